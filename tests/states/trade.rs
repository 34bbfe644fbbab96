//! Story: what does accuracy cost? Digits and verdicts of `palmistry trade` against what is known; no test asserts a time.

use crate::common::{folder, json, palmistry, with_threads, without_times, write};
use crate::picture::Picture;
use palmistry::System;
use palmistry::report::{trade_front_table, trade_plot};
use palmistry::tradeoff::{
    Combination, CorrectDigits, Derivative, Number, RankMethod, Trade, TradeQuestion, trade,
};
use std::collections::BTreeSet;
use std::path::Path;

fn measure(system: &System, samples: u64) -> Trade {
    let question =
        TradeQuestion { samples, seed: 1, rounds: 1, interrupt: &false.into(), progress: &|_, _| () };
    trade(system, &question).unwrap()
}

fn parsed(text: &str) -> System {
    System::parse("trade.proof", text, Path::new("")).unwrap()
}

fn digits(found: &Trade, number: Number, derivative: Derivative) -> (f64, f64) {
    let result = found.derivatives.iter().find(|d| (d.number, d.derivative) == (number, derivative)).unwrap();
    assert_eq!(result.failed, 0, "{result:?}");
    match result.digits {
        CorrectDigits::Measured { median, worst } => (median, worst),
        other => panic!("{other:?}"),
    }
}

/// The ten-state regime. A number has about as many digits as its significand (7.2, 16.0, 30.7), less those that the
/// condition of a state costs; the gaps between the kinds are the gaps between the significands. Differences lose half
/// of the digits and more with each order: with `u` the unit of a double, a third derivative is right to `u^(1/4)`
/// (forward) or `u^(2/5)` (central), 3.9 and 6.3 digits, less what the third and fourth derivatives cost.
#[test]
fn digits_are_what_the_numbers_have() {
    let system = System::read(Path::new("proofs/moll2002/general.proof")).unwrap();
    let found = measure(&system, 200);
    assert_eq!((found.size, found.block, found.varying), ((10, 10), (4, 4), 30));
    assert_eq!(found.states, 200);
    for derivative in [Derivative::Graph, Derivative::Series, Derivative::Duals, Derivative::Expanded] {
        let of = |number| digits(&found, number, derivative);
        let (single, double, twice) = (of(Number::Single), of(Number::Double), of(Number::DoubleDouble));
        assert!((5.0..7.3).contains(&single.0), "{derivative:?} {single:?}");
        assert!((13.5..16.0).contains(&double.0), "{derivative:?} {double:?}");
        assert!((29.0..31.1).contains(&twice.0), "{derivative:?} {twice:?}");
        for pair in [single, double, twice] {
            assert!(pair.1 <= pair.0, "{derivative:?} {pair:?}");
        }
        // an enclosure says no more than a double knows
        let interval = of(Number::Interval);
        assert!(interval.0 < double.0 && interval.0 > 10.0, "{derivative:?} {interval:?}");
    }
    // the same algebra in another order
    let blocks = digits(&found, Number::Double, Derivative::Blocks);
    assert!((13.5..16.0).contains(&blocks.0), "{blocks:?}");
    // a bound on the error is no less than the error, and certain where it suffices
    let bounded = digits(&found, Number::Bounded, Derivative::Blocks);
    assert!(bounded.0 > 11.0 && bounded.0 < blocks.0 && bounded.1 <= blocks.1, "{bounded:?} {blocks:?}");
    let certain = found.combinations.iter().find(|c| c.rank == RankMethod::BoundedElimination).unwrap();
    assert_eq!((certain.wrong, certain.certified + certain.undecided), (0, 200), "{certain:?}");
    let jacobi = found.combinations.iter().filter(|c| c.rank == RankMethod::Jacobi);
    let svd =
        found.combinations.iter().filter(|c| c.rank == RankMethod::SvdNalgebra && c.number == Number::Double);
    for (a, b) in jacobi.zip(svd) {
        assert_eq!((a.derivative, a.wrong, a.failed), (b.derivative, b.wrong, b.failed));
    }
    for (number, forward, central) in
        [(Number::Double, 2.0..4.5, 4.0..7.0), (Number::DoubleDouble, 5.5..8.0, 9.5..13.0)]
    {
        let (low, high) =
            (digits(&found, number, Derivative::Forward).0, digits(&found, number, Derivative::Central).0);
        assert!(forward.contains(&low) && central.contains(&high), "{number:?} {low} {high}");
    }
    for result in &found.derivatives {
        match result.number {
            Number::Rational => assert_eq!(result.digits, CorrectDigits::Exact),
            Number::Residue => assert_eq!((result.digits, result.failed), (CorrectDigits::Modular, 0)),
            _ => {}
        }
    }
    // what is exact is never wrong, and says so of itself
    for c in found.combinations.iter().filter(|c| matches!(c.number, Number::Residue | Number::Rational)) {
        assert_eq!((c.not_right(), c.certified), (0, 200), "{c:?}");
    }
}

