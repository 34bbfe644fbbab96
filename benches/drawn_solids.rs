//! How often a body in space is recovered from measurements alone: so many drawn scenes of 1.76 s, with noise of the contacts in m or without. With
//! `cargo bench --bench drawn_solids -- 100 177 6 1e-3`, a count, samples, a seed and the noise (0 unless given), it prints a line a scene (what is left of a contact, the greatest relative error of centre, rate, inertia and mass,
//! the greatest error of all 16 numbers in deviations by the bound that is told) and the counts.
//!
//! Without noise a scene arrives that fits and is right to 1e-5, with noise one that fits and is within five deviations. One that is told to fit, and not, is silent: of those there should be none.

use palmistry::experiment::space::{
    SpaceMeasurements, SpaceSensor, drawn_scenes, relative_error, true_entries,
};
use std::time::Instant;

/// Where few samples follow on each other, the rule of integration leaves errors of some millionths in what is nearly blind.
const ARRIVED: f64 = 1e-5;
const DEVIATIONS: f64 = 5.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // cargo adds one of its own
    let asked: Vec<String> = std::env::args().skip(1).filter(|text| !text.starts_with("--")).collect();
    let whole = |place: usize, other: usize| asked.get(place).map_or(Ok(other), |text| text.parse());
    let (count, samples, seed) = (whole(0, 100)?, whole(1, 177)?, whole(2, 5)? as u64);
    let noise: f64 = asked.get(3).map_or(Ok(0.0), |text| text.parse())?;
    let sensor = SpaceSensor { noise, ..SpaceSensor::default() };
    let [mut arrived, mut exact, mut lost, mut unfit, mut blind, mut ambiguous, mut silent] = [0; 7];
    for (place, (scene, moments)) in drawn_scenes(seed, count, samples, 1.76).iter().enumerate() {
        let measurements =
            SpaceMeasurements::of(moments, &sensor, 1).solid(&scene.palms, scene.gravity, &sensor);
        let begin = Instant::now();
        let found = measurements.first_state();
        let seconds = begin.elapsed().as_secs_f64();
        let Some(state) = found else {
            println!("{place}: lost, {seconds:.1} s");
            lost += 1;
            continue;
        };
        let truth = true_entries(scene, &moments[0]);
        let error = relative_error(&state.entries(), &truth);
        let off = (state.entries().iter().zip(truth).zip(state.deviations()))
            .map(|((found, truth), deviation)| ((found - truth) / deviation).abs())
            .fold(0.0, f64::max);
        let is_right = if noise > 0.0 { off <= DEVIATIONS } else { error < ARRIVED };
        let (word, sum) = match (state.fits(), state.is_unobservable(), state.rival, is_right) {
            (false, ..) => ("does not fit", &mut unfit),
            (_, true, ..) => ("blind", &mut blind),
            (_, _, Some(_), _) => ("ambiguous", &mut ambiguous),
            (_, _, _, true) => ("fits", &mut arrived),
            _ => ("fits, SILENT", &mut silent),
        };
        *sum += 1;
        exact += usize::from(word == "fits" && error < 1e-8);
        println!(
            "{place}: {word}, error {error:.1e}, {off:.1} deviations, residual {:.1e} m, chi-square {:.1e} of {}, ratio {:.3}, {:.2} left, {seconds:.1} s",
            state.rms_residual, state.chi_square, state.degrees, state.ratio, state.curved
        );
    }
    println!(
        "{arrived} of {count} arrive, {exact} of them to 1e-8; {lost} lost, {unfit} do not fit, {blind} blind, {ambiguous} ambiguous; {silent} fail and do not say so"
    );
    Ok(())
}
