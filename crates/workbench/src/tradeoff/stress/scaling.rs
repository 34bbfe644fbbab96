//! One quantity at a time from 1e-150 to 1e150 times its value, all others unchanged.

use super::finding::StressFinding;
use super::subject::Subject;
use super::{Mark, Way};
use dashu::rational::RBig;
use palmistry_math::expression::Symbol;
use palmistry_rank::observability::{Coordinate, State};

/// The exponents of ten reach this far, in steps of [`STEP`].
const FARTHEST: i32 = 150;
const STEP: usize = 10;

/// What is scaled: symbols, each by a power of the factor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// A symbol's name, or a unit.
    pub name: String,
    /// The symbols that change, and the power of the factor by which each does.
    pub powers: Vec<(Symbol, i32)>,
}

/// The results of one way for a quantity that is scaled.
#[derive(Clone, Debug, PartialEq)]
pub struct WayScaled {
    pub way: Way,
    /// The mark at each exponent; `None` where there is no truth.
    pub marks: Vec<Option<Mark>>,
    /// The least and the greatest exponent around zero within which the rank is right everywhere.
    pub right: Option<(i32, i32)>,
    /// What is said just below and just above that.
    pub below: Option<String>,
    pub above: Option<String>,
}

/// A quantity that is scaled, and the results of every way.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    pub quantity: String,
    /// Of ten.
    pub exponents: Vec<i32>,
    pub ways: Vec<WayScaled>,
}

/// Scales numbers of a state by powers of a factor.
pub(super) fn scaled(state: &State, factors: impl Iterator<Item = (Symbol, RBig)>) -> State {
    let mut state = state.clone();
    for (symbol, factor) in factors {
        if let Some(Coordinate::Number(number)) = state.values.get_mut(&symbol) {
            *number = &*number * factor;
        }
    }
    state
}

impl Quantity {
    /// The quantities of a state: each number that is not zero, by itself.
    pub(super) fn all(subject: &Subject, state: &State) -> Vec<Quantity> {
        let numbers = state.values.iter().filter_map(|(symbol, value)| match value {
            Coordinate::Number(number) if !number.is_zero() => Some(*symbol),
            _ => None,
        });
        numbers
            .map(|symbol| Quantity {
                name: subject.system.symbol_name(symbol).to_owned(),
                powers: vec![(symbol, 1)],
            })
            .collect()
    }

    /// Takes the quantity from one end to the other.
    pub(super) fn scale(&self, subject: &Subject, state: &State) -> Scaling {
        let decider = subject.decider();
        let exponents: Vec<i32> = (-FARTHEST..=FARTHEST).step_by(STEP).collect();
        let found: Vec<Option<Vec<(Mark, String)>>> = exponents
            .iter()
            .map(|exponent| {
                let ten = RBig::from(10);
                let factor = |power: i32| ten.pow((exponent * power) as isize);
                let state =
                    scaled(state, self.powers.iter().map(|(symbol, power)| (*symbol, factor(*power))));
                let truth = subject.truth(&state).ok()?;
                let findings = subject.findings(&decider, &state, &truth, None).into_iter().zip(Way::ALL);
                let marked = findings.map(|(finding, way)| {
                    let mark = finding.mark(way, &truth);
                    let cause =
                        (mark == Mark::Wrong).then(|| StressFinding::rounded(subject, &state, way)).flatten();
                    let mut said = finding.said();
                    if mark == Mark::Wrong {
                        let cause = cause.unwrap_or_else(|| "rounding".to_owned());
                        said = format!("{said} instead of {}: {cause}", truth.rank);
                    }
                    (mark, said)
                });
                Some(marked.collect())
            })
            .collect();
        let ways = Way::ALL.iter().map(|way| {
            let at = |place: usize| found[place].as_ref().map(|all| &all[way.place()]);
            let fine = |place: usize| at(place).is_none_or(|(mark, _)| *mark <= Mark::Lost);
            let middle = exponents.len() / 2;
            let first = (0..=middle).rev().take_while(|place| fine(*place)).last();
            let last = (middle..exponents.len()).take_while(|place| fine(*place)).last();
            let said = |place: Option<usize>| place.and_then(at).map(|(_, said)| said.clone());
            WayScaled {
                way: *way,
                marks: (0..exponents.len()).map(|place| at(place).map(|(mark, _)| *mark)).collect(),
                right: first.zip(last).map(|(first, last)| (exponents[first], exponents[last])),
                below: said(first.map_or(Some(middle), |first| first.checked_sub(1))),
                above: said(last.map(|last| last + 1).filter(|place| *place < exponents.len())),
            }
        });
        Scaling { quantity: self.name.clone(), ways: ways.collect(), exponents }
    }
}
