//! What to measure or to know besides: by hand, by the ranks of all sets of additions that are written as files, and as the program is asked.

use crate::common::{folder, json, palmistry, write};
use palmistry::design::{Addition, AdditionKind, Design, DesignQuestion, design};
use palmistry::{RankQuestion, System, answer_rank};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn read(text: &str) -> System {
    format!("system \"s\" {text}").parse().unwrap()
}

/// The sets that are found, each in words, all of them proved.
fn sets(text: &str, targets: &[&str], change: impl Fn(&mut DesignQuestion<'_>)) -> Vec<String> {
    let (sets, are_proved) = sets_and_proofs(text, targets, change);
    assert!(are_proved, "{sets:?}");
    sets
}

/// The sets, and whether all of them are proved.
fn sets_and_proofs(
    text: &str,
    targets: &[&str],
    change: impl Fn(&mut DesignQuestion<'_>),
) -> (Vec<String>, bool) {
    let never = AtomicBool::new(false);
    let mut question = DesignQuestion {
        targets: targets.iter().map(|name| (*name).to_owned()).collect(),
        ..DesignQuestion::of(Path::new(""), &never)
    };
    change(&mut question);
    let answer = design(&read(text), &question).unwrap();
    assert!(answer.open.is_none() && answer.contradicted == 0, "{answer:?}");
    let word = |addition: &Addition| match addition {
        Addition::Output(text) => format!("output {text}"),
        Addition::Known(name) => format!("known {name}"),
        Addition::Initial(name) => format!("initial {name}"),
        Addition::Input(name) => format!("input {name}"),
        Addition::Experiment => "experiment".to_owned(),
    };
    let proved = answer.designs.iter().all(|design| design.log2_error.is_some_and(|error| error < -90.0));
    let in_words = |one: &Design| one.additions.iter().map(word).collect::<Vec<_>>().join(", ");
    (answer.designs.iter().map(in_words).collect(), proved)
}

/// What can be added under two names is added once, and takes no rows of others: by hand.
#[test]
fn the_same_addition_twice() {
    let product = "state x param a, b, c unknown drift f x' = -a*x output b*c*x";
    let measure = |expressions: &[&str], question: &mut DesignQuestion<'_>| {
        question.measurable = Some(expressions.iter().map(|one| (*one).to_owned()).collect());
        question.kinds = vec![AdditionKind::Outputs, AdditionKind::Known];
        question.at_most = 2;
    };
    let found = sets(product, &["x"], |question| measure(&["a"], question));
    assert_eq!(found, ["known b, known c"]);
    let apart = "state x, y param c unknown drift f x' = -x y' = 0*x + 1 output x";
    let found = sets(apart, &["y"], |question| measure(&["c*x", "x*c", "y"], question));
    assert_eq!(found, ["output y"]);
    // measured already
    let found = sets(apart, &["y"], |question| measure(&["2*x - x", "c*x", "y"], question));
    assert_eq!(found, ["output y"]);
}

const TWO: &str = "state x, y param a, b, c unknown drift f x' = -(a + b)*x + c*y y' = a*x - c*y output x";

/// By hand.
#[test]
fn designs_by_hand() {
    let any = |_: &mut DesignQuestion<'_>| ();
    // a scale: the amount, the amount once, or something of known size
    let scaled = "state x param k, s unknown drift f x' = -k*x output s*x";
    let with_initial = |question: &mut DesignQuestion<'_>| question.kinds.push(AdditionKind::Initial);
    assert_eq!(sets(scaled, &["s"], with_initial), ["output x", "initial x", "input x"]);
    // one experiment leaves a sum, a second one with another start does not help, knowing one of the two does
    let sum = "state x param a, b unknown drift f x' = -(a + b)*x output x";
    assert_eq!(sets(sum, &["a"], any), ["known b"]);
    let line = "state x, y param a unknown drift f x' = 0 y' = 0 output x + a*y";
    // what nothing moves is known or not: it is no output
    let known =
        |question: &mut DesignQuestion<'_>| question.kinds = vec![AdditionKind::Outputs, AdditionKind::Known];
    assert_eq!(sets(line, &["a"], known), ["known x, known y"]);
    // H. Hong et al. (2020), example 2.14: two values from one experiment, one from two
    let hong = "state x param a unknown drift f x' = 0 output x, a*x + a^2";
    let global = |question: &mut DesignQuestion<'_>| question.globally = true;
    // that one experiment leaves two is counted at random points, and no symmetry shows it
    assert_eq!(sets_and_proofs(hong, &["a"], global), (vec!["experiment".to_owned()], false));
    assert!(sets(hong, &["a"], any).is_empty());
    // either of two compartments that can be exchanged tells which is which
    let exchanged = "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z output x";
    let outputs = |question: &mut DesignQuestion<'_>| {
        question.globally = true;
        question.kinds = vec![AdditionKind::Outputs];
        question.measurable = Some(vec!["y + z".to_owned(), "y - z".to_owned(), "y".to_owned()]);
    };
    assert_eq!(sets(exchanged, &["c"], outputs), ["output y - z", "output y"]);
}

