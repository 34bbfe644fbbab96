//! `palmistry observe`: a body or another system in motion, and observers that recover its state.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, nothing_found, watched};
use super::observe_stream;
use super::observe_studies::studies;
use super::output::{Files, Form, print_in_lines, progress, read_scene};
use super::shards::{NO_WHOLE, Parts, Shards};
use super::slow_text::KeptSlow;
use super::{Status, Unusable};
use clap::Args;
use indicatif::ProgressBar;
use palmistry::experiment::joint::JointScene;
use palmistry::experiment::slow::SlowScene;
use palmistry::experiment::space::SpaceScene;
use palmistry::experiment::{
    Answer, Experiment, Recognition, RecognitionVerdict, Reconstruction, Scene, Studied, Studies, StudyPart,
    shown,
};
use palmistry::file::note;
use palmistry::mechanics::moving::Ended;
use palmistry::observer::RecordError;
use palmistry::report::{
    Observed, choice_json, choice_text, forget_seconds, observe_json, observe_page, observe_text,
};
use palmistry::sweep::shard_of;
use palmistry::system::Code;
use std::path::{Path, PathBuf};

/// Simulates a system and its sensors, or reads a recording, and runs observers that estimate its state: the system of any proof file by its own
/// equations, or a body between two palms by Newton's laws and the contacts.
///
/// SCENE is a TOML file: the state at the start and the inputs as functions of time, or the body, the palms and how they move;
/// the sensors; and the observers with what they estimate, what they know and their initial guesses (the book has all keys). The
/// observers know only the measurements and the equations of the scene's proof file. For each update there are the true and
/// the recovered states, the error, the Cramér-Rao bound, steps and time.
///
/// With --data - the measurements come from standard input as they are written (CSV), and each window is answered as soon as it is there: with
/// --json in a line of JSON, and one at the end. Memory is bounded by a few windows. If a stream ends early, the answers given before stand.
///
/// A scene with [experiments] has several experiments, each with its own conditions, and one set of parameters: the parameters are fitted at once by maximum likelihood, from many starts.
/// `palmistry import` makes such scenes from PEtab problems.
///
/// With --data the measurements come from a CSV or Parquet file with the columns that the model needs (time, outputs, inputs);
/// faulty rows are reported by number and handled as the scene says, and what --record wrote gives the same answer. With --studies the scene's studies run as well: the
/// error over many seeds at several levels of noise beside the bound, and the initial guesses from which each method converges to the truth.
///
/// Studies can be cut into shards of trials, with --shard and --part, each a process of its own; --merge then answers as --studies
/// does in one run, to the last bit.
///
/// An update that converged is tested against the noise that the scene states: its residuals have to pass the chi-square test. Where
/// no noise is stated it is estimated from the residuals, which then have to be white. The exit status is 1 where an update
/// converged and does not pass, a moving-horizon method has no update that passes, or the body is not in the scene's library.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry observe proofs/moll2002/scenes/section_4_6.toml --out observed
  palmistry observe SCENE --accuracy 1e-3                   the cheapest observer that is accurate enough
  palmistry observe SCENE --record - | palmistry observe SCENE --data - --json")]
