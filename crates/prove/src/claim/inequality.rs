//! `left < right` and its kin, wherever both sides exist and the conditions hold.

use super::evidence::refutation;
use super::existence::{Existence, existence};
use super::identity::{OnOneBranch, RANDOM_PRIMES};
use super::terms::{OnBranch, Point, Values};
use super::verdict::{Verdict, Witness};
use super::witness::texts_of_sides;
use dashu::rational::RBig;
use palmistry_checker::{Doubt, Refutation};
use palmistry_inequality::{
    Argument, Given, InequalityAnswer, Irrational, IrrationalPlace, Open, Proposed, decide,
    vanishes_somewhere,
};
use palmistry_lang::System;
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{
    Guard, Input, LOG2_ERROR, Need, NodeId, Program, Related, Symbol, ZeroTest, expand_angles,
    identically_zero, zero_by_relations,
};
use palmistry_math::number::real_roots::RealRoot;
use palmistry_math::number::{
    Arithmetic, Enclosure, Enclosures, Function, rational_from_f64, rational_to_f64, round_to_decimal,
};
use palmistry_rank::observability::{Coordinate, NamedCoordinate, State, assumed};
use rand::Rng;
use std::cmp::Ordering;
use std::collections::HashMap;

/// States that are drawn before anything else is tried, and after everything has been.
const FIRST: usize = 40;
const LAST: usize = 300;
/// States between which a condition is looked for that could not be solved.
const STATES: usize = 24;

const SIGNS: &str = "exact arithmetic: the signs of factors and sums of squares";
const ZEROS: &str = "exact arithmetic: all zeros of the polynomials in one variable";
const MATRIX: &str = "exact arithmetic: the matrix of a polynomial of degree two";
const BOXES: &str = "interval arithmetic on boxes";
const EXACT: &str = "exact arithmetic at a state";
const INTERVALS: &str = "interval arithmetic at a state";

/// Decides relations that are claimed together. `is_assumed` says of each guard whether it is a condition, and not needed
/// for something to exist; `unsolved` are conditions that could not be solved, as expressions that vanish.
pub(crate) fn decide_relations(
    system: &mut System,
    on: &OnBranch,
    is_assumed: &[bool],
    unsolved: &[NodeId],
    rng: &mut impl Rng,
) -> OnOneBranch {
    let there = match existence(system, on, rng) {
        Existence::Nowhere(guard) => return OnOneBranch::Empty(guard),
        found if unsolved.is_empty() => found,
        _ => on_unsolved(system, on, unsolved, rng),
    };
    let (taken, exists): (Vec<_>, Vec<_>) =
        on.terms.guards.iter().copied().zip(is_assumed).partition(|(_, assumed)| **assumed);
    let guards = |list: Vec<(Guard, &bool)>| list.into_iter().map(|(guard, _)| guard).collect::<Vec<_>>();
    let (taken, exists) = (guards(taken), guards(exists));
    let given = Given { assumed: &taken, equations: unsolved, exists: &exists };
    let mut verdicts = Vec::new();
    for entry in 0..on.terms.relations.len() {
        let verdict = one(system, on, entry, given, rng);
        let refuted = matches!(verdict, Verdict::Refuted { .. });
        verdicts.push(verdict);
        if refuted {
            break;
        }
    }
    OnOneBranch::Verdict(Verdict::all(verdicts), there)
}

/// Whether a condition that could not be solved is met somewhere.
fn on_unsolved(system: &mut System, on: &OnBranch, unsolved: &[NodeId], rng: &mut impl Rng) -> Existence {
    let texts: Vec<String> =
        unsolved.iter().map(|node| format!("{} = 0", system.graph.text(*node))).collect();
    let not_shown = Existence::NotShown(texts.join(", "));
    let [condition] = unsolved else { return not_shown };
    let mut states = Vec::new();
    for attempt in 0..STATES {
        let point = on.draw(system, attempt, rng);
        // around the origin too: what is drawn may all lie outside of a small set
        let scale = [RBig::ZERO, RBig::ONE, RBig::ONE / RBig::from(8), RBig::from(8)][attempt % 4].clone();
        let number = |value: &Coordinate| match value {
            Coordinate::Number(value) => Some(value.clone()),
            angle => rational_from_f64(angle.to_f64()),
        };
        let values = point.state.values.iter().filter_map(|(symbol, v)| Some((*symbol, number(v)? * &scale)));
        states.push(values.collect::<HashMap<_, _>>());
    }
    match vanishes_somewhere(&mut system.graph, *condition, &on.terms.guards, &states) {
        true => Existence::Shown,
        false => not_shown,
    }
}

