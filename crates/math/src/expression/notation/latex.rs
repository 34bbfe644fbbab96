//! LaTeX, for a paper: what `amsmath` sets, without its dollar signs.

use super::name::{greek, runs};
use super::{Fence, Formula, FormulaName, FormulaSign};
use crate::expression::syntax::Relation;

/// A formula in LaTeX.
pub fn latex(formula: &Formula) -> String {
    let mut out = String::new();
    write(formula, &mut out);
    out.trim_end().to_owned()
}

/// Puts text behind text: a command and a letter are kept apart.
fn put(out: &mut String, text: &str) {
    let letters = out.len() - out.trim_end_matches(|c: char| c.is_ascii_alphabetic()).len();
    let is_command = letters > 0 && out[..out.len() - letters].ends_with('\\');
    if is_command && text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        out.push(' ');
    }
    out.push_str(text);
}

fn group(formula: &Formula, out: &mut String) {
    out.push('{');
    write(formula, out);
    out.push('}');
}

fn write(formula: &Formula, out: &mut String) {
    match formula {
        Formula::Number(digits) => put(out, digits),
        Formula::Name(name) => write_name(name, out),
        Formula::Word(word) => put(out, &word_of(word)),
        Formula::Literal(text) => put(out, &format!("\\mathtt{{{}}}", text.replace('_', "\\_"))),
        Formula::Text(text) => put(out, &format!("\\ \\text{{{text}}}\\ ")),
        Formula::Sign(sign) => put(out, sign_of(*sign)),
        Formula::Row(parts) => {
            for (place, part) in parts.iter().enumerate() {
                // LaTeX leaves room around the words of functions by itself
                let beside =
                    [place.checked_sub(1).and_then(|before| parts.get(before)), parts.get(place + 1)];
                let is_room = *part == Formula::Sign(FormulaSign::Thin);
                if !(is_room && beside.into_iter().flatten().any(has_room)) {
                    write(part, out);
                }
            }
        }
        Formula::Fraction(top, bottom) => {
            put(out, "\\frac");
            group(top, out);
            group(bottom, out);
        }
        Formula::Scripts { base, below, above } => {
            match &**base {
                Formula::Name(name) if below.is_none() && above.is_some() => write_name(name, out),
                Formula::Name(_) | Formula::Word(_) | Formula::Number(_) | Formula::Literal(_) => {
                    write(base, out)
                }
                Formula::Row(parts) if parts.last() == Some(&Formula::Sign(FormulaSign::At)) => {
                    put(out, "\\left.");
                    parts[..parts.len() - 1].iter().for_each(|part| write(part, out));
                    put(out, "\\right|");
                }
                Formula::Fence(..) | Formula::Matrix(_) => write(base, out),
                _ => group(base, out),
            }
            for (mark, script) in [("_", below), ("^", above)] {
                if let Some(script) = script {
                    out.push_str(mark);
                    group(script, out);
                }
            }
        }
        Formula::Root(inner) => {
            put(out, "\\sqrt");
            group(inner, out);
        }
        Formula::Fence(fence, inner) => {
            let [open, close] = match fence {
                Fence::Round => ["\\left(", "\\right)"],
                Fence::Square => ["\\left[", "\\right]"],
                Fence::Bars => ["\\left|", "\\right|"],
            };
            put(out, open);
            write(inner, out);
            put(out, close);
        }
        Formula::Matrix(rows) => {
            put(out, "\\begin{bmatrix}");
            for (place, row) in rows.iter().enumerate() {
                if place > 0 {
                    out.push_str(" \\\\ ");
                }
                for (place, entry) in row.iter().enumerate() {
                    if place > 0 {
                        out.push_str(" & ");
                    }
                    write(entry, out);
                }
            }
            out.push_str("\\end{bmatrix}");
        }
    }
}

/// A function's word, perhaps with an exponent.
fn has_room(formula: &Formula) -> bool {
    match formula {
        Formula::Word(word) => *word != "d",
        Formula::Scripts { base, .. } => has_room(base),
        _ => false,
    }
}

fn write_name(name: &FormulaName, out: &mut String) {
    for from in &name.from {
        put(out, &format!("\\mathrm{{{}}}.", from.replace('_', "\\_")));
    }
    let mut letters = match greek(&name.letters) {
        Some((_, latex)) => latex.to_owned(),
        None if name.letters.len() == 1 => name.letters.clone(),
        None => format!("\\mathrm{{{}}}", name.letters),
    };
    for accent in &name.accents {
        letters = format!("{}{{{letters}}}", accent.latex());
    }
    put(out, &letters);
    if !name.index.is_empty() {
        let mut index = String::new();
        for (place, part) in name.index.iter().enumerate() {
            if place > 0 {
                index.push(',');
            }
            for run in runs(part) {
                match greek(run) {
                    Some((_, latex)) => put(&mut index, latex),
                    None if run.len() > 1 && !run.starts_with(|c: char| c.is_ascii_digit()) => {
                        put(&mut index, &format!("\\mathrm{{{run}}}"));
                    }
                    None => put(&mut index, run),
                }
            }
        }
        out.push_str(&format!("_{{{index}}}"));
    }
}

fn word_of(word: &str) -> String {
    match word {
        "d" => "\\mathrm{d}".to_owned(),
        "rank" | "pole" | "sgn" | "atan2" | "solutions" | "observable" | "unobservable" | "identifiable"
        | "unidentifiable" => format!("\\operatorname{{{word}}}"),
        _ => format!("\\{word}"),
    }
}

fn sign_of(sign: FormulaSign) -> &'static str {
    match sign {
        FormulaSign::Plus => " + ",
        FormulaSign::Minus => " - ",
        FormulaSign::Negative => "-",
        FormulaSign::Dot => " \\cdot ",
        FormulaSign::Cross => " \\times ",
        FormulaSign::Thin => "\\,",
        FormulaSign::Comma => ", ",
        FormulaSign::IndexComma => ",",
        FormulaSign::In => " \\in ",
        FormulaSign::At => "|",
        FormulaSign::Partial => "\\partial",
        FormulaSign::Transpose => "\\mathsf{T}",
        FormulaSign::Relation(relation) => match relation {
            Relation::Equal => " = ",
            Relation::NotEqual => " \\neq ",
            Relation::Less => " < ",
            Relation::AtMost => " \\leq ",
            Relation::Greater => " > ",
            Relation::AtLeast => " \\geq ",
        },
    }
}
