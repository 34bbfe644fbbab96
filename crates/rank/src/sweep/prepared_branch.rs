//! One branch of the conditions of a question about a rank: what is made ready before any state is looked at, and what is reported
//! once all were.

use super::asked::{RankQuestion, held_conditions};
use super::certainty::Certainty;
use super::counts::SweepCounts;
use super::deviation::standard_deviations;
use super::given_states::GivenStates;
use super::part::BranchCounts;
use super::prepared::PreparedSweep;
use super::question::{
    BranchAnswer, GenericOnBranch, RankError, TakenRow, guarded, held_parameters, named_unknowns,
};
use super::series::PreparedSeries;
use super::states::{Stretch, SweepOptions, SweepReport, Told};
use super::stream::Stream;
use super::table::TableOf;
use crate::observability::{
    Branch, Codistribution, Frame, Length, Locus, Probe, SignCell, UnobservableDirections,
    unobservable_directions,
};
use palmistry_lang::{Assignment, System, Time};
use palmistry_math::expression::{Graph, Guard, NodeId, Symbol, expand_angles};
use std::sync::atomic::Ordering;

/// What the full codistribution is decided by.
pub(super) enum ByStates {
    Rows(Box<PreparedSweep>),
    /// Where its Lie derivatives are too long to be written down.
    Series(Box<PreparedSeries>),
}

impl ByStates {
    pub fn over(
        &self,
        system: &System,
        stretch: &Stretch<'_>,
        table: &mut TableOf<'_, '_>,
    ) -> Result<SweepCounts, RankError> {
        Ok(match self {
            ByStates::Rows(prepared) => prepared.over(system, stretch, table)?,
            ByStates::Series(prepared) => prepared.over(system, stretch, table)?,
        })
    }

    pub fn report(
        &self,
        system: &System,
        counts: SweepCounts,
        told: Told<'_>,
    ) -> Result<SweepReport, RankError> {
        Ok(match self {
            ByStates::Rows(prepared) => prepared.report(system, counts, told)?,
            ByStates::Series(prepared) => prepared.report(counts, told),
        })
    }
}

/// A branch of the conditions, or a part of one by signs, before any state is looked at.
pub(super) struct PreparedBranch {
    branch: Branch,
    pub cell: SignCell,
    /// States that are drawn on it.
    pub samples: u64,
    /// Whether states were asked for, and Lie derivatives for them.
    wanted: bool,
    conditions: Assignment,
    /// Those of them that the question gives.
    given: Vec<Symbol>,
    codistribution: Codistribution,
    pub locus: Locus,
    pub full: ByStates,
    pub rows: Option<PreparedSweep>,
}

/// The file's own rows, and what they need to exist.
pub(super) type OwnRows<'a> = (&'a [NodeId], &'a [Guard]);

/// How many states are drawn, and when none are.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub samples: u64,
    pub only_if_short: bool,
}

