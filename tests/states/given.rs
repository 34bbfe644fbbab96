//! States that are handed over. Oracles: the states of a sweep, which is told the same of each that it draws, and matrices by hand.

use palmistry::sweep::{Certainty, GivenStates, RankError, RankPreparation, StateRow, StateTable};
use palmistry::{RankQuestion, System};
use std::sync::atomic::AtomicBool;

static GOES_ON: AtomicBool = AtomicBool::new(false);

fn given(text: &str, wanted: Certainty) -> Result<GivenStates, RankError> {
    let mut system: System = text.parse().expect("a system");
    let question = RankQuestion { wanted, ..RankQuestion::default() };
    let prepared = RankPreparation::new(&mut system, &question)?;
    prepared.at_given_states(&mut system)
}

fn decided(text: &str, states: &[&[f64]]) -> Vec<(Option<usize>, bool)> {
    let given = given(text, Certainty::Certified).expect("states can be decided");
    let rows = given.decide(states, &GOES_ON).expect("as many as needed").expect("nothing stops it");
    rows.iter().map(|row| (row.rank, row.certified)).collect()
}

const LORENZ: &str = "system \"Lorenz\" state x, y, z param a = 10, b = 28, c = 8/3
    drift f  x' = a*(y - x)  y' = x*(b - z) - y  z' = x*y - c*z
    output x sample x in [-20, 20] y in [-20, 20] z in [0, 40]";

/// The very rows of a sweep's table, bit by bit.
#[test]
fn a_state_that_was_drawn_has_the_row_of_its_sweep() {
    for wanted in [Certainty::Certified, Certainty::Computed] {
        let mut system: System = LORENZ.parse().unwrap();
        let question = RankQuestion { samples: 5000, wanted, ..RankQuestion::default() };
        let prepared = RankPreparation::new(&mut system, &question).unwrap();
        let mut drawn: Vec<StateRow> = Vec::new();
        let mut take = |_: usize, rows: &[StateRow]| drawn.extend_from_slice(rows);
        let coordinates = prepared.coordinates();
        let given = given(LORENZ, wanted).unwrap();
        let places: Vec<usize> =
            given.coordinates().iter().map(|s| coordinates.iter().position(|c| c == s).unwrap()).collect();
        let mut table = StateTable { coordinates, take: &mut take };
        prepared.sweep_with(&system, 0..5000, Some(&mut table)).unwrap();
        let column = |place: &usize| drawn.iter().map(|row| row.coordinates[*place]).collect();
        let columns: Vec<Vec<f64>> = places.iter().map(column).collect();
        let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let found = given.decide(&slices, &GOES_ON).unwrap().unwrap();
        assert_eq!(found.len(), 5000);
        for (found, drawn) in found.iter().zip(&drawn) {
            assert_eq!(*found, StateRow { coordinates: Vec::new(), ..drawn.clone() });
        }
    }
}

/// `[2x, 2y; 2(x - b), 2y]` has the determinant `4 b y`. A double is a rational number, the least of them too.
#[test]
fn ranks_by_hand() {
    let text =
        "system \"two beacons\" state x, y param b = 2 drift f others' = 0 output x^2 + y^2, (x - b)^2 + y^2";
    let x = [0.5, 0.5, 1.5, 1e300, -7.0, f64::NAN, 1.0];
    let y = [1.0, 0.0, 5e-324, 1e-300, -0.0, 1.0, f64::INFINITY];
    let full = (Some(2), true);
    let short = (Some(1), true);
    let nothing = (None, false);
    assert_eq!(decided(text, &[&x, &y]), [full, short, full, full, short, nothing, nothing]);
    // a pole, and beyond the sample box
    let text = "system \"s\" state x, y drift f x' = y/x y' = 0 output x sample x in [1, 2] y in [1, 2]";
    assert_eq!(decided(text, &[&[0.0, -3.0], &[1.0, 1.0]]), [nothing, full]);
    // all is eliminated
    let text = "system \"s\" state x, y drift f x' = y y' = -x output x";
    assert_eq!(decided(text, &[&[0.0], &[0.0]]), [full]);
    // what is not seen anywhere: no rank is higher than one
    let text = "system \"s\" state x, y drift f x' = y y' = x output x + y";
    assert_eq!(decided(text, &[&[0.0, 2.0], &[0.0, 1.0]]), [short, short]);
}

/// Angles are in radians, and no sine of a double is rational: a short rank is computed where nothing bounds it from above.
#[test]
fn angles() {
    let text = "system \"a range\" state x, theta angle theta drift f x' = 0 theta' = 0 output x*cos(theta), x*sin(theta)";
    let found = decided(text, &[&[1.0, 2.0, 0.0], &[0.3, 12.0, 1.0]]);
    assert_eq!(found[..2], [(Some(2), true), (Some(2), true)]);
    assert_eq!(found[2].0, Some(1));
    assert!(!found[2].1);
}

#[test]
fn what_cannot_be_decided_is_refused() {
    // which sign holds depends on the state, and that of the box is not that of all
    let text = "system \"s\" state x, y drift f x' = y y' = x output abs(x) sample x in [1, 2] y in [1, 2]";
    assert!(matches!(given(text, Certainty::Certified), Err(RankError::NotAtGivenStates(_))));
    let given = given(LORENZ, Certainty::Certified).unwrap();
    assert!(given.decide(&[&[1.0], &[1.0]], &GOES_ON).is_err());
    assert!(given.decide(&[&[1.0], &[1.0], &[1.0, 2.0]], &GOES_ON).is_err());
    assert_eq!(given.decide(&[&[], &[], &[]], &GOES_ON).unwrap(), Some(Vec::new()));
    let stopped = AtomicBool::new(true);
    assert_eq!(given.decide(&[&[1.0], &[1.0], &[1.0]], &stopped).unwrap(), None);
}
