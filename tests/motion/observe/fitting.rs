//! The test of fit: calibrated for each loss, for windows together and where they meet; and bounds that are held.
//!
//! Oracle: under the stated noise a probability is even, whatever was fitted; wrong models by closed forms; regression with an unknown that is fixed.

use crate::common::{folder, json, palmistry, words_of, write};
use crate::observe::{NEVER, answers, experiment};
use palmistry::experiment::Experiment;
use palmistry::observer::{Signals, Track, UpdateEnd};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const NOISE: f64 = 0.05;

/// A spring that hardens, and one that does not.
const SPRING: &str =
    "state x, v param c = 0 drift f x' = v v' = -4*x - c*x^3 output x sample x in [-2, 2] v in [-4, 4]";
const POINT: &str = "state x, v drift f x' = v v' = 0 output x sample x in [-5, 5] v in [-5, 5]";

fn scene(equations: &str, start: &str, more: &str, seed: u64) -> (tempfile::TempDir, Experiment) {
    let folder = folder();
    write(&folder, "own.proof", format!("system \"A system of its own\" {equations}"));
    let model = folder.path().join("own.proof");
    let text = format!(
        "title = \"Fits\"\nseed = {seed}\nmodel = \"{}\"\nduration = 6\nsamples = 121\n[start]\n{start}\n[sensor]\nnoise = {NOISE}\n\
         [observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\", \"v\"]\nguess = {{ x = 0.9, v = 0.4 }}\nsteps = 40\n{more}",
        model.display()
    );
    let found = experiment(&text);
    (folder, found)
}

/// The same measurements, changed.
fn changed(mut experiment: Experiment, change: impl Fn(usize, f64, f64) -> f64) -> Experiment {
    let times = experiment.signals.times().to_vec();
    let values = experiment.signals.column(0).iter().zip(&times).enumerate();
    let values = values.map(|(i, (value, time))| change(i, *time, *value)).collect();
    experiment.signals = Signals::new(times, vec![("x".to_owned(), values)]).unwrap();
    experiment
}

fn track(experiment: &Experiment) -> Track {
    experiment.run(&NEVER, &|_| ()).unwrap().remove(0).track
}

/// The largest distance of some probabilities from even ones.
fn unevenness(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    let n = all.len() as f64;
    let apart = |(i, p): (usize, &f64)| (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs());
    all.iter().enumerate().map(apart).fold(0.0, f64::max)
}

const LOSSES: [&str; 3] = ["\"squares\"", "\"huber\"", "{ huber = 2.5 }"];

/// By Kolmogorov's limit of one in a thousand; and of a hundred right models as many are below 0.05 as the binomial distribution lets be (0 to 13, but for one in 5000).
#[test]
fn each_loss_has_a_calibrated_test() {
    for loss in LOSSES {
        let probability = |seed: u64| {
            let more = format!("window = 120\nloss = {loss}\n");
            let (_folder, experiment) = scene(SPRING, "x = 1.0\nv = 0.5", &more, seed);
            track(&experiment).updates[0].fit.unwrap().probability
        };
        let all: Vec<f64> = (1..=100).map(probability).collect();
        let few = all.iter().filter(|p| **p < 0.05).count();
        assert!(few <= 13, "{loss}: {few}");
        let apart = unevenness(all);
        assert!(apart < 0.195, "{loss}: {apart}");
    }
}

/// A cubic term that the model lacks, small enough that hardly a residual is an outlier: no loss lets it pass.
#[test]
fn no_loss_lets_a_wrong_model_pass() {
    for loss in LOSSES {
        let more = format!("window = 120\nloss = {loss}\nknown = {{ c = 0.0 }}\n");
        let (_folder, experiment) = scene(SPRING, "x = 1.0\nv = 0.5", &more, 5);
        assert!(track(&experiment).is_sound(), "{loss}");
        let wrong = changed(experiment, |_, time, value| value + hardened(time) - plain(time));
        let found = track(&wrong);
        let update = &found.updates[0];
        assert!(!update.is_borne_out() && update.fit.unwrap().probability < 1e-6, "{loss}: {update:?}");
    }
}

/// `x'' = -4 x`, and `x'' = -4 x - 0.3 x^3`, from 1 and 0.5.
fn plain(time: f64) -> f64 {
    (2.0 * time).cos() + 0.25 * (2.0 * time).sin()
}

fn hardened(time: f64) -> f64 {
    let steps = (time / 1e-3).round() as usize;
    let force = |x: f64| -4.0 * x - 0.3 * x * x * x;
    let (mut x, mut v) = (1.0, 0.5);
    for _ in 0..steps {
        // Verlet's method, of the second order
        let half = v + 0.5e-3 * force(x);
        x += 1e-3 * half;
        v = half + 0.5e-3 * force(x);
    }
    x
}

