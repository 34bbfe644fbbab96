//! A scene in ten lines: what is sought of an oscillator, each with its bound, whether it fits the measurements, and where it goes from there. With
//! `cargo run --example van_der_pol`:
//!
//! ```text
//! x = 1.20 within 0.003, true 1.20
//! y = -0.51 within 0.004, true -0.50
//! mu = 1.40 within 0.002, true 1.40
//! fits: true
//! 161 samples, at 8.0 s: x = 0.02, y = -2.30
//! ```

use palmistry::experiment::{Experiment, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/systems/van_der_pol.toml");
    let experiment = Experiment::new(Scene::read(file.as_ref())?, None)?;
    let answers = experiment.observe()?;
    let (track, update) = (&answers[0].track, &answers[0].track.updates[0]);
    let truth = experiment.truth_at(update.from).unwrap_or_default();
    for (i, name) in experiment.names().iter().enumerate() {
        println!(
            "{name} = {:.2} within {:.3}, true {:.2}",
            update.estimate[i], update.deviations[i], truth[i]
        );
    }
    println!("fits: {}", update.is_borne_out());
    let last = track.last().ok_or("nothing was believed")?;
    println!(
        "{} samples, at {:.1} s: x = {:.2}, y = {:.2}",
        track.estimates.len(),
        last.time,
        last.state[0],
        last.state[1]
    );
    Ok(())
}
