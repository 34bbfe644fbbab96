//! The rank of a set of rows at many sampled states.

use super::certainty::Certainty;
use super::digits::{Digits, NoDigits};
use super::ladder::{DecidedRows, ProofWanted, RankDecider, StateDecision, StateReport};
use super::stream::{Stream, StreamOptions};
use super::unseen::{UnseenDirection, UnseenDirections};
use crate::expression::{Guard, NodeId, add_guard, expand_angles};
use crate::number::{PrimeField, Rung};
use crate::observability::{
    Codistribution, Defined, GenericAnswer, Locus, LocusError, Seen, Spectrum, State, StateInWords,
};
use crate::system::System;
use dashu::rational::RBig;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

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
    /// What every rank has to be, at the least.
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

/// Never set: of what nothing stops.
pub(crate) static UNINTERRUPTED: AtomicBool = AtomicBool::new(false);

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
            interrupt: &UNINTERRUPTED,
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
    /// A basis of the directions that no row sees, exactly.
    pub unseen: Vec<Vec<RBig>>,
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
    /// How many states each rung of the ladder decided.
    pub rungs: BTreeMap<Rung, u64>,
    /// The rung with which every state began.
    pub first: Rung,
    /// Rows and columns of the matrix that remains without unit rows; the singular values are its.
    pub remaining: (usize, usize),
    /// Poles that were met and left out, by the divisor that was zero.
    pub poles: BTreeMap<String, u64>,
    /// The state of full rank with the largest ratio of singular values.
    pub worst: Option<(StateInWords, Spectrum)>,
    /// Its singular values to as many digits as were wanted, if any were.
    pub digits: Option<Result<Digits, NoDigits>>,
    /// What is not seen where the rank is short.
    pub unseen: Vec<UnseenDirection>,
    /// The smallest gap on which a computed rank rests.
    pub smallest_gap: f64,
    /// Whether it was stopped early.
    pub interrupted: bool,
    /// As many of the states as were to be recorded, spread over the sweep, those that are poles or not certified left
    /// out; the worst conditioned state is the first.
    pub recorded: Vec<RecordedState>,
    /// How long it took, in s.
    pub seconds: f64,
}

impl SweepReport {
    /// How many states were left by the first rung of the ladder to a later one.
    pub fn climbed(&self) -> u64 {
        self.rungs.iter().filter(|(rung, _)| **rung != self.first).map(|(_, count)| count).sum()
    }
}

/// States are swept in blocks of this size; between blocks it can be interrupted.
const BLOCK: u64 = 2048;

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
    // the decider looks at the graph while the counts asks the system for names
    let graph = system.graph.clone();
    let columns = system.unknown_count();
    let rows = DecidedRows { quick: &quick, all: &all, columns };
    let decider =
        RankDecider::new(&graph, defined, rows, is_angle, ProofWanted { wanted: options.wanted, field })
            .at_most(options.most.unwrap_or(columns));
    // a stream decides full ranks only; where the quick rows cannot have it, there is nothing to stream
    let stream = Stream::new(system, locus, &quick)
        .filter(|_| watched)
        .filter(|stream| stream.full_rank() == system.unknown_count() && stream.remaining() != (0, 0));
    let mut report = match stream {
        Some(stream) => streamed(system, &stream, &decider, options)?,
        None => one_by_one(system, locus, &decider, options)?,
    };
    report.seconds = begin.elapsed().as_secs_f64();
    Ok(report)
}

/// Every state by itself.
fn one_by_one(
    system: &System,
    locus: &Locus,
    decider: &RankDecider<'_>,
    options: SweepOptions<'_>,
) -> Result<SweepReport, LocusError> {
    let mut counts = SweepCounts::default();
    let mut done = 0;
    while done < options.samples && !options.interrupt.load(Ordering::Relaxed) {
        let end = (done + BLOCK).min(options.samples);
        let indices: Vec<u64> = (done..end).collect();
        decide_all(system, decider, &mut counts, &indices, |index| locus.draw(options.seed, index))?;
        done = end;
        (options.progress)(done);
    }
    let worst = counts.worst.as_ref().map(|(state, _)| state.clone());
    let mut report = counts.finish(system, decider, options.digits, done < options.samples);
    report.recorded = recorded(decider, worst, options, |index| locus.draw(options.seed, index))?;
    report.remaining = decider.remaining();
    Ok(report)
}

