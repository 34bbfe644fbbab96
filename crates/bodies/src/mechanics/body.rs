//! A smooth convex body in the plane, by its support function.

use super::Real;
use super::harmonics::Harmonics;
use super::linear::Vector;
use dashu::base::Abs;
use dashu::rational::RBig;

/// Why a support function is not that of a body that the palms can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// The radius of curvature may vanish somewhere.
    #[error("the body cannot be shown to be strictly convex: its harmonics are too large for its size")]
    NotConvex,
    /// The centre of mass may lie outside.
    #[error("the centre of mass cannot be shown to lie inside the body")]
    CentreOutside,
}

/// The convex body whose extent from its centre of mass in the direction at the angle `a` is
/// `h(a) = mean + sum_k (p_k cos(k a) + q_k sin(k a))`, lengths in metres.
///
/// A body is the intersection of the half-planes `x · u(a) <= h(a)`; its boundary point with the outward
/// normal `u(a)` is `h u + h' u'`. The first harmonic moves the body away from its centre of mass without
/// changing its form.
#[derive(Clone, Debug)]
pub struct PlanarBody {
    harmonics: Harmonics<Real>,
}

impl PlanarBody {
    /// The body with these coefficients, `harmonics[k - 1]` being `(p_k, q_k)`.
    ///
    /// # Errors
    /// Unless `mean > sum (k^2 - 1)(|p_k| + |q_k|)`, which makes `h + h''` (the radius of curvature) positive
    /// everywhere, and `mean > sum (|p_k| + |q_k|)`, which makes `h` positive. Both are decided exactly; both are
    /// sufficient, not necessary.
    pub fn new(mean: &RBig, harmonics: &[(RBig, RBig)]) -> Result<Self, ShapeError> {
        let (mut extent, mut bend) = (RBig::ZERO, RBig::ZERO);
        for (k, (p, q)) in (1i64..).zip(harmonics) {
            let size = p.clone().abs() + q.clone().abs();
            bend += RBig::from(k * k - 1) * &size;
            extent += size;
        }
        if *mean <= bend {
            return Err(ShapeError::NotConvex);
        }
        if *mean <= extent {
            return Err(ShapeError::CentreOutside);
        }
        let real = |(p, q): &(RBig, RBig)| [Real::from_rational(p), Real::from_rational(q)];
        let pairs = harmonics.iter().map(real).collect();
        Ok(PlanarBody { harmonics: Harmonics { mean: Real::from_rational(mean), pairs } })
    }

    /// The value of the support function and of its derivative in a direction, a unit vector in the body's
    /// frame.
    fn support_and_slope(&self, direction: &Vector<2>) -> (Real, Real) {
        let [x, y] = direction;
        let (mut cosine, mut sine) = (Real::one(), Real::zero());
        let [value, slope, _] = self.harmonics.support(|_| {
            // one multiple of the angle after the other: the angle itself is not known
            (cosine, sine) = (&cosine * x - &sine * y, &sine * x + &cosine * y);
            [cosine.clone(), sine.clone()]
        });
        (value, slope)
    }

    /// How far the body reaches in a direction, a unit vector in the body's frame.
    pub fn support(&self, direction: &Vector<2>) -> Real {
        self.support_and_slope(direction).0
    }

    /// The boundary point whose outward normal is a given unit vector, both in the body's frame.
    pub fn point(&self, normal: &Vector<2>) -> Vector<2> {
        let (value, slope) = self.support_and_slope(normal);
        let [x, y] = normal;
        [&value * x - &slope * y, &value * y + &slope * x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::linear::dot;
    use palmistry_math::number::parse_decimal;

    fn q(text: &str) -> RBig {
        parse_decimal(text).unwrap()
    }

    fn direction(angle: f64) -> Vector<2> {
        let (sine, cosine) =
            Real::from_rational(&palmistry_math::number::rational_from_f64(angle).unwrap()).sin_cos();
        [cosine, sine]
    }

    /// Every boundary point lies in every supporting half-plane, and on its own one.
    #[test]
    fn a_body_lies_inside_its_tangents() {
        let body = PlanarBody::new(
            &q("1"),
            &[(q("0.2"), q("-0.1")), (q("0.1"), q("0.05")), (q("-0.02"), q("0.03"))],
        );
        let body = body.unwrap();
        let directions: Vec<_> = (0..60).map(|i| direction(f64::from(i) / 9.0)).collect();
        for own in &directions {
            let point = body.point(own);
            for other in &directions {
                let room = body.support(other) - dot(&point, other);
                assert!(if own == other {
                    room.abs() < Real::power_of_two(-310)
                } else {
                    room.is_positive()
                });
            }
        }
    }

    #[test]
    fn a_body_that_may_have_a_dent_is_refused() {
        let zero = || (q("0"), q("0"));
        let refused = |mean: &str, harmonics: &[(RBig, RBig)]| PlanarBody::new(&q(mean), harmonics).err();
        assert_eq!(refused("1", &[zero(), (q("1/3"), q("0"))]), Some(ShapeError::NotConvex));
        assert_eq!(refused("1", &[zero(), (q("0.33"), q("0"))]), None);
        assert_eq!(refused("1", &[(q("0.6"), q("0.4"))]), Some(ShapeError::CentreOutside));
        assert_eq!(refused("0", &[]), Some(ShapeError::NotConvex));
    }
}
