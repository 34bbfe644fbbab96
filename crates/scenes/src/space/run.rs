//! A scene in space, simulated or recorded, and the estimates from its measurements without prior knowledge.

use super::answers::{PoseError, SpaceUpdate, SpaceVerdict};
use super::drawn::true_entries;
use super::measurements::SpaceMeasurements;
use super::scene::SpaceScene;
use super::touched::{SpaceShape, chained};
use crate::solid::{FEWEST, SolidMeasurements, SolidPose};
use nalgebra::{Matrix3, Vector3};
use palmistry_bodies::mechanics::spatial::{
    ConvexSolid, Orientation, SpatialMoment, SpatialScene, SpatialSceneError, SpatialTrajectory,
    balanced_orientation, simulate_solid,
};
use palmistry_lang::ReadError;
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

/// The tolerance of the integrator.
const TOLERANCE: f64 = 1e-13;

/// The simulated body and motion.
#[derive(Clone, Debug)]
pub struct SpaceTruth {
    /// Body, palms and start.
    pub scene: SpatialScene,
    /// The motion.
    pub trajectory: SpatialTrajectory,
}

/// A scene with its measurements.
#[derive(Clone, Debug)]
pub struct SpaceExperiment {
    /// The scene.
    pub scene: SpaceScene,
    /// None where measurements are recorded.
    pub truth: Option<SpaceTruth>,
    /// The measurements.
    pub measurements: SpaceMeasurements,
}

/// The estimates.
#[derive(Clone, Debug)]
pub struct SpaceAnswers {
    /// One for the whole record, or one a window.
    pub updates: Vec<SpaceUpdate>,
    /// The shape from the windows up to the first that does not fit; none where that is the first of all.
    pub shape: Option<SpaceShape>,
}

impl SpaceAnswers {
    /// Whether some window is explained, and none has measurements that no body explains. A window from which the state is not observable is a valid
    /// part of the answer.
    pub fn as_expected(&self) -> bool {
        let mut verdicts = self.updates.iter().map(|update| update.verdict);
        let wrong = |verdict| matches!(verdict, SpaceVerdict::DoesNotFit | SpaceVerdict::Lost);
        !verdicts.clone().any(wrong) && verdicts.any(|verdict| verdict == SpaceVerdict::Fits)
    }

    /// Replaces each time by NaN.
    pub fn forget_times(&mut self) {
        self.updates.iter_mut().for_each(|update| update.seconds = f64::NAN);
    }
}

impl SpaceExperiment {
    /// Simulates a scene, or takes its measurements from a file: `data`, or else the one that the scene names.
    ///
    /// # Errors
    /// What is wrong with the body, the palms or the file.
    pub fn new(scene: SpaceScene, data: Option<&Path>) -> Result<SpaceExperiment, ReadError> {
        if let Some(file) = data.or(scene.record.as_deref()) {
            let measurements = SpaceMeasurements::recorded(&scene, file)?;
            return Ok(SpaceExperiment { scene, truth: None, measurements });
        }
        let truth = simulated(&scene)?;
        let moments = &truth.trajectory.moments;
        if moments.len() < FEWEST {
            let last = moments.last().map_or(0.0, |moment| moment.time);
            let message =
                format!("all palms hold the body for {last:.4} s, which is {} samples", moments.len());
            let help = "start in balance (balanced = true), turn body and palms slower, or sample faster";
            return Err(scene.error_at("body", message, help));
        }
        let measurements = SpaceMeasurements::of(moments, &scene.sensor, scene.seed);
        Ok(SpaceExperiment { scene, truth: Some(truth), measurements })
    }

    /// The measurements with the places of the palms.
    pub fn solid(&self) -> SolidMeasurements {
        self.measurements.solid(&self.scene.palms, self.scene.gravity, &self.scene.sensor)
    }

    /// The windows, each from the last sample of the one before.
    fn windows(&self) -> Vec<Range<usize>> {
        let rows = self.measurements.times.len();
        let length = self.scene.observer.window.unwrap_or(rows).clamp(FEWEST, rows);
        let mut windows = Vec::new();
        let mut from = 0;
        loop {
            let to = from + length;
            // the remaining samples would be too few for a window
            if to - 1 + FEWEST > rows {
                windows.push(from..rows);
                return windows;
            }
            windows.push(from..to);
            from = to - 1;
        }
    }

    /// How many windows there are.
    pub fn count(&self) -> usize {
        self.windows().len()
    }

