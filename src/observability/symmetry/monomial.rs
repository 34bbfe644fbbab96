//! Polynomials in coordinates and in sines and cosines of angles, with integer coefficients.

use super::kernel::{KernelSource, Point};
use crate::expression::{Graph, NodeId, Symbol, SymbolFunction, SymbolInput};
use crate::number::Function;

/// A product of powers of variables, which are named by their places in [`KernelSource::variables`].
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Monomial {
    pub powers: Vec<(usize, u8)>,
    /// An angle itself, and not its sine or cosine: it has a derivative, and no value modulo a prime.
    pub angle: Option<Symbol>,
}

impl Monomial {
    pub fn variable(variable: usize) -> Monomial {
        Monomial { powers: vec![(variable, 1)], angle: None }
    }

    pub fn degree(&self) -> usize {
        self.powers.iter().map(|(_, power)| usize::from(*power)).sum::<usize>()
            + usize::from(self.angle.is_some())
    }

    pub fn value(&self, source: &KernelSource, point: &Point) -> u64 {
        let r = source.residues;
        self.powers
            .iter()
            .fold(r.one(), |product, (place, power)| r.mul(product, r.power(point.values[*place], *power)))
    }

    /// The partial derivative by a symbol, at a point.
    pub fn slope(&self, source: &KernelSource, point: &Point, symbol: Symbol) -> u64 {
        let r = source.residues;
        if let Some(angle) = self.angle {
            return if angle == symbol { r.one() } else { 0 };
        }
        let mut total = 0;
        for (at, (place, power)) in self.powers.iter().enumerate() {
            let SymbolInput { symbol: of, function } = source.variables[*place];
            if of != symbol {
                continue;
            }
            // the partner of a sine stands behind it
            let inner = match function {
                SymbolFunction::Itself => r.one(),
                SymbolFunction::Sine => point.values[place + 1],
                SymbolFunction::Cosine => r.neg(point.values[place - 1]),
            };
            let mut term = r.mul(inner, r.integer(i64::from(*power)));
            term = r.mul(term, r.power(point.values[*place], power - 1));
            for (other, (place, power)) in self.powers.iter().enumerate() {
                if other != at {
                    term = r.mul(term, r.power(point.values[*place], *power));
                }
            }
            total = r.add(total, term);
        }
        total
    }

    fn node(&self, graph: &mut Graph, variables: &[SymbolInput]) -> NodeId {
        let mut product = match self.angle {
            Some(angle) => graph.symbol(angle),
            None => graph.integer(1),
        };
        for (place, power) in &self.powers {
            let factor = variable_node(graph, variables[*place]);
            let factor = graph.power(factor, i32::from(*power));
            product = graph.mul(product, factor);
        }
        product
    }
}

fn variable_node(graph: &mut Graph, variable: SymbolInput) -> NodeId {
    let symbol = graph.symbol(variable.symbol);
    match variable.function {
        SymbolFunction::Itself => symbol,
        SymbolFunction::Sine => graph.apply(Function::Sin, symbol),
        SymbolFunction::Cosine => graph.apply(Function::Cos, symbol),
    }
}

/// All monomials of exactly one degree in some variables; a square of a sine is left out, since it is one less that of the
/// cosine.
pub(super) fn monomials(source: &KernelSource, variables: &[usize], degree: usize) -> Vec<Monomial> {
    let mut found = vec![Monomial::default()];
    for _ in 0..degree {
        let mut next = Vec::new();
        for monomial in &found {
            for variable in variables {
                let mut powers = monomial.powers.clone();
                match powers.last_mut() {
                    Some((last, _)) if *last > *variable => continue,
                    Some((last, power)) if last == variable => {
                        if source.variables[*variable].function == SymbolFunction::Sine {
                            continue;
                        }
                        *power += 1;
                    }
                    _ => powers.push((*variable, 1)),
                }
                next.push(Monomial { powers, angle: None });
            }
        }
        found = next;
    }
    found
}

/// How many monomials of up to a degree there are at the most.
pub(super) fn count(variables: usize, degree: usize) -> usize {
    (1..=degree).fold(1usize, |all, k| all.saturating_mul(variables + k) / k)
}

/// A sum of monomials with integer coefficients.
pub(super) type Polynomial = Vec<(Monomial, i64)>;

pub(super) fn value(polynomial: &Polynomial, source: &KernelSource, point: &Point) -> u64 {
    let r = source.residues;
    polynomial.iter().fold(0, |sum, (monomial, coefficient)| {
        r.add(sum, r.mul(r.integer(*coefficient), monomial.value(source, point)))
    })
}

/// As an expression that begins without a sign, where it can.
pub(super) fn polynomial_node(
    graph: &mut Graph,
    variables: &[SymbolInput],
    polynomial: &Polynomial,
) -> NodeId {
    let mut sum = graph.integer(0);
    let (positive, negative): (Vec<_>, Vec<_>) = polynomial.iter().partition(|(_, c)| *c > 0);
    for (monomial, coefficient) in positive {
        let node = monomial.node(graph, variables);
        let factor = graph.integer(*coefficient);
        let term = graph.mul(factor, node);
        sum = graph.add(sum, term);
    }
    for (monomial, coefficient) in negative {
        let node = monomial.node(graph, variables);
        let factor = graph.integer(coefficient.saturating_neg());
        let term = graph.mul(factor, node);
        sum = graph.sub(sum, term);
    }
    sum
}
