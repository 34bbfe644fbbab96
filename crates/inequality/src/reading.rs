//! A goal and what is given, read as fractions of polynomials in the same variables: symbols, sines and cosines of angles,
//! and the values of functions, with what is known of each.

use super::bounds::{Bound, SymbolBounds};
use super::{Known, Premises};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::expression::{
    Graph, Input, Node, NodeId, Program, Sign, Symbol, expand_angles, sign_given,
};
use palmistry_math::number::polynomial::{LARGEST_ARITY, Polynomial, Ring};
use palmistry_math::number::{Fraction, Fractions, Function};
use std::rc::Rc;

/// Longer polynomials are not looked at.
pub const LONGEST: usize = 400;

/// A goal and what is given as fractions, and what is known of their variables.
pub struct Polynomials {
    pub goal: Fraction,
    pub assumed: Vec<Fraction>,
    pub fractions: Fractions<Polynomial>,
    pub variables: Vec<GoalVariable>,
    /// Sines at most to the first power.
    pub normal: Rc<dyn Fn(Polynomial) -> Polynomial>,
    /// Polynomials that are zero.
    pub vanishing: Vec<Polynomial>,
    /// For each sine its place, and `1 - cos^2`, which it becomes when it is squared.
    pub squares_of_sines: Vec<(usize, Polynomial)>,
    /// Variables that are roots: their places, and numerator and denominator of what they are taken of.
    pub roots: Vec<(usize, Polynomial, Polynomial)>,
    /// Between what principal values lie: polynomials that are not negative, and whether they are positive.
    pub principal_values: Vec<(Polynomial, bool)>,
}

/// A number that is not passed.
pub struct End {
    pub value: RBig,
    /// Whether it is not reached either.
    pub strict: bool,
}

/// A variable: its sign, and a number that it does not pass.
pub struct GoalVariable {
    pub sign: Option<Sign>,
    pub low: Option<End>,
    pub high: Option<End>,
}

/// What is read together with a goal.
pub struct Reading {
    /// How many assumptions were read behind the goal, and how many equations behind them.
    assumed: usize,
    equations: usize,
    /// For goal, assumptions, equations, and what roots are taken of, with sums of angles expanded.
    program: Program,
    /// Roots among the inputs: their places, and those of their squares among the nodes.
    roots: Vec<(usize, usize)>,
}

impl Reading {
    /// `None` where there are too many variables.
    pub fn new(
        graph: &mut Graph,
        goal: NodeId,
        premises: Premises<'_>,
        is_angle: &dyn Fn(Symbol) -> bool,
    ) -> Option<Reading> {
        let mut nodes = vec![goal];
        nodes.extend(premises.assumed.iter().map(|guard| guard.node));
        nodes.extend(premises.equations);
        let mut nodes = expand_angles(graph, &nodes, is_angle);
        let mut squares: Vec<(NodeId, usize)> = Vec::new();
        loop {
            let program = Program::with_unknown_functions(graph, &nodes, is_angle);
            if program.inputs().len() > LARGEST_ARITY {
                return None;
            }
            let root = |input: &Input| match input {
                Input::Opaque(node) => match graph.node(*node) {
                    Node::Apply(Function::Sqrt, argument) => Some((*node, argument)),
                    _ => None,
                },
                _ => None,
            };
            let new = program
                .inputs()
                .iter()
                .filter_map(root)
                .find(|(node, _)| squares.iter().all(|(known, _)| known != node));
            let Some((node, argument)) = new else {
                let place = |node: NodeId| program.inputs().iter().position(|i| *i == Input::Opaque(node));
                let roots = squares.iter().filter_map(|(node, square)| Some((place(*node)?, *square)));
                return Some(Reading {
                    assumed: premises.assumed.len(),
                    equations: premises.equations.len(),
                    roots: roots.collect(),
                    program,
                });
            };
            squares.push((node, nodes.len()));
            nodes.extend(expand_angles(graph, &[argument], is_angle));
        }
    }

    /// What the variables of its polynomials stand for.
    pub fn inputs(&self) -> &[Input] {
        self.program.inputs()
    }

