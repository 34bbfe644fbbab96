//! The likelihood of parameters, with its gradient and the information that is expected of the measurements.

use super::compiled::{CompiledPhase, Names, Room, Sloped};
use super::problem::{JointProblem, Phase};
use super::simulate::{At, Exactness, How, Moment, NotFollowed};
use nalgebra::{DMatrix, DVector};
use palmistry_math::expression::NodeId;
use std::collections::HashMap;

/// An experiment as programs.
struct CompiledExperiment {
    /// The place of the phase before it.
    before: Option<usize>,
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
    /// The phases before experiments, each once: a control is often that of many experiments.
    befores: Vec<CompiledPhase>,
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
        let mut befores = Vec::new();
        let mut known: HashMap<&Phase, usize> = HashMap::new();
        let mut all_times = vec![Vec::new(); problem.experiments.len()];
        problem.measurements.iter().for_each(|one| all_times[one.experiment].push(one.time));
        for (at, one) in problem.experiments.iter().enumerate() {
            let before = match &one.before {
                None => None,
                Some(phase) => Some(match known.get(phase) {
                    Some(place) => *place,
                    None => {
                        befores.push(CompiledPhase::new(&mut system, phase, &names, problem.clock)?);
                        known.insert(phase, befores.len() - 1);
                        befores.len() - 1
                    }
                }),
            };
            let mut times = std::mem::take(&mut all_times[at]);
            times.sort_by(f64::total_cmp);
            times.dedup();
            let rests = times.pop_if(|last| last.is_infinite()).is_some();
            experiments.push(CompiledExperiment {
                before,
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
        Ok(Likelihood { problem, befores, experiments, formulas, measurements })
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
        self.simulated(scaled, &How { exactness, slopes: true, interrupted })
    }

    /// The objective alone, without sensitivities: less work by about as many times as there are parameters. Steps are chosen for the states alone, so
    /// that its last digits are others than those of [`Likelihood::at`].
    ///
    /// # Errors
    /// As there.
    pub fn objective(
        &self,
        scaled: &[f64],
        exactness: Exactness,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<f64, NotFollowed> {
        Ok(self.simulated(scaled, &How { exactness, slopes: false, interrupted })?.objective)
    }

    fn simulated(&self, scaled: &[f64], how: &How<'_>) -> Result<SimulatedExperiments, NotFollowed> {
        let values = self.problem.values(scaled);
        let slopes: Vec<f64> =
            self.problem.parameters.iter().zip(scaled).map(|(one, place)| one.scale.slope(*place)).collect();
        let at = At { values: &values, slopes: &slopes };
        let mut rests: Vec<Option<Moment>> = vec![None; self.befores.len()];
        let mut moments = Vec::with_capacity(self.experiments.len());
        for (one, own) in self.experiments.iter().zip(&self.problem.experiments) {
            let found =
                self.moments(one, &at, how, &mut rests).map_err(|(time, why)| match (how.interrupted)() {
                    true => NotFollowed::Interrupted,
                    false => NotFollowed::Lost { experiment: own.name.clone(), time, why },
                })?;
            moments.push(found);
        }
        self.compared(scaled, &at, &moments)
    }

    /// An experiment from what came before it; the steady states that are known already, by the places of their phases.
    fn moments(
        &self,
        one: &CompiledExperiment,
        at: &At<'_>,
        how: &How<'_>,
        rests: &mut [Option<Moment>],
    ) -> Result<(Vec<Moment>, Option<Moment>), (f64, String)> {
        let before = match one.before {
            None => None,
            Some(place) => {
                if rests[place].is_none() {
                    let phase = &self.befores[place];
                    let rest = phase.rest(at, &phase.start(at, None), how);
                    rests[place] =
                        Some(rest.map_err(|(time, why)| (time, format!("before it begins, {why}")))?);
                }
                rests[place].as_ref()
            }
        };
        let start = one.phase.start(at, before);
        if one.rests && one.times.is_empty() {
            return Ok((Vec::new(), Some(one.phase.rest(at, &start, how)?)));
        }
        let rests = one.rests.then_some(self.problem.clock);
        one.phase.follow(at, &start, &one.times, rests, how)
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
