//! How far known signals are derived by what a file asks for: `L(f, f, x)` with `x' = u` holds `u'`, whether or not the file writes it.

use super::model::Role;
use super::signals::{Knowledge, derivative};
use super::syntax::Item;
use palmistry_math::expression::syntax::{Expr, ExprKind};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

/// Of so many signals, and states, each is looked at by itself; where there are more, the others are taken together.
const MOST_APART: usize = 64;

/// What an expression holds.
#[derive(Clone, Default)]
struct Holds {
    /// The highest derivatives of signals, by their places.
    signals: BTreeMap<usize, usize>,
    /// The places of states.
    states: BTreeSet<usize>,
}

type Held = Rc<Holds>;

/// A field: whether it moves signals, and what the rates of states hold.
#[derive(Clone, Default)]
struct Moves {
    signals: bool,
    rates: BTreeMap<usize, Held>,
    /// The rates of states that are not known one by one.
    others: Held,
}

/// What is known of the entries above.
#[derive(Default)]
pub(super) struct Driven {
    /// Known signals.
    signals: HashMap<String, usize>,
    states: HashMap<String, usize>,
    definitions: HashMap<String, Held>,
    fields: HashMap<String, Moves>,
    /// What moves the states, and what the outputs hold.
    moving: Vec<String>,
    outputs: Vec<Held>,
    /// The highest derivatives that anything holds.
    highest: BTreeMap<usize, usize>,
    nothing: Held,
    /// What an imported name may hold.
    anything: Held,
}

impl Driven {
    /// Of the entries of a file, in their order.
    pub fn of(items: &[Item]) -> Driven {
        let mut found = Driven::default();
        let is_discrete = items.iter().any(|item| matches!(item, Item::Field { is_map: true, .. }));
        if is_discrete {
            // in steps a signal goes to its next value, as far as is asked
            return found;
        }
        let enter = |places: &mut HashMap<String, usize>, name: &str| {
            let place = places.len().min(MOST_APART);
            places.entry(name.to_owned()).or_insert(place);
        };
        for item in items {
            match item {
                Item::Signals { knowledge: Knowledge::Known, list } => {
                    list.iter().for_each(|one| enter(&mut found.signals, &one.name.text));
                }
                // what moves is a state
                Item::Field { components, .. } => {
                    components.iter().for_each(|(name, _)| enter(&mut found.states, &name.text));
                }
                _ => (),
            }
        }
        if found.signals.is_empty() {
            return found;
        }
        found.anything = Rc::new(Holds {
            signals: found.signals.values().map(|place| (*place, 0)).collect(),
            states: found.states.values().copied().collect(),
        });
        if !items.iter().any(|item| matches!(item, Item::Field { role: Role::Drift, .. })) {
            // the drift that is made for the signals
            found.fields.insert("signals".to_owned(), Moves { signals: true, ..Moves::default() });
        }
        items.iter().for_each(|item| found.item(item));
        found
    }

