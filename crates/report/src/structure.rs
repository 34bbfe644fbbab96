//! Which state moves with which, and what is measured: the inference diagram of a system (Liu, Slotine and Barabasi, Observability of
//! complex systems, PNAS 110 (2013) 2460-2465). An arrow from a state leads to those that stand in its rate.

use crate::drawing::escaped;
use palmistry_lang::{Role, System, UnknownKind};
use palmistry_math::expression::Symbol;
use palmistry_math::expression::notation::letter_and_index;
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
/// The size of letters in pixels, and how wide one is at most.
const LETTERS: [f64; 2] = [10.0, 14.0];
const WIDTH_OF_A_LETTER: f64 = 0.58;

/// A node: a state, a signal that drives states, or, beside a single state, an unknown constant or an input.
struct Node {
    /// None of an input, whose vector field has no symbol.
    symbol: Option<Symbol>,
    name: String,
    is_signal: bool,
}

impl Node {
    /// The letter and the index by which it is shown.
    fn label(&self, system: &System) -> (String, String) {
        letter_and_index(&self.name, system.looks.get(&self.name))
            .unwrap_or_else(|| (self.name.clone(), String::new()))
    }

    /// How many letters wide its label is; those of an index are smaller.
    fn letters(&self, system: &System) -> f64 {
        let (letter, index) = self.label(system);
        letter.chars().count() as f64 + 0.8 * index.chars().count() as f64
    }

    /// The size of its letters: as large as a circle has room for, and never too small to be read.
    fn size(&self, system: &System) -> f64 {
        (1.7 * RADIUS / (WIDTH_OF_A_LETTER * self.letters(system).max(1.0))).clamp(LETTERS[0], LETTERS[1])
    }

    /// Pixels that its label takes.
    fn width(&self, system: &System) -> f64 {
        self.letters(system) * self.size(system) * WIDTH_OF_A_LETTER
    }
}

/// The nodes of a system: states that move, and signals; of a single state its unknown constants and inputs too, so that there is something to see.
fn nodes_of(system: &System, ground: DiagramGround) -> Vec<Node> {
    let node = |symbol: Symbol, is_signal: bool| Node {
        symbol: Some(symbol),
        name: system.symbol_name(symbol).to_owned(),
        is_signal,
    };
    let of_first = |symbol: &Symbol| !system.symbol_name(*symbol).contains(['@', '\'']);
    let moving: BTreeSet<Symbol> = rates(system).map(|(symbol, _)| symbol).collect();
    let signals: BTreeSet<Symbol> =
        system.signal_chains().iter().filter_map(|chain| chain.first().copied()).collect();
    let own = || system.states.iter().copied().filter(of_first);
    let states = own().filter(|symbol| moving.contains(symbol) && !signals.contains(symbol));
    let mut nodes: Vec<Node> = states.map(|symbol| node(symbol, false)).collect();
    if nodes.len() == 1 && ground == DiagramGround::Alone {
        let constants = own().filter(|symbol| system.unknown_kind(*symbol) == Some(UnknownKind::Parameter));
        nodes.extend(constants.map(|symbol| node(symbol, false)));
        let inputs = system.fields.iter().filter(|field| field.role == Role::Input);
        let inputs = inputs.filter(|field| !field.name.ends_with('\''));
        nodes.extend(inputs.map(|field| Node { symbol: None, name: field.name.clone(), is_signal: true }));
    }
    nodes.extend(own().filter(|symbol| signals.contains(symbol)).map(|symbol| node(symbol, true)));
    nodes
}

