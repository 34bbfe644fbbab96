//! Units as instruments write them, with what they are of the SI's: `mm`, `deg/s`, `N*mm`, `degC`.
//!
//! Source of the factors: Bureau international des poids et mesures, The International System of Units (SI), 9th edition, 2019, tables 4, 7 and 8; for
//! those outside of it National Institute of Standards and Technology, Special Publication 811, 2008, appendix B.

use super::exponents::{Base, Dimension};
use super::words::{Meaning, meaning};
use std::f64::consts::PI;

/// A unit: what is written in it is `factor` times as much, and `offset` more, in units of the SI without a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaledUnit {
    /// By what a number is multiplied.
    pub factor: f64,
    /// What is added then: of temperatures in degrees alone.
    pub offset: f64,
    /// What it measures.
    pub dimension: Dimension,
}

const PREFIXES: [(&str, f64); 12] = [
    ("n", 1e-9),
    ("u", 1e-6),
    ("µ", 1e-6),
    ("μ", 1e-6),
    ("m", 1e-3),
    ("c", 1e-2),
    ("d", 1e-1),
    ("h", 1e2),
    ("k", 1e3),
    ("M", 1e6),
    ("G", 1e9),
    ("p", 1e-12),
];

/// Symbols that may have a prefix before them.
const PREFIXED: [&str; 19] =
    ["m", "s", "A", "K", "mol", "cd", "rad", "Hz", "N", "J", "W", "Pa", "C", "V", "S", "F", "H", "T", "Wb"];

/// Units with a factor that no prefix makes: names, factor, and the coherent unit that it is of.
const OTHERS: [(&[&str], f64, &str); 24] = [
    (&["deg", "degree", "degrees", "°"], PI / 180.0, "rad"),
    (&["turn", "turns", "rev", "revolution"], 2.0 * PI, "rad"),
    (&["arcminute", "arcmin"], PI / 10_800.0, "rad"),
    (&["arcsecond", "arcsec"], PI / 648_000.0, "rad"),
    (&["rpm"], PI / 30.0, "Hz"),
    (&["millimetre", "millimeter"], 1e-3, "m"),
    (&["centimetre", "centimeter"], 1e-2, "m"),
    (&["kilometre", "kilometer"], 1e3, "m"),
    (&["inch", "in"], 0.0254, "m"),
    (&["foot", "ft"], 0.3048, "m"),
    (&["g", "gram", "grams"], 1e-3, "kg"),
    (&["mg", "milligram"], 1e-6, "kg"),
    (&["t", "tonne", "tonnes"], 1e3, "kg"),
    (&["lb", "pound"], 0.453_592_37, "kg"),
    (&["min", "minute", "minutes"], 60.0, "s"),
    (&["h", "hour", "hours"], 3600.0, "s"),
    (&["d", "day", "days"], 86_400.0, "s"),
    (&["week", "weeks"], 604_800.0, "s"),
    (&["millisecond", "milliseconds"], 1e-3, "s"),
    (&["bar"], 1e5, "Pa"),
    (&["atm", "atmosphere"], 101_325.0, "Pa"),
    (&["cal", "calorie"], 4.184, "J"),
    (&["eV", "electronvolt"], 1.602_176_634e-19, "J"),
    (&["g0", "gn"], 9.806_65, "acceleration"),
];

/// Reads a unit.
///
/// # Errors
/// The word that is none, with one that is near.
pub fn scaled_unit(text: &str) -> Result<ScaledUnit, String> {
    let text = text.trim();
    let offset = match text {
        "degC" | "celsius" | "°C" => Some((1.0, 273.15)),
        "degF" | "fahrenheit" | "°F" => Some((5.0 / 9.0, 459.67 * 5.0 / 9.0)),
        _ => None,
    };
    if let Some((factor, offset)) = offset {
        return Ok(ScaledUnit { factor, offset, dimension: Dimension::of(Base::Temperature) });
    }
    let mut unit = ScaledUnit { factor: 1.0, offset: 0.0, dimension: Dimension::none() };
    let mut rest = text;
    let mut divides = false;
    loop {
        let end = rest.find(['*', '/', '·', ' ']).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        let one = term(word.trim().trim_matches(['(', ')']))?;
        let power = if divides { -1 } else { 1 };
        unit.factor *= one.factor.powi(power);
        unit.dimension =
            if divides { unit.dimension.over(&one.dimension) } else { unit.dimension.times(&one.dimension) };
        let after = after.trim_start();
        let Some(sign) = after.chars().next() else { break };
        // after one stroke all that is in brackets is below it: that is not read, and said
        divides = sign == '/';
        let is_sign = matches!(sign, '*' | '/' | '·');
        rest = if is_sign { after[sign.len_utf8()..].trim_start() } else { after };
        if rest.starts_with('(') && divides && rest.contains(['*', ' ']) {
            return Err(format!("'{text}' has brackets: write each unit with its own stroke, as in m/s/s"));
        }
    }
    Ok(unit)
}

