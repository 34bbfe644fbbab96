//! `prove` as a report: what stands in it, how it is laid out, which claims are asked for.

use crate::common::{folder, json, write};
use crate::process::{finish, program, words};
use serde_json::Value;
use std::process::Output;

/// Four claims: two as expected; one that is refuted at every x but zero, and one whose correction is wrong.
const MIXED: &str = "system \"mixed\"\n# a comment\nstate x\ndrift f\n  x' = -x\noutput x\nclaim one: L(f, x) = -x\n\
                     claim two.a:\n  L(f, x)\n    = x\nclaim two.b expect refuted: x = x + 1\n\
                     erratum three: printed x = 2*x\n  corrected x = 3*x\n";

fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("a text")
}

fn prove(file: &std::path::Path, more: &[&str]) -> Output {
    finish(program(&[&["prove", file.to_str().unwrap()], more].concat()).env_remove("COLUMNS"))
}

#[test]
fn what_is_not_as_expected_is_told_whole() {
    let folder = folder();
    let file = write(&folder, "mixed.proof", MIXED);
    let output = prove(&file, &[]);
    assert_eq!(output.status.code(), Some(1), "{}", words(&output));
    let text = text(&output);
    let place = |line: usize, column: usize| format!("{}:{line}:{column}", file.display());
    let block: Vec<&str> = text
        .lines()
        .skip_while(|line| !line.contains("two.a"))
        .take_while(|line| !line.contains("two.b"))
        .collect();
    assert_eq!(block[0], format!("  FAIL refuted    two.a  {}", place(8, 7)), "{text}");
    assert_eq!(block[1].split_whitespace().collect::<Vec<_>>().join(" "), "claimed L(f, x) = x");
    assert!(block.last().unwrap().trim_start().starts_with("expected   proved"), "{text}");
    // the sides are those at the state: the left one is minus the right one, and that is x
    let value = |label: &str| {
        let line = block.iter().find_map(|line| line.trim_start().strip_prefix(label));
        line.unwrap_or_else(|| panic!("{label} in {text}")).trim().split(" = ").next().unwrap().to_owned()
    };
    let x = block
        .iter()
        .find_map(|line| line.split_once("x = ").filter(|(before, _)| before.contains("refuted at")));
    assert_eq!(value("right"), x.expect("a state").1);
    assert_eq!(value("left"), format!("-{}", value("right")).replace("--", ""));
    assert!(text.contains(&format!("three  {}", place(12, 9))), "{text}");
    assert!(text.contains("erratum: 'printed' refuted, 'corrected' proved"), "{text}");
}

/// The counts of the words are all the claims.
#[test]
fn the_summary_adds_up_and_says_how_long_it_took() {
    let folder = folder();
    let file = write(&folder, "mixed.proof", MIXED);
    for more in [&[][..], &["-q"]] {
        let text = text(&prove(&file, more));
        let last = text.lines().last().unwrap();
        let (all, rest) = last.split_once(" claims: ").unwrap_or_else(|| panic!("{last}"));
        let (counts, rest) = rest.split_once("; ").unwrap();
        let sum: usize =
            counts.split(", ").map(|part| part.split_once(' ').unwrap().0.parse::<usize>().unwrap()).sum();
        assert_eq!((all, sum), ("4", 4), "{last}");
        let seconds = rest.strip_prefix("2 not as expected, ").and_then(|rest| rest.strip_suffix(" s"));
        assert!(seconds.is_some_and(|seconds| seconds.parse::<f64>().is_ok()), "{last}");
    }
    let quiet = text(&prove(&file, &["-q"]));
    assert!(quiet.contains("two.a") && !quiet.contains("two.b"), "{quiet}");
}

