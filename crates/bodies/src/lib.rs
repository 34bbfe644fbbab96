//! Bodies and palms in doubles: the shape of a convex body ([`shape`]), real bodies between real palms by Newton's laws ([`mechanics`]), and
//! the surface of stable poses between slow palms ([`pose_surface`]).
//!
//! A second witness for the physics: this crate reads no proof file and shares no formula with one.

#![warn(missing_docs)]

// each imports from those above it

// the shape of a convex body from its contacts
pub mod shape;

// real bodies between real palms
#[doc(hidden)]
pub mod mechanics;

// the surface of stable poses of a body between slow palms
pub mod pose_surface;