/// A stream of states; those that it leaves are decided one by one.
fn streamed(
    system: &System,
    stream: &Stream,
    decider: &RankDecider<'_>,
    options: SweepOptions<'_>,
) -> Result<SweepReport, LocusError> {
    let mut counts = SweepCounts::default();
    let mut trouble = None;
    let mut skipped = false;
    let state = |index| stream.state(options.seed, index);
    let mut left = |indices: &[u64]| {
        for block in indices.chunks(BLOCK as usize) {
            skipped |= options.interrupt.load(Ordering::Relaxed);
            if skipped || trouble.is_some() {
                return;
            }
            trouble = decide_all(system, decider, &mut counts, block, state).err();
        }
    };
    let SweepOptions { samples: states, seed, wanted, digits, interrupt, progress, .. } = options;
    let found = stream.run(&StreamOptions { states, seed, wanted, interrupt, progress }, &mut left)?;
    if let Some(error) = trouble {
        return Err(error);
    }
    let full = system.unknown_count();
    let decided = found.states - found.left;
    if decided > 0 {
        counts.samples += decided;
        counts.certified += found.certified;
        *counts.ranks.entry(full).or_insert(0) += decided;
        *counts.rungs.entry(Rung::Doubles).or_insert(0) += decided;
        *counts.computed.entry(full).or_insert(0) += decided - found.denied;
        counts.disagreements += found.denied;
    }
    if let Some(gap) = found.smallest_gap {
        counts.smallest_gap = Some(counts.smallest_gap.map_or(gap, |least| least.min(gap)));
    }
    if let Some((index, condition)) = found.worst
        && counts.worst.as_ref().is_none_or(|(_, worst)| condition > worst.condition())
    {
        let state = state(index)?;
        if let StateDecision::Report(StateReport { spectrum: Some(spectrum), .. }) = decider.decide(&state) {
            counts.worst = Some((state, spectrum));
        }
    }
    let worst = counts.worst.as_ref().map(|(state, _)| state.clone());
    let mut report = counts.finish(system, decider, digits, found.interrupted || skipped);
    report.recorded = recorded(decider, worst, options, state)?;
    report.first = Rung::Doubles;
    report.remaining = found.remaining;
    Ok(report)
}

/// The worst state and others that are spread over the sweep, with their certified ranks.
fn recorded(
    decider: &RankDecider<'_>,
    worst: Option<State>,
    options: SweepOptions<'_>,
    state: impl Fn(u64) -> Result<State, LocusError> + Sync,
) -> Result<Vec<RecordedState>, LocusError> {
    let count = options.recorded.min(options.samples);
    let drawn = (0..count).into_par_iter().map(|part| {
        // in 128 bits, since the product of two counts may not fit into 64
        let index = u128::from(part) * u128::from(options.samples) / u128::from(count);
        state(index as u64)
    });
    let drawn: Vec<State> = drawn.collect::<Result<_, _>>()?;
    let first = worst.filter(|_| count > 0);
    let states: Vec<State> = first.into_iter().chain(drawn).take(count as usize).collect();
    let decided = states.into_par_iter().map(|state| match decider.decide(&state) {
        _ if options.interrupt.load(Ordering::Relaxed) => None,
        StateDecision::Report(StateReport {
            rank, unseen, hidden, certainty: Certainty::Certified, ..
        }) => {
            let unseen = if hidden.is_empty() { unseen } else { decider.unseen(&state) };
            // a short rank is checked by what is not seen, exactly
            (rank + unseen.len() == decider.columns()).then_some(RecordedState { state, rank, unseen })
        }
        _ => None,
    });
    Ok(decided.collect::<Vec<_>>().into_iter().flatten().collect())
}

/// Judges some states at once and adds them up in their order.
fn decide_all(
    system: &System,
    decider: &RankDecider<'_>,
    counts: &mut SweepCounts,
    indices: &[u64],
    state: impl Fn(u64) -> Result<State, LocusError> + Sync,
) -> Result<(), LocusError> {
    let block: Vec<Result<(State, StateDecision), LocusError>> = indices
        .par_iter()
        .map(|index| {
            let state = state(*index)?;
            let decided = decider.decide(&state);
            Ok((state, decided))
        })
        .collect();
    for (index, item) in indices.iter().zip(block) {
        let (state, decided) = item?;
        counts.add(system, decider, *index, state, decided);
    }
    Ok(())
}

