//! The observability rank of an observer's equations along a motion: whether the measurements determine the followed states there, and how well.
//!
//! The rows are the differentials, by the states that are followed, of the outputs and of their derivatives along the motion (4.36 and 4.37, with the inputs as
//! they are measured and not as they might be chosen). All measurements are known signals; their derivatives are those of a polynomial through neighbouring
//! samples. A motion that crosses a zero of a divisor has met a pole, wherever its samples lie.

use nalgebra::DMatrix;
use palmistry_lang::System;
use palmistry_math::expression::{Derivation, Graph, Node, NodeId, Program, Symbol, gradient};
use palmistry_math::number::{Floats, MOST_ITERATIONS, PrimeField, rational_from_f64};
use palmistry_observe::{EstimateQuestion, Model, MotionRankFound, PoleMet, Task, parameter_values};
use palmistry_rank::observability::{Coordinate, Defined, State, singular_values};
use palmistry_rank::sweep::{Certainty, DecidedRows, ProofWanted, RankDecider, StateDecision};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{HashMap, HashSet};

/// Outputs are differentiated no more often than this.
const MOST: usize = 3;

/// The same for a single motion: with columns that drive the model, and without. A polynomial of degree [`DEGREE`] has no more derivatives.
const MOST_ONCE: [usize; 2] = [DEGREE, 10];

/// Derivatives with more nodes than this are not taken: they grow with each order.
const MOST_PARTS: usize = 200_000;

/// Derivatives of measurements are those of a polynomial of this degree through this many samples to either side.
const DEGREE: usize = 5;
const BESIDE: usize = 10;

/// The rank is computed at this many samples of a window or a few more, evenly spread.
const ASKED: usize = 20;

/// A divisor counts as zero where a motion ends if it is below this fraction of its earlier maximum.
const NEXT_TO_NOTHING: f64 = 1e-2;

/// Where the value of a symbol comes from.
#[derive(Clone, Copy, Debug)]
enum Value {
    /// A followed state.
    State(usize),
    /// A derivative of a column of the signals, by the place of the column among those of the model.
    Column(usize, usize),
}

/// A divisor of the equations.
struct Divisor {
    text: String,
    program: Program,
}

/// The rank of an observer's equations, ready to be computed along motions.
pub struct MotionRank {
    decider: RankDecider<'static>,
    values: HashMap<Symbol, Value>,
    divisors: Vec<Divisor>,
    columns: Vec<usize>,
    /// How many states are followed: the rank where all of them are observable.
    pub of: usize,
    /// The number of derivatives of each output among the rows.
    order: usize,
    /// The number of derivatives of columns that have symbols.
    most: usize,
}

impl MotionRank {
    /// Of a task's equations. Outputs are differentiated until the rank is full at the first sample with these values of the estimated states, three
    /// times at most, since it is computed window by window.
    pub fn new(task: &Task<'_>, sought: &[f64]) -> MotionRank {
        MotionRank::with(task, sought, MOST)
    }

    /// The same with more derivatives, where three do not make the rank full.
    pub fn thorough(task: &Task<'_>, sought: &[f64]) -> MotionRank {
        let measured = |column: &usize| task.full.outputs.contains(&task.signals.names()[*column]);
        let [driven, alone] = MOST_ONCE;
        let is_driven = !task.full.columns.iter().all(measured);
        MotionRank::with(task, sought, if is_driven { driven } else { alone })
    }

