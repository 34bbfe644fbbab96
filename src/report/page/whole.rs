//! The page that the main job writes: one file, with its plots and nothing from elsewhere.

use crate::claim::{Outcome, Verdict};
use crate::paper::{Derivatives, FileFindings, Findings, Numbering, ReductionFound};
use crate::report::claims::outcomes::{error_bound, explanations, special_text, witness_line};
use crate::report::claims::words::{RULE_OF_DAMAGE, counts, errors, meaning};
use crate::report::motion::answers::Observed;
use crate::report::motion::section::observed_section;
use crate::report::page::extremes::extremes;
use crate::report::page::findings::ranks_in_words;
use crate::report::plot;
use crate::report::ranks::answer::fields_text;
use crate::sweep::RankAnswer;
use crate::system::Flaw;
use crate::tradeoff::PrintedExpression;
use crate::tradeoff::Rows;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("../page.css");

/// The page as HTML.
pub fn page(found: &Findings) -> String {
    let outcomes: Vec<&Outcome> = found.outcomes().collect();
    let failed = outcomes.iter().filter(|outcome| !outcome.ok).count();
    let experiments: Vec<Observed<'_>> =
        found.experiments.iter().map(|(experiment, answers)| Observed::of(experiment, answers)).collect();
    let content = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (found.paper.title) ": what holds, and what does not" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "What holds, and what does not" }
                    p {
                        (PreEscaped(found.paper.reference(|title| html! { em { (title) } }.into_string())))
                        @if let Some(source) = &found.paper.source { ", " (source) }
                        ", checked from first principles. "
                        "Each verdict says what stands behind it: " b { "proved" } " is exact arithmetic with the "
                        "probability of an error stated, " b { "refuted" } " a state in exact numbers at which the two "
                        "sides differ, " b { "erratum" } " a printed form refuted and its corrected form proved. "
                        b { "Restated" } " is no proof: the two sides are one expression once names are put in."
                    }
                    ul.tally {
                        @for (word, count) in counts(outcomes.iter().copied()) {
                            li title=(meaning(word)) { b { (count) } " " (word) }
                        }
                        li class=[(failed > 0).then_some("bad")] { b { (failed) } " not as expected" }
                        li { b { (format!("{:.0} s", found.seconds)) } " in all" }
                    }
                    @if found.interrupted { p.bad { "This run was interrupted; it shows what was done until then." } }
                    nav {
                        @if found.paper.numbering.count() > 0 { a href="#equations" { "All equations" } }
                        a href="#errata" { "Errata" }
                        a href="#damage" { "Damage and wording" }
                        @for (i, file) in found.files.iter().enumerate().filter(|(_, file)| has_a_section(file)) {
                            a href=(format!("#file{i}")) { (file.system.title) }
                        }
                        a href="#extremes" { "Speed against accuracy" }
                        @if !experiments.is_empty() { a href="#observers" { "Bodies in motion" } }
                        a href="#claims" { "All claims" }
                    }
                }
                @if found.paper.numbering.count() > 0 { (all_equations(&found.paper.numbering, &outcomes)) }
                (errata(&found.paper.numbering, &outcomes))
                (damage(&found.paper.numbering, &outcomes))
                @for (i, file) in found.files.iter().enumerate().filter(|(_, file)| has_a_section(file)) {
                    (file_section(i, file))
                }
                (extremes(found))
                @if !experiments.is_empty() { (observed_section(&experiments)) }
                (all_claims(&outcomes))
            }
        }
    };
    content.into_string()
}

fn has_a_section(file: &FileFindings) -> bool {
    !file.ranks.is_empty()
        || !file.printed.is_empty()
        || !file.left_out.is_empty()
        || file.derivatives.is_some()
}

fn errata(numbering: &Numbering, outcomes: &[&Outcome]) -> Markup {
    html! {
        section #errata {
            h2 { "Errata" }
            p { "The printed form is refuted by a state that a pocket calculator can check; the corrected form is proved." }
            p { (errors(numbering, outcomes.iter().copied(), Flaw::Erratum).text("erratum")) }
            @for outcome in numbering.in_order(outcomes.iter().copied().filter(|o| o.fault == Some(Flaw::Erratum))) {
                (fault_entry(outcome, Flaw::Erratum))
            }
        }
    }
}

