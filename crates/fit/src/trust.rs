//! The search for the largest likelihood from one start, as a solver of argmin.

use super::Exactness;
use super::likelihood::{Likelihood, SimulatedExperiments};
use argmin::core::{Error, IterState, KV, Problem, Solver, State, TerminationReason, TerminationStatus};
use nalgebra::{Cholesky, DMatrix, DVector};

/// What the solver knows between two steps.
pub(super) type Iteration = IterState<DVector<f64>, DVector<f64>, (), DMatrix<f64>, (), f64>;

/// The damping of the first step, relative to the information.
const FIRST: f64 = 1e-3;

/// The damping beyond which no step is tried any more.
const STRONGEST: f64 = 1e12;

/// The information of an undetermined parameter counts as this, in units of its scale.
const LEAST_INFORMATION: f64 = 1e-12;

/// No parameter goes farther in one step, in decades or units of its logarithm; of one on a linear scale, relative to its range.
const LONGEST: f64 = 1.0;

/// A step is made that gains more than this part of what it promises.
const LEAST_GAIN: f64 = 1e-4;

/// From so many parameters on a step is first tried without sensitivities after one that failed, where it promises so much that errors of the integration
/// do not matter: one that fails, too, needs none.
const MANY: usize = 8;
const PLAIN: f64 = 1e-2;

/// What is searched, with some parameters fixed.
pub(super) struct Search<'l> {
    pub likelihood: &'l Likelihood,
    /// The bounds of parameters on their scales; both are one where a parameter is fixed.
    pub bounds: Vec<[f64; 2]>,
    /// How exactly is simulated.
    pub exactness: Exactness,
    pub interrupted: &'l (dyn Fn() -> bool + Sync),
}

impl Search<'_> {
    /// Where the next step promises to raise the logarithm of the likelihood by less than this, the search has converged: a difference of one
    /// is hardly significant.
    fn settled(&self) -> f64 {
        match self.exactness {
            Exactness::Search => 1e-5,
            Exactness::Answer => 1e-9,
        }
    }

    fn held(&self, place: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(place.len(), |i, _| place[i].clamp(self.bounds[i][0], self.bounds[i][1]))
    }
}

/// Fisher's scoring within a region of trust: the Hessian is the information that is expected, damped as by Levenberg and Marquardt, between
/// bounds by a set of those that hold.
///
/// Reference: J. Nocedal, S. J. Wright, Numerical Optimization, 2006, sections 10.3 and 16.5.
#[derive(Default)]
pub(super) struct Scoring {
    lambda: f64,
    growth: f64,
    scales: Vec<f64>,
    here: Option<SimulatedExperiments>,
    pub converged: bool,
    pub stuck: bool,
}

impl Scoring {
    pub fn from(here: SimulatedExperiments) -> Scoring {
        Scoring { lambda: FIRST, growth: 2.0, here: Some(here), ..Scoring::default() }
    }

    /// A search that goes on with this damping and its growth; what is known of the place is computed anew.
    pub fn with_damping([lambda, growth]: [f64; 2]) -> Scoring {
        Scoring { lambda, growth, ..Scoring::default() }
    }

    /// The damping, and its growth.
    pub fn damping(&self) -> [f64; 2] {
        [self.lambda, self.growth]
    }

    /// The step with this damping.
    fn step(
        &self,
        search: &Search<'_>,
        here: &SimulatedExperiments,
        place: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let p = place.len();
        let pushed = |i: usize| {
            let [low, high] = search.bounds[i];
            (place[i] <= low && here.gradient[i] > 0.0) || (place[i] >= high && here.gradient[i] < 0.0)
        };
        let mut held: Vec<Option<f64>> = (0..p).map(|i| pushed(i).then_some(0.0)).collect();
        let reach = |i: usize| {
            let [low, high] = search.bounds[i];
            let longest = match search.likelihood.problem().parameters[i].scale {
                super::ParameterScale::Linear => LONGEST * (high - low) / 8.0,
                super::ParameterScale::Log => LONGEST * std::f64::consts::LN_10,
                super::ParameterScale::Log10 => LONGEST,
            };
            [low.max(place[i] - longest), high.min(place[i] + longest)]
        };
        loop {
            let free: Vec<usize> = (0..p).filter(|i| held[*i].is_none()).collect();
            let mut step = DVector::from_fn(p, |i, _| held[i].unwrap_or(0.0));
            if !free.is_empty() {
                let moved = &here.information * &step;
                let scale = |i: usize| self.scales[free[i]].sqrt();
                // in units in which each parameter's own information is one
                let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| {
                    let own = here.information[(free[i], free[j])] / (scale(i) * scale(j));
                    if i == j { own + self.lambda } else { own }
                });
                let right = DVector::from_fn(free.len(), |i, _| {
                    -(here.gradient[free[i]] + moved[free[i]]) / scale(i)
                });
                let own = Cholesky::new(matrix)?.solve(&right);
                for (i, place) in free.iter().enumerate() {
                    step[*place] = own[i] / scale(i);
                }
            }
            let mut is_within = true;
            for i in free {
                let [low, high] = reach(i);
                let there = place[i] + step[i];
                if there < low || there > high {
                    held[i] = Some(there.clamp(low, high) - place[i]);
                    is_within = false;
                }
            }
            if is_within {
                return step.iter().all(|part| part.is_finite()).then_some(step);
            }
        }
    }
}

