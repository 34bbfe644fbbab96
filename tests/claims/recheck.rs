//! The checker against verdicts that are worked out by hand, and against files that were tampered with.

use crate::common::{folder, json as printed_json, palmistry, write};
use palmistry::checker::{Doubt, Effort, Evidence, Finding, VerdictFile};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

/// A file of one verdict, whose evidence is looked at by itself.
fn file(evidence: Value) -> Value {
    let asked = json!({"what": "equation", "claimed": "", "sense": "always", "where": "", "except": ""});
    let verdict = json!({"file": "by hand", "digest": "", "id": "1", "statement": "", "asked": asked, "verdict": "found",
        "evidence": evidence});
    json!({"schema": "palmistry-verdicts", "version": 4, "tool": "by hand", "seed": 1, "verdicts": [verdict]})
}

/// What the check of the evidence of a file of one verdict comes to, whatever claim it is filed under.
fn check(file: &Value) -> Finding {
    let file = VerdictFile::read(&file.to_string()).unwrap_or_else(|why| panic!("{why}"));
    let [record] = file.verdicts.as_slice() else { panic!("{} verdicts", file.verdicts.len()) };
    record.evidence.check_alone(1, &Effort::default(), &false.into())
}

/// In words, why a file is refused.
fn doubt(file: &Value) -> String {
    match VerdictFile::read(&file.to_string()) {
        Err(why) => why.to_string(),
        Ok(_) => match check(file) {
            Finding::NotConfirmed(doubt) => doubt.to_string(),
            other => panic!("{other:?}"),
        },
    }
}

fn number(text: &str) -> Value {
    json!({ "number": text })
}

/// `x^2 = 2 x where y = x`, with the requirement that `y` is not zero, refuted at x = y = 3: 9 and 6.
fn squares() -> Value {
    file(json!({"refuted": {
        "listing": [["symbol", "x"], ["symbol", "y"], ["power", 0, 2], ["const", "2"], ["mul", 3, 0], ["sub", 1, 0],
            ["const", "0"]],
        "state": {"x": number("3"), "y": number("3")},
        "sides": {"left": 2, "right": 4},
        "conditions": [{"left": 5, "right": 6}],
        "requirements": [{"kind": "not_zero", "step": 1}],
        "printed": {"left": "9", "right": "6"},
    }}))
}

#[test]
fn a_refutation_is_evaluated_again_and_each_part_of_it_counts() {
    let whole = squares();
    assert_eq!(check(&whole), Finding::Confirmed { times: 1 });
    let base = "/verdicts/0/evidence/refuted";
    for (place, other, why) in [
        ("/state/x/number", json!("4"), "condition 0 is not met"),
        ("/state/y/number", json!("31/10"), "condition 0 is not met"),
        ("/state/x", json!({"angle": {"sin": "1/2", "cos": "1/2"}}), "squares do not add up to one"),
        ("/state/x", json!({"step": 4}), "does not come before"),
        ("/sides/left", json!(4), "the two sides are equal"),
        ("/sides/left", json!(700), "does not come before"),
        ("/conditions/0/right", json!(0), "condition 0 is not met"),
        ("/requirements/0/step", json!(6), "requirement 0 is not met"),
        ("/requirements/0/kind", json!("inside_one"), "requirement 0 is not met"),
        ("/printed/left", json!("9.1"), "the left side is not what is printed"),
        ("/printed/right", json!("19/3"), "the right side is not what is printed"),
        ("/printed/right", json!("between about 5 and 7"), "cannot be shown to be what is printed"),
        ("/listing/2/2", json!(1), "the left side is not what is printed"),
        ("/listing/2/1", json!(2), "does not come before"),
        ("/listing/3/1", json!("3"), "the two sides are equal"),
        ("/listing/0/1", json!("z"), "names a symbol that the state does not give"),
        ("/listing/2", json!(["power", 0, -1]), "the left side is not what is printed"),
        ("/listing/2", json!(["div", 0, 2]), "does not come before"),
        ("/listing/4", json!(["mul", 3]), "lacks an operand"),
        ("/listing/4", json!(["mul", 3, 0, 0]), "an operand too many"),
        ("/listing/4", json!(["times", 3, 0]), "no such operation"),
        ("/listing/4", json!(["apply", "tan", 0]), "no such function"),
        ("/state/x/number", json!("3/0"), "a number is written as digits"),
        ("/state/x/number", json!("3e0"), "a number is written as digits"),
    ] {
        let mut tampered = whole.clone();
        let part = tampered.pointer_mut(&format!("{base}{place}")).expect("the part is there");
        *part = other.clone();
        let said = doubt(&tampered);
        assert!(said.contains(why), "{place} as {other}: {said}");
    }
}

