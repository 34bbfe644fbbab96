//! Whether the decision procedure of the library (`proofs/coq/Check.v`) will decide an identity, and not too late: its way from terms to
//! fractions of polynomials is gone here modulo a prime, and its work is counted. This decides nothing. It keeps theorems out of a file
//! that would not be proved there, so that the rest of the file is.

use crate::place::extent;
use crate::printer::Reason;
use crate::residue::{PRIME, residue, times};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::expression::{Graph, Node, NodeId};
use palmistry_math::number::Function;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// So many products of monomials are up to twenty seconds of Coq.
const MOST_WORK: u64 = 3_000_000;
/// Nor of terms with more parts, written out: each of them is looked at.
const LARGEST: u64 = 10_000_000;
/// No greater multiple of an angle is expanded by the library.
const MOST_TURNS: i64 = 12;

/// Powers of atoms, by their numbers.
type Monomial = Vec<(u32, u32)>;
type Polynomial = BTreeMap<Monomial, u64>;
/// Numbers of factors and their powers.
type Factors = BTreeMap<u32, u32>;
/// Sine and cosine.
type Circular = (Polynomial, Polynomial);

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Atom {
    Of(NodeId),
    Sine(NodeId),
    Cosine(NodeId),
}

/// A fraction, and what it took to come to it: as often as it is met.
#[derive(Clone)]
struct Fraction {
    top: Polynomial,
    bottom: Factors,
    work: u64,
}

/// More than Coq should do.
struct TooMuch;

struct Ways<'g> {
    graph: &'g Graph,
    atoms: HashMap<Atom, u32>,
    /// The square of an atom that has another form.
    squares: HashMap<u32, Polynomial>,
    factors: Vec<Polynomial>,
    known: HashMap<(NodeId, bool), Rc<Fraction>>,
    work: u64,
}

/// Whether the library shows that two expressions are equal. The graph knows both already, and may know that they are one: the library
/// goes through each.
pub(crate) fn foreseen(graph: &Graph, left: NodeId, right: NodeId) -> Result<(), Reason> {
    let (atoms, squares, factors, known) = Default::default();
    let mut ways = Ways { graph, atoms, squares, factors, known, work: 0 };
    match ways.difference(left, right) {
        Ok(found) if found.top.is_empty() => Ok(()),
        Ok(_) => Err("it rests on laws of functions that the library does not have".to_owned()),
        Err(TooMuch) => Err("its polynomials are too large for the library".to_owned()),
    }
}

fn constant(value: u64) -> Polynomial {
    if value == 0 { Polynomial::new() } else { Polynomial::from([(Monomial::new(), value)]) }
}

fn negated(mut p: Polynomial) -> Polynomial {
    p.values_mut().for_each(|value| *value = PRIME - *value);
    p
}

fn add_to(sum: &mut Polynomial, monomial: Monomial, value: u64) {
    let entry = sum.entry(monomial).or_insert(0);
    *entry = (*entry + value) % PRIME;
}

fn sum(mut a: Polynomial, b: Polynomial) -> Polynomial {
    for (monomial, value) in b {
        add_to(&mut a, monomial, value);
    }
    a.retain(|_, value| *value != 0);
    a
}

fn joined(a: &Monomial, b: &Monomial) -> Monomial {
    let mut all: BTreeMap<u32, u32> = a.iter().copied().collect();
    for (atom, power) in b {
        *all.entry(*atom).or_insert(0) += power;
    }
    all.into_iter().collect()
}

