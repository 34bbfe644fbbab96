//! The numbers of values at some random points, each modulo a prime of its own.

use super::model::Model;
use super::round::{Course, Round, round};
use super::{Solutions, SolutionsAnswer, SolutionsQuestion, bound, second};
use crate::observability::generic::{Orders, Probe, orders_on_orbits, sum_of_errors};
use palmistry_lang::System;
use palmistry_math::expression::LOG2_ERROR;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cell::Cell;
use std::sync::atomic::Ordering;

/// A verdict that is computed rests on so many rounds at least.
const LEAST_ROUNDS: usize = 2;
/// And one that is proved on no more than these.
const MOST_ROUNDS: usize = 24;
/// Fills the numbers in.
pub(super) fn count(
    system: &System,
    model: &Model,
    question: &SolutionsQuestion,
    answer: &mut SolutionsAnswer,
) -> Result<(), String> {
    // any fixed seed: what is true almost everywhere does not depend on the user's
    let mut rng = ChaCha8Rng::seed_from_u64(0x6669_6272_6573);
    let probe = Probe::new(system, &question.conditions);
    let orders = match model.is_on_a_set() {
        true => {
            // on a set that is not invariant an order that adds nothing need not be the last; what determines all locally may not distinguish all
            // values
            answer.orders_are_open = true;
            let told = orders_on_orbits(system, &question.conditions, &mut rng);
            probe.orders_on_a_set(told.as_deref(), &mut rng)?
        }
        false => probe.orders(&mut rng)?,
    };
    answer.orders = orders.last.clone();
    let course = Course { work: Cell::new(0), way: Cell::new(None) };
    let mut best: Option<Round> = None;
    let mut wanted = LEAST_ROUNDS;
    while answer.rounds < wanted {
        let round = round(model, &orders, question, &course, &mut rng);
        answer.work = course.work.get();
        let is_cut_off = answer.work > question.work || question.interrupt.load(Ordering::Relaxed);
        if round.is_err() && is_cut_off && answer.rounds >= LEAST_ROUNDS {
            // it is computed, and what was to prove it takes too long
            break;
        }
        let round = round?;
        if let Some(way) = course.way.get() {
            answer.orders = orders.and_further(way.further).last;
        }
        answer.rounds += 1;
        match &mut best {
            None => best = Some(round),
            Some(best) if best.values != round.values => {
                return Err(format!(
                    "two random points disagree: one has {} points in its fibre and another one {}",
                    best.points, round.points
                ));
            }
            Some(_) => {}
        }
        if answer.rounds == 1 {
            // further rounds, where they are cheap and make a proof of it
            let Some(best) = &best else { continue };
            let left = question.work.saturating_sub(course.work.get());
            let affordable = 1 + (left / 2 / best.work.max(1)).min(MOST_ROUNDS as u64 - 1) as usize;
            for (place, values) in best.values.iter().enumerate() {
                if let Some(each) = of_a_round(model, &orders, place, *values) {
                    // what is known of the rank may fail as well
                    let needed = ((1.0 - LOG2_ERROR) / -each).ceil() as usize;
                    if needed <= affordable {
                        wanted = wanted.max(needed);
                    }
                }
            }
        }
    }
    let Some(best) = best else { return Ok(()) };
    let is_shown = answer.unknowns.iter().any(|of_it| of_it.at_least.is_some());
    if best.points == 2 && !is_shown && !model.is_on_a_set() && model.angles.is_empty() {
        answer.second = second::second_point(model, &orders, question, &course, &mut rng);
    }
    answer.points = Some(best.points);
    for (place, (of_it, values)) in answer.unknowns.iter_mut().zip(&best.values).enumerate() {
        of_it.solutions = Solutions::Finite(*values);
        if let Some(each) = of_a_round(model, &orders, place, *values) {
            let log2_error = sum_of_errors(answer.rounds as f64 * each, of_it.local_error);
            if log2_error <= LOG2_ERROR {
                of_it.at_most = Some((*values, log2_error));
            }
        }
    }
    Ok(())
}

/// The logarithm of the probability that one round shows so few values where there are more.
fn of_a_round(model: &Model, orders: &Orders, place: usize, values: usize) -> Option<f64> {
    let asked = place.checked_sub(model.unknowns.len()).and_then(|place| model.asked.get(place));
    bound::bounds(model, orders, asked)?.of_a_round(values)
}
