//! How well the measurements determine each parameter, from the expected information at the best parameters.

use super::likelihood::SimulatedExperiments;
use nalgebra::{DMatrix, SymmetricEigen};

/// A direction whose information is below this part of the largest counts as undetermined: it is rounding.
const ROUNDING: f64 = 1e-13;

/// The eigenvalues take no more sweeps than these.
const MOST_ITERATIONS: usize = 10_000;

/// A parameter takes part in a direction by more than this part of its largest.
const PART: f64 = 0.1;

/// A direction in the space of the parameters on their scales, and how badly it is known.
#[derive(Clone, Debug)]
pub struct WeakDirection {
    /// Its standard deviation along a step of one unit; infinite where no measurement determines it.
    pub deviation: f64,
    /// The parameters that take part, by their places, largest first, with their parts.
    pub parts: Vec<(usize, f64)>,
}

/// What is known of the parameters that are not at their bounds.
#[derive(Clone, Debug)]
pub struct Information {
    /// The standard deviation of each parameter on its scale; infinite where it is undetermined, none where it lies at a bound.
    pub deviations: Vec<Option<f64>>,
    /// The covariance of those that lie at no bound, where all are determined.
    pub covariance: Option<DMatrix<f64>>,
    /// The directions, the worst known first.
    pub directions: Vec<WeakDirection>,
}

impl Information {
    /// Of parameters of which some lie at their bounds.
    pub fn of(simulated: &SimulatedExperiments, at_bounds: &[bool]) -> Information {
        let all = at_bounds.len();
        let free: Vec<usize> = (0..all).filter(|place| !at_bounds[*place]).collect();
        let own = DMatrix::from_fn(free.len(), free.len(), |i, j| simulated.information[(free[i], free[j])]);
        let mut deviations = vec![None; all];
        if free.is_empty() {
            return Information { deviations, covariance: None, directions: Vec::new() };
        }
        let Some(eigen) = SymmetricEigen::try_new(own, f64::EPSILON, MOST_ITERATIONS) else {
            // without eigenvalues no parameter counts as determined
            free.iter().for_each(|place| deviations[*place] = Some(f64::INFINITY));
            return Information { deviations, covariance: None, directions: Vec::new() };
        };
        let largest = eigen.eigenvalues.max();
        let is_told = |value: f64| value > ROUNDING * largest && value > 0.0;
        for (i, place) in free.iter().enumerate() {
            let mut variance = 0.0;
            for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
                let part = vector[i] * vector[i];
                // a part that is rounding does not make the parameter undetermined
                variance += match is_told(*value) {
                    true => part / value,
                    false if part > 1e-6 => f64::INFINITY,
                    false => 0.0,
                };
            }
            deviations[*place] = Some(variance.sqrt());
        }
        let mut order: Vec<usize> = (0..free.len()).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let direction = |at: usize| {
            let vector = eigen.eigenvectors.column(at);
            let most = vector.amax();
            let sign = vector.iter().find(|part| part.abs() == most).map_or(1.0, |part| part.signum());
            let mut parts: Vec<(usize, f64)> = vector
                .iter()
                .enumerate()
                .filter(|(_, part)| part.abs() > PART * most)
                .map(|(i, part)| (free[i], sign * part))
                .collect();
            parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
            let value = eigen.eigenvalues[at];
            let deviation = if is_told(value) { 1.0 / value.sqrt() } else { f64::INFINITY };
            WeakDirection { deviation, parts }
        };
        let directions = order.iter().map(|at| direction(*at)).collect();
        let covariance = eigen.eigenvalues.iter().all(|value| is_told(*value)).then(|| {
            let inverse = DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| 1.0 / value));
            &eigen.eigenvectors * inverse * eigen.eigenvectors.transpose()
        });
        Information { deviations, covariance, directions }
    }
}
