//! How often a body in space is recovered from readings alone: so many drawn scenes of 1.76 s, without noise. With
//! `cargo bench --bench drawn_solids -- 100 177 6`, the last a seed, it prints a line a scene (what is left of a contact, the greatest relative error of centre, rate, inertia and mass) and the counts.

use palmistry::experiment::space::{SpaceReadings, SpaceSensor, drawn_scenes, relative_error, true_entries};
use std::time::Instant;

/// Where few samples follow on each other, the rule of integration leaves errors of some millionths in what is nearly blind.
const ARRIVED: f64 = 1e-5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // cargo adds one of its own
    let mut asked = std::env::args().skip(1).filter(|text| !text.starts_with("--"));
    let mut next = |other: usize| asked.next().map_or(Ok(other), |text| text.parse());
    let (count, samples, seed) = (next(100)?, next(177)?, next(5)? as u64);
    let sensor = SpaceSensor::default();
    let [mut arrived, mut exact, mut untold] = [0; 3];
    for (place, (scene, moments)) in drawn_scenes(seed, count, samples, 1.76).iter().enumerate() {
        let readings = SpaceReadings::of(moments, &sensor, 1).solid(&scene.palms, scene.gravity, &sensor);
        let begin = Instant::now();
        let found = readings.first_state();
        let seconds = begin.elapsed().as_secs_f64();
        let Some(state) = found else {
            println!("{place}: lost, {seconds:.1} s");
            continue;
        };
        let error = relative_error(&state.entries(), &true_entries(scene, &moments[0]));
        let word = if state.fits() { "fits" } else { "does not fit" };
        println!(
            "{place}: {word}, error {error:.1e}, misfit {:.1e} m, chi-square {:.1e} of {}, ratio {:.3}, {seconds:.1} s",
            state.misfit, state.chi_square, state.degrees, state.ratio
        );
        arrived += usize::from(state.fits() && error < ARRIVED);
        exact += usize::from(state.fits() && error < 1e-8);
        untold += usize::from(state.fits() && error >= ARRIVED);
    }
    println!("{arrived} of {count} arrive, {exact} of them to 1e-8; {untold} fail and do not say so");
    Ok(())
}
