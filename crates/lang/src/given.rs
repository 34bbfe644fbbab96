//! Values and ranges that are given from outside the file, as text: `rho=1/2`, `r1=-1..1`. Of whoever hands them over (a command
//! line, another language) nothing is known here.

use super::model::{Kind, System};
use dashu::rational::RBig;
use miette::Diagnostic;
use palmistry_math::expression::Symbol;
use palmistry_math::number::parse_decimal;
use std::collections::{BTreeMap, HashMap};

/// What is wrong with something that was given, and what to do.
#[derive(Clone, Debug, Diagnostic, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct GivenError {
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    #[help]
    pub help: Option<String>,
}

impl GivenError {
    fn new(message: impl Into<String>, help: impl Into<String>) -> GivenError {
        GivenError { message: message.into(), help: Some(help.into()) }
    }
}

impl System {
    /// Reads `name=value` pairs for the symbols of the system: numbers as people write them, angles in radians. A range of components
    /// such as `x[1..3]=0` is given all at once. Empty texts say nothing.
    ///
    /// # Errors
    /// What is no pair, a name that the system does not have, one that is given twice, and what is no number.
    pub fn given_values<T: AsRef<str>>(&self, pairs: &[T]) -> Result<HashMap<Symbol, RBig>, GivenError> {
        let mut values = HashMap::new();
        for pair in pairs.iter().map(AsRef::as_ref).filter(|pair| !pair.trim().is_empty()) {
            let Some((name, text)) = pair.split_once('=') else {
                let message = format!("'{pair}' is not of the form name=value");
                return Err(GivenError::new(message, "as in --at rho=1/2,g=0"));
            };
            let symbols = self.symbols_of(name.trim());
            if symbols.is_empty() {
                return Err(self.no_such_symbol(name.trim(), self.symbols().map(|(symbol, _)| symbol)));
            }
            let value = given_number(text)?;
            for symbol in symbols {
                if values.insert(symbol, value.clone()).is_some() {
                    let message = format!("'{}' is given twice", self.symbol_name(symbol));
                    return Err(GivenError::new(message, "give it once"));
                }
            }
        }
        Ok(values)
    }

    /// Reads `name=low..high`, for the states and parameters of the system; the same number twice holds one fixed.
    ///
    /// # Errors
    /// As [`System::given_values`], and a range that is empty.
    pub fn given_ranges<T: AsRef<str>>(
        &self,
        texts: &[T],
    ) -> Result<BTreeMap<Symbol, (RBig, RBig)>, GivenError> {
        let mut found = BTreeMap::new();
        for text in texts.iter().map(AsRef::as_ref).filter(|text| !text.trim().is_empty()) {
            let form = || {
                let message = format!("'{text}' is not of the form name=low..high");
                GivenError::new(message, "as in --box omega0=1/2..3,r1=-1..1")
            };
            let (name, range) = text.split_once('=').ok_or_else(form)?;
            let (low, high) = range.split_once("..").ok_or_else(form)?;
            let symbol = self.own_symbol(name)?;
            let (low, high) = (given_number(low)?, given_number(high)?);
            if low > high {
                return Err(GivenError::new(
                    format!("the range of '{}' is empty: {low} is above {high}", name.trim()),
                    "the low end comes first; the same number twice holds it fixed",
                ));
            }
            if found.insert(symbol, (low, high)).is_some() {
                return Err(GivenError::new(format!("'{}' is given twice", name.trim()), "give it once"));
            }
        }
        Ok(found)
    }

    /// The state or parameter of a name, those of imported files aside.
    ///
    /// # Errors
    /// Where there is none; the help names all.
    pub fn own_symbol(&self, name: &str) -> Result<Symbol, GivenError> {
        let name = name.trim();
        let own = || self.symbols().filter(|(_, info)| info.kind != Kind::Imported).map(|(symbol, _)| symbol);
        own().find(|symbol| self.symbol_name(*symbol) == name).ok_or_else(|| self.no_such_symbol(name, own()))
    }

    fn no_such_symbol(&self, name: &str, known: impl Iterator<Item = Symbol>) -> GivenError {
        let known: Vec<&str> = known.map(|symbol| self.symbol_name(symbol)).collect();
        GivenError::new(
            format!("'{name}' is no state or parameter of {}", self.name),
            format!("these are: {}", known.join(", ")),
        )
    }
}

/// Reads a number as people write it: `2`, `-.5`, `1e-3` or `1/3`.
///
/// # Errors
/// What is no number, and one of more than 4096 digits.
pub fn given_number(text: &str) -> Result<RBig, GivenError> {
    parse_decimal(text).ok_or_else(|| {
        let shown: String = text.trim().chars().take(40).collect();
        if text.split('/').any(is_too_long) {
            let limit = "a number has at most 4096 digits and an exponent of at most 4096";
            let message = format!("'{shown}' is too long: {limit}");
            GivenError::new(message, "take a number that is nearer to one")
        } else {
            GivenError::new(format!("'{shown}' is not a number"), "such as 2, -.5, 1e-3 or 1/3")
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
