//! Coulomb friction at both contacts between flat palms: stick and slip (section 6.2).
//!
//! A contact slides one way, or the other, or sticks; what sticks while palm and body turn at different rates *rolls*, and where both
//! contacts stick the body is *stuck* between palms that turn as one. In each pair of modes the laws are linear in accelerations and forces
//! (`laws`). A motion stays in its pair until a sliding contact comes to rest or the friction of one that sticks leaves its cone; then every pair
//! that the velocities allow is tried, and one goes on that is `consistent`: contacts push, friction is within its cone, and what begins to slide does so against its
//! friction. Where none is, the laws of rigid bodies with friction have no solution (P. Painleve, Lecons sur le frottement, 1895), and the motion ends with
//! that verdict.
//!
//! Left out: impacts, curved palms, a static coefficient that differs from the kinetic one.

mod consistent;
mod laws;
mod modes;
mod simulate;

pub use modes::{ContactMode, ModePair};
#[doc(hidden)]
pub use simulate::{RubbedMotion, simulate_with_friction};
