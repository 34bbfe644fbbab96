//! Ranks at states where the argument of an absolute value vanishes. The oracle takes one-sided differences of the outputs' derivatives, which are written here by hand.

use crate::common::{folder, palmistry, write};
use palmistry::claim::Verdict;
use palmistry::{System, decide_all};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn word(model: &str, claim: &str) -> (String, String) {
    let system: System = format!("{model}\nclaim c: {claim}\n").parse().unwrap();
    let outcome = decide_all(&system, 1, &false.into(), &|_| ()).remove(0);
    let why = match &outcome.verdict {
        Verdict::Undecided { why } => why.clone(),
        Verdict::Proved { engine, .. } => engine.clone(),
        _ => String::new(),
    };
    (outcome.verdict.word().to_owned(), why)
}

/// A system of two states, a state in its kink, and the outputs' derivatives that are continuously differentiable there.
struct Case {
    model: &'static str,
    kink: &'static str,
    at: [f64; 2],
    smooth: [fn([f64; 2]) -> f64; 2],
}

const CASES: [Case; 5] = [
    // a tyre whose force grows less and less: straight driving
    Case {
        model: "system \"s\" state beta, r param C = 5 drift f beta' = -r - C*beta/(1 + abs(beta)) r' = C*beta/(1 + abs(beta)) - r output r",
        kink: "beta = 0, r = 0",
        at: [0.0, 0.0],
        smooth: [|[_, r]| r, |[beta, r]| 5.0 * beta / (1.0 + beta.abs()) - r],
    },
    Case {
        model: "system \"s\" state beta, r param C = 5 drift f beta' = -r - C*beta/(1 + abs(beta)) r' = C*beta/(1 + abs(beta)) - r output r",
        kink: "beta = 0",
        at: [0.0, 0.7],
        smooth: [|[_, r]| r, |[beta, r]| 5.0 * beta / (1.0 + beta.abs()) - r],
    },
    // a drag that is the square of the velocity, with its sign
    Case {
        model: "system \"s\" state x, v drift f x' = v v' = -v*abs(v) - x output x",
        kink: "v = 0",
        at: [0.3, 0.0],
        smooth: [|[x, _]| x, |[_, v]| v],
    },
    // a tank whose inflow stops at a level
    Case {
        model: "system \"s\" state a, b drift f a' = max(b - a, 0)^2 + b b' = -b output a",
        kink: "a = b",
        at: [0.4, 0.4],
        smooth: [|[a, _]| a, |[a, b]| (b - a).max(0.0).powi(2) + b],
    },
    // two kinks that meet
    Case {
        model: "system \"s\" state x, y drift f x' = y + x*abs(x) + y*abs(y) y' = -x output x",
        kink: "x = 0, y = 0",
        at: [0.0, 0.0],
        smooth: [|[x, _]| x, |[x, y]| y + x * x.abs() + y * y.abs()],
    },
];

#[test]
fn a_rank_is_full_where_enough_derivatives_are_continuously_differentiable() {
    for case in &CASES {
        let (found, why) = word(case.model, &format!("rank = 2 where {}", case.kink));
        assert_eq!(found, "proved", "{} {}: {why}", case.model, case.kink);
        assert!(why.contains("continuously differentiable at the kink"), "{why}");
        for claim in ["rank >= 1", "rank >= 2", "1 <= rank <= 2", "observable(STATES)"] {
            let states = case.model.split("state ").nth(1).unwrap().split(" param").next().unwrap();
            let states = states.split(" drift").next().unwrap();
            let claim = claim.replace("STATES", states);
            let (found, why) = word(case.model, &format!("{claim} where {}", case.kink));
            assert_eq!(found, "proved", "{} {claim}: {why}", case.model);
        }
        for claim in ["rank = 1", "rank <= 1", "rank = 3"] {
            let (found, _) = word(case.model, &format!("{claim} where {}", case.kink));
            assert_ne!(found, "proved", "{} {claim}", case.model);
        }
        // from every side the same slopes, and those of rank two
        let step = 1e-6;
        let mut all: Vec<[[f64; 2]; 2]> = Vec::new();
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let slope = |of: fn([f64; 2]) -> f64, k: usize| {
                let mut there = case.at;
                there[k] += signs[k] * step;
                (of(there) - of(case.at)) / (signs[k] * step)
            };
            all.push(case.smooth.map(|of| [slope(of, 0), slope(of, 1)]));
        }
        for one in &all {
            for (row, first) in one.iter().zip(&all[0]) {
                assert!(row.iter().zip(first).all(|(a, b)| (a - b).abs() < 1e-4), "{}", case.model);
            }
            assert!((one[0][0] * one[1][1] - one[0][1] * one[1][0]).abs() > 0.5, "{}", case.model);
        }
    }
}

