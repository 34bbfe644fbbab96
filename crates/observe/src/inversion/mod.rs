//! A start of multiple shooting that needs no guess: Lie derivatives inverted on smoothed measurements.
//!
//! Where the outputs and their derivatives along the motion determine the state, the map `x -> (h, L_f h, L_f^2 h, ...)` can be solved for it: its
//! left side is taken from polynomials through the measurements near a time (A. Savitzky, M. J. E. Golay, Smoothing and
//! differentiation of data by simplified least squares procedures, 1964). With the derivatives of the signals that drive the system the map is that of R. Hermann, A. J. Krener, Nonlinear
//! controllability and observability, 1977. High derivatives of noisy measurements are worth little, so that the result is where a search begins and no answer: the
//! polynomials are fitted over stretches of several lengths, and the start is that whose segments have the least residual.

mod map;

use super::nodes::{Bounds, Nodes, Segments};
use super::starts::range;
use super::task::Task;
use map::{ObservabilityMap, SignalDerivatives};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// At so many places of a window the map is solved at once, for the states there and the constants that all of them share.
const ANCHORS: usize = 6;

/// So many first values are tried for that, drawn from the sample box, beside the guess.
const DRAWS: usize = 8;

/// Steps of the damped least squares.
const STEPS: usize = 40;

/// The nodes at which the inverted map begins; none where there is no such map, or nothing solves it.
pub(super) fn nodes(
    task: &Task<'_>,
    segments: &Segments<'_>,
    bounds: &Bounds,
    (belief, rows, clamped): (&[f64], &Range<usize>, &[usize]),
) -> Option<Nodes> {
    if !clamped.is_empty() || task.full.has_implicit() || segments.moving.is_empty() {
        return None;
    }
    let draws = drawn_states(task, segments, belief, rows, bounds);
    let map = ObservabilityMap::new(task, segments, rows, &draws)?;
    let degree = map.degree();
    let mut stretch = degree + 2;
    let mut best: Option<(f64, Nodes)> = None;
    while stretch <= rows.len() && !task.interrupted() {
        let found = solved(&map, task, (segments, bounds), rows, (stretch, degree), &draws);
        if let Some(found) = found
            && let Ok(expanded) = segments.expand(&found)
        {
            let cost: f64 = expanded.iter().map(|segment| segment.cost(1.0)).sum();
            if cost.is_finite() && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, found));
            }
        }
        stretch = if stretch < rows.len() { (2 * stretch).min(rows.len()) } else { rows.len() + 1 };
    }
    best.map(|(_, nodes)| nodes)
}

/// The guess, and states of the sample box.
fn drawn_states(
    task: &Task<'_>,
    segments: &Segments<'_>,
    belief: &[f64],
    rows: &Range<usize>,
    bounds: &Bounds,
) -> Vec<Vec<f64>> {
    let first = task.full_state(belief, rows.start);
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut draw = |is_drawn: bool| {
        let mut state = first.clone();
        for place in segments.moving.iter().chain(&segments.constant) {
            let part = random.random::<f64>();
            if is_drawn && let Some(([low, high], _)) = range(task, *place) {
                state[*place] = low + part * (high - low);
            }
            state[*place] = bounds.within(0, *place, state[*place]);
        }
        state
    };
    (0..=DRAWS).map(|i| draw(i > 0)).collect()
}

/// The nodes by derivatives from stretches of so many rows, by polynomials of a degree.
fn solved(
    map: &ObservabilityMap,
    task: &Task<'_>,
    (segments, bounds): (&Segments<'_>, &Bounds),
    rows: &Range<usize>,
    polynomials: (usize, usize),
    draws: &[Vec<f64>],
) -> Option<Nodes> {
    let at = |segment: &Range<usize>| map.given(task, rows, rows.start + segment.start, polynomials);
    let given: Vec<SignalDerivatives> = segments.rows.iter().map(at).collect::<Option<_>>()?;
    let read: Vec<Vec<f64>> = given.iter().map(|given| map.read(task, given)).collect();
    // a row counts in units of what it is in the window
    let size = |row: usize| {
        let squares: f64 = read.iter().map(|read| read[row] * read[row]).sum();
        (squares / read.len() as f64).sqrt().max(1e-9)
    };
    let sizes: Vec<f64> = (0..map.rows).map(size).collect();
    let problem = Inversion { map, segments, bounds, given: &given, read: &read, sizes: &sizes };
    let last = segments.rows.len() - 1;
    let mut anchors: Vec<usize> = (1..=ANCHORS).map(|i| last * i / (ANCHORS + 1)).collect();
    anchors.dedup();
    let mut best: Option<(f64, Vec<Vec<f64>>)> = None;
    for state in draws {
        // a measured state begins at its measurement
        let first = |node: &usize| {
            let place = |place: usize| {
                let column = task.full.column_of(place)?;
                Some(bounds.within(*node, place, given[*node][&column][0]))
            };
            (0..state.len()).map(|i| place(i).unwrap_or(state[i])).collect()
        };
        let states: Vec<Vec<f64>> = anchors.iter().map(first).collect();
        if let Some((cost, states)) = problem.solve(&anchors, states, true)
            && best.as_ref().is_none_or(|(least, _)| cost < *least)
        {
            best = Some((cost, states));
        }
    }
    let (_, known) = best?;
    let mut moving = Vec::new();
    for node in 0..=last {
        let nearest = (0..anchors.len()).min_by_key(|i| anchors[*i].abs_diff(node))?;
        let begin = vec![known[nearest].clone()];
        let state = match problem.solve(&[node], begin, false) {
            Some((_, states)) => states.into_iter().next()?,
            None => known[nearest].clone(),
        };
        moving.push(DVector::from_iterator(
            segments.moving.len(),
            segments.moving.iter().map(|place| bounds.within(node, *place, state[*place])),
        ));
    }
    let constant = segments.constant.iter().map(|place| bounds.within(0, *place, known[0][*place]));
    Some(Nodes { moving, constant: DVector::from_iterator(segments.constant.len(), constant) })
}

/// The map at the nodes of a window, set equal to the measurements.
struct Inversion<'a> {
    map: &'a ObservabilityMap,
    segments: &'a Segments<'a>,
    bounds: &'a Bounds,
    given: &'a [SignalDerivatives],
    read: &'a [Vec<f64>],
    sizes: &'a [f64],
}

