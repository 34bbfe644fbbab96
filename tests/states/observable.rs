//! Story 1: is my system observable?

use crate::common::{folder, json, palmistry, with_threads, without_times, write};
use palmistry::System;
use palmistry::expression::{Program, expand_angles};
use palmistry::number::Floats;
use palmistry::observability::{Reduction, float_inputs};
use palmistry::report::rank_json;
use palmistry::system::Value::Matrix;
use palmistry::{RankQuestion, answer_rank};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

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
        ("proofs/moll2002/constraint/two_rates.proof", 7),
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

/// What is divided by has a value at a state also where no row of the codistribution mentions it: by hand, the rank is that of
/// the unit matrix wherever the field exists.
#[test]
fn what_only_guards_mention_is_drawn_too() {
    let folder = folder();
    let with = |param: &str, rate: &str, sample: &str| {
        let text = format!(
            "system \"s\" state x, v param {param} drift f x' = v v' = {rate} output x \
             sample x in [-1, 1] v in [-1, 1] {sample}"
        );
        write(&folder, "s.proof", text).display().to_string()
    };
    for (param, rate, sample, more) in [
        ("m = 2", "-x/m", "", &[][..]),
        ("m", "-x/m", "m in [1, 2]", &[]),
        ("m = 2, k = 3", "-x*sqrt(k)/log(m)", "", &[]),
        ("m", "-x/m", "", &["--at", "m=3"]),
        ("m, k", "-x/m", "k in [1, 2]", &["--where", "m = k"]),
    ] {
        let file = with(param, rate, sample);
        let found = rank(&[&[file.as_str(), "--samples", "40"], more].concat());
        assert_eq!(found["rank_histogram"], json!({ "2": 40 }), "{param} {rate} {sample}: {found}");
        assert_eq!(found["certified"], 40, "{param} {rate} {sample}");
    }
    // where the divisor is zero there is a pole, and no rank
    let found = rank(&[&with("m = 2", "-x/m", ""), "--samples", "10", "--at", "m=0"]);
    assert_eq!(found["certified"], 0, "{found}");
}

/// Where the object does not turn, both radii are unseen: the first two columns of every row vanish with omega0
/// (thesis 4.49, 4.51 and 4.53), and nothing else does.
#[test]
fn the_radii_are_unseen_where_the_object_does_not_turn() {
    let found = rank(&[SAME_RATE, "--samples", "100", "--at", "omega0=0"]);
    assert_eq!(found["rank_histogram"], json!({ "4": 100 }));
    assert_eq!(found["certified"], 100);
    let unobservable: Vec<&Value> =
        found["unobservable"].as_array().unwrap().iter().map(|u| &u["example"]).collect();
    assert_eq!(unobservable, ["r1", "r2"]);
}

