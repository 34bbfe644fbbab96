//! A state in exact numbers.

use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{Input, Program, Symbol, SymbolFunction, SymbolInput};
use palmistry_math::number::{Arithmetic, Function, RealNumber, Refusal, rational_to_f64};
use std::collections::BTreeMap;

/// The exact value of one symbol.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // names and messages say it
pub enum Coordinate {
    /// A rational number; of an angle, in radians.
    Number(RBig),
    /// An angle by its sine and cosine, both rational, their squares adding up to one.
    Angle { sine: RBig, cosine: RBig },
}

impl Coordinate {
    /// The angle whose half has the rational tangent `t`.
    pub fn from_half_tangent(t: &RBig) -> Self {
        let square = t * t;
        let bottom = RBig::ONE + &square;
        Coordinate::Angle { sine: (t + t) / &bottom, cosine: (RBig::ONE - square) / bottom }
    }

    /// The double nearest to the value; for an angle in radians, between minus pi and pi.
    pub fn to_f64(&self) -> f64 {
        match self {
            Coordinate::Number(value) => rational_to_f64(value),
            Coordinate::Angle { sine, cosine } => rational_to_f64(sine).atan2(rational_to_f64(cosine)),
        }
    }

    /// The value in exact numbers, in words: `3/2`, or `sin = 4/5, cos = 3/5`.
    pub fn exact_text(&self) -> String {
        match self {
            Coordinate::Number(value) => value.to_string(),
            Coordinate::Angle { sine, cosine } => format!("sin = {sine}, cos = {cosine}"),
        }
    }
}

/// A coordinate of a state in words.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCoordinate {
    /// The symbol's name.
    pub name: String,
    /// Its exact value: `3/2`, or `sin = 4/5, cos = 3/5`.
    pub exact: String,
    /// The nearest double; of an angle in radians.
    pub value: f64,
}

/// A state in words, in the order of its symbols.
pub type WrittenState = Vec<NamedCoordinate>;

/// Why a state lacks an input of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingInput {
    /// A number has no image in the arithmetic.
    Refused(Refusal),
    /// The state has no value for a symbol, or the program asks for the value of a function.
    Unsaid,
}

impl From<Refusal> for MissingInput {
    fn from(refusal: Refusal) -> Self {
        MissingInput::Refused(refusal)
    }
}

/// Exact values for some symbols.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The values, by symbol.
    pub values: BTreeMap<Symbol, Coordinate>,
}

impl State {
    /// The inputs of a program at this state, in the numbers of an arithmetic.
    ///
    /// # Errors
    /// Where a number has no image there, or where the state has no value for a symbol.
    pub fn inputs<A: Arithmetic>(
        &self,
        program: &Program,
        arithmetic: &A,
    ) -> Result<Vec<A::Number>, MissingInput> {
        let mut inputs = Vec::with_capacity(program.inputs().len());
        for input in program.inputs() {
            let SymbolInput { symbol, function } = input.of_symbol().ok_or(MissingInput::Unsaid)?;
            let image = |value| arithmetic.rational(value);
            inputs.push(match (self.values.get(&symbol).ok_or(MissingInput::Unsaid)?, function) {
                // of an angle in radians the sine is no rational, and exact arithmetic refuses
                (Coordinate::Number(value), function) => function.of(arithmetic, image(value)?)?,
                (Coordinate::Angle { sine, .. }, SymbolFunction::Sine) => image(sine)?,
                (Coordinate::Angle { cosine, .. }, SymbolFunction::Cosine) => image(cosine)?,
                (Coordinate::Angle { sine, cosine }, SymbolFunction::Itself) => {
                    principal_value(arithmetic, sine, cosine)?
                }
            });
        }
        Ok(inputs)
    }

    /// The state in words, with the names of a system.
    pub fn describe(&self, system: &System) -> WrittenState {
        self.values
            .iter()
            .map(|(symbol, value)| NamedCoordinate {
                name: system.symbol_name(*symbol).to_owned(),
                exact: value.exact_text(),
                value: value.to_f64(),
            })
            .collect()
    }
}

/// The angle between minus pi and pi of which sine and cosine are given: `2 atan(sin/(1 + cos))`.
fn principal_value<A: Arithmetic>(arithmetic: &A, sine: &RBig, cosine: &RBig) -> Result<A::Number, Refusal> {
    if *cosine == RBig::from(-1) {
        return arithmetic.pi();
    }
    let half = arithmetic.rational(&(sine / (RBig::ONE + cosine)))?;
    let half = arithmetic.apply(Function::Atan, &half)?;
    arithmetic.mul(&arithmetic.rational(&RBig::from(2))?, &half)
}

/// A program's inputs at a state given in doubles, or in any other number of fixed size; angles in radians.
pub fn float_inputs<T: RealNumber>(program: &Program, value: impl Fn(Symbol) -> T) -> Vec<T> {
    let nothing = T::from_f64(f64::NAN);
    let at = |function, symbol: &Symbol| value(*symbol).function(function).unwrap_or(nothing);
    let input = |input: &Input| match input {
        Input::Plain(symbol) => value(*symbol),
        Input::Sine(symbol) => at(Function::Sin, symbol),
        Input::Cosine(symbol) => at(Function::Cos, symbol),
        Input::Opaque(_) => nothing,
    };
    program.inputs().iter().map(input).collect()
}
