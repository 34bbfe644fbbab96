//! The support function of a body on an interval of normals, enclosed: every operation is rounded outward.
//!
//! The body is the one that its numbers say exactly: harmonics and semi-axes as the doubles that they are, a spline through points whose directions are thirds
//! of a turn and not doubles near them. The centre of mass is known to [`CENTRE`] of the mean radius: what is shown holds for
//! each place in that square, the true centroid among them.

use super::body::PoseBody;
use crate::mechanics::moving::{BodyForm, Knots};
use palmistry_math::number::{Function, Interval};
use std::f64::consts::TAU;

/// Half the side of the square in which the centre of mass may lie, in mean radii.
pub(super) const CENTRE: f64 = 1e-9;

type Vector = [Interval; 2];

enum Outline {
    Harmonics(Vec<[f64; 2]>),
    Ellipse([Interval; 2]),
    Spline(Box<[[Vector; 4]; 3]>),
}

/// A support function that takes intervals.
pub(super) struct EnclosedBody {
    outline: Outline,
    centre: Vector,
}

fn number(value: f64) -> Interval {
    Interval::point(value)
}

fn root(value: Interval) -> Interval {
    // a square may reach below zero by overestimation, its root does not
    let inside = value.intersection(Interval::new(0.0, f64::INFINITY)).unwrap_or(Interval::ZERO);
    inside.image(Function::Sqrt).unwrap_or(Interval::new(0.0, f64::INFINITY))
}

fn dot(a: Vector, b: Vector) -> Interval {
    a[0] * b[0] + a[1] * b[1]
}

