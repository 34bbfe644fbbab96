//! Errors of contacts and torques, carried through the integrals.
//!
//! An error at a sample gives the body an impulse `mu dF` and its angular momentum over mass one of `mu (dG - c x dF)`, each for the time that the sample stands for (the trapezoidal rule); its later effect is that
//! of another initial state, turn included. So the constraints are `y_k = J_k z_k + D_k e_k`, `z_{k+1} = z_k + B_k e_k`, with the derivatives `J_k` by 12 numbers of that state. The innovations of this
//! are white (Kalman's filter where the noise of measurements is that of the state); `e = D^T eta + B^T lambda` is the likeliest error, by the adjoint. So far by the trapezoidal rule; measurements are integrated by a better one (`rule`), and
//! errors are the likeliest, and the residuals stationary where they are, only where both agree: the difference that the filter's rule leaves is filtered again.

use super::constraint::Constrained;
use super::flow::{Start, TURN};
use super::integrals::{Integrals, Node, Rules};
use super::linear::{backward, cholesky, forward};
use super::rule::Piece;
use super::surface::PalmSample;
use super::vector::{Vector, along, cross, dot, scaled};

/// Errors at a sample: of both coordinates of each contact, and of each torque.
pub(super) const ERRORS: usize = 9;
/// The numbers of the initial state that errors move.
const MOVED: usize = 12;

/// The filter takes integrals by the trapezoidal rule. The most iterations that remove its difference from the rule of integration, and the fraction of the first sum of squares at which they stop.
const CORRECTED: usize = 20;
const SOLVED: f64 = 1e-14;

/// The sizes of errors, and the least rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviations {
    /// In m.
    pub contact: f64,
    /// In N m.
    pub torque: f64,
    /// In rad/s: no constraint is weighted more than that of a body that turns at this rate against its palm.
    pub softened: f64,
}

/// One sample of the filter.
struct Stage {
    by: [[f64; MOVED]; 3],
    /// The derivatives of the constraints by errors of their own contacts, besides those through the integrals.
    slopes: [f64; 6],
    impulse: [[f64; ERRORS]; MOVED],
    spacing: f64,
    /// The triangle of the innovations' covariance, and the gain.
    triangle: [[f64; 3]; 3],
    gain: [[f64; 3]; MOVED],
}

/// The filter over all samples.
pub(super) struct Whitener {
    stages: Vec<Stage>,
    /// The rule of integration, interval by interval.
    pieces: Vec<Piece>,
    /// The variance that is added to each constraint.
    softened: f64,
}

/// The change of the initial state by errors of unit size: a column an error.
fn impulses(
    start: &Start,
    node: &Node,
    palms: &[PalmSample; 3],
    sample: &Constrained,
    spacing: f64,
    deviations: &Deviations,
) -> Option<[[f64; ERRORS]; MOVED]> {
    let mut all = [[0.0; ERRORS]; MOVED];
    // the turn's derivative by the turn at the first sample, for its inverse
    let xi = &sample.at.moved;
    let [a, b, c] = [xi[TURN], xi[TURN + 1], xi[TURN + 2]];
    let volume = dot(&a, &cross(&b, &c));
    if volume.abs() < 1e-9 || !volume.is_finite() {
        return None;
    }
    let [bc, ca, ab] = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
    for (i, palm) in palms.iter().enumerate() {
        let [along_hinge, up, torque] = palm.wrenches();
        let (contact, of_torque) = (deviations.contact, deviations.torque);
        for (column, (force, moment), size) in
            [(2 * i, along_hinge, contact), (2 * i + 1, up, contact), (6 + i, torque, of_torque)]
        {
            let t = start.mu * spacing * size;
            let velocity: Vector = scaled(t, &force);
            let centre = scaled(-node.time, &velocity);
            let spun = scaled(t, &along(&moment, -1.0, &cross(&sample.centre, &force)));
            // the effect of centre and velocity at the first sample on the momentum until now
            let drawn = along(&cross(&centre, &node.force), 1.0, &cross(&velocity, &node.first));
            let momentum = along(&spun, start.mu, &drawn);
            let mut turned = [0.0; 3];
            for (part, from) in [(&centre, 0), (&velocity, 3), (&momentum, 6)] {
                for k in 0..3 {
                    turned = along(&turned, -part[k], &xi[from + k]);
                }
            }
            let turn = [dot(&bc, &turned), dot(&ca, &turned), dot(&ab, &turned)].map(|value| value / volume);
            for k in 0..3 {
                all[k][column] = centre[k];
                all[3 + k][column] = velocity[k];
                all[6 + k][column] = momentum[k];
                all[9 + k][column] = turn[k];
            }
        }
    }
    Some(all)
}

