//! Several experiments explained by one set of parameters: simulation with exact derivatives, maximum likelihood, identifiability.
//!
//! A [`JointProblem`] is experiments (rates and initial states under their own settings), measurements with the law of their errors, and the parameters that
//! are estimated. [`Likelihood`] simulates it at some parameters, stiff or not, with its sensitivities; [`fit`] searches the largest likelihood from
//! many starts; [`Information`] says how well the measurements determine each parameter, and [`profile`] how far each could be moved.
//!
//! This floor knows systems and numbers; it knows neither scenes nor files.

#![warn(missing_docs)]

mod checkpoint;
mod compiled;
mod ends;
mod information;
mod laws;
mod likelihood;
mod problem;
mod profile;
mod search;
mod simulate;
mod steady;
mod trust;

pub use checkpoint::{Keep, SearchState};
pub use ends::{SearchEnd, StartEnd};
pub use information::{Information, WeakDirection};
pub use laws::{ErrorLaw, ErrorScale, ParameterScale, Prior, PriorLaw};
pub use likelihood::{Likelihood, SimulatedExperiments};
pub use problem::{EstimatedParameter, JointExperiment, JointMeasurement, JointProblem, Phase};
pub use profile::{ParameterProfile, profile};
pub use search::{ALLOWED, JointFit, fit};
pub use simulate::{Exactness, NotFollowed};

#[cfg(test)]
mod tests;