/// Every pair of a number and a way is either measured or left out for a reason.
#[test]
fn nothing_is_left_out_in_silence() {
    let system = System::read(Path::new("proofs/moll2002/same_rate.proof")).unwrap();
    let found = measure(&system, 20);
    for number in Number::ALL {
        for derivative in Derivative::ALL {
            let measured = found.derivatives.iter().any(|d| (d.number, d.derivative) == (number, derivative));
            let reason =
                found.left_out.iter().find(|l| (l.number, l.derivative) == (number, Some(derivative)));
            assert_ne!(measured, reason.is_some_and(|l| !l.reason.is_empty()), "{number:?} {derivative:?}");
        }
        for rank in RankMethod::ALL {
            let measured = found.ranks.iter().any(|r| (r.number, r.rank) == (number, rank));
            let reason = found.left_out.iter().find(|l| (l.number, l.rank) == (number, Some(rank)));
            assert_ne!(measured, reason.is_some_and(|l| !l.reason.is_empty()), "{number:?} {rank:?}");
        }
    }
    let pairs: usize = Number::ALL
        .iter()
        .map(|number| {
            let ways = found.derivatives.iter().filter(|d| d.number == *number).count();
            ways * found.ranks.iter().filter(|r| r.number == *number).count()
        })
        .sum();
    assert_eq!(found.combinations.len(), pairs);
}

/// Two outputs of which one is a function of the other: the rank is one of two, exactly, but differences see two rows
/// that are not quite parallel, and intervals know that they do not know.
#[test]
fn a_short_rank_is_taken_for_full_by_noise() {
    let system = parsed(
        "system \"one output twice\" state x, y drift f others' = 0 output x*y^2, (x*y^2)^3
         sample x in [1, 2] y in [1, 2]",
    );
    let found = measure(&system, 100);
    assert_eq!(found.certified_ranks.into_iter().collect::<Vec<_>>(), [(1, 100)]);
    let of = |number, derivative, rank| {
        *found
            .combinations
            .iter()
            .find(|c| (c.number, c.derivative, c.rank) == (number, derivative, rank))
            .unwrap()
    };
    for derivative in [Derivative::Forward, Derivative::Central] {
        let noisy = of(Number::Double, derivative, RankMethod::SvdNalgebra);
        assert!(noisy.wrong > 90, "{noisy:?}");
    }
    let exact = of(Number::Rational, Derivative::Graph, RankMethod::ExactElimination);
    assert_eq!((exact.not_right(), exact.certified), (0, 100));
    let modular = of(Number::Residue, Derivative::Graph, RankMethod::ExactElimination);
    assert_eq!((modular.not_right(), modular.certified), (0, 0)); // right, and no proof
    let unsure = of(Number::Interval, Derivative::Graph, RankMethod::IntervalElimination);
    assert_eq!((unsure.wrong, unsure.undecided), (0, 100));
    let unsure = of(Number::Bounded, Derivative::Blocks, RankMethod::BoundedElimination);
    assert_eq!((unsure.wrong, unsure.undecided), (0, 100));
}

