//! A record as it stands in its file: cells that may be unreadable, and rows that may be too short or too long.

use super::columns::ColumnPlan;
#[cfg(feature = "parquet")]
use super::parquet_file;
use super::stamps::Stamps;
use super::table::{Cell, Row, Table, listed};
use super::{ColumnNames, Fault, FaultKind, Record, RecordError, STREAM, TIME, comma_separated};
use palmistry_io::foreign::shown;
use palmistry_lang::nearest;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A record as it stands in its file.
#[derive(Clone, Debug)]
pub struct RecordRows {
    pub(super) path: PathBuf,
    /// The names of the columns, the time among them.
    pub(super) names: Vec<String>,
    pub(super) rows: Vec<Row>,
    /// Which columns are judged, as indices; the first is that of the times.
    pub(super) needed: Vec<usize>,
    /// The names of the columns in the file.
    pub(super) shown: Vec<String>,
    /// So many rows stand before these in the file.
    pub(super) before: usize,
    /// The first time as it was written, where times are dates.
    pub(super) began: Option<String>,
}

impl RecordRows {
    /// Reads a file, CSV or Parquet by its extension; `-` is all of standard input, as CSV. `needed` are the columns that must be there beside the time and
    /// in which a cell that is no number is a fault; none means all.
    ///
    /// # Errors
    /// The file cannot be read, lacks a column or has no row.
    pub fn read(path: &Path, needed: &[&str]) -> Result<RecordRows, RecordError> {
        RecordRows::read_named(path, needed, &ColumnNames::default())
    }

    /// The same of a file that has some columns under other names and in other units.
    ///
    /// # Errors
    /// As [`RecordRows::read`], and where a column that is named is not there.
    pub fn read_named(
        path: &Path,
        needed: &[&str],
        columns: &ColumnNames,
    ) -> Result<RecordRows, RecordError> {
        // as it is written: `-` is CSV
        let is_stream = path == Path::new("-");
        let path = if is_stream { Path::new(STREAM) } else { path };
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let table = match extension.as_deref() {
            _ if is_stream => comma_separated::read(path)?,
            Some("csv") => comma_separated::read(path)?,
            #[cfg(feature = "parquet")]
            Some("parquet") => parquet_file::read(path)?,
            #[cfg(not(feature = "parquet"))]
            Some("parquet") => return Err(RecordError::NoParquet { path: path.to_owned() }),
            _ => return Err(RecordError::Extension { path: path.to_owned() }),
        };
        RecordRows::of_table(path, table, needed, columns)
    }

    /// Columns that no file holds, as one that does: each of the same length, the time among them as any other. `name` is what stands in messages where else
    /// the file's would.
    ///
    /// # Errors
    /// As [`RecordRows::read_named`], and where a column is longer than another.
    pub fn of_columns(
        name: &str,
        held: Vec<(String, Vec<f64>)>,
        needed: &[&str],
        columns: &ColumnNames,
    ) -> Result<RecordRows, RecordError> {
        let length = held.first().map_or(0, |(_, values)| values.len());
        if let Some((column, values)) = held.iter().find(|(_, values)| values.len() != length) {
            let (column, found) = (column.clone(), values.len());
            return Err(RecordError::Length { column, found, expected: length });
        }
        // in a table without a text NaN is what an empty cell is in a file
        let cell = |value: f64| if value.is_nan() { Cell::Missing } else { Cell::Number(value) };
        let row = |place: usize| Row {
            line: None,
            cells: held.iter().map(|(_, values)| cell(values[place])).collect(),
            surplus: 0,
            is_short: false,
        };
        let rows = (0..length).map(row).collect();
        let names = held.into_iter().map(|(name, _)| name).collect();
        RecordRows::of_table(
            Path::new(name),
            Table { names, rows, foreign: BTreeMap::new() },
            needed,
            columns,
        )
    }

    fn of_table(
        path: &Path,
        table: Table,
        needed: &[&str],
        columns: &ColumnNames,
    ) -> Result<RecordRows, RecordError> {
        twice(path, &table.names)?;
        let plan = columns.plan(path, &table.names)?;
        let judged = judged(path, &plan, needed)?;
        let Table { names, mut rows, foreign } = plan.table(table);
        let mut stamps = Stamps::default();
        rows.iter_mut().for_each(|row| stamps.count(row, judged[0]));
        let began = stamps.began().map(str::to_owned);
        if began.is_some() {
            plan.takes_dates(path, judged[0])?;
        }
        if let Some((column, what)) = judged
            .iter()
            .filter_map(|column| Some((column, foreign.get(column)?)))
            .min_by_key(|(column, _)| **column)
        {
            let why = format!("the column '{}' holds {what}, not numbers", plan.shown[*column]);
            let help = "write it as doubles; times are seconds".to_owned();
            return Err(RecordError::Header { path: path.to_owned(), why, help });
        }
        if rows.is_empty() {
            return Err(RecordError::NoRows { path: path.to_owned() });
        }
        let (path, shown, needed) = (path.to_owned(), plan.shown, judged);
        Ok(RecordRows { path, names, rows, needed, shown, before: 0, began })
    }

