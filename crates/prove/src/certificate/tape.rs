//! One expression in the coordinates of a box, ready to be evaluated millions of times, over intervals and over doubles
//! alike, with its derivatives by the coordinates (in reverse, so that all of them cost as much as a few values).
//!
//! What does not depend on a coordinate is folded into constants. The sine and the cosine of a coordinate, or of half of
//! it, are inputs of their own: the same few are needed by every expression, at the same few places.

use super::slots::{Slots, as_coordinate_function};
use palmistry_math::expression::{Graph, Need, Node, NodeId, Symbol};
use palmistry_math::number::{Function, Interval, RealNumber};
use std::collections::HashMap;

#[derive(Clone, Copy, Debug)]
enum Operation {
    Constant(u32),
    Slot(u32),
    Add(u32, u32),
    Sub(u32, u32),
    Mul(u32, u32),
    Div(u32, u32),
    Neg(u32),
    Power(u32, i32),
    Apply(Function, u32),
}

/// What a symbol is on a region.
#[derive(Clone, Debug)]
pub(super) enum Role {
    /// A coordinate of the box.
    Free(usize),
    /// Known to lie in this interval.
    Held(Interval),
}

/// An expression as a list of operations.
#[derive(Clone, Debug)]
pub(super) struct Tape {
    operations: Vec<Operation>,
    intervals: Vec<Interval>,
    doubles: Vec<f64>,
    /// What its operations need of their operands to be defined.
    needs: Vec<(u32, Need)>,
    /// The slots that it needs.
    pub slots: Vec<usize>,
    /// The coordinates that it depends on.
    pub coordinates: Vec<usize>,
}

/// Numbers that a tape computes with: their own image of its constants.
pub(super) trait Scalar: RealNumber {
    fn constants(tape: &Tape) -> &[Self];
}

impl Scalar for Interval {
    fn constants(tape: &Tape) -> &[Self] {
        &tape.intervals
    }
}

impl Scalar for f64 {
    fn constants(tape: &Tape) -> &[Self] {
        &tape.doubles
    }
}

/// Room for the values and the derivatives of one evaluation, to be used again.
#[derive(Clone, Debug)]
pub(super) struct Room<T> {
    values: Vec<T>,
    slopes: Vec<T>,
    /// The derivatives by the slots.
    pub by_slots: Vec<T>,
}

impl<T> Default for Room<T> {
    fn default() -> Self {
        Room { values: Vec::new(), slopes: Vec::new(), by_slots: Vec::new() }
    }
}

/// The range of an expression, and the values of its operations on the way to it.
pub(super) struct Range<'r> {
    pub value: Interval,
    tape: &'r Tape,
    room: &'r Room<Interval>,
}

impl Range<'_> {
    /// Whether all operations are defined, and continuous, wherever the slots may lie.
    pub fn is_defined(&self) -> bool {
        let met = |(place, need): &(u32, Need)| {
            let value = self.room.values.get(*place as usize);
            value.is_some_and(|value| need.is_met_by_interval(*value) == Some(true))
        };
        self.tape.needs.iter().all(met)
    }
}