impl Ways<'_> {
    fn difference(&mut self, left: NodeId, right: NodeId) -> Result<Fraction, TooMuch> {
        if extent(self.graph, &[left, right]).parts > LARGEST {
            return Err(TooMuch);
        }
        let (left, right) = (self.fraction(left, false)?, self.fraction(right, false)?);
        let right =
            Fraction { top: negated(right.top.clone()), bottom: right.bottom.clone(), work: right.work };
        let found = self.add(&left, &right)?;
        if found.work > MOST_WORK { Err(TooMuch) } else { Ok(found) }
    }

    fn spend(&mut self, work: usize) -> Result<(), TooMuch> {
        self.work += work as u64;
        if self.work > MOST_WORK { Err(TooMuch) } else { Ok(()) }
    }

    fn atom(&mut self, atom: Atom) -> u32 {
        let next = self.atoms.len() as u32;
        *self.atoms.entry(atom).or_insert(next)
    }

    fn is(atom: u32) -> Polynomial {
        Polynomial::from([(vec![(atom, 1)], 1)])
    }

    fn product(&mut self, a: &Polynomial, b: &Polynomial) -> Result<Polynomial, TooMuch> {
        self.spend(a.len() * b.len())?;
        let mut found = Polynomial::new();
        for (m, x) in a {
            for (n, y) in b {
                add_to(&mut found, joined(m, n), times(*x, *y));
            }
        }
        found.retain(|_, value| *value != 0);
        self.reduced(found)
    }

    /// Squares of sines and roots are replaced.
    fn reduced(&mut self, mut p: Polynomial) -> Result<Polynomial, TooMuch> {
        loop {
            let square = |(atom, power): &(u32, u32)| *power >= 2 && self.squares.contains_key(atom);
            let (with, mut without): (Polynomial, Polynomial) =
                p.into_iter().partition(|(monomial, _)| monomial.iter().any(square));
            if with.is_empty() {
                return Ok(without);
            }
            let mut work = 0;
            for (mut monomial, value) in with {
                let Some(place) = monomial.iter().position(square) else { continue };
                let by = &self.squares[&monomial[place].0];
                monomial[place].1 -= 2;
                monomial.retain(|(_, power)| *power > 0);
                work += by.len();
                for (m, x) in by {
                    add_to(&mut without, joined(&monomial, m), times(*x, value));
                }
            }
            self.spend(work)?;
            without.retain(|_, value| *value != 0);
            p = without;
        }
    }

    fn power(&mut self, p: &Polynomial, n: u32) -> Result<Polynomial, TooMuch> {
        let mut found = constant(1);
        for _ in 0..n {
            found = self.product(&found, p)?;
        }
        Ok(found)
    }

    fn expanded(&mut self, factors: &Factors) -> Result<Polynomial, TooMuch> {
        let mut found = constant(1);
        for (factor, n) in factors {
            let power = self.power(&self.factors[*factor as usize].clone(), *n)?;
            found = self.product(&found, &power)?;
        }
        Ok(found)
    }

    fn factor(&mut self, p: Polynomial) -> u32 {
        let place = self.factors.iter().position(|known| *known == p);
        place.unwrap_or_else(|| {
            self.factors.push(p);
            self.factors.len() - 1
        }) as u32
    }

    fn add(&mut self, a: &Fraction, b: &Fraction) -> Result<Fraction, TooMuch> {
        if a.top.is_empty() || b.top.is_empty() {
            let kept = if a.top.is_empty() { b } else { a };
            return Ok(Fraction { work: a.work.saturating_add(b.work), ..kept.clone() });
        }
        let mut common = a.bottom.clone();
        for (factor, n) in &b.bottom {
            let entry = common.entry(*factor).or_insert(0);
            *entry = (*entry).max(*n);
        }
        let lacks = |own: &Factors| -> Factors {
            let rest = common.iter().map(|(factor, n)| (*factor, n - own.get(factor).copied().unwrap_or(0)));
            rest.filter(|(_, n)| *n > 0).collect()
        };
        let (p, q) = (self.expanded(&lacks(&a.bottom))?, self.expanded(&lacks(&b.bottom))?);
        let (left, right) = (self.product(&a.top, &p)?, self.product(&b.top, &q)?);
        Ok(Fraction { top: sum(left, right), bottom: common, work: a.work.saturating_add(b.work) })
    }

    fn multiply(&mut self, a: &Fraction, b: &Fraction) -> Result<Fraction, TooMuch> {
        let work = a.work.saturating_add(b.work);
        if a.top.is_empty() || b.top.is_empty() {
            return Ok(Fraction { top: Polynomial::new(), bottom: Factors::new(), work });
        }
        let cancelled = |top: &Polynomial, bottom: &Factors| {
            let factor = self.factors.iter().position(|known| known == top).map(|place| place as u32);
            match factor.filter(|factor| bottom.get(factor).is_some_and(|n| *n > 0)) {
                Some(factor) => {
                    let mut rest = bottom.clone();
                    *rest.entry(factor).or_insert(1) -= 1;
                    (constant(1), rest)
                }
                None => (top.clone(), bottom.clone()),
            }
        };
        let ((p, mut bottom), (q, more)) = (cancelled(&a.top, &b.bottom), cancelled(&b.top, &a.bottom));
        for (factor, n) in more {
            *bottom.entry(factor).or_insert(0) += n;
        }
        bottom.retain(|_, n| *n > 0);
        Ok(Fraction { top: self.product(&p, &q)?, bottom, work })
    }

    fn inverse(&mut self, a: Fraction) -> Result<Fraction, TooMuch> {
        let top = self.expanded(&a.bottom)?;
        let bottom = match a.top == constant(1) {
            true => Factors::new(),
            false => Factors::from([(self.factor(a.top), 1)]),
        };
        Ok(Fraction { top, bottom, work: a.work })
    }

    /// The fraction of an expression, or of its inverse; its work counts what the library does again at each place.
    fn fraction(&mut self, id: NodeId, inverted: bool) -> Result<Rc<Fraction>, TooMuch> {
        if let Some(known) = self.known.get(&(id, inverted)).cloned() {
            return if known.work > MOST_WORK { Err(TooMuch) } else { Ok(known) };
        }
        // the work of this node alone: what is below it counts as often as it is met
        let mut before = self.work;
        let whole = |top: Polynomial| Fraction { top, bottom: Factors::new(), work: 0 };
        let mut turned = !inverted;
        let node = self.graph.node(id);
        let found = match node {
            Node::Constant(_) => {
                let value = self.graph.constant_value(id).cloned().unwrap_or(RBig::ZERO);
                let above = whole(constant(residue(value.numerator())));
                let below = residue(&IBig::from(value.denominator().clone()));
                match below {
                    1 => above,
                    _ => Fraction { bottom: Factors::from([(self.factor(constant(below)), 1)]), ..above },
                }
            }
            Node::Add(a, b) => {
                let (a, b) = (self.fraction(a, false)?, self.fraction(b, false)?);
                before = self.work;
                self.add(&a, &b)?
            }
            Node::Sub(a, b) => {
                let (a, b) = (self.fraction(a, false)?, self.fraction(b, false)?);
                before = self.work;
                let b = Fraction { top: negated(b.top.clone()), bottom: b.bottom.clone(), work: b.work };
                self.add(&a, &b)?
            }
            Node::Mul(a, b) | Node::Div(a, b) => {
                turned = true;
                let divides = matches!(node, Node::Div(..));
                let (a, b) = (self.fraction(a, inverted)?, self.fraction(b, inverted != divides)?);
                before = self.work;
                self.multiply(&a, &b)?
            }
            Node::Neg(a) => {
                turned = true;
                let a = self.fraction(a, inverted)?;
                Fraction { top: negated(a.top.clone()), bottom: a.bottom.clone(), work: a.work }
            }
            Node::Power(a, n) => {
                turned = true;
                let a = self.fraction(a, inverted != (n < 0))?;
                before = self.work;
                let times = n.unsigned_abs();
                let bottom = a.bottom.iter().map(|(factor, m)| (*factor, m * times)).collect();
                Fraction { top: self.power(&a.top, times)?, bottom, work: a.work }
            }
            Node::Apply(function @ (Function::Sin | Function::Cos), a) => {
                let (sine, cosine) = self.circular(a)?;
                whole(if function == Function::Sin { sine } else { cosine })
            }
            Node::Apply(Function::Sqrt, a) => {
                let atom = self.atom(Atom::Of(id));
                if !self.squares.contains_key(&atom) {
                    let inner = self.fraction(a, false)?;
                    if inner.bottom.is_empty() {
                        self.squares.insert(atom, inner.top.clone());
                    }
                }
                whole(Self::is(atom))
            }
            Node::Pi | Node::Symbol(_) | Node::Apply(..) => {
                let atom = self.atom(Atom::Of(id));
                whole(Self::is(atom))
            }
        };
        let mut found = if turned { found } else { self.inverse(found)? };
        found.work = found.work.saturating_add(self.work - before);
        let found = Rc::new(found);
        self.known.insert((id, inverted), found.clone());
        if found.work > MOST_WORK { Err(TooMuch) } else { Ok(found) }
    }

    /// How many quarter turns an angle is.
    fn quarters(&self, id: NodeId) -> Option<IBig> {
        let number = |id| self.graph.constant_value(id).cloned();
        let whole = |value: RBig| value.denominator().is_one().then(|| value.numerator().clone());
        match self.graph.node(id) {
            Node::Constant(_) => number(id).filter(RBig::is_zero).map(|_| IBig::ZERO),
            Node::Pi => Some(IBig::from(2)),
            Node::Neg(a) => self.quarters(a).map(|n| -n),
            Node::Mul(a, b) => {
                let (factor, angle) =
                    number(a).map(|value| (value, b)).or(number(b).map(|value| (value, a)))?;
                whole(factor * RBig::from(self.quarters(angle)?))
            }
            Node::Div(a, b) => whole(RBig::from(self.quarters(a)?) / number(b)?),
            _ => None,
        }
    }

    fn circular(&mut self, id: NodeId) -> Result<Circular, TooMuch> {
        if let Some(n) = self.quarters(id) {
            let minus = constant(PRIME - 1);
            return Ok(match residue(&(((n % IBig::from(4)) + IBig::from(4)) % IBig::from(4))) {
                0 => (Polynomial::new(), constant(1)),
                1 => (constant(1), Polynomial::new()),
                2 => (Polynomial::new(), minus),
                _ => (minus, Polynomial::new()),
            });
        }
        let back = |(sine, cosine): Circular| (negated(sine), cosine);
        match self.graph.node(id) {
            Node::Add(a, b) => {
                let (a, b) = (self.circular(a)?, self.circular(b)?);
                self.turned(&a, &b)
            }
            Node::Sub(a, b) => {
                let (a, b) = (self.circular(a)?, back(self.circular(b)?));
                self.turned(&a, &b)
            }
            Node::Neg(a) => Ok(back(self.circular(a)?)),
            Node::Mul(a, b) => {
                let factor = |id| {
                    let value = self.graph.constant_value(id).filter(|value| value.denominator().is_one())?;
                    i64::try_from(value.numerator().clone()).ok().filter(|n| n.abs() <= MOST_TURNS)
                };
                let Some((n, angle)) = factor(a).map(|n| (n, b)).or(factor(b).map(|n| (n, a))) else {
                    return Ok(self.as_it_is(id));
                };
                let one = self.circular(angle)?;
                let mut found = (Polynomial::new(), constant(1));
                for _ in 0..n.abs() {
                    found = self.turned(&one, &found)?;
                }
                Ok(if n < 0 { back(found) } else { found })
            }
            _ => Ok(self.as_it_is(id)),
        }
    }

    fn turned(&mut self, a: &Circular, b: &Circular) -> Result<Circular, TooMuch> {
        let sine = sum(self.product(&a.0, &b.1)?, self.product(&a.1, &b.0)?);
        let cosine = sum(self.product(&a.1, &b.1)?, negated(self.product(&a.0, &b.0)?));
        Ok((sine, cosine))
    }

    fn as_it_is(&mut self, id: NodeId) -> Circular {
        let (sine, cosine) = (self.atom(Atom::Sine(id)), self.atom(Atom::Cosine(id)));
        let circle = sum(constant(1), Polynomial::from([(vec![(cosine, 2)], PRIME - 1)]));
        self.squares.insert(sine, circle);
        (Self::is(sine), Self::is(cosine))
    }
}
