//! What a convex body lies in where none of its radii of curvature is larger than a bound: the intersection of balls of that radius; and that of balls of several radii with
//! half-spaces.
//!
//! The region is convex and is described from a point inside. Over a triangle of directions it contains the tetrahedron whose corners are points inside of all
//! balls, and it lies within the cone up to a tangent plane of any of them; both volumes are intervals rounded outward. The triangle with the largest
//! difference is divided until that is small.

use super::bounds::{BoundedRegion, SurfaceTouch, TouchError, check, middle};
use super::mesh::SurfaceMesh;
use nalgebra::Vector3;
use palmistry_math::number::{Function, Interval};
use std::collections::{BinaryHeap, HashMap};

/// The volume is enclosed to this part of itself, where that takes no more than so many triangles.
const WIDTH: f64 = 1e-3;
const MOST: usize = 60_000;

/// The intersection of balls of one radius that touch from outside at the contacts: the body lies in it where no radius of curvature is larger. So it does
/// where spherical palms of this radius, larger than any radius of curvature of the body, touched it with their inside.
///
/// The volume is enclosed to about a thousandth; corners of the surface are points inside of all balls.
///
/// # Errors
/// Where a contact or the radius cannot be used, or the middle of all contacts is not inside of a ball.
pub fn ball_intersection(touches: &[SurfaceTouch], radius: f64) -> Result<BoundedRegion, TouchError> {
    check(touches)?;
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(TouchError::Radius(radius));
    }
    balls_and_half_spaces(touches, &vec![radius; touches.len()])
}

/// The same with a radius for each contact; where that is infinite there is a half-space. The body lies in it where each contact is on the inside of a sphere of that radius
/// that the body does not cross.
///
/// # Errors
/// Where a contact or a radius cannot be used, no radius is finite, or the middle of all contacts is not inside of a ball or a half-space.
///
/// # Panics
/// Where there are not as many radii as contacts.
pub fn balls_and_half_spaces(touches: &[SurfaceTouch], radii: &[f64]) -> Result<BoundedRegion, TouchError> {
    assert_eq!(touches.len(), radii.len(), "a radius for each contact");
    check(touches)?;
    if let Some(radius) = radii.iter().find(|radius| radius.is_nan() || **radius <= 0.0) {
        return Err(TouchError::Radius(*radius));
    }
    if radii.iter().all(|radius| radius.is_infinite()) {
        return Err(TouchError::Radius(f64::INFINITY));
    }
    let inside = middle(touches);
    let mut balls = Vec::with_capacity(touches.len());
    for ((index, touch), radius) in (1..).zip(touches).zip(radii) {
        let (bound, room) = match radius.is_finite() {
            true => Ball::at(touch, *radius, &inside),
            false => Ball::half_space(touch, &inside),
        };
        if room <= 0.0 || room.is_nan() {
            return Err(TouchError::Inconsistent { index, by: -room });
        }
        balls.push(bound);
    }
    let mut seen = Seen { balls, corners: Vec::new(), middles: HashMap::new() };
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let six: Vec<usize> = axes.into_iter().flat_map(|axis| [axis, -axis]).map(|u| seen.corner(u)).collect();
    let mut open = BinaryHeap::new();
    let (mut low, mut high) = (0.0, 0.0);
    for octant in 0..8usize {
        let side = |axis: usize| six[2 * axis + (octant >> axis & 1)];
        let negative = octant.count_ones() % 2 == 1;
        let [a, b, c] = [side(0), side(1), side(2)];
        let piece = seen.piece(if negative { [a, c, b] } else { [a, b, c] });
        (low, high) = (low + piece.low, high + piece.high);
        open.push(piece);
    }
    // how much is open is looked at now and then, for the running sums round
    let settled = |low: f64, high: f64| high - low <= WIDTH * low;
    while open.len() < MOST && !settled(low, high) {
        for _ in 0..64 {
            let Some(piece) = open.pop() else { break };
            let [a, b, c] = piece.corners;
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|edge| seen.middle(edge));
            open.extend(
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|corners| seen.piece(corners)),
            );
        }
        (low, high) = open.iter().fold((0.0, 0.0), |(low, high), piece| (low + piece.low, high + piece.high));
    }
    let pieces = open.into_vec();
    let volume = pieces.iter().fold(Interval::ZERO, |sum, piece| sum + Interval::new(piece.low, piece.high));
    let surface = SurfaceMesh {
        corners: seen.corners.iter().map(|corner| corner.direction * corner.reach + inside).collect(),
        polygons: pieces.iter().map(|piece| seen.polygon(piece.corners)).collect(),
    };
    Ok(BoundedRegion { volume, surface })
}

