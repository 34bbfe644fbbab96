//! How a body in space looks: its support function with gradient and second derivatives, whatever it is made of.

use nalgebra::{Matrix3, Vector3};

/// A convex body in a frame of its own, by its support function: how far it reaches in the direction of a unit vector `n`.
/// Lengths are in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum SolidForm {
    /// `sqrt(sum (a_i n_i)^2)`, the ellipsoid with these semi-axes.
    Ellipsoid { semi_axes: [f64; 3] },
    /// `(sum |a_i n_i|^p)^(1/p) + rounding`, `p` the even exponent: the body `sum |x_i/a_i|^q <= 1` with `1/p + 1/q = 1`, to which
    /// a ball of the radius `rounding` is added (Minkowski). For `p > 2` the first has edges, which the ball rounds off.
    Superellipsoid { semi_axes: [f64; 3], exponent: u32, rounding: f64 },
    /// `mean + sum c x^i y^j z^k`, polynomials of the direction. Those of the first degree move the body and keep its form.
    Harmonics { mean: f64, terms: Vec<Harmonic> },
    /// The sum of bodies, each taken so many times (Minkowski): support functions add up.
    Blend(Vec<(f64, SolidForm)>),
}

/// The product of a coefficient in metres and of powers of the direction's three components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// The three exponents.
    pub powers: [u32; 3],
    /// What it is multiplied by.
    pub coefficient: f64,
}

/// A support function at a direction, continued to all of space such that `h(t n) = t h(n)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// How far the body reaches.
    pub extent: f64,
    /// The gradient: the boundary point with this outward normal.
    pub point: Vector3<f64>,
    /// The second derivatives. Along tangents they are the body's radii of curvature; along the normal they vanish.
    pub bend: Matrix3<f64>,
}

impl Support {
    fn plus(self, times: f64, other: Support) -> Support {
        Support {
            extent: self.extent + times * other.extent,
            point: self.point + times * other.point,
            bend: self.bend + times * other.bend,
        }
    }

    fn none() -> Support {
        Support { extent: 0.0, point: Vector3::zeros(), bend: Matrix3::zeros() }
    }

    /// The product of both radii of curvature: the area of the surface for each unit of solid angle of its normals.
    pub(super) fn area(&self) -> f64 {
        let trace = self.bend.trace();
        (trace * trace - (self.bend * self.bend).trace()) / 2.0
    }
}

impl SolidForm {
    /// The support function in the direction of a unit vector.
    pub fn support(&self, n: &Vector3<f64>) -> Support {
        match self {
            SolidForm::Ellipsoid { semi_axes } => power_mean(semi_axes, 2, n),
            SolidForm::Superellipsoid { semi_axes, exponent, rounding } => {
                power_mean(semi_axes, *exponent, n).plus(*rounding, ball(n))
            }
            SolidForm::Harmonics { mean, terms } => {
                let start = Support::none().plus(*mean, ball(n));
                terms.iter().fold(start, |sum, term| sum.plus(term.coefficient, monomial(&term.powers, n)))
            }
            SolidForm::Blend(parts) => {
                parts.iter().fold(Support::none(), |sum, (times, part)| sum.plus(*times, part.support(n)))
            }
        }
    }
}

fn ball(n: &Vector3<f64>) -> Support {
    Support { extent: 1.0, point: *n, bend: Matrix3::identity() - n * n.transpose() }
}

/// `(sum |a_i n_i|^p)^(1/p)`, of products that are scaled by the greatest, so that no power of it overflows.
fn power_mean(semi_axes: &[f64; 3], exponent: u32, n: &Vector3<f64>) -> Support {
    let axes = Vector3::from(*semi_axes);
    let stretched = axes.component_mul(n);
    let greatest = stretched.amax();
    let scaled = stretched / greatest;
    let p = f64::from(exponent);
    let power = |by: u32| scaled.map(|x| x.powi(by.cast_signed()));
    let sum = power(exponent).sum();
    let slope = axes.component_mul(&power(exponent - 1));
    let point = slope * sum.powf((1.0 - p) / p);
    let straight = Matrix3::from_diagonal(&axes.component_mul(&axes).component_mul(&power(exponent - 2)));
    let bend = (straight * sum.powf((1.0 - p) / p)
        - slope * slope.transpose() * sum.powf((1.0 - 2.0 * p) / p))
        * ((p - 1.0) / greatest);
    Support { extent: greatest * sum.powf(1.0 / p), point, bend }
}

