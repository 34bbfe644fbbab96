mod files;
#[cfg(feature = "parquet")]
mod parquet_files;

use super::*;
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
    let rows = RecordRows::read(&path, &[]).unwrap();
    let told = faults_of(&rows, &FaultRules::default());
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
    // the measurement of 0.6 s is not there: the repeated time is reported, and the gap after it
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

/// Steps of 0.04, 0.10 and 0.16 s have a standard deviation of 0.06 sqrt(2/3) s: given it, the rule lets them pass,
/// and still finds ten missing samples.
#[test]
fn a_gap_is_told_from_jitter() {
    let mut text = "time,s1\n".to_owned();
    let mut time = 0.0;
    for row in 0..60 {
        text += &format!("{time:.2},{row}\n");
        time += [0.1, 0.04, 0.16, 0.04, 0.1, 0.16][row % 6] + if row == 40 { 1.0 } else { 0.0 };
    }
    let (_folder, path) = file("record.csv", text);
    let rows = RecordRows::read(&path, &[]).unwrap();
    let gaps = |jitter: f64| -> Vec<usize> {
        let rules = FaultRules { jitter, spike: f64::INFINITY, ..FaultRules::default() };
        faults_of(&rows, &rules).into_iter().map(|fault| fault.row).collect()
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
    // 5.9 off; a tenth of the usual change of 0.2 is the least usual departure, five measurements have the gain sqrt(28/5)
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
        #[cfg(feature = "parquet")]
        ("a.parquet", "", "cannot read"),
        #[cfg(feature = "parquet")]
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
