//! Least models of systems by hand: what is left out, and that all claims of the new files are proved.

use palmistry_lang::System;
use palmistry_prove::claim::prove;
use palmistry_reduce::{LeastModel, NotReduced, ReduceQuestion, WhyLeftOut, reduce};
use std::path::Path;

fn question(conditions: &[&str], known: &[&str], undriven: &[&str]) -> ReduceQuestion {
    let list = |names: &[&str]| -> Vec<String> { names.iter().map(|name| (*name).to_owned()).collect() };
    ReduceQuestion {
        conditions: list(conditions),
        known: list(known).into_iter().map(|name| (name, None)).collect(),
        undriven: list(undriven),
        ..ReduceQuestion::default()
    }
}

/// The least model of a text, read back, with all its claims proved.
fn least(text: &str, asked: &ReduceQuestion) -> Result<(LeastModel, System), NotReduced> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("whole.proof"), text).unwrap();
    let system = System::parse("whole.proof", text, folder.path()).unwrap();
    let found = reduce(&system, asked, "whole.proof")?;
    let small = System::parse("least.proof", &found.text, folder.path());
    let small = small.unwrap_or_else(|error| panic!("{error}\n{}", found.text));
    for outcome in prove(&small) {
        assert!(outcome.ok, "{} {}: {}\n{}", outcome.word(), outcome.id, outcome.statement, found.text);
    }
    assert!(!small.claims.is_empty());
    Ok((found, small))
}

fn names(found: &LeastModel) -> Vec<(&str, &str)> {
    let word = |why: &WhyLeftOut| match why {
        WhyLeftOut::Fixed(_) => "fixed",
        WhyLeftOut::KnownConstant => "known",
        WhyLeftOut::MeasuredConstant => "measured",
        WhyLeftOut::NoOutputDependsOnIt => "dead",
        WhyLeftOut::NotNeeded => "not needed",
        WhyLeftOut::InSmallTermsAlone => "small",
        WhyLeftOut::Conserved { .. } => "conserved",
    };
    found.left_out.iter().map(|one| (one.name.as_str(), word(&one.why))).collect()
}

const EPIDEMIC: &str = r#"
system "An epidemic of which the ill are counted"
state S, I, R
param beta, gamma unknown
drift f
  S' = -beta*S*I
  I' = beta*S*I - gamma*I
  R' = gamma*I
output I
"#;

/// No output depends on who has recovered; where they are counted too, one of the three is given by the others.
#[test]
fn states_that_no_output_needs_and_conservation_laws() {
    let (found, small) = least(EPIDEMIC, &ReduceQuestion::default()).unwrap();
    assert_eq!(names(&found), [("R", "dead")]);
    assert_eq!((found.unknowns, found.moving), ([5, 4], [3, 2]));
    assert_eq!(small.state_names(), ["S", "I", "beta", "gamma"]);
    let counted = EPIDEMIC.replace("output I", "output I, R");
    let (found, small) = least(&counted, &ReduceQuestion::default()).unwrap();
    assert_eq!(names(&found), [("S", "conserved")]);
    let WhyLeftOut::Conserved { law, total } = &found.left_out[0].why else { panic!() };
    assert_eq!((law.as_str(), total.as_str()), ("I + R + S", "total"));
    assert_eq!((found.unknowns, found.moving), ([5, 5], [3, 2]));
    assert!(small.state_names().contains(&"total".to_owned()));
}

/// A known signal beside parameters of both kinds, definitions that are functions of it, an angle, and units.
#[test]
fn signals_parameters_angles_and_units_are_declared_again() {
    let text = r#"
        system "A cart with a pole"
        state x : length, v : velocity, phi : angle, omega : 1/time
        param M, m : mass unknown
        param l : length unknown
        param g : acceleration = 9.81
        angle phi
        known F(t) : force
        let s = (F + m*l*omega^2*sin(phi))/(M + m)
        let alpha = (g*sin(phi) - cos(phi)*s)/(l*(4/3 - m*cos(phi)^2/(M + m)))
        assume M > 0, m > 0
        drift f
          x'     = v
          v'     = s - m*l*alpha*cos(phi)/(M + m)
          phi'   = omega
          omega' = alpha
        output phi
        sample
          phi in [-1, 1]
          F   in [1, 2]
          avoid cos(phi), v
        "#;
    let (found, small) = least(text, &question(&[], &["l"], &[])).unwrap();
    assert_eq!(names(&found), [("x", "dead"), ("v", "dead"), ("l", "known")]);
    assert!(
        found.text.contains("known F(t) : ") && found.text.contains("avoid cos(phi)\n"),
        "{}",
        found.text
    );
    assert!(found.text.contains("let alpha = ") && found.text.contains("assume M > 0"), "{}", found.text);
    assert!(small.is_angle(small.find_symbol("phi").unwrap()));
    // without a force, and a level cart
    let (found, _) = least(text, &question(&["F = 0", "g = 0"], &[], &[])).unwrap();
    assert!(!found.text.contains("F(t)") && !found.text.contains("param g"), "{}", found.text);
}

