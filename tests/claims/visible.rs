//! `observable(...)` and `unobservable(...)`: what is seen of functions, by answers by hand, with the contrary refuted; what a verdict
//! rests on, found again by the checker; the same by another way, the rank with the function among the outputs; and what is no
//! such statement.

use palmistry::checker::{Checking, Effort, Finding, ProofSources, VerdictFile};
use palmistry::claim::{Kept, decide_all_keeping};
use palmistry::{System, decide_all};
use std::path::Path;

fn read(text: &str) -> Result<System, String> {
    System::parse("model.proof", text, Path::new("")).map_err(|error| format!("{error:?}"))
}

/// The verdicts on some claims about a model.
fn words(model: &str, claims: &[String]) -> Vec<&'static str> {
    let claims: Vec<String> =
        claims.iter().enumerate().map(|(place, claim)| format!("claim c{place}: {claim}\n")).collect();
    let text = format!("system \"model\"\n{model}\n{}", claims.concat());
    let system = read(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    decide_all(&system, 1, &false.into(), &|_| ()).iter().map(|outcome| outcome.word()).collect()
}

/// Models with what is seen of them and what is not, by hand: the outputs' derivatives are written down and solved.
pub(crate) const MODELS: [(&str, &[&str], &[&str]); 15] = [
    // c x, its rate -k c x: k and the product
    (
        "state x param c, k unknown drift f x' = -k*x output c*x",
        &["k", "c*x", "k^2 + 3*k", "log(c) + log(x) where c > 0, x > 0", "L(f, x)/x"],
        &["c", "x", "x/c", "k*x", "exp(c)"],
    ),
    // the beginning is known
    (
        "state x, z param a, k, c unknown drift f x' = -k*x*a z' = x output c*x initial x known",
        &["k*a", "c", "x", "c*x", "sin(x)"],
        &["k", "a", "z", "k/a", "k*x"],
    ),
    // a parameter that is known is no unknown, and a signal neither
    (
        "state x param k, p unknown param g known u(t) drift f x' = u*k - g*p*x output x",
        &["k", "p", "g*p", "u*p"],
        &[],
    ),
    // what an input moves is told by it alone
    ("state x, y drift f x' = 0 y' = 0 input u x' = y y' = 0 output x", &["x", "y", "x*y"], &[]),
    // the circle's radius, and not where on it
    (
        "state x, y param w unknown drift f x' = -w*y y' = w*x output x^2 + y^2",
        &["x^2 + y^2", "sqrt(x^2 + y^2)"],
        &["x", "y", "w", "x*y"],
    ),
    // an angle that is seen by its sine
    ("state a, w angle a drift f a' = w w' = -sin(a) output w", &["a", "sin(a)", "w", "cos(2*a)"], &[]),
    // a parameter in an exponent: k exp(-e) stands together
    (
        "state x param k, e unknown drift f x' = -k*exp(-e)*x output x",
        &["k*exp(-e)", "log(k) - e where k > 0"],
        &["k", "e", "k*e"],
    ),
    // a sum of exponents
    ("state x param a, b unknown drift f x' = -exp(a)*exp(b)*x output x", &["a + b"], &["a", "b", "a - b"]),
    // steps: w sees z/y two steps later
    (
        "state x, y, z, w drift f x+ = 0 y+ = 1 z+ = x w+ = z/y output x*y, x*z, w",
        &["x", "y", "z", "w", "x + y*z"],
        &[],
    ),
    // a map that forgets: the images are a line, and on it z is not told
    ("state x, y, z drift f x+ = y y+ = y z+ = 2*z output x", &["x", "y", "x*y"], &["z", "x*z"]),
    // two experiments with one k, and scales of their own
    ("experiments 2 state x param k unknown drift f x' = -k*x output x", &["k", "x", "x@2", "x - x@2"], &[]),
    // what is measured is tied by an equation
    (
        "state x, y param w unknown known u(t) drift f x' = -w*y y' = w*x output 0 = u*x - y",
        &["w", "y/x"],
        &["x", "y", "x^2 + y^2"],
    ),
    // an unknown input of which nothing is assumed but that its first derivative is constant
    ("state x unknown w(t) order 1 drift f x' = w output x", &["x", "w", "w'"], &[]),
    ("state x, v unknown w(t) order 0 drift f x' = v v' = w - v output v", &["v", "w"], &["x", "x*v"]),
    // nothing moves
    ("state x, y drift f others' = 0 output x*y", &["x*y", "1/(x*y)"], &["x", "y", "x + y"]),
];

#[test]
fn what_is_seen_by_hand() {
    for (model, seen, unobservable) in MODELS {
        let mut claims = Vec::new();
        for (list, word, other) in
            [(seen, "observable", "unobservable"), (unobservable, "unobservable", "observable")]
        {
            for function in list {
                let (function, given) = match function.split_once(" where ") {
                    Some((function, given)) => (function, format!(" where {given}")),
                    None => (*function, String::new()),
                };
                claims.push((format!("{word}({function}){given}"), "proved"));
                claims.push((format!("{other}({function}){given}"), "refuted"));
            }
        }
        let texts: Vec<String> = claims.iter().map(|(text, _)| text.clone()).collect();
        for ((text, expected), word) in claims.iter().zip(words(model, &texts)) {
            assert_eq!(word, *expected, "{text} of {model}");
        }
    }
}

