//! Everything about one subject: speed against accuracy and the extremes ([`tradeoff`]), and a folder of claims, sets, pictures and scenes
//! taken through all of it ([`paper`]).

pub mod paper;
pub mod tradeoff;
