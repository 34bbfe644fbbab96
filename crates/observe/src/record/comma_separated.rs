//! Comma-separated values: a header line with the columns' names, and a line a sample. A line that begins with `#` is
//! a comment, spaces around a cell do not count.

use super::table::Table;
use super::{Cell, LONGEST_FILE, MOST_CELLS, ROOM, Record, RecordError, Row, STREAM};
use csv::{ReaderBuilder, Trim, WriterBuilder};
use palmistry_io::file::read_bytes;
use palmistry_io::foreign::{Budget, Spent};
use std::io::{Error, Read, Write};
use std::path::Path;

pub(super) const COMMENT: u8 = b'#';

/// What some programs put in front of a text in UTF-8.
pub(super) const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// The names of the columns, and the rows.
pub(super) fn read(path: &Path) -> Result<Table, RecordError> {
    let complain = |why: String| RecordError::Unreadable { path: path.to_owned(), why, help: None };
    let bytes = match path == Path::new(STREAM) {
        true => standard_input().map_err(|e| complain(e.to_string()))?,
        false => read_bytes(path, LONGEST_FILE).map_err(|e| complain(e.to_string()))?,
    };
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&bytes);
    let mut reader =
        ReaderBuilder::new().flexible(true).trim(Trim::All).comment(Some(COMMENT)).from_reader(bytes);
    let complain = |e: csv::Error| complain(e.to_string());
    let header = reader.byte_headers().map_err(complain)?.clone();
    let names = names(&header, path)?;
    let refuse = |why: String| Err(no_header(path, why));
    let mut rows = Vec::new();
    let room = Budget::new(ROOM);
    let too_large = |spent: Spent| no_header(path, format!("its numbers are too many: {spent}"));
    room.bytes(bytes.len()).map_err(too_large)?;
    for line in reader.byte_records() {
        let line = line.map_err(complain)?;
        room.bytes(names.len() * size_of::<Cell>() + 2 * size_of::<Row>()).map_err(too_large)?;
        let cells = (0..names.len()).map(|i| cell(line.get(i).unwrap_or_default())).collect();
        if (rows.len() as u64 + 1).saturating_mul(names.len() as u64) > MOST_CELLS {
            return refuse(format!("it has more than {MOST_CELLS} cells"));
        }
        let surplus = line.len().saturating_sub(names.len());
        let is_short = line.len() < names.len();
        rows.push(Row { line: line.position().map(|at| line_number(bytes, at)), cells, surplus, is_short });
    }
    Ok(Table { names, rows, ..Table::default() })
}

/// All of standard input.
fn standard_input() -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::io::stdin().lock().take(LONGEST_FILE + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > LONGEST_FILE {
        true => Err(Error::other(format!("it has more than {LONGEST_FILE} bytes"))),
        false => Ok(bytes),
    }
}

fn no_header(path: &Path, why: String) -> RecordError {
    let help = "the first line names the columns, for instance: time,s1,s2".to_owned();
    RecordError::Header { path: path.to_owned(), why, help }
}

/// The names in a header.
pub(super) fn names(header: &csv::ByteRecord, path: &Path) -> Result<Vec<String>, RecordError> {
    let names: Vec<String> =
        header.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
    if names.is_empty() {
        return Err(no_header(path, "the file is empty".to_owned()));
    }
    match names.iter().position(String::is_empty) {
        Some(nameless) => Err(no_header(path, format!("column {} has no name", nameless + 1))),
        None => Ok(names),
    }
}

/// The line on which a row begins, counted from one. The format's reader tells where it began to look for the row,
/// with empty lines and comments still before it.
pub(super) fn line_number(bytes: &[u8], from: &csv::Position) -> u64 {
    let mut line = from.line();
    let mut rest = usize::try_from(from.byte()).ok().and_then(|at| bytes.get(at..)).unwrap_or_default();
    while let [first, ..] = rest
        && matches!(*first, COMMENT | b'\r' | b'\n')
        && let Some(end) = rest.iter().position(|b| *b == b'\n')
    {
        rest = &rest[end + 1..];
        line += 1;
    }
    line
}

pub(super) fn cell(bytes: &[u8]) -> Cell {
    let text = String::from_utf8_lossy(bytes);
    match text.trim() {
        "" => Cell::Missing,
        text => text.parse().map_or_else(|_| Cell::Unreadable(shortened(text)), Cell::Number),
    }
}

/// An unclosed quote can make a cell of half a file: its beginning is enough.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Writes a record. Rust prints a double with the fewest digits that are read back as the same one.
pub(super) fn write(record: &Record, file: &mut dyn Write) -> std::io::Result<()> {
    let mut writer = WriterBuilder::new().from_writer(file);
    let header = std::iter::once(record.first_name()).chain(record.names.iter().map(String::as_str));
    writer.write_record(header).map_err(io_error)?;
    for (row, time) in record.times.iter().enumerate() {
        // what was not measured is an empty cell
        let cell = |value: f64| if value.is_nan() { String::new() } else { format!("{value:?}") };
        let cells = record.columns.iter().map(|column| cell(column[row]));
        writer.write_record(std::iter::once(format!("{time:?}")).chain(cells)).map_err(io_error)?;
    }
    writer.flush()
}

/// What the system says, as it says it: a pipe whose reader has gone away is to be known as such.
fn io_error(error: csv::Error) -> Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => Error::other(format!("{other:?}")),
    }
}
