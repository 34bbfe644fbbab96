//! The rank at many states by power series: where the Lie derivatives that it takes are too long to be written down.

use super::counts::SweepCounts;
use super::states::{Stretch, SweepOptions, SweepReport, Told};
use super::table::{StateRow, TableOf};
use crate::observability::{Defined, Locus, LocusError, Probe};
use palmistry_budget::Share;
use palmistry_lang::System;
use palmistry_math::number::{NumberType, PrimeField};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// States are swept in blocks of this size; between blocks it can be interrupted.
const BLOCK: u64 = 256;

/// Power series made ready for being looked at, at any states of a locus.
pub(super) struct PreparedSeries {
    locus: Locus,
    probe: Probe,
    field: PrimeField,
    defined: Defined,
    seed: u64,
    most: usize,
}

impl PreparedSeries {
    pub fn new(system: &mut System, locus: &Locus, probe: Probe, options: &SweepOptions<'_>) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
        let field = PrimeField::random(&mut rng);
        let guards = system.smooth_guards(&system.moving_fields());
        let defined = Defined::new(system, &guards);
        let most = options.most.unwrap_or(system.unknown_count());
        PreparedSeries { locus: locus.clone(), probe, field, defined, seed: options.seed, most }
    }

    /// The rank at some of the states, modulo a prime: no less for certain, and no more where it is that of almost all states.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn over(
        &self,
        system: &System,
        stretch: &Stretch<'_>,
        table: &mut TableOf<'_, '_>,
    ) -> Result<SweepCounts, LocusError> {
        let Stretch { range, interrupt, progress } = stretch;
        let begin = Instant::now();
        let (graph, most) = (&system.graph, self.most);
        let mut counts = SweepCounts::default();
        let mut next = range.start;
        while next < range.end && !interrupt.load(Ordering::Relaxed) {
            let end = range.end.min(next.saturating_add(BLOCK));
            let share = Share::here();
            let decided = |index| {
                let state = self.locus.draw(self.seed, index)?;
                if let Some(undefined) = self.defined.failure(graph, &state) {
                    return Ok(Err(undefined));
                }
                let pole = || "a divisor is zero modulo the prime, or a value is not rational".to_owned();
                Ok(self.probe.rank_at(&state, self.field, index, most).ok_or_else(pole))
            };
            let block: Vec<Result<Result<usize, String>, LocusError>> =
                (next..end).into_par_iter().map(|index| share.carry(|| decided(index))).collect();
            let mut rows = Vec::new();
            for (index, found) in (next..end).zip(block) {
                let found = found?;
                if table.is_wanted() {
                    rows.push(StateRow {
                        rank: found.as_ref().ok().copied(),
                        certified: found.as_ref().is_ok_and(|rank| *rank == most),
                        ..StateRow::of_nothing(index)
                    });
                }
                match found {
                    Ok(rank) => {
                        counts.samples += 1;
                        *counts.ranks.entry(rank).or_insert(0) += 1;
                        *counts.number_types.entry(NumberType::Residues).or_insert(0) += 1;
                        counts.certified += u64::from(rank == most);
                    }
                    Err(pole) => *counts.poles.entry(pole).or_insert(0) += 1,
                }
            }
            table.write(rows, |index| self.locus.draw(self.seed, index))?;
            progress(end - range.start);
            next = end;
        }
        counts.interrupted = next < range.end;
        counts.seconds = Some(begin.elapsed().as_secs_f64());
        Ok(counts)
    }

    /// What a whole sweep has found.
    pub fn report(&self, counts: SweepCounts, told: Told<'_>) -> SweepReport {
        SweepReport {
            samples: counts.samples,
            rank_histogram: counts.ranks,
            computed_histogram: BTreeMap::new(),
            certified: counts.certified,
            disagreements: 0,
            number_types: counts.number_types,
            first: NumberType::Residues,
            remaining: (0, 0),
            poles: counts.poles,
            worst: None,
            digits: told.digits.map(|_| Err(super::NoDigits::NoState)),
            unobservable: Vec::new(),
            smallest_gap: f64::INFINITY,
            interrupted: counts.interrupted,
            recorded: Vec::new(),
            seconds: counts.seconds.unwrap_or(f64::NAN),
        }
    }
}
