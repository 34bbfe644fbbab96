//! From distant starts: least squares with a prior whose weight falls, the iteratively regularised method of Gauss and Newton (A. B. Bakushinskii, The problem of the convergence of the iteratively regularized
//! Gauss-Newton method, Computational Mathematics and Mathematical Physics 32, 1992).
//!
//! In measurements of a second or two some unknowns are a thousand times less observable than others: without a prior the first steps run along such a valley to bodies that spin tens of times too fast, and do not come back.
//! With one, unknowns that are not observable yet stay at the prior, and the minimum moves a little with each weight.

use super::UNKNOWNS;
use super::change::{Change, Normal, Positive, Scale, shortened};
use super::constraint::{expanded, values};
use super::flow::Start;
use super::integrals::Integrals;
use super::vector::{PLACES, symmetric};

/// Standard deviations of a prior: of the centre in lengths, of velocity and rate in those of a fall, of the inverse of the inertia in that of a ball, of the logarithm of 1/m.
const SPREAD: [f64; 5] = [0.3, 0.3, 0.3, 0.5, 0.1];

/// The first weight of the prior, relative to a fall's speed; its factor; and the last weight where measurements are exact.
const WEIGHTS: [f64; 3] = [0.03, 0.3, 1e-11];
/// The weight of the prior at first on the records after the first.
const AGAIN: f64 = 1e-8;
/// Steps for each weight; and for each part of the record after the first.
const STEPS: [usize; 2] = [20, 40];
/// A path has stalled where the sum of squares of the measurements is above this fraction of its last value, and this many times that of the prior.
const STALLED: [f64; 2] = [0.97, 10.0];

/// The prior of the state.
pub(super) struct Prior {
    pub at: Start,
    /// The inverse of the inertia over mass of a ball, in 1/m^2.
    pub ball: f64,
    /// The length of the body, and the rate of a fall: the root of gravity over it.
    pub length: f64,
    pub fall: f64,
}

/// Where a path ends.
pub(super) struct Ended {
    pub start: Start,
    /// The sum of the squares of constraints, in units of a fall's speed.
    pub cost: f64,
    /// Whether it reached the last weight and the whole record.
    pub is_through: bool,
}

impl Prior {
    /// The differences of a start from the prior in its deviations, each with its derivatives by changes.
    pub fn rows(&self, here: &Start) -> Option<[(f64, Change); UNKNOWNS]> {
        let k = Positive::of(&here.inverse)?;
        let around: [[f64; 6]; 6] = std::array::from_fn(|a| {
            let mut unit = [0.0; 6];
            unit[a] = 1.0;
            k.around(&symmetric(&unit))
        });
        let [centre, velocity, rate, inverse, mu] = SPREAD;
        let speed = self.length * self.fall;
        Some(std::array::from_fn(|i| {
            let mut row = [0.0; UNKNOWNS];
            let (off, size) = match i {
                0..3 => (here.centre[i] - self.at.centre[i], centre * self.length),
                3..6 => (here.velocity[i - 3] - self.at.velocity[i - 3], velocity * speed),
                6..9 => (here.rate[i - 6] - self.at.rate[i - 6], rate * self.fall),
                9..15 => {
                    let (a, b) = PLACES[i - 9];
                    // those off the diagonal are there twice
                    let (middle, size) =
                        if a == b { (self.ball, inverse) } else { (0.0, inverse / 2f64.sqrt()) };
                    (here.inverse[i - 9] - middle, size * self.ball)
                }
                _ => ((here.mu / self.at.mu).ln(), mu),
            };
            match i {
                9..15 => (0..6).for_each(|a| row[9 + a] = around[a][i - 9] / size),
                _ => row[i] = 1.0 / size,
            }
            (off / size, row)
        }))
    }

    /// The sums of squares of the measurements and of the prior.
    fn costs(&self, all: &Integrals, here: &Start) -> Option<[f64; 2]> {
        let unit = self.length * self.fall;
        let told = values(here, all).iter().flatten().map(|value| (value / unit).powi(2)).sum::<f64>();
        let own = self.rows(here)?.iter().map(|(off, _)| off * off).sum::<f64>();
        (told + own).is_finite().then_some([told, own])
    }

    fn normal(&self, all: &Integrals, here: &Start, weight: f64) -> Option<Normal> {
        let unit = self.length * self.fall;
        let chain = here.chain()?;
        let mut normal = Normal::none();
        for sample in expanded(here, all) {
            for (value, by) in sample.value.iter().zip(&sample.by) {
                normal.add(value / unit, &chain.row(&by.map(|x| x / unit)));
            }
        }
        for (off, row) in self.rows(here)? {
            normal.add(weight * off, &row.map(|x| weight * x));
        }
        normal.cost.is_finite().then_some(normal)
    }

    /// Levenberg and Marquardt's method for one weight; the sums of squares of the measurements and of the prior at its end.
    fn descend(&self, all: &Integrals, from: Start, weight: f64, steps: usize) -> Option<(Start, [f64; 2])> {
        let scale = self.scale();
        let sum = |costs: &[f64; 2]| costs[0] + weight * weight * costs[1];
        let mut here = from;
        let mut costs = self.costs(all, &here)?;
        let mut damping = 1e-6;
        for _ in 0..steps {
            let Some(normal) = self.normal(all, &here, weight) else { break };
            let mut better = None;
            for _ in 0..8 {
                let there = normal.step(damping).and_then(|step| here.changed(&shortened(&step, &scale)));
                better = there
                    .and_then(|there| Some((there, self.costs(all, &there)?)))
                    .filter(|(_, reached)| sum(reached) < sum(&costs));
                if better.is_some() {
                    break;
                }
                damping = f64::max(damping * 8.0, 1e-8);
            }
            let Some((there, reached)) = better else { break };
            let is_settled = sum(&reached) > sum(&costs) * (1.0 - 1e-3);
            (here, costs) = (there, reached);
            damping *= 0.1;
            if is_settled {
                break;
            }
        }
        Some((here, [costs[0], weight * weight * costs[1]]))
    }

    /// The longest step.
    pub fn scale(&self) -> Scale {
        Scale { length: self.length, rate: SPREAD[2] * self.fall }
    }

    /// From the prior on the first of some records, each of which is part of the next, to the last one; `error` is the known error of a contact relative to its length.
    pub fn follow(&self, records: &[Integrals], error: f64) -> Option<Ended> {
        let [first, factor, last] = WEIGHTS;
        // an error is in a constraint by the body's rate, which is a tenth of a fall's
        let last = last.max(0.1 * error);
        let (begin, rest) = records.split_first()?;
        let (mut here, mut weight, mut before) = (self.at, first, f64::INFINITY);
        while weight > last {
            let (there, [told, own]) = self.descend(begin, here, weight, STEPS[0])?;
            here = there;
            if told > STALLED[0] * before && told > STALLED[1] * own {
                return Some(Ended { start: here, cost: told, is_through: false });
            }
            before = told;
            weight *= factor;
        }
        for record in rest {
            for weight in [AGAIN, last] {
                (here, [before, _]) = self.descend(record, here, weight.max(last), STEPS[1])?;
            }
        }
        Some(Ended { start: here, cost: before, is_through: true })
    }
}
