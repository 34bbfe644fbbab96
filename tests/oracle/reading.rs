//! Constants and expressions as the library prints them, read back: `3/2`, `-pi/2`, `1 + 2*pi`, `sqrt(2)`, `x*sin(1/2*phi)`.

use super::expression::{Expression, Function, Symbol};
use Expression as E;
use dashu::rational::RBig;

/// A constant; `None` where the text is none.
pub fn read_constant(text: &str) -> Option<E> {
    read_expression(text, &[])
}

/// An expression of some symbols; `None` where the text is none.
pub fn read_expression(text: &str, symbols: &[Symbol]) -> Option<E> {
    let mut reader = Reader { rest: text, symbols };
    let found = reader.sum()?;
    reader.skip();
    reader.rest.is_empty().then_some(found)
}

struct Reader<'a> {
    rest: &'a str,
    symbols: &'a [Symbol],
}

impl Reader<'_> {
    fn skip(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// Takes a sign if it comes next.
    fn sign(&mut self, sign: char) -> bool {
        self.skip();
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn sum(&mut self) -> Option<E> {
        let mut found = self.product()?;
        loop {
            if self.sign('+') {
                found = found.plus(self.product()?);
            } else if self.sign('-') {
                found = found.minus(self.product()?);
            } else {
                return Some(found);
            }
        }
    }

    fn product(&mut self) -> Option<E> {
        if self.sign('-') {
            return Some(self.product()?.negated());
        }
        let mut found = self.power()?;
        loop {
            if self.sign('*') {
                found = found.times(self.power()?);
            } else if self.sign('/') {
                found = found.over(self.power()?);
            } else {
                return Some(found);
            }
        }
    }

    fn power(&mut self) -> Option<E> {
        let base = self.primary()?;
        if !self.sign('^') {
            return Some(base);
        }
        let bracket = self.sign('(');
        let negative = self.sign('-');
        let exponent: i32 = self.word(|c| c.is_ascii_digit())?.parse().ok()?;
        if bracket && !self.sign(')') {
            return None;
        }
        Some(base.power(if negative { -exponent } else { exponent }))
    }

    fn word(&mut self, takes: impl Fn(char) -> bool) -> Option<&str> {
        self.skip();
        let end = self.rest.find(|c| !takes(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn primary(&mut self) -> Option<E> {
        if self.sign('(') {
            let found = self.sum()?;
            return self.sign(')').then_some(found);
        }
        self.skip();
        if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            let text = self.word(|c| c.is_ascii_digit() || c == '.')?;
            return decimal(text).map(E::Number);
        }
        let name = self.word(|c| c.is_ascii_alphabetic())?.to_owned();
        if name == "pi" {
            return Some(E::Pi);
        }
        if let Some(symbol) = self.symbols.iter().find(|symbol| **symbol == name) {
            return Some(E::Symbol(symbol));
        }
        let all = [
            Function::Sin,
            Function::Cos,
            Function::Tan,
            Function::Asin,
            Function::Acos,
            Function::Atan,
            Function::Sqrt,
            Function::Exp,
            Function::Log,
        ];
        let function = all.into_iter().find(|function| function.name() == name)?;
        if !self.sign('(') {
            return None;
        }
        let inner = self.sum()?;
        self.sign(')').then(|| inner.of(function))
    }
}

/// Digits, perhaps with a point.
fn decimal(text: &str) -> Option<RBig> {
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    let digits: RBig = format!("{whole}{part}").parse().ok()?;
    let scale: RBig = format!("1{}", "0".repeat(part.len())).parse().ok()?;
    Some(digits / scale)
}

#[cfg(test)]
mod tests {
    use super::super::number::Number;
    use super::super::point::Point;
    use super::super::series::value;
    use super::*;

    #[test]
    fn what_is_printed_is_read_back() {
        let of = |text: &str| value(&read_constant(text).unwrap(), &Point::default()).unwrap();
        assert_eq!(of("-3*pi/2").as_turns(), Some(RBig::from(-3) / RBig::from(2)));
        assert!(matches!(of("1 + 2*(sqrt(4) - 3)^2"), Number::Rational(value) if value == RBig::from(3)));
        assert!(matches!(of("0.25^(-1)"), Number::Rational(value) if value == RBig::from(4)));
        assert!(read_constant("x + 1").is_none() && read_constant("2 pi").is_none());
    }
}
