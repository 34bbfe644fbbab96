//! What the checker shows of generic claims without any evidence is what the engine proves: random systems, every rank and what is observable, each claim filed as proved.

use crate::visible::MODELS;
use palmistry::checker::{Checking, ClaimParts, Effort, Finding, ProofSources, VerdictFile, source_digest};
use palmistry::{System, decide_all};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use std::path::Path;

/// For each claim of a file whether the engine proves it, and whether the checker shows it when somebody says that it is proved and gives no evidence.
fn proved_and_shown(model: &str, claims: &[String]) -> Vec<(bool, bool)> {
    let lines = claims.iter().enumerate().map(|(place, claim)| format!("claim c{place}: {claim}\n"));
    let text = format!("system \"model\"\n{model}\n{}", lines.collect::<String>());
    let read = || {
        System::parse("model.proof", &text, Path::new("")).unwrap_or_else(|error| panic!("{error:?}: {text}"))
    };
    let outcomes = decide_all(&read(), 1, &false.into(), &|_| ());
    let record = |(place, claim): (usize, &String)| {
        json!({"file": "model.proof", "digest": source_digest(&text), "id": format!("c{place}"),
            "statement": claim, "asked": ClaimParts::of(claim), "verdict": "proved",
            "evidence": {"unchecked": "none"}})
    };
    let records: Vec<_> = claims.iter().enumerate().map(record).collect();
    let file =
        json!({"schema": "palmistry-verdicts", "version": 4, "tool": "", "seed": 1, "verdicts": records});
    let file = VerdictFile::read(&file.to_string()).expect("a verdict file");
    let (sources, effort, never) = (ProofSources::given([read()]), Effort::default(), false.into());
    let with = Checking { sources: &sources, seed: 1, effort: &effort, interrupt: &never };
    let checked = file.check(with, &|| ());
    outcomes
        .iter()
        .zip(&checked)
        .map(|(outcome, verdict)| (outcome.word() == "proved", matches!(verdict.finding, Finding::Shown(_))))
        .collect()
}

/// Models with answers by hand: what is true may be shown, and its contrary never is.
#[test]
fn models_by_hand_are_shown_as_they_are() {
    let (mut shown, mut all) = (0, 0);
    for (model, seen, unobservable) in MODELS {
        let functions = seen.iter().map(|one| (one, true)).chain(unobservable.iter().map(|one| (one, false)));
        for (function, is_observable) in functions {
            let (function, conditions) = function.split_once(" where ").unwrap_or((function, ""));
            let given = if conditions.is_empty() { String::new() } else { format!(" where {conditions}") };
            let claims = ["observable", "unobservable"].map(|word| format!("{word}({function}){given}"));
            let found = proved_and_shown(model, &claims);
            let contrary = found[usize::from(is_observable)];
            assert!(!contrary.0 && !contrary.1, "{model}: {claims:?} {found:?}");
            shown += usize::from(found[usize::from(!is_observable)].1);
            all += 1;
        }
    }
    println!("{shown} of {all}");
    assert!(2 * shown >= all, "{shown} of {all}");
}

/// A random rate or output of some symbols.
fn term(rng: &mut impl Rng, symbols: &[&str]) -> String {
    let mut any = || symbols[rng.random_range(0..symbols.len())].to_owned();
    let (a, b, c) = (any(), any(), any());
    match rng.random_range(0..8) {
        0 => a,
        1 => format!("{a}*{b}"),
        2 => format!("{a} - {b}"),
        3 => format!("{a}*{b}/(1 + {c}^2)"),
        4 => format!("{a}*sin({b})"),
        5 => format!("{a}*exp(-{b})"),
        6 => format!("{a}*{b} + {b}*{c}"),
        _ => format!("({a} + {b})/{c}"),
    }
}

/// Random systems: of all ranks and of both statements on each unknown the checker shows none that the engine does not prove, and most that it proves.
#[test]
fn what_is_shown_of_random_systems_is_what_is_proved() {
    let mut rng = ChaCha8Rng::seed_from_u64(3711);
    let (mut shown, mut proved) = (0, 0);
    for _ in 0..60 {
        let symbols = ["x", "y", "k", "c"];
        let mut one = || term(&mut rng, &symbols);
        let (f, g, h) = (one(), one(), one());
        let model = format!("state x, y\nparam k, c unknown\ndrift f\n  x' = {f}\n  y' = {g}\noutput {h}\n");
        let ranks = (1..=4).map(|rank| format!("rank = {rank}"));
        let on_a_set = (1..=4).map(|rank| format!("rank = {rank} where c = 0, k = 1"));
        let functions = symbols
            .iter()
            .flat_map(|name| ["observable", "unobservable"].map(|word| format!("{word}({name})")));
        let claims: Vec<String> = ranks.chain(on_a_set).chain(functions).collect();
        for (claim, (is_proved, is_shown)) in claims.iter().zip(proved_and_shown(&model, &claims)) {
            assert!(is_proved || !is_shown, "{model}{claim}");
            shown += usize::from(is_shown);
            proved += usize::from(is_proved);
        }
    }
    println!("{shown} of {proved}");
    assert!(4 * shown >= 3 * proved, "{shown} of {proved}");
}
