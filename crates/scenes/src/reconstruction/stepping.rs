//! The motion from one sample to the next, with its derivatives by the unknowns.
//!
//! The pair of J. R. Dormand and P. J. Prince of orders 5 and 4 (1980): where both differ the span is halved, as it has to be where the curvature of the body has a kink. The derivatives obey linear
//! equations that are the same for all unknowns except for their inhomogeneity: these are carried by two solutions and Simpson's rule, for hundreds of unknowns at the cost of a few. They are accurate to a millionth, enough for a search
//! and for its bound; the motion itself is accurate to the tolerance.

use super::record::{Followed, INPUTS, Unknowns, WholeRecord, node, parts};
use palmistry_observe::dormand_prince::{DIFFERENCE, STAGES, between};

/// Both formulas differ by no more than this at the end of a span, in rad and rad/s.
const TOLERANCE: f64 = 1e-11;

/// A span is halved this often at most.
const DEPTH: u32 = 16;

/// Steps at most over a record, and for each of its samples: smooth motion takes one or two from one sample to the next, a kink some sixteen.
const MOST_STEPS: usize = 20_000;
const STEPS_A_SAMPLE: usize = 50;

/// Why a motion cannot be followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unfollowed {
    /// It has no finite acceleration, or one that jumps.
    Lost,
    /// It takes too many steps.
    Steps,
}

/// Angle and rate, their rates, and their derivatives by the free unknowns; none where they are not wanted.
#[derive(Clone)]
struct Moving {
    at: [f64; 2],
    rates: [f64; 2],
    slopes: [Vec<f64>; 2],
    /// The linearisation of the motion there, where an earlier step has computed it.
    linear: Option<Linear>,
}

/// The derivatives of the acceleration by angle and rate, and by the free unknowns.
type Linear = ([f64; 2], Vec<f64>);

/// A span that was passed: the states in its middle and at its end, the rates there, and the difference of both formulas.
struct Passed {
    middle: [f64; 2],
    end: [f64; 2],
    rates: [f64; 2],
    off: f64,
}

type Matrix = [[f64; 2]; 2];

impl WholeRecord {
    /// The motion from the first sample over so many; with its derivatives, if wanted. None where it cannot be followed.
    pub fn follow(&self, x: &Unknowns, rows: usize, derivatives: bool) -> Option<Vec<Followed>> {
        self.followed(x, rows, derivatives).ok()
    }

    /// Whether too many steps are needed between samples to follow the motion: as where their times are in another unit.
    pub fn takes_too_many_steps(&self, x: &Unknowns) -> bool {
        self.followed(x, self.times.len(), false) == Err(Unfollowed::Steps)
    }

    fn followed(&self, x: &Unknowns, rows: usize, derivatives: bool) -> Result<Vec<Followed>, Unfollowed> {
        let p = if derivatives { self.head() + x.support.coefficients().len() } else { 0 };
        let at = [self.phi, x.rate];
        let rates = self.rates(self.times[0], at, x);
        let mut state = Moving { at, rates, slopes: [vec![0.0; p], vec![0.0; p]], linear: None };
        if p > 0 && self.rate.is_none() {
            state.slopes[1][0] = 1.0;
        }
        let mut steps = MOST_STEPS.max(STEPS_A_SAMPLE * self.times.len());
        let mut followed = Vec::with_capacity(rows);
        for i in 0..rows.min(self.times.len()) {
            if i > 0 {
                let span = [self.times[i - 1], self.times[i]];
                state = self.advanced(x, span, &state, (DEPTH, &mut steps))?;
            }
            followed.push(self.sample(i, &state, x));
        }
        Ok(followed)
    }

