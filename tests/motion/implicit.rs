//! Implicit outputs in observers: equations that tie measurements to states, and are read themselves nowhere.

use palmistry::System;
use palmistry::experiment::{Experiment, Scene};
use palmistry::observer::*;
use std::path::Path;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Where a ship is, of which its own speeds and the bearing of a beacon at the origin are read.
const SHIP: &str = "system \"A bearing is read\"\nstate x, y\nknown u(t), w1(t), w2(t)\n\
    drift f  x' = w1  y' = w2\noutput 0 = u*x - y\n\
    sample x in [2, 4]  y in [1, 3]  u in [0, 1]  w1 in [0, 1]  w2 in [-1, 1]\nclaim seen: rank = 2\n";

const TRUTH: [f64; 2] = [3.0, 2.0];

/// The ship's place and speeds at a time: a parabola.
fn ship(t: f64) -> ([f64; 2], [f64; 2]) {
    ([TRUTH[0] + 0.8 * t, TRUTH[1] - 1.5 * t + 1.2 * t * t], [0.8, 2.4 * t - 1.5])
}

/// Marsaglia's generator, and normal numbers by Box and Muller.
struct Draws(u64);

impl Draws {
    fn new(seed: u64) -> Draws {
        let mut draws = Draws(0x9e37_79b9_7f4a_7c15 ^ (seed + 1).wrapping_mul(0xbf58_476d_1ce4_e5b9));
        (0..20).for_each(|_| {
            let _ = draws.uniform();
        });
        draws
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// 61 samples over 1.5 s with errors of the bearing and of the speeds.
fn measurements(seed: u64, errors: [f64; 2], gain: f64) -> Signals {
    let mut draws = Draws::new(seed);
    let times: Vec<f64> = (0..61).map(|i| 0.025 * f64::from(i)).collect();
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for t in &times {
        let ([x, y], [w1, w2]) = ship(*t);
        columns[0].push(gain * y / x + errors[0] * draws.normal());
        columns[1].push(w1 + errors[1] * draws.normal());
        columns[2].push(w2 + errors[1] * draws.normal());
    }
    let [u, w1, w2] = columns;
    let named = [("u", u), ("w1", w1), ("w2", w2)];
    Signals::new(times, named.map(|(name, values)| (name.to_owned(), values)).into()).unwrap()
}

fn system() -> System {
    System::parse("ship.proof", SHIP, Path::new("")).unwrap()
}

fn question() -> EstimateQuestion {
    let guess = [("x", 2.5), ("y", 1.5)].map(|(name, value)| (name.to_owned(), value)).into();
    EstimateQuestion { guess, ..EstimateQuestion::default() }
}

fn task<'a>(system: &System, signals: &'a Signals, errors: [f64; 2]) -> Task<'a> {
    let mut task = Task::new(system, &question(), signals, &NEVER).unwrap();
    for (name, size) in [("u", errors[0]), ("w1", errors[1]), ("w2", errors[1])] {
        if size > 0.0 {
            task.errors.insert(name.to_owned(), MeasurementErrors { normal: size, rounding: 0.0 });
            task.exact = false;
            (task.sigma, task.noise) = (size, Noise::Stated { normal: size, rounding: 0.0 });
        }
    }
    task
}

fn window() -> MovingWindow {
    MovingWindow { steps: 30, ..MovingWindow::new(60) }
}

/// Of exact measurements the state comes back, with the output named as the file has it.
#[test]
fn exact_readings_give_the_state() {
    let (system, signals) = (system(), measurements(0, [0.0; 2], 1.0));
    let task = task(&system, &signals, [0.0; 2]);
    assert_eq!(task.full.outputs, ["0 = u*x - y"]);
    let track = window().observe(&task);
    let update = &track.updates[0];
    assert_eq!(update.end, UpdateEnd::Converged, "{update:?}");
    for (found, truth) in update.estimate.iter().zip(TRUTH) {
        assert!((found - truth).abs() < 1e-7, "{found}");
    }
}

/// The bound is the one by hand: with speeds that are read exactly, `u x - y` has the derivatives `(u, -1)` by the first place and errs by
/// `x` times the bearing's error.
#[test]
fn the_bound_is_that_of_the_measurements() {
    let error = 1e-3;
    let (system, signals) = (system(), measurements(0, [0.0; 2], 1.0));
    let task = task(&system, &signals, [error, 0.0]);
    let bounds = window().bounds(&task, &TRUTH, &(0..61), &[]);
    let mut information = [[0.0; 2]; 2];
    for t in signals.times() {
        let ([x, y], _) = ship(*t);
        let row = [y / x / (x * error), -1.0 / (x * error)];
        for i in 0..2 {
            for j in 0..2 {
                information[i][j] += row[i] * row[j];
            }
        }
    }
    let [[a, b], [_, d]] = information;
    let determinant = a * d - b * b;
    for (bound, by_hand) in bounds.iter().zip([(d / determinant).sqrt(), (a / determinant).sqrt()]) {
        assert!((bound / by_hand - 1.0).abs() < 1e-4, "{bound} {by_hand}");
    }
}

