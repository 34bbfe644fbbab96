//! The thesis's own search beside ours on figure 5.3's scene, with and without noise of a millimetre: `cargo bench --bench two_stages -- 40 5000`, seeds and draws. It is told rate, inertia and mass.

use palmistry::experiment::solid::{KnownSolid, SolidMeasurements};
use palmistry::experiment::space::{SpaceExperiment, SpaceScene, SpaceTruth};
use std::time::Instant;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002/scenes/figure_5_3.toml");

/// A centre or an inertia over mass nearer than this, in m or m^2, has arrived.
const ARRIVED: f64 = 1e-6;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Errors of centre and inertia over mass, by one method and from one seed.
fn errors(
    truth: &SpaceTruth,
    measurements: &SolidMeasurements,
    draws: Option<usize>,
    seed: u64,
) -> Option<[f64; 2]> {
    let first = &truth.trajectory.moments[0];
    let turn = first.orientation.matrix();
    let inertia = turn * truth.scene.inertia_over_mass * turn.transpose();
    let known = KnownSolid {
        rate: first.rate,
        inertia_over_mass: truth.scene.inertia_over_mass,
        mass: truth.scene.mass,
        radii: [0.5, 3.0],
    };
    let (centre, found) = match draws {
        Some(draws) => {
            measurements.two_stages(&known, draws, seed).map(|end| (end.centre, end.inertia_over_mass))?
        }
        None => measurements.first_state().map(|state| (state.centre, state.inertia_over_mass))?,
    };
    Some([(centre - first.centre).norm(), (found - inertia).norm()])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // cargo adds one of its own
    let mut asked = std::env::args().skip(1).filter(|text| !text.starts_with("--"));
    let mut next = |other: usize| asked.next().map_or(Ok(other), |text| text.parse());
    let (seeds, draws) = (next(40)?, next(5000)?);
    let text = std::fs::read_to_string(FILE)?;
    for noise in [0.0, 1e-3] {
        for own in [Some(draws), None] {
            let begin = Instant::now();
            let mut ends = Vec::new();
            for seed in 1..=seeds as u64 {
                let mut scene = SpaceScene::parse(FILE, &text)?;
                (scene.sensor.noise, scene.seed) = (noise, seed);
                let found = SpaceExperiment::new(scene, None)?;
                let truth = found.truth.as_ref().ok_or("nothing is simulated")?;
                ends.extend(errors(truth, &found.solid(), own, seed));
            }
            let arrived = ends.iter().filter(|[centre, _]| *centre < ARRIVED).count();
            let of = |i: usize| median(ends.iter().map(|end| end[i]).collect());
            println!(
                "noise {noise} m, {}: {} of {seeds} end, {arrived} arrive; median {:.1e} m, {:.1e} m^2; {:.2} s each",
                if own.is_some() { "two stages" } else { "ours" },
                ends.len(),
                of(0),
                of(1),
                begin.elapsed().as_secs_f64() / seeds as f64
            );
        }
    }
    Ok(())
}
