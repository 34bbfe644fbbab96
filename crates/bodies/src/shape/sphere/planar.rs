//! The bounds of a body in the plane, by those in space: an area is the volume of a prism of height one over it.

use super::bounds::{
    BoundedRegion, OuterBound, SurfaceTouch, TouchError, contact_hull, half_space_intersection,
};
use nalgebra::{Vector2, Vector3};
use palmistry_math::number::Interval;

/// A contact of a planar body, in the body's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarTouch {
    /// Where, in metres.
    pub point: Vector2<f64>,
    /// The outward normal there, a unit vector but for rounding.
    pub normal: Vector2<f64>,
}

/// A convex region of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarRegion {
    /// An enclosure of its area, rounded outward, in m^2.
    pub area: Interval,
    /// Its corners, rounded, counterclockwise.
    pub corners: Vec<Vector2<f64>>,
}

/// What a planar body lies in.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanarOuterBound {
    /// A bounded region.
    Bounded(PlanarRegion),
    /// It may reach as far as one likes in this direction, a unit vector.
    Unbounded {
        /// No normal has a positive product with it.
        direction: Vector2<f64>,
    },
}

/// The part of a prism that is its region: corners at height zero, about their middle.
fn base(prism: BoundedRegion) -> PlanarRegion {
    let low = |corner: &&Vector3<f64>| corner.z < 0.5;
    let mut corners: Vec<Vector2<f64>> =
        prism.surface.corners.iter().filter(low).map(|corner| corner.xy()).collect();
    let middle = corners.iter().sum::<Vector2<f64>>() / corners.len().max(1) as f64;
    corners.sort_by(|a, b| {
        let angle = |p: &Vector2<f64>| (p.y - middle.y).atan2(p.x - middle.x);
        angle(a).total_cmp(&angle(b))
    });
    PlanarRegion { area: prism.volume, corners }
}

fn raised(touch: &PlanarTouch, height: f64) -> SurfaceTouch {
    SurfaceTouch { point: touch.point.push(height), normal: touch.normal.push(0.0) }
}

/// The convex hull of the contacts of a planar body, which it contains.
///
/// # Errors
/// Where a contact cannot be used, or all lie on one line.
pub fn planar_hull(touches: &[PlanarTouch]) -> Result<PlanarRegion, TouchError> {
    let both: Vec<SurfaceTouch> =
        touches.iter().flat_map(|touch| [raised(touch, 0.0), raised(touch, 1.0)]).collect();
    contact_hull(&both).map(base).map_err(|error| counted(error, 2))
}

/// The intersection of the half-planes at the contacts of a planar body, in which it lies.
///
/// # Errors
/// Where a contact cannot be used, or the middle of all contacts lies outside of a half-plane.
pub fn half_plane_intersection(touches: &[PlanarTouch]) -> Result<PlanarOuterBound, TouchError> {
    let count = touches.len().max(1) as f64;
    let middle = touches.iter().map(|touch| touch.point).sum::<Vector2<f64>>() / count;
    let end = |height: f64, up: f64| SurfaceTouch {
        point: middle.push(height),
        normal: Vector3::new(0.0, 0.0, up),
    };
    // at half of the height, so that the middle of all is that of the plane
    let mut all: Vec<SurfaceTouch> = touches.iter().map(|touch| raised(touch, 0.5)).collect();
    if !all.is_empty() {
        all.extend([end(0.0, -1.0), end(1.0, 1.0)]);
    }
    Ok(match half_space_intersection(&all).map_err(|error| counted(error, 1))? {
        OuterBound::Bounded(prism) => PlanarOuterBound::Bounded(base(prism)),
        OuterBound::Unbounded { direction } => {
            PlanarOuterBound::Unbounded { direction: direction.xy().normalize() }
        }
    })
}

/// Places of contacts as they were counted before each was taken so many times.
fn counted(error: TouchError, times: usize) -> TouchError {
    match error {
        TouchError::Value { index } => TouchError::Value { index: index.div_ceil(times) },
        other => other,
    }
}
