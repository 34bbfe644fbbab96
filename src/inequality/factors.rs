//! The sign of an expression by those of its factors: over one denominator, split into polynomials, each of which is
//! assumed to have a sign, has coefficients of one sign in variables whose signs are known, or is a sum of squares.

use super::bounds::{Bounds, Range};
use super::squares::{Bounded, bounded_below};
use crate::expression::{
    Graph, Guard, Input, Need, Node, NodeId, Program, Sign, Symbol, expand_angles, sign_given,
};
use crate::number::polynomial::{LARGEST_ARITY, Polynomial, Ring};
use crate::number::{Factorisation, Factors, Fractions, Function, primitive, split};
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::collections::HashMap;
use std::rc::Rc;

/// Longer polynomials are not looked at.
const LONGEST: usize = 400;
/// Powers of a sine beyond this are not taken out.
const MOST_SINES: u32 = 64;
/// So many assumptions are tried as multipliers.
const MOST_MULTIPLIERS: usize = 3;

/// What is known of the variables of some polynomials, and of polynomials in them.
pub struct Signs {
    fractions: Fractions<Polynomial>,
    variables: Vec<Variable>,
    normal: Rc<dyn Fn(Polynomial) -> Polynomial>,
    /// Polynomials that are zero.
    vanishing: Vec<Polynomial>,
    /// For each sine its place, and `1 - cos^2`, which it becomes when it is squared.
    squares_of_sines: Vec<(usize, Polynomial)>,
    /// Variables that are roots: their places, and numerator and denominator of what they are taken of.
    roots: Vec<(usize, Polynomial, Polynomial)>,
    /// Polynomials that are not negative, and whether they are positive.
    assumed: Vec<(Polynomial, bool)>,
    /// Primitive polynomials that are not zero.
    not_zero: Vec<Polynomial>,
}

/// A number that is not passed, and whether it is not reached either.
type End = (RBig, bool);

/// A variable: its sign, and a number that it does not pass.
struct Variable {
    sign: Option<Sign>,
    low: Option<End>,
    high: Option<End>,
}

/// What is read together with a goal.
struct Reading {
    /// For goal, assumptions, equations, and what roots are taken of, with sums of angles expanded.
    program: Program,
    /// Roots among the inputs: their places, and those of their squares among the nodes.
    roots: Vec<(usize, usize)>,
}

/// Whether factors tell that a goal holds, wherever it exists, what is assumed holds and the equations' left sides vanish.
pub fn tell(
    graph: &mut Graph,
    goal: Guard,
    (assumed, equations): (&[Guard], &[NodeId]),
    is_angle: &dyn Fn(Symbol) -> bool,
    (bounds, known): (&Bounds, &HashMap<NodeId, Sign>),
) -> bool {
    let with_all = Reading::new(graph, goal.node, (assumed, equations), is_angle);
    let (reading, assumed, equations) = match with_all {
        Some(reading) => (reading, assumed, equations),
        // too many variables
        None => match Reading::new(graph, goal.node, (&[], &[]), is_angle) {
            Some(reading) => (reading, &[][..], &[][..]),
            None => return false,
        },
    };
    let Some((signs, top, bottom)) = reading.signs(graph, (assumed, equations), (bounds, known)) else {
        return false;
    };
    if goal.need == Need::NotZero {
        return signs.is_not_zero_product(&top);
    }
    signs.of_fraction(&top, &bottom).is_some_and(|sign| super::tells(goal.need, sign))
}

