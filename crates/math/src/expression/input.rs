//! The inputs of a program.

use super::{NodeId, Symbol};
use crate::number::{Arithmetic, Function, Refusal};

/// An input of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// The value of a symbol.
    Plain(Symbol),
    /// The sine of a symbol that is an angle.
    Sine(Symbol),
    /// The cosine of a symbol that is an angle.
    Cosine(Symbol),
    /// The value of a function that is treated as an unknown of its own (the node is the function's value), or pi.
    Opaque(NodeId),
}

/// A function of one symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SymbolInput {
    /// The symbol.
    pub symbol: Symbol,
    /// Which function of it.
    pub function: SymbolFunction,
}

/// Which function of a symbol is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolFunction {
    /// The symbol itself.
    Itself,
    /// Its sine.
    Sine,
    /// Its cosine.
    Cosine,
}

impl Input {
    /// The symbol that it is of, and what of it; nothing of what is treated as an unknown of its own.
    pub fn of_symbol(self) -> Option<SymbolInput> {
        let (symbol, function) = match self {
            Input::Plain(symbol) => (symbol, SymbolFunction::Itself),
            Input::Sine(symbol) => (symbol, SymbolFunction::Sine),
            Input::Cosine(symbol) => (symbol, SymbolFunction::Cosine),
            Input::Opaque(_) => return None,
        };
        Some(SymbolInput { symbol, function })
    }

    /// The symbol that it is of.
    pub fn symbol(self) -> Option<Symbol> {
        self.of_symbol().map(|input| input.symbol)
    }
}

impl SymbolFunction {
    /// The value, from that of the symbol; of an angle in radians.
    ///
    /// # Errors
    /// Where the arithmetic has no such sine or cosine.
    pub fn of<A: Arithmetic>(self, arithmetic: &A, value: A::Number) -> Result<A::Number, Refusal> {
        match self {
            SymbolFunction::Itself => Ok(value),
            SymbolFunction::Sine => arithmetic.apply(Function::Sin, &value),
            SymbolFunction::Cosine => arithmetic.apply(Function::Cos, &value),
        }
    }
}
