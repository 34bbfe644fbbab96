//! The ways in which one condition can be met.

use palmistry_math::expression::{NodeId, Symbol};

/// How a condition `expression = 0` is met. The order is that in which conditions are taken: those first that leave
/// nothing open.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// One of these vanishes.
    Factors(Vec<NodeId>),
    /// `symbol = value`, and nothing else.
    Value(Symbol, NodeId),
    /// The angle has one of these values, up to whole turns.
    Turns(Symbol, Vec<NodeId>),
    /// `slope symbol + rest = 0`: the value where the slope is not zero, and any where both vanish.
    Linear { symbol: Symbol, value: NodeId, slope: NodeId, rest: NodeId, apart: Apart },
    /// A sum of terms of which none is negative: all of these vanish.
    All(Vec<NodeId>),
    /// What is nowhere negative: where it vanishes these do, its derivatives.
    Touching(Vec<NodeId>),
    /// By no way that is known.
    Unknown,
}

/// What is known of the states at which slope and rest of a linear condition vanish together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Apart {
    /// They have no common factor: these states have two dimensions less.
    Coprime,
    /// They may have one.
    Shared,
    /// Functions are met of which nothing is known but their names: either may be zero everywhere.
    NotKnown,
}

impl Apart {
    /// How many dimensions less these states have, at the least.
    pub(super) fn dimensions(self) -> usize {
        match self {
            Apart::Coprime => 2,
            Apart::Shared => 1,
            Apart::NotKnown => 0,
        }
    }
}

impl Way {
    /// Ways of a lower rank are taken first.
    pub(super) fn rank(&self) -> u8 {
        match self {
            Way::Value(..) => 0,
            Way::Turns(..) | Way::All(_) => 1,
            Way::Linear { apart: Apart::Coprime, .. } => 2,
            Way::Factors(_) => 3,
            Way::Linear { .. } => 4,
            Way::Touching(_) => 5,
            Way::Unknown => 6,
        }
    }
}
