//! What moves the palms: prescribed angles, or torques.

use serde::Deserialize;
use std::f64::consts::TAU;

/// `amplitude sin(2 pi frequency t + phase)`: the amplitude in the unit of what oscillates, the frequency in hertz,
/// the phase in radians, zero unless given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Oscillation {
    pub amplitude: f64,
    pub frequency: f64,
    #[serde(default)]
    pub phase: f64,
}

impl Oscillation {
    /// Its value and first two time derivatives.
    fn at(&self, time: f64) -> [f64; 3] {
        let turning = TAU * self.frequency;
        let (sine, cosine) = (turning * time + self.phase).sin_cos();
        [sine, turning * cosine, -turning * turning * sine].map(|x| self.amplitude * x)
    }
}

/// An angle that is prescribed for all times: `start + rate t` and oscillations, in radians and seconds. A phase that is
/// not zero moves the angle at time zero away from `start`. What is not given is zero.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Course {
    pub start: f64,
    #[serde(default)]
    pub rate: f64,
    #[serde(default)]
    pub swings: Vec<Oscillation>,
}

impl Course {
    /// The angle, its rate and its acceleration at a time.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let steady = [self.start + self.rate * time, self.rate, 0.0];
        self.swings.iter().fold(steady, |sum, swing| {
            let swing = swing.at(time);
            std::array::from_fn(|i| sum[i] + swing[i])
        })
    }
}

/// A palm that a motor pushes: where and how fast it starts, in radians and seconds, and the motor's torque about the
/// origin, `torque` and oscillations, in newton metres.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushedPalm {
    pub angle: f64,
    #[serde(default)]
    pub rate: f64,
    pub torque: f64,
    #[serde(default)]
    pub swings: Vec<Oscillation>,
}

impl PushedPalm {
    /// The torque at a time.
    pub fn torque_at(&self, time: f64) -> f64 {
        self.swings.iter().fold(self.torque, |sum, swing| sum + swing.at(time)[0])
    }
}

/// What moves the palms. Palm 1's angle is against the X axis, palm 2's against palm 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// The angles are prescribed; contact forces and motor torques are results.
    Prescribed([Course; 2]),
    /// The torques are prescribed; the palms' angles are results as well. Both motors stand on the ground: what one of them
    /// exerts on its palm is not taken from the other palm (equations 4.7 and 4.8).
    Torques([PushedPalm; 2]),
}
