//! Fourier polynomials of all orders at once: which harmonics there are is unknown, and the uncertainty about them is in the band.
//!
//! A truncated series ignores what its harmonics cannot follow, without any sign of it. So each order is taken with several priors on how fast harmonics fall, `part (k/2)^-decay` relative to the size of the body and
//! never more than convexity allows; each is weighted by its evidence, and the shape is the mean of all, with the covariance of the mixture. About one
//! point, where all is linear, a triangle of the largest order's rows has all others in its corners.

use super::candidate::{Found, Whole, gained};
use super::descent::{Squares, inverse, joined, solved};
use super::record::{Followed, Unknowns, WholeRecord};
use nalgebra::{DMatrix, DVector};
use palmistry_bodies::shape::{SupportFunction, SupportSeries};
use std::sync::atomic::{AtomicBool, Ordering};

/// Orders that are weighted, and how many of them it begins with; more are tried where the last one has more than this fraction of the weight.
const ORDERS: [usize; 16] = [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 20, 24, 32, 40, 48];
const FIRST: usize = 13;
const MORE: f64 = 1e-3;

/// Harmonics relative to the size of the body, and how fast they fall.
const PARTS: [f64; 5] = [1.0, 0.3, 0.1, 0.03, 0.01];
const DECAYS: [f64; 5] = [2.0, 3.0, 4.0, 6.0, 9.0];

/// The number of harmonics of a search that starts from several motions.
const BEGUN: usize = 6;

/// Priors whose weight is below this fraction of the largest are left out.
const UNLIKELY: f64 = 1e-6;

/// The problem is linearised about a point whose contacts differ from those of the mean by less than this, squared and in units of their variance.
const NEAR: f64 = 0.05;

/// Where the contacts of the mean and of the point differ by more than this, five deviations squared, errors are not linear and the covariance is invalid. Where no deviation is stated its size is not known well enough to test.
const LINEAR: f64 = 25.0;
const ROUNDS: usize = 5;

/// A prior of the harmonics.
#[derive(Clone, Copy)]
struct Belief {
    order: usize,
    part: f64,
    decay: f64,
}

impl Belief {
    /// The square roots of the weights of the coefficients about zero, of a body of a size in m.
    fn weights(self, size: f64) -> Vec<f64> {
        let deviation = |k: usize| match k {
            0 => 2.0 * size,
            // the centre of mass lies inside
            1 => 0.5 * size,
            k => {
                let k = k as f64;
                (2.0 / (k * k - 1.0)).min(self.part * (2.0 / k).powf(self.decay)) * size
            }
        };
        (0..=2 * self.order).map(|i| 1.0 / deviation(i.div_ceil(2))).collect()
    }
}

/// The prior of the coefficients from convexity, for a body of a size in m: the square roots of their weights.
pub(super) fn convex_weights(size: f64, order: usize) -> Vec<f64> {
    Belief { order, part: 1.0, decay: 2.0 }.weights(size)
}

fn beliefs(orders: &[usize]) -> Vec<Belief> {
    let of = |order: &usize| {
        let order = *order;
        PARTS.into_iter().flat_map(move |part| DECAYS.map(|decay| Belief { order, part, decay }))
    };
    orders.iter().flat_map(of).collect()
}

/// The estimate under one prior, about a point.
struct Told {
    belief: Belief,
    evidence: f64,
    /// Of the free unknowns: steps of the first ones, values of the coefficients.
    value: DVector<f64>,
    inverse: DMatrix<f64>,
}

/// The mixture over all priors.
struct Mixture {
    value: DVector<f64>,
    covariance: DMatrix<f64>,
    evidence: f64,
    likeliest: Belief,
    /// The fraction of the weight that the largest orders have.
    last: f64,
}

impl WholeRecord {
    /// The series estimated from the measurements, from a point near it; none where nothing can be followed, or it was interrupted.
    pub fn series(&self, start: &Unknowns, interrupt: &AtomicBool) -> Option<Found> {
        let order = *self.orders()[..self.asked()].last()?;
        let first = Belief { order, part: 1.0, decay: 3.0 }.weights(self.size());
        let begin = self.descend_to_end(expanded(start, order), &first, interrupt)?;
        let found = self.series_about(&begin.x, interrupt)?;
        Some(Found { is_sure: found.is_sure && begin.is_settled, ..found })
    }

