//! The terms of a statement on one branch of its conditions, and states at which to look at them.

use dashu::rational::RBig;
use palmistry_inequality::{Bound, Bounds, SymbolBounds, bounds};
use palmistry_lang::{Assignment, Kind, System};
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Guard, Need, NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::{Enclosure, Enclosures, Function, Interval, Rationals, rational_from_f64};
use palmistry_rank::observability::{Branch, Coordinate, NamedCoordinate, State, WrittenState};
use rand::{Rng, RngExt};
use std::collections::BTreeMap;

/// The first so many states have the file's values and positive numbers; later ones any.
const SIMPLE: usize = 10;
/// The precision of enclosures where there is no exact arithmetic.
const BITS: usize = 400;
/// The length to which exact values may grow.
const EXACT_BITS: usize = 1 << 16;

/// What a statement is made of: sides, and what they need to exist.
#[derive(Clone, Debug, Default)]
pub(crate) struct Terms {
    /// The entries of the left side, then those of the right.
    pub sides: Vec<NodeId>,
    /// The relation claimed between each entry of the left and that of the right; empty where all are equations.
    pub relations: Vec<Relation>,
    pub guards: Vec<Guard>,
    /// Left sides less right sides of the conditions.
    pub conditions: Vec<NodeId>,
    /// Whether the sides are one expression once names are put in.
    pub one_thing_twice: bool,
}

/// Terms with their angles expanded, as programs that a state can be put into.
struct Programs {
    sides: Program,
    guards: Program,
    conditions: Program,
}

/// The terms of a statement on a branch.
pub(crate) struct OnBranch {
    /// The branch itself.
    pub branch: Branch,
    /// As the statement has them, with the guards of the branch.
    pub statement: Terms,
    /// With the branch's values put in.
    pub terms: Terms,
    needs: Vec<Need>,
    /// As the statement has them.
    whole: Programs,
    /// With the branch's values put in.
    here: Programs,
    /// What is drawn.
    free: Vec<Symbol>,
    /// Between what, where guards say so.
    bounds: Bounds,
    /// What follows, in the order of the symbols: the value, or its sine and cosine.
    solved: Vec<(Symbol, Solved)>,
    /// Whether angles are drawn as exact points of the circle; else as numbers, in radians.
    circular: bool,
}

struct Solved {
    is_angle: bool,
    value: NodeId,
    /// For the value, or for sine and cosine.
    program: Program,
}

/// A state at which all conditions hold.
pub(crate) struct Point {
    /// What was drawn, and what follows from it exactly.
    pub state: State,
    /// What follows and has no exact number, as an expression in numbers.
    pub terms: Vec<(Symbol, NodeId)>,
}

/// What terms come to at a state.
pub(crate) enum Values {
    Exact(Vec<RBig>),
    Enclosed(Vec<Enclosure>),
}

impl OnBranch {
    /// The terms of a statement on a branch.
    ///
    /// # Errors
    /// In words, where a term distinguishes values that the conditions leave open.
    pub fn new(system: &mut System, branch: &Branch, statement: &Terms) -> Result<OnBranch, String> {
        let sides = branch.put_in(system, &statement.sides)?;
        let nodes: Vec<NodeId> = statement.guards.iter().map(|guard| guard.node).collect();
        let there = branch.put_in(system, &nodes)?;
        let needs: Vec<Need> = statement.guards.iter().map(|guard| guard.need).collect();
        let guards =
            there.iter().zip(&needs).map(|(node, need)| Guard { node: *node, need: *need }).collect();
        let relations = statement.relations.clone();
        let here = Terms { sides, relations, guards, ..Terms::default() };
        let mut solved: Vec<Symbol> = branch.values.keys().copied().collect();
        solved.sort_unstable();
        let values: Vec<NodeId> = solved.iter().map(|symbol| branch.values[symbol]).collect();
        let all = || statement.sides.iter().chain(&nodes).chain(&statement.conditions).chain(&values);
        let mut free = system.graph.symbols_of(all().copied());
        free.retain(|symbol| !branch.values.contains_key(symbol));
        // a guard may need more than sine and cosine determine, as that an angle is less than one: enclosures decide that
        let there = || statement.sides.iter().chain(&statement.conditions).chain(&values);
        let bounds = bounds(&mut system.graph, &here.guards);
        // points of the circle stand for angles between minus pi and pi
        let half_turn = Interval::new(-Interval::PI.low(), Interval::PI.low());
        let is_beyond = |(symbol, range): (&Symbol, &SymbolBounds)| {
            system.is_angle(*symbol) && !half_turn.encloses(range.interval())
        };
        let circular = !bounds.iter().any(is_beyond)
            && bare_angle(system, &there().copied().collect::<Vec<_>>()).is_none()
            && bare_angle(system, &here.sides).is_none();
        let whole = programs(system, statement, circular);
        let programs_here = programs(system, &here, circular);
        let solved = solved
            .into_iter()
            .zip(values)
            .map(|(symbol, value)| (symbol, Solved::new(system, symbol, value, circular)))
            .collect();
        Ok(OnBranch {
            branch: branch.clone(),
            statement: statement.clone(),
            terms: here,
            needs,
            whole,
            here: programs_here,
            free,
            bounds,
            solved,
            circular,
        })
    }