/// A word, perhaps with a power.
fn term(text: &str) -> Result<ScaledUnit, String> {
    let (word, power) = match text.split_once('^') {
        Some((word, power)) => {
            let power = power.parse::<i32>().ok().filter(|power| (-9..=9).contains(power));
            (word, power.ok_or_else(|| format!("'{text}' has no whole power"))?)
        }
        None => match text.chars().next_back() {
            Some('²') => (&text[..text.len() - '²'.len_utf8()], 2),
            Some('³') => (&text[..text.len() - '³'.len_utf8()], 3),
            _ => (text, 1),
        },
    };
    let (factor, dimension) = simple(word).ok_or_else(|| {
        let near = crate::nearest(word, names());
        let near = near.map_or_else(
            || "write mm, cm, km, ms, min, deg, rpm, g, N, kPa or their like, with * / ^".to_owned(),
            |near| format!("perhaps '{near}' is meant"),
        );
        if word.is_empty() {
            format!("a unit is missing: {near}")
        } else {
            format!("'{word}' is no unit; {near}")
        }
    })?;
    Ok(ScaledUnit { factor: factor.powi(power), offset: 0.0, dimension: dimension.power(&power.into()) })
}

fn names() -> impl Iterator<Item = &'static str> {
    let prefixed = ["mm", "cm", "km", "um", "ms", "us", "mA", "kN", "mN", "kPa", "kJ", "kHz", "mV", "mrad"];
    OTHERS.iter().flat_map(|(names, _, _)| names.iter().copied()).chain(PREFIXED).chain(prefixed)
}

fn simple(word: &str) -> Option<(f64, Dimension)> {
    let coherent = |word: &str| match meaning(word) {
        Meaning::Dimension(dimension) => Some(dimension),
        Meaning::Scaled(_) | Meaning::Nothing => None,
    };
    match word {
        "1" => return Some((1.0, Dimension::none())),
        "%" | "percent" => return Some((0.01, Dimension::none())),
        "l" | "L" | "litre" | "liter" => return Some((1e-3, coherent("volume")?)),
        "ml" | "mL" => return Some((1e-6, coherent("volume")?)),
        _ => {}
    }
    if let Some((_, factor, of)) = OTHERS.iter().find(|(names, _, _)| names.contains(&word)) {
        return Some((*factor, coherent(of)?));
    }
    if let Some(dimension) = coherent(word) {
        return Some((1.0, dimension));
    }
    PREFIXES.iter().find_map(|(prefix, factor)| {
        let symbol = word.strip_prefix(prefix).filter(|symbol| PREFIXED.contains(symbol))?;
        Some((*factor, coherent(symbol)?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors by hand, or by definition.
    #[test]
    fn units_are_what_they_are_of_the_si() {
        for (text, factor, unit) in [
            ("mm", 1e-3, "m"),
            ("ms", 1e-3, "s"),
            ("min", 60.0, "s"),
            ("deg", 0.017453292519943295, "1"),
            ("deg/s", 0.017453292519943295, "1/s"),
            ("rpm", 0.10471975511965977, "1/s"),
            ("km/h", 1.0 / 3.6, "m/s"),
            ("N*mm", 1e-3, "m^2 kg/s^2"),
            ("g*cm^2", 1e-7, "m^2 kg"),
            ("mm/s²", 1e-3, "m/s^2"),
            ("m/s/s", 1.0, "m/s^2"),
            ("1/min", 1.0 / 60.0, "1/s"),
            ("%", 0.01, "1"),
            ("mrad", 1e-3, "1"),
            ("kPa", 1e3, ""),
            ("L/min", 1e-3 / 60.0, "m^3/s"),
        ] {
            let found = scaled_unit(text).unwrap();
            assert!((found.factor / factor - 1.0).abs() < 1e-15, "{text}: {}", found.factor);
            assert_eq!(found.offset, 0.0);
            if !unit.is_empty() && !unit.contains("kg") {
                assert_eq!(found.dimension.unit(), unit, "{text}");
            }
        }
        assert_eq!(scaled_unit("kPa").unwrap().dimension, scaled_unit("bar").unwrap().dimension);
        assert_eq!(scaled_unit("N*mm").unwrap().dimension, scaled_unit("J").unwrap().dimension);
        let celsius = scaled_unit("degC").unwrap();
        assert_eq!((celsius.factor, celsius.offset), (1.0, 273.15));
        let fahrenheit = scaled_unit("degF").unwrap();
        assert!((fahrenheit.factor * 212.0 + fahrenheit.offset - 373.15).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_unit_is_told() {
        assert!(scaled_unit("milimetre").unwrap_err().contains("perhaps 'millimetre' is meant"));
        for text in ["", "m/", "mm^x", "furlong", "m/(s*s)", "1e3"] {
            assert!(scaled_unit(text).is_err(), "{text}");
        }
    }
}
