//! The state of a body in space on three palms, flat or spherical, from their measurements, without a first guess and without its shape.
//!
//! The constraint of palm `i` on a body of unknown shape is
//!
//! ```text
//! 0 = y_i = n_i . (c' + omega x (c_i - c) - w_i x (c_i - o_i)),
//! ```
//!
//! with the contact `c_i`, the normal `n_i`, the hinge `o_i` and the palm's rate `w_i` as measured. A contact lies `p` along the hinge and `q` up the palm, and the
//! force along the normal follows from the motor's torque: `f q = torque - I w'`. On a sphere that is fixed to a palm these two determine height and normal as well (`surface`), and the lever
//! `a . ((c_i - o_i) x n_i)` about the hinge's axis stands in the place of `q`. With the sums `F` and `G` of forces and of their moments about the origin, Newton's and Euler's
//! laws are integrals of measurements, polynomial in the centre `c0`, its velocity `v0`, the angular momentum over mass `l0` and `mu = 1/m`,
//!
//! ```text
//! c(t) = c0 + v0 t + g t^2/2 + mu S(t),                                   S'' = F,
//! l(t) = l0 + mu (int G - c0 x int F - v0 x int t F - g/2 x int t^2 F - mu int S x F),
//! ```
//!
//! and only the orientation of the body has to be integrated again for every guess, `R' = R hat(K R^T l)`, `R = 1` at the first sample: `K` is the inverse of the inertia over mass
//! in a frame that is the world's at the first sample. So 16 numbers are estimated: `c0`, `v0`, `omega0 = K l0`, the six of `K`, and `mu`.
//!
//! Errors of a contact are in the constraint at that sample, and by force and lever in all integrals after it. `whiten` carries them: they move the initial state as a random walk, so that an
//! innovations filter with 12 states makes the residuals white; its adjoint gives the likeliest error of each contact. `refine` corrects measurements by that and repeats, which is the maximum of the likelihood over state
//! and contacts at once (errors in variables), and not of one with measurements in the derivatives. Where errors are stated `newton` goes on
//! with the Hessian and gives the part of the information that is not noise. `search` finds initial values, by `regular` steps from a
//! prior of the body. `two_stage` is the thesis's own search, for comparison.
//!
//! Palms' angles, rates and accelerations are taken as exact, contacts and torques with their standard deviations.

// matrices are written by their indices, as in the formulas
#![allow(clippy::needless_range_loop)]

mod change;
mod constraint;
mod flow;
mod integrals;
mod linear;
mod linearised;
mod newton;
mod refine;
mod regular;
mod rule;
mod search;
mod surface;
mod touches;
mod two_stage;
mod vector;
mod whiten;

pub use surface::PalmSurface;
pub use touches::{SolidPose, SolidTouch};
pub use two_stage::{KnownSolid, TwoStages};

use nalgebra::{Matrix3, SMatrix, Vector3};

/// The fewest samples of an estimate.
pub(super) const FEWEST: usize = 24;

/// For exact measurements the residual of the true state is below this fraction of the deviation that they are weighted with.
const EXACT: f64 = 1e-2;

/// If less than this fraction of the information by derivatives at noisy measurements is real, it counts as none.
const CURVED: f64 = 0.1;
/// The greatest factor between the growth of chi-square and that of its parabola.
const BENT: f64 = 5.0;

/// The unknowns.
pub const UNKNOWNS: usize = 16;

/// One palm at one sample. SI units, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalmMeasurement {
    /// Where the contact is: along the hinge and up the palm, from the point of the hinge.
    pub place: [f64; 2],
    /// The axis of the hinge, the direction up the palm and the plane's normal towards the body, as columns, in the world.
    pub frame: Matrix3<f64>,
    /// The palm's rate about its hinge.
    pub rate: f64,
    /// The motor's torque less the part that moves the palm itself: the torque on the body.
    pub torque: f64,
}

