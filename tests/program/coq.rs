//! Theorems for Coq: what is written, that Coq accepts all of it and rests on nothing but the axioms of its real numbers, and that it
//! refuses what is false. With PALMISTRY_COQ=required Coq has to be there.

use crate::common::{folder, json, palmistry, write};
use palmistry::claim::decide_all;
use palmistry::coq::stated;
use palmistry::{System, Verdict};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;

/// What everything rests on: Coq's construction of the real numbers, and classical logic, which its analysis uses.
const AXIOMS: [&str; 4] = [
    "ClassicalDedekindReals.sig_forall_dec",
    "ClassicalDedekindReals.sig_not_dec",
    "Classical_Prop.classic",
    "FunctionalExtensionality.functional_extensionality_dep",
];

/// The library.
const LIBRARY: [&str; 4] = ["Lie.v", "Check.v", "Point.v", "Rank.v"];

fn coqc(folder: &Path, file: &str) -> Output {
    let run = Command::new("coqc").args(["-Q", ".", "Palmistry", file]).current_dir(folder).output();
    run.expect("coqc runs")
}

fn is_there() -> bool {
    let there = Command::new("coqc").arg("--version").output().is_ok();
    let required = std::env::var("PALMISTRY_COQ").is_ok_and(|word| word == "required");
    assert!(there || !required, "PALMISTRY_COQ is 'required', and there is no coqc");
    there
}

fn compile(folder: &Path, file: &str) {
    let output = coqc(folder, file);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{file}: {error}");
}

#[test]
fn theorems_are_written_with_what_they_mention_and_reasons_for_the_others() {
    let folder = folder();
    let file = write(
        &folder,
        "swing.proof",
        r#"
system "A swing *) Axiom false : False. (*" cite "(* nested"
state phi, omega, by
param k, match, unused
angle phi
drift f  phi' = omega  omega' = -k*sin(phi)  others' = 0
output phi, by
let energy = omega^2/2 - k*cos(phi)
let R = [cos(phi), -sin(phi); sin(phi), cos(phi)]
claim 1.energy: L(f, energy) = 0
claim 1.turned: transpose(R)*R = [1, 0; 0, 1]
claim 1.where: energy = omega^2/2 where k = 0
claim 1.at: (energy at {phi = 0}) + by*match = omega^2/2 - k + match*by
claim 2.rank: rank = 3
claim 2.seen: rank([d(phi); d(L(f, phi))]) = 2
claim 2.pieces: rank = 3 where sin(phi) = 0
claim 2.rows: rank([omega, k; 2*omega, 2*k]) = 1
claim 2.none: rank([0*omega, 0*k]) = 0
claim 2.less expect refuted: rank = 2
claim 2.wrong expect refuted: L(f, phi) = 2*omega
claim 2.circle: omega*cos(phi)^2 = omega where sin(phi) = 0
claim 2.laws: exp(by)*exp(omega)*log(exp(k)) = k*exp(by + omega)
"#,
    );
    let out = folder.path().join("theorems");
    let run = palmistry(&["prove", &file.to_string_lossy(), "--coq", &out.to_string_lossy(), "--json"]);
    let theorems = json(&run)["theorems"]["files"][0].clone();
    assert_eq!(theorems["coq"], "swing.v");
    let whole = ["1.energy", "1.turned", "1.where", "1.at", "2.rank", "2.seen"];
    assert_eq!(theorems["theorems"], serde_json::json!(whole));
    // a set in two pieces, and a matrix that could have more
    assert_eq!(theorems["reached"], serde_json::json!(["2.pieces", "2.rows"]));
    let reasons: Vec<String> = theorems["left_out"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|one| format!("{}: {}", one["id"].as_str().unwrap_or(""), one["reason"].as_str().unwrap_or("")))
        .collect();
    // of nothing nothing is shown
    assert!(reasons.contains(&"2.none: a rank of zero, which no row reaches".to_owned()), "{reasons:?}");
    assert_eq!(reasons.len(), 3, "{reasons:?}");
    assert_eq!(theorems["refuted"], serde_json::json!(["2.less", "2.wrong"]));
    let text = std::fs::read_to_string(out.join("swing.v")).expect("a file");
    assert!(
        text.contains("Definition f := field\n  [(phi, omega);\n   (omega, - (k * Sin phi))]."),
        "{text}"
    );
    assert!(text.contains("Theorem claim_1_energy : L f energy\n  == 0.\nProof. identity. Qed."), "{text}");
    assert!(text.contains("\n  where [k = 0]."), "{text}");
    assert!(
        text.contains("Theorem claim_1_where_somewhere : is_about_something ([k = 0])%condition"),
        "{text}"
    );
    assert!(
        text.contains("Theorem claim_2_wrong_refuted : refuted []\n  (L f phi)\n  (2 * omega)."),
        "{text}"
    );
    assert!(text.contains("by_ * match_"), "{text}");
    assert!(!text.contains("unused"), "{text}");
    assert_eq!(text.matches("(*").count(), text.matches("*)").count(), "{text}");
    let project = std::fs::read_to_string(out.join("_CoqProject")).expect("a file");
    assert_eq!(project, "-Q . Palmistry\nLie.v\nCheck.v\nPoint.v\nRank.v\nswing.v\n");
    if is_there() {
        for file in LIBRARY.into_iter().chain(["swing.v"]) {
            compile(&out, file);
        }
        let uses = "From Palmistry Require Import Lie Check swing.\nPrint Assumptions claim_1_energy.\n";
        std::fs::write(out.join("uses.v"), uses).expect("written");
        let told = String::from_utf8(coqc(&out, "uses.v").stdout).expect("text");
        assert!(!told.contains("false"), "{told}");
    }
}

