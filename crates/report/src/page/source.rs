//! The text of each proof file, its lines counted, so that an entry can point to where it stands.

use super::anchors::Anchors;
use maud::{Markup, PreEscaped, html};
use palmistry_io::foreign::shown;
use palmistry_lang::System;

/// The texts of some files, each folded away.
pub(super) fn sources(systems: &[&System], anchors: &Anchors) -> Markup {
    html! {
        section #sources {
            h2 { "The proof files" }
            @for (place, system) in systems.iter().enumerate() {
                details.source #(anchors.file(place)) {
                    summary { b { (system.name) } " " (system.title) @if let Some(cite) = &system.cite { " (" (cite) ")" } }
                    (PreEscaped(text(&system.source, place, anchors)))
                }
            }
        }
    }
}

/// A line in which every character is visible, its tabs as they are.
fn in_letters(line: &str) -> String {
    line.split('\t').map(shown).collect::<Vec<_>>().join("\t")
}

/// A numbered list of lines. Only those to which something points have a name.
fn text(source: &str, file: usize, anchors: &Anchors) -> String {
    let named = anchors.lines_of(file);
    let mut out = String::from("<ol>");
    for (place, line) in source.lines().enumerate() {
        let line = in_letters(line).replace('&', "&amp;").replace('<', "&lt;");
        match named.contains(&(place + 1)) {
            true => out.push_str(&format!("<li id=\"{}\">{line}", Anchors::line_name(file, place + 1))),
            false => out.push_str(&format!("<li>{line}")),
        }
    }
    out.push_str("</ol>");
    out
}
