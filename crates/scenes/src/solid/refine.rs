//! The likeliest state and errors of the measurements at once: Gauss and Newton's method on both, errors eliminated by the filter.

use super::change::{Positive, Scale, shortened};
use super::flow::Start;
use super::integrals::Rules;
use super::linear::cholesky;
use super::linearised::{Linear, corrected};
use super::newton::{About, Settled, Square};
use super::vector::{PLACES, symmetric};
use super::whiten::{Deviations, ERRORS};
use super::{Rival, SolidMeasurements, SolidState, UNKNOWNS};
use nalgebra::{Matrix3, SMatrix, Vector3};
use palmistry_math::number::MOST_ITERATIONS;

/// The result of refinement.
#[derive(Clone, Debug)]
pub(super) struct Refined {
    pub start: Start,
    /// The measurements without their likeliest errors.
    pub corrected: SolidMeasurements,
    pub chi_square: f64,
    /// The information by derivatives at the corrected measurements: the covariance of the gradient.
    information: Square,
    /// Half the Hessian of chi-square.
    curvature: Square,
    /// Whether it is a minimum, and not a place on a slope that goes on.
    pub is_minimum: bool,
    /// See [`Settled::bent`].
    bent: f64,
    /// Another end of the search that explains the measurements as well.
    pub rival: Option<Rival>,
    rms_residual: f64,
    /// J. von Neumann's ratio of the white residuals: about 2 where these are noise.
    pub ratio: f64,
    /// The deviation that contacts were weighed with, in m.
    weighed: f64,
}

/// The gain of a whole step, in units of the deviations squared, below which no other one is taken; and below which the result counts as converged where none gains anything. Contacts that are said to be exact are weighted with
/// deviations that they do not have, so that a direction a million times less observable than the rest still gains by far less.
const GAINED: [f64; 2] = [1e-8, 1e-2];
const EXACT_GAINED: f64 = 1e-18;

/// If chi-square is above this many times the number of constraints the fit is rejected, and no minimum is looked for more closely.
const HOPELESS: f64 = 3.0;

/// From a start; none where the method does not converge: with whole steps, and where these fail with damped ones. Where errors are stated Newton's method goes on from there, also from where they did not converge.
pub(super) fn refine(
    measurements: &SolidMeasurements,
    rules: &Rules,
    from: Start,
    scale: &Scale,
    deviations: &Deviations,
) -> Option<Refined> {
    let about = |start: &Start, errors: &[[f64; ERRORS]]| {
        Linear::about(measurements, rules, deviations, start, errors)
    };
    let exact = measurements.contact_deviation == 0.0;
    let by = |growth: f64, most: usize| stepped(&about, from, scale, exact, (growth, most));
    let mut ended = by(f64::INFINITY, 15).filter(|(_, is_end)| *is_end);
    if ended.is_none() {
        ended = by(GROWTH, 25);
    }
    let (settled, is_end) = ended?;
    let few = HOPELESS * (3 * measurements.rows()) as f64;
    let is_close = settled.chi_square() < few;
    if exact || !is_close {
        return is_end.then(|| Refined::of(measurements, deviations, settled, None));
    }
    let (settled, curvature, is_minimum) = settled.descended(&about, scale)?;
    let spread = sandwiched(&settled.linear.normal.matrix, &curvature);
    let bent = match &spread {
        Some((spread, _)) if is_minimum => settled.bent(&about, scale, spread, &curvature),
        _ => f64::INFINITY,
    };
    Some(Refined { bent, ..Refined::of(measurements, deviations, settled, Some((curvature, is_minimum))) })
}

/// The factor by which the sum of the squares may grow in a damped step.
const GROWTH: f64 = 1.05;

/// The method with steps after which the sum of the squares is no more than so many times as large, at most so many of them; and whether it converged.
fn stepped(
    about: &About<'_>,
    from: Start,
    scale: &Scale,
    exact: bool,
    (growth, most): (f64, usize),
) -> Option<(Settled, bool)> {
    let mut here = Settled::begun(about, from)?;
    let mut damping = if growth.is_finite() { 1e-4 } else { 0.0 };
    let least = if exact { EXACT_GAINED } else { GAINED[0] };
    let (mut gain, mut last) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..most {
        let whole = here.linear.normal.step(0.0)?;
        gain = -whole.iter().zip(&here.linear.normal.gradient).map(|(a, b)| a * b).sum::<f64>();
        // where rounding alone is left, steps gain no less than those before
        if gain < least || (gain >= last && gain < GAINED[1] / 10.0) {
            break;
        }
        last = gain;
        let mut next = None;
        for _ in 0..8 {
            let by = if gain < GAINED[1] { 0.0 } else { damping };
            let step = shortened(&here.linear.normal.step(by)?, scale);
            next = here.next(about, &step).filter(|found| found.chi_square() <= growth * here.chi_square());
            if next.is_some() || by == 0.0 {
                break;
            }
            damping *= 10.0;
        }
        let Some(next) = next else { break };
        here = next;
        damping *= 0.03;
    }
    let is_end = gain <= GAINED[1];
    Some((here, is_end))
}

