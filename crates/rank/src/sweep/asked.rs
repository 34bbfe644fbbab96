//! What is asked of a rank, and what is fixed where it is.

use crate::observability::Branch;
use crate::sweep::certainty::Certainty;
use dashu::rational::RBig;
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{Assignment, Kind, SymbolInfo, System};
use palmistry_math::expression::Symbol;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// What is asked.
pub struct RankQuestion<'a> {
    /// States drawn on each branch of the conditions; with zero no Lie derivatives are taken either.
    pub samples: u64,
    /// The seed of the drawn states.
    pub seed: u64,
    /// How certain every rank has to be, at the least.
    pub wanted: Certainty,
    /// To how many digits the singular values of the worst conditioned state are wanted, if doubles will not do.
    pub digits: Option<usize>,
    /// Lie derivatives up to exactly this order; otherwise until the rank stops growing.
    pub order: Option<usize>,
    /// Symbols that are fixed, with their values.
    pub fixed: BTreeMap<Symbol, RBig>,
    /// Conditions in the language, such as `sin(phi1) = 0`.
    pub conditions: Vec<String>,
    /// How many of the states are recorded with their certified rank, for a verdict file.
    pub recorded: u64,
    /// Set from outside to stop early.
    pub interrupt: &'a AtomicBool,
    /// Called with the number of states done.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

impl Default for RankQuestion<'_> {
    /// A thousand states of the sample box, every rank certified, from Lie derivatives taken until the rank stops
    /// growing.
    fn default() -> Self {
        RankQuestion {
            samples: 1000,
            seed: 1,
            wanted: Certainty::Certified,
            digits: None,
            order: None,
            fixed: BTreeMap::new(),
            conditions: Vec::new(),
            recorded: 0,
            interrupt: &UNINTERRUPTED,
            progress: &|_| (),
        }
    }
}

/// Symbols that every drawn state has the same value of: parameters with a value and no range, and ranges of no width.
fn held_by_the_file(system: &System, question: &RankQuestion<'_>) -> Vec<(Symbol, RBig)> {
    let held = |(symbol, info): (Symbol, &SymbolInfo)| {
        let value = match &info.range {
            Some(range) => (range.low == range.high).then(|| range.low.clone()),
            None => info.default.clone(),
        }?;
        let exact = !info.is_angle || value.is_zero();
        (exact && info.kind != Kind::Imported && !question.fixed.contains_key(&symbol))
            .then_some((symbol, value))
    };
    system.symbols().filter_map(held).collect()
}

/// The parameters that a file gives one value to, with these values; states with a range of no width are none.
pub(crate) fn held_constants(system: &mut System) -> Assignment {
    let mut held = held_by_the_file(system, &RankQuestion::default());
    held.retain(|(symbol, _)| !system.states.contains(symbol));
    held.into_iter().map(|(symbol, value)| (symbol, system.graph.rational(value))).collect()
}

/// The values that every state of a branch has.
pub(crate) fn held_conditions(
    system: &mut System,
    question: &RankQuestion<'_>,
    branch: &Branch,
) -> Assignment {
    // values that are fixed are conditions too, but for angles, whose values are no rational half turns
    let mut conditions = branch.values.clone();
    for (symbol, value) in &question.fixed {
        if !system.is_angle(*symbol) || value.is_zero() {
            conditions.insert(*symbol, system.graph.rational(value.clone()));
        }
    }
    // so are parameters that the file gives one value to
    for (symbol, value) in held_by_the_file(system, question) {
        let value = system.graph.rational(value);
        conditions.entry(symbol).or_insert(value);
    }
    for known in conditions.clone().keys() {
        let value = conditions[known];
        let value = system.graph.substitute(&[value], &conditions)[0];
        conditions.insert(*known, value);
    }
    conditions
}
