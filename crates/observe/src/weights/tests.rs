//! Weights by hand, and against full matrices.

use super::*;
use crate::{EstimateQuestion, Noise};
use palmistry_lang::System;
use std::path::Path;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// A point that is driven at a measured speed: `x(t_i) = x(0) + sum of the steps`. With errors of the speed alone and two measurements
/// of x the covariance is by hand; steps are of length one and the curves of two samples are straight, so that the second
/// measurement errs by the mean of both speeds' errors.
#[test]
fn errors_of_a_speed_add_up_in_the_place() {
    let text =
        "system \"A driven point\"\nstate x\nparam u\ndrift f\n  x' = 0\ninput g\n  x' = 1\noutput x\n";
    let system = System::parse("point.proof", text, Path::new("")).unwrap();
    let columns = vec![("x".to_owned(), vec![0.0, 3.0]), ("u".to_owned(), vec![2.0, 2.0])];
    let signals = Signals::new(vec![0.0, 1.0], columns).unwrap();
    let question = EstimateQuestion {
        guess: vec![("x".to_owned(), 0.5)],
        inputs: vec![("g".to_owned(), "u".to_owned())],
        ..EstimateQuestion::default()
    };
    let mut task = Task::new(&system, &question, &signals, &NEVER).unwrap();
    (task.exact, task.sigma) = (false, 0.1);
    task.noise = Noise::Stated { normal: 0.1, rounding: 0.0 };
    assert!(!are_needed(&task));
    for (errors, variance) in [
        (MeasurementErrors { normal: 0.2, rounding: 0.0 }, 0.2 * 0.2 / 2.0),
        // both samples are equal after rounding: they have one error
        (MeasurementErrors { normal: 0.0, rounding: 0.6 }, 0.6 * 0.6 / 12.0),
    ] {
        task.errors.insert("u".to_owned(), errors);
        assert!(are_needed(&task));
        let weights = Weights::of(&task, (&[0.5], signals.times()), Vec::new(), None, &signals).unwrap();
        // C^-1 by what it makes of units
        let unit = DMatrix::identity(2, 2);
        let weighted = weights.weighted_slopes(&unit) / weights.unit;
        let covariance = weighted.tr_mul(&weighted).try_inverse().unwrap();
        let by_hand = DMatrix::from_row_slice(2, 2, &[0.01, 0.0, 0.0, 0.01 + variance]);
        assert!((&covariance - by_hand).amax() < 1e-9, "{covariance}");
        // differences of (0, 1): the likely errors of the speed are those that regression gives
        let differences = DVector::from_vec(vec![0.0, 1.0]);
        let likely = weights.likely_errors(&weights.weighted(&differences));
        let expected = variance / (0.01 + variance);
        let mean = (likely[0] + likely[1]) / 2.0;
        assert!((mean - expected).abs() < 1e-9, "{likely}");
        assert!((weights.back(&weights.weighted(&differences))[1] - 0.01 / (0.01 + variance)).abs() < 1e-9);
    }
}

/// A pendulum that is pushed through a moving frame, with uneven times and two columns that err, one of them rounded to where neighbours are often equal.
fn pushed(count: usize) -> (System, Signals, EstimateQuestion) {
    let text = "system \"A pushed pendulum\"\nstate x, v\nparam a, u\ndrift f\n  x' = v\n  v' = -4*sin(x + a) - v*a^2\n\
                input g\n  v' = 1 + x^2\n  others' = 0\noutput x + a*u, v\n";
    let system = System::parse("pushed.proof", text, Path::new("")).unwrap();
    let times: Vec<f64> = (0..count).map(|i| 0.05 * i as f64 + 0.01 * (i * i % 5) as f64).collect();
    let column =
        |name: &str, at: &dyn Fn(f64) -> f64| (name.to_owned(), times.iter().map(|t| at(*t)).collect());
    let columns = vec![
        column("a", &|t| (0.3 * (2.0 * t).sin() / 0.05).round() * 0.05),
        column("u", &|t| (3.0 * t).cos()),
        column("x + a*u", &|_| 0.0),
        column("v", &|_| 0.0),
    ];
    let question = EstimateQuestion {
        guess: vec![("x".to_owned(), 0.4), ("v".to_owned(), -0.2)],
        inputs: vec![("g".to_owned(), "u".to_owned())],
        ..EstimateQuestion::default()
    };
    (system, Signals::new(times.clone(), columns).unwrap(), question)
}