/// All sets of up to two outputs, known parameters, initial conditions and inputs as files of their own: those whose rank tells the targets are found, as far as they are
/// minimal, and no others.
#[test]
fn designs_are_those_of_the_ranks_of_all_files() {
    let additions: Vec<(String, String)> = ["x2", "x3"]
        .into_iter()
        .map(|name| (format!("output {name}"), format!("output {name}")))
        .chain(["p2", "p3", "p4"].map(|name| (format!("known {name}"), format!("output {name}"))))
        .chain(["x1", "x2", "x3"].map(|name| (format!("initial {name}"), format!("initial {name} known"))))
        .chain(
            ["x1", "x2", "x3"]
                .map(|name| (format!("input {name}"), format!("input into{name} {name}' = 1 others' = 0"))),
        )
        .collect();
    let text = "state x1, x2, x3 param p1, p2, p3, p4 unknown \
                drift f x1' = -p1*x1 + p2*x2 x2' = p3*x1 - p4*x2 x3' = p4*x1 - p2*x3 output x1";
    let told = |set: &[usize]| -> bool {
        // inputs and known initial_values first: an output is one of all experiments
        let mut lines: Vec<&str> = set.iter().map(|place| additions[*place].1.as_str()).collect();
        lines.sort_unstable();
        let file = format!("system \"s\" {text} {}", lines.join(" "));
        let mut system: System = file.parse().unwrap_or_else(|error| panic!("{error:?} {file}"));
        let answer =
            answer_rank(&mut system, &RankQuestion { samples: 0, ..RankQuestion::default() }).unwrap();
        let generic = answer.branches[0].generic.clone();
        let seen = generic.unknowns.iter().find(|(symbol, _)| system.symbol_name(*symbol) == "p1");
        seen.is_some_and(|(_, seen)| *seen == palmistry::observability::Observability::Yes)
    };
    let mut expected: Vec<BTreeSet<usize>> = Vec::new();
    let all = additions.len();
    let pairs = (0..all).flat_map(|i| (i + 1..all).map(move |j| vec![i, j]));
    assert!(!told(&[]));
    for set in (0..all).map(|i| vec![i]).chain(pairs) {
        let contains = |smaller: &BTreeSet<usize>| smaller.iter().all(|place| set.contains(place));
        if !expected.iter().any(contains) && told(&set) {
            expected.push(set.into_iter().collect());
        }
    }
    let names = |set: &BTreeSet<usize>| -> BTreeSet<String> {
        set.iter().map(|place| additions[*place].0.clone()).collect()
    };
    let expected: BTreeSet<BTreeSet<String>> = expected.iter().map(names).collect();
    let found = sets(text, &["p1"], |question| {
        question.at_most = 2;
        question.kinds =
            vec![AdditionKind::Outputs, AdditionKind::Known, AdditionKind::Initial, AdditionKind::Inputs];
    });
    // x1 can be measured too, and is not among those above
    let found: BTreeSet<BTreeSet<String>> =
        found.iter().map(|set| set.split(", ").map(str::to_owned).collect()).collect();
    let without: BTreeSet<_> =
        found.into_iter().filter(|set: &BTreeSet<String>| !set.contains("output x1")).collect();
    assert!(expected.len() >= 3, "{expected:?}");
    assert_eq!(without, expected);
}

/// Where an amount begins at nought nothing is told of what moves it by itself: a set that would suffice from elsewhere does not, and a larger one is found.
#[test]
fn initial_conditions_count() {
    let text = "state x, y param a, k unknown initial x = 0 drift f x' = a*x y' = k output y";
    let never = AtomicBool::new(false);
    let question =
        DesignQuestion { targets: vec!["a".to_owned()], ..DesignQuestion::of(Path::new(""), &never) };
    let answer = design(&read(text), &question).unwrap();
    // measuring x tells a from everywhere but where it stays nought; an input moves it from there
    assert!(answer.contradicted > 0 && answer.open.is_none(), "{answer:?}");
    let sets: Vec<Vec<Addition>> = answer.designs.iter().map(|design| design.additions.clone()).collect();
    assert_eq!(sets, [vec![Addition::Output("x".to_owned()), Addition::Input("x".to_owned())]]);
}

