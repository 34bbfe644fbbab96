//! `palmistry observe` of a scene with `motion = "quasistatic"`.

use super::interrupt::{begin_to_tell, interrupted};
use super::observe::Observe;
use super::output::{Files, Form, progress};
use super::slow_text::{KeptSlow, SlowFound};
use super::{Status, Unusable};
use palmistry::experiment::slow::{SlowExperiment, SlowScene, StudyRow, slow_study};
use palmistry::system::Code;

impl Observe {
    /// What does not go with slow motion, or not together.
    fn slow_goes_together(&self, scene: &SlowScene) -> miette::Result<()> {
        let not_for_slow = [
            (self.motion.is_some(), "--motion"),
            (self.outline.is_some(), "--outline"),
            (self.track.is_some(), "--track"),
        ];
        if let Some((_, option)) = not_for_slow.iter().find(|(is_given, _)| *is_given) {
            let message = format!("{option} is not for slow motion");
            return Err(Unusable::report(
                Code::Option,
                message,
                "leave it out; --record, --out and --json say all there is",
            ));
        }
        let cut = [
            (self.shards.shard.is_some(), "--shard"),
            (self.shards.merge.is_some(), "--merge"),
            (self.shards.missing.is_some(), "--missing"),
        ];
        if let Some((_, option)) = cut.iter().find(|(is_given, _)| *is_given) {
            let message = format!("{option} is not for slow motion: its study is not cut into shards");
            return Err(Unusable::report(
                Code::Option,
                message,
                "run it with --studies; fewer 'bodies' or 'samples' in [study] take less time",
            ));
        }
        if self.studies && scene.study.is_none() {
            return Err(Unusable::report(
                Code::Question,
                "the scene has no study",
                "add [study] to it, or leave out --studies",
            ));
        }
        self.records_alone()
    }

    /// Observes a slow scene. Its measurements are explained all at once: of standard input, too, the answer comes at the end.
    pub(super) fn run_slow(self, mut scene: SlowScene, kept: &KeptSlow) -> miette::Result<Status> {
        scene.seed = self.seed.unwrap_or(scene.seed);
        self.slow_goes_together(&scene)?;
        let bar = progress(4, "simulating");
        let experiment = SlowExperiment::new(scene, self.data.as_deref())?;
        bar.inc(1);
        let mut files = Files::default();
        if let Some(path) = &self.record {
            let record = experiment
                .record()
                .map_err(|error| Unusable::report(Code::Question, error.to_string(), ""))?;
            files.table(path, &record);
            files.announce(path);
        }
        if self.records_to_output() {
            // what is printed is the record alone: others may read it
            bar.finish_and_clear();
            return Ok(files.status(Status::of(true)));
        }
        bar.set_message("observing");
        let answers = experiment.run(&interrupted, &|step| {
            bar.set_message(step);
            bar.inc(1);
        });
        bar.finish_and_clear();
        let settings = experiment.scene.study.clone().filter(|_| self.studies);
        let scene = experiment.scene.clone();
        let told = SlowFound {
            experiment,
            answers,
            study: Vec::new(),
            out: self.out,
            form: Form::of(self.json),
            no_times: self.no_times,
        };
        kept.with(|kept| *kept = Some(told));
        if let Some(settings) = settings {
            let rows = settings.families.len()
                * settings.samples.len()
                * settings.resolutions.len()
                * settings.orders.len().max(1);
            let bar = progress((rows * settings.bodies) as u64, "bodies");
            let keep = |rows: &[StudyRow]| {
                bar.set_position(rows.iter().map(|row| row.bodies as u64).sum());
                kept.with(|kept| kept.iter_mut().for_each(|told| told.study = rows.to_vec()));
            };
            slow_study(&scene, &interrupted, &keep)
                .map_err(|error| scene.error_at("study", error.to_string(), "other families may do"))?;
            bar.finish_and_clear();
        }
        begin_to_tell();
        match kept.with(Option::take) {
            Some(told) => told.tell(files),
            None => Ok(files.status(Status::of(true))),
        }
    }
}