pub(crate) struct Observe {
    /// The scene.
    pub(super) scene: PathBuf,
    /// Measurements from a file (CSV or Parquet) instead of a simulation; - is standard input (CSV), answered window by window.
    #[arg(long, value_name = "FILE")]
    pub(super) data: Option<PathBuf>,
    /// Take this seed and not the scene's.
    #[arg(long, value_name = "S")]
    pub(super) seed: Option<u64>,
    /// Run the scene's studies, too.
    #[arg(long)]
    pub(super) studies: bool,
    /// Write a page with pictures (index.html) and observe.json into this folder; for a body in space also its surfaces, as PLY and OBJ.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["shard", "missing"])]
    pub(super) out: Option<PathBuf>,
    /// Write the measurements to a file, CSV or Parquet by its extension; - is standard output (CSV), and then no observer runs.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["shard", "missing"])]
    pub(super) record: Option<PathBuf>,
    /// Write all of the simulated motion to a file, CSV or Parquet: poses, contact forces, torques, energies, the truth.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["shard", "missing"])]
    pub(super) motion: Option<PathBuf>,
    /// Write the outline to a file, CSV or Parquet: for each normal the support radius with its band, and the point.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["shard", "missing"])]
    pub(super) outline: Option<PathBuf>,
    /// Write the estimates sample by sample to a file, CSV or Parquet: each state with its bound.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["shard", "missing"])]
    pub(super) track: Option<PathBuf>,
    /// Choose the observer, in the place of those that the scene names: windows of several lengths and all samples at once are tried until
    /// the standard deviation of each estimated state at the end is at most this part of its size, as in 1e-3.
    #[arg(long, value_name = "PART", value_parser = super::arguments::part, conflicts_with_all = ["within", "studies", "shard", "merge", "missing"])]
    pub(super) accuracy: Option<f64>,
    /// Choose the observer in the same way: the most accurate of those whose estimate takes at most this long, as in 20ms or 1.5s.
    #[arg(long, value_name = "TIME", value_parser = super::arguments::time, conflicts_with_all = ["studies", "shard", "merge", "missing"])]
    pub(super) within: Option<f64>,
    /// Keep how far each search of a fit has come in this file, and go on from it where it is there: of scenes with several experiments. A run in several parts gives the
    /// answer of one run.
    #[arg(long, value_name = "FILE")]
    pub(super) resume: Option<PathBuf>,
    #[command(flatten)]
    pub(super) shards: Shards,
    /// Print no times: two runs with one seed on one machine then write the same to the last byte, as a merge does, which has no times.
    #[arg(long)]
    pub(super) no_times: bool,
    /// Print one JSON object: 'observers' with their 'updates' and 'end', and the studies.
    #[arg(long)]
    pub json: bool,
}

impl Observe {
    /// Observes. What a study of slow motion has come to is told where an interrupt does not wait for its body.
    pub fn run(self) -> miette::Result<Status> {
        let form = Form::of(self.json);
        let kept: KeptSlow = KeptSlow::default();
        let filled = kept.clone();
        watched(move || self.work(&filled), move || kept.tell().unwrap_or_else(|| nothing_found(form)))
    }

    /// Whether the command line says that measurements come from standard input; a scene may say so too.
    pub fn reads_a_stream(&self) -> bool {
        self.data.as_deref() == Some(Path::new("-"))
    }

