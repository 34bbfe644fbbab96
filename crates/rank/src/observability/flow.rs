//! Some expressions along the flow of a field, decomposed into operations for which there is a recurrence of Taylor
//! coefficients. [`series`](super::series) runs them.

use dashu::rational::RBig;
use palmistry_math::expression::{Graph, Input, Node, NodeId, Symbol};
use palmistry_math::number::Function;
use std::collections::HashMap;

/// What is done to whole series. Operands are places of earlier operations.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operation {
    Constant(usize),
    Pi,
    Input(usize),
    /// An angle that is met inside sines and cosines alone: of its own value nothing is needed but how it changes.
    Angle,
    Add(usize, usize),
    Sub(usize, usize),
    Neg(usize),
    Mul(usize, usize),
    Square(usize),
    Div(usize, usize),
    /// A sine; the cosine of the same argument is the next operation. Both may be given as inputs.
    Sine(usize, Option<usize>),
    /// A cosine; the sine of the same argument is the operation before.
    Cosine(usize, Option<usize>),
    Exp(usize),
    Root(usize),
    /// A function `c` of `a` with `c' b = a'`.
    Integral(Function, usize, usize),
}

/// Some expressions along the flow of one field: a straight-line program over power series.
#[derive(Clone, Debug)]
pub struct Flow {
    pub(super) operations: Vec<Operation>,
    pub(super) origins: Vec<NodeId>,
    pub(super) constants: Vec<RBig>,
    pub(super) inputs: Vec<Input>,
    /// The rate of an input that moves, by the input's operation.
    pub(super) rates: HashMap<usize, usize>,
    pub(super) roots: Vec<usize>,
    /// Whether a root needs it at its last order, when no rate is wanted any more.
    pub(super) needed_last: Vec<bool>,
    bare_angle: Option<Symbol>,
}

impl Flow {
    /// The expressions `roots` along the field that moves each of these symbols at its rate; all others stand still.
    /// Sines and cosines of bare angles become inputs.
    pub fn new(
        graph: &Graph,
        components: &[(Symbol, NodeId)],
        roots: &[NodeId],
        is_angle: impl Fn(Symbol) -> bool,
    ) -> Flow {
        let moving: HashMap<Symbol, NodeId> = components.iter().copied().collect();
        // the symbols that the roots mention, those that their rates mention, and so on
        let mut wanted = roots.to_vec();
        let mut met: Vec<Symbol> = Vec::new();
        let mut next = graph.symbols_of(roots.iter().copied());
        while let Some(symbol) = next.pop() {
            if !met.contains(&symbol) {
                met.push(symbol);
                if let Some(rate) = moving.get(&symbol) {
                    wanted.push(*rate);
                    next.extend(graph.symbols_of([*rate]));
                }
            }
        }
        let mut lowering = Lowering { flow: Flow::empty(), places: HashMap::new(), angles: HashMap::new() };
        let order = graph.reachable(wanted);
        lowering.flow.bare_angle = bare_angle(graph, &order, roots, &is_angle);
        let bare = lowering.flow.bare_angle.is_some();
        for id in &order {
            lowering.lower(graph, *id, &is_angle, bare);
        }
        let Lowering { mut flow, places, .. } = lowering;
        for id in order {
            if let Some(rate) = graph.as_symbol(id).and_then(|symbol| moving.get(&symbol)) {
                flow.rates.insert(places[&id], places[rate]);
            }
        }
        flow.roots = roots.iter().map(|root| places[root]).collect();
        flow.mark_needed_last();
        flow
    }

    fn empty() -> Flow {
        Flow {
            operations: Vec::new(),
            origins: Vec::new(),
            constants: Vec::new(),
            inputs: Vec::new(),
            rates: HashMap::new(),
            roots: Vec::new(),
            needed_last: Vec::new(),
            bare_angle: None,
        }
    }

    fn mark_needed_last(&mut self) {
        let mut needed = vec![false; self.operations.len()];
        for root in &self.roots {
            needed[*root] = true;
        }
        for place in (0..self.operations.len()).rev() {
            if needed[place] {
                for operand in self.operations[place].operands() {
                    needed[operand] = true;
                }
            }
        }
        self.needed_last = needed;
    }

    /// What has to be given, in this order.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// An angle that is met outside sines and cosines, and so has no exact value. Where there is none, no angle is among
    /// the inputs.
    pub fn bare_angle(&self) -> Option<Symbol> {
        self.bare_angle
    }

    /// The number of operations on whole series.
    pub fn len(&self) -> usize {
        self.operations.len()
    }

    /// Whether there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.operations.is_empty()
    }
}

impl Operation {
    pub(super) fn operands(self) -> impl Iterator<Item = usize> {
        let (a, b) = match self {
            Operation::Constant(_) | Operation::Pi | Operation::Input(_) | Operation::Angle => (None, None),
            Operation::Add(a, b)
            | Operation::Sub(a, b)
            | Operation::Mul(a, b)
            | Operation::Div(a, b)
            | Operation::Integral(_, a, b) => (Some(a), Some(b)),
            Operation::Neg(a)
            | Operation::Square(a)
            | Operation::Exp(a)
            | Operation::Root(a)
            | Operation::Sine(a, _)
            | Operation::Cosine(a, _) => (Some(a), None),
        };
        a.into_iter().chain(b)
    }
}

