//! The likelihood of parameters, with its gradient and the information that is expected of the measurements.

use super::compiled::{CompiledPhase, Names, Room, Sloped};
use super::problem::JointProblem;
use super::simulate::{At, Exactness, Moment, NotFollowed};
use nalgebra::{DMatrix, DVector};
use palmistry_math::expression::NodeId;
use std::collections::HashMap;

/// An experiment as programs.
struct CompiledExperiment {
    before: Option<CompiledPhase>,
    phase: CompiledPhase,
    /// The times of measurement, increasing; without the measurements at steady state.
    times: Vec<f64>,
    /// Whether something is measured at steady state.
    rests: bool,
}

/// A measurement as a program.
struct CompiledMeasurement {
    /// The place of its formulas.
    formula: usize,
    /// The place among the times of its experiment; none at steady state.
    moment: Option<usize>,
}

/// What is expected of the measurements at some parameters.
#[derive(Clone, Debug)]
pub struct SimulatedExperiments {
    /// Minus the logarithm of the likelihood, priors included.
    pub objective: f64,
    /// The logarithm of the likelihood, without priors.
    pub log_likelihood: f64,
    /// The sum of the squares of the residuals, each over the size of its error; of errors by Laplace twice their absolute values.
    pub chi_square: f64,
    /// The gradient of the objective by the parameters on their scales.
    pub gradient: DVector<f64>,
    /// The information that is expected (Fisher), on the same scales, priors included.
    pub information: DMatrix<f64>,
    /// What is expected of each measurement.
    pub expected: Vec<f64>,
    /// The size of each one's error.
    pub sizes: Vec<f64>,
    /// The residual of each over that size, on the scale on which it is compared.
    pub residuals: Vec<f64>,
}

/// A problem as programs: ready to be simulated.
pub struct Likelihood {
    problem: JointProblem,
    experiments: Vec<CompiledExperiment>,
    formulas: Vec<Sloped>,
    measurements: Vec<CompiledMeasurement>,
}

impl Likelihood {
    /// Compiles a problem.
    ///
    /// # Errors
    /// The name of something of which neither a state nor a parameter nor a value is known.
    pub fn new(problem: JointProblem) -> Result<Likelihood, String> {
        let mut system = problem.system.clone();
        let names = Names::of(&problem);
        let mut experiments = Vec::new();
        let mut all_times = vec![Vec::new(); problem.experiments.len()];
        problem.measurements.iter().for_each(|one| all_times[one.experiment].push(one.time));
        for (at, one) in problem.experiments.iter().enumerate() {
            let before = one
                .before
                .as_ref()
                .map(|phase| CompiledPhase::new(&mut system, phase, &names, problem.clock));
            let mut times = std::mem::take(&mut all_times[at]);
            times.sort_by(f64::total_cmp);
            times.dedup();
            let rests = times.pop_if(|last| last.is_infinite()).is_some();
            experiments.push(CompiledExperiment {
                before: before.transpose()?,
                phase: CompiledPhase::new(&mut system, &one.phase, &names, problem.clock)?,
                times,
                rests,
            });
        }
        let mut places: HashMap<[NodeId; 2], usize> = HashMap::new();
        let mut formulas = Vec::new();
        let mut measurements = Vec::new();
        for one in &problem.measurements {
            let key = [one.expected, one.size];
            let formula = match places.get(&key) {
                Some(place) => *place,
                None => {
                    formulas.push(Sloped::new(&mut system, &key, &names)?);
                    places.insert(key, formulas.len() - 1);
                    formulas.len() - 1
                }
            };
            let times = &experiments[one.experiment].times;
            let moment = one.time.is_finite().then(|| times.partition_point(|time| *time < one.time));
            measurements.push(CompiledMeasurement { formula, moment });
        }
        Ok(Likelihood { problem, experiments, formulas, measurements })
    }

    /// The problem.
    pub fn problem(&self) -> &JointProblem {
        &self.problem
    }

