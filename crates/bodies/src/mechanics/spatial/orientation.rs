//! Rotations, kept on their manifold: a quaternion that is only ever multiplied by those of rotation vectors.

use nalgebra::{Matrix3, Quaternion, Vector3};

/// How a body is turned.
///
/// The rotation is that of the quaternion divided by its norm, whatever rounding makes of that: nothing is renormalised, and what
/// is integrated are rotation vectors, three numbers without a constraint between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation(Quaternion<f64>);

/// Below this angle in radians a series is taken where a quotient would lose digits.
const SMALL: f64 = 1e-2;

impl Orientation {
    /// That of the world.
    pub fn upright() -> Orientation {
        Orientation(Quaternion::identity())
    }

    /// The rotation by the length of a vector, in radians, about its direction.
    pub fn by(turn: &Vector3<f64>) -> Orientation {
        let half = turn.norm() / 2.0;
        let (sine, cosine) = half.sin_cos();
        let share = if half < SMALL {
            0.5 * series(half * half, [1.0, -1.0 / 6.0, 1.0 / 120.0])
        } else {
            sine / (2.0 * half)
        };
        Orientation(Quaternion::from_parts(cosine, turn * share))
    }

    /// The rotation after another one in the body's frame.
    pub fn then(&self, own: &Orientation) -> Orientation {
        Orientation(self.0 * own.0)
    }

    /// The matrix that takes the body's frame to the world's.
    pub fn matrix(&self) -> Matrix3<f64> {
        let q = self.0;
        let twice = 2.0 / q.norm_squared();
        let v = q.imag();
        let hat = v.cross_matrix();
        Matrix3::identity() + twice * (q.scalar() * hat + hat * hat)
    }

    /// Scalar and vector part.
    pub fn quaternion(&self) -> [f64; 4] {
        [self.0.w, self.0.i, self.0.j, self.0.k]
    }
}

fn series(x: f64, coefficients: [f64; 3]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// How fast a rotation vector moves that is added in the body's frame, where the body turns at a rate, in its own frame: the inverse
/// of the exponential's derivative (E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, 2006, section IV.7).
pub(super) fn rotation_vector_rate(turn: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let angle = turn.norm();
    // (1 - (a/2) cot(a/2))/a^2
    let share = if angle < SMALL {
        series(angle * angle, [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0])
    } else {
        (1.0 - angle / 2.0 / (angle / 2.0).tan()) / (angle * angle)
    };
    rate + turn.cross(rate) / 2.0 + turn.cross(&turn.cross(rate)) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rodrigues' formula, and the derivative of a rotation by differences.
    #[test]
    fn rotations_and_their_rates() {
        for turn in [[0.3, -0.2, 0.9], [1e-3, 2e-3, -1e-3], [1.9, 0.4, 0.2], [0.0, 0.0, 0.0]] {
            let turn = Vector3::from(turn);
            let own = nalgebra::Rotation3::new(turn).into_inner();
            assert!((Orientation::by(&turn).matrix() - own).norm() < 1e-14);
            let rate = Vector3::new(0.4, -1.1, 0.7);
            let moved = rotation_vector_rate(&turn, &rate);
            let step = 1e-5;
            let at = |t: f64| Orientation::by(&(turn + moved * t)).matrix();
            let change = at(0.0).transpose() * (at(step) - at(-step)) / (2.0 * step);
            assert!((change - rate.cross_matrix()).norm() < 1e-9, "{turn}");
        }
        let (a, b) = (Vector3::new(0.3, 0.1, -0.5), Vector3::new(-0.2, 0.7, 0.4));
        let both = Orientation::by(&a).then(&Orientation::by(&b)).matrix();
        assert!((both - Orientation::by(&a).matrix() * Orientation::by(&b).matrix()).norm() < 1e-14);
    }
}
