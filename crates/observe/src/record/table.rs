//! What the readers of the formats find: cells, readable or not, in rows under names.

use palmistry_io::foreign::shown;
use std::collections::BTreeMap;

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number, finite or not.
    Number(f64),
    /// Nothing.
    Missing,
    /// Something else, and what it says.
    Unreadable(String),
}

impl Cell {
    /// The number that stands in the cell, if it is finite.
    pub fn finite(&self) -> Option<f64> {
        match self {
            Cell::Number(value) => Some(*value).filter(|v| v.is_finite()),
            Cell::Missing | Cell::Unreadable(_) => None,
        }
    }
}

/// A row of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The line in the file, counted from one; a Parquet file has no lines.
    pub line: Option<u64>,
    /// One cell a column.
    pub cells: Vec<Cell>,
    /// How many cells stand after those.
    pub surplus: usize,
    /// Whether it ends before the last column: such a row may be cut off.
    pub is_short: bool,
}

/// What a format's reader finds.
#[derive(Default)]
pub(super) struct Table {
    pub names: Vec<String>,
    pub rows: Vec<Row>,
    /// What the columns hold that cannot hold numbers, by their indices.
    pub foreign: BTreeMap<usize, String>,
}

/// Names in a line, the first ones of many.
pub(super) fn listed(names: &[String]) -> String {
    const MOST: usize = 40;
    let more = names.len().saturating_sub(MOST);
    let first: Vec<_> = names.iter().take(MOST).map(|name| shown(name)).collect();
    match more {
        0 => first.join(", "),
        _ => format!("{} and {more} more", first.join(", ")),
    }
}
