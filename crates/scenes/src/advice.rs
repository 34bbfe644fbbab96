//! Advice before an experiment: how palms may move so that they touch as many normals of a body as they can, and hold it all the time.
//!
//! Courses are drawn at random within limits, moved by Newton's laws as any scene is, and the best are varied, less and less. Of those that touch most, windows of their
//! measurements are compared by the Cramér-Rao bound of the state at the truth, and the best is advised. Each course has a random stream of its own: the
//! answer depends on the seed alone, not on the number of threads. It is the best that the search found; nothing proves that there is no better one.

use super::run::Experiment;
use super::scene::{Guess, Method, Scene, SceneError, Simulated, Study};
use super::simulation::Simulation;
use palmistry_bodies::mechanics::moving::{Course, Drive, Ended, Moment, Oscillation};
use palmistry_bodies::shape::Coverage;
use palmistry_observe::WindowSearch;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::atomic::{AtomicBool, Ordering};

/// This many courses are varied.
const PARENTS: usize = 8;

/// This many are tried before the best are chosen anew.
const BATCH: usize = 32;

/// Of those that touch nearly as much as the best, this many are compared by the Cramér-Rao bounds of their measurements.
const FINALISTS: usize = 6;

/// Coverage within this fraction of all normals below the best counts as equal.
const AS_MUCH: f64 = 0.01;

/// Numbers of a course are multiples of this, in rad, Hz and s, so that the printed course is the one that was tried.
const STEP: f64 = 1e-3;

/// Limits of the palms' motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdviceLimits {
    /// The least and the greatest angle of each palm, in rad; palm 2 is measured from palm 1.
    pub angles: [[f64; 2]; 2],
    /// The greatest rate of either palm, in rad/s.
    pub rate: f64,
}

/// The question: limits, number of trials, seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdviceQuestion {
    /// Limits of the palms' motion.
    pub limits: AdviceLimits,
    /// How many courses are tried.
    pub trials: usize,
    /// The seed of the random numbers.
    pub seed: u64,
}

/// A motion that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct TriedMotion {
    /// The courses of both palms.
    pub courses: [Course; 2],
    /// The part of the duration after which it ended, 1 where the body was held to the end; 0 where it could not be held at first.
    pub lasted: f64,
    /// Which normals were touched.
    pub coverage: Coverage,
}

/// The expected Cramér-Rao bounds of windows of the measurements of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedBounds {
    /// How many windows there are.
    pub windows: usize,
    /// In how many of them every estimated state has a bound below `unobservable_above` of its size.
    pub observable_windows: usize,
    /// The Cramér-Rao bound of each state in the median window, in its unit; infinite where it is unobservable in more than half of the windows.
    pub bounds: Vec<(String, f64)>,
    /// The largest ratio of a bound to the size of its state, in the median window.
    pub relative: f64,
    /// The condition number of the sensitivities in the median window.
    pub condition: f64,
}

/// The advice.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// How many courses were tried.
    pub tried: usize,
    /// How many of them held the body to the end.
    pub held: usize,
    /// The scene's own motion, where its palms are prescribed.
    pub own: Option<TriedMotion>,
    /// The best motion; none where the body was held in none.
    pub best: Option<TriedMotion>,
    /// The expected bounds of its measurements; none where the scene's model does not fit such a motion.
    pub expected: Option<ExpectedBounds>,
}

impl TriedMotion {
    /// The score: normals touched, reduced where the body is not held.
    fn worth(&self) -> f64 {
        let touched = self.coverage.fraction();
        if self.is_held() { 1.0 + touched } else { touched * self.lasted }
    }

    /// Whether the body was held to the end.
    pub fn is_held(&self) -> bool {
        self.lasted >= 1.0
    }
}

