//! Inputs as users have them: constants to be identified, signals known and unknown, values at the beginning, several
//! experiments. All ranks are found by hand; the calculation stands with each.

use crate::common::{folder, json, palmistry, write};
use palmistry::system::UnknownKind;
use palmistry::{System, prove};
use std::path::Path;

fn system(text: &str) -> System {
    System::parse("test.proof", text, Path::new("")).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Each rank below and above is refuted, so that the claim is no accident.
fn has_rank(text: &str, rank: usize) {
    let claims = format!(
        "{text}\nclaim less expect refuted: rank = {}\nclaim right: rank = {rank}\nclaim more expect refuted: rank = {}\n",
        rank.wrapping_sub(1).min(1000),
        rank + 1
    );
    for outcome in prove(&system(&claims)) {
        assert!(outcome.ok, "{} is {}: {claims}", outcome.statement, outcome.word());
    }
}

/// `y = x`, `x' = a u + b u^2`: along the field that drives u, `x'` has the derivatives `a + 2 b u` and `2 b`, so that `a`
/// and `b` are seen. Were u a constant to be identified, only `a u + b u^2` would be.
#[test]
fn a_known_signal_may_enter_in_any_way() {
    let text = |declared: &str| {
        format!("system \"s\" state x param a, b unknown {declared} drift f x' = a*u + b*u^2 output x")
    };
    has_rank(&text("known u(t)"), 3);
    has_rank(&text("param u"), 2);
    // x, and the one combination: a, b and u are three unknowns more
    has_rank(&text("param u unknown"), 2);
    let found = system(&text("known u(t)"));
    assert_eq!((found.states.len(), found.unknown_count(), found.known.len()), (4, 3, 1));
    let kinds: Vec<_> =
        found.states.iter().map(|state| (found.symbol_name(*state), found.unknown_kind(*state))).collect();
    let parameter = Some(UnknownKind::Parameter);
    assert_eq!(kinds, [("x", Some(UnknownKind::State)), ("a", parameter), ("b", parameter), ("u", None)]);
}

/// `y = k u'`: `k` is seen where `u'` is not zero, and `u` itself says nothing. With `y = x + k u'`, `x' = 0` the derivative by
/// `u'`, along the field `u''`, is `k`, and `x` follows.
#[test]
fn derivatives_of_known_signals() {
    let k = "system \"s\" param k unknown known u(t) output k*u'";
    has_rank(k, 1);
    let found =
        system(&format!("{k} claim 1: L(signals, u) = u' claim 2: L(u'', k*u') = k claim 3: L(u'', u) = 0"));
    assert_eq!(found.known.len(), 2);
    assert!(prove(&found).iter().all(|outcome| outcome.ok));
    let roles: Vec<String> =
        found.roles().iter().map(|field| format!("{} {}", field.role.name(), field.name)).collect();
    assert_eq!(roles, ["drift signals", "input u''"]);
    has_rank("system \"s\" state x param k unknown known u(t) drift f x' = 0 output x + k*u'", 2);
    // as a set says: where u' is zero, and stays so for a while, k is not seen; the fields leave it, and so it is seen
    let at_rest = "system \"s\" state x param k unknown known u(t) drift f x' = 0 output x + k*u' claim 1: rank = 2 where u' = 0";
    assert_eq!(prove(&system(at_rest))[0].word(), "proved");
}

/// `y = x`, `x' = w`: with `w^(n+1) = 0` the derivatives of y are x, w, w', ..., all of them seen. With `y = x + z`, `z' = w`,
/// `x' = 0` only the sum and the signal's derivatives are.
#[test]
fn unknown_signals_have_an_order() {
    for (order, unknown) in [("order 0", 1), ("", 2), ("order 1", 2), ("order 3", 4)] {
        let text = format!("system \"s\" state x unknown w(t) {order} drift f x' = w output x");
        has_rank(&text, 1 + unknown);
        let found = system(&text);
        let last = format!("w{} = 0", "'".repeat(unknown));
        assert_eq!(found.assumed_of_signals(), [last]);
        let w = found.find_symbol("w").unwrap();
        assert_eq!(found.unknown_kind(w), Some(UnknownKind::Signal));
    }
    has_rank("system \"s\" state x, z unknown w(t) order 1 drift f x' = 0 z' = w output x + z", 3);
    // no statement rests on an order that the file does not say
    let claimed = |order: &str, claim: &str| {
        let text =
            format!("system \"s\" state x unknown w(t) {order} drift f x' = w output x claim 1: {claim}");
        System::parse("test.proof", &text, Path::new(""))
    };
    let refused = claimed("", "L(f, f, f, x) = 0").unwrap_err().to_string();
    assert!(
        refused.contains("the derivative of 'w'' is w'', and the file does not say that it is zero"),
        "{refused}"
    );
    // no bracket and no step of a map does either
    for (order, claim, word) in [
        ("", "bracket(f, g, x) = [0]", ""),
        ("", "L(bracket(f, g), x) = 0", ""),
        ("order 1", "L(bracket(f, g), x) = 0", "proved"),
        ("order 2", "L(bracket(f, g), x) = 0", "refuted"),
    ] {
        let text = format!(
            "system \"s\" state x unknown w(t) {order} drift f x' = w input g x' = w' output x claim 1: {claim}"
        );
        match System::parse("test.proof", &text, Path::new("")) {
            Ok(found) => assert_eq!(prove(&found)[0].word(), word, "{order} {claim}"),
            Err(refused) => assert!(
                word.is_empty() && refused.to_string().contains("derivative of 'w'' is w''"),
                "{refused}"
            ),
        }
    }
    for (order, is_told) in [("", false), ("order 1", true)] {
        let text = format!(
            "system \"s\" state x unknown w(t) {order} drift f x+ = x + w output x claim 1: L(f, f, f, x) = x + 3*w + 3*w'"
        );
        match System::parse("test.proof", &text, Path::new("")) {
            Ok(found) => assert!(is_told && prove(&found)[0].word() == "proved"),
            Err(refused) => assert!(
                !is_told && refused.to_string().contains("what 'w'' is after a step is given by w''"),
                "{refused}"
            ),
        }
    }
    for (order, claim, word) in [
        ("order 1", "L(f, f, f, x) = 0", "proved"),
        ("", "L(f, f, x) = w'", "proved"),
        ("", "L(f, f, f, x) = w''", "proved"),
        ("order 2", "L(f, f, f, x) = 0", "refuted"),
    ] {
        assert_eq!(prove(&claimed(order, claim).unwrap())[0].word(), word, "{order} {claim}");
    }
    // what the file mentions is there without being asked for
    let mentioned = system("system \"s\" state x unknown w(t) drift f x' = w''' output x");
    assert_eq!(mentioned.unknown_count(), 5);
}

/// `y = c x`, `x' = -k x`: c and x are seen as a product, but where the initial condition of x is known.
#[test]
fn values_that_are_known_at_the_beginning() {
    let text = "system \"s\" state x param k, c unknown drift f x' = -k*x output c*x";
    has_rank(text, 2);
    has_rank(&format!("{text} initial x known"), 2);
    assert_eq!(system(&format!("{text} initial x known")).unknown_count(), 2);
    // where it is zero it stays zero, and nothing is seen
    has_rank(&format!("{text} initial x = 0"), 0);
    // y = x1, x1' = x2, x2' = k: seen in the second derivative, although the first adds nothing
    let late =
        "system \"s\" state x1, x2 param k unknown drift f x1' = x2 x2' = k output x1 initial x1, x2 known";
    has_rank(late, 1);
    // y = c x, x' = k - x from x = 0: y' = c k there, and y^(n+1) = -y^(n); off that set c is seen too
    let start = "system \"s\" state x param k, c unknown drift f x' = k - x output c*x";
    has_rank(&format!("{start} initial x = 0"), 1);
    has_rank(&format!("{start} initial x = 1/2"), 2);
    has_rank(&format!("{start} param p initial x = p"), 2);
    has_rank(&format!("{start} initial x known"), 2);
}

/// The claim is about the beginning, and so is what the program says of ranks.
#[test]
fn ranks_are_asked_at_the_beginning() {
    let folder = folder();
    let start =
        "system \"s\"\nstate x\nparam k, c unknown\ndrift f\n  x' = k - x\noutput c*x\ninitial x = 0\n";
    let file = write(&folder, "start.proof", start);
    let found = json(&palmistry(&["rank", file.to_str().unwrap(), "--samples", "20", "--json"]));
    assert_eq!(found["rank_histogram"], serde_json::json!({ "1": 20 }));
    assert_eq!(found["higher_derivatives_cannot_raise_it"], true);
    assert_eq!(found["conditions"], serde_json::json!(["x = 0"]));
    assert_eq!(found["known"], serde_json::json!(["x"]));
    assert_eq!(found["dimension"], 2);
}

/// `x' = a + b z` with z at rest, both seen: one experiment tells `a + b z`, two with other values of z tell a and b. The
/// unknowns are x, z, a, b, and x and z once more.
#[test]
fn what_two_experiments_tell_and_one_does_not() {
    let text = |experiments: &str| {
        format!(
            "system \"s\" {experiments} state x, z param a, b unknown drift f x' = a + b*z z' = 0 output x, z"
        )
    };
    has_rank(&text(""), 3);
    has_rank(&text("experiments 1"), 3);
    has_rank(&text("experiments 2"), 6);
    has_rank(&text("experiments 3"), 8);
    let found = system(&text("experiments 2"));
    let names: Vec<&str> = found.states.iter().map(|state| found.symbol_name(*state)).collect();
    assert_eq!(names, ["x", "z", "a", "b", "x@2", "z@2"]);
    let outputs: Vec<&str> = found.outputs.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(outputs, ["x", "z", "x@2", "z@2"]);
    // said at the end it is the same
    has_rank(
        "system \"s\" state x, z param a, b unknown drift f x' = a + b*z z' = 0 output x, z experiments 2",
        6,
    );
    let claims = "let v = a + b*z claim 1: L(f, x@2) = v@2 claim 2: v@2 - v = b*(z@2 - z) claim 3: d(v@2, z@2) = b \
                  claim 4: rank = 5 where z@2 = z";
    let outcomes = prove(&system(&format!("{} {claims}", text("experiments 2"))));
    assert!(
        outcomes.iter().all(|outcome| outcome.ok),
        "{:?}",
        outcomes.iter().map(|o| o.word()).collect::<Vec<_>>()
    );
}

/// Inputs and signals are those of their experiment: what drives the second one does not move the first.
#[test]
fn each_experiment_has_inputs_and_signals_of_its_own() {
    let text = "system \"s\" experiments 2 state x param c unknown known u(t) drift f x' = c*u^2 input g x' = 1 output x \
                claim 1: L(g@2, x@2) = 1 claim 2: L(g@2, x) = 0 claim 3: L(u'@2, f) = 0";
    let error = System::parse("s", text, Path::new("")).unwrap_err();
    assert!(error.message.contains("'f'"), "{error}");
    let text = text.replace("L(u'@2, f) = 0", "L(u'@2, f, x@2) = 2*c*u@2 claim 4: L(u', f, x@2) = 0");
    let found = system(&text);
    assert!(prove(&found).iter().all(|outcome| outcome.ok), "{text}");
    let roles: Vec<String> = found.roles().into_iter().map(|field| field.name).collect();
    assert_eq!(roles, ["f", "g", "g@2", "u'", "u'@2"]);
    assert_eq!((found.unknown_count(), found.known.len()), (3, 2));
}

/// A derivative of a signal has its dimension by time; a copy has that of what it is a copy of.
#[test]
fn dimensions_go_along() {
    let text = |rate: &str| {
        format!(
            "system \"s\" experiments 2 state x : length, v : velocity param m = 2 : mass unknown known u(t) : force \
             unknown w(t) : velocity order 1 drift f x' = v + w v' = {rate} output x output x"
        )
    };
    let found = system(&format!(
        "{} claim 1: L(u''@2, u'@2*x@2) = x@2 claim 2: L(f, v@2)*m = u@2 + m*L(f, f, x)*0",
        text("u/m + u'*0")
    ));
    let dimension = |name: &str| found.dimension_of(found.find_symbol(name).unwrap()).unwrap().to_string();
    assert_eq!((dimension("w'"), dimension("u@2")), (dimension("w'@2"), dimension("u")));
    assert_eq!(dimension("w'@2"), "length/time^2");
    for wrong in ["u'/m", "u", "u/m + w"] {
        let error = System::parse("s", &text(wrong), Path::new("")).unwrap_err();
        assert!(error.message.contains("has to be") || error.message.contains("two dimensions"), "{error}");
    }
}

/// Words that begin these entries are names elsewhere.
#[test]
fn the_new_words_are_names_too() {
    let text = "system \"s\" state initial, experiments param t = 2 drift f initial' = experiments + t experiments' = 0 output initial \
                sample initial in [0, 1] experiments in [0, 1] claim 1: rank = 2";
    assert!(prove(&system(text)).iter().all(|outcome| outcome.ok));
    // with a comma before it, `unknown` would be a third constant, and a and b known
    for word in ["unknown", "known", "everywhere", "except"] {
        let text = format!("system \"s\" state x param a, b, {word} drift f x' = -a*b*x output x");
        let error = System::parse("test.proof", &text, Path::new("")).expect_err(&text);
        assert!(error.message.contains("a word of the language"), "{error}");
    }
}

/// Where it stands, and what is said.
#[test]
fn mistakes_are_refused_where_they_stand() {
    for (text, place, message) in [
        ("param k unknown\ndrift f\n  k' = 1", (5, 3), "'k' is a constant"),
        ("known u(t)\ndrift f\n  u' = 1", (5, 3), "is a signal"),
        ("drift f\n  x' = 1\nparam k unknown", (5, 7), "does not know of this state"),
        ("drift f\n  x' = u'", (4, 8), "unknown name 'u''"),
        ("unknown w(t) order 1\ndrift f\n  x' = w''", (3, 20), "zero by this order"),
        ("unknown w(t) order 1/2", (3, 20), "whole number"),
        ("known u(s)", (3, 9), "'t'"),
        ("known u", (3, 7), "'(t)'"),
        ("known u(t) order 2", (3, 12), "no order behind a known signal"),
        ("initial x", (3, 10), "'known' or a value"),
        ("param k unknown\ninitial k known", (4, 9), "a constant"),
        ("param k unknown\ninitial x = k", (4, 13), "'k' is not known"),
        ("initial y known", (3, 9), "unknown state 'y'"),
        ("initial x known\ninitial x = 0", (4, 9), "said already"),
        ("experiments 0", (3, 13), "from 1 to 20"),
        ("experiments 2\nexperiments 3", (4, 1), "says already"),
        ("experiments 2\ndrift f\n  x@2' = 1", (5, 3), "in the first experiment"),
        ("experiments 2\nlet v = x\noutput v@3", (5, 8), "no experiment 3"),
        ("state y@2", (3, 7), "further experiments"),
        ("state x'", (3, 7), "derivatives of signals"),
        ("known u'(t)", (3, 7), ""),
        ("known x(t)", (3, 7), "has a meaning already"),
        ("let x' = 1", (3, 5), "derivatives of signals"),
        ("param k, k' unknown", (3, 10), "derivatives of signals"),
    ] {
        let text = format!("system \"s\"\nstate x\n{text}\n");
        let error = System::parse("test.proof", &text, Path::new("")).expect_err(&text);
        assert!(error.message.contains(message), "{error}: {text}");
        assert_eq!(error.line_and_column(), place, "{error}: {text}");
    }
}

/// Ranges that the file does not give: half of a hint to both sides of it, what is divided by or has a root taken of from one
/// half to two, angles on almost a whole turn, all else from -1 to 1.
#[test]
fn what_has_no_range_is_drawn_by_default() {
    let folder = folder();
    let text = "system \"s\"\nstate x, phi\nparam k = 4, c = -2, z = 0 unknown\nparam j = -2, l = 4 unknown\nparam m unknown\n\
                known u(t)\nangle phi\ndrift f\n  x' = sqrt(u)/m + sin(phi) + j\n  phi' = l\noutput x, k + z\n";
    let file = write(&folder, "s.proof", text);
    let found = json(&palmistry(&["rank", file.to_str().unwrap(), "--samples", "20", "--json"]));
    let told = serde_json::json!({
        "x": ["-1", "1"], "phi": ["-3", "3"], "z": ["-1", "1"], "l": ["2", "6"], "m": ["0.5", "2"], "u": ["0.5", "2"]
    });
    assert_eq!(found["drawn_by_default"], told);
    let text =
        String::from_utf8(palmistry(&["rank", file.to_str().unwrap(), "--samples", "20"]).stdout).unwrap();
    assert!(text.contains("drawn by default"), "{text}");
}

/// Signals that are tied to states by outputs that are zero. By hand: `u = x` with `x' = k` tells x, and by its derivative k.
/// `u = y/x` of what turns with the rate w tells the angle and w, and not the radius. `u = 1/x`, `v = -x y` tell both, and their
/// rates. `x + k u^2 = 1` with x and k at rest keeps u at rest: one equation for two unknowns; were u free, two of them.
#[test]
fn outputs_that_are_zero_tie_signals_to_states() {
    has_rank("system \"s\" state x param k unknown known u(t) drift f x' = k output 0 = x - u", 2);
    has_rank(
        "system \"s\" state x, y param w unknown known u(t) drift f x' = -w*y y' = w*x output 0 = u*x - y",
        2,
    );
    has_rank(
        "system \"s\" state x, y param a unknown known u(t), v(t) unknown w(t) order 0 drift f x' = w y' = a \
         output 0 = u*x - 1, 0 = v + x*y",
        4,
    );
    let at_rest = "system \"s\" state x param k unknown known u(t) drift f x' = 0";
    has_rank(&format!("{at_rest} output 0 = x + k*u^2 - 1"), 1);
    has_rank(&format!("{at_rest} output x + k*u^2"), 2);
    // u = a x + b with x seen and at rest: one experiment tells the sum, two tell a and b
    let line = "state x param a, b unknown known u(t) drift f x' = 0 output x output 0 = u - a*x - b";
    has_rank(&format!("system \"s\" {line}"), 2);
    has_rank(&format!("system \"s\" experiments 2 {line}"), 4);
}

/// Drawn states lie on the set, with all derivatives; and the checker, which does not look at outputs that tie states, finds no fault.
#[test]
fn states_are_drawn_where_these_outputs_are_zero() {
    let folder = folder();
    let text = "system \"s\"\nstate x\nparam k unknown\nknown u(t)\ndrift f\n  x' = k\noutput 0 = 2*u - x\n";
    let file = write(&folder, "tied.proof", text);
    let verdicts = folder.path().join("v.json").display().to_string();
    let arguments = ["rank", file.to_str().unwrap(), "--samples", "20", "--json", "--verdicts", &verdicts];
    let found = json(&palmistry(&arguments));
    assert_eq!(found["rank_histogram"], serde_json::json!({ "2": 20 }));
    assert_eq!(found["conditions"], serde_json::json!(["0 = 2*u - x"]));
    assert_eq!(found["higher_derivatives_cannot_raise_it"], true);
    let state = &found["worst_conditioned"]["state"];
    let value = |name: &str| state[name]["value"].as_f64().unwrap_or_else(|| panic!("{name}: {state}"));
    assert_eq!((2.0 * value("u"), 2.0 * value("u'")), (value("x"), value("k")));
    assert_eq!((value("u''"), value("u'''")), (0.0, 0.0));
    let checked = palmistry(&["recheck", &verdicts]);
    assert_eq!(checked.status.code(), Some(0), "{}", String::from_utf8_lossy(&checked.stdout));
}

/// A set of several parts is not taken for one of them, and an input cannot be anything where an output is zero.
#[test]
fn ties_that_are_not_understood_decide_nothing() {
    let several = "system \"s\" state x, y known u(t) drift f x' = 0 y' = 0 output 0 = u*(u - x) claim 1 expect undecided: rank = 1";
    assert!(prove(&system(several)).iter().all(|outcome| outcome.ok));
    let curved = "system \"s\" state x known u(t) drift f x' = 0 output 0 = u^2 + x^2 - 1 claim 1 expect undecided: rank = 1";
    assert!(prove(&system(curved)).iter().all(|outcome| outcome.ok));
    for text in [
        "system \"s\" state x known u(t) drift f x' = 0 input g x' = 1 output 0 = u - x",
        "system \"s\" state x known u(t) drift f x' = 0 output 0 = u - x, x",
        "system \"s\" state x known u(t) drift f x' = 0 output 1 = u - x",
    ] {
        assert!(System::parse("s", text, Path::new("")).is_err(), "{text}");
    }
}

/// With `x' = u` the second derivative of `x` is `u'`, whether or not the file writes it: what is said of it does not hang on other
/// claims. Through definitions, fields of other roles, brackets and whole rows; a signal that drives nothing is not derived.
#[test]
fn a_lie_derivative_goes_on_to_the_derivatives_of_known_signals() {
    let head = "system \"s\" state x, v known u(t), w(t) drift f x' = v v' = u*x output x field g x' = u v' = 0 \
                let first = L(f, x) let second = L(f, first)";
    let verdict = |claim: &str| {
        let outcomes = prove(&system(&format!("{head} claim 1: {claim}")));
        outcomes[0].word().to_owned()
    };
    // no derivative is written
    assert_eq!(verdict("L(f, f, x) = u*x"), "proved");
    assert_eq!(verdict("L(f, f, f, x) = u*v"), "refuted");
    assert_eq!(verdict("L(f, second) = u*v"), "refuted");
    assert_eq!(verdict("L(f, f, second) = u^2*x"), "refuted");
    assert_eq!(verdict("L(f, g, x) = 0"), "refuted");
    assert_eq!(verdict("L(bracket(f, g), x) = -u*x"), "refuted");
    assert_eq!(verdict("L(f, [2*x; v]) = [2*v; u*x]"), "proved");
    // and where it is
    assert_eq!(verdict("L(f, f, f, x) = u*v + u'*x"), "proved");
    assert_eq!(verdict("L(f, f, second) = u^2*x + 2*u'*v + u''*x"), "proved");
    assert_eq!(verdict("L(f, g, x) = u'"), "proved");
    let found = system(&format!("{head} claim 1: L(f, f, second) = 0"));
    let known = found.known_names();
    assert_eq!(known, ["u", "u'", "u''", "w"]);
    // assumptions and what states keep away from count as well
    for entry in ["assume L(f, f, f, x) > 0", "sample avoid L(f, f, f, x)"] {
        assert_eq!(system(&format!("{head} {entry}")).known_names(), ["u", "u'", "w"], "{entry}");
    }
    // what is asked from outside does not take the last derivative for a constant
    let eval = |expression: &str| {
        let mut bare = system("system \"s\" state x known u(t) drift f x' = u output x");
        bare.evaluate_text_guarded(expression).map(|_| ()).map_err(|error| error.to_string())
    };
    assert!(eval("L(f, x)").is_ok());
    let refused = eval("L(f, f, x)").unwrap_err();
    assert!(refused.contains("the derivative of 'u' is u', which the file does not come to"), "{refused}");
    // so far and no further
    let deep = format!("{head} claim 1: L({}x) = 0", "f, ".repeat(40));
    let refused = System::parse("test.proof", &deep, Path::new("")).unwrap_err().to_string();
    assert!(refused.contains("or comes to it by Lie derivatives; the highest is 30"), "{refused}");
}

/// A tied signal says what a quotient says that is measured: drawn systems in both forms have the same rank and the same verdict of each unknown, whatever derivatives of
/// the signal the file mentions besides, at almost all states and at those at which a state is nought.
#[test]
fn a_tie_is_a_quotient_that_is_measured() {
    use palmistry::{RankQuestion, answer_rank};
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(11);
    let names = ["x0", "x1", "x2", "k0", "k1"];
    let (mut compared, mut on_sets, mut unsaid) = (0, 0, 0);
    for _ in 0..120 {
        let mut polynomial = |terms: usize, states_alone: bool| -> String {
            let mut term = || {
                let mut text = rng.random_range(1..=3).to_string();
                for _ in 0..rng.random_range(0..=2) {
                    let last = if states_alone { 3 } else { names.len() };
                    text += &format!("*{}", names[rng.random_range(0..last)]);
                }
                text
            };
            (0..terms).map(|_| term()).collect::<Vec<_>>().join(" + ")
        };
        let rates: String =
            (0..3).map(|place| format!(" x{place}' = {}", polynomial(1 + place % 2, false))).collect();
        let (above, below) = (polynomial(2, true), polynomial(1, true));
        let more =
            ["", " let q = u'*x0", " let q = u''", " let q = L(f, L(f, u*x1))"][rng.random_range(0..4)];
        let head = "system \"s\" state x0, x1, x2 param k0, k1 unknown";
        let tied = format!("{head} known u(t) drift f{rates} output 0 = u*({below}) - ({above}){more}");
        let measured = format!("{head} drift f{rates} output ({above})/({below})");
        let found = |text: &str, conditions: &[&str]| {
            let mut system = system(text);
            let conditions = conditions.iter().map(|&one| one.to_owned()).collect();
            let question = RankQuestion { samples: 4, conditions, ..RankQuestion::default() };
            let answer = answer_rank(&mut system, &question).map_err(|why| why.to_string())?;
            let [branch] = answer.branches.as_slice() else { return Err("branches".to_owned()) };
            let verdicts: Vec<String> =
                branch.generic.unknowns.iter().map(|(_, verdict)| format!("{verdict:?}")).collect();
            let sampled: Vec<usize> = branch.full.rank_histogram.keys().copied().collect();
            Ok::<_, String>((branch.generic.rank(), verdicts, sampled))
        };
        for conditions in [&[][..], &["x0 = 0"][..]] {
            let Ok((rank, verdicts, ranks)) = found(&measured, conditions) else { continue };
            let Ok((own, says, sampled)) = found(&tied, conditions) else {
                unsaid += 1;
                continue;
            };
            let Some(rank) = rank else { continue };
            let text = format!("{tied}\n{measured}\n{conditions:?}");
            if own.is_some() {
                assert_eq!((own, &says), (Some(rank), &verdicts), "{text}");
                compared += usize::from(conditions.is_empty());
                on_sets += usize::from(!conditions.is_empty());
            }
            for ranks in [ranks, sampled] {
                assert!(ranks.iter().all(|at_a_state| *at_a_state <= rank), "{text}: {ranks:?} of {rank}");
            }
        }
    }
    println!("{compared} and {on_sets} on sets compared, of {unsaid} nothing is said");
    assert!(compared >= 80 && on_sets >= 20, "{compared} {on_sets} {unsaid}");
}

/// Where the slope of the tie vanishes the last derivatives of the signal look free and are not: nothing is said there that is false.
#[test]
fn where_a_tie_gives_lower_derivatives_nothing_false_is_said() {
    // scaling all of x, y, a, b keeps u, so that at x = y = 0 the rank is 2 of 4, and b is not observable where x = 0
    let file = system(
        "system \"s\" state x, y param a, b unknown known u(t) drift f x' = b y' = a output 0 = u*x - y
         claim 1: rank = 3
         claim 2 expect undecided: rank = 4 where x = 0
         claim 3 expect undecided: rank = 2 where x = 0, y = 0
         claim 4 expect undecided: observable(b) where x = 0
         claim 5: unobservable(b)",
    );
    for outcome in prove(&file) {
        assert!(outcome.ok, "{} {:?}", outcome.id, outcome.verdict);
    }
    // a scale is in no way given by a direction
    let turning =
        "system \"s\" state x, y param w unknown known u(t) drift f x' = -w*y y' = w*x output 0 = u*x - y
         claim 1: solutions(x) = infinity
         claim 2 expect refuted: solutions(y) < infinity
         claim 3 expect undecided: solutions(w) = 1";
    for outcome in prove(&system(turning)) {
        assert!(outcome.ok, "{} {:?}", outcome.id, outcome.verdict);
    }
}

/// What is asked of the full codistribution without the tie is refused, and not answered off it.
#[test]
fn what_knows_no_ties_refuses_them() {
    let folder = folder();
    let text = "system \"tied\"\nstate x, y\nknown u(t)\ndrift f  x' = y  y' = 0\noutput 0 = u*x - y\n\
                sample\n  x in [1, 2]\n  y in [1, 2]\n  u in [1/2, 2]\n  u' in [-4, -1/4]\nclaim a: rank = 1\n";
    let file = write(&folder, "tied.proof", text);
    let file = file.to_str().unwrap();
    for arguments in [
        &["certify", file, "--boxes", "10"][..],
        &["trade", file, "--samples", "10"],
        &["stress", file],
        &["rank", file, "--accessible"],
    ] {
        let found = palmistry(arguments);
        assert_eq!(found.status.code(), Some(2), "{arguments:?} {}", String::from_utf8_lossy(&found.stdout));
        let said = String::from_utf8_lossy(&found.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains("an output is zero"), "{arguments:?} {said}");
    }
    let reduced = json(&palmistry(&["reduce", file, "--json"]));
    assert!(reduced["rank"].is_null(), "{reduced}");
}

/// `u x - y = 0` also holds at `x = y = 0`, whatever `u` is there: where motions stay there, a proof names that part; with the rows `(u, -1)` and `(u', 0)` the
/// rank there is two, and not one. Where the motion leaves it at once, or it is assumed away, there is none.
#[test]
fn a_part_on_which_a_signal_is_free_is_named() {
    let named = |text: &str| -> Vec<String> {
        let file = format!("system \"s\" state x, y param k unknown known u(t) {text}");
        let outcomes = palmistry::prove(&file.parse::<System>().unwrap());
        assert!(outcomes.iter().all(|outcome| outcome.ok), "{text}: {outcomes:?}");
        outcomes.into_iter().flat_map(|outcome| outcome.not_looked_at).collect()
    };
    let there = "claim 1: rank <= 2 claim 2: unobservable(x) claim 3 expect refuted: rank = 3";
    assert_eq!(
        named(&format!("drift f others' = 0 output 0 = u*x - y output k {there}")),
        ["x = 0", "x = 0"]
    );
    assert_eq!(
        named(&format!("assume x > 0 drift f others' = 0 output 0 = u*x - y output k {there}")),
        [""; 0]
    );
    assert_eq!(
        named(&format!("assume x^2 + y^2 > 0 drift f others' = 0 output 0 = u*x - y output k {there}")),
        [""; 0]
    );
    assert_eq!(named("drift f others' = 0 output 0 = (1 + x^2)*u - y output k claim 1: rank = 2"), [""; 0]);
    // `x` leaves zero at once, and `k` where both are
    assert_eq!(named("drift f x' = 1 y' = k output 0 = u*x - y claim 1: rank = 3"), [""; 0]);
    assert_eq!(named("drift f x' = k y' = x + 1 output 0 = u*x - y claim 1: rank = 3"), [""; 0]);
    assert_eq!(named("drift f x' = k*x y' = x output 0 = u*x - y claim 1: unobservable(x)"), ["x = 0"]);
    // without a signal: `z (b x + a) = 0` is the second equation, and where `z = 0` the output sees z and not x
    let two = "state z, a, b drift f x' = a y' = 0 z' = b*z a' = -a*b b' = 0 output 0 = z*x - y output a claim 1: observable(x)";
    assert_eq!(named(two), ["z = 0"]);
    // one equation at rest is one part, whatever it is solved for
    assert_eq!(named("state z drift f others' = 0 output 0 = z*x - y output k claim 1: rank = 2"), [""; 0]);
    // the other rows, at a state of that part
    let rows = "system \"s\" state x, y, u, w claim 1: rank([u, -1; w, 0]) = 2 where x = 0, y = 0, w != 0"
        .parse::<System>()
        .unwrap();
    assert!(palmistry::prove(&rows).iter().all(|outcome| outcome.ok));
}
