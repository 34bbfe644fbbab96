//! A minor that is not zero, found by elimination: modulo a prime where all entries are rational, else by enclosures.

use palmistry_checker::Minor;
use palmistry_math::expression::Program;
use palmistry_math::number::{Arithmetic, Enclosures, PrimeField, Refusal};
use palmistry_rank::observability::{State, independent_rows};

/// The bits of the enclosures.
const BITS: usize = 512;

/// Rows and columns of the largest minor that is found, at a state at which a program gives all entries, row by row.
pub fn largest_minor(program: &Program, columns: usize, state: &State, field: PrimeField) -> Option<Minor> {
    over(&field, program, columns, state).or_else(|| over(&Enclosures::new(BITS), program, columns, state))
}

fn over<A: Arithmetic + Copy>(
    arithmetic: &A,
    program: &Program,
    columns: usize,
    state: &State,
) -> Option<Minor> {
    let inputs = state.inputs(program, arithmetic).ok()?;
    let values = program.load(*arithmetic).ok()?.run(&inputs, &mut Vec::new()).ok()?;
    let matrix: Vec<Vec<A::Number>> = values.chunks(columns).map(<[A::Number]>::to_vec).collect();
    independent(arithmetic, &matrix, columns).ok()
}

/// Rows that are independent, and as many columns in which they still are.
fn independent<A: Arithmetic>(
    arithmetic: &A,
    matrix: &[Vec<A::Number>],
    columns: usize,
) -> Result<Minor, Refusal> {
    let rows = independent_rows(arithmetic, matrix)?;
    let transposed: Vec<Vec<A::Number>> =
        (0..columns).map(|column| rows.iter().map(|row| matrix[*row][column].clone()).collect()).collect();
    let columns = independent_rows(arithmetic, &transposed)?;
    Ok(Minor { rows, columns })
}
