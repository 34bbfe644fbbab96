//! The fully multiplied-out form of an expression as a formula of its own, term by term: what a computer-algebra
//! system prints, and what people paste into their programs.

use palmistry_math::expression::{Expansion, Graph, Input, NodeId, Symbol, expand};
use palmistry_math::number::Function;
use palmistry_math::number::polynomial::Polynomial;

/// The multiplied-out forms of some expressions, as expressions: over each denominator a sum of monomials, added up one
/// after the other. A power of a variable that occurs in several monomials is taken once, and nothing else is shared.
///
/// # Errors
/// In words, where an expression cannot be expanded, or all of them together have more than `most` monomials.
pub fn term_by_term(
    graph: &mut Graph,
    entries: &[NodeId],
    is_angle: impl Fn(Symbol) -> bool,
    most: usize,
) -> Result<Vec<NodeId>, String> {
    let mut monomials = 0;
    let mut found = Vec::with_capacity(entries.len());
    for entry in entries {
        let expansion = expand(graph, *entry, &is_angle)?;
        let lengths = expansion.denominator.iter().map(|(factor, _)| factor.len());
        monomials += expansion.numerator.len() + lengths.sum::<usize>();
        if monomials > most {
            return Err(format!("too large: more than {most} monomials"));
        }
        found.push(formula(graph, &expansion));
    }
    Ok(found)
}

fn formula(graph: &mut Graph, expansion: &Expansion) -> NodeId {
    let variables: Vec<NodeId> =
        expansion.variables.iter().map(|variable| variable_node(graph, *variable)).collect();
    let sum = sum_of_monomials(graph, &expansion.numerator, &variables);
    let front = graph.rational(expansion.front.clone());
    let top = graph.mul(front, sum);
    let mut bottom = graph.integer(1);
    for (factor, power) in &expansion.denominator {
        let value = sum_of_monomials(graph, factor, &variables);
        // a power beyond any exponent of this world would not have been expanded
        let value = graph.power(value, i32::try_from(*power).unwrap_or(i32::MAX));
        bottom = graph.mul(bottom, value);
    }
    graph.div(top, bottom)
}

fn variable_node(graph: &mut Graph, variable: Input) -> NodeId {
    match variable {
        Input::Plain(symbol) => graph.symbol(symbol),
        Input::Sine(symbol) => {
            let angle = graph.symbol(symbol);
            graph.apply(Function::Sin, angle)
        }
        Input::Cosine(symbol) => {
            let angle = graph.symbol(symbol);
            graph.apply(Function::Cos, angle)
        }
        Input::Opaque(node) => node,
    }
}

fn sum_of_monomials(graph: &mut Graph, polynomial: &Polynomial, variables: &[NodeId]) -> NodeId {
    let mut sum = graph.integer(0);
    for (exponents, coefficient) in polynomial.terms() {
        let mut term = graph.integer(1);
        for (variable, exponent) in variables.iter().zip(exponents) {
            let power = graph.power(*variable, i32::from(*exponent));
            term = graph.mul(term, power);
        }
        // the coefficient last: two monomials that differ in it alone do not exist
        let coefficient = graph.rational(coefficient.clone().into());
        term = graph.mul(coefficient, term);
        sum = graph.add(sum, term);
    }
    sum
}
