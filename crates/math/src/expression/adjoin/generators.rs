//! The generators: numbers and values of functions, and what is known of each.

use super::form::{Form, Generator, Monomial};
use super::{Adjunction, Halt};
use crate::expression::{Node, NodeId, Symbol};
use crate::number::{Function, Turn};
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::collections::HashMap;

/// What a generator is. All of them are real.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// A number of the statement, free.
    Symbol(Symbol),
    Pi,
    /// `2 cos(2 pi/N)`, with the `N` of this pass.
    Turn,
    /// `exp(m/D) > 0`, with the `D` of this monomial; free.
    Exp(Monomial),
    /// Sine and cosine of `m/D`: a free point of the circle.
    Sine(Monomial),
    Cosine(Monomial),
    /// The square root of what is not negative.
    Root(Form),
    /// The absolute value of what may have any sign.
    Abs(Form),
    /// The logarithm of the absolute value; free.
    Log(Form),
    /// The positive root of this degree of the absolute value; taken as free.
    Power(Form, u32),
    /// The value of an inverse function; free.
    Value(Function, Form),
    /// Any other value of a function; free.
    Opaque(Function, NodeId),
    /// One over a sum. In forms only.
    Inverse(Form),
    /// The `P >= 0` of which a free generator is plus or minus the `D`-th power.
    Part(Generator),
}

/// Which multiples of a monomial are met in exponents, or in sines: those of a fraction of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Measure {
    Exponent,
    Angle,
}

/// The table of generators.
#[derive(Clone, Debug)]
pub(super) struct Generators {
    pub keys: Vec<Key>,
    /// How deep each generator is nested: one more than those that it is made of.
    depths: Vec<usize>,
    places: HashMap<Key, Generator>,
    nodes: Vec<NodeId>,
    of_symbol: HashMap<Symbol, Generator>,
    /// The circles' symbols.
    pub circles: HashMap<Symbol, Generator>,
    /// The `D` of monomials.
    pub divisors: HashMap<(Measure, Monomial), u32>,
    /// The `D` of free generators that are plus (`true`) or minus a power.
    pub parts: HashMap<Generator, (u32, bool)>,
    pub turn: Turn,
}

/// Functions of functions, and fractions in denominators, are followed no deeper.
pub(super) const DEEPEST: usize = 24;
/// No further than into so many parts a monomial or a generator is divided.
const MOST_PARTS: u64 = 48;

impl Generators {
    pub fn new(turn: Turn) -> Self {
        Generators {
            keys: Vec::new(),
            depths: Vec::new(),
            places: HashMap::new(),
            nodes: Vec::new(),
            of_symbol: HashMap::new(),
            circles: HashMap::new(),
            divisors: HashMap::new(),
            parts: HashMap::new(),
            turn,
        }
    }

    pub fn key(&self, variable: Generator) -> &Key {
        &self.keys[variable as usize]
    }

    /// The symbol of a generator, or its sine or cosine, as an expression.
    pub fn node_at(&self, variable: Generator) -> NodeId {
        self.nodes[variable as usize]
    }

    /// How deep the deepest generator of a form is nested.
    pub fn depth(&self, form: &Form) -> usize {
        form.0.keys().map(|monomial| self.depth_of_monomial(monomial)).max().unwrap_or(0)
    }

    fn depth_of_monomial(&self, monomial: &Monomial) -> usize {
        monomial.iter().map(|(variable, _)| self.depths[*variable as usize]).max().unwrap_or(0)
    }

    fn depth_of_key(&self, key: &Key) -> usize {
        match key {
            Key::Symbol(_) | Key::Pi | Key::Turn | Key::Opaque(..) => 0,
            Key::Exp(monomial) | Key::Sine(monomial) | Key::Cosine(monomial) => {
                1 + self.depth_of_monomial(monomial)
            }
            Key::Root(form)
            | Key::Abs(form)
            | Key::Log(form)
            | Key::Power(form, _)
            | Key::Value(_, form)
            | Key::Inverse(form) => 1 + self.depth(form),
            Key::Part(whole) => self.depths[*whole as usize],
        }
    }

