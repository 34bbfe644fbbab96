//! Whatever a file declares to be unknown or to enter the system becomes an ordinary coordinate with an ordinary rate, so that
//! everything that knows states, fields and outputs knows it.
//!
//! `param k unknown` is a coordinate that stands still. `known u(t)` is the chain `u, u', ...` up to the highest derivative
//! that the file mentions, whose last link an input field moves at the rate one: driven by an arbitrary function it is an
//! arbitrary signal, and nothing is cut off. `unknown w(t)` is such a chain up to the order that is assumed, and its last
//! link stands still. In a second experiment each state, signal, input and output has a copy, `x@2`; constants have none.

use super::codes::Code;
use super::error::Problem;
use super::model::{Assignment, Field, FieldPlace, Kind, Range, Role, SymbolInfo, System, Time, Value};
use super::signals::{DeclaredInitial, DeclaredSignal, Derivatives, Knowledge, NOWHERE};
use super::syntax::Item;
use super::unknowns::{Signal, UnknownKind, next_derivative};
use super::written::Written;
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Name, Relation, Span};
use palmistry_math::expression::{Derivation, Guard, NodeId, Symbol};

/// No more experiments than these are made.
const MOST_EXPERIMENTS: usize = 20;
/// No higher derivatives are taken.
const HIGHEST_DERIVATIVE: usize = 30;
/// Of an unknown signal of which nothing else is said so many derivatives are taken not to vanish.
pub(crate) const DEFAULT_ORDER: usize = 1;

/// No more unknowns are told by outputs that are zero: the derivatives of these are as many.
const MOST_TIED: usize = 20;

/// How many unknowns the entries of a file declare.
fn unknowns_of(items: &[Item], derivatives: &Derivatives) -> usize {
    let of_signal = |signal: &DeclaredSignal| {
        let used = derivatives.highest(&signal.name.text);
        let order = signal.order.as_ref().and_then(|order| whole(order, 0..=HIGHEST_DERIVATIVE));
        order.unwrap_or(used.max(DEFAULT_ORDER)) + 1
    };
    let count = |item: &Item| match item {
        Item::State(list) => list.len(),
        Item::Param(list) => list.iter().filter(|one| one.knowledge == Some(Knowledge::Unknown)).count(),
        Item::Signals { knowledge: Knowledge::Unknown, list } => list.iter().map(of_signal).sum(),
        _ => 0,
    };
    items.iter().map(count).sum()
}

/// The whole number that an expression is, if it lies within bounds.
fn whole(expr: &Expr, bounds: std::ops::RangeInclusive<usize>) -> Option<usize> {
    let ExprKind::Number(number) = &expr.kind else { return None };
    let value = number.is_int().then(|| usize::try_from(number.numerator().clone()).ok()).flatten();
    value.filter(|value| bounds.contains(value))
}

impl System {
    /// Looks through all entries for what has to be known before the first of them is entered.
    pub(super) fn look_ahead(&mut self, items: &[Item]) -> Derivatives {
        let count = items.iter().find_map(|item| match item {
            Item::Experiments { count, .. } => whole(count, 1..=MOST_EXPERIMENTS),
            _ => None,
        });
        self.coordinates.further_experiments = count.unwrap_or(1) - 1;
        let derivatives = Derivatives::of(items);
        if items.iter().any(|item| matches!(item, Item::Zero(_))) {
            // as many derivatives as there are unknowns: a rank has stopped growing by then
            let unknowns = unknowns_of(items, &derivatives) * count.unwrap_or(1);
            self.coordinates.highest_lie_order = Some(unknowns);
        }
        derivatives
    }

    /// `experiments 2`; what it says was looked for before.
    pub(super) fn enter_experiments(&mut self, count: &Expr, span: &Span) -> Result<(), Problem> {
        if whole(count, 1..=MOST_EXPERIMENTS).is_none() {
            let message = format!("the number of experiments is one from 1 to {MOST_EXPERIMENTS}");
            return Err(
                Problem::new(Code::Initial, &count.span, message, "this is none").help("as in experiments 2")
            );
        }
        if self.coordinates.experiments_said {
            let message = "the file says already how many experiments there are";
            return Err(Problem::new(Code::Initial, span, message, "the second time"));
        }
        self.coordinates.experiments_said = true;
        Ok(())
    }

