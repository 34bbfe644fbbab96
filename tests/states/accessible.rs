//! The rank of the accessibility distribution: Kalman's matrix for linear systems, and systems whose answer is known.

use crate::common::{folder, json, palmistry, write};
use dashu::rational::RBig;
use palmistry::sweep::{AccessibilityAnswer, AccessibilityBranch};
use palmistry::{RankQuestion, System, answer_accessibility};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn answer(text: &str, conditions: &[&str]) -> AccessibilityAnswer {
    let mut system: System = text.parse().unwrap_or_else(|why| panic!("{why:?}\n{text}"));
    let conditions = conditions.iter().map(|text| (*text).to_owned()).collect();
    let question = RankQuestion { samples: 20, conditions, ..RankQuestion::default() };
    answer_accessibility(&mut system, &question).unwrap_or_else(|why| panic!("{why}\n{text}"))
}

/// The one branch of an answer.
fn only(text: &str) -> AccessibilityBranch {
    answer(text, &[]).branches.remove(0)
}

/// The rank of a matrix of small integers, by elimination in rationals.
fn rank(mut rows: Vec<Vec<i64>>) -> usize {
    let mut rows: Vec<Vec<RBig>> =
        rows.drain(..).map(|row| row.into_iter().map(RBig::from).collect()).collect();
    let columns = rows.first().map_or(0, Vec::len);
    let mut found = 0;
    for column in 0..columns {
        let Some(pivot) = (found..rows.len()).find(|row| rows[*row][column] != RBig::ZERO) else { continue };
        rows.swap(found, pivot);
        let (above, below) = rows.split_at_mut(found + 1);
        for row in below {
            let factor = &row[column] / &above[found][column];
            row.iter_mut().zip(&above[found]).for_each(|(entry, other)| *entry -= &factor * other);
        }
        found += 1;
    }
    found
}

fn times(a: &[Vec<i64>], x: &[i64]) -> Vec<i64> {
    a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
}

/// `x' = A x + B u`: the strong rank is that of `[B, AB, A^2 B, ...]`, and the other one more where `A x` leads out of its span.
#[test]
fn linear_systems_have_kalmans_rank() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let mut ranks = std::collections::BTreeSet::new();
    for case in 0..60 {
        let (n, inputs) = (rng.random_range(1..6usize), rng.random_range(1..3usize));
        // many zeros, so that ranks are short
        let entry = |rng: &mut ChaCha8Rng| match rng.random_range(0..3) {
            0 => rng.random_range(-3..4i64),
            _ => 0,
        };
        let a: Vec<Vec<i64>> = (0..n).map(|_| (0..n).map(|_| entry(&mut rng)).collect()).collect();
        let b: Vec<Vec<i64>> = (0..inputs).map(|_| (0..n).map(|_| entry(&mut rng)).collect()).collect();
        let mut kalman = Vec::new();
        for column in &b {
            let mut column = column.clone();
            for _ in 0..n {
                kalman.push(column.clone());
                column = times(&a, &column);
            }
        }
        let strong = rank(kalman.clone());
        // at almost all states: at one that no equation of small integers knows
        let state: Vec<i64> = (0..n as u32).map(|place| 1009i64.pow(place)).collect();
        kalman.push(times(&a, &state));
        let whole = rank(kalman);
        let mut text = format!("system \"linear\" state x[1..{n}] drift f ");
        for (place, row) in a.iter().enumerate() {
            let terms: Vec<String> =
                row.iter().enumerate().map(|(column, a)| format!("({a})*x[{}]", column + 1)).collect();
            text += &format!("x[{}]' = {} ", place + 1, terms.join(" + "));
        }
        for (input, column) in b.iter().enumerate() {
            text += &format!("input b{input} ");
            for (place, b) in column.iter().enumerate() {
                text += &format!("x[{}]' = {b} ", place + 1);
            }
        }
        text += &format!("sample x[1..{n}] in [1, 2]");
        let found = only(&text);
        assert_eq!(found.strong.rank(), Some(strong), "case {case}: {text}");
        assert_eq!(found.whole.rank(), Some(whole), "case {case}: {text}");
        assert_eq!(
            found.sampled.as_ref().unwrap().certified,
            found.sampled.as_ref().unwrap().samples,
            "case {case}: {text}"
        );
        ranks.insert((n - strong, whole - strong));
    }
    assert!(ranks.len() > 4, "{ranks:?}");
}

