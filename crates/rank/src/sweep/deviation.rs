//! How well each state is observable at states of a sweep: what [`Scales`] say there.

use super::scales::{DrawnStates, MeasuredRows, Scales};
use super::states::SweepReport;
use crate::observability::{Codistribution, Locus, LocusError, WrittenState};
use palmistry_lang::System;
use palmistry_math::expression::{NodeId, Symbol};

/// From this on a state is called nearly invisible: no instrument has six digits in its derivatives.
pub const NEARLY_INVISIBLE: f64 = 1e6;

/// How well one state is observable.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardDeviation {
    /// The state's name.
    pub state: String,
    /// Its spread (prior standard deviation) over the sample box, in its own unit; one where it has none.
    pub spread: f64,
    /// The median of its standard deviations at the states that were looked at, normalised by its spread. Infinite where it is
    /// unobservable, or where doubles cannot decide.
    pub median: f64,
    /// The greatest of them.
    pub worst: f64,
    /// At how many states it is infinite.
    pub infinite: usize,
    /// Whether the ranks of the sweep say that it is observable at every state: where it is infinite all the same, doubles cannot say
    /// how well.
    pub is_observable: bool,
}

/// The state of the system that is observable least, where it is so.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastObservable {
    /// The state's name.
    pub state: String,
    /// Its standard deviation there over its prior one; may be infinite.
    pub deviation: f64,
    /// Where.
    pub at: WrittenState,
}

/// How well each state is observable, at some states of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardDeviations {
    /// At how many states.
    pub states: usize,
    /// The Lie derivatives that are measured, and the spread of each, which is the unit of its noise.
    pub lie_derivatives: Vec<(String, f64)>,
    /// A row for each state of the system, in the order of the file.
    pub list: Vec<StandardDeviation>,
    /// The worst of them all; nothing of a system without states.
    pub least: Option<LeastObservable>,
    /// Whether Lie derivatives of higher order may make a state observable that is not by these.
    pub may_be_finite: bool,
}

/// Whether a sweep says of a state of the system that it is observable at every state that was drawn.
fn is_observable(system: &System, state: Symbol, swept: &SweepReport) -> bool {
    let name = system.symbol_name(state);
    let is_full = swept.rank_histogram.keys().all(|rank| *rank == system.unknown_count());
    let is_told = swept.certified == swept.samples;
    is_full
        || is_told
            && !swept.unobservable.iter().any(|direction| direction.states.iter().any(|part| part == name))
}

/// How well each state is observable by the Lie derivatives that were needed, at up to two hundred states drawn from a locus; those
/// that the sweep left out, since something does not exist there, are left out here too.
///
/// # Errors
/// Where states cannot be drawn.
pub(crate) fn standard_deviations(
    system: &mut System,
    locus: &Locus,
    codistribution: &Codistribution,
    swept: &SweepReport,
    (seed, samples): (u64, u64),
) -> Result<Option<StandardDeviations>, LocusError> {
    let values: Vec<NodeId> =
        codistribution.needed.iter().map(|lie_derivative| codistribution.values[*lie_derivative]).collect();
    let rows = MeasuredRows { entries: codistribution.needed_entries(), values: Some(values) };
    let drawn = DrawnStates::new(system, locus, &rows, seed, samples)?;
    if drawn.states.is_empty() {
        return Ok(None);
    }
    let scales = Scales::new(system, &drawn);
    let all: Vec<Vec<f64>> = drawn.matrices.iter().map(|matrix| scales.deviations(matrix, None)).collect();
    let unknowns = system.unknowns();
    let list = unknowns.iter().enumerate().map(|(column, symbol)| {
        let mut each: Vec<f64> = all.iter().map(|deviations| deviations[column]).collect();
        each.sort_by(f64::total_cmp);
        StandardDeviation {
            state: system.symbol_name(*symbol).to_owned(),
            spread: scales.priors[column],
            median: each[each.len() / 2],
            worst: each[each.len() - 1],
            infinite: each.iter().filter(|deviation| deviation.is_infinite()).count(),
            is_observable: is_observable(system, *symbol, swept),
        }
    });
    let list = list.collect();
    let mut least: Option<(f64, usize, usize)> = None;
    for (place, deviations) in all.iter().enumerate() {
        for (column, deviation) in deviations.iter().enumerate() {
            if least.is_none_or(|(most, ..)| *deviation > most) {
                least = Some((*deviation, place, column));
            }
        }
    }
    let least = least.map(|(deviation, place, column)| LeastObservable {
        state: system.symbol_name(unknowns[column]).to_owned(),
        deviation,
        at: drawn.states[place].describe(system),
    });
    let lie_derivatives = codistribution
        .needed
        .iter()
        .map(|lie_derivative| codistribution.lie_derivatives[*lie_derivative].text(system));
    let lie_derivatives = lie_derivatives.zip(scales.noise).collect();
    Ok(Some(StandardDeviations {
        states: drawn.states.len(),
        lie_derivatives,
        list,
        least,
        may_be_finite: false,
    }))
}
