//! How misfits are weighed: by their squares, or so that a few that are far off say no more than that.

use serde::Deserialize;

/// What is made as small as it can be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Loss {
    /// The sum of the squares.
    #[default]
    Squares,
    /// Squares up to so many standard deviations of a reading, and beyond as a straight line goes on from there (P. J. Huber, Robust estimation of a
    /// location parameter, 1964).
    Huber(f64),
}

/// The corner at which an estimate from normal errors has 95 percent of the efficiency of least squares.
pub const CORNER: f64 = 1.345;

impl Loss {
    /// The residual whose square is twice the loss of a difference, and its derivative by the difference; `sigma` is the standard deviation of
    /// a reading.
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

    /// The difference as the test of fit counts it: no more than up to the corner.
    pub(super) fn counted(self, difference: f64, sigma: f64) -> f64 {
        match self {
            Loss::Huber(corner) => difference.clamp(-corner * sigma, corner * sigma),
            Loss::Squares => difference,
        }
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
        assert_eq!(loss.counted(-3.0, 1.0), -1.0);
        assert_eq!(Loss::Squares.residual(9.0, 1.0), (9.0, 1.0));
    }
}