/// Brockett's integrator, the unicycle, the car, cars with trailers (Laumond 1993: all are controllable), a body in space turned by two
/// torques, and what is not: a conserved quantity, a clock, a unicycle that does not turn.
#[test]
fn answers_that_are_known() {
    let trailers = |count: usize| {
        format!(
            "system \"trailers\" state x, y, th[0..{count}] angle th[0..{count}]\n\
             input drive x' = cos(th[0])*product(j in 1..{count}, cos(th[j] - th[j - 1]))\n\
             y' = sin(th[0])*product(j in 1..{count}, cos(th[j] - th[j - 1]))\n\
             th[i]' = sin(th[i + 1] - th[i])*product(j in i + 2..{count}, cos(th[j] - th[j - 1])) for i in 0..{last}\n\
             others' = 0\n\
             input turn th[{count}]' = 1 others' = 0\nsample x in [0, 1] y in [0, 1] th[0..{count}] in [-1, 1]",
            last = count - 1
        )
    };
    for (text, whole, strong) in [
        ("system \"Brockett\" state x, y, z input g x' = 1 z' = -y others' = 0 input h y' = 1 z' = x others' = 0".to_owned(), 3, 3),
        ("system \"unicycle\" state x, y, t angle t input g x' = cos(t) y' = sin(t) t' = 0 input h t' = 1 others' = 0".to_owned(), 3, 3),
        ("system \"it does not turn\" state x, y, t angle t input g x' = cos(t) y' = sin(t) t' = 0".to_owned(), 1, 1),
        ("system \"it turns by itself\" state x, y, t angle t drift f t' = 1 others' = 0 input g x' = cos(t) y' = sin(t) t' = 0".to_owned(), 3, 2),
        ("system \"a clock\" state t, x drift f t' = 1 x' = 0 input g x' = 1 t' = 0".to_owned(), 2, 1),
        ("system \"circles\" state x, y drift f x' = y y' = -x input g x' = x*y y' = -x^2".to_owned(), 1, 1),
        ("system \"no input\" state x, y drift f x' = y y' = -x".to_owned(), 1, 0),
        ("system \"Euler, two torques\" state w[1..3] param a = 1, b = -2, c = 1 drift f w[1]' = a*w[2]*w[3] w[2]' = b*w[1]*w[3] w[3]' = c*w[1]*w[2] input g w[1]' = 1 others' = 0 input h w[2]' = 1 others' = 0".to_owned(), 3, 3),
        // symmetric about the axis of the torque: the other two turn about it, and their length is kept
        ("system \"Euler, one torque on the axis\" state w[1..3] drift f w[1]' = w[2]*w[3] w[2]' = -w[1]*w[3] w[3]' = 0 input g w[3]' = 1 others' = 0".to_owned(), 2, 2),
        ("system \"a constant is not moved\" state x param k unknown drift f x' = k*x input g x' = 1".to_owned(), 1, 1),
        ("system \"an exponential\" state x, y drift f x' = exp(y) y' = 0 input g y' = 1 x' = 0".to_owned(), 2, 2),
        ("system \"short with functions\" state x, y, z drift f x' = exp(y)*z y' = 0 z' = 0 input g y' = 1 others' = 0".to_owned(), 2, 2),
        (trailers(1), 4, 4),
        (trailers(2), 5, 5),
        (trailers(4), 7, 7),
    ] {
        let text = if text.contains("sample") { text } else {
            let states = text.split("state ").nth(1).unwrap().split([' ', '\n']).take_while(|word| !["param", "drift", "input", "angle"].contains(word));
            let names: Vec<String> = states.map(|name| name.trim_end_matches(',').to_owned()).collect();
            let mut ranges: Vec<String> = names.iter().map(|name| format!("{name} in [1/2, 3/2]")).collect();
            if text.contains("unknown") { ranges.push("k in [1, 2]".to_owned()); }
            format!("{text} sample {}", ranges.join(" "))
        };
        let found = only(&text);
        assert_eq!((found.whole.rank(), found.strong.rank()), (Some(whole), Some(strong)), "{text}");
        assert!(found.sampled.as_ref().unwrap().rank_histogram.keys().all(|rank| *rank <= whole), "{text}");
        assert_eq!(found.sampled.as_ref().unwrap().samples, 20, "{text}");
    }
}

/// On a set that the fields leave, longer brackets may still raise the rank: Martinet's field needs one more where y = 0; on one that
/// they do not leave the rank that rests is known.
#[test]
fn special_sets_are_looked_at_by_themselves() {
    let martinet = "system \"Martinet\" state x, y, z input g x' = 1 z' = y^2 others' = 0 input h y' = 1 others' = 0\n\
                    sample x in [-1, 1] y in [1/2, 1] z in [-1, 1]";
    let around = only(martinet);
    assert_eq!((around.whole.rank(), around.order), (Some(3), 2));
    let on = answer(martinet, &["y = 0"]).branches.remove(0);
    assert_eq!((on.whole.rank(), on.order), (Some(3), 3));
    assert_eq!(on.sampled.as_ref().unwrap().rank_histogram.get(&3), Some(&20));

    let kept = "system \"a plane that is kept\" state x, y, z drift f x' = 0 y' = x^2 z' = y^2*x input g x' = x others' = 0\n\
                sample x in [1, 2] y in [1, 2] z in [1, 2]";
    assert_eq!(only(kept).whole.rank(), Some(3));
    let on = answer(kept, &["x = 0"]).branches.remove(0);
    assert_eq!((on.whole.rank(), on.strong.rank()), (Some(0), Some(0)));

    // a rank that is not known is not said to be one: x^4 needs brackets of five fields
    let mut system: System = "system \"order\" state x, y input g x' = 1 y' = 0 input h y' = x^4 x' = 0 sample x in [1, 2] y in [1, 2]".parse().unwrap();
    let question = RankQuestion {
        samples: 5,
        order: Some(1),
        conditions: vec!["x = 0".to_owned()],
        ..RankQuestion::default()
    };
    let found = answer_accessibility(&mut system, &question).unwrap();
    assert!(!found.is_final());
    assert_eq!((found.branches[0].whole.at_least, found.branches[0].whole.at_most), (1, 2));
}

