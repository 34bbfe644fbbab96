//! Looks for what is wrong with the rows of a file.

use super::spike::spikes;
use super::{Cell, Fault, FaultKind, FaultRules, MOST_FAULTS, OnFault, ReadRecord, RecordError, RecordRows};
use crate::Interpolation;
use std::collections::BTreeSet;

impl RecordRows {
    /// Looks for faults and does with them what the rules say.
    ///
    /// # Errors
    /// There is a fault and the rules say to stop; or no row is left.
    pub fn settle(self, rules: &FaultRules) -> Result<ReadRecord, RecordError> {
        let faults = faults_of(&self, rules);
        // of what has so many faults not all are known
        if rules.on_fault == OnFault::Stop && !faults.is_empty() || faults.len() > MOST_FAULTS {
            return Err(RecordError::Faulty { path: self.path, faults });
        }
        let skipped: BTreeSet<usize> = faults.iter().filter(|f| f.takes_its_row()).map(|f| f.row).collect();
        if skipped.len() == self.rows.len() {
            return Err(RecordError::NothingLeft { path: self.path, faults });
        }
        let began = self.began.clone();
        let may_lack = |name: &str| rules.empty.contains_key(name);
        let (record, left_out) = self.numbers(|row| !skipped.contains(&row), may_lack);
        let settled = record.settle(rules);
        let (record, sparse, outside) =
            settled.map_err(|column| RecordError::NotMeasured { path: self.path, column })?;
        Ok(ReadRecord { record, faults, left_out, sparse, began, outside })
    }
}

/// All that is wrong with a record, in the order of its rows.
///
/// Cells of needed columns have to hold finite numbers. Times have to increase: as few rows as possible are blamed
/// when they do not, and among equals the later ones. A step in time of more than `1.5 * usual + 3 * jitter`, where
/// `usual` is the median step, is a gap; rows in between whose times cannot be used count as usual steps. What a
/// spike is stands at the head of `spike.rs`. Of more than [`MOST_FAULTS`] the rest is left out.
pub fn faults_of(rows: &RecordRows, rules: &FaultRules) -> Vec<Fault> {
    let room = |faults: &Vec<Fault>| (MOST_FAULTS + 1).saturating_sub(faults.len());
    let mut faults = unreadable(rows, rules);
    let cells = rows.rows.iter().enumerate().flat_map(|(row, place)| {
        rows.needed.iter().map(move |column| (row, *column, place.cells.get(*column)))
    });
    let infinite = cells.filter_map(|(row, column, cell)| match cell {
        Some(Cell::Number(value)) if !value.is_finite() => {
            Some(rows.fault(row, Some(column), FaultKind::NotFinite { value: *value }))
        }
        _ => None,
    });
    let left = room(&faults);
    faults.extend(infinite.take(left));
    let time = |row: usize| rows.rows[row].cells.get(rows.needed[0]).and_then(Cell::finite);
    let timed: Vec<(usize, f64)> = (0..rows.rows.len()).filter_map(|row| Some((row, time(row)?))).collect();
    let order = Order::of(&timed);
    let times = gaps(&order, rules.jitter).into_iter().map(|(row, kind)| rows.fault(row, None, kind));
    let left = room(&faults);
    faults.extend(times.take(left));
    let blamed = order.blamed.into_iter().map(|(row, kind)| rows.fault(row, Some(rows.needed[0]), kind));
    let left = room(&faults);
    faults.extend(blamed.take(left));
    for &column in &rows.needed[1..] {
        let resolution = rules.resolution.get(&rows.names[column]).copied().unwrap_or(0.0);
        let value = |row: usize| rows.rows[row].cells.get(column).and_then(Cell::finite);
        // where a row has too many cells its values stand in other columns than their own
        let whole = order.kept.iter().filter(|(row, _)| rows.rows[*row].surplus == 0);
        let points: Vec<(usize, f64, f64)> =
            whole.filter_map(|(row, time)| Some((*row, *time, value(*row)?))).collect();
        let series: Vec<(f64, f64)> = points.iter().map(|(_, time, value)| (*time, *value)).collect();
        let spike = |(index, departure): (usize, f64)| {
            let (row, _, value) = points[index];
            rows.fault(row, Some(column), FaultKind::Spike { value, departure })
        };
        let left = room(&faults);
        let is_held = rules.interpolation == Interpolation::Hold;
        faults.extend(spikes(&series, rules.spike, resolution, is_held).into_iter().map(spike).take(left));
    }
    faults.sort_by_key(|fault| fault.row);
    faults
}

