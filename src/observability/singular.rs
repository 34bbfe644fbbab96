//! Rank by singular values: what floating point has to say, with the gap on which it rests.

use faer::Mat;

/// The singular values of a matrix whose rows were first scaled to length one, and the rank that they suggest.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// In descending order.
    pub values: Vec<f64>,
    /// How many of them exceed [`Spectrum::tolerance`].
    pub rank: usize,
    /// `max(rows, columns) * 2^-52 * largest`, the customary threshold.
    pub tolerance: f64,
    /// The gap on which the rank rests: the smallest value that counts, over the largest that does not (or over the
    /// threshold, where all count).
    pub gap: f64,
}

impl Spectrum {
    /// The smallest singular value of as many as there are columns.
    pub fn smallest(&self) -> f64 {
        self.values.last().copied().unwrap_or(0.0)
    }

    /// The largest over the smallest singular value.
    pub fn condition(&self) -> f64 {
        self.values.first().copied().unwrap_or(0.0) / self.smallest()
    }
}

/// The singular values of a matrix given by rows. `None` where an entry or a singular value is not finite.
///
/// A row of zeros stays one; every other row is scaled to length one, because the differentials of different outputs
/// come in different units.
pub fn singular_values(entries: &[f64], columns: usize) -> Option<Spectrum> {
    if columns == 0 || entries.is_empty() {
        return None;
    }
    let rows = entries.len() / columns;
    let mut scaled = Mat::<f64>::zeros(rows, columns);
    for (i, row) in entries.chunks(columns).enumerate() {
        // by the largest entry first, so that squares neither overflow nor vanish
        let largest = row.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        if !largest.is_finite() || row.iter().any(|x| x.is_nan()) {
            return None;
        }
        let length = largest * row.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt();
        for (j, x) in row.iter().enumerate() {
            scaled[(i, j)] = if largest > 0.0 { x / length } else { 0.0 };
        }
    }
    let mut values = scaled.singular_values().ok()?;
    if values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    values.resize(columns, 0.0); // fewer rows than columns: the rest of the spectrum is zero
    let largest = values[0];
    let tolerance = rows.max(columns) as f64 * f64::EPSILON * largest;
    let rank = values.iter().filter(|v| **v > tolerance).count();
    let below = values.get(rank).copied().unwrap_or(0.0).max(tolerance);
    let gap = if rank == 0 { 0.0 } else { values[rank - 1] / below };
    Some(Spectrum { values, rank, tolerance, gap })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_has_unit_singular_values() {
        let spectrum = singular_values(&[0.6, -0.8, 0.8, 0.6], 2).unwrap();
        assert_eq!(spectrum.rank, 2);
        assert!(spectrum.values.iter().all(|v| (v - 1.0).abs() < 1e-15));
    }

    #[test]
    fn equal_rows_leave_a_gap() {
        let spectrum = singular_values(&[1.0, 2.0, 3.0, 1.0, 2.0, 3.0], 3).unwrap();
        assert_eq!(spectrum.rank, 1);
        assert!(spectrum.gap > 1e14);
    }

    #[test]
    fn what_is_not_finite_is_reported_and_the_extremes_are_not() {
        assert_eq!(singular_values(&[f64::NAN, 1.0], 2), None);
        assert_eq!(singular_values(&[f64::INFINITY, 1.0], 2), None);
        assert_eq!(singular_values(&[1e200, 0.0, 0.0, 1e-200], 2).unwrap().rank, 2);
    }
}
