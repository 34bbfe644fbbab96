//! Readings with errors: as good as they can be, and the same on any number of threads.

use crate::observe::{NEVER, experiment, text};
use palmistry::experiment::{NoiseLevel, NoiseStudy, noise_study};

const SEEDS: usize = 60;

fn study(threads: usize) -> Vec<NoiseLevel> {
    let experiment = experiment(&text("same_rate"));
    let simulation = experiment.simulation.as_ref().unwrap();
    let settings = NoiseStudy { levels: vec![1e-4], seeds: SEEDS };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| noise_study(&experiment, simulation, &settings, &NEVER, &|| ()).unwrap())
}

/// Least squares with independent normal errors reach the bound of Cramér and Rao where the errors are small. The mean square
/// of N normal errors has the relative standard deviation sqrt(2/N), its root half of that, 1/sqrt(2N); four of them are
/// passed by chance once in some ten thousand.
#[test]
fn the_error_is_the_bound_of_cramer_and_rao_on_any_number_of_threads() {
    let levels = study(1);
    let [level] = &levels[..] else { panic!("{levels:?}") };
    assert_eq!((level.noise, level.seeds, level.converged), (1e-4, SEEDS, SEEDS));
    let spread = 4.0 / (2.0 * SEEDS as f64).sqrt();
    assert_eq!((level.errors.len(), level.bounds.len()), (3, 3));
    for (error, bound) in level.errors.iter().zip(&level.bounds) {
        assert!(bound.is_finite() && *bound > 0.0, "{bound}");
        assert!((error / bound - 1.0).abs() < spread, "{error:e} for {bound:e}");
    }
    assert_eq!(levels, study(2));
}

/// The bound grows with the noise, in proportion; so do the errors, the same errors at another size, while they are small.
#[test]
fn errors_grow_with_the_noise_as_the_bound_does() {
    let experiment = experiment(&text("same_rate"));
    let simulation = experiment.simulation.as_ref().unwrap();
    // one level a study: within a study every level has errors of its own
    let level = |noise: f64| {
        let settings = NoiseStudy { levels: vec![noise], seeds: 8 };
        noise_study(&experiment, simulation, &settings, &NEVER, &|| ()).unwrap().remove(0)
    };
    let levels = [level(1e-7), level(1e-6)];
    for i in 0..3 {
        assert!((levels[1].bounds[i] / levels[0].bounds[i] - 10.0).abs() < 1e-9);
        // beyond the first order an error of size e is off by about e
        assert!((levels[1].errors[i] / levels[0].errors[i] - 10.0).abs() < 1e-3, "{levels:?}");
    }
}
