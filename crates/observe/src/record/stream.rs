//! Comma-separated values that arrive piece by piece: rows are judged as those of a file are, as soon as those after them are there that a
//! judgement needs; what is kept of them is bounded.

use super::columns::ColumnPlan;
use super::comma_separated::{BYTE_ORDER_MARK, COMMENT, cell, line_number, names};
use super::rows::{judged, twice};
use super::stamps::Stamps;
use super::table::Row;
use super::{
    Cell, ColumnNames, EmptyCells, Fault, FaultKind, FaultRules, OnFault, RecordError, RecordRows, STREAM,
    check::faults_of,
};
use csv::{ReaderBuilder, Trim};
use std::path::{Path, PathBuf};

/// A line of more bytes has no end.
const LONGEST_LINE: usize = 1 << 20;

/// A row is judged by so many after it, and by so many before it.
const BESIDE: usize = 16;

/// So many rows are judged at once at most.
const MOST_AT_ONCE: usize = 4096;

/// A row that can be used: its time, and the values of the needed columns.
#[derive(Clone, Debug, PartialEq)]
pub struct GoodRow {
    pub time: f64,
    pub values: Vec<f64>,
}

/// Rows that arrive.
#[derive(Debug)]
pub struct RowStream {
    path: PathBuf,
    columns: ColumnNames,
    needed: Vec<String>,
    rules: FaultRules,
    /// The first part of a line whose end has not arrived.
    rest: Vec<u8>,
    /// Lines that have arrived.
    lines: u64,
    plan: Option<(ColumnPlan, Vec<usize>)>,
    /// The header has arrived, and rows that are judged and those that are not, in a row.
    rows: Vec<Row>,
    /// So many of the rows are judged.
    judged: usize,
    /// So many rows stand before those that are kept.
    before: usize,
    last_time: f64,
    /// From when on times are counted that are dates.
    stamps: Stamps,
}

impl RowStream {
    /// A stream of rows that has read nothing yet.
    pub fn new(columns: ColumnNames, needed: Vec<String>, mut rules: FaultRules) -> RowStream {
        // what lies between this value and the next is not known before that is there
        rules.empty.retain(|_, empty| *empty == EmptyCells::NotMeasured);
        RowStream {
            path: Path::new(STREAM).to_owned(),
            columns,
            needed,
            rules,
            rest: Vec::new(),
            lines: 0,
            plan: None,
            rows: Vec::new(),
            judged: 0,
            before: 0,
            last_time: f64::NEG_INFINITY,
            stamps: Stamps::default(),
        }
    }

    /// The needed columns, in the order of [`GoodRow::values`]; none before the header has arrived.
    pub fn names(&self) -> Option<Vec<String>> {
        let (plan, judged) = self.plan.as_ref()?;
        Some(judged[1..].iter().map(|place| plan.names[*place].clone()).collect())
    }

    /// The first time as it was written, where times are dates.
    pub fn began(&self) -> Option<&str> {
        self.stamps.began()
    }

    /// How many rows have arrived.
    pub fn arrived(&self) -> usize {
        self.before + self.rows.len()
    }

    /// How many rows have arrived and are not judged.
    pub fn waiting(&self) -> usize {
        self.rows.len() - self.judged
    }

    /// Takes bytes as they arrive.
    ///
    /// # Errors
    /// The header cannot be used, or a line has no end.
    pub fn take(&mut self, bytes: &[u8]) -> Result<(), RecordError> {
        self.rest.extend_from_slice(bytes);
        let Some(end) = self.rest.iter().rposition(|byte| *byte == b'\n') else {
            if self.rest.len() <= LONGEST_LINE {
                return Ok(());
            }
            let why = format!("line {} has more than {LONGEST_LINE} bytes", self.lines + 1);
            let help = Some("a row is a line; is it text?".to_owned());
            return Err(RecordError::Unreadable { path: self.path.clone(), why, help });
        };
        let rest = self.rest.split_off(end + 1);
        let whole = std::mem::replace(&mut self.rest, rest);
        self.take_lines(&whole)
    }

