//! A body in space on three palms that it touches all.

use super::linear::{Square, Vector, apply, dot, product, solve, sum, transposed};
use super::{Real, Solid};

/// The frame of a palm as a matrix of rows: its axis of rotation, the direction up the palm, and the normal
/// towards the body (`t_i1`, `t_i2`, `n_i` of section 5.1, in the world).
///
/// A palm is a plane through the origin that turns about its horizontal line. `azimuth` is the direction in
/// which it rises, an angle from the X axis; `angle` is how steeply, from the horizontal. Both in radians.
pub fn palm_frame(azimuth: &Real, angle: &Real) -> Square<3> {
    let ((sa, ca), (s, c)) = (azimuth.sin_cos(), angle.sin_cos());
    [[sa.clone(), -&ca, Real::zero()], [&c * &ca, &c * &sa, s.clone()], [-(&s * &ca), -(&s * &sa), c]]
}

/// The rotation by an angle, in radians, about a coordinate axis (0, 1, 2 for X, Y, Z).
pub fn rotation_about(axis: usize, angle: &Real) -> Square<3> {
    let (sine, cosine) = angle.sin_cos();
    let entry = |i: usize, j: usize| match ((i + 3 - axis % 3) % 3, (j + 3 - axis % 3) % 3) {
        (0, 0) => Real::one(),
        (1, 1) | (2, 2) => cosine.clone(),
        (1, 2) => -&sine,
        (2, 1) => sine.clone(),
        _ => Real::zero(),
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// The rotation by `a` about Z, after `b` about X, after `c` about Z, of the angles `[a, b, c]` in radians.
pub fn rotation(angles: &Vector<3>) -> Square<3> {
    let [a, b, c] = angles;
    product(&rotation_about(2, a), &product(&rotation_about(0, b), &rotation_about(2, c)))
}

/// One contact in space.
#[derive(Clone, Debug)]
pub struct SolidContact {
    /// The contact in the world: `c_i`.
    pub world: Vector<3>,
    /// The contact in the body's frame: `beta_i`.
    pub body: Vector<3>,
    /// The outward normal in the body's frame: `n_i`.
    pub outward: Vector<3>,
    /// The contact in the palm's frame, which the sensor measures: `s_i`. The third component is zero.
    pub sensed: Vector<3>,
}

/// A body in three-point contact.
#[derive(Clone, Debug)]
pub struct Grip {
    /// The centre of mass in the world.
    pub centre: Vector<3>,
    pub contacts: [SolidContact; 3],
}

/// Lays the body on the palms so that it touches all three, in the given orientation. Undefined numbers come
/// out where the palms have a line in common.
pub fn grip(solid: &Solid, turn: &Square<3>, palms: &[Square<3>; 3]) -> Grip {
    let back = transposed(turn);
    let normals = palms.each_ref().map(|palm| palm[2].clone());
    let outward = normals.each_ref().map(|n| apply(&back, &n.each_ref().map(|x| -x)));
    let centre = solve(normals, outward.each_ref().map(|n| solid.support(n)));
    Grip::about(solid, turn, palms, centre, outward)
}

impl Grip {
    /// With the centre of mass in its place and the outward normals at the contacts, in the body's frame.
    pub(super) fn about(
        solid: &Solid,
        turn: &Square<3>,
        palms: &[Square<3>; 3],
        centre: Vector<3>,
        outward: [Vector<3>; 3],
    ) -> Grip {
        let contacts = std::array::from_fn(|i| {
            let body = solid.point(&outward[i]);
            let world = sum(&centre, &apply(turn, &body));
            let sensed = palms[i].each_ref().map(|axis| dot(axis, &world));
            SolidContact { world, body, outward: outward[i].clone(), sensed }
        });
        Grip { centre, contacts }
    }
}
