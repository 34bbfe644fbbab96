//! The words of the language, for those who colour or complete them: the very lists that the reader reads by.

use super::elaborate::OTHER_FUNCTIONS;
use super::{dimension, entry_words, views};
use palmistry_math::expression::{COMPOSED, parse};
use palmistry_math::number::Function;

/// The words that begin an entry.
pub const ENTRIES: &[&str] = &entry_words::ENTRIES;

/// Those of them that are names too, unless a title or `of` follows.
pub const VIEWS: &[&str] = &views::WORDS;

/// Words that are never names, most of [`ENTRIES`] among them.
pub const RESERVED: &[&str] = &parse::RESERVED;
/// Special words that cannot be declared as names.
pub const UNDECLARABLE: &[&str] = &parse::UNDECLARABLE;

/// Words with a meaning at some places, and names elsewhere.
pub const SPECIAL: &[&str] = &parse::SPECIAL;

/// Names that have a value of their own.
pub const CONSTANTS: &[&str] = &["pi", "rank"];

/// The functions of the language: each is one where a bracket follows.
pub fn functions() -> impl Iterator<Item = &'static str> {
    let composed = COMPOSED.into_iter().map(|(name, ..)| name);
    Function::ALL.into_iter().map(Function::name).chain(OTHER_FUNCTIONS).chain(composed)
}

/// The words of dimensions: quantities and units, behind the colon of a declaration.
pub fn dimensions() -> impl Iterator<Item = &'static str> {
    dimension::words()
}
