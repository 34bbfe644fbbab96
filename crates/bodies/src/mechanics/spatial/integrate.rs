//! The integrator: Dop853 of the crate ode_solvers, in pieces short enough that a rotation vector serves in each.
//!
//! Within a piece the body is turned by its orientation at the start and then by a rotation vector, which is integrated like
//! all else and so is under the same control of errors (H. Munthe-Kaas, Runge-Kutta methods on Lie groups, BIT 38, 1998). The time
//! goes along as a coordinate: version 0.6.2 of the crate has a wrong node for rates that depend on it.

use super::contact::Places;
use super::laws::Situation;
use super::orientation::{Orientation, rotation_vector_rate};
use super::scene::{SpatialDrive, SpatialPalm, SpatialScene};
use nalgebra::Vector3;
use ode_solvers::{Dop853, OutputType, SVector, System};
use palmistry_io::foreign::Budget;

/// What is integrated: orientation, angular velocity in the world, angle and rate of each palm that is pushed, the work of the motors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimedState {
    pub time: f64,
    pub orientation: Orientation,
    pub rate: Vector3<f64>,
    pub pushed: [[f64; 2]; 3],
    pub work: f64,
    /// Where contacts on spheres were a short time before.
    pub near: Option<Places>,
}

/// A rotation vector, the rate, angles and rates of the palms, work, the time since the start.
type Vector = SVector<f64, 14>;

/// Steps within a piece, refused ones included, after which an integration is given up.
const MOST_STEPS: u32 = 20_000;
/// A piece is as long as the body takes to turn by this, in radians, at the rate at its start.
const TURN_OF_A_PIECE: f64 = 0.5;
/// And on spheres no longer than so many of the longest steps.
const STEPS_ON_SPHERES: f64 = 8.0;
/// More pieces between two samples are not taken.
const MOST_PIECES: usize = 1_000_000;

impl TimedState {
    pub fn situation(&self, scene: &SpatialScene) -> Situation {
        Situation::at(scene, self.time, &self.orientation.matrix(), &self.rate, &self.pushed, self.near)
    }

    fn vector(&self) -> Vector {
        let [a, b, c] = self.pushed;
        let palms = [a[0], b[0], c[0], a[1], b[1], c[1]];
        Vector::from_fn(|i, _| match i {
            3..6 => self.rate[i - 3],
            6..12 => palms[i - 6],
            12 => self.work,
            _ => 0.0,
        })
    }

    /// The state at a vector of the piece that begins here, and the rotation vector.
    fn after(&self, y: &Vector) -> (TimedState, Vector3<f64>) {
        let turn = Vector3::new(y[0], y[1], y[2]);
        let state = TimedState {
            time: self.time + y[13],
            orientation: self.orientation.then(&Orientation::by(&turn)),
            rate: Vector3::new(y[3], y[4], y[5]),
            pushed: std::array::from_fn(|i| [y[6 + i], y[9 + i]]),
            work: y[12],
            near: self.near,
        };
        (state, turn)
    }
}

struct Laws<'a> {
    scene: &'a SpatialScene,
    begin: TimedState,
}

impl System<f64, Vector> for Laws<'_> {
    fn system(&self, _: f64, y: &Vector, rates: &mut Vector) {
        let (state, turn) = self.begin.after(y);
        let matrix = state.orientation.matrix();
        let at = Situation::at(self.scene, state.time, &matrix, &state.rate, &state.pushed, state.near);
        let turning = rotation_vector_rate(&turn, &(matrix.transpose() * state.rate));
        let pushed = matches!(self.scene.drive, SpatialDrive::Torques(_));
        let power: f64 = (0..3).map(|i| at.torques[i] * at.rates[i]).sum();
        *rates = Vector::from_fn(|i, _| match i {
            0..3 => turning[i],
            3..6 => at.turning[i - 3],
            6..9 if pushed => at.rates[i - 6],
            9..12 if pushed => at.accelerations[i - 9],
            12 => power,
            13 => 1.0,
            _ => 0.0,
        });
    }
}

/// The integrator's steps from a state to time `end`, first and last included, none longer than `longest` seconds; and why it
/// stopped before the end, if it did.
pub(super) fn steps(
    scene: &SpatialScene,
    from: TimedState,
    end: f64,
    longest: f64,
    budget: &Budget,
) -> (Vec<TimedState>, Option<String>) {
    let mut all = vec![from];
    let mut here = from;
    let is_flat = scene.palms.iter().all(SpatialPalm::is_flat);
    for _ in 0..MOST_PIECES {
        if here.time >= end {
            return (all, None);
        }
        let turning = here.rate.norm();
        let mut most = TURN_OF_A_PIECE / turning;
        if !is_flat {
            // contacts are searched for from those at the start of a piece
            here.near = here.situation(scene).touched;
            most = most.min(STEPS_ON_SPHERES * longest);
        }
        let until = if most < end - here.time { here.time + most } else { end };
        if until <= here.time {
            return (all, Some("the body turns too fast for its time to be computed".to_owned()));
        }
        let (found, failure) = piece(scene, here, until, longest);
        let paid = budget.steps(1 + found.len());
        all.extend(found);
        if failure.is_some() {
            return (all, failure);
        }
        if let Err(spent) = paid {
            return (all, Some(format!("{spent} of the integrator: let it end earlier")));
        }
        if let Some(last) = all.last_mut() {
            // begin + (end - begin) may be off by a rounding
            last.time = until;
            here = *last;
        }
    }
    (all, Some(format!("{MOST_PIECES} pieces were not enough")))
}

fn piece(
    scene: &SpatialScene,
    begin: TimedState,
    end: f64,
    longest: f64,
) -> (Vec<TimedState>, Option<String>) {
    let (span, tolerance) = (end - begin.time, scene.tolerance);
    // the four numbers before the step sizes are its usual safety factor, damping, and bounds on a change of step
    let mut solver = Dop853::from_param(
        Laws { scene, begin },
        0.0,
        span,
        span,
        begin.vector(),
        tolerance,
        tolerance,
        0.9,
        0.0,
        0.333,
        6.0,
        longest,
        span.min(longest),
        MOST_STEPS,
        MOST_STEPS,
        OutputType::Sparse,
    );
    let failure = solver.integrate().err().map(|error| error.to_string());
    (solver.y_out().iter().skip(1).map(|y| begin.after(y).0).collect(), failure)
}
