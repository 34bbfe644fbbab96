//! An expression multiplied out: a sum of monomials over one common denominator, as a computer-algebra system's
//! `simplify` leaves it.

use super::graph::{Graph, NodeId, Symbol};
use super::input::Input;
use super::program::Program;
use crate::expression::expand_angles;
use crate::number::polynomial::{Exponents, LARGEST_ARITY, Polynomial, Ring};
use crate::number::{Arithmetic, Fractions, Refusal};
use dashu::integer::IBig;
use dashu::rational::RBig;

/// `front * numerator / denominator`, the numerator a primitive polynomial with sines at most to the first power.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// The variables, by their index in the monomials.
    pub variables: Vec<Input>,
    /// The rational factor in front.
    pub front: RBig,
    /// The sum of monomials.
    pub numerator: Polynomial,
    /// The factors of the denominator and their powers; no factor divides the numerator.
    pub denominator: Vec<(Polynomial, u32)>,
}

/// Expands an expression.
///
/// # Errors
/// In words, where it is no rational expression in at most [`LARGEST_ARITY`] variables, or too long.
pub fn expand(
    graph: &mut Graph,
    root: NodeId,
    is_angle: impl Fn(Symbol) -> bool,
) -> Result<Expansion, String> {
    let expanded = expand_angles(graph, &[root], &is_angle);
    let program = Program::new(graph, &expanded, &is_angle);
    let variables = program.inputs().to_vec();
    if variables.len() > LARGEST_ARITY {
        return Err(format!("{} variables; at most {LARGEST_ARITY} can be expanded", variables.len()));
    }
    let circles = circles(&variables);
    let reduce = circles.clone();
    let fractions = Fractions::<Polynomial>::with_normal_form(move |p| reduced(p, &reduce));
    let inputs: Vec<_> = (0..variables.len()).map(|i| fractions.element(Polynomial::variable(i))).collect();
    let loaded = program.load(&fractions).map_err(|refusal| refusal.to_string())?;
    let value = loaded
        .run(&inputs, &mut Vec::new())
        .map_err(|failure| format!("{}, in {}", failure.refusal, graph.text(failure.node)))?
        .remove(0);
    let too_long = |refusal: Refusal| refusal.to_string();
    let mut numerator = reduced(fractions.expand(&value.top).map_err(too_long)?, &circles);
    let mut front = RBig::ONE;
    let mut denominator = Vec::new();
    for (place, power) in &value.bottom {
        let factor = fractions.factor(*place);
        let content = factor.content();
        let scale = RBig::ONE / RBig::from(content.clone());
        front *= (0..*power).fold(RBig::ONE, |p, _| p * &scale);
        let Some(primitive) = factor.divide_exactly(&Polynomial::integer(&content)) else {
            return Err("a factor of the denominator is zero".to_owned());
        };
        let mut left = *power;
        while left > 0
            && let Some(quotient) = divide(&numerator, &primitive, &circles)
        {
            numerator = quotient;
            left -= 1;
        }
        if left > 0 && primitive != Polynomial::integer(&IBig::ONE) {
            denominator.push((primitive, left));
        }
    }
    let content = numerator.content();
    if !content.is_zero() {
        front *= RBig::from(content.clone());
        numerator = numerator.divide_exactly(&Polynomial::integer(&content)).unwrap_or(numerator);
    }
    Ok(Expansion { variables, front, numerator, denominator })
}

/// Places of the sine and the cosine of each angle that has a sine.
fn circles(variables: &[Input]) -> Vec<(usize, Option<usize>)> {
    let place = |wanted: Input| variables.iter().position(|v| *v == wanted);
    variables
        .iter()
        .enumerate()
        .filter_map(|(i, v)| match v {
            Input::Sine(symbol) => Some((i, place(Input::Cosine(*symbol)))),
            _ => None,
        })
        .collect()
}

/// `1 - cos^2`, where there is a cosine.
fn square_of_sine(cosine: usize) -> Polynomial {
    let c = Polynomial::variable(cosine);
    let square = c.mul(&c).unwrap_or_default();
    Polynomial::integer(&IBig::ONE).add(&square.neg())
}

/// The polynomial with each sine at most to the first power.
fn reduced(polynomial: Polynomial, circles: &[(usize, Option<usize>)]) -> Polynomial {
    circles.iter().fold(polynomial, |p, (sine, cosine)| match cosine {
        Some(cosine) => p.reduce_square(*sine, &square_of_sine(*cosine)).unwrap_or(p),
        None => p,
    })
}