fn one(system: &mut System, on: &OnBranch, entry: usize, given: Given<'_>, rng: &mut impl Rng) -> Verdict {
    let solved = given.equations.is_empty();
    let relation = on.terms.relations[entry];
    let entries = on.terms.relations.len();
    let (left, right) = (on.terms.sides[entry], on.terms.sides[entry + entries]);
    let Some(goal) = assumed(&mut system.graph, relation, left, right) else {
        return Verdict::undecided("an equation among inequalities");
    };
    let mut tries = Tries { entry, relation, are_equal: false, doubt: None, found: None };
    if solved {
        for attempt in 0..FIRST {
            let point = on.draw(system, attempt, rng);
            if tries.refute(system, on, point) {
                return tries.verdict(system);
            }
        }
    }
    // both sides are one: then they are equal wherever they exist
    if let Some(verdict) = where_equal(system, on, goal, &mut tries, solved, rng) {
        return verdict;
    }
    let is_angle = &system.angle_test();
    // the search knows expressions only, and the graph is the system's
    let mut graph = std::mem::take(&mut system.graph);
    let answer = decide(&mut graph, goal, given, &is_angle, &mut |graph, proposed| {
        if !solved {
            return false;
        }
        std::mem::swap(graph, &mut system.graph);
        let refuted = on.at_proposed(system, proposed).is_some_and(|point| tries.refute(system, on, point));
        std::mem::swap(graph, &mut system.graph);
        refuted
    });
    system.graph = graph;
    let certain = |engine: String| Verdict::Proved { engine, log2_error: f64::NEG_INFINITY };
    match answer {
        InequalityAnswer::Holds(Argument::Signs) => certain(SIGNS.to_owned()),
        InequalityAnswer::Holds(Argument::Zeros) => certain(ZEROS.to_owned()),
        InequalityAnswer::Holds(Argument::Matrix) => certain(MATRIX.to_owned()),
        InequalityAnswer::Holds(Argument::Boxes { boxes, touches }) => {
            let engine = match boxes {
                1 => BOXES.replace("boxes", "the whole box"),
                _ => BOXES.replace("boxes", &format!("{boxes} boxes")),
            };
            match touches {
                false => certain(engine),
                true => Verdict::Proved {
                    engine: format!("{engine}, and derivatives where it is met with equality"),
                    log2_error: LOG2_ERROR,
                },
            }
        }
        InequalityAnswer::Fails => tries.verdict(system),
        InequalityAnswer::FailsAt(place) => at_irrational(system, on, &place, tries, rng),
        InequalityAnswer::Open(open) => {
            if solved {
                for attempt in FIRST..LAST {
                    let point = on.draw(system, attempt, rng);
                    if tries.refute(system, on, point) {
                        return tries.verdict(system);
                    }
                }
            }
            let mut why = in_words(system, &open);
            if let Some(doubt) = &tries.doubt {
                why.push_str(&format!(
                    "; a state was found at which it fails, which the checker does not confirm: {doubt}"
                ));
            }
            Verdict::undecided(why)
        }
    }
}

/// The refutation at an irrational value of a symbol. A zero of degree two is a number that the checker knows; for any other one the
/// witness gives its polynomial and an isolating interval.
fn at_irrational(
    system: &mut System,
    on: &OnBranch,
    place: &IrrationalPlace,
    mut tries: Tries,
    rng: &mut impl Rng,
) -> Verdict {
    if let Some(value) = by_an_expression(system, place) {
        let mut branch = on.branch.clone();
        for other in branch.values.values_mut() {
            let values = HashMap::from([(place.symbol, value)]);
            *other = system.graph.substitute(&[*other], &values)[0];
        }
        branch.values.insert(place.symbol, value);
        if let Ok(there) = OnBranch::new(system, &branch, &on.statement) {
            for touching in [false, true] {
                tries.are_equal = touching;
                let point = there.draw(system, 0, rng);
                if tries.refute(system, &there, point) {
                    return tries.verdict(system);
                }
            }
        }
    }
    let name = system.symbol_name(place.symbol).to_owned();
    let Irrational::Zero { polynomial, root } = &place.value else {
        return Verdict::undecided(format!(
            "it seems to fail at an angle {name} of some twelfths of pi, which the checker does not confirm"
        ));
    };
    let (value, exact) = (root.near(), root.text(&name, polynomial));
    let Some([left, right]) = sides_near(system, on, (place, root), tries.entry) else {
        return Verdict::undecided(format!(
            "it fails at {name} = {exact}, at which the sides cannot be enclosed"
        ));
    };
    let state = vec![NamedCoordinate { name, exact, value }];
    let witness = Witness { state, left, right, entry: None, refutation: None };
    Verdict::Refuted { engine: ZEROS.to_owned(), witness }
}