#[derive(Default)]
struct SweepCounts {
    samples: u64,
    certified: u64,
    disagreements: u64,
    rungs: BTreeMap<Rung, u64>,
    ranks: BTreeMap<usize, u64>,
    computed: BTreeMap<usize, u64>,
    poles: BTreeMap<String, u64>,
    worst: Option<(State, Spectrum)>,
    unseen: UnseenDirections,
    smallest_gap: Option<f64>,
}

impl SweepCounts {
    fn add(
        &mut self,
        system: &System,
        decider: &RankDecider<'_>,
        index: u64,
        state: State,
        decided: StateDecision,
    ) {
        let report = match decided {
            StateDecision::Pole(divisor) => {
                *self.poles.entry(divisor).or_insert(0) += 1;
                return;
            }
            StateDecision::Report(report) => report,
        };
        self.samples += 1;
        *self.ranks.entry(report.rank).or_insert(0) += 1;
        self.certified += u64::from(report.certainty == Certainty::Certified);
        *self.rungs.entry(report.rung).or_insert(0) += 1;
        for direction in &report.unseen {
            self.unseen.add(system, direction, true, &state, index);
        }
        // one exact example of each kind is enough
        let mut first = report.hidden;
        first.retain(|parts| !self.unseen.count(system, parts));
        if !first.is_empty() {
            let (mut unseen, mut exact) = (decider.unseen(&state), true);
            if unseen.is_empty() {
                (unseen, exact) = (decider.unseen_nearly(&state), false);
            }
            for direction in unseen {
                let parts: Vec<bool> = direction.iter().map(|part| !part.is_zero()).collect();
                if first.contains(&parts) {
                    self.unseen.add(system, &direction, exact, &state, index);
                }
            }
        }
        let (Some(spectrum), Some(computed)) = (report.spectrum, report.computed) else { return };
        *self.computed.entry(computed).or_insert(0) += 1;
        self.disagreements += u64::from(computed != report.rank);
        let gap = self.smallest_gap.get_or_insert(f64::INFINITY);
        *gap = gap.min(spectrum.gap);
        let worse = self.worst.as_ref().is_none_or(|(_, worst)| spectrum.condition() > worst.condition());
        if report.rank == system.unknown_count() && worse {
            self.worst = Some((state, spectrum));
        }
    }

    fn finish(
        self,
        system: &System,
        decider: &RankDecider<'_>,
        digits: Option<usize>,
        interrupted: bool,
    ) -> SweepReport {
        let digits_of_worst = |digits| match &self.worst {
            Some((state, _)) => decider.digits(state, digits),
            None => Err(NoDigits::NoState),
        };
        SweepReport {
            samples: self.samples,
            rank_histogram: self.ranks,
            computed_histogram: self.computed,
            certified: self.certified,
            disagreements: self.disagreements,
            rungs: self.rungs,
            remaining: (0, 0),
            first: Rung::Intervals,
            poles: self.poles,
            digits: digits.map(digits_of_worst),
            worst: self.worst.map(|(state, spectrum)| (state.describe(system), spectrum)),
            unseen: self.unseen.into_list(),
            smallest_gap: self.smallest_gap.unwrap_or(f64::INFINITY),
            interrupted,
            recorded: Vec::new(),
            seconds: 0.0,
        }
    }
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

impl GenericAnswer {
    /// Takes the rank that was certified at all sampled states for a lower bound, on the components of the domain on which they lie,
    /// where that decides the rank; and what is not seen at one of them for not seen.
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
        // a part that is told is no zero, also where it is known to many digits only
        let takes_part = |name: &str| {
            report.unseen.iter().any(|direction| direction.states.iter().any(|state| state == name))
        };
        for ((symbol, seen), surely) in self.unknowns.iter_mut().zip(&self.seen_at_most) {
            if *surely || self.at_least == self.dimension {
                *seen = Seen::Yes;
            } else if takes_part(system.symbol_name(*symbol)) {
                // the rank does without its column there, and so does it around
                *seen = Seen::No;
            }
        }
    }
}