/// Seeks courses of the palms of a scene that touch all normals of its body; `done` is called after each trial.
///
/// # Errors
/// Where the scene describes no body between palms, or one that cannot be simulated, with the place in the scene.
pub fn advise(
    scene: &Scene,
    question: &AdviceQuestion,
    interrupt: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<Advice, SceneError> {
    let Some(simulated) = &scene.simulated else {
        let help = "advice is for a simulated body: give [body] and [palms]";
        return Err(scene.error_at("model", "the scene has no body", "no body beside this", help));
    };
    let own = match &simulated.palms.drive {
        Drive::Prescribed(courses) => Some(tried(scene, simulated, courses)),
        Drive::Torques(_) => None,
    };
    let duration = simulated.duration;
    let mut best: Vec<TriedMotion> = Vec::new();
    let (mut count, mut held) = (0, 0);
    while count < question.trials && !interrupt.load(Ordering::Relaxed) {
        let batch = BATCH.min(question.trials - count);
        let is_random = count < question.trials / 2 || best.is_empty();
        // the later the less is changed
        let spread = 0.5 * (1.0 - count as f64 / question.trials as f64);
        let one = |i: usize| {
            let mut random = ChaCha8Rng::seed_from_u64(question.seed);
            random.set_stream((count + i) as u64);
            let courses = [0, 1].map(|palm| {
                let limits = (question.limits.angles[palm], question.limits.rate);
                match is_random {
                    true => drawn(&mut random, limits, duration),
                    false => {
                        varied(&mut random, &best[i % best.len()].courses[palm], spread, limits, duration)
                    }
                }
            });
            let motion = tried(scene, simulated, &courses);
            done();
            motion
        };
        let found: Vec<TriedMotion> = (0..batch).into_par_iter().map(one).collect();
        held += found.iter().filter(|motion| motion.is_held()).count();
        best.extend(found);
        // stable: the earlier of two that are as good stays before the other
        best.sort_by(|a, b| b.worth().total_cmp(&a.worth()));
        best.truncate(PARENTS);
        count += batch;
    }
    best.retain(|motion| motion.lasted > 0.0);
    let (best, expected) = chosen(scene, best);
    Ok(Advice { tried: count, held, own, best, expected })
}

/// Of those that touch as much as the best, the one with the smallest Cramér-Rao bounds.
fn chosen(scene: &Scene, mut best: Vec<TriedMotion>) -> (Option<TriedMotion>, Option<ExpectedBounds>) {
    let Some(most) = best.first().map(TriedMotion::worth) else { return (None, None) };
    best.retain(|motion| motion.worth() >= most - AS_MUCH);
    best.truncate(FINALISTS);
    let expected: Vec<Option<ExpectedBounds>> =
        best.par_iter().map(|motion| expected(scene, &motion.courses)).collect();
    let all = best.into_iter().zip(expected);
    let worst = |expected: &Option<ExpectedBounds>| match expected {
        Some(expected) => expected.relative,
        None => f64::INFINITY,
    };
    let least = all.reduce(|best, next| if worst(&next.1) < worst(&best.1) { next } else { best });
    least.map_or((None, None), |(motion, expected)| (Some(motion), expected))
}

/// A scene whose palms move otherwise.
fn with_courses(scene: &Scene, simulated: &Simulated, courses: &[Course; 2]) -> (Scene, Simulated) {
    let mut simulated = simulated.clone();
    simulated.palms.drive = Drive::Prescribed(courses.clone());
    let mut scene = scene.clone();
    scene.simulated = Some(simulated.clone());
    scene.study = Study::default();
    scene.observer.guess = Guess::Off(0.0);
    scene.observer.methods = vec![Method::TrustRegion];
    (scene, simulated)
}

fn tried(scene: &Scene, simulated: &Simulated, courses: &[Course; 2]) -> TriedMotion {
    let (scene, simulated) = with_courses(scene, simulated, courses);
    let nothing = TriedMotion { courses: courses.clone(), lasted: 0.0, coverage: Coverage::default() };
    let Ok(simulation) = Simulation::of(&scene, &simulated) else { return nothing };
    let moments = &simulation.trajectory.moments;
    let Some(last) = moments.last() else { return nothing };
    let lasted = match simulation.ended() {
        Ended::Completed => 1.0,
        _ => (last.time / simulated.duration).min(1.0 - f64::EPSILON),
    };
    let normals =
        |palm: usize| -> Vec<f64> { moments.iter().map(|moment| normal(&scene, moment, palm)).collect() };
    let paths = [normals(0), normals(1)];
    TriedMotion { coverage: Coverage::of_paths(paths.iter().map(Vec::as_slice)), lasted, ..nothing }
}

/// The outward normal at which a palm touches a body, in the body's frame, in rad.
fn normal(scene: &Scene, moment: &Moment, palm: usize) -> f64 {
    let side = if palm == 0 { 1.0 } else { -1.0 };
    let [first, second] = &moment.palms;
    let angle = if palm == 0 { first.angle } else { first.angle + second.angle };
    let tangent = angle + side * scene.palm_forms[palm].at(&moment.palms[palm].s).turned;
    tangent - side * FRAC_PI_2 - moment.phi0
}

/// The expected Cramér-Rao bounds of windows of the measurements of a motion, at the truth.
fn expected(scene: &Scene, courses: &[Course; 2]) -> Option<ExpectedBounds> {
    let (scene, _) = with_courses(scene, scene.simulated.as_ref()?, courses);
    let experiment = Experiment::new(scene, None).ok()?;
    let never = AtomicBool::new(false);
    let task = experiment.task(&never).ok()?;
    let observer = experiment.window(WindowSearch::TrustRegion);
    let times = experiment.signals.times();
    let names = experiment.names();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let (mut conditions, mut relative, mut seen) = (Vec::new(), Vec::new(), 0);
    let mut row = 0;
    while row + observer.window < times.len() {
        let rows = row..row + observer.window + 1;
        let truth = experiment.truth_at(times[row])?;
        let (bounds, condition) = observer.bounds_and_condition(&task, &truth, &rows, &[]);
        let ratios = bounds.iter().zip(&task.sizes).map(|(bound, size)| bound / size);
        let largest = ratios.fold(0.0, f64::max);
        seen += usize::from(largest <= observer.unobservable_above);
        relative.push(largest);
        columns.iter_mut().zip(&bounds).for_each(|(column, bound)| column.push(*bound));
        conditions.push(condition);
        row += observer.window;
    }
    let windows = conditions.len();
    if windows == 0 {
        return None;
    }
    let bounds = names.iter().zip(columns).map(|(name, column)| ((*name).to_owned(), median(column)));
    let (relative, condition) = (median(relative), median(conditions));
    Some(ExpectedBounds { windows, observable_windows: seen, bounds: bounds.collect(), relative, condition })
}

/// The middle one, the upper of two.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

type PalmLimits = ([f64; 2], f64);

/// A course at random: a rate and one swing.
fn drawn(random: &mut ChaCha8Rng, limits: PalmLimits, duration: f64) -> Course {
    let ([low, high], rate) = limits;
    let mut part = || random.random::<f64>();
    let start = low + part() * (high - low);
    let steady = (2.0 * part() - 1.0) * rate.min((high - low) / duration);
    let amplitude = part() * (high - low) / 2.0;
    // from half a period to four of them, evenly in their logarithm
    let frequency = 0.5 / duration * 8f64.powf(part());
    let phase = part() * TAU;
    let swings = vec![Oscillation { amplitude, frequency, phase }];
    within(Course { start, rate: steady, swings }, limits, duration)
}

/// A course near another one.
fn varied(
    random: &mut ChaCha8Rng,
    course: &Course,
    spread: f64,
    limits: PalmLimits,
    duration: f64,
) -> Course {
    let ([low, high], rate) = limits;
    let mut change = |size: f64| spread * size * (2.0 * random.random::<f64>() - 1.0);
    let start = (course.start + change(high - low)).clamp(low, high);
    let steady = course.rate + change(rate.min((high - low) / duration));
    let swing = |swing: &Oscillation| Oscillation {
        amplitude: (swing.amplitude + change((high - low) / 2.0)).abs(),
        frequency: (swing.frequency + change(1.0 / duration)).abs(),
        phase: (swing.phase + change(TAU / 2.0)).rem_euclid(TAU),
    };
    let swings = course.swings.iter().map(swing).collect();
    within(Course { start, rate: steady, swings }, limits, duration)
}

/// A course that keeps its limits, in round numbers: as much less rate and swing as it takes.
fn within(mut course: Course, ([low, high], rate): PalmLimits, duration: f64) -> Course {
    const LOOKS: usize = 400;
    let round = |value: f64| (value / STEP).round() * STEP;
    course.start = round(course.start).clamp(low, high);
    loop {
        course.rate = round(course.rate);
        for swing in &mut course.swings {
            *swing = Oscillation {
                amplitude: round(swing.amplitude),
                frequency: round(swing.frequency),
                phase: round(swing.phase),
            };
        }
        let keeps = (0..=LOOKS).all(|i| {
            let [angle, turning, _] = course.at(duration * i as f64 / LOOKS as f64);
            (low..=high).contains(&angle) && turning.abs() <= rate
        });
        if keeps || (course.rate == 0.0 && course.swings.iter().all(|swing| swing.amplitude == 0.0)) {
            return course;
        }
        // four fifths of two steps are rounded to two again
        let less = |value: f64| if value.abs() < 2.5 * STEP { 0.0 } else { 0.8 * value };
        course.rate = less(course.rate);
        for swing in &mut course.swings {
            swing.amplitude = less(swing.amplitude);
        }
    }
}
