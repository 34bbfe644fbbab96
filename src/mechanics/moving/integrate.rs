//! The one place that knows the integrator: Dop853 of the crate ode_solvers (Hairer, Nørsett and Wanner, Solving
//! Ordinary Differential Equations I, 1993, section II.10), asked for its own steps and nothing between them.

use super::laws::{Situation, State};
use super::scene::Scene;
use ode_solvers::{Dop853, OutputType, SVector, System};

type Vector = SVector<f64, 7>;

/// Steps between two samples, refused ones included, after which an integration is given up.
const MOST_STEPS: u32 = 20_000;

struct Laws<'a> {
    scene: &'a Scene,
    begin: f64,
}

impl System<f64, Vector> for Laws<'_> {
    fn system(&self, since: f64, y: &Vector, rates: &mut Vector) {
        let state: State = (*y).into();
        let situation = Situation::at(self.scene, self.begin + since, &state);
        *rates = situation.rates(&state, &self.scene.drive).into();
    }
}

/// The integrator's steps from a state at time `begin` to time `end`, first and last included, none longer than
/// `longest` seconds; and why it stopped before the end, if it did.
pub(super) fn steps(
    scene: &Scene,
    (begin, state): (f64, State),
    end: f64,
    longest: f64,
) -> (Vec<(f64, State)>, Option<String>) {
    let (span, tolerance) = (end - begin, scene.tolerance);
    let first = span.min(longest);
    // times count from `begin`: the solver compares its step with the time to see whether it became too short. The
    // four numbers before the step sizes are its usual safety factor, damping, and bounds on a change of step.
    let mut solver = Dop853::from_param(
        Laws { scene, begin },
        0.0,
        span,
        span,
        Vector::from(state),
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
    let mut all: Vec<(f64, State)> = times.zip(solver.y_out().iter().map(|y| (*y).into())).collect();
    // begin + (end - begin) may be off by a rounding
    if let (None, Some(last)) = (&failure, all.last_mut()) {
        last.0 = end;
    }
    (all, failure)
}
