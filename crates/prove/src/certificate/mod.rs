//! Certificates on boxes: is the rank full not at sampled states only, but at every state of a box?
//!
//! [`Region::new`] takes a system, a choice of rows and the sample box, brings the minors of the rows to products of
//! factors, and keeps a few of them. Where all factors of one minor are different from zero, and the system is defined,
//! the rank is full. [`Region::run`] looks for boxes on which that is *proved*, by interval arithmetic with outward
//! rounding, and halves the others, the largest first. [`Region::answer`] says which part of the volume is proved so
//! far, on which a minor is proved to vanish somewhere, and what the rest is; never more than is proved, since volumes
//! are sums of powers of one half and exact.
//!
//! Three things make boxes large. Factors have narrower bounds than their product, and depend on fewer coordinates
//! (`minors`). A factor's bounds take into account where it is monotone, and squares that can be completed
//! (`factor`). And factors without common coordinates are examined separately, in fewer dimensions (`part`).
//!
//! This module knows nothing of particular systems.

mod answer;
mod boxes;
mod choice;
mod collector;
mod common_denominator;
mod domain;
mod explain;
mod factor;
mod journal;
mod minors;
mod part;
mod part_volumes;
mod problem;
mod progress;
mod proved;
mod region;
mod region_answer;
mod rows;
mod search;
mod share;
mod slots;
mod tape;
mod workspace;

pub use answer::{BoxStanding, OpenBox, PartAnswer, Patch, RegionAnswer, RegionMap, RegionMinor, Vanishing};
pub use boxes::FreeCoordinate;
pub use progress::{Limits, Progress};
pub use proved::ProvedBox;
pub use region::{Region, certify, certify_region};
pub use rows::{HeldSymbol, RegionRow, RegionRows};
pub use share::RegionPart;
