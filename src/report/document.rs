//! The frame of every page: one file, with its style and its script, and nothing from elsewhere.

use crate::report::compact::compact;
use crate::report::drawing::STANDALONE;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");
/// What sorts and filters; a page without it shows everything.
const SCRIPT: &str = include_str!("page.js");

/// A page as HTML.
pub(super) fn document(title: &str, content: &Markup, has_claims: bool) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (content)
                @if has_claims { script { (PreEscaped(SCRIPT)) } }
            }
        }
    }
    .into_string();
    compact(&page.replace(STANDALONE, ""))
}