    fn sample(&self, i: usize, state: &Moving, x: &Unknowns) -> Followed {
        let ([phi0, omega0], [phi, rate]) = (state.at, &state.slopes);
        let p = phi.len();
        if p == 0 {
            let pose = self.pose(self.times[i], phi0, omega0, x);
            return Followed { phi: phi0, rate: omega0, contacts: pose.contacts, ..Followed::default() };
        }
        let local = self.local(self.times[i], phi0, omega0, x);
        let contact = |i: usize| self.row(&local, &parts(&local.pose.contacts[i]), x, phi, rate);
        let radius = |i: usize| {
            let mut by = [0.0; INPUTS];
            by[3 * i] = 1.0;
            self.row(&local, &by, x, phi, rate)
        };
        Followed {
            phi: phi0,
            rate: omega0,
            radii: local.touched.support.map(|support| support[0]),
            centre: local.pose.centre.map(|x| x.re),
            contacts: local.pose.contacts.map(|x| x.re),
            contact_rows: [contact(0), contact(1)],
            radius_rows: [radius(0), radius(1)],
            phi_row: phi.to_vec(),
            rate_row: rate.to_vec(),
        }
    }

    /// The rates of angle and rate.
    fn rates(&self, time: f64, at: [f64; 2], x: &Unknowns) -> [f64; 2] {
        [at[1], self.pose(time, at[0], at[1], x).acceleration]
    }

    /// A span in one step.
    fn stepped(&self, [from, to]: [f64; 2], state: &Moving, x: &Unknowns) -> Passed {
        let step = to - from;
        let mut rates = [state.rates; 7];
        let mut end = state.at;
        for stage in 1..7 {
            let sum = |i: usize| -> f64 { (0..stage).map(|k| STAGES[stage][k] * rates[k][i]).sum() };
            end = [0, 1].map(|i: usize| state.at[i] + step * sum(i));
            rates[stage] = self.rates(node(from, to, stage), end, x);
        }
        let off = [0, 1].map(|i: usize| {
            step * rates.iter().zip(&DIFFERENCE).map(|(rate, part)| part * rate[i]).sum::<f64>()
        });
        let off =
            if off.iter().all(|off| off.is_finite()) { off[0].abs().max(off[1].abs()) } else { f64::NAN };
        let halfway = |i: usize| between(0.5, step, [state.at[i], end[i]], rates.map(|rate| rate[i]));
        Passed { middle: [halfway(0), halfway(1)], end, rates: rates[6], off }
    }

    /// The state at the end of a span, which may be halved so often and take so many steps.
    fn advanced(
        &self,
        x: &Unknowns,
        span: [f64; 2],
        state: &Moving,
        (depth, steps): (u32, &mut usize),
    ) -> Result<Moving, Unfollowed> {
        *steps = steps.checked_sub(1).ok_or(Unfollowed::Steps)?;
        let [from, to] = span;
        let middle = f64::midpoint(from, to);
        let passed = self.stepped(span, state, x);
        if !passed.off.is_finite() {
            return Err(Unfollowed::Lost);
        }
        if passed.off > TOLERANCE {
            let depth = depth.checked_sub(1).ok_or(Unfollowed::Lost)?;
            let half = self.advanced(x, [from, middle], state, (depth, steps))?;
            return self.advanced(x, [middle, to], &half, (depth, steps));
        }
        let (slopes, linear) = match state.slopes[0].is_empty() {
            true => (state.slopes.clone(), None),
            false => {
                let first = state.linear.clone().unwrap_or_else(|| self.linear(from, state.at, x));
                let second = self.linear(middle, passed.middle, x);
                let last = self.linear(to, passed.end, x);
                (carried(to - from, [&first, &second, &last], &state.slopes), Some(last))
            }
        };
        Ok(Moving { at: passed.end, rates: passed.rates, slopes, linear })
    }
}

/// The derivatives at the end of a span, by the linearised motion at its start, middle and end.
fn carried(step: f64, locals: [&Linear; 3], slopes: &[Vec<f64>; 2]) -> [Vec<f64>; 2] {
    let linear = locals.map(|local| local.0);
    let [all, second] = [over(step, linear), over(step / 2.0, halves(linear))];
    let mut carried = slopes.clone();
    for k in 0..slopes[0].len() {
        let own = [slopes[0][k], slopes[1][k]];
        let drives = locals.map(|local| local.1[k]);
        for (i, carried) in carried.iter_mut().enumerate() {
            let driven = all[i][1] * drives[0] + 4.0 * second[i][1] * drives[1];
            let last = if i == 1 { drives[2] } else { 0.0 };
            carried[k] = all[i][0] * own[0] + all[i][1] * own[1] + step / 6.0 * (driven + last);
        }
    }
    carried
}

