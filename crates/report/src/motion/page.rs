//! The page of an experiment.

use crate::document::document;
use crate::motion::answers::Observed;
use crate::motion::closure::closure_section;
use crate::motion::outline_section::shape_section;
use crate::motion::recognition::recognition_section;
use crate::motion::reconstruction::reconstruction;
use crate::motion::section::{FRAMES, body_pictures, faults, sensor_pictures, state_pictures, summary};
use crate::motion::studies_section::studies;
use crate::motion::table::{ends, notes, updates};
use maud::html;

/// The page as HTML.
pub fn observe_page(observed: &Observed<'_>) -> String {
    let has_palms = observed.experiment.is_about_palms();
    let studied = !observed.studied.is_empty();
    let shape = reconstruction(observed.answers).is_some();
    let content = html! {
        header {
            h1 { (observed.experiment.scene.title) }
            (summary(observed))
            (faults(observed))
            nav {
                @if has_palms { a href="#body" { "The body" } }
                @if shape { a href="#shape" { "The shape" } }
                @if observed.experiment.recognition.is_some() { a href="#recognition" { "Which body it is" } }
                @if observed.experiment.closure.is_some() { a href="#closure" { "Closure" } }
                a href="#found" { "What they found" }
                a href="#states" { "States over time" }
                a href="#sensors" { "Sensor errors" }
                @if studied { a href="#studies" { "Studies" } }
                a href="#updates" { "All updates" }
            }
        }
        main {
            @if has_palms { section #body { h2 { "The body between its palms" } (body_pictures(observed, FRAMES)) } }
            @if shape { section #shape { h2 { "The shape" } (shape_section(observed)) } }
            section #found { h2 { "What they found" } (ends(observed)) (notes(observed)) }
            @if let Some(found) = &observed.experiment.recognition {
                section #recognition { h2 { "Which body it is" } (recognition_section(found)) }
            }
            @if let Some(closure) = &observed.experiment.closure {
                section #closure { h2 { "Closure" } (closure_section(closure)) }
            }
            section #states { h2 { "States over time" } (state_pictures(observed)) }
            section #sensors { h2 { "Sensor errors" } (sensor_pictures(observed)) }
            @if studied { section #studies { h2 { "Studies" } (studies(observed)) } }
            section #updates { h2 { "All updates" } (updates(observed)) }
        }
    };
    document(&observed.experiment.scene.title, &content, false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::section::observed_section;
    use crate::motion::shape::{departure, outline};
    use palmistry_scenes::{BasinStudy, Experiment, NoiseStudy, Scene, Studied, basins, noise_study};
    use std::sync::atomic::AtomicBool;

    const SCENE: &str = r#"
title = "A small scene"
model = "../../proofs/moll2002/general.proof"
duration = 0.3
samples = 61

[body]
shape = { kind = "harmonics", mean = 1.0, harmonics = [[0, 0], [0.08, 0.03]] }
mass = 1.0
rate = -1.0

[palms]
inertia = [0.5, 0.5]
prescribed = [{ start = 0.6, rate = 0.3 }, { start = 1.7 }]

[observer]
methods = ["trust-region", "integration"]
inputs = { g1 = "tau1", g2 = "tau2" }
estimate = ["r1", "r2", "omega0"]
guess_off = 0.1
window = 30
steps = 20
"#;

    /// The observers of the small scene with its studies, and what is made of them.
    fn with_observed(test: impl FnOnce(&Observed<'_>)) {
        let scene = Scene::parse("small.toml", SCENE).unwrap();
        let experiment = Experiment::new(scene, None).unwrap();
        let never = AtomicBool::new(false);
        let answers = experiment.run(&never, &|_| {}).unwrap();
        let study = NoiseStudy { levels: vec![1e-5, 1e-4], seeds: 2 };
        let simulation = experiment.simulation.as_ref().unwrap();
        let noise = noise_study(&experiment, simulation, &study, &never, &|| {}).unwrap();
        let ranges = ["r1", "r2"].map(|name| (name.to_owned(), [0.9, 1.1])).into();
        let basins = basins(&experiment, &BasinStudy { ranges, points: 2 }, &never, &|| {}).unwrap();
        let (experiment, answers) = (&experiment, &answers[..]);
        let studied = &Studied { noise, basins, curvature: None };
        test(&Observed { experiment, answers, studied, interrupted: false });
    }

    #[test]
    fn a_page_holds_its_pictures() {
        with_observed(|observed| {
            let (page, section) = (observe_page(observed), observed_section(&[*observed]).into_string());
            // a paper's page has half of the frames, and nothing of the sensors
            for (text, what, frames, sensors) in
                [(&page, "page", FRAMES, 3), (&section, "section", FRAMES / 2, 0)]
            {
                assert!(!text.contains("could not be drawn"), "{what}");
                // the frames and the outline, three states with their errors, sensor errors of one method and of both outputs, the
                // noise of three states, the basins of two methods
                assert_eq!(text.matches("<svg").count(), frames + 1 + 6 + sensors + 3 + 2, "{what}");
                assert!(!text.contains("NaN"), "{what}");
            }
            assert!(section.contains("id=\"observers\""));
        });
    }

    /// The second witness is the simulation: its shape, from a support function, knows no r and d, and its poses no omega0 of an
    /// observer. The trapezoidal rule is off by `h^2/12` times what the acceleration has grown by (Euler and Maclaurin); besides,
    /// estimates from measurements without error are good to 1e-6 m and rad/s, and bodies here reach no farther than 1.2 m.
    #[test]
    fn recovered_contacts_lie_on_the_true_outline() {
        with_observed(|observed| {
            let simulation = observed.experiment.simulation.as_ref().unwrap();
            let (moments, outline) =
                (&simulation.trajectory.moments, outline(observed.experiment, observed.answers).unwrap());
            assert_eq!(outline.instants.len(), moments.len());
            let step: f64 = 0.3 / 60.0;
            let rule = |i: usize| step.powi(2) / 12.0 * (moments[i].alpha0 - moments[0].alpha0);
            for (i, (instant, moment)) in outline.instants.iter().zip(moments).enumerate() {
                let off = [0, 1].map(|axis| (instant.centre[axis] - moment.centre[axis]).abs());
                assert!(off[0].max(off[1]) < 2e-6, "{} s: {off:?}", instant.time);
                let turned = instant.orientation - moment.phi0 - rule(i);
                assert!(turned.abs() < 1e-6, "{} s: {turned:e}", instant.time);
            }
            let turned = (0..moments.len()).map(|i| rule(i).abs()).fold(0.0, f64::max);
            let (largest, mean) = departure(&outline, &simulation.shape).unwrap();
            assert!(largest < 2e-6 + 1.2 * turned, "{largest:e} for {turned:e}");
            assert!(mean <= largest);
        });
    }
}
