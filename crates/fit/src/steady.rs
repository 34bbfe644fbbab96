//! Steady states before an experiment, with their derivatives by the parameters from the equations that the steady state obeys.
//!
//! The states alone are followed to their rest, which is many times less work than following the sensitivities too, most of all where rates differ
//! by many orders of magnitude. At rest `f(x, p) = 0`, and what is conserved is what it was at the start: `W x = W x0`. Differentiated by the
//! parameters these are linear equations for the sensitivities.
//!
//! Reference: G. T. Lines, L. Paszkowski, L. Schmiester, D. Weindl, P. Stapor, J. Hasenauer, Efficient computation of steady states in
//! large-scale ODE models of biochemical reaction networks, IFAC-PapersOnLine 52 (2019) 32-37.

use super::compiled::{CompiledPhase, Room};
use super::simulate::{At, How, Moment};
use nalgebra::{DMatrix, DVector};

/// Singular values below this part of the largest are zero, once rows are scaled to one and states are in parts of their sizes.
const ZERO: f64 = 1e-11;

/// A sum of terms is zero that is smaller than this part of its terms.
const CANCELS: f64 = 1e-9;

/// Singular values take no more sweeps than these.
const MOST_ITERATIONS: usize = 10_000;

/// How far, in parts of its size, each state is moved for a point at which a conservation law is tried once more.
const ASIDE: [f64; 4] = [0.37, 0.81, 0.59, 0.23];

/// Added to the size of a state.
const LEAST: f64 = 1e-3;

/// So near to each other are derivatives of a state that are the same, in parts of the largest of them and of the state.
const AGREES: f64 = 1e-3;

/// The size of a state, as it counts.
fn size(state: f64) -> f64 {
    state.abs() + LEAST
}

/// What the equations of a steady state give.
struct Solved {
    /// How many sums are conserved.
    laws: usize,
    /// The derivatives by the parameters.
    slopes: DMatrix<f64>,
    /// Newton's step to the rest.
    step: DVector<f64>,
}

/// The rates at some states with their derivatives: dense, the clock left out, parameters on their scales.
struct Linearised {
    rates: DVector<f64>,
    by_states: DMatrix<f64>,
    by_parameters: DMatrix<f64>,
}

impl CompiledPhase {
    /// The steady state that is reached from a start.
    ///
    /// # Errors
    /// When it cannot be followed, and why.
    pub fn rest(&self, at: &At<'_>, start: &Moment, how: &How<'_>) -> Result<Moment, (f64, String)> {
        let states_alone = How { slopes: false, ..*how };
        let (_, rest) = self.follow(at, start, &[], Some(self.clock), &states_alone)?;
        let Some(rest) = rest else { return Err((0.0, "it does not come to rest".to_owned())) };
        if !how.slopes {
            return Ok(rest);
        }
        if let Some(slopes) = self.slopes_at_rest(at, start, &rest) {
            return Ok(Moment { slopes, states: rest.states });
        }
        let (_, rest) = self.follow(at, start, &[], Some(self.clock), how)?;
        rest.ok_or_else(|| (0.0, "it does not come to rest".to_owned()))
    }

    /// The derivatives of a steady state; none where its equations and what is conserved do not determine them.
    ///
    /// Where what is left depends on all that happened, as in an epidemic, the Jacobian matrix near the rest is regular, and singular at the rest itself. So
    /// the derivatives are taken near it and nearer, and have to be the same.
    pub fn slopes_at_rest(&self, at: &At<'_>, start: &Moment, rest: &Moment) -> Option<DMatrix<f64>> {
        let near = self.equations(at, start, &rest.states)?;
        let nearer: Vec<f64> =
            rest.states.iter().zip(near.step.iter()).map(|(one, step)| one + step).collect();
        let nearer = self.equations(at, start, &nearer)?;
        // state by state, in the unit of each
        let is_same = |(row, state): (usize, &f64)| {
            let (one, other) = (near.slopes.row(row), nearer.slopes.row(row));
            (one - other).amax() <= AGREES * (size(*state) + other.amax())
        };
        let agree = near.laws == nearer.laws && rest.states.iter().enumerate().all(is_same);
        agree.then_some(nearer.slopes)
    }

