//! Bad input gets a clear error at its place, and nothing panics on any input.

use crate::common::{folder, json, palmistry, write};
use palmistry::{System, decide_all};
use proptest::prelude::*;
use std::path::Path;

/// The error as it is shown on a terminal without colours.
fn shown(text: &str) -> String {
    let error = match System::parse("file.proof", text, Path::new("")) {
        Ok(_) => panic!("no error in {text}"),
        Err(error) => error,
    };
    let mut out = String::new();
    let handler =
        miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor()).with_width(90);
    handler.render_report(&mut out, &error).unwrap();
    out
}

#[test]
fn mistakes_are_shown_at_their_place() {
    let head = "system \"s\"\nstate omega0, r1\nparam g = 9.81\nangle\n";
    let head = head.replace("angle\n", "");
    for (name, rest) in [
        ("misspelt", "let v = omga0*r1\n"),
        ("missing_bracket", "let v = (omega0 + r1\nlet w = 2\n"),
        ("missing_operand", "let v = omega0 +\nlet w = 2\n"),
        ("two_exponents", "let v = r1^0.5^2\n"),
        ("unknown_function", "let v = sine(r1)\n"),
        ("implied_product", "let v = 2 r1\n"),
        ("field_lacks_a_state", "field f\n  r1' = 1\n"),
        ("field_of_no_state", "field f\n  r1' = 1\n  g' = 2\n"),
        ("declared_twice", "let r1 = 2\n"),
        ("matrix_with_ragged_rows", "let M = [1, 2; 3]\n"),
        ("determinant_of_a_row", "let v = det([1, 2])\n"),
        ("sum_of_number_and_matrix", "let v = 1 + [1, 2]\n"),
        ("claim_without_equation", "claim 1: r1 + 2\n"),
        ("claim_of_unknown_name", "claim 1: r1 = r2\n"),
        ("claim_of_unlike_sides", "claim 1: [r1, r1] = r1\n"),
        ("claim_twice", "claim 1: r1 = r1\nclaim 1: r1 = r1\n"),
        ("erratum_without_correction", "erratum 1: printed r1 = 2\n"),
        ("erratum_that_states_nothing", "erratum 1: printed \"r1 = two\" corrected r1 = r1\n"),
        ("loose_wording_without_words", "loose 1: printed r1 = 2 meant r1 = r1\n"),
        ("damaged_without_repair", "damaged 1: reads \"r1 =\" as r1 = 2 corrected r1 = r1\n"),
        ("restates_what_is_not_there", "claim 1: r1 = r1\nclaim 2 restates rl: r1 = r1\n"),
        ("restates_of_another_file", "claim 2 restates 4.1 in \"nowhere.proof\": r1 = r1\n"),
        ("restates_and_is_refuted", "claim 1 consequence expect refuted: r1 = 2\n"),
        ("follows_what_holds", "claim 1: r1 = r1\nerratum 2 follows 1: printed r1 = 2 corrected r1 = r1\n"),
        ("follows_nothing", "erratum 2 follows 3: printed r1 = 2 corrected r1 = r1\n"),
        (
            "follows_in_a_circle",
            "erratum 1 follows 2: printed r1 = 2 corrected r1 = r1\nerratum 2 follows 1: printed r1 = 3 corrected r1 = r1\n",
        ),
        ("expected_nonsense", "claim 1 expect true: r1 = r1\n"),
        ("empty_range", "sample r1 in [3, 1]\n"),
        ("range_of_no_number", "sample r1 in [0, g*r1]\n"),
        ("unknown_import", "use other = \"nowhere.proof\"\n"),
        ("nothing_that_begins_an_entry", "claims 1: r1 = r1\n"),
        ("a_map_without_a_title", "map f\n  r1+ = 2*r1\n"),
        ("state_after_a_field", "field f\n  r1' = 1\n  omega0' = 2\nstate late\n"),
        ("rank_at_a_point", "claim 1: rank at {r1 = 2} = 2\n"),
        ("rank_with_a_name", "let r = rank\n"),
        ("lie_derivative_of_nothing", "let v = L(r1)\n"),
        ("lie_derivative_along_no_field", "let v = L(f, r1)\n"),
    ] {
        insta::assert_snapshot!(name, shown(&format!("{head}{rest}")));
    }
}

