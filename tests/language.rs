//! The language says what it means: fields have roles, and what is declared twice is refused.

mod common;

use common::{folder, json, palmistry, write};
use palmistry::system::Role;
use palmistry::{System, decide_all};
use std::path::Path;

fn system(text: &str) -> System {
    System::parse("test.proof", text, Path::new("")).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The verdict words of all claims.
fn words(text: &str) -> Vec<&'static str> {
    decide_all(&system(text), 1, &false.into(), &|_| ()).iter().map(|outcome| outcome.word()).collect()
}

/// Three states of which the drift moves one and the outputs see one: by hand, d(x) and d(L_f x) = d(y), and z is in
/// neither. `aside` moves x by z: a rank that took it for an input would find three.
fn three(role: &str) -> String {
    format!(
        "system \"three\"\nstate x, y, z\ndrift f\n  x' = y\n  others' = 0\n{role} aside\n  x' = z\n  others' = 0\n\
         output x\nsample x in [1, 2] y in [1, 2] z in [1, 2]\nclaim derivative: L(aside, x) = z\nclaim two: rank = 2\n"
    )
}

#[test]
fn a_field_that_is_only_differentiated_along_raises_no_rank() {
    assert_eq!(words(&three("field")), ["proved", "proved"]);
    assert_eq!(words(&three("input")), ["proved", "refuted"]);
    let folder = folder();
    for (role, rank, fields) in [
        ("field", 2, serde_json::json!([{ "name": "f", "role": "drift" }])),
        (
            "input",
            3,
            serde_json::json!([{ "name": "f", "role": "drift" }, { "name": "aside", "role": "input" }]),
        ),
    ] {
        let file = write(&folder, "three.proof", three(role));
        let file = file.to_str().unwrap();
        let found = json(&palmistry(&["rank", file, "--samples", "20", "--json"]));
        assert_eq!(found["rank_histogram"], serde_json::json!({ rank.to_string(): 20 }));
        assert_eq!(found["fields"], fields);
        let found = json(&palmistry(&["certify", file, "--boxes", "10", "--json"]));
        assert_eq!(found["fields"], fields);
        let found = json(&palmistry(&["trade", file, "--samples", "10", "--json"]));
        assert_eq!(found["fields"], fields);
        let claims = json(&palmistry(&["prove", file, "--json"]));
        assert_eq!(claims["claims"][1]["fields"], fields, "{claims}");
        assert!(claims["claims"][0].get("fields").is_none(), "{claims}");
        let text = palmistry(&["rank", file, "--samples", "20"]);
        let text = String::from_utf8(text.stdout).unwrap();
        assert!(text.contains("fields: drift f"), "{text}");
        assert_eq!(text.contains("input aside"), role == "input", "{text}");
    }
}

/// Inputs alone move a system too; a drift may stand behind them, and the order of declaration says nothing.
#[test]
fn inputs_and_drift_in_any_order() {
    let text = "system \"s\" state x, y input g x' = y others' = 0 output x claim 1: rank = 2";
    assert_eq!(words(text), ["proved"]);
    let text = "system \"s\" state x, y field v x' = 1 y' = 1 input g x' = y others' = 0 drift f others' = 0 output x";
    let found = system(text);
    let roles: Vec<Role> = found.fields.iter().map(|field| field.role).collect();
    assert_eq!(roles, [Role::Other, Role::Input, Role::Drift]);
    assert_eq!((found.moving_fields(), found.drift()), (vec![1, 2], Some(2)));
}

/// A second drift is refused where it stands.
#[test]
fn a_system_has_one_drift() {
    let text = "system \"s\"\nstate x\ndrift f\n  x' = 1\ndrift h\n  x' = 2\n";
    let error = System::parse("test.proof", text, Path::new("")).unwrap_err();
    assert_eq!(error.line_and_column(), (5, 7));
    assert!(error.message.contains("a drift 'f' already"), "{error}");
    assert!(error.help.unwrap().contains("input h"));
}

/// A rank of nothing that moves is refused with the line and the word to add, by every command that decides one.
#[test]
fn a_rank_without_drift_and_input_is_refused() {
    let text =
        "system \"s\"\nstate x, y\n\nfield f\n  x' = y\n  y' = 0\noutput x\nsample x in [1, 2] y in [1, 2]\n";
    let error = System::parse("test.proof", &format!("{text}claim 1: rank = 2"), Path::new("")).unwrap_err();
    assert_eq!(error.line_and_column(), (4, 7));
    assert!(error.message.contains("'field f' is only differentiated along"), "{error}");
    assert!(error.help.unwrap().contains("drift f"));
    let folder = folder();
    let file = write(&folder, "plain.proof", text);
    for command in ["rank", "certify", "trade"] {
        let output = palmistry(&[command, file.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(2), "{command}");
        let message = json(&output)["error"]["message"].as_str().unwrap().to_owned();
        assert!(message.contains("line 4: 'field f'") && message.contains("drift f"), "{command}: {message}");
    }
    // what needs no rank reads the file as it is
    assert_eq!(words(&format!("{text}claim 1: L(f, x) = y")), ["proved"]);
    // no field at all: the claim is marked, and what to write is said
    let text = "system \"s\"\nstate x\noutput x\nclaim 1: rank = 1";
    let error = System::parse("test.proof", text, Path::new("")).unwrap_err();
    assert_eq!(error.line_and_column(), (4, 10));
    assert!(error.help.unwrap().contains("drift f  others' = 0"));
    assert_eq!(words("system \"s\" state x drift f others' = 0 output x claim 1: rank = 1"), ["proved"]);
}

/// An imported field keeps its role, and is in no rank of the file that imports it.
#[test]
fn imported_fields_are_in_no_rank() {
    let folder = folder();
    write(&folder, "other.proof", "system \"other\" state x, y drift f x' = y y' = 0 output x");
    let text = "system \"s\" use other = \"other.proof\" state x, y output x";
    let refused = System::parse("s.proof", &format!("{text} claim 1: rank = 2"), folder.path()).unwrap_err();
    assert!(refused.message.contains("declares no field that moves its states"), "{refused}");
    let text = format!("{text} drift rest others' = 0 claim 1: rank = 1 claim 2: L(other.f, x) = y");
    let found = System::parse("s.proof", &text, folder.path()).unwrap();
    let outcomes = decide_all(&found, 1, &false.into(), &|_| ());
    assert!(outcomes.iter().all(|outcome| outcome.ok), "{outcomes:?}");
}
