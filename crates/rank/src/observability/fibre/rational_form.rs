//! Values of unknowns where rates and outputs are no rational functions: functions become states of their own.
//!
//! `g = exp(u)` moves by `g' = u' g`, `log v` by `v'/v`, sine and cosine of `u` are those of an angle that moves by `u'`, `atan u` moves by
//! `u'/(1 + u^2)`; a state `z` under a root is what `r = sqrt(z)` says, `z = r^2`. Written so, all is rational, and the states and
//! constants that give the same outputs are met by the fibre of this larger system with free initial conditions of the functions. What
//! has one value there has one value: the other way nothing follows, since a point of the fibre whose functions are not those of its
//! arguments is none of the file. A function whose argument has one value there is known at all times, and measured from then on (a root is
//! the positive one); so is the argument of an exponential or a logarithm that has one value, over the reals.
//!
//! What is found holds for almost all initial conditions of the larger system. That it holds for almost all of the file is so if the
//! functions satisfy no algebraic equation with the coordinates: by Ax's theorem (J. Ax, *On Schanuel's conjectures*, Ann. of Math.
//! 93, 1971) if no sum of rational multiples of the exponents and logarithms is constant, and none of the angles and arcs. It suffices
//! that no combination of their differentials with constant coefficients vanishes, and that is seen at random points modulo a prime.
//! There a function may have any value: those that come before satisfy no equation, so that a relation is one for all their values.
//!
//! An output that is an angle itself determines its sine and cosine; these are measured in its place.

use super::model::Model;
use super::{Solutions, SolutionsAnswer, SolutionsOf, SolutionsQuestion, solutions};
use crate::observability::driven::told_constants;
use crate::observability::elimination;
use crate::observability::generic::sum_of_errors;
use palmistry_lang::{Assignment, Kind, SymbolInfo, System, Time};
use palmistry_math::expression::{
    Derivation, Graph, Node, NodeId, Program, Symbol, draw_residues, expand_angles,
};
use palmistry_math::number::{Function, PrimeField};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, HashMap, HashSet};

/// No more functions become states.
const MOST: usize = 24;
/// Points at which differentials are compared, beside one for each function.
const FURTHER_POINTS: usize = 3;
/// A point is drawn so often.
const ATTEMPTS: usize = 8;
/// Names that no file can give.
const NAME: &str = "\u{1}function";

/// A function that is a state of its own.
struct Lifted {
    function: Function,
    /// Over the coordinates of the larger system.
    argument: NodeId,
    /// What is known where it is known: itself, or cosine and sine of its angle.
    values: Vec<NodeId>,
    is_measured: bool,
}

/// A system without functions, and what the file speaks of.
struct RationalForm {
    system: System,
    lifted: Vec<Lifted>,
    /// The unknowns of the file, then the expressions that are asked for.
    asked: Vec<NodeId>,
    /// The functions of the file in words.
    text: String,
}

/// How a system is rewritten.
struct Rewriting {
    graph: Graph,
    angles: HashSet<Symbol>,
    /// The components of the fields that move the states, field by field.
    rates: Vec<BTreeMap<Symbol, NodeId>>,
    outputs: Vec<NodeId>,
    asked: Vec<NodeId>,
    /// The roots.
    roots: Vec<Lifted>,
    /// The functions that satisfy no equation, one for each that is new.
    lifted: Vec<Lifted>,
    /// The states that take the place of others, by these.
    in_place: HashMap<Symbol, Symbol>,
    /// The functions that are states.
    new: Vec<Symbol>,
    /// How many names were given.
    names: usize,
    /// The functions, as they are written.
    texts: Vec<String>,
}

