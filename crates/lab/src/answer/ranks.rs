//! What is observable and identifiable, and where it is not.

use super::place::Place;
use super::{Refused, Tell};
use palmistry_io::UNINTERRUPTED;
use palmistry_prove::drops::{DropAnswer, where_it_drops_telling};
use palmistry_rank::observability::{SOLUTIONS_WORK, UnobservableField};
use palmistry_rank::sweep::{
    GlobalAnswer, RankQuestion, SolutionsWanted, answer_rank, answer_solutions_telling,
};
use palmistry_report::{
    drops_json, drops_text, formula_mathml_in, global_json, global_text, rank_json, rank_text,
    unobservable_field_text,
};
use serde_json::{Value, json};
use std::sync::Mutex;

/// The seed of sampled states, that of all commands.
const SEED: u64 = 1;

pub(super) fn rank(place: &Place<'_>, samples: u64, tell: Tell<'_>) -> Result<Value, Refused> {
    let mut system = place.system()?;
    let question = RankQuestion {
        samples,
        seed: SEED,
        interrupt: &UNINTERRUPTED,
        progress: &|done| tell(json!({ "kind": "progress", "done": done, "of": samples })),
        ..RankQuestion::default()
    };
    let answer = answer_rank(&mut system, &question).map_err(|why| Refused::new(why.to_string()))?;
    let looks = system.looks.clone();
    let field = |field: &UnobservableField| {
        let components: Vec<Value> = field
            .components
            .iter()
            .map(|part| json!({ "of": part.name, "mathml": [formula_mathml_in(&part.name, &looks), formula_mathml_in(&part.text, &looks)], "text": part.text }))
            .collect();
        json!({ "text": unobservable_field_text(field), "components": components })
    };
    let branch = |branch: &palmistry_rank::sweep::BranchAnswer| {
        let motions = branch.motions.as_ref();
        let functions = motions.map_or(&[][..], |found| &found.functions);
        json!({
            "conditions": branch.conditions,
            "fields": motions.map_or(&[][..], |found| &found.fields).iter().map(field).collect::<Vec<_>>(),
            "for_all_parameters": motions.is_none_or(|found| found.for_all_parameters),
            "fields_missing": motions.map(|found| found.fields_missing),
            "functions": functions.iter().map(|one| json!({ "text": one.text, "mathml": formula_mathml_in(&one.text, &looks) })).collect::<Vec<_>>(),
            "functions_missing": motions.map(|found| found.functions_missing),
        })
    };
    let branches: Vec<Value> = answer.branches.iter().map(branch).collect();
    Ok(json!({ "rank": rank_json(&answer), "unobservable": branches, "text": rank_text(&answer, false) }))
}

pub(super) fn values(place: &Place<'_>, functions: bool, tell: Tell<'_>) -> Result<Value, Refused> {
    let mut system = place.system()?;
    let wanted = if functions { SolutionsWanted::Functions } else { SolutionsWanted::Values };
    let told = |answer: &GlobalAnswer| json!({ "global": global_json(answer), "text": global_text(answer) });
    let tell = Mutex::new(tell);
    let mut so_far = |answer: GlobalAnswer| {
        let mut line = told(&answer);
        line["kind"] = json!("so-far");
        if let Ok(tell) = tell.lock() {
            tell(line);
        }
    };
    let answer = answer_solutions_telling(&mut system, wanted, SOLUTIONS_WORK, &UNINTERRUPTED, &mut so_far);
    answer.map(|answer| told(&answer)).map_err(|why| Refused::new(why.to_string()))
}

pub(super) fn drops(place: &Place<'_>, tell: Tell<'_>) -> Result<Value, Refused> {
    let mut system = place.system()?;
    let told = |answer: &DropAnswer| json!({ "drops": drops_json(answer), "text": drops_text(answer) });
    let mut so_far = |answer: DropAnswer| {
        let mut line = told(&answer);
        line["kind"] = json!("so-far");
        tell(line);
    };
    let answer = where_it_drops_telling(&mut system, SEED, &UNINTERRUPTED, &mut so_far)?;
    Ok(told(&answer))
}
