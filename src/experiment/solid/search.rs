//! Where to begin, from readings alone: angular velocities all over a ball, each with a body that turns like a solid ball.
//!
//! It does not always arrive: with noise of a thousandth of the body, or over a second and a half in which a body turns little, a wrong minimum may be met first. One that does not explain the readings says so
//! (`SolidState::fits`), and the search goes on; with noise, readings that are nearly blind may be explained by more than one state.

use super::descent::{Free, Scale, descend};
use super::flow::Start;
use super::integrals::{Integrals, Rules};
use super::refine::{Refined, refine};
use super::vector::{Vector, along, dot};
use super::whiten::Deviations;
use super::{FEWEST, SolidReadings};
use nalgebra::{Matrix3, Vector3};

/// Contacts whose noise is not stated are weighed as if they had errors of this part of their distances: what is left by the true state of exact readings is rounding and the rule of integration, a thousandth of that
/// or less. How much may be left is for `SolidState::fits`.
const NOTHING: f64 = 1e-6;
/// Rates below these parts of the largest are softened: while it is sought, and at the end.
const SOFTENED: [f64; 3] = [0.05, 0.01, 0.001];

/// One pass over rates.
struct Pass {
    /// Directions.
    directions: usize,
    /// Magnitudes, in parts of the largest.
    magnitudes: &'static [f64],
    /// The part that is looked at first, of what is looked at before the whole record; and how many samples of it.
    part: f64,
    samples: usize,
    /// How many are let go.
    kept: usize,
}

const PASSES: [Pass; 4] = [
    Pass { directions: 12, magnitudes: &[0.5], part: 0.5, samples: 9, kept: 3 },
    Pass { directions: 20, magnitudes: &[0.25, 0.7], part: 1.0, samples: 12, kept: 6 },
    Pass { directions: 40, magnitudes: &[0.15, 0.4, 1.0], part: 0.3, samples: 12, kept: 10 },
    Pass { directions: 60, magnitudes: &[0.3, 0.8], part: 0.7, samples: 14, kept: 12 },
];

/// What is known before anything is sought.
struct Likely {
    centre: Vector,
    mu: f64,
    scale: Scale,
    deviations: Deviations,
    /// What part of the record is looked at before all of it is: six times the time in which a body falls by about its size.
    part: f64,
}

impl Likely {
    fn of(readings: &SolidReadings) -> Option<Likely> {
        // the point next to all normals through contacts of the first samples
        let few = (readings.rows() / 20).max(3);
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let mut force = Vector3::zeros();
        for palms in &readings.palms {
            for palm in palms {
                force += palm.frame.column(2) * (palm.torque / palm.place[1]);
            }
        }
        for palms in &readings.palms[..few] {
            for (palm, hinge) in palms.iter().zip(&readings.hinges) {
                let contact = hinge + palm.frame * Vector3::new(palm.place[0], palm.place[1], 0.0);
                let n = palm.frame.column(2);
                let across = Matrix3::identity() - n * n.transpose();
                matrix += across;
                right += across * contact;
            }
        }
        let meeting = matrix.try_inverse()? * right;
        let mut spread = 0.0;
        let (mut moved, mut spun) = (0.0, 0.0);
        let stride = (readings.rows() / 12).max(1);
        for (k, palms) in readings.palms.iter().enumerate() {
            for (i, palm) in palms.iter().enumerate() {
                let contact =
                    readings.hinges[i] + palm.frame * Vector3::new(palm.place[0], palm.place[1], 0.0);
                spread += (contact - meeting).norm_squared();
                spun += palm.rate * palm.rate;
                if let Some(later) = readings.palms.get(k + stride) {
                    let time = readings.times[k + stride] - readings.times[k];
                    let [p, q] = [0, 1].map(|a: usize| (later[i].place[a] - palm.place[a]) / time);
                    moved += p * p + q * q;
                }
            }
        }
        let count = (3 * readings.rows()) as f64;
        let length = (spread / count).sqrt();
        let rate = 2.0 * (moved / count).sqrt() / length + (spun / count).sqrt();
        let weight = readings.gravity.norm();
        let force = force.norm() / readings.rows() as f64;
        let duration = readings.times[readings.rows() - 1] - readings.times[0];
        let usable = length > 0.0 && rate > 0.0 && weight > 0.0 && force > 0.0;
        let contact = readings.contact_deviation.max(NOTHING * length);
        let deviations =
            Deviations { contact, torque: readings.torque_deviation, softened: SOFTENED[2] * rate };
        usable.then(|| Likely {
            centre: meeting.into(),
            mu: weight / force,
            scale: Scale { length, rate },
            deviations,
            part: (6.0 * (length / weight).sqrt() / duration).min(1.0),
        })
    }