/// A parameter has the value of the file, as for a rank: with nought before it a state is not seen.
#[test]
fn parameters_are_held_as_for_a_rank() {
    let with =
        |parameter: &str| format!("state x, y param {parameter} drift f x' = -x y' = y output x + k*y");
    let never = AtomicBool::new(false);
    let question =
        || DesignQuestion { targets: vec!["y".to_owned()], ..DesignQuestion::of(Path::new(""), &never) };
    let held = design(&read(&with("k = 0")), &question()).unwrap();
    assert!(!held.is_met && held.held.len() == 1, "{held:?}");
    let sets: Vec<_> = held.designs.iter().map(|design| design.additions.clone()).collect();
    assert_eq!(sets, [vec![Addition::Output("y".to_owned())]]);
    // and where the file says nothing any value
    let free = design(&read(&with("k")), &question()).unwrap();
    assert!(free.is_met && free.held.is_empty(), "{free:?}");
}

/// Components of vectors are states as any; names that a file has are not taken for inputs; and what stands behind an expression is no line of its own.
#[test]
fn what_is_added_is_one_line_and_has_a_name_of_its_own() {
    let scaled = "state x[1..2] param k, s unknown drift f x[i]' = -k*x[i] for i in 1..2 output s*x[1]";
    assert_eq!(sets(scaled, &["s"], |_| ()), ["output x[1]", "input x[1]"]);
    let taken = "state x param k, s, into_x_0 unknown drift f x' = -k*x output s*x";
    assert_eq!(sets(taken, &["s"], |_| ()), ["output x", "input x"]);
    let ask = |text: &str, measure: &str| {
        let never = AtomicBool::new(false);
        let question = DesignQuestion {
            measurable: Some(vec![measure.to_owned()]),
            kinds: vec![AdditionKind::Outputs, AdditionKind::Inputs],
            ..DesignQuestion::of(Path::new(""), &never)
        };
        design(&read(text), &question).unwrap()
    };
    let answer = ask("state x param k, s unknown drift f x' = -k*x output s*x", "x initial x = 1");
    assert!(
        answer.designs.iter().all(|one| one.additions == [Addition::Input("x".to_owned())]),
        "{answer:?}"
    );
    assert_eq!(answer.left_out.len(), 1, "{answer:?}");
    // all names are in the file, in a comment: named, and at once
    let comment: String = (0..100).map(|number| format!(" into_x_{number}")).collect();
    let full = format!("state x param k, s unknown drift f x' = -k*x output s*x #{comment}");
    let answer = ask(&full, "x");
    assert!(answer.left_out.iter().any(|(_, why)| why.contains("has all names")), "{answer:?}");
}

/// Three further experiments are among sets of three; of functions that may satisfy relations no set is said to suffice.
#[test]
fn experiments_and_functions() {
    // each experiment is one equation for three constants and an unknown beginning that is seen
    let line = "state x param a, b, c unknown drift f x' = 0 output x, a*x^2 + b*x + c";
    let experiments = |question: &mut DesignQuestion<'_>| question.kinds = vec![AdditionKind::Experiments];
    assert_eq!(sets(line, &["a"], experiments), ["experiment, experiment"]);
    let cubic = "state x param a, b, c, d unknown drift f x' = 0 output x, a*x^3 + b*x^2 + c*x + d";
    assert_eq!(sets(cubic, &["a"], experiments), ["experiment, experiment, experiment"]);
    let power = "state x, y param n, k unknown drift f x' = -k*x^n y' = 0 output x*y";
    let never = AtomicBool::new(false);
    let answer = design(&read(power), &DesignQuestion::of(Path::new(""), &never)).unwrap();
    let undecided = answer.designs.iter().any(|design| design.log2_error.is_none());
    assert!(!undecided, "{answer:?}");
}

