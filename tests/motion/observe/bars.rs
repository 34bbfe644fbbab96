//! How well a state is known at every sample, and whether a filter is what it believes of itself.
//!
//! Oracles: `x' = a x`, whose bound at any time is written down; the matrix of Cramér and Rao of a pendulum with the state at that very sample for the unknown, whose
//! measurements are followed to both sides by an integrator of these lines and differenced; regression, which a filter without process noise has to come to.

use crate::common::{folder, write};
use crate::observe::{NEVER, answers, experiment};
use nalgebra::{DMatrix, Matrix2, Vector2};
use palmistry::experiment::Experiment;
use palmistry::observer::{HighGain, Innovations, Observer, Track};

const NOISE: f64 = 0.02;

/// A scene of a system of two lines with its measurements' noise.
fn scene(equations: &str, start: &str, more: &str, seed: u64) -> (tempfile::TempDir, Experiment) {
    let folder = folder();
    write(&folder, "own.proof", format!("system \"A system of its own\" {equations}"));
    let model = folder.path().join("own.proof");
    let text = format!(
        "title = \"Bars\"\nseed = {seed}\nmodel = \"{}\"\nduration = 5\nsamples = 101\n[start]\n{start}\n[sensor]\nnoise = {NOISE}\n[observer]\n{more}",
        model.display()
    );
    let found = experiment(&text);
    (folder, found)
}

const GROWTH: &str = "state x drift f x' = x output x sample x in [0.5, 2]";
const POINT: &str = "state x, v drift f x' = v v' = 0 output x sample x in [-5, 5] v in [-5, 5]";

#[test]
fn the_bound_of_what_grows_grows_with_it() {
    for (more, windows) in [("window = 100\n", 1), ("window = 20\ninherit = false\n", 5)] {
        let own = format!(
            "methods = [\"trust-region\"]\nestimate = [\"x\"]\nguess = {{ x = 1.1 }}\nsteps = 30\n{more}"
        );
        let (_folder, experiment) = scene(GROWTH, "x = 1.0", &own, 1);
        let answer = &answers(&experiment)[0];
        let track = &answer.track;
        assert_eq!(track.updates.len(), windows);
        let times = experiment.signals.times();
        let table = experiment.track_table(answer, None).unwrap();
        let bounds = table.column("x_bound").unwrap();
        for (row, estimate) in track.estimates.iter().enumerate() {
            // the window whose estimate this sample has: the first of two that share it
            let steps = 100 / windows;
            let first = row.saturating_sub(1) / steps * steps;
            let square: f64 = (first..=first + steps).map(|i| (2.0 * (times[i] - times[first])).exp()).sum();
            let bound = NOISE / square.sqrt() * (times[row] - times[first]).exp();
            assert!(
                (estimate.deviations[0] / bound - 1.0).abs() < 1e-6,
                "{row}: {:e} for {bound:e}",
                estimate.deviations[0]
            );
            assert_eq!(bounds[row], estimate.deviations[0]);
        }
        // at the end of the whole it is off by no more than its bar, which is 148 times that of the beginning
        if windows == 1 {
            let last = track.last().unwrap();
            assert!((last.state[0] - 5f64.exp()).abs() < 4.0 * last.deviations[0]);
        }
    }
}

/// A pendulum `phi'' = -4 sin(phi) - 0.3 phi'` from a state over a time, in steps of the classical method of Runge and Kutta.
fn swung(state: Vector2<f64>, time: f64) -> Vector2<f64> {
    let rate = |s: Vector2<f64>| Vector2::new(s[1], -4.0 * s[0].sin() - 0.3 * s[1]);
    let steps = (time.abs() / 0.005).ceil().max(1.0);
    let h = time / steps;
    (0..steps as usize).fold(state, |s, _| {
        let a = rate(s);
        let b = rate(s + a * (h / 2.0));
        let c = rate(s + b * (h / 2.0));
        let d = rate(s + c * h);
        s + (a + (b + c) * 2.0 + d) * (h / 6.0)
    })
}

#[test]
fn a_pendulum_is_known_at_each_sample_as_the_matrix_there_says() {
    let equations = "state phi, omega angle phi drift f phi' = omega omega' = -4*sin(phi) - 3/10*omega output phi \
                     sample phi in [-2, 2] omega in [-3, 3]";
    let own = "methods = [\"trust-region\"]\nestimate = [\"phi\", \"omega\"]\nguess = { phi = 1.1, omega = 0.4 }\nsteps = 50\nwindow = 100\n";
    let (_folder, experiment) = scene(equations, "phi = 1.2\nomega = 0.5", own, 3);
    let track = &answers(&experiment)[0].track;
    let times = experiment.signals.times();
    for row in [0, 13, 50, 77, 100] {
        let here = &track.estimates[row];
        let state = Vector2::new(here.state[0], here.state[1]);
        let mut information = Matrix2::zeros();
        for time in times {
            let read = |s: Vector2<f64>| swung(s, time - times[row])[0];
            let step = 1e-5;
            let slope = |k: usize| {
                let mut moved = Vector2::zeros();
                moved[k] = step;
                (read(state + moved) - read(state - moved)) / (2.0 * step)
            };
            let slope = Vector2::new(slope(0), slope(1));
            information += slope * slope.transpose() / (NOISE * NOISE);
        }
        let covariance = information.try_inverse().unwrap();
        for k in 0..2 {
            let bound = covariance[(k, k)].sqrt();
            assert!(
                (here.deviations[k] / bound - 1.0).abs() < 1e-4,
                "{row} {k}: {} for {bound}",
                here.deviations[k]
            );
        }
    }
    // the bars of the first sample are not those of the others
    assert!((track.estimates[50].deviations[0] / track.estimates[0].deviations[0] - 1.0).abs() > 0.2);
}

