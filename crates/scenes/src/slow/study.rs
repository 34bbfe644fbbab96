//! Many bodies: how often, how accurately and how fast each method finds a shape.

use super::families::Family;
use super::found::EXACT;
use super::orders::Orders;
use super::quadrature::by_quadrature;
use super::run::{measurements_of, track_error, without_excess};
use super::scene::{SlowScene, SlowStudy};
use super::segments::{FoundJump, found_jumps, from_segments};
use super::start::from_nothing_within;
use super::stopwatch::Stopwatch;
use super::thesis::{ThesisMethod, by_thesis};
use palmistry_bodies::mechanics::Palm;
use palmistry_bodies::mechanics::moving::{
    DEFAULT_TOLERANCE, Drive, FormError, MovingScene, Shape, Trajectory,
};
use palmistry_bodies::mechanics::resting::{follow_resting, plan_3_14};
use palmistry_bodies::shape::SupportFunction;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// How long the plan takes, in s: nothing depends on it.
const DURATION: f64 = 100.0;

/// An outline whose error is less than this fraction of the mean radius (or so many times the resolution) counts as recovered.
const RECOVERED: f64 = 1e-2;
const RECOVERED_RESOLUTIONS: f64 = 2.0;

/// Draws for a body that jumps as often as required and does not leave the palms.
const MOST_DRAWS: usize = 200;

/// The results of one method over all bodies of a row. Errors are relative to the mean radius, and in radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WayTally {
    /// The greatest error of a support radius on the way, one a body; infinite where the method stopped.
    pub radius: Vec<f64>,
    /// The greatest error of the orientation.
    pub phi0: Vec<f64>,
    /// All seconds of processor time.
    pub seconds: f64,
}

impl WayTally {
    fn add(&mut self, error: Option<super::run::TrackError>, size: f64, seconds: f64) {
        self.radius.push(error.map_or(f64::INFINITY, |error| error.radius / size));
        self.phi0.push(error.map_or(f64::INFINITY, |error| error.phi0));
        self.seconds += seconds;
    }

    /// Bodies on which the method ended before the last sample, or found nothing.
    pub fn stopped(&self) -> usize {
        self.radius.iter().filter(|radius| radius.is_infinite()).count()
    }
}

/// Runs with the same number of jumps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JumpTally {
    /// The number of runs.
    pub runs: usize,
    /// Those whose whole outline was recovered.
    pub recovered: usize,
    /// Those in which every jump was found between its own two samples, and no other.
    pub located: usize,
    /// The runs whose measurements are explained by the estimate.
    pub explained: usize,
    /// Of these the ones with a false jump: a certain one ([`FoundJump::certain`](super::FoundJump)) between whose samples the body did not jump.
    pub false_jumps: usize,
    /// Of the explained runs the ones with a jump of the body between two samples that is not reported.
    pub missed: usize,
    /// The number of jumps of the recovered runs, and of those to which descent in the recovered potential leads.
    pub predicted: [usize; 2],
}

/// The median and the worst of a list; none of an empty one.
pub fn median_and_worst(values: &[f64]) -> Option<[f64; 2]> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    Some([*sorted.get(sorted.len() / 2)?, *sorted.last()?])
}

/// A row of the study: a family, a number of samples, a resolution.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRow {
    /// The family.
    pub family: Family,
    /// The samples.
    pub samples: usize,
    /// The resolution, in m.
    pub resolution: f64,
    /// The last order of harmonics; where none, the measurements choose it.
    pub order: Option<usize>,
    /// The bodies.
    pub bodies: usize,
    /// The number of bodies that was required: there are fewer where the draws ran out, or it was interrupted.
    pub asked: usize,
    /// The bodies that were drawn besides and jumped, or not as often as required.
    pub jumped: usize,
    /// Of runs with jumps, by their number.
    pub jumps: BTreeMap<usize, JumpTally>,
    /// Sections 3.3 and 3.4, from the true radii, by each of [`ThesisMethod::ALL`].
    pub thesis: [WayTally; 3],
    /// From the true height.
    pub quadrature: WayTally,
    /// With no prior knowledge.
    pub together: WayTally,
    /// The greatest error of the whole outline, in m, one a body.
    pub outline: Vec<f64>,
    /// The bodies whose outline was recovered.
    pub recovered: usize,
    /// The bodies whose outline was not recovered, although the measurements are explained.
    pub silent: usize,
}