/// Over 200 seeds errors are as large as the bounds, with errors of the bearing, and of the speeds beside it; and the residual is what noise
/// explains.
#[test]
fn errors_are_as_large_as_their_bounds() {
    let system = system();
    for errors in [[2e-3, 0.0], [2e-3, 0.02], [1e-4, 0.02]] {
        let (mut squares, mut fits, mut chi_squares) = ([0.0; 2], 0, 0.0);
        const SEEDS: u64 = 200;
        for seed in 0..SEEDS {
            let signals = measurements(seed, errors, 1.0);
            let task = task(&system, &signals, errors);
            let track = window().observe(&task);
            let update = &track.updates[0];
            fits += u32::from(update.end == UpdateEnd::Converged);
            chi_squares += update.fit.unwrap().chi_square;
            for place in 0..2 {
                squares[place] +=
                    ((update.estimate[place] - TRUTH[place]) / update.deviations[place]).powi(2);
            }
        }
        for square in squares {
            let ratio = (square / SEEDS as f64).sqrt();
            assert!((0.8..1.2).contains(&ratio), "{errors:?}: {ratio}");
        }
        assert!(fits >= 199, "{errors:?}: {fits}");
        // 59 degrees of freedom
        let mean = chi_squares / SEEDS as f64;
        assert!((mean - 59.0).abs() < 5.0 * (2.0 * 59.0 / SEEDS as f64).sqrt(), "{errors:?}: {mean}");
    }
}

/// A bearing whose gain is off is no bearing of a ship that moves so: said where the noise is stated.
#[test]
fn a_wrong_gain_does_not_fit() {
    let system = system();
    for seed in 0..20 {
        let signals = measurements(seed, [1e-4, 0.0], 1.1);
        let task = task(&system, &signals, [1e-4, 0.0]);
        let track = window().observe(&task);
        assert!(track.is_contradicted(), "{:?}", track.updates[0]);
    }
}

/// Filters compare outputs with what is read of them: here they say that they cannot.
#[test]
fn filters_refuse_in_words() {
    let (system, signals) = (system(), measurements(0, [1e-3, 0.0], 1.0));
    let task = task(&system, &signals, [1e-3, 0.0]);
    let methods: [&dyn Observer; 3] = [&Kalman::default(), &Unscented::default(), &HighGain::default()];
    for method in methods {
        let track = method.observe(&task);
        assert!(track.estimates.is_empty());
        assert!(track.remarks[0].contains("0 = u*x - y is not measured"), "{:?}", track.remarks);
    }
}

/// The same as a scene with a recording: columns that the rank alone asks for need not be there, and the noise belongs to columns.
#[test]
fn a_recording_with_an_implicit_output() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ship.proof"), SHIP).unwrap();
    let signals = measurements(3, [1e-3, 0.0], 1.0);
    let mut csv = String::from("time,u,w1,w2\n");
    for (row, t) in signals.times().iter().enumerate() {
        let [u, w1, w2] = [0, 1, 2].map(|place| signals.column(place)[row]);
        csv += &format!("{t:?},{u:?},{w1:?},{w2:?}\n");
    }
    std::fs::write(folder.path().join("ship.csv"), csv).unwrap();
    let scene = |sensor: &str| {
        let text = format!(
            "title = \"A ship\"\nmodel = \"ship.proof\"\n[data]\nrecord = \"ship.csv\"\n{sensor}[observer]\n\
             methods = [\"trust-region\", \"multiple-shooting\"]\nestimate = [\"x\", \"y\"]\n\
             guess = {{ x = 2.5, y = 1.5 }}\nwindow = 60\nsteps = 30\n"
        );
        let path = folder.path().join("ship.toml");
        Scene::parse(&path.to_string_lossy(), &text).and_then(|scene| Experiment::new(scene, None))
    };
    for (sensor, size) in [("[sensor.u]\nnoise = 1e-3\n", 1e-3), ("", 1e-3)] {
        let experiment = scene(sensor).unwrap();
        for answer in experiment.observe().unwrap() {
            let update = &answer.track.updates[0];
            assert_eq!(update.end, UpdateEnd::Converged, "{sensor}: {update:?}");
            for (place, truth) in TRUTH.iter().enumerate() {
                let error = (update.estimate[place] - truth).abs();
                assert!(
                    update.deviations[place] > size && error < 5.0 * update.deviations[place],
                    "{update:?}"
                );
            }
        }
    }
    let error = scene("[sensor]\nnoise = 1e-3\n").unwrap_err().to_string();
    assert!(error.contains("no output is read"), "{error}");
}