/// Five of a hundred measurements far off pass by a robust loss, fifteen do not, and of least squares none are left out.
#[test]
fn a_tenth_of_the_readings_may_be_outliers() {
    let off = |every: usize| {
        move |i: usize, _: f64, value: f64| {
            value + if i % every == 3 { 1.0 - 2.0 * f64::from(u8::from(i.is_multiple_of(2))) } else { 0.0 }
        }
    };
    for (every, fits) in [(20, true), (7, false)] {
        let (_folder, experiment) = scene(SPRING, "x = 1.0\nv = 0.5", "window = 120\nloss = \"huber\"\n", 6);
        let found = track(&changed(experiment, off(every)));
        let (update, fit) = (&found.updates[0], found.updates[0].fit.unwrap());
        assert_eq!(update.is_borne_out(), fits, "{update:?}");
        assert_eq!(fit.outliers, (0..121).filter(|i| i % every == 3).count());
        assert_eq!(fit.has_outliers(), !fits);
    }
}

/// Residuals that are no larger than their stated noise pass, rounded ones and exact ones too.
#[test]
fn what_is_better_than_stated_passes() {
    for more in ["", "inherit = false\n", "loss = \"huber\"\n"] {
        let more = format!("window = 30\n{more}");
        let (_folder, experiment) = scene(SPRING, "x = 1.0\nv = 0.5", &more, 1);
        let exact = changed(experiment.clone(), |_, time, _| plain(time));
        let rounded = changed(experiment, |_, time, _| (plain(time) / 0.02).round() * 0.02);
        for found in [track(&exact), track(&rounded)] {
            assert!(found.is_sound(), "{:?}", found.together());
            assert!(found.together().unwrap().fits);
        }
    }
}

