//! One kind of number with all its ways: what they get right, and the jobs that measure their times.

use super::block::Block;
use super::combination::{
    Combination, CombinationLeftOut, CorrectDigits, Derivative, DerivativeResult, Number, RankMethod,
    RankResult,
};
use super::ranks::{RankVerdict, RankWay};
use super::sense::{no_derivative, no_rank};
use super::timing::{Job, Part};
use super::truth::{Exact, Truth};
use super::ways::{Possible, Way};
use super::work::Work;
use dashu::rational::RBig;
use rayon::prelude::*;
use std::ops::Range;

/// States that are evaluated in one go.
const CHUNK: usize = 32;

/// How accurate a kind of number can be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Accuracy {
    /// So many decimal digits, and no more.
    Digits(f64),
    Exact,
    Modular,
}

/// The image of a constant, where it has one.
type ConstantOf<'w, N> = Box<dyn Fn(&RBig) -> Option<N> + Send + Sync + 'w>;

/// The relative error of a value; infinite for what is no number, or an enclosure that does not enclose.
type ErrorOf<'w, N> = Box<dyn Fn(&N, &Exact) -> f64 + Send + Sync + 'w>;

/// Does the first so many states.
pub(super) type Timer<'w> = Box<dyn Fn(usize) + Send + Sync + 'w>;

