//! How large the radii of curvature of a form are at most: whether a body rolls inside a sphere.

use super::form::SolidForm;
use nalgebra::{Matrix3, Vector3};

/// What the radii of curvature of all but a form's polynomials are certainly not above, where it is taken so many times.
///
/// Those of an ellipsoid lie below `max a_i^2 / min a_i`. With `y_i = |a_i n_i|/h` those of `h = (sum |a_i n_i|^p)^(1/p)` are at most
/// `(p - 1) sum a_i^2 v_i^2 y_i^(p - 2)/h` along a tangent `v`, which is no more than `(p - 1) max a_i^2/min h`, and `h` is at least
/// `(sum a_i^(-2 p/(p - 2)))^(-(p - 2)/(2 p))` by Hoelder's inequality.
pub(super) fn greatest_radius(form: &SolidForm, times: f64) -> f64 {
    let extremes = |axes: &[f64; 3]| axes.iter().fold((f64::MAX, 0f64), |(a, b), x| (a.min(*x), b.max(*x)));
    let own = match form {
        SolidForm::Ellipsoid { semi_axes } => {
            let (least, greatest) = extremes(semi_axes);
            greatest * greatest / least
        }
        SolidForm::Superellipsoid { semi_axes, exponent, rounding } => {
            let (least, greatest) = extremes(semi_axes);
            let p = f64::from(*exponent);
            let extent = match exponent {
                2 => least,
                _ => {
                    // of the axes over the least one, so that no power overflows
                    let power = -2.0 * p / (p - 2.0);
                    let sum: f64 = semi_axes.iter().map(|a| (a / least).powf(power)).sum();
                    least * sum.powf(-(p - 2.0) / (2.0 * p))
                }
            };
            (p - 1.0) * greatest * greatest / extent + rounding
        }
        SolidForm::Harmonics { .. } => 0.0,
        SolidForm::Blend(parts) => parts.iter().map(|(by, part)| greatest_radius(part, *by)).sum(),
    };
    times * own * (1.0 + 1e-12)
}

/// The greater of the two eigenvalues along tangents of a symmetric matrix that the normal is no part of.
pub(super) fn greater_tangential(bend: &Matrix3<f64>, n: &Vector3<f64>) -> f64 {
    let aside = n.cross(&Vector3::ith(n.iamin(), 1.0)).normalize();
    let across = n.cross(&aside);
    let [a, b, c] = [aside.dot(&(bend * aside)), aside.dot(&(bend * across)), across.dot(&(bend * across))];
    (a + c) / 2.0 + ((a - c) / 2.0).hypot(b)
}
