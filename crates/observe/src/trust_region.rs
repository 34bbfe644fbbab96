//! Gauss and Newton's method within a region of trust, as a solver of argmin.

use super::newton::{Iteration, gauss_newton, length, no_guess, settled};
use super::window::{Window, WindowExpansion};
use super::{Lost, Order};
use argmin::core::{Error, KV, Problem, Solver, State, TerminationReason, TerminationStatus};
use nalgebra::DVector;

/// The damping beyond which no step is tried any more.
const STRONGEST: f64 = 1e16;

/// Levenberg and Marquardt's method.
///
/// Needs the error of the output with its exact first derivatives (`Window::expand`).
///
/// Each step minimises `|r + J p|^2 + lambda |p|^2`, `p` in units of the unknowns' sizes; `lambda` falls while the error falls as
/// foretold, and rises where it does not, which bounds the step as a radius would.
///
/// Reference: K. Madsen, H. B. Nielsen, O. Tingleff, Methods for non-linear least squares problems, 2004, section 3.2.
#[derive(Clone, Debug)]
pub struct TrustRegion {
    /// The magnitudes of the unknowns.
    pub sizes: Vec<f64>,
    /// Refused steps.
    pub refused: usize,
    lambda: f64,
    growth: f64,
    here: Option<WindowExpansion>,
    converged: bool,
    stuck: bool,
}

impl TrustRegion {
    /// For unknowns of these magnitudes.
    pub fn new(sizes: Vec<f64>) -> TrustRegion {
        let (lambda, growth) = (0.0, 2.0);
        TrustRegion { sizes, refused: 0, lambda, growth, here: None, converged: false, stuck: false }
    }

    /// The next step; between bounds where there are some, by a set of those that hold (J. Nocedal, S. J. Wright, Numerical Optimization, 2006, section 16.5): what lies at one
    /// and is pushed against it stays there, what would go beyond one ends there, and all else takes the best step that is left to it.
    fn within(
        &self,
        problem: &Problem<Window<'_>>,
        here: &WindowExpansion,
        guess: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let bounds = problem.problem.as_ref().map_or(&[][..], |window| &window.bounds);
        if bounds.is_empty() {
            return gauss_newton(here, &self.sizes, self.lambda);
        }
        let pushed = |i: usize| {
            let [low, high] = bounds[i];
            (guess[i] <= low && here.gradient[i] > 0.0) || (guess[i] >= high && here.gradient[i] < 0.0)
        };
        let mut held: Vec<Option<f64>> = (0..bounds.len()).map(|i| pushed(i).then_some(0.0)).collect();
        loop {
            let mut free = here.clone();
            for (i, step) in held.iter().enumerate() {
                let Some(step) = step else { continue };
                free.differences.axpy(*step, &here.slopes.column(i), 1.0);
                free.slopes.column_mut(i).fill(0.0);
            }
            let own = gauss_newton(&free, &self.sizes, self.lambda)?;
            let step = DVector::from_fn(own.len(), |i, _| held[i].unwrap_or(own[i]));
            let mut is_within = true;
            for (i, [low, high]) in bounds.iter().enumerate() {
                let there = guess[i] + step[i];
                if held[i].is_none() && (there < *low || there > *high) {
                    held[i] = Some(there.clamp(*low, *high) - guess[i]);
                    is_within = false;
                }
            }
            if is_within {
                return Some(step);
            }
        }
    }

    /// How much smaller `2k/dt` should be after a step, by the linear model.
    fn foretold(&self, here: &WindowExpansion, step: &DVector<f64>) -> f64 {
        let after = &here.differences + &here.slopes * step;
        here.differences.norm_squared() - after.norm_squared()
    }
}

impl Solver<Window<'_>, Iteration> for TrustRegion {
    fn name(&self) -> &str {
        "trust region"
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<Window<'_>>,
        state: Iteration,
    ) -> Result<(Iteration, Option<KV>), Error> {
        let guess = state.get_param().cloned().ok_or_else(no_guess)?;
        let here = match self.here.take() {
            Some(here) => here,
            None => {
                let here =
                    problem.problem("expansions", |window| Ok(window.expand(&guess, Order::First)?))?;
                let scaled = here
                    .slopes
                    .column_iter()
                    .zip(&self.sizes)
                    .map(|(c, size)| c.norm_squared() * size * size);
                // what was learned before may weigh some directions far more than others: damping would hide these
                let is_near = problem.problem.as_ref().is_some_and(|window| window.relations() > 0);
                self.lambda = if is_near { 1e-16 } else { 1e-6 } * scaled.fold(0.0, f64::max);
                here
            }
        };
        while self.lambda < STRONGEST {
            let Some(step) = self.within(problem, &here, &guess) else { break };
            let short = length(&step, &self.sizes);
            let tried: Result<WindowExpansion, Lost> = problem.problem("expansions", |window| {
                Ok(window.expand(&window.held(&guess + &step), Order::First))
            })?;
            if let Ok(there) = tried {
                let gain = here.differences.norm_squared() - there.differences.norm_squared();
                let ratio = gain / self.foretold(&here, &step);
                if ratio > 0.0 || short < 1e-9 {
                    let shrink = 1.0 - (2.0 * ratio - 1.0).powi(3);
                    self.lambda *= if ratio.is_finite() { shrink.clamp(1e-3, 2.0) } else { 1.0 };
                    self.growth = 2.0;
                    self.converged = settled(short, here.cost, there.cost);
                    let there_is = problem.problem("steps", |window| Ok(window.held(&guess + &step)))?;
                    let state = state.param(there_is).cost(there.cost).gradient(there.gradient.clone());
                    self.here = Some(there);
                    return Ok((state, None));
                }
            }
            self.refused += 1;
            self.lambda = (self.lambda * self.growth).max(1e-300);
            self.growth *= 2.0;
        }
        self.stuck = true;
        let state = state.param(guess).cost(here.cost);
        self.here = Some(here);
        Ok((state, None))
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
