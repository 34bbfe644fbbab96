//! `palmistry plan`: what a scene requires of its model, before anything is estimated.

use super::derived::{decided, import_path};
use super::interrupt::INTERRUPTED;
use super::output::{Files, Form, read_scene};
use super::{Status, Unusable};
use clap::Args;
use palmistry::experiment::Experiment;
use palmistry::experiment::joint::JointScene;
use palmistry::experiment::slow::SlowScene;
use palmistry::experiment::space::SpaceScene;
use palmistry::foreign::name_of;
use palmistry::report::{plan_json, plan_text};
use palmistry::system::Code;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Says what a scene requires of its model, before anything is estimated.
///
/// What the scene and its measurements fix is put into the model: palms at rest or at one rate, known masses, columns that never change. The remaining states, the
/// nonzero terms and the driven inputs make the least model, a proof file whose claims say that it is the scene's model under these conditions, torques
/// included; they are decided. Then the rank: which unknowns the measurements determine generically, which estimated unknowns are unobservable, and which of them would
/// have to be known to make the rest observable; and the rank along the motion itself.
///
/// Observers substitute driving columns that never change, and integrate only the states that they need.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry plan proofs/moll2002/scenes/fixed_palms.toml
  palmistry plan SCENE --tolerance 1e-6                     without terms that are small over its ranges
  palmistry plan SCENE --data recording.csv --out least.proof && palmistry rank least.proof

Exit status: 0 nothing that is estimated is shown to be unobservable, 1 something is, or a claim of the least model is not proved, 2 the scene cannot be used.")]
pub(crate) struct Plan {
    /// The scene.
    pub(super) scene: PathBuf,
    /// Measurements from a file (CSV or Parquet) instead of a simulation.
    #[arg(long, value_name = "FILE")]
    pub(super) data: Option<PathBuf>,
    /// Take this seed and not the scene's.
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Leave out terms of a rate that together are at most this part of the median of its absolute values, as in 1e-6: over the ranges of the
    /// measurements, the bounds of what is estimated, and else those of the model's file. How large they are at most is proved, or they stay.
    #[arg(long, value_name = "PART", value_parser = super::arguments::part)]
    tolerance: Option<f64>,
    /// Write the proof file of the least model here.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Measure no times, so that the same scene gives the same bytes.
    #[arg(long)]
    no_times: bool,
    /// Print one JSON object with 'constants', 'least_model' (its 'proof' and 'claims'), 'operations', 'nanoseconds', 'rank', 'rank_along_motion'.
    #[arg(long)]
    pub json: bool,
}

impl Plan {
    pub fn run(self) -> miette::Result<Status> {
        self.has_one_model()?;
        let mut scene = read_scene(&self.scene)?;
        scene.seed = self.seed.unwrap_or(scene.seed);
        if self.data.as_deref().or(scene.data.record.as_deref()) == Some(Path::new("-")) {
            let help = "name a file: what never changes is known when all of it is there";
            return Err(Unusable::report(Code::Option, "a plan is not made of standard input", help));
        }
        let model = PathBuf::from(&scene.model);
        let experiment = Experiment::new(scene, self.data.as_deref())?;
        let whole = std::path::absolute(&model).unwrap_or_else(|_| model.clone());
        let mut plan = experiment.plan(&name_of(&whole), !self.no_times, self.tolerance, &INTERRUPTED)?;
        let out = self.out.as_deref().filter(|out| out.as_os_str() != "-");
        let mut outcomes = Vec::new();
        let mut files = Files::default();
        if let Ok(least) = &mut plan.least {
            let import = import_path(&model, out);
            least.text =
                least.text.replacen(&format!("\"{}\"", name_of(&whole)), &format!("\"{import}\""), 1);
            let place = out.unwrap_or(Path::new("least.proof"));
            outcomes = decided(&least.text, &import, &model, place)
                .map_err(|why| {
                    Unusable::report(Code::Question, format!("the least model is not written: {why}"), "")
                })?
                .1;
            if let Some(out) = out {
                files.text(out, &least.text);
                files.announce(out);
            }
        } else if out.is_some() {
            let why = plan.least.as_ref().err().cloned().unwrap_or_default();
            return Err(Unusable::report(
                Code::Option,
                format!("there is no least model to be written: {why}"),
                "leave out --out",
            ));
        }
        let mut object = plan_json(&experiment.scene, &plan, &outcomes);
        object["scene"] = json!(name_of(&self.scene));
        object["written"] = json!(out.map(name_of));
        let is_told = plan.generic.as_ref().is_none_or(|rank| rank.unobservable.is_empty());
        let all_proved = outcomes.iter().all(|outcome| outcome.ok);
        let text = || plan_text(&experiment.scene, &plan, &outcomes).trim_end().to_owned();
        files.print(Form::of(self.json), object, text, Status::of(is_told && all_proved))
    }

    /// That the scene is of a kind whose model is a proof file.
    fn has_one_model(&self) -> miette::Result<()> {
        let (kind, help) = if let Some(scene) = SpaceScene::read(&self.scene) {
            scene?;
            ("a body in space", "'palmistry advise' plans its runs")
        } else if let Some(scene) = SlowScene::read(&self.scene) {
            scene?;
            (
                "a body that is moved slowly",
                "its poses are balances of forces and no motion: 'palmistry poses' has them",
            )
        } else if let Some(scene) = JointScene::read(&self.scene) {
            scene?;
            ("several experiments", "'palmistry reduce' makes the least model of its proof file")
        } else {
            return Ok(());
        };
        Err(Unusable::report(
            Code::Question,
            format!("{}: of {kind} no least model is made", name_of(&self.scene)),
            help,
        ))
    }
}