/// A stranger's file: what doubles, what is long, what is imported a hundred million ways. Nothing of it is worth waiting for, and the rest is written.
#[test]
fn what_would_keep_coq_or_the_writer_for_ever_is_left_out() {
    let folder = folder();
    let mut text = "system \"large\"\nuse b0 = \"b0.proof\"\nstate x\nparam k\ndrift f  x' = k*x\noutput x\nlet a0 = x + k\n".to_owned();
    for i in 0..60 {
        text.push_str(&format!("let a{} = a{i}*a{i} + a{i}\n", i + 1));
    }
    text.push_str("claim doubling: a60 = a59^2 + a59\n");
    text.push_str("claim power expect refuted: ((x^1000)^1000)^1000 = 2*x\n");
    text.push_str(&format!("claim long: {} = 20000*k*x\n", vec!["k*x"; 20_000].join(" + ")));
    let row = |i: usize| (0..12).map(|j| if i == j { "x" } else { "0" }).collect::<Vec<_>>().join(", ");
    let rows: Vec<String> = (0..12).map(row).collect();
    text.push_str(&format!("claim sparse: det([{}]) = x^12\n", rows.join("; ")));
    text.push_str("claim small: L(f, x) = k*x\n");
    let file = write(&folder, "large.proof", text);
    for i in 0..7 {
        let uses: String = (0..10).map(|j| format!("use c{j} = \"b{}.proof\"\n", i + 1)).collect();
        write(&folder, &format!("b{i}.proof"), format!("system \"b{i}\"\n{uses}state x\n"));
    }
    write(&folder, "b7.proof", "system \"b7\"\nstate x\n");
    let out = folder.path().join("theorems");
    let run = palmistry(&["prove", &file.to_string_lossy(), "--coq", &out.to_string_lossy(), "--json"]);
    let theorems = json(&run)["theorems"]["files"][0].clone();
    assert_eq!(theorems["theorems"], serde_json::json!(["sparse", "small"]), "{theorems}");
    assert_eq!(theorems["left_out"].as_array().map(Vec::len), Some(3), "{theorems}");
    if is_there() {
        for file in LIBRARY.into_iter().chain(["large.v"]) {
            compile(&out, file);
        }
    }
}

/// The names that Coq prints behind `Print Assumptions`.
fn assumptions(told: &str) -> BTreeSet<&str> {
    let names = told.lines().filter(|line| !line.starts_with(' ') && *line != "Axioms:");
    names.filter_map(|line| line.split_whitespace().next()).filter(|name| name.contains('.')).collect()
}