/// Conditions that a field does not keep, that are met in two ways, or under which nothing has a value.
#[test]
fn conditions_have_to_stay_met() {
    let text = r#"
        system "A pendulum on a cart that somebody drives"
        state phi, omega, v
        param k
        angle phi
        drift f
          phi' = omega
          omega' = -k*sin(phi) - v
          v' = 0
        input a
          v' = 1
          others' = 0
        output phi
        "#;
    let why = |conditions: &[&str], undriven: &[&str]| {
        least(text, &question(conditions, &[], undriven)).unwrap_err()
    };
    assert!(
        matches!(why(&["v = 0"], &[]), NotReduced::NotKept { field, rate, .. } if field == "input a" && rate == "1")
    );
    assert!(matches!(why(&["omega = 0"], &[]), NotReduced::NotKept { field, .. } if field == "drift f"));
    assert!(matches!(
        why(&["phi^2 = 1", "v = 0"], &["a"]),
        NotReduced::SeveralWays { .. } | NotReduced::Condition { .. }
    ));
    assert!(matches!(why(&["v > 0"], &["a"]), NotReduced::Condition { .. }));
    assert!(matches!(why(&["w = 0"], &["a"]), NotReduced::Condition { .. }));
    assert!(matches!(why(&[], &["b"]), NotReduced::NoInput { .. }));
    let (found, _) = least(text, &question(&["v = 0"], &[], &["a"])).unwrap();
    assert_eq!((names(&found), found.unknowns), (vec![("v", "fixed")], [3, 2]));
    // at rest no unknown is left on which an output depends
    assert_eq!(why(&["omega = 0", "v = -k*sin(phi)"], &["a"]), NotReduced::Nothing);
}

/// A condition between states, and one that holds by itself.
#[test]
fn two_of_a_kind_are_one() {
    let text = r#"
        system "Two equal tanks that fill each other"
        state x, y, z
        param k unknown
        drift f
          x' = -k*(x - z)
          y' = -k*(y - z)
          z' = k*(x + y - 2*z)
        output z + x - y
        "#;
    let (found, small) = least(text, &question(&["y = x"], &[], &[])).unwrap();
    assert_eq!(small.state_names().len(), 3, "{}", found.text);
    assert!(names(&found).contains(&("y", "fixed")) || names(&found).contains(&("x", "fixed")));
    assert!(
        found.left_out.iter().any(|one| matches!(one.why, WhyLeftOut::Conserved { .. })),
        "{}",
        found.text
    );
}

/// What is known and moves becomes an output, and its rate is as informative as before.
#[test]
fn what_moves_and_is_known_is_an_output() {
    let text = "system \"a\" state x, y drift f x' = y y' = -y output x";
    let (found, small) = least(text, &question(&[], &["y"], &[])).unwrap();
    assert_eq!((small.outputs.len(), small.state_names().len()), (2, 2));
    assert!(found.remarks[0].contains("output"), "{:?}", found.remarks);
    let why = least(text, &question(&[], &["z"], &[])).unwrap_err();
    assert!(matches!(why, NotReduced::NoUnknown { .. }));
    // a parameter on which no output depends
    let text = "system \"a\" state x param k unknown drift f x' = 0 output x";
    assert_eq!(least(text, &question(&[], &["k"], &[])).unwrap_err(), NotReduced::Nothing);
    for (text, word) in [
        ("system \"a\" state x drift f x+ = x output x", "discrete"),
        ("system \"a\" state x experiments 2 drift f x' = 1 output x", "experiments"),
        ("system \"a\" state x initial x = 0 drift f x' = 1 output x", "initial"),
    ] {
        let why = least(text, &ReduceQuestion::default()).unwrap_err();
        assert!(why.to_string().contains(word), "{why}");
    }
}

/// A state with a known initial condition is no unknown, and stays one that moves.
#[test]
fn known_initial_conditions_are_declared_again() {
    let text = "system \"a\" state x, y, z param k unknown initial x, z known drift f x' = k*x y' = x z' = 0 output x + y + z";
    let (found, small) = least(text, &ReduceQuestion::default()).unwrap();
    assert_eq!((names(&found), found.unknowns), (vec![("z", "known")], [2, 2]), "{}", found.text);
    assert!(found.text.contains("initial x known\n") && small.unknown_count() == 2, "{}", found.text);
}

