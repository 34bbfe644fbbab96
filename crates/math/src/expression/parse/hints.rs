//! What may help where a text does not read: what people write by the habits of other languages, and how it is written here.

use super::tokens::{Expected, ends_a_line};
use crate::number::Function;

/// What is expected behind a state in a field.
pub(super) const PRIME: &str = "' after the state";

/// How it is written here, by what stands at the place and before it.
const AT_THE_PLACE: [(&str, &str, &str); 34] = [
    ("*", "*", "a power is written with '^', as in x^2"),
    ("/", "/", "a comment begins with '#'"),
    ("=", "=", "an equation has one '=', as in x = y"),
    ("", ":=", "write '=' alone"),
    (":", "=", "write '=' alone"),
    ("", "<-", "write '=' alone"),
    ("", "&", SEVERAL),
    ("", "~", "write '=': approximately is said by 'within', as in x = 2 within 0.1"),
    (")", "'", "a prime stands behind the name of a state alone: a derivative along the drift f is L(f, x)"),
    ("=", ">", "write '>='"),
    ("=", "<", "write '<='"),
    ("", "|", "an absolute value is written abs(x), as in abs(omega)"),
    ("", "\\", "write functions and Greek letters without the backslash, as in sin(phi)"),
    ("", "{", "brackets are ( and ); a matrix is written [a, b; c, d]"),
    ("", "%", "a comment begins with '#'"),
    ("", "//", "a comment begins with '#'"),
    ("", ";", "an entry ends with its line: leave ';' out"),
    ("", "\u{201c}", "use straight quotation marks, as in \"text\""),
    ("", "\u{201d}", "use straight quotation marks, as in \"text\""),
    ("", "\u{201e}", "use straight quotation marks, as in \"text\""),
    ("", "\u{ab}", "use straight quotation marks, as in \"text\""),
    ("", "\u{2018}", "use the straight mark ', as in x' = y"),
    ("", "\u{2019}", "use the straight mark ', as in x' = y"),
    ("", "\u{2032}", "use the straight mark ', as in x' = y"),
    ("", "\u{2212}", "use the minus sign of the keyboard, '-'"),
    ("", "\u{2013}", "use the minus sign of the keyboard, '-'"),
    ("", "\u{b7}", "a product is written with '*'"),
    ("", "\u{d7}", "a product is written with '*'"),
    ("", "\u{22c5}", "a product is written with '*'"),
    ("", "\u{221a}", "a root is written sqrt(x)"),
    ("", "\u{2264}", "write '<='"),
    ("", "\u{2265}", "write '>='"),
    ("", "\u{b2}", "a power is written with '^', as in x^2"),
    ("", "\u{b3}", "a power is written with '^', as in x^3"),
];

/// Of statements that are to hold together.
const SEVERAL: &str = "of several statements each is a claim of its own; conditions stand behind 'where', with ',' between them";

/// What may help by what stands at the place.
fn at_the_place(before: &str, rest: &str) -> Option<String> {
    let line = before.rsplit(ends_a_line).next().unwrap_or_default();
    let fixed = |(left, right, help): &(&str, &str, &str)| {
        (line.ends_with(left) && rest.starts_with(right)).then(|| (*help).to_owned())
    };
    let ends = |behind: &str| {
        let behind = behind.trim_start_matches(' ');
        behind.is_empty() || behind.starts_with(ends_a_line)
    };
    let comma = || {
        let is_last = rest.strip_prefix(',').is_some_and(ends);
        is_last.then(|| "an entry ends with its line: leave ',' out".to_owned())
    };
    let closes = || {
        let is_more = rest.starts_with(')') && line.matches(')').count() >= line.matches('(').count();
        is_more.then(|| "this bracket closes none: each ')' needs its '('".to_owned())
    };
    let found = AT_THE_PLACE.iter().find_map(fixed).or_else(|| decimal_comma(line, rest));
    found.or_else(closes).or_else(|| of_lie_derivatives(line, rest)).or_else(comma)
}

fn is_function(name: &str) -> bool {
    Function::ALL.into_iter().any(|function| function.name() == name)
}

fn decimal_comma(line: &str, rest: &str) -> Option<String> {
    let digit = |c: char| c.is_ascii_digit();
    let is_one = line.ends_with(digit) && rest.strip_prefix(',').is_some_and(|rest| rest.starts_with(digit));
    is_one.then(|| "a decimal point is written '.', as in 0.5".to_owned())
}

