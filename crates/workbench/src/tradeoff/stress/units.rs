//! The same states in other units: which verdicts change, and which are wrong; and what a threshold that is fixed as a
//! part of the largest singular value would make of states as differently conditioned as these.

use super::finding::StressFinding;
use super::scaling::scaled;
use super::subject::{Subject, Truth};
use super::{Mark, Way};
use dashu::rational::RBig;
use palmistry_math::expression::Symbol;
use palmistry_rank::observability::{Spectrum, State};
use palmistry_rank::sweep::RankDecider;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Other units.
#[derive(Clone, Debug)]
pub enum Rescaling {
    /// The numbers that stand for the same physical state, where dimensions are known: each symbol times a factor.
    Symbols(Vec<(Symbol, RBig)>),
    /// One state measured in units `2^power` times smaller, the rows being what they are: its column in the matrix is
    /// multiplied, which rounds nothing.
    Column { place: usize, power: i32 },
}

/// What one way says in some units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WayInUnits {
    pub wrong: usize,
    pub open: usize,
    pub refused: usize,
    /// How many verdicts differ from those in the file's own units.
    pub changed: usize,
}

/// What all ways say in some units.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitsRow {
    pub name: String,
    pub states: usize,
    /// In the order of [`Way::ALL`].
    pub ways: Vec<WayInUnits>,
}

/// Condition numbers of the states in the old and the new scaling, in decades, and fixed thresholds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conditioning {
    /// States of full rank by the decade of the condition number; rows scaled to length one.
    pub old: BTreeMap<i32, usize>,
    /// The same, equilibrated and without unit rows.
    pub new: BTreeMap<i32, usize>,
    /// A part of the largest singular value, and how many ranks it makes wrong in the old and in the new scaling.
    pub thresholds: Vec<(f64, usize, usize)>,
    pub states: usize,
}

/// Parts of the largest singular value below which one may take values for zeros.
const THRESHOLDS: [f64; 6] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14];

/// A state with its truth and its findings in the file's own units.
pub(super) struct Seen {
    pub state: State,
    pub truth: Truth,
    pub findings: Vec<StressFinding>,
}

impl Seen {
    /// `None` at a pole.
    pub fn new(subject: &Subject, decider: &RankDecider<'_>, state: State) -> Option<Seen> {
        let truth = subject.truth(&state).ok()?;
        let findings = subject.findings(decider, &state, &truth, None);
        Some(Seen { state, truth, findings })
    }
}

/// The marks of all ways at all states in some units; the file's own without a rescaling.
pub(super) fn in_units(subject: &Subject, seen: &[Seen], name: &str, other: Option<&Rescaling>) -> UnitsRow {
    let decider = subject.decider();
    let mut ways = vec![WayInUnits::default(); Way::ALL.len()];
    let mut states = 0;
    for one in seen {
        let moved = match other {
            None => None,
            Some(Rescaling::Symbols(factors)) => {
                let state = scaled(&one.state, factors.iter().cloned());
                let Ok(truth) = subject.truth(&state) else { continue };
                let findings = subject.findings(&decider, &state, &truth, None);
                Some((truth, findings))
            }
            Some(Rescaling::Column { place, power }) => {
                let column = Some((*place, 2f64.powi(*power)));
                Some((one.truth.clone(), subject.findings(&decider, &one.state, &one.truth, column)))
            }
        };
        states += 1;
        let (truth, findings) = moved.as_ref().map_or((&one.truth, &one.findings), |(t, f)| (t, f));
        for (way, count) in Way::ALL.iter().zip(&mut ways) {
            let (here, there) = (&one.findings[way.place()], &findings[way.place()]);
            match there.mark(*way, truth) {
                Mark::Wrong => count.wrong += 1,
                Mark::Open => count.open += 1,
                Mark::Refused => count.refused += 1,
                Mark::Right | Mark::Lost => {}
            }
            count.changed += usize::from(here.verdict != there.verdict);
        }
    }
    UnitsRow { name: name.to_owned(), states, ways }
}

/// How states are conditioned, and what fixed thresholds make of them.
pub(super) fn conditioning(subject: &Subject, states: Vec<State>) -> Conditioning {
    let known: Vec<Option<(usize, Spectrum, Spectrum)>> = states
        .into_par_iter()
        .map(|state| {
            let (old, new) = subject.spectra(&state)?;
            Some((subject.rank(&state)?, old, new))
        })
        .collect();
    let mut found = Conditioning {
        thresholds: THRESHOLDS.map(|threshold| (threshold, 0, 0)).to_vec(),
        ..Conditioning::default()
    };
    for (rank, old, new) in known.into_iter().flatten() {
        found.states += 1;
        if rank == old.values.len() {
            for (histogram, condition) in
                [(&mut found.old, old.condition()), (&mut found.new, new.condition())]
            {
                // a smallest singular value of zero has no decade; it stands beyond all others
                let decade = if condition.is_finite() { condition.log10().floor() as i32 } else { i32::MAX };
                *histogram.entry(decade).or_insert(0) += 1;
            }
        }
        for (threshold, old_wrong, new_wrong) in &mut found.thresholds {
            let count = |values: &[f64]| {
                let largest = values.first().copied().unwrap_or(0.0);
                values.iter().filter(|value| **value > *threshold * largest).count()
            };
            *old_wrong += usize::from(count(&old.values) != rank);
            *new_wrong += usize::from(subject.eliminated() + count(&new.values) != rank);
        }
    }
    found
}