/// A form in the text that does not hold, and the right one.
fn fault_entry(outcome: &Outcome, fault: Flaw) -> Markup {
    let [_, before, between] = fault.keywords();
    html! {
        article class=[(!outcome.ok).then_some("bad")] {
            h3 { (outcome.id) }
            @if let Some(quoted) = &outcome.quoted {
                p.printed { span.label { (before) } code { (quoted) } }
            }
            @if let Some((statement, verdict)) = &outcome.printed {
                p.printed { span.label { @if outcome.quoted.is_some() { "as" } @else { (before) } } code { (statement) } }
                p { span.label { (verdict.word()) } (explain(verdict)) }
                @if let Some(special) = &outcome.printed_at_files_values { p { (special_text(special)) } }
            }
            p.corrected { span.label { (between) } code { (outcome.statement) } }
            p { span.label { (outcome.verdict.word()) } (explain(&outcome.verdict)) }
            @if let Some(special) = &outcome.at_files_values { p { (special_text(special)) } }
            @let lines = explanations(outcome);
            @if !lines.is_empty() {
                details {
                    summary { "what the names mean" }
                    @for line in lines { div { code { (line) } } }
                }
            }
            @if let Some(from) = &outcome.follows { p { "Follows " (from) "." } }
            @if let Some(remark) = &outcome.remark { p.remark { (remark) } }
        }
    }
}

/// One cell for each numbered equation, coloured by its verdict.
fn all_equations(numbering: &Numbering, outcomes: &[&Outcome]) -> Markup {
    let all = numbering.equations(outcomes.iter().copied());
    let mut words: Vec<&str> = all.iter().map(|equation| equation.word()).collect();
    words.sort_unstable();
    words.dedup();
    html! {
        section #equations {
            h2 { "All numbered equations" }
            p.legend {
                @for word in words {
                    span class=(class_of(word)) { (word) } " " (all.iter().filter(|e| e.word() == word).count()) " "
                }
            }
            div.cells {
                @for equation in &all {
                    @let ids = equation.entries.iter().map(|o| format!("{} {}", o.id, o.word())).collect::<Vec<_>>().join("; ");
                    span class=(class_of(equation.word())) title=(ids) { (equation.number) }
                }
            }
        }
    }
}

fn class_of(word: &str) -> String {
    format!("cell {}", word.replace(' ', "-"))
}

/// What is not, or not for sure, the author's mistake.
fn damage(numbering: &Numbering, outcomes: &[&Outcome]) -> Markup {
    html! {
        section #damage {
            h2 { "Damage and wording" }
            p { (RULE_OF_DAMAGE.replace('*', "")) }
            @for fault in Flaw::ALL.into_iter().filter(|fault| *fault != Flaw::Erratum) {
                @let of_kind = numbering.in_order(outcomes.iter().copied().filter(|o| o.fault == Some(fault)));
                @if !of_kind.is_empty() {
                    details {
                        summary { (errors(numbering, outcomes.iter().copied(), fault).text(fault.word())) ": " (meaning(fault.word())) }
                        @for outcome in of_kind { (fault_entry(outcome, fault)) }
                    }
                }
            }
        }
    }
}

fn explain(verdict: &Verdict) -> Markup {
    html! {
        @match verdict {
            Verdict::Proved { engine, log2_error } => {
                (engine)
                @if *log2_error == f64::NEG_INFINITY { "; certain" }
                @else { "; probability of an error below " (error_bound(*log2_error)) }
            }
            Verdict::Refuted { witness, .. } => { (witness_line(witness)) }
            Verdict::Definition { .. } => { "nothing to decide" }
            Verdict::Undecided { why } => { (why) }
        }
    }
}

