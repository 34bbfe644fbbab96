//! A straight-line program: the nodes that some expressions need, in an order in which they can be computed, to be run
//! over any [`Arithmetic`].

use super::graph::{Graph, Node, NodeId, Symbol};
use super::input::Input;
use crate::number::{Arithmetic, Function, Refusal};
use dashu::rational::RBig;
use palmistry_budget as budget;
use std::collections::HashMap;

#[derive(Clone, Copy, Debug)]
enum Operation {
    Constant(u32),
    Pi,
    Input(u32),
    Add(u32, u32),
    Sub(u32, u32),
    Mul(u32, u32),
    Div(u32, u32),
    Neg(u32),
    Power(u32, i32),
    Apply(Function, u32),
}

/// A straight-line program for some expressions.
#[derive(Clone, Debug, Default)]
pub struct Program {
    operations: Vec<Operation>,
    origins: Vec<NodeId>,
    constants: Vec<RBig>,
    inputs: Vec<Input>,
    outputs: Vec<u32>,
    bare_angle: Option<Symbol>,
    /// The number of operations, the first ones, that depend on no input.
    constant: usize,
}

impl Operation {
    fn operands(self) -> [Option<u32>; 2] {
        match self {
            Operation::Constant(_) | Operation::Pi | Operation::Input(_) => [None; 2],
            Operation::Add(a, b) | Operation::Sub(a, b) | Operation::Mul(a, b) | Operation::Div(a, b) => {
                [Some(a), Some(b)]
            }
            Operation::Neg(a) | Operation::Power(a, _) | Operation::Apply(_, a) => [Some(a), None],
        }
    }

    fn with_operands(self, of: impl Fn(u32) -> u32) -> Operation {
        match self {
            Operation::Constant(_) | Operation::Pi | Operation::Input(_) => self,
            Operation::Add(a, b) => Operation::Add(of(a), of(b)),
            Operation::Sub(a, b) => Operation::Sub(of(a), of(b)),
            Operation::Mul(a, b) => Operation::Mul(of(a), of(b)),
            Operation::Div(a, b) => Operation::Div(of(a), of(b)),
            Operation::Neg(a) => Operation::Neg(of(a)),
            Operation::Power(a, n) => Operation::Power(of(a), n),
            Operation::Apply(function, a) => Operation::Apply(function, of(a)),
        }
    }
}

/// Where and why a program stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Why.
    pub refusal: Refusal,
    /// The node whose value could not be computed.
    pub node: NodeId,
    /// The factor of the divisor that is zero, or may be, where that is what went wrong.
    pub divisor: Option<NodeId>,
}

/// How functions are treated.
#[derive(Clone, Copy, PartialEq)]
enum Functions {
    Computed,
    Unknown,
}

impl Program {
    /// The program for `roots` whose inputs are symbols: all functions are computed.
    pub fn plain(graph: &Graph, roots: &[NodeId]) -> Self {
        Self::build(graph, roots, &|_| false, Functions::Computed)
    }

    /// The program for `roots`. Sines and cosines of a bare angle become inputs, all other functions are computed.
    pub fn new(graph: &Graph, roots: &[NodeId], is_angle: impl Fn(Symbol) -> bool) -> Self {
        Self::build(graph, roots, &is_angle, Functions::Computed)
    }

    /// The program for `roots` in which every function is an input of its own, of whose value nothing is known; but for
    /// sines and cosines of a bare angle, which are inputs as such.
    pub fn with_unknown_functions(
        graph: &Graph,
        roots: &[NodeId],
        is_angle: impl Fn(Symbol) -> bool,
    ) -> Self {
        Self::build(graph, roots, &is_angle, Functions::Unknown)
    }

