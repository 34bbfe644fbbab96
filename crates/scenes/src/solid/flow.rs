//! The orientation of the body at every sample, and its derivatives by everything that it depends on.
//!
//! `R' = R hat(K R^T l)` by the method of J. C. Butcher with seven stages and order six (On Runge-Kutta processes of high order, J. Austral. Math. Soc. 4, 1964), and with it `xi`, the change `R hat(xi)` of `R`
//! by each of 19 directions:
//!
//! ```text
//! xi' = K (R^T dl + R^T l x xi) + dK R^T l - K R^T l x xi
//! ```

use super::integrals::{Integrals, Node, Step};
use super::vector::{IDENTITY, Matrix, Vector, along, back, cross, scaled, symmetric, times, unit};

/// Centre, velocity, momentum, an additional turn at the first sample, `K`, `mu`: three each, then six and one.
pub(super) const DIRECTIONS: usize = 19;
pub(super) const MOMENTUM: usize = 6;
pub(super) const TURN: usize = 9;
pub(super) const INVERSE: usize = 12;
pub(super) const MU: usize = 18;

/// The initial state and the parameters of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Start {
    pub centre: Vector,
    pub velocity: Vector,
    /// The angular velocity.
    pub rate: Vector,
    /// Entries 11, 22, 33, 12, 13, 23 of the inverse of the inertia over mass.
    pub inverse: [f64; 6],
    /// The angular momentum over mass: `inverse` times this is `rate`.
    pub momentum: Vector,
    /// One over mass.
    pub mu: f64,
}

/// `N` is 0 where no derivatives are needed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turned<const N: usize> {
    pub turn: Matrix,
    pub moved: [Vector; N],
}

impl Start {
    pub fn centre_at(&self, node: &Node, gravity: &Vector) -> Vector {
        let steady =
            along(&along(&self.centre, node.time, &self.velocity), node.time * node.time / 2.0, gravity);
        along(&steady, self.mu, &node.place())
    }

    pub fn velocity_at(&self, node: &Node, gravity: &Vector) -> Vector {
        along(&along(&self.velocity, node.time, gravity), self.mu, &node.force)
    }

    /// The angular momentum over mass, and its derivative by `mu`.
    pub fn momentum_at(&self, node: &Node, gravity: &Vector) -> (Vector, Vector) {
        let drawn = along(&node.moment, -1.0, &cross(&self.centre, &node.force));
        let drawn = along(&drawn, -1.0, &cross(&self.velocity, &node.first));
        let drawn = along(&drawn, -0.5, &cross(gravity, &node.second));
        let l = along(&along(&self.momentum, self.mu, &drawn), -self.mu * self.mu, &node.moved);
        (l, along(&drawn, -2.0 * self.mu, &node.moved))
    }

    /// The derivative of the momentum in a direction, `by_mu` its derivative by `mu`.
    pub fn momentum_along(&self, node: &Node, by_mu: &Vector, direction: usize) -> Vector {
        match direction {
            0..3 => scaled(-self.mu, &cross(&unit(direction), &node.force)),
            3..6 => scaled(-self.mu, &cross(&unit(direction - 3), &node.first)),
            MOMENTUM..TURN => unit(direction - MOMENTUM),
            MU => *by_mu,
            _ => [0.0; 3],
        }
    }
}

/// The angular velocity in the body's frame, and its derivative in each direction.
pub(super) fn own_rate<const N: usize>(
    start: &Start,
    node: &Node,
    gravity: &Vector,
    at: &Turned<N>,
) -> (Vector, [Vector; N]) {
    let k = symmetric(&start.inverse);
    let (l, by_mu) = start.momentum_at(node, gravity);
    let own = back(&at.turn, &l);
    let mut changes = [[0.0; 3]; N];
    for (direction, change) in changes.iter_mut().enumerate() {
        let mut moved = cross(&own, &at.moved[direction]);
        if !(TURN..MU).contains(&direction) {
            let dl = start.momentum_along(node, &by_mu, direction);
            moved = along(&moved, 1.0, &back(&at.turn, &dl));
        }
        *change = times(&k, &moved);
        if (INVERSE..MU).contains(&direction) {
            let (i, j) = super::vector::PLACES[direction - INVERSE];
            change[i] += own[j];
            if i != j {
                change[j] += own[i];
            }
        }
    }
    (times(&k, &own), changes)
}

fn slope<const N: usize>(start: &Start, node: &Node, gravity: &Vector, at: &Turned<N>) -> Turned<N> {
    let (rate, mut moved) = own_rate(start, node, gravity, at);
    for (change, xi) in moved.iter_mut().zip(&at.moved) {
        *change = along(change, -1.0, &cross(&rate, xi));
    }
    // each row of R hat(w) is the row's vector product with w
    Turned { turn: at.turn.map(|row| cross(&row, &rate)), moved }
}

fn added<const N: usize>(from: &Turned<N>, length: f64, slopes: &[Turned<N>], by: &[f64]) -> Turned<N> {
    let mut sum = *from;
    for (slope, by) in slopes.iter().zip(by) {
        if *by == 0.0 {
            continue;
        }
        let t = length * by;
        for (row, change) in sum.turn.iter_mut().zip(&slope.turn) {
            *row = along(row, t, change);
        }
        for (xi, change) in sum.moved.iter_mut().zip(&slope.moved) {
            *xi = along(xi, t, change);
        }
    }
    sum
}

/// The stages after the first: the node, and the weights of the slopes before.
const STAGES: [(usize, &[f64]); 6] = [
    (0, &[1.0 / 3.0]),
    (2, &[0.0, 2.0 / 3.0]),
    (0, &[1.0 / 12.0, 1.0 / 3.0, -1.0 / 12.0]),
    (1, &[-1.0 / 16.0, 9.0 / 8.0, -3.0 / 16.0, -3.0 / 8.0]),
    (1, &[0.0, 9.0 / 8.0, -3.0 / 8.0, -3.0 / 4.0, 1.0 / 2.0]),
    (3, &[9.0 / 44.0, -9.0 / 11.0, 63.0 / 44.0, 18.0 / 11.0, 0.0, -16.0 / 11.0]),
];
const PARTS: [f64; 7] = [11.0 / 120.0, 0.0, 27.0 / 40.0, 27.0 / 40.0, -4.0 / 15.0, -4.0 / 15.0, 11.0 / 120.0];

fn stepped<const N: usize>(
    start: &Start,
    begin: &Node,
    step: &Step,
    gravity: &Vector,
    from: &Turned<N>,
) -> Turned<N> {
    let mut slopes = vec![slope(start, begin, gravity, from)];
    for (node, by) in STAGES {
        let there = added(from, step.length, &slopes, by);
        slopes.push(slope(start, &step.nodes[node], gravity, &there));
    }
    added(from, step.length, &slopes, &PARTS)
}

/// The orientation of the body at each sample that is used.
pub(super) fn turned<const N: usize>(start: &Start, all: &Integrals) -> Vec<Turned<N>> {
    let mut moved = [[0.0; 3]; N];
    for (i, xi) in moved.iter_mut().skip(TURN).take(3).enumerate() {
        xi[i] = 1.0;
    }
    let mut here = Turned { turn: IDENTITY, moved };
    let mut path = vec![here];
    for (step, begin) in all.steps.iter().zip(&all.nodes) {
        here = stepped(start, begin, step, &all.gravity, &here);
        path.push(here);
    }
    path
}
