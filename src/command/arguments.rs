//! Arguments that more than one command takes.

use super::Unusable;
use clap::ValueEnum;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::expression::Symbol;
use palmistry::number::parse_decimal;
use palmistry::observability::Certainty;
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
        let Some(symbol) = system.find_symbol(name.trim()) else {
            let known: Vec<&str> = system.symbols().map(|(symbol, _)| system.symbol_name(symbol)).collect();
            return Err(Unusable::report(
                format!("'{}' is no state or parameter of {}", name.trim(), system.name),
                format!("these are: {}", known.join(", ")),
            ));
        };
        let Some(value) = parse_decimal(text) else {
            return Err(Unusable::report(format!("'{text}' is not a number"), "such as 2, -.5, 1e-3 or 1/3"));
        };
        if values.insert(symbol, value).is_some() {
            return Err(Unusable::report(format!("'{}' is given twice", name.trim()), "give it once"));
        }
    }
    Ok(values)
}
