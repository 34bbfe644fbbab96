//! Branch and bound: a box on which interval arithmetic shows an inequality is done with, others are halved.
//!
//! Every bound encloses the values at all states of the box at which all terms exist, so that a box without such states
//! counts as done, as does one on which an assumption certainly fails. Where the partial derivative by a coordinate has
//! one sign the least value lies on a face; and bounds by the mean value theorem are used beside the direct ones.
//! (Neumaier, Interval Methods for Systems of Equations, 1990, chapter 5.)

use super::bounds::{Bound, Bounds};
use super::domain_intervals::WhereDefined;
use super::touch::Touch;
use dashu::rational::RBig;
use palmistry_math::expression::{
    Graph, Guard, Input, Loaded, Need, NodeId, Program, Symbol, expand_angles, gradient,
};
use palmistry_math::number::{Enclosures, Interval, rational_from_f64};
use std::collections::{BinaryHeap, HashMap};

/// Interval operations that a search may take.
const WORK: usize = 8_000_000;
/// Boxes that are kept at most.
const MOST_BOXES: usize = 200_000;
/// States that are proposed as counterexamples at most.
const MOST_STATES: usize = 60;
/// Coordinates that are narrower than this, for their size, are not halved.
const NARROW: f64 = 1e-9;
/// A box with sides of this size may hold one state at which equality is met.
const NEARLY: f64 = 1e-4;
/// Nor are those that lie beyond this.
const FAR: f64 = 1e9;
/// The bits with which a corner is looked at.
const CORNER_BITS: usize = 256;

/// A question for the search.
pub struct Question<'q> {
    /// What is to hold.
    pub goal: Guard,
    /// What may be taken to hold: inequalities.
    pub assumed: &'q [Guard],
    /// What may be taken to vanish.
    pub equations: &'q [NodeId],
    /// Where the goal's terms exist.
    pub exists: &'q [Guard],
    pub bounds: &'q Bounds,
}

/// A symbol and the interval in which its value may be chosen; one number where both are equal.
pub type Proposed = Vec<(Symbol, RBig, RBig)>;

/// What a search came to.
pub enum Found {
    /// It holds on all of the box; so many boxes were looked at, and whether it is met with equality somewhere, as exact
    /// arithmetic modulo primes has found.
    Holds { boxes: usize, touches: bool },
    /// A proposed state was taken as a counterexample.
    Fails,
    /// It is open on this part of the volume; one of the open boxes, by symbol.
    Open { share: f64, sample: Vec<(Symbol, Interval)>, boxes: usize },
}

struct Search<'q> {
    question: &'q Question<'q>,
    symbols: Vec<Symbol>,
    start: Vec<Interval>,
    /// Goal, assumptions, equations, what has to exist, partial derivatives.
    loaded: Loaded<'q, WhereDefined>,
    program: &'q Program,
    registers: Vec<Interval>,
    touch: Touch,
    touches: bool,
    work: usize,
}

#[derive(Clone)]
struct Cell {
    measure: f64,
    number: usize,
    sides: Vec<Interval>,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}
impl Eq for Cell {}
impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Cell {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.measure.total_cmp(&other.measure).then(other.number.cmp(&self.number))
    }
}

/// Searches the box that bounds describe; angles of which whole turns do not matter need none. `refutes` is shown states
/// at which the goal seems to fail, and says whether one is a counterexample.
pub fn search(
    graph: &mut Graph,
    question: &Question<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
    refutes: &mut dyn FnMut(&mut Graph, &Proposed) -> bool,
) -> Found {
    let guards = question.assumed.iter().chain(question.exists).map(|guard| guard.node);
    let mut nodes = vec![question.goal.node];
    nodes.extend(question.assumed.iter().map(|guard| guard.node));
    nodes.extend(question.equations);
    nodes.extend(question.exists.iter().map(|guard| guard.node));
    let mut symbols = graph.symbols_of(nodes.iter().copied().chain(guards));
    symbols.sort_unstable();
    let partials = gradient(graph, question.goal.node, &symbols);
    let expanded = expand_angles(graph, &nodes, is_angle);
    let circular = Program::with_unknown_functions(graph, &expanded, is_angle);
    let turns = |symbol: Symbol| {
        is_angle(symbol)
            && circular.inputs().iter().all(|input| match input {
                Input::Plain(met) => *met != symbol,
                Input::Opaque(node) => !graph.symbols_of([*node]).contains(&symbol),
                Input::Sine(_) | Input::Cosine(_) => true,
            })
    };
    let half_turn = Interval::new(-Interval::PI.high(), Interval::PI.high());
    let start: Vec<Interval> = symbols
        .iter()
        .map(|symbol| match question.bounds.get(symbol) {
            Some(range) => range.interval(),
            None if turns(*symbol) => half_turn,
            None => Interval::WHOLE,
        })
        .collect();
    let touch = Touch::new(question.goal.node, &symbols, &partials);
    nodes.extend(partials);
    let program = Program::plain(graph, &nodes);
    let Ok(loaded) = program.load(WhereDefined) else {
        return Found::Open { share: 1.0, sample: Vec::new(), boxes: 0 };
    };
    let mut search = Search {
        question,
        symbols,
        start,
        loaded,
        program: &program,
        registers: Vec::new(),
        touch,
        touches: false,
        work: 0,
    };
    search.run(graph, refutes)
}