impl Tape {
    /// The tape of an expression. `role` says what each symbol is.
    ///
    /// # Errors
    /// The symbol of which nothing is known.
    pub fn new(
        graph: &Graph,
        root: NodeId,
        role: impl Fn(Symbol) -> Option<Role>,
        slots: &mut Slots,
    ) -> Result<Tape, Symbol> {
        let mut tape = Tape {
            operations: Vec::new(),
            intervals: Vec::new(),
            doubles: Vec::new(),
            needs: Vec::new(),
            slots: Vec::new(),
            coordinates: Vec::new(),
        };
        let mut place: HashMap<NodeId, u32> = HashMap::new();
        let mut functions: HashMap<NodeId, usize> = HashMap::new();
        let order = graph.reachable([root]);
        for &id in &order {
            if let Some((symbol, function)) = as_coordinate_function(graph, id)
                && let Some(Role::Free(coordinate)) = role(symbol)
            {
                functions.insert(id, slots.place(coordinate, function));
            }
        }
        // what only a function's argument needs is not computed
        let mut needed = std::collections::BTreeSet::new();
        let mut stack = vec![root];
        while let Some(id) = stack.pop() {
            if needed.insert(id) && !functions.contains_key(&id) {
                stack.extend(graph.node(id).operands());
            }
        }
        for id in needed {
            let operation = match (functions.get(&id), graph.node(id)) {
                (Some(slot), _) => {
                    tape.slots.push(*slot);
                    Operation::Slot(*slot as u32)
                }
                (None, Node::Symbol(symbol)) => match role(symbol) {
                    Some(Role::Held(value)) => tape.constant(value),
                    _ => return Err(symbol),
                },
                (None, Node::Constant(_)) => {
                    let value = graph.constant_value(id).map_or(Interval::WHOLE, Interval::from_rational);
                    tape.constant(value)
                }
                (None, Node::Pi) => tape.constant(Interval::PI),
                (None, node) => {
                    let operation = operation(node, &place);
                    tape.needs.extend(need(operation));
                    tape.folded(operation)
                }
            };
            place.insert(id, tape.operations.len() as u32);
            tape.operations.push(operation);
        }
        tape.coordinates = tape.slots.iter().map(|place| slots.at(*place).coordinate).collect();
        tape.coordinates.sort_unstable();
        tape.coordinates.dedup();
        Ok(tape)
    }

    fn constant(&mut self, value: Interval) -> Operation {
        self.intervals.push(value);
        self.doubles.push(value.mid());
        Operation::Constant(self.intervals.len() as u32 - 1)
    }

    /// An operation on constants is a constant.
    fn folded(&mut self, operation: Operation) -> Operation {
        let known = |place: u32| match self.operations[place as usize] {
            Operation::Constant(index) => Some(self.intervals[index as usize]),
            _ => None,
        };
        let value = match operation {
            Operation::Constant(_) | Operation::Slot(_) => None,
            Operation::Add(a, b) => known(a).zip(known(b)).map(|(a, b)| a + b),
            Operation::Sub(a, b) => known(a).zip(known(b)).map(|(a, b)| a - b),
            Operation::Mul(a, b) => known(a).zip(known(b)).map(|(a, b)| a * b),
            Operation::Div(a, b) => known(a).zip(known(b)).map(|(a, b)| a / b),
            Operation::Neg(a) => known(a).map(|a| -a),
            Operation::Power(a, n) => known(a).map(|a| power(a, n)),
            Operation::Apply(function, a) => known(a).map(|a| apply(function, a)),
        };
        value.map_or(operation, |value| self.constant(value))
    }

    /// The number of operations.
    pub fn len(&self) -> usize {
        self.operations.len()
    }

    /// The value, from the values of the slots.
    pub fn value<T: Scalar>(&self, slots: &[T], room: &mut Room<T>) -> T {
        let constants = T::constants(self);
        room.values.clear();
        for operation in &self.operations {
            let at = |place: u32| room.values[place as usize];
            let value = match *operation {
                Operation::Constant(index) => constants[index as usize],
                Operation::Slot(slot) => slots[slot as usize],
                Operation::Add(a, b) => at(a) + at(b),
                Operation::Sub(a, b) => at(a) - at(b),
                Operation::Mul(a, b) => at(a) * at(b),
                Operation::Div(a, b) => at(a) / at(b),
                Operation::Neg(a) => -at(a),
                Operation::Power(a, n) => power(at(a), n),
                Operation::Apply(function, a) => apply(function, at(a)),
            };
            room.values.push(value);
        }
        room.values.last().copied().unwrap_or(T::from_f64(f64::NAN))
    }

    /// The range over what the slots enclose.
    pub fn range<'r>(&'r self, slots: &[Interval], room: &'r mut Room<Interval>) -> Range<'r> {
        let value = self.value(slots, room);
        Range { value, tape: self, room }
    }

