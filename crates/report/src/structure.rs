//! Which state moves with which, and what is measured: the inference diagram of a system (Liu, Slotine and Barabasi, Observability of
//! complex systems, PNAS 110 (2013) 2460-2465). An arrow from a state leads to those that stand in its rate.

use crate::drawing::escaped;
use palmistry_lang::{Role, System};
use palmistry_math::expression::Symbol;
use palmistry_math::expression::notation::in_letters;
use palmistry_rank::observability::Observability;
use palmistry_rank::sweep::BranchAnswer;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Where a diagram is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiagramGround {
    /// On a page, whose ink and paper it has.
    Page,
    /// As a file of its own, on white.
    Alone,
}

/// With more nodes nothing can be made out.
const MOST_NODES: usize = 24;
/// Pixels.
const RADIUS: f64 = 17.0;
const MARGIN: f64 = 26.0;

/// A node: a state, or a signal that drives states.
struct Node {
    symbol: Symbol,
    is_signal: bool,
}

/// The diagram as SVG, with what was found of the unknowns. None where there are no states that move, or too many of them.
pub fn structure_picture(
    system: &System,
    found: Option<&BranchAnswer>,
    ground: DiagramGround,
) -> Option<String> {
    let of_first = |symbol: &Symbol| !system.symbol_name(*symbol).contains(['@', '\'']);
    let moving: BTreeSet<Symbol> = rates(system).map(|(symbol, _)| symbol).collect();
    let signals: BTreeSet<Symbol> =
        system.signal_chains().iter().filter_map(|chain| chain.first().copied()).collect();
    let is_one = |symbol: &Symbol| moving.contains(symbol) || signals.contains(symbol);
    let states = system.states.iter().copied().filter(|symbol| is_one(symbol) && of_first(symbol));
    let mut nodes: Vec<Node> =
        states.map(|symbol| Node { symbol, is_signal: signals.contains(&symbol) }).collect();
    nodes.sort_by_key(|node| node.is_signal);
    if !(2..=MOST_NODES).contains(&nodes.iter().filter(|node| !node.is_signal).count())
        || nodes.len() > MOST_NODES
    {
        return None;
    }
    let place = |symbol: Symbol| nodes.iter().position(|node| node.symbol == symbol);
    let mut arrows: BTreeSet<(usize, usize)> = BTreeSet::new();
    for (symbol, rate) in rates(system) {
        let Some(from) = place(symbol).filter(|from| !nodes[*from].is_signal) else { continue };
        let mentioned = system.graph.symbols_of([rate]);
        arrows.extend(mentioned.into_iter().filter_map(place).filter(|to| *to != from).map(|to| (from, to)));
    }
    let measured: BTreeSet<Symbol> =
        system.graph.symbols_of(system.outputs.iter().map(|(_, node)| *node)).into_iter().collect();
    let order = ordered(nodes.len(), &arrows);
    let circle = (nodes.len() as f64 * 3.0 * RADIUS / std::f64::consts::TAU).max(2.1 * RADIUS);
    let size = 2.0 * (circle + RADIUS + MARGIN);
    let at: Vec<(f64, f64)> = (0..nodes.len())
        .map(|node| {
            let turn = order[node] as f64 / nodes.len() as f64 * std::f64::consts::TAU;
            (size / 2.0 + circle * turn.sin(), size / 2.0 - circle * turn.cos())
        })
        .collect();
    let mut out = format!(
        "<svg class=\"structure\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {size:.0} {size:.0}\" width=\"{size:.0}\" \
         height=\"{size:.0}\" font-family=\"system-ui,sans-serif\" text-anchor=\"middle\"{}>",
        escaped(&format!("which states of {} stand in whose rates, and what is measured", system.title)),
        if ground == DiagramGround::Alone { " color=\"#1f2430\"" } else { "" }
    );
    if ground == DiagramGround::Alone {
        let _ = write!(out, "<rect width=\"{size:.0}\" height=\"{size:.0}\" rx=\"8\" fill=\"#fff\"/>");
    }
    let mut lines = String::new();
    let mut heads = String::new();
    for (from, to) in &arrows {
        arrow(at[*from], at[*to], arrows.contains(&(*to, *from)), (&mut lines, &mut heads));
    }
    let _ = write!(
        out,
        "<path d=\"{lines}\" fill=\"none\" stroke=\"#8a93a0\" stroke-width=\"1.3\"/><path d=\"{heads}\" fill=\"#8a93a0\"/>"
    );
    for (node, (x, y)) in nodes.iter().zip(&at) {
        let name = system.symbol_name(node.symbol);
        let fill = if node.is_signal { "#7c5cbf" } else { colour(found, name) };
        if measured.contains(&node.symbol) {
            let outer = RADIUS + 4.0;
            let _ = write!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{outer}\" fill=\"none\" stroke=\"#3b6ea5\" stroke-width=\"2.5\"/>"
            );
        }
        let _ = match node.is_signal {
            true => {
                let side = 1.7 * RADIUS;
                write!(
                    out,
                    "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{side:.1}\" height=\"{side:.1}\" fill=\"{fill}\" fill-opacity=\".22\" stroke=\"{fill}\"/>",
                    x - side / 2.0,
                    y - side / 2.0
                )
            }
            false => write!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{RADIUS}\" fill=\"{fill}\" fill-opacity=\".22\" stroke=\"{fill}\"/>"
            ),
        };
        let letters = in_letters(name);
        let short: String = match letters.chars().count() {
            0..=9 => letters.clone(),
            _ => letters.chars().take(8).chain(['\u{2026}']).collect(),
        };
        let font = (58.0 / short.chars().count().max(1) as f64).clamp(6.5, 14.0);
        let _ = write!(
            out,
            "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{font:.1}\" fill=\"currentColor\">{}<title>{}</title></text>",
            y + 0.35 * font,
            escaped(&short),
            escaped(name)
        );
    }
    out.push_str("</svg>");
    Some(out)
}

