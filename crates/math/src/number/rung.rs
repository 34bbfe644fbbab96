//! The ladder of numbers, by name: from those that are fast to those that are certain.

/// A rung of the ladder: the numbers with which a value or a rank was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub enum Rung {
    /// f64.
    Doubles,
    /// Pairs of f64.
    DoubleDoubles,
    /// f64, rounded outward.
    Intervals,
    /// Modulo a prime.
    Residues,
    /// Rational numbers.
    Exact,
    /// Intervals whose ends have so many bits.
    Enclosures(usize),
}

impl Rung {
    /// In a word or two.
    pub fn name(self) -> String {
        match self {
            Rung::Doubles => "doubles".to_owned(),
            Rung::DoubleDoubles => "double-doubles".to_owned(),
            Rung::Intervals => "intervals".to_owned(),
            Rung::Residues => "residues".to_owned(),
            Rung::Exact => "exact".to_owned(),
            Rung::Enclosures(bits) => format!("enclosures of {bits} bits"),
        }
    }
}