/// By the words of the line as far as the place.
fn of_lie_derivatives(line: &str, rest: &str) -> Option<String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words: Vec<&str> = line.split(|c| !is_word(c)).filter(|word| !word.is_empty()).collect();
    let at_word: String = rest.chars().take_while(|c| is_word(*c)).collect();
    let has = |word: &str| words.contains(&word) || at_word == word;
    if ["if", "then", "else"].into_iter().any(has) {
        return Some(
            "there is no 'if': write max(a, b), min(a, b), abs(a) or sign(a), or a claim for each case with 'where'"
                .to_owned(),
        );
    }
    if matches!(at_word.as_str(), "and" | "or") || matches!(words.last(), Some(&("and" | "or"))) {
        return Some(SEVERAL.to_owned());
    }
    if matches!(words.last(), Some(&("forall" | "all"))) || matches!(at_word.as_str(), "forall") {
        return Some(
            "a claim is about all states and values for which its terms exist: leave 'forall' out".to_owned(),
        );
    }
    if at_word == "where" && words.last() == Some(&"everywhere") {
        return Some("'where' and its conditions stand before 'everywhere'".to_owned());
    }
    let is_fault = |word: &&str| matches!(*word, "erratum" | "damaged" | "scan" | "convention" | "loose");
    if (at_word == "at" || words.contains(&"at")) && words.first().is_some_and(is_fault) {
        return Some(
            "where it stands is a text in quotation marks behind its name, as in erratum 4.2 at \"page 57\": ..."
                .to_owned(),
        );
    }
    if at_word == "at" || words.last() == Some(&"at") {
        return Some(
            "a condition of a claim is written with 'where', as in '... where omega = 0'".to_owned(),
        );
    }
    if let Some((base, power)) = line.rsplit_once('^')
        && rest.starts_with('(')
        && !power.is_empty()
        && power.chars().all(|c| c.is_ascii_digit())
        && let Some(function) = base.rsplit(|c| !is_word(c)).next().filter(|name| is_function(name))
    {
        return Some(format!(
            "a power of a function stands behind its brackets, as in {function}(x)^{power}"
        ));
    }
    // an index runs in something else: 'for i in 1..3'
    if words.last() == Some(&"in") && !rest.starts_with('[') && !words.contains(&"for") {
        return Some("a range has square brackets, as in x in [-1, 1]".to_owned());
    }
    of_an_entry(&words, line, rest)
}

/// By how a line begins that is an entry of another form.
fn of_an_entry(words: &[&str], line: &str, rest: &str) -> Option<String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let is_equation = rest.starts_with('=') && !rest.starts_with("==");
    let named: &str = &rest[..rest.find(|c| !is_word(c)).unwrap_or(rest.len())];
    match words {
        ["system"] if !named.is_empty() => {
            Some(format!("a title stands in quotation marks, as in system \"{named}\""))
        }
        ["output", name] if is_equation => Some(format!(
            "an output is an expression: name it by a definition, let {name} = ..., and write output {name}"
        )),
        ["claim", of] if is_equation => {
            Some(format!("a claim has a name and a colon, as in claim a: {of} = ..."))
        }
        [
            "claim",
            "observable" | "unobservable" | "identifiable" | "unidentifiable" | "rank" | "solutions",
        ] => Some(format!(
            "a claim has a name and a colon, as in claim a: {}...",
            line.trim_start().split_once(' ').map_or("", |(_, of)| of)
        )),
        ["claim", _, word @ ("observable" | "unobservable" | "identifiable" | "unidentifiable"), ..] => {
            Some(format!("the unknowns stand in brackets, as in {word}(x, y)"))
        }
        ["state" | "param" | "angle" | "use" | "output" | "sample" | "assume"] if rest.starts_with(':') => {
            Some(format!("leave ':' out behind '{}'", words[0]))
        }
        ["drift" | "input" | "field", _] if rest.starts_with(':') => {
            Some("leave ':' out behind the name".to_owned())
        }
        ["input", name] if rest.starts_with('(') => {
            Some(format!("a signal that drives the system is declared, as in known {name}(t)"))
        }
        ["state", .., name] if is_equation => {
            Some(format!("an initial condition is an entry of its own: initial {name} = ..."))
        }
        ["state" | "angle", ..] if rest.starts_with('(') => {
            Some("a state is named alone, without (t)".to_owned())
        }
        ["state" | "param" | "angle", .., name] if !named.is_empty() => {
            Some(format!("names stand with ',' between them, as in {name}, {named}"))
        }
        ["param", .., name] if rest.starts_with('[') => {
            Some(format!("a range is an entry of its own, as in sample {name} in [1, 2]"))
        }
        ["sample", .., name] if is_equation || named == "from" => {
            Some(format!("a range has square brackets, as in {name} in [-1, 1]"))
        }
        ["initial", .., name] if rest.starts_with('(') => {
            Some(format!("as in initial {name} = 1, without brackets"))
        }
        ["known" | "unknown", .., name] => Some(format!(
            "a signal is one of time, as in {0} {name}(t); a constant is declared as in param {name} {0}",
            words[0]
        )),
        ["param", .., name] if rest.starts_with(['<', '>']) => {
            Some(format!("what is assumed of it is an entry of its own, as in assume {name} > 0"))
        }
        ["measure" | "measured" | "measurement" | "observe" | "observed" | "y" | "meas"] => {
            Some("an output is written 'output', as in output x".to_owned())
        }
        [name] if line.trim_start() == line && is_equation => Some(format!(
            "a rate of change is written with a prime, as in {name}' = ..., an abbreviation as let {name} = ..., and an output as output ..."
        )),
        [] if line.trim().is_empty() && !named.is_empty() => {
            let behind = rest[named.len()..].trim_start_matches('\'').trim_start();
            let is_rate = rest[named.len()..].starts_with('\'') && behind.starts_with('=');
            is_rate.then(|| {
                format!(
                    "a rate of change stands under its field: write 'drift f' on the line before {named}'"
                )
            })
        }
        _ => None,
    }
}

