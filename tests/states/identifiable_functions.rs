//! Generators of all identifiable functions: by hand, by what was published, and by points of fibres that Newton's method finds in doubles from symbolic Lie derivatives.

use crate::common::{folder, json, palmistry, write};
use nalgebra::{DMatrix, DVector};
use palmistry::System;
use palmistry::expression::{NodeId, Program, gradient};
use palmistry::number::{Floats, MOST_ITERATIONS};
use palmistry::observability::IdentifiableFunctions;
use palmistry::sweep::{SolutionsWanted, answer_solutions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

const WORK: u64 = 100_000_000;

fn functions_of(system: &System) -> IdentifiableFunctions {
    let answer =
        answer_solutions(&mut system.clone(), SolutionsWanted::Functions, WORK, &AtomicBool::new(false));
    answer.unwrap().functions.unwrap()
}

fn texts(found: &IdentifiableFunctions) -> Vec<&str> {
    found.functions.iter().map(|function| function.text.as_str()).collect()
}

/// By hand: what one value of an output leaves of unknowns.
#[test]
fn functions_by_hand() {
    let rows: [(&str, &[&str]); 12] = [
        ("state x param k unknown drift f x' = k^2*x output x", &["x", "k^2"]),
        ("state x param k unknown drift f x' = k^5*x output x", &["x", "k^5"]),
        ("state x param a, b unknown drift f x' = (a + b)*x + a*b output x", &["x", "a*b", "a + b"]),
        ("state x param a, b unknown drift f x' = a*x/b output x", &["x", "a/b"]),
        ("state x param k, s unknown drift f x' = -k*x output s*x", &["k", "x*s"]),
        // squares tell the product of the signs no more than each: three functions of two unknowns
        ("state x, y drift f x' = x*y y' = 0 output x^2", &["y", "x^2"]),
        ("state x, y drift f x' = y y' = x output x^2", &["x*y", "x^2"]),
        // two experiments with one constant: each has an amount of its own
        ("state x param k, s unknown drift f x' = -k*x output s*x experiments 2", &["k", "x*s", "s*x@2"]),
        // what is known stands in a function as a number does
        ("state x param k, s unknown param c known drift f x' = (c - k)*s*x output x", &["x", "s*(k - c)"]),
        // by a known angle: the square of a component in a frame that is turned
        (
            "state x, y param phi known angle phi drift f x' = y y' = -x output (cos(phi)*x + sin(phi)*y)^2",
            &["x*y", "x^2"],
        ),
        // nothing at all
        ("state x param k unknown drift f x' = -k*x output 2", &[]),
        // an angle by its sine
        ("state q param w unknown angle q drift f q' = w output sin(q)", &["sin(q)", "w*cos(q)"]),
    ];
    for (text, expected) in rows {
        let system: System = format!("system \"s\" {text}").parse().unwrap();
        let found = functions_of(&system);
        assert!(found.generate_all(), "{text} {found:?}");
        assert_eq!(texts(&found), expected, "{text}");
    }
}

/// What cannot be had is named: functions that are not rational, initial conditions that are given, too little work.
#[test]
fn what_is_not_found_is_named() {
    let ask = |text: &str, work: u64| {
        let mut system: System = format!("system \"s\" {text}").parse().unwrap();
        let answer = answer_solutions(&mut system, SolutionsWanted::Functions, work, &AtomicBool::new(false));
        let answer = answer.unwrap();
        assert!(!answer.is_final(), "{text}");
        answer.functions.unwrap().open.unwrap()
    };
    let why = ask("state x param k unknown drift f x' = -k*x output sqrt(x^2 + 1)", WORK);
    assert!(why.contains("is no rational function"), "{why}");
    let given = "state x param k unknown initial x = 1 drift f x' = k*x output x^2";
    assert!(ask(given, WORK).contains("initial conditions"), "{}", ask(given, WORK));
    let exchanged = "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z \
                     output x";
    assert!(ask(exchanged, 10).contains("undecided"), "{}", ask(exchanged, 10));
}

#[derive(serde::Deserialize)]
struct Expected {
    #[serde(default)]
    functions: Vec<String>,
    #[serde(default)]
    functions_of_constants: Vec<String>,
    published: bool,
}

fn file_of(model: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places = [root.join("tests/models"), root.join("proofs/benchmarks")];
    places.iter().map(|place| place.join(model).with_extension("proof")).find(|file| file.exists()).unwrap()
}

/// Functions of the unknowns and their gradients, in doubles.
struct InDoubles {
    program: Program,
    unknowns: Vec<palmistry::expression::Symbol>,
    count: usize,
}

impl InDoubles {
    fn new(system: &mut System, nodes: &[NodeId]) -> InDoubles {
        let unknowns = system.unknowns();
        let mut entries = nodes.to_vec();
        for node in nodes {
            entries.extend(gradient(&mut system.graph, *node, &unknowns));
        }
        InDoubles { program: Program::plain(&system.graph, &entries), unknowns, count: nodes.len() }
    }

    /// Values and the matrix of gradients; what is no unknown is one.
    fn at(&self, point: &DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let place: HashMap<_, usize> = self.unknowns.iter().copied().zip(0..).collect();
        let value = |symbol| place.get(&symbol).map_or(1.0, |place| point[*place]);
        let inputs: Vec<f64> =
            self.program.inputs().iter().map(|input| value(input.symbol().unwrap())).collect();
        let mut registers = Vec::new();
        let values = self.program.load(Floats).ok()?.run(&inputs, &mut registers).ok()?;
        let (first, rest) = values.split_at(self.count);
        let all = first.iter().chain(rest);
        if all.clone().any(|value| !value.is_finite()) {
            return None;
        }
        Some((DVector::from_row_slice(first), DMatrix::from_row_slice(self.count, self.unknowns.len(), rest)))
    }

    /// A point with the values of another one, by Gauss and Newton's steps of least length from a start.
    fn same_as(&self, goal: &DVector<f64>, start: DVector<f64>) -> Option<DVector<f64>> {
        let mut here = start;
        for _ in 0..60 {
            let (values, slopes) = self.at(&here)?;
            let left = goal - &values;
            if left.iter().zip(goal.iter()).all(|(left, goal)| left.abs() < 1e-11 * (1.0 + goal.abs())) {
                return Some(here);
            }
            let step = slopes.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS)?.solve(&left, 1e-11).ok()?;
            let length = step.norm();
            here += step * if length > 1.0 { 1.0 / length } else { 1.0 };
        }
        None
    }
}