    fn with(task: &Task<'_>, sought: &[f64], most: usize) -> MotionRank {
        let model = &task.full;
        let mut graph = model.system.graph.clone();
        let (jets, values) = jets(&mut graph, model, task, most);
        let mut slopes: HashMap<Symbol, NodeId> =
            model.symbols.iter().copied().zip(model.rate_nodes.iter().copied()).collect();
        for chain in &jets {
            for pair in chain.windows(2) {
                let next = graph.symbol(pair[1]);
                slopes.insert(pair[0], next);
            }
        }
        let mut along = Derivation::new(slopes);
        let columns = model.columns.clone();
        let divisors = divisors(model, task, &values);
        let inputs = Inputs { values: &values, columns: &columns, task, most };
        let (state, derivatives) = (task.full_state(sought, 0), inputs.derivatives(0));
        let mut last = model.output_nodes.clone();
        let (mut entries, mut order) = (Vec::new(), 0);
        loop {
            for node in &last {
                entries.extend(gradient(&mut graph, *node, &model.symbols));
            }
            let program = Program::plain(&graph, &entries);
            let found = inputs.run(&program, &state, &derivatives);
            let rank = found.and_then(|found| {
                singular_values(&found, &vec![0.0; found.len()], model.symbols.len()).map(|all| all.rank)
            });
            if order == most || rank == Some(model.symbols.len()) || graph.len() > MOST_PARTS {
                break;
            }
            last = last.into_iter().map(|node| along.apply(&mut graph, node)).collect();
            order += 1;
        }
        // any fixed field: what it proves does not depend on which
        let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(1));
        let proof = ProofWanted { wanted: Certainty::Computed, field };
        let rows = DecidedRows { quick: &entries, all: &entries, columns: model.symbols.len() };
        let decider = RankDecider::new(&graph, Defined::default(), rows, |_| false, proof).owning();
        MotionRank { decider, values, divisors, columns, of: model.symbols.len(), order, most }
    }

    /// The rank along the motion through all samples of a task, from these estimated states at the first; outputs that are states have their
    /// measured values.
    pub fn along(&self, task: &Task<'_>, sought: &[f64]) -> MotionRankFound {
        let times = task.signals.times();
        let mut found = MotionRankFound {
            asked: 0,
            decided: 0,
            rank: self.of,
            of: self.of,
            order: self.order,
            certified: true,
            smallest: f64::NAN,
            condition: 0.0,
            at: times[0],
            pole: None,
            lost: None,
        };
        let mut stopped = None;
        let motion = task.integrate(sought, 0..times.len()).or_else(|lost| {
            let until = times.partition_point(|time| *time < lost.time).max(1);
            stopped = Some(lost);
            task.integrate(sought, 0..until)
        });
        let motion = motion.unwrap_or_else(|_| vec![sought.to_vec()]);
        let states: Vec<Vec<f64>> =
            motion.iter().enumerate().map(|(row, own)| task.full_state(own, row)).collect();
        let inputs = Inputs { values: &self.values, columns: &self.columns, task, most: self.most };
        found.pole = self.first_pole(&inputs, &states);
        if let Some(lost) = stopped {
            found.pole = found.pole.or_else(|| self.pole_at(&inputs, &states, lost.time));
            found.lost = Some(lost.to_string());
        }
        for row in (0..states.len()).step_by((times.len() / ASKED).max(1)) {
            if task.interrupted() {
                break;
            }
            self.ask(&inputs, &states[row], row, &mut found);
        }
        if found.decided == 0 {
            // interrupted, or a pole at every sample: nothing is known of the rank
            (found.rank, found.condition, found.certified) = (0, f64::INFINITY, false);
        }
        found
    }

    fn ask(&self, inputs: &Inputs<'_>, state: &[f64], row: usize, found: &mut MotionRankFound) {
        let derivatives = inputs.derivatives(row);
        let exact = |symbol: &Symbol, value: &Value| {
            let value = rational_from_f64(inputs.value(*value, state, &derivatives))?;
            Some((*symbol, Coordinate::Number(value)))
        };
        let all = self.values.iter().filter_map(|(symbol, value)| exact(symbol, value)).collect();
        let time = inputs.task.signals.times()[row];
        found.asked += 1;
        match self.decider.decide(&State { values: all }) {
            StateDecision::Pole(divisor) => {
                found.pole.get_or_insert(PoleMet { divisor, time });
            }
            StateDecision::Report(report) => {
                let condition = match &report.spectrum {
                    Some(spectrum) if report.rank == self.of => spectrum.condition(),
                    // nothing was left to decide: all rows are unit rows
                    None if report.rank == self.of => 1.0,
                    _ => f64::INFINITY,
                };
                found.decided += 1;
                found.certified &= report.certainty == Certainty::Certified;
                let is_worse = report.rank < found.rank
                    || (report.rank == found.rank && (found.decided == 1 || condition > found.condition));
                if is_worse {
                    found.smallest = report.spectrum.as_ref().map_or(f64::NAN, |all| all.smallest());
                    (found.rank, found.condition, found.at) = (report.rank, condition, time);
                }
            }
        }
    }

    /// The divisor that nearly vanishes where a motion could not be followed any further, evaluated at the last state before.
    fn pole_at(&self, inputs: &Inputs<'_>, states: &[Vec<f64>], time: f64) -> Option<PoleMet> {
        let mut here = vec![0.0; self.columns.len()];
        inputs.task.signals.at(&self.columns, time, &mut here);
        let here: Vec<Vec<f64>> = here.into_iter().map(|value| vec![value]).collect();
        let last = states.last()?;
        let is_next_to_nothing = |divisor: &&Divisor| {
            let value = |state: &[f64], read: &[Vec<f64>]| inputs.run(&divisor.program, state, read);
            let before =
                states.iter().enumerate().filter_map(|(row, state)| value(state, &inputs.values_at(row)));
            let largest = before.map(|found| found[0].abs()).fold(0.0, f64::max);
            value(last, &here).is_some_and(|found| found[0].abs() < NEXT_TO_NOTHING * largest)
        };
        let divisor = self.divisors.iter().find(is_next_to_nothing)?;
        Some(PoleMet { divisor: divisor.text.clone(), time })
    }

    /// The first zero of a divisor at a sample, or between two.
    fn first_pole(&self, inputs: &Inputs<'_>, states: &[Vec<f64>]) -> Option<PoleMet> {
        let times = inputs.task.signals.times();
        let value = |divisor: &Divisor, row: usize| {
            inputs.run(&divisor.program, &states[row], &inputs.values_at(row)).map(|found| found[0])
        };
        let mut first: Option<PoleMet> = None;
        for divisor in &self.divisors {
            let mut before: Option<(f64, f64)> = None;
            for (row, time) in times.iter().enumerate().take(states.len()) {
                let here = value(divisor, row).unwrap_or(0.0);
                let met = match before {
                    _ if here == 0.0 => Some(*time),
                    Some((then, last)) if last * here < 0.0 => {
                        Some(then + (time - then) * last / (last - here))
                    }
                    _ => None,
                };
                if let Some(time) = met {
                    if first.as_ref().is_none_or(|other| time < other.time) {
                        first = Some(PoleMet { divisor: divisor.text.clone(), time });
                    }
                    break;
                }
                before = Some((*time, here));
            }
        }
        first
    }
}