/// The faults for which a row is no row of numbers at all.
pub(super) fn unreadable(rows: &RecordRows, rules: &FaultRules) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (row, place) in rows.rows.iter().enumerate() {
        if faults.len() > MOST_FAULTS {
            break;
        }
        if place.surplus > 0 {
            faults.push(rows.fault(row, None, FaultKind::Surplus { cells: place.surplus }));
        }
        for &column in &rows.needed {
            let kind = match place.cells.get(column) {
                Some(Cell::Number(_)) => continue,
                // a row that was cut off is no row in which something was not measured
                Some(Cell::Missing) if !place.is_short && rules.empty.contains_key(&rows.names[column]) => {
                    continue;
                }
                Some(Cell::Unreadable(says)) => FaultKind::NotANumber { says: says.clone() },
                Some(Cell::Missing) | None => FaultKind::Missing,
            };
            faults.push(rows.fault(row, Some(column), kind));
        }
    }
    faults
}

/// The rows whose times increase, and those that are blamed when not all do.
struct Order {
    kept: Vec<(usize, f64)>,
    blamed: Vec<(usize, FaultKind)>,
}

impl Order {
    /// Keeps the longest increasing sequence of times, and among equally long ones that of the earliest rows: a single
    /// wrong time, too early or too late, is then blamed alone.
    fn of(timed: &[(usize, f64)]) -> Order {
        // heads[k - 1] is the latest time at which a sequence of length k can begin, negated so as to increase
        let (mut heads, mut lengths) = (Vec::<f64>::new(), vec![0; timed.len()]);
        for (index, (_, time)) in timed.iter().enumerate().rev() {
            let length = heads.partition_point(|head| *head < -time);
            match heads.get_mut(length) {
                Some(head) => *head = -time,
                None => heads.push(-time),
            }
            lengths[index] = length + 1;
        }
        let mut order = Order { kept: Vec::new(), blamed: Vec::new() };
        let mut left = heads.len();
        for (&(row, time), length) in timed.iter().zip(lengths) {
            if length == left && order.kept.last().is_none_or(|(_, last)| *last < time) {
                order.kept.push((row, time));
                left -= 1;
            } else {
                let same = order.kept.iter().rev().take_while(|(_, t)| *t >= time).find(|(_, t)| *t == time);
                let kind = same.map_or(FaultKind::OutOfOrder, |(of, _)| FaultKind::Duplicate { of: of + 1 });
                order.blamed.push((row, kind));
            }
        }
        order
    }
}

/// The steps in time that are too long. A row that is there but whose time is wrong or cannot be read stands for one
/// usual step.
fn gaps(order: &Order, jitter: f64) -> Vec<(usize, FaultKind)> {
    let repeated: BTreeSet<usize> = order
        .blamed
        .iter()
        .filter(|(_, kind)| matches!(kind, FaultKind::Duplicate { .. }))
        .map(|(row, _)| *row)
        .collect();
    let between =
        |from: usize, to: usize| (from + 1..to).filter(|row| !repeated.contains(row)).count() as f64;
    let pairs = || order.kept.windows(2).map(|pair| (pair[0], pair[1]));
    let mut sorted: Vec<f64> = pairs().map(|((_, from), (_, to))| to - from).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(&usual) = sorted.get(sorted.len() / 2) else { return Vec::new() };
    let gap = |((from_row, from), (row, to)): ((usize, f64), (usize, f64))| {
        let step = to - from;
        let unfilled = step - between(from_row, row) * usual;
        let missing = ((unfilled / usual).round() as u64).saturating_sub(1).max(1);
        let kind = FaultKind::Gap { step, usual, missing };
        (unfilled > 1.5 * usual + 3.0 * jitter).then_some((row, kind))
    };
    pairs().filter_map(gap).collect()
}
