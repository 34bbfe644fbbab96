//! The shape estimated from an experiment: from an observer's estimates sample by sample, or as a batch estimate of all measurements.
//!
//! Between two flat palms shape and motion follow from one law and all measurements (`whole`): that has no window, no pole and no sum of errors, and its
//! band is that of the measurements. Where this does not apply, or does not explain the measurements, the shape is fitted to the support radii
//! that the shown observer estimates (`track`). Either way the estimator is that of [`palmistry_bodies::shape`].

mod agreement;
mod candidate;
mod descent;
mod knots;
mod law;
mod recognition;
mod record;
mod series;
mod start;
mod stepping;
mod table;
mod track;
mod turning;
mod whole;

#[doc(hidden)]
pub use track::{on_palm, shown, turned};

use super::recovered::{Apart, Reconstruction, TooWide, TouchTrack, WholeMotion, WholeSample};
use super::run::{Answer, Experiment};
use super::scene::{Method, SceneError};
use super::simulation::deviation;
use candidate::Found;
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::shape::{
    Coverage, Measured, ShapeEstimate, SupportSample, SupportWeights, deviation_of, fit_support,
};
use record::WholeRecord;
use std::sync::atomic::AtomicBool;
use whole::WholeEstimate;

/// The batch estimate is accepted if its residual is below this fraction of the mean radius, or a few times the noise: else the model is wrong.
const BELIEVED: f64 = 1e-3;
const BELIEVED_NOISE: f64 = 5.0;

impl Experiment {
    /// The shape estimated from the measurements, with the answers as initial values. None where the model is not one of two palms with the outputs `s1` and `s2` and
    /// the estimated states `r1` and `r2`, or there is no answer.
    pub fn reconstruct(&self, answers: &[Answer], interrupt: &AtomicBool) -> Option<Reconstruction> {
        let answer = shown(answers)?;
        let track = track::touch_track(self, answer)?;
        let (mut contradiction, mut apart) = (None, None);
        match self.whole_record(&track, interrupt) {
            Ok((record, told)) => {
                let whole = whole_motion(&record, &told);
                contradiction = agreement::contradiction(&self.names(), answer, &whole);
                if contradiction.is_none() {
                    let coverage = coverage(&record, &told.best);
                    let (shape, too_wide) = resolved(told.best.shape, told.best.is_sure, &coverage);
                    let whole = too_wide.is_none().then_some(whole);
                    return Some(Reconstruction {
                        track,
                        shape,
                        coverage,
                        whole,
                        contradiction,
                        too_wide,
                        apart,
                    });
                }
            }
            Err(found) => apart = found,
        }
        let (shape, coverage) = from_track(&track, !answer.track.updates.is_empty());
        // two estimates that contradict each other are both rejected, whatever the windows' own tests say
        let is_told = contradiction.is_none()
            && track::no_outline(answer, &track.forms, self.scene.observer.when_unobservable).is_none();
        let (shape, too_wide) =
            shape.filter(|_| is_told).map_or((None, None), |shape| resolved(shape, true, &coverage));
        Some(Reconstruction { track, shape, coverage, whole: None, contradiction, too_wide, apart })
    }

    /// The answers of all observers, as [`Experiment::run`], and the shape estimated from them, which is stored with the answer that
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
                let answer = &mut answers[place];
                let strays =
                    found.whole.as_ref().map(|whole| agreement::strays(&self.names(), answer, whole));
                for (place, seam, why) in strays.into_iter().flatten() {
                    answer.track.updates[place].seam = Some(seam);
                    answer.track.remarks.push(why);
                }
                let why =
                    track::no_outline(answer, &found.track.forms, self.scene.observer.when_unobservable);
                answer.track.remarks.extend(why.filter(|_| found.whole.is_none()));
                answer.reconstruction = Some(Box::new(found));
            }
        }
        Ok(answers)
    }

    /// The outline by one answer, sample by sample; none where [`Experiment::reconstruct`] has none.
    #[doc(hidden)]
    pub fn touch_track(&self, answer: &Answer) -> Option<TouchTrack> {
        track::touch_track(self, answer)
    }

    /// Shape and motion as a batch estimate of all measurements, where the palms are flat and a body between them explains the measurements; else the reason, where it is known.
    fn whole_record(
        &self,
        track: &TouchTrack,
        interrupt: &AtomicBool,
    ) -> Result<(WholeRecord, WholeEstimate), Option<Apart>> {
        if track.forms.iter().any(|form| *form != Palm::Flat) {
            return Err(None);
        }
        let stated = deviation(self.scene.sensor.noise, self.scene.sensor.resolution);
        let Some(mut record) = WholeRecord::of(self, stated) else { return Err(None) };
        let starts = record.starts(self, track);
        let round = record.nearly_round();
        if let Some(first) = round.first()
            && starts.iter().chain(&round).all(|start| record.takes_too_many_steps(start))
        {
            return Err(Some(record.apart(first)));
        }
        let Some(told) = record.estimate(&starts, stated, interrupt) else { return Err(None) };
        let mean = told.best.shape.support.mean();
        let most = (BELIEVED * mean).max(BELIEVED_NOISE * stated);
        if told.best.rms_residual <= most && mean > 0.0 { Ok((record, told)) } else { Err(None) }
    }
}

