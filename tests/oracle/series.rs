//! Truncated power series around a state, and the value of an expression as such a series.
//!
//! With a series of every rate and every output, a Lie derivative is a sum of products of series: no expression ever
//! grows, and no rule of the library is shared.

use super::expression::{Binary, Expression, Function, Symbol};
use super::number::{Number, Sign, Trouble, exact_root, float, pi};
use super::point::{Coordinate, Point};
use dashu::float::FBig;
use dashu::float::round::mode::HalfEven;
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// The variables of a series, and the degree up to which it is kept. At most eight variables.
#[derive(Clone, Debug)]
pub struct Space {
    pub variables: Vec<Symbol>,
    pub degree: u32,
}

/// Coefficients by exponents, eight bits for each variable; those that are exactly zero are left out.
#[derive(Clone, Debug, Default)]
pub struct Series(BTreeMap<u64, Number>);

fn degree(exponents: u64) -> u32 {
    exponents.to_le_bytes().into_iter().map(u32::from).sum()
}

impl Series {
    pub fn constant(value: Number) -> Series {
        let mut found = Series::default();
        found.put(0, value);
        found
    }

    fn put(&mut self, exponents: u64, value: Number) {
        if !value.is_exact_zero() {
            self.0.insert(exponents, value);
        }
    }

    /// The value at the state itself.
    pub fn value(&self) -> Number {
        self.0.get(&0).cloned().unwrap_or(Number::ZERO)
    }

    /// The derivatives by the variables, at the state itself.
    pub fn gradient(&self, space: &Space) -> Vec<Number> {
        (0..space.variables.len())
            .map(|place| self.0.get(&(1 << (8 * place))).cloned().unwrap_or(Number::ZERO))
            .collect()
    }

    pub fn add(&self, other: &Series) -> Series {
        let mut found = self.clone();
        for (exponents, value) in &other.0 {
            let sum = found.0.remove(exponents).unwrap_or(Number::ZERO).add(value);
            found.put(*exponents, sum);
        }
        found
    }

    pub fn negative(&self) -> Series {
        Series(self.0.iter().map(|(e, value)| (*e, value.negative())).collect())
    }

    pub fn multiply(&self, other: &Series, space: &Space) -> Series {
        let mut found = Series::default();
        for (a, x) in &self.0 {
            let room = space.degree - degree(*a);
            for (b, y) in other.0.iter().filter(|(b, _)| degree(**b) <= room) {
                let sum = found.0.remove(&(a + b)).unwrap_or(Number::ZERO).add(&x.multiply(y));
                found.put(a + b, sum);
            }
        }
        found
    }

    /// The derivative by a variable; it is right up to one degree less.
    pub fn derivative(&self, place: usize) -> Series {
        let mut found = Series::default();
        for (exponents, value) in &self.0 {
            let n = (exponents >> (8 * place)) & 0xff;
            if n > 0 {
                found.put(exponents - (1 << (8 * place)), value.multiply(&Number::integer(n as i64)));
            }
        }
        found
    }

    /// `sum coefficient_k v^k`, where `v` is this series without its constant.
    fn composed(&self, coefficients: &[Number], space: &Space) -> Series {
        let mut small = self.clone();
        small.0.remove(&0);
        let mut found = Series::default();
        for coefficient in coefficients.iter().rev() {
            found = found.multiply(&small, space).add(&Series::constant(coefficient.clone()));
        }
        found
    }

    fn is_constant(&self) -> bool {
        self.0.keys().all(|exponents| *exponents == 0)
    }
}

