//! The words that begin an entry, those that people write for them, and what to say where none begins.

use super::error::nearest;
use super::problems::is_first_in_line;
use palmistry_math::expression::Expected;
use palmistry_math::expression::parse::{Text, ends_a_line};
use winnow::error::ParserError;

/// What is expected where an entry begins.
pub(super) const ENTRY: &str = "one of: system, use, state, param, angle, assume, latex, let, drift, input, field, output, sample, claim, erratum, \
                     damaged, scan, convention, loose, definition, undecided, set, singularity, map, line, reduction, known, unknown, initial, experiments";

/// What is expected behind an entry in its line.
pub(super) const NEXT_ENTRY: &str = "an operator, or the next entry on a line of its own";

/// The words that begin an entry.
pub(super) const ENTRIES: [&str; 31] = [
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
    "singularity",
    "pole",
    "map",
    "line",
    "reduction",
    "known",
    "unknown",
    "initial",
    "experiments",
];

/// Words with which entries begin elsewhere, and how they are written here.
#[rustfmt::skip]
const OTHER_ENTRIES: [(&str, &str); 26] = [
    ("const constant constants parameter parameters params", "it is called 'param', as in param k = 2"),
    ("variable variables var vars syms symbols symbolic sym Real real float double unknowns", "it is called 'state', as in state x, y"),
    ("dynamics ode odes equation equations rates system_dynamics", "it is called 'drift', as in drift f, and a rate for each state below it"),
    ("vector vectorfield", "it is called 'field', as in field g, and a rate for each state below it"),
    ("def define function", "it is called 'let', as in let e = x^2: a definition is one expression, and no function"),
    ("import include from", "it is called 'use', as in use p = \"other.proof\""),
    ("theorem lemma proposition corollary prove proof assert check show", "it is called 'claim', as in claim 1: rank = 2"),
    ("measure measured measures measurement observe observed meas", "an output is written 'output', as in output x"),
    ("signal disturbance noise control controls inputs", "a signal is declared as in known u(t) or unknown w(t)"),
    ("init ic initials", "it is called 'initial', as in initial x = 1, y known"),
    ("assumption assumptions require given with such assuming constraint where suppose", "what is assumed is an entry of its own, as in assume k > 0, a > 0"),
    ("range ranges domain sampling avoid", "ranges stand behind 'sample', as in sample x in [0, 1] avoid x - 1"),
    ("typo misprint errata", "it is called 'erratum', as in erratum 1: printed x = y corrected x = x"),
    ("plot figure draw", "as in map \"title\": x in [0, 1], y in [0, 2] at {z = 3} of x"),
    ("simulate simulation solver solve integrate run time", "simulations stand in a scene ('palmistry observe'): leave it out"),
    ("end", "an entry ends by itself: leave 'end' out"),
    ("model title", "a file begins with its title, as in system \"a pendulum\""),
    ("author cite", "a source stands behind the title, as in system \"a pendulum\" cite \"a textbook\""),
    ("degrees deg radians", "angles are in radians, as in angle x"),
    ("controllable observability", "a claim has a name and a colon, as in claim 1: rank = 2"),
    ("set", "as in set \"rest\": x = 0, y = 0"),
    ("singularity pole", "as in singularity \"at the origin\": x = 0"),
    ("map", "as in map \"title\": x in [0, 1], y in [0, 2]; a step of discrete time is written in a drift, as in x+ = e"),
    ("line", "as in line \"title\": x to 2 from {y = 1}"),
    ("reduction", "as in use p = \"other.proof\", and then reduction of p: x = 0"),
    ("y", "an output is an expression, as in output x"),
];

/// Signs with which comments begin elsewhere.
const COMMENTS: [&str; 5] = ["!", "/*", "\"\"\"", "<!--", "--"];

