//! Systems in discrete time: ranks against matrices of observability, against sequences that are followed in residues, and by hand.

use palmistry::sweep::BranchAnswer;
use palmistry::{RankQuestion, System, answer_accessibility, answer_rank, prove};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::Path;

fn only(text: &str, conditions: &[&str]) -> BranchAnswer {
    let mut system: System = text.parse().unwrap_or_else(|why| panic!("{why:?}\n{text}"));
    let conditions = conditions.iter().map(|text| (*text).to_owned()).collect();
    let question = RankQuestion { samples: 20, conditions, ..RankQuestion::default() };
    answer_rank(&mut system, &question).unwrap_or_else(|why| panic!("{why}\n{text}")).branches.remove(0)
}

/// A prime, and numbers modulo it with derivatives by the states.
const P: i128 = (1 << 61) - 1;

#[derive(Clone)]
struct Jet(i128, Vec<i128>);

impl Jet {
    fn constant(value: i128, count: usize) -> Jet {
        Jet(value.rem_euclid(P), vec![0; count])
    }
    fn plus(&self, other: &Jet) -> Jet {
        Jet((self.0 + other.0) % P, self.1.iter().zip(&other.1).map(|(a, b)| (a + b) % P).collect())
    }
    fn times(&self, other: &Jet) -> Jet {
        let slopes = self.1.iter().zip(&other.1).map(|(a, b)| (a * other.0 % P + b * self.0 % P) % P);
        Jet(self.0 * other.0 % P, slopes.collect())
    }
}

fn inverse(value: i128) -> i128 {
    let (mut base, mut power, mut found) = (value.rem_euclid(P), P - 2, 1);
    while power > 0 {
        if power & 1 == 1 {
            found = found * base % P;
        }
        base = base * base % P;
        power >>= 1;
    }
    found
}

fn rank(mut rows: Vec<Vec<i128>>) -> usize {
    let columns = rows.first().map_or(0, Vec::len);
    let mut found = 0;
    for column in 0..columns {
        let Some(pivot) = (found..rows.len()).find(|row| rows[*row][column] != 0) else { continue };
        rows.swap(found, pivot);
        let scale = inverse(rows[found][column]);
        let (above, below) = rows.split_at_mut(found + 1);
        for row in below {
            let factor = row[column] * scale % P;
            for (entry, other) in row.iter_mut().zip(&above[found]) {
                *entry = (*entry - factor * other % P).rem_euclid(P);
            }
        }
        found += 1;
    }
    found
}

/// A sum of monomials: a factor, and the states in it; the place behind the last state is the known signal.
type Polynomial = Vec<(i64, Vec<usize>)>;

fn written(polynomial: &Polynomial, names: &[String]) -> String {
    let term = |(factor, states): &(i64, Vec<usize>)| {
        let parts: Vec<String> = states.iter().map(|state| format!("*{}", names[*state])).collect();
        format!("({factor}){}", parts.concat())
    };
    let terms: Vec<String> = polynomial.iter().map(term).collect();
    if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
}

fn value(polynomial: &Polynomial, at: &[Jet]) -> Jet {
    let count = at[0].1.len();
    polynomial.iter().fold(Jet::constant(0, count), |sum, (factor, states)| {
        let one = Jet::constant(i128::from(*factor), count);
        sum.plus(&states.iter().fold(one, |product, state| product.times(&at[*state])))
    })
}

/// Random maps, many of them with thin images, some with a known signal: the rank of twice as many values of the outputs as there are
/// states, with derivatives modulo a prime.
#[test]
fn ranks_are_those_of_sequences() {
    let mut rng = ChaCha8Rng::seed_from_u64(2026);
    let mut met = std::collections::BTreeSet::new();
    for case in 0..60 {
        let n = rng.random_range(1..5usize);
        let has_signal = rng.random_range(0..3) == 0;
        let variables = n + usize::from(has_signal);
        let polynomial = |rng: &mut ChaCha8Rng, most: usize| -> Polynomial {
            let terms = rng.random_range(0..=most);
            let monomial = |rng: &mut ChaCha8Rng| {
                let degree = rng.random_range(0..3usize);
                (rng.random_range(1..4i64), (0..degree).map(|_| rng.random_range(0..variables)).collect())
            };
            (0..terms).map(|_| monomial(rng)).collect()
        };
        let map: Vec<Polynomial> = (0..n).map(|_| polynomial(&mut rng, 2)).collect();
        let mut output = polynomial(&mut rng, 2);
        output.push((1, vec![rng.random_range(0..n)]));
        let mut names: Vec<String> = (1..=n).map(|place| format!("x[{place}]")).collect();
        names.push("u".to_owned());
        let mut text = format!("system \"map\" state x[1..{n}]\n");
        text += if has_signal { "known u(t)\ndrift f\n" } else { "drift f\n" };
        for (name, successor) in names.iter().zip(&map) {
            text += &format!("  {name}+ = {}\n", written(successor, &names));
        }
        text += &format!(
            "output {}\nsample x[1..{n}] in [1, 2]{}",
            written(&output, &names),
            if has_signal { " u in [1, 2]" } else { "" }
        );

        let draw = |rng: &mut ChaCha8Rng| i128::from(rng.random_range(1..i64::MAX));
        let mut state: Vec<Jet> = (0..n)
            .map(|place| {
                let mut jet = Jet::constant(draw(&mut rng), n);
                jet.1[place] = 1;
                jet
            })
            .collect();
        let mut rows = Vec::new();
        for _ in 0..2 * n + 1 {
            let mut all = state.clone();
            if has_signal {
                all.push(Jet::constant(draw(&mut rng), n));
            }
            rows.push(value(&output, &all).1);
            state = map.iter().map(|successor| value(successor, &all)).collect();
        }
        let wanted = rank(rows);
        let found = only(&text, &[]);
        assert_eq!(found.generic_rank, wanted, "case {case}: {text}");
        assert!(found.is_final, "case {case}: {text}");
        met.insert((n - wanted, has_signal));
    }
    assert!(met.len() > 4, "{met:?}");
}

