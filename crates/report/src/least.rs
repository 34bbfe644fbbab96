//! The least model of a system or of a scene, as text and as JSON.

use crate::layout::{counted, item, prose};
use palmistry_io::foreign::shown;
use palmistry_prove::claim::Outcome;
use palmistry_rank::observability::GenericAnswer;
use palmistry_reduce::{LeastModel, LeftOutState, SmallTerms, WhyLeftOut};
use palmistry_scenes::{PlanRank, Scene, ScenePlan};
use serde_json::{Value, json};

/// A least model as text: what it has and what was left out, its generic rank (none of a system whose outputs tie signals, which `rank` decides), and whether
/// its claims are proved.
pub fn least_text(least: &LeastModel, outcomes: &[Outcome], rank: Option<&GenericAnswer>) -> String {
    let mut out = String::new();
    model_lines(least, &mut out);
    match rank {
        Some(rank) => {
            let known = rank.rank().map_or((rank.at_least, rank.at_most), |rank| (rank, rank));
            prose(&rank_in_words(known, rank.dimension), &mut out);
        }
        None => prose("an output is zero: 'palmistry rank' decides the rank", &mut out),
    }
    claim_lines(outcomes, &mut out);
    out
}

/// The same as JSON, with the proof file.
pub fn least_json(least: &LeastModel, outcomes: &[Outcome], rank: Option<&GenericAnswer>) -> Value {
    let mut object = model_json(least, outcomes);
    object["rank"] = rank.map_or(
        Value::Null,
        |rank| json!({ "at_least": rank.at_least, "at_most": rank.at_most, "of": rank.dimension }),
    );
    object
}

fn model_lines(least: &LeastModel, out: &mut String) {
    let of = |[before, after]: [usize; 2], what: &str| match before == after {
        true => counted(after, what),
        false => format!("{} instead of {before}", counted(after, what)),
    };
    let moving = match least.moving {
        [before, after] if before == after => format!("{after} move"),
        [before, after] => format!("{after} move instead of {before}"),
    };
    let (unknowns, operations) = (of(least.unknowns, "unknown"), of(least.operations, "operation"));
    prose(&format!("least model: {unknowns}, of which {moving}; {operations}"), out);
    for LeftOutState { name, why } in &least.left_out {
        item(&format!("{name}: {}", why_in_words(why)), out);
    }
    for own in &least.small_terms {
        let SmallTerms { state, field, terms, bound, median } = own;
        let text = format!(
            "{state}' along {field}: left out {}, together at most {bound}; the median of the rate is {median:.1e}",
            terms.join(", ")
        );
        item(&shown(&text), out);
    }
    for remark in &least.remarks {
        item(remark, out);
    }
}

fn claim_lines(outcomes: &[Outcome], out: &mut String) {
    let proved = outcomes.iter().filter(|outcome| outcome.ok).count();
    let text = format!(
        "{proved} of {} that it is the larger system there are proved",
        counted(outcomes.len(), "claim")
    );
    prose(&text, out);
    for outcome in outcomes.iter().filter(|outcome| !outcome.ok) {
        item(&format!("{} {}: {}", outcome.word(), outcome.id, shown(&outcome.statement)), out);
    }
}

fn rank_in_words((at_least, at_most): (usize, usize), of: usize) -> String {
    match at_least == at_most {
        true if of == 0 => "nothing is unknown".to_owned(),
        true if at_least == of => format!("generic rank {of} of {of}: locally observable"),
        true => {
            format!("generic rank {at_least} of {of}: {} unobservable", counted(of - at_least, "direction"))
        }
        false => format!("generic rank not decided: between {at_least} and {at_most} of {of}"),
    }
}

fn why_in_words(why: &WhyLeftOut) -> String {
    match why {
        WhyLeftOut::Fixed(value) => format!("fixed, {value}"),
        WhyLeftOut::KnownConstant => "a known constant, a parameter now".to_owned(),
        WhyLeftOut::MeasuredConstant => "constant and measured, a parameter now".to_owned(),
        WhyLeftOut::NoOutputDependsOnIt => "no output depends on it: unobservable".to_owned(),
        WhyLeftOut::NotNeeded => "no output depends on it; its initial condition is known".to_owned(),
        WhyLeftOut::InSmallTermsAlone => "outputs depend on it by small terms alone".to_owned(),
        WhyLeftOut::Conserved { law, total } => format!("{law} is conserved: the unknown constant {total}"),
    }
}

