//! Symmetric systems of a few equations, by Cholesky's method.

/// The lower triangle of a symmetric positive matrix of `size` rows; none where it is not positive.
pub(super) fn cholesky<const N: usize>(matrix: &[[f64; N]; N], size: usize) -> Option<[[f64; N]; N]> {
    let mut l = [[0.0; N]; N];
    for i in 0..size {
        for j in 0..=i {
            let mut value = matrix[i][j];
            for k in 0..j {
                value -= l[i][k] * l[j][k];
            }
            if i != j {
                l[i][j] = value / l[j][j];
            } else if value > 0.0 && value.is_finite() {
                l[i][i] = value.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(l)
}

/// The solution of the system with this triangle.
pub(super) fn forward<const N: usize>(l: &[[f64; N]; N], size: usize, right: &[f64; N]) -> [f64; N] {
    let mut y = [0.0; N];
    for i in 0..size {
        let mut value = right[i];
        for k in 0..i {
            value -= l[i][k] * y[k];
        }
        y[i] = value / l[i][i];
    }
    y
}

/// The solution of the system with the transposed triangle.
pub(super) fn backward<const N: usize>(l: &[[f64; N]; N], size: usize, right: &[f64; N]) -> [f64; N] {
    let mut y = [0.0; N];
    for i in (0..size).rev() {
        let mut value = right[i];
        for k in i + 1..size {
            value -= l[k][i] * y[k];
        }
        y[i] = value / l[i][i];
    }
    y
}

/// The solution of a symmetric positive system.
pub(super) fn solved<const N: usize>(
    matrix: &[[f64; N]; N],
    size: usize,
    right: &[f64; N],
) -> Option<[f64; N]> {
    let l = cholesky(matrix, size)?;
    let found = backward(&l, size, &forward(&l, size, right));
    found.iter().all(|value| value.is_finite()).then_some(found)
}
