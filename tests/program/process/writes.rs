//! A write that fails is told; what is no file is not replaced.

use crate::common::{folder, json, write};
use crate::process::{SMALL, files, finish, in_shell, program, words};
use std::os::unix::fs::FileTypeExt;
use std::process::{Command, Stdio};

/// One run of each command that is over soon.
fn runs(file: &str) -> Vec<Vec<String>> {
    let all: [&[&str]; 9] = [
        &["prove", file],
        &["prove", file, "--json"],
        &["rank", file, "--samples", "10"],
        &["certify", file, "--boxes", "10"],
        &["trade", file, "--samples", "2"],
        &["stress", file, "--states", "1", "--samples", "1"],
        &["eval", file, "x + 1", "--at", "x=1"],
        &["--help"],
        &["--version"],
    ];
    all.iter().map(|run| run.iter().map(|word| (*word).to_owned()).collect()).collect()
}

#[test]
fn results_that_cannot_be_printed_are_status_two() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    for run in runs(file.to_str().unwrap()) {
        let run: Vec<&str> = run.iter().map(String::as_str).collect();
        for line in ["exec \"$0\" \"$@\" > /dev/full", "exec \"$0\" \"$@\" >&-"] {
            let output = finish(&mut in_shell(line, &run));
            assert_eq!(output.status.code(), Some(2), "{run:?} {line}: {}", words(&output));
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(said.contains("standard output"), "{run:?} {line}: {said}");
        }
    }
}

/// Who has read enough goes away; that is no error, and no word is lost over it.
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    let mut child = program(&["prove", file.to_str().unwrap(), "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = crate::process::end_of(child);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(output.stderr.is_empty(), "{}", words(&output));
}

/// Standard error that cannot be written costs its words and nothing else.
#[test]
fn words_that_cannot_be_said_change_no_status() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    let (file, bad) = (file.to_str().unwrap(), write(&folder, "bad.proof", "system"));
    let out = folder.path().join("out");
    let all: [(&[&str], i32); 5] = [
        (&["prove", bad.to_str().unwrap()], 2),
        (&["prove", "--nonsense"], 2),
        (&["eval", file, "1/x", "--at", "x=0"], 2),
        (&["stress", file, "--states", "1", "--samples", "1", "--out", out.to_str().unwrap()], 0),
        (&["prove", file], 0),
    ];
    for (run, status) in all {
        for line in ["exec \"$0\" \"$@\" 2> /dev/full", "exec \"$0\" \"$@\" 2>&-"] {
            let output = finish(&mut in_shell(line, run));
            assert_eq!(output.status.code(), Some(status), "{run:?} {line}: {}", words(&output));
        }
    }
}

/// What could not be written beside the results is named in them, and costs them nothing.
#[test]
fn results_that_cannot_be_kept_are_still_printed() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    let file = file.to_str().unwrap();
    let taken = write(&folder, "taken", "a file, where a folder is asked for");
    let (taken, inside) = (taken.to_str().unwrap(), taken.join("claims.xml"));
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002/scenes/same_rate.toml");
    let all: [(&[&str], &str); 8] = [
        (&["prove", file, "--junit", "/dev/full"], "claims"),
        (&["prove", file, "--junit", inside.to_str().unwrap()], "claims"),
        (&["certify", file, "--boxes", "10", "--out", taken], "proved_fraction"),
        (&["certify", file, "--boxes", "10", "--state", inside.to_str().unwrap()], "proved_fraction"),
        (&["trade", file, "--samples", "2", "--out", taken], "combinations"),
        (&["stress", file, "--states", "1", "--samples", "1", "--out", taken], "studies"),
        (&["observe", scene, "--record", "/dev/full"], "observers"),
        (&["observe", scene, "--out", taken], "observers"),
    ];
    for (run, found) in all {
        let output = finish(&mut program(&[run, &["--json"]].concat()));
        if run.contains(&"--record") {
            // a device has no extension, and a record needs one: that is known before anything is done
            assert_eq!(output.status.code(), Some(2), "{}", words(&output));
            let object = json(&output);
            let message = object["error"]["message"].as_str().unwrap_or_default();
            assert!(message.contains("is neither a .csv nor a .parquet file"), "{run:?}: {}", words(&output));
            continue;
        }
        assert_eq!(output.status.code(), Some(2), "{run:?}: {}", words(&output));
        let object = json(&output);
        if run.contains(&"--out") {
            // that is known before anything is found
            let message = object["error"]["message"].as_str().unwrap_or_default();
            assert!(message.contains("is a file, and --out names a folder"), "{run:?}: {}", words(&output));
            continue;
        }
        assert!(!object[found].is_null(), "{run:?}: {}", words(&output));
        let why = object["unwritten"][0]["why"].as_str().unwrap_or_default();
        assert!(why.contains("cannot write"), "{run:?}: {}", words(&output));
        assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write"), "{run:?}");
    }
    assert_eq!(files(folder.path()), ["small.proof", "taken"]);
}