fn model_json(least: &LeastModel, outcomes: &[Outcome]) -> Value {
    let left_out = least.left_out.iter().map(|one| {
        let word = match &one.why {
            WhyLeftOut::Fixed(_) => "fixed",
            WhyLeftOut::KnownConstant => "known_constant",
            WhyLeftOut::MeasuredConstant => "measured_constant",
            WhyLeftOut::NoOutputDependsOnIt => "no_output_depends_on_it",
            WhyLeftOut::NotNeeded => "not_needed",
            WhyLeftOut::InSmallTermsAlone => "in_small_terms_alone",
            WhyLeftOut::Conserved { .. } => "conserved",
        };
        json!({ "name": one.name, "why": word, "in_words": why_in_words(&one.why) })
    });
    let small = |own: &SmallTerms| json!({ "state": own.state, "field": own.field, "terms": own.terms, "at_most": own.bound, "median_of_rate": own.median });
    let claim = |outcome: &Outcome| json!({ "id": outcome.id, "statement": outcome.statement, "verdict": outcome.word() });
    let pair = |[before, after]: [usize; 2]| json!({ "before": before, "after": after });
    json!({
        "proof": least.text,
        "conditions": least.conditions,
        "left_out": left_out.collect::<Vec<_>>(),
        "small_terms": least.small_terms.iter().map(small).collect::<Vec<_>>(),
        "unknowns": pair(least.unknowns),
        "moving": pair(least.moving),
        "operations": pair(least.operations),
        "remarks": least.remarks,
        "claims": outcomes.iter().map(claim).collect::<Vec<_>>(),
    })
}

/// What a scene requires, as text; `outcomes` are the claims of its least model's file.
pub fn plan_text(scene: &Scene, plan: &ScenePlan, outcomes: &[Outcome]) -> String {
    let mut out = String::new();
    prose(&shown(&scene.title), &mut out);
    let (states, estimated) = (counted(plan.states.len(), "state"), plan.estimated.join(", "));
    prose(&format!("the model's file has {states}; estimated: {estimated}"), &mut out);
    if !scene.observer.modes.is_empty() {
        prose("the scene has several modes: this is the plan of its first model", &mut out);
    }
    if !plan.followed.is_empty() {
        prose(&format!("followed beside it: {}", plan.followed.join(", ")), &mut out);
    }
    prose(&format!("compared with measurements: {}", plan.compared.join(", ")), &mut out);
    if !plan.driving.is_empty() {
        prose(&format!("taken from measurements as they change: {}", plan.driving.join(", ")), &mut out);
    }
    if !plan.constants.is_empty() {
        let constant = |own: &palmistry_scenes::PlanConstant| {
            format!("{} = {}{}", own.name, own.value, if own.is_measured { " (measured)" } else { "" })
        };
        let all: Vec<String> = plan.constants.iter().map(constant).collect();
        prose(&format!("constant: {}", all.join(", ")), &mut out);
    }
    for own in &plan.steady_for_a_while {
        let text = format!(
            "{} is {} from {} s to {} s, and not all along: observed by itself, that part has a smaller model",
            own.name, own.value, own.from, own.to
        );
        prose(&text, &mut out);
    }
    out.push('\n');
    match &plan.least {
        Ok(least) => {
            model_lines(least, &mut out);
            claim_lines(outcomes, &mut out);
        }
        Err(why) => prose(&format!("no proof file of the least model: {}", shown(why)), &mut out),
    }
    let [general, own] = plan.operations;
    let mut text = format!(
        "right-hand side: {} with every column a signal, {own} with constants put in",
        counted(general, "operation")
    );
    if plan.nanoseconds.iter().all(|time| time.is_finite()) {
        let [general, own] = plan.nanoseconds;
        text += &format!(" ({general:.0} and {own:.0} ns)");
    }
    prose(&text, &mut out);
    out.push('\n');
    rank_lines(plan, &mut out);
    out
}

