//! A body given by the harmonics of its support function, in doubles.

use super::form::{FormError, length};
use super::plane::unit;
use super::positive::{Doubt, positive_everywhere};
use crate::mechanics::harmonics::Harmonics;

/// A series with a positive radius of curvature.
#[derive(Clone, Debug)]
pub(super) struct Series(Harmonics<f64>);

impl Series {
    pub(super) fn new(mean: f64, harmonics: &[[f64; 2]]) -> Result<Self, FormError> {
        length("the mean of the support function", mean)?;
        for (k, pair) in (1..).zip(harmonics) {
            if let Some(&value) = pair.iter().find(|x| !x.is_finite()) {
                return Err(FormError::NotFinite { what: format!("a coefficient of harmonic {k}"), value });
            }
        }
        let found = Series(Harmonics { mean, pairs: harmonics.to_vec() });
        // h + h'' = mean + sum (1 - k^2)(p_k cos + q_k sin), whose slope is at most sum k (k^2 - 1) |c_k|
        let slope = found.sum(|k| k * (k * k - 1.0));
        // sum and sine of each term are off by a few units in the last place, the argument k a by k of them
        let rounding = 8.0 * f64::EPSILON * (mean + found.sum(|k| (k + 4.0) * (k * k + 1.0)));
        let radius = |angle: f64| {
            let [h, _, second] = found.support(angle);
            h + second
        };
        positive_everywhere(radius, slope, rounding).map_err(|doubt| match doubt {
            Doubt::Negative { angle, value } => FormError::NotConvex { angle, radius: value },
            Doubt::Undecided { angle, value } => {
                FormError::TooClose { what: "the radius of curvature", angle, value }
            }
        })?;
        Ok(found)
    }

    /// The sum of the harmonics' sizes with weights.
    fn sum(&self, weight: impl Fn(f64) -> f64) -> f64 {
        (1..).zip(&self.0.pairs).map(|(k, [p, q])| weight(f64::from(k)) * p.hypot(*q)).sum()
    }

    /// `h`, `h'` and `h''`.
    pub(super) fn support(&self, angle: f64) -> [f64; 3] {
        self.0.support(|k| unit(f64::from(k) * angle))
    }

    /// No point of the outline is farther from the origin: the greatest distance is the maximum of `h`.
    pub(super) fn reach(&self) -> f64 {
        self.0.mean + self.sum(|_| 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `1 + p cos(2 a)` has the radius of curvature `1 - 3 p cos(2 a)`: positive exactly for `|p| < 1/3`.
    #[test]
    fn convexity_is_decided_up_to_its_limit() {
        let body = |p: f64| Series::new(1.0, &[[0.0, 0.0], [p, 0.0]]).map(|_| ());
        assert_eq!(body(0.333333), Ok(()));
        let Err(FormError::NotConvex { angle, radius }) = body(0.333334) else { panic!() };
        // the dent is where cos(2 a) = 1; within 1e-5 of it, (2 a)^2 / 2 < 1e-5
        assert!(angle.sin().abs() < 3e-3 && radius <= 0.0, "{angle} {radius}");
        // two harmonics whose sizes add to more than the mean, 3 * 0.2 + 8 * 0.06 = 1.08, but never together
        let sum_is_not_needed = Series::new(1.0, &[[0.0, 0.0], [-0.2, 0.0], [0.0, 0.06]]);
        let radius = |a: f64| 1.0 + 0.6 * (2.0 * a).cos() - 0.48 * (3.0 * a).sin();
        let least = (0..100_000).map(|i| radius(f64::from(i) * 1e-4)).fold(f64::MAX, f64::min);
        assert_eq!(sum_is_not_needed.is_ok(), least > 0.0);
        assert!(Series::new(1.0, &[[f64::NAN, 0.0]]).is_err() && Series::new(-1.0, &[]).is_err());
    }
}
