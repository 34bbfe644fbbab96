//! Observers on systems whose answers are known in closed form: no palm is met here.

use palmistry::System;
use palmistry::observer::*;
use std::path::Path;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// `x'' = -w^2 x + u`, the frequency being a state that does not move.
const OSCILLATOR: &str = r#"
    system "An oscillator whose position is measured"
    state x, v, w
    param u = 0
    drift f
      x' = v
      v' = -w^2*x
      w' = 0
    input g
      v' = 1
      others' = 0
    output x
"#;

fn system(text: &str) -> System {
    System::parse("test.proof", text, Path::new("")).unwrap()
}

/// `x` at a time for the start (x0, v0, w), with the derivatives by these three, first and second: differentiated by hand.
fn oscillator(t: f64, [x0, v0, w]: [f64; 3]) -> (f64, [f64; 3], [[f64; 3]; 3]) {
    let (s, c) = (w * t).sin_cos();
    let x = x0 * c + v0 / w * s;
    let by_w = -x0 * t * s - v0 / (w * w) * s + v0 / w * t * c;
    let by_ww = -x0 * t * t * c + 2.0 * v0 / w.powi(3) * s - 2.0 * v0 / (w * w) * t * c - v0 / w * t * t * s;
    let (by_xw, by_vw) = (-t * s, t * c / w - s / (w * w));
    (x, [c, s / w, by_w], [[0.0, 0.0, by_xw], [0.0, 0.0, by_vw], [by_xw, by_vw, by_ww]])
}

/// Readings of the oscillator.
fn measurements(truth: [f64; 3], samples: usize) -> Signals {
    let times: Vec<f64> = (0..samples).map(|i| 0.02 * i as f64).collect();
    let x = times.iter().map(|t| oscillator(*t, truth).0).collect();
    Signals::new(times, vec![("x".to_owned(), x)]).unwrap()
}

fn question(guess: &[(&str, f64)]) -> EstimateQuestion {
    EstimateQuestion {
        guess: guess.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        ..EstimateQuestion::default()
    }
}

fn window(method: WindowSearch) -> MovingWindow {
    MovingWindow {
        method,
        window: 50,
        steps: 20,
        unobservable_above: 1.0,
        when_unobservable: WhenUnobservable::Hold,
    }
}

#[test]
fn sensitivities_are_those_of_the_closed_form() {
    let truth = [0.7, -1.1, 2.3];
    let signals = measurements(truth, 60);
    let question =
        ModelQuestion { followed: ["x", "v", "w"].map(str::to_owned).to_vec(), ..Default::default() };
    let model = Model::new(&system(OSCILLATOR), &question, &signals).unwrap();
    let flow = ModelFlow { model: &model, signals: &signals, tolerance: 1e-12, stride: Stride::BySample };
    let samples = flow.follow(&truth, &[0, 1, 2], signals.times(), Order::Second).unwrap();
    for sample in samples {
        let (x, slopes, bends) = oscillator(sample.time, truth);
        assert!((sample.outputs[0] - x).abs() < 1e-11);
        for (i, (slope, row)) in slopes.iter().zip(bends).enumerate() {
            assert!((sample.output_slopes[(0, i)] - slope).abs() < 1e-10);
            for (j, bend) in row.iter().enumerate() {
                assert!((sample.output_bends[0][(i, j)] - bend).abs() < 1e-10, "{i} {j} at {}", sample.time);
            }
        }
    }
}

#[test]
fn an_input_field_drives_by_its_signal() {
    // v' = -w^2 x + u with u = (4 - w^2) cos(2t) is solved by x = -cos(2t)... for x0 = -1, v0 = 0
    let w = 3.0f64;
    let times: Vec<f64> = (0..200).map(|i| 0.01 * f64::from(i)).collect();
    let u = times.iter().map(|t| (4.0 - w * w) * (2.0 * t).cos()).collect();
    let x = times.iter().map(|t| -(2.0 * t).cos()).collect();
    let signals = Signals::new(times, vec![("u".to_owned(), u), ("x".to_owned(), x)]).unwrap();
    let question = ModelQuestion {
        followed: ["x", "v"].map(str::to_owned).to_vec(),
        known: [("w".to_owned(), w)].into(),
        inputs: vec![("g".to_owned(), "u".to_owned())],
    };
    let model = Model::new(&system(OSCILLATOR), &question, &signals).unwrap();
    let flow = ModelFlow { model: &model, signals: &signals, tolerance: 1e-12, stride: Stride::BySample };
    for sample in flow.follow(&[-1.0, 0.0], &[], signals.times(), Order::Value).unwrap() {
        assert!((sample.outputs[0] + (2.0 * sample.time).cos()).abs() < 1e-10, "at {}", sample.time);
    }
}

#[test]
fn both_methods_by_windows_find_speed_and_frequency() {
    let truth = [0.7, -1.1, 2.3];
    let signals = measurements(truth, 151);
    for method in [WindowSearch::Newton, WindowSearch::TrustRegion] {
        let task = Task::new(&system(OSCILLATOR), &question(&[("v", -1.21), ("w", 2.53)]), &signals, &NEVER)
            .unwrap();
        let track = window(method).observe(&task);
        assert_eq!(track.updates.len(), 3);
        assert_eq!(track.estimates.len(), 151);
        for update in &track.updates {
            assert_eq!(update.end, UpdateEnd::Converged, "{method:?}");
            let (s, c) = (truth[2] * update.from).sin_cos();
            let v = -truth[0] * truth[2] * s + truth[1] * c;
            assert!((update.estimate[0] - v).abs() < 1e-9, "{method:?}: {:?} and {v}", update.estimate);
            assert!((update.estimate[1] - truth[2]).abs() < 1e-9);
        }
        assert!(track.estimates.iter().all(|moment| moment.residual[0].abs() < 1e-9));
    }
}

