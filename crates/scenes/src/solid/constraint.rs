//! The constraint at every sample, with its derivatives in all directions.

use super::flow::{DIRECTIONS, Start, Turned, own_rate, turned};
use super::integrals::{Integrals, Node};
use super::surface::PalmSample;
use super::vector::{Vector, along, cross, dot, scaled, times, unit};

/// One sample: the three constraints and what they depend on.
#[derive(Clone, Debug)]
pub(super) struct Constrained {
    pub value: [f64; 3],
    /// A row a palm.
    pub by: [[f64; DIRECTIONS]; 3],
    /// The derivatives of each by its contact's two coordinates.
    pub slopes: [[f64; 2]; 3],
    pub centre: Vector,
    pub at: Turned<DIRECTIONS>,
}

/// The velocity of the body at a contact against that of the palm, along the normal.
fn approach(palm: &PalmSample, hinge_to: f64, centre: &Vector, velocity: &Vector, omega: &Vector) -> f64 {
    let arm = along(&palm.contact, -1.0, centre);
    dot(&palm.normal, &along(velocity, 1.0, &cross(omega, &arm))) - palm.rate * hinge_to
}

/// The values alone.
pub(super) fn values(start: &Start, all: &Integrals) -> Vec<[f64; 3]> {
    let path = turned::<0>(start, all);
    let at = |(k, here): (usize, &Turned<0>)| {
        let node: &Node = &all.nodes[k];
        let (own, _) = own_rate(start, node, &all.gravity, here);
        let omega = times(&here.turn, &own);
        let centre = start.centre_at(node, &all.gravity);
        let velocity = start.velocity_at(node, &all.gravity);
        let palms = &all.palms[k];
        // n . (w axis x (contact - hinge)) = w lever
        let value = |i: usize| approach(&palms[i], palms[i].lever, &centre, &velocity, &omega);
        std::array::from_fn(value)
    };
    path.iter().enumerate().map(at).collect()
}

/// Values and derivatives.
pub(super) fn expanded(start: &Start, all: &Integrals) -> Vec<Constrained> {
    let path = turned::<DIRECTIONS>(start, all);
    path.iter().enumerate().map(|(k, here)| sample(start, all, k, here)).collect()
}

fn sample(start: &Start, all: &Integrals, k: usize, here: &Turned<DIRECTIONS>) -> Constrained {
    let node = &all.nodes[k];
    let (own, changes) = own_rate(start, node, &all.gravity, here);
    let omega = times(&here.turn, &own);
    let centre = start.centre_at(node, &all.gravity);
    let velocity = start.velocity_at(node, &all.gravity);
    let place = node.place();
    let palms = &all.palms[k];
    let mut found = Constrained {
        value: std::array::from_fn(|i| approach(&palms[i], palms[i].lever, &centre, &velocity, &omega)),
        by: [[0.0; DIRECTIONS]; 3],
        slopes: std::array::from_fn(|i| {
            let arm = along(&palms[i].contact, -1.0, &centre);
            palms[i].slopes(&omega, &along(&velocity, 1.0, &cross(&omega, &arm)))
        }),
        centre,
        at: *here,
    };
    for direction in 0..DIRECTIONS {
        let spun = along(&changes[direction], 1.0, &cross(&here.moved[direction], &own));
        let spun = times(&here.turn, &spun);
        let (moved, sped) = match direction {
            0..3 => (unit(direction), [0.0; 3]),
            3..6 => (scaled(node.time, &unit(direction - 3)), unit(direction - 3)),
            super::flow::MU => (place, node.force),
            _ => ([0.0; 3], [0.0; 3]),
        };
        for i in 0..3 {
            let palm = &palms[i];
            let arm = along(&palm.contact, -1.0, &centre);
            let change = along(&along(&sped, 1.0, &cross(&spun, &arm)), -1.0, &cross(&omega, &moved));
            found.by[i][direction] = dot(&palm.normal, &change);
        }
    }
    found
}
