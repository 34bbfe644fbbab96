//! States at which two sides differ, in numbers that a pocket calculator takes.

use super::terms::{OnBranch, Point, Values};
use super::verdict::Witness;
use dashu::base::BitTest;
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::number::{Enclosure, Enclosures, round_to_decimal};
use rand::Rng;

/// How many states are tried.
const ATTEMPTS: usize = 300;
/// After so many states at which the sides agree the search ends.
const STATES: usize = 45;
/// Agreement is counted up to so many digits.
const MOST_DIGITS: usize = 100;
/// The digits to which irrational or long values are written, and to which they are at most where they are alike.
const DIGITS: usize = 20;

/// What a search for a witness came to.
pub(crate) enum Search {
    Found {
        witness: Witness,
        /// The state.
        point: Point,
        /// Which entry differs, counted from zero.
        entry: usize,
        /// Whether both values are exact.
        exact: bool,
    },
    /// The sides agree to so many digits at so many states.
    Agrees { digits: usize, states: usize },
}

/// Looks for a state at which both sides exist, all conditions hold, and some entry of the left certainly differs from
/// that of the right; the `suspects` are looked at.
pub(crate) fn search(
    system: &mut System,
    on: &OnBranch,
    suspects: std::ops::Range<usize>,
    rng: &mut impl Rng,
) -> Search {
    let entries = on.terms.sides.len() / 2;
    let (mut least, mut states) = (MOST_DIGITS, 0);
    for attempt in 0..ATTEMPTS {
        let point = on.draw(system, attempt, rng);
        let Some(values) = on.sides(&point) else { continue };
        for entry in suspects.clone() {
            match compare(&values, entry, entry + entries) {
                Comparison::Differ(left, right) => {
                    let state = on.describe(system, &point);
                    let exact = matches!(values, Values::Exact(_));
                    let witness = Witness { state, left, right, entry: None, refutation: None };
                    return Search::Found { witness, point, entry, exact };
                }
                Comparison::Agree(digits) => least = least.min(digits),
            }
        }
        states += 1;
        if states == STATES {
            break;
        }
    }
    Search::Agrees { digits: if states == 0 { 0 } else { least }, states }
}

/// Two sides at one state.
enum Comparison {
    Differ(String, String),
    /// To so many digits, at most [`MOST_DIGITS`].
    Agree(usize),
}

/// The values of two sides as they are printed; alike where they are equal.
pub(super) fn texts_of_sides(values: &Values, left: usize, right: usize) -> [String; 2] {
    match (compare(values, left, right), values) {
        (Comparison::Differ(left, right), _) => [left, right],
        (Comparison::Agree(_), Values::Exact(values)) => {
            [left, right].map(|side| shown(&values[side], DIGITS))
        }
        (Comparison::Agree(_), Values::Enclosed(values)) => [left, right]
            .map(|side| values[side].certain_decimal(DIGITS).unwrap_or_else(|| values[side].bounds_text())),
    }
}

fn compare(values: &Values, left: usize, right: usize) -> Comparison {
    match values {
        Values::Exact(values) if values[left] == values[right] => Comparison::Agree(MOST_DIGITS),
        Values::Exact(values) => {
            let shown = |digits: usize| [&values[left], &values[right]].map(|value| shown(value, digits));
            let [left_text, right_text] = until_they_differ(shown);
            match left_text == right_text {
                // numbers that are alike to thousands of digits are shown as what they are
                true => Comparison::Differ(values[left].to_string(), values[right].to_string()),
                false => Comparison::Differ(left_text, right_text),
            }
        }
        Values::Enclosed(values) => {
            let (left, right) = (&values[left], &values[right]);
            if Enclosures::common(left, right).is_none() {
                let text = |value: &Enclosure, digits| {
                    value.certain_decimal(digits).unwrap_or_else(|| value.bounds_text())
                };
                let [left, right] = until_they_differ(|digits| [text(left, digits), text(right, digits)]);
                return Comparison::Differ(left, right);
            }
            let same = |n: &usize| left.decimal(*n).is_some_and(|text| right.decimal(*n) == Some(text));
            Comparison::Agree((1..=MOST_DIGITS).rev().find(same).unwrap_or(0))
        }
    }
}

/// A short value as it is, a long one to some digits.
fn shown(value: &RBig, digits: usize) -> String {
    let short = value.numerator().bit_len() + value.denominator().bit_len() < 100;
    if short { value.to_string() } else { round_to_decimal(value, digits) }
}

/// Two texts to as many digits as it takes to distinguish them.
pub(super) fn until_they_differ(texts: impl Fn(usize) -> [String; 2]) -> [String; 2] {
    let mut digits = DIGITS;
    loop {
        let found = texts(digits);
        if found[0] != found[1] || digits > 1 << 14 {
            return found;
        }
        digits *= 2;
    }
}
