//! One answer, however a sweep is cut. Oracle: the sweep that is not cut, on any number of threads, to the last bit; and for the
//! table, an exact rank by the same states one at a time.

use palmistry::report::{forget_seconds, rank_json};
use palmistry::sweep::{Certainty, MergeError, RankPart, RankPreparation, StateRow, StateTable, shard_of};
use palmistry::{RankQuestion, System, answer_rank};
use proptest::prelude::*;
use serde_json::Value;
use std::path::Path;

/// Systems and conditions, each for a way on which states are decided.
fn systems() -> Vec<(&'static str, String, Vec<&'static str>)> {
    let file = |path: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a shipped file")
    };
    vec![
        (
            "streamed, with something to avoid",
            "system \"s\" state x, y, z drift f x' = y*z y' = z^2 - x z' = x*y + y output x
             sample x in [-1, 1] y in [-1, 1] z in [-1, 1] avoid x - y"
                .to_owned(),
            vec![],
        ),
        (
            "two parts by the sign of z, with another direction unobservable on each",
            "system \"s\" state x, y, z, w drift f x' = 0 y' = 0 z' = 0 w' = 0
             output x + y, (z - abs(z))*w, z*x sample x in [-1, 1] y in [-1, 1] z in [-1, 1] w in [-1, 1]"
                .to_owned(),
            vec![],
        ),
        ("directions of which residues know the parts alone", file("tests/models/cr.proof"), vec![]),
        ("enclosures", file("tests/models/big_topp.proof"), vec![]),
        (
            "half of the states are poles",
            "system \"s\" state x, y drift f x' = y y' = x output sqrt(x)*y, x sample x in [-1, 1] y in [-1, 1]"
                .to_owned(),
            vec![],
        ),
        (
            "two branches, and the file's own rows",
            "system \"s\" state phi, y, z angle phi drift f phi' = y y' = z*sin(phi) z' = 0 output cos(phi) + sin(phi)
             let rows = [y, 1, z; 1, 2, 3; y, z, y] sample phi in [-3, 3] y in [-1, 1] z in [-1, 1]"
                .to_owned(),
            vec!["sin(phi) = 0"],
        ),
        (
            "a box that is cut",
            "system \"s\" state x, y drift f x' = y y' = -x output x^2 sample x in [-1, 1] y in [-1, 1]".to_owned(),
            vec!["x > y"],
        ),
    ]
}

fn question<'a>(samples: u64, conditions: &[&str]) -> RankQuestion<'a> {
    let conditions = conditions.iter().map(|text| (*text).to_owned()).collect();
    RankQuestion { samples, seed: 3, conditions, digits: Some(5), recorded: 3, ..RankQuestion::default() }
}

fn read(text: &str) -> System {
    System::parse("s.proof", text, Path::new("")).expect("a system")
}

/// What is compiled for vectors needs much of the stack where nothing is optimised.
fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(64 << 20);
    pool.build().unwrap().install(work)
}

fn without_times(mut found: Value) -> String {
    forget_seconds(&mut found);
    serde_json::to_string_pretty(&found).unwrap()
}

fn whole(text: &str, conditions: &[&str], samples: u64) -> String {
    on_threads(2, || {
        let answer = answer_rank(&mut read(text), &question(samples, conditions)).expect("an answer");
        assert!(!answer.interrupted());
        without_times(rank_json(&answer))
    })
}

/// Three readers, each of which prepares for itself; every part goes through its text.
fn merged(text: &str, conditions: &[&str], samples: u64, cuts: &[std::ops::Range<u64>]) -> String {
    let question = question(samples, conditions);
    let mut parts = Vec::new();
    for threads in 1..=3 {
        let own = cuts.iter().enumerate().filter(|(place, _)| place % 3 + 1 == threads);
        on_threads(threads, || {
            let mut system = read(text);
            let prepared = RankPreparation::new(&mut system, &question).expect("a preparation");
            for (place, states) in own {
                let part = prepared.sweep(&system, states.clone()).expect("a part");
                let text = part.text().expect("it is whole");
                assert_eq!(RankPart::read(&text).unwrap().text().unwrap(), text);
                parts.push((format!("part {place}"), RankPart::read(&text).unwrap()));
            }
        });
    }
    on_threads(2, || {
        let mut system = read(text);
        let prepared = RankPreparation::new(&mut system, &question).expect("a preparation");
        without_times(rank_json(&prepared.answer(&mut system, parts).expect("a whole")))
    })
}

