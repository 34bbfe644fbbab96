//! The rules: what an expression measures, from what its parts do.

use super::check::Checker;
use super::form::Form;
use super::problem::Asked;
use super::quantity::{Entry, MOST_ENTRIES, Quantity, Table};
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Expr, ExprKind, Name, Span};
use palmistry_math::number::Function;

impl Checker<'_> {
    /// What an expression measures. Mistakes are noted, and what they are in is left open.
    pub(super) fn quantity(&mut self, expr: &Expr) -> Quantity {
        let found = match &expr.kind {
            ExprKind::Number(value) if value.is_zero() => Quantity::scalar(Entry::Zero),
            ExprKind::Number(_) => Quantity::number(),
            ExprKind::Name(name) => self.named(name),
            ExprKind::Call(name, arguments) => self.call(name, arguments, &expr.span),
            ExprKind::Sum(terms) => self.sum(terms),
            ExprKind::Product(factors) => self.product(factors),
            ExprKind::Power(base, exponent) => match self.quantity(base) {
                Quantity::Table(table) if table.is_scalar() => {
                    let entry = match &table.entries[0] {
                        _ if *exponent == 0 => Entry::number(),
                        Entry::Of(form) => Entry::Of(form.power(&RBig::from(*exponent))),
                        Entry::Zero if *exponent < 0 => Entry::Open,
                        other => other.clone(),
                    };
                    Quantity::Table(Table { entries: vec![entry], ..table })
                }
                _ => Quantity::Open,
            },
            ExprKind::RealPower(base, exponent) => self.real_power(base, exponent),
            ExprKind::Matrix(rows) => self.blocks(rows),
            ExprKind::At(inner, list) => self.at(inner, list),
            // an index without a value is told where names are
            ExprKind::Indexed(_) => Quantity::Open,
        };
        match found {
            Quantity::Table(table) if table.entries.len() > MOST_ENTRIES || !self.spend(table.size()) => {
                Quantity::Open
            }
            found => found,
        }
    }

    fn named(&mut self, name: &str) -> Quantity {
        // a definition measures the same in all experiments
        let name = match name.split_once('@') {
            Some((base, _)) if self.system.definition(base).is_some() => base,
            _ => name,
        };
        if self.system.definition(name).is_some() {
            return self.known.definitions.get(name).cloned().unwrap_or(Quantity::Open);
        }
        if let Some(symbol) = self.system.find_symbol(name) {
            let form = self.known.symbols.get(&symbol).cloned();
            return Quantity::scalar(form.map_or(Entry::Open, Entry::Of));
        }
        match name {
            "pi" => Quantity::number(),
            "rank" => Quantity::scalar(Entry::number()),
            _ => Quantity::Open,
        }
    }

    /// One entry for two that are equal or added.
    pub(super) fn joined(&mut self, a: &Entry, b: &Entry, place: &Span, asked: &Asked) -> Entry {
        match (a, b) {
            (Entry::Zero, other) | (other, Entry::Zero) => other.clone(),
            (Entry::Open, other) | (other, Entry::Open) => other.clone(),
            (Entry::Of(left), Entry::Of(right)) => {
                if self.equate(left, right, place, asked) {
                    Entry::Of(left.clone())
                } else {
                    Entry::Open
                }
            }
        }
    }

    /// Entry by entry; of many mistakes the first is noted.
    pub(super) fn entrywise(&mut self, a: &Table, b: &Table, place: &Span, asked: &Asked) -> Quantity {
        if a.shape() != b.shape() {
            return Quantity::Open;
        }
        let mut entries = Vec::with_capacity(a.entries.len());
        let before = self.problems.len();
        for (left, right) in a.entries.iter().zip(&b.entries) {
            entries.push(self.joined(left, right, place, asked));
            if self.problems.len() > before {
                let (row, column) =
                    ((entries.len() - 1) / a.columns + 1, (entries.len() - 1) % a.columns + 1);
                if let (false, Some(problem)) = (a.is_scalar(), self.problems.last_mut()) {
                    problem.message.push_str(&format!(", in row {row}, column {column}"));
                }
                return Quantity::Open;
            }
        }
        Quantity::Table(Table {
            entries,
            is_number: a.is_number && b.is_number,
            at_numbers: a.at_numbers || b.at_numbers,
            ..*a
        })
    }

    fn sum(&mut self, terms: &[(bool, Expr)]) -> Quantity {
        let mut total: Option<(Quantity, usize)> = None;
        let before = self.problems.len();
        for (_, term) in terms {
            let next = self.quantity(term);
            let value = match total {
                None => next,
                Some((Quantity::Table(sum), end)) => match next {
                    Quantity::Table(next) => {
                        let (place, sign) = self.operator(end, term.span.start, &term.span);
                        self.entrywise(&sum, &next, &place, &Asked::Sum(sign))
                    }
                    // what is not known has no shape either
                    Quantity::Open => Quantity::Table(sum),
                },
                Some((Quantity::Open, _)) => next,
            };
            total = Some((value, term.span.end));
        }
        match total {
            // what follows from a mistake is none of its own
            Some((value, _)) if self.problems.len() == before => value,
            _ => Quantity::Open,
        }
    }

    fn product(&mut self, factors: &[(bool, Expr)]) -> Quantity {
        let mut total: Option<(Quantity, usize)> = None;
        for (divides, factor) in factors {
            let next = self.quantity(factor);
            let value = match (total, next) {
                (None, next) => next,
                (Some((Quantity::Table(a), end)), Quantity::Table(b)) => {
                    let (place, _) = self.operator(end, factor.span.start, &factor.span);
                    self.multiplied(&a, &b, *divides, &place)
                }
                _ => Quantity::Open,
            };
            total = Some((value, factor.span.end));
        }
        total.map_or(Quantity::Open, |(value, _)| value)
    }

    /// `e at {x = 2}`: a number is one in the file's unit of `x`.
    fn at(&mut self, inner: &Expr, list: &[(Name, Expr)]) -> Quantity {
        let inner = self.quantity(inner);
        let at_numbers = self.at_point(list);
        match inner {
            Quantity::Table(table) => Quantity::Table(Table {
                is_number: false,
                at_numbers: at_numbers || table.at_numbers,
                ..table
            }),
            Quantity::Open => Quantity::Open,
        }
    }

    /// What symbols are replaced by; whether one that has a dimension is replaced by a number.
    pub(super) fn at_point(&mut self, list: &[(Name, Expr)]) -> bool {
        let mut at_numbers = false;
        for (name, value) in list {
            let Quantity::Table(found) = self.quantity(value) else { continue };
            let symbol = self.system.find_symbol(&name.text);
            let form = symbol.and_then(|symbol| self.known.symbols.get(&symbol)).cloned();
            let replaced = form.clone().map_or(Entry::Open, Entry::Of);
            at_numbers |= found.at_numbers || (found.is_number && self.has_a_scale(&Table::scalar(replaced)));
            if let (false, Some(form), Some(Entry::Of(value_form))) =
                (found.is_number, form, found.entries.first())
            {
                let (place, _) = self.operator(name.span.end, value.span.start, &value.span);
                self.equate(&form, value_form, &place, &Asked::Replaced(name.text.clone()));
            }
        }
        at_numbers
    }

    fn call(&mut self, name: &str, arguments: &[Expr], span: &Span) -> Quantity {
        // the name of the function is its operator
        let place = span.start..span.start + name.len();
        match name {
            "L" => return self.lie(arguments),
            "d" => return self.differential(arguments),
            "bracket" => return self.bracket(arguments),
            _ => {}
        }
        let tables: Vec<Quantity> = arguments.iter().map(|argument| self.quantity(argument)).collect();
        let tables: Vec<Table> = tables
            .into_iter()
            .filter_map(|quantity| match quantity {
                Quantity::Table(table) => Some(table),
                Quantity::Open => None,
            })
            .collect();
        let is_function = Function::ALL.iter().any(|function| function.name() == name)
            || ["tan", "cot", "sec", "csc", "sinh", "cosh", "tanh"].contains(&name);
        match (name, tables.as_slice()) {
            ("abs" | "sign" | "min" | "max" | "atan2", tables) => self.composed(name, tables, &place),
            (
                "rank" | "pole" | "solutions" | "observable" | "unobservable" | "identifiable"
                | "unidentifiable",
                _,
            ) => Quantity::scalar(Entry::number()),
            ("sqrt", [one]) if one.is_scalar() => {
                let entry = match &one.entries[0] {
                    Entry::Of(form) => Entry::Of(form.power(&(RBig::ONE / RBig::from(2)))),
                    other => other.clone(),
                };
                Quantity::Table(Table { entries: vec![entry], ..*one })
            }
            (_, [one]) if is_function && one.is_scalar() => {
                if let Entry::Of(form) = &one.entries[0] {
                    self.equate(form, &Form::number(), &place, &Asked::Argument(name.to_owned()));
                }
                Quantity::Table(Table { entries: vec![Entry::number()], ..*one })
            }
            (_, _) if is_function => Quantity::scalar(Entry::number()),
            ("transpose", [one]) => Quantity::Table(one.transpose()),
            ("det", [one]) => {
                let entry = self.determinant(one, &place);
                Quantity::Table(Table { at_numbers: one.at_numbers, ..Table::scalar(entry) })
            }
            ("inverse", [one]) => {
                let entries = self.inverse(one, &place);
                Quantity::Table(one.with(entries))
            }
            ("dot", [a, b]) if a.entries.len() == b.entries.len() => {
                let terms: Vec<Entry> = a.entries.iter().zip(&b.entries).map(|(x, y)| x.times(y)).collect();
                let entry = self.total(&terms, &place, "'dot'");
                self.of_two(a, b, Table::scalar(entry))
            }
            ("cross", [a, b]) => self.cross(a, b, &place),
            _ => Quantity::Open,
        }
    }

    /// What a derivative along a field divides by: `L(f, e)` is `e` times this.
    fn along(&mut self, field: &Expr) -> Entry {
        match &field.kind {
            ExprKind::Name(name) => {
                self.known.fields.get(name).map_or(Entry::Open, |factor| Entry::Of(factor.clone()))
            }
            ExprKind::Call(name, fields) if name == "bracket" && fields.len() == 2 => {
                let (first, second) = (self.along(&fields[0]), self.along(&fields[1]));
                first.times(&second)
            }
            _ => Entry::Open,
        }
    }

    fn lie(&mut self, arguments: &[Expr]) -> Quantity {
        let Some((last, fields)) = arguments.split_last() else { return Quantity::Open };
        let Quantity::Table(table) = self.quantity(last) else { return Quantity::Open };
        let mut factor = Entry::number();
        for field in fields {
            factor = factor.times(&self.along(field));
        }
        let entries = table.entries.iter().map(|entry| entry.times(&factor)).collect();
        Quantity::Table(table.with(entries))
    }

    /// The column of the rates of all states.
    fn bracket(&mut self, arguments: &[Expr]) -> Quantity {
        let [first, second, names @ ..] = arguments else { return Quantity::Open };
        let factor = self.along(first).times(&self.along(second));
        let entries = self.states_or(names).iter().map(|state| state.times(&factor)).collect();
        Quantity::Table(Table::row(entries).transpose())
    }

    /// The dimensions of the states that are named, or of all where none is.
    fn states_or(&mut self, names: &[Expr]) -> Vec<Entry> {
        if names.is_empty() {
            let form = |state| self.known.symbols.get(state).cloned().map_or(Entry::Open, Entry::Of);
            return self.system.unknowns().iter().map(form).collect();
        }
        let mut found = Vec::with_capacity(names.len());
        for name in names {
            found.push(match self.quantity(name) {
                Quantity::Table(table) if table.is_scalar() => table.entries[0].clone(),
                _ => Entry::Open,
            });
        }
        found
    }

    fn differential(&mut self, arguments: &[Expr]) -> Quantity {
        let Some((first, names)) = arguments.split_first() else { return Quantity::Open };
        let Quantity::Table(table) = self.quantity(first) else { return Quantity::Open };
        let [entry] = table.entries.as_slice() else { return Quantity::Open };
        let by = self.states_or(names);
        let entries = by.iter().map(|by| entry.over(by)).collect();
        Quantity::Table(Table { at_numbers: table.at_numbers, ..Table::row(entries) })
    }
}