/// Definitions of texts in the system.
fn nodes_of(system: &System, texts: &[&str]) -> (System, Vec<NodeId>) {
    let names: Vec<String> = (0..texts.len()).map(|number| format!("asked_{number}")).collect();
    let lines = names.iter().zip(texts).map(|(name, text)| format!("\nlet {name} = {text}"));
    let system: System = format!("{}{}", system.source, lines.collect::<String>()).parse().unwrap();
    let node = |name: &String| system.definition(name).unwrap().as_number().unwrap();
    let nodes = names.iter().map(node).collect();
    (system, nodes)
}

/// Outputs and their Lie derivatives along the drift and the inputs, as long as they are few and short.
fn measured(system: &mut System) -> Vec<NodeId> {
    let mut last: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    let mut all = last.clone();
    for _ in 0..system.unknowns().len() {
        let mut next = Vec::new();
        for node in last {
            for field in system.moving_fields() {
                let derivative = system.lie_derivative(field, node);
                if system.graph.constant_value(derivative).is_none() && !all.contains(&derivative) {
                    next.push(derivative);
                }
            }
        }
        let size = system.graph.reachable(all.iter().chain(&next).copied()).len();
        if size > 4_000 || all.len() + next.len() > 40 {
            break;
        }
        all.extend(&next);
        last = next;
    }
    all
}

/// Two sets of functions: wherever the first have the same values, the second have.
fn follow(system: &System, first: &[&str], second: &[&str], name: &str) -> usize {
    let (mut system, nodes) = nodes_of(system, &[first, second].concat());
    let (one, other) = nodes.split_at(first.len());
    agree(&mut system, one, other, name)
}