/// By hand.
#[test]
fn answers_that_are_known() {
    for (text, rank, full) in [
        // the growth rate of the logistic map is seen from two values
        (
            "state x param r unknown drift f x+ = r*x*(1 - x) output x sample x in [1/4, 1/3] r in [2, 3]",
            2,
            2,
        ),
        // a state that is not named stays, and is not seen
        ("state x, y drift f x+ = x/2 output x sample x in [1, 2] y in [1, 2]", 1, 2),
        ("state x, y drift f x+ = x + y output x sample x in [1, 2] y in [1, 2]", 2, 2),
        // nilpotent: two of three are forgotten at once, the output sees them before
        (
            "state x[1..3] drift f x[i]+ = x[i + 1] for i in 1..2 x[3]+ = 0 output x[1] sample x[1..3] in [1, 2]",
            3,
            3,
        ),
        // the span rests after one step and grows at the next: the images are a thin set
        (
            "state x, y, z, w drift f x+ = 0 y+ = 1 z+ = x w+ = z/y output x*y, x*z, w sample x in [1, 2] y in [1, 2] z in [1, 2] w in [1, 2]",
            4,
            4,
        ),
        // what a known signal multiplies is seen, what an unknown one does is its own difference
        (
            "state x, z known u(t) drift f x+ = x + u*z output x sample x in [1, 2] z in [1, 2] u in [1, 2]",
            2,
            2,
        ),
        (
            "state x unknown w(t) drift f x+ = x + w output x sample x in [1, 2] w in [1, 2] w' in [1, 2]",
            3,
            3,
        ),
        // two parameters in one product
        (
            "state x param a unknown, b unknown drift f x+ = a*b*x output x sample x in [1, 2] a in [1, 2] b in [1, 2]",
            2,
            3,
        ),
        // a delay line of a signal that is known is known too late: its past is a state
        (
            "state before known u(t) drift f before+ = u output before sample before in [1, 2] u in [1, 2]",
            1,
            1,
        ),
    ] {
        let found = only(&format!("system \"s\" {text}"), &[]);
        assert_eq!((found.generic_rank, found.is_final), (rank, true), "{text}");
        assert_eq!(found.full.rank_histogram.keys().collect::<Vec<_>>(), [&rank], "{text}");
        assert_eq!(found.full.certified, 20, "{text}");
        assert_eq!(found.taken[0].entries.len(), full, "{text}");
    }
}

/// On a set that a step leaves nothing is final but a rank that cannot be exceeded; on one that it does not, what rests long enough.
#[test]
fn special_sets() {
    let text =
        "system \"s\" state x, y drift f x+ = x + x*y y+ = 2*y output x sample x in [1, 2] y in [1, 2]";
    assert_eq!(only(text, &[]).generic_rank, 2);
    // x = 0 is kept, and nothing is seen of y there
    let kept = only(text, &["x = 0"]);
    assert_eq!((kept.generic_rank, kept.is_final), (1, true));
    assert!(kept.order >= 4, "{}", kept.order);
    let left = only(text, &["y = 1"]);
    assert_eq!((left.generic_rank, left.is_final), (2, true));
    let text = "system \"s\" state x, y, z drift f x+ = x + y^2 y+ = y + z z+ = 0 output x sample x in [1, 2] y in [1, 2] z in [1, 2]";
    assert_eq!(only(text, &[]).generic_rank, 3);
    let left = only(text, &["y = 0"]);
    assert_eq!((left.generic_rank, left.is_final), (2, false));
}