    /// What is read. `None` where polynomials do not suffice.
    pub fn polynomials(&self, graph: &mut Graph, known: Known<'_>) -> Option<Polynomials> {
        let Reading { assumed, equations, .. } = *self;
        let circles = circles(self.program.inputs());
        let squares_of_sines =
            circles.iter().map(|(sine, cosine)| (*sine, square_of_sine(*cosine))).collect::<Vec<_>>();
        let normal: Rc<dyn Fn(Polynomial) -> Polynomial> = Rc::new(move |p| reduced(p, &circles));
        let inner = normal.clone();
        let fractions = Fractions::<Polynomial>::with_normal_form(move |p| inner(p));
        let inputs = self.program.inputs();
        let variables = inputs.iter().map(|input| GoalVariable::new(graph, *input, known)).collect();
        let elements: Vec<_> =
            (0..inputs.len()).map(|i| fractions.element(Polynomial::variable(i))).collect();
        let mut values = self.program.load(&fractions).ok()?.run(&elements, &mut Vec::new()).ok()?;
        // what vanishes: numerators of equations, and squares of roots less what they are taken of
        let (mut vanishing, mut roots): (Vec<Polynomial>, Vec<_>) = (Vec::new(), Vec::new());
        for value in &values[1 + assumed..][..equations] {
            vanishing.extend(fractions.expand(&value.top).ok());
        }
        for (place, square) in &self.roots {
            let root = Polynomial::variable(*place);
            let value = &values[*square];
            if let (Ok(top), Ok(bottom), Some(squared)) =
                (fractions.expand(&value.top), fractions.expand(&value.bottom), root.mul(&root))
            {
                vanishing.extend(squared.mul(&bottom).map(|left| left.add(&top.neg())));
                roots.push((*place, top, bottom));
            }
        }
        vanishing.retain(|p| !p.is_zero() && p.len() <= LONGEST);
        values.truncate(1 + assumed);
        let goal = values.remove(0);
        let principal_values = principal_values(graph, inputs);
        Some(Polynomials {
            goal,
            assumed: values,
            fractions,
            variables,
            normal,
            vanishing,
            squares_of_sines,
            roots,
            principal_values,
        })
    }
}

impl GoalVariable {
    fn new(graph: &mut Graph, input: Input, known: Known<'_>) -> GoalVariable {
        let Known { bounds, signs } = known;
        let free = GoalVariable { sign: None, low: None, high: None };
        match input {
            Input::Plain(symbol) => {
                let node = graph.symbol(symbol);
                let Some(SymbolBounds { low, high }) = bounds.get(&symbol) else {
                    return GoalVariable { sign: signs.get(&node).copied(), ..free };
                };
                let end = |bound: &Option<Bound>| {
                    bound
                        .as_ref()
                        .and_then(|bound| Some(End { value: bound.exact.clone()?, strict: bound.strict }))
                };
                GoalVariable { sign: signs.get(&node).copied(), low: end(low), high: end(high) }
            }
            Input::Opaque(node) => {
                let (low, high) = constant_bounds(graph.node(node));
                GoalVariable { sign: sign_given(graph, node, signs), low, high }
            }
            Input::Sine(_) | Input::Cosine(_) => free,
        }
    }
}

/// Rational numbers that pi and principal values do not reach.
fn constant_bounds(node: Node) -> (Option<End>, Option<End>) {
    // 333/106 < pi < 355/113
    let (below_pi, above_pi) = (RBig::from(333) / RBig::from(106), RBig::from(355) / RBig::from(113));
    let quarter = &above_pi / RBig::from(2);
    let strictly = |value: RBig| Some(End { value, strict: true });
    match node {
        Node::Pi => (strictly(below_pi), strictly(above_pi)),
        Node::Apply(Function::Asin | Function::Atan, _) => (strictly(-quarter.clone()), strictly(quarter)),
        Node::Apply(Function::Acos, _) => {
            (Some(End { value: RBig::ZERO, strict: false }), strictly(above_pi))
        }
        _ => (None, None),
    }
}

/// Places of the sine and the cosine of each angle that has a sine.
fn circles(inputs: &[Input]) -> Vec<(usize, usize)> {
    let place = |wanted: Input| inputs.iter().position(|input| *input == wanted);
    let of = |(i, input): (usize, &Input)| match input {
        Input::Sine(symbol) => Some((i, place(Input::Cosine(*symbol))?)),
        _ => None,
    };
    inputs.iter().enumerate().filter_map(of).collect()
}

/// Between what principal values lie, where pi is met too: `pi - 2 atan(u) > 0`.
fn principal_values(graph: &Graph, inputs: &[Input]) -> Vec<(Polynomial, bool)> {
    let node = |input: &Input| match input {
        Input::Opaque(node) => Some(graph.node(*node)),
        _ => None,
    };
    let mut found = Vec::new();
    let Some(pi) = inputs.iter().position(|input| node(input) == Some(Node::Pi)) else { return found };
    let pi = Polynomial::variable(pi);
    for (place, input) in inputs.iter().enumerate() {
        let value = Polynomial::variable(place);
        let twice = value.add(&value);
        match node(input) {
            Some(Node::Apply(function @ (Function::Asin | Function::Atan), _)) => {
                let strict = function == Function::Atan;
                found.extend([(pi.add(&twice), strict), (pi.add(&twice.neg()), strict)]);
            }
            Some(Node::Apply(Function::Acos, _)) => found.push((pi.add(&value.neg()), false)),
            _ => {}
        }
    }
    found
}

/// With each sine at most to the first power.
fn reduced(polynomial: Polynomial, circles: &[(usize, usize)]) -> Polynomial {
    circles
        .iter()
        .fold(polynomial, |p, (sine, cosine)| p.reduce_square(*sine, &square_of_sine(*cosine)).unwrap_or(p))
}

/// `1 - cos^2`
fn square_of_sine(cosine: usize) -> Polynomial {
    let c = Polynomial::variable(cosine);
    Polynomial::integer(&IBig::ONE).add(&c.mul(&c).unwrap_or_default().neg())
}
