//! The shape of a convex body in space from what was touched of it.
//!
//! [`contact_hull`] is what the body contains, [`half_space_intersection`], [`ball_intersection`] and [`balls_and_half_spaces`] are what it lies in: their volumes are certain for the contacts as they
//! are given. [`fit_solid`] makes a support function on the sphere of them. [`SurfaceMesh`] writes surfaces for other programs, and [`planar_hull`] and
//! [`half_plane_intersection`] are the bounds of a body in the plane.

mod balls;
mod bounds;
mod fit;
mod harmonics;
mod hull;
mod mesh;
mod planar;
mod rounded;
mod side;
mod vector;

pub use balls::{ball_intersection, balls_and_half_spaces};
pub use bounds::{
    BoundedRegion, OuterBound, SurfaceTouch, TouchError, contact_hull, half_space_intersection,
};
pub use fit::{SolidEstimate, SolidSample, fit_solid};
pub use harmonics::SphereSeries;
pub use mesh::SurfaceMesh;
pub use planar::{PlanarOuterBound, PlanarRegion, PlanarTouch, half_plane_intersection, planar_hull};
pub use rounded::rounded_hull;

#[cfg(test)]
mod tests;
