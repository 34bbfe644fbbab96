//! Rational expressions as products of polynomials above products of polynomials.
//!
//! The variables are the plain symbols and, for each angle, the tangent `t` of its half: `sin = 2t/(1+t^2)`,
//! `cos = (1-t^2)/(1+t^2)`. No relation is left between them, so that a polynomial has one factorisation and what
//! divides can be divided out; the price, an angle of a half turn at which `t` is infinite, is paid back by
//! [`Products::node`], which writes a polynomial as the form in `sin(phi/2)` and `cos(phi/2)` that it stands for.
//! Functions other than these are unknowns of their own.

use super::graph::{Graph, NodeId, Symbol};
use super::input::Input;
use super::program::Program;
use crate::number::polynomial::{LARGEST_ARITY, Polynomial, Ring};
use crate::number::{Arithmetic, Fraction, Fractions, Function};
use dashu::base::Gcd;
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// What a polynomial is one in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variable {
    /// A symbol.
    Plain(Symbol),
    /// The tangent of half an angle.
    HalfTangent(Symbol),
    /// The value of a function that is treated as an unknown.
    Unknown(NodeId),
}

/// Nodes as fractions.
pub type NodeFractions = Vec<(NodeId, Fraction)>;

/// The polynomials that some expressions are made of.
#[derive(Default)]
pub struct Products {
    variables: Vec<Variable>,
    fractions: Fractions<Polynomial>,
}

impl Products {
    /// What has been met so far, in the order of the polynomials' variables.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The arithmetic of the fractions.
    pub fn fractions(&self) -> &Fractions<Polynomial> {
        &self.fractions
    }

    /// The expressions as fractions, and with them all nodes that they need. Sines and cosines of sums of angles must
    /// have been expanded.
    ///
    /// # Errors
    /// In words, where they are no rational expressions in at most [`LARGEST_ARITY`] variables, are nowhere defined, or would be
    /// too long.
    pub fn read(
        &mut self,
        graph: &Graph,
        roots: &[NodeId],
        is_angle: impl Fn(Symbol) -> bool,
    ) -> Result<(Vec<Fraction>, NodeFractions), String> {
        let program = Program::with_unknown_functions(graph, roots, is_angle);
        if let Some(angle) = program.bare_angle() {
            let name = graph.symbol_name(angle);
            return Err(format!("'{name}' is declared as an angle but stands outside sin, cos and tan"));
        }
        let inputs =
            program.inputs().iter().map(|input| self.input(*input)).collect::<Result<Vec<_>, _>>()?;
        let loaded = program.load(&self.fractions).map_err(|refusal| refusal.to_string())?;
        let mut registers = Vec::new();
        let values = loaded
            .run(&inputs, &mut registers)
            .map_err(|failure| format!("{}, in {}", failure.refusal, graph.text(failure.node)))?;
        Ok((values, program.nodes().iter().copied().zip(registers).collect()))
    }

    fn input(&mut self, input: Input) -> Result<Fraction, String> {
        let (symbol, sine) = match input {
            Input::Plain(symbol) => return self.plain(Variable::Plain(symbol)),
            Input::Opaque(node) => return self.plain(Variable::Unknown(node)),
            Input::Sine(symbol) => (symbol, true),
            Input::Cosine(symbol) => (symbol, false),
        };
        let place = self.place(Variable::HalfTangent(symbol))?;
        let (t, circle) = (Polynomial::variable(place), one_plus_square(place));
        let two = Polynomial::integer(&IBig::from(2));
        let top = if sine { t.add(&t) } else { two.add(&circle.neg()) };
        let (top, bottom) = (self.fractions.element(top), self.fractions.element(circle));
        self.fractions.div(&top, &bottom).map_err(|refusal| refusal.to_string())
    }

