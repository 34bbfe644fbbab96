//! Files that are none, that never end, that import one another; and numbers and names that are too large.

use crate::common::{folder, json, write};
use crate::process::{SMALL, finish, in_shell, program, words};
use std::process::Command;

fn message(output: &std::process::Output) -> String {
    json(output)["error"]["message"].as_str().unwrap_or_else(|| panic!("{}", words(output))).to_owned()
}

/// A device without end, a folder, and a pipe to which nobody writes.
#[test]
fn what_is_no_file_is_refused_in_words() {
    let folder = folder();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let file = write(&folder, "small.proof", SMALL).display().to_string();
    assert!(Command::new("mkfifo").arg(place("pipe")).status().unwrap().success());
    for name in ["zero.csv", "zero.parquet"] {
        std::os::unix::fs::symlink("/dev/zero", place(name)).unwrap();
    }
    std::fs::create_dir(place("folder.csv")).unwrap();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002/scenes/same_rate.toml");
    for (run, why) in [
        (vec!["prove", "/dev/zero"], "longer than"),
        (vec!["rank", "/dev/zero"], "longer than"),
        (vec!["rank", "/"], "is a folder"),
        (vec!["prove", &place("pipe")], "nobody writes to it"),
        (vec!["observe", "/dev/zero"], "longer than"),
        (vec!["observe", "/"], "is a folder"),
        (vec!["observe", scene, "--data", &place("zero.csv")], "longer than"),
        (vec!["observe", scene, "--data", &place("zero.parquet")], "longer than"),
        (vec!["observe", scene, "--data", &place("folder.csv")], "is a folder"),
        (vec!["certify", &file, "--state", "/dev/zero"], "is no file"),
        (vec!["certify", &file, "--state", "/"], "is no file"),
        (vec!["certify", &file, "--state", &place("pipe")], "is no file"),
    ] {
        let output = finish(&mut program(&[run.as_slice(), &["--json"]].concat()));
        assert_eq!(output.status.code(), Some(2), "{run:?}: {}", words(&output));
        assert!(message(&output).contains(why), "{run:?}: {}", words(&output));
    }
}

/// A scene that names a device is not told that there is no such file.
#[test]
fn what_a_scene_names_and_is_no_file_is_told_from_what_is_not_there() {
    let folder = folder();
    write(&folder, "a.proof", SMALL);
    let place = |name: &str| folder.path().join(name).display().to_string();
    assert!(Command::new("mkfifo").arg(place("pipe.csv")).status().unwrap().success());
    for (model, record, why) in [
        ("/dev/zero", "run.csv", "/dev/zero is no regular file"),
        ("a.proof", "/dev/zero", "/dev/zero is no regular file"),
        ("a.proof", "pipe.csv", "pipe.csv is no regular file"),
        ("a.proof", "none.csv", "there is no file"),
        ("a.proof", "a.proof/run.csv", "there is no file"),
    ] {
        let text = format!(
            "title = \"a\"\nmodel = \"{model}\"\n[data]\nrecord = \"{record}\"\n[observer]\nestimate = [\"x\", \"y\"]\n"
        );
        let scene = write(&folder, "a.toml", text);
        let output = finish(&mut program(&["observe", scene.to_str().unwrap(), "--json"]));
        assert_eq!(output.status.code(), Some(2), "{record}: {}", words(&output));
        assert!(message(&output).contains(why), "{model} {record}: {}", words(&output));
    }
    let text = "title = \"a\"\nmodel = \"/dev/zero\"\nmeasurements = \"run.csv\"\nerrors = { x = { size = 1 } }\nparameters = { k = { bounds = [1, 2] } }\n[experiments.one]\n";
    let scene = write(&folder, "b.toml", text);
    let output = finish(&mut program(&["observe", scene.to_str().unwrap(), "--json"]));
    assert!(message(&output).contains("is no regular file"), "{}", words(&output));
}

/// A pipe of the shell's is as good as a file.
#[test]
fn a_pipe_that_somebody_writes_to_is_read() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    let file = file.to_str().unwrap();
    let expected = finish(&mut program(&["eval", file, "x + 1", "--at", "x=1/3"]));
    for line in [
        "\"$0\" eval <(cat \"$1\") 'x + 1' --at x=1/3",
        "\"$0\" eval <(sleep 0.2; cat \"$1\") 'x + 1' --at x=1/3",
        "cat \"$1\" | \"$0\" eval /dev/stdin 'x + 1' --at x=1/3",
    ] {
        let output = finish(&mut in_shell(line, &[file]));
        assert_eq!(output.status.code(), Some(0), "{line}: {}", words(&output));
        assert_eq!(output.stdout, expected.stdout, "{line}");
    }
}

