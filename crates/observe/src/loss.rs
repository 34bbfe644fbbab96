//! How residuals are weighed: by their squares, or robustly, so that a few outliers have a bounded influence.

use super::chi_square::exceeded;
use serde::Deserialize;

/// What is minimised.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Loss {
    /// The sum of the squares.
    #[default]
    Squares,
    /// Squares up to so many standard deviations of a measurement, and beyond as a straight line goes on from there (P. J. Huber, Robust estimation of a
    /// location parameter, 1964).
    Huber(f64),
}

/// The corner at which an estimate from normal errors has 95 percent of the efficiency of least squares.
pub const CORNER: f64 = 1.345;

/// So many standard deviations no error of a window reaches by chance: one in 16,000 is larger.
const OUTLIER: f64 = 4.0;

impl Loss {
    /// The residual whose square is twice the loss of a difference, and its derivative by the difference; `sigma` is the standard deviation of
    /// a measurement.
    pub(super) fn residual(self, difference: f64, sigma: f64) -> (f64, f64) {
        match self {
            Loss::Huber(corner) if difference.abs() > corner * sigma => {
                let corner = corner * sigma;
                let residual = (2.0 * corner * difference.abs() - corner * corner).sqrt();
                (residual * difference.signum(), corner / residual)
            }
            _ => (difference, 1.0),
        }
    }

    /// Whether no normal error reaches a difference, so that the test of fit leaves it out; `coherent` is what rounding and computation
    /// may add. Least squares leave nothing out.
    pub(super) fn is_outlier(self, difference: f64, sigma: f64, coherent: f64) -> bool {
        match self {
            Loss::Huber(corner) => difference.abs() > OUTLIER.max(corner) * sigma + coherent,
            Loss::Squares => false,
        }
    }

    /// By how much the sum of the squares of normal errors falls for each unknown that is fitted: `2 - b/a^2` with `b` the mean of the square of the
    /// loss's derivative and `a` that of its second one, for `b/a^2` is the variance of the estimate over that of least squares.
    pub(super) fn taken(self) -> f64 {
        let Loss::Huber(corner) = self else { return 1.0 };
        let beyond = exceeded(corner * corner, 1.0);
        let density = (-corner * corner / 2.0).exp() / std::f64::consts::TAU.sqrt();
        let square = 1.0 - beyond - 2.0 * corner * density + corner * corner * beyond;
        2.0 - square / (1.0 - beyond).powi(2)
    }

    /// Whether a difference is beyond the corner.
    pub(super) fn is_discounted(self, difference: f64, sigma: f64) -> bool {
        matches!(self, Loss::Huber(corner) if difference.abs() > corner * sigma)
    }
}

/// `"squares"`, `"huber"`, or `{ huber = 2.0 }`.
impl<'de> Deserialize<'de> for Loss {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename_all = "kebab-case")]
        enum Word {
            Squares,
            Huber,
        }
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Corner {
            huber: f64,
        }
        struct Either;
        impl<'de> serde::de::Visitor<'de> for Either {
            type Value = Loss;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a string")
            }

            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<Loss, E> {
                let word = Word::deserialize(serde::de::value::StrDeserializer::<E>::new(word))?;
                Ok(match word {
                    Word::Squares => Loss::Squares,
                    Word::Huber => Loss::Huber(CORNER),
                })
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Loss, A::Error> {
                let corner = Corner::deserialize(serde::de::value::MapAccessDeserializer::new(map))?;
                Ok(Loss::Huber(corner.huber))
            }
        }
        deserializer.deserialize_any(Either)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: with the corner at one and a difference of three the loss is 3 - 1/2; its derivative is one.
    #[test]
    fn beyond_the_corner_the_loss_is_a_straight_line() {
        let loss = Loss::Huber(1.0);
        let (residual, slope) = loss.residual(-3.0, 1.0);
        assert!((residual * residual / 2.0 - 2.5).abs() < 1e-15 && residual < 0.0);
        assert!((residual * slope + 1.0).abs() < 1e-15);
        assert_eq!(loss.residual(0.5, 1.0), (0.5, 1.0));
        assert!(!loss.is_outlier(-3.0, 1.0, 0.0) && loss.is_outlier(-4.5, 1.0, 0.0));
        assert!(!loss.is_outlier(-4.5, 1.0, 1.0) && !Loss::Squares.is_outlier(1e3, 1.0, 0.0));
        // at Huber's own corner the efficiency is 0.95
        assert!(
            (Loss::Huber(CORNER).taken() - (2.0 - 1.0 / 0.95)).abs() < 1e-4 && Loss::Squares.taken() == 1.0
        );
        assert_eq!(Loss::Squares.residual(9.0, 1.0), (9.0, 1.0));
    }
}
