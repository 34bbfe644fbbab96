//! Operations as a tape of instructions on registers.
//!
//! A value that one operation alone uses is not stored: up to three operations make one instruction. Instructions are
//! ordered so that few values are alive at a time, and a register whose value is no longer needed is used again.

use super::operations::{Operation, Operations, Place, Root};
use crate::number::{Bounded, Function};

/// What an instruction does with `a`, `b`, `c`, `d`, by rows of [`Kind`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `a o b`
    Two,
    /// `(a o b) o c`
    Three,
    /// `(a o b) o (c o d)`
    Balanced,
    /// `((a o b) o c) o d`
    Chain,
    /// `1/a`, checked
    Reciprocal,
    /// `sin a` to the target and `cos a` to register `b`, checked
    SineCosine,
    /// Another function of `a`, checked
    Function(Function),
}

/// Two-place operations inside an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Sub,
    Mul,
    /// The second minus the first.
    Reversed,
}
use Operator::{Add, Mul, Reversed, Sub};

/// One pass over a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instruction {
    pub kind: Kind,
    pub operators: [Operator; 3],
    pub target: u32,
    pub operands: [u32; 4],
}

/// Where a result is found.
#[derive(Clone, Copy, Debug)]
pub(super) enum Slot {
    Constant(Bounded<f64>),
    Register(u32),
}

/// A straight-line program on registers.
#[derive(Clone, Debug, Default)]
pub(super) struct Tape {
    pub instructions: Vec<Instruction>,
    /// Registers that hold a constant throughout, from the first register on.
    pub constants: Vec<Bounded<f64>>,
    /// The register in which each input is expected; `None` where it is not used.
    pub inputs: Vec<Option<u32>>,
    pub outputs: Vec<Slot>,
    pub registers: usize,
    /// Operations on numbers, before they were put together.
    pub operations: usize,
}

const NOWHERE: u32 = u32::MAX;

/// An instruction whose operands are still operations.
#[derive(Clone, Copy)]
struct Tile {
    kind: Kind,
    operators: [Operator; 3],
    /// What it computes, and for [`Kind::SineCosine`] the cosine.
    results: [Place; 2],
    operands: [Place; 4],
    count: usize,
}

impl Tile {
    fn operands(&self) -> &[Place] {
        &self.operands[..self.count]
    }
}

impl Tape {
    pub fn new(operations: &Operations, inputs: usize) -> Tape {
        let tiles = tiles(operations);
        let order = schedule(operations, &tiles);
        allocate(operations, &tiles, &order, inputs)
    }
}

/// How often each operation is used; results and checked values count too.
fn uses(operations: &Operations) -> Vec<u32> {
    let mut uses = vec![0; operations.all.len()];
    for operation in &operations.all {
        for operand in operation.operands() {
            uses[operand as usize] += 1;
        }
    }
    for root in &operations.roots {
        if let Root::Place(place) = root {
            uses[*place as usize] += 2; // a result is stored, whatever else uses it
        }
    }
    for place in &operations.checked {
        uses[*place as usize] += 2;
    }
    uses
}

