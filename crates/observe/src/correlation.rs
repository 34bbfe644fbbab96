//! Whether neighbouring residuals agree more than independent errors of a known size let them.
//!
//! The residuals of a wrong model follow a curve, and neighbours on a curve are alike, even where the sum of the squares is what noise makes. The
//! statistic is `S = sum r_i r_(i+1)` over the samples of each output. Of residuals `r = M e`, with `M = 1 - Q Q^T` the projector off what the
//! unknowns follow, `S = r^T A r` has the mean `tr(A M)` and the variance `2 tr(A M A M)`, both in units of the errors (G. E. P. Box, G. M. Jenkins,
//! Time Series Analysis, 1970, chapter 8, without the projector; A. M. Mathai, S. B. Provost, Quadratic Forms in Random Variables, 1992, for it).

use super::chi_square::exceeded;
use nalgebra::DMatrix;

/// Fewer pairs of neighbours than these are not tested.
const FEWEST: usize = 12;

/// Residuals, and what is known of their errors.
pub(super) struct Neighbours<'a> {
    /// In the unit of the measurements, sample by sample; none where a measurement is left out.
    pub residuals: &'a [Option<f64>],
    /// The places where nothing was measured, in their order: neighbours are those before and after them.
    pub unmeasured: &'a [usize],
    /// Outputs a sample: so many places further is the same output, one sample later.
    pub outputs: usize,
    /// So many of the first are no measurements.
    pub relations: usize,
    /// Their derivatives by the unknowns.
    pub slopes: &'a DMatrix<f64>,
    /// By how much the sum of the squares falls for each unknown (`Loss::taken`): one for least squares.
    pub taken: f64,
    /// The standard deviation of an error.
    pub sigma: f64,
    /// What rounding and computation may add to each, however these are correlated.
    pub coherent: f64,
}

impl Neighbours<'_> {
    /// The probability that right residuals have neighbours that agree so much.
    ///
    /// Residuals that are smaller than their stated errors agree by no more than they are large, and pass. None where too few are left to tell.
    pub fn probability(&self) -> Option<f64> {
        let measured = |place: &usize| self.unmeasured.binary_search(place).is_err();
        let next = |i: usize| (i + self.outputs..self.residuals.len()).step_by(self.outputs).find(measured);
        let pairs: Vec<(usize, usize)> = (self.relations..self.residuals.len())
            .filter(|i| self.residuals[*i].is_some())
            .filter_map(|i| next(i).map(|j| (i, j)))
            .filter(|(_, j)| self.residuals[*j].is_some())
            .collect();
        if pairs.len() < FEWEST {
            return None;
        }
        let value = |i: usize| self.residuals[i].unwrap_or(0.0);
        let sum: f64 = pairs.iter().map(|(i, j)| value(*i) * value(*j)).sum();
        let count = self.residuals.iter().flatten().count();
        let square: f64 = self.residuals.iter().flatten().map(|value| value * value).sum();
        let degrees = count.saturating_sub(self.slopes.ncols()).max(1) as f64;
        // larger residuals than stated are a matter of the sum of squares; smaller ones are compared with what was stated
        let own = square / degrees;
        let variance = own.max(self.sigma * self.sigma);
        let (mean, spread) = self.moments(&pairs)?;
        let coherent = self.coherent * self.coherent;
        let above = sum - pairs.len() as f64 * coherent - mean * own;
        let deviation = (spread * (variance * variance + 4.0 * coherent * variance)).sqrt();
        let tail = exceeded((above / deviation).powi(2), 1.0) / 2.0;
        Some(match above / deviation {
            z if z.is_nan() => 0.0,
            z if z > 0.0 => tail,
            _ => 1.0 - tail,
        })
    }

    /// Mean and variance of the statistic of errors of size one; none where too few degrees of freedom remain.
    fn moments(&self, pairs: &[(usize, usize)]) -> Option<(f64, f64)> {
        let q = self.slopes.clone().qr().q();
        let mean: f64 = -self.taken * pairs.iter().map(|(i, j)| q.row(*i).dot(&q.row(*j))).sum::<f64>();
        let mut moved = DMatrix::zeros(q.nrows(), q.ncols());
        for (i, j) in pairs {
            for k in 0..q.ncols() {
                moved[(*i, k)] += 0.5 * q[(*j, k)];
                moved[(*j, k)] += 0.5 * q[(*i, k)];
            }
        }
        let inner = q.tr_mul(&moved);
        let own = pairs.len() as f64;
        let spread = own - 4.0 * moved.norm_squared() + 2.0 * inner.norm_squared();
        (spread > own / 4.0 && mean.is_finite()).then_some((mean, spread))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn normal(random: &mut ChaCha8Rng) -> f64 {
        let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
    }

    /// The residuals of the best parabola through errors, with what is added to them, of two outputs that share it.
    fn probability(random: &mut ChaCha8Rng, sigma: f64, added: impl Fn(f64) -> f64, coherent: f64) -> f64 {
        const SAMPLES: usize = 60;
        let at = |i: usize| (i / 2) as f64 / SAMPLES as f64;
        let slopes = DMatrix::from_fn(2 * SAMPLES, 3, |i, k| at(i).powi(k as i32));
        let read = nalgebra::DVector::from_fn(2 * SAMPLES, |i, _| sigma * normal(random) + added(at(i)));
        let q = slopes.clone().qr().q();
        let left = &read - &q * q.tr_mul(&read);
        let residuals: Vec<Option<f64>> = left.iter().map(|value| Some(*value)).collect();
        let known = Neighbours {
            residuals: &residuals,
            unmeasured: &[],
            outputs: 2,
            relations: 0,
            slopes: &slopes,
            taken: 1.0,
            sigma: 0.1,
            coherent,
        };
        known.probability().unwrap()
    }

    /// Of right residuals the probability is even: the largest distance from that of 400 of them, by Kolmogorov's limit of one in a thousand.
    #[test]
    fn of_right_residuals_it_is_even() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut all: Vec<f64> = (0..400).map(|_| probability(&mut random, 0.1, |_| 0.0, 0.0)).collect();
        all.sort_by(f64::total_cmp);
        let n = all.len() as f64;
        let apart = |(i, p): (usize, &f64)| (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs());
        let most = all.iter().enumerate().map(apart).fold(0.0, f64::max);
        assert!(most < 1.95 / n.sqrt(), "{most}");
    }

    #[test]
    fn a_curve_is_told_and_what_is_smaller_than_its_errors_is_not() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let wave = |size: f64| move |t: f64| size * (9.0 * t).sin();
        assert!(probability(&mut random, 0.1, wave(0.25), 0.0) < 1e-4);
        // the same curve where errors of ten times the size are stated, and where rounding may have made it
        assert!(probability(&mut random, 0.0, wave(0.01), 0.0) > 0.1);
        assert!(probability(&mut random, 0.1, wave(0.25), 0.2) > 0.1);
    }
}