    /// The estimates under each of a few priors, with the harmonics that an initial value has at most.
    pub fn believed(&self, begin: &Unknowns, interrupt: &AtomicBool) -> Vec<Found> {
        let one = |part: f64| {
            let weights = Belief { order: BEGUN, part, decay: 3.0 }.weights(self.size());
            let best = self.descend(expanded(begin, BEGUN), &weights, self.times.len(), interrupt)?;
            self.at_minimum(&best, &weights)
        };
        PARTS.into_iter().filter_map(one).collect()
    }

    /// The largest order that is tried first: a body that needs more may need infinitely many.
    pub const ORDER_OF_SMOOTH: usize = ORDERS[FIRST - 1];

    fn orders(&self) -> Vec<usize> {
        let most = (self.times.len() / 4).max(1);
        ORDERS.into_iter().filter(|order| *order <= most).collect()
    }

    /// The number of orders that are tried first.
    fn asked(&self) -> usize {
        FIRST.min(self.orders().len())
    }

    /// The series estimated from the measurements about a point where a search ended.
    pub fn series_about(&self, start: &Unknowns, interrupt: &AtomicBool) -> Option<Found> {
        let orders = self.orders();
        let mut asked = self.asked();
        let mut x = start.clone();
        loop {
            let (found, last) = self.mixed(&x, &orders[..asked], interrupt)?;
            if asked == orders.len() || last < MORE {
                return Some(found);
            }
            x = found.unknowns;
            asked = orders.len();
        }
    }

    /// The mixture over so many orders, at its own mean.
    fn mixed(&self, start: &Unknowns, orders: &[usize], interrupt: &AtomicBool) -> Option<(Found, f64)> {
        let (order, rows) = (*orders.last()?, self.times.len());
        let mut x = expanded(start, order);
        let mut round = 0;
        // whether the last descent led anywhere, and has converged
        let (mut is_moving, mut is_settled) = (true, true);
        loop {
            if interrupt.load(Ordering::Relaxed) {
                return None;
            }
            let motion = self.follow(&x, rows, true)?;
            let rows_there = self.rows(&motion);
            let triangle = self.about(&x, &rows_there);
            let mixture = self.weigh(&triangle, orders)?;
            let mean = self.reached(&x, &mixture.value)?;
            let there = self.follow(&mean, rows, true);
            let moved = there.as_ref().map_or(f64::INFINITY, |there| self.apart_in_contacts(&motion, there));
            round += 1;
            if moved <= NEAR || round == ROUNDS || !is_moving {
                // a mean that cannot be followed, or explains less than the point itself, is a sign of nonlinearity
                let most = self.squares(&motion) + moved.sqrt() + 1.0;
                let (at, motion) = match there.filter(|there| self.squares(there) <= most) {
                    Some(there) => (mean, there),
                    None => (x, motion),
                };
                let found = self.found(at, (motion, &rows_there), mixture.covariance, mixture.evidence);
                let found = Found { is_sure: is_settled && (moved <= LINEAR || !self.stated), ..found };
                return Some((found, mixture.last));
            }
            // a linearisation about one point may not hold at another: the likeliest prior is minimised from the mean or, where that explains less, from the point
            let weights = mixture.likeliest.weights(self.size());
            let whole = Whole { record: self, rows, prior: &weights };
            let begins = [&mean, &x].map(|begin| expanded(begin, mixture.likeliest.order));
            let sums = begins.each_ref().map(|begin| whole.sum(begin).unwrap_or(f64::INFINITY));
            let [mean, point] = begins;
            let begin = if sums[0] <= sums[1] { mean } else { point };
            let best = self.descend_to_end(begin, &weights, interrupt)?;
            is_settled = best.is_settled;
            let next = expanded(&best.x, order);
            let there = self.follow(&next, rows, false)?;
            is_moving = self.apart_in_contacts(&motion, &there) > NEAR;
            x = next;
        }
    }

    /// The squared distance of two motions' contacts, in units of their variance.
    fn apart_in_contacts(&self, one: &[Followed], other: &[Followed]) -> f64 {
        let pairs =
            one.iter().zip(other).flat_map(|(a, b)| [0, 1].map(|i: usize| a.contacts[i] - b.contacts[i]));
        pairs.map(|off| (off / self.sigma).powi(2)).sum()
    }