/// What some editors put in front of a text is no part of it.
#[test]
fn a_byte_order_mark_is_accepted_everywhere() {
    let folder = folder();
    let marked = |text: &str| format!("\u{feff}{text}");
    write(&folder, "imported.proof", marked(SMALL));
    let file = write(
        &folder,
        "marked.proof",
        marked("system \"a\" use s = \"imported.proof\" claim 1: s.rows = s.rows"),
    );
    let output = finish(&mut program(&["prove", file.to_str().unwrap()]));
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));

    let root = env!("CARGO_MANIFEST_DIR");
    let scene = std::fs::read_to_string(format!("{root}/proofs/moll2002/scenes/same_rate.toml")).unwrap();
    let scene = scene.replace("\"../", &format!("\"{root}/proofs/moll2002/"));
    let (plain, marked_scene) = (write(&folder, "a.toml", &scene), write(&folder, "b.toml", marked(&scene)));
    let table = folder.path().join("table.csv");
    let observe = |scene: &std::path::Path, more: &[&str]| {
        finish(&mut program(&[&["observe", scene.to_str().unwrap(), "--json"], more].concat()))
    };
    let first = observe(&plain, &["--record", table.to_str().unwrap()]);
    let second = observe(&marked_scene, &[]);
    assert_eq!(first.status.code(), second.status.code(), "{}", words(&second));
    let numbers = |output: &std::process::Output| {
        let mut object = json(output);
        crate::common::without_times(&mut object);
        object["observers"].clone()
    };
    assert_eq!(numbers(&first), numbers(&second));
    let text = std::fs::read_to_string(&table).unwrap();
    write(&folder, "table.csv", marked(&text));
    let record = palmistry::observer::Record::read(&table, &[]).unwrap();
    assert_eq!(record.len(), text.lines().count() - 1);
}

#[test]
fn a_number_that_is_too_long_is_pointed_at() {
    let folder = folder();
    let file = write(&folder, "a.proof", "system \"a\"\nstate x\nlet a = 2 +\n  1e99999\n");
    let output = finish(&mut program(&["prove", file.to_str().unwrap(), "--json"]));
    let error = json(&output)["error"].clone();
    assert_eq!((error["line"].as_u64(), error["column"].as_u64()), (Some(4), Some(5)), "{error}");
    assert!(error["message"].as_str().unwrap().contains("exponent of at most"), "{error}");
    let file = write(&folder, "small.proof", SMALL);
    for run in [
        vec!["eval", file.to_str().unwrap(), "x", "--at", "x=1e99999"],
        vec!["eval", file.to_str().unwrap(), "x + 1e99999", "--at", "x=1"],
        vec!["certify", file.to_str().unwrap(), "--box", "x=0..1e99999"],
    ] {
        let output = finish(&mut program(&[run.as_slice(), &["--json"]].concat()));
        assert_eq!(output.status.code(), Some(2), "{run:?}");
        assert!(message(&output).contains("exponent of at most"), "{run:?}: {}", words(&output));
    }
}

#[test]
fn any_number_of_threads_may_be_asked_for() {
    let folder = folder();
    let file = write(&folder, "small.proof", SMALL);
    let expected = finish(&mut program(&["prove", file.to_str().unwrap()]));
    for threads in ["99999999", "340282366920938463463374607431768211456", "0", "-1", "many", ""] {
        let mut command = program(&["prove", file.to_str().unwrap()]);
        let output = finish(command.env("RAYON_NUM_THREADS", threads));
        assert_eq!(output.status.code(), Some(0), "{threads}: {}", words(&output));
        // all but how long it took, which stands last
        let found = |output: &std::process::Output| {
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            text.rsplit_once(", ").expect("a summary").0.to_owned()
        };
        assert_eq!(found(&output), found(&expected), "{threads}");
    }
}