    /// Compiled once, and not for every closure.
    fn build(
        graph: &Graph,
        roots: &[NodeId],
        is_angle: &dyn Fn(Symbol) -> bool,
        functions: Functions,
    ) -> Self {
        let opaque = functions == Functions::Unknown;
        let mut program = Program {
            operations: Vec::new(),
            origins: Vec::new(),
            constants: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            bare_angle: None,
            constant: 0,
        };
        let input_of = |id: NodeId| -> Option<Input> {
            match graph.node(id) {
                Node::Symbol(symbol) => Some(Input::Plain(symbol)),
                Node::Apply(function, argument) => match (function, graph.as_symbol(argument)) {
                    (Function::Sin, Some(symbol)) if is_angle(symbol) => Some(Input::Sine(symbol)),
                    (Function::Cos, Some(symbol)) if is_angle(symbol) => Some(Input::Cosine(symbol)),
                    _ => opaque.then_some(Input::Opaque(id)),
                },
                // pi is transcendental: rational expressions in it vanish only where they vanish for all its values
                Node::Pi => opaque.then_some(Input::Opaque(id)),
                _ => None,
            }
        };
        let mut place: HashMap<NodeId, u32> = HashMap::new();
        for id in needed(graph, roots, &input_of) {
            let at = |operand: NodeId| place[&operand];
            let operation = match (input_of(id), graph.node(id)) {
                (Some(input), _) => {
                    if let Input::Plain(symbol) = input
                        && is_angle(symbol)
                    {
                        program.bare_angle = Some(symbol);
                    }
                    program.inputs.push(input);
                    Operation::Input(program.inputs.len() as u32 - 1)
                }
                (None, node) => match node {
                    Node::Constant(index) => {
                        program.constants.push(graph.constant_at(index).clone());
                        Operation::Constant(program.constants.len() as u32 - 1)
                    }
                    Node::Pi => Operation::Pi,
                    Node::Add(a, b) => Operation::Add(at(a), at(b)),
                    Node::Sub(a, b) => Operation::Sub(at(a), at(b)),
                    Node::Mul(a, b) => Operation::Mul(at(a), at(b)),
                    Node::Div(a, b) => Operation::Div(at(a), at(b)),
                    Node::Neg(a) => Operation::Neg(at(a)),
                    Node::Power(a, n) => Operation::Power(at(a), n),
                    Node::Apply(function, a) => Operation::Apply(function, at(a)),
                    Node::Symbol(symbol) => unreachable!("symbol {symbol:?} is an input"),
                },
            };
            place.insert(id, program.operations.len() as u32);
            program.operations.push(operation);
            program.origins.push(id);
        }
        program.outputs = roots.iter().map(|root| place[root]).collect();
        program.constants_first();
        program
    }

    /// Moves what depends on no input to the front, so that it is computed once where a program is loaded.
    fn constants_first(&mut self) {
        let mut is_constant: Vec<bool> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let operands = operation.operands();
            let mut constant = operands.into_iter().flatten().map(|operand| is_constant[operand as usize]);
            is_constant.push(!matches!(operation, Operation::Input(_)) && constant.all(|one| one));
        }
        self.constant = is_constant.iter().filter(|one| **one).count();
        let mut order: Vec<usize> = (0..self.operations.len()).collect();
        order.sort_by_key(|place| !is_constant[*place]); // stable: operands stay before what is made of them
        let mut places = vec![0; order.len()];
        for (new, old) in order.iter().enumerate() {
            places[*old] = new as u32;
        }
        let place = |old: u32| places[old as usize];
        self.operations = order.iter().map(|old| self.operations[*old].with_operands(place)).collect();
        self.origins = order.iter().map(|old| self.origins[*old]).collect();
        self.outputs.iter_mut().for_each(|output| *output = place(*output));
    }

    /// The number of operations, inputs and constants included.
    pub fn len(&self) -> usize {
        self.operations.len()
    }

    /// Whether there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.operations.is_empty()
    }

    /// The node that each operation computes: when a program has run, its registers hold their values in this order.
    pub fn origins(&self) -> &[NodeId] {
        &self.origins
    }

    /// The inputs, in the order in which they are given.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// The nodes that it computes, in the order of its registers.
    pub fn nodes(&self) -> &[NodeId] {
        &self.origins
    }

    /// An angle that is met outside sines and cosines, and so has no exact value.
    pub fn bare_angle(&self) -> Option<Symbol> {
        self.bare_angle
    }

    /// A function that is treated as an unknown of its own, if there is one. (Pi is transcendental, and rightly an unknown.)
    pub fn unknown_function(&self, graph: &Graph) -> Option<NodeId> {
        self.inputs.iter().find_map(|input| match input {
            Input::Opaque(node) if graph.node(*node) != Node::Pi => Some(*node),
            _ => None,
        })
    }

    /// The program with its constants in the numbers of an arithmetic.
    ///
    /// # Errors
    /// Where a constant has no image (a denominator that vanishes modulo the prime).
    pub fn load<A: Arithmetic>(&self, arithmetic: A) -> Result<Loaded<'_, A>, Refusal> {
        let constants = self.constants.iter().map(|c| arithmetic.rational(c)).collect::<Result<_, _>>()?;
        let mut loaded = Loaded { program: self, arithmetic, constants, known: Vec::new() };
        // what is refused here is refused, and named, where it runs
        let mut known = Vec::with_capacity(self.constant);
        for operation in &self.operations[..self.constant] {
            match loaded.compute(*operation, &[], &known) {
                Ok(value) => known.push(value),
                Err(_) => break,
            }
        }
        loaded.known = known;
        Ok(loaded)
    }
}

