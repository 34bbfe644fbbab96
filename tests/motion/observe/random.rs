//! Whatever numbers stand in a scene, the library answers. The cases are the same each time; `PROPTEST_RNG_SEED` draws others.

use crate::observe::{NEVER, REGIMES, text, with};
use palmistry::experiment::{Experiment, Scene};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A number as someone might write it: near the usual one, of any size, or none.
fn number(usual: f64) -> impl Strategy<Value = String> {
    let value = prop_oneof![
        40 => (-1.0..1.0f64).prop_map(move |off| usual * (1.0 + 0.3 * off)),
        2 => -3.0..3.0f64,
        1 => (-300.0..300.0f64).prop_map(|power| 10f64.powf(power)),
        1 => prop::sample::select(vec![0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX]),
    ];
    // TOML knows nan and inf as they are written here, but for the capitals
    value.prop_map(|value| format!("{value:?}").to_lowercase())
}

fn shape() -> impl Strategy<Value = String> {
    let harmonics = (number(1.2), number(0.03), number(-0.04)).prop_map(|(mean, p, q)| {
        format!("{{ kind = \"harmonics\", mean = {mean}, harmonics = [[0, 0], [0.1, 0], [{p}, {q}]] }}")
    });
    let ellipse = (number(1.2), number(1.0))
        .prop_map(|(a, b)| format!("{{ kind = \"ellipse\", semi_axes = [{a}, {b}] }}"));
    let superellipse = (number(1.2), number(1.0), 1u32..34, number(0.3)).prop_map(|(a, b, half, rounding)| {
        let exponent = 2 * half;
        format!(
            "{{ kind = \"superellipse\", semi_axes = [{a}, {b}], exponent = {exponent}, rounding = {rounding} }}"
        )
    });
    let knots = prop::sample::select(vec!["uniform", "centripetal", "chord"]);
    let spline = (number(1.2), number(1.3), number(1.4), knots).prop_map(|(a, b, c, knots)| {
        format!("{{ kind = \"spline\", radii = [{a}, {b}, {c}], knots = \"{knots}\" }}")
    });
    let random = (0u64..100).prop_map(|seed| format!("{{ kind = \"random-spline\", seed = {seed} }}"));
    prop_oneof![4 => harmonics, 1 => ellipse, 1 => superellipse, 1 => spline, 1 => random]
}

fn palms() -> impl Strategy<Value = String> {
    let swing = (number(0.1), number(1.0), number(0.5)).prop_map(|(amplitude, frequency, phase)| {
        format!("swings = [{{ amplitude = {amplitude}, frequency = {frequency}, phase = {phase} }}]")
    });
    let of =
        (number(0.4), number(0.4), number(1.8), number(0.1), number(5.1), number(-6.2), swing, any::<bool>());
    of.prop_map(|(start1, rate1, start2, rate2, torque1, torque2, swing, told)| match told {
        true => format!(
            "prescribed = [{{ start = {start1}, rate = {rate1}, {swing} }}, {{ start = {start2}, rate = {rate2} }}]"
        ),
        false => format!(
            "torques = [{{ angle = {start1}, rate = {rate1}, torque = {torque1}, {swing} }}, \
             {{ angle = {start2}, rate = {rate2}, torque = {torque2} }}]"
        ),
    })
}

/// How many scenes could be used.
static OBSERVED: AtomicUsize = AtomicUsize::new(0);

const CASES: u32 = 100;

/// The seed that the environment names, otherwise always the same: what lands does not hang on a draw.
fn seed() -> RngSeed {
    std::env::var("PROPTEST_RNG_SEED")
        .ok()
        .and_then(|text| text.parse().ok())
        .map_or(RngSeed::Fixed(6), RngSeed::Fixed)
}

#[test]
fn no_numbers_make_a_scene_panic() {
    each_is_answered();
    let observed = OBSERVED.load(Ordering::Relaxed);
    assert!(observed > CASES as usize / 15, "the test has looked at something: {observed}");
}

/// The part of a text from the first of two words up to the second.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let begin = text.find(from).unwrap();
    &text[begin..begin + text[begin..].find(to).unwrap()]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, rng_seed: seed(), ..ProptestConfig::default() })]

    fn each_is_answered(
        (shape, palms, regime) in (shape(), palms(), prop::sample::select(REGIMES.to_vec())),
        (mass, orientation, rate) in (number(1.0), number(5.3), number(-0.8)),
        (duration, inertia) in (number(0.1), number(0.5)),
        (noise, resolution, radius, turning) in (number(1e-5), number(1e-5), number(1.3), number(-0.9)),
        (samples, window) in (2usize..14).prop_flat_map(|samples| (Just(samples), 2..=samples)),
        steps in 1usize..8,
    ) {
        let whole = text(regime).replace("steps = 100", "steps = 20");
        let body = between(&whole, "[body]", "[palms]");
        let moved = between(&whole, "[palms]", "[observer]");
        let estimate = between(&whole, "estimate", "guess_off");
        let rho = if estimate.contains("rho") { ", rho = 0.8" } else { "" };
        let changes = [
            (body, format!("[body]\nshape = {shape}\nmass = {mass}\norientation = {orientation}\nrate = {rate}\n")),
            (
                moved,
                format!("[palms]\ninertia = [{inertia}, 0.6]\n{palms}\n[sensor]\nnoise = {noise}\nresolution = {resolution}\n"),
            ),
            ("duration = 1.4", format!("duration = {duration}")),
            ("samples = 401", format!("samples = {samples}")),
            ("window = 80", format!("window = {window}")),
            ("steps = 20", format!("steps = {steps}")),
            ("guess_off = 0.1", format!("guess = {{ r1 = {radius}, r2 = 1.3, omega0 = {turning}{rho} }}")),
        ];
        let scene = changes.iter().fold(whole.clone(), |text, (from, to)| with(&text, from, to));
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
    }
}
