//! Several windows together: whether all of them are what the errors of the measurements explain, and whether they agree where they meet; and the innovations of
//! a filter.

use super::chi_square::exceeded;
use super::fit::FALSE_ALARMS;

/// How far the estimates of two windows differ where they meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// In s.
    pub time: f64,
    /// The square of the difference in units of its own covariance, less what rounding may add.
    pub chi_square: f64,
    /// In how many directions both determine the state.
    pub degrees: usize,
    /// How likely a difference so large is, were the model right.
    pub probability: f64,
    /// Whether the difference is what the second window's own measurements add to what it inherited: such differences are independent of each other.
    pub is_increment: bool,
}

impl Seam {
    /// Of two estimates of the same states at a time with the standard deviations of each, where the correlation of their errors is not known: no difference has a
    /// deviation above the sum of both. No state is an angle. The worst state is given, its probability times the number of states (Bonferroni). None where no
    /// state has a deviation on both sides.
    pub fn of_any_correlation(time: f64, before: [&[f64]; 2], after: [&[f64]; 2]) -> Option<Seam> {
        let [before, before_deviations] = before;
        let [after, after_deviations] = after;
        let places = 0..before.len().min(after.len());
        let told = |place: usize| {
            let sum = before_deviations.get(place)? + after_deviations.get(place)?;
            (sum.is_finite() && sum > 0.0).then(|| (after[place] - before[place]).abs() / sum)
        };
        let apart: Vec<f64> = places.filter_map(told).collect();
        let most = apart.iter().copied().reduce(f64::max)?;
        let chi_square = most * most;
        let probability = (apart.len() as f64 * exceeded(chi_square, 1.0)).min(1.0);
        Some(Seam { time, chi_square, degrees: 1, probability, is_increment: false })
    }

    /// Whether two windows of a right model seldom differ so much.
    pub fn is_open(&self) -> bool {
        self.probability < FALSE_ALARMS
    }
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
    /// How likely it is that the seams of inheriting windows are so unlikely all in all, by the same test of Fisher's; none of fewer than two.
    pub seams: Option<f64>,
    /// Whether all three are no less likely than [`FALSE_ALARMS`].
    pub fits: bool,
}

/// What the windows of a track or of a stream have come to so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tested {
    sum: f64,
    windows: usize,
    seams: usize,
    worst: Option<Seam>,
    /// Of the seams of inheriting windows, which are independent of each other.
    increments: usize,
    sum_of_increments: f64,
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
        if seam.is_increment {
            self.increments += 1;
            self.sum_of_increments -= 2.0 * seam.probability.ln();
        }
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
        let seams =
            (self.increments > 1).then(|| exceeded(self.sum_of_increments, 2.0 * self.increments as f64));
        let all = [Some(probability), worst_seam.map(|(_, p)| p), seams];
        let fits = all.into_iter().flatten().all(|p| p >= FALSE_ALARMS);
        Some(Together { windows: self.windows, probability, worst_seam, seams, fits })
    }
}

/// The innovations of a filter, and whether they are what it believes of its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovations {
    /// The sum of the normalised squares, `nu^T S^-1 nu` at each sample.
    pub chi_square: f64,
    /// Measurements that were compared.
    pub degrees: usize,
    /// How likely a sum so large is, were the filter's covariance and the noise right (Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to
    /// Tracking and Navigation, 2001, section 5.4).
    pub probability: f64,
    /// The standard deviation of a measurement that the filter believes, in its unit.
    pub sigma: f64,
    /// How likely innovations are that correlate so much with those of the sample before, were the model right: then they are white (section 5.4.2 there). None
    /// of a filter that is not the best linear one, whose innovations need not be white, and of few measurements.
    pub whiteness: Option<f64>,
    /// Whether both are no less likely than [`FALSE_ALARMS`].
    pub fits: bool,
    /// The sum of the products of each innovation with the one before, in deviations, and how many there are.
    products: f64,
    counted: usize,
    /// What rounding may add to each, in deviations.
    coherent: f64,
}

/// A sum of fewer products is not yet near a normal distribution.
const LEAST_PRODUCTS: usize = 50;

