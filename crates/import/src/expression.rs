//! An expression as a foreign file means it, whatever it was written in: numbers, names, sums, products, powers, functions and
//! cases, with the place of each part.
//!
//! Readers make these, [`super::printed`] writes them in our language; neither knows of the other.

use dashu::rational::RBig;
use palmistry_lang::{Code, Problem};
use palmistry_math::number::parse_decimal;
use std::ops::Range;

/// A place in the foreign text, in bytes.
pub(super) type Span = Range<usize>;

/// Deeper expressions are refused: nobody means them, and our language counts its brackets too.
pub(super) const DEEPEST: usize = 300;

/// An expression of a foreign file.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignExpr {
    /// What it is.
    pub kind: ForeignKind,
    /// Where it stands, in bytes.
    pub span: Range<usize>,
}

/// How two expressions are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the names say it
pub enum ForeignOrder {
    Less,
    AtMost,
    Greater,
    AtLeast,
}

impl ForeignOrder {
    /// Whether two numbers are so.
    pub(super) fn holds(self, left: &RBig, right: &RBig) -> bool {
        match self {
            ForeignOrder::Less => left < right,
            ForeignOrder::AtMost => left <= right,
            ForeignOrder::Greater => left > right,
            ForeignOrder::AtLeast => left >= right,
        }
    }

    /// How the second of two is compared with the first.
    pub(super) fn turned(self) -> ForeignOrder {
        match self {
            ForeignOrder::Less => ForeignOrder::Greater,
            ForeignOrder::AtMost => ForeignOrder::AtLeast,
            ForeignOrder::Greater => ForeignOrder::Less,
            ForeignOrder::AtLeast => ForeignOrder::AtMost,
        }
    }

    /// Which of two values a case has whose sides are equal.
    pub(super) fn of_equals(self, values: &(ForeignExpr, ForeignExpr)) -> &ForeignExpr {
        match self {
            ForeignOrder::AtMost | ForeignOrder::AtLeast => &values.0,
            ForeignOrder::Less | ForeignOrder::Greater => &values.1,
        }
    }
}

/// What a foreign expression is.
#[derive(Clone, Debug, PartialEq)]
pub enum ForeignKind {
    /// An exact number; decimals are the fractions that they denote.
    Number(RBig),
    /// The number pi.
    Pi,
    /// A name of the foreign file.
    Name(String),
    /// Terms with their signs, `true` where one is subtracted.
    Sum(Vec<(bool, ForeignExpr)>),
    /// Factors from left to right, `true` where one is divided by.
    Product(Vec<(bool, ForeignExpr)>),
    /// Base and exponent.
    Power(Box<ForeignExpr>, Box<ForeignExpr>),
    /// A function of [`FUNCTIONS`].
    Call(&'static str, Vec<ForeignExpr>),
    /// One expression where the first of two is less (or however they are compared) than the second, another elsewhere.
    Case {
        /// The two that are compared.
        sides: Box<(ForeignExpr, ForeignExpr)>,
        /// How.
        order: ForeignOrder,
        /// What it is where that is so, and where not.
        values: Box<(ForeignExpr, ForeignExpr)>,
    },
}

/// The functions that expressions are made of, as our language calls them, each with the least and the greatest number of its
/// arguments. `atan2(y, x)` has `y` first.
pub const FUNCTIONS: [(&str, usize, usize); 20] = [
    ("sqrt", 1, 1),
    ("exp", 1, 1),
    ("log", 1, 1),
    ("sin", 1, 1),
    ("cos", 1, 1),
    ("tan", 1, 1),
    ("cot", 1, 1),
    ("sec", 1, 1),
    ("csc", 1, 1),
    ("asin", 1, 1),
    ("acos", 1, 1),
    ("atan", 1, 1),
    ("sinh", 1, 1),
    ("cosh", 1, 1),
    ("tanh", 1, 1),
    ("abs", 1, 1),
    ("sign", 1, 1),
    ("min", 2, usize::MAX),
    ("max", 2, usize::MAX),
    ("atan2", 2, 2),
];

impl ForeignExpr {
    pub(super) fn new(kind: ForeignKind, span: &Span) -> ForeignExpr {
        ForeignExpr { kind, span: span.clone() }
    }

    pub(super) fn integer(value: i64, span: &Span) -> ForeignExpr {
        ForeignExpr::new(ForeignKind::Number(RBig::from(value)), span)
    }

    /// A number as it is written: digits, a point, an exponent.
    pub(super) fn number(text: &str, span: &Span) -> Result<ForeignExpr, Problem> {
        let value = (!text.contains('/')).then(|| parse_decimal(text)).flatten().ok_or_else(|| {
            Problem::new(Code::Foreign, span, format!("'{text}' is no number that can be read"), "this")
                .help("decimals of at most 4096 digits, with an exponent of at most 4096")
        })?;
        Ok(ForeignExpr::new(ForeignKind::Number(value), span))
    }

