//! In how many drawn scenes the state is found without a first guess, and how long that takes.
//!
//! `cargo bench --bench arrival [-- COUNT [SEED]]`, 1000 scenes without noise and 1000 with noise of a thousandth of the body's size. A state has arrived
//! that is within one percent of the truth in both radii and the rate; the radius of gyration is sought, too. Scenes in which three
//! standard deviations of a bound of Cramer and Rao pass one percent of any of the three do not tell so much. Three bounds say which: that of
//! the methods by windows, of the motion from the true radii, rate and gyration and the first contacts as they are read; that of the constraint
//! at all samples, at the truth; and that of the constraint at what was found, which the estimator tells. Times are the best of three.

mod scenes;

use palmistry::experiment::unguided::{FirstState, PalmMeasurements};
use palmistry::experiment::{Experiment, NoiseStudy, Scene, noise_study};
use palmistry::mechanics::moving::Ended;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

static NEVER: AtomicBool = AtomicBool::new(false);

fn main() {
    let numbers: Vec<u64> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let (count, seed) = (numbers.first().copied().unwrap_or(1000), numbers.get(1).copied().unwrap_or(1));
    println!(
        "noise, of the size   scenes   arrived of those that see by windows, by the constraint at the truth, by what is told   microseconds: median, nine of ten"
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
    let (mut held, mut times, mut missed) = (0, Vec::new(), Vec::new());
    // that see, and have arrived: by the windows' bound, by the constraint's at the truth, by the one that is told
    let mut counts = [[0; 2]; 3];
    while held < count {
        let text = scenes::drawn(&mut draws, held % 4, noise, is_circular);
        let Some(drawn) = experiment(&text) else { continue };
        held += 1;
        let truth = drawn.truth_at(0.0).expect("a simulation has a truth");
        let measurements = drawn.palm_measurements().expect("a drawn scene tells all");
        let one = || {
            let begin = Instant::now();
            (measurements.first_state(), begin.elapsed().as_secs_f64())
        };
        // others use the machine, too
        let (found, first) = one();
        times.push((0..2).map(|_| one().1).fold(first, f64::min));
        let near = found.is_some_and(|found| {
            let found = [found.radii[0], found.radii[1], found.rate];
            found.iter().zip(&truth).all(|(found, truth)| (found / truth - 1.0).abs() < 0.01)
        });
        let sees = if noise == 0.0 {
            [true; 3]
        } else {
            let told = |bound: Option<[f64; 3]>| bound.is_some_and(|bound| is_told(&bound, &truth));
            [
                by_windows(&drawn, &truth),
                told(at_truth(&text, &drawn)),
                told(found.map(|found| found.deviations)),
            ]
        };
        for ([seen, arrived], sees) in counts.iter_mut().zip(sees) {
            *seen += usize::from(sees);
            *arrived += usize::from(sees && near);
        }
        if !near && sees.contains(&true) {
            missed.push((held - 1, sees));
        }
    }
    times.sort_by(f64::total_cmp);
    let at = |part: f64| 1e6 * times.get((times.len() as f64 * part) as usize).copied().unwrap_or(f64::NAN);
    let counts = counts.map(|[seen, arrived]| {
        format!(
            "{:<22}",
            format!("{arrived} of {seen}, {:.1} %", 100.0 * arrived as f64 / seen.max(1) as f64)
        )
    });
    println!("{noise:<20} {held:>6}   {}   {:.0}, {:.0}", counts.join("   "), at(0.5), at(0.9));
    println!("missed, and which bound says that it sees: {missed:?}");
}

/// The scene, if it can be simulated and both palms hold the body all the time.
fn experiment(text: &str) -> Option<Experiment> {
    let scene = Scene::parse("drawn.toml", text).expect("a drawn scene is one");
    let experiment = Experiment::new(scene, None).ok()?;
    let completed = *experiment.simulation.as_ref()?.ended() == Ended::Completed;
    completed.then_some(experiment)
}

/// Whether three standard deviations are less than one percent.
fn is_told(bound: &[f64], truth: &[f64]) -> bool {
    bound.iter().zip(truth).all(|(bound, truth)| 3.0 * bound < 0.01 * truth.abs())
}

/// Whether the bound of the methods by windows says that the scene sees.
fn by_windows(experiment: &Experiment, truth: &[f64]) -> bool {
    let study = NoiseStudy { levels: vec![experiment.scene.sensor.noise], seeds: 0 };
    let Some(simulation) = &experiment.simulation else { return false };
    let levels = noise_study(experiment, simulation, &study, &NEVER, &|| ()).unwrap_or_default();
    levels.first().is_some_and(|level| is_told(&level.bounds[..3], truth))
}

/// The bound of the constraint at the truth, of the motion as it is without errors.
fn at_truth(text: &str, noisy: &Experiment) -> Option<[f64; 3]> {
    let (start, end) = (text.find("[sensor]")?, text.find("[observer]")?);
    let exact = experiment(&format!("{}{}", &text[..start], &text[end..]))?;
    let measurements =
        PalmMeasurements { sigma: noisy.palm_measurements().ok()?.sigma, ..exact.palm_measurements().ok()? };
    let simulation = exact.simulation.as_ref()?;
    let moment = simulation.trajectory.moments[0];
    measurements.bound_at(&FirstState {
        radii: moment.palms.map(|palm| palm.r),
        rate: moment.omega0,
        gyration: simulation.constants["rho"],
        centre: moment.centre,
        velocity: moment.velocity,
        receding: [0.0; 2],
        deviations: [0.0; 3],
        rms_residual: 0.0,
    })
}