/// Where there is no exact arithmetic the truth is an enclosure, and the exact number types are left out for a reason. Rows that
/// are no differentials of words leave the ways out that start from words.
#[test]
fn what_is_not_possible_is_said_with_its_reason() {
    let system = parsed(
        "system \"an exponential\" state x, y drift f x' = y y' = exp(x) output x*y
         sample x in [1, 2] y in [1, 2] let rows = [d(x*y); d(exp(x) + y)]",
    );
    let found = measure(&system, 50);
    assert_eq!((found.states, found.without_truth), (50, 0));
    let reason = |number, derivative| {
        let left = found.left_out.iter().find(|l| (l.number, l.derivative) == (number, Some(derivative)));
        left.map(|l| l.reason.clone()).unwrap_or_default()
    };
    assert!(reason(Number::Rational, Derivative::Graph).contains("no exact value"));
    assert!(reason(Number::Residue, Derivative::Graph).contains("no exact value"));
    for derivative in [Derivative::Series, Derivative::Duals, Derivative::Forward] {
        let why = reason(Number::Double, derivative);
        assert!(why.contains("row 2") && why.contains("no differential of a Lie derivative"), "{why}");
    }
    assert!(digits(&found, Number::Double, Derivative::Graph).1 > 14.0);
    assert!(digits(&found, Number::Interval, Derivative::Graph).1 > 13.0);
}

/// The same seed gives the same result on any number of threads, times excepted; and the files are there.
#[test]
fn one_seed_gives_one_result_on_any_number_of_threads() {
    let folder = folder();
    let out = folder.path().to_str().unwrap();
    let arguments = ["trade", "proofs/moll2002/fixed_palms.proof", "--samples", "40", "--json", "--out", out];
    let (mut one, mut two) =
        (json(&with_threads(&arguments, Some("1"))), json(&with_threads(&arguments, Some("2"))));
    without_times(&mut one);
    without_times(&mut two);
    assert_eq!(one, two);
    let picture = Picture::read(&std::fs::read_to_string(folder.path().join("trade.svg")).unwrap());
    assert_eq!(picture.title, one["title"].as_str().unwrap());
    assert!(picture.texts.iter().any(|text| text == "digits at the worst state"));
    let written: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("trade.json")).unwrap()).unwrap();
    assert_eq!(written["samples"], 40);
}

/// Nothing on the front is beaten by more than the tolerance, and everything else is; the table holds the front, from the fastest.
#[test]
fn the_front_is_one() {
    let system = System::read(Path::new("proofs/moll2002/fixed_palms.proof")).unwrap();
    let found = measure(&system, 30);
    // better by 5 % of time, by a quarter of a digit, or in any verdict
    let better = |a: &Combination, b: &Combination| {
        a.seconds < 0.95 * b.seconds
            || a.digits.worst() > b.digits.worst() + 0.25
            || a.not_right() < b.not_right()
            || a.certified > b.certified
    };
    for c in &found.combinations {
        let beaten = found.combinations.iter().any(|other| better(other, c) && !better(c, other));
        assert_eq!(c.on_front, !beaten, "{c:?}");
    }
    let table = trade_front_table(&found);
    assert_eq!(table.len(), found.combinations.iter().filter(|c| c.on_front).count());
    assert!(table.iter().any(|row| row[0] == "rational" && row[4] == "all"));
    // everything that was timed is named below the picture, each thing once, with what its looks mean
    let picture = Picture::read(&trade_plot(&found));
    assert_eq!(picture.title, system.title);
    let timed = || found.combinations.iter().filter(|c| c.seconds.is_finite());
    let mut names: BTreeSet<&str> = timed().map(|c| c.number.name()).collect();
    names.extend(timed().map(|c| c.derivative.name()));
    names.extend(["hollow: some verdicts are not right", "with a rim: all verdicts are certain"]);
    names.extend(["time a state, derivative and rank", "digits at the worst state"]);
    assert!(names.len() > 12, "{names:?}");
    for name in names {
        assert_eq!(picture.texts.iter().filter(|text| *text == name).count(), 1, "{name}");
    }
}

#[test]
fn what_cannot_be_measured_is_refused_in_words() {
    let folder = folder();
    let empty = write(&folder, "empty.proof", "system \"nothing is seen\" state x drift f x' = x");
    let output = palmistry(&["trade", empty.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(json(&output)["error"]["message"].as_str().unwrap().contains("no states or no outputs"));
    let unbounded = write(&folder, "unbounded.proof", "system \"no box\" state x drift f x' = x output x^2");
    let output = palmistry(&["trade", unbounded.to_str().unwrap(), "--json"]);
    let told = json(&output)["drawn_by_default"].clone();
    assert_eq!(told, serde_json::json!({ "x": ["-1", "1"] }));
}
