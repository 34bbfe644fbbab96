//! Rows made ready for being decided at the states of a locus, any of them: a whole sweep, or a part of one.

use super::certainty::Certainty;
use super::counts::{SweepCounts, WorstState};
use super::digits::NoDigits;
use super::escalation::{DecidedRows, ProofWanted, RankDecider, StateDecision, StateReport};
use super::fingerprint::Fingerprint;
use super::states::{RecordedState, Stretch, SweepOptions, SweepReport, Told};
use super::stream::{Stream, StreamOptions};
use super::table::{StateRow, TableOf, put_in};
use crate::observability::{Codistribution, Defined, Locus, LocusError, Probe, Spectrum, State};
use palmistry_budget::Share;
use palmistry_lang::System;
use palmistry_math::expression::{Graph, NodeId, add_guard, expand_angles};
use palmistry_math::number::{NumberType, PrimeField};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// States are swept in blocks of this size; between blocks it can be interrupted.
const BLOCK: u64 = 2048;

/// Rows that are made ready for being decided at the states of a locus, each of which is drawn by its index: whoever looks at
/// it, and in whatever order, finds the same.
pub(super) struct PreparedSweep {
    locus: Locus,
    stream: Option<Stream>,
    decider: RankDecider<'static>,
    seed: u64,
    wanted: Certainty,
    most: Option<usize>,
    /// The rows that are tried first, all rows, and what they need to exist.
    rows: [Vec<NodeId>; 3],
}

impl PreparedSweep {
    /// `quick` rows are tried first (those that suffice at a generic state); where they fall short, `all` rows decide.
    pub fn new(
        system: &mut System,
        locus: &Locus,
        quick: &[NodeId],
        all: &[NodeId],
        options: &SweepOptions<'_>,
    ) -> PreparedSweep {
        let is_angle = &system.angle_test();
        let quick = expand_angles(&mut system.graph, quick, is_angle);
        let all = expand_angles(&mut system.graph, all, is_angle);
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
        let mut guards = system.smooth_guards(&system.moving_fields());
        // a stream watches what outputs and fields need; what the rows need beside that is looked at state by state
        let watched = options
            .guards
            .iter()
            .all(|guard| guards.contains(guard) || guard.is_obvious(&system.graph) == Some(true));
        options.guards.iter().for_each(|guard| add_guard(&system.graph, &mut guards, *guard));
        let defined = Defined::new(system, &guards);
        let field = PrimeField::random(&mut rng);
        let columns = system.unknown_count();
        let rows = DecidedRows { quick: &quick, all: &all, columns };
        let proof = ProofWanted { wanted: options.wanted, field };
        let decider = RankDecider::new(&system.graph, defined, rows, is_angle, proof)
            .at_most(options.most.unwrap_or(columns))
            .owning();
        // a stream decides full ranks only; where the quick rows cannot have it, there is nothing to stream
        let stream = Stream::new(system, locus, &quick)
            .filter(|_| watched)
            .filter(|stream| stream.full_rank() == columns && stream.remaining() != (0, 0));
        let guards = guards.iter().map(|guard| guard.node).collect();
        let (most, rows) = (options.most, [quick, all, guards]);
        let (seed, wanted) = (options.seed, options.wanted);
        PreparedSweep { locus: locus.clone(), stream, decider, seed, wanted, most, rows }
    }

    /// The same, where at states at which the rows are short of the rank at almost all of them derivatives of higher order are looked at.
    pub fn looking_further(self, by: Option<Probe>) -> PreparedSweep {
        PreparedSweep { decider: self.decider.with_further_derivatives(by), ..self }
    }

    /// What is decided, to the last bit, as a number.
    pub fn fingerprint(&self, graph: &Graph) -> u64 {
        let mut found = Fingerprint::default();
        self.rows.iter().for_each(|nodes| found.nodes(graph, nodes));
        found.text(&format!("{:?} {:?} {}", self.most, self.wanted, self.stream.is_some()));
        found.value()
    }

