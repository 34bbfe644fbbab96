//! A scene of slow motion, simulated or recorded, and the answers of every method.

use super::found::{EXACT, SlowShape};
use super::keys::COLUMNS;
use super::kinks::with_kinks;
use super::local::derivative;
use super::measurements::SlowMeasurements;
use super::orders::Orders;
use super::patches::{Arrangement, arrangements};
use super::quadrature::{SlowTrack, by_quadrature};
use super::scene::SlowScene;
use super::segments::{FoundJump, found_jumps, from_segments};
use super::sequence::with_poses_and_jumps;
use super::start::{Vote, from_nothing, from_nothing_briefly, votes};
use super::thesis::{ThesisMethod, ThesisTrack, by_thesis};
use super::together::Together;
use crate::simulation::{deviation, normal, outline};
use miette::Diagnostic;
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::mechanics::moving::{DEFAULT_TOLERANCE, Drive, MovingScene, Shape, Trajectory};
use palmistry_bodies::mechanics::resting::follow_resting;
use palmistry_lang::ReadError;
use palmistry_observe::Record;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::time::Instant;

/// The simulated body and motion.
#[derive(Clone, Debug)]
pub struct SlowTruth {
    /// The body.
    pub shape: Shape,
    /// Its motion.
    pub trajectory: Trajectory,
}

/// A scene with its measurements.
#[derive(Clone, Debug)]
pub struct SlowExperiment {
    /// The scene.
    pub scene: SlowScene,
    /// None where measurements are recorded.
    pub truth: Option<SlowTruth>,
    /// The measurements.
    pub measurements: SlowMeasurements,
}

/// The error of a track: the greatest error of a support radius, in m, and of the orientation, in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackError {
    /// In m.
    pub radius: f64,
    /// In radians, with the frame of the body turned so that it is least.
    pub phi0: f64,
}

/// The answers of all methods.
#[derive(Clone, Debug)]
pub struct SlowAnswers {
    /// The batch estimate of all measurements, with no prior knowledge; none where no start could be followed.
    pub together: Option<SlowShape>,
    /// Whether it explains the measurements.
    pub explained: bool,
    /// The jumps of the body in the estimate.
    pub jumps: Vec<FoundJump>,
    /// 3.48 and 3.49 of the estimate, and of the thesis's method restarted at these jumps from the estimated radii.
    pub arrangements: Option<[Arrangement; 2]>,
    /// Quadrature from the height at the first sample: the true one, or the estimated one.
    pub quadrature: Option<SlowTrack>,
    /// The thesis's method from the radii at the first sample, by each integrator.
    pub thesis: Vec<(ThesisMethod, ThesisTrack)>,
    /// The same by the predictor and corrector, with an error of one percent in the height.
    pub misled: Option<ThesisTrack>,
    /// The constants determined by zeros of 3.37's numerator.
    pub votes: Vec<Vote>,
    /// The seconds of the batch estimate, quadrature, and the predictor and corrector.
    pub seconds: [f64; 3],
}

impl SlowExperiment {
    /// Simulates a scene, or takes its measurements from a file: `data`, or else the one that the scene names.
    ///
    /// # Errors
    /// What is wrong with the body, the palms or the file.
    pub fn new(scene: SlowScene, data: Option<&Path>) -> Result<SlowExperiment, ReadError> {
        if let Some(file) = data.or(scene.record.as_deref()) {
            let measurements = recorded(&scene, file)?;
            return Ok(SlowExperiment { scene, truth: None, measurements });
        }
        let (Some(body), Some(palms)) = (&scene.body, &scene.palms) else {
            return Err(scene.error_at("title", "there is nothing to observe", "name a recording in [data]"));
        };
        let help = "a body has to be smooth and strictly convex, with its centre of mass inside";
        let (shape, _) = outline(body)
            .and_then(|(shape, draws)| Ok((shape.without_corners()?, draws)))
            .map_err(|error| scene.error_at("body.shape", error.to_string(), help))?;
        let moved = MovingScene {
            mass: body.mass,
            gyration: body.radius_of_gyration.unwrap_or_else(|| shape.gyration()),
            orientation: body.orientation,
            rate: 0.0,
            gravity: body.gravity,
            palm_inertia: [1.0; 2],
            palm_lengths: palms.lengths,
            palms: [Palm::Flat; 2],
            drive: Drive::Prescribed(palms.courses.clone()),
            tolerance: DEFAULT_TOLERANCE,
            shape,
        };
        let trajectory = follow_resting(&moved, &scene.times).map_err(|error| {
            scene.error_at(
                "palms",
                error.to_string(),
                "both palms have to push: phi1, phi2 and pi - phi1 - phi2 positive",
            )
        })?;
        let measurements = measurements_of(&trajectory, scene.noise, scene.resolution, scene.seed);
        Ok(SlowExperiment { truth: Some(SlowTruth { shape: moved.shape, trajectory }), measurements, scene })
    }

