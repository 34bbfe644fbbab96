//! The rank of rows in which functions are met, by what these are known to satisfy.
//!
//! Over generators ([`over_generators`]) a rank is an upper bound at every state at which all terms exist and the assumptions hold.
//! Where the generators satisfy no further equation it is the rank at almost all states of every component of the domain; where
//! that is not shown, a minor at a true state is a lower bound on the component of that state.

use super::elimination::independent_rows;
use palmistry_lang::System;
use palmistry_math::expression::{Guard, NodeId, expand_angles, over_generators};
use rand::Rng;

/// What is known of the rank of some rows.
#[derive(Clone, Debug)]
pub struct RelatedRank {
    /// Rows that raise the rank, the first ones first. Their number is an upper bound wherever the rows exist.
    pub needed: Vec<usize>,
    /// The probability that the upper bound errs, as a power of two.
    pub log2_error: f64,
    /// Whether it is the rank at almost all states of every component of the domain, if it is that at one state.
    pub everywhere: bool,
    /// Whether it is the rank at almost all states, without a look at any.
    pub exact: bool,
}

/// The rank of rows of so many columns, given one after the other, where the assumptions hold.
///
/// # Errors
/// In words, where nothing is found out.
pub fn related_rank(
    system: &mut System,
    entries: &[NodeId],
    columns: usize,
    assumptions: &[Guard],
    rng: &mut impl Rng,
) -> Result<RelatedRank, String> {
    let is_angle = &system.angle_test();
    let nodes: Vec<NodeId> = assumptions.iter().map(|guard| guard.node).collect();
    let nodes = expand_angles(&mut system.graph, &nodes, is_angle);
    let assumptions: Vec<Guard> =
        assumptions.iter().zip(nodes).map(|(guard, node)| Guard { node, need: guard.need }).collect();
    let entries = expand_angles(&mut system.graph, entries, is_angle);
    let full = columns.min(entries.len() / columns.max(1));
    let mut needed: Vec<usize> = Vec::new();
    let found =
        over_generators(&mut system.graph, &entries, columns, &assumptions, rng, &mut |ring, values| {
            let matrix: Vec<Vec<Vec<u64>>> = values.chunks(columns.max(1)).map(<[_]>::to_vec).collect();
            match independent_rows(&ring, &matrix) {
                Ok(kept) => {
                    if kept.len() > needed.len() {
                        needed = kept;
                    }
                    true
                }
                Err(_) => false,
            }
        })?;
    if let Some(sign) = found.open_signs.first() {
        return Err(format!("its values depend on the sign of {}", system.graph.text(*sign)));
    }
    if found.signs_are_open {
        return Err("its values depend on signs that are not known".to_owned());
    }
    let log2_error = if needed.len() == full { f64::NEG_INFINITY } else { found.log2_error };
    let everywhere = found.independent;
    Ok(RelatedRank { needed, log2_error, everywhere, exact: everywhere && found.constants_known })
}
