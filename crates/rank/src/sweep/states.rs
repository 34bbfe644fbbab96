//! What is asked of a sweep over many states, and what it has found.

use super::certainty::Certainty;
use super::digits::{Digits, NoDigits};
use super::unobservable::UnobservableDirection;
use crate::observability::{GenericAnswer, Observability, Spectrum, State, WrittenState};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::Guard;
use palmistry_math::number::NumberType;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::AtomicBool;

/// How to sweep.
#[derive(Clone, Copy)]
pub struct SweepOptions<'a> {
    /// How many states are drawn.
    pub samples: u64,
    /// The seed from which they are drawn.
    pub seed: u64,
    /// No state's rank is higher, for certain; nothing where only the number of unknowns bounds it.
    pub most: Option<usize>,
    /// What the rows need to exist, beside what outputs and fields need.
    pub guards: &'a [Guard],
    /// How certain every rank has to be, at the least.
    pub wanted: Certainty,
    /// To how many digits the singular values of the worst conditioned state are wanted, if doubles will not do.
    pub digits: Option<usize>,
    /// How many of the states are recorded with their certified rank.
    pub recorded: u64,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called after every block with the number of states done.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

impl Default for SweepOptions<'_> {
    /// A thousand states, every rank certified.
    fn default() -> Self {
        SweepOptions {
            samples: 1000,
            seed: 1,
            most: None,
            guards: &[],
            wanted: Certainty::Certified,
            digits: None,
            recorded: 0,
            interrupt: &palmistry_io::UNINTERRUPTED,
            progress: &|_| (),
        }
    }
}

/// A state of the sweep with its certified rank.
#[derive(Clone, Debug)]
pub struct RecordedState {
    /// The state, exactly.
    pub state: State,
    /// Its rank.
    pub rank: usize,
    /// A basis of the unobservable directions, exactly.
    pub unobservable: Vec<Vec<RBig>>,
}

/// What a sweep has found.
#[derive(Clone, Debug)]
pub struct SweepReport {
    /// States at which the rank was decided.
    pub samples: u64,
    /// The rank by exact arithmetic where there is one, else by singular values.
    pub rank_histogram: BTreeMap<usize, u64>,
    /// The rank by singular values alone.
    pub computed_histogram: BTreeMap<usize, u64>,
    /// How many of the ranks are certified.
    pub certified: u64,
    /// At how many states the singular values say something else than what decided.
    pub disagreements: u64,
    /// How many states each number type decided.
    pub number_types: BTreeMap<NumberType, u64>,
    /// The number type with which every state began.
    pub first: NumberType,
    /// Rows and columns of the matrix that remains without unit rows; the singular values are its.
    pub remaining: (usize, usize),
    /// Poles that were met and left out, by the divisor that was zero.
    pub poles: BTreeMap<String, u64>,
    /// The state of full rank with the largest ratio of singular values.
    pub worst: Option<(WrittenState, Spectrum)>,
    /// Its singular values to as many digits as were wanted, if any were.
    pub digits: Option<Result<Digits, NoDigits>>,
    /// The unobservable directions where the rank is short.
    pub unobservable: Vec<UnobservableDirection>,
    /// The smallest gap on which a computed rank rests.
    pub smallest_gap: f64,
    /// Whether it was stopped early.
    pub interrupted: bool,
    /// As many of the states as were to be recorded, spread over the sweep, those that are poles or not certified left
    /// out; the worst conditioned state is the first.
    pub recorded: Vec<RecordedState>,
    /// How long it took, in s; NaN where it is not recorded, as of a sweep that was merged of parts.
    pub seconds: f64,
}

impl SweepReport {
    /// How many states were escalated from the first number type to a later one.
    pub fn climbed(&self) -> u64 {
        self.number_types
            .iter()
            .filter(|(number_type, _)| **number_type != self.first)
            .map(|(_, count)| count)
            .sum()
    }
}

/// Some of the states of a sweep, those of the indices of a range, and who looks on.
#[derive(Clone)]
pub(super) struct Stretch<'a> {
    pub range: Range<u64>,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called after every block with the number of states done.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// What is reported of a sweep beside what it has counted.
#[derive(Clone, Copy)]
pub(super) struct Told<'a> {
    /// How many states the whole sweep has.
    pub samples: u64,
    /// As [`SweepOptions::digits`].
    pub digits: Option<usize>,
    /// As [`SweepOptions::recorded`].
    pub recorded: u64,
    pub interrupt: &'a AtomicBool,
}

impl GenericAnswer {
    /// Takes the rank that was certified at all sampled states for a lower bound, on the components of the domain on which they lie,
    /// where that decides the rank; and what is unobservable at one of them for unobservable.
    pub(super) fn seen_at_states(&mut self, system: &System, report: &SweepReport) {
        let mut ranks = report.rank_histogram.keys();
        let (rank, others) = (ranks.next(), ranks.next());
        let all_certified = report.samples > 0 && report.certified == report.samples;
        // states of two ranks may lie on two components
        if self.is_final() || !all_certified || rank != Some(&self.at_most) || others.is_some() {
            return;
        }
        self.at_least = self.at_most;
        self.open = Some(
            "by minors at the sampled states, for the components of the domain on which these lie".to_owned(),
        );
        // a part that is reported is not zero, also where it is known to many digits only
        let takes_part = |name: &str| {
            report.unobservable.iter().any(|direction| direction.states.iter().any(|state| state == name))
        };
        for ((symbol, seen), surely) in self.unknowns.iter_mut().zip(&self.seen_at_most) {
            if *surely || self.at_least == self.dimension {
                *seen = Observability::Yes;
            } else if takes_part(system.symbol_name(*symbol)) {
                // the rank does without its column there, and so does it around
                *seen = Observability::No;
            }
        }
    }
}