#[test]
fn the_program_tells_it() {
    let folder = folder();
    let file = write(
        &folder,
        "a.proof",
        "system \"s\" state x, y, z drift f x' = y y' = x z' = 0 input g x' = 1 y' = 0 z' = 0 sample x in [1, 2] y in [1, 2] z in [1, 2]",
    );
    let file = file.to_str().unwrap();
    let text = palmistry(&["rank", file, "--accessible", "--samples", "10"]);
    assert_eq!(text.status.code(), Some(0));
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.contains("accessibility: generic rank 2 of 3 (no more, error probability below 2^-1"),
        "{text}"
    );
    assert!(text.contains("a combination of z; for one, dz = 0"), "{text}");
    let found = json(&palmistry(&["rank", file, "--accessible", "--samples", "10", "--json"]));
    let branch = &found["branches"][0];
    assert_eq!(
        (&branch["accessibility"]["rank"], &branch["strong_accessibility"]["rank"]),
        (&2.into(), &2.into())
    );
    assert_eq!(branch["brackets"], serde_json::json!(["g", "[f, g]"]));
    assert_eq!(found["dimension"], 3);
    // brackets of one field only: nothing is final
    let cut = palmistry(&["rank", file, "--accessible", "--samples", "10", "--order", "0"]);
    assert_eq!(cut.status.code(), Some(3));
    assert_eq!(palmistry(&["rank", file, "--accessible", "--digits", "9"]).status.code(), Some(2));
}

/// Where signs part the domain the rank of one part says nothing of another: x' = 2y where y is positive, and nought where it is not.
#[test]
fn parts_by_sign_have_ranks_of_their_own() {
    let mut system: System =
        "system \"s\" state x, y drift f x' = y + abs(y) y' = 0 input g x' = 0 y' = 1 output x \
                              sample y in [-2, 1] x in [-1, 1]"
            .parse()
            .unwrap();
    let answer =
        answer_accessibility(&mut system, &RankQuestion { samples: 30, ..RankQuestion::default() }).unwrap();
    let branch = &answer.branches[0];
    assert!(branch.whole.at_least <= 1, "{:?}", branch.whole);
    assert!(branch.sampled.as_ref().unwrap().rank_histogram.len() == 2);
}

/// Inequalities that leave a set of fewer dimensions, or nothing, and fields that exist on such a set alone.
#[test]
fn thin_sets_of_inequalities_and_domains() {
    let text = "system \"s\" state x, y drift f x' = y y' = 0 input g x' = y y' = 0 output x";
    for (condition, ranks) in [
        ("y = 0", Some([0, 0])),
        ("y >= 0, y <= 0", Some([0, 0])),
        ("y^2 <= 0", Some([0, 0])),
        ("x^2 + y^2 <= 0", Some([0, 0])),
        ("y >= 1", Some([1, 1])),
        ("y > 1, y < 0", None),
    ] {
        let mut system: System = text.parse().unwrap();
        let conditions = vec![condition.to_owned()];
        let question = RankQuestion { samples: 0, conditions, ..RankQuestion::default() };
        let found = answer_accessibility(&mut system, &question);
        let found = found.ok().map(|answer| {
            let branch = &answer.branches[0];
            [branch.whole, branch.strong].map(|bounds| bounds.rank().unwrap())
        });
        assert_eq!(found, ranks, "{condition}");
    }
    let assumed = "system \"s\" state x, y param m drift f x' = y*m y' = 0 input g x' = y*m y' = 0 output x assume m >= 0, m <= 0";
    assert_eq!(only(assumed).whole.rank(), Some(0));
    for drift in ["m*y + sqrt(m) + sqrt(-m)", "m*y + log(-1 - y^2)"] {
        let text = format!(
            "system \"s\" state x, y param m drift f x' = {drift} y' = 0 input g x' = 0 y' = 1 output x"
        );
        let mut system: System = text.parse().unwrap();
        let question = RankQuestion { samples: 0, ..RankQuestion::default() };
        let why =
            answer_accessibility(&mut system, &question).map(|answer| answer.branches.len()).unwrap_err();
        assert!(why.to_string().contains("derivatives"), "{why}");
    }
}