    /// The measurements as a table that this program and others can read.
    ///
    /// # Errors
    /// None that a simulation brings about.
    pub fn record(&self) -> Result<Record, palmistry_observe::RecordError> {
        let column = |name: &str, of: &dyn Fn(usize) -> f64| {
            (name.to_owned(), (0..self.measurements.rows()).map(of).collect::<Vec<f64>>())
        };
        let r = &self.measurements;
        let columns = vec![
            column("phi1", &|i| r.palms[i][0]),
            column("phi2", &|i| r.palms[i][1]),
            column("s1", &|i| r.contacts[i][0]),
            column("s2", &|i| r.contacts[i][1]),
        ];
        Record::new(r.times.clone(), columns)
    }

    /// The answers of all methods; `done` is called after each step.
    pub fn run(&self, interrupt: &dyn Fn() -> bool, done: &dyn Fn(&'static str)) -> SlowAnswers {
        let measurements = &self.measurements;
        let timed = |seconds: &mut f64, begin: Instant| *seconds = begin.elapsed().as_secs_f64();
        let mut seconds = [f64::NAN; 3];
        let begin = Instant::now();
        let together =
            from_any(measurements, interrupt).map(|found| without_excess(measurements, found, interrupt));
        timed(&mut seconds[0], begin);
        done("batch least squares");
        let explained = together.as_ref().is_some_and(|found| found.explains(EXACT));
        let start = match (&self.truth, &together) {
            (Some(truth), _) => {
                truth.trajectory.moments.first().map(|at| (at.centre[1], at.palms.map(|palm| palm.r)))
            }
            (None, Some(found)) => {
                found.track.height.first().copied().zip(found.track.radii.first().copied())
            }
            (None, None) => None,
        };
        let begin = Instant::now();
        let quadrature = start.map(|(height, _)| by_quadrature(measurements, height));
        timed(&mut seconds[1], begin);
        done("quadrature");
        let mut thesis = Vec::new();
        let mut misled = None;
        if let Some((height, radii)) = start {
            for method in ThesisMethod::ALL {
                let begin = Instant::now();
                thesis.push((method, by_thesis(measurements, radii, method)));
                if method == ThesisMethod::PredictorCorrector {
                    timed(&mut seconds[2], begin);
                }
            }
            let off = measurements.sampled(0).radii(1.01 * height);
            misled = Some(by_thesis(measurements, off, ThesisMethod::PredictorCorrector));
        }
        done("the thesis's way");
        let jumps = match &together {
            Some(found) if explained => found_jumps(measurements, found),
            _ => Vec::new(),
        };
        let arrangements = together.as_ref().map(|found| arrangements(measurements, &found.track, &jumps));
        SlowAnswers {
            explained,
            jumps,
            arrangements,
            together,
            quadrature,
            thesis,
            misled,
            votes: votes(measurements),
            seconds,
        }
    }

    /// The error of a whole track; none where the truth is not known, or the track stopped before.
    pub fn error(&self, track: &SlowTrack) -> Option<TrackError> {
        track_error(&self.truth.as_ref()?.trajectory, track)
    }
}

/// A shape from few starts; where none explains the measurements, one for all segments between jumps; where that fails too, from all starts.
fn from_any(measurements: &SlowMeasurements, interrupt: &dyn Fn() -> bool) -> Option<SlowShape> {
    let explains = |found: &SlowShape| found.explains(EXACT);
    from_nothing_briefly(measurements, Orders::CHOSEN, interrupt)
        .filter(explains)
        .or_else(|| from_segments(measurements, interrupt).filter(explains))
        .or_else(|| from_nothing(measurements, interrupt))
}

/// The estimate of a search, without harmonics, jumps and unevenness that the measurements do not require.
pub(super) fn without_excess(
    measurements: &SlowMeasurements,
    found: SlowShape,
    interrupt: &dyn Fn() -> bool,
) -> SlowShape {
    let simpler = Together::of(measurements).with_fewer_harmonics(found, interrupt);
    with_poses_and_jumps(measurements, with_kinks(measurements, simpler, interrupt), interrupt)
}

/// The errors of a track, which needs all samples.
pub(super) fn track_error(truth: &Trajectory, track: &SlowTrack) -> Option<TrackError> {
    let moments = &truth.moments;
    if track.radii.len() != moments.len() || moments.is_empty() {
        return None;
    }
    let radii = track.radii.iter().zip(moments);
    let radius = radii
        .flat_map(|(r, at)| [0, 1].map(|i: usize| (r[i] - at.palms[i].r).abs()))
        .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
    // whole turns at a jump are no errors
    let first = track.phi0[0] - moments[0].phi0;
    let off: Vec<f64> = (track.phi0.iter().zip(moments))
        .map(|(phi0, at)| (phi0 - at.phi0 - first + PI).rem_euclid(TAU) - PI)
        .collect();
    let ends =
        off.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |ends, x| [ends[0].min(*x), ends[1].max(*x)]);
    let phi0 = (ends[1] - ends[0]) / 2.0;
    (radius.is_finite() && phi0.is_finite()).then_some(TrackError { radius, phi0 })
}