/// `x = 3/2 where x^2 = 2` at the square root of two, and `(pi + 1)(1 - cos(phi)) = pi (1 - cos(phi)) where sin(phi) = 0` at
/// phi = pi, where the sides are 2 pi + 2 and 2 pi: witnesses that are no fractions.
#[test]
fn conditions_hold_exactly_at_roots_and_at_turns() {
    let root = file(json!({"refuted": {
        "listing": [["const", "2"], ["apply", "sqrt", 0], ["symbol", "x"], ["power", 2, 2], ["const", "3/2"]],
        "state": {"x": {"step": 1}},
        "sides": {"left": 2, "right": 4},
        "conditions": [{"left": 3, "right": 0}],
        "requirements": [{"kind": "positive", "step": 2}],
        "printed": {"left": "1.4142135623730950488", "right": "3/2"},
    }}));
    assert_eq!(check(&root), Finding::Confirmed { times: 1 });
    let mut other = root.clone();
    other["verdicts"][0]["evidence"]["refuted"]["printed"]["left"] = json!("1.4142135623730950489");
    assert!(doubt(&other).contains("the left side is not what is printed"));
    // no double tells this number from the root of two, and no enclosure: only the exact square does
    let near = "1767766952966368811002110905262/1250000000000000000000000000000";
    other = root.clone();
    other["verdicts"][0]["evidence"]["refuted"]["state"]["x"] = number(near);
    assert!(doubt(&other).contains("condition 0 is not met"));

    let turn = file(json!({"refuted": {
        "listing": [["pi"], ["symbol", "phi"], ["apply", "sin", 1], ["apply", "cos", 1], ["const", "1"], ["sub", 4, 3],
            ["add", 0, 4], ["mul", 6, 5], ["mul", 0, 5], ["const", "0"]],
        "state": {"phi": {"step": 0}},
        "sides": {"left": 7, "right": 8},
        "conditions": [{"left": 2, "right": 9}],
        "requirements": [],
        // mpmath 1.3: 2 pi + 2, 2 pi
        "printed": {"left": "8.2831853071795864769", "right": "6.2831853071795864769"},
    }}));
    assert_eq!(check(&turn), Finding::Confirmed { times: 1 });
    // a double near pi does not meet the condition
    let mut other = turn;
    other["verdicts"][0]["evidence"]["refuted"]["state"]["phi"] = number("884279719003555/281474976710656");
    assert!(doubt(&other).contains("condition 0 is not met"));
}

/// A side that does not exist at the state refutes nothing: `x/(x - x)` and `log(x - x)`.
#[test]
fn what_does_not_exist_does_not_differ() {
    for (step, why) in
        [(json!(["div", 0, 1]), "division by zero"), (json!(["apply", "log", 1]), "outside its domain")]
    {
        let file = file(json!({"refuted": {
            "listing": [["symbol", "x"], ["sub", 0, 0], step],
            "state": {"x": number("3")}, "sides": {"left": 0, "right": 2}, "conditions": [], "requirements": [],
            "printed": {"left": "3", "right": "0"},
        }}));
        let said = doubt(&file);
        assert!(said.contains(why), "{said}");
    }
}

/// What is not shown is not said: `exp(1)^2 = exp(2)` as a condition is true, and the checker has no rule for it; it has one for
/// `sin(1)^2 + cos(1)^2 = 1`.
#[test]
fn a_condition_that_is_not_shown_confirms_nothing() {
    let refuted = |listing: Value, condition: [usize; 2], sides: [usize; 2]| {
        file(json!({"refuted": {
            "listing": listing,
            "state": {},
            "sides": {"left": sides[0], "right": sides[1]},
            "conditions": [{"left": condition[0], "right": condition[1]}],
            "requirements": [],
            "printed": {"left": "1", "right": "2"},
        }}))
    };
    let exponentials =
        json!([["const", "1"], ["apply", "exp", 0], ["power", 1, 2], ["const", "2"], ["apply", "exp", 3]]);
    assert!(doubt(&refuted(exponentials, [2, 4], [0, 3])).contains("condition 0 cannot be shown"));
    let circle = json!([
        ["const", "1"],
        ["apply", "sin", 0],
        ["apply", "cos", 0],
        ["power", 1, 2],
        ["power", 2, 2],
        ["add", 3, 4],
        ["const", "2"]
    ]);
    assert_eq!(check(&refuted(circle, [5, 0], [0, 6])), Finding::Confirmed { times: 1 });
}

