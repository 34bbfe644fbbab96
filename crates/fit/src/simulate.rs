//! Experiments followed through time with the derivatives of their states by the parameters.
//!
//! States and sensitivities are integrated together by an explicit method of order five, and where that takes too many steps by formulas of backward differentiation,
//! which stay stable where rates differ by many orders of magnitude (both of the crate diffsol); the derivatives of the rates are exact. Which is
//! used depends on the experiment and the parameters alone.

use super::compiled::{CompiledPhase, Room};
use diffsol::error::DiffsolError;
use diffsol::{
    NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason,
};
use nalgebra::{DMatrix, DVector};
use std::cell::RefCell;

/// How exactly the states are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exactness {
    /// For searches, which compare what is far from the answer.
    Search,
    /// For answers.
    Answer,
}

impl Exactness {
    /// The relative and the absolute error of an explicit step, of states and (ten and a hundred times these) of their derivatives.
    fn explicit(self) -> [f64; 2] {
        match self {
            Exactness::Search => [1e-8, 1e-11],
            Exactness::Answer => [1e-11, 1e-13],
        }
    }

    /// Those of an implicit one: where small errors grow a thousandfold, as in an infection, steps by formulas of backward differentiation err a hundred
    /// times as much as explicit ones of the same tolerance (measured on a model of immune cells: 2e-3 against 9e-6 of the value at 1e-9, 5e-5 at 1e-11).
    fn implicit(self) -> [f64; 2] {
        match self {
            Exactness::Search => [1e-8, 1e-11],
            Exactness::Answer => [1e-11, 1e-13],
        }
    }
}

/// Added to the size of a state in the test for a steady state.
const LEAST: f64 = 1e-3;

/// So many steps are made in an experiment at most.
const MOST_STEPS: usize = 20_000;

/// A state is steady that is nearer to its steady value than this part of it, and whose rate changes it by less than this part in the time that has passed.
const AT_REST: f64 = 1e-8;

/// Singular values of the Jacobian matrix below this part of the largest belong to what is conserved.
const CONSERVED: f64 = 1e-13;

/// The singular values take no more sweeps than these.
const MOST_ITERATIONS: usize = 10_000;

/// The shortest step, whatever the unit of time is; one that does not move time is none either.
const SHORTEST: f64 = 1e-30;

/// Where no steady state is reached by then, that is an error.
const LONGEST: f64 = 1e12;

/// So far on either side of a kink rates are looked at: at the kink itself signs have no value.
fn beside(time: f64) -> f64 {
    1e-11 * (1.0 + time)
}

/// Why an experiment could not be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotFollowed {
    /// The equations have no value there, or no step is small enough.
    #[error("'{experiment}' cannot be followed beyond the time {time:.6}: {why}")]
    Lost {
        /// The experiment.
        experiment: String,
        /// When.
        time: f64,
        /// Why.
        why: String,
    },
    /// What was expected of a measurement, or the size of its error, is no number there.
    #[error(
        "at the time {time} of '{experiment}' nothing can be expected of '{output}': its formula or its error has no value"
    )]
    NoValue {
        /// The experiment.
        experiment: String,
        /// The output.
        output: String,
        /// When.
        time: f64,
    },
    /// It was interrupted.
    #[error("interrupted")]
    Interrupted,
}

/// The states at a time, and their derivatives by the parameters on their scales: a row a state.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    pub states: Vec<f64>,
    pub slopes: DMatrix<f64>,
}

/// The parameters at which is followed.
pub(super) struct At<'a> {
    /// Their values.
    pub values: &'a [f64],
    /// The derivatives of the values by their places on their scales.
    pub slopes: &'a [f64],
}

/// How an experiment is followed.
#[derive(Clone, Copy)]
pub(super) struct How<'h> {
    pub exactness: Exactness,
    /// Whether the sensitivities are followed too.
    pub slopes: bool,
    pub interrupted: &'h dyn Fn() -> bool,
}