/// What may help where the prime of a rate of change is missing: the name that should have one ends before the place.
fn of_a_rate(before: &str, rest: &str) -> Option<String> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let named = before.trim_end();
    let begin = named
        .rfind(|c| !is_word(c))
        .map_or(0, |end| end + named[end..].chars().next().map_or(1, char::len_utf8));
    let (name, line) = (&named[begin..], named[..begin].rsplit(ends_a_line).next().unwrap_or_default());
    if let Some(left) =
        line.trim_end().rsplit(|c: char| !is_word(c)).next().filter(|_| !line.trim().is_empty())
    {
        // behind an expression stands no state whose rate follows
        let help = match is_function(left) {
            true => format!("a function has its argument in brackets, as in {left}({name})"),
            false if left.is_empty() => "a product is written with '*'".to_owned(),
            false => format!("a product is written with '*', as in {left}*{name}"),
        };
        return of_lie_derivatives(line, name).or(Some(help));
    }
    let dotted = name.strip_suffix("_dot").or_else(|| name.strip_suffix("dot"));
    let derived = match (name, rest) {
        ("d", rest) => rest.strip_prefix('(').and_then(|rest| rest.split(')').next()),
        (name, rest) if rest.starts_with("/dt") => name.strip_prefix('d'),
        _ => None,
    };
    let state = dotted.or(derived).map(str::trim).filter(|state| !state.is_empty());
    let state = state.or(rest.starts_with('=').then_some(name))?;
    Some(format!("a rate of change is written with a prime, as in {state}' = ..."))
}

impl Expected {
    /// With the advice for what people write by the habits of other languages, where the text has it at the place.
    pub fn hinted(self, text: &str) -> Expected {
        let Some((before, rest)) = text.split_at_checked(self.at) else { return self };
        let rate = if self.what.starts_with(PRIME) { of_a_rate(before, rest) } else { None };
        let help = at_the_place(before, rest).or(rate).or(self.help);
        Expected { help, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Anything may stand at a place, and a place may be no boundary of characters.
    #[test]
    fn no_text_is_too_strange() {
        let texts =
            ["", "\u{3c6}", "d(", "  \u{2032}x", "x y", "x\u{85}y\u{2028}z", "# \u{201c}\nif", "in (", "1,2"];
        for text in texts {
            for at in 0..=text.len() + 2 {
                for what in [PRIME, "a name"] {
                    let expected = Expected { what: what.to_owned(), at, help: Some("kept".to_owned()) };
                    assert!(expected.hinted(text).help.is_some(), "{text:?} at {at}");
                }
            }
        }
    }
}
