//! What a sweep has counted: all that the sums of several sweeps need, so that it does not matter where one is cut into parts.

use super::certainty::Certainty;
use super::escalation::{RankDecider, StateDecision, StateReport};
use super::unobservable::UnseenDirections;
use crate::observability::State;
use palmistry_math::number::NumberType;
use std::collections::BTreeMap;

/// A state of full rank, with the ratio of singular values by which it is the worst of those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WorstState {
    pub index: u64,
    pub condition: f64,
}

impl WorstState {
    /// The worse of two; the earlier one where they are equal.
    fn worse(earlier: Option<WorstState>, later: Option<WorstState>) -> Option<WorstState> {
        match (earlier, later) {
            (Some(earlier), Some(later)) if later.condition > earlier.condition => Some(later),
            (None, later) => later,
            (earlier, _) => earlier,
        }
    }
}

/// What was found at some states.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SweepCounts {
    /// States at which the rank was decided.
    pub samples: u64,
    pub certified: u64,
    pub disagreements: u64,
    pub number_types: BTreeMap<NumberType, u64>,
    pub ranks: BTreeMap<usize, u64>,
    pub computed: BTreeMap<usize, u64>,
    pub poles: BTreeMap<String, u64>,
    /// Of the states that were decided one by one.
    pub worst: Option<WorstState>,
    /// Of those in streams: by other numbers, which are compared in the end alone.
    pub worst_streamed: Option<WorstState>,
    pub unobservable: UnseenDirections,
    pub smallest_gap: Option<f64>,
    /// Whether not all states were looked at that were to be.
    pub interrupted: bool,
    /// How long it took, in s; nothing where that is not recorded.
    pub seconds: Option<f64>,
}

fn add_all<K: Ord>(mine: &mut BTreeMap<K, u64>, theirs: BTreeMap<K, u64>) {
    for (key, count) in theirs {
        let sum = mine.entry(key).or_insert(0);
        *sum = sum.saturating_add(count);
    }
}

impl SweepCounts {
    /// Adds what was counted at later states.
    pub fn append(&mut self, later: SweepCounts) {
        for (mine, theirs) in [
            (&mut self.samples, later.samples),
            (&mut self.certified, later.certified),
            (&mut self.disagreements, later.disagreements),
        ] {
            *mine = mine.saturating_add(theirs);
        }
        add_all(&mut self.number_types, later.number_types);
        add_all(&mut self.ranks, later.ranks);
        add_all(&mut self.computed, later.computed);
        add_all(&mut self.poles, later.poles);
        self.worst = WorstState::worse(self.worst, later.worst);
        self.worst_streamed = WorstState::worse(self.worst_streamed, later.worst_streamed);
        self.unobservable.append(later.unobservable);
        self.gap(later.smallest_gap);
        self.interrupted |= later.interrupted;
        self.seconds = self.seconds.zip(later.seconds).map(|(mine, theirs)| mine + theirs);
    }

    /// Notes a gap.
    pub fn gap(&mut self, gap: Option<f64>) {
        if let Some(gap) = gap.filter(|gap| !gap.is_nan()) {
            self.smallest_gap = Some(self.smallest_gap.map_or(gap, |least| least.min(gap)));
        }
    }

    /// Adds what was found at the state of an index, later than all before it.
    pub fn add(
        &mut self,
        unknowns: &[String],
        decider: &RankDecider<'_>,
        index: u64,
        state: &State,
        decided: StateDecision,
    ) {
        let report = match decided {
            StateDecision::Pole(divisor) => {
                *self.poles.entry(divisor).or_insert(0) += 1;
                return;
            }
            StateDecision::Report(report) => report,
        };
        let StateReport { rank, certainty, number_type, spectrum, computed, unobservable, hidden, .. } =
            report;
        self.samples += 1;
        *self.ranks.entry(rank).or_insert(0) += 1;
        self.certified += u64::from(certainty == Certainty::Certified);
        *self.number_types.entry(number_type).or_insert(0) += 1;
        for direction in &unobservable {
            self.unobservable.add(unknowns, direction, index);
        }
        // one exact example of each kind is enough
        let mut without_example = hidden;
        without_example.retain(|parts| !self.unobservable.count(unknowns, parts));
        if !without_example.is_empty() {
            let (mut unobservable, mut exact) = (decider.unobservable(state), true);
            if unobservable.is_empty() {
                (unobservable, exact) = (decider.nearly_unobservable(state), false);
            }
            for direction in unobservable {
                let parts: Vec<bool> = direction.iter().map(|part| !part.is_zero()).collect();
                if without_example.contains(&parts) {
                    self.unobservable.give_example(unknowns, &direction, exact, index);
                }
            }
        }
        let (Some(spectrum), Some(computed)) = (spectrum, computed) else { return };
        *self.computed.entry(computed).or_insert(0) += 1;
        self.disagreements += u64::from(computed != rank);
        self.gap(Some(spectrum.gap));
        if rank == unknowns.len() && !spectrum.condition().is_nan() {
            let this = WorstState { index, condition: spectrum.condition() };
            self.worst = WorstState::worse(self.worst, Some(this));
        }
    }
}
