//! Answers about ranks, as text.

use super::answer::{certainty_text, stop_text};
use super::deviations::{deviations_text, direction_text, nearly_unobservable_text, place_text};
use super::generic::{generic_sentence, generic_text};
use super::global::{global_circumstances, global_findings};
use super::motions::motions_text;
use super::singular::{SingularSet, singular_set_text};
use crate::layout::{counted, fits_a_line, in_columns, item, prose};
use crate::names::{by_default_text, fields_text, values_text};
use palmistry_lang::Range;
use palmistry_rank::observability::Stop;
use palmistry_rank::sweep::{BranchAnswer, GlobalAnswer, RankAnswer, SweepReport};

/// The ranks at the sampled states in one line; with the details also what was met on the way.
fn sampled_text(how: &str, report: &SweepReport, details: bool, out: &mut String) {
    let share = |count: u64| match count {
        1 if report.samples == 1 => String::new(),
        all if all == report.samples => " at all of them".to_owned(),
        some => format!(" at {some}"),
    };
    let ranks: Vec<String> = report
        .rank_histogram
        .iter()
        .rev()
        .map(|(rank, count)| format!("rank {rank}{}", share(*count)))
        .collect();
    let mut text = match ranks.is_empty() {
        true => "no sampled state could be decided".to_owned(),
        false => format!("at {}{how}: {}", counted(report.samples, "sampled state"), ranks.join(", ")),
    };
    text += &match report.certified {
        _ if ranks.is_empty() => String::new(),
        all if all == report.samples => ", certified".to_owned(),
        0 => "; computed, not certified".to_owned(),
        some => format!("; certified at {some} of {}", report.samples),
    };
    let poles: u64 = report.poles.values().sum();
    if poles > 0 && !details {
        text += &format!("; {} left out, singular there", counted(poles, "state"));
    }
    prose(&text, out);
    if report.interrupted {
        item("interrupted: these are the states done until then", out);
    }
    if !details {
        return;
    }
    if report.disagreements > 0 {
        item(
            &format!(
                "at {} the singular values alone suggest another rank: {:?}",
                counted(report.disagreements, "state"),
                report.computed_histogram
            ),
            out,
        );
    }
    for (pole, count) in &report.poles {
        item(&format!("{} left out, singular there: {pole}", counted(*count, "state")), out);
    }
}

/// Unobservable directions at single states; where the rank there is lower than elsewhere, by Lie derivatives up to this order alone.
fn directions_text(report: &SweepReport, short_up_to: Option<usize>, out: &mut String) {
    let unobservable = match short_up_to {
        Some(order) => format!("not observable by Lie derivatives up to order {order}"),
        None => "unobservable".to_owned(),
    };
    for direction in &report.unobservable {
        item(
            &format!(
                "at {} {unobservable}: a direction in {}; for one, {}",
                counted(direction.count, "state"),
                direction.states.join(", "),
                direction.example
            ),
            out,
        );
        item(&format!("  at {}:", place_text(&direction.at)), out);
        item(&format!("  {}", direction_text(direction)), out);
    }
}

/// How the ranks at the sampled states were decided.
fn sweep_details(report: &SweepReport, out: &mut String) {
    let number_types: Vec<String> = report
        .number_types
        .iter()
        .map(|(number_type, count)| format!("{} at {count}", number_type.name()))
        .collect();
    if !number_types.is_empty() {
        let climbed = report.climbed();
        item(
            &format!(
                "number types: {}; {} escalated to a higher precision",
                number_types.join(", "),
                counted(climbed, "state")
            ),
            out,
        );
    }
    if report.smallest_gap.is_finite() {
        item(&format!("smallest gap on which a computed rank rests: {:.1e}", report.smallest_gap), out);
    }
    if report.seconds.is_finite() {
        item(&format!("{:.2} s", report.seconds), out);
    }
}

