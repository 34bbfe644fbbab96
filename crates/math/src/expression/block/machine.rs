//! Running a tape over a block of states: each instruction is one loop over the block.
//!
//! A register holds one value of every state of the block, and the registers together fit into the first-level cache.
//! They lie apart by one cache line more than they are long, because addresses that agree in their last twelve bits
//! disturb each other.

use super::tape::{Instruction, Kind, Operator, Slot, Tape};
use crate::number::{Function, LaneTask, Lanes};
use std::cell::Cell;

/// A tape with room for its registers.
pub struct Machine<'t, L> {
    tape: &'t Tape,
    zero: L,
    /// Lanes in a register; one more lies between registers.
    length: usize,
    registers: Vec<L>,
    /// Zero where every checked value so far is finite (and no divisor zero), else not a number.
    health: Vec<L>,
}

/// The registers should not need more than this many bytes.
const CACHE: usize = 64 << 10;
/// A block has at least and at most so many lanes: less, and most time goes into finding the next instruction.
const SHORTEST: usize = 4;
const LONGEST: usize = 16;
/// The same in states, for lanes of many doubles: both come to an even number of lanes.
const FEWEST: usize = 32;
const MOST: usize = 128;

impl<'t, L: Lanes> Machine<'t, L> {
    /// A machine over the numbers of which `zero` is one.
    #[inline(always)]
    pub(super) fn new(tape: &'t Tape, zero: L) -> Self {
        let fitting = CACHE / (size_of::<L>() * (tape.registers + 1));
        let (shortest, longest) = (SHORTEST.min(FEWEST / L::COUNT), LONGEST.min(MOST / L::COUNT));
        Self::with_lanes(tape, zero, fitting.saturating_sub(1).clamp(shortest, longest))
    }

    /// The same for blocks of a given length, or one more.
    #[inline(always)]
    pub(super) fn with_lanes(tape: &'t Tape, zero: L, lanes: usize) -> Self {
        let length = lanes.next_multiple_of(2);
        let mut registers = vec![zero; (tape.registers + 1) * (length + 1)];
        for (constant, register) in tape.constants.iter().zip(registers.chunks_mut(length + 1)) {
            register.fill(zero.splat(constant.value).within(constant.units));
        }
        Machine { tape, zero, length, registers, health: vec![zero; length] }
    }

    /// How many lanes a block has.
    pub fn lanes(&self) -> usize {
        self.length
    }

    /// How many states a block has.
    pub fn states(&self) -> usize {
        self.length * L::COUNT
    }

    /// Room for the values of an input, one per lane; `None` where the input has no influence. It must be filled before
    /// every run.
    #[inline(always)]
    pub fn input(&mut self, place: usize) -> Option<&mut [L]> {
        let register = self.tape.inputs.get(place).copied().flatten()? as usize;
        self.registers.get_mut(register * (self.length + 1)..)?.get_mut(..self.length)
    }

    /// A result in one lane, after a run.
    #[inline(always)]
    pub fn output(&self, place: usize, lane: usize) -> L {
        match self.tape.outputs[place] {
            Slot::Register(register) => self.registers[register as usize * (self.length + 1) + lane],
            Slot::Constant(value) => self.zero.splat(value.value).within(value.units),
        }
    }

    /// Where a result is found: in a register, or a constant.
    #[inline(always)]
    pub(super) fn row(&self, place: usize) -> Result<&[L], L> {
        match self.tape.outputs[place] {
            Slot::Register(register) => {
                Ok(&self.registers[register as usize * (self.length + 1)..][..self.length])
            }
            Slot::Constant(value) => Err(self.zero.splat(value.value).within(value.units)),
        }
    }

    /// Zero in each lane where nothing went wrong, and not a number where a divisor was zero or infinite or a function
    /// had no finite value. Where bounds on errors are kept, its own is not a number where a bound is none.
    #[inline(always)]
    pub fn health(&self, lane: usize) -> L {
        self.health[lane]
    }

    /// Computes all results of a block.
    pub fn run(&mut self) {
        self.zero.apart(Run(self));
    }
}

struct Run<'m, 't, L>(&'m mut Machine<'t, L>);

impl<L: Lanes> LaneTask for Run<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Machine { tape, zero, length, registers, health } = self.0;
        health.fill(*zero);
        let cells = Cell::from_mut(&mut registers[..]).as_slice_of_cells();
        let health = Cell::from_mut(&mut health[..]).as_slice_of_cells();
        for instruction in &tape.instructions {
            step(instruction, cells, health, *length);
        }
    }
}

/// A register.
#[inline(always)]
fn register<L>(cells: &[Cell<L>], register: u32, length: usize) -> &[Cell<L>] {
    &cells[register as usize * (length + 1)..][..length]
}

/// A two-place operation as a type.
trait Binary {
    fn apply<L: Lanes>(a: L, b: L) -> L;
}

macro_rules! binary {
    ($($name:ident $a:ident $b:ident $value:expr;)*) => {$(
        struct $name;
        impl Binary for $name {
            #[inline(always)]
            fn apply<L: Lanes>($a: L, $b: L) -> L {
                $value
            }
        }
    )*};
}
binary! {
    Plus a b a + b;
    Minus a b a - b;
    Times a b a * b;
    Turned a b b - a;
}

