//! Whether bounds hold where any column errs, and what a whole record tells of a torque's gain.
//!
//! `cargo bench --bench channels [-- SEEDS] [WORDS]`, 200 and all unless given; words are columns, `read` or `exact` contacts, and `gain`. For each regime of the thesis and each column the root of the mean square error of each state
//! that is sought over its bound, in the first window; then the gain of motor 1, read one percent too large, sought over the whole record.

use palmistry::experiment::{Experiment, NoiseStudy, Scene, noise_study};
use palmistry::observer::{MovingWindow, WindowSearch};
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

const REGIMES: [&str; 4] = ["same_rate", "one_palm_fixed", "fixed_palms", "general"];

/// Columns with a noise that is usual for them: contacts in m, angles in rad, rates in rad/s, accelerations in rad/s^2, torques in N m.
const COLUMNS: [(&str, f64); 10] = [
    ("s1", 1e-4),
    ("s2", 1e-4),
    ("phi1", 1e-4),
    ("phi2", 1e-4),
    ("omega1", 1e-3),
    ("omega2", 1e-3),
    ("alpha1", 1e-2),
    ("alpha2", 1e-2),
    ("tau1", 1e-2),
    ("tau2", 1e-2),
];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let seeds = words.iter().find_map(|word| word.parse().ok()).unwrap_or(200);
    let words: Vec<&str> =
        words.iter().map(String::as_str).filter(|word| word.parse::<usize>().is_err()).collect();
    let is_asked = |word: &str| words.is_empty() || words.contains(&word);
    println!("contacts   regime           column   noise   converged   residuals error over bound");
    for (word, contacts) in [("read", 1e-5), ("exact", 0.0)] {
        for (column, noise) in COLUMNS.into_iter().filter(|(column, _)| is_asked(column) && is_asked(word)) {
            REGIMES.iter().for_each(|regime| row(contacts, regime, column, noise, seeds));
        }
    }
    if is_asked("gain") {
        println!("\nregime           gain found   error     bound     ends");
        REGIMES.iter().for_each(|regime| gain(regime, seeds.min(10) as u64));
    }
}

fn text(regime: &str) -> String {
    let path = format!("proofs/moll2002/scenes/{regime}.toml");
    let text = std::fs::read_to_string(path).expect("the scenes of the thesis are there");
    let text = text.replace("\"../", "\"proofs/moll2002/");
    text.split("[study.").next().unwrap_or_default().to_owned()
}

fn experiment(text: &str) -> Experiment {
    let scene = Scene::parse("scene.toml", text).unwrap_or_else(|error| panic!("{error}"));
    Experiment::new(scene, None).unwrap_or_else(|error| panic!("{error}"))
}

fn row(contacts: f64, regime: &str, column: &str, noise: f64, seeds: usize) {
    // from where a search begins is no matter here
    let text = text(regime).replace("guess_off = 0.1", "guess_off = 0.01");
    let experiment = experiment(&format!("{text}[sensor.{column}]\nnoise = {noise:e}\n"));
    let simulation = experiment.simulation.as_ref().expect("a scene is simulated");
    let study = NoiseStudy { levels: vec![contacts], seeds };
    match noise_study(&experiment, simulation, &study, &NEVER, &|| ()) {
        Ok(levels) => {
            let level = &levels[0];
            let ratios: Vec<String> =
                level.errors.iter().zip(&level.bounds).map(|(e, b)| format!("{:.2}", e / b)).collect();
            println!(
                "{contacts:<10e} {regime:<16} {column:<8} {noise:<7e} {:>4} of {:<4} {:>4}      {}",
                level.converged,
                level.seeds,
                level.unfit,
                ratios.join(" ")
            );
        }
        Err(error) => println!("{regime} {column}: {error}"),
    }
}

fn gain(regime: &str, seeds: u64) {
    let text = text(regime)
        .replace("\"omega0\"", "\"omega0\", \"tau1.gain\"")
        .replace("guess_off = 0.1", "guess_off = 0.01")
        .replace("window = 80", "window = 400");
    let mut errors = Vec::new();
    let mut bound = f64::NAN;
    let mut ends = Vec::new();
    for seed in 1..=seeds {
        let text = format!("seed = {seed}\n{text}[sensor]\nnoise = 1e-5\n[sensor.tau1]\ngain = 1.01\n");
        let experiment = experiment(&text);
        let task = experiment.task(&NEVER).unwrap_or_else(|error| panic!("{error}"));
        let observer = MovingWindow { steps: 100, ..experiment.window(WindowSearch::TrustRegion) };
        let update = observer.update(&task, &task.guess, &(0..task.signals.times().len()), &[]);
        let place = experiment.names().iter().position(|name| *name == "tau1.gain").expect("it is sought");
        errors.push(update.estimate[place] - 1.01);
        bound = update.deviations[place];
        ends.push(format!("{:?}", update.end).chars().take(12).collect::<String>());
    }
    ends.sort();
    ends.dedup();
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    let last = 1.01 + errors.last().copied().unwrap_or(f64::NAN);
    println!("{regime:<16} {last:.7}    {rms:.1e}   {bound:.1e}   {}", ends.join(", "));
}
