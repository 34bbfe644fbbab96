//! Whether the two sides of a comparison can be equal on more than a thin set. `sign` has no value where its argument is zero, so a case may be
//! written by it only where that cannot be: `max(x - 1, 0) > 0` has equal sides on half of the space, and a flag is nothing but zero and one.
//!
//! An expression is looked at piece by piece: on each piece it is one analytic function, which is either zero everywhere there or on a thin
//! set alone. Which of the two it is, a few points tell.

use super::expression::{ForeignExpr, ForeignKind, ForeignOrder, function_value};
use super::print::same;
use std::collections::BTreeMap;

/// At so many points pieces are looked at.
const POINTS: usize = 8;

/// An expression of more pieces is not looked at further: it may be anything.
const MOST_PIECES: usize = 64;

/// So many pairs of pieces are looked at in a model.
const MOST_PAIRS: usize = 4_000_000;

/// Of a piece so many conditions are kept in mind: those beyond say less of it.
const MOST_WAYS: usize = 32;

/// More conditions are not compared with each other.
const MOST_CONDITIONS: usize = 256;

/// A value, and how large what it was made of is: what is small beside that is zero.
type Point = (f64, f64);

/// One analytic piece of an expression: which way its conditions go there, and its values.
#[derive(Clone)]
struct Piece {
    ways: BTreeMap<usize, bool>,
    at: [Point; POINTS],
}

/// The pieces of an expression; none where there are too many.
type Pieces = Option<Vec<Piece>>;

/// The pieces of the definitions of a model so far.
pub(super) struct ThinSets {
    definitions: BTreeMap<String, Pieces>,
    /// What constants are by the values of the file.
    values: BTreeMap<String, f64>,
    /// Pairs that are compared: the same two are greater and less at the same places.
    conditions: Vec<(ForeignExpr, ForeignExpr)>,
    fresh: usize,
    pairs: usize,
}

fn number(value: f64) -> Vec<Piece> {
    vec![Piece { ways: BTreeMap::new(), at: [(value, value.abs()); POINTS] }]
}

