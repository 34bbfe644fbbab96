//! Lines of progress on standard error for a run that takes long, where standard error is no terminal and shows no bar.

use palmistry::file::note;
use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What is being done, and how many steps are done of how many.
#[derive(Clone, Default)]
pub(crate) struct Stage(Arc<Mutex<(String, u64, u64)>>);

/// Ends the lines when it is dropped.
pub(crate) struct Lines {
    _end: Option<Sender<()>>,
}

impl Stage {
    /// What is done from now on.
    pub fn is(&self, what: &str, done: u64, all: u64) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = (what.to_owned(), done, all);
    }

    /// A line each time so much has passed; none of a short run, and none in a terminal.
    pub fn lines_every(&self, pause: Duration) -> Lines {
        if stderr().is_terminal() {
            return Lines { _end: None };
        }
        let (end, ended) = channel::<()>();
        let (stage, begin) = (self.clone(), Instant::now());
        // without a thread there are no lines, and the run is the same
        let _ = std::thread::Builder::new().name("progress".to_owned()).spawn(move || {
            while ended.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                note(&stage.line(begin.elapsed()));
            }
        });
        Lines { _end: Some(end) }
    }

    fn line(&self, elapsed: Duration) -> String {
        let (what, done, all) = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let what = if what.is_empty() { "reading".to_owned() } else { what };
        format!("{} s: {what} ({done} of {all} steps done)", elapsed.as_secs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done() {
        let stage = Stage::default();
        assert_eq!(stage.line(Duration::from_secs(15)), "15 s: reading (0 of 0 steps done)");
        stage.is("the extremes", 3, 9);
        assert_eq!(stage.line(Duration::from_secs(30)), "30 s: the extremes (3 of 9 steps done)");
    }
}
