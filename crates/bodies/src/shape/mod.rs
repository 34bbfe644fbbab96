//! The shape of a convex body from what was touched of it.
//!
//! Whatever touched the body gives [`SupportSample`]s: an outward normal in the body's frame, how far the body reaches there, and how
//! much that is worth. [`fit_support`] makes a closed [`SupportSeries`] of them, a [`ShapeEstimate`] says how sure it is: the band about it, area and
//! perimeter with their errors, whether it is convex ([`Convexity`]), and [`Coverage`] says which normals were touched at all. Who has a
//! better way from measurements to the coefficients brings these and their covariance, and has the rest. A [`SupportSpline`] is the support function of a closed
//! spline through a few points, whose curvature has kinks; [`Extent`] bounds perimeter and area by what was touched alone.
//!
//! Of bodies in space [`sphere`] knows what they contain and what they lie in, and their support function.
//!
//! This floor knows numbers. It knows nothing of palms, bodies, motions or systems.

mod convexity;
mod coverage;
mod estimate;
mod extent;
mod fit;
mod function;
mod series;
pub mod sphere;
mod spline;

pub use convexity::{Convexity, convexity};
pub use coverage::Coverage;
#[doc(hidden)]
pub use estimate::deviation_of;
pub use estimate::{Measured, ShapeEstimate};
pub use extent::Extent;
#[doc(hidden)]
pub use fit::{ORDERS, convex_deviation};
pub use fit::{SupportSample, SupportWeights, fit_support};
pub use function::SupportFunction;
pub use series::SupportSeries;
pub use spline::SupportSpline;
