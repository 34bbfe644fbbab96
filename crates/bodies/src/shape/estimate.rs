//! A support function that was estimated, and how sure it is.

use super::{Convexity, Coverage, SupportFunction, SupportSeries};
use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};

/// A value with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard deviation, in the same unit.
    pub deviation: f64,
}

/// A closed support function with the covariance of its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeEstimate {
    /// The support function.
    pub support: SupportFunction,
    /// Of its coefficients: a row and a column each. Those of a series are `a_0, a_1, b_1, a_2, b_2, ...`, in m.
    pub covariance: DMatrix<f64>,
    /// Other support functions about the same point that explain the samples, each with the probability that it is the one: what they differ by is in all deviations.
    pub others: Vec<(f64, ShapeEstimate)>,
    /// How many samples it was made of.
    pub samples: usize,
    /// The sum of the squared residuals, in units of the samples' variances.
    pub chi_square: f64,
    /// Samples less unknowns; at least one.
    pub degrees: usize,
    /// By what factor the deviations grew because the residual is larger than the weights explain; one where it is not.
    pub widened: f64,
}

/// The standard deviation of a linear form in numbers with a covariance. The small variance of the touched part is a difference of the large ones of the gaps:
/// their rounding is counted, and a variance of which no digit remains is not zero.
pub fn deviation_of(covariance: &DMatrix<f64>, form: &[f64]) -> f64 {
    let (mut variance, mut rounded) = (0.0, 0.0);
    for (column, factor) in covariance.column_iter().zip(form) {
        for (entry, other) in column.iter().zip(form) {
            let part = entry * factor * other;
            variance += part;
            rounded += part.abs();
        }
    }
    (variance.max(0.0) + f64::EPSILON * rounded).sqrt()
}

/// The quantile that one normal error in a thousand exceeds, for a band that holds at all normals at once.
const ONE_IN_A_THOUSAND: f64 = 3.090_232_306_167_813;

/// Pieces of a turn for each harmonic, where the band of the radius of curvature is first looked at.
const PIECES: usize = 8;

/// Normals at which it is looked at where nobody knows how fast it changes.
const GRID: usize = 1440;

/// A piece is halved this often at most.
const DEPTH: u32 = 12;

impl ShapeEstimate {
    /// The standard deviation of the support radius at a normal (rad), in m: that of a single normal, if the body has no harmonics beyond those of the series.
    pub fn deviation(&self, angle: f64) -> f64 {
        self.deviation_of(angle, |basis| basis[0])
    }

    /// Half the width of the band about the support radius at a normal, in m. Where it was touched it is two standard deviations. In a gap no sample determines
    /// which harmonics there are, and the band follows from convexity alone: the body reaches at least as far as its contacts at the gap's ends, and no farther
    /// than the corner at which the tangents there meet; infinite where these do not meet, in a gap of half a turn and more.
    pub fn band(&self, coverage: &Coverage, angle: f64) -> f64 {
        let own = 2.0 * self.deviation(angle);
        if coverage.contains(angle) {
            return own;
        }
        let turned = angle.rem_euclid(TAU);
        let within = |from: f64| if turned < from { turned + TAU } else { turned };
        let gap = coverage.gaps().into_iter().find(|[from, to]| within(*from) <= *to);
        let Some([from, to]) = gap else { return own };
        if to - from >= PI {
            return f64::INFINITY;
        }
        let (angle, sine) = (within(from), (to - from).sin());
        let [first, last] = [from, to].map(|end| self.support.support(end)[0]);
        let corner = (first * (to - angle).sin() + last * (angle - from).sin()) / sine;
        let reach = |end: f64| {
            let [x, y] = self.support.point(end);
            x * angle.cos() + y * angle.sin()
        };
        let (radius, least) = (self.support.support(angle)[0], reach(from).max(reach(to)));
        let ends = 2.0 * self.deviation(from).max(self.deviation(to));
        own.max((corner - radius).max(radius - least) + ends)
    }

    /// The standard deviation of the radius of curvature, in m.
    pub fn curvature_deviation(&self, angle: f64) -> f64 {
        self.deviation_of(angle, |basis| basis[0] + basis[2])
    }

