//! The support function of a closed cubic spline through a few points, and its derivatives by the points and by the steps of the spline's parameter.
//!
//! Its third derivative jumps where two pieces meet: no short series follows it there, and a few points determine it exactly.

use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

type Plane = [f64; 2];
/// Coefficients of the powers 0 to 3 of a parameter from 0 to 1.
type Cubic = [Plane; 4];

/// So far beyond the ends of a piece its roots still count.
const BEYOND: f64 = 1e-9;

/// Nodes and weights of Gauss and Legendre's rule with five nodes on `[-1, 1]` (Abramowitz and Stegun, table 25.4), and the parts of a piece.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];
const PARTS: u32 = 16;

/// A closed cubic spline with two continuous derivatives through points, counterclockwise, as a support function.
#[derive(Clone, Debug, PartialEq)]
pub struct SupportSpline {
    points: Vec<Plane>,
    /// The logarithms of the parameter's steps relative to the first one, from the second on.
    ratios: Vec<f64>,
    pieces: Vec<Cubic>,
    /// The derivatives of the pieces by the coordinates of the points, then by the ratios.
    slopes: Vec<Vec<Cubic>>,
}

/// Where a normal touches the curve: on which piece, and its derivatives by the parameter.
struct Touch {
    piece: usize,
    t: f64,
    at: [Plane; 4],
}

