//! Palmistry checks mathematics about systems that are seen only through their outputs.
//!
//! From a proof file to a verdict, in the order in which it happens: [`System::read`] turns the file into a system,
//! that is states, vector fields, outputs and claims over one shared graph of expressions ([`expression`],
//! [`system`]), or into an error that points into the text. [`decide_all`] takes each claim to an [`Outcome`]: an
//! identity is tested in exact arithmetic at random points of random prime fields ([`number`]), a rank by minors, a
//! number by intervals ([`claim`]).
//! [`answer_rank`] asks at sampled states whether the differentials of the outputs and of their Lie derivatives span
//! the state space ([`observability`], [`sweep`]), and [`certificate`] on which boxes they do. Real bodies, moved by Newton's laws alone, are a second witness for the physics
//! ([`mechanics`]). An [`observer`] recovers states from what is measured, and an [`experiment`] has such observers recover
//! the shape of a real body from touch. And [`report`] writes down what came of it all.
//!
//! ```
//! use palmistry::{System, decide_all};
//! let text = r#"
//!     system "A pendulum whose angle is seen"
//!     state phi, omega
//!     param k = 2
//!     angle phi
//!     drift f
//!       phi'   = omega
//!       omega' = -k*sin(phi)
//!     output phi
//!     claim 1: L(f, L(f, phi)) = -k*sin(phi)
//!     claim 2: rank = 2
//! "#;
//! let system = System::parse("pendulum.proof", text, std::path::Path::new(""))?;
//! let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
//! assert!(outcomes.iter().all(|outcome| outcome.ok));
//! # Ok::<(), palmistry::ReadError>(())
//! ```
//!
//! Beside these stand [`tradeoff`], speed against accuracy and the extremes, and [`paper`], a folder taken through all of it.
//! Each module is a floor and imports only from those above it here.

// files: read within bounds, written whole or not at all
#[doc(hidden)]
pub mod file;

// what a value can be
pub mod number;

// from text to a shared graph of expressions, its derivative, its value
pub mod expression;

// a system, and how it is read from a proof file
pub mod system;

// what was found, evaluated again by code that shares nothing with what found it
pub mod checker;

// Lie derivatives, codistribution, conditions
pub mod observability;

// the rank at many states
pub mod sweep;

// full rank on boxes
pub mod certificate;

// inequalities: signs, sums of squares, boxes
pub(crate) mod inequality;

// what verdicts rest on, written down for the checker
#[doc(hidden)]
pub mod evidence;

// claims, the engines that decide them, verdicts
pub mod claim;

// real bodies between real palms, a second witness for the physics
#[doc(hidden)]
pub mod mechanics;

// states recovered from what is measured
pub mod observer;

// speed against accuracy, the extremes
#[doc(hidden)]
pub mod tradeoff;

// bodies, sensors and observers together: scenes
pub mod experiment;

// a folder of claims, sets, pictures and scenes taken through everything below
pub mod paper;

// the page, the plots, the JSON
#[cfg(feature = "report")]
pub mod report;

pub use certificate::certify;
pub use claim::{
    Outcome, PointValue, ValueError, Verdict, Witness, certified_value, decide, decide_all, prove,
};
pub use sweep::{RankAnswer, RankQuestion, answer_rank};
pub use system::{ReadError, System};
