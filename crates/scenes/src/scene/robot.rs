//! A robot on uneven ground as a scene describes it: `[robot]` and `[ground]`.

use super::simulated::{downwards, sample_times};
use serde::Deserialize;

/// `[robot]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneRobot {
    /// `wheels`: the positions of wheels 1 and 2 from the centre of mass, in the robot's frame, in m.
    pub wheels: [[f64; 2]; 2],
    /// `mass`, in kg.
    pub mass: f64,
    /// `radius_of_gyration` about the centre of mass, in m.
    pub radius_of_gyration: f64,
    /// `speed` of wheel 1 along the ground, in m/s; negative towards smaller x.
    pub speed: f64,
    /// `start`: the x of wheel 1 at first, in m; 0 unless given.
    #[serde(default)]
    pub start: f64,
    /// `gravity` along the Y axis, in m/s^2; -9.81 unless given.
    #[serde(default = "downwards")]
    pub gravity: f64,
}

/// `[ground]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneGround {
    /// `waves`: their sum is the height.
    pub waves: Vec<SceneWave>,
}

/// A wave of the ground: `amplitude * sin(2 pi x / wavelength + phase)`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneWave {
    /// `amplitude`, in m.
    pub amplitude: f64,
    /// `wavelength`, in m.
    pub wavelength: f64,
    /// `phase`, in rad; 0 unless given.
    #[serde(default)]
    pub phase: f64,
}

/// A robot that drives over uneven ground, and the times of its measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedRobot {
    /// `duration`: the time of the last sample, in seconds.
    pub duration: f64,
    /// `samples`, or what follows from `rate`: the number of samples, both ends included.
    pub samples: usize,
    /// `[robot]`.
    pub robot: SceneRobot,
    /// `[ground]`.
    pub ground: SceneGround,
}

impl SimulatedRobot {
    /// The times of the samples, as [`super::Simulated::times`].
    pub fn times(&self, jitter: f64, seed: u64) -> Vec<f64> {
        sample_times(self.duration, self.samples, jitter, seed)
    }
}
