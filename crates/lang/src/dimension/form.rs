//! A dimension with unknowns in it: a known one, times powers of unknown ones.

use super::exponents::Dimension;
use dashu::rational::RBig;

/// An unknown dimension, by its place in the solution.
pub(super) type Unknown = usize;

/// A dimension times powers of unknown ones, each unknown once, in order, and with an exponent that is not zero.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub(super) struct Form {
    pub known: Dimension,
    pub unknown: Vec<(Unknown, RBig)>,
}

impl Form {
    pub fn number() -> Form {
        Form::default()
    }

    pub fn known(dimension: Dimension) -> Form {
        Form { known: dimension, unknown: Vec::new() }
    }

    pub fn unknown(unknown: Unknown) -> Form {
        Form { known: Dimension::none(), unknown: vec![(unknown, RBig::ONE)] }
    }

    pub fn times(&self, other: &Form) -> Form {
        self.times_power(other, &RBig::ONE)
    }

    pub fn over(&self, other: &Form) -> Form {
        self.times_power(other, &-RBig::ONE)
    }

    pub fn power(&self, exponent: &RBig) -> Form {
        Form::number().times_power(self, exponent)
    }

    /// `self * other^exponent`
    pub fn times_power(&self, other: &Form, exponent: &RBig) -> Form {
        let known = self.known.times(&other.known.power(exponent));
        if other.unknown.is_empty() || exponent.is_zero() {
            return Form { known, unknown: self.unknown.clone() };
        }
        let mut unknown = Vec::with_capacity(self.unknown.len() + other.unknown.len());
        let (mut mine, mut theirs) = (self.unknown.iter().peekable(), other.unknown.iter().peekable());
        loop {
            let take_mine = match (mine.peek(), theirs.peek()) {
                (None, None) => break,
                (Some(a), Some(b)) if a.0 == b.0 => {
                    let sum = &a.1 + &b.1 * exponent;
                    if !sum.is_zero() {
                        unknown.push((a.0, sum));
                    }
                    mine.next();
                    theirs.next();
                    continue;
                }
                (Some(a), Some(b)) => a.0 < b.0,
                (Some(_), None) => true,
                (None, Some(_)) => false,
            };
            if take_mine {
                unknown.extend(mine.next().cloned());
            } else {
                unknown.extend(theirs.next().map(|(place, power)| (*place, power * exponent)));
            }
        }
        Form { known, unknown }
    }

    /// What it is worth in the measure of the work that a file may cause.
    pub fn size(&self) -> usize {
        1 + self.unknown.len()
    }
}
