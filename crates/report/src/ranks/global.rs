//! How many values of each unknown give the same outputs, as JSON and as text.

use super::generic::unknown_verdict;
use crate::claims::outcomes::error_bound;
use crate::layout::{COLUMNS, Layout, counted, in_columns, item, prose};
use crate::names::{plain_number, values_json, values_text};
use palmistry_io::foreign::shown;
use palmistry_lang::UnknownKind;
use palmistry_rank::observability::{
    IdentifiableFunction, IdentifiableFunctions, Observability, SecondPoint, Solutions, SolutionsOf,
};
use palmistry_rank::sweep::GlobalAnswer;
use serde_json::{Value, json};
use std::fmt::Write;

/// What stands behind a number of values.
fn verdict(of_it: &SolutionsOf) -> &'static str {
    match &of_it.solutions {
        Solutions::Undecided(_) => "undecided",
        _ if of_it.is_proved() => "proved",
        _ => "computed",
    }
}

fn unknown_json(of_it: &SolutionsOf) -> Value {
    let values = match &of_it.solutions {
        Solutions::Finite(count) => json!(count),
        Solutions::Infinite => json!("infinity"),
        Solutions::Undecided(_) => Value::Null,
    };
    let why = match &of_it.solutions {
        Solutions::Undecided(why) => json!(why),
        _ => Value::Null,
    };
    json!({
        "name": of_it.name,
        "kind": of_it.kind.map(UnknownKind::name),
        "local": unknown_verdict(of_it.kind.unwrap_or(UnknownKind::State), of_it.local),
        "values": values,
        "verdict": verdict(of_it),
        "at_least": of_it.at_least.as_ref().map(|(least, _)| least),
        "symmetry": of_it.at_least.as_ref().map(|(_, map)| map),
        "at_most": of_it.at_most.map(|(most, _)| most),
        "error_bound": of_it.at_most.map(|(_, log2_error)| error_bound(log2_error)),
        "why": why,
    })
}

fn second_json(second: &SecondPoint) -> Value {
    let each = second
        .values
        .iter()
        .map(|(name, one, other)| (name.clone(), json!([plain_number(one), plain_number(other)])));
    json!({
        "values": each.collect::<serde_json::Map<_, _>>(),
        "equal_derivatives": second.order,
    })
}

/// An answer as one object.
pub fn global_json(answer: &GlobalAnswer) -> Value {
    let found = &answer.solutions;
    json!({
        "file": answer.file,
        "title": answer.title,
        "conditions": answer.conditions,
        "fixed_at_the_files_values": values_json(&answer.held),
        "known": answer.known,
        "final": answer.is_final(),
        "interrupted": answer.interrupted,
        "points": found.rounds,
        "derivatives": found.orders,
        "derivatives_are_open": found.orders_are_open,
        "size_of_a_fibre": found.points,
        "products": found.work,
        "unknowns": found.unknowns.iter().map(unknown_json).collect::<Vec<_>>(),
        "second_point": found.second.as_ref().map(second_json),
        "identifiable_functions": answer.functions.as_ref().map(functions_json),
        "seconds": answer.seconds,
    })
}

fn functions_json(found: &IdentifiableFunctions) -> Value {
    let function = |of_it: &IdentifiableFunction| {
        json!({
            "function": of_it.text,
            "is_unknown": of_it.is_unknown,
            "verdict": if of_it.log2_error.is_some() { "proved" } else { "computed" },
            "error_bound": of_it.log2_error.map(error_bound),
        })
    };
    json!({
        "functions": found.functions.iter().map(function).collect::<Vec<_>>(),
        "generate_all": found.generate_all(),
        "missing": found.missing,
        "solutions_in_common": found.common.map(|[common, _]| common),
        "why": found.open,
    })
}

/// Longer functions do not widen the column of functions.
const WIDEST: usize = 40;

/// Generators of the identifiable functions, and whether every other one is a rational function of them.
fn functions_text(found: &IdentifiableFunctions) -> String {
    let mut out = String::new();
    if found.functions.is_empty() && found.generate_all() {
        out.push_str("identifiable functions: none but constants (computed)\n");
    }
    if !found.functions.is_empty() {
        let all = if found.generate_all() {
            ", of which every other one is a rational function (computed)"
        } else {
            ""
        };
        let _ = writeln!(out, "identifiable functions: one value for given outputs{all}");
    }
    // a column for the longest of those that fit
    let lengths = found.functions.iter().map(|of_it| of_it.text.chars().count());
    let width = lengths.filter(|length| *length <= WIDEST).max().unwrap_or(0);
    for of_it in &found.functions {
        let how = match of_it.log2_error {
            Some(f64::NEG_INFINITY) => "proved, certain".to_owned(),
            Some(log2_error) => format!("proved, error probability below {}", error_bound(log2_error)),
            None => "computed".to_owned(),
        };
        let _ = writeln!(out, "  {:<width$}  {how}", of_it.text);
    }
    if found.missing > 0 {
        let more = counted(found.missing, "further independent function");
        let is = if found.missing == 1 { "is" } else { "are" };
        let _ = writeln!(out, "{more} {is} identifiable at least locally, and {is} not found");
    } else if let Some([common, outputs]) = found.common.filter(|[common, outputs]| common > outputs) {
        let _ = writeln!(
            out,
            "these functions have {common} solutions in common where the outputs have {outputs}: others, which are not found, tell more apart"
        );
    }
    if let Some(why) = &found.open {
        let _ = writeln!(out, "not all is known: {why}");
    }
    out
}

