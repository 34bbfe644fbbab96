//! Whether palms of other forms improve the estimate: the Cramér-Rao bound at the truth over the curvatures of both palms, in several motions of the body.

use super::super::run::Experiment;
use super::super::scene::{CurvatureStudy, Guess, Method, Scene, SceneError, Study};
use super::noise::{at_level, first_window};
use palmistry_bodies::mechanics::Palm;
use palmistry_observe::WindowSearch;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// The states whose bounds are compared: the support radii at both contacts.
const COMPARED: [&str; 2] = ["r1", "r2"];

/// Palms of less curvature count as flat, in 1/m.
const FLATTEST: f64 = 1e-6;

/// The initial state of a scene's body, and its bound between flat palms.
#[derive(Clone, Debug, PartialEq)]
pub struct StudiedMotion {
    /// `phi0` at the start, in rad.
    pub orientation: f64,
    /// `omega0` at the start, in rad/s.
    pub rate: f64,
    /// The bound between flat palms.
    pub flat: WindowBound,
}

/// The Cramér-Rao bound of both support radii in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindowBound {
    /// The palms do not hold the body for that long.
    NotHeld,
    /// The bound exceeds the scene's `unobservable_above`.
    Unobservable,
    /// The larger Cramér-Rao bound of both, in m.
    Bound(f64),
}

impl WindowBound {
    /// In m, infinite where unobservable; nothing where the body is not held.
    pub fn bound(self) -> Option<f64> {
        match self {
            WindowBound::NotHeld => None,
            WindowBound::Unobservable => Some(f64::INFINITY),
            WindowBound::Bound(bound) => Some(bound),
        }
    }
}

/// The ratios of bounds to those between flat palms, over the motions that flat palms observe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureRatio {
    /// The middle one (the upper of two); infinite where unobservable.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// The number of motions that flat palms observe and these hold.
    pub motions: usize,
}

/// The Cramér-Rao bound over the curvatures of both palms.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvatureMap {
    /// The standard deviation of the contacts' measurements, in m.
    pub noise: f64,
    /// The curvatures along each side, in 1/m: above zero of hollow palms.
    pub curvatures: Vec<f64>,
    /// The motions.
    pub motions: Vec<StudiedMotion>,
    /// For each pair of curvatures, rows by that of palm 2, the bound of each motion; none where it was interrupted before.
    pub bounds: Vec<Vec<Option<WindowBound>>>,
}

impl CurvatureMap {
    /// The ratios of the bounds of a pair of curvatures to those of flat palms; nothing where there is no motion to compare.
    pub fn ratio(&self, cell: usize) -> Option<CurvatureRatio> {
        let bounds = self.bounds.get(cell)?;
        let ratio = |(bounds, motion): (&Option<WindowBound>, &StudiedMotion)| match motion.flat {
            WindowBound::Bound(flat) => Some((*bounds)?.bound()? / flat),
            _ => None,
        };
        let mut ratios: Vec<f64> = bounds.iter().zip(&self.motions).filter_map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let (least, greatest) = (*ratios.first()?, *ratios.last()?);
        Some(CurvatureRatio { median: ratios[ratios.len() / 2], least, greatest, motions: ratios.len() })
    }
}

/// The bounds of a study, one after the other: those between flat palms, then all motions of each pair of curvatures.
pub(super) struct CurvatureTrials<'a> {
    experiment: &'a Experiment,
    study: &'a CurvatureStudy,
    curvatures: Vec<f64>,
    /// Orientation and rate of each.
    motions: Vec<[f64; 2]>,
}

