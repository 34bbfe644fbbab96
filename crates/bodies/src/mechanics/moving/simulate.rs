//! A scene carried through time.

use super::breach::Breach;
use super::integrate::steps;
use super::laws::{Situation, TimedState};
use super::scene::{MovingScene, SceneError};
use super::trajectory::{Ended, Moment, Trajectory};
use palmistry_io::foreign::{Allowance, Budget};

/// The end of a contact is located to so many seconds.
pub(super) const LOCATED: f64 = 1e-14;

/// The last of sample times that are finite, not negative and increase.
///
/// # Errors
/// The first that is not so, or that there are none.
pub fn checked_times(times: &[f64]) -> Result<f64, SceneError> {
    let mut before = -f64::MIN_POSITIVE;
    for (index, &time) in (1..).zip(times) {
        if !(time > before && time.is_finite()) {
            return Err(SceneError::Time { index, time });
        }
        before = time;
    }
    times.last().copied().ok_or(SceneError::NoTimes)
}

/// Moves the scene from time zero and reports its moments at the sample times, which increase.
///
/// The motion ends before the last of them where a contact does; see [`Ended`].
///
/// # Errors
/// Where a value of the scene or a time cannot be used, or a palm would have to pull at the start.
pub fn simulate(scene: &MovingScene, times: &[f64]) -> Result<Trajectory, SceneError> {
    let last = checked_times(times)?;
    scene.check()?;

    let budget = Budget::new(ALLOWANCE);
    let mut moments = Vec::with_capacity(times.len());
    let mut now = TimedState { time: 0.0, state: scene.start() };
    let start_energy = Moment::of(scene, now.time, &now.state).energy();
    for &time in times {
        if time > now.time {
            match advance(scene, now, [time, scene.longest_step(last)], &budget) {
                Ok(held) => now = TimedState { time, ..held },
                Err(stop) => {
                    // an end at once after a sample is that sample
                    let fresh = stop.at.filter(|at| at.time > now.time);
                    moments.extend(fresh.map(|at| Moment::of(scene, at.time, &at.state)));
                    return Ok(Trajectory { moments, ended: stop.ended, start_energy, jumps: Vec::new() });
                }
            }
        }
        moments.push(Moment::of(scene, time, &now.state));
    }
    Ok(Trajectory { moments, ended: Ended::Completed, start_energy, jumps: Vec::new() })
}

/// An end before the next sample, and the last state before it unless the integrator gave up.
struct Stop {
    at: Option<TimedState>,
    ended: Ended,
}

fn breach(at: &TimedState, scene: &MovingScene) -> Option<Breach> {
    Situation::at(scene, at.time, &at.state).breach(scene)
}

/// What a motion may cost: steps of the integrator.
const ALLOWANCE: Allowance = Allowance { bytes: u64::MAX, nodes: u64::MAX, steps: 1_000_000 };

/// The state at time `end`, by steps that are no longer than `longest`.
fn advance(
    scene: &MovingScene,
    from: TimedState,
    [end, longest]: [f64; 2],
    budget: &Budget,
) -> Result<TimedState, Stop> {
    let (all, failure) = steps(scene, from, end, longest);
    let paid = budget.steps(all.len());
    let failure =
        failure.or(paid.err().map(|spent| format!("{spent} of the integrator: let it end earlier")));
    let mut held = from;
    for step in all {
        if let Some(first) = breach(&step, scene) {
            let (at, last) = locate(scene, held, step.time, first);
            return Err(Stop { at: Some(at), ended: Ended::by(last, at.time) });
        }
        held = step;
    }
    match failure {
        None => Ok(held),
        Some(why) => Err(Stop { at: None, ended: Ended::Failed { time: held.time, why } }),
    }
}

/// Where the contacts hold for the last time between a state in which they do and a time at which they do not, by
/// bisection; each state is integrated from the last one that held.
fn locate(scene: &MovingScene, held: TimedState, broken: f64, mut by: Breach) -> (TimedState, Breach) {
    let (mut low, mut high) = (held, broken);
    while high - low.time > LOCATED {
        let middle = low.time + (high - low.time) / 2.0;
        if middle <= low.time || middle >= high {
            break;
        }
        let (all, failure) = steps(scene, low, middle, middle - low.time);
        let Some(&state) = all.last().filter(|_| failure.is_none()) else { break };
        match breach(&state, scene) {
            None => low = state,
            Some(found) => (high, by) = (middle, found),
        }
    }
    (low, by)
}