/// Several conditions in one `--where` are what several of one condition are.
#[test]
fn several_conditions_stand_in_one_where() {
    let ask = |conditions: &[&str]| {
        let mut found = rank(&[&[SAME_RATE, "--samples", "40"], conditions].concat());
        crate::common::without_times(&mut found);
        found
    };
    let apart = ask(&["--where", "g = 0", "--where", "r1 > 1", "--where", "r1 < r2"]);
    assert_eq!(ask(&["--where", "g = 0, 1 < r1 < r2"]), apart);
    assert_eq!(ask(&["--where", "g = 0,r1 > 1", "--where", "r1 < r2"]), apart);
    assert_eq!(apart["rank_histogram"], json!({ "5": 40 }));
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

/// Outputs 4x + y and x + y: the squares of [4 1; 1 1], scaled, are [4/5 1/5; 1/5 4/5], as x/(1 - x) = |a d|/|b c|, so that
/// the singular values are 3/sqrt(5) and 1/sqrt(5) and the condition is 3 (digits of the root: mpmath 1.3).
#[test]
fn digits_of_the_worst_state_in_closed_form() {
    let text = "system \"linear\" state x, y drift f x' = y y' = 0 output 4*x + y, x + y \
                sample x in [0, 1] y in [0, 1]";
    let folder = folder();
    let file = write(&folder, "linear.proof", text);
    let arguments = [file.to_str().unwrap(), "--samples", "10", "--digits"];
    for (digits, first, second, numbers) in [
        ("9", "1.34164079", "0.447213595", "intervals"),
        (
            "33",
            "1.34164078649987381784550420123877",
            "0.447213595499957939281834733746255",
            "enclosures of 179 bits",
        ),
    ] {
        let found = rank(&[&arguments[..], &[digits]].concat());
        let exact = &found["worst_to_digits"];
        assert_eq!(exact["singular_values"], json!([first, second]));
        assert_eq!(exact["digits"].to_string(), digits);
        assert_eq!((exact["verdict"].as_str(), exact["escalated"].as_u64()), (Some("certified"), Some(0)));
        assert_eq!(exact["numbers"], numbers);
        let worst = &found["worst_conditioned"];
        assert_eq!(
            (&worst["condition"], worst["singular_values"][0].as_f64()),
            (&json!(3.0), first.parse().ok())
        );
    }
    let words = palmistry(&[&["rank"], &arguments[..], &["20", "--verdict", "computed"]].concat());
    let words = String::from_utf8(words.stdout).unwrap();
    assert!(words.contains("worst conditioned: 3.0000000000000000000 at"), "{words}");
    assert!(words.contains("20 digits, certified by enclosures of 134 bits"), "{words}");
    // without the option nothing is said of digits
    assert_eq!(rank(&arguments[..3]).get("worst_to_digits"), None);
}

/// The second witness: the rows at the reported state in doubles, unit rows left out, rows and columns scaled to length
/// one in turn ten thousand times, singular values by faer.
#[test]
fn digits_of_a_regime_are_those_of_scaling_without_end() {
    let found = rank(&[SAME_RATE, "--samples", "300", "--digits", "20"]);
    let (found, digits) = (&found["own_rows"], &found["own_rows"]["worst_to_digits"]);
    let mut system = System::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(SAME_RATE)).unwrap();
    let Some(Matrix(rows)) = system.definition("rows").cloned() else { panic!("no rows") };
    let kept = Reduction::new(&system.graph, &rows.entries, rows.columns);
    let is_angle = &system.angle_test();
    let entries = expand_angles(&mut system.graph, &kept.entries, is_angle);
    let program = Program::plain(&system.graph, &entries);
    let value =
        |symbol| found["worst_conditioned"]["state"][system.symbol_name(symbol)]["value"].as_f64().unwrap();
    let inputs = float_inputs(&program, value);
    let entries = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
    let size = kept.columns.len();
    let mut matrix = faer::Mat::from_fn(size, size, |i, j| entries[i * size + j]);
    for _ in 0..10_000 {
        for i in 0..size {
            let length = matrix.row(i).norm_l2();
            (0..size).for_each(|j| matrix[(i, j)] /= length);
        }
        for j in 0..size {
            let length = matrix.col(j).norm_l2();
            (0..size).for_each(|i| matrix[(i, j)] /= length);
        }
    }
    let values = matrix.singular_values().unwrap();
    assert_eq!(digits["singular_values"].as_array().unwrap().len(), size);
    for (value, digits) in values.iter().zip(digits["singular_values"].as_array().unwrap()) {
        let exact: f64 = digits.as_str().unwrap().parse().unwrap();
        assert!((value - exact).abs() < 1e-13, "{value}, {exact}");
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
        drift f
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
    assert_eq!(found["higher_derivatives_cannot_raise_it"], true);
    assert_eq!(found["unobservable"][0]["states"], json!(["x", "y"]));
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
        drift f  x' = 1  z' = 0
        output x, x^5*z
        claim at_large: rank = 2
        claim paused expect refuted: rank = 1 where x = 0
        claim in_the_end: rank = 2 where x = 0
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
            "system \"held\" state x, y, z {param} drift f x' = y y' = z z' = 0 output x, k*z
             sample x in [1, 2] y in [1, 2] z in [1, 2]"
        );
        let file = write(&folder, "held.proof", text);
        let found = rank(&[file.to_str().unwrap(), "--samples", "20"]);
        assert_eq!(found["rank_histogram"], json!({ "3": 20 }), "{param}");
        assert_eq!(found["lie_derivatives"], json!(["x", "Lf x", "Lf Lf x"]), "{param}");
    }
}

