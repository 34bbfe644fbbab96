//! What was found of one system beside its claims: ranks on sets, maps, lines, reductions, numbers in print, Lie derivatives.

use super::entry::{explain, formula};
use super::findings::ranks_in_words;
use super::inline::{conditions, field_name, in_line, lie_derivative, listed, numbers_first, with_list};
use super::motions::unobservable_directions;
use super::system::system_mathematics;
use super::unknowns::unknowns;
use crate::axis::name_in_picture;
use crate::plot;
use crate::ranks::{deviation_text, taken_for_granted};
use crate::structure::{DiagramGround, structure_picture};
use maud::{Markup, PreEscaped, html};
use palmistry_lang::Looks;
use palmistry_prove::claim::Outcome;
use palmistry_rank::observability::CodistributionError;
use palmistry_rank::sweep::{BranchAnswer, RankAnswer, RankError};
use palmistry_workbench::paper::{
    DerivativesFound, FileFindings, LineFound, MapFound, ReductionFound, SetRank,
};
use palmistry_workbench::tradeoff::{ExpandedText, LandscapeRows, Map, PrintedExpression, WaysAgreement};

/// The unit of a name, where it is known.
pub(super) type Units<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Whether there is something to show.
pub(super) fn has_a_section(file: &FileFindings) -> bool {
    !file.ranks.is_empty()
        || !file.printed.is_empty()
        || !file.left_out.is_empty()
        || !file.reductions.is_empty()
        || file.derivatives.is_some()
}

/// Everything of one file.
pub(super) fn file_section(anchor: &str, file: &FileFindings, claims: &Markup, units: Units<'_>) -> Markup {
    let looks = &file.system.looks;
    html! {
        section #(anchor) {
            h2 { (file.system.title) }
            @if !file.ranks.is_empty() { div.beside { div { (system_mathematics(&file.system)) } (structure(file)) } }
            @for found in &file.reductions { (reduction(found, looks)) }
            @for left in &file.left_out { p.bad { "Not done: " (left.what) ": " (left.why) } }
            @for left in &file.too_large { p { "Bounded: " (left.what) ": " (left.why) "." } }
            (claims)
            @if !file.ranks.is_empty() {
                h3 { "What is observable" }
                @for line in granted(file) { p { (with_list(&capitalised(&line), looks)) "." } }
                (unknowns(&file.ranks, looks)) (unobservable_directions(&file.ranks, looks)) (ranks(&file.ranks, looks))
            }
            @for map in &file.maps { (maps(map, units, looks)) }
            @if !file.lines.is_empty() { (lines(&file.lines, units)) }
            @for found in &file.printed { (printed(found, &file.outcomes)) }
            @if file.ways.is_some() || file.derivatives.is_some() {
                details {
                    summary { "Lie derivatives by several routes" }
                    @if let Some(found) = &file.ways { (ways(found, looks)) }
                    @if let Some(found) = &file.derivatives { (derivatives(found, looks)) }
                }
            }
        }
    }
}

/// Which state stands in whose rate, with what is observable.
fn structure(file: &FileFindings) -> Markup {
    let branch = file.ranks.first().and_then(|rank| rank.answer().ok()?.branches.first());
    html! {
        @if let Some(picture) = structure_picture(&file.system, branch, DiagramGround::Page) {
            figure {
                (PreEscaped(picture))
                figcaption {
                    "An arrow leads from a state to those that stand in its rate; a ring is around what the outputs hold, squares are "
                    "signals. Green is generically observable, red is not, grey is known or undecided."
                }
            }
        }
    }
}

/// As a sentence begins.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// What the ranks of a file take for granted; the first of them is that at all states.
fn granted(file: &FileFindings) -> Vec<String> {
    let answer = file.ranks.iter().find_map(|rank| rank.found.as_ref().ok());
    answer.map(taken_for_granted).unwrap_or_default()
}

fn maps(map: &MapFound, units: Units<'_>, looks: &Looks) -> Markup {
    html! {
        figure {
            div.grid {
                @for (kind, drawn) in &map.maps {
                    @let title = if *kind == LandscapeRows::Own { "the file's own rows" } else { "the full codistribution" };
                    @let title = map.view.of.as_ref().map_or(title.to_owned(), |of| format!("{title}: {}", name_in_picture(of, looks)));
                    @let units = [units(&drawn.x.name), units(&drawn.y.name)];
                    (PreEscaped(plot::map(drawn, &title, [units[0].as_deref(), units[1].as_deref()], looks)))
                }
            }
            figcaption {
                b { (title_of(map, looks)) ". " }
                "The standard deviation of " @match &map.view.of { Some(of) => { (in_line(of, looks)) } None => { "the worst state" } }
                " over its prior one, where each row is measured up to its own range (computed, not certified). Light is "
                "small, which is well; dark is large; green is infinite, which is unobservable or not distinguishable from it; white "
                "is a singularity. "
                @if map.view.of.is_none() { (worst_of(map, looks)) }
                @if let Some(caption) = &map.view.caption { (caption) }
            }
        }
    }
}