/// What has no continuous differential does not count, and what it would add is not decided.
#[test]
fn what_is_not_differentiable_at_a_kink_decides_nothing() {
    let friction = "system \"s\" state v, w param k unknown drift f v' = -k*abs(v - w)*(v - w) w' = k*abs(v - w)*(v - w) output v";
    // all are continuously differentiable, and those that are looked at vanish
    let (found, why) = word(friction, "rank = 1 where v = w");
    assert_eq!(found, "undecided");
    assert!(why.contains("it lies in a kink, and the first Lie derivatives do not decide it"), "{why}");
    let tyre = "system \"s\" state beta, r param C unknown drift f beta' = -r - C*beta/(1 + abs(beta)) r' = C*beta/(1 + abs(beta)) - r output r";
    let (found, why) = word(tyre, "rank = 3 where beta = 0");
    assert_eq!(found, "undecided");
    assert!(why.contains("L(f, L(f, r)) has no continuous differential there"), "{why}");
    assert_eq!(word(tyre, "rank >= 2 where beta = 0").0, "proved");
    assert_eq!(word(friction, "rank >= 1 where v = w").0, "proved");
    assert_eq!(word(friction, "rank >= 2 where v = w").0, "undecided");
    assert_eq!(word(friction, "observable(v, w) where v = w").0, "undecided");
    // off the kink nothing has changed
    assert_eq!(word(friction, "rank = 3").0, "proved");
    // the output has a kink itself; a rate jumps; a root has no slope; a map leads from one side to the other
    for (model, claim) in [
        ("system \"s\" state x drift f x' = 1 output abs(x)", "rank = 1 where x = 0"),
        ("system \"s\" state x, v drift f x' = v v' = -sign(v) output x", "rank = 2 where v = 0"),
        ("system \"s\" state x, v drift f x' = v v' = -sqrt(abs(v)) output x", "rank = 2 where v = 0"),
        ("system \"s\" state x, y drift f x+ = y + x*abs(x) y+ = x output x", "rank = 2 where x = 0"),
    ] {
        assert_eq!(word(model, claim).0, "undecided", "{model}");
    }
}

/// States are not sampled in a kink, and the message says what answers. Beside it they are.
#[test]
fn a_sweep_in_a_kink_says_what_decides_there() {
    let folder = folder();
    let file =
        write(&folder, "s.proof", format!("{}\nsample beta in [-1, 1] r in [-1, 1]\n", CASES[0].model));
    let rank = |condition: &str| palmistry(&["rank", file.to_str().unwrap(), "--where", condition]);
    let output = rank("beta = 0");
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(message.contains("lie in a kink of an absolute value"), "{message}");
    assert_eq!(rank("r = 0").status.code(), Some(0));
}

