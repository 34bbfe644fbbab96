//! Equilibration: rows and columns of a matrix brought to equal lengths, so that what is said of its rank does not depend
//! on the units of the states and of the outputs.
//!
//! Other units multiply every row and every column of the matrix of differentials by a positive number. The matrix
//! `R M C` (`R`, `C` diagonal and positive) whose rows all have one length, and whose columns do too, is the same for
//! all of them: it is unique wherever it exists (R. Sinkhorn and P. Knopp, "Concerning nonnegative matrices and doubly
//! stochastic matrices", Pacific J. Math. 21, 1967, applied to the squares of the entries). It is reached by scaling
//! rows and columns in turn.

/// An entry's error counts so many times in the lengths: a row that is nothing but rounding noise is not lifted to the
/// size of the others, where its noise would drown them. Multiplying an entry and its error by the same number leaves
/// the weight of one against the other alone, so this too does not depend on units. (The square root of 2^52.)
pub(crate) const WEIGHT_OF_ERRORS: f64 = 67_108_864.0;

/// Scaling has converged when no row's length changes by more than this.
const CONVERGED: f64 = 1e-4;

const MOST_ROUNDS: usize = 100;

/// Scales rows and columns of a matrix (by rows, `columns` entries each) to equal lengths in place: to length one the
/// columns, and the rows to what follows from that. Rows and columns of zeros stay. `errors`, bounds on the errors of
/// the entries, are scaled with them.
pub fn equilibrate(entries: &mut [f64], errors: &mut [f64], columns: usize) {
    let mut weights: Vec<f64> =
        entries.iter().zip(&*errors).map(|(entry, error)| entry.abs() + WEIGHT_OF_ERRORS * error).collect();
    let rows = entries.len() / columns;
    for round in 0..MOST_ROUNDS {
        let mut change = 0.0f64;
        for line in 0..rows + columns {
            // the places of row `line`, or of column `line - rows`
            let (first, step, count) =
                if line < rows { (line * columns, 1, columns) } else { (line - rows, columns, rows) };
            let places = (0..count).map(|k| first + k * step);
            let largest = places.clone().fold(0.0f64, |a, place| a.max(weights[place]));
            if largest == 0.0 || !largest.is_finite() {
                continue;
            }
            // the largest entry alone at first, so that no square overflows or vanishes later
            let length = if round == 0 {
                largest
            } else {
                largest * places.clone().map(|p| (weights[p] / largest).powi(2)).sum::<f64>().sqrt()
            };
            if line < rows {
                change = change.max((length / (columns as f64 / rows as f64).sqrt() - 1.0).abs());
            }
            for place in places {
                entries[place] /= length;
                errors[place] /= length;
                weights[place] /= length;
            }
        }
        if round > 0 && change < CONVERGED {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn equilibrated(mut entries: Vec<f64>, columns: usize) -> Vec<f64> {
        let mut errors = vec![0.0; entries.len()];
        equilibrate(&mut entries, &mut errors, columns);
        entries
    }

    #[test]
    fn the_orthogonal_matrix_behind_units_is_found_again() {
        // a rotation by atan(4/3), rows in nanometres and light years, columns in seconds and megayears
        let (a, b, p, q) = (1e-9, 9.46e15, 1.0, 3.15e13);
        let scaled = equilibrated(vec![0.6 * a * p, -0.8 * a * q, 0.8 * b * p, 0.6 * b * q], 2);
        for (found, true_value) in scaled.iter().zip([0.6f64, -0.8, 0.8, 0.6]) {
            // a doubly stochastic matrix of two by two has one free number, and the product of the diagonals fixes it
            assert!((found - true_value).abs() < 1e-3, "{scaled:?}");
        }
    }

    #[test]
    fn a_row_of_noise_is_not_lifted() {
        let mut entries = vec![1.0, 2.0, 1e-17, -1e-17];
        let mut errors = vec![0.0, 0.0, 2e-17, 2e-17];
        equilibrate(&mut entries, &mut errors, 2);
        assert!(entries[2].abs() < 1e-7 && entries[3].abs() < 1e-7 && errors[2] < 1e-7, "{entries:?}");
    }

    #[test]
    fn rows_and_columns_of_zeros_stay() {
        assert_eq!(equilibrated(vec![0.0, 5.0, 0.0, 0.0], 2), [0.0, 1.0, 0.0, 0.0]);
    }
}