    /// The linear equations for the slopes at some states, solved.
    fn equations(&self, at: &At<'_>, start: &Moment, states: &[f64]) -> Option<Solved> {
        let (n, p) = (states.len(), at.values.len());
        let here = self.linearised(at, states)?;
        // a slow reaction counts as much as a fast one, and states by their sizes, as where it is asked whether they rest
        let largest_in = |row: usize| {
            let terms = (0..n).map(|column| (here.by_states[(row, column)] * size(states[column])).abs());
            terms.fold(0.0, f64::max)
        };
        let rows: Vec<f64> =
            (0..n).map(largest_in).map(|largest| if largest == 0.0 { 1.0 } else { largest }).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| here.by_states[(i, j)] * size(states[j]) / rows[i]);
        let svd = scaled.clone().try_svd(true, false, f64::EPSILON, MOST_ITERATIONS)?;
        let from_left = svd.u.as_ref()?;
        let kept = ZERO * svd.singular_values.max().max(f64::MIN_POSITIVE);
        let laws: Vec<DVector<f64>> = (0..n)
            .filter(|i| svd.singular_values[*i] <= kept)
            // of the rows as they are
            .map(|i| DVector::from_fn(n, |row, _| from_left[(row, i)] / rows[row]))
            .map(|law| &law / law.amax())
            .collect();
        let laws = self.without_clock(laws);
        if !laws.is_empty() && !self.are_conserved(at, &laws, [&start.states, states]) {
            return None;
        }
        let still = usize::from(self.clock.is_some());
        let equations = n + laws.len() + still;
        let mut matrix = DMatrix::zeros(equations, n);
        // the slopes by the parameters, and in the last column the way to the rest itself
        let mut right = DMatrix::zeros(equations, p + 1);
        matrix.rows_mut(0, n).copy_from(&scaled);
        for row in 0..n {
            for column in 0..p {
                right[(row, column)] = -here.by_parameters[(row, column)] / rows[row];
            }
            right[(row, p)] = -here.rates[row] / rows[row];
        }
        for (place, law) in laws.iter().enumerate() {
            let in_columns = DVector::from_fn(n, |column, _| law[column] * size(states[column]));
            let largest = in_columns.amax();
            matrix.row_mut(n + place).copy_from(&(in_columns.transpose() / largest));
            let conserved = law.transpose() * &start.slopes / largest;
            right.view_mut((n + place, 0), (1, p)).copy_from(&conserved);
        }
        if let Some(clock) = self.clock {
            // time does not depend on any parameter
            matrix[(equations - 1, clock)] = 1.0;
        }
        let svd = matrix.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS)?;
        if svd.singular_values.min() <= ZERO * svd.singular_values.max() {
            return None;
        }
        let mut slopes = svd.solve(&right, 0.0).ok()?;
        for (mut row, state) in slopes.row_iter_mut().zip(states) {
            row *= size(*state);
        }
        let step = slopes.column(p).clone_owned();
        let found = Solved { laws: laws.len(), slopes: slopes.columns(0, p).clone_owned(), step };
        slopes.iter().all(|slope| slope.is_finite()).then_some(found)
    }

    /// Laws without the clock, whose row and column are zero and which by itself would be one.
    fn without_clock(&self, laws: Vec<DVector<f64>>) -> Vec<DVector<f64>> {
        let Some(clock) = self.clock else { return laws };
        // the row of the clock is zero, so that a basis of the laws has it apart: what is left of the others is their own basis
        let mut found: Vec<DVector<f64>> = Vec::new();
        for mut law in laws {
            law[clock] = 0.0;
            for other in &found {
                law -= other * (other.dot(&law) / other.norm_squared());
            }
            if law.amax() > 1e-6 {
                found.push(&law / law.amax());
            }
        }
        found
    }

    /// Whether sums of the states are conserved by the rates whatever the states and the parameters are: at the start, at rest and at two points aside.
    fn are_conserved(&self, at: &At<'_>, laws: &[DVector<f64>], [start, rest]: [&[f64]; 2]) -> bool {
        if self.clock.is_some_and(|clock| self.rates.by_states.iter().any(|[_, column]| *column == clock)) {
            // what flows in for a while is not seen at a few points
            return false;
        }
        let aside = |way: usize| -> Vec<f64> {
            let between = start.iter().zip(rest).enumerate().map(|(i, (one, other))| {
                let part = ASIDE[(i + way) % ASIDE.len()];
                part * one + (1.0 - part) * other + 0.1 * part * (one.abs() + other.abs())
            });
            between.collect()
        };
        [start.to_vec(), rest.to_vec(), aside(0), aside(1)].iter().all(|states| {
            self.linearised(at, states).is_some_and(|there| {
                laws.iter().all(|law| {
                    let cancels = |values: &[f64]| {
                        let terms = law.iter().zip(values).map(|(weight, value)| weight * value);
                        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size): (f64, f64), term| {
                            (sum + term, size + term.abs())
                        });
                        sum.abs() <= CANCELS * size
                    };
                    let of_columns = |matrix: &DMatrix<f64>| {
                        matrix.column_iter().all(|column| cancels(column.clone_owned().as_slice()))
                    };
                    of_columns(&there.by_states) && of_columns(&there.by_parameters)
                })
            })
        })
    }

    /// The rates and their derivatives at some states; none where one has no value.
    fn linearised(&self, at: &At<'_>, states: &[f64]) -> Option<Linearised> {
        let (n, p) = (states.len(), at.values.len());
        let mut room = Room::default();
        let mut derivatives = vec![0.0; self.rates.by_states.len() + self.rates.by_parameters.len()];
        self.rates.slopes.run(states, at.values, &mut room, &mut derivatives);
        let mut rates = vec![0.0; n];
        self.rates.values.run(states, at.values, &mut room, &mut rates);
        let mut found = Linearised {
            rates: DVector::from_vec(rates),
            by_states: DMatrix::zeros(n, n),
            by_parameters: DMatrix::zeros(n, p),
        };
        let (by_states, by_parameters) = derivatives.split_at(self.rates.by_states.len());
        for ([row, column], slope) in self.rates.by_states.iter().zip(by_states) {
            found.by_states[(*row, *column)] = *slope;
        }
        for ([row, column], slope) in self.rates.by_parameters.iter().zip(by_parameters) {
            found.by_parameters[(*row, *column)] = slope * at.slopes[*column];
        }
        if let Some(clock) = self.clock {
            found.rates[clock] = 0.0;
            found.by_states.row_mut(clock).fill(0.0);
            found.by_states.column_mut(clock).fill(0.0);
            found.by_parameters.row_mut(clock).fill(0.0);
        }
        let mut all = found.rates.iter().chain(found.by_states.iter()).chain(found.by_parameters.iter());
        all.all(|value| value.is_finite()).then_some(found)
    }
}