/// `(x + 1)^2 = x^2 + 2 x + 1` is consistent; `x^2 = x`, true at the state x = 1 that the file gives, is not; and
/// `3.14 = pi within 0.002` is confirmed.
#[test]
fn a_proof_is_tried_at_states_of_the_checkers_choice() {
    let stated = |right: usize, state: &str| {
        file(json!({"proved": {
            "listing": [["symbol", "x"], ["const", "1"], ["add", 0, 1], ["power", 2, 2], ["power", 0, 2], ["const", "2"],
                ["mul", 5, 0], ["add", 4, 6], ["add", 7, 1]],
            "state": {"x": number(state)},
            "sides": [{"left": if right == 8 { 3 } else { 4 }, "right": right}],
            "conditions": [], "requirements": [{"kind": "positive", "step": 0}],
            "engine": "by hand", "log2_error": null, "degree": 2.0,
        }}))
    };
    assert!(matches!(check(&stated(8, "1")), Finding::Consistent { states } if states >= 5));
    assert_eq!(check(&stated(0, "1")), Finding::NotConfirmed(Doubt::Differ));
    assert_eq!(check(&stated(8, "-1")), Finding::NotConfirmed(Doubt::RequirementNotMet(0)));
    let near = |tolerance: &str| {
        file(json!({"proved": {
            "listing": [["const", "157/50"], ["pi"], ["const", tolerance]],
            "state": {}, "sides": [{"left": 0, "right": 1}], "within": 2, "conditions": [], "requirements": [],
            "engine": "by hand", "log2_error": null, "degree": null,
        }}))
    };
    assert_eq!(check(&near("1/500")), Finding::Confirmed { times: 1 });
    assert_eq!(check(&near("1/1000")), Finding::NotConfirmed(Doubt::Differ));
}

/// The differentials of `x y` and of its derivative along x' = y, y' = x, which is `x^2 + y^2`: rows (y, x), (2 x, 2 y), the
/// determinant 2 y^2 - 2 x^2. The rank is 2 at (2, 1), 1 at (1, 1) and 0 at the origin.
fn products(x: &str, y: &str, rank: usize, minor: Value, kernel: Value) -> Value {
    file(json!({"rank": {
        "listing": [["symbol", "x"], ["symbol", "y"], ["const", "2"], ["mul", 2, 0], ["mul", 2, 1]],
        "columns": ["x", "y"], "row_names": ["x*y", "Lf x*y"], "rows": [[1, 0], [3, 4]],
        "requirements": [{"kind": "not_negative", "step": 0}],
        "states": [{"state": {"x": number(x), "y": number(y)}, "rank": rank, "minor": minor, "kernel": kernel}],
    }}))
}

/// Of the same rows: "the rank is 2 at almost all states" is confirmed by one minor, "it is 1" refuted by the same; that it
/// is 1 of the first row alone, too. A proof that it is 1 by the state (1, 1) is found wrong at another state.
#[test]
fn a_claim_about_a_rank_is_tried_at_other_states() {
    let claimed = |at: &str, rank: usize, claimed: usize, word: &str| {
        let places: Vec<usize> = (0..rank).collect();
        let minor = json!({"rows": places, "columns": places});
        let mut file = products(at, "1", rank, minor, json!([]));
        let matrix = file["verdicts"][0]["evidence"]["rank"].take();
        file["verdicts"][0]["evidence"] = json!({"claimed_rank": {
            "matrix": matrix, "claimed": claimed, "word": word, "engine": "by hand", "log2_error": null,
        }});
        check(&file)
    };
    assert_eq!(claimed("2", 2, 2, "proved"), Finding::Confirmed { times: 1 });
    assert_eq!(claimed("2", 2, 1, "refuted"), Finding::Confirmed { times: 1 });
    let greater = Finding::NotConfirmed(Doubt::GreaterRank { found: 2, stated: 1 });
    assert_eq!(claimed("1", 1, 1, "proved"), greater);
    assert_eq!(claimed("1", 1, 2, "refuted"), greater);
    assert_eq!(claimed("1", 2, 2, "proved"), Finding::NotConfirmed(Doubt::MinorVanishes(0)));
    for (rank, of, word) in [(2, 1, "proved"), (2, 2, "refuted")] {
        let found = claimed("2", rank, of, word);
        assert_eq!(found, Finding::NotConfirmed(Doubt::OtherRank { found: rank, claimed: of }));
    }
}

