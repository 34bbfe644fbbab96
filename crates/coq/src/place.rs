//! A state in exact numbers at which two sides have values, or differ. It is searched for here and checked there: Coq calculates both
//! sides at it (`proofs/coq/Point.v`).

use dashu::base::BitTest;
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Graph, Guard, Node, NodeId, Symbol};
use palmistry_math::number::Function;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// So many states are tried.
const TRIES: u64 = 60;
/// Coq goes through a term as often as it is met: no more than so many parts.
const LARGEST: u64 = 2_000_000;
/// Nor into terms that are nested more deeply.
pub(crate) const DEEPEST: u64 = 1000;
/// No longer number is a value: powers of powers have few parts.
const MOST_BITS: usize = 100_000;
/// The values that are tried, in this order from a place that hangs on the symbol.
const VALUES: [(i32, u32); 13] = [
    (1, 1),
    (2, 1),
    (3, 1),
    (1, 2),
    (5, 1),
    (3, 2),
    (-1, 1),
    (2, 3),
    (-2, 1),
    (7, 1),
    (-1, 3),
    (4, 1),
    (-3, 2),
];

/// A number, or an angle by the tangent of its half.
#[derive(Clone, PartialEq)]
pub(crate) enum Coordinate {
    Number(RBig),
    Angle(RBig),
}

/// What is compared, entry by entry, and under what.
pub(crate) struct Compared {
    pub left: Vec<NodeId>,
    pub right: Vec<NodeId>,
    pub conditions: Vec<(NodeId, Relation, NodeId)>,
    /// What has to hold for all of it to have values: the graph has left out what falls out of sums and products.
    pub guards: Vec<Guard>,
}

/// A state, and the first entry that differs there.
pub(crate) struct Found {
    pub state: Vec<(Symbol, Coordinate)>,
    pub differs: Option<usize>,
}

/// Coordinates of a state.
pub(crate) type State = Vec<(Symbol, Coordinate)>;

/// A state that meets the conditions and at which all entries have values; where one has to differ, such a state.
/// `named` are the variables of what is printed.
pub(crate) fn place(
    system: &System,
    compared: &Compared,
    named: &BTreeSet<Symbol>,
    has_to_differ: bool,
) -> Option<Found> {
    let ask = |values: &mut Values<'_>| {
        let mut differs = None;
        for (entry, (left, right)) in compared.left.iter().zip(&compared.right).enumerate() {
            match (values.of(*left), values.of(*right)) {
                (Some(left), Some(right)) if left != right => differs = differs.or(Some(entry)),
                (Some(_), Some(_)) => (),
                // one entry that differs is enough
                _ if has_to_differ => (),
                _ => return None,
            }
        }
        (differs.is_some() || !has_to_differ).then_some(differs)
    };
    let (state, differs) = search(system, compared, named, TRIES, ask)?;
    Some(Found { state, differs })
}

