//! `palmistry observe --accuracy` and `--within`: the observer is chosen by what is asked for.

use super::interrupt::INTERRUPTED;
use super::observe::Observe;
use super::{Status, Unusable};
use indicatif::ProgressBar;
use palmistry::experiment::{Experiment, ObserverChoice, Sufficient};
use palmistry::system::Code;

impl Observe {
    /// What is asked of an observer, where something is.
    pub(super) fn sufficient(&self) -> Option<Sufficient> {
        self.accuracy.map(Sufficient::Accuracy).or(self.within.map(Sufficient::Within))
    }

    /// That no observer is to be chosen, where there are none to choose from.
    pub(super) fn has_no_choice(&self, kind: &str) -> miette::Result<()> {
        match self.sufficient() {
            None => Ok(()),
            Some(_) => {
                let message = format!(
                    "{kind} is observed in one way: there is nothing to choose by --accuracy or --within"
                );
                Err(Unusable::report(Code::Option, message, "leave it out"))
            }
        }
    }

    /// The observer that suffices in the place of those that the scene names.
    pub(super) fn choose(
        &self,
        experiment: &mut Experiment,
        bar: &ProgressBar,
    ) -> miette::Result<Option<ObserverChoice>> {
        let Some(asked) = self.sufficient() else { return Ok(None) };
        bar.set_message("choosing");
        let choice = experiment.choose(asked, &INTERRUPTED, &|tried| bar.set_message(tried.method.name()))?;
        if let Some(chosen) = choice.chosen {
            *experiment = experiment.chosen(&choice.tried[chosen]);
        }
        Ok(Some(choice))
    }

    /// The status with a choice: what is asked for has to be reached.
    pub(super) fn status_with(&self, status: Status, choice: Option<&ObserverChoice>) -> Status {
        match choice {
            Some(choice) if !choice.suffices && status == Status::AsExpected => Status::NotAsExpected,
            _ => status,
        }
    }
}
