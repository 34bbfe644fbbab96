//! A table with a row for each state of a sweep, CSV or Parquet, written as the states come: it may be longer than any memory.

use palmistry_io::foreign::shown_path;
use palmistry_rank::sweep::StateRow;
#[cfg(feature = "parquet")]
use parquet::{
    basic::{Compression, Repetition, Type as Physical},
    data_type::{BoolType, DoubleType, Int32Type, Int64Type},
    errors::ParquetError,
    file::properties::{EnabledStatistics, WriterProperties},
    file::writer::{SerializedFileWriter, SerializedRowGroupWriter},
    schema::types::Type,
};
use std::io::{Error, Result, Write};
use std::path::Path;
#[cfg(feature = "parquet")]
use std::sync::Arc;

/// The columns of every table.
const COLUMNS: [&str; 5] = ["index", "rank", "certified", "smallest_singular_value", "condition"];

/// The column of the branch of the conditions, counted from one, where there are several.
const BRANCH: &str = "branch";

/// A group of rows has about so many.
#[cfg(feature = "parquet")]
const GROUP: usize = 1 << 18;

/// In which form a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableForm {
    /// Comma-separated values; what there is none of is an empty cell.
    CommaSeparated,
    /// Parquet; what there is none of is null.
    Parquet,
}

impl TableForm {
    /// By the extension of a file.
    ///
    /// # Errors
    /// A message where it is another one.
    pub fn of(path: &Path) -> std::result::Result<TableForm, String> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(TableForm::CommaSeparated),
            Some("parquet") if cfg!(feature = "parquet") => Ok(TableForm::Parquet),
            Some("parquet") => Err("this program was built without Parquet; name a .csv file".to_owned()),
            _ => Err(format!("{} is neither a .csv nor a .parquet file", shown_path(path))),
        }
    }
}

enum Sink<'w> {
    Text(&'w mut (dyn Write + Send)),
    #[cfg(feature = "parquet")]
    Groups {
        writer: Box<SerializedFileWriter<&'w mut (dyn Write + Send)>>,
        held: Vec<(usize, StateRow)>,
        /// How many coordinates each row has.
        coordinates: usize,
    },
}

/// A table that is being written.
pub struct StateTableWriter<'w> {
    sink: Sink<'w>,
    /// Whether there is a column for the branch.
    branches: bool,
}

impl<'w> StateTableWriter<'w> {
    /// Begins a table of states on so many branches of the conditions, with these coordinates.
    ///
    /// # Errors
    /// What the system says.
    pub fn new(
        file: &'w mut (dyn Write + Send),
        form: TableForm,
        branches: usize,
        coordinates: &[String],
    ) -> Result<Self> {
        let branch = Some(BRANCH).filter(|_| branches > 1);
        let sink = match form {
            #[cfg(feature = "parquet")]
            TableForm::Parquet => {
                let writer = begin(file, branch, coordinates).map_err(Error::other)?;
                Sink::Groups { writer: Box::new(writer), held: Vec::new(), coordinates: coordinates.len() }
            }
            #[cfg(not(feature = "parquet"))]
            TableForm::Parquet => return Err(Error::other("this program was built without Parquet")),
            TableForm::CommaSeparated => {
                let names = COLUMNS.into_iter().chain(branch).map(str::to_owned);
                let cells: Vec<String> = names.chain(coordinates.iter().map(|name| quoted(name))).collect();
                writeln!(file, "{}", cells.join(","))?;
                Sink::Text(file)
            }
        };
        Ok(StateTableWriter { sink, branches: branch.is_some() })
    }

    /// Adds some rows of the branch of a number, counted from zero.
    ///
    /// # Errors
    /// What the system says.
    pub fn add(&mut self, branch: usize, rows: &[StateRow]) -> Result<()> {
        match &mut self.sink {
            Sink::Text(file) => rows.iter().try_for_each(|row| {
                let mut line = format!("{},", row.index);
                line.push_str(&row.rank.map(|rank| rank.to_string()).unwrap_or_default());
                line.push_str(if row.certified { ",true" } else { ",false" });
                for value in [row.smallest_singular_value, row.condition] {
                    line.push(',');
                    line.push_str(&value.map(|value| value.to_string()).unwrap_or_default());
                }
                if self.branches {
                    line.push_str(&format!(",{}", branch + 1));
                }
                row.coordinates.iter().for_each(|value| line.push_str(&format!(",{value}")));
                writeln!(file, "{line}")
            }),
            #[cfg(feature = "parquet")]
            Sink::Groups { writer, held, coordinates } => {
                held.extend(rows.iter().map(|row| (branch, row.clone())));
                if held.len() < GROUP {
                    return Ok(());
                }
                let group = std::mem::take(held);
                write_group(writer, &group, self.branches, *coordinates).map_err(Error::other)
            }
        }
    }

