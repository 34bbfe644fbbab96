//! Vectors of three numbers, and matrices of three rows: plain arrays, for computations at every sample.

pub(super) type Vector = [f64; 3];
/// Rows.
pub(super) type Matrix = [Vector; 3];

pub(super) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + t b`.
pub(super) fn along(a: &Vector, t: f64, b: &Vector) -> Vector {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

pub(super) fn scaled(t: f64, a: &Vector) -> Vector {
    [t * a[0], t * a[1], t * a[2]]
}

pub(super) fn times(m: &Matrix, a: &Vector) -> Vector {
    [dot(&m[0], a), dot(&m[1], a), dot(&m[2], a)]
}

/// The transpose of a matrix, times a vector.
pub(super) fn back(m: &Matrix, a: &Vector) -> Vector {
    let mut sum = [0.0; 3];
    for i in 0..3 {
        for j in 0..3 {
            sum[j] += m[i][j] * a[i];
        }
    }
    sum
}

pub(super) fn unit(i: usize) -> Vector {
    IDENTITY[i]
}

/// Where the six entries of a symmetric matrix stand.
pub(super) const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// A symmetric matrix of its six entries.
pub(super) fn symmetric(entries: &[f64; 6]) -> Matrix {
    let mut m = [[0.0; 3]; 3];
    for (value, (i, j)) in entries.iter().zip(PLACES) {
        m[i][j] = *value;
        m[j][i] = *value;
    }
    m
}
