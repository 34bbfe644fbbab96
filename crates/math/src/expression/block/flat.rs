//! Expressions as products of powers of *atoms*: inputs, sums of two products, values of functions.
//!
//! A quotient becomes a product with a negative power, so that each divisor is inverted once however often it is divided
//! by; signs and constants gather in one coefficient; `x*a + x*b` becomes `x*(a + b)`. All of this is exact as algebra
//! and changes only the rounding.

use crate::expression::graph::{Graph, Node, NodeId};
use crate::expression::input::Input;
use crate::number::{Arithmetic, Function, Rationals, Refusal, rational_to_f64};
use dashu::base::{Abs, BitTest, Signed};
use dashu::rational::RBig;
use std::collections::{BTreeSet, HashMap};

/// A place among [`Flat::atoms`].
pub(super) type AtomId = u32;
/// A place among [`Flat::products`].
pub(super) type ProductId = u32;

/// The empty product.
pub(super) const ONE: ProductId = 0;

/// A product of more factors than this becomes an atom, so that long chains stay short.
const MOST_FACTORS: u64 = 12;

/// A place among [`Flat::coefficients`].
pub(super) type CoefficientId = u32;
const ZERO: CoefficientId = 0;
/// The coefficient one.
pub(super) const UNIT: CoefficientId = 1;

/// A coefficient times a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Term {
    pub coefficient: CoefficientId,
    pub product: ProductId,
}

impl Term {
    const ZERO: Term = Term { coefficient: ZERO, product: ONE };
}

/// What is not a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Atom {
    Input(u32),
    Pi,
    /// A number with many digits.
    Rational(CoefficientId),
    Sum(Term, Term),
    Function(Function, Term),
    /// A long product.
    Whole(ProductId),
}

/// Powers of atoms, by atom; no power is zero.
type Powers = Vec<(AtomId, i64)>;

/// Coefficients longer than so many bits are not multiplied out.
const LONGEST_COEFFICIENT: usize = 2048;

/// Larger powers are not taken: whatever is not one is zero or infinite there.
const LARGEST_POWER: i64 = 1 << 40;

/// Some expressions, flattened.
#[derive(Default)]
pub(super) struct Flat {
    /// An atom's own products hold only earlier atoms.
    pub atoms: Vec<Atom>,
    pub products: Vec<Powers>,
    pub coefficients: Vec<RBig>,
    /// Of each coefficient in a term, whether it is negative, and its magnitude among the coefficients.
    pub magnitudes: Vec<(bool, CoefficientId)>,
    pub inputs: Vec<Input>,
    /// What was asked for, in order.
    pub roots: Vec<Term>,
    /// Atoms that are divided by, anywhere in what was asked for or watched.
    pub divisors: BTreeSet<AtomId>,
    /// Function values that are met there.
    pub functions: BTreeSet<AtomId>,
    /// Whether zero is divided by, or a power is needed that is out of all bounds.
    pub undefined: bool,
    atom_places: HashMap<Atom, AtomId>,
    product_places: HashMap<Powers, ProductId>,
    coefficient_places: HashMap<RBig, CoefficientId>,
}

impl Flat {
    /// Flattens `roots`; of `watched` only the divisors and the functions are kept. `input_of` says which nodes are given
    /// from outside, and `known` which of these are constants.
    pub fn new(
        graph: &Graph,
        roots: &[NodeId],
        watched: &[NodeId],
        input_of: &dyn Fn(NodeId) -> Option<Input>,
        known: &dyn Fn(Input) -> Option<RBig>,
    ) -> Flat {
        let mut flat = Flat::default();
        flat.product(Vec::new());
        flat.coefficient(RBig::ZERO);
        flat.coefficient(RBig::ONE);
        let mut terms: HashMap<NodeId, Term> = HashMap::new();
        for id in needed(graph, roots.iter().chain(watched).copied(), input_of) {
            let at = |operand: NodeId| terms[&operand];
            let term = match (input_of(id), graph.node(id)) {
                (Some(input), _) => match known(input) {
                    Some(value) => flat.rational(value),
                    None => {
                        flat.inputs.push(input);
                        flat.atom(Atom::Input(flat.inputs.len() as u32 - 1))
                    }
                },
                (None, Node::Constant(index)) => flat.rational(graph.constant_at(index).clone()),
                (None, Node::Pi) => flat.atom(Atom::Pi),
                (None, Node::Symbol(symbol)) => unreachable!("symbol {symbol:?} is an input"),
                (None, Node::Add(a, b)) => flat.sum(at(a), at(b)),
                (None, Node::Sub(a, b)) => {
                    let negative = flat.negated(at(b));
                    flat.sum(at(a), negative)
                }
                (None, Node::Neg(a)) => flat.negated(at(a)),
                (None, Node::Mul(a, b)) => flat.times(at(a), at(b)),
                (None, Node::Div(a, b)) => {
                    let inverse = flat.power(at(b), -1);
                    flat.times(at(a), inverse)
                }
                (None, Node::Power(a, n)) => flat.power(at(a), n),
                (None, Node::Apply(function, a)) => flat.apply(function, at(a)),
            };
            terms.insert(id, term);
        }
        flat.roots = roots.iter().map(|root| terms[root]).collect();
        for id in 0..flat.coefficients.len() {
            let magnitude = flat.coefficients[id].clone().abs();
            let negative = flat.coefficients[id].is_negative();
            let magnitude = flat.coefficient(magnitude);
            flat.magnitudes.push((negative, magnitude));
        }
        flat
    }