impl StudyRow {
    /// Replaces each time by NaN.
    pub fn forget_times(&mut self) {
        let ways = self.thesis.iter_mut().chain([&mut self.quadrature, &mut self.together]);
        ways.for_each(|way| way.seconds = f64::NAN);
    }
}

/// The greatest difference of two outlines about their centres of mass over all directions, in m, one of them turned so that it is least.
fn outline_error(shape: &Shape, found: &SupportFunction) -> f64 {
    const DIRECTIONS: usize = 720;
    let truth: Vec<f64> =
        (0..DIRECTIONS).map(|i| shape.support(TAU * i as f64 / DIRECTIONS as f64)[0]).collect();
    let off = |turn: f64| {
        let at = |i: usize| found.support(TAU * i as f64 / DIRECTIONS as f64 + turn)[0] - truth[i];
        (0..DIRECTIONS).map(|i| at(i).abs()).fold(0.0, f64::max)
    };
    let coarse = |i: &usize| off(TAU * *i as f64 / 360.0);
    let best = (0..360).min_by(|a, b| coarse(a).total_cmp(&coarse(b))).unwrap_or(0);
    // golden section
    let (mut low, mut high) = (TAU * (best as f64 - 1.0) / 360.0, TAU * (best as f64 + 1.0) / 360.0);
    let part = (5f64.sqrt() - 1.0) / 2.0;
    for _ in 0..60 {
        let (a, b) = (high - part * (high - low), low + part * (high - low));
        if off(a) < off(b) { high = b } else { low = a }
    }
    off(f64::midpoint(low, high))
}

/// The study of a scene: a row for each family, number of samples and resolution. Bodies that jump on the plan are counted and drawn anew. `found` is called after each body with the rows so far, including
/// the incomplete one, and once more at the end.
///
/// # Errors
/// What is wrong with the bodies.
pub fn slow_study(
    scene: &SlowScene,
    interrupt: &dyn Fn() -> bool,
    found: &dyn Fn(&[StudyRow]),
) -> Result<(), FormError> {
    let Some(study) = &scene.study else { return Ok(()) };
    let orders: Vec<Option<usize>> =
        if study.orders.is_empty() { vec![None] } else { study.orders.iter().copied().map(Some).collect() };
    let mut rows = Vec::new();
    for &family in &study.families {
        for &samples in &study.samples {
            for &resolution in &study.resolutions {
                for &order in &orders {
                    let mut row = StudyRow::begun(family, samples, resolution, order, study.bodies);
                    // the same bodies in every row of a family
                    let mut random = ChaCha8Rng::seed_from_u64(scene.seed);
                    while row.bodies < study.bodies && row.jumped < MOST_DRAWS * study.bodies && !interrupt()
                    {
                        let shape = family.draw(study.size, &mut random)?;
                        let before = row.clone();
                        let is_one = one_body(&mut row, shape, scene, study, interrupt);
                        if interrupt() {
                            // a search that was cut off is no failure
                            row = before;
                        } else if is_one {
                            rows.push(row.clone());
                            found(&rows);
                            rows.pop();
                        }
                    }
                    rows.push(row);
                }
            }
        }
    }
    found(&rows);
    Ok(())
}

impl StudyRow {
    fn begun(
        family: Family,
        samples: usize,
        resolution: f64,
        order: Option<usize>,
        asked: usize,
    ) -> StudyRow {
        StudyRow {
            family,
            samples,
            resolution,
            order,
            bodies: 0,
            asked,
            jumped: 0,
            jumps: BTreeMap::new(),
            thesis: Default::default(),
            quadrature: WayTally::default(),
            together: WayTally::default(),
            outline: Vec::new(),
            recovered: 0,
            silent: 0,
        }
    }
}