fn agree(system: &mut System, first: &[NodeId], second: &[NodeId], name: &str) -> usize {
    let one = InDoubles::new(system, first);
    let other = InDoubles::new(system, second);
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let unknowns = system.unknowns().len();
    let mut draw = |low: f64, high: f64| DVector::from_fn(unknowns, |_, _| rng.random_range(low..high));
    let mut met = 0;
    for _ in 0..8 {
        let point = draw(0.5, 2.0);
        let (Some((goal, _)), Some((wanted, _))) = (one.at(&point), other.at(&point)) else { continue };
        for _ in 0..8 {
            let Some(there) = one.same_as(&goal, draw(-2.0, 3.0)) else { continue };
            // a point as far off as this is another one, and near it what is left of an equation is multiplied
            let Some((found, slopes)) = other.at(&there) else { continue };
            let scale = 1.0 + slopes.norm() * there.norm();
            let off = (&found - &wanted).norm();
            assert!(off < 1e-6 * scale, "{name}: {off} of {scale}: {wanted} {found} at {point} and {there}");
            met += usize::from((&there - &point).norm() > 1e-3);
        }
    }
    met
}

/// Of published models: where the generators have the same values the published functions have, and the Lie derivatives of the outputs; and where all
/// Lie derivatives that are short enough have the same values, the generators have, unless there are too few of them to tell.
#[test]
fn generators_against_points_of_fibres() {
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/expected.toml");
    let table: BTreeMap<String, Expected> = toml::from_str(&std::fs::read_to_string(table).unwrap()).unwrap();
    let (mut complete, mut met) = (0, [0; 3]);
    for (name, expected) in &table {
        let system = System::read(&file_of(name)).unwrap();
        if system.unknowns().len() > 14 || !system.angles().is_empty() {
            continue;
        }
        let found = functions_of(&system);
        if !found.generate_all() {
            println!("{name}: {:?}", found.open);
            continue;
        }
        complete += 1;
        let own = texts(&found);
        let functions: Vec<&str> = match expected.published {
            true => expected
                .functions
                .iter()
                .chain(&expected.functions_of_constants)
                .map(String::as_str)
                .collect(),
            false => Vec::new(),
        };
        if !functions.is_empty() {
            met[0] += follow(&system, &own, &functions, name);
        }
        let rank = own.len();
        let (mut with_own, generators) = nodes_of(&system, &own);
        let of_outputs = measured(&mut with_own);
        met[1] += agree(&mut with_own, &generators, &of_outputs, name);
        // as many independent ones as there are functions, and some more, so that finitely many points are left and few of these by chance
        let (mut again, generators) = nodes_of(&system, &own);
        let of_outputs = measured(&mut again);
        if of_outputs.len() > rank + 2 && system.unknowns().len() <= 8 {
            met[2] += agree(&mut again, &of_outputs, &generators, name);
        }
    }
    println!("{complete} models, {met:?} points");
    assert!(complete >= 25 && met.iter().all(|met| *met >= 100), "{complete} {met:?}");
}

