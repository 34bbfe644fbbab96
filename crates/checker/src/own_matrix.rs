//! A matrix as the proof file has it, at the states of evidence, and what a minor at a state says of it.

use super::checking::operations;
use super::claim::{BuiltClaim, ListedClaim};
use super::doubt::Doubt;
use super::listing::{Listing, Step};
use super::minor::{CertifiedRank, RankedState};
use super::modular::given_by;
use super::state::ExactCoordinate;
use super::witness::RequirementKind;
use palmistry_lang::System;
use palmistry_math::expression::NodeId;
use palmistry_math::number::Function;

/// A matrix as the proof file has it, at the states of the evidence.
pub(super) struct OwnMatrix {
    pub(super) matrix: CertifiedRank,
    pub(super) claim: ListedClaim,
    /// Whether these are all rows that there are; Lie derivatives have no end.
    pub(super) is_whole: bool,
    /// The same with further rows, among which a greater rank would show.
    pub(super) longer: CertifiedRank,
}

/// The rows of a claim with what it assumes behind the operations of the evidence's states, and the same with further rows.
pub(super) fn lowered(
    system: &System,
    claim: &BuiltClaim,
    given: &CertifiedRank,
    (rows, mut further): (&[Vec<NodeId>], Vec<Vec<NodeId>>),
) -> Result<OwnMatrix, Doubt> {
    let by_steps =
        given.states.iter().find(|state| !operations(&given.listing, &state.state).steps().is_empty());
    let behind = by_steps.map_or_else(Listing::default, |state| operations(&given.listing, &state.state));
    further.retain(|row| !rows.contains(row));
    let lower = |rows: &[Vec<NodeId>]| {
        claim.listed(system, &behind, |lowering| {
            let row = |row: &Vec<NodeId>| row.iter().map(|entry| lowering.place(*entry)).collect();
            rows.iter().map(row).collect::<Result<Vec<Vec<usize>>, _>>()
        })
    };
    let matrix = |listed: &mut ListedClaim, rows: Vec<Vec<usize>>| CertifiedRank {
        rows,
        listing: std::mem::take(&mut listed.listing),
        conditions: listed.conditions.clone(),
        requirements: listed.requirements.clone(),
        ..given.clone()
    };
    let (mut listed, places) = lower(rows)?;
    let own = matrix(&mut listed, places);
    further.extend_from_slice(rows);
    let (mut with_more, places) = lower(&further)?;
    let longer = matrix(&mut with_more, places);
    Ok(OwnMatrix { matrix: own, claim: listed, is_whole: false, longer })
}

/// Whether a minor that is not zero at one state is not zero at almost all: the entries are quotients of functions that are
/// analytic in all complex numbers, and the states are all there are, or an open part of them, or those at which some symbols have the values
/// that equations give them by the others. What has to be positive leaves an open part; what may be zero as well can leave single states (`sqrt(-x^2)`).
pub(super) fn is_generic(own: &OwnMatrix) -> bool {
    let matrix = &own.matrix;
    let is_open = |kind| {
        matches!(kind, RequirementKind::NotZero | RequirementKind::Positive | RequirementKind::InsideOne)
    };
    if !matrix.requirements.iter().all(|requirement| is_open(requirement.kind)) {
        return false;
    }
    let Some(given) = given_by(&matrix.listing, &matrix.conditions, false) else { return false };
    let steps = matrix.listing.steps();
    // what a state gives by an operation is free in no claim
    let is_free = |name: &String| !given.symbols.iter().any(|(known, _)| known == name);
    let by_numbers = |state: &RankedState| {
        !state.state.iter().any(|(name, value)| {
            let is_constant = |place: &usize| matches!(steps.get(*place), Some(Step::Constant(_)));
            is_free(name) && matches!(value, ExactCoordinate::Step(place) if !is_constant(place))
        })
    };
    let places = matrix.rows.iter().flatten().copied().chain(given.symbols.iter().map(|(_, place)| *place));
    is_rational(&matrix.listing, places) && matrix.states.iter().all(by_numbers)
}

/// Whether the entries are quotients of sums and products of symbols, sines, cosines and exponentials.
pub(super) fn is_rational(listing: &Listing, places: impl Iterator<Item = usize>) -> bool {
    let steps = listing.steps();
    let mut open: Vec<usize> = places.collect();
    let mut met = vec![false; steps.len()];
    while let Some(place) = open.pop() {
        let Some(known) = met.get_mut(place) else { return false };
        if std::mem::replace(known, true) {
            continue;
        }
        if let Step::Apply(function, _) = &steps[place]
            && !matches!(function, Function::Sin | Function::Cos | Function::Exp)
        {
            return false;
        }
        open.extend(steps[place].operands());
    }
    true
}
