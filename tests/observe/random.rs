//! Whatever numbers stand in a scene, the library answers, and soon.

use crate::{NEVER, text, with};
use palmistry::experiment::{Experiment, Scene};
use proptest::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A number as someone might write it: near the usual one, of any size, or none.
fn number(usual: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        40 => (-1.0..1.0f64).prop_map(move |off| usual * (1.0 + 0.3 * off)),
        2 => -3.0..3.0f64,
        1 => (-300.0..300.0f64).prop_map(|power| 10f64.powf(power)),
        1 => prop::sample::select(vec![0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX]),
    ]
}

/// As TOML wants it.
fn written(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") }
}

/// A case takes a second at most, on a machine that others use too.
const LONGEST: Duration = Duration::from_secs(10);

/// How many scenes could be used.
static OBSERVED: AtomicUsize = AtomicUsize::new(0);

#[test]
fn no_numbers_make_a_scene_panic() {
    each_is_answered();
    let observed = OBSERVED.load(Ordering::Relaxed);
    eprintln!("OBSERVED {observed}");
    assert!(observed > CASES as usize / 10, "the test has looked at something: {observed}");
}

const CASES: u32 = 200;

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

    fn each_is_answered(
        (mass, orientation, rate) in (number(1.0), number(5.3), number(-0.8)),
        (duration, inertia, start1, start2) in (number(0.1), number(0.5), number(0.4), number(1.8)),
        (amplitude, frequency, phase) in (number(0.1), number(1.0), number(0.5)),
        (mean, harmonic) in (number(1.2), number(0.03)),
        (noise, resolution, guess) in (number(1e-5), number(1e-5), number(1.3)),
        (samples, window) in (2usize..14).prop_flat_map(|samples| (Just(samples), 2..=samples)),
        steps in 1usize..8,
    ) {
        let base = text("same_rate");
        let swings = format!(
            "prescribed = [{{ start = {}, rate = 0.4, swings = [{{ amplitude = {}, frequency = {}, phase = {} }}] }}, {{ start = {} }}]",
            written(start1), written(amplitude), written(frequency), written(phase), written(start2),
        );
        let guesses = format!("guess = {{ r1 = {0}, r2 = 1.3, omega0 = {0} }}", written(guess));
        let changes = [
            ("mass = 1.0", format!("mass = {}", written(mass))),
            ("orientation = 5.3", format!("orientation = {}", written(orientation))),
            ("rate = -0.8", format!("rate = {}", written(rate))),
            ("duration = 1.4", format!("duration = {}", written(duration))),
            ("samples = 401", format!("samples = {samples}")),
            ("[0.5, 0.6]", format!("[{}, 0.6]", written(inertia))),
            ("prescribed = [{ start = 0.4, rate = 0.4 }, { start = 1.8 }]", swings),
            ("mean = 1.2", format!("mean = {}", written(mean))),
            ("[0.03, -0.04]", format!("[{}, -0.04]", written(harmonic))),
            ("window = 80", format!("window = {window}")),
            ("steps = 20", format!("steps = {steps}")),
            ("guess_off = 0.1", guesses),
            (
                "[observer]\n",
                format!("[sensor]\nnoise = {}\nresolution = {}\n[observer]\n", written(noise), written(resolution)),
            ),
        ];
        let scene = changes.iter().fold(base, |text, (from, to)| with(&text, from, to));
        let begin = Instant::now();
        // an error is an answer; a panic is none
        let answers = Scene::parse("scene.toml", &scene)
            .and_then(|scene| Experiment::new(scene, None))
            .and_then(|experiment| experiment.run(&NEVER, &|_| ()));
        match &answers {
            Err(error) => prop_assert!(!error.message.is_empty()),
            Ok(answers) => {
                prop_assert_eq!(answers.len(), 5);
                OBSERVED.fetch_add(1, Ordering::Relaxed);
            }
        }
        if begin.elapsed() > Duration::from_millis(300) {eprintln!("SLOW {:?} {}", begin.elapsed(), answers.is_ok());}
        prop_assert!(begin.elapsed() < LONGEST, "{:?}\n{scene}", begin.elapsed());
    }
}
