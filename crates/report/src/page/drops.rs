//! Where a rank drops, on the page: the sets as formulas, what the rank is on each, what proves the rest, what is open.

use super::entry::raised;
use super::inline::{in_line, lie_derivative};
use crate::claims::outcomes::error_bound;
use crate::document::document;
use crate::formula::{conditions_mathml, formula_mathml};
use crate::names::by_default_text;
use maud::{Markup, PreEscaped, html};
use palmistry_lang::Looks;
use palmistry_prove::drops::{BoxShare, DropAnswer, DropSet, UsedMinor};
use palmistry_rank::observability::WrittenState;

/// Longer formulas are cut off; the JSON has all of them.
const LONGEST: usize = 400;
/// In a table with other columns formulas that are longer than this stand as text, which is broken into lines.
const SHORT: usize = 120;
/// So many open sets and minors are shown.
const MOST: usize = 60;
/// So many conditions under which all terms exist.
const CONDITIONS: usize = 8;

/// The page as HTML.
pub fn drops_page(answer: &DropAnswer) -> String {
    let content = html! {
        header { h1 { (answer.title) } p.y { (answer.file) } }
        main { section { (told(answer)) } }
    };
    document(&format!("{}: singular set", answer.title), &content, false)
}

fn told(answer: &DropAnswer) -> Markup {
    let DropAnswer { rank, dimension, .. } = answer;
    html! {
        h3 { "The singular set: where the rank is lower" }
        p {
            @if answer.is_final { "Generically the rank is " b { (rank) } " of " (dimension) "." }
            @else { "Asked for is the rank " b { (rank) } " of " (dimension) "; that it is so generically is not decided." }
            @if !answer.initial.is_empty() {
                " It is decided for the initial conditions " (listed(&answer.initial, SHORT)) "."
            }
            @if !answer.domain.is_empty() {
                " It is asked for where all terms exist: "
                (listed(&answer.domain[..answer.domain.len().min(CONDITIONS)], SHORT))
                @if answer.domain.len() > CONDITIONS { ", and " (answer.domain.len() - CONDITIONS) " more" } "."
            }
        }
        (conclusion(answer))
        @if !answer.sets.is_empty() { (sets(&answer.sets)) }
        @if !answer.open.is_empty() { (open(&answer.open)) }
        @if let Some(share) = &answer.on_the_box { (on_the_box(share, *rank)) }
        @if !answer.minors.is_empty() { (minors(&answer.minors)) }
    }
}

/// What the sets below are, in a sentence.
fn conclusion(answer: &DropAnswer) -> Markup {
    let (cases, empty) = answer.cases;
    html! {
        p.lead {
            @match (answer.is_exact(), answer.sets.is_empty()) {
                (true, true) => { "The singular set is empty: nowhere is the rank lower." }
                (true, false) => { "The rank is lower on these sets, and nowhere else." }
                (false, true) if answer.minors.is_empty() => { "The singular set is not known: no case of it was decided." }
                (false, true) => { "No set was found on which the rank is lower; the rest is open." }
                (false, false) => { "The rank is lower on these sets; whether elsewhere too is open." }
            }
        }
        p {
            @if cases == 0 { "No case was looked at." } @else if answer.is_exact() { "Proved: all" } @else { "So far" }
            @if cases > 0 {
            " states were taken apart into " (cases) @if cases == 1 { " case" } @else { " cases" }
            ", " (empty) " of them empty; "
            (answer.minors.len()) @if answer.minors.len() == 1 { " minor" } @else { " minors" }
            ", each a product of factors that do not vanish on its case, "
            @if answer.minors.len() == 1 { "shows" } @else { "show" }
            " the rank to be no lower there."
            }
            @if let Some(why) = &answer.out_of_reach { " " span.bad { "The search ended early: " (why) "." } }
        }
    }
}

fn sets(sets: &[DropSet]) -> Markup {
    html! {
        div.scroll { table {
            thead { tr { th { "set" } th { "rank" } th { "that it is no higher" } th { "for example at" } } }
            tbody {
                @for set in sets {
                    tr {
                        td { (place(set)) }
                        td.n { @if !set.exactly { "at most " } b { (set.rank) } }
                        td {
                            @match error_bound(set.log2_error).as_str() {
                                "0" => { "certain" }
                                bound => { "error below " (raised(bound)) }
                            }
                        }
                        td.w {
                            @if let Some(state) = &set.state { (at(state)) }
                            @else if !set.exists { "no state of it was found, and there may be none" }
                        }
                    }
                }
            }
        } }
    }
}

fn open(sets: &[DropSet]) -> Markup {
    html! {
        p { b.bad { "Open" } ": the rank may be lower on these." }
        div.scroll { table {
            thead { tr { th { "set" } th { "why it is open" } } }
            tbody {
                @for set in sets.iter().take(MOST) {
                    tr { td { (place(set)) } td.w { (set.open.as_deref().unwrap_or_default()) } }
                }
            }
        } }
        @if sets.len() > MOST { p { "and " (sets.len() - MOST) " more, which the JSON has." } }
    }
}

