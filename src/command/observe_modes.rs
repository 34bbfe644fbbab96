//! `palmistry observe` of a scene with `[[observer.modes]]`: several systems side by side.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::observe::Observe;
use super::output::{Files, Form};
use super::{Status, Unusable};
use indicatif::ProgressBar;
use palmistry::experiment::{Experiment, Scene};
use palmistry::file::note;
use palmistry::mechanics::moving::Ended;
use palmistry::report::{modes_json, modes_text};
use palmistry::system::Code;

impl Observe {
    /// Whether what is asked for can be had of modes.
    pub(super) fn goes_with_modes(&self, scene: &Scene, is_stream: bool) -> miette::Result<()> {
        let asked = [
            ("--data -", is_stream),
            ("--studies", self.studies || self.shards.are_asked()),
            ("--out", self.out.is_some()),
            ("--outline", self.outline.is_some()),
            ("--track", self.track.is_some()),
            ("--accuracy", self.accuracy.is_some()),
            ("--within", self.within.is_some()),
        ];
        match asked.iter().find(|(_, is_asked)| *is_asked) {
            Some((name, _)) if !scene.observer.modes.is_empty() => {
                let message = format!(
                    "modes are reported as text or JSON, of a recording or a simulation: not with {name}"
                );
                Err(Unusable::report(Code::Option, message, "leave it out, or [[observer.modes]]"))
            }
            _ => Ok(()),
        }
    }

    /// Tells which mode each window is of.
    pub(super) fn run_modes(
        &self,
        experiment: &Experiment,
        bar: &ProgressBar,
        files: Files,
    ) -> miette::Result<Status> {
        let windows = match experiment.scene.observer.switch {
            Some(_) => experiment.run_switched(&INTERRUPTED, &|| bar.tick())?,
            None => experiment.run_modes(&INTERRUPTED, &|| bar.tick())?,
        };
        bar.finish_and_clear();
        begin_to_tell();
        if let Some(simulation) = &experiment.simulation
            && *simulation.ended() != Ended::Completed
        {
            note(&format!("the motion ended early: {}", simulation.ended()));
        }
        // a window in which modes change fits none: that is part of the answer
        let status = Status::of(windows.iter().any(|window| window.chosen.is_some()));
        let mut json = modes_json(experiment, &windows);
        json["interrupted"] = interrupted().into();
        files.print(Form::of(self.json), json, || modes_text(experiment, &windows), status)
    }
}
