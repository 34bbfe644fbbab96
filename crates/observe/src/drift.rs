//! Whether residuals drift: whether the residuals of an output follow a slow curve that no fitted unknown explains.
//!
//! The residual of a slow error of the model, a gyro's bias or a gain, is smaller than the noise at each sample and has the same sign at hundreds of them. The
//! sum of the squares does not notice it, nor do neighbours, whose products are lost among those of the noise. Of residuals `r = M e`, with `M` the projector
//! off what the unknowns follow and errors `e` that are independent and of one size, the part along orthonormal columns `B = M B` is `B^T e`: its square is
//! that of as many errors as there are columns. Here these are the polynomials of the lowest degrees over the samples of one output (score test against a
//! polynomial trend; C. R. Rao, Large sample tests of statistical hypotheses, 1948).

use super::chi_square::exceeded;
use nalgebra::{DMatrix, DVector};

/// Polynomials up to this degree are slow curves.
const DEGREE: usize = 3;
/// An output with fewer samples than these is not tested for slow curves.
const FEWEST: usize = 12;
/// A polynomial that the unknowns follow but for less than this part is not tested: an estimate that has not quite converged would fail there.
const LEAST_LEFT: f64 = 0.1;

/// How unlikely the slow part of the residuals is, were the model right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Which output it is most unlikely of, by its place among those of the model.
    pub output: usize,
    /// How likely so large a slow part is in any of the outputs (Z. Šidák, Rectangular confidence regions, 1967); no more than that where they share what was fitted.
    pub probability: f64,
}

/// Residuals whose errors are independent and of one size, and what the unknowns follow of them.
pub(super) struct Trend<'a> {
    /// The residuals, in units of the size of their errors; those that do not count are zero.
    pub residuals: &'a DVector<f64>,
    /// Orthonormal: what the unknowns follow.
    pub followed: &'a DMatrix<f64>,
    /// Outputs a sample.
    pub outputs: usize,
    /// The largest norm of what rounding and computation add, over all samples of an output and however it is correlated, in the same unit.
    pub coherent: f64,
}

/// The polynomials over the samples of an output, by columns: of so many rows those whose place `counts`.
pub(super) fn slow_curves(
    rows: usize,
    (outputs, output, relations): (usize, usize, usize),
    counts: impl Fn(usize) -> bool,
) -> Option<DMatrix<f64>> {
    let places: Vec<usize> =
        (relations + output..rows).step_by(outputs.max(1)).filter(|place| counts(*place)).collect();
    if places.len() < FEWEST {
        return None;
    }
    let (first, last) = (places[0] as f64, places[places.len() - 1] as f64);
    let mut curves = DMatrix::zeros(rows, DEGREE + 1);
    for place in places {
        let x = (2.0 * place as f64 - first - last) / (last - first);
        // Legendre's, which are nearly orthogonal here
        let (mut before, mut now) = (0.0, 1.0);
        for degree in 0..=DEGREE {
            curves[(place, degree)] = now;
            let n = degree as f64;
            (before, now) = (now, ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0));
        }
    }
    Some(curves)
}

