//! Arguments that more than one command takes.

use super::Unusable;
use clap::ValueEnum;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::expression::Symbol;
use palmistry::number::parse_decimal;
use palmistry::sweep::Certainty;
use std::collections::HashMap;

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

/// Reads `name=value` pairs, for the symbols of a system.
pub(crate) fn assignments(system: &System, pairs: &[String]) -> miette::Result<HashMap<Symbol, RBig>> {
    let mut values = HashMap::new();
    for pair in pairs.iter().filter(|pair| !pair.trim().is_empty()) {
        let Some((name, text)) = pair.split_once('=') else {
            return Err(Unusable::report(
                format!("'{pair}' is not of the form name=value"),
                "as in --at rho=1/2,g=0",
            ));
        };
        let symbols = system.symbols_of(name.trim());
        if symbols.is_empty() {
            let known: Vec<&str> = system.symbols().map(|(symbol, _)| system.symbol_name(symbol)).collect();
            return Err(Unusable::report(
                format!("'{}' is no state or parameter of {}", name.trim(), system.name),
                format!("these are: {}", known.join(", ")),
            ));
        }
        let value = number(text)?;
        for symbol in symbols {
            if values.insert(symbol, value.clone()).is_some() {
                let name = system.symbol_name(symbol);
                return Err(Unusable::report(format!("'{name}' is given twice"), "give it once"));
            }
        }
    }
    Ok(values)
}

/// Reads a number as people write it.
pub(crate) fn number(text: &str) -> miette::Result<RBig> {
    parse_decimal(text).ok_or_else(|| {
        let shown: String = text.trim().chars().take(40).collect();
        if text.split('/').any(is_too_long) {
            let limit = "a number has at most 4096 digits and an exponent of at most 4096";
            Unusable::report(format!("'{shown}' is too long: {limit}"), "take a number that is nearer to one")
        } else {
            Unusable::report(format!("'{shown}' is not a number"), "such as 2, -.5, 1e-3 or 1/3")
        }
    })
}

/// Whether a text is a number, but for its length.
fn is_too_long(text: &str) -> bool {
    let text = text.trim().trim_start_matches(['-', '+']);
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let exponent = exponent.strip_prefix(['-', '+']).unwrap_or(exponent);
    digits(&mantissa.replacen('.', "", 1)) && digits(exponent) && parse_decimal(text).is_none()
}