/// The measurements of a motion: contacts with normal errors, rounded; exact angles.
pub(super) fn measurements_of(
    trajectory: &Trajectory,
    noise: f64,
    resolution: f64,
    seed: u64,
) -> SlowMeasurements {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let moments = &trajectory.moments;
    let mut read = |s: f64| {
        let s = s + noise * normal(&mut random);
        if resolution > 0.0 { (s / resolution).round() * resolution } else { s }
    };
    SlowMeasurements {
        times: moments.iter().map(|at| at.time).collect(),
        palms: moments.iter().map(|at| at.palms.map(|palm| palm.angle)).collect(),
        rates: moments.iter().map(|at| at.palms.map(|palm| palm.rate)).collect(),
        contacts: moments.iter().map(|at| [read(at.palms[0].s), read(at.palms[1].s)]).collect(),
        sigma: deviation(noise, resolution),
    }
}

/// The measurements of a file. The palms' rates are computed by differentiation: the angles are accurate.
fn recorded(scene: &SlowScene, file: &Path) -> Result<SlowMeasurements, ReadError> {
    let names = COLUMNS.map(|name| scene.columns.get(name).map_or(name, String::as_str));
    let mut rules = scene.faults.clone();
    rules.resolution.extend(names[2..].iter().map(|name| ((*name).to_owned(), scene.resolution)));
    let found = Record::read_checked(file, &names, &rules).map_err(|error| {
        let help = error.help().map(|help| help.to_string()).unwrap_or_default();
        scene.error_at(
            "data",
            error.to_string(),
            format!("{help}; columns with other names are named in [data] columns = {{ s1 = \"...\" }}"),
        )
    })?;
    let record = found.record;
    let times = record.times().to_vec();
    if times.len() < 8 {
        return Err(scene.error_at(
            "data",
            format!("there are {} samples", times.len()),
            "let there be 8 and more",
        ));
    }
    let [phi1, phi2, s1, s2] = names.map(|name| record.column(name).unwrap_or_default().to_vec());
    let pairs = |a: &[f64], b: &[f64]| -> Vec<[f64; 2]> { a.iter().zip(b).map(|(a, b)| [*a, *b]).collect() };
    let palms = pairs(&phi1, &phi2);
    let pushes = |[phi1, phi2]: &[f64; 2]| phi1.sin() > 0.0 && phi2.sin() > 1e-4 && (phi1 + phi2).sin() > 0.0;
    if let Some(row) = palms.iter().position(|palms| !pushes(palms)) {
        let message = format!(
            "at {} s a palm would have to pull: phi1 = {}, phi2 = {}",
            times[row], phi1[row], phi2[row]
        );
        return Err(scene.error_at("data", message, "angles are in radians, palm 2's against palm 1"));
    }
    let rates = pairs(&derivative(&times, &phi1, 9), &derivative(&times, &phi2, 9));
    let sigma = deviation(scene.noise, scene.resolution);
    Ok(SlowMeasurements { rates, contacts: pairs(&s1, &s2), palms, times, sigma })
}