/// Covers the operations with instructions, from the results down. By operation; `None` where it is inside another tile,
/// an input or a constant.
fn tiles(operations: &Operations) -> Vec<Option<Tile>> {
    let all = &operations.all;
    let uses = uses(operations);
    let mut tiles: Vec<Option<Tile>> = vec![None; all.len()];
    let mut wanted = vec![false; all.len()];
    // the sine and the cosine of one argument are computed together
    let mut circular: std::collections::HashMap<Place, [Place; 2]> = std::collections::HashMap::new();
    for (place, operation) in all.iter().enumerate() {
        if let Operation::Circular(function, argument) = operation {
            let pair = circular.entry(*argument).or_insert([NOWHERE; 2]);
            pair[usize::from(*function == Function::Cos)] = place as Place;
        }
    }
    for root in &operations.roots {
        if let Root::Place(place) = root {
            wanted[*place as usize] = true;
        }
    }
    for place in &operations.checked {
        wanted[*place as usize] = true;
    }
    let binary = |place: Place| match all[place as usize] {
        Operation::Add(left, right) => Some(Binary { operator: Add, left, right }),
        Operation::Sub(left, right) => Some(Binary { operator: Sub, left, right }),
        Operation::Mul(left, right) => Some(Binary { operator: Mul, left, right }),
        _ => None,
    };
    let inner = |place: Place| binary(place).filter(|_| uses[place as usize] == 1);
    for place in (0..all.len() as Place).rev() {
        if !wanted[place as usize] {
            continue;
        }
        let simple = |kind, argument| Tile {
            kind,
            operators: [Add; 3],
            results: [place, NOWHERE],
            operands: [argument; 4],
            count: 1,
        };
        let tile = match all[place as usize] {
            Operation::Input(_) | Operation::Constant(_) => continue,
            Operation::Reciprocal(a) => simple(Kind::Reciprocal, a),
            Operation::Function(function, a) => simple(Kind::Function(function), a),
            Operation::Circular(_, a) => Tile { results: circular[&a], ..simple(Kind::SineCosine, a) },
            Operation::Add(left, right) => fused(place, Binary { operator: Add, left, right }, inner),
            Operation::Sub(left, right) => fused(place, Binary { operator: Sub, left, right }, inner),
            Operation::Mul(left, right) => fused(place, Binary { operator: Mul, left, right }, inner),
        };
        for operand in tile.operands() {
            wanted[*operand as usize] = true;
        }
        tiles[place as usize] = Some(tile);
    }
    tiles
}

/// An operation with two operands.
#[derive(Clone, Copy)]
struct Binary {
    operator: Operator,
    left: Place,
    right: Place,
}

/// The largest tile at an operation; `inner` gives operations that nothing else uses.
fn fused(place: Place, outermost: Binary, inner: impl Fn(Place) -> Option<Binary>) -> Tile {
    let Binary { operator, left: a, right: b } = outermost;
    let tile = |kind, operators, operands, count| Tile {
        kind,
        operators,
        results: [place, NOWHERE],
        operands,
        count,
    };
    // the operator when its operands are exchanged
    let turned = |operator| match operator {
        Sub => Reversed,
        other => other,
    };
    if let (Some(one), Some(other)) = (inner(a), inner(b)) {
        let operands = [one.left, one.right, other.left, other.right];
        return tile(Kind::Balanced, [one.operator, operator, other.operator], operands, 4);
    }
    let (outer, inside, other) = match (inner(a), inner(b)) {
        (Some(inside), _) => (operator, inside, b),
        (None, Some(inside)) => (turned(operator), inside, a),
        (None, None) => return tile(Kind::Two, [operator, Add, Add], [a, b, 0, 0], 2),
    };
    let Binary { operator: first, left: c, right: d } = inside;
    let (second, innermost, third) = match (inner(c), inner(d)) {
        (Some(innermost), _) => (first, innermost, d),
        (None, Some(innermost)) => (turned(first), innermost, c),
        (None, None) => return tile(Kind::Three, [first, outer, Add], [c, d, other, 0], 3),
    };
    let Binary { operator, left: e, right: f } = innermost;
    tile(Kind::Chain, [operator, second, outer], [e, f, third, other], 4)
}