/// One kind of number, and what can be done with it.
pub(super) struct Setup<'w, N> {
    pub number: Number,
    accuracy: Accuracy,
    constant: ConstantOf<'w, N>,
    error: ErrorOf<'w, N>,
    pub ways: Vec<(Derivative, Way<'w, N>)>,
    pub ranks: Vec<(RankMethod, RankWay<'w, N>)>,
    /// What is timed where it is not the way itself, because a way hands its results over state by state.
    pub timers: Vec<(Derivative, Timer<'w>)>,
    /// Ways that would make sense and are not possible here.
    left_out: Vec<(Derivative, String)>,
}

impl<'w, N> Setup<'w, N> {
    pub fn new(
        number: Number,
        accuracy: Accuracy,
        constant: impl Fn(&RBig) -> Option<N> + Send + Sync + 'w,
        error: impl Fn(&N, &Exact) -> f64 + Send + Sync + 'w,
    ) -> Self {
        let constant = Box::new(constant);
        let error = Box::new(error);
        Setup {
            number,
            accuracy,
            constant,
            error,
            ways: Vec::new(),
            ranks: Vec::new(),
            timers: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Takes a way in, or notes why it is not possible here.
    pub fn way(&mut self, derivative: Derivative, way: Possible<'w, N>) {
        match way {
            Ok(way) => self.ways.push((derivative, way)),
            Err(reason) => self.left_out.push((derivative, reason)),
        }
    }

    /// Everything that is not combined, and why.
    fn left_out(&self) -> Vec<CombinationLeftOut> {
        let leave_out =
            |derivative, rank, reason| CombinationLeftOut { number: self.number, derivative, rank, reason };
        let taken = |wanted: &Derivative| self.ways.iter().any(|(derivative, _)| derivative == wanted);
        let mut found = Vec::new();
        for derivative in Derivative::ALL.into_iter().filter(|derivative| !taken(derivative)) {
            let impossible = self.left_out.iter().find(|(other, _)| *other == derivative);
            let reason = match impossible {
                Some((_, reason)) => reason.clone(),
                None => no_derivative(self.number, derivative).to_owned(),
            };
            found.push(leave_out(Some(derivative), None, reason));
        }
        let taken = |wanted: &RankMethod| self.ranks.iter().any(|(rank, _)| rank == wanted);
        for rank in RankMethod::ALL.into_iter().filter(|rank| !taken(rank)) {
            found.push(leave_out(None, Some(rank), no_rank(self.number, rank).to_owned()));
        }
        found
    }
}

/// What was found so far; seconds come later.
#[derive(Default)]
pub(super) struct Findings {
    pub derivatives: Vec<DerivativeResult>,
    pub ranks: Vec<RankResult>,
    pub left_out: Vec<CombinationLeftOut>,
    verdicts: Vec<Combination>,
}

impl Findings {
    pub fn set_seconds(&mut self, of: &Part, seconds: f64) {
        for found in &mut self.derivatives {
            if *of == Part::Derivative(found.number, found.derivative) {
                found.seconds = seconds;
            }
        }
        for found in &mut self.ranks {
            if *of == Part::Rank(found.number, found.rank) {
                found.seconds = seconds;
            }
        }
    }

    /// All combinations, with the sums of the times of their parts.
    pub fn combinations(&self) -> Vec<Combination> {
        let mut all = self.verdicts.clone();
        for combination in &mut all {
            let derivative = self.derivatives.iter().find(|found| {
                (found.number, found.derivative) == (combination.number, combination.derivative)
            });
            let rank = self
                .ranks
                .iter()
                .find(|found| (found.number, found.rank) == (combination.number, combination.rank));
            let seconds = |found: Option<f64>| found.unwrap_or(f64::INFINITY);
            combination.seconds = seconds(derivative.map(|d| d.seconds)) + seconds(rank.map(|r| r.seconds));
        }
        all
    }
}

/// Evaluates everything once at all states, on all cores, and returns the jobs for the timing.
pub(super) fn study<'s, N: Clone + Send + Sync + 's>(
    work: &Work,
    setup: &'s Setup<'_, N>,
    findings: &mut Findings,
    jobs: &mut Vec<Job<'s>>,
) {
    findings.left_out.extend(setup.left_out());
    let mut timed = (Vec::new(), Vec::new());
    for (derivative, way) in &setup.ways {
        let entries = evaluate(work, way);
        let (digits, failed) = digits(work, setup, &entries);
        let (number, derivative) = (setup.number, *derivative);
        findings.derivatives.push(DerivativeResult {
            number,
            derivative,
            seconds: f64::INFINITY,
            digits,
            failed,
        });
        let matrices = |block: &Block| -> Vec<Option<Vec<N>>> {
            let of = |values: &Option<Vec<N>>| block.entries(&setup.constant, values.as_ref()?);
            in_chunks(entries.len(), &|states| entries[states].iter().map(of).collect())
        };
        let blocks = matrices(&work.block);
        let wholes = if setup.ranks.iter().any(|(rank, _)| rank.keeps_unit_rows()) {
            matrices(&work.whole)
        } else {
            Vec::new()
        };
        for (rank, decide) in &setup.ranks {
            findings.verdicts.push(Combination {
                number,
                derivative,
                rank: *rank,
                seconds: f64::INFINITY,
                digits,
                wrong: 0,
                undecided: 0,
                failed: 0,
                certified: 0,
                on_front: false,
            });
            if let Some(tally) = findings.verdicts.last_mut() {
                let (block, matrices) =
                    if rank.keeps_unit_rows() { (&work.whole, &wholes) } else { (&work.block, &blocks) };
                count(work, block, tally, &verdicts(matrices, decide));
            }
        }
        if timed.0.is_empty() {
            timed = (blocks, wholes);
        }
        let timer = setup.timers.iter().find(|(other, _)| *other == derivative);
        jobs.push(Job::new(Part::Derivative(number, derivative), move |states| match timer {
            Some((_, timer)) => timer(states),
            None => way(0..states, &mut |values| {
                std::hint::black_box(values);
            }),
        }));
    }
    for (rank, decide) in &setup.ranks {
        findings.ranks.push(RankResult { number: setup.number, rank: *rank, seconds: f64::INFINITY });
        let blocks = if rank.keeps_unit_rows() { timed.1.clone() } else { timed.0.clone() };
        jobs.push(Job::new(Part::Rank(setup.number, *rank), move |states| {
            decide(&blocks[..states.min(blocks.len())], &mut |verdict| {
                std::hint::black_box(verdict);
            });
        }));
    }
}

fn evaluate<N: Clone + Send>(work: &Work, way: &Way<'_, N>) -> Vec<Option<Vec<N>>> {
    let count = work.states.len();
    in_chunks(count, &|states| {
        let mut found = Vec::with_capacity(CHUNK);
        way(states, &mut |values| found.push(values.map(<[N]>::to_vec)));
        found
    })
}

/// What comes of so many states, some at a time, on all cores; compiled once for each kind of result.
fn in_chunks<T: Send>(count: usize, chunk: &(dyn Fn(Range<usize>) -> Vec<T> + Sync)) -> Vec<T> {
    let states = |index: usize| chunk(index * CHUNK..((index + 1) * CHUNK).min(count));
    (0..count.div_ceil(CHUNK)).into_par_iter().flat_map_iter(states).collect()
}

/// The digits at the median and at the worst state, and how many states have no value.
fn digits<N: Sync>(work: &Work, setup: &Setup<'_, N>, entries: &[Option<Vec<N>>]) -> (CorrectDigits, u64) {
    let most = if let Accuracy::Digits(most) = setup.accuracy { most } else { f64::INFINITY };
    let at_a_state = |(values, truth): (&Option<Vec<N>>, &Truth)| {
        let errors =
            values.as_ref()?.iter().zip(&truth.values).map(|(value, exact)| (setup.error)(value, exact));
        let worst = errors.fold(0.0, f64::max);
        // at worst none are right; and zero is not minus zero
        worst.is_finite().then(|| (-worst.log10()).min(most).max(0.0) + 0.0)
    };
    let mut found: Vec<Option<f64>> = in_chunks(entries.len().min(work.truths.len()), &|states| {
        entries[states.clone()].iter().zip(&work.truths[states]).map(at_a_state).collect()
    });
    let failed = found.iter().filter(|digits| digits.is_none()).count() as u64;
    match setup.accuracy {
        Accuracy::Exact if failed == 0 => return (CorrectDigits::Exact, 0),
        Accuracy::Modular => return (CorrectDigits::Modular, failed),
        _ => {}
    }
    found.sort_by(|a, b| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
    let at = |place: usize| found.get(place).copied().flatten().unwrap_or(0.0);
    (CorrectDigits::Measured { median: at(found.len() / 2), worst: at(0) }, failed)
}

fn verdicts<N: Sync>(blocks: &[Option<Vec<N>>], decide: &RankWay<'_, N>) -> Vec<RankVerdict> {
    in_chunks(blocks.len(), &|states| {
        let mut found = Vec::with_capacity(states.len());
        decide(&blocks[states], &mut |verdict| found.push(verdict));
        found
    })
}

fn count(work: &Work, block: &Block, tally: &mut Combination, verdicts: &[RankVerdict]) {
    for (verdict, truth) in verdicts.iter().zip(&work.truths) {
        match verdict {
            RankVerdict::Rank(rank) if block.eliminated + rank != truth.rank => tally.wrong += 1,
            // a nonzero minor modulo a prime is one for certain; that there is none is not
            RankVerdict::Rank(rank) => {
                tally.certified += u64::from(match tally.number {
                    Number::Rational | Number::Interval | Number::Bounded => true,
                    Number::Residue => *rank == block.rows.min(block.columns),
                    Number::Single | Number::Double | Number::DoubleDouble => false,
                });
            }
            RankVerdict::Undecided => tally.undecided += 1,
            RankVerdict::Failed => tally.failed += 1,
        }
    }
}