impl PreparedBranch {
    /// Prepares a branch. What series say of it is handed on as soon as it is known.
    pub fn new(
        system: &mut System,
        question: &RankQuestion<'_>,
        branch: &Branch,
        (extent, own): (Extent, Option<OwnRows<'_>>),
        known: &mut dyn FnMut(GenericOnBranch),
    ) -> Result<Self, RankError> {
        branch.check_codistribution(system).map_err(RankError::Condition)?;
        let conditions = held_conditions(system, question, branch);
        let given =
            |symbol: &Symbol| branch.values.contains_key(symbol) || question.fixed.contains_key(symbol);
        let given: Vec<Symbol> = conditions.keys().copied().filter(given).collect();
        let length = question.order.map_or(Length::UntilItStops, Length::Exactly);
        let frame = Frame::new(system, &conditions)?;
        known(GenericOnBranch::new(system, branch, &frame));
        let wanted = extent.samples > 0 && (!extent.only_if_short || frame.lie_derivatives_are_short(system));
        let samples = if wanted { extent.samples } else { 0 };
        let codistribution = match wanted {
            true => Codistribution::within(system, &conditions, length, frame)?,
            false => Codistribution::without_lie_derivatives(frame),
        };
        let all = codistribution.entries();
        let mut mentioned: Vec<NodeId> = all.clone();
        mentioned.extend(own.iter().flat_map(|(rows, _)| rows.iter()));
        mentioned.extend(guarded(system));
        let locus = Locus::new(system, branch, &question.fixed, &mentioned)?;
        let options = SweepOptions {
            samples,
            seed: question.seed,
            most: Some(codistribution.most()),
            guards: &[],
            wanted: question.wanted,
            digits: question.digits,
            recorded: question.recorded,
            interrupt: question.interrupt,
            progress: question.progress,
        };
        // Lie derivatives that somebody asked for are looked at as they are; functions have no residues at a state
        let has_series = wanted && question.order.is_none() && system.time == Time::Continuous;
        let probe =
            has_series.then(|| Probe::new(system, &conditions)).filter(|probe| !probe.has_functions());
        let full = match probe {
            Some(probe) if codistribution.is_cut_off() => {
                ByStates::Series(Box::new(PreparedSeries::new(system, &locus, probe, &options)))
            }
            probe => {
                let quick = codistribution.needed_entries();
                let further = probe.filter(|_| system.highest_lie_order().is_none());
                let rows = PreparedSweep::new(system, &locus, &quick, &all, &options);
                ByStates::Rows(Box::new(rows.looking_further(further)))
            }
        };
        let rows = own.filter(|_| wanted).map(|(rows, guards)| {
            PreparedSweep::new(system, &locus, rows, rows, &SweepOptions { most: None, guards, ..options })
        });
        Ok(PreparedBranch {
            branch: branch.clone(),
            cell: SignCell::default(),
            samples,
            wanted,
            conditions,
            given,
            codistribution,
            locus,
            full,
            rows,
        })
    }

    /// What decides states that are handed over; none where there are no Lie derivatives.
    pub fn into_given_states(self, system: &mut System, wanted: Certainty) -> Option<GivenStates> {
        let ByStates::Rows(prepared) = self.full else { return None };
        if !self.wanted {
            return None;
        }
        let is_angle = &system.angle_test();
        let rows = expand_angles(&mut system.graph, &self.codistribution.needed_entries(), is_angle);
        // a stream of drawn states needs full columns, one of given states does not
        let stream = Stream::new(system, &self.locus, &rows);
        let most = self.codistribution.most();
        Some(GivenStates::new(stream, prepared.into_decider(), self.locus, most, wanted))
    }

    /// What the rows are, to the last bit, as a text.
    pub fn fingerprint(&self, graph: &Graph) -> String {
        let full = match &self.full {
            ByStates::Rows(rows) => Some(rows.fingerprint(graph)),
            ByStates::Series(_) => None,
        };
        format!("{full:?} {:?}", self.rows.as_ref().map(|rows| rows.fingerprint(graph)))
    }

    /// The answer on one branch.
    ///
    /// # Errors
    /// States that cannot be drawn.
    pub fn answer(
        self,
        system: &mut System,
        question: &RankQuestion<'_>,
        own: Option<&[NodeId]>,
        counts: BranchCounts,
    ) -> Result<BranchAnswer, RankError> {
        let PreparedBranch {
            branch,
            samples,
            wanted,
            conditions,
            given,
            mut codistribution,
            locus,
            full,
            rows,
            ..
        } = self;
        let RankQuestion { digits, recorded, interrupt, .. } = *question;
        let told = Told { samples, digits, recorded, interrupt };
        let by_series = matches!(full, ByStates::Series(_));
        let full = full.report(system, counts.full, told)?;
        let deviations = match full.interrupted || by_series || !wanted {
            true => None,
            false => standard_deviations(system, &locus, &codistribution, &full, (question.seed, samples))?,
        };
        let rows = match rows.zip(counts.rows) {
            Some((rows, counts)) => Some(rows.report(system, counts, told)?),
            None => None,
        };
        codistribution.generic.seen_at_states(system, &full);
        let known = codistribution.generic.is_final() && question.order.is_none();
        // fields are found in one go: who does not wait gets what there is without them
        let motions = match interrupt.load(Ordering::Relaxed) {
            true => None,
            false => motions(system, &codistribution, &conditions, &given),
        };
        let generic_rank =
            codistribution.generic.rank().filter(|_| known).unwrap_or(codistribution.generic_rank());
        // Lie derivatives that were not taken show nothing, and series do
        let generic_rank = match wanted {
            true => generic_rank,
            false => generic_rank.max(codistribution.generic.at_least),
        };
        // fields settle what the rank of all Lie derivatives is, and these Lie derivatives may be fewer
        let settled = motions.as_ref().is_some_and(|found| {
            found.settles_the_rank && generic_rank + found.directions() == system.unknown_count()
        });
        let is_final = codistribution.is_final() || known || settled;
        let lie_derivative =
            |(lie_derivative, entries): (&crate::observability::LieDerivative, &Vec<NodeId>)| TakenRow {
                lie_derivative: lie_derivative.text(system),
                entries: entries.clone(),
            };
        let numbered = |(index, entries): (usize, &[NodeId])| TakenRow {
            lie_derivative: format!("row {}", index + 1),
            entries: entries.to_vec(),
        };
        let own_rows = own.unwrap_or_default().chunks(system.unknown_count());
        let mut answer = BranchAnswer {
            taken: codistribution
                .lie_derivatives
                .iter()
                .zip(&codistribution.rows)
                .map(lie_derivative)
                .collect(),
            own: own_rows.enumerate().map(numbered).collect(),
            conditions: locus.conditions.clone(),
            by_default: locus.by_default.clone(),
            held: held_parameters(system, question, &branch.values, own.into_iter().flatten()),
            lie_derivatives: codistribution
                .needed
                .iter()
                .map(|i| codistribution.lie_derivatives[*i].text(system))
                .collect(),
            unknowns: named_unknowns(system),
            order: codistribution.order,
            stop: codistribution.stop,
            generic_rank,
            is_final,
            motions,
            cut_off: question.order.is_none()
                && !known
                && !codistribution.is_final()
                && !codistribution.has_rested(),
            generic: codistribution.generic,
            full,
            deviations,
            rows,
        };
        // such states show what these Lie derivatives do, and no more
        let short = answer.is_short_somewhere();
        let recorded = std::mem::take(&mut answer.full.recorded);
        answer.full.recorded =
            recorded.into_iter().filter(|state| !answer.may_be_raised(state.rank)).collect();
        if let Some(found) = &mut answer.deviations {
            found.may_be_finite = short;
        }
        Ok(answer)
    }
}

/// The unobservable fields, where something is unobservable and all conditions are on parameters; `given` are those of the
/// question.
fn motions(
    system: &mut System,
    codistribution: &Codistribution,
    conditions: &Assignment,
    given: &[Symbol],
) -> Option<UnobservableDirections> {
    let found = codistribution.generic.rank().unwrap_or(codistribution.generic_rank());
    let unobservable = found < system.unknown_count();
    let of_states = |system: &System, symbol: &Symbol, value: NodeId| {
        let mentioned = system.graph.symbols_of([value]);
        [*symbol].iter().chain(&mentioned).any(|symbol| system.states.contains(symbol))
    };
    if !unobservable || conditions.iter().any(|(symbol, value)| of_states(system, symbol, *value)) {
        return None;
    }
    let given = given.iter().map(|symbol| (*symbol, conditions[symbol])).collect();
    let found = unobservable_directions(system, Some(codistribution), conditions, &given)?;
    (found.directions() > 0).then_some(found)
}
