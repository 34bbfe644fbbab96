//! Of tests: exponential decays, measured with normal errors.

use super::{EstimateQuestion, Noise, Signals, Task};
use palmistry_lang::System;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::Path;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// `x' = -k x` with `x` measured at so many times from 0 to so many seconds, from 2 with `k = 0.8`, and a normal error of this size.
pub struct Decay {
    system: System,
    question: EstimateQuestion,
    pub signals: Signals,
}

impl Decay {
    pub fn new((rows, end): (usize, f64), noise: f64, seed: u64, guess: [f64; 2]) -> Decay {
        let text = "system \"A decay\"\nstate x, k\ndrift f\n  x' = -k*x\n  others' = 0\noutput x\n";
        let guess = ["x", "k"].iter().zip(guess).map(|(name, value)| ((*name).to_owned(), value)).collect();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let times: Vec<f64> = (0..rows).map(|row| end * row as f64 / (rows - 1) as f64).collect();
        let read = times.iter().map(|time| 2.0 * (-0.8 * time).exp() + noise * normal(&mut random)).collect();
        Decay {
            system: System::parse("decay.proof", text, Path::new("")).unwrap(),
            question: EstimateQuestion { guess, ..EstimateQuestion::default() },
            signals: Signals::new(times, vec![("x".to_owned(), read)]).unwrap(),
        }
    }

    /// Nothing is known of the errors.
    pub fn task(&self) -> Task<'_> {
        let mut task = Task::new(&self.system, &self.question, &self.signals, &NEVER).unwrap();
        task.exact = false;
        task
    }

    /// Normal errors of this size are stated.
    pub fn stated(&self, normal: f64) -> Task<'_> {
        Task { noise: Noise::Stated { normal, rounding: 0.0 }, sigma: normal, ..self.task() }
    }
}

/// A number of the standard normal distribution, by the transform of Box and Muller.
pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}
