//! What a file assumes holds for each of its claims, and for the states that are sampled.

use crate::common::{folder, json, palmistry, write};
use palmistry::{System, decide_all};
use std::path::Path;

const HEAD: &str = "system \"s\"\nstate x, v\nparam m, k\ndrift f\n  x' = v\n  v' = -k/m*x\noutput x\n";

fn words(text: &str) -> Vec<(String, &'static str)> {
    let system = System::parse("s.proof", text, Path::new("")).unwrap_or_else(|error| panic!("{error:?}"));
    decide_all(&system, 1, &false.into(), &|_| ())
        .iter()
        .map(|found| (found.id.clone(), found.verdict.word()))
        .collect()
}

/// A claim below and one above; signs, ranks, and what the assumption says itself. Without it both are refuted.
#[test]
fn claims_hold_under_what_is_assumed() {
    let claims = "claim a: k/m > 0\nclaim b: sqrt(k/m)^2 = k/m\nclaim c: m != 0\nclaim d: rank = 2\nclaim e: k/m < 0\nclaim g: rank = 2 everywhere\n";
    let found = words(&format!("{HEAD}claim first: m + k > 0\nassume m > 0, k > 0\n{claims}"));
    let expected = [
        ("first", "proved"),
        ("a", "proved"),
        ("b", "proved"),
        ("c", "proved"),
        ("d", "proved"),
        ("e", "refuted"),
        ("g", "proved"),
    ];
    assert_eq!(found, expected.map(|(id, word)| (id.to_owned(), word)));
    let without = words(&format!("{HEAD}claim first: m + k > 0\nclaim a: k/m > 0\n"));
    assert!(without.iter().all(|(_, word)| *word == "refuted"), "{without:?}");
}

/// Of no state nothing is proved: assumptions that contradict one another, or a claim's own condition.
#[test]
fn assumptions_that_cannot_hold_prove_nothing() {
    let none =
        System::parse("s.proof", &format!("{HEAD}assume m > 0, m < 0\nclaim a: k = 1\n"), Path::new(""));
    assert!(none.expect_err("no value of m").message.contains("no value of 'm' meets all"));
    for text in ["assume m > k, k > m\nclaim a: k = 1\n", "assume m > 0\nclaim a: k = 1 where m < 0\n"] {
        let found = words(&format!("{HEAD}{text}"));
        assert_ne!(found[0].1, "proved", "{text}");
    }
}

#[test]
fn an_assumption_is_an_inequality_in_declared_names() {
    for (text, message, help) in [
        ("assume m = 1", "an equation is no assumption", "'param' or 'let'"),
        ("assume n > 0", "unknown name 'n'", ""),
        ("assume m", "expected '=', '<'", ""),
    ] {
        let error = System::parse("s.proof", &format!("{HEAD}{text}\n"), Path::new("")).expect_err(text);
        assert!(error.message.contains(message), "{text}: {}", error.message);
        assert!(error.help.unwrap_or_default().contains(help), "{text}");
    }
}

/// The checker reads the assumption from the file: with it both verdicts are held to their claims, and once it is another one neither is confirmed.
#[test]
fn verdicts_are_held_to_the_assumption() {
    let folder = folder();
    let file = write(
        &folder,
        "s.proof",
        format!("{HEAD}assume m > 0, k > 0\nclaim a: k/m > 0\nclaim b expect refuted: k/m < 0\n"),
    );
    let verdicts = folder.path().join("v.json");
    let output = palmistry(&["prove", file.to_str().unwrap(), "--verdicts", verdicts.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(palmistry(&["recheck", verdicts.to_str().unwrap()]).status.code(), Some(0));
    write(
        &folder,
        "s.proof",
        format!("{HEAD}assume m < 0, k > 0\nclaim a: k/m > 0\nclaim b expect refuted: k/m < 0\n"),
    );
    let output = palmistry(&["recheck", verdicts.to_str().unwrap(), "--json"]);
    let found = json(&output);
    assert_eq!((&found["confirmed"], &found["not_checked"]), (&0.into(), &2.into()), "{found}");
}

#[test]
fn sampled_states_meet_the_assumptions() {
    let folder = folder();
    let file =
        write(&folder, "s.proof", format!("{HEAD}assume m > 0, 1/2 < k\nsample m in [-3, 3] k in [-3, 3]\n"));
    let table = folder.path().join("states.csv");
    let (file, table) = (file.to_str().unwrap(), table.to_str().unwrap());
    let output = palmistry(&["rank", file, "--samples", "50", "--table", table, "--coordinates"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(table).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place =
        |name: &str| names.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name}: {names:?}"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    assert_eq!(rows.len(), 50);
    assert!(rows.iter().all(|row| row[place("m")] > 0.0 && row[place("k")] > 0.5), "{text}");
}
