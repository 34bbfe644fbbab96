//! Vectors in one line mean what the same file means with every component written out by hand.

use crate::common::{folder, json, palmistry, write};
use palmistry::{System, answer_rank, prove};
use proptest::prelude::*;
use std::path::Path;

fn system(text: &str) -> System {
    System::parse("v.proof", text, Path::new("")).unwrap_or_else(|why| panic!("{why:?}\n{text}"))
}

/// States, symbols with values and ranges, fields, outputs and what is avoided, in words.
fn all_of(text: &str) -> Vec<String> {
    let system = system(text);
    let mut found = Vec::new();
    for (symbol, info) in system.symbols() {
        let (kind, angle) = (info.kind, info.is_angle);
        found.push(format!(
            "{} {kind:?} {angle} {:?} {:?} {:?}",
            system.symbol_name(symbol),
            info.default,
            info.range,
            system.dimension_of(symbol)
        ));
    }
    for field in &system.fields {
        for (state, rate) in &field.components {
            let rate = system.graph.text(*rate);
            found.push(format!("{} {:?} {} {rate}", field.name, field.role, system.symbol_name(*state)));
        }
    }
    found.extend(
        system.outputs.iter().map(|(text, value)| format!("{text} is {}", system.graph.text(*value))),
    );
    found.extend(system.avoid.iter().map(|(_, value)| format!("not {}", system.graph.text(*value))));
    found
}

#[test]
fn a_line_for_all_components_is_as_many_lines() {
    let short = "system \"s\"\nstate x[0..3] : length, phi[1..2]\nparam a[i] = 1/i for i in 1..3, c[1..2] = 2, d\nangle phi[1..2]\n\
                 let flow[i] : length/time = a[i]*(x[i - 1] - x[i])/d for i in 1..3\n\
                 drift f\n  x[i]' = flow[i] for i in 1..3\n  x[0]' = -sum(i in 1..3, i*x[i])/d\n  phi[2*i - 1]' = cos(phi[3 - i])/d for i in 1..1\n\
                 phi[2]' = product(j in 1..2, c[j])/d\ninput g  x[2..3]' = d  others' = 0\n\
                 output x[1..2], x[i]*x[j] for i in 0..1 for j in i + 2..3\n\
                 sample\n  x[0..1] in [-1, 1]\n  x[i] in [-i, i] for i in 2..3, d in [1, 2]\n  avoid x[i] for i in 1..2, x[3]";
    let long = "system \"s\"\nstate x[0], x[1], x[2], x[3] : length, phi[1], phi[2]\nparam a[1] = 1, a[2] = 1/2, a[3] = 1/3, c[1] = 2, c[2] = 2, d\n\
                angle phi[1], phi[2]\n\
                let flow[1] : length/time = a[1]*(x[0] - x[1])/d let flow[2] : length/time = a[2]*(x[1] - x[2])/d let flow[3] : length/time = a[3]*(x[2] - x[3])/d\n\
                drift f\n  x[1]' = flow[1]  x[2]' = flow[2]  x[3]' = flow[3]\n  x[0]' = -(x[1] + 2*x[2] + 3*x[3])/d\n  phi[1]' = cos(phi[2])/d\n\
                phi[2]' = c[1]*c[2]/d\ninput g  x[2]' = d  x[3]' = d  others' = 0\n\
                output x[1], x[2], x[0]*x[2], x[0]*x[3], x[1]*x[3]\n\
                sample\n  x[0] in [-1, 1] x[1] in [-1, 1]\n  x[2] in [-2, 2] x[3] in [-3, 3] d in [1, 2]\n  avoid x[1], x[2], x[3]";
    assert_eq!(all_of(short), all_of(long));
}

