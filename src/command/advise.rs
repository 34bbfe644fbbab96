//! `palmistry advise`: how palms may move so that they touch all of a body; what else to measure in any system.

use super::arguments::By;
use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, progress, read_scene};
use super::{Status, Unusable};
use clap::Args;
use palmistry::experiment::space::SpaceScene;
use palmistry::experiment::{AdviceLimits, AdviceQuestion, advise};
use palmistry::pose_surface::numbers;
use palmistry::report::{advice_json, advice_text};
use palmistry::system::Code;
use std::path::PathBuf;

/// Plans an experiment: what else to measure in any system, or how palms should move.
///
/// With --identify FILE is a proof file. It finds all minimal sets of further outputs, known parameters, inputs and experiments that make the named
/// unknowns identifiable or observable, the smallest sets first. That a set suffices, and that nothing of it can be left out, is decided as a claim is.
///
/// Without it FILE is a scene, and motions of two palms are searched for that touch all normals of a body and hold it all the time.
/// The scene has the body, how it starts, how long the experiment lasts, and the observer. Motions of the palms (an angle, a rate and a swing each) are drawn
/// within limits, the body is moved by Newton's laws, and the best are varied in smaller and smaller steps. For those that touch most, it computes how well windows of
/// the measurements determine the state: the Cramér-Rao bound at the truth, with the scene's sensors. What is found is printed with the lines to paste
/// into [palms]. The search is random: the same seed gives the same answer with any number of threads, and more trials may find better ones.
///
/// For a scene with motion = "spatial" it searches for runs: how to lay the body on its three palms, and how to set it turning, so that the hull of all contacts grows most, run by run, compared with
/// as many random runs.
///
/// The exit status is 1 where no set suffices, no motion was found that holds the body to the end, or fewer runs than were asked.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry advise mysystem.proof --identify k1,k2
  palmistry advise mysystem.proof --identify all --globally --by outputs --measure x2 --measure 'x3 + x4'
  palmistry advise proofs/moll2002/scenes/general.toml --trials 64
  palmistry advise SCENE --angle1 0.3,0.9 --angle2 1.2,1.9 --rate 2 --seed 7 --json
  palmistry advise proofs/moll2002/scenes/figure_5_3.toml --runs 4 --trials 32")]
pub(crate) struct Advise {
    /// The scene, or with --identify the proof file.
    pub(super) file: PathBuf,
    /// The unknowns of a proof file that are to become identifiable or observable: their names, or 'all'.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(super) identify: Vec<String>,
    /// With --identify: one value for each (globally), and not finitely many (locally).
    #[arg(long, requires = "identify")]
    pub(super) globally: bool,
    /// With --identify: what may be added; outputs, known, inputs and experiments unless given.
    #[arg(long, value_enum, value_name = "KIND,...", value_delimiter = ',', requires = "identify")]
    pub(super) by: Vec<By>,
    /// With --identify: an expression that can be measured (may be repeated); each state unless given.
    #[arg(long, value_name = "EXPRESSION", requires = "identify")]
    pub(super) measure: Vec<String>,
    /// With --identify: the largest number of additions in a set.
    #[arg(long, value_name = "N", default_value_t = 3, requires = "identify", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub(super) at_most: u8,
    /// How many motions are tried (400 unless given); in space for each run (32 unless given).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(super) trials: Option<u64>,
    /// The least and the greatest angle of palm 1 against the ground, rad (0.2,1.2 unless given).
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true)]
    pub(super) angle1: Option<String>,
    /// The least and the greatest angle of palm 2 against palm 1, rad (0.8,1.9 unless given).
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true)]
    pub(super) angle2: Option<String>,
    /// The greatest rate of either palm, rad/s (3 unless given); in space that at which the body is set turning (0.5 unless given).
    #[arg(long, value_name = "RATE")]
    pub(super) rate: Option<f64>,
    /// How many runs of a body in space (4 unless given).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100))]
    pub(super) runs: Option<u64>,
    /// Take this seed and not the scene's.
    #[arg(long, value_name = "S")]
    pub(super) seed: Option<u64>,
    /// Print one JSON object with 'best' (its 'palms', 'coverage', 'gaps') and 'expected' bounds; in space with 'runs' (how they begin, 'hull', 'outer', 'random'); with --identify 'designs'.
    #[arg(long)]
    pub json: bool,
}

fn range(option: &str, text: Option<&str>, default: [f64; 2]) -> miette::Result<[f64; 2]> {
    let Some(text) = text else { return Ok(default) };
    let help = "write the least and the greatest angle with a comma between them";
    let found =
        numbers(text).map_err(|why| Unusable::report(Code::Option, format!("{option}: {why}"), help))?;
    match found[..] {
        [low, high] if low < high && low.is_finite() && high.is_finite() => Ok([low, high]),
        _ => Err(Unusable::report(Code::Option, format!("{option}: '{text}' is no range of angles"), help)),
    }
}

impl Advise {
    pub fn run(self) -> miette::Result<Status> {
        if !self.identify.is_empty() {
            return self.run_system(&self.identify);
        }
        if self.file.extension().is_some_and(|extension| extension == "proof") {
            let help = "name unknowns of a proof file, as in --identify k1,k2 or --identify all; a scene is a TOML file";
            return Err(Unusable::report(
                Code::Option,
                "what is to be identified in this proof file is not said",
                help,
            ));
        }
        if let Some(scene) = SpaceScene::read(&self.file) {
            return self.run_space(scene?);
        }
        let first = range("--angle1", self.angle1.as_deref(), [0.2, 1.2])?;
        let second = range("--angle2", self.angle2.as_deref(), [0.8, 1.9])?;
        let rate = self.rate.unwrap_or(3.0);
        if !(rate > 0.0 && rate.is_finite()) {
            let message = format!("--rate: palms that turn at no more than {rate} rad/s do not move");
            return Err(Unusable::report(Code::Option, message, "give a rate above zero"));
        }
        if self.runs.is_some() {
            let help = "leave it out, or name a scene with motion = \"spatial\"";
            return Err(Unusable::report(Code::Option, "--runs is for bodies in space", help));
        }
        let scene = read_scene(&self.file)?;
        let trials = self.trials.unwrap_or(400);
        let question = AdviceQuestion {
            limits: AdviceLimits { angles: [first, second], rate },
            trials: trials as usize,
            seed: self.seed.unwrap_or(scene.seed),
        };
        let bar = progress(trials, "moving bodies");
        let advice = advise(&scene, &question, &INTERRUPTED, &|| bar.inc(1))?;
        bar.finish_and_clear();
        begin_to_tell();
        let is_held = advice.best.as_ref().is_some_and(|best| best.is_held());
        let json = advice_json(&scene, &advice, interrupted());
        Files::default().print(
            Form::of(self.json),
            json,
            || advice_text(&scene, &advice),
            Status::of(is_held),
        )
    }
}
