//! What observers make of a stream: a line of JSON or some lines of text a window, and the end.

use crate::layout::{counted, in_columns};
use crate::motion::answers::{
    Beside, Observed, end_name, fault_lines, origin, origin_in_words, state_lines, states, update_json,
};
use crate::motion::fit::{fit_in_words, suspects_in_words};
use crate::motion::next::{next_line_of_tests, next_lines};
use crate::motion::verdicts::{innovations_in_words, innovations_json, together_in_words, together_json};
use palmistry_scenes::{StreamAnswer, StreamEnd, WindowReport};
use serde_json::{Value, json};
use std::fmt::Write;

/// A window as an object.
pub fn stream_json(report: &WindowReport<'_>) -> Value {
    let observed = Observed::of(report.experiment, &[]);
    let answer = |answer: &StreamAnswer| {
        let end = answer.end.as_ref().map(|last| {
            let bounds = Some(&last.deviations[..]);
            json!({ "time": last.time, "states": states(&observed, last.time, &last.state, bounds) })
        });
        json!({
            "method": answer.method.name(),
            "updates": answer.updates.iter().map(|update| update_json(&observed, update)).collect::<Vec<_>>(),
            "fits_as_well": answer.others.iter().map(|other| update_json(&observed, other)).collect::<Vec<_>>(),
            "end": end,
            "unobserved_samples": answer.unobserved,
            "remarks": answer.remarks,
        })
    };
    let mut found = json!({
        "window": report.window,
        "samples": report.samples,
        "rows": report.rows,
        "faults": fault_lines(&report.faults),
        "observers": report.answers.iter().map(answer).collect::<Vec<_>>(),
    });
    if let Some(origin) = origin(report.experiment) {
        found["time_origin"] = origin;
    }
    found
}

/// The end of a stream as an object.
pub fn stream_end_json(end: &StreamEnd, interrupted: bool) -> Value {
    let observer = |tally: &palmistry_scenes::StreamTally| {
        json!({
            "method": tally.method.name(),
            "updates": tally.updates,
            "fit": tally.fit,
            "untested": tally.untested,
            "do_not_fit": tally.contradicted,
            "steps_spent": tally.spent,
            "together": together_json(tally.tested.together()),
            "innovations": innovations_json(tally.innovations),
        })
    };
    let mut found = json!({
        "ended": end.cut_off.as_deref().unwrap_or("whole"),
        "windows": end.windows,
        "rows": end.rows,
        "faulty_rows": end.faults,
        "observers": end.observers.iter().map(observer).collect::<Vec<_>>(),
        "interrupted": interrupted,
    });
    if let Some(fault) = &end.fault {
        found["ended"] = json!("a faulty row");
        found["error"] = json!({ "message": fault });
    }
    found
}

/// A window as text.
pub fn stream_text(report: &WindowReport<'_>, is_timed: bool) -> String {
    let observed = Observed::of(report.experiment, &[]);
    let names = report.experiment.names();
    let mut text = String::new();
    if report.window == 1 {
        let _ = writeln!(text, "{}", report.experiment.scene.title);
        text.push_str(&origin_in_words(report.experiment));
    }
    for line in fault_lines(&report.faults) {
        let _ = writeln!(text, "  {line}");
    }
    for answer in &report.answers {
        let _ = writeln!(text, "{}, window {}", answer.method.name(), report.window);
        for (update, is_other) in
            answer.updates.iter().map(|u| (u, false)).chain(answer.others.iter().map(|u| (u, true)))
        {
            let time = if is_timed { format!(", {:.1} ms", 1e3 * update.seconds) } else { String::new() };
            let standing = match is_other {
                true => "another state fits as well".to_owned(),
                false => format!(
                    "{} after {}{}{time}",
                    end_name(&update.end).trim_end_matches(", but does not fit"),
                    counted(update.steps, "step"),
                    fit_in_words(update)
                ),
            };
            let _ = writeln!(text, "  from {:.6} s: {standing}", update.from);
            state_lines(&mut text, &observed, &names, update.from, &update.estimate, Beside::of(update));
            for line in suspects_in_words(update) {
                let _ = writeln!(text, "    {line}");
            }
        }
        if let Some(last) = &answer.end {
            let _ = writeln!(text, "  at {:.6} s:", last.time);
            let known = Beside { bounds: &last.deviations, at_bounds: &[], worth: "" };
            state_lines(&mut text, &observed, &names, last.time, &last.state, known);
        }
        for remark in &answer.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        for line in next_lines(&answer.updates, &answer.others) {
            let _ = writeln!(text, "  {line}");
        }
    }
    in_columns(&text)
}

/// The end of a stream as text.
pub fn stream_end_text(end: &StreamEnd) -> String {
    let mut text = format!(
        "{} of {}; faulty rows: {}",
        counted(end.windows, "window"),
        counted(end.rows, "row"),
        end.faults
    );
    for tally in end.observers.iter().filter(|tally| tally.updates > 0) {
        let _ = write!(text, "; {}: {} of {} updates pass", tally.method.name(), tally.fit, tally.updates);
        if tally.untested > 0 {
            let _ = write!(text, ", {} with too little measured to test the residuals", tally.untested);
        }
        if tally.spent > 0 {
            let _ = write!(text, ", {} ended with all steps spent", tally.spent);
        }
    }
    for tally in &end.observers {
        if let Some(all) = tally.tested.together().filter(|all| !all.fits) {
            let _ = write!(text, "\n{}: {}", tally.method.name(), together_in_words(&all));
        }
        if let Some(own) = &tally.innovations {
            let _ = write!(text, "\n{}: {}", tally.method.name(), innovations_in_words(own));
        }
        let windows_fail = tally.contradicted == 0 && tally.tested.together().is_some_and(|all| !all.fits);
        let innovations_fail = tally.innovations.as_ref().is_some_and(|own| !own.fits);
        for line in next_line_of_tests(windows_fail, innovations_fail) {
            let _ = write!(text, "\n{}: {line}", tally.method.name());
        }
    }
    if let Some(why) = &end.cut_off {
        let _ = write!(text, "\ncut off: {why}; what was answered until then stands");
    }
    if end.fault.is_some() {
        text.push_str("\nended by a faulty row; what was answered until then stands");
    }
    in_columns(&text)
}