fn dot(a: Plane, b: Plane) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Plane, b: Plane) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn plus(a: Plane, factor: f64, b: Plane) -> Plane {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

/// Normal and tangent at an angle.
fn frame(angle: f64) -> [Plane; 2] {
    let (sine, cosine) = angle.sin_cos();
    [[cosine, sine], [-sine, cosine]]
}

/// A cubic and its derivatives by its parameter.
fn derivatives([c0, c1, c2, c3]: &Cubic, t: f64) -> [Plane; 4] {
    let at = |i: usize| {
        let (c0, c1, c2, c3) = (c0[i], c1[i], c2[i], c3[i]);
        [
            c0 + t * (c1 + t * (c2 + t * c3)),
            c1 + t * (2.0 * c2 + 3.0 * t * c3),
            2.0 * c2 + 6.0 * t * c3,
            6.0 * c3,
        ]
    };
    let [x, y] = [at(0), at(1)];
    [0, 1, 2, 3].map(|k: usize| [x[k], y[k]])
}

/// The equations for the second derivatives at the points, from the continuity of the first ones.
struct Bends {
    inverse: DMatrix<f64>,
    /// The second derivatives at the points, a column for each axis.
    bends: DMatrix<f64>,
}

fn matrix(steps: &[f64]) -> DMatrix<f64> {
    let n = steps.len();
    let mut matrix = DMatrix::zeros(n, n);
    for i in 0..n {
        let before = (i + n - 1) % n;
        matrix[(i, before)] += steps[before];
        matrix[(i, i)] += 2.0 * (steps[before] + steps[i]);
        matrix[(i, (i + 1) % n)] += steps[i];
    }
    matrix
}

/// The right-hand side, where the slope of a piece is a value for each.
fn sides(slopes: &[Plane]) -> DMatrix<f64> {
    let n = slopes.len();
    DMatrix::from_fn(n, 2, |i, axis| 6.0 * (slopes[i][axis] - slopes[(i + n - 1) % n][axis]))
}

impl SupportSpline {
    /// The spline through the points `x_0, y_0, x_1, ...` (m) whose parameter grows by 1 on the first piece, and by `exp` of the numbers that follow on the others. None with
    /// fewer than three points, or where it cannot be computed.
    pub fn of_coefficients(coefficients: &[f64]) -> Option<SupportSpline> {
        let n = (coefficients.len() + 1) / 3;
        if n < 3 || coefficients.len() != 3 * n - 1 {
            return None;
        }
        let (points, ratios) = coefficients.split_at(2 * n);
        let points: Vec<Plane> = points.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        let mut spline =
            SupportSpline { points, ratios: ratios.to_vec(), pieces: Vec::new(), slopes: Vec::new() };
        let steps = spline.steps();
        let chords = spline.chords();
        let speeds: Vec<Plane> =
            chords.iter().zip(&steps).map(|(chord, step)| chord.map(|x| x / step)).collect();
        let inverse = matrix(&steps).try_inverse()?;
        let bends = &inverse * sides(&speeds);
        let known = Bends { inverse, bends };
        spline.pieces = spline.cubics(&chords, &known.bends, &steps);
        spline.slopes = (0..coefficients.len()).map(|place| spline.slope(place, &known, &steps)).collect();
        let finite = spline.pieces.iter().flatten().flatten().all(|x| x.is_finite());
        finite.then_some(spline)
    }

    fn steps(&self) -> Vec<f64> {
        std::iter::once(1.0).chain(self.ratios.iter().map(|ratio| ratio.exp())).collect()
    }

    fn chords(&self) -> Vec<Plane> {
        let n = self.points.len();
        (0..n).map(|i| plus(self.points[(i + 1) % n], -1.0, self.points[i])).collect()
    }

    fn cubics(&self, chords: &[Plane], bends: &DMatrix<f64>, steps: &[f64]) -> Vec<Cubic> {
        let n = chords.len();
        let piece = |i: usize| {
            let square = steps[i] * steps[i] / 6.0;
            let [begin, end] = [i, (i + 1) % n].map(|k| [square * bends[(k, 0)], square * bends[(k, 1)]]);
            let first = plus(plus(chords[i], -2.0, begin), -1.0, end);
            [self.points[i], first, begin.map(|x| 3.0 * x), plus(end, -1.0, begin)]
        };
        (0..n).map(piece).collect()
    }

    /// The derivative of all pieces by one coefficient.
    fn slope(&self, place: usize, known: &Bends, steps: &[f64]) -> Vec<Cubic> {
        let n = self.points.len();
        let mut moved = vec![[0.0; 2]; n];
        let mut stretched = vec![0.0; n];
        if place < 2 * n {
            moved[place / 2][place % 2] = 1.0;
        } else {
            stretched[place - 2 * n + 1] = steps[place - 2 * n + 1];
        }
        let chords: Vec<Plane> = (0..n).map(|i| plus(moved[(i + 1) % n], -1.0, moved[i])).collect();
        let own = self.chords();
        let speeds: Vec<Plane> = (0..n)
            .map(|i| {
                let by_step = own[i].map(|x| -x * stretched[i] / (steps[i] * steps[i]));
                plus(by_step, 1.0 / steps[i], chords[i])
            })
            .collect();
        let right = sides(&speeds) - matrix(&stretched) * &known.bends;
        let bends = &known.inverse * right;
        (0..n)
            .map(|i| {
                let (square, by) = (steps[i] * steps[i] / 6.0, steps[i] * stretched[i] / 3.0);
                let [begin, end] = [i, (i + 1) % n].map(|k| {
                    [0, 1].map(|axis: usize| square * bends[(k, axis)] + by * known.bends[(k, axis)])
                });
                let first = plus(plus(chords[i], -2.0, begin), -1.0, end);
                [moved[i], first, begin.map(|x| 3.0 * x), plus(end, -1.0, begin)]
            })
            .collect()
    }

    /// The points' coordinates, then the logarithms of the steps but the first.
    pub fn coefficients(&self) -> Vec<f64> {
        self.points.iter().flatten().chain(&self.ratios).copied().collect()
    }

    /// The points through which it runs: where its curvature has kinks. In m.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The same curve with one more point, in the middle of a piece.
    pub fn with_point_on(&self, piece: usize) -> Option<SupportSpline> {
        let steps = self.steps();
        let mut points = self.points.clone();
        points.insert(piece + 1, derivatives(&self.pieces[piece], 0.5)[0]);
        let mut split = steps.clone();
        split[piece] /= 2.0;
        split.insert(piece, split[piece]);
        let ratios = split[1..].iter().map(|step| (step / split[0]).ln());
        let all: Vec<f64> = points.iter().flatten().copied().chain(ratios).collect();
        SupportSpline::of_coefficients(&all)
    }

    /// The farthest point in a direction: there the derivative by the parameter, a quadratic polynomial, is perpendicular to it.
    fn touch(&self, normal: Plane) -> Touch {
        let mut found = Touch { piece: 0, t: f64::NAN, at: [[f64::NAN; 2]; 4] };
        let mut most = f64::NEG_INFINITY;
        for (piece, cubic) in self.pieces.iter().enumerate() {
            let [a, b, c] = [3.0 * dot(cubic[3], normal), dot(cubic[2], normal), dot(cubic[1], normal)];
            let sum = -(b + (b * b - a * c).sqrt().copysign(b));
            for t in [sum / a, c / sum] {
                if !(-BEYOND..=1.0 + BEYOND).contains(&t) {
                    continue;
                }
                let at = derivatives(cubic, t);
                let reach = dot(at[0], normal);
                if reach > most {
                    most = reach;
                    found = Touch { piece, t, at };
                }
            }
        }
        found
    }

    /// `[r, r', r'', r''']` at an angle, in m.
    pub fn support(&self, angle: f64) -> [f64; 4] {
        let [normal, tangent] = frame(angle);
        let [x, first, second, third] = self.touch(normal).at;
        let (speed, turning) = (dot(first, first).sqrt(), cross(first, second));
        let (reach, slope) = (dot(x, normal), dot(x, tangent));
        let radius = speed.powi(3) / turning;
        let by_parameter = 3.0 * speed * dot(first, second) / turning
            - speed.powi(3) * cross(first, third) / (turning * turning);
        [reach, slope, radius - reach, by_parameter * speed * speed / turning - slope]
    }

    /// The derivatives of `[r, r', r'']` at an angle by the coefficients; the fourth is not given.
    pub fn basis(&self, angle: f64) -> Vec<[f64; 4]> {
        let [normal, tangent] = frame(angle);
        let Touch { piece, t, at: [_, first, second, third] } = self.touch(normal);
        let (speed, turning) = (dot(first, first).sqrt(), cross(first, second));
        let by = |slope: &Vec<Cubic>| {
            let [x, own_first, own_second, _] = derivatives(&slope[piece], t);
            let along = -dot(own_first, normal) / dot(second, normal);
            let [first_by, second_by] = [plus(own_first, along, second), plus(own_second, along, third)];
            let faster = dot(first, first_by) / speed;
            let turned = cross(first_by, second) + cross(first, second_by);
            let radius = speed * speed * (3.0 * faster / turning - speed * turned / (turning * turning));
            let reach = dot(x, normal);
            [reach, dot(plus(x, along, first), tangent), radius - reach, 0.0]
        };
        self.slopes.iter().map(by).collect()
    }

    /// Sums over the outline: of what a point and its derivative are worth.
    fn over(&self, worth: impl Fn(Plane, Plane) -> f64) -> f64 {
        let half = 0.5 / f64::from(PARTS);
        let nodes = (0..PARTS).flat_map(|part| {
            GAUSS.map(move |(node, weight)| (half * (f64::from(2 * part + 1) + node), half * weight))
        });
        let of = |cubic: &Cubic| -> f64 {
            nodes
                .clone()
                .map(|(t, weight)| {
                    let [x, first, ..] = derivatives(cubic, t);
                    weight * worth(x, first)
                })
                .sum()
        };
        self.pieces.iter().map(of).sum()
    }

    /// In m.
    pub fn perimeter(&self) -> f64 {
        self.over(|_, first| dot(first, first).sqrt())
    }

    /// In m^2.
    pub fn area(&self) -> f64 {
        self.over(|x, first| 0.5 * cross(x, first))
    }

    /// Derivatives of the perimeter and of the area by the coefficients: `int dr da` and `int dr ds`.
    pub(super) fn integrated(&self) -> [DVector<f64>; 2] {
        const NORMALS: u32 = 2880;
        let step = TAU / f64::from(NORMALS);
        let mut sums = [0, 1].map(|_| DVector::zeros(self.slopes.len()));
        for i in 0..NORMALS {
            let angle = step * f64::from(i);
            let [reach, _, second, _] = self.support(angle);
            for (place, basis) in self.basis(angle).iter().enumerate() {
                sums[0][place] += step * basis[0];
                sums[1][place] += step * basis[0] * (reach + second);
            }
        }
        sums
    }

    /// The least of `x' × x''`, a quadratic polynomial on each piece, relative to the sizes that it is made of, and where it is: positive where the curve turns
    /// to the left everywhere.
    pub(super) fn least_turning(&self) -> (f64, f64) {
        let size = |c: Plane| c[0].hypot(c[1]);
        let mut least = (f64::INFINITY, 0.0);
        for cubic in &self.pieces {
            let [_, c1, c2, c3] = *cubic;
            let [constant, linear, square] = [2.0 * cross(c1, c2), 6.0 * cross(c1, c3), 6.0 * cross(c2, c3)];
            let terms = size(c1) * (size(c2) + size(c3)) + size(c2) * size(c3);
            let vertex = (-linear / (2.0 * square)).clamp(0.0, 1.0);
            for t in [0.0, 1.0, if vertex.is_finite() { vertex } else { 0.0 }] {
                let turning = (constant + t * (linear + t * square)) / terms;
                if turning.is_nan() || turning < least.0 {
                    let [_, [x, y], ..] = derivatives(cubic, t);
                    least = (turning, (-x).atan2(y));
                }
            }
        }
        least
    }
}

#[cfg(test)]
mod tests;
