//! Expressions of the witness: a plain tree, its text in the proof language, and its derivative.

use super::number::Number;
use dashu::rational::RBig;

/// The name of a symbol.
pub type Symbol = &'static str;

/// A function of one variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sqrt,
    Exp,
    Log,
    Abs,
    Sign,
    Sinh,
    Cosh,
    Tanh,
}

/// A function of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    Min,
    Max,
    /// The angle of a point: its second coordinate first.
    Atan2,
    /// A positive base to any exponent.
    RealPower,
}

impl Function {
    pub fn name(self) -> &'static str {
        match self {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Sqrt => "sqrt",
            Function::Exp => "exp",
            Function::Log => "log",
            Function::Abs => "abs",
            Function::Sign => "sign",
            Function::Sinh => "sinh",
            Function::Cosh => "cosh",
            Function::Tanh => "tanh",
        }
    }
}

/// An expression, as it is written: nothing is ever simplified, since that may change where it exists.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    Number(RBig),
    Pi,
    Symbol(Symbol),
    Sum(Box<Expression>, Box<Expression>),
    Difference(Box<Expression>, Box<Expression>),
    Product(Box<Expression>, Box<Expression>),
    Quotient(Box<Expression>, Box<Expression>),
    Negative(Box<Expression>),
    Power(Box<Expression>, i32),
    Apply(Function, Box<Expression>),
    Two(Binary, Box<Expression>, Box<Expression>),
}

use Expression as E;

impl Expression {
    pub fn integer(value: i64) -> E {
        E::Number(RBig::from(value))
    }

    pub fn plus(self, other: E) -> E {
        E::Sum(self.into(), other.into())
    }

    pub fn minus(self, other: E) -> E {
        E::Difference(self.into(), other.into())
    }

    pub fn times(self, other: E) -> E {
        E::Product(self.into(), other.into())
    }

    pub fn over(self, other: E) -> E {
        E::Quotient(self.into(), other.into())
    }

    pub fn power(self, exponent: i32) -> E {
        E::Power(self.into(), exponent)
    }

    pub fn of(self, function: Function) -> E {
        E::Apply(function, self.into())
    }

    pub fn with_other(self, function: Binary, other: E) -> E {
        E::Two(function, self.into(), other.into())
    }

    pub fn negated(self) -> E {
        E::Negative(self.into())
    }

    /// A number as an expression; `None` where it has digits only, or pi in a denominator.
    pub fn of_number(number: &Number) -> Option<E> {
        match number {
            Number::Rational(value) => Some(E::Number(value.clone())),
            Number::Pi(top, bottom) if bottom.len() == 1 => {
                let term = |(k, c): (usize, &RBig)| {
                    let c = E::Number(c / &bottom[0]);
                    if k == 0 { c } else { c.times(E::Pi.power(k as i32)) }
                };
                let kept = top.iter().enumerate().filter(|(_, c)| !c.is_zero());
                kept.map(term).reduce(E::plus)
            }
            _ => None,
        }
    }

    /// The expression with a symbol replaced.
    pub fn with(&self, name: Symbol, value: &E) -> E {
        let mut found = self.clone();
        for place in (0..self.count()).rev() {
            found = found.with_part(place, &mut |part| match part {
                E::Symbol(other) if *other == name => value.clone(),
                other => other.clone(),
            });
        }
        found
    }

    /// The text in the proof language, each operation in brackets of its own.
    pub fn text(&self) -> String {
        match self {
            E::Number(value) if value.denominator().is_one() && *value >= RBig::ZERO => value.to_string(),
            E::Number(value) => format!("({value})"),
            E::Pi => "pi".to_owned(),
            E::Symbol(name) => (*name).to_owned(),
            E::Sum(a, b) => format!("({} + {})", a.text(), b.text()),
            E::Difference(a, b) => format!("({} - {})", a.text(), b.text()),
            E::Product(a, b) => format!("({}*{})", a.text(), b.text()),
            E::Quotient(a, b) => format!("({}/{})", a.text(), b.text()),
            E::Negative(a) => format!("(-{})", a.text()),
            E::Power(a, n) => format!("(({})^({n}))", a.text()),
            E::Apply(f, a) => format!("{}({})", f.name(), a.text()),
            E::Two(Binary::Min, a, b) => format!("min({}, {})", a.text(), b.text()),
            E::Two(Binary::Max, a, b) => format!("max({}, {})", a.text(), b.text()),
            E::Two(Binary::Atan2, a, b) => format!("atan2({}, {})", a.text(), b.text()),
            E::Two(Binary::RealPower, a, b) => format!("(({})^({}))", a.text(), b.text()),
        }
    }

    /// All symbols, each as often as it is met.
    pub fn symbols(&self) -> Vec<Symbol> {
        match self {
            E::Number(_) | E::Pi => Vec::new(),
            E::Symbol(name) => vec![name],
            E::Sum(a, b) | E::Difference(a, b) | E::Product(a, b) | E::Quotient(a, b) | E::Two(_, a, b) => {
                [a.symbols(), b.symbols()].concat()
            }
            E::Negative(a) | E::Power(a, _) | E::Apply(_, a) => a.symbols(),
        }
    }

