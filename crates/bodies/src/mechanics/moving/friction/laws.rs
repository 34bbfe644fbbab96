//! Newton's and Euler's laws in a pair of modes: linear equations for accelerations and contact forces.
//!
//! The body's point at the contact moves relative to palm `i` with `u = c' + omega0 JX - w Jp`, where `X` and `p` are the contact from the
//! centre of mass and from the origin; `t · u` is how fast it slides and `n · u` is zero. In the palm's frame, which turns at `w`,
//!
//! ```text
//! (t · u)' = t · u' + w n · u = t · u'
//! (n · u)' = n · u' - w t · u = 0
//! u' = c'' + alpha0 JX + omega0 JX' - A Jp - w Jp',    X' = omega0 JX + v (w - omega0) t,    p' = c' + X'
//! ```
//!
//! with the radius of curvature `v`. The unknowns are `c''`, `alpha0`, both palms' accelerations `A`, and normal force and friction at both contacts; the
//! equations are Newton's and Euler's laws, the palms' own, `(n · u)' = 0`, and of each contact either `F = -mu sign N` or `(t · u)' = 0`.

use super::modes::{ContactMode, ModePair};
use crate::mechanics::moving::drive::Drive;
use crate::mechanics::moving::laws::{Situation, State, Touching};
use crate::mechanics::moving::plane::{Plane, along, cross, difference, dot, left_of, scaled, unit};
use crate::mechanics::moving::scene::MovingScene;

const UNKNOWNS: usize = 9;

/// Where the unknowns stand: accelerations of the centre, of the body's angle, of the palms; then normal force and friction of each palm.
const ALPHA: usize = 2;
const PALM: usize = 3;
const NORMAL: usize = 5;
const FRICTION: usize = 6;

/// What is known at one moment in a pair of modes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rubbing {
    pub situation: Situation,
    /// Along the tangents as the thesis turns them, on the body.
    pub friction: [f64; 2],
    /// How fast the body slides along them, in m/s, and how fast that changes.
    pub slips: [f64; 2],
    pub slip_rates: [f64; 2],
    /// How far what sticks is from the edges of its cones, in N: negative where it cannot be held. None where nothing sticks.
    pub slack: Option<f64>,
    /// The largest of all numbers that were solved for: what rounding is measured by.
    pub largest: f64,
}

