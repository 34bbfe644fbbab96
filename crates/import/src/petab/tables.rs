//! The tables of a PEtab problem: tab-separated text with a row of names.

use super::PetabFile;
use palmistry_lang::{Code, Problem, ReadError};
use std::collections::BTreeMap;

/// Nobody calls a thing by a longer name.
const LONGEST_NAME: usize = 500;

/// What programs write into a cell that has nothing in it.
const NOTHING: [&str; 9] = ["nan", "NaN", "NA", "N/A", "n/a", "<NA>", "null", "NULL", "None"];

/// A row with its cells, and where it stands in the file, in bytes.
pub(super) struct Row {
    cells: Vec<String>,
    place: std::ops::Range<usize>,
}

/// A table with the file that it was read from.
pub(super) struct Table<'f> {
    pub file: &'f PetabFile,
    pub columns: Vec<String>,
    places: BTreeMap<String, usize>,
    pub rows: Vec<Row>,
}

impl Row {
    /// The cell at a place, without blanks around it; none where it is empty, or says that it is.
    pub fn at(&self, column: usize) -> Option<&str> {
        let cell = self.cells.get(column).map(String::as_str);
        cell.filter(|cell| !cell.is_empty() && !NOTHING.contains(cell))
    }
}

impl<'f> Table<'f> {
    /// Reads a table that has these columns.
    ///
    /// # Errors
    /// Where it is no table, or lacks a column.
    pub fn read(file: &'f PetabFile, needed: &[&str]) -> Result<Table<'f>, ReadError> {
        let problem = |message: String, place: std::ops::Range<usize>, help: &str| {
            Problem::new(Code::ForeignText, &place, message, "here").help(help).locate(&file.name, &file.text)
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(b'\t')
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(file.text.as_bytes());
        let head = reader.headers().map_err(|why| {
            problem(
                format!("the table cannot be read: {why}"),
                0..0,
                "a table is text, its cells apart by tabs",
            )
        })?;
        let columns: Vec<String> = head.iter().map(str::to_owned).collect();
        if let Some(missing) = needed.iter().find(|name| !columns.iter().any(|own| own == *name)) {
            let first = file.text.lines().next().map_or(0, str::len);
            return Err(problem(
                format!("the table has no column '{missing}'"),
                0..first,
                "the first line names the columns, apart by tabs; PEtab 1.0 says which there have to be",
            ));
        }
        if let Some(long) = columns.iter().find(|name| name.len() > LONGEST_NAME) {
            let message = format!("a column's name has {} bytes", long.len());
            return Err(problem(message, 0..0, "names of at most 500 bytes are read"));
        }
        let places: BTreeMap<String, usize> =
            columns.iter().enumerate().rev().map(|(at, name)| (name.clone(), at)).collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|why| {
                problem(
                    format!("the table cannot be read: {why}"),
                    0..0,
                    "a table is text, its cells apart by tabs",
                )
            })?;
            let start = record.position().map_or(0, |place| place.byte() as usize).min(file.text.len());
            let end = file.text[start..].find('\n').map_or(file.text.len(), |length| start + length);
            if record.iter().all(str::is_empty) {
                continue;
            }
            if record.len() > columns.len() {
                return Err(problem(
                    format!("this row has {} cells, and the table {} columns", record.len(), columns.len()),
                    start..end,
                    "take the rest out, or name its columns",
                ));
            }
            rows.push(Row { cells: record.iter().map(str::to_owned).collect(), place: start..end });
        }
        Ok(Table { file, columns, places, rows })
    }

    /// The cell of a column in a row; none where it is empty, or there is no such column.
    pub fn cell<'r>(&self, row: &'r Row, column: &str) -> Option<&'r str> {
        self.places.get(column).and_then(|at| row.at(*at))
    }

    /// A mistake in a row.
    pub fn error(&self, row: &Row, message: impl Into<String>, help: impl Into<String>) -> ReadError {
        Problem::new(Code::ForeignText, &row.place, message, "in this row")
            .help(help)
            .locate(&self.file.name, &self.file.text)
    }

    /// The cell of a column that a row has to have.
    ///
    /// # Errors
    /// It is empty.
    pub fn needed<'r>(&self, row: &'r Row, column: &str) -> Result<&'r str, ReadError> {
        self.cell(row, column)
            .ok_or_else(|| self.error(row, format!("the row has no '{column}'"), "fill it in"))
    }

    /// A number in a cell that a row has to have.
    ///
    /// # Errors
    /// It is empty, or no finite number.
    pub fn number(&self, row: &Row, column: &str) -> Result<f64, ReadError> {
        let text = self.needed(row, column)?;
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| {
            self.error(row, format!("'{text}' is no number"), format!("'{column}' is a decimal"))
        })
    }
}