/// The series of an expression around a state, all of whose parts have to exist there.
pub fn series(expression: &Expression, point: &Point, space: &Space) -> Result<Series, Trouble> {
    use Expression as E;
    let of = |part: &E| series(part, point, space);
    Ok(match expression {
        E::Number(value) => Series::constant(Number::Rational(value.clone())),
        E::Pi => Series::constant(Number::turns(RBig::ONE)),
        E::Symbol(name) => {
            let mut found = Series::constant(point.number(name)?);
            if let Some(place) = space.variables.iter().position(|variable| variable == name)
                && space.degree > 0
            {
                found.put(1 << (8 * place), Number::ONE);
            }
            found
        }
        E::Sum(a, b) => of(a)?.add(&of(b)?),
        E::Difference(a, b) => of(a)?.add(&of(b)?.negative()),
        E::Product(a, b) => of(a)?.multiply(&of(b)?, space),
        E::Quotient(a, b) => of(a)?.multiply(&reciprocal(&of(b)?, space)?, space),
        E::Negative(a) => of(a)?.negative(),
        E::Power(a, n) => {
            let base = of(a)?;
            let mut found = Series::constant(Number::ONE);
            for _ in 0..n.unsigned_abs() {
                found = found.multiply(&base, space);
            }
            if *n < 0 { reciprocal(&found, space)? } else { found }
        }
        E::Apply(Function::Tan, a) => {
            let (sine, cosine) = circular(a, point, space)?;
            sine.multiply(&reciprocal(&cosine, space)?, space)
        }
        E::Apply(Function::Sin, a) => circular(a, point, space)?.0,
        E::Apply(Function::Cos, a) => circular(a, point, space)?.1,
        E::Two(function, a, b) => two(*function, (&of(a)?, &of(b)?), space)?,
        E::Apply(function, a) => {
            let inner = of(a)?;
            let degree = if inner.is_constant() { 0 } else { space.degree };
            inner.composed(&taylor(*function, &inner.value(), degree)?, space)
        }
    })
}

/// A function of two series.
fn two(function: Binary, (a, b): (&Series, &Series), space: &Space) -> Result<Series, Trouble> {
    let of = |function: Function, inner: &Series| {
        let degree = if inner.is_constant() { 0 } else { space.degree };
        Ok(inner.composed(&taylor(function, &inner.value(), degree)?, space))
    };
    match function {
        Binary::Min | Binary::Max => match a.value().subtract(&b.value()).sign() {
            Sign::Positive => Ok(if function == Binary::Max { a.clone() } else { b.clone() }),
            Sign::Negative => Ok(if function == Binary::Max { b.clone() } else { a.clone() }),
            Sign::Zero if space.degree == 0 => Ok(a.clone()),
            Sign::Zero => Err(Trouble::NotSmooth),
            Sign::Unclear => Err(Trouble::Unclear),
        },
        Binary::RealPower => {
            if a.value().sign() == Sign::Zero {
                return Err(Trouble::Undefined);
            }
            of(Function::Exp, &of(Function::Log, a)?.multiply(b, space))
        }
        // a quarter turn less the angle from the other axis; on the first axis, where it points forward, by the tangent
        Binary::Atan2 => match (a.value().sign(), b.value().sign()) {
            (Sign::Unclear, _) | (_, Sign::Unclear) => Err(Trouble::Unclear),
            (Sign::Zero, Sign::Positive) => of(Function::Atan, &a.multiply(&reciprocal(b, space)?, space)),
            (Sign::Zero, _) => Err(Trouble::Undefined),
            (sign, _) => {
                let quarter = if sign == Sign::Positive { half_of_pi() } else { half_of_pi().negative() };
                let rest = of(Function::Atan, &b.multiply(&reciprocal(a, space)?, space))?;
                Ok(Series::constant(quarter).add(&rest.negative()))
            }
        },
    }
}

/// The value of an expression at a state.
pub fn value(expression: &Expression, point: &Point) -> Result<Number, Trouble> {
    Ok(series(expression, point, &Space { variables: Vec::new(), degree: 0 })?.value())
}

fn reciprocal(of: &Series, space: &Space) -> Result<Series, Trouble> {
    let first = Number::ONE.divide(&of.value())?;
    let ratio = first.negative();
    let mut coefficients = vec![first];
    for k in 0..space.degree as usize {
        coefficients.push(coefficients[k].multiply(&ratio));
    }
    Ok(of.composed(&coefficients, space))
}

/// Sine and cosine of an expression.
fn circular(angle: &Expression, point: &Point, space: &Space) -> Result<(Series, Series), Trouble> {
    let inner = series(angle, point, space)?;
    let (cosine, sine) = turn(angle, point)?;
    let (mut sines, mut cosines) = (Vec::new(), Vec::new());
    let mut factorial = Number::ONE;
    let cycle = [sine.clone(), cosine.clone(), sine.negative(), cosine.negative()];
    for k in 0..=space.degree as usize {
        if k > 0 {
            factorial = factorial.divide(&Number::integer(k as i64))?;
        }
        sines.push(cycle[k % 4].multiply(&factorial));
        cosines.push(cycle[(k + 1) % 4].multiply(&factorial));
    }
    Ok((inner.composed(&sines, space), inner.composed(&cosines, space)))
}