/// The later values of a known signal are drawn where the signal is, given or by default, and boxes have a side for each.
#[test]
fn later_values_lie_where_the_signal_does() {
    let text = "system \"s\" state x, y, z known u(t) drift f x+ = x + y y+ = y + u*z output x sample x in [1, 2] y in [1, 2] z in [1, 2]";
    for range in ["", " u in [3, 4]"] {
        let text = format!("{text}{range}");
        let found = only(&text, &[]);
        assert_eq!((found.generic_rank, found.full.certified), (3, 20), "{text}");
        let worst = &found.full.worst.as_ref().unwrap().0;
        let (low, high) = if range.is_empty() { (-1.0, 1.0) } else { (3.0, 4.0) };
        assert!(
            worst.iter().filter(|at| at.name.starts_with('u')).all(|at| (low..=high).contains(&at.value)),
            "{worst:?}"
        );
        let mut system: System = text.parse().unwrap();
        let region = palmistry::certify(&mut system, 200);
        assert!(region.is_ok(), "{:?}", region.err());
    }
}

/// Angles may be added up in a step; on a set that fixes one up to whole turns these do not matter.
#[test]
fn angles_are_turned() {
    let text = "system \"s\" state a, b, x angle a, b drift f a+ = a + b x+ = x + sin(a) output x sample a in [-3, 3] b in [-3, 3] x in [0, 1]";
    let found = only(text, &[]);
    assert_eq!((found.generic_rank, found.is_final, found.full.certified), (3, true, 20));
    let on = only(text, &["sin(b) = 0"]);
    assert_eq!(on.full.rank_histogram.len(), 1);
}

/// `L(f, e)` is `e` after a step, wherever that exists.
#[test]
fn claims_are_about_compositions() {
    let text = "system \"s\"\nstate x : length, y : length\nparam k\nknown u(t) : length\ndrift f\n  x+ = y + u\n  y+ = k*x\nfield g\n  x+ = 2*x\n\
                output x\nsample x in [1, 2] y in [1, 2] k in [1, 2] u in [1, 2]\n\
                claim once: L(f, x^2) = (y + u)^2\nclaim twice: L(f, f, y) = k*(y + u)\nclaim other: L(g, x*y) = 2*x*y\n\
                claim order: L(f, g, x) = 2*(y + u)\nclaim and: L(g, f, y) = 2*k*x\nclaim stays: L(f, k) = k\nclaim rank: rank = 2\n\
                claim wrong expect refuted: L(f, x) = y\n";
    let system: System = text.parse().unwrap_or_else(|why| panic!("{why:?}"));
    for outcome in prove(&system) {
        assert!(outcome.ok, "{}: {}", outcome.id, outcome.word());
    }
    // what is needed is needed after the step
    let text = "system \"s\"\nstate x\ndrift f\n  x+ = x - 1\nclaim 1: L(f, x/x) = 1\n";
    let system: System = text.parse().unwrap();
    let outcome = &prove(&system)[0];
    assert!(
        outcome.ok && outcome.domain.iter().any(|need| need.contains("x + (-1) != 0")),
        "{:?}",
        outcome.domain
    );
}

#[test]
fn what_is_refused() {
    for (text, message) in [
        ("state x, y drift f x+ = 1 y' = 2", "expected one kind of time in a field"),
        ("state x drift f x+ = 1 field g x' = 2", "the field 'f' above is one of another time"),
        ("state x field g x' = 2 drift f x+ = 1", "the field 'g' above is one of another time"),
        ("state x input g x+ = 2", "in discrete time an input is a known signal, and no field"),
        ("state x drift f x+ = 1 drift g x+ = 2", "there is a drift 'f' already"),
        (
            "state x drift f x+ = 1 others+ = 0",
            "expected the name of a state: one that is not named stays as it is",
        ),
        ("state x drift f x+ = 1 x+ = 2", "'x' is given twice in the field 'f'"),
        ("state x known u(t) drift f x+ = u'", "in discrete time 'u' has no derivatives"),
        (
            "state x drift f x+ = 1 field g x+ = x claim 1: bracket(f, g) = [1]",
            "'f' is a map, and maps have no bracket",
        ),
    ] {
        let text = format!("system \"s\"\n{text}\n");
        let error = System::parse("s.proof", &text, Path::new("")).expect_err(&text);
        assert_eq!(error.message, message, "{text}");
    }
    let mut system: System =
        "system \"s\" state x drift f x+ = x output x sample x in [1, 2]".parse().unwrap();
    assert!(
        answer_accessibility(&mut system, &RankQuestion::default())
            .is_err_and(|why| why.to_string().contains("continuous"))
    );
}