    fn product(&mut self, powers: Powers) -> ProductId {
        if let Some(known) = self.product_places.get(&powers) {
            return *known;
        }
        let id = self.products.len() as ProductId;
        self.products.push(powers.clone());
        self.product_places.insert(powers, id);
        id
    }

    fn coefficient(&mut self, value: RBig) -> CoefficientId {
        if let Some(known) = self.coefficient_places.get(&value) {
            return *known;
        }
        let id = self.coefficients.len() as CoefficientId;
        self.coefficients.push(value.clone());
        self.coefficient_places.insert(value, id);
        id
    }

    fn rational(&mut self, value: RBig) -> Term {
        Term { coefficient: self.coefficient(value), product: ONE }
    }

    /// An atom as a term.
    fn atom(&mut self, atom: Atom) -> Term {
        let id = match self.atom_places.get(&atom) {
            Some(known) => *known,
            None => {
                let id = self.atoms.len() as AtomId;
                self.atoms.push(atom);
                self.atom_places.insert(atom, id);
                id
            }
        };
        Term { coefficient: UNIT, product: self.product(vec![(id, 1)]) }
    }

    fn times(&mut self, a: Term, b: Term) -> Term {
        let coefficient = match (a.coefficient, b.coefficient) {
            (ZERO, _) | (_, ZERO) => return Term::ZERO,
            (UNIT, other) | (other, UNIT) => other,
            (x, y) => {
                let value = &self.coefficients[x as usize] * &self.coefficients[y as usize];
                if length(&value) > LONGEST_COEFFICIENT {
                    // as it was: one of them becomes an atom
                    let whole = self.atom(Atom::Rational(x));
                    let a = self.times(whole, Term { coefficient: UNIT, ..a });
                    return self.times(a, b);
                }
                self.coefficient(value)
            }
        };
        let powers = merged(&self.products[a.product as usize], &self.products[b.product as usize], 1);
        self.term(coefficient, powers)
    }

    /// A coefficient with a product, the product as an atom of its own where it is long.
    fn term(&mut self, coefficient: CoefficientId, powers: Powers) -> Term {
        self.undefined |= powers.iter().any(|(_, power)| power.abs() > LARGEST_POWER);
        let count = powers.iter().fold(0u64, |sum, (_, n)| sum.saturating_add(n.unsigned_abs()));
        let several = powers.len() > 1;
        let product = self.product(powers);
        if count > MOST_FACTORS && several {
            Term { coefficient, product: self.atom(Atom::Whole(product)).product }
        } else {
            Term { coefficient, product }
        }
    }

    /// The base of a negative power is noted as a divisor.
    fn power(&mut self, a: Term, n: i32) -> Term {
        if n < 0 {
            let atoms = self.products[a.product as usize].iter().map(|(atom, _)| *atom);
            self.divisors.extend(atoms);
        }
        let exact = Rationals { bits: LONGEST_COEFFICIENT };
        let coefficient = match a.coefficient {
            UNIT => UNIT,
            other => match exact.power(&self.coefficients[other as usize], n) {
                Ok(value) => self.coefficient(value),
                Err(Refusal::DivisionByZero) => {
                    self.undefined = true;
                    return Term::ZERO;
                }
                Err(_) => {
                    let whole = self.atom(Atom::Rational(other));
                    let a = self.times(whole, Term { coefficient: UNIT, ..a });
                    return self.power(a, n);
                }
            },
        };
        let times_n = |(atom, power): &(AtomId, i64)| (*atom, power.saturating_mul(i64::from(n)));
        let powers = self.products[a.product as usize].iter().map(times_n).collect();
        self.term(coefficient, powers)
    }