/// A state whose initial condition is known and on which nothing depends is not called unobservable.
#[test]
fn what_is_known_and_not_needed_is_no_unobservable_state() {
    let text = "system \"a\" state x, z initial z known drift f x' = -x z' = x output x";
    let (found, _) = least(text, &ReduceQuestion::default()).unwrap();
    assert!(matches!(found.left_out[0].why, WhyLeftOut::NotNeeded), "{:?}", found.left_out);
    assert!(!found.text.contains("unobservable"), "{}", found.text);
}

/// That a condition stays met may rest on a relation between functions, and what is not shown is not said to be false.
#[test]
fn conditions_between_functions() {
    let text = "system \"a\" state x, y, z drift f x' = 2*x y' = y z' = y output z sample x in [1, 2] y in [1, 2] z in [1, 2]";
    let (found, _) = least(text, &question(&["y = sqrt(x)"], &[], &[])).unwrap();
    assert!(names(&found).iter().any(|(_, why)| *why == "fixed"), "{:?}", found.left_out);
    let why = least(text, &question(&["y = exp(x)"], &[], &[])).unwrap_err().to_string();
    assert!(why.contains("is not shown to stay met"), "{why}");
}

/// A path that would end its quotation marks is refused.
#[test]
fn no_path_forges_a_line() {
    let system =
        System::parse("a.proof", "system \"a\" state x drift f x' = -x output x", Path::new("")).unwrap();
    for import in ["a\" claim c: 1 = 1 \"", "a\nclaim c: 1 = 1"] {
        let found = reduce(&system, &ReduceQuestion::default(), import);
        assert!(matches!(found, Err(NotReduced::Kind { .. })), "{import:?}");
    }
}

/// Formulas that are too long in one piece are written in parts.
#[test]
fn long_formulas_are_written_in_parts() {
    let mut sum = "sin(x)*y + cos(x)*z".to_owned();
    for _ in 0..9 {
        sum = format!("(({sum})^2 + x*({sum}))");
    }
    let text = format!("system \"a\" state x, y, z drift f x' = y y' = z z' = {sum} output x");
    let (found, _) = least(&text, &ReduceQuestion::default()).unwrap();
    assert!(found.text.contains("let part2 = "), "{}", found.text);
}

/// Components of vectors, an output that is an equation, an unknown signal.
#[test]
fn vectors_equations_and_unknown_signals() {
    let text = r#"
        system "A chain whose end is pulled by nobody knows what"
        state x[1..3], v[1..3], dead
        unknown w(t) order 1
        drift f
          x[i]' = v[i] for i in 1..3
          v[1]' = x[2] - x[1]
          v[2]' = x[1] - 2*x[2] + x[3]
          v[3]' = x[2] - x[3] + w
          dead' = x[1]
        output x[1], x[3]
        "#;
    let (found, small) = least(text, &ReduceQuestion::default()).unwrap();
    assert_eq!(names(&found), [("dead", "dead")]);
    assert!(small.state_names().contains(&"w".to_owned()), "{}", found.text);
    let (found, _) = least(text, &question(&["w = 0"], &[], &[])).unwrap();
    assert!(!found.text.contains("unknown w"), "{}", found.text);
    let text = "system \"a\" state x, y param a unknown known u(t) drift f x' = u y' = x*y output x output 0 = a*x - u";
    let (found, small) = least(text, &ReduceQuestion::default()).unwrap();
    assert_eq!((names(&found), small.zero_outputs().len()), (vec![("y", "dead")], 1));
}

/// What drives an input is a known signal, or has a value: then no input is left, and the claims hold both sides to the torques.
#[test]
fn driven_inputs_are_in_the_drift() {
    let text = r#"
        system "A cart that a motor drives"
        state x : length, v : velocity
        param u : force
        param m : mass = 2
        param b : force*time/length unknown
        drift f
          x' = v
          v' = -b*v/m
        input g
          v' = 1/m
          others' = 0
        output x
        "#;
    let driven = |conditions: &[&str], known: &[&str]| ReduceQuestion {
        driven: vec![("g".to_owned(), "u".to_owned())],
        ..question(conditions, known, &[])
    };
    let (found, small) = least(text, &driven(&[], &[])).unwrap();
    assert!(found.text.contains("known u(t) : ") && !found.text.contains("input"), "{}", found.text);
    assert!(found.text.contains("L(larger.f, v) + u*L(larger.g, v)"), "{}", found.text);
    assert_eq!((small.fields.len(), found.unknowns), (2, [3, 3]), "the drift, and that u may change");
    let (found, _) = least(text, &driven(&["u = 0"], &[])).unwrap();
    assert!(!found.text.contains("known u"), "{}", found.text);
    let asked = ReduceQuestion { signals: vec!["m".to_owned()], ..driven(&["u = 0"], &[]) };
    let (found, _) = least(text, &asked).unwrap();
    assert!(found.text.contains("known m(t) : mass"), "{}", found.text);
    let value = "1/2".parse().unwrap();
    let asked = ReduceQuestion { known: vec![("b".to_owned(), Some(value))], ..driven(&[], &[]) };
    let (found, _) = least(text, &asked).unwrap();
    assert!(found.text.contains("param b : ") && found.text.contains(" = 1/2\n"), "{}", found.text);
    for (driven, word) in [(("h", "u"), "input"), (("g", "w"), "signal"), (("g", "x"), "signal")] {
        let asked = ReduceQuestion {
            driven: vec![(driven.0.to_owned(), driven.1.to_owned())],
            ..ReduceQuestion::default()
        };
        let why = least(text, &asked).unwrap_err().to_string();
        assert!(why.contains(word), "{why}");
    }
}