#[test]
fn files_that_are_none_are_refused_in_words() {
    let folder = folder();
    for (name, bytes, words) in [
        ("empty.proof", b"".as_slice(), "does not name a system"),
        ("binary.proof", b"system \"a\"\n\xff\xfe\x00\x01", "not a text in UTF-8: byte 11 is 0xff"),
        ("zeros.proof", &[0; 64], "expected one of: system"),
        ("comment.proof", b"# nothing\n", "does not name a system"),
    ] {
        let file = write(&folder, name, bytes);
        let output = palmistry(&["prove", file.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let message = json(&output)["error"]["message"].as_str().unwrap().to_owned();
        assert!(message.contains(words), "{name}: {message}");
    }
    let output = palmistry(&["prove", folder.path().join("none").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let output =
        palmistry(&["verify", "--proofs", "no/such/folder", "--out", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
}

/// A file that imports itself.
#[test]
fn an_import_without_end_is_ended() {
    let folder = folder();
    let file = write(&folder, "loop.proof", "system \"loop\" use again = \"loop.proof\"");
    let output = palmistry(&["prove", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
}

/// Where an error stands is given by line and column, for editors.
#[test]
fn an_error_in_json_has_its_line_and_column() {
    let folder = folder();
    let file = write(&folder, "a.proof", "system \"a\"\nparam x\nclaim 1: x =\n  y + 1\n");
    let output = palmistry(&["prove", file.to_str().unwrap(), "--json"]);
    let error = &json(&output)["error"];
    assert_eq!((error["line"].as_u64(), error["column"].as_u64()), (Some(4), Some(3)));
}

/// Deep nesting, long sums, towers of powers: an error or an answer, never a crash and never a wait without end.
#[test]
fn depth_and_length_are_survived() {
    // frames that are not optimised are larger
    let stack = if cfg!(debug_assertions) { 64 << 20 } else { 2 << 20 };
    let thread = std::thread::Builder::new().stack_size(stack).spawn(deep_and_long).unwrap();
    thread.join().unwrap();
}

fn deep_and_long() {
    let try_it = |expression: &str| {
        let text = format!("system \"s\" state x drift f x' = x^2 output x claim 1: {expression} = 0");
        if let Ok(system) = System::parse("deep.proof", &text, Path::new("")) {
            decide_all(&system, 1, &false.into(), &|_| ());
        }
    };
    for n in [10, 100, 1000, 100_000] {
        try_it(&format!("{}x{}", "(".repeat(n), ")".repeat(n)));
        try_it(&format!("{}x{}", "[".repeat(n), "]".repeat(n)));
        try_it(&format!("{}x{}", "sin(".repeat(n), ")".repeat(n)));
        try_it(&format!("{}x", "-".repeat(n)));
        try_it(&vec!["x"; n].join(" + 1/"));
        try_it(&vec!["x"; n].join("*"));
        try_it(&format!("x{}", " at {x = x}".repeat(n)));
        try_it(&format!("x{}", "^2".repeat(n)));
        try_it(&"(".repeat(n));
    }
    // every line squares the one before: the degree is 2^60, the value at x = 3 has 10^18 digits
    let lets: String = (1..=60).map(|i| format!("let a{i} = a{}^2 + 1 ", i - 1)).collect();
    let text =
        format!("system \"tower\" state x let a0 = x {lets} claim 1: a60 = a59 claim 2: a60 = a60*x/x");
    let system = System::parse("tower.proof", &text, Path::new("")).unwrap();
    let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
    assert!(outcomes.iter().all(|outcome| outcome.word() != "refuted" || outcome.id == "1"));
}

/// Pieces of the language, in any order.
fn scraps() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "system",
        "\"t\"",
        "state",
        "x",
        "y",
        "param",
        "k",
        "= 2",
        "angle",
        "a",
        "let",
        "v",
        "=",
        "field",
        "f",
        "x' =",
        "others' = 0",
        "output",
        "sample",
        "in [0, 1]",
        "avoid",
        "claim 1:",
        "claim",
        "erratum",
        "printed",
        "corrected",
        "damaged",
        "reads \"t\" as",
        "repaired",
        "convention",
        "loose",
        "meant",
        "restates",
        "follows",
        "consequence",
        "where",
        "at {",
        "}",
        "within",
        "expect",
        "refuted",
        "+",
        "-",
        "*",
        "/",
        "^",
        "^2",
        "(",
        ")",
        "[",
        "]",
        ",",
        ";",
        "L(f, x)",
        "d(x)",
        "det(",
        "rank",
        "rank(",
        "pole(",
        "sin(",
        "sqrt(",
        "log(",
        "exp(",
        "pi",
        "0",
        "1",
        ".5",
        "1e400",
        "1e99999",
        "\n",
        "#",
        "'",
        "\"",
        "é",
        "\u{0}",
        "use",
        "general",
        "rank = 1",
    ]);
    prop::collection::vec(piece, 0..40).prop_map(|pieces| pieces.join(" "))
}

/// A shipped file with some bytes changed, taken out or put in twice.
fn damaged(text: &str, cuts: &[(prop::sample::Index, u8, u8)]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for (place, kind, byte) in cuts {
        if bytes.is_empty() {
            break;
        }
        let at = place.index(bytes.len());
        match kind % 4 {
            0 => bytes[at] = *byte,
            1 => drop(bytes.drain(at..(at + usize::from(*byte)).min(bytes.len()))),
            2 => {
                let piece = bytes[at..(at + usize::from(*byte)).min(bytes.len())].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_makes_it_panic(text in any::<String>()) {
        let _ = System::parse("any.proof", &text, Path::new(""));
    }

    #[test]
    fn no_pile_of_scraps_makes_it_panic(text in scraps()) {
        let text = format!("system \"s\" state x, y param k = 2, a angle a drift f x' = y y' = -k*x + sin(a) output x {text}");
        if let Ok(system) = System::parse("scraps.proof", &text, Path::new("")) {
            decide_all(&system, 1, &false.into(), &|_| ());
        }
    }

    #[test]
    fn no_damage_to_a_file_makes_it_panic(
        cuts in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), any::<u8>()), 1..6)
    ) {
        let text = include_str!("../../proofs/moll2002/general.proof");
        if let Ok(text) = String::from_utf8(damaged(text, &cuts)) {
            let _ = System::parse("damaged.proof", &text, Path::new("proofs/moll2002"));
        }
    }

    /// Whatever stands between '--at' and its end.
    #[test]
    fn no_expression_makes_it_panic(text in scraps()) {
        let mut system = System::parse("e.proof", "system \"s\" state x, y drift f x' = y y' = x", Path::new("")).unwrap();
        let _ = system.evaluate_text(&text);
        let _ = palmistry::number::parse_decimal(&text);
        let _ = palmistry::observability::parse_condition(&text);
    }
}
