//! A text in which constants that are to be estimated are unknown, and input fields have a symbol that drives them: what
//! an observer asks for, and a person should not have to write.

use palmistry_lang::{DeclarationKind, Outline, System, with_plain_line_ends};
use palmistry_math::number::rational_to_f64;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A text for an observer.
pub(super) struct Rewritten {
    pub text: String,
    /// Constants that had a value and would have none any more: other components of a vector.
    pub known: BTreeMap<String, f64>,
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
    // a vector is declared as a whole
    let vector = |name: &str| name.split('[').next().unwrap_or_default().to_owned();
    let declared: BTreeSet<String> = moved.iter().map(|name| vector(name)).collect();
    // from the end of the text to its beginning, so that places stay
    let mut ends: Vec<(usize, usize)> = Vec::new();
    for (place, one) in outline.declarations.iter().enumerate() {
        if one.kind != DeclarationKind::Parameter || !declared.contains(&vector(&one.name)) {
            continue;
        }
        let next = outline.declarations.get(place + 1).filter(|next| next.entry == one.entry);
        let end = next.map_or(one.entry.end, |next| next.span.start).max(one.span.end);
        let code = &plain[one.span.start..one.span.start + length_of_code(&plain[one.span.start..end])];
        // what was said to be known is not any more
        let kept = code.strip_suffix("known").filter(|rest| rest.ends_with(char::is_whitespace));
        if kept.is_some() || !code.ends_with("unknown") {
            let kept = kept.unwrap_or(code).trim_end();
            ends.push((one.span.start + kept.len(), one.span.start + code.len()));
        }
    }
    let mut found = plain;
    for (from, to) in ends.into_iter().rev() {
        found.replace_range(from..to, " unknown");
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
    let is_other =
        |name: &str| name.contains('[') && declared.contains(&vector(name)) && !moved.contains(name);
    let known = system.symbols().filter_map(|(symbol, info)| {
        let name = system.symbol_name(symbol);
        let value = info.default.as_ref().filter(|_| is_other(name))?;
        Some((name.to_owned(), rational_to_f64(value)))
    });
    let known = known.collect();
    let mut drives = BTreeMap::new();
    for field in driven {
        let mut name = format!("driving_{}", field.replace('.', "_"));
        while system.find_symbol(&name).is_some() || system.definition(&name).is_some() {
            name.push('_');
        }
        let _ = writeln!(found, "param {name}");
        drives.insert(field.clone(), name);
    }
    Rewritten { text: found, known, drives }
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
        // what is said to be known, and a vector of which a component is estimated
        let text = "system \"S\"\nstate x\nparam k = 2 known, c[1..2] = 3\ndrift f\n  x' = -k*x + c[1] + c[2]\noutput x\n";
        let system: System = text.parse().expect("it is sound");
        let found = rewritten(text, &system, &["k".to_owned(), "c[1]".to_owned()], &BTreeSet::new());
        let read: System = found.text.parse().unwrap_or_else(|why| panic!("{why:?}\n{}", found.text));
        assert!(read.state_names().len() == 4, "{:?}\n{}", read.state_names(), found.text);
        assert_eq!(found.known, BTreeMap::from([("c[2]".to_owned(), 3.0)]));
        // what moves already stays as it is
        let same = rewritten(text, &system, &["x".to_owned()], &BTreeSet::new());
        assert_eq!(same.text.trim_end(), text.trim_end());
    }
}