#[test]
fn one_asks_for_claims_by_their_ids() {
    let folder = folder();
    let file = write(&folder, "mixed.proof", MIXED);
    let ids = |more: &[&str]| -> Vec<String> {
        let found = json(&prove(&file, &[&["--json"], more].concat()));
        let claims = found["claims"].as_array().unwrap_or_else(|| panic!("{found}"));
        claims.iter().map(|claim| claim["id"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(ids(&["--only", "one"]), ["one"]);
    assert_eq!(ids(&["--only", "two"]), ["two.a", "two.b"]);
    assert_eq!(ids(&["--only", "*e*"]), ["one", "three"]);
    assert_eq!(ids(&["--only", "two.b", "--only", "one"]), ["one", "two.b"]);
    assert_eq!(prove(&file, &["--only", "one"]).status.code(), Some(0));
    let unknown = prove(&file, &["--only", "oen"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(words(&unknown).contains("there is no claim 'oen'") && words(&unknown).contains("'one'"));
}

/// A verdict does not depend on what else is asked for.
#[test]
fn a_claim_alone_has_the_verdict_that_it_has_among_others() {
    let all = json(&finish(&mut program(&["prove", "proofs/moll2002/fixed_palms.proof", "--json"])));
    for claim in all["claims"].as_array().unwrap().iter().take(4) {
        let id = claim["id"].as_str().unwrap();
        let run = ["prove", "proofs/moll2002/fixed_palms.proof", "--json", "--only", id];
        let alone = json(&finish(&mut program(&run)));
        let found = alone["claims"].as_array().unwrap().iter().find(|found| found["id"] == id);
        let plain = |claim: &Value| {
            let mut claim = claim.clone();
            crate::common::without_times(&mut claim);
            claim
        };
        assert_eq!(plain(found.expect("it is decided")), plain(claim));
    }
}

#[test]
fn json_and_junit_carry_the_statement_and_its_place() {
    let folder = folder();
    let file = write(&folder, "mixed.proof", MIXED);
    let xml = folder.path().join("claims.xml");
    let found = json(&prove(&file, &["--json", "--junit", xml.to_str().unwrap()]));
    let claim = &found["claims"][1];
    assert_eq!((claim["line"].as_u64(), claim["column"].as_u64()), (Some(8), Some(7)), "{claim}");
    assert_eq!(claim["statement"], "L(f, x) = x");
    let xml = std::fs::read_to_string(xml).unwrap();
    let case = xml.split("<testcase").find(|case| case.contains("two.a")).unwrap();
    assert!(case.contains("line=\"8\"") && case.contains("column=\"7\""), "{case}");
    assert!(case.contains("name=\"statement\" value=\"L(f, x) = x\""), "{case}");
    assert!(!xml.contains('\u{1b}'));
}

#[test]
fn a_file_has_no_colours_and_a_terminal_its_width() {
    let folder = folder();
    let file = write(&folder, "mixed.proof", MIXED);
    assert!(!text(&prove(&file, &[])).contains('\u{1b}'));
    let run = ["prove", file.to_str().unwrap()];
    let coloured = finish(program(&run).env("CLICOLOR_FORCE", "1").env_remove("NO_COLOR"));
    assert!(text(&coloured).contains("\u{1b}[1m\u{1b}[31mFAIL\u{1b}[0m"), "{}", words(&coloured));
    let plain = finish(program(&run).env("CLICOLOR_FORCE", "1").env("NO_COLOR", "1"));
    assert!(!text(&plain).contains('\u{1b}'));
    // no line with a blank to break at is longer; what it says stays the same
    let narrow = text(&finish(program(&run).env("COLUMNS", "48")));
    let place = file.display().to_string();
    let long: Vec<&str> =
        narrow.lines().filter(|line| line.chars().count() > 48 && !line.contains(&place)).collect();
    assert!(long.is_empty(), "{long:?}");
    let in_words = |text: &str| {
        let without_time = text.rsplit_once(", ").unwrap().0;
        without_time.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(in_words(&narrow), in_words(&text(&prove(&file, &[]))));
}
