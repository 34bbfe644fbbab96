//! Parquet, plain or compressed by Snappy, as columns of doubles. What is read may also hold single-precision and whole numbers
//! and may lack values; columns of other types, and numbers that mean dates or decimals, are known by name only.

use super::table::Table;
use super::{Cell, LONGEST_FILE, MOST_CELLS, ROOM, Record, RecordError, Row, metadata};
use bytes::Bytes;
use palmistry_io::file::read_bytes;
use palmistry_io::foreign::{Budget, Spent};
use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, RowGroupReader};
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnDescriptor, Type};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

/// How many values are read at once.
const BATCH: usize = 8192;

/// Whole numbers up to this size are doubles.
const EXACT: u64 = 1 << f64::MANTISSA_DIGITS;

/// The names of the columns, and the rows.
pub(super) fn read(path: &Path) -> Result<Table, RecordError> {
    let complain = |why: String, help: Option<&str>| RecordError::Unreadable {
        path: path.to_owned(),
        why,
        help: help.map(str::to_owned),
    };
    let bytes = Bytes::from(read_bytes(path, LONGEST_FILE).map_err(|e| complain(e.to_string(), None))?);
    // the format's reader asserts where it might complain, and loops where it might stop: a damaged file must neither
    // end the program nor hold it up
    let found = metadata::check(&bytes).and_then(|()| {
        catch_unwind(AssertUnwindSafe(|| table(bytes))).unwrap_or_else(|_| Err(DAMAGED.to_owned()))
    });
    found.map_err(|why| {
        if why.contains("Disabled feature") {
            let help = "write it without compression or with Snappy, or as CSV";
            complain("its columns are compressed".to_owned(), Some(help))
        } else if why == DAMAGED {
            complain(why, Some("write it anew, or as CSV"))
        } else {
            complain(why, Some("the file may be cut short, or no Parquet file"))
        }
    })
}

/// What is said of a file on which the format's reader fails.
const DAMAGED: &str = "it is damaged";

fn table(file: Bytes) -> Result<Table, String> {
    let words = |e: ParquetError| e.to_string();
    let room = Budget::new(ROOM);
    let too_large = |spent: Spent| format!("its numbers are too many: {spent}");
    room.bytes(file.len()).map_err(too_large)?;
    let reader = SerializedFileReader::new(file).map_err(words)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut table = Table::default();
    for column in schema.columns() {
        if let Some(what) = foreign(column) {
            table.foreign.insert(table.names.len(), what);
        }
        table.names.push(column.path().string());
    }
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(words)?;
        let count = group.metadata().num_rows();
        let (columns, before) = (table.names.len(), table.rows.len() as u64);
        let rows = u64::try_from(count).map_or(u64::MAX, |count| count.saturating_add(before));
        if rows.saturating_mul(columns.max(1) as u64) > MOST_CELLS {
            return Err(format!("it promises {count} rows of {columns} columns"));
        }
        // the columns of a group, and what becomes of them
        let row = 2 * columns * size_of::<Cell>() + 2 * size_of::<Row>();
        room.bytes((count as usize).saturating_mul(row)).map_err(too_large)?;
        let columns: Vec<Vec<Cell>> = (0..table.names.len())
            .map(|index| match table.foreign.contains_key(&index) {
                true => Ok(Vec::new()),
                false => cells(group.as_ref(), index, count),
            })
            .collect::<Result<_, _>>()?;
        let count = count as usize;
        for (index, column) in columns.iter().enumerate() {
            if column.len() != count && !table.foreign.contains_key(&index) {
                let name = &table.names[index];
                return Err(format!("column '{name}' has {} values for {count} rows", column.len()));
            }
        }
        let mut columns: Vec<_> = columns.into_iter().map(Vec::into_iter).collect();
        for _ in 0..count {
            let cells = columns.iter_mut().map(|column| column.next().unwrap_or(Cell::Missing)).collect();
            table.rows.push(Row { line: None, cells, surplus: 0, is_short: false });
        }
    }
    Ok(table)
}