#[test]
fn one_seven_and_sixty_four_shards_give_the_same_to_the_last_bit() {
    for (name, text, conditions) in systems() {
        let slow = name == "enclosures";
        let samples = if slow { 5 } else { 331 };
        let expected = whole(&text, &conditions, samples);
        for shards in if slow { vec![7] } else { vec![1, 7, 64] } {
            let cuts: Vec<_> = (1..=shards).map(|number| shard_of(samples, number, shards)).collect();
            assert_eq!(merged(&text, &conditions, samples, &cuts), expected, "{name}: {shards}");
        }
    }
    // what is compared is what was meant to be
    let branches = |index: usize| -> Vec<Value> {
        let (_, text, conditions) = &systems()[index];
        let found: Value = serde_json::from_str(&whole(text, conditions, 331)).unwrap();
        found["branches"].as_array().cloned().unwrap_or(vec![found])
    };
    assert_eq!(branches(0)[0]["decided_by"]["doubles"], 331);
    assert_eq!(branches(1).len(), 2);
    assert_ne!(branches(1)[0]["unobservable"], branches(1)[1]["unobservable"]);
    assert!(branches(2)[0]["unobservable"].as_array().unwrap().len() > 1);
    let poles: u64 =
        branches(4)[0]["singularities"].as_object().unwrap().values().filter_map(Value::as_u64).sum();
    assert!((100..231).contains(&poles), "{poles}");
    assert_eq!(branches(5).len(), 2);
    assert!(branches(5).iter().all(|branch| branch["own_rows"]["samples"] == 331));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    /// Cut anywhere, also where eight states at a time are none.
    #[test]
    fn a_sweep_may_be_cut_anywhere(mut ends in prop::collection::vec(0u64..300, 0..6), system in 0usize..6) {
        let (name, text, conditions) = systems().into_iter().filter(|(name, ..)| *name != "enclosures").nth(system).unwrap();
        let samples = 300;
        ends.extend([0, samples]);
        ends.sort_unstable();
        let cuts: Vec<_> = ends.windows(2).map(|pair| pair[0].min(samples)..pair[1].min(samples)).collect();
        prop_assert_eq!(merged(&text, &conditions, samples, &cuts), whole(&text, &conditions, samples), "{}", name);
    }
}

#[test]
fn shards_are_all_states_once() {
    for states in [0, 1, 5, 63, 64, 1_000_000_007, u64::MAX] {
        for of in [1, 2, 7, 64, 1000] {
            let mut next = 0;
            for number in 1..=of {
                let range = shard_of(states, number, of);
                assert_eq!(range.start, next);
                assert!(range.end - range.start <= states.div_ceil(of));
                next = range.end;
            }
            assert_eq!(next, states);
        }
    }
}

#[test]
fn what_is_no_whole_is_refused_by_name() {
    on_threads(2, refusals);
}

fn refusals() {
    let (_, text, _) = systems().swap_remove(0);
    let question = question(100, &[]);
    let mut system = read(&text);
    let part = |states: std::ops::Range<u64>| {
        let mut system = read(&text);
        let prepared = RankPreparation::new(&mut system, &question).unwrap();
        (format!("{states:?}"), prepared.sweep(&system, states).unwrap())
    };
    let mut refused = |parts: Vec<(String, RankPart)>| {
        let prepared = RankPreparation::new(&mut system, &question).unwrap();
        match prepared.answer(&mut system, parts) {
            Err(palmistry::sweep::RankError::Merge(why)) => why,
            other => panic!("{:?}", other.err()),
        }
    };
    assert_eq!(refused(vec![]), MergeError::NoParts);
    assert_eq!(refused(vec![part(0..40), part(50..100)]), MergeError::Gap(40..50));
    assert_eq!(refused(vec![part(50..100)]), MergeError::Gap(0..50));
    assert_eq!(refused(vec![part(0..50)]), MergeError::Gap(50..100));
    let overlap = |one: &str, other: &str, states| MergeError::Overlap {
        one: one.to_owned(),
        other: other.to_owned(),
        states,
    };
    assert_eq!(refused(vec![part(40..100), part(0..50)]), overlap("0..50", "40..100", 40..50));
    assert_eq!(refused(vec![part(0..100), part(0..100)]), overlap("0..100", "0..100", 0..100));
    assert_eq!(refused(vec![part(0..100), part(20..30)]), overlap("0..100", "20..30", 20..30));

    // another seed, other numbers, another file, other conditions
    for other in [
        RankQuestion { seed: 4, ..self::question(100, &[]) },
        RankQuestion { wanted: Certainty::Computed, ..self::question(100, &[]) },
        RankQuestion { order: Some(3), ..self::question(100, &[]) },
        self::question(101, &[]),
        self::question(100, &["x > 0"]),
    ] {
        let mut system = read(&text);
        let prepared = RankPreparation::new(&mut system, &other).unwrap();
        let part = prepared.sweep(&system, 0..100).unwrap();
        assert_eq!(refused(vec![("mine".to_owned(), part)]), MergeError::OtherQuestion("mine".to_owned()));
    }
    let mut changed = read(&text.replace("x*y + y", "x*y - y"));
    let prepared = RankPreparation::new(&mut changed, &question).unwrap();
    let part = prepared.sweep(&changed, 0..100).unwrap();
    assert_eq!(refused(vec![("mine".to_owned(), part)]), MergeError::OtherQuestion("mine".to_owned()));
}