/// The first state that meets the conditions and of which what is asked of its values has an answer, among so many.
pub(crate) fn search<T>(
    system: &System,
    compared: &Compared,
    named: &BTreeSet<Symbol>,
    tries: u64,
    mut ask: impl FnMut(&mut Values<'_>) -> Option<T>,
) -> Option<(State, T)> {
    let graph = &system.graph;
    let nodes: Vec<NodeId> = compared
        .left
        .iter()
        .chain(&compared.right)
        .copied()
        .chain(compared.conditions.iter().flat_map(|(left, _, right)| [*left, *right]))
        .chain(compared.guards.iter().map(|guard| guard.node))
        .collect();
    let Extent { parts, depth } = extent(graph, &nodes);
    if parts > LARGEST || depth > DEEPEST {
        return None;
    }
    let mut symbols = named.clone();
    symbols.extend(graph.symbols_of(nodes.iter().copied()));
    let mut angles = angles(graph, &nodes);
    angles.extend(symbols.iter().copied().filter(|symbol| system.is_angle(*symbol)));
    (0..tries).find_map(|attempt| {
        let mut state: BTreeMap<Symbol, Coordinate> = BTreeMap::new();
        for (symbol, number) in symbols.iter().zip(0u64..) {
            // neighbours differ, and the first tries are all positive
            let place = (number * (attempt + 1) + attempt * attempt / 3) % VALUES.len() as u64;
            let (above, below) = VALUES[place as usize];
            let above = if attempt % 2 == 0 { above.abs() } else { above };
            let value = RBig::from_parts(IBig::from(above), below.into());
            let is_angle = angles.contains(symbol);
            state
                .insert(*symbol, if is_angle { Coordinate::Angle(value) } else { Coordinate::Number(value) });
        }
        for _ in 0..compared.conditions.len() {
            give(graph, &mut state, &compared.conditions);
        }
        let mut values = Values { graph, state: &state, known: HashMap::new(), exist: HashMap::new() };
        let is_met = compared.conditions.iter().all(|(left, relation, right)| {
            let (Some(left), Some(right)) = (values.of(*left), values.of(*right)) else { return false };
            match relation {
                Relation::Equal => left == right,
                Relation::NotEqual => left != right,
                Relation::Less => left < right,
                Relation::AtMost => left <= right,
                Relation::Greater => left > right,
                Relation::AtLeast => left >= right,
            }
        });
        let exists = |guard: &Guard| values.of(guard.node).is_some_and(|value| guard.need.is_met_by(&value));
        if !is_met || !compared.guards.iter().all(exists) {
            return None;
        }
        let answer = ask(&mut values)?;
        Some((state.into_iter().collect(), answer))
    })
}

/// Values that conditions give are put in; as the library has it, of two variables the first is given.
fn give(graph: &Graph, state: &mut BTreeMap<Symbol, Coordinate>, conditions: &[(NodeId, Relation, NodeId)]) {
    for (left, relation, right) in conditions {
        if *relation != Relation::Equal {
            continue;
        }
        let symbol = |node: NodeId| graph.as_symbol(node);
        let pair = symbol(*left).map(|name| (name, *right)).or(symbol(*right).map(|name| (name, *left)));
        let found = match pair {
            Some((name, value)) => {
                let mut values = Values { graph, state, known: HashMap::new(), exist: HashMap::new() };
                let given = match values.state.get(&name) {
                    Some(Coordinate::Angle(_)) => values.circular(value).and_then(|(sine, cosine)| {
                        let below = RBig::ONE + cosine;
                        (!below.is_zero()).then(|| Coordinate::Angle(sine / below))
                    }),
                    _ => values.of(value).map(Coordinate::Number),
                };
                given.map(|given| (name, given))
            }
            None => turned(graph, state, *left, *right)
                .or_else(|| turned(graph, state, *right, *left))
                .or_else(|| root(graph, state, conditions, [*left, *right])),
        };
        state.extend(found);
    }
}

/// A number with which two sides are equal that are affine in it: of the one that the fewest other conditions name.
fn root(
    graph: &Graph,
    state: &mut BTreeMap<Symbol, Coordinate>,
    conditions: &[(NodeId, Relation, NodeId)],
    [left, right]: [NodeId; 2],
) -> Option<(Symbol, Coordinate)> {
    let named: Vec<Vec<Symbol>> =
        conditions.iter().map(|(left, _, right)| graph.symbols_of([*left, *right])).collect();
    let mut candidates = graph.symbols_of([left, right]);
    candidates.retain(|symbol| matches!(state.get(symbol), Some(Coordinate::Number(_))));
    candidates.sort_by_key(|symbol| (named.iter().filter(|of| of.contains(symbol)).count(), *symbol));
    candidates.into_iter().find_map(|symbol| {
        let before = state.get(&symbol).cloned()?;
        let at = [0, 1, 2].map(|value| {
            state.insert(symbol, Coordinate::Number(value.into()));
            let mut values = Values { graph, state, known: HashMap::new(), exist: HashMap::new() };
            Some(values.of(left)? - values.of(right)?)
        });
        state.insert(symbol, before);
        let [Some(at_0), Some(at_1), Some(at_2)] = at else { return None };
        let slope = at_1 - &at_0;
        let is_affine = at_2 - &at_0 == RBig::from(2) * &slope;
        (is_affine && !slope.is_zero()).then(|| (symbol, Coordinate::Number(-at_0 / slope)))
    })
}

/// An angle by the tangent of its half at which a sine or a cosine vanishes: `sin(a)`, `cos(a)`, `sin(a + b)`, `sin(a - b)`.
fn turned(
    graph: &Graph,
    state: &BTreeMap<Symbol, Coordinate>,
    turn: NodeId,
    zero: NodeId,
) -> Option<(Symbol, Coordinate)> {
    graph.constant_value(zero).filter(|value| value.is_zero())?;
    let Node::Apply(function @ (Function::Sin | Function::Cos), of) = graph.node(turn) else { return None };
    let half = |symbol: Symbol| match state.get(&symbol) {
        Some(Coordinate::Angle(half)) => Some(half.clone()),
        _ => None,
    };
    let (symbol, half) = match (graph.node(of), function) {
        (Node::Symbol(symbol), Function::Sin) => (symbol, RBig::ZERO),
        (Node::Symbol(symbol), _) => (symbol, RBig::ONE),
        (Node::Add(a, b), Function::Sin) => (graph.as_symbol(a)?, -half(graph.as_symbol(b)?)?),
        (Node::Sub(a, b), Function::Sin) => (graph.as_symbol(a)?, half(graph.as_symbol(b)?)?),
        _ => return None,
    };
    Some((symbol, Coordinate::Angle(half)))
}

/// How much there is of some terms that are written out.
pub(crate) struct Extent {
    pub parts: u64,
    pub depth: u64,
}

/// How much there is of some terms that are written out, without going down into them.
pub(crate) fn extent(graph: &Graph, nodes: &[NodeId]) -> Extent {
    let (mut open, mut met) = (nodes.to_vec(), BTreeSet::new());
    while let Some(id) = open.pop() {
        if met.insert(id) {
            open.extend(graph.node(id).operands());
        }
    }
    // a node comes after those that it needs
    let mut known: HashMap<NodeId, (u64, u64)> = HashMap::new();
    for id in met {
        let of = graph.node(id).operands().filter_map(|part| known.get(&part));
        let found = of.fold((1u64, 1), |(parts, depth), (more, below)| {
            (parts.saturating_add(*more), depth.max(below + 1))
        });
        known.insert(id, found);
    }
    let all = nodes.iter().filter_map(|node| known.get(node));
    let (parts, depth) =
        all.fold((0u64, 0), |(parts, depth), (more, below)| (parts.saturating_add(*more), depth.max(*below)));
    Extent { parts, depth }
}

/// The symbols within sines and cosines.
fn angles(graph: &Graph, nodes: &[NodeId]) -> BTreeSet<Symbol> {
    let (mut open, mut met, mut found) = (nodes.to_vec(), BTreeSet::new(), BTreeSet::new());
    while let Some(id) = open.pop() {
        if !met.insert(id) {
            continue;
        }
        let node = graph.node(id);
        if let Node::Apply(Function::Sin | Function::Cos, of) = node {
            found.extend(graph.symbols_of([of]));
        }
        open.extend(node.operands());
    }
    found
}

/// How long a number is.
fn bits(value: &RBig) -> usize {
    value.numerator().bit_len() + value.denominator().bit_len()
}

/// Values at a state, each calculated once.
pub(crate) struct Values<'a> {
    graph: &'a Graph,
    state: &'a BTreeMap<Symbol, Coordinate>,
    known: HashMap<NodeId, Option<RBig>>,
    /// Of each whether it has a value, calculated or not.
    exist: HashMap<NodeId, bool>,
}

