//! The rank at many states by power series: where the words of Lie derivatives that it takes are too long to be written down.

use super::states::{SweepOptions, SweepReport};
use crate::number::{PrimeField, Rung};
use crate::observability::{Defined, Locus, LocusError, Probe};
use crate::system::System;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// States are swept in blocks of this size; between blocks it can be interrupted.
const BLOCK: u64 = 256;

/// The rank at every state drawn from a locus, modulo a prime: no less for certain, and no more where it is that of almost all states.
///
/// # Errors
/// Where states cannot be drawn.
pub(super) fn sweep_by_series(
    system: &mut System,
    locus: &Locus,
    probe: &Probe,
    options: &SweepOptions<'_>,
) -> Result<SweepReport, LocusError> {
    let begin = Instant::now();
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let field = PrimeField::random(&mut rng);
    let guards = system.smooth_guards(&system.moving_fields());
    let defined = Defined::new(system, &guards);
    let most = options.most.unwrap_or(system.unknown_count());
    let mut report = SweepReport {
        samples: 0,
        rank_histogram: BTreeMap::new(),
        computed_histogram: BTreeMap::new(),
        certified: 0,
        disagreements: 0,
        rungs: BTreeMap::new(),
        first: Rung::Residues,
        remaining: (0, 0),
        poles: BTreeMap::new(),
        worst: None,
        digits: options.digits.map(|_| Err(super::NoDigits::NoState)),
        unseen: Vec::new(),
        smallest_gap: f64::INFINITY,
        interrupted: false,
        recorded: Vec::new(),
        seconds: 0.0,
    };
    let graph = &system.graph;
    let mut done = 0;
    while done < options.samples && !options.interrupt.load(Ordering::Relaxed) {
        let end = (done + BLOCK).min(options.samples);
        let block: Vec<Result<Result<usize, String>, LocusError>> = (done..end)
            .into_par_iter()
            .map(|index| {
                let state = locus.draw(options.seed, index)?;
                if let Some(undefined) = defined.failure(graph, &state) {
                    return Ok(Err(undefined));
                }
                let pole = || "a divisor is zero modulo the prime, or a value is not rational".to_owned();
                Ok(probe.rank_at(&state, field, index, most).ok_or_else(pole))
            })
            .collect();
        for found in block {
            match found? {
                Ok(rank) => {
                    report.samples += 1;
                    *report.rank_histogram.entry(rank).or_insert(0) += 1;
                    report.certified += u64::from(rank == most);
                }
                Err(pole) => *report.poles.entry(pole).or_insert(0) += 1,
            }
        }
        done = end;
        (options.progress)(done);
    }
    if report.samples > 0 {
        report.rungs.insert(Rung::Residues, report.samples);
    }
    report.interrupted = done < options.samples;
    report.seconds = begin.elapsed().as_secs_f64();
    Ok(report)
}