impl CompiledPhase {
    /// The state at the start, from what the phase before has left.
    pub fn start(&self, at: &At<'_>, before: Option<&Moment>) -> Moment {
        let (n, p) = (self.given.len(), at.values.len());
        let mut room = Room::default();
        let nothing = vec![0.0; n];
        let mut values = vec![0.0; self.start.rows];
        self.start.values.run(&nothing, at.values, &mut room, &mut values);
        let mut derivatives = vec![0.0; self.start.by_states.len() + self.start.by_parameters.len()];
        self.start.slopes.run(&nothing, at.values, &mut room, &mut derivatives);
        let mut own = DMatrix::zeros(self.start.rows, p);
        let by_parameters = &derivatives[self.start.by_states.len()..];
        for ([row, column], slope) in self.start.by_parameters.iter().zip(by_parameters) {
            own[(*row, *column)] = slope * at.slopes[*column];
        }
        let mut moment = Moment { states: vec![0.0; n], slopes: DMatrix::zeros(n, p) };
        for (state, given) in self.given.iter().enumerate() {
            match (given, before) {
                (Some(row), _) => {
                    moment.states[state] = values[*row];
                    moment.slopes.set_row(state, &own.row(*row));
                }
                (None, Some(before)) => {
                    moment.states[state] = before.states[state];
                    moment.slopes.set_row(state, &before.slopes.row(state));
                }
                (None, None) => {}
            }
        }
        moment
    }

    /// When rates have kinks or jumps until a time, increasing, each with its derivatives by the parameters on their scales.
    fn kinks(&self, at: &At<'_>, until: f64) -> Vec<(f64, DVector<f64>)> {
        let Some(clock) = self.clock else { return Vec::new() };
        let mut room = Room::default();
        let mut values = [(); 3].map(|()| vec![0.0; self.switches.rows]);
        let mut states = vec![0.0; self.given.len()];
        for (time, values) in values.iter_mut().enumerate() {
            states[clock] = time as f64;
            self.switches.values.run(&states, at.values, &mut room, values);
        }
        let mut derivatives = vec![0.0; self.switches.by_states.len() + self.switches.by_parameters.len()];
        let mut found: Vec<(f64, DVector<f64>)> = Vec::new();
        let [first, second, third] = &values;
        for (row, ((a, b), c)) in first.iter().zip(second).zip(third).enumerate() {
            let slope = b - a;
            let is_straight = (c - 2.0 * b + a).abs() <= 1e-9 * (a.abs() + b.abs() + c.abs());
            let time = -a / slope;
            // bent ones are left to the control of the steps
            if !is_straight || !(0.0..=until).contains(&time) {
                continue;
            }
            states[clock] = time;
            self.switches.slopes.run(&states, at.values, &mut room, &mut derivatives);
            let mut moves = DVector::zeros(at.values.len());
            let by_parameters = &derivatives[self.switches.by_states.len()..];
            for ([own, column], derivative) in self.switches.by_parameters.iter().zip(by_parameters) {
                if *own == row {
                    moves[*column] -= derivative * at.slopes[*column] / slope;
                }
            }
            found.push((time, moves));
        }
        found.sort_by(|one, other| one.0.total_cmp(&other.0));
        found.dedup_by(|one, other| one.0 - other.0 <= 2.0 * beside(one.0));
        found
    }

    /// Follows from a start at time zero: the moments at increasing times, and where `rests` is set the steady state of all but the clock.
    /// Where rates have a kink or a jump at a time that is known, steps end there; how the time of a jump moves with the parameters is in
    /// the derivatives.
    ///
    /// # Errors
    /// When and why not.
    pub fn follow(
        &self,
        at: &At<'_>,
        start: &Moment,
        times: &[f64],
        rests: Option<Option<usize>>,
        how: &How<'_>,
    ) -> Result<(Vec<Moment>, Option<Moment>), (f64, String)> {
        let until = if rests.is_some() { LONGEST } else { times.last().copied().unwrap_or(0.0) };
        let kinks = self.kinks(at, until);
        let (Some(clock), false) = (self.clock, kinks.is_empty()) else {
            return self.smoothly(at, (0.0, start), times, rests, how);
        };
        let mut found = Vec::with_capacity(times.len());
        let (mut from, mut start) = (0.0, start.clone());
        let mut rates = [vec![0.0; start.states.len()], vec![0.0; start.states.len()]];
        let mut room = Room::default();
        for (time, moves) in &kinks {
            let [before, behind] = [time - beside(*time), time + beside(*time)];
            if before > from {
                // what is measured at that very time is measured behind it: an input has been switched by then
                let count = times[found.len()..].iter().filter(|own| **own < before).count();
                let mut own: Vec<f64> = times[found.len()..found.len() + count].to_vec();
                own.push(before);
                let (mut there, _) = self.smoothly(at, (from, &start), &own, None, how)?;
                let Some(end) = there.pop() else { break };
                found.extend(there);
                start = end;
            }
            start.states[clock] = before;
            self.rates.values.run(&start.states, at.values, &mut room, &mut rates[0]);
            start.states[clock] = behind;
            self.rates.values.run(&start.states, at.values, &mut room, &mut rates[1]);
            for (state, (one, other)) in rates[0].iter().zip(&rates[1]).enumerate() {
                let jump = one - other;
                if jump.is_finite() && *time > 0.0 {
                    for (slope, moved) in start.slopes.row_mut(state).iter_mut().zip(moves.iter()) {
                        *slope += jump * moved;
                    }
                }
            }
            from = behind;
        }
        let (there, rest) = self.smoothly(at, (from, &start), &times[found.len()..], rests, how)?;
        found.extend(there);
        Ok((found, rest))
    }

