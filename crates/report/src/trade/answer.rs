//! Speed against accuracy, as JSON and as text; the picture is in `trade_plot`.

use crate::layout::counted;
use crate::names::{by_default_text, fields_json, fields_text, ranges_json};
use palmistry_workbench::tradeoff::{
    Combination, CombinationLeftOut, CorrectDigits, DIGITS_TOLERANCE, DerivativeResult, TIME_TOLERANCE, Trade,
};
use serde_json::{Value, json};
use std::fmt::Write;

fn digits_json(digits: CorrectDigits) -> Value {
    match digits {
        CorrectDigits::Exact => json!({ "kind": "exact" }),
        CorrectDigits::Modular => json!({ "kind": "exact modulo a prime" }),
        CorrectDigits::Measured { median, worst } => {
            json!({ "kind": "measured", "median": rounded(median), "worst": rounded(worst) })
        }
    }
}

/// Digits of digits are noise.
fn rounded(digits: f64) -> f64 {
    (digits * 100.0).round() / 100.0
}

fn seconds_json(seconds: f64) -> Value {
    if seconds.is_finite() { json!(seconds) } else { Value::Null }
}

/// What was measured, as one object. `seconds_on_front` depends on times, and so may differ from run to run; all that has
/// no 'seconds' in its name does not.
pub fn trade_json(trade: &Trade) -> Value {
    let derivative = |found: &DerivativeResult| {
        json!({
            "number": found.number.name(),
            "derivative": found.derivative.name(),
            "digits": digits_json(found.digits),
            "failed": found.failed,
            "seconds_a_state": seconds_json(found.seconds),
        })
    };
    let combination = |c: &Combination| {
        json!({
            "number": c.number.name(),
            "derivative": c.derivative.name(),
            "rank": c.rank.name(),
            "digits": digits_json(c.digits),
            "wrong": c.wrong,
            "undecided": c.undecided,
            "failed": c.failed,
            "certified": c.certified,
            "seconds_a_state": seconds_json(c.seconds),
            "seconds_on_front": c.on_front,
        })
    };
    let left_out = |left: &CombinationLeftOut| {
        json!({
            "number": left.number.name(),
            "derivative": left.derivative.map(|derivative| derivative.name()),
            "rank": left.rank.map(|rank| rank.name()),
            "reason": left.reason,
        })
    };
    let ranks: serde_json::Map<String, Value> =
        trade.certified_ranks.iter().map(|(rank, count)| (rank.to_string(), json!(count))).collect();
    json!({
        "file": trade.file,
        "title": trade.title,
        "fields": fields_json(&trade.fields),
        "drawn_by_default": ranges_json(&trade.by_default),
        "rows_from": trade.rows,
        "lie_derivatives": trade.lie_derivatives,
        "rows": trade.size.0,
        "columns": trade.size.1,
        "varying_entries": trade.varying,
        "block_rows": trade.block.0,
        "block_columns": trade.block.1,
        "samples": trade.states,
        "without_truth": trade.without_truth,
        "seed": trade.seed,
        "certified_rank_histogram": ranks,
        "derivatives": trade.derivatives.iter().map(derivative).collect::<Vec<_>>(),
        "ranks": trade.ranks.iter().map(|found| json!({
            "number": found.number.name(),
            "rank": found.rank.name(),
            "seconds_a_state": seconds_json(found.seconds),
        })).collect::<Vec<_>>(),
        "combinations": trade.combinations.iter().map(combination).collect::<Vec<_>>(),
        "left_out": trade.left_out.iter().map(left_out).collect::<Vec<_>>(),
        "rounds": trade.rounds,
        "interrupted": trade.interrupted,
        "seconds": trade.seconds,
    })
}

fn time(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "-".to_owned(),
        s if s < 1e-6 => format!("{:.0} ns", s * 1e9),
        s if s < 1e-3 => format!("{:.1} us", s * 1e6),
        s => format!("{:.1} ms", s * 1e3),
    }
}

/// Digits at the median and at the worst state, as text.
pub(crate) fn digits_text(digits: CorrectDigits) -> (String, String) {
    match digits {
        CorrectDigits::Exact => ("all".to_owned(), "all".to_owned()),
        CorrectDigits::Modular => ("mod p".to_owned(), "mod p".to_owned()),
        CorrectDigits::Measured { median, worst } => (format!("{median:.1}"), format!("{worst:.1}")),
    }
}

/// The combinations on the front, from the fastest to the slowest.
pub(crate) fn front(trade: &Trade) -> Vec<&Combination> {
    let mut front: Vec<&Combination> = trade.combinations.iter().filter(|c| c.on_front).collect();
    front.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    front
}

