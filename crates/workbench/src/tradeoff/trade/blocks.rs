//! The entries that vary by a block program: all states at once, one array for each input and each entry.

use super::lanes::BoundedValues;
use super::study::Timer;
use super::ways::Way;
use super::work::{Work, inputs};
use palmistry_math::expression::BlockProgram;
use palmistry_math::number::{Bounded, Floats, Instructions};
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// A block program and its inputs at every state.
pub(super) struct Blocks<'w> {
    program: &'w BlockProgram,
    inputs: Vec<Vec<f64>>,
}

impl<'w> Blocks<'w> {
    /// # Errors
    /// In words, where an input has no value.
    pub fn new(work: &'w Work) -> Result<Self, String> {
        let (program, scalar) = (&work.programs.blocks, &work.programs.graph);
        let by_state = inputs(work, scalar, &Floats::<f64>::new())?;
        let place = |input| scalar.inputs().iter().position(|other| other == input);
        let inputs = program.inputs().iter().map(|input| {
            let place = place(input).ok_or("an input that the program of single states does not have")?;
            Ok(by_state.iter().map(|values| values[place]).collect())
        });
        Ok(Blocks { program, inputs: inputs.collect::<Result<_, String>>()? })
    }

    fn evaluate(&self, states: Range<usize>, results: &mut [Vec<f64>]) -> Vec<usize> {
        let inputs: Vec<&[f64]> = self.inputs.iter().map(|values| &values[states.clone()]).collect();
        let mut outputs: Vec<&mut [f64]> =
            results.iter_mut().map(|values| &mut values[..states.len()]).collect();
        self.program.evaluate(&inputs, &mut outputs)
    }

    fn room(&self, states: usize) -> Vec<Vec<f64>> {
        vec![vec![0.0; states]; self.program.outputs()]
    }
}

/// So many states are evaluated in one go when it is timed; their results fit into the second-level cache.
const AT_ONCE: usize = 256;

/// What is to be timed: the first states, into arrays that are used again, and nothing handed over one by one.
pub(super) fn timer<'w>(blocks: Arc<Blocks<'w>>) -> Timer<'w> {
    let room = Mutex::new(blocks.room(AT_ONCE));
    Box::new(move |states| {
        let Ok(mut room) = room.lock() else { return };
        for start in (0..states).step_by(AT_ONCE) {
            std::hint::black_box(blocks.evaluate(start..(start + AT_ONCE).min(states), &mut room));
        }
    })
}

/// State after state from results that lie in arrays.
pub(super) fn way<'w>(blocks: Arc<Blocks<'w>>) -> Way<'w, f64> {
    Box::new(move |states, sink| {
        let count = states.len();
        let mut results = blocks.room(count);
        let lost = blocks.evaluate(states, &mut results);
        let mut row = vec![0.0; results.len()];
        for state in 0..count {
            for (entry, values) in row.iter_mut().zip(&results) {
                *entry = values[state];
            }
            sink((!lost.contains(&state)).then_some(row.as_slice()));
        }
    })
}

impl Blocks<'_> {
    fn evaluate_bounded(&self, states: Range<usize>, results: &mut Vec<Bounded<f64>>) {
        let inputs: Vec<&[f64]> = self.inputs.iter().map(|values| &values[states.clone()]).collect();
        let (program, states) = (self.program, states.len());
        Instructions::detect().run(BoundedValues { program, inputs: &inputs, states, results });
    }
}

/// The same with bounds on the errors.
pub(super) fn bounded_timer<'w>(blocks: Arc<Blocks<'w>>) -> Timer<'w> {
    let room = Mutex::new(Vec::new());
    Box::new(move |states| {
        let Ok(mut room) = room.lock() else { return };
        for start in (0..states).step_by(AT_ONCE) {
            blocks.evaluate_bounded(start..(start + AT_ONCE).min(states), &mut room);
            std::hint::black_box(&mut room);
        }
    })
}

/// The same with bounds on the errors, state after state.
pub(super) fn bounded_way<'w>(blocks: Arc<Blocks<'w>>) -> Way<'w, Bounded<f64>> {
    Box::new(move |states, sink| {
        let (count, outputs) = (states.len(), blocks.program.outputs());
        let mut results = Vec::new();
        blocks.evaluate_bounded(states, &mut results);
        for state in 0..count {
            let row = &results[state * outputs..][..outputs];
            sink(row.iter().all(|entry| !entry.value.is_nan()).then_some(row));
        }
    })
}
