//! Bodies at rest between two slow flat palms, in double precision: where they lie, and how they are carried along.
//!
//! Without friction a body that touches both palms has one freedom, its turn `phi0`, and rests where the height of its centre of mass is least. That height,
//! the [`potential`], follows from the support function alone: the palms through the origin have the normals `n_1`, `n_2` towards the body, `n_i · c = r_i`
//! for the centre of mass `c`, two linear equations whose second unknown is
//!
//! ```text
//! U = (A r_1 + B r_2)/sin phi2,    A = sin(phi1 + phi2),  B = sin phi1
//! ```
//!
//! with the radii `r_i` at the outward normals `phi1 - phi0 - pi/2` and `phi1 + phi2 - phi0 - 3 pi/2`. `A/sin phi2` and `B/sin phi2` are the contact forces
//! relative to the weight, so that both are positive where palms push. [`stable_poses`] finds every minimum over the turn, [`descend`] the one that a released
//! body comes to, [`follow_resting`] carries a body along while palms move, through folds (equation 3.43 of the thesis) and jumps.
//!
//! As the rest of this floor it knows numbers only, and nothing of how `s`, `r` and `d` move. The bodies in 320 bits ([`lowest_pose`](super::lowest_pose)), which rest by
//! differences of heights, are the witness in tests, and so is a polygon laid between two lines.
//!
//! Left out: friction, impacts (after a jump the body lies where the descent ends, at once), palms that touch each other.

mod follow;
mod plan;
mod poses;
mod potential;

#[cfg(test)]
mod tests;

pub use crate::mechanics::moving::Jump;
pub use follow::follow_resting;
pub use plan::{PlanError, plan_3_14};
pub use poses::{BalancedPose, descend, stable_poses, stationary_poses};
pub use potential::{ConvexBody, Potential, contacts_at_rest, potential};
