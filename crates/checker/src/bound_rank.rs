//! Ranks checked against what the proof file says: rows are built anew, and what is left out of the evidence is not taken for granted.

use super::binding::{ClaimKind, ClaimSense, RecordedWord, listed_statement};
use super::bound_drawn::is_shown_at_points;
use super::bound_span::{Asked, is_shown};
use super::checking::Checking;
use super::claim::{BuiltClaim, OWN_ROWS, Subject, further_rows, numbered_row, rows_of_lie_derivatives};
use super::claimed_rank::Tried;
use super::doubt::{Doubt, Effort, Finding, Half, Missing, ShownBy, Unchecked};
use super::listing::Listing;
use super::minor::CertifiedRank;
use super::normal::{Equations, states_on_parts};
use super::own_matrix::{OwnMatrix, is_generic, is_rational, lowered};
use super::record::{Evidence, VerdictRecord};
use super::state::{ExactCoordinate, ExactState};
use super::witness::holds;
use palmistry_lang::{System, Value};
use palmistry_math::expression::NodeId;

/// The work on rows of the checker's own.
const TRIED: u64 = 1 << 25;

/// A verdict on a claim about a rank, or about what is observable.
pub(super) fn of_a_claim(
    record: &VerdictRecord,
    system: &mut System,
    claim: &BuiltClaim,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let given = match &record.evidence {
        Evidence::ClaimedRank(found) => &found.matrix,
        Evidence::Rank(found) => found,
        _ => return Err(Doubt::OtherClaim("the evidence is of another kind than the claim")),
    };
    let claimed = match claim.subject {
        Subject::Matrix { claimed, .. } | Subject::System { claimed } => Some(claimed),
        _ => None,
    };
    if let (Evidence::ClaimedRank(found), Some(claimed)) = (&record.evidence, claimed)
        && found.claimed != claimed
    {
        return Err(Doubt::OtherClaim("the claimed number is another"));
    }
    // with the differential of a function among the rows a full rank says nothing of that function
    let of_functions = match &claim.subject {
        Subject::Functions { functions } => functions.iter().map(|node| system.graph.text(*node)).collect(),
        _ => Vec::new(),
    };
    let is_of_lie_derivatives = !given.row_names.iter().any(|word| of_functions.contains(word));
    let own = own_matrix(system, claim, given)?;
    let is_refuted = record.verdict == RecordedWord::Refuted;
    let is_generic = is_generic(&own);
    let rows = own.matrix.clone();
    let finding = by_states(record, claim, (claimed, is_of_lie_derivatives), own, with)?;
    let is_open = matches!(finding, Finding::HalfConfirmed(_) | Finding::Consistent { .. });
    let rank = match (&record.evidence, given.states.as_slice()) {
        (Evidence::ClaimedRank(_), [state]) if claimed.is_some() => Some(state.rank),
        (Evidence::ClaimedRank(_), _) if !is_refuted => None,
        _ => return Ok(finding),
    };
    let is_observable = record.asked.what == ClaimKind::Observable;
    if !is_open || record.asked.sense != ClaimSense::Generic {
        return Ok(finding);
    }
    let is_full = rank.is_some_and(|rank| rank == rows.columns.len());
    if is_full
        && is_rational(&rows.listing, rows.rows.iter().flatten().copied())
        && is_full_on_each_part(system, &rows, with)?
    {
        return Ok(Finding::Shown(ShownBy::EachPart));
    }
    let asked = Asked { rank, given: Some(given), is_generic, is_observable };
    if is_shown(system, claim, asked, with)? {
        return Ok(Finding::Shown(ShownBy::Eliminated));
    }
    if is_shown_at_points(system, claim, (asked, given), with)? {
        return Ok(Finding::Shown(ShownBy::RankAtPoints));
    }
    Ok(finding)
}

