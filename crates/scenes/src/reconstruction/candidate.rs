//! A candidate shape and motion of a whole record: its residual, its uncertainty, its evidence.

use super::descent::{Squares, descend, inverse, joined, triangle_of};
use super::record::{Followed, Unknowns, WholeRecord};
use nalgebra::{DMatrix, DVector};
use palmistry_bodies::shape::{ShapeEstimate, SupportFunction, deviation_of};
use std::sync::atomic::AtomicBool;

/// An estimate from a whole record.
#[derive(Clone)]
pub(super) struct Found {
    pub unknowns: Unknowns,
    /// Of the free unknowns, scaled by the residual.
    pub covariance: DMatrix<f64>,
    pub shape: ShapeEstimate,
    pub motion: Vec<Followed>,
    /// The root mean square residual of a contact, in m.
    pub rms_residual: f64,
    /// The logarithm of the evidence of the measurements, up to a constant of the record.
    pub evidence: f64,
    /// The radius of gyration, less [`CERTAIN`] deviations where it was estimated, in m.
    pub least_gyration: f64,
    /// Whether its search has converged, and errors as large as its own are linear, where their size is known.
    pub is_sure: bool,
}

/// Two shapes that differ by no more than this fraction of a deviation are one.
const SAME: f64 = 0.3;

/// A search takes this many descents at most, each from where the last one stopped.
const MOST_DESCENTS: usize = 20;

/// A difference of this many standard deviations is not chance.
const CERTAIN: f64 = 5.0;

impl Found {
    /// Whether this chi-square exceeds another one's by more than its fewer unknowns explain: for the true model the excess is chi-square distributed with that many degrees.
    pub fn is_refuted_by(&self, other: &Found) -> bool {
        let fewer = self.shape.degrees.saturating_sub(other.shape.degrees).max(1) as f64;
        self.shape.chi_square > other.shape.chi_square + fewer + CERTAIN * (2.0 * fewer).sqrt()
    }

    /// Whether it may be a body: its centre of mass lies on its side of both palms, and its mass within its outline.
    pub fn is_body(&self) -> bool {
        let is_between = self.motion.iter().all(|at| at.radii.iter().all(|radius| *radius > 0.0));
        is_between && self.holds_its_mass()
    }

    /// Whether the radius of gyration, less [`CERTAIN`] deviations, fits into the outline, its perimeter increased by as many.
    ///
    /// No two points of a convex outline are farther apart than half its perimeter, by H. Jung's theorem (1901) it lies in a circle of `1/sqrt(3)` of that, and mass within a circle
    /// has no larger radius of gyration. The uncertainty of normals that were not touched is in the deviation.
    fn holds_its_mass(&self) -> bool {
        let perimeter = self.shape.perimeter();
        let most = (perimeter.value + CERTAIN * perimeter.deviation) / (2.0 * 3f64.sqrt());
        self.least_gyration <= most
    }

    /// Whether its outline is a spline, and not a series.
    pub fn is_spline(&self) -> bool {
        matches!(self.unknowns.support, SupportFunction::Spline(_))
    }

    /// Whether another candidate has the same support radii where it was touched, up to a fraction of this one's deviations.
    pub fn is_also(&self, other: &Found) -> bool {
        self.motion.iter().zip(&other.motion).all(|(own, other)| {
            (0..2).all(|palm| {
                let deviation = deviation_of(&self.covariance, &own.radius_rows[palm]);
                (own.radii[palm] - other.radii[palm]).abs() <= SAME * deviation
            })
        })
    }
}

/// The best unknowns for some rows.
#[derive(Clone)]
pub(super) struct Best {
    pub x: Unknowns,
    pub cost: f64,
    /// See [`super::descent::Least`].
    pub is_settled: bool,
}

/// The sum of squares of the residuals of the first rows and of the prior on the coefficients, given as square roots of weights about zero.
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
    /// The chi-square of the contacts: squared residuals in units of their variance.
    pub fn squares(&self, motion: &[Followed]) -> f64 {
        let contacts = motion.iter().enumerate().flat_map(|(i, at)| {
            (0..2).map(move |palm| ((at.contacts[palm] - self.contacts[palm][i]) / self.sigma).powi(2))
        });
        contacts.sum()
    }

    /// The triangle of the contacts' derivatives by the free unknowns, with the right-hand side (measured minus expected) as the last column.
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

    /// The same, continued until it converges or [`MOST_DESCENTS`] of them were not enough.
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

    /// The root mean square residual of a contact, in m, from the sum of squares.
    pub fn rms_residual(&self, cost: f64, rows: usize) -> f64 {
        self.sigma * (cost / (2 * rows) as f64).sqrt()
    }

    /// Whether the residual is explained by noise: within [`CERTAIN`] deviations of a sum of so many squares.
    pub fn is_explained(&self, cost: f64, rows: usize) -> bool {
        let n = 2.0 * rows as f64;
        cost <= n + CERTAIN * (2.0 * n).sqrt()
    }

    /// A found minimum with its evidence by P. Laplace's method: the prior of the coefficients against the posterior.
    pub fn at_minimum(&self, best: &Best, prior: &[f64]) -> Option<Found> {
        let motion = self.follow(&best.x, self.times.len(), true)?;
        let rows = self.rows(&motion);
        let triangle = joined(&rows, prior, &vec![0.0; prior.len()]);
        let inverse = inverse(&triangle)?;
        let covariance = &inverse * inverse.transpose();
        let evidence = -0.5 * best.cost + gained(&triangle, prior);
        Some(self.found(best.x.clone(), (motion, &rows), covariance, evidence))
    }

    /// The candidate at some unknowns, from its motion, the triangle of its rows and the covariance of its free unknowns.
    pub fn found(
        &self,
        unknowns: Unknowns,
        (motion, rows): (Vec<Followed>, &DMatrix<f64>),
        covariance: DMatrix<f64>,
        evidence: f64,
    ) -> Found {
        let chi_square = self.squares(&motion);
        let (n, head, p) = (2 * self.times.len(), self.head(), covariance.nrows());
        // a coefficient that the prior determines costs no measurement
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
        // its logarithm is the unknown
        let off = self.place_of_gyration().map_or(0.0, |place| covariance[(place, place)].max(0.0).sqrt());
        let least_gyration = unknowns.gyration * (-CERTAIN * off).exp();
        Found { unknowns, covariance, shape, motion, rms_residual, evidence, least_gyration, is_sure: true }
    }

    /// The length scale of the prior of the coefficients, in m: twice the mean measured contact, from which a body that touches both palms cannot be far.
    pub fn size(&self) -> f64 {
        let read = || self.contacts.iter().flatten();
        read().map(|s| s.abs()).sum::<f64>() / read().count().max(1) as f64
    }

    /// The prior of a spline's coefficients: its points lie about the centre of mass, and its steps are of one size.
    pub fn spline_prior(&self, support: &SupportFunction) -> Vec<f64> {
        let points = 2 * support.points().len();
        let weight = 1.0 / (2.0 * self.size());
        (0..support.coefficients().len()).map(|i| if i < points { weight } else { 1.0 }).collect()
    }
}

/// The information gain: the logarithm of the ratio of the prior and posterior volumes.
pub(super) fn gained(triangle: &DMatrix<f64>, prior: &[f64]) -> f64 {
    let p = triangle.ncols() - 1;
    let afterwards: f64 = (0..p).map(|i| triangle[(i, i)].abs().ln()).sum();
    prior.iter().filter(|weight| **weight > 0.0).map(|weight| weight.ln()).sum::<f64>() - afterwards
}