/// What to say where no entry begins: by the word there.
fn of_a_word(word: &str, behind: &str) -> Option<String> {
    let other = || {
        let found = OTHER_ENTRIES.iter().find(|(others, _)| others.split(' ').any(|other| other == word));
        // what is short may be the name of something
        found.filter(|_| word != "y" || behind.starts_with('=')).map(|(_, advice)| (*advice).to_owned())
    };
    let small = word.to_lowercase();
    let near = || {
        let known = ENTRIES.into_iter().find(|entry| *entry == small).filter(|_| word.len() > 1);
        let near = known.or_else(|| nearest(word, ENTRIES))?;
        (near != word).then(|| format!("perhaps you meant '{near}'"))
    };
    let is_equation = behind.starts_with('=') && !behind.starts_with("==");
    let is_named = word.starts_with(|c: char| c.is_alphabetic());
    let constant = || {
        (is_named && is_equation).then(|| {
            format!("a constant is declared, as in param {word} = 2, an abbreviation as let {word} = ..., and an output as output {word}")
        })
    };
    let by_what_follows = || match behind {
        _ if !is_named => None,
        behind if behind.starts_with(":=") => Some(format!("an abbreviation is written let {word} = ...")),
        behind if behind.starts_with("(0)") => Some(format!("as in initial {word} = 1")),
        behind if behind.starts_with("in ") => Some(format!("as in sample {word} in [0, 1]")),
        _ => None,
    };
    other().or_else(constant).or_else(by_what_follows).or_else(near)
}

/// What to say where no entry begins.
pub(super) fn no_entry(text: &str, input: &Text<'_>, after_an_entry: bool) -> Expected {
    let mut error = Expected::from_input(input);
    let rest = &text[error.at..];
    let word: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let behind = rest[word.len()..].trim_start_matches([' ', '\t']);
    if after_an_entry && !is_first_in_line(text, error.at) {
        error.what = NEXT_ENTRY.to_owned();
        return error;
    }
    let is_comment = COMMENTS.into_iter().any(|sign| rest.starts_with(sign));
    error.what = match word.as_str() {
        // words that are names too begin an entry only where a title follows
        "set" | "singularity" | "pole" | "map" | "line" => {
            format!("a title in quotation marks behind '{word}'")
        }
        _ => ENTRY.to_owned(),
    };
    let go_on = || "or an operator, if the expression above goes on here".to_owned();
    error.help = match (is_comment, rate_without_field(&word, behind, after_an_entry)) {
        (true, _) => Some("a comment begins with '#'".to_owned()),
        (false, Some(help)) => Some(help),
        (false, None) => of_a_word(&word, behind),
    };
    let error = error.with_habits(text);
    Expected { help: error.help.or_else(|| after_an_entry.then(go_on)), ..error }
}

/// Whether a text begins with the word of an entry.
pub(super) fn is_an_entry(text: &str) -> bool {
    let word: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    ENTRIES.contains(&word.as_str())
}

/// What to say of a rate of change, or of an equation with one, that stands under no field.
fn rate_without_field(word: &str, behind: &str, after_an_entry: bool) -> Option<String> {
    let is_rate = |behind: &str| behind.trim_start_matches('\'').trim_start().starts_with('=');
    if !word.is_empty() && behind.starts_with('\'') && is_rate(behind) {
        return Some(format!(
            "a rate of change stands under its field: write 'drift f' on the line before {word}'"
        ));
    }
    let line = behind.split(ends_a_line).next().unwrap_or_default();
    let is_number = word.starts_with(|c: char| c.is_ascii_digit());
    (after_an_entry && is_number && line.starts_with('=') && line.contains('\''))
        .then(|| "a rate stands alone on the left, as in x' = ...".to_owned())
}

/// With the entry that may be meant, where a line begins with a word that was taken for a state.
pub(super) fn of_a_line(expected: Expected, text: &str) -> Expected {
    let Some((before, rest)) = text.split_at_checked(expected.at) else { return expected };
    let line = before.rsplit(ends_a_line).next().unwrap_or_default();
    let word = line.trim();
    let is_word = !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_word || expected.help.is_some() || !expected.what.starts_with("' after the state") {
        return expected;
    }
    let is_equation = rest.starts_with('=') && !rest.starts_with("==");
    let help = match is_equation {
        true if line.trim_start() != line => None,
        true if word != "y" => Some(format!(
            "a rate of change is written with a prime, as in {word}' = ..., an abbreviation as let {word} = ..., a constant as param {word} = ..., and an output as output ..."
        )),
        _ => of_a_word(word, rest),
    };
    Expected { help, ..expected }
}
