//! The part of the page that is about speed, accuracy and the extremes.

use super::trade::{TRADE_FRONT_HEADINGS, trade_front_table};
use super::trade_plot::trade_plot;
use crate::tradeoff::Trade;
use crate::verification::Verification;
use maud::{Markup, PreEscaped, html};

/// What was found of it, as a section of the page.
pub(super) fn extremes(found: &Verification) -> Markup {
    html! {
        section #extremes {
            h2 { "Speed against accuracy" }
            @if let Some(trade) = &found.trade { (traded(trade)) }
        }
    }
}

fn traded(trade: &Trade) -> Markup {
    html! {
        p {
            "Every sensible combination of a kind of number, a way to a derivative and a way to a rank, on the same "
            (trade.states) " states of the general regime's sample box: " (trade.combinations.len()) " combinations; the table "
            "holds those that no other beats in time, in digits at the worst state, in right verdicts and in certain ones. "
            "(" code { "palmistry trade" } " measures them on a thousand states.)"
        }
        figure { (PreEscaped(trade_plot(trade))) }
        table {
            thead { tr { @for heading in TRADE_FRONT_HEADINGS { th { (heading) } } } }
            tbody { @for row in trade_front_table(trade) { tr { @for cell in row { td { (cell) } } } } }
        }
    }
}
