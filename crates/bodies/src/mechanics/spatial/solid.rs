//! A convex body in space that is shown to be one, about its centre of mass.

use super::curvature::{greater_tangential, greatest_radius};
use super::form::{SolidForm, Support};
use super::sphere::{Doubt, over_all_directions, positive_everywhere};
use nalgebra::{Matrix3, Vector3};

/// Sharper edges than this exponent makes are not worth their quadrature.
const MOST_EXPONENT: u32 = 64;
/// Polynomials of a higher degree in a direction are not looked at.
const MOST_DEGREE: u32 = 64;

/// Why a form is not that of a body that palms can hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidFormError {
    /// A number that cannot be used.
    #[error("{what} is {value}; it has to be {wanted}")]
    Value { what: &'static str, value: f64, wanted: &'static str },
    /// There is nothing to add up.
    #[error("a blend has no parts; give at least one")]
    Nothing,
    /// A radius of curvature is not positive, or cannot be shown to be.
    #[error(
        "the body cannot be shown to be strictly convex: where the outward normal is ({x:.4}, {y:.4}, {z:.4}) the least radius of \
         curvature is no more than {radius:.4e} m for certain; make the harmonics smaller"
    )]
    NotConvex { x: f64, y: f64, z: f64, radius: f64 },
    /// The centre of mass lies outside, or cannot be shown to lie inside.
    #[error(
        "the centre of mass cannot be shown to lie inside the body: in the direction ({x:.4}, {y:.4}, {z:.4}) it reaches \
         {extent:.4e} m from it"
    )]
    CentreOutside { x: f64, y: f64, z: f64, extent: f64 },
    /// An integral did not converge.
    #[error("volume and moments did not settle: the last two approximations differ by a relative {0:.1e}")]
    Quadrature(f64),
}

/// A strictly convex body in a frame whose origin is its centre of mass.
#[derive(Clone, Debug)]
pub struct ConvexSolid {
    form: SolidForm,
    centre: Vector3<f64>,
    /// From the centre of mass.
    centroid: Vector3<f64>,
    volume: f64,
    second: Matrix3<f64>,
}

impl ConvexSolid {
    /// The body with its centre of mass at a point of the frame in which the form is given, or at the centroid.
    ///
    /// # Errors
    /// Where a number cannot be used, the body is not strictly convex, or the centre of mass is not inside.
    pub fn new(form: SolidForm, centre: Option<[f64; 3]>) -> Result<ConvexSolid, SolidFormError> {
        check(&form)?;
        let flat = |doubt: Doubt| SolidFormError::NotConvex {
            x: doubt.direction.x,
            y: doubt.direction.y,
            z: doubt.direction.z,
            radius: doubt.value,
        };
        let [least, slope, size] = bounds(&form, 1.0);
        let curved = |n: &Vector3<f64>| least + tangential(&polynomial_part(&form, n), n);
        positive_everywhere(curved, slope, 1e-13 * size).map_err(flat)?;

        let moments = |n: &Vector3<f64>| {
            let here = form.support(n);
            // cones from the origin to patches of the surface
            let cone = here.extent * here.area();
            let [x, y, z] = here.point.into();
            let first = [x, y, z].map(|value| value / 4.0);
            let second = [x * x, y * y, z * z, x * y, x * z, y * z].map(|product| product / 5.0);
            let all = [&[1.0 / 3.0][..], &first, &second].concat();
            std::array::from_fn(|i| all[i] * cone)
        };
        let all: [f64; 10] = over_all_directions(moments).map_err(SolidFormError::Quadrature)?;
        let volume = all[0];
        let centroid = Vector3::new(all[1], all[2], all[3]) / volume;
        let about_origin =
            Matrix3::new(all[4], all[7], all[8], all[7], all[5], all[9], all[8], all[9], all[6]) / volume;
        let second = about_origin - centroid * centroid.transpose();
        let centre = centre.map_or(centroid, Vector3::from);
        let solid = ConvexSolid { form, centre, centroid: centroid - centre, volume, second };
        positive_everywhere(|n| solid.support(n).extent, size + solid.centre.norm(), 1e-13 * size).map_err(
            |doubt| SolidFormError::CentreOutside {
                x: doubt.direction.x,
                y: doubt.direction.y,
                z: doubt.direction.z,
                extent: doubt.value,
            },
        )?;
        Ok(solid)
    }

