//! Everything about one subject: speed against accuracy and the extremes ([`tradeoff`]), and a folder of claims, sets, pictures and scenes
//! taken through all of it ([`paper`]).

#![warn(missing_docs)]

// each imports from those above it

// speed against accuracy, the extremes
#[doc(hidden)]
pub mod tradeoff;

// a folder of claims, sets, pictures and scenes taken through everything below
pub mod paper;