/// A ball or a half-space, about the point inside.
enum Ball {
    Round {
        centre: Vector3<f64>,
        radius: f64,
    },
    /// `normal . x <= offset`.
    HalfSpace {
        normal: Vector3<f64>,
        offset: f64,
    },
}

fn points(vector: &Vector3<f64>) -> [Interval; 3] {
    <[f64; 3]>::from(*vector).map(Interval::point)
}

fn product(a: &[Interval; 3], b: &[Interval; 3]) -> Interval {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Ball {
    /// That of a radius which touches at a contact, and how far the point inside is from its surface.
    fn at(touch: &SurfaceTouch, radius: f64, inside: &Vector3<f64>) -> (Ball, f64) {
        let centre = touch.point - touch.normal * radius - inside;
        // larger by what rounding moves a centre, and by what a normal is off one
        let off = radius * (1.0 - touch.normal.norm()).abs();
        let rounded = 8.0 * f64::EPSILON * (radius + touch.point.norm() + inside.norm());
        let radius = (radius + off + rounded).next_up();
        (Ball::Round { centre, radius }, radius - centre.norm())
    }

    fn half_space(touch: &SurfaceTouch, inside: &Vector3<f64>) -> (Ball, f64) {
        let from_inside =
            std::array::from_fn(|i| Interval::point(touch.point[i]) - Interval::point(inside[i]));
        let reach = product(&points(&touch.normal), &from_inside);
        (Ball::HalfSpace { normal: touch.normal, offset: reach.high() }, reach.low())
    }

    /// How far one comes in a direction.
    fn exit(&self, direction: &Vector3<f64>) -> f64 {
        match self {
            Ball::Round { centre, radius } => {
                let along = centre.dot(direction) / direction.norm_squared();
                let room = (radius * radius - centre.norm_squared()) / direction.norm_squared();
                along + (along * along + room).max(0.0).sqrt()
            }
            Ball::HalfSpace { normal, offset } => match normal.dot(direction) {
                along if along > 0.0 => offset / along,
                _ => f64::INFINITY,
            },
        }
    }

    /// Whether a place is inside for certain.
    fn contains(&self, place: &Vector3<f64>) -> bool {
        match self {
            Ball::Round { centre, radius } => {
                let square = (0..3).fold(Interval::ZERO, |sum, i| {
                    sum + (Interval::point(place[i]) - Interval::point(centre[i])).sqr()
                });
                square.high() <= Interval::point(*radius).sqr().low()
            }
            Ball::HalfSpace { normal, offset } => product(&points(normal), &points(place)).high() <= *offset,
        }
    }

    /// The tangent plane at a place near its surface: a normal, not of length one, and how far along it the plane is, no nearer than it is.
    fn tangent(&self, place: &Vector3<f64>) -> Option<([Interval; 3], Interval)> {
        match self {
            Ball::Round { centre, radius } => {
                let normal = points(&(place - centre));
                let long = (normal[0].sqr() + normal[1].sqr() + normal[2].sqr()).image(Function::Sqrt)?;
                Some((normal, Interval::point(*radius) * long + product(&normal, &points(centre))))
            }
            Ball::HalfSpace { normal, offset } => Some((points(normal), Interval::point(*offset))),
        }
    }
}

struct Corner {
    direction: Vector3<f64>,
    /// The place in this direction, so many times as long, is inside of all balls.
    reach: f64,
}

/// A triangle of directions with its share of the volume.
struct Piece {
    corners: [usize; 3],
    low: f64,
    high: f64,
}

impl Piece {
    fn gap(&self) -> f64 {
        self.high - self.low
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Piece {}
impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.gap().total_cmp(&other.gap()).then_with(|| self.corners.cmp(&other.corners))
    }
}

struct Seen {
    balls: Vec<Ball>,
    corners: Vec<Corner>,
    middles: HashMap<[usize; 2], usize>,
}

impl Seen {
    fn corner(&mut self, direction: Vector3<f64>) -> usize {
        let mut reach = self.balls.iter().map(|ball| ball.exit(&direction)).fold(f64::INFINITY, f64::min);
        let inside = |reach: f64| {
            let place = direction * reach;
            self.balls.iter().all(|ball| ball.contains(&place))
        };
        for shrink in [1e-15, 1e-14, 1e-12, 1e-9, 1e-6, 1e-3] {
            if inside(reach) {
                break;
            }
            reach *= 1.0 - shrink;
        }
        // the point about which the region is described is inside
        let reach = if inside(reach) { reach } else { 0.0 };
        self.corners.push(Corner { direction, reach });
        self.corners.len() - 1
    }

    fn middle(&mut self, [a, b]: [usize; 2]) -> usize {
        let key = [a.min(b), a.max(b)];
        if let Some(known) = self.middles.get(&key) {
            return *known;
        }
        let direction = (self.corners[a].direction + self.corners[b].direction).normalize();
        let corner = self.corner(direction);
        self.middles.insert(key, corner);
        corner
    }

    /// A triangle with the corners that smaller ones beside it have on its edges, so that the surface is closed.
    fn polygon(&self, [a, b, c]: [usize; 3]) -> Vec<usize> {
        let mut polygon = Vec::new();
        let mut open = vec![[c, a], [b, c], [a, b]];
        while let Some([from, to]) = open.pop() {
            match self.middles.get(&[from.min(to), from.max(to)]) {
                Some(&middle) => open.extend([[middle, to], [from, middle]]),
                None => polygon.push(from),
            }
        }
        polygon
    }

    fn piece(&self, corners: [usize; 3]) -> Piece {
        let at = corners.map(|place| &self.corners[place]);
        let enclosed = at.map(|corner| <[f64; 3]>::from(corner.direction).map(Interval::point));
        let [u, v, w] = enclosed;
        let cone = (u[0] * (v[1] * w[2] - v[2] * w[1])
            + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0]))
            / Interval::point(6.0);
        let cone = Interval::new(cone.low().max(0.0), cone.high().max(0.0));
        // places are rounded once more than reaches: they were looked at as places
        let place = |i: usize| Interval::point(at[i].reach) * Interval::new(1.0 - 4e-16, 1.0);
        let within = cone * place(0) * place(1) * place(2);

        let middle = at.iter().map(|corner| corner.direction).sum::<Vector3<f64>>();
        let nearest =
            self.balls.iter().map(|ball| (ball.exit(&middle), ball)).min_by(|a, b| a.0.total_cmp(&b.0));
        let high = nearest.map_or(f64::INFINITY, |(exit, ball)| {
            let Some((normal, offset)) = ball.tangent(&(middle * exit)) else { return f64::INFINITY };
            let mut over = cone;
            for direction in &enclosed {
                let along = product(&normal, direction);
                if along.low() <= 0.0 || offset.low() <= 0.0 {
                    return f64::INFINITY;
                }
                over *= offset / along;
            }
            over.high()
        });
        Piece { corners, low: within.low().max(0.0), high }
    }
}
