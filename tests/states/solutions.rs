//! How many values give the same outputs: by hand, by what was published (`values` and functions in
//! `tests/models/expected.toml`), and the words in which it is told.

use crate::common::{json, palmistry, words_of};
use palmistry::observability::{Observability, Solutions, SolutionsOf, SolutionsQuestion, solutions};
use palmistry::sweep::SolutionsWanted;
use palmistry::{System, answer_solutions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// As much work as a test may be.
const WORK: u64 = 4_000_000;
/// As much as one of the published models may be.
const WORK_OF_A_MODEL: u64 = 400_000_000;
/// Larger models are left to the table in the book.
const MOST_UNKNOWNS: usize = 40;

fn read(text: &str) -> System {
    format!("system \"s\" {text}").parse().unwrap()
}

/// What is known of the unknowns, then of some expressions.
fn ask(system: &System, expressions: &[String], work: u64) -> Vec<SolutionsOf> {
    // each expression has a name of its own, so that it is read as the file would
    let names: Vec<String> = (0..expressions.len()).map(|number| format!("asked_{number}")).collect();
    let lines = names.iter().zip(expressions).map(|(name, text)| format!("\nlet {name} = {text}"));
    let mut system: System = format!("{}{}", system.source, lines.collect::<String>()).parse().unwrap();
    let node = |name: &String| system.definition(name).unwrap().as_number().unwrap();
    let list = names.iter().zip(expressions).map(|(name, text)| (text.clone(), node(name))).collect();
    let interrupt = AtomicBool::new(false);
    let question =
        SolutionsQuestion { conditions: Default::default(), expressions: list, work, interrupt: &interrupt };
    solutions(&mut system, &question).unwrap().unknowns
}

fn number(of_it: &SolutionsOf) -> String {
    match &of_it.solutions {
        Solutions::Finite(count) => count.to_string(),
        Solutions::Infinite => "infinity".to_owned(),
        Solutions::Undecided(why) => format!("undecided: {why}"),
    }
}

/// Each unknown with its number, and an exclamation mark where that is proved.
fn table(text: &str) -> String {
    let answer =
        answer_solutions(&mut read(text), SolutionsWanted::Values, WORK, &AtomicBool::new(false)).unwrap();
    let word = |of_it: &SolutionsOf| {
        format!("{} {}{}", of_it.name, number(of_it), if of_it.is_proved() { "!" } else { "" })
    };
    answer.solutions.unknowns.iter().map(word).collect::<Vec<_>>().join(", ")
}

/// By hand: a square has two roots; a product leaves its factors open; the coefficients of a quadratic polynomial leave its roots open
/// up to their order; a third power has three roots over the complex numbers, of which one is real.
#[test]
fn answers_by_hand() {
    let rows = [
        ("state x param k unknown drift f x' = k^2*x output x", "x 1!, k 2!"),
        ("state x param k unknown drift f x' = k^3*x output x", "x 1!, k 3"),
        ("state x param k unknown drift f x' = k*x output x^2", "x 2!, k 1!"),
        ("state x param a, b unknown drift f x' = a*b*x output x", "x 1!, a infinity!, b infinity!"),
        ("state x param a, b unknown drift f x' = (a + b)*x + a*b output x", "x 1!, a 2!, b 2!"),
        // the two peripheral compartments may be exchanged
        (
            "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z \
             input u x' = 1 others' = 0 output x",
            "x 1!, y 2!, z 2!, a 2!, b 2!, c 2!, d 2!",
        ),
        // a known beginning tells the sign
        ("state x param k unknown initial x = 1 drift f x' = k*x output x^2", "k 1!"),
        // what numbers tell at the beginning: the third derivative is 2*a; a square has two roots there, too; where x stays zero nothing is told of k
        ("state x param a unknown initial x = 0 drift f x' = 1 + a*x^2 output x", "a 1!"),
        ("state x param a unknown initial x = 7/3 drift f x' = 1 + a^2*x^2 output x", "a 2!"),
        (
            "state x, y param k, a unknown initial x = 0 drift f x' = k*x y' = a*x + a output y",
            "y 1!, k infinity!, a 1!",
        ),
        // what is known tells the scale
        ("state x param a unknown param b drift f x' = a*b*x output x", "x 1!, a 1!"),
        // H. Hong et al. (2020), example 2.14: one experiment leaves two values, two leave one
        ("state x param a unknown drift f x' = 0 output x, a*x + a^2", "x 1!, a 2"),
        ("state x param a unknown drift f x' = 0 output x, a*x + a^2 experiments 2", "x 1!, a 1!, x@2 1!"),
        // a denominator
        ("state x param v, k unknown drift f x' = -v*x/(k + x) output x", "x 1!, v 1!, k 1!"),
    ];
    for (text, expected) in rows {
        assert_eq!(table(text), expected, "{text}");
    }
}

/// Two values of a drawn function that a symmetry tells apart generically may be one where a state begins at a number, as those of `x*k` where `x = 0`.
/// The points with the same outputs are known by hand; the witness puts them into the function, in whole numbers.
#[test]
fn functions_of_states_that_begin_at_numbers() {
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let systems = ["x' = k^2 + c*x c' = 0", "x' = k^2 + x c' = k^2*x", "x' = k^2 c' = x"];
    let mut met = BTreeMap::new();
    for number in 0..60 {
        let rates = systems[number % systems.len()];
        let first = rng.random_range(-1..=1i128);
        // a polynomial in `x - first` or `x`, `c` and `k`
        let terms: Vec<[i128; 4]> = (0..rng.random_range(1..=3))
            .map(|_| {
                [
                    rng.random_range(1..=3),
                    rng.random_range(0..=2),
                    rng.random_range(0..=1),
                    rng.random_range(0..=2),
                ]
            })
            .collect();
        let shift = if rng.random_range(0..2) == 0 { first } else { 0 };
        let text: Vec<String> =
            terms.iter().map(|[a, n, m, l]| format!("{a}*(x - ({shift}))^{n}*c^{m}*k^{l}")).collect();
        let value = |c: i128, k: i128| -> i128 {
            terms
                .iter()
                .map(|[a, n, m, l]| a * (first - shift).pow(*n as u32) * c.pow(*m as u32) * k.pow(*l as u32))
                .sum()
        };
        let differs = [(2, 3), (5, 7), (-3, 4)].iter().any(|(c, k)| value(*c, *k) != value(*c, -k));
        let count = if differs { 2 } else { 1 };
        // of a number nothing is asked
        if terms.iter().all(|[_, n, m, l]| n + m + l == 0) {
            continue;
        }
        let expression = text.join(" + ");
        let file = format!(
            "state x, c param k unknown initial x = {first} drift f {rates} output x, c \
             claim 1: solutions({expression}) = {count} claim 2 expect refuted: solutions({expression}) = {}",
            3 - count
        );
        for outcome in palmistry::prove(&read(&file)) {
            assert!(outcome.ok, "{file}\n{} {}: {:?}", outcome.id, outcome.statement, outcome.verdict);
        }
        *met.entry(count).or_insert(0) += 1;
    }
    assert!(met.values().all(|count| *count > 10) && met.len() == 2, "{met:?}");
    // a root of a number is no number that could be drawn: `(x^2 - 2)*k` is zero here, and no symmetry says more
    let root = "state x param k unknown initial x = sqrt(2) drift f x' = k^2 output x claim 1 expect undecided: solutions((x^2 - 2)*k) >= 2";
    assert!(palmistry::prove(&read(root)).iter().all(|outcome| outcome.ok));
}

/// Local identifiability leaves finitely many values where all is algebraic on the line and the circle, or made of exponentials, logarithms, roots
/// and arcs; the sine of a number has one value at infinitely many of them.
#[test]
fn sines_of_numbers_have_infinitely_many_arguments() {
    let finite = [
        ("angle k drift f x' = sin(k) output x", "k", true),
        ("angle k drift f x' = sin(2*k)*x output x", "k", true),
        ("drift f x' = exp(k^2)*x output x", "k", true),
        ("drift f x' = x*atan(k) output x", "k", true),
        ("param p drift f x' = k*sin(p*3) output x", "k", true),
        ("known u(t) drift f x' = k^3*sin(u) output x", "k", true),
        ("drift f x' = sin(k) output x", "k", false),
        ("drift f x' = 1 output cos(x + k), x", "k", false),
        ("drift f x' = 1 output sin(x), cos(x), k", "x", false),
        ("drift f x' = x*tan(k) output x", "k", false),
        ("drift f x' = exp(sin(k)) output x", "k", false),
        ("drift f x' = x + cos(k^2) output x", "k", false),
    ];
    for (text, name, is_finite) in finite {
        let word = if is_finite { "" } else { " expect undecided" };
        let wrong = if is_finite { " expect refuted" } else { " expect undecided" };
        let text = format!(
            "state x param k unknown {text} claim 1{word}: solutions({name}) < infinity claim 2{wrong}: solutions({name}) = infinity"
        );
        for outcome in palmistry::prove(&read(&text)) {
            assert!(outcome.ok, "{text}\n{} {}: {:?}", outcome.id, outcome.statement, outcome.verdict);
        }
    }
}

/// An angle is a point of the circle: the sine of an angle leaves two of them, both its functions one.
#[test]
fn an_angle_is_a_point_of_the_circle() {
    let text =
        |rate: &str, output: &str| format!("state a, w angle a drift f a' = w w' = {rate} output {output}");
    assert_eq!(table(&text("0", "sin(a)")), "a 2, w 2");
    assert_eq!(table(&text("0", "sin(a), cos(a)")), "a 1, w 1");
    // gravity tells which of the two it is
    assert_eq!(table(&text("-sin(a)", "sin(a)")), "a 1, w 1");
}

/// Functions become states of their own: what has one value with free initial conditions of these has one value. By hand: an exponential and a
/// logarithm are injective, a sine is not; of a square in an exponent the sign is open; a root is the positive one.
#[test]
fn functions_are_states_of_their_own() {
    let rows = [
        ("state x param k unknown drift f x' = -k*x output exp(x)", "x 1!, k 1!"),
        ("state x param k unknown drift f x' = -exp(k)*x output x", "x 1!, k 1!"),
        ("state x param k unknown drift f x' = -log(k)*x output x", "x 1!, k 1!"),
        ("state x param k unknown drift f x' = -atan(k)*x output x", "x 1!, k 1!"),
        // Arrhenius's law
        (
            "state c, t param e, k unknown drift f c' = -k*exp(-e/t)*c t' = k*exp(-e/t)*c - t output t",
            "c 1!, t 1!, e 1!, k 1!",
        ),
        // an unknown exponent
        ("state x param v, n unknown drift f x' = -v*x^n output x", "x 1!, v 1!, n 1!"),
        // a tank runs out
        ("state h param a unknown drift f h' = -a*sqrt(h) output h", "h 1!, a 1!"),
        (
            "state h, l param a unknown param g drift f h' = -a*sqrt(2*g*h) l' = a*sqrt(2*g*h) - sqrt(l) output l",
            "h 1!, l 1!, a 1!",
        ),
        // an angle that is measured itself
        ("state x param v, n, k unknown drift f x' = -v*x^n/(k^n + x^n) output x", "x 1!, v 1!, n 1!, k 1!"),
        ("state p, w angle p param k unknown drift f p' = w w' = -k*sin(p) output p", "p 1, w 1, k 1"),
    ];
    for (text, expected) in rows {
        assert_eq!(table(text), expected, "{text}");
    }
    for (text, name, reason) in [
        ("state x param k unknown drift f x' = -exp(k^2)*x output x", "k", "there are 2 values"),
        ("state x param k unknown drift f x' = -sin(k)*x output x", "k", "infinitely many values"),
        // exponentials that are one function of each other
        ("state x param k unknown drift f x' = -exp(k)*x + exp(2*k) output x", "k", "no algebraic equation"),
        ("state x param k unknown drift f x' = -exp(k)*x + exp(1) output x", "k", "no algebraic equation"),
        ("state x param k unknown drift f x' = -asin(k)*x output x", "k", "functions are met"),
        ("state x param k unknown drift f x' = -abs(k)*x output x", "k", "functions are met"),
        (
            "state x param k unknown initial x = 1 drift f x' = -exp(k)*x output x",
            "k",
            "no rational function",
        ),
        // an angle outside of its functions stays there
        ("state p angle p param k unknown drift f p' = k output 2*p", "k", "stands outside sin"),
        (
            "state p, x angle p param k unknown drift f p' = k x' = x*p output x, cos(p)",
            "k",
            "stands outside sin",
        ),
        // the argument is known at the beginning alone: a and -a have the same outputs
        (
            "state x, y param a unknown initial x known drift f x' = a y' = exp(x) output a^2",
            "a",
            "no rational function",
        ),
    ] {
        let found = table(text);
        assert!(found.contains(&format!("{name} undecided")) && found.contains(reason), "{text}: {found}");
    }
}

/// A function of an initial condition that is known is asked for at the beginning, and has one value there, whatever becomes of the state.
#[test]
fn what_is_known_at_first_has_one_value_there() {
    let system = read("state x, y param a unknown initial x known drift f x' = a y' = 0 output y");
    let found = ask(&system, &["x".to_owned(), "x + y".to_owned(), "x*a".to_owned()], WORK);
    let numbers: Vec<String> = found[2..].iter().map(number).collect();
    assert_eq!(numbers, ["1", "1", "infinity"], "{found:?}");
}

#[test]
fn what_is_no_rational_function_is_named() {
    let system = read("state x param k unknown drift f x' = -k*x output sqrt(x^2 + 1)");
    let found = ask(&system, &[], WORK);
    assert!(found.iter().all(|of_it| of_it.local == Observability::Yes), "{found:?}");
    assert!(number(&found[0]).contains("is no rational function"), "{found:?}");
    let steps = read("state x param k unknown drift f x+ = k*x output x");
    assert!(number(&ask(&steps, &[], WORK)[0]).contains("steps"));
}

/// A limit is named, and what a symmetry shows stands without a basis.
#[test]
fn what_takes_too_long_is_undecided() {
    let text = "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z \
                input u x' = 1 others' = 0 output x";
    let found = ask(&read(text), &[], 10);
    let of_y = found.iter().find(|of_it| of_it.name == "y").unwrap();
    assert!(number(of_y).contains("takes"), "{of_y:?}");
    assert_eq!(of_y.at_least.as_ref().map(|(least, _)| *least), Some(2));
}

/// Less work may leave a number open or unproved, it never changes one: also where it ends between the points that make an answer and those
/// that make a proof.
#[test]
fn work_changes_no_number() {
    let text = "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z \
                output x";
    let words = |work: u64| -> Vec<(String, bool)> {
        ask(&read(text), &[], work).iter().map(|of_it| (number(of_it), of_it.is_proved())).collect()
    };
    let all = words(100_000_000);
    assert!(all.iter().all(|(_, is_proved)| *is_proved), "{all:?}");
    let mut ends = std::collections::BTreeSet::new();
    for step in 20..60 {
        let found = words((f64::from(step) / 2.5).exp2() as u64);
        for ((number, is_proved), (of_all, _)) in found.iter().zip(&all) {
            let is_open = number.starts_with("undecided");
            assert!(is_open || number == of_all, "{number} {of_all}");
            ends.insert((is_open, *is_proved));
        }
    }
    // each of the three ends was met: open, computed, proved
    assert_eq!(ends.len(), 3, "{ends:?}");
}

/// What is proved is said to be, the rest with its number in the remark.
#[test]
fn claims_about_numbers_of_values() {
    let system = read(
        "state x, z param k, a, b, c unknown drift f x' = k^2*x + a*b*z z' = -c^3*z output x, z \
         claim 1: solutions(x) = 1 claim 2: 1 = solutions(a*b) claim 3: solutions(k) = 2 \
         claim 4: solutions(k) >= 2 claim 5: solutions(a) = infinity claim 6: solutions(a) > 100 \
         claim 7: solutions(k) < infinity claim 8 expect refuted: solutions(k) = 1 \
         claim 9 expect refuted: solutions(a) <= 3 claim 10 expect refuted: solutions(x) = infinity \
         claim 11 expect undecided: solutions(c) = 3 claim 12: solutions(c) <= 3 claim 13 expect undecided: solutions(c) = 1 \
         claim 14 expect undecided: solutions(k) = 2 where x = 1 claim 15: solutions(k*x) = 2 claim 16: solutions(c^3) = 1",
    );
    for outcome in palmistry::prove(&system) {
        assert!(outcome.ok, "{} {}: {:?}", outcome.id, outcome.statement, outcome.verdict);
        if outcome.id == "11" {
            assert!(
                format!("{:?}", outcome.verdict).contains("3 over the complex numbers"),
                "{:?}",
                outcome.verdict
            );
        }
    }
    for wrong in ["solutions(x, z) = 1", "x = infinity", "solutions(x) = solutions(z)", "solutions(y) = 1"] {
        let text = format!("system \"s\" state x, z drift f x' = z z' = 0 output x claim 1: {wrong}");
        assert!(text.parse::<System>().is_err(), "{wrong}");
    }
}

#[test]
fn the_command_tells_each_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.proof");
    std::fs::write(&file, "system \"s\" state x param k, a, b unknown drift f x' = k^2*x + a*b output x")
        .unwrap();
    let file = file.to_str().unwrap();
    let output = palmistry(&["rank", file, "--global"]);
    let text = String::from_utf8_lossy(&output.stdout);
    let words = words_of(&output);
    assert!(words.contains("2 solutions over the complex numbers: proved, by k -> -k"), "{text}");
    assert!(text.contains("globally observable   1 solution: proved"), "{text}");
    let found = json(&palmistry(&["rank", file, "--global", "--json"]));
    let values: Vec<_> =
        found["unknowns"].as_array().unwrap().iter().map(|of_it| of_it["values"].clone()).collect();
    assert_eq!(values, [1.into(), 2.into(), "infinity".into(), "infinity".into()] as [serde_json::Value; 4]);
    let larger = file_of("mammillary3");
    let little = palmistry(&["rank", larger.to_str().unwrap(), "--global", "--work", "10"]);
    assert_eq!(little.status.code(), Some(3), "{}", String::from_utf8_lossy(&little.stdout));
    // with every other question: its answer, and these numbers beside it
    let both = json(&palmistry(&["rank", file, "--global", "--at", "x=1", "--samples", "5", "--json"]));
    assert_eq!((&both["samples"], &both["global"]["unknowns"]), (&5.into(), &found["unknowns"]));
    for others in [&["--order", "2", "--samples", "5"] as &[&str], &["--where", "k > 0"], &["--digits", "5"]]
    {
        let alone = json(&palmistry(&[&["rank", file, "--json", "--no-times"], others].concat()));
        let both = palmistry(&[&["rank", file, "--json", "--no-times", "--functions"], others].concat());
        assert_eq!(both.status.code(), Some(0), "{others:?}");
        let mut both = json(&both);
        let values = both.as_object_mut().unwrap().remove("global").expect("numbers of solutions");
        assert_eq!(values["unknowns"], found["unknowns"]);
        assert_eq!(both, alone, "{others:?}");
    }
    let text = palmistry(&["rank", file, "--global", "--at", "x=1", "--samples", "5"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("globally observable") && text.contains("sampled states"), "{text}");
    // the numbers do not depend on states: parts have none, and a merge adds them
    let parts = folder.path().join("parts");
    let parts = parts.to_str().unwrap();
    let asked = ["rank", file, "--global", "--samples", "20", "--no-times"];
    for shard in ["1/2", "2/2"] {
        let done = palmistry(&[&asked[..], &["--shard", shard, "--part", parts]].concat());
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        assert!(String::from_utf8_lossy(&done.stderr).contains("--merge"), "{done:?}");
    }
    let merged = palmistry(&[&asked[..], &["--merge", parts]].concat());
    assert_eq!(merged.status.code(), Some(0), "{}", String::from_utf8_lossy(&merged.stderr));
    assert_eq!(String::from_utf8_lossy(&merged.stdout), String::from_utf8_lossy(&palmistry(&asked).stdout));
}

/// Numbers of solutions, and then what is identifiable, along what nothing changes, and where the rank drops. By hand: a*b is
/// identifiable, (a, b) moves along a d/da - b d/db, and the rank drops where x or k is zero, at any of the others.
#[test]
fn numbers_are_followed_by_directions_and_the_singular_set() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.proof");
    std::fs::write(&file, "system \"s\" state x param k, a, b unknown drift f x' = k^2*x + a*b output x")
        .unwrap();
    let file = file.to_str().unwrap();
    for how in ["--global", "--functions"] {
        let text = String::from_utf8(palmistry(&["rank", file, how]).stdout).unwrap();
        let place = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part} in {text}"));
        let places =
            ["2 solutions", "identifiable combinations of", "unobservable direction", "singular set"];
        assert!(places.map(place).is_sorted(), "{text}");
        let found = json(&palmistry(&["rank", file, how, "--json"]));
        assert_eq!(found["unobservable_directions"]["functions"][0]["text"], "a*b", "{found}");
        assert_eq!(found["unobservable_directions"]["fields_missing"], 0, "{found}");
        // without sampled states it is named, and looked for beside them
        assert!(found["singular_set"]["sets"].is_null(), "{found}");
        let found = json(&palmistry(&["rank", file, how, "--samples", "10", "--json"]));
        let sets: Vec<&str> = found["singular_set"]["sets"]
            .as_array()
            .unwrap()
            .iter()
            .map(|set| set["equations"][0].as_str().unwrap())
            .collect();
        assert!(sets.contains(&"k = 0"), "{found}");
    }
}

