//! The rows of a codistribution made ready for minors: rows that are unit vectors (outputs that are themselves states) go
//! first, each with its column, and what remains is brought to a common denominator row by row.

use crate::expression::{Graph, NodeId, Products, Symbol};
use crate::number::polynomial::{Polynomial, Ring};
use crate::number::{Factors, Fraction};

/// The rows without unit vectors.
pub(super) struct Block {
    /// The columns that are left, by their places among the states.
    pub columns: Vec<usize>,
    /// The places of the rows that are left, and their entries in these columns.
    pub rows: Vec<(usize, Vec<NodeId>)>,
}

/// Takes out unit rows, with their columns.
pub(super) fn without_unit_rows(graph: &Graph, rows: &[Vec<NodeId>], dimension: usize) -> Block {
    let is_zero = |id: &NodeId| graph.constant_value(*id).is_some_and(|c| c.is_zero());
    let mut columns: Vec<usize> = (0..dimension).collect();
    let mut left: Vec<usize> = (0..rows.len()).collect();
    loop {
        // a row with one entry that is not zero in the columns that are left, and that one a constant
        let found = left.iter().enumerate().find_map(|(at, row)| {
            let mut filled = columns.iter().filter(|column| !is_zero(&rows[*row][**column]));
            match (filled.next(), filled.next()) {
                (Some(column), None) if graph.constant_value(rows[*row][*column]).is_some() => {
                    Some((at, *column))
                }
                _ => None,
            }
        });
        let Some((at, column)) = found else { break };
        left.remove(at);
        columns.retain(|c| *c != column);
    }
    let rows = left
        .into_iter()
        .map(|row| (row, columns.iter().map(|column| rows[row][*column]).collect::<Vec<_>>()))
        .filter(|(_, entries)| !entries.iter().all(is_zero))
        .collect();
    Block { columns, rows }
}

/// A row over its common denominator.
pub(super) struct ClearedRow {
    /// Its place among all rows.
    pub row: usize,
    /// What all its entries have above the bar, and what stands below it.
    pub above: Factors,
    pub below: Factors,
    /// The rest, by columns.
    pub entries: Vec<Polynomial>,
}

impl ClearedRow {
    /// The number of monomials.
    pub fn length(&self) -> usize {
        self.entries.iter().map(Polynomial::len).sum()
    }
}

/// Brings a row to its common denominator; with it come all nodes that it needs.
///
/// # Errors
/// In words, where its entries are no rational expressions or too long.
pub(super) fn clear(
    products: &mut Products,
    graph: &Graph,
    row: usize,
    entries: &[NodeId],
    is_angle: impl Fn(Symbol) -> bool,
) -> Result<(ClearedRow, Vec<(NodeId, Fraction)>), String> {
    let (values, nodes) = products.read(graph, entries, is_angle)?;
    let fractions = products.fractions();
    let is_zero = |top: &Factors| top.keys().any(|place| fractions.factor(*place).is_zero());
    let mut above: Option<Factors> = None;
    let mut below = Factors::new();
    for value in values.iter().filter(|value| !is_zero(&value.top)) {
        above = Some(match above {
            None => value.top.clone(),
            Some(common) => common
                .iter()
                .filter_map(|(place, power)| value.top.get(place).map(|other| (*place, *power.min(other))))
                .collect(),
        });
        for (place, power) in &value.bottom {
            let most = below.entry(*place).or_insert(0);
            *most = (*most).max(*power);
        }
    }
    let above = above.unwrap_or_default();
    let without = |from: &Factors, what: &Factors| -> Factors {
        let less = |(place, power): (&u32, &u32)| (*place, power - what.get(place).unwrap_or(&0).min(power));
        from.iter().map(less).filter(|(_, power)| *power > 0).collect()
    };
    let mut cleared = Vec::new();
    for value in &values {
        if is_zero(&value.top) {
            cleared.push(Polynomial::default());
            continue;
        }
        let mut top = without(&value.top, &above);
        for (place, power) in without(&below, &value.bottom) {
            *top.entry(place).or_insert(0) += power;
        }
        cleared.push(fractions.expand(&top).map_err(|refusal| refusal.to_string())?);
    }
    Ok((ClearedRow { row, above, below, entries: cleared }, nodes))
}