impl Whitener {
    /// None where a covariance is not positive.
    pub fn of(
        start: &Start,
        all: &Integrals,
        samples: &[Constrained],
        rules: &Rules,
        deviations: &Deviations,
        is_stated: bool,
    ) -> Option<Whitener> {
        // errors of exact measurements are those of the rule alone, correlated from sample to sample, and rounding counts for more
        let pieces = if is_stated { rules.whole.clone() } else { rules.trapezoids() };
        let spacing = rules.spacing();
        let softened = (deviations.contact * deviations.softened).powi(2);
        let mut spread = [[0.0; MOVED]; MOVED];
        let mut stages = Vec::with_capacity(samples.len());
        for (k, sample) in samples.iter().enumerate() {
            let impulse = impulses(start, &all.nodes[k], &all.palms[k], sample, spacing[k], deviations)?;
            let by: [[f64; MOVED]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| sample.by[i][j]));
            // the fraction of an error's impulse that has arrived at its own sample
            let arrived = match k {
                0 => 0.0,
                _ if k + 1 == samples.len() => 1.0,
                _ => 0.5,
            };
            let (mut direct, mut slopes) = ([[0.0; ERRORS]; 3], [0.0; 6]);
            for i in 0..3 {
                for e in 0..ERRORS {
                    let mut value = 0.0;
                    for (m, row) in impulse.iter().enumerate() {
                        value += by[i][m] * row[e] * arrived;
                    }
                    direct[i][e] = value;
                }
                for side in 0..2 {
                    slopes[2 * i + side] = deviations.contact * sample.slopes[i][side];
                    direct[i][2 * i + side] += slopes[2 * i + side];
                }
            }
            // spread times the transpose of `by`
            let mut towards = [[0.0; 3]; MOVED];
            for (row, to) in spread.iter().zip(&mut towards) {
                for i in 0..3 {
                    to[i] = row.iter().zip(&by[i]).map(|(a, b)| a * b).sum();
                }
            }
            let mut covariance = [[0.0; 3]; 3];
            for i in 0..3 {
                for j in 0..=i {
                    let mut value: f64 = direct[i].iter().zip(&direct[j]).map(|(a, b)| a * b).sum();
                    for m in 0..MOVED {
                        value += by[i][m] * towards[m][j];
                    }
                    covariance[i][j] = value;
                }
                covariance[i][i] += softened;
            }
            let triangle = cholesky(&covariance, 3)?;
            let mut gain = [[0.0; 3]; MOVED];
            for m in 0..MOVED {
                let mut right = towards[m];
                for i in 0..3 {
                    right[i] += impulse[m].iter().zip(&direct[i]).map(|(a, b)| a * b).sum::<f64>();
                }
                gain[m] = backward(&triangle, 3, &forward(&triangle, 3, &right));
                // minus gain times covariance times gain, column by column below
                towards[m] = forward(&triangle, 3, &right);
            }
            for m in 0..MOVED {
                for n in 0..MOVED {
                    let own: f64 = impulse[m].iter().zip(&impulse[n]).map(|(a, b)| a * b).sum();
                    spread[m][n] += own - dot(&towards[m], &towards[n]);
                }
            }
            stages.push(Stage { by, slopes, impulse, spacing: spacing[k], triangle, gain });
        }
        Some(Whitener { stages, pieces, softened })
    }

    /// White residuals of a column of constraints.
    pub fn white(&self, column: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.innovations(column).iter().zip(&self.stages).map(|(v, at)| forward(&at.triangle, 3, v)).collect()
    }

    fn innovations(&self, column: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut state = [0.0; MOVED];
        let mut all = Vec::with_capacity(column.len());
        for (stage, value) in self.stages.iter().zip(column) {
            let innovation: [f64; 3] = std::array::from_fn(|i| {
                value[i] - stage.by[i].iter().zip(&state).map(|(a, b)| a * b).sum::<f64>()
            });
            for (value, gain) in state.iter_mut().zip(&stage.gain) {
                *value += dot(gain, &innovation);
            }
            all.push(innovation);
        }
        all
    }

    /// The multipliers of a column of constraints in the sum of the squares of the likeliest errors that make it, by the filter's own rule.
    fn filtered(&self, column: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut all = self.innovations(column);
        let mut ahead = [0.0; MOVED];
        for (stage, value) in self.stages.iter().zip(&mut all).rev() {
            let mut eta = backward(&stage.triangle, 3, &forward(&stage.triangle, 3, value));
            for (gain, value) in stage.gain.iter().zip(&ahead) {
                eta = along(&eta, -value, gain);
            }
            for m in 0..MOVED {
                for i in 0..3 {
                    ahead[m] += stage.by[i][m] * eta[i];
                }
            }
            *value = eta;
        }
        all
    }

    /// The same by the rule of integration: conjugate gradients, for which the filter is the preconditioner.
    pub fn multipliers(&self, column: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let sum = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 { a.iter().zip(b).map(|(a, b)| dot(a, b)).sum() };
        let add = |to: &mut [[f64; 3]], by: f64, what: &[[f64; 3]]| {
            for (to, what) in to.iter_mut().zip(what) {
                *to = along(to, by, what);
            }
        };
        let mut found = vec![[0.0; 3]; column.len()];
        let mut left = column.to_vec();
        let mut direction = self.filtered(&left);
        let first = sum(&left, &direction);
        let mut size = first;
        for _ in 0..CORRECTED {
            if size.is_nan() || size <= SOLVED * first {
                break;
            }
            let mut made = self.made_by(&self.likely(&direction));
            add(&mut made, self.softened, &direction);
            let by = size / sum(&direction, &made);
            add(&mut found, by, &direction);
            add(&mut left, -by, &made);
            let next = self.filtered(&left);
            let before = size;
            size = sum(&left, &next);
            for (direction, next) in direction.iter_mut().zip(next) {
                *direction = along(&next, size / before, direction);
            }
        }
        found
    }

    /// The likeliest errors, in units of their deviations, from multipliers.
    pub fn likely(&self, multipliers: &[[f64; 3]]) -> Vec<[f64; ERRORS]> {
        // by interval: the information of all samples after it about the state there
        let mut after = vec![[0.0; MOVED]; self.pieces.len()];
        let mut sum = [0.0; MOVED];
        for (k, stage) in self.stages.iter().enumerate().skip(1).rev() {
            for m in 0..MOVED {
                for i in 0..3 {
                    sum[m] += stage.by[i][m] * multipliers[k][i];
                }
            }
            after[k - 1] = sum;
        }
        let mut states = vec![[0.0; MOVED]; self.stages.len()];
        for (piece, after) in self.pieces.iter().zip(&after) {
            for (state, weight) in states[piece.first..].iter_mut().zip(piece.weights) {
                for m in 0..MOVED {
                    state[m] += weight * after[m];
                }
            }
        }
        let of = |((stage, state), eta): ((&Stage, &[f64; MOVED]), &[f64; 3])| {
            std::array::from_fn(|e| {
                let carried: f64 = stage.impulse.iter().zip(state).map(|(row, value)| row[e] * value).sum();
                let own = if e < 6 { stage.slopes[e] * eta[e / 2] } else { 0.0 };
                own + carried / stage.spacing
            })
        };
        self.stages.iter().zip(&states).zip(multipliers).map(of).collect()
    }

    /// The constraints that errors make, by the rule of integration.
    pub fn made_by(&self, errors: &[[f64; ERRORS]]) -> Vec<[f64; 3]> {
        let moved = |(stage, error): (&Stage, &[f64; ERRORS])| -> [f64; MOVED] {
            std::array::from_fn(|m| {
                stage.impulse[m].iter().zip(error).map(|(a, b)| a * b).sum::<f64>() / stage.spacing
            })
        };
        let rates: Vec<[f64; MOVED]> = self.stages.iter().zip(errors).map(moved).collect();
        let mut state = [0.0; MOVED];
        let mut all = Vec::with_capacity(errors.len());
        for (k, (stage, error)) in self.stages.iter().zip(errors).enumerate() {
            if k > 0 {
                let piece = &self.pieces[k - 1];
                for (weight, rate) in piece.weights.iter().zip(&rates[piece.first..]) {
                    for m in 0..MOVED {
                        state[m] += weight * rate[m];
                    }
                }
            }
            all.push(std::array::from_fn(|i| {
                let carried: f64 = stage.by[i].iter().zip(&state).map(|(a, b)| a * b).sum();
                carried + (0..2).map(|side| stage.slopes[2 * i + side] * error[2 * i + side]).sum::<f64>()
            }));
        }
        all
    }
}
