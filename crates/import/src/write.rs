//! A foreign model as a proof file.

use super::cases::{Uncased, written_out};
use super::model::{ForeignConstant, ForeignModel};
use super::names::ForeignNames;
use super::print::text;
use palmistry_io::foreign::Budget;
use palmistry_lang::Problem;
use palmistry_math::expression::parse::ends_a_line;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Lines are broken where they are longer than this.
const WIDTH: usize = 110;

/// The text of a proof file, and what was renamed: foreign names and ours.
pub(super) struct ProofText {
    pub text: String,
    pub renamed: Vec<(String, String)>,
}

/// One line without what ends lines, quotes texts or turns the direction of writing.
fn plain(text: &str) -> String {
    let bad = |c: char| {
        ends_a_line(c)
            || c.is_control()
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{61c}')
    };
    let spaced: String = text.chars().map(|c| if bad(c) { ' ' } else { c }).collect();
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", plain(text).replace('"', "'"))
}

/// A list of names behind a word, in lines that are not too long.
fn listed(out: &mut String, word: &str, names: &[String]) {
    let mut line = String::new();
    for (at, name) in names.iter().enumerate() {
        let comma = if at + 1 < names.len() { "," } else { "" };
        if !line.is_empty() && word.len() + line.len() + name.len() + 2 > WIDTH {
            let _ = writeln!(out, "{word} {}", line.trim_end_matches([',', ' ']));
            line.clear();
        }
        let _ = write!(line, "{name}{comma} ");
    }
    if !line.is_empty() {
        let _ = writeln!(out, "{word} {}", line.trim_end_matches([',', ' ']));
    }
}

