//! What a convex body cannot be smaller and cannot be larger than, once it has been touched.
//!
//! The body contains each contact, so that it contains their convex hull. At each contact it lies on one side of the tangent plane, so that it lies
//! in the intersection of these half-spaces. In coordinates about a point inside, the half-space `n . x <= w` is the point `n/w`; the intersection is bounded where the hull of these points has
//! the origin inside, its corners are then the hull's facets and its faces the hull's corners. All `w > 0` is not enough for that: the normals have to span all directions with positive factors. Where they do
//! not there is a direction in which a body may be as long as one likes, and it is reported.
//!
//! Where every radius of curvature is known to be at least `a`, a ball of that radius rolls inside of the body, and balls that touch at the contacts take the place of points. Where none is larger than `b`,
//! the body rolls inside a ball of the radius `b`, and balls take the place of half-spaces (W. Blaschke, Kreis und Kugel, 1916, section 24): also where the body was touched by the inside of
//! spherical palms with a larger radius than any of its own.
//!
//! Contacts and normals are taken as they are given: of these numbers the bounds are certain. Their errors are a matter for the caller.

use super::hull::{Flat, Hull};
use super::mesh::SurfaceMesh;
use super::side::{Point, side, whole};
use super::vector::{Enclosed, cross, dot};
use dashu::integer::IBig;
use dashu::rational::RBig;
use nalgebra::Vector3;
use palmistry_math::number::{Interval, RealNumber, rational_from_f64};
use std::cmp::Ordering;
use std::collections::HashMap;

/// A contact in the body's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceTouch {
    /// Where, in metres.
    pub point: Vector3<f64>,
    /// The body's outward normal there, a unit vector but for rounding.
    pub normal: Vector3<f64>,
}

/// A convex region with what is known of its volume in m^3.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedRegion {
    /// An enclosure of its volume, rounded outward.
    pub volume: Interval,
    /// Its surface; corners are rounded. Of balls, where these are its corners, without them.
    pub surface: SurfaceMesh,
}

/// What a body lies in.
#[derive(Clone, Debug, PartialEq)]
pub enum OuterBound {
    /// A bounded region.
    Bounded(BoundedRegion),
    /// The tangent planes do not bound it: it may reach as far as one likes in this direction, a unit vector in the body's frame.
    Unbounded {
        /// No normal has a positive product with it; that was decided before it was rounded.
        direction: Vector3<f64>,
    },
}

/// Why there is no bound.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TouchError {
    /// There is nothing to bound.
    #[error("there are no contacts")]
    Nothing,
    /// A number that cannot be used.
    #[error(
        "contact {index} (counted from 1) has a coordinate that is no finite number, or a normal that is no unit vector"
    )]
    Value {
        /// Which one.
        index: usize,
    },
    /// Contacts that lie in one plane.
    #[error("the contacts lie in one plane, so that their hull has no volume")]
    Flat,
    /// They are not those of one convex body.
    #[error(
        "contact {index} (counted from 1) has the middle of all contacts {by:.3e} m outside of its tangent plane: these are not contacts of \
         one convex body in one frame"
    )]
    Inconsistent {
        /// Which one.
        index: usize,
        /// How far, in m.
        by: f64,
    },
    /// A radius that cannot be used.
    #[error("a bound of the radii of curvature is {0}; it has to be positive and finite")]
    Radius(f64),
    /// The hull failed its own check, which would be a mistake of this program.
    #[error("the hull that was found is not that of the contacts; please report this with the contacts")]
    Unproved,
}

/// How far from one a normal's length may be.
pub(super) const UNIT: f64 = 1e-9;

pub(super) fn check(touches: &[SurfaceTouch]) -> Result<(), TouchError> {
    for (index, touch) in (1..).zip(touches) {
        let finite = touch.point.iter().all(|value| value.is_finite() && value.abs() < 1e60);
        let unit = (touch.normal.norm() - 1.0).abs() <= UNIT;
        if !(finite && unit) {
            return Err(TouchError::Value { index });
        }
    }
    if touches.is_empty() { Err(TouchError::Nothing) } else { Ok(()) }
}

/// The middle of all contacts.
pub(super) fn middle(touches: &[SurfaceTouch]) -> Vector3<f64> {
    touches.iter().map(|touch| touch.point).sum::<Vector3<f64>>() / touches.len() as f64
}

fn proved(points: &[Point]) -> Result<Result<Hull, Flat>, TouchError> {
    match Hull::of(points) {
        Ok(hull) if hull.is_proved(points) => Ok(Ok(hull)),
        Ok(_) => Err(TouchError::Unproved),
        Err(flat) => Ok(Err(flat)),
    }
}

