//! The words of a dimension: quantities, and the units of the SI by name and by symbol.
//!
//! Only coherent units stand here, those that are products of powers of base units without a factor: a unit says what is
//! measured, and the numbers of a file are those in base units. Source: Bureau international des poids et mesures, The
//! International System of Units (SI), 9th edition, 2019, tables 2 to 6.

use super::exponents::Dimension;

/// The words that mean one dimension, and its whole exponents of mass, length, time, current, temperature, amount and
/// luminous intensity.
const MEANINGS: [(&[&str], [i32; 7]); 47] = [
    (&["dimensionless", "number", "angle", "solid_angle"], [0; 7]),
    (&["radian", "radians", "rad", "steradian", "steradians", "sr"], [0; 7]),
    (&["mass", "kilogram", "kilograms", "kg"], [1, 0, 0, 0, 0, 0, 0]),
    (&["length", "metre", "metres", "meter", "meters", "m"], [0, 1, 0, 0, 0, 0, 0]),
    (&["time", "second", "seconds", "s"], [0, 0, 1, 0, 0, 0, 0]),
    (&["current", "ampere", "amperes", "A"], [0, 0, 0, 1, 0, 0, 0]),
    (&["temperature", "kelvin", "kelvins", "K"], [0, 0, 0, 0, 1, 0, 0]),
    (&["amount", "mole", "moles", "mol"], [0, 0, 0, 0, 0, 1, 0]),
    (&["luminous_intensity", "intensity", "candela", "candelas", "cd"], [0, 0, 0, 0, 0, 0, 1]),
    (&["area"], [0, 2, 0, 0, 0, 0, 0]),
    (&["volume"], [0, 3, 0, 0, 0, 0, 0]),
    (&["curvature", "wavenumber"], [0, -1, 0, 0, 0, 0, 0]),
    (&["velocity", "speed"], [0, 1, -1, 0, 0, 0, 0]),
    (&["acceleration"], [0, 1, -2, 0, 0, 0, 0]),
    (&["frequency", "angular_velocity", "rate", "hertz", "Hz", "becquerel", "Bq"], [0, 0, -1, 0, 0, 0, 0]),
    (&["angular_acceleration"], [0, 0, -2, 0, 0, 0, 0]),
    (&["density"], [1, -3, 0, 0, 0, 0, 0]),
    (&["momentum"], [1, 1, -1, 0, 0, 0, 0]),
    (&["angular_momentum", "action"], [1, 2, -1, 0, 0, 0, 0]),
    (&["inertia", "moment_of_inertia"], [1, 2, 0, 0, 0, 0, 0]),
    (&["force", "newton", "newtons", "N"], [1, 1, -2, 0, 0, 0, 0]),
    (&["torque", "moment"], [1, 2, -2, 0, 0, 0, 0]),
    (&["energy", "work", "heat", "joule", "joules", "J"], [1, 2, -2, 0, 0, 0, 0]),
    (&["power", "watt", "watts", "W"], [1, 2, -3, 0, 0, 0, 0]),
    (&["pressure", "stress", "pascal", "pascals", "Pa"], [1, -1, -2, 0, 0, 0, 0]),
    (&["stiffness", "surface_tension"], [1, 0, -2, 0, 0, 0, 0]),
    (&["damping"], [1, 0, -1, 0, 0, 0, 0]),
    (&["viscosity", "dynamic_viscosity"], [1, -1, -1, 0, 0, 0, 0]),
    (&["kinematic_viscosity", "diffusivity"], [0, 2, -1, 0, 0, 0, 0]),
    (&["charge", "coulomb", "coulombs", "C"], [0, 0, 1, 1, 0, 0, 0]),
    (&["voltage", "electric_potential", "volt", "volts", "V"], [1, 2, -3, -1, 0, 0, 0]),
    (&["resistance", "ohm", "ohms"], [1, 2, -3, -2, 0, 0, 0]),
    (&["conductance", "siemens", "S"], [-1, -2, 3, 2, 0, 0, 0]),
    (&["capacitance", "farad", "farads", "F"], [-1, -2, 4, 2, 0, 0, 0]),
    (&["inductance", "henry", "henries", "H"], [1, 2, -2, -2, 0, 0, 0]),
    (&["magnetic_flux", "weber", "webers", "Wb"], [1, 2, -2, -1, 0, 0, 0]),
    (&["magnetic_field", "tesla", "teslas", "T"], [1, 0, -2, -1, 0, 0, 0]),
    (&["electric_field"], [1, 1, -3, -1, 0, 0, 0]),
    (&["entropy", "heat_capacity"], [1, 2, -2, 0, -1, 0, 0]),
    (&["specific_heat_capacity"], [0, 2, -2, 0, -1, 0, 0]),
    (&["thermal_conductivity"], [1, 1, -3, 0, -1, 0, 0]),
    (&["concentration"], [0, -3, 0, 0, 0, 1, 0]),
    (&["catalytic_activity", "katal", "katals", "kat"], [0, 0, -1, 0, 0, 1, 0]),
    (&["molar_mass"], [1, 0, 0, 0, 0, -1, 0]),
    (&["dose", "gray", "grays", "Gy", "sievert", "sieverts", "Sv"], [0, 2, -2, 0, 0, 0, 0]),
    (&["luminous_flux", "lumen", "lumens", "lm"], [0, 0, 0, 0, 0, 0, 1]),
    (&["illuminance", "lux", "lx"], [0, -2, 0, 0, 0, 0, 1]),
];

/// Units with a factor, by names that people are likely to write, and the quantity that they measure.
const SCALED: [(&[&str], &str); 12] = [
    (&["degree", "degrees", "deg", "turn", "turns", "revolution", "arcminute", "arcsecond"], "angle"),
    (&["millimetre", "millimeter", "mm", "centimetre", "centimeter", "cm", "decimetre", "dm"], "length"),
    (
        &["kilometre", "kilometer", "km", "micrometre", "um", "nanometre", "nm", "inch", "foot", "mile"],
        "length",
    ),
    (&["gram", "grams", "g", "milligram", "mg", "tonne", "tonnes", "t", "pound", "lb"], "mass"),
    (&["minute", "minutes", "min", "hour", "hours", "h", "day", "days", "d", "year", "years"], "time"),
    (&["millisecond", "milliseconds", "ms", "microsecond", "us", "nanosecond", "ns"], "time"),
    (&["milliampere", "mA"], "current"),
    (&["celsius", "degC", "fahrenheit"], "temperature"),
    (&["kilonewton", "kN", "millinewton", "mN"], "force"),
    (&["kilojoule", "kJ", "calorie", "cal", "electronvolt", "eV"], "energy"),
    (&["kilopascal", "kPa", "bar", "atmosphere", "atm"], "pressure"),
    (&["litre", "liter", "l", "L"], "volume"),
];

/// What a word of a dimension means.
pub(super) enum Meaning {
    Dimension(Dimension),
    /// A unit with a factor, and the quantity that it measures.
    Scaled(&'static str),
    Nothing,
}

/// Looks a word up.
pub(super) fn meaning(word: &str) -> Meaning {
    if let Some((_, exponents)) = MEANINGS.iter().find(|(words, _)| words.contains(&word)) {
        return Meaning::Dimension(Dimension::whole(*exponents));
    }
    match SCALED.iter().find(|(words, _)| words.contains(&word)) {
        Some((_, quantity)) => Meaning::Scaled(quantity),
        None => Meaning::Nothing,
    }
}

/// All words that mean something.
pub(crate) fn all() -> impl Iterator<Item = &'static str> {
    MEANINGS.iter().flat_map(|(words, _)| words.iter().copied())
}
