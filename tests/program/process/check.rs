//! `check`: all that is wrong with a file, each mistake once and at its place.

use crate::common::{folder, json, write};
use crate::process::{finish, program, words};
use serde_json::json;
use std::path::Path;

/// Line and message of each error, in the order in which they are told.
fn errors(file: &Path) -> Vec<(u64, String)> {
    let output = finish(&mut program(&["check", file.to_str().unwrap(), "--json"]));
    let found = json(&output);
    let list = found["errors"].as_array().unwrap_or_else(|| panic!("{}", words(&output)));
    assert_eq!(output.status.code(), Some(if list.is_empty() { 0 } else { 2 }), "{}", words(&output));
    assert_eq!(found["ok"], list.is_empty());
    let one = |error: &serde_json::Value| {
        assert!(error["column"].as_u64() >= Some(1), "{error}");
        assert_eq!(error["file"], file.display().to_string());
        (error["line"].as_u64().expect("a line"), error["message"].as_str().expect("a message").to_owned())
    };
    list.iter().map(one).collect()
}

fn lines(text: &str) -> Vec<u64> {
    let folder = folder();
    let file = write(&folder, "a.proof", text);
    errors(&file).into_iter().map(|(line, _)| line).collect()
}

/// Each row: a file, and the lines of its mistakes. What only follows from a mistake is none.
#[test]
fn every_mistake_is_told_once_and_at_its_line() {
    for (text, expected) in [
        // syntax, an unknown name, a shape, an identifier twice
        (
            "system \"s\"\nstate x\ndrift f\n  x' = -x\nlet a = (x + 1\nlet b = x + nobody\noutput x\n\
             claim 1: b = [x]\nclaim 2: [x, x] = [x; x]\nclaim 2: x = x\nclaim 3: x = \n",
            &[5, 6, 9, 10, 11][..],
        ),
        // several unknown names in one expression
        ("system \"s\"\nstate x\nclaim 1: one + x = two*sin(three)\n", &[3, 3, 3]),
        // what rests on a name that failed is not told: neither definitions, claims nor fields
        ("system \"s\"\nstate x\nlet a = x +* 2\nlet b = a + 1\nclaim 1: b = a\nclaim 2: c = b\n", &[3, 6]),
        (
            "system \"s\"\nstate x\ndrift f\n  x' = missing\noutput x\nclaim 1: L(f, x) = x\nclaim 2: rank = 1\n",
            &[4],
        ),
        ("system \"s\"\nstate x,\ndrift f\n  x' = y\noutput x\nclaim 1: d(x) = [1, 0]\n", &[2, 4]),
        (
            "system \"s\"\nuse g = \"none.proof\"\nstate x\nclaim 1: L(g.f, x) = g.v\nclaim 2: y = x\n",
            &[2, 5],
        ),
        // an entry whose end is lost in a quotation
        (
            "system \"s\"\nstate x\ndefinition 1: \"never closed\nlet a = x\nclaim 2: a = b\nclaim 3: a = x \"r\"\n",
            &[3, 5],
        ),
        // entries that are indented as a whole
        ("  system \"s\"\n  state x\n  let a = (x\n  let b = c\n", &[3, 4]),
        // references
        ("system \"s\"\nstate x\nclaim 1 restates 7: x = x\nclaim 2 restates 8: x = x\n", &[3, 4]),
        // what is missing at the end of an entry is marked there
        ("system \"s\"\nstate x\nclaim 1: x = +\nclaim 2 restates 1: x = x\n", &[3]),
        // no title, and a title that cannot be read
        ("state x\nclaim 1: x = y\n", &[1, 2]),
        ("system s\nstate x\nclaim 1: x = y\n", &[1, 3]),
        ("system \"s\"\nstate x\nset \"a\": x = y\nmap \"b\": x in [0, 1]\nclaim 1: x = z\n", &[3, 4, 5]),
        ("system \"s\"\nstate x\nclaim 1: x = x\n", &[]),
    ] {
        assert_eq!(lines(text), expected, "{text}");
    }
}