impl Values<'_> {
    /// Whether a term has a value and derivatives there, also one that is not calculated, such as an angle; as the library has it
    /// (`is_smooth_at`).
    pub fn exists(&mut self, id: NodeId) -> bool {
        if let Some(known) = self.exist.get(&id) {
            return *known;
        }
        let node = self.graph.node(id);
        let own = match node {
            Node::Div(_, below) => self.of(below).is_some_and(|value| !value.is_zero()),
            Node::Power(base, ..0) => self.of(base).is_some_and(|value| !value.is_zero()),
            Node::Apply(Function::Sin | Function::Cos | Function::Exp | Function::Atan, _) => true,
            Node::Apply(Function::Sqrt | Function::Log, of) => {
                self.of(of).is_some_and(|value| value > RBig::ZERO)
            }
            Node::Apply(..) => false,
            _ => true,
        };
        let found = own && node.operands().all(|part| self.exists(part));
        self.exist.insert(id, found);
        found
    }

    pub fn of(&mut self, id: NodeId) -> Option<RBig> {
        if let Some(known) = self.known.get(&id) {
            return known.clone();
        }
        let found = self.calculated(id).filter(|value| bits(value) <= MOST_BITS);
        self.known.insert(id, found.clone());
        found
    }

    fn calculated(&mut self, id: NodeId) -> Option<RBig> {
        match self.graph.node(id) {
            Node::Constant(_) => self.graph.constant_value(id).cloned(),
            Node::Symbol(symbol) => match self.state.get(&symbol)? {
                Coordinate::Number(value) => Some(value.clone()),
                Coordinate::Angle(_) => None,
            },
            Node::Add(a, b) => Some(self.of(a)? + self.of(b)?),
            Node::Sub(a, b) => Some(self.of(a)? - self.of(b)?),
            Node::Mul(a, b) => Some(self.of(a)? * self.of(b)?),
            Node::Div(a, b) => {
                let (above, below) = (self.of(a)?, self.of(b)?);
                (!below.is_zero()).then(|| above / below)
            }
            Node::Neg(a) => Some(-self.of(a)?),
            Node::Power(a, n) => {
                let base = self.of(a)?;
                if bits(&base).saturating_mul(n.unsigned_abs() as usize) > 2 * MOST_BITS {
                    return None;
                }
                let power = base.pow(n.unsigned_abs() as isize);
                match n {
                    0.. => Some(power),
                    _ if power.is_zero() => None,
                    _ => Some(RBig::ONE / power),
                }
            }
            Node::Apply(Function::Sin, a) => self.circular(a).map(|(sine, _)| sine),
            Node::Apply(Function::Cos, a) => self.circular(a).map(|(_, cosine)| cosine),
            Node::Pi | Node::Apply(..) => None,
        }
    }

    /// Sine and cosine, of what the library can calculate them of.
    fn circular(&mut self, id: NodeId) -> Option<(RBig, RBig)> {
        let turned = |(s, c): &(RBig, RBig), (t, k): &(RBig, RBig)| (s * k + c * t, c * k - s * t);
        match self.graph.node(id) {
            Node::Constant(_) => {
                self.graph.constant_value(id).filter(|value| value.is_zero()).map(|_| (RBig::ZERO, RBig::ONE))
            }
            Node::Pi => Some((RBig::ZERO, -RBig::ONE)),
            Node::Symbol(symbol) => match self.state.get(&symbol)? {
                Coordinate::Angle(t) => {
                    let below = RBig::ONE + t * t;
                    Some((RBig::from(2) * t / &below, (RBig::ONE - t * t) / below))
                }
                Coordinate::Number(_) => None,
            },
            Node::Neg(a) => self.circular(a).map(|(sine, cosine)| (-sine, cosine)),
            Node::Add(a, b) => Some(turned(&self.circular(a)?, &self.circular(b)?)),
            Node::Sub(a, b) => {
                let ((s, c), (t, k)) = (self.circular(a)?, self.circular(b)?);
                Some(turned(&(s, c), &(-t, k)))
            }
            Node::Div(a, b) | Node::Mul(a, b) => self.multiple(id, a, b),
            _ => None,
        }
    }

    /// Of a quarter turn, and of small multiples.
    fn multiple(&mut self, id: NodeId, a: NodeId, b: NodeId) -> Option<(RBig, RBig)> {
        let number = |node: NodeId| self.graph.constant_value(node).cloned();
        let divides = matches!(self.graph.node(id), Node::Div(..));
        let (factor, angle) = match (number(a), number(b)) {
            (_, Some(value)) if divides => (RBig::ONE / value, a),
            (Some(value), _) if !divides => (value, b),
            (_, Some(value)) => (value, a),
            _ => return None,
        };
        let (angle, factor) = match self.graph.node(angle) {
            // quarter turns
            Node::Pi => (None, factor * RBig::from(2)),
            _ => (Some(angle), factor),
        };
        let count =
            factor.denominator().is_one().then(|| i32::try_from(factor.numerator().clone()).ok())??;
        let one = match angle {
            None => (RBig::ONE, RBig::ZERO),
            Some(angle) if count.abs() <= 12 => self.circular(angle)?,
            Some(_) => return None,
        };
        let mut found = (RBig::ZERO, RBig::ONE);
        let times = if angle.is_none() { count.rem_euclid(4) } else { count.abs() };
        for _ in 0..times {
            found = (&one.0 * &found.1 + &one.1 * &found.0, &one.1 * &found.1 - &one.0 * &found.0);
        }
        let back = angle.is_some() && count < 0;
        Some(if back { (-found.0, found.1) } else { found })
    }
}