    /// A state of simple numbers that meets the conditions, inside the sample box where the file has one; every third
    /// one is drawn from farther.
    pub fn draw(&self, system: &mut System, attempt: usize, rng: &mut impl Rng) -> Point {
        let mut state = State::default();
        for symbol in &self.free {
            let within = self.bounds.get(symbol).and_then(|range| within(range, attempt, rng));
            let value = if let Some(value) = within {
                self.within_bounds(system, *symbol, value)
            } else if self.circular && system.is_angle(*symbol) {
                Coordinate::from_half_tangent(&half_tangent(system, *symbol, attempt, rng))
            } else {
                Coordinate::Number(number(system, *symbol, attempt, rng))
            };
            state.values.insert(*symbol, value);
        }
        self.complete(system, state)
    }

    /// A number that lies within bounds, as a coordinate.
    fn within_bounds(&self, system: &System, symbol: Symbol, value: RBig) -> Coordinate {
        if self.circular && system.is_angle(symbol) {
            let tangent = (value.to_f64().value() / 2.0).tan();
            let near = |part: f64| rational_from_f64(tangent + part * tangent.abs().max(1.0) / 1000.0);
            if let (Some(low), Some(high)) = (near(-1.0), near(1.0)) {
                return Coordinate::from_half_tangent(&RBig::simplest_in(low, high));
            }
        }
        Coordinate::Number(value)
    }

    /// The state with what the conditions give.
    pub fn complete(&self, system: &mut System, mut state: State) -> Point {
        let drawn = state.clone();
        let mut terms = Vec::new();
        for (symbol, solved) in &self.solved {
            match solved.at(&drawn) {
                Some(coordinate) => {
                    state.values.insert(*symbol, coordinate);
                }
                None => terms.push((*symbol, in_numbers(system, solved.value, &drawn))),
            }
        }
        Point { state, terms }
    }

    /// The values of all sides at a point where they exist and all conditions hold. `None` where that is not so, or not
    /// certain.
    pub fn sides(&self, point: &Point) -> Option<Values> {
        let met = if point.terms.is_empty() { self.meets_conditions(&point.state) } else { None };
        let programs = match met {
            // as the statement has them, so that nothing rests on how the conditions were solved
            Some(true) => &self.whole,
            Some(false) => return None,
            None => &self.here,
        };
        if !self.exists(&programs.guards, &point.state)? {
            return None;
        }
        values(&programs.sides, &point.state)
    }

    /// Whether all conditions hold, exactly; `None` where there is no exact arithmetic for them.
    fn meets_conditions(&self, state: &State) -> Option<bool> {
        let found = exact_values(&self.whole.conditions, state)?;
        Some(found.iter().all(RBig::is_zero))
    }

    fn exists(&self, program: &Program, state: &State) -> Option<bool> {
        Some(match values(program, state)? {
            Values::Exact(found) => found.iter().zip(&self.needs).all(|(value, need)| need.is_met_by(value)),
            Values::Enclosed(found) => found
                .iter()
                .zip(&self.needs)
                .all(|(value, need)| need.is_met_by_enclosure(value) == Some(true)),
        })
    }

    /// The symbols that the conditions leave free.
    pub fn free_symbols(&self) -> &[Symbol] {
        &self.free
    }

    /// Whether angles are drawn as exact points of the circle.
    pub fn draws_circles(&self) -> bool {
        self.circular
    }

