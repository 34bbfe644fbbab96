//! The dimensions of a determinant and of an inverse.
//!
//! All products that a determinant adds have one dimension if and only if the entries that take part in one of them are
//! products `r_i c_j` of a dimension of their row and one of their column, block by block: two nonnegative matrices of
//! total support whose positive diagonals have one product are diagonally equivalent (Engel and Schneider, Cyclic and
//! diagonal products on a matrix, Linear Algebra and its Applications 7, 1973). An entry takes part in a product if it
//! lies on a cycle of the graph that a first perfect matching leaves (Dulmage and Mendelsohn, 1958).

use super::check::Checker;
use super::form::Form;
use super::problem::Asked;
use super::quantity::{Entry, Table};
use palmistry_math::expression::syntax::Span;

/// How the entries of a square matrix that are not zero take part in its determinant.
struct Structure {
    /// The column that the matching gives to each row.
    column: Vec<usize>,
    /// Whether the equation of a row depends on the unknown that the matching gives to another row, perhaps through others.
    reaches: Vec<Vec<bool>>,
}

impl Structure {
    /// Nothing where every product is zero.
    fn of(table: &Table) -> Option<Structure> {
        let n = table.rows;
        let filled = |row: usize, column: usize| *table.at(row, column) != Entry::Zero;
        let mut row_of: Vec<Option<usize>> = vec![None; n];
        for row in 0..n {
            if !augment(row, n, &filled, &mut vec![false; n], &mut row_of) {
                return None;
            }
        }
        let mut column = vec![0; n];
        for (place, row) in row_of.iter().enumerate() {
            column[(*row)?] = place;
        }
        let mut reaches: Vec<Vec<bool>> =
            (0..n).map(|row| (0..n).map(|other| filled(row, column[other])).collect()).collect();
        for through in 0..n {
            for from in 0..n {
                for to in 0..n {
                    reaches[from][to] |= reaches[from][through] && reaches[through][to];
                }
            }
        }
        Some(Structure { column, reaches })
    }

    fn in_one_block(&self, row: usize, other: usize) -> bool {
        self.reaches[row][other] && self.reaches[other][row]
    }
}

/// Finds a column for a row, moving other rows where needed (Kuhn's method).
fn augment(
    row: usize,
    n: usize,
    filled: &dyn Fn(usize, usize) -> bool,
    tried: &mut [bool],
    row_of: &mut [Option<usize>],
) -> bool {
    for column in 0..n {
        if !filled(row, column) || std::mem::replace(&mut tried[column], true) {
            continue;
        }
        let is_free = match row_of[column] {
            None => true,
            Some(other) => augment(other, n, filled, tried, row_of),
        };
        if is_free {
            row_of[column] = Some(row);
            return true;
        }
    }
    false
}

/// The dimensions of the rows and columns of a matrix; each block has a factor of its own that cancels.
struct Sides {
    rows: Vec<Form>,
    columns: Vec<Form>,
}

impl Checker<'_> {
    /// Rows and columns such that the entries of each block are their products; nothing where that is a mistake, which is
    /// noted, or unknown.
    fn rows_and_columns(
        &mut self,
        table: &Table,
        structure: &Structure,
        what: &'static str,
        span: &Span,
    ) -> Option<Sides> {
        let n = table.rows;
        let mut rows: Vec<Option<Form>> = vec![None; n];
        let mut columns: Vec<Option<Form>> = vec![None; n];
        // the unknown of a row, by the matching, is the other end of it
        let takes_part = |row: usize, other: usize| structure.in_one_block(row, other);
        for first in 0..n {
            if rows[first].is_some() {
                continue;
            }
            rows[first] = Some(Form::number());
            let mut open = vec![first];
            while let Some(row) = open.pop() {
                for other in (0..n).filter(|other| takes_part(row, *other)) {
                    let column = structure.column[other];
                    let row_form = rows[row].clone()?;
                    let Entry::Of(entry) = table.at(row, column) else { continue };
                    match &columns[column] {
                        None => columns[column] = Some(entry.over(&row_form)),
                        Some(known) => {
                            let product = row_form.times(known);
                            if !self.equate(entry, &product, span, &Asked::Products(what)) {
                                return None;
                            }
                        }
                    }
                    // the row that the matching gives to this column
                    let column_form = columns[column].clone()?;
                    if rows[other].is_none() {
                        let Entry::Of(entry) = table.at(other, column) else { return None };
                        rows[other] = Some(entry.over(&column_form));
                        open.push(other);
                    }
                }
            }
        }
        Some(Sides {
            rows: rows.into_iter().collect::<Option<_>>()?,
            columns: columns.into_iter().collect::<Option<_>>()?,
        })
    }

    /// The dimension of a determinant.
    pub fn determinant(&mut self, table: &Table, span: &Span) -> Entry {
        if table.rows != table.columns || table.entries.contains(&Entry::Open) {
            return Entry::Open;
        }
        let Some(structure) = Structure::of(table) else { return Entry::Zero };
        let Some(sides) = self.rows_and_columns(table, &structure, "the determinant", span) else {
            return Entry::Open;
        };
        let all = sides.rows.iter().chain(&sides.columns);
        Entry::Of(all.fold(Form::number(), |product, side| product.times(side)))
    }

    /// The dimensions of an inverse; those of entries between two blocks are left open.
    pub(super) fn inverse(&mut self, table: &Table, span: &Span) -> Vec<Entry> {
        let n = table.rows;
        let open = || vec![Entry::Open; table.entries.len()];
        if table.rows != table.columns || table.entries.contains(&Entry::Open) {
            return open();
        }
        let Some(structure) = Structure::of(table) else { return open() };
        let Some(sides) = self.rows_and_columns(table, &structure, "the inverse", span) else {
            return open();
        };
        let mut entries = open();
        for row in 0..n {
            let column = structure.column[row];
            for other in 0..n {
                entries[column * n + other] = if structure.in_one_block(row, other) {
                    Entry::Of(Form::number().over(&sides.columns[column]).over(&sides.rows[other]))
                } else if structure.reaches[row][other] {
                    Entry::Open
                } else {
                    Entry::Zero
                };
            }
        }
        entries
    }
}
