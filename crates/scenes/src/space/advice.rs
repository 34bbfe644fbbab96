//! Runs that enlarge the certain part of a body in space: how to lay it on the palms and set it turning, so that the hull of all contacts grows as much as a search finds.
//!
//! A run lays the body in the pose of balance to which it falls from an orientation, sets it turning, and lasts as long as the scene. Runs are chosen one after another, each the one that makes
//! the hull of all contacts so far greatest; half of the trials of a run are drawn at random, the others vary the best. The plan is compared with as many of the random
//! runs. Each trial has a random stream of its own: the answer depends on the seed alone, not on the number of threads. It is a search's best, one run at a time; nothing
//! proves that there is no better one.

use super::run::{SpaceTruth, simulated};
use super::scene::SpaceScene;
use palmistry_bodies::mechanics::spatial::SpatialEnded;
use palmistry_bodies::shape::sphere::{OuterBound, SurfaceTouch, contact_hull, half_space_intersection};
use palmistry_lang::ReadError;
use palmistry_math::number::Interval;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

/// This many runs are varied.
const PARENTS: usize = 4;

/// This many are tried before the best are chosen anew.
const BATCH: usize = 8;

/// Orientations and rates are rounded to `1/PARTS` rad and rad/s, so that the printed run is the one that was tried.
const PARTS: f64 = 1e3;

/// The question: runs, trials, greatest rate, seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunsQuestion {
    /// How many runs there are to be.
    pub runs: usize,
    /// How many are tried for each.
    pub trials: usize,
    /// The greatest rate at which a body is set turning, in rad/s.
    pub rate: f64,
    /// The seed of the random numbers.
    pub seed: u64,
}

/// How a body is laid and set turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laying {
    /// From where it falls into balance: the rotation by the length of this vector, in rad, about its direction.
    pub orientation: [f64; 3],
    /// The angular velocity that it is given, in rad/s.
    pub rate: [f64; 3],
}

/// A run of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRun {
    /// Its initial pose and rate.
    pub laying: Laying,
    /// The volume of the hull of all contacts of this run and those before it, in m^3.
    pub hull: Interval,
    /// The volume of the intersection of half-spaces, in m^3; or why none is known: they do not bound it, or a contact cannot be used.
    pub outer: Result<Interval, String>,
    /// Of as many runs drawn at random: the hull's volume in the median and at most, in m^3; none where too few of them held the body.
    pub random: Option<[f64; 2]>,
}

/// The advice.
#[derive(Clone, Debug, PartialEq)]
pub struct RunsAdvice {
    /// How many runs were tried.
    pub tried: usize,
    /// How many of them held the body to the end.
    pub held: usize,
    /// The number of rows of random runs that the plan is compared with.
    pub random_rows: usize,
    /// The runs, in their order; fewer than required where no trial held the body, or it was interrupted.
    pub plan: Vec<PlannedRun>,
    /// The body's own volume, in m^3.
    pub volume: f64,
}

/// A run that held the body to its end.
#[derive(Clone)]
struct Held {
    laying: Laying,
    touches: Vec<SurfaceTouch>,
    /// The volume of the hull with all runs before it.
    worth: f64,
}

