//! Unobservable directions in the state space, each at a state.

use crate::observability::WrittenState;
use dashu::base::{Abs, Gcd};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_math::number::rational_to_f64;
use std::collections::BTreeMap;

/// Unobservable directions of one kind, with one example.
#[derive(Clone, Debug)]
pub struct UnobservableDirection {
    /// The states that take part, by name.
    pub states: Vec<String>,
    /// At how many sampled states.
    pub count: u64,
    /// One of them, as `1 r1 - 0.5 omega0`.
    pub example: String,
    /// The index of the draw that it belongs to.
    pub index: u64,
    /// The state at which it is unobservable, all its coordinates.
    pub at: WrittenState,
    /// That direction as a vector, a part for each of `states`: in small integers where its parts are in such a
    /// proportion, else with one as its largest part. The first part is positive.
    pub vector: Vec<RBig>,
    /// Whether these parts are exact; else they are correct to more than a hundred digits.
    pub exact: bool,
}

/// Integers up to this are small.
const SMALL: u32 = 100;

/// Directions of one kind, as they are counted.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UnseenKind {
    /// At how many states.
    pub count: u64,
    /// The first of them, where it could be written down.
    pub example: Option<UnseenExample>,
}

/// A direction at the state at which it is unobservable.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UnseenExample {
    /// The index of the draw.
    pub index: u64,
    /// As `1 r1 - 0.5 omega0`.
    pub text: String,
    /// As [`UnobservableDirection::vector`].
    pub vector: Vec<RBig>,
    /// As [`UnobservableDirection::exact`].
    pub exact: bool,
}

/// The directions of a sweep, by the states that take part. What is counted does not depend on where a sweep is cut into parts:
/// every state counts, and the example is that of the first state of which one can be given.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UnseenDirections(pub BTreeMap<Vec<String>, UnseenKind>);

impl UnseenDirections {
    /// Counts a direction that is unobservable at a state, the draw of an index.
    pub fn add(&mut self, unknowns: &[String], direction: &[RBig], index: u64) {
        let takes_part: Vec<bool> = direction.iter().map(|part| !part.is_zero()).collect();
        self.count(unknowns, &takes_part);
        self.give_example(unknowns, direction, true, index);
    }

    /// Counts a direction of which only the unknowns that take part are known; whether there is an example of such.
    pub fn count(&mut self, unknowns: &[String], takes_part: &[bool]) -> bool {
        let kind = self.0.entry(names_of(unknowns, takes_part)).or_default();
        kind.count += 1;
        kind.example.is_some()
    }

    /// Takes a direction for the example of its kind, where that was counted and has none.
    pub fn give_example(&mut self, unknowns: &[String], direction: &[RBig], exact: bool, index: u64) {
        let takes_part: Vec<bool> = direction.iter().map(|part| !part.is_zero()).collect();
        let names = names_of(unknowns, &takes_part);
        if let Some(kind) = self.0.get_mut(&names).filter(|kind| kind.example.is_none()) {
            let parts: Vec<&RBig> = direction.iter().filter(|part| !part.is_zero()).collect();
            let near: Vec<f64> = parts.iter().map(|part| rational_to_f64(part)).collect();
            let (text, vector) = (combination(&names, &near), in_proportion(&parts));
            kind.example = Some(UnseenExample { index, text, vector, exact });
        }
    }

    /// Adds what was counted at later states.
    pub fn append(&mut self, later: UnseenDirections) {
        for (names, kind) in later.0 {
            let mine = self.0.entry(names).or_default();
            mine.count = mine.count.saturating_add(kind.count);
            mine.example = mine.example.take().or(kind.example);
        }
    }

    /// All of them of which there is an example, in order of the names; `at` is the state of an index in words.
    ///
    /// # Errors
    /// Those of `at`.
    pub fn into_list<E>(
        self,
        at: impl Fn(u64) -> Result<WrittenState, E>,
    ) -> Result<Vec<UnobservableDirection>, E> {
        let with_example = |(states, kind): (Vec<String>, UnseenKind)| {
            let UnseenExample { index, text, vector, exact } = kind.example?;
            let whole = |at| UnobservableDirection {
                states,
                count: kind.count,
                example: text,
                index,
                at,
                vector,
                exact,
            };
            Some(at(index).map(whole))
        };
        self.0.into_iter().filter_map(with_example).collect()
    }
}

/// The names of the unknowns that take part.
fn names_of(unknowns: &[String], takes_part: &[bool]) -> Vec<String> {
    unknowns.iter().zip(takes_part).filter(|(_, part)| **part).map(|(name, _)| name.clone()).collect()
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
    use palmistry_math::number::parse_decimal;

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