#[test]
fn coq_accepts_the_theorems_of_two_papers_and_of_the_regimes_of_the_thesis() {
    if !is_there() {
        return;
    }
    let folder = folder();
    let out = folder.path().join("theorems");
    let regimes = ["general", "same_rate", "fixed_palms", "one_palm_fixed"]
        .map(|name| format!("proofs/moll2002/{name}.proof"));
    let mut arguments = vec!["prove", "proofs/martinelli2005", "proofs/hermann1977"];
    arguments.extend(regimes.iter().map(String::as_str));
    let out_text = out.to_string_lossy();
    arguments.extend(["--coq", &out_text, "--json"]);
    let run = json(&palmistry(&arguments));
    let (mut theorems, mut left_out) = (0, 0);
    for file in LIBRARY {
        let text = std::fs::read_to_string(out.join(file)).expect("a file");
        for word in ["Admitted", "admit", "Axiom", "Parameter ", "Hypothesis rules_hold : hold r l."] {
            // one hypothesis of a section, which its lemmas carry
            let expected = usize::from(file == "Check.v" && word.starts_with("Hypothesis"));
            assert_eq!(text.matches(word).count(), expected, "{word} in {file}");
        }
        compile(&out, file);
    }
    for file in run["theorems"]["files"].as_array().expect("a list") {
        let name = file["coq"].as_str().expect("a name");
        let claims = file["theorems"].as_array().expect("a list");
        theorems += claims.len();
        left_out += file["left_out"].as_array().map_or(0, Vec::len);
        let Some(claim) = claims.last().and_then(|claim| claim.as_str()) else { continue };
        let file = out.join(name);
        let mut text = std::fs::read_to_string(&file).expect("a file");
        let ident = claim.replace(['.', '-'], "_");
        let theorem = format!("Theorem claim_{ident}");
        let whole = text.lines().find_map(|line| line.strip_prefix(&theorem).map(str::to_owned));
        let rest = whole.unwrap_or_else(|| panic!("{theorem} in {name}"));
        let rest = rest.split_whitespace().next().unwrap_or("").to_owned();
        text.push_str(&format!("Print Assumptions claim_{ident}{}.\n", if rest == ":" { "" } else { &rest }));
        std::fs::write(&file, text).expect("written");
        let output = coqc(&out, name);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let told = String::from_utf8(output.stdout).expect("text");
        assert_eq!(assumptions(&told), BTreeSet::from(AXIOMS), "{name}: {told}");
    }
    assert!(theorems >= 90, "{theorems} theorems, {left_out} left out");
}

/// What becomes of a statement by one sign, function, factor or name.
fn mutants(statement: &str) -> Vec<String> {
    let Some((left, right)) = statement.split_once(" = ") else { return Vec::new() };
    let mut found = vec![format!("{left} = 2*({right})"), format!("-({left}) = {right}")];
    for (from, to) in
        [(" + ", " - "), (" - ", " + "), ("sin(", "cos("), ("cos(", "sin("), ("1", "2"), ("2", "1")]
    {
        for (side, is_left) in [(left, true), (right, false)] {
            for (at, _) in side.match_indices(from) {
                let changed = format!("{}{to}{}", &side[..at], &side[at + from.len()..]);
                found.push(match is_left {
                    true => format!("{changed} = {right}"),
                    false => format!("{left} = {changed}"),
                });
            }
        }
    }
    found
}

#[test]
fn coq_refuses_what_is_made_false_by_one_sign_function_factor_or_index() {
    if !is_there() {
        return;
    }
    let folder = folder();
    for name in LIBRARY {
        let text = std::fs::read_to_string(format!("proofs/coq/{name}")).expect("a file of the library");
        write(&folder, name, text);
        compile(folder.path(), name);
    }
    let mut refused = 0;
    for name in
        ["moll2002/fixed_palms", "moll2002/same_rate", "moll2002/chapter4_motion", "martinelli2005/polar"]
    {
        let path = PathBuf::from(format!("proofs/{name}.proof"));
        let text = std::fs::read_to_string(&path).expect("a proof file");
        let home = path.parent().expect("a folder");
        let whole = System::read(&path).expect("a system");
        let mut changed = text.clone();
        let mut count = 0;
        for claim in &whole.claims {
            for statement in claim.body.statements() {
                let written = &text[statement.span.clone()];
                if written.len() > 120 || written.contains('\n') {
                    continue;
                }
                for mutant in mutants(written).into_iter().take(6) {
                    let more = format!("{changed}\nclaim mutant.{count}: {mutant}\n");
                    // shapes, units and names still have to fit
                    if count < 100 && System::parse("mutants", &more, home).is_ok() {
                        changed = more;
                        count += 1;
                    }
                }
            }
        }
        let mut system = System::parse("mutants", &changed, home).expect("mutants fit one by one");
        system.claims.retain(|claim| claim.id.starts_with("mutant."));
        let outcomes = decide_all(&system, 1, &AtomicBool::new(false), &|_| ());
        let is_false: BTreeSet<&str> = outcomes
            .iter()
            .filter(|outcome| matches!(outcome.verdict, Verdict::Refuted { .. }))
            .map(|outcome| outcome.id.as_str())
            .collect();
        let wanted = |id: &str| if is_false.contains(id) { Ok(()) } else { Err("not refuted".to_owned()) };
        let found = stated(&system, &wanted);
        // the identity is not shown, so that there is no theorem
        let text = found.text.replace("Proof. identity. Qed.", "Proof. identity. Fail Qed. Abort.");
        refused += text.matches("Fail Qed").count();
        let file = format!("{}.v", name.replace('/', "_"));
        write(&folder, &file, text);
        compile(folder.path(), &file);
    }
    assert!(refused >= 200, "{refused} mutants were refused");
}