/// Counts values in the larger system, and fills in what follows.
///
/// # Errors
/// In words, where this is more than that there are functions: it is not shown that they satisfy no equation.
pub(super) fn count_in_rational_form(
    system: &System,
    question: &SolutionsQuestion,
    answer: &mut SolutionsAnswer,
) -> Result<(), Option<String>> {
    let expressions: Vec<NodeId> = question.expressions.iter().map(|(_, node)| *node).collect();
    let mut form = RationalForm::new(system, &question.conditions, &expressions)?;
    // what rests on functions that are known rests on why they are
    let mut known_error = Some(f64::NEG_INFINITY);
    let found = loop {
        let of_functions = form.lifted.iter().map(|lifted| &lifted.argument);
        let nodes = of_functions.chain(form.lifted.iter().flat_map(|lifted| &lifted.values));
        let nodes = nodes.chain(form.asked.iter().filter(|node| form.place(**node).is_none()));
        let nodes: Vec<NodeId> = nodes.copied().collect();
        // what is not rational even so, an angle outside of its functions, would be rewritten for ever
        if Model::new(&form.system, &Assignment::new(), &nodes).is_err() {
            return Err(None);
        }
        let expressions = nodes.into_iter().map(|node| (String::new(), node)).collect();
        let inner = SolutionsQuestion {
            conditions: Assignment::new(),
            expressions,
            work: question.work.saturating_sub(answer.work),
            interrupt: question.interrupt,
        };
        let found = solutions(&mut form.system, &inner).map_err(|_| None)?;
        answer.work += found.work;
        (answer.rounds, answer.orders, answer.points) = (found.rounds, found.orders, None);
        let (unknowns, expressions) = found.unknowns.split_at(form.system.unknown_count());
        let of_functions: usize = form.lifted.iter().map(|lifted| 1 + lifted.values.len()).sum();
        let (of_functions, mut rest) = expressions.split_at(of_functions);
        let new = form.measure_what_is_known(of_functions);
        if new.is_empty() {
            let mut asked = Vec::new();
            for node in &form.asked {
                asked.extend(match form.place(*node) {
                    Some(place) => unknowns.get(place).cloned(),
                    None => rest.split_off_first().cloned(),
                });
            }
            break asked;
        }
        for one in new {
            known_error = known_error.zip(one).map(|(all, one)| sum_of_errors(all, one));
        }
    };
    for (of_it, found) in answer.unknowns.iter_mut().zip(found) {
        of_it.at_least = None;
        (of_it.solutions, of_it.at_most) = match found.solutions {
            Solutions::Finite(1) => {
                let error =
                    found.at_most.zip(known_error).map(|((_, error), known)| sum_of_errors(error, known));
                (Solutions::Finite(1), error.map(|error| (1, error)))
            }
            Solutions::Undecided(why) => (Solutions::Undecided(why), None),
            Solutions::Finite(count) => {
                let why = format!(
                    "with {} of any initial value there are {count} values, and which of them are those of the file is not known",
                    form.text
                );
                (Solutions::Undecided(why), None)
            }
            Solutions::Infinite => {
                let why = format!("with {} of any initial value there are infinitely many values", form.text);
                (Solutions::Undecided(why), None)
            }
        };
    }
    Ok(())
}