    fn deviation_of(&self, angle: f64, part: impl Fn(&[f64; 4]) -> f64) -> f64 {
        let own = |of: &ShapeEstimate| Measured {
            value: part(&of.support.support(angle)),
            deviation: of.spread(of.support.basis(angle).iter().map(&part)),
        };
        self.with_others(&own).deviation
    }

    /// The standard deviation of a linear form in the coefficients.
    fn spread(&self, form: impl Iterator<Item = f64>) -> f64 {
        let form: Vec<f64> = form.collect();
        deviation_of(&self.covariance, &form)
    }

    /// A value of this one, with the deviation of the mixture of all about it.
    fn with_others(&self, of: &dyn Fn(&ShapeEstimate) -> Measured) -> Measured {
        let own = of(self);
        let probability = 1.0 - self.others.iter().map(|(probability, _)| probability).sum::<f64>();
        let mut variance = probability * own.deviation.powi(2);
        for (probability, other) in &self.others {
            let other = of(other);
            variance += probability * (other.deviation.powi(2) + (other.value - own.value).powi(2));
        }
        Measured { value: own.value, deviation: variance.sqrt() }
    }

    /// The perimeter, `int r da`, in m.
    pub fn perimeter(&self) -> Measured {
        self.with_others(&|of| Measured {
            value: of.support.perimeter(),
            deviation: of.spread(of.support.sizes_by_coefficients()[0].iter().copied()),
        })
    }

    /// The area, `1/2 int r^2 - r'^2 da`, in m^2; its deviation by its derivatives.
    pub fn area(&self) -> Measured {
        self.with_others(&|of| Measured {
            value: of.support.area(),
            deviation: of.spread(of.support.sizes_by_coefficients()[1].iter().copied()),
        })
    }

    /// Whether the estimated function, as it is, is that of a convex body.
    pub fn convexity(&self) -> Convexity {
        self.support.convexity()
    }

    /// Whether all that lies in the band is convex: that `r + r''` is positive at all normals at once, also less as many of its standard deviations as errors exceed
    /// once in a thousand (H. Scheffé, 1953: the root of a quantile of chi-square with as many degrees as there are coefficients). `NotConvex` where
    /// it is negative even with them added; else `Undecided`, at the normal that is in doubt.
    pub fn convexity_within_band(&self) -> Convexity {
        let p = self.covariance.nrows().max(1) as f64;
        // the quantile by E. Wilson and M. Hilferty (1931), good to a few thousandths
        let cube = 1.0 - 2.0 / (9.0 * p) + ONE_IN_A_THOUSAND * (2.0 / (9.0 * p)).sqrt();
        let width = (p * cube.powi(3)).sqrt();
        // how fast curvature and deviation can change with the angle: known of a series alone, else a fine grid has to do
        let (slope, order) = match &self.support {
            SupportFunction::Series(series) if self.others.is_empty() => {
                (self.steepest(series, width), series.order() + 1)
            }
            _ => (0.0, GRID / PIECES),
        };
        let half = PI / (PIECES * order) as f64;
        let mut open: Vec<(f64, f64, u32)> =
            (0..PIECES * order).map(|i| ((2 * i + 1) as f64 * half, half, 0)).collect();
        let (mut least, mut doubt): (f64, Option<(f64, f64)>) = (f64::INFINITY, None);
        while let Some((angle, half, depth)) = open.pop() {
            let (curvature, band) =
                (self.support.radius_of_curvature(angle), width * self.curvature_deviation(angle));
            if curvature + band < 0.0 {
                return Convexity::NotConvex { angle, value: curvature + band };
            }
            let low = curvature - band;
            if low - slope * half > 0.0 {
                least = least.min(low - slope * half);
            } else if depth == DEPTH || low.is_nan() || low <= 0.0 {
                // not the first place that is in doubt but the worst
                if doubt.is_none_or(|(_, worst)| low.total_cmp(&worst).is_lt()) {
                    doubt = Some((angle, low));
                }
            } else {
                open.push((angle - half / 2.0, half / 2.0, depth + 1));
                open.push((angle + half / 2.0, half / 2.0, depth + 1));
            }
        }
        match doubt {
            Some((angle, _)) => Convexity::Undecided { angle },
            None => Convexity::Convex { least },
        }
    }

