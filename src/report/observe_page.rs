//! The page of an experiment.

use super::observe::{Observed, observe_text};
use maud::{DOCTYPE, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

/// The page as HTML.
pub fn observe_page(observed: &Observed<'_>) -> String {
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
                h1 { (observed.experiment.scene.title) }
                pre { (observe_text(observed)) }
            }
        }
    };
    content.into_string()
}