/// What the body contains: the convex hull of the contacts. Its volume is made of rationals, and rounded once.
///
/// # Errors
/// Where a contact cannot be used, or all lie in one plane.
///
/// ```
/// use nalgebra::Vector3;
/// use palmistry_bodies::shape::sphere::{SurfaceTouch, contact_hull};
/// // an octahedron: six points of the unit sphere
/// let at = |normal: Vector3<f64>| SurfaceTouch { point: normal, normal };
/// let touches: Vec<SurfaceTouch> =
///     [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().flat_map(|n| [at(n), at(-n)]).collect();
/// let volume = contact_hull(&touches)?.volume;
/// assert!(volume.contains(4.0 / 3.0) && volume.width() < 1e-15);
/// # Ok::<(), palmistry_bodies::shape::sphere::TouchError>(())
/// ```
pub fn contact_hull(touches: &[SurfaceTouch]) -> Result<BoundedRegion, TouchError> {
    check(touches)?;
    let places: Vec<Vector3<f64>> = touches.iter().map(|touch| touch.point).collect();
    let hull = hull_of_places(&places)?.ok_or(TouchError::Flat)?;
    let volume = Interval::from_rational(&exact_volume(&places, &hull));
    Ok(BoundedRegion { volume, surface: surface_of(&places, &hull) })
}

pub(super) fn hull_of_places(places: &[Vector3<f64>]) -> Result<Option<Hull>, TouchError> {
    let points: Vec<Point> = places.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect();
    Ok(proved(&points)?.ok())
}

pub(super) fn exact_volume(places: &[Vector3<f64>], hull: &Hull) -> RBig {
    let exact = |place: usize| -> [RBig; 3] {
        let place: [f64; 3] = places[place].into();
        // finite: they were looked at
        place.map(|value| rational_from_f64(value).unwrap_or(RBig::ZERO))
    };
    let six = hull.facets.iter().fold(RBig::ZERO, |sum, facet| {
        let [a, b, c] = facet.map(exact);
        let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
        sum + &a[0] * minor(1, 2) + &a[1] * minor(2, 0) + &a[2] * minor(0, 1)
    });
    six / RBig::from(6)
}

pub(super) fn surface_of(places: &[Vector3<f64>], hull: &Hull) -> SurfaceMesh {
    let mut used: HashMap<usize, usize> = HashMap::new();
    let mut mesh = SurfaceMesh::default();
    for facet in &hull.facets {
        let polygon = facet.map(|place| {
            *used.entry(place).or_insert_with(|| {
                mesh.corners.push(places[place]);
                mesh.corners.len() - 1
            })
        });
        mesh.polygons.push(polygon.to_vec());
    }
    mesh
}

/// What the body lies in: the intersection of the half-spaces at its contacts, each no smaller than it is given.
///
/// # Errors
/// Where a contact cannot be used, or the middle of all contacts lies outside of a half-space.
pub fn half_space_intersection(touches: &[SurfaceTouch]) -> Result<OuterBound, TouchError> {
    check(touches)?;
    let (inside, points) = about_inside(touches)?;
    let hull = match proved(&points)? {
        Ok(hull) => hull,
        Err(flat) => {
            let plane = plane_through(flat.rows.each_ref());
            // the origin is not beyond it: then nothing is
            let turn = plane[3] < IBig::ZERO;
            return Ok(OuterBound::Unbounded { direction: direction(&plane, turn) });
        }
    };
    let origin = [0.0, 0.0, 0.0, 1.0];
    let mut corners: Vec<Enclosed> = Vec::with_capacity(hull.facets.len());
    for facet in &hull.facets {
        let rows = facet.map(|place| &points[place]);
        let plane = plane_through(rows);
        if side([&origin, rows[0], rows[1], rows[2]]) != Ordering::Less {
            return Ok(OuterBound::Unbounded { direction: direction(&plane, false) });
        }
        let [x, y, z, w] = plane;
        let w = RBig::from(-w);
        corners.push([x, y, z].map(|value| Interval::from_rational(&(RBig::from(value) / &w))));
    }
    let ahead: HashMap<(usize, usize), usize> = hull
        .facets
        .iter()
        .enumerate()
        .flat_map(|(k, [a, b, c])| [((*a, *b), k), ((*b, *c), k), ((*c, *a), k)])
        .collect();
    let mut mesh = SurfaceMesh::default();
    let mut places: HashMap<[u64; 3], usize> = HashMap::new();
    let mut six = Interval::ZERO;
    let mut done: Vec<bool> = vec![false; points.len()];
    for (first, facet) in hull.facets.iter().enumerate() {
        for corner in *facet {
            if std::mem::replace(&mut done[corner], true) {
                continue;
            }
            let around = facets_around(&hull, &ahead, corner, first);
            let apex = &corners[around[0]];
            for pair in around[1..].windows(2) {
                six += dot(apex, &cross(&corners[pair[0]], &corners[pair[1]]));
            }
            let mut polygon: Vec<usize> = Vec::new();
            for facet in around {
                let place = Vector3::from(corners[facet].map(Interval::mid)) + inside;
                let key: [u64; 3] = [place.x, place.y, place.z].map(f64::to_bits);
                let next = *places.entry(key).or_insert_with(|| {
                    mesh.corners.push(place);
                    mesh.corners.len() - 1
                });
                if polygon.last() != Some(&next) && polygon.first() != Some(&next) {
                    polygon.push(next);
                }
            }
            if polygon.len() > 2 {
                mesh.polygons.push(polygon);
            }
        }
    }
    Ok(OuterBound::Bounded(BoundedRegion { volume: six / Interval::point(6.0), surface: mesh }))
}