/// A long formula in several lines, broken before a term.
fn broken(text: &str, begin: usize) -> String {
    if begin + text.len() <= WIDTH {
        return text.to_owned();
    }
    let (mut out, mut line) = (String::new(), begin);
    for piece in text.split_inclusive(' ').collect::<Vec<_>>() {
        let is_sign = matches!(piece, "+ " | "- ");
        if is_sign && line > WIDTH * 2 / 3 {
            let _ = write!(out, "\n{}", " ".repeat(begin.min(12)));
            line = begin.min(12);
        }
        out.push_str(piece);
        line += piece.len();
    }
    out.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

/// Constants in the order of the file, those without a value first, by what is known of them.
fn constants(
    out: &mut String,
    list: &[&ForeignConstant],
    names: &ForeignNames,
    unknown: bool,
    budget: &Budget,
) -> Result<(), Problem> {
    let of_kind = || list.iter().filter(|constant| constant.is_unknown == unknown);
    let without: Vec<String> =
        of_kind().filter(|c| c.value.is_none()).map(|c| names.ours(&c.name).to_owned()).collect();
    if unknown {
        // the word behind the last name of a line is for all of it
        let mut lines = String::new();
        listed(&mut lines, "param", &without);
        for line in lines.lines() {
            let _ = writeln!(out, "{line} unknown");
        }
    } else {
        listed(out, "param", &without);
    }
    for constant in of_kind() {
        if let Some(value) = &constant.value {
            let number = super::expression::ForeignExpr::new(
                super::expression::ForeignKind::Number(value.clone()),
                &(0..0),
            );
            let word = if unknown { " unknown" } else { "" };
            let _ = writeln!(
                out,
                "param {} = {}{word}",
                names.ours(&constant.name),
                text(&number, names, budget)?
            );
        }
    }
    Ok(())
}

/// Writes a model. `origin` says briefly what was imported, and goes into the citation.
pub(super) fn proof_text(model: &ForeignModel, origin: &str, budget: &Budget) -> Result<ProofText, Problem> {
    let Uncased { model, has_sign } = &written_out(model, budget)?;
    let mut all = model.all_names();
    all.extend(model.outputs.iter().filter_map(|output| output.name.clone()));
    let mut names = ForeignNames::of(all.iter().map(String::as_str));
    let drift = names.free("f");
    let mut out = String::new();
    for remark in &model.remarks {
        let _ = writeln!(out, "# {}", plain(remark));
    }
    let renamed: Vec<(String, String)> =
        names.renamed().map(|(foreign, ours)| (foreign.to_owned(), ours.to_owned())).collect();
    if !renamed.is_empty() {
        let list: Vec<String> =
            renamed.iter().map(|(foreign, ours)| format!("{} -> {ours}", plain(foreign))).collect();
        for line in list.chunks(8) {
            let _ = writeln!(out, "# renamed: {}", line.join(", "));
        }
    }
    let title = model.title.as_deref().map(plain).filter(|title| !title.is_empty());
    let source = match &model.source {
        Some(source) if !plain(source).is_empty() => format!("{} ({origin})", plain(source)),
        _ => origin.to_owned(),
    };
    let _ =
        writeln!(out, "system {}  cite {}\n", quoted(title.as_deref().unwrap_or(origin)), quoted(&source));

    let states: Vec<String> = model.states.iter().map(|state| names.ours(&state.name).to_owned()).collect();
    listed(&mut out, "state", &states);
    let list: Vec<&ForeignConstant> = model.constants.iter().collect();
    constants(&mut out, &list, &names, true, budget)?;
    constants(&mut out, &list, &names, false, budget)?;
    let signals =
        |list: &[String]| list.iter().map(|name| format!("{}(t)", names.ours(name))).collect::<Vec<_>>();
    listed(&mut out, "known", &signals(&model.known_inputs));
    listed(&mut out, "unknown", &signals(&model.unknown_inputs));
    if *has_sign {
        out.push_str(
            "# cases are written by sign(x): where x is zero, on a thin set, they have no value here\n",
        );
    }
    out.push('\n');
    for (name, value) in &model.definitions {
        let name = names.ours(name);
        let _ = writeln!(out, "let {name} = {}", broken(&text(value, &names, budget)?, name.len() + 7));
    }
    if !model.definitions.is_empty() {
        out.push('\n');
    }
    let _ = writeln!(out, "drift {drift}");
    let widest = states.iter().map(String::len).max().unwrap_or(0);
    for (state, name) in model.states.iter().zip(&states) {
        let mark = if model.is_discrete { '+' } else { '\'' };
        let rate = broken(&text(&state.rate, &names, budget)?, widest + 6);
        let _ = writeln!(out, "  {:<width$} = {rate}", format!("{name}{mark}"), width = widest + 1);
    }
    out.push('\n');
    outputs(&mut out, model, &names, budget)?;
    for (name, value) in &model.initial_values {
        let what = match value {
            Some(value) => format!("initial {} = {}", names.ours(name), text(value, &names, budget)?),
            None => format!("initial {} known", names.ours(name)),
        };
        let _ = writeln!(out, "# {what}");
    }
    Ok(ProofText { text: out, renamed })
}

/// Outputs: a name by itself, and whatever is more than that under the name that it has in the file.
fn outputs(
    out: &mut String,
    model: &ForeignModel,
    names: &ForeignNames,
    budget: &Budget,
) -> Result<(), Problem> {
    let (mut list, mut defined) = (Vec::new(), BTreeSet::new());
    let taken: BTreeSet<String> = model.all_names().into_iter().collect();

    for output in &model.outputs {
        let value = text(&output.value, names, budget)?;
        match &output.name {
            Some(name)
                if !value.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && !taken.contains(name) =>
            {
                let ours = names.ours(name);
                if defined.insert(name.clone()) {
                    let _ = writeln!(out, "let {ours} = {}", broken(&value, ours.len() + 7));
                }
                list.push(ours.to_owned());
            }
            _ => list.push(value),
        }
    }
    if list.iter().any(|value| value.contains(' ') || value.len() > 40) {
        list.iter().for_each(|value| {
            let _ = writeln!(out, "output {}", broken(value, 7));
        });
    } else {
        listed(out, "output", &list);
    }
    Ok(())
}
