//! A scene carried through time.

use super::breach::Breach;
use super::integrate::steps;
use super::laws::{Situation, State};
use super::scene::{MovingScene, SceneError};
use super::trajectory::{Ended, Moment, Trajectory};

/// Contacts are looked at after each step of the integrator, of which there are at least so many: a contact force
/// that is negative for a shorter time than a step may go unseen.
const FEWEST_STEPS: f64 = 256.0;

/// The end of a contact is sought until it is known to so many seconds.
const LOCATED: f64 = 1e-14;

/// Moves the scene from time zero and reports its moments at the sample times, which increase.
///
/// The motion ends before the last of them where a contact does; see [`Ended`].
///
/// # Errors
/// Where a value of the scene or a time cannot be used, or a palm would have to pull at the start.
pub fn simulate(scene: &MovingScene, times: &[f64]) -> Result<Trajectory, SceneError> {
    let last = times.last().ok_or(SceneError::NoTimes)?;
    let mut before = -f64::MIN_POSITIVE;
    for (index, &time) in (1..).zip(times) {
        if !(time > before && time.is_finite()) {
            return Err(SceneError::Time { index, time });
        }
        before = time;
    }
    scene.check()?;

    let mut moments = Vec::with_capacity(times.len());
    let mut now = (0.0, scene.start());
    let start_energy = Moment::of(scene, now.0, &now.1).energy();
    for &time in times {
        if time > now.0 {
            match advance(scene, now, time, last / FEWEST_STEPS) {
                Ok(state) => now = (time, state),
                Err(stop) => {
                    // an end at once after a sample is that sample
                    let fresh = stop.at.filter(|(time, _)| *time > now.0);
                    moments.extend(fresh.map(|(time, state)| Moment::of(scene, time, &state)));
                    return Ok(Trajectory { moments, ended: stop.ended, start_energy });
                }
            }
        }
        moments.push(Moment::of(scene, time, &now.1));
    }
    Ok(Trajectory { moments, ended: Ended::Completed, start_energy })
}

/// An end before the next sample, and the last state before it unless the integrator gave up.
struct Stop {
    at: Option<(f64, State)>,
    ended: Ended,
}

fn breach((time, state): &(f64, State), scene: &MovingScene) -> Option<Breach> {
    Situation::at(scene, *time, state).breach(scene)
}

/// The state at time `end`.
fn advance(scene: &MovingScene, from: (f64, State), end: f64, longest: f64) -> Result<State, Stop> {
    let (all, failure) = steps(scene, from, end, longest);
    let mut held = from;
    for step in all {
        if let Some(first) = breach(&step, scene) {
            let (at, last) = locate(scene, held, step.0, first);
            return Err(Stop { at: Some(at), ended: Ended::by(last, at.0) });
        }
        held = step;
    }
    match failure {
        None => Ok(held.1),
        Some(why) => Err(Stop { at: None, ended: Ended::Failed { time: held.0, why } }),
    }
}

/// Where the contacts hold for the last time between a state in which they do and a time at which they do not, by
/// bisection; each state is integrated from the first one.
fn locate(scene: &MovingScene, held: (f64, State), broken: f64, mut by: Breach) -> ((f64, State), Breach) {
    let (mut low, mut high) = (held, broken);
    while high - low.0 > LOCATED {
        let middle = low.0 + (high - low.0) / 2.0;
        if middle <= low.0 || middle >= high {
            break;
        }
        let (all, failure) = steps(scene, held, middle, middle - held.0);
        let Some(&state) = all.last().filter(|_| failure.is_none()) else { break };
        match breach(&state, scene) {
            None => low = state,
            Some(found) => (high, by) = (middle, found),
        }
    }
    (low, by)
}
