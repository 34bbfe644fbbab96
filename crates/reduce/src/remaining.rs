//! What remains of a system while conditions are put in and things are left out.

use super::flows::{Flow, component, flows, given};
use super::laws::{Law, Movements, laws};
use super::question::{NotReduced, ReduceQuestion};
use dashu::rational::RBig;
use palmistry_lang::{Assignment, System, Time, UnknownKind, nearest};
use palmistry_math::expression::{
    NodeId, Related, Symbol, ZeroTest, expand_angles, identically_zero, zero_by_relations,
};
use palmistry_rank::observability::{parse_condition, solve_conditions};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::{HashMap, HashSet};

/// Why something of the larger system is not in the smaller one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WhyLeftOut {
    /// The conditions give its value: the value.
    Fixed(String),
    /// It is constant and known: a parameter of the smaller system.
    KnownConstant,
    /// It is constant and an output: a parameter of the smaller system.
    MeasuredConstant,
    /// No output depends on it: it is unobservable.
    NoOutputDependsOnIt,
    /// No output depends on it, and its initial condition is known.
    NotNeeded,
    /// Outputs depend on it by small terms alone, which are left out.
    InSmallTermsAlone,
    /// A conservation law gives it by the others: the law, and the name of the constant.
    Conserved {
        /// What is conserved: `S + I + R`.
        law: String,
        /// The new unknown constant.
        total: String,
    },
}

/// A state or an unknown constant that was left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOutState {
    /// Its name.
    pub name: String,
    /// Why it is not there any more.
    pub why: WhyLeftOut,
}

/// An output of the larger system.
#[derive(Clone, Debug)]
pub(crate) struct RemainingOutput {
    pub node: NodeId,
    /// Whether it is an equation: `output 0 = y`.
    pub is_zero: bool,
    /// Whether the smaller system measures it: not so what is known anyway.
    pub is_kept: bool,
}

/// Small terms of one rate, for the claims about it.
#[derive(Clone, Debug)]
pub(crate) struct LeftOutOfRate {
    /// The place of the flow.
    pub flow: usize,
    pub state: Symbol,
    pub bound: String,
    /// What was left out: the larger system's rate less this one.
    pub difference: NodeId,
    /// The ranges of the symbols on which the difference depends.
    pub ranges: Vec<(Symbol, RBig, RBig)>,
}

/// A system on its way to a smaller one.
pub(crate) struct Remaining {
    pub system: System,
    /// States and unknown constants that are left; signals are none of them.
    pub states: Vec<Symbol>,
    /// The fields that are kept.
    pub flows: Vec<Flow>,
    /// For each of them the rates of `states`.
    pub rates: Vec<Vec<NodeId>>,
    pub outputs: Vec<RemainingOutput>,
    /// States that move and are known: outputs that the larger system does not have.
    pub further_outputs: Vec<Symbol>,
    /// What the conditions give.
    pub values: Assignment,
    /// Constants that have become parameters, with their values where these are known.
    pub constants: Vec<(Symbol, Option<RBig>)>,
    /// Parameters of the larger system that are known signals.
    pub signals: Vec<Symbol>,
    pub laws: Vec<Law>,
    /// Rates without their small terms.
    pub approximated: Vec<LeftOutOfRate>,
    pub left_out: Vec<LeftOutState>,
    pub remarks: Vec<String>,
    /// The order in which things are left out is that of the larger system.
    all: Vec<Symbol>,
}