impl RationalForm {
    fn new(
        system: &System,
        conditions: &Assignment,
        expressions: &[NodeId],
    ) -> Result<RationalForm, Option<String>> {
        let has_zero_outputs = !system.zero_outputs().is_empty() || system.highest_lie_order().is_some();
        // what is known at the beginning alone cannot be measured from then on
        let is_known_at_first = system.closed_coordinates().iter().any(|state| system.known.contains(state));
        if system.time == Time::Discrete || has_zero_outputs || is_known_at_first {
            return Err(None);
        }
        let mut graph = system.graph.clone();
        let constants = told_constants(system, &graph, conditions);
        // initial conditions that are given are those of the functions too
        if constants.len() < conditions.len() {
            return Err(None);
        }
        let fields = system.moving_fields();
        let angles = system.angles();
        let mut there = |node: NodeId| {
            let node = graph.substitute(&[node], &constants)[0];
            expand_angles(&mut graph, &[node], |symbol| angles.contains(&symbol))[0]
        };
        let rates = fields.iter().map(|field| {
            let components = system.fields[*field].components.iter();
            components.map(|(symbol, node)| (*symbol, there(*node))).collect()
        });
        let rates: Vec<BTreeMap<Symbol, NodeId>> = rates.collect();
        let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| there(*node)).collect();
        let expressions: Vec<NodeId> = expressions.iter().map(|node| there(*node)).collect();
        let mut rewriting = Rewriting {
            angles,
            rates,
            outputs: Vec::new(),
            asked: Vec::new(),
            roots: Vec::new(),
            lifted: Vec::new(),
            in_place: HashMap::new(),
            new: Vec::new(),
            names: 0,
            texts: Vec::new(),
            graph,
        };
        for output in outputs {
            match rewriting.graph.as_symbol(output).filter(|symbol| rewriting.angles.contains(symbol)) {
                Some(_) => {
                    let sides = [Function::Cos, Function::Sin];
                    let sides = sides.map(|function| rewriting.graph.apply(function, output));
                    rewriting.outputs.extend(sides);
                }
                None => rewriting.outputs.push(output),
            }
        }
        for symbol in system.unknowns() {
            let node = rewriting.graph.symbol(symbol);
            rewriting.asked.push(node);
        }
        rewriting.asked.extend(expressions);
        rewriting.roots_become_states(system).ok_or(None)?;
        rewriting.functions_become_states().ok_or(None)?;
        if !rewriting.is_dense() {
            let text = rewriting.texts.join(", ");
            return Err(Some(format!("it is not shown that no algebraic equation relates {text}")));
        }
        Ok(rewriting.into_form(system))
    }

    /// The place of an expression among the unknowns, where it is one of them.
    fn place(&self, node: NodeId) -> Option<usize> {
        let symbol = self.system.graph.as_symbol(node)?;
        self.system.unknowns().iter().position(|unknown| *unknown == symbol)
    }

    /// Measures functions whose arguments have one value, and arguments of those that have; for each that is new the logarithm of the probability
    /// that it has more values, or nothing where that was computed only.
    fn measure_what_is_known(&mut self, found: &[SolutionsOf]) -> Vec<Option<f64>> {
        let has_one = |of_it: &SolutionsOf| of_it.solutions == Solutions::Finite(1);
        let error = |of_it: &SolutionsOf| of_it.at_most.map(|(_, error)| error);
        let (arguments, mut values) = found.split_at(self.lifted.len());
        let mut new = Vec::new();
        let mut measured = Vec::new();
        for (lifted, argument) in self.lifted.iter_mut().zip(arguments) {
            let (own, rest) = values.split_at(lifted.values.len());
            values = rest;
            if lifted.is_measured {
                continue;
            }
            let is_injective = matches!(lifted.function, Function::Exp | Function::Log | Function::Atan);
            if has_one(argument) {
                measured.extend(lifted.values.iter().copied());
                new.push(error(argument));
                lifted.is_measured = true;
            } else if is_injective && own.iter().all(has_one) {
                measured.push(lifted.argument);
                new.extend(own.iter().map(error));
                lifted.is_measured = true;
            }
        }
        for node in measured {
            self.system.outputs.push((String::new(), node));
            self.system.output_guards.push(Vec::new());
        }
        new
    }
}

impl Rewriting {
    /// All expressions, as they stand.
    fn roots(&self) -> Vec<NodeId> {
        let rates = self.rates.iter().flat_map(|field| field.values());
        rates.chain(&self.outputs).chain(&self.asked).copied().collect()
    }

    /// Rewrites all of them.
    fn replace(&mut self, mut image: impl FnMut(&mut Graph, NodeId) -> NodeId) {
        let graph = &mut self.graph;
        let rates = self.rates.iter_mut().flat_map(|field| field.values_mut());
        let of_functions = self.roots.iter_mut().chain(&mut self.lifted);
        let of_functions =
            of_functions.flat_map(|lifted| std::iter::once(&mut lifted.argument).chain(&mut lifted.values));
        for node in rates.chain(&mut self.outputs).chain(&mut self.asked).chain(of_functions) {
            *node = image(graph, *node);
        }
    }

