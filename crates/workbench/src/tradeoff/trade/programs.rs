//! The programs that the ways to a derivative run.

use crate::tradeoff::point_programs::PointPrograms;
use crate::tradeoff::term_by_term::term_by_term;
use palmistry_lang::System;
use palmistry_math::expression::{BlockProgram, NodeId, Program, expand_angles, gradient};
use palmistry_rank::observability::{LieDerivative, lie_derivative_by_series};

/// A multiplied-out form longer than this is said to be too large.
const MOST_MONOMIALS: usize = 20_000;

/// Where an entry that varies is found by ways that take whole rows.
#[derive(Clone, Debug)]
pub(super) struct RowPlan {
    /// The fields and the output of the Lie derivative of each row that has entries that vary.
    pub rows: Vec<(Vec<usize>, usize)>,
    /// Row (of these) and column of each entry that varies.
    pub picks: Vec<(usize, usize)>,
}

pub(super) struct Programs {
    /// The entries that vary, as they were derived.
    pub graph: Program,
    /// The same over blocks of states.
    pub blocks: BlockProgram,
    /// By Taylor series; or why not.
    pub series: Result<Program, String>,
    /// Multiplied out; or why not.
    pub expanded: Result<Program, String>,
    pub points: PointPrograms,
    pub plan: Result<RowPlan, String>,
}

impl Programs {
    /// `entries` are all, by rows; `varying` the places of those that are no constants.
    pub fn new(
        system: &mut System,
        entries: &[NodeId],
        varying: &[usize],
        lie_derivatives: &Result<Vec<LieDerivative>, String>,
    ) -> Programs {
        let is_angle = &system.angle_test();
        let roots: Vec<NodeId> = varying.iter().map(|place| entries[*place]).collect();
        let by_series =
            lie_derivatives.as_ref().map_err(Clone::clone).and_then(|words| series(system, words, varying));
        let expanded = term_by_term(&mut system.graph, &roots, is_angle, MOST_MONOMIALS);
        let compile = |roots: &[NodeId]| Program::new(&system.graph, roots, is_angle);
        let columns = system.unknown_count();
        let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
        Programs {
            graph: compile(&roots),
            blocks: BlockProgram::new(&system.graph, &roots, &[], is_angle, |_| None),
            series: by_series.map(|roots| compile(&roots)),
            expanded: expanded.map(|roots| compile(&roots)),
            points: PointPrograms::new(system, &outputs),
            plan: lie_derivatives.as_ref().map(|words| plan(words, varying, columns)).map_err(Clone::clone),
        }
    }
}

fn series(system: &mut System, words: &[LieDerivative], varying: &[usize]) -> Result<Vec<NodeId>, String> {
    let columns = system.unknown_count();
    let plan = plan(words, varying, columns);
    let states = system.unknowns();
    let mut rows = Vec::new();
    for (fields, output) in &plan.rows {
        let h = system.outputs[*output].1;
        let value = lie_derivative_by_series(system, fields, h).map_err(|f| f.refusal.to_string())?;
        rows.push(gradient(&mut system.graph, value, &states));
    }
    let picked: Vec<NodeId> = plan.picks.iter().map(|(row, column)| rows[*row][*column]).collect();
    let is_angle = &system.angle_test();
    Ok(expand_angles(&mut system.graph, &picked, is_angle))
}

fn plan(words: &[LieDerivative], varying: &[usize], columns: usize) -> RowPlan {
    let mut kept: Vec<usize> = varying.iter().map(|place| place / columns).collect();
    kept.dedup();
    let pick = |place: &usize| (kept.partition_point(|row| *row < place / columns), place % columns);
    RowPlan {
        picks: varying.iter().map(pick).collect(),
        rows: kept.iter().map(|row| (words[*row].fields.clone(), words[*row].output)).collect(),
    }
}