/// Cosine and sine of an expression at a state; exact for integer combinations of angles whose sine and cosine are
/// known, and of multiples of half of pi.
fn turn(angle: &Expression, point: &Point) -> Result<(Number, Number), Trouble> {
    use Expression as E;
    let rotated = |(c, s): (Number, Number), (d, t): (Number, Number)| {
        (c.multiply(&d).subtract(&s.multiply(&t)), s.multiply(&d).add(&c.multiply(&t)))
    };
    let conjugate = |(c, s): (Number, Number)| (c, s.negative());
    match angle {
        E::Symbol(name) => {
            if let Coordinate::Angle { sine, cosine } = point.coordinate(name)? {
                return Ok((Number::Rational(cosine.clone()), Number::Rational(sine.clone())));
            }
        }
        E::Sum(a, b) => return Ok(rotated(turn(a, point)?, turn(b, point)?)),
        E::Difference(a, b) => return Ok(rotated(turn(a, point)?, conjugate(turn(b, point)?))),
        E::Negative(a) => return Ok(conjugate(turn(a, point)?)),
        E::Product(a, b) => {
            for (number, other) in [(a, b), (b, a)] {
                if let E::Number(n) = &**number
                    && n.denominator().is_one()
                    && let Ok(n @ -12..=12) = i64::try_from(n.numerator().clone())
                {
                    let one = turn(other, point)?;
                    let one = if n < 0 { conjugate(one) } else { one };
                    return Ok((0..n.abs())
                        .fold((Number::ONE, Number::ZERO), |whole, _| rotated(whole, one.clone())));
                }
            }
        }
        _ => {}
    }
    let at = value(angle, point)?;
    let quarters = at.as_turns().map(|turns| turns * RBig::from(2));
    if let Some(quarters) = quarters.filter(|q| q.denominator().is_one()) {
        let place = quarters.numerator().clone() % IBig::from(4);
        return Ok(match i64::try_from(place).unwrap_or(0).rem_euclid(4) {
            0 => (Number::ONE, Number::ZERO),
            1 => (Number::ZERO, Number::ONE),
            2 => (Number::integer(-1), Number::ZERO),
            _ => (Number::ZERO, Number::integer(-1)),
        });
    }
    let digits = bounded(&at)?;
    Ok((Number::Digits(digits.cos()), Number::Digits(digits.sin())))
}

/// A float of reasonable size: what grows beyond is no business of a test.
fn bounded(value: &Number) -> Result<FBig<HalfEven, 2>, Trouble> {
    let digits = value.digits();
    let most = float(&RBig::from(10_000));
    if digits > most || -digits.clone() > most { Err(Trouble::TooLarge) } else { Ok(digits) }
}

/// `f^(k)(at) / k!` for `k` up to a degree.
fn taylor(function: Function, at: &Number, degree: u32) -> Result<Vec<Number>, Trouble> {
    let n = degree as usize;
    let rational = |a: i64, b: i64| Number::Rational(RBig::from(a) / RBig::from(b));
    let first = value_of(function, at)?;
    if degree == 0 {
        return Ok(vec![first]);
    }
    let mut found = vec![first];
    match function {
        Function::Exp => {
            for k in 1..=n {
                found.push(found[k - 1].multiply(&rational(1, k as i64)));
            }
        }
        Function::Sqrt => {
            if at.is_exact_zero() {
                return Err(Trouble::NotSmooth);
            }
            for k in 1..=n {
                let k = k as i64;
                let next = found[k as usize - 1].multiply(&rational(3 - 2 * k, 2 * k)).divide(at)?;
                found.push(next);
            }
        }
        Function::Abs | Function::Sign if at.is_exact_zero() => return Err(Trouble::NotSmooth),
        _ => {
            // the derivative is a rational function, or the root of one, of the variable: a series of its own
            let space = Space { variables: vec!["t"], degree: degree - 1 };
            let t = Expression::Symbol("t");
            let derivative = match function {
                Function::Log => Expression::integer(1).over(t.clone()),
                _ => t.clone().of(function).derivative("t"),
            };
            let point = Point::of([("t", Coordinate::Number(at.clone()))]);
            let slope = series(&derivative, &point, &space).map_err(|trouble| match trouble {
                Trouble::Undefined => Trouble::NotSmooth, // it has a value there
                other => other,
            })?;
            for k in 1..=n {
                let coefficient = slope.0.get(&(k as u64 - 1)).cloned().unwrap_or(Number::ZERO);
                found.push(coefficient.multiply(&rational(1, k as i64)));
            }
        }
    }
    Ok(found)
}

