//! Each word says what stands behind it: derived, restated, defined, a consequence, an example; the author's mistake, print
//! or scan, the scanner's, a convention, loose wording. And errors that follow from others are not counted twice.

use crate::common::{folder, json, palmistry, write};
use crate::derivation::claims_of_the_thesis;
use palmistry::paper::{Numbering, Paper};
use palmistry::report::{counts_text, errata_markdown};
use palmistry::{Outcome, System, decide_all};
use std::collections::BTreeMap;
use std::path::Path;

/// An oscillator, and some names.
const HEAD: &str = "system \"s\" state x, y, phi param k, m angle phi drift f x' = y y' = -k*x phi' = 1 \
    let energy = m*y^2/2 let point = [x; y] let half = energy/2 let slope = L(f, energy) \
    let rate = -k*x let flat = det([x, y; 2*x, 2*y]) ";

fn numbering() -> Numbering {
    Numbering(vec![("4".to_owned(), 91), ("A".to_owned(), 27)])
}

fn outcomes(text: &str) -> Vec<Outcome> {
    let text = format!("{HEAD}{text}");
    let system = System::parse("test.proof", &text, Path::new("")).unwrap_or_else(|e| panic!("{e}: {text}"));
    decide_all(&system, 1, &false.into(), &|_| ())
}

/// What is only read off from a field or a definition is no proof; what had to be calculated is.
#[test]
fn what_is_written_down_twice_is_not_proved() {
    for (word, statement) in [
        ("holds by definition", "L(f, x) = y"),
        ("holds by definition", "L(f, y) = -x*k"),
        ("holds by definition", "L(f, point) = [y; rate]"),
        ("holds by definition", "L(f, [x, y, phi]) = [y, -k*x, 1]"),
        ("holds by definition", "d(y) = [0, 1, 0]"),
        ("holds by definition", "energy = y^2*m/2"),
        ("holds by definition", "half = energy/2"),
        ("holds by definition", "slope = L(f, energy)"),
        ("holds by definition", "x + y = x + y"),
        // differentiated, multiplied out, taken at a point, under a condition, by an identity of sines
        ("proved", "L(f, energy) = -k*m*x*y"),
        ("proved", "slope = -k*m*x*y"),
        ("proved", "L(f, f, x) = -k*x"),
        ("proved", "d(energy) = [0, m*y, 0]"),
        ("proved", "flat = 0"),
        ("proved", "det([x, y; 1, 1]) = x - y"),
        ("proved", "energy at {y = 2} = 2*m"),
        ("proved", "energy = 2*m where y = 2"),
        ("proved", "[1, 2]*point = [x + 2*y]"),
        ("proved", "(x + y)^2 = x^2 + 2*x*y + y^2"),
        ("proved", "sin(phi)^2 + cos(phi)^2 = 1"),
        ("refuted", "L(f, y) = k*x"),
    ] {
        let found = &outcomes(&format!("claim 1: {statement}"))[0];
        assert_eq!(found.word(), word, "{statement}: {:?}", found.verdict);
        // the engine that says so, and no other word, speaks of one expression
        let says_so = format!("{:?}", found.verdict).contains("the two sides are one expression");
        assert_eq!(says_so, word == "holds by definition", "{statement}: {:?}", found.verdict);
        assert_eq!(found.ok, word != "refuted", "{statement}");
    }
}