#[test]
fn a_rank_is_confirmed_by_its_minor_and_its_kernel_alone() {
    let whole = json!({"rows": [1, 0], "columns": [0, 1]});
    let one = json!({"rows": [0], "columns": [1]});
    let none = json!({"rows": [], "columns": []});
    assert_eq!(check(&products("2", "1", 2, whole.clone(), json!([]))), Finding::Confirmed { times: 1 });
    assert_eq!(
        check(&products("1", "1", 1, one.clone(), json!([["-1", "1"]]))),
        Finding::Confirmed { times: 1 }
    );
    let all = json!([["1", "0"], ["1", "1"]]);
    assert_eq!(check(&products("0", "0", 0, none.clone(), all)), Finding::Confirmed { times: 1 });
    for (x, y, rank, minor, kernel, why) in [
        // a certificate of rank 2 at the origin, as issue 10 found it
        ("0", "0", 2, &whole, json!([]), "the minor of state 0 vanishes"),
        ("1", "1", 2, &whole, json!([]), "the minor of state 0 vanishes"),
        ("1", "1", 1, &one, json!([["1", "1"]]), "row 0 does not annihilate vector 0"),
        ("1", "1", 1, &one, json!([["0", "0"]]), "not independent"),
        ("1", "1", 1, &one, json!([]), "0 vectors instead of 1"),
        ("1", "1", 1, &one, json!([["1"]]), "not all have an entry a column"),
        // the first row is (1, 2) there, and the second one (4, 2)
        ("2", "1", 1, &one, json!([["-2", "1"]]), "row 1 does not annihilate"),
        ("0", "0", 0, &none, json!([["1", "0"], ["2", "0"]]), "not independent"),
        ("2", "1", 2, &json!({"rows": [0, 0], "columns": [0, 1]}), json!([]), "2 different rows and columns"),
        ("2", "1", 2, &json!({"rows": [0, 2], "columns": [0, 1]}), json!([]), "2 different rows and columns"),
        ("2", "1", 3, &whole, json!([]), "3 different rows and columns"),
        ("-2", "1", 2, &whole, json!([]), "requirement 0 is not met"),
    ] {
        let said = doubt(&products(x, y, rank, minor.clone(), kernel.clone()));
        assert!(said.contains(why), "rank {rank} at {x}, {y}: {said}");
    }
}

/// Matrices of a known rank: a product of two random integer matrices has at most the rank of its inner size, and here the
/// kernel and a minor follow from how they are made. Every certificate of another rank is refused.
#[test]
fn random_matrices_have_the_rank_that_they_are_made_with_and_no_other() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let (mut confirmed, mut refused) = (0, 0);
    for _ in 0..200 {
        let (height, width) = (rng.random_range(1..=5usize), rng.random_range(1..=5usize));
        let rank = rng.random_range(0..=height.min(width));
        // the first rows and columns are a unit matrix: (I B; A A B) has this rank, and (-B; I) is its kernel
        let mut random = |h: usize, w: usize| -> Vec<Vec<i64>> {
            (0..h).map(|_| (0..w).map(|_| rng.random_range(-3..=3)).collect()).collect()
        };
        let (a, b) = (random(height - rank, rank), random(rank, width - rank));
        let unit = |i: usize, j: usize| i64::from(i == j);
        let upper = |i: usize, j: usize| if j < rank { unit(i, j) } else { b[i][j - rank] };
        let entry = |i: usize, j: usize| match i.checked_sub(rank) {
            None => upper(i, j),
            Some(below) => (0..rank).map(|k| a[below][k] * upper(k, j)).sum(),
        };
        let mut listing = Vec::new();
        let rows: Vec<Vec<usize>> = (0..height)
            .map(|i| {
                (0..width)
                    .map(|j| {
                        listing.push(json!(["const", entry(i, j).to_string()]));
                        listing.len() - 1
                    })
                    .collect()
            })
            .collect();
        let vector = |free: usize| -> Vec<String> {
            let part = |j: usize| if j < rank { -b[j][free] } else { unit(j - rank, free) };
            (0..width).map(|j| part(j).to_string()).collect()
        };
        let kernel: Vec<Vec<String>> = (0..width - rank).map(vector).collect();
        let places: Vec<usize> = (0..rank).collect();
        let certificate = |rank: usize, minor: &[usize], kernel: &[Vec<String>]| {
            file(json!({"rank": {
                "listing": listing, "columns": vec!["x"; width], "row_names": vec!["w"; height], "rows": rows,
                "requirements": [],
                "states": [{"state": {}, "rank": rank, "minor": {"rows": minor, "columns": minor}, "kernel": kernel}],
            }}))
        };
        assert_eq!(check(&certificate(rank, &places, &kernel)), Finding::Confirmed { times: 1 });
        confirmed += 1;
        if rank < height.min(width) {
            let more: Vec<usize> = (0..=rank).collect();
            doubt(&certificate(rank + 1, &more, &kernel[1..]));
            refused += 1;
        }
        if rank > 0 {
            let mut longer = kernel.clone();
            longer.push(vec!["1".to_owned(); width]);
            doubt(&certificate(rank - 1, &places[1..], &longer));
            refused += 1;
        }
    }
    assert_eq!(confirmed, 200);
    assert!(refused > 200, "{refused}");
}

