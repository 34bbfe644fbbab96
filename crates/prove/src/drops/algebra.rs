//! Expressions as polynomials without relations between their variables: each angle is the tangent of its half, or it is a
//! half turn, at which that tangent is infinite. So the states fall into charts, one for each set of angles that are half
//! turns, and in each of them a polynomial has one factorisation.

use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Graph, Node, NodeId, Products, Program, Symbol, Variable, expand_angles};
use palmistry_math::number::polynomial::{Polynomial, Ring};
use palmistry_math::number::{Fraction, Function, primitive};
use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::coordinates::Coordinates;
use super::factors::MOST_TERMS;

/// The angles that are half turns; of all others the tangent of the half is a number.
pub(super) type Chart = BTreeSet<Symbol>;

/// Why an algebraic answer was not found, in words.
pub(super) type Reach<T> = Result<T, String>;

/// A polynomial above another one, as products of factors.
pub(super) struct Ratio {
    pub top: Vec<(Polynomial, u32)>,
    pub bottom: Vec<(Polynomial, u32)>,
}

impl Ratio {
    /// A polynomial with the sign of the fraction; `None` where it becomes too long.
    pub fn signed(&self) -> Option<Polynomial> {
        let odd = self.bottom.iter().filter(|(_, n)| n % 2 == 1).map(|(factor, _)| (factor.clone(), 1));
        let all: Vec<_> = self.top.iter().cloned().chain(odd).collect();
        expanded(&all)
    }

    /// A polynomial with the sign of one less the square of the fraction; `None` where it becomes too long.
    pub fn below_one(&self) -> Option<Polynomial> {
        let (top, bottom) = (expanded(&self.top)?, expanded(&self.bottom)?);
        Some(bottom.mul(&bottom)?.add(&top.mul(&top)?.neg()))
    }
}

/// A system's expressions as polynomials.
pub(super) struct Algebra<'s> {
    pub system: &'s mut System,
    products: Products,
    /// Angles, with the symbols that stand for the tangents of their halves.
    pub tangents: BTreeMap<Symbol, Symbol>,
    /// What stands for states.
    pub coordinates: Coordinates,
    mapped: HashMap<(Chart, NodeId), NodeId>,
}

impl<'s> Algebra<'s> {
    /// For some expressions of a system. Symbols that are met inside sines and cosines alone are angles, whether or not the
    /// file says so.
    pub fn new(system: &'s mut System, mentioned: &[NodeId]) -> Self {
        let angles = angles_of(system, mentioned);
        let met = system.graph.symbols_of(mentioned.iter().copied());
        let tangents = angles
            .into_iter()
            .filter(|angle| met.contains(angle))
            .map(|angle| {
                // no name of a file begins like this
                let name = format!("#{}", system.graph.symbol_name(angle));
                (angle, system.graph.intern(&name))
            })
            .collect();
        Algebra {
            system,
            products: Products::default(),
            tangents,
            coordinates: Coordinates::default(),
            mapped: HashMap::new(),
        }
    }

    /// Takes other coordinates.
    pub fn change(&mut self, coordinates: Coordinates) {
        self.coordinates = coordinates;
        self.mapped.clear();
    }