fn erring<'a>(system: &System, question: &EstimateQuestion, signals: &'a Signals) -> Task<'a> {
    let mut task = Task::new(system, question, signals, &NEVER).unwrap();
    (task.exact, task.sigma) = (false, 0.02);
    task.noise = Noise::Stated { normal: 0.02, rounding: 0.01 };
    task.errors.insert("a".to_owned(), MeasurementErrors { normal: 0.01, rounding: 0.05 });
    task.errors.insert("u".to_owned(), MeasurementErrors { normal: 0.1, rounding: 0.0 });
    task
}

/// The covariance as a full matrix, a column a sample and then a column a run.
fn full_covariance(weights: &Weights) -> DMatrix<f64> {
    let (slopes, rows) = (weights.sensitivity.dense(), weights.sensitivity.rows);
    let own = |i: usize| own_variance(&weights.outputs, i) + weights.least;
    let mut all = DMatrix::from_diagonal(&DVector::from_fn(slopes.nrows(), |i, _| own(i)));
    for (column, errors) in weights.columns.errors.iter().enumerate() {
        let of = slopes.columns(column * rows, rows);
        all += of * of.transpose() * errors.normal.powi(2);
        for run in &weights.columns.runs[column] {
            let together = of.columns(run.start, run.len()).column_sum();
            all += &together * together.transpose() * (errors.rounding.powi(2) / 12.0);
        }
    }
    all
}

/// The recursion against factors of the full matrix: weighted differences, what is transposed, likely errors, and what the test of fit takes off, in a window within a
/// recording and in one that is all of it.
#[test]
fn the_recursion_is_the_full_matrix() {
    let (system, signals, question) = pushed(60);
    let task = erring(&system, &question, &signals);
    for window in [6..40, 0..60, 3..5] {
        let weights =
            Weights::of(&task, (&[0.4, -0.2], &signals.times()[window]), Vec::new(), None, &signals).unwrap();
        let covariance = full_covariance(&weights);
        let n = covariance.nrows();
        assert!(weights.columns.runs[0].iter().any(|run| run.len() > 1));
        let root = nalgebra::Cholesky::new(covariance.clone()).unwrap().unpack();
        let off = |a: &DVector<f64>, b: &DVector<f64>| (a - b).amax() / b.amax();
        let differences = DVector::from_fn(n, |i, _| ((7 * i % 13) as f64).sin());
        let white = root.solve_lower_triangular(&differences).unwrap();
        let weighted = weights.weighted(&differences);
        assert!(off(&weighted, &(&white * 0.02)) < 1e-9);
        let pulled = root.transpose().solve_upper_triangular(&white).unwrap();
        assert!(off(&weights.back(&weighted), &(&pulled * 4e-4)) < 1e-9);
        let coloured = weights.factor.coloured(&weights.recursion(), &white);
        assert!(off(&coloured, &differences) < 1e-9);
        let inverse = covariance.try_inverse().unwrap();
        let (slopes, rows) = (weights.sensitivity.dense(), weights.sensitivity.rows);
        let (diagonal, runs) = weights.factor.norms(&weights.recursion());
        assert!(off(&diagonal, &inverse.diagonal()) < 1e-9);
        let likely = weights.likely_errors(&weighted);
        let pull = slopes.tr_mul(&pulled);
        let mut expected = DVector::zeros(pull.len());
        for (column, errors) in weights.columns.errors.iter().enumerate() {
            for (run, norm) in weights.columns.runs[column].iter().zip(&runs[column]) {
                let places = column * rows + run.start..column * rows + run.end;
                let together = slopes.columns(places.start, run.len()).column_sum();
                let square = together.dot(&(&inverse * &together));
                assert!((norm * norm - square).abs() < 1e-9 * square.max(1e-3), "{norm} {square}");
                let sum: f64 = places.clone().map(|place| pull[place]).sum();
                for place in places {
                    expected[place] =
                        errors.normal.powi(2) * pull[place] + errors.rounding.powi(2) / 12.0 * sum;
                }
            }
        }
        assert!(off(&likely, &expected) < 1e-9);
        assert!(off(&weights.sensitivity.times(&likely), &(slopes * &likely)) < 1e-12);
    }
}