    fn work(self, kept: &KeptSlow) -> miette::Result<Status> {
        if let Some(space) = SpaceScene::read(&self.scene) {
            self.has_no_choice("a body in space")?;
            self.searches_little()?;
            return self.run_space(space?);
        }
        if let Some(slow) = SlowScene::read(&self.scene) {
            self.has_no_choice("a body that is moved slowly")?;
            self.searches_little()?;
            return self.run_slow(slow?, kept);
        }
        if let Some(joint) = JointScene::read(&self.scene) {
            self.has_no_choice("a scene with several experiments")?;
            return self.run_joint(joint?);
        }
        self.searches_little()?;
        let mut scene = read_scene(&self.scene)?;
        scene.seed = self.seed.unwrap_or(scene.seed);
        let from = self.data.as_deref().or(scene.data.record.as_deref());
        let is_stream = from == Some(Path::new("-"));
        if is_stream {
            print_in_lines();
        }
        self.goes_together(&scene, is_stream)?;
        if is_stream {
            return observe_stream::observe(scene, Form::of(self.json), self.no_times);
        }
        let bar = progress(scene.observer.methods.len() as u64 + 1, "simulating");
        let mut experiment = Experiment::new(scene, self.data.as_deref())?;
        bar.inc(1);
        let asks_for_studies = self.studies || self.shards.are_asked();
        if asks_for_studies && experiment.simulated().is_none() {
            let message = "a study needs the true states, which a recording does not have";
            return Err(Unusable::report(Code::Option, message, "leave out --studies, or simulate"));
        }
        if asks_for_studies && experiment.scene.study.is_empty() {
            let message = "the scene has no studies";
            let asked = if self.studies {
                "--studies"
            } else {
                "--shard, --merge and --missing, which are of studies"
            };
            let help =
                format!("add [study.noise], [study.basin] or [study.curvature] to it, or leave out {asked}");
            return Err(Unusable::report(Code::Question, message, help));
        }
        let merged = if self.shards.are_asked() {
            match self.shard_or_merge(&experiment, &bar)? {
                Sharded::Done(status) => return Ok(status),
                Sharded::Merged(studied) => Some(studied),
            }
        } else {
            None
        };
        let mut files = Files::default();
        if let Some(path) = &self.record {
            files.table(path, experiment.as_written());
            files.announce(path);
        }
        if let Some(path) = &self.motion {
            let table = match (&experiment.simulation, &experiment.motion) {
                (Some(simulation), _) => simulation.table(),
                (None, Some(motion)) => motion.table(),
                (None, None) => {
                    let message = "a recording has no true motion";
                    return Err(Unusable::report(Code::Option, message, "leave out --motion, or --data"));
                }
            };
            let table = table.map_err(|error| Unusable::report(Code::Question, error.to_string(), ""))?;
            files.table(path, &table);
            files.announce(path);
        }
        if self.records_to_output() {
            // what is printed is the record alone: others may read it
            bar.finish_and_clear();
            return Ok(files.status(Status::of(true)));
        }
        let choice = self.choose(&mut experiment, &bar)?;
        bar.set_message("observing");
        if !experiment.scene.observer.modes.is_empty() {
            return self.run_modes(&experiment, &bar, files);
        }
        let mut answers = experiment.run_with_shape(&INTERRUPTED, &|method| {
            bar.set_message(method.name());
            bar.inc(1);
        })?;
        experiment.recognition = experiment.recognise(&INTERRUPTED)?;
        bar.finish_and_clear();
        let no_times = self.no_times || merged.is_some();
        if no_times {
            answers.iter_mut().for_each(Answer::forget_times);
        }
        self.write_shape(&experiment, &answers, &mut files)?;
        let studied = match merged {
            Some(merged) => merged,
            None if self.studies => studies(&experiment)?,
            None => Studied::default(),
        };
        begin_to_tell();
        let interrupted = interrupted();
        let observed =
            Observed { experiment: &experiment, answers: &answers, studied: &studied, interrupted };
        let mut json = observe_json(&observed);
        if no_times {
            forget_seconds(&mut json);
        }
        if let Some(choice) = &choice {
            json["choice"] = choice_json(choice, !no_times);
        }
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &observe_page(&observed));
            files.json(&folder.join("observe.json"), &json);
            files.announce(&folder.join("index.html"));
        }
        if let Some(simulation) = &experiment.simulation
            && *simulation.ended() != Ended::Completed
        {
            note(&format!("the motion ended early: {}", simulation.ended()));
        }
        if let Some(lost) = experiment.motion.as_ref().and_then(|motion| motion.ended()) {
            note(&format!("the motion ended early: {lost}"));
        }
        // a window that cannot be seen is part of the answer; a method by windows that saw none has found nothing, and one that
        // contradicts the measurements is wrong; filters beside them are there to be compared, and where only filters were asked they have to pass their test
        let by_windows = |answer: &Answer| answer.method.is_by_windows();
        let has_windows = answers.iter().any(by_windows);
        let as_expected = answers.iter().all(|answer| match (by_windows(answer), interrupted) {
            (true, true) => !answer.track.is_contradicted(),
            (true, false) => answer.track.is_sound(),
            (false, _) => has_windows || answer.track.passes(),
        });
        let is_known = |found: &Recognition| found.verdict != RecognitionVerdict::NoneOfThem;
        let status = Status::of(as_expected && experiment.recognition.as_ref().is_none_or(is_known));
        let status = self.status_with(status, choice.as_ref());
        let text = || match &choice {
            Some(choice) => format!("{}\n{}", choice_text(choice, !no_times), observe_text(&observed)),
            None => observe_text(&observed),
        };
        files.print(Form::of(self.json), json, text, status)
    }
}

/// What is left of a command whose studies are cut.
enum Sharded {
    /// A shard was done, or those that are missing were printed.
    Done(Status),
    Merged(Studied),
}

