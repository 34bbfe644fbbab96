//! A shape and a motion that may be those of a whole record: what is left of the readings, how sure it is, how likely.

use super::descent::{Squares, descend, inverse, joined, triangle_of};
use super::record::{Followed, Unknowns, WholeRecord};
use nalgebra::{DMatrix, DVector};
use palmistry_bodies::shape::{ShapeEstimate, SupportFunction, deviation_of};
use std::sync::atomic::AtomicBool;

/// What a whole record told.
#[derive(Clone)]
pub(super) struct Found {
    pub unknowns: Unknowns,
    /// Of the free unknowns, with what the residual adds.
    pub covariance: DMatrix<f64>,
    pub shape: ShapeEstimate,
    pub motion: Vec<Followed>,
    /// The root of the mean square of what is left of a contact, in m.
    pub rms_residual: f64,
    /// The logarithm of the probability of the readings, but for a constant of the record.
    pub evidence: f64,
    /// The radius of gyration, [`CERTAIN`] deviations taken off where it was sought, in m.
    pub least_gyration: f64,
    /// Whether its search has come to its end, and errors as large as its own are linear, where it is known how large they are.
    pub is_sure: bool,
}

/// Two shapes that differ by no more than this part of a deviation are one.
const SAME: f64 = 0.3;

/// So many descents, each from where the last one stopped, make a search.
const MOST_DESCENTS: usize = 20;

/// So many deviations are not chance.
const CERTAIN: f64 = 5.0;

impl Found {
    /// Whether this leaves more than another one does by more than its fewer unknowns explain: of the true model that is the square of as many normal numbers.
    pub fn is_refuted_by(&self, other: &Found) -> bool {
        let fewer = self.shape.degrees.saturating_sub(other.shape.degrees).max(1) as f64;
        self.shape.chi_square > other.shape.chi_square + fewer + CERTAIN * (2.0 * fewer).sqrt()
    }

    /// Whether it may be a body: its centre of mass lies on its side of both palms, and its mass within its outline.
    pub fn is_body(&self) -> bool {
        let is_between = self.motion.iter().all(|at| at.radii.iter().all(|radius| *radius > 0.0));
        is_between && self.holds_its_mass()
    }

    /// Whether the radius of gyration fits into the outline, [`CERTAIN`] deviations taken off it and added to the perimeter.
    ///
    /// No two points of a convex outline are farther apart than half its perimeter, by H. Jung's theorem (1901) it lies in a circle of `1/sqrt(3)` of that, and mass within a circle
    /// has no larger radius of gyration. What was not touched is in the deviation.
    fn holds_its_mass(&self) -> bool {
        let perimeter = self.shape.perimeter();
        let most = (perimeter.value + CERTAIN * perimeter.deviation) / (2.0 * 3f64.sqrt());
        self.least_gyration <= most
    }

    /// Whether its outline is a spline, and not a series.
    pub fn is_spline(&self) -> bool {
        matches!(self.unknowns.support, SupportFunction::Spline(_))
    }

    /// Whether another one says the same of the body where it was touched, to a part of this one's deviations.
    pub fn is_also(&self, other: &Found) -> bool {
        self.motion.iter().zip(&other.motion).all(|(own, other)| {
            (0..2).all(|palm| {
                let deviation = deviation_of(&self.covariance, &own.radius_rows[palm]);
                (own.radii[palm] - other.radii[palm]).abs() <= SAME * deviation
            })
        })
    }
}

/// The best unknowns of some rows.
#[derive(Clone)]
pub(super) struct Best {
    pub x: Unknowns,
    pub cost: f64,
    /// As of [`super::descent::Least`].
    pub is_settled: bool,
}

/// The sum of squares of what is left of the first rows, and of what is known of the coefficients: the roots of their weights about zero.
pub(super) struct Whole<'a> {
    pub record: &'a WholeRecord,
    pub rows: usize,
    pub prior: &'a [f64],
}

impl Squares for Whole<'_> {
    type Point = Unknowns;

    fn sum(&self, at: &Unknowns) -> Option<f64> {
        let motion = self.record.follow(at, self.rows, false)?;
        Some(self.record.squares(&motion) + self.drawn(at))
    }

    fn triangle(&self, at: &Unknowns) -> Option<DMatrix<f64>> {
        let motion = self.record.follow(at, self.rows, true)?;
        let coefficients = at.support.coefficients();
        let lacks: Vec<f64> =
            coefficients.iter().zip(self.prior).map(|(value, weight)| -value * weight).collect();
        Some(joined(&self.record.rows(&motion), self.prior, &lacks))
    }

    fn moved(&self, at: &Unknowns, step: &DVector<f64>) -> Option<Unknowns> {
        self.record.moved(at, step)
    }
}

impl Whole<'_> {
    fn drawn(&self, at: &Unknowns) -> f64 {
        let coefficients = at.support.coefficients();
        coefficients.iter().zip(self.prior).map(|(value, weight)| (value * weight).powi(2)).sum()
    }
}

impl WholeRecord {
    /// What is left of the contacts, in units of their variance.
    pub fn squares(&self, motion: &[Followed]) -> f64 {
        let contacts = motion.iter().enumerate().flat_map(|(i, at)| {
            (0..2).map(move |palm| ((at.contacts[palm] - self.contacts[palm][i]) / self.sigma).powi(2))
        });
        contacts.sum()
    }

