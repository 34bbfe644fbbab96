//! Pure integration: the equations, from the first guess to the end. What the thesis resorts to where the state is not
//! observable, and the line below which no observer should fall.

use super::Learned;
use super::task::{Observer, Task};
use super::track::{SampleEstimate, Track};

/// Integrates the estimated states with the outputs as measured, and never compares.
#[derive(Clone, Copy, Debug, Default)]
pub struct Integration;

impl Observer for Integration {
    fn observe(&self, task: &Task<'_>) -> Track {
        let times = task.signals.times();
        let mut track = Track::default();
        let mut belief = Learned::before(task).belief;
        track.estimates.push(unknown(times[0], belief.clone()));
        for (row, &time) in times.iter().enumerate().skip(1) {
            if task.interrupted() {
                break;
            }
            match task.integrate(&belief, row - 1..row + 1) {
                Ok(states) => belief = states.into_iter().next_back().unwrap_or(belief),
                Err(lost) => {
                    if track.unobserved == 0 {
                        track.remarks.push(format!("held from where the equations have no value: {lost}"));
                    }
                    track.unobserved += 1;
                }
            }
            track.estimates.push(unknown(time, belief.clone()));
        }
        track.hand_on(Learned { belief, ..Learned::nothing(task) });
        track
    }
}

/// A state of which the covariance is not known.
fn unknown(time: f64, state: Vec<f64>) -> SampleEstimate {
    SampleEstimate { time, state, deviations: Vec::new(), residual: Vec::new() }
}
