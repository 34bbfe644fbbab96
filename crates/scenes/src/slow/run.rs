//! A scene of slow motion, simulated or recorded, and what every way makes of its readings.

use super::found::{EXACT, SlowShape};
use super::keys::COLUMNS;
use super::kinks::with_kinks;
use super::ladder::Orders;
use super::local::derivative;
use super::patches::{Arrangement, arrangements};
use super::quadrature::{SlowTrack, by_quadrature};
use super::readings::SlowMeasurements;
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

/// What was simulated.
#[derive(Clone, Debug)]
pub struct SlowTruth {
    /// The body.
    pub shape: Shape,
    /// Its motion.
    pub trajectory: Trajectory,
}

/// A scene with its readings.
#[derive(Clone, Debug)]
pub struct SlowExperiment {
    /// The scene.
    pub scene: SlowScene,
    /// None where readings are recorded.
    pub truth: Option<SlowTruth>,
    /// What the palms read.
    pub readings: SlowMeasurements,
}

/// How far a track is from the truth: the greatest error of a support radius, in m, and of the orientation, in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackError {
    /// In m.
    pub radius: f64,
    /// In radians, the frame of the body turned so that it is least.
    pub phi0: f64,
}

/// What all ways make of the readings.
#[derive(Clone, Debug)]
pub struct SlowAnswers {
    /// All readings at once, nothing known; none where no start could be followed.
    pub together: Option<SlowShape>,
    /// Whether it explains the readings.
    pub explained: bool,
    /// Where the body jumps in what was found.
    pub jumps: Vec<FoundJump>,
    /// 3.48 and 3.49 of what was found, and of the thesis's way restarted at these jumps from the radii that were found.
    pub arrangements: Option<[Arrangement; 2]>,
    /// Quadrature from the height at the first sample: the true one, or the one that was found.
    pub quadrature: Option<SlowTrack>,
    /// The thesis's way from the radii at the first sample, by each method.
    pub thesis: Vec<(ThesisMethod, ThesisTrack)>,
    /// The same by the predictor and corrector, with the height one in a hundred off.
    pub misled: Option<ThesisTrack>,
    /// The constants that zeros of 3.37's numerator tell.
    pub votes: Vec<Vote>,
    /// Seconds that all at once, quadrature and the predictor and corrector took.
    pub seconds: [f64; 3],
}

impl SlowExperiment {
    /// Simulates a scene, or takes its readings from a file: `data`, or else the one that the scene names.
    ///
    /// # Errors
    /// What is wrong with the body, the palms or the file.
    pub fn new(scene: SlowScene, data: Option<&Path>) -> Result<SlowExperiment, ReadError> {
        if let Some(file) = data.or(scene.record.as_deref()) {
            let readings = recorded(&scene, file)?;
            return Ok(SlowExperiment { scene, truth: None, readings });
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
        let readings = readings_of(&trajectory, scene.noise, scene.resolution, scene.seed);
        Ok(SlowExperiment { truth: Some(SlowTruth { shape: moved.shape, trajectory }), readings, scene })
    }

    /// The readings as a table that other programs, and this one, read.
    ///
    /// # Errors
    /// None that a simulation brings about.
    pub fn record(&self) -> Result<Record, palmistry_observe::RecordError> {
        let column = |name: &str, of: &dyn Fn(usize) -> f64| {
            (name.to_owned(), (0..self.readings.rows()).map(of).collect::<Vec<f64>>())
        };
        let r = &self.readings;
        let columns = vec![
            column("phi1", &|i| r.palms[i][0]),
            column("phi2", &|i| r.palms[i][1]),
            column("s1", &|i| r.contacts[i][0]),
            column("s2", &|i| r.contacts[i][1]),
        ];
        Record::new(r.times.clone(), columns)
    }

    /// What all ways make of the readings; `done` is told of each step.
    pub fn run(&self, interrupt: &dyn Fn() -> bool, done: &dyn Fn(&'static str)) -> SlowAnswers {
        let readings = &self.readings;
        let timed = |seconds: &mut f64, begin: Instant| *seconds = begin.elapsed().as_secs_f64();
        let mut seconds = [f64::NAN; 3];
        let begin = Instant::now();
        let together = from_any(readings, interrupt).map(|found| without_excess(readings, found, interrupt));
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
        let quadrature = start.map(|(height, _)| by_quadrature(readings, height));
        timed(&mut seconds[1], begin);
        done("quadrature");
        let mut thesis = Vec::new();
        let mut misled = None;
        if let Some((height, radii)) = start {
            for method in ThesisMethod::ALL {
                let begin = Instant::now();
                thesis.push((method, by_thesis(readings, radii, method)));
                if method == ThesisMethod::PredictorCorrector {
                    timed(&mut seconds[2], begin);
                }
            }
            let off = readings.sampled(0).radii(1.01 * height);
            misled = Some(by_thesis(readings, off, ThesisMethod::PredictorCorrector));
        }
        done("the thesis's way");
        let jumps = match &together {
            Some(found) if explained => found_jumps(readings, found),
            _ => Vec::new(),
        };
        let arrangements = together.as_ref().map(|found| arrangements(readings, &found.track, &jumps));
        SlowAnswers {
            explained,
            jumps,
            arrangements,
            together,
            quadrature,
            thesis,
            misled,
            votes: votes(readings),
            seconds,
        }
    }

    /// How far a whole track is from the truth; none where this is not known, or the track stopped before.
    pub fn error(&self, track: &SlowTrack) -> Option<TrackError> {
        track_error(&self.truth.as_ref()?.trajectory, track)
    }
}

/// A shape from few starts; where none explains the readings one for all segments between jumps; where there is none either from all starts.
fn from_any(readings: &SlowMeasurements, interrupt: &dyn Fn() -> bool) -> Option<SlowShape> {
    let explains = |found: &SlowShape| found.explains(EXACT);
    from_nothing_briefly(readings, Orders::CHOSEN, interrupt)
        .filter(explains)
        .or_else(|| from_segments(readings, interrupt).filter(explains))
        .or_else(|| from_nothing(readings, interrupt))
}

/// What a search found, without harmonics, jumps and unevenness that the readings do not ask for.
pub(super) fn without_excess(
    readings: &SlowMeasurements,
    found: SlowShape,
    interrupt: &dyn Fn() -> bool,
) -> SlowShape {
    let simpler = Together::of(readings).with_fewer_harmonics(found, interrupt);
    with_poses_and_jumps(readings, with_kinks(readings, simpler, interrupt), interrupt)
}

/// The errors of a track, which has to have all samples.
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

/// What palms read of a motion: contacts with normal errors, rounded; the angles as they are.
pub(super) fn readings_of(
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

/// Readings of a file. Rates of the palms are differentiated: the angles are known well.
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
