//! The closed cubic spline through three points around the origin (section 3.4 of the thesis).

use super::form::{FormError, Knots, length};
use super::plane::{Plane, along, cross, dot, left_of, scaled, unit};
use super::quadrature::{Integrals, over_pieces, rates};
use std::f64::consts::{PI, TAU};

/// A root this far beyond the end of its piece is still taken: the neighbour has the same root there up to the cube
/// of this, for the spline's second derivative is continuous.
const BEYOND: f64 = 1e-6;

/// Three cubics, each over a parameter from 0 to 1, with continuous first and second derivatives (in the common
/// parameter) at the points, counterclockwise and strictly convex.
#[derive(Clone, Debug)]
pub(super) struct ClosedSpline {
    /// Coefficients of the powers 0 to 3 of the parameter.
    pieces: [[Plane; 4]; 3],
}

/// The solution of `rows x = right` by Cramer's rule. The spline's matrix is diagonally dominant.
fn solved(rows: [[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let determinant = |m: &[[f64; 3]; 3]| -> f64 {
        (0..3)
            .map(|j| {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                m[0][j] * (m[1][k] * m[2][l] - m[1][l] * m[2][k])
            })
            .sum()
    };
    let whole = determinant(&rows);
    std::array::from_fn(|j| {
        let mut replaced = rows;
        (0..3).for_each(|i| replaced[i][j] = right[i]);
        determinant(&replaced) / whole
    })
}

impl ClosedSpline {
    pub(super) fn new(radii: [f64; 3], knots: Knots) -> Result<Self, FormError> {
        for radius in radii {
            length("a radius of the spline", radius)?;
        }
        let points: [Plane; 3] = std::array::from_fn(|i| scaled(radii[i], unit(TAU * i as f64 / 3.0)));
        let chords: [Plane; 3] = std::array::from_fn(|i| along(points[(i + 1) % 3], -1.0, points[i]));
        let steps = chords.map(|chord| match knots {
            Knots::Uniform => 1.0,
            Knots::Centripetal => chord[0].hypot(chord[1]).sqrt(),
            Knots::Chord => chord[0].hypot(chord[1]),
        });
        ClosedSpline::through(points, steps)
    }

    /// The spline through three points, for which its parameter takes the given steps.
    fn through(points: [Plane; 3], steps: [f64; 3]) -> Result<Self, FormError> {
        let chords: [Plane; 3] = std::array::from_fn(|i| along(points[(i + 1) % 3], -1.0, points[i]));
        // the second derivatives at the points, from the continuity of the first ones
        let before = |i: usize| (i + 2) % 3;
        let rows = std::array::from_fn(|i| {
            let mut row = [0.0; 3];
            row[before(i)] = steps[before(i)];
            row[i] = 2.0 * (steps[before(i)] + steps[i]);
            row[(i + 1) % 3] = steps[i];
            row
        });
        let bends = [0, 1].map(|axis: usize| {
            let slope = |i: usize| chords[i][axis] / steps[i];
            solved(rows, std::array::from_fn(|i| 6.0 * (slope(i) - slope(before(i)))))
        });
        let pieces = std::array::from_fn(|i| {
            let square = steps[i] * steps[i] / 6.0;
            let [begin, end] = [i, (i + 1) % 3].map(|k| scaled(square, [bends[0][k], bends[1][k]]));
            let first = along(along(chords[i], -2.0, begin), -1.0, end);
            [points[i], first, scaled(3.0, begin), along(end, -1.0, begin)]
        });
        let found = ClosedSpline { pieces };
        found.check()?;
        Ok(found)
    }

    /// Strictly convex: it turns to the left everywhere, and once.
    ///
    /// The turning `x' × x''` of a cubic `c0 + c1 t + c2 t^2 + c3 t^3` is `2 c1×c2 + 6 c1×c3 t + 6 c2×c3 t^2`: the
    /// cubic term vanishes. Its least value on `[0, 1]` is at an end or at the vertex. The direction of a quadratic
    /// `x'` turns by less than a full turn, so that its ends determine by how much.
    fn check(&self) -> Result<(), FormError> {
        let mut turned = 0.0;
        for (i, piece) in self.pieces.iter().enumerate() {
            let [_, c1, c2, c3] = *piece;
            let [constant, linear, square] = [2.0 * cross(c1, c2), 6.0 * cross(c1, c3), 6.0 * cross(c2, c3)];
            let turning = |t: f64| constant + t * (linear + t * square);
            let vertex = -linear / (2.0 * square);
            let inside = if square > 0.0 && (0.0..=1.0).contains(&vertex) { vertex } else { 0.0 };
            let least =
                [0.0, 1.0, inside].into_iter().fold(0.0, |a, b| if turning(b) < turning(a) { b } else { a });
            let size = |c: Plane| c[0].hypot(c[1]);
            let terms = size(c1) * (size(c2) + size(c3)) + size(c2) * size(c3);
            if turning(least) <= 64.0 * f64::EPSILON * terms {
                let [x, y] = self.at(i, least);
                let speed = size(self.rate(i, least));
                let curvature = turning(least) / speed.powi(3);
                return Err(FormError::Dent { x, y, polar: y.atan2(x).rem_euclid(TAU), curvature });
            }
            let (begin, end) = (self.rate(i, 0.0), self.rate(i, 1.0));
            turned += cross(begin, end).atan2(dot(begin, end)).rem_euclid(TAU);
        }
        if (turned - TAU).abs() > PI {
            return Err(FormError::Loops(turned / TAU));
        }
        Ok(())
    }

    fn at(&self, piece: usize, t: f64) -> Plane {
        let [c0, c1, c2, c3] = self.pieces[piece];
        along(c0, t, along(c1, t, along(c2, t, c3)))
    }

    fn rate(&self, piece: usize, t: f64) -> Plane {
        let [_, c1, c2, c3] = self.pieces[piece];
        along(c1, t, along(scaled(2.0, c2), 3.0 * t, c3))
    }

    /// `h`, `h'` and `h''`. The first two and the radius of curvature `h + h''` are continuous; `h''` has kinks where
    /// the normal is that of one of the three points.
    ///
    /// The outline is farthest in the direction `u` where `x' · u = 0`, a quadratic equation on each piece.
    pub(super) fn support(&self, angle: f64) -> [f64; 3] {
        let direction = unit(angle);
        let mut farthest = [f64::NEG_INFINITY, f64::NAN, f64::NAN];
        for (i, [_, c1, c2, c3]) in self.pieces.iter().enumerate() {
            let [a, b, c] = [3.0 * dot(*c3, direction), dot(*c2, direction), dot(*c1, direction)];
            // a t^2 + 2 b t + c = 0, without cancellation
            let sum = -(b + (b * b - a * c).sqrt().copysign(b));
            for root in [sum / a, c / sum] {
                if !(-BEYOND..=1.0 + BEYOND).contains(&root) {
                    continue;
                }
                let x = self.at(i, root);
                let reached = dot(x, direction);
                if reached > farthest[0] {
                    let rate = self.rate(i, root);
                    let bend = along(scaled(2.0, *c2), 6.0 * root, *c3);
                    let radius = dot(rate, rate).powf(1.5) / cross(rate, bend);
                    farthest = [reached, dot(x, left_of(direction)), radius - reached];
                }
            }
        }
        farthest
    }

    /// No point of the outline is farther from the origin: a cubic stays within its control points.
    pub(super) fn reach(&self) -> f64 {
        let control = |[c0, c1, c2, c3]: &[Plane; 4]| {
            let second = along(*c0, 1.0 / 3.0, *c1);
            let third = along(along(*c0, 2.0 / 3.0, *c1), 1.0 / 3.0, *c2);
            let last = along(along(along(*c0, 1.0, *c1), 1.0, *c2), 1.0, *c3);
            [*c0, second, third, last].map(|x| x[0].hypot(x[1])).into_iter().fold(0.0, f64::max)
        };
        self.pieces.iter().map(control).fold(0.0, f64::max)
    }

    /// The integrals over its outline: all but the perimeter are of polynomials, and exact up to rounding.
    pub(super) fn integrals(&self) -> Result<Integrals, FormError> {
        over_pieces(3, |piece, t| rates(self.at(piece, t), self.rate(piece, t)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Through the points, with continuous derivatives: by one-sided values at the knots.
    #[test]
    fn the_spline_interpolates_smoothly() {
        for knots in [Knots::Uniform, Knots::Centripetal, Knots::Chord] {
            let radii = [1.2, 1.5, 1.3];
            let spline = ClosedSpline::new(radii, knots).unwrap();
            for i in 0..3 {
                let next = (i + 1) % 3;
                let (point, end) = (spline.at(next, 0.0), spline.at(i, 1.0));
                assert!((point[0].hypot(point[1]) - radii[next]).abs() < 1e-15);
                assert!((point[0] - end[0]).abs() + (point[1] - end[1]).abs() < 2e-15);
                // the common parameter is the local one times the step
                let points = [i, next, (i + 2) % 3].map(|k| spline.at(k, 0.0));
                let chord = |k: usize| along(points[k + 1], -1.0, points[k]);
                let step = |k: usize| match knots {
                    Knots::Uniform => 1.0,
                    Knots::Centripetal => dot(chord(k), chord(k)).sqrt().sqrt(),
                    Knots::Chord => dot(chord(k), chord(k)).sqrt(),
                };
                let bend = |piece: usize, t: f64| {
                    let [_, _, c2, c3] = spline.pieces[piece];
                    along(scaled(2.0, c2), 6.0 * t, c3)
                };
                for axis in 0..2 {
                    let (left, right) =
                        (spline.rate(i, 1.0)[axis] / step(0), spline.rate(next, 0.0)[axis] / step(1));
                    assert!((left - right).abs() < 1e-14);
                    let (left, right) =
                        (bend(i, 1.0)[axis] / step(0).powi(2), bend(next, 0.0)[axis] / step(1).powi(2));
                    assert!((left - right).abs() < 2e-14);
                }
            }
        }
    }

    /// The cubics with these ends and `speed` times the tangents of the unit circle there (Hermite).
    fn arcs(corners: [Plane; 4], speed: f64) -> ClosedSpline {
        let arc = |i: usize| {
            let (begin, end) = (corners[i], corners[i + 1]);
            let [leave, arrive] = [begin, end].map(|x| scaled(speed, left_of(x)));
            let chord = along(end, -1.0, begin);
            let second = along(along(scaled(3.0, chord), -2.0, leave), -1.0, arrive);
            [begin, leave, second, along(along(scaled(-2.0, chord), 1.0, leave), 1.0, arrive)]
        };
        ClosedSpline { pieces: [arc(0), arc(1), arc(2)] }
    }

    fn corners(step: f64) -> [Plane; 4] {
        [0.0, 1.0, 2.0, 3.0].map(|i| unit(step * i))
    }

    /// Three arcs of 120 degrees with the speed `k` turn at their ends by `2 T0 × (3 chord - 2 T0 - T1) = 9 k - sqrt(3)
    /// k^2`: they have dents there beyond `k = 3 sqrt(3) = 5.196`. And clockwise the right way is the wrong one.
    #[test]
    fn a_dent_is_found_where_it_is() {
        assert_eq!(arcs(corners(TAU / 3.0), 5.19).check(), Ok(()));
        let Err(FormError::Dent { x, y, curvature, .. }) = arcs(corners(TAU / 3.0), 5.5).check() else {
            panic!("no dent")
        };
        assert!(corners(TAU / 3.0).iter().any(|c| (c[0] - x).hypot(c[1] - y) < 1e-14));
        assert!((curvature - (9.0 * 5.5 - 3f64.sqrt() * 5.5 * 5.5) / 5.5f64.powi(3)).abs() < 1e-14);
        let [a, b, c, _] = corners(TAU / 3.0);
        assert!(ClosedSpline::through([a, b, c], [1.0; 3]).is_ok());
        assert!(matches!(ClosedSpline::through([a, c, b], [1.0; 3]), Err(FormError::Dent { .. })));
    }

    /// What `Knots` says: on a grid over the radii of section 3.4 no spline has a dent.
    #[test]
    fn all_splines_of_a_grid_are_convex() {
        for knots in [Knots::Uniform, Knots::Centripetal, Knots::Chord] {
            for index in 0..13 * 13 * 13 {
                let radii = [index % 13, index / 13 % 13, index / 169].map(|i| 0.1 + 0.2 * f64::from(i));
                assert!(ClosedSpline::new(radii, knots).is_ok(), "{radii:?}");
            }
        }
    }

    /// An outline of three arcs that each turn by 240 degrees is convex everywhere but winds twice.
    #[test]
    fn a_loop_is_no_body() {
        let wound = arcs(corners(2.0 * TAU / 3.0), 6.0);
        let Err(FormError::Loops(turns)) = wound.check() else { panic!("{:?}", wound.check()) };
        assert!((turns - 2.0).abs() < 1e-15);
    }

    /// The support function is the greatest projection over a fine outline, which at `n` points a piece falls short
    /// by at most `|x''| / (8 n^2)`.
    #[test]
    fn the_support_function_is_a_maximum() {
        let spline = ClosedSpline::new([0.4, 2.1, 1.1], Knots::Uniform).unwrap();
        let bend = spline.pieces.iter().flatten().map(|c| 6.0 * c[0].hypot(c[1])).fold(0.0, f64::max);
        for k in 0..200 {
            let angle = f64::from(k) * 0.0314 + 0.01;
            let points = (0..3).flat_map(|i| (0..1000).map(move |t| (i, f64::from(t) / 1000.0)));
            let most = points.map(|(i, t)| dot(spline.at(i, t), unit(angle))).fold(f64::MIN, f64::max);
            let short = spline.support(angle)[0] - most;
            assert!((-1e-15..2.0 * bend / 8e6).contains(&short), "{short}");
        }
    }

    /// `h'` and `h''` against central differences of `h` and `h'`, and at the kinks from one side.
    #[test]
    fn derivatives_of_the_support_function() {
        let spline = ClosedSpline::new([1.2, 1.7, 1.3], Knots::Uniform).unwrap();
        let step = 1e-5;
        for k in 0..100 {
            let angle = f64::from(k) * 0.0628 + 0.0123;
            let [before, [_, slope, second], after] = [-step, 0.0, step].map(|e| spline.support(angle + e));
            assert!((slope - (after[0] - before[0]) / (2.0 * step)).abs() < 1e-8);
            // a kink of h'' within the step adds its jump in slope times the step
            assert!((second - (after[1] - before[1]) / (2.0 * step)).abs() < 1e-3, "{angle}");
        }
    }
}
