//! The test of fit of whole searches.

use crate::decays::Decay;
use crate::loss::CORNER;
use crate::{Loss, MovingWindow, MultipleShooting, Observer, Task, Update};

const NOISE: f64 = 0.05;
const ROWS: usize = 161;

/// The update of all rows of a decay with these errors, which are stated.
fn update(seed: u64, loss: Loss) -> Update {
    let decay = Decay::new((ROWS, 4.0), NOISE, seed, [1.8, 0.9]);
    let task = Task { loss, ..decay.stated(NOISE) };
    let track = MovingWindow { steps: 20, ..MovingWindow::new(ROWS) }.observe(&task);
    track.updates.into_iter().next().unwrap()
}

/// How many of some updates have a probability below this.
fn below(updates: &[Update], limit: f64) -> usize {
    updates.iter().filter(|update| update.fit.unwrap().probability < limit).count()
}

/// Of right models and errors as they are stated a robust loss rejects no more than least squares do: by the binomial distribution of 150 draws, more than 16
/// below one in twenty are as rare as one in a thousand, and so are more than two below one in a thousand.
#[test]
fn a_robust_loss_rejects_right_models_as_seldom_as_squares() {
    for loss in [Loss::Squares, Loss::Huber(CORNER)] {
        let updates: Vec<Update> = (0..40).map(|seed| update(seed, loss)).collect();
        assert!(updates.iter().all(|update| update.fit.is_some()));
        let (five, one) = (below(&updates, 0.05), below(&updates, 1e-3));
        println!("STUDY {loss:?} {five} {one} {}", below(&updates, 0.5));
    }
}

/// From a guess beyond the root of the largest double the answer is right, or there is none: no deviation is nothing.
#[test]
fn a_guess_beyond_all_sense_is_never_certain() {
    for guess in [[1e300, 1e300], [1e200, 1.0], [1e-300, 1e-300]] {
        let decay = Decay::new((41, 4.0), NOISE, 3, guess);
        let task = decay.stated(NOISE);
        let all: [&dyn Observer; 2] = [&MovingWindow::new(41), &MultipleShooting::new(41)];
        for observer in all {
            let track = observer.observe(&task);
            for update in &track.updates {
                println!(
                    "{guess:?} {:?} {:?} {:?} {:?}",
                    update.estimate, update.deviations, update.end, update.fit
                );
                assert!(update.deviations.iter().all(|own| *own > 0.0), "{guess:?}: {update:?}");
                let is_right =
                    (update.estimate[0] - 2.0).abs() < 0.2 && (update.estimate[1] - 0.8).abs() < 0.2;
                assert!(is_right || !update.is_borne_out(), "{guess:?}: {update:?}");
            }
            assert!(track.estimates.iter().flat_map(|own| &own.deviations).all(|own| *own > 0.0));
        }
    }
}
