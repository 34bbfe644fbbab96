//! Observers on measurements that arrive: an answer a window, keeping no more than a window and the estimates so far.
//!
//! A window is observed as soon as the rows are there that its curves and the fault checks of its rows need; it starts from the estimate at its
//! first sample, which it shares with the window before. A column that does not change in the first window is taken for a constant, as of a file; where it
//! changes later the model is built again with it, and only the estimate is kept. The probability
//! of a false alarm of the k-th window is the whole run's times `6/(pi k)^2`, so that all of an endless run have no more than that together.

mod arriving;
mod events;
mod observing;

pub use events::{StreamAnswer, StreamEnd, StreamPiece, StreamTally, WindowReport};

use super::channels::known_sensors;
use super::groundwork::{Groundwork, Steady};
use super::run::unusable;
use super::scene::{Guess, Scene, SceneError};
use arriving::{Arriving, Buffer};
use observing::{Observing, SoFar};
use palmistry_observe::{RecordError, RowStream, STREAM};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Observes what arrives, window after window. `next` returns what has arrived, `tell` is called with each window and returns whether anybody still
/// listens.
///
/// # Errors
/// What is wrong with the scene, the header or the first window, with the place in the scene. Later faults are in [`StreamEnd`].
pub fn observe_stream(
    scene: Scene,
    interrupt: &AtomicBool,
    next: &mut dyn FnMut() -> StreamPiece,
    tell: &mut dyn FnMut(&WindowReport<'_>) -> bool,
) -> Result<StreamEnd, SceneError> {
    if scene.observer.whole {
        let help = "leave 'whole' out, or put the measurements into a file first";
        let message = "a stream has no end, and so no whole";
        return Err(scene.error_at("observer.whole", message, "asked for here", help));
    }
    let ground = Groundwork::of(scene, false)?;
    let scene = &ground.scene;
    let delayed = known_sensors(&scene.observer.known).into_iter().find(|(_, known)| known.delay > 0.0);
    if let Some((name, _)) = delayed {
        let message = format!("the delay of '{name}' cannot be undone in a stream");
        let help = "put the measurements into a file first";
        return Err(scene.error_at("observer.known", message, "known here", help));
    }
    let rows = RowStream::new(ground.names.clone(), ground.needed(), ground.fault_rules());
    let mut arriving = Arriving {
        rows,
        next,
        interrupt,
        buffer: Buffer::default(),
        end: StreamEnd::default(),
        faults: Vec::new(),
        is_over: false,
    };
    let window = scene.observer.window.max(2) + 1;
    arriving.fill(scene, window)?;
    if arriving.buffer.times.len() < 2 {
        let path = Path::new(STREAM).to_owned();
        return match (arriving.end.fault.is_some(), arriving.end.cut_off.is_some()) {
            // there was nothing to observe
            (false, false) if arriving.rows.arrived() == 1 => {
                let help = "a window has two rows or more";
                Err(scene.error_at(
                    "data",
                    format!("{STREAM} has one row"),
                    "the measurements of this scene",
                    help,
                ))
            }
            (false, false) => Err(unusable(scene, &RecordError::NoRows { path })),
            _ => Ok(arriving.ended()),
        };
    }
    let mut experiment = arriving.experiment(ground.clone(), window, Steady::AreConstants)?;
    let mut so_far = SoFar::of(&experiment);
    loop {
        let changed;
        (so_far, changed) = {
            let task = experiment.task(interrupt)?;
            let names = arriving.rows.names().unwrap_or_default();
            let observing = Observing::of(&experiment, &task, &ground.known, names, so_far);
            observing.run(&mut arriving, window, tell)?
        };
        let Some(name) = changed else { break };
        let mut ground = ground.clone();
        if let Some(belief) = so_far.learned.iter().flatten().next() {
            let names = experiment.names().into_iter().map(str::to_owned);
            let values = names.zip(belief.belief.iter().copied()).collect();
            ground.scene.observer.guess = Guess::Values(values);
        }
        experiment = arriving.experiment(ground, window, Steady::AreColumns)?;
        experiment.origin = so_far.origin;
        so_far.forget_all_but_belief(&name);
    }
    let mut end = arriving.ended();
    (end.observers, end.windows) = (so_far.tallies, so_far.windows);
    Ok(end)
}
