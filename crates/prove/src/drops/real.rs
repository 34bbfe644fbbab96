//! A state of a case in exact numbers.

use super::algebra::Algebra;
use super::case::{Case, Relation};
use super::cover::NamedSet;
use super::explore::Search;
use super::factors::places;
use dashu::rational::RBig;
use palmistry_math::expression::{Guard, Need, NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::polynomial::Polynomial;
use palmistry_math::number::real_roots::{common, rational_zeros, real_roots, square_free, zeros_of};
use palmistry_math::number::{Arithmetic, Rationals, rational_to_f64};
use palmistry_rank::observability::{Coordinate, NamedCoordinate, State, WrittenState};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// So many states are tried.
const ATTEMPTS: u64 = 80;
/// The length to which exact values may grow.
const BITS: usize = 1 << 14;

/// A state of a case at which the rows exist and which lies in none of some sets, exactly. `None` where none was found: that
/// says nothing.
pub(super) fn state_on(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    case: &Case,
    off: &[NamedSet],
) -> Option<State> {
    let frame = Frame::of(algebra, search, case, off)?;
    let mut rng = ChaCha8Rng::seed_from_u64(0x0073_7461_7465); // any fixed seed
    for attempt in 0..ATTEMPTS {
        let mut values = frame.draw(algebra, case, attempt, &mut rng);
        if solved(algebra, &case.relations, &mut values, &mut rng).is_none() {
            continue;
        }
        let nodes: Vec<NodeId> = frame.solved.iter().map(|(_, node)| *node).collect();
        let Some(found) = at(algebra, &nodes, &values) else { continue };
        values.extend(frame.solved.iter().map(|(symbol, _)| *symbol).zip(found));
        if !meets(algebra, case, &values) {
            continue;
        }
        let Some(state) = in_the_file(algebra, case, values) else { continue };
        if is_inside(algebra, search, &state, off) == Some(true) {
            return Some(state);
        }
    }
    None
}

/// Whether a case whose one unsolved equation has no rational solution has real points: at rational values of all else that equation
/// has a real zero at which nothing vanishes that must not. `false` where that was not found, which says nothing.
pub(super) fn has_real_points(algebra: &mut Algebra<'_>, search: &Search<'_>, case: &Case) -> bool {
    real_point(algebra, search, case).is_some()
}

/// Values of all symbols of a case but one, and the equation for that one.
struct RealPoint {
    free: BTreeMap<Symbol, RBig>,
    solved: Vec<(Symbol, NodeId)>,
    place: usize,
    equation: Vec<RBig>,
}

fn real_point(algebra: &mut Algebra<'_>, search: &Search<'_>, case: &Case) -> Option<RealPoint> {
    let ([relation], true) =
        (case.relations.as_slice(), search.guards.is_empty() && case.positive.is_empty())
    else {
        return None;
    };
    let frame = Frame::of(algebra, search, case, &[])?;
    let mut rng = ChaCha8Rng::seed_from_u64(0x7265_616c); // any fixed seed
    (0..ATTEMPTS).find_map(|attempt| {
        let free = frame.draw(algebra, case, attempt, &mut rng);
        let equation = in_one_variable(algebra, &relation.polynomial, relation.place, &free)?;
        let exists = zeros_of(&equation) > 0
            && case.nonzero.iter().all(|factor| {
                let factor = in_one_variable(algebra, factor, relation.place, &free);
                factor.is_some_and(|factor| common(&equation, &factor).len() == 1)
            });
        exists.then(|| RealPoint { free, solved: frame.solved.clone(), place: relation.place, equation })
    })
}

/// A real point of a case as a state in words, where that one number is irrational and all others are drawn.
pub(super) fn irrational_state(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    case: &Case,
) -> Option<WrittenState> {
    let RealPoint { free, solved, place, equation } = real_point(algebra, search, case)?;
    let symbol = algebra.symbol_at(place)?;
    // an angle is not the number that stands for it, and what follows from an irrational number has no short name
    let is_plain = |symbol: Symbol| !algebra.tangents.values().any(|tangent| *tangent == symbol);
    let is_as_in_the_file = case.chart.is_empty() && algebra.coordinates.changed.is_empty();
    if !solved.is_empty()
        || !is_as_in_the_file
        || !is_plain(symbol)
        || !free.keys().all(|symbol| is_plain(*symbol))
    {
        return None;
    }
    let name = |symbol: Symbol| algebra.system.symbol_name(symbol).to_owned();
    let mut root = real_roots(&equation).into_iter().next()?;
    let simple = square_free(&equation);
    root.narrow(&simple);
    let mut state: BTreeMap<Symbol, (String, f64)> =
        free.iter().map(|(symbol, value)| (*symbol, (value.to_string(), rational_to_f64(value)))).collect();
    state.insert(symbol, (root.text(&name(symbol), &simple), root.near()));
    Some(
        state
            .into_iter()
            .map(|(symbol, (exact, value))| NamedCoordinate { name: name(symbol), exact, value })
            .collect(),
    )
}

/// What is drawn for a case, and what follows from it.
struct Frame {
    free: Vec<Symbol>,
    solved: Vec<(Symbol, NodeId)>,
}

impl Frame {
    fn of(algebra: &mut Algebra<'_>, search: &Search<'_>, case: &Case, off: &[NamedSet]) -> Option<Frame> {
        if !case.is_met() {
            return None;
        }
        let mut all: Vec<NodeId> = search.rows.rows.iter().flatten().copied().collect();
        all.extend(search.guards.iter().map(|guard| guard.node));
        all.extend(off.iter().flat_map(NamedSet::mentioned));
        let everything = algebra.in_chart(&case.chart, &all);
        let mut free = algebra.system.graph.symbols_of(everything);
        free.extend(algebra.system.graph.symbols_of(case.values.values().copied()));
        let polynomials = case.relations.iter().map(|relation| &relation.polynomial);
        for polynomial in polynomials.chain(&case.nonzero) {
            free.extend(places(polynomial).into_iter().filter_map(|place| algebra.symbol_at(place)));
        }
        let related: Option<Vec<Symbol>> =
            case.relations.iter().map(|relation| algebra.symbol_at(relation.place)).collect();
        let related = related?;
        free.retain(|symbol| !case.values.contains_key(symbol) && !related.contains(symbol));
        free.sort_unstable();
        free.dedup();
        let mut solved: Vec<(Symbol, NodeId)> = case.values.iter().map(|(s, v)| (*s, *v)).collect();
        solved.sort_unstable();
        Some(Frame { free, solved })
    }

    fn draw(
        &self,
        algebra: &Algebra<'_>,
        case: &Case,
        attempt: u64,
        rng: &mut ChaCha8Rng,
    ) -> BTreeMap<Symbol, RBig> {
        let mut values = BTreeMap::new();
        for symbol in &self.free {
            // on a circle, and on much else, few rational points are simple: those of right triangles, and zero
            let value = match case.relations.is_empty() || rng.random_range(0..3u8) == 0 {
                true => drawn(algebra, *symbol, attempt, rng),
                false => {
                    let (top, bottom) = SPECIAL[rng.random_range(0..SPECIAL.len())];
                    RBig::from(top) / RBig::from(bottom)
                }
            };
            values.insert(*symbol, value);
        }
        values
    }
}

/// Values at which equations that are linear in nothing often have rational solutions.
const SPECIAL: [(i64, i64); 14] = [
    (0, 1),
    (1, 1),
    (-1, 1),
    (2, 1),
    (-2, 1),
    (3, 1),
    (4, 1),
    (1, 2),
    (3, 5),
    (4, 5),
    (-3, 5),
    (5, 13),
    (12, 13),
    (1, 3),
];

/// Puts rational solutions of equations that were not solved beside the values, each for its own variable.
fn solved(
    algebra: &mut Algebra<'_>,
    relations: &[Relation],
    values: &mut BTreeMap<Symbol, RBig>,
    rng: &mut ChaCha8Rng,
) -> Option<()> {
    let mut open: Vec<&Relation> = relations.iter().collect();
    while !open.is_empty() {
        // one that mentions no other's variable
        let at = open.iter().position(|relation| {
            let mut others = open.iter().filter(|other| other.place != relation.place);
            others.all(|other| relation.polynomial.degree_in(other.place) == 0)
        })?;
        let relation = open.remove(at);
        let equation = in_one_variable(algebra, &relation.polynomial, relation.place, values)?;
        let found = rational_zeros(&equation);
        if found.is_empty() {
            return None;
        }
        let root = found[rng.random_range(0..found.len())].clone();
        values.insert(algebra.symbol_at(relation.place)?, root);
    }
    Some(())
}

/// A polynomial in one variable at values of all others, constant first, the last one not zero.
fn in_one_variable(
    algebra: &mut Algebra<'_>,
    polynomial: &Polynomial,
    place: usize,
    values: &BTreeMap<Symbol, RBig>,
) -> Option<Vec<RBig>> {
    let mut found = vec![RBig::ZERO; usize::from(polynomial.degree_in(place)) + 1];
    for (power, part) in polynomial.coefficients_in(place) {
        let node = algebra.exactly(&part);
        found[usize::from(power)] = at(algebra, &[node], values)?.pop()?;
    }
    while found.last().is_some_and(RBig::is_zero) {
        found.pop();
    }
    Some(found)
}

/// Whether what must not vanish does not, and what must be positive is, as far as it can be computed exactly.
fn meets(algebra: &mut Algebra<'_>, case: &Case, values: &BTreeMap<Symbol, RBig>) -> bool {
    let zero = case.nonzero.iter().map(|factor| (factor, Need::NotZero));
    let needs: Vec<(NodeId, Need)> = zero
        .chain(case.positive.iter().map(|factor| (factor, Need::Positive)))
        .map(|(factor, need)| (algebra.exactly(factor), need))
        .collect();
    let nodes: Vec<NodeId> = needs.iter().map(|(node, _)| *node).collect();
    if let Some(found) = at(algebra, &nodes, values) {
        return needs.iter().zip(&found).all(|((_, need), value)| need.is_met_by(value));
    }
    // one by one, since one that has no exact value hides all others
    needs.iter().all(|(node, need)| {
        at(algebra, &[*node], values).is_none_or(|found| found.iter().all(|value| need.is_met_by(value)))
    })
}

/// A simple number, within the range that the file gives where it gives one.
fn drawn(algebra: &Algebra<'_>, symbol: Symbol, attempt: u64, rng: &mut ChaCha8Rng) -> RBig {
    let simple = RBig::from(rng.random_range(1..=12i64)) / RBig::from(rng.random_range(1..=4i64));
    let sign = if attempt % 2 == 1 && rng.random_range(0..3u8) == 0 { -RBig::ONE } else { RBig::ONE };
    match algebra.system.symbol_info(symbol) {
        Some(info) if attempt < ATTEMPTS / 2 => match (&info.range, &info.default) {
            (Some(range), _) => {
                let part = RBig::from(rng.random_range(1..=15i64)) / RBig::from(16);
                &range.low + (&range.high - &range.low) * part
            }
            (None, Some(value)) if attempt < ATTEMPTS / 4 => value.clone(),
            _ => simple * sign,
        },
        _ => simple * sign,
    }
}

/// Expressions of plain symbols at rational values.
fn at(algebra: &Algebra<'_>, nodes: &[NodeId], values: &BTreeMap<Symbol, RBig>) -> Option<Vec<RBig>> {
    let program = Program::plain(&algebra.system.graph, nodes);
    let exact = Rationals { bits: BITS };
    let mut inputs = Vec::new();
    for input in program.inputs() {
        inputs.push(exact.rational(values.get(&input.symbol()?)?).ok()?);
    }
    program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok()
}

/// The values of a chart's symbols as a state of the file.
fn in_the_file(algebra: &mut Algebra<'_>, case: &Case, values: BTreeMap<Symbol, RBig>) -> Option<State> {
    let changed = algebra.coordinates.changed.clone();
    let olds: Vec<NodeId> = changed.iter().map(|(old, ..)| algebra.coordinates.values[old]).collect();
    let olds = algebra.in_chart(&case.chart, &olds);
    let found = at(algebra, &olds, &values)?;
    let mut state = State::default();
    for (symbol, value) in values {
        let angle = algebra.tangents.iter().find(|(_, tangent)| **tangent == symbol).map(|(angle, _)| *angle);
        if let Some(angle) = angle {
            state.values.insert(angle, Coordinate::from_half_tangent(&value));
        } else if !changed.iter().any(|(_, new, _)| *new == symbol) {
            state.values.insert(symbol, Coordinate::Number(value));
        }
    }
    for ((old, ..), value) in changed.iter().zip(found) {
        state.values.insert(*old, Coordinate::Number(value));
    }
    for angle in &case.chart {
        state.values.insert(*angle, Coordinate::Angle { sine: RBig::ZERO, cosine: -RBig::ONE });
    }
    // what no row mentions may be anything
    for symbol in algebra.system.states.clone() {
        let anything = match algebra.tangents.contains_key(&symbol) || algebra.system.is_angle(symbol) {
            true => Coordinate::from_half_tangent(&(RBig::ONE / RBig::from(2))),
            false => Coordinate::Number(RBig::ONE),
        };
        state.values.entry(symbol).or_insert(anything);
    }
    Some(state)
}

/// Whether all guards hold at a state, and it lies in none of some sets.
fn is_inside(
    algebra: &mut Algebra<'_>,
    search: &Search<'_>,
    state: &State,
    off: &[NamedSet],
) -> Option<bool> {
    let nodes: Vec<NodeId> = search.guards.iter().map(|guard| guard.node).collect();
    let values = exact_values(algebra, &nodes, state)?;
    if !search.guards.iter().zip(&values).all(|(guard, value)| guard.need.is_met_by(value)) {
        return Some(false);
    }
    for set in off {
        // where its equations do not exist it is not
        if all_hold(algebra, &set.guards, state)?
            && exact_values(algebra, &set.vanishing, state)?.iter().all(RBig::is_zero)
        {
            return Some(false);
        }
    }
    Some(true)
}

fn all_hold(algebra: &mut Algebra<'_>, guards: &[Guard], state: &State) -> Option<bool> {
    for guard in guards {
        let value = exact_values(algebra, &[guard.node], state)?.pop()?;
        if !guard.need.is_met_by(&value) {
            return Some(false);
        }
    }
    Some(true)
}

/// Expressions of the file at a state.
pub(super) fn exact_values(algebra: &mut Algebra<'_>, nodes: &[NodeId], state: &State) -> Option<Vec<RBig>> {
    let tangents = &algebra.tangents;
    let is_angle = |symbol: Symbol| tangents.contains_key(&symbol);
    let expanded = expand_angles(&mut algebra.system.graph, nodes, is_angle);
    let program = Program::new(&algebra.system.graph, &expanded, is_angle);
    let exact = Rationals { bits: BITS };
    let inputs = state.inputs(&program, &exact).ok()?;
    program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok()
}
