//! Claims about ranks: of a matrix, or of the observability codistribution, at almost all states of a set.

use super::existence::{Existence, existence};
use super::identity::{OnOneBranch, RANDOM_PRIMES};
use super::rank_witness::{Ranks, rank_witness};
use super::terms::{OnBranch, Terms};
use super::verdict::{Verdict, Witness};
use crate::expression::NodeId;
use crate::observability::{Branch, Codistribution, GenericRank, Length, Stop, generic_rank};
use crate::system::System;
use rand::Rng;

/// A nonzero minor, the certain half of a statement about a rank.
const MINOR: &str = "a minor that is not zero modulo a prime";

/// Decides `rank(M) = claimed` on a branch; the entries are the sides of the terms.
pub(crate) fn decide_rank(
    system: &mut System,
    on: &OnBranch,
    columns: usize,
    claimed: usize,
    rng: &mut impl Rng,
) -> OnOneBranch {
    let entries = on.terms.sides.clone();
    let exists = existence(system, on, rng);
    let rows = Rows { entries: &entries, columns, scope: "", on };
    on_one_branch(system, exists, &rows, claimed, rng)
}

/// Decides `rank = claimed` for the codistribution, on the states of a branch.
///
/// # Errors
/// In words: there is no codistribution, or it tells apart what the conditions leave open.
pub(crate) fn decide_codistribution(
    system: &mut System,
    on: &OnBranch,
    branch: &Branch,
    claimed: usize,
    rng: &mut impl Rng,
) -> Result<OnOneBranch, String> {
    if system.outputs.is_empty() || system.unknown_count() == 0 {
        return Err("there is no codistribution: the file declares no states or no outputs".to_owned());
    }
    branch.check_codistribution(system)?;
    let exists = existence(system, on, rng);
    if let Existence::Nowhere(guard) = exists {
        return Ok(OnOneBranch::Empty(guard));
    }
    let words = Codistribution::new(system, &branch.values, Length::UntilItStops)?;
    let entries = system.graph.substitute(&words.entries(), &branch.values);
    let found = words.generic_rank();
    if !words.is_final() && found <= claimed && found < system.unknown_count() {
        return Err(format!(
            "words of up to {} fields give the rank {found}; the fields leave these states, so that longer words may add \
             to it (to claim a rank for some words, write rank([d(...); ...]))",
            words.order
        ));
    }
    let scope = match words.stop {
        Stop::Full => "",
        _ => ", and longer words do not raise it",
    };
    let columns = system.unknown_count();
    // the rows that give the rank at almost all states: no other row adds to it anywhere
    let terms = Terms { sides: words.needed_entries(), guards: on.terms.guards.clone(), ..Terms::default() };
    let needed = OnBranch::new(system, branch, &terms)?;
    let rows = Rows { entries: &entries, columns, scope, on: &needed };
    Ok(on_one_branch(system, exists, &rows, claimed, rng))
}

/// Rows of expressions, one after the other.
struct Rows<'a> {
    entries: &'a [NodeId],
    columns: usize,
    /// What is said of them beside their rank.
    scope: &'a str,
    /// Those of them that give the rank, as terms that a state can be put into.
    on: &'a OnBranch,
}

fn on_one_branch(
    system: &mut System,
    exists: Existence,
    rows: &Rows<'_>,
    claimed: usize,
    rng: &mut impl Rng,
) -> OnOneBranch {
    match exists {
        Existence::Nowhere(guard) => OnOneBranch::Empty(guard),
        Existence::NotShown(guard) => {
            let why = format!("no state was found at which all of it exists; it needs {guard}");
            OnOneBranch::Verdict(Verdict::undecided(why), Existence::NotShown(guard))
        }
        Existence::Shown => OnOneBranch::Verdict(decide(system, rows, claimed, rng), exists),
    }
}

fn decide(system: &mut System, rows: &Rows<'_>, claimed: usize, rng: &mut impl Rng) -> Verdict {
    let is_angle = &system.angle_test();
    match generic_rank(&mut system.graph, rows.entries, rows.columns, is_angle, rng) {
        GenericRank::Rank { rank, log2_error, .. } if rank == claimed => {
            let engine = if log2_error == f64::NEG_INFINITY { MINOR } else { RANDOM_PRIMES };
            Verdict::Proved { engine: format!("{engine}{}", rows.scope), log2_error }
        }
        GenericRank::Rank { rank, .. } => {
            let ranks = Ranks { generic: rank, claimed };
            let witness =
                rank_witness(system, rows.on, rows.columns, ranks, rng).unwrap_or_else(|| Witness {
                    state: Vec::new(),
                    left: rank.to_string(),
                    right: claimed.to_string(),
                    entry: None,
                    refutation: None,
                });
            Verdict::Refuted { engine: format!("{RANDOM_PRIMES}{}", rows.scope), witness }
        }
        GenericRank::Pole(divisor) => {
            let text = system.graph.text(divisor);
            Verdict::undecided(format!("every state there is a pole: {text} = 0 is divided by"))
        }
        GenericRank::Unknown(why) => Verdict::undecided(why),
    }
}