/// The verdict on an unknown: the global one where the number of solutions is known, else the local one.
fn strongest(of_it: &SolutionsOf) -> &'static str {
    let kind = of_it.kind.unwrap_or(UnknownKind::State);
    match (&of_it.solutions, kind) {
        (Solutions::Finite(1), UnknownKind::Parameter) => "globally identifiable",
        (Solutions::Finite(1), _) => "globally observable",
        (Solutions::Infinite, _) => unknown_verdict(kind, Observability::No),
        (Solutions::Finite(_), _) => unknown_verdict(kind, Observability::Yes),
        (Solutions::Undecided(_), _) => unknown_verdict(kind, of_it.local),
    }
}

/// What is known of the number of solutions, and how.
fn in_words(of_it: &SolutionsOf, orders_are_open: bool) -> String {
    match &of_it.solutions {
        Solutions::Undecided(why) => match &of_it.at_least {
            Some((least, map)) => {
                format!("at least {least} solutions: proved, by {map}; how many is undecided: {why}")
            }
            None => format!("globally undecided: {why}"),
        },
        Solutions::Infinite => "infinitely many solutions: proved".to_owned(),
        Solutions::Finite(1) => match of_it.at_most {
            Some((1, log2_error)) => {
                format!("1 solution: proved, error probability below {}", error_bound(log2_error))
            }
            _ => "1 solution: computed".to_owned(),
        },
        Solutions::Finite(count) => {
            let proved = of_it.is_proved();
            let how = if proved { "proved" } else { "computed" };
            let mut text = format!("{count} solutions over the complex numbers: {how}");
            match &of_it.at_least {
                Some((least, map)) if *least < *count => {
                    let _ = write!(text, "; at least {least} that are real: proved, by {map}");
                }
                Some((_, map)) => {
                    let rest = if proved { "" } else { "; no fewer, and real: proved" };
                    let _ = write!(text, "{rest}, by {map}");
                }
                None => {}
            }
            if orders_are_open && !proved {
                text.push_str("; further derivatives might exclude some of them");
            }
            text
        }
    }
}

/// An answer as text.
pub fn global_text(answer: &GlobalAnswer) -> String {
    let mut out = format!("{}: {}\n", shown(&answer.file), answer.title);
    global_findings(answer, &mut out);
    global_circumstances(answer, true, &mut out);
    in_columns(&out)
}

/// What was found: the table of unknowns, a witness, identifiable functions.
pub(super) fn global_findings(answer: &GlobalAnswer, out: &mut String) {
    let found = &answer.solutions;
    let _ = writeln!(out, "the number of solutions of each unknown for given outputs, generically:");
    let width = |of: &dyn Fn(&SolutionsOf) -> usize| found.unknowns.iter().map(of).max().unwrap_or(0);
    let names = width(&|of_it| of_it.name.chars().count());
    let verdicts = width(&|of_it| strongest(of_it).len());
    let layout = Layout { width: Some(COLUMNS), ..Layout::default() };
    // further lines stand below the number of solutions, unless names leave no room there
    let hang = if names + verdicts < 36 { names + verdicts + 6 } else { 4 };
    for of_it in &found.unknowns {
        let (name, verdict) = (&of_it.name, strongest(of_it));
        let rest = in_words(of_it, found.orders_are_open);
        let _ = writeln!(
            out,
            "{}",
            layout.wrap(&format!("  {name:<names$}  {verdict:<verdicts$}  "), hang, &rest)
        );
    }
    if let Some(second) = &found.second {
        prose(
            &format!(
                "a witness: two points at which all derivatives of the outputs up to order {} are equal, in exact numbers",
                second.order
            ),
            out,
        );
        for (name, one, other) in &second.values {
            let (one, other) = (plain_number(one), plain_number(other));
            let text = if one == other { one } else { format!("{one} or {other}") };
            item(&format!("{name} = {text}"), out);
        }
    }
    if let Some(functions) = &answer.functions {
        out.push_str(&in_columns(&functions_text(functions)));
    }
}

/// What was taken for granted, and how it was computed. Fixed values and what is known are left out where another answer about the system says so.
pub(super) fn global_circumstances(answer: &GlobalAnswer, is_alone: bool, out: &mut String) {
    let found = &answer.solutions;
    if !answer.conditions.is_empty() {
        prose(&format!("initial conditions: {}", answer.conditions.join(", ")), out);
    }
    if is_alone && !answer.held.is_empty() {
        prose(&format!("fixed at the values in the file: {}", values_text(&answer.held)), out);
    }
    if is_alone && !answer.known.is_empty() {
        prose(&format!("known: {}", answer.known.join(", ")), out);
    }
    if found.rounds > 0 {
        let orders: Vec<String> = found.orders.iter().map(ToString::to_string).collect();
        let is_timed = answer.seconds.is_finite();
        let time = if is_timed { format!(", {:.1} s", answer.seconds) } else { String::new() };
        let text = format!(
            "computed at {} modulo random primes of 62 bits, from derivatives of the outputs up to {}{time}",
            counted(found.rounds, "random point"),
            orders.join(", "),
        );
        prose(&text, out);
    }
}