/// Four times as many samples take four times as many numbers: a full matrix would have sixteen times as many.
#[test]
fn weights_are_linear_in_the_samples() {
    let length = |count: usize| {
        let (system, signals, question) = pushed(count);
        let task = erring(&system, &question, &signals);
        let weights =
            Weights::of(&task, (&[0.4, -0.2], signals.times()), Vec::new(), None, &signals).unwrap();
        let differences = DVector::from_element(2 * count, 0.01);
        let slopes = DMatrix::from_fn(2 * count, 5, |i, j| ((i * j) as f64).sin());
        let weighted = weights.weighted(&differences);
        let slopes = weights.weighted_slopes(&slopes);
        assert!(weights.fit(&weighted, &slopes, 1e-9, 2 * count - 5, (Loss::Squares, 1e-3)).fits);
        // all that it holds, as text
        format!("{weights:?}").len()
    };
    let (few, many) = (length(250), length(1000));
    assert!(many < 6 * few, "{few} and {many} characters");
}

/// Differences that were not measured have no weight: the recursion is that of the full matrix without its rows and columns.
#[test]
fn what_was_not_measured_is_as_if_it_were_not_there() {
    let (system, signals, question) = pushed(60);
    let task = erring(&system, &question, &signals);
    let window = &signals.times()[5..45];
    let (whole, n) = (full_covariance(&of_window(&task, window, Vec::new())), 80);
    for every in [2, 3, 7] {
        let unmeasured: Vec<usize> = (0..n).filter(|place| place % every == 1).collect();
        let kept: Vec<usize> = (0..n).filter(|place| place % every != 1).collect();
        let weights = of_window(&task, window, unmeasured.clone());
        let covariance = whole.select_rows(&kept).select_columns(&kept);
        let root = nalgebra::Cholesky::new(covariance.clone()).unwrap().unpack();
        let mut differences = DVector::from_fn(n, |i, _| ((7 * i % 13) as f64).sin());
        unmeasured.iter().for_each(|place| differences[*place] = 0.0);
        let white = root.solve_lower_triangular(&differences.select_rows(&kept)).unwrap();
        let weighted = weights.weighted(&differences);
        let off = |a: &DVector<f64>, b: &DVector<f64>| (a.select_rows(&kept) - b).amax() / b.amax();
        assert!(
            off(&weighted, &(&white * 0.02)) < 1e-9 && unmeasured.iter().all(|place| weighted[*place] == 0.0)
        );
        let pulled = root.transpose().solve_upper_triangular(&white).unwrap();
        assert!(off(&weights.back(&weighted), &(&pulled * 4e-4)) < 1e-9);
        let coloured = weights.factor.coloured(&weights.recursion(), &(&weighted / 0.02));
        assert!(off(&coloured, &differences.select_rows(&kept)) < 1e-9);
        let (diagonal, _) = weights.factor.norms(&weights.recursion());
        assert!(off(&diagonal, &covariance.try_inverse().unwrap().diagonal()) < 1e-9);
        let slopes = DMatrix::zeros(n, 2);
        let fit = weights.fit(&weighted, &slopes, 1e-9, kept.len(), (Loss::Squares, 1e-3));
        assert!((fit.chi_square / white.norm_squared() - 1.0).abs() < 1e-9 && fit.measurements == kept.len());
    }
}

fn of_window(task: &Task<'_>, times: &[f64], unmeasured: Vec<usize>) -> Weights {
    Weights::of(task, (&[0.4, -0.2], times), unmeasured, None, task.signals).unwrap()
}
