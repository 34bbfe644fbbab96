//! A closed support function: a Fourier polynomial of the normal's angle.

use std::f64::consts::{PI, TAU};

/// A support function about a point, `r(a) = a_0 + sum a_k cos(k a) + b_k sin(k a)`: how far the body reaches in the direction of the
/// outward normal with the angle `a` (rad, in the body's frame), in m.
#[derive(Clone, Debug, PartialEq)]
pub struct SupportSeries {
    /// `a_0`, the mean radius.
    pub mean: f64,
    /// `[a_k, b_k]` from `k = 1` on; the first of them moves the body without changing it.
    pub harmonics: Vec<[f64; 2]>,
}

impl SupportSeries {
    /// From the coefficients `a_0, a_1, b_1, a_2, b_2, ...`; zero where there are none.
    pub fn of_coefficients(coefficients: &[f64]) -> SupportSeries {
        let harmonics = coefficients.get(1..).unwrap_or_default().chunks_exact(2);
        SupportSeries {
            mean: coefficients.first().copied().unwrap_or(0.0),
            harmonics: harmonics.map(|pair| [pair[0], pair[1]]).collect(),
        }
    }

    /// The coefficients `a_0, a_1, b_1, a_2, b_2, ...`.
    pub fn coefficients(&self) -> Vec<f64> {
        std::iter::once(self.mean).chain(self.harmonics.iter().flatten().copied()).collect()
    }

    /// `k` of the last harmonic.
    pub fn order(&self) -> usize {
        self.harmonics.len()
    }

    /// The derivatives by the coefficients, in their order, of `[r, r', r'', r''']` at an angle.
    pub fn basis(angle: f64, order: usize) -> Vec<[f64; 4]> {
        let mut basis = Vec::with_capacity(1 + 2 * order);
        basis.push([1.0, 0.0, 0.0, 0.0]);
        let (step_sine, step_cosine) = angle.sin_cos();
        let (mut sine, mut cosine) = (0.0, 1.0);
        for k in 1..=order {
            // one turn more: each is off by no more than k roundings
            (sine, cosine) =
                (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
            let k = k as f64;
            basis.push([cosine, -k * sine, -k * k * cosine, k * k * k * sine]);
            basis.push([sine, k * cosine, -k * k * sine, -k * k * k * cosine]);
        }
        basis
    }

    /// `[r, r', r'', r''']` at an angle, in m.
    pub fn support(&self, angle: f64) -> [f64; 4] {
        let mut value = [self.mean, 0.0, 0.0, 0.0];
        let (step_sine, step_cosine) = angle.sin_cos();
        let (mut sine, mut cosine) = (0.0, 1.0);
        for (k, [a, b]) in (1..).zip(&self.harmonics) {
            // one turn more: each is off by no more than k roundings
            (sine, cosine) =
                (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
            let k = f64::from(k);
            let (even, odd) = (a * cosine + b * sine, b * cosine - a * sine);
            value[0] += even;
            value[1] += k * odd;
            value[2] -= k * k * even;
            value[3] -= k * k * k * odd;
        }
        value
    }

    /// The boundary point with the outward normal at this angle, `r u + r' u'`, in m.
    pub fn point(&self, angle: f64) -> [f64; 2] {
        let ([r, slope, ..], (sine, cosine)) = (self.support(angle), angle.sin_cos());
        [r * cosine - slope * sine, r * sine + slope * cosine]
    }

    /// The radius of curvature `r + r''` there, in m.
    pub fn radius_of_curvature(&self, angle: f64) -> f64 {
        let [r, _, second, _] = self.support(angle);
        r + second
    }

    /// `int r da` over a turn, in m: the perimeter where it is convex.
    pub fn perimeter(&self) -> f64 {
        TAU * self.mean
    }

    /// `1/2 int r^2 - r'^2 da` over a turn, in m^2: the area where it is convex.
    pub fn area(&self) -> f64 {
        let harmonics = (1..).zip(&self.harmonics);
        let sum: f64 = harmonics.map(|(k, [a, b])| (1.0 - f64::from(k * k)) * (a * a + b * b)).sum();
        PI * self.mean * self.mean + PI / 2.0 * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ellipse has the support function `sqrt(a^2 cos^2 + b^2 sin^2)`; its series by the trapezoidal rule converges geometrically. Area
    /// `pi a b`, and the point `(a^2 cos, b^2 sin)/r` lies on it.
    #[test]
    fn an_ellipse_has_its_area_and_its_points() {
        let (a, b): (f64, f64) = (1.3, 0.9);
        let support = |angle: f64| (a * angle.cos()).hypot(b * angle.sin());
        const N: usize = 256;
        let coefficient = |k: usize, wave: fn(f64) -> f64| -> f64 {
            let at = |i: usize| TAU * i as f64 / N as f64;
            (0..N).map(|i| support(at(i)) * wave(k as f64 * at(i))).sum::<f64>() / N as f64
        };
        let harmonics = (1..60).map(|k| [2.0 * coefficient(k, f64::cos), 2.0 * coefficient(k, f64::sin)]);
        let series = SupportSeries { mean: coefficient(0, f64::cos), harmonics: harmonics.collect() };
        assert!((series.area() - PI * a * b).abs() < 1e-13);
        for i in 0..20 {
            let angle = 0.3 * f64::from(i);
            let ([x, y], r) = (series.point(angle), support(angle));
            let exact = [a * a * angle.cos() / r, b * b * angle.sin() / r];
            assert!((x - exact[0]).hypot(y - exact[1]) < 1e-12, "{angle}");
            assert!((series.radius_of_curvature(angle) - (a * b).powi(2) / r.powi(3)).abs() < 1e-10);
        }
        assert_eq!(SupportSeries::of_coefficients(&series.coefficients()), series);
    }

    /// The basis against the series itself, which is linear in each coefficient.
    #[test]
    fn the_basis_is_the_derivative_by_the_coefficients() {
        for place in 0..9 {
            let mut unit = [0.0; 9];
            unit[place] = 1.0;
            let (series, basis) = (SupportSeries::of_coefficients(&unit), SupportSeries::basis(0.7, 4));
            for (value, expected) in series.support(0.7).into_iter().zip(basis[place]) {
                assert!((value - expected).abs() < 64.0 * 8.0 * f64::EPSILON, "{place}: {value} {expected}");
            }
        }
    }
}
