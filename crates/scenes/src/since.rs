//! Recordings whose times are counted from a distant origin, or are too near to each other to be distinguished.

use super::scene::{Scene, SceneError};
use palmistry_observe::Record;

/// Times are counted from the first sample where its time exceeds this many durations of the recording.
const LONG_AGO: f64 = 1000.0;

/// The least step between two samples, in units of the last digit of their times.
const FEWEST_DIGITS: f64 = 100.0;

/// Two samples nearer than this fraction of the usual step are one.
const NEAREST: f64 = 1e-6;

/// The origin from which times are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Since {
    /// In s.
    pub origin: f64,
}

impl Since {
    /// The time of the first sample of a record where that is far from zero; else zero.
    pub fn first(record: &Record) -> Since {
        let origin = match record.times() {
            [first, .., last] if first.abs() > LONG_AGO * (last - first) => *first,
            // a single sample has no duration that its time could be compared with
            _ => 0.0,
        };
        Since { origin }
    }

    /// The record with its times counted from there.
    ///
    /// # Errors
    /// Where the times have too few digits for the steps between them, or two samples have nearly one time.
    pub fn count(&self, scene: &Scene, record: Record) -> Result<Record, SceneError> {
        let refuse =
            |message: String, help: &str| scene.error_at("data", message, "these measurements", help);
        let times = record.times();
        let mut steps: Vec<(usize, f64)> =
            times.windows(2).map(|pair| pair[1] - pair[0]).enumerate().collect();
        steps.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (Some((row, least)), Some((_, usual))) = (steps.first(), steps.get(steps.len() / 2)) else {
            return Ok(record);
        };
        let digit = self.origin.abs() * f64::EPSILON;
        if *usual < FEWEST_DIGITS * digit {
            let message = format!(
                "times near {:e} s are given to {digit:.0e} s, and samples are {usual:.0e} s apart",
                self.origin
            );
            return Err(refuse(
                message,
                "count the times from the first sample, before they are written down",
            ));
        }
        if *least < NEAREST * usual {
            let message = format!(
                "the samples in rows {} and {} are {least:.0e} s apart, usual are {usual:.0e} s: no curve runs through both",
                row + 1,
                row + 2
            );
            return Err(refuse(message, "leave one of the two out"));
        }
        if self.origin == 0.0 {
            return Ok(record);
        }
        // the difference of two times of a similar size has no rounding
        let counted = times.iter().map(|time| time - self.origin).collect();
        let columns =
            record.names().iter().filter_map(|name| Some((name.clone(), record.column(name)?.to_vec())));
        let columns = columns.collect();
        Record::new(counted, columns).map_err(|error| refuse(error.to_string(), ""))
    }
}
