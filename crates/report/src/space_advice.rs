//! What runs of a body in space are advised, as text with lines to paste into scenes, and as JSON.

use crate::layout::counted;
use palmistry_scenes::space::{Laying, PlannedRun, RunsAdvice, SpaceScene};
use serde_json::{Value, json};
use std::fmt::Write;

/// The lines of `[body]` that say how it is laid; what else is under `[body]` stays.
fn laid(laying: &Laying) -> String {
    format!("orientation = {:?}\nbalanced = true\nrate = {:?}", laying.orientation, laying.rate)
}

/// What is advised, as text.
pub fn runs_advice_text(scene: &SpaceScene, advice: &RunsAdvice) -> String {
    let mut out = scene.title.clone();
    let _ = writeln!(
        out,
        "\n{} tried; the body is held to the end in {}",
        counted(advice.tried, "run"),
        advice.held
    );
    if advice.plan.is_empty() {
        out += "no run was found that holds the body to the end";
        return out;
    }
    let _ = writeln!(
        out,
        "the body has {:.4} m^3; the hull of all contacts so far, and what half-spaces leave:",
        advice.volume
    );
    let _ = writeln!(
        out,
        "{:>5}{:>12}{:>8}{:>14}   {} of random runs: median, most",
        "runs",
        "hull, m^3",
        "part",
        "outside, m^3",
        counted(advice.random_rows, "row")
    );
    for (place, PlannedRun { hull, outer, random, .. }) in advice.plan.iter().enumerate() {
        let part = 100.0 * hull.low() / advice.volume;
        let outer = outer.as_ref().map_or_else(Clone::clone, |outer| format!("{:.4}", outer.high()));
        let random = random.map_or("-".to_owned(), |[median, most]| format!("{median:.4}, {most:.4}"));
        let _ = writeln!(out, "{:>5}{:>12.4}{part:>6.1} %{outer:>14}   {random}", place + 1, hull.low());
    }
    for (place, run) in advice.plan.iter().enumerate() {
        let _ = write!(
            out,
            "\n[body]  # run {}: these lines in the place of how it lies\n{}\n",
            place + 1,
            laid(&run.laying)
        );
    }
    out.trim_end().to_owned()
}

/// What is advised, as JSON.
pub fn runs_advice_json(scene: &SpaceScene, advice: &RunsAdvice, interrupted: bool) -> Value {
    let run = |run: &PlannedRun| {
        json!({
            "orientation": run.laying.orientation,
            "rate": run.laying.rate,
            "hull": run.hull.low(),
            "outer": run.outer.as_ref().ok().map(|outer| outer.high()),
            "why": run.outer.as_ref().err(),
            "random": run.random.map(|[median, most]| json!({ "median": median, "most": most })),
        })
    };
    json!({
        "scene": scene.title,
        "tried": advice.tried,
        "held": advice.held,
        "random_rows": advice.random_rows,
        "volume": advice.volume,
        "runs": advice.plan.iter().map(run).collect::<Vec<Value>>(),
        "interrupted": interrupted,
    })
}
