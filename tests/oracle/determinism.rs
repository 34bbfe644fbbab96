//! The same verdicts for any number of threads, any order of the claims and any names of theirs.

use super::condition_sets::{ANGLES, PLAIN, anchor, through};
use super::dice::Dice;
use super::findings::{Findings, seed};
use super::library::{rank_at, verdicts};
use super::rewriting::Alphabet;
use super::systems::draw;
use dashu::rational::RBig;

#[test]
fn threads_and_order_change_nothing() {
    let found = Findings::of("threads and order", 24, one_case);
    found.assert_no_fault("threads_and_order_change_nothing");
    let same = found.total("files answered alike");
    assert!(same > 20 || !found.is_whole(), "only {same}");
}

fn one_case(case: u64, findings: &mut Findings) {
    let mut dice = Dice::new(seed() ^ 0x7a2e, case);
    let model = draw(["polynomial", "of angles", "rational"][case as usize % 3], &mut dice);
    let plain: Vec<_> = model.symbols().into_iter().filter(|name| !model.angles.contains(name)).collect();
    if plain.is_empty() {
        return findings.count("threads", "no plain symbol");
    }
    let alphabet = Alphabet { plain, angles: model.angles.clone(), functions: true };
    let mut claims: Vec<String> =
        (0..=model.states.len()).map(|n| format!("claim r{n}: rank = {n}\n")).collect();
    for place in 0..5 {
        let term = alphabet.term(&mut dice);
        let other = if dice.once_in(2) {
            alphabet.rewritten(&term, 2, &mut dice)
        } else {
            alphabet.near_miss(&term, &mut dice)
        };
        claims.push(format!("claim c{place}: {} = {}\n", term.text(), other.text()));
    }
    let head = model.text();
    let text = |claims: &[String]| format!("{head}{}", claims.concat());
    let threads = |n: usize, text: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
        pool.install(|| verdicts(text))
    };
    let forward = text(&claims);
    let first = threads(1, &forward);
    for n in [2, 5] {
        if threads(n, &forward) != first {
            findings.fault("threads change a verdict", format!("{n} threads"), &forward);
        }
    }
    let renamed: Vec<String> =
        claims.iter().map(|claim| claim.replacen("claim ", "claim called_", 1)).collect();
    let mut called = threads(3, &text(&renamed));
    for said in called.iter_mut().flatten() {
        said.id = said.id.replacen("called_", "", 1);
    }
    if called != first {
        findings.fault("names of claims change a verdict", format!("{first:?}"), &text(&renamed));
    }
    claims.reverse();
    let mut backward = threads(3, &text(&claims));
    if let Ok(said) = &mut backward {
        said.reverse();
    }
    if backward == first {
        findings.count("threads", "files answered alike");
    } else {
        let detail = format!("{first:?}\n{backward:?}");
        findings.fault("the order of claims changes a verdict", detail, &forward);
    }
    let at: Vec<(String, RBig)> =
        model.symbols().iter().map(|name| ((*name).to_owned(), RBig::ZERO)).collect();
    let of = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
        pool.install(|| rank_at(&head, &at))
    };
    if of(1) != of(4) {
        findings.fault("threads change a rank", "at zero", &head);
    }
    conditions(&mut dice, findings);
}

/// Claims on a set, with one thread and with four.
fn conditions(dice: &mut Dice, findings: &mut Findings) {
    let point = anchor(dice);
    let Some(condition) = (0..20).find_map(|_| through(&point, dice)) else { return };
    let text = format!(
        "system \"drawn\"\nstate {}\nparam {}\nangle {}\nclaim 1: x*cos(phi) = y where {}\n",
        PLAIN.join(", "),
        ANGLES.join(", "),
        ANGLES.join(", "),
        condition.text()
    );
    let of = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
        pool.install(|| verdicts(&text))
    };
    if of(1) == of(4) {
        findings.count("threads", "conditions answered alike");
    } else {
        findings.fault("threads change a claim on a set", "", &text);
    }
}
