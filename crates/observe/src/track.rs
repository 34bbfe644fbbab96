//! What an observer gives back: what it believed sample by sample, and how its updates ended.

use super::Lost;
use super::fit::{Fit, NoiseFrom};
use super::learned::Learned;
use super::suspect::Suspect;
use super::together::{Innovations, Seam, Tested, Together};
use nalgebra::DMatrix;
use std::sync::Arc;

/// What an observer believes at a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleEstimate {
    /// In s.
    pub time: f64,
    /// The estimated states.
    pub state: Vec<f64>,
    /// The standard deviation of each, in its unit: by windows the Cramér-Rao bound of the window, carried along the flow to this sample;
    /// of a filter by its covariance. Infinite where the measurements do not determine it; empty where the observer has none.
    pub deviations: Vec<f64>,
    /// The expected outputs minus the measured ones; empty where the observer compares none.
    pub residual: Vec<f64>,
}

/// How an update ended.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // names and messages say it
pub enum UpdateEnd {
    /// The last step was too short to matter, and the errors of the measurements explain the residual.
    Converged,
    /// The last step was too short to matter, and the residual is larger than the errors of the measurements explain: another model,
    /// other errors, or a false minimum.
    DoesNotFit,
    /// All steps that were allowed are done.
    StepsSpent,
    /// No step made the error smaller.
    Stuck,
    /// The measurements do not determine the estimated states; the observer held what it believed, or integrated.
    Unobservable { weakest: Vec<f64> },
    /// The model could not be followed.
    Lost(Lost),
}

/// One update from a window of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Update {
    /// The first time, in s.
    pub from: f64,
    /// The last time, in s.
    pub to: f64,
    /// What is believed of the state at the first time.
    pub estimate: Vec<f64>,
    /// The values of the followed outputs there, as believed.
    pub outputs: Vec<f64>,
    /// The Cramér-Rao bound (1 sigma) of each entry of the estimate, linearised there.
    pub deviations: Vec<f64>,
    /// The covariance of all followed states, the estimated ones first: zero of what was not changed. None where something is unobservable.
    pub covariance: Option<Arc<DMatrix<f64>>>,
    /// The estimates that lie at a bound that was stated, by place, and the bound: there the deviation is that of an unknown that is free.
    pub at_bounds: Vec<(usize, f64)>,
    /// Its difference from where the window before it ended, where both determine the state.
    pub seam: Option<Seam>,
    /// The condition of the sensitivities, scaled.
    pub condition: f64,
    /// The error of the output, `k` of 4.77, there.
    pub cost: f64,
    /// The root mean square of expected minus measured there, in the outputs' unit.
    pub rms_residual: f64,
    /// Steps that were taken.
    pub steps: u64,
    /// Those of them that had to be shortened, refused or replaced.
    pub troubled: usize,
    /// The wall time of the update, in s.
    pub seconds: f64,
    /// How it ended.
    pub end: UpdateEnd,
    /// How well it explains the measurements, where it was found out.
    pub fit: Option<Fit>,
    /// The name of the output whose residuals drift most, where that was tested.
    pub drifting: Option<String>,
    /// Whether it counts what the windows before it have learned, beside its own measurements.
    pub is_heir: bool,
    /// Measurements beyond the corner of a robust loss.
    pub discounted: usize,
    /// What else might be wrong with the model: for the first update of a track that converged where the noise is stated.
    pub suspects: Vec<Suspect>,
}

impl Update {
    /// Whether it has an answer that the measurements bear out.
    pub fn is_borne_out(&self) -> bool {
        let fits = self.fit.is_some_and(|fit| fit.fits);
        fits && matches!(self.end, UpdateEnd::Converged | UpdateEnd::Stuck)
    }

    /// Whether its estimate is only what was believed before: the measurements do not determine all estimated states. Its deviations are then what measurements
    /// could reach at best, and nothing of how far that belief is from the truth.
    pub fn is_held(&self) -> bool {
        matches!(self.end, UpdateEnd::Unobservable { .. })
    }

    /// Whether its search came to no end: its deviations are those of an estimate that is not reached.
    pub fn is_unfinished(&self) -> bool {
        matches!(self.end, UpdateEnd::StepsSpent | UpdateEnd::Lost(_))
    }

