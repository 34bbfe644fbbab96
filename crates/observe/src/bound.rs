//! How well a window can determine the unknowns at all: the Cramér-Rao bound.

use nalgebra::DMatrix;

/// A singular value below this fraction of the largest is noise of the integration: its direction is unobservable.
const UNSEEN: f64 = 1e-10;

/// The least standard deviations that an unbiased estimate of the unknowns can have, and their covariance.
///
/// For independent normal errors of the measurements with the standard deviation `sigma` no unbiased estimate has a smaller
/// covariance than `sigma^2 (J^T J)^-1`, `J` being the derivatives of the measurements by the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct CramerRaoBound {
    /// One an unknown, in its unit; infinite where it is unobservable.
    pub deviations: Vec<f64>,
    /// The largest singular value of the scaled `J` over the smallest.
    pub condition: f64,
    /// The covariance; none where a direction is unobservable, or a variance is no double above zero.
    pub covariance: Option<DMatrix<f64>>,
    /// The combination of unknowns that is determined worst, of length one, in units of the unknowns' sizes.
    pub weakest: Vec<f64>,
}

/// The Cramér-Rao bound from the derivatives of the measurements, a row a measurement; `sizes` are the magnitudes of the unknowns, by which
/// they are scaled before anything is decomposed.
pub fn cramer_rao(slopes: &DMatrix<f64>, sigma: f64, sizes: &[f64]) -> CramerRaoBound {
    let p = slopes.ncols();
    let blind = || CramerRaoBound {
        deviations: vec![f64::INFINITY; p],
        condition: f64::INFINITY,
        covariance: None,
        weakest: vec![0.0; p],
    };
    if p == 0 || slopes.nrows() < p || slopes.iter().any(|value| !value.is_finite()) {
        return blind();
    }
    let scaled = DMatrix::from_fn(slopes.nrows(), p, |i, j| slopes[(i, j)] * sizes[j]);
    let Some(svd) = scaled.try_svd(false, true, f64::EPSILON, 10_000) else {
        return blind();
    };
    let (values, Some(directions)) = (&svd.singular_values, &svd.v_t) else {
        return blind();
    };
    let largest = values.max();
    let (least, smallest) = values.argmin();
    let weakest = directions.row(least).iter().copied().collect();
    if largest <= 0.0 {
        return blind();
    }
    let unobserved: Vec<usize> = (0..p).filter(|k| values[*k] <= UNSEEN * largest).collect();
    // sizes and singular values may be beyond the root of the largest double: their squares are in no formula
    let part = |k: usize, i: usize| sigma * directions[(k, i)] * (sizes[i] / values[k]);
    let entry = |i: usize, j: usize| -> f64 { (0..p).map(|k| part(k, i) * part(k, j)).sum::<f64>() };
    let deviation = |i: usize| {
        // an unknown without a part in the unobservable directions is observable all the same
        let hidden = unobserved.iter().any(|k| directions[(*k, i)].abs() > 1e-6);
        let seen = (0..p).filter(|k| !unobserved.contains(k));
        let deviation = seen.map(|k| part(k, i)).fold(0.0, f64::hypot);
        // a deviation that no double holds is not known, and neither zero nor a number
        let is_known = deviation.is_finite() && (deviation > 0.0 || sigma <= 0.0);
        if hidden || !is_known { f64::INFINITY } else { deviation }
    };
    CramerRaoBound {
        deviations: (0..p).map(deviation).collect(),
        condition: if smallest > 0.0 { largest / smallest } else { f64::INFINITY },
        covariance: unobserved
            .is_empty()
            .then(|| DMatrix::from_fn(p, p, entry))
            .filter(|own| own.iter().all(|value| value.is_finite()))
            .filter(|own| sigma <= 0.0 || own.diagonal().iter().all(|variance| *variance > 0.0)),
        weakest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line `a + b t` measured at the times -1, 0, 1: var a = sigma^2/3, var b = sigma^2/2, by hand.
    #[test]
    fn the_bound_of_a_straight_line_is_known() {
        let slopes = DMatrix::from_row_slice(3, 2, &[1.0, -1.0, 1.0, 0.0, 1.0, 1.0]);
        let bound = cramer_rao(&slopes, 0.1, &[1.0, 100.0]);
        assert!((bound.deviations[0] - 0.1 / 3f64.sqrt()).abs() < 1e-15);
        assert!((bound.deviations[1] - 0.1 / 2f64.sqrt()).abs() < 1e-15);
        assert!((bound.covariance.unwrap()[(0, 1)]).abs() < 1e-15);
    }

    /// Whatever the sizes by which the unknowns are scaled, also where their squares are no doubles, the bound is the same.
    #[test]
    fn the_bound_does_not_depend_on_sizes() {
        let slopes = DMatrix::from_row_slice(3, 2, &[1.0, -1.0, 1.0, 0.0, 1.0, 1.0]);
        for sizes in [[1e-250, 1e-250], [1e200, 1e200], [1e300, 1e300]] {
            let bound = cramer_rao(&slopes, 0.1, &sizes);
            assert!((bound.deviations[0] - 0.1 / 3f64.sqrt()).abs() < 1e-12, "{sizes:?}: {bound:?}");
            assert!((bound.deviations[1] - 0.1 / 2f64.sqrt()).abs() < 1e-12, "{sizes:?}: {bound:?}");
        }
        // a state that is measured with a slope of 1e200 has a deviation, small as it is
        let steep = cramer_rao(&DMatrix::from_element(2, 1, 1e200), 1e-9, &[1.0]).deviations[0];
        assert!(steep > 0.0 && steep < 1e-200, "{steep}");
        // and of one that no double holds nothing is known
        let beyond = cramer_rao(&DMatrix::from_element(2, 1, 1e300), 1e-300, &[1e-300]).deviations[0];
        assert_eq!(beyond, f64::INFINITY);
        assert_eq!(cramer_rao(&DMatrix::from_element(2, 1, 1e200), 1e-9, &[1.0]).covariance, None);
    }

    /// Two unknowns of which only the sum is measured, and a third that is measured: the third is observable.
    #[test]
    fn what_is_not_seen_has_no_bound() {
        let slopes = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 1.0]);
        let bound = cramer_rao(&slopes, 1.0, &[1.0; 3]);
        assert_eq!(bound.deviations[..2], [f64::INFINITY; 2]);
        assert!((bound.deviations[2] - 1.0).abs() < 1e-12);
        assert_eq!(bound.covariance, None);
    }
}
