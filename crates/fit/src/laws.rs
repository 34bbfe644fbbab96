//! How errors are distributed, on which scale parameters are estimated, and their priors.

use std::f64::consts::{LN_10, TAU};

/// On which scale a parameter is estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterScale {
    /// As it is.
    Linear,
    /// By its natural logarithm.
    Log,
    /// By its decimal logarithm.
    Log10,
}

impl ParameterScale {
    /// Its name in a scene.
    pub fn word(self) -> &'static str {
        match self {
            ParameterScale::Linear => "linear",
            ParameterScale::Log => "log",
            ParameterScale::Log10 => "log10",
        }
    }

    /// A value on this scale.
    pub fn scaled(self, value: f64) -> f64 {
        match self {
            ParameterScale::Linear => value,
            ParameterScale::Log => value.ln(),
            ParameterScale::Log10 => value.log10(),
        }
    }

    /// The value that stands at a place of this scale.
    pub fn value(self, scaled: f64) -> f64 {
        match self {
            ParameterScale::Linear => scaled,
            ParameterScale::Log => scaled.exp(),
            ParameterScale::Log10 => (scaled * LN_10).exp(),
        }
    }

    /// The derivative of the value by its place.
    pub fn slope(self, scaled: f64) -> f64 {
        match self {
            ParameterScale::Linear => 1.0,
            ParameterScale::Log => scaled.exp(),
            ParameterScale::Log10 => LN_10 * self.value(scaled),
        }
    }
}

/// On which scale measurements and what is expected of them are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorScale {
    /// As they are.
    Linear,
    /// By their natural logarithms.
    Log,
    /// By their decimal logarithms.
    Log10,
}

impl ErrorScale {
    /// Its name in a scene.
    pub fn word(self) -> &'static str {
        match self {
            ErrorScale::Linear => "linear",
            ErrorScale::Log => "log",
            ErrorScale::Log10 => "log10",
        }
    }

    /// A number on this scale, with its derivative.
    pub(crate) fn of(self, value: f64) -> [f64; 2] {
        match self {
            ErrorScale::Linear => [value, 1.0],
            ErrorScale::Log => [value.ln(), 1.0 / value],
            ErrorScale::Log10 => [value.log10(), 1.0 / (LN_10 * value)],
        }
    }

    /// Minus the logarithm of the derivative of the scale where a measurement lies: the density is one of the measurement itself.
    fn density(self, measured: f64) -> f64 {
        match self {
            ErrorScale::Linear => 0.0,
            ErrorScale::Log => measured.ln(),
            ErrorScale::Log10 => (measured * LN_10).ln(),
        }
    }
}

/// How errors are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorLaw {
    /// By Gauss, with a standard deviation.
    Normal,
    /// By Laplace, with a scale.
    Laplace,
}

/// What one measurement adds to minus the logarithm of the likelihood, with derivatives and expected second derivatives by what is expected and by
/// the size of the errors, both on the scale on which they are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term {
    pub value: f64,
    pub by_expected: f64,
    pub by_size: f64,
    pub information: [f64; 2],
    /// The residual over the size of the errors.
    pub residual: f64,
}

impl ErrorLaw {
    /// Its name in a scene.
    pub fn word(self) -> &'static str {
        match self {
            ErrorLaw::Normal => "normal",
            ErrorLaw::Laplace => "laplace",
        }
    }

    /// The term of a measurement; none where a number is missing, or the size of the errors is not positive.
    pub(crate) fn term(self, scale: ErrorScale, measured: f64, expected: f64, size: f64) -> Option<Term> {
        let [m, _] = scale.of(measured);
        let [y, slope] = scale.of(expected);
        let residual = (y - m) / size;
        if !(size > 0.0 && residual.is_finite() && slope.is_finite()) {
            return None;
        }
        let density = scale.density(measured);
        let (value, by_residual, by_size, information) = match self {
            ErrorLaw::Normal => (
                0.5 * (TAU * size * size).ln() + 0.5 * residual * residual,
                residual,
                (1.0 - residual * residual) / size,
                [1.0, 2.0],
            ),
            ErrorLaw::Laplace => (
                (2.0 * size).ln() + residual.abs(),
                if residual == 0.0 { 0.0 } else { residual.signum() },
                (1.0 - residual.abs()) / size,
                [1.0, 1.0],
            ),
        };
        Some(Term {
            value: value + density,
            by_expected: by_residual * slope / size,
            by_size,
            information: [information[0] * (slope / size).powi(2), information[1] / (size * size)],
            residual,
        })
    }
}

/// The law of a prior.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PriorLaw {
    /// By Gauss: mean and standard deviation.
    Normal,
    /// By Laplace: centre and scale.
    Laplace,
    /// The logarithm by Gauss.
    LogNormal,
    /// The logarithm by Laplace.
    LogLaplace,
}

/// What is believed of a parameter before anything is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Its law.
    pub law: PriorLaw,
    /// Whether it is about the parameter on its scale, and not about its value.
    pub is_on_scale: bool,
    /// Its centre.
    pub centre: f64,
    /// Its spread.
    pub spread: f64,
}

impl Prior {
    /// Minus the logarithm of its density, the derivative, and a second derivative that is not negative, by the parameter on its scale.
    pub(crate) fn term(&self, scale: ParameterScale, scaled: f64) -> [f64; 3] {
        let (x, slope) = match self.is_on_scale {
            true => (scaled, 1.0),
            false => (scale.value(scaled), scale.slope(scaled)),
        };
        let is_log = matches!(self.law, PriorLaw::LogNormal | PriorLaw::LogLaplace);
        let (z, slope, density) = match is_log {
            true => (x.ln(), slope / x, x.ln()),
            false => (x, slope, 0.0),
        };
        // the derivative of the density's own logarithm
        let own = if is_log { slope } else { 0.0 };
        let residual = (z - self.centre) / self.spread;
        match self.law {
            PriorLaw::Normal | PriorLaw::LogNormal => [
                0.5 * residual * residual + 0.5 * (TAU * self.spread * self.spread).ln() + density,
                residual * slope / self.spread + own,
                (slope / self.spread).powi(2),
            ],
            PriorLaw::Laplace | PriorLaw::LogLaplace => [
                residual.abs() + (2.0 * self.spread).ln() + density,
                residual.signum() * slope / self.spread + own,
                (slope / self.spread).powi(2),
            ],
        }
    }
}
