//! Where to begin, from readings alone: drawn thoughts of how a body like a ball lies and turns, each followed (`regular`) while readings take over.
//!
//! It does not always arrive: with noise of a thousandth of the body a wrong minimum may be met first. One that does not explain the readings says so
//! (`SolidState::fits`), and the search goes on. With noise, readings that are nearly blind may be explained by more than one state: another end is looked for, and one that explains them as well is told (`Rival`).

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

/// Contacts whose noise is not stated are weighed as if they had errors of this part of their distances: what is left by the true state of exact readings is rounding and the rule of integration, a thousandth of that
/// or less. How much may be left is for `SolidState::fits`.
const NOTHING: f64 = 1e-6;
/// Rates below this part of a fall's, the root of gravity over the body's length, are softened.
const SOFTENED: f64 = 3e-4;

/// So many priors are drawn. After each round of them those paths that stalled lowest are refined too, so many: noise that is not stated stalls all.
const DRAWS: usize = 80;
const ROUND: usize = 20;
const STALLED: usize = 3;
/// How far priors are drawn from what is likely: the centre in lengths, velocity and rate in those of a fall, the inverse of the inertia in that of a ball.
const DRAWN: [f64; 4] = [0.1, 0.1, 0.15, 0.15];

/// What is known before anything is sought.
struct Likely {
    centre: Vector,
    mu: f64,
    length: f64,
    /// The rate of a fall, in 1/s.
    fall: f64,
    deviations: Deviations,
    /// What part of the record is looked at before all of it is: six times the time in which a body falls by about its size.
    part: f64,
}

impl Likely {
    fn of(readings: &SolidMeasurements) -> Option<Likely> {
        // the point next to all normals through contacts of the first samples
        let few = (readings.rows() / 20).max(3);
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let mut force = Vector3::zeros();
        for palms in &readings.palms {
            for (i, palm) in palms.iter().enumerate() {
                force += readings.normal(palms, i) * (palm.torque / readings.lever(palms, i));
            }
        }
        for palms in &readings.palms[..few] {
            for i in 0..3 {
                let (contact, n) = (readings.contact(palms, i), readings.normal(palms, i));
                let across = Matrix3::identity() - n * n.transpose();
                matrix += across;
                right += across * contact;
            }
        }
        let meeting = matrix.try_inverse()? * right;
        let mut spread = 0.0;
        for palms in &readings.palms {
            for i in 0..3 {
                spread += (readings.contact(palms, i) - meeting).norm_squared();
            }
        }
        let count = (3 * readings.rows()) as f64;
        let length = (spread / count).sqrt();
        let weight = readings.gravity.norm();
        let force = force.norm() / readings.rows() as f64;
        let duration = readings.times[readings.rows() - 1] - readings.times[0];
        let usable = length > 0.0 && weight > 0.0 && force > 0.0;
        let contact = readings.contact_deviation.max(NOTHING * length);
        let fall = (weight / length).sqrt();
        let deviations = Deviations { contact, torque: readings.torque_deviation, softened: SOFTENED * fall };
        usable.then(|| Likely {
            centre: meeting.into(),
            mu: weight / force,
            length,
            fall,
            deviations,
            part: (6.0 / (fall * duration)).min(1.0),
        })
    }

    /// A body like a ball at rest, moved by so many draws.
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
    fn records(&self, readings: &SolidMeasurements, first: f64) -> Vec<Integrals> {
        let mut parts = vec![first * self.part];
        while parts[parts.len() - 1] < 1.0 {
            parts.push((2.0 * parts[parts.len() - 1]).min(1.0));
        }
        let of = |part: &f64| {
            let samples = (25.0 * part / self.part).clamp(25.0, 60.0) as usize;
            let rules = Rules::of(&readings.times, chosen(readings.rows(), *part, samples));
            Integrals::of(readings, &rules)
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

/// The best that was found.
pub(super) fn found(readings: &SolidMeasurements, interrupt: &dyn Fn() -> bool) -> Option<Refined> {
    if !readings.is_whole() || readings.is_still() {
        return None;
    }
    let mut search = Search::of(readings, Likely::of(readings)?);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    // half of the draws begin with half of what is likely enough
    let records = [1.0, 0.5].map(|part| search.likely.records(readings, part));
    let mut stalled: Vec<Ended> = Vec::new();
    for k in 0..DRAWS {
        if interrupt() {
            return search.told();
        }
        let prior = search.likely.drawn(&mut random, f64::from(u8::from(k > 0)));
        let error = readings.contact_deviation / search.likely.length;
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

/// Where readings have errors, so many ends that explain them are compared before one is told.
const ENDS: usize = 2;
/// After so many that do not fit, or are no body, it is given up: what is nearly blind leads all starts along its valleys.
const ASTRAY: usize = 6;
/// A state is a rival where it leaves no more than this over the least, and an entry of it is more than so many deviations away: were the likelihood what the bound says, it would leave as much as the square of that.
const LEAVES: f64 = 25.0;
const APART: f64 = 5.0;

/// What was found until now.
struct Search<'a> {
    readings: &'a SolidMeasurements,
    likely: Likely,
    whole: Rules,
    best: Option<Refined>,
    /// All that fit: what they leave, and what they say.
    ends: Vec<(f64, [f64; UNKNOWNS])>,
    /// How many ends are none of those.
    astray: usize,
}

impl Search<'_> {
    fn of(readings: &SolidMeasurements, likely: Likely) -> Search<'_> {
        let whole = Rules::of(&readings.times, (0..readings.rows()).collect());
        Search { readings, likely, whole, best: None, ends: Vec::new(), astray: 0 }
    }

    fn refine(&mut self, start: Start) {
        let scale = Scale { length: self.likely.length, rate: self.likely.fall };
        let Some(refined) = refine(self.readings, &self.whole, start, &scale, &self.likely.deviations) else {
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

    /// Exact readings are explained by one state, and what is astray there has cost little.
    fn is_done(&self) -> bool {
        match self.readings.contact_deviation > 0.0 {
            true => self.ends.len() >= ENDS || self.astray >= ASTRAY,
            false => !self.ends.is_empty(),
        }
    }

    /// The best, with the one that is furthest from it among those that explain the readings as well.
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
    let (readings, first) = (&found.corrected, &found.corrected.palms[0]);
    let outside =
        (0..3).all(|i| readings.normal(first, i).dot(&(state.centre - readings.contact(first, i))) > 0.0);
    a > 0.0 && c < 1.5 * (a + b) && outside
}