    fn is_zero(&self, node: NodeId) -> bool {
        self.graph.constant_value(node).is_some_and(|value| value.is_zero())
    }

    fn is_of_an_angle(&self, function: Function, argument: NodeId) -> bool {
        matches!(function, Function::Sin | Function::Cos)
            && self.graph.as_symbol(argument).is_some_and(|symbol| self.angles.contains(&symbol))
    }

    /// The functions in some expressions, those in arguments first.
    fn functions(&self, roots: &[NodeId]) -> Vec<(NodeId, Function, NodeId)> {
        let all = self.graph.reachable(roots.iter().copied()).into_iter();
        all.filter_map(|id| match self.graph.node(id) {
            Node::Apply(function, argument) if !self.is_of_an_angle(function, argument) => {
                Some((id, function, argument))
            }
            _ => None,
        })
        .collect()
    }

    fn named(&mut self) -> Symbol {
        self.names += 1;
        self.graph.intern(&format!("{NAME}{}", self.names))
    }

    /// A state in an argument of a root, of degree one there, is given by the root; nothing where there is none.
    fn roots_become_states(&mut self, system: &System) -> Option<()> {
        loop {
            let roots = self.roots();
            let is_root = |(_, function, argument): &(NodeId, Function, NodeId)| {
                *function == Function::Sqrt && self.functions(&[*argument]).is_empty()
            };
            let Some((id, _, argument)) = self.functions(&roots).into_iter().find(is_root) else {
                return Some(());
            };
            if self.names == MOST {
                return None;
            }
            let candidates: Vec<Symbol> = system
                .states
                .iter()
                .map(|state| *self.in_place.get(state).unwrap_or(state))
                .filter(|state| !self.angles.contains(state) && !system.known.contains(state))
                .collect();
            let held = self.graph.symbols_of([argument]);
            let mut solved = None;
            for state in candidates.into_iter().filter(|state| held.contains(state)) {
                let slope = Derivation::partial(&mut self.graph, state).apply(&mut self.graph, argument);
                if self.graph.symbols_of([slope]).contains(&state) || self.is_zero(slope) {
                    continue;
                }
                let zero = self.graph.integer(0);
                let rest = self.graph.substitute(&[argument], &Assignment::from([(state, zero)]))[0];
                solved = Some((state, slope, rest));
                break;
            }
            let (state, slope, rest) = solved?;
            self.texts.push(self.graph.text(id));
            let new = self.named();
            let root = self.graph.symbol(new);
            let square = self.graph.power(root, 2);
            let difference = self.graph.sub(square, rest);
            let value = self.graph.div(difference, slope);
            for field in 0..self.rates.len() {
                let rates = self.rates[field].clone().into_iter().collect();
                let along = Derivation::new(rates).apply(&mut self.graph, argument);
                let double = self.graph.add(root, root);
                let rate = self.graph.div(along, double);
                self.rates[field].remove(&state);
                if !self.is_zero(rate) {
                    self.rates[field].insert(new, rate);
                }
            }
            let own = system.states.iter().find(|own| self.in_place.get(own).unwrap_or(own) == &state);
            self.in_place.insert(*own.unwrap_or(&state), new);
            let values = vec![root];
            self.roots.push(Lifted {
                function: Function::Sqrt,
                argument: square,
                values,
                is_measured: false,
            });
            self.replace(|graph, node| {
                let mut images: HashMap<NodeId, NodeId> = HashMap::new();
                for at in graph.reachable([node]) {
                    let image = match graph.node(at) {
                        _ if at == id => root,
                        Node::Symbol(symbol) if symbol == state => value,
                        other => graph.rebuild(other, |operand| images[&operand]),
                    };
                    images.insert(at, image);
                }
                images[&node]
            });
        }
    }

