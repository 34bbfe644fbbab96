use super::*;
use proptest::prelude::*;
use std::path::PathBuf;

/// A file of its own, gone when the folder is dropped.
fn file(name: &str, bytes: impl AsRef<[u8]>) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// The faults of a text, as pairs of row and line, and what is wrong.
fn faults(text: &str) -> Vec<(usize, Option<u64>, Option<String>, FaultKind)> {
    let (_folder, path) = file("record.csv", text);
    let rows = Rows::read(&path, &[]).unwrap();
    let told = check(&rows, &FaultRules::default());
    told.into_iter().map(|f| (f.row, f.line, f.column, f.kind)).collect()
}

fn column(name: &str) -> Option<String> {
    Some(name.to_owned())
}

/// Times from zero in tenths of a second, and `s1 = 2 time`, with some lines replaced.
fn record(lines: usize, replaced: &[(usize, &str)]) -> String {
    let mut text = "time,s1\n".to_owned();
    for row in 1..=lines {
        match replaced.iter().find(|(r, _)| *r == row) {
            Some((_, line)) => text += line,
            None => text += &format!("{:.1},{:.1}", 0.1 * (row - 1) as f64, 0.2 * (row - 1) as f64),
        }
        text.push('\n');
    }
    text
}

#[test]
fn a_whole_record_has_no_fault() {
    assert_eq!(faults(&record(30, &[])), []);
}

#[test]
fn each_fault_is_told_with_its_row() {
    let says = |says: &str| FaultKind::NotANumber { says: says.to_owned() };
    let s1 = || column("s1");
    let time = || column(TIME);
    assert_eq!(faults(&record(30, &[(7, "0.6,1.2m")])), [(7, Some(8), s1(), says("1.2m"))]);
    assert_eq!(faults(&record(30, &[(7, "o.6,1.2")])), [(7, Some(8), time(), says("o.6"))]);
    assert_eq!(faults(&record(30, &[(7, "0.6,")])), [(7, Some(8), s1(), FaultKind::Missing)]);
    assert_eq!(faults(&record(30, &[(7, "0.6")])), [(7, Some(8), s1(), FaultKind::Missing)]);
    let infinite = FaultKind::NotFinite { value: f64::NEG_INFINITY };
    assert_eq!(faults(&record(30, &[(7, "0.6,-inf")])), [(7, Some(8), s1(), infinite.clone())]);
    assert_eq!(faults(&record(30, &[(7, "-1e999,1.2")])), [(7, Some(8), time(), infinite)]);
    let nan = &faults(&record(30, &[(7, "0.6,NaN")]))[..];
    assert!(
        matches!(nan, [(7, Some(8), Some(_), FaultKind::NotFinite { value })] if value.is_nan()),
        "{nan:?}"
    );
    assert_eq!(
        faults(&record(30, &[(7, "0.6,1.2,,9")])),
        [(7, Some(8), None, FaultKind::Surplus { cells: 2 })]
    );
    let twice = faults(&record(30, &[(7, "0.5,1.2")]));
    // the reading of 0.6 s is not there: the time twice is told, and the gap after it
    assert_eq!(twice[0], (7, Some(8), time(), FaultKind::Duplicate { of: 6 }));
    assert!(matches!(twice[1..], [(8, Some(9), None, FaultKind::Gap { missing: 1, .. })]), "{twice:?}");
    for wrong in ["0.25", "-3", "1e9", "0.95"] {
        let line = format!("{wrong},1.2");
        assert_eq!(
            faults(&record(30, &[(7, &line)])),
            [(7, Some(8), time(), FaultKind::OutOfOrder)],
            "{wrong}"
        );
    }
}

/// A comment takes up a line and no row, and so does an empty line.
#[test]
fn lines_and_rows_are_counted_apart() {
    let text = record(30, &[(3, "# a comment\n0.2,0.4"), (7, "\n0.6,x")]);
    let told = faults(&text);
    assert_eq!((told[0].0, told[0].1), (7, Some(10)));
    assert_eq!(text.lines().nth(9), Some("0.6,x"));
}

