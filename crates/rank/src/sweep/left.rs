//! What inequalities among the conditions of a question leave of its branches.

use super::asked::{RankQuestion, held_conditions};
use super::question::RankError;
use crate::observability::{Branch, Interior, SmoothPart, Unsolved, interior, smooth_part};
use palmistry_lang::System;
use palmistry_math::expression::Guard;

/// The branches, those on which inequalities can hold with equality only as the sets on which they do, and without those on which they hold
/// nowhere, or outputs and rates are defined nowhere.
///
/// # Errors
/// Where nothing remains, or such a set cannot be solved; and where it is not known what remains, if no state is to be drawn.
pub(super) fn left_by_inequalities(
    system: &mut System,
    question: &RankQuestion<'_>,
    branches: Vec<Branch>,
) -> Result<Vec<Branch>, RankError> {
    let (mut open, mut found): (Vec<Branch>, Vec<Branch>) = (branches, Vec::new());
    open.reverse();
    let mut undefined = None;
    while let Some(branch) = open.pop() {
        let held = held_conditions(system, question, &branch);
        if branch.assumed.is_empty() {
            // of a set that is asked for the states that are drawn decide whether anything is defined there
            let is_of_all = question.conditions.is_empty() && question.fixed.is_empty();
            match is_of_all.then(|| smooth_part(system, &branch, &held, &[])).transpose() {
                Ok(Some(SmoothPart::Thin(why))) => undefined = Some(why),
                Ok(_) => found.push(branch),
                Err(why) => return Err(RankError::Condition(why)),
            }
            continue;
        }
        let smooth = system.smooth_guards(&system.moving_fields());
        let guards: Vec<Guard> = branch.guards.iter().chain(&smooth).copied().collect();
        let guards = system.substitute_guards(&guards, &held);
        match interior(system, &branch, &guards).map_err(RankError::Condition)? {
            Interior::Open(_) => found.push(branch),
            Interior::Empty(_) => {}
            Interior::Flat(vanishing) => match branch.meeting(system, &vanishing) {
                Ok(solution) => open.extend(solution.smaller.into_iter().chain(solution.parts)),
                Err(why) if !why.may_be_met() => {}
                Err(why) => return Err(why.into()),
            },
            // states that are drawn decide
            Interior::NotKnown(_) if question.samples > 0 => found.push(branch),
            Interior::NotKnown(words) => {
                let why = format!("no state was found at which all of these hold: {words}");
                return Err(RankError::Condition(why));
            }
        }
    }
    match (found.is_empty(), undefined) {
        (false, _) => Ok(found),
        (true, Some(why)) => Err(RankError::Condition(why)),
        (true, None) => Err(Unsolved::NeverTogether.into()),
    }
}
