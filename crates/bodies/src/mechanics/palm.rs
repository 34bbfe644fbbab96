//! A palm by its own form: what a sensor's value means.
//!
//! A palm is a curve that begins at the joint. In its frame the first axis leaves the joint along the palm, the second one
//! points to the side of the body; so palm 2, which stands on the body's other side, is palm 1 in a mirror. A sensor measures
//! where the contact is, by arc length from the joint.

use super::harmonics::SupportNumber;
use std::ops::{Add, Mul, Sub};

/// Numbers by which a palm is given: doubles, and those of 320 bits.
pub trait PalmNumber: SupportNumber {
    /// The sine and the cosine of an angle in radians.
    fn sine_cosine(&self) -> [Self; 2];
    /// The quotient.
    fn over(&self, divisor: &Self) -> Self;
}

impl PalmNumber for f64 {
    fn sine_cosine(&self) -> [f64; 2] {
        let (sine, cosine) = self.sin_cos();
        [sine, cosine]
    }

    fn over(&self, divisor: &f64) -> f64 {
        self / divisor
    }
}

impl PalmNumber for super::Real {
    fn sine_cosine(&self) -> [Self; 2] {
        let (sine, cosine) = self.sin_cos();
        [sine, cosine]
    }

    fn over(&self, divisor: &Self) -> Self {
        self / divisor
    }
}

/// The form of a palm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Palm<N> {
    /// A line through the joint.
    #[default]
    Flat,
    /// An arc of a circle through the joint, of this radius in m: positive where the palm is hollow, so that it bends towards the
    /// body (equations 4.81 and 4.82), negative where it bulges.
    Circular { radius: N },
}

/// A palm at a sensor's value, in the palm's frame.
#[derive(Clone, Debug)]
pub struct PalmPoint<N> {
    /// The contact, in m from the joint.
    pub place: [N; 2],
    /// The unit tangent, away from the joint.
    pub tangent: [N; 2],
    /// The unit normal, towards the body.
    pub normal: [N; 2],
    /// In 1/m, positive where hollow: by how much the tangent turns towards the body in a metre.
    pub curvature: N,
    /// By how much it has turned since the joint, in rad.
    pub turned: N,
}

impl<N: PalmNumber> Palm<N>
where
    for<'a> &'a N: Add<&'a N, Output = N> + Sub<&'a N, Output = N> + Mul<&'a N, Output = N>,
{
    /// The palm where its sensor measures `s`, in m from the joint along the palm.
    pub fn at(&self, s: &N) -> PalmPoint<N> {
        let (zero, one) = (N::whole(0), N::whole(1));
        match self {
            Palm::Flat => PalmPoint {
                place: [s.clone(), zero.clone()],
                tangent: [one.clone(), zero.clone()],
                normal: [zero.clone(), one],
                curvature: zero.clone(),
                turned: zero,
            },
            Palm::Circular { radius } => {
                let turned = s.over(radius);
                // by the half angle: 1 - cos loses all digits where the palm is nearly flat
                let two = N::whole(2);
                let [sine, cosine] = turned.over(&two).sine_cosine();
                let chord = &(&two * radius) * &sine;
                let tangent = [&(&cosine * &cosine) - &(&sine * &sine), &two * &(&sine * &cosine)];
                PalmPoint {
                    place: [&chord * &cosine, &chord * &sine],
                    normal: [&zero - &tangent[1], tangent[0].clone()],
                    tangent,
                    curvature: one.over(radius),
                    turned,
                }
            }
        }
    }

    /// The palm with its curvature reduced to a part of it, from flat at zero to itself at one.
    pub(super) fn flattened(&self, part: &N) -> Palm<N>
    where
        N: PartialEq,
    {
        match self {
            Palm::Circular { radius } if *part != N::whole(0) => Palm::Circular { radius: radius.over(part) },
            _ => Palm::Flat,
        }
    }
}

impl Palm<f64> {
    /// How far the palm reaches, in m along it: without end if it is flat, half a circle otherwise.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Palm::Flat => f64::INFINITY,
            Palm::Circular { radius } => std::f64::consts::PI * radius.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::Real;

    /// A quarter of a circle of radius 2, by hand: from the joint to (2, 2), where the tangent points to the body's side. A
    /// bulging one goes to (2, -2).
    #[test]
    fn a_quarter_of_a_circle() {
        let quarter = std::f64::consts::PI;
        for (radius, side) in [(2.0, 1.0), (-2.0, -1.0)] {
            let end = Palm::Circular { radius }.at(&quarter);
            let found = [end.place, end.tangent, end.normal].concat();
            for (found, expected) in found.iter().zip([2.0, 2.0 * side, 0.0, side, -side, 0.0]) {
                assert!((found - expected).abs() < 1e-15, "{found} {expected}");
            }
            assert_eq!((end.curvature, end.turned), (side / 2.0, side * quarter / 2.0));
        }
    }

    /// At the radius 1e9 the contact of s = 2 is 2e-9 above the tangent, to all digits of a double; with 320 bits to 90.
    #[test]
    fn a_nearly_flat_palm_keeps_its_digits() {
        let end = Palm::Circular { radius: 1e9 }.at(&2.0);
        assert!((end.place[1] / 2e-9 - 1.0).abs() < 1e-15 && (end.place[0] - 2.0).abs() < 1e-15);
        let flat = Palm::<f64>::Flat.at(&2.0);
        assert_eq!(
            (flat.place, flat.tangent, flat.normal, flat.curvature),
            ([2.0, 0.0], [1.0, 0.0], [0.0, 1.0], 0.0)
        );
        let (two, radius) = (Real::whole(2), Real::whole(1_000_000_000));
        let end = Palm::Circular { radius: radius.clone() }.at(&two);
        // x^2 + (y - b)^2 = b^2
        let above = &end.place[1] - &radius;
        let off = &end.place[0] * &end.place[0] + &above * &above - &radius * &radius;
        assert!(off.abs() < Real::power_of_two(-250));
    }

    /// The tangent is the derivative of the place by arc length, and turns by the curvature: central differences.
    #[test]
    fn a_sensor_reads_arc_length() {
        for palm in [Palm::Flat, Palm::Circular { radius: 3.0 }, Palm::Circular { radius: -0.7 }] {
            let [before, here, after] = [0.6 - 1e-5, 0.6, 0.6 + 1e-5].map(|s| palm.at(&s));
            for k in 0..2 {
                let slope =
                    |pick: fn(&PalmPoint<f64>) -> [f64; 2]| (pick(&after)[k] - pick(&before)[k]) / 2e-5;
                assert!((slope(|point| point.place) - here.tangent[k]).abs() < 1e-9);
                assert!((slope(|point| point.tangent) - here.curvature * here.normal[k]).abs() < 1e-9);
            }
        }
    }
}
