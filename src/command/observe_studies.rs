//! The studies of a scene of motion, with their progress.

use super::interrupt::INTERRUPTED;
use super::output::progress;
use indicatif::ProgressBar;
use palmistry::experiment::{Experiment, SceneError, Studied, basins, curvature_map, noise_study};

/// Runs all that the scene asks for.
pub(super) fn studies(experiment: &Experiment) -> Result<Studied, SceneError> {
    let study = &experiment.scene.study;
    let counted = |length: usize, what: &'static str| -> ProgressBar { progress(length as u64, what) };
    let mut studied = Studied::default();
    if let (Some(settings), Some(simulation)) = (&study.noise, experiment.simulated()) {
        let bar = counted(settings.levels.len() * settings.seeds, "seeds");
        studied.noise = noise_study(experiment, simulation, settings, &INTERRUPTED, &|| bar.inc(1))?;
        bar.finish_and_clear();
    }
    if let Some(settings) = &study.basin {
        let guesses = settings.points.pow(2) * experiment.scene.observer.methods.len();
        let bar = counted(guesses, "first guesses");
        studied.basins = basins(experiment, settings, &INTERRUPTED, &|| bar.inc(1))?;
        bar.finish_and_clear();
    }
    if let Some(settings) = &study.curvature {
        let motions = settings.orientations.len() * settings.rates.len();
        let bar = counted(motions * (1 + settings.points.pow(2)), "bounds");
        studied.curvature = Some(curvature_map(experiment, settings, &INTERRUPTED, &|| bar.inc(1))?);
        bar.finish_and_clear();
    }
    Ok(studied)
}