/// Whether the rank is full at a state of each part of the set on which the conditions hold.
fn is_full_on_each_part(system: &System, rows: &CertifiedRank, with: Checking<'_>) -> Result<bool, Doubt> {
    let [known] = rows.states.as_slice() else { return Ok(false) };
    // what the state gives by an operation may be free here, and the other way round
    let mut like = known.state.clone();
    for (name, value) in &mut like {
        if matches!(value, ExactCoordinate::Step(_)) {
            let is_angle = system.find_symbol(name).is_some_and(|symbol| system.is_angle(symbol));
            *value = ExactCoordinate::unit(is_angle);
        }
    }
    let states = Equations {
        listing: &rows.listing,
        sides: &[],
        conditions: &rows.conditions,
        requirements: &rows.requirements,
    };
    let effort = with.effort.limited(TRIED);
    let parts = match states_on_parts(states, &rows.rows, (&like, with.seed), &effort) {
        Ok(parts) => parts,
        Err(Missing::Effort | Missing::Refused { .. }) => return Ok(false),
        Err(other) => return Err(other.into()),
    };
    let full = rows.columns.len();
    let is_full = |state: &ExactState| rows.rank_at(state, &effort).is_ok_and(|rank| rank == full);
    Ok(parts.is_some_and(|parts| !parts.is_empty() && parts.iter().all(|part| part.iter().any(is_full))))
}

/// The same by what was found at states.
fn by_states(
    record: &VerdictRecord,
    claim: &BuiltClaim,
    (claimed, is_of_lie_derivatives): (Option<usize>, bool),
    own: OwnMatrix,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let is_refuted = record.verdict == RecordedWord::Refuted;
    match (&record.evidence, claimed) {
        (Evidence::ClaimedRank(found), Some(_)) if record.asked.sense == ClaimSense::Generic => {
            let is_generic = is_generic(&own);
            let states = &own.matrix.states;
            let assumes_more = states.iter().any(|state| claim.is_exceeded_by(&state.state));
            let tried = Tried { is_whole: own.is_whole, is_generic, assumes_more, longer: Some(&own.longer) };
            found.with_matrix(own.matrix).check_as(tried, with.seed, with.effort)
        }
        (Evidence::ClaimedRank(found), None) => {
            let full = own.matrix.columns.len();
            let is_full = is_of_lie_derivatives && own.matrix.states.iter().any(|state| state.rank == full);
            let is_generic = is_generic(&own);
            let tried = Tried { is_whole: false, is_generic, assumes_more: false, longer: None };
            let finding = found.with_matrix(own.matrix).check_as(tried, with.seed, with.effort)?;
            let is_observable = record.asked.what == ClaimKind::Observable;
            Ok(what_is_observable(finding, is_full, is_observable != is_refuted))
        }
        (Evidence::Rank(_), None) => {
            let finding = own.matrix.check(with.effort, with.interrupt);
            let full = own.matrix.columns.len();
            let is_full = is_of_lie_derivatives
                && own.matrix.states.iter().any(|state| state.rank == full)
                && is_generic(&own);
            let is_observable = record.asked.what == ClaimKind::Observable;
            Ok(what_is_observable(finding, is_full, is_observable != is_refuted))
        }
        (Evidence::ClaimedRank(_), Some(claimed)) => at_each_state(&own, claimed, (record, false), with),
        (_, Some(claimed)) => at_each_state(&own, claimed, (record, true), with),
        _ => Err(Doubt::OtherClaim("the evidence is of another kind than the claim")),
    }
}

/// Where the rank is full all functions are observable; otherwise no state decides it.
fn what_is_observable(finding: Finding, is_full: bool, is_said_to_be: bool) -> Finding {
    match finding {
        Finding::NotConfirmed(doubt) => Finding::NotConfirmed(doubt),
        _ if is_full && !is_said_to_be => Finding::NotConfirmed(Doubt::FullRank),
        Finding::HalfConfirmed(Half::PartOfTheSet) if is_full => Finding::HalfConfirmed(Half::PartOfTheSet),
        Finding::Confirmed { times } if is_full => Finding::Confirmed { times },
        Finding::Consistent { states } => Finding::Consistent { states },
        Finding::HalfConfirmed(Half::GenericallyNoLess { states }) => Finding::Consistent { states },
        _ => Finding::Consistent { states: 0 },
    }
}

