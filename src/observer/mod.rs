//! Floor 5: state estimation. What was measured ([`record`]) is where every observer begins.

pub mod record;

pub use record::{Cell, Fault, FaultKind, FaultRules, OnFault, Reading, Record, RecordError, Rows, check};
