//! What an observer has learned by a sample, for whoever goes on from there: the next window, or the next part of a stream.

use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// What is known of a state before the measurements of its window.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrival {
    /// The state, with the outputs that are followed.
    pub mean: Vec<f64>,
    /// The factor: a row a relation, a column a state, in units of a measurement.
    pub factor: DMatrix<f64>,
}

impl Arrival {
    /// The relations of some unknowns at their values: what is off, and the derivatives.
    pub(super) fn off(&self, free: &[usize], unknowns: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let apart = DVector::from_fn(free.len(), |i, _| unknowns[i] - self.mean[free[i]]);
        let slopes = self.factor.select_columns(free);
        (&slopes * apart, slopes)
    }
}

/// What an observer has learned by a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// What is believed of the estimated states.
    pub belief: Vec<f64>,
    /// The standard deviations of that, where a filter has them.
    pub deviations: Option<Vec<f64>>,
    /// Whether the measurements before determined the state.
    pub(super) sees: bool,
    /// Whether it is known which errors would not be noticed.
    pub(super) is_asked: bool,
    pub(super) arrival: Option<Arc<Arrival>>,
    /// The state of a filter, and its covariance or a factor of it.
    pub(super) filter: Option<(DVector<f64>, DMatrix<f64>)>,
    /// The samples before that were uninformative by themselves.
    pub(super) unobserved: Option<Arc<UninformativeWindows>>,
    /// Where the last window ended, and how well that is known.
    pub(super) spread: Option<Arc<Spread>>,
}

/// How well a state is known at a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// The state, with the outputs that are followed.
    pub state: Vec<f64>,
    /// The covariance of its errors.
    pub covariance: DMatrix<f64>,
    /// The covariance of its errors, a row a state, with those of this sample's measurements, a column an output.
    pub by_measurement: DMatrix<f64>,
    /// By how many deviations rounding and computation may have moved it, however they are correlated.
    pub coherent: f64,
    /// Whether the measurements bore it out against a stated noise.
    pub is_tested: bool,
}

/// Windows that do not determine the state: the next one takes their samples as well.
#[derive(Clone, Debug, PartialEq)]
pub struct UninformativeWindows {
    /// How many samples back the first of them begins.
    pub(super) rows: usize,
    /// What was known there.
    pub(super) before: Learned,
}

impl Learned {
    /// A belief without a covariance.
    pub fn belief_alone(belief: Vec<f64>) -> Learned {
        let (sees, is_asked) = (true, false);
        Learned {
            belief,
            deviations: None,
            sees,
            is_asked,
            arrival: None,
            filter: None,
            unobserved: None,
            spread: None,
        }
    }

    /// How many samples before this one the next window takes as well, because they were uninformative alone.
    pub fn rows_unobserved(&self) -> usize {
        self.unobserved.as_ref().map_or(0, |unobserved| unobserved.rows)
    }
}
