//! Shape and motion of a body from all readings of a record at once, by least squares.
//!
//! The body slides between two flat palms by its one law of motion (`law`), so that all contacts follow from its rate at the first sample and its
//! support function: a handful of unknowns for hundreds of readings. No torque and no mass is in it, no derivative of a reading, and no window: what
//! a method by windows forgets from one to the next is kept here. Levenberg and Marquardt's method begins at a shape and a rate that others found, on the first part of the record, and goes
//! on to all of it; then harmonics are added while G. Schwarz's criterion says that they tell something.

use super::record::{Followed, Unknowns, WholeRecord};
use crate::shape::{ORDERS, ShapeEstimate, SupportSeries, convex_deviation};
use nalgebra::{DMatrix, DVector};
use std::sync::atomic::{AtomicBool, Ordering};

/// What a whole record told.
pub(super) struct Found {
    pub unknowns: Unknowns,
    /// Of the free unknowns, with what the misfit adds.
    pub covariance: DMatrix<f64>,
    pub shape: ShapeEstimate,
    pub motion: Vec<Followed>,
    /// The root of the mean square of what is left of a contact, in m.
    pub misfit: f64,
}

/// The highest order that is tried.
const MOST: usize = 32;

/// Steps for one order at most.
const STEPS: usize = 30;

/// A step that lowers the sum of the squares by less than this part of itself is the last one, unless it is below what follows.
const SETTLED: f64 = 1e-9;

/// So many orders without a better criterion end the search: a body with fourfold symmetry has none of the orders 5 and 6.
const PATIENCE: usize = 3;

/// Parts of the record that are explained one after the other.
const PARTS: [f64; 4] = [0.15, 0.3, 0.6, 1.0];

/// Fewer rows than these are no part.
const FEWEST: usize = 24;

/// A misfit below this part of the mean radius is one of the shape; a larger one is one of a motion that is another.
const FOUND: f64 = 1e-2;

/// So many of the discs go on.
const KEPT: usize = 6;

/// The best unknowns of some rows and order.
#[derive(Clone)]
struct Best {
    x: Unknowns,
    cost: f64,
}

impl Best {
    /// The criterion of G. Schwarz (1978), the variance of the readings being known.
    fn criterion(&self, rows: usize) -> f64 {
        self.cost + self.x.support.len() as f64 * (2.0 * rows as f64).ln()
    }
}