/// A value of a name that nothing gives one: between zero and one, and at some points less than zero or greater than one.
fn any_value(name: &str, point: usize) -> f64 {
    let begin = 0xcbf2_9ce4_8422_2325_u64 ^ (point as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = name.bytes().fold(begin, mix);
    let hash = (hash ^ (hash >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    // 53 bits of it are a fraction
    let part = ((hash ^ (hash >> 29)) >> 11) as f64 / (1_u64 << 53) as f64;
    match point % 4 {
        0 | 1 => 0.05 + 0.9 * part,
        2 => 0.5 + 3.0 * part,
        _ => 3.0 * part - 1.5,
    }
}

impl ThinSets {
    /// No definitions yet; `values` are what constants are.
    pub fn new(values: impl Iterator<Item = (String, f64)>) -> ThinSets {
        ThinSets {
            definitions: BTreeMap::new(),
            values: values.collect(),
            conditions: Vec::new(),
            fresh: 0,
            pairs: 0,
        }
    }

    /// Keeps in mind what a definition is.
    pub fn define(&mut self, name: &str, value: &ForeignExpr) {
        let pieces = self.pieces(value);
        self.definitions.insert(name.to_owned(), pieces);
    }

    /// Whether two expressions may be equal on more than a thin set.
    pub fn may_be_equal(&mut self, left: &ForeignExpr, right: &ForeignExpr) -> bool {
        let (left, right) = (self.pieces(left), self.pieces(right));
        let difference = self.joined(left, right, |a, b| (a.0 - b.0, a.1 + b.1));
        difference.is_none_or(|pieces| pieces.iter().any(is_zero))
    }

    /// Whether an expression may be zero on more than a thin set.
    pub fn may_be_zero(&mut self, of: &ForeignExpr) -> bool {
        self.pieces(of).is_none_or(|pieces| pieces.iter().any(is_zero))
    }

    /// Which of the conditions a comparison is, and which way it goes where the first is the greater one.
    fn condition(&mut self, high: &ForeignExpr, low: &ForeignExpr) -> (usize, bool) {
        for (at, (one, other)) in self.conditions.iter().enumerate() {
            if same(one, high) && same(other, low) {
                return (at, true);
            }
            if same(one, low) && same(other, high) {
                return (at, false);
            }
        }
        if self.conditions.len() < MOST_CONDITIONS {
            self.conditions.push((high.clone(), low.clone()));
            return (self.conditions.len() - 1, true);
        }
        self.fresh += 1;
        (MOST_CONDITIONS + self.fresh, true)
    }

    /// One expression where a condition goes one way, another where it goes the other way.
    fn either(&self, condition: (usize, bool), then: Pieces, otherwise: Pieces) -> Pieces {
        let (which, way) = condition;
        let mut all = Vec::new();
        for (pieces, way) in [(then?, way), (otherwise?, !way)] {
            for mut piece in pieces {
                if piece.ways.get(&which).is_none_or(|own| *own == way) {
                    piece.ways.insert(which, way);
                    add(&mut all, piece)?;
                }
            }
        }
        Some(all)
    }

    fn joined(&mut self, left: Pieces, right: Pieces, of: impl Fn(Point, Point) -> Point) -> Pieces {
        let (left, right) = (left?, right?);
        self.pairs += left.len() * right.len();
        if self.pairs > MOST_PAIRS && left.len() * right.len() > 1 {
            return None;
        }
        let mut all = Vec::new();
        for one in &left {
            for other in &right {
                if one.ways.iter().any(|(which, way)| other.ways.get(which).is_some_and(|own| own != way)) {
                    continue;
                }
                let mut ways = one.ways.clone();
                ways.extend(&other.ways);
                add(&mut all, Piece { ways, at: std::array::from_fn(|at| of(one.at[at], other.at[at])) })?;
            }
        }
        Some(all)
    }

    fn each(pieces: Pieces, of: impl Fn(Point) -> Point) -> Pieces {
        Some(pieces?.into_iter().map(|piece| Piece { at: piece.at.map(&of), ..piece }).collect())
    }

    fn pieces(&mut self, of: &ForeignExpr) -> Pieces {
        let zero = || ForeignExpr::integer(0, &of.span);
        match &of.kind {
            ForeignKind::Number(value) => Some(number(value.to_f64().value())),
            ForeignKind::Pi => Some(number(std::f64::consts::PI)),
            ForeignKind::Name(name) => match (self.definitions.get(name), self.values.get(name)) {
                (Some(pieces), _) => pieces.clone(),
                (None, Some(value)) => Some(number(*value)),
                (None, None) => {
                    let at = std::array::from_fn(|point| {
                        let value = any_value(name, point);
                        (value, value.abs())
                    });
                    Some(vec![Piece { ways: BTreeMap::new(), at }])
                }
            },
            ForeignKind::Sum(list) => {
                let mut sum = Some(number(0.0));
                for (subtracted, part) in list {
                    let part = self.pieces(part);
                    let sign = if *subtracted { -1.0 } else { 1.0 };
                    sum = self.joined(sum, part, |a, b| (a.0 + sign * b.0, a.1 + b.1));
                }
                sum
            }
            ForeignKind::Product(list) => {
                let mut product = Some(number(1.0));
                for (divided, part) in list {
                    let part = self.pieces(part);
                    product = self.joined(product, part, |a, b| match divided {
                        true => (a.0 / b.0, a.1 / b.0.abs()),
                        false => (a.0 * b.0, a.1 * b.1),
                    });
                }
                product
            }
            ForeignKind::Power(base, exponent) => {
                let (base, exponent) = (self.pieces(base), self.pieces(exponent));
                self.joined(base, exponent, |a, b| (a.0.powf(b.0), a.1.powf(b.0).abs()))
            }
            ForeignKind::Case { sides, order, values } => {
                let condition = match order {
                    ForeignOrder::Greater | ForeignOrder::AtLeast => self.condition(&sides.0, &sides.1),
                    ForeignOrder::Less | ForeignOrder::AtMost => self.condition(&sides.1, &sides.0),
                };
                let (then, otherwise) = (self.pieces(&values.0), self.pieces(&values.1));
                self.either(condition, then, otherwise)
            }
            ForeignKind::Call("abs" | "sign", list) if list.len() == 1 => {
                let is_sign = matches!(of.kind, ForeignKind::Call("sign", _));
                let inner = self.pieces(&list[0]);
                let condition = self.condition(&list[0], &zero());
                let sign = |sign: f64| {
                    ThinSets::each(inner.clone(), |point| match is_sign {
                        true => (sign, 1.0),
                        false => (sign * point.0, point.1),
                    })
                };
                let mut all = self.either(condition, sign(1.0), sign(-1.0))?;
                // where it is nothing but zero
                for piece in inner?.into_iter().filter(|piece| is_sign && is_zero(piece)) {
                    add(&mut all, Piece { at: [(0.0, 0.0); POINTS], ..piece })?;
                }
                Some(all)
            }
            ForeignKind::Call(name @ ("max" | "min"), list) => match list.as_slice() {
                [one, other] => {
                    let (one_is, other_is) = (self.pieces(one), self.pieces(other));
                    let (which, way) = self.condition(one, other);
                    self.either((which, way == (*name == "max")), one_is, other_is)
                }
                _ => {
                    let mut all = Vec::new();
                    for part in list {
                        for piece in self.pieces(part)? {
                            add(&mut all, piece)?;
                        }
                    }
                    Some(all)
                }
            },
            ForeignKind::Call(name, list) => {
                let first = list.first().map(|one| self.pieces(one))?;
                let own = |values: &[f64]| {
                    let value = function_value(name, values).unwrap_or(f64::NAN);
                    (value, value.abs())
                };
                match list.get(1) {
                    None => ThinSets::each(first, |point| own(&[point.0])),
                    Some(second) => {
                        let second = self.pieces(second);
                        self.joined(first, second, |a, b| own(&[a.0, b.0]))
                    }
                }
            }
        }
    }
}

/// Whether a piece is zero wherever it has a value.
fn is_zero(piece: &Piece) -> bool {
    let mut finite = piece.at.iter().filter(|(value, size)| value.is_finite() && size.is_finite()).peekable();
    finite.peek().is_some() && finite.all(|(value, size)| value.abs() <= 1e-10 * size)
}

/// Adds a piece; one of the same values is the same, and says less of its conditions.
fn add(all: &mut Vec<Piece>, mut piece: Piece) -> Option<()> {
    while piece.ways.len() > MOST_WAYS {
        piece.ways.pop_first();
    }
    let alike = |own: &&mut Piece| {
        own.at.iter().zip(&piece.at).all(|(one, other)| one.0.to_bits() == other.0.to_bits())
    };
    if let Some(own) = all.iter_mut().find(alike) {
        own.ways.retain(|which, way| piece.ways.get(which) == Some(way));
        return Some(());
    }
    all.push(piece);
    (all.len() <= MOST_PIECES).then_some(())
}