/// What a map is called: by its file, or, where nobody asked for it, by what it shows.
fn title_of(map: &MapFound, looks: &Looks) -> Markup {
    match &map.view.of {
        Some(of) if map.view.span.is_empty() => html! { "how well " (in_line(of, looks)) " is observable" },
        _ => html! { (map.view.title) },
    }
}

/// Which state is the worst in which part of each map.
fn worst_of(found: &MapFound, looks: &Looks) -> Markup {
    let shown = found.maps.iter().map(|(_, map)| map).filter(|map| !map.shown.is_empty());
    let shown: Vec<&Map> = shown.collect();
    let all = |map: &Map| map.shown.iter().map(|(_, count)| count).sum::<usize>() as f64;
    html! {
        @if !shown.is_empty() {
            "The worst is "
            @for (place, map) in shown.iter().enumerate() {
                @if place > 0 { "; " }
                @for (place, (name, count)) in map.shown.iter().enumerate() {
                    @if place > 0 { ", " }
                    (in_line(name, looks)) " in " (format!("{:.0} %", 100.0 * *count as f64 / all(map)))
                }
            }
            " of the cells. "
        }
    }
}

fn lines(lines: &[LineFound], units: Units<'_>) -> Markup {
    html! {
        figure {
            div.grid {
                @for line in lines {
                    (PreEscaped(plot::slope(&line.slope, &line.view.title, units(&line.view.moving).as_deref())))
                }
            }
            figcaption {
                "How well each state is observable along lines"
                @if lines.iter().all(|line| line.rows == LandscapeRows::Own) { ", by the file's own rows alone" }
                ": its standard deviation over its prior one, that of the worst in red; dots above the scale where it is infinite. "
                "Distances are in the coordinate that moves."
            }
        }
    }
}

fn reduction(found: &ReductionFound, looks: &Looks) -> Markup {
    let proved = found.claims.iter().filter(|outcome| outcome.ok).count();
    html! {
        p {
            "This is " em { (found.of) } " where " (conditions(&found.reduction.written, looks)) ": "
            b { (proved) } " of " (found.claims.len()) " statements proved (the conditions stay met, what is left out stays as it "
            "is, fields and differentials are the same). Left out: "
            @for (place, name) in found.left_out.iter().enumerate() {
                @if place > 0 { ", " }
                (in_line(name, looks))
            }
            "."
            @if let Some(remark) = &found.reduction.remark { " " (remark) "." }
            @match &found.comparison {
                Ok(c) => {
                    " " (c.small_states) " states instead of " (c.large_states) "; differentials agree to "
                    (format!("{:.0e}", c.largest_difference.max(f64::EPSILON))) " relative. One state's matrix takes "
                    (c.large_operations) " operations with all states, and " (c.small_operations) " with these"
                    @if !c.large_seconds.is_nan() {
                        "; with its singular values " b { (format!("{:.1}", c.large_seconds / c.small_seconds)) } " times as long"
                    }
                    "."
                }
                Err(why) => { " Not counted: " (why) "." }
            }
        }
    }
}

fn unobservable(answer: &RankAnswer, own: bool) -> Vec<String> {
    let mut found = Vec::new();
    for branch in &answer.branches {
        let report = if own { branch.rows.as_ref() } else { Some(&branch.full) };
        for direction in report.into_iter().flat_map(|report| &report.unobservable) {
            let text = direction.states.join(", ");
            if !found.contains(&text) {
                found.push(text);
            }
        }
    }
    found
}

/// Lists of names as symbols, one list behind the other.
fn in_symbols(lists: &[String], looks: &Looks) -> Markup {
    html! {
        @for (place, list) in lists.iter().enumerate() {
            @if place > 0 { "; " }
            (listed(&list.split(", ").collect::<Vec<_>>(), looks))
        }
    }
}

/// The Lie derivatives that were used, branches with the same ones together.
fn distinct_lie_derivatives(answer: &RankAnswer) -> Vec<&[String]> {
    let mut found: Vec<&[String]> =
        answer.branches.iter().map(|branch| branch.lie_derivatives.as_slice()).collect();
    found.dedup();
    found
}