/// Every way to cut a part short is noticed, and every byte that is changed.
#[test]
fn a_damaged_part_is_refused() {
    on_threads(2, damages);
}

fn damages() {
    let (_, text, _) = systems().swap_remove(2);
    let question = question(20, &[]);
    let mut system = read(&text);
    let prepared = RankPreparation::new(&mut system, &question).unwrap();
    let part = prepared.sweep(&system, 0..20).unwrap();
    let text = part.text().unwrap();
    for end in 0..text.trim_end().len() {
        assert!(RankPart::read(&text[..end]).is_err(), "{end}");
    }
    for place in 0..text.len() {
        let mut bytes = text.clone().into_bytes();
        bytes[place] = if bytes[place] == b'7' { b'8' } else { b'7' };
        let Ok(changed) = String::from_utf8(bytes) else { continue };
        // nothing but blanks between the words may change
        assert!(RankPart::read(&changed).is_err_and(|why| !why.to_string().is_empty()), "{place}");
    }
    // an interrupted sweep is no part that could be kept
    let stopped = RankQuestion { interrupt: &true.into(), ..self::question(20, &[]) };
    let mut system = read(&systems()[2].1);
    let prepared = RankPreparation::new(&mut system, &stopped).unwrap();
    assert_eq!(prepared.sweep(&system, 0..20).unwrap().text(), None);
}

/// The rows of the table add up to what is told, and those of two parts are those of the whole.
#[test]
fn the_table_has_a_row_for_each_state() {
    on_threads(2, tables);
}

fn tables() {
    for (name, text, conditions) in systems().into_iter().filter(|(name, ..)| *name != "enclosures") {
        let question = question(300, &conditions);
        let rows_of = |states: std::ops::Range<u64>| -> Vec<(usize, StateRow)> {
            let mut system = read(&text);
            let prepared = RankPreparation::new(&mut system, &question).unwrap();
            let mut rows = Vec::new();
            let coordinates = prepared.coordinates();
            let mut take = |branch: usize, found: &[StateRow]| {
                rows.extend(found.iter().map(|row| (branch, row.clone())));
            };
            let mut table = StateTable { coordinates, take: &mut take };
            prepared.sweep_with(&system, states, Some(&mut table)).unwrap();
            rows.sort_by_key(|(branch, row)| (*branch, row.index));
            rows
        };
        let rows = rows_of(0..300);
        let mut halves = [rows_of(0..123), rows_of(123..300)].concat();
        halves.sort_by_key(|(branch, row)| (*branch, row.index));
        assert_eq!(rows, halves, "{name}");
        let answer = answer_rank(&mut read(&text), &question).unwrap();
        assert_eq!(rows.len(), 300 * answer.branches.len(), "{name}");
        for (place, branch) in answer.branches.iter().enumerate() {
            let own: Vec<&StateRow> =
                rows.iter().filter(|(of, _)| *of == place).map(|(_, row)| row).collect();
            assert!(own.iter().map(|row| row.index).eq(0..300), "{name}");
            for (rank, count) in &branch.full.rank_histogram {
                assert_eq!(own.iter().filter(|row| row.rank == Some(*rank)).count() as u64, *count, "{name}");
            }
            let poles = own.iter().filter(|row| row.rank.is_none()).count() as u64;
            assert_eq!(poles, branch.full.poles.values().sum::<u64>(), "{name}");
            assert_eq!(
                own.iter().filter(|row| row.certified).count() as u64,
                branch.full.certified,
                "{name}"
            );
            if let Some((state, spectrum)) = &branch.full.worst {
                // of that state, all coordinates
                let values: Vec<f64> = state.iter().map(|at| at.value).collect();
                let worst = own.iter().find(|row| row.coordinates == values).expect("it is in the table");
                assert_eq!(worst.rank, Some(answer.dimension), "{name}");
                // the table has the condition by which states were compared, and equilibration ends where another round gains little:
                // of the state that is told it is made with more care
                let ratio = worst.condition.unwrap() / spectrum.condition();
                assert!((0.8..1.25).contains(&ratio), "{name}: {ratio}");
                let others = own.iter().filter(|row| row.rank == Some(answer.dimension));
                assert!(
                    others.filter_map(|row| row.condition).all(|one| one <= worst.condition.unwrap() * 1.001)
                );
            }
        }
    }
}
