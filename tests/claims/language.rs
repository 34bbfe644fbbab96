//! The language says what it means: fields have roles, and what is declared twice is refused.

use crate::common::{folder, json, palmistry, write};
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
    assert_eq!(words(&three("field")), ["holds by definition", "proved"]);
    assert_eq!(words(&three("input")), ["holds by definition", "refuted"]);
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
        assert!(text.contains("; drift f"), "{text}");
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
    assert_eq!(words(&format!("{text}claim 1: L(f, x) = y")), ["holds by definition"]);
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

/// A text and the message that it is refused with, with line and column.
fn refused(text: &str, folder: &Path) -> (String, (usize, usize)) {
    match System::parse("test.proof", text, folder) {
        Ok(_) => panic!("not refused: {text}"),
        Err(error) => (error.message.clone(), error.line_and_column()),
    }
}

/// What would overwrite something in silence is refused where it stands.
#[test]
fn nothing_is_overwritten_in_silence() {
    let folder = folder();
    write(&folder, "a.proof", "system \"a\" state x, y param k = 1 let v = x + k drift f x' = y y' = 0");
    write(&folder, "b.proof", "system \"b\" state x, y param k = 2 let v = x - k drift f x' = -y y' = 0");
    for (text, words, place) in [
        (
            "system \"s\"\nuse a = \"a.proof\"\nuse a = \"b.proof\"",
            "'a' is the name of an imported system",
            (3, 5),
        ),
        ("system \"s\"\nuse a.b = \"a.proof\"", "a name with a dot", (2, 5)),
        ("system \"s\"\nstate x\nsystem \"t\"", "describes a system already: \"s\"", (3, 1)),
        ("system \"\"", "needs a title", (1, 1)),
        ("system \"s\" state x\nsample x in [0, 1]\n  x in [2, 3]", "'x' has a range already", (3, 3)),
        ("system \"s\" state x\nsample x in [0, 1]\nsample x in [0, 1]", "'x' has a range already", (3, 8)),
        ("system \"s\" state x\nparam x", "'x' has a meaning already", (2, 7)),
        ("system \"s\" param x = 2\nstate x", "'x' has a meaning already", (2, 7)),
        ("system \"s\" state x\nlet x = 2", "'x' has a meaning already", (2, 5)),
        ("system \"s\" let x = 2\nparam x", "'x' has a meaning already", (2, 7)),
        ("system \"s\" state x, y,\n  x", "'x' has a meaning already", (2, 3)),
        ("system \"s\" state\n others", "'others' is a word of the language", (2, 2)),
        ("system \"s\" param\n pi", "'pi' has a meaning already", (2, 2)),
        ("system \"s\" use a = \"a.proof\"\nlet k = 3", "'k' is a symbol of an imported system", (2, 5)),
        ("system \"s\" let k = 3\nuse a = \"a.proof\"", "'k' is a definition above, and a symbol of", (2, 1)),
        ("system \"s\" state x\nfield a.f x' = 1", "a name with a dot", (2, 7)),
        ("system \"s\" state x\nfield f x' = 1\ninput f x' = 1", "there is a field 'f' already", (3, 7)),
        ("system \"s\" state x let r = d(x^2)\nstate y", "differentiated by all states", (2, 7)),
        ("system \"s\" state x field f\n x' = 1 x' = 2", "'x' is given twice", (2, 9)),
        ("system \"s\" param k claim 1: k = k\nclaim 1: k = 2", "there is a claim '1' already", (2, 7)),
        ("system \"s\" state x claim 1: x at {x = 1,\n x = 2} = 1", "'x' is given twice", (2, 2)),
    ] {
        let (message, found) = refused(text, folder.path());
        assert!(message.contains(words), "{text}: {message}");
        assert_eq!(found, place, "{text}: {message}");
    }
}

