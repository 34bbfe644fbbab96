//! Functions that are made of others, and powers that are not integers: what they stand for, and what they need.

use super::codes::Code;
use super::error::Problem;
use super::foreign::call_of;
use super::model::{System, Value};
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Expr, Span};
use palmistry_math::expression::{COMPOSED, Need, NodeId};
use palmistry_math::number::Function;

/// No greater integer is an exponent.
const LARGEST_EXPONENT: i32 = 1000;

impl System {
    /// A call of a function that is made of others; nothing where the name is none of theirs.
    pub(super) fn composed(
        &mut self,
        name: &str,
        arguments: &[Expr],
        span: &Span,
    ) -> Option<Result<Value, Problem>> {
        let (name, least, most) = COMPOSED.into_iter().find(|(known, ..)| *known == name)?;
        if !(least..=most).contains(&arguments.len()) {
            let wanted = match (least, most) {
                (1, _) => "one argument",
                (_, 2) => "two arguments",
                _ => "two arguments or more",
            };
            let message = format!("'{name}' takes {wanted}");
            return Some(Err(Problem::new(
                Code::Arguments,
                span,
                message,
                format!("{} here", arguments.len()),
            )
            .help(call_of(name))));
        }
        Some(self.composed_of(name, arguments))
    }

    fn composed_of(&mut self, name: &str, arguments: &[Expr]) -> Result<Value, Problem> {
        let mut values = Vec::with_capacity(arguments.len());
        for argument in arguments {
            values.push(self.scalar(argument)?);
        }
        let first = values[0];
        let value = match name {
            "abs" => self.absolute(first),
            "sign" => {
                let size = self.absolute(first);
                self.need(first, Need::NotZero);
                self.graph.div(first, size)
            }
            "min" | "max" => {
                let mut found = first;
                for other in &values[1..] {
                    let difference = self.graph.sub(found, *other);
                    self.absolute(difference);
                    found = self.graph.extreme(found, *other, name == "max");
                }
                found
            }
            "atan2" => {
                let x = values[1];
                let squares = [self.graph.power(x, 2), self.graph.power(first, 2)];
                let sum = self.graph.add(squares[0], squares[1]);
                self.need(sum, Need::NotNegative);
                let divisor = self.graph.half_angle_divisor(first, x);
                self.need(divisor, Need::NotZero);
                self.graph.angle_of_point(first, x)
            }
            _ => self.graph.hyperbolic(name, first),
        };
        Ok(Value::Scalar(value))
    }

    /// The absolute value of an expression, which has derivatives where this is not zero.
    fn absolute(&mut self, a: NodeId) -> NodeId {
        let square = self.graph.power(a, 2);
        self.need(square, Need::NotNegative);
        self.graph.absolute(a)
    }

    /// A power whose exponent is not written as an integer: of an integer and of halves by roots, else `exp(n log(x))`.
    pub(super) fn real_power(&mut self, base: &Expr, exponent: &Expr, span: &Span) -> Result<Value, Problem> {
        let (base, power) = (self.scalar(base)?, self.scalar(exponent)?);
        let known = self.graph.constant_value(power).cloned();
        let halves =
            known.as_ref().map(|value| value * RBig::from(2)).filter(|twice| twice.denominator().is_one());
        let value = match (known, halves) {
            (Some(value), Some(twice)) => {
                let whole = value.denominator().is_one();
                let count = if whole { value.numerator() } else { twice.numerator() };
                let count = i32::try_from(count.clone()).ok().filter(|n| n.abs() <= LARGEST_EXPONENT);
                let Some(count) = count else {
                    let message = format!("an exponent of at most {LARGEST_EXPONENT} is expected");
                    return Err(Problem::new(Code::Number, span, message, "here")
                        .help("write exp(n*log(x)) for any other power of a positive number"));
                };
                let mut base = base;
                if !whole {
                    self.need(base, Need::NotNegative);
                    base = self.graph.apply(Function::Sqrt, base);
                }
                if count < 0 {
                    self.need(base, Need::NotZero);
                }
                self.graph.power(base, count)
            }
            _ => {
                self.need(base, Need::Positive);
                self.graph.real_power(base, power)
            }
        };
        Ok(Value::Scalar(value))
    }
}
