//! The column *global* of the table of benchmarks, held to what `rank --global` says. Times of the page are not compared.

use crate::common::{json, palmistry};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Rows whose time on the page is longer, in seconds, are compared on request: `cargo test --release --test book -- --ignored`.
const LONGEST: f64 = 1.0;

/// The rows of the table: the model, what its last cell says, and the seconds of that cell.
fn rows() -> Vec<(String, String, f64)> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src/benchmarks.md");
    let text = std::fs::read_to_string(page).expect("the page");
    let table = text.split("<!-- benches/benchmarks -->").nth(1).expect("a table");
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    let rows = table.lines().filter(|line| line.starts_with("| ")).skip(1);
    rows.map(|line| {
        let cells: Vec<String> = cells(line);
        let global = cells[8].clone();
        match global.rsplit_once(", ").and_then(|(said, time)| Some((said, time.strip_suffix(" s")?))) {
            Some((said, seconds)) => {
                (cells[0].clone(), said.to_owned(), seconds.parse().expect("a wall time"))
            }
            None => (cells[0].clone(), global, 0.0),
        }
    })
    .collect()
}

/// A report of `rank --global` in the words of the table.
fn in_words(report: &Value) -> String {
    let is_observable = |one: &&Value| {
        ["locally observable", "locally identifiable"].iter().any(|word| one["local"] == *word)
    };
    let unknowns: Vec<&Value> = report["unknowns"].as_array().expect("unknowns").iter().collect();
    let observable: Vec<&Value> = unknowns.into_iter().filter(is_observable).collect();
    if observable.is_empty() {
        return "nothing is observable".to_owned();
    }
    let mut several: BTreeMap<u64, Vec<&str>> = BTreeMap::new();
    for one in &observable {
        match one["values"].as_u64() {
            None => return "undecided".to_owned(),
            Some(1) => {}
            Some(count) => several.entry(count).or_default().push(one["name"].as_str().expect("a name")),
        }
    }
    let verdict = match observable.iter().all(|one| one["verdict"] == "proved") {
        true => "proved",
        false => "computed",
    };
    let counts: Vec<String> =
        several.iter().map(|(count, names)| format!("{count} of {}", names.join(", "))).collect();
    let counts = if counts.is_empty() { "one".to_owned() } else { counts.join("; ") };
    format!("{counts} ({verdict})")
}

fn compared(takes_long: bool) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let rows = rows();
    assert!(rows.len() >= 56, "{} rows", rows.len());
    let mut wrong = Vec::new();
    for (model, said, _) in rows.iter().filter(|(.., seconds)| (*seconds > LONGEST) == takes_long) {
        let files = ["proofs/benchmarks", "tests/models"].map(|folder| format!("{folder}/{model}.proof"));
        let file = files.iter().find(|file| root.join(file).exists()).unwrap_or_else(|| panic!("{model}"));
        let found = in_words(&json(&palmistry(&["rank", "--global", "--json", file])));
        if found != *said {
            wrong.push(format!("{model}: the page says {said}, the program {found}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn numbers_of_values_are_those_of_the_table() {
    compared(false);
}

#[test]
#[ignore = "minutes: those of the table that take more than a second"]
fn numbers_of_values_that_take_long() {
    compared(true);
}
