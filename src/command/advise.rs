//! `palmistry advise`: how palms may move so that they touch all of a body.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use clap::Args;
use palmistry::experiment::{AdviceLimits, AdviceQuestion, Scene, advise};
use palmistry::pose_surface::numbers;
use palmistry::report::{advice_json, advice_text};
use std::path::PathBuf;

/// Seeks motions of two palms that touch all normals of a body and hold it all the time, before an experiment is made.
///
/// SCENE has the body, how it starts, how long the experiment lasts, and the observer. Courses of the palms (an angle, a rate and a swing each) are drawn
/// within limits, the body is moved by Newton's laws, and the best courses are varied, less and less. Of those that touch most it is asked how well windows of
/// the readings could tell the state: the bound of Cramér and Rao at the truth, with the scene's sensors. What is found is printed with the lines to paste
/// into [palms]. The search is random: the same seed gives the same answer with any number of threads, and more trials may find better ones.
///
/// The exit status is 1 where no course was found that holds the body to the end.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry advise proofs/moll2002/scenes/general.toml --trials 64
  palmistry advise SCENE --angle1 0.3,0.9 --angle2 1.2,1.9 --rate 2 --seed 7 --json")]
pub(crate) struct Advise {
    /// The scene.
    scene: PathBuf,
    /// How many courses are tried.
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    trials: u64,
    /// The least and the greatest angle of palm 1 against the ground, rad.
    #[arg(long, value_name = "LOW,HIGH", default_value = "0.2,1.2", allow_hyphen_values = true)]
    angle1: String,
    /// The least and the greatest angle of palm 2 against palm 1, rad.
    #[arg(long, value_name = "LOW,HIGH", default_value = "0.8,1.9", allow_hyphen_values = true)]
    angle2: String,
    /// The greatest rate of either palm, rad/s.
    #[arg(long, value_name = "RATE", default_value_t = 3.0)]
    rate: f64,
    /// Take this seed and not the scene's.
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Print one JSON object with 'best' (its 'palms', 'coverage', 'gaps') and 'expected' bounds.
    #[arg(long)]
    pub json: bool,
}

fn range(option: &str, text: &str) -> miette::Result<[f64; 2]> {
    let help = "write the least and the greatest angle with a comma between them";
    let found = numbers(text).map_err(|why| Unusable::report(format!("{option}: {why}"), help))?;
    match found[..] {
        [low, high] if low < high && low.is_finite() && high.is_finite() => Ok([low, high]),
        _ => Err(Unusable::report(format!("{option}: '{text}' is no range of angles"), help)),
    }
}

impl Advise {
    pub fn run(self) -> miette::Result<Status> {
        let angles = [range("--angle1", &self.angle1)?, range("--angle2", &self.angle2)?];
        if !(self.rate > 0.0 && self.rate.is_finite()) {
            let message = format!("--rate: palms that turn at no more than {} rad/s do not move", self.rate);
            return Err(Unusable::report(message, "give a rate above zero"));
        }
        let scene = Scene::read(&self.scene)?;
        let question = AdviceQuestion {
            limits: AdviceLimits { angles, rate: self.rate },
            trials: self.trials as usize,
            seed: self.seed.unwrap_or(scene.seed),
        };
        let bar = progress(self.trials, "moving bodies");
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
