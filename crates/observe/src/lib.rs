//! States recovered from what is measured.
//!
//! [`Signals`] are columns of measurements over time. A [`Model`] takes some states of a system for unknown and everything else
//! for constants or signals; a [`ModelFlow`] follows it through time with its exact first and second derivatives by the unknowns. A
//! `Window` compares what the model expects with what was measured, `cramer_rao` bounds how well the measurements can determine the
//! unknowns, and an [`Observer`] works through a [`Task`] and gives a [`Track`]: Newton's method and a region of trust
//! ([`MovingWindow`]), [`MultipleShooting`], [`Integration`], [`Kalman`], [`Unscented`], [`HighGain`]. Whether the errors of the measurements explain the
//! residual is a [`Fit`]; a [`Suspect`] says which errors of what is taken for known the residual would show, and which not.
//!
//! This floor knows systems, signals and numbers; it knows nothing of palms, bodies or scenes.

#![warn(missing_docs)]

mod attempt;
mod bound;
mod calibration;
mod chi_square;
mod correlation;
#[cfg(test)]
mod decays;
pub mod dormand_prince;
mod drift;
mod ending;
mod errors_in_variables;
mod filtered;
mod fit;
mod flow;
mod high_gain;
mod inheritance;
mod integration;
mod interpolation;
mod inversion;
mod jet;
mod kalman;
mod late;
mod learned;
mod loss;
mod model;
mod moving_window;
mod multiple_shooting;
mod newton;
mod nodes;
mod objection;
mod propagated;
mod quick_step;
mod record;
mod response;
mod restarts;
mod seam;
mod sensitivity;
mod signal;
mod smoother;
mod spread;
mod starts;
mod stiff_joints;
mod suspect;
mod task;
mod together;
mod trace;
mod track;
mod trust_region;
mod unobservable;
mod unscented;
mod weights;
mod whitening;
mod window;

pub use bound::CramerRaoBound;
pub(crate) use bound::cramer_rao;
pub use calibration::CalibrationKind;
#[doc(hidden)]
pub use calibration::{EstimatedCalibration, declare, estimated_calibrations};
#[doc(hidden)]
pub use chi_square::exceeded_with;
pub use drift::Drift;
#[doc(hidden)]
pub use fit::explains;
pub use fit::{FALSE_ALARMS, Fit, MeasurementErrors, Noise, NoiseFrom};
pub use flow::Lost;
#[doc(hidden)]
pub use flow::{ModelFlow, Order, Sample, Stride, advance};
pub use high_gain::HighGain;
pub use integration::Integration;
pub use interpolation::Interpolation;
pub use kalman::Kalman;
pub use learned::{Arrival, Learned, Spread, UninformativeWindows};
pub use loss::Loss;
pub use model::{Model, ModelError};
#[doc(hidden)]
pub use model::{ModelQuestion, parameter_values, total_rates};
pub use moving_window::{MovingWindow, WhenUnobservable, WindowSearch};
pub use multiple_shooting::{MultipleShooting, Shooting};
pub use newton::Newton;
pub use objection::{MotionRankFound, Objection, PoleMet};
pub use record::{
    ColumnNames, ColumnSource, EmptyCells, Fault, FaultKind, FaultRules, OnFault, ReadRecord, Record,
    RecordError, SparseColumn,
};
#[doc(hidden)]
pub use record::{RecordRows, RowStream, STREAM, TIME, faults_of};
pub use response::{Response, ResponseError, ResponseQuestion, response};
pub use signal::{SignalError, Signals};
pub use smoother::Smoother;
pub use suspect::{Suspect, SuspectKind};
pub use task::{EstimateQuestion, Observer, Task};
pub use together::{Innovations, Seam, Tested, Together};
pub use track::{SampleEstimate, Track, Update, UpdateEnd, passes_unwindowed};
pub use trust_region::TrustRegion;
pub use unscented::Unscented;