impl<'a> CurvatureTrials<'a> {
    /// # Errors
    /// Where no body is held, or its support radii are not estimated.
    pub fn new(
        experiment: &'a Experiment,
        study: &'a CurvatureStudy,
    ) -> Result<CurvatureTrials<'a>, SceneError> {
        let names = experiment.names();
        if experiment.scene.simulated.is_none() || !COMPARED.iter().all(|name| names.contains(name)) {
            let message = "the map compares how well palms determine r1 and r2";
            let help = "simulate a body between two palms, and let 'estimate' contain both radii";
            return Err(experiment.scene.error_at("study.curvature", message, "here", help));
        }
        let last = study.points.max(2) - 1;
        let [low, high] = study.range;
        if let Some(missing) = ["b1", "b2"].iter().find(|name| experiment.system.find_symbol(name).is_none())
        {
            let message =
                format!("the model knows no radius {missing}: it would take all palms for flat ones");
            let help = "take a model of circular palms, such as that of scenes/circular_palms.toml";
            return Err(experiment.scene.error_at("model", message, "this model", help));
        }
        let at = |i: usize| {
            let curvature = low + (high - low) * i as f64 / last as f64;
            // flat is flat, whatever the sum rounds to; arcs of more than 1e6 m are flat to the mechanics
            if curvature.abs() < FLATTEST.max(1e-12 * (high - low)) { 0.0 } else { curvature }
        };
        let with_rates = |orientation: &f64| {
            let orientation = *orientation;
            study.rates.iter().map(move |rate| [orientation, *rate])
        };
        let motions = study.orientations.iter().flat_map(with_rates).collect();
        Ok(CurvatureTrials { experiment, study, curvatures: (0..=last).map(at).collect(), motions })
    }

    /// The number of trials.
    pub fn count(&self) -> usize {
        self.motions.len() * (1 + self.curvatures.len().pow(2))
    }

    /// The bound of one of them, which depends on its place alone.
    pub fn trial(&self, place: usize) -> WindowBound {
        let (cell, motion) = (place / self.motions.len(), self.motions[place % self.motions.len()]);
        let curvatures = match cell.checked_sub(1) {
            None => [0.0; 2],
            Some(cell) => {
                let side = self.curvatures.len();
                [self.curvatures[cell % side], self.curvatures[cell / side % side]]
            }
        };
        let forms = curvatures.map(|curvature| match curvature {
            0.0 => Palm::Flat,
            _ => Palm::Circular { radius: 1.0 / curvature },
        });
        bounds(&self.experiment.scene, forms, motion, self.study.noise).unwrap_or(WindowBound::NotHeld)
    }

    /// The map from all bounds, in their order.
    pub fn map(&self, bounds: &[Option<WindowBound>]) -> CurvatureMap {
        let (flat, cells) = bounds.split_at(self.motions.len().min(bounds.len()));
        let motions = self.motions.iter().zip(flat).map(|([orientation, rate], flat)| StudiedMotion {
            orientation: *orientation,
            rate: *rate,
            flat: flat.unwrap_or(WindowBound::NotHeld),
        });
        CurvatureMap {
            noise: self.study.noise,
            curvatures: self.curvatures.clone(),
            motions: motions.collect(),
            bounds: cells.chunks(self.motions.len()).map(<[Option<WindowBound>]>::to_vec).collect(),
        }
    }
}

/// The bound of palms of these forms in the first window of a scene with this initial state; nothing where they do not hold the body so long.
fn bounds(
    scene: &Scene,
    forms: [Palm<f64>; 2],
    [orientation, rate]: [f64; 2],
    noise: f64,
) -> Option<WindowBound> {
    let mut scene = scene.clone();
    scene.palm_forms = forms;
    (scene.study, scene.observer.guess) = (Study::default(), Guess::Off(0.0));
    scene.observer.methods = vec![Method::TrustRegion];
    let simulated = scene.simulated.as_mut()?;
    (simulated.body.orientation, simulated.body.rate) = (orientation, rate);
    // no longer than the required window
    let samples = (scene.observer.window.max(2) + 1).min(simulated.samples);
    simulated.duration *= (samples - 1) as f64 / (simulated.samples - 1).max(1) as f64;
    simulated.samples = samples;
    let experiment = Experiment::new(scene, None).ok()?;
    if experiment.signals.times().len() < samples {
        return None;
    }
    let never = AtomicBool::new(false);
    let task = experiment.task(&never).ok()?;
    let task = at_level(&experiment, &task, noise);
    let observer = experiment.window(WindowSearch::TrustRegion);
    let truth = experiment.truth_at(*experiment.signals.times().first()?)?;
    let bounds = observer.bounds(&task, &truth, &first_window(&task, &observer), &task.clamped);
    let part = bounds.iter().zip(&task.sizes).map(|(bound, size)| bound / size).fold(0.0, f64::max);
    let names = experiment.names();
    let compared = names.iter().zip(&bounds).filter(|(name, _)| COMPARED.contains(name));
    let largest = compared.map(|(_, bound)| *bound).fold(0.0, f64::max);
    let sees = part <= observer.unobservable_above && largest.is_finite();
    Some(if sees { WindowBound::Bound(largest) } else { WindowBound::Unobservable })
}

/// The map of a study. Bounds are found side by side; the result is the same on any number of threads. `done` is called once a bound.
///
/// # Errors
/// Where no body is held, or its support radii are not estimated.
pub fn curvature_map(
    experiment: &Experiment,
    study: &CurvatureStudy,
    interrupt: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<CurvatureMap, SceneError> {
    let all = CurvatureTrials::new(experiment, study)?;
    let one = |place: usize| -> Option<WindowBound> {
        if interrupt.load(Ordering::Relaxed) {
            return None;
        }
        let bounds = all.trial(place);
        done();
        Some(bounds)
    };
    let bounds: Vec<Option<WindowBound>> = (0..all.count()).into_par_iter().map(one).collect();
    Ok(all.map(&bounds))
}
