//! The one place that knows the integrator: Dop853 of the crate ode_solvers (Hairer, Nørsett and Wanner, Solving
//! Ordinary Differential Equations I, 1993, section II.10), asked for its own steps and nothing between them.
//!
//! In version 0.6.2 of the crate the twelfth stage of a step is computed with the time of its start instead of its
//! end (`c_12` is 0; it has to be 1, the sum of its row; pull request 42). A system whose rates do not depend on the
//! time is not affected. So the time is integrated along with the state, and the solver's own time is not used.

use super::laws::{Situation, State, TimedState};
use super::scene::MovingScene;
use ode_solvers::{Dop853, OutputType, SVector, System};

/// Steps between two samples, refused ones included, after which an integration is given up.
const MOST_STEPS: u32 = 20_000;

/// Rates of `M` numbers, of which the last is the time since the start.
struct Laws<F>(F);

impl<const M: usize, F: Fn(&[f64; M]) -> [f64; M]> System<f64, SVector<f64, M>> for Laws<F> {
    fn system(&self, _: f64, y: &SVector<f64, M>, rates: &mut SVector<f64, M>) {
        *rates = SVector::from((self.0)(&std::array::from_fn(|i| y[i])));
    }
}

/// The integrator's steps from a state to time `end`, first and last included, none longer than
/// `longest` seconds; and why it stopped before the end, if it did.
pub(super) fn steps(
    scene: &MovingScene,
    from: TimedState,
    end: f64,
    longest: f64,
) -> (Vec<TimedState>, Option<String>) {
    let TimedState { time: begin, state } = from;
    let held = |y: &[f64; 8]| -> State { std::array::from_fn(|i| y[i]) };
    let laws = |y: &[f64; 8]| {
        let state = held(y);
        let rates = Situation::at(scene, begin + y[7], &state).rates(&state, &scene.drive);
        std::array::from_fn(|i| rates.get(i).copied().unwrap_or(1.0))
    };
    let start = std::array::from_fn(|i| state.get(i).copied().unwrap_or(0.0));
    let (all, failure) = own_steps(laws, start, [begin, end], longest, scene.tolerance);
    (all.iter().map(|(time, y)| TimedState { time: *time, state: held(y) }).collect(), failure)
}

/// The integrator's steps over the times from `begin` to `end`, with their times: `rates` of numbers of which the last is the time since
/// `begin`. None is longer than `longest` seconds; and why it stopped before the end, if it did.
pub(super) fn own_steps<const M: usize>(
    rates: impl Fn(&[f64; M]) -> [f64; M],
    start: [f64; M],
    [begin, end]: [f64; 2],
    longest: f64,
    tolerance: f64,
) -> (Vec<(f64, [f64; M])>, Option<String>) {
    let span = end - begin;
    let first = span.min(longest);
    // times count from `begin`: the solver compares its step with the time to see whether it became too short. The
    // four numbers before the step sizes are its usual safety factor, damping, and bounds on a change of step.
    let mut solver = Dop853::from_param(
        Laws(rates),
        0.0,
        span,
        span,
        SVector::from(start),
        tolerance,
        tolerance,
        0.9,
        0.0,
        0.333,
        6.0,
        longest,
        first,
        MOST_STEPS,
        MOST_STEPS,
        OutputType::Sparse,
    );
    let failure = solver.integrate().err().map(|error| error.to_string());
    let times = solver.x_out().iter().map(|since| begin + since);
    let mut all: Vec<(f64, [f64; M])> =
        times.zip(solver.y_out()).map(|(time, y)| (time, std::array::from_fn(|i| y[i]))).collect();
    // begin + (end - begin) may be off by a rounding
    if let (None, Some(last)) = (&failure, all.last_mut()) {
        last.0 = end;
    }
    (all, failure)
}
