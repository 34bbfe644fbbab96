//! What an expression measures: the dimension of a number, or those of the entries of a matrix.

use super::form::Form;

/// A matrix with more entries is not looked at.
pub(super) const MOST_ENTRIES: usize = 4096;

/// The dimension of an entry.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Entry {
    /// Zero fits every dimension.
    Zero,
    /// Nothing is known of it, and nothing is asked of it.
    Open,
    Of(Form),
}

/// What an expression measures.
#[derive(Clone, Debug)]
pub(super) enum Quantity {
    Table(Table),
    /// Nothing is known of it, not even its shape.
    Open,
}

/// The dimensions of the entries of a matrix, by rows; a number is a matrix of one entry.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub rows: usize,
    pub columns: usize,
    pub entries: Vec<Entry>,
    /// Whether it is made of written numbers alone.
    pub is_number: bool,
    /// Whether it is taken at a point that is given by numbers.
    pub at_numbers: bool,
}

impl Entry {
    pub fn number() -> Entry {
        Entry::Of(Form::number())
    }

    pub fn times(&self, other: &Entry) -> Entry {
        match (self, other) {
            (Entry::Zero, _) | (_, Entry::Zero) => Entry::Zero,
            (Entry::Open, _) | (_, Entry::Open) => Entry::Open,
            (Entry::Of(a), Entry::Of(b)) => Entry::Of(a.times(b)),
        }
    }

    pub fn over(&self, other: &Entry) -> Entry {
        match (self, other) {
            // nothing is divided by zero
            (_, Entry::Zero) => Entry::Open,
            (Entry::Zero, _) => Entry::Zero,
            (Entry::Open, _) | (_, Entry::Open) => Entry::Open,
            (Entry::Of(a), Entry::Of(b)) => Entry::Of(a.over(b)),
        }
    }
}

impl Table {
    pub fn scalar(entry: Entry) -> Table {
        Table { rows: 1, columns: 1, entries: vec![entry], is_number: false, at_numbers: false }
    }

    pub fn row(entries: Vec<Entry>) -> Table {
        Table { rows: 1, columns: entries.len(), entries, is_number: false, at_numbers: false }
    }

    pub fn is_scalar(&self) -> bool {
        self.entries.len() == 1
    }

    pub fn shape(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    pub fn at(&self, row: usize, column: usize) -> &Entry {
        &self.entries[row * self.columns + column]
    }

    /// The same with other entries, as the value of an operation that writes no number.
    pub fn with(&self, entries: Vec<Entry>) -> Table {
        Table { entries, is_number: false, ..*self }
    }

    /// How much work it is to look at.
    pub fn size(&self) -> usize {
        let size = |entry: &Entry| match entry {
            Entry::Of(form) => form.size(),
            _ => 1,
        };
        self.entries.iter().map(size).sum()
    }

    pub fn transpose(&self) -> Table {
        let entries = (0..self.columns).flat_map(|j| (0..self.rows).map(move |i| self.at(i, j).clone()));
        Table { rows: self.columns, columns: self.rows, entries: entries.collect(), ..*self }
    }
}

impl Quantity {
    pub fn scalar(entry: Entry) -> Quantity {
        Quantity::Table(Table::scalar(entry))
    }

    /// A written number that is not zero.
    pub fn number() -> Quantity {
        Quantity::Table(Table { is_number: true, ..Table::scalar(Entry::number()) })
    }
}
