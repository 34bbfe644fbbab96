//! The extended Kalman filter and its smoother against the formulas of a textbook, and with first guesses that say nothing.

use crate::decays::Decay;
use crate::{Kalman, Observer, Smoother, Task, Track, Unscented};
use nalgebra::{Matrix2, Vector2};

const NOISE: f64 = 0.05;
const GUESS: [f64; 2] = [2.2, 1.0];

fn decay() -> Decay {
    Decay::new((41, 4.0), NOISE, 3, GUESS)
}

/// What the textbook believes at a sample: after its measurements, and what was predicted for it with the derivative of the flow.
struct Moment {
    state: Vector2<f64>,
    covariance: Matrix2<f64>,
    predicted: Option<(Vector2<f64>, Matrix2<f64>, Matrix2<f64>)>,
}

/// The filter of `x' = -k x` by its covariance; the guess is what is known before the first measurement.
fn textbook(decay: &Decay, settings: Kalman) -> Vec<Moment> {
    let (times, read) = (decay.signals.times(), decay.signals.column(0));
    let diagonal =
        |part: f64| Matrix2::from_diagonal(&Vector2::from(GUESS).map(|size| (part * size).powi(2)));
    let (mut state, mut covariance) = (Vector2::from(GUESS), diagonal(settings.prior));
    let mut all = Vec::new();
    for row in 0..times.len() {
        let mut predicted = None;
        if row > 0 {
            let step = times[row] - times[row - 1];
            let [x, k] = [state[0], state[1]];
            let falls = (-k * step).exp();
            let flow = Matrix2::new(falls, -step * x * falls, 0.0, 1.0);
            state = Vector2::new(x * falls, k);
            covariance = flow * covariance * flow.transpose() + diagonal(settings.process_noise) * step;
            predicted = Some((state, covariance, flow));
        }
        let gain = covariance.column(0) / (covariance[(0, 0)] + NOISE * NOISE);
        state += gain * (read[row] - state[0]);
        covariance -= gain * covariance.row(0);
        all.push(Moment { state, covariance, predicted });
    }
    all
}

/// Whether a track has these states and covariances.
fn agree(track: &Track, told: &[(Vector2<f64>, Matrix2<f64>)]) {
    assert_eq!(track.estimates.len(), told.len());
    for (own, (state, covariance)) in track.estimates.iter().zip(told) {
        for i in 0..2 {
            let deviation = covariance[(i, i)].sqrt();
            assert!((own.state[i] - state[i]).abs() < 1e-7 * deviation, "{own:?} {state}");
            assert!((own.deviations[i] / deviation - 1.0).abs() < 1e-7, "{own:?} {covariance}");
        }
    }
}

#[test]
fn the_filter_is_that_of_a_textbook_from_the_first_sample_on() {
    let (decay, settings) = (decay(), Kalman::default());
    let track = settings.observe(&decay.stated(NOISE));
    let told: Vec<_> =
        textbook(&decay, settings).into_iter().map(|own| (own.state, own.covariance)).collect();
    agree(&track, &told);
    assert_eq!(track.innovations.unwrap().degrees, 41);
}

#[test]
fn the_smoother_is_that_of_a_textbook() {
    let (decay, filter) = (decay(), Kalman::default());
    let track = Smoother { filter }.observe(&decay.stated(NOISE));
    let passed = textbook(&decay, filter);
    let mut told: Vec<(Vector2<f64>, Matrix2<f64>)> = Vec::new();
    for (row, own) in passed.iter().enumerate().rev() {
        let smoothed = match (told.last(), passed.get(row + 1).and_then(|next| next.predicted)) {
            (Some((state, covariance)), Some((there, spread, flow))) => {
                let gain = own.covariance * flow.transpose() * spread.try_inverse().unwrap();
                let moved = own.covariance + gain * (covariance - spread) * gain.transpose();
                (own.state + gain * (state - there), moved)
            }
            _ => (own.state, own.covariance),
        };
        told.push(smoothed);
    }
    told.reverse();
    agree(&track, &told);
}

/// Whatever is believed of the guess, no deviation is nothing, and each measurement is either compared or its sample is said to be lost.
fn is_honest(track: &Track, prior: f64) {
    let bars = track.estimates.iter().flat_map(|own| &own.deviations);
    assert!(bars.clone().all(|own| *own > 0.0), "{prior:e}: {:?}", bars.collect::<Vec<_>>());
    let compared = track.innovations.map_or(0, |own| own.degrees);
    assert_eq!(compared + track.unobserved, 41, "{prior:e}: {:?}", track.remarks);
    assert_eq!(track.unobserved > 0, !track.remarks.is_empty(), "{prior:e}");
}

#[test]
fn a_guess_of_which_nothing_is_known_makes_no_filter_certain() {
    let decay = decay();
    for prior in [0.5, 1e4, 1e8, 1e16, 1e160, 1e200, 1e300] {
        let task: Task<'_> = decay.stated(NOISE);
        let filter = Kalman { prior, ..Kalman::default() };
        let all = [
            filter.observe(&task),
            Smoother { filter }.observe(&task),
            Unscented { prior, ..Unscented::default() }.observe(&task),
        ];
        for track in &all {
            is_honest(track, prior);
        }
        assert!(prior < 1e200 || all.iter().all(|track| !track.passes()), "{prior:e}");
    }
}
