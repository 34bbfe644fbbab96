//! Story 3: did my derivation survive the edit?

use crate::common::{folder, json, palmistry, with_threads, without_times, write};
use palmistry::{System, Verdict, decide_all};
use serde_json::Value;
use std::path::Path;
use std::sync::LazyLock;

/// All claims that come with the program, decided once for all tests that look at them.
pub(crate) fn all_claims() -> &'static Value {
    static ALL: LazyLock<Value> = LazyLock::new(|| {
        let output = with_threads(&["prove", "proofs", "--json"], Some("2"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        json(&output)
    });
    &ALL
}

/// Those of the thesis, and of the papers in its folder.
pub(crate) fn claims_of_the_thesis() -> Vec<&'static Value> {
    let all = all_claims()["claims"].as_array().unwrap();
    all.iter().filter(|claim| claim["file"].as_str().unwrap().contains("moll2002/")).collect()
}

#[test]
fn all_files_are_as_they_say() {
    for claim in all_claims()["claims"].as_array().unwrap() {
        assert_eq!(claim["ok"], true, "{claim}");
        assert_eq!(claim["verdict"], claim["expected"], "{claim}");
        let word = claim["verdict"].as_str().unwrap();
        if ["definition", "undecided"].contains(&word) {
            continue;
        }
        assert!(claim["engine"].is_string(), "{claim}");
        match word {
            "proved" | "holds by definition" | "consequence" | "example" => {
                assert!(claim["error_bound"].is_string(), "{claim}");
            }
            "refuted" => assert!(claim["witness"].is_object(), "{claim}"),
            // of a fault the form in the text is refuted wherever it can be stated, else its words are quoted
            _ => {
                assert_eq!(claim["corrected"]["verdict"].as_str().unwrap_or("proved"), "proved");
                assert!(claim["witness"].is_object() || claim["quoted"].is_string(), "{claim}");
            }
        }
        if claim["verdict"] == "erratum" {
            assert_eq!(claim["printed"]["verdict"], "refuted");
            assert_eq!(claim["corrected"]["verdict"], "proved");
        }
    }
}

/// Every numbered equation, from 3.1 to A.27, has an entry by its number: as it is, or in parts.
#[test]
fn no_equation_is_left_out() {
    let ids: Vec<&str> = claims_of_the_thesis().iter().map(|c| c["id"].as_str().unwrap()).collect();
    let mut count = 0;
    let paper = palmistry::paper::Paper::read(Path::new("proofs/moll2002")).unwrap();
    for (chapter, last) in &paper.numbering.0 {
        for number in 1..=*last {
            let number = format!("{chapter}.{number}");
            let part = format!("{number}.");
            assert!(ids.iter().any(|id| *id == number || id.starts_with(&part)), "{number} has no entry");
            count += 1;
        }
    }
    assert_eq!(count, 221);
    let table = include_str!("../../reports/errata.md");
    assert!(table.contains("221 equations") && !table.contains("no entry"));
}

