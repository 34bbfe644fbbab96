//! Long files: what is read and decided grows with their length and not with its square. A run is ended after minutes
//! (see [`crate::process::finish`]); with a cost that grows as the square each of these takes an hour, and without a second or so.

use crate::common::{folder, json, write};
use crate::process::{finish, program, words};
use palmistry::report::claim_json;
use palmistry::{System, decide, decide_all};
use std::path::Path;

fn many(count: usize, line: impl Fn(usize) -> String) -> String {
    (1..=count).map(line).collect()
}

/// Forty thousand entries of each kind.
#[test]
fn long_files_are_read_and_decided() {
    const COUNT: usize = 40_000;
    let states = format!("state x0{}\n", many(COUNT, |i| format!(", x{i}")));
    let all = [
        (
            "claims",
            format!(
                "state x\n{}",
                many(COUNT, |i| format!("claim {i}: (x + {i})^2 - x^2 = {}*x + {}\n", 2 * i, i * i))
            ),
        ),
        (
            "definitions",
            format!(
                "state x\nlet a0 = x\n{}claim 1: 1 = 1\n",
                many(COUNT, |i| format!("let a{i} = a{} + x\n", i - 1))
            ),
        ),
        ("states", format!("{states}claim 1: x0 = x0\n")),
        (
            "a field",
            format!(
                "{states}field f\n x0' = 1\n{}claim 1: L(f, x2) = x1\n",
                many(COUNT, |i| format!(" x{i}' = x{}\n", i - 1))
            ),
        ),
        ("parameters", format!("{}claim 1: 1 = 1\n", many(COUNT, |i| format!("param k{i} = {i}\n")))),
        ("outputs", format!("state x\n{}claim 1: 1 = 1\n", many(COUNT, |i| format!("output x + {i}\n")))),
        (
            "ranges",
            format!("{states}sample\n{}claim 1: 1 = 1\n", many(COUNT, |i| format!(" x{i} in [0, {i}]\n"))),
        ),
        (
            "terms",
            format!(
                "state x\nclaim 1: {}x - x = 0\n",
                many(COUNT, |i| format!("sin({i}*x) - sin({i}*x) + "))
            ),
        ),
        (
            "fields",
            format!(
                "state x\n{}claim 1: L(f1, x) = 1\n",
                many(COUNT, |i| format!("field f{i}\n x' = {i}\n"))
            ),
        ),
    ];
    let folder = folder();
    for (name, text) in all {
        let file = write(&folder, "long.proof", format!("system \"long\"\n{text}"));
        let output = finish(&mut program(&["prove", file.to_str().unwrap(), "--json"]));
        assert_eq!(
            output.status.code(),
            Some(0),
            "{name}: {}",
            &words(&output)[..1000.min(words(&output).len())]
        );
        let found = json(&output);
        let claims = found["claims"].as_array().unwrap();
        assert_eq!(claims.len(), if name == "claims" { COUNT } else { 1 }, "{name}");
        let holds = |claim: &serde_json::Value| claim["ok"] == true && claim["verdict"] != "undecided";
        assert!(claims.iter().all(holds), "{name}");
    }
}

/// Claims share a copy of their system, one after the other. The oracle is a copy for each, in two orders.
#[test]
fn a_verdict_does_not_depend_on_its_neighbours() {
    let without_times = |outcome: &palmistry::Outcome| {
        let mut object = claim_json(outcome);
        crate::common::without_times(&mut object);
        object
    };
    let mut compared = 0;
    for file in ["fixed_palms", "chapter3_contact", "appendix_a3"] {
        let path = format!("proofs/moll2002/{file}.proof");
        let mut system = System::read(Path::new(&path)).unwrap();
        for _ in 0..2 {
            let together = decide_all(&system, 7, &false.into(), &|_| ());
            assert_eq!(together.len(), system.claims.len());
            for (claim, outcome) in system.claims.iter().zip(&together) {
                assert_eq!(
                    without_times(&decide(&system, claim, 7)),
                    without_times(outcome),
                    "{file} {}",
                    claim.id
                );
                compared += 1;
            }
            system.claims.reverse();
        }
    }
    assert!(compared > 20, "{compared}");
}

/// What is named once may be met many times: sixty names, each the double of the one before, are sixty steps and not 2^60.
#[test]
fn shared_parts_are_walked_once() {
    let names = many(59, |i| format!("let a{i} = a{} + a{}\n", i - 1, i - 1));
    let claims = "claim turns: cos(phi + a45)^2 = 1 where sin(phi + a45) = 0\n\
                  claim sign: x + a59 > 0 where x > 0\n\
                  claim value: sin(a45)^2 = 3/4\n";
    let text = format!(
        "system \"shared\"\nstate x, phi\nangle phi\nlet a0 = pi + pi/3\n{names}drift f\n x' = 1\n phi' = 1\noutput x\n{claims}"
    );
    let folder = folder();
    let file = write(&folder, "shared.proof", text);
    let output = finish(&mut program(&["prove", file.to_str().unwrap(), "--json"]));
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert_eq!(json(&output)["claims"].as_array().unwrap().len(), 3);
}
