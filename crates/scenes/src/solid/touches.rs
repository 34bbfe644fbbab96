//! The contacts in the body's own frame, on which all estimates of the shape are based.

use super::constraint::expanded;
use super::flow::Turned;
use super::integrals::{Integrals, Rules};
use super::refine::Refined;
use super::vector::{along, back};
use nalgebra::{Matrix3, Vector3};

/// A contact in the body's frame, which is the world's at the first sample, about the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidTouch {
    /// In m.
    pub point: Vector3<f64>,
    /// The body's outward normal.
    pub normal: Vector3<f64>,
}

/// The body at one sample, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidPose {
    /// In s.
    pub time: f64,
    /// The centre of mass.
    pub centre: Vector3<f64>,
    /// The rotation from the body's frame to the world's.
    pub turn: Matrix3<f64>,
    /// By palm.
    pub touches: [SolidTouch; 3],
}

impl Refined {
    /// The body at all samples, contacts without their likeliest errors.
    pub fn poses(&self) -> Vec<SolidPose> {
        let measurements = &self.corrected;
        let rules = Rules::of(&measurements.times, (0..measurements.rows()).collect());
        let all = Integrals::of(measurements, &rules);
        let samples = expanded(&self.start, &all);
        let pose = |(k, sample): (usize, &super::constraint::Constrained)| {
            let Turned { turn, .. } = sample.at;
            let touches = all.palms[k].map(|palm| SolidTouch {
                point: back(&turn, &along(&palm.contact, -1.0, &sample.centre)).into(),
                normal: -Vector3::from(back(&turn, &palm.normal)).normalize(),
            });
            SolidPose {
                time: measurements.times[k],
                centre: sample.centre.into(),
                turn: Matrix3::from_fn(|i, j| turn[i][j]),
                touches,
            }
        };
        samples.iter().enumerate().map(pose).collect()
    }
}