/// A monomial `P` of the degree `k`, continued as `P |n|^(1 - k)`.
fn monomial(powers: &[u32; 3], n: &Vector3<f64>) -> Support {
    // the factors of each component: its power and what that has for derivatives
    let factor = |i: usize, derivative: u32| {
        let power = powers[i];
        if derivative > power {
            return 0.0;
        }
        let falling: f64 = (0..derivative).map(|j| f64::from(power - j)).product();
        falling * n[i].powi((power - derivative).cast_signed())
    };
    let by = |orders: [u32; 3]| (0..3).map(|i| factor(i, orders[i])).product::<f64>();
    let unit = |i: usize| std::array::from_fn::<u32, 3, _>(|j| u32::from(i == j));
    let value = by([0; 3]);
    let slope = Vector3::from_fn(|i, _| by(unit(i)));
    let second = Matrix3::from_fn(|i, j| by(std::array::from_fn(|k| unit(i)[k] + unit(j)[k])));
    let m = 1.0 - f64::from(powers.iter().sum::<u32>());
    let mixed = slope * n.transpose();
    let radial = n * n.transpose();
    Support {
        extent: value,
        point: slope + m * value * n,
        bend: second
            + m * (mixed + mixed.transpose())
            + m * value * (Matrix3::identity() + (m - 2.0) * radial),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forms() -> Vec<SolidForm> {
        let term = |powers, coefficient| Harmonic { powers, coefficient };
        let harmonics = SolidForm::Harmonics {
            mean: 1.5,
            terms: vec![
                term([1, 0, 0], 0.2),
                term([2, 1, 0], 0.05),
                term([0, 2, 2], -0.03),
                term([1, 1, 1], 0.04),
                term([0, 0, 5], 0.01),
            ],
        };
        let ellipsoid = SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] };
        let box_like = SolidForm::Superellipsoid { semi_axes: [1.0, 0.7, 1.3], exponent: 6, rounding: 0.2 };
        let blend = SolidForm::Blend(vec![(0.5, ellipsoid.clone()), (2.0, harmonics.clone())]);
        vec![ellipsoid, box_like, harmonics, blend]
    }

    /// Gradient and second derivatives by central differences of `|n| h(n/|n|)`, and Euler's relations of a function of the
    /// first degree.
    #[test]
    fn derivatives_are_those_of_the_extent() {
        for form in forms() {
            let along = |n: Vector3<f64>| {
                let size = n.norm();
                let there = form.support(&(n / size));
                (size * there.extent, there.point)
            };
            for direction in [[0.3, -0.5, 0.8], [1.0, 0.2, 0.1], [-0.6, 0.6, -0.5]] {
                let n = Vector3::from(direction).normalize();
                let here = form.support(&n);
                assert!((here.point.dot(&n) - here.extent).abs() < 1e-14);
                assert!((here.bend * n).norm() < 1e-13);
                for i in 0..3 {
                    let step = Vector3::ith(i, 1e-5);
                    let (above, below) = (along(n + step), along(n - step));
                    assert!(((above.0 - below.0) / 2e-5 - here.point[i]).abs() < 1e-8, "{form:?}");
                    let difference = (above.1 - below.1) / 2e-5 - here.bend.column(i);
                    assert!(difference.norm() < 1e-7, "{form:?} {difference}");
                }
            }
        }
    }

    /// Points of an ellipsoid meet its equation; the product of the radii of curvature is `(abc)^2 / h^4` (Gauss).
    #[test]
    fn an_ellipsoid_is_one() {
        let form = SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] };
        for direction in [[0.3, -0.5, 0.8], [1.0, 0.2, 0.1], [0.0, 0.0, 1.0]] {
            let here = form.support(&Vector3::from(direction).normalize());
            let level = (here.point[0] / 2.5).powi(2) + (here.point[1] / 2.0).powi(2) + here.point[2].powi(2);
            assert!((level - 1.0).abs() < 1e-14);
            assert!((here.area() - 25.0 / here.extent.powi(4)).abs() < 1e-12 * here.area());
        }
    }
}