/// All of a list have to be seen, none of it may be.
#[test]
fn of_a_list_each_counts() {
    let model = "state x param c, k unknown drift f x' = -k*x output c*x";
    let claims = ["observable(k, c*x)", "observable(k, c)", "unobservable(c, x)", "unobservable(c, k)"];
    let claims: Vec<String> = claims.map(str::to_owned).into();
    assert_eq!(words(model, &claims), ["proved", "refuted", "proved", "refuted"]);
    let claims = ["identifiable(k)", "unidentifiable(c)", "identifiable(c)", "identifiable(k*[1; k])"];
    let claims: Vec<String> = claims.map(str::to_owned).into();
    assert_eq!(words(model, &claims), ["proved", "proved", "refuted", "proved"]);
}

/// On parts by signs, and on sets that the fields leave or not.
#[test]
fn conditions_and_parts() {
    let cold = "state x, k, m drift f x' = -k*max(x, 0) k' = 0 m' = 0 output x";
    let claims = [
        ("unobservable(k) where x < 0", "proved"),
        ("observable(k) where x > 0", "proved"),
        ("observable(k)", "refuted"),
        ("unobservable(k)", "refuted"),
        ("unobservable(m, m*abs(x))", "proved"),
        ("observable(abs(x))", "proved"),
        // there the rate has no derivative
        ("unobservable(k) where x = 0", "undecided"),
    ];
    let texts: Vec<String> = claims.iter().map(|(text, _)| (*text).to_owned()).collect();
    assert_eq!(words(cold, &texts), claims.map(|(_, word)| word));
    // x' = 1, y = x^5 z: where x = 0 the fifth derivative sees z, and none before it
    let leaves = "state x, z drift f x' = 1 z' = 0 output x^5*z";
    let claims = ["observable(z) where x = 0".to_owned(), "observable(x, z)".to_owned()];
    assert_eq!(words(leaves, &claims), ["proved", "proved"]);
    // of two amounts that begin at nought and grow by constants, the product is seen: all of the orbit is special, so that no order is known to be the last
    let special = "state x, z param a, b unknown initial x = 0, z = 0 drift f x' = a z' = b output x*z";
    assert_eq!(
        words(special, &["observable(a)".to_owned(), "rank([d(a*b)]) = 1".to_owned()]),
        ["undecided", "proved"]
    );
}

/// A motor that stands still with constant currents (proofs/koteich2015) does not tell its angle.
#[test]
fn a_motor_at_standstill() {
    let model = "state ia, ib, w, a param L, R, p, ua, ub angle a drift f \
                 ia' = (ua - R*ia + w*p*sin(a))/L ib' = (ub - R*ib - w*p*cos(a))/L w' = 0 a' = w output ia, ib";
    let claims = ["observable(a, w)", "observable(a) where w = 0", "unobservable(a, cos(a)) where w = 0"];
    assert_eq!(words(model, &claims.map(str::to_owned)), ["proved", "refuted", "proved"]);
}

/// The same by another way: of what has always moved and is unknown, a function is seen where it adds nothing to the rank as an output
/// of its own.
#[test]
fn an_output_that_is_seen_adds_no_rank() {
    for (model, seen, unobservable) in MODELS {
        if model.contains("initial") || model.contains("+ =") || model.contains("output 0") {
            continue; // there derivatives of the function tell more than itself
        }
        let functions = seen.iter().map(|one| (one, true)).chain(unobservable.iter().map(|one| (one, false)));
        for (function, is_observable) in functions.filter(|(function, _)| !function.contains("where")) {
            let rank = |model: &str| {
                let claims: Vec<String> = (0..8).map(|n| format!("rank = {n}")).collect();
                words(model, &claims).iter().position(|word| *word == "proved")
            };
            let with_it = model.replacen(" output ", &format!(" output {function}, "), 1);
            let (rank, with_it) = (rank(model), rank(&with_it));
            assert!(rank.is_some(), "{model}");
            assert_eq!(rank == with_it, is_observable, "{function} of {model}: {rank:?}, {with_it:?}");
        }
    }
}