/// The digits of the worst conditioned state, which were asked for.
fn digits_text(report: &SweepReport, out: &mut String) {
    let Some(digits) = &report.digits else { return };
    // how hard a rank is to decide says nothing of how well a state is observable: it is for those who ask for digits
    if let Some((state, spectrum)) = &report.worst {
        let values: Vec<String> = state.iter().map(|at| format!("{} = {:.6}", at.name, at.value)).collect();
        let condition = match digits {
            Ok(found) => found.condition.clone(),
            Err(_) => format!("{:.3e}", spectrum.condition()),
        };
        item(&format!("worst conditioned: {condition} at {}", values.join(", ")), out);
        let (rows, columns) = report.remaining;
        item(
            &format!(
                "(singular values are those of the {rows} by {columns} matrix that remains without unit rows, equilibrated)"
            ),
            out,
        );
    }
    match digits {
        Ok(found) => {
            if !found.values.is_empty() {
                item(&format!("its singular values: {}", found.values.join(", ")), out);
            }
            let (kind, climbed) = (certainty_text(found.certainty), counted(found.climbed, "escalation"));
            item(
                &format!("{} digits, {kind} by {} after {climbed}", found.digits, found.number_type.name()),
                out,
            );
        }
        Err(why) => item(&format!("no digits beyond those of doubles: {why}"), out),
    }
}

/// What an answer takes for granted beside its file's equations: what is known and so not counted, what is assumed of signals,
/// and ranges that the file does not give.
pub(crate) fn taken_for_granted(answer: &RankAnswer) -> Vec<String> {
    let mut lines = Vec::new();
    if !answer.known.is_empty() {
        lines.push(format!("known, and not counted: {}", answer.known.join(", ")));
    }
    if !answer.assumed.is_empty() {
        lines.push(format!("assumed of unknown signals: {}", answer.assumed.join(", ")));
    }
    let by_default = drawn_by_default(answer);
    if !by_default.is_empty() {
        lines.push(by_default_text(&by_default));
    }
    lines
}

/// All that is drawn from ranges which the file does not give, on any branch.
fn drawn_by_default(answer: &RankAnswer) -> Vec<(String, Range)> {
    let mut by_default: Vec<(String, Range)> = Vec::new();
    for one in answer.branches.iter().flat_map(|branch| &branch.by_default) {
        if !by_default.contains(one) {
            by_default.push(one.clone());
        }
    }
    by_default
}

/// A line as it is; where that is longer than a line may be and nobody asks for details, a shorter one.
fn whole_or_short(whole: String, short: impl FnOnce() -> String, details: bool) -> String {
    if details || fits_a_line(&whole) { whole } else { short() }
}

/// What stands at the end of an answer: how many unknowns and outputs there are, what moves the states, what is known, fixed and drawn. Each is
/// a line, and without the details a count where it is longer than that.
fn circumstances(answer: &RankAnswer, details: bool) -> Vec<String> {
    let sizes = format!("{}, {}", counted(answer.dimension, "unknown"), counted(answer.outputs, "output"));
    let whole = format!("{sizes}; {}", fields_text(&answer.fields));
    let fields = || format!("{sizes}; {} (--details lists them)", counted(answer.fields.len(), "field"));
    let mut lines = vec![whole_or_short(whole, fields, details)];
    if !answer.known.is_empty() {
        let known = || {
            format!(
                "known, and not counted: {} (--details lists them)",
                counted(answer.known.len(), "symbol")
            )
        };
        let whole = format!("known, and not counted: {}", answer.known.join(", "));
        lines.push(whole_or_short(whole, known, details));
    }
    if !answer.assumed.is_empty() {
        lines.push(format!("assumed of unknown signals: {}", answer.assumed.join(", ")));
    }
    for branch in answer.branches.iter().filter(|branch| !branch.held.is_empty()) {
        let values = values_text(&branch.held);
        let line =
            format!("fixed at the values in the file: {values} (a claim 'rank = n' is about all values)");
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    // where no state is sampled nothing is drawn
    let is_sampled = answer.branches.iter().any(|branch| branch.stop != Stop::NotTaken);
    let by_default = drawn_by_default(answer);
    if is_sampled && !by_default.is_empty() {
        let short = || {
            let drawn = counted(by_default.len(), "symbol");
            format!("drawn by default, without a range in the file: {drawn} (--details lists them)")
        };
        lines.push(whole_or_short(by_default_text(&by_default), short, details));
    }
    lines
}

/// What is printed beside an answer about ranks.
#[derive(Clone, Copy, Default)]
pub struct RankTextParts<'a> {
    /// How many values of each unknown give the same outputs: it comes first.
    pub global: Option<&'a GlobalAnswer>,
    /// Whether the table of unknowns is left out, as the one before it says more.
    pub without_table: bool,
    /// Where the rank drops, if that was asked.
    pub singular_set: Option<&'a SingularSet>,
    /// Whether Lie derivatives, number types, gaps, standard deviations and single states are printed.
    pub details: bool,
}