/// A claim about a rank at each state of a set, or, for a generic one, a state at which the rank is another.
fn at_each_state(
    own: &OwnMatrix,
    claimed: usize,
    (record, has_kernel): (&VerdictRecord, bool),
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    if has_kernel && let Finding::NotConfirmed(doubt) = own.matrix.check(with.effort, with.interrupt) {
        return Err(doubt);
    }
    let (mut refuted, mut states) = (false, 0);
    for (place, state) in own.matrix.states.iter().enumerate() {
        let values = own.matrix.is_at_least(place, state, with.effort)?;
        states += 1;
        if holds(&values, &[], &own.claim.except_requirements).is_err() {
            // whether a state at which a named set is undefined lies in it is for no evaluation to say
            continue;
        }
        for set in &own.claim.except {
            let mut is_outside = false;
            for side in set {
                is_outside |= side.hold(&values)? == Some(false);
            }
            if !is_outside {
                return Err(Doubt::LeftOut(place));
            }
        }
        let is_each = record.asked.sense.is_of_each_state();
        let is_less = is_each && has_kernel && own.is_whole && state.rank < claimed;
        refuted |= state.rank > claimed || is_less;
        let agrees = (state.rank == claimed) == (record.verdict == RecordedWord::Proved);
        if !agrees {
            return Err(Doubt::OtherRank { found: state.rank, claimed });
        }
    }
    Ok(match refuted {
        true => Finding::Confirmed { times: 1 },
        false => Finding::Consistent { states: states - 1 },
    })
}

/// Ranks at recorded states.
pub(super) fn at_states(
    record: &VerdictRecord,
    system: &mut System,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let Evidence::Rank(given) = &record.evidence else {
        return Err(Doubt::OtherClaim("the evidence is of another kind than the verdict"));
    };
    let (claim, is_own) = listed_claim(record, system, &given.row_names)?;
    if let Finding::NotConfirmed(doubt) = given.check(with.effort, with.interrupt) {
        return Err(doubt);
    }
    let own = match is_own {
        true => own_matrix(system, &claim, given)?,
        false => of_rows(system, &claim, given)?,
    };
    let finding = own.matrix.check(with.effort, with.interrupt);
    let times = own.matrix.states.len();
    let is_full = own.matrix.states.iter().all(|state| state.rank == own.matrix.columns.len());
    let is_short = matches!(finding, Finding::Confirmed { .. }) && !is_full && !own.is_whole;
    if is_short {
        let effort = Effort::new(TRIED);
        for state in &own.longer.states {
            match own.longer.rank_at(&state.state, &effort) {
                Ok(rank) if rank > state.rank => {
                    return Err(Doubt::GreaterRank { found: rank, stated: state.rank });
                }
                _ => {}
            }
        }
    }
    Ok(match finding {
        Finding::Confirmed { .. } if is_short => {
            if own.matrix.states.iter().all(|state| state.rank == 0) {
                return Ok(Finding::Consistent { states: times.saturating_sub(1) });
            }
            Finding::HalfConfirmed(Half::NoLessAtStates { times })
        }
        finding => finding,
    })
}

/// Full rank on boxes.
pub(super) fn on_boxes(
    record: &VerdictRecord,
    system: &mut System,
    with: Checking<'_>,
) -> Result<Finding, Doubt> {
    let Evidence::Boxes(given) = &record.evidence else {
        return Err(Doubt::OtherClaim("the evidence is of another kind than the verdict"));
    };
    if given.digest != given.digest_of_the_rest() {
        return Err(Doubt::DigestDiffers);
    }
    let (claim, is_own) = listed_claim(record, system, &given.row_names)?;
    let Subject::Matrix { rows, .. } = &claim.subject else {
        return Ok(Finding::NotChecked(Unchecked::Nothing));
    };
    if given.columns != system.column_names() {
        return Err(Doubt::OtherColumns);
    }
    let chosen: Vec<&Vec<NodeId>> = match is_own {
        true => given
            .row_names
            .iter()
            .map(|word| Ok(&rows[numbered_row(word, rows.len())?]))
            .collect::<Result<_, Doubt>>()?,
        false => rows.iter().collect(),
    };
    let (listed, rows) = claim.listed(system, &Listing::default(), |lowering| {
        let row = |row: &&Vec<NodeId>| row.iter().map(|entry| lowering.place(*entry)).collect();
        chosen.iter().map(row).collect::<Result<Vec<Vec<usize>>, _>>()
    })?;
    let mut own = given.clone();
    (own.listing, own.rows, own.requirements) = (listed.listing, rows, listed.requirements);
    own.digest = own.digest_of_the_rest();
    Ok(own.check(with.effort, with.interrupt))
}

