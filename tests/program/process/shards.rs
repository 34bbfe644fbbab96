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

/// One whose minors cost little.
const CUBIC: &str = "system \"s\"\nstate x, y\ndrift f\n  x' = y\n  y' = -x\noutput x^3 + y\nsample x in [-1, 2] y in [-1, 3]\n";

const OSCILLATOR: &str = "system \"s\"\nstate x, y\nparam mu = 1.4\ndrift f\n  x' = y\n  y' = mu*(1 - x^2)*y - x\noutput x\n\
                          sample x in [-2, 2] y in [-2, 2]\n";

const SCENE: &str = "title = \"s\"\nmodel = \"s.proof\"\nduration = 1\nsamples = 21\n[start]\nx = 1.2\ny = -0.5\n\
                     [sensor]\nnoise = 0.01\n[observer]\nmethods = [\"trust-region\", \"newton\"]\nestimate = [\"x\", \"y\"]\n\
                     window = 20\nsteps = 10\n";

const STUDIES: &str = "[study.noise]\nlevels = [1e-3, 1e-2]\nseeds = 4\n\
                       [study.basin]\nx = [-2, 2]\ny = [-2, 2]\npoints = 2\n";

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

    /// A scene of an oscillator, with these studies.
    fn scene(studies: &str) -> Case {
        let mut case = Case::of(OSCILLATOR, &["observe"]);
        let scene = write(&case.folder, "s.toml", format!("{SCENE}{studies}"));
        case.command = vec!["observe".to_owned(), scene.display().to_string()];
        case
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

/// The studies of a scene are trials that are dealt out: 8 draws of noise, and 4 first guesses for each of two methods.
#[test]
fn studies_in_shards_are_those_of_one_run() {
    let case = Case::scene(STUDIES);
    let one_run = case.succeeds(&["--studies", "--no-times", "--json"]);
    let found: Value = serde_json::from_str(&one_run).unwrap();
    assert_eq!((found["noise"].as_array().unwrap().len(), found["basins"].as_array().unwrap().len()), (2, 2));
    assert_eq!(found["noise"][1]["seeds"], 4);
    for of in ["1", "3", "7"] {
        let parts = case.path(of);
        let missing = case.succeeds(&["--missing", &parts, of]);
        for number in missing.lines().rev() {
            let shard = format!("{number}/{of}");
            assert!(case.succeeds(&["--shard", &shard, "--part", &parts]).starts_with("written: "));
        }
        assert_eq!(case.succeeds(&["--missing", &parts, of]), "");
        // to the last byte
        assert_eq!(case.succeeds(&["--merge", &parts, "--json"]), one_run, "{of}");
    }
    let parts = case.path("3");
    assert_eq!(files(&parts), ["observe-1-of-3.json", "observe-2-of-3.json", "observe-3-of-3.json"]);
    assert_eq!(case.succeeds(&["--merge", &parts]), case.succeeds(&["--studies", "--no-times"]));
    let again = json(&case.run(&["--shard", "2/3", "--part", &parts, "--json"]));
    assert_eq!((&again["was_there"], &again["whole"]), (&json!(true), &json!(true)));
    // one that is damaged counts as missing, and is made again to the same bytes
    let path = Path::new(&parts).join("observe-2-of-3.json");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert_eq!(case.succeeds(&["--missing", &parts, "3"]), "2\n");
    assert!(case.refused(&["--merge", &parts]).contains("observe-2-of-3.json: this is no part of a sweep"));
    case.succeeds(&["--shard", "2/3", "--part", &parts]);
    assert_eq!(std::fs::read(&path).unwrap(), whole);
    // gaps, overlaps, other questions
    std::fs::remove_file(&path).unwrap();
    assert!(case.refused(&["--merge", &parts]).contains("no part has the trials 5 to 9"));
    case.succeeds(&["--shard", "2/4", "--part", &parts]);
    let said = case.refused(&["--merge", &parts]);
    assert!(said.contains("observe-1-of-3.json") && said.contains("both have the trials 4 to 4"), "{said}");
    let said = case.refused(&["--seed", "2", "--merge", &parts]);
    assert!(said.contains("observe-1-of-3.json belongs to another question"), "{said}");
    write(&case.folder, "s.proof", OSCILLATOR.replace("= 1.4", "= 1.5"));
    let said = case.refused(&["--shard", "1/3", "--part", &parts]);
    assert!(said.contains("observe-1-of-3.json belongs to another question"), "{said}");
}

#[test]
fn what_is_no_study_cannot_be_cut() {
    let case = Case::scene("");
    let parts = case.path("parts");
    for asked in
        [&["--shard", "1/2", "--part", &parts][..], &["--merge", &parts], &["--missing", &parts, "2"]]
    {
        assert!(case.refused(asked).contains("the scene has no studies"), "{asked:?}");
    }
    let case = Case::scene(STUDIES);
    let record = case.path("record.csv");
    case.succeeds(&["--record", &record]);
    let said = case.refused(&["--data", &record, "--shard", "1/2", "--part", &parts]);
    assert!(said.contains("a study needs the true states"), "{said}");
    assert_eq!(case.run(&["--shard", "1/2", "--part", &parts, "--out", &parts]).status.code(), Some(2));
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

/// To a depth it is the same however boxes are dealt out: oracle, the one search, which knows of no shares.
#[test]
fn boxes_to_a_depth_are_those_of_one_search() {
    let case = Case::of(CUBIC, &["certify"]);
    let (state, alone) = (case.path("open.txt"), case.path("alone.txt"));
    case.succeeds(&["--boxes", "40", "--state", &state]);
    std::fs::copy(&state, &alone).unwrap();
    let saved = |path: &str| std::fs::read_to_string(path).unwrap();
    // the time that a search took is in its file, and no part of what it found
    let told = |text: &str| {
        let mut found: Value = serde_json::from_str(text).unwrap();
        let found_fields = found.as_object_mut().unwrap();
        found_fields.retain(|name, _| name != "seconds" && name != "curve");
        assert!(found["boxes"].as_u64() > Some(100), "{found}");
        found
    };
    let one = told(&case.succeeds(&["--depth", "13", "--state", &alone, "--json"]));
    assert_ne!(saved(&state), saved(&alone));
    let verdicts = [case.path("one.json"), case.path("merged.json")];
    // nothing is open up to there any more, and what is deeper is left alone
    let again = ["--depth", "13", "--state", &alone, "--json", "--verdicts", &verdicts[0]];
    let mut again = told(&case.succeeds(&again));
    again.as_object_mut().unwrap().remove("verdict_boxes");
    assert_eq!(again, one);
    for of in ["1", "3", "7"] {
        let parts = case.path(of);
        for number in case.succeeds(&["--state", &state, "--missing", &parts, of]).lines() {
            let shard = format!("{number}/{of}");
            case.succeeds(&["--depth", "13", "--state", &state, "--shard", &shard, "--part", &parts]);
        }
        let merged = ["--state", &state, "--merge", &parts, "--json", "--verdicts", &verdicts[1]];
        let mut merged = told(&case.succeeds(&merged));
        merged.as_object_mut().unwrap().remove("verdict_boxes");
        assert_eq!(merged, one, "{of}");
        // and the proved boxes that are kept, with their minors
        assert_eq!(saved(&verdicts[0]), saved(&verdicts[1]), "{of}");
    }
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
    let sum: f64 = ["proved_fraction", "minor_vanishes_fraction", "open_fraction"]
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