    /// The generator of a plain symbol of the rewritten expressions.
    pub fn of_symbol(&self, symbol: Symbol) -> Option<Generator> {
        self.of_symbol.get(&symbol).copied()
    }
}

impl Adjunction<'_> {
    /// The generator that is this, new or known.
    pub(super) fn variable(&mut self, key: Key) -> Generator {
        // the sine and the cosine of an angle come together
        let key = match key {
            Key::Cosine(monomial) => return self.variable(Key::Sine(monomial)) + 1,
            key => key,
        };
        if let Some(known) = self.generators.places.get(&key) {
            return *known;
        }
        let place = self.generators.keys.len() as Generator;
        // no name of a file begins like this
        let symbol = match &key {
            Key::Symbol(symbol) => *symbol,
            _ => self.graph.intern(&format!("#{place}")),
        };
        let node = self.graph.symbol(symbol);
        let depth = self.generators.depth_of_key(&key);
        self.generators.depths.push(depth);
        if let Key::Sine(monomial) = &key {
            self.generators.depths.push(depth);
            let cosine = Key::Cosine(monomial.clone());
            let nodes = [Function::Sin, Function::Cos].map(|function| self.graph.apply(function, node));
            self.generators.nodes.extend(nodes);
            self.generators.circles.insert(symbol, place);
            self.generators.places.insert(key.clone(), place);
            self.generators.keys.extend([key, cosine]);
            return place;
        }
        self.generators.nodes.push(node);
        self.generators.of_symbol.insert(symbol, place);
        self.generators.places.insert(key.clone(), place);
        self.generators.keys.push(key);
        place
    }

    /// A generator as an expression.
    pub(super) fn node_of(&mut self, variable: Generator) -> NodeId {
        if let Key::Inverse(form) = self.generators.key(variable).clone() {
            let node = self.node_of_form(&form);
            return self.graph.power(node, -1);
        }
        let Some((parts, upward)) = self.generators.parts.get(&variable).copied() else {
            return self.generators.nodes[variable as usize];
        };
        let part = self.variable(Key::Part(variable));
        let node = self.generators.nodes[part as usize];
        let node = self.graph.power(node, parts as i32);
        if upward { node } else { self.graph.neg(node) }
    }

    /// A generator by its key, as an expression.
    pub(super) fn node_of_key(&mut self, key: Key) -> NodeId {
        let variable = self.variable(key);
        self.node_of(variable)
    }

    pub(super) fn node_of_monomial(&mut self, monomial: &Monomial) -> NodeId {
        let mut product = self.graph.integer(1);
        for (variable, power) in monomial {
            let base = self.node_of(*variable);
            let power = self.graph.power(base, *power);
            product = self.graph.mul(product, power);
        }
        product
    }

    pub(super) fn node_of_form(&mut self, form: &Form) -> NodeId {
        let mut sum = self.graph.integer(0);
        for (monomial, factor) in &form.0 {
            let product = self.node_of_monomial(monomial);
            let factor = self.graph.rational(factor.clone());
            let term = self.graph.mul(factor, product);
            sum = self.graph.add(sum, term);
        }
        sum
    }

    /// A polynomial in twice the cosine of a part of the turn.
    pub(super) fn in_turn(&mut self, coefficients: &[i64]) -> NodeId {
        let y = self.node_of_key(Key::Turn);
        let mut sum = self.graph.integer(0);
        for c in coefficients.iter().rev() {
            let shifted = self.graph.mul(sum, y);
            let c = self.graph.integer(*c);
            sum = self.graph.add(shifted, c);
        }
        sum
    }

    /// The factor as a multiple of the monomial's fraction, which is made finer where it has to be.
    pub(super) fn multiple(
        &mut self,
        measure: Measure,
        monomial: &Monomial,
        factor: &RBig,
    ) -> Result<i64, Halt> {
        let key = (measure, monomial.clone());
        let parts = self.generators.divisors.get(&key).copied().unwrap_or(1);
        let count = factor * RBig::from(parts);
        if !count.denominator().is_one() {
            let finer = finer(parts, factor)?;
            self.generators.divisors.insert(key, finer);
            return Err(Halt::Again);
        }
        i64::try_from(IBig::clone(count.numerator()))
            .map_err(|_| Halt::Stop("an exponent is too large".into()))
    }

    /// Divides a free generator that is known not to be negative (or not positive) into parts; the pass begins anew.
    pub(super) fn divide(&mut self, variable: Generator, upward: bool, power: &RBig) -> Halt {
        let whole = match self.generators.key(variable) {
            Key::Part(whole) => *whole,
            _ => variable,
        };
        let (parts, upward) = self.generators.parts.get(&whole).copied().unwrap_or((1, upward));
        // of a part, a power of it is asked for: the parts become finer by its denominator
        let denominator = u64::try_from(power.denominator().clone()).unwrap_or(u64::MAX);
        match u64::from(parts).checked_mul(denominator).filter(|parts| *parts <= MOST_PARTS) {
            Some(parts) => {
                self.generators.parts.insert(whole, (parts as u32, upward));
                Halt::Again
            }
            None => Halt::Stop(format!("a root of degree {} is taken", power.denominator())),
        }
    }

    /// An expression over generators as a form; nothing where it is too long.
    pub(super) fn form(&mut self, root: NodeId) -> Option<Form> {
        let mut stack = vec![(root, false)];
        while let Some((id, ready)) = stack.pop() {
            if self.forms.contains_key(&id) {
                continue;
            }
            if !ready {
                stack.push((id, true));
                if self.generator_at(id).is_none() {
                    stack.extend(self.graph.node(id).operands().map(|operand| (operand, false)));
                }
                continue;
            }
            let form = self.form_of_node(id);
            self.forms.insert(id, form);
        }
        self.forms.get(&root).cloned().flatten()
    }

    fn generator_at(&self, id: NodeId) -> Option<Generator> {
        match self.graph.node(id) {
            Node::Symbol(symbol) => self.generators.of_symbol(symbol),
            Node::Apply(function, argument) => {
                let circle = self.generators.circles.get(&self.graph.as_symbol(argument)?)?;
                Some(if function == Function::Sin { *circle } else { circle + 1 })
            }
            _ => None,
        }
    }

    fn form_of_node(&mut self, id: NodeId) -> Option<Form> {
        if let Some(variable) = self.generator_at(id) {
            return Some(Form::variable(variable));
        }
        let known = |id: NodeId| self.forms.get(&id).cloned().flatten();
        match self.graph.node(id) {
            Node::Constant(_) => {
                let value = self.graph.constant_value(id)?.clone();
                Some(if value.is_zero() { Form::default() } else { Form::constant(value) })
            }
            Node::Add(a, b) => known(a)?.plus(&known(b)?, &RBig::ONE),
            Node::Sub(a, b) => known(a)?.plus(&known(b)?, &RBig::from(-1)),
            Node::Neg(a) => Some(known(a)?.scaled(&RBig::from(-1))),
            Node::Mul(a, b) => {
                let (a, b) = (known(a)?, known(b)?);
                self.times(&a, &b)
            }
            Node::Div(a, b) => {
                let (a, b) = (known(a)?, known(b)?);
                let inverse = self.form_to(&b, -1)?;
                self.times(&a, &inverse)
            }
            Node::Power(a, n) => {
                let a = known(a)?;
                self.form_to(&a, n)
            }
            Node::Symbol(_) | Node::Pi | Node::Apply(..) => None,
        }
    }

    /// The product of two forms, reduced.
    pub(super) fn times(&mut self, a: &Form, b: &Form) -> Option<Form> {
        let product = a.times(b)?;
        self.reduced(product)
    }

    pub(super) fn form_to(&mut self, base: &Form, power: i32) -> Option<Form> {
        if power < 0 {
            let inverse = match base.single() {
                Some((monomial, factor)) => {
                    let inverse = monomial.iter().map(|(variable, power)| (*variable, -power)).collect();
                    self.reduced(Form::term(inverse, RBig::ONE / factor))?
                }
                None if self.generators.depth(base) >= DEEPEST => return None,
                None => {
                    let (content, rest) = base.primitive()?;
                    let inverse = Form::variable(self.variable(Key::Inverse(rest)));
                    inverse.scaled(&(RBig::ONE / content))
                }
            };
            return self.form_to(&inverse, -power);
        }
        if let Some((monomial, factor)) = base.single() {
            let mut raised = Monomial::new();
            for (variable, n) in monomial {
                raised.push((*variable, n.checked_mul(power).filter(|n| n.abs() < 1 << 12)?));
            }
            let factor = (factor.numerator().pow(power as usize), factor.denominator().pow(power as usize));
            return match power {
                0 => Some(Form::constant(RBig::ONE)),
                _ => self.reduced(Form::term(raised, RBig::from_parts(factor.0, factor.1))),
            };
        }
        let mut product = Form::constant(RBig::ONE);
        for _ in 0..power.min(64) {
            product = self.times(&product, base)?;
        }
        (power <= 64).then_some(product)
    }

    /// The form with squares of sines, roots and absolute values written out, and powers of the cosine of a part of the turn.
    fn reduced(&mut self, form: Form) -> Option<Form> {
        let (mut open, mut done) = (form, Form::default());
        for _ in 0..4000 {
            let Some((monomial, factor)) = open.0.pop_first() else { return Some(done) };
            let found = monomial
                .iter()
                .enumerate()
                .find_map(|(place, (variable, power))| Some((place, self.written_out(*variable, *power)?)));
            match found {
                None => done.insert(monomial, factor),
                Some((place, (square, twos, left))) => {
                    let mut rest = monomial;
                    rest[place].1 = left;
                    rest.retain(|(_, power)| *power != 0);
                    let square = self.form_to(&square, twos)?;
                    open = open.plus(&Form::term(rest, factor).times(&square)?, &RBig::ONE)?;
                }
            }
        }
        None
    }

    /// A power of a generator as a power of a form times a lower power of the generator.
    fn written_out(&self, variable: Generator, power: i32) -> Option<(Form, i32, i32)> {
        let halves = (power.div_euclid(2), power.rem_euclid(2));
        let generators = &self.generators;
        match generators.key(variable) {
            Key::Sine(_) if power >= 2 => {
                let mut square = Form::constant(RBig::ONE);
                square.insert(vec![(variable + 1, 2)], RBig::from(-1));
                Some((square, halves.0, halves.1))
            }
            Key::Root(radicand) if halves.0 != 0 => Some((radicand.clone(), halves.0, halves.1)),
            Key::Abs(inner) if halves.0 != 0 => Some((inner.clone(), 2 * halves.0, halves.1)),
            Key::Inverse(inner) if power < 0 => Some((inner.clone(), -power, 0)),
            Key::Turn if power >= generators.turn.minimal.len() as i32 => {
                // the leading power, by the minimal polynomial
                let degree = generators.turn.minimal.len() as i32;
                let mut lower = Form::default();
                for (power, c) in generators.turn.minimal.iter().enumerate() {
                    let monomial = if power == 0 { Vec::new() } else { vec![(variable, power as i32)] };
                    lower.insert(monomial, RBig::from(-c));
                }
                Some((lower, 1, power - degree))
            }
            _ => None,
        }
    }
}

/// The least common multiple of a number of parts and the denominator of a factor.
fn finer(parts: u32, factor: &RBig) -> Result<u32, Halt> {
    let denominator = u64::try_from(factor.denominator().clone()).unwrap_or(u64::MAX);
    let (mut a, mut b) = (u64::from(parts), denominator);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    (u64::from(parts) / a)
        .checked_mul(denominator)
        .filter(|finer| *finer <= MOST_PARTS)
        .map(|finer| finer as u32)
        .ok_or_else(|| Halt::Stop(format!("an argument is divided by {}", factor.denominator())))
}