impl Remaining {
    /// All of a system, but for inputs that nothing drives.
    ///
    /// # Errors
    /// A kind of system that is not written anew; an input that there is not.
    pub fn new(system: &System, question: &ReduceQuestion) -> Result<Remaining, NotReduced> {
        let kind = |why: String| NotReduced::Kind { why };
        system.require_motion().map_err(kind)?;
        if system.time == Time::Discrete {
            return Err(kind("systems in discrete time are not reduced".to_owned()));
        }
        if system.states.iter().any(|state| system.symbol_name(*state).contains('@')) {
            return Err(kind("systems with several experiments are not reduced".to_owned()));
        }
        if !system.initial_conditions().is_empty() {
            return Err(kind("systems with initial values are not reduced".to_owned()));
        }
        let signals: HashSet<Symbol> = system.signal_chains().into_iter().flatten().collect();
        let flows = flows(system, question)?;
        let mut system = system.clone();
        for (name, range) in &question.ranges {
            if let Some(info) = system.find_symbol(name).and_then(|symbol| system.symbols.get_mut(&symbol)) {
                info.range = Some(range.clone());
            }
        }
        let states: Vec<Symbol> =
            system.states.iter().copied().filter(|state| !signals.contains(state)).collect();
        let rates = flows
            .iter()
            .map(|flow| states.iter().map(|state| component(&mut system, flow, *state)).collect())
            .collect();
        let signals =
            question.signals.iter().map(|name| given(&system, name)).collect::<Result<Vec<_>, _>>()?;
        let driving = flows.iter().flat_map(|flow| flow.terms.iter().filter_map(|(symbol, _)| *symbol));
        let own_signals: HashSet<Symbol> = system.signal_chains().into_iter().flatten().collect();
        let mut signals: Vec<Symbol> = signals.into_iter().chain(driving).collect();
        signals.sort_unstable();
        signals.dedup();
        signals.retain(|symbol| !own_signals.contains(symbol));
        let zeros = system.zero_outputs();
        let outputs = system
            .outputs
            .iter()
            .map(|(_, node)| RemainingOutput { node: *node, is_zero: zeros.contains(node), is_kept: true })
            .collect();
        Ok(Remaining {
            all: states.clone(),
            states,
            flows,
            rates,
            outputs,
            further_outputs: Vec::new(),
            values: Assignment::new(),
            constants: Vec::new(),
            signals,
            laws: Vec::new(),
            approximated: Vec::new(),
            left_out: Vec::new(),
            remarks: Vec::new(),
            system,
        })
    }

    /// How many unknowns there are, and how many of them move.
    pub fn counts(&self) -> (usize, usize) {
        let unknown =
            || (0..self.states.len()).filter(|place| !self.system.known.contains(&self.states[*place]));
        (unknown().count(), unknown().filter(|place| !self.is_constant(*place)).count())
    }

    /// The outputs that are measured.
    pub fn output_nodes(&self) -> impl Iterator<Item = NodeId> {
        self.outputs.iter().filter(|output| output.is_kept).map(|output| output.node)
    }

    /// The conditions as they were solved, with what the conservation laws give.
    pub fn conditions(&self) -> Vec<String> {
        let mut solved: Vec<(&str, String)> = self
            .values
            .iter()
            .map(|(symbol, value)| (self.system.symbol_name(*symbol), self.system.graph.text(*value)))
            .collect();
        solved.sort_unstable();
        solved.into_iter().map(|(name, value)| format!("{name} = {value}")).collect()
    }

    /// Whether an unknown has the rate zero along every field, as it is written.
    pub fn is_constant(&self, place: usize) -> bool {
        self.rates
            .iter()
            .all(|rates| self.system.graph.constant_value(rates[place]).is_some_and(|rate| rate.is_zero()))
    }

    /// Puts the conditions in, and checks that every field keeps them.
    ///
    /// # Errors
    /// A condition that cannot be solved, that a field does not keep, or under which something is divided by zero.
    pub fn put_in_conditions(&mut self, question: &ReduceQuestion) -> Result<(), NotReduced> {
        if question.conditions.is_empty() {
            return Ok(());
        }
        self.solve(question)?;
        let chains = self.system.signal_chains();
        // a signal that has a value for good has derivatives that are zero
        for chain in &chains {
            let is_number = |symbol: &Symbol| {
                self.values
                    .get(symbol)
                    .is_some_and(|value| self.system.graph.constant_value(*value).is_some())
            };
            if let Some(from) = chain.iter().position(is_number) {
                for derivative in &chain[from + 1..] {
                    let zero = self.system.graph.integer(0);
                    self.values.entry(*derivative).or_insert(zero);
                }
            }
        }
        self.has_values()?;
        self.stays_met(&chains.concat())?;
        let places: Vec<usize> =
            (0..self.states.len()).filter(|place| self.values.contains_key(&self.states[*place])).collect();
        for place in places.into_iter().rev() {
            let value = self.system.graph.text(self.values[&self.states[place]]);
            self.leave_out(place, WhyLeftOut::Fixed(value));
        }
        let values = self.values.clone();
        self.substitute(&values);
        Ok(())
    }