    pub(super) fn name(text: impl Into<String>, span: &Span) -> ForeignExpr {
        ForeignExpr::new(ForeignKind::Name(text.into()), span)
    }

    pub(super) fn negative(self) -> ForeignExpr {
        let span = self.span.clone();
        match self.kind {
            ForeignKind::Number(value) => ForeignExpr::new(ForeignKind::Number(-value), &span),
            kind => ForeignExpr::new(
                ForeignKind::Sum(vec![(true, ForeignExpr { kind, span: span.clone() })]),
                &span,
            ),
        }
    }

    pub(super) fn plus(self, other: ForeignExpr) -> ForeignExpr {
        self.joined(other, |a, b| ForeignKind::Sum(vec![(false, a), (false, b)]))
    }

    pub(super) fn minus(self, other: ForeignExpr) -> ForeignExpr {
        self.joined(other, |a, b| ForeignKind::Sum(vec![(false, a), (true, b)]))
    }

    pub(super) fn times(self, other: ForeignExpr) -> ForeignExpr {
        self.joined(other, |a, b| ForeignKind::Product(vec![(false, a), (false, b)]))
    }

    pub(super) fn over(self, other: ForeignExpr) -> ForeignExpr {
        self.joined(other, |a, b| ForeignKind::Product(vec![(false, a), (true, b)]))
    }

    pub(super) fn to(self, exponent: ForeignExpr) -> ForeignExpr {
        self.joined(exponent, |a, b| ForeignKind::Power(Box::new(a), Box::new(b)))
    }

    fn joined(
        self,
        other: ForeignExpr,
        kind: impl Fn(ForeignExpr, ForeignExpr) -> ForeignKind,
    ) -> ForeignExpr {
        let span = self.span.start.min(other.span.start)..self.span.end.max(other.span.end);
        ForeignExpr::new(kind(self, other), &span)
    }

    /// A function of [`FUNCTIONS`] of this one.
    pub(super) fn under(self, function: &'static str) -> ForeignExpr {
        let span = self.span.clone();
        ForeignExpr::new(ForeignKind::Call(function, vec![self]), &span)
    }

    /// Its value where it is a number.
    pub(super) fn as_number(&self) -> Option<&RBig> {
        match &self.kind {
            ForeignKind::Number(value) => Some(value),
            _ => None,
        }
    }

    /// Its parts, one step down.
    pub(super) fn parts(&self) -> Vec<&ForeignExpr> {
        match &self.kind {
            ForeignKind::Number(_) | ForeignKind::Pi | ForeignKind::Name(_) => Vec::new(),
            ForeignKind::Sum(list) | ForeignKind::Product(list) => {
                list.iter().map(|(_, part)| part).collect()
            }
            ForeignKind::Power(base, exponent) => vec![base, exponent],
            ForeignKind::Call(_, arguments) => arguments.iter().collect(),
            ForeignKind::Case { sides, values, .. } => vec![&sides.0, &sides.1, &values.0, &values.1],
        }
    }

    /// Calls `each` for every case in it, the outermost one first.
    pub(super) fn cases(&mut self, each: &mut impl FnMut(&mut ForeignExpr)) {
        if matches!(self.kind, ForeignKind::Case { .. }) {
            each(self);
        }
        self.parts_mut().into_iter().for_each(|part| part.cases(each));
    }

    /// Its exact value, where it is made of numbers and of names that have one by sums, products and whole powers alone.
    pub(super) fn exact(&self, of: &impl Fn(&str) -> Option<RBig>) -> Option<RBig> {
        match &self.kind {
            ForeignKind::Number(value) => Some(value.clone()),
            ForeignKind::Name(name) => of(name),
            ForeignKind::Sum(list) => list.iter().try_fold(RBig::ZERO, |sum, (subtracted, part)| {
                let part = part.exact(of)?;
                Some(if *subtracted { sum - part } else { sum + part })
            }),
            ForeignKind::Product(list) => list.iter().try_fold(RBig::ONE, |product, (divided, part)| {
                let part = part.exact(of)?;
                match divided {
                    true if part == RBig::ZERO => None,
                    true => Some(product / part),
                    false => Some(product * part),
                }
            }),
            // larger ones are no flags, and may be too large to write
            ForeignKind::Power(base, exponent) => {
                let exponent = exponent.as_number().filter(|value| value.is_int())?;
                let exponent = isize::try_from(exponent.numerator().clone())
                    .ok()
                    .filter(|power| (0..=8).contains(power))?;
                Some(base.exact(of)?.pow(exponent))
            }
            _ => None,
        }
    }

