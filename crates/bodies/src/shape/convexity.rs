//! Whether a support function is that of a convex body: `r + r'' > 0` at every normal.

use super::SupportSeries;
use palmistry_math::number::{Function, Interval, RealNumber};
use std::f64::consts::TAU;

/// An interval is halved this often before it is given up.
const DEPTH: u32 = 44;

/// A lower bound on a piece is good enough that is no less than this part of the value in its middle.
const TIGHT: f64 = 0.95;

/// Pieces of a turn at the start, for each harmonic.
const PIECES: u32 = 4;

/// What is known of the sign of `r + r''`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convexity {
    /// It is positive at every normal, and nowhere less than this; in m.
    Convex {
        /// A lower bound of the least radius of curvature.
        least: f64,
    },
    /// It is negative at this normal (rad).
    NotConvex {
        /// The angle of the normal.
        angle: f64,
        /// The value there, in m, or one that is nearer to zero.
        value: f64,
    },
    /// It is too near to zero at this normal to be decided.
    Undecided {
        /// The angle of the normal.
        angle: f64,
    },
}

/// The sign of `r + r''` of a series, with its coefficients as they are: decided in interval arithmetic rounded outward, by its mean value
/// form on pieces of a turn that are halved until it is decided there.
pub fn convexity(series: &SupportSeries) -> Convexity {
    let pieces = PIECES * (series.order() as u32 + 1);
    // a turn and a little more: rounding omits no normal
    let step = TAU * (1.0 + 1e-9) / f64::from(pieces);
    let mut open: Vec<(Interval, u32)> = (0..pieces)
        .map(|i| (Interval::new(step * f64::from(i), (step * f64::from(i + 1)).next_up()), 0))
        .collect();
    let mut least = f64::INFINITY;
    while let Some((piece, depth)) = open.pop() {
        let Some([middle, all]) = curvature(series, piece) else {
            return Convexity::Undecided { angle: piece.mid() };
        };
        if middle.high() < 0.0 {
            return Convexity::NotConvex { angle: piece.mid(), value: middle.high() };
        }
        if all.low() > 0.0 && (all.low() > TIGHT * middle.low() || depth == DEPTH) {
            least = least.min(all.low());
        } else if depth == DEPTH {
            return Convexity::Undecided { angle: piece.mid() };
        } else {
            let (left, right) = piece.split();
            open.extend([(left, depth + 1), (right, depth + 1)]);
        }
    }
    Convexity::Convex { least }
}

/// `r + r''` in the middle of a piece, and on all of it; none where there is no bound.
fn curvature(series: &SupportSeries, piece: Interval) -> Option<[Interval; 2]> {
    let middle = Interval::point(piece.mid());
    let (mut value, mut slope) = (Interval::point(series.mean), Interval::ZERO);
    let none = [0.0; 2];
    for (k, [a, b]) in (1u32..).zip(&series.harmonics).filter(|(_, harmonic)| **harmonic != none) {
        let k = f64::from(k);
        let (a, b) = (Interval::point(*a), Interval::point(*b));
        // exact: no order has that many digits
        let factor = Interval::point(1.0 - k * k);
        let wave = |angle: Interval| -> Option<[Interval; 2]> {
            let angle = Interval::point(k) * angle;
            Some([angle.function(Function::Cos).ok()?, angle.function(Function::Sin).ok()?])
        };
        let ([cosine, sine], [cosines, sines]) = (wave(middle)?, wave(piece)?);
        value += factor * (a * cosine + b * sine);
        slope += factor * Interval::point(k) * (b * cosines - a * sines);
    }
    let all = value + slope * (piece - middle);
    let known = |interval: &Interval| interval.low().is_finite() && interval.high().is_finite();
    (known(&value) && known(&all)).then_some([value, all])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(order: usize, [a, b]: [f64; 2]) -> SupportSeries {
        let mut harmonics = vec![[0.0; 2]; order];
        harmonics[order - 1] = [a, b];
        SupportSeries { mean: 1.0, harmonics }
    }

    /// `1 + e cos(k t + p)` is convex for `|e| < 1/(k^2 - 1)`, whatever the phase `p`, by hand; a grid would miss a sharp bend.
    #[test]
    fn the_limit_of_one_harmonic_is_known() {
        for order in [2usize, 3, 7, 24] {
            let limit = 1.0 / ((order * order) as f64 - 1.0);
            for phase in [0.0f64, 0.4, 2.0] {
                let at = |e: f64| convexity(&with(order, [e * limit * phase.cos(), e * limit * phase.sin()]));
                let Convexity::Convex { least } = at(1.0 - 1e-7) else { panic!("{order} {phase}") };
                assert!(least > 0.0 && least < 1.1e-7, "{least}");
                let Convexity::NotConvex { angle, value } = at(1.0 + 1e-7) else { panic!("{order} {phase}") };
                assert!(value < 0.0 && value > -1.1e-7, "{value} at {angle}");
                assert!(matches!(at(1.0), Convexity::Undecided { .. } | Convexity::NotConvex { .. }));
            }
        }
    }

    #[test]
    fn what_is_no_number_is_undecided() {
        for broken in [f64::NAN, f64::INFINITY] {
            assert!(matches!(convexity(&with(2, [broken, 0.0])), Convexity::Undecided { .. }));
        }
        // a first harmonic only moves the body
        assert_eq!(convexity(&with(1, [5.0, 3.0])), Convexity::Convex { least: 1.0 });
    }
}
