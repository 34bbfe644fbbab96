//! The frame of every page: one file, with its style and its script, and nothing from elsewhere. Its content security policy names
//! both by their hashes: a browser runs no other script, and loads nothing, whatever a stranger's file has brought onto the page.

use crate::compact::compact;
use crate::drawing::STANDALONE;
use crate::inline_hash::inline_hash;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");
/// What sorts and filters; a page without it shows everything.
const SCRIPT: &str = include_str!("page.js");

/// What turns pictures of surfaces, on pages that have some.
pub(super) const TURNING: &str = include_str!("solid_picture.js");

/// Stands for the policy until the page is whole.
const POLICY: &str = "the-policy-of-this-page";

/// A page as HTML.
pub(super) fn document(title: &str, content: &Markup, has_claims: bool) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content={ "default-src 'none'; " (POLICY) };
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
    with_policy(&compact(&page.replace(STANDALONE, "")))
}

/// The page with its policy: its own style as it stands there, and the scripts that this program has.
fn with_policy(page: &str) -> String {
    // the first style of a page is its own: before it stands a title, in which markup is letters
    let style = page.split_once("<style>").and_then(|(_, rest)| rest.split_once("</style>"));
    let policy = format!(
        "style-src {}; script-src {} {}; base-uri 'none'; form-action 'none'",
        inline_hash(style.map_or("", |(style, _)| style)),
        inline_hash(SCRIPT),
        inline_hash(TURNING)
    );
    page.replacen(POLICY, &policy, 1)
}
