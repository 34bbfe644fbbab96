//! Several experiments in one scene: conditions of their own, one set of parameters, errors whose size may be estimated too.
//!
//! A [`JointScene`] is read from TOML and measurements from CSV, in rows of experiment, output, time and value; [`JointScene::problem`] puts the
//! settings of each experiment into the model's equations, and [`JointExperiments`] fits all of it at once.

mod built;
mod checkpoint;
mod keys;
mod rows;
mod run;
mod unused;

pub use checkpoint::SearchFile;
pub use keys::JointScene;
pub use palmistry_fit::Keep;
pub use run::{GoodnessOfFit, JointAnswer, JointExperiments, NominalAnswer};

#[cfg(test)]
mod tests;
