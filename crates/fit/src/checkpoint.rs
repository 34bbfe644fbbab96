//! What searches have come to, so that a later run goes on from there: to the last bit as one run that was not interrupted.

use super::ends::{SearchEnd, StartEnd};
use super::trust::{Iteration, Scoring};
use argmin::core::checkpointing::{Checkpoint, CheckpointingFrequency};
use argmin::core::{Error, State};
use nalgebra::DVector;
use std::sync::Arc;

/// How far a search has come.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchState {
    /// Where it began, on the scales of the parameters.
    pub start: Vec<f64>,
    /// Where it is.
    pub place: Vec<f64>,
    /// The best place so far.
    pub best: Vec<f64>,
    /// Minus the logarithm of the likelihood where it is, and at the best place.
    pub objectives: [f64; 2],
    /// The damping, and its next growth.
    pub damping: [f64; 2],
    /// How many steps it has made.
    pub steps: u64,
    /// How it ended; none where it goes on.
    pub end: Option<StartEnd>,
}

/// Where states of searches are kept. A search is named by its number.
pub trait Keep: Send + Sync {
    /// What was kept of a search.
    fn get(&self, number: usize) -> Option<SearchState>;
    /// Keeps it.
    fn put(&self, number: usize, state: &SearchState);
}

/// Where one search keeps its state.
#[derive(Clone)]
pub(super) struct Kept {
    pub keep: Arc<dyn Keep>,
    pub number: usize,
}

impl Kept {
    /// The search, where it has ended.
    pub fn ended(&self) -> Option<SearchEnd> {
        let state = self.keep.get(self.number)?;
        let (steps, end) = (state.steps, state.end?);
        Some(SearchEnd { start: state.start, found: state.best, objective: state.objectives[1], steps, end })
    }

    /// Where it began, where it is on its way.
    pub fn begun(&self) -> Option<Vec<f64>> {
        self.keep.get(self.number).filter(|state| state.end.is_none()).map(|state| state.start)
    }

    /// Keeps a search that has ended; one that was interrupted goes on next time.
    pub fn end(&self, found: &SearchEnd) {
        if found.end == StartEnd::Interrupted {
            return;
        }
        let SearchEnd { start, found: best, objective, steps, end } = found.clone();
        let (objectives, end) = ([objective; 2], Some(end));
        let state =
            SearchState { start, place: best.clone(), best, objectives, damping: [0.0; 2], steps, end };
        self.keep.put(self.number, &state);
    }
}

/// The checkpoint of a search, as argmin asks for it.
pub(super) struct SearchCheckpoint {
    pub kept: Kept,
    pub start: Vec<f64>,
    pub most: u64,
}

impl Checkpoint<Scoring, Iteration> for SearchCheckpoint {
    fn save(&self, solver: &Scoring, state: &Iteration) -> Result<(), Error> {
        if solver.converged || solver.stuck {
            return Ok(()); // it ends now, and its end is kept
        }
        let plain = |place: Option<&DVector<f64>>| place.map(|place| place.as_slice().to_vec());
        let (Some(place), Some(best)) = (plain(state.get_param()), plain(state.get_best_param())) else {
            return Ok(());
        };
        let kept = SearchState {
            start: self.start.clone(),
            place,
            best,
            objectives: [state.get_cost(), state.get_best_cost()],
            damping: solver.damping(),
            steps: state.get_iter(),
            end: None,
        };
        self.kept.keep.put(self.kept.number, &kept);
        Ok(())
    }

    fn load(&self) -> Result<Option<(Scoring, Iteration)>, Error> {
        let kept = self
            .kept
            .keep
            .get(self.kept.number)
            .filter(|kept| kept.end.is_none() && kept.start == self.start);
        Ok(kept.map(|kept| {
            let [objective, least] = kept.objectives;
            let mut state = Iteration::new().param(DVector::from_vec(kept.best)).cost(least);
            state.update();
            let mut state = state.param(DVector::from_vec(kept.place)).cost(objective).max_iters(self.most);
            state.iter = kept.steps;
            (Scoring::with_damping(kept.damping), state)
        }))
    }

    fn frequency(&self) -> CheckpointingFrequency {
        CheckpointingFrequency::Always
    }
}
