//! Story 1: is my system observable?

mod common;

use common::{folder, json, palmistry, with_threads, without_times, write};
use serde_json::{Value, json};

const SAME_RATE: &str = "proofs/moll2002/same_rate.proof";
const GENERAL: &str = "proofs/moll2002/general.proof";

fn rank(arguments: &[&str]) -> Value {
    let output = palmistry(&[&["rank"], arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&output)
}

/// Every regime is observable at every sampled state of its box, and each rank is certified.
#[test]
fn every_regime_is_observable_on_its_box() {
    for (file, dimension) in [
        (GENERAL, 10),
        (SAME_RATE, 6),
        ("proofs/moll2002/one_palm_fixed.proof", 6),
        ("proofs/moll2002/fixed_palms.proof", 5),
    ] {
        let found = rank(&[file, "--samples", "500"]);
        assert_eq!(found["dimension"], dimension, "{file}");
        assert_eq!(found["samples"], 500, "{file}");
        assert_eq!(found["certified"], 500, "{file}");
        assert_eq!(found["rank_histogram"], json!({ dimension.to_string(): 500 }), "{file}");
    }
}

/// Where the object does not turn, both radii are unseen: the first two columns of every row vanish with omega0
/// (thesis 4.49, 4.51 and 4.53), and nothing else does.
#[test]
fn the_radii_are_unseen_where_the_object_does_not_turn() {
    let found = rank(&[SAME_RATE, "--samples", "100", "--at", "omega0=0"]);
    assert_eq!(found["rank_histogram"], json!({ "4": 100 }));
    assert_eq!(found["certified"], 100);
    let unseen: Vec<&Value> = found["unseen"].as_array().unwrap().iter().map(|u| &u["example"]).collect();
    assert_eq!(unseen, ["r1", "r2"]);
}

/// Palm 1 level: the thesis's own six rows lose one, the full codistribution does not (it has L_f L_f s2).
#[test]
fn two_questions_have_two_answers() {
    let found = rank(&[SAME_RATE, "--samples", "50", "--where", "sin(phi1) = 0"]);
    assert_eq!(
        found["rank_histogram"],
        json!({ "6": 100 }),
        "two branches, palm 1 to the right and to the left"
    );
    for branch in found["branches"].as_array().unwrap() {
        assert_eq!(branch["own_rows"]["rank_histogram"], json!({ "5": 50 }));
    }
}

/// A system that is known to be unobservable: in polar coordinates seen by their radius only, the angle is free.
#[test]
fn an_unobservable_system_is_said_to_be_one() {
    let folder = folder();
    let text = r#"
        system "A point on a circle, seen by its distance"
        state x, y
        param k = 3
        field f
          x' = -k*y
          y' = k*x
        output x^2 + y^2
        sample x in [1, 2]  y in [1, 2]
        claim 1: rank = 1
        claim 2 expect refuted: rank = 2
    "#;
    let file = write(&folder, "circle.proof", text);
    let file = file.to_str().unwrap();
    let found = rank(&[file, "--samples", "40"]);
    assert_eq!(found["rank_histogram"], json!({ "1": 40 }));
    assert_eq!(found["certified"], 40);
    assert_eq!(found["longer_words_cannot_raise_it"], true);
    assert_eq!(found["unseen"][0]["states"], json!(["x", "y"]));
    assert!(palmistry(&["prove", file]).status.success());
}

/// On a set that the flow leaves, words of some length may pause and longer ones go on: no verdict may claim the rank
/// of the pause. L_f^5 of x^5 z is 120 z at x = 0, and nothing shorter sees z there.
#[test]
fn a_pause_of_the_rank_is_not_taken_for_its_end() {
    let folder = folder();
    let text = r#"
        system "A pause"
        state x, z
        field f  x' = 1  z' = 0
        output x, x^5*z
        claim at_large: rank = 2
        claim paused expect undecided: rank = 1 where x = 0
        claim not_known expect undecided: rank = 2 where x = 0
        claim by_words: rank([d(x); d(L(f, f, f, f, f, x^5*z))]) = 2 where x = 0
    "#;
    let file = write(&folder, "pause.proof", text);
    let output = palmistry(&["prove", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

/// A parameter that the file holds at zero is zero for the choice of words too: `k z` says nothing, L_f L_f x does.
#[test]
fn parameters_that_are_held_are_held_everywhere() {
    let folder = folder();
    for param in ["param k = 0", "param k sample k in [0, 0]"] {
        let text = format!(
            "system \"held\" state x, y, z {param} field f x' = y y' = z z' = 0 output x, k*z
             sample x in [1, 2] y in [1, 2] z in [1, 2]"
        );
        let file = write(&folder, "held.proof", text);
        let found = rank(&[file.to_str().unwrap(), "--samples", "20"]);
        assert_eq!(found["rank_histogram"], json!({ "3": 20 }), "{param}");
        assert_eq!(found["words"], json!(["x", "Lf x", "Lf Lf x"]), "{param}");
    }
}

/// Where an output does not exist its derivative may; such states are left out and named.
#[test]
fn a_state_without_output_is_left_out() {
    let folder = folder();
    let text = "system \"log\" state x field f x' = 0 output log(x - 5) sample x in [1, 2]";
    let file = write(&folder, "log.proof", text);
    let found = rank(&[file.to_str().unwrap(), "--samples", "10"]);
    assert_eq!(found["samples"], 0);
    let poles = found["poles"].as_object().unwrap();
    assert!(poles.keys().all(|why| why.contains("not defined")) && poles.values().all(|count| count == 10));
}

/// Unknown functions may conspire: exp(x) exp(-x) - 1 is zero, and nothing here knows it. Then the choice of words is a
/// guess, and said to be one.
#[test]
fn a_guess_is_not_called_final() {
    let folder = folder();
    let text = "system \"exp\" state x, y field f x' = 0 y' = 0 output x, (exp(x)*exp(-x) - 1)*y
                sample x in [1, 2] y in [1, 2]";
    let file = write(&folder, "exp.proof", text);
    assert_eq!(rank(&[file.to_str().unwrap(), "--samples", "10"])["longer_words_cannot_raise_it"], false);
}

/// `sin(phi) = 0` leaves whole turns open; rows with phi/2 in them tell these apart, and no rank is claimed for all.
#[test]
fn a_rank_that_whole_turns_change_is_not_decided() {
    let folder = folder();
    let text = "system \"half turns\" state x, y, phi angle phi field f x' = 0 y' = 0 phi' = 0
                output x, phi, y*(cos(phi/2) - 1) sample x in [1, 2] y in [1, 2] phi in [-1, 1]
                claim 1 expect undecided: rank = 2 where sin(phi) = 0
                claim 2 expect undecided: rank = 3 where sin(phi) = 0";
    let file = write(&folder, "turns.proof", text);
    let file = file.to_str().unwrap();
    assert!(palmistry(&["prove", file]).status.success());
    let output = palmistry(&["rank", file, "--where", "sin(phi) = 0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("whole turns"));
}

/// The same bits for one seed, whatever the number of threads; others for another seed.
#[test]
fn one_seed_gives_one_result_on_any_number_of_threads() {
    let run = |threads: &str, seed: &str| {
        let arguments = ["rank", GENERAL, "--samples", "5000", "--seed", seed, "--json"];
        let mut found = json(&with_threads(&arguments, Some(threads)));
        without_times(&mut found);
        found
    };
    assert_eq!(run("1", "7"), run("2", "7"));
    assert_eq!(run("2", "7"), run("5", "7"));
    assert_ne!(run("2", "7")["worst_conditioned"], run("2", "8")["worst_conditioned"]);
}

/// A pole everywhere is an answer in words and exit status 2, not a rank.
#[test]
fn a_pole_everywhere_is_named() {
    let output = palmistry(&["rank", SAME_RATE, "--at", "omega0=2,omega1=2", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(json(&output)["error"]["message"].as_str().unwrap().contains("pole"));
}

#[test]
fn what_cannot_be_asked_is_refused_with_advice() {
    for (arguments, advice) in [
        (vec!["rank", SAME_RATE, "--at", "omga0=0"], "omega0"),
        (vec!["rank", SAME_RATE, "--at", "omega0"], "name=value"),
        (vec!["rank", SAME_RATE, "--at", "omega0=x"], "not a number"),
        (vec!["rank", SAME_RATE, "--at", "omega0=1,omega0=2"], "twice"),
        (vec!["rank", SAME_RATE, "--where", "r1^2 = 2"], "not linear"),
        (vec!["rank", SAME_RATE, "--where", "r1 ="], "expected"),
        (vec!["rank", "no/such.proof"], "cannot read"),
    ] {
        let output = palmistry(&arguments);
        let words = String::from_utf8_lossy(&output.stderr).replace("\n", " ").replace("│", " ");
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(words.contains(advice), "{arguments:?}: {words}");
    }
}

/// A long run that is interrupted says so and keeps what it had.
#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_what_it_had() {
    use std::process::{Command, Stdio};
    let child = Command::new(env!("CARGO_BIN_EXE_palmistry"))
        .args(["rank", SAME_RATE, "--samples", "1000000000", "--json"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let found = json(&output);
    assert_eq!(found["interrupted"], true);
    let samples = found["samples"].as_u64().unwrap();
    assert!(samples > 0 && found["certified"] == samples);
}
