//! Palmistry checks mathematics about systems that are seen only through their outputs.
//!
//! ```
//! use palmistry::{RankQuestion, System, answer_rank, prove};
//! let mut system: System = r#"
//!     system "A pendulum whose angle is measured"
//!     state phi, omega
//!     param k = 2
//!     angle phi
//!     drift f
//!       phi'   = omega
//!       omega' = -k*sin(phi)
//!     output phi
//!     sample
//!       phi   in [-3, 3]
//!       omega in [-2, 2]
//!     claim acceleration: L(f, f, phi) = -k*sin(phi)
//!     claim observable: rank = 2
//! "#.parse()?;
//!
//! // every claim with its verdict: proved, refuted with a witness, or undecided
//! for outcome in prove(&system) {
//!     assert_eq!(outcome.word(), "proved", "{}", outcome.statement);
//! }
//!
//! // the rank of the observability codistribution at a thousand drawn states, certified at each
//! let answer = answer_rank(&mut system, &RankQuestion::default())?;
//! let states = &answer.branches[0].full;
//! assert_eq!((states.rank_histogram[&2], states.certified), (1000, 1000));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! From a proof file to a verdict, in the order in which it happens: [`System::read`] turns the file into a system,
//! that is states, vector fields, outputs and claims over one shared graph of expressions ([`expression`],
//! [`system`]), or into an error that points into the text. [`prove`] takes each claim to an [`Outcome`]: an
//! identity is tested in exact arithmetic at random points of random prime fields ([`number`]), a rank by minors, a
//! number by intervals ([`claim`]). [`answer_rank`] asks at sampled states whether the differentials of the outputs and of
//! their Lie derivatives span the state space ([`observability`], [`sweep`]), and [`certify`] on which boxes they do
//! ([`certificate`]). An [`observer`] recovers states from what is measured, and an [`experiment`] has such observers recover
//! the shape of a real body from touch, moved by Newton's laws alone. What verdicts rest on is written down, and a [`checker`]
//! that shares nothing with the engines finds it again. A [`paper`] is a folder taken through all of it, and `report` writes
//! down what came of it all.
//!
//! # Numbers, units, rows
//!
//! Values of symbols are exact rationals ([`dashu::rational::RBig`](https://docs.rs/dashu)), angles among them in radians;
//! everything else has the units in which the system was written, times of recordings are seconds. A matrix of differentials has
//! a row for each function and a column for each state, in the order in which the file declares them.
//!
//! # Features
//!
//! `cli` (default) is the program `palmistry` with all that it needs; `report` is text, JSON, pages and pictures of answers;
//! `parquet` reads and writes recordings as Parquet files beside CSV. With `default-features = false` none of their crates is built.
//!
//! # What is promised
//!
//! What is documented here. Items that are hidden from the documentation are what the program, the tests and the benchmarks
//! reach of the inside; they may change with every version.

#![warn(missing_docs)]

// Each is a crate under `crates/`, or a module of one, and knows only those above it here: their manifests say so.

#[doc(hidden)]
pub use palmistry_io::{file, foreign};

pub use palmistry_math::{expression, number};

pub use palmistry_lang as system;

pub use palmistry_import as import;

pub use palmistry_checker as checker;

#[doc(hidden)]
pub use palmistry_coq as coq;

pub use palmistry_rank::{design, observability, sweep};

pub use palmistry_reduce as reduction;

pub use palmistry_prove::{certificate, claim};
#[doc(hidden)]
pub use palmistry_prove::{drops, evidence};

#[doc(hidden)]
pub use palmistry_bodies::mechanics;
pub use palmistry_bodies::{pose_surface, shape};

pub use palmistry_observe as observer;

#[doc(hidden)]
pub use palmistry_fit as fit;

pub use palmistry_scenes as experiment;

pub use palmistry_workbench::paper;
#[doc(hidden)]
pub use palmistry_workbench::tradeoff;

#[cfg(feature = "report")]
pub use palmistry_report as report;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub use palmistry_lsp as lsp;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub use palmistry_lab as lab;

pub use certificate::certify;
pub use claim::{
    Outcome, PointValue, ValueError, Verdict, Witness, certified_value, decide, decide_all, prove,
};
pub use sweep::{RankAnswer, RankQuestion, answer_accessibility, answer_rank, answer_solutions};
pub use system::{ReadError, System};