    /// The variable's place, new or known.
    fn place(&mut self, variable: Variable) -> Result<usize, String> {
        match self.variables.iter().position(|known| *known == variable) {
            Some(place) => Ok(place),
            None if self.variables.len() == LARGEST_ARITY => {
                Err(format!("more than {LARGEST_ARITY} variables"))
            }
            None => {
                self.variables.push(variable);
                Ok(self.variables.len() - 1)
            }
        }
    }

    fn plain(&mut self, variable: Variable) -> Result<Fraction, String> {
        let place = self.place(variable)?;
        Ok(self.fractions.element(Polynomial::variable(place)))
    }

    /// The same polynomials in other variables, for their forms: place by place.
    pub fn renamed(&self, name: impl Fn(Variable) -> Variable) -> Products {
        let variables = self.variables.iter().map(|variable| name(*variable)).collect();
        Products { variables, fractions: Fractions::default() }
    }

    /// The polynomials `1 + t^2`, which vanish nowhere.
    pub fn circles(&self) -> Vec<Polynomial> {
        let is_tangent = |place: &usize| matches!(self.variables[*place], Variable::HalfTangent(_));
        (0..self.variables.len()).filter(is_tangent).map(one_plus_square).collect()
    }

    /// The cosine of half of the angle whose half tangent has this place among the variables.
    pub fn half_cosine(&self, graph: &mut Graph, place: usize) -> Option<NodeId> {
        match self.variables.get(place)? {
            Variable::HalfTangent(symbol) => Some(half(graph, *symbol, Function::Cos)),
            _ => None,
        }
    }

    /// An expression that vanishes where a polynomial does: a positive multiple of the form that it stands for. For each
    /// angle of degree `d` that is the polynomial times `cos(phi/2)^d`, written in the sine and the cosine of the angle
    /// where `d` is even, of half the angle where it is odd; so it has a value at a half turn too.
    pub fn node(&self, graph: &mut Graph, polynomial: &Polynomial) -> NodeId {
        self.form(graph, polynomial).1
    }

    /// The form itself.
    pub fn exactly(&self, graph: &mut Graph, polynomial: &Polynomial) -> NodeId {
        let (factor, form) = self.form(graph, polynomial);
        let factor = graph.rational(factor);
        graph.mul(factor, form)
    }

    /// The form over a positive factor, and the factor.
    fn form(&self, graph: &mut Graph, polynomial: &Polynomial) -> (RBig, NodeId) {
        let mut terms: Vec<(Vec<u8>, IBig)> =
            polynomial.terms().map(|(e, c)| (e[..self.variables.len()].to_vec(), c.clone())).collect();
        let mut bases: Vec<NodeId> = Vec::new();
        for variable in &self.variables {
            bases.push(match variable {
                Variable::Unknown(node) => *node,
                Variable::Plain(symbol) | Variable::HalfTangent(symbol) => graph.symbol(*symbol),
            });
        }
        let mut halvings = 0;
        for (place, variable) in self.variables.iter().enumerate() {
            let Variable::HalfTangent(symbol) = variable else { continue };
            let degree = polynomial.degree_in(place);
            let (sine, cosine) = if degree.is_multiple_of(2) {
                let angle = graph.symbol(*symbol);
                (graph.apply(Function::Sin, angle), graph.apply(Function::Cos, angle))
            } else {
                (half(graph, *symbol, Function::Sin), half(graph, *symbol, Function::Cos))
            };
            bases[place] = cosine;
            bases.push(sine);
            if degree.is_multiple_of(2) {
                terms = in_whole_angle(&terms, place, degree / 2);
                halvings += i32::from(degree / 2);
            } else {
                for (exponents, _) in &mut terms {
                    exponents.push(exponents[place]);
                    exponents[place] = degree - exponents[place];
                }
            }
        }
        let content = terms.iter().fold(IBig::ZERO, |content, (_, c)| content.gcd(c).into());
        if !content.is_zero() {
            terms.iter_mut().for_each(|(_, c)| *c /= &content);
        }
        let factor = RBig::from(content) / RBig::from(IBig::ONE << halvings as usize);
        (factor, nested(graph, &bases, terms))
    }
}