/// Each file of the benchmarks and each regime of the thesis as its author wrote it down by hand.
#[test]
fn the_thesis_s_regimes_are_found() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../proofs/moll2002");
    let system = System::read(&folder.join("general.proof")).unwrap();
    let import = folder.join("general.proof");
    let at_rest = ["alpha1 = 0, alpha2 = 0"];
    for (conditions, known, undriven, states, rank) in [
        (&["omega1 = 0, omega2 = 0"][..], &["rho"][..], &[][..], &["r1", "r2", "omega0", "s1", "s2"][..], 5),
        (&["omega1 = 0"], &["rho"], &[], &["r1", "r2", "omega0", "s1", "s2", "phi2"], 6),
        (&["omega2 = 0"], &["omega1"], &["g1", "g2"], &["r1", "r2", "omega0", "s1", "s2", "phi1"], 6),
        (&[], &["omega1", "omega2"], &["g1", "g2"], &["r1", "r2", "omega0", "s1", "s2", "phi1", "phi2"], 7),
    ] {
        let conditions = [&at_rest[..], conditions].concat();
        let found =
            reduce(&system, &question(&conditions, known, undriven), import.to_str().unwrap()).unwrap();
        let small = System::parse("least.proof", &found.text, Path::new("")).unwrap();
        assert_eq!(small.state_names(), states, "{}", found.text);
        for outcome in prove(&small) {
            assert!(outcome.ok, "{} {}", outcome.id, outcome.statement);
        }
        let answer = palmistry_rank::observability::generic_answer(
            &small,
            &palmistry_lang::Assignment::new(),
            palmistry_rank::observability::Ceiling::Rests,
        );
        assert_eq!(answer.rank(), Some(rank), "{}", found.text);
    }
}

/// Assumptions stay as they are, functions in them too; what is left out is put in, and what says nothing of the rest is named.
#[test]
fn assumptions_are_carried_over() {
    let functions = "system \"s\" state x, z param k unknown assume exp(x) > 2, abs(k) < 3, k > 1 drift f x' = -k*x z' = x output x";
    let (_, small) = least(functions, &ReduceQuestion::default()).unwrap();
    assert_eq!(small.assumptions(), ["exp(x) > 2", "abs(k) < 3", "k > 1"]);
    // by hand: y = total - x, between 2 and 4
    let conserved = "system \"s\" state x, y param b unknown assume y > 0 drift f x' = -b*x*max(y, 0) y' = b*x*max(y, 0) output max(y, 0), x sample x in [1, 2] y in [1, 2]";
    let (found, small) = least(conserved, &ReduceQuestion::default()).unwrap();
    assert_eq!(names(&found), [("y", "conserved")]);
    let [assumed] = &small.assumptions()[..] else { panic!("{}", found.text) };
    assert!(assumed.ends_with("- x > 0"), "{assumed}");
    let total = small.states.iter().find(|state| small.symbol_name(**state).starts_with("total"));
    let range = small.symbol_info(*total.unwrap()).unwrap().range.clone().unwrap();
    assert_eq!((range.low, range.high), (2.into(), 4.into()));
    let equal =
        "system \"s\" state x, y param b unknown assume y > 0 drift f x' = -b*x y' = -b*y output x, y";
    let fixed = |condition: &str| least(equal, &question(&[condition], &[], &[]));
    assert_eq!(fixed("y = x").map(|(_, small)| small.assumptions()).unwrap(), ["x > 0"]);
    let contradicted = fixed("y = 0");
    assert!(
        matches!(&contradicted, Err(NotReduced::Kind { why }) if why.contains("contradict")),
        "{contradicted:?}"
    );
    let apart = "system \"s\" state x, z assume z > x drift f x' = -x z' = 1 output x";
    let (found, small) = least(apart, &ReduceQuestion::default()).unwrap();
    assert!(small.assumptions().is_empty() && found.text.contains("not assumed here"), "{}", found.text);
}
