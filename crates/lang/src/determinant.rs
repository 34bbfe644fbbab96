//! The determinant of a matrix of expressions, as an expression.

use super::model::Matrix;
use palmistry_math::expression::{Graph, NodeId};
use std::collections::HashMap;

/// Matrices with more rows than this are refused: the expansion has up to `2^n` minors.
pub(crate) const LARGEST: usize = 12;

/// Laplace's expansion, row after row with the emptiest row first, each minor computed once. Entries that are zero cost
/// nothing, so the unit rows that outputs contribute are free.
pub fn determinant(graph: &mut Graph, matrix: &Matrix) -> NodeId {
    let n = matrix.rows;
    let is_zero = |graph: &Graph, id: NodeId| graph.constant_value(id).is_some_and(|c| c.is_zero());
    let mut order: Vec<usize> = (0..n).collect();
    let filled = |row: &usize| (0..n).filter(|column| !is_zero(graph, matrix.at(*row, *column))).count();
    order.sort_by_key(filled);
    let swapped =
        (0..n).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|(j, i)| order[*j] > order[*i]).count();

    // minors of the last rows of the order, by the set of columns that they use
    let mut minors: HashMap<u32, NodeId> = HashMap::from([(0, graph.integer(1))]);
    for &row in order.iter().rev() {
        let mut next: HashMap<u32, NodeId> = HashMap::new();
        let mut sets: Vec<u32> = minors.keys().copied().collect();
        sets.sort_unstable(); // so that the same file gives the same graph
        for set in sets {
            for column in (0..n as u32).filter(|column| set >> column & 1 == 0) {
                let entry = matrix.at(row, column as usize);
                if is_zero(graph, entry) {
                    continue;
                }
                let product = graph.mul(entry, minors[&set]);
                // the sign counts the columns of the set that stand left of this one
                let left = (set & ((1 << column) - 1)).count_ones();
                let zero = graph.integer(0);
                let sum = next.get(&(set | 1 << column)).copied().unwrap_or(zero);
                let sum = if left % 2 == 0 { graph.add(sum, product) } else { graph.sub(sum, product) };
                next.insert(set | 1 << column, sum);
            }
        }
        minors = next;
    }
    let all = (1u32 << n) - 1;
    let zero = graph.integer(0);
    let value = minors.get(&all).copied().unwrap_or(zero);
    if swapped % 2 == 0 { value } else { graph.neg(value) }
}
