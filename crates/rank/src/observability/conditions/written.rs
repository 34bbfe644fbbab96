//! Conditions as they are written outside of a file, on a command line.

use palmistry_math::expression::parse::{Depth, conditions, read_all};
use palmistry_math::expression::syntax::Equation;

/// Reads conditions such as `sin(phi1) = 0`, `0 < x < 1`, which is two, or several between commas: `x = 0, y > 0`.
///
/// # Errors
/// In words: what was expected, and where.
pub fn parse_condition(text: &str) -> Result<Vec<Equation>, String> {
    read_all(text, &Depth::default(), "an operator, ',' and another condition, or the end", conditions)
        .map_err(|e| format!("in the condition '{text}', at column {}: {e}", e.at + 1))
}

#[cfg(test)]
mod tests {
    use super::parse_condition;

    /// By hand: each relation of each condition, in order.
    #[test]
    fn several_conditions_stand_between_commas() {
        for (text, count) in [
            ("x = 0", 1),
            ("x = 0, y > 0", 2),
            (" 0 < x < 1 , y = x # both\n, z in [0, 1]", 5),
            ("dot([x, y], [1, 0]) = 0, x at {x = 1, y = 2} = 1", 2),
            ("x[i] = x[i + 1] for i in 1..4, y > 0", 5),
        ] {
            assert_eq!(parse_condition(text).map(|found| found.len()), Ok(count), "{text}");
        }
        for (text, column) in
            [("x = 0,", 7), ("x = 0, y", 9), ("x = 0 y = 0", 7), (", x = 0", 1), ("", 1), ("x = 0;", 6)]
        {
            let why = parse_condition(text).unwrap_err();
            assert!(why.contains(&format!("at column {column}:")), "{text}: {why}");
        }
    }
}