impl Reading {
    /// `None` where there are too many variables.
    fn new(
        graph: &mut Graph,
        goal: NodeId,
        (assumed, equations): (&[Guard], &[NodeId]),
        is_angle: &dyn Fn(Symbol) -> bool,
    ) -> Option<Reading> {
        let mut nodes = vec![goal];
        nodes.extend(assumed.iter().map(|guard| guard.node));
        nodes.extend(equations);
        let mut nodes = expand_angles(graph, &nodes, is_angle);
        let mut squares: Vec<(NodeId, usize)> = Vec::new();
        loop {
            let program = Program::new(graph, &nodes, is_angle, true);
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
                return Some(Reading { roots: roots.collect(), program });
            };
            squares.push((node, nodes.len()));
            nodes.extend(expand_angles(graph, &[argument], is_angle));
        }
    }

    fn signs(
        &self,
        graph: &mut Graph,
        (assumed, equations): (&[Guard], &[NodeId]),
        (bounds, known): (&Bounds, &HashMap<NodeId, Sign>),
    ) -> Option<(Signs, Factors, Factors)> {
        let circles = circles(self.program.inputs());
        let squares_of_sines =
            circles.iter().map(|(sine, cosine)| (*sine, square_of_sine(*cosine))).collect::<Vec<_>>();
        let normal: Rc<dyn Fn(Polynomial) -> Polynomial> = Rc::new(move |p| reduced(p, &circles));
        let inner = normal.clone();
        let fractions = Fractions::<Polynomial>::with_normal_form(move |p| inner(p));
        let inputs = self.program.inputs();
        let variables = inputs.iter().map(|input| Variable::new(graph, *input, bounds, known)).collect();
        let elements: Vec<_> =
            (0..inputs.len()).map(|i| fractions.element(Polynomial::variable(i))).collect();
        let values = self.program.load(&fractions).ok()?.run(&elements, &mut Vec::new()).ok()?;
        // what vanishes: numerators of equations, and squares of roots less what they are taken of
        let (mut vanishing, mut roots): (Vec<Polynomial>, Vec<_>) = (Vec::new(), Vec::new());
        for value in &values[1 + assumed.len()..][..equations.len()] {
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
        let mut signs = Signs {
            squares_of_sines,
            fractions,
            variables,
            normal,
            vanishing,
            roots,
            assumed: Vec::new(),
            not_zero: Vec::new(),
        };
        signs.assumed = principal_values(graph, inputs);
        // those of fewer factors first: they help to read the others
        let mut order: Vec<usize> = (0..assumed.len()).collect();
        order.sort_by_key(|place| values[place + 1].top.len() + values[place + 1].bottom.len());
        for place in order {
            let value = &values[place + 1];
            signs.assume(&value.top, &value.bottom, assumed[place].need);
        }
        Some((signs, values[0].top.clone(), values[0].bottom.clone()))
    }
}

