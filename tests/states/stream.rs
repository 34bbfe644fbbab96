//! A hundred thousand states at once: what the stream says is true, the same everywhere, and names what is wrong.

use faer::Mat;
use palmistry::System;
use palmistry::expression::{NodeId, Program, expand_angles};
use palmistry::number::{Floats, Instructions, PrimeField, Rationals, rational_to_f64};
use palmistry::observability::{
    Coordinate, Locus, Reduction, float_inputs, rank, singular_values, solve_conditions,
};
use palmistry::sweep::{Certainty, StateVerdict, StatesError, Stream, StreamOptions, StreamReport, Verdicts};
use palmistry::system::Value;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn regime(name: &str) -> System {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(name).with_extension("proof");
    System::read(&file).unwrap()
}

fn rows(system: &System) -> Vec<NodeId> {
    let Some(Value::Matrix(rows)) = system.definition("rows") else { panic!("no rows") };
    rows.entries.clone()
}

pub(crate) fn stream(system: &mut System) -> Stream {
    let rows = rows(system);
    let branch = solve_conditions(system, &[]).unwrap().remove(0);
    let locus = Locus::new(system, &branch, &BTreeMap::new(), &rows).unwrap();
    Stream::new(system, &locus, &rows).unwrap()
}

pub(crate) fn run(stream: &Stream, states: u64, wanted: Certainty) -> (StreamReport, Vec<u64>) {
    let mut left = Vec::new();
    let options = StreamOptions { states, seed: 7, wanted, interrupt: &false.into(), progress: &|_| () };
    let report = stream.run(&options, &mut |indices| left.extend_from_slice(indices)).unwrap();
    (report, left)
}

/// A small system with one row beside the output x.
fn small(row: &str, range: &str) -> System {
    let text = format!(
        "system \"s\" state x, y drift f x' = y y' = 0 output x sample x in {range} y in [1, 2] \
         let rows = [1, 0; {row}]"
    );
    System::parse("s.proof", &text, Path::new("")).unwrap()
}

#[test]
fn every_state_of_the_regimes_is_proved_or_named() {
    // the outputs of each file are states: as many unit rows
    for (name, eliminated, remaining) in [
        ("general", 6, (4, 4)),
        ("same_rate", 3, (3, 3)),
        ("one_palm_fixed", 3, (3, 3)),
        ("fixed_palms", 2, (3, 3)),
    ] {
        let (report, left) = run(&stream(&mut regime(name)), 20_000, Certainty::Certified);
        assert_eq!((report.eliminated, report.remaining), (eliminated, remaining), "{name}");
        assert_eq!(report.states, 20_000);
        assert_eq!(report.left, left.len() as u64);
        assert_eq!(report.certified + report.left, report.states);
        assert_eq!((report.not_finite, report.full()), (0, eliminated + remaining.0));
        assert!(report.certified >= 19_990, "{name}: {report:?}");
        assert!(left.is_sorted());
        let counted: u64 = report.conditions.iter().sum();
        assert_eq!(Some(&counted), report.ranks.get(&report.full()));
    }
}

/// A full rank modulo a prime is a full rank: the second witness for what elimination with error bounds claims.
#[test]
fn certified_states_have_full_rank_modulo_a_prime_and_exactly() {
    for name in ["general", "same_rate"] {
        let mut system = regime(name);
        let stream = stream(&mut system);
        let (_, left) = run(&stream, 300, Certainty::Certified);
        let is_angle = &system.angle_test();
        let rows = rows(&system);
        let rows = expand_angles(&mut system.graph, &rows, is_angle);
        let program = Program::new(&system.graph, &rows, is_angle);
        let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(1));
        let width = system.states.len();
        for index in (0..300).filter(|index| !left.contains(index)) {
            let state = stream.state(7, index).unwrap();
            let inputs = state.inputs(&program, &field).unwrap();
            let values = program.load(field).unwrap().run(&inputs, &mut Vec::new()).unwrap();
            assert_eq!(rank(&field, values.chunks(width).map(<[u64]>::to_vec).collect()), Ok(width));
            if index < 5 {
                let exact = Rationals::default();
                let inputs = state.inputs(&program, &exact).unwrap();
                let values = program.load(exact).unwrap().run(&inputs, &mut Vec::new()).unwrap();
                assert_eq!(rank(&exact, values.chunks(width).map(<[_]>::to_vec).collect()), Ok(width));
            }
        }
    }
}

#[test]
fn the_same_result_on_any_number_of_threads_and_any_processor() {
    let all = stream(&mut regime("general"));
    let first = run(&all, 30_001, Certainty::Certified);
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| run(&all, 30_001, Certainty::Certified)), first, "{threads} threads");
    }
    let mut all = all;
    for instructions in Instructions::ALL {
        all = all.with(instructions);
        assert_eq!(run(&all, 30_001, Certainty::Certified), first, "{instructions:?}");
    }
}