    fn take_lines(&mut self, mut bytes: &[u8]) -> Result<(), RecordError> {
        if self.lines == 0 {
            bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        }
        let first = self.lines;
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .comment(Some(COMMENT))
            .from_reader(bytes);
        let mut line = csv::ByteRecord::new();
        loop {
            let unreadable = |error: csv::Error| RecordError::Unreadable {
                path: self.path.clone(),
                why: error.to_string(),
                help: None,
            };
            if !reader.read_byte_record(&mut line).map_err(unreadable)? {
                break;
            }
            let Some((plan, places)) = &self.plan else {
                let names = names(&line, &self.path)?;
                twice(&self.path, &names)?;
                let plan = self.columns.plan(&self.path, &names)?;
                let needed: Vec<&str> = self.needed.iter().map(String::as_str).collect();
                let places = judged(&self.path, &plan, &needed)?;
                self.plan = Some((plan, places));
                continue;
            };
            let columns = plan.width();
            let cells = (0..columns).map(|i| cell(line.get(i).unwrap_or_default())).collect();
            let number = line.position().map(|at| first + line_number(bytes, at));
            let surplus = line.len().saturating_sub(columns);
            let is_short = line.len() < columns;
            let mut row = plan.row(Row { line: number, cells, surplus, is_short });
            self.stamps.count(&mut row, places[0]);
            if self.stamps.began().is_some() {
                plan.takes_dates(&self.path, places[0])?;
            }
            self.rows.push(row);
        }
        self.lines += bytes.iter().filter(|byte| **byte == b'\n').count() as u64;
        Ok(())
    }

    /// What is wrong with a last line that has no end; nothing where there is none. It may be cut off in the middle of a number, and is no row.
    pub fn cut_off(&self) -> Option<String> {
        let is_row = self.rest.iter().any(|byte| !byte.is_ascii_whitespace());
        is_row.then(|| format!("line {} has no end: it may be cut off, and is left out", self.lines + 1))
    }

    /// What faults of rows do.
    pub fn on_fault(&self) -> OnFault {
        self.rules.on_fault
    }

    /// Whether a header has arrived.
    pub fn has_header(&self) -> bool {
        self.plan.is_some()
    }

