//! Initial values from measurements alone: drawn priors of how a body like a ball lies and turns, each followed (`regular`) while measurements take over.
//!
//! It does not always converge to the truth: with noise of a thousandth of the body a wrong minimum may be met first. One that does not explain the measurements is rejected
//! (`SolidState::fits`), and the search goes on. With noise, measurements of a barely observable state may be explained by more than one: another end is looked for, and one that explains them as well is reported (`Rival`).

use super::change::Scale;
use super::flow::Start;
use super::integrals::{Integrals, Rules};
use super::refine::{Refined, refine};
use super::regular::{Ended, Prior};
use super::vector::{Vector, along};
use super::whiten::Deviations;
use super::{FEWEST, Rival, SolidMeasurements, UNKNOWNS};
use crate::simulation::normal;
use nalgebra::{Matrix3, Vector3};
use palmistry_math::number::MOST_ITERATIONS;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Contacts without stated noise are weighted as if they had errors of this fraction of their distances: the residual of the true state for exact measurements is rounding and the rule of integration, a thousandth of that
/// or less. `SolidState::fits` decides which residual is acceptable.
const NOTHING: f64 = 1e-6;
/// Rates below this part of a fall's, the root of gravity over the body's length, are softened.
const SOFTENED: f64 = 3e-4;

/// The number of priors that are drawn. After each round of them this many of the paths that stalled lowest are refined too: noise that is not stated stalls all.
const DRAWS: usize = 80;
const ROUND: usize = 20;
const STALLED: usize = 3;
/// The standard deviations of the drawn priors about the likely state: the centre in lengths, velocity and rate in those of a fall, the inverse of the inertia in that of a ball.
const DRAWN: [f64; 4] = [0.1, 0.1, 0.15, 0.15];

/// Estimates and scales that are known before the search.
struct Likely {
    centre: Vector,
    mu: f64,
    length: f64,
    /// The rate of a fall, in 1/s.
    fall: f64,
    deviations: Deviations,
    /// The first part of the record, as a fraction of it: six times the time in which a body falls by about its size.
    part: f64,
}

impl Likely {
    fn of(measurements: &SolidMeasurements) -> Option<Likely> {
        // the point next to all normals through contacts of the first samples
        let few = (measurements.rows() / 20).max(3);
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let mut force = Vector3::zeros();
        for palms in &measurements.palms {
            for (i, palm) in palms.iter().enumerate() {
                force += measurements.normal(palms, i) * (palm.torque / measurements.lever(palms, i));
            }
        }
        for palms in &measurements.palms[..few] {
            for i in 0..3 {
                let (contact, n) = (measurements.contact(palms, i), measurements.normal(palms, i));
                let across = Matrix3::identity() - n * n.transpose();
                matrix += across;
                right += across * contact;
            }
        }
        let meeting = matrix.try_inverse()? * right;
        let mut spread = 0.0;
        for palms in &measurements.palms {
            for i in 0..3 {
                spread += (measurements.contact(palms, i) - meeting).norm_squared();
            }
        }
        let count = (3 * measurements.rows()) as f64;
        let length = (spread / count).sqrt();
        let weight = measurements.gravity.norm();
        let force = force.norm() / measurements.rows() as f64;
        let duration = measurements.times[measurements.rows() - 1] - measurements.times[0];
        let usable = length > 0.0 && weight > 0.0 && force > 0.0;
        let contact = measurements.contact_deviation.max(NOTHING * length);
        let fall = (weight / length).sqrt();
        let deviations =
            Deviations { contact, torque: measurements.torque_deviation, softened: SOFTENED * fall };
        usable.then(|| Likely {
            centre: meeting.into(),
            mu: weight / force,
            length,
            fall,
            deviations,
            part: (6.0 / (fall * duration)).min(1.0),
        })
    }

    /// A ball that does not move, changed by random draws.
    fn drawn(&self, random: &mut ChaCha8Rng, times: f64) -> Option<Prior> {
        let mut draw = |size: f64| times * size * normal(random);
        let [centre, velocity, rate, inverse] = DRAWN;
        let mut vector = |size: f64| -> Vector { std::array::from_fn(|_| draw(size)) };
        let place = along(&self.centre, 1.0, &vector(centre * self.length));
        let (velocity, rate) = (vector(velocity * self.length * self.fall), vector(rate * self.fall));
        let ball = 1.0 / (0.4 * self.length * self.length);
        let mut grown = [0.0; UNKNOWNS];
        grown[9..15].fill_with(|| draw(inverse));
        let at = Start::new(place, velocity, rate, [ball, ball, ball, 0.0, 0.0, 0.0], self.mu)?;
        Some(Prior { at: at.changed(&grown)?, ball, length: self.length, fall: self.fall })
    }

    /// The likely part of the record, each twice as long as the one before, and all of it.
    fn records(&self, measurements: &SolidMeasurements, first: f64) -> Vec<Integrals> {
        let mut parts = vec![first * self.part];
        while parts[parts.len() - 1] < 1.0 {
            parts.push((2.0 * parts[parts.len() - 1]).min(1.0));
        }
        let of = |part: &f64| {
            let samples = (25.0 * part / self.part).clamp(25.0, 60.0) as usize;
            let rules = Rules::of(&measurements.times, chosen(measurements.rows(), *part, samples));
            Integrals::of(measurements, &rules)
        };
        parts.iter().map(of).collect()
    }
}