impl WholeRecord {
    /// Shape and motion, from where others began; none where nothing can be followed, or it was interrupted.
    ///
    /// Where what they found explains nothing it is sought from discs at rates on a grid.
    pub fn explain(&self, starts: &[Unknowns], interrupt: &AtomicBool) -> Option<Found> {
        let rows = self.times.len();
        let stop = || interrupt.load(Ordering::Relaxed);
        let mut best: Option<Best> = None;
        for start in starts {
            let straight = self.descend(start.clone(), rows, interrupt);
            let mut ends = vec![straight];
            if !ends[0].as_ref().is_some_and(|end| self.is_explained(end, rows)) {
                ends.push(self.by_parts(start.clone(), 0, interrupt));
            }
            best =
                best.into_iter().chain(ends.into_iter().flatten()).min_by(|a, b| a.cost.total_cmp(&b.cost));
            if stop() || best.as_ref().is_some_and(|best| self.is_explained(best, rows)) {
                break;
            }
        }
        let is_found = |best: &Best| self.misfit(best, rows) < FOUND * best.x.support[0];
        if !best.as_ref().is_some_and(is_found) && !stop() {
            best = best
                .into_iter()
                .chain(self.begun_as_discs(interrupt))
                .min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        let best = self.choose_order(best?, interrupt)?;
        if stop() { None } else { self.found(best.x) }
    }

    /// The first parts of the record one after the other, from one of [`PARTS`] on.
    fn by_parts(&self, start: Unknowns, first: usize, interrupt: &AtomicBool) -> Option<Best> {
        let mut end = None;
        let mut x = start;
        for part in &PARTS[first..] {
            let best = self.descend(x, self.part(*part), interrupt)?;
            x = best.x.clone();
            end = Some(best);
        }
        end
    }

    fn part(&self, part: f64) -> usize {
        let rows = self.times.len();
        ((part * rows as f64) as usize).clamp(rows.min(FEWEST), rows)
    }

    /// From discs that turn at one rate each: the best few by the first part of the record go on to all of it.
    fn begun_as_discs(&self, interrupt: &AtomicBool) -> Option<Best> {
        let rows = self.part(PARTS[0]);
        let starts = self.discs().into_iter();
        let mut begun: Vec<Best> = starts.filter_map(|start| self.descend(start, rows, interrupt)).collect();
        begun.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut best: Option<Best> = None;
        for begin in begun.into_iter().take(KEPT) {
            let end = self.by_parts(begin.x, 1, interrupt);
            best = best.into_iter().chain(end).min_by(|a, b| a.cost.total_cmp(&b.cost));
            if best.as_ref().is_some_and(|best| self.is_explained(best, self.times.len())) {
                break;
            }
        }
        best
    }

    /// The root of the mean square of what is left of a contact, in m.
    fn misfit(&self, best: &Best, rows: usize) -> f64 {
        self.sigma * (best.cost / (2 * rows) as f64).sqrt()
    }

    /// Whether what is left is no more than noise leaves, five deviations of the sum of so many squares added.
    fn is_explained(&self, best: &Best, rows: usize) -> bool {
        let n = 2.0 * rows as f64;
        best.cost <= n + 5.0 * (2.0 * n).sqrt()
    }

    /// More harmonics while they tell something, and fewer while these tell nothing.
    fn choose_order(&self, start: Best, interrupt: &AtomicBool) -> Option<Best> {
        let rows = self.times.len();
        let first = start.x.support.len() / 2;
        let most = MOST.min(rows / 4).max(first);
        let mut best = start.clone();
        let (mut last, mut idle) = (start.clone(), 0);
        for order in ORDERS.into_iter().filter(|order| (first + 1..=most).contains(order)) {
            let mut x = last.x.clone();
            x.support.resize(1 + 2 * order, 0.0);
            let Some(end) = self.descend(x, rows, interrupt) else { break };
            last = end;
            if last.criterion(rows) < best.criterion(rows) {
                (best, idle) = (last.clone(), 0);
            } else {
                idle += 1;
            }
            if idle == PATIENCE || interrupt.load(Ordering::Relaxed) {
                break;
            }
        }
        if best.x.support.len() == start.x.support.len() {
            for order in ORDERS.into_iter().rev().filter(|order| *order < first) {
                let mut x = best.x.clone();
                x.support.truncate(1 + 2 * order);
                match self.descend(x, rows, interrupt) {
                    Some(end) if end.criterion(rows) < best.criterion(rows) => best = end,
                    _ => break,
                }
            }
        }
        Some(best)
    }

    /// What convexity says of each coefficient: the root of its weight.
    fn drawn(&self, x: &Unknowns) -> Vec<f64> {
        let mean = x.support.first().copied().unwrap_or(1.0);
        (0..x.support.len()).map(|i| 1.0 / convex_deviation(mean, i.div_ceil(2))).collect()
    }

    fn cost(&self, x: &Unknowns, drawn: &[f64], motion: &[Followed]) -> f64 {
        let contacts = motion.iter().enumerate().flat_map(|(i, at)| {
            (0..2).map(move |palm| ((at.contacts[palm] - self.contacts[palm][i]) / self.sigma).powi(2))
        });
        let shape = x.support.iter().zip(drawn).map(|(value, drawn)| (value * drawn).powi(2));
        contacts.sum::<f64>() + shape.sum::<f64>()
    }

    /// The normal equations: the matrix, and half of the gradient.
    fn normal(&self, x: &Unknowns, drawn: &[f64], motion: &[Followed]) -> (DMatrix<f64>, DVector<f64>) {
        let (head, p) = (self.head(), self.head() + x.support.len());
        let mut rows = DMatrix::zeros(2 * motion.len(), p);
        let mut left = DVector::zeros(2 * motion.len());
        for (i, at) in motion.iter().enumerate() {
            for palm in 0..2 {
                left[2 * i + palm] = (at.contacts[palm] - self.contacts[palm][i]) / self.sigma;
                for (j, slope) in at.contact_rows[palm].iter().enumerate() {
                    rows[(2 * i + palm, j)] = slope / self.sigma;
                }
            }
        }
        let (mut matrix, mut gradient) = (rows.tr_mul(&rows), rows.tr_mul(&left));
        for (i, (value, drawn)) in x.support.iter().zip(drawn).enumerate() {
            matrix[(head + i, head + i)] += drawn * drawn;
            gradient[head + i] += drawn * drawn * value;
        }
        (matrix, gradient)
    }

    fn moved(&self, x: &Unknowns, step: &DVector<f64>) -> Unknowns {
        let head = self.head();
        let gyration = if head == 2 { x.gyration * step[1].clamp(-1.0, 1.0).exp() } else { x.gyration };
        let support = x.support.iter().enumerate().map(|(i, value)| value + step[head + i]);
        Unknowns { rate: x.rate + step[0], gyration, support: support.collect() }
    }

    /// Levenberg and Marquardt's method on the first rows.
    fn descend(&self, start: Unknowns, rows: usize, interrupt: &AtomicBool) -> Option<Best> {
        let drawn = self.drawn(&start);
        let mut x = start;
        let mut motion = self.follow(&x, rows, true)?;
        let mut cost = self.cost(&x, &drawn, &motion);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            if interrupt.load(Ordering::Relaxed) {
                return None;
            }
            let (matrix, gradient) = self.normal(&x, &drawn, &motion);
            let mut better = None;
            for _ in 0..8 {
                if let Some(step) = solve(&matrix, &gradient, damping) {
                    let there = self.moved(&x, &step);
                    let next =
                        self.follow(&there, rows, false).map(|motion| self.cost(&there, &drawn, &motion));
                    if let Some(next) = next.filter(|next| *next < cost) {
                        better = Some((there, next));
                        break;
                    }
                }
                damping = (damping * 10.0).max(1e-9);
            }
            let Some((there, next)) = better else { break };
            let settled = cost - next <= SETTLED * next.max(1e-6 * rows as f64);
            (x, cost) = (there, next);
            damping *= 0.02;
            if settled {
                break;
            }
            motion = self.follow(&x, rows, true)?;
        }
        cost.is_finite().then_some(Best { x, cost })
    }

