//! The shape that an experiment tells: from what an observer believes sample by sample, or from all readings at once.
//!
//! Between two flat palms shape and motion follow from one law and all readings (`whole`): that has no window, no pole and no sum of errors, and its
//! band is that of the readings. Where this does not apply, or does not explain the readings, the shape is made of what the observer shown
//! believes of the support radii (`track`). Either way it is one estimator's ([`crate::shape`]).

mod law;
mod recognition;
mod record;
mod start;
mod table;
mod track;
mod whole;

#[doc(hidden)]
pub use track::{on_palm, shown, turned};

use super::recovered::{Reconstruction, TouchTrack, WholeMotion, WholeSample};
use super::run::{Answer, Experiment};
use super::scene::{Method, SceneError};
use super::simulation::NOMINAL;
use super::simulation::deviation;
use crate::mechanics::Palm;
use crate::shape::{Coverage, Measured, ShapeEstimate, SupportSample, SupportWeights, fit_support};
use record::WholeRecord;
use std::sync::atomic::AtomicBool;
use whole::Found;

/// All readings at once are believed whose misfit is below this part of the mean radius, or a few times the noise: else it is another model.
const BELIEVED: f64 = 1e-3;
const BELIEVED_NOISE: f64 = 5.0;

/// The standard deviation of the contacts at first where none is stated, in parts of their mean.
const UNSTATED: f64 = 1e-4;

/// The noise that is not stated is sought again until it does not get smaller by this factor.
const SMALLER: f64 = 0.5;

impl Experiment {
    /// The shape that the readings tell, with what the answers found as the beginning. None where the model is not one of two palms with the outputs `s1` and `s2` and
    /// the sought states `r1` and `r2`, or there is no answer.
    pub fn reconstruct(&self, answers: &[Answer], interrupt: &AtomicBool) -> Option<Reconstruction> {
        let answer = shown(answers)?;
        let track = track::touch_track(self, answer)?;
        if let Some((record, found)) = self.whole_record(&track, interrupt) {
            let normals = |palm: usize| -> Vec<f64> {
                let at = |(time, at): (&f64, &record::Followed)| record.palms_at(*time).normals(at.phi)[palm];
                record.times.iter().zip(&found.motion).map(at).collect()
            };
            let paths = [normals(0), normals(1)];
            let coverage = Coverage::of_paths(paths.iter().map(Vec::as_slice));
            let whole = Some(whole_motion(&record, &found));
            return Some(Reconstruction { track, shape: Some(found.shape), coverage, whole });
        }
        let (shape, coverage) = from_track(&track, !answer.track.updates.is_empty());
        Some(Reconstruction { track, shape, coverage, whole: None })
    }

    /// What every observer makes of the readings, as [`Experiment::run`], and the shape that they tell, which stands with the answer that
    /// is shown.
    ///
    /// # Errors
    /// As [`Experiment::task`].
    pub fn run_with_shape(
        &self,
        interrupt: &AtomicBool,
        done: &dyn Fn(Method),
    ) -> Result<Vec<Answer>, SceneError> {
        let mut answers = self.run(interrupt, done)?;
        if let Some(found) = self.reconstruct(&answers, interrupt) {
            let place = shown(&answers)
                .and_then(|shown| answers.iter().position(|answer| std::ptr::eq(answer, shown)));
            if let Some(place) = place {
                answers[place].reconstruction = Some(Box::new(found));
            }
        }
        Ok(answers)
    }

    /// What an answer says of the outline sample by sample; none where [`Experiment::reconstruct`] has none.
    #[doc(hidden)]
    pub fn touch_track(&self, answer: &Answer) -> Option<TouchTrack> {
        track::touch_track(self, answer)
    }

    /// Shape and motion from all readings at once, where the palms are flat and a body between them explains the readings.
    fn whole_record(&self, track: &TouchTrack, interrupt: &AtomicBool) -> Option<(WholeRecord, Found)> {
        if track.forms.iter().any(|form| *form != Palm::Flat) {
            return None;
        }
        let stated = deviation(self.scene.sensor.noise, self.scene.sensor.resolution);
        let mut record = WholeRecord::of(self, stated)?;
        let mut starts = record.starts(self, track);
        if stated > 0.0 {
            let found = record.explain(&starts, interrupt)?;
            let most = (BELIEVED * found.shape.support.mean).max(BELIEVED_NOISE * stated);
            return (found.misfit <= most && found.shape.support.mean > 0.0).then_some((record, found));
        }
        // nobody says how good the readings are: what is left says it, and with it how many harmonics they tell
        let read = || record.contacts.iter().flatten();
        let length = read().map(|s| s.abs()).sum::<f64>() / read().count() as f64;
        record.sigma = UNSTATED * length;
        let mut found = record.explain(&starts, interrupt)?;
        if found.misfit > BELIEVED * found.shape.support.mean {
            return None;
        }
        while found.misfit < SMALLER * record.sigma && record.sigma > NOMINAL {
            let before = record.sigma;
            record.sigma = found.misfit.max(NOMINAL);
            starts = vec![found.unknowns.clone()];
            match record.explain(&starts, interrupt) {
                Some(next) => found = next,
                None => {
                    record.sigma = before;
                    break;
                }
            }
        }
        Some((record, found))
    }
}

/// The shape by what an observer believes of the radii. Samples of a window share their errors and count as one; where there are no windows, errors are taken for independent.
fn from_track(track: &TouchTrack, by_windows: bool) -> (Option<ShapeEstimate>, Coverage) {
    let samples: Vec<SupportSample> = track.instants.iter().flat_map(|at| at.samples).collect();
    let weights = if by_windows { SupportWeights::InverseVariances } else { SupportWeights::Relative };
    let shape = fit_support(&samples, weights, None);
    // a path ends where the body was lost
    let runs = track.instants.split(|at| !at.seen);
    let paths: Vec<Vec<f64>> = runs
        .flat_map(|run| [0, 1].map(|palm| run.iter().map(|at| at.samples[palm].angle).collect()))
        .collect();
    (shape, Coverage::of_paths(paths.iter().map(Vec::as_slice)))
}

fn whole_motion(record: &WholeRecord, found: &Found) -> WholeMotion {
    let measured = |value: f64, row: &[f64]| {
        let row = nalgebra::DVector::from_column_slice(row);
        Measured { value, deviation: (&found.covariance * &row).dot(&row).max(0.0).sqrt() }
    };
    let samples = record.times.iter().zip(&found.motion).map(|(time, at)| WholeSample {
        time: *time,
        phi0: measured(at.phi, &at.phi_row),
        omega0: measured(at.rate, &at.rate_row),
        radii: [0, 1].map(|palm| measured(at.radii[palm], &at.radius_rows[palm])),
        centre: at.centre,
    });
    let gyration = (record.head() == 2).then(|| {
        let value = found.unknowns.gyration;
        Measured { value, deviation: value * found.covariance[(1, 1)].max(0.0).sqrt() }
    });
    WholeMotion { samples: samples.collect(), gyration, misfit: found.misfit, sigma: record.sigma }
}