/// Samples evenly over a part of the record.
pub(super) fn chosen(rows: usize, part: f64, samples: usize) -> Vec<usize> {
    let last = (((rows - 1) as f64 * part) as usize).clamp(FEWEST - 1, rows - 1);
    let samples = samples.min(last + 1);
    (0..samples).map(|k| k * last / (samples - 1)).collect()
}

/// The best estimate.
pub(super) fn found(measurements: &SolidMeasurements, interrupt: &dyn Fn() -> bool) -> Option<Refined> {
    if !measurements.is_whole() || measurements.is_still() {
        return None;
    }
    let mut search = Search::of(measurements, Likely::of(measurements)?);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    // half of the draws start with half of that part
    let records = [1.0, 0.5].map(|part| search.likely.records(measurements, part));
    let mut stalled: Vec<Ended> = Vec::new();
    for k in 0..DRAWS {
        if interrupt() {
            return search.told();
        }
        let prior = search.likely.drawn(&mut random, f64::from(u8::from(k > 0)));
        let error = measurements.contact_deviation / search.likely.length;
        match prior.and_then(|prior| prior.follow(&records[k % 2], error)) {
            Some(end) if end.is_through => search.refine(end.start),
            Some(end) => stalled.push(end),
            None => {}
        }
        if (k + 1) % ROUND == 0 && !search.is_done() {
            stalled.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            for end in stalled.drain(..).take(STALLED) {
                if !search.is_done() && !interrupt() {
                    search.refine(end.start);
                }
            }
        }
        if search.is_done() {
            break;
        }
    }
    search.told()
}

/// Where measurements have errors, this many ends that explain them are compared before one is chosen.
const ENDS: usize = 2;
/// After this many ends that do not fit, or are no body, the search stops: a barely observable state leads all starts along its valleys.
const ASTRAY: usize = 6;
/// A state is a rival where its chi-square is no more than this above the least, and an entry of it is more than so many deviations away: if the bound were valid, the difference would be the square of that.
const LEAVES: f64 = 25.0;
const APART: f64 = 5.0;

/// The state of the search.
struct Search<'a> {
    measurements: &'a SolidMeasurements,
    likely: Likely,
    whole: Rules,
    best: Option<Refined>,
    /// All ends that fit: chi-square and entries.
    ends: Vec<(f64, [f64; UNKNOWNS])>,
    /// The number of ends that do not fit.
    astray: usize,
}

impl Search<'_> {
    fn of(measurements: &SolidMeasurements, likely: Likely) -> Search<'_> {
        let whole = Rules::of(&measurements.times, (0..measurements.rows()).collect());
        Search { measurements, likely, whole, best: None, ends: Vec::new(), astray: 0 }
    }

    fn refine(&mut self, start: Start) {
        let scale = Scale { length: self.likely.length, rate: self.likely.fall };
        let Some(refined) = refine(self.measurements, &self.whole, start, &scale, &self.likely.deviations)
        else {
            return;
        };
        self.astray += 1;
        let Some(state) = refined.state().filter(|_| is_body(&refined)) else { return };
        if state.fits() {
            self.ends.push((state.chi_square, state.entries()));
            self.astray -= 1;
        }
        if self.best.as_ref().is_none_or(|best| refined.chi_square < best.chi_square) {
            self.best = Some(refined);
        }
    }

    /// Exact measurements are explained by one state, and wrong ends have cost little there.
    fn is_done(&self) -> bool {
        match self.measurements.contact_deviation > 0.0 {
            true => self.ends.len() >= ENDS || self.astray >= ASTRAY,
            false => !self.ends.is_empty(),
        }
    }

    /// The best, with the one that is furthest from it among those that explain the measurements as well.
    fn told(self) -> Option<Refined> {
        let mut best = self.best?;
        let state = best.state()?;
        let (own, deviations) = (state.entries(), state.deviations());
        let rival = |(chi_square, entries): &(f64, [f64; UNKNOWNS])| {
            let apart =
                (0..UNKNOWNS).map(|i| ((entries[i] - own[i]) / deviations[i]).abs()).fold(0.0, f64::max);
            Rival { apart, chi_square: *chi_square }
        };
        best.rival = (self.ends.iter().map(rival))
            .filter(|rival| rival.apart > APART && rival.chi_square <= best.chi_square + LEAVES)
            .max_by(|a, b| a.apart.total_cmp(&b.apart));
        Some(best)
    }
}

/// Whether the contacts are on the body's outside, and its moments of inertia those of a body.
fn is_body(found: &Refined) -> bool {
    let Some(state) = found.state() else { return false };
    let Some(moments) = state.inertia_over_mass.try_symmetric_eigen(f64::EPSILON, MOST_ITERATIONS) else {
        return false;
    };
    let mut moments = moments.eigenvalues;
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let [a, b, c] = moments.into();
    let (measurements, first) = (&found.corrected, &found.corrected.palms[0]);
    let outside = (0..3)
        .all(|i| measurements.normal(first, i).dot(&(state.centre - measurements.contact(first, i))) > 0.0);
    a > 0.0 && c < 1.5 * (a + b) && outside
}
