//! A block program: expressions evaluated at many states at once, as fast as the processor can.
//!
//! From the shared graph to a tape: expressions become products of powers of sums (`flat`), products are multiplied out
//! with what they share computed once (`sharing`, `operations`), operations are put together to instructions, ordered, and given
//! registers (`tape`); each instruction is one loop over a block of states, structure of arrays (`machine`).
//!
//! The algebra is exact and the rounding is the program's own: results agree with those of a [`Program`] to within the
//! rounding of both, not bit by bit. They are the same bits on every processor.
//!
//! [`Program`]: crate::expression::Program

mod flat;
mod machine;
mod operations;
mod sharing;
mod tape;

use super::graph::{Graph, Node, NodeId, Symbol};
use super::input::Input;
use crate::number::{Function, Instructions, Lanes, MOST_LANES, Vectorised};
use dashu::rational::RBig;
use flat::Flat;
pub use machine::Machine;
use operations::Operations;
use tape::Tape;

/// A straight-line program over blocks of states.
#[derive(Clone, Debug)]
pub struct BlockProgram {
    tape: Tape,
    inputs: Vec<Input>,
    undefined: bool,
}

impl BlockProgram {
    /// The program for `roots`. Sines and cosines of a bare angle become inputs; those of anything else are computed.
    ///
    /// What is divided by and what functions are applied to is checked, in `roots` and in `watched`, of which nothing
    /// else is computed: a state at which a value does not exist is reported even where it has no influence.
    ///
    /// Inputs of which a value is `known` become constants.
    pub fn new(
        graph: &Graph,
        roots: &[NodeId],
        watched: &[NodeId],
        is_angle: impl Fn(Symbol) -> bool,
        known: impl Fn(Input) -> Option<RBig>,
    ) -> Self {
        let input_of = |id: NodeId| match graph.node(id) {
            Node::Symbol(symbol) => Some(Input::Plain(symbol)),
            Node::Apply(function, argument) => match (function, graph.as_symbol(argument)) {
                (Function::Sin, Some(symbol)) if is_angle(symbol) => Some(Input::Sine(symbol)),
                (Function::Cos, Some(symbol)) if is_angle(symbol) => Some(Input::Cosine(symbol)),
                _ => None,
            },
            _ => None,
        };
        let flat = Flat::new(graph, roots, watched, &input_of, &known);
        let operations = Operations::new(&flat);
        let tape = Tape::new(&operations, flat.inputs.len());
        BlockProgram { tape, inputs: flat.inputs, undefined: operations.undefined }
    }

    /// The inputs, in the order in which they are given.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// Whether an input has any influence on the results and on what is checked.
    pub fn is_used(&self, place: usize) -> bool {
        self.tape.inputs.get(place).is_some_and(Option::is_some)
    }

    /// How many results there are.
    pub fn outputs(&self) -> usize {
        self.tape.outputs.len()
    }

    /// Operations on numbers for one state.
    pub fn operations(&self) -> usize {
        self.tape.operations
    }

    /// Passes over a block.
    pub fn passes(&self) -> usize {
        self.tape.instructions.len()
    }

    /// Values that are held at once.
    pub fn registers(&self) -> usize {
        self.tape.registers
    }

    /// Whether there is no state at all at which everything exists: a constant that is zero is divided by, or a constant
    /// is needed that no double can hold.
    pub fn is_undefined(&self) -> bool {
        self.undefined
    }

    /// The program with room for its registers, over numbers of which `zero` is one.
    #[inline(always)]
    pub fn machine<L: Lanes>(&self, zero: L) -> Machine<'_, L> {
        Machine::new(&self.tape, zero)
    }

    /// The same for blocks of a given length, or one more.
    #[inline(always)]
    pub fn machine_of<L: Lanes>(&self, zero: L, lanes: usize) -> Machine<'_, L> {
        Machine::with_lanes(&self.tape, zero, lanes)
    }

    /// The results at many states: one slice per input, in the order of [`BlockProgram::inputs`], and one per output, all
    /// as long as there are states. Returns the states, by their places, at which a result or something on the way to
    /// it is not finite; their results are not to be used.
    pub fn evaluate(&self, inputs: &[&[f64]], outputs: &mut [&mut [f64]]) -> Vec<usize> {
        self.evaluate_with(Instructions::detect(), inputs, outputs)
    }

    /// The same with chosen instructions, which change nothing but the time it takes.
    pub fn evaluate_with(
        &self,
        instructions: Instructions,
        inputs: &[&[f64]],
        outputs: &mut [&mut [f64]],
    ) -> Vec<usize> {
        instructions.run(Evaluation { program: self, inputs, outputs })
    }
}

struct Evaluation<'a, 'b, 'c> {
    program: &'a BlockProgram,
    inputs: &'a [&'b [f64]],
    outputs: &'a mut [&'c mut [f64]],
}

impl Vectorised for Evaluation<'_, '_, '_> {
    type Output = Vec<usize>;

    #[inline(always)]
    fn run<L: Lanes>(self, zero: L) -> Vec<usize> {
        let Evaluation { program, inputs, outputs } = self;
        let count = outputs.iter().map(|o| o.len()).chain(inputs.iter().map(|i| i.len())).min().unwrap_or(0);
        let mut machine = program.machine(zero);
        let mut lost = Vec::new();
        let mut health = vec![zero; machine.lanes()];
        let mut buffer = [0.0; MOST_LANES];
        let mut start = 0;
        while start < count {
            for (place, values) in inputs.iter().enumerate() {
                let Some(room) = machine.input(place) else { continue };
                for (k, lane) in room.iter_mut().enumerate() {
                    let from = start + k * L::COUNT;
                    if from + L::COUNT <= count {
                        *lane = zero.load(&values[from..]);
                    } else {
                        // the last state again, where there are none left
                        for (i, value) in buffer.iter_mut().enumerate() {
                            *value = values[(from + i).min(count - 1)];
                        }
                        *lane = zero.load(&buffer);
                    }
                }
            }
            machine.run();
            for (lane, health) in health.iter_mut().enumerate() {
                *health = machine.health(lane);
            }
            for (place, values) in outputs.iter_mut().enumerate() {
                let row = match machine.row(place) {
                    Ok(row) => row,
                    Err(constant) if start == 0 => {
                        constant.store(&mut buffer);
                        values.fill(buffer[0]);
                        continue;
                    }
                    Err(_) => continue,
                };
                for (lane, value) in row.iter().enumerate() {
                    health[lane] = health[lane] + value.zero_if_finite();
                    let first = start + lane * L::COUNT;
                    if first + L::COUNT <= count {
                        value.store(&mut values[first..]);
                    } else if first < count {
                        value.store(&mut buffer);
                        values[first..count].copy_from_slice(&buffer[..count - first]);
                    }
                }
            }
            for (lane, health) in health.iter().enumerate() {
                let first = start + lane * L::COUNT;
                health.store(&mut buffer);
                let here = L::COUNT.min(count.saturating_sub(first));
                if program.undefined || buffer[..here].iter().any(|mark| *mark != 0.0) {
                    lost.extend(
                        (0..here).filter(|i| program.undefined || buffer[*i] != 0.0).map(|i| first + i),
                    );
                }
            }
            start += machine.states();
        }
        lost
    }
}
