//! Bodies in motion: the scenes that the main job runs, in short.

use super::Options;
use crate::experiment::{Answer, Experiment, Scene};
use crate::system::ReadError;

/// The scenes that are run: the thesis's own simulation, and what happens where nothing can be seen.
pub const SCENES: [&str; 2] = ["section_4_6.toml", "turning_point.toml"];

/// Runs the scenes, without their studies.
///
/// # Errors
/// A scene that cannot be used.
pub(super) fn experiments(options: &Options<'_>) -> Result<Vec<(Experiment, Vec<Answer>)>, ReadError> {
    let run = |file: &&str| {
        let experiment = Experiment::new(Scene::read(&options.scenes.join(file))?, None)?;
        let answers = experiment.run(options.interrupt, &|_| ())?;
        Ok((experiment, answers))
    };
    SCENES.iter().map(run).collect()
}