/// Files that ask for more than a check may take end with a sentence, soon.
#[test]
fn no_file_fills_the_memory() {
    let refuted = |listing: Vec<Value>| {
        let last = listing.len() - 1;
        file(json!({"refuted": {
            "listing": listing, "state": {"x": number("3/2")}, "sides": {"left": last, "right": 0}, "conditions": [],
            "requirements": [], "printed": {"left": "1", "right": "3/2"},
        }}))
    };
    let mut squares = vec![json!(["symbol", "x"])];
    squares.extend((0..20_000).map(|place| json!(["mul", place, place])));
    let mut exponentials = vec![json!(["symbol", "x"])];
    exponentials.extend((0..2_000).map(|place| json!(["apply", "exp", place])));
    let mut sums = vec![json!(["symbol", "x"]), json!(["pi"])];
    sums.extend((1..400).map(|place| json!(["add", place, 0])));
    sums.push(json!(["power", 400, 2_147_483_647]));
    for (what, listing) in [("squares", squares), ("exponentials", exponentials), ("sums", sums)] {
        let said = doubt(&refuted(listing));
        assert!(said.contains("operation") || said.contains("distinguished"), "{what}: {said}");
    }
    let record = refuted(vec![json!(["symbol", "x"]), json!(["mul", 0, 0])]);
    let file = VerdictFile::read(&record.to_string()).expect("it is read");
    let finding = file.verdicts[0].evidence.check_alone(1, &Effort::new(1), &false.into());
    let Finding::NotConfirmed(doubt) = &finding else { panic!("{finding:?}") };
    assert!(doubt.to_string().contains("too much work"));
    assert_eq!(finding.word(), "not checked");
    // sums of long fractions, each of which is fast and longer than the one before
    let mut sums = vec![json!(["symbol", "x"])];
    for place in 0..10_000usize {
        sums.push(json!(["const", format!("1/{}{}1", place + 1, "7".repeat(300))]));
        sums.push(json!(["add", 2 * place, 2 * place + 1]));
    }
    let begin = std::time::Instant::now();
    let file = VerdictFile::read(&refuted(sums).to_string()).expect("it is read");
    let finding = file.verdicts[0].evidence.check_alone(1, &Effort::new(1 << 27), &false.into());
    assert_eq!(finding.word(), "not checked", "{finding:?}");
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

#[test]
fn what_is_no_verdict_file_is_told_why() {
    let text = squares().to_string();
    for end in (0..text.len()).step_by(7) {
        assert!(VerdictFile::read(&text[..end]).is_err(), "cut at {end}");
    }
    for (part, other, why) in [
        ("/schema", json!("verdicts"), "its schema is 'verdicts'"),
        ("/version", json!(3), "write it anew"),
        ("/version", json!(5), "its version is 5"),
        ("/version", json!(-1), "no verdict file"),
        ("/verdicts/0/evidence", json!({"sworn": {}}), "unknown variant"),
        ("/verdicts/0/evidence/refuted/listing", json!([["symbol", ""]]), "operation 0"),
    ] {
        let mut file = squares();
        *file.pointer_mut(part).expect("the part is there") = other;
        assert!(doubt(&file).contains(why), "{part}: {}", doubt(&file));
    }
    let mut file = squares();
    file["verdicts"][0]["evidence"]["refuted"]["remark"] = json!("trust me");
    assert!(doubt(&file).contains("unknown field"));
    let deep = "[".repeat(100_000);
    assert!(VerdictFile::read(&deep).is_err());
}

/// Random bytes of a file are replaced: whatever is read is checked without a panic.
#[test]
fn no_damage_makes_it_panic() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let one = json!({"rows": [0], "columns": [1]});
    let whole = [squares(), products("1", "1", 1, one, json!([["-1", "1"]]))].map(|file| file.to_string());
    let (mut read, mut confirmed) = (0, 0);
    for round in 0..6_000 {
        let mut bytes = whole[round % 2].clone().into_bytes();
        for _ in 0..rng.random_range(1..=2) {
            let at = rng.random_range(0..bytes.len());
            let letters = b"0123456789-/\"[]{},:aemnst";
            bytes[at] = letters[rng.random_range(0..letters.len())];
        }
        let Ok(text) = String::from_utf8(bytes) else { continue };
        let Ok(file) = VerdictFile::read(&text) else { continue };
        read += 1;
        let alone = |evidence: &Evidence| evidence.check_alone(1, &Effort::new(1 << 24), &false.into());
        let is_confirmed = |evidence: &Evidence| matches!(alone(evidence), Finding::Confirmed { .. });
        confirmed += file.verdicts.iter().filter(|record| is_confirmed(&record.evidence)).count();
    }
    assert!(read > 200 && confirmed > 10 && confirmed < read, "{read} were read, {confirmed} confirmed");
}