    fn solve(&mut self, question: &ReduceQuestion) -> Result<(), NotReduced> {
        let mut conditions = Vec::new();
        for text in &question.conditions {
            let refused = |why: String| NotReduced::Condition { condition: text.clone(), why };
            conditions.extend(parse_condition(text).map_err(refused)?);
        }
        let all = question.conditions.join(", ");
        let branches = solve_conditions(&mut self.system, &conditions)
            .map_err(|why| NotReduced::Condition { condition: all.clone(), why: why.to_string() })?;
        let [branch] = branches.as_slice() else {
            let ways =
                branches.iter().map(|branch| branch.steps.join(", ")).collect::<Vec<_>>().join("; or ");
            if branches.is_empty() {
                return Err(NotReduced::Condition { condition: all, why: "no state meets it".to_owned() });
            }
            return Err(NotReduced::SeveralWays { ways: branches.len(), list: ways });
        };
        if !branch.up_to_turns.is_empty() || !branch.assumed.is_empty() {
            let why = match branch.assumed.is_empty() {
                true => "it gives an angle up to whole turns; write the angle itself, as in phi = pi/2",
                false => "an inequality leaves nothing out; write equations",
            };
            return Err(NotReduced::Condition { condition: all, why: why.to_owned() });
        }
        self.values.clone_from(&branch.values);
        Ok(())
    }

    /// Checks that rates and outputs have values where the conditions hold.
    fn has_values(&mut self) -> Result<(), NotReduced> {
        let values = self.values.clone();
        for (flow, rates) in self.flows.iter().zip(&self.rates) {
            for (state, rate) in self.states.iter().zip(rates) {
                if self.system.graph.vanishing_divisor(&[*rate], &values).is_some() {
                    let (state, field) = (self.system.symbol_name(*state), &flow.name);
                    return Err(NotReduced::Pole { what: format!("the rate of '{state}' along {field}") });
                }
            }
        }
        for (output, (name, _)) in self.outputs.iter().zip(&self.system.outputs) {
            if self.system.graph.vanishing_divisor(&[output.node], &values).is_some() {
                return Err(NotReduced::Pole { what: format!("the output '{name}'") });
            }
        }
        Ok(())
    }

    /// Checks that every field keeps the conditions. For a signal nothing has to be shown: its value is what the condition says.
    fn stays_met(&mut self, signals: &[Symbol]) -> Result<(), NotReduced> {
        let mut rng = ChaCha8Rng::seed_from_u64(0x006b_6570_7400); // any fixed seed: the claims of the file are proved anew
        let mut solved: Vec<(Symbol, NodeId)> =
            self.values.iter().map(|(symbol, value)| (*symbol, *value)).collect();
        solved.sort_unstable_by_key(|(symbol, _)| *symbol);
        let values = self.values.clone();
        for (symbol, value) in solved.iter().filter(|(symbol, _)| !signals.contains(symbol)) {
            let of_value = self.system.graph.symbols_of([*value]);
            if let Some(signal) = of_value.iter().find(|symbol| self.signals.contains(symbol)) {
                let condition =
                    format!("{} = {}", self.system.symbol_name(*symbol), self.system.graph.text(*value));
                let why = format!("'{}' is a signal, and changes", self.system.symbol_name(*signal));
                return Err(NotReduced::Condition { condition, why });
            }
            for flow in self.flows.clone() {
                let own = component(&mut self.system, &flow, *symbol);
                let mut difference = own;
                for state in self.system.graph.symbols_of([*value]) {
                    // what has no rate of its own, a parameter, does not move
                    let slope = self.system.partial(*value, state);
                    let rate = component(&mut self.system, &flow, state);
                    let term = self.system.graph.mul(slope, rate);
                    difference = self.system.graph.sub(difference, term);
                }
                let there = self.system.graph.substitute(&[difference], &values)[0];
                let is_angle = &self.system.angle_test();
                let expanded = expand_angles(&mut self.system.graph, &[there], is_angle);
                let found = identically_zero(&self.system.graph, &expanded, is_angle, &mut rng);
                let is_shown = match found {
                    ZeroTest::Zero { .. } => true,
                    ZeroTest::Pole(_) => false,
                    // functions may satisfy relations that the plain test does not know
                    ZeroTest::Nonzero(_) | ZeroTest::Unknown(_) => matches!(
                        zero_by_relations(&mut self.system.graph, &expanded, &[], is_angle, &mut rng),
                        Related::Zero { .. }
                    ),
                };
                if !is_shown {
                    let condition =
                        format!("{} = {}", self.system.symbol_name(*symbol), self.system.graph.text(*value));
                    let field = format!("{} {}", flow.role.name(), flow.name);
                    let rate = self.system.graph.text(there);
                    return Err(NotReduced::NotKept { condition, field, rate });
                }
            }
        }
        Ok(())
    }

