//! Arriving rows: checked for faults, and kept until their window is observed.

use super::events::{StreamEnd, StreamPiece};
use crate::groundwork::{Groundwork, Steady};
use crate::run::{Experiment, unusable};
use crate::scene::{Scene, SceneError};
use palmistry_observe::{Fault, OnFault, ReadRecord, Record, RecordError, RowStream, STREAM};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// The number of rows beside a window that its curves need.
pub const MARGIN: usize = 4;

/// Rows that are checked, and not yet given away.
#[derive(Default)]
pub struct Buffer {
    pub times: Vec<f64>,
    pub columns: Vec<Vec<f64>>,
    /// The index of the first row of the next window; the curves of the window need those before.
    pub first: usize,
    /// This many rows before it are used again with it.
    pub again: usize,
}

impl Buffer {
    /// The number of rows from the next window on.
    pub fn waiting(&self) -> usize {
        self.times.len() - self.first
    }

    /// Drops rows that no curve needs any more.
    pub fn drop_before(&mut self) {
        let gone = self.first.saturating_sub(MARGIN + self.again);
        self.times.drain(..gone);
        self.columns.iter_mut().for_each(|column| drop(column.drain(..gone)));
        self.first -= gone;
    }
}

pub const INTERRUPTED: &str = "interrupted";

/// Rows that arrive and go into the buffer.
pub struct Arriving<'a> {
    pub rows: RowStream,
    pub next: &'a mut dyn FnMut() -> StreamPiece,
    pub interrupt: &'a AtomicBool,
    pub buffer: Buffer,
    pub end: StreamEnd,
    /// Since the last report.
    pub faults: Vec<Fault>,
    pub is_over: bool,
}

impl Arriving<'_> {
    /// Waits until a window is there with the rows after it that its curves need, or there is no more.
    pub fn fill(&mut self, scene: &Scene, window: usize) -> Result<(), SceneError> {
        let refuse = |error: RecordError| unusable(scene, &error);
        loop {
            let wanted = (window + MARGIN).saturating_sub(self.buffer.waiting());
            if wanted == 0 || self.end.fault.is_some() {
                return Ok(());
            }
            self.judge(wanted);
            if (window + MARGIN) <= self.buffer.waiting() || self.is_over || self.end.fault.is_some() {
                if self.is_over
                    && self.rows.waiting() > 0
                    && self.end.fault.is_none()
                    && self.buffer.waiting() < window + MARGIN
                {
                    continue;
                }
                return Ok(());
            }
            if self.interrupt.load(Ordering::Relaxed) {
                self.end.cut_off = Some(INTERRUPTED.to_owned());
                self.is_over = true;
                continue;
            }
            match (self.next)() {
                StreamPiece::Bytes(bytes) => self.rows.take(&bytes).map_err(refuse)?,
                StreamPiece::Nothing => {}
                StreamPiece::End => self.is_over = true,
                StreamPiece::Broken(why) => {
                    self.end.cut_off = Some(why);
                    self.is_over = true;
                }
            }
            if self.is_over {
                if self.end.cut_off.is_none() {
                    self.end.cut_off = self.rows.cut_off();
                }
                if !self.rows.has_header() && self.end.cut_off.is_none() {
                    let path = Path::new(STREAM).to_owned();
                    return Err(refuse(RecordError::NoRows { path }));
                }
            }
        }
    }

    fn judge(&mut self, wanted: usize) {
        let (good, faults) = self.rows.judge(wanted, self.is_over);
        if let Some(names) = self.rows.names().filter(|_| self.buffer.columns.is_empty()) {
            self.buffer.columns = vec![Vec::new(); names.len()];
        }
        for row in good {
            self.buffer.times.push(row.time);
            for (column, value) in self.buffer.columns.iter_mut().zip(row.values) {
                column.push(value);
            }
        }
        self.end.faults += faults.len();
        let stops = self.rows.on_fault() == OnFault::Stop;
        if let Some(first) = faults.first().filter(|_| stops) {
            self.end.fault = Some(format!("{STREAM}: {first}"));
            self.is_over = true;
        }
        self.faults.extend(faults);
    }

    /// The experiment with the measurements of the next window.
    pub fn experiment(
        &self,
        ground: Groundwork,
        window: usize,
        steady: Steady,
    ) -> Result<Experiment, SceneError> {
        let names = self.rows.names().unwrap_or_default();
        let rows = self.buffer.first..self.buffer.first + window.min(self.buffer.waiting());
        let columns = self.buffer.columns.iter().map(|column| column[rows.clone()].to_vec());
        let record =
            Record::new(self.buffer.times[rows.clone()].to_vec(), names.into_iter().zip(columns).collect());
        let record = record.map_err(|error| unusable(&ground.scene, &error))?;
        let began = self.rows.began().map(str::to_owned);
        let reading = ReadRecord { began, ..ReadRecord::whole(record) };
        Experiment::with_measurements(ground, reading, None, steady)
    }

    pub fn ended(mut self) -> StreamEnd {
        self.end.rows = self.rows.arrived();
        self.end
    }
}
