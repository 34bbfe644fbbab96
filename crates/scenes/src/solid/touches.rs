//! Where the body was touched, in its own frame: what all shapes are made of.

use super::constraint::expanded;
use super::flow::Turned;
use super::integrals::{Integrals, Rules};
use super::refine::Refined;
use super::vector::{along, back};
use nalgebra::{Matrix3, Vector3};

/// A contact in the body's frame, which is the world's at the first sample, about the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidTouch {
    /// Where, in m.
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
    /// What takes the body's frame to the world's.
    pub turn: Matrix3<f64>,
    /// By palm.
    pub touches: [SolidTouch; 3],
}

impl Refined {
    /// The body at all samples, contacts without the errors that they likely have.
    pub fn poses(&self) -> Vec<SolidPose> {
        let readings = &self.corrected;
        let rules = Rules::of(&readings.times, (0..readings.rows()).collect());
        let all = Integrals::of(readings, &rules);
        let samples = expanded(&self.start, &all);
        let pose = |(k, sample): (usize, &super::constraint::Constrained)| {
            let Turned { turn, .. } = sample.at;
            let touches = all.palms[k].map(|palm| SolidTouch {
                point: back(&turn, &along(&palm.contact, -1.0, &sample.centre)).into(),
                normal: -Vector3::from(back(&turn, &palm.normal)).normalize(),
            });
            SolidPose {
                time: readings.times[k],
                centre: sample.centre.into(),
                turn: Matrix3::from_fn(|i, j| turn[i][j]),
                touches,
            }
        };
        samples.iter().enumerate().map(pose).collect()
    }
}