    /// The support function about the centre of mass, in the direction of a unit vector.
    pub fn support(&self, n: &Vector3<f64>) -> Support {
        let Support { extent, point, bend } = self.form.support(n);
        Support { extent: extent - self.centre.dot(n), point: point - self.centre, bend }
    }

    /// Whether the body rolls inside a sphere of a radius in metres: all of its radii of curvature are smaller for certain.
    ///
    /// # Errors
    /// An outward normal in the body's frame, and how large a radius of curvature may be there.
    pub fn rolls_in(&self, radius: f64) -> Result<(), (Vector3<f64>, f64)> {
        let [_, slope, size] = bounds(&self.form, 1.0);
        let own = |n: &Vector3<f64>| {
            greatest_radius(&self.form, 1.0) + greater_tangential(&polynomial_part(&self.form, n), n)
        };
        positive_everywhere(|n| radius - own(n), slope, 1e-13 * (size + radius))
            .map_err(|doubt| (doubt.direction, radius - doubt.value))
    }

    /// In cubic metres.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The middle of its volume, from its centre of mass.
    pub fn centroid(&self) -> Vector3<f64> {
        self.centroid
    }

    /// The inertia matrix of a body of one material about its centroid, for each kilogram, in square metres.
    pub fn uniform_inertia(&self) -> Matrix3<f64> {
        Matrix3::identity() * self.second.trace() - self.second
    }
}

fn check(form: &SolidForm) -> Result<(), SolidFormError> {
    let is = |holds: bool, what, value, wanted| match holds {
        true => Ok(()),
        false => Err(SolidFormError::Value { what, value, wanted }),
    };
    let positive =
        |what, value: f64| is(value > 0.0 && value.is_finite(), what, value, "positive and finite");
    match form {
        SolidForm::Ellipsoid { semi_axes } => {
            semi_axes.iter().try_for_each(|value| positive("a semi-axis", *value))
        }
        SolidForm::Superellipsoid { semi_axes, exponent, rounding } => {
            semi_axes.iter().try_for_each(|value| positive("a semi-axis", *value))?;
            let usable = exponent % 2 == 0 && (2..=MOST_EXPONENT).contains(exponent);
            is(usable, "the exponent", f64::from(*exponent), "even, from 2 to 64")?;
            match exponent {
                2 => is(
                    *rounding >= 0.0 && rounding.is_finite(),
                    "the rounding",
                    *rounding,
                    "finite and not negative",
                ),
                _ => positive("the rounding of a body with edges", *rounding),
            }
        }
        SolidForm::Harmonics { mean, terms } => {
            is(mean.is_finite(), "the mean", *mean, "finite")?;
            terms.iter().try_for_each(|term| {
                is(term.coefficient.is_finite(), "a coefficient", term.coefficient, "finite")?;
                let degree: f64 = term.powers.iter().map(|power| f64::from(*power)).sum();
                is(degree <= f64::from(MOST_DEGREE), "the degree of a term", degree, "at most 64")
            })
        }
        SolidForm::Blend(parts) if parts.is_empty() => Err(SolidFormError::Nothing),
        SolidForm::Blend(parts) => parts.iter().try_for_each(|(times, part)| {
            positive("how often a part is taken", *times)?;
            check(part)
        }),
    }
}

