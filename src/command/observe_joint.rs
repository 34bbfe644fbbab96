//! `palmistry observe` of a scene with several experiments.

use super::interrupt::{begin_to_tell, interrupted};
use super::observe::Observe;
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use palmistry::experiment::joint::{JointExperiments, JointScene};
use palmistry::report::{
    JointObserved, joint_json, joint_page, joint_parameters, joint_simulation, joint_text,
};
use palmistry::system::Code;

impl Observe {
    /// What does not go with several experiments.
    fn joint_goes_together(&self) -> miette::Result<()> {
        let refused = [
            (self.record.is_some(), "--record", "the measurements are in the scene's file"),
            (self.motion.is_some(), "--motion", "--out and --json have what is expected at each measurement"),
            (self.outline.is_some(), "--outline", "there is no body"),
            (self.track.is_some(), "--track", "--out and --json have what is expected at each measurement"),
            (self.studies, "--studies", "a scene of several experiments has none"),
            (self.shards.shard.is_some(), "--shard", "a scene of several experiments has no studies"),
            (self.shards.merge.is_some(), "--merge", "a scene of several experiments has no studies"),
            (self.shards.missing.is_some(), "--missing", "a scene of several experiments has no studies"),
            (self.reads_a_stream(), "--data -", "all experiments are explained at once: give a file"),
        ];
        match refused.iter().find(|(is_given, ..)| *is_given) {
            Some((_, option, why)) => Err(Unusable::report(
                Code::Option,
                format!("{option} is not for several experiments"),
                format!("leave it out: {why}"),
            )),
            None => Ok(()),
        }
    }

    /// Fits several experiments at once.
    pub(super) fn run_joint(self, mut scene: JointScene) -> miette::Result<Status> {
        scene.seed = self.seed.unwrap_or(scene.seed);
        self.joint_goes_together()?;
        let experiments = JointExperiments::new(scene, self.data.as_deref())?;
        let bar = progress(experiments.count() as u64, "searching");
        let answer = experiments.run(&interrupted, &|| bar.inc(1));
        bar.finish_and_clear();
        begin_to_tell();
        let observed =
            JointObserved { experiments: &experiments, answer: &answer, interrupted: interrupted() };
        let json = joint_json(&observed);
        let mut files = Files::default();
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &joint_page(&observed));
            files.json(&folder.join("observe.json"), &json);
            for (name, table) in [
                ("simulation.tsv", joint_simulation(&observed)),
                ("parameters.tsv", joint_parameters(&observed)),
            ] {
                if let Some(table) = table {
                    files.text(&folder.join(name), &table);
                }
            }
            files.announce(&folder.join("index.html"));
        }
        // a search that was cut off may have found what explains them
        let status = if observed.interrupted { Status::CutOff } else { Status::of(answer.as_expected()) };
        files.print(Form::of(self.json), json, || joint_text(&observed), status)
    }
}
