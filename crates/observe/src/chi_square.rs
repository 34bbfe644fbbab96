//! The distribution of a sum of squares of normal errors, and of one whose errors have means of their own.

/// Terms of a series or fraction at most: so many are never needed for the degrees of freedom of a window.
const MOST_TERMS: usize = 100_000;

/// The probability that the sum of the squares of `degrees` independent normal errors, each in units of its standard
/// deviation, is larger than `square`: the regularised upper incomplete gamma function `Q(degrees/2, square/2)`.
///
/// One for a square that is not positive, zero for one that is no number: such a residual is not explained.
///
/// Reference: M. Abramowitz, I. Stegun, Handbook of Mathematical Functions, 6.5.29, 6.5.31 (as J. Lentz evaluates fractions),
/// 26.4.19.
pub fn exceeded(square: f64, degrees: f64) -> f64 {
    if square.is_nan() || square == f64::INFINITY {
        return 0.0;
    }
    if square <= 0.0 || degrees <= 0.0 {
        return if square <= 0.0 { 1.0 } else { 0.0 };
    }
    let (a, x) = (degrees / 2.0, square / 2.0);
    let scale = (a * x.ln() - x - log_gamma(a)).exp();
    if x < a + 1.0 {
        // the series of the lower function
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..MOST_TERMS {
            term *= x / (a + n as f64);
            sum += term;
            if term < sum * f64::EPSILON {
                break;
            }
        }
        (1.0 - scale * sum).clamp(0.0, 1.0)
    } else {
        // the continued fraction of the upper function
        const TINY: f64 = 1e-300;
        let mut b = x + 1.0 - a;
        let (mut c, mut d) = (1.0 / TINY, 1.0 / b);
        let mut fraction = d;
        for n in 1..MOST_TERMS {
            let numerator = -(n as f64) * (n as f64 - a);
            b += 2.0;
            d = numerator * d + b;
            d = 1.0 / if d.abs() < TINY { TINY } else { d };
            c = b + numerator / c;
            c = if c.abs() < TINY { TINY } else { c };
            fraction *= d * c;
            if (d * c - 1.0).abs() < f64::EPSILON {
                break;
            }
        }
        (scale * fraction).clamp(0.0, 1.0)
    }
}

/// The square that is exceeded with a probability, for degrees of freedom.
pub fn quantile(probability: f64, degrees: f64) -> f64 {
    least(|square| exceeded(square, degrees) <= probability)
}

/// The probability that a sum of squares is larger than `square` where the errors have means whose squares sum up to
/// `noncentrality`.
///
/// Reference: Abramowitz and Stegun 26.4.25, a mean over Poisson's distribution.
pub fn exceeded_with(square: f64, degrees: f64, noncentrality: f64) -> f64 {
    let mean = noncentrality / 2.0;
    if mean.is_nan() || mean > 1e6 {
        // the normal approximation has long been good
        return if degrees + noncentrality > square { 1.0 } else { 0.0 };
    }
    let spread = 8.0 * mean.sqrt() + 20.0;
    let (first, last) = ((mean - spread).max(0.0).floor() as usize, (mean + spread).ceil() as usize);
    let weight = |j: usize| {
        let j = j as f64;
        if mean > 0.0 { (j * mean.ln() - mean - log_gamma(j + 1.0)).exp() } else { f64::from(j == 0.0) }
    };
    (first..=last).map(|j| weight(j) * exceeded(square, degrees + 2.0 * j as f64)).sum::<f64>().min(1.0)
}

/// How large the sum of the squares of the means has to be for a sum of squares to pass, with the probability `power`, what is passed
/// with the probability `alarm` where there are none.
pub fn noncentrality(alarm: f64, power: f64, degrees: f64) -> f64 {
    let limit = quantile(alarm, degrees);
    least(|noncentrality| exceeded_with(limit, degrees, noncentrality) >= power)
}

/// The least positive number from which on something holds.
fn least(holds: impl Fn(f64) -> bool) -> f64 {
    let mut high = 1.0;
    while !holds(high) && high < 1e9 {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

/// The logarithm of the gamma function of a positive number, by Stirling's series from ten on.
fn log_gamma(mut x: f64) -> f64 {
    let mut product = 1.0;
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    // Bernoulli's numbers over 2k(2k - 1), Abramowitz and Stegun 6.1.41; the last one adds less than 1e-16 from ten on
    const SERIES: [f64; 7] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
    ];
    let square = x * x;
    let series = SERIES.iter().rev().fold(0.0, |sum, term| sum / square + term) / x;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - f64::ln(product)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use palmistry_math::number::rational_to_f64;

    /// Of 2k degrees of freedom the probability is a finite sum, `exp(-x) sum x^i/i!` over `i < k` with `x` half of the square:
    /// the sum in rationals, the exponential function from the library.
    #[test]
    fn even_degrees_are_a_finite_sum() {
        for k in [1u32, 2, 5, 20, 80, 200] {
            for x in [1u32, 3, 10, 40, 79, 81, 160, 250] {
                let (mut term, mut sum) = (RBig::ONE, RBig::ZERO);
                for i in 1..=k {
                    sum += &term;
                    term *= RBig::from_parts(x.into(), i.into());
                }
                let exact = (rational_to_f64(&sum).ln() - f64::from(x)).exp();
                let found = exceeded(2.0 * f64::from(x), 2.0 * f64::from(k));
                assert!((found - exact).abs() < 1e-12 * exact + 1e-14, "{k} {x}: {found:e} for {exact:e}");
            }
        }
    }

    /// One degree: `erfc(sqrt(square/2))`; Abramowitz and Stegun, table 26.1 (twice the tail of the normal distribution).
    #[test]
    fn one_degree_is_the_normal_distribution() {
        for (z, tail) in [
            (1.0, 0.158_655_253_931_457_05),
            (3.0, 1.349_898_031_630_094_5e-3),
            (5.0, 2.866_515_718_791_933e-7f64),
        ] {
            let found = exceeded(z * z, 1.0);
            assert!((found / (2.0 * tail) - 1.0).abs() < 1e-12, "{z}: {found:e}");
        }
        assert!((quantile(0.05, 1.0) - 3.841_458_820_694_124).abs() < 1e-9);
    }

    /// One degree with the mean `m`: larger than `z^2` is above `z` or below `-z`, two tails of the normal distribution.
    #[test]
    fn a_mean_of_its_own_moves_the_normal_distribution() {
        let above =
            |z: f64| if z >= 0.0 { exceeded(z * z, 1.0) / 2.0 } else { 1.0 - exceeded(z * z, 1.0) / 2.0 };
        for (z, m) in [(1.0, 0.5), (3.29, 4.0), (3.29, 5.6), (2.0, 30.0f64)] {
            let exact = above(z - m) + above(z + m);
            assert!((exceeded_with(z * z, 1.0, m * m) - exact).abs() < 1e-12, "{z} {m}");
        }
        // what is passed once in a thousand is passed in 99 of 100 cases from 3.29 + 2.33 deviations on
        assert!((noncentrality(1e-3, 0.99, 1.0).sqrt() - (3.290_526_731 + 2.326_347_874)).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_square_is_answered() {
        assert_eq!((exceeded(-1.0, 3.0), exceeded(0.0, 0.0), exceeded(1.0, 0.0)), (1.0, 1.0, 0.0));
        assert_eq!(
            (exceeded(f64::NAN, 3.0), exceeded(f64::INFINITY, 3.0), exceeded(1e300, 3.0)),
            (0.0, 0.0, 0.0)
        );
    }
}
