//! The thesis's method: its equations 3.35 to 3.37 integrated from radii at the first sample.
//!
//! The denominator of 3.37 is `sin phi2 (y - y_r)`, the height of the centre of mass over the centre of rotation: where one passes the other it vanishes, and with it the numerator.
//! A step that comes near divides one error by another.

use super::measurements::SlowMeasurements;
use super::quadrature::SlowTrack;
use ode_solvers::{Dop853, Dopri5, OutputType, SVector, System};
use std::cell::Cell;

/// The corrector is repeated until the relative change of the state is below this, or so often.
const SETTLED: f64 = 1e-12;
const CORRECTIONS: usize = 20;

/// Measurements between samples and their rates come from the polynomial through this many: of fourth order as the method.
const POINTS: usize = 5;

/// The tolerance of the adaptive solvers.
const TOLERANCE: f64 = 1e-9;

/// The methods that integrate 3.35 to 3.37.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThesisMethod {
    /// Adams, Bashforth and Moulton's of fourth order, the corrector repeated: section 3.3.
    PredictorCorrector,
    /// Dormand and Prince's of fifth order with its steps chosen.
    Dopri5,
    /// Dormand and Prince's of eighth order with its steps chosen.
    Dop853,
}

impl ThesisMethod {
    /// All of them, the thesis's own first.
    pub const ALL: [ThesisMethod; 3] =
        [ThesisMethod::PredictorCorrector, ThesisMethod::Dopri5, ThesisMethod::Dop853];
}

/// The track by the thesis's method.
#[derive(Clone, Debug)]
pub struct ThesisTrack {
    /// Up to the last sample that it reached.
    pub track: SlowTrack,
    /// `e_f` of 3.38, in m, sample by sample.
    pub force_error: Vec<f64>,
    /// The length of `e_c` of 3.39, in m.
    pub contact_error: Vec<f64>,
    /// The samples before which the denominator of 3.37 changes its sign.
    pub vanishing: Vec<usize>,
    /// Why it stopped before the last sample.
    pub stopped: Option<String>,
}

type State = [f64; 3];

/// The right-hand sides of 3.35 to 3.37, `d` by 3.18 and 3.19.
fn rates(at: &super::measurements::Sampled, contact_rates: [f64; 2], [r1, r2, _]: State) -> State {
    let [numerator, denominator] = at.turning([r1, r2], contact_rates);
    let turn = numerator / denominator;
    let d = at.tangential([r1, r2]);
    [-d[0] * (at.w[0] - turn), -d[1] * (at.w[1] - turn), turn]
}

fn along(state: State, parts: &[(f64, State)]) -> State {
    parts.iter().fold(state, |sum, (weight, rate)| std::array::from_fn(|i| sum[i] + weight * rate[i]))
}

/// Integrates 3.35 to 3.37 from the radii at the first sample, the orientation zero there.
pub fn by_thesis(measurements: &SlowMeasurements, radii: [f64; 2], method: ThesisMethod) -> ThesisTrack {
    let start = [radii[0], radii[1], 0.0];
    let (states, stopped) = match method {
        ThesisMethod::PredictorCorrector => (predictor_corrector(measurements, start), None),
        ThesisMethod::Dopri5 | ThesisMethod::Dop853 => adaptive(measurements, start, method),
    };
    let mut found = ThesisTrack {
        track: SlowTrack { radii: Vec::new(), phi0: Vec::new(), height: Vec::new() },
        force_error: Vec::new(),
        contact_error: Vec::new(),
        vanishing: Vec::new(),
        stopped,
    };
    let mut before = 0.0;
    for (row, [r1, r2, phi0]) in states.into_iter().enumerate() {
        let at = measurements.sampled(row);
        let [d1, d2] = at.tangential([r1, r2]);
        let [s1, s2] = at.s;
        // 3.38 by 3.33: the side of contact 1 from the centre of mass, and where balance has it
        let side = r1 * at.first[0] - d1 * at.first[1];
        let balance = (s1 * at.opening[1] - s2) * at.first[0] / at.opening[0];
        // 3.39: contact i is c - r_i n_i -+ d_i along the palm
        let first = [r1 * at.first[0] - d1 * at.first[1], -r1 * at.first[1] - d1 * at.first[0]];
        let second = [-r2 * at.second[0] + d2 * at.second[1], r2 * at.second[1] + d2 * at.second[0]];
        let apart = [0, 1].map(|k: usize| {
            let along = |pair: [f64; 2], s: f64| s * pair[1 - k];
            first[k] - second[k] - along(at.first, s1) + along(at.second, s2)
        });
        found.force_error.push(side + balance);
        found.contact_error.push(apart[0].hypot(apart[1]));
        let denominator = at.turning([r1, r2], [0.0; 2])[1];
        if row > 0 && (denominator < 0.0) != (before < 0.0) {
            found.vanishing.push(row);
        }
        before = denominator;
        found.track.height.push((at.second[0] * r1 + at.first[0] * r2) / at.opening[0]);
        found.track.radii.push([r1, r2]);
        found.track.phi0.push(phi0);
    }
    found
}

