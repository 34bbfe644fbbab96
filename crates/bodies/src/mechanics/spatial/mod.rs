//! Bodies in space in motion, in double precision: a smooth convex body that rolls and slides on three palms through time.
//!
//! A `SolidForm` says how a body looks, a `ConvexSolid` is the body once it is shown to be strictly convex, with volume and
//! moments. A `SpatialScene` adds mass, inertia, gravity, three palms that turn about hinges, each a plane or a sphere, a start and a `SpatialDrive`;
//! `simulate_solid` gives the moments at given times, what sensors and motors would report, and how the motion ended.
//! `balanced_orientation` is the pose in which a body lies still on palms at rest.
//!
//! As the rest of this floor it is independent: it imports numbers only, reads no proof file and uses no equation of the thesis.
//! What it knows are support functions, Newton's and Euler's laws and that a contact stays a contact, differentiated twice. The
//! bodies in 320 bits beside it, which are differenced, are the witness in tests; so is the constraint of `proofs/`.
//!
//! Left out: friction, impacts (a motion ends where a contact force reaches zero), other curved palms than
//! spheres, edges of palms.

mod balance;
mod check;
mod contact;
mod curvature;
mod form;
mod integrate;
mod laws;
mod orientation;
mod scene;
mod simulate;
mod solid;
mod sphere;

#[doc(hidden)]
pub use balance::balanced_orientation;
#[doc(hidden)]
pub use form::{Harmonic, SolidForm, Support};
#[doc(hidden)]
pub use orientation::Orientation;
#[doc(hidden)]
pub use scene::{SpatialDrive, SpatialPalm, SpatialScene, SpatialSceneError};
#[doc(hidden)]
pub use simulate::{SpatialEnded, SpatialMoment, SpatialPalmMoment, SpatialTrajectory, simulate_solid};
#[doc(hidden)]
pub use solid::{ConvexSolid, SolidFormError};
