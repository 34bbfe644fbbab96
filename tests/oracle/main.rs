//! The standing oracle: random questions, and an independent witness who knows the answers.
//!
//! ```sh
//! cargo test --release --test oracle -- --nocapture                                  # about a minute on two cores
//! PALMISTRY_ORACLE_CASES=100000 PALMISTRY_ORACLE_SEED=7 cargo test --release --test oracle -- --nocapture
//! PALMISTRY_ORACLE_SEED=7 PALMISTRY_ORACLE_ONLY=123 cargo test --release --test oracle systems -- --nocapture
//! ```
//!
//! The witness shares no code with the engines: its expressions are a plain tree that is never simplified, its Lie
//! derivatives are products of power series around a state, its ranks an elimination over exact rationals, its values
//! rational, rational in pi, or of 240 digits. It writes proof files as text, and `library` alone gives them to the
//! library. See `README.md` beside this file for what is tried.

mod agreement;
mod boxes;
mod condition_sets;
mod conditions;
mod determinism;
mod dice;
mod exact_sets;
mod expression;
mod findings;
mod function_values;
mod identities;
mod inequalities;
mod laws;
mod library;
mod number;
mod one_variable;
mod point;
mod rank;
mod rank_sets;
mod reading;
mod rewriting;
mod series;
mod system;
mod systems;
mod thin;
mod witness;