impl Inversion<'_> {
    /// Levenberg and Marquardt's method for the states at some nodes, with the constants that they share or without; the residual error.
    fn solve(
        &self,
        nodes: &[usize],
        mut states: Vec<Vec<f64>>,
        with_constants: bool,
    ) -> Option<(f64, Vec<Vec<f64>>)> {
        let (mut cost, mut left, mut slopes) = self.expand(nodes, &states, with_constants)?;
        let (mut lambda, mut growth) = (1e-2, 2.0);
        for _ in 0..STEPS {
            let mut normal = slopes.tr_mul(&slopes);
            let width = normal.nrows();
            (0..width).for_each(|i| normal[(i, i)] += lambda);
            let step = normal.cholesky()?.solve(&slopes.tr_mul(&-&left));
            let there = self.moved(nodes, &states, &step, with_constants);
            match self.expand(nodes, &there, with_constants).filter(|(after, ..)| *after < cost) {
                Some((after, left_there, slopes_there)) => {
                    let is_settled = cost - after <= 1e-10 * cost;
                    (cost, left, slopes, states) = (after, left_there, slopes_there, there);
                    (lambda, growth) = ((lambda * 0.2_f64).max(1e-14), 2.0);
                    if is_settled {
                        break;
                    }
                }
                None if lambda > 1e8 => break,
                None => (lambda, growth) = (lambda * growth, growth * 2.0),
            }
        }
        Some((cost, states))
    }

    fn moved(
        &self,
        nodes: &[usize],
        states: &[Vec<f64>],
        step: &DVector<f64>,
        with_constants: bool,
    ) -> Vec<Vec<f64>> {
        let (moving, constant) = (&self.segments.moving, &self.segments.constant);
        let mut there = states.to_vec();
        for (i, (state, node)) in there.iter_mut().zip(nodes).enumerate() {
            for (j, place) in moving.iter().enumerate() {
                let value = state[*place] + step[i * moving.len() + j] * self.segments.sizes[*place];
                state[*place] = self.bounds.within(*node, *place, value);
            }
            for (j, place) in constant.iter().enumerate().filter(|_| with_constants) {
                let value =
                    state[*place] + step[nodes.len() * moving.len() + j] * self.segments.sizes[*place];
                state[*place] = self.bounds.within(0, *place, value);
            }
        }
        there
    }

    /// The error, the residual of each row at each node, and the derivatives: first by the moving states node by node, then by the constants.
    fn expand(
        &self,
        nodes: &[usize],
        states: &[Vec<f64>],
        with_constants: bool,
    ) -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        let (moving, constant) = (&self.segments.moving, &self.segments.constant);
        let (m, n) = (self.map.rows, moving.len());
        let width = nodes.len() * n + if with_constants { constant.len() } else { 0 };
        let mut left = DVector::zeros(nodes.len() * m);
        let mut slopes = DMatrix::zeros(nodes.len() * m, width);
        for (i, (node, state)) in nodes.iter().zip(states).enumerate() {
            let (rows, by) = self.map.at(state, &self.given[*node])?;
            for row in 0..m {
                left[i * m + row] = (rows[row] - self.read[*node][row]) / self.sizes[row];
                let slope = |place: usize| by[(row, place)] * self.segments.sizes[place] / self.sizes[row];
                for (j, place) in moving.iter().enumerate() {
                    slopes[(i * m + row, i * n + j)] = slope(*place);
                }
                for (j, place) in constant.iter().enumerate().filter(|_| with_constants) {
                    slopes[(i * m + row, nodes.len() * n + j)] = slope(*place);
                }
            }
        }
        let cost = left.norm_squared();
        cost.is_finite().then_some((cost, left, slopes))
    }
}