    /// The same from a time, where rates are smooth.
    fn smoothly(
        &self,
        at: &At<'_>,
        (from, start): (f64, &Moment),
        times: &[f64],
        rests: Option<Option<usize>>,
        &How { exactness, slopes: with_slopes, interrupted }: &How<'_>,
    ) -> Result<(Vec<Moment>, Option<Moment>), (f64, String)> {
        let (n, all) = (start.states.len(), at.values.len());
        // what the phase does not depend on has no sensitivity
        let mut sought: Vec<usize> = self.rates.by_parameters.iter().map(|[_, column]| *column).collect();
        sought
            .extend((0..all).filter(|column| start.slopes.column(*column).iter().any(|slope| *slope != 0.0)));
        sought.sort_unstable();
        sought.dedup();
        if !with_slopes {
            sought.clear();
        }
        // a problem without any would be of another kind
        let p = sought.len().max(1);
        let (Some(rates), Some(slopes)) = (self.rates.values.loaded(), self.rates.slopes.loaded()) else {
            return Err((0.0, "a constant is no number".to_owned()));
        };
        let place: Vec<Option<usize>> =
            (0..all).map(|column| sought.iter().position(|other| *other == column)).collect();
        let room = RefCell::new(Room::default());
        let (by_states, by_parameters) = (&self.rates.by_states, &self.rates.by_parameters);
        let count = by_states.len() + by_parameters.len();
        // the derivatives at the last states that were asked for
        let known: RefCell<(Vec<f64>, Vec<f64>)> = RefCell::new((vec![f64::NAN; n], vec![0.0; count]));
        let differentiate = |x: &[f64]| {
            let mut known = known.borrow_mut();
            let (last, values) = &mut *known;
            if last.as_slice() != x {
                last.copy_from_slice(x);
                slopes.run(x, at.values, &mut room.borrow_mut(), values);
            }
        };
        let rate = |x: &[f64], _: &[f64], _: f64, y: &mut [f64]| {
            rates.run(x, at.values, &mut room.borrow_mut(), y);
        };
        let by_state = |x: &[f64], _: &[f64], _: f64, v: &[f64], y: &mut [f64]| {
            differentiate(x);
            y.fill(0.0);
            for ([row, column], slope) in by_states.iter().zip(&known.borrow().1) {
                y[*row] += slope * v[*column];
            }
        };
        let by_parameter = |x: &[f64], _: &[f64], _: f64, v: &[f64], y: &mut [f64]| {
            differentiate(x);
            y.fill(0.0);
            for ([row, column], slope) in by_parameters.iter().zip(&known.borrow().1[by_states.len()..]) {
                if let Some(place) = place[*column] {
                    y[*row] += slope * at.slopes[*column] * v[place];
                }
            }
        };
        let begin = |_: &[f64], _: f64, y: &mut [f64]| y.copy_from_slice(&start.states);
        let begin_by = |_: &[f64], _: f64, v: &[f64], y: &mut [f64]| {
            y.fill(0.0);
            for (column, v) in sought.iter().zip(v) {
                for (y, slope) in y.iter_mut().zip(start.slopes.column(*column).iter()) {
                    *y += slope * v;
                }
            }
        };
        let mut found: Vec<Moment> = Vec::with_capacity(times.len());
        let last = times.last().copied().unwrap_or(from);
        while found.len() < times.len() && times[found.len()] <= from {
            found.push(start.clone());
        }
        if rests.is_none() && found.len() == times.len() {
            return Ok((found, None));
        }
        let failed = |error: DiffsolError| (0.0, error.to_string());
        let end = if rests.is_some() { LONGEST } else { last };
        let build = |[relative, absolute]: [f64; 2]| {
            OdeBuilder::<NalgebraMat<f64>>::new()
                .rtol(relative)
                .atol([absolute])
                .sens_rtol(relative * 10.0)
                .sens_atol([absolute * 100.0])
                .t0(from)
                .h0(if last > from { last - from } else { 1.0 } * 1e-6)
                .p(vec![0.0; p])
                .rhs_sens_implicit(rate, by_state, by_parameter)
                .init_sens(begin, begin_by, n)
                .build()
                .map(|mut problem| {
                    problem.ode_options.min_timestep = SHORTEST;
                    problem
                })
        };
        // the largest sum of a row's magnitudes: no eigenvalue is larger
        let norm = |x: &[f64]| {
            differentiate(x);
            let mut sums = vec![0.0; n];
            for ([row, _], slope) in by_states.iter().zip(&known.borrow().1) {
                sums[*row] += slope.abs();
            }
            sums.into_iter().fold(0.0, f64::max)
        };
        // by Newton's step, the shortest one where something is conserved: how far each state is from its steady value
        let distance = |x: &[f64], rates: &[f64]| -> Option<DVector<f64>> {
            differentiate(x);
            let mut jacobian = DMatrix::zeros(n, n);
            for ([row, column], slope) in by_states.iter().zip(&known.borrow().1) {
                jacobian[(*row, *column)] = *slope;
            }
            let mut right = DVector::from_column_slice(rates);
            if let Some(clock) = self.clock {
                jacobian.row_mut(clock).fill(0.0);
                jacobian.column_mut(clock).fill(0.0);
                right[clock] = 0.0;
            }
            if jacobian.iter().chain(right.iter()).any(|value| !value.is_finite()) {
                return None;
            }
            let svd = jacobian.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS)?;
            svd.solve(&right, CONSERVED * svd.singular_values.max()).ok()
        };
        let way = Way {
            from,
            times,
            rests,
            end,
            sought: &sought,
            all,
            rate: &rate,
            distance: &distance,
            interrupted,
        };
        let problem = build(exactness.explicit()).map_err(failed)?;
        let mut solver = problem.tsit45_sens().map_err(failed)?;
        let explicit = way.go(&mut solver, found.clone(), Some(&norm));
        drop(solver);
        match explicit {
            Err(Stopped::Stiff) => {}
            Ok(there) => return Ok(there),
            Err(Stopped::Lost(time, why)) if interrupted() => return Err((time, why)),
            // where no explicit step is small enough an implicit one may be
            Err(Stopped::Lost(..)) => {}
        }
        let problem = build(exactness.implicit()).map_err(failed)?;
        let mut solver = problem.bdf_sens::<NalgebraLU<f64>>().map_err(failed)?;
        way.go(&mut solver, found, None).map_err(|stopped| match stopped {
            Stopped::Lost(time, why) => (time, why),
            Stopped::Stiff => (0.0, "it is stiff".to_owned()),
        })
    }
}

