//! A dimension: a product of powers of the base dimensions.

use dashu::rational::RBig;
use std::fmt;

/// The base dimensions of the International System of Units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)] // names and messages say it
pub enum Base {
    Mass,
    Length,
    Time,
    Current,
    Temperature,
    Amount,
    LuminousIntensity,
}

impl Base {
    /// All of them, in the order in which they are written.
    pub const ALL: [Base; 7] = [
        Base::Mass,
        Base::Length,
        Base::Time,
        Base::Current,
        Base::Temperature,
        Base::Amount,
        Base::LuminousIntensity,
    ];

    /// Its name in a proof file.
    pub fn name(self) -> &'static str {
        match self {
            Base::Mass => "mass",
            Base::Length => "length",
            Base::Time => "time",
            Base::Current => "current",
            Base::Temperature => "temperature",
            Base::Amount => "amount",
            Base::LuminousIntensity => "luminous_intensity",
        }
    }

    /// The symbol of its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Base::Mass => "kg",
            Base::Length => "m",
            Base::Time => "s",
            Base::Current => "A",
            Base::Temperature => "K",
            Base::Amount => "mol",
            Base::LuminousIntensity => "cd",
        }
    }
}

/// A product of powers of the base dimensions, with rational exponents.
///
/// ```
/// use palmistry_lang::{Base, Dimension};
/// let acceleration = Dimension::of(Base::Length).over(&Dimension::of(Base::Time).power(&2.into()));
/// assert_eq!(acceleration.to_string(), "length/time^2");
/// assert_eq!(acceleration.unit(), "m/s^2");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// In the order of [`Base::ALL`].
    exponents: Box<[RBig; 7]>,
}

impl Dimension {
    /// That of a number.
    pub fn none() -> Self {
        Dimension::default()
    }

    /// That of a base quantity.
    pub fn of(base: Base) -> Self {
        let mut found = Dimension::default();
        found.exponents[base as usize] = RBig::ONE;
        found
    }

    /// From whole exponents, in the order of [`Base::ALL`].
    pub(super) fn whole(exponents: [i32; 7]) -> Self {
        Dimension { exponents: Box::new(exponents.map(RBig::from)) }
    }

    /// Whether it is that of a number.
    pub fn is_none(&self) -> bool {
        self.exponents.iter().all(RBig::is_zero)
    }

    /// The exponent of a base dimension.
    pub fn exponent(&self, base: Base) -> &RBig {
        &self.exponents[base as usize]
    }

    /// That of a product.
    pub fn times(&self, other: &Dimension) -> Dimension {
        self.joined(&RBig::ONE, other)
    }

    /// That of a quotient.
    pub fn over(&self, other: &Dimension) -> Dimension {
        self.joined(&-RBig::ONE, other)
    }

    /// That of a power.
    pub fn power(&self, exponent: &RBig) -> Dimension {
        Dimension::none().joined(exponent, self)
    }

    /// That of a product with a power.
    fn joined(&self, power: &RBig, other: &Dimension) -> Dimension {
        let exponents = std::array::from_fn(|place| &self.exponents[place] + power * &other.exponents[place]);
        Dimension { exponents: Box::new(exponents) }
    }

    /// A unit of the SI, made of base units: `m/s^2`; `1` where there is none.
    pub fn unit(&self) -> String {
        let unit = |base: Base| base.unit().to_owned();
        fraction(Base::ALL.iter().map(|base| (unit(*base), self.exponent(*base))))
    }
}

/// `length/time^2`; `1` for a number. It can be read again.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |base: Base| base.name().to_owned();
        f.write_str(&fraction(Base::ALL.iter().map(|base| (name(*base), self.exponent(*base)))))
    }
}

/// Powers as a fraction: `a*b^2/(c*d)`.
pub(super) fn fraction<'e>(powers: impl IntoIterator<Item = (String, &'e RBig)>) -> String {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (name, exponent) in powers {
        let size = if *exponent < RBig::ZERO { -exponent.clone() } else { exponent.clone() };
        let text = match (size.is_one(), size.denominator().is_one()) {
            _ if size.is_zero() => continue,
            (true, _) => name,
            (_, true) => format!("{name}^{size}"),
            _ => format!("{name}^({size})"),
        };
        if size == *exponent { above.push(text) } else { below.push(text) }
    }
    let top = if above.is_empty() { "1".to_owned() } else { above.join("*") };
    match below.as_slice() {
        [] => top,
        [one] => format!("{top}/{one}"),
        many => format!("{top}/({})", many.join("*")),
    }
}
