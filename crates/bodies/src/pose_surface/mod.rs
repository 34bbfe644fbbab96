//! The surface of stable poses of a convex body between two slow, flat palms without friction (section 3.6 of the thesis): how it hangs together, what a cycle of
//! palm angles turns the body by, and how to plan on it.
//!
//! A [`PoseBody`] has a [`potential`], the height of its centre of mass; its minima are the [`stable_poses`]. Over the pairs of touching normals the surface
//! is a graph ([`ContactChart`]) whose components, with their holonomy, are computed at any margin from parallel palms; over the palm angles it is a
//! [`PoseGrid`], on which [`pose_plan`] finds ways and [`slide()`] runs them; [`certify_surface`] proves by intervals what hangs together and what does not.
//! [`conjecture`] asks all of it of many bodies.
//!
//! What only [`certify_surface`] says is certain. The rest is computed in doubles on grids: what is narrower than a step may be joined or cut.
//! This floor knows bodies and palms; it knows nothing of sensors, systems, files or pages.

mod body;
mod certify;
mod contact_chart;
mod enclosed;
mod families;
#[cfg(test)]
mod figure_3_17;
mod plan;
mod potential;
mod sheets;
mod slide;
mod stable;
mod study;
mod survey;
mod turns;
mod zeros;

pub use body::{BodyTextError, PoseBody, numbers};
pub use certify::{CertifiedComponent, SurfaceCertificate, certify_surface};
pub use contact_chart::{ClosingFold, ContactChart, SurfaceComponent, closing_folds};
pub use families::BodyFamily;
pub use plan::{NoPlan, PlanGoal, PosePlan, finer_pose_plan, pose_plan};
pub use potential::{PalmPair, measurements, potential};
pub use sheets::{GridPose, PoseGrid, PoseLimits};
pub use slide::{PoseJump, Slide, path_length, plan_of_figure_3_14, slide};
pub use stable::{StablePose, level_poses, stable_poses};
pub use study::{ConjectureFinding, ConjectureQuestion, MarginFinding, PlanFinding, conjecture};
pub use survey::{PoseQuestion, PoseSurvey, survey_poses};