/// What cannot be answered is named, and what is cut off says so.
#[test]
fn limits_are_named() {
    let ask = |text: &str, targets: &[&str]| {
        let never = AtomicBool::new(false);
        let question = DesignQuestion {
            targets: targets.iter().map(|name| (*name).to_owned()).collect(),
            ..DesignQuestion::of(Path::new(""), &never)
        };
        design(&read(text), &question)
    };
    let why = ask(TWO, &["d"]).unwrap_err().to_string();
    assert!(why.contains("'d' is no unknown") && why.contains("x, y, a, b, c"), "{why}");
    assert!(ask("state x drift f x' = 0", &[]).unwrap_err().to_string().contains("no outputs"));
    assert!(ask("state x drift f x' = x output x", &[]).unwrap().is_met);
    let steps = ask("state x, y param k unknown drift f x+ = k*y y+ = x*y output x", &["k"]);
    assert!(steps.unwrap_err().to_string().contains("goes in steps"));
    let idle = AtomicBool::new(false);
    for at_most in [0, 9, usize::MAX] {
        let question = DesignQuestion { at_most, ..DesignQuestion::of(Path::new(""), &idle) };
        assert!(design(&read(TWO), &question).unwrap_err().to_string().contains("sets of 1 to 8"));
    }
    // more inputs than choices are looked at: said, and at once
    let names: Vec<String> = (0..60).map(|place| format!("x{place}")).collect();
    let rates: String = names.iter().map(|name| format!(" {name}' = {name}^2")).collect();
    let many = format!("state {} drift f{rates} output x0", names.join(", "));
    let question = DesignQuestion { at_most: 8, ..DesignQuestion::of(Path::new(""), &idle) };
    let answer = design(&read(&many), &question).unwrap();
    assert!(answer.open.as_deref().is_some_and(|why| why.contains("more than")), "{answer:?}");
    let stopped = AtomicBool::new(true);
    let answer = design(&read(TWO), &DesignQuestion::of(Path::new(""), &stopped)).unwrap();
    assert!(answer.designs.is_empty() && answer.open.as_deref() == Some("it was interrupted"), "{answer:?}");
    // with too little work for values the sets are undecided, and not said to be none
    let exchanged = "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z \
                     input u x' = 1 others' = 0 output x";
    let question = DesignQuestion { globally: true, work: 10, ..DesignQuestion::of(Path::new(""), &idle) };
    let answer = design(&read(exchanged), &question).unwrap();
    assert!(answer.designs.is_empty() && answer.open.is_some(), "{answer:?}");
    // a definition that counts the columns is of one experiment alone
    let counted =
        "state x, y param a unknown drift f x' = 0 y' = 0 let D = det([d(x); d(y); d(a)]) output x + a*y";
    let answer = ask(counted, &["a"]).unwrap();
    assert!(answer.left_out.iter().any(|(addition, _)| *addition == Addition::Experiment), "{answer:?}");
}

#[test]
fn the_command_advises() {
    let folder = folder();
    // claims are of the file as it stands: what is added does not ask for them
    let text = "system \"Two compartments\"\nstate x, y\nparam a, b, c unknown\ndrift f\n  x' = -(a + b)*x + c*y\n  y' = a*x - c*y\noutput x\n\
                claim 1 expect refuted: det([d(x); d(y); d(a); d(b); d(c)]) = 2\n";
    let file = write(&folder, "two.proof", text);
    let file = file.to_str().unwrap();
    let output = palmistry(&["advise", file, "--identify", "a,b"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("4 minimal sets of 1 addition:\n  measure y "), "{printed}");
    assert!(printed.contains("single additions; all sets of up to 3 additions were looked at"), "{printed}");
    let found = json(&palmistry(&["advise", file, "--identify", "a,b", "--by", "outputs", "--json"]));
    assert_eq!(found["designs"][0]["additions"], serde_json::json!([{ "kind": "output", "what": "y" }]));
    assert_eq!(found["designs"][0]["verdict"], "proved");
    assert_eq!(found["identify"][0]["local"], "non-identifiable");
    assert_eq!(found["final"], true);
    // nothing suffices: an answer, and not the one that was hoped for
    let none = palmistry(&["advise", file, "--identify", "a,b", "--by", "experiments"]);
    assert_eq!(none.status.code(), Some(1), "{}", String::from_utf8_lossy(&none.stdout));
    for (arguments, word) in [
        (&["--identify", "a", "--trials", "3"][..], "--trials is for scenes"),
        (&["--identify", "q"], "'q' is no unknown"),
        (&["--identify", "a", "--measure", "x\ny"], "is no expression in one line"),
    ] {
        let output = palmistry(&[&["advise", file], arguments].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(word), "{said}");
    }
    let bare = palmistry(&["advise", file]);
    let said = String::from_utf8_lossy(&bare.stderr).into_owned();
    assert!(bare.status.code() == Some(2) && said.contains("--identify k1,k2"), "{said}");
    // what cannot be read is left out, and said to be
    let output = palmistry(&["advise", file, "--identify", "a", "--measure", "x +", "--measure", "y"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("left out: measure x +"), "{output:?}");
}

/// What is assumed leaves no open set of states, or outputs and rates exist on none: nothing is advised.
#[test]
fn nothing_is_advised_on_a_thin_set() {
    for text in [
        "state x param a unknown param m drift f x' = a*m*x output x assume m >= 0, m <= 0",
        "state x param a unknown param m drift f x' = a*m*x output x, sqrt(m) + sqrt(-m)",
    ] {
        let never = AtomicBool::new(false);
        let question =
            DesignQuestion { targets: vec!["a".to_owned()], ..DesignQuestion::of(Path::new(""), &never) };
        let why = design(&read(text), &question).map(|answer| answer.is_met).unwrap_err().to_string();
        assert!(why.contains("what is assumed is met"), "{why}");
    }
    let open =
        sets("state x param a unknown param m drift f x' = a*m*x output x assume m > 0", &["a"], |_| ());
    assert!(open.is_empty());
}