    /// All other functions, those in arguments first; nothing where one cannot be a state.
    fn functions_become_states(&mut self) -> Option<()> {
        let mut arguments: HashMap<NodeId, Symbol> = HashMap::new();
        loop {
            let roots = self.roots();
            let Some((id, function, argument)) = self.functions(&roots).into_iter().next() else {
                return Some(());
            };
            if self.names == MOST
                || matches!(function, Function::Sqrt | Function::Asin | Function::Acos)
                || self.graph.symbols_of([argument]).iter().any(|symbol| self.is_bare(argument, *symbol))
            {
                return None;
            }
            let text = self.graph.text(id);
            let is_circular = matches!(function, Function::Sin | Function::Cos);
            let known = arguments.get(&argument).copied().filter(|_| is_circular);
            let symbol = match known {
                Some(symbol) => symbol,
                None => {
                    let symbol = self.named();
                    self.new.push(symbol);
                    let node = self.graph.symbol(symbol);
                    if is_circular {
                        self.angles.insert(symbol);
                        arguments.insert(argument, symbol);
                    }
                    for field in 0..self.rates.len() {
                        let rates = self.rates[field].clone().into_iter().collect();
                        let along = Derivation::new(rates).apply(&mut self.graph, argument);
                        let rate = self.rate(function, node, argument, along);
                        if !self.is_zero(rate) {
                            self.rates[field].insert(symbol, rate);
                        }
                    }
                    let values = match is_circular {
                        true => {
                            [Function::Cos, Function::Sin].map(|side| self.graph.apply(side, node)).to_vec()
                        }
                        false => vec![node],
                    };
                    self.texts.push(text);
                    self.lifted.push(Lifted { function, argument, values, is_measured: false });
                    symbol
                }
            };
            let node = self.graph.symbol(symbol);
            let node = if is_circular { self.graph.apply(function, node) } else { node };
            let in_place = |graph: &mut Graph, root: NodeId| {
                let mut images: HashMap<NodeId, NodeId> = HashMap::new();
                for at in graph.reachable([root]) {
                    let image = match graph.node(at) {
                        _ if at == id => node,
                        other => graph.rebuild(other, |operand| images[&operand]),
                    };
                    images.insert(at, image);
                }
                images[&root]
            };
            self.replace(in_place);
        }
    }

    /// Whether an angle stands in an expression outside of its sine and cosine.
    fn is_bare(&self, root: NodeId, symbol: Symbol) -> bool {
        if !self.angles.contains(&symbol) {
            return false;
        }
        let is_it = |id: NodeId| self.graph.as_symbol(id) == Some(symbol);
        let all = self.graph.reachable([root]);
        is_it(root)
            || all.into_iter().any(|id| match self.graph.node(id) {
                Node::Apply(Function::Sin | Function::Cos, _) => false,
                node => node.operands().any(is_it),
            })
    }

    /// How a function moves whose argument moves so.
    fn rate(&mut self, function: Function, value: NodeId, argument: NodeId, along: NodeId) -> NodeId {
        match function {
            Function::Exp => self.graph.mul(value, along),
            Function::Log => self.graph.div(along, argument),
            Function::Atan => {
                let square = self.graph.power(argument, 2);
                let one = self.graph.integer(1);
                let bottom = self.graph.add(one, square);
                self.graph.div(along, bottom)
            }
            // of sine and cosine the angle moves as the argument
            _ => along,
        }
    }

