//! The outline of a file: what it declares and claims.

use super::source::Source;
use palmistry_lang::{Declaration, DeclarationKind, in_one_line};
use serde_json::{Value, json};

/// The kinds of symbols, by their numbers in the protocol.
const NAMESPACE: u32 = 3;
const METHOD: u32 = 6;
const FUNCTION: u32 = 12;
const VARIABLE: u32 = 13;
const CONSTANT: u32 = 14;
const BOOLEAN: u32 = 17;
const ARRAY: u32 = 18;
const OBJECT: u32 = 19;
const EVENT: u32 = 24;

/// No more characters of an entry than these are shown behind its name.
const MOST_CHARACTERS: usize = 80;

/// What a text declares, as symbols of a document.
pub(super) fn symbols(source: &Source) -> Value {
    source.outline.declarations.iter().map(|declaration| symbol(source, declaration)).collect()
}

fn symbol(source: &Source, declaration: &Declaration) -> Value {
    use DeclarationKind as Is;
    let Declaration { kind, name, span, entry } = declaration;
    let number = match kind {
        Is::System | Is::Import => NAMESPACE,
        Is::State | Is::Signal(_) => VARIABLE,
        Is::Parameter => CONSTANT,
        Is::Definition => FUNCTION,
        Is::Field(_) => METHOD,
        Is::Output => EVENT,
        Is::Claim(_) => BOOLEAN,
        Is::View("set" | "singularity") => ARRAY,
        Is::View(_) | Is::Reduction => OBJECT,
    };
    let behind = in_one_line(&source.plain, &(span.end..entry.end.max(span.end)));
    let detail = match kind {
        Is::Definition | Is::Claim(_) | Is::View(_) => {
            let short: String = behind.chars().take(MOST_CHARACTERS).collect();
            format!("{} {}", kind.word(), short.trim_start_matches([':', '=', ' ']))
        }
        _ => kind.word().to_owned(),
    };
    // a name is not empty, or an editor leaves out the whole list
    let name = if name.is_empty() { "?" } else { name };
    let whole = entry.start.min(span.start)..entry.end.max(span.end);
    json!({
        "name": name,
        "detail": detail,
        "kind": number,
        "range": source.range(&whole),
        "selectionRange": source.range(span),
    })
}