const PENDULUM: &str = r#"
system "A pendulum whose angle is measured, and a clock that nobody sees"
state phi, omega, tau
angle phi
param k = 2
drift f
  phi'   = omega
  omega' = -k*sin(phi)
  tau'   = 1
output phi
sample
  phi in [-3, 3]
  omega in [-1, 1]
  tau in [0, 1]
"#;

/// The ranks of shipped files and of a system whose rank is short, through the program and back.
#[test]
fn ranks_go_through_a_file_and_back() {
    let folder = folder();
    let pendulum = write(&folder, "pendulum.proof", PENDULUM);
    let pendulum = pendulum.to_string_lossy().into_owned();
    let verdicts = folder.path().join("verdicts.json").to_string_lossy().into_owned();
    for (file, rank) in [
        (pendulum.as_str(), 2),
        ("proofs/moll2002/fixed_palms.proof", 5),
        ("proofs/moll2002/general.proof", 10),
    ] {
        let ranked = palmistry(&[
            "rank",
            file,
            "--samples",
            "300",
            "--verdicts",
            &verdicts,
            "--verdict-states",
            "40",
            "--json",
        ]);
        assert!(ranked.status.success(), "{}", String::from_utf8_lossy(&ranked.stderr));
        let output = palmistry(&["recheck", &verdicts, "--json"]);
        let found = printed_json(&output);
        assert_eq!(output.status.code(), Some(0), "{found}");
        assert_eq!(found["not_confirmed"], 0);
        // that a rank is no greater, no finite number of Lie derivatives shows
        assert_eq!(found["half_confirmed"].as_u64() > Some(0), rank == 2, "{found}");
        assert!(found["confirmed"].as_u64() > Some(0) || rank == 2);
        let text = std::fs::read_to_string(&verdicts).expect("the file is there");
        let read = VerdictFile::read(&text).expect("it is read");
        let Evidence::Rank(certified) = &read.verdicts[0].evidence else { panic!("no rank") };
        assert_eq!(certified.states.len(), 40);
        assert!(certified.states.iter().all(|state| state.rank == rank), "{file}");
        // another rank is refused, at any state
        for at in [0, 39] {
            let mut tampered: Value = serde_json::from_str(&text).expect("it is JSON");
            tampered["verdicts"][0]["evidence"]["rank"]["states"][at]["rank"] = json!(rank - 1);
            std::fs::write(&verdicts, tampered.to_string()).expect("it is written");
            let output = palmistry(&["recheck", &verdicts]);
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            assert_eq!(output.status.code(), Some(1), "{text}");
            assert!(text.contains("NOT CONFIRMED") && text.contains(&format!("state {at}")), "{text}");
        }
    }
}

#[test]
fn what_cannot_be_read_ends_with_status_two() {
    let folder = folder();
    let broken = write(&folder, "broken.json", "{\"schema\": \"palmistry-verdicts\"");
    let path = folder.path().to_string_lossy().into_owned();
    for file in
        [broken.to_string_lossy().into_owned(), path, "nowhere.json".to_owned(), "/dev/zero".to_owned()]
    {
        let output = palmistry(&["recheck", &file, "--json"]);
        assert_eq!(output.status.code(), Some(2), "{file}");
        assert!(
            printed_json(&output)["error"]["message"].as_str().is_some_and(|why| why.contains(&file)),
            "{file}"
        );
    }
}

