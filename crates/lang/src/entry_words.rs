//! The words that begin an entry, those that people write for them, and what to say where none begins.

use super::error::nearest;
use palmistry_math::expression::Expected;
use palmistry_math::expression::parse::{Text, ends_a_line};
use winnow::error::ParserError;

/// What is expected where an entry begins.
pub(super) const ENTRY: &str = "one of: system, use, state, param, angle, assume, latex, let, drift, input, field, output, sample, claim, erratum, \
                     damaged, scan, convention, loose, definition, undecided, set, pole, map, line, reduction, known, unknown, initial, experiments";

/// The words that begin an entry.
pub(super) const ENTRIES: [&str; 30] = [
    "system",
    "assume",
    "latex",
    "use",
    "state",
    "param",
    "angle",
    "let",
    "drift",
    "input",
    "field",
    "output",
    "sample",
    "claim",
    "erratum",
    "damaged",
    "scan",
    "convention",
    "loose",
    "definition",
    "undecided",
    "set",
    "pole",
    "map",
    "line",
    "reduction",
    "known",
    "unknown",
    "initial",
    "experiments",
];

/// Entries by the names that they have elsewhere.
const OTHER_ENTRIES: [(&str, &str); 16] = [
    ("const", "param"),
    ("constant", "param"),
    ("constants", "param"),
    ("parameter", "param"),
    ("parameters", "param"),
    ("variable", "state"),
    ("var", "state"),
    ("dynamics", "drift"),
    ("ode", "drift"),
    ("equations", "drift"),
    ("def", "let"),
    ("import", "use"),
    ("include", "use"),
    ("theorem", "claim"),
    ("lemma", "claim"),
    ("measure", "output"),
];

/// What to say where no entry begins.
pub(super) fn no_entry(text: &str, input: &Text<'_>, after_an_entry: bool) -> Expected {
    let mut error = Expected::from_input(input);
    let line = text[..error.at].rfind(ends_a_line).map_or(0, |end| end + 1);
    let word: String = text[error.at..].chars().take_while(|c| c.is_alphanumeric()).collect();
    if after_an_entry && !text[line..error.at].trim().is_empty() {
        error.what = "an operator, or the next entry on a line of its own".to_owned();
        error.help = Some("a product is written with '*'".to_owned());
    } else {
        // words that are names too begin an entry only where a title follows
        if let "set" | "pole" | "map" | "line" = word.as_str() {
            error.what = format!("a title in quotation marks behind '{word}'");
            let step = "; a step of discrete time is written in a drift, as in x+ = e";
            let help = if word == "map" { step } else { "" };
            error.help = Some(format!("the reference of the language shows what a {word} consists of{help}"));
            return error;
        }
        error.what = ENTRY.to_owned();
        let other = OTHER_ENTRIES.into_iter().find(|(other, _)| *other == word).map(|(_, own)| own);
        let behind = text[error.at..].get(word.len()..).unwrap_or_default().trim_start();
        let is_equation = !word.is_empty() && behind.starts_with('=') && !behind.starts_with("==");
        let constant = is_equation.then(|| {
            format!("a constant is declared, as in param {word} = 2, and an abbreviation as let {word} = ...")
        });
        let near = nearest(&word, ENTRIES).filter(|near| *near != word);
        let near = other
            .map(|own| format!("it is called '{own}'"))
            .or(constant)
            .or(near.map(|near| format!("perhaps you meant '{near}'")));
        let go_on = || "or an operator, if the expression above goes on here".to_owned();
        error.help = near.or_else(|| after_an_entry.then(go_on));
    }
    error
}

/// Whether a text begins with the word of an entry.
pub(super) fn is_an_entry(text: &str) -> bool {
    let word: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    ENTRIES.contains(&word.as_str())
}

/// With the entry that may be meant, where a line begins with a word that is almost one and was taken for a state.
pub(super) fn advised(expected: Expected, text: &str) -> Expected {
    let before = text.get(..expected.at).unwrap_or_default();
    let line = before.rsplit(ends_a_line).next().unwrap_or_default().trim();
    let is_word = line.chars().all(|c| c.is_ascii_alphanumeric());
    let near = nearest(line, ENTRIES).filter(|_| is_word && expected.help.is_none());
    let meant = near.filter(|near| *near != line).map(|near| format!("perhaps you meant '{near}'"));
    Expected { help: expected.help.or(meant), ..expected }
}