impl Rubbing {
    /// Not finite where the equations have no solution.
    pub(super) fn at(
        scene: &MovingScene,
        coefficient: f64,
        pair: ModePair,
        time: f64,
        state: &State,
    ) -> Rubbing {
        let (phi0, omega0) = (state[0], state[1]);
        let world = scene.palms_at(time, state);
        let touching = Touching::of(scene, &world, [phi0, omega0]);
        let (normals, rates) = (touching.normals, touching.rates);
        let tangents = normals.map(|normal| scaled(-1.0, left_of(normal)));
        let slides = |i: usize| {
            let palm = along(touching.velocity, -rates[i], left_of(touching.contacts[i]));
            dot(tangents[i], along(palm, omega0, left_of(touching.arms[i])))
        };
        let slips = [slides(0), slides(1)];
        // u' but for what the unknowns make of it
        let rest = [0, 1].map(|i: usize| {
            let [h, _, second] = touching.support[i];
            let over_the_body = scaled((h + second) * touching.swept[i], tangents[i]);
            let arm_rate = along(over_the_body, omega0, left_of(touching.arms[i]));
            let contact_rate = along(touching.velocity, 1.0, arm_rate);
            along(scaled(omega0, left_of(arm_rate)), -rates[i], left_of(contact_rate))
        });

        let (mass, inertia) = (scene.mass, scene.mass * scene.gyration * scene.gyration);
        let mut rows = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut right = [0.0; UNKNOWNS];
        (rows[0][0], rows[1][1]) = (mass, mass);
        rows[ALPHA][ALPHA] = inertia;
        right[1] = mass * scene.gravity;
        // what a unit of each unknown adds to the acceleration of the body's point at the contact, along a direction
        let point_row = |i: usize, direction: Plane| {
            let mut row = [0.0; UNKNOWNS];
            (row[0], row[1]) = (direction[0], direction[1]);
            row[ALPHA] = dot(direction, left_of(touching.arms[i]));
            row[PALM + i] = -dot(direction, left_of(touching.contacts[i]));
            row
        };
        for i in 0..2 {
            let (normal, friction) = (NORMAL + 2 * i, FRICTION + 2 * i);
            for (column, direction) in [(normal, normals[i]), (friction, tangents[i])] {
                rows[0][column] = -direction[0];
                rows[1][column] = -direction[1];
                rows[ALPHA][column] = -cross(touching.arms[i], direction);
            }
            match &scene.drive {
                Drive::Prescribed(_) => {
                    (rows[PALM + i][PALM + i], right[PALM + i]) = (1.0, world[i][2]);
                }
                Drive::Torques(palms) => {
                    rows[PALM + i][PALM + i] = scene.palm_inertia[i];
                    // friction has no lever about the joint of a flat palm
                    rows[PALM + i][normal] = cross(touching.contacts[i], normals[i]);
                    right[PALM + i] = palms[i].torque_at(time);
                }
            }
            rows[normal] = point_row(i, normals[i]);
            right[normal] = rates[i] * slips[i] - dot(normals[i], rest[i]);
            match pair.0[i] {
                ContactMode::Sticks => {
                    rows[friction] = point_row(i, tangents[i]);
                    right[friction] = -dot(tangents[i], rest[i]);
                }
                slides => {
                    (rows[friction][friction], rows[friction][normal]) = (1.0, coefficient * slides.sense());
                }
            }
        }
        let stuck = pair.0 == [ContactMode::Sticks; 2];
        let told = matches!(scene.drive, Drive::Prescribed(_));
        let between = difference(touching.contacts[1], touching.contacts[0]);
        let squeeze = scaled(1.0 / between[0].hypot(between[1]), between);
        if stuck && told {
            // four equations for three accelerations, of which one follows from the others where palms turn as one; and three for
            // four forces: at first neither contact squeezes the body against the other
            let mut row = [0.0; UNKNOWNS];
            for (i, sign) in [(0, 1.0), (1, -1.0)] {
                row[NORMAL + 2 * i] = sign * dot(squeeze, normals[i]);
                row[FRICTION + 2 * i] = sign * dot(squeeze, tangents[i]);
            }
            (rows[FRICTION + 2], right[FRICTION + 2]) = (row, 0.0);
        }
        let mut found = solve(rows, right);
        let mut slack = None;
        let holding = |found: &[f64; UNKNOWNS], i: usize| {
            coefficient * found[NORMAL + 2 * i] - found[FRICTION + 2 * i].abs()
        };
        if stuck && told {
            let by: [[f64; 2]; 2] = [(0, 1.0), (1, -1.0)]
                .map(|(i, sign): (usize, f64)| [normals[i], tangents[i]].map(|way| sign * dot(squeeze, way)));
            let forces = [0, 1].map(|i: usize| [found[NORMAL + 2 * i], found[FRICTION + 2 * i]]);
            let (least, width) = squeezed(coefficient, forces, by);
            for i in 0..2 {
                found[NORMAL + 2 * i] += least * by[i][0];
                found[FRICTION + 2 * i] += least * by[i][1];
            }
            slack = Some(width);
        } else {
            for i in (0..2).filter(|&i| pair.0[i] == ContactMode::Sticks) {
                let here = holding(&found, i);
                slack = Some(slack.map_or(here, |other: f64| other.min(here)));
            }
        }
        let slip_rate = |i: usize| {
            let row = point_row(i, tangents[i]);
            row.iter().zip(&found).map(|(a, b)| a * b).sum::<f64>() + dot(tangents[i], rest[i])
        };
        let forces = [found[NORMAL], found[NORMAL + 2]];
        let levers = [0, 1].map(|i: usize| cross(touching.contacts[i], normals[i]));
        let (accelerations, torques) = scene.accelerations_and_torques(time, &world, levers, forces);
        Rubbing {
            friction: [found[FRICTION], found[FRICTION + 2]],
            slip_rates: [slip_rate(0), slip_rate(1)],
            slips,
            slack,
            largest: found.iter().fold(0.0, |most: f64, x| most.max(x.abs())),
            situation: Situation {
                alpha0: found[ALPHA],
                centre: touching.centre,
                velocity: touching.velocity,
                angles: touching.angles,
                rates,
                accelerations,
                s: [0, 1].map(|i: usize| dot(touching.contacts[i], unit(touching.angles[i]))),
                r: touching.support.map(|support| support[0]),
                d: touching.support.map(|support| -support[1]),
                forces,
                torques,
                opening: (touching.angles[1] - touching.angles[0]).sin(),
            },
        }
    }
}

/// The squeeze nearest to none with which the forces of both contacts are within their cones, and how far the squeezes that do reach from
/// the least to the greatest: negative where there is none. For rigid bodies the squeeze is indeterminate.
fn squeezed(coefficient: f64, forces: [[f64; 2]; 2], by: [[f64; 2]; 2]) -> (f64, f64) {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..2 {
        for side in [-1.0, 1.0] {
            // coefficient * normal + side * friction >= 0
            let at_none = coefficient * forces[i][0] + side * forces[i][1];
            let slope = coefficient * by[i][0] + side * by[i][1];
            match slope {
                _ if slope > 0.0 => low = low.max(-at_none / slope),
                _ if slope < 0.0 => high = high.min(-at_none / slope),
                _ if at_none < 0.0 => return (0.0, at_none),
                _ => (),
            }
        }
    }
    let least = if low > high { (low + high) / 2.0 } else { 0.0_f64.clamp(low, high) };
    (least, (high - low).min(f64::MAX))
}

/// Gauss's elimination with the largest pivot of each column; not finite where the matrix is singular.
fn solve(mut rows: [[f64; UNKNOWNS]; UNKNOWNS], mut right: [f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
    for column in 0..UNKNOWNS {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (column..UNKNOWNS).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(column);
        rows.swap(column, pivot);
        right.swap(column, pivot);
        for row in column + 1..UNKNOWNS {
            let factor = rows[row][column] / rows[column][column];
            let (above, below) = rows.split_at_mut(row);
            for (own, upper) in below[0].iter_mut().zip(&above[column]).skip(column) {
                *own -= factor * upper;
            }
            right[row] -= factor * right[column];
        }
    }
    let mut found = [0.0; UNKNOWNS];
    for row in (0..UNKNOWNS).rev() {
        let known: f64 = (row + 1..UNKNOWNS).map(|column| rows[row][column] * found[column]).sum();
        found[row] = (right[row] - known) / rows[row][row];
    }
    found
}