#[test]
fn states_lie_in_the_box_and_keep_away_from_what_is_avoided() {
    let mut system = regime("general");
    let stream = stream(&mut system);
    let symbol = |name: &str| system.find_symbol(name).unwrap();
    let number = |value: &Coordinate| value.to_f64();
    let mut smallest = f64::INFINITY;
    for index in 0..2000 {
        let state = stream.state(3, index).unwrap();
        let at = |name: &str| number(&state.values[&symbol(name)]);
        for (symbol, info) in system.symbols() {
            let (Some(range), Some(value)) = (&info.range, state.values.get(&symbol)) else { continue };
            let value = value.to_f64();
            let slack = if info.is_angle { 1e-15 } else { 0.0 };
            assert!(
                value >= range.low.to_f64().value() - slack && value <= range.high.to_f64().value() + slack
            );
        }
        for distance in [at("omega1") - at("omega0"), at("omega1") + at("omega2") - at("omega0")] {
            smallest = smallest.min(distance.abs());
            assert!(distance.abs() >= 0.05 - 1e-15, "{distance}");
        }
    }
    assert!(smallest < 0.1, "the edge of what is avoided is never reached: {smallest}");
}

/// Coordinates of the first states that a stream draws, angles in radians.
fn drawn(stream: &Stream, count: u64) -> Vec<Vec<f64>> {
    let mut coordinates = vec![Vec::new(); stream.coordinates().count()];
    for index in 0..count {
        let state = stream.state(7, index).unwrap();
        for (values, symbol) in coordinates.iter_mut().zip(stream.coordinates()) {
            values.push(state.values[&symbol].to_f64());
        }
    }
    coordinates
}

/// The verdicts of states that are handed over beside two other witnesses: what the stream says where it draws the very
/// same states, and the scalar singular values of the scaled block, its entries evaluated one by one.
#[test]
fn states_that_are_handed_over_get_the_verdicts_of_those_that_are_drawn() {
    for name in ["general", "same_rate", "one_palm_fixed", "fixed_palms"] {
        let mut system = regime(name);
        let stream = stream(&mut system);
        let (report, _) = run(&stream, 1003, Certainty::Certified);
        let states = drawn(&stream, 1003);
        let slices: Vec<&[f64]> = states.iter().map(Vec::as_slice).collect();
        let (mut proved, mut plain) = (Verdicts::default(), Verdicts::default());
        stream.verdicts(&slices, Certainty::Certified, &mut proved).unwrap();
        stream.verdicts(&slices, Certainty::Computed, &mut plain).unwrap();
        let count =
            |found: &Verdicts, verdict| found.verdicts.iter().filter(|v| **v == verdict).count() as u64;
        assert_eq!(count(&proved, StateVerdict::Full(Certainty::Certified)), report.certified, "{name}");
        assert_eq!(
            count(&plain, StateVerdict::Full(Certainty::Certified)),
            0,
            "{name}: plain doubles prove nothing"
        );
        assert!(count(&plain, StateVerdict::Full(Certainty::Computed)) >= 1000, "{name}");

        let is_angle = &system.angle_test();
        let rows = rows(&system);
        let kept = Reduction::new(&system.graph, &rows, system.states.len());
        let entries = expand_angles(&mut system.graph, &kept.entries, is_angle);
        let program = Program::plain(&system.graph, &entries);
        let symbols: Vec<_> = stream.coordinates().collect();
        let (width, loaded) = (kept.columns.len(), program.load(Floats).unwrap());
        for state in 0..1003 {
            let value = |symbol| match symbols.iter().position(|other| *other == symbol) {
                Some(place) => states[place][state],
                None => rational_to_f64(system.symbol_info(symbol).unwrap().default.as_ref().unwrap()),
            };
            let entries = loaded.run(&float_inputs(&program, value), &mut Vec::new()).unwrap();
            for found in [&proved, &plain] {
                let factor = |place: usize| {
                    found.row_factors[place / width][state] * found.column_factors[place % width][state]
                };
                let scaled = Mat::from_fn(entries.len() / width, width, |i, j| {
                    entries[i * width + j] * factor(i * width + j)
                });
                let other = scaled.singular_values().unwrap();
                for (values, other) in found.singular_values.iter().zip(&other) {
                    // programs round differently; entries are sums that may cancel
                    assert!(
                        (values[state] - other).abs() < 1e-12 * found.singular_values[0][state],
                        "{name}"
                    );
                }
                // one scaling up to where it stops: lengths to half a percent
                let single = singular_values(&entries, &vec![0.0; entries.len()], width).unwrap();
                assert!((found.singular_values[0][state] / single.values[0] - 1.0).abs() < 0.02, "{name}");
            }
        }
    }
}

