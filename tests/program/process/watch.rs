//! `prove --watch`: a file is edited, and the second report is another one.

use crate::common::{folder, write};
use crate::process::{program, signal};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// A report that has not come by then does not come.
const LATE: Duration = Duration::from_secs(60);

/// A run that watches, and the lines that it prints.
struct Run {
    child: Child,
    lines: Receiver<String>,
}

impl Run {
    fn begin(arguments: &[&str]) -> Run {
        let mut command = program(&[&["prove", "--watch"], arguments].concat());
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program runs");
        let out = BufReader::new(child.stdout.take().expect("a pipe"));
        let (tell, lines) = channel();
        std::thread::spawn(move || {
            for line in out.lines().map_while(Result::ok) {
                let _ = tell.send(line);
            }
        });
        Run { child, lines }
    }

    fn line(&self) -> String {
        self.lines.recv_timeout(LATE).expect("a line")
    }

    fn report(&self) -> Value {
        let line = self.line();
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
    }

    /// Interrupts it, and tells its status.
    fn end(mut self) -> Option<i32> {
        signal("INT", &self.child.id().to_string());
        self.child.wait().expect("it ends").code()
    }
}

fn again(report: &Value) -> Vec<String> {
    let name =
        |path: &Value| Path::new(path.as_str().unwrap()).file_name().unwrap().to_string_lossy().into_owned();
    report["decided_again"].as_array().unwrap_or_else(|| panic!("{report}")).iter().map(name).collect()
}

#[test]
fn what_is_changed_is_decided_again_and_what_imports_it() {
    let folder = folder();
    let system = |more: &str| format!("system \"s\"\nstate x\nlet a = 2*x\n{more}");
    write(&folder, "base.proof", system("claim 1: a = x + x\n"));
    write(&folder, "user.proof", "system \"u\"\nuse base = \"base.proof\"\nstate x\nclaim 2: base.a = 2*x\n");
    write(&folder, "other.proof", system("claim 3: a = x + x\n"));
    let run = Run::begin(&[folder.path().to_str().unwrap(), "--json"]);
    let first = run.report();
    assert_eq!(again(&first), ["base.proof", "other.proof", "user.proof"]);
    assert_eq!((&first["ok"], first["claims"].as_array().unwrap().len()), (&Value::Bool(true), 3));

    // an edit that changes what another file imports
    write(&folder, "base.proof", system("claim 1: a = x + x\n").replace("2*x", "3*x"));
    let second = run.report();
    assert_eq!(again(&second), ["base.proof", "user.proof"]);
    let verdict = |report: &Value, id: &str| {
        let claims = report["claims"].as_array().unwrap();
        claims.iter().find(|claim| claim["id"] == id).unwrap_or_else(|| panic!("{id}"))["verdict"].clone()
    };
    assert_eq!(second["ok"], false);
    assert_eq!((verdict(&second, "1"), verdict(&second, "2")), ("refuted".into(), "refuted".into()));
    assert_eq!(verdict(&second, "3"), verdict(&first, "3"));

    // a file that cannot be read is told, and the others stay
    write(&folder, "other.proof", system("claim 3: a = nobody\nclaim 4: b = x\n"));
    let third = run.report();
    assert_eq!(again(&third), ["other.proof"]);
    assert_eq!(third["errors"].as_array().unwrap().len(), 2, "{third}");
    assert_eq!(third["claims"].as_array().unwrap().len(), 2);

    // an editor that puts a new file in the place of the old one; and one more file
    write(&folder, "new", system("claim 3: a = x + x\n"));
    std::fs::rename(folder.path().join("new"), folder.path().join("other.proof")).unwrap();
    let fourth = run.report();
    assert_eq!(again(&fourth), ["other.proof"]);
    write(&folder, "base.proof", system("claim 1: a = x + x\n"));
    let fifth = run.report();
    assert_eq!(
        (again(&fifth), &fifth["ok"]),
        (vec!["base.proof".into(), "user.proof".into()], &Value::Bool(true))
    );
    std::fs::remove_file(folder.path().join("other.proof")).unwrap();
    let sixth = run.report();
    assert_eq!((again(&sixth).len(), sixth["claims"].as_array().unwrap().len()), (0, 2));
    assert_eq!(run.end(), Some(0));
}