impl Refined {
    fn of(
        measurements: &SolidMeasurements,
        deviations: &Deviations,
        settled: Settled,
        bent: Option<(Square, bool)>,
    ) -> Refined {
        let errors = settled.linear.errors(&[0.0; UNKNOWNS]);
        let contacts: f64 = errors.iter().flat_map(|error| &error[..6]).map(|e| e * e).sum();
        let Linear { normal, ratio, .. } = settled.linear;
        Refined {
            start: settled.start,
            corrected: corrected(measurements, &errors, deviations),
            chi_square: normal.cost,
            information: normal.matrix,
            curvature: bent.map_or(normal.matrix, |(curvature, _)| curvature),
            rival: None,
            bent: 1.0,
            is_minimum: bent.is_none_or(|(_, is_minimum)| is_minimum),
            rms_residual: deviations.contact * (contacts / (6 * errors.len()) as f64).sqrt(),
            ratio,
            weighed: deviations.contact,
        }
    }
}

/// Eigenvalues of the curvature relative to the information are at least this: along smaller ones the state is unobservable.
const FLAT: f64 = 1e-6;

/// `H^-1 G H^-1` for the curvature `H` and the covariance `G` of the gradient: the covariance of what makes the gradient zero (P. J. Huber, Proceedings of the Fifth Berkeley Symposium, 1967). Both are one where measurements are exact.
/// With `G = L L^T` it is the inverse of the square of `L^-1 H L^-T`, between `L^-T` and `L^-1`.
fn sandwiched(information: &Square, curvature: &Square) -> Option<(SMatrix<f64, UNKNOWNS, UNKNOWNS>, f64)> {
    let full = |of: &Square| {
        SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| if i > j { of[i][j] } else { of[j][i] })
    };
    // unscaled, directions that are a million times less observable would be lost to rounding
    let triangle = cholesky(information, UNKNOWNS)?;
    let lower = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| triangle[i][j]);
    let inverse = lower.solve_lower_triangular(&SMatrix::identity())?;
    let relative = inverse * full(curvature) * inverse.transpose();
    let symmetric = (relative + relative.transpose()) / 2.0;
    let eigen = symmetric.try_symmetric_eigen(f64::EPSILON, MOST_ITERATIONS)?;
    let mut spread = eigen.eigenvectors;
    for (mut column, value) in spread.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column /= value.max(FLAT);
    }
    let half = inverse.transpose() * spread;
    Some((half * half.transpose(), eigen.eigenvalues.min()))
}

impl Refined {
    /// The estimated state.
    pub fn state(&self) -> Option<SolidState> {
        let k = Positive::of(&self.start.inverse)?;
        let inertia = Matrix3::from_fn(|i, j| k.inverse[i][j]);
        // the derivatives of the estimated quantities by each change
        let c = Matrix3::from_fn(|i, j| k.triangle[i][j]);
        let mut by = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
        for a in 0..6 {
            let mut unit = [0.0; 6];
            unit[a] = 1.0;
            let x = symmetric(&unit);
            let dk = c * Matrix3::from_fn(|i, j| x[i][j]) * c.transpose();
            let dj = -inertia * dk * inertia;
            for (b, place) in PLACES.iter().enumerate() {
                by[(9 + b, 9 + a)] = dj[*place];
            }
        }
        by[(15, 15)] = self.start.mu;
        let (spread, curved) = sandwiched(&self.information, &self.curvature)?;
        let covariance = by * spread * by.transpose();
        let degrees = 3 * self.corrected.rows() - UNKNOWNS;
        Some(SolidState {
            centre: Vector3::from(self.start.centre),
            velocity: Vector3::from(self.start.velocity),
            rate: Vector3::from(self.start.rate),
            inertia_over_mass: inertia,
            mass: 1.0 / self.start.mu,
            covariance,
            curved,
            bent: self.bent,
            is_minimum: self.is_minimum,
            rival: None,
            chi_square: self.chi_square,
            degrees,
            rms_residual: self.rms_residual,
            ratio: self.ratio,
            weighed: self.weighed,
            contacts_are_stated: self.corrected.contact_deviation > 0.0,
            is_stated: self.corrected.contact_deviation > 0.0 || self.corrected.torque_deviation > 0.0,
        })
    }
}