    /// The record of the rows to keep, numbered from one, and the names of the columns that hold something other than
    /// numbers there. In columns that `may_lack` them an empty cell is NaN.
    pub(super) fn numbers(
        &self,
        keep: impl Fn(usize) -> bool,
        may_lack: impl Fn(&str) -> bool,
    ) -> (Record, Vec<String>) {
        let kept: Vec<&Row> =
            (1..).zip(&self.rows).filter(|(row, _)| keep(*row)).map(|(_, row)| row).collect();
        let values = |column: usize| -> Option<Vec<f64>> {
            let lacks = may_lack(&self.names[column]);
            let number = |row: &&Row| match row.cells.get(column) {
                Some(Cell::Number(value)) => Some(*value),
                Some(Cell::Missing) if lacks => Some(f64::NAN),
                _ => None,
            };
            kept.iter().map(number).collect()
        };
        let (mut record, mut left_out) = (Record::default(), Vec::new());
        for (index, name) in self.names.iter().enumerate() {
            match values(index) {
                Some(values) if name == TIME => record.times = values,
                Some(values) => {
                    record.names.push(name.clone());
                    record.columns.push(values);
                }
                None => left_out.push(name.clone()),
            }
        }
        (record, left_out)
    }

    /// The fault of a kind in a row, counted from zero.
    pub(super) fn fault(&self, row: usize, column: Option<usize>, kind: FaultKind) -> Fault {
        let place = self.rows.get(row);
        Fault {
            row: self.before + row + 1,
            line: place.and_then(|row| row.line),
            time: place.and_then(|row| row.cells.get(self.needed[0])).and_then(Cell::finite),
            column: column.and_then(|c| self.shown.get(c).cloned()),
            kind,
        }
    }
}

/// No two columns have one name.
pub(super) fn twice(path: &Path, names: &[String]) -> Result<(), RecordError> {
    let mut seen = BTreeSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(twice) => {
            let why = format!("the column '{twice}' is there twice");
            let help = "give every column a name of its own".to_owned();
            Err(RecordError::Header { path: path.to_owned(), why, help })
        }
        None => Ok(()),
    }
}

/// The columns that are judged: the times first; where none is needed beside them, all.
pub(super) fn judged(path: &Path, plan: &ColumnPlan, needed: &[&str]) -> Result<Vec<usize>, RecordError> {
    let names = &plan.names;
    // of columns with one name the first
    let places: BTreeMap<&str, usize> =
        names.iter().enumerate().rev().map(|(at, name)| (name.as_str(), at)).collect();
    let index = |column: &str| places.get(column).copied().ok_or_else(|| missing(path, &plan.shown, column));
    let mut judged = vec![index(TIME)?];
    let mut known = BTreeSet::from([judged[0]]);
    if needed.is_empty() {
        judged.extend((0..names.len()).filter(|i| names[*i] != TIME));
    }
    for column in needed {
        let column = index(column)?;
        if known.insert(column) {
            judged.push(column);
        }
    }
    Ok(judged)
}

fn missing(path: &Path, names: &[String], column: &str) -> RecordError {
    // a name with its unit beside it, as in "h2 (m)" or "time [s]"
    let with_unit = |name: &&str| {
        let rest = name.strip_prefix(column).map(str::trim_start);
        rest.is_some_and(|rest| rest.starts_with(['(', '[', '/', ',']))
    };
    let all = || names.iter().map(String::as_str);
    let short_time = |name: &&str| {
        column == TIME && ["t", "timestamp", "seconds"].iter().any(|own| name.eq_ignore_ascii_case(own))
    };
    let same = all().find(with_unit).or_else(|| all().find(short_time));
    let help = match same.or_else(|| nearest(column, all())) {
        _ if names.iter().all(|name| name.parse::<f64>().is_ok()) => {
            format!(
                "the first line is one of numbers: let it name the columns, as in {TIME},{}",
                if column == TIME { "x" } else { column }
            )
        }
        Some(name) => {
            format!(
                "perhaps '{name}' is meant; the header must name it '{column}', or a scene so: [columns] {column} = \"{name}\"",
                name = shown(name)
            )
        }
        None if names.len() == 1 => {
            let sign = match names[0].chars().find(|sign| matches!(sign, ';' | '\t')) {
                Some(';') => ", here by semicolons",
                Some(_) => ", here by tabs",
                None => "",
            };
            format!("its header is the one name {:?}; columns are separated by commas{sign}", names[0])
        }
        None => format!("its columns are {}", listed(names)),
    };
    RecordError::Column { path: path.to_owned(), column: column.to_owned(), help }
}
