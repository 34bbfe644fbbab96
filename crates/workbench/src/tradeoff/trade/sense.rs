//! Which combinations make no sense, and why.

use super::combination::{Derivative, Number, RankMethod};

/// Why a way to a derivative is not taken with a kind of number.
pub(super) fn no_derivative(number: Number, derivative: Derivative) -> &'static str {
    match (derivative, number) {
        (_, Number::Bounded) => "only block programs carry bounds along",
        (Derivative::Forward | Derivative::Central, Number::Interval) => {
            "an enclosure of a difference quotient does not enclose the derivative"
        }
        (Derivative::Forward | Derivative::Central, _) => "exact numbers for an inexact derivative",
        (Derivative::Duals, Number::Residue) => {
            "a residue has no order and no magnitude, which num-dual asks for"
        }
        (Derivative::Duals, _) => "num-dual asks for numbers of fixed size that have all functions",
        (Derivative::Blocks, _) => "the block program computes in doubles",
        (Derivative::Graph | Derivative::Series | Derivative::Expanded, _) => "there is no such program",
    }
}

/// Why a way to a rank is not taken with a kind of number.
pub(super) fn no_rank(number: Number, rank: RankMethod) -> &'static str {
    let exact = matches!(number, Number::Residue | Number::Rational);
    match rank {
        RankMethod::ExactElimination => "numbers that round do not know whether they are zero",
        RankMethod::BoundedElimination => "only doubles with bounds know their own error in blocks",
        _ if number == Number::Bounded => "it would not look at the bounds",
        RankMethod::IntervalElimination => "only intervals know their own error",
        RankMethod::Elimination if exact => "exact numbers need no threshold",
        RankMethod::Elimination if number == Number::Interval => "intervals need no threshold",
        RankMethod::Elimination => "LU with full pivoting is this elimination",
        _ if number == Number::Residue => "a residue has no magnitude",
        _ if exact => "square roots leave the rational numbers",
        _ if number == Number::Interval => "the libraries do not enclose",
        RankMethod::SvdEquilibrated | RankMethod::Jacobi => "it computes in doubles",
        _ => "the libraries decompose machine floats alone",
    }
}