    /// Whether the measurements bear it out, and against a noise that was stated.
    pub(super) fn has_tested(&self) -> bool {
        self.is_borne_out() && self.fit.is_some_and(|fit| fit.from == NoiseFrom::Stated)
    }

    /// Whether it has an answer whose residuals could not be tested: too few were measured, and no noise is stated.
    pub fn is_untested(&self) -> bool {
        self.is_borne_out() && self.fit.is_some_and(|fit| !fit.is_tested())
    }

    /// Takes part in the tests of all windows together, where it was tested at all.
    pub fn count_in(&self, tested: &mut Tested) {
        let is_at_best =
            !matches!(self.end, UpdateEnd::Unobservable { .. } | UpdateEnd::Lost(_) | UpdateEnd::StepsSpent);
        let fit = self.fit.filter(|fit| is_at_best && fit.from != NoiseFrom::Computation && fit.is_tested());
        if let Some(fit) = fit {
            tested.window(fit.probability);
        }
        if let Some(seam) = self.seam {
            tested.seam(seam);
        }
    }

    /// Whether the residual of the best state that was found is larger than the errors of the measurements explain.
    pub fn is_contradicted(&self) -> bool {
        let fails = self.fit.is_some_and(|fit| !fit.fits);
        fails && matches!(self.end, UpdateEnd::DoesNotFit | UpdateEnd::Stuck)
    }
}

/// What an observer makes of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// What it believed, sample by sample.
    pub estimates: Vec<SampleEstimate>,
    /// Its updates, where it works by windows.
    pub updates: Vec<Update>,
    /// Other states that fit as well as those of the updates: the measurements do not distinguish them.
    pub others: Vec<Update>,
    /// Samples at which the state was unobservable, or the model could not be followed, and it held or integrated instead.
    pub unobserved: usize,
    /// Whether the innovations of a filter are what its covariance and the noise of the measurements explain; none of other methods.
    pub innovations: Option<Innovations>,
    /// Further remarks.
    pub remarks: Vec<String>,
    /// What was learned, for the next window or part of a stream.
    pub learned: Option<Arc<Learned>>,
}

impl Track {
    /// Notes that the model could not be followed to a sample, where a filter then holds what it believed.
    pub(super) fn hold(&mut self, lost: &Lost) {
        if self.unobserved == 0 {
            self.remarks.push(format!("held, with the outputs as they are read: {lost}"));
        }
        self.unobserved += 1;
    }

    /// What it believed last.
    pub fn last(&self) -> Option<&SampleEstimate> {
        self.estimates.last()
    }

    /// The test of all windows together, and of each against the one before it; nothing of fewer than two.
    pub fn together(&self) -> Option<Together> {
        let mut tested = Tested::default();
        self.updates.iter().for_each(|update| update.count_in(&mut tested));
        tested.together()
    }

    /// Whether one of its updates is contradicted by the measurements, or all of them together are, or a seam.
    pub fn is_contradicted(&self) -> bool {
        self.updates.iter().any(Update::is_contradicted) || self.together().is_some_and(|all| !all.fits)
    }

    /// Whether a method that does not work by windows passes; see [`passes_unwindowed`].
    pub fn passes(&self) -> bool {
        passes_unwindowed(self.estimates.len(), self.unobserved, self.innovations.as_ref())
    }

    /// Whether one of its updates is borne out by the measurements, none is contradicted and each search came to an end: of methods that work by windows. A window in which
    /// the model has a pole is no fault of either.
    pub fn is_sound(&self) -> bool {
        let borne_out = self.updates.iter().any(Update::is_borne_out);
        let has_ended = self.updates.iter().all(|update| update.end != UpdateEnd::StepsSpent);
        borne_out && has_ended && !self.is_contradicted()
    }
}

/// Whether a method that does not work by windows passes: it has estimates, it could follow its model at some sample after the first, and its
/// innovations, where it has any, are what it believes of its errors.
pub fn passes_unwindowed(estimates: usize, unobserved: usize, innovations: Option<&Innovations>) -> bool {
    let follows = unobserved == 0 || unobserved + 1 < estimates;
    estimates > 0 && follows && innovations.is_none_or(|own| own.fits)
}