#[test]
fn reports_in_words_say_what_was_decided_and_the_status_is_that_of_the_last() {
    let folder = folder();
    let file = write(&folder, "a.proof", "system \"s\"\nstate x\nclaim 1: x = x + 0\n");
    let run = Run::begin(&[file.to_str().unwrap()]);
    let summary = |run: &Run| loop {
        let line = run.line();
        assert!(!line.contains('\u{1b}'), "{line}");
        if line.contains(" not as expected") {
            return line;
        }
    };
    assert!(run.line().starts_with("decided: "));
    assert!(summary(&run).contains("0 not as expected"));
    write(&folder, "a.proof", "system \"s\"\nstate x\nclaim 1: x = x + 1\n");
    assert!(run.line().starts_with("decided: "));
    assert!(summary(&run).contains("1 not as expected"));
    assert_eq!(run.end(), Some(1));
}

/// As without `--watch`: it stands in the report, and the status is 2.
#[test]
fn what_cannot_be_written_is_named_in_each_report() {
    let folder = folder();
    let file = write(&folder, "a.proof", "system \"s\"\nstate x\nclaim 1: x = x + 0\n");
    let inside = file.join("claims.xml");
    let run = Run::begin(&[file.to_str().unwrap(), "--json", "--junit", inside.to_str().unwrap()]);
    let report = run.report();
    assert_eq!(report["unwritten"][0]["file"], inside.display().to_string(), "{report}");
    assert_eq!((&report["ok"], run.end()), (&true.into(), Some(2)));
}

/// A folder that has lost its files takes no other ones with it, and a file without claims is not taken for an interrupt.
#[test]
fn what_is_gone_or_empty_is_told_as_that() {
    let (one, other) = (folder(), folder());
    let text = |rest: &str| format!("system \"s\"\nstate x\n{rest}");
    write(&one, "a.proof", text("claim 1: x = x + 0\n"));
    let kept = write(&other, "b.proof", text("claim 2: x = x + 0\n"));
    let run = Run::begin(&[one.path().to_str().unwrap(), kept.to_str().unwrap(), "--json"]);
    assert_eq!(run.report()["claims"].as_array().map(Vec::len), Some(2));
    std::fs::remove_file(one.path().join("a.proof")).unwrap();
    let left = run.report();
    assert_eq!((&left["claims"][0]["id"], &left["ok"]), (&"2".into(), &true.into()), "{left}");
    assert_eq!((left["claims"].as_array().map(Vec::len), again(&left).len()), (Some(1), 0), "{left}");
    assert_eq!(run.end(), Some(0));

    let run = Run::begin(&[kept.to_str().unwrap()]);
    let until_the_summary = || {
        let mut lines = vec![run.line()];
        while !lines.last().unwrap().contains(" not as expected, ") {
            lines.push(run.line());
        }
        lines
    };
    until_the_summary();
    write(&other, "b.proof", text(""));
    assert!(until_the_summary().last().unwrap().starts_with("0 claims; "));
    // what stands below that summary would be the first line of the next report
    write(&other, "b.proof", text("claim 2: x = y\n"));
    assert!(until_the_summary()[0].starts_with("decided: "));
    write(&other, "b.proof", text("claim 2: x = x + 1\n"));
    assert!(until_the_summary()[0].starts_with("decided: "));
    assert_eq!(run.end(), Some(1));
}

/// What is not there when it begins is a mistake, as it is without it.
#[test]
fn a_folder_without_files_ends_it() {
    let folder = folder();
    let mut run = Run::begin(&[folder.path().to_str().unwrap()]);
    assert_eq!(run.child.wait().unwrap().code(), Some(2));
}