/// Drawn linear compartments with one output: the coefficients of the differential equation that the output satisfies, from the matrix by Faddeev and
/// Leverrier's sums, have one value where the generators have.
#[test]
fn coefficients_of_drawn_compartments() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut several, mut met) = (0, 0);
    for number in 0..30 {
        let size = rng.random_range(2..=3);
        let mut rates = vec![String::new(); size];
        let mut matrix: Vec<Vec<String>> = vec![vec!["0".to_owned(); size]; size];
        let mut names = Vec::new();
        let add = |entry: &mut String, term: &str| {
            *entry = if entry == "0" { term.to_owned() } else { format!("{entry} + {term}") };
        };
        for from in 0..size {
            for to in 0..=size {
                // a leak goes nowhere
                if from == to || !rng.random_bool(0.6) {
                    continue;
                }
                let name = format!("k{from}{to}");
                rates[from].push_str(&format!(" - {name}*x{from}"));
                add(&mut matrix[from][from], &format!("(-{name})"));
                if to < size {
                    rates[to].push_str(&format!(" + {name}*x{from}"));
                    add(&mut matrix[to][from], &name);
                }
                names.push(name);
            }
        }
        if names.is_empty() || names.len() > 6 {
            continue;
        }
        let states: Vec<String> = (0..size).map(|place| format!("x{place}")).collect();
        let rates: String =
            states.iter().zip(&rates).map(|(state, rate)| format!("\n  {state}' = 0{rate}")).collect();
        let text = format!(
            "system \"s\" state {}\nparam {} unknown\ndrift f{rates}\noutput x0",
            states.join(", "),
            names.join(", ")
        );
        let system: System = text.parse().unwrap();
        let found = functions_of(&system);
        assert!(found.generate_all(), "{text} {found:?}");
        // the trace, the sum of the principal minors and the determinant satisfy a linear equation with x0 alone, where that tells them
        let entry = |i: usize, j: usize| format!("({})", matrix[i][j]);
        let trace: Vec<String> = (0..size).map(|i| entry(i, i)).collect();
        let minor = |i: usize, j: usize| {
            format!("({}*{} - {}*{})", entry(i, i), entry(j, j), entry(i, j), entry(j, i))
        };
        let minors: Vec<String> =
            (0..size).flat_map(|i| (i + 1..size).map(move |j| (i, j))).map(|(i, j)| minor(i, j)).collect();
        let coefficients = [trace.join(" + "), minors.join(" + ")];
        let mut list: Vec<&str> = coefficients.iter().map(String::as_str).collect();
        let determinant = (size == 3).then(|| {
            let [a, b, c] = [0, 1, 2].map(|j| {
                let [p, q] = [[1, 2], [0, 2], [0, 1]][j];
                format!("{}*({}*{} - {}*{})", entry(0, j), entry(1, p), entry(2, q), entry(1, q), entry(2, p))
            });
            format!("{a} - {b} + {c}")
        });
        list.extend(determinant.as_deref());
        // they are told where all compartments take part in the output: then the differential equation has this order and no lower one
        let reaches = |from: usize| {
            let mut met = vec![from];
            let mut next = 0;
            while next < met.len() {
                let here = met[next];
                met.extend(
                    (0..size)
                        .filter(|to| matrix[*to][here] != "0" && *to != here && !met.contains(to))
                        .collect::<Vec<_>>(),
                );
                next += 1;
            }
            met.contains(&0)
        };
        if (0..size).all(reaches) {
            met += follow(&system, &texts(&found), &list, &format!("{number}: {text}"));
            several += 1;
        }
    }
    assert!(several >= 10 && met >= 100, "{several} systems, {met} points");
}

#[test]
fn the_command_tells_generators() {
    let folder = folder();
    let text = "system \"s\" state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y z' = b*x - d*z output x";
    let file = write(&folder, "s.proof", text);
    let file = file.to_str().unwrap();
    let output = palmistry(&["rank", file, "--functions"]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("identifiable functions: one value for given outputs, of which every other one is"),
        "{text}"
    );
    assert!(text.contains("\n  a + b + c + d          proved, error probability below"), "{text}");
    let found = json(&palmistry(&["rank", file, "--functions", "--json"]));
    let functions = &found["identifiable_functions"];
    assert_eq!(functions["generate_all"], true);
    assert_eq!(functions["missing"], 0);
    assert_eq!(functions["functions"][0]["function"], "x");
    assert_eq!(functions["functions"][0]["is_unknown"], true);
    assert_eq!(
        json(&palmistry(&["rank", file, "--global", "--json"]))["identifiable_functions"],
        serde_json::Value::Null
    );
    let little = palmistry(&["rank", file, "--functions", "--work", "10"]);
    assert_eq!(little.status.code(), Some(3), "{}", String::from_utf8_lossy(&little.stdout));
    assert_eq!(palmistry(&["rank", file, "--functions", "--samples", "3"]).status.code(), Some(0));
    assert_eq!(palmistry(&["rank", file, "--work", "10"]).status.code(), Some(2));
    let nothing = write(&folder, "none.proof", "system \"s\" state x drift f x' = -x output 2");
    let told = palmistry(&["rank", nothing.to_str().unwrap(), "--functions"]);
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(text.contains("identifiable functions: none but constants"), "{text}");
}
