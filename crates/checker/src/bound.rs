//! A verdict checked against its claim: the claim is read from the proof file, its sides and rows are built anew, and the verdict is
//! confirmed only where its evidence implies it.

use super::binding::{ClaimKind, ClaimParts, ClaimSense, RecordedWord};
use super::bound_span::{Asked, is_shown, pole_is_shown};
use super::checking::{Checking, operations};
use super::claim::{BuiltClaim, Subject, sides, statement};
use super::claimed_rank::ClaimedWord;
use super::doubt::{Doubt, Effort, Finding, ShownBy, Unchecked};
use super::identity::StatedIdentity;
use super::listing::Listing;
use super::modular::{given_by, vanish};
use super::normal::{Equations, follow};
use super::record::{Evidence, VerdictRecord};
use super::sources::source_digest;
use super::state::{ExactCoordinate, ExactState, Ratio};
use super::witness::{Refutation, Sides, SidesRelation};
use palmistry_lang::{System, in_one_line};
use palmistry_math::expression::syntax::Relation;

/// The work on multiplying out the sides of one claim.
const WORK: u64 = 1 << 23;
/// The work on them at random points.
const POINTS: u64 = 1 << 28;

/// Checks one verdict against its proof file.
pub(super) fn check(record: &VerdictRecord, with: Checking<'_>) -> Finding {
    match try_check(record, with) {
        Ok(finding) => finding,
        // nothing was said that could be doubted
        Err(_) if matches!(record.evidence, Evidence::Unchecked(_)) => {
            Finding::NotChecked(Unchecked::Nothing)
        }
        Err(doubt) => Finding::NotConfirmed(doubt),
    }
}

fn try_check(record: &VerdictRecord, with: Checking<'_>) -> Result<Finding, Doubt> {
    let source = match with.sources.system(&record.file) {
        Ok(source) => source,
        Err(why) => return Ok(Finding::NotChecked(Unchecked::NoProofFile(why))),
    };
    if source_digest(&source.source) != record.digest {
        return Ok(Finding::NotChecked(Unchecked::OtherProofFile));
    }
    let mut system = (*source).clone();
    if record.verdict == RecordedWord::Found && !system.zero_outputs().is_empty() {
        return Ok(Finding::NotChecked(Unchecked::TiedOutputs));
    }
    match record.asked.what {
        ClaimKind::SystemAtStates | ClaimKind::RowsAtStates => {
            super::bound_rank::at_states(record, &mut system, with)
        }
        ClaimKind::SystemOnBoxes | ClaimKind::RowsOnBoxes => {
            super::bound_rank::on_boxes(record, &mut system, with)
        }
        _ => of_a_claim(record, &mut system, with),
    }
}

