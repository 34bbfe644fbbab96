//! Scenes of slow motion: `motion = "quasistatic"`.

use super::super::scene::Body;
use super::super::scene::place::Places;
use super::families::Family;
use palmistry_bodies::mechanics::moving::Course;
use palmistry_lang::{Code, Problem, ReadError};
use palmistry_observe::FaultRules;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// `[study]`: many bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowStudy {
    /// The number of bodies of each family.
    pub bodies: usize,
    /// The families.
    pub families: Vec<Family>,
    /// Numbers of samples.
    pub samples: Vec<usize>,
    /// Resolutions of the contacts in m; zero for exact measurements.
    pub resolutions: Vec<f64>,
    /// The mean radius of the bodies, in m.
    pub size: f64,
    /// The margin, in radians, that the plan keeps from where palms pull.
    pub margin: f64,
    /// How often it goes round the plan of figure 3.14.
    pub rounds: f64,
    /// The last orders of harmonics, each a row of its own; where empty, the measurements choose it.
    pub orders: Vec<usize>,
    /// The least and the greatest number of jumps of a body; without it only bodies that never jump.
    pub jumps: Option<[usize; 2]>,
}

/// How palms move.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowPalms {
    /// `prescribed`, or the courses of the plan.
    pub courses: [Course; 2],
    /// How far the pads reach from the joint, in m.
    pub lengths: [f64; 2],
}

/// A scene of slow motion.
#[derive(Clone, Debug)]
pub struct SlowScene {
    /// `title`.
    pub title: String,
    /// `seed`: the seed of noise, jitter and random bodies.
    pub seed: u64,
    /// The times of the samples in s; none where measurements are recorded.
    pub times: Vec<f64>,
    /// `[body]`.
    pub body: Option<Body>,
    /// `[palms]`.
    pub palms: Option<SlowPalms>,
    /// The standard deviation of a contact's error, in m.
    pub noise: f64,
    /// The step to which contacts are rounded, in m.
    pub resolution: f64,
    /// `[data] record`, relative to where the program runs.
    pub record: Option<PathBuf>,
    /// The recording's names of the columns `phi1`, `phi2`, `s1`, `s2`.
    pub columns: BTreeMap<String, String>,
    /// `[data] on_fault` and `spike`: how faulty rows of a recording are detected and treated.
    pub faults: FaultRules,
    /// `[study]`.
    pub study: Option<SlowStudy>,
    pub(super) name: String,
    pub(super) text: String,
}

impl SlowScene {
    /// An error at a value of this scene.
    pub fn error_at(&self, place: &str, message: impl Into<String>, help: impl Into<String>) -> ReadError {
        let span = Places::of(&self.text).map_or(0..0, |places| places.value(place));
        Problem::new(Code::SceneValue, &span, message, "here").help(help).locate(&self.name, &self.text)
    }
}
