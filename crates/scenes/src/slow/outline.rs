//! A support function whose curvature has kinks: a Fourier polynomial, and a tail determined by a few jumps of its higher derivatives.
//!
//! A periodic function that is smooth except for jumps `J_m` of its `m`th derivative at an angle `t` has the Fourier coefficients `sum J_m e^(-ikt)/(2 pi (ik)^(m+1))` beyond those of its smooth
//! part. For one jump of 1 they add up to `-(2 pi)^m/(m+1)! B_(m+1)(x)` with Bernoulli's polynomials, `x` the fraction of a turn since the jump. Splines have jumps of the third derivative and of all
//! higher ones where their pieces meet; three of them leave coefficients that fall by `k^-7`. The free harmonics are removed from the tail, so that both are independent.

use nalgebra::DMatrix;
use palmistry_bodies::shape::SupportSeries;
use std::f64::consts::{PI, TAU};

/// Jumps that are estimated at one angle: of the third derivative and the two after it.
const JUMPS: usize = 3;

/// Coefficients of a kink: its jumps and its angle.
pub(super) const OF_KINK: usize = JUMPS + 1;

/// Where the radius of curvature has a kink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kink {
    /// The jumps of the support function's third, fourth and fifth derivative, in m.
    pub jumps: [f64; JUMPS],
    /// The normal's angle in the body's frame, in rad.
    pub angle: f64,
}

/// A support function with kinks of its curvature. Its coefficients are those of the series, then those of each kink: the jumps and the angle.
pub(super) struct Outline {
    series: SupportSeries,
    pub kinks: Vec<Kink>,
}

/// Bernoulli's polynomials of the degrees 0 to 6, at a fraction of a turn.
fn bernoulli(x: f64) -> [f64; 7] {
    let square = x * x;
    [
        1.0,
        x - 0.5,
        square - x + 1.0 / 6.0,
        x * (square - 1.5 * x + 0.5),
        square * (square - 2.0 * x + 1.0) - 1.0 / 30.0,
        x * (square * (square - 2.5 * x + 5.0 / 3.0) - 1.0 / 6.0),
        square * (square * (square - 3.0 * x + 2.5) - 0.5) + 1.0 / 42.0,
    ]
}

/// The real part of `e^(ik a)/(ik)^n`, by the sine and cosine of `k a`.
fn integrated(n: usize, sine: f64, cosine: f64) -> f64 {
    match n % 4 {
        0 => cosine,
        1 => sine,
        2 => -cosine,
        _ => -sine,
    }
}