fn unseen(answer: &RankAnswer, own: bool) -> Vec<String> {
    let mut found = Vec::new();
    for branch in &answer.branches {
        let report = if own { branch.rows.as_ref() } else { Some(&branch.full) };
        for direction in report.into_iter().flat_map(|report| &report.unseen) {
            let text = direction.states.join(", ");
            if !found.contains(&text) {
                found.push(text);
            }
        }
    }
    found
}

/// The words that were needed, branches with the same words together.
fn distinct_words(answer: &RankAnswer) -> Vec<String> {
    let mut found: Vec<String> = answer.branches.iter().map(|branch| branch.words.join(", ")).collect();
    found.dedup();
    found
}

fn reduction(found: &ReductionFound) -> Markup {
    let proved = found.claims.iter().filter(|outcome| outcome.ok).count();
    html! {
        p {
            "This is " em { (found.of) } " where " code { (found.reduction.written.join(", ")) } ": "
            b { (proved) } " of " (found.claims.len()) " statements proved (the conditions stay met, what is left out stays as it "
            "is, fields and differentials are the same). Left out: " (found.left_out.join(", ")) "."
            @if let Some(remark) = &found.reduction.remark { " " (remark) "." }
            @match &found.comparison {
                Ok(c) => {
                    " " (c.small_states) " states instead of " (c.large_states) "; differentials agree to "
                    (format!("{:.0e}", c.largest_difference.max(f64::EPSILON))) " relative. One state's matrix and singular values "
                    "take " b { (format!("{:.1}", c.large_seconds / c.small_seconds)) } " times as long with all states ("
                    (c.large_operations) " operations against " (c.small_operations) ")."
                }
                Err(why) => { " Not counted: " (why) "." }
            }
        }
    }
}

fn file_section(index: usize, file: &FileFindings) -> Markup {
    html! {
        section #(format!("file{index}")) {
            h2 { (file.system.title) }
            @for found in &file.reductions { (reduction(found)) }
            @for left in &file.left_out { p.bad { "Not done: " (left.what) ": " (left.why) } }
            @if !file.ranks.is_empty() { (ranks(file)) }
            @for map in &file.maps {
                figure {
                    div.pair {
                        @for (kind, drawn) in &map.maps {
                            @let title = if *kind == Rows::Own { "the file's own rows" } else { "the full codistribution" };
                            (PreEscaped(plot::map(drawn, title, [None, None])))
                        }
                    }
                    figcaption {
                        b { (map.view.title) ". " }
                        "The smallest singular value (of what remains without unit rows, equilibrated; computed, not certified) over "
                        "two coordinates. "
                        @if let Some(caption) = &map.view.caption { (caption) }
                    }
                }
            }
            @if !file.lines.is_empty() {
                figure {
                    div.grid { @for line in &file.lines { (PreEscaped(plot::slope(&line.slope, &line.view.title, None))) } }
                    figcaption {
                        "The singular values of the file's own rows (of the full codistribution where it has none) along lines; the "
                        "smallest in red. Distances are in the coordinate that moves."
                    }
                }
            }
            @for printed in &file.printed { (printed_numbers(printed, &file.outcomes)) }
            @if let Some(found) = &file.derivatives { (derivatives(found)) }
        }
    }
}

fn ranks(result: &FileFindings) -> Markup {
    html! {
            div.scroll { table {
                thead { tr {
                    th { "states" } th { "sampled" } th { "certified" } th { "rank, full codistribution" } th { "words needed" }
                    th { "not seen" } th { "rank, the file's own rows" } th { "not seen by these" } th { "worst condition" }
                } }
                tbody {
                    @for rank in &result.ranks {
                        tr { td { (rank.name()) @if let Some(set) = &rank.set { br; code { (set.written.join(", ")) } } }
                        @match &rank.found {
                            Ok(answer) => {
                                td.number { (answer.branches.iter().map(|b| b.full.samples).sum::<u64>()) }
                                td.number { (answer.branches.iter().map(|b| b.full.certified).sum::<u64>()) }
                                td { b { (ranks_in_words(answer, false)) } " of " (answer.dimension) }
                                td.words { @for words in distinct_words(answer) { div { (words) } } }
                                td { (unseen(answer, false).join("; ")) }
                                td { b { (ranks_in_words(answer, true)) } }
                                td { (unseen(answer, true).join("; ")) }
                                td.number { (worst(answer)) }
                            }
                            Err(pole) => { td colspan="8" { (pole) } }
                        } }
                    }
                }
            } }
    }
}

