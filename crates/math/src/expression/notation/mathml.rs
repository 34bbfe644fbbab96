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

/// Pieces are put together up to this many letters and signs: a narrow screen has room for them.
const PIECE: usize = 28;

/// A formula as elements between which a line may break: behind the relations, signs and commas that stand in no bracket. Words
/// stand between them.
pub fn mathml_in_pieces(formula: &Formula) -> String {
    let Formula::Row(parts) = formula else { return mathml(formula) };
    let mut written = Vec::new();
    for run in parts.chunk_by(|a, b| !is_text(a) && !is_text(b)) {
        match &run[0] {
            Formula::Text(words) => written.push((*words).to_owned()),
            _ => written.extend(pieces(run).into_iter().map(|piece| {
                let mut text = String::from("<math>");
                write_row(piece, &mut text);
                text + "</math>"
            })),
        }
    }
    written.join(" ")
}

fn is_text(part: &Formula) -> bool {
    matches!(part, Formula::Text(_))
}

/// A row cut where a line may break, into as few pieces as narrow screens have room for.
fn pieces(row: &[Formula]) -> Vec<&[Formula]> {
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
    let mut found = Vec::new();
    let (mut begin, mut end, mut letters) = (0, 0, 0);
    for stretch in row.split_inclusive(breaks) {
        let mut text = String::new();
        write_row(stretch, &mut text);
        let more = letters_of(&text);
        if letters + more > PIECE && end > begin {
            found.push(&row[begin..end]);
            (begin, letters) = (end, 0);
        }
        (end, letters) = (end + stretch.len(), letters + more);
    }
    found.push(&row[begin..end]);
    found
}

/// How many letters and signs an element shows.
fn letters_of(element: &str) -> usize {
    element.split('<').map(|part| part.rsplit('>').next().unwrap_or_default().chars().count()).sum()
}

/// Parts side by side.
fn write_row(parts: &[Formula], out: &mut String) {
    // brackets grow with what stands beside them, unless they are a group of their own; where nothing is high they need none
    let is_flat = parts.iter().all(is_flat);
    let mut rest = parts;
    while let [part, others @ ..] = rest {
        rest = others;
        match (part, others) {
            // room around words belongs to the word, and the minus of a number to the number: one element where two would say the same
            (Formula::Word(word), [Formula::Sign(FormulaSign::Thin), others @ ..]) if *word != "d" => {
                element("mi", &format!("{word}{THIN}"), out);
                rest = others;
            }
            (Formula::Sign(FormulaSign::Negative), [Formula::Number(digits), others @ ..]) => {
                element("mn", &format!("−{digits}"), out);
                rest = others;
            }
            // behind another sign it would stand between two
            (Formula::Sign(FormulaSign::Negative), _) if others.len() + 1 < parts.len() => {
                out.push_str("<mo form=\"prefix\">−</mo>");
            }
            (Formula::Fence(Fence::Round, inner), _) if is_flat => {
                out.push_str("<mo>(</mo>");
                write(inner, out);
                out.push_str("<mo>)</mo>");
            }
            _ => write(part, out),
        }
    }
}

/// A narrow space.
const THIN: char = '\u{2009}';

/// Not higher than letters with their indices and exponents.
fn is_flat(formula: &Formula) -> bool {
    match formula {
        Formula::Fraction(..) | Formula::Root(_) | Formula::Matrix(_) | Formula::Sign(FormulaSign::At) => {
            false
        }
        Formula::Row(parts) => parts.iter().all(is_flat),
        Formula::Fence(_, inner) => is_flat(inner),
        Formula::Scripts { base, below, above } => {
            is_flat(base) && [below, above].into_iter().flatten().all(|script| is_flat(script))
        }
        _ => true,
    }
}

fn write(formula: &Formula, out: &mut String) {
    match formula {
        Formula::Number(digits) => element("mn", digits, out),
        Formula::Name(name) => write_name(name, None, out),
        Formula::Word("d") => element("mtext", "d", out),
        Formula::Word(word) => element("mi", word, out),
        Formula::Literal(text) => element("mtext", text, out),
        Formula::Text(text) => element("mtext", text, out),
        Formula::Sign(sign) => out.push_str(sign_of(*sign)),
        Formula::Row(parts) => write_row(parts, out),
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
        Formula::Row(parts)
            if matches!(parts[..], [Formula::Sign(FormulaSign::Negative), Formula::Number(_)]) =>
        {
            write_row(parts, out);
        }
        Formula::Row(parts) => {
            out.push_str("<mrow>");
            write_row(parts, out);
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
    let symbol = name.symbol();
    let tag = match (name.index.is_empty() || symbol.is_some(), above) {
        (true, None) => None,
        (true, Some(_)) => Some("msup"),
        (false, None) => Some("msub"),
        (false, Some(_)) => Some("msubsup"),
    };
    if let Some(tag) = tag {
        out.push_str(&format!("<{tag}>"));
    }
    match symbol {
        // one element where several would say the same: a page has thousands of them
        Some(symbol) => element("mi", &symbol, out),
        None => write_parts(name, out),
    }
    if let Some(above) = above {
        one(above, out);
    }
    if let Some(tag) = tag {
        out.push_str(&format!("</{tag}>"));
    }
}

/// The letters of a name with its accents, and its index.
fn write_parts(name: &FormulaName, out: &mut String) {
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
        FormulaSign::Thin => "<mi>\u{2009}</mi>",
        FormulaSign::Comma => "<mo>,</mo>",
        FormulaSign::IndexComma => "<mtext>,</mtext>",
        FormulaSign::In => "<mo>∈</mo>",
        FormulaSign::At => "<mo>|</mo>",
        FormulaSign::Partial => "<mo>∂</mo>",
        FormulaSign::Transpose => "<mtext>T</mtext>",
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
