//! Rank by singular values: what floating point has to say, with the gap on which it rests.

use super::equilibrate::equilibrate;
use faer::Mat;
use nalgebra::DMatrix;
use palmistry_math::number::MOST_ITERATIONS;

/// A full rank may be taken from doubles whose errors are not known where the smallest singular value is at least this
/// part of the largest: half of the digits of a double.
pub const SEPARATED: f64 = 1.5e-8;

/// The singular values of a matrix after `equilibrate`, and the rank that they suggest.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// In descending order.
    pub values: Vec<f64>,
    /// How many of them exceed [`Spectrum::tolerance`].
    pub rank: usize,
    /// By how much the errors of the entries and of the decomposition may move a singular value (H. Weyl): the
    /// Frobenius norm of the errors, scaled as the entries are, and `max(rows, columns) * 2^-52 * largest`.
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
        self.values.first().map_or(1.0, |largest| largest / self.smallest())
    }

    /// Whether all singular values count and half of the digits are left for errors that are not known.
    pub fn is_separated(&self) -> bool {
        self.values.is_empty() || self.smallest() >= SEPARATED * self.values[0]
    }

    fn new(mut values: Vec<f64>, rows: usize, columns: usize, noise: f64) -> Spectrum {
        values.sort_by(|a, b| b.total_cmp(a));
        values.resize(columns, 0.0); // fewer rows than columns: the rest of the spectrum is zero
        let largest = values.first().copied().unwrap_or(0.0);
        let tolerance = noise + rows.max(columns) as f64 * f64::EPSILON * largest;
        let rank = values.iter().filter(|v| **v > tolerance).count();
        let below = values.get(rank).copied().unwrap_or(0.0).max(tolerance);
        let gap = match rank.checked_sub(1) {
            Some(last) => values[last] / below,
            None if columns == 0 => f64::INFINITY, // nothing was left to decide
            None => 0.0,
        };
        Spectrum { values, rank, tolerance, gap }
    }
}

/// The singular values of a matrix given by rows, and bounds on the absolute errors of its entries. `None` where an
/// entry, a bound or a singular value is not finite. A matrix without rows has the rank zero.
///
/// The matrix is equilibrated first, so that neither the values nor the rank depend on units.
pub fn singular_values(entries: &[f64], errors: &[f64], columns: usize) -> Option<Spectrum> {
    if !entries.iter().chain(errors).all(|x| x.is_finite()) {
        return None;
    }
    if columns == 0 || entries.is_empty() {
        return Some(Spectrum::new(Vec::new(), 0, columns, 0.0));
    }
    let (mut scaled, mut noise) = (entries.to_vec(), errors.to_vec());
    equilibrate(&mut scaled, &mut noise, columns);
    let noise = noise.iter().map(|e| e * e).sum::<f64>().sqrt();
    Some(Spectrum::new(decompose(&scaled, columns)?, entries.len() / columns, columns, noise))
}

/// The customary way, for comparison: rows scaled to length one, and a threshold relative to the largest singular value,
/// `max(rows, columns) * 2^-52 * largest`. Other units of the states give other values, and may give another rank.
pub fn customary_singular_values(entries: &[f64], columns: usize) -> Option<Spectrum> {
    if columns == 0 || entries.is_empty() || !entries.iter().all(|x| x.is_finite()) {
        return None;
    }
    let mut scaled = entries.to_vec();
    for row in scaled.chunks_mut(columns) {
        // by the largest entry first, so that squares neither overflow nor vanish
        let largest = row.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let length = largest * row.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt();
        for x in row {
            *x = if largest > 0.0 { *x / length } else { 0.0 };
        }
    }
    Some(Spectrum::new(decompose(&scaled, columns)?, entries.len() / columns, columns, 0.0))
}

