//! What can stand at the cursor: names of the file and of those that it imports, functions, the words that begin an entry, units.

use super::lookup::{Library, is_code};
use super::source::Source;
use palmistry_lang::{Declaration, DeclarationKind, vocabulary};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::rc::Rc;

/// The kinds of completions, by their numbers in the protocol.
const FUNCTION: u32 = 3;
const VARIABLE: u32 = 6;
const MODULE: u32 = 9;
const UNIT: u32 = 11;
const KEYWORD: u32 = 14;
const CONSTANT: u32 = 21;

/// No more names than these are offered.
const MOST_NAMES: usize = 1000;

/// What can stand at a byte of the plain text; nothing in comments, titles and numbers.
pub(super) fn completions(library: &Library, source: &Rc<Source>, at: usize) -> Vec<Value> {
    let text = &source.plain[..at];
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
    let begin = at - text.chars().rev().take_while(|c| is_part(*c)).count();
    let word = &text[begin..];
    if !is_code(text) || word.starts_with(|c: char| c.is_ascii_digit()) {
        return Vec::new();
    }
    let mut found = BTreeMap::new();
    if let Some((alias, _)) = word.rsplit_once('.') {
        let import = source.outline.imports.iter().find(|import| import.alias == alias);
        if let Some(other) = import.and_then(|import| library.beside(source, &import.path)) {
            for one in &other.outline.declarations {
                add(&mut found, &format!("{alias}.{}", one.name), one);
            }
            let output = format!("{alias}.output");
            found.insert(output, (VARIABLE, "the outputs of that file".to_owned()));
        }
        return items(found);
    }
    let line = text[..begin].rsplit('\n').next().unwrap_or_default();
    if declares_a_name(line) {
        return Vec::new();
    }
    let mut offer = |words: &mut dyn Iterator<Item = &'static str>, kind: u32, detail: &str| {
        for word in words {
            found.entry(word.to_owned()).or_insert((kind, detail.to_owned()));
        }
    };
    if line.trim().is_empty() {
        offer(&mut vocabulary::ENTRIES.iter().copied(), KEYWORD, "begins an entry");
    } else if is_a_declaration(line) && line.contains(':') {
        offer(&mut vocabulary::dimensions(), UNIT, "a quantity or a unit");
        return items(found);
    }
    if names_a_claim(line) && !line.contains(':') {
        let claims = source.outline.declarations.iter().take(MOST_NAMES);
        for one in claims.filter(|one| matches!(one.kind, DeclarationKind::Claim(_))) {
            found.insert(one.name.clone(), (VARIABLE, "a claim".to_owned()));
        }
        return items(found);
    }
    offer(&mut vocabulary::functions(), FUNCTION, "a function");
    offer(&mut vocabulary::CONSTANTS.iter().copied(), CONSTANT, "a constant");
    offer(&mut vocabulary::SPECIAL.iter().copied(), KEYWORD, "a word of the language");
    for one in source.outline.declarations.iter().take(MOST_NAMES) {
        add(&mut found, &one.name, one);
    }
    items(found)
}

/// Whether the name of something new is being written: there is nothing to offer, and who ends the line means to end it.
fn declares_a_name(line: &str) -> bool {
    let first = line.split_whitespace().next().unwrap_or_default();
    let rest = line.trim_start().strip_prefix(first).unwrap_or_default();
    match first {
        "state" | "param" | "known" | "unknown" => {
            !rest.rsplit(',').next().unwrap_or_default().contains([':', '=', '('])
        }
        "let" | "use" => !rest.contains('='),
        "claim" => !rest.contains(':') && !names_a_claim(rest),
        "drift" | "input" | "field" => !rest.contains(['\'', '+', '=']),
        "system" => true,
        _ => false,
    }
}

/// Whether the name of another claim is to follow.
fn names_a_claim(line: &str) -> bool {
    line.split_whitespace().any(|word| ["restates", "follows"].contains(&word))
}

/// Whether a line declares names, whose units stand behind a colon.
fn is_a_declaration(line: &str) -> bool {
    let first = line.split_whitespace().next().unwrap_or_default();
    ["state", "param", "known", "unknown"].contains(&first)
}

fn add(found: &mut BTreeMap<String, (u32, String)>, name: &str, one: &Declaration) {
    let kind = match one.kind {
        DeclarationKind::State | DeclarationKind::Signal(_) | DeclarationKind::Definition => VARIABLE,
        DeclarationKind::Parameter => CONSTANT,
        DeclarationKind::Field(_) => FUNCTION,
        DeclarationKind::Import => MODULE,
        _ => return,
    };
    found.insert(name.to_owned(), (kind, one.kind.word().to_owned()));
}

fn items(found: BTreeMap<String, (u32, String)>) -> Vec<Value> {
    let item = |(label, (kind, detail))| json!({ "label": label, "kind": kind, "detail": detail });
    found.into_iter().map(item).collect()
}
