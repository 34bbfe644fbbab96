//! What it adds that wheel 2 of a robot rolls where wheel 1 has been, as text, JSON and for the page.

use super::fit::finite;
use maud::{Markup, html};
use palmistry_scenes::{Closure, ClosureSetting, ComputedRank};
use serde_json::{Value, json};
use std::fmt::Write;

/// From when on, as text.
fn begins(closure: &Closure) -> String {
    let [met, all] = closure.samples;
    match closure.from {
        Some(from) => format!(
            "wheel 2 rolls over what wheel 1 has drawn from {from:.3} s on, at {met} of {all} samples"
        ),
        None => "wheel 2 is never where wheel 1 has been, and nothing closes".to_owned(),
    }
}

/// Names in a row, or that there are none.
fn listed(names: &[&str]) -> String {
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}

fn least(rank: &ComputedRank) -> String {
    rank.least().map_or_else(|| "none".to_owned(), |least| format!("{least:.2e}"))
}

/// As text.
pub(super) fn closure_text(closure: &Closure) -> String {
    let mut text = format!("\nclosure, computed for this drive: {}\n", begins(closure));
    for ClosureSetting { read, unknowns, without, with } in &closure.settings {
        let _ = writeln!(
            text,
            "  {read}: rank {} of {} without, {} with; least singular value {}, {}",
            without.rank,
            unknowns.len(),
            with.rank,
            least(without),
            least(with)
        );
    }
    for setting in &closure.settings {
        let (gained, left) = (listed(&setting.gained()), listed(&setting.unobservable()));
        let _ = writeln!(text, "  {}: gained {gained}; non-identifiable {left}", setting.read);
    }
    text
}

fn rank_json(rank: &ComputedRank, unknowns: &[&str]) -> Value {
    let told = unknowns.iter().zip(&rank.observable).filter(|(_, told)| **told);
    json!({
        "rank": rank.rank,
        "estimated": told.map(|(name, _)| *name).collect::<Vec<_>>(),
        "singular_values": rank.singular_values.iter().map(|value| finite(*value)).collect::<Vec<_>>(),
    })
}

/// As JSON.
pub(super) fn closure_json(closure: &Closure) -> Value {
    let settings = closure.settings.iter().map(|setting| {
        json!({
            "read": setting.read,
            "unknowns": setting.unknowns,
            "without": rank_json(&setting.without, &setting.unknowns),
            "with": rank_json(&setting.with, &setting.unknowns),
            "gained": setting.gained(),
        })
    });
    json!({
        "status": "computed",
        "from": closure.from,
        "samples": closure.samples[0],
        "samples_of": closure.samples[1],
        "settings": settings.collect::<Vec<_>>(),
    })
}

/// For the page.
pub(super) fn closure_section(closure: &Closure) -> Markup {
    html! {
        p {
            "Here " (begins(closure)) ". That is a delay, so that no finite number of Lie derivatives gives its rank. What stands below is "
            b { "computed" } ": singular values of all rows of this drive, differentiated at the true unknowns."
        }
        div.scroll {
            table {
                thead { tr { th { "read" } th { "unknowns" } th { "rank without" } th { "rank with" } th { "gained" } th { "non-identifiable" } } }
                tbody {
                    @for setting in &closure.settings {
                        tr {
                            td { (setting.read) }
                            td.n { (setting.unknowns.len()) }
                            td.n { (setting.without.rank) }
                            td.n { (setting.with.rank) }
                            td { (listed(&setting.gained())) }
                            td { (listed(&setting.unobservable())) }
                        }
                    }
                }
            }
        }
    }
}