/// The nodes to compute, operands first; below an input nothing is needed.
fn needed(graph: &Graph, roots: &[NodeId], input_of: &impl Fn(NodeId) -> Option<Input>) -> Vec<NodeId> {
    let mut found = std::collections::BTreeSet::new();
    let mut stack = roots.to_vec();
    while let Some(id) = stack.pop() {
        if found.insert(id) && input_of(id).is_none() {
            stack.extend(graph.node(id).operands());
        }
    }
    found.into_iter().collect()
}

/// A program over one arithmetic.
#[derive(Clone, Debug)]
pub struct Loaded<'p, A: Arithmetic> {
    program: &'p Program,
    arithmetic: A,
    constants: Vec<A::Number>,
    /// The values of the first operations: what depends on no input.
    known: Vec<A::Number>,
}

impl<A: Arithmetic> Loaded<'_, A> {
    /// The arithmetic it runs over.
    pub fn arithmetic(&self) -> &A {
        &self.arithmetic
    }

    /// The values of the program's expressions; `inputs` are in the order of [`Program::inputs`]. `registers` is room
    /// that is used again from call to call.
    ///
    /// # Errors
    /// The first operation that was refused.
    pub fn run(
        &self,
        inputs: &[A::Number],
        registers: &mut Vec<A::Number>,
    ) -> Result<Vec<A::Number>, Failure> {
        Ok(self.run_in(inputs, registers)?.cloned().collect())
    }

    /// The same where they lie in the registers: nothing is copied.
    ///
    /// # Errors
    /// As [`Loaded::run`].
    pub fn run_in<'r>(
        &self,
        inputs: &[A::Number],
        registers: &'r mut Vec<A::Number>,
    ) -> Result<impl Iterator<Item = &'r A::Number>, Failure> {
        budget::steps(self.program.operations.len());
        registers.clear();
        registers.extend_from_slice(&self.known);
        let first = self.known.len();
        for (operation, &node) in self.program.operations.iter().zip(&self.program.origins).skip(first) {
            let value = self.compute(*operation, inputs, registers);
            match value {
                Ok(value) => registers.push(value),
                Err(refusal) => {
                    let divides = matches!(refusal, Refusal::DivisionByZero | Refusal::DivisorNotSeparated);
                    let divisor = if divides { self.zero_factor(*operation, registers) } else { None };
                    return Err(Failure { refusal, node, divisor });
                }
            }
        }
        let registers: &'r [A::Number] = registers;
        Ok(self.program.outputs.iter().map(|index| &registers[*index as usize]))
    }

    /// The value of an operation from those before it. A call would move numbers of many derivatives twice.
    #[inline(always)]
    fn compute(
        &self,
        operation: Operation,
        inputs: &[A::Number],
        registers: &[A::Number],
    ) -> Result<A::Number, Refusal> {
        let arithmetic = &self.arithmetic;
        let at = |index: u32| &registers[index as usize];
        match operation {
            Operation::Constant(index) => Ok(self.constants[index as usize].clone()),
            Operation::Pi => arithmetic.pi(),
            Operation::Input(index) => Ok(inputs[index as usize].clone()),
            Operation::Add(a, b) => arithmetic.add(at(a), at(b)),
            Operation::Sub(a, b) => arithmetic.sub(at(a), at(b)),
            Operation::Mul(a, b) => arithmetic.mul(at(a), at(b)),
            Operation::Div(a, b) => arithmetic.div(at(a), at(b)),
            Operation::Neg(a) => arithmetic.neg(at(a)),
            Operation::Power(a, n) => arithmetic.power(at(a), n),
            Operation::Apply(function, a) => arithmetic.apply(function, at(a)),
        }
    }

    /// The factor of an operation's divisor that may be zero: through products, powers and quotients to the sum or
    /// the input that vanishes.
    fn zero_factor(&self, operation: Operation, registers: &[A::Number]) -> Option<NodeId> {
        let mut at = match operation {
            Operation::Div(_, b) => b,
            Operation::Power(a, n) if n < 0 => a,
            _ => return None,
        };
        let may_vanish = |index: u32| self.arithmetic.is_zero(&registers[index as usize]) != Some(false);
        loop {
            at = match self.program.operations[at as usize] {
                Operation::Mul(a, b) => {
                    if may_vanish(a) {
                        a
                    } else {
                        b
                    }
                }
                Operation::Div(a, _) | Operation::Neg(a) | Operation::Power(a, _) => a,
                _ => return Some(self.program.origins[at as usize]),
            };
        }
    }
}