fn filtered(method: &str, more: &str, seed: u64) -> (tempfile::TempDir, Experiment) {
    let own = format!(
        "methods = [\"{method}\"]\nestimate = [\"x\", \"v\"]\nguess = {{ x = 0.9, v = 0.6 }}\n\
         kalman = {{ prior = 100.0, process_noise = 0.0 }}\nunscented = {{ prior = 100.0, process_noise = 0.0 }}\n{more}"
    );
    scene(POINT, "x = 1.0\nv = 0.5", &own, seed)
}

/// Without process noise and with hardly a prior a filter of a straight line is regression.
#[test]
fn a_filter_has_the_bars_of_regression() {
    for method in ["kalman", "unscented"] {
        let (_folder, experiment) = filtered(method, "", 2);
        let track = &answers(&experiment)[0].track;
        let times = experiment.signals.times();
        for row in [20, 60, 100] {
            let design = DMatrix::from_fn(row + 1, 2, |i, k| (times[i] - times[row]).powi(k as i32));
            let covariance = (design.tr_mul(&design)).try_inverse().unwrap() * NOISE * NOISE;
            for k in 0..2 {
                let bound = covariance[(k, k)].sqrt();
                let own = track.estimates[row].deviations[k];
                assert!((own / bound - 1.0).abs() < 2e-3, "{method} {row} {k}: {own} for {bound}");
            }
        }
    }
}

fn innovations(track: &Track) -> Innovations {
    track.innovations.unwrap_or_else(|| panic!("{:?}", track.remarks))
}

/// Of right models the probability is even, by Kolmogorov's limit of one in a thousand; of a model without its force the innovations do not pass.
#[test]
fn innovations_are_even_of_what_is_right_and_fail_of_what_is_wrong() {
    for method in ["kalman", "unscented"] {
        let mut all: Vec<f64> = (1..=80)
            .map(|seed| innovations(&answers(&filtered(method, "", seed).1)[0].track).probability)
            .collect();
        all.sort_by(f64::total_cmp);
        let n = all.len() as f64;
        let apart = |(i, p): (usize, &f64)| (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs());
        let most = all.iter().enumerate().map(apart).fold(0.0, f64::max);
        assert!(most < 1.95 / n.sqrt(), "{method}: {most}");
        let (_folder, mut experiment) = filtered(method, "", 1);
        let times = experiment.signals.times().to_vec();
        let bent = experiment.signals.column(0).iter().zip(&times).map(|(x, t)| x + 0.02 * t * t).collect();
        experiment.signals = palmistry::observer::Signals::new(times, vec![("x".to_owned(), bent)]).unwrap();
        let wrong = experiment.run(&NEVER, &|_| ()).unwrap();
        assert!(!innovations(&wrong[0].track).fits, "{method}");
    }
}

/// The high-gain observer's own bars: over 60 seeds the root of the mean square of its errors, in deviations, is one to a fifth, after its first errors have died out.
#[test]
fn the_bars_of_the_high_gain_observer_are_its_errors() {
    let mut squares = [0.0; 2];
    let mut count = 0.0f64;
    for seed in 1..=60 {
        let (_folder, experiment) = filtered("high-gain", "", seed);
        let task = experiment.task(&NEVER).unwrap();
        let track = HighGain { gain: 4.0 }.observe(&task);
        assert!(innovations(&track).fits, "{:?}", track.innovations);
        for row in [70, 100] {
            let (estimate, time) = (&track.estimates[row], experiment.signals.times()[row]);
            for (k, truth) in [1.0 + 0.5 * time, 0.5].into_iter().enumerate() {
                squares[k] += ((estimate.state[k] - truth) / estimate.deviations[k]).powi(2);
            }
            count += 1.0;
        }
    }
    for square in squares {
        let ratio = (square / count).sqrt();
        assert!((0.8..1.2).contains(&ratio), "{ratio}");
    }
}

/// What compares nothing has neither bars nor a verdict.
#[test]
fn integration_has_no_bars() {
    let (_folder, experiment) = filtered("integration", "", 1);
    let track = &answers(&experiment)[0].track;
    assert!(track.innovations.is_none() && track.together().is_none());
    assert!(track.estimates.iter().all(|at| at.deviations.is_empty()));
    let page =
        palmistry::report::observe_page(&palmistry::report::Observed::of(&experiment, &answers(&experiment)));
    assert!(!page.contains("very update converged"), "a method without updates has none that converged");
    assert!(page.contains("its estimates are not tested against the measurements"));
}
