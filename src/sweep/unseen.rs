//! Directions in the state space that no row sees, at a state at which that is so.

use crate::number::rational_to_f64;
use crate::observability::{State, StateInWords};
use crate::system::System;
use dashu::base::{Abs, Gcd};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// Directions of one kind that are not seen, with one example.
#[derive(Clone, Debug)]
pub struct UnseenDirection {
    /// The states that take part, by name.
    pub states: Vec<String>,
    /// At how many sampled states.
    pub count: u64,
    /// One of them, as `1 r1 - 0.5 omega0`.
    pub example: String,
    /// The index of the draw that it belongs to.
    pub index: u64,
    /// The state at which it is not seen, all its coordinates.
    pub at: StateInWords,
    /// That direction as a vector, a part for each of `states`: in small integers where its parts are in such a
    /// proportion, else with one as its largest part. The first part is positive.
    pub vector: Vec<RBig>,
    /// Whether these parts are exact; else they are correct to more than a hundred digits.
    pub exact: bool,
}

/// Integers up to this are small.
const SMALL: u32 = 100;

/// The directions of a sweep, by the states that take part.
#[derive(Debug, Default)]
pub(super) struct UnseenDirections(BTreeMap<Vec<String>, UnseenDirection>);

impl UnseenDirections {
    /// Counts a direction that is not seen at a state, the draw of an index.
    pub fn add(&mut self, system: &System, direction: &[RBig], exact: bool, state: &State, index: u64) {
        let parts: Vec<(&RBig, String)> = direction
            .iter()
            .zip(system.unknowns())
            .filter(|(part, _)| !part.is_zero())
            .map(|(part, symbol)| (part, system.symbol_name(symbol).to_owned()))
            .collect();
        let (parts, names): (Vec<&RBig>, Vec<String>) = parts.into_iter().unzip();
        let entry = self.0.entry(names.clone()).or_insert_with(|| UnseenDirection {
            count: 0,
            example: combination(&names, &parts.iter().map(|part| rational_to_f64(part)).collect::<Vec<_>>()),
            states: names,
            index,
            at: state.describe(system),
            vector: in_proportion(&parts),
            exact,
        });
        entry.count += 1;
    }

    /// Counts a direction of which only the unknowns that take part are known; whether there is an example of such.
    pub fn count(&mut self, system: &System, parts: &[bool]) -> bool {
        let part_of = parts.iter().zip(system.unknowns()).filter(|(takes_part, _)| **takes_part);
        let names: Vec<String> = part_of.map(|(_, symbol)| system.symbol_name(symbol).to_owned()).collect();
        let known = self.0.get_mut(&names);
        known.map(|direction| direction.count += 1).is_some()
    }

    /// All of them, in order of the names.
    pub fn into_list(self) -> Vec<UnseenDirection> {
        self.0.into_values().collect()
    }
}

/// A vector along another one, none of whose parts is zero.
fn in_proportion(parts: &[&RBig]) -> Vec<RBig> {
    let Some(first) = parts.first() else { return Vec::new() };
    let denominators = parts.iter().fold(UBig::ONE, |all, part| {
        let next = part.denominator();
        &all / (&all).gcd(next) * next
    });
    let scaled: Vec<IBig> =
        parts.iter().map(|part| part.numerator() * IBig::from(&denominators / part.denominator())).collect();
    let common = scaled.iter().fold(UBig::ZERO, |all, part| all.gcd(part.clone().abs().into_parts().1));
    let integers: Vec<IBig> = scaled.into_iter().map(|part| part / IBig::from(common.clone())).collect();
    let unit = if integers.iter().all(|part| part.clone().abs() <= IBig::from(SMALL)) {
        parts[0] / RBig::from(integers[0].clone())
    } else {
        parts.iter().map(|part| (*part).clone().abs()).max().unwrap_or(RBig::ONE)
    };
    let unit = if (*first / &unit) < RBig::ZERO { -unit } else { unit };
    parts.iter().map(|part| *part / &unit).collect()
}

/// `r1 - 0.5 omega0`, the largest part scaled to one.
fn combination(names: &[String], parts: &[f64]) -> String {
    let largest = parts.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let mut text = String::new();
    for (name, part) in names.iter().zip(parts) {
        let part = part / largest;
        let sign = match (text.is_empty(), part < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        text.push_str(sign);
        if (part.abs() - 1.0).abs() > 5e-5 {
            text.push_str(&format!("{:.4} ", part.abs()));
        }
        text.push_str(name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::parse_decimal;

    #[test]
    fn vectors_are_small_integers_or_have_one_as_their_largest_part() {
        for (direction, expected) in [
            (&["1/2", "-1"][..], &["1", "-2"][..]),
            (&["-3", "6", "-9"], &["1", "-2", "3"]),
            (&["1/3", "1/4"], &["4", "3"]),
            (&["7"], &["1"]),
            (&["-1/1000", "1"], &["1/1000", "-1"]),
            (&["1/65536", "3/7"], &["7/196608", "1"]),
        ] {
            let read = |list: &[&str]| -> Vec<RBig> {
                list.iter().map(|text| parse_decimal(text).unwrap()).collect()
            };
            let direction = read(direction);
            let vector = in_proportion(&direction.iter().collect::<Vec<_>>());
            assert_eq!(vector, read(expected));
        }
    }
}