    /// Does something with no variables met so far, and forgets those that it met.
    pub fn apart<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::take(&mut self.products);
        let found = work(self);
        self.products = before;
        found
    }

    /// All charts, the one without half turns first; `None` where they are too many.
    pub fn charts(&self) -> Option<Vec<Chart>> {
        if self.tangents.len() > MOST_ANGLES {
            return None;
        }
        let mut charts = vec![Chart::new()];
        for angle in self.tangents.keys() {
            let with = charts.iter().map(|chart| chart.iter().copied().chain([*angle]).collect());
            charts.extend(with.collect::<Vec<_>>());
        }
        charts.sort_by_key(Chart::len);
        Some(charts)
    }

    /// Expressions in a chart, as rational expressions of plain symbols.
    pub fn in_chart(&mut self, chart: &Chart, nodes: &[NodeId]) -> Vec<NodeId> {
        let missing: Vec<NodeId> =
            nodes.iter().copied().filter(|node| !self.mapped.contains_key(&(chart.clone(), *node))).collect();
        if !missing.is_empty() {
            let tangents = &self.tangents;
            let graph = &mut self.system.graph;
            let there = graph.substitute(&missing, &self.coordinates.values);
            let expanded = expand_angles(graph, &there, |symbol| tangents.contains_key(&symbol));
            let found = with_tangents(graph, &expanded, tangents, chart);
            for (node, image) in missing.into_iter().zip(found) {
                self.mapped.insert((chart.clone(), node), image);
            }
        }
        nodes.iter().map(|node| self.mapped[&(chart.clone(), *node)]).collect()
    }

    /// An expression of plain symbols as a fraction.
    pub fn read(&mut self, node: NodeId) -> Reach<Ratio> {
        let (mut values, _) = self.products.read(&self.system.graph, &[node], |_| false)?;
        let fraction = values.pop().unwrap_or_default();
        Ok(self.ratio(&fraction))
    }

    fn ratio(&self, fraction: &Fraction) -> Ratio {
        let list = |factors: &palmistry_math::number::Factors| {
            factors.iter().map(|(place, n)| (self.products.fractions().factor(*place), *n)).collect()
        };
        Ratio { top: list(&fraction.top), bottom: list(&fraction.bottom) }
    }

    /// The product of what stands above the bar: zero where the expression is.
    pub fn numerator(&mut self, node: NodeId) -> Reach<Polynomial> {
        let ratio = self.read(node)?;
        expanded(&ratio.top).ok_or_else(|| TOO_LONG.to_owned())
    }

    pub fn variables(&self) -> &[Variable] {
        self.products.variables()
    }

    /// Variables that are positive at all states: values of exponentials.
    pub fn positive_variables(&self) -> Vec<Polynomial> {
        let is_positive = |variable: &Variable| match variable {
            Variable::Unknown(node) => {
                matches!(self.system.graph.node(*node), Node::Apply(Function::Exp, _))
            }
            _ => false,
        };
        let places = self.products.variables().iter().enumerate();
        places.filter(|(_, one)| is_positive(one)).map(|(place, _)| Polynomial::variable(place)).collect()
    }

    /// The symbol of a variable that is one.
    pub fn symbol_at(&self, place: usize) -> Option<Symbol> {
        match self.products.variables().get(place)? {
            Variable::Plain(symbol) => Some(*symbol),
            Variable::HalfTangent(_) | Variable::Unknown(_) => None,
        }
    }

    /// The places of variables that are values of functions and mention a symbol.
    pub fn functions_of(&self, symbol: Symbol) -> Vec<usize> {
        let mentions = |variable: &Variable| match variable {
            Variable::Unknown(node) => self.system.graph.symbols_of([*node]).contains(&symbol),
            _ => false,
        };
        let variables = self.products.variables().iter().enumerate();
        variables.filter(|(_, variable)| mentions(variable)).map(|(place, _)| place).collect()
    }

    /// Whether a polynomial mentions a symbol inside a function.
    pub fn hides(&self, polynomial: &Polynomial, place: usize) -> bool {
        let Some(symbol) = self.symbol_at(place) else { return true };
        self.functions_of(symbol).into_iter().any(|function| polynomial.degree_in(function) > 0)
    }

    /// A polynomial as an expression of plain symbols, up to a positive factor.
    pub fn node(&mut self, polynomial: &Polynomial) -> NodeId {
        self.products.node(&mut self.system.graph, polynomial)
    }

    /// The very polynomial.
    pub fn exactly(&mut self, polynomial: &Polynomial) -> NodeId {
        self.products.exactly(&mut self.system.graph, polynomial)
    }

    /// A polynomial as an expression of the file's own symbols: the form in sines and cosines, up to a positive factor.
    pub fn shown(&mut self, polynomial: &Polynomial) -> NodeId {
        let of_tangent: BTreeMap<Symbol, Symbol> = self.tangents.iter().map(|(a, t)| (*t, *a)).collect();
        let products = self.products.renamed(|variable| match variable {
            Variable::Plain(symbol) => match of_tangent.get(&symbol) {
                Some(angle) => Variable::HalfTangent(*angle),
                None => variable,
            },
            _ => variable,
        });
        let graph = &mut self.system.graph;
        let node = products.node(graph, polynomial);
        // functions of an angle have its half's tangent inside
        let mut tangents = Assignment::new();
        for (tangent, angle) in of_tangent {
            let (angle, half) = (graph.symbol(angle), graph.rational(RBig::ONE / RBig::from(2)));
            let half = graph.mul(angle, half);
            let (sine, cosine) = (graph.apply(Function::Sin, half), graph.apply(Function::Cos, half));
            tangents.insert(tangent, graph.div(sine, cosine));
        }
        graph.substitute(&[node], &tangents)[0]
    }

    /// A polynomial with `bottom x + top = 0` solved for a symbol put in, multiplied by an even power of `bottom`.
    pub fn put_in(&mut self, polynomial: &Polynomial, solved: &Solved) -> Reach<Polynomial> {
        if self.hides(polynomial, solved.place) {
            let node = self.node(polynomial);
            let values = Assignment::from([(solved.symbol, solved.value)]);
            let node = self.system.graph.substitute(&[node], &values)[0];
            let ratio = self.read(node)?;
            // an odd power below the bar stands above it as well, for the sign
            let odd = ratio.bottom.into_iter().filter(|(_, n)| n % 2 == 1).map(|(factor, _)| (factor, 1));
            let top: Vec<_> = ratio.top.into_iter().chain(odd).collect();
            return expanded(&top).ok_or_else(|| TOO_LONG.to_owned());
        }
        let parts = polynomial.coefficients_in(solved.place);
        let Some(degree) = parts.keys().next_back().copied().filter(|degree| *degree > 0) else {
            return Ok(polynomial.clone());
        };
        let degree = degree + degree % 2;
        let minus = solved.top.neg();
        let mut sum = Polynomial::default();
        for (power, part) in parts {
            let product = raised(&minus, power)
                .and_then(|value| value.mul(&raised(&solved.bottom, degree - power)?))
                .and_then(|value| value.mul(&part));
            sum = sum.add(&product.ok_or(TOO_LONG)?);
            if sum.len() > MOST_TERMS {
                return Err(TOO_LONG.to_owned());
            }
        }
        Ok(sum)
    }
}

