//! What is found at a state is that state's own: neither its neighbours nor where a stream is cut change a bit of it.

use crate::stream::{regime, run, stream};
use palmistry::number::Instructions;
use palmistry::sweep::{Certainty, StateVerdict, Stream, Verdicts};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

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

/// What is said of states, in bits: verdicts, singular values, and factors of rows and columns, state by state.
fn bits(found: &Verdicts) -> Vec<(StateVerdict, Vec<u64>)> {
    let numbers = [&found.singular_values, &found.row_factors, &found.column_factors];
    found
        .verdicts
        .iter()
        .enumerate()
        .map(|(state, verdict)| {
            (*verdict, numbers.into_iter().flatten().map(|values| values[state].to_bits()).collect())
        })
        .collect()
}

/// The oracle is each state handed over alone.
#[test]
fn states_get_in_any_order_and_company_the_bits_that_they_get_alone() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let pick = |rng: &mut ChaCha8Rng, below: usize| rng.random_range(0..below);
    for name in ["general", "same_rate"] {
        let mut stream = stream(&mut regime(name));
        let mut states = drawn(&stream, 150);
        let axes = states.len();
        // not a number, infinite, zero, far away, and tiny: at single coordinates and at all of a state
        for (place, value) in
            [f64::NAN, f64::INFINITY, 0.0, 1e9, 1e-160].into_iter().cycle().take(40).enumerate()
        {
            let state = pick(&mut rng, 150);
            if place % 4 == 0 {
                states.iter_mut().for_each(|values| values[state] = value);
            } else {
                states[pick(&mut rng, axes)][state] = value;
            }
        }
        for wanted in [Certainty::Computed, Certainty::Certified] {
            stream = stream.with(Instructions::Portable);
            let decided = |stream: &Stream, order: &[usize]| {
                let chosen: Vec<Vec<f64>> =
                    states.iter().map(|values| order.iter().map(|state| values[*state]).collect()).collect();
                let slices: Vec<&[f64]> = chosen.iter().map(Vec::as_slice).collect();
                let mut found = Verdicts::default();
                stream.verdicts(&slices, wanted, &mut found).unwrap();
                bits(&found)
            };
            let alone: Vec<_> = (0..150).map(|state| decided(&stream, &[state]).remove(0)).collect();
            let not_finite = alone.iter().filter(|(verdict, _)| *verdict == StateVerdict::NotFinite).count();
            assert!(not_finite > 5 && not_finite < 60, "{name}: {not_finite}");
            for instructions in Instructions::ALL {
                stream = stream.with(instructions);
                for _ in 0..8 {
                    let mut order: Vec<usize> = (0..150).collect();
                    (1..150).rev().for_each(|k| order.swap(k, pick(&mut rng, k + 1)));
                    let mut rest = &order[..];
                    while !rest.is_empty() {
                        let (some, later) = rest.split_at(1 + pick(&mut rng, rest.len()));
                        for (state, found) in some.iter().zip(decided(&stream, some)) {
                            assert_eq!(found, alone[*state], "{name}, {instructions:?}, state {state}");
                        }
                        rest = later;
                    }
                }
            }
        }
    }
}

#[test]
fn more_samples_change_nothing_at_those_before() {
    let mut all = stream(&mut regime("general"));
    let (_, left) = run(&all, 9001, Certainty::Computed);
    let (longer, _) = run(&all, 9001, Certainty::Certified);
    for instructions in Instructions::ALL {
        all = all.with(instructions);
        for count in [1, 2, 7, 9, 17, 100, 4097, 8999] {
            let (report, some) = run(&all, count, Certainty::Computed);
            let before: Vec<u64> = left.iter().copied().filter(|index| *index < count).collect();
            assert_eq!((report.states, some), (count, before), "{instructions:?}");
            // the worst of all states is the worst of those before as soon as it is among them
            let (report, _) = run(&all, count, Certainty::Certified);
            if longer.worst.is_some_and(|(index, _)| index < count) {
                assert_eq!(report.worst, longer.worst, "{instructions:?}, {count} states");
            }
        }
    }
}
