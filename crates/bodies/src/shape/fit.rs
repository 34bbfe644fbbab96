//! The closed support function that explains touched normals best: weighted least squares for the coefficients of a Fourier polynomial.
//!
//! # What every convex body obeys
//!
//! `r + r''` is not negative, so that none of its Fourier coefficients is larger than twice its mean, which is that of `r`: a body of the mean radius
//! `a_0` has `|a_k|, |b_k| <= 2 a_0/(k^2 - 1)`, and `<= 2 a_0` for `k = 1`, since its point of reference lies inside. The fit takes these bounds for standard
//! deviations of the coefficients about zero. That is all the regularisation there is. Where normals were touched it changes nothing that the samples
//! determine; where they were not, it keeps the deviations of the coefficients finite. The band in a gap, [`ShapeEstimate::band`], does without it.

use super::{ShapeEstimate, SupportSeries};
use nalgebra::{DMatrix, DVector};

/// How far a body reaches at one normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportSample {
    /// The angle of the outward normal in the body's frame, in rad.
    pub angle: f64,
    /// The support radius there, in m.
    pub radius: f64,
    /// What the sample is worth: the inverse of the variance of its radius, in 1/m^2, or a multiple of that.
    pub weight: f64,
}

/// What weights are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SupportWeights {
    /// Inverse variances. Where the residual is larger than they explain the covariance grows with it; it never shrinks.
    InverseVariances,
    /// Known up to a factor, which follows from the residual.
    Relative,
}

/// The orders that are tried where none is given, the last harmonic of each.
pub const ORDERS: [usize; 15] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48];

/// The variance of samples of unknown worth at first, relative to the square of the mean radius; and the least that is believed of that in the end.
const UNHEARD: f64 = 1e-12;
const EXACT: f64 = 1e-14;

/// So many orders are tried at once.
const AT_ONCE: usize = 7;

/// So many rows are factored at once.
const ROWS: usize = 1024;

/// The standard deviation that convexity gives a coefficient of the `k`-th harmonic of a body with a mean radius; infinite for the mean itself.
pub fn convex_deviation(mean: f64, k: usize) -> f64 {
    match k {
        0 => f64::INFINITY,
        1 => 2.0 * mean.abs(),
        k => 2.0 * mean.abs() / ((k * k) as f64 - 1.0),
    }
}

/// The support function that explains samples best, with its covariance. Samples without a positive finite weight do not count. None where none does, or they
/// determine no positive mean radius.
///
/// The order is the one given, or else the one of [`ORDERS`] with the least criterion of G. Schwarz (1978): harmonics too small to be significant are
/// left out, and their part is not in the band.
///
/// ```
/// use palmistry_bodies::shape::{SupportSample, SupportWeights, fit_support};
/// // a disc of radius 2 about a point that is 0.3 off its centre, touched all round to a thousandth
/// let angles = (0..60).map(|i| std::f64::consts::TAU * f64::from(i) / 60.0);
/// let samples: Vec<SupportSample> = angles
///     .map(|angle| SupportSample { angle, radius: 2.0 - 0.3 * angle.cos(), weight: 1e6 })
///     .collect();
/// let shape = fit_support(&samples, SupportWeights::InverseVariances, None).unwrap();
/// assert_eq!(shape.support.order(), 1);
/// assert!((shape.perimeter().value - 4.0 * std::f64::consts::PI).abs() < 1e-6);
/// ```
pub fn fit_support(
    samples: &[SupportSample],
    weights: SupportWeights,
    order: Option<usize>,
) -> Option<ShapeEstimate> {
    let counts = |s: &&SupportSample| {
        s.weight > 0.0 && [s.weight, s.angle, s.radius].iter().all(|value| value.is_finite())
    };
    let samples: Vec<SupportSample> = samples.iter().filter(counts).copied().collect();
    let total: f64 = samples.iter().map(|s| s.weight).sum();
    let mean = samples.iter().map(|s| s.weight * s.radius).sum::<f64>() / total;
    if !(mean > 0.0 && mean.is_finite()) {
        return None;
    }
    let orders = match order {
        Some(order) => vec![order],
        // no more coefficients than half of the samples
        None => {
            ORDERS.into_iter().filter(|order| *order == 1 || 2 * (1 + 2 * order) <= samples.len()).collect()
        }
    };
    let best = |unit: f64| -> Option<Solution> {
        let mut best: Option<Solution> = None;
        // higher orders are looked at where the best one is among the last of the lower ones
        for tried in orders.chunks(AT_ONCE) {
            let factored = Factored::of(&samples, mean, unit, *tried.last()?);
            let solutions = tried.iter().filter_map(|order| factored.solve(*order, samples.len()));
            best = best
                .into_iter()
                .chain(solutions)
                .min_by(|a, b| a.criterion(weights).total_cmp(&b.criterion(weights)));
            let last_but_one = tried.iter().rev().nth(1).or(tried.last()).copied();
            let is_inside = |found: &Solution| last_but_one.is_some_and(|last| found.order() < last);
            if best.as_ref().is_some_and(is_inside) {
                break;
            }
        }
        best
    };
    let found = match weights {
        SupportWeights::InverseVariances => best(1.0)?,
        SupportWeights::Relative => {
            // convexity with nearly no weight at first: the samples have to determine their own size
            let size = UNHEARD * mean * mean * total / samples.len() as f64;
            let first = best(1.0 / size)?;
            let variance = first.cost * size / first.degrees() as f64;
            best(1.0 / variance.max(EXACT * size)).unwrap_or(first)
        }
    };
    let degrees = found.degrees();
    let spread = found.cost / degrees as f64;
    Some(ShapeEstimate {
        support: SupportSeries::of_coefficients(found.coefficients.as_slice()).into(),
        others: Vec::new(),
        covariance: found.covariance * spread.max(1.0),
        samples: samples.len(),
        chi_square: found.cost,
        degrees,
        widened: spread.max(1.0).sqrt(),
    })
}

