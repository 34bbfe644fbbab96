//! `palmistry observe` of a scene with `motion = "spatial"`.

use super::interrupt::{begin_to_tell, interrupted};
use super::observe::Observe;
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use palmistry::experiment::space::{SpaceExperiment, SpaceScene};
use palmistry::file::note;
use palmistry::report::{SpaceObserved, space_ended, space_json, space_page, space_surfaces, space_text};
use palmistry::system::Code;

/// Rings of the smooth surfaces that are written.
const SURFACE_RINGS: usize = 48;

impl Observe {
    /// What does not go with bodies in space, or not together.
    fn space_goes_together(&self) -> miette::Result<()> {
        let refused = [
            (self.motion.is_some(), "--motion"),
            (self.outline.is_some(), "--outline"),
            (self.track.is_some(), "--track"),
            (self.studies, "--studies"),
            (self.shards.shard.is_some(), "--shard"),
            (self.shards.merge.is_some(), "--merge"),
            (self.shards.missing.is_some(), "--missing"),
        ];
        if let Some((_, option)) = refused.iter().find(|(is_given, _)| *is_given) {
            let message = format!("{option} is not for bodies in space");
            let help = "leave it out; --record, --out and --json say all there is, and no study of them is run by a scene";
            return Err(Unusable::report(Code::Option, message, help));
        }
        self.records_alone()
    }

    /// Observes a scene in space. A window is explained all at once: of standard input, too, the answer comes at the end.
    pub(super) fn run_space(self, mut scene: SpaceScene) -> miette::Result<Status> {
        scene.seed = self.seed.unwrap_or(scene.seed);
        self.space_goes_together()?;
        let experiment = SpaceExperiment::new(scene, self.data.as_deref())?;
        let mut files = Files::default();
        if let Some(path) = &self.record {
            let record = experiment
                .measurements
                .record()
                .map_err(|error| Unusable::report(Code::Question, error.to_string(), ""))?;
            files.table(path, &record);
            files.announce(path);
        }
        if self.records_to_output() {
            // what is printed is the record alone: others may read it
            return Ok(files.status(Status::of(true)));
        }
        let bar = progress(experiment.count() as u64, "observing");
        let mut answers = experiment.run(&interrupted, &|| bar.inc(1));
        bar.finish_and_clear();
        if self.no_times {
            answers.forget_times();
        }
        begin_to_tell();
        let observed =
            SpaceObserved { experiment: &experiment, answers: &answers, interrupted: interrupted() };
        if let Some(ended) = space_ended(&observed) {
            note(&ended);
        }
        let json = space_json(&observed);
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &space_page(&observed));
            files.json(&folder.join("observe.json"), &json);
            for one in space_surfaces(&observed, SURFACE_RINGS) {
                files.text(&folder.join(one.kind.file()).with_extension("ply"), &one.surface.ply());
                files.text(&folder.join(one.kind.file()).with_extension("obj"), &one.surface.obj());
            }
            files.announce(&folder.join("index.html"));
        }
        files.print(Form::of(self.json), json, || space_text(&observed), Status::of(answers.as_expected()))
    }
}