    /// How fast `r + r''` of a series and so many of its deviations change at most.
    fn steepest(&self, series: &SupportSeries, width: f64) -> f64 {
        let slopes = (1..).zip(&series.harmonics).map(|(k, [a, b])| {
            let k = f64::from(k);
            let at = 2 * k as usize - 1;
            let spread = |i: usize| self.covariance[(i, i)].max(0.0).sqrt();
            k * (k * k - 1.0) * (a.hypot(*b) + width * (spread(at) + spread(at + 1)))
        });
        slopes.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(second: f64, deviation: f64) -> ShapeEstimate {
        let support = SupportSeries { mean: 1.0, harmonics: vec![[0.0; 2], [second, 0.0]] };
        ShapeEstimate {
            covariance: DMatrix::identity(5, 5) * deviation.powi(2),
            support: support.into(),
            others: Vec::new(),
            samples: 100,
            chi_square: 95.0,
            degrees: 95,
            widened: 1.0,
        }
    }

    /// `1 - 3 a cos 2t` with a = 0.3 is at least 0.1, with the deviation `s sqrt(1 + 9)`; chi-square with 5 degrees exceeds 20.515 once in a
    /// thousand: by hand the band reaches zero at `s = 0.1/sqrt(205.15)`.
    #[test]
    fn a_body_is_convex_while_its_band_is() {
        let limit = 0.1 / 205.15f64.sqrt();
        let at = |second: f64, deviation: f64| estimate(second, deviation).convexity_within_band();
        assert!(matches!(at(0.3, 0.99 * limit), Convexity::Convex { .. }));
        assert!(matches!(at(0.3, 1.01 * limit), Convexity::Undecided { .. }));
        assert!(matches!(at(0.4, 0.1 * limit), Convexity::NotConvex { .. }));
        assert!(matches!(at(f64::NAN, 0.1), Convexity::Undecided { .. }));
        // the polynomial itself is convex all the same
        let Convexity::Convex { least } = estimate(0.3, 1.01 * limit).convexity() else { panic!() };
        assert!(least > 0.095 && least <= 0.1, "{least}");
    }

    /// By hand for a disc of radius one that was not touched over a right angle: in its middle it may reach to the corner of a square, `sqrt 2`, and the chord
    /// is at `sqrt 2 / 2`. Over half a turn nothing is known.
    #[test]
    fn a_gap_is_as_wide_as_convexity_leaves_it() {
        let disc = estimate(0.0, 1e-9);
        let touched = |path: &[f64]| Coverage::of_paths([path]);
        let three_quarters = touched(&[PI / 2.0, TAU]);
        let band = disc.band(&three_quarters, PI / 4.0);
        assert!((band - (2f64.sqrt() - 1.0)).abs() < 1e-8, "{band}");
        assert_eq!(disc.band(&three_quarters, PI), 2.0 * disc.deviation(PI));
        assert_eq!(disc.band(&touched(&[0.0, 3.0]), 4.0), f64::INFINITY);
        assert_eq!(disc.band(&Coverage::default(), 4.0), f64::INFINITY);
        // across the end of the turn
        let across = disc.band(&touched(&[PI / 4.0, 7.0 * PI / 4.0]), -0.0);
        assert!((across - (2f64.sqrt() - 1.0)).abs() < 1e-8, "{across}");
    }

    /// By hand: `x - y` of two numbers that are one and the same, each known to one, but for 1e-9 that the covariance cannot hold beside it.
    #[test]
    fn what_rounding_leaves_is_not_nothing() {
        let both = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]);
        let found = deviation_of(&both, &[1.0, -1.0]);
        assert!((1e-9..1e-7).contains(&found), "{found:e}");
        assert!((deviation_of(&both, &[1.0, 1.0]) - 2.0).abs() < 1e-15);
    }

    /// By hand for a disc: `A = pi a^2` has the derivative `2 pi a`, and the harmonics do not matter to the first order.
    #[test]
    fn a_disc_has_its_errors() {
        let disc = estimate(0.0, 1e-3);
        assert!((disc.perimeter().deviation - TAU * 1e-3).abs() < 1e-15);
        assert!((disc.area().deviation - TAU * 1e-3).abs() < 1e-15);
        assert!((disc.deviation(0.3) - 1e-3 * 3f64.sqrt()).abs() < 1e-15);
    }
}