/// The rows of the least squares problem of the largest order, as a triangle: those of smaller orders are its corner.
struct Factored {
    /// The coefficients' columns, and the right-hand side as the last one.
    triangle: DMatrix<f64>,
}

/// The best coefficients of one order.
struct Solution {
    coefficients: DVector<f64>,
    covariance: DMatrix<f64>,
    cost: f64,
    samples: usize,
}

impl Solution {
    fn order(&self) -> usize {
        self.coefficients.len() / 2
    }

    fn degrees(&self) -> usize {
        self.samples.saturating_sub(self.coefficients.len()).max(1)
    }

    fn criterion(&self, weights: SupportWeights) -> f64 {
        let (n, p) = (self.samples as f64, self.coefficients.len() as f64);
        match weights {
            SupportWeights::InverseVariances => self.cost + p * n.ln(),
            SupportWeights::Relative => n * (self.cost / n).max(f64::MIN_POSITIVE).ln() + p * n.ln(),
        }
    }
}

impl Factored {
    /// Weights are multiplied by `unit`.
    fn of(samples: &[SupportSample], mean: f64, unit: f64, order: usize) -> Factored {
        let p = 1 + 2 * order;
        let mut triangle = DMatrix::zeros(p, p + 1);
        for i in 1..p {
            triangle[(i, i)] = 1.0 / convex_deviation(mean, i.div_ceil(2));
        }
        for block in samples.chunks(ROWS) {
            let mut rows = DMatrix::zeros(triangle.nrows() + block.len(), p + 1);
            rows.rows_mut(0, triangle.nrows()).copy_from(&triangle);
            for (i, sample) in (triangle.nrows()..).zip(block) {
                let root = (sample.weight * unit).sqrt();
                for (j, basis) in SupportSeries::basis(sample.angle, order).iter().enumerate() {
                    rows[(i, j)] = root * basis[0];
                }
                rows[(i, p)] = root * sample.radius;
            }
            triangle = rows.qr().r();
        }
        Factored { triangle }
    }

    fn solve(&self, order: usize, samples: usize) -> Option<Solution> {
        let (p, last) = (1 + 2 * order, self.triangle.ncols() - 1);
        let corner = self.triangle.view((0, 0), (p, p)).into_owned();
        let side = self.triangle.view((0, last), (p, 1)).column(0).into_owned();
        let coefficients = corner.solve_upper_triangular(&side)?;
        let inverse = corner.solve_upper_triangular(&DMatrix::identity(p, p))?;
        let cost = self.triangle.view((p, last), (self.triangle.nrows() - p, 1)).norm_squared();
        let finite = coefficients.iter().chain(inverse.iter()).all(|value| value.is_finite());
        finite.then(|| Solution { coefficients, covariance: &inverse * inverse.transpose(), cost, samples })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::f64::consts::{PI, TAU};

    fn normal(random: &mut ChaCha8Rng) -> f64 {
        let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
        radius * (TAU * random.random::<f64>()).cos()
    }

    fn body() -> SupportSeries {
        let harmonics = vec![[0.01, -0.02], [0.015, 0.0], [0.005, -0.006]];
        SupportSeries { mean: 0.2, harmonics }
    }

    fn read(random: &mut ChaCha8Rng, count: usize, turn: f64, sigma: f64) -> Vec<SupportSample> {
        let angles = (0..count).map(|i| turn * i as f64 / count as f64);
        let read = angles.map(|angle| SupportSample {
            angle,
            radius: body().support(angle)[0] + sigma * normal(random),
            weight: if sigma > 0.0 { sigma.powi(-2) } else { 1e18 },
        });
        read.collect()
    }

    /// All normals, evenly: the columns are orthogonal, and by hand the mean has the variance `sigma^2/n`, each other coefficient twice that.
    #[test]
    fn the_covariance_of_even_samples_is_known() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let samples = read(&mut random, 400, TAU, 1e-4);
        let found = fit_support(&samples, SupportWeights::InverseVariances, Some(3)).unwrap();
        let variance = 1e-8 / 400.0 * found.widened.powi(2);
        for i in 0..7 {
            let expected = if i == 0 { variance } else { 2.0 * variance };
            assert!((found.covariance[(i, i)] / expected - 1.0).abs() < 1e-4, "{i}");
        }
        // at every normal the same: sqrt(7/400) sigma
        let deviation = found.deviation(1.234) / found.widened;
        assert!((deviation / (1e-4 * (7.0f64 / 400.0).sqrt()) - 1.0).abs() < 1e-4);
    }

