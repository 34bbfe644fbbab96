//! In how many drawn scenes the state is found without a first guess, and how long that takes.
//!
//! `cargo bench --bench arrival [-- COUNT [SEED]]`, 1000 scenes without noise and 1000 with noise of a thousandth of the body's size. A state has arrived
//! that is within one percent of the truth in both radii and the rate; the radius of gyration is sought, too. Scenes in which three
//! standard deviations of the bound of Cramer and Rao, at the truth and for this noise, pass one percent of any of the three are counted
//! apart: they do not tell so much. That bound is one of the motion's derivatives, which are without end where a palm and the body come to
//! turn at one rate; so the table also counts those of the others in which the bound of the guess-free state itself says that it sees.

mod scenes;

use palmistry::experiment::{Experiment, NoiseStudy, Scene, noise_study};
use palmistry::mechanics::moving::Ended;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

static NEVER: AtomicBool = AtomicBool::new(false);

fn main() {
    let numbers: Vec<u64> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let (count, seed) = (numbers.first().copied().unwrap_or(1000), numbers.get(1).copied().unwrap_or(1));
    println!(
        "noise, of the size   scenes   blind   arrived of those that see   of those by its own bound   microseconds: median, nine of ten"
    );
    for is_circular in [false, true] {
        println!("{} palms", if is_circular { "circular" } else { "flat" });
        for noise in [0.0, 1e-3] {
            row(noise, count as usize, seed, is_circular);
        }
    }
}

fn row(noise: f64, count: usize, seed: u64, is_circular: bool) {
    let mut draws = scenes::Draws::new(seed);
    let (mut held, mut blind, mut arrived, mut times, mut missed) = (0, 0, 0, Vec::new(), Vec::new());
    let (mut own, mut own_arrived) = (0, 0);
    while held < count {
        let text = scenes::drawn(&mut draws, held % 4, noise, is_circular);
        let Some(experiment) = experiment(&text) else { continue };
        held += 1;
        let truth = experiment.truth_at(0.0).expect("a simulation has a truth");
        let is_blind = noise > 0.0 && !sees(&experiment, &truth);
        if is_blind {
            blind += 1;
            continue;
        }
        let readings = experiment.palm_readings().expect("a drawn scene tells all");
        let begin = Instant::now();
        let found = readings.first_state();
        times.push(begin.elapsed().as_secs_f64());
        let near = found.is_some_and(|found| {
            let found = [found.radii[0], found.radii[1], found.rate];
            found.iter().zip(&truth).all(|(found, truth)| (found / truth - 1.0).abs() < 0.01)
        });
        arrived += usize::from(near);
        let sees = found.is_some_and(|found| {
            found.deviations.iter().zip(&truth).all(|(deviation, truth)| 3.0 * deviation < 0.01 * truth.abs())
        });
        own += usize::from(sees);
        own_arrived += usize::from(sees && near);
        if !near {
            missed.push(held - 1);
        }
    }
    times.sort_by(f64::total_cmp);
    let at = |part: f64| 1e6 * times.get((times.len() as f64 * part) as usize).copied().unwrap_or(f64::NAN);
    let seen = held - blind;
    println!(
        "{noise:<20} {held:>6}   {blind:>5}   {arrived} of {seen}, {:.1} %   {own_arrived} of {own}, {:.1} %   {:.0}, {:.0}",
        100.0 * arrived as f64 / seen.max(1) as f64,
        100.0 * own_arrived as f64 / own.max(1) as f64,
        at(0.5),
        at(0.9)
    );
    println!("missed: {missed:?}");
}

/// The scene, if it can be simulated and both palms hold the body all the time.
fn experiment(text: &str) -> Option<Experiment> {
    let scene = Scene::parse("drawn.toml", text).expect("a drawn scene is one");
    let experiment = Experiment::new(scene, None).ok()?;
    let completed = *experiment.simulation.as_ref()?.ended() == Ended::Completed;
    completed.then_some(experiment)
}

/// Whether the bound at the truth lets radii and rate be told to one percent.
fn sees(experiment: &Experiment, truth: &[f64]) -> bool {
    let study = NoiseStudy { levels: vec![experiment.scene.sensor.noise], seeds: 0 };
    let Some(simulation) = &experiment.simulation else { return false };
    let levels = noise_study(experiment, simulation, &study, &NEVER, &|| ()).unwrap_or_default();
    let Some(level) = levels.first() else { return false };
    level.bounds.iter().zip(truth).take(3).all(|(bound, truth)| 3.0 * bound < 0.01 * truth.abs())
}