/// What one box came to.
enum Look {
    Done,
    /// It is open: states at which the goal may fail, and how much the goal varies along each coordinate.
    Open(Vec<Proposed>, Vec<f64>),
}

impl Search<'_> {
    fn run(&mut self, graph: &mut Graph, refutes: &mut dyn FnMut(&mut Graph, &Proposed) -> bool) -> Found {
        let mut open = BinaryHeap::from([Cell { measure: 1.0, number: 0, sides: self.start.clone() }]);
        let (mut stuck, mut boxes, mut proposed) = (Vec::new(), 0, 0);
        while let Some(cell) = open.pop() {
            if self.work > WORK || open.len() > MOST_BOXES {
                stuck.push(cell);
                break;
            }
            boxes += 1;
            let weights = match self.look(graph, &cell.sides) {
                Look::Done => continue,
                Look::Open(states, weights) => {
                    for state in states {
                        proposed += 1;
                        if proposed <= MOST_STATES && refutes(graph, &state) {
                            return Found::Fails;
                        }
                    }
                    weights
                }
            };
            match self.halve(&cell, &weights) {
                Some(halves) => {
                    for (k, sides) in halves.into_iter().enumerate() {
                        open.push(Cell { measure: self.measure(&sides), number: 2 * boxes + k, sides });
                    }
                }
                None => stuck.push(cell),
            }
        }
        stuck.extend(open);
        let largest = stuck.iter().max().map(|cell| cell.sides.clone());
        match largest {
            None => Found::Holds { boxes, touches: self.touches },
            Some(sides) => {
                let share = stuck.iter().map(|cell| cell.measure).sum::<f64>().min(1.0);
                Found::Open { share, sample: self.symbols.iter().copied().zip(sides).collect(), boxes }
            }
        }
    }

    fn values(&mut self, sides: &[Interval]) -> Option<Vec<Interval>> {
        self.work += self.program.len();
        let inputs: Vec<Interval> = self
            .program
            .inputs()
            .iter()
            .map(|input| match input {
                Input::Plain(symbol) => {
                    self.symbols.binary_search(symbol).map_or(Interval::WHOLE, |place| sides[place])
                }
                _ => Interval::WHOLE,
            })
            .collect();
        self.loaded.run(&inputs, &mut self.registers).ok()
    }

    fn look(&mut self, graph: &mut Graph, sides: &[Interval]) -> Look {
        let question = self.question;
        let nothing = vec![0.0; sides.len()];
        let Some(values) = self.values(sides) else { return Look::Open(Vec::new(), nothing) };
        let (goal, rest) = (values[0], &values[1..]);
        let (assumed, rest) = rest.split_at(question.assumed.len());
        let (equations, rest) = rest.split_at(question.equations.len());
        let (exists, slopes) = rest.split_at(question.exists.len());
        let met = |guards: &[Guard], values: &[Interval]| -> Vec<Option<bool>> {
            guards.iter().zip(values).map(|(g, v)| g.need.is_met_by_interval(*v)).collect()
        };
        let (assumed, exists) = (met(question.assumed, assumed), met(question.exists, exists));
        if assumed.contains(&Some(false))
            || exists.contains(&Some(false))
            || equations.iter().any(|value| !value.contains_zero())
        {
            return Look::Done;
        }
        let need = question.goal.need;
        if need.is_met_by_interval(goal) == Some(true) {
            return Look::Done;
        }
        let slopes = slopes.to_vec();
        let weights: Vec<f64> =
            slopes.iter().zip(sides).map(|(slope, side)| slope.magnitude() * side.width()).collect();
        let mut states = Vec::new();
        let everywhere = exists.iter().all(|met| *met == Some(true));
        if everywhere
            && need != Need::NotZero
            && let Some(face) = self.on_faces(graph, sides, &slopes)
        {
            match face {
                Face::Holds => return Look::Done,
                Face::Fails(state) => states.push(state),
            }
        }
        if everywhere {
            let bounds: Vec<_> = self.symbols.iter().map(|symbol| question.bounds.get(symbol)).collect();
            let is_left_out = |place: usize, value: &RBig| {
                let ends = bounds[place].into_iter().flat_map(|range| [&range.low, &range.high]).flatten();
                ends.into_iter().any(|bound| bound.strict && bound.exact.as_ref() == Some(value))
            };
            if self.touch.holds(graph, need, sides, &is_left_out) {
                self.touches = true;
                return Look::Done;
            }
        }
        let middle: Vec<Interval> = sides.iter().map(|side| Interval::point(side.mid())).collect();
        let Some(at_middle) = self.values(&middle) else { return Look::Open(states, weights) };
        if everywhere {
            let mean = slopes
                .iter()
                .zip(sides)
                .zip(&middle)
                .fold(at_middle[0], |sum, ((slope, side), mid)| sum + *slope * (*side - *mid));
            if need.is_met_by_interval(mean) == Some(true) {
                return Look::Done;
            }
        }
        // what excludes equality may fail at a single state, and is looked for where the goal is nearly zero
        let narrow =
            need != Need::NotNegative && sides.iter().all(|s| s.width() < NEARLY * s.magnitude().max(1.0));
        let fails = narrow || need.is_met_by_interval(at_middle[0]) == Some(false);
        let may = |values: &[Interval], guards: &[Guard]| {
            guards.iter().zip(values).all(|(g, v)| g.need.is_met_by_interval(*v) != Some(false))
        };
        let first = 1 + question.assumed.len();
        let there = first + question.equations.len();
        if fails
            && question.equations.is_empty()
            && may(&at_middle[1..first], question.assumed)
            && may(&at_middle[there..there + question.exists.len()], question.exists)
            && let Some(state) = self.near(sides, &middle, narrow)
        {
            states.push(state);
        }
        Look::Open(states, weights)
    }

    /// Numbers near the middle of a box, or anywhere in it.
    fn near(&self, sides: &[Interval], middle: &[Interval], anywhere: bool) -> Option<Proposed> {
        let one = |((symbol, side), mid): ((&Symbol, &Interval), &Interval)| {
            if anywhere {
                return Some((*symbol, rational_from_f64(side.low())?, rational_from_f64(side.high())?));
            }
            let radius = (side.width() / 4.0).min(mid.magnitude().max(1.0) / 1000.0);
            let (low, high) = (mid.mid() - radius, mid.mid() + radius);
            Some((*symbol, rational_from_f64(low)?, rational_from_f64(high)?))
        };
        self.symbols.iter().zip(sides).zip(middle).map(one).collect()
    }

    /// The goal on the faces on which its least value lies, where slopes determine them.
    fn on_faces(&mut self, graph: &mut Graph, sides: &[Interval], slopes: &[Interval]) -> Option<Face> {
        let mut faces = sides.to_vec();
        let mut moved = false;
        for ((face, slope), side) in faces.iter_mut().zip(slopes).zip(sides) {
            let end = if slope.low() >= 0.0 {
                side.low()
            } else if slope.high() <= 0.0 {
                side.high()
            } else {
                continue;
            };
            if end.is_finite() && !side.is_point() {
                (*face, moved) = (Interval::point(end), true);
            }
        }
        let need = self.question.goal.need;
        if moved {
            let values = self.values(&faces)?;
            // the ends of the whole box may lie a little outside of what is assumed, where terms need not exist
            let first = 1 + self.question.assumed.len() + self.question.equations.len();
            let exists = &values[first..first + self.question.exists.len()];
            if self
                .question
                .exists
                .iter()
                .zip(exists)
                .any(|(g, v)| g.need.is_met_by_interval(*v) != Some(true))
            {
                return None;
            }
            if need.is_met_by_interval(values[0]) == Some(true) {
                return Some(Face::Holds);
            }
        }
        if !faces.iter().all(|face| face.is_point()) || faces.is_empty() {
            return None;
        }
        self.at_corner(graph, sides, &faces, slopes)
    }

    /// The goal at a corner at which it is least, exactly.
    fn at_corner(
        &self,
        graph: &mut Graph,
        sides: &[Interval],
        corner: &[Interval],
        slopes: &[Interval],
    ) -> Option<Face> {
        let (mut values, mut state) = (HashMap::new(), Proposed::new());
        let (mut left_out, mut open_end) = (false, false);
        for (place, symbol) in self.symbols.iter().enumerate() {
            let end = corner[place].low();
            let range = self.question.bounds.get(symbol);
            let is_end = |bound: &Option<Bound>, at: f64, inner: f64| {
                bound.clone().filter(|_| end == at && end == inner)
            };
            let bound = range.and_then(|range| {
                is_end(&range.low, self.start[place].low(), sides[place].low()).or(is_end(
                    &range.high,
                    self.start[place].high(),
                    sides[place].high(),
                ))
            });
            let node = match &bound {
                Some(bound) => bound.value,
                None => graph.rational(rational_from_f64(end)?),
            };
            let strict = bound.is_some_and(|bound| bound.strict);
            left_out |= strict;
            open_end |= strict && !sides[place].is_point() && !slopes[place].contains_zero();
            let exact = graph.constant_value(node).cloned();
            let value = exact.or_else(|| rational_from_f64(end))?;
            state.push((*symbol, value.clone(), value));
            values.insert(*symbol, node);
        }
        let there = graph.substitute(&[self.question.goal.node], &values)[0];
        let (low, high) = match graph.constant_value(there) {
            Some(value) => (value.clone(), value.clone()),
            None => {
                let program = Program::plain(graph, &[there]);
                let found =
                    program.load(Enclosures::new(CORNER_BITS)).ok()?.run(&[], &mut Vec::new()).ok()?;
                (found[0].low(), found[0].high())
            }
        };
        let need = self.question.goal.need;
        match need.is_met_between(&low, &high) {
            Some(true) => Some(Face::Holds),
            // the corner itself does not belong to the box, and away from it the goal grows
            Some(false) if open_end && low.is_zero() && high.is_zero() => Some(Face::Holds),
            Some(false) if !left_out && self.question.equations.is_empty() => Some(Face::Fails(state)),
            _ => None,
        }
    }

    /// The part of the whole box, unbounded sides by their angles.
    fn measure(&self, sides: &[Interval]) -> f64 {
        sides
            .iter()
            .zip(&self.start)
            .map(|(side, start)| {
                let whole = start.width();
                if start.is_point() {
                    1.0
                } else if whole.is_finite() {
                    side.width() / whole
                } else {
                    (side.high().atan() - side.low().atan()) / (start.high().atan() - start.low().atan())
                }
            })
            .product()
    }

    /// The two halves along the coordinate that makes the goal vary most.
    fn halve(&self, cell: &Cell, weights: &[f64]) -> Option<[Vec<Interval>; 2]> {
        let mut best: Option<(f64, f64, usize, f64)> = None;
        for (place, side) in cell.sides.iter().enumerate() {
            let Some(cut) = cut(*side) else { continue };
            let relative = if self.start[place].width().is_finite() {
                side.width() / self.start[place].width()
            } else {
                side.high().atan() - side.low().atan()
            };
            let weight = if side.width().is_finite() { weights[place] } else { f64::INFINITY };
            let weight = if weight.is_nan() { f64::INFINITY } else { weight };
            // a coordinate that the goal does not depend on may still decide where something exists
            if best.is_none_or(|(w, r, ..)| (weight, relative) > (w, r)) {
                best = Some((weight, relative, place, cut));
            }
        }
        let (.., place, at) = best?;
        let mut halves = [cell.sides.clone(), cell.sides.clone()];
        halves[0][place] = Interval::new(cell.sides[place].low(), at);
        halves[1][place] = Interval::new(at, cell.sides[place].high());
        Some(halves)
    }
}

enum Face {
    Holds,
    Fails(Proposed),
}

/// Where a side is cut in two.
fn cut(side: Interval) -> Option<f64> {
    let (low, high) = (side.low(), side.high());
    let at = match (low.is_finite(), high.is_finite()) {
        (true, true) => {
            let wide = side.width() > NARROW * side.magnitude().max(NARROW);
            return wide.then(|| side.mid()).filter(|mid| low < *mid && *mid < high);
        }
        (false, false) => 0.0,
        (true, false) if low < 0.0 => 0.0,
        (true, false) => (2.0 * low).max(low + 1.0),
        (false, true) if high > 0.0 => 0.0,
        (false, true) => (2.0 * high).min(high - 1.0),
    };
    (at.abs() < FAR).then_some(at)
}