    /// Judges rows that have arrived; hands on those that can be used, at most about as many as are `wanted`, and what is wrong with the others. Rows
    /// are judged when those after them are there, or at the end. Where the rules say to stop, the rows before the first fault are handed on.
    pub fn judge(&mut self, wanted: usize, is_end: bool) -> (Vec<GoodRow>, Vec<Fault>) {
        let after = if is_end { 0 } else { BESIDE };
        let most = wanted.clamp(1, MOST_AT_ONCE);
        let Some((plan, needed)) = &self.plan else { return (Vec::new(), Vec::new()) };
        if self.waiting() < if is_end { 1 } else { most + after } {
            return (Vec::new(), Vec::new());
        }
        let end = (self.judged + most).min(self.rows.len() - after);
        let looked_at = (end + BESIDE).min(self.rows.len());
        let rest = self.rows.split_off(looked_at);
        let rows = RecordRows {
            path: self.path.clone(),
            names: plan.names.clone(),
            shown: plan.shown.clone(),
            rows: std::mem::take(&mut self.rows),
            needed: needed.clone(),
            before: self.before,
            began: None,
        };
        let first = self.before + self.judged;
        let is_here = |fault: &Fault| (first..self.before + end).contains(&(fault.row - 1));
        let mut faults: Vec<Fault> = faults_of(&rows, &self.rules).into_iter().filter(is_here).collect();
        let mut good = Vec::new();
        for place in self.judged..end {
            let number = self.before + place + 1;
            let own = || faults.iter().filter(|fault| fault.row == number);
            if self.rules.on_fault == OnFault::Stop && own().next().is_some() {
                break;
            }
            if own().any(Fault::takes_its_row) {
                continue;
            }
            let value = |column: &usize| match rows.rows[place].cells.get(*column) {
                Some(Cell::Missing) if self.rules.empty.contains_key(&rows.names[*column]) => Some(f64::NAN),
                cell => cell.and_then(Cell::finite),
            };
            let mut values = needed.iter().map(value);
            let Some(time) = values.next().flatten() else { continue };
            // what was judged before is not looked at again
            if time <= self.last_time {
                let same = time == self.last_time;
                let kind = if same { FaultKind::Duplicate { of: number - 1 } } else { FaultKind::OutOfOrder };
                faults.push(rows.fault(place, Some(needed[0]), kind));
                if self.rules.on_fault == OnFault::Stop {
                    break;
                }
                continue;
            }
            if let Some(values) = values.collect() {
                self.last_time = time;
                good.push(GoodRow { time, values });
            }
        }
        faults.sort_by_key(|fault| fault.row);
        if self.rules.on_fault == OnFault::Stop {
            faults.truncate(1);
        }
        // some rows stay, by which the next are judged
        self.rows = rows.rows;
        self.rows.extend(rest);
        let gone = end.saturating_sub(BESIDE);
        self.rows.drain(..gone);
        self.before += gone;
        self.judged = end - gone;
        (good, faults)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(on_fault: OnFault) -> RowStream {
        let rules = FaultRules { on_fault, ..FaultRules::default() };
        RowStream::new(ColumnNames::default(), vec!["x".to_owned()], rules)
    }

    /// Whatever pieces they arrive in all rows are handed on once and in order, and no more are kept than are judged at once with those
    /// beside them.
    #[test]
    fn rows_pass_through_and_are_not_kept() {
        let text: String = (0..9000).map(|i| format!("{}.0,{}\n", i, f64::from(i) / 8.0)).collect();
        let text = format!("# a comment\ntime,x\n{text}");
        for (piece, wanted) in [(7, 100), (4096, 100), (100_000, 1_000_000)] {
            let (mut rows, mut found, mut most) = (stream(OnFault::Stop), Vec::new(), 0);
            for bytes in text.as_bytes().chunks(piece) {
                rows.take(bytes).unwrap();
                loop {
                    let (good, faults) = rows.judge(wanted, false);
                    assert!(faults.is_empty(), "{faults:?}");
                    if good.is_empty() {
                        break;
                    }
                    found.extend(good);
                }
                most = most.max(rows.rows.len());
            }
            let arrives_at_once = piece / 4;
            assert!(most <= wanted.min(MOST_AT_ONCE) + 2 * BESIDE + arrives_at_once, "{most}");
            while rows.waiting() > 0 {
                found.extend(rows.judge(wanted, true).0);
            }
            assert_eq!((found.len(), rows.arrived()), (9000, 9000));
            let is_whole =
                |(i, row): (usize, &GoodRow)| row.time == i as f64 && row.values == [i as f64 / 8.0];
            assert!(found.iter().enumerate().all(is_whole));
            assert_eq!(rows.cut_off(), None);
        }
    }

    /// Times that begin again are no rows, however many they are.
    #[test]
    fn what_was_judged_is_not_judged_again() {
        let line = |i: i32| format!("{i},1\n");
        let text: String = (0..60).chain(20..90).map(line).collect();
        let mut rows = stream(OnFault::Skip);
        rows.take(format!("time,x\n{text}").as_bytes()).unwrap();
        let (mut found, mut faults) = (Vec::new(), Vec::new());
        while rows.waiting() > 0 {
            let (good, wrong) = rows.judge(25, true);
            found.extend(good.into_iter().map(|row| row.time));
            faults.extend(wrong);
        }
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
        assert_eq!((found[0], found[found.len() - 1]), (0.0, 89.0));
        assert!(faults.iter().all(|fault| fault.line.is_some()) && faults.len() >= 30, "{}", faults.len());
    }
}