/// What the columns of the front's table are.
pub const TRADE_FRONT_HEADINGS: [&str; 8] =
    ["number", "derivative", "rank", "a state", "digits", "wrong", "unsure", "certified"];

/// The front as rows of a table under `TRADE_FRONT_HEADINGS`: time a state, digits at the worst state, how many
/// verdicts were wrong, how many undecided or failed, how many right ones are certain.
pub fn trade_front_table(trade: &Trade) -> Vec<[String; 8]> {
    let row = |c: &&Combination| {
        [
            c.number.name().to_owned(),
            c.derivative.name().to_owned(),
            c.rank.name().to_owned(),
            time(c.seconds),
            digits_text(c.digits).1,
            c.wrong.to_string(),
            (c.undecided + c.failed).to_string(),
            c.certified.to_string(),
        ]
    };
    front(trade).iter().map(row).collect()
}

/// What was measured, as text.
pub fn trade_text(trade: &Trade) -> String {
    let mut out = String::new();
    let ranks: Vec<String> = trade
        .certified_ranks
        .iter()
        .map(|(rank, count)| format!("{rank} at {}", counted(*count, "state")))
        .collect();
    let _ = writeln!(out, "{}\nfields: {}", trade.title, fields_text(&trade.fields));
    if !trade.by_default.is_empty() {
        let _ = writeln!(out, "{}", by_default_text(&trade.by_default));
    }
    let _ = writeln!(
        out,
        "rows: {}, {} by {}, {} entries vary; {} of the sample box, seed {}",
        trade.rows,
        trade.size.0,
        trade.size.1,
        trade.varying,
        counted(trade.states, "state"),
        trade.seed
    );
    if !trade.lie_derivatives.is_empty() {
        let _ = writeln!(out, "Lie derivatives: {}", trade.lie_derivatives.join(", "));
    }
    if trade.without_truth > 0 {
        let _ = writeln!(out, "{} left out: nothing is certain there", counted(trade.without_truth, "state"));
    }
    let _ = writeln!(
        out,
        "certified rank: {}; decided on the {} by {} that remain without unit rows",
        ranks.join(", "),
        trade.block.0,
        trade.block.1
    );
    let _ = writeln!(
        out,
        "\n{:<16} {:<20} {:>9} {:>14} {:>6} {:>7}",
        "number", "derivative", "a state", "digits: median", "worst", "failed"
    );
    for found in &trade.derivatives {
        let (median, worst) = digits_text(found.digits);
        let _ = writeln!(
            out,
            "{:<16} {:<20} {:>9} {median:>14} {worst:>6} {:>7}",
            found.number.name(),
            found.derivative.name(),
            time(found.seconds),
            found.failed
        );
    }
    let _ = writeln!(out, "\n{:<16} {:<22} {:>9}", "number", "rank", "a state");
    for found in &trade.ranks {
        let _ =
            writeln!(out, "{:<16} {:<22} {:>9}", found.number.name(), found.rank.name(), time(found.seconds));
    }
    let right = trade.combinations.iter().filter(|c| c.not_right() == 0).count();
    let _ = writeln!(
        out,
        "\n{} combinations, {right} of them right at every state; on the Pareto front (time, digits\nat the worst state, right verdicts, certain ones; {:.0} % of time and {} of a digit do not decide):",
        trade.combinations.len(),
        100.0 * TIME_TOLERANCE,
        DIGITS_TOLERANCE,
    );
    let line = |cells: [&str; 8]| {
        format!(
            "{:<16} {:<20} {:<22} {:>9} {:>6} {:>6} {:>9} {:>6}",
            cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]
        )
    };
    let _ = writeln!(out, "{}", line(TRADE_FRONT_HEADINGS));
    for row in trade_front_table(trade) {
        let _ = writeln!(out, "{}", line(std::array::from_fn(|i| row[i].as_str())));
    }
    let wrong: Vec<&Combination> = trade.combinations.iter().filter(|c| c.not_right() > 0).collect();
    if !wrong.is_empty() {
        let _ = writeln!(out, "\nnot right at every state:");
        for c in wrong {
            let _ = writeln!(
                out,
                "{:<16} {:<20} {:<22} {} wrong, {} undecided, {} failed",
                c.number.name(),
                c.derivative.name(),
                c.rank.name(),
                c.wrong,
                c.undecided,
                c.failed
            );
        }
    }
    let _ = writeln!(
        out,
        "\ndigits are those of the worst entry of a state; a time is the least of {} interleaved rounds on one thread, \
         derivative and rank timed apart and added; {} pairs of a number and a way are left out (--json says why); {:.1} s",
        trade.rounds,
        trade.left_out.len(),
        trade.seconds
    );
    if trade.interrupted {
        let _ = writeln!(out, "interrupted: this is what was measured until then");
    }
    out.trim_end().to_owned()
}