/// An answer as text: the unknowns, identifiable combinations and unobservable directions, the sampled ranks in a line; and with the details the Lie
/// derivatives that were used, number types, gaps, standard deviations and times. At the end, what was taken for granted.
pub fn rank_text(answer: &RankAnswer, details: bool) -> String {
    rank_text_with(answer, &RankTextParts { details, ..RankTextParts::default() })
}

/// The same with what else was asked about the system.
pub fn rank_text_with(answer: &RankAnswer, parts: &RankTextParts<'_>) -> String {
    let mut out = format!("{}\n", answer.title);
    if let Some(global) = parts.global {
        global_findings(global, &mut out);
    }
    let is_one = answer.branches.len() == 1;
    for branch in &answer.branches {
        branch_text(branch, parts, is_one, &mut out);
    }
    if let Some(found) = parts.singular_set {
        singular_set_text(found, &answer.file, &mut out);
    }
    for branch in &answer.branches {
        let title = branch.conditions.join(", ");
        if !is_one && !title.is_empty() && branch.stop != Stop::NotTaken {
            prose(&format!("where {title}"), &mut out);
        }
        samples_text(branch, parts, &mut out);
    }
    if answer.branches.iter().all(|branch| branch.stop == Stop::NotTaken) && !parts.without_table {
        prose("no states were sampled (--samples N draws N)", &mut out);
    }
    for place in &answer.left_out {
        prose(&format!("no state of the sample box was found where {place}"), &mut out);
    }
    for line in circumstances(answer, parts.details) {
        prose(&line, &mut out);
    }
    if let Some(global) = parts.global {
        global_circumstances(global, false, &mut out);
    }
    in_columns(out.trim_end())
}

/// What holds generically on a branch of the conditions. A short condition is the title of its table; a long one follows it.
fn branch_text(branch: &BranchAnswer, parts: &RankTextParts<'_>, is_one: bool, out: &mut String) {
    let conditions = format!("where {}", branch.conditions.join(", "));
    let is_title = !is_one || fits_a_line(&conditions);
    if !branch.conditions.is_empty() && is_title {
        prose(&conditions, out);
    }
    match parts.without_table {
        true => prose(&generic_sentence(&branch.generic), out),
        false => generic_text(&branch.generic, &branch.unknowns, out),
    }
    if !branch.conditions.is_empty() && !is_title {
        prose(&conditions, out);
    }
    // fields are for all states: single directions at sampled ones are details
    let at_states = branch.stop != Stop::NotTaken && !parts.details;
    branch.motions.iter().for_each(|found| motions_text(found, at_states, out));
}

/// The ranks at the states of a branch that were sampled.
fn samples_text(branch: &BranchAnswer, parts: &RankTextParts<'_>, out: &mut String) {
    if branch.stop == Stop::NotTaken {
        return;
    }
    let details = parts.details;
    if !branch.is_final {
        prose("higher Lie derivatives may still raise the rank: nothing here says that they cannot", out);
    }
    let short_up_to = branch.is_short_somewhere().then_some(branch.order);
    let by_order =
        short_up_to.map_or_else(String::new, |order| format!(", by Lie derivatives up to order {order}"));
    sampled_text(&by_order, &branch.full, details, out);
    let lower = branch.full.rank_histogram.range(..branch.generic_rank).map(|(_, count)| count).sum::<u64>();
    if details {
        directions_text(&branch.full, short_up_to, out);
    } else if branch.motions.is_none() && !branch.full.unobservable.is_empty() {
        item("--details has the unobservable directions, each at one of these states", out);
    }
    digits_text(&branch.full, out);
    if lower > 0 && parts.singular_set.is_none() {
        item(
            &format!(
                "rank-deficient at {lower} of them: --singular-set gives the singular set, by Lie derivatives of all orders"
            ),
            out,
        );
    }
    if details {
        let longest = branch.order;
        item(&format!("Lie derivatives used: {}", branch.lie_derivatives.join(", ")), out);
        item(&format!("Lie derivatives up to order {longest} were taken: {}", stop_text(branch.stop)), out);
        sweep_details(&branch.full, out);
    }
    if let Some(rows) = &branch.rows {
        sampled_text(", by the rows of the file", rows, details, out);
        digits_text(rows, out);
        if details {
            directions_text(rows, None, out);
            sweep_details(rows, out);
        }
    }
    if let Some(found) = &branch.deviations {
        match details {
            true => deviations_text(found, out),
            false => nearly_unobservable_text(found, out),
        }
    }
}