    fn start(&self, rate: Vector) -> Option<Start> {
        let inverse = 1.0 / (0.4 * self.scale.length * self.scale.length);
        let ball = [inverse, inverse, inverse, 0.0, 0.0, 0.0];
        Start::new(self.centre, [0.0; 3], rate, ball, self.mu)
    }
}

/// Directions evenly over the sphere, on a spiral.
fn direction(k: usize, of: usize) -> Vector {
    let z = 1.0 - (2 * k + 1) as f64 / of as f64;
    let (sine, cosine) = (2.399_963_229_728_653 * k as f64).sin_cos();
    let across = (1.0 - z * z).sqrt();
    [across * cosine, across * sine, z]
}

/// Samples evenly over a part of the record.
fn chosen(rows: usize, part: f64, samples: usize) -> Vec<usize> {
    let last = (((rows - 1) as f64 * part) as usize).clamp(FEWEST - 1, rows - 1);
    let samples = samples.min(last + 1);
    (0..samples).map(|k| k * last / (samples - 1)).collect()
}

/// The best that was found.
pub(super) fn found(readings: &SolidReadings, interrupt: &dyn Fn() -> bool) -> Option<Refined> {
    if !readings.is_whole() {
        return None;
    }
    let likely = Likely::of(readings)?;
    let whole = Rules::of(&readings.times, (0..readings.rows()).collect());
    let mut best: Option<Refined> = None;
    for pass in &PASSES {
        for candidate in pass.candidates(readings, &likely, interrupt) {
            if interrupt() {
                return best;
            }
            let Some(refined) = let_go(readings, &likely, &whole, candidate) else { continue };
            if !is_body(&refined) || best.as_ref().is_some_and(|best| refined.chi_square >= best.chi_square) {
                continue;
            }
            let fits = refined.state().is_some_and(|state| state.fits());
            best = Some(refined);
            if fits {
                return best;
            }
        }
    }
    best
}

/// All unknowns let go, on more and more of the record.
fn let_go(readings: &SolidReadings, likely: &Likely, whole: &Rules, candidate: Start) -> Option<Refined> {
    let mut here = candidate;
    let mut part = 0.5 * likely.part;
    loop {
        let samples = (25.0 * part / likely.part).clamp(13.0, 60.0) as usize;
        let rules = Rules::of(&readings.times, chosen(readings.rows(), part, samples));
        let all = Integrals::of(readings, &rules);
        let soft = SOFTENED[usize::from(part >= likely.part)] * likely.scale.rate;
        here = descend(&all, here, Free::Mass, &likely.scale, soft, 10).0;
        here = descend(&all, here, Free::All, &likely.scale, soft, 30).0;
        if part >= 1.0 {
            break;
        }
        part = (2.0 * part).min(1.0);
    }
    refine(readings, whole, here, &likely.scale, &likely.deviations)
}

impl Pass {
    /// The best states of bodies like balls, those first that leave least.
    fn candidates(
        &self,
        readings: &SolidReadings,
        likely: &Likely,
        interrupt: &dyn Fn() -> bool,
    ) -> Vec<Start> {
        let rules =
            Rules::of(&readings.times, chosen(readings.rows(), self.part * likely.part, self.samples));
        let all = Integrals::of(readings, &rules);
        let soft = SOFTENED[0] * likely.scale.rate;
        let mut ends: Vec<(Start, f64)> = Vec::new();
        for magnitude in self.magnitudes {
            for k in 0..self.directions {
                if interrupt() {
                    return Vec::new();
                }
                let rate = direction(k, self.directions).map(|value| value * magnitude * likely.scale.rate);
                let Some(start) = likely.start(rate) else { continue };
                let (end, cost) = descend(&all, start, Free::Motion, &likely.scale, soft, 8);
                let is_known = |(other, least): &(Start, f64)| {
                    let off = along(&end.rate, -1.0, &other.rate);
                    dot(&off, &off).sqrt() < 0.02 * likely.scale.rate && (least - cost).abs() < 0.02 * least
                };
                if cost.is_finite() && !ends.iter().any(is_known) {
                    ends.push((end, cost));
                }
            }
        }
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        ends.into_iter().take(self.kept).map(|(end, _)| end).collect()
    }
}

/// Whether the contacts are on the body's outside, and its moments of inertia those of a body.
fn is_body(found: &Refined) -> bool {
    let Some(state) = found.state() else { return false };
    let mut moments = state.inertia_over_mass.symmetric_eigenvalues();
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let [a, b, c] = moments.into();
    let first = &found.corrected.palms[0];
    let outside = first.iter().zip(&found.corrected.hinges).all(|(palm, hinge)| {
        let contact = hinge + palm.frame * Vector3::new(palm.place[0], palm.place[1], 0.0);
        palm.frame.column(2).dot(&(state.centre - contact)) > 0.0
    });
    a > 0.0 && c < 1.5 * (a + b) && outside
}