/// Why a way was not gone to its end.
enum Stopped {
    /// An explicit method takes too many steps.
    Stiff,
    /// When, and why.
    Lost(f64, String),
}

/// An explicit method is given up after so many steps.
const EASY: usize = 4_000;

/// So often is looked whether its steps are as short as stability demands; then it is given up where it needs so many more.
const LOOK: usize = 25;
const MORE: f64 = 500.0;

/// Steps times the norm of the Jacobian matrix above this are as long as stability allows.
const STABLE: f64 = 1.0;

/// Rates at states, parameters and a time.
type Rate<'r> = dyn Fn(&[f64], &[f64], f64, &mut [f64]) + 'r;

/// How far states with these rates are from the steady state.
type Distance<'d> = dyn Fn(&[f64], &[f64]) -> Option<DVector<f64>> + 'd;

/// A norm of the Jacobian matrix at states.
type Norm<'n> = dyn Fn(&[f64]) -> f64 + 'n;

/// What is to be followed.
struct Way<'w> {
    from: f64,
    times: &'w [f64],
    rests: Option<Option<usize>>,
    end: f64,
    /// The parameters that have sensitivities, of all.
    sought: &'w [usize],
    all: usize,
    rate: &'w Rate<'w>,
    distance: &'w Distance<'w>,
    interrupted: &'w dyn Fn() -> bool,
}