/// The angles of a file, and symbols that are met inside sines and cosines alone.
fn angles_of(system: &mut System, mentioned: &[NodeId]) -> BTreeSet<Symbol> {
    let mut angles: BTreeSet<Symbol> = system.angles().into_iter().collect();
    angles.extend(inside_sines(&system.graph, mentioned));
    loop {
        let is_angle = |symbol: Symbol| angles.contains(&symbol);
        let expanded = expand_angles(&mut system.graph, mentioned, is_angle);
        match Program::with_unknown_functions(&system.graph, &expanded, is_angle).bare_angle() {
            Some(number) if angles.remove(&number) => {}
            _ => break,
        }
    }
    angles
}

/// Does something while the symbols that are met inside sines and cosines alone are angles.
pub(super) fn with_angles<T>(
    system: &mut System,
    mentioned: &[NodeId],
    work: impl FnOnce(&mut System) -> T,
) -> T {
    let angles = angles_of(system, mentioned);
    let mut turned = Vec::new();
    for (symbol, info) in &mut system.symbols {
        if !info.is_angle && angles.contains(symbol) {
            info.is_angle = true;
            turned.push(*symbol);
        }
    }
    let found = work(system);
    for symbol in turned {
        if let Some(info) = system.symbols.get_mut(&symbol) {
            info.is_angle = false;
        }
    }
    found
}

/// A symbol that was solved for: `bottom x + top = 0`.
pub(super) struct Solved {
    pub symbol: Symbol,
    pub place: usize,
    pub top: Polynomial,
    pub bottom: Polynomial,
    pub value: NodeId,
}

pub(super) const TOO_LONG: &str = "the remainder becomes too long";
/// Each angle doubles the number of charts.
const MOST_ANGLES: usize = 4;

/// A product of powers, multiplied out.
pub(super) fn expanded(factors: &[(Polynomial, u32)]) -> Option<Polynomial> {
    let mut product = Polynomial::integer(&IBig::ONE);
    for (factor, power) in factors {
        for _ in 0..*power {
            product = product.mul(factor)?;
            if product.len() > MOST_TERMS {
                return None;
            }
        }
    }
    Some(product)
}

pub(super) fn raised(base: &Polynomial, power: u8) -> Option<Polynomial> {
    expanded(&[(base.clone(), u32::from(power))])
}

/// A polynomial in the one way in which it is compared: primitive, its leading coefficient positive.
pub(super) fn normal(polynomial: &Polynomial) -> Polynomial {
    primitive(polynomial).unwrap_or_default()
}

/// The symbols that stand inside sines and cosines.
fn inside_sines(graph: &Graph, roots: &[NodeId]) -> Vec<Symbol> {
    let arguments =
        graph.reachable(roots.iter().copied()).into_iter().filter_map(|id| match graph.node(id) {
            Node::Apply(Function::Sin | Function::Cos, argument) => Some(argument),
            _ => None,
        });
    graph.symbols_of(arguments.collect::<Vec<_>>())
}

/// Sines and cosines of angles, which stand alone by now, by the tangents of their halves.
fn with_tangents(
    graph: &mut Graph,
    roots: &[NodeId],
    tangents: &BTreeMap<Symbol, Symbol>,
    chart: &Chart,
) -> Vec<NodeId> {
    let mut image: HashMap<NodeId, NodeId> = HashMap::new();
    for id in graph.reachable(roots.iter().copied()) {
        let node = graph.node(id);
        let angle = match node {
            Node::Apply(function @ (Function::Sin | Function::Cos), argument) => {
                graph.as_symbol(argument).and_then(|angle| Some((function, angle, *tangents.get(&angle)?)))
            }
            _ => None,
        };
        let new = match angle {
            Some((function, angle, _)) if chart.contains(&angle) => {
                graph.integer(if function == Function::Sin { 0 } else { -1 })
            }
            Some((function, _, tangent)) => {
                let t = graph.symbol(tangent);
                let (one, square) = (graph.integer(1), graph.power(t, 2));
                let bottom = graph.add(one, square);
                let top = match function {
                    Function::Sin => graph.add(t, t),
                    _ => graph.sub(one, square),
                };
                graph.div(top, bottom)
            }
            None => graph.rebuild(node, |operand| image[&operand]),
        };
        image.insert(id, new);
    }
    roots.iter().map(|root| image[root]).collect()
}