/// Newton's method doubles the digits from step to step: the error after a step is at most a constant times its square.
#[test]
fn newton_converges_quadratically() {
    let truth = [0.7, -1.1, 2.3];
    let signals = measurements(truth, 50);
    let task =
        Task::new(&system(OSCILLATOR), &question(&[("v", -1.21), ("w", 2.53)]), &signals, &NEVER).unwrap();
    let error = |steps: u64| {
        let track = MovingWindow { steps, ..window(WindowSearch::Newton) }.observe(&task);
        (track.updates[0].estimate[1] - truth[2]).abs()
    };
    let errors: Vec<f64> = (1..=6).map(error).collect();
    // the factor tends to a constant: were the convergence linear it would grow without bound
    let factors: Vec<f64> = errors
        .windows(2)
        .take_while(|pair| pair[1] > 1e-11)
        .map(|pair| pair[1] / (pair[0] * pair[0]))
        .collect();
    assert!(factors.len() >= 3 && factors.iter().all(|factor| *factor < 5.0), "{errors:?} {factors:?}");
    assert!(errors[5] < 1e-10, "{errors:?}");
}

#[test]
fn a_filter_ends_near_the_truth() {
    let truth = [0.7, -1.1, 2.3];
    let signals = measurements(truth, 301);
    let task =
        Task::new(&system(OSCILLATOR), &question(&[("v", -1.0), ("w", 2.5)]), &signals, &NEVER).unwrap();
    let track = Kalman { prior: 0.1, process_noise: 1e-6, least_sigma: 1e-6 }.observe(&task);
    assert!((track.last().unwrap().state[1] - truth[2]).abs() < 1e-4, "{:?}", track.last());
    assert_eq!(track.unobserved, 0);
}

/// An oscillator about an unknown place of rest: its canonical form (x, v, -w^2 x + b) exists everywhere.
#[test]
fn a_high_gain_observer_forgets_its_first_guess() {
    let text = r#"
        system "An oscillator about an unknown place"
        state x, v, b
        param w = 2
        drift f
          x' = v
          v' = -w^2*x + b
          b' = 0
        output x
    "#;
    let place = 0.3;
    let times: Vec<f64> = (0..201).map(|i| 0.01 * f64::from(i)).collect();
    let x = times.iter().map(|t| place + 0.5 * (2.0 * t).cos()).collect();
    let signals = Signals::new(times, vec![("x".to_owned(), x)]).unwrap();
    let task = Task::new(&system(text), &question(&[("v", 0.5), ("b", 3.0)]), &signals, &NEVER).unwrap();
    let track = HighGain { gain: 15.0 }.observe(&task);
    // the error of each guess, of order one, dies out as (t gain)^2 exp(-gain t)
    for moment in track.estimates.iter().filter(|moment| moment.time >= 1.0) {
        let left = 100.0 * (15.0 * moment.time).powi(2) * (-15.0 * moment.time).exp() + 1e-9;
        assert!((moment.state[1] - 4.0 * place).abs() < left, "{moment:?}");
    }
    assert_eq!(track.unobserved, 0);
    assert_eq!(track.remarks, ["canonical form: the outputs and their derivatives, 3 coordinates"]);
}

/// Two springs of which only the sum of the stiffnesses is felt.
#[test]
fn what_cannot_be_told_apart_is_said_to_be_unseen() {
    let text = r#"
        system "Two springs"
        state x, v, a, b
        drift f
          x' = v
          v' = -(a + b)*x
          others' = 0
        output x
    "#;
    let signals = measurements([0.7, -1.1, 2.0], 60);
    let task = Task::new(&system(text), &question(&[("v", -1.1), ("a", 1.0), ("b", 3.0)]), &signals, &NEVER)
        .unwrap();
    let track = window(WindowSearch::Newton).observe(&task);
    let UpdateEnd::Unobservable { weakest } = &track.updates[0].end else { panic!("{:?}", track.updates[0]) };
    // the two differ against each other, in units of their sizes 1 and 3
    assert!((weakest[0]).abs() < 1e-6 && (weakest[1] + 3.0 * weakest[2]).abs() < 1e-6, "{weakest:?}");
    assert_eq!(track.updates[0].estimate, [-1.1, 1.0, 3.0]);
    assert_eq!(track.unobserved, 59);
}

#[test]
fn what_no_one_tells_is_named() {
    let signals = measurements([1.0, 0.0, 1.0], 9);
    let refused = |guess: &[(&str, f64)], text: &str| {
        Task::new(&system(text), &question(guess), &signals, &NEVER).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&[("v", 1.0)], OSCILLATOR),
        "nothing determines 'w': estimate it, give it under `known`, or hand over a column of that name"
    );
    assert_eq!(refused(&[("y", 1.0)], OSCILLATOR), "'y' is no state of the system; its states are x, v, w");
}
