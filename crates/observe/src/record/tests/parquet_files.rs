//! Parquet files: of ours and of other programs, cut and damaged.

use super::files::{any_record, bits, one_nan, read_somehow};
use super::*;
use proptest::prelude::*;

/// A Parquet file of a few rows.
fn parquet_bytes() -> Vec<u8> {
    let (_folder, path) = file("record.parquet", "");
    let values = |by: f64| (0..50).map(|i| by * f64::from(i)).collect::<Vec<f64>>();
    let columns = vec![("s1".to_owned(), values(0.1)), ("s2".to_owned(), values(-3.0))];
    Record::new(values(0.01), columns).unwrap().write(&path).unwrap();
    std::fs::read(&path).unwrap()
}

/// Files of other programs: columns that may lack values, of single precision and of whole numbers, in two groups of
/// rows; and columns that are no numbers or mean a date.
#[test]
fn parquet_columns_of_other_types_are_numbers_or_refused() {
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    let schema = "message m { required double time; optional double s1; required float s2; required int64 count; \
                  optional binary note (UTF8); required int64 clock (TIMESTAMP(MILLIS,true)); }";
    let (_folder, path) = file("record.parquet", "");
    let mut writer = SerializedFileWriter::new(
        std::fs::File::create(&path).unwrap(),
        std::sync::Arc::new(parse_message_type(schema).unwrap()),
        Default::default(),
    )
    .unwrap();
    for (start, large) in [(0.0, 7), (2.0, i64::MAX)] {
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&[start, start + 1.0], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&[0.25], Some(&[0, 1]), None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<FloatType>().write_batch(&[0.5, 0.75], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&[3, large], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<ByteArrayType>().write_batch(&[ByteArray::from("a")], Some(&[1, 0]), None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&[1, 2], None, None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
    }
    writer.close().unwrap();

    let rows = RecordRows::read(&path, &["s1", "s2", "count"]).unwrap();
    let told: Vec<_> =
        faults_of(&rows, &FaultRules::default()).into_iter().map(|f| (f.row, f.column, f.kind)).collect();
    let says = i64::MAX.to_string();
    let expected = [
        (1, column("s1"), FaultKind::Missing),
        (3, column("s1"), FaultKind::Missing),
        (4, column("count"), FaultKind::NotANumber { says }),
    ];
    assert_eq!(told, expected);
    let record = Record::read(&path, &["s2"]).unwrap();
    assert_eq!(record.times(), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(record.column("s2"), Some([0.5, 0.75, 0.5, 0.75].as_slice()));
    assert_eq!(record.names(), ["s2"]);
    for (needed, words) in [("note", "holds BYTE_ARRAY"), ("clock", "holds TIMESTAMP_MILLIS")] {
        let said = Record::read(&path, &[needed]).unwrap_err().to_string();
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_parquet_file_that_was_cut_is_refused() {
    let whole = parquet_bytes();
    for length in 0..whole.len() {
        let (_folder, path) = file("record.parquet", &whole[..length]);
        assert!(Record::read(&path, &[]).is_err(), "cut to {length} of {}", whole.len());
    }
}

proptest! {
    #[test]
    fn parquet_is_read_back_bit_for_bit(record in any_record()) {
        let (_folder, path) = file("record.parquet", "");
        record.write(&path).unwrap();
        let back = Record::read(&path, &[]).unwrap();
        prop_assert_eq!(back.names(), record.names());
        prop_assert_eq!(one_nan(bits(&back)), one_nan(bits(&record)));
    }

    #[test]
    fn no_damage_makes_the_reader_panic(at in any::<prop::sample::Index>(), to in any::<u8>()) {
        let mut bytes = parquet_bytes();
        let at = at.index(bytes.len());
        bytes[at] = to;
        read_somehow("record.parquet", &bytes);
    }
}
