//! The height of the centre of mass of a body that touches both palms, with its derivatives.

use crate::mechanics::moving::Shape;
use std::f64::consts::FRAC_PI_2;
use std::ops::{Add, Mul};

/// A body as this module needs it. Closures from an angle to `[h, h', h'']` are bodies, too.
pub trait ConvexBody: Sync {
    /// The support function about the centre of mass and its first two derivatives, `[h, h', h'']` in metres, at the outward normal with this angle in the
    /// body's frame, in radians. It has the period of a turn, and `h + h''` is positive.
    fn support(&self, angle: f64) -> [f64; 3];
}

impl ConvexBody for Shape {
    fn support(&self, angle: f64) -> [f64; 3] {
        Shape::support(self, angle)
    }
}

impl<F: Fn(f64) -> [f64; 3] + Sync> ConvexBody for F {
    fn support(&self, angle: f64) -> [f64; 3] {
        self(angle)
    }
}

/// A function of `phi0`, `phi1`, `phi2` with its derivatives, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Potential {
    /// In metres: the height of the centre of mass over the palms' joint.
    pub value: f64,
    /// In metres per radian. The first is zero in equilibrium.
    pub gradient: [f64; 3],
    /// Symmetric, in metres per square radian. The first of the first row is positive at a stable pose, zero at a fold (3.43).
    pub hessian: [[f64; 3]; 3],
}

impl Potential {
    /// The function `f` of `weights · (phi0, phi1, phi2)`, `f` and its two derivatives given there.
    fn of([f, slope, second]: [f64; 3], weights: [f64; 3]) -> Potential {
        Potential {
            value: f,
            gradient: weights.map(|w| w * slope),
            hessian: weights.map(|w| weights.map(|v| w * v * second)),
        }
    }

    /// How the pose follows the palms while it is in equilibrium: `d phi0/d phi1` and `d phi0/d phi2`; not finite at a fold.
    pub fn following(&self) -> [f64; 2] {
        [1, 2].map(|k: usize| -self.hessian[0][k] / self.hessian[0][0])
    }
}

impl Add for Potential {
    type Output = Potential;
    fn add(self, other: Potential) -> Potential {
        Potential {
            value: self.value + other.value,
            gradient: std::array::from_fn(|i| self.gradient[i] + other.gradient[i]),
            hessian: std::array::from_fn(|i| {
                std::array::from_fn(|j| self.hessian[i][j] + other.hessian[i][j])
            }),
        }
    }
}

// a product of functions has sums in its derivatives
#[allow(clippy::suspicious_arithmetic_impl)]
impl Mul for Potential {
    type Output = Potential;
    fn mul(self, other: Potential) -> Potential {
        let (a, b) = (&self, &other);
        Potential {
            value: a.value * b.value,
            gradient: std::array::from_fn(|i| a.gradient[i] * b.value + a.value * b.gradient[i]),
            hessian: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    a.hessian[i][j] * b.value
                        + a.gradient[i] * b.gradient[j]
                        + a.gradient[j] * b.gradient[i]
                        + a.value * b.hessian[i][j]
                })
            }),
        }
    }
}

/// The outward normals at both contacts, as angles in the body's frame.
pub(super) fn normals(phi0: f64, [phi1, phi2]: [f64; 2]) -> [f64; 2] {
    [phi1 - phi0 - FRAC_PI_2, phi1 + phi2 - phi0 - 3.0 * FRAC_PI_2]
}

/// The height of the centre of mass with its first and second derivatives by `phi0`, `phi1`, `phi2`; not finite where `sin phi2` vanishes.
pub fn potential<B: ConvexBody + ?Sized>(body: &B, phi0: f64, palms: [f64; 2]) -> Potential {
    let [phi1, phi2] = palms;
    let support = normals(phi0, palms).map(|angle| body.support(angle));
    let sine_of = |angle: f64, weights: [f64; 3]| {
        let (sine, cosine) = angle.sin_cos();
        Potential::of([sine, cosine, -sine], weights)
    };
    let (sine, cosine) = phi2.sin_cos();
    let cosecant = [1.0 / sine, -cosine / (sine * sine), (1.0 + cosine * cosine) / (sine * sine * sine)];
    let first = sine_of(phi1 + phi2, [0.0, 1.0, 1.0]) * Potential::of(support[0], [-1.0, 1.0, 0.0]);
    let second = sine_of(phi1, [0.0, 1.0, 0.0]) * Potential::of(support[1], [-1.0, 1.0, 1.0]);
    (first + second) * Potential::of(cosecant, [0.0, 0.0, 1.0])
}

/// The contacts of a body that touches both palms, its centre of mass and the contact forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestingContacts {
    /// The distances of the contacts from the joint along the palms: what the sensors measure, in metres.
    pub s: [f64; 2],
    /// The support radii at the contacts.
    pub r: [f64; 2],
    /// Minus their derivatives by the normal's angle.
    pub d: [f64; 2],
    /// The centre of mass in the world.
    pub centre: [f64; 2],
    /// The contact forces that carry the weight, relative to it; their torque about the centre of mass is not zero unless the pose is in equilibrium.
    pub forces: [f64; 2],
}

/// The contacts of a body in a pose, in equilibrium or not.
pub fn contacts_at_rest<B: ConvexBody + ?Sized>(body: &B, phi0: f64, palms: [f64; 2]) -> RestingContacts {
    let [phi1, phi2] = palms;
    let support = normals(phi0, palms).map(|angle| body.support(angle));
    let ([r1, r2], d) = ([support[0][0], support[1][0]], [-support[0][1], -support[1][1]]);
    let ((sine1, cosine1), (sine2, cosine2), (sine12, cosine12)) =
        (phi1.sin_cos(), phi2.sin_cos(), (phi1 + phi2).sin_cos());
    // n_1 = (-sin phi1, cos phi1) and n_2 = (sin phi12, -cos phi12), n_i · c = r_i
    let centre = [(cosine12 * r1 + cosine1 * r2) / sine2, (sine12 * r1 + sine1 * r2) / sine2];
    // the contact is c - r_i n_i and a piece along the palm: the body's tangent there, d_i along it, is the palm's direction turned round
    let s = [(r1 * cosine2 + r2) / sine2 - d[0], (r2 * cosine2 + r1) / sine2 + d[1]];
    RestingContacts { s, r: [r1, r2], d, centre, forces: [sine12 / sine2, sine1 / sine2] }
}