fn on_the_box(share: &Result<BoxShare, String>, rank: usize) -> Markup {
    html! {
        p {
            @match share {
                Ok(share) => {
                    "Interval certificates prove the rank to be " (rank) " on " b { (share.percent()) " %" }
                    " of the sample box (" (share.boxes) @if share.boxes == 1 { " box" } @else { " boxes" } "), which is no more than a part of all states."
                    @if !share.by_default.is_empty() { " " (by_default_text(&share.by_default)) "." }
                }
                Err(why) => { "Interval certificates prove nothing on the sample box: " (why) "." }
            }
        }
    }
}

fn minors(minors: &[UsedMinor]) -> Markup {
    html! {
        details {
            summary { "the minors by which the rank is no lower elsewhere" }
            div.scroll { table {
                thead { tr { th { "on the case" } th { "minor" } th { "is, up to a factor that does not vanish" } } }
                tbody {
                    @for minor in minors.iter().take(MOST) {
                        tr {
                            td { @if minor.equations.is_empty() { "all states" } @else { (listed(&minor.equations, SHORT)) } }
                            td.w { (rows(&minor.rows)) }
                            td { (product(&minor.factors)) }
                        }
                    }
                }
            } }
            @if minors.len() > MOST { p { "and " (minors.len() - MOST) " more, which the JSON has." } }
        }
    }
}

/// The Lie derivatives whose differentials are the rows of a minor.
fn rows(rows: &[String]) -> Markup {
    html! { @for (place, row) in rows.iter().enumerate() { @if place > 0 { ", " } (lie_derivative(row, None, &Looks::default())) } }
}

fn product(factors: &[(String, i64)]) -> Markup {
    let raised = |(factor, power): &(String, i64)| match power {
        -1 | 1 => format!("({factor})"),
        _ => format!("({factor})^{}", power.unsigned_abs()),
    };
    let part = |below: bool| {
        let own: Vec<String> =
            factors.iter().filter(|(_, power)| (*power < 0) == below).map(raised).collect();
        if own.is_empty() { "1".to_owned() } else { own.join("*") }
    };
    let (above, below) = (part(false), part(true));
    let text = if below == "1" { above } else { format!("{above}/({below})") };
    expression(&text)
}

fn expression(text: &str) -> Markup {
    let formula = if text.len() <= SHORT { formula_mathml(text) } else { None };
    match formula {
        Some(formula) => html! { span.f { (PreEscaped(formula)) } },
        None => html! { code { (in_short(text, LONGEST)) } },
    }
}

fn place(set: &DropSet) -> Markup {
    let all: Vec<String> = set.equations.iter().chain(&set.unless).cloned().collect();
    if all.is_empty() {
        html! { "all states" }
    } else {
        listed(&all, LONGEST)
    }
}

/// Conditions as formulas, one after the other; each of those that are too long as it is written, in part.
fn listed(conditions: &[String], longest: usize) -> Markup {
    html! {
        @for (place, condition) in conditions.iter().enumerate() {
            @if place > 0 { ", " }
            @let formula = if condition.len() <= longest { conditions_mathml(std::slice::from_ref(condition), &Default::default()) } else { None };
            @match formula {
                Some(formula) => { span.f { (PreEscaped(formula)) } }
                None => { code { (in_short(condition, longest)) } }
            }
        }
    }
}

fn in_short(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text.to_owned(),
    }
}

fn at(state: &WrittenState) -> Markup {
    html! {
        @for (place, at) in state.iter().enumerate() {
            @if place > 0 { ", " }
            (in_line(&at.name, &Looks::default())) @if at.exact.contains('=') { ": " } @else { " = " } (at.exact)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer() -> DropAnswer {
        let set = DropSet {
            equations: vec!["omega0 = 0".to_owned()],
            unless: vec!["x != 0".to_owned()],
            rank: 4,
            exactly: false,
            open: None,
            log2_error: f64::NEG_INFINITY,
            state: None,
            exists: false,
        };
        let open = DropSet { open: Some("too long".to_owned()), unless: Vec::new(), ..set.clone() };
        DropAnswer {
            file: "a.proof".to_owned(),
            title: "A <system>".to_owned(),
            dimension: 6,
            rank: 6,
            is_final: true,
            initial: Vec::new(),
            domain: vec!["y != 0".to_owned()],
            sets: vec![set],
            open: vec![open],
            minors: vec![UsedMinor {
                equations: Vec::new(),
                rows: vec!["x".to_owned()],
                columns: vec!["x".to_owned()],
                factors: vec![("omega0".to_owned(), 2), ("y".to_owned(), -1)],
            }],
            cases: (3, 1),
            out_of_reach: None,
            interrupted: false,
            on_the_box: Some(Err("no box".to_owned())),
            seconds: 0.0,
        }
    }

    /// What is open is never shown as if it were all.
    #[test]
    fn a_page_says_what_is_open() {
        let mut answer = answer();
        let text = drops_page(&answer);
        for part in ["whether elsewhere too is open", "too long", "no box", "<th>why it is open"] {
            assert!(text.contains(part), "{part}");
        }
        assert!(!text.contains("nowhere else") && !text.contains("<system>"));
        answer.open.clear();
        answer.on_the_box = None;
        let text = drops_page(&answer);
        assert!(text.contains("on these sets, and nowhere else") && text.contains("Proved: all"));
    }
}
