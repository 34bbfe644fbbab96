//! Speed against accuracy, measured: every sensible combination of a kind of number, a way to a derivative and a way to
//! a rank, on the same states of one system.
//!
//! The states are drawn from the system's sample box and nowhere else; on the way into a singular set all of this looks
//! different. At each of them the entries of the matrix of differentials are known for certain, and so is its rank.
//! [`trade`] measures how many digits of the entries each way gets right, how often each combination misreports the rank,
//! and what a state costs; [`Combination::on_front`] marks those that no other beats.

mod block;
mod blocks;
mod combination;
mod duals;
mod exact;
mod floats;
mod front;
mod lanes;
mod programs;
mod ranks;
mod rows;
mod sense;
mod study;
mod timing;
mod truth;
mod ways;
mod work;

pub use combination::{
    Combination, CombinationLeftOut, CorrectDigits, Derivative, DerivativeResult, Number, RankMethod, Trade,
};
pub use front::{DIGITS_TOLERANCE, TIME_TOLERANCE};

use front::mark_front;
use palmistry_lang::System;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use study::Findings;
use work::Work;

/// The settings of [`trade`].
pub struct TradeQuestion<'a> {
    /// States drawn from the sample box.
    pub samples: u64,
    pub seed: u64,
    /// Rounds of timing, in which all take turns of about two milliseconds.
    pub rounds: usize,
    /// Set from outside to stop early; what was found is kept.
    pub interrupt: &'a AtomicBool,
    /// Called with the steps done and the steps in all.
    pub progress: &'a (dyn Fn(u64, u64) + Sync),
}

/// Measures all combinations on one system.
///
/// # Errors
/// In words: no states or outputs, an empty sample box, rows of which nothing is known for certain.
pub fn trade(system: &System, question: &TradeQuestion<'_>) -> Result<Trade, String> {
    system.require_continuous("'trade' compares ways to Lie derivatives along flows")?;
    let begin = Instant::now();
    let work = Work::new(system.clone(), question)?;
    let steps = (Number::ALL.len() + question.rounds) as u64;
    let mut findings = Findings::default();
    let singles = floats::single(&work);
    let doubles = floats::double(&work);
    let bounded = floats::bounded(&work);
    let double_doubles = floats::double_double(&work);
    let intervals = floats::interval(&work);
    let residues = exact::residue(&work, question.seed);
    let rationals = exact::rational(&work);
    let mut jobs = Vec::new();
    let stopped = || question.interrupt.load(Ordering::Relaxed);
    let mut done = 0;
    macro_rules! study {
        ($($setup:ident)*) => {$(
            if !stopped() {
                study::study(&work, &$setup, &mut findings, &mut jobs);
                done += 1;
                (question.progress)(done, steps);
            }
        )*};
    }
    study!(singles doubles bounded double_doubles intervals residues rationals);
    let rounds = timing::time(&mut jobs, question.rounds, work.states.len(), &stopped, &|round| {
        (question.progress)(done + round as u64, steps);
    });
    for job in &jobs {
        findings.set_seconds(&job.of, job.seconds);
    }
    findings.derivatives.sort_by_key(|found| (found.number, found.derivative));
    findings.ranks.sort_by_key(|found| (found.number, found.rank));
    let mut combinations = findings.combinations();
    combinations.sort_by_key(|c| (c.number, c.derivative, c.rank));
    mark_front(&mut combinations);
    Ok(Trade {
        file: work.system.name.clone(),
        title: work.system.title.clone(),
        fields: work.system.roles(),
        by_default: work.system.ranges_by_default(),
        rows: work.origin.clone(),
        lie_derivatives: work.lie_derivatives.clone(),
        size: (work.rows, work.columns),
        varying: work.varying.len(),
        block: (work.block.rows, work.block.columns),
        seed: question.seed,
        states: work.states.len() as u64,
        without_truth: work.without_truth,
        certified_ranks: work.rank_histogram(),
        derivatives: findings.derivatives,
        ranks: findings.ranks,
        combinations,
        left_out: findings.left_out,
        rounds,
        interrupted: stopped(),
        seconds: begin.elapsed().as_secs_f64(),
    })
}
