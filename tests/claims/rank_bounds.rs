//! Bounds of a rank, and ranks up to an order of Lie derivatives. Matrices are drawn as products of two of numbers and letters, so that
//! their ranks are known by construction and counted once more in machine integers modulo a prime; orders by hand.

use palmistry::{RankQuestion, System, answer_rank, prove};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PRIME: i64 = 1_000_003;

fn system(text: &str) -> System {
    text.parse().unwrap_or_else(|why| panic!("{why:?}: {text}"))
}

/// The rank modulo a prime, by elimination; entries are small.
fn rank_of(mut rows: Vec<Vec<i64>>) -> usize {
    let power = |base: i64, mut exponent: i64| {
        let (mut base, mut found) = (base, 1);
        while exponent > 0 {
            if exponent % 2 == 1 {
                found = found * base % PRIME;
            }
            base = base * base % PRIME;
            exponent /= 2;
        }
        found
    };
    let width = rows[0].len();
    let mut rank = 0;
    for column in 0..width {
        let Some(pivot) = (rank..rows.len()).find(|row| rows[*row][column].rem_euclid(PRIME) != 0) else {
            continue;
        };
        rows.swap(rank, pivot);
        let inverse = power(rows[rank][column].rem_euclid(PRIME), PRIME - 2);
        let (upper, lower) = rows.split_at_mut(rank + 1);
        for row in lower {
            let factor = row[column] * inverse % PRIME;
            for (entry, above) in row.iter_mut().zip(&upper[rank]) {
                *entry = (*entry - factor * above).rem_euclid(PRIME);
            }
        }
        rank += 1;
    }
    rank
}

/// Every bound of every rank of drawn matrices: proved exactly where it holds, and refuted where it does not.
#[test]
fn bounds_hold_where_the_rank_does() {
    let mut rng = ChaCha8Rng::seed_from_u64(35);
    for _ in 0..40 {
        let (height, width) = (rng.random_range(2..=4), rng.random_range(2..=4));
        let inner = rng.random_range(1..=3);
        let letters = ["x", "y", "1", "2", "0"];
        let values = [("x", 3), ("y", 7), ("1", 1), ("2", 2), ("0", 0)];
        let value = |letter: &str| values.iter().find(|(name, _)| *name == letter).unwrap().1;
        let mut drawn = |rows: usize, columns: usize| -> Vec<Vec<&str>> {
            (0..rows).map(|_| (0..columns).map(|_| letters[rng.random_range(0..5)]).collect()).collect()
        };
        let (left, right) = (drawn(height, inner), drawn(inner, width));
        let text = |matrix: &[Vec<&str>]| {
            let rows: Vec<String> = matrix.iter().map(|row| row.join(", ")).collect();
            format!("[{}]", rows.join("; "))
        };
        let product: Vec<Vec<i64>> = (0..height)
            .map(|i| {
                (0..width).map(|j| (0..inner).map(|k| value(left[i][k]) * value(right[k][j])).sum()).collect()
            })
            .collect();
        // a special state may have a lower rank: several are looked at
        let others = [(5, 11), (13, 2), (17, 23)].map(|(x, y)| {
            let value = |letter: &str| match letter {
                "x" => x,
                "y" => y,
                other => value(other),
            };
            let entry = |i: usize, j: usize| (0..inner).map(|k| value(left[i][k]) * value(right[k][j])).sum();
            rank_of((0..height).map(|i| (0..width).map(|j| entry(i, j)).collect()).collect())
        });
        let rank = others.into_iter().chain([rank_of(product)]).max().unwrap();
        let (left, right) = (text(&left), text(&right));
        let mut file =
            format!("system \"drawn\" state x, y drift f x' = 0 y' = 0 output x let m = {left}*{right}\n");
        let mut expected = Vec::new();
        for bound in 0..=4usize {
            let all = [
                ("=", rank == bound),
                (">=", rank >= bound),
                (">", rank > bound),
                ("<=", rank <= bound),
                ("<", rank < bound),
            ];
            for (place, (sign, holds)) in all.into_iter().enumerate() {
                if (sign, bound) == ("<", 0) {
                    continue;
                }
                file.push_str(&format!("claim c{bound}_{place}: rank(m) {sign} {bound}\n"));
                expected.push(holds);
            }
            file.push_str(&format!("claim turned{bound}: {bound} <= rank(m)\n"));
            expected.push(bound <= rank);
            file.push_str(&format!("claim both{bound}: {bound} <= rank(m) <= {}\n", bound + 1));
            expected.push(bound <= rank && rank <= bound + 1);
        }
        for (outcome, holds) in prove(&system(&file)).iter().zip(expected) {
            let word = if holds { "proved" } else { "refuted" };
            assert_eq!(outcome.word(), word, "{} of rank {rank}: {file}", outcome.statement);
        }
    }
}

