//! `palmistry advise` of a scene with `motion = "spatial"`.

use super::advise::Advise;
use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use palmistry::experiment::space::{RunsQuestion, SpaceScene, advise_runs};
use palmistry::report::{runs_advice_json, runs_advice_text};
use palmistry::system::Code;

impl Advise {
    /// Seeks runs that widen the hull of all contacts.
    pub(super) fn run_space(self, scene: SpaceScene) -> miette::Result<Status> {
        for (is_given, option) in [(self.angle1.is_some(), "--angle1"), (self.angle2.is_some(), "--angle2")] {
            if is_given {
                let help = "leave it out: in space the palms move as the scene says, and the body's initial pose is searched for";
                return Err(Unusable::report(
                    Code::Option,
                    format!("{option} is not for bodies in space"),
                    help,
                ));
            }
        }
        let rate = self.rate.unwrap_or(0.5);
        if !(rate >= 0.0 && rate.is_finite()) {
            let message = format!("--rate: no body is set turning at {rate} rad/s");
            return Err(Unusable::report(Code::Option, message, "give a rate from zero on"));
        }
        let (runs, trials) = (self.runs.unwrap_or(4), self.trials.unwrap_or(32));
        let question = RunsQuestion {
            runs: runs as usize,
            trials: trials as usize,
            rate,
            seed: self.seed.unwrap_or(scene.seed),
        };
        let bar = progress(runs * trials, "moving bodies");
        let advice = advise_runs(&scene, &question, &INTERRUPTED, &|| bar.inc(1))?;
        bar.finish_and_clear();
        begin_to_tell();
        let json = runs_advice_json(&scene, &advice, interrupted());
        let status = Status::of(advice.plan.len() == question.runs);
        Files::default().print(Form::of(self.json), json, || runs_advice_text(&scene, &advice), status)
    }
}