impl Way<'_> {
    /// Goes through all times, and to the steady state where that is asked for.
    fn go<'s, E, S>(
        &self,
        solver: &mut S,
        mut found: Vec<Moment>,
        norm: Option<&Norm<'_>>,
    ) -> Result<(Vec<Moment>, Option<Moment>), Stopped>
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 's,
        S: OdeSolverMethod<'s, E>,
    {
        let lost = |time: f64, error: DiffsolError| Stopped::Lost(time, error.to_string());
        solver.set_stop_time(self.end).map_err(|error| lost(0.0, error))?;
        let (mut rates, mut looked) = (Vec::new(), self.from);
        for step in 0..MOST_STEPS {
            let before = solver.state().t;
            let stopped = solver.step().map_err(|error| lost(before, error))?;
            let time = solver.state().t;
            // an integrator may take a number that is none for a small error
            if solver.state().y.batch_as_slice(0).iter().any(|state| !state.is_finite()) {
                return Err(Stopped::Lost(before, "the rates have no value there".to_owned()));
            }
            if (self.interrupted)() {
                return Err(Stopped::Lost(time, "interrupted".to_owned()));
            }
            if time <= before {
                return Err(Stopped::Lost(time, "no step is small enough".to_owned()));
            }
            if let Some(norm) = norm
                && step % LOOK == LOOK - 1
            {
                let last = self.times.last().copied().unwrap_or(0.0);
                let stride = (time - looked) / LOOK as f64;
                looked = time;
                let is_bounded = stride * norm(solver.state().y.batch_as_slice(0)) > STABLE;
                if step >= EASY || is_bounded && (last - time) / stride > MORE {
                    return Err(Stopped::Stiff);
                }
            }
            while found.len() < self.times.len() && self.times[found.len()] <= time {
                found.push(self.moment(solver, self.times[found.len()])?);
            }
            if found.len() == self.times.len() {
                let Some(clock) = self.rests else { return Ok((found, None)) };
                let states = solver.state().y.batch_as_slice(0).to_vec();
                rates.resize(states.len(), 0.0);
                (self.rate)(&states, &[], time, &mut rates);
                let is_nothing = |state: usize, change: f64| {
                    Some(state) == clock || change.abs() <= AT_REST * (states[state].abs() + LEAST)
                };
                // after a short time any rate has changed little: the distance to the steady state counts
                let is_constant_state = (0..states.len()).all(|state| is_nothing(state, rates[state] * time))
                    && (self.distance)(&states, &rates).is_some_and(|distance| {
                        (0..states.len()).all(|state| is_nothing(state, distance[state]))
                    });
                if is_constant_state {
                    let moment = self.moment(solver, time)?;
                    return Ok((found, Some(moment)));
                }
                // towards a steady state steps grow for ever, and an explicit method's do not
                if norm.is_some() && step >= EASY / 4 {
                    return Err(Stopped::Stiff);
                }
            }
            if stopped == OdeSolverStopReason::TstopReached {
                return Err(Stopped::Lost(time, "it does not come to rest".to_owned()));
            }
        }
        Err(Stopped::Lost(solver.state().t, format!("more than {MOST_STEPS} steps are needed")))
    }

    fn moment<'s, E, S>(&self, solver: &S, time: f64) -> Result<Moment, Stopped>
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 's,
        S: OdeSolverMethod<'s, E>,
    {
        let lost = |error: DiffsolError| Stopped::Lost(time, error.to_string());
        let states = solver.interpolate(time).map_err(lost)?.batch_as_slice(0).to_vec();
        let mut moment = Moment { slopes: DMatrix::zeros(states.len(), self.all), states };
        if !self.sought.is_empty() {
            let lanes = solver.interpolate_sens(time).map_err(lost)?;
            for (lane, column) in self.sought.iter().enumerate() {
                moment.slopes.column_mut(*column).copy_from_slice(lanes.batch_as_slice(lane));
            }
        }
        Ok(moment)
    }
}