    /// The estimates from the measurements; `done` is called after each window.
    pub fn run(&self, interrupt: &dyn Fn() -> bool, done: &dyn Fn()) -> SpaceAnswers {
        let all = self.solid();
        let mut updates = Vec::new();
        for rows in self.windows() {
            if interrupt() {
                break;
            }
            let begin = Instant::now();
            let part = SolidMeasurements {
                times: all.times[rows.clone()].to_vec(),
                palms: all.palms[rows.clone()].to_vec(),
                ..all.clone()
            };
            let found = part.explained(interrupt);
            let verdict = match &found {
                None if part.is_still() => SpaceVerdict::Unobservable,
                None => SpaceVerdict::Lost,
                Some((state, _)) if !state.fits() => SpaceVerdict::DoesNotFit,
                Some((state, _)) if state.is_unobservable() => SpaceVerdict::Unobservable,
                Some((state, _)) if state.rival.is_some() => SpaceVerdict::Ambiguous,
                Some(_) => SpaceVerdict::Fits,
            };
            let (state, poses) = found.map_or((None, Vec::new()), |(state, poses)| (Some(state), poses));
            updates.push(SpaceUpdate { rows, verdict, state, poses, seconds: begin.elapsed().as_secs_f64() });
            done();
        }
        let touched = chained(&updates, all.contact_deviation);
        let radii = self.scene.palms.map(|palm| match palm.curvature < 0.0 {
            true => -1.0 / palm.curvature,
            false => f64::INFINITY,
        });
        let shape = touched.map(|touched| SpaceShape::of(touched, &self.scene.observer, radii));
        SpaceAnswers { updates, shape }
    }

    /// The true state at the first sample of a window, in the order of [`SolidState::entries`].
    pub fn true_entries(&self, update: &SpaceUpdate) -> Option<[f64; 16]> {
        let truth = self.truth.as_ref()?;
        Some(true_entries(&truth.scene, &truth.trajectory.moments[update.rows.start]))
    }

    /// The errors of poses; nothing where the truth is not known.
    pub fn errors(&self, update: &SpaceUpdate) -> Vec<PoseError> {
        let Some(truth) = &self.truth else { return Vec::new() };
        let moments = &truth.trajectory.moments[update.rows.clone()];
        let Some(first) = moments.first() else { return Vec::new() };
        let start = first.orientation.matrix();
        let error = |(pose, moment): (&SolidPose, &SpatialMoment)| PoseError {
            time: moment.time,
            centre: (pose.centre - moment.centre).norm(),
            turn: angle(&(pose.turn * start * moment.orientation.matrix().transpose())),
            radius: (0..3)
                .map(|i| {
                    let (touch, palm) = (&pose.touches[i], &moment.palms[i]);
                    (touch.point.dot(&touch.normal) - palm.touched.dot(&palm.outward)).abs()
                })
                .fold(0.0, f64::max),
        };
        update.poses.iter().zip(moments).map(error).collect()
    }

    /// The true support radius at a normal in the frame of the estimated shape, which is the world's at the first sample; and the point there.
    pub fn true_support(&self, normal: &Vector3<f64>) -> Option<(f64, Vector3<f64>)> {
        let truth = self.truth.as_ref()?;
        let turn = truth.trajectory.moments.first()?.orientation.matrix();
        let support = truth.scene.solid.support(&(turn.transpose() * normal));
        Some((support.extent, turn * support.point))
    }
}

/// The angle of a rotation, without the rounding error of a cosine near one.
fn angle(turn: &Matrix3<f64>) -> f64 {
    let skew = (turn - turn.transpose()) / 2.0;
    Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)]).norm().atan2((turn.trace() - 1.0) / 2.0)
}

pub(super) fn simulated(scene: &SpaceScene) -> Result<SpaceTruth, ReadError> {
    let (Some(body), Some(drive)) = (&scene.body, &scene.drive) else {
        return Err(scene.error_at("title", "there is nothing to observe", "name a recording in [data]"));
    };
    let help = "a body has to be smooth and strictly convex, with its centre of mass inside";
    let solid = ConvexSolid::new(body.form.clone(), body.centre)
        .map_err(|error| scene.error_at("body.shape", error.to_string(), help))?;
    let inertia = match body.inertia {
        Some([a, b, c, d, e, f]) => Matrix3::new(a, d, e, d, b, f, e, f, c),
        None => {
            // of one material about its centroid; further off it is greater (Steiner)
            let off = solid.centroid();
            solid.uniform_inertia() + Matrix3::identity() * off.norm_squared() - off * off.transpose()
        }
    };
    let mut moved = SpatialScene {
        mass: body.mass,
        inertia_over_mass: inertia,
        solid,
        orientation: Orientation::by(&Vector3::from(body.orientation)),
        rate: body.rate,
        gravity: scene.gravity,
        palms: scene.palms,
        drive: drive.clone(),
        tolerance: TOLERANCE,
    };
    let refused = |error: SpatialSceneError| {
        let (place, help) = match &error {
            SpatialSceneError::Hollow { palm, .. } => {
                (format!("palms.curvature[{}]", palm - 1), "bend the palm less, or give another body")
            }
            SpatialSceneError::NoContact => {
                ("palms.curvature".to_owned(), "bend the palms less, or move touch_point")
            }
            _ => {
                let help =
                    "all three palms have to push, their normals spread, the values be those of a body";
                ("body".to_owned(), help)
            }
        };
        scene.error_at(&place, error.to_string(), help)
    };
    if body.balanced {
        moved.orientation = balanced_orientation(&moved).map_err(refused)?.ok_or_else(|| {
            let help = "give another orientation to fall from, other palms, or leave out balanced";
            scene.error_at("body.balanced", "there is no pose of balance to fall to", help)
        })?;
    }
    let trajectory = simulate_solid(&moved, &scene.times).map_err(refused)?;
    Ok(SpaceTruth { scene: moved, trajectory })
}
