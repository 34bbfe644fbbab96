//! MathML, for a page: presentation elements of the Core, which browsers set without a script and without a font to load.

use super::name::{greek, runs};
use super::{Fence, Formula, FormulaName, FormulaSign};
use crate::expression::syntax::Relation;

/// A formula as one element.
pub fn mathml(formula: &Formula) -> String {
    let mut out = String::from("<math>");
    write(formula, &mut out);
    out.push_str("</math>");
    out
}

/// A formula as elements between which a line may break: behind the relations, signs and commas that stand in no bracket.
pub fn mathml_in_pieces(formula: &Formula) -> String {
    let Formula::Row(parts) = formula else { return mathml(formula) };
    let breaks = |part: &Formula| {
        matches!(
            part,
            Formula::Sign(
                FormulaSign::Plus
                    | FormulaSign::Minus
                    | FormulaSign::Comma
                    | FormulaSign::Relation(_)
                    | FormulaSign::In
            )
        )
    };
    let mut pieces = Vec::new();
    let mut piece = String::new();
    let mut finish = |piece: &mut String| {
        if !piece.is_empty() {
            pieces.push(format!("<math>{piece}</math>"));
            piece.clear();
        }
    };
    for part in parts {
        let is_text = matches!(part, Formula::Text(_));
        if is_text {
            finish(&mut piece);
        }
        write(part, &mut piece);
        if is_text || breaks(part) {
            finish(&mut piece);
        }
    }
    finish(&mut piece);
    pieces.join(" ")
}

fn write(formula: &Formula, out: &mut String) {
    match formula {
        Formula::Number(digits) => element("mn", digits, out),
        Formula::Name(name) => write_name(name, None, out),
        Formula::Word("d") => out.push_str("<mi mathvariant=\"normal\">d</mi>"),
        Formula::Word(word) => element("mi", word, out),
        Formula::Literal(text) => element("mtext", text, out),
        Formula::Text(text) => element("mtext", text, out),
        Formula::Sign(sign) => out.push_str(sign_of(*sign)),
        Formula::Row(parts) => parts.iter().for_each(|part| write(part, out)),
        Formula::Fraction(top, bottom) => {
            out.push_str("<mfrac>");
            one(top, out);
            one(bottom, out);
            out.push_str("</mfrac>");
        }
        Formula::Scripts { base, below, above } => match (&**base, below, above) {
            (Formula::Name(name), None, Some(above)) => write_name(name, Some(above), out),
            (base, below, above) => {
                let tag = match (below, above) {
                    (Some(_), Some(_)) => "msubsup",
                    (Some(_), None) => "msub",
                    _ => "msup",
                };
                out.push_str(&format!("<{tag}>"));
                one(base, out);
                [below, above].into_iter().flatten().for_each(|script| one(script, out));
                out.push_str(&format!("</{tag}>"));
            }
        },
        Formula::Root(inner) => {
            out.push_str("<msqrt>");
            write(inner, out);
            out.push_str("</msqrt>");
        }
        Formula::Fence(fence, inner) => {
            let [open, close] = match fence {
                Fence::Round => ["(", ")"],
                Fence::Square => ["[", "]"],
                Fence::Bars => ["|", "|"],
            };
            out.push_str(&format!("<mrow><mo>{open}</mo>"));
            write(inner, out);
            out.push_str(&format!("<mo>{close}</mo></mrow>"));
        }
        Formula::Matrix(rows) => {
            out.push_str("<mrow><mo>[</mo><mtable>");
            for row in rows {
                out.push_str("<mtr>");
                for entry in row {
                    out.push_str("<mtd>");
                    write(entry, out);
                    out.push_str("</mtd>");
                }
                out.push_str("</mtr>");
            }
            out.push_str("</mtable><mo>]</mo></mrow>");
        }
    }
}

/// Exactly one element.
fn one(formula: &Formula, out: &mut String) {
    match formula {
        Formula::Row(parts) if parts.len() == 1 => one(&parts[0], out),
        Formula::Row(parts) => {
            out.push_str("<mrow>");
            parts.iter().for_each(|part| write(part, out));
            out.push_str("</mrow>");
        }
        Formula::Name(name) if !name.from.is_empty() => {
            out.push_str("<mrow>");
            write_name(name, None, out);
            out.push_str("</mrow>");
        }
        other => write(other, out),
    }
}

fn element(tag: &str, text: &str, out: &mut String) {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    out.push_str(&format!("<{tag}>{text}</{tag}>"));
}

/// A name, perhaps with an exponent, which then stands above its index.
fn write_name(name: &FormulaName, above: Option<&Formula>, out: &mut String) {
    for from in &name.from {
        element("mtext", &format!("{from}."), out);
    }
    let tag = match (name.index.is_empty(), above) {
        (true, None) => None,
        (true, Some(_)) => Some("msup"),
        (false, None) => Some("msub"),
        (false, Some(_)) => Some("msubsup"),
    };
    if let Some(tag) = tag {
        out.push_str(&format!("<{tag}>"));
    }
    name.accents.iter().for_each(|_| out.push_str("<mover>"));
    letters(&name.letters, out);
    for accent in &name.accents {
        out.push_str(&format!("<mo>{}</mo></mover>", accent.character()));
    }
    if !name.index.is_empty() {
        let runs: Vec<Vec<&str>> = name.index.iter().map(|part| runs(part)).collect();
        let several = runs.iter().flatten().count() > 1;
        out.push_str(if several { "<mrow>" } else { "" });
        for (place, part) in runs.iter().enumerate() {
            if place > 0 {
                out.push_str(sign_of(FormulaSign::IndexComma));
            }
            for run in part {
                match run.starts_with(|c: char| c.is_ascii_digit()) {
                    true => element("mn", run, out),
                    false => letters(run, out),
                }
            }
        }
        out.push_str(if several { "</mrow>" } else { "" });
    }
    if let Some(above) = above {
        one(above, out);
    }
    if let Some(tag) = tag {
        out.push_str(&format!("</{tag}>"));
    }
}

fn letters(letters: &str, out: &mut String) {
    match greek(letters) {
        Some((letter, _)) => element("mi", &letter.to_string(), out),
        None => element("mi", letters, out),
    }
}

fn sign_of(sign: FormulaSign) -> &'static str {
    match sign {
        FormulaSign::Plus => "<mo>+</mo>",
        FormulaSign::Minus | FormulaSign::Negative => "<mo>−</mo>",
        FormulaSign::Dot => "<mo>·</mo>",
        FormulaSign::Cross => "<mo>×</mo>",
        FormulaSign::Thin => "<mspace width=\".2em\"/>",
        FormulaSign::Comma => "<mo>,</mo>",
        FormulaSign::IndexComma => "<mo rspace=\"0\">,</mo>",
        FormulaSign::In => "<mo>∈</mo>",
        FormulaSign::At => "<mo>|</mo>",
        FormulaSign::Partial => "<mo>∂</mo>",
        FormulaSign::Transpose => "<mi mathvariant=\"normal\">T</mi>",
        FormulaSign::Relation(relation) => match relation {
            Relation::Equal => "<mo>=</mo>",
            Relation::NotEqual => "<mo>≠</mo>",
            Relation::Less => "<mo>&lt;</mo>",
            Relation::AtMost => "<mo>≤</mo>",
            Relation::Greater => "<mo>&gt;</mo>",
            Relation::AtLeast => "<mo>≥</mo>",
        },
    }
}