    /// Ends the table.
    ///
    /// # Errors
    /// What the system says.
    pub fn finish(self) -> Result<()> {
        match self.sink {
            Sink::Text(_) => Ok(()),
            #[cfg(feature = "parquet")]
            Sink::Groups { mut writer, held, coordinates } => {
                if !held.is_empty() {
                    write_group(&mut writer, &held, self.branches, coordinates).map_err(Error::other)?;
                }
                writer.close().map(|_| ()).map_err(Error::other)
            }
        }
    }
}

/// A name as a cell.
fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}

#[cfg(feature = "parquet")]
fn begin<'w>(
    file: &'w mut (dyn Write + Send),
    branch: Option<&str>,
    coordinates: &[String],
) -> std::result::Result<SerializedFileWriter<&'w mut (dyn Write + Send)>, ParquetError> {
    let field = |name: &str, physical, repetition| {
        Type::primitive_type_builder(name, physical).with_repetition(repetition).build().map(Arc::new)
    };
    let kinds = [
        (Physical::INT64, Repetition::REQUIRED),
        (Physical::INT32, Repetition::OPTIONAL),
        (Physical::BOOLEAN, Repetition::REQUIRED),
        (Physical::DOUBLE, Repetition::OPTIONAL),
        (Physical::DOUBLE, Repetition::OPTIONAL),
    ];
    let mut fields = Vec::new();
    for (name, (physical, repetition)) in COLUMNS.into_iter().zip(kinds) {
        fields.push(field(name, physical, repetition)?);
    }
    if let Some(name) = branch {
        fields.push(field(name, Physical::INT32, Repetition::REQUIRED)?);
    }
    for name in coordinates {
        fields.push(field(name, Physical::DOUBLE, Repetition::REQUIRED)?);
    }
    let schema = Arc::new(Type::group_type_builder("states").with_fields(fields).build()?);
    let properties = WriterProperties::builder()
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_compression(Compression::SNAPPY)
        .build();
    SerializedFileWriter::new(file, schema, Arc::new(properties))
}

#[cfg(feature = "parquet")]
fn write_group(
    writer: &mut SerializedFileWriter<&mut (dyn Write + Send)>,
    rows: &[(usize, StateRow)],
    branches: bool,
    coordinates: usize,
) -> std::result::Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    let each = || rows.iter().map(|(_, row)| row);
    let whole: Vec<i64> = each().map(|row| row.index as i64).collect();
    column::<Int64Type>(&mut group, &whole, None)?;
    let ranks: Vec<Option<i32>> = each().map(|row| row.rank.map(|rank| rank as i32)).collect();
    optional::<Int32Type>(&mut group, &ranks)?;
    let certified: Vec<bool> = each().map(|row| row.certified).collect();
    column::<BoolType>(&mut group, &certified, None)?;
    let smallest: Vec<Option<f64>> = each().map(|row| row.smallest_singular_value).collect();
    optional::<DoubleType>(&mut group, &smallest)?;
    let conditions: Vec<Option<f64>> = each().map(|row| row.condition).collect();
    optional::<DoubleType>(&mut group, &conditions)?;
    if branches {
        let places: Vec<i32> = rows.iter().map(|(branch, _)| *branch as i32 + 1).collect();
        column::<Int32Type>(&mut group, &places, None)?;
    }
    for place in 0..coordinates {
        let of = |row: &StateRow| row.coordinates.get(place).copied().unwrap_or(f64::NAN);
        let values: Vec<f64> = each().map(of).collect();
        column::<DoubleType>(&mut group, &values, None)?;
    }
    group.close()?;
    Ok(())
}

#[cfg(feature = "parquet")]
type Group<'g, 'w> = SerializedRowGroupWriter<'g, &'w mut (dyn Write + Send)>;

#[cfg(feature = "parquet")]
fn column<T: parquet::data_type::DataType>(
    group: &mut Group<'_, '_>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> std::result::Result<(), ParquetError> {
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(values, levels, None)?;
        column.close()?;
    }
    Ok(())
}

#[cfg(feature = "parquet")]
fn optional<T: parquet::data_type::DataType>(
    group: &mut Group<'_, '_>,
    values: &[Option<T::T>],
) -> std::result::Result<(), ParquetError> {
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let there: Vec<T::T> = values.iter().flatten().cloned().collect();
    column::<T>(group, &there, Some(&levels))
}