#[test]
fn a_gap_says_how_many_samples_are_missing() {
    let text: Vec<String> = record(30, &[]).lines().map(str::to_owned).collect();
    let without = [&text[..11], &text[14..]].concat().join("\n");
    let told = faults(&without);
    // rows 11, 12 and 13 of the whole record are gone; the eleventh row is now that of 1.3 s
    let [(11, Some(12), None, FaultKind::Gap { step, usual, missing: 3 })] = told[..] else {
        panic!("{told:?}")
    };
    assert!((step - 0.4).abs() < 1e-12 && (usual - 0.1).abs() < 1e-12);
}

/// Steps of 0.04, 0.10 and 0.16 s have a standard deviation of 0.06 sqrt(2/3) s: told of it, the rule lets them pass,
/// and still sees ten samples that are missing.
#[test]
fn a_gap_is_told_from_jitter() {
    let mut text = "time,s1\n".to_owned();
    let mut time = 0.0;
    for row in 0..60 {
        text += &format!("{time:.2},{row}\n");
        time += [0.1, 0.04, 0.16, 0.04, 0.1, 0.16][row % 6] + if row == 40 { 1.0 } else { 0.0 };
    }
    let (_folder, path) = file("record.csv", text);
    let rows = Rows::read(&path, &[]).unwrap();
    let gaps = |jitter: f64| -> Vec<usize> {
        let rules = FaultRules { jitter, spike: f64::INFINITY, ..FaultRules::default() };
        check(&rows, &rules).into_iter().map(|fault| fault.row).collect()
    };
    // of 59 steps every third is of 0.16 s, more than one and a half of the median of 0.10 s; the long one is another
    assert_eq!(gaps(0.0).len(), 20);
    assert_eq!(gaps(0.06 * (2.0f64 / 3.0).sqrt()), [42]);
}

#[test]
fn a_spike_is_told_with_its_row_and_size() {
    let told = faults(&record(40, &[(21, "2.0,9.9")]));
    let [(21, Some(22), Some(column), FaultKind::Spike { value, departure })] = &told[..] else {
        panic!("{told:?}")
    };
    // 5.9 off; a tenth of the usual change of 0.2 is the least usual departure, five readings have the gain sqrt(28/5)
    assert_eq!((column.as_str(), *value), ("s1", 9.9));
    assert!((departure - 5.9 / 0.02 / (28.0f64 / 5.0).sqrt()).abs() < 1e-6, "{departure}");
}

#[test]
fn the_rules_say_whether_faulty_rows_stop_or_are_skipped() {
    let text = record(30, &[(7, "0.6,x"), (9, "0.8,nan"), (12, "0.25,2.2")]);
    let (_folder, path) = file("record.csv", &text);
    let stop = FaultRules::default();
    let error = Record::read_checked(&path, &["s1"], &stop).unwrap_err();
    let RecordError::Faulty { faults, .. } = &error else { panic!("{error}") };
    assert_eq!(faults.iter().map(|f| f.row).collect::<Vec<_>>(), [7, 9, 12]);
    let said = error.to_string();
    assert!(said.contains("has 3 faults"), "{said}");
    assert!(said.contains("row 7 (line 8) at 0.6 s, s1: \"x\" is no number"), "{said}");

    let skip = FaultRules { on_fault: OnFault::Skip, ..stop };
    let reading = Record::read_checked(&path, &["s1"], &skip).unwrap();
    assert_eq!(reading.record.len(), 27);
    assert!(reading.record.times().windows(2).all(|w| w[0] < w[1]));
    assert!(reading.record.column("s1").unwrap().iter().all(|v| v.is_finite()));
    assert_eq!(reading.faults.iter().map(|f| f.row).collect::<Vec<_>>(), [7, 9, 12]);
}

