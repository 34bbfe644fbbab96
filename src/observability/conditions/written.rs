//! Conditions as they are written outside of a file, on a command line.

use crate::expression::parse::{Depth, equations, read_all};
use crate::expression::syntax::Equation;

/// Reads a condition such as `sin(phi1) = 0` or `0 < x < 1`, which is two.
///
/// # Errors
/// In words: what was expected, and where.
pub fn parse_condition(text: &str) -> Result<Vec<Equation>, String> {
    read_all(text, &Depth::default(), "an operator, or the end", equations)
        .map_err(|e| format!("in the condition '{text}', at column {}: {e}", e.at + 1))
}