#[test]
fn states_that_cannot_be_looked_at_are_refused_or_named() {
    // the corner x vanishes at the second state, the third is no number, the fourth lies outside of the box
    let mut system = small("1, x", "[1, 2]");
    let stream = stream(&mut system);
    let names: Vec<&str> = stream.coordinates().map(|symbol| system.symbol_name(symbol)).collect();
    let (x, y) = ([1.5, 0.0, f64::NAN, -7.0], [1.0; 4]);
    let states: Vec<&[f64]> = names.iter().map(|name| if *name == "x" { &x[..] } else { &y[..] }).collect();
    let mut found = Verdicts::default();
    stream.verdicts(&states, Certainty::Certified, &mut found).unwrap();
    let proved = StateVerdict::Full(Certainty::Certified);
    assert_eq!(found.verdicts, [proved, StateVerdict::Open(1), StateVerdict::NotFinite, proved]);
    stream.verdicts(&states, Certainty::Computed, &mut found).unwrap();
    let computed = StateVerdict::Full(Certainty::Computed);
    assert_eq!(found.verdicts, [computed, StateVerdict::Open(1), StateVerdict::NotFinite, computed]);

    let wanted = Certainty::Computed;
    assert_eq!(
        stream.verdicts(&states[1..], wanted, &mut found),
        Err(StatesError::Coordinates { expected: states.len(), found: states.len() - 1 })
    );
    let mut short = states.clone();
    short[names.len() - 1] = &y[..3];
    assert_eq!(stream.verdicts(&short, wanted, &mut found), Err(StatesError::Lengths { first: 4, other: 3 }));
    let nothing = vec![&y[..0]; names.len()];
    stream.verdicts(&nothing, wanted, &mut found).unwrap();
    assert!(found.verdicts.is_empty());
}

#[test]
fn a_row_that_is_nothing_but_rounding_is_left_and_not_believed() {
    // sin^2 + cos^2 - 1 is zero, which doubles do not see; x and y are no angles, so that no algebra sees it either
    let mut system = small("0, (sin(y)^2 + cos(y)^2 - 1)*x", "[1, 2]");
    let (report, left) = run(&stream(&mut system), 1000, Certainty::Computed);
    assert_eq!((report.certified, report.computed, left.len()), (0, 0, 1000));
    assert_eq!(report.ranks.keys().copied().collect::<Vec<_>>(), [1]);
}

#[test]
fn what_is_not_finite_is_counted_and_left() {
    // a pole that no other entry feels, an overflow, a logarithm of what is negative
    for row in ["1/x, 1", "0, (10^200*y)*(10^200*y)", "0, log(x - 5)"] {
        let (report, left) = run(&stream(&mut small(row, "[0, 0]")), 100, Certainty::Computed);
        assert_eq!((report.not_finite, left.len() as u64, report.states), (100, 100, 100), "{row}");
        assert!(report.ranks.is_empty());
    }
}

#[test]
fn a_function_that_is_only_believed_proves_nothing_but_is_computed() {
    let (report, left) = run(&stream(&mut small("0, exp(x)", "[1, 2]")), 100, Certainty::Computed);
    assert_eq!((report.certified, report.computed, left.len()), (0, 100, 0));
    let (report, left) = run(&stream(&mut small("0, exp(x)", "[1, 2]")), 100, Certainty::Certified);
    assert_eq!((report.certified, report.computed, left.len()), (0, 100, 100));
}

#[test]
fn nothing_left_to_decide_is_full_rank() {
    let (report, left) = run(&stream(&mut small("0, 3", "[1, 2]")), 100, Certainty::Certified);
    assert_eq!((report.eliminated, report.remaining, report.certified, left.len()), (2, (0, 0), 100, 0));
}

#[test]
fn units_do_not_change_a_verdict() {
    let mut counts = Vec::new();
    for unit in ["1", "10^(-120)", "10^120"] {
        let row = format!("0, {unit}*(x - 1.5)");
        let (report, _) = run(&stream(&mut small(&row, "[1, 2]")), 5000, Certainty::Computed);
        counts.push((report.certified, report.computed, report.left, report.ranks));
    }
    assert!(counts.windows(2).all(|two| two[0] == two[1]), "{counts:?}");
}

#[test]
fn it_can_be_stopped_and_keeps_what_was_found() {
    let stream = stream(&mut regime("fixed_palms"));
    let interrupt = AtomicBool::new(false);
    let options = StreamOptions {
        states: 10_000_000,
        seed: 1,
        wanted: Certainty::Computed,
        interrupt: &interrupt,
        progress: &|_| interrupt.store(true, Ordering::Relaxed),
    };
    let report = stream.run(&options, &mut |_| ()).unwrap();
    assert!(report.interrupted && report.states > 0 && report.states < 10_000_000);
}

#[test]
fn a_box_that_is_avoided_altogether_is_an_error() {
    let text = "system \"s\" state x output x sample x in [0, 0.01] avoid x let rows = [x]";
    let mut system = System::parse("s.proof", text, Path::new("")).unwrap();
    let stream = stream(&mut system);
    let options = StreamOptions {
        states: 10,
        seed: 1,
        wanted: Certainty::Computed,
        interrupt: &false.into(),
        progress: &|_| (),
    };
    assert!(stream.run(&options, &mut |_| ()).is_err());
    assert!(stream.state(1, 0).is_err());
}