/// Claims of the thesis through the program and back: every refutation is confirmed, and none is after its sides were made one,
/// what is printed was changed, or a value of the witness was taken away.
#[test]
fn claims_go_through_a_file_and_back() {
    let folder = folder();
    let verdicts = folder.path().join("verdicts.json").to_string_lossy().into_owned();
    let files = ["proofs/moll2002/chapter3_balance.proof", "proofs/moll2002/appendix_a1.proof"];
    let proved = palmistry(&["prove", files[0], files[1], "--verdicts", &verdicts]);
    assert!(proved.status.success(), "{}", String::from_utf8_lossy(&proved.stdout));
    let output = palmistry(&["recheck", &verdicts, "--json"]);
    let found = printed_json(&output);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let of = |kind: &str, finding: &str| {
        let list = found["verdicts"].as_array().expect("a list");
        list.iter().filter(|verdict| verdict["kind"] == kind && verdict["finding"] == finding).count()
    };
    assert!(of("refuted", "confirmed") >= 10 && of("proved", "confirmed") >= 60, "{found}");
    // three inequalities are tried at states
    assert_eq!(of("proved", "consistent"), 3, "{found}");
    assert_eq!(found["not_confirmed"], 0);

    let text = std::fs::read_to_string(&verdicts).expect("the file is there");
    let whole: Value = serde_json::from_str(&text).expect("it is JSON");
    let tamper: [fn(&mut Value); 3] = [
        |refuted| refuted["sides"]["right"] = refuted["sides"]["left"].clone(),
        |refuted| refuted["printed"]["left"] = json!("123456789/7"),
        |refuted| refuted["state"] = json!({}),
    ];
    let mut tampered = 0;
    for index in 0..whole["verdicts"].as_array().map_or(0, Vec::len) {
        let verdict = &whole["verdicts"][index];
        // without symbols there is no witness to be taken away
        if verdict["evidence"]["refuted"]["state"].as_object().is_none_or(serde_json::Map::is_empty) {
            continue;
        }
        for change in tamper {
            let mut file = whole.clone();
            file["verdicts"] = json!([verdict]);
            change(&mut file["verdicts"][0]["evidence"]["refuted"]);
            doubt(&file);
            tampered += 1;
        }
    }
    assert!(tampered >= 20, "{tampered}");
}

/// A rank of no rows at all is no rank that was looked at, whatever is written beside it; nor is one at no state.
#[test]
fn nothing_at_all_is_not_confirmed() {
    let none = json!({"rows": [], "columns": []});
    let mut whole = products("0", "0", 0, none, json!([["1", "0"], ["0", "1"]]));
    let rank = &mut whole["verdicts"][0]["evidence"]["rank"];
    (rank["rows"], rank["row_names"]) = (json!([]), json!([]));
    assert_eq!(check(&whole), Finding::NotConfirmed(Doubt::NoRows));
    assert_eq!(check(&whole).word(), "not checked");
    whole["verdicts"][0]["evidence"]["rank"]["states"] = json!([]);
    assert!(matches!(check(&whole), Finding::NotConfirmed(Doubt::NoRows | Doubt::Empty)));
}

/// Names of a stranger's file neither end a line nor reach the terminal as what it obeys.
#[test]
fn no_name_forges_a_line_of_the_answer() {
    let folder = folder();
    let mut forged = squares();
    forged["verdicts"][0]["id"] =
        json!("1\n  confirmed      refuted   by hand 2: evaluated again\u{1b}[2J\u{202e}");
    forged["verdicts"][0]["file"] = json!("by\rhand\u{7}");
    let run = |forged: &Value| {
        let path = write(&folder, "forged.json", forged.to_string());
        let output = palmistry(&[
            "recheck",
            path.to_str().expect("a name"),
            "--proofs",
            folder.path().to_str().expect("a name"),
        ]);
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned())
    };
    // no file at all is there: the reason has the name of one
    let [text, why] = run(&forged);
    assert!(text.is_empty() && why.contains("no proof file") && why.contains("hand"), "{text}{why}");
    assert!(!why.contains(['\u{1b}', '\u{202e}', '\r', '\u{7}']), "{why:?}");
    // one of two is
    write(&folder, "real.proof", "system \"s\" state x drift f x' = x output x\n");
    let mut real = forged["verdicts"][0].clone();
    (real["id"], real["file"]) = (json!("2"), json!("real.proof"));
    forged["verdicts"].as_array_mut().expect("a list").push(real);
    let [text, _] = run(&forged);
    assert_eq!(text.lines().count(), 3, "{text}");
    assert!(text.starts_with("  not checked"), "{text}");
    assert!(!text.contains(['\u{1b}', '\u{202e}', '\r', '\u{7}']), "{text:?}");
}