    /// The highest derivative of a known signal that anything holds.
    pub fn highest(&self, signal: &str) -> usize {
        let place = self.signals.get(signal);
        place.and_then(|place| self.highest.get(place)).copied().unwrap_or(0)
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Let { name, value, .. } => {
                let held = self.asked(value);
                self.definitions.insert(name.text.clone(), held);
            }
            Item::Field { role, name, components, .. } => {
                let mut moves = Moves { signals: *role == Role::Drift, ..Moves::default() };
                for (state, rate) in components {
                    let held = self.asked(rate);
                    if let Some(place) = self.states.get(&state.text) {
                        // several are taken together where there are many
                        let before = moves.rates.get(place).cloned().unwrap_or_default();
                        moves.rates.insert(*place, self.union(vec![before, held]));
                    }
                }
                if *role != Role::Other {
                    self.moving.push(name.text.clone());
                }
                self.fields.insert(name.text.clone(), moves);
            }
            Item::Output(list) | Item::Zero(list) => list.iter().for_each(|one| {
                let held = self.asked(&one.value);
                self.outputs.push(held);
            }),
            Item::Assume(equations) => equations.iter().for_each(|equation| {
                self.asked(&equation.left);
                self.asked(&equation.right);
            }),
            Item::Sample { avoid, .. } => avoid.iter().for_each(|expr| {
                self.asked(expr);
            }),
            Item::Claim(claim) => {
                for statement in claim.body.statements() {
                    for equation in statement.all_equations() {
                        self.asked(&equation.left);
                        self.asked(&equation.right);
                    }
                }
            }
            Item::View(view) => {
                for equation in view.equations() {
                    self.asked(&equation.left);
                    self.asked(&equation.right);
                }
            }
            _ => (),
        }
    }

    /// What an expression holds, which counts for the file.
    fn asked(&mut self, expr: &Expr) -> Held {
        let held = self.held(expr);
        for (place, order) in &held.signals {
            let highest = self.highest.entry(*place).or_default();
            *highest = (*order).max(*highest);
        }
        held
    }

    fn held(&self, expr: &Expr) -> Held {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Indexed(_) => self.nothing.clone(),
            ExprKind::Name(name) => self.of_name(name),
            ExprKind::Call(function, arguments) if function == "L" && arguments.len() > 1 => {
                let (last, fields) = arguments.split_last().unwrap_or((expr, &[]));
                fields.iter().rev().fold(self.held(last), |held, field| self.along(field, &held))
            }
            ExprKind::Call(function, arguments) if function == "bracket" && arguments.len() > 1 => {
                // the components of each are derived along the other one
                let all =
                    Rc::new(Holds { states: self.states.values().copied().collect(), ..Holds::default() });
                let (first, second) = (&arguments[0], &arguments[1]);
                let both = [[first, second], [second, first]];
                let twice = both.map(|[last, before]| self.along(last, &self.along(before, &all)));
                self.union(twice.to_vec())
            }
            ExprKind::Call(function, arguments) if function == "codistribution" => {
                let order = match arguments.as_slice() {
                    [Expr { kind: ExprKind::Number(order), .. }] => order.to_f64().value(),
                    _ => 0.0,
                };
                let mut held = self.union(self.outputs.clone());
                // beyond a few orders all that moves has been met, and each raises the derivatives of signals by one
                for _ in 0..(order.clamp(0.0, 64.0) as usize) {
                    let names = self.moving.iter().map(String::as_str).chain(["signals"]);
                    let moves: Vec<&Moves> = names.filter_map(|name| self.fields.get(name)).collect();
                    held = self.union(moves.into_iter().map(|moves| self.derived(moves, &held)).collect());
                }
                held
            }
            ExprKind::Call(_, arguments) => self.union(arguments.iter().map(|one| self.held(one)).collect()),
            ExprKind::RealPower(base, exponent) => self.union(vec![self.held(base), self.held(exponent)]),
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                self.union(parts.iter().map(|(_, part)| self.held(part)).collect())
            }
            ExprKind::Power(base, _) => self.held(base),
            ExprKind::Matrix(rows) => {
                self.union(rows.iter().flatten().map(|entry| self.held(entry)).collect())
            }
            ExprKind::At(inner, list) => {
                let values = list.iter().map(|(_, value)| self.held(value));
                self.union(std::iter::once(self.held(inner)).chain(values).collect())
            }
        }
    }

    fn of_name(&self, name: &str) -> Held {
        let (signal, order) = derivative(name).unwrap_or((name, 0));
        let base = signal.split('@').next().unwrap_or(signal);
        if let Some(place) = self.signals.get(base) {
            return Rc::new(Holds { signals: BTreeMap::from([(*place, order)]), ..Holds::default() });
        }
        if let Some(place) = self.states.get(base) {
            return Rc::new(Holds { states: BTreeSet::from([*place]), ..Holds::default() });
        }
        match self.definitions.get(base) {
            Some(held) => held.clone(),
            None if name.contains('.') => self.anything.clone(),
            None => self.nothing.clone(),
        }
    }

    /// What the derivative along a field holds: the drift takes signals to their derivatives.
    fn along(&self, field: &Expr, held: &Held) -> Held {
        match &field.kind {
            ExprKind::Name(name) => match self.fields.get(name.split('@').next().unwrap_or(name)) {
                Some(moves) => self.derived(moves, held),
                None if name.contains('.') => {
                    let moves = Moves { signals: true, others: self.anything.clone(), ..Moves::default() };
                    self.derived(&moves, held)
                }
                // a field that drives a signal
                None => held.clone(),
            },
            // a bracket: along both, in whichever order
            ExprKind::Call(_, fields) if fields.len() > 1 => {
                let both = [[&fields[0], &fields[1]], [&fields[1], &fields[0]]];
                let twice = both.map(|[last, before]| self.along(last, &self.along(before, held)));
                self.union(twice.to_vec())
            }
            _ => held.clone(),
        }
    }

    fn derived(&self, moves: &Moves, held: &Held) -> Held {
        let mut raised = Holds::clone(held);
        if moves.signals {
            raised.signals.values_mut().for_each(|order| *order += 1);
        }
        let rates = held.states.iter().map(|place| moves.rates.get(place).unwrap_or(&moves.others).clone());
        self.union(std::iter::once(Rc::new(raised)).chain(rates).collect())
    }

    fn union(&self, all: Vec<Held>) -> Held {
        let mut whole: Option<Held> = None;
        for held in all.into_iter().filter(|held| !held.signals.is_empty() || !held.states.is_empty()) {
            whole = Some(match whole {
                None => held,
                Some(mut whole) => {
                    let into = Rc::make_mut(&mut whole);
                    for (place, order) in &held.signals {
                        let highest = into.signals.entry(*place).or_default();
                        *highest = (*order).max(*highest);
                    }
                    into.states.extend(&held.states);
                    whole
                }
            });
        }
        whole.unwrap_or_else(|| self.nothing.clone())
    }
}
