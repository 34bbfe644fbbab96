//! Newton's method for the error of the output (4.78), as a solver of argmin.

use super::window::{Window, WindowExpansion};
use super::{Lost, Order};
use argmin::core::{Error, IterState, KV, Problem, Solver, State, TerminationReason, TerminationStatus};
use nalgebra::{Cholesky, DMatrix, DVector};

/// What a solver knows between two steps: the guess, the gradient, the Hessian.
pub(super) type Iteration = IterState<DVector<f64>, DVector<f64>, (), DMatrix<f64>, (), f64>;

/// A step shorter than this fraction of the unknowns' sizes ends the search.
const SHORTEST: f64 = 1e-13;
/// And so does one shorter than this that does not lower the error any more: the rest is rounding.
const SHORT: f64 = 1e-9;
/// A step is halved so often at most.
const HALVINGS: usize = 12;

/// Newton's method.
///
/// Needs the error of the output with its exact first and second derivatives (`Window::expand`).
///
/// Each step is `-H^-1 grad k`. Where `H` is not positive definite `k` is not convex there, which 4.78 presupposes, and the
/// step is that of Gauss and Newton, whose matrix is never indefinite; where a step would raise `k`, or lead to where the
/// model cannot be followed, it is halved. Both are counted. Near the solution neither happens, and the convergence is
/// quadratic.
///
/// Reference: M. Moll 2002, section 4.5, after G. Zimmer, State observation by on-line minimization, 1994.
#[derive(Clone, Debug, Default)]
pub struct Newton {
    /// The magnitudes of the unknowns.
    pub sizes: Vec<f64>,
    /// Steps whose Hessian was not positive definite.
    pub not_convex: usize,
    /// Halved steps.
    pub halved: usize,
    converged: bool,
    stuck: bool,
}

impl Newton {
    /// For unknowns of these magnitudes.
    pub fn new(sizes: Vec<f64>) -> Newton {
        Newton { sizes, ..Newton::default() }
    }
}

/// The solution of `matrix * x = right` for a positive definite matrix whose unknowns have the given sizes.
fn solve_definite(matrix: &DMatrix<f64>, right: &DVector<f64>, sizes: &[f64]) -> Option<DVector<f64>> {
    let p = right.len();
    let scaled = DMatrix::from_fn(p, p, |i, j| matrix[(i, j)] * sizes[i] * sizes[j]);
    let right = DVector::from_fn(p, |i, _| right[i] * sizes[i]);
    let solution = Cholesky::new(scaled)?.solve(&right);
    let solution = DVector::from_fn(p, |i, _| solution[i] * sizes[i]);
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}

/// The largest component of a step in units of the unknowns' sizes.
pub(super) fn length(step: &DVector<f64>, sizes: &[f64]) -> f64 {
    step.iter().zip(sizes).map(|(step, size)| (step / size).abs()).fold(0.0, f64::max)
}

impl Newton {
    fn direction(&mut self, expansion: &WindowExpansion) -> Option<DVector<f64>> {
        if let Some(step) = solve_definite(&expansion.hessian, &expansion.gradient, &self.sizes) {
            return Some(-step);
        }
        self.not_convex += 1;
        gauss_newton(expansion, &self.sizes, 0.0)
    }
}

/// The step of Gauss and Newton with the damping `lambda` (Levenberg, Marquardt), by least squares and not by `J^T J`.
pub(super) fn gauss_newton(expansion: &WindowExpansion, sizes: &[f64], lambda: f64) -> Option<DVector<f64>> {
    let (n, p) = expansion.slopes.shape();
    let damping = lambda.sqrt();
    let matrix = DMatrix::from_fn(n + p, p, |i, j| {
        if i < n {
            expansion.slopes[(i, j)] * sizes[j]
        } else if i - n == j {
            damping
        } else {
            0.0
        }
    });
    let right = DVector::from_fn(n + p, |i, _| if i < n { -expansion.differences[i] } else { 0.0 });
    if matrix.iter().chain(right.iter()).any(|value| !value.is_finite()) {
        return None;
    }
    let svd = matrix.try_svd(true, true, f64::EPSILON, 10_000)?;
    let step = svd.solve(&right, svd.singular_values.max() * 1e-14).ok()?;
    Some(DVector::from_fn(p, |i, _| step[i] * sizes[i]))
}

impl Solver<Window<'_>, Iteration> for Newton {
    fn name(&self) -> &str {
        "Newton"
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<Window<'_>>,
        state: Iteration,
    ) -> Result<(Iteration, Option<KV>), Error> {
        let guess = state.get_param().cloned().ok_or_else(no_guess)?;
        let expansion = problem.problem("expansions", |window| Ok(window.expand(&guess, Order::Second)?))?;
        let Some(mut step) = self.direction(&expansion) else {
            self.stuck = true;
            return Ok((state.param(guess).cost(expansion.cost), None));
        };
        let mut cost = None;
        for _ in 0..HALVINGS {
            let short = length(&step, &self.sizes) < 1e-6; // the change of k drowns in its rounding
            let tried: Result<f64, Lost> =
                problem.problem("costs", |window| Ok(window.cost(&(&guess + &step))))?;
            match tried {
                Ok(value) if short || value <= expansion.cost => {
                    cost = Some(value);
                    break;
                }
                _ => {
                    self.halved += 1;
                    step *= 0.5;
                }
            }
        }
        let Some(cost) = cost else {
            self.stuck = true;
            return Ok((state.param(guess).cost(expansion.cost), None));
        };
        self.converged = settled(length(&step, &self.sizes), expansion.cost, cost);
        Ok((
            state.param(guess + step).gradient(expansion.gradient).hessian(expansion.hessian).cost(cost),
            None,
        ))
    }

    fn terminate(&mut self, _state: &Iteration) -> TerminationStatus {
        match (self.converged, self.stuck) {
            (true, _) => TerminationStatus::Terminated(TerminationReason::SolverConverged),
            (_, true) => TerminationStatus::Terminated(TerminationReason::SolverExit(
                "no step lowers the error".into(),
            )),
            _ => TerminationStatus::NotTerminated,
        }
    }
}

/// Whether a search is at its end after a step of this length, from one error to another.
pub(super) fn settled(length: f64, before: f64, after: f64) -> bool {
    length < SHORTEST || (length < SHORT && after >= before * (1.0 - 1e-6))
}

pub(super) fn no_guess() -> Error {
    Error::msg("a first guess is needed")
}
