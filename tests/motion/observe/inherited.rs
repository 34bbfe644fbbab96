//! What windows hand on, estimates over whole records, bounds, and a robust loss.
//!
//! Oracle: a point that moves at one speed, read with errors. The best line through all measurements, its deviations and its residual are
//! known in closed form (regression), whatever the windows.

use crate::common::{folder, write};
use crate::observe::{NEVER, answers, experiment};
use palmistry::observer::{MovingWindow, Observer, UpdateEnd};

const NOISE: f64 = 0.05;
const SAMPLES: usize = 201;

/// A point at `x(t) = x0 + v t`, in windows of 40 steps.
fn point(more: &str) -> (tempfile::TempDir, palmistry::experiment::Experiment) {
    let folder = folder();
    write(
        &folder,
        "point.proof",
        "system \"A point\" state x, v drift f x' = v v' = 0 output x sample x in [-5, 5] v in [-5, 5]",
    );
    let model = folder.path().join("point.proof");
    let scene = format!(
        "title = \"A point\"\nmodel = \"{}\"\nduration = 10\nsamples = {SAMPLES}\n[start]\nx = 1.0\nv = 0.5\n[sensor]\nnoise = {NOISE}\n\
         [observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\", \"v\"]\nguess = {{ x = 0.3, v = 0.1 }}\nwindow = 40\n{more}",
        model.display()
    );
    (folder, experiment(&scene))
}

/// The best line `a + b t` through some measurements, and the standard deviations of `a` and `b`.
fn line(times: &[f64], values: &[f64]) -> ([f64; 2], [f64; 2]) {
    let n = times.len() as f64;
    let (t, x) = (times.iter().sum::<f64>() / n, values.iter().sum::<f64>() / n);
    let square: f64 = times.iter().map(|time| (time - t).powi(2)).sum();
    let slope = times.iter().zip(values).map(|(time, value)| (time - t) * (value - x)).sum::<f64>() / square;
    let deviation = NOISE / square.sqrt();
    ([x - slope * t, slope], [NOISE * (1.0 / n + t * t / square).sqrt(), deviation])
}

#[test]
fn the_last_window_knows_what_all_readings_tell() {
    let (_folder, experiment) = point("");
    let track = &answers(&experiment)[0].track;
    assert_eq!(track.updates.len(), 5);
    assert!(track.is_sound() && track.remarks.is_empty(), "{:?}", track.remarks);
    let times = experiment.signals.times();
    let values = experiment.signals.column(0);
    for (place, update) in track.updates.iter().enumerate() {
        assert_eq!((&update.end, update.is_heir), (&UpdateEnd::Converged, place > 0));
        // all measurements up to the end of this window
        let rows = 40 * (place + 1) + 1;
        let shifted: Vec<f64> = times[..rows].iter().map(|time| time - update.from).collect();
        let (best, deviations) = line(&shifted, &values[..rows]);
        for i in 0..2 {
            assert!((update.estimate[i] - best[i]).abs() < 1e-6 * deviations[i], "{place} {i}");
            assert!((update.deviations[i] / deviations[i] - 1.0).abs() < 1e-6, "{place} {i}");
        }
        let fit = update.fit.unwrap();
        // a window has its own measurements but the one it shares, and two relations in the place of that
        assert_eq!(fit.degrees, if place == 0 { 41 - 2 } else { 40 + 2 - 2 });
    }
    // where nothing is inherited each window stands alone
    let (_folder, alone) = point("inherit = false\n");
    let alone = &answers(&alone)[0].track;
    let own = &alone.updates[4];
    let (best, deviations) =
        line(&times[160..].iter().map(|time| time - own.from).collect::<Vec<_>>(), &values[160..]);
    assert!(!own.is_heir && (own.estimate[1] - best[1]).abs() < 1e-6 * deviations[1]);
    assert!(own.deviations[1] > 5.0 * track.updates[4].deviations[1]);
}

#[test]
fn a_whole_record_is_one_window() {
    let (_folder, experiment) = point("whole = true\n");
    let track = &answers(&experiment)[0].track;
    assert_eq!((track.updates.len(), track.estimates.len()), (1, SAMPLES));
    let (best, deviations) = line(experiment.signals.times(), experiment.signals.column(0));
    let update = &track.updates[0];
    for i in 0..2 {
        assert!((update.estimate[i] - best[i]).abs() < 1e-6 * deviations[i]);
        assert!((update.deviations[i] / deviations[i] - 1.0).abs() < 1e-6);
    }
}