/// Normals at which the width of a band is checked.
const NORMALS: u32 = 360;

/// A shape, unless its search has not converged, its errors are not linear, or its band is somewhere wider than its mean radius where it was touched: no linear model holds so far, and neither does its band.
fn resolved(
    shape: ShapeEstimate,
    is_sure: bool,
    coverage: &Coverage,
) -> (Option<ShapeEstimate>, Option<TooWide>) {
    let angles = (0..NORMALS).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(NORMALS));
    let touched = angles.filter(|angle| coverage.contains(*angle));
    let (band, mean) =
        (touched.map(|angle| shape.band(coverage, angle)).fold(0.0, f64::max), shape.support.mean());
    match !is_sure || band > mean {
        true => (None, Some(TooWide { band, mean })),
        false => (Some(shape), None),
    }
}

/// The normals that a motion touched.
fn coverage(record: &WholeRecord, found: &Found) -> Coverage {
    let normals = |palm: usize| -> Vec<f64> {
        let at = |(time, at): (&f64, &record::Followed)| record.palms_at(*time).normals(at.phi)[palm];
        record.times.iter().zip(&found.motion).map(at).collect()
    };
    let paths = [normals(0), normals(1)];
    Coverage::of_paths(paths.iter().map(Vec::as_slice))
}

/// The shape fitted to the radii of an observer. Samples of a window share their errors and count as one; where there are no windows, errors are taken for independent.
fn from_track(track: &TouchTrack, by_windows: bool) -> (Option<ShapeEstimate>, Coverage) {
    let samples: Vec<SupportSample> = track.instants.iter().flat_map(|at| at.samples).collect();
    let weights = if by_windows { SupportWeights::InverseVariances } else { SupportWeights::Relative };
    let shape = fit_support(&samples, weights, None);
    // a path ends where the body was lost
    let runs = track.instants.split(|at| !at.is_observed);
    let paths: Vec<Vec<f64>> = runs
        .flat_map(|run| [0, 1].map(|palm| run.iter().map(|at| at.samples[palm].angle).collect()))
        .collect();
    (shape, Coverage::of_paths(paths.iter().map(Vec::as_slice)))
}

/// A value of one candidate, and its derivatives by the free unknowns.
type Value<'a> = (f64, &'a [f64]);

/// The best candidate's motion, with the deviations of all candidates about it.
fn whole_motion(record: &WholeRecord, told: &WholeEstimate) -> WholeMotion {
    let own = |found: &Found, (value, row): Value<'_>| Measured {
        value,
        deviation: deviation_of(&found.covariance, row),
    };
    let least = 1.0 - told.others.iter().map(|(probability, _)| probability).sum::<f64>();
    let measured = |of: &dyn Fn(&Found) -> Measured| {
        let best = of(&told.best);
        let mut variance = least * best.deviation.powi(2);
        for (probability, found) in &told.others {
            let other = of(found);
            variance += probability * (other.deviation.powi(2) + (other.value - best.value).powi(2));
        }
        Measured { value: best.value, deviation: variance.sqrt() }
    };
    let samples = record.times.iter().enumerate().map(|(i, time)| WholeSample {
        time: *time,
        phi0: measured(&|found| own(found, (found.motion[i].phi, &found.motion[i].phi_row))),
        omega0: measured(&|found| own(found, (found.motion[i].rate, &found.motion[i].rate_row))),
        radii: [0, 1].map(|palm: usize| {
            measured(&|found| own(found, (found.motion[i].radii[palm], &found.motion[i].radius_rows[palm])))
        }),
        centre: told.best.motion[i].centre,
    });
    let gyration = record.place_of_gyration().map(|place| {
        measured(&|found| {
            let value = found.unknowns.gyration;
            Measured { value, deviation: value * found.covariance[(place, place)].max(0.0).sqrt() }
        })
    });
    WholeMotion {
        samples: samples.collect(),
        gyration,
        rms_residual: told.best.rms_residual,
        sigma: record.sigma,
        stated: record.stated,
    }
}