fn of_a_claim(record: &VerdictRecord, system: &mut System, with: Checking<'_>) -> Result<Finding, Doubt> {
    let said =
        statement(system, &record.id).ok_or(Doubt::OtherClaim("the proof file has no such claim"))?.clone();
    let text = system.source.get(said.span.clone()).unwrap_or_default();
    if in_one_line(&system.source, &said.span) != record.statement {
        return Err(Doubt::OtherClaim("the claim of this id says something else"));
    }
    if ClaimParts::of(text) != record.asked {
        return Err(Doubt::OtherClaim("the number, the sense or the conditions of the claim are others"));
    }
    let fits = match &record.evidence {
        Evidence::Refuted(_) => record.verdict == RecordedWord::Refuted,
        Evidence::Proved(_) => record.verdict == RecordedWord::Proved,
        Evidence::ClaimedRank(rank) => {
            (rank.word == ClaimedWord::Proved) == (record.verdict == RecordedWord::Proved)
        }
        Evidence::Rank(_) => true,
        Evidence::Unchecked(_) => true,
        Evidence::Boxes(_) => false,
    };
    if !fits || record.verdict == RecordedWord::Found {
        return Err(Doubt::OtherClaim("the evidence is of another kind than the verdict"));
    }
    if let Finding::NotConfirmed(doubt) = record.evidence.check_alone(with.seed, with.effort, with.interrupt)
    {
        return Err(doubt);
    }
    let claim = BuiltClaim::of(system, &said)?;
    let is_of_the_system = matches!(claim.subject, Subject::System { .. } | Subject::Functions { .. });
    if is_of_the_system && !system.zero_outputs().is_empty() {
        return Ok(Finding::NotChecked(Unchecked::TiedOutputs));
    }
    match (&claim.subject, &record.evidence) {
        (Subject::Sides(_), Evidence::Refuted(found)) => refuted(system, &claim, found, with.effort),
        (Subject::Sides(_), Evidence::Proved(found)) => proved(system, &claim, found, with),
        (Subject::Near { .. }, Evidence::Refuted(_) | Evidence::Proved(_)) => {
            near(system, &claim, &record.evidence, with)
        }
        (
            Subject::Matrix { claimed, .. } | Subject::System { claimed },
            Evidence::Proved(_) | Evidence::Unchecked(_),
        ) => without_states(record, system, &claim, Some(*claimed), with),
        (Subject::Pole { expression, factor, order }, Evidence::Unchecked(_)) => {
            let is_asked = record.verdict == RecordedWord::Proved;
            let asked = ((*expression, *factor), *order);
            Ok(match is_asked && pole_is_shown(system, &claim, asked, with)? {
                true => Finding::Shown(ShownBy::MultipliedOut),
                false => Finding::NotChecked(Unchecked::Nothing),
            })
        }
        (Subject::Functions { .. }, Evidence::Proved(_) | Evidence::Unchecked(_)) => {
            without_states(record, system, &claim, None, with)
        }
        (
            Subject::Matrix { .. } | Subject::System { .. } | Subject::Functions { .. },
            Evidence::ClaimedRank(_),
        )
        | (Subject::Matrix { .. } | Subject::System { .. } | Subject::Functions { .. }, Evidence::Rank(_)) => {
            super::bound_rank::of_a_claim(record, system, &claim, with)
        }
        (Subject::Other, _) | (_, Evidence::Unchecked(_)) => Ok(Finding::NotChecked(Unchecked::Nothing)),
        _ => Err(Doubt::OtherClaim("the evidence is of another kind than the claim")),
    }
}

/// What a generic claim about a rank or about functions comes to where no state is at hand, or an equation that is a step of its proof.
fn without_states(
    record: &VerdictRecord,
    system: &mut System,
    claim: &BuiltClaim,
    rank: Option<usize>,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let asked = Asked {
        rank,
        given: None,
        is_generic: false,
        is_observable: record.asked.what == ClaimKind::Observable,
    };
    let is_asked = record.asked.sense == ClaimSense::Generic && record.verdict == RecordedWord::Proved;
    if is_asked && is_shown(system, claim, asked, with)? {
        return Ok(Finding::Shown(ShownBy::Eliminated));
    }
    Ok(Finding::NotChecked(match record.evidence {
        Evidence::Unchecked(_) => Unchecked::Nothing,
        _ => Unchecked::StepOfAProof,
    }))
}

fn refuted(
    system: &System,
    claim: &BuiltClaim,
    found: &Refutation,
    effort: &Effort,
) -> Result<Finding, Doubt> {
    let Subject::Sides(pairs) = &claim.subject else { return Ok(Finding::NotChecked(Unchecked::Nothing)) };
    let behind = operations(&found.listing, &found.state);
    let (listed, entries) = claim.listed(system, &behind, |lowering| sides(lowering, pairs))?;
    let mut own = Refutation {
        listing: listed.listing,
        conditions: listed.conditions,
        requirements: listed.requirements,
        within: None,
        ..found.clone()
    };
    let mut why = Doubt::Empty;
    for entry in entries {
        own.sides = entry;
        match own.check(effort) {
            Finding::NotConfirmed(doubt) if doubt.is_of_no_entry() => return Err(doubt),
            Finding::NotConfirmed(doubt) => why = doubt,
            confirmed => return Ok(confirmed),
        }
    }
    Err(why)
}