/// Exactly one JSON object, also where the command line is not understood.
#[test]
fn a_command_line_that_is_not_understood_is_json_under_json() {
    for run in [
        vec!["prove", "--json"],
        vec!["--json"],
        vec!["prove", "a.proof", "--json", "--nonsense"],
        vec!["rank", "a.proof", "--samples", "0", "--json"],
        vec!["rank", "a.proof", "--order", "13", "--json"],
        vec!["certify", "a.proof", "--budget", "-1", "--json"],
        vec!["nonsense", "--json"],
    ] {
        let output = finish(&mut program(&run));
        assert_eq!(output.status.code(), Some(2), "{run:?}: {}", words(&output));
        assert!(!message(&output).is_empty() && !message(&output).starts_with("error"), "{run:?}");
        assert!(!output.stderr.is_empty(), "{run:?}");
    }
    let plain = finish(&mut program(&["prove", "--nonsense"]));
    assert!(plain.stdout.is_empty(), "{}", words(&plain));
    let name = finish(&mut program(&["prove", "--", "--json"]));
    assert!(name.stdout.is_empty(), "a file of that name: {}", words(&name));
}

/// Each file is read once, however many ways lead to it.
#[test]
fn imports_that_meet_again_are_read_once() {
    let folder = folder();
    let chain = |uses: usize| {
        for level in 0..8 {
            let next = format!("l{}.proof", level + 1);
            let uses: String = (0..uses).map(|i| format!("use u{i} = \"{next}\"\n")).collect();
            write(&folder, &format!("l{level}.proof"), format!("system \"{level}\"\n{uses}claim 1: 1 = 1\n"));
        }
        write(&folder, "l8.proof", "system \"8\"\nstate x\nlet a = x\n");
        finish(&mut program(&["prove", folder.path().join("l0.proof").to_str().unwrap(), "--json"]))
    };
    let output = chain(4);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let output = chain(20);
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert!(message(&output).contains("names"), "{}", words(&output));
}

#[test]
fn a_circle_of_imports_is_named() {
    let folder = folder();
    let a = write(&folder, "a.proof", "system \"a\" use b = \"b.proof\" claim 1: 1 = 1");
    write(&folder, "b.proof", "system \"b\" use c = \"./c.proof\"");
    write(&folder, "c.proof", "system \"c\" use a = \"a.proof\"");
    let output = finish(&mut program(&["prove", a.to_str().unwrap(), "--json"]));
    assert_eq!(output.status.code(), Some(2));
    let said = message(&output);
    assert!(said.contains("imports itself: a.proof -> b.proof -> c.proof -> a.proof"), "{said}");
}

/// Verdicts of which no proof file is where `recheck` looks are no verdicts without doubt. Of two files one may be gone, which is said of its verdicts; and of no verdicts none is in doubt.
#[test]
fn verdicts_without_their_proof_files_are_refused() {
    let folder = folder();
    let text = "system \"s\" state x drift f x' = -x output x\nclaim 1: (x + 1)^2 = x^2 + 2*x + 1\n";
    for name in ["a.proof", "b.proof"] {
        write(&folder, name, text);
    }
    let verdicts = folder.path().join("verdicts.json");
    let run = |arguments: &[&str]| {
        let output = finish(program(arguments).current_dir(folder.path()));
        (output.status.code(), json(&output))
    };
    let name = verdicts.to_str().unwrap();
    assert_eq!(run(&["prove", "a.proof", "b.proof", "--verdicts", name, "--json"]).0, Some(0));
    assert_eq!(run(&["recheck", name, "--json"]).0, Some(0));
    let (status, found) = run(&["recheck", name, "--proofs", "elsewhere", "--json"]);
    let error = &found["error"];
    assert_eq!(status, Some(2), "{found}");
    assert!(error["message"].as_str().is_some_and(|message| message.contains("no proof file")), "{found}");
    assert!(error["help"].as_str().is_some_and(|help| help.contains("--proofs")), "{found}");
    std::fs::remove_file(folder.path().join("b.proof")).unwrap();
    let (status, found) = run(&["recheck", name, "--json"]);
    assert_eq!(
        (status, &found["confirmed"], &found["not_checked"]),
        (Some(0), &1.into(), &1.into()),
        "{found}"
    );
    let mut none: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&verdicts).unwrap()).unwrap();
    none["verdicts"] = serde_json::Value::Array(Vec::new());
    write(&folder, "verdicts.json", none.to_string());
    assert_eq!(run(&["recheck", name, "--json"]).0, Some(0));
}