    /// The derivative by a symbol, by the rules of any textbook; it exists where the expression is smooth.
    pub fn derivative(&self, by: Symbol) -> E {
        let zero = || E::integer(0);
        if !self.symbols().contains(&by) {
            return zero();
        }
        match self {
            E::Number(_) | E::Pi => zero(),
            E::Symbol(_) => E::integer(1),
            E::Sum(a, b) => a.derivative(by).plus(b.derivative(by)),
            E::Difference(a, b) => a.derivative(by).minus(b.derivative(by)),
            E::Product(a, b) => {
                a.derivative(by).times((**b).clone()).plus((**a).clone().times(b.derivative(by)))
            }
            E::Quotient(a, b) => {
                let top = a.derivative(by).times((**b).clone()).minus((**a).clone().times(b.derivative(by)));
                top.over((**b).clone().power(2))
            }
            E::Negative(a) => a.derivative(by).negated(),
            E::Power(_, 0) => zero(),
            E::Power(a, n) => {
                E::integer(i64::from(*n)).times((**a).clone().power(n - 1)).times(a.derivative(by))
            }
            E::Two(function, a, b) => {
                let (da, db) = (a.derivative(by), b.derivative(by));
                let (a, b) = ((**a).clone(), (**b).clone());
                match function {
                    Binary::Min | Binary::Max => {
                        let above = a.minus(b).of(Function::Sign).times(da.clone().minus(db.clone()));
                        let both = da.plus(db);
                        let twice =
                            if *function == Binary::Max { both.plus(above) } else { both.minus(above) };
                        twice.over(E::integer(2))
                    }
                    Binary::Atan2 => {
                        let turned = b.clone().times(da).minus(a.clone().times(db));
                        turned.over(a.power(2).plus(b.power(2)))
                    }
                    Binary::RealPower => {
                        let of_base = b.clone().times(da).over(a.clone());
                        let of_exponent = db.times(a.clone().of(Function::Log));
                        a.with_other(Binary::RealPower, b).times(of_base.plus(of_exponent))
                    }
                }
            }
            E::Apply(function, a) => {
                let inner = (**a).clone();
                let square = || inner.clone().power(2);
                let one = || E::integer(1);
                let outer = match function {
                    Function::Sin => inner.of(Function::Cos),
                    Function::Cos => inner.of(Function::Sin).negated(),
                    Function::Tan => one().over(inner.clone().of(Function::Cos).power(2)),
                    Function::Asin => one().over(one().minus(square()).of(Function::Sqrt)),
                    Function::Acos => one().over(one().minus(square()).of(Function::Sqrt)).negated(),
                    Function::Atan => one().over(one().plus(square())),
                    Function::Sqrt => one().over(E::integer(2).times(inner.of(Function::Sqrt))),
                    Function::Exp => inner.of(Function::Exp),
                    Function::Log => one().over(inner),
                    Function::Abs => inner.of(Function::Sign),
                    Function::Sign => zero(),
                    Function::Sinh => inner.of(Function::Cosh),
                    Function::Cosh => inner.of(Function::Sinh),
                    Function::Tanh => one().over(inner.of(Function::Cosh).power(2)),
                };
                outer.times(a.derivative(by))
            }
        }
    }

    /// How many parts an expression has, itself included.
    pub fn count(&self) -> usize {
        1 + match self {
            E::Number(_) | E::Pi | E::Symbol(_) => 0,
            E::Sum(a, b) | E::Difference(a, b) | E::Product(a, b) | E::Quotient(a, b) | E::Two(_, a, b) => {
                a.count() + b.count()
            }
            E::Negative(a) | E::Power(a, _) | E::Apply(_, a) => a.count(),
        }
    }

    /// The expression with its part number `place` (outermost first) replaced by what a rule makes of it.
    pub fn with_part(&self, place: usize, rule: &mut dyn FnMut(&E) -> E) -> E {
        if place == 0 {
            return rule(self);
        }
        let rest = place - 1;
        let mut two = |a: &E, b: &E| {
            let first = a.count();
            if rest < first {
                (Box::new(a.with_part(rest, rule)), Box::new(b.clone()))
            } else {
                (Box::new(a.clone()), Box::new(b.with_part(rest - first, rule)))
            }
        };
        match self {
            E::Number(_) | E::Pi | E::Symbol(_) => self.clone(),
            E::Sum(a, b) => {
                let (a, b) = two(a, b);
                E::Sum(a, b)
            }
            E::Difference(a, b) => {
                let (a, b) = two(a, b);
                E::Difference(a, b)
            }
            E::Product(a, b) => {
                let (a, b) = two(a, b);
                E::Product(a, b)
            }
            E::Quotient(a, b) => {
                let (a, b) = two(a, b);
                E::Quotient(a, b)
            }
            E::Two(function, a, b) => {
                let (a, b) = two(a, b);
                E::Two(*function, a, b)
            }
            E::Negative(a) => E::Negative(a.with_part(rest, rule).into()),
            E::Power(a, n) => E::Power(a.with_part(rest, rule).into(), *n),
            E::Apply(f, a) => E::Apply(*f, a.with_part(rest, rule).into()),
        }
    }
}