    /// The triangle of the contacts' derivatives by the free unknowns, with what the contacts lack.
    pub fn rows(&self, motion: &[Followed]) -> DMatrix<f64> {
        let p = motion.first().map_or(0, |at| at.phi_row.len());
        let mut rows = DMatrix::zeros(2 * motion.len(), p + 1);
        for (i, at) in motion.iter().enumerate() {
            for palm in 0..2 {
                for (j, slope) in at.contact_rows[palm].iter().enumerate() {
                    rows[(2 * i + palm, j)] = slope / self.sigma;
                }
                rows[(2 * i + palm, p)] = (self.contacts[palm][i] - at.contacts[palm]) / self.sigma;
            }
        }
        triangle_of(rows)
    }

    pub fn moved(&self, x: &Unknowns, step: &DVector<f64>) -> Option<Unknowns> {
        let rate = if self.rate.is_none() { x.rate + step[0] } else { x.rate };
        let gyration = match self.place_of_gyration() {
            Some(place) => x.gyration * step[place].clamp(-1.0, 1.0).exp(),
            None => x.gyration,
        };
        let coefficients = x.support.coefficients().into_iter().enumerate();
        let coefficients: Vec<f64> = coefficients.map(|(i, value)| value + step[self.head() + i]).collect();
        Some(Unknowns { rate, gyration, support: x.support.with(&coefficients)? })
    }

    /// The least sum of squares over the first rows.
    pub fn descend(
        &self,
        start: Unknowns,
        prior: &[f64],
        rows: usize,
        interrupt: &AtomicBool,
    ) -> Option<Best> {
        let whole = Whole { record: self, rows, prior };
        descend(&whole, start, interrupt).map(|end| Best {
            x: end.at,
            cost: end.sum,
            is_settled: end.is_settled,
        })
    }

    /// The same, gone on with until it has come to its end or [`MOST_DESCENTS`] of them were not enough.
    pub fn descend_to_end(&self, start: Unknowns, prior: &[f64], interrupt: &AtomicBool) -> Option<Best> {
        let mut best = self.descend(start, prior, self.times.len(), interrupt)?;
        for _ in 1..MOST_DESCENTS {
            if best.is_settled {
                break;
            }
            best = self.descend(best.x, prior, self.times.len(), interrupt)?;
        }
        Some(best)
    }

    /// The root of the mean square of what is left of a contact, in m, by the sum of its squares.
    pub fn rms_residual(&self, cost: f64, rows: usize) -> f64 {
        self.sigma * (cost / (2 * rows) as f64).sqrt()
    }

    /// Whether what is left is no more than noise leaves, [`CERTAIN`] deviations of the sum of so many squares added.
    pub fn is_explained(&self, cost: f64, rows: usize) -> bool {
        let n = 2.0 * rows as f64;
        cost <= n + CERTAIN * (2.0 * n).sqrt()
    }

    /// A found minimum with the evidence of P. Laplace's method: what is known of the coefficients beforehand against what is known afterwards.
    pub fn at_minimum(&self, best: &Best, prior: &[f64]) -> Option<Found> {
        let motion = self.follow(&best.x, self.times.len(), true)?;
        let rows = self.rows(&motion);
        let triangle = joined(&rows, prior, &vec![0.0; prior.len()]);
        let inverse = inverse(&triangle)?;
        let covariance = &inverse * inverse.transpose();
        let evidence = -0.5 * best.cost + gained(&triangle, prior);
        Some(self.found(best.x.clone(), (motion, &rows), covariance, evidence))
    }

    /// What is found, with its motion, the triangle of its rows and the covariance of its free unknowns.
    pub fn found(
        &self,
        unknowns: Unknowns,
        (motion, rows): (Vec<Followed>, &DMatrix<f64>),
        covariance: DMatrix<f64>,
        evidence: f64,
    ) -> Found {
        let chi_square = self.squares(&motion);
        let (n, head, p) = (2 * self.times.len(), self.head(), covariance.nrows());
        // a coefficient that is known beforehand costs no reading
        let told = rows.columns(0, p);
        let free = (told * &covariance).component_mul(&told).sum().min(p as f64);
        let shape = ShapeEstimate {
            support: unknowns.support.clone(),
            covariance: covariance.view((head, head), (p - head, p - head)).into_owned(),
            others: Vec::new(),
            samples: n,
            chi_square,
            degrees: n.saturating_sub(free.round() as usize).max(1),
            widened: 1.0,
        };
        let rms_residual = self.rms_residual(chi_square, self.times.len());
        // its logarithm is what is sought
        let off = self.place_of_gyration().map_or(0.0, |place| covariance[(place, place)].max(0.0).sqrt());
        let least_gyration = unknowns.gyration * (-CERTAIN * off).exp();
        Found { unknowns, covariance, shape, motion, rms_residual, evidence, least_gyration, is_sure: true }
    }

    /// The length by which coefficients are measured beforehand, in m: twice the mean of what was read, from which a body that touches both palms cannot be far.
    pub fn size(&self) -> f64 {
        let read = || self.contacts.iter().flatten();
        read().map(|s| s.abs()).sum::<f64>() / read().count().max(1) as f64
    }

    /// What is known of a spline's coefficients beforehand: its points lie about the centre of mass, and its steps are of one size.
    pub fn spline_prior(&self, support: &SupportFunction) -> Vec<f64> {
        let points = 2 * support.points().len();
        let weight = 1.0 / (2.0 * self.size());
        (0..support.coefficients().len()).map(|i| if i < points { weight } else { 1.0 }).collect()
    }
}

/// By how much more is known afterwards: the logarithm of the ratio of both densities' sizes.
pub(super) fn gained(triangle: &DMatrix<f64>, prior: &[f64]) -> f64 {
    let p = triangle.ncols() - 1;
    let afterwards: f64 = (0..p).map(|i| triangle[(i, i)].abs().ln()).sum();
    prior.iter().filter(|weight| **weight > 0.0).map(|weight| weight.ln()).sum::<f64>() - afterwards
}