/// A claim says what it restates, or that it is a consequence or an example; the statement has to hold all the same.
#[test]
fn a_claim_says_on_what_it_rests() {
    let found = outcomes(
        "claim a: L(f, energy) = -k*m*x*y claim b restates a, f: slope = -k*m*x*y claim c consequence: flat = 0 \
         claim d example: energy at {y = 2} = 2*m claim e consequence: flat = 1 definition f.text: \"f\"",
    );
    let words: Vec<&str> = found.iter().map(Outcome::word).collect();
    assert_eq!(words, ["proved", "holds by definition", "consequence", "example", "refuted", "definition"]);
    assert_eq!(
        found.iter().map(|outcome| outcome.ok).collect::<Vec<_>>(),
        [true, true, true, true, false, true]
    );
    let expected: Vec<&str> = found.iter().map(Outcome::expected_word).collect();
    assert_eq!(
        expected,
        ["proved", "holds by definition", "consequence", "example", "consequence", "definition"]
    );
    assert_eq!(
        counts_text(&found),
        "1 proved, 1 holds by definition, 1 definition, 1 consequence, 1 example, 1 refuted"
    );
}

/// Each kind of fault has a word of its own, which is said only when the right form is proved and the form in the text, where
/// it can be stated, refuted.
#[test]
fn faults_have_words_of_their_own() {
    let wrong = "L(f, energy) = k*m*x*y";
    let right = "L(f, energy) = -k*m*x*y";
    for (begin, between, word, needs) in [
        ("erratum 1: printed", "corrected", "erratum", ""),
        ("erratum 1: printed \"+ kmxy\" as", "corrected", "erratum", ""),
        ("damaged 1: reads", "repaired", "print or scan", ""),
        ("damaged 1: reads \"+ kmxy\" as", "repaired", "print or scan", ""),
        ("scan 1: scanned \"krnxy\" as", "repaired", "scanning fault", ""),
        ("convention 1: printed", "meant", "convention", ""),
        ("loose 1: printed \"energy grows\" as", "meant", "loose wording", ""),
        ("damaged 1: reads \"kmxy\"", "repaired", "print or scan", "quoted"),
        ("scan 1: scanned \"krnxy\"", "repaired", "scanning fault", "quoted"),
        ("loose 1: printed \"energy grows\"", "meant", "loose wording", "quoted"),
    ] {
        let entry = |first: &str, second: &str| match needs {
            "quoted" => format!("{begin} {between} {second}"),
            _ => format!("{begin} {first} {between} {second}"),
        };
        let found = outcomes(&entry(wrong, right)).remove(0);
        assert_eq!((found.word(), found.expected_word(), found.ok), (word, word, true), "{begin}");
        // the right form does not hold
        let found = outcomes(&entry(wrong, wrong)).remove(0);
        assert_eq!((found.word(), found.expected_word(), found.ok), ("refuted", word, false), "{begin}");
        // the form in the text holds
        if needs.is_empty() {
            let found = outcomes(&entry(right, right)).remove(0);
            assert_eq!((found.word(), found.expected_word(), found.ok), ("proved", word, false), "{begin}");
        }
    }
}