/// Of three linear laws over a span those of its second half: the one in its middle is interpolated.
fn halves([_, middle, end]: [[f64; 2]; 3]) -> [[f64; 2]; 3] {
    [middle, [0, 1].map(|i: usize| f64::midpoint(middle[i], end[i])), end]
}

/// The state transition matrix of `angle'' = by_angle angle + by_rate rate` over a span, the coefficients being given at its start, middle and end: Kutta's method.
fn over(step: f64, laws: [[f64; 2]; 3]) -> Matrix {
    let from = |start: [f64; 2]| {
        let rates = |law: [f64; 2], at: [f64; 2]| [at[1], law[0] * at[0] + law[1] * at[1]];
        let plus = |by: f64, slope: [f64; 2]| [start[0] + by * slope[0], start[1] + by * slope[1]];
        let first = rates(laws[0], start);
        let second = rates(laws[1], plus(step / 2.0, first));
        let third = rates(laws[1], plus(step / 2.0, second));
        let fourth = rates(laws[2], plus(step, third));
        [0, 1].map(|i: usize| start[i] + step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]))
    };
    let [by_angle, by_rate] = [from([1.0, 0.0]), from([0.0, 1.0])];
    [[by_angle[0], by_rate[0]], [by_angle[1], by_rate[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Experiment, Scene};
    use palmistry_bodies::shape::{SupportFunction, SupportSeries};

    /// The simulated motion of a body whose harmonics are known, by Newton's laws, and derivatives against differences.
    #[test]
    fn motion_and_derivatives_are_those_of_the_body() {
        let text = include_str!("../../../../proofs/moll2002/scenes/general.toml");
        let scene = Scene::parse("../../proofs/moll2002/scenes/general.toml", text).unwrap();
        let experiment = Experiment::new(scene, None).unwrap();
        let simulation = experiment.simulation.as_ref().unwrap();
        let [x, y] = simulation.shape.centre_of_mass();
        let series = SupportSeries { mean: 1.2, harmonics: vec![[-x, -y], [0.1, 0.0], [0.03, -0.04]] };
        let record = WholeRecord::of(&experiment, 1e-4).unwrap();
        let moments = &simulation.trajectory.moments;
        let gyration = simulation.constants["rho"];
        let exact = Unknowns { rate: moments[0].omega0, gyration, support: SupportFunction::Series(series) };
        let motion = record.follow(&exact, record.times.len(), true).unwrap();
        for (at, moment) in motion.iter().zip(moments) {
            assert!((at.phi - moment.phi0).abs() < 1e-9 && (at.rate - moment.omega0).abs() < 1e-9);
            for palm in 0..2 {
                assert!((at.contacts[palm] - moment.palms[palm].s).abs() < 1e-9);
            }
        }
        let p = motion[0].phi_row.len();
        assert_eq!(p, record.head() + 7);
        for place in 0..p {
            let moved = |by: f64| {
                let mut step = nalgebra::DVector::zeros(p);
                step[place] = by;
                let there = record.moved(&exact, &step).unwrap();
                record.follow(&there, record.times.len(), false).unwrap()
            };
            let (up, down) = (moved(1e-6), moved(-1e-6));
            for i in (0..motion.len()).step_by(50) {
                for palm in 0..2 {
                    let slope = (up[i].contacts[palm] - down[i].contacts[palm]) / 2e-6;
                    let row = motion[i].contact_rows[palm][place];
                    assert!((slope - row).abs() < 1e-5 * (1.0 + slope.abs()), "{place} {i}: {slope} {row}");
                }
            }
        }
    }
}
