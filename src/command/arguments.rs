//! What is chosen or given on the command line: words of a list, parts, times.

use clap::ValueEnum;
use palmistry::design::AdditionKind;
use palmistry::sweep::Certainty;

/// What a verdict has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Wanted {
    Certified,
    Computed,
}

impl From<Wanted> for Certainty {
    fn from(wanted: Wanted) -> Self {
        match wanted {
            Wanted::Certified => Certainty::Certified,
            Wanted::Computed => Certainty::Computed,
        }
    }
}

/// Kinds of additions, as they are named on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum By {
    /// Further outputs: the states, or what --measure names.
    Outputs,
    /// Parameters that are known.
    Known,
    /// States whose initial conditions are known.
    Initial,
    /// Known inputs that are added to the rates of states.
    Inputs,
    /// Further experiments from other initial conditions.
    Experiments,
}

impl From<By> for AdditionKind {
    fn from(by: By) -> AdditionKind {
        match by {
            By::Outputs => AdditionKind::Outputs,
            By::Known => AdditionKind::Known,
            By::Initial => AdditionKind::Initial,
            By::Inputs => AdditionKind::Inputs,
            By::Experiments => AdditionKind::Experiments,
        }
    }
}

/// A part of something: a number above zero and below one.
pub(super) fn part(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(part) if part > 0.0 && part < 1.0 => Ok(part),
        _ => Err("write a number above 0 and below 1, as in 1e-6".to_owned()),
    }
}

/// A time with its unit, `20ms` or `1.5 s`; in s.
pub(super) fn time(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (number, unit) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e-3),
        None => (text.strip_suffix('s').unwrap_or(text), 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value * unit),
        _ => Err("write a time with its unit, as in 20ms or 1.5s".to_owned()),
    }
}
