//! Conservation laws: sums of states, with rational factors, whose rate is zero along every field.

use dashu::base::{Abs, Signed};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{
    Graph, NodeId, Program, Symbol, ZeroTest, draw_residues, expand_angles, identically_zero,
};
use palmistry_math::number::PrimeField;
use palmistry_rank::observability::kernel;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A sum of states that no field changes.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    /// The state that the others give.
    pub state: Symbol,
    /// Its factor.
    own: RBig,
    /// The other states with their factors.
    others: Vec<(Symbol, RBig)>,
    /// The conserved amount: an unknown constant.
    pub total: Symbol,
    /// Its name.
    pub name: String,
    /// The sum as it is written.
    pub text: String,
}

/// More points than unknown factors, so that what vanishes at all of them by chance is rare; what is found is shown for all points.
const SPARE_POINTS: usize = 6;
/// How often a point is drawn anew because it is a pole.
const ATTEMPTS: usize = 40;
/// The largest numerators and denominators of factors that are looked for.
const LARGEST: [i64; 2] = [1000, 12];
/// Systems of more moving states are not looked at: the points fill a square of them.
const MOST_STATES: usize = 400;

impl Law {
    /// What the law gives for its state.
    pub fn given(&self, graph: &mut Graph) -> NodeId {
        let mut value = graph.symbol(self.total);
        for (state, factor) in &self.others {
            let (state, factor) = (graph.symbol(*state), graph.rational(factor.clone()));
            let term = graph.mul(factor, state);
            value = graph.sub(value, term);
        }
        let own = graph.rational(self.own.clone());
        graph.div(value, own)
    }

    /// The ends of what the total can be where each state lies in its range; nothing where one has none.
    pub fn range_of_the_total(&self, system: &System) -> Option<[RBig; 2]> {
        let mut ends = [RBig::ZERO, RBig::ZERO];
        let own = (self.state, self.own.clone());
        for (state, factor) in std::iter::once(&own).chain(&self.others) {
            let range = system.symbol_info(*state)?.range.as_ref()?;
            let (low, high) = (factor * &range.low, factor * &range.high);
            let (low, high) = if low > high { (high, low) } else { (low, high) };
            ends[0] += low;
            ends[1] += high;
        }
        Some(ends)
    }
}

/// The states of a system that move, and their rates along each field. What the others may give comes last.
pub(crate) struct Movements<'s> {
    pub system: &'s mut System,
    pub states: Vec<Symbol>,
    pub rates: Vec<Vec<NodeId>>,
}

/// The conservation laws of some states, each with a state of its own that no other law holds: one of the last, since in reduced echelon form the last columns are those
/// that the others give.
pub(crate) fn laws(moving: &mut Movements<'_>) -> Vec<Law> {
    let count = moving.states.len();
    if !(2..=MOST_STATES).contains(&count) {
        return Vec::new();
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0x006c_6177); // any fixed seed: what is found is shown
    let Some(found) = vectors(moving, &mut rng) else { return Vec::new() };
    let mut laws: Vec<Law> = Vec::new();
    let several = found.len() > 1;
    for factors in found {
        let terms: Vec<(usize, RBig)> =
            factors.into_iter().enumerate().filter(|(_, factor)| !factor.is_zero()).collect();
        if terms.len() < 2 || !holds(moving, &terms, &mut rng) {
            continue;
        }
        let mut terms: Vec<(Symbol, RBig)> =
            terms.into_iter().map(|(place, factor)| (moving.states[place], factor)).collect();
        let text = text(moving.system, &terms);
        let Some((state, own)) = terms.pop() else { continue };
        let name = name(moving.system, several.then_some(laws.len() + 1));
        let total = moving.system.graph.intern(&name);
        laws.push(Law { state, own, others: terms, total, name, text });
    }
    laws
}

/// What annihilates the rates at random points modulo a prime, as rational numbers; none where no point has values.
fn vectors(moving: &Movements<'_>, rng: &mut ChaCha8Rng) -> Option<Vec<Vec<RBig>>> {
    let graph = &moving.system.graph;
    let count = moving.states.len();
    let field = PrimeField::random(rng);
    let mut rows = Vec::new();
    for rates in &moving.rates {
        let mut program = Program::with_unknown_functions(graph, rates, moving.system.angle_test());
        if program.bare_angle().is_some() {
            program = Program::with_unknown_functions(graph, rates, |_| false);
        }
        let loaded = program.load(field).ok()?;
        let mut registers = Vec::new();
        for _ in 0..count + SPARE_POINTS {
            let values = (0..ATTEMPTS)
                .find_map(|_| loaded.run(&draw_residues(&program, &field, rng), &mut registers).ok())?;
            rows.push(values);
        }
    }
    let basis = kernel(&field, rows, count).ok()?;
    let fractions = |vector: &Vec<u64>| vector.iter().map(|value| fraction(&field, *value)).collect();
    Some(basis.iter().filter_map(fractions).collect())
}

/// The small fraction that a residue stands for.
fn fraction(field: &PrimeField, residue: u64) -> Option<RBig> {
    let [numerator, denominator] = LARGEST;
    for below in 1..=denominator {
        let above = field.product(residue, field.integer(&below.into()));
        let above = field.representative(above);
        let from_above = field.modulus() - above;
        if above <= numerator as u64 {
            return Some(RBig::from_parts(above.into(), (below as u64).into()));
        }
        if from_above <= numerator as u64 {
            return Some(-RBig::from_parts(from_above.into(), (below as u64).into()));
        }
    }
    None
}

/// Whether the rate of a sum is zero along every field, for all values.
fn holds(moving: &mut Movements<'_>, terms: &[(usize, RBig)], rng: &mut ChaCha8Rng) -> bool {
    let graph = &mut moving.system.graph;
    let mut sums = Vec::new();
    for rates in &moving.rates {
        let mut sum = graph.integer(0);
        for (place, factor) in terms {
            let factor = graph.rational(factor.clone());
            let term = graph.mul(factor, rates[*place]);
            sum = graph.add(sum, term);
        }
        sums.push(sum);
    }
    let is_angle = &moving.system.angle_test();
    let expanded = expand_angles(&mut moving.system.graph, &sums, is_angle);
    matches!(identically_zero(&moving.system.graph, &expanded, is_angle, rng), ZeroTest::Zero { .. })
}

fn name(system: &System, number: Option<usize>) -> String {
    let wanted = number.map_or_else(|| "total".to_owned(), |number| format!("total{number}"));
    let mut name = wanted.clone();
    let mut more = 1;
    while system.graph.find_symbol(&name).is_some() || system.definition(&name).is_some() {
        more += 1;
        name = format!("{wanted}_{more}");
    }
    name
}

fn text(system: &System, terms: &[(Symbol, RBig)]) -> String {
    let mut text = String::new();
    for (state, factor) in terms {
        let name = system.symbol_name(*state);
        let size = factor.clone().abs();
        let sign = match (text.is_empty(), factor.is_negative()) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text.push_str(sign);
        if size != RBig::ONE {
            text.push_str(&format!("{size}*"));
        }
        text.push_str(name);
    }
    text
}