    fn found(&self, x: Unknowns) -> Option<Found> {
        let motion = self.follow(&x, self.times.len(), true)?;
        let drawn = self.drawn(&x);
        let chi_square = self.cost(&x, &drawn, &motion);
        let (matrix, gradient) = self.normal(&x, &drawn, &motion);
        let inverse = scaled_inverse(&matrix)?;
        let (n, p) = (2 * self.times.len(), gradient.len());
        let degrees = n.saturating_sub(p).max(1);
        let spread = (chi_square / degrees as f64).max(1.0);
        let covariance = inverse * spread;
        let head = self.head();
        let shape = ShapeEstimate {
            support: SupportSeries::of_coefficients(&x.support),
            covariance: covariance.view((head, head), (p - head, p - head)).into_owned(),
            samples: n,
            chi_square,
            degrees,
            widened: spread.sqrt(),
        };
        let misfit = self.sigma * (chi_square / n as f64).sqrt();
        Some(Found { unknowns: x, covariance, shape, motion, misfit })
    }
}

/// The unknowns' own scales: the roots of the diagonal.
fn scales(matrix: &DMatrix<f64>) -> DVector<f64> {
    matrix.diagonal().map(|value| if value > 0.0 { value.sqrt().recip() } else { 1.0 })
}

fn scaled(matrix: &DMatrix<f64>, scales: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] * scales[i] * scales[j])
}

/// The step of the normal equations with the diagonal made larger by a part of itself.
fn solve(matrix: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let scales = scales(matrix);
    let mut scaled = scaled(matrix, &scales);
    for i in 0..scaled.nrows() {
        scaled[(i, i)] += damping;
    }
    let step = scaled.cholesky()?.solve(&gradient.component_mul(&scales));
    let step = -step.component_mul(&scales);
    step.iter().all(|value| value.is_finite()).then_some(step)
}

fn scaled_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scales = scales(matrix);
    let inverse = scaled(matrix, &scales).cholesky()?.inverse();
    let inverse = scaled(&inverse, &scales);
    inverse.iter().all(|value| value.is_finite()).then_some(inverse)
}
