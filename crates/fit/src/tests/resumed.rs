//! A fit in several runs, each of which is interrupted, against one run.

use super::{LOG10, Made, NEVER, Row};
use crate::{JointFit, Keep, SearchState, StartEnd, fit};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

#[derive(Default)]
struct Memory {
    states: Mutex<BTreeMap<usize, SearchState>>,
    /// How often a search was found on its way.
    went_on: AtomicUsize,
}

impl Keep for Memory {
    fn get(&self, number: usize) -> Option<SearchState> {
        let found = self.states.lock().unwrap().get(&number).cloned();
        if found.as_ref().is_some_and(|state| state.end.is_none()) {
            self.went_on.fetch_add(1, Ordering::Relaxed);
        }
        found
    }

    fn put(&self, number: usize, state: &SearchState) {
        assert_ne!(state.end, Some(StartEnd::Interrupted));
        self.states.lock().unwrap().insert(number, state.clone());
    }
}

/// A search, to the last bit: its start, its end, its objective and steps, and how it ended.
type Bits = (Vec<u64>, Vec<u64>, u64, u64, StartEnd);

/// All that a fit says of its searches.
fn all(fit: &JointFit) -> Vec<Bits> {
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect();
    let one = |one: &crate::SearchEnd| {
        (bits(&one.start), bits(&one.found), one.objective.to_bits(), one.steps, one.end.clone())
    };
    fit.searches.iter().map(one).collect()
}

#[test]
fn a_fit_in_several_runs_is_that_of_one_run() {
    let truth = |amplitude: f64, t: f64| amplitude * ((-0.8 * t).exp() + (-0.05 * t).exp());
    let mut rows: Vec<Row<'_>> = Vec::new();
    for i in 0..12 {
        let t = 2.0 * f64::from(i);
        rows.push((0, "x + y", t, truth(2.0, t) + 0.01 * (7.0 * t).sin(), "0.01"));
        rows.push((1, "x + y", t, truth(5.0, t) + 0.01 * (5.0 * t).cos(), "0.01"));
    }
    let made = Made {
        text: "system \"decays\"\nstate x, y\nparam k, q, a, b unknown\ndrift f\n  x' = -k*x\n  y' = -q*y\noutput x\n",
        parameters: &[
            ("k", 1e-1, 1e2, LOG10),
            ("q", 1e-4, 1e-1, LOG10),
            ("a", 1e-2, 1e2, LOG10),
            ("b", 1e-2, 1e2, LOG10),
        ],
        experiments: &[(&[], &[Some("a"), Some("a")]), (&[], &[Some("b"), Some("b")])],
        rows: &rows,
        clock: None,
    };
    let likelihood = made.likelihood();
    let asked = (6, 200, 1);
    let whole = fit(&likelihood, asked, None, &NEVER, &|| ()).unwrap();
    let memory = Arc::new(Memory::default());
    let keep: Arc<dyn Keep> = memory.clone();
    let mut runs = 0;
    let found = loop {
        // each run goes a little farther than the one before
        runs += 1;
        let most = 2000 * runs;
        let calls = AtomicUsize::new(0);
        let is_over = || calls.fetch_add(1, Ordering::Relaxed) > most;
        let found = fit(&likelihood, asked, Some(&keep), &is_over, &|| ());
        if calls.load(Ordering::Relaxed) <= most {
            break found.unwrap();
        }
        assert!(runs < 1000, "it never ends");
    };
    assert!(runs > 3 && memory.went_on.load(Ordering::Relaxed) > 3, "{runs} runs");
    assert!(all(&found) == all(&whole));
    assert_eq!(found.best, whole.best);
    // what has ended is not searched again
    let again = fit(&likelihood, asked, Some(&keep), &NEVER, &|| ()).unwrap();
    assert!(all(&again) == all(&whole));
}