/// One slip that is carried on is one error, in whatever file.
#[test]
fn errors_that_follow_are_not_counted_twice() {
    let folder = folder();
    let entry =
        |id: &str, follows: &str| format!("erratum {id} {follows}: printed x = 2*x corrected x = x*1\n");
    let first =
        [entry("4.1", ""), entry("4.2", "follows 4.1"), entry("4.3", "follows 4.2"), entry("4.4", "")];
    let head = "system \"s\" param x\n";
    write(&folder, "a.proof", format!("{head}{}", first.concat()));
    let second = entry("4.5", "follows 4.3 in \"a.proof\"");
    let file = write(&folder, "b.proof", format!("{head}{second}"));
    let mut found = Vec::new();
    for name in ["a.proof", "b.proof"] {
        let system = System::read(&folder.path().join(name)).unwrap();
        found.extend(decide_all(&system, 1, &false.into(), &|_| ()));
    }
    let report = errata_markdown(
        &Paper { title: "a paper".to_owned(), numbering: numbering(), ..Paper::default() },
        &found,
    );
    let line = "5 errata (2 independent, 3 consequential): 4.2 follows 4.1, 4.3 follows 4.2, 4.5 follows 4.3 in a.proof.";
    assert!(report.contains(line), "{report}");
    assert!(report.contains("| 4.5 | erratum | 4.5 (follows 4.3 in a.proof) |"), "{report}");
    // an entry of another file that is none, and a circle through two files
    for (there, message) in [("4.9", "no entry '4.9' in a.proof"), ("4.6", "come from itself")] {
        write(&folder, "a.proof", format!("{head}{}", entry("4.6", "follows 4.5 in \"b.proof\"")));
        write(
            &folder,
            "b.proof",
            format!("{head}{}", entry("4.5", &format!("follows {there} in \"a.proof\""))),
        );
        let output = palmistry(&["prove", file.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(2));
        let said = json(&output)["error"]["message"].as_str().unwrap().to_owned();
        assert!(said.contains(message), "{said}");
    }
}

/// The word of an equation: what is the matter with it first, else that of the entry with its own number.
#[test]
fn an_equation_has_the_word_of_its_own_entry() {
    let found = outcomes(
        "definition 4.1: \"a name\" claim 4.1.zero consequence: flat = 0 \
         claim 4.2: flat = 0 claim 4.2.part restates f: L(f, x) = y \
         claim 4.3.a: flat = 0 claim 4.3.b example: flat = 0 \
         claim 4.4: flat = 0 damaged 4.4.sign: reads x = -x repaired x = x*1 \
         claim 4.5: flat = 0 claim 4.5.other expect refuted: flat = 1 \
         claim A.section2.value: flat = 0 claim A.2: flat = 0",
    );
    let numbering = numbering();
    let rows = numbering.equations(&found);
    let word = |number: &str| rows.iter().find(|row| row.number == number).unwrap().word();
    let words = ["4.1", "4.2", "4.3", "4.4", "4.5", "4.6", "A.2"].map(word);
    assert_eq!(words, ["definition", "proved", "example", "print or scan", "proved", "no entry", "proved"]);
    assert_eq!(rows.iter().find(|row| row.number == "A.2").unwrap().entries.len(), 1);
}

/// The thesis: what is restated names where it comes from, every fault that is stated is refuted, and what the damaged
/// text shows is never called proved.
#[test]
fn the_words_of_the_thesis() {
    // papers of their own in the folder are not the thesis
    let is_of_the_thesis = |claim: &&serde_json::Value| {
        let file = claim["file"].as_str().unwrap();
        !file.contains("moll2002/constraint/") && !file.contains("moll2002/space/")
    };
    let claims: Vec<_> = claims_of_the_thesis().into_iter().filter(is_of_the_thesis).collect();
    let mut words: BTreeMap<&str, usize> = BTreeMap::new();
    for claim in &claims {
        let word = claim["verdict"].as_str().unwrap();
        *words.entry(word).or_default() += 1;
        if word == "holds by definition" {
            assert!(!claim["restates"].as_array().unwrap().is_empty(), "{claim}");
        }
        if word == "proved" {
            assert_ne!(claim["engine"], "the two sides are one expression", "{claim}");
        }
    }
    let word = |id: &str| {
        claims.iter().find(|claim| claim["id"] == id).unwrap_or_else(|| panic!("{id}"))["verdict"]
            .as_str()
            .unwrap()
    };
    for id in [
        "3.24", "3.34", "3.41", "4.18", "4.31.s2", "4.34.g1", "4.41", "4.55", "4.59", "4.62.4", "4.64.6",
        "5.21", "5.22", "5.30", "A.1", "A.2", "A.3", "A.4", "A.10", "A.11", "A.13", "A.22", "A.23", "A.24",
    ] {
        assert_eq!(word(id), "print or scan", "{id}");
    }
    for id in ["3.14", "3.36", "3.37", "4.27", "4.42", "4.44", "5.19", "A.25"] {
        assert_eq!(word(id), "scanning fault", "{id}");
    }
    for (id, expected) in [
        ("4.54", "convention"),
        ("4.89", "convention"),
        ("3.text.first_boundary.diameter", "loose wording"),
        ("4.80", "loose wording"),
        ("6.text.direction", "loose wording"),
        ("3.text.moving_palms", "loose wording"),
        ("3.text.conjecture", "erratum"),
        ("3.text.spiral", "loose wording"),
        ("3.text.connected", "undecided"),
        ("3.text.two_poses", "loose wording"),
        ("3.text.antipodal", "consequence"),
        ("3.text.finite", "loose wording"),
        ("3.text.close", "consequence"),
        ("3.text.not_on_curve", "proved"),
        ("3.text.entire", "loose wording"),
        ("3.text.friction", "loose wording"),
        ("5.text.curvature", "consequence"),
        ("5.text.invalidates", "example"),
        ("5.text.alpha", "undecided"),
        ("6.text.table.rates", "loose wording"),
        ("6.text.table.space", "erratum"),
        ("6.text.table.slow", "loose wording"),
        ("6.text.section", "erratum"),
        ("6.text.modes", "consequence"),
        ("6.text.simpler", "undecided"),
        ("6.text.same_surface", "loose wording"),
        ("4.text.linear", "proved"),
        ("4.text.two_solutions", "erratum"),
        ("4.text.convex", "loose wording"),
        ("3.text.many_poses", "erratum"),
        ("4.text.3_29", "erratum"),
        ("5.17", "erratum"),
        ("5.18", "erratum"),
        ("5.text.normal_terms.1", "convention"),
        ("A.27", "proved"),
        ("A.text.c_m2", "print or scan"),
        ("5.42", "proved"),
        ("3.48", "definition"),
        ("4.77", "definition"),
        ("6.3", "definition"),
        ("5.6", "consequence"),
        ("3.44", "consequence"),
        ("4.45", "holds by definition"),
    ] {
        assert_eq!(word(id), expected, "{id}");
    }
    let of_section_4_7 = ["4.text.unchanged", "4.85", "4.86", "4.87", "4.text.3_29"];
    for id in of_section_4_7 {
        let claim = claims.iter().find(|claim| claim["id"] == id).unwrap();
        assert!(claim["follows"].is_string(), "{claim}");
    }
    let on_their_own = claims.iter().filter(|c| c["verdict"] == "erratum" && c.get("follows").is_none());
    let mut ids: Vec<&str> = on_their_own.map(|claim| claim["id"].as_str().unwrap()).collect();
    ids.sort_unstable();
    let expected = [
        "3.text.area",
        "3.text.conjecture",
        "3.text.many_poses",
        "3.text.singular",
        "4.71",
        "4.text.second_derivative",
        "5.17",
        "6.text.section",
        "6.text.table.space",
        "A.section2.generic",
    ];
    assert_eq!(ids, expected);
    // each says where it stands; of a mistake, a convention and loose wording, whether a conclusion changes
    let mut about_sentences = 0;
    let faults = ["erratum", "print or scan", "scanning fault", "convention", "loose wording"];
    for fault in claims.iter().filter(|claim| faults.contains(&claim["verdict"].as_str().unwrap())) {
        let text = |key: &str| fault[key].as_str().unwrap_or_default();
        assert!(text("passage").contains(", page"), "{fault}");
        let is_sentence = fault["id"].as_str().unwrap().contains(".text.") && fault["quoted"].is_string();
        match text("verdict") {
            "erratum" | "loose wording" => {
                assert!(text("conclusion").len() >= "none changes".len(), "{fault}");
                let begins = |word: &str| text("remark").starts_with(word);
                assert!(!is_sentence || begins("Overstated") || begins("False as stated"), "{fault}");
                about_sentences += usize::from(is_sentence);
            }
            "convention" => assert!(text("conclusion").len() >= "none changes".len(), "{fault}"),
            _ => {}
        }
    }
    assert_eq!(about_sentences, 31);
    insta::assert_json_snapshot!("words", words);
}
