//! Number types by name: from those that are fast to those that are certain.

/// A number type: the numbers with which a value or a rank was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub enum NumberType {
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

impl NumberType {
    /// A short name.
    pub fn name(self) -> String {
        match self {
            NumberType::Doubles => "doubles".to_owned(),
            NumberType::DoubleDoubles => "double-doubles".to_owned(),
            NumberType::Intervals => "intervals".to_owned(),
            NumberType::Residues => "residues".to_owned(),
            NumberType::Exact => "exact".to_owned(),
            NumberType::Enclosures(bits) => format!("enclosures of {bits} bits"),
        }
    }
}
