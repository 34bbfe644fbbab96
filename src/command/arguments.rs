//! Arguments that more than one command takes.

use clap::ValueEnum;
use palmistry::sweep::Certainty;

/// What a verdict has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Wanted {
    Certified,
    Computed,
}

impl From<Wanted> for Certainty {
    fn from(wanted: Wanted) -> Self {
        match wanted {
            Wanted::Certified => Certainty::Certified,
            Wanted::Computed => Certainty::Computed,
        }
    }
}