    /// Over 200 draws the error over the band's deviation has the mean square one within five of its own deviations; so have area and
    /// perimeter. The order is estimated, and is seldom another than the true one.
    #[test]
    fn errors_are_what_the_band_says() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let (body, mut squares, mut right) = (body(), [0.0; 4], 0);
        const DRAWS: usize = 200;
        for draw in 0..DRAWS {
            let weights =
                [SupportWeights::InverseVariances, SupportWeights::Relative][usize::from(draw % 2 == 0)];
            let mut samples = read(&mut random, 60, TAU, 1e-4);
            if weights == SupportWeights::Relative {
                samples.iter_mut().for_each(|sample| sample.weight = 7.0);
            }
            let found = fit_support(&samples, weights, None).unwrap();
            right += usize::from(found.support.order() == 3);
            let off = |angle: f64| {
                (found.support.support(angle)[0] - body.support(angle)[0]) / found.deviation(angle)
            };
            let (area, perimeter) = (found.area(), found.perimeter());
            let offs = [
                off(0.4),
                off(3.0),
                (area.value - body.area()) / area.deviation,
                (perimeter.value - body.perimeter()) / perimeter.deviation,
            ];
            squares.iter_mut().zip(offs).for_each(|(sum, off)| *sum += off * off);
        }
        assert!(right > DRAWS * 3 / 5, "{right}");
        for square in squares {
            let mean = square / DRAWS as f64;
            assert!((mean - 1.0).abs() < 5.0 * (2.0 / DRAWS as f64).sqrt(), "{squares:?}");
        }
    }

    /// Samples without error: the body itself, to rounding; and the band where nothing was touched is as wide as convexity allows.
    #[test]
    fn what_is_exact_stays_exact_and_what_is_untouched_is_wide() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let found =
            fit_support(&read(&mut random, 400, TAU, 0.0), SupportWeights::InverseVariances, None).unwrap();
        assert_eq!(found.support.order(), 3);
        let worst = |found: &ShapeEstimate, end: f64| {
            let at = |i: i32| end * f64::from(i) / 200.0;
            let off = |angle: f64| (found.support.support(angle)[0] - body().support(angle)[0]).abs();
            (0..200).map(|i| off(at(i))).fold(0.0, f64::max)
        };
        assert!(worst(&found, TAU) < 1e-14, "{:e}", worst(&found, TAU));

        let half = fit_support(&read(&mut random, 400, PI, 1e-4), SupportWeights::InverseVariances, Some(24))
            .unwrap();
        assert!(worst(&half, PI) < 2e-4);
        let gap = half.deviation(1.5 * PI);
        assert!(gap > 0.01 && gap < 0.5, "{gap}");
        let off = (half.support.support(1.5 * PI)[0] - body().support(1.5 * PI)[0]).abs();
        assert!(off < 3.0 * gap, "{off} of {gap}");
    }

    #[test]
    fn nothing_gives_nothing() {
        let sample = |radius: f64, weight: f64| SupportSample { angle: 0.0, radius, weight };
        for samples in
            [vec![], vec![sample(f64::NAN, 1.0)], vec![sample(1.0, 0.0)], vec![sample(-1.0, 1.0); 9]]
        {
            assert!(fit_support(&samples, SupportWeights::InverseVariances, None).is_none());
            assert!(fit_support(&samples, SupportWeights::Relative, None).is_none());
        }
        // one sample is one: the rest is convexity's
        let one = fit_support(&[sample(1.0, 1e6)], SupportWeights::InverseVariances, None).unwrap();
        assert!(one.deviation(0.0) < 1e-2 && one.deviation(3.0) > 0.5);
    }
}