    /// The value, and in `room.by_slots` the derivatives by the slots.
    pub fn gradient<T: Scalar>(&self, slots: &[T], room: &mut Room<T>) -> T {
        let value = self.value(slots, room);
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        room.slopes.clear();
        room.slopes.resize(self.operations.len(), zero);
        room.by_slots.clear();
        room.by_slots.resize(slots.len(), zero);
        if let Some(last) = room.slopes.last_mut() {
            *last = one;
        }
        let (values, slopes) = (&room.values, &mut room.slopes);
        for (place, operation) in self.operations.iter().enumerate().rev() {
            let slope = slopes[place];
            let at = |place: u32| values[place as usize];
            let mut pass = |to: u32, part: T| slopes[to as usize] = slopes[to as usize] + part;
            match *operation {
                Operation::Constant(_) => {}
                Operation::Slot(slot) => {
                    room.by_slots[slot as usize] = room.by_slots[slot as usize] + slope;
                }
                Operation::Add(a, b) => {
                    pass(a, slope);
                    pass(b, slope);
                }
                Operation::Sub(a, b) => {
                    pass(a, slope);
                    pass(b, -slope);
                }
                Operation::Mul(a, b) => {
                    pass(a, slope * at(b));
                    pass(b, slope * at(a));
                }
                Operation::Div(a, b) => {
                    pass(a, slope / at(b));
                    pass(b, -(slope * values[place] / at(b)));
                }
                Operation::Neg(a) => pass(a, -slope),
                Operation::Power(a, n) => {
                    pass(a, slope * power(at(a), n - 1) * T::from_f64(f64::from(n)));
                }
                Operation::Apply(function, a) => pass(a, slope * rate(function, at(a), values[place])),
            }
        }
        value
    }

    /// What the derivatives by its slots say of the derivatives by the coordinates that it depends on. `inputs` are the
    /// values of the slots.
    pub fn by_coordinates<T: RealNumber>(
        &self,
        slots: &Slots,
        by_slots: &[T],
        inputs: &[T],
        found: &mut [T],
    ) {
        let zero = T::from_f64(0.0);
        for coordinate in &self.coordinates {
            found[*coordinate] = zero;
        }
        for place in &self.slots {
            let slope = match slots.slope(*place) {
                None => by_slots[*place],
                Some((other, factor)) => by_slots[*place] * inputs[other] * T::from_f64(factor),
            };
            let sum = &mut found[slots.at(*place).coordinate];
            *sum = *sum + slope;
        }
    }
}

fn operation(node: Node, place: &HashMap<NodeId, u32>) -> Operation {
    let at = |id: NodeId| place[&id];
    match node {
        Node::Add(a, b) => Operation::Add(at(a), at(b)),
        Node::Sub(a, b) => Operation::Sub(at(a), at(b)),
        Node::Mul(a, b) => Operation::Mul(at(a), at(b)),
        Node::Div(a, b) => Operation::Div(at(a), at(b)),
        Node::Neg(a) => Operation::Neg(at(a)),
        Node::Power(a, n) => Operation::Power(at(a), n),
        Node::Apply(function, a) => Operation::Apply(function, at(a)),
        Node::Constant(_) | Node::Pi | Node::Symbol(_) => unreachable!("these have no operands"),
    }
}

/// What an operation needs, and of which operand.
fn need(operation: Operation) -> Option<(u32, Need)> {
    match operation {
        Operation::Div(_, b) => Some((b, Need::NotZero)),
        Operation::Power(a, n) if n < 0 => Some((a, Need::NotZero)),
        Operation::Apply(function, a) => Need::of(function).map(|need| (a, need)),
        _ => None,
    }
}

/// `a^n`; what is not defined is a NaN, or the whole line.
fn power<T: RealNumber>(a: T, n: i32) -> T {
    a.power(n).unwrap_or(T::from_f64(f64::NAN))
}

fn apply<T: RealNumber>(function: Function, a: T) -> T {
    a.function(function).unwrap_or(T::from_f64(f64::NAN))
}

/// The derivative of a function where its argument and its value are known.
fn rate<T: RealNumber>(function: Function, a: T, value: T) -> T {
    let one = T::from_f64(1.0);
    match function {
        Function::Sin => apply(Function::Cos, a),
        Function::Cos => -apply(Function::Sin, a),
        Function::Exp => value,
        Function::Log => one / a,
        Function::Sqrt => one / (value + value),
        Function::Atan => one / (one + power(a, 2)),
        Function::Asin => one / apply(Function::Sqrt, one - power(a, 2)),
        Function::Acos => -(one / apply(Function::Sqrt, one - power(a, 2))),
    }
}