    /// Takes constants that are known, or measured by themselves, as parameters; a state that moves and is known as an output.
    ///
    /// # Errors
    /// A name that is no unknown.
    pub fn take_constants_as_known(&mut self, question: &ReduceQuestion) -> Result<(), NotReduced> {
        for (name, value) in &question.known {
            if let (Ok(parameter), Some(value)) = (given(&self.system, name), value) {
                // it was known before, and has a value now
                if let Some(info) = self.system.symbols.get_mut(&parameter) {
                    info.default = Some(value.clone());
                }
                continue;
            }
            let symbol = self.system.find_symbol(name).filter(|symbol| self.all.contains(symbol));
            let Some(symbol) = symbol else {
                let names: Vec<&str> = self.all.iter().map(|one| self.system.symbol_name(*one)).collect();
                let near = nearest(name, names.iter().copied()).map(|near| format!(" (perhaps '{near}')"));
                let unknowns = names.join(", ") + &near.unwrap_or_default();
                return Err(NotReduced::NoUnknown { name: name.clone(), unknowns });
            };
            let Some(place) = self.states.iter().position(|state| *state == symbol) else {
                continue; // the conditions give it
            };
            if self.is_constant(place) {
                self.constants.push((symbol, value.clone()));
                self.leave_out(place, WhyLeftOut::KnownConstant);
            } else if !self.is_measured(symbol) {
                self.further_outputs.push(symbol);
                self.remarks.push(format!(
                    "'{name}' is known as an output and stays a state: its rate is not zero as it is written"
                ));
            }
        }
        for place in (0..self.states.len()).rev() {
            let symbol = self.states[place];
            if self.is_constant(place) && self.system.known.contains(&symbol) {
                // its initial condition is known, and so is its value at all times
                self.constants.push((symbol, None));
                self.leave_out(place, WhyLeftOut::KnownConstant);
            } else if self.is_measured(symbol) && self.is_constant(place) {
                self.constants.push((symbol, None));
                self.leave_out(place, WhyLeftOut::MeasuredConstant);
            }
        }
        // an output that depends on nothing unknown is uninformative
        let unknown: HashSet<Symbol> = self.unknown_symbols();
        for output in &mut self.outputs {
            let mut depends = self.system.graph.symbols_of([output.node]).into_iter();
            output.is_kept = output.is_zero || depends.any(|symbol| unknown.contains(&symbol));
        }
        Ok(())
    }

    fn is_measured(&self, symbol: Symbol) -> bool {
        let is_it = |node: NodeId| self.system.graph.as_symbol(node) == Some(symbol);
        let mut outputs = self.outputs.iter().filter(|output| !output.is_zero);
        self.further_outputs.contains(&symbol) || outputs.any(|output| is_it(output.node))
    }

    /// What is not known: states, unknown constants, unknown signals.
    fn unknown_symbols(&self) -> HashSet<Symbol> {
        let signals = self.system.signal_chains().into_iter().flatten();
        // a state whose initial condition is known moves as others do
        let unknown = signals.filter(|symbol| !self.system.known.contains(symbol));
        self.states.iter().copied().chain(unknown).collect()
    }