/// What is known of a state. A tint of the colour is behind the letters, which have that of those around the picture.
fn colour(found: Option<&BranchAnswer>, name: &str) -> &'static str {
    let mut unknowns =
        found.into_iter().flat_map(|branch| branch.unknowns.iter().zip(&branch.generic.unknowns));
    match unknowns.find(|((own, _), _)| own == name).map(|(_, (_, verdict))| *verdict) {
        Some(Observability::Yes) => "#2f9e44",
        Some(Observability::No) => "#d6293e",
        Some(Observability::Undecided) | None => "#8a93a0",
    }
}

/// The states that a drift or an input moves, with their rates; in discrete time with what they are after a step.
fn rates(system: &System) -> impl Iterator<Item = (Symbol, palmistry_math::expression::NodeId)> {
    let fields = system.fields.iter().filter(|field| field.role != Role::Other);
    fields.flat_map(|field| field.components.iter().copied())
}

/// The place of each node on the circle, so that arrows are short: neighbours are exchanged while that helps.
fn ordered(nodes: usize, arrows: &BTreeSet<(usize, usize)>) -> Vec<usize> {
    let mut order: Vec<usize> = (0..nodes).collect();
    let length = |order: &[usize]| -> usize {
        let apart = |(a, b): &(usize, usize)| {
            let distance = order[*a].abs_diff(order[*b]);
            distance.min(nodes - distance)
        };
        arrows.iter().map(apart).sum()
    };
    let mut best = length(&order);
    for _ in 0..nodes {
        let before = best;
        for a in 0..nodes {
            for b in a + 1..nodes {
                order.swap(a, b);
                let found = length(&order);
                if found < best {
                    best = found;
                } else {
                    order.swap(a, b);
                }
            }
        }
        if best == before {
            break;
        }
    }
    order
}

/// An arrow between two nodes, bent to the side where one leads back.
fn arrow(
    (x0, y0): (f64, f64),
    (x1, y1): (f64, f64),
    leads_back: bool,
    (lines, heads): (&mut String, &mut String),
) {
    let length = (x1 - x0).hypot(y1 - y0);
    let (ux, uy) = ((x1 - x0) / length, (y1 - y0) / length);
    let bend = if leads_back { 0.16 * length.min(90.0) } else { 0.0 };
    let (mx, my) = ((x0 + x1) / 2.0 - uy * bend, (y0 + y1) / 2.0 + ux * bend);
    let toward = |(x, y): (f64, f64)| {
        let reach = (mx - x).hypot(my - y);
        (
            x + (mx - x) / reach * (RADIUS + 5.0),
            y + (my - y) / reach * (RADIUS + 5.0),
            (x - mx) / reach,
            (y - my) / reach,
        )
    };
    let (ax, ay, ..) = toward((x0, y0));
    let (bx, by, dx, dy) = toward((x1, y1));
    let _ = write!(lines, "M{ax:.1} {ay:.1}Q{mx:.1} {my:.1} {bx:.1} {by:.1}");
    let (back, half) = (7.0, 3.2);
    let _ = write!(
        heads,
        "M{bx:.1} {by:.1}L{:.1} {:.1}L{:.1} {:.1}z",
        bx - dx * back - dy * half,
        by - dy * back + dx * half,
        bx - dx * back + dy * half,
        by - dy * back - dx * half
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_rank::sweep::{RankQuestion, answer_rank};

    fn drawn(text: &str) -> Option<String> {
        let system: System = text.parse().unwrap();
        let question = RankQuestion { samples: 0, ..RankQuestion::default() };
        let answer = answer_rank(&mut system.clone(), &question).unwrap();
        structure_picture(&system, answer.branches.first(), DiagramGround::Page)
    }

    /// A chain whose end is not measured, its output, and a known signal: three nodes, two arrows, one ring, one square.
    #[test]
    fn a_chain_has_its_arrows() {
        let picture =
            drawn("system \"<chain>\" state x, y known u(t) drift f x' = u y' = x output x").unwrap();
        assert_eq!(picture.matches("r=\"17\"").count(), 2, "{picture}");
        assert_eq!(picture.matches("stroke-width=\"2.5\"").count(), 1);
        assert_eq!(picture.matches("<rect").count(), 1);
        assert_eq!(picture.matches('Q').count(), 2);
        assert!(
            picture.contains("#d6293e") && picture.contains("#2f9e44") && picture.contains("&lt;chain&gt;")
        );
    }

    /// Of one state, of states that nothing moves and of more than can be made out there is none.
    #[test]
    fn what_has_no_diagram() {
        assert_eq!(drawn("system \"one\" state x drift f x' = -x output x"), None);
        let many =
            "system \"many\" state x[1..25] drift f x[i]' = x[i + 1] for i in 1..24 x[25]' = 0 output x[1]";
        assert_eq!(drawn(many), None);
        let rests: System = "system \"rests\" state x, y output x".parse().unwrap();
        assert_eq!(structure_picture(&rests, None, DiagramGround::Page), None);
    }
}