    /// What decides the rank at a state, whoever drew it.
    pub fn into_decider(self) -> RankDecider<'static> {
        self.decider
    }

    /// The state of an index.
    fn state(&self, index: u64) -> Result<State, LocusError> {
        match &self.stream {
            Some(stream) => stream.state(self.seed, index),
            None => self.locus.draw(self.seed, index),
        }
    }

    /// Looks at some of the states.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn over(
        &self,
        system: &System,
        stretch: &Stretch<'_>,
        table: &mut TableOf<'_, '_>,
    ) -> Result<SweepCounts, LocusError> {
        let begin = Instant::now();
        let names = unknown_names(system);
        let mut counts = match &self.stream {
            Some(stream) => self.streamed(stream, &names, stretch, table)?,
            None => self.one_by_one(&names, stretch, table)?,
        };
        counts.seconds = Some(begin.elapsed().as_secs_f64());
        Ok(counts)
    }

    /// Every state by itself.
    fn one_by_one(
        &self,
        names: &[String],
        stretch: &Stretch<'_>,
        table: &mut TableOf<'_, '_>,
    ) -> Result<SweepCounts, LocusError> {
        let Stretch { range, interrupt, progress } = stretch;
        let mut counts = SweepCounts::default();
        let mut next = range.start;
        while next < range.end && !interrupt.load(Ordering::Relaxed) {
            let indices: Vec<u64> = (next..range.end.min(next.saturating_add(BLOCK))).collect();
            let rows = self.decide_all(names, &mut counts, &indices, table.is_wanted())?;
            table.write(rows, |index| self.state(index))?;
            next += indices.len() as u64;
            progress(next - range.start);
        }
        counts.interrupted = next < range.end;
        Ok(counts)
    }

    /// A stream of states; those that it leaves are decided one by one.
    fn streamed(
        &self,
        stream: &Stream,
        names: &[String],
        stretch: &Stretch<'_>,
        table: &mut TableOf<'_, '_>,
    ) -> Result<SweepCounts, LocusError> {
        let Stretch { range, interrupt, progress } = stretch;
        let mut counts = SweepCounts::default();
        let mut trouble = None;
        let mut skipped = false;
        let wants_rows = table.is_wanted();
        let mut left = |indices: &[u64], mut rows: Vec<StateRow>| {
            for block in indices.chunks(BLOCK as usize) {
                skipped |= interrupt.load(Ordering::Relaxed);
                if skipped || trouble.is_some() {
                    return;
                }
                match self.decide_all(names, &mut counts, block, wants_rows) {
                    Ok(decided) => put_in(&mut rows, decided),
                    Err(error) => trouble = Some(error),
                }
            }
            if trouble.is_none() {
                trouble = table.write(rows, |index| self.state(index)).err();
            }
        };
        let options = StreamOptions {
            states: range.end - range.start,
            seed: self.seed,
            wanted: self.wanted,
            interrupt,
            progress,
        };
        let found = stream.run_from(range.start, &options, wants_rows, &mut left)?;
        if let Some(error) = trouble {
            return Err(error);
        }
        let (full, decided) = (names.len(), found.states - found.left);
        if decided > 0 {
            counts.samples += decided;
            counts.certified += found.certified;
            *counts.ranks.entry(full).or_insert(0) += decided;
            *counts.number_types.entry(NumberType::Doubles).or_insert(0) += decided;
            *counts.computed.entry(full).or_insert(0) += decided - found.denied;
            counts.disagreements += found.denied;
        }
        counts.gap(found.smallest_gap);
        counts.worst_streamed = found.worst.map(|(index, condition)| WorstState { index, condition });
        counts.interrupted = found.interrupted || skipped;
        Ok(counts)
    }

    /// Decides some states at once and adds them up in their order.
    fn decide_all(
        &self,
        names: &[String],
        counts: &mut SweepCounts,
        indices: &[u64],
        wants_rows: bool,
    ) -> Result<Vec<StateRow>, LocusError> {
        let share = Share::here();
        let decided = |index: &u64| {
            let state = self.state(*index)?;
            let decided = self.decider.decide(&state);
            Ok((state, decided))
        };
        let block: Vec<Result<(State, StateDecision), LocusError>> =
            indices.par_iter().map(|index| share.carry(|| decided(index))).collect();
        let mut rows = Vec::new();
        for (index, item) in indices.iter().zip(block) {
            let (state, decided) = item?;
            if wants_rows {
                rows.push(row_of(*index, &decided));
            }
            counts.add(names, &self.decider, *index, &state, decided);
        }
        Ok(rows)
    }

    /// The worst conditioned of all states, whether decided one by one or in a stream.
    fn worst(&self, counts: &SweepCounts) -> Result<Option<(State, Spectrum)>, LocusError> {
        let decided = |worst: Option<WorstState>| -> Result<_, LocusError> {
            let Some(WorstState { index, .. }) = worst else { return Ok(None) };
            let state = self.state(index)?;
            Ok(match self.decider.decide(&state) {
                StateDecision::Report(StateReport { spectrum: Some(spectrum), .. }) => {
                    Some((state, spectrum))
                }
                _ => None,
            })
        };
        let least = counts.worst.map_or(f64::NEG_INFINITY, |worst| worst.condition);
        if let Some(found) = decided(counts.worst_streamed.filter(|worst| worst.condition > least))? {
            return Ok(Some(found));
        }
        decided(counts.worst)
    }

    /// What a whole sweep has found.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn report(
        &self,
        system: &System,
        counts: SweepCounts,
        told: Told<'_>,
    ) -> Result<SweepReport, LocusError> {
        let worst = self.worst(&counts)?;
        let digits_of_worst = |digits| match &worst {
            Some((state, _)) => self.decider.digits(state, digits),
            None => Err(NoDigits::NoState),
        };
        let digits = told.digits.map(digits_of_worst);
        let recorded = self.recorded(worst.as_ref().map(|(state, _)| state.clone()), told)?;
        let at = |index| -> Result<_, LocusError> { Ok(self.state(index)?.describe(system)) };
        Ok(SweepReport {
            samples: counts.samples,
            rank_histogram: counts.ranks,
            computed_histogram: counts.computed,
            certified: counts.certified,
            disagreements: counts.disagreements,
            number_types: counts.number_types,
            first: if self.stream.is_some() { NumberType::Doubles } else { NumberType::Intervals },
            remaining: self.stream.as_ref().map_or(self.decider.remaining(), Stream::remaining),
            poles: counts.poles,
            worst: worst.map(|(state, spectrum)| (state.describe(system), spectrum)),
            digits,
            unobservable: counts.unobservable.into_list(at)?,
            smallest_gap: counts.smallest_gap.unwrap_or(f64::INFINITY),
            interrupted: counts.interrupted,
            recorded,
            seconds: counts.seconds.unwrap_or(f64::NAN),
        })
    }

    /// The worst state and others that are spread over the sweep, with their certified ranks.
    fn recorded(&self, worst: Option<State>, told: Told<'_>) -> Result<Vec<RecordedState>, LocusError> {
        let count = told.recorded.min(told.samples);
        let share = Share::here();
        let drawn = (0..count).into_par_iter().map(|part| {
            // in 128 bits, since the product of two counts may not fit into 64
            let index = u128::from(part) * u128::from(told.samples) / u128::from(count);
            share.carry(|| self.state(index as u64))
        });
        let drawn: Vec<State> = drawn.collect::<Result<_, _>>()?;
        let first = worst.filter(|_| count > 0);
        let states: Vec<State> = first.into_iter().chain(drawn).take(count as usize).collect();
        let decided = states.into_par_iter().map(|state| match share.carry(|| self.decider.decide(&state)) {
            _ if told.interrupt.load(Ordering::Relaxed) => None,
            StateDecision::Report(StateReport {
                rank,
                unobservable,
                hidden,
                certainty: Certainty::Certified,
                is_of_rows: true,
                ..
            }) => {
                let unobservable = if hidden.is_empty() {
                    unobservable
                } else {
                    share.carry(|| self.decider.unobservable(&state))
                };
                // a short rank is checked by the exact unobservable directions
                (rank + unobservable.len() == self.decider.columns()).then_some(RecordedState {
                    state,
                    rank,
                    unobservable,
                })
            }
            _ => None,
        });
        Ok(decided.collect::<Vec<_>>().into_iter().flatten().collect())
    }
}