impl Variable {
    fn new(graph: &mut Graph, input: Input, bounds: &Bounds, known: &HashMap<NodeId, Sign>) -> Variable {
        let free = Variable { sign: None, low: None, high: None };
        match input {
            Input::Plain(symbol) => {
                let node = graph.symbol(symbol);
                let Some(Range { low, high }) = bounds.get(&symbol) else {
                    return Variable { sign: known.get(&node).copied(), ..free };
                };
                let end = |bound: &Option<super::bounds::Bound>| {
                    bound.as_ref().and_then(|bound| Some((bound.exact.clone()?, bound.strict)))
                };
                Variable { sign: known.get(&node).copied(), low: end(low), high: end(high) }
            }
            Input::Opaque(node) => {
                let (low, high) = constant_bounds(graph.node(node));
                Variable { sign: sign_given(graph, node, known), low, high }
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
    let strictly = |value: RBig| Some((value, true));
    match node {
        Node::Pi => (strictly(below_pi), strictly(above_pi)),
        Node::Apply(Function::Asin | Function::Atan, _) => (strictly(-quarter.clone()), strictly(quarter)),
        Node::Apply(Function::Acos, _) => (Some((RBig::ZERO, false)), strictly(above_pi)),
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

impl Signs {
    /// Notes what an assumption about a fraction says of polynomials.
    fn assume(&mut self, top: &Factors, bottom: &Factors, need: Need) {
        let strict = match need {
            Need::Positive | Need::NotZero => true,
            Need::NotNegative => false,
            Need::WithinOne | Need::InsideOne => return,
        };
        // what is different from zero is so in each of its factors
        if strict {
            for place in top.keys() {
                let found = self.split(&self.fractions.factor(*place)).factors;
                self.not_zero.extend(found.into_iter().map(|(factor, _)| factor));
            }
        }
        if need == Need::NotZero {
            return;
        }
        let (mut upward, mut rest) = (true, Some(Polynomial::integer(&IBig::ONE)));
        for (place, power) in top.iter().chain(bottom) {
            let factor = self.fractions.factor(*place);
            if power % 2 == 0 {
                continue;
            }
            match self.of_polynomial(&factor, false) {
                Some(sign) if sign.is_strict() => upward ^= !sign.is_upward(),
                _ => rest = rest.and_then(|rest| rest.mul(&factor)),
            }
        }
        if let Some(rest) = rest.map(|rest| (self.normal)(rest))
            && rest.degree() > 0
            && rest.len() <= LONGEST
        {
            self.assumed.push((if upward { rest } else { rest.neg() }, strict));
        }
    }

    fn of_fraction(&self, top: &Factors, bottom: &Factors) -> Option<Sign> {
        let mut product = Some(Sign::Positive);
        let mut open = Polynomial::integer(&IBig::ONE);
        for (place, power) in top.iter().chain(bottom) {
            let factor = self.fractions.factor(*place);
            if factor.is_zero() {
                return None;
            }
            let sign = self.of_polynomial(&factor, true);
            let even = power % 2 == 0;
            match sign {
                _ if even => {
                    // what is divided by is not zero
                    let strict = bottom.contains_key(place)
                        || sign.is_some_and(Sign::is_strict)
                        || self.is_not_zero(&factor);
                    product = product.map(|product| times(product, Sign::new(true, strict)));
                }
                Some(sign) => {
                    let strict = sign.is_strict() || bottom.contains_key(place);
                    product = product.map(|p| times(p, Sign::new(sign.is_upward(), strict)));
                }
                None => open = open.mul(&factor)?,
            }
        }
        let product = product?;
        if open.degree() == 0 {
            return Some(product);
        }
        // factors without a sign may have one together
        let open = (self.normal)(open);
        (open.len() <= LONGEST)
            .then(|| self.of_one_piece(&open, true))
            .flatten()
            .map(|sign| times(product, sign))
    }

    /// Whether no factor of a product is ever zero.
    fn is_not_zero_product(&self, top: &Factors) -> bool {
        top.keys().all(|place| {
            let factor = self.fractions.factor(*place);
            self.is_not_zero(&factor) || self.of_polynomial(&factor, true).is_some_and(Sign::is_strict)
        })
    }

    /// A product of polynomials, sines first: with `sin^2 = 1 - cos^2` a sine divides what becomes a multiple of that when
    /// it is multiplied by the sine.
    fn split(&self, polynomial: &Polynomial) -> Factorisation {
        let (mut rest, mut sines) = (polynomial.clone(), Vec::new());
        for (sine, square) in &self.squares_of_sines {
            let sine = Polynomial::variable(*sine);
            let mut power = 0;
            while power < MOST_SINES
                && let Some(raised) = rest.mul(&sine).map(|raised| (self.normal)(raised))
                && let Some(quotient) = raised.divide_exactly(square)
            {
                (rest, power) = (quotient, power + 1);
            }
            if power > 0 {
                sines.push((sine, power));
            }
        }
        let known: Vec<Polynomial> = self
            .squares_of_sines
            .iter()
            .map(|(_, square)| square)
            .chain(self.assumed.iter().map(|(known, _)| known))
            .chain(&self.not_zero)
            .cloned()
            .collect();
        let mut found = split(&rest, &known);
        for (sine, power) in sines {
            match found.factors.iter_mut().find(|(factor, _)| *factor == sine) {
                Some((_, known)) => *known += power,
                None => found.factors.push((sine, power)),
            }
        }
        found
    }

    /// The sine of which a polynomial is the square, and whether with its sign.
    fn as_square_of_a_sine(&self, polynomial: &Polynomial) -> Option<(Polynomial, bool)> {
        let of = |(sine, square): &(usize, Polynomial)| {
            let same = polynomial == square;
            (same || *polynomial == square.neg()).then(|| (Polynomial::variable(*sine), same))
        };
        self.squares_of_sines.iter().find_map(of)
    }

    fn is_not_zero(&self, polynomial: &Polynomial) -> bool {
        self.split(polynomial).factors.iter().all(|(factor, _)| {
            let sine = self.as_square_of_a_sine(factor).map(|(sine, _)| sine);
            let primitive = primitive(sine.as_ref().unwrap_or(factor));
            primitive.is_some_and(|p| self.not_zero.contains(&p) || self.not_zero.contains(&p.neg()))
        })
    }

    fn of_polynomial(&self, polynomial: &Polynomial, squares: bool) -> Option<Sign> {
        if polynomial.is_zero() || polynomial.len() > LONGEST {
            return None;
        }
        if let Some(sign) = self.of_one_piece(polynomial, false) {
            return Some(sign);
        }
        let found = self.split(polynomial);
        let mut product = Sign::new(found.unit > IBig::ZERO, true);
        let one = found.factors.len() == 1 && found.factors[0].1 == 1;
        for (factor, power) in &found.factors {
            let sign = match self.of_one_piece(factor, squares && (one || power % 2 == 1)) {
                Some(sign) => sign,
                None if power % 2 == 0 => Sign::NotNegative,
                None => return None,
            };
            let strict = sign.is_strict() || self.is_not_zero(factor);
            product = times(product, Sign::new(sign.is_upward() || power % 2 == 0, strict));
        }
        Some(product)
    }

    fn of_one_piece(&self, polynomial: &Polynomial, squares: bool) -> Option<Sign> {
        let minus = polynomial.neg();
        let scaled = |known: &Polynomial| {
            let (a, b) = (primitive(polynomial)?, primitive(known)?);
            let upward = |p: &Polynomial| p.content() > IBig::ZERO;
            (a == b).then(|| upward(polynomial) == upward(known))
        };
        if let Some((sine, upward)) = self.as_square_of_a_sine(polynomial) {
            return Some(Sign::new(upward, self.is_not_zero(&sine)));
        }
        for (known, strict) in &self.assumed {
            if let Some(upward) = scaled(known) {
                return Some(Sign::new(upward, *strict || self.is_not_zero(polynomial)));
            }
        }
        if let Some(strict) = self.by_coefficients(polynomial) {
            return Some(Sign::new(true, strict));
        }
        if let Some(strict) = self.by_coefficients(&minus) {
            return Some(Sign::new(false, strict));
        }
        if let Some(sign) = self.beside_a_root(polynomial, squares) {
            return Some(sign);
        }
        if !squares {
            return None;
        }
        for (candidate, upward) in [(polynomial, true), (&minus, false)] {
            if self.fails_somewhere(candidate) {
                continue;
            }
            if let Some(bounded) = self.by_squares(candidate) {
                let strict = bounded == Bounded::Positive || self.is_not_zero(polynomial);
                return Some(Sign::new(upward, strict));
            }
        }
        None
    }

    /// The sign of `a + b sqrt(u)`: that of the side whose square is the greater one.
    fn beside_a_root(&self, polynomial: &Polynomial, squares: bool) -> Option<Sign> {
        for (place, top, bottom) in &self.roots {
            let mut parts = polynomial.coefficients_in(*place);
            if parts.keys().max() != Some(&1) || top.degree_in(*place) + bottom.degree_in(*place) > 0 {
                continue;
            }
            let mut take = |power: u8| parts.remove(&power).unwrap_or_default();
            let (a, b) = (take(0), take(1));
            // u = top/bottom is not negative, and so its sign is that of top*bottom
            let Some(slope) = self.of_polynomial(&b, squares) else { continue };
            let Some(below) = self.of_polynomial(bottom, squares).filter(|sign| sign.is_strict()) else {
                continue;
            };
            let square = |p: &Polynomial, factor: &Polynomial| p.mul(p)?.mul(factor);
            let (of_rest, of_root) = (square(&a, bottom)?, square(&b, top)?);
            let more = (self.normal)(of_root.add(&of_rest.neg()));
            let upward = |sign: Sign| sign.is_upward() == below.is_upward();
            // the root's part outweighs the rest
            if let Some(sign) = self.of_polynomial(&more, squares).filter(|sign| upward(*sign)) {
                return Some(Sign::new(slope.is_upward(), sign.is_strict() && slope.is_strict()));
            }
            // the rest outweighs the root's part
            if let Some(rest) = self.of_polynomial(&a, squares)
                && let Some(sign) = self.of_polynomial(&more.neg(), squares).filter(|sign| upward(*sign))
            {
                return Some(Sign::new(rest.is_upward(), sign.is_strict() && rest.is_strict()));
            }
        }
        None
    }

    /// Sums of squares: by itself; with what is assumed; and times something positive that is assumed.
    fn by_squares(&self, polynomial: &Polynomial) -> Option<Bounded> {
        let assumed = self.all_assumed();
        let normal = &*self.normal;
        let mut found = bounded_below(polynomial, &[], &[], normal);
        if found == Some(Bounded::Positive) || assumed.is_empty() && self.vanishing.is_empty() {
            return found;
        }
        found = bounded_below(polynomial, &assumed, &self.vanishing, normal).or(found);
        for (factor, _) in assumed.iter().filter(|(_, strict)| *strict).take(MOST_MULTIPLIERS) {
            if found.is_some() {
                break;
            }
            let product = polynomial.mul(factor).map(normal);
            found = product.and_then(|p| bounded_below(&p, &assumed, &self.vanishing, normal));
        }
        found
    }

    /// Whether a polynomial without assumptions is certainly negative somewhere, so that no sum of squares is looked for:
    /// an odd power of highest degree, or a negative value at the origin.
    fn fails_somewhere(&self, polynomial: &Polynomial) -> bool {
        self.all_assumed().is_empty()
            && self.vanishing.is_empty()
            && polynomial.degree() % 2 == 1
            && polynomial.terms().all(|(e, _)| {
                // with relations between sines and cosines the degree says nothing
                let as_term = Polynomial::term(*e, IBig::ONE);
                let square = as_term.mul(&as_term);
                square.is_some_and(|square| (self.normal)(square.clone()) == square)
            })
    }

    /// What is assumed, the ends of variables included.
    fn all_assumed(&self) -> Vec<(Polynomial, bool)> {
        let mut all = self.assumed.clone();
        for (place, variable) in self.variables.iter().enumerate() {
            let x = Polynomial::variable(place);
            let mut note = |polynomial: Polynomial, strict: bool| {
                if !all.iter().any(|(known, _)| *known == polynomial) {
                    all.push((polynomial, strict));
                }
            };
            if let Some((low, strict)) = &variable.low {
                note(line(&x, low, true), *strict);
            }
            if let Some((high, strict)) = &variable.high {
                note(line(&x, high, false), *strict);
            }
            if variable.low.is_none()
                && variable.high.is_none()
                && let Some(sign) = variable.sign
            {
                note(if sign.is_upward() { x } else { x.neg() }, sign.is_strict());
            }
        }
        all
    }

    /// Whether each monomial is not negative for the signs of its variables, counted from an end where they have one; if
    /// so, whether the sum is positive.
    fn by_coefficients(&self, polynomial: &Polynomial) -> Option<bool> {
        let mut shifted = polynomial.clone();
        let mut signs: Vec<Option<bool>> = Vec::new();
        for (place, variable) in self.variables.iter().enumerate() {
            let x = Polynomial::variable(place);
            let (moved, strict) = match (variable, variable.sign) {
                (Variable { low: Some((low, strict)), .. }, _) => (Some((x, low, true)), Some(*strict)),
                (Variable { high: Some((high, strict)), .. }, _) => (Some((x, high, false)), Some(*strict)),
                (_, Some(sign)) if sign.is_upward() => (None, Some(sign.is_strict())),
                (_, Some(sign)) => (Some((x, &RBig::ZERO, false)), Some(sign.is_strict())),
                _ => (None, None),
            };
            if let Some((x, end, upward)) = moved
                && polynomial.degree_in(place) > 0
            {
                shifted = replace(&shifted, place, &x, end, upward)?;
            }
            signs.push(strict);
        }
        let mut strict = false;
        for (exponents, coefficient) in shifted.terms() {
            if *coefficient < IBig::ZERO {
                return None;
            }
            let mut positive = true;
            for (place, exponent) in exponents.iter().enumerate().filter(|(_, e)| **e > 0) {
                match signs.get(place).copied().flatten() {
                    Some(strict) => positive &= strict,
                    None if exponent % 2 == 0 => positive = false,
                    None => return None,
                }
            }
            strict |= positive;
        }
        Some(strict)
    }
}

/// `x - end` or `end - x`, over a common denominator.
fn line(x: &Polynomial, end: &RBig, upward: bool) -> Polynomial {
    let bottom = Polynomial::integer(&IBig::from(end.denominator().clone()));
    let top = Polynomial::integer(end.numerator());
    let scaled = x.mul(&bottom).unwrap_or_default();
    if upward { scaled.add(&top.neg()) } else { top.add(&scaled.neg()) }
}

/// A positive multiple of a polynomial in which a variable is counted from an end: `x = end + x'`, or `end - x'`.
fn replace(
    polynomial: &Polynomial,
    place: usize,
    x: &Polynomial,
    end: &RBig,
    upward: bool,
) -> Option<Polynomial> {
    let bottom = IBig::from(end.denominator().clone());
    let scaled = x.mul(&Polynomial::integer(&bottom))?;
    let step = Polynomial::integer(end.numerator()).add(&if upward { scaled } else { scaled.neg() });
    let most = polynomial.degree_in(place);
    let mut total = Polynomial::default();
    for (power, coefficient) in polynomial.coefficients_in(place) {
        let mut term = coefficient;
        for _ in 0..power {
            term = term.mul(&step)?;
        }
        for _ in power..most {
            term = term.mul(&Polynomial::integer(&bottom))?;
        }
        total = total.add(&term);
    }
    (total.len() <= LONGEST).then_some(total)
}

fn times(a: Sign, b: Sign) -> Sign {
    Sign::new(a.is_upward() == b.is_upward(), a.is_strict() && b.is_strict())
}