impl Innovations {
    /// Of a sum of squares, and of the sum of so many products of each innovation with the one before, both in deviations; `coherent` is what rounding may add to each
    /// innovation.
    pub(super) fn of(
        [chi_square, products]: [f64; 2],
        [degrees, counted]: [usize; 2],
        sigma: f64,
        coherent: f64,
    ) -> Option<Innovations> {
        let rest = (chi_square.sqrt() - coherent * (degrees as f64).sqrt()).max(0.0);
        let probability = exceeded(rest * rest, degrees as f64);
        let whiteness = (counted >= LEAST_PRODUCTS).then(|| {
            let n = counted as f64;
            let rounding = n * coherent * coherent + 2.0 * coherent * n.sqrt();
            let rest = products.abs() - rounding;
            if rest <= 0.0 { 1.0 } else { exceeded(rest * rest / n, 1.0) }
        });
        let fits = probability >= FALSE_ALARMS && whiteness.is_none_or(|p| p >= FALSE_ALARMS);
        (degrees > 0).then_some(Innovations {
            chi_square,
            degrees,
            probability,
            sigma,
            whiteness,
            fits,
            products,
            counted,
            coherent,
        })
    }

    /// Of these and those that came after, together.
    pub fn with(self, later: Innovations) -> Innovations {
        let sums = [self.chi_square + later.chi_square, self.products + later.products];
        let counts = [self.degrees + later.degrees, self.counted + later.counted];
        let (sigma, coherent) = (self.sigma.min(later.sigma), self.coherent.max(later.coherent));
        Innovations::of(sums, counts, sigma, coherent).unwrap_or(self)
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
            is_increment: false,
        };
        assert_eq!(together(&[0.5], &[]), None);
        assert!(together(&[0.5, 0.2], &[seam(1.0)]).unwrap().fits);
        let jump = together(&[0.5, 0.2, 0.9], &[seam(1.0), seam(18.0 * 18.0)]).unwrap();
        assert!(!jump.fits && jump.probability > 0.1 && jump.worst_seam.unwrap().0.chi_square == 324.0);
        assert!(!together(&[0.01, 0.01, 0.01, 0.01], &[]).unwrap().fits);
    }

    /// Twelve differences of 1.9 deviations are each what chance may bring, and all of them are not.
    #[test]
    fn seams_of_heirs_count_together() {
        let seam = |is_increment| {
            let chi_square = 1.9_f64 * 1.9;
            let probability = exceeded(chi_square, 1.0);
            Seam { time: 1.0, chi_square, degrees: 1, probability, is_increment }
        };
        let windows = [0.5; 13];
        let heirs = together(&windows, &[seam(true); 12]).unwrap();
        assert!(!heirs.fits && heirs.worst_seam.unwrap().1 > 0.5);
        // by a table of chi-square: -2 ln 0.0574 = 5.716, twelve of them 68.6 with 24 degrees of freedom
        assert!((heirs.seams.unwrap() / 3.4e-6).ln().abs() < 0.2, "{:?}", heirs.seams);
        let others = together(&windows, &[seam(false); 12]).unwrap();
        assert!(others.fits && others.seams.is_none());
    }

    /// Correlated as they may be, the difference of two errors has no deviation above the sum of theirs.
    #[test]
    fn seams_of_any_correlation_are_as_by_hand() {
        let of = |after: [f64; 2], deviations: [f64; 2]| {
            Seam::of_any_correlation(2.0, [&[1.0, 5.0], &[0.1, f64::INFINITY]], [&after, &deviations])
        };
        let near = of([1.3, 9.0], [0.05, 0.1]).unwrap();
        assert!((near.chi_square - 4.0).abs() < 1e-12 && !near.is_open());
        assert!(of([2.2, 5.0], [0.05, 0.1]).unwrap().is_open());
        assert_eq!(of([2.2, 5.0], [f64::INFINITY, 0.1]), None);
        assert_eq!(Seam::of_any_correlation(2.0, [&[1.0], &[]], [&[1.0], &[0.1]]), None);
    }

    /// By hand: a sum of `n` products of independent numbers has the variance `n`. What is no number is no white noise, and few products are not tested.
    #[test]
    fn whiteness_is_that_of_the_sum_of_products() {
        let of = |products: f64, counted: usize| Innovations::of([100.0, products], [100, counted], 1.0, 0.0);
        let even = of(20.0, 100).unwrap();
        assert!((even.whiteness.unwrap() - 0.0455).abs() < 1e-4 && even.fits);
        assert!(!of(-40.0, 100).unwrap().fits && of(40.0, 49).unwrap().fits);
        assert!(!of(f64::NAN, 100).unwrap().fits);
        assert_eq!(of(40.0, 49).unwrap().whiteness, None);
        assert_eq!(Innovations::of([0.0, 0.0], [0, 0], 1.0, 0.0), None);
        // two halves, each of which passes: by hand, products of 40 in 100 are four deviations
        let half = of(20.0, 50).unwrap();
        let whole = half.with(half);
        assert!(half.fits && !whole.fits && whole.degrees == 200);
        assert!((whole.whiteness.unwrap() / 6.334e-5 - 1.0).abs() < 1e-3, "{whole:?}");
    }
}
