//! The surfaces of a body in space that was touched: for the page, and for other programs.

use super::space::SpaceObserved;
use nalgebra::Vector3;
use palmistry_bodies::shape::sphere::{BoundedRegion, OuterBound, SurfaceMesh, TouchError};
use palmistry_scenes::space::directions;

/// What a surface is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceKind {
    /// The body itself, of a scene that describes it.
    Body,
    /// The support function that was recovered.
    Shape,
    /// The hull of all contacts.
    Hull,
    /// The intersection of the half-spaces of all tangent planes.
    HalfSpaces,
    /// The intersection of balls where the greatest radius of curvature is known.
    Balls,
    /// The intersection of the balls of hollow palms, and of half-spaces at the other contacts.
    HollowPalms,
}

impl SurfaceKind {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            SurfaceKind::Body => "the body",
            SurfaceKind::Shape => "the recovered support function",
            SurfaceKind::Hull => "hull of the contacts",
            SurfaceKind::HalfSpaces => "half-spaces",
            SurfaceKind::Balls => "balls of the greatest radius of curvature",
            SurfaceKind::HollowPalms => "balls of the hollow palms",
        }
    }

    /// The name of its file, without the extension.
    pub fn file(self) -> &'static str {
        match self {
            SurfaceKind::Body => "body",
            SurfaceKind::Shape => "shape",
            SurfaceKind::Hull => "hull",
            SurfaceKind::HalfSpaces => "half_spaces",
            SurfaceKind::Balls => "balls",
            SurfaceKind::HollowPalms => "hollow_palms",
        }
    }
}

/// A surface in the frame of the body: the world's at the first sample, about the centre of mass, in m.
#[derive(Clone, Debug)]
pub struct SpaceSurface {
    /// What it is of.
    pub kind: SurfaceKind,
    /// Corners and polygons.
    pub surface: SurfaceMesh,
}

/// A smooth surface by its points at directions: so many rings of four-sided faces between two caps.
fn smooth(rings: usize, point: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> SurfaceMesh {
    let around = 2 * rings;
    let corners = directions(rings).iter().flatten().map(point).collect();
    let mut polygons: Vec<Vec<usize>> = vec![(0..around).collect()];
    for ring in 1..rings {
        for k in 0..around {
            let (above, below) = ((ring - 1) * around, ring * around);
            let next = (k + 1) % around;
            polygons.push(vec![above + k, below + k, below + next, above + next]);
        }
    }
    polygons.push(((rings - 1) * around..rings * around).rev().collect());
    SurfaceMesh { corners, polygons }
}

/// All that there are, smooth ones with so many rings of points. Where the body was not touched the support function is undetermined, and so is its surface.
pub fn space_surfaces(observed: &SpaceObserved<'_>, rings: usize) -> Vec<SpaceSurface> {
    let (experiment, Some(shape)) = (observed.experiment, &observed.answers.shape) else { return Vec::new() };
    let truth = experiment.truth.as_ref().map(|_| {
        smooth(rings, |normal| experiment.true_support(normal).map_or(Vector3::zeros(), |(_, point)| point))
    });
    let found =
        shape.estimate.as_ref().map(|found| smooth(rings, |normal| found.support.point_and_bend(normal).0));
    let region =
        |of: &Result<BoundedRegion, TouchError>| of.as_ref().ok().map(|region| region.surface.clone());
    let planes = match &shape.outer {
        Ok(OuterBound::Bounded(region)) => Some(region.surface.clone()),
        _ => None,
    };
    let all = [
        (SurfaceKind::Body, truth),
        (SurfaceKind::Shape, found),
        (SurfaceKind::Hull, region(&shape.hull)),
        (SurfaceKind::HalfSpaces, planes),
        (SurfaceKind::Balls, shape.balls.as_ref().and_then(region)),
        (SurfaceKind::HollowPalms, shape.hollow.as_ref().and_then(region)),
    ];
    all.into_iter()
        .filter_map(|(kind, surface)| Some(SpaceSurface { kind, surface: surface? }))
        .filter(|one| !one.surface.polygons.is_empty())
        .collect()
}