/// Of a form that is taken so many times: what the radii of curvature of all but its polynomials are certainly not below, how fast
/// those of the polynomials change with the direction at most, and how far it reaches at most.
///
/// The radii of curvature of an ellipsoid lie above `min a_i^2 / max a_i`; edges have none, so that the ball that rounds them
/// remains. On the unit sphere no `j`-th derivative of a monomial of degree `k` is greater than `k (k - 1) ...`, with `j`
/// factors, and those of `|n|^m` are no greater than `|m|`, `|m| (|m| + 1)` and `|m| (|m| + 2) max(3, |m| + 1)`.
fn bounds(form: &SolidForm, times: f64) -> [f64; 3] {
    let extremes = |axes: &[f64; 3]| axes.iter().fold((f64::MAX, 0f64), |(a, b), x| (a.min(*x), b.max(*x)));
    match form {
        SolidForm::Ellipsoid { semi_axes } => {
            let (least, greatest) = extremes(semi_axes);
            [times * least * least / greatest * (1.0 - 1e-12), 0.0, times * greatest]
        }
        SolidForm::Superellipsoid { semi_axes, exponent, rounding } => {
            let (least, greatest) = extremes(semi_axes);
            let own = if *exponent == 2 { least * least / greatest * (1.0 - 1e-12) } else { 0.0 };
            // the greatest extent is that in the direction of an axis, where p >= 2
            [times * (own + rounding), 0.0, times * (greatest + rounding)]
        }
        SolidForm::Harmonics { mean, terms } => {
            let (mut slope, mut size) = (0.0, mean.abs());
            for term in terms {
                let k: f64 = term.powers.iter().map(|power| f64::from(*power)).sum();
                let m = (1.0 - k).abs();
                let of_power = [1.0, k, k * (k - 1.0), k * (k - 1.0) * (k - 2.0)].map(|bound| bound.max(0.0));
                let of_norm = [1.0, m, m * (m + 1.0), m * (m + 2.0) * (m + 1.0).max(3.0)];
                let third = of_power[3]
                    + 3.0 * of_power[2] * of_norm[1]
                    + 3.0 * of_power[1] * of_norm[2]
                    + of_norm[3];
                slope += third * term.coefficient.abs();
                size += (1.0 + k + m) * term.coefficient.abs();
            }
            [0.0, times * slope, times * size]
        }
        SolidForm::Blend(parts) => parts.iter().fold([0.0; 3], |sum, (by, part)| {
            let own = bounds(part, times * by);
            std::array::from_fn(|i| sum[i] + own[i])
        }),
    }
}

/// The second derivatives of what of a form is a polynomial.
fn polynomial_part(form: &SolidForm, n: &Vector3<f64>) -> Matrix3<f64> {
    match form {
        SolidForm::Ellipsoid { .. } | SolidForm::Superellipsoid { .. } => Matrix3::zeros(),
        SolidForm::Harmonics { .. } => form.support(n).bend,
        SolidForm::Blend(parts) => {
            parts.iter().fold(Matrix3::zeros(), |sum, (times, part)| sum + polynomial_part(part, n) * *times)
        }
    }
}

/// The lesser of the two eigenvalues along tangents of a symmetric matrix that the normal is no part of.
fn tangential(bend: &Matrix3<f64>, n: &Vector3<f64>) -> f64 {
    let aside = n.cross(&Vector3::ith(n.iamin(), 1.0)).normalize();
    let across = n.cross(&aside);
    let [a, b, c] = [aside.dot(&(bend * aside)), aside.dot(&(bend * across)), across.dot(&(bend * across))];
    (a + c) / 2.0 - ((a - c) / 2.0).hypot(b)
}

#[cfg(test)]
mod tests {
    use super::super::form::Harmonic;
    use super::*;
    use std::f64::consts::PI;

    fn harmonics(mean: f64, terms: &[([u32; 3], f64)]) -> SolidForm {
        let terms = terms.iter().map(|(powers, c)| Harmonic { powers: *powers, coefficient: *c }).collect();
        SolidForm::Harmonics { mean, terms }
    }