/// Symbols for the derivatives of measurements, and where the values of all symbols come from.
fn jets(
    graph: &mut Graph,
    model: &Model,
    task: &Task<'_>,
    most: usize,
) -> (Vec<Vec<Symbol>>, HashMap<Symbol, Value>) {
    let mut values: HashMap<Symbol, Value> =
        model.symbols.iter().enumerate().map(|(place, symbol)| (*symbol, Value::State(place))).collect();
    let mut jets = Vec::new();
    for (place, column) in model.columns.iter().enumerate() {
        let name = &task.signals.names()[*column];
        let own = graph.intern(name);
        if values.contains_key(&own) {
            continue;
        }
        let mut chain = vec![own];
        chain.extend((1..=most).map(|order| graph.intern(&format!("derivative {order} of {name}"))));
        for (order, symbol) in chain.iter().enumerate() {
            values.insert(*symbol, Value::Column(place, order));
        }
        jets.push(chain);
    }
    (jets, values)
}

/// The divisors of the equations, as far as they change.
fn divisors(model: &Model, task: &Task<'_>, values: &HashMap<Symbol, Value>) -> Vec<Divisor> {
    let mut system = model.system.clone();
    let (_, EstimateQuestion { known, inputs, .. }) = &*task.source;
    let driven = inputs.iter().filter_map(|(name, _)| system.fields.iter().position(|own| own.name == *name));
    let fields: Vec<usize> = system.drift().into_iter().chain(driven).collect();
    let given = |name: &str| task.signals.find(name).is_some();
    let Ok(mut constants) = parameter_values(&mut system, known, given) else { return Vec::new() };
    constants.retain(|symbol, _| !model.symbols.contains(symbol));
    let rates = fields.iter().flat_map(|field| &system.fields[*field].components);
    let rates = rates.filter(|(symbol, _)| model.symbols.contains(symbol)).map(|(_, node)| *node);
    let (mut factors, mut seen) = (Vec::new(), HashSet::new());
    for node in rates.chain(system.outputs.iter().map(|(_, node)| *node)) {
        collect_divisors(&system.graph, node, false, &mut seen, &mut factors);
    }
    let of = |system: &mut System, factor: NodeId| {
        let text = system.graph.text(factor);
        let node = system.graph.substitute(&[factor], &constants)[0];
        let symbols = system.graph.symbols_of([node]);
        let is_known = symbols
            .iter()
            .all(|symbol| matches!(values.get(symbol), Some(Value::State(_) | Value::Column(_, 0))));
        (is_known && !symbols.is_empty())
            .then(|| Divisor { text, program: Program::plain(&system.graph, &[node]) })
    };
    factors.into_iter().filter_map(|factor| of(&mut system, factor)).collect()
}