/// The row of a table for a state.
pub(super) fn row_of(index: u64, decided: &StateDecision) -> StateRow {
    match decided {
        StateDecision::Pole(_) => StateRow::of_nothing(index),
        StateDecision::Report(StateReport { rank, certainty, spectrum, .. }) => StateRow {
            rank: Some(*rank),
            certified: *certainty == Certainty::Certified,
            // of a matrix without columns there are none
            smallest_singular_value: spectrum.as_ref().and_then(|found| found.values.last().copied()),
            condition: spectrum.as_ref().map(Spectrum::condition),
            ..StateRow::of_nothing(index)
        },
    }
}

/// The names of the unknowns of a system, in their order.
fn unknown_names(system: &System) -> Vec<String> {
    system.unknowns().into_iter().map(|symbol| system.symbol_name(symbol).to_owned()).collect()
}

/// Decides the rank of the codistribution, or of any rows, at every state drawn from a locus.
///
/// `quick` rows are tried first (those that suffice at a generic state); where they fall short, `all` rows decide.
///
/// # Errors
/// Where states cannot be drawn.
pub fn sweep(
    system: &mut System,
    locus: &Locus,
    quick: &[NodeId],
    all: &[NodeId],
    options: SweepOptions<'_>,
) -> Result<SweepReport, LocusError> {
    let begin = Instant::now();
    let prepared = PreparedSweep::new(system, locus, quick, all, &options);
    let SweepOptions { samples, digits, recorded, interrupt, progress, .. } = options;
    let stretch = Stretch { range: 0..samples, interrupt, progress };
    let counts = prepared.over(system, &stretch, &mut TableOf::nobody())?;
    let mut report = prepared.report(system, counts, Told { samples, digits, recorded, interrupt })?;
    report.seconds = begin.elapsed().as_secs_f64();
    Ok(report)
}

/// The rows of a codistribution as [`sweep`] wants them.
impl Codistribution {
    /// Sweeps this codistribution.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn sweep(
        &self,
        system: &mut System,
        locus: &Locus,
        options: SweepOptions<'_>,
    ) -> Result<SweepReport, LocusError> {
        let options = SweepOptions { most: Some(self.most()), ..options };
        sweep(system, locus, &self.needed_entries(), &self.entries(), options)
    }
}