    /// The symbols that the conditions give, with their values in terms of the others.
    pub fn solved_values(&self) -> Vec<(Symbol, NodeId)> {
        self.solved.iter().map(|(symbol, solved)| (*symbol, solved.value)).collect()
    }

    /// The point in words: every symbol that the statement or its conditions mention.
    pub fn describe(&self, system: &System, point: &Point) -> WrittenState {
        let mut all: BTreeMap<Symbol, (String, f64)> = BTreeMap::new();
        for (symbol, value) in &point.state.values {
            all.insert(*symbol, (value.exact_text(), value.to_f64()));
        }
        for (symbol, term) in &point.terms {
            let program = Program::plain(&system.graph, &[*term]);
            let near = values(&program, &State::default());
            let near = match &near {
                Some(Values::Enclosed(value)) => value[0].midpoint(),
                _ => f64::NAN,
            };
            all.insert(*symbol, (system.graph.text(*term), near));
        }
        all.into_iter()
            .map(|(symbol, (exact, value))| NamedCoordinate {
                name: system.symbol_name(symbol).to_owned(),
                exact,
                value,
            })
            .collect()
    }
}

impl Solved {
    fn new(system: &mut System, symbol: Symbol, value: NodeId, circular: bool) -> Solved {
        let is_angle = circular && system.is_angle(symbol);
        let wanted = if is_angle {
            vec![system.graph.apply(Function::Sin, value), system.graph.apply(Function::Cos, value)]
        } else {
            vec![value]
        };
        Solved { is_angle, value, program: program(system, &wanted, circular) }
    }

    fn at(&self, state: &State) -> Option<Coordinate> {
        let mut found = exact_values(&self.program, state)?.into_iter();
        Some(if self.is_angle {
            Coordinate::Angle { sine: found.next()?, cosine: found.next()? }
        } else {
            Coordinate::Number(found.next()?)
        })
    }
}

/// An expression with the numbers of a state put in.
fn in_numbers(system: &mut System, value: NodeId, state: &State) -> NodeId {
    let mut numbers = Assignment::new();
    for (symbol, coordinate) in &state.values {
        if let Coordinate::Number(value) = coordinate {
            numbers.insert(*symbol, system.graph.rational(value.clone()));
        }
    }
    system.graph.substitute(&[value], &numbers)[0]
}

fn bare_angle(system: &mut System, nodes: &[NodeId]) -> Option<Symbol> {
    program(system, nodes, true).bare_angle()
}

fn program(system: &mut System, nodes: &[NodeId], circular: bool) -> Program {
    if !circular {
        return Program::plain(&system.graph, nodes);
    }
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, nodes, is_angle);
    Program::new(&system.graph, &expanded, is_angle)
}

fn programs(system: &mut System, terms: &Terms, circular: bool) -> Programs {
    let guards: Vec<NodeId> = terms.guards.iter().map(|guard| guard.node).collect();
    Programs {
        sides: program(system, &terms.sides, circular),
        guards: program(system, &guards, circular),
        conditions: program(system, &terms.conditions, circular),
    }
}

/// The values of a program at a state, exactly where that is possible, else enclosed.
fn values(program: &Program, state: &State) -> Option<Values> {
    if let Some(values) = exact_values(program, state) {
        return Some(Values::Exact(values));
    }
    let arithmetic = Enclosures::new(BITS);
    let inputs = state.inputs(program, &arithmetic).ok()?;
    program.load(arithmetic).ok()?.run(&inputs, &mut Vec::new()).ok().map(Values::Enclosed)
}

fn exact_values(program: &Program, state: &State) -> Option<Vec<RBig>> {
    let exact = Rationals { bits: EXACT_BITS };
    let inputs = state.inputs(program, &exact).ok()?;
    program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok()
}

