//! Bodies and palms in doubles: the shape of a convex body ([`shape`]), real bodies between real palms by Newton's laws ([`mechanics`]), and
//! the surface of stable poses between slow palms ([`pose_surface`]).
//!
//! A second witness for the physics: this crate reads no proof file and shares no formula with one.

pub mod mechanics;
pub mod pose_surface;
pub mod shape;