/// The value of a function other than sine, cosine and tangent.
fn value_of(function: Function, at: &Number) -> Result<Number, Trouble> {
    let one = Number::ONE;
    let known =
        |numerator: i64, denominator: i64| Ok(Number::turns(RBig::from(numerator) / RBig::from(denominator)));
    let is = |n: i64| matches!(at, Number::Rational(value) if *value == RBig::from(n));
    match function {
        Function::Sqrt => match at.sign() {
            Sign::Negative => Err(Trouble::Undefined),
            Sign::Unclear => Err(Trouble::Unclear),
            Sign::Zero => Ok(Number::ZERO),
            Sign::Positive => match at {
                Number::Rational(value) if exact_root(value).is_some() => {
                    Ok(exact_root(value).map_or(Number::ZERO, Number::Rational))
                }
                _ => Ok(Number::Digits(at.digits().sqrt())),
            },
        },
        Function::Log => match at.sign() {
            Sign::Negative | Sign::Zero => Err(Trouble::Undefined),
            Sign::Unclear => Err(Trouble::Unclear),
            Sign::Positive if is(1) => Ok(Number::ZERO),
            Sign::Positive => Ok(Number::Digits(at.digits().ln())),
        },
        Function::Abs => match at.sign() {
            Sign::Unclear => Err(Trouble::Unclear),
            Sign::Negative => Ok(at.negative()),
            _ => Ok(at.clone()),
        },
        Function::Sign => match at.sign() {
            Sign::Unclear => Err(Trouble::Unclear),
            Sign::Zero => Err(Trouble::Undefined),
            Sign::Negative => Ok(Number::integer(-1)),
            Sign::Positive => Ok(one),
        },
        Function::Sinh | Function::Tanh if is(0) => Ok(Number::ZERO),
        Function::Cosh if is(0) => Ok(one),
        Function::Sinh | Function::Cosh | Function::Tanh => {
            let up = bounded(at)?.exp();
            let down = float(&RBig::ONE) / up.clone();
            let two = float(&RBig::from(2));
            let (sine, cosine) = ((up.clone() - down.clone()) / two.clone(), (up + down) / two);
            Ok(Number::Digits(match function {
                Function::Sinh => sine,
                Function::Cosh => cosine,
                _ => sine / cosine,
            }))
        }
        Function::Exp if is(0) => Ok(one),
        Function::Exp => Ok(Number::Digits(bounded(at)?.exp())),
        Function::Atan if is(0) => Ok(Number::ZERO),
        Function::Atan if is(1) => known(1, 4),
        Function::Atan if is(-1) => known(-1, 4),
        Function::Atan => Ok(Number::Digits(at.digits().atan())),
        _ => {
            let is_sine = function == Function::Asin;
            match at {
                _ if is(0) => known(0, 1).map(|zero| if is_sine { zero } else { half_of_pi() }),
                _ if is(1) => Ok(if is_sine { half_of_pi() } else { Number::ZERO }),
                _ if is(-1) && is_sine => known(-1, 2),
                _ if is(-1) => known(1, 1),
                _ => match (one.subtract(at).sign(), one.add(at).sign()) {
                    (Sign::Positive, Sign::Positive) if is_sine => Ok(Number::Digits(at.digits().asin())),
                    (Sign::Positive, Sign::Positive) => {
                        // by the arc sine: pi/2 - asin(x)
                        Ok(Number::Digits(pi() / float(&RBig::from(2)) - at.digits().asin()))
                    }
                    (Sign::Negative, _) | (_, Sign::Negative) => Err(Trouble::Undefined),
                    _ => Err(Trouble::Unclear),
                },
            }
        }
    }
}

fn half_of_pi() -> Number {
    Number::turns(RBig::from(1) / RBig::from(2))
}
