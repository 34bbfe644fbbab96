//! The touchpad of section 3.5, 100 Hz and 0.1 mm, under a body of the size of a hand.

use super::{experiment, text};
use palmistry::experiment::{Answer, Experiment};

/// Body at the start and palms of the four regimes.
const REGIMES: [(&str, f64, f64, &str); 4] = [
    ("both palms turn at one rate", 5.0, -0.8, "{ start = 0.4, rate = 0.6 }, { start = 1.8 }"),
    ("palm 1 is fixed", 4.3, 4.50333209967908, "{ start = 0.8 }, { start = 1.8, rate = -1.03923 }"),
    ("both palms are fixed", 4.4, 0.3, "{ start = 0.7 }, { start = 1.7 }"),
    (
        "both palms swing",
        4.4,
        0.3,
        "{ start = 0.7, swings = [{ amplitude = 0.1, frequency = 1.3, phase = 0 }] }, \
         { start = 1.7, swings = [{ amplitude = 0.1, frequency = 1.7, phase = 1 }] }",
    ),
];

fn scene(orientation: f64, rate: f64, palms: &str) -> String {
    let model = text("general").lines().find(|line| line.starts_with("model")).unwrap().to_owned();
    format!(
        "title = \"A touchpad\"\n{model}\nduration = 1.4\nsamples = 141\n[body]\n\
         shape = {{ kind = \"harmonics\", mean = 0.1, harmonics = [[0, 0], [0.00833, 0], [0.0025, -0.00333]] }}\n\
         mass = 1.0\nradius_of_gyration = 0.07\norientation = {orientation}\nrate = {rate}\n[palms]\n\
         inertia = [0.0035, 0.0042]\nprescribed = [{palms}]\n[sensor]\nresolution = 1e-4\n[observer]\n\
         methods = [\"trust-region\"]\nwindow = 20\nsteps = 60\ninputs = {{ g1 = \"tau1\", g2 = \"tau2\" }}\n\
         estimate = [\"r1\", \"r2\", \"omega0\"]\nguess = \"none\"\n"
    )
}

/// The shape is found from all measurements in each regime, as near and as far round as the book says.
#[test]
fn the_shape_over_a_touchpad_is_as_near_as_the_book_says() {
    let (mut errors, mut parts) = (Vec::new(), Vec::new());
    for (_, orientation, rate, palms) in REGIMES {
        let experiment: Experiment = experiment(&scene(orientation, rate, palms));
        let found = experiment.reconstruct(&super::answers(&experiment), &super::NEVER).expect("two palms");
        assert!(found.whole.is_some());
        let (largest, _) = super::shape::worst(&experiment, &found);
        errors.push(format!("{:.1e}", largest / 0.1));
        parts.push(format!("{:.0}", 100.0 * found.coverage.fraction()));
    }
    let listed = |words: &[String]| format!("{} and {}", words[..3].join(", "), words[3]);
    let page =
        include_str!("../../../book/src/observers.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let sentence = format!(
        "error is {} of the mean radius, with {} % of the normals touched",
        listed(&errors),
        listed(&parts)
    );
    assert!(page.contains(&sentence), "{sentence}");
}

/// In each regime all windows of 20 samples fit, with both radii right to one percent and all within five of their bounds, although a palm and the body come to turn at one rate in many of them.
#[test]
fn every_window_of_a_touchpad_is_answered() {
    for (regime, orientation, rate, palms) in REGIMES {
        let experiment: Experiment = experiment(&scene(orientation, rate, palms));
        let answers: Vec<Answer> = super::answers(&experiment);
        let track = &answers[0].track;
        assert_eq!(track.updates.len(), 7, "{regime}");
        for update in &track.updates {
            assert!(update.is_borne_out(), "{regime}: {update:?}");
            let truth = experiment.truth_at(update.from).unwrap();
            for (place, (found, true_value)) in update.estimate.iter().zip(&truth).enumerate() {
                let off = (found - true_value).abs();
                assert!(off < 5.0 * update.deviations[place], "{regime}, {place}: {update:?}");
                assert!(place > 1 || off < 1e-2 * true_value, "{regime}, {place}: {update:?}");
            }
        }
    }
}