#[derive(serde::Deserialize)]
struct Expected {
    #[serde(default)]
    values: BTreeMap<String, usize>,
    #[serde(default)]
    functions: Vec<String>,
    #[serde(default)]
    functions_of_constants: Vec<String>,
    not_seen: Vec<String>,
    published: bool,
}

fn file_of(model: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places = [root.join("tests/models"), root.join("proofs/benchmarks")];
    places.iter().map(|place| place.join(model).with_extension("proof")).find(|file| file.exists()).unwrap()
}

/// Published numbers of values, and functions that were published as identifiable, which have one value each. What takes too
/// much work for a test is
/// undecided, and is counted.
#[test]
fn published_numbers_of_values() {
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/expected.toml");
    let table: BTreeMap<String, Expected> = toml::from_str(&std::fs::read_to_string(table).unwrap()).unwrap();
    let (mut decided, mut open) = (0, Vec::new());
    for (name, expected) in &table {
        let mut functions = expected.functions.clone();
        functions.extend(expected.functions_of_constants.iter().cloned());
        let mut wanted = expected.values.clone();
        if expected.published {
            wanted.extend(functions.into_iter().map(|function| (function, 1)));
        }
        if wanted.is_empty() {
            continue;
        }
        let system = System::read(&file_of(name)).unwrap();
        if system.unknowns().len() > MOST_UNKNOWNS {
            open.push(name.as_str());
            continue;
        }
        let expressions: Vec<String> =
            wanted.keys().filter(|text| system.find_symbol(text).is_none()).cloned().collect();
        let found = ask(&system, &expressions, WORK_OF_A_MODEL);
        let mut is_open = false;
        for of_it in &found {
            match (&of_it.solutions, wanted.get(&of_it.name)) {
                (Solutions::Undecided(_), _) => is_open = true,
                (_, None) => assert_eq!(
                    of_it.solutions == Solutions::Infinite,
                    expected.not_seen.contains(&of_it.name),
                    "{name}: {of_it:?}"
                ),
                (solutions, Some(count)) => {
                    assert_eq!(solutions, &Solutions::Finite(*count), "{name}: {of_it:?}")
                }
            }
        }
        if is_open { open.push(name.as_str()) } else { decided += 1 }
    }
    println!("{decided} models as published; too much work here: {open:?}");
    assert!(decided >= 31, "{decided}; {open:?}");
}
