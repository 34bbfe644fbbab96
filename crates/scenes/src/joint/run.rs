//! The fit of several experiments, and how good its answer is.

use super::checkpoint::{SearchFile, question};
use super::keys::JointScene;
use palmistry_fit::{
    ErrorLaw, Exactness, Information, JointFit, JointProblem, Keep, Likelihood, ParameterProfile,
    SimulatedExperiments, StartEnd, fit, profile,
};
use palmistry_lang::ReadError;
use palmistry_observe::exceeded_with;
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// A parameter is at a bound if its distance to it is below this fraction of the range.
const AT_BOUND: f64 = 1e-6;

/// States and their derivatives at all times of measurement are kept at once: this many numbers at most.
const MOST_NUMBERS: usize = 50_000_000;

/// The significance level of the chi-square test: a fit with a smaller probability is rejected.
const FALSE_ALARM: f64 = 0.01;

/// How well the best parameters explain the measurements, where the size of the errors is known.
#[derive(Clone, Copy, Debug)]
pub struct GoodnessOfFit {
    /// The sum of the squares of the residuals over the sizes of their errors.
    pub chi_square: f64,
    /// The number of measurements less that of the identifiable directions of the parameters.
    pub degrees: usize,
    /// The probability of a larger chi-square by chance (the p-value).
    pub probability: f64,
}

impl GoodnessOfFit {
    /// Whether it passes the chi-square test.
    pub fn fits(&self) -> bool {
        self.probability >= FALSE_ALARM
    }
}

/// The expected measurements at the published values.
#[derive(Clone, Debug)]
pub struct NominalAnswer {
    /// The values, on the scales of the parameters.
    pub place: Vec<f64>,
    /// The simulated experiments, or why there are none.
    pub simulated: Result<SimulatedExperiments, String>,
}

/// The answer of all experiments together.
#[derive(Debug)]
pub struct JointAnswer {
    /// At the published values, where all parameters have one.
    pub nominal: Option<NominalAnswer>,
    /// The searches; none where none was asked for, and why there is none.
    pub fit: Option<Result<JointFit, String>>,
    /// Of each parameter whether its best value lies at a bound.
    pub at_bounds: Vec<bool>,
    /// The information of the measurements about the parameters.
    pub information: Option<Information>,
    /// The searches that ended elsewhere and as likely, by their places: where there are some, parameters have several values that explain the
    /// measurements.
    pub apart: Vec<usize>,
    /// The test of fit; none where the size of the errors is estimated, or errors are not normal.
    pub goodness: Option<GoodnessOfFit>,
    /// Profile likelihoods, where they were asked for.
    pub profiles: Vec<ParameterProfile>,
}

impl JointAnswer {
    /// Whether something was found and no test rejects it.
    pub fn as_expected(&self) -> bool {
        let fits = self.goodness.is_none_or(|own| own.fits());
        match &self.fit {
            Some(fit) => fit.as_ref().is_ok_and(|fit| fit.best().end == StartEnd::Converged) && fits,
            None => self.nominal.as_ref().is_none_or(|own| own.simulated.is_ok()),
        }
    }
}

/// A scene of several experiments with its measurements.
pub struct JointExperiments {
    /// The scene.
    pub scene: JointScene,
    /// All of it as programs.
    pub likelihood: Likelihood,
}

impl JointExperiments {
    /// Takes a scene and its measurements, or those of another file.
    ///
    /// # Errors
    /// What is wrong with the model, the scene or the measurements, and where.
    pub fn new(scene: JointScene, data: Option<&Path>) -> Result<JointExperiments, ReadError> {
        let problem = scene.problem(data)?;
        let times: std::collections::BTreeSet<(usize, u64)> =
            problem.measurements.iter().map(|one| (one.experiment, one.time.to_bits())).collect();
        let numbers = times.len().saturating_mul(problem.states.len() * (1 + problem.parameters.len()));
        if numbers > MOST_NUMBERS {
            let message = format!(
                "{} times of measurement with {} states and {} parameters take {numbers} numbers, and at most {MOST_NUMBERS} are held",
                times.len(),
                problem.states.len(),
                problem.parameters.len()
            );
            return Err(scene.error_at(
                "measurements",
                message,
                "take every tenth measurement, or estimate fewer parameters",
            ));
        }
        let likelihood = Likelihood::new(problem).map_err(|name| {
            let help =
                format!("add '{name}' to [known] or to [parameters], or set it in each experiment or row");
            scene.error_at("experiments", format!("nothing says what '{name}' is"), help)
        })?;
        Ok(JointExperiments { scene, likelihood })
    }

