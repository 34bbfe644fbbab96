//! `palmistry observe`: a body or another system in motion, and observers that recover its state.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use clap::Args;
use indicatif::ProgressBar;
use palmistry::experiment::{
    Answer, Basin, Experiment, NoiseLevel, Reconstruction, Scene, SceneError, basins, noise_study, shown,
};
use palmistry::file::note;
use palmistry::mechanics::moving::Ended;
use palmistry::observer::RecordError;
use palmistry::report::{Observed, ended_in_words, forget_seconds, observe_json, observe_page, observe_text};
use std::path::PathBuf;

/// Moves a system, hands on what its sensors tell, and has observers recover its state: the system of any proof file by its own
/// equations, or a body between two palms by Newton's laws and the contacts.
///
/// SCENE is a TOML file: the state at the start and the inputs as functions of time, or the body, the palms and how they move;
/// the sensors; and the observers with what they seek, what they are told and where they begin (the book has all keys). The
/// observers know only the readings and the equations of the scene's proof file. For each update there are the true and
/// the recovered states, the error, the bound of Cramér and Rao below which no unbiased estimate can be, steps and time.
///
/// With --data the readings come from a CSV or Parquet file with the columns that the model needs (time, outputs, inputs);
/// faulty rows are reported by number and handled as the scene says, and what --record wrote gives the same answer. With --studies the scene's studies run as well: the
/// error over many seeds at several levels of noise beside the bound, and the first guesses from which each method arrives.
///
/// An update that converged is held against the noise that the scene states: what is left has to be what the noise explains. Where
/// no noise is stated it is estimated from what is left, which then has to look like noise. The exit status is 1 where an update
/// converged and does not fit, or a method by windows has no update that does.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry observe proofs/moll2002/scenes/section_4_6.toml --out observed")]
pub(crate) struct Observe {
    /// The scene.
    scene: PathBuf,
    /// Readings from a file (CSV or Parquet) instead of a simulation.
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// Take this seed and not the scene's.
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Run the scene's studies, too.
    #[arg(long)]
    studies: bool,
    /// Write a page with pictures (index.html) and observe.json into this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the readings to a file, CSV or Parquet by its extension.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Write all of the simulated motion to a file, CSV or Parquet: poses, contact forces, torques, energies, the truth.
    #[arg(long, value_name = "FILE")]
    motion: Option<PathBuf>,
    /// Write the outline to a file, CSV or Parquet: for each normal the support radius with its band, and the point.
    #[arg(long, value_name = "FILE")]
    outline: Option<PathBuf>,
    /// Write what was believed sample by sample to a file, CSV or Parquet: each state with its bound.
    #[arg(long, value_name = "FILE")]
    track: Option<PathBuf>,
    /// Tell no times: two runs with one seed on one machine then write the same to the last byte.
    #[arg(long)]
    no_times: bool,
    /// Print one JSON object: 'observers' with their 'updates' and 'end', and the studies.
    #[arg(long)]
    pub json: bool,
}

