//! A shape's control points as states: `constraint/control_points.proof` held against splines that Newton's laws move.

use super::{NEVER, experiment, text, with};
use palmistry::System;
use palmistry::observer::*;
use std::path::Path;

const RADII: [f64; 3] = [1.2, 1.7, 1.3];

/// A window of the thesis's spline that is thrown about, of which the contacts and the palms are read: the control points come back, and with them the whole outline, how it is turned,
/// and where its centre of mass is. Truth is the body's own; its motion is a simulation that has no equation of the file.
#[test]
fn control_points_of_a_shape_are_states() {
    let shape = "{ kind = \"harmonics\", mean = 1.2, harmonics = [[0, 0], [0.1, 0], [0.03, -0.04]] }";
    let spline = format!("{{ kind = \"spline\", radii = {RADII:?}, knots = \"uniform\" }}");
    // palm 1 on the piece from the first point to the second, palm 2 on that from the third to the first
    let scene = with(&with(&text("same_rate"), shape, &spline), "orientation = 5.3", "orientation = -1.466");
    let experiment = experiment(&scene);
    const LAST: usize = 100;
    let column = |name: &str| -> Vec<f64> { experiment.truth(name).unwrap()[..=LAST].to_vec() };
    let times = experiment.signals.times()[..=LAST].to_vec();
    let (phi1, phi2) = (column("phi1"), column("phi2"));
    let phi12: Vec<f64> = phi1.iter().zip(&phi2).map(|(a, b)| a + b).collect();
    let still = ["w1", "w1'", "w12", "w12'", "tangent1", "tangent2"]
        .map(|name| (name.to_owned(), vec![0.0; times.len()]));
    let read = [("s1", column("s1")), ("s2", column("s2")), ("phi1", phi1.clone()), ("phi12", phi12.clone())];
    let columns = read.into_iter().map(|(name, values)| (name.to_owned(), values)).chain(still).collect();
    let signals = Signals::new(times, columns).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/constraint/control_points.proof");
    let system = System::read(&file).unwrap();
    let (phi0, omega0) = (column("phi0"), column("omega0"));
    let guess = [
        ("phi0", phi0[0] + 0.05),
        ("omega0", 1.05 * omega0[0]),
        ("u1", 0.15),
        ("u2", 0.5),
        ("q1", 1.25),
        ("q2", 1.6),
        ("q3", 1.35),
        ("bx", -0.1),
        ("by", 0.05),
        ("rho2", 0.5),
    ];
    let question = EstimateQuestion {
        guess: guess.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        known: [
            ("rate1", 0.4),
            ("rate12", 0.4),
            ("drive1", 0.0),
            ("drive12", 0.0),
            ("on1", 0.0),
            ("on2", 0.0),
            ("on3", 1.0),
            ("half", 3f64.sqrt() / 2.0),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .into(),
        ..EstimateQuestion::default()
    };
    let task = Task::new(&system, &question, &signals, &NEVER).unwrap();
    let update = &MovingWindow { steps: 60, ..MovingWindow::new(LAST) }.observe(&task).updates[0];
    assert_eq!(update.end, UpdateEnd::Converged, "{update:?}");
    let found = &update.estimate;
    assert!((found[0] - phi0[0]).abs() < 1e-9 && (found[1] - omega0[0]).abs() < 1e-9, "{found:?}");
    for (told, truth) in found[4..7].iter().zip(RADII) {
        assert!((told - truth).abs() < 1e-9, "{found:?}");
    }
    // such splines are affine images of one curve, so that of one material they balance where their points do
    let point = |i: usize| -> [f64; 2] {
        let (s, c) = (i as f64 * std::f64::consts::TAU / 3.0).sin_cos();
        [RADII[i] * c, RADII[i] * s]
    };
    for axis in [0, 1] {
        let middle = (0..3).map(|i| point(i)[axis]).sum::<f64>() / 3.0;
        assert!((found[7 + axis] - middle).abs() < 1e-9, "{found:?}");
    }
}
