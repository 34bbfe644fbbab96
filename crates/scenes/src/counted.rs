//! Other values that explain the measurements as well as an estimate does, by counting them: how many values of each unknown give the same outputs.
//!
//! Two rates of absorption and elimination can be exchanged where only the blood is measured; no symmetry of single unknowns shows it, and a search that begins near
//! one of two such answers finds that one. What is counted are values over the complex numbers, generically, with inputs that may be any functions of time
//! ([`palmistry_rank::observability::solutions`]); which ones a scene's bounds exclude is not known.

use super::not_identifiable::as_estimated;
use super::run::Experiment;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::Symbol;
use palmistry_observe::CalibrationKind;
use palmistry_rank::observability::{Mirror, Solutions, SolutionsQuestion, mirrors, solutions};
use std::collections::HashSet;
use std::sync::atomic::AtomicBool;

/// Work for about a second: an estimate does not wait longer for a remark.
const WORK: u64 = 300_000_000;

impl Experiment {
    /// The estimated unknowns of which more values are counted than their mirror images, each with their number, in words; none where that is not known.
    pub(super) fn counted_values(&self, interrupt: &AtomicBool) -> Option<String> {
        let mut system = self.as_counted()?;
        let free: HashSet<Symbol> = self.names().iter().filter_map(|name| system.find_symbol(name)).collect();
        let mirrors = mirrors(&system, &free).unwrap_or_default();
        let question = SolutionsQuestion {
            conditions: Assignment::default(),
            expressions: Vec::new(),
            work: WORK,
            interrupt,
        };
        let answer = solutions(&mut system, &question).ok()?;
        let counted = answer.unknowns.iter().filter_map(|of_it| match of_it.solutions {
            Solutions::Finite(count) => Some((of_it.name.as_str(), count)),
            Solutions::Infinite | Solutions::Undecided(_) => None,
        });
        let several: Vec<String> = counted
            .filter(|(name, count)| {
                let symbol = system.find_symbol(name);
                *count > symbol.map_or(1, |symbol| images(&mirrors, symbol))
            })
            .map(|(name, count)| format!("{name} ({count})"))
            .collect();
        (!several.is_empty()).then(|| {
            format!(
                "several values give the same outputs, complex ones counted: of {}; the estimate is one of them, and which one the search finds depends on its initial guess and its bounds",
                several.join(", ")
            )
        })
    }

    /// The system as it is estimated, where its values can be counted: all states are estimated or measured, and nothing else is known of the beginning.
    fn as_counted(&self) -> Option<System> {
        if self.is_about_palms() || !self.system.initial_conditions().is_empty() {
            return None;
        }
        let names = self.names();
        let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
        if names.iter().any(|name| matches!(CalibrationKind::of(name), Some((_, CalibrationKind::Delay)))) {
            return None;
        }
        let mut system = as_estimated(&self.system, &names, &self.question, &self.signals)?;
        for state in system.states.clone() {
            let name = system.symbol_name(state).to_owned();
            if names.contains(&name) {
                continue;
            }
            self.signals.find(&name)?;
            system.known.insert(state);
        }
        Some(system)
    }
}

/// How many values of an unknown its mirror images are, with its own.
fn images(mirrors: &[Mirror], symbol: Symbol) -> usize {
    let mut all = Vec::new();
    for mirror in mirrors {
        if let Some((_, turned)) = mirror.of.iter().find(|(other, _)| *other == symbol)
            && !all.contains(&turned)
        {
            all.push(turned);
        }
    }
    1 + all.len()
}
