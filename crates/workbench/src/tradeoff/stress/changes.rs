//! Changes of units, by the dimensions that a file declares.

use super::scaling::Quantity;
use super::units::Rescaling;
use dashu::base::Gcd;
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_lang::{Base, Dimension, System};
use palmistry_math::expression::{NodeId, Symbol};

/// Other units, each with the power of ten of it that makes the unit of the SI. What a system has no dimension of is left out.
const OTHER_UNITS: [&[(Base, &str, i32)]; 10] = [
    &[(Base::Length, "millimetre", 3), (Base::Mass, "gram", 3), (Base::Time, "millisecond", 3)],
    &[(Base::Length, "millimetre", 3), (Base::Mass, "kilogram", 0), (Base::Time, "second", 0)],
    &[(Base::Length, "metre", 0), (Base::Mass, "kilogram", 0), (Base::Time, "microsecond", 6)],
    &[(Base::Length, "micrometre", 6), (Base::Mass, "milligram", 6), (Base::Time, "second", 0)],
    &[(Base::Length, "picometre", 12), (Base::Mass, "kilogram", 0), (Base::Time, "second", 0)],
    &[(Base::Length, "megametre", -6), (Base::Mass, "tonne", -3), (Base::Time, "megasecond", -6)],
    &[(Base::Current, "microampere", 6)],
    &[(Base::Temperature, "millikelvin", 3)],
    &[(Base::Amount, "micromole", 6)],
    &[(Base::LuminousIntensity, "millicandela", 3)],
];

/// The dimensions of what some rows depend on, states included, if the declared dimensions determine a change of units.
fn dimensioned<'s>(system: &'s System, rows: &[NodeId]) -> Option<Vec<(Symbol, &'s Dimension)>> {
    if !system.dimensions_tell_units() {
        return None;
    }
    let mentioned = system.graph.symbols_of(rows.iter().copied());
    let known = system.symbols().map(|(symbol, _)| symbol);
    let counts = |symbol: &Symbol| mentioned.contains(symbol) || system.states.contains(symbol);
    known.filter(counts).map(|symbol| Some((symbol, system.dimension_of(symbol)?))).collect()
}

/// The least number by which all exponents of a base dimension become whole, and the exponents times it.
fn whole(dimensions: &[(Symbol, &Dimension)], base: Base) -> Option<(i32, Vec<(Symbol, i32)>)> {
    let common = dimensions.iter().fold(IBig::ONE, |common, (_, dimension)| {
        let below = IBig::from(dimension.exponent(base).denominator().clone());
        let divisor = IBig::from((&common).gcd(&below));
        common * below / divisor
    });
    let mut powers = Vec::new();
    for (symbol, dimension) in dimensions {
        let power = dimension.exponent(base) * RBig::from(common.clone());
        match i32::try_from(power.numerator().clone()).ok()? {
            0 => {}
            power => powers.push((*symbol, power)),
        }
    }
    Some((i32::try_from(common).ok()?, powers))
}

/// The states in other units: for each change its name, and what becomes of each symbol. Nothing where the file does not
/// declare enough dimensions.
pub fn units(system: &System, rows: &[NodeId]) -> Option<Vec<(String, Rescaling)>> {
    let dimensions = dimensioned(system, rows)?;
    let mut found: Vec<(String, Rescaling)> = Vec::new();
    for units in OTHER_UNITS {
        let mut names = Vec::new();
        let mut exponents: Vec<(Symbol, i32)> = dimensions.iter().map(|(symbol, _)| (*symbol, 0)).collect();
        for (base, name, ten) in units {
            let (common, powers) = whole(&dimensions, *base)?;
            if powers.is_empty() {
                continue;
            }
            // with roots of the unit among the dimensions a power of it, so that all factors are rational
            names.push(match (common, ten) {
                (1, _) | (_, 0) => (*name).to_owned(),
                _ => format!("10^({}) of the unit of {}", -ten * common, base.name()),
            });
            for (symbol, power) in powers {
                if let Some((_, exponent)) = exponents.iter_mut().find(|(known, _)| *known == symbol) {
                    *exponent = exponent.checked_add(power.checked_mul(*ten)?)?;
                }
            }
        }
        exponents.retain(|(_, exponent)| *exponent != 0);
        if exponents.is_empty() {
            continue;
        }
        let ten = RBig::from(10);
        let factors = exponents.into_iter().map(|(symbol, power)| (symbol, ten.pow(power as isize)));
        let (name, factors): (String, Vec<(Symbol, RBig)>) = (names.join(", "), factors.collect());
        let is_new = |(_, known): &(String, Rescaling)| !matches!(known, Rescaling::Symbols(known) if *known == factors);
        if found.iter().all(is_new) {
            found.push((name, Rescaling::Symbols(factors)));
        }
    }
    Some(found)
}

/// The units that can be scaled, each with the powers of it in the symbols of some rows.
pub fn unit_quantities(system: &System, rows: &[NodeId]) -> Vec<Quantity> {
    let Some(dimensions) = dimensioned(system, rows) else { return Vec::new() };
    let mut found = Vec::new();
    for base in Base::ALL {
        if let Some((_, powers)) = whole(&dimensions, base)
            && !powers.is_empty()
        {
            found.push(Quantity { name: format!("the unit of {}", base.name()), powers });
        }
    }
    found
}