    /// Declares a coordinate, and what it is in the other experiments unless it is the same in all.
    pub(super) fn declare_coordinate(&mut self, name: &Name, kind: UnknownKind) -> Result<Symbol, Problem> {
        if let Some(field) = self.fields.first() {
            let message = format!("the field '{}' above does not know of this state", field.name);
            let problem = Problem::new(Code::TooLate, &name.span, message, "declare states before fields");
            let line = self.place(field.span.start).0;
            return Err(problem.help(format!(
                "declare it above the field '{}', in front of line {line}: move this line up",
                field.name
            )));
        }
        if self.states_are_final {
            let message =
                format!("something above is differentiated by all states, and '{}' is none yet", name.text);
            return Err(Problem::new(Code::TooLate, &name.span, message, "declare states before 'd(...)'"));
        }
        // the derivatives of a signal
        let symbol = match name.text.ends_with('\'') && kind == UnknownKind::Signal {
            true => self.declare_anew(&name.text, Kind::State),
            false => self.declare(name, Kind::State)?,
        };
        self.coordinates.own.push(symbol);
        if kind != UnknownKind::Parameter {
            let info = self.symbols[&symbol].clone();
            let further = 2..self.coordinates.further_experiments + 2;
            let copies: Vec<Symbol> =
                further.map(|experiment| self.graph.intern(&format!("{}@{experiment}", name.text))).collect();
            for copy in &copies {
                self.symbols.insert(*copy, info.clone());
            }
            if !copies.is_empty() {
                self.coordinates.copies.insert(symbol, copies);
            }
        }
        if kind != UnknownKind::State {
            for one in self.everywhere(symbol) {
                self.coordinates.kinds.insert(one, kind);
            }
        }
        if self.coordinates.further_experiments == 0 {
            self.states.push(symbol);
            return Ok(symbol);
        }
        // one experiment after the other
        let own = self.coordinates.own.clone();
        self.states = own.clone();
        for place in 0..self.coordinates.further_experiments {
            let copies = &self.coordinates.copies;
            self.states.extend(own.iter().filter_map(|symbol| copies.get(symbol).map(|all| all[place])));
        }
        Ok(symbol)
    }

    /// A coordinate and what it is in the other experiments.
    pub(super) fn everywhere(&self, symbol: Symbol) -> Vec<Symbol> {
        let copies = self.coordinates.copies.get(&symbol);
        std::iter::once(symbol).chain(copies.into_iter().flatten().copied()).collect()
    }

    /// For each experiment but the first its number, and what coordinates of the first are in it.
    pub(super) fn further_experiments(&mut self) -> Vec<(usize, Assignment)> {
        let copies = &self.coordinates.copies;
        let further = 0..self.coordinates.further_experiments;
        let graph = &mut self.graph;
        let of = |place: usize| {
            let pairs = copies.iter().map(|(symbol, all)| (*symbol, graph.symbol(all[place])));
            (place + 2, pairs.collect())
        };
        further.map(of).collect()
    }

    /// `param k unknown`, perhaps with a value near which it lies.
    pub(super) fn declare_unknown_constant(
        &mut self,
        name: &Name,
        hint: Option<RBig>,
    ) -> Result<(), Problem> {
        let symbol = self.declare_coordinate(name, UnknownKind::Parameter)?;
        if let Some(hint) = hint {
            self.coordinates.hints.insert(symbol, hint);
        }
        Ok(())
    }