/// A term as text and as numbers.
type Term = (&'static str, fn(f64, f64) -> f64);

/// Terms of drawn systems.
const TERMS: [Term; 9] = [
    ("x", |x, _| x),
    ("y", |_, y| y),
    ("x*abs(x)", |x, _| x * x.abs()),
    ("abs(x)", |x, _| x.abs()),
    ("y*abs(x)", |x, y| y * x.abs()),
    ("max(x, 0)^2", |x, _| x.max(0.0).powi(2)),
    ("y^2", |_, y| y * y),
    ("max(x, 0)*abs(y)", |x, y| x.max(0.0) * y.abs()),
    ("abs(x)^3*y", |x, y| x.abs().powi(3) * y),
];

/// Drawn systems at `x = 0`, and at `x = 0, y = 0`: where the rank is proved full the output has the same slope from both sides, and motions from states around differ
/// in it, each by as much as the states are apart. The motions are those of a method of Runge and Kutta in this file.
#[test]
fn states_in_kinks_whose_rank_is_full_are_told_apart() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut proved = [0, 0];
    for _ in 0..150 {
        // most of them continuously differentiable, or nothing would be proved
        let smooth = [0, 1, 2, 5, 6, 8];
        let mut sum = |count: usize| -> Vec<(usize, f64)> {
            let any = rng.random_range(0..4) == 0;
            let mut term = || match any {
                true => rng.random_range(0..TERMS.len()),
                false => smooth[rng.random_range(0..smooth.len())],
            };
            let terms: Vec<usize> = (0..count).map(|_| term()).collect();
            let mut factor = || f64::from(rng.random_range(1..4)) * [1.0, -1.0][rng.random_range(0..2)];
            terms.into_iter().map(|term| (term, factor())).collect()
        };
        let sums = [sum(2), sum(2), sum(3)];
        let text = |of: &[(usize, f64)]| {
            of.iter()
                .map(|(term, factor)| format!("({factor})*{}", TERMS[*term].0))
                .collect::<Vec<_>>()
                .join(" + ")
        };
        let value = |of: &[(usize, f64)], [x, y]: [f64; 2]| -> f64 {
            of.iter().map(|(term, factor)| factor * TERMS[*term].1(x, y)).sum()
        };
        let model = format!(
            "system \"s\" state x, y drift f x' = {} y' = {} output {}",
            text(&sums[0]),
            text(&sums[1]),
            text(&sums[2])
        );
        for (place, set, at) in
            [(0, "x = 0", [0.0, 0.37]), (0, "x = 0", [0.0, -0.53]), (1, "x = 0, y = 0", [0.0, 0.0])]
        {
            let (found, _) = word(&model, &format!("rank = 2 where {set}"));
            if found != "proved" {
                continue;
            }
            proved[place] += 1;
            let outputs = |from: [f64; 2]| -> Vec<f64> {
                let rate = |at: [f64; 2]| [value(&sums[0], at), value(&sums[1], at)];
                let (mut at, step) = (from, 1e-3);
                let along = |at: [f64; 2], by: [f64; 2], far: f64| [at[0] + far * by[0], at[1] + far * by[1]];
                let mut found = vec![value(&sums[2], at)];
                for k in 0..100 {
                    let a = rate(at);
                    let b = rate(along(at, a, step / 2.0));
                    let c = rate(along(at, b, step / 2.0));
                    let d = rate(along(at, c, step));
                    for i in 0..2 {
                        at[i] += step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
                    }
                    if k % 5 == 4 {
                        found.push(value(&sums[2], at));
                    }
                }
                found
            };
            let (here, apart) = (outputs(at), 1e-5);
            for k in 0..16 {
                let (s, c) = (f64::from(k) * std::f64::consts::PI / 8.0).sin_cos();
                let there = outputs([at[0] + apart * c, at[1] + apart * s]);
                let back = outputs([at[0] - apart * c, at[1] - apart * s]);
                let most = there.iter().zip(&here).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(most > 1e-4 * apart, "{model} at {at:?}: {most:e} in direction {k}");
                let bend = (there[0] + back[0] - 2.0 * here[0]).abs();
                assert!(bend < 1e-2 * apart, "{model} at {at:?}: {bend:e} in direction {k}");
            }
        }
    }
    assert!(proved[0] > 30 && proved[1] > 3, "{proved:?}");
}

/// Edges: a function that depends on a sign on one side alone; a logarithm of a square; the edge of what is assumed; a function that does not exist there; a product under the
/// bars, which vanishes in two ways; sides that only an assumption excludes; and derivatives that grow.
#[test]
fn edges_of_kinks_are_no_kinks() {
    for (model, claim) in [
        (
            "system \"s\" state x, y drift f x' = 1 y' = 1 output x + max(x, 0)*abs(y) output y",
            "rank = 2 where x = 0",
        ),
        ("system \"s\" state x, y drift f x' = y y' = 1 output log(x^2) output y", "rank >= 1 where x = 0"),
        (
            "system \"s\" state x, y drift f x' = y y' = 1 + x*abs(x) output x output y + log(x^2)",
            "rank >= 1 where x = 0",
        ),
        ("system \"s\" state x assume x >= 0 drift f x' = 1 output abs(x)", "rank = 1 where x = 0"),
        (
            "system \"s\" state x, y assume x + y >= 0 drift f x' = 1 y' = 1 output abs(x) + abs(y) output x - y",
            "rank = 2 where x = 0, y = 0",
        ),
        (
            "system \"s\" state x, v drift f x' = v v' = -v*abs(v) output x",
            "observable(log(v^2)) where v = 0",
        ),
        ("system \"s\" state x, y drift f x' = y y' = 1 output abs(x*y)", "rank = 2 where x = 0"),
        (
            "system \"s\" state x, v assume v^2 > 0 drift f x' = v v' = -v*abs(v) output x",
            "rank = 2 where v = 0",
        ),
    ] {
        let (found, why) = word(model, claim);
        assert_eq!(found, "undecided", "{model}: {claim}");
        assert!(!model.contains("log(x^2)") || !why.contains("kink"), "{why}");
    }
    // twelve states one after another, whose derivatives double: the search ends
    let names: Vec<String> = (0..12).map(|i| format!("x{i}")).collect();
    let rates: Vec<String> =
        (0..12).map(|i| format!("x{i}' = x{}*abs(x0)*sin(x{i}*x{})", (i + 1) % 12, (i + 5) % 12)).collect();
    let model = format!("system \"s\" state {} drift f {} output x1*x2", names.join(", "), rates.join(" "));
    assert_ne!(word(&model, "rank = 12 where x0 = 0").0, "proved");
}