/// That a rank is nowhere less than a bound, where it is greater generically: by hand, and on every set that a bound leaves out.
#[test]
fn a_rank_that_never_falls_below_a_bound() {
    let file = system(
        "system \"falls\" state x, y, z drift f x' = y y' = z z' = 0 output x
         let m = [1, x, 0; 0, y, z; 0, 0, y]
         claim most: rank(m) = 3
         claim one: rank(m) >= 1 everywhere
         claim two expect refuted: rank(m) >= 2 everywhere
         claim off: rank(m) >= 2 except where y = 0, z = 0
         claim narrow expect refuted: rank(m) >= 3 except where y = 0, z = 0
         claim enough: rank(m) >= 3 except where y = 0
         claim words: rank >= 2 everywhere
         claim all: rank >= 3 everywhere
         claim much expect refuted: rank >= 4
         claim where: rank(m) >= 2 where y = 0
         claim less: rank(m) <= 2 where y = 0",
    );
    for outcome in prove(&file) {
        assert!(outcome.ok, "{}: {:?}", outcome.id, outcome.verdict);
    }
}

/// A bound from below needs no more than a minor: on a set that the fields leave, where the rank itself is open, it is proved.
#[test]
fn bounds_of_an_open_rank() {
    let file = system(
        "system \"open\" state x, y, z drift f x' = y y' = abs(z) z' = exp(x)*sin(y) output x
         claim two: rank >= 2
         claim three: rank <= 3",
    );
    for outcome in prove(&file) {
        assert!(outcome.ok, "{}: {:?}", outcome.id, outcome.verdict);
    }
}

/// A chain of integrators needs one order more for each: by hand. Inputs are fields of their own, signals are derived as far as the order
/// goes, steps count as fields do.
#[test]
fn orders_of_lie_derivatives() {
    let chain = system(
        "system \"chain\" state a, b, c, d param k unknown known u(t)
         drift f a' = b b' = c + u c' = k*d d' = 0
         output a
         let second = codistribution(2)
         claim none: rank(codistribution(0)) = 1
         claim one: rank(codistribution(1)) = 2
         claim two: rank(second) = 3
         claim three: rank(codistribution(3)) = 4
         claim rests: rank(codistribution(4)) = 4
         claim all: rank = 4
         claim rows: second = [d(a); d(L(f, a)); d(L(f, f, a))]
         claim known: rank([second; d(c)]) = 3
         claim unknown expect refuted: rank([second; d(k*d)]) = 3
         claim later: rank([codistribution(3); d(k*d)]) = 4",
    );
    let driven = system(
        "system \"driven\" state x, y, z drift f x' = 0 y' = 0 z' = 0 input g x' = y y' = 0 z' = 0 input h x' = 0 y' = z z' = 0
         output x
         claim one: rank(codistribution(1)) = 2
         claim two: rank(codistribution(2)) = 3
         claim height: codistribution(1) = [d(x); d(L(f, x)); d(L(g, x)); d(L(h, x))]",
    );
    let steps = system(
        "system \"steps\" state x, y, z drift f x+ = y y+ = z z+ = x*y output x
         claim one: rank(codistribution(1)) = 2
         claim two: rank(codistribution(2)) = 3
         claim rows: codistribution(2) = [d(x); d(L(f, x)); d(L(f, f, x))]",
    );
    let twice = system(
        "system \"twice\" state x param k unknown experiments 2 drift f x' = k*x output x
         claim none: rank(codistribution(0)) = 2
         claim one: rank(codistribution(1)) = 3",
    );
    for file in [chain, driven, steps, twice] {
        for outcome in prove(&file) {
            assert!(outcome.ok, "{} {}: {:?}", file.title, outcome.id, outcome.verdict);
        }
    }
}

/// The same orders by the engine that samples ranks: it shares no line with the rows of the language.
#[test]
fn orders_are_those_of_sampled_ranks() {
    for name in ["moll2002/same_rate", "koteich2015/salient", "martinelli2005/one_beacon"] {
        let path = format!("{}/proofs/{name}.proof", env!("CARGO_MANIFEST_DIR"));
        for order in 0..=3 {
            let mut file = System::read(path.as_ref()).unwrap();
            let question = RankQuestion { order: Some(order), samples: 40, ..RankQuestion::default() };
            let answer = answer_rank(&mut file, &question).unwrap();
            let rank = answer.branches[0].full.rank_histogram.keys().max().copied().unwrap();
            let claim = format!("\nclaim of_this_order: rank(codistribution({order})) = {rank}\n");
            let text = format!("{}{claim}", file.source);
            let folder = std::path::Path::new(&path).parent().unwrap();
            let file = System::parse("extended.proof", &text, folder).unwrap();
            let claim = file.claims.iter().find(|claim| claim.id == "of_this_order").unwrap();
            let outcome = palmistry::decide(&file, claim, 1);
            assert!(outcome.ok, "{name} {order} {rank}: {:?}", outcome.verdict);
        }
    }
}

