//! What calculations with matrices measure, from what their entries do.

use super::check::Checker;
use super::problem::Asked;
use super::quantity::{Entry, MOST_ENTRIES, Quantity, Table};
use palmistry_math::expression::syntax::{Expr, Span};

impl Checker<'_> {
    pub(super) fn multiplied(&mut self, a: &Table, b: &Table, divides: bool, place: &Span) -> Quantity {
        let (is_number, at_numbers) = (a.is_number && b.is_number, a.at_numbers || b.at_numbers);
        let with = |table: &Table, entries: Vec<Entry>| {
            Quantity::Table(Table { entries, is_number, at_numbers, ..*table })
        };
        match (a.is_scalar(), b.is_scalar(), divides) {
            (_, true, true) => with(a, a.entries.iter().map(|entry| entry.over(&b.entries[0])).collect()),
            (_, true, false) => with(a, a.entries.iter().map(|entry| entry.times(&b.entries[0])).collect()),
            (true, _, false) => with(b, b.entries.iter().map(|entry| a.entries[0].times(entry)).collect()),
            (_, _, false) if a.columns == b.rows && a.rows * b.columns <= MOST_ENTRIES => {
                let mut entries = Vec::with_capacity(a.rows * b.columns);
                let before = self.problems.len();
                for row in 0..a.rows {
                    for column in 0..b.columns {
                        let terms = (0..a.columns).map(|k| a.at(row, k).times(b.at(k, column)));
                        let terms: Vec<Entry> = terms.collect();
                        entries.push(self.total(&terms, place, "the product"));
                        if self.problems.len() > before || !self.spend(terms.len()) {
                            return Quantity::Open;
                        }
                    }
                }
                let table = Table { rows: a.rows, columns: b.columns, entries, is_number, at_numbers };
                Quantity::Table(table)
            }
            _ => Quantity::Open,
        }
    }

    /// The sum of products.
    pub(super) fn total(&mut self, terms: &[Entry], place: &Span, what: &'static str) -> Entry {
        let mut total = Entry::Zero;
        for term in terms {
            total = self.joined(&total, term, place, &Asked::Products(what));
        }
        // a term of which nothing is known may be any part of the sum
        total
    }

    pub(super) fn blocks(&mut self, rows: &[Vec<Expr>]) -> Quantity {
        let mut whole =
            Table { rows: 0, columns: 0, entries: Vec::new(), is_number: true, at_numbers: false };
        for row in rows {
            let mut blocks = Vec::new();
            for block in row {
                match self.quantity(block) {
                    Quantity::Table(table) => blocks.push(table),
                    Quantity::Open => blocks.push(Table { rows: 0, ..Table::scalar(Entry::Open) }),
                }
            }
            let height = blocks.first().map_or(0, |block| block.rows);
            let width: usize = blocks.iter().map(|block| block.columns).sum();
            let fits = height > 0 && blocks.iter().all(|block| block.rows == height);
            if !fits || (whole.rows > 0 && whole.columns != width) {
                return Quantity::Open;
            }
            for line in 0..height {
                for block in &blocks {
                    let begin = line * block.columns;
                    whole.entries.extend_from_slice(&block.entries[begin..begin + block.columns]);
                }
            }
            if whole.entries.len() > MOST_ENTRIES {
                return Quantity::Open;
            }
            whole.rows += height;
            whole.columns = width;
            // zeros are numbers, too
            let is_number =
                |block: &Table| block.is_number || block.entries.iter().all(|entry| *entry == Entry::Zero);
            whole.is_number &= blocks.iter().all(is_number);
            whole.at_numbers |= blocks.iter().any(|block| block.at_numbers);
        }
        Quantity::Table(whole)
    }

    pub(super) fn of_two(&self, a: &Table, b: &Table, found: Table) -> Quantity {
        let is_number = a.is_number && b.is_number;
        Quantity::Table(Table { is_number, at_numbers: a.at_numbers || b.at_numbers, ..found })
    }

    pub(super) fn cross(&mut self, a: &Table, b: &Table, place: &Span) -> Quantity {
        let (x, y) = (&a.entries, &b.entries);
        if x.len() != y.len() || !(2..=3).contains(&x.len()) {
            return Quantity::Open;
        }
        let before = self.problems.len();
        let mut part = |i: usize, j: usize| {
            let terms = [x[i].times(&y[j]), x[j].times(&y[i])];
            match self.problems.len() > before {
                true => Entry::Open,
                false => self.total(&terms, place, "'cross'"),
            }
        };
        let found = match x.len() {
            2 => Table::scalar(part(0, 1)),
            _ => {
                let entries = vec![part(1, 2), part(2, 0), part(0, 1)];
                Table { entries, ..*a }
            }
        };
        self.of_two(a, b, found)
    }
}