/// The quotient in the ring in which `sin^2 = 1 - cos^2`: a sine divides `a + b sin` where `1 - cos^2` divides `a`.
fn divide(
    numerator: &Polynomial,
    factor: &Polynomial,
    circles: &[(usize, Option<usize>)],
) -> Option<Polynomial> {
    if let Some(quotient) = numerator.divide_exactly(factor) {
        return Some(quotient);
    }
    let (sine, cosine) = circles
        .iter()
        .find_map(|(sine, cosine)| (*factor == Polynomial::variable(*sine)).then_some((*sine, (*cosine)?)))?;
    let raised = reduced(numerator.mul(&Polynomial::variable(sine))?, circles);
    raised.divide_exactly(&square_of_sine(cosine))
}

impl Expansion {
    /// The value by adding up the monomials one after the other, in the numbers of an arithmetic: what an evaluation
    /// of the printed formula does. `order` permutes the monomials, `within` the factors of each.
    ///
    /// # Errors
    /// Where an operation is refused.
    pub fn sum_terms<A: Arithmetic>(
        &self,
        arithmetic: &A,
        values: &[A::Number],
        order: &[usize],
        within: &[usize],
    ) -> Result<A::Number, Refusal> {
        let terms: Vec<(&Exponents, &IBig)> = self.numerator.terms().collect();
        let mut sum = arithmetic.rational(&RBig::ZERO)?;
        for index in order {
            let (exponents, coefficient) = terms[*index];
            let term = self.monomial(arithmetic, values, exponents, coefficient, within)?;
            sum = arithmetic.add(&sum, &term)?;
        }
        let mut bottom = arithmetic.rational(&RBig::ONE)?;
        for (factor, power) in &self.denominator {
            let mut value = arithmetic.rational(&RBig::ZERO)?;
            for (exponents, coefficient) in factor.terms() {
                value = arithmetic
                    .add(&value, &self.monomial(arithmetic, values, exponents, coefficient, within)?)?;
            }
            let power = i32::try_from(*power).map_err(|_| Refusal::TooLarge)?;
            bottom = arithmetic.mul(&bottom, &arithmetic.power(&value, power)?)?;
        }
        let top = arithmetic.mul(&arithmetic.rational(&self.front)?, &sum)?;
        arithmetic.div(&top, &bottom)
    }

    fn monomial<A: Arithmetic>(
        &self,
        arithmetic: &A,
        values: &[A::Number],
        exponents: &Exponents,
        coefficient: &IBig,
        within: &[usize],
    ) -> Result<A::Number, Refusal> {
        let mut term = arithmetic.rational(&RBig::from(coefficient.clone()))?;
        for variable in within {
            let exponent = exponents[*variable];
            if exponent > 0 {
                term = arithmetic.mul(&term, &arithmetic.power(&values[*variable], i32::from(exponent))?)?;
            }
        }
        Ok(term)
    }

    /// The name of a variable, as `r1` or `cos(phi2)`.
    pub fn variable_name(&self, graph: &Graph, index: usize) -> String {
        match self.variables[index] {
            Input::Plain(symbol) => graph.symbol_name(symbol).to_owned(),
            Input::Sine(symbol) => format!("sin({})", graph.symbol_name(symbol)),
            Input::Cosine(symbol) => format!("cos({})", graph.symbol_name(symbol)),
            Input::Opaque(node) => graph.text(node),
        }
    }

    /// A polynomial in these variables, as text, cut after some terms.
    pub fn text(&self, graph: &Graph, polynomial: &Polynomial, most: usize) -> String {
        let mut text = String::new();
        for (count, (exponents, coefficient)) in polynomial.terms().rev().enumerate() {
            if count == most {
                text.push_str(&format!(" + ... ({} terms more)", polynomial.len() - most));
                break;
            }
            let negative = *coefficient < IBig::ZERO;
            let magnitude = if negative { -coefficient.clone() } else { coefficient.clone() };
            text.push_str(match (text.is_empty(), negative) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            });
            let mut factors = Vec::new();
            for (index, exponent) in exponents.iter().enumerate().filter(|(_, e)| **e > 0) {
                let name = self.variable_name(graph, index);
                factors.push(if *exponent == 1 { name } else { format!("{name}^{exponent}") });
            }
            if magnitude != IBig::ONE || factors.is_empty() {
                factors.insert(0, magnitude.to_string());
            }
            text.push_str(&factors.join("*"));
        }
        if text.is_empty() { "0".to_owned() } else { text }
    }
}