/// They are set as mathematics.
fn lie_derivatives(answer: &RankAnswer, looks: &Looks) -> Markup {
    let fields: Vec<&str> = answer.fields.iter().map(|field| field.name.as_str()).collect();
    html! {
        @for used in distinct_lie_derivatives(answer) {
            div {
                @for (place, one) in used.iter().enumerate() {
                    @if place > 0 { ", " }
                    (lie_derivative(one, Some(&fields), looks))
                }
            }
        }
    }
}

/// Why there is no rank on a set.
fn without_rank(rank: &SetRank, why: &str, looks: &Looks) -> Markup {
    match &rank.found {
        Err(RankError::Codistribution(CodistributionError::Pole { divisor })) => html! {
            "undefined at every state there: a division by " span.f { (in_line(divisor, looks)) } " = 0"
        },
        Ok(answer) if rank.is_undecided() && !answer.left_out.is_empty() => {
            let (said, _) = why.split_once(" where ").unwrap_or((why, ""));
            html! {
                "not decided: " (said)
                @for (place, part) in answer.left_out.iter().enumerate() {
                    @if place > 0 { ", or" }
                    " where " (conditions(&part.split(", ").map(numbers_first).collect::<Vec<_>>(), looks))
                }
            }
        }
        _ if rank.is_undecided() => html! { "not decided: " (why) },
        _ => html! { (with_list(why, looks)) },
    }
}

/// The rank on each set, a row each.
fn ranks(ranks: &[SetRank], looks: &Looks) -> Markup {
    let answers = ranks.iter().filter_map(|rank| rank.answer().ok());
    let has_own = answers.flat_map(|answer| &answer.branches).any(|branch| branch.rows.is_some());
    html! {
        div.scroll { table {
            thead { tr {
                th { "states" } th { "rank" } th { "unobservable" }
                @if has_own { th { "rank, rows of the file" } th { "unobservable by these" } }
                th { "Lie derivatives used" } th { "sampled" } th { "certified" } th { "least observable" }
            } }
            tbody {
                @for rank in ranks {
                    tr {
                        td.s { (rank.name()) @if let Some(set) = &rank.set { br; (conditions(&set.written, looks)) } }
                        @match rank.answer() {
                            Ok(answer) => {
                                td.k { b { (ranks_in_words(answer, false)) } " of " (answer.dimension) }
                                td {
                                    @if answer.branches.iter().any(BranchAnswer::is_short_somewhere) {
                                        "not decided: Lie derivatives of higher order may raise the rank"
                                    } @else { (in_symbols(&unobservable(answer, false), looks)) }
                                }
                                @if has_own {
                                    td { b { (ranks_in_words(answer, true)) } }
                                    td { (in_symbols(&unobservable(answer, true), looks)) }
                                }
                                td.w { (lie_derivatives(answer, looks)) }
                                td.n { (answer.branches.iter().map(|b| b.full.samples).sum::<u64>()) }
                                td.n { (answer.branches.iter().map(|b| b.full.certified).sum::<u64>()) }
                                td.n { (least_observable(answer, looks)) }
                            }
                            Err(why) => { td.bad[!rank.as_expected()] colspan=(if has_own { "8" } else { "6" }) { (without_rank(rank, &why, looks)) } }
                        }
                    }
                }
            }
        } }
    }
}

/// The state with the largest standard deviation over its prior one.
fn least_observable(answer: &RankAnswer, looks: &Looks) -> Markup {
    let found = answer.branches.iter().filter_map(|branch| branch.deviations.as_ref());
    let all: Vec<_> = found.filter_map(|found| Some((found.least.as_ref()?, found))).collect();
    let least = all.into_iter().max_by(|(a, _), (b, _)| a.deviation.total_cmp(&b.deviation));
    match least {
        Some((least, found)) => html! { (in_line(&least.state, looks)) ": " (deviation_text(found, least)) },
        None => html! { "-" },
    }
}