/// The singular values of a finite matrix, in no order.
fn decompose(entries: &[f64], columns: usize) -> Option<Vec<f64>> {
    let rows = entries.len() / columns;
    let matrix = Mat::<f64>::from_fn(rows, columns, |i, j| entries[i * columns + j]);
    // faer resolves small values best, but now and then gives up on an ordinary matrix; then nalgebra, with a bound on
    // its iterations, which it needs
    matrix.singular_values().ok().or_else(|| {
        let copy = DMatrix::from_row_slice(rows, columns, entries);
        let found = copy.try_svd(false, false, f64::EPSILON, MOST_ITERATIONS)?;
        Some(found.singular_values.iter().copied().collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_has_unit_singular_values() {
        let spectrum = singular_values(&[0.6, -0.8, 0.8, 0.6], &[0.0; 4], 2).unwrap();
        assert_eq!(spectrum.rank, 2);
        assert!(spectrum.values.iter().all(|v| (v - 1.0).abs() < 1e-15));
    }

    #[test]
    fn equal_rows_leave_a_gap() {
        let spectrum = singular_values(&[1.0, 2.0, 3.0, 1.0, 2.0, 3.0], &[0.0; 6], 3).unwrap();
        assert_eq!(spectrum.rank, 1);
        assert!(spectrum.gap > 1e14);
    }

    #[test]
    fn what_is_not_finite_is_reported_and_the_extremes_are_not() {
        assert_eq!(singular_values(&[f64::NAN, 1.0], &[0.0; 2], 2), None);
        assert_eq!(singular_values(&[f64::INFINITY, 1.0], &[0.0; 2], 2), None);
        assert_eq!(singular_values(&[2.0, 1.0], &[0.0, f64::INFINITY], 2), None);
        assert_eq!(singular_values(&[1e200, 0.0, 0.0, 1e-200], &[0.0; 4], 2).unwrap().rank, 2);
    }

    /// The general regime's matrix at a state at which faer 0.24.4 reports that it does not converge (the two rows along
    /// the drift and the two along an input field; the six outputs are unit rows).
    #[test]
    fn an_ordinary_matrix_is_not_given_up() {
        let mut entries = Vec::new();
        for output in [3, 4, 5, 6, 7, 8] {
            entries.extend((0..10).map(|column| f64::from(u8::from(column == output))));
        }
        entries.extend([
            1.198284080221406,
            1.5920562190019318,
            -15.491130501180447,
            -2.560294776831794,
            -3.5681800277418674,
            3.349784557596555,
            9.897195412375236,
            4.266217312039949,
            5.172570499477162,
            -2.376141333116341,
            -1.541806759043932,
            -1.1474729152315413,
            5.049475652258063,
            0.7085878759935629,
            0.7126526408394348,
            -6.372630466128818,
            1.4899753322260887,
            0.5103387302440963,
            1.8879770037212245,
            3.4620292767190044,
            1.7239474507209331,
            3.5556862455684617,
            1.025160289881425,
            -3.9891182479644454,
            0.0,
            0.0,
            -1.025160289881425,
            -12.21166132703306,
            0.0,
            -4.607320017047065,
            -2.858838153320799,
            -3.3674869382690966,
            1.051670865848755,
            3.265961027281011,
            1.4019386601133852,
            0.0,
            -1.051670865848755,
            12.848628540541938,
            -1.051670865848755,
            6.712848501023682,
        ]);
        let spectrum = singular_values(&entries, &[0.0; 100], 10).unwrap();
        assert_eq!(spectrum.rank, 10);
        // columns of length one: the squares add up to their number
        assert!((spectrum.values.iter().map(|v| v * v).sum::<f64>() - 10.0).abs() < 1e-12);
    }

    #[test]
    fn a_row_of_noise_does_not_count_and_says_so() {
        let entries = [1.0, 2.0, 1e-17, -1e-17];
        let spectrum = singular_values(&entries, &[0.0, 0.0, 2e-17, 2e-17], 2).unwrap();
        assert_eq!(spectrum.rank, 1);
        assert_eq!(customary_singular_values(&entries, 2).unwrap().rank, 2);
    }
}