/// A chain of compartments seen at its end has full rank; a ring of equal ones is not seen where all are alike.
#[test]
fn ranks_and_claims_of_vectors() {
    let mut chain = system(
        "system \"chain\"\nstate x[1..7]\nparam a[1..7] = 2\ndrift f\n  x[1]' = -a[1]*x[1]\n  x[i]' = a[i - 1]*x[i - 1] - a[i]*x[i] for i in 2..7\n\
         output x[7]\nsample x[1..7] in [0, 1]\nclaim 1: rank = 7\nclaim 2: L(f, sum(i in 1..7, x[i])) = -a[7]*x[7]\n\
         claim 3: x[1]*x[2] = x[2]^2 where x[i] = x[i + 1] for i in 1..2\nclaim 4 expect refuted: x[1]*x[2] = x[3]^2 where x[1..2] = 1\n\
         claim 5: d(x[1]*x[2], x[1..2]) = [x[2], x[1]]\nclaim 6: sum(i in 1..0, x[i]) + product(i in 1..0, x[i]) = 1\n",
    );
    for outcome in prove(&chain) {
        assert!(outcome.ok, "{}: {}", outcome.id, outcome.word());
    }
    let answer = answer_rank(&mut chain, &Default::default()).unwrap();
    assert_eq!(answer.branches[0].generic_rank, 7);
    assert_eq!(answer.branches[0].full.certified, 1000);
}

#[test]
fn what_is_wrong_is_said_at_its_place() {
    let head = "system \"s\"\nstate x[1..3], y, z[1]\nparam k, p[1..2]\n";
    for (text, message, marked) in [
        ("let v = x[4]", "'x' has no component 4: it has x[1..3]", "x[4]"),
        ("let v = sum(i in 1..3, x[i - 1])", "'x' has no component 0: it has x[1..3]", "x[i - 1]"),
        ("let v = x[i]", "unknown index 'i'", "x[i]"),
        ("let v = x[k]", "'k' is a state or parameter, and no index", "x[k]"),
        ("let v = x", "'x' is a vector, and one of its components is needed", "x"),
        ("let v = y[1]", "'y' has no components", "y[1]"),
        ("let v = q[1]", "unknown vector 'q'", "q[1]"),
        ("let v = 2*x[1..2]", "a range of components stands for several, and one is needed here", "x[1..2]"),
        ("let v = sum(k in 1..3, x[k])", "'k' has a meaning already, and would be an index here", "k"),
        ("let v = x[1, 2]", "expected ']': a vector has one index", ","),
        (
            "let v = sum(i in 3..1, x[i])",
            "expected a range that ends no lower than it begins; 3..1 is empty",
            "3",
        ),
        ("let v = sum(i in 1..5001, 2)", "expected a range of at most 5000 numbers; 1..5001 has more", "1"),
        ("let v = x[1.5]", "expected ']' or '..'", "."),
        ("let v = x[12345678901]", "expected an index made of numbers of at most 9 digits", "1"),
        ("state x[3..4]", "'x[3]' has a meaning already", "x[3..4]"),
        ("state x", "'x' would be a vector and something without components", "x"),
        ("state y[1]", "'y' would be a vector and something without components", "y[1]"),
        (
            "drift f  x[i]' = 1  others' = 0",
            "expected a number as index; nothing says what 'i' runs through",
            "x",
        ),
        (
            "drift f  x[i]' = 1 for i in 1..3 x[2]' = 0 others' = 0",
            "'x[2]' is given twice in the field 'f'",
            "x[2]",
        ),
        ("drift f  x[1..2]' = 1 y' = 0 z[1]' = 0", "the field 'f' does not say how 'x[3]' moves", "f"),
        ("drift f  p[1]' = 1 others' = 0", "'p[1]' is no state", "p[1]"),
        ("sample x[1..3] in [0, 1] x[2] in [0, 1]", "'x[2]' has a range already", "x[2]"),
        ("claim 1: y = 1 where x[1..4] = 0", "'x' has no component 4: it has x[1..3]", "x[1..4]"),
        ("claim 1: y at {x[1..2] = 0, x[2] = 1} = 1", "'x[2]' is given twice", "x[2]"),
        (
            "map \"m\": x[1..2] in [0, 1], y in [0, 1]",
            "expected a coordinate and its range, as in x in [0, 1]",
            "x",
        ),
    ] {
        let text = format!("{head}{text}\n");
        let error = System::parse("v.proof", &text, Path::new("")).expect_err(&text);
        assert_eq!(error.message, message, "{text}");
        let span = error.span.offset()..error.span.offset() + error.span.len();
        assert_eq!(&text[span.clone()], marked, "{text}");
        assert!(span.start >= head.len(), "{text}");
    }
}

