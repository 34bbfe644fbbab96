//! Lie derivatives where all of an order are too many: only those that raise the rank are taken, and continued.

use super::codistribution::{Codistribution, LieDerivative};
use super::evaluated_rows::EvaluatedRows;
use super::needed::{CodistributionError, needed};
use super::saturation::Stop;
use super::series::lie_derivative_by_series;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{NodeId, gradient};

/// A Lie derivative that is continued, with its value and its differential by all coordinates that move.
#[derive(Clone)]
struct Link {
    lie_derivative: LieDerivative,
    value: NodeId,
    row: Vec<NodeId>,
}

/// Expressions of Lie derivatives that are taken by need have no more nodes than this.
const MOST_NODES: usize = 2_000_000;

impl Codistribution {
    /// Takes only Lie derivatives that raise the rank by all coordinates that move, and of longer ones only those that continue one of these: over the
    /// field of functions the differentials of all others lie in the span of theirs, and so do those of what continues them. On a set
    /// that is not invariant this does not hold: there they are kept where they show all that series have shown; otherwise what was taken before is.
    pub(super) fn take_by_need(
        &mut self,
        system: &mut System,
        conditions: &Assignment,
        fields: &[usize],
    ) -> Result<(), CodistributionError> {
        let begin = system.graph.len();
        let closed = system.closed_coordinates();
        let mut chain: Vec<Link> = Vec::new();
        let outputs = (0..system.outputs.len()).map(|output| LieDerivative { fields: Vec::new(), output });
        let mut candidates: Vec<LieDerivative> = outputs.collect();
        let mut evaluated = EvaluatedRows::new(system);
        let ended = if self.invariant { Stop::NoGrowth } else { self.stop };
        let (mut stop, mut taken) = (ended, None);
        while !candidates.is_empty() {
            let before = chain.len();
            for lie_derivative in candidates.drain(..) {
                let output = system.outputs[lie_derivative.output].1;
                let value = match system.graph.len() - begin > MOST_NODES {
                    true => None,
                    false => lie_derivative_by_series(system, &lie_derivative.fields, output).ok(),
                };
                let Some(value) = value else {
                    stop = Stop::TooMany;
                    break;
                };
                let row = gradient(&mut system.graph, value, &closed);
                chain.push(Link { lie_derivative, value, row });
            }
            let rows: Vec<Vec<NodeId>> = chain.iter().map(|link| link.row.clone()).collect();
            let of_points = evaluated.as_mut().and_then(|evaluated| {
                evaluated.push(&system.graph, &rows[before..], conditions)?;
                let raising = evaluated.independent()?;
                evaluated.keep(&raising);
                Some((raising, false))
            });
            let (raising, guessed) = match of_points {
                Some(found) => found,
                None => {
                    evaluated = None;
                    needed(system, &rows, conditions)?
                }
            };
            chain = raising.iter().map(|place| chain[*place].clone()).collect();
            let found = self.of_chain(system, conditions, &chain, guessed)?;
            let rank = found.needed.len();
            taken = Some(found);
            if rank >= self.generic.at_most {
                stop = if rank == system.unknown_count() { Stop::Full } else { ended };
                break;
            }
            if stop == Stop::TooMany {
                break;
            }
            for link in &chain[before.min(chain.len())..] {
                for field in fields {
                    let fields =
                        std::iter::once(*field).chain(link.lie_derivative.fields.iter().copied()).collect();
                    candidates.push(LieDerivative { fields, output: link.lie_derivative.output });
                }
            }
        }
        match taken {
            // what was taken before may name more
            Some(taken)
                if stop != Stop::TooMany && self.invariant || taken.needed.len() > self.needed.len() =>
            {
                *self = Codistribution { stop, ..taken };
            }
            _ if self.invariant => self.stop = Stop::TooMany,
            _ => {}
        }
        Ok(())
    }

    /// The Lie derivatives of a chain that raise the rank by the unknowns; the chain itself where all that moves is unknown.
    fn of_chain(
        &self,
        system: &mut System,
        conditions: &Assignment,
        chain: &[Link],
        guessed: bool,
    ) -> Result<Codistribution, CodistributionError> {
        let (closed, unknowns) = (system.closed_coordinates(), system.unknowns());
        let is_unknown: Vec<bool> = closed.iter().map(|symbol| unknowns.contains(symbol)).collect();
        let of_unknowns = |link: &Link| -> Vec<NodeId> {
            link.row
                .iter()
                .zip(&is_unknown)
                .filter(|(_, unknown)| **unknown)
                .map(|(entry, _)| *entry)
                .collect()
        };
        let rows: Vec<Vec<NodeId>> = chain.iter().map(of_unknowns).collect();
        let (kept, guessed) = match closed.len() > unknowns.len() {
            true => needed(system, &rows, conditions)?,
            false => ((0..chain.len()).collect(), guessed),
        };
        Ok(Codistribution {
            lie_derivatives: kept.iter().map(|place| chain[*place].lie_derivative.clone()).collect(),
            values: kept.iter().map(|place| chain[*place].value).collect(),
            rows: kept.iter().map(|place| rows[*place].clone()).collect(),
            order: kept.iter().map(|place| chain[*place].lie_derivative.fields.len()).max().unwrap_or(0),
            needed: (0..kept.len()).collect(),
            guessed,
            ..self.clone()
        })
    }
}
