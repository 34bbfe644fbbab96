//! Work that is cut into shards, as a shell loop or an array of jobs does it. Oracle: the same command in one run, byte for byte.

use crate::common::{folder, json, write};
use crate::process::{finish, program, words};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Output;

const SYSTEM: &str = "system \"s\"\nstate x, y, z\ndrift f\n  x' = y*z\n  y' = z^2 - x\n  z' = x*y\noutput x\n\
                      sample x in [-1, 1] y in [-1, 1] z in [-1, 1]\n";

/// One with open boxes for as long as one likes, and with few minors.
const FEW_MINORS: &str = "system \"s\"\nstate x, y\ndrift f\n  x' = y\n  y' = -x\noutput x^2 + y^2*x\n\
                          sample x in [-1, 2] y in [-1, 3]\n";

struct Case {
    folder: tempfile::TempDir,
    command: Vec<String>,
}

impl Case {
    fn new(words: &[&str]) -> Case {
        Case::of(SYSTEM, words)
    }

    fn of(system: &str, words: &[&str]) -> Case {
        let folder = folder();
        let file = write(&folder, "s.proof", system).display().to_string();
        let (verb, more) = words.split_first().unwrap();
        let mut command = vec![(*verb).to_owned(), file];
        command.extend(more.iter().map(|word| (*word).to_owned()));
        Case { folder, command }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    fn run(&self, more: &[&str]) -> Output {
        let all: Vec<&str> = self.command.iter().map(String::as_str).chain(more.iter().copied()).collect();
        finish(&mut program(&all))
    }

    fn succeeds(&self, more: &[&str]) -> String {
        let output = self.run(more);
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// What is said where it cannot be done.
    fn refused(&self, more: &[&str]) -> String {
        let output = self.run(more);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        let said = String::from_utf8(output.stderr).unwrap();
        // as it is broken into lines for people
        said.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    }
}

fn files(folder: &str) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_rank_in_shards_is_that_of_one_run() {
    let case = Case::new(&["rank", "--samples", "600", "--seed", "9"]);
    let parts = case.path("parts");
    for number in ["3", "1", "2"] {
        assert_ne!(case.succeeds(&["--missing", &parts, "3"]), "");
        let said = case.succeeds(&["--shard", &format!("{number}/3"), "--part", &parts]);
        assert!(said.starts_with("written: "), "{said}");
    }
    assert_eq!(case.succeeds(&["--missing", &parts, "3"]), "");
    assert_eq!(files(&parts), ["rank-1-of-3.json", "rank-2-of-3.json", "rank-3-of-3.json"]);
    // to the last byte, in JSON and in words
    assert_eq!(case.succeeds(&["--merge", &parts, "--json"]), case.succeeds(&["--no-times", "--json"]));
    assert_eq!(case.succeeds(&["--merge", &parts]), case.succeeds(&["--no-times"]));
    let more = ["--digits", "12", "--json"];
    let one_run = case.succeeds(&[&more[..], &["--no-times"]].concat());
    assert_eq!(case.succeeds(&[&more[..], &["--merge", &parts]].concat()), one_run);

    // a part that is there is left alone, whoever asks for it
    let path = Path::new(&parts).join("rank-2-of-3.json");
    let before = std::fs::metadata(&path).unwrap().modified().unwrap();
    let again = json(&case.run(&["--shard", "2/3", "--part", &parts, "--json"]));
    assert_eq!((&again["was_there"], &again["whole"]), (&json!(true), &json!(true)));
    assert_eq!(std::fs::metadata(&path).unwrap().modified().unwrap(), before);
    // one that is damaged counts as missing, is refused by a merge, and made again
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert_eq!(case.succeeds(&["--missing", &parts, "3"]), "2\n");
    let said = case.refused(&["--merge", &parts]);
    assert!(said.contains("rank-2-of-3.json: this is no part of a sweep"), "{said}");
    case.succeeds(&["--shard", "2/3", "--part", &parts]);
    assert_eq!(std::fs::read(&path).unwrap(), whole);
}

#[test]
fn parts_that_are_no_whole_are_refused_by_name() {
    let case = Case::new(&["rank", "--samples", "100"]);
    let parts = case.path("parts");
    assert!(case.refused(&["--merge", &parts]).contains("cannot read"));
    case.succeeds(&["--shard", "1/3", "--part", &parts]);
    assert!(case.refused(&["--merge", &parts]).contains("no part has the states 33 to 99"));
    case.succeeds(&["--shard", "3/3", "--part", &parts]);
    assert!(case.refused(&["--merge", &parts]).contains("no part has the states 33 to 65"));
    case.succeeds(&["--shard", "2/4", "--part", &parts]);
    let said = case.refused(&["--merge", &parts]);
    assert!(said.contains("rank-1-of-3.json") && said.contains("both have the states 25 to 32"), "{said}");
    // another seed
    let said = case.refused(&["--seed", "2", "--merge", &parts]);
    assert!(said.contains("belongs to another question"), "{said}");
    let said = case.refused(&["--seed", "2", "--shard", "1/3", "--part", &parts]);
    assert!(said.contains("rank-1-of-3.json belongs to another question"), "{said}");
    for wrong in ["0/3", "4/3", "1", "1/0", "-1/3", "1/1000001", "a/b"] {
        assert_eq!(case.run(&["--shard", wrong, "--part", &parts]).status.code(), Some(2), "{wrong}");
    }
    assert!(case.refused(&["--missing", &parts, "none"]).contains("'none' is no number of shards"));
}

/// By pairs of shards the tables have each state once; as CSV and as Parquet they say the same.
#[test]
fn a_table_has_a_row_for_each_state() {
    let case = Case::new(&["rank", "--samples", "500"]);
    let (whole, columns) = (case.path("whole.csv"), case.path("whole.parquet"));
    let found: Value =
        serde_json::from_str(&case.succeeds(&["--table", &whole, "--coordinates", "--json"])).unwrap();
    let text = std::fs::read_to_string(&whole).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("index,rank,certified,smallest_singular_value,condition,x,y,z"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!((rows.len(), found["samples"].as_u64()), (500, Some(500)));
    for (place, row) in rows.iter().enumerate() {
        assert_eq!((row[0], row[1], row[2]), (place.to_string().as_str(), "3", "true"));
        assert!(row[3].parse::<f64>().unwrap() > 0.0 && row[4].parse::<f64>().unwrap() >= 1.0);
        assert!(row[5..].iter().all(|value| value.parse::<f64>().unwrap().abs() <= 1.0));
    }
    let halves: Vec<String> = ["1/2", "2/2"]
        .map(|shard| {
            let table = case.path(&format!("{}.csv", &shard[..1]));
            case.succeeds(&[
                "--shard",
                shard,
                "--part",
                &case.path("parts"),
                "--table",
                &table,
                "--coordinates",
            ]);
            std::fs::read_to_string(table).unwrap().split_once('\n').unwrap().1.to_owned()
        })
        .into();
    assert_eq!(halves.concat(), text.split_once('\n').unwrap().1);

    case.succeeds(&["--table", &columns, "--coordinates"]);
    let file = std::fs::File::open(&columns).unwrap();
    let reader = parquet::file::serialized_reader::SerializedFileReader::new(file).unwrap();
    let mut count = 0;
    for (row, expected) in reader.into_iter().zip(&rows) {
        let row = row.unwrap().to_string();
        let cells: Vec<&str> = row.trim_matches(['{', '}']).split(", ").collect();
        assert!(cells[0].ends_with(&format!("index: {}", expected[0])), "{row}");
        assert_eq!(cells[4], format!("condition: {}", expected[4]), "{row}");
        count += 1;
    }
    assert_eq!(count, 500);
    let said = case.refused(&["--table", &case.path("states.txt")]);
    assert!(said.contains("neither a .csv nor a .parquet file"), "{said}");
}

/// What was open is dealt out, each box to one: nothing is lost and nothing counts twice, and going on from there is going on.
#[test]
fn open_boxes_are_dealt_out_and_put_together_again() {
    let case = Case::of(FEW_MINORS, &["certify", "--boxes", "150"]);
    let (state, parts, next) = (case.path("open.txt"), case.path("parts"), case.path("next.txt"));
    assert!(case.refused(&["--shard", "1/3", "--part", &parts]).contains("'--state' names none"));
    let first: Value = serde_json::from_str(&case.succeeds(&["--state", &state, "--json"])).unwrap();
    let base = std::fs::read_to_string(&state).unwrap();
    assert_eq!(case.succeeds(&["--state", &state, "--missing", &parts, "3"]), "1\n2\n3\n");
    for shard in ["2/3", "1/3", "3/3"] {
        case.succeeds(&["--state", &state, "--shard", shard, "--part", &parts]);
    }
    assert_eq!(
        std::fs::read_to_string(&state).unwrap(),
        base,
        "a share changes nothing of what it was dealt from"
    );
    let merge = ["--state", &state, "--merge", &parts, "--merged", &next, "--json"];
    let merged: Value = serde_json::from_str(&case.succeeds(&merge)).unwrap();
    let number = |found: &Value, name: &str| found[name].as_f64().unwrap();
    assert_eq!(merged["boxes"], 600);
    assert!(number(&merged, "proved_fraction") > number(&first, "proved_fraction"));
    // volumes are exact: what is proved, what vanishes and the rest are all of it
    let sum: f64 = ["proved_fraction", "minor_vanishes_fraction", "rest_fraction"]
        .iter()
        .map(|name| number(&merged, name))
        .sum();
    assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    // a search that is taken up has to cover the box
    let on: Value = serde_json::from_str(&case.succeeds(&["--state", &next, "--json"])).unwrap();
    assert_eq!(on["boxes"], 750);
    assert!(number(&on, "proved_fraction") >= number(&merged, "proved_fraction"));

    let one = Path::new(&parts).join("certify-2-of-3.part");
    let text = std::fs::read_to_string(&one).unwrap();
    std::fs::write(&one, text.replacen("proved 0", "proved 1", 1)).unwrap();
    assert!(case.refused(&merge[..4]).contains("damaged"));
    std::fs::remove_file(&one).unwrap();
    assert!(case.refused(&merge[..4]).contains("share 2 of 3 is missing"));
    // of another search
    std::fs::write(&one, text).unwrap();
    let other = ["--state", &next, "--merge", &parts];
    assert!(case.refused(&other).contains("belongs to another question"));
}
