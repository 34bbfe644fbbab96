//! Limits of the system, names that are no text, channels that lie.

use crate::common::{folder, write};
use std::ffi::OsString;
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn program() -> &'static str {
    env!("CARGO_BIN_EXE_palmistry")
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn names(folder: &Path) -> Vec<String> {
    let mut found: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    found.sort();
    found
}

/// A file that becomes longer than it may be leaves nothing behind, and says so.
#[test]
fn a_limit_on_the_size_of_files_leaves_nothing_behind() {
    let folder = folder();
    let rates: String = (0..400).map(|i| format!("x{i}' = -x{i}\n")).collect();
    write(&folder, "a.txt", rates);
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 1; exec \"$0\" import a.txt --out b.proof", program()])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert_eq!(names(folder.path()), ["a.txt"], "{}", text(&output));
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 1; exec \"$0\" new paper", program()])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert_eq!(names(folder.path()), ["a.txt"], "{}", text(&output));
}

/// Names that are no UTF-8 are names.
#[test]
fn names_that_are_no_text_are_used_and_shown() {
    let folder = folder();
    let odd = |end: &str| {
        let mut bytes = b"n\xff\x1b".to_vec();
        bytes.extend(end.bytes());
        OsString::from_vec(bytes)
    };
    let run = |arguments: &[&OsString]| {
        let output = Command::new(program()).args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.code().is_some_and(|code| code < 3), "{}", text(&output));
        assert!(
            !text(&output).contains("panicked") && !text(&output).contains('\u{1b}'),
            "{}",
            text(&output)
        );
        output
    };
    let word = |text: &str| OsString::from(text);
    let (json, fmt, new, import, prove) =
        (word("--json"), word("fmt"), word("new"), word("import"), word("prove"));
    let (check, rank, out, verify) = (word("check"), word("rank"), word("--out"), word("verify"));
    let made = run(&[&new, &odd("paper"), &json]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made));
    assert!(folder.path().join(odd("paper")).join("paper.toml").is_file());
    write(&folder, "a.txt", "x' = -k*x\ny = x\n");
    for last in [None, Some(&json)] {
        let mut arguments: Vec<&OsString> = Vec::new();
        let (from, to) = (word("a.txt"), odd("b.proof"));
        arguments.extend([&import, &from, &out, &to]);
        arguments.extend(last);
        assert_eq!(run(&arguments).status.code(), Some(0));
    }
    std::fs::write(folder.path().join(odd("c.proof")), "system \"c\"\nstate x\n  claim 1: x = x\n").unwrap();
    for verb in [&fmt, &check, &rank, &prove] {
        run(&[verb, &odd("c.proof"), &json]);
        run(&[verb, &odd("c.proof")]);
    }
    run(&[&verify, &odd("paper"), &json]);
}

/// A message of 100 GB is refused before there is room for it, in a process that may have one.
#[test]
fn an_editor_cannot_ask_for_a_hundred_gigabytes() {
    for header in
        ["Content-Length: 100000000000\r\n\r\n{}", "Content-Length: 18446744073709551615\r\n\r\n", "x: y"]
    {
        let mut child = Command::new("sh")
            .args(["-c", "ulimit -v 4000000; exec \"$0\" lsp --stdio", program()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(header.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(
            !text(&output).contains("panicked") && !text(&output).contains("memory"),
            "{}",
            text(&output)
        );
    }
}
