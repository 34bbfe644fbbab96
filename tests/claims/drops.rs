//! Where ranks drop: systems whose sets are known by hand, and random ones beside exact elimination state by state.

use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry::checker::{Checking, Effort, Evidence, Finding, ProofSources, Unchecked, VerdictFile};
use palmistry::claim::{Kept, decide_all_keeping};
use palmistry::drops::{DropAnswer, where_it_drops};
use palmistry::{System, prove};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

static NO: AtomicBool = AtomicBool::new(false);

fn drops(text: &str) -> DropAnswer {
    let mut system: System = text.parse().expect("a system");
    where_it_drops(&mut system, 1, &NO).expect("there is a codistribution")
}

/// The sets with their ranks, sorted.
fn sets(answer: &DropAnswer) -> Vec<String> {
    assert!(answer.is_exact(), "{answer:#?}");
    let mut found: Vec<String> = answer
        .sets
        .iter()
        .map(|set| {
            format!("{}: {}", set.rank, [set.equations.clone(), set.unless.clone()].concat().join(", "))
        })
        .collect();
    found.sort();
    found
}

/// A unicycle with unit speed that sees the square of its distance to a beacon in the origin: `h = (x^2 + y^2)/2`,
/// `Lf h = x cos + y sin`, `Lf Lf h = 1`, and along the turning input `Lg Lf h = y cos - x sin`. Turning about the beacon is
/// not seen: rank 2, and at the beacon 2 as well (`d Lf h`, `d Lg Lf h`); the rank drops nowhere.
#[test]
fn a_unicycle_and_a_beacon() {
    let answer = drops(
        "system \"unicycle\" state x, y, theta angle theta\ndrift f x' = cos(theta) y' = sin(theta) others' = 0\n\
         input g theta' = 1 others' = 0\noutput (x^2 + y^2)/2",
    );
    assert_eq!((answer.rank, answer.dimension), (2, 3));
    assert_eq!(sets(&answer), [""; 0]);
    // without the input, on straight lines: h and Lf h, whose differentials are parallel where the motion is radial and the
    // beacon is left or reached: `x dx + y dy` against `cos dx + sin dy + (y cos - x sin) dtheta`
    let straight = drops(
        "system \"straight\" state x, y, theta angle theta\ndrift f x' = cos(theta) y' = sin(theta) others' = 0\n\
         output (x^2 + y^2)/2",
    );
    assert_eq!(straight.rank, 2);
    assert_eq!(sets(&straight), ["1: sin(theta)*x - cos(theta)*y = 0"]);
}

/// Lorenz's system seen through `x`: `d x`, `d Lf x`, `d Lf Lf x` have the determinant `-sigma^2 x` (up to sign), and on
/// `x = 0` the next word gives `sigma^3 y`. What is left is the z axis, which the drift does not leave.
#[test]
fn lorenz_by_its_first_coordinate() {
    let answer = drops(
        "system \"Lorenz\" state x, y, z param sigma, rho, beta\n\
         drift f x' = sigma*(y - x) y' = x*(rho - z) - y z' = x*y - beta*z\noutput x",
    );
    assert_eq!(answer.rank, 3);
    assert_eq!(sets(&answer), ["1: sigma = 0", "2: x = 0, y = 0"]);
    assert!(answer.sets.iter().all(|set| set.state.is_some()));
}

/// At rest the rows are the outputs' differentials, and the set can be read off: the determinant is `x (x^2 + 1) (x^2 + y)`, of
/// which the middle factor has no real zero.
#[test]
fn a_factor_without_real_zeros_cuts_out_nothing() {
    let answer =
        drops("system \"rest\" state x, y, z drift f others' = 0\noutput x, x*y*(x^2 + 1), x^2*z + y*z");
    assert_eq!(sets(&answer), ["2: x = 0", "2: y + x^2 = 0"]);
}