macro_rules! pass {
    ($name:ident $($operator:ident)*; $($operand:ident $place:literal)*; $value:expr) => {
        #[inline(always)]
        fn $name<L: Lanes, $($operator: Binary),*>(i: &Instruction, cells: &[Cell<L>], length: usize) {
            $(let $operand = register(cells, i.operands[$place], length);)*
            let target = register(cells, i.target, length);
            for k in 0..length {
                $(let $operand = $operand[k].get();)*
                target[k].set($value);
            }
        }
    };
}
pass!(two P; a 0 b 1; P::apply(a, b));
pass!(three P Q; a 0 b 1 c 2; Q::apply(P::apply(a, b), c));
pass!(balanced P Q R; a 0 b 1 c 2 d 3; Q::apply(P::apply(a, b), R::apply(c, d)));
pass!(chain P Q R; a 0 b 1 c 2 d 3; R::apply(Q::apply(P::apply(a, b), c), d));

/// The same for an operator that is never turned round.
macro_rules! forward {
    ($operator:expr, $name:ident => $code:expr) => {
        match $operator {
            Operator::Add => {
                type $name = Plus;
                $code
            }
            Operator::Sub => {
                type $name = Minus;
                $code
            }
            _ => {
                type $name = Times;
                $code
            }
        }
    };
}

/// Code with an operator as a type: compiled once for each.
macro_rules! with {
    ($operator:expr, $name:ident => $code:expr) => {
        match $operator {
            Operator::Add => {
                type $name = Plus;
                $code
            }
            Operator::Sub => {
                type $name = Minus;
                $code
            }
            Operator::Mul => {
                type $name = Times;
                $code
            }
            Operator::Reversed => {
                type $name = Turned;
                $code
            }
        }
    };
}

/// Two lanes at a time, so that finding out what to do is not most of the work.
type Two<L> = [L; 2];

#[inline(always)]
fn pair<L: Copy>(register: &[Cell<L>], k: usize) -> Two<L> {
    [register[k].get(), register[k + 1].get()]
}

#[inline(always)]
fn apply<L: Lanes>(operator: Operator, [a, c]: Two<L>, [b, d]: Two<L>) -> Two<L> {
    match operator {
        Operator::Add => [a + b, c + d],
        Operator::Sub => [a - b, c - d],
        Operator::Mul => [a * b, c * d],
        Operator::Reversed => [b - a, d - c],
    }
}

#[inline(always)]
fn step<L: Lanes>(i: &Instruction, cells: &[Cell<L>], health: &[Cell<L>], length: usize) {
    let [p, q, r] = i.operators;
    let [a, b, c, d] = i.operands;
    let (a, b) = (register(cells, a, length), register(cells, b, length));
    let (c, d) = (register(cells, c, length), register(cells, d, length));
    let target = register(cells, i.target, length);
    match i.kind {
        Kind::Two if L::SIMPLE => forward!(p, P => two::<L, P>(i, cells, length)),
        Kind::Three if L::SIMPLE => forward!(p, P => with!(q, Q => three::<L, P, Q>(i, cells, length))),
        Kind::Balanced if L::SIMPLE => {
            forward!(p, P => forward!(q, Q => forward!(r, R => balanced::<L, P, Q, R>(i, cells, length))));
        }
        Kind::Chain if L::SIMPLE => {
            forward!(p, P => with!(q, Q => with!(r, R => chain::<L, P, Q, R>(i, cells, length))));
        }
        Kind::Two => {
            for k in (0..length).step_by(2) {
                let [x, y] = apply(p, pair(a, k), pair(b, k));
                target[k].set(x);
                target[k + 1].set(y);
            }
        }
        Kind::Three => {
            for k in (0..length).step_by(2) {
                let [x, y] = apply(q, apply(p, pair(a, k), pair(b, k)), pair(c, k));
                target[k].set(x);
                target[k + 1].set(y);
            }
        }
        Kind::Balanced => {
            for k in (0..length).step_by(2) {
                let (left, right) = (apply(p, pair(a, k), pair(b, k)), apply(r, pair(c, k), pair(d, k)));
                let [x, y] = apply(q, left, right);
                target[k].set(x);
                target[k + 1].set(y);
            }
        }
        Kind::Chain => {
            for k in (0..length).step_by(2) {
                let inner = apply(q, apply(p, pair(a, k), pair(b, k)), pair(c, k));
                let [x, y] = apply(r, inner, pair(d, k));
                target[k].set(x);
                target[k + 1].set(y);
            }
        }
        Kind::Reciprocal => {
            for k in 0..length {
                let x = a[k].get();
                let value = x.splat(1.0) / x;
                target[k].set(value);
                check(x, value, &health[k]);
            }
        }
        Kind::SineCosine => {
            for k in 0..length {
                let x = a[k].get();
                let (sine, cosine) = x.sin_cos();
                target[k].set(sine);
                b[k].set(cosine);
                check(x, sine, &health[k]);
            }
        }
        Kind::Function(function) => {
            for k in 0..length {
                let x = a[k].get();
                let value = if function == Function::Sqrt { x.sqrt() } else { x.apply(function) };
                target[k].set(value);
                check(x, value, &health[k]);
                if function != Function::Sqrt {
                    health[k].set(health[k].get() + value.splat(0.0).without_bound());
                }
            }
        }
    }
}

/// Infinities survive sums and products, but not a division by them nor every function: so arguments and values of
/// these are looked at. (The sum of an argument and its value does not
/// overflow by itself: one of them is small where the other is large.)
#[inline(always)]
fn check<L: Lanes>(argument: L, value: L, health: &Cell<L>) {
    health.set(health.get() + (argument + value).zero_if_finite());
}