/// On uneven times the integrals of polynomials replace the textbook's weights, which hold for even ones.
fn predictor_corrector(measurements: &SlowMeasurements, start: State) -> Vec<State> {
    let times = &measurements.times;
    let contact_rates = measurements.contact_rates(POINTS);
    let at = |row: usize, state: State| rates(&measurements.sampled(row), contact_rates[row], state);
    let mut states = vec![start];
    let mut slopes = vec![at(0, start)];
    for row in 1..times.len() {
        let (from, step) = (states[row - 1], times[row] - times[row - 1]);
        if row < 4 {
            // the first steps by Runge and Kutta's, the measurements between by their polynomial
            let middle = measurements.between(times[row - 1] + step / 2.0, POINTS);
            let half = |slope: State| rates(&middle.0, middle.1, along(from, &[(step / 2.0, slope)]));
            let k1 = slopes[row - 1];
            let k2 = half(k1);
            let k3 = half(k2);
            let k4 = at(row, along(from, &[(step, k3)]));
            let parts = [(step / 6.0, k1), (step / 3.0, k2), (step / 3.0, k3), (step / 6.0, k4)];
            states.push(along(from, &parts));
        } else {
            let weights = |nodes: &[f64]| -> Vec<f64> { step_weights(nodes, times[row - 1], times[row]) };
            let predict = weights(&times[row - 4..row]);
            let parts: Vec<(f64, State)> =
                predict.iter().zip(&slopes[row - 4..row]).map(|(w, slope)| (*w, *slope)).collect();
            let mut state = along(from, &parts);
            let correct = weights(&times[row - 3..=row]);
            for _ in 0..CORRECTIONS {
                let mut parts: Vec<(f64, State)> =
                    correct.iter().zip(&slopes[row - 3..row]).map(|(w, slope)| (*w, *slope)).collect();
                parts.push((correct[3], at(row, state)));
                let next = along(from, &parts);
                let change = (0..3).map(|i| (next[i] - state[i]).abs() / (1e-3 + next[i].abs()));
                let settled = change.fold(0.0, f64::max) < SETTLED;
                state = next;
                if settled {
                    break;
                }
            }
            states.push(state);
        }
        slopes.push(at(row, states[row]));
    }
    states
}

/// The weights of the slopes at four nodes in the integral between two times: of the cubic through them, by Simpson's rule, which is exact for it.
fn step_weights(nodes: &[f64], from: f64, to: f64) -> Vec<f64> {
    let basis = |j: usize, t: f64| -> f64 {
        (0..nodes.len()).filter(|k| *k != j).map(|k| (t - nodes[k]) / (nodes[j] - nodes[k])).product()
    };
    let middle = f64::midpoint(from, to);
    (0..nodes.len())
        .map(|j| (to - from) / 6.0 * (basis(j, from) + 4.0 * basis(j, middle) + basis(j, to)))
        .collect()
}

/// The most evaluations from one sample to the next.
const MOST_EVALUATIONS: usize = 4000;

/// Time is the last coordinate: Dop853 of ode_solvers 0.6.2 takes zero for the twelfth node of the method, which is one.
struct Law<'a> {
    measurements: &'a SlowMeasurements,
    evaluations: &'a Cell<usize>,
}

impl System<f64, SVector<f64, 4>> for Law<'_> {
    fn system(&self, _: f64, y: &SVector<f64, 4>, dy: &mut SVector<f64, 4>) {
        self.evaluations.set(self.evaluations.get() + 1);
        if self.evaluations.get() > MOST_EVALUATIONS {
            // no step is accepted from here on
            return dy.fill(f64::NAN);
        }
        let (at, contact_rates) = self.measurements.between(y[3], POINTS);
        let [r1, r2, phi0] = rates(&at, contact_rates, [y[0], y[1], y[2]]);
        *dy = SVector::from([r1, r2, phi0, 1.0]);
    }
}

/// From sample to sample; the states at the samples that were reached, and why it stopped.
fn adaptive(
    measurements: &SlowMeasurements,
    start: State,
    method: ThesisMethod,
) -> (Vec<State>, Option<String>) {
    let mut states = vec![start];
    for ends in measurements.times.windows(2) {
        let evaluations = Cell::new(0);
        let (law, span) = (Law { measurements, evaluations: &evaluations }, ends[1] - ends[0]);
        let [r1, r2, phi0] = states[states.len() - 1];
        let y = SVector::from([r1, r2, phi0, ends[0]]);
        // the four numbers before the step sizes are the solvers' usual safety factor, damping, and bounds on a change of step
        let (tolerance, most) = (TOLERANCE, MOST_EVALUATIONS as u32);
        macro_rules! end {
            ($solver:expr) => {{
                let mut solver = $solver;
                solver.integrate().map(|_| solver.y_out().last().copied())
            }};
        }
        let found = match method {
            ThesisMethod::Dop853 => end!(Dop853::from_param(
                law,
                0.0,
                span,
                span,
                y,
                tolerance,
                tolerance,
                0.9,
                0.0,
                0.333,
                6.0,
                span,
                span,
                most,
                most,
                OutputType::Sparse,
            )),
            _ => end!(Dopri5::from_param(
                law,
                0.0,
                span,
                span,
                y,
                tolerance,
                tolerance,
                0.9,
                0.04,
                0.2,
                10.0,
                span,
                span,
                most,
                most,
                OutputType::Sparse,
            )),
        };
        match found {
            Ok(Some(y)) if y.iter().all(|x| x.is_finite()) => states.push([y[0], y[1], y[2]]),
            Ok(_) => return (states, Some("a number is not finite".to_owned())),
            // the integrator calls this a step that is too small
            Err(_) if evaluations.get() > MOST_EVALUATIONS => {
                let why = format!(
                    "the equations were evaluated {MOST_EVALUATIONS} times since the sample before, and no more is done"
                );
                return (states, Some(why));
            }
            Err(error) => return (states, Some(error.to_string())),
        }
    }
    (states, None)
}
