//! What is written is read back, and no file makes the reader panic.

use super::*;
use proptest::prelude::*;

pub(super) fn bits(record: &Record) -> Vec<Vec<u64>> {
    let columns = std::iter::once(&record.times).chain(&record.columns);
    columns.map(|column| column.iter().map(|v| v.to_bits()).collect()).collect()
}

/// A NaN has many patterns of bits and one meaning: nothing was measured.
pub(super) fn one_nan(mut bits: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
    for bits in bits.iter_mut().flatten().filter(|bits| f64::from_bits(**bits).is_nan()) {
        *bits = f64::NAN.to_bits();
    }
    bits
}

pub(super) fn any_record() -> impl Strategy<Value = Record> {
    (1usize..30, 0usize..4).prop_flat_map(|(rows, columns)| {
        let column = proptest::collection::vec(any::<u64>().prop_map(f64::from_bits), rows);
        proptest::collection::vec(column, columns + 1).prop_map(|mut columns| {
            let times = columns.remove(0);
            let name = |(index, values)| (format!("column, \"{index}\""), values);
            Record::new(times, columns.into_iter().enumerate().map(name).collect()).unwrap()
        })
    })
}

/// A reader may refuse, but must return.
pub(super) fn read_somehow(name: &str, bytes: &[u8]) {
    let (_folder, path) = file(name, bytes);
    let _ = Record::read(&path, &[]);
    let _ = Record::read(&path, &["s1"]);
    let rules = FaultRules { on_fault: OnFault::Skip, ..FaultRules::default() };
    let _ = Record::read_checked(&path, &[], &rules);
}

proptest! {
    #[test]
    fn csv_is_read_back_bit_for_bit(record in any_record()) {
        let (_folder, path) = file("record.csv", "");
        record.write(&path).unwrap();
        let back = Record::read(&path, &[]).unwrap();
        prop_assert_eq!(back.names(), record.names());
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
