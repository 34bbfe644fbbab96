//! What was found of many bodies, by family and margin.

use palmistry_bodies::pose_surface::{ConjectureFinding, ConjectureQuestion, MarginFinding};
use serde_json::{Value, json};
use std::fmt::Write;

/// Findings of one family, which stand together.
fn families(findings: &[ConjectureFinding]) -> impl Iterator<Item = &[ConjectureFinding]> {
    findings.chunk_by(|a, b| a.family == b.family)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Counts of one family at one margin.
struct Counts {
    reach: usize,
    not: usize,
    unsettled: usize,
    one: usize,
    spiral: usize,
    quiet: usize,
}

fn counts(family: &[ConjectureFinding], place: usize) -> Counts {
    let count =
        |test: &dyn Fn(&MarginFinding) -> bool| family.iter().filter(|one| test(&one.margins[place])).count();
    Counts {
        reach: count(&|one| one.reaches_all == Some(true)),
        not: count(&|one| one.reaches_all == Some(false)),
        unsettled: count(&|one| one.reaches_all.is_none()),
        one: count(&|one| one.components == 1),
        spiral: count(&|one| one.is_spiral),
        quiet: count(&|one| one.jumps.iter().all(|jumps| *jumps == 0)),
    }
}

/// As text.
pub fn conjecture_text(findings: &[ConjectureFinding], question: &ConjectureQuestion<'_>) -> String {
    let mut out = String::from(
        "evidence, and no proof: does some component of the surface of stable poses lead to all orientations?\n",
    );
    for family in families(findings) {
        let Some(first) = family.first() else { continue };
        let met = family.iter().filter(|one| one.closing_folds > 0).count();
        let _ = writeln!(
            out,
            "\n{}: {} bodies; the boundaries meet (3.47) on {met}\n  margin   all reached   not   unsettled   one component   spiral   3.14 without jumps",
            first.family.name(),
            family.len()
        );
        for (place, margin) in question.margins.iter().enumerate() {
            let found = counts(family, place);
            let _ = writeln!(
                out,
                "  {margin:<8} {:>11} {:>5} {:>11} {:>15} {:>8} {:>20}",
                found.reach, found.not, found.unsettled, found.one, found.spiral, found.quiet
            );
        }
        out.push_str(&plans_text(family));
    }
    out.trim_end().to_owned()
}

fn plans_text(family: &[ConjectureFinding]) -> String {
    let plans: Vec<_> = family.iter().filter_map(|one| one.plan.as_ref()).collect();
    if plans.is_empty() {
        return String::new();
    }
    let (lengths, reading): (Vec<f64>, Vec<f64>) =
        plans.iter().filter_map(|plan| Some((*plan.length.as_ref().ok()?, plan.measurement?))).unzip();
    let done = lengths.len();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let mut out = format!("  plans that touch all normals: {done} of {}", plans.len());
    if let (Some(length), Some(reading)) = (median(lengths), median(reading)) {
        let _ = write!(
            out,
            ", length median {length:.2}, longest {longest:.2} rad; farthest contact, median {reading:.1} mean radii"
        );
    }
    for (rounds, word) in ["one round", "two rounds"].into_iter().enumerate() {
        let all = plans.iter().filter(|plan| plan.rounds[rounds].0 >= 1.0 - 1e-9).count();
        let quiet = plans
            .iter()
            .filter(|plan| plan.rounds[rounds].0 >= 1.0 - 1e-9 && plan.rounds[rounds].1 == 0)
            .count();
        let _ = write!(out, "\n  {word} of plan 3.14 touch all of {all}, of {quiet} without a jump");
    }
    let reading = median(plans.iter().map(|plan| plan.round_measurement).collect()).unwrap_or_default();
    let _ = writeln!(out, "; farthest contact, median {reading:.1} mean radii");
    for one in family {
        if let Some(Err(why)) = one.plan.as_ref().map(|plan| &plan.length) {
            let _ = writeln!(out, "    no plan for number {}: {why}", one.number);
        }
    }
    out
}

/// As one object.
pub fn conjecture_json(findings: &[ConjectureFinding], question: &ConjectureQuestion<'_>) -> Value {
    let family = |family: &[ConjectureFinding]| {
        let margins: Vec<Value> = question
            .margins
            .iter()
            .enumerate()
            .map(|(place, margin)| {
                let found = counts(family, place);
                json!({
                    "margin": margin, "all": found.reach, "not": found.not, "unsettled": found.unsettled,
                    "one_component": found.one, "spiral": found.spiral, "without_jumps": found.quiet,
                })
            })
            .collect();
        // the bodies that are not as the conjecture has them
        let exceptions: Vec<Value> = family
            .iter()
            .filter(|one| one.margins.iter().any(|at| at.reaches_all != Some(true)))
            .map(|one| {
                let at = |at: &MarginFinding| json!({ "reaches_all": at.reaches_all, "reach": at.reach, "components": at.components });
                json!({
                    "number": one.number, "body": one.body, "centre": one.centre, "level": one.level,
                    "margins": one.margins.iter().map(at).collect::<Vec<_>>(),
                })
            })
            .collect();
        let plans: Vec<Value> = family
            .iter()
            .filter_map(|one| Some((one.number, one.plan.as_ref()?)))
            .map(|(number, plan)| {
                json!({
                    "number": number, "length": plan.length.as_ref().ok(), "why": plan.length.as_ref().err().map(ToString::to_string),
                    "measurement": plan.measurement, "rounded_measurement": plan.round_measurement,
                    "coverage": plan.rounds.map(|round| round.0), "jumps": plan.rounds.map(|round| round.1),
                })
            })
            .collect();
        json!({
            "family": family[0].family.name(), "bodies": family.len(),
            "closing_folds": family.iter().filter(|one| one.closing_folds > 0).count(),
            "margins": margins, "exceptions": exceptions, "plans": plans,
        })
    };
    json!({ "seed": question.seed, "families": families(findings).map(family).collect::<Vec<_>>() })
}
