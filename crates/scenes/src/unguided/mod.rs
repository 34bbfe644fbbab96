//! The state of a body between two palms, flat or circular, from a window of measurements, without a first guess.
//!
//! The constraint of palm `i` on a body of unknown shape is that the body's material point at the contact does not enter the palm,
//!
//! ```text
//! 0 = n_i · (c' + omega x (c_i - c) - w_i x c_i),
//! ```
//!
//! with the contact `c_i`, the normal `n_i` and the palm's rate `w_i` as measured, and the hinge at the origin. The contact forces
//! follow from the torques, `f_i (c_i x n_i) = tau_i - I_i A_i` (4.7, 4.8). With them Newton's and Euler's laws are integrals of measurements,
//!
//! ```text
//! c(t)     = c0 + v0 t + P(t),                            m P'' = m g + sum f_i n_i
//! omega(t) = omega0 + k (C(t) - A(t) · c0 - B(t) · v0),   k = 1/(m rho^2)
//! A' = sum f_i (n_iy, -n_ix),   B' = t A',   C' = sum f_i c_i x n_i - A' · P,
//! ```
//!
//! so that the constraint is a polynomial in `c0`, `v0`, `omega0` and `k` at every sample: nothing is integrated during the search.
//! `search` estimates them; where contacts err, their errors are carried through the integrals (`carried`). No shape, no curvature and no derivative of a contact is in it.

mod carried;
mod descent;
mod grid;
mod integrals;
mod normal;
mod scene;
mod search;

pub(super) use scene::{Unguided, palm_measurements};

use integrals::Integrals;
use palmistry_bodies::mechanics::Palm;

/// The fewest samples of an estimate.
const FEWEST: usize = 12;

/// A window of measurements, and known quantities. SI units; palms are in the world's frame.
#[derive(Clone, Debug)]
pub struct PalmMeasurements {
    /// In s.
    pub times: Vec<f64>,
    /// The palms' forms.
    pub palms: [Palm<f64>; 2],
    /// The contacts, by arc length along the palms.
    pub contacts: [Vec<f64>; 2],
    /// The palms' angles against the X axis, in rad, and their rates and accelerations.
    pub angles: [Vec<f64>; 2],
    /// In rad/s.
    pub rates: [Vec<f64>; 2],
    /// In rad/s^2.
    pub accelerations: [Vec<f64>; 2],
    /// The motors' torques about the hinge.
    pub torques: [Vec<f64>; 2],
    /// Of the palms about the hinge.
    pub inertia: [f64; 2],
    /// Of the body.
    pub mass: f64,
    /// The acceleration along the Y axis.
    pub gravity: f64,
    /// The body's radius of gyration, where it is known.
    pub gyration: Option<f64>,
    /// The standard deviation of the contacts, where it is known; zero for exact ones.
    pub sigma: Option<f64>,
}

/// The state at the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstState {
    /// The distances of the centre of mass from the palms' tangents at the contacts, `r1` and `r2`.
    pub radii: [f64; 2],
    /// `omega0`.
    pub rate: f64,
    /// The radius of gyration.
    pub gyration: f64,
    /// The centre of mass in the world.
    pub centre: [f64; 2],
    /// Its velocity.
    pub velocity: [f64; 2],
    /// The same along the normals of the palms, `v1` and `v2`.
    pub receding: [f64; 2],
    /// The Cramér-Rao bounds of `r1`, `r2` and `omega0`, by the stated noise of the contacts; zeros where none is stated.
    pub deviations: [f64; 3],
    /// The root mean square residual of the contacts.
    pub rms_residual: f64,
}

impl PalmMeasurements {
    /// The state at the first sample that explains the measurements best among those that were found; none where there are too few
    /// measurements, they are not finite, or nothing that has the body between the palms explains them.
    pub fn first_state(&self) -> Option<FirstState> {
        let n = self.times.len();
        let columns = [&self.contacts, &self.angles, &self.rates, &self.accelerations, &self.torques];
        let whole = columns
            .iter()
            .flat_map(|pair| pair.iter())
            .all(|column| column.len() == n && column.iter().all(|value| value.is_finite()));
        if n < FEWEST || !whole {
            return None;
        }
        search::search(&Integrals::of(self)?)
    }

    /// The Cramér-Rao bound of `r1`, `r2` and `omega0` at a true state, by the constraint at all samples: for exact contacts,
    /// with the errors that they are to have stated. None where no error is stated.
    pub fn bound_at(&self, truth: &FirstState) -> Option<[f64; 3]> {
        let (sigma, all) = (self.sigma?, Integrals::of(self)?);
        let log_k = -(self.mass * truth.gyration * truth.gyration).ln();
        let ([x, y], [u, v]) = (truth.centre, truth.velocity);
        let end = descent::End { x: [x, y, u, v, truth.rate, log_k], cost: 0.0, carried: None };
        Some(descent::deviations(&all, &end).map(|deviation| sigma * deviation))
    }
}

impl PalmMeasurements {
    /// The given rows.
    ///
    /// # Panics
    /// When there are no such rows.
    pub fn rows(&self, rows: std::ops::Range<usize>) -> PalmMeasurements {
        let cut = |pair: &[Vec<f64>; 2]| [pair[0][rows.clone()].to_vec(), pair[1][rows.clone()].to_vec()];
        PalmMeasurements {
            times: self.times[rows.clone()].to_vec(),
            contacts: cut(&self.contacts),
            angles: cut(&self.angles),
            rates: cut(&self.rates),
            accelerations: cut(&self.accelerations),
            torques: cut(&self.torques),
            ..*self
        }
    }

    /// The motion from a first state on, by the integrals of the measurements; none where there are too few.
    pub(super) fn motion(&self, first: &FirstState) -> Option<PalmMotion> {
        if self.times.len() < FEWEST {
            return None;
        }
        let all = Integrals::of(self)?;
        let k = 1.0 / (self.mass * first.gyration * first.gyration);
        let ([cx, cy], [vx, vy]) = (first.centre, first.velocity);
        let mut motion = PalmMotion { radii: Vec::new(), rates: Vec::new() };
        for sample in &all.samples {
            let turned = sample.c - sample.a[0] * cx - sample.a[1] * cy - sample.b[0] * vx - sample.b[1] * vy;
            let place = [cx + vx * sample.time + sample.place[0], cy + vy * sample.time + sample.place[1]];
            motion.rates.push(first.rate + k * turned);
            motion.radii.push(sample.palms.map(|palm| palm.normal[0] * place[0] + palm.normal[1] * place[1]));
        }
        Some(motion)
    }
}

/// A motion, sample by sample.
pub(super) struct PalmMotion {
    /// The distances of the centre of mass from the palms.
    pub radii: Vec<[f64; 2]>,
    /// The body's rate.
    pub rates: Vec<f64>,
}

#[cfg(test)]
mod tests;