    /// The problem.
    pub fn problem(&self) -> &JointProblem {
        self.likelihood.problem()
    }

    /// How many searches and profiles there are to do.
    pub fn count(&self) -> usize {
        self.scene.starts + if self.scene.profiles { self.problem().parameters.len() } else { 0 }
    }

    /// The file of the searches of this fit: what is in it where it is there.
    ///
    /// # Errors
    /// In words: it cannot be read, is damaged, or is of another question.
    pub fn searches(&self, path: &Path) -> Result<SearchFile, String> {
        let (scene, problem) = (&self.scene, self.problem());
        let question = question(problem, (scene.starts, scene.steps, scene.seed));
        let bounds: Vec<[f64; 2]> = problem.parameters.iter().map(|one| one.scaled_bounds()).collect();
        SearchFile::open(path, question, &bounds)
    }

    /// Simulates at the published values, searches from all starts, and determines which parameters are identifiable. Searches that are kept go on.
    pub fn run(
        &self,
        keep: Option<&Arc<dyn Keep>>,
        interrupted: &(dyn Fn() -> bool + Sync),
        done: &(dyn Fn() + Sync),
    ) -> JointAnswer {
        let nominal = self.problem().nominal().map(|place| {
            let simulated = self
                .likelihood
                .at(&place, Exactness::Answer, &|| interrupted())
                .map_err(|why| why.to_string());
            NominalAnswer { place, simulated }
        });
        let mut answer = JointAnswer {
            nominal,
            fit: None,
            at_bounds: Vec::new(),
            information: None,
            apart: Vec::new(),
            goodness: None,
            profiles: Vec::new(),
        };
        if self.scene.starts == 0 {
            return answer;
        }
        let found = fit(
            &self.likelihood,
            (self.scene.starts, self.scene.steps, self.scene.seed),
            keep,
            interrupted,
            done,
        );
        if let Ok(found) = &found {
            let best = found.best();
            answer.at_bounds = self.at_bounds(&best.found);
            let information = Information::of(&found.simulated, &answer.at_bounds);
            // without convergence there is a better fit, and nothing to be tested
            if best.end == StartEnd::Converged {
                let told = information.directions.iter().filter(|one| one.deviation.is_finite()).count();
                answer.goodness = self.goodness(&found.simulated, told);
            }
            if best.end == StartEnd::Converged {
                answer.apart = found.apart(&information);
            }
            if self.scene.profiles {
                let one = |place: usize| {
                    let deviation = information.deviations[place].unwrap_or(f64::INFINITY);
                    let found =
                        profile(&self.likelihood, &best.found, best.objective, place, deviation, interrupted);
                    done();
                    found
                };
                answer.profiles = (0..best.found.len()).into_par_iter().map(one).collect();
            }
            answer.information = Some(information);
        }
        answer.fit = Some(found);
        answer
    }

    fn at_bounds(&self, found: &[f64]) -> Vec<bool> {
        let is_at = |(one, place): (&palmistry_fit::EstimatedParameter, &f64)| {
            let [low, high] = one.scaled_bounds();
            (place - low).min(high - place) <= AT_BOUND * (high - low)
        };
        self.problem().parameters.iter().zip(found).map(is_at).collect()
    }

    /// A chi-square test where this many directions of the parameters are identifiable: only these reduce the degrees of freedom.
    fn goodness(&self, simulated: &SimulatedExperiments, told: usize) -> Option<GoodnessOfFit> {
        let problem = self.problem();
        let sought: Vec<_> = problem.parameters.iter().map(|one| one.symbol).collect();
        let sizes = problem.system.graph.symbols_of(problem.measurements.iter().map(|one| one.size));
        let is_known = !sizes.iter().any(|symbol| sought.contains(symbol) || problem.states.contains(symbol));
        let is_normal = problem.measurements.iter().all(|one| one.law == ErrorLaw::Normal);
        let has_prior = problem.parameters.iter().any(|one| one.prior.is_some());
        if !is_known || !is_normal || has_prior {
            return None;
        }
        let degrees = problem.measurements.len().checked_sub(told).filter(|degrees| *degrees > 0)?;
        let probability = exceeded_with(simulated.chi_square, degrees as f64, 0.0);
        Some(GoodnessOfFit { chi_square: simulated.chi_square, degrees, probability })
    }
}