/// What verdicts rest on is confirmed, or what the checker tries agrees; and a forged one is not.
#[test]
fn the_checker_finds_it_again() {
    let text = "system \"model\"\nstate x\nparam c, k unknown\ndrift f x' = -k*x\noutput c*x\n\
                claim a: observable(k, c*x)\nclaim b: unobservable(c, x)\nclaim c expect refuted: observable(c)\n\
                claim d expect refuted: unobservable(k)\n";
    let system = read(text).unwrap();
    let outcomes = decide_all_keeping(Kept::Evidence, &system, 1, &false.into(), &|_| ());
    assert!(outcomes.iter().all(|outcome| outcome.ok));
    let records: Vec<_> = outcomes.into_iter().flat_map(|outcome| outcome.evidence).collect();
    let count = |id: &str| records.iter().filter(|record| record.id == id).count();
    // the words, and the words with the functions; for each unseen one a matrix, and the field; two ranks at a state
    assert_eq!(["a", "b", "c", "d"].map(count), [2, 4, 2, 2]);
    let file = VerdictFile::new(1, records);
    let (sources, effort, never) = (ProofSources::given([system]), Effort::new(1 << 33), false.into());
    let with = Checking { sources: &sources, seed: 7, effort: &effort, interrupt: &never };
    let checked = file.check(with, &|| ());
    for verdict in &checked {
        let finding = &verdict.finding;
        // what is proved is shown by the fields that keep the outputs; ranks at a state say nothing of other words
        let is_as_it_was = match verdict.record.id.as_str() {
            "a" | "b" => matches!(finding, Finding::Shown(_)),
            _ => matches!(finding, Finding::Consistent { .. }),
        };
        assert!(is_as_it_was, "{}: {finding:?}", verdict.record.id);
    }
    // k is put in the place of c: then it is seen, and the ranks at the state are others
    let forged = file.text().unwrap();
    let at = forged.find("\"rank\":3").expect("a rank with the function's differential");
    let forged = format!("{}\"rank\":2{}", &forged[..at], &forged[at + 8..]);
    let forged = VerdictFile::read(&forged).unwrap();
    let checked = forged.check(with, &|| ());
    assert!(checked.iter().any(|verdict| matches!(verdict.finding, Finding::NotConfirmed(_))));
}

/// A field that keeps the outputs and moves what is said to be unseen is the proof, where one is found.
#[test]
fn a_field_is_the_better_proof() {
    let text = "system \"model\"\nstate x\nparam c, k unknown\ndrift f x' = -k*x\noutput c*x\nclaim b: unobservable(c, x)\n";
    let outcomes = decide_all(&read(text).unwrap(), 1, &false.into(), &|_| ());
    let palmistry::Verdict::Proved { engine, log2_error } = &outcomes[0].verdict else {
        panic!("{:?}", outcomes[0].verdict)
    };
    assert!(*log2_error < -100.0);
    let fields = ["x' = -x, c' = c", "x' = x, c' = -c"];
    assert!(fields.iter().any(|field| engine.ends_with(&format!("along {field}"))), "{engine}");
}

/// What is no such statement is refused, at its place.
#[test]
fn mistakes_are_told() {
    for (claim, message) in [
        ("claim a: observable(x) = 1", "compared with nothing"),
        ("claim a: 1 = observable(x)", "a number cannot equal a statement about observability"),
        ("claim a: rank = observable(x)", "a rank cannot equal a statement about observability"),
        ("claim a: observable(x) + 1", "by itself"),
        ("claim a: observable(rank)", "is said of unknowns and functions, not of a rank"),
        ("claim a: observable(x) everywhere", "are said of a rank"),
        ("claim a: observable(x) on sample", "'on sample' is said of numbers"),
        ("claim a: identifiable(x*k)", "'identifiable' is said of constants, and 'x' moves"),
        ("let v = observable(x)", "has no name"),
        ("claim a: observable(nobody)", "unknown name 'nobody'"),
        // true or false by definition, and never what was meant
        ("claim a: observable(7)", "7 is a number"),
        ("claim a: unobservable(x at {x = 1})", "1 is a number"),
        ("param c\nclaim a: identifiable(c)", "made of known constants"),
        ("param c\nclaim a: unidentifiable(k, c^2)", "made of known constants"),
        ("param c\nclaim a: solutions(c) = 1", "made of known constants"),
        ("claim a: solutions(k) = 1 within 2", "are exact"),
        ("claim a: rank = 2 within 1", "are exact"),
        ("claim a: rank = 5 at {x = 0}", "'at' belongs to the number before it"),
        ("claim a: solutions(k) = 5 at {x = 0}", "'at' belongs to the number before it"),
        ("claim a: x = 5 where x = 5 at {k = 0}", "'at' belongs to the number before it"),
        ("let n = 5\nclaim a: rank = n at {x = 0}", "'at' belongs to the number"),
        ("claim a: rank >= (1) at {x = 0}", "'at' belongs to the number"),
        ("claim a: (1) at {x = 0} <= rank", "'at' belongs to the number"),
    ] {
        let text = format!("system \"T\"\nstate x\nparam k unknown\ndrift f x' = -k*x\noutput x\n{claim}\n");
        let error = read(&text).expect_err(claim);
        assert!(error.contains(message), "{claim}: {error}");
    }
    // where there is nothing to see by, or nothing that exists, nothing is said
    let without = "state x drift f x' = x";
    assert_eq!(words(without, &["unobservable(x)".to_owned()]), ["undecided"]);
    let model = "state x drift f x' = x output x";
    assert_eq!(words(model, &["observable(1/(x - x))".to_owned()]), ["undecided"]);
}