/// The names stay the same through the program: values, conditions, JSON, a file of verdicts that is checked again, LaTeX.
#[test]
fn components_keep_their_names() {
    let folder = folder();
    let text = "system \"s\"\nstate x[1..3]\nparam a[1..3] = 1\ndrift f\n  x[i]' = a[i]*x[i + 1] for i in 1..2\n  x[3]' = -x[3]*x[1]\n\
                output x[1]\nsample x[1..3] in [1, 2]\n";
    let file = write(&folder, "v.proof", text);
    let (file, verdicts) = (file.to_str().unwrap(), folder.path().join("v.json"));
    let verdicts = verdicts.to_str().unwrap();
    let ranked = palmistry(&[
        "rank",
        file,
        "--samples",
        "5",
        "--at",
        "x[3]=2,a[1..2]=3",
        "--where",
        "x[i] = 1 for i in 1..2",
        "--verdicts",
        verdicts,
        "--json",
    ]);
    let answer = json(&ranked);
    assert_eq!(answer["rank_histogram"]["3"], 5, "{answer}");
    let conditions = answer["conditions"].to_string();
    assert!(conditions.contains("x[1] = 1") && conditions.contains("x[3] = 2"), "{conditions}");
    assert_eq!(palmistry(&["recheck", verdicts]).status.code(), Some(0));
    assert!(std::fs::read_to_string(verdicts).unwrap().contains("x[3]"));
    let value = palmistry(&["eval", file, "L(f, x[2])", "--at", "x[1..3]=2,a[2]=5", "--latex"]);
    let printed = String::from_utf8(value.stdout).unwrap();
    assert!(printed.contains("x_{2}") && printed.contains("10"), "{printed}");
    let twice = palmistry(&["eval", file, "x[1]", "--at", "x[1..3]=2,x[2]=5"]);
    assert!(String::from_utf8(twice.stderr).unwrap().contains("'x[2]' is given twice"));
}

fn a_part() -> impl Strategy<Value = String> {
    let number = prop_oneof!["[0-9]{1,2}", "[0-9]{8,12}", Just("-3".to_owned())];
    let whole = prop_oneof![
        number.clone(),
        Just("i".to_owned()),
        number.prop_map(|n| format!("{n}*i")),
        Just("i + j - 1".to_owned()),
        Just("".to_owned()),
    ];
    (whole.clone(), whole, 0..8).prop_map(|(a, b, kind)| match kind {
        0 => format!("x[{a}]"),
        1 => format!("x[{a}..{b}]"),
        2 => format!("sum(i in {a}..{b}, x[i])"),
        3 => format!("product(j in {a}..{b}, sum(i in 1..j, i*x[j]))"),
        4 => format!("x[1] for i in {a}..{b}"),
        5 => format!("[x[{a}..{b}]]"),
        6 => format!("x[1] at {{x[{a}..{b}] = i for i in {a}..3}}"),
        _ => format!("sum(i in {a}..{b}, sum(j in i..{b}, sum(k in j..{a}, x[k])))"),
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// Whatever stands in brackets, a file is read or refused, and what is refused is marked within the text.
    #[test]
    fn nothing_panics_on_any_range(parts in prop::collection::vec(a_part(), 1..4), entry in 0..5) {
        let list = parts.join(", ");
        let line = match entry {
            0 => format!("state {list}"),
            1 => format!("let v[i] = {list}"),
            2 => format!("output {list}"),
            3 => format!("drift f {}' = {} others' = 0", parts[0], parts[parts.len() - 1]),
            _ => format!("claim 1: {} = 1 where {list} = 2", parts[0]),
        };
        let text = format!("system \"s\"\nstate x[1..9]\n{line}\n");
        let found = System::examine_text("v.proof", &text, Path::new(""), 9);
        for problem in &found.problems {
            prop_assert!(problem.span.offset() + problem.span.len() <= text.len());
        }
    }
}