/// One sign in 4.48, and nothing else: refuted, by a state at which the two sides can be computed by hand.
#[test]
fn one_wrong_sign_is_refuted_with_a_witness() {
    let folder = folder();
    let text = std::fs::read_to_string("proofs/moll2002/same_rate.proof").unwrap();
    let right = "let d1 = (r1*cos(phi2) + r2)/sin(phi2) - s1";
    assert!(text.contains(right));
    write(&folder, "general.proof", std::fs::read("proofs/moll2002/general.proof").unwrap());
    let file =
        write(&folder, "same_rate.proof", text.replace(right, "let d1 = (r1*cos(phi2) - r2)/sin(phi2) - s1"));
    let output = palmistry(&["prove", file.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let found = json(&output);
    let broken = found["claims"].as_array().unwrap().iter().find(|claim| claim["id"] == "reduce.r1").unwrap();
    assert_eq!(broken["verdict"], "refuted");
    // r1' = -d1 (omega1 - omega0), once with r2 and once with -r2: the sides differ by 2 r2 (omega1 - omega0)/sin(phi2)
    let state = &broken["witness"]["state"];
    let exact =
        |name: &str| palmistry::number::parse_decimal(state[name]["exact"].as_str().unwrap()).unwrap();
    let sine = state["phi2"]["exact"].as_str().unwrap();
    let sine = sine.strip_prefix("sin = ").unwrap().split(',').next().unwrap();
    let sine = palmistry::number::parse_decimal(sine).unwrap();
    let side =
        |name: &str| palmistry::number::parse_decimal(broken["witness"][name].as_str().unwrap()).unwrap();
    let two = dashu::rational::RBig::from(2);
    assert_eq!(side("left") - side("right"), two * exact("r2") * (exact("omega1") - exact("omega0")) / sine);
}

/// A table of statements that everybody knows, with their verdicts.
#[test]
fn known_statements_have_their_verdicts() {
    let cases = [
        ("proved", "sin(a)^2 + cos(a)^2 = 1"),
        ("proved", "sin(a + b) = sin(a)*cos(b) + cos(a)*sin(b)"),
        ("proved", "cos(3*a) = 4*cos(a)^3 - 3*cos(a)"),
        ("proved", "sin(a - pi/2) = -cos(a)"),
        ("refuted", "sin(a + b) = sin(a) + sin(b)"),
        ("refuted", "(x + y)^2 = x^2 + y^2"),
        ("proved", "(x^7 - y^7)/(x - y) = x^6 + x^5*y + x^4*y^2 + x^3*y^3 + x^2*y^4 + x*y^5 + y^6"),
        ("proved", "d(x*y) = [y, x]"),
        ("proved", "L(f, L(f, x)) = -k*x"),
        ("proved", "L(f, log(y)) = -k*x/y"),
        ("proved", "L(f, exp(x*y))/exp(x*y) = y^2 - k*x^2"),
        ("proved", "L(f, sqrt(x))*2*sqrt(x) = y"),
        ("proved", "sqrt(x)^2 = x"),
        ("proved", "L(f, atan(x)) = y/(1 + x^2)"),
        ("refuted", "sqrt(x^2 + y^2) = x + y"),
        ("refuted", "exp(x + y) = exp(x) + exp(y)"),
        // true, but nothing here knows that an exponential of a sum is a product: not to be called proved
        ("proved", "exp(x + y) = exp(x)*exp(y)"),
        ("proved", "det([1, x, x^2; 1, y, y^2; 1, 3, 9]) = (y - x)*(3 - x)*(3 - y)"),
        ("proved", "rank([x, y; 2*x, 2*y]) = 1"),
        ("refuted", "rank([x, y; 2*x, 2*y]) = 2"),
        ("proved", "rank([x, y; y, x]) = 1 where x = y"),
        ("proved", "pole(1/(x - y)^3 + 1/(x - y), x - y) = 3"),
        ("proved", "pole((x^2 - y^2)/(x - y), x - y) = 0"),
        ("proved", "pole(cos(a)/sin(a)^3, sin(a)) = 3"),
        // of order two at a = 0, and none at half a turn, where the sine vanishes too
        ("undecided", "pole(1/(1 - cos(a)), sin(a)) = 2"),
        ("undecided", "pole(1/(sin(a)*(1 + cos(a))), sin(a)) = 1"),
        ("undecided", "pole(1/(x^2*y), x*y) = 2"),
        ("undecided", "pole(1/sin(a), sin(a)) = 1 where a = 2"),
        ("refuted", "pole(1/(x - y), x - y) = 2"),
        ("proved", "x^2 at {x = 3/2} = 9/4"),
        ("proved", "pi = 3.14159265358979323846 within 1e-20"),
        ("refuted", "pi = 22/7 within 1e-3"),
        ("proved", "pi = 22/7 within 2e-3"),
        ("undecided", "1/(x - y) = 1/(x - y) + 1 where x = y"),
        ("undecided", "x = y where x^2 = y^2"),
        ("undecided", "x = y where 1 = 2"),
        ("proved", "cos(a) = 1 where sin(a) = 0, a = 0"),
        ("refuted", "x = 0 where x*y = 0"),
        // a whole turn further on these are false
        ("undecided", "cos(a/2)*(cos(a/2) - 1) = 0 where sin(a) = 0"),
        ("undecided", "a*(a - pi) = 0 where sin(a) = 0"),
        // nothing equals nothing is no theorem
        ("undecided", "1/0 = 1/0"),
        ("undecided", "0*(1/0) = 0"),
        ("undecided", "sqrt(-1)^2 = -1"),
        ("undecided", "1/x = 1/x where x = 0"),
        // simple numbers first, but not only
        ("refuted", "k*x = 2*x where k = 3"),
        ("refuted", "sqrt(x^2) = x"),
        // it holds up to half a turn
        ("refuted", "cos(x/2) = sqrt((1 + cos(x))/2)"),
        ("refuted", "(k - 2)*x = 0"),
        // at x = -1, whose powers are short
        ("refuted", "(((x^1000)^1000)^1000)^1000 = x"),
    ];
    for (verdict, statement) in cases {
        let text = format!(
            "system \"facts\" state x, y param a, b, k = 2 angle a, b drift f x' = y y' = -k*x claim 1: {statement}"
        );
        let system =
            System::parse("facts.proof", &text, Path::new("")).unwrap_or_else(|e| panic!("{statement}: {e}"));
        let outcome = decide_all(&system, 1, &false.into(), &|_| ()).remove(0);
        assert_eq!(outcome.word(), verdict, "{statement}: {:?}", outcome.verdict);
    }
}

/// The bound on the probability of an error is below 2^-100 wherever something was left to chance.
#[test]
fn proofs_state_an_error_below_two_to_minus_hundred() {
    let system = System::read(Path::new("proofs/moll2002/one_palm_fixed.proof")).unwrap();
    for outcome in decide_all(&system, 1, &false.into(), &|_| ()) {
        if let Verdict::Proved { log2_error, .. } = outcome.verdict {
            assert!(log2_error < -100.0, "{}: 2^{log2_error}", outcome.id);
        }
    }
}

#[test]
fn the_outcome_does_not_depend_on_the_number_of_threads() {
    let mut two = all_claims().clone();
    let mut one = json(&with_threads(&["prove", "proofs", "--json"], Some("1")));
    without_times(&mut two);
    without_times(&mut one);
    assert_eq!(one, two);
}

#[test]
fn junit_is_written_whole() {
    let folder = folder();
    let file = folder.path().join("deep/er/claims.xml");
    let output =
        palmistry(&["prove", "proofs/moll2002/fixed_palms.proof", "--junit", file.to_str().unwrap()]);
    assert!(output.status.success());
    let xml = std::fs::read_to_string(&file).unwrap();
    assert!(
        xml.starts_with("<?xml")
            && xml.contains("failures=\"0\"")
            && xml.trim_end().ends_with("</testsuites>")
    );
    assert_eq!(std::fs::read_dir(file.parent().unwrap()).unwrap().count(), 1, "nothing is left beside it");
}

/// Expected verdicts other than 'proved'.
#[test]
fn an_unexpected_verdict_is_exit_status_one() {
    let folder = folder();
    let file =
        write(&folder, "a.proof", "system \"a\" param x claim 1: x = 2*x claim 2 expect refuted: x = x + 1");
    let output = palmistry(&["prove", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("1 not as expected"));
}

/// The first example of the book's chapter on the language says what is true.
#[test]
fn the_example_of_the_book_holds() {
    let chapter = include_str!("../../book/src/language.md");
    let example = chapter.split("```").find(|block| block.contains("system \"A pendulum")).unwrap();
    let example = &example[example.find("system").unwrap()..];
    let system = System::parse("pendulum.proof", example, Path::new("")).unwrap();
    let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
    assert_eq!(outcomes.len(), 4);
    assert!(outcomes.iter().all(|outcome| outcome.ok && outcome.word() == "proved"));
}
