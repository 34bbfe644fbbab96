//! As much of a TextMate grammar's interpreter as ours needs: `match` with captures, `begin` and `end`, `include`, line by line.
//! The regular expressions are regex-lite's, which has no look-ahead: ours stand at ends only, and are matched as groups.

use regex_lite::Regex;
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

enum Rule {
    Match { pattern: Pattern, name: String, captures: Vec<Capture> },
    Span { begin: Pattern, end: Pattern, name: String, captures: Vec<Capture>, inner: Vec<Rc<Rule>> },
}

struct Capture {
    group: usize,
    name: String,
    inner: Vec<Rc<Rule>>,
}

struct Pattern {
    regex: Regex,
    has_ahead: bool,
}

impl Pattern {
    fn new(text: &str) -> Pattern {
        let (text, has_ahead) = match text.split_once("(?=") {
            Some((before, ahead)) => {
                assert!(ahead.ends_with(')') && !ahead.contains("(?="), "one look-ahead, at the end: {text}");
                (format!("{before}(?P<ahead>{ahead}"), true)
            }
            None => (text.to_owned(), false),
        };
        assert!(!["(?!", "(?<!", "(?<="].iter().any(|form| text.contains(form)), "{text}");
        Pattern { regex: Regex::new(&text).unwrap_or_else(|error| panic!("{text}: {error}")), has_ahead }
    }

    /// The places of the match from a byte on, and of its groups.
    fn find(&self, line: &str, at: usize) -> Option<Vec<Option<(usize, usize)>>> {
        let found = self.regex.captures_at(line, at)?;
        let mut groups: Vec<_> =
            found.iter().map(|group| group.map(|group| (group.start(), group.end()))).collect();
        if self.has_ahead {
            let (start, _) = groups[0].expect("a match");
            groups[0] = found.name("ahead").map(|ahead| (start, ahead.start()));
        }
        Some(groups)
    }
}

/// A grammar that is read.
pub struct Grammar {
    rules: Vec<Rc<Rule>>,
}

impl Grammar {
    pub fn read(path: &Path) -> Grammar {
        let text = std::fs::read_to_string(path).expect("the grammar");
        let grammar: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(grammar["scopeName"], "source.palmistry");
        let mut known = HashMap::new();
        let used = rules(&grammar["patterns"], &grammar["repository"], &mut known);
        let all = grammar["repository"].as_object().expect("a repository").len();
        assert_eq!(known.len(), all, "every part is used");
        Grammar { rules: used }
    }

    /// The scopes of each byte of a text, from the outermost to the innermost.
    pub fn scopes(&self, text: &str) -> Vec<String> {
        let mut scopes = vec![String::new(); text.len()];
        let mut open: Vec<Rc<Rule>> = Vec::new();
        let mut begin = 0;
        for line in text.split_inclusive('\n') {
            let content = line.trim_end_matches(['\n', '\r']);
            scan(
                &self.rules,
                &mut open,
                content,
                &mut scopes[begin..begin + content.len()],
                (0, content.len()),
            );
            begin += line.len();
        }
        scopes
    }
}

fn rules(list: &Value, repository: &Value, known: &mut HashMap<String, Vec<Rc<Rule>>>) -> Vec<Rc<Rule>> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let mut found = Vec::new();
    for value in list.as_array().map(Vec::as_slice).unwrap_or_default() {
        if let Some(part) = value["include"].as_str() {
            let part = part.strip_prefix('#').expect("a part of the repository");
            if !known.contains_key(part) {
                let value = &repository[part];
                assert!(value.is_object(), "{part}");
                let list = if value["patterns"].is_array() && value["begin"].is_null() {
                    value["patterns"].clone()
                } else {
                    Value::from(vec![value.clone()])
                };
                let inner = rules(&list, repository, known);
                known.insert(part.to_owned(), inner);
            }
            found.extend(known[part].iter().cloned());
            continue;
        }
        let mut captures = |value: &Value| -> Vec<Capture> {
            let Some(object) = value.as_object() else { return Vec::new() };
            object
                .iter()
                .map(|(group, value)| Capture {
                    group: group.parse().expect("a number"),
                    name: text(&value["name"]),
                    inner: rules(&value["patterns"], repository, known),
                })
                .collect()
        };
        found.push(Rc::new(match value["begin"].as_str() {
            None => Rule::Match {
                captures: captures(&value["captures"]),
                pattern: Pattern::new(value["match"].as_str().expect("a pattern")),
                name: text(&value["name"]),
            },
            Some(begin) => Rule::Span {
                captures: captures(&value["beginCaptures"]),
                begin: Pattern::new(begin),
                end: Pattern::new(value["end"].as_str().expect("an end")),
                name: text(&value["name"]),
                inner: rules(&value["patterns"], repository, known),
            },
        }));
    }
    found
}

fn put(scopes: &mut [String], name: &str, (from, to): (usize, usize)) {
    if !name.is_empty() {
        scopes[from..to].iter_mut().for_each(|scope| *scope = format!("{scope} {name}").trim().to_owned());
    }
}

/// Takes a line apart: the match that begins first, of two the rule that is listed first; an end before all others.
fn scan(
    rules: &[Rc<Rule>],
    open: &mut Vec<Rc<Rule>>,
    line: &str,
    scopes: &mut [String],
    (from, to): (usize, usize),
) {
    let mut at = from;
    loop {
        let within = open.last().cloned();
        let (inner, end, name) = match within.as_deref() {
            Some(Rule::Span { inner, end, name, .. }) => {
                (inner.as_slice(), end.find(line, at), name.as_str())
            }
            _ => (rules, None, ""),
        };
        let begins = |groups: &Vec<Option<(usize, usize)>>| groups[0].expect("a match").0;
        let first = inner
            .iter()
            .filter_map(|rule| {
                let (Rule::Match { pattern, .. } | Rule::Span { begin: pattern, .. }) = &**rule;
                let groups = pattern.find(line, at)?;
                (begins(&groups) < to).then(|| (rule.clone(), groups))
            })
            .min_by_key(|(_, groups)| begins(groups));
        let ends = end.filter(|end| first.as_ref().is_none_or(|(_, groups)| begins(end) <= begins(groups)));
        if let Some(end) = ends {
            let (_, stop) = end[0].expect("a match");
            put(scopes, name, (at, stop));
            open.pop();
            at = stop;
            continue;
        }
        let Some((rule, groups)) = first else {
            put(scopes, name, (at, to));
            return;
        };
        let (start, stop) = groups[0].expect("a match");
        assert!(stop > at, "a rule that matches nothing");
        put(scopes, name, (at, stop));
        let (Rule::Match { name, captures, .. } | Rule::Span { name, captures, .. }) = &*rule;
        put(scopes, name, (start, stop));
        for capture in captures {
            if let Some(Some(place)) = groups.get(capture.group) {
                put(scopes, &capture.name, *place);
                if !capture.inner.is_empty() {
                    scan(&capture.inner, &mut Vec::new(), line, scopes, *place);
                }
            }
        }
        if matches!(&*rule, Rule::Span { .. }) {
            open.push(rule.clone());
        }
        at = stop;
    }
}
