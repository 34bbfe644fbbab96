//! The one place that knows the integrator: Dop853 of the crate ode_solvers (Hairer, Nørsett and Wanner, Solving
//! Ordinary Differential Equations I, 1993, section II.10), asked for its own steps and nothing between them.
//!
//! In version 0.6.2 of the crate the twelfth stage of a step is computed with the time of its beginning instead of its
//! end (`c_12` is 0; it has to be 1, the sum of its row; pull request 42). A system whose rates do not depend on the
//! time is not affected. So the time is integrated along with the state, and the solver's own time is not used.

use super::laws::{Situation, State, TimedState};
use super::scene::MovingScene;
use ode_solvers::{Dop853, OutputType, SVector, System};

/// The state, and the time since the beginning.
type Vector = SVector<f64, 8>;

/// Steps between two samples, refused ones included, after which an integration is given up.
const MOST_STEPS: u32 = 20_000;

struct Laws<'a> {
    scene: &'a MovingScene,
    begin: f64,
}

fn state(y: &Vector) -> State {
    std::array::from_fn(|i| y[i])
}

fn vector(state: State, last: f64) -> Vector {
    Vector::from_fn(|i, _| state.get(i).copied().unwrap_or(last))
}

impl System<f64, Vector> for Laws<'_> {
    fn system(&self, _: f64, y: &Vector, rates: &mut Vector) {
        let state = state(y);
        let situation = Situation::at(self.scene, self.begin + y[7], &state);
        *rates = vector(situation.rates(&state, &self.scene.drive), 1.0);
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
    let TimedState { time: begin, state: from } = from;
    let (span, tolerance) = (end - begin, scene.tolerance);
    let first = span.min(longest);
    // times count from `begin`: the solver compares its step with the time to see whether it became too short. The
    // four numbers before the step sizes are its usual safety factor, damping, and bounds on a change of step.
    let mut solver = Dop853::from_param(
        Laws { scene, begin },
        0.0,
        span,
        span,
        vector(from, 0.0),
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
    let states = solver.y_out().iter().map(state);
    let mut all: Vec<TimedState> =
        times.zip(states).map(|(time, state)| TimedState { time, state }).collect();
    // begin + (end - begin) may be off by a rounding
    if let (None, Some(last)) = (&failure, all.last_mut()) {
        last.time = end;
    }
    (all, failure)
}