/// A rate that is read 0.025 too large drives the model: each window passes by itself, and where they meet they do not.
#[test]
fn windows_that_pass_alone_do_not_agree_where_they_meet() {
    let gyro = "state x param u drift f x' = 0 input g x' = 1 output x sample x in [-5, 5]";
    let folder = folder();
    write(&folder, "gyro.proof", format!("system \"A gyro\" {gyro}"));
    let (own, whole) = ("inherit = false", "whole = true");
    let windows = |seed: u64, bias: f64, more: &str| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut error = || {
            let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
            NOISE * radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
        };
        let mut rows = String::from("time,x,u\n");
        for i in 0..201 {
            let t = 0.05 * f64::from(i);
            rows += &format!("{t:?},{:?},{:?}\n", t.sin() + error(), t.cos() + bias);
        }
        write(&folder, "gyro.csv", rows);
        let place = folder.path().display();
        let text = format!(
            "title = \"A gyro\"\nmodel = \"{place}/gyro.proof\"\n[data]\nrecord = \"{place}/gyro.csv\"\non_fault = \"skip\"\n[sensor]\nnoise = {NOISE}\n[observer]\n\
             methods = [\"trust-region\"]\ninputs = {{ g = \"u\" }}\nestimate = [\"x\"]\nguess = {{ x = 0.5 }}\nsteps = 20\nwindow = 40\n{more}\n"
        );
        let path = write(&folder, "gyro.toml", &text);
        (path, track(&experiment(&text)))
    };
    let mut right = 0;
    for seed in 1..=20 {
        right += usize::from(windows(seed, 0.0, ["", own, whole][seed as usize % 3]).1.is_sound());
    }
    assert!(right >= 19, "{right} of 20 right models");
    let (path, found) = windows(1, 0.025, own);
    assert!(found.updates.iter().all(|update| update.is_borne_out()), "{:?}", found.updates);
    let (seam, probability) = found.together().unwrap().worst_seam.unwrap();
    assert!(probability < 1e-3 && seam.chi_square > 10.0 && !found.is_sound(), "{seam:?}");
    let output = palmistry(&["observe", path.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(json(&output)["observers"][0]["together"]["fits"], false);
    let words = words_of(&palmistry(&["observe", path.to_str().unwrap()]));
    assert!(
        words.contains("windows together fail the chi-square test") && words.contains("try next ("),
        "{words}"
    );
    // with what was learned before, too
    assert!(!windows(1, 0.025, "").1.is_sound());
    // a bias that leaves at most 0.55 deviations at a sample: neither the squares nor neighbours tell it, and the residuals drift
    let (path, found) = windows(1, 0.0055, whole);
    let fit = found.updates[0].fit.unwrap();
    println!("{fit:?}");
    assert!(
        !fit.fits && fit.neighbours.unwrap() > 1e-3 && fit.by_drift().unwrap().probability < 3e-4,
        "{fit:?}"
    );
    let output = json(&palmistry(&["observe", path.to_str().unwrap(), "--json"]));
    assert_eq!(output["observers"][0]["updates"][0]["fit"]["drift"]["output"], "x");
    let words = words_of(&palmistry(&["observe", path.to_str().unwrap()]));
    assert!(words.contains("and they drift, those of x most"), "{words}");
}

/// Over 60 seeds the squares at seams have the mean of chi-square: of windows by themselves and of those that inherit.
#[test]
fn seams_of_right_models_have_the_covariance_that_is_believed() {
    for more in ["inherit = false\n", ""] {
        let (mut sum, mut degrees) = (0.0, 0.0);
        for seed in 1..=60 {
            let (_folder, experiment) =
                scene(POINT, "x = 1.0\nv = 0.5", &format!("window = 40\n{more}"), seed);
            for seam in track(&experiment).updates.iter().filter_map(|update| update.seam) {
                (sum, degrees) = (sum + seam.chi_square, degrees + seam.degrees as f64);
            }
        }
        assert!(degrees >= 100.0, "{degrees}");
        // the standard deviation of the mean, three times; seams that follow each other share a window
        let room = 4.0 * (2.0 / degrees).sqrt();
        assert!((sum / degrees - 1.0).abs() < room, "{more}: {} of {degrees}", sum / degrees);
    }
}

/// The true speed is 0.5, and the bound 0.3: the place is then the mean of `x - 0.3 t`, and a bar is told beside the bound that is held.
#[test]
fn bounds_are_held_by_every_method() {
    let more = "window = 120\nbounds = { v = [-1.0, 0.3] }\n";
    for method in ["newton", "trust-region", "multiple-shooting", "kalman", "unscented", "high-gain"] {
        let (_folder, mut experiment) = scene(POINT, "x = 1.0\nv = 0.5", more, 1);
        experiment.scene.observer.methods = vec![serde_method(method)];
        let found = track(&experiment);
        let beyond = found.estimates.iter().filter(|at| at.state[1] > 0.3).count();
        assert_eq!(beyond, 0, "{method}");
        assert!(
            found.remarks.iter().any(|remark| remark.contains("'v' is at its bound 0.3")),
            "{method}: {:?}",
            found.remarks
        );
        let Some(update) = found.updates.first() else { continue };
        assert_eq!(update.at_bounds, [(1, 0.3)], "{method}");
        let (times, values) = (experiment.signals.times(), experiment.signals.column(0));
        let mean = times.iter().zip(values).map(|(t, x)| x - 0.3 * t).sum::<f64>() / times.len() as f64;
        assert!((update.estimate[0] - mean).abs() < 1e-9, "{method}: {} for {mean}", update.estimate[0]);
        assert_eq!(update.end, UpdateEnd::DoesNotFit, "{method}");
    }
    // a guess beyond a bound is no estimate either
    let (_folder, experiment) =
        scene(POINT, "x = 1.0\nv = 0.5", "window = 120\nblind = 1e-9\nbounds = { v = [-1.0, 0.3] }\n", 1);
    assert!(track(&experiment).updates[0].estimate[1] <= 0.3);
}

fn serde_method(name: &str) -> palmistry::experiment::Method {
    use palmistry::experiment::Method;
    [
        Method::Newton,
        Method::TrustRegion,
        Method::MultipleShooting,
        Method::Kalman,
        Method::Unscented,
        Method::HighGain,
    ]
    .into_iter()
    .find(|method| method.name() == name)
    .unwrap()
}

/// Two unknowns that pull at each other, both bounded: by a grid over both the best state is where one bound holds.
#[test]
fn a_step_along_a_bound_is_the_best_that_is_left() {
    let more = "window = 120\nbounds = { v = [-1.0, 0.3], x = [0.0, 1.2] }\n";
    let (_folder, experiment) = scene(POINT, "x = 1.0\nv = 0.5", more, 4);
    let update = &answers(&experiment)[0].track.updates[0];
    let (times, values) = (experiment.signals.times(), experiment.signals.column(0));
    let rms_residual = |x: f64, v: f64| -> f64 {
        times.iter().zip(values).map(|(t, read)| (x + v * t - read).powi(2)).sum()
    };
    let own = rms_residual(update.estimate[0], update.estimate[1]);
    for i in 0..=120 {
        for k in 0..=130 {
            let (x, v) = (0.01 * f64::from(i), -1.0 + 0.01 * f64::from(k));
            assert!(rms_residual(x, v) > own - 1e-9, "{x} {v}");
        }
    }
    assert_eq!(update.at_bounds.len(), 2, "{:?}", update.estimate);
}

/// An error and a bound are printed in one unit, that of the state: an estimate that is off by two of 100 s is so by a few of its bounds.
#[test]
fn errors_and_bounds_have_one_unit() {
    let (_folder, experiment) = scene(POINT, "x = 100.0\nv = 0.5", "window = 120\n", 2);
    let answers = answers(&experiment);
    let observed = palmistry::report::Observed::of(&experiment, &answers);
    let text = palmistry::report::observe_text(&observed);
    assert!(text.contains("both in the unit of the state"), "{text}");
    let found = palmistry::report::observe_json(&observed);
    let state = &found["observers"][0]["updates"][0]["states"]["x"];
    let of = |key: &str| state[key].as_f64().unwrap();
    assert_eq!(of("error"), (of("recovered") - of("true")).abs());
    assert!((of("relative_error") - of("error") / 100.0).abs() < 1e-15 && of("error") < 5.0 * of("bound"));
    let line = text.lines().find(|line| line.trim_start().starts_with("x ")).unwrap();
    assert!(line.contains(&format!("error {:.1e}", of("error"))), "{line}");
}