fn worst(answer: &RankAnswer) -> String {
    let conditions = answer.branches.iter().filter_map(|b| b.full.worst.as_ref()).map(|(_, s)| s.condition());
    match conditions.fold(None::<f64>, |a, c| Some(a.map_or(c, |a| a.max(c)))) {
        Some(condition) => format!("{condition:.1e}"),
        None => "-".to_owned(),
    }
}

fn printed_numbers(found: &PrintedExpression, outcomes: &[Outcome]) -> Markup {
    let digits = found.values.first().map_or(0, |value| value.carried);
    html! {
            h3 { "Numbers in print: " code { (found.text) } }
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
                            td.words { (value.point) }
                            td.number { (value.printed) }
                            td.number { (value.certified.decimal) }
                            td.number { (value.digits_that_agree) }
                            td.number { (format!("{:+.2e}", value.error)) }
                            @match &value.study {
                                Ok(study) => {
                                    td.number {
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
            @let studied: &[_] = &found.values.iter().filter_map(|v| Some((v, v.study.as_ref().ok()?))).collect::<Vec<_>>();
            @if !studied.is_empty() { figure {
                div.grid {
                    @for (value, study) in studied {
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
            } }
            h3 { "Its poles" }
            table {
                thead { tr { th { "the factor that vanishes, and the order of the pole" } th { "verdict" } } }
                tbody {
                    @for outcome in outcomes.iter().filter(|outcome| outcome.pole_of.as_deref() == Some(found.text.as_str())) {
                        tr {
                            td.words { code { (outcome.statement) } }
                            td.words { (outcome.word()) ": " (explain(&outcome.verdict)) }
                        }
                    }
                }
            }
    }
}

fn denominator(found: &crate::tradeoff::ExpandedText) -> String {
    let factor = |(text, power): &(String, u32)| {
        let text = if text.contains(' ') { format!("({text})") } else { text.clone() };
        if *power == 1 { text } else { format!("{text}^{power}") }
    };
    found.denominator.iter().map(factor).collect::<Vec<_>>().join(" ")
}

fn derivatives(found: &Derivatives) -> Markup {
    html! {
            h3 { "Lie derivatives by two routes" }
            p {
                "The derivatives of the shared expression graph against num-dual's nested dual numbers, which share no rule of "
                "differentiation: " (found.output) " along " (found.field) ", again and again."
            }
            div.pair {
                table {
                    thead { tr { th { "order" } th { "largest relative difference" } th { "states" } } }
                    tbody { @for route in &found.routes {
                        tr {
                            td.number { (route.order) }
                            td.number { (format!("{:.1e}", route.largest_difference)) }
                            td.number { (route.states) }
                        }
                    } }
                }
                (PreEscaped(plot::growth(&found.growth, "operations of the graph; grey: order^3")))
            }
    }
}

fn all_claims(outcomes: &[&Outcome]) -> Markup {
    html! {
        section #claims {
            h2 { "All claims" }
            div.scroll { table {
                thead { tr { th { "file" } th { "id" } th { "verdict" } th { "statement" } th { "what stands behind it" } } }
                tbody {
                    @for outcome in outcomes {
                        tr class=[(!outcome.ok).then_some("bad")] {
                            td { (outcome.file.rsplit('/').next().unwrap_or_default()) }
                            td { (outcome.id) }
                            td { (outcome.word()) }
                            td.words { code { (outcome.statement) } @if let Some(remark) = &outcome.remark { p.remark { (remark) } } }
                            td.words {
                                (explain(&outcome.verdict))
                                @if let Some(special) = &outcome.at_files_values { p { (special_text(special)) } }
                                @if !outcome.fields.is_empty() { p { (fields_text(&outcome.fields)) } }
                            }
                        }
                    }
                }
            } }
        }
    }
}
