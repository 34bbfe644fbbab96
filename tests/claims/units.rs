//! Story 1, continued: other units of length, mass and time change no verdict.

use dashu::rational::RBig;
use palmistry::System;
use palmistry::expression::expand_angles;
use palmistry::number::{Floats, PrimeField};
use palmistry::observability::{
    Branch, Codistribution, Coordinate, Defined, Length, Locus, State, customary_singular_values,
    parse_condition, solve_conditions,
};
use palmistry::sweep::{Certainty, DecidedRows, ProofWanted, RankDecider, StateDecision, StateReport};
use palmistry::system::Value;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// The powers of length, mass and time in the dimension of a symbol of the planar files: by hand from section 4.2, and so a
/// witness for what the files declare.
fn dimension(name: &str) -> [i32; 3] {
    match name {
        "r1" | "r2" | "s1" | "s2" | "rho" => [1, 0, 0],
        "omega0" | "omega1" | "omega2" => [0, 0, -1],
        "alpha1" | "alpha2" => [0, 0, -2],
        "phi1" | "phi2" => [0, 0, 0],
        "m" => [0, 1, 0],
        "I1" | "I2" => [2, 1, 0],
        "g" => [1, 0, -2],
        "tau1" | "tau2" => [2, 1, -2],
        other => panic!("what is the dimension of {other}?"),
    }
}

fn in_other_units(system: &System, state: &State, units: [&RBig; 3]) -> State {
    let values = state.values.iter().map(|(symbol, value)| {
        let value = match value {
            Coordinate::Number(number) => {
                let powers = dimension(system.symbol_name(*symbol));
                let factor = powers
                    .iter()
                    .zip(units)
                    .fold(RBig::ONE, |factor, (power, unit)| factor * unit.pow(*power as isize));
                Coordinate::Number(number * factor)
            }
            angle => angle.clone(),
        };
        (*symbol, value)
    });
    State { values: values.collect() }
}

/// A regime's own rows and its full codistribution, with states on a set.
struct Case {
    system: System,
    rows: Vec<Vec<palmistry::expression::NodeId>>,
    states: Vec<State>,
}

fn case(file: &str, conditions: &[&str], count: u64) -> Vec<Case> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(file);
    let mut system = System::read(&path).unwrap();
    let equations: Vec<_> = conditions.iter().flat_map(|text| parse_condition(text).unwrap()).collect();
    let branches: Vec<Branch> = solve_conditions(&mut system, &equations).unwrap();
    branches
        .into_iter()
        .map(|branch| {
            let full =
                Codistribution::new(&mut system, &branch.values, Length::UntilItStops).unwrap().entries();
            let Some(Value::Matrix(own)) = system.definition("rows").cloned() else { panic!("no rows") };
            let mentioned: Vec<_> = full.iter().chain(&own.entries).copied().collect();
            let locus = Locus::new(&mut system, &branch, &BTreeMap::new(), &mentioned).unwrap();
            let is_angle = &system.angle_test();
            let rows = [full, own.entries].map(|rows| expand_angles(&mut system.graph, &rows, is_angle));
            let states = (0..count).map(|index| locus.draw(5, index).unwrap()).collect();
            Case { system: system.clone(), rows: rows.to_vec(), states }
        })
        .collect()
}

fn cases() -> Vec<Case> {
    [
        ("general.proof", &[][..]),
        ("general.proof", &["omega0 = 0"]),
        ("general.proof", &["det_A_factor = 0"]),
        ("same_rate.proof", &[]),
        ("same_rate.proof", &["omega0 = 0"]),
        ("same_rate.proof", &["sin(phi1) = 0"]),
        ("one_palm_fixed.proof", &[]),
        ("one_palm_fixed.proof", &["omega2 = 0"]),
        ("fixed_palms.proof", &[]),
    ]
    .into_iter()
    .flat_map(|(file, conditions)| case(file, conditions, 6))
    .collect()
}