/// A simple number within a range, every fifth time one of its ends; mostly near the ends where it has one or none.
fn within(range: &SymbolBounds, attempt: usize, rng: &mut impl Rng) -> Option<RBig> {
    let end = |bound: &Option<Bound>, down: bool| {
        let bound = bound.as_ref()?;
        let inside = if down { bound.enclosed.high() } else { bound.enclosed.low() };
        bound.exact.clone().or_else(|| rational_from_f64(inside))
    };
    let (low, high) = (end(&range.low, true), end(&range.high, false));
    if attempt % 5 == 4 {
        let ends = [(&range.low, &low), (&range.high, &high)];
        let closed = ends.into_iter().filter(|(bound, _)| bound.as_ref().is_some_and(|bound| !bound.strict));
        let closed: Vec<RBig> = closed.filter_map(|(_, end)| end.clone()).collect();
        if !closed.is_empty() {
            return Some(closed[rng.random_range(0..closed.len())].clone());
        }
    }
    let reach = [RBig::from(3), RBig::ONE, RBig::from(10), RBig::ONE / RBig::from(4)][attempt % 4].clone()
        * RBig::from([1, 4, 40, 400][(attempt / 60).min(3)]);
    let (low, high) = match (low, high) {
        (Some(low), Some(high)) => (low, high),
        (Some(low), None) => (low.clone(), low + reach),
        (None, Some(high)) => (&high - reach, high),
        (None, None) => return None,
    };
    // halves, thirds and quarters from the start
    (low <= high).then(|| simple_between(&low, &high, attempt.max(40), rng))
}

/// The value that the file gives to a parameter, or a simple number from its range; every third time, and after some
/// failures always, any number.
fn number(system: &System, symbol: Symbol, attempt: usize, rng: &mut impl Rng) -> RBig {
    let info = system.symbol_info(symbol).filter(|info| info.kind != Kind::Imported);
    let any = |rng: &mut _| {
        let reach = match attempt {
            // now and then beyond a half turn, up to which identities of roots and principal values hold
            _ if attempt >= SIMPLE && attempt % 7 == 5 => [7, 30, 1000][attempt / 7 % 3],
            _ => [3, 3, 30, 1000][(attempt / 60).min(3)],
        };
        simple_between(&RBig::from(-reach), &RBig::from(reach), attempt, rng)
    };
    let far = attempt % 3 == 2 && attempt >= SIMPLE || attempt >= 100;
    match info.and_then(|info| info.range.as_ref()) {
        _ if far => any(rng),
        Some(range) => simple_between(&range.low, &range.high, attempt, rng),
        None if attempt < SIMPLE => match info.and_then(|info| info.default.clone()) {
            Some(default) => default,
            None => simple_between(&RBig::ONE, &RBig::from(3), attempt, rng),
        },
        None => any(rng),
    }
}

/// The tangent of half an angle: a simple number within the angle's range, and neither zero nor one, at which a sine
/// or a cosine vanishes and a calculator has nothing to check.
fn half_tangent(system: &System, symbol: Symbol, attempt: usize, rng: &mut impl Rng) -> RBig {
    let range = system.symbol_info(symbol).and_then(|info| info.range.as_ref());
    let tangent = |bound: &RBig| rational_from_f64((bound.to_f64().value() / 2.0).tan());
    let bounds = range
        .filter(|_| attempt % 3 != 2)
        .and_then(|range| Some((tangent(&range.low)?, tangent(&range.high)?)))
        .filter(|(a, b)| a < b);
    let (low, high) = bounds.unwrap_or((RBig::from(-2), RBig::from(2)));
    for _ in 0..50 {
        // halves, thirds and quarters from the start: the sines are then fractions such as 4/5 and 12/13
        let value = simple_between(&low, &high, attempt.max(40), rng);
        if !value.is_zero() && value != RBig::ONE && value != RBig::from(-1) {
            return value;
        }
    }
    RBig::simplest_in(low, high)
}

/// A rational of small numerator and denominator within a range, not zero if that can be avoided; later attempts draw
/// from finer grids.
fn simple_between(low: &RBig, high: &RBig, attempt: usize, rng: &mut impl Rng) -> RBig {
    let denominator = 1 + (attempt / 20) as i64;
    for _ in 0..20 {
        let bottom = RBig::from(rng.random_range(1..=denominator.min(12)));
        let (first, last) = ((low * &bottom).ceil(), (high * &bottom).floor());
        let (Ok(first), Ok(last)) = (i64::try_from(first), i64::try_from(last)) else { break };
        if first > last {
            continue;
        }
        let top = rng.random_range(first..=last.min(first.saturating_add(1000)));
        if top != 0 {
            return RBig::from(top) / bottom;
        }
    }
    if low == high { low.clone() } else { RBig::simplest_in(low.clone(), high.clone()) }
}
