//! A text in which constants that are to be estimated are unknown, and input fields have a symbol that drives them: what
//! an observer asks for, and a person should not have to write.

use palmistry_lang::{DeclarationKind, Outline, System, with_plain_line_ends};
use palmistry_math::number::rational_to_f64;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A text for an observer.
pub(super) struct Rewritten {
    pub text: String,
    /// The symbols that drive input fields, by the names of these.
    pub drives: BTreeMap<String, String>,
}

/// Rewrites a text whose parameters among `estimate` are constants and whose `driven` fields have no symbol.
pub(super) fn rewritten(
    text: &str,
    system: &System,
    estimate: &[String],
    driven: &BTreeSet<String>,
) -> Rewritten {
    let plain = with_plain_line_ends(text);
    let outline = Outline::of(&plain);
    let is_constant = |name: &str| {
        let symbol = system.find_symbol(name);
        symbol.is_some_and(|symbol| !system.states.contains(&symbol))
    };
    let moved: BTreeSet<&str> =
        estimate.iter().map(String::as_str).filter(|name| is_constant(name)).collect();
    // from the end of the text to its beginning, so that places stay
    let mut ends: Vec<usize> = Vec::new();
    for (place, one) in outline.declarations.iter().enumerate() {
        if one.kind != DeclarationKind::Parameter || !moved.contains(one.name.as_str()) {
            continue;
        }
        let next = outline.declarations.get(place + 1).filter(|next| next.entry == one.entry);
        let end = next.map_or(one.entry.end, |next| next.span.start).max(one.span.end);
        ends.push(one.span.start + length_of_code(&plain[one.span.start..end]));
    }
    let mut found = plain;
    for end in ends.into_iter().rev() {
        found.insert_str(end, " unknown");
    }
    found.push('\n');
    for name in &moved {
        // a value without a range is near the truth; the first guess is not the value itself
        let info = system.find_symbol(name).and_then(|symbol| system.symbol_info(symbol));
        let Some(value) = info.filter(|info| info.range.is_none()).and_then(|info| info.default.clone())
        else {
            continue;
        };
        let value = rational_to_f64(&value);
        let [low, high] = if value < 0.0 { [2.0 * value, 0.5 * value] } else { [0.5 * value, 2.0 * value] };
        if low < high {
            let _ = writeln!(found, "sample {name} in [{low}, {high}]");
        }
    }
    let mut drives = BTreeMap::new();
    for field in driven {
        let mut name = format!("driving_{}", field.replace('.', "_"));
        while system.find_symbol(&name).is_some() || system.definition(&name).is_some() {
            name.push('_');
        }
        let _ = writeln!(found, "param {name}");
        drives.insert(field.clone(), name);
    }
    Rewritten { text: found, drives }
}

/// How much of a declaration is left without the comma, the blanks and the comments behind it.
fn length_of_code(text: &str) -> usize {
    let (mut end, mut comment) = (0, false);
    for (place, c) in text.char_indices() {
        comment = (comment || c == '#') && c != '\n';
        if !comment && !c.is_whitespace() && c != ',' {
            end = place + c.len_utf8();
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: one of three parameters becomes unknown, with its comment, its value and its unit; an input field gets a symbol.
    #[test]
    fn constants_become_unknown() {
        let text = "system \"S\"\nstate x\nparam a = 1, k: 1/s = 2, # a rate\n  c unknown   # another\ndrift f\n  x' = -a*k*x + c\ninput g\n  x' = 1\noutput x\nclaim r: rank = 1\n";
        let system: System = text.parse().expect("it is sound");
        let driven = BTreeSet::from(["g".to_owned()]);
        let found = rewritten(text, &system, &["x".to_owned(), "k".to_owned(), "c".to_owned()], &driven);
        let read: System = found.text.parse().unwrap_or_else(|why| panic!("{why:?}\n{}", found.text));
        assert_eq!(read.state_names(), ["x", "k", "c"], "{}", found.text);
        assert!(found.text.contains("param a = 1, k: 1/s = 2 unknown, # a rate\n  c unknown   # another\n"));
        assert!(read.find_symbol("driving_g").is_some() && found.drives["g"] == "driving_g");
        let range = read.find_symbol("k").and_then(|symbol| read.symbol_info(symbol)?.range.clone());
        assert_eq!(
            range.map(|range| (rational_to_f64(&range.low), rational_to_f64(&range.high))),
            Some((1.0, 4.0))
        );
        // what moves already stays as it is
        let same = rewritten(text, &system, &["x".to_owned()], &BTreeSet::new());
        assert_eq!(same.text.trim_end(), text.trim_end());
    }
}
