//! `palmistry advise FILE --identify NAMES`: what to measure or to know besides, so that unknowns become identifiable.

use super::advise::Advise;
use super::interrupt::{INTERRUPTED, begin_to_tell};
use super::output::{Files, Form, counter};
use super::{Status, Unusable};
use palmistry::System;
use palmistry::design::{AdditionKind, DesignQuestion, design};
use palmistry::report::{design_json, design_text};
use palmistry::system::Code;
use std::path::Path;

impl Advise {
    /// Finds all minimal sets of additions.
    pub(super) fn run_system(&self, identify: &[String]) -> miette::Result<Status> {
        let of_scenes = [
            (self.trials.is_some(), "--trials"),
            (self.angle1.is_some(), "--angle1"),
            (self.angle2.is_some(), "--angle2"),
            (self.rate.is_some(), "--rate"),
            (self.runs.is_some(), "--runs"),
            (self.seed.is_some(), "--seed"),
        ];
        if let Some((_, option)) = of_scenes.iter().find(|(is_given, _)| *is_given) {
            let help = "leave it out, or leave out --identify and name a scene";
            return Err(Unusable::report(Code::Option, format!("{option} is for scenes"), help));
        }
        let system = System::read(&self.file)?;
        let folder = self.file.parent().unwrap_or(Path::new(""));
        let bar = counter("sets of additions looked at");
        let all = identify.iter().any(|name| name == "all");
        let mut question = DesignQuestion {
            targets: if all { Vec::new() } else { identify.to_vec() },
            measurable: (!self.measure.is_empty()).then(|| self.measure.clone()),
            at_most: usize::from(self.at_most),
            globally: self.globally,
            progress: &|done| bar.set_position(done),
            ..DesignQuestion::of(folder, &INTERRUPTED)
        };
        if !self.by.is_empty() {
            question.kinds = self.by.iter().map(|by| AdditionKind::from(*by)).collect();
        }
        let found = design(&system, &question);
        bar.finish_and_clear();
        let answer = found.map_err(|why| Unusable::report(Code::Question, why.to_string(), ""))?;
        begin_to_tell();
        let is_answered = answer.is_met || !answer.designs.is_empty();
        let status = match answer.open {
            Some(_) => Status::CutOff,
            None => Status::of(is_answered),
        };
        Files::default().print(Form::of(self.json), design_json(&answer), || design_text(&answer), status)
    }
}
