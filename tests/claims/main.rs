//! Is it so? Claims, the language they are written in, and what a verdict rests on.

#[path = "../common/mod.rs"]
mod common;

mod assumptions;
mod bad_input;
mod blocks;
mod brackets;
mod composed;
mod derivation;
mod dimensions;
mod drops;
mod edges;
mod formulas;
mod functions;
mod inequalities;
mod inputs;
mod kinks;
mod language;
mod lie_derivatives;
mod misprints;
mod mistakes;
mod mistakes_of_entries;
mod mutated_verdicts;
mod mutation;
mod nonrational;
mod orders;
mod published;
mod rank_bounds;
mod recheck;
mod sentences;
mod series;
mod shown;
mod thin;
mod units;
mod vectors;
mod visible;
mod words;
