//! A smooth convex body in space, by its support function.

use super::Real;
use super::body::ShapeError;
use super::linear::{Vector, dot, sum};
use dashu::base::Abs;
use dashu::rational::RBig;

/// The coefficients of a [`Solid`], lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidShape {
    /// The semi-axes of the ellipsoid.
    pub axes: [RBig; 3],
    /// Its centre, in the frame whose origin is the centre of mass.
    pub centre: [RBig; 3],
    /// The coefficients of `n_x^4`, `n_y^4`, `n_z^4`.
    pub quartic: [RBig; 3],
    /// The coefficient of `n_x n_y n_z`.
    pub cubic: RBig,
}

/// The convex body that reaches, in the direction of a unit vector `n`,
/// `h(n) = sqrt(sum (a_i n_i)^2) + c · n + sum q_i n_i^4 + k n_x n_y n_z`
/// from its centre of mass.
///
/// The first two terms alone are an ellipsoid; the quartic and the cubic harmonic make a body that is none.
/// The boundary point with the outward normal `n` is the gradient of `h`, continued to all of space such that
/// `h(t n) = t h(n)`.
#[derive(Clone, Debug)]
pub struct Solid {
    squares: Vector<3>,
    centre: Vector<3>,
    quartic: Vector<3>,
    cubic: Real,
}

impl Solid {
    /// The body of these coefficients.
    ///
    /// The radii of curvature of an ellipsoid lie above `min a_i^2 / max a_i`. On the unit sphere the second
    /// derivatives along tangents of a form `P` of degree `k`, continued as `P |n|^(1 - k)`, are those of `P` less
    /// `(k - 1) P`. So the quartic takes away at most `12 + 3 = 15` times its largest coefficient, and the cubic
    /// no more than twice its own.
    ///
    /// # Errors
    /// Unless those bounds keep the radii of curvature positive and the centre of mass inside.
    pub fn new(shape: &SolidShape) -> Result<Self, ShapeError> {
        let least = |values: &[RBig; 3]| values.iter().fold(values[0].clone(), |a, b| a.min(b.clone()));
        let greatest = |values: &[RBig; 3]| values.iter().fold(values[0].clone(), |a, b| a.max(b.clone()));
        let size = |values: &[RBig; 3]| greatest(&values.clone().map(Abs::abs));
        let (thin, wide) = (least(&shape.axes), greatest(&shape.axes));
        let (quartic, cubic) = (size(&shape.quartic), shape.cubic.clone().abs());
        let taken = RBig::from(15) * &quartic + RBig::from(2) * &cubic;
        if thin <= RBig::ZERO || &thin * &thin <= taken * wide {
            return Err(ShapeError::NotConvex);
        }
        let offset = shape.centre.iter().fold(RBig::ZERO, |total, c| total + c.clone().abs());
        if thin <= offset + &quartic + &cubic {
            return Err(ShapeError::CentreOutside);
        }
        let real = |values: &[RBig; 3]| values.each_ref().map(Real::from_rational);
        Ok(Solid {
            squares: real(&shape.axes).map(|a| &a * &a),
            centre: real(&shape.centre),
            quartic: real(&shape.quartic),
            cubic: Real::from_rational(&shape.cubic),
        })
    }

    /// The radius of the ellipsoid's support function, and the sums of the two harmonics, in a direction.
    fn terms(&self, n: &Vector<3>) -> (Real, Real, Real) {
        let squares: Vector<3> = std::array::from_fn(|i| &n[i] * &n[i]);
        let fourths: Vector<3> = std::array::from_fn(|i| &squares[i] * &squares[i]);
        let cubic = &self.cubic * &n[0] * &n[1] * &n[2];
        (dot(&self.squares, &squares).sqrt(), dot(&self.quartic, &fourths), cubic)
    }

    /// How far the body reaches in the direction of a unit vector in its frame.
    pub fn support(&self, n: &Vector<3>) -> Real {
        let (ellipsoid, quartic, cubic) = self.terms(n);
        ellipsoid + dot(&self.centre, n) + quartic + cubic
    }

    /// The boundary point whose outward normal is a given unit vector, both in the body's frame.
    pub fn point(&self, n: &Vector<3>) -> Vector<3> {
        let (ellipsoid, quartic, cubic) = self.terms(n);
        // the factor |n|^-3 of the quartic and |n|^-2 of the cubic add these multiples of n at |n| = 1
        let inward = Real::whole(3) * quartic + Real::whole(2) * cubic;
        let gradient: Vector<3> = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            &self.squares[i] * &n[i] / &ellipsoid
                + Real::whole(4) * &self.quartic[i] * &n[i] * &n[i] * &n[i]
                + &self.cubic * &n[j] * &n[k]
                - &inward * &n[i]
        });
        sum(&gradient, &self.centre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_math::number::parse_decimal;

    fn q(text: &str) -> RBig {
        parse_decimal(text).unwrap()
    }

    fn list(text: &str) -> [RBig; 3] {
        let mut items = text.split(' ').map(q);
        std::array::from_fn(|_| items.next().unwrap())
    }

    fn egg(quartic: &str, cubic: &str) -> SolidShape {
        let (axes, centre) = (list("1.2 1 0.9"), list("0.1 -0.05 0.07"));
        SolidShape { axes, centre, quartic: list(quartic), cubic: q(cubic) }
    }

    fn direction(i: i32) -> Vector<3> {
        let angle = |text: f64| {
            Real::from_rational(&palmistry_math::number::rational_from_f64(text).unwrap()).sin_cos()
        };
        let ((s, c), (z, rho)) = (angle(f64::from(i) * 0.71), angle(f64::from(i) * 0.37));
        [c * &rho, s * &rho, z]
    }

    /// The points of the ellipsoid satisfy its equation, and every point of the other body lies in every
    /// supporting half-space.
    #[test]
    fn a_solid_lies_inside_its_tangent_planes() {
        let tiny = Real::power_of_two(-300);
        let ellipsoid = Solid::new(&egg("0 0 0", "0")).unwrap();
        let bumpy = Solid::new(&egg("0.02 -0.015 0.01", "0.03")).unwrap();
        let directions: Vec<_> = (0..40).map(direction).collect();
        for n in &directions {
            let x = ellipsoid.point(n);
            let level = (0..3).fold(Real::zero(), |total, i| {
                let from_centre = &x[i] - &ellipsoid.centre[i];
                total + &from_centre * &from_centre / &ellipsoid.squares[i]
            });
            assert!((level - Real::one()).abs() < tiny);
            let x = bumpy.point(n);
            for other in &directions {
                let room = bumpy.support(other) - dot(&x, other);
                assert!(if n == other { room.abs() < tiny } else { room.is_positive() });
            }
        }
    }

    #[test]
    fn a_solid_that_may_have_a_dent_is_refused() {
        assert_eq!(Solid::new(&egg("0.05 0 0", "0")).err(), Some(ShapeError::NotConvex));
        assert_eq!(Solid::new(&egg("0 0 0", "-0.4")).err(), Some(ShapeError::NotConvex));
        let away = SolidShape { centre: list("0.5 0.4 0.1"), ..egg("0 0 0", "0") };
        assert_eq!(Solid::new(&away).err(), Some(ShapeError::CentreOutside));
        assert_eq!(
            Solid::new(&SolidShape { axes: list("1 0 1"), ..away }).err(),
            Some(ShapeError::NotConvex)
        );
    }
}
