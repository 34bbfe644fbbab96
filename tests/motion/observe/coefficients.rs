//! A shape's coefficients as states: `constraint/coefficients.proof` held against bodies that Newton's laws move.

use super::{NEVER, experiment, text};
use palmistry::System;
use palmistry::observer::*;
use std::path::Path;

/// A window of a body that is thrown about, of which the contacts and the palms are read: its support function comes back, at all normals. Truth is the body's own, and its motion a
/// simulation that has no equation of the file.
#[test]
fn coefficients_of_a_shape_are_states() {
    let experiment = experiment(&text("same_rate"));
    let column = |name: &str| -> Vec<f64> { experiment.truth(name).unwrap()[..161].to_vec() };
    let times = experiment.signals.times()[..161].to_vec();
    let (phi1, phi2) = (column("phi1"), column("phi2"));
    let phi12: Vec<f64> = phi1.iter().zip(&phi2).map(|(a, b)| a + b).collect();
    let still = ["u1", "u1'", "u12", "u12'"].map(|name| (name.to_owned(), vec![0.0; times.len()]));
    let read = [("s1", column("s1")), ("s2", column("s2")), ("phi1", phi1.clone()), ("phi12", phi12.clone())];
    let columns = read.into_iter().map(|(name, values)| (name.to_owned(), values)).chain(still).collect();
    let signals = Signals::new(times, columns).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/constraint/coefficients.proof");
    let system = System::read(&file).unwrap();
    let (phi0, omega0) = (column("phi0"), column("omega0"));
    let guess = [
        ("phi0", phi0[0]),
        ("omega0", 1.05 * omega0[0]),
        ("a0", 1.15),
        ("a1", 0.0),
        ("b1", 0.0),
        ("a2", 0.09),
        ("b2", 0.01),
        ("a3", 0.02),
        ("b3", -0.03),
        ("rho2", 0.9),
    ];
    let question = EstimateQuestion {
        guess: guess.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        // the frame of the body: nothing else tells it
        clamped: vec!["phi0".to_owned()],
        known: [("rate1", 0.4), ("rate12", 0.4), ("drive1", 0.0), ("drive12", 0.0)]
            .map(|(name, value)| (name.to_owned(), value))
            .into(),
        ..EstimateQuestion::default()
    };
    let task = Task::new(&system, &question, &signals, &NEVER).unwrap();
    let update = &MovingWindow { steps: 60, ..MovingWindow::new(160) }.observe(&task).updates[0];
    assert_eq!(update.end, UpdateEnd::Converged, "{update:?}");
    let found = &update.estimate;
    assert!((found[1] - omega0[0]).abs() < 1e-6, "{found:?}");
    let support = |angle: f64| {
        let harmonic = |k: usize| {
            let (s, c) = (k as f64 * angle).sin_cos();
            found[2 * k + 1] * c + found[2 * k + 2] * s
        };
        found[2] + harmonic(1) + harmonic(2) + harmonic(3)
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    for (i, (r1, r2)) in column("r1").iter().zip(column("r2")).enumerate() {
        for (told, truth) in
            [(support(phi1[i] - phi0[i] - quarter), *r1), (support(phi12[i] - phi0[i] + quarter), r2)]
        {
            assert!((told - truth).abs() < 1e-6, "{told} {truth} {found:?}");
        }
    }
}
