//! A support function on the sphere: a sum of real spherical harmonics.

use nalgebra::{Matrix3, Vector3};
use num_dual::{DualNum, hessian};

/// A support function about a point in m, `h(n) = sum c_lm Y_lm(n)` for unit vectors `n`, with harmonics whose squares have the mean one over the sphere.
///
/// Coefficients are those of degree 0, of degree 1, and so on; within a degree `l` the order is `m = 0`, then cosine and sine of `m = 1` up to `m = l`. Those of degree one move the
/// body and keep its form.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereSeries {
    /// `(degree + 1)^2` of them, in m.
    pub coefficients: Vec<f64>,
    /// The last degree.
    pub degree: usize,
}

/// The harmonics up to a degree at a unit vector: homogeneous polynomials by the recursion of Legendre's functions, so that the poles are no exception.
fn basis<D: DualNum<Primitive = f64>>(n: &[D; 3], degree: usize) -> Vec<D> {
    let [x, y, z] = n;
    let zero = || x.clone() * 0.0;
    let mut values: Vec<D> = vec![zero(); (degree + 1) * (degree + 1)];
    // rho^m cos(m phi) and rho^m sin(m phi)
    let (mut cosine, mut sine) = (zero() + 1.0, zero());
    // P_m^m/rho^m with the factors that make the mean of squares one
    let mut first = zero() + 1.0;
    for m in 0..=degree {
        let order = m as f64;
        let (mut before, mut here) = (zero(), first.clone());
        for l in m..=degree {
            let place = l * l;
            if m == 0 {
                values[place] = here.clone();
            } else {
                values[place + 2 * m - 1] = here.clone() * cosine.clone();
                values[place + 2 * m] = here.clone() * sine.clone();
            }
            // normalised as in S. Holmes and W. Featherstone, Journal of Geodesy 76, 2002, (11)
            let next = (l + 1) as f64;
            let a = ((4.0 * next * next - 1.0) / (next * next - order * order)).sqrt();
            let b = if l == m {
                0.0
            } else {
                let below = (next - 1.0).powi(2);
                ((2.0 * next + 1.0) * (below - order * order)
                    / ((2.0 * next - 3.0) * (next * next - order * order)))
                    .sqrt()
            };
            let following = z.clone() * here.clone() * a - before * b;
            (before, here) = (here, following);
        }
        let factor = if m == 0 { 3f64.sqrt() } else { ((2.0 * order + 3.0) / (2.0 * order + 2.0)).sqrt() };
        first *= factor;
        (cosine, sine) =
            (x.clone() * cosine.clone() - y.clone() * sine.clone(), y.clone() * cosine + x.clone() * sine);
    }
    values
}

impl SphereSeries {
    /// The harmonics up to a degree at a unit vector, in the order of coefficients.
    pub fn basis(n: &Vector3<f64>, degree: usize) -> Vec<f64> {
        basis(&[n.x, n.y, n.z], degree)
    }

    /// How far the body reaches in the direction of a unit vector, in m.
    pub fn support(&self, n: &Vector3<f64>) -> f64 {
        let basis = SphereSeries::basis(n, self.degree);
        basis.iter().zip(&self.coefficients).map(|(value, c)| value * c).sum()
    }

    /// The point of the body with a unit vector as its outward normal, about the point of reference; and the second derivatives of the support function, continued so that
    /// it is homogeneous of the first degree, whose values along tangents are the radii of curvature.
    pub fn point_and_bend(&self, n: &Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
        let (_, gradient, bend) = hessian(
            |v| {
                let size = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
                let unit = [0, 1, 2].map(|i: usize| v[i] / size);
                let values = basis(&unit, self.degree);
                let zero = size * 0.0;
                let sum =
                    values.into_iter().zip(&self.coefficients).fold(zero, |sum, (value, c)| sum + value * *c);
                sum * size
            },
            n,
        );
        (gradient, bend)
    }

    /// The lesser radius of curvature where a unit vector is the outward normal, in m: a body is convex where it is positive.
    pub fn least_radius(&self, n: &Vector3<f64>) -> f64 {
        let bend = self.point_and_bend(n).1;
        let trace = bend.trace();
        let product = (trace * trace - (bend * bend).trace()) / 2.0;
        trace / 2.0 - (trace * trace / 4.0 - product).max(0.0).sqrt()
    }
}