/// The digits of an irrational zero and of the sides there.
const SHOWN: usize = 12;
/// And the bits with which they are computed.
const BITS_SHOWN: usize = 200;

/// A zero of a polynomial of degree two, or an angle, as an expression.
fn by_an_expression(system: &mut System, place: &IrrationalPlace) -> Option<NodeId> {
    let (polynomial, root) = match &place.value {
        Irrational::Zero { polynomial, root } => (polynomial, root),
        Irrational::HalfTurns(turns) => {
            let (turns, pi) = (system.graph.rational(turns.clone()), system.graph.pi());
            return Some(system.graph.mul(turns, pi));
        }
    };
    let [c, b, a] = &polynomial[..] else { return None };
    let two = RBig::from(2);
    let (middle, twice) = (-b / (a * &two), a * &two);
    let below = (b * b - a * c * RBig::from(4)) / (&twice * &twice);
    let graph = &mut system.graph;
    let is_upper = root.low >= middle;
    let (middle, below) = (graph.rational(middle), graph.rational(below));
    let root = graph.apply(Function::Sqrt, below);
    Some(if is_upper { graph.add(middle, root) } else { graph.sub(middle, root) })
}

/// The sides of an entry where a symbol is known to lie between two numbers.
fn sides_near(
    system: &System,
    on: &OnBranch,
    (place, root): (&IrrationalPlace, &RealRoot),
    entry: usize,
) -> Option<[String; 2]> {
    let sides = &on.terms.sides;
    let program = Program::plain(&system.graph, &[sides[entry], sides[entry + sides.len() / 2]]);
    let arithmetic = Enclosures::new(BITS_SHOWN);
    let (low, high) = (arithmetic.rational(&root.low).ok()?, arithmetic.rational(&root.high).ok()?);
    let inputs = match program.inputs() {
        [] => Vec::new(),
        [Input::Plain(symbol)] if *symbol == place.symbol => vec![Enclosures::hull(&low, &high)],
        _ => return None,
    };
    let values = program.load(arithmetic).ok()?.run(&inputs, &mut Vec::new()).ok()?;
    let text = |value: &Enclosure| {
        value
            .certain_decimal(SHOWN)
            .unwrap_or_else(|| round_to_decimal(&((value.low() + value.high()) / RBig::from(2)), SHOWN))
    };
    let texts = [text(&values[0]), text(&values[1])];
    // two equal sides are written as the one that is known to more digits
    Some(match (place.touches, values[1].is_exact()) {
        (false, _) => texts,
        (true, exact) => [texts[usize::from(exact)].clone(), texts[usize::from(exact)].clone()],
    })
}

/// What is to be said where the two sides are one expression. An inequality that excludes equality fails there, wherever
/// it exists.
fn where_equal(
    system: &mut System,
    on: &OnBranch,
    goal: Guard,
    tries: &mut Tries,
    may_refute: bool,
    rng: &mut impl Rng,
) -> Option<Verdict> {
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, &[goal.node], is_angle);
    let (engine, log2_error) = match identically_zero(&system.graph, &expanded, is_angle, rng) {
        ZeroTest::Zero { log2_error, .. } => (RANDOM_PRIMES.to_owned(), log2_error),
        _ => match zero_by_relations(&mut system.graph, &expanded, &on.terms.guards, is_angle, rng) {
            Related::Zero { log2_error, used, .. } => {
                (format!("{RANDOM_PRIMES}, with what is known of {used}"), log2_error)
            }
            Related::NotShown(_) | Related::NoFunctions => return None,
        },
    };
    if goal.need == Need::NotNegative {
        return Some(Verdict::Proved { engine, log2_error });
    }
    tries.are_equal = true;
    for attempt in 0..LAST {
        let point = on.draw(system, attempt, rng);
        if may_refute && tries.refute(system, on, point) {
            return Some(tries.verdict(system));
        }
    }
    Some(Verdict::undecided(match &tries.doubt {
        Some(doubt) => format!(
            "both sides are equal wherever they are defined, so that it fails there, which the checker does not confirm: {doubt}"
        ),
        None => "both sides are equal wherever they are defined, and no state was found at which they are"
            .to_owned(),
    }))
}

