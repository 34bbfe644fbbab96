//! Times that are written as dates, as loggers do: counted in seconds from the first of them.

use super::table::{Cell, Row};
use chrono::{DateTime, NaiveDateTime};

/// Dates without a time zone, as they are written.
const LOCAL: [&str; 4] =
    ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f", "%Y/%m/%d %H:%M:%S%.f", "%d.%m.%Y %H:%M:%S%.f"];

/// A moment, in nanoseconds since 1970, and whether a time zone was said: one without is of no other clock than its own file's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Moment {
    nanoseconds: i64,
    has_zone: bool,
}

/// The moment that a text states.
fn moment(text: &str) -> Option<Moment> {
    // a blank in the place of the T, as databases write it, is accepted as well
    if let Ok(found) = DateTime::parse_from_rfc3339(text) {
        return Some(Moment { nanoseconds: found.timestamp_nanos_opt()?, has_zone: true });
    }
    let found = LOCAL.iter().find_map(|format| NaiveDateTime::parse_from_str(text, format).ok())?;
    Some(Moment { nanoseconds: found.and_utc().timestamp_nanos_opt()?, has_zone: false })
}

/// From when on dates are counted: the first one, as it was written.
#[derive(Clone, Debug, Default)]
pub(super) struct Stamps {
    first: Option<(Moment, String)>,
    /// Whether a time was a number: then dates are none.
    are_numbers: bool,
}

impl Stamps {
    /// The first date, as it was written; none where times are numbers.
    pub fn began(&self) -> Option<&str> {
        self.first.as_ref().map(|(_, text)| text.as_str())
    }

    /// A row whose time, in a column, is a number of seconds since the first date, where it is a date. What is no date, or of another kind than the first, stays what it is.
    pub fn count(&mut self, row: &mut Row, column: usize) {
        let Some(cell) = row.cells.get_mut(column) else { return };
        match cell {
            Cell::Number(_) => self.are_numbers |= self.first.is_none(),
            Cell::Unreadable(text) if !self.are_numbers => {
                let Some(own) = moment(text) else { return };
                let (first, _) = self.first.get_or_insert_with(|| (own, text.clone()));
                if first.has_zone == own.has_zone {
                    let apart = i128::from(own.nanoseconds) - i128::from(first.nanoseconds);
                    *cell = Cell::Number(apart as f64 / 1e9);
                }
            }
            Cell::Unreadable(_) | Cell::Missing => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(texts: &[&str]) -> (Vec<Cell>, Option<String>) {
        let mut stamps = Stamps::default();
        let cells = texts.iter().map(|text| {
            let cell = text.parse().map_or_else(|_| Cell::Unreadable((*text).to_owned()), Cell::Number);
            let mut row = Row { line: None, cells: vec![cell], surplus: 0, is_short: false };
            stamps.count(&mut row, 0);
            row.cells.remove(0)
        });
        let cells = cells.collect();
        (cells, stamps.began().map(str::to_owned))
    }

    fn numbers(texts: &[&str]) -> Vec<f64> {
        counted(texts).0.iter().filter_map(Cell::finite).collect()
    }

    /// Over the turn of a leap year's February, with another zone's hour, to a nanosecond.
    #[test]
    fn dates_are_counted_from_the_first() {
        let zoned = [
            "2024-02-28T23:59:59.5Z",
            "2024-02-29T00:00:00.000000001Z",
            "2024-03-01T02:00:00+02:00",
            "2024-02-28 23:59:59.5Z",
        ];
        assert_eq!(numbers(&zoned), [0.0, 0.500000001, 86400.5, 0.0]);
        for local in [
            ["2026-11-28T10:00:00", "2026-11-28T10:00:00.25"],
            ["2026-11-28 10:00:00", "2026-11-28 10:00:00.25"],
            ["2026/11/28 10:00:00", "2026/11/28 10:00:00.25"],
            ["28.11.2026 10:00:00", "28.11.2026 10:00:00.25"],
        ] {
            assert_eq!(numbers(&local), [0.0, 0.25]);
            assert_eq!(counted(&local).1.as_deref(), Some(local[0]));
        }
    }

    /// A text, a number among dates before any, a date among numbers and one of another kind stay what they are.
    #[test]
    fn what_is_no_date_stays() {
        let (cells, began) = counted(&["1.5", "2026-11-28T10:00:00Z"]);
        assert!(began.is_none() && matches!(cells[1], Cell::Unreadable(_)));
        let (cells, _) =
            counted(&["2026-11-28T10:00:00Z", "2026-11-28T10:00:01", "soon", "2026-13-28T10:00:00Z"]);
        assert!(cells[1..].iter().all(|cell| matches!(cell, Cell::Unreadable(_))));
        // years that nanoseconds do not reach
        assert!(numbers(&["9999-01-01T00:00:00Z", "0001-01-01T00:00:00Z"]).is_empty());
    }
}
