//! Claims and their verdicts: the engines that decide them ([`claim`]), full rank on boxes ([`certificate`]), the exact sets on which a
//! rank drops ([`drops`]), and what verdicts rest on, written down for the checker ([`evidence`]).

#![warn(missing_docs)]

// each imports from those above it

// full rank on boxes
pub mod certificate;

// the exact sets on which a rank drops
#[doc(hidden)]
pub mod drops;

// what verdicts rest on, written down for the checker
#[doc(hidden)]
pub mod evidence;

// claims, the engines that decide them, verdicts
pub mod claim;
