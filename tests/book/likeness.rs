//! When an output is what a page shows. Wall times may differ, and with them the blanks before them; `...` on a line of its own
//! stands for any lines, at the end of a line for the rest of it.

/// Units of wall time.
const UNITS: [&str; 5] = ["s", "ms", "us", "µs", "ns"];

/// A line without the length of its blanks, and without its times.
fn plain(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut found: Vec<String> = Vec::new();
    for word in words {
        let unit = word.trim_end_matches([',', ';', ':', '.', ')', '"']);
        let is_time = UNITS.contains(&unit)
            && found.last().is_some_and(|last| last.trim_start_matches(['(', '"']).parse::<f64>().is_ok());
        // in JSON a time is the value of a key
        let is_seconds = found.last().is_some_and(|last| last.ends_with("seconds\":"));
        if is_time {
            found.pop();
            found.push("TIME".to_owned());
        } else if is_seconds {
            found.push("TIME".to_owned());
        } else {
            found.push(word.to_owned());
        }
    }
    found.join(" ")
}

/// Whether an output is what is shown.
pub fn is_shown(shown: &[String], output: &[&str]) -> bool {
    match shown.split_first() {
        None => output.is_empty(),
        Some((first, rest)) if first.trim() == "..." => {
            (0..=output.len()).any(|skipped| is_shown(rest, &output[skipped..]))
        }
        Some((first, rest)) => output.split_first().is_some_and(|(line, below)| {
            let like = match first.strip_suffix("...") {
                Some(begin) => plain(line).starts_with(&plain(begin)),
                None => plain(line) == plain(first),
            };
            like && is_shown(rest, below)
        }),
    }
}

#[test]
fn times_may_differ_and_nothing_else() {
    let shown = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let like = |left: &str, right: &str| is_shown(&shown(left), &right.lines().collect::<Vec<_>>());
    assert!(like("7 claims, 0.0 s", "7 claims, 12.3 s"));
    assert!(like("a\n  0.00 s\nb", "a\n  11.25 s\nb"));
    assert!(like("{\n  \"seconds\": 0.1,\n}", "{\n  \"seconds\": 7.25e-5,\n}"));
    assert!(!like("7 claims, 0.0 s", "8 claims, 0.0 s"));
    assert!(!like("at 3 states", "at 4 states"));
    assert!(!like("a\nb", "a") && !like("a", "a\nb"));
    assert!(like("a\n...\nd", "a\nb\nc\nd") && like("a\n...", "a") && !like("...\nd", "a\nb"));
    assert!(like("error ...", "error 1e-15") && !like("error ...", "no error"));
}
