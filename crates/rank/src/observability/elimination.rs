//! Rank and kernel of a matrix by Gaussian elimination: over exact numbers, and over numbers that know their own error.

use palmistry_math::number::{Arithmetic, Refusal};

/// Brings a matrix, given by its rows, to reduced row echelon form and returns the pivot columns. Over an arithmetic
/// that always knows whether a number is zero this is exact.
///
/// # Errors
/// Where an operation is refused (numbers that grow too long).
fn reduce<A: Arithmetic>(
    arithmetic: &A,
    rows: &mut [Vec<A::Number>],
    full: bool,
) -> Result<Vec<usize>, Refusal> {
    let columns = rows.first().map_or(0, Vec::len);
    let mut pivots = Vec::new();
    for column in 0..columns {
        let top = pivots.len();
        let Some(found) =
            (top..rows.len()).find(|row| arithmetic.is_zero(&rows[*row][column]) == Some(false))
        else {
            continue;
        };
        rows.swap(top, found);
        let inverse =
            arithmetic.div(&arithmetic.rational(&dashu::rational::RBig::ONE)?, &rows[top][column])?;
        for entry in &mut rows[top][column..] {
            *entry = arithmetic.mul(entry, &inverse)?;
        }
        let (above, rest) = rows.split_at_mut(top);
        let Some((pivot_row, below)) = rest.split_first_mut() else { break };
        let others = if full { above } else { &mut [] };
        for row in others.iter_mut().chain(below) {
            if arithmetic.is_zero(&row[column]) == Some(true) {
                continue;
            }
            let factor = row[column].clone();
            for (entry, pivot_entry) in row[column..].iter_mut().zip(&pivot_row[column..]) {
                *entry = arithmetic.sub(entry, &arithmetic.mul(&factor, pivot_entry)?)?;
            }
        }
        pivots.push(column);
        if pivots.len() == rows.len() {
            break;
        }
    }
    Ok(pivots)
}

/// The rank of a matrix given by its rows.
///
/// # Errors
/// Where an operation is refused.
pub fn rank<A: Arithmetic>(arithmetic: &A, mut rows: Vec<Vec<A::Number>>) -> Result<usize, Refusal> {
    Ok(reduce(arithmetic, &mut rows, false)?.len())
}

/// A basis of the vectors of so many entries that all rows annihilate, each with a one at a free column of its own. No rows
/// at all annihilate every vector.
///
/// # Errors
/// Where an operation is refused.
pub fn kernel<A: Arithmetic>(
    arithmetic: &A,
    mut rows: Vec<Vec<A::Number>>,
    columns: usize,
) -> Result<Vec<Vec<A::Number>>, Refusal> {
    let pivots = reduce(arithmetic, &mut rows, true)?;
    let (zero, one) = (
        arithmetic.rational(&dashu::rational::RBig::ZERO)?,
        arithmetic.rational(&dashu::rational::RBig::ONE)?,
    );
    let mut basis = Vec::new();
    for free in (0..columns).filter(|column| !pivots.contains(column)) {
        let mut vector = vec![zero.clone(); columns];
        vector[free] = one.clone();
        for (row, &pivot) in rows.iter().zip(&pivots) {
            vector[pivot] = arithmetic.neg(&row[free])?;
        }
        basis.push(vector);
    }
    Ok(basis)
}

/// A lower bound on the rank of every matrix that lies in a matrix of enclosures: elimination that takes a pivot only if
/// it is certainly not zero.
///
/// `significance` is how far a number lies from zero in units of its own uncertainty (infinite where it has none); the
/// most significant entry of all that remain is taken. Multiplying a row or a column by a positive number changes no
/// significance, so that the choice of pivots, and the rank, do not depend on units.
///
/// # Errors
/// Where an operation is refused.
pub fn certain_rank<A: Arithmetic>(
    arithmetic: &A,
    mut rows: Vec<Vec<A::Number>>,
    significance: impl Fn(&A::Number) -> f64,
) -> Result<usize, Refusal> {
    let columns = rows.first().map_or(0, Vec::len);
    for step in 0..rows.len().min(columns) {
        let mut best = None;
        for (i, row) in rows.iter().enumerate().skip(step) {
            for (j, entry) in row.iter().enumerate().skip(step) {
                if arithmetic.is_zero(entry) == Some(false) {
                    let weight = significance(entry);
                    if best.is_none_or(|(most, _, _)| weight > most) {
                        best = Some((weight, i, j));
                    }
                }
            }
        }
        let Some((_, i, j)) = best else { return Ok(step) };
        rows.swap(step, i);
        for row in &mut rows {
            row.swap(step, j);
        }
        let (above, below) = rows.split_at_mut(step + 1);
        let Some(pivot_row) = above.last() else { break };
        for row in below {
            if arithmetic.is_zero(&row[step]) == Some(true) {
                continue;
            }
            let factor = arithmetic.div(&row[step], &pivot_row[step])?;
            for (entry, p) in row[step + 1..].iter_mut().zip(&pivot_row[step + 1..]) {
                *entry = arithmetic.sub(entry, &arithmetic.mul(&factor, p)?)?;
            }
        }
    }
    Ok(rows.len().min(columns))
}

/// The indices of rows that raise the rank, greedily from the first.
pub fn independent_rows<A: Arithmetic>(
    arithmetic: &A,
    rows: &[Vec<A::Number>],
) -> Result<Vec<usize>, Refusal> {
    let mut echelon: Vec<(usize, Vec<A::Number>)> = Vec::new(); // pivot column, row with a one there
    let mut kept = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let mut rest = row.clone();
        for (column, pivot_row) in &echelon {
            let factor = rest[*column].clone();
            if arithmetic.is_zero(&factor) != Some(true) {
                for (entry, p) in rest.iter_mut().zip(pivot_row) {
                    *entry = arithmetic.sub(entry, &arithmetic.mul(&factor, p)?)?;
                }
            }
        }
        if let Some(column) = rest.iter().position(|entry| arithmetic.is_zero(entry) == Some(false)) {
            let inverse =
                arithmetic.div(&arithmetic.rational(&dashu::rational::RBig::ONE)?, &rest[column])?;
            for entry in &mut rest {
                *entry = arithmetic.mul(entry, &inverse)?;
            }
            echelon.push((column, rest));
            kept.push(index);
        }
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use palmistry_math::number::Rationals;

    fn matrix(rows: &[&[i64]]) -> Vec<Vec<RBig>> {
        rows.iter().map(|row| row.iter().map(|x| RBig::from(*x)).collect()).collect()
    }

    #[test]
    fn the_magic_square_of_order_four_has_rank_three() {
        // Duerer's square, Melencolia I (1514): its rank is three
        let square = matrix(&[&[16, 3, 2, 13], &[5, 10, 11, 8], &[9, 6, 7, 12], &[4, 15, 14, 1]]);
        let all = Rationals::default();
        assert_eq!(rank(&all, square.clone()), Ok(3));
        let basis = kernel(&all, square.clone(), 4).unwrap();
        assert_eq!(basis.len(), 1);
        assert_eq!(kernel(&all, Vec::new(), 3).unwrap().len(), 3, "no rows see nothing");
        for row in &square {
            let dot = row.iter().zip(&basis[0]).fold(RBig::ZERO, |s, (a, b)| s + a * b);
            assert!(dot.is_zero());
        }
        assert_eq!(independent_rows(&all, &square), Ok(vec![0, 1, 2]));
    }
}