/// Bounds that leave one number are bounds: the checkers know equations of ranks alone, and no verdict on a bound is bound to one.
#[test]
fn bounds_that_come_to_a_number_are_not_checked() {
    let folder = crate::common::folder();
    let text = "system \"edges\"\nstate x, y\ndrift f  x' = y  y' = 0\noutput x\nclaim a: rank([0, 0]) <= 0\nclaim b: 2 <= rank <= 2\n\
                claim c: 1 <= rank([x, y; 2*x, 2*y]) <= 1\nclaim d: rank([0, 0]) < 1\nclaim e: rank([0, 0]) >= 0\n\
                claim f expect refuted: rank < 1 where x = 0\nclaim g: rank >= 0 everywhere\n";
    let file = crate::common::write(&folder, "edges.proof", text);
    let verdicts = folder.path().join("v.json").display().to_string();
    let proved = crate::common::palmistry(&["prove", file.to_str().unwrap(), "--verdicts", &verdicts]);
    assert!(proved.status.success(), "{}", String::from_utf8_lossy(&proved.stdout));
    let checked = crate::common::palmistry(&["recheck", &verdicts]);
    let text = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(checked.status.success() && text.contains("7 verdicts: 7 not checked"), "{text}");
}

/// What cannot be meant is refused where it stands.
#[test]
fn what_is_no_bound_and_no_order() {
    let head = "system \"t\" state x, y drift f x' = y y' = 0 ";
    for (rest, why) in [
        ("output x claim a: rank != 2", "compares numbers"),
        ("output x claim a: rank <= 2 everywhere", "nowhere greater"),
        ("output x claim a: 1 <= rank <= 2 everywhere", "nowhere greater"),
        ("output x claim a: 3 >= rank except where x = 0", "nowhere greater"),
        ("output x latex x \"y\"", "looks so"),
        ("output x latex x \"z\" param z", "looks so"),
        ("output x latex x \"z\", y \"z\"", "looks so"),
        ("output x latex x \"\\dot{\\dot{\\dot{x}}}\"", "no letter with accents"),
        ("output x claim a: rank(codistribution(-1)) = 2", "greatest number of fields"),
        ("output x claim a: rank(codistribution(1/2)) = 2", "greatest number of fields"),
        ("output x claim a: rank(codistribution(x)) = 2", "greatest number of fields"),
        ("output x claim a: rank(codistribution(100000)) = 2", "more than 4096 rows"),
        ("claim a: rank(codistribution(1)) = 2", "no codistribution"),
        ("output x output 0 = x*y claim a: rank(codistribution(1)) = 2", "outputs that are zero"),
        ("output x let m = codistribution(1) output y", "does not know of this output"),
        ("output x let m = codistribution(1) input g x' = 0 y' = 1", "does not know of this field"),
        ("output x claim a: rank >= x", "whole number"),
        ("output x claim a: rank = 3/2", "whole number"),
        ("output x claim a: 1 <= rank <= x", "whole number"),
        ("output x let n = 1 + 1 claim a: rank([x, y]) >= n - 1", ""),
    ] {
        let parsed: Result<System, _> = format!("{head}{rest}").parse();
        match parsed {
            Err(error) => assert!(error.to_string().contains(why), "{rest}: {error}"),
            Ok(file) => {
                let outcomes = prove(&file);
                assert!(
                    why.is_empty() && outcomes.iter().all(|outcome| outcome.word() == "proved"),
                    "{rest}: {outcomes:?}"
                );
            }
        }
    }
    // few rows, and each of very many entries
    let many = "system \"t\" state x[1..2000] drift f others' = 0 output x[1], x[2] claim a: rank(codistribution(40)) = 2";
    let error = many.parse::<System>().unwrap_err().to_string();
    assert!(error.contains("more than 65536 entries"), "{error}");
}

/// A rank that no matrix of this size has is refuted wherever the matrix exists, with 'everywhere' as without.
#[test]
fn more_than_a_matrix_can_have() {
    let file = system(
        "system \"s\" param x, y
         claim a expect refuted: rank([x, y]) >= 2 everywhere
         claim b expect refuted: rank([x, y]) = 2 everywhere
         claim c expect refuted: rank([x, y]) = 3 except where x = 0
         claim d expect refuted: rank([x; y; x*y]) > 1 everywhere
         claim e expect refuted: rank([x, y]) >= 2
         claim f: rank([x, y]) >= 1 except where x = 0, y = 0",
    );
    for outcome in prove(&file) {
        assert!(outcome.ok, "{}: {:?}", outcome.id, outcome.verdict);
    }
}
