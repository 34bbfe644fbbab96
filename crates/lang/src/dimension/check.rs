//! A file, checked for dimensions: declarations, then everything that is written of what they declare.

use super::exponents::{Base, Dimension};
use super::form::Form;
use super::problem::Asked;
use super::quantity::{Entry, Quantity, Table};
use super::reading::DeclaredDimension;
use super::solution::Solution;
use crate::Problem;
use crate::declare::in_words;
use crate::model::{Role, System};
use crate::signals::DeclaredInitial;
use crate::syntax::{ClaimBody, Expectation, Item, OutputSyntax, Statement};
use crate::views::{End, View};
use dashu::rational::RBig;
use palmistry_math::expression::Symbol;
use palmistry_math::expression::syntax::{Equation, Expr, Name, Span};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// A file may cause so much work: some seconds. What is written beyond is left open.
const MOST_WORK: usize = 20_000_000;

/// What is known of the dimensions of a system. Of one that declares none nothing is. A copy costs no more than its unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dimensions {
    /// Whether the file, or one that it imports, declares a dimension.
    pub(super) is_declared: bool,
    pub(super) solution: Solution,
    /// The dimensions of powers whose exponents are no numbers, as `length^(n)`, by what they are called.
    pub(super) symbolic: HashMap<String, Form>,
    pub(super) symbols: Arc<BTreeMap<Symbol, Form>>,
    pub(super) definitions: Arc<HashMap<String, Quantity>>,
    /// The dimension by which a derivative along the field differs from what is differentiated.
    pub(super) fields: Arc<HashMap<String, Form>>,
    /// Whether some definition, field or output holds a number that stands for something with a dimension, or something of
    /// which no dimension is known: then a change of units is not told by the dimensions of the symbols alone.
    pub(super) holds_units: bool,
    /// The dimensions that are known in the end.
    found: Arc<BTreeMap<Symbol, Dimension>>,
}

/// What a file imports: the name that it has there, where, and its dimensions.
pub(crate) type Import = (String, Span, Arc<Dimensions>);

impl Dimensions {
    /// The dimension of a symbol, declared or inferred.
    pub(super) fn of(&self, symbol: Symbol) -> Option<&Dimension> {
        self.found.get(&symbol)
    }
}

/// A system that is being checked.
pub(super) struct Checker<'s> {
    pub system: &'s System,
    pub known: Dimensions,
    pub problems: Vec<Problem>,
    work: usize,
}

/// Checks a file: what is known of its dimensions, and all mistakes, in the order of the file.
pub(crate) fn check(system: &System, items: &[Item], imports: &[Import]) -> (Dimensions, Vec<Problem>) {
    let declares = |item: &Item| match item {
        Item::State(list) | Item::Param(list) => list.iter().any(|one| one.dimension.is_some()),
        Item::Signals { list, .. } => list.iter().any(|one| one.dimension.is_some()),
        Item::Let { dimension, .. } => dimension.is_some(),
        Item::Output(list) | Item::Zero(list) => list.iter().any(|one| one.dimension.is_some()),
        _ => false,
    };
    let is_declared = items.iter().any(declares) || imports.iter().any(|(_, _, other)| other.is_declared);
    if !is_declared {
        return (Dimensions::default(), Vec::new());
    }
    let known = Dimensions { is_declared, ..Dimensions::default() };
    let mut checker = Checker { system, known, problems: Vec::new(), work: 0 };
    for (alias, span, other) in imports.iter().filter(|(_, _, other)| other.is_declared) {
        checker.import(alias, span, other);
    }
    checker.declare(items);
    for item in items {
        checker.item(item);
    }
    let Checker { mut known, mut problems, .. } = checker;
    let mut found = BTreeMap::new();
    for (symbol, form) in known.symbols.iter() {
        if let Some(dimension) = known.solution.dimension(form) {
            found.insert(*symbol, dimension);
        }
    }
    known.found = Arc::new(found);
    problems.sort_by_key(|problem| (problem.span.start, problem.span.end));
    (known, problems)
}

/// The mistakes in a statement about a system that was checked before.
pub(super) fn problems_of(system: &System, statement: &Statement) -> Vec<Problem> {
    let known = (*system.dimensions).clone();
    if !known.is_declared {
        return Vec::new();
    }
    let mut checker = Checker { system, known, problems: Vec::new(), work: 0 };
    checker.statement(statement);
    checker.problems
}

