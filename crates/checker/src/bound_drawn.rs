//! Ranks of which one half is shown by a minor at a state, and the other at random points modulo primes.
//!
//! A Lie derivative is written as `Lg Lf^2 y`. Where the differentials of some of them are independent, and those of all outputs and of all derivatives of
//! these along each field are combinations of them, then so are those of all Lie derivatives: the derivative of a combination along a field is one of
//! what it combines and of their derivatives (R. Hermann, A. J. Krener, Nonlinear controllability and observability, 1977). Where known
//! symbols move, the differentials of their rates have to be combinations as well.

use super::bound_span::{Asked, is_kept, placed, rows_of_the_minor};
use super::checking::Checking;
use super::claim::{BuiltClaim, Subject, is_lie_derivative, rows_of_lie_derivatives};
use super::doubt::{Doubt, Missing};
use super::listing::Listing;
use super::minor::CertifiedRank;
use super::modular::{given_by, have_rank_of_at_most};
use super::own_matrix::{is_generic, lowered};
use palmistry_lang::{System, Time};
use palmistry_math::expression::{NodeId, Symbol, gradient};

/// The work on one claim.
const WORK: u64 = 1 << 29;
/// That on whether fields leave the set on which conditions hold.
const WORK_ON_CONDITIONS: u64 = 1 << 20;

/// Whether what is asked of almost all states holds there, with evidence that has a minor at one. `false` says nothing.
pub(super) fn is_shown_at_points(
    system: &mut System,
    claim: &BuiltClaim,
    (asked, given): (Asked<'_>, &CertifiedRank),
    with: Checking<'_>,
) -> Result<bool, Doubt> {
    if !asked.is_generic {
        return Ok(false);
    }
    match try_show(system, claim, (asked, given), with) {
        Err(Doubt::NoValue(Missing::Effort | Missing::Refused { .. })) => Ok(false),
        other => other,
    }
}

fn try_show(
    system: &mut System,
    claim: &BuiltClaim,
    (asked, given): (Asked<'_>, &CertifiedRank),
    with: Checking<'_>,
) -> Result<bool, Doubt> {
    let functions = match &claim.subject {
        Subject::Matrix { rows, .. } => {
            return match asked.rank {
                Some(rank) => has_rank_of_at_most(system, claim, rows, rank, with),
                None => Ok(false),
            };
        }
        Subject::System { .. } => Vec::new(),
        Subject::Functions { functions } => functions.clone(),
        _ => return Ok(false),
    };
    let Some(mut words) = rows_of_the_minor(given) else { return Ok(false) };
    let of_functions: Vec<String> = functions.iter().map(|node| system.graph.text(*node)).collect();
    let all = words.len();
    // an output that is one of the functions is a Lie derivative as well
    words.retain(|word| !of_functions.contains(word) || is_lie_derivative(system, word));
    let basis = rows_of_lie_derivatives(system, &words, &[])?;
    let unknowns = system.unknowns();
    let of = |system: &mut System, node: NodeId| gradient(&mut system.graph, node, &unknowns);
    let differentials: Vec<Vec<NodeId>> = functions.iter().map(|node| of(system, *node)).collect();
    let rank = basis.len();
    let [state] = given.states.as_slice() else { return Ok(false) };
    if !functions.is_empty() && asked.is_observable {
        // where a function stands in the minor, all Lie derivatives of the evidence have its rank without it
        let basis = match words.len() == all {
            true => basis,
            false => {
                let words: Vec<String> =
                    given.row_names.iter().filter(|word| is_lie_derivative(system, word)).cloned().collect();
                let rows = rows_of_lie_derivatives(system, &words, &[])?;
                let own = lowered(system, claim, given, (&rows, Vec::new()))?;
                if !is_generic(&own) || own.matrix.rank_at(&state.state, &with.effort.limited(WORK))? < all {
                    return Ok(false);
                }
                rows
            }
        };
        let rows = [basis, differentials].concat();
        return has_rank_of_at_most(system, claim, &rows, all, with);
    }
    if asked.rank.is_some_and(|asked| asked != rank) || !stops(system, claim, (&words, &basis), with)? {
        return Ok(false);
    }
    // what is no combination at one state is none at almost all
    for differential in differentials {
        let rows = [basis.clone(), vec![differential]].concat();
        let own = lowered(system, claim, given, (&rows, Vec::new()))?;
        if !is_generic(&own) || own.matrix.rank_at(&state.state, &with.effort.limited(WORK))? <= rank {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether all Lie derivatives are combinations of some, by their differentials.
fn stops(
    system: &mut System,
    claim: &BuiltClaim,
    (words, basis): (&[String], &[Vec<NodeId>]),
    with: Checking<'_>,
) -> Result<bool, Doubt> {
    // of an unknown signal there are columns without end; a known one is a state that is known, which an input moves
    let is_known = |symbol: &Symbol| system.known.contains(symbol);
    if system.time == Time::Discrete || !system.signal_chains().iter().flatten().all(is_known) {
        return Ok(false);
    }
    if !is_kept(system, claim, &with.effort.limited(WORK_ON_CONDITIONS))? {
        return Ok(false);
    }
    let mut rows = basis.to_vec();
    let mut longer = Vec::new();
    let unknowns = system.unknowns();
    for field in system.moving_fields() {
        let name = system.fields[field].name.clone();
        longer.extend(words.iter().map(|word| format!("L{name} {word}")));
        let rates: Vec<NodeId> = system.fields[field]
            .components
            .iter()
            .filter(|(symbol, _)| system.known.contains(symbol))
            .map(|(_, rate)| *rate)
            .collect();
        rows.extend(rates.into_iter().map(|rate| gradient(&mut system.graph, rate, &unknowns)));
    }
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, value)| *value).collect();
    rows.extend(outputs.into_iter().map(|output| gradient(&mut system.graph, output, &unknowns)));
    rows.extend(rows_of_lie_derivatives(system, &longer, &[])?);
    has_rank_of_at_most(system, claim, &rows, basis.len(), with)
}

fn has_rank_of_at_most(
    system: &System,
    claim: &BuiltClaim,
    rows: &[Vec<NodeId>],
    rank: usize,
    with: Checking<'_>,
) -> Result<bool, Doubt> {
    let (listed, rows) = claim.listed(system, &Listing::default(), |lowering| placed(lowering, rows))?;
    let Some(given) = given_by(&listed.listing, &listed.conditions, true) else { return Ok(false) };
    Ok(have_rank_of_at_most(&listed.listing, &given, &rows, rank, &with.effort.limited(WORK))?)
}