impl Observe {
    pub fn run(self) -> miette::Result<Status> {
        let mut scene = Scene::read(&self.scene)?;
        scene.seed = self.seed.unwrap_or(scene.seed);
        let bar = progress(scene.observer.methods.len() as u64 + 1, "simulating");
        let experiment = Experiment::new(scene, self.data.as_deref())?;
        bar.inc(1);
        if self.studies && experiment.simulated().is_none() {
            let message = "a study needs the truth, and readings from a file have none";
            return Err(Unusable::report(message, "leave out --studies, or simulate"));
        }
        let study = &experiment.scene.study;
        if self.studies && study.noise.is_none() && study.basin.is_none() {
            let message = "the scene has no studies";
            return Err(Unusable::report(
                message,
                "add [study.noise] or [study.basin] to it, or leave out --studies",
            ));
        }
        let mut files = Files::default();
        if let Some(path) = &self.record {
            files.table(path, &experiment.record);
            files.announce(path);
        }
        if let Some(path) = &self.motion {
            let table = match (&experiment.simulation, &experiment.motion) {
                (Some(simulation), _) => simulation.table(),
                (None, Some(motion)) => motion.table(),
                (None, None) => {
                    let message = "readings from a file tell no motion";
                    return Err(Unusable::report(message, "leave out --motion, or --data"));
                }
            };
            let table = table.map_err(|error| Unusable::report(error.to_string(), ""))?;
            files.table(path, &table);
            files.announce(path);
        }
        bar.set_message("observing");
        let mut answers = experiment.run(&INTERRUPTED, &|method| {
            bar.set_message(method.name());
            bar.inc(1);
        })?;
        bar.set_message("shape");
        let reconstruction = experiment.reconstruct(&answers, &INTERRUPTED);
        bar.finish_and_clear();
        if self.no_times {
            answers.iter_mut().for_each(Answer::forget_times);
        }
        self.write_shape(&experiment, &answers, reconstruction.as_ref(), &mut files)?;
        if let (Some(place), Some(found)) = (shown_place(&answers), reconstruction) {
            answers[place].reconstruction = Some(Box::new(found));
        }
        let (noise, basins) = if self.studies { studies(&experiment)? } else { (Vec::new(), Vec::new()) };
        begin_to_tell();
        let interrupted = interrupted();
        let observed = Observed {
            experiment: &experiment,
            answers: &answers,
            noise: &noise,
            basins: &basins,
            interrupted,
        };
        let mut json = observe_json(&observed);
        if self.no_times {
            forget_seconds(&mut json);
        }
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &observe_page(&observed));
            files.json(&folder.join("observe.json"), &json);
            files.announce(&folder.join("index.html"));
        }
        if let Some(simulation) = &experiment.simulation
            && *simulation.ended() != Ended::Completed
        {
            note(&format!("the motion ended early: {}", ended_in_words(simulation.ended())));
        }
        if let Some(lost) = experiment.motion.as_ref().and_then(|motion| motion.ended()) {
            note(&format!("the motion ended early: {lost}"));
        }
        // a window that cannot be seen is part of the answer; a method by windows that saw none has found nothing, and one that
        // contradicts the readings is wrong
        let by_windows = |answer: &&Answer| answer.method.is_by_windows();
        let as_expected = answers.iter().filter(by_windows).all(|answer| match interrupted {
            true => !answer.track.is_contradicted(),
            false => answer.track.is_sound(),
        });
        let status = Status::of(as_expected);
        files.print(Form::of(self.json), json, || observe_text(&observed), status)
    }
}

/// Why there may be no outline.
const NO_OUTLINE: &str = "no support radius was seen; an outline takes two palms with the outputs s1 and s2, and r1 and r2 sought and seen";

impl Observe {
    /// The files of `--outline` and `--track`.
    fn write_shape(
        &self,
        experiment: &Experiment,
        answers: &[Answer],
        reconstruction: Option<&Reconstruction>,
        files: &mut Files,
    ) -> miette::Result<()> {
        let unexpected = |error: RecordError| Unusable::report(error.to_string(), "");
        if let Some(path) = &self.outline {
            match reconstruction.and_then(Reconstruction::outline_table) {
                Some(table) => files.table(path, &table.map_err(unexpected)?),
                None => files.text_or(path, Err::<String, _>(NO_OUTLINE)),
            }
            files.announce(path);
        }
        if let Some(path) = &self.track {
            match shown(answers) {
                Some(answer) => {
                    let table = experiment.track_table(answer, reconstruction);
                    files.table(path, &table.map_err(unexpected)?);
                }
                None => files.text_or(path, Err::<String, _>("no observer was run")),
            }
            files.announce(path);
        }
        Ok(())
    }
}

/// The place of the answer whose outline is shown.
fn shown_place(answers: &[Answer]) -> Option<usize> {
    let shown = shown(answers)?;
    answers.iter().position(|answer| std::ptr::eq(answer, shown))
}

fn studies(experiment: &Experiment) -> Result<(Vec<NoiseLevel>, Vec<Basin>), SceneError> {
    let study = &experiment.scene.study;
    let counted = |length: usize, what: &'static str| -> ProgressBar { progress(length as u64, what) };
    let mut noise = Vec::new();
    if let (Some(settings), Some(simulation)) = (&study.noise, experiment.simulated()) {
        let bar = counted(settings.levels.len() * settings.seeds, "seeds");
        noise = noise_study(experiment, simulation, settings, &INTERRUPTED, &|| bar.inc(1))?;
        bar.finish_and_clear();
    }
    let mut maps = Vec::new();
    if let Some(settings) = &study.basin {
        let guesses = settings.points.pow(2) * experiment.scene.observer.methods.len();
        let bar = counted(guesses, "first guesses");
        maps = basins(experiment, settings, &INTERRUPTED, &|| bar.inc(1))?;
        bar.finish_and_clear();
    }
    Ok((noise, maps))
}