impl Checker<'_> {
    /// Whether there is work left for something of this size.
    pub(super) fn spend(&mut self, size: usize) -> bool {
        self.work = self.work.saturating_add(size);
        self.work <= MOST_WORK
    }

    /// Takes over what is known of an imported file, its unknowns under new places.
    fn import(&mut self, alias: &str, span: &Span, other: &Dimensions) {
        self.known.holds_units |= other.holds_units;
        let mut theirs = other.solution.clone();
        let mut places: BTreeMap<usize, Form> = BTreeMap::new();
        let mut moved = |form: &Form, mine: &mut Solution| {
            let form = theirs.resolve(form, &mut Default::default());
            let mut found = Form::known(form.known);
            for (unknown, power) in &form.unknown {
                let place = places.entry(*unknown).or_insert_with(|| {
                    match (theirs.origin(*unknown).0.to_owned(), theirs.is_rigid(*unknown)) {
                        (of, true) => mine.rigid(of),
                        (of, false) => mine.unknown(of),
                    }
                });
                found = found.times_power(place, power);
            }
            found
        };
        let mut conflicts = Vec::new();
        for (symbol, form) in other.symbols.iter() {
            let form = moved(form, &mut self.known.solution);
            match self.known.symbols.get(symbol) {
                None => {
                    Arc::make_mut(&mut self.known.symbols).insert(*symbol, form);
                }
                Some(mine) => {
                    if let Err(conflict) = self.known.solution.equate(mine, &form, None) {
                        conflicts.push((*symbol, conflict));
                    }
                }
            }
        }
        for (name, form) in other.fields.iter() {
            let form = moved(form, &mut self.known.solution);
            Arc::make_mut(&mut self.known.fields).entry(format!("{alias}.{name}")).or_insert(form);
        }
        for (name, quantity) in other.definitions.iter() {
            let quantity = match quantity {
                Quantity::Table(table) => {
                    let entries = table.entries.iter().map(|entry| match entry {
                        Entry::Of(form) => Entry::Of(moved(form, &mut self.known.solution)),
                        other => other.clone(),
                    });
                    Quantity::Table(Table { entries: entries.collect(), ..*table })
                }
                Quantity::Open => Quantity::Open,
            };
            Arc::make_mut(&mut self.known.definitions).insert(format!("{alias}.{name}"), quantity);
        }
        for (symbol, conflict) in conflicts {
            let name = self.system.symbol_name(symbol).to_owned();
            self.report(&conflict, span, &Asked::Imported(name));
        }
    }

    /// The symbols: those that are declared, angles, and unknowns.
    fn declare(&mut self, items: &[Item]) {
        for item in items {
            let declared: Vec<_> = match item {
                Item::State(list) | Item::Param(list) => {
                    list.iter().map(|one| (&one.name, &one.dimension)).collect()
                }
                Item::Signals { list, .. } => list.iter().map(|one| (&one.name, &one.dimension)).collect(),
                _ => continue,
            };
            for (name, dimension) in declared {
                let Some(symbol) = self.system.find_symbol(&name.text) else { continue };
                let Some(DeclaredDimension { dimension, span }) = dimension else { continue };
                let form = Form::known(dimension.clone());
                if self.system.is_angle(symbol) {
                    self.equate(&form, &Form::number(), span, &Asked::Angle(name.text.clone()));
                }
                if let Some(known) = Arc::make_mut(&mut self.known.symbols).insert(symbol, form.clone()) {
                    self.equate(&form, &known, span, &Asked::Imported(name.text.clone()));
                }
            }
        }
        let symbols: Vec<Symbol> = self.system.symbols().map(|(symbol, _)| symbol).collect();
        for symbol in symbols {
            if !self.known.symbols.contains_key(&symbol) {
                let form = match self.system.is_angle(symbol) {
                    true => Form::number(),
                    false => self.known.solution.unknown(format!("'{}'", self.system.symbol_name(symbol))),
                };
                Arc::make_mut(&mut self.known.symbols).insert(symbol, form);
            }
        }
        self.follow();
    }

    /// What follows from these: each derivative of a signal is the one before by time, a copy in another experiment is what
    /// it is a copy of, and along the field that drives a signal one derives by its highest derivative.
    fn follow(&mut self) {
        let system = self.system;
        let by_time = Form::known(Dimension::of(Base::Time).power(&-RBig::ONE));
        let symbols = Arc::make_mut(&mut self.known.symbols);
        for (symbol, copies) in &system.coordinates.copies {
            let Some(form) = symbols.get(symbol).cloned() else { continue };
            symbols.extend(copies.iter().map(|copy| (*copy, form.clone())));
        }
        for signal in &system.coordinates.signals {
            for pair in signal.chain.windows(2) {
                let Some(rate) = symbols.get(&pair[0]).map(|form| form.times(&by_time)) else { continue };
                symbols.insert(pair[1], rate);
            }
        }
        let fields = Arc::make_mut(&mut self.known.fields);
        for field in system.fields.iter().filter(|field| system.is_made(field)) {
            let form = match (field.role, field.components.first()) {
                (Role::Drift, _) => Some(by_time.clone()),
                (_, Some((moved, _))) => symbols.get(moved).map(|form| form.power(&-RBig::ONE)),
                _ => None,
            };
            fields.extend(form.map(|form| (field.name.clone(), form)));
        }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::System { .. }
            | Item::Use { .. }
            | Item::State(_)
            | Item::Param(_)
            | Item::Angle(_)
            | Item::Looks(_) => {}
            Item::Let { name, dimension, value: expr } => {
                let mut found = self.quantity(expr);
                if let Some(dimension) = dimension {
                    found = self.declared(found, &name.text, dimension);
                }
                self.note_units(&found);
                Arc::make_mut(&mut self.known.definitions).insert(name.text.clone(), found);
            }
            Item::Field { role, name, components, is_map, .. } => {
                self.field(*role, name, components, *is_map);
            }
            Item::Output(list) | Item::Zero(list) => {
                for OutputSyntax { value: expr, dimension, .. } in list {
                    let found = self.quantity(expr);
                    self.note_units(&found);
                    if let Some(dimension) = dimension {
                        let text = crate::in_one_line(&self.system.source, &expr.span);
                        self.declared(found, &text, dimension);
                    }
                }
            }
            Item::Signals { .. } | Item::Experiments { .. } => {}
            Item::Initial(list) => {
                for DeclaredInitial { name, value } in list {
                    let Some(value) = value else { continue };
                    self.known.holds_units |= self.at_point(&[(name.clone(), value.clone())]);
                }
            }
            // a range is of numbers, in the unit of what it is of
            Item::Assume(relations) => {
                self.conditions(relations);
            }
            Item::Sample { avoid, .. } => {
                for expr in avoid {
                    self.quantity(expr);
                }
            }
            Item::Claim(claim) => match &claim.body {
                // what is said to be wrong may have wrong dimensions
                ClaimBody::Claim { expected: Expectation::Refuted, .. } => {}
                ClaimBody::Claim { statement, .. }
                | ClaimBody::Scan { repaired: statement, .. }
                | ClaimBody::Erratum { corrected: statement, .. } => self.statement(statement),
                ClaimBody::Definition { .. } | ClaimBody::Open { .. } => {}
            },
            Item::View(view) => match &**view {
                View::Set { conditions, .. } | View::Reduction { conditions, .. } => {
                    self.conditions(conditions);
                }
                View::Line { moving, end: End::Value(value), .. } => {
                    self.at_point(&[(moving.clone(), value.clone())]);
                }
                View::Line { end: End::Zero(equation), .. } => {
                    self.conditions(std::slice::from_ref(equation));
                }
                // ranges and the values of a point are numbers
                View::Line { end: End::Infinity, .. } | View::Map { .. } => {}
            },
        }
    }

    /// Conditions; whether one gives a number to something that has a dimension.
    fn conditions(&mut self, conditions: &[Equation]) -> bool {
        let mut at_numbers = false;
        for condition in conditions {
            let left = self.quantity(&condition.left);
            let right = self.quantity(&condition.right);
            at_numbers |= self.sides(condition, left, right, true);
        }
        at_numbers
    }

    /// What is declared of a definition or an output; a written number is one in this unit.
    fn declared(&mut self, found: Quantity, name: &str, declared: &DeclaredDimension) -> Quantity {
        let form = Form::known(declared.dimension.clone());
        let Quantity::Table(table) = found else { return Quantity::Open };
        let wanted = |entry: &Entry| match entry {
            Entry::Zero => Entry::Zero,
            _ => Entry::Of(form.clone()),
        };
        let table_wanted = table.with(table.entries.iter().map(wanted).collect());
        if table.is_number {
            self.known.holds_units |= !declared.dimension.is_none();
        } else {
            let asked = Asked::Declared(name.to_owned());
            self.entrywise(&table_wanted, &table, &declared.span, &asked);
        }
        Quantity::Table(table_wanted)
    }

    /// Notes whether something holds numbers in units, or is not known.
    fn note_units(&mut self, found: &Quantity) {
        self.known.holds_units |= match found {
            Quantity::Table(table) => table.at_numbers || table.entries.contains(&Entry::Open),
            Quantity::Open => true,
        };
    }

    fn field(&mut self, role: Role, name: &Name, components: &[(Name, Expr)], is_map: bool) {
        let factor = match role {
            // a step leads from a state to one of its kind
            _ if is_map => Form::number(),
            Role::Drift => Form::known(Dimension::of(Base::Time).power(&-RBig::ONE)),
            _ => self.known.solution.unknown(format!("the field '{}'", name.text)),
        };
        for (state, expr) in components {
            let found = self.quantity(expr);
            self.note_units(&found);
            let symbol = self.system.find_symbol(&state.text);
            let form = symbol.and_then(|symbol| self.known.symbols.get(&symbol)).cloned();
            if let (Some(form), Quantity::Table(Table { entries, .. })) = (form, found)
                && let [Entry::Of(rate)] = entries.as_slice()
            {
                let (place, _) = self.operator(state.span.end, expr.span.start, &expr.span);
                let asked = Asked::Rate { state: state.text.clone(), field: name.text.clone() };
                self.equate(&form.times(&factor), rate, &place, &asked);
            }
        }
        let fields = Arc::make_mut(&mut self.known.fields);
        for experiment in 2..self.system.coordinates.further_experiments + 2 {
            fields.insert(in_words(&name.text, experiment), factor.clone());
        }
        fields.insert(name.text.clone(), factor);
    }

    fn statement(&mut self, statement: &Statement) {
        let at_numbers = self.conditions(&statement.conditions) || statement.on_sample;
        statement.except.iter().flatten().for_each(|set| {
            self.conditions(set);
        });
        let mut left = self.quantity(&statement.equation.left);
        for equation in statement.relations() {
            let right = self.quantity(&equation.right);
            self.sides(equation, left, right.clone(), at_numbers);
            // the next of a chain begins where this one ends, unless it is 'in [low, high]'
            left = right;
            if equation.span == statement.equation.span && is_a_range(statement) {
                left = self.quantity(&statement.equation.left);
            }
        }
    }

    /// Compares two sides; where `numbers_fit`, a written number takes the dimension of the other side. Whether one of
    /// them is such a number, and the other has a dimension.
    fn sides(&mut self, equation: &Equation, left: Quantity, right: Quantity, numbers_fit: bool) -> bool {
        let (Quantity::Table(left), Quantity::Table(right)) = (left, right) else { return false };
        let number = |table: &Table| table.is_number;
        let fits = numbers_fit || left.at_numbers || right.at_numbers;
        if !(fits && (number(&left) || number(&right))) {
            let between = (equation.left.span.end, equation.right.span.start);
            let (place, _) = self.operator(between.0, between.1, &equation.span);
            let sign = equation.relation.sign().to_owned();
            self.entrywise(&left, &right, &place, &Asked::Relation(sign));
        }
        if let Some(within) = &equation.within
            && let Quantity::Table(tolerance) = self.quantity(within)
            && !tolerance.is_number
        {
            let side = if number(&left) { &right } else { &left };
            self.entrywise(side, &tolerance, &within.span, &Asked::Tolerance);
        }
        let sets_a_scale =
            |one: &Table, other: &Table, checker: &mut Self| number(one) && checker.has_a_scale(other);
        sets_a_scale(&left, &right, self) || sets_a_scale(&right, &left, self)
    }

    /// Whether some entry has a dimension for all that is known, so that its value hangs on the unit.
    pub(super) fn has_a_scale(&mut self, table: &Table) -> bool {
        table.entries.iter().any(|entry| match entry {
            Entry::Of(form) => {
                let form = self.known.solution.resolve(form, &mut Default::default());
                !form.known.is_none() || !form.unknown.is_empty()
            }
            _ => false,
        })
    }
}

/// Whether a statement is `e in [low, high]`, whose two relations have one left side.
fn is_a_range(statement: &Statement) -> bool {
    statement.further.first().is_some_and(|second| second.left.span == statement.equation.left.span)
}
