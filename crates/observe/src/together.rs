//! Several windows together: whether all of them are what the errors of the readings explain, and whether they agree where they meet; and the innovations of
//! a filter.

use super::chi_square::exceeded;
use super::fit::FALSE_ALARMS;

/// How far the estimates of two windows are apart where they meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// In s.
    pub time: f64,
    /// The square of the difference in units of its own covariance, less what rounding may add.
    pub chi_square: f64,
    /// In how many directions both tell.
    pub degrees: usize,
    /// How likely a difference so large is, were the model right.
    pub probability: f64,
}

/// The tests of all windows of a track together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Together {
    /// So many windows were tested.
    pub windows: usize,
    /// How likely it is that their probabilities are so small, were the model right: `-2 sum ln p` has the distribution of chi-square with two degrees of freedom a window
    /// (R. A. Fisher, Statistical Methods for Research Workers, 1932, section 21.1).
    pub probability: f64,
    /// The least likely seam, and how likely it is that one of so many is so unlikely (C. E. Bonferroni, 1936).
    pub worst_seam: Option<(Seam, f64)>,
    /// Whether both are no less likely than [`FALSE_ALARMS`].
    pub fits: bool,
}

/// What the windows of a track or of a stream have come to so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tested {
    sum: f64,
    windows: usize,
    seams: usize,
    worst: Option<Seam>,
}

impl Tested {
    /// Takes in the probability of a window by itself.
    pub fn window(&mut self, probability: f64) {
        self.sum -= 2.0 * probability.ln();
        self.windows += 1;
    }

    /// Takes in a seam.
    pub fn seam(&mut self, seam: Seam) {
        self.seams += 1;
        if self.worst.is_none_or(|worst| seam.probability < worst.probability) {
            self.worst = Some(seam);
        }
    }

    /// The tests of all of them; nothing of one window.
    pub fn together(&self) -> Option<Together> {
        if self.windows < 2 && self.seams == 0 {
            return None;
        }
        let probability = exceeded(self.sum, 2.0 * self.windows as f64);
        let worst_seam = self.worst.map(|seam| (seam, (seam.probability * self.seams as f64).min(1.0)));
        let fits = probability >= FALSE_ALARMS && worst_seam.is_none_or(|(_, p)| p >= FALSE_ALARMS);
        Some(Together { windows: self.windows, probability, worst_seam, fits })
    }
}

/// The innovations of a filter, and whether they are what it believes of its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovations {
    /// The sum of the normalised squares, `nu^T S^-1 nu` at each sample.
    pub chi_square: f64,
    /// Readings that were compared.
    pub degrees: usize,
    /// How likely a sum so large is, were the filter's covariance and the noise right (Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to
    /// Tracking and Navigation, 2001, section 5.4).
    pub probability: f64,
    /// The standard deviation of a reading that the filter believes, in its unit.
    pub sigma: f64,
    /// Whether it is no less likely than [`FALSE_ALARMS`].
    pub fits: bool,
}

impl Innovations {
    /// Of a sum of squares; `coherent` is what rounding may add to each, in standard deviations.
    pub(super) fn of(chi_square: f64, degrees: usize, sigma: f64, coherent: f64) -> Option<Innovations> {
        let rest = (chi_square.sqrt() - coherent * (degrees as f64).sqrt()).max(0.0);
        let probability = exceeded(rest * rest, degrees as f64);
        let fits = probability >= FALSE_ALARMS;
        (degrees > 0).then_some(Innovations { chi_square, degrees, probability, sigma, fits })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn together(windows: &[f64], seams: &[Seam]) -> Option<Together> {
        let mut all = Tested::default();
        windows.iter().for_each(|own| all.window(*own));
        seams.iter().for_each(|own| all.seam(*own));
        all.together()
    }

    /// Two probabilities: the product `k` of two even ones is below it with the probability `k (1 - ln k)`, by integration.
    #[test]
    fn two_probabilities_are_combined_as_by_hand() {
        for (a, b) in [(0.5, 0.5), (0.04, 0.3), (1e-4, 0.9), (1.0, 1.0)] {
            let product: f64 = a * b;
            let by_hand = product * (1.0 - product.ln());
            let found = together(&[a, b], &[]).unwrap().probability;
            assert!((found - by_hand).abs() < 1e-12, "{a} {b}");
        }
        assert_eq!(together(&[0.0, 1.0], &[]).unwrap().probability, 0.0);
    }

    #[test]
    fn one_unlikely_seam_is_enough() {
        let seam = |chi_square: f64| Seam {
            time: 1.0,
            chi_square,
            degrees: 1,
            probability: exceeded(chi_square, 1.0),
        };
        assert_eq!(together(&[0.5], &[]), None);
        assert!(together(&[0.5, 0.2], &[seam(1.0)]).unwrap().fits);
        let jump = together(&[0.5, 0.2, 0.9], &[seam(1.0), seam(18.0 * 18.0)]).unwrap();
        assert!(!jump.fits && jump.probability > 0.1 && jump.worst_seam.unwrap().0.chi_square == 324.0);
        assert!(!together(&[0.01, 0.01, 0.01, 0.01], &[]).unwrap().fits);
    }
}