    /// `known u(t)` or `unknown w(t)`.
    pub(super) fn declare_signal(
        &mut self,
        knowledge: Knowledge,
        declared: &DeclaredSignal,
        derivatives: &Derivatives,
    ) -> Result<(), Problem> {
        let name = &declared.name;
        self.refuse_taken(name)?;
        let used = match knowledge {
            Knowledge::Known => derivatives.reached(&name.text),
            Knowledge::Unknown => derivatives.highest(&name.text),
        };
        let refuse = |span: &Span, message: String| {
            Problem::new(Code::Signal, span, message, "this signal")
                .help("name the derivative as a state of its own")
        };
        if used > HIGHEST_DERIVATIVE {
            let message = format!(
                "the file mentions derivative {used} of '{}', or comes to it by Lie derivatives",
                name.text
            );
            return Err(refuse(&name.span, format!("{message}; the highest is {HIGHEST_DERIVATIVE}")));
        }
        let order = match &declared.order {
            Some(expr) => {
                let Some(order) = whole(expr, 0..=HIGHEST_DERIVATIVE) else {
                    let message = format!("an order is a whole number from 0 to {HIGHEST_DERIVATIVE}");
                    return Err(Problem::new(Code::Number, &expr.span, message, "this is none")
                        .help("as in unknown w(t) order 2"));
                };
                if order < used {
                    let text = format!("{}{}", name.text, "'".repeat(used));
                    let message = format!("the file mentions {text}, which is zero by this order");
                    return Err(Problem::new(Code::Signal, &expr.span, message, "the order of derivatives")
                        .help(format!("write 'order {used}'")));
                }
                order
            }
            None if knowledge == Knowledge::Unknown => used.max(DEFAULT_ORDER),
            None => used + self.coordinates.highest_lie_order.map_or(0, |longest| longest + 1),
        };
        let mut chain = Vec::new();
        for place in 0..=order {
            let text = format!("{}{}", name.text, "'".repeat(place));
            chain.push(self.declare_coordinate(&Name { text, ..name.clone() }, UnknownKind::Signal)?);
        }
        let is_known = knowledge == Knowledge::Known;
        let experiments = self.coordinates.further_experiments + 1;
        for experiment in 0..experiments {
            let links: Vec<Symbol> = chain.iter().map(|link| self.everywhere(*link)[experiment]).collect();
            if is_known {
                self.known.extend(&links);
            }
            let (has_order, span) = (declared.order.is_some(), name.span.clone());
            self.coordinates.signals.push(Signal { is_known, has_order, chain: links, span });
        }
        Ok(())
    }

    /// `initial x known`, `initial x = 0`.
    pub(super) fn enter_initial(&mut self, declared: &DeclaredInitial) -> Result<(), Problem> {
        let name = &declared.name;
        let Some(symbol) = self.find_symbol(&name.text).filter(|symbol| self.states.contains(symbol)) else {
            return Err(self.unknown(&name.text, &name.span, super::elaborate::Wanted::State));
        };
        if self.coordinates.kinds.get(&symbol) == Some(&UnknownKind::Parameter) {
            let message = format!("'{}' is a constant, and has no initial condition", name.text);
            return Err(Problem::new(Code::Initial, &name.span, message, "declared as unknown")
                .help("write 'param' and 'known'"));
        }
        if self.known.contains(&symbol) {
            let message = format!("it is said already that '{}' is known", name.text);
            return Err(Problem::new(Code::Twice, &name.span, message, "said again").help("leave it out"));
        }
        if self.states_are_final {
            let message =
                format!("something above is differentiated by all that is unknown, '{}' with it", name.text);
            return Err(Problem::new(
                Code::TooLate,
                &name.span,
                message,
                "say what is known before 'd(...)'",
            ));
        }
        let mut number = None;
        if let Some(value) = &declared.value {
            let node = self.scalar(value)?;
            let mentioned = self.graph.symbols_of([node]);
            if let Some(state) = mentioned.iter().find(|symbol| self.states.contains(symbol)) {
                let message = format!("'{}' is not known", self.symbol_name(*state));
                return Err(Problem::new(
                    Code::Initial,
                    &value.span,
                    message,
                    "an initial condition is made of what is known",
                )
                .help("declare no value: an unknown initial condition is that of a state like any other"));
            }
            number = self.graph.constant_value(node).cloned();
        }
        let experiments: Vec<Symbol> = match name.text.contains('@') {
            true => vec![symbol],
            false => self.everywhere(symbol),
        };
        for one in experiments {
            self.known.insert(one);
            self.coordinates.known_at_first.insert(one);
            // where the rank is asked states are drawn
            if let Some(number) = &number
                && let Some(info) = self.symbols.get_mut(&one)
            {
                info.range = Some(Range { low: number.clone(), high: number.clone() });
                self.sampled.insert(one);
            }
            if let Some(value) = &declared.value {
                let left =
                    Expr { kind: ExprKind::Name(self.symbol_name(one).to_owned()), span: name.span.clone() };
                let span = name.span.start..value.span.end;
                let (relation, right) = (Relation::Equal, value.clone());
                self.coordinates.initial.push(Equation { left, relation, right, within: None, span });
            }
        }
        Ok(())
    }