/// The factors of all divisors, each once; a divisor of a divisor, as the cosine in `1/tan`, is excluded.
fn collect_divisors(
    graph: &Graph,
    node: NodeId,
    divides: bool,
    seen: &mut HashSet<(NodeId, bool)>,
    found: &mut Vec<NodeId>,
) {
    if !seen.insert((node, divides)) {
        return;
    }
    let mut go_on = |part: NodeId, divides: bool| collect_divisors(graph, part, divides, seen, found);
    match graph.node(node) {
        Node::Mul(a, b) => [a, b].into_iter().for_each(|part| go_on(part, divides)),
        Node::Div(a, b) => {
            go_on(a, divides);
            go_on(b, !divides);
        }
        Node::Neg(a) => go_on(a, divides),
        Node::Power(a, exponent) => go_on(a, divides != (exponent < 0)),
        other => {
            other.operands().for_each(|part| go_on(part, false));
            if divides {
                found.push(node);
            }
        }
    }
}

/// The values of symbols at the samples of a task.
struct Inputs<'a> {
    values: &'a HashMap<Symbol, Value>,
    columns: &'a [usize],
    task: &'a Task<'a>,
    most: usize,
}

impl Inputs<'_> {
    /// The measurements at a sample, a row a column.
    fn values_at(&self, row: usize) -> Vec<Vec<f64>> {
        self.columns.iter().map(|column| vec![self.task.signals.column(*column)[row]]).collect()
    }

    /// The same with derivatives: of each column the value and as many of these as have symbols.
    fn derivatives(&self, row: usize) -> Vec<Vec<f64>> {
        let times = self.task.signals.times();
        let count = (2 * BESIDE + 1).min(times.len());
        let first = row.saturating_sub(BESIDE).min(times.len() - count);
        let near = first..first + count;
        let reach = times[near.clone()].iter().map(|time| (time - times[row]).abs()).fold(0.0, f64::max);
        let mut found = self.values_at(row);
        if reach == 0.0 {
            found.iter_mut().for_each(|own| own.resize(self.most + 1, 0.0));
            return found;
        }
        let degree = DEGREE.min(count - 1);
        let powers = DMatrix::from_fn(count, degree + 1, |i, k| {
            ((times[first + i] - times[row]) / reach).powi(k as i32)
        });
        let read = DMatrix::from_fn(count, self.columns.len(), |i, j| {
            self.task.signals.column(self.columns[j])[first + i]
        });
        let svd = powers.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS);
        let coefficients = svd.and_then(|svd| svd.solve(&read, 1e-12).ok());
        for (place, own) in found.iter_mut().enumerate() {
            let mut factorial = 1.0;
            for order in 1..=self.most {
                factorial *= order as f64;
                let coefficient = coefficients.as_ref().filter(|_| order <= degree);
                let coefficient = coefficient.map_or(0.0, |all| all[(order, place)]);
                own.push(factorial * coefficient / reach.powi(order as i32));
            }
        }
        found
    }

    fn value(&self, value: Value, state: &[f64], derivatives: &[Vec<f64>]) -> f64 {
        match value {
            Value::State(place) => state[place],
            Value::Column(place, order) => derivatives[place][order],
        }
    }

    /// A program at a state; nothing where it has no value there.
    fn run(&self, program: &Program, state: &[f64], derivatives: &[Vec<f64>]) -> Option<Vec<f64>> {
        let input = |symbol: Symbol| Some(self.value(*self.values.get(&symbol)?, state, derivatives));
        let inputs: Option<Vec<f64>> =
            program.inputs().iter().map(|own| own.symbol().and_then(input)).collect();
        let values = program.load(Floats).ok()?.run(&inputs?, &mut Vec::new()).ok()?;
        values.iter().all(|value| value.is_finite()).then_some(values)
    }
}