/// Seeks runs of a scene's body on its palms, which move as the scene says; `done` is called after each trial.
///
/// # Errors
/// Where the scene describes no body, or one that cannot be simulated on its palms, with the place in the scene.
pub fn advise_runs(
    scene: &SpaceScene,
    question: &RunsQuestion,
    interrupt: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<RunsAdvice, ReadError> {
    if scene.body.is_none() {
        let help = "advice is for a simulated body: give [body] and what moves the palms";
        return Err(scene.error_at("title", "the scene has no body", help));
    }
    let volume = simulated(scene)?.scene.solid.volume();
    let mut advice = RunsAdvice { tried: 0, held: 0, random_rows: 0, plan: Vec::new(), volume };
    let mut touched: Vec<SurfaceTouch> = Vec::new();
    let mut random_runs: Vec<Vec<SurfaceTouch>> = Vec::new();
    for place in 0..question.runs {
        let mut best: Vec<Held> = Vec::new();
        let mut count = 0;
        while count < question.trials && !interrupt.load(Ordering::Relaxed) {
            let batch = BATCH.min(question.trials - count);
            let is_random = count < question.trials / 2 || best.is_empty();
            // the later the less is changed
            let spread = 0.5 * (1.0 - count as f64 / question.trials as f64);
            let one = |i: usize| {
                let mut random = ChaCha8Rng::seed_from_u64(question.seed);
                random.set_stream((place * question.trials + count + i) as u64);
                let laying = match is_random {
                    true => drawn(&mut random, question.rate),
                    false => varied(&mut random, &best[i % best.len()].laying, spread, question.rate),
                };
                let held = tried(scene, laying, &touched);
                done();
                held
            };
            let found: Vec<Option<Held>> = (0..batch).into_par_iter().map(one).collect();
            let found: Vec<Held> = found.into_iter().flatten().collect();
            advice.held += found.len();
            if is_random {
                random_runs.extend(found.iter().map(|run| run.touches.clone()));
            }
            best.extend(found);
            // stable: the earlier of two that are as good stays before the other
            best.sort_by(|a, b| b.worth.total_cmp(&a.worth));
            best.truncate(PARENTS);
            count += batch;
        }
        advice.tried += count;
        let Some(best) = best.into_iter().next() else { break };
        touched.extend(best.touches);
        // contacts in a plane, as those of one body that lies still, have no volume
        let hull = contact_hull(&touched).map_or(Interval::point(0.0), |hull| hull.volume);
        let outer = match half_space_intersection(&touched) {
            Ok(OuterBound::Bounded(region)) => Ok(region.volume),
            Ok(OuterBound::Unbounded { .. }) => Err("unbounded".to_owned()),
            Err(why) => Err(why.to_string()),
        };
        advice.plan.push(PlannedRun { laying: best.laying, hull, outer, random: None });
    }
    held_against(&random_runs, &mut advice);
    Ok(advice)
}

/// Rows of as many random runs as the plan has, and the volumes of their hulls.
fn held_against(random_runs: &[Vec<SurfaceTouch>], advice: &mut RunsAdvice) {
    let length = advice.plan.len().max(1);
    let rows: Vec<Vec<f64>> = random_runs
        .par_chunks_exact(length)
        .map(|row| {
            let mut touched = Vec::new();
            let grown = row.iter().map(|run| {
                touched.extend_from_slice(run);
                volume(&touched)
            });
            grown.collect()
        })
        .collect();
    advice.random_rows = rows.len();
    for (place, run) in advice.plan.iter_mut().enumerate() {
        let mut volumes: Vec<f64> = rows.iter().map(|row| row[place]).collect();
        volumes.sort_by(f64::total_cmp);
        run.random = volumes.last().map(|most| [volumes[volumes.len() / 2], *most]);
    }
}

/// The certain volume of the hull of contacts; zero where they lie in a plane.
fn volume(touches: &[SurfaceTouch]) -> f64 {
    contact_hull(touches).map_or(0.0, |hull| hull.volume.low())
}

/// A run, where it holds the body to its end.
fn tried(scene: &SpaceScene, laying: Laying, before: &[SurfaceTouch]) -> Option<Held> {
    let mut scene = scene.clone();
    let body = scene.body.as_mut()?;
    (body.orientation, body.rate, body.balanced) = (laying.orientation, laying.rate, true);
    let SpaceTruth { trajectory, .. } = simulated(&scene).ok()?;
    if trajectory.ended != SpatialEnded::Completed {
        return None;
    }
    let palms = trajectory.moments.iter().flat_map(|moment| moment.palms);
    let touches: Vec<SurfaceTouch> =
        palms.map(|palm| SurfaceTouch { point: palm.touched, normal: palm.outward.normalize() }).collect();
    let worth = volume(&[before, &touches].concat());
    Some(Held { laying, touches, worth })
}

/// In round numbers, towards zero: so rounding exceeds no limit.
fn told(vector: [f64; 3]) -> [f64; 3] {
    vector.map(|x| (x * PARTS).trunc() / PARTS)
}

/// A vector of at most this length, in round numbers; evenly in the ball.
fn vector(random: &mut ChaCha8Rng, most: f64) -> [f64; 3] {
    loop {
        let place: [f64; 3] = std::array::from_fn(|_| 2.0 * random.random::<f64>() - 1.0);
        if place.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
            return told(place.map(|x| most * x));
        }
    }
}

fn drawn(random: &mut ChaCha8Rng, rate: f64) -> Laying {
    Laying { orientation: vector(random, PI), rate: vector(random, rate) }
}

/// A laying near another one.
fn varied(random: &mut ChaCha8Rng, laying: &Laying, spread: f64, rate: f64) -> Laying {
    let near = |at: [f64; 3], by: [f64; 3], most: f64| {
        let moved: [f64; 3] = std::array::from_fn(|i| at[i] + by[i]);
        let length = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
        let shrink = if length > most { most / length } else { 1.0 };
        told(moved.map(|x| shrink * x))
    };
    Laying {
        orientation: near(laying.orientation, vector(random, spread * PI), PI),
        rate: near(laying.rate, vector(random, spread * rate), rate),
    }
}
