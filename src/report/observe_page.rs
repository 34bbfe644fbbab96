//! The page of an experiment.

use super::observe::Observed;
use super::observe_section::{body_pictures, faults, sensor_pictures, state_pictures, studies, summary};
use super::observe_table::{ends, notes, updates};
use maud::{DOCTYPE, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

/// The page as HTML.
pub fn observe_page(observed: &Observed<'_>) -> String {
    let studied = !observed.noise.is_empty() || !observed.basins.is_empty();
    let content = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (observed.experiment.scene.title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (observed.experiment.scene.title) }
                    (summary(observed))
                    (faults(observed))
                    nav {
                        a href="#body" { "The body" }
                        a href="#found" { "What they found" }
                        a href="#states" { "States over time" }
                        a href="#sensors" { "Sensor errors" }
                        @if studied { a href="#studies" { "Studies" } }
                        a href="#updates" { "All updates" }
                    }
                }
                section #body { h2 { "The body between its palms" } (body_pictures(observed)) }
                section #found { h2 { "What they found" } (ends(observed)) (notes(observed)) }
                section #states { h2 { "States over time" } (state_pictures(observed)) }
                section #sensors { h2 { "Sensor errors" } (sensor_pictures(observed)) }
                @if studied { section #studies { h2 { "Studies" } (studies(observed)) } }
                section #updates { h2 { "All updates" } (updates(observed)) }
            }
        }
    };
    content.into_string()
}
