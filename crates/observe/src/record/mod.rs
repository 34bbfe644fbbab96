//! Measurement records: a table of times and named columns, read from CSV or Parquet and written to either.
//!
//! A file is read twice over: first as [`RecordRows`], cells as they stand there, readable or not; then, when [`faults_of`] has
//! said what is wrong with them and the caller's rules have said what to do about it, as a [`Record`] of plain numbers
//! whose times increase. This module knows nothing of palms or observers: which columns are needed is the caller's.

mod check;
mod columns;
mod comma_separated;
mod error;
mod fault;
#[cfg(feature = "parquet")]
mod metadata;
#[cfg(feature = "parquet")]
mod parquet_file;
mod rows;
mod sparse;
mod spike;
mod stamps;
mod stream;
mod table;
#[cfg(feature = "parquet")]
mod thrift;
mod write;

#[doc(hidden)]
pub use check::faults_of;
pub use columns::{ColumnNames, ColumnSource};
pub use error::RecordError;
pub use fault::{EmptyCells, Fault, FaultKind, FaultRules, OnFault};
pub use rows::RecordRows;
pub use sparse::SparseColumn;
#[doc(hidden)]
pub use stream::RowStream;
pub(crate) use table::{Cell, Row};

use palmistry_io::foreign::Allowance;
use std::collections::BTreeSet;
use std::path::Path;

/// The name of the column of times, in seconds.
pub const TIME: &str = "time";

/// What a stream is called in messages.
pub const STREAM: &str = "standard input";

/// Files of more bytes than this are not read: eight hours of ten columns at 100 Hz have fewer, as text.
const LONGEST_FILE: u64 = 512 << 20;

/// More cells than this are not believed: a damaged file of a few bytes may promise any number of them.
const MOST_CELLS: u64 = 50_000_000;

/// More faults than these are not listed: the file is another one than is thought.
const MOST_FAULTS: usize = 1_000_000;

/// What the rows of a file may take while they are read, its text among it.
const ROOM: Allowance = Allowance { bytes: 1_600 << 20, nodes: u64::MAX, steps: u64::MAX };

/// A table of numbers: a time in seconds and named columns, one row a sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// The name of the first column where it is not time.
    over: Option<String>,
    times: Vec<f64>,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

/// A record that was read by rules, with what was wrong in the file.
#[derive(Clone, Debug)]
pub struct ReadRecord {
    /// The rows without fault.
    pub record: Record,
    /// All faults that were found, in the order of their rows. Rows with a fault are not in the record, but for a
    /// gap, which takes away no row.
    pub faults: Vec<Fault>,
    /// Columns of the file that were not asked for and hold something other than numbers: not in the record.
    pub left_out: Vec<String>,
    /// Columns with empty cells, and what became of these.
    pub sparse: Vec<SparseColumn>,
    /// The first time as it was written, where times are dates: they are counted from it.
    pub began: Option<String>,
    /// Rows before the first and after the last value of a column that drives the model: not in the record.
    pub outside: [usize; 2],
}

impl ReadRecord {
    /// Of a record without faults.
    pub fn whole(record: Record) -> ReadRecord {
        let (faults, left_out, sparse) = (Vec::new(), Vec::new(), Vec::new());
        ReadRecord { record, faults, left_out, sparse, began: None, outside: [0, 0] }
    }
}

impl Record {
    /// The table of these columns; each name once, and none of them `TIME`.
    ///
    /// # Errors
    /// When a column has another length than the times, or a name is empty or there twice.
    pub fn new(times: Vec<f64>, columns: Vec<(String, Vec<f64>)>) -> Result<Record, RecordError> {
        let mut record = Record { times, ..Record::default() };
        let mut known = BTreeSet::new();
        for (name, values) in columns {
            if values.len() != record.times.len() {
                let (found, expected) = (values.len(), record.times.len());
                return Err(RecordError::Length { column: name, found, expected });
            }
            if name.trim().is_empty() || name == TIME || !known.insert(name.clone()) {
                return Err(RecordError::Name { column: name });
            }
            record.names.push(name);
            record.columns.push(values);
        }
        Ok(record)
    }

    /// The table of these columns over something other than time: the first column is called so. It is written as such, and is no record of
    /// measurements to anyone who reads it.
    ///
    /// # Errors
    /// As [`Record::new`], or when a column has the name of the first.
    pub fn over(
        name: &str,
        values: Vec<f64>,
        columns: Vec<(String, Vec<f64>)>,
    ) -> Result<Record, RecordError> {
        let record = Record::new(values, columns)?;
        if name.trim().is_empty() || record.names.iter().any(|other| other == name) {
            return Err(RecordError::Name { column: name.to_owned() });
        }
        Ok(Record { over: Some(name.to_owned()), ..record })
    }

    /// The name of the first column: that of times, unless the record is over something else.
    pub fn first_name(&self) -> &str {
        self.over.as_deref().unwrap_or(TIME)
    }

    /// Reads a file of numbers, CSV or Parquet by its extension (`-` is all of standard input, as CSV), and judges no value: times may stand in any order,
    /// and a cell that says `NaN` or `inf` is a number here, one that is empty NaN. `needed` are the columns that must be there beside the
    /// time; none means all. Other columns are kept where they are whole.
    ///
    /// # Errors
    /// The file cannot be read, lacks a column or has no row, or a cell that is needed is no number.
    pub fn read(path: &Path, needed: &[&str]) -> Result<Record, RecordError> {
        let rows = RecordRows::read(path, needed)?;
        let columns = rows.needed[1..].iter().map(|column| rows.names[*column].clone());
        let empty = columns.map(|name| (name, EmptyCells::NotMeasured)).collect();
        let rules = FaultRules { empty, ..FaultRules::default() };
        let faults = check::unreadable(&rows, &rules);
        if !faults.is_empty() {
            return Err(RecordError::Faulty { path: path.to_owned(), faults });
        }
        Ok(rows.numbers(|_| true, |name| rules.empty.contains_key(name)).0)
    }

    /// Reads a file, CSV or Parquet by its extension, and does with faulty rows what the rules say. In the record that
    /// comes back every needed value is finite and the times increase.
    ///
    /// # Errors
    /// As [`Record::read`]; and when there is a fault and the rules say to stop, or no row is left.
    pub fn read_checked(path: &Path, needed: &[&str], rules: &FaultRules) -> Result<ReadRecord, RecordError> {
        RecordRows::read(path, needed)?.settle(rules)
    }

    /// The same of a file that has some columns under other names and in other units; `needed` are the names that models give them.
    ///
    /// # Errors
    /// As [`Record::read_checked`]; and where a column that is named is not there.
    pub fn read_named(
        path: &Path,
        needed: &[&str],
        names: &ColumnNames,
        rules: &FaultRules,
    ) -> Result<ReadRecord, RecordError> {
        RecordRows::read_named(path, needed, names)?.settle(rules)
    }

    /// Writes the record, CSV or Parquet by the extension, so that it is read back bit for bit, but for the payload of a NaN: that is an empty cell, in which
    /// nothing was measured. A file is whole or not there; a device or a pipe is written into, and `-` is standard output, as CSV.
    ///
    /// # Errors
    /// The extension is another, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), RecordError> {
        write::write(self, path)
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The times of the samples, in seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The names of the columns, without the time.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The values of a column, if there is one of that name; the times are not among them.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.names.iter().position(|n| n == name)?;
        self.columns.get(index).map(Vec::as_slice)
    }
}

#[cfg(test)]
mod tests;