/// And what may be said twice means one thing.
#[test]
fn what_may_be_said_twice_means_one_thing() {
    let folder = folder();
    write(
        &folder,
        "a.proof",
        "system \"a\" state x, y param k = 1, m = 1 let v = -x + k*m drift f x' = y y' = 0",
    );
    write(&folder, "b.proof", "system \"b\" state x, y param k = 2, m = 1 let v = x - k*m");
    // one file under two names
    let text = "system \"s\" use a = \"a.proof\" use c = \"a.proof\" state x, y claim 1: a.v = c.v claim 2: L(a.f, x) = L(c.f, x)";
    let system_of =
        |text: &str| System::parse("s.proof", text, folder.path()).unwrap_or_else(|e| panic!("{e}"));
    let all_hold = |text: &str| decide_all(&system_of(text), 1, &false.into(), &|_| ()).iter().all(|o| o.ok);
    assert!(all_hold(text));
    // names of imported definitions are explained under the names that they have here
    let outcome = decide_all(&system_of(text), 1, &false.into(), &|_| ()).remove(1);
    assert_eq!(outcome.differentiated_along[0], ("a.f".to_owned(), "x' = y y' = 0".to_owned()));
    // where two imports give a parameter two values it has none; where they agree it has that
    let system = system_of("system \"s\" use a = \"a.proof\" use b = \"b.proof\" state x, y");
    let value = |name: &str| system.symbol_info(system.find_symbol(name).unwrap()).unwrap().default.clone();
    assert_eq!((value("k"), value("m")), (None, Some(1.into())));
    // an angle is one wherever that is said
    for order in ["angle p output sin(p)", "output sin(p) angle p", "angle p angle p output sin(p)"] {
        assert_eq!(
            words(&format!("system \"s\" state p {order} claim 1: sin(p)^2 = 1 - cos(p)^2")),
            ["proved"]
        );
    }
    // an output that is named twice is one output
    assert_eq!(system_of("system \"s\" state x, y output x, y, x output -(-y)").outputs.len(), 2);
    // a function is a function where a bracket follows, and a name elsewhere
    assert_eq!(
        words("system \"s\" state L, d, sin field f L' = d others' = 0 claim 1: L(f, L*sin) = d*sin"),
        ["proved"]
    );
}

/// Whatever an editor shows as the end of a line ends a comment: a false claim below it is read, and its place is right.
#[test]
fn no_claim_hides_below_a_comment() {
    for end in
        ["\n", "\r\n", "\r", "\u{b}", "\u{c}", "\u{85}", "\u{2028}", "\u{2029}", "\u{1c}", "\u{1d}", "\u{1e}"]
    {
        let text = format!("system \"s\"{end}param x # a note{end}claim 1: x = x + 1 # and another{end}");
        assert_eq!(words(&text), ["refuted"], "{end:?}");
        let text = format!("system \"\u{e9}\" # \u{fc}{end}param x # a note{end}claim 1: \u{e9} = 1");
        let (_, place) = refused(&text, Path::new(""));
        assert_eq!(place, (3, 10), "{end:?}");
    }
    // marks that turn the direction of writing make a claim look like a comment
    for mark in ['\u{202e}', '\u{2066}', '\u{200f}'] {
        let text = format!("system \"s\"\nparam x # {mark}note\nclaim 1: x = x");
        let (message, place) = refused(&text, Path::new(""));
        assert!(message.contains(&format!("U+{:04X}", mark as u32)), "{message}");
        assert_eq!(place, (2, 11));
    }
    assert_eq!(words("\u{feff}system \"s\" param x claim 1: x = x"), ["holds by definition"]);
}

