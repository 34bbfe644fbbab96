//! A paper is a folder: proof files, scenes, and a `paper.toml` that says what it is called and how it numbers its equations.
//! [`Paper::read`] finds them, and [`verify`] takes them through everything below: claims, ranks on named sets, maps, lines,
//! numbers in print, reductions, speed against accuracy, the extremes, certificates, bodies in motion.
//!
//! This floor knows no palm, no chapter and no file name. It calls everything below and draws nothing.

mod bounds;
mod findings;
mod folder;
mod left_out;
mod numbering;
mod reduction;
mod verify;
mod views;

#[doc(hidden)]
pub use findings::DerivativesFound;
pub use findings::{FileFindings, Findings};
#[doc(hidden)]
pub use folder::MANIFEST;
pub use folder::Paper;
#[doc(hidden)]
pub use left_out::LeftOut;
#[doc(hidden)]
pub use numbering::{NumberedEquation, Numbering};
#[doc(hidden)]
pub use reduction::ReductionFound;
pub use verify::{VerifyOptions, verify, verify_into};
#[doc(hidden)]
pub use views::{LineFound, MapFound, SetRank};