impl Solver<Search<'_>, Iteration> for Scoring {
    fn name(&self) -> &str {
        "scoring"
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<Search<'_>>,
        state: Iteration,
    ) -> Result<(Iteration, Option<KV>), Error> {
        let place = state.get_param().cloned().ok_or_else(|| Error::msg("no start"))?;
        let here = match self.here.take() {
            Some(here) => here,
            None => problem.problem("simulations", |search| {
                Ok(search.likelihood.at(place.as_slice(), search.exactness, &|| (search.interrupted)())?)
            })?,
        };
        // an undetermined parameter moves little
        let least = (1e-12 * here.information.diagonal().max()).max(LEAST_INFORMATION);
        self.scales = here.information.diagonal().iter().map(|own| own.max(least)).collect();
        while self.lambda < STRONGEST {
            let planned = problem.problem("steps", |search| {
                let Some(step) = self.step(search, &here, &place) else { return Ok(None) };
                let gain = -(here.gradient.dot(&step) + 0.5 * (&here.information * &step).dot(&step));
                Ok(Some((search.held(&(&place + &step)), gain, search.settled())))
            })?;
            if let Some((there, gain, settled)) = planned {
                if gain.abs() <= settled && self.lambda <= FIRST {
                    self.converged = true;
                    break;
                }
                if gain <= 0.0 {
                    self.lambda *= self.growth;
                    self.growth *= 2.0;
                    continue;
                }
                let tried = problem.problem("simulations", |search| {
                    let interrupted = || (search.interrupted)();
                    if self.growth > 2.0 && there.len() >= MANY && gain > PLAIN {
                        match search.likelihood.objective(there.as_slice(), search.exactness, &interrupted) {
                            Ok(alone) if here.objective - alone <= LEAST_GAIN * gain => return Ok(None),
                            Ok(_) => {}
                            Err(error) => return Ok(Some(Err(error))),
                        }
                    }
                    Ok(Some(search.likelihood.at(there.as_slice(), search.exactness, &interrupted)))
                })?;
                match tried {
                    Some(Err(error @ super::NotFollowed::Interrupted)) => return Err(error.into()),
                    None | Some(Err(_)) => {}
                    Some(Ok(tried)) => {
                        let ratio = (here.objective - tried.objective) / gain;
                        if ratio > LEAST_GAIN {
                            let shrink = 1.0 - (2.0 * ratio - 1.0).powi(3);
                            self.lambda = (self.lambda * shrink.clamp(0.1, 2.0)).max(1e-12);
                            self.growth = 2.0;
                            self.converged = gain <= settled;
                            let state =
                                state.param(there).cost(tried.objective).gradient(tried.gradient.clone());
                            self.here = Some(tried);
                            return Ok((state, None));
                        }
                        if gain <= settled {
                            // the rest is rounding
                            self.converged = true;
                            break;
                        }
                    }
                }
            }
            self.lambda *= self.growth;
            self.growth *= 2.0;
        }
        self.stuck = !self.converged;
        let state = state.param(place).cost(here.objective);
        self.here = Some(here);
        Ok((state, None))
    }

    fn terminate(&mut self, _state: &Iteration) -> TerminationStatus {
        match (self.converged, self.stuck) {
            (true, _) => TerminationStatus::Terminated(TerminationReason::SolverConverged),
            (_, true) => TerminationStatus::Terminated(TerminationReason::SolverExit(
                "no step raises the likelihood".into(),
            )),
            _ => TerminationStatus::NotTerminated,
        }
    }
}
