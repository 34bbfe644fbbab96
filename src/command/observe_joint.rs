//! `palmistry observe` of a scene with several experiments.

use super::interrupt::{begin_to_tell, interrupted};
use super::observe::Observe;
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use palmistry::experiment::joint::{JointExperiments, JointScene, Keep};
use palmistry::file::note;
use palmistry::foreign::name_of;
use palmistry::report::{
    JointObserved, joint_json, joint_page, joint_parameters, joint_simulation, joint_text,
};
use palmistry::system::Code;
use std::sync::Arc;

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

    /// That searches are kept of a fit alone.
    pub(super) fn searches_little(&self) -> miette::Result<()> {
        match &self.resume {
            None => Ok(()),
            Some(_) => Err(Unusable::report(
                Code::Option,
                "--resume is for scenes with several experiments, whose searches take long",
                "leave it out; studies are cut by --shard",
            )),
        }
    }

    /// Fits several experiments at once.
    pub(super) fn run_joint(self, mut scene: JointScene) -> miette::Result<Status> {
        scene.seed = self.seed.unwrap_or(scene.seed);
        self.joint_goes_together()?;
        let experiments = JointExperiments::new(scene, self.data.as_deref())?;
        let kept = match &self.resume {
            None => None,
            Some(path) => {
                let help = "name another file, or delete it";
                let opened = experiments.searches(path).map_err(|why| {
                    Unusable::report(Code::Saved, format!("{}: {why}", name_of(path)), help)
                })?;
                let [ended, on] = opened.counts();
                if ended + on > 0 {
                    note(&format!(
                        "going on from {}: {ended} searches have ended, {on} go on",
                        name_of(path)
                    ));
                }
                Some(Arc::new(opened))
            }
        };
        let keep = kept.as_ref().map(|kept| Arc::clone(kept) as Arc<dyn Keep>);
        let bar = progress(experiments.count() as u64, "searching");
        let answer = experiments.run(keep.as_ref(), &interrupted, &|| bar.inc(1));
        bar.finish_and_clear();
        if let (Some(kept), Some(path)) = (&kept, &self.resume)
            && let Some(why) = kept.close()
        {
            note(&format!("{} could not be written: {why}", name_of(path)));
        }
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