/// What a column holds, when it is not plain numbers.
fn foreign(column: &ColumnDescriptor) -> Option<String> {
    if column.max_rep_level() > 0 {
        return Some("lists".to_owned());
    }
    let physical = column.physical_type();
    let number = matches!(physical, Physical::DOUBLE | Physical::FLOAT | Physical::INT32 | Physical::INT64);
    let converted = column.converted_type();
    let plain = matches!(
        converted,
        ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64
            | ConvertedType::UINT_8
            | ConvertedType::UINT_16
    );
    match (number, plain) {
        (true, true) => None,
        (true, false) => Some(format!("{converted} values")),
        (false, _) => Some(format!("{physical} values")),
    }
    .or_else(|| {
        // times in nanoseconds have no older name
        let logical = column.logical_type_ref()?;
        (converted == ConvertedType::NONE).then(|| format!("{logical:?} values"))
    })
}

fn cells(group: &dyn RowGroupReader, index: usize, rows: i64) -> Result<Vec<Cell>, String> {
    let present = group.metadata().schema_descr().column(index).max_def_level();
    let reader = group.get_column_reader(index).map_err(|e| e.to_string())?;
    match reader {
        ColumnReader::DoubleColumnReader(reader) => values(reader, present, rows, |v: &f64| Cell::Number(*v)),
        ColumnReader::FloatColumnReader(reader) => {
            values(reader, present, rows, |v: &f32| Cell::Number(f64::from(*v)))
        }
        ColumnReader::Int32ColumnReader(reader) => {
            values(reader, present, rows, |v: &i32| Cell::Number(f64::from(*v)))
        }
        ColumnReader::Int64ColumnReader(reader) => values(reader, present, rows, |v: &i64| {
            if v.unsigned_abs() <= EXACT { Cell::Number(*v as f64) } else { Cell::Unreadable(v.to_string()) }
        }),
        _ => Err("a column is not of the type that the schema says".to_owned()),
    }
}

fn values<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    present: i16,
    rows: i64,
    cell: impl Fn(&T::T) -> Cell,
) -> Result<Vec<Cell>, String> {
    let mut cells = Vec::new();
    loop {
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        let (records, _, _) = reader
            .read_records(BATCH, (present > 0).then_some(&mut levels), None, &mut values)
            .map_err(|e| e.to_string())?;
        if records == 0 {
            return Ok(cells);
        }
        if cells.len() as i64 > rows {
            return Err("a column has more values than there are rows".to_owned());
        }
        if present == 0 {
            cells.extend(values.iter().map(&cell));
        } else {
            let mut values = values.iter();
            for level in levels {
                let value = if level == present { values.next().map(&cell) } else { None };
                cells.push(value.unwrap_or(Cell::Missing));
            }
        }
    }
}

/// Writes a record: one group of rows, doubles as they are, and none where nothing was measured.
pub(super) fn write(record: &Record, file: &mut (dyn Write + Send)) -> std::io::Result<()> {
    store(record, file).map_err(std::io::Error::other)
}

fn store(record: &Record, file: &mut (dyn Write + Send)) -> Result<(), ParquetError> {
    let is_sparse = |values: &[f64]| values.iter().any(|value| value.is_nan());
    let field = |name: &str, repetition: Repetition| {
        let builder = Type::primitive_type_builder(name, Physical::DOUBLE);
        builder.with_repetition(repetition).build().map(Arc::new)
    };
    let mut fields = vec![field(record.first_name(), Repetition::REQUIRED)?];
    for (name, values) in record.names.iter().zip(&record.columns) {
        let repetition = if is_sparse(values) { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        fields.push(field(name, repetition)?);
    }
    let schema = Arc::new(Type::group_type_builder("record").with_fields(fields).build()?);
    let properties = WriterProperties::builder()
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .build();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (place, values) in std::iter::once(&record.times).chain(&record.columns).enumerate() {
        let Some(mut column) = group.next_column()? else { break };
        let writer = column.typed::<DoubleType>();
        if place > 0 && is_sparse(values) {
            let levels: Vec<i16> = values.iter().map(|value| i16::from(!value.is_nan())).collect();
            let measured: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
            writer.write_batch(&measured, Some(&levels), None)?;
        } else {
            writer.write_batch(values, None, None)?;
        }
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(())
}