#[test]
fn a_gap_is_reported_and_takes_no_row() {
    let text = "time,s1\n0,0\n1,1\n2,2\n5,5\n6,6\n";
    let (_folder, path) = file("record.csv", text);
    let rules = FaultRules { on_fault: OnFault::Skip, ..FaultRules::default() };
    let reading = Record::read_checked(&path, &[], &rules).unwrap();
    assert_eq!(reading.record.len(), 5);
    assert_eq!(reading.faults.len(), 1);
    assert!(Record::read_checked(&path, &[], &FaultRules::default()).is_err());
}

#[test]
fn columns_that_nobody_asked_for_are_kept_when_they_are_numbers() {
    let (_folder, path) = file("record.csv", "\u{feff}time, s1 ,note,truth\n0,1,good,3\n1,2,,4\n");
    let reading = Record::read_checked(&path, &["s1"], &FaultRules::default()).unwrap();
    assert_eq!(reading.record.names(), ["s1", "truth"]);
    assert_eq!(reading.record.column("truth"), Some([3.0, 4.0].as_slice()));
    assert_eq!(reading.left_out, ["note"]);
}

#[test]
fn files_that_are_no_records_are_refused_in_words() {
    for (name, text, words) in [
        ("a.csv", "", "the file is empty"),
        ("a.csv", "\n\n", "the file is empty"),
        ("a.csv", "time,s1\n", "has no rows"),
        ("a.csv", "time,s2\n0,1\n", "has no column 's1'"),
        ("a.csv", "s1,s2\n0,1\n", "has no column 'time'"),
        ("a.csv", "time;s1\n0;1\n", "has no column 'time'"),
        ("a.csv", "time,s1,s1\n0,1,1\n", "'s1' is there twice"),
        ("a.csv", "time,,s1\n0,1,1\n", "column 2 has no name"),
        ("a.parquet", "", "cannot read"),
        ("a.parquet", "time,s1\n0,1\n", "cannot read"),
        ("a.txt", "time,s1\n0,1\n", "neither a .csv nor a .parquet file"),
    ] {
        let (_folder, path) = file(name, text);
        let said = Record::read(&path, &["s1"]).unwrap_err().to_string();
        assert!(said.contains(words), "{text:?}: {said}");
    }
    let said = Record::read(std::path::Path::new("no/such/record.csv"), &[]).unwrap_err().to_string();
    assert!(said.contains("cannot read no/such/record.csv"), "{said}");
}

#[test]
fn all_rows_at_fault_leave_nothing() {
    let (_folder, path) = file("record.csv", "time,s1\n0,x\n1,y\n");
    let rules = FaultRules { on_fault: OnFault::Skip, ..FaultRules::default() };
    let error = Record::read_checked(&path, &[], &rules).unwrap_err();
    assert!(matches!(error, RecordError::NothingLeft { .. }), "{error}");
}

