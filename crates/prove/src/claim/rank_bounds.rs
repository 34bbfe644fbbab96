//! Bounds on ranks of rows with functions: from above by the known relations between the functions, from below at a state.

use super::claimed_ranks::ClaimedRanks;
use super::rank_witness::best_state;
use super::terms::OnBranch;
use super::verdict::{Verdict, Witness};
use palmistry_lang::System;
use palmistry_math::expression::NodeId;
use palmistry_math::expression::{Guard, Need, expand};
use palmistry_rank::observability::related_rank;
use rand::Rng;

/// Rows of expressions, one after the other.
pub(super) struct Rows<'a> {
    pub entries: &'a [NodeId],
    pub columns: usize,
    /// What is said of them beside their rank.
    pub scope: &'a str,
    /// Those of them that give the rank, as terms that a state can be put into.
    pub on: &'a OnBranch,
}

/// What is known of a rank beside the rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// It is no more at any state.
    pub most: usize,
    /// But for an error of this probability, as a power of two.
    pub log2_error: f64,
    /// Whether the rows without those that give the rank hold all that comes next: where these add nothing, nothing does.
    pub settled: bool,
}

/// The two halves of the proof.
const BOUNDS: &str = "a minor at a state, by enclosures, and exact arithmetic at random points of random prime fields with what is \
                      known of the functions";

/// Decides the rank by bounds. `limits` say what holds of rows that were not taken.
pub(super) fn by_bounds(
    system: &mut System,
    rows: &Rows<'_>,
    limits: Limits,
    claimed: ClaimedRanks,
    rng: &mut impl Rng,
) -> Verdict {
    let guards = rows.on.terms.guards.clone();
    let related = related_rank(system, rows.entries, rows.columns, &guards, rng);
    let height = rows.entries.len() / rows.columns.max(1);
    let of_rows = related.as_ref().map_or(height.min(rows.columns), |found| found.needed.len());
    let (lower, witness) = match best_state(system, rows.on, rows.columns, of_rows.min(limits.most), rng) {
        Some((rank, state)) => (rank, Some(state)),
        None => (0, None),
    };
    // what has stopped growing at a state has stopped for good on its component
    let rests = limits.settled && lower == of_rows;
    let upper = if rests { lower } else { limits.most };
    let log2_error = match &related {
        Ok(found) if upper < rows.columns => found.log2_error.max(limits.log2_error),
        _ if upper < rows.columns => limits.log2_error,
        _ => f64::NEG_INFINITY,
    };
    let refuted = |left: String| {
        let Some(state) = witness.clone() else {
            return Verdict::undecided(format!(
                "the rank is {left} at all states, and no state in exact numbers was found at which all of it is defined"
            ));
        };
        let witness = Witness { state, left, right: claimed.to_string(), entry: None, refutation: None };
        Verdict::Refuted { engine: BOUNDS.to_owned(), witness }
    };
    let word = |bound: &str, rank: usize| match lower == upper {
        true => rank.to_string(),
        false => format!("{bound} {rank}"),
    };
    if lower > claimed.most {
        return refuted(word("at least", lower));
    }
    if upper < claimed.least {
        return refuted(word("at most", upper));
    }
    if upper <= claimed.most && claimed.least == 0 {
        // at no state it is more
        return Verdict::Proved { engine: format!("{BOUNDS}{}", rows.scope), log2_error };
    }
    let is_settled = claimed.least <= lower && upper <= claimed.most;
    if !is_settled {
        let why = related.err().map_or(String::new(), |why| format!("; {why}"));
        return Verdict::undecided(format!(
            "the rank is at least {lower} at a state and at most {upper} at any, and it is not known which{why}"
        ));
    }
    let everywhere = upper == 0 || related.is_ok_and(|found| found.everywhere) || is_convex(system, &guards);
    if everywhere {
        return Verdict::Proved { engine: format!("{BOUNDS}{}", rows.scope), log2_error };
    }
    let place: Vec<String> = witness
        .iter()
        .flatten()
        .map(|coordinate| format!("{} = {}", coordinate.name, coordinate.exact))
        .collect();
    Verdict::undecided(format!(
        "the rank is generically {} around {}; that it is so on every component of the domain is not shown",
        word("at least", lower),
        place.join(", ")
    ))
}

/// Whether the guards show that the states at which they all hold are a convex set, and so one component.
fn is_convex(system: &mut System, guards: &[Guard]) -> bool {
    let is_angle = &system.angle_test();
    guards.iter().all(|guard| match guard.need {
        _ if guard.is_obvious(&system.graph) == Some(true) => true,
        Need::NotZero => false,
        _ => expand(&mut system.graph, guard.node, is_angle).is_ok_and(|found| {
            let plain = found
                .variables
                .iter()
                .all(|input| matches!(input, palmistry_math::expression::Input::Plain(_)));
            plain && found.denominator.is_empty() && found.numerator.degree() <= 1
        }),
    })
}