/// An order of the tiles, operands first, those that need more registers before those that need fewer.
fn schedule(operations: &Operations, tiles: &[Option<Tile>]) -> Vec<Place> {
    // how many registers a tile takes when its operands are computed one after the other (R. Sethi and J. D. Ullman,
    // J. ACM 17, 1970; exact for trees, a guess where values are shared)
    let mut need = vec![0u32; tiles.len()];
    for (place, tile) in tiles.iter().enumerate() {
        let Some(tile) = tile else { continue };
        let mut needs: Vec<u32> = tile.operands().iter().map(|o| need[*o as usize]).collect();
        needs.sort_unstable_by(|a, b| b.cmp(a));
        let most = needs.iter().zip(0..).map(|(need, held)| need + held).max();
        need[place] = most.unwrap_or(0).max(1);
    }
    let mut order = Vec::new();
    let mut state = vec![0u8; tiles.len()]; // 1: being visited, 2: done
    let mut stack: Vec<Place> = Vec::new();
    let roots = operations.roots.iter().filter_map(|root| match root {
        Root::Place(place) => Some(*place),
        Root::Constant(_) => None,
    });
    for root in roots.chain(operations.checked.iter().copied()) {
        stack.push(root);
        while let Some(&place) = stack.last() {
            let Some(tile) = &tiles[place as usize] else {
                stack.pop();
                continue;
            };
            match state[place as usize] {
                0 => {
                    state[place as usize] = 1;
                    let mut operands: Vec<Place> = tile.operands().to_vec();
                    operands.sort_by_key(|operand| (need[*operand as usize], *operand));
                    stack.extend(operands.into_iter().filter(|operand| state[*operand as usize] == 0));
                }
                1 => {
                    stack.pop();
                    for result in tile.results.into_iter().filter(|result| *result != NOWHERE) {
                        state[result as usize] = 2;
                    }
                    order.push(place);
                }
                _ => {
                    stack.pop();
                }
            }
        }
    }
    order
}

fn allocate(operations: &Operations, tiles: &[Option<Tile>], order: &[Place], inputs: usize) -> Tape {
    let mut tape = Tape { inputs: vec![None; inputs], operations: count(operations), ..Tape::default() };
    let mut last_use = vec![0usize; tiles.len()];
    // times count from one; zero is never
    for (time, place) in (1..).zip(order) {
        for operand in tiles[*place as usize].iter().flat_map(Tile::operands) {
            last_use[*operand as usize] = time;
        }
    }
    for root in &operations.roots {
        if let Root::Place(place) = root {
            last_use[*place as usize] = usize::MAX;
        }
    }
    let mut register = vec![NOWHERE; tiles.len()];
    for (place, operation) in operations.all.iter().enumerate() {
        if let Operation::Constant(value) = operation
            && last_use[place] > 0
        {
            register[place] = tape.constants.len() as u32;
            tape.constants.push(*value);
            last_use[place] = usize::MAX;
        }
    }
    let mut registers = tape.constants.len() as u32;
    for (place, operation) in operations.all.iter().enumerate() {
        if let Operation::Input(input) = operation
            && last_use[place] > 0
        {
            register[place] = registers;
            tape.inputs[*input as usize] = Some(registers);
            registers += 1;
        }
    }
    let mut free: Vec<u32> = Vec::new();
    for (time, place) in (1..).zip(order) {
        let Some(tile) = &tiles[*place as usize] else { continue };
        let mut operands = [0; 4];
        for (slot, operand) in operands.iter_mut().zip(tile.operands()) {
            *slot = register[*operand as usize];
        }
        let mut take = |free: &mut Vec<u32>| {
            free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            })
        };
        // a target may be the register of an operand that ends here, but not the second target of two
        let second = (tile.kind == Kind::SineCosine).then(|| take(&mut free));
        let mut ended: Vec<Place> = tile.operands().to_vec();
        ended.sort_unstable();
        ended.dedup();
        for operand in ended {
            if last_use[operand as usize] == time {
                free.push(register[operand as usize]);
            }
        }
        let target = take(&mut free);
        if let Some(second) = second {
            operands[1] = second;
        }
        let targets = [Some(target), second];
        for (result, held) in tile.results.into_iter().zip(targets) {
            match (result, held) {
                (NOWHERE, Some(held)) => free.push(held),
                (result, Some(held)) => {
                    register[result as usize] = held;
                    if last_use[result as usize] == 0 {
                        free.push(held); // computed only to be checked
                    }
                }
                _ => {}
            }
        }
        tape.instructions.push(Instruction { kind: tile.kind, operators: tile.operators, target, operands });
    }
    tape.outputs = operations
        .roots
        .iter()
        .map(|root| match root {
            Root::Constant(value) => Slot::Constant(*value),
            Root::Place(place) => Slot::Register(register[*place as usize]),
        })
        .collect();
    tape.registers = registers as usize;
    tape
}

fn count(operations: &Operations) -> usize {
    let is_work = |o: &&Operation| !matches!(o, Operation::Input(_) | Operation::Constant(_));
    operations.all.iter().filter(is_work).count()
}
