//! A text that is read whole or refused: JSON with the name of its format and a checksum.
//!
//! Real numbers in it are written as the 64 bits that they are.

use crate::file::Checksum;
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

/// Why a text is no part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PartError {
    /// It is something else.
    #[error("this is no part of a sweep ({0})")]
    Foreign(String),
    /// It was cut or changed: its checksum is another, or its numbers contradict each other.
    #[error("this part of a sweep is damaged: {0}")]
    Damaged(&'static str),
}

/// What is wrong with a part whose checksum is right.
pub const CONTRADICTS: PartError = PartError::Damaged("its numbers contradict each other");

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sealed<T> {
    format: String,
    checksum: String,
    part: T,
}

/// The text of a part, sealed; `format` is what it begins with, another one where its fields mean something else.
pub fn seal<T: Serialize>(format: &str, part: T) -> Option<String> {
    let body = serde_json::to_string(&part).ok()?;
    let whole = Sealed { format: format.to_owned(), checksum: hex(Checksum::of(&body)), part };
    Some(format!("{}\n", serde_json::to_string_pretty(&whole).ok()?))
}

/// Reads what [`seal`] wrote.
///
/// # Errors
/// The text is something else, or was cut or changed.
pub fn unseal<T: Serialize + DeserializeOwned>(format: &str, text: &str) -> Result<T, PartError> {
    let Sealed { format: found, checksum, part } =
        serde_json::from_str::<Sealed<T>>(text).map_err(|why| PartError::Foreign(why.to_string()))?;
    if found != format {
        return Err(PartError::Foreign(format!("its format is not '{format}'")));
    }
    let body = serde_json::to_string(&part).unwrap_or_default();
    if checksum != hex(Checksum::of(&body)) {
        return Err(PartError::Damaged("it was cut or changed, and its checksum is another"));
    }
    Ok(part)
}

fn hex(number: u64) -> String {
    format!("{number:016x}")
}

/// A number as its bits.
#[derive(Clone, Copy)]
pub struct Bits(pub u64);

impl Serialize for Bits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&hex(self.0))
    }
}

impl<'de> Deserialize<'de> for Bits {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Cow::<str>::deserialize(deserializer)?;
        let digits = text.len() == 16 && text.bytes().all(|b| b.is_ascii_hexdigit());
        let found = u64::from_str_radix(&text, 16).ok().filter(|_| digits);
        found.map(Bits).ok_or_else(|| D::Error::custom("a number is written as sixteen hexadecimal digits"))
    }
}
