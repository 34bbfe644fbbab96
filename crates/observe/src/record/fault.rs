//! What can be wrong with a row, and the rules by which it is found.

use crate::Interpolation;
use palmistry_io::foreign::shown;
use std::collections::BTreeMap;
use std::fmt;

/// What to do when a row is faulty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OnFault {
    /// Use none of the record.
    #[default]
    Stop,
    /// Use the other rows.
    Skip,
}

/// What an empty cell of a column means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmptyCells {
    /// Nothing was measured then: of an output, which is compared where it was measured.
    NotMeasured,
    /// The value lies between those around it: of a column that drives the model.
    Interpolated,
}

/// How faults are found, and what to do about them.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultRules {
    /// What to do.
    pub on_fault: OnFault,
    /// How many usual departures from what its neighbours foretell make a value a spike; infinite: none is.
    pub spike: f64,
    /// The standard deviation of the time between two samples, in seconds.
    pub jitter: f64,
    /// The grid on which the measurements of a column lie, in the column's unit; a column that is not here has none.
    pub resolution: BTreeMap<String, f64>,
    /// What an empty cell means in a column; in one that is not here it is a fault.
    pub empty: BTreeMap<String, EmptyCells>,
    /// How columns go from one sample to the next.
    pub interpolation: Interpolation,
}

impl Default for FaultRules {
    /// Stop at a fault; eight usual departures are a spike; even times, fine measurements.
    fn default() -> Self {
        FaultRules {
            on_fault: OnFault::Stop,
            spike: 8.0,
            jitter: 0.0,
            resolution: BTreeMap::new(),
            empty: BTreeMap::new(),
            interpolation: Interpolation::default(),
        }
    }
}

/// Something that is wrong in a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The row, counted from one below the header.
    pub row: usize,
    /// The line in the file, counted from one; none in a Parquet file.
    pub line: Option<u64>,
    /// The row's time in seconds, if that can be read.
    pub time: Option<f64>,
    /// The column, where the fault is in one.
    pub column: Option<String>,
    /// What is wrong.
    pub kind: FaultKind,
}

/// The ways in which a row is faulty.
#[derive(Clone, Debug, PartialEq)]
pub enum FaultKind {
    /// The cell holds something else than a number.
    NotANumber {
        /// What it says.
        says: String,
    },
    /// The number is infinite or none (NaN).
    NotFinite {
        /// The number.
        value: f64,
    },
    /// The cell is empty or not there.
    Missing,
    /// The row has more cells than the header has names.
    Surplus {
        /// How many more.
        cells: usize,
    },
    /// The row's time does not fit between those before and after it.
    OutOfOrder,
    /// The row has the time of an earlier one.
    Duplicate {
        /// The earlier row, counted from one.
        of: usize,
    },
    /// Rows are missing before this one.
    Gap {
        /// The time since the row before, in seconds.
        step: f64,
        /// The usual time between rows, in seconds.
        usual: f64,
        /// How many rows would fill the gap.
        missing: u64,
    },
    /// The value is far from what its neighbours foretell.
    Spike {
        /// The value.
        value: f64,
        /// How many usual departures it is off.
        departure: f64,
    },
}

impl Fault {
    /// Whether the row is of no use: so it is for every fault but a gap, which lies before its row.
    pub fn takes_its_row(&self) -> bool {
        !matches!(self.kind, FaultKind::Gap { .. })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "row {}", self.row)?;
        if let Some(line) = self.line {
            write!(f, " (line {line})")?;
        }
        if let Some(time) = self.time {
            write!(f, " at {time} s")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", {}", shown(column))?;
        }
        match &self.kind {
            FaultKind::NotANumber { says } => write!(f, ": {says:?} is no number"),
            FaultKind::NotFinite { value } => write!(f, ": {value} is not finite"),
            FaultKind::Missing => write!(f, ": nothing there"),
            FaultKind::Surplus { cells } => write!(f, ": {cells} more cells than the header has names"),
            FaultKind::OutOfOrder => write!(f, ": does not fit between the times before and after it"),
            FaultKind::Duplicate { of } => write!(f, ": has the time of row {of}"),
            FaultKind::Gap { step, usual, missing } => {
                write!(f, ": {step:.3e} s after the row before, usual are {usual:.3e} s: {missing} missing")
            }
            FaultKind::Spike { value, departure } => {
                write!(f, ": {value} is {departure:.1} usual departures off what its neighbours foretell")
            }
        }
    }
}