/// Measurements of three palms. SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidMeasurements {
    /// The times, increasing.
    pub times: Vec<f64>,
    /// Sample by sample.
    pub palms: Vec<[PalmMeasurement; 3]>,
    /// A point of each hinge.
    pub hinges: [Vector3<f64>; 3],
    /// Planes, unless spheres are given.
    pub surfaces: [PalmSurface; 3],
    /// The acceleration of gravity, any vector.
    pub gravity: Vector3<f64>,
    /// The standard deviation of each coordinate of a contact, in m; zero where they are exact.
    pub contact_deviation: f64,
    /// The standard deviation of a torque, in N m.
    pub torque_deviation: f64,
}

/// The estimate of the body's state at the first sample, in the world's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidState {
    /// The centre of mass.
    pub centre: Vector3<f64>,
    /// Its velocity.
    pub velocity: Vector3<f64>,
    /// The angular velocity.
    pub rate: Vector3<f64>,
    /// The inertia about the centre of mass over mass, in m^2.
    pub inertia_over_mass: Matrix3<f64>,
    /// In kg.
    pub mass: f64,
    /// Of centre, velocity, rate, the inertia's entries 11, 22, 33, 12, 13, 23, and 1/m, for the stated deviations: by the Hessian of chi-square and the covariance of its gradient, which is the Cramér-Rao bound where errors are small.
    pub covariance: SMatrix<f64, 16, 16>,
    /// The sum of the squares of all estimated errors of the measurements, in units of their deviations.
    pub chi_square: f64,
    /// The degrees of freedom: the constraints less the unknowns.
    pub degrees: usize,
    /// The root mean square of the estimated errors of contacts, in m.
    pub rms_residual: f64,
    /// J. von Neumann's ratio of the white residuals: about 2 where they are noise.
    pub ratio: f64,
    /// The deviation that contacts were weighted with, in m: where none was stated a millionth of the body.
    pub weighed: f64,
    /// Whether it is a minimum of chi-square. A state that explains the measurements and is no minimum lies in a valley that goes on.
    pub is_minimum: bool,
    /// The least ratio, over all directions, of the curvature of chi-square to the information by derivatives at noisy measurements: 1 where measurements are exact.
    pub curved: f64,
    /// The largest factor between the growth of chi-square and that of its parabola, three deviations along the least observable directions: 1 where measurements are exact.
    pub bent: f64,
    /// Another state that explains the measurements as well.
    pub rival: Option<Rival>,
    /// Whether the measurements' deviations were stated.
    pub is_stated: bool,
    /// Whether those of contacts were: else contacts are weighted with more than their errors, and chi-square is too lenient.
    pub contacts_are_stated: bool,
}

/// Another state that explains the measurements as well as the estimate, and lies outside of its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rival {
    /// The largest distance of an entry, in deviations of the estimate.
    pub apart: f64,
    /// Its chi-square.
    pub chi_square: f64,
}

impl SolidState {
    /// The estimated quantities: centre, velocity, rate, the inertia's entries 11, 22, 33, 12, 13, 23, and 1/m.
    pub fn entries(&self) -> [f64; UNKNOWNS] {
        let j = &self.inertia_over_mass;
        std::array::from_fn(|i| match i {
            0..3 => self.centre[i],
            3..6 => self.velocity[i - 3],
            6..9 => self.rate[i - 6],
            9..15 => j[vector::PLACES[i - 9]],
            _ => 1.0 / self.mass,
        })
    }

    /// Standard deviations of all entries, by the Cramér-Rao bound: for the stated deviations or, where measurements were said to be exact, for errors of the size of the residuals.
    pub fn deviations(&self) -> [f64; UNKNOWNS] {
        let left = if self.is_stated { 1.0 } else { self.chi_square / self.degrees as f64 };
        std::array::from_fn(|i| (self.covariance[(i, i)] * left).sqrt())
    }

