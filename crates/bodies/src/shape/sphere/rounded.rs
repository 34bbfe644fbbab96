//! What a convex body contains where its radii of curvature have a least one: a hull of balls.

use super::bounds::{
    BoundedRegion, SurfaceTouch, TouchError, UNIT, check, exact_volume, hull_of_places, surface_of,
};
use super::mesh::SurfaceMesh;
use super::vector::{Enclosed, cross, dot, length, minus};
use nalgebra::Vector3;
use palmistry_math::number::{Function, Interval, RealNumber};
use std::collections::BTreeMap;

/// What the body contains where none of its radii of curvature is less than `least`: the hull of the balls of that radius that touch at the contacts. Its volume is
/// that of the hull of the centres, with area times radius, edges' lengths times outer angles times half of the radius' square, and a ball (J. Steiner, 1840).
/// The surface that is given is that of the hull of the centres.
///
/// # Errors
/// Where a contact or the radius cannot be used.
pub fn rounded_hull(touches: &[SurfaceTouch], least: f64) -> Result<BoundedRegion, TouchError> {
    check(touches)?;
    if !(least > 0.0 && least.is_finite()) {
        return Err(TouchError::Radius(least));
    }
    let centres: Vec<Vector3<f64>> = touches.iter().map(|t| t.point - t.normal * least).collect();
    let farthest = touches.iter().map(|t| t.point.amax()).fold(0.0, f64::max);
    // less by what rounding moves a centre, and by what normals are off one
    let radius = least * (1.0 - 2.0 * UNIT) - 4.0 * f64::EPSILON * (farthest + least);
    let r = Interval::point(radius.max(0.0));
    let ball = Interval::point(4.0) / Interval::point(3.0) * Interval::PI * r.pow(3);
    let Some(hull) = hull_of_places(&centres)? else {
        return Ok(BoundedRegion {
            volume: Interval::new(ball.low(), f64::INFINITY),
            surface: SurfaceMesh::default(),
        });
    };
    let normals: Vec<[Interval; 3]> = hull
        .facets
        .iter()
        .map(|facet| {
            let [a, b, c] =
                facet.map(|place| centres[place].into()).map(|p: [f64; 3]| p.map(Interval::point));
            cross(&minus(&b, &a), &minus(&c, &a))
        })
        .collect();
    let half = Interval::point(0.5);
    let area = normals.iter().fold(Interval::ZERO, |sum, n| sum + length(n) * half);
    // in an order that is the same in every run: sums of intervals depend on it
    let owner: BTreeMap<(usize, usize), usize> = hull
        .facets
        .iter()
        .enumerate()
        .flat_map(|(k, [a, b, c])| [((*a, *b), k), ((*b, *c), k), ((*c, *a), k)])
        .collect();
    let edges =
        owner.iter().filter(|((from, to), _)| from < to).fold(Interval::ZERO, |sum, ((from, to), k)| {
            let Some(other) = owner.get(&(*to, *from)) else { return sum };
            let [a, b] =
                [from, to].map(|place| centres[*place].into()).map(|p: [f64; 3]| p.map(Interval::point));
            sum + length(&minus(&b, &a)) * outer_angle(&normals[*k], &normals[*other])
        });
    let own = Interval::from_rational(&exact_volume(&centres, &hull));
    let volume = own + r * area + r.sqr() * half * edges + ball;
    Ok(BoundedRegion { volume, surface: surface_of(&centres, &hull) })
}

/// The angle between two vectors.
fn outer_angle(a: &Enclosed, b: &Enclosed) -> Interval {
    let (along, across) = (dot(a, b), length(&cross(a, b)));
    let angle = |of: Interval| of.image(Function::Atan).unwrap_or(Interval::WHOLE);
    let right = Interval::PI * Interval::point(0.5);
    if along.low() > 0.0 {
        angle(across / along)
    } else if across.low() > 0.0 {
        right - angle(along / across)
    } else {
        Interval::new(0.0, Interval::PI.high())
    }
}
