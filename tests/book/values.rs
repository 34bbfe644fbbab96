//! Numbers as pages write them, and where the program has them: in an output, in JSON, in the source.

use crate::complete::lines_without_tests;
use crate::numbers::Output;
use serde_json::Value as Json;
use std::path::Path;

const WORDS: [&str; 21] = [
    "none",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
    "twenty",
];
const TENS: [&str; 10] =
    ["", "", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"];

/// A text with single blanks.
pub fn collapsed(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What something is compared with.
pub enum Value {
    Number(f64),
    /// Several, in the order of the words.
    Numbers(Vec<f64>),
    /// A text that is there.
    Text,
}

/// A number of a page, and a unit of its last digit.
pub struct Number {
    pub value: f64,
    unit: f64,
}

impl Number {
    /// The number in brackets, or the first number.
    pub fn of(words: &str) -> Option<Number> {
        if let Some((_, rest)) = words.split_once('[') {
            return Number::of(&rest.split_once(']')?.0.replace('[', ""));
        }
        (0..words.len())
            .filter(|at| begins(words, *at))
            .find_map(|at| Number::at(&words[at..]).map(|found| found.0))
    }

    /// The number at the beginning of a text, and its length.
    fn at(text: &str) -> Option<(Number, usize)> {
        let length = text.find(|c: char| !c.is_alphabetic() && c != '-').unwrap_or(text.len());
        let word = text[..length].trim_end_matches('-').to_lowercase();
        if let Some(value) = in_words(&word) {
            // two hundred
            let next = text[length..].strip_prefix(' ').unwrap_or("");
            let end = next.find(|c: char| !c.is_alphabetic()).unwrap_or(next.len());
            let times = in_words(&next[..end]).filter(|times| value > 0.0 && *times >= 100.0);
            return Some(match times {
                Some(times) => (Number { value: value * times, unit: times }, length + 1 + end),
                None => (Number { value, unit: 1.0 }, length),
            });
        }
        let sign = usize::from(text.starts_with(['-', '+']));
        let digits = |from: usize, also: char| -> usize {
            let rest = &text[from..];
            from + rest.find(|c: char| !c.is_ascii_digit() && c != also).unwrap_or(rest.len())
        };
        let mut end = digits(sign, ',');
        while text[..end].ends_with(',') {
            end -= 1;
        }
        if end == sign {
            return None;
        }
        let mut decimals = 0;
        if text[end..].starts_with('.') && text[end + 1..].starts_with(|c: char| c.is_ascii_digit()) {
            let last = digits(end + 1, '0');
            decimals = last - end - 1;
            end = last;
        }
        let plain: f64 = text[..end].replace(',', "").parse().ok()?;
        // 1e-9, and 2^{-100} or 10^9
        let (mut value, mut unit) = (plain, 0.1_f64.powi(i32::try_from(decimals).ok()?));
        let power = ["e", "^{", "^"].iter().find_map(|mark| {
            let from = end + text[end..].starts_with(mark).then_some(mark.len())?;
            let minus = usize::from(text[from..].starts_with(['-', '+']));
            let last = digits(from + minus, '0');
            let power: i32 = text[from..last].parse().ok()?;
            Some((*mark == "e", power, last))
        });
        if let Some((is_decimal, power, last)) = power {
            end = last;
            if is_decimal {
                value = text[..end].replace(',', "").parse().ok()?;
                unit *= 10_f64.powi(power);
            } else {
                value = plain.powi(power);
                unit = value * 1e-9;
            }
        }
        Some((Number { value, unit }, end))
    }

    /// Whether it is in this relation to a value.
    pub fn compares(&self, sign: char, value: f64) -> bool {
        match sign {
            '=' => (self.value - value).abs() <= 0.5 * self.unit * (1.0 + 1e-6),
            '~' => self.value * value > 0.0 && (0.5..=2.0).contains(&(self.value / value)),
            '>' => self.value > value,
            _ => self.value < value,
        }
    }
}

/// Whether a word or a number can begin here.
fn begins(text: &str, at: usize) -> bool {
    let before = text.get(..at).and_then(|before| before.chars().next_back());
    let now = text.get(at..).and_then(|rest| rest.chars().next());
    now.is_some() && before.is_none_or(|c| !c.is_alphanumeric() && c != '.' && c != '_')
}

/// A number that is written as a word, up to ninety-nine, hundred, thousand or million.
fn in_words(word: &str) -> Option<f64> {
    let known = |word: &str| -> Option<usize> {
        let small = WORDS.iter().position(|own| *own == word);
        small.or_else(|| Some(TENS.iter().position(|own| !own.is_empty() && *own == word)? * 10))
    };
    let round = [("hundred", 100), ("thousand", 1000), ("million", 1_000_000), ("no", 0), ("half", 0)];
    let found = match word.split_once('-') {
        Some((tens, ones)) => {
            known(tens).filter(|tens| *tens >= 20)? + known(ones).filter(|ones| *ones < 10)?
        }
        None if word == "half" => return None,
        None => known(word).or_else(|| Some(round.iter().find(|own| own.0 == word)?.1))?,
    };
    Some(f64::from(u32::try_from(found).ok()?))
}

/// How many numbers stand in words of a page, or one where one is in brackets.
pub fn numbers_of(words: &str) -> usize {
    if words.contains('[') {
        return 1;
    }
    all_numbers(words).len()
}

/// The numbers of some words, in their order.
pub fn all_numbers(words: &str) -> Vec<Number> {
    let (mut all, mut at) = (Vec::new(), 0);
    while at < words.len() {
        let found = begins(words, at).then(|| Number::at(&words[at..])).flatten();
        at += found.as_ref().map_or(1, |(_, length)| *length.max(&1));
        all.extend(found.map(|(number, _)| number));
    }
    all
}

/// A value without `* 1e3` or `/ 2^20` behind it, and that factor.
fn scaled(what: &str) -> (&str, f64) {
    for (mark, is_divisor) in [(" * ", false), (" / ", true)] {
        if let Some((what, factor)) = what.rsplit_once(mark)
            && let Some((number, length)) = Number::at(factor.trim())
            && length == factor.trim().len()
        {
            return (what.trim(), if is_divisor { 1.0 / number.value } else { number.value });
        }
    }
    (what, 1.0)
}

/// The numbers in a text at the places of `{}`. `...` between blanks stands for any words, the fewest that do, and `#` for one.
fn in_places(text: &str, pattern: &str) -> Option<Vec<f64>> {
    let is_plain = !pattern.split(' ').any(|word| word == "..." || word == "#");
    if is_plain && pattern.matches("{}").count() == 1 {
        return in_place(text, pattern).map(|value| vec![value]);
    }
    let parts = pattern.split(' ').map(|word| match word {
        "..." => "(?:[^ ]+ )*?".to_owned(),
        "#" => "[^ ]+ ".to_owned(),
        word => {
            let number = r"([-+]?[0-9]+(?:,[0-9]{3})*(?:\.[0-9]+)?(?:e[-+]?[0-9]+)?)";
            format!("{} ", escaped(word).replace(r"\{\}", number))
        }
    });
    let pattern = format!("(?:^| ){}(?:$|[^0-9.])", parts.collect::<String>().trim_end());
    let found = regex_lite::Regex::new(&pattern).ok()?.captures(text)?;
    found.iter().skip(1).map(|number| Some(Number::at(number?.as_str())?.0.value)).collect()
}

/// The number in a text at the place of `{}`.
fn in_place(text: &str, pattern: &str) -> Option<f64> {
    let (before, after) = pattern.split_once("{}")?;
    text.match_indices(before).find_map(|(at, _)| {
        let rest = &text[at + before.len()..];
        let (number, length) = Number::at(&rest.replace('_', ""))?;
        // a length among digits with '_' between them
        let mut end = length;
        while rest[..end].replace('_', "").len() < length {
            end += 1;
        }
        rest[end..].starts_with(after).then_some(number.value)
    })
}

/// A text as a regular expression that finds it.
fn escaped(text: &str) -> String {
    let marked = text.chars().flat_map(|c| {
        let is_plain = c.is_alphanumeric() || !c.is_ascii();
        [(!is_plain).then_some('\\'), Some(c)]
    });
    marked.flatten().collect()
}

/// A value in what a command printed.
pub fn in_output(what: &str, is_quoted: bool, output: &Output) -> Result<Value, String> {
    let lacks = || {
        let mut end: String = output.all.chars().rev().take(400).collect();
        end = end.chars().rev().collect();
        format!("the output does not contain '{what}'; it ends with: {end}")
    };
    let (place, factor) = scaled(what);
    let (fold, path) = place.split_once(' ').unwrap_or(("", place));
    if !is_quoted
        && (place.starts_with('.') || path.starts_with('.') && ["max", "min", "sum"].contains(&fold))
    {
        let json: Json = serde_json::from_str(&output.stdout).map_err(|why| {
            format!("'{path}' is a place in JSON, and the output is none: {why}; {}", lacks())
        })?;
        let fold = if place.starts_with('.') { "" } else { fold };
        let path = if fold.is_empty() { place } else { path };
        return in_json(&json, path, fold).map(|value| Value::Number(value * factor));
    }
    if place.contains("{}") {
        let found = in_places(&output.all, &collapsed(place)).ok_or_else(lacks)?;
        let found: Vec<f64> = found.into_iter().map(|value| value * factor).collect();
        return Ok(if let [value] = found[..] { Value::Number(value) } else { Value::Numbers(found) });
    }
    let words = collapsed(&if is_quoted { what.replace(['[', ']'], "") } else { what.to_owned() });
    output.all.contains(&words).then_some(Value::Text).ok_or_else(lacks)
}

/// The value at a place in JSON: `.a[0].b[key=value].c`.
fn in_json(json: &Json, path: &str, fold: &str) -> Result<f64, String> {
    let none = || format!("no place '{path}' in the JSON");
    let mut at: Vec<&Json> = vec![json];
    // whether what was found so far are several
    let mut is_list = false;
    let mut rest = path;
    while !rest.is_empty() {
        if let Some(inner) = rest.strip_prefix('[') {
            let mut depth = 1;
            let end = inner.find(|c| {
                depth += i32::from(c == '[') - i32::from(c == ']');
                depth == 0
            });
            let (index, behind) = inner.split_at(end.ok_or_else(none)?);
            rest = &behind[1..];
            if let (false, Ok(index)) = (is_list, index.parse::<usize>()) {
                at = vec![at[0].get(index).ok_or_else(none)?];
                continue;
            }
            if !is_list {
                at = at[0].as_array().ok_or_else(none)?.iter().collect();
                is_list = true;
            }
            if let Ok(index) = index.parse::<usize>() {
                at = vec![at.get(index).ok_or_else(none)?];
                is_list = false;
            } else if !index.is_empty() {
                let (key, wanted) = index.split_once('=').ok_or_else(none)?;
                let (key, is_wanted) = key.strip_suffix('!').map_or((key, true), |key| (key, false));
                at.retain(|one| one.get(key).is_some_and(|own| is_like(own, wanted)) == is_wanted);
            }
            continue;
        }
        let name = rest.strip_prefix('.').ok_or_else(none)?;
        let end = name.find(['.', '[']).unwrap_or(name.len());
        rest = &name[end..];
        let mut next = Vec::new();
        for one in at {
            match one {
                // a name of a list is that of each of its elements
                Json::Array(list) => {
                    is_list = true;
                    next.extend(list.iter().filter_map(|one| one.get(&name[..end])));
                }
                Json::Object(all) if &name[..end] == "*" => {
                    is_list = true;
                    next.extend(all.values());
                }
                one => next.extend(one.get(&name[..end])),
            }
        }
        at = next;
        if at.is_empty() {
            return Err(none());
        }
        is_list &= at.len() > 1;
    }
    if fold.is_empty() && is_list {
        return Ok(at.len() as f64);
    }
    let all: Vec<&Json> =
        at.iter().flat_map(|one| one.as_array().map_or(vec![*one], |list| list.iter().collect())).collect();
    if fold.is_empty() && at[0].is_array() {
        return Ok(all.len() as f64);
    }
    let numbers = all.iter().filter_map(|one| one.as_f64());
    match fold {
        "max" => numbers.reduce(f64::max).ok_or_else(none),
        "min" => numbers.reduce(f64::min).ok_or_else(none),
        "sum" => Ok(numbers.sum()),
        _ => at[0].as_f64().ok_or_else(|| format!("'{path}' is {}, which is no number", at[0])),
    }
}

/// Whether a value in JSON is what is written, numbers by their size.
fn is_like(own: &Json, wanted: &str) -> bool {
    match own {
        Json::String(text) => text == wanted,
        Json::Number(number) => wanted.parse().is_ok_and(|wanted: f64| number.as_f64() == Some(wanted)),
        Json::Array(list) => {
            let inner = wanted.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
            inner.is_some_and(|inner| {
                let parts: Vec<&str> = inner.split(',').map(str::trim).collect();
                parts.len() == list.len() && list.iter().zip(parts).all(|(own, part)| is_like(own, part))
            })
        }
        Json::Bool(own) => wanted == if *own { "true" } else { "false" },
        own => own.is_null() && wanted == "null",
    }
}

/// A value in the source: `NAME in FILE`, `text {} in FILE`, `lines in FILES`, `files in FOLDER/*.ending`.
pub fn in_source(root: &Path, what: &str) -> Result<Value, String> {
    let (what, place) = what.rsplit_once(" in ").ok_or("no ' in FILE' behind it")?;
    // what is published has neither the other crates beside it nor the reports
    let first = place.split('/').next().unwrap_or_default();
    if ["crates", "python", "benches"].contains(&first) && !root.join(first).exists() {
        return Ok(Value::Text);
    }
    let read = |path: &str| std::fs::read_to_string(root.join(path)).map_err(|why| format!("{path}: {why}"));
    let number = |found: usize| Ok(Value::Number(found as f64));
    match what {
        "lines" => {
            let mut lines = 0;
            for path in place.split_whitespace() {
                match root.join(path).exists() {
                    true if path.ends_with(".rs") || root.join(path).is_dir() => {
                        lines += lines_without_tests(&root.join(path));
                    }
                    _ => lines += read(path)?.lines().count(),
                }
            }
            number(lines)
        }
        "files" => {
            let (folder, ending) = place.rsplit_once("/*").ok_or("'files in FOLDER/*.ending'")?;
            let entries = std::fs::read_dir(root.join(folder)).map_err(|why| format!("{folder}: {why}"))?;
            let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
            number(names.filter(|name| name.ends_with(ending)).count())
        }
        _ => {
            let text = read(place)?;
            let (name, factor) = scaled(what);
            if let Some(value) = name.contains("{}").then(|| in_place(&collapsed(&text), &collapsed(name))) {
                let value = value.ok_or_else(|| format!("{place} does not contain '{name}'"))?;
                return Ok(Value::Number(value * factor));
            }
            constant(&text, name)
                .map(|value| Value::Number(value * factor))
                .ok_or_else(|| format!("no constant '{name}' with a number in {place}"))
        }
    }
}

/// The value of a constant in Rust or Python: a number, a product or shift of numbers, or how long a table is.
fn constant(text: &str, name: &str) -> Option<f64> {
    let is_name = |text: &str, at: usize| {
        let around = [text[..at].chars().next_back(), text[at + name.len()..].chars().next()];
        around.iter().flatten().all(|c| !c.is_alphanumeric() && *c != '_')
    };
    text.match_indices(name).filter(|(at, _)| is_name(text, *at)).find_map(|(at, _)| {
        let rest = text[at + name.len()..].trim_start();
        let line = text[..at].rsplit('\n').next()?.trim();
        let (kind, value) = match rest.strip_prefix(':') {
            Some(rest) if line.ends_with("const") || line.ends_with("static") => {
                // the type of a table has a ';'
                let at = rest.find(" =")?;
                (&rest[..at], &rest[at + 2..])
            }
            None if line.is_empty() => ("", rest.strip_prefix('=')?),
            _ => return None,
        };
        if let Some((_, length)) = kind.rsplit_once(';')
            && let Some(length) = evaluated(length.trim_end().trim_end_matches(']'), text)
        {
            return Some(length);
        }
        let end = if kind.is_empty() { value.find('\n') } else { value.find(';') };
        evaluated(&value[..end?], text)
    })
}

/// A product, quotient or shift of numbers.
fn evaluated(expression: &str, text: &str) -> Option<f64> {
    let plain = expression.split('#').next()?.replace('_', "");
    let plain = plain.trim();
    let inner =
        plain.strip_prefix("Duration::from").or_else(|| plain.strip_prefix("std::time::Duration::from"));
    if let Some((unit, inner)) = inner.and_then(|inner| inner.split_once('(')) {
        let factor = if unit == "millis" { 1e-3 } else { 1.0 };
        return Some(evaluated(inner.strip_suffix(')')?, text)? * factor);
    }
    let plain = plain.split(" as ").next()?.trim();
    for (mark, join) in [
        (" << ", (|a, b| a * f64::exp2(b)) as fn(f64, f64) -> f64),
        (" - ", |a, b| a - b),
        (" + ", |a, b| a + b),
        (" / ", |a, b| a / b),
        (" * ", |a, b| a * b),
        ("**", f64::powf),
    ] {
        if let Some((left, right)) = plain.rsplit_once(mark) {
            return Some(join(evaluated(left, text)?, evaluated(right, text)?));
        }
    }
    let plain = plain.trim_matches(['(', ')']);
    let plain = ["usize", "u128", "u64", "u32", "u16", "i64", "i32", "f64"]
        .iter()
        .find_map(|kind| plain.strip_suffix(kind))
        .unwrap_or(plain);
    plain.parse().ok().or_else(|| {
        let is_name = plain.chars().all(|c| c.is_ascii_uppercase());
        let own = expression.trim();
        (is_name && !own.is_empty()).then(|| constant(text, own)).flatten()
    })
}

#[test]
fn numbers_are_read_as_pages_write_them() {
    for (words, value) in [
        ("of 1,390 lines", 1390.0),
        ("forty-six mistakes", 46.0),
        ("about -138.222, or so", -138.222),
        ("to 3.5e-9 m", 3.5e-9),
        ("at m4 of [17] and 3", 17.0),
        ("below $2^{-10}$", 1.0 / 1024.0),
        ("Four papers", 4.0),
        ("more than two hundred", 200.0),
        ("none of 5", 0.0),
    ] {
        assert_eq!(Number::of(words).map(|found| found.value), Some(value), "{words}");
    }
    assert!(Number::of("no number of anyone").is_some_and(|found| found.value == 0.0));
    assert!(Number::of("m4 is a name").is_none());
    let rounds = |words: &str, value| Number::of(words).expect("a number").compares('=', value);
    assert!(
        rounds("0.71", 0.7129) && !rounds("0.72", 0.7129) && rounds("2e-9", 2.4e-9) && !rounds("46", 46.6)
    );
    let text = "const A: u64 = 1 << 20;\nconst AB: usize = 2_000;\nconst T: [(&str, u8); 3] = [\n];\nconst C: f64 = 1.0 / 4.0;\nP = 5_0\n\
                const D: Duration = Duration::from_secs(30);\nconst E: u64 = 3 * A;\n";
    for (name, value) in [("A", 1048576.0), ("AB", 2000.0), ("T", 3.0), ("C", 0.25), ("P", 50.0), ("D", 30.0)]
    {
        assert_eq!(constant(text, name), Some(value), "{name}");
    }
    assert_eq!(constant(text, "E"), Some(3.0 * 1048576.0));
}

#[test]
fn words_between_may_be_any() {
    let text = "smooth: 4 bodies; (3.47) on 2 margin 0.05 4 1 0 0.15 3 7 8 rough: 5 bodies; (3.47) on 0 margin 0.15 1 2 3.5e-2, end";
    for (pattern, values) in [
        ("smooth: ... 0.15 {}", Some(vec![3.0])),
        ("smooth: ... 0.15 # {}", Some(vec![7.0])),
        ("smooth: ... 0.05 {} {} {}", Some(vec![4.0, 1.0, 0.0])),
        ("{} bodies; (3.47) on {}", Some(vec![4.0, 2.0])),
        ("rough: ... (3.47) on {} margin", Some(vec![0.0])),
        ("rough: ... 0.15 # # {},", Some(vec![0.035])),
        ("rough: ... 0.05 {}", None),
        ("smooth: ... 4 ... bodies; ... on {} margin", Some(vec![2.0])),
        ("mooth: ... 0.15 {}", None),
        ("smooth: ... bodies, {}", None),
    ] {
        assert_eq!(in_places(text, pattern), values, "{pattern}");
    }
}
