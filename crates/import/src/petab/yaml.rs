//! The file that names a problem's tables: YAML of mappings, lists and texts.

use palmistry_lang::{Code, Problem};
use saphyr_parser::{Event, Parser, ScanError};
use std::collections::BTreeMap;

/// Deeper files name no tables.
const DEEPEST: usize = 20;

/// A value. Numbers are the texts that are written.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Yaml {
    Text(String),
    List(Vec<Yaml>),
    Map(BTreeMap<String, Yaml>),
}

impl Yaml {
    /// Reads the first document.
    ///
    /// # Errors
    /// Where it is no YAML, has references (by which a short text may mean a very long one), or is too deep.
    pub fn read(text: &str) -> Result<Yaml, Problem> {
        let mut parser = Parser::new_from_str(text);
        loop {
            match next(&mut parser)? {
                Event::StreamStart | Event::DocumentStart(_) | Event::Nothing => {}
                Event::StreamEnd => return Ok(Yaml::Map(BTreeMap::new())),
                event => return value(&mut parser, event, 0),
            }
        }
    }

    /// The entry of a mapping.
    pub fn get(&self, key: &str) -> Option<&Yaml> {
        match self {
            Yaml::Map(entries) => entries.get(key),
            _ => None,
        }
    }

    /// The text that it is.
    pub fn text(&self) -> Option<&str> {
        match self {
            Yaml::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The texts of a list, or one text as a list; none where it is anything else.
    pub fn texts(&self) -> Option<Vec<String>> {
        match self {
            Yaml::Text(text) => Some(vec![text.clone()]),
            Yaml::List(list) => list.iter().map(|one| one.text().map(str::to_owned)).collect(),
            Yaml::Map(_) => None,
        }
    }
}

fn wrong(message: String) -> Problem {
    Problem::new(Code::ForeignText, &(0..1), message, "the file")
        .help("PEtab 1.0 names parameter_file and problems")
}

fn unread(why: &ScanError) -> Problem {
    wrong(format!("this is no YAML: {why}"))
}

fn next<'t>(parser: &mut Parser<'t, saphyr_parser::StrInput<'t>>) -> Result<Event<'t>, Problem> {
    match parser.next_event() {
        None => Ok(Event::StreamEnd),
        Some(Ok((event, _))) => Ok(event),
        Some(Err(why)) => Err(unread(&why)),
    }
}

fn value<'t>(
    parser: &mut Parser<'t, saphyr_parser::StrInput<'t>>,
    event: Event<'t>,
    depth: usize,
) -> Result<Yaml, Problem> {
    if depth > DEEPEST {
        return Err(wrong("the file is nested too deeply".to_owned()));
    }
    match event {
        Event::Scalar(text, ..) => Ok(Yaml::Text(text.into_owned())),
        Event::SequenceStart(..) => {
            let mut list = Vec::new();
            loop {
                match next(parser)? {
                    Event::SequenceEnd => return Ok(Yaml::List(list)),
                    event => list.push(value(parser, event, depth + 1)?),
                }
            }
        }
        Event::MappingStart(..) => {
            let mut entries = BTreeMap::new();
            loop {
                let key = match next(parser)? {
                    Event::MappingEnd => return Ok(Yaml::Map(entries)),
                    event => value(parser, event, depth + 1)?,
                };
                let Yaml::Text(key) = key else { return Err(wrong("a key is no text".to_owned())) };
                let event = next(parser)?;
                let entry = value(parser, event, depth + 1)?;
                entries.insert(key, entry);
            }
        }
        Event::Alias(_) => Err(wrong("the file has a reference (*), and none is read".to_owned())),
        _ => Err(wrong("the file ends within a value".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mappings_lists_and_texts_are_read() {
        let text = "format_version: 1\nparameter_file: p.tsv\nproblems:\n- sbml_files: [m.xml]\n  condition_files:\n  - 'c 1.tsv'\n";
        let found = Yaml::read(text).unwrap();
        assert_eq!(found.get("format_version").and_then(Yaml::text), Some("1"));
        assert_eq!(found.get("parameter_file").unwrap().texts(), Some(vec!["p.tsv".to_owned()]));
        let Some(Yaml::List(problems)) = found.get("problems") else { panic!("{found:?}") };
        assert_eq!(problems[0].get("condition_files").unwrap().texts(), Some(vec!["c 1.tsv".to_owned()]));
        assert_eq!(Yaml::read("").unwrap(), Yaml::Map(BTreeMap::new()));
    }

    /// A short text that would mean a billion of them is refused, and so is what is no YAML or has no end.
    #[test]
    fn references_depth_and_rubbish_are_refused() {
        for text in [
            "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n".to_owned(),
            "a: &a\n  b: *a\n".to_owned(),
            "[".repeat(100_000),
            "{".repeat(100_000),
            "a: [b".to_owned(),
            "? [a]\n: b\n".to_owned(),
            "- ".repeat(10_000),
        ] {
            assert!(Yaml::read(&text).is_err(), "{:.40}", text);
        }
    }
}