/// The minors of `x^2 - y^2`, `x y (x - 2 y)` and `x^3` are `2(x^4 + ...)`; each vanishes on lines, all of them at the origin
/// alone, a set of codimension two.
#[test]
fn common_zeros_may_be_fewer_than_those_of_each_minor() {
    let answer =
        drops("system \"rest\" state x, y drift f others' = 0\noutput x^2 - y^2, x*y*(x - 2*y), x^3");
    assert_eq!(sets(&answer), ["0: y = 0, x = 0"]);
}

/// `x^2 - y^2` is two lines; `x^4 + x + 1` has no real zero, which only Sturm's chain shows; `x^3 - 2` has one that is no
/// rational number.
#[test]
fn factors_are_irreducible_where_it_matters() {
    let rest =
        |output: &str| drops(&format!("system \"rest\" state x, y drift f others' = 0\noutput {output}"));
    assert_eq!(sets(&rest("x*y^2 - x^3/3, y")), ["1: x + y = 0", "1: x - y = 0"]);
    assert_eq!(sets(&rest("x^5/5 + x^2/2 + x, y")), [""; 0]);
    assert_eq!(sets(&rest("x^4/4 - 2*x, y")), ["1: x^3 - 2 = 0"]);
}

/// `cos(phi)` and `sin(phi)` as outputs of a circle see the angle everywhere; `cos(phi)` alone not where `sin(phi) = 0`, half
/// turns included; the difference of two angles is seen by its sine but for right angles.
#[test]
fn angles_include_half_turns() {
    let rest = |state: &str, output: &str| {
        drops(&format!("system \"rest\" state {state} angle {state} drift f others' = 0\noutput {output}"))
    };
    assert_eq!(sets(&rest("phi", "cos(phi), sin(phi)")), [""; 0]);
    assert_eq!(sets(&rest("phi", "cos(phi)")), ["0: sin(phi) = 0"]);
    assert_eq!(sets(&rest("phi", "sin(phi)")), ["0: cos(phi) = 0"]);
    assert_eq!(sets(&rest("a, b", "a, sin(a - b)")), ["1: cos(a - b) = 0"]);
    assert_eq!(sets(&rest("a, b", "a, sin(a + b)")), ["1: cos(a + b) = 0"]);
    // where a file does not say that it is an angle
    let plain = drops("system \"rest\" state x, phi drift f others' = 0\noutput x, x*cos(phi)");
    assert_eq!(sets(&plain), ["1: sin(phi) = 0", "1: x = 0"]);
}

/// A pendulum whose angle is measured has rank 2 everywhere; where its cosine is seen alone, not at rest where it hangs or stands.
#[test]
fn a_pendulum() {
    let pendulum = |output: &str| {
        drops(&format!(
            "system \"pendulum\" state phi, omega param k angle phi\n\
             drift f phi' = omega omega' = -k*sin(phi)\noutput {output}"
        ))
    };
    assert_eq!(sets(&pendulum("phi")), [""; 0]);
    assert_eq!(sets(&pendulum("cos(phi)")), ["0: omega = 0, sin(phi) = 0"]);
}

/// The words of claims: proved, refuted with a state off the sets, and what the rank is on them.
#[test]
fn claims_about_all_states() {
    let system: System = "system \"s\" state x, y, z param k\ndrift f x' = y y' = z z' = 0\noutput k*x, y^2 + z^2\n\
         sample x in [1, 2] y in [1, 2] z in [1, 2]\n\
         claim product: rank = 3 except where k*y = 0\nclaim least: rank = 3 except where k = 0\n\
         claim sets: rank = 3 except where k = 0 or y = 0, z = 0\nclaim given: rank = 3 where k = 2 everywhere\n\
         claim all expect refuted: rank = 3 everywhere\nclaim other expect refuted: rank = 3 except where y = 0\n\
         claim low expect refuted: rank = 2 everywhere\n\
         claim rows: rank([k, 0; y, x]) = 2 except where k*x = 0\n\
         claim one expect refuted: rank([k, 0; y, x]) = 2 except where k = 0\n"
        .parse()
        .expect("a system");
    let outcomes = prove(&system);
    for outcome in &outcomes {
        assert!(outcome.ok, "{}: {:?}", outcome.id, outcome.verdict);
    }
    let beside = |id: &str| &outcomes.iter().find(|outcome| outcome.id == id).expect("it is there").beside;
    assert_eq!(beside("least"), &["where k = 0 the rank is deficient at all states: at most 2 where k = 0"]);
    assert_eq!(beside("sets").len(), 2);
    assert_eq!(
        beside("sets")[1],
        "where y = 0, z = 0 the rank is not deficient everywhere, or that is not decided; it is 0 where y = 0, z = 0, k = 0"
    );
    assert!(beside("given").is_empty());
}