    /// Whether the state is unobservable from the measurements: the fit is no minimum, or no bound is valid, or that of centre, rate, inertia or 1/m is as large as the estimate.
    pub fn is_unobservable(&self) -> bool {
        if !self.is_minimum || self.is_noise() || self.is_bent() {
            return true;
        }
        let (entries, deviations) = (self.entries(), self.deviations());
        let size = |of: &[f64]| of.iter().map(|x| x * x).sum::<f64>();
        let seen = |range: std::ops::Range<usize>| size(&deviations[range.clone()]) < size(&entries[range]);
        ![0..3, 6..9, 9..15, 15..16].into_iter().all(seen)
    }

    /// Whether the information of the measurements is mostly the noise in their derivatives along some direction: the true part is a small difference of large numbers, and no bound is valid.
    pub fn is_noise(&self) -> bool {
        self.curved < CURVED
    }

    /// Whether chi-square is no parabola within the bound by its curvature: such a bound is not valid.
    pub fn is_bent(&self) -> bool {
        self.bent > BENT
    }

    /// Whether the residuals are explained. Where deviations are stated: below five deviations of the sum of as many squares. Where none is, they have to be those of rounding and the rule of integration, `EXACT` of what
    /// contacts were weighted with, or to look like noise: the residuals of a wrong state are correlated from sample to sample. By J. von Neumann's ratio (Annals of Mathematical Statistics 12, 1941), whose mean is 2 and
    /// whose variance 4 over the number of differences, five deviations on the side of correlation.
    pub fn fits(&self) -> bool {
        let n = self.degrees as f64;
        let differences = n + UNKNOWNS as f64;
        let is_small = !self.is_stated || self.chi_square <= n + 5.0 * (2.0 * n).sqrt();
        let is_noise = self.contacts_are_stated
            || self.rms_residual <= EXACT * self.weighed
            || self.ratio >= 2.0 - 5.0 * (4.0 / differences).sqrt();
        is_small && is_noise
    }
}

impl SolidMeasurements {
    /// The number of samples.
    pub fn rows(&self) -> usize {
        self.times.len()
    }

    /// Whether nothing moves: no palm turns, and no contact has moved further than its errors explain. Nothing but the place of such a body is observable.
    pub fn is_still(&self) -> bool {
        let Some(first) = self.palms.first() else { return true };
        let size = first.iter().flat_map(|palm| palm.place).fold(0.0, |most: f64, x| most.max(x.abs()));
        let most = (10.0 * self.contact_deviation).max(1e-9 * size);
        let still = |palms: &[PalmMeasurement; 3]| {
            palms.iter().zip(first).all(|(palm, first)| {
                palm.rate == 0.0 && (0..2).all(|k| (palm.place[k] - first.place[k]).abs() <= most)
            })
        };
        self.palms.iter().all(still)
    }

    /// Whether there are enough measurements, all of them finite, with increasing times and contacts off the hinges.
    fn is_whole(&self) -> bool {
        let increase = self.times.windows(2).all(|pair| pair[0] < pair[1]);
        let palms = self.palms.iter().flatten();
        let finite = palms.clone().all(|palm| {
            let own = [palm.place[0], palm.place[1], palm.rate, palm.torque];
            own.iter().chain(palm.frame.iter()).all(|value| value.is_finite())
        });
        self.rows() >= FEWEST
            && self.palms.len() == self.rows()
            && increase
            && finite
            && self.times.iter().all(|time| time.is_finite())
            && self.palms.iter().all(|palms| {
                (0..3).all(|i| {
                    let lever = self.lever(palms, i);
                    lever != 0.0 && lever.is_finite()
                })
            })
    }

    /// The state at the first sample that explains the measurements best among those that were found; none where there are too few
    /// measurements or nothing that is a body explains them.
    pub fn first_state(&self) -> Option<SolidState> {
        search::found(self, &|| false)?.state()
    }

    /// The same with the body at all samples, given up where `interrupt` says so.
    pub fn explained(&self, interrupt: &dyn Fn() -> bool) -> Option<(SolidState, Vec<SolidPose>)> {
        let found = search::found(self, interrupt)?;
        found.state().map(|state| (state, found.poses()))
    }
}

#[cfg(test)]
mod tests;