fn decide(
    case: &Case,
    rows: &[palmistry::expression::NodeId],
    state: &State,
    wanted: Certainty,
) -> StateReport {
    let is_angle = &case.system.angle_test();
    let decider = RankDecider::new(
        &case.system.graph,
        Defined::default(),
        DecidedRows { quick: rows, all: rows, columns: case.system.states.len() },
        is_angle,
        ProofWanted { wanted, field: PrimeField::random(&mut rand_chacha_rng()) },
    );
    match decider.decide(state) {
        StateDecision::Report(report) => report,
        StateDecision::Pole(pole) => panic!("{pole}"),
    }
}

fn rand_chacha_rng() -> impl rand::Rng {
    use rand::SeedableRng;
    rand_chacha::ChaCha8Rng::seed_from_u64(1)
}

/// A unit: an odd part of two digits over another, and a power of ten.
fn unit(exponents: std::ops::RangeInclusive<i32>) -> impl Strategy<Value = RBig> {
    (11u32..99, 11u32..99, exponents)
        .prop_map(|(a, b, exponent)| RBig::from(a) / RBig::from(b) * RBig::from(10).pow(exponent as isize))
}

/// The files declare the dimensions that the table has by hand.
#[test]
fn the_files_declare_these_dimensions() {
    use palmistry::system::Base;
    for file in [
        "general.proof",
        "constraint/two_rates.proof",
        "same_rate.proof",
        "one_palm_fixed.proof",
        "fixed_palms.proof",
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(file);
        let system = System::read(&path).unwrap();
        assert!(system.dimensions_tell_units(), "{file}");
        let mut count = 0;
        for (symbol, _) in system.symbols() {
            let declared = system.dimension_of(symbol).unwrap();
            let powers = [Base::Length, Base::Mass, Base::Time].map(|base| declared.exponent(base).clone());
            let name = system.symbol_name(symbol);
            assert_eq!(powers, dimension(name).map(RBig::from), "{file}: {name}");
            assert!([Base::Current, Base::Temperature].iter().all(|base| declared.exponent(*base).is_zero()));
            count += 1;
        }
        assert!(count >= 10, "{file}: {count}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    /// From picometres to a thousand light years, and so on: the rank, what decides it and what singular values say.
    #[test]
    fn no_verdict_depends_on_units(length in unit(-12..=18), mass in unit(-30..=30), time in unit(-12..=15)) {
        for case in cases() {
            for rows in &case.rows {
                for state in &case.states {
                    let other = in_other_units(&case.system, state, [&length, &mass, &time]);
                    for wanted in [Certainty::Certified, Certainty::Computed] {
                        let (here, there) =
                            (decide(&case, rows, state, wanted), decide(&case, rows, &other, wanted));
                        prop_assert_eq!(here.rank, there.rank);
                        prop_assert_eq!(here.certainty, there.certainty);
                        prop_assert_eq!(here.number_type, there.number_type);
                        prop_assert_eq!(here.computed, there.computed);
                    }
                }
            }
        }
    }
}

/// The customary threshold fails the same test: with lengths in picometres it finds another rank.
#[test]
fn the_customary_threshold_depends_on_units() {
    let mut changed = 0;
    for case in case("general.proof", &[], 20) {
        let is_angle = &case.system.angle_test();
        let program = palmistry::expression::Program::new(&case.system.graph, &case.rows[1], is_angle);
        let customary = |state: &State| {
            let inputs = state.inputs(&program, &Floats).unwrap();
            let values = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
            customary_singular_values(&values, case.system.states.len()).unwrap().rank
        };
        for state in &case.states {
            let picometres = RBig::from(10).pow(12);
            let other = in_other_units(&case.system, state, [&picometres, &RBig::ONE, &RBig::ONE]);
            changed += usize::from(customary(state) != customary(&other));
        }
    }
    assert_eq!(changed, 3, "of twenty states");
}