/// What is said to be written is what was.
#[test]
fn what_could_not_be_written_is_not_said_to_be() {
    let folder = folder();
    let spoilt = "system \"s\"\n  state x\n";
    let (file, other) = (write(&folder, "a.proof", spoilt), write(&folder, "b.proof", "system \"s\"\n"));
    // no file may grow
    let full = "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"";
    let run = ["fmt", file.to_str().unwrap(), other.to_str().unwrap()];
    let output = finish(&mut in_shell(full, &run));
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said, format!("left as it is: {}\n", file.display()));
    let found = json(&finish(&mut in_shell(full, &[&run[..], &["--json"]].concat())));
    assert_eq!(found["changed"], serde_json::json!([]), "{found}");
    assert_eq!(found["unwritten"][0]["file"], file.display().to_string(), "{found}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), spoilt);

    let inside = file.join("man1");
    let output = finish(&mut program(&["man", "--out", inside.to_str().unwrap()]));
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said, format!("0 pages in {}\n", inside.display()));
}

/// Devices, links and pipes are what they were; the same words arrive as in a file.
#[test]
fn only_files_are_replaced() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    let file = file.to_str().unwrap();
    let place = |name: &str| folder.path().join(name);
    let junit = |to: &str| finish(&mut program(&["prove", file, "--junit", to]));

    std::os::unix::fs::symlink("/dev/null", place("null")).unwrap();
    assert_eq!(junit(place("null").to_str().unwrap()).status.code(), Some(0));
    assert!(place("null").is_symlink());
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());

    std::os::unix::fs::symlink("target.xml", place("link.xml")).unwrap();
    for _ in 0..2 {
        assert_eq!(junit(place("link.xml").to_str().unwrap()).status.code(), Some(0));
        assert!(place("link.xml").is_symlink() && !place("target.xml").is_symlink());
        assert!(std::fs::read_to_string(place("target.xml")).unwrap().contains("<testsuites"));
    }

    assert!(Command::new("mkfifo").arg(place("pipe")).status().unwrap().success());
    let line = format!("\"$0\" \"$@\" > /dev/null & cat {}; wait $!", place("pipe").display());
    let piped = finish(&mut in_shell(&line, &["prove", file, "--junit", place("pipe").to_str().unwrap()]));
    assert_eq!(piped.status.code(), Some(0), "{}", words(&piped));
    assert!(String::from_utf8_lossy(&piped.stdout).contains("<testsuites"));
    assert!(std::fs::metadata(place("pipe")).unwrap().file_type().is_fifo());

    // all names of standard output: a pipe, and a file that the shell holds open
    for name in ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        let output = junit(name);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", words(&output));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.contains("<testsuites") && text.contains("2 claims"), "{name}: {text}");
        let line = format!("\"$0\" \"$@\" > {}", place("both.txt").display());
        let output = finish(&mut in_shell(&line, &["prove", file, "--junit", name]));
        assert_eq!(output.status.code(), Some(0), "{name}: {}", words(&output));
        let text = std::fs::read_to_string(place("both.txt")).unwrap();
        assert!(text.contains("<testsuites") && text.contains("2 claims"), "{name}: {text}");
    }
    let expected = ["both.txt", "link.xml", "null", "pipe", "small.proof", "target.xml"];
    assert_eq!(files(folder.path()), expected, "nothing is left beside them");
}

/// A record goes to standard output as comma-separated values.
#[test]
fn a_record_can_be_printed() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002/scenes/same_rate.toml");
    let output = finish(&mut program(&["observe", scene, "--record", "-"]));
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.starts_with("time,"), "{text}");
    assert!(text.lines().take(10).all(|line| line.contains(',')), "{text}");
}
