//! Rows that are known before any number is put in: an output that is itself a state has a unit row for its differential.
//!
//! Such a row determines its column exactly, whatever the other rows hold there, so that both can be left out before the
//! rank is decided: `rank = eliminated + rank of what remains`. Singular values are then those of what remains.

use palmistry_math::expression::{Graph, NodeId};

/// What remains of a matrix of expressions when its unit rows have been eliminated with their columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reduction {
    /// The rows that remain, by their places in the matrix; rows of zeros do not.
    pub rows: Vec<usize>,
    /// The columns that remain.
    pub columns: Vec<usize>,
    /// The rows that were eliminated, by their places in the matrix.
    pub unit_rows: Vec<usize>,
    /// How many rows were eliminated with as many columns.
    pub eliminated: usize,
    /// The entries that remain, by rows.
    pub entries: Vec<NodeId>,
}

impl Reduction {
    /// Eliminates, again and again, rows whose only entry in a remaining column that is not the constant zero is another
    /// constant. `entries` are given by rows of `columns` entries.
    pub fn new(graph: &Graph, entries: &[NodeId], columns: usize) -> Reduction {
        // whether an entry is a constant, and then whether it is zero
        let constant = |id: &NodeId| graph.constant_value(*id).map(|value| value.is_zero());
        let matrix: Vec<Vec<Option<bool>>> =
            entries.chunks(columns.max(1)).map(|row| row.iter().map(constant).collect()).collect();
        let mut rows: Vec<usize> = (0..matrix.len()).collect();
        let mut kept: Vec<usize> = (0..columns).collect();
        let mut unit_rows = Vec::new();
        loop {
            rows.retain(|row| kept.iter().any(|column| matrix[*row][*column] != Some(true)));
            let unit = rows.iter().enumerate().find_map(|(place, row)| {
                let mut filled = kept.iter().filter(|column| matrix[*row][**column] != Some(true));
                match (filled.next(), filled.next()) {
                    (Some(column), None) if matrix[*row][*column] == Some(false) => Some((place, *column)),
                    _ => None,
                }
            });
            let Some((place, column)) = unit else { break };
            unit_rows.push(rows.remove(place));
            kept.retain(|other| *other != column);
        }
        let entries =
            rows.iter().flat_map(|row| kept.iter().map(move |column| entries[row * columns + column]));
        Reduction { entries: entries.collect(), rows, columns: kept, eliminated: unit_rows.len(), unit_rows }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x and 1 and 0 as entries.
    fn reduced(matrix: &[&str]) -> Reduction {
        let mut graph = Graph::default();
        let x = graph.intern("x");
        let x = graph.symbol(x);
        let mut entries = Vec::new();
        for letter in matrix.iter().flat_map(|row| row.chars()) {
            entries.push(match letter {
                'x' => x,
                digit => graph.integer(i64::from(digit.to_digit(10).unwrap())),
            });
        }
        Reduction::new(&graph, &entries, matrix[0].len())
    }

    #[test]
    fn unit_rows_leave_with_their_columns() {
        let found = reduced(&["0100", "xxxx", "x0xx", "0010"]);
        assert_eq!((found.eliminated, found.rows, found.columns), (2, vec![1, 2], vec![0, 3]));
        assert_eq!(found.entries.len(), 4);
    }

    #[test]
    fn a_second_unit_row_of_one_column_says_nothing_new() {
        let found = reduced(&["010", "020", "xxx"]);
        assert_eq!((found.eliminated, found.rows, found.columns), (1, vec![2], vec![0, 2]));
    }

    #[test]
    fn elimination_goes_on_and_may_leave_nothing() {
        let found = reduced(&["110", "010", "xx3"]);
        assert_eq!((found.eliminated, found.rows.len(), found.columns.len()), (3, 0, 0));
    }

    #[test]
    fn an_entry_that_may_vanish_is_no_unit() {
        assert_eq!(reduced(&["0x", "xx"]).eliminated, 0);
    }
}
