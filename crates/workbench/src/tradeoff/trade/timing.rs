//! Times that can be compared: all jobs take turns, round after round, on one thread, and of each the least counts.

use super::combination::{Derivative, Number, RankMethod};
use std::time::Instant;

/// A turn takes about so long, if the states suffice for it.
const TURN: f64 = 2e-3;

/// What a job is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Derivative(Number, Derivative),
    Rank(Number, RankMethod),
}

/// Something to be timed: `run(n)` does the first `n` states.
pub(super) struct Job<'w> {
    pub of: Part,
    pub run: Box<dyn FnMut(usize) + 'w>,
    /// Seconds a state, so far.
    pub seconds: f64,
}

impl<'w> Job<'w> {
    pub fn new(of: Part, run: impl FnMut(usize) + 'w) -> Self {
        Job { of, run: Box::new(run), seconds: f64::INFINITY }
    }

    fn turn(&mut self, states: usize) -> f64 {
        let begin = Instant::now();
        (self.run)(states);
        begin.elapsed().as_secs_f64() / states as f64
    }
}

/// Times all jobs; returns the number of rounds that were done before it was stopped.
pub(super) fn time(
    jobs: &mut [Job<'_>],
    rounds: usize,
    states: usize,
    stopped: &dyn Fn() -> bool,
    progress: &dyn Fn(usize),
) -> usize {
    if states == 0 {
        return 0;
    }
    // how many states make a turn, from two states on warm caches
    let mut share = Vec::with_capacity(jobs.len());
    for job in jobs.iter_mut() {
        job.turn(1);
        let estimate = job.turn(states.min(2)).max(1e-9);
        share.push(((TURN / estimate) as usize).clamp(1, states));
    }
    for round in 0..rounds {
        for (job, states) in jobs.iter_mut().zip(&share) {
            if stopped() {
                return round;
            }
            job.seconds = job.turn(*states).min(job.seconds);
        }
        progress(round + 1);
    }
    rounds
}