/// A claim made of what is listed: rows of the file, or of its Lie derivatives, and what is assumed.
fn listed_claim(
    record: &VerdictRecord,
    system: &mut System,
    row_names: &[String],
) -> Result<(BuiltClaim, bool), Doubt> {
    let asked = &record.asked;
    let (id, is_own) = match asked.what {
        ClaimKind::SystemAtStates => ("rank", false),
        ClaimKind::RowsAtStates => (OWN_ROWS, true),
        ClaimKind::SystemOnBoxes => ("certify", false),
        _ => ("certify", true),
    };
    let fits = asked.sense == ClaimSense::Listed && asked.except.is_empty() && asked.claimed.is_empty();
    if record.id != id
        || !fits
        || record.verdict != RecordedWord::Found
        || record.statement != listed_statement(asked.what, &asked.given)
    {
        return Err(Doubt::OtherClaim("it is filed under another name, or says something else"));
    }
    let rows = match is_own {
        false => rows_of_lie_derivatives(system, row_names, &[])?,
        true => match system.definition(OWN_ROWS) {
            Some(Value::Matrix(matrix)) if matrix.columns == system.unknown_count() => {
                matrix.entries.chunks(matrix.columns.max(1)).map(<[NodeId]>::to_vec).collect()
            }
            _ => return Err(Doubt::OtherClaim("the proof file has no rows of its own")),
        },
    };
    let states = match &record.evidence {
        Evidence::Rank(found) => found.states.as_slice(),
        _ => &[],
    };
    Ok((BuiltClaim::of_rows(system, rows, is_own, &asked.given, states)?, is_own))
}

/// The matrix of a claim; minors name rows of the evidence, which may be some of those that the claim has.
fn own_matrix(system: &mut System, claim: &BuiltClaim, given: &CertifiedRank) -> Result<OwnMatrix, Doubt> {
    let (rows, columns) = match &claim.subject {
        Subject::Matrix { rows, columns, .. } => (rows, *columns),
        Subject::System { .. } => return of_lie_derivatives(system, claim, given, &[]),
        Subject::Functions { functions } => return of_lie_derivatives(system, claim, given, functions),
        _ => return Err(Doubt::OtherClaim("the evidence is of another kind than the claim")),
    };
    let places: Vec<usize> =
        given.row_names.iter().map(|word| numbered_row(word, rows.len())).collect::<Result<_, _>>()?;
    if given.columns.len() != columns {
        return Err(Doubt::OtherColumns);
    }
    let mut own = lowered(system, claim, given, (rows, Vec::new()))?;
    own.matrix.row_names = (1..=rows.len()).map(|row| format!("row {row}")).collect();
    for (index, state) in own.matrix.states.iter_mut().enumerate() {
        for row in &mut state.minor.rows {
            let place = places.get(*row).copied();
            *row = place.ok_or(Doubt::NoMinor { state: index, rank: state.rank })?;
        }
    }
    own.is_whole = true;
    Ok(own)
}

fn of_lie_derivatives(
    system: &mut System,
    claim: &BuiltClaim,
    given: &CertifiedRank,
    functions: &[NodeId],
) -> Result<OwnMatrix, Doubt> {
    if given.columns != system.column_names() {
        return Err(Doubt::OtherColumns);
    }
    let rows = rows_of_lie_derivatives(system, &given.row_names, functions)?;
    // with the differential of a function among them further rows would say something else
    let further = if functions.is_empty() { further_rows(system, &given.row_names) } else { Vec::new() };
    lowered(system, claim, given, (&rows, further))
}

/// The same for rows that were built already, one for each row name of the evidence.
fn of_rows(system: &mut System, claim: &BuiltClaim, given: &CertifiedRank) -> Result<OwnMatrix, Doubt> {
    match &claim.subject {
        Subject::Matrix { rows, .. } if given.columns == system.column_names() => {
            let further = further_rows(system, &given.row_names);
            lowered(system, claim, given, (rows, further))
        }
        _ => Err(Doubt::OtherColumns),
    }
}