impl Trend<'_> {
    /// The test, of the slow curves of each output that has any; none where no output has.
    pub fn drift(&self, curves: impl Fn(usize) -> Option<DMatrix<f64>>) -> Option<Drift> {
        let of = |output: usize| Some((output, self.tail(curves(output)?)?));
        let tails: Vec<(usize, f64)> = (0..self.outputs).filter_map(of).collect();
        let (output, least) = tails.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let probability = -(tails.len() as f64 * (-least).ln_1p()).exp_m1();
        Some(Drift { output, probability })
    }

    /// How likely so large a part of the residuals along some columns is; none where the unknowns follow all of these.
    fn tail(&self, mut curves: DMatrix<f64>) -> Option<f64> {
        let lengths: Vec<f64> = curves.column_iter().map(|column| column.norm()).collect();
        // twice is enough (W. Kahan, in B. N. Parlett, The Symmetric Eigenvalue Problem, 1980)
        for _ in 0..2 {
            let inner = self.followed.tr_mul(&curves);
            curves -= self.followed * inner;
        }
        let mut kept: Vec<DVector<f64>> = Vec::new();
        for (column, length) in curves.column_iter().zip(lengths) {
            let mut own = column.clone_owned();
            for _ in 0..2 {
                kept.iter().for_each(|other| own.axpy(-other.dot(&own), other, 1.0));
            }
            let left = own.norm();
            if left > LEAST_LEFT * length {
                kept.push(own / left);
            }
        }
        if kept.is_empty() {
            return None;
        }
        let part = kept.iter().map(|own| own.dot(self.residuals).powi(2)).sum::<f64>().sqrt();
        match part - self.coherent {
            rest if rest.is_nan() => Some(0.0),
            rest if rest <= 0.0 => Some(1.0),
            rest => Some(exceeded(rest * rest, kept.len() as f64)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const SAMPLES: usize = 200;

    fn normal(random: &mut ChaCha8Rng) -> f64 {
        let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
    }

    fn at(place: usize) -> f64 {
        (place / 2) as f64 / SAMPLES as f64
    }

    /// Of the residuals of the best straight lines through errors, one for both of two outputs or one for each, with what is added to the first output.
    fn drift(random: &mut ChaCha8Rng, lines: usize, added: impl Fn(f64) -> f64, coherent: f64) -> Drift {
        let coherent = coherent * (SAMPLES as f64).sqrt();
        let slopes = DMatrix::from_fn(2 * SAMPLES, 2 * lines, |i, k| {
            if i % lines == k / 2 { at(i).powi(k as i32 % 2) } else { 0.0 }
        });
        let read = DVector::from_fn(2 * SAMPLES, |i, _| {
            normal(random) + if i % 2 == 0 { added(at(i)) } else { 0.0 }
        });
        let followed = slopes.qr().q();
        let residuals = &read - &followed * followed.tr_mul(&read);
        let known = Trend { residuals: &residuals, followed: &followed, outputs: 2, coherent };
        known.drift(|output| slow_curves(2 * SAMPLES, (2, output, 0), |_| true)).unwrap()
    }

    /// Of right residuals the probability is even where outputs share no unknowns; where they do, the residuals of one depend on those of the other, and small
    /// probabilities are rarer: by the largest distances of 400 of them, and Kolmogorov's limit of one in a thousand.
    #[test]
    fn of_right_residuals_it_is_even() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for lines in [1, 2] {
            let mut all: Vec<f64> =
                (0..400).map(|_| drift(&mut random, lines, |_| 0.0, 0.0).probability).collect();
            all.sort_by(f64::total_cmp);
            let n = all.len() as f64;
            let below = |(i, p): (usize, &f64)| (i + 1) as f64 / n - p;
            let above = |(i, p): (usize, &f64)| p - i as f64 / n;
            let most = |of: &dyn Fn((usize, &f64)) -> f64| all.iter().enumerate().map(of).fold(0.0, f64::max);
            let limit = 1.95 / n.sqrt();
            assert!(most(&below) < limit, "{lines}: {}", most(&below));
            assert!(lines == 1 || most(&above) < limit, "{lines}: {}", most(&above));
        }
    }

    /// A curve of half a deviation is found, and its output is named; not where rounding may have made it.
    #[test]
    fn a_slow_curve_below_the_noise_is_told() {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let slow = |t: f64| 6.0 * (t - 0.5).powi(2);
        let found = drift(&mut random, 2, slow, 0.0);
        assert!(found.output == 0 && found.probability < 1e-3, "{found:?}");
        assert!(drift(&mut random, 2, slow, 0.75).probability > 0.1);
        // seven periods are no slow curve
        assert!(drift(&mut random, 2, |t| 0.5 * (44.0 * t).sin(), 0.0).probability > 1e-3);
    }

    #[test]
    fn of_few_samples_and_of_what_is_followed_nothing_is_told() {
        assert!(slow_curves(22, (2, 0, 0), |_| true).is_none());
        assert!(slow_curves(26, (2, 1, 2), |place| place != 5).is_none());
        assert!(slow_curves(26, (2, 1, 2), |_| true).is_some());
        let followed = slow_curves(40, (1, 0, 0), |_| true).unwrap().qr().q();
        let residuals = DVector::from_element(40, 1.0);
        let known = Trend { residuals: &residuals, followed: &followed, outputs: 1, coherent: 0.0 };
        assert_eq!(known.drift(|output| slow_curves(40, (1, output, 0), |_| true)), None);
        let unknown = DVector::from_element(40, f64::NAN);
        let none = DMatrix::zeros(40, 0);
        let known = Trend { residuals: &unknown, followed: &none, outputs: 1, coherent: 0.0 };
        assert_eq!(known.drift(|output| slow_curves(40, (1, output, 0), |_| true)).unwrap().probability, 0.0);
    }
}