/// Adds a body to a row; false where it does not jump as often as required, which is not at all unless stated.
fn one_body(
    row: &mut StudyRow,
    shape: Shape,
    scene: &SlowScene,
    study: &SlowStudy,
    interrupt: &dyn Fn() -> bool,
) -> bool {
    let Ok(courses) = plan_3_14(study.margin, study.rounds, DURATION) else { return false };
    let times: Vec<f64> = (0..row.samples).map(|i| DURATION * i as f64 / (row.samples - 1) as f64).collect();
    let moved = MovingScene {
        mass: 1.0,
        gyration: shape.gyration(),
        orientation: 0.0,
        rate: 0.0,
        gravity: -9.81,
        palm_inertia: [1.0; 2],
        palm_lengths: [f64::INFINITY; 2],
        palms: [Palm::Flat; 2],
        drive: Drive::Prescribed(courses),
        tolerance: DEFAULT_TOLERANCE,
        shape,
    };
    let [least, most] = study.jumps.unwrap_or_default();
    let followed = follow_resting(&moved, &times);
    let Some(truth) = followed
        .ok()
        .filter(|truth| (least..=most).contains(&truth.jumps.len()) && truth.moments.len() == times.len())
    else {
        row.jumped += 1;
        return false;
    };
    // each body has errors of its own
    let measurements =
        measurements_of(&truth, scene.noise, row.resolution, scene.seed.wrapping_add(row.bodies as u64));
    let size = study.size;
    row.bodies += 1;
    let first = &truth.moments[0];
    for (tally, method) in row.thesis.iter_mut().zip(ThesisMethod::ALL) {
        let watch = Stopwatch::begun();
        let thesis = by_thesis(&measurements, first.palms.map(|palm| palm.r), method);
        let seconds = watch.seconds();
        tally.add(track_error(&truth, &thesis.track), size, seconds);
    }
    let watch = Stopwatch::begun();
    let quadrature = by_quadrature(&measurements, first.centre[1]);
    let seconds = watch.seconds();
    row.quadrature.add(track_error(&truth, &quadrature), size, seconds);
    let watch = Stopwatch::begun();
    let found = if study.jumps.is_some() {
        from_segments(&measurements, interrupt)
    } else {
        let least = row.order.map_or(0, |order| order / 2);
        from_nothing_within(&measurements, Orders { least, most: row.order, enough: 0.0 }, interrupt)
    };
    let found = found.map(|found| match row.order {
        None => without_excess(&measurements, found, interrupt),
        Some(_) => found,
    });
    let seconds = watch.seconds();
    let error = found.as_ref().and_then(|found| track_error(&truth, &found.track));
    row.together.add(error, size, seconds);
    let outline =
        found.as_ref().map_or(f64::INFINITY, |found| outline_error(&moved.shape, &found.shape.support));
    let explained = found.as_ref().is_some_and(|found| found.explains(EXACT));
    let recovered = outline <= (RECOVERED * size).max(RECOVERED_RESOLUTIONS * row.resolution);
    row.outline.push(outline);
    row.recovered += usize::from(recovered && explained);
    row.silent += usize::from(!recovered && explained);
    if study.jumps.is_some() {
        let tally = row.jumps.entry(truth.jumps.len()).or_default();
        tally.runs += 1;
        if let Some(found) = found.as_ref().filter(|_| explained) {
            tally.explained += 1;
            let (told, happened) = (found_jumps(&measurements, found), rows_after(&truth));
            let is_at = |jump: &FoundJump, row: usize| (jump.within[0]..=jump.within[1]).contains(&row);
            let is_false = |jump: &FoundJump| jump.certain && !happened.iter().any(|row| is_at(jump, *row));
            tally.false_jumps += usize::from(told.iter().any(is_false));
            tally.missed +=
                usize::from(!happened.iter().all(|row| told.iter().any(|jump| is_at(jump, *row))));
        }
        if let Some(found) = found.filter(|_| recovered && explained) {
            tally.recovered += 1;
            let told = found_jumps(&measurements, &found);
            let after: Vec<usize> = told.iter().map(|jump| jump.row).collect();
            tally.located += usize::from(after == rows_after(&truth));
            tally.predicted[0] += told.len();
            tally.predicted[1] += told.iter().filter(|jump| jump.predicted).count();
        }
    }
    true
}

/// The first samples after jumps.
fn rows_after(truth: &Trajectory) -> Vec<usize> {
    let mut rows: Vec<usize> =
        (truth.jumps.iter()).map(|jump| truth.moments.partition_point(|at| at.time < jump.time)).collect();
    rows.dedup();
    rows
}