/// A value in a file is what `rank` takes; a claim is about all values, and says where that makes a difference. With k = 0
/// the output does not see y: by hand the rank is 2 for every other k.
#[test]
fn a_value_in_a_file_is_never_part_of_a_claim() {
    let text = "system \"s\" state x, y param k = 0, m = 2.5, idle = 7 drift f x' = k*y y' = m*x output x\n\
                sample x in [1, 2] y in [1, 2]\n\
                claim rank: rank = 2\n\
                claim same: L(f, x) = k*y\n\
                claim wrong: k*x = x\n\
                claim given: rank = 2 where k = 3\n\
                claim zero: rank = 1 where k = 0\n\
                claim pole: x/k = x/k\n\
                claim matrix: rank([k, 1; 0, m]) = 2";
    let outcomes = decide_all(&system(text), 1, &false.into(), &|_| ());
    let found: Vec<(&str, &str, Option<&str>)> = outcomes
        .iter()
        .map(|o| (o.id.as_str(), o.word(), o.at_files_values.as_ref().map(|special| special.word)))
        .collect();
    assert_eq!(
        found[..5],
        [
            ("rank", "proved", Some("refuted")),
            ("same", "holds by definition", None),
            ("wrong", "refuted", None),
            ("given", "proved", None),
            ("zero", "proved", None),
        ]
    );
    assert_eq!(found[6], ("matrix", "proved", Some("refuted")));
    let special = outcomes[0].at_files_values.as_ref().unwrap();
    let names: Vec<&str> = special.values.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["k", "m"]);
    let folder = folder();
    let file = write(&folder, "k.proof", text);
    let file = file.to_str().unwrap();
    let found = json(&palmistry(&["prove", file, "--json"]));
    let special = serde_json::json!({ "values": { "k": "0", "m": "2.5" }, "verdict": "refuted" });
    assert_eq!(found["claims"][0]["at_the_files_values"], special);
    assert!(found["claims"][1].get("at_the_files_values").is_none());
    let shown = String::from_utf8(palmistry(&["prove", file]).stdout).unwrap();
    assert!(shown.contains("at the file's values k = 0, m = 2.5 it is refuted"), "{shown}");
    let found = json(&palmistry(&["rank", file, "--samples", "10", "--json"]));
    assert_eq!(found["rank_histogram"], serde_json::json!({ "1": 10 }));
    assert_eq!(found["fixed_at_the_files_values"], serde_json::json!({ "k": "0", "m": "2.5" }));
    let found = json(&palmistry(&["rank", file, "--samples", "10", "--at", "k=1", "--json"]));
    assert_eq!(found["rank_histogram"], serde_json::json!({ "2": 10 }));
    assert_eq!(found["fixed_at_the_files_values"], serde_json::json!({ "m": "2.5" }));
    let shown = String::from_utf8(palmistry(&["rank", file, "--samples", "10"]).stdout).unwrap();
    assert!(shown.contains("fixed at the values in the file: k = 0, m = 2.5"), "{shown}");
}

/// `within` compares numbers, and takes none from the file either.
#[test]
fn within_takes_no_value_from_the_file() {
    let text = "system \"s\" param k = 2 claim 1: k = 2 within 0.1 claim 2: k at {k = 2} = 2 within 0.1";
    assert_eq!(words(text), ["undecided", "proved"]);
}

/// A refuted rank names a state and the rank there: by hand 1 for [x, 1; x^2, x], whatever x is, and for k = 0 above.
#[test]
fn a_refuted_rank_names_a_state() {
    let text = "system \"s\" state x, y, z drift f x' = y others' = 0 output x*x\n\
                claim matrix: rank([x, 1; x^2, x]) = 2\n\
                claim full: rank = 3\n\
                claim short: rank = 1\n\
                claim on_a_set: rank([x, 1; x^2, y]) = 2 where y = x";
    for outcome in decide_all(&system(text), 1, &false.into(), &|_| ()) {
        let palmistry::Verdict::Refuted { witness, .. } = &outcome.verdict else { panic!("{outcome:?}") };
        let value = |name: &str| {
            let found = witness.state.iter().find(|at| at.name == *name);
            found.map(|at| palmistry::number::parse_decimal(&at.exact).unwrap())
        };
        let (rank, claimed) = match outcome.id.as_str() {
            "matrix" | "on_a_set" => ("1", "2"),
            // d(x^2), d(2xy), d(2y^2): two, outside x = 0 and y = 0
            "full" => ("2", "3"),
            _ => ("2", "1"),
        };
        assert_eq!((witness.left.as_str(), witness.right.as_str()), (rank, claimed), "{outcome:?}");
        assert!(value("x").is_some_and(|x| !x.is_zero()), "{outcome:?}");
        if outcome.id == "on_a_set" {
            assert_eq!(value("x"), value("y"), "{outcome:?}");
        }
    }
}

/// Two sides that are alike to more digits than are shown at first are shown until they differ.
#[test]
fn the_two_sides_of_a_witness_differ_in_print() {
    let text = "system \"s\" param x claim 1: x + 1/123456789012345678901234567890123456789 = x\n\
                claim 2: pi + 1/123456789012345678901234567890123456789 = pi claim 3: x + 1e-3000 = x";
    for outcome in decide_all(&system(text), 1, &false.into(), &|_| ()) {
        let palmistry::Verdict::Refuted { witness, .. } = &outcome.verdict else { panic!("{outcome:?}") };
        assert_ne!(witness.left, witness.right, "{outcome:?}");
    }
}
