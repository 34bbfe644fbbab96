//! Random scenes in space, on which searches without a guess are tested.

use nalgebra::Vector3;
use palmistry_bodies::mechanics::moving::{Course, Oscillation};
use palmistry_bodies::mechanics::spatial::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

struct Draws(ChaCha8Rng);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn vector(&mut self, most: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-most, most))
    }
}

/// A body of one of three kinds on palms at rest, at constant rates or swinging, laid in balance and set turning.
fn drawn(draws: &mut Draws, kind: usize) -> Option<SpatialScene> {
    let axes = std::array::from_fn(|_| draws.between(1.0, 2.5));
    let ellipsoid = SolidForm::Ellipsoid { semi_axes: axes };
    let harmonic = |powers, coefficient| Harmonic { powers, coefficient };
    let terms = vec![
        harmonic([2, 0, 0], draws.between(-0.15, 0.15)),
        harmonic([0, 3, 0], draws.between(-0.05, 0.05)),
        harmonic([1, 1, 1], draws.between(-0.06, 0.06)),
        harmonic([0, 1, 2], draws.between(-0.05, 0.05)),
    ];
    let form = match kind % 3 {
        0 => ellipsoid,
        1 => SolidForm::Harmonics { mean: draws.between(1.2, 1.8), terms },
        _ => SolidForm::Blend(vec![(0.6, ellipsoid), (0.4, SolidForm::Harmonics { mean: 1.4, terms })]),
    };
    let solid = ConvexSolid::new(form, None).ok()?;
    let palms = [0.0, 1.0, 2.0].map(|k| SpatialPalm {
        azimuth: k * TAU / 3.0 + draws.between(-0.2, 0.2),
        inertia: 0.5,
        ..SpatialPalm::default()
    });
    let way = (kind / 3) % 3;
    let courses = [(); 3].map(|()| {
        let rate = if way == 1 { draws.between(-0.1, 0.1) } else { 0.0 };
        let swing = Oscillation {
            amplitude: 0.05,
            frequency: draws.between(0.4, 0.9),
            phase: draws.between(0.0, 6.0),
        };
        Course {
            start: draws.between(0.9, 1.15),
            rate,
            swings: if way == 2 { vec![swing] } else { Vec::new() },
        }
    });
    let mut scene = SpatialScene {
        mass: draws.between(0.5, 2.0),
        inertia_over_mass: solid.uniform_inertia(),
        solid,
        orientation: Orientation::by(&Vector3::from(draws.vector(1.5))),
        rate: [0.0; 3],
        gravity: [0.0, 0.0, -9.81],
        palms,
        drive: SpatialDrive::Prescribed(courses),
        tolerance: 1e-13,
    };
    scene.orientation = balanced_orientation(&scene).ok()??;
    scene.rate = draws.vector(0.5);
    Some(scene)
}

/// This many scenes of one seed in which all palms hold the body for a duration in s, with the moments at so many samples. Bodies are
/// of three kinds by turns (ellipsoids, harmonics, blends) of about 1 to 2.5 m, on palms that by turns are at rest, turn at constant rates, swing.
pub fn drawn_scenes(
    seed: u64,
    count: usize,
    samples: usize,
    duration: f64,
) -> Vec<(SpatialScene, Vec<SpatialMoment>)> {
    let mut draws = Draws(ChaCha8Rng::seed_from_u64(seed));
    let times: Vec<f64> = (0..samples).map(|k| duration * k as f64 / (samples - 1) as f64).collect();
    let mut held = Vec::new();
    while held.len() < count {
        let Some(scene) = drawn(&mut draws, held.len()) else { continue };
        let Ok(found) = simulate_solid(&scene, &times) else { continue };
        if found.ended == SpatialEnded::Completed {
            held.push((scene, found.moments));
        }
    }
    held
}

/// The true state of the body at a moment, in the order of [`SolidState::entries`](crate::solid::SolidState::entries): centre, velocity, rate, inertia over mass, 1/m.
pub fn true_entries(scene: &SpatialScene, moment: &SpatialMoment) -> [f64; 16] {
    let turn = moment.orientation.matrix();
    let j = turn * scene.inertia_over_mass * turn.transpose();
    const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    std::array::from_fn(|i| match i {
        0..3 => moment.centre[i],
        3..6 => moment.velocity[i - 3],
        6..9 => moment.rate[i - 6],
        9..15 => j[PLACES[i - 9]],
        _ => 1.0 / scene.mass,
    })
}

/// The largest error of centre, rate, inertia and 1/m, each relative to the size of its group.
pub fn relative_error(found: &[f64; 16], truth: &[f64; 16]) -> f64 {
    let group = |range: std::ops::Range<usize>| {
        let size = truth[range.clone()].iter().map(|v| v * v).sum::<f64>().sqrt();
        let error = range.map(|i| (found[i] - truth[i]).powi(2)).sum::<f64>().sqrt();
        error / size
    };
    [group(0..3), group(6..9), group(9..15), group(15..16)].into_iter().fold(0.0, f64::max)
}
