//! How far known signals are derived by what a file asks for: `L(f, f, x)` with `x' = u` holds `u'`, whether or not the file writes it.

use super::model::Role;
use super::signals::{Knowledge, derivative};
use super::syntax::Item;
use palmistry_math::expression::syntax::{Expr, ExprKind};
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// Of so many signals each is looked at by itself; where there are more, all are derived as far as one of them is.
const MOST_APART: usize = 64;

/// The highest derivatives of signals in an expression, by their places.
type Orders = Rc<BTreeMap<usize, usize>>;

/// What is known of the entries above.
#[derive(Default)]
pub(super) struct Driven {
    /// Known signals.
    places: HashMap<String, usize>,
    definitions: HashMap<String, Orders>,
    /// Fields, and whether they move signals.
    fields: HashMap<String, (bool, Orders)>,
    /// The highest derivatives that anything holds.
    highest: BTreeMap<usize, usize>,
    nothing: Orders,
    /// What an imported name may hold.
    anything: Orders,
}

impl Driven {
    /// Of the entries of a file, in their order.
    pub fn of(items: &[Item]) -> Driven {
        let mut found = Driven::default();
        let known = items.iter().filter_map(|item| match item {
            Item::Signals { knowledge: Knowledge::Known, list } => Some(list),
            _ => None,
        });
        for signal in known.flatten() {
            let place = found.places.len().min(MOST_APART);
            found.places.insert(signal.name.text.clone(), place);
        }
        // in steps a signal goes to its next value, as far as is asked
        let is_discrete = items.iter().any(|item| matches!(item, Item::Field { is_map: true, .. }));
        if found.places.is_empty() || is_discrete {
            found.places.clear();
            return found;
        }
        found.anything = Rc::new(found.places.values().map(|place| (*place, 0)).collect());
        if !items.iter().any(|item| matches!(item, Item::Field { role: Role::Drift, .. })) {
            // the drift that is made for the signals
            found.fields.insert("signals".to_owned(), (true, found.anything.clone()));
        }
        items.iter().for_each(|item| found.item(item));
        found
    }

    /// The highest derivative of a known signal that anything holds.
    pub fn highest(&self, signal: &str) -> usize {
        let place = self.places.get(signal);
        place.and_then(|place| self.highest.get(place)).copied().unwrap_or(0)
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Let { name, value, .. } => {
                let orders = self.asked(value);
                self.definitions.insert(name.text.clone(), orders);
            }
            Item::Field { role, name, components, .. } => {
                let rates = components.iter().map(|(_, rate)| self.asked(rate)).collect::<Vec<_>>();
                let rates = self.union(rates);
                self.fields.insert(name.text.clone(), (*role == Role::Drift, rates));
            }
            Item::Output(list) | Item::Zero(list) => list.iter().for_each(|one| {
                self.asked(&one.value);
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

    /// The orders of an expression, which count for the file.
    fn asked(&mut self, expr: &Expr) -> Orders {
        let orders = self.orders(expr);
        for (place, order) in orders.iter() {
            let highest = self.highest.entry(*place).or_default();
            *highest = (*order).max(*highest);
        }
        orders
    }

    fn orders(&self, expr: &Expr) -> Orders {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Indexed(_) => self.nothing.clone(),
            ExprKind::Name(name) => self.of_name(name),
            ExprKind::Call(function, arguments) if function == "L" && arguments.len() > 1 => {
                let (last, fields) = arguments.split_last().unwrap_or((expr, &[]));
                fields.iter().rev().fold(self.orders(last), |orders, field| self.along(field, orders))
            }
            ExprKind::Call(function, arguments) if function == "bracket" && arguments.len() > 1 => {
                // the components of each are derived along the other one
                let (first, second) = (&arguments[0], &arguments[1]);
                let both = [(first, second), (second, first)];
                self.union(both.map(|(field, of)| self.along(field, self.rates(of))).to_vec())
            }
            ExprKind::Call(_, arguments) => {
                self.union(arguments.iter().map(|one| self.orders(one)).collect())
            }
            ExprKind::RealPower(base, exponent) => self.union(vec![self.orders(base), self.orders(exponent)]),
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                self.union(parts.iter().map(|(_, part)| self.orders(part)).collect())
            }
            ExprKind::Power(base, _) => self.orders(base),
            ExprKind::Matrix(rows) => {
                self.union(rows.iter().flatten().map(|entry| self.orders(entry)).collect())
            }
            ExprKind::At(inner, list) => {
                let values = list.iter().map(|(_, value)| self.orders(value));
                self.union(std::iter::once(self.orders(inner)).chain(values).collect())
            }
        }
    }

    fn of_name(&self, name: &str) -> Orders {
        let (signal, order) = derivative(name).unwrap_or((name, 0));
        let base = signal.split('@').next().unwrap_or(signal);
        if let Some(place) = self.places.get(base) {
            return Rc::new(BTreeMap::from([(*place, order)]));
        }
        match self.definitions.get(base) {
            Some(orders) => orders.clone(),
            None if name.contains('.') => self.anything.clone(),
            None => self.nothing.clone(),
        }
    }

    /// The orders of the components of a field.
    fn rates(&self, field: &Expr) -> Orders {
        match &field.kind {
            ExprKind::Name(name) => match self.fields.get(name.split('@').next().unwrap_or(name)) {
                Some((_, rates)) => rates.clone(),
                None if name.contains('.') => self.anything.clone(),
                None => self.nothing.clone(),
            },
            _ => self.orders(field),
        }
    }

    /// The orders of what is derived along a field: the drift takes signals to their derivatives.
    fn along(&self, field: &Expr, orders: Orders) -> Orders {
        let moves = |name: &str| {
            let known = self.fields.get(name.split('@').next().unwrap_or(name));
            known.map_or(name.contains('.'), |(moves, _)| *moves)
        };
        let steps = match &field.kind {
            ExprKind::Name(name) => usize::from(moves(name)),
            ExprKind::Call(_, fields) => {
                let moving = |field: &&Expr| matches!(&field.kind, ExprKind::Name(name) if moves(name));
                fields.iter().take(2).filter(moving).count()
            }
            _ => 0,
        };
        let raised = match steps {
            0 => orders,
            _ => Rc::new(orders.iter().map(|(place, order)| (*place, order + steps)).collect()),
        };
        self.union(vec![raised, self.rates(field)])
    }

    fn union(&self, all: Vec<Orders>) -> Orders {
        let mut whole: Option<Orders> = None;
        for orders in all.into_iter().filter(|orders| !orders.is_empty()) {
            whole = Some(match whole {
                None => orders,
                Some(mut whole) => {
                    let into = Rc::make_mut(&mut whole);
                    for (place, order) in orders.iter() {
                        let highest = into.entry(*place).or_default();
                        *highest = (*order).max(*highest);
                    }
                    whole
                }
            });
        }
        whole.unwrap_or_else(|| self.nothing.clone())
    }
}