fn one_plus_square(place: usize) -> Polynomial {
    let t = Polynomial::variable(place);
    Polynomial::integer(&IBig::ONE).add(&t.mul(&t).unwrap_or_default())
}

pub(super) fn half(graph: &mut Graph, angle: Symbol, function: Function) -> NodeId {
    let angle = graph.symbol(angle);
    let factor = graph.rational(RBig::ONE / RBig::from(2));
    let half = graph.mul(factor, angle);
    graph.apply(function, half)
}

/// With `S` and `C` the sine and the cosine of half the angle, `2 S^2 = 1 - cos`, `2 C^2 = 1 + cos`, `2 S C = sin`: each
/// `t^j` stands for `S^j C^(2k - j)`, which is `(1 - cos)^a (1 + cos)^b`, times the sine if `j` is odd, over `2^k`. The
/// place of `t` becomes that of the cosine, and the sine gets a new one.
fn in_whole_angle(terms: &[(Vec<u8>, IBig)], place: usize, k: u8) -> Vec<(Vec<u8>, IBig)> {
    let mut found: BTreeMap<Vec<u8>, IBig> = BTreeMap::new();
    for (exponents, coefficient) in terms {
        let j = exponents[place];
        let (a, odd) = (j / 2, j % 2);
        let b = k - a - odd;
        for (power, c) in binomials(a, b).into_iter().enumerate() {
            let mut e = exponents.clone();
            e[place] = power as u8;
            e.push(odd);
            *found.entry(e).or_insert(IBig::ZERO) += coefficient * c;
        }
    }
    found.into_iter().filter(|(_, c)| !c.is_zero()).collect()
}

/// The coefficients of `(1 - x)^a (1 + x)^b`.
fn binomials(a: u8, b: u8) -> Vec<IBig> {
    let mut row = vec![IBig::ONE];
    for sign in std::iter::repeat_n(-1, usize::from(a)).chain(std::iter::repeat_n(1, usize::from(b))) {
        row.push(IBig::ZERO);
        for i in (1..row.len()).rev() {
            let moved = &row[i - 1] * IBig::from(sign);
            row[i] += moved;
        }
    }
    row
}

/// A sum of monomials, with the base that most of them have taken out of these, again and again.
fn nested(graph: &mut Graph, bases: &[NodeId], terms: Vec<(Vec<u8>, IBig)>) -> NodeId {
    let common = (0..bases.len()).max_by_key(|place| {
        let count = terms.iter().filter(|(e, _)| e.get(*place).is_some_and(|e| *e > 0)).count();
        (count, std::cmp::Reverse(*place))
    });
    let (Some(place), true) = (common, terms.iter().any(|(e, _)| e.iter().any(|e| *e > 0))) else {
        let sum = terms.into_iter().fold(IBig::ZERO, |sum, (_, c)| sum + c);
        return graph.rational(RBig::from(sum));
    };
    let (mut with, without): (Vec<_>, Vec<_>) = terms.into_iter().partition(|(e, _)| e[place] > 0);
    let power = with.iter().map(|(e, _)| e[place]).min().unwrap_or(1);
    for (exponents, _) in &mut with {
        exponents[place] -= power;
    }
    let inner = nested(graph, bases, with);
    let base = graph.power(bases[place], i32::from(power));
    let product = graph.mul(base, inner);
    if without.is_empty() {
        return product;
    }
    // a sum that begins with a minus reads better as a difference
    let negative = without.iter().all(|(_, c)| *c < IBig::ZERO);
    let without: Vec<_> =
        if negative { without.into_iter().map(|(e, c)| (e, -c)).collect() } else { without };
    let rest = nested(graph, bases, without);
    if negative { graph.sub(product, rest) } else { graph.add(product, rest) }
}
