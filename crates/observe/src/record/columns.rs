//! Columns of a file under other names and in other units than those of a model.

use super::table::{Row, Table, listed};
use super::{Cell, Record, RecordError, TIME};
use palmistry_io::foreign::shown;
use palmistry_lang::nearest;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Where a column comes from: `factor` times what stands there, and `offset` more.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnSource {
    /// The name that models give it; [`TIME`] of the times.
    pub name: String,
    /// Its name in the file.
    pub from: String,
    /// Not zero.
    pub factor: f64,
    /// In the model's unit.
    pub offset: f64,
}

impl ColumnSource {
    fn read(&self, raw: f64) -> f64 {
        self.factor * raw + self.offset
    }

    fn written(&self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}

/// Some columns under other names; all others are what they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnNames {
    /// Each name once.
    pub sources: Vec<ColumnSource>,
}

/// Which column of a file is which, with factor and offset.
#[derive(Clone, Debug)]
pub(crate) struct ColumnPlan {
    /// The names that models know.
    pub names: Vec<String>,
    /// The same columns' names in the file.
    pub shown: Vec<String>,
    places: Vec<(usize, Option<ColumnSource>)>,
    width: usize,
}

impl ColumnNames {
    /// The columns of a file with this header.
    ///
    /// # Errors
    /// A column that is named is not there.
    pub(crate) fn plan(&self, path: &Path, header: &[String]) -> Result<ColumnPlan, RecordError> {
        let mut plan =
            ColumnPlan { names: Vec::new(), shown: Vec::new(), places: Vec::new(), width: header.len() };
        // of columns with one name the first
        let places: BTreeMap<&str, usize> =
            header.iter().enumerate().rev().map(|(at, name)| (name.as_str(), at)).collect();
        let mut named = BTreeSet::new();
        for source in &self.sources {
            named.extend([source.name.as_str(), source.from.as_str()]);
            let place = places.get(source.from.as_str()).copied().ok_or_else(|| {
                let near = nearest(&source.from, header.iter().map(String::as_str));
                let near = near.map_or_else(
                    || format!("its columns are {}", listed(header)),
                    |near| format!("perhaps '{near}' is meant"),
                );
                let help = format!("{near}; [columns] takes '{}' from it", source.name);
                RecordError::Column { path: path.to_owned(), column: source.from.clone(), help }
            })?;
            plan.add(&source.name, &source.from, place, Some(source.clone()));
        }
        for (place, name) in header.iter().enumerate() {
            // what has its name from the scene comes before what has it from the file
            if !named.contains(name.as_str()) {
                plan.add(name, name, place, None);
            }
        }
        Ok(plan)
    }

    /// A record as a file has it that is read with these names.
    ///
    /// # Errors
    /// Two columns would have one name.
    pub fn written(&self, record: &Record) -> Result<Record, RecordError> {
        let source = |name: &str| self.sources.iter().find(|source| source.name == name);
        let write = |name: &str, values: &[f64]| match source(name) {
            Some(own) => (own.from.clone(), values.iter().map(|value| own.written(*value)).collect()),
            None => (name.to_owned(), values.to_vec()),
        };
        let (time, times) = write(TIME, record.times());
        let columns = record.names.iter().zip(&record.columns).map(|(name, values)| write(name, values));
        let columns = columns.collect();
        if time == TIME { Record::new(times, columns) } else { Record::over(&time, times, columns) }
    }

    /// What is read again of a record that was [`ColumnNames::written`]: the same but for the last digit.
    ///
    /// # Errors
    /// None that a record that was written could bring about.
    pub fn read(&self, written: &Record, names: &[String]) -> Result<Record, RecordError> {
        let source = |name: &str| self.sources.iter().find(|source| source.name == name);
        let read = |name: &str, values: &[f64]| match source(name) {
            Some(own) => values.iter().map(|value| own.read(*value)).collect(),
            None => values.to_vec(),
        };
        let from = |name: &String| source(name).map_or(name.as_str(), |own| own.from.as_str()).to_owned();
        let columns =
            names.iter().filter_map(|name| Some((name.clone(), read(name, written.column(&from(name))?))));
        Record::new(read(TIME, written.times()), columns.collect())
    }
}

impl ColumnPlan {
    fn add(&mut self, name: &str, shown: &str, place: usize, source: Option<ColumnSource>) {
        self.names.push(name.to_owned());
        self.shown.push(shown.to_owned());
        self.places.push((place, source));
    }

    /// That a column which holds dates is taken as it is.
    ///
    /// # Errors
    /// A unit, a factor or an offset is said of it.
    pub fn takes_dates(&self, path: &Path, column: usize) -> Result<(), RecordError> {
        match &self.places[column].1 {
            Some(source) if source.factor != 1.0 || source.offset != 0.0 => {
                let why = format!(
                    "the column '{}' holds dates, which have no unit, factor or offset",
                    shown(&source.from)
                );
                let help = "say its name alone: they are counted in s from the first one".to_owned();
                Err(RecordError::Header { path: path.to_owned(), why, help })
            }
            _ => Ok(()),
        }
    }

    /// How many columns the file has, as far as the plan goes.
    pub fn width(&self) -> usize {
        self.width
    }

    /// A row with its cells in the order of the plan.
    pub fn row(&self, row: Row) -> Row {
        let cell = |(place, source): &(usize, Option<ColumnSource>)| {
            let cell = row.cells.get(*place).cloned().unwrap_or(Cell::Missing);
            match (cell, source) {
                (Cell::Number(value), Some(source)) => Cell::Number(source.read(value)),
                (cell, _) => cell,
            }
        };
        let cells = self.places.iter().map(cell).collect();
        Row { cells, ..row }
    }

    /// A table with its columns in the order of the plan.
    pub(super) fn table(&self, table: Table) -> Table {
        let foreign: BTreeMap<usize, String> = self
            .places
            .iter()
            .enumerate()
            .filter_map(|(own, (place, _))| Some((own, table.foreign.get(place)?.clone())))
            .collect();
        Table {
            names: self.names.clone(),
            rows: table.rows.into_iter().map(|row| self.row(row)).collect(),
            foreign,
        }
    }
}