    /// Simulates all experiments.
    ///
    /// # Errors
    /// Where a simulation comes to no end, or a measurement has no expected value.
    pub fn at(
        &self,
        scaled: &[f64],
        exactness: Exactness,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<SimulatedExperiments, NotFollowed> {
        let values = self.problem.values(scaled);
        let slopes: Vec<f64> =
            self.problem.parameters.iter().zip(scaled).map(|(one, place)| one.scale.slope(*place)).collect();
        let at = At { values: &values, slopes: &slopes };
        let moments = self
            .experiments
            .iter()
            .zip(&self.problem.experiments)
            .map(|(one, own)| {
                one.moments(&at, self.problem.clock, (exactness, interrupted)).map_err(|(time, why)| {
                    match interrupted() {
                        true => NotFollowed::Interrupted,
                        false => NotFollowed::Lost { experiment: own.name.clone(), time, why },
                    }
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        self.compared(scaled, &at, &moments)
    }

    /// The terms of all measurements and priors.
    fn compared(
        &self,
        scaled: &[f64],
        at: &At<'_>,
        moments: &[(Vec<Moment>, Option<Moment>)],
    ) -> Result<SimulatedExperiments, NotFollowed> {
        let (p, count) = (scaled.len(), self.measurements.len());
        let mut found = SimulatedExperiments {
            objective: 0.0,
            log_likelihood: 0.0,
            chi_square: 0.0,
            gradient: DVector::zeros(p),
            information: DMatrix::zeros(p, p),
            expected: Vec::with_capacity(count),
            sizes: Vec::with_capacity(count),
            residuals: Vec::with_capacity(count),
        };
        let mut room = Room::default();
        for (one, own) in self.measurements.iter().zip(&self.problem.measurements) {
            let no_value = || NotFollowed::NoValue {
                experiment: self.problem.experiments[own.experiment].name.clone(),
                output: own.output.clone(),
                time: own.time,
            };
            let (moments, rest) = &moments[own.experiment];
            let moment = match one.moment {
                Some(place) => moments.get(place),
                None => rest.as_ref(),
            };
            let moment = moment.ok_or_else(no_value)?;
            let formula = &self.formulas[one.formula];
            let mut both = [0.0; 2];
            formula.values.run(&moment.states, at.values, &mut room, &mut both);
            let [expected, size] = both;
            let term = own.law.term(own.scale, own.value, expected, size).ok_or_else(no_value)?;
            let mut derivatives = vec![0.0; formula.by_states.len() + formula.by_parameters.len()];
            formula.slopes.run(&moment.states, at.values, &mut room, &mut derivatives);
            let mut by = [DVector::zeros(p), DVector::zeros(p)];
            for ([row, state], slope) in formula.by_states.iter().zip(&derivatives) {
                by[*row].axpy(*slope, &moment.slopes.row(*state).transpose(), 1.0);
            }
            let rest = &derivatives[formula.by_states.len()..];
            for ([row, column], slope) in formula.by_parameters.iter().zip(rest) {
                by[*row][*column] += slope * at.slopes[*column];
            }
            if by.iter().flat_map(|by| by.iter()).any(|slope| !slope.is_finite()) {
                return Err(no_value());
            }
            found.objective += term.value;
            found.chi_square += match own.law {
                super::ErrorLaw::Normal => term.residual * term.residual,
                super::ErrorLaw::Laplace => 2.0 * term.residual.abs(),
            };
            found.gradient.axpy(term.by_expected, &by[0], 1.0);
            found.gradient.axpy(term.by_size, &by[1], 1.0);
            for (by, weight) in by.iter().zip(term.information) {
                found.information.ger(weight, by, by, 1.0);
            }
            found.expected.push(expected);
            found.sizes.push(size);
            found.residuals.push(term.residual);
        }
        found.log_likelihood = -found.objective;
        for (place, one) in self.problem.parameters.iter().enumerate() {
            let Some(prior) = &one.prior else { continue };
            let [value, slope, bend] = prior.term(one.scale, scaled[place]);
            found.objective += value;
            found.gradient[place] += slope;
            found.information[(place, place)] += bend;
        }
        Ok(found)
    }
}

impl CompiledExperiment {
    fn moments(
        &self,
        at: &At<'_>,
        clock: Option<usize>,
        how: (Exactness, &dyn Fn() -> bool),
    ) -> Result<(Vec<Moment>, Option<Moment>), (f64, String)> {
        let before = match &self.before {
            None => None,
            Some(phase) => {
                let start = phase.start(at, None);
                let (_, rest) = phase
                    .follow(at, &start, &[], Some(clock), how)
                    .map_err(|(time, why)| (time, format!("before it begins, {why}")))?;
                rest
            }
        };
        let start = self.phase.start(at, before.as_ref());
        let rests = self.rests.then_some(clock);
        self.phase.follow(at, &start, &self.times, rests, how)
    }
}
