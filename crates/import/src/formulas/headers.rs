//! Lines such as `states: x, y` that say what formulas do not.

use super::pieces::{signal, symbol};
use crate::expression::Span;
use crate::script::{Dialect, Parser, Syntax, tokens};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::BTreeMap;

/// The headers, each with what it may be called.
const HEADERS: [(&str, &[&str]); 8] = [
    ("title", &["title"]),
    ("source", &["source", "cite"]),
    ("states", &["states", "state"]),
    ("outputs", &["outputs", "output"]),
    ("parameters", &["parameters", "parameter", "unknown parameters"]),
    ("known", &["known", "known parameters", "constants"]),
    ("inputs", &["inputs", "input", "known inputs"]),
    ("unknown inputs", &["unknown inputs", "unknown input"]),
];

/// The text with blanks in place of its headers, and where what they say stands.
pub(super) fn without_headers(text: &str) -> Result<(String, BTreeMap<&'static str, Span>), Problem> {
    let (mut body, mut headers) = (String::new(), BTreeMap::new());
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let header = line.split_once(':').and_then(|(word, rest)| {
            let word = word.trim().trim_start_matches('#').trim().to_lowercase();
            let (name, _) = HEADERS.iter().find(|(_, names)| names.contains(&word.as_str()))?;
            Some((*name, line.len() - rest.len()))
        });
        match header {
            Some((name, from)) => {
                let ours = line[from..].split('#').next().unwrap_or_default();
                if headers.insert(name, at + from..at + from + ours.trim_end().len()).is_some() {
                    return Err(Problem::new(
                        Code::Foreign,
                        &(at..at + line.trim_end().len()),
                        format!("'{name}' is said twice"),
                        "again here",
                    )
                    .help("put all of it into one line"));
                }
                body.extend(line.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
            }
            None => body.push_str(line),
        }
        at += line.len();
    }
    Ok((body, headers))
}

/// The expressions of a header, at their places.
pub(super) fn expressions_in(text: &str, span: &Span, budget: &Budget) -> Result<Vec<Syntax>, Problem> {
    let masked: String = format!("{}{}", " ".repeat(span.start), &text[span.clone()]);
    let (words, _) = tokens(&masked, Dialect::Printed, budget)?;
    let mut parser = Parser::new(&words, Dialect::Printed);
    let mut list = Vec::new();
    while !parser.at_end() {
        list.push(parser.argument()?);
        if !parser.take(",") && !parser.at_end() {
            return Err(parser.unexpected("','"));
        }
    }
    Ok(list)
}

/// A name in a header, and where it stands.
pub(super) type Listed = (String, Span);

pub(super) fn names_in(text: &str, span: Option<&Span>, budget: &Budget) -> Result<Vec<Listed>, Problem> {
    let Some(span) = span else { return Ok(Vec::new()) };
    let list = expressions_in(text, span, budget)?;
    list.iter()
        .map(|one| {
            symbol(one).or_else(|| signal(one)).map(|name| (name, one.span.clone())).ok_or_else(|| {
                Problem::new(Code::Foreign, &one.span, "this is no name", "this")
                    .help("names with commas between them; a value is a line of its own, as in k = 2")
            })
        })
        .collect()
}