    fn apply(&mut self, function: Function, a: Term) -> Term {
        let term = self.atom(Atom::Function(function, a));
        self.functions.insert(self.products[term.product as usize][0].0);
        term
    }

    fn negated(&mut self, a: Term) -> Term {
        let value = -self.coefficients[a.coefficient as usize].clone();
        Term { coefficient: self.coefficient(value), ..a }
    }

    fn sum(&mut self, a: Term, b: Term) -> Term {
        if a.coefficient == ZERO {
            return b;
        }
        if b.coefficient == ZERO {
            return a;
        }
        let coefficients = |term: Term| &self.coefficients[term.coefficient as usize];
        if a.product == b.product {
            let sum = coefficients(a) + coefficients(b);
            let product = if sum.is_zero() { ONE } else { a.product };
            return Term { coefficient: self.coefficient(sum), product };
        }
        let common = common(&self.products[a.product as usize], &self.products[b.product as usize]);
        let (mut first, mut second) = (self.without(a, &common), self.without(b, &common));
        if second.product < first.product {
            std::mem::swap(&mut first, &mut second);
        }
        // one of the coefficients is made one where that takes no rounding, so that multiples are found to be the same
        let (x, y) =
            (&self.coefficients[first.coefficient as usize], &self.coefficients[second.coefficient as usize]);
        let (ratio, inverse) = (y / x, x / y);
        let outside = if is_double(&ratio) {
            x.clone()
        } else if is_double(&inverse) {
            y.clone()
        } else {
            x.signum()
        };
        let inside = (x / &outside, y / &outside);
        (first.coefficient, second.coefficient) = (self.coefficient(inside.0), self.coefficient(inside.1));
        let atom = self.atom(Atom::Sum(first, second));
        let outside = Term { coefficient: self.coefficient(outside), product: self.product(common) };
        self.times(atom, outside)
    }

    fn without(&mut self, term: Term, factors: &Powers) -> Term {
        let powers = merged(&self.products[term.product as usize], factors, -1);
        Term { product: self.product(powers), ..term }
    }
}

/// Whether a double is this very number.
fn is_double(value: &RBig) -> bool {
    RBig::try_from(rational_to_f64(value)).is_ok_and(|double| double == *value)
}

/// Bits in which a number is written.
fn length(value: &RBig) -> usize {
    value.numerator().bit_len() + value.denominator().bit_len()
}

/// `a b^sign`
fn merged(a: &Powers, b: &Powers, sign: i64) -> Powers {
    let mut found = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let left = a.get(i).map_or(AtomId::MAX, |(atom, _)| *atom);
        let right = b.get(j).map_or(AtomId::MAX, |(atom, _)| *atom);
        let mut power = 0;
        if left <= right {
            power += a[i].1;
            i += 1;
        }
        if right <= left {
            power += sign * b[j].1;
            j += 1;
        }
        if power != 0 {
            found.push((left.min(right), power));
        }
    }
    found
}

/// The factors that both have, with the smaller power of one sign.
fn common(a: &Powers, b: &Powers) -> Powers {
    let mut found = Vec::new();
    for (atom, m) in a {
        if let Ok(place) = b.binary_search_by_key(atom, |(other, _)| *other) {
            let n = b[place].1;
            if m.signum() == n.signum() {
                found.push((*atom, m.signum() * m.abs().min(n.abs())));
            }
        }
    }
    found
}

/// The nodes to compute, operands first; below an input nothing is needed.
fn needed(
    graph: &Graph,
    roots: impl Iterator<Item = NodeId>,
    input_of: &dyn Fn(NodeId) -> Option<Input>,
) -> Vec<NodeId> {
    let mut seen = BTreeSet::new();
    let mut stack: Vec<NodeId> = roots.collect();
    while let Some(id) = stack.pop() {
        if seen.insert(id) && input_of(id).is_none() {
            stack.extend(graph.node(id).operands());
        }
    }
    seen.into_iter().collect()
}
