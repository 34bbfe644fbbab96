//! Conservation laws: sums of states, with rational factors, whose rate is zero along every field.

use super::remaining::Remaining;
use dashu::base::{Abs, Signed};
use dashu::rational::RBig;
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
}

/// The conservation laws of the states that move, each with a state of its own that no other law holds: by choice one that is no output.
pub(crate) fn laws(remaining: &mut Remaining) -> Vec<Law> {
    let columns = columns(remaining);
    if columns.len() < 2 || columns.len() > MOST_STATES {
        return Vec::new();
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0x006c_6177); // any fixed seed: what is found is shown
    let Some(found) = vectors(remaining, &columns, &mut rng) else { return Vec::new() };
    let mut laws: Vec<Law> = Vec::new();
    let several = found.len() > 1;
    for factors in found {
        let terms: Vec<(Symbol, RBig)> = columns
            .iter()
            .zip(factors)
            .filter(|(_, factor)| !factor.is_zero())
            .map(|(place, factor)| (remaining.states[*place], factor))
            .collect();
        let Some(((state, own), others)) = terms.split_last() else { continue };
        if others.is_empty() || !holds(remaining, &terms, &mut rng) {
            continue;
        }
        let name = name(remaining, several.then_some(laws.len() + 1));
        let total = remaining.system.graph.intern(&name);
        let text = text(remaining, &terms);
        laws.push(Law { state: *state, own: own.clone(), others: others.to_vec(), total, name, text });
    }
    laws
}

/// The places of the states that move. In reduced echelon form the last columns are those that the others give: what is an output by itself comes first.
fn columns(remaining: &Remaining) -> Vec<usize> {
    let outputs: Vec<Symbol> =
        remaining.output_nodes().filter_map(|node| remaining.system.graph.as_symbol(node)).collect();
    let known = |place: &usize| {
        let state = remaining.states[*place];
        outputs.contains(&state) || remaining.further_outputs.contains(&state)
    };
    let moves = |place: &usize| !remaining.is_constant(*place);
    let (mut first, last): (Vec<usize>, Vec<usize>) =
        (0..remaining.states.len()).filter(moves).partition(known);
    first.extend(last);
    first
}

/// What annihilates the rates at random points modulo a prime, as rational numbers; none where no point has values.
fn vectors(remaining: &Remaining, columns: &[usize], rng: &mut ChaCha8Rng) -> Option<Vec<Vec<RBig>>> {
    let graph = &remaining.system.graph;
    let field = PrimeField::random(rng);
    let mut rows = Vec::new();
    for rates in &remaining.rates {
        let nodes: Vec<NodeId> = columns.iter().map(|place| rates[*place]).collect();
        let mut program = Program::with_unknown_functions(graph, &nodes, remaining.system.angle_test());
        if program.bare_angle().is_some() {
            program = Program::with_unknown_functions(graph, &nodes, |_| false);
        }
        let loaded = program.load(field).ok()?;
        let mut registers = Vec::new();
        for _ in 0..columns.len() + SPARE_POINTS {
            let values = (0..ATTEMPTS)
                .find_map(|_| loaded.run(&draw_residues(&program, &field, rng), &mut registers).ok())?;
            rows.push(values);
        }
    }
    let basis = kernel(&field, rows, columns.len()).ok()?;
    Some(
        basis
            .iter()
            .filter_map(|vector| vector.iter().map(|value| fraction(&field, *value)).collect())
            .collect(),
    )
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
fn holds(remaining: &mut Remaining, terms: &[(Symbol, RBig)], rng: &mut ChaCha8Rng) -> bool {
    let places: Vec<Option<usize>> =
        terms.iter().map(|(state, _)| remaining.states.iter().position(|other| other == state)).collect();
    let mut sums = Vec::new();
    for rates in &remaining.rates {
        let graph = &mut remaining.system.graph;
        let mut sum = graph.integer(0);
        for (place, (_, factor)) in places.iter().zip(terms) {
            let Some(place) = place else { return false };
            let factor = graph.rational(factor.clone());
            let term = graph.mul(factor, rates[*place]);
            sum = graph.add(sum, term);
        }
        sums.push(sum);
    }
    let is_angle = &remaining.system.angle_test();
    let expanded = expand_angles(&mut remaining.system.graph, &sums, is_angle);
    matches!(identically_zero(&remaining.system.graph, &expanded, is_angle, rng), ZeroTest::Zero { .. })
}

fn name(remaining: &Remaining, number: Option<usize>) -> String {
    let system = &remaining.system;
    let wanted = number.map_or_else(|| "total".to_owned(), |number| format!("total{number}"));
    let mut name = wanted.clone();
    let mut more = 1;
    while system.graph.find_symbol(&name).is_some() || system.definition(&name).is_some() {
        more += 1;
        name = format!("{wanted}_{more}");
    }
    name
}

fn text(remaining: &Remaining, terms: &[(Symbol, RBig)]) -> String {
    let mut text = String::new();
    for (state, factor) in terms {
        let name = remaining.system.symbol_name(*state);
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