    #[test]
    fn an_ellipsoid_has_its_volume_and_moments() {
        let axes = [2.5, 2.0, 1.0];
        let solid = ConvexSolid::new(SolidForm::Ellipsoid { semi_axes: axes }, None).unwrap();
        assert!((solid.volume() - 20.0 / 3.0 * PI).abs() < 1e-11);
        let inertia = solid.uniform_inertia();
        let expected = [(4.0 + 1.0) / 5.0, (6.25 + 1.0) / 5.0, (6.25 + 4.0) / 5.0];
        for i in 0..3 {
            for j in 0..3 {
                let wanted = if i == j { expected[i] } else { 0.0 };
                assert!((inertia[(i, j)] - wanted).abs() < 1e-12);
            }
        }
    }

    /// A ball that is moved is the ball about its centre; a rounded body of the exponent 4 has the volume of Steiner's formula,
    /// which is a polynomial of the third degree in the rounding.
    #[test]
    fn a_moved_ball_and_steiners_polynomial() {
        let ball = ConvexSolid::new(harmonics(1.5, &[([1, 0, 0], 0.4), ([0, 0, 1], -0.2)]), None).unwrap();
        assert!((ball.volume() - 4.0 / 3.0 * PI * 1.5f64.powi(3)).abs() < 1e-11);
        assert!((ball.support(&Vector3::x()).extent - 1.5).abs() < 1e-13);
        let volume = |rounding: f64| {
            let form = SolidForm::Superellipsoid { semi_axes: [1.0, 0.8, 1.2], exponent: 4, rounding };
            ConvexSolid::new(form, None).unwrap().volume()
        };
        let [a, b, c, d, e] = [0.2, 0.4, 0.6, 0.8, 1.0].map(volume);
        // fourth differences of a cubic vanish, third ones are 6 times its leading coefficient
        assert!((a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs() < 1e-10);
        assert!((-a + 3.0 * b - 3.0 * c + d - 6.0 * 4.0 / 3.0 * PI * 0.008).abs() < 1e-10);
    }

    /// On the sphere `z^2` takes away at most 2 (where `z = 1`): `2 (1 - z^2) - z^2` and `-z^2` are its second derivatives along
    /// a meridian and across, less the value.
    #[test]
    fn a_dent_is_refused_and_the_last_body_without_one_is_not() {
        let dented = |c: f64| ConvexSolid::new(harmonics(1.0, &[([0, 0, 2], c)]), None);
        // along a meridian 1 + c (2 - 3 z^2), across 1 - c z^2
        assert!(dented(0.9).is_ok());
        assert!(matches!(dented(1.01), Err(SolidFormError::NotConvex { .. })));
        assert!(dented(-0.45).is_ok());
        assert!(matches!(dented(-0.51), Err(SolidFormError::NotConvex { .. })));
        let ellipsoid = SolidForm::Ellipsoid { semi_axes: [1.0; 3] };
        let blend = |c: f64| {
            let parts = vec![(0.5, ellipsoid.clone()), (1.0, harmonics(0.5, &[([0, 0, 2], c)]))];
            ConvexSolid::new(SolidForm::Blend(parts), None)
        };
        assert!(blend(0.9).is_ok() && blend(1.1).is_err());
    }

    #[test]
    fn what_cannot_be_used_says_what_it_is() {
        let refused = |form| ConvexSolid::new(form, None).unwrap_err().to_string();
        let box_like =
            |exponent, rounding| SolidForm::Superellipsoid { semi_axes: [1.0; 3], exponent, rounding };
        assert!(refused(box_like(3, 0.1)).contains("exponent is 3"));
        assert!(refused(box_like(4, 0.0)).contains("rounding"));
        assert!(refused(SolidForm::Ellipsoid { semi_axes: [1.0, f64::NAN, 1.0] }).contains("semi-axis"));
        assert!(refused(SolidForm::Blend(Vec::new())).contains("no parts"));
        assert!(refused(harmonics(f64::INFINITY, &[])).contains("mean"));
        assert!(refused(harmonics(1.0, &[([40, 40, 0], 1e-9)])).contains("degree"));
        let outside = ConvexSolid::new(SolidForm::Ellipsoid { semi_axes: [1.0; 3] }, Some([0.9, 0.5, 0.0]));
        assert!(matches!(outside, Err(SolidFormError::CentreOutside { .. })));
    }
}
