//! Polynomials through the samples about a time: values, slopes, integrals, on uneven times.

use std::ops::Range;

/// The samples about a time.
pub(super) struct Stencil<'a> {
    first: usize,
    times: &'a [f64],
}

impl<'a> Stencil<'a> {
    /// So many samples, as evenly on both sides as the ends allow.
    pub fn about(times: &'a [f64], time: f64, points: usize) -> Stencil<'a> {
        let points = points.min(times.len());
        let after = times.partition_point(|t| *t < time);
        let first = (after.max(points / 2) - points / 2).min(times.len() - points);
        Stencil { first, times: &times[first..first + points] }
    }

    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.times.len()
    }

    /// The weight of each sample in the value at a time (Lagrange).
    pub fn value_weights(&self, time: f64) -> Vec<f64> {
        self.weights(time).0
    }

    /// The weight of each sample in the slope there.
    pub fn slope_weights(&self, time: f64) -> Vec<f64> {
        self.weights(time).1
    }

    /// Values and slopes by B. Fornberg's recursion (Mathematics of Computation 51, 1988).
    fn weights(&self, time: f64) -> (Vec<f64>, Vec<f64>) {
        let x = self.times;
        let n = x.len();
        let (mut value, mut slope) = (vec![0.0; n], vec![0.0; n]);
        if n == 0 {
            return (value, slope);
        }
        value[0] = 1.0;
        let mut before = 1.0;
        let mut last = x[0] - time;
        for i in 1..n {
            let mut product = 1.0;
            let previous = last;
            last = x[i] - time;
            for j in 0..i {
                let apart = x[i] - x[j];
                product *= apart;
                if j == i - 1 {
                    slope[i] = before * (value[j] - previous * slope[j]) / product;
                    value[i] = -before * previous * value[j] / product;
                }
                slope[j] = (last * slope[j] - value[j]) / apart;
                value[j] = last * value[j] / apart;
            }
            before = product;
        }
        (value, slope)
    }
}

/// Gauss and Legendre's nodes and weights on [-1, 1]: exact to degree nine.
const GAUSS: [[f64; 2]; 5] = [
    [-0.906_179_845_938_664, 0.236_926_885_056_189_08],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.906_179_845_938_664, 0.236_926_885_056_189_08],
];

/// The slopes of a column at its samples.
pub(crate) fn derivative(times: &[f64], column: &[f64], points: usize) -> Vec<f64> {
    let at = |time: &f64| -> f64 {
        let stencil = Stencil::about(times, *time, points);
        stencil.slope_weights(*time).iter().zip(&column[stencil.range()]).map(|(w, x)| w * x).sum()
    };
    times.iter().map(at).collect()
}

/// The integral of a column from the first sample to each.
pub(super) fn integral(times: &[f64], column: &[f64], points: usize) -> Vec<f64> {
    let mut total = 0.0;
    let mut all = vec![0.0; times.len().min(1)];
    for ends in times.windows(2) {
        let (middle, half) = (f64::midpoint(ends[0], ends[1]), (ends[1] - ends[0]) / 2.0);
        let stencil = Stencil::about(times, middle, points);
        for [node, weight] in GAUSS {
            let weights = stencil.value_weights(middle + half * node);
            let value: f64 = weights.iter().zip(&column[stencil.range()]).map(|(w, x)| w * x).sum();
            total += half * weight * value;
        }
        all.push(total);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of the degree that the samples carry are exact, on uneven times.
    #[test]
    fn polynomials_are_exact() {
        let times: Vec<f64> = (0..12).map(|i| f64::from(i) + 0.3 * f64::from(i * i % 5) / 5.0).collect();
        let cubic = |t: f64| 0.3 + t * (1.0 - t * (0.2 - 0.01 * t));
        let column: Vec<f64> = times.iter().map(|t| cubic(*t)).collect();
        for (t, slope) in times.iter().zip(derivative(&times, &column, 6)) {
            assert!((slope - (1.0 - 0.4 * t + 0.03 * t * t)).abs() < 1e-12);
        }
        let primitive = |t: f64| t * (0.3 + t * (0.5 - t * (0.2 / 3.0 - 0.01 / 4.0 * t)));
        for (t, total) in times.iter().zip(integral(&times, &column, 6)) {
            assert!((total - (primitive(*t) - primitive(times[0]))).abs() < 1e-11);
        }
        assert!(integral(&[], &[], 6).is_empty());
    }
}
