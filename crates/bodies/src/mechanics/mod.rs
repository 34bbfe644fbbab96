//! Real bodies, as a second and independent witness for the physics.
//!
//! A body is given by its support function: [`PlanarBody`] with a few harmonics, [`Solid`] as an ellipsoid or
//! as a body that is none. It is laid on palms so that it touches them ([`place`], `grip`(grip())), which
//! is a linear problem, and carried along while palms and body turn as prescribed. What a sensor would
//! measure, and where the centre of mass goes, is then differentiated numerically in numbers of 320 bits
//! ([`differentiate`]): some seventy correct digits, of which the estimate vouches for more than forty.
//! Newton's laws, written for the centre of mass and the rotation and solved as linear equations, give the
//! accelerations, the contact forces and the palms' torques ([`planar_dynamics`], [`solid_dynamics`]); where
//! nothing accelerates, the potential energy gives the pose ([`lowest_pose`], [`follow`], [`resting_pose`]; in double precision [`resting`]).
//!
//! What a published formula says of such a motion can then be compared with the motion itself. For that to be
//! worth something this floor has to be independent: it imports numbers only, reads no proof file, and uses no
//! formula of the thesis beyond the definitions of the frames and of what `s`, `r`, `d` and `e` mean. In
//! particular it does not know that `r' = -d`, nor how `s` moves, nor Euler's equation.
//!
//! A [`Palm`] says what a sensor's value means: the contact, tangent, normal and curvature there. Flat ones and circular
//! ones there are in the plane; in space a [`PalmSphere`] makes one of a flat palm.
//!
//! Left out here: friction (`moving` has it), contact that breaks (the sign of a contact force is reported, not enforced), and time: a motion is known at one moment, with its first two derivatives there. Through time
//! and in double precision bodies are moved by [`moving`] in the plane and by [`spatial`] in space, for which this is the witness.
//! [`terrain`] has a robot that rolls over uneven ground.

mod body;
mod contact;
mod curved;
mod derivative;
mod dynamics;
mod grip;
mod harmonics;
pub mod linear;
mod motion;
pub mod moving;
mod pace;
mod palm;
mod precise;
mod quasistatics;
mod rest;
pub mod resting;
mod solid;
pub mod spatial;
mod spheres;
pub mod terrain;
mod tumbling;

#[doc(hidden)]
pub use body::PlanarBody;
#[doc(hidden)]
pub use contact::{Angles, Placement, place};
#[doc(hidden)]
pub use curved::place_on;
#[doc(hidden)]
pub use derivative::differentiate;
pub(crate) use derivative::{Derivatives, Moving};
#[doc(hidden)]
pub use dynamics::{Inertia, PlanarDynamics, planar_dynamics, planar_dynamics_on};
#[doc(hidden)]
pub use grip::palm_frame;
#[doc(hidden)]
pub use motion::{PalmMotion, PlanarMotion, Swing, radius_of_curvature};
#[doc(hidden)]
pub use palm::{Palm, PalmNumber, PalmPoint};
#[doc(hidden)]
pub use precise::Real;
#[doc(hidden)]
pub use quasistatics::{follow, lowest_pose};
#[doc(hidden)]
pub use rest::resting_pose;
#[doc(hidden)]
pub use solid::{Solid, SolidShape};
#[doc(hidden)]
pub use spheres::PalmSphere;
#[doc(hidden)]
pub use tumbling::{
    MovingVector, SolidDynamics, SolidInertia, SolidMotion, Tumbling, angular_acceleration, angular_velocity,
    solid_dynamics,
};