    /// Refuses what nobody has to say of a coordinate: how a constant or a signal moves.
    pub(super) fn refuse_rate(&self, role: Role, symbol: Symbol, span: &Span) -> Result<(), Problem> {
        if role == Role::Other {
            return Ok(());
        }
        let name = self.symbol_name(symbol);
        let (message, help) = match self.coordinates.kinds.get(&symbol) {
            Some(UnknownKind::Parameter) => {
                (format!("'{name}' is a constant, and does not move"), "declare it as a state")
            }
            Some(UnknownKind::Signal) => {
                (format!("'{name}' is a signal, and has no rate"), "declare it as a state")
            }
            _ if !self.coordinates.own.contains(&symbol) => {
                (format!("'{name}' moves as it does in the first experiment"), "leave it out")
            }
            _ => return Ok(()),
        };
        Err(Problem::new(Code::Field, span, message, "given a rate").help(help))
    }

    /// The states that a field has to say something of.
    pub(super) fn moving_states(&self) -> impl Iterator<Item = Symbol> {
        let kinds = &self.coordinates.kinds;
        self.coordinates.own.iter().copied().filter(|state| !kinds.contains_key(state))
    }

    /// The rates of signals that are told by their next derivatives.
    fn chains(&mut self) -> Vec<(Symbol, NodeId)> {
        let links = self.coordinates.signals.iter().flat_map(|signal| signal.chain.windows(2));
        let links: Vec<(Symbol, Symbol)> = links.map(|pair| (pair[0], pair[1])).collect();
        let mut rate = |(link, next): (Symbol, Symbol)| {
            let difference = self.graph.symbol(next);
            let value = match self.time {
                Time::Continuous => difference,
                Time::Discrete => {
                    let before = self.graph.symbol(link);
                    self.graph.add(before, difference)
                }
            };
            (link, value)
        };
        links.into_iter().map(&mut rate).collect()
    }

    /// What a drift moves besides: signals, and the states in the other experiments.
    pub(super) fn complete_drift(&mut self, rates: &mut Vec<(Symbol, NodeId)>, guards: &mut Vec<Vec<Guard>>) {
        for (_, copies) in self.further_experiments() {
            let (more, needs) = self.in_experiment(rates, guards, &copies);
            rates.extend(more);
            guards.extend(needs);
        }
        let chains = self.chains();
        guards.extend(chains.iter().map(|_| Vec::new()));
        rates.extend(chains);
    }

    /// Rates of the first experiment in another one.
    pub(super) fn in_experiment(
        &mut self,
        rates: &[(Symbol, NodeId)],
        guards: &[Vec<Guard>],
        copies: &Assignment,
    ) -> (Vec<(Symbol, NodeId)>, Vec<Vec<Guard>>) {
        let (mut found, mut needs) = (Vec::new(), Vec::new());
        for ((symbol, rate), guards) in rates.iter().zip(guards) {
            let Some(copy) = copies.get(symbol).and_then(|copy| self.graph.as_symbol(*copy)) else {
                continue;
            };
            found.push((copy, self.graph.substitute(&[*rate], copies)[0]));
            needs.push(self.substitute_guards(guards, copies));
        }
        (found, needs)
    }