/// A point inside of all half-spaces, and these as homogeneous points about it. It is the middle of all contacts; where that lies on a tangent plane, as with few contacts, a point under
/// them.
fn about_inside(touches: &[SurfaceTouch]) -> Result<(Vector3<f64>, Vec<Point>), TouchError> {
    let own = middle(touches);
    let outward = touches.iter().map(|touch| touch.normal).sum::<Vector3<f64>>() / touches.len() as f64;
    let size = touches.iter().map(|touch| (touch.point - own).norm()).fold(0.0, f64::max);
    let under = own - outward * if size > 0.0 { size } else { 1.0 };
    half_spaces(touches, &own).map(|points| (own, points)).or_else(|error| {
        // the error about the middle is reported where the point below fails too
        half_spaces(touches, &under).map(|points| (under, points)).map_err(|_| error)
    })
}

fn half_spaces(touches: &[SurfaceTouch], inside: &Vector3<f64>) -> Result<Vec<Point>, TouchError> {
    let half_space = |(index, touch): (usize, &SurfaceTouch)| {
        let n: [f64; 3] = touch.normal.into();
        let from_inside: Enclosed =
            std::array::from_fn(|i| Interval::point(touch.point[i]) - Interval::point(inside[i]));
        let reach = dot(&n.map(Interval::point), &from_inside);
        let [x, y, z] = n;
        match reach.low() > 0.0 {
            true => Ok([x, y, z, reach.high()]),
            false => Err(TouchError::Inconsistent { index, by: -reach.low() }),
        }
    };
    (1..).zip(touches).map(half_space).collect()
}

/// The facets around a corner, counterclockwise.
fn facets_around(
    hull: &Hull,
    ahead: &HashMap<(usize, usize), usize>,
    corner: usize,
    first: usize,
) -> Vec<usize> {
    let mut around = vec![first];
    let mut here = first;
    while around.len() <= hull.facets.len() {
        let [a, b, c] = hull.facets[here];
        let before = if corner == a {
            c
        } else if corner == b {
            a
        } else {
            b
        };
        match ahead.get(&(corner, before)) {
            Some(&next) if next != first => {
                around.push(next);
                here = next;
            }
            _ => break,
        }
    }
    around
}

/// The plane through three points: what the coordinates of another one have to be multiplied by so that the sum is the determinant with it before them.
fn plane_through(rows: [&Point; 3]) -> [IBig; 4] {
    let rows = rows.map(whole);
    let minor = |[i, j, k]: [usize; 3]| -> IBig {
        let [a, b, c] = &rows;
        &a[i] * (&b[j] * &c[k] - &b[k] * &c[j]) - &a[j] * (&b[i] * &c[k] - &b[k] * &c[i])
            + &a[k] * (&b[i] * &c[j] - &b[j] * &c[i])
    };
    [minor([1, 2, 3]), -minor([0, 2, 3]), minor([0, 1, 3]), -minor([0, 1, 2])]
}

/// The direction of a plane's normal, turned round where that is asked.
fn direction(plane: &[IBig; 4], turned: bool) -> Vector3<f64> {
    let size = |value: &IBig| if *value < IBig::ZERO { -value } else { value.clone() };
    let largest = plane[..3].iter().map(size).max().unwrap_or(IBig::ONE);
    let sign = if turned { -1.0 } else { 1.0 };
    let part = |value: &IBig| {
        let part = RBig::from(value.clone()) / RBig::from(largest.clone().max(IBig::ONE));
        sign * palmistry_math::number::rational_to_f64(&part)
    };
    Vector3::new(part(&plane[0]), part(&plane[1]), part(&plane[2])).normalize()
}