    /// Leaves out states and constants on which no output depends, by itself or by the rate of something on which it does.
    pub fn leave_out_what_no_output_needs(&mut self) {
        for place in self.not_needed() {
            let is_known = self.system.known.contains(&self.states[place]);
            let why = if is_known { WhyLeftOut::NotNeeded } else { WhyLeftOut::NoOutputDependsOnIt };
            self.leave_out(place, why);
        }
    }

    /// The places of what no output depends on, the last one first.
    pub fn not_needed(&self) -> Vec<usize> {
        let places: HashMap<Symbol, usize> =
            self.states.iter().enumerate().map(|(place, state)| (*state, place)).collect();
        let mut needed: HashSet<Symbol> = self.further_outputs.iter().copied().collect();
        let mut open: Vec<NodeId> = self.output_nodes().collect();
        let rates_of = |symbol: &Symbol| {
            let place = places.get(symbol).copied();
            self.rates.iter().filter_map(move |rates| Some(rates[place?]))
        };
        open.extend(self.further_outputs.iter().flat_map(rates_of));
        // each expression is looked at once, whatever shares it
        let mut seen: HashSet<NodeId> = HashSet::new();
        while let Some(node) = open.pop() {
            if !seen.insert(node) {
                continue;
            }
            open.extend(self.system.graph.node(node).operands());
            if let Some(symbol) = self.system.graph.as_symbol(node)
                && needed.insert(symbol)
            {
                open.extend(rates_of(&symbol));
            }
        }
        (0..self.states.len()).rev().filter(|place| !needed.contains(&self.states[*place])).collect()
    }

    /// Takes the last state of each conservation law that is no output by the others, and the conserved amount as an unknown constant in its place.
    pub fn use_conservation_laws(&mut self) {
        if self.states.iter().any(|state| self.system.known.contains(state)) {
            return; // of an amount whose initial value is partly known something is known
        }
        let (mut places, rest): (Vec<usize>, Vec<usize>) = (0..self.states.len())
            .filter(|place| !self.is_constant(*place))
            .partition(|place| self.is_measured(self.states[*place]));
        places.extend(rest);
        let of = |rates: &Vec<NodeId>| places.iter().map(|place| rates[*place]).collect();
        let rates = self.rates.iter().map(of).collect();
        let states = places.iter().map(|place| self.states[*place]).collect();
        for law in laws(&mut Movements { system: &mut self.system, states, rates }) {
            let mut values = Assignment::new();
            let given = law.given(&mut self.system.graph);
            values.insert(law.state, given);
            let place = self.states.iter().position(|state| *state == law.state);
            if let Some(place) = place {
                let why = WhyLeftOut::Conserved { law: law.text.clone(), total: law.name.clone() };
                self.leave_out(place, why);
                self.substitute(&values);
                let zero = self.system.graph.integer(0);
                self.states.push(law.total);
                self.rates.iter_mut().for_each(|rates| rates.push(zero));
                self.laws.push(law);
            }
        }
    }

    /// Leaves out the state of a place.
    pub fn leave_out(&mut self, place: usize, why: WhyLeftOut) {
        let symbol = self.states.remove(place);
        self.rates.iter_mut().for_each(|rates| {
            rates.remove(place);
        });
        self.left_out.push(LeftOutState { name: self.system.symbol_name(symbol).to_owned(), why });
    }

    /// Puts what was left out into the order of the larger system.
    pub fn put_in_order(&mut self) {
        let places: HashMap<&str, usize> = self
            .all
            .iter()
            .enumerate()
            .map(|(place, symbol)| (self.system.symbol_name(*symbol), place))
            .collect();
        self.left_out.sort_by_key(|one| places.get(one.name.as_str()).copied());
    }

    /// Puts values into all rates and outputs.
    fn substitute(&mut self, values: &Assignment) {
        for rates in &mut self.rates {
            *rates = self.system.graph.substitute(rates, values);
        }
        for output in &mut self.outputs {
            output.node = self.system.graph.substitute(&[output.node], values)[0];
        }
    }

    /// Whether an unknown is a constant by its declaration.
    pub fn is_declared_constant(&self, symbol: Symbol) -> bool {
        self.system.unknown_kind(symbol) == Some(UnknownKind::Parameter)
    }
}
