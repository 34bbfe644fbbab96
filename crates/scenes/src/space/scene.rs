//! Scenes in space: `motion = "spatial"`.

use super::super::scene::place::Places;
use super::measurements::SpaceSensor;
use palmistry_bodies::mechanics::spatial::{SolidForm, SpatialDrive, SpatialPalm};
use palmistry_lang::{Code, Problem, ReadError};
use palmistry_observe::FaultRules;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// `[body]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceBody {
    /// `shape`.
    pub form: SolidForm,
    /// `centre_of_mass` in the frame of the shape; the centroid unless given.
    pub centre: Option<[f64; 3]>,
    /// In kg.
    pub mass: f64,
    /// `inertia_over_mass`: entries 11, 22, 33, 12, 13, 23 in the frame of the shape, in m^2; those of one material unless given.
    pub inertia: Option<[f64; 6]>,
    /// `orientation`: the rotation by the length of this vector, in rad, about its direction.
    pub orientation: [f64; 3],
    /// `balanced`: it lies in the pose of balance to which it falls from there, on palms as they are at the start.
    pub balanced: bool,
    /// `rate`: its angular velocity in the world, in rad/s.
    pub rate: [f64; 3],
}

/// `[observer]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpaceObserver {
    /// `window`: the number of samples that are explained at a time; all of them unless given.
    pub window: Option<usize>,
    /// `degree`: the highest degree of the shape's harmonics; the measurements choose unless given.
    pub degree: Option<usize>,
    /// `least_radius` and `greatest_radius`: known bounds of the body's radii of curvature, in m.
    pub radii: [Option<f64>; 2],
}

/// A scene in space.
#[derive(Clone, Debug)]
pub struct SpaceScene {
    /// `title`.
    pub title: String,
    /// `seed`: the seed of the noise.
    pub seed: u64,
    /// The times of the samples in s; none where measurements are recorded.
    pub times: Vec<f64>,
    /// `gravity`: any vector, in m/s^2.
    pub gravity: [f64; 3],
    /// `[body]`; none where measurements are recorded.
    pub body: Option<SpaceBody>,
    /// `azimuth`, `hinge`, `inertia`, `curvature`, `touch_point` of `[palms]`.
    pub palms: [SpatialPalm; 3],
    /// `prescribed` or `torques` of `[palms]`; none where measurements are recorded.
    pub drive: Option<SpatialDrive>,
    /// `[sensor]`.
    pub sensor: SpaceSensor,
    /// `[data] record`, relative to where the program runs.
    pub record: Option<PathBuf>,
    /// The recording's names of its columns.
    pub columns: BTreeMap<String, String>,
    /// `[data] on_fault` and `spike`: how faulty rows of a recording are detected and treated.
    pub faults: FaultRules,
    /// `[observer]`.
    pub observer: SpaceObserver,
    pub(super) name: String,
    pub(super) text: String,
}

impl SpaceScene {
    /// An error at a value of this scene.
    pub fn error_at(&self, place: &str, message: impl Into<String>, help: impl Into<String>) -> ReadError {
        let span = Places::of(&self.text).map_or(0..0, |places| places.value(place));
        Problem::new(Code::SceneValue, &span, message, "here").help(help).locate(&self.name, &self.text)
    }
}