/// Where an output does not exist its derivative may; such states are left out and named.
#[test]
fn a_state_without_output_is_left_out() {
    let folder = folder();
    let text = "system \"log\" state x drift f x' = 0 output log(x - 5) sample x in [1, 2]";
    let file = write(&folder, "log.proof", text);
    let found = rank(&[file.to_str().unwrap(), "--samples", "10"]);
    assert_eq!(found["samples"], 0);
    let poles = found["singularities"].as_object().unwrap();
    assert!(poles.keys().all(|why| why.contains("outside of")) && poles.values().all(|count| count == 10));
}

/// Unknown functions may conspire: asin(sin(x)) - x is zero for these x and not for all, and nothing here knows it. Then the
/// choice of words is a guess, and said to be one.
#[test]
fn a_guess_is_not_called_final() {
    let folder = folder();
    let text = "system \"exp\" state x, y drift f x' = 0 y' = 0 output x, (asin(sin(x)) - x)*y
                sample x in [1/10, 1] y in [1, 2]";
    let file = write(&folder, "exp.proof", text);
    assert_eq!(
        rank(&[file.to_str().unwrap(), "--samples", "10"])["higher_derivatives_cannot_raise_it"],
        false
    );
}

/// `sin(phi) = 0` leaves whole turns open; rows with phi/2 in them tell these apart, and no rank is claimed for all.
#[test]
fn a_rank_that_whole_turns_change_is_not_decided() {
    let folder = folder();
    let text = "system \"half turns\" state x, y, phi angle phi drift f x' = 0 y' = 0 phi' = 0
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
    assert!(json(&output)["error"]["message"].as_str().unwrap().contains("undefined at every state"));
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
        (vec!["rank", "no/such.proof"], "there is no file no/such.proof"),
        (vec!["rank", SAME_RATE, "--where", "r1 == 0"], "one '='"),
    ] {
        let output = palmistry(&arguments);
        let words = String::from_utf8_lossy(&output.stderr).replace("\n", " ").replace("│", " ");
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(words.contains(advice), "{arguments:?}: {words}");
    }
}

/// A long run that is interrupted, here when it first says how far it is, says so and keeps what it had.
#[test]
fn an_interrupted_run_keeps_what_it_had() {
    let mut system = System::read(Path::new(SAME_RATE)).unwrap();
    let interrupt = AtomicBool::new(false);
    let stop = |done: u64| {
        interrupt.fetch_or(done > 0, Ordering::Relaxed);
    };
    let question = RankQuestion {
        samples: 1_000_000_000,
        interrupt: &interrupt,
        progress: &stop,
        ..RankQuestion::default()
    };
    // what is compiled for vectors needs much of the stack where nothing is optimised
    let threads = rayon::ThreadPoolBuilder::new().stack_size(64 << 20).build().unwrap();
    let answer = threads.install(|| answer_rank(&mut system, &question));
    let found = rank_json(&answer.unwrap());
    assert_eq!(found["interrupted"], true);
    let samples = found["samples"].as_u64().unwrap();
    assert!((1..1_000_000_000).contains(&samples) && found["certified"] == samples, "{samples}");
    // the whole sample box of the thesis's section on palms at one rate: full rank at each of them
    assert_eq!(found["rank_histogram"], json!({ "6": samples }));
}
