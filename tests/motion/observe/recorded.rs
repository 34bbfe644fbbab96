//! Readings from files: what was recorded gives what was simulated, and damage is named by its row.

use crate::common::{folder, palmistry, write};
use crate::observe::{observe, refusal, text, with};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The scene for recordings: `same_rate` with a first guess in numbers, about ten percent off, which a file can have too.
fn scene(folder: &TempDir, on_fault: &str) -> PathBuf {
    let text = with(&text("same_rate"), "guess_off = 0.1", "guess = { r1 = 1.3, r2 = 1.3, omega0 = -0.9 }");
    write(folder, "scene.toml", format!("{text}\n[data]\non_fault = \"{on_fault}\"\n"))
}

/// A recording of the scene; its times are those of `--record`.
fn record(folder: &TempDir, scene: &Path, name: &str) -> (PathBuf, Value) {
    let path = folder.path().join(name);
    let (output, found) = observe(scene, &["--record", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    (path, found)
}

fn replayed(scene: &Path, data: &Path) -> (std::process::Output, Value) {
    observe(scene, &["--data", data.to_str().unwrap()])
}

/// Takes out what a file cannot know: the truth, errors against it, the simulation; and times.
fn without_truth(value: &mut Value) {
    crate::common::without_times(value);
    match value {
        Value::Object(map) => {
            map.retain(|key, _| !["true", "error", "relative_error", "simulation"].contains(&key.as_str()));
            map.values_mut().for_each(without_truth);
        }
        Value::Array(list) => list.iter_mut().for_each(without_truth),
        _ => {}
    }
}

#[test]
fn a_recording_gives_the_same_answers_as_the_simulation() {
    let folder = folder();
    let scene = scene(&folder, "stop");
    for name in ["x.csv", "x.parquet"] {
        let (path, mut simulated) = record(&folder, &scene, name);
        let (output, mut replayed) = replayed(&scene, &path);
        assert_eq!(output.status.code(), Some(0), "{name}: {replayed}");
        assert_eq!(replayed["faults"].as_array().map(Vec::len), Some(0));
        assert!(replayed.get("simulation").is_none() && simulated.get("simulation").is_some());
        assert!(replayed["observers"][0]["updates"][0]["states"]["r1"].get("true").is_none());
        // the file has every digit, and so has every answer: nothing is rounded here
        without_truth(&mut simulated);
        without_truth(&mut replayed);
        // where the body's frame is at first a recording does not tell: the outline is turned, and what does not turn is the same
        let [of_body, of_file] = [&mut simulated, &mut replayed].map(|found| {
            let shape = found.as_object_mut().unwrap().remove("shape").expect("the shape is estimated");
            ["/area/at_least", "/perimeter/at_least", "/mean_radius"].map(|place| {
                shape.pointer(place).and_then(Value::as_f64).unwrap_or_else(|| panic!("{place}: {shape}"))
            })
        });
        for (body, file) in of_body.iter().zip(of_file) {
            assert!((body / file - 1.0).abs() < 1e-12, "{name}: {body} {file}");
        }
        assert_eq!(simulated, replayed, "{name}");
    }
}

/// Times that are a thousand times as large: no motion is followed for ever, and what is wrong is asked for. By hand: 1.4 s over 400 spans, and the root of a radius of 1.1 to 1.3 m over 9.81 m/s^2.
#[test]
fn times_in_milliseconds_end_and_are_named() {
    let folder = folder();
    let scene = scene(&folder, "stop");
    let (path, _) = record(&folder, &scene, "x.csv");
    let table = std::fs::read_to_string(path).unwrap();
    let in_milliseconds = |line: &str| match line.split_once(',') {
        Some((time, rest)) => match time.parse::<f64>() {
            Ok(time) => format!("{},{rest}\n", 1000.0 * time),
            Err(_) => format!("{line}\n"),
        },
        None => format!("{line}\n"),
    };
    let table: String = table.lines().map(in_milliseconds).collect();
    let data = write(&folder, "milliseconds.csv", table);
    let (output, found) = replayed(&scene, &data);
    assert_eq!(output.status.code(), Some(1), "{found}");
    let apart = &found["shape"]["apart"];
    let told = |key: &str| apart[key].as_f64().unwrap_or_else(|| panic!("{key}: {}", found["shape"]));
    assert!((told("between") - 3.5).abs() < 1e-9 && (0.1..1.0).contains(&told("scale")), "{apart}");
    let words = palmistry(&["observe", scene.to_str().unwrap(), "--data", data.to_str().unwrap()]);
    let words = crate::common::words_of(&words);
    assert!(words.contains("Are the times in another unit than s, as milliseconds?"), "{words}");
}

/// A scene's head and its observer, and nothing that is simulated.
fn without_body(whole: &str) -> (String, String) {
    let (head, rest) = whole.split_once("[body]").unwrap();
    let observer = &rest[rest.find("[observer]").unwrap()..];
    let head: String = head
        .lines()
        .filter(|line| !line.starts_with("duration") && !line.starts_with("samples"))
        .map(|line| format!("{line}\n"))
        .collect();
    (head, observer.to_owned())
}

/// A guess that is off is off the body that the scene describes; where it describes none it is refused.
#[test]
fn a_guess_off_needs_what_it_is_off_from() {
    let folder = folder();
    let (path, simulated) = record(&folder, &scene(&folder, "stop"), "x.csv");
    let off = write(&folder, "off.toml", text("same_rate"));
    let (output, found) = replayed(&off, &path);
    assert_eq!(output.status.code(), Some(0), "{found}");
    for name in ["r1", "r2", "omega0"] {
        let truth = simulated["observers"][0]["updates"][0]["states"][name]["true"].as_f64().unwrap();
        let guess = found["first_guess"][name].as_f64().unwrap();
        assert!((guess / truth - 1.1).abs() < 1e-9, "{name}: {guess} and {truth}");
    }
    let (head, observer) = without_body(&text("same_rate"));
    let alone = write(&folder, "alone.toml", format!("{head}{observer}\n[data]\nrecord = \"x.csv\"\n"));
    let (output, found) = observe(&alone, &[]);
    let (message, help) = refusal(&output, &found);
    assert_eq!(message, "recorded data has no truth from which a guess could be off");
    assert!(help.contains("give the first guess itself"), "{help}");
}

/// A scene that names its file itself and describes no body, told the constants that a body would have had.
#[test]
fn a_scene_without_a_body_takes_constants_and_file_as_told() {
    let folder = folder();
    let (_, simulated) = record(&folder, &scene(&folder, "stop"), "x.csv");
    let told = &simulated["given"];
    let known = ["m", "g", "I1", "I2", "rho"].map(|name| format!("{name} = {}", told[name]));
    let (head, observer) = without_body(&std::fs::read_to_string(folder.path().join("scene.toml")).unwrap());
    let observer =
        with(&observer, "window = 80", &format!("window = 80\nknown = {{ {} }}", known.join(", ")));
    let observer = with(&observer, "[data]\n", "[data]\nrecord = \"x.csv\"\n");
    let alone = write(&folder, "alone.toml", format!("{head}{observer}"));
    let (output, found) = observe(&alone, &[]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let states = |found: &Value| {
        let states = &found["observers"][0]["updates"][0]["states"];
        ["r1", "r2", "omega0"].map(|name| states[name]["recovered"].as_f64().unwrap())
    };
    assert_eq!(states(&found), states(&simulated));
}

/// A whole file's lines, damaged: what is wrong, how it comes about, and how what is said of it begins.
type Damage = (&'static str, fn(&mut Vec<String>), &'static [&'static str]);

/// Replaces the column of a line, both counted from zero; line 100 is row 100, for the header is line 0.
fn cell(lines: &mut [String], line: usize, column: usize, value: impl Fn(&str) -> String) {
    let mut cells: Vec<String> = lines[line].split(',').map(str::to_owned).collect();
    cells[column] = value(&cells[column]);
    lines[line] = cells.join(",");
}

const DAMAGES: [Damage; 6] = [
    ("a NaN", |lines| cell(lines, 100, 1, |_| "NaN".to_owned()), &["row 100 (line 101) at 0.34"]),
    ("a word", |lines| cell(lines, 300, 2, |_| "n/a".to_owned()), &["row 300 (line 301) at 1.04"]),
    (
        "a spike",
        |lines| cell(lines, 200, 1, |value| (value.parse::<f64>().unwrap() + 0.05).to_string()),
        &["row 200 (line 201) at 0.69"],
    ),
    ("a gap", |lines| drop(lines.drain(150..154)), &["row 150 (line 151) at 0.53"]),
    // the row that comes too late is missing where it should be
    (
        "two rows that changed places",
        |lines| lines.swap(50, 51),
        &["row 50 (line 51) at 0.17", "row 51 (line 52) at 0.17"],
    ),
    ("a row twice", |lines| lines.insert(60, lines[60].clone()), &["row 61 (line 62) at 0.20"]),
];

#[test]
fn damaged_rows_stop_or_are_skipped_and_are_named_either_way() {
    let folder = folder();
    let stop = scene(&folder, "stop");
    let (path, simulated) = record(&folder, &stop, "x.csv");
    let whole: Vec<String> = std::fs::read_to_string(path).unwrap().lines().map(str::to_owned).collect();
    for (what, damage, rows) in DAMAGES {
        let mut lines = whole.clone();
        damage(&mut lines);
        let data = write(&folder, "damaged.csv", lines.join("\n"));
        let (output, found) = replayed(&scene(&folder, "stop"), &data);
        let (message, help) = refusal(&output, &found);
        assert!(message.contains("damaged.csv has ") && message.contains(" fault"), "{what}: {message}");
        let told: Vec<&str> = message.lines().skip(1).collect();
        let named = |told: &[&str]| told.iter().zip(rows).all(|(fault, row)| fault.starts_with(row));
        assert!(told.len() == rows.len() && named(&told), "{what}: {message}");
        assert!(help.contains("on_fault = \"skip\""), "{what}: {help}");

        let (output, found) = replayed(&scene(&folder, "skip"), &data);
        assert_eq!(output.status.code(), Some(0), "{what}: {found}");
        let faults: Vec<&str> =
            found["faults"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
        assert_eq!(faults, told, "{what}");
        // the other rows are as good as ever: the body is that of the simulation
        let samples = lines.len() - 1 - usize::from(what != "a gap"); // a gap takes no row of those that are there
        assert_eq!(found["samples"], samples, "{what}");
        let update = &found["observers"][0]["updates"][0];
        assert_eq!(update["status"], "converged", "{what}");
        for (name, state) in update["states"].as_object().unwrap() {
            let truth = simulated["observers"][0]["updates"][0]["states"][name]["true"].as_f64().unwrap();
            let error = (state["recovered"].as_f64().unwrap() / truth - 1.0).abs();
            assert!(error < 1e-8, "{what}, {name}: {error:e}");
        }
    }
}

#[test]
fn all_faults_of_a_file_are_listed_together() {
    let folder = folder();
    let (path, _) = record(&folder, &scene(&folder, "stop"), "x.csv");
    let mut lines: Vec<String> = std::fs::read_to_string(path).unwrap().lines().map(str::to_owned).collect();
    // from the end, so that rows before keep their numbers
    for (_, damage, _) in [DAMAGES[1], DAMAGES[2], DAMAGES[3], DAMAGES[0]] {
        damage(&mut lines);
    }
    let data = write(&folder, "damaged.csv", lines.join("\n"));
    let (output, found) = replayed(&scene(&folder, "skip"), &data);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let faults: Vec<&str> = found["faults"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    let rows = ["row 100 ", "row 150 ", "row 196 ", "row 296 "];
    assert_eq!(faults.len(), rows.len(), "{faults:?}");
    assert!(faults.iter().zip(rows).all(|(fault, row)| fault.starts_with(row)), "{faults:?}");
}

/// Of a million rows of one time not all faults are kept: it is said so, and no row is skipped for it.
#[test]
fn more_faults_than_are_kept_are_refused() {
    let folder = folder();
    let scene = scene(&folder, "skip");
    let (path, _) = record(&folder, &scene, "x.csv");
    let whole = std::fs::read_to_string(path).unwrap();
    let mut lines = whole.lines();
    let (header, row) = (lines.next().unwrap(), lines.next().unwrap());
    let many = |count: usize| format!("{header}\n{}", format!("{row}\n").repeat(count));
    let data = write(&folder, "many.csv", many(1_000_002));
    let (output, found) = replayed(&scene, &data);
    let (message, help) = refusal(&output, &found);
    assert!(message.contains("has more than 1000000 faults") && message.ends_with("and more"), "{message}");
    assert!(help.contains("no row is skipped"), "{help}");
    // one less, and all but the first are skipped: nothing is estimated from one sample
    let data = write(&folder, "many.csv", many(1_000_001));
    let (output, found) = replayed(&scene, &data);
    assert_eq!(output.status.code(), Some(1), "{found}");
    assert_eq!((&found["samples"], found["faults"].as_array().map(Vec::len)), (&1.into(), Some(1_000_000)));
}

/// What cannot be read at all is refused whatever is to be done with faulty rows.
#[test]
fn files_that_are_no_recording_are_refused() {
    let folder = folder();
    let (csv, _) = record(&folder, &scene(&folder, "skip"), "x.csv");
    let (parquet, _) = record(&folder, &scene(&folder, "skip"), "x.parquet");
    let whole = std::fs::read_to_string(csv).unwrap();
    let without = whole.lines().map(|line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.remove(2);
        cells.join(",")
    });
    let lacking = write(&folder, "lacking.csv", without.collect::<Vec<_>>().join("\n"));
    let bytes = std::fs::read(parquet).unwrap();
    let short = write(&folder, "short.parquet", &bytes[..bytes.len() / 2]);
    // the end of a Parquet file says where all else is: with the middle gone it says so of what is not there
    let hollow = write(&folder, "hollow.parquet", [&bytes[..100], &bytes[bytes.len() - 2000..]].concat());
    let empty = write(&folder, "empty.csv", "");
    let empty_parquet = write(&folder, "empty.parquet", "");
    let header = write(&folder, "header.csv", whole.lines().next().unwrap());
    let binary = write(&folder, "binary.csv", [0xff, 0xfe, 0x00, 0x01, b'\n', 0x80]);
    let other = write(&folder, "x.txt", &whole);
    let directory = folder.path().join("directory.csv");
    std::fs::create_dir(&directory).unwrap();
    for (file, words) in [
        (lacking, "no column 's2'"),
        (short, "cannot read"),
        (hollow, "cannot read"),
        (empty, "the file is empty"),
        (empty_parquet, "cannot read"),
        (header, "has no rows"),
        (binary, "no column 'time'"),
        (other, "neither a .csv nor a .parquet file"),
        (directory, "cannot read"),
        (folder.path().join("none.csv"), "there is no file"),
    ] {
        for on_fault in ["stop", "skip"] {
            let (output, found) = replayed(&scene(&folder, on_fault), &file);
            if !file.exists() {
                // said before the scene is looked at
                let message = found["error"]["message"].as_str().unwrap_or_default();
                assert!(output.status.code() == Some(2) && message.contains("there is no file"), "{found}");
                continue;
            }
            let (message, _) = refusal(&output, &found);
            let name = file.file_name().unwrap().to_str().unwrap();
            assert!(message.contains(words) && message.contains(name), "{name}: {message}");
        }
    }
}

/// A recording that cannot be written is said so, and nothing of it is left.
#[test]
fn a_recording_is_whole_or_not_there() {
    let folder = folder();
    let scene = scene(&folder, "stop");
    let target = folder.path().join("out.xlsx");
    let output = crate::observe::palmistry(&[
        "observe",
        scene.to_str().unwrap(),
        "--record",
        target.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(2));
    let words = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("neither a .csv nor a .parquet file"), "{words}");
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left, ["scene.toml"], "nothing half written");
}