/// Where a goal is open, in words.
fn in_words(system: &System, open: &Open) -> String {
    let mut sample: Vec<String> = open
        .sample
        .iter()
        .map(|(symbol, side)| {
            format!("{} in [{:.6}, {:.6}]", system.symbol_name(*symbol), side.low(), side.high())
        })
        .collect();
    if sample.len() > 6 {
        sample.truncate(6);
        sample.push("...".to_owned());
    }
    let unbounded = open.sample.iter().any(|(_, side)| !side.width().is_finite());
    let share = format!("{:.3} %", 100.0 * open.share);
    let place = match sample.is_empty() {
        true => String::new(),
        false => {
            format!(", {} {}", if open.boxes > 1 { "for example where" } else { "where" }, sample.join(", "))
        }
    };
    let advice =
        if unbounded { "; a bounded region ('where x in [a, b]', 'on sample') may decide it" } else { "" };
    match open.boxes {
        0 | 1 => format!("no sign is read off, and interval arithmetic does not decide it{place}{advice}"),
        boxes => format!(
            "after {boxes} boxes {share} of the region is open{place}; neither signs of factors nor sums of squares decide it{advice}"
        ),
    }
}

/// States that were tried as counterexamples.
struct Tries {
    entry: usize,
    relation: Relation,
    /// Whether the sides are known to be equal wherever they exist, and the relation excludes that.
    are_equal: bool,
    /// Why the checker did not confirm one.
    doubt: Option<Doubt>,
    found: Option<(Witness, bool)>,
}

impl Tries {
    /// Whether the relation certainly fails at a state, which the checker confirms.
    fn refute(&mut self, system: &System, on: &OnBranch, point: Point) -> bool {
        let Some(values) = on.sides(&point) else { return false };
        let entries = on.terms.relations.len();
        // of sides that are equal the checker decides, in exact numbers of its own
        if !self.are_equal && !fails(&values, self.relation, self.entry, self.entry + entries) {
            return false;
        }
        let exact = matches!(values, Values::Exact(_));
        let [left, right] = texts_of_sides(&values, self.entry, self.entry + entries);
        let witness =
            Witness { state: on.describe(system, &point), left, right, entry: None, refutation: None };
        let confirmed: Result<Box<Refutation>, Doubt> = refutation(system, on, &point, self.entry, &witness);
        match confirmed {
            Ok(refutation) => {
                self.found = Some((Witness { refutation: Some(refutation), ..witness }, exact));
                true
            }
            Err(doubt) => {
                self.doubt = Some(doubt);
                false
            }
        }
    }

    fn verdict(&mut self, _: &System) -> Verdict {
        match self.found.take() {
            Some((witness, exact)) => {
                Verdict::Refuted { engine: if exact { EXACT } else { INTERVALS }.to_owned(), witness }
            }
            None => Verdict::undecided("a counterexample was lost"),
        }
    }
}

/// Whether a relation certainly fails.
fn fails(values: &Values, relation: Relation, left: usize, right: usize) -> bool {
    let order = match values {
        Values::Exact(values) => Some(values[left].cmp(&values[right])),
        Values::Enclosed(values) => {
            let (l, r) = (&values[left], &values[right]);
            if l.high() < r.low() {
                Some(Ordering::Less)
            } else if l.low() > r.high() {
                Some(Ordering::Greater)
            } else {
                None
            }
        }
    };
    order.is_some_and(|order| !relation.holds(order))
}

impl OnBranch {
    /// A state with coordinates in proposed intervals, as simple as possible; what the conditions solve for follows.
    fn at_proposed(&self, system: &mut System, proposed: &Proposed) -> Option<Point> {
        let mut state = State::default();
        for symbol in self.free_symbols() {
            let found = proposed.iter().find(|(known, ..)| known == symbol);
            let (low, high) = match found {
                Some((_, low, high)) => (low.clone(), high.clone()),
                None => (RBig::ZERO, RBig::ZERO),
            };
            state.values.insert(*symbol, self.coordinate_between(system, *symbol, low, high)?);
        }
        Some(self.complete(system, state))
    }

    fn coordinate_between(
        &self,
        system: &System,
        symbol: Symbol,
        low: RBig,
        high: RBig,
    ) -> Option<Coordinate> {
        let simple = |low: RBig, high: RBig| match (low.cmp(&RBig::ZERO), high.cmp(&RBig::ZERO)) {
            (Ordering::Less, Ordering::Greater) => RBig::ZERO,
            _ if low < high => RBig::simplest_in(low, high),
            _ => low,
        };
        if !self.draws_circles() || !system.is_angle(symbol) {
            return Some(Coordinate::Number(simple(low, high)));
        }
        // by the tangent of the half, up to whole turns
        let turn = std::f64::consts::TAU;
        let wrapped = |value: &RBig| {
            let value = rational_to_f64(value);
            value - turn * (value / turn).round()
        };
        let (low, high) = (wrapped(&low), wrapped(&high));
        let tangent = |value: f64| rational_from_f64((value / 2.0).tan());
        let (a, b) = (tangent(low.min(high))?, tangent(low.max(high))?);
        Some(Coordinate::from_half_tangent(&simple(a, b)))
    }
}