    /// Whether the functions are shown to satisfy no algebraic equation with the coordinates.
    fn is_dense(&mut self) -> bool {
        let own: HashSet<Symbol> = self.new.iter().copied().collect();
        let roots: Vec<NodeId> =
            self.roots().into_iter().chain(self.lifted.iter().map(|lifted| lifted.argument)).collect();
        let symbols = self.graph.symbols_of(roots);
        let coordinates: Vec<Symbol> = symbols.into_iter().filter(|symbol| !own.contains(symbol)).collect();
        // the differentials of exponents and logarithms, and of angles and arcs: a row each
        let (mut real, mut circular) = (Vec::new(), Vec::new());
        for (place, coordinate) in coordinates.iter().enumerate() {
            if self.angles.contains(coordinate) {
                let entry = |column: usize| self.graph.integer(i64::from(column == place));
                let row: Vec<NodeId> = (0..coordinates.len()).map(entry).collect();
                circular.push(row);
            }
        }
        let mut along: Vec<HashMap<Symbol, NodeId>> = Vec::new();
        for coordinate in &coordinates {
            along.push(HashMap::from([(*coordinate, self.graph.integer(1))]));
        }
        for (number, symbol) in self.new.clone().into_iter().enumerate() {
            let Lifted { function, argument, .. } = self.lifted[number];
            let node = self.graph.symbol(symbol);
            let mut row = Vec::new();
            for slopes in &mut along {
                let slope = Derivation::new(slopes.clone()).apply(&mut self.graph, argument);
                let own = self.rate(function, node, argument, slope);
                slopes.insert(symbol, own);
                row.push(if function == Function::Exp { slope } else { own });
            }
            let is_real = matches!(function, Function::Exp | Function::Log);
            if is_real { real.push(row) } else { circular.push(row) }
        }
        [real, circular].iter().all(|rows| self.are_independent(rows))
    }

    /// Whether rows of functions are independent over the constants: at several random points modulo a prime, side by side.
    fn are_independent(&self, rows: &[Vec<NodeId>]) -> bool {
        if rows.is_empty() {
            return true;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(0x6675_6e63_7469_6f6e);
        let field = PrimeField::random(&mut rng);
        let entries: Vec<NodeId> = rows.iter().flatten().copied().collect();
        let program =
            Program::with_unknown_functions(&self.graph, &entries, |symbol| self.angles.contains(&symbol));
        let Ok(loaded) = program.load(field) else { return false };
        let mut all: Vec<Vec<u64>> = vec![Vec::new(); rows.len()];
        for _ in 0..rows.len() + FURTHER_POINTS {
            let drawn = (0..ATTEMPTS).find_map(|_| {
                let inputs = draw_residues(&program, &field, &mut rng);
                loaded.run(&inputs, &mut Vec::new()).ok()
            });
            let Some(values) = drawn else { return false };
            for (row, values) in all.iter_mut().zip(values.chunks(rows[0].len().max(1))) {
                row.extend_from_slice(values);
            }
        }
        elimination::rank(&field, all).is_ok_and(|rank| rank == rows.len())
    }

    fn into_form(self, system: &System) -> RationalForm {
        let mut form = system.clone();
        form.graph = self.graph;
        for state in &mut form.states {
            if let Some(new) = self.in_place.get(state) {
                *state = *new;
            }
        }
        form.states.extend(&self.new);
        for symbol in self.in_place.values().chain(&self.new) {
            let is_angle = self.angles.contains(symbol);
            let info = SymbolInfo { kind: Kind::State, is_angle, default: None, range: None };
            form.symbols.insert(*symbol, info);
        }
        for (field, rates) in system.moving_fields().into_iter().zip(self.rates) {
            let field = &mut form.fields[field];
            field.guards = vec![Vec::new(); rates.len()];
            field.components = rates.into_iter().collect();
            field.derive_anew(&form.graph);
        }
        form.output_guards = vec![Vec::new(); self.outputs.len()];
        form.outputs = self.outputs.into_iter().map(|node| (String::new(), node)).collect();
        let mut texts = self.texts;
        texts.dedup();
        let lifted = self.lifted.into_iter().chain(self.roots).collect();
        RationalForm { system: form, lifted, asked: self.asked, text: texts.join(", ") }
    }
}