impl Observe {
    /// Does a shard of the studies, tells which are missing, or merges them.
    fn shard_or_merge(&self, experiment: &Experiment, bar: &ProgressBar) -> miette::Result<Sharded> {
        let studies = Studies::new(experiment, &INTERRUPTED)?;
        let parts = Parts {
            kind: "observe",
            extension: ".json",
            read: &|text| StudyPart::read(text).map_err(|why| why.to_string()),
            belongs: &|part: &StudyPart| part.fingerprint() == studies.fingerprint(),
        };
        let form = Form::of(self.json);
        if let Some(missing) = &self.shards.missing {
            bar.finish_and_clear();
            begin_to_tell();
            return parts.tell_missing(missing, form).map(Sharded::Done);
        }
        if let (Some(shard), Some(folder)) = (self.shards.shard, &self.shards.part) {
            bar.set_message("trials");
            let status = parts.do_shard(shard, folder, None, form, |_| {
                let places = shard_of(studies.trials(), shard.number, shard.of);
                bar.set_position(0);
                bar.set_length(places.end - places.start);
                let part = studies.part(places, &INTERRUPTED, &|| bar.inc(1));
                bar.finish_and_clear();
                Ok(part.and_then(|part| part.text()))
            });
            return status.map(Sharded::Done);
        }
        let all = self.shards.merge.as_ref().map_or_else(|| Ok(Vec::new()), |folder| parts.all(folder))?;
        let merged =
            studies.merge(all).map_err(|why| Unusable::report(Code::Saved, why.to_string(), NO_WHOLE))?;
        Ok(Sharded::Merged(merged))
    }
}

impl Observe {
    /// Whether the record is what is printed.
    pub(super) fn records_to_output(&self) -> bool {
        self.record.as_deref() == Some(Path::new("-"))
    }

    /// Whether no more is asked for than the record, where that is what is printed.
    pub(super) fn records_alone(&self) -> miette::Result<()> {
        let asked = [
            ("--json", self.json),
            ("--studies", self.studies),
            ("--out", self.out.is_some()),
            ("--outline", self.outline.is_some()),
            ("--track", self.track.is_some()),
            ("--accuracy", self.accuracy.is_some()),
            ("--within", self.within.is_some()),
        ];
        match asked.iter().find(|(_, is_asked)| *is_asked) {
            Some((name, _)) if self.records_to_output() => {
                let message = format!(
                    "with --record - the measurements are all that is printed, and no observer runs: {name} asks for more"
                );
                Err(Unusable::report(Code::Option, message, "record to a file, or leave the other out"))
            }
            _ => Ok(()),
        }
    }

    /// Whether what is asked for can be had at once.
    fn goes_together(&self, scene: &Scene, is_stream: bool) -> miette::Result<()> {
        self.records_alone()?;
        self.goes_with_modes(scene, is_stream)?;
        if !scene.observer.library.is_empty() && (is_stream || !scene.observer.modes.is_empty()) {
            let message = "a body is recognised by all measurements at once: not by those of a stream, and not beside modes";
            let help = "leave out [[observer.library]]; or [[observer.modes]], and put the measurements into a file first";
            return Err(Unusable::report(Code::Option, message, help));
        }
        if is_stream {
            let asked = [
                ("--studies", self.studies || self.shards.are_asked()),
                ("--out", self.out.is_some()),
                ("--record", self.record.is_some()),
                ("--motion", self.motion.is_some()),
                ("--outline", self.outline.is_some()),
                ("--track", self.track.is_some()),
                ("--accuracy", self.accuracy.is_some()),
                ("--within", self.within.is_some()),
            ];
            if let Some((name, _)) = asked.iter().find(|(_, is_asked)| *is_asked) {
                let message = format!("{name} needs all measurements, and a stream is not kept");
                return Err(Unusable::report(
                    Code::Option,
                    message,
                    "put the measurements into a file first, and hand it over with --data",
                ));
            }
            if scene.data.record.as_deref().is_some_and(|record| record != Path::new("-")) {
                note("measurements come from standard input, and not from the scene's record");
            }
        }
        Ok(())
    }
}

/// Why there may be no outline.
const NO_OUTLINE: &str = "no support radius was observable; an outline takes two palms with the outputs s1 and s2, and r1 and r2 estimated and observable";

impl Observe {
    /// The files of `--outline` and `--track`.
    fn write_shape(
        &self,
        experiment: &Experiment,
        answers: &[Answer],
        files: &mut Files,
    ) -> miette::Result<()> {
        let reconstruction = shown(answers).and_then(|answer| answer.reconstruction.as_deref());
        let unexpected = |error: RecordError| Unusable::report(Code::Question, error.to_string(), "");
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
