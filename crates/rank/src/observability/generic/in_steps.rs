//! The answer in discrete time: random sequences of states, until the bound is met.

use super::probe::{ATTEMPTS, observable_in};
use super::steps::Steps;
use super::{GenericAnswer, Observability, conclude, nothing_known};
use crate::observability::saturation::Ceiling;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::NodeId;
use palmistry_math::number::PrimeField;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// What is observable at almost all states of a system in discrete time, and whether each of some functions is.
pub(super) fn answer_in_steps(
    system: &System,
    conditions: &Assignment,
    ceiling: Ceiling,
    asked: &[NodeId],
) -> (GenericAnswer, Vec<Observability>) {
    let nothing_known = |why| (nothing_known(system, why), vec![Observability::Undecided; asked.len()]);
    let (mut answer, _) = nothing_known(String::new());
    let steps = match Steps::new(system, conditions, ceiling == Ceiling::Rests, asked) {
        Ok(steps) => steps,
        Err(why) => return nothing_known(why),
    };
    // any fixed seed: what is true almost everywhere does not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x0073_7465_7073);
    let bounds = steps.rounds();
    let mut best: Option<(usize, Vec<bool>)> = None;
    let mut refused = String::new();
    for _ in 0..bounds.as_ref().map_or(1, |bounds| bounds.rounds) + ATTEMPTS {
        let field = PrimeField::random(&mut rng);
        let (echelon, rows, order) = match steps.follow(field, &mut rng) {
            Ok(found) => found,
            Err(refusal) => {
                refused = refusal.to_string();
                continue;
            }
        };
        answer.rounds += 1;
        answer.order = answer.order.max(order);
        let (rank, seen) = (echelon.rank(), observable_in(&echelon, &rows));
        best = Some(match best.take() {
            Some(known) if known.0 > rank => known,
            // observable is what is so at all points of this rank
            Some(known) if known.0 == rank => {
                (rank, known.1.iter().zip(&seen).map(|(known, here)| *known && *here).collect())
            }
            _ => (rank, seen),
        });
        let is_full = rank == answer.dimension;
        if is_full || answer.rounds == bounds.as_ref().map_or(1, |bounds| bounds.rounds) {
            break;
        }
    }
    let Some(best) = best else {
        return nothing_known(format!("{ATTEMPTS} random sequences met singularities: {refused}"));
    };
    if bounds.as_ref().is_ok_and(|bounds| answer.rounds < bounds.rounds) && best.0 < answer.dimension {
        return nothing_known(format!("too many of the random sequences met singularities: {refused}"));
    }
    answer.open = None;
    let closed = system.closed_coordinates();
    if bounds.is_ok() {
        answer.closed_at_most = best.0;
        if closed.len() > answer.dimension {
            // a state with a known initial condition counts as unknown
            let mut all = system.clone();
            all.known.retain(|symbol| !closed.contains(symbol));
            answer.closed_at_most = match answer_in_steps(&all, conditions, ceiling, &[]).0 {
                found if found.open.is_none() || ceiling != Ceiling::Rests => found.at_least,
                _ => closed.len(),
            };
        }
    }
    let seen = conclude(&mut answer, &[best], &bounds, true, ceiling);
    (answer, seen)
}