/// A file that cannot be imported is one mistake: what stands above the import is known below it.
#[test]
fn behind_an_import_that_fails_the_names_above_it_are_known() {
    let folder = folder();
    write(&folder, "broken.proof", "system \"b\"\nstate q\nlet a = b\n");
    let head = "system \"s\"\nstate x : length, y\nparam k : time\nuse o = \"broken.proof\"\n";
    let rest = "let z = k*x\nlet w = y*o.a\ndrift f\n  x' = y\n  y' = y/k + sin(x)\nclaim 1: z = k*x\nclaim 2: z = nobody\n";
    let file = write(&folder, "a.proof", format!("{head}{rest}"));
    let found = errors(&file);
    // the import, the sine of a length, a number added to an acceleration, a name
    assert_eq!(found.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [4, 9, 9, 11], "{found:?}");
    assert!(found[0].1.contains("broken.proof:3:9: unknown name 'b'"), "{found:?}");
}

/// The problem that `prove` tells is the one that is found, for each file with one mistake.
#[test]
fn a_file_with_one_mistake_has_one() {
    for (line, text) in [
        (2, "system \"s\"\nstate pi\nclaim 1: cos(0) = 1\n"),
        (3, "system \"s\"\nstate x\nsample x in [2, 1]\nclaim 1: x = x\n"),
        (3, "system \"s\"\nstate x\nstate x\nclaim 1: x = x\n"),
        (3, "system \"s\"\nstate x\nlet a = [1, 2; 3]\nclaim 1: a = a\n"),
    ] {
        let folder = folder();
        let file = write(&folder, "a.proof", text);
        let found = errors(&file);
        let proved = json(&finish(&mut program(&["prove", file.to_str().unwrap(), "--json"])));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].0, &json!(found[0].1)), (line, &proved["error"]["message"]), "{text}");
    }
}

#[test]
fn errors_are_shown_where_they_are_and_counted() {
    let folder = folder();
    let file = write(&folder, "a.proof", "system \"s\"\nstate x\nclaim 1: x = y\nclaim 2: z = x\n");
    let fine = write(&folder, "b.proof", "system \"s\"\nstate x\nclaim 1: x = x\n");
    let output = finish(&mut program(&["check", file.to_str().unwrap(), fine.to_str().unwrap()]));
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("unknown name 'y'") && text.contains("unknown name 'z'"), "{text}");
    assert!(text.contains("a.proof:3:14") && text.contains("claim 2: z = x"), "{text}");
    assert!(text.trim_end().ends_with("2 errors in 1 of 2 files"), "{text}");
    let fine = finish(&mut program(&["check", fine.to_str().unwrap()]));
    assert_eq!(
        (fine.status.code(), String::from_utf8_lossy(&fine.stdout).trim()),
        (Some(0), "1 file can be read")
    );
}

#[test]
fn of_very_many_errors_so_many_are_told() {
    let folder = folder();
    let claims: String = (0..500).map(|n| format!("claim {n}: x = y{n}\n")).collect();
    let file = write(&folder, "a.proof", format!("system \"s\"\nstate x\n{claims}"));
    assert_eq!(errors(&file).len(), 100);
    let broken: String = (0..500).map(|n| format!("claim {n}: x = \n")).collect();
    write(&folder, "a.proof", format!("system \"s\"\nstate x\n{broken}"));
    assert_eq!(errors(&file).len(), 100);
    let output = finish(&mut program(&["check", file.to_str().unwrap()]));
    assert!(String::from_utf8_lossy(&output.stdout).contains("and more"), "{}", words(&output));
}

#[test]
fn shipped_files_can_be_read_and_a_missing_one_is_told() {
    let output = finish(&mut program(&["check", "proofs", "--json"]));
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(json(&output)["files"].as_u64() > Some(20));
    let output = finish(&mut program(&["check", "no/such.proof", "--json"]));
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert_eq!(json(&output)["errors"][0]["file"], "no/such.proof");
}
