//! What all combinations have to do.

use super::TradeQuestion;
use super::block::Block;
use super::programs::Programs;
use super::rows::Rows;
use super::truth::{Truth, radians};
use dashu::rational::RBig;
use palmistry_lang::System;
use palmistry_math::expression::{Input, Program, expand_angles};
use palmistry_math::number::Arithmetic;
use palmistry_rank::observability::{Branch, Locus, MissingInput, State};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;

pub(super) struct Work {
    pub system: System,
    /// Where the rows come from, and their Lie derivatives where they are known.
    pub origin: String,
    pub lie_derivatives: Vec<String>,
    pub columns: usize,
    pub rows: usize,
    /// The places of the entries that are no constants.
    pub varying: Vec<usize>,
    pub block: Block,
    /// The matrix with its unit rows.
    pub whole: Block,
    pub programs: Programs,
    pub states: Vec<State>,
    /// The values of the symbols of [`PointPrograms`] at each state as enclosures, angles in radians.
    ///
    /// [`PointPrograms`]: crate::tradeoff::PointPrograms
    pub points: Vec<Vec<(RBig, RBig)>>,
    pub truths: Vec<Truth>,
    pub without_truth: u64,
}

impl Work {
    pub fn new(mut system: System, question: &TradeQuestion<'_>) -> Result<Work, String> {
        if system.unknown_count() == 0 || system.outputs.is_empty() {
            return Err(format!("{} declares no states or no outputs", system.name));
        }
        system.require_motion()?;
        let columns = system.unknown_count();
        let rows = Rows::of(&mut system)?;
        let is_angle = &system.angle_test();
        if rows.entries.is_empty() {
            let why = "no output changes with the states: there are no rows, their rank is 0, and nothing is to be traded";
            return Err(format!("{}: {why}", system.name));
        }
        let entries = expand_angles(&mut system.graph, &rows.entries, is_angle);
        let constant = |place: &usize| system.graph.constant_value(entries[*place]).is_some();
        let varying: Vec<usize> = (0..entries.len()).filter(|place| !constant(place)).collect();
        let block = Block::new(&system, &entries, &varying);
        let whole = Block::whole(&system, &entries, &varying);
        // what the fields need is drawn too: dual numbers and differences go through them
        let mut mentioned = rows.entries;
        mentioned.extend(system.outputs.iter().map(|(_, node)| *node));
        let moving = system.moving_fields();
        let rates =
            moving.iter().flat_map(|field| system.fields[*field].components.iter().map(|(_, node)| *node));
        mentioned.extend(rates);
        let locus = Locus::new(&mut system, &Branch::default(), &BTreeMap::new(), &mentioned)
            .map_err(|error| error.to_string())?;
        let programs = Programs::new(&mut system, &entries, &varying, &rows.lie_derivatives);
        let words = rows.lie_derivatives.iter().flatten().map(|word| word.text(&system)).collect();
        let mut work = Work {
            system,
            origin: rows.origin,
            lie_derivatives: words,
            columns,
            rows: entries.len() / columns,
            varying,
            block,
            whole,
            programs,
            states: Vec::new(),
            points: Vec::new(),
            truths: Vec::new(),
            without_truth: 0,
        };
        work.find_truths(&locus, question)?;
        Ok(work)
    }

    fn find_truths(&mut self, locus: &Locus, question: &TradeQuestion<'_>) -> Result<(), String> {
        let stopped = || question.interrupt.load(Ordering::Relaxed);
        let symbols = self.programs.points.symbols();
        let rows: Vec<usize> = self.varying.iter().map(|place| place / self.columns).collect();
        let drawn: Vec<Option<(State, Truth, Vec<_>)>> = (0..question.samples)
            .into_par_iter()
            .map(|index| {
                if stopped() {
                    return Ok(None);
                }
                let state = locus.draw(question.seed, index).map_err(|error| error.to_string())?;
                let truth = Truth::at(&state, &self.programs.graph, &self.block, &rows);
                let point: Option<Vec<_>> = symbols.iter().map(|symbol| radians(&state, *symbol)).collect();
                Ok(truth.zip(point).map(|(truth, point)| (state, truth, point)))
            })
            .collect::<Result<_, String>>()?;
        for item in drawn {
            match item {
                Some((state, truth, point)) => {
                    self.states.push(state);
                    self.points.push(point);
                    self.truths.push(truth);
                }
                None => self.without_truth += 1,
            }
        }
        if stopped() {
            self.without_truth = 0; // most of these were never looked at
        }
        if self.states.is_empty() && stopped() {
            return Err("interrupted before anything was measured".to_owned());
        }
        if self.states.is_empty() {
            return Err("at no sampled state is the rank of the rows known for certain".to_owned());
        }
        Ok(())
    }

    pub fn rank_histogram(&self) -> BTreeMap<usize, u64> {
        let mut histogram = BTreeMap::new();
        for truth in &self.truths {
            *histogram.entry(truth.rank).or_insert(0) += 1;
        }
        histogram
    }
}

/// What a program needs at every state, in the numbers of an arithmetic.
///
/// # Errors
/// In words, where a number has no image.
pub(super) fn inputs<A: Arithmetic>(
    work: &Work,
    program: &Program,
    arithmetic: &A,
) -> Result<Vec<Vec<A::Number>>, String> {
    let complain = |missing: MissingInput| match missing {
        MissingInput::Refused(refusal) => refusal.to_string(),
        MissingInput::Unsaid => match program.inputs().iter().find(|input| matches!(input, Input::Opaque(_)))
        {
            Some(_) => "a function that is treated as an unknown".to_owned(),
            None => "an angle is met outside sines and cosines".to_owned(),
        },
    };
    work.states.iter().map(|state| state.inputs(program, arithmetic).map_err(complain)).collect()
}