    /// The triangle for the coefficients themselves instead of steps from a point.
    fn about(&self, x: &Unknowns, triangle: &DMatrix<f64>) -> DMatrix<f64> {
        let p = triangle.ncols() - 1;
        let head = vec![0.0; self.head()];
        let values = DVector::from_vec([head, x.support.coefficients()].concat());
        let mut moved = triangle.clone();
        let side = triangle.column(p) + triangle.columns(0, p) * values;
        moved.set_column(p, &side);
        moved
    }

    /// The unknowns of a mixture about a point.
    fn reached(&self, x: &Unknowns, value: &DVector<f64>) -> Option<Unknowns> {
        let head = self.head();
        let mut step = value.clone();
        for (i, own) in x.support.coefficients().into_iter().enumerate() {
            step[head + i] -= own;
        }
        self.moved(x, &step)
    }

    /// The estimate under one prior, from a triangle.
    fn told(&self, triangle: &DMatrix<f64>, belief: Belief) -> Option<Told> {
        let (last, head) = (triangle.ncols() - 1, self.head());
        let p = head + 1 + 2 * belief.order;
        let weights = belief.weights(self.size());
        let mut corner = DMatrix::zeros(p + 1, p + 1);
        corner.view_mut((0, 0), (p, p)).copy_from(&triangle.view((0, 0), (p, p)));
        for i in 0..p {
            corner[(i, p)] = triangle[(i, last)];
        }
        // the residual that no coefficient of this order changes
        corner[(p, p)] = triangle.view((p, last), (triangle.nrows() - p, 1)).norm();
        let all = joined(&corner, &weights, &vec![0.0; weights.len()]);
        let cost = all[(p, p)].powi(2);
        let evidence = -0.5 * cost + gained(&all, &weights);
        let (value, inverse) = (solved(&all)?, inverse(&all)?);
        evidence.is_finite().then_some(Told { belief, evidence, value, inverse })
    }

    /// The mixture of all priors, each with its weight.
    fn weigh(&self, triangle: &DMatrix<f64>, orders: &[usize]) -> Option<Mixture> {
        let all: Vec<Told> =
            beliefs(orders).into_iter().filter_map(|belief| self.told(triangle, belief)).collect();
        let best = all.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
        let likely: Vec<(f64, &Told)> = all
            .iter()
            .map(|told| ((told.evidence - best.evidence).exp(), told))
            .filter(|(weight, _)| *weight > UNLIKELY)
            .collect();
        let total: f64 = likely.iter().map(|(weight, _)| weight).sum();
        let p = triangle.ncols() - 1;
        let mut value = DVector::zeros(p);
        for (weight, told) in &likely {
            let mut part = value.rows_mut(0, told.value.len());
            part += &told.value * (weight / total);
        }
        let mut covariance = DMatrix::zeros(p, p);
        for (weight, told) in &likely {
            let own = told.value.len();
            let mut part = covariance.view_mut((0, 0), (own, own));
            part += &told.inverse * told.inverse.transpose() * (weight / total);
            let mut off = -value.clone();
            let mut first = off.rows_mut(0, own);
            first += &told.value;
            covariance.ger(weight / total, &off, &off, 1.0);
        }
        let is_last = |told: &Told| Some(&told.belief.order) == orders.last();
        let last: f64 = likely.iter().filter(|(_, told)| is_last(told)).map(|(weight, _)| weight).sum();
        Some(Mixture {
            value,
            covariance,
            // all priors are equally likely
            evidence: best.evidence + (total / all.len() as f64).ln(),
            likeliest: best.belief,
            last: last / total,
        })
    }
}

/// The unknowns with a series of an order: coefficients beyond it are dropped, missing ones are zero.
pub(super) fn expanded(x: &Unknowns, order: usize) -> Unknowns {
    let mut coefficients = x.support.coefficients();
    coefficients.resize(1 + 2 * order, 0.0);
    let support = SupportFunction::Series(SupportSeries::of_coefficients(&coefficients));
    Unknowns { support, ..x.clone() }
}
