//! The pieces that arrive in a stream, and the reports on it.

use crate::run::Experiment;
use crate::scene::Method;
use palmistry_observe::{Fault, Innovations, SampleEstimate, Tested, Update, passes_unwindowed};

/// A piece of a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StreamPiece {
    /// Some bytes of comma-separated values.
    Bytes(Vec<u8>),
    /// Nothing yet.
    Nothing,
    /// The end of the stream.
    End,
    /// The end of the stream, for this reason.
    Broken(String),
}

/// The answer of one observer on a window.
#[derive(Clone, Debug)]
pub struct StreamAnswer {
    /// The observer.
    pub method: Method,
    /// Its estimate at the last sample.
    pub end: Option<SampleEstimate>,
    /// The standard deviations of that, where a filter has them.
    pub deviations: Option<Vec<f64>>,
    /// Its updates: one, or two where the first contradicts the estimate of earlier windows.
    pub updates: Vec<Update>,
    /// Other states that fit as well.
    pub others: Vec<Update>,
    /// Further remarks.
    pub remarks: Vec<String>,
    /// Samples at which the state was unobservable.
    pub unobserved: usize,
}

/// A window of a stream.
#[derive(Clone, Debug)]
pub struct WindowReport<'a> {
    /// The scene; its measurements are those of the first window.
    pub experiment: &'a Experiment,
    /// Which window it is, from 1 on.
    pub window: u64,
    /// Its samples, the one shared with the window before included.
    pub samples: usize,
    /// The number of rows that had arrived.
    pub rows: usize,
    /// The faults of rows since the last report.
    pub faults: Vec<Fault>,
    /// The answer of each observer.
    pub answers: Vec<StreamAnswer>,
}

/// How a stream ended.
#[derive(Clone, Debug, Default)]
pub struct StreamEnd {
    /// Windows that were answered.
    pub windows: u64,
    /// Rows that had arrived.
    pub rows: usize,
    /// Rows with faults.
    pub faults: usize,
    /// Why it ended early, as text: an interrupt, a broken pipe, a row that is cut off.
    pub cut_off: Option<String>,
    /// A faulty row, where the scene says to stop.
    pub fault: Option<String>,
    /// For each observer: its updates, those that fit or were not tested, and whether one is contradicted.
    pub observers: Vec<StreamTally>,
}

/// The tally of an observer's updates.
#[derive(Clone, Debug)]
pub struct StreamTally {
    /// The observer.
    pub method: Method,
    /// Its updates.
    pub updates: usize,
    /// Those that converged, were tested, and fit.
    pub fit: usize,
    /// Those that converged, and of which too little was measured to test the residuals.
    pub untested: usize,
    /// Those that converged and do not fit.
    pub contradicted: usize,
    /// Those whose search did not converge: all of its steps were spent.
    pub spent: usize,
    /// The tests of all of them together, and of their seams.
    pub tested: Tested,
    /// The innovations of a filter, over all windows; none of other methods.
    pub innovations: Option<Innovations>,
    /// Samples with an estimate, and those of them at which it could not follow its model.
    pub believed: [usize; 2],
}

impl StreamTally {
    /// Whether an update is contradicted, or all of them together are.
    pub fn is_contradicted(&self) -> bool {
        self.contradicted > 0 || self.tested.together().is_some_and(|all| !all.fits)
    }

    /// Whether a method that does not work by windows passes; see [`passes_unwindowed`].
    pub fn passes(&self) -> bool {
        let [believed, unobserved] = self.believed;
        passes_unwindowed(believed, unobserved, self.innovations.as_ref())
    }
}

impl StreamEnd {
    /// Whether no update is contradicted, each search converged, and each method by windows has an update that fits, or that too little was measured to test; where there is none by windows, whether each filter passes its test. A stream that was
    /// cut off before it had any answer needs none.
    pub fn is_sound(&self) -> bool {
        let is_whole = self.cut_off.is_none();
        let by_windows = |tally: &StreamTally| tally.method.is_by_windows();
        let has_windows = self.observers.iter().any(by_windows);
        self.observers.iter().all(|tally| match by_windows(tally) {
            true => {
                let fits = tally.fit + tally.untested > 0 || (!is_whole && tally.updates == 0);
                fits && tally.spent == 0 && !tally.is_contradicted()
            }
            false => has_windows || tally.passes() || (!is_whole && tally.believed[0] == 0),
        })
    }
}