/// What changes in the middle contradicts what was learned: that is said, and the next window begins anew.
#[test]
fn what_contradicts_earlier_windows_is_told() {
    let (_folder, mut experiment) = point("");
    let times = experiment.signals.times().to_vec();
    let bent: Vec<f64> = experiment
        .signals
        .column(0)
        .iter()
        .zip(&times)
        .map(|(value, time)| value - 1.2 * (time - 4.0).max(0.0))
        .collect();
    experiment.signals = palmistry::observer::Signals::new(times, vec![("x".to_owned(), bent)]).unwrap();
    let track = &experiment.run(&NEVER, &|_| ()).unwrap()[0].track;
    let ends: Vec<bool> = track.updates.iter().map(palmistry::observer::Update::is_borne_out).collect();
    // the third window begins where the speed changes: with what was learned it does not fit, and by itself it does
    assert_eq!(ends, [true, true, false, true, true, true]);
    assert_eq!(track.updates[2].end, UpdateEnd::DoesNotFit);
    assert!(!track.is_sound() && track.remarks.iter().any(|remark| remark.contains("contradict")));
    assert!((track.updates[5].estimate[1] + 0.7).abs() < 5.0 * track.updates[5].deviations[1]);
}

#[test]
fn estimates_stay_within_bounds() {
    let (_folder, experiment) = point("bounds = { v = [0.6, 2.0] }\n");
    let track = &answers(&experiment)[0].track;
    assert_eq!(track.updates[0].estimate[1], 0.6);
    assert!(
        track.remarks.iter().any(|remark| remark.contains("'v' is at its bound 0.6")),
        "{:?}",
        track.remarks
    );
    // the true speed is 0.5: the longer it is watched the less it is explained
    assert!(!track.is_sound());
    let (_folder, experiment) = point("bounds = { v = [0.0, 2.0], x = [-inf, inf] }\n");
    let track = &answers(&experiment)[0].track;
    assert!(track.is_sound() && track.remarks.is_empty());
}

/// One measurement in ten is two units off, forty deviations. Least squares say that nothing fits; with a robust loss the line is found, and
/// the number of measurements that count less is told.
#[test]
fn a_robust_loss_finds_the_line_among_outliers() {
    for (more, is_found) in [("whole = true\n", false), ("whole = true\nloss = \"huber\"\n", true)] {
        let (_folder, mut experiment) = point(more);
        let times = experiment.signals.times().to_vec();
        let off = |(i, value): (usize, &f64)| if i % 10 == 3 { value + 2.0 } else { *value };
        let values = experiment.signals.column(0).iter().enumerate().map(off).collect();
        experiment.signals =
            palmistry::observer::Signals::new(times, vec![("x".to_owned(), values)]).unwrap();
        let track = &experiment.run(&NEVER, &|_| ()).unwrap()[0].track;
        let update = &track.updates[0];
        assert_eq!(update.is_borne_out(), is_found, "{update:?}");
        let distance = (update.estimate[0] - 1.0).abs() / update.deviations[0];
        assert_eq!(distance < 6.0, is_found, "{distance}");
        if is_found {
            // twenty outliers, and of the others about one in six lies beyond 1.345 deviations
            assert!((20..=70).contains(&update.discounted), "{}", update.discounted);
            assert!(update.fit.unwrap().chi_square < 201.0);
        }
    }
    // of a model that is wrong nearly all measurements lie beyond the corner: that is no outlier
    let (_folder, mut experiment) = point("whole = true\nloss = \"huber\"\n");
    let times = experiment.signals.times().to_vec();
    let bent = times.iter().map(|time| 3.0 * (2.0 * time).sin()).collect();
    experiment.signals = palmistry::observer::Signals::new(times, vec![("x".to_owned(), bent)]).unwrap();
    let track = &experiment.run(&NEVER, &|_| ()).unwrap()[0].track;
    assert!(!track.updates[0].is_borne_out(), "{:?}", track.updates[0]);
}