/// The page of a paper leads to the theorems beside it.
#[test]
fn theorems_of_a_paper_stand_beside_its_page() {
    let folder = folder();
    let out = folder.path().join("report");
    let run = json(&palmistry(&[
        "verify",
        "proofs/hermann1977",
        "--out",
        &out.to_string_lossy(),
        "--coq",
        "--no-times",
        "--json",
    ]));
    let page = std::fs::read_to_string(out.join("index.html")).expect("a page");
    let mut led = 0;
    for file in run["theorems"]["files"].as_array().expect("a list") {
        let name = file["coq"].as_str().expect("a name");
        let text = std::fs::read_to_string(out.join("coq").join(name)).expect("a file");
        let whole = ["theorems", "reached"].map(|list| file[list].as_array().expect("a list").len());
        assert!(text.matches("\nTheorem claim_").count() >= whole.iter().sum());
        led += page.matches(&format!("href=coq/{name} ")).count();
    }
    assert!(led > 10, "{led} claims lead to theorems");
    assert!(out.join("coq/Rank.v").exists());
    // without being asked none is written, and the page leads nowhere
    let out = folder.path().join("plain");
    palmistry(&["verify", "proofs/hermann1977", "--out", &out.to_string_lossy(), "--no-times"]);
    assert!(!out.join("coq").exists());
    assert!(!std::fs::read_to_string(out.join("index.html")).expect("a page").contains("coq/"));
}

/// A theorem on a rank with another number, shown by one row more or less: a row twice, and one left out.
fn rank_mutants(theorem: &str) -> Option<[String; 2]> {
    let (said, proof) = theorem.split_once(".\nProof. ")?;
    let (said, number) = said.rsplit_once(' ')?;
    // of no row there is none to be repeated
    let number: usize = number.parse().ok().filter(|number| *number > 0)?;
    let (shown, rows) = proof.strip_suffix("]%nat. Qed.\n")?.rsplit_once(" [")?;
    // the separators of words stand outside of their brackets
    let mut all: Vec<String> = Vec::new();
    for piece in rows.split("; ") {
        match all.last_mut() {
            Some(last) if last.contains('(') && !last.ends_with(')') => *last = format!("{last}; {piece}"),
            _ => all.push(piece.to_owned()),
        }
    }
    let written = |number: usize, rows: &[String]| {
        format!("{said} {number}.\nProof. {shown} [{}]%nat. Fail Qed. Abort.\n", rows.join("; "))
    };
    let more = [&all[..], &all[..1]].concat();
    Some([written(number + 1, &more), written(number - 1, &all[..all.len() - 1])])
}

#[test]
fn coq_refuses_ranks_that_are_larger_or_smaller() {
    if !is_there() {
        return;
    }
    let folder = folder();
    let out = folder.path().join("theorems");
    let run = palmistry(&[
        "prove",
        "proofs/martinelli2005",
        "proofs/koteich2015",
        "proofs/moll2002/same_rate.proof",
        "--coq",
        &out.to_string_lossy(),
        "--json",
    ]);
    for file in LIBRARY {
        compile(&out, file);
    }
    let mut refused = 0;
    for file in json(&run)["theorems"]["files"].as_array().expect("a list") {
        let name = file["coq"].as_str().expect("a name");
        let text = std::fs::read_to_string(out.join(name)).expect("a file");
        let mut changed = String::new();
        for part in text.split_inclusive("Qed.\n") {
            let rank = part.contains("rank_at ").then(|| rank_mutants(part)).flatten();
            match rank {
                // that fewer are reached is true, where nothing is said of more
                Some([more, _]) if part.contains("_reaches ") => {
                    changed.push_str(&more);
                    refused += 1;
                }
                Some([more, fewer]) => {
                    changed.push_str(&more);
                    changed.push_str(&fewer);
                    refused += 2;
                }
                None => changed.push_str(part),
            }
        }
        std::fs::write(out.join(name), changed).expect("written");
        compile(&out, name);
    }
    assert!(refused >= 60, "{refused} ranks were refused");
}
