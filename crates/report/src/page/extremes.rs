//! The part of the page that is about speed, accuracy and the extremes.

use crate::axis::unit_of;
use crate::certificate::answer::region_text;
use crate::certificate::plot::{region_curve, region_map_in_short};
use crate::stress::plot::lines_picture;
use crate::trade::answer::{TRADE_FRONT_HEADINGS, trade_front_table};
use crate::trade::plot::trade_plot;
use maud::{Markup, PreEscaped, html};
use palmistry_lang::System;
use palmistry_prove::certificate::RegionAnswer;
use palmistry_workbench::paper::Findings;
use palmistry_workbench::tradeoff::Trade;
use palmistry_workbench::tradeoff::stress::StressStudy;

/// What the section is called; nothing if nothing was found for it.
pub(super) fn extremes_heading(found: &Findings) -> Option<&'static str> {
    let is_timed = found.files.iter().any(|file| file.trade.is_some());
    let goes_far = found.files.iter().any(|file| file.stress.is_some() || file.certificate.is_some());
    match (is_timed, goes_far) {
        (true, _) => Some("Speed against accuracy"),
        (false, true) => Some("How far it holds"),
        (false, false) => None,
    }
}

/// What was found of it, as a section of the page.
pub(super) fn extremes(found: &Findings, heading: &str) -> Markup {
    let stress: Vec<&StressStudy> = found.files.iter().filter_map(|file| file.stress.as_ref()).collect();
    let regions: Vec<(&System, &RegionAnswer)> =
        found.files.iter().filter_map(|file| Some((&file.system, file.certificate.as_ref()?))).collect();
    html! {
        section #extremes {
            h2 { (heading) }
            details {
                summary { "number types, the extremes, and what is certified between samples" }
                @for file in &found.files {
                    @if let Some(trade) = &file.trade { (traded(trade)) }
                }
                @if !stress.is_empty() { (stressed(&stress)) }
                @if !regions.is_empty() { (certified(&regions)) }
            }
        }
    }
}

fn certified(regions: &[(&System, &RegionAnswer)]) -> Markup {
    html! {
        h3 { "Between the samples" }
        p {
            "Full rank proved on whole sub-boxes of the sample box by interval arithmetic, the largest halved first; a short "
            "version. " code { "palmistry certify" } " goes on for as long as it is given."
        }
        @for (system, answer) in regions {
            details {
                summary { (region_text(answer).lines().take(2).collect::<Vec<_>>().join(": ")) }
                pre { (region_text(answer)) }
                figure {
                    div.grid {
                        (PreEscaped(region_curve(answer, "proved")))
                        @if let Some(map) = &answer.map {
                            @let units = [unit_of(system, &map.x.name), unit_of(system, &map.y.name)];
                            @let units = [units[0].as_deref(), units[1].as_deref()];
                            (PreEscaped(region_map_in_short(map, "the box, in two coordinates", units)))
                        }
                    }
                    figcaption {
                        "How much of the box is still open, box by box; and the boxes over two coordinates: pale where full rank is "
                        "proved, red where a minor vanishes, black where a singularity lies in it, grey where nothing is decided; hundreds of boxes in cells, pale where nothing else reaches in."
                    }
                }
            }
        }
    }
}

fn stressed(studies: &[&StressStudy]) -> Markup {
    html! {
        h3 { "The extremes" }
        p {
            "Lines into every singular set of every system down to a distance of 1e-15: where each kind of number first misreports "
            "the rank of the file's own rows, loses more than half of its digits, or refuses, beside the certified rank at the very "
            "state. A short version; " code { "palmistry stress" } " has more states, scales every quantity from 1e-150 to 1e150, "
            "says how states are conditioned, and prints every distance."
        }
        @for study in studies {
            details {
                summary { (study.title) }
                figure {
                    div.grid { (PreEscaped(lines_picture(study))) }
                    figcaption { "Bars from far to near, coloured by what a verdict is worth there." }
                }
            }
        }
    }
}

fn traded(trade: &Trade) -> Markup {
    html! {
        p {
            "Every sensible combination of a kind of number, a way to a derivative and a way to a rank, on the same "
            (trade.states) " states of the sample box of " (trade.title) ": " (trade.combinations.len()) " combinations; the table "
            "holds those that no other beats in time, in digits at the worst state, in right verdicts and in certain ones. "
            "(" code { "palmistry trade" } " measures them on a thousand states.)"
        }
        figure {
            div.grid { (PreEscaped(trade_plot(trade))) }
            figcaption { "The line joins those of which every verdict is right and that no other one beats in time and digits." }
        }
        div.scroll { table {
            thead { tr { @for heading in TRADE_FRONT_HEADINGS { th { (heading) } } } }
            tbody { @for row in trade_front_table(trade) { tr { @for cell in row { td { (cell) } } } } }
        } }
    }
}