/// The diagram as SVG, with what was found of the unknowns. None where there are no states that move, or too many of them.
pub fn structure_picture(
    system: &System,
    found: Option<&BranchAnswer>,
    ground: DiagramGround,
) -> Option<String> {
    let nodes = nodes_of(system, ground);
    // beside the mathematics of a page one state alone shows nothing
    let least = if ground == DiagramGround::Page { 2 } else { 1 };
    if nodes.iter().filter(|node| !node.is_signal).count() < least || nodes.len() > MOST_NODES {
        return None;
    }
    let place = |symbol: Symbol| nodes.iter().position(|node| node.symbol == Some(symbol));
    let mut arrows: BTreeSet<(usize, usize)> = BTreeSet::new();
    for (symbol, rate) in rates(system) {
        let Some(from) = place(symbol).filter(|from| !nodes[*from].is_signal) else { continue };
        let mentioned = system.graph.symbols_of([rate]);
        arrows.extend(mentioned.into_iter().filter_map(place).filter(|to| *to != from).map(|to| (from, to)));
    }
    for field in system.fields.iter().filter(|field| field.role == Role::Input) {
        let Some(to) = nodes.iter().position(|node| node.symbol.is_none() && node.name == field.name) else {
            continue;
        };
        arrows.extend(field.components.iter().filter_map(|(symbol, _)| Some((place(*symbol)?, to))));
    }
    let measured: BTreeSet<Symbol> =
        system.graph.symbols_of(system.outputs.iter().map(|(_, node)| *node)).into_iter().collect();
    let order = ordered(nodes.len(), &arrows);
    // names that are wider than a circle need room beside each other, and at the edges
    let widest = nodes.iter().map(|node| node.width(system)).fold(0.0, f64::max);
    let apart = (3.0 * RADIUS).max(widest + 10.0);
    let circle = match nodes.len() {
        1 => 0.0,
        several => (several as f64 * apart / std::f64::consts::TAU).max(0.7 * apart),
    };
    let size = 2.0 * (circle + RADIUS + MARGIN.max(widest / 2.0 - RADIUS + 4.0));
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
        let fill = if node.is_signal { "#7c5cbf" } else { colour(found, &node.name) };
        if node.symbol.is_some_and(|symbol| measured.contains(&symbol)) {
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
        let (letter, index) = node.label(system);
        let font = node.size(system);
        let below = match index.is_empty() {
            true => String::new(),
            false => {
                format!("<tspan dy=\"{:.1}\" font-size=\"80%\">{}</tspan>", 0.25 * font, escaped(&index))
            }
        };
        let _ = write!(
            out,
            "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{font:.1}\" fill=\"currentColor\">{}{below}<title>{}</title></text>",
            y + 0.35 * font,
            escaped(&letter),
            escaped(&node.name)
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

    /// A name of several letters is a letter with an index; a word has its room.
    #[test]
    fn names_are_symbols() {
        let picture = drawn(
            "system \"s\" state Fyf, biomass_concentration drift f Fyf' = biomass_concentration biomass_concentration' = 0 output Fyf",
        )
        .unwrap();
        assert!(picture.contains(">F<tspan dy=") && picture.contains(">yf</tspan>"), "{picture}");
        assert!(picture.contains(">biomass<tspan") && !picture.contains('\u{2026}'), "{picture}");
        let size = picture.split("viewBox=\"0 0 ").nth(1).unwrap().split(' ').next().unwrap();
        assert!(size.parse::<f64>().unwrap() > 250.0, "{size}");
    }

    /// Of one state, of states that nothing moves and of more than can be made out there is none.
    #[test]
    fn what_has_no_diagram() {
        assert_eq!(drawn("system \"one\" state x drift f x' = -x output x"), None);
        let many =
            "system \"many\" state x[1..25] drift f x[i]' = x[i + 1] for i in 1..24 x[25]' = 0 output x[1]";
        assert_eq!(drawn(many), None);
        // in a file of its own it has its constants and inputs beside it
        let one: System = "system \"one\" state x param k unknown drift f x' = -k*x input g x' = 1 output x"
            .parse()
            .unwrap();
        let picture = structure_picture(&one, None, DiagramGround::Alone).unwrap();
        assert_eq!(
            (picture.matches("r=\"17\"").count(), picture.matches("<rect").count()),
            (2, 2),
            "{picture}"
        );
        assert_eq!(picture.matches('Q').count(), 2, "{picture}");
        let rests: System = "system \"rests\" state x, y output x".parse().unwrap();
        assert_eq!(structure_picture(&rests, None, DiagramGround::Page), None);
    }
}