    /// Adds the fields that drive known signals, and where nothing else moves by itself a drift for signals. Signals that
    /// outputs tie are not driven at will.
    pub(super) fn finish_signals(&mut self) -> Result<(), Problem> {
        let chains = self.chains();
        if !chains.is_empty() && self.drift().is_none() {
            let mut name = "signals".to_owned();
            while self.field_places.contains_key(&name) {
                name.push('_');
            }
            self.add_field(name, Role::Drift, NOWHERE, chains);
        }
        if self.highest_lie_order().is_some_and(|longest| longest > MOST_TIED) {
            let message = format!("an output is zero, and there are more than {MOST_TIED} unknowns");
            return Err(Problem::new(Code::ZeroOutput, &(0..0), message, "")
                .help("write what it says as an output that is measured"));
        }
        if self.highest_lie_order().is_some() {
            return match self.fields.iter().find(|field| field.role == Role::Input) {
                Some(input) => {
                    let message =
                        format!("an output is zero, and so the input '{}' is not anything", input.name);
                    Err(Problem::new(Code::ZeroOutput, &input.span, message, "this input")
                        .help("write what drives it as a known signal: known u(t), and u in the drift"))
                }
                None => Ok(()),
            };
        }
        let driven = self.coordinates.signals.iter().filter(|signal| signal.is_known);
        let driven: Vec<(Symbol, Span)> =
            driven.filter_map(|signal| Some((*signal.chain.last()?, signal.span.clone()))).collect();
        for (symbol, span) in driven {
            let name = next_derivative(self.symbol_name(symbol));
            let one = self.graph.integer(1);
            self.add_field(name, Role::Input, span, vec![(symbol, one)]);
        }
        Ok(())
    }

    /// Whether a field is one that the file did not write: it drives a known signal, or moves signals alone.
    pub(crate) fn is_made(&self, field: &Field) -> bool {
        let is_signal =
            |(symbol, _): &(Symbol, NodeId)| self.coordinates.kinds.get(symbol) == Some(&UnknownKind::Signal);
        field.role != Role::Other && !field.components.is_empty() && field.components.iter().all(is_signal)
    }

    fn add_field(&mut self, name: String, role: Role, span: Span, components: Vec<(Symbol, NodeId)>) {
        self.field_places.insert(name.clone(), FieldPlace::Own(self.fields.len()));
        self.fields.push(Field {
            name,
            role,
            span,
            guards: vec![Vec::new(); components.len()],
            derivation: Derivation::new(components.iter().copied().collect()),
            components,
            written: Written::default(),
        });
    }

    /// What a definition is in another experiment: `v@2`.
    pub(super) fn named_in_experiment(&mut self, name: &str, span: &Span) -> Result<Option<Value>, Problem> {
        let Some((base, experiment)) = name.split_once('@') else { return Ok(None) };
        if self.definition(base).is_none() {
            return Ok(None);
        }
        let all = self.further_experiments();
        let Some((_, copies)) = all.into_iter().find(|(number, _)| number.to_string() == experiment) else {
            let count = self.coordinates.further_experiments + 1;
            let message = format!("there is no experiment {experiment}");
            return Err(Problem::new(Code::Initial, span, message, format!("the file has {count}")));
        };
        let base = Expr { kind: ExprKind::Name(base.to_owned()), span: span.clone() };
        let (value, domain) = self.apart(|system| system.elaborate(&base))?;
        let guards = self.guards_of(&domain);
        let guards = self.substitute_guards(&guards, &copies);
        self.need_all(guards);
        Ok(Some(self.substitute(value, &copies)))
    }

    /// The range of a coordinate of the first experiment, for the others that have none of their own.
    pub(super) fn spread_range(&mut self, symbol: Symbol, range: &Range) {
        for copy in self.everywhere(symbol).into_iter().skip(1) {
            if !self.sampled.contains(&copy)
                && let Some(info) = self.symbols.get_mut(&copy)
            {
                info.range = Some(range.clone());
            }
        }
    }

    /// What is known of a symbol that is declared as a parameter or a coordinate.
    pub(super) fn fresh_info(&self, symbol: Symbol, kind: Kind) -> SymbolInfo {
        SymbolInfo { kind, is_angle: self.is_angle(symbol), default: None, range: None }
    }
}

/// How an output of the first experiment is called in another one.
pub(crate) fn in_words(text: &str, experiment: usize) -> String {
    let is_name = text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '\''));
    match is_name {
        true => format!("{text}@{experiment}"),
        false => format!("({text})@{experiment}"),
    }
}
