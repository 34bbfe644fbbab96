//! Axes of pictures: names with their units, numbers that differ where their values do, and the room that they need.

use crate::drawing::{BACK, BELOW};
use palmistry_lang::{Looks, System};
use palmistry_math::expression::notation::letter_and_index;

/// The unit of a symbol from the dimension that its file declares, or that follows from what it declares; none where it is
/// unknown or there is none.
pub fn unit_of(system: &System, name: &str) -> Option<String> {
    let symbol = system.find_symbol(name)?;
    let unit = system.dimension_of(symbol)?.unit();
    match unit.as_str() {
        "1" => system.is_angle(symbol).then(|| "rad".to_owned()),
        _ => Some(unit),
    }
}

/// A unit as people write it: `kg·m²/s` for `kg*m^2/s`.
pub(super) fn unit_in_print(unit: &str) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut out = String::with_capacity(unit.len());
    let mut is_exponent = false;
    for c in unit.chars() {
        match (c, c.to_digit(10)) {
            ('*', _) => out.push('·'),
            ('^', _) => {}
            ('-', _) if is_exponent => out.push('⁻'),
            (_, Some(digit)) if is_exponent => out.push(RAISED[digit as usize]),
            // a root stays as it is written: there is no fraction above the line
            ('(', _) if is_exponent => out.push_str("^("),
            _ => out.push(c),
        }
        is_exponent = c == '^' || is_exponent && (c.is_ascii_digit() || c == '-');
    }
    out
}

/// A name in a picture, its index below the line.
pub(super) fn name_in_picture(name: &str, looks: &Looks) -> String {
    match letter_and_index(name, looks.get(name)) {
        Some((letter, index)) if index.is_empty() => letter,
        Some((letter, index)) => format!("{letter}{BELOW}{index}{BACK}"),
        None => name.to_owned(),
    }
}

/// A name along an axis, with the unit of what it means where that is known.
pub(super) fn axis(name: &str, unit: Option<&str>) -> String {
    axis_in(name, unit, &Looks::default())
}

/// The same with the looks that a file gives to its names.
pub(super) fn axis_in(name: &str, unit: Option<&str>, looks: &Looks) -> String {
    let name = name_in_picture(name, looks);
    let unit = unit.filter(|unit| !unit.is_empty());
    unit.map_or(name.clone(), |unit| format!("{name}, {}", unit_in_print(unit)))
}

/// A number along an axis of some span.
pub(super) fn number(value: f64, span: f64) -> String {
    let value = if value.abs() < 1e-9 * span { 0.0 } else { value };
    if !(1e-2..1e5).contains(&span) {
        // as many digits as distinguish a tenth of the span from nothing
        let digits = ((value.abs() / span).log10().ceil() + 1.0).clamp(1.0, 12.0) as usize;
        return if value == 0.0 { "0".to_owned() } else { format!("{value:.digits$e}") };
    }
    let decimals = (1.0 - span.log10().floor()).max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// The decimal logarithm of a value along an axis of some span of logarithms, as the value.
pub(super) fn power(logarithm: f64, span: f64) -> String {
    // as many digits as distinguish two of ten steps: a step is a part of 10^step - 1
    let digits = (-(std::f64::consts::LN_10 * span / 10.0).log10()).ceil().clamp(0.0, 12.0) as usize;
    format!("{:.digits$e}", 10f64.powf(logarithm))
}

/// The pixels that the labels of a vertical axis need, with what is written along it.
pub(super) fn room(range: (f64, f64), label: impl Fn(f64) -> String) -> u32 {
    let part = |step: i32| range.0 + (range.1 - range.0) * f64::from(step) / 10.0;
    let longest = (0..=10).map(|step| label(part(step)).chars().count()).max().unwrap_or(0);
    30 + 7 * longest as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn an_axis_has_sensible_numbers() {
        assert_eq!(number(0.30000000000000004, 1.4), "0.3");
        assert_eq!(number(-1e-17, 1.0), "0.0");
        assert_eq!(number(2e-8, 1e-7), "2.0e-8");
        assert_eq!(number(150.0, 400.0), "150");
        assert_eq!(number(-10_000.0, 20_000.0), "-10000");
    }

    /// Ten labels along an axis are ten texts, however short it is and wherever it begins.
    #[test]
    fn labels_differ_where_values_do() {
        for (begin, span) in [(1000.0, 1e-3), (0.0, 20.0), (-5e7, 1e8), (1.0, 0.5), (1e-9, 1e-12)] {
            let labels: BTreeSet<String> =
                (0..10).map(|step| number(begin + span * f64::from(step) / 10.0, span)).collect();
            assert_eq!(labels.len(), 10, "{labels:?}");
        }
        for (begin, span) in [(0.0, 1e-5), (-3.0, 0.1), (-8.0, 6.0), (2.0, 1.0), (5.0, 0.02)] {
            let labels: BTreeSet<String> =
                (0..10).map(|step| power(begin + span * f64::from(step) / 10.0, span)).collect();
            assert_eq!(labels.len(), 10, "{labels:?}");
        }
        assert_eq!(room((-10_000.0, 10_000.0), |v| number(v, 20_000.0)), 30 + 42);
    }

    #[test]
    fn units_are_set_as_people_write_them() {
        for (unit, expected) in [
            ("kg*m^2", "kg·m²"),
            ("1/s", "1/s"),
            ("m/s^-12", "m/s⁻¹²"),
            ("m^(1/2)*s^3", "m^(1/2)·s³"),
            ("rad", "rad"),
        ] {
            assert_eq!(unit_in_print(unit), expected);
        }
        assert_eq!(axis("Fyf", Some("kg*m/s^2")), format!("F{BELOW}yf{BACK}, kg·m/s²"));
        assert_eq!(axis("mass", None), "mass");
    }

    #[test]
    fn units_are_those_that_a_file_declares() {
        let text = "system \"a\"\nstate x : length, v, phi\nparam g : acceleration = 1, other = 1\nangle phi\n\
                    drift f\n  x' = v\n  v' = g*sin(phi)\n  phi' = v/x\n";
        let system = System::parse("a.proof", text, Path::new("")).unwrap();
        let unit = |name: &str| unit_of(&system, name);
        assert_eq!((unit("x").as_deref(), unit("v").as_deref()), (Some("m"), Some("m/s")));
        assert_eq!((unit("g").as_deref(), unit("phi").as_deref()), (Some("m/s^2"), Some("rad")));
        assert_eq!((unit("other"), unit("nothing")), (None, None));
        let plain = System::parse("b.proof", "system \"b\"\nstate r1\n", Path::new("")).unwrap();
        assert_eq!(unit_of(&plain, "r1"), None);
    }
}
