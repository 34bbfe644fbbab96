//! A planar body between two palms that it touches both.

use super::linear::{Vector, cross_planar, difference, dot, solve, sum};
use super::{PlanarBody, Real};

/// Angles in radians: how the body and the palms lie.
///
/// The palms are lines through the origin of the world. Palm 1 makes the angle `phi1` with the X axis, palm 2
/// the angle `phi2` with palm 1; the body lies between them and is turned by `phi0` (section 3.1 of the
/// thesis).
#[derive(Clone, Debug)]
pub struct Angles {
    pub phi0: Real,
    pub phi1: Real,
    pub phi2: Real,
}

/// One contact.
#[derive(Clone, Debug)]
pub struct Contact {
    /// The palm's unit tangent, as the thesis turns it: from the origin on palm 1, towards the origin on palm
    /// 2.
    pub tangent: Vector<2>,
    /// The palm's unit normal, towards the body.
    pub normal: Vector<2>,
    /// The contact in the world.
    pub world: Vector<2>,
    /// The contact in the body's frame.
    pub body: Vector<2>,
    /// The distance from the origin along the palm, which the sensor measures: `s` of the thesis.
    pub s: Real,
    /// The projection of the contact, in the body's frame, on the outward normal there: `r` of the thesis.
    pub r: Real,
    /// Its projection on the tangent `t`, a quarter turn clockwise from the outward normal: `d` of the
    /// thesis.
    pub d: Real,
    /// The body's outward normal at the contact, in the body's frame.
    pub outward: Vector<2>,
}

/// A body in two-point contact.
#[derive(Clone, Debug)]
pub struct Placement {
    /// The centre of mass in the world.
    pub centre: Vector<2>,
    /// The contacts with palm 1 and palm 2.
    pub contacts: [Contact; 2],
}

/// Turns a vector by the angle whose sine and cosine are given.
fn turned(v: &Vector<2>, (sine, cosine): &(Real, Real)) -> Vector<2> {
    [cosine * &v[0] - sine * &v[1], sine * &v[0] + cosine * &v[1]]
}

/// Lays the body between the palms so that it touches both, in the given orientation.
///
/// Which boundary points touch is decided by the normals; where the centre of mass then lies, by the two
/// conditions that no point of the body is behind a palm and one is on it. Undefined numbers come out where
/// the palms are parallel.
pub fn place(body: &PlanarBody, angles: &Angles) -> Placement {
    let turn = angles.phi0.sin_cos();
    let back = (-&turn.0, turn.1.clone());
    let (sine1, cosine1) = angles.phi1.sin_cos();
    let (sine2, cosine2) = (&angles.phi1 + &angles.phi2).sin_cos();
    let palms = [
        ([cosine1.clone(), sine1.clone()], [-&sine1, cosine1.clone()]),
        ([-&cosine2, -&sine2], [sine2.clone(), -&cosine2]),
    ];
    let outward = [0, 1].map(|i: usize| turned(&[-&palms[i].1[0], -&palms[i].1[1]], &back));
    let rows = [palms[0].1.clone(), palms[1].1.clone()];
    // the lowest point over a palm is as far below the centre of mass as the body reaches towards the palm
    let centre = solve(rows, [body.support(&outward[0]), body.support(&outward[1])]);
    let contact = |i: usize| {
        let (tangent, normal) = palms[i].clone();
        let x = body.point(&outward[i]);
        let world = sum(&centre, &turned(&x, &turn));
        let along = dot(&world, &tangent);
        let clockwise = [outward[i][1].clone(), -&outward[i][0]];
        Contact {
            s: if i == 0 { along } else { -along },
            r: dot(&x, &outward[i]),
            d: dot(&x, &clockwise),
            outward: outward[i].clone(),
            body: x,
            tangent,
            normal,
            world,
        }
    };
    Placement { contacts: [contact(0), contact(1)], centre }
}

impl Placement {
    /// The moment about the centre of mass of a unit force that palm `i` (0 or 1) exerts on the body; undefined
    /// for any other `i`.
    pub fn moment(&self, i: usize) -> Real {
        let moment =
            |contact: &Contact| cross_planar(&difference(&contact.world, &self.centre), &contact.normal);
        self.contacts.get(i).map_or(Real::UNDEFINED, moment)
    }
}