/// Windows of two steps tell the speed to no better than 0.7, which is more than its size of 0.1 and than a third of what they find: they grow until together they do, and what they say is regression's. Nothing of what
/// they read is lost, and the deviations by hand say when they see.
#[test]
fn windows_that_do_not_see_grow() {
    let (_folder, experiment) = point("");
    let (times, values) = (experiment.signals.times(), experiment.signals.column(0));
    let task = experiment.task(&NEVER).unwrap();
    let windows = MovingWindow { steps: 20, ..MovingWindow::new(2) };
    let track = windows.observe(&task);
    // so many steps make the deviation of the speed less than its guess, or than a third of what was found
    let sees = |rows: std::ops::Range<usize>| {
        let (best, deviations) = line(&times[rows.clone()], &values[rows]);
        deviations[1] < f64::max(0.1, best[1].abs() / 3.0)
    };
    let rows = (1..).map(|i| 2 * i + 1).find(|rows| sees(0..*rows)).unwrap();
    let blind = track
        .updates
        .iter()
        .take_while(|update| matches!(update.end, UpdateEnd::Unobservable { .. }))
        .count();
    assert_eq!(blind, (rows - 1) / 2 - 1, "{rows}");
    let first = &track.updates[blind];
    assert_eq!((first.from, first.to, &first.end), (0.0, times[rows - 1], &UpdateEnd::Converged));
    let (best, deviations) = line(&times[..rows], &values[..rows]);
    for i in 0..2 {
        assert!((first.estimate[i] - best[i]).abs() < 1e-6 * deviations[i], "{i}: {first:?}");
        assert!((first.deviations[i] / deviations[i] - 1.0).abs() < 1e-6, "{i}");
    }
    assert!(track.remarks[0].contains(&format!("grown to {rows} samples")), "{:?}", track.remarks);
    // every sample has one estimate, in order
    assert!(track.estimates.iter().map(|estimate| estimate.time).eq(times.iter().copied()));
    assert_eq!(track.unobserved, 0);
    // the last one knows all
    let last = track.updates.last().unwrap();
    let shifted: Vec<f64> = times.iter().map(|time| time - last.from).collect();
    let (best, deviations) = line(&shifted, values);
    assert!((last.estimate[1] - best[1]).abs() < 1e-5 * deviations[1], "{last:?}");
    // each for itself they hardly ever see, and hold
    let mut alone = task.clone();
    alone.inherit = false;
    let alone = windows.observe(&alone);
    assert_eq!(alone.updates.len(), (times.len() - 1) / 2);
    for (place, update) in alone.updates.iter().enumerate() {
        let is_unobservable = matches!(update.end, UpdateEnd::Unobservable { .. });
        assert_eq!(is_unobservable, !sees(2 * place..2 * place + 3), "{update:?}");
    }
    let blind =
        alone.updates.iter().filter(|update| matches!(update.end, UpdateEnd::Unobservable { .. })).count();
    assert!(20 * blind > 19 * alone.updates.len(), "{blind} of {}", alone.updates.len());
}

/// A speed that nothing tells within eight windows: that is said, and no more of them are kept.
#[test]
fn windows_grow_to_a_bound() {
    let (_folder, experiment) = point("");
    let task = experiment.task(&NEVER).unwrap();
    // nothing is seen that is not known to a millionth of its size
    let windows = MovingWindow { unobservable_above: 1e-6, ..MovingWindow::new(2) };
    let track = windows.observe(&task);
    assert_eq!(track.updates.len(), 100);
    assert!(track.updates.iter().all(|update| matches!(update.end, UpdateEnd::Unobservable { .. })));
    let told = track.remarks.iter().filter(|remark| remark.contains("8 windows together")).count();
    // the last of eight is the first of the next eight
    assert_eq!(told, (100 - 1) / 7, "{:?}", track.remarks);
    assert_eq!(track.estimates.len(), SAMPLES);
}

/// A bound at the truth: half of the windows' estimates lie at it. What is handed on is what the measurements told, without the bound, so that the last window has the
/// best line that keeps the bound, of all measurements; and no window is said to differ from the one before.
#[test]
fn what_is_handed_on_from_a_bound_is_what_the_measurements_told() {
    let (_folder, plain) = point("bounds = { v = [0.5, 2] }\n");
    let mut at_bounds = 0;
    for seed in 1..=16 {
        let mut scene = plain.scene.clone();
        scene.seed = seed;
        let experiment = palmistry::experiment::Experiment::new(scene, None).unwrap();
        let track = &answers(&experiment)[0].track;
        assert!(track.is_sound(), "seed {seed}: {:?}", track.together());
        at_bounds += track.updates.iter().filter(|update| !update.at_bounds.is_empty()).count();
        let last = track.updates.last().unwrap();
        let (times, values) = (experiment.signals.times(), experiment.signals.column(0));
        let ([mut start, mut slope], _) = line(times, values);
        if slope < 0.5 {
            slope = 0.5;
            let rest = times.iter().zip(values).map(|(time, value)| value - 0.5 * time);
            start = rest.sum::<f64>() / times.len() as f64;
        }
        let known = [start + slope * last.from, slope];
        for (found, known) in last.estimate.iter().zip(known) {
            assert!((found - known).abs() < 1e-7, "seed {seed}: {:?} {known:?}", last.estimate);
        }
    }
    assert!((16..64).contains(&at_bounds), "{at_bounds} of 80 estimates lie at the bound");
}