    fn parts_mut(&mut self) -> Vec<&mut ForeignExpr> {
        match &mut self.kind {
            ForeignKind::Number(_) | ForeignKind::Pi | ForeignKind::Name(_) => Vec::new(),
            ForeignKind::Sum(list) | ForeignKind::Product(list) => {
                list.iter_mut().map(|(_, part)| part).collect()
            }
            ForeignKind::Power(base, exponent) => vec![base, exponent],
            ForeignKind::Call(_, arguments) => arguments.iter_mut().collect(),
            ForeignKind::Case { sides, values, .. } => {
                vec![&mut sides.0, &mut sides.1, &mut values.0, &mut values.1]
            }
        }
    }

    /// Calls `each` for every name in it, with its place.
    pub(super) fn names(&self, each: &mut impl FnMut(&str, &Span)) {
        match &self.kind {
            ForeignKind::Name(name) => each(name, &self.span),
            _ => self.parts().into_iter().for_each(|part| part.names(each)),
        }
    }

    /// Puts another expression where a name stands, wherever there is one for it.
    pub(super) fn replace(&mut self, by: &impl Fn(&str) -> Option<ForeignExpr>) {
        if let ForeignKind::Name(name) = &self.kind {
            if let Some(other) = by(name) {
                *self = other;
            }
            return;
        }
        self.parts_mut().into_iter().for_each(|part| part.replace(by));
    }

    /// How many parts it has in all.
    pub(super) fn size(&self) -> usize {
        1 + self.parts().into_iter().map(ForeignExpr::size).sum::<usize>()
    }

    /// How deep it goes.
    pub(super) fn depth(&self) -> usize {
        1 + self.parts().into_iter().map(ForeignExpr::depth).max().unwrap_or(0)
    }

    /// Whether it has a value wherever its parts have: nothing is divided by but numbers, it is no root, logarithm or the like.
    pub(super) fn is_total_here(&self) -> bool {
        match &self.kind {
            ForeignKind::Product(list) => list.iter().all(|(divided, part)| {
                !divided || part.as_number().is_some_and(|value| *value != RBig::ZERO)
            }),
            ForeignKind::Power(_, exponent) => {
                exponent.as_number().is_some_and(|value| value.is_int() && *value >= RBig::ZERO)
            }
            ForeignKind::Call(name, _) => {
                matches!(
                    *name,
                    "exp" | "sin" | "cos" | "atan" | "sinh" | "cosh" | "tanh" | "abs" | "min" | "max"
                )
            }
            _ => true,
        }
    }

    /// Its value in doubles, by nothing but what the parts mean: the second route that tests hold the emitted file to. `None`
    /// where a name has no value.
    #[doc(hidden)]
    pub fn value(&self, of: &impl Fn(&str) -> Option<f64>) -> Option<f64> {
        let at = |part: &ForeignExpr| part.value(of);
        Some(match &self.kind {
            ForeignKind::Number(value) => value.to_f64().value(),
            ForeignKind::Pi => std::f64::consts::PI,
            ForeignKind::Name(name) => of(name)?,
            ForeignKind::Sum(list) => list.iter().try_fold(0.0, |sum, (subtracted, part)| {
                Some(if *subtracted { sum - at(part)? } else { sum + at(part)? })
            })?,
            ForeignKind::Product(list) => list.iter().try_fold(1.0, |product, (divided, part)| {
                Some(if *divided { product / at(part)? } else { product * at(part)? })
            })?,
            ForeignKind::Power(base, exponent) => at(base)?.powf(at(exponent)?),
            ForeignKind::Call(name, arguments) => {
                let values: Vec<f64> = arguments.iter().map(at).collect::<Option<_>>()?;
                function_value(name, &values)?
            }
            ForeignKind::Case { sides, order, values } => {
                let (left, right) = (at(&sides.0)?, at(&sides.1)?);
                let holds = match order {
                    ForeignOrder::Less => left < right,
                    ForeignOrder::AtMost => left <= right,
                    ForeignOrder::Greater => left > right,
                    ForeignOrder::AtLeast => left >= right,
                };
                if holds { at(&values.0)? } else { at(&values.1)? }
            }
        })
    }
}

pub(super) fn function_value(name: &str, values: &[f64]) -> Option<f64> {
    let x = *values.first()?;
    Some(match name {
        "sqrt" => x.sqrt(),
        "exp" => x.exp(),
        "log" => x.ln(),
        "sin" => x.sin(),
        "cos" => x.cos(),
        "tan" => x.tan(),
        "cot" => 1.0 / x.tan(),
        "sec" => 1.0 / x.cos(),
        "csc" => 1.0 / x.sin(),
        "asin" => x.asin(),
        "acos" => x.acos(),
        "atan" => x.atan(),
        "sinh" => x.sinh(),
        "cosh" => x.cosh(),
        "tanh" => x.tanh(),
        "abs" => x.abs(),
        "sign" => x.signum(),
        "min" => values.iter().copied().fold(f64::INFINITY, f64::min),
        "max" => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        "atan2" => x.atan2(*values.get(1)?),
        _ => return None,
    })
}