fn rank_lines(plan: &ScenePlan, out: &mut String) {
    if let Some(PlanRank { at_least, at_most, of, unobservable, cures }) = &plan.generic {
        prose(&rank_in_words((*at_least, *at_most), *of), out);
        if !unobservable.is_empty() {
            prose(&format!("estimated and unobservable: {}", unobservable.join(", ")), out);
            match cures.is_empty() {
                true => prose("no single one of them, measured as well, is shown to cure that", out),
                false => {
                    let text = format!(
                        "with {} measured as well, or known, all else that is estimated is observable",
                        cures.join(" or ")
                    );
                    prose(&text, out);
                }
            }
        }
    }
    let along = &plan.along;
    let from = if plan.along_truth { "true values" } else { "first guess" };
    if along.decided == 0 {
        let why =
            along.lost.as_deref().unwrap_or("its equations are singular at every sample that was asked");
        prose(&format!("the rank along the motion from the {from} is not known: {why}"), out);
        return;
    }
    let mut text = format!(
        "rank along the motion from the {from}: {} of {} at {} of {}",
        along.rank,
        along.of,
        along.decided,
        counted(along.asked, "sample")
    );
    text += &match along.order {
        0 => ", by the outputs alone".to_owned(),
        order => format!(", by the outputs and {} of each", counted(order, "derivative")),
    };
    match along.rank == along.of {
        true => text += &format!("; worst condition {:.1e}, at {:.3} s", along.condition, along.at),
        // whether higher derivatives raise the rank is not asked
        false => text += &format!("; least at {:.3} s, and more derivatives may show more", along.at),
    }
    prose(&text, out);
    if let Some(pole) = &along.pole {
        prose(
            &format!("the motion meets a singularity at {:.3} s, where {} is zero", pole.time, pole.divisor),
            out,
        );
    }
    if let Some(lost) = &along.lost {
        prose(&format!("the motion could not be followed to the end: {lost}"), out);
    }
}

/// The same as JSON.
pub fn plan_json(scene: &Scene, plan: &ScenePlan, outcomes: &[Outcome]) -> Value {
    let least = match &plan.least {
        Ok(least) => model_json(least, outcomes),
        Err(why) => json!({ "none": why }),
    };
    let finite = |value: f64| value.is_finite().then_some(value);
    let constants = plan
        .constants
        .iter()
        .map(|own| json!({ "name": own.name, "value": own.value, "measured": own.is_measured }));
    let steady = plan
        .steady_for_a_while
        .iter()
        .map(|own| json!({ "name": own.name, "value": own.value, "from": own.from, "to": own.to }));
    let rank = plan.generic.as_ref().map(|rank| {
        json!({
            "at_least": rank.at_least, "at_most": rank.at_most, "of": rank.of,
            "unobservable": rank.unobservable, "known_would_do": rank.cures,
        })
    });
    let along = &plan.along;
    json!({
        "title": scene.title,
        "of_several_modes": !scene.observer.modes.is_empty(),
        "states": plan.states,
        "estimated": plan.estimated,
        "followed": plan.followed,
        "compared": plan.compared,
        "driving": plan.driving,
        "constants": constants.collect::<Vec<_>>(),
        "steady_for_a_while": steady.collect::<Vec<_>>(),
        "operations": { "with_all_columns": plan.operations[0], "with_constants": plan.operations[1] },
        "nanoseconds": { "with_all_columns": finite(plan.nanoseconds[0]), "with_constants": finite(plan.nanoseconds[1]) },
        "least_model": least,
        "rank": rank,
        "rank_along_motion": {
            "from": if plan.along_truth { "truth" } else { "guess" },
            "rank": along.rank, "of": along.of, "asked": along.asked, "decided": along.decided,
            "derivatives": along.order, "condition": finite(along.condition), "at": along.at,
            "singularity": along.pole.as_ref().map(|pole| json!({ "divisor": pole.divisor, "time": pole.time })),
            "lost": along.lost,
        },
    })
}