/// `d(x^2 + exp(x)) = 2x + exp(x)` has one zero, near -0.35, which no algebra finds: the set is open, and the box says how much is
/// certain. That claim stays undecided; one on a matrix has no box.
#[test]
fn what_is_open_is_certified_on_the_box_as_far_as_that_goes() {
    let text = "system \"s\" state x drift f others' = 0\noutput x^2 + exp(x)\nsample x in [LOW, 2]\n\
                claim all expect undecided: rank = 1 everywhere\n\
                claim rows expect undecided: rank([2*x + exp(x)]) = 1 everywhere";
    let shares = [("1", 1.0..=1.0, "100.0 %"), ("-1", 0.9..=0.999_999_999_999, "99.")];
    for (low, expected, told) in shares {
        let text = text.replace("LOW", low);
        let answer = drops(&text);
        assert!(!answer.is_exact() && answer.sets.is_empty() && answer.open.len() == 1);
        let share = answer.on_the_box.expect("it is open").expect("there is a box");
        assert!(expected.contains(&share.proved), "{share:?}");
        assert_eq!(share.sides.len(), 1);
        let outcomes = prove(&text.parse::<System>().expect("a system"));
        let why: Vec<String> = outcomes.iter().map(|outcome| format!("{:?}", outcome.verdict)).collect();
        assert!(outcomes.iter().all(|outcome| outcome.ok), "{why:?}");
        assert!(why[0].contains(told) && why[0].contains("interval certificates"), "{}", why[0]);
        assert!(!why[1].contains('%'), "{}", why[1]);
    }
    assert!(drops("system \"s\" state x drift f others' = 0\noutput x^3").on_the_box.is_none());
}

/// An exponential is positive; a root, a logarithm and a difference of exponentials may vanish.
#[test]
fn exponentials_do_not_vanish() {
    let system: System = "system \"s\" state x, y\ndrift f others' = 0\noutput x, y\n\
         claim one: rank([exp(x)]) = 1 everywhere\nclaim sum: rank([exp(x) + exp(2*y)]) = 1 everywhere\n\
         claim product: rank([y*exp(x)]) = 1 except where y = 0\n\
         claim again: rank([y*exp(x) + x*y*exp(x)]) = 1 except where y*(1 + x) = 0\n\
         claim less expect undecided: rank([exp(x) - 1]) = 1 everywhere\n\
         claim both expect undecided: rank([exp(x) - exp(y)]) = 1 except where x - y - 1 = 0\n\
         claim root expect undecided: rank([sqrt(x)]) = 1 everywhere\n\
         claim log expect undecided: rank([log(x)]) = 1 everywhere"
        .parse()
        .expect("a system");
    for outcome in prove(&system) {
        assert!(outcome.ok, "{}: {:?}", outcome.id, outcome.verdict);
    }
}