/// For a unit jump of the derivative `n - 1` at the angle 0, the part beyond the free harmonics, at index `n`. Index zero, a point mass, has none.
fn tails(angle: f64, order: usize) -> [f64; 7] {
    let polynomials = bernoulli((angle / TAU).rem_euclid(1.0));
    let mut found = [0.0; 7];
    let mut factor = -1.0 / TAU;
    for (n, polynomial) in polynomials.into_iter().enumerate().skip(1) {
        factor *= TAU / n as f64;
        found[n] = factor * polynomial;
    }
    let (step_sine, step_cosine) = angle.sin_cos();
    let (mut sine, mut cosine) = (0.0, 1.0);
    for k in 1..=order {
        (sine, cosine) = (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
        let part = 1.0 / k as f64;
        let mut power = 1.0 / PI;
        for (n, tail) in found.iter_mut().enumerate().skip(1) {
            power *= part;
            *tail -= power * integrated(n, sine, cosine);
        }
    }
    found
}

/// [`SupportSeries::support`], with two sines for all harmonics together: a search evaluates it some millions of times. Each is off by no more than `k` roundings.
fn summed(series: &SupportSeries, angle: f64) -> [f64; 4] {
    let mut value = [series.mean, 0.0, 0.0, 0.0];
    let (step_sine, step_cosine) = angle.sin_cos();
    let (mut sine, mut cosine) = (0.0, 1.0);
    for (k, [a, b]) in (1..).zip(&series.harmonics) {
        (sine, cosine) = (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
        let k = f64::from(k);
        let (even, odd) = (a * cosine + b * sine, k * (b * cosine - a * sine));
        value[0] += even;
        value[1] += odd;
        value[2] -= k * k * even;
        value[3] -= k * k * odd;
    }
    value
}

impl Outline {
    pub fn of(coefficients: &[f64], kinks: usize) -> Outline {
        let (series, rest) = coefficients.split_at(coefficients.len() - OF_KINK * kinks);
        let kink = |at: &[f64]| Kink { jumps: [at[0], at[1], at[2]], angle: at[3] };
        Outline {
            series: SupportSeries::of_coefficients(series),
            kinks: rest.chunks_exact(OF_KINK).map(kink).collect(),
        }
    }

    pub fn order(&self) -> usize {
        self.series.order()
    }

    /// `[r, r', r'', r''']`.
    pub fn support(&self, angle: f64) -> [f64; 4] {
        let mut value = summed(&self.series, angle);
        for kink in &self.kinks {
            let tails = tails(angle - kink.angle, self.order());
            for (times, derivative) in value.iter_mut().enumerate() {
                *derivative += (0..JUMPS).map(|q| kink.jumps[q] * tails[4 + q - times]).sum::<f64>();
            }
        }
        value
    }

    /// The derivatives of `[r, r', r'']` by the coefficients; the fourth entry is unused.
    pub fn basis(&self, angle: f64) -> Vec<[f64; 4]> {
        let mut basis = SupportSeries::basis(angle, self.order());
        for kink in &self.kinks {
            let tails = tails(angle - kink.angle, self.order());
            for q in 0..JUMPS {
                basis.push([0, 1, 2, 3].map(|times| tails[4 + q - times]));
            }
            let moved = |times: usize| -(0..JUMPS).map(|q| kink.jumps[q] * tails[3 + q - times]).sum::<f64>();
            basis.push([0, 1, 2, 3].map(moved));
        }
        basis
    }

    /// The series with the first harmonics of its tail, up to the given order.
    pub fn expanded(&self, order: usize) -> SupportSeries {
        let mut coefficients = self.series.coefficients();
        coefficients.resize(1 + 2 * order.max(self.order()), 0.0);
        let rows = self.by_own(order);
        for (j, kink) in self.kinks.iter().enumerate() {
            let first = 1 + 2 * self.order() + OF_KINK * j;
            for (place, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient += (0..JUMPS).map(|q| kink.jumps[q] * rows[(place, first + q)]).sum::<f64>();
            }
        }
        SupportSeries::of_coefficients(&coefficients)
    }

    /// The derivatives of the expanded series' coefficients by those of this one.
    pub fn by_own(&self, order: usize) -> DMatrix<f64> {
        let free = 1 + 2 * self.order();
        let mut rows = DMatrix::zeros(1 + 2 * order.max(self.order()), free + OF_KINK * self.kinks.len());
        (0..free).for_each(|i| rows[(i, i)] = 1.0);
        for (j, kink) in self.kinks.iter().enumerate() {
            let first = free + OF_KINK * j;
            for k in self.order() + 1..=order {
                // cos(ka) of e^(ik(a - t))/(ik)^n stands at -t, sin(ka) a quarter of a turn before
                let (sine, cosine) = (-(k as f64) * kink.angle).sin_cos();
                for (place, [sine, cosine]) in [(2 * k - 1, [sine, cosine]), (2 * k, [cosine, -sine])] {
                    let at = |n: usize| integrated(n, sine, cosine) / (PI * (k as f64).powi(n as i32));
                    for q in 0..JUMPS {
                        rows[(place, first + q)] = at(4 + q);
                    }
                    rows[(place, first + JUMPS)] =
                        -(0..JUMPS).map(|q| kink.jumps[q] * at(3 + q)).sum::<f64>();
                }
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COEFFICIENTS: [f64; 13] = [1.0, 0.0, 0.0, 0.02, 0.01, 0.3, -0.2, 0.1, 0.7, -0.1, 0.4, 0.2, 3.0];

    /// The tail against its Fourier series, summed: the terms left out are below `k^-4` by Euler and Maclaurin.
    #[test]
    fn the_tail_is_the_sum_of_its_harmonics() {
        let outline = Outline::of(&COEFFICIENTS, 2);
        assert_eq!((outline.order(), outline.kinks.len()), (2, 2));
        let expanded = outline.expanded(3000);
        for angle in [0.1, 0.69, 0.71, 2.0, 2.99, 3.01, 5.9] {
            let (whole, summed) = (outline.support(angle), expanded.support(angle));
            for (times, most) in [1e-11, 1e-8, 4e-5].into_iter().enumerate() {
                assert!((whole[times] - summed[times]).abs() < most, "{angle} {times}: {whole:?} {summed:?}");
            }
        }
        // the third derivative jumps by the kink's jump, the others are continuous
        let [before, after] = [0.7 - 1e-9, 0.7 + 1e-9].map(|angle| outline.support(angle));
        assert!((after[3] - before[3] - 0.3).abs() < 1e-7 && (after[2] - before[2]).abs() < 1e-8);
    }

    /// Against the series' own sines, each taken by itself.
    #[test]
    fn a_series_is_summed_as_it_is() {
        let order = 200;
        let falling = |k: usize| [0.3, -0.2].map(|part| part / (k as f64).powi(4));
        let series = SupportSeries { mean: 1.0, harmonics: (1..=order).map(falling).collect() };
        let outline = Outline::of(&series.coefficients(), 0);
        for angle in [-700.0, -3.0, 0.0, 0.7, 2.0, 40.0] {
            let pairs = outline.support(angle).into_iter().zip(series.support(angle));
            for (times, (summed, own)) in pairs.enumerate() {
                // `sum k^times k^-4` roundings of `k` and of the angle's multiples
                let size: f64 = (1..=order).map(|k| (k as f64).powi(times as i32 - 3)).sum();
                assert!(
                    (summed - own).abs() < 4.0 * (1.0 + angle.abs()) * size * f64::EPSILON,
                    "{angle} {times}"
                );
            }
        }
    }

    /// Differences of the function and of its expansion.
    #[test]
    fn the_basis_is_the_derivative_by_the_coefficients() {
        let outline = Outline::of(&COEFFICIENTS, 2);
        let by_own = outline.by_own(6);
        for angle in [0.3, 1.9, 4.4] {
            let basis = outline.basis(angle);
            for place in 0..COEFFICIENTS.len() {
                let moved = |by: f64| {
                    let mut moved = COEFFICIENTS;
                    moved[place] += by;
                    Outline::of(&moved, 2)
                };
                let (up, down) = (moved(1e-5), moved(-1e-5));
                for (times, basis) in basis[place].iter().take(3).enumerate() {
                    let slope = (up.support(angle)[times] - down.support(angle)[times]) / 2e-5;
                    assert!((slope - basis).abs() < 1e-7, "{angle} {place} {times}");
                }
                let (up, down) = (up.expanded(6).coefficients(), down.expanded(6).coefficients());
                for (row, (up, down)) in up.iter().zip(&down).enumerate() {
                    assert!(((up - down) / 2e-5 - by_own[(row, place)]).abs() < 1e-9, "{place} {row}");
                }
            }
        }
    }
}
