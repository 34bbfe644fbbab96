//! The thesis's own search (section 5.5), for comparison: rate, inertia and mass are known, and six numbers are estimated, the orientation of the body and its support radii at the three contacts of the first sample.
//!
//! First they are drawn evenly, and the draw with the least cost over a short time is kept; then simplex searches (J. A. Nelder and R. Mead, A simplex method for function minimization, Computer Journal 7, 1965), each from
//! where the one before ended and over twice the time. Centre and velocity follow from radii and constraints of the first sample. The cost is the integral of the three constraints squared, to which the
//! thesis adds how far its twelve equations for nine numbers of the contacts drift apart.

use super::SolidMeasurements;
use super::constraint::values;
use super::flow::Start;
use super::integrals::{Integrals, Rules};
use super::search::chosen;
use super::vector::PLACES;
use nalgebra::{Matrix3, Quaternion, SVector, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The quantities that the thesis takes as known, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownSolid {
    /// The angular velocity at the first sample.
    pub rate: Vector3<f64>,
    /// The inertia over mass about the centre of mass, in a frame of the body's own.
    pub inertia_over_mass: Matrix3<f64>,
    pub mass: f64,
    /// All support radii are between these.
    pub radii: [f64; 2],
}

/// The result of the two stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoStages {
    /// The centre of mass at the first sample.
    pub centre: Vector3<f64>,
    pub inertia_over_mass: Matrix3<f64>,
    /// The root of the mean square of the constraints over the whole record, in m/s.
    pub left: f64,
}

/// Three of a rotation vector that is added, in rad, and three radii in m.
type Six = SVector<f64, 6>;

/// The part of the record that is used first, with so many samples; and those of the whole.
const FIRST: (f64, usize) = (1.0 / 16.0, 6);
const SAMPLES: usize = 60;
/// The first simplex: in rad, and relative to the radii's range.
const SIMPLEX: [f64; 2] = [0.1, 0.05];
/// Steps of one search.
const STEPS: usize = 400;

struct Sought<'a> {
    measurements: &'a SolidMeasurements,
    known: &'a KnownSolid,
    from: UnitQuaternion<f64>,
}

impl Sought<'_> {
    /// None where the palms' normals are in one plane.
    fn start(&self, six: &Six) -> Option<Start> {
        let turn = UnitQuaternion::from_scaled_axis(six.fixed_rows::<3>(0)) * self.from;
        let turn = turn.to_rotation_matrix();
        let k = self.known.inertia_over_mass.try_inverse()?;
        let k = turn.matrix() * k * turn.matrix().transpose();
        let palms = &self.measurements.palms[0];
        let contacts: [Vector3<f64>; 3] = std::array::from_fn(|i| self.measurements.contact(palms, i));
        let normals: [Vector3<f64>; 3] = std::array::from_fn(|i| self.measurements.normal(palms, i));
        let solve = Matrix3::from_fn(|i, j| normals[i][j]).try_inverse()?;
        let centre = solve * Vector3::from_fn(|i, _| normals[i].dot(&contacts[i]) + six[3 + i]);
        let velocity = solve
            * Vector3::from_fn(|i, _| {
                let moved = self.known.rate.cross(&(contacts[i] - centre));
                palms[i].rate * self.measurements.lever(palms, i) - normals[i].dot(&moved)
            });
        let (rate, mu) = (self.known.rate.into(), 1.0 / self.known.mass);
        Start::new(centre.into(), velocity.into(), rate, PLACES.map(|place| k[place]), mu)
    }

    /// The sum of the squares of the constraints; infinite where there is none.
    fn cost(&self, all: &Integrals, six: &Six) -> f64 {
        let Some(start) = self.start(six) else { return f64::INFINITY };
        let sum: f64 = values(&start, all).iter().flatten().map(|value| value * value).sum();
        if sum.is_finite() { sum } else { f64::INFINITY }
    }
}

/// Reflection, expansion, contraction and shrinking by the authors' factors.
fn simplex(cost: &dyn Fn(&Six) -> f64, from: Six, size: &Six) -> Six {
    let mut points: Vec<(Six, f64)> = (0..7)
        .map(|k| {
            let mut point = from;
            if k > 0 {
                point[k - 1] += size[k - 1];
            }
            (point, cost(&point))
        })
        .collect();
    for _ in 0..STEPS {
        points.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (points[0], points[6]);
        let middle = points[..6].iter().fold(Six::zeros(), |sum, point| sum + point.0) / 6.0;
        let along = |times: f64| {
            let point = middle + (worst.0 - middle) * times;
            (point, cost(&point))
        };
        let mirrored = along(-1.0);
        if mirrored.1 < best.1 {
            let further = along(-2.0);
            points[6] = if further.1 < mirrored.1 { further } else { mirrored };
        } else if mirrored.1 < points[5].1 {
            points[6] = mirrored;
        } else {
            let nearer = if mirrored.1 < worst.1 { along(-0.5) } else { along(0.5) };
            if nearer.1 < worst.1.min(mirrored.1) {
                points[6] = nearer;
            } else {
                for point in &mut points[1..] {
                    let there = best.0 + (point.0 - best.0) / 2.0;
                    *point = (there, cost(&there));
                }
            }
        }
    }
    points.sort_by(|a, b| a.1.total_cmp(&b.1));
    points[0].0
}

impl SolidMeasurements {
    /// The thesis's search with so many draws; none where measurements are too few or nothing was found.
    pub fn two_stages(&self, known: &KnownSolid, draws: usize, seed: u64) -> Option<TwoStages> {
        if !self.is_whole() {
            return None;
        }
        let record = |part: f64, samples: usize| {
            let rules = Rules::of(&self.times, chosen(self.rows(), part, samples));
            Integrals::of(self, &rules)
        };
        let short = record(FIRST.0, FIRST.1);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let [low, high] = known.radii;
        let mut best: Option<(UnitQuaternion<f64>, Six, f64)> = None;
        for _ in 0..draws {
            // a direction in four dimensions is an even turn
            let mut draw = || crate::simulation::normal(&mut random);
            let from = UnitQuaternion::new_normalize(Quaternion::new(draw(), draw(), draw(), draw()));
            let six =
                Six::from_fn(|i, _| if i < 3 { 0.0 } else { low + (high - low) * random.random::<f64>() });
            let cost = Sought { measurements: self, known, from }.cost(&short, &six);
            if best.as_ref().is_none_or(|best| cost < best.2) {
                best = Some((from, six, cost));
            }
        }
        let (from, mut six, _) = best?;
        let sought = Sought { measurements: self, known, from };
        let range = SIMPLEX[1] * (high - low);
        let mut size = Six::from_fn(|i, _| if i < 3 { SIMPLEX[0] } else { range });
        let mut part = FIRST.0;
        loop {
            let samples = (SAMPLES as f64 * part) as usize;
            let all = record(part, samples.max(FIRST.1));
            six = simplex(&|six| sought.cost(&all, six), six, &size);
            if part >= 1.0 {
                let start = sought.start(&six)?;
                let mean = sought.cost(&all, &six) / (3 * all.nodes.len()) as f64;
                let k = Matrix3::from_fn(|i, j| super::vector::symmetric(&start.inverse)[i][j]);
                let inertia_over_mass = k.try_inverse()?;
                return Some(TwoStages { centre: start.centre.into(), inertia_over_mass, left: mean.sqrt() });
            }
            part = (2.0 * part).min(1.0);
            size /= 2.0;
        }
    }
}