fn proved(
    system: &System,
    claim: &BuiltClaim,
    found: &StatedIdentity,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let Subject::Sides(pairs) = &claim.subject else { return Ok(Finding::NotChecked(Unchecked::Nothing)) };
    let has_equations = claim.conditions.iter().any(|(_, relation, _)| *relation == Relation::Equal);
    if !has_equations && claim.is_exceeded_by(&found.state) {
        return Err(Doubt::OtherClaim("the state assumes what the claim does not"));
    }
    let behind = operations(&found.listing, &found.state);
    let (listed, sides) = claim.listed(system, &behind, |lowering| sides(lowering, pairs))?;
    let own = StatedIdentity {
        listing: listed.listing,
        conditions: listed.conditions,
        requirements: listed.requirements,
        sides,
        within: None,
        ..found.clone()
    };
    let finding = own.check(with.seed, with.effort);
    if !matches!(finding, Finding::Consistent { .. }) {
        return Ok(finding);
    }
    let equations = Equations {
        listing: &own.listing,
        sides: &own.sides,
        conditions: &own.conditions,
        requirements: &own.requirements,
    };
    // what takes too much work is not shown
    if follow(equations, &with.effort.limited(WORK)) == Ok(true) {
        return Ok(Finding::Shown(ShownBy::MultipliedOut));
    }
    Ok(match agrees_at_points(&own, with.effort) {
        true => Finding::Shown(ShownBy::AgreesAtPoints),
        false => finding,
    })
}

/// Whether equations hold at random points, where the conditions say what symbols are.
fn agrees_at_points(own: &StatedIdentity, effort: &Effort) -> bool {
    let equal = |sides: &Sides| sides.relation == SidesRelation::Equal;
    if own.sides.is_empty() || !own.sides.iter().all(equal) {
        return false;
    }
    let differences: Vec<(usize, usize)> = own.sides.iter().map(|sides| (sides.left, sides.right)).collect();
    given_by(&own.listing, &own.conditions, true)
        .is_some_and(|given| vanish(&own.listing, &given, &differences, &effort.limited(POINTS)) == Ok(true))
}

/// Two numbers and how near they are, at the values that the file gives.
fn near(
    system: &System,
    claim: &BuiltClaim,
    evidence: &Evidence,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let Subject::Near { sides: pair, tolerance } = &claim.subject else {
        return Ok(Finding::NotChecked(Unchecked::Nothing));
    };
    let mut state = ExactState::new();
    let nodes = [pair.0, pair.2, *tolerance].into_iter().chain(claim.guards.iter().map(|guard| guard.node));
    for symbol in system.graph.symbols_of(nodes) {
        let given = system.symbol_info(symbol).and_then(|info| info.default.clone());
        let given = given.ok_or(Doubt::OtherClaim("the proof file gives no value to what is compared"))?;
        state.insert(system.symbol_name(symbol).to_owned(), ExactCoordinate::Number(Ratio(given)));
    }
    let (listed, (pair, tolerance)) = claim.listed(system, &Listing::default(), |lowering| {
        let pair = lowering.sides(pair.0, pair.1, pair.2)?;
        Ok((pair, lowering.place(*tolerance)?))
    })?;
    let (listing, conditions, requirements) = (listed.listing, listed.conditions, listed.requirements);
    match evidence {
        Evidence::Refuted(found) => {
            let within = Some(tolerance);
            let printed = found.printed.clone();
            let own = Refutation { listing, state, sides: pair, within, conditions, requirements, printed };
            Ok(own.check(with.effort))
        }
        Evidence::Proved(found) => {
            let (sides, within) = (vec![pair], Some(tolerance));
            let own =
                StatedIdentity { listing, state, sides, within, conditions, requirements, ..found.clone() };
            Ok(own.check(with.seed, with.effort))
        }
        _ => Err(Doubt::OtherClaim("the evidence is of another kind than the claim")),
    }
}
