//! Claims about ranks: of a matrix, or of the observability codistribution, at almost all states of a set.

use super::identity::RANDOM_PRIMES;
use super::verdict::{Verdict, Witness};
use crate::expression::NodeId;
use crate::observability::{Branch, Codistribution, GenericRank, Length, Stop, generic_rank};
use crate::system::{Matrix, System};
use rand::Rng;

/// A nonzero minor, the certain half of a statement about a rank.
const MINOR: &str = "a minor that is not zero modulo a prime";

/// Decides `rank(M) = claimed`.
pub(crate) fn decide_rank(
    system: &mut System,
    matrix: &Matrix,
    claimed: usize,
    rng: &mut impl Rng,
) -> Verdict {
    decide(system, &matrix.entries, matrix.columns, claimed, "", rng)
}

/// Decides `rank = claimed` for the codistribution, on the states of a branch.
pub(crate) fn decide_codistribution(
    system: &mut System,
    branch: &Branch,
    claimed: usize,
    rng: &mut impl Rng,
) -> Verdict {
    if system.outputs.is_empty() || system.states.is_empty() {
        return Verdict::undecided("there is no codistribution: the file declares no states or no outputs");
    }
    if let Err(why) = branch.check_codistribution(system) {
        return Verdict::undecided(why);
    }
    let words = match Codistribution::new(system, &branch.values, Length::UntilItStops) {
        Ok(words) => words,
        Err(why) => return Verdict::undecided(why),
    };
    let entries = system.graph.substitute(&words.entries(), &branch.values);
    let found = words.generic_rank();
    if !words.is_final() && found <= claimed {
        return Verdict::undecided(format!(
            "words of up to {} fields give the rank {found}; the fields leave these states, so that longer words may add \
             to it (to claim a rank for some words, write rank([d(...); ...]))",
            words.order
        ));
    }
    let scope = match words.stop {
        Stop::Full => "",
        _ => ", and longer words do not raise it",
    };
    decide(system, &entries, system.states.len(), claimed, scope, rng)
}

fn decide(
    system: &mut System,
    entries: &[NodeId],
    columns: usize,
    claimed: usize,
    scope: &str,
    rng: &mut impl Rng,
) -> Verdict {
    let angles = system.angles();
    match generic_rank(&mut system.graph, entries, columns, |symbol| angles.contains(&symbol), rng) {
        GenericRank::Rank { rank, log2_error, .. } if rank == claimed => {
            let engine = if log2_error == f64::NEG_INFINITY { MINOR } else { RANDOM_PRIMES };
            Verdict::Proved { engine: format!("{engine}{scope}"), log2_error }
        }
        GenericRank::Rank { rank, .. } => {
            let witness = Witness {
                state: Vec::new(),
                left: rank.to_string(),
                right: claimed.to_string(),
                entry: None,
            };
            Verdict::Refuted { engine: format!("{RANDOM_PRIMES}{scope}"), witness }
        }
        GenericRank::Pole(divisor) => {
            let text = system.graph.text(divisor);
            Verdict::undecided(format!("every state there is a pole: {text} = 0 is divided by"))
        }
        GenericRank::Unknown(why) => Verdict::undecided(why),
    }
}
