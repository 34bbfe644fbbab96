//! `--no-times`: what is printed depends on neither the clock nor the number of threads, to the last byte.

use crate::common::{folder, json, palmistry, with_threads, write};
use crate::process::{SMALL, words};
use serde_json::Value;

/// Inputs, and a parameter with two values.
const MOVED: &str = "system \"moved\"\nstate x, y, k\ninput g\n  x' = 1\n  others' = 0\ninput h\n  y' = k^2\n  others' = 0\n\
                     output x, y\nsample x in [1/2, 1] y in [1/2, 1] k in [1, 2]\n";

/// Whether an object has a number of seconds anywhere.
fn has_seconds(found: &Value) -> bool {
    match found {
        Value::Object(fields) => fields
            .iter()
            .any(|(name, value)| name.contains("seconds") && value.is_number() || has_seconds(value)),
        Value::Array(items) => items.iter().any(has_seconds),
        _ => false,
    }
}

/// Whether a line ends in a number of seconds.
fn has_time(text: &str) -> bool {
    text.lines().any(|line| {
        let before = line.strip_suffix(" s").unwrap_or_default();
        before.ends_with(|sign: char| sign.is_ascii_digit())
    })
}

#[test]
fn no_kind_of_rank_tells_times() {
    let folder = folder();
    let (small, moved) = (write(&folder, "small.proof", SMALL), write(&folder, "moved.proof", MOVED));
    let (small, moved) = (small.to_str().unwrap(), moved.to_str().unwrap());
    for run in [
        &["rank", small, "--samples", "20", "--details"] as &[&str],
        &["rank", moved, "--global"],
        &["rank", moved, "--functions"],
        &["rank", small, "--singular-set"],
        &["rank", moved, "--accessible", "--samples", "20"],
        &["rank", moved, "--global", "--accessible", "--samples", "20"],
        &["rank", small, "--global", "--singular-set"],
    ] {
        let run = [run, &["--no-times"]].concat();
        let as_json = [&run[..], &["--json"]].concat();
        let (one, four) = (with_threads(&run, Some("1")), with_threads(&run, Some("4")));
        assert_eq!(one.status.code(), Some(0), "{run:?}: {}", words(&one));
        assert_eq!(one.stdout, four.stdout, "{run:?}");
        assert!(!has_time(&String::from_utf8_lossy(&one.stdout)), "{run:?}: {}", words(&one));
        let (one, four) = (with_threads(&as_json, Some("1")), with_threads(&as_json, Some("4")));
        assert_eq!(one.stdout, four.stdout, "{run:?}");
        assert!(!has_seconds(&json(&one)), "{run:?}: {}", words(&one));
        // and without the option they are told, so that this test has something to find
        let timed =
            palmistry(&as_json.iter().copied().filter(|word| *word != "--no-times").collect::<Vec<_>>());
        assert!(has_seconds(&json(&timed)), "{run:?}: {}", words(&timed));
    }
}