/// An angle that is a root itself, or an operand of something else than a sine or a cosine.
fn bare_angle(
    graph: &Graph,
    nodes: &[NodeId],
    roots: &[NodeId],
    is_angle: impl Fn(Symbol) -> bool,
) -> Option<Symbol> {
    let circular = |id: &&NodeId| !matches!(graph.node(**id), Node::Apply(Function::Sin | Function::Cos, _));
    let operands = nodes.iter().filter(circular).flat_map(|id| graph.node(*id).operands());
    roots
        .iter()
        .copied()
        .chain(operands)
        .filter_map(|id| graph.as_symbol(id))
        .find(|symbol| is_angle(*symbol))
}

/// Nodes decomposed into operations for which there is a recurrence.
struct Lowering {
    flow: Flow,
    places: HashMap<NodeId, usize>,
    /// The sine of an argument, by the argument's operation; the cosine follows it.
    angles: HashMap<usize, usize>,
}

impl Lowering {
    fn push(&mut self, operation: Operation, origin: NodeId) -> usize {
        self.flow.operations.push(operation);
        self.flow.origins.push(origin);
        self.flow.operations.len() - 1
    }

    fn input(&mut self, input: Input) -> usize {
        self.flow.inputs.push(input);
        self.flow.inputs.len() - 1
    }

    fn constant(&mut self, value: RBig, origin: NodeId) -> usize {
        self.flow.constants.push(value);
        let operation = Operation::Constant(self.flow.constants.len() - 1);
        self.push(operation, origin)
    }

    fn lower(&mut self, graph: &Graph, id: NodeId, is_angle: &impl Fn(Symbol) -> bool, bare: bool) {
        let at = |operand: NodeId| self.places[&operand];
        let place = match graph.node(id) {
            Node::Constant(_) => {
                let value = graph.constant_value(id).cloned().unwrap_or(RBig::ZERO);
                self.constant(value, id)
            }
            Node::Pi => self.push(Operation::Pi, id),
            Node::Symbol(symbol) if is_angle(symbol) && !bare => self.push(Operation::Angle, id),
            Node::Symbol(symbol) => {
                let input = self.input(Input::Plain(symbol));
                self.push(Operation::Input(input), id)
            }
            Node::Add(a, b) => self.push(Operation::Add(at(a), at(b)), id),
            Node::Sub(a, b) => self.push(Operation::Sub(at(a), at(b)), id),
            Node::Neg(a) => self.push(Operation::Neg(at(a)), id),
            Node::Mul(a, b) if a == b => self.push(Operation::Square(at(a)), id),
            Node::Mul(a, b) => self.push(Operation::Mul(at(a), at(b)), id),
            Node::Div(a, b) => self.push(Operation::Div(at(a), at(b)), id),
            Node::Power(a, n) => self.power(at(a), n, id),
            Node::Apply(function, a) => {
                let angle = graph.as_symbol(a).filter(|symbol| is_angle(*symbol));
                self.apply(function, at(a), angle, id)
            }
        };
        self.places.insert(id, place);
    }

    /// By repeated squaring; a negative power is the reciprocal of the positive one.
    fn power(&mut self, base: usize, n: i32, id: NodeId) -> usize {
        let mut rest = n.unsigned_abs();
        let (mut result, mut square) = (None, base);
        while rest > 0 {
            if rest & 1 == 1 {
                result = Some(match result {
                    Some(known) => self.push(Operation::Mul(known, square), id),
                    None => square,
                });
            }
            rest >>= 1;
            if rest > 0 {
                square = self.push(Operation::Square(square), id);
            }
        }
        let one = if n > 0 { None } else { Some(self.constant(RBig::ONE, id)) };
        match (result, one) {
            (Some(power), Some(one)) => self.push(Operation::Div(one, power), id),
            (Some(power), None) => power,
            (None, one) => one.unwrap_or(base),
        }
    }

    fn apply(&mut self, function: Function, a: usize, angle: Option<Symbol>, id: NodeId) -> usize {
        match function {
            Function::Sin | Function::Cos => {
                let sine = match self.angles.get(&a) {
                    Some(known) => *known,
                    None => {
                        let sine = angle.map(|symbol| self.input(Input::Sine(symbol)));
                        let cosine = angle.map(|symbol| self.input(Input::Cosine(symbol)));
                        let place = self.push(Operation::Sine(a, sine), id);
                        self.push(Operation::Cosine(a, cosine), id);
                        self.angles.insert(a, place);
                        place
                    }
                };
                if function == Function::Sin { sine } else { sine + 1 }
            }
            Function::Exp => self.push(Operation::Exp(a), id),
            Function::Sqrt => self.push(Operation::Root(a), id),
            Function::Log => self.push(Operation::Integral(function, a, a), id),
            Function::Atan | Function::Asin | Function::Acos => {
                let one = self.constant(RBig::ONE, id);
                let square = self.push(Operation::Square(a), id);
                let bottom = match function {
                    Function::Atan => self.push(Operation::Add(one, square), id),
                    _ => {
                        let rest = self.push(Operation::Sub(one, square), id);
                        let root = self.push(Operation::Root(rest), id);
                        if function == Function::Asin { root } else { self.push(Operation::Neg(root), id) }
                    }
                };
                self.push(Operation::Integral(function, a, bottom), id)
            }
        }
    }
}