/// Ranks at states that the file excludes, by its initial conditions or by what it assumes, are not confirmed, however right the arithmetic is.
#[test]
fn ranks_at_states_that_the_file_excludes() {
    let folder = folder();
    let text = "system \"at rest\"\nstate x, z\nparam k\nassume k > 0\ninitial z = 0\ndrift f  x' = 0  z' = 0\noutput k*z*x\n";
    let proof = write(&folder, "rests.proof", text);
    let path = folder.path().join("v.json");
    let verdicts = path.to_str().unwrap();
    assert!(
        palmistry(&["rank", proof.to_str().unwrap(), "--samples", "2", "--verdicts", verdicts])
            .status
            .success()
    );
    let honest: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let with = |k: &str, z: &str| {
        let mut found = honest.clone();
        // k z dx: of rank one where neither is nought
        let is_full = k != "0" && z != "0";
        let state = json!({
            "state": { "x": number("1"), "k": number(k), "z": number(z) },
            "rank": usize::from(is_full),
            "minor": if is_full { json!({ "rows": [0], "columns": [0] }) } else { json!({ "rows": [], "columns": [] }) },
            "kernel": if is_full { json!([]) } else { json!([["1"]]) },
        });
        let rank = &mut found["verdicts"][0]["evidence"]["rank"];
        rank["listing"] = json!([["symbol", "z"], ["symbol", "k"], ["mul", 1, 0]]);
        (rank["rows"], rank["row_names"], rank["states"]) = (json!([[2]]), json!(["k*z*x"]), json!([state]));
        std::fs::write(&path, found.to_string()).unwrap();
        let checked = palmistry(&["recheck", verdicts]);
        (checked.status.code(), String::from_utf8_lossy(&checked.stdout).into_owned())
    };
    for (k, z, confirmed) in [("1", "0", true), ("1", "1", false), ("-1", "0", false), ("-1", "1", false)] {
        let (code, text) = with(k, z);
        assert_eq!(code, Some(if confirmed { 0 } else { 1 }), "k = {k}, z = {z}: {text}");
    }
}

/// A root that cancels leaves single states: what is not zero at one of them is not generically not zero. By hand, at x = 1 both ranks are 0.
#[test]
fn a_root_that_cancels_leaves_single_states() {
    let folder = folder();
    let path = folder.path().join("v.json");
    let verdicts = path.to_str().unwrap();
    let model = "system \"s\"\nstate x, y\ndrift f\n  others' = 0\noutput x\nclaim a: rank([1 - x]) = 1\nclaim b: rank([1 - x, y]) = 1\n";
    let proof = write(&folder, "s.proof", model);
    assert!(palmistry(&["prove", proof.to_str().unwrap(), "--verdicts", verdicts]).status.success());
    let thin = model
        .replace("rank([1 - x])", "rank([1 - x + 0*sqrt(-(x^2 - x)^2)])")
        .replace("rank([1 - x, y])", "rank([1 - x, 0*sqrt(-(x^2 - x)^2)])");
    write(&folder, "s.proof", &thin);
    let mut found: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    for verdict in found["verdicts"].as_array_mut().unwrap() {
        let id = verdict["id"].as_str().unwrap();
        let statement = thin.lines().find_map(|line| line.strip_prefix(&format!("claim {id}: "))).unwrap();
        verdict["statement"] = json!(statement);
        verdict["digest"] = json!(palmistry::checker::source_digest(&thin));
        let state = &mut verdict["evidence"]["claimed_rank"]["matrix"]["states"][0]["state"];
        state["x"] = number("0");
    }
    std::fs::write(&path, found.to_string()).unwrap();
    let checked = printed_json(&palmistry(&["recheck", verdicts, "--json"]));
    for verdict in checked["verdicts"].as_array().unwrap() {
        let finding = verdict["finding"].as_str().unwrap();
        assert!(matches!(finding, "half confirmed" | "consistent" | "not checked"), "{checked}");
    }
}
