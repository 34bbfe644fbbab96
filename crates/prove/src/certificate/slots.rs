//! What tapes are given: the coordinates of a box, and their sines and cosines.

use palmistry_math::expression::{Graph, Node, NodeId, Symbol};
use palmistry_math::number::Function;

/// A function of one coordinate that is given to a tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum CoordinateFunction {
    /// The coordinate itself.
    Itself,
    Sine,
    Cosine,
    HalfSine,
    HalfCosine,
}

/// An input: which coordinate, and what of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Slot {
    pub coordinate: usize,
    pub function: CoordinateFunction,
}

/// All inputs of the tapes of one question.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    slots: Vec<Slot>,
    /// For each slot the one that its derivative is a multiple of (the cosine for the sine), and the factor.
    slopes: Vec<Option<(usize, f64)>>,
}

impl Slots {
    pub fn iter(&self) -> impl Iterator<Item = Slot> {
        self.slots.iter().copied()
    }

    /// The places of the slots of a coordinate.
    pub fn of(&self, coordinate: usize) -> impl Iterator<Item = usize> {
        let is_of = move |(_, slot): &(usize, &Slot)| slot.coordinate == coordinate;
        self.slots.iter().enumerate().filter(is_of).map(|(place, _)| place)
    }

    pub fn at(&self, place: usize) -> Slot {
        self.slots[place]
    }

    pub fn place(&mut self, coordinate: usize, function: CoordinateFunction) -> usize {
        let find =
            |slots: &[Slot], function| slots.iter().position(|slot| *slot == Slot { coordinate, function });
        if let Some(place) = find(&self.slots, function) {
            return place;
        }
        // a sine is never without its cosine, which is its slope, behind it
        let pair: &[(CoordinateFunction, CoordinateFunction, f64)] = match function {
            CoordinateFunction::Itself => &[],
            CoordinateFunction::Sine | CoordinateFunction::Cosine => &[
                (CoordinateFunction::Sine, CoordinateFunction::Cosine, 1.0),
                (CoordinateFunction::Cosine, CoordinateFunction::Sine, -1.0),
            ],
            CoordinateFunction::HalfSine | CoordinateFunction::HalfCosine => &[
                (CoordinateFunction::HalfSine, CoordinateFunction::HalfCosine, 0.5),
                (CoordinateFunction::HalfCosine, CoordinateFunction::HalfSine, -0.5),
            ],
        };
        let first = self.slots.len();
        if pair.is_empty() {
            self.slots.push(Slot { coordinate, function });
            self.slopes.push(None);
        }
        for (step, (function, _, factor)) in pair.iter().enumerate() {
            self.slots.push(Slot { coordinate, function: *function });
            self.slopes.push(Some((first + 1 - step, *factor)));
        }
        find(&self.slots, function).unwrap_or(first)
    }

    /// What the derivative of a slot by its coordinate is a multiple of: another slot, and the factor; `None` of the
    /// coordinate itself, whose derivative is one.
    pub fn slope(&self, place: usize) -> Option<(usize, f64)> {
        self.slopes[place]
    }
}

/// A symbol, or the sine or cosine of one or of half of one.
pub(super) fn as_coordinate_function(graph: &Graph, id: NodeId) -> Option<(Symbol, CoordinateFunction)> {
    let (function, argument) = match graph.node(id) {
        Node::Symbol(symbol) => return Some((symbol, CoordinateFunction::Itself)),
        Node::Apply(function @ (Function::Sin | Function::Cos), argument) => (function, argument),
        _ => return None,
    };
    if let Some(symbol) = graph.as_symbol(argument) {
        return Some((
            symbol,
            if function == Function::Sin { CoordinateFunction::Sine } else { CoordinateFunction::Cosine },
        ));
    }
    let Node::Mul(a, b) = graph.node(argument) else { return None };
    let is_half = |id| graph.constant_value(id).is_some_and(|c| (c + c).is_one());
    let symbol = match (graph.as_symbol(a), graph.as_symbol(b)) {
        (Some(symbol), None) if is_half(b) => symbol,
        (None, Some(symbol)) if is_half(a) => symbol,
        _ => return None,
    };
    Some((
        symbol,
        if function == Function::Sin { CoordinateFunction::HalfSine } else { CoordinateFunction::HalfCosine },
    ))
}