/// What a theorem writes down for the checker: each minor with its factors, and a state of each case with its rank. The state of
/// the case `x = 0` is told apart from that of `x != 0` by its minor.
#[test]
fn a_theorem_is_tried_on_each_of_its_cases() {
    let text = "system \"s\" state x, y, z drift f others' = 0\noutput x, y, z*x, z*y\n\
                claim theorem: rank = 3 except where x = 0, y = 0";
    let system: System = text.parse().expect("a system");
    let outcomes = decide_all_keeping(Kept::Evidence, &system, 1, &NO, &|_| ());
    assert_eq!(outcomes[0].word(), "proved", "{:?}", outcomes[0].verdict);
    let file = VerdictFile::new(1, outcomes[0].evidence.clone());
    let sources = ProofSources::given([system.clone()]);
    let effort = Effort::default();
    let with = Checking { sources: &sources, seed: 1, effort: &effort, interrupt: &NO };
    let mut consistent = 0;
    for checked in file.check(with, &|| ()) {
        match (&checked.record.evidence, &checked.finding) {
            // two states are not all
            (Evidence::Rank(_), Finding::Consistent { states }) => consistent += states + 1,
            (Evidence::Proved(_), Finding::NotChecked(Unchecked::StepOfAProof)) => {}
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(consistent, 2);
    // a state on the set that is left out has no such minor
    let mut told = file.verdicts.clone();
    for record in &mut told {
        if let Evidence::Rank(rank) = &mut record.evidence {
            let text = serde_json::to_string(&rank.states[0]).expect("it is written");
            let mut state: serde_json::Value = serde_json::from_str(&text).expect("it is read");
            for name in ["x", "y"] {
                state["state"][name] = serde_json::json!({ "number": "0" });
            }
            rank.states[0] = serde_json::from_value(state).expect("it is read");
        }
    }
    let found = VerdictFile::new(1, told);
    let findings = found.check(with, &|| ());
    assert!(findings.iter().any(|checked| matches!(checked.finding, Finding::NotConfirmed(_))));
}

/// A polynomial in three variables with small coefficients: exponents and what stands before them.
#[derive(Clone, Debug, Default)]
struct Sum(BTreeMap<[u32; 3], i128>);

impl Sum {
    fn random(rng: &mut ChaCha8Rng, terms: usize, variables: usize, degree: u32) -> Sum {
        let mut sum = Sum::default();
        for _ in 0..terms {
            let mut exponents = [0; 3];
            for _ in 0..rng.random_range(0..=degree) {
                exponents[rng.random_range(0..variables)] += 1;
            }
            *sum.0.entry(exponents).or_insert(0) += rng.random_range(-2..=2i128);
        }
        sum.0.retain(|_, value| *value != 0);
        sum
    }

    fn text(&self) -> String {
        let term = |(exponents, value): (&[u32; 3], &i128)| {
            let powers = ["x", "y", "z"].iter().zip(exponents).filter(|(_, power)| **power > 0);
            let powers = powers.map(|(name, power)| format!("*{name}^{power}"));
            format!("({value}){}", powers.collect::<String>())
        };
        if self.0.is_empty() {
            "0".to_owned()
        } else {
            self.0.iter().map(term).collect::<Vec<_>>().join(" + ")
        }
    }

    fn derivative(&self, by: usize) -> Sum {
        let mut found = Sum::default();
        for (exponents, value) in self.0.iter().filter(|(exponents, _)| exponents[by] > 0) {
            let mut less = *exponents;
            less[by] -= 1;
            *found.0.entry(less).or_insert(0) += value * i128::from(exponents[by]);
        }
        found
    }

    fn times(&self, other: &Sum, into: &mut Sum) {
        for (a, x) in &self.0 {
            for (b, y) in &other.0 {
                *into.0.entry([a[0] + b[0], a[1] + b[1], a[2] + b[2]]).or_insert(0) += x * y;
            }
        }
        into.0.retain(|_, value| *value != 0);
    }

    fn along(&self, field: &[Sum]) -> Sum {
        let mut found = Sum::default();
        for (by, rate) in field.iter().enumerate() {
            self.derivative(by).times(rate, &mut found);
        }
        found
    }

    fn at(&self, state: &[i128; 3]) -> RBig {
        let term = |(exponents, value): (&[u32; 3], &i128)| {
            let powers = state.iter().zip(exponents).map(|(x, n)| IBig::from(*x).pow(*n as usize));
            IBig::from(*value) * powers.product::<IBig>()
        };
        RBig::from(self.0.iter().map(term).sum::<IBig>())
    }
}

/// The rank of rational rows, by elimination.
fn rank(mut rows: Vec<Vec<RBig>>) -> usize {
    let mut rank = 0;
    for column in 0..rows.first().map_or(0, Vec::len) {
        let Some(at) = (rank..rows.len()).find(|row| !rows[*row][column].is_zero()) else { continue };
        rows.swap(rank, at);
        let pivot = rows[rank].clone();
        for row in &mut rows[rank + 1..] {
            let factor = &row[column] / &pivot[column];
            row.iter_mut().zip(&pivot).for_each(|(entry, p)| *entry -= &factor * p);
        }
        rank += 1;
    }
    rank
}

/// Random polynomial systems. The oracle shares nothing with the library: it differentiates sums of monomials, and eliminates
/// over the rationals at each state of a grid. On the sets that are found the rank is lower at each of these states, and off
/// them it is not, as far as words of some length tell.
#[test]
fn random_systems_beside_elimination_state_by_state() {
    let mut rng = ChaCha8Rng::seed_from_u64(20261122);
    let (mut exact, mut on, mut off) = (0, 0, 0);
    for _ in 0..60 {
        let n = rng.random_range(2..=3usize);
        let degree = if n == 2 { 3 } else { 2 };
        let field: Vec<Sum> = (0..n).map(|_| Sum::random(&mut rng, 2, n, 2)).collect();
        let outputs: Vec<Sum> =
            (0..rng.random_range(1..=2)).map(|_| Sum::random(&mut rng, 2, n, degree)).collect();
        if outputs.iter().any(|output| output.0.keys().all(|e| e.iter().sum::<u32>() == 0)) {
            continue;
        }
        let names = &["x", "y", "z"][..n];
        let rates = names.iter().zip(&field).map(|(name, rate)| format!(" {name}' = {}", rate.text()));
        let text = format!(
            "system \"random\" state {}\ndrift f{}\noutput {}",
            names.join(", "),
            rates.collect::<String>(),
            outputs.iter().map(Sum::text).collect::<Vec<_>>().join(", ")
        );
        let answer = drops(&text);
        if !answer.is_final {
            continue;
        }
        exact += usize::from(answer.is_exact());
        let mut words = outputs.clone();
        let mut last = outputs;
        for _ in 0..5 {
            last = last.iter().map(|word| word.along(&field)).collect();
            words.extend(last.clone());
        }
        let rows: Vec<Vec<Sum>> =
            words.iter().map(|word| (0..n).map(|by| word.derivative(by)).collect()).collect();
        let mut system: System = text.parse().expect("a system");
        let mut holds = |equation: &str, state: &[i128; 3]| {
            let (left, vanishes) = match (equation.strip_suffix(" = 0"), equation.strip_suffix(" != 0")) {
                (Some(left), _) => (left, true),
                (_, left) => (left.expect("an equation or not one"), false),
            };
            let values: Vec<String> =
                names.iter().zip(state).map(|(name, x)| format!("{name} = {x}")).collect();
            let value = system.evaluate_text(&format!("({left}) at {{{}}}", values.join(", ")));
            let node = value.expect("it is read").as_number().expect("a number");
            system.graph.constant_value(node).expect("a constant").is_zero() == vanishes
        };
        let side = || -2..=2i128;
        for (x, y) in side().flat_map(|x| side().map(move |y| (x, y))) {
            for z in if n == 3 { -2..=2 } else { 0..=0i128 } {
                let state = [x, y, z];
                let lower = answer.sets.iter().any(|set| {
                    set.equations.iter().chain(&set.unless).all(|equation| holds(equation, &state))
                });
                let values = rows.iter().map(|row| row.iter().map(|entry| entry.at(&state)).collect());
                let found = rank(values.collect());
                if lower {
                    assert!(found < answer.rank, "{text} at {state:?}: {found}, {:?}", answer.sets);
                    on += 1;
                } else if answer.is_exact() {
                    assert_eq!(found, answer.rank, "{text} at {state:?}: {:?}", answer.sets);
                    off += 1;
                }
            }
        }
    }
    assert!(
        exact > 30 && on > 150 && off > 1500,
        "{exact} exact answers, {on} states on the sets, {off} off them"
    );
}
