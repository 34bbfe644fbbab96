//! Planar bodies in motion, in double precision: a smooth convex body that slides between two palms through
//! time.
//!
//! A `BodyForm` says how a body looks, a `Shape` is the body once it is shown to be strictly convex: its
//! support function about the centre of mass, area, perimeter, radius of gyration. A `MovingScene` adds masses,
//! gravity, a start and a `Drive`, which prescribes either the palms' motion or their torques;
//! `simulate` then gives a `Trajectory`, what sensors and motors would report at given times, and how it ended, [`Ended`].
//!
//! As the rest of this floor it is independent: it imports numbers only and reads no proof file. What it knows
//! are the geometry of support functions, Newton's and Euler's laws and that a contact stays a contact. In
//! particular no equation of the thesis for how `s`, `r` or `d` change is used, so that a motion can be held
//! against them. The bodies in 320 bits beside it obey the same laws by differences, and are
//! the witness in tests; what a body with harmonics looks like, its support function, both share.
//!
//! `friction` has stick and slip by Coulomb's law, [`simulate_with_friction`].
//!
//! Left out: impacts (a motion ends where a contact force reaches zero, for after that the body may
//! come back and hit), palms that touch each other, the palms' own weight.

mod arcs;
mod breach;
mod check;
mod curved;
mod drive;
mod form;
mod friction;
mod integrate;
mod laws;
mod plane;
mod positive;
mod quadrature;
mod random;
mod scene;
mod series;
mod shape;
mod simulate;
mod spline;
mod superellipse;
mod trajectory;

#[cfg(test)]
pub(crate) mod fixtures;
#[cfg(test)]
mod tests;

#[doc(hidden)]
pub use drive::{Course, Drive, Oscillation, PushedPalm};
#[doc(hidden)]
pub use form::{BodyForm, CentreOfMass, FormError, Knots};
pub use friction::{ContactMode, ModePair};
#[doc(hidden)]
pub use friction::{RubbedMotion, simulate_with_friction};
#[doc(hidden)]
pub use random::{DrawnSpline, SplineDraws};
#[doc(hidden)]
pub use scene::{DEFAULT_TOLERANCE, MovingScene, SceneError};
#[doc(hidden)]
pub use shape::Shape;
pub(crate) use simulate::checked_times;
#[doc(hidden)]
pub use simulate::simulate;
pub(crate) use trajectory::PalmMoment;
#[doc(hidden)]
pub use trajectory::{Ended, Jump, Moment, Trajectory};