fn along(a: Vector, factor: Interval, b: Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

/// The solution of three equations by Cramer's rule.
fn solved(rows: [[Interval; 3]; 3], right: [Interval; 3]) -> [Interval; 3] {
    let determinant = |m: [[Interval; 3]; 3]| {
        let minor = |j: usize, k: usize| m[1][j] * m[2][k] - m[1][k] * m[2][j];
        m[0][0] * minor(1, 2) + m[0][1] * minor(2, 0) + m[0][2] * minor(0, 1)
    };
    let whole = determinant(rows);
    std::array::from_fn(|j| {
        let mut replaced = rows;
        (0..3).for_each(|i| replaced[i][j] = right[i]);
        determinant(replaced) / whole
    })
}

/// The closed cubic spline through three points at thirds of a turn: coefficients of the powers of each piece's parameter.
fn spline(radii: [f64; 3], knots: Knots) -> [[Vector; 4]; 3] {
    let half = root(number(3.0)) * number(0.5);
    let directions = [[Interval::ONE, Interval::ZERO], [number(-0.5), half], [number(-0.5), -half]];
    let points: [Vector; 3] = std::array::from_fn(|i| directions[i].map(|x| x * number(radii[i])));
    let chords: [Vector; 3] = std::array::from_fn(|i| along(points[(i + 1) % 3], number(-1.0), points[i]));
    let steps = chords.map(|[x, y]| match knots {
        Knots::Uniform => Interval::ONE,
        Knots::Centripetal => root(root(x.sqr() + y.sqr())),
        Knots::Chord => root(x.sqr() + y.sqr()),
    });
    let before = |i: usize| (i + 2) % 3;
    // second derivatives at the points: the first ones are continuous
    let rows = std::array::from_fn(|i| {
        let mut row = [Interval::ZERO; 3];
        row[before(i)] = steps[before(i)];
        row[i] = number(2.0) * (steps[before(i)] + steps[i]);
        row[(i + 1) % 3] = steps[i];
        row
    });
    let bends = [0, 1].map(|axis: usize| {
        let slope = |i: usize| chords[i][axis] / steps[i];
        solved(rows, std::array::from_fn(|i| number(6.0) * (slope(i) - slope(before(i)))))
    });
    std::array::from_fn(|i| {
        let square = steps[i].sqr() / number(6.0);
        let [begin, end] = [i, (i + 1) % 3].map(|k| [bends[0][k] * square, bends[1][k] * square]);
        let first = along(along(chords[i], number(-2.0), begin), number(-1.0), end);
        [points[i], first, begin.map(|x| number(3.0) * x), along(end, number(-1.0), begin)]
    })
}

impl EnclosedBody {
    /// `None` for a superellipse, whose support function is not enclosed here.
    pub fn new(body: &PoseBody) -> Option<EnclosedBody> {
        let outline = match body.form() {
            BodyForm::Harmonics { harmonics, .. } => Outline::Harmonics(harmonics.clone()),
            BodyForm::Ellipse { semi_axes } => Outline::Ellipse(semi_axes.map(number)),
            BodyForm::Spline { radii, knots } => Outline::Spline(Box::new(spline(*radii, *knots))),
            BodyForm::Superellipse { .. } | BodyForm::Arcs { .. } => return None,
        };
        let room = CENTRE * body.mean_radius();
        let centre = body.centre().map(|x| Interval::new(x - room, x + room));
        Some(EnclosedBody { outline, centre })
    }

    /// `[r', r'']` at all normals of an interval.
    pub fn slopes(&self, angle: Interval) -> [Interval; 2] {
        let (sine, cosine) = angle.sin_cos();
        let (along, outward) = ([-sine, cosine], [cosine, sine]);
        let [slope, second] = match &self.outline {
            Outline::Harmonics(pairs) => harmonics(pairs, angle),
            Outline::Ellipse(axes) => ellipse(*axes, [sine, cosine]),
            Outline::Spline(pieces) => outline_slopes(pieces, outward, along),
        };
        [slope - dot(self.centre, along), second + dot(self.centre, outward)]
    }
}

fn harmonics(pairs: &[[f64; 2]], angle: Interval) -> [Interval; 2] {
    let mut total = [Interval::ZERO; 2];
    for (k, [p, q]) in (1..).zip(pairs) {
        if *p == 0.0 && *q == 0.0 {
            continue;
        }
        let k = number(f64::from(k));
        let (sine, cosine) = (k * angle).sin_cos();
        total[0] += k * (number(*q) * cosine - number(*p) * sine);
        total[1] += -(k * k) * (number(*p) * cosine + number(*q) * sine);
    }
    total
}

/// `r = sqrt(a^2 cos^2 + b^2 sin^2)`: `r r' = (b^2 - a^2) sin cos`, `r + r'' = a^2 b^2/r^3`.
fn ellipse([a, b]: [Interval; 2], [sine, cosine]: [Interval; 2]) -> [Interval; 2] {
    let r = root((a * cosine).sqr() + (b * sine).sqr());
    let slope = (b.sqr() - a.sqr()) * sine * cosine / r;
    [slope, (a * b).sqr() / r.pow(3) - r]
}

/// Pieces of a spline's parameter are looked at one by one down to this.
const FINEST: f64 = 1.0 / 1024.0;

/// On each piece the outline is farthest where `x' · u = 0` and `x'' · u < 0`; on a convex outline one piece has that place.
fn outline_slopes(pieces: &[[Vector; 4]; 3], outward: Vector, sideways: Vector) -> [Interval; 2] {
    let mut found: Option<[Interval; 2]> = None;
    for [c0, c1, c2, c3] in pieces {
        let doubled = c2.map(|x| number(2.0) * x);
        let mut open = vec![Interval::new(0.0, 1.0)];
        while let Some(t) = open.pop() {
            let rate = along(*c1, t, along(doubled, number(3.0) * t, *c3));
            let bend = along(doubled, number(6.0) * t, *c3);
            // at the place that is farthest the first is zero, and the second is not positive
            if !dot(rate, outward).contains_zero() || dot(bend, outward).low() > 0.0 {
                continue;
            }
            if t.width() > FINEST {
                let (low, high) = t.split();
                open.extend([low, high]);
                continue;
            }
            let at = along(*c0, t, along(*c1, t, along(*c2, t, *c3)));
            let length = root(rate[0].sqr() + rate[1].sqr());
            let turning = rate[0] * bend[1] - rate[1] * bend[0];
            let radius = length.pow(3) / turning;
            let next = [dot(at, sideways), radius - dot(at, outward)];
            found = Some(match found {
                None => next,
                Some(all) => [0, 1].map(|i| all[i].hull(next[i])),
            });
        }
    }
    found.unwrap_or([Interval::WHOLE; 2])
}

/// Cells of a turn in an [`EnclosedTable`].
const CELLS: usize = 1 << 13;

/// Cells are taken wider by this part on either side, and one more is asked for where an end is so near to an edge: far more than what an angle is rounded by.
const EDGE: f64 = 1e-6;

/// `r'` and `r''` on small cells of the turn once and for all: on an interval of normals they lie in the hull of its cells.
pub(super) struct EnclosedTable {
    /// The hull of `2^level` cells from each one on, by levels.
    levels: Vec<Vec<[Interval; 2]>>,
}

impl EnclosedTable {
    /// `None` where the body is not enclosed.
    pub fn new(body: &PoseBody) -> Option<EnclosedTable> {
        let enclosed = EnclosedBody::new(body)?;
        let edge = |place: f64| place * (TAU / CELLS as f64);
        let cell = |k: usize| {
            let k = k as f64;
            enclosed.slopes(Interval::new(edge(k - EDGE), edge(k + 1.0 + EDGE)))
        };
        let mut levels: Vec<Vec<[Interval; 2]>> = vec![(0..CELLS).map(cell).collect()];
        while 1 << levels.len() <= CELLS {
            let last = &levels[levels.len() - 1];
            let half = 1 << (levels.len() - 1);
            let both = |k: usize| {
                let (one, other) = (last[k], last[(k + half) % CELLS]);
                [0, 1].map(|i| one[i].hull(other[i]))
            };
            levels.push((0..CELLS).map(both).collect());
        }
        Some(EnclosedTable { levels })
    }

    /// `[r', r'']` at all normals of an interval within some turns of zero.
    pub fn slopes(&self, angle: Interval) -> [Interval; 2] {
        let place = |angle: f64| angle * (CELLS as f64 / TAU);
        let (first, last) = ((place(angle.low()) - EDGE).floor(), (place(angle.high()) + EDGE).floor());
        if !(first.abs() < 1e6 && last - first < CELLS as f64 - 1.0) {
            return self.levels[self.levels.len() - 1][0];
        }
        let count = (last - first) as usize + 1;
        let level = count.ilog2() as usize;
        let at = |k: f64| self.levels[level][k.rem_euclid(CELLS as f64) as usize];
        let (one, other) = (at(first), at(last + 1.0 - (1_u64 << level) as f64));
        [0, 1].map(|i| one[i].hull(other[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_surface::families::BodyFamily;

    /// The values in doubles, at points of intervals of all sizes, lie in the enclosures, which are as wide as the intervals and no more than some
    /// times; at a point they are narrow.
    #[test]
    fn enclosures_hold_the_values() {
        for family in BodyFamily::ALL {
            for number in 0..4 {
                let body = family.draw(3, number);
                let enclosed = EnclosedBody::new(&body).expect("enclosed");
                let table = EnclosedTable::new(&body).expect("enclosed");
                for i in -300..300_i32 {
                    let low = 0.021 * f64::from(i);
                    let width = [0.0, 1e-3, 0.05][i.unsigned_abs() as usize % 3];
                    let found = enclosed.slopes(Interval::new(low, low + width));
                    let listed = table.slopes(Interval::new(low, low + width));
                    for part in [0.0, 0.3, 1.0] {
                        let [_, slope, second] = body.support(low + part * width);
                        let room = 1e-12 * body.mean_radius();
                        for (value, held) in
                            [(slope, found[0]), (second, found[1]), (slope, listed[0]), (second, listed[1])]
                        {
                            assert!(
                                held.low() - room <= value && value <= held.high() + room,
                                "{} {value} {held}",
                                body.text()
                            );
                        }
                    }
                    if width == 0.0 {
                        // a piece of the parameter of 1/1024, or two that meet, by the speed of the outline: no more than 15 m for radii up to 2.5 m
                        assert!(found[0].width() < 15.0 * 2.0 * FINEST, "{}", found[0]);
                    }
                }
            }
        }
        let ellipse = PoseBody::parse("ellipse:1.3,0.7", Some([0.1, 0.05])).unwrap();
        let enclosed = EnclosedBody::new(&ellipse).expect("enclosed");
        for i in 0..60 {
            let angle = 0.1 * f64::from(i);
            let ([_, slope, second], [first, next]) =
                (ellipse.support(angle), enclosed.slopes(Interval::point(angle)));
            assert!(first.contains(slope) && next.contains(second));
        }
    }
}
