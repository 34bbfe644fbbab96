//! Terms that are the same wherever both exist, by rules that anybody can check; and near misses, with one sign, number,
//! exponent or function changed.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use Expression as E;
use dashu::rational::RBig;

/// The symbols that terms are made of.
#[derive(Clone, Debug)]
pub struct Alphabet {
    pub plain: Vec<Symbol>,
    pub angles: Vec<Symbol>,
    /// Whether roots, exponentials, logarithms and the like are met.
    pub functions: bool,
}

impl Alphabet {
    /// A term of moderate size.
    pub fn term(&self, dice: &mut Dice) -> E {
        let poly = dice.polynomial(&self.plain, 2, 3);
        match dice.below(if self.functions { 8 } else { 5 }) {
            0 => poly,
            1 => poly.over(dice.divisor(&self.plain)),
            2 | 3 if !self.angles.is_empty() => {
                let wave = dice.wave(&self.angles);
                if dice.once_in(2) { poly.times(wave) } else { poly.plus(wave.power(2)) }
            }
            5 => poly.plus(dice.transcendental(&self.plain)),
            6 => dice.transcendental(&self.plain).times(dice.monomial(&self.plain, 1)),
            7 => dice.transcendental(&self.plain),
            _ => poly.times(dice.polynomial(&self.plain, 1, 2)),
        }
    }

    /// A short term, to multiply with and to divide by.
    fn short(&self, dice: &mut Dice) -> E {
        match dice.below(4) {
            0 => dice.divisor(&self.plain),
            1 if !self.angles.is_empty() => dice.wave(&self.angles),
            2 if self.functions => dice.transcendental(&self.plain),
            _ => dice.polynomial(&self.plain, 1, 2),
        }
    }

    /// The same term written otherwise: some rules at random places.
    pub fn rewritten(&self, term: &E, rules: usize, dice: &mut Dice) -> E {
        let mut found = term.clone();
        for _ in 0..rules {
            if found.count() > 160 {
                break;
            }
            let place = dice.below(found.count());
            found = found.with_part(place, &mut |part| self.rule(part, dice));
        }
        found
    }

    fn rule(&self, part: &E, dice: &mut Dice) -> E {
        let t = part.clone();
        let one = || E::integer(1);
        // rules for a shape come first, two times in three
        if !dice.once_in(3)
            && let Some(found) = by_shape(part)
        {
            return found;
        }
        let s = self.short(dice);
        let bare_angle = part.symbols().iter().any(|name| self.angles.contains(name)) && is_linear(part);
        if bare_angle {
            return t.plus(E::integer(0)); // an angle has to stay within its sine
        }
        match dice.below(if self.functions { 16 } else { 10 }) {
            0 => t.plus(s.clone().minus(s)),
            1 => t.times(s.clone().over(s)),
            2 => t.times(s.clone()).over(s),
            3 if !self.angles.is_empty() => {
                let angle = E::Symbol(dice.one_of(&self.angles));
                let square = |f| angle.clone().of(f).power(2);
                t.times(square(Function::Sin).plus(square(Function::Cos)))
            }
            4 => one().over(one().over(t)),
            5 => t.plus(E::integer(0).over(s)),
            6 => t.negated().negated(),
            7 => t.power(2).over(t_again(part)),
            8 => t.plus(s.power(0)).minus(one()),
            9 => t.power(-1).power(-1),
            10 => t.of(Function::Sqrt).power(2),
            11 => t.plus(E::integer(0).times(s.of(Function::Log))),
            12 => t.plus(E::integer(0).times(s.of(Function::Sqrt))),
            13 => t.of(Function::Log).of(Function::Exp),
            14 => t.of(Function::Atan).of(Function::Tan),
            15 => t.of(Function::Asin).of(Function::Sin),
            _ => t.plus(E::integer(0)),
        }
    }

    /// A term with one small thing changed; often it is another one.
    pub fn near_miss(&self, term: &E, dice: &mut Dice) -> E {
        for _ in 0..40 {
            let place = dice.below(term.count());
            let found = term.with_part(place, &mut |part| match part {
                E::Number(n) => E::Number(n + RBig::from(dice.one_of(&[1, -1, 2]))),
                E::Sum(a, b) => E::Difference(a.clone(), b.clone()),
                E::Difference(a, b) => E::Sum(a.clone(), b.clone()),
                E::Product(a, b) if dice.once_in(2) => E::Quotient(a.clone(), b.clone()),
                E::Quotient(a, b) => E::Product(a.clone(), b.clone()),
                E::Negative(a) => (**a).clone(),
                E::Power(a, n) => E::Power(a.clone(), n + dice.one_of(&[1, -1])),
                E::Apply(Function::Sin, a) => (**a).clone().of(Function::Cos),
                E::Apply(Function::Cos, a) => (**a).clone().of(Function::Sin),
                E::Apply(Function::Sqrt, a) if dice.once_in(2) => (**a).clone().of(Function::Atan),
                E::Apply(Function::Log, a) => (**a).clone().of(Function::Exp),
                E::Symbol(name) if self.plain.contains(name) && dice.once_in(4) => {
                    E::Symbol(dice.one_of(&self.plain))
                }
                other => other.clone(),
            });
            if found != *term {
                return found;
            }
        }
        term.clone().plus(E::integer(1))
    }