#[test]
fn a_file_that_cannot_be_written_leaves_nothing_behind() {
    let (folder, path) = file("here", "a file");
    let record = Record::new(vec![0.0], vec![("s1".to_owned(), vec![1.0])]).unwrap();
    assert!(record.write(&path.join("record.csv")).is_err());
    assert!(record.write(&folder.path().join("record.xls")).is_err());
    // names that the format refuses, or a folder in the place of the file
    std::fs::create_dir(folder.path().join("taken.csv")).unwrap();
    assert!(record.write(&folder.path().join("taken.csv")).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_table_of_unlike_columns_is_refused() {
    let column = |name: &str, count: usize| (name.to_owned(), vec![0.0; count]);
    assert!(Record::new(vec![0.0; 3], vec![column("s1", 2)]).is_err());
    assert!(Record::new(vec![0.0; 3], vec![column("s1", 3), column("s1", 3)]).is_err());
    assert!(Record::new(vec![0.0; 3], vec![column("time", 3)]).is_err());
    assert!(Record::new(vec![0.0; 3], vec![column("s1", 3), column("s2", 3)]).is_ok());
}

fn bits(record: &Record) -> Vec<Vec<u64>> {
    let columns = std::iter::once(&record.times).chain(&record.columns);
    columns.map(|column| column.iter().map(|v| v.to_bits()).collect()).collect()
}

fn any_record() -> impl Strategy<Value = Record> {
    (1usize..30, 0usize..4).prop_flat_map(|(rows, columns)| {
        let column = proptest::collection::vec(any::<u64>().prop_map(f64::from_bits), rows);
        proptest::collection::vec(column, columns + 1).prop_map(|mut columns| {
            let times = columns.remove(0);
            let name = |(index, values)| (format!("column, \"{index}\""), values);
            Record::new(times, columns.into_iter().enumerate().map(name).collect()).unwrap()
        })
    })
}

/// A Parquet file of a few rows.
fn parquet_bytes() -> Vec<u8> {
    let (_folder, path) = file("record.parquet", "");
    let values = |by: f64| (0..50).map(|i| by * f64::from(i)).collect::<Vec<f64>>();
    let columns = vec![("s1".to_owned(), values(0.1)), ("s2".to_owned(), values(-3.0))];
    Record::new(values(0.01), columns).unwrap().write(&path).unwrap();
    std::fs::read(&path).unwrap()
}

/// A reader may refuse, but must return.
fn read_somehow(name: &str, bytes: &[u8]) {
    let (_folder, path) = file(name, bytes);
    let _ = Record::read(&path, &[]);
    let _ = Record::read(&path, &["s1"]);
    let rules = FaultRules { on_fault: OnFault::Skip, ..FaultRules::default() };
    let _ = Record::read_checked(&path, &[], &rules);
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

    let rows = Rows::read(&path, &["s1", "s2", "count"]).unwrap();
    let told: Vec<_> =
        check(&rows, &FaultRules::default()).into_iter().map(|f| (f.row, f.column, f.kind)).collect();
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
        prop_assert_eq!(bits(&back), bits(&record));
    }

    #[test]
    fn csv_is_read_back_bit_for_bit(record in any_record()) {
        let (_folder, path) = file("record.csv", "");
        record.write(&path).unwrap();
        let back = Record::read(&path, &[]).unwrap();
        prop_assert_eq!(back.names(), record.names());
        // a NaN has many patterns of bits and one name
        let one_nan = |mut bits: Vec<Vec<u64>>| {
            for bits in bits.iter_mut().flatten().filter(|bits| f64::from_bits(**bits).is_nan()) {
                *bits = f64::NAN.to_bits();
            }
            bits
        };
        prop_assert_eq!(one_nan(bits(&back)), one_nan(bits(&record)));
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read_somehow("record.csv", &bytes);
        read_somehow("record.parquet", &bytes);
        let framed = [b"PAR1", &bytes[..], &(bytes.len() as u32).to_le_bytes(), b"PAR1"].concat();
        read_somehow("record.parquet", &framed);
    }

    #[test]
    fn no_table_makes_the_reader_panic(text in "(time,s1\n)?([0-9.eE+-]{0,4}[,\n\"#]){0,120}") {
        read_somehow("record.csv", text.as_bytes());
    }

    #[test]
    fn no_damage_makes_the_reader_panic(at in any::<prop::sample::Index>(), to in any::<u8>()) {
        let mut bytes = parquet_bytes();
        let at = at.index(bytes.len());
        bytes[at] = to;
        read_somehow("record.parquet", &bytes);
    }

    /// What is left after skipping has finite values at times that increase.
    #[test]
    fn what_is_left_can_be_used(rows in proptest::collection::vec((0u8..40, -3i8..3), 1..60)) {
        let mut text = "time,s1\n".to_owned();
        for (time, value) in rows {
            let value = if value == -3 { "nan".to_owned() } else { value.to_string() };
            text += &format!("{time},{value}\n");
        }
        let (_folder, path) = file("record.csv", text);
        let rules = FaultRules { on_fault: OnFault::Skip, ..FaultRules::default() };
        if let Ok(reading) = Record::read_checked(&path, &[], &rules) {
            prop_assert!(reading.record.times().windows(2).all(|w| w[0] < w[1]));
            prop_assert!(reading.record.column("s1").unwrap().iter().all(|v| v.is_finite()));
        }
    }
}