fn printed(found: &PrintedExpression, outcomes: &[Outcome]) -> Markup {
    let none = Looks::default();
    let looks = outcomes.first().map_or(&none, |outcome| &outcome.looks);
    let digits = found.values.first().map_or(0, |value| value.carried);
    let studied: Vec<_> = found.values.iter().filter_map(|v| Some((v, v.study.as_ref().ok()?))).collect();
    let poles: Vec<&Outcome> =
        outcomes.iter().filter(|outcome| outcome.pole_of.as_deref() == Some(found.text.as_str())).collect();
    html! {
        h3 { "Numbers in print: " (in_line(&found.text, looks)) }
        @if let Some(expanded) = &found.expanded {
            p {
                "Multiplied out over its common denominator, as a computer-algebra system's " code { "simplify" }
                " leaves it, it has " b { (expanded.monomials) } " monomials: "
                code { (expanded.front) " * (" (expanded.beginning) ") / (" (denominator(expanded)) ")" } "."
            }
        }
        div.scroll { table {
            thead { tr {
                th { "point" } th { "printed" } th { "certified to forty digits" } th { "digits that agree" } th { "error of print" }
                th { "errors of sums in " (digits) " digits" } th { "print is" }
            } }
            tbody {
                @for value in &found.values {
                    tr {
                        td.w { (value.point) }
                        td.n { (value.printed) }
                        td.n { (value.certified.decimal) }
                        td.n { (value.digits_that_agree) }
                        td.n { (format!("{:+.2e}", value.error)) }
                        @match &value.study {
                            Ok(study) => {
                                td.n {
                                    (format!("{:+.1e}", study.errors.first().copied().unwrap_or(0.0))) " to "
                                    (format!("{:+.1e}", study.errors.last().copied().unwrap_or(0.0)))
                                    ", rms " (format!("{:.1e}", study.deviation()))
                                }
                                td { @if study.contains(value.error) { "inside" } @else { "outside" } }
                            }
                            Err(why) => { td colspan="2" { "not known: " (why) } }
                        }
                    }
                }
            }
        } }
        @if !studied.is_empty() {
            figure {
                div.grid {
                    @for (value, study) in &studied {
                        (PreEscaped(plot::rounding(study, value.error, &format!("printed {}", value.printed))))
                    }
                }
                figcaption {
                    "The monomials added up in decimal arithmetic of " (digits) " digits, in "
                    (studied.first().map_or(0, |(_, study)| study.errors.len()))
                    " random orders: how far each sum is from the certified value. The red line is the number in print. The "
                    "largest monomial is "
                    @for (i, (_, study)) in studied.iter().enumerate() {
                        @if i > 0 { ", " } (format!("{:.0}", study.cancellation))
                    }
                    " times the sum: that is where the digits go."
                }
            }
        }
        @if !poles.is_empty() {
            h3 { "Its poles" }
            div.scroll { table {
                thead { tr { th { "the factor that vanishes, and the order of the pole" } th { "verdict" } } }
                tbody {
                    @for outcome in poles {
                        tr {
                            td.w { (formula(&outcome.statement, looks)) }
                            td.w { (outcome.word()) ": " (explain(&outcome.verdict, looks)) }
                        }
                    }
                }
            } }
        }
    }
}

fn denominator(found: &ExpandedText) -> String {
    let factor = |(text, power): &(String, u32)| {
        let text = if text.contains(' ') { format!("({text})") } else { text.clone() };
        if *power == 1 { text } else { format!("{text}^{power}") }
    };
    found.denominator.iter().map(factor).collect::<Vec<_>>().join(" ")
}

/// Whether three ways of automatic differentiation agree.
fn ways(found: &WaysAgreement, looks: &Looks) -> Markup {
    let [by_duals, by_series] = found.largest;
    html! {
        p class=[(!found.agree()).then_some("bad")] {
            "Automatic differentiation: num-dual's dual numbers and Taylor series give the graph's Lie derivatives ("
            (found.derivatives) " along "
            @for (place, field) in found.fields.iter().enumerate() { @if place > 0 { ", " } (field_name(field, looks)) }
            ", up to order " (found.order) ") to "
            (format!("{by_duals:.0e}")) " and " (format!("{by_series:.0e}"))
            @if found.too_long > 0 { "; " (found.too_long) " are too long to be compared" }
            "."
        }
    }
}

fn derivatives(found: &DerivativesFound, looks: &Looks) -> Markup {
    html! {
        h3 { "Lie derivatives by two routes" }
        p {
            "The derivatives of the shared expression graph against num-dual's nested dual numbers, which share no rule of "
            "differentiation: " (in_line(&found.output, looks)) " along " (field_name(&found.field, looks)) ", again and again."
        }
        div.grid {
            table {
                thead { tr { th { "order" } th { "largest relative difference" } th { "states" } } }
                tbody { @for route in &found.routes {
                    tr {
                        td.n { (route.order) }
                        td.n { (format!("{:.1e}", route.largest_difference)) }
                        td.n { (route.states) }
                    }
                } }
            }
            figure {
                (PreEscaped(plot::growth(&found.growth, "operations of the graph; grey: order^3")))
                figcaption { "What each further derivative costs; a line of slope three for comparison." }
            }
        }
    }
}