    /// A term that exists nowhere, since it divides by zero, or takes the root or logarithm of what is never positive.
    pub fn nowhere(&self, dice: &mut Dice) -> E {
        let t = match dice.below(2) {
            0 => E::Symbol(dice.one_of(&self.plain)),
            _ => self.term(dice),
        };
        let one = || E::integer(1);
        let square = || t.clone().power(2);
        match dice.below(12) {
            0 => E::integer(0).over(self.rewritten(&t, 2, dice).minus(t)),
            1 => one().over(t.clone().minus(t)),
            2 => E::integer(-1).minus(square()).of(Function::Sqrt),
            3 => square().negated().of(Function::Log),
            4 => square().plus(E::integer(2)).of(Function::Asin),
            5 => E::integer(-2).minus(square()).of(Function::Acos),
            6 => t.clone().minus(one()).of(Function::Sqrt).times(t.negated().of(Function::Sqrt)),
            7 => one().over(
                square()
                    .plus(one())
                    .power(2)
                    .minus(square().power(2).plus(E::integer(2).times(square())).plus(one())),
            ),
            8 => t.clone().of(Function::Log).plus(t.negated().of(Function::Log)),
            9 => t.of(Function::Sqrt).plus(one()).negated().of(Function::Sqrt),
            10 => one().over(one().over(t.clone()).minus(one().over(t))),
            _ => t.of(Function::Exp).negated().of(Function::Log),
        }
    }
}

fn t_again(part: &E) -> E {
    part.clone()
}

/// Whether a term is a sum of symbols and numbers, as stands within a sine.
fn is_linear(part: &E) -> bool {
    match part {
        E::Number(_) | E::Pi | E::Symbol(_) => true,
        E::Sum(a, b) | E::Difference(a, b) | E::Product(a, b) => is_linear(a) && is_linear(b),
        E::Negative(a) => is_linear(a),
        E::Quotient(..) | E::Power(..) | E::Apply(..) | E::Two(..) => false,
    }
}

/// What a term of a certain shape also is.
fn by_shape(part: &E) -> Option<E> {
    let one = || E::integer(1);
    Some(match part {
        E::Sum(a, b) => E::Sum(b.clone(), a.clone()),
        E::Product(a, b) => match &**a {
            E::Sum(c, d) => (**c).clone().times((**b).clone()).plus((**d).clone().times((**b).clone())),
            _ => E::Product(b.clone(), a.clone()),
        },
        E::Difference(a, b) => (**a).clone().plus((**b).clone().negated()),
        E::Quotient(a, b) => (**a).clone().times((**b).clone().power(-1)),
        E::Power(a, 2) => match &**a {
            E::Sum(c, d) => {
                let (c, d) = ((**c).clone(), (**d).clone());
                c.clone().power(2).plus(E::integer(2).times(c).times(d.clone())).plus(d.power(2))
            }
            other => other.clone().times(other.clone()),
        },
        E::Power(a, n) if *n > 2 => (**a).clone().power(n - 1).times((**a).clone()),
        E::Power(a, n) if *n < 0 => one().over((**a).clone().power(-n)),
        E::Apply(Function::Tan, a) => (**a).clone().of(Function::Sin).over((**a).clone().of(Function::Cos)),
        E::Apply(Function::Sin, a) => match &**a {
            E::Product(two, u) if **two == E::integer(2) => {
                let u = || (**u).clone();
                E::integer(2).times(u().of(Function::Sin)).times(u().of(Function::Cos))
            }
            E::Sum(u, v) => {
                let (u, v) = (|| (**u).clone(), || (**v).clone());
                let first = u().of(Function::Sin).times(v().of(Function::Cos));
                first.plus(u().of(Function::Cos).times(v().of(Function::Sin)))
            }
            _ => return None,
        },
        E::Apply(Function::Cos, a) => match &**a {
            E::Product(two, u) if **two == E::integer(2) => {
                one().minus(E::integer(2).times((**u).clone().of(Function::Sin).power(2)))
            }
            E::Difference(u, v) => {
                let (u, v) = (|| (**u).clone(), || (**v).clone());
                let first = u().of(Function::Cos).times(v().of(Function::Cos));
                first.plus(u().of(Function::Sin).times(v().of(Function::Sin)))
            }
            _ => return None,
        },
        _ => return None,
    })
}
