//! The likeliest state and errors of the readings at once: Gauss and Newton's method on both, errors eliminated by the filter.

use super::change::{Change, Normal, Positive, Scale, shortened};
use super::constraint::expanded;
use super::flow::Start;
use super::integrals::{Integrals, Rules};
use super::linear::{backward, cholesky, forward};
use super::vector::{PLACES, symmetric};
use super::whiten::{Deviations, ERRORS, Whitener};
use super::{SolidReadings, SolidState, UNKNOWNS};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// What refinement ends with.
#[derive(Clone, Debug)]
pub(super) struct Refined {
    pub start: Start,
    /// The readings without the errors that they likely have.
    pub corrected: SolidReadings,
    pub chi_square: f64,
    /// The inverse of the covariance of changes.
    information: [[f64; UNKNOWNS]; UNKNOWNS],
    misfit: f64,
    /// J. von Neumann's ratio of the white residuals: about 2 where these are noise.
    pub ratio: f64,
    /// The deviation that contacts were weighed with, in m.
    weighed: f64,
}

/// The readings less errors in units of their deviations.
fn corrected(readings: &SolidReadings, errors: &[[f64; ERRORS]], deviations: &Deviations) -> SolidReadings {
    let mut own = readings.clone();
    for (palms, error) in own.palms.iter_mut().zip(errors) {
        for (i, palm) in palms.iter_mut().enumerate() {
            palm.place[0] -= deviations.contact * error[2 * i];
            palm.place[1] -= deviations.contact * error[2 * i + 1];
            palm.torque -= deviations.torque * error[6 + i];
        }
    }
    own
}

/// What a whole step would gain, in units of the deviations squared, below which no other one is taken; and below which what was found counts where none gains anything. Contacts that are said to be exact are weighed with
/// deviations that they have not, so that what is told a million times less than the rest still gains by far less.
const GAINED: [f64; 2] = [1e-8, 1e-2];
const EXACT_GAINED: f64 = 1e-18;

/// All constraints about a start and errors of the readings.
struct Linear {
    whitener: Whitener,
    /// The constraints as they would be without errors that are taken away.
    column: Vec<[f64; 3]>,
    rows: Vec<[Change; 3]>,
    normal: Normal,
    ratio: f64,
}

/// The mean square of what follows on each other less each other, over the mean square.
fn neumann(white: &[[f64; 3]]) -> f64 {
    let squares: f64 = white.iter().flatten().map(|value| value * value).sum();
    let steps: f64 =
        white.windows(2).flat_map(|pair| (0..3).map(|i| (pair[1][i] - pair[0][i]).powi(2))).sum();
    steps / squares * white.len() as f64 / (white.len() - 1) as f64
}

impl Linear {
    fn about(
        readings: &SolidReadings,
        rules: &Rules,
        spacing: &[f64],
        deviations: &Deviations,
        start: &Start,
        errors: &[[f64; ERRORS]],
    ) -> Option<Linear> {
        let own = corrected(readings, errors, deviations);
        if !own.is_whole() {
            return None;
        }
        let all = Integrals::of(&own, rules);
        let samples = expanded(start, &all);
        let whitener = Whitener::of(start, &all, &samples, spacing, deviations)?;
        let made = whitener.made_by(errors);
        let column: Vec<[f64; 3]> = samples
            .iter()
            .zip(&made)
            .map(|(at, made)| std::array::from_fn(|i| at.value[i] + made[i]))
            .collect();
        let chain = start.chain()?;
        let rows: Vec<[Change; 3]> = samples.iter().map(|at| at.by.map(|row| chain.row(&row))).collect();
        let white = whitener.white(&column);
        let columns: Vec<Vec<[f64; 3]>> = (0..UNKNOWNS)
            .map(|j| whitener.white(&rows.iter().map(|at| at.map(|row| row[j])).collect::<Vec<_>>()))
            .collect();
        let mut normal = Normal::none();
        for (k, residual) in white.iter().enumerate() {
            for i in 0..3 {
                let row: Change = std::array::from_fn(|j| columns[j][k][i]);
                normal.add(residual[i], &row);
            }
        }
        let ratio = neumann(&white);
        normal.cost.is_finite().then_some(Linear { whitener, column, rows, normal, ratio })
    }

    /// The likeliest errors after a step.
    fn errors(&self, step: &Change) -> Vec<[f64; ERRORS]> {
        let left = |(value, rows): (&[f64; 3], &[Change; 3])| {
            std::array::from_fn(|i| value[i] + rows[i].iter().zip(step).map(|(a, b)| a * b).sum::<f64>())
        };
        self.whitener.errors(&self.column.iter().zip(&self.rows).map(left).collect::<Vec<_>>())
    }
}

/// From a start; none where the method does not come to an end: with whole steps, and where these lead nowhere with damped ones.
pub(super) fn refine(
    readings: &SolidReadings,
    rules: &Rules,
    from: Start,
    scale: &Scale,
    deviations: &Deviations,
) -> Option<Refined> {
    let by = |growth: f64, most: usize| stepped(readings, rules, from, scale, deviations, (growth, most));
    by(f64::INFINITY, 15).or_else(|| by(GROWTH, 25))
}

/// By how much the sum of the squares may grow in a damped step. The filter's rule is not the one by which readings are integrated, so that errors which are taken away leave a few percent of what they make.
const GROWTH: f64 = 1.05;

/// The method with steps after which the sum of the squares is no more than so many times as large, and so many of them.
fn stepped(
    readings: &SolidReadings,
    rules: &Rules,
    from: Start,
    scale: &Scale,
    deviations: &Deviations,
    (growth, most): (f64, usize),
) -> Option<Refined> {
    let spacing = rules.spacing();
    let about = |start: &Start, errors: &[[f64; ERRORS]]| {
        Linear::about(readings, rules, &spacing, deviations, start, errors)
    };
    let mut start = from;
    let mut here = about(&start, &vec![[0.0; ERRORS]; readings.rows()])?;
    let mut damping = if growth.is_finite() { 1e-4 } else { 0.0 };
    let least = if readings.contact_deviation > 0.0 { GAINED[0] } else { EXACT_GAINED };
    let (mut gain, mut last) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..most {
        let whole = here.normal.step(0.0)?;
        gain = -whole.iter().zip(&here.normal.gradient).map(|(a, b)| a * b).sum::<f64>();
        // where rounding alone is left, steps gain no less than those before
        if gain < least || (gain >= last && gain < GAINED[1] / 10.0) {
            break;
        }
        last = gain;
        let mut next = None;
        for _ in 0..8 {
            let by = if gain < GAINED[1] { 0.0 } else { damping };
            let step = shortened(&here.normal.step(by)?, scale);
            if let Some(there) = start.changed(&step) {
                let its_errors = here.errors(&step);
                let found = about(&there, &its_errors);
                next =
                    found.filter(|found| found.normal.cost <= growth * here.normal.cost).map(|f| (there, f));
            }
            if next.is_some() || by == 0.0 {
                break;
            }
            damping *= 10.0;
        }
        let Some(next) = next else { break };
        (start, here) = next;
        damping *= 0.03;
    }
    if gain.is_nan() || gain > GAINED[1] {
        return None;
    }
    let errors = here.errors(&[0.0; UNKNOWNS]);
    let contacts: f64 = errors.iter().flat_map(|error| &error[..6]).map(|e| e * e).sum();
    let misfit = deviations.contact * (contacts / (6 * errors.len()) as f64).sqrt();
    let corrected = corrected(readings, &errors, deviations);
    let Linear { normal, ratio, .. } = here;
    let weighed = deviations.contact;
    Some(Refined {
        start,
        corrected,
        chi_square: normal.cost,
        information: normal.matrix,
        misfit,
        ratio,
        weighed,
    })
}

impl Refined {
    /// What is told of it.
    pub fn state(&self) -> Option<SolidState> {
        let k = Positive::of(&self.start.inverse)?;
        let triangle = cholesky(&self.information, UNKNOWNS)?;
        let inertia = Matrix3::from_fn(|i, j| k.inverse[i][j]);
        // what the sought numbers change by in each change
        let c = Matrix3::from_fn(|i, j| k.triangle[i][j]);
        let mut by = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
        for a in 0..6 {
            let mut unit = [0.0; 6];
            unit[a] = 1.0;
            let x = symmetric(&unit);
            let dk = c * Matrix3::from_fn(|i, j| x[i][j]) * c.transpose();
            let dj = -inertia * dk * inertia;
            for (b, place) in PLACES.iter().enumerate() {
                by[(9 + b, 9 + a)] = dj[*place];
            }
        }
        by[(15, 15)] = self.start.mu;
        let mut inverse = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
        for j in 0..UNKNOWNS {
            let mut unit = [0.0; UNKNOWNS];
            unit[j] = 1.0;
            let column = backward(&triangle, UNKNOWNS, &forward(&triangle, UNKNOWNS, &unit));
            for (i, value) in column.iter().enumerate() {
                inverse[(i, j)] = *value;
            }
        }
        let degrees = 3 * self.corrected.rows() - UNKNOWNS;
        Some(SolidState {
            centre: Vector3::from(self.start.centre),
            velocity: Vector3::from(self.start.velocity),
            rate: Vector3::from(self.start.rate),
            inertia_over_mass: inertia,
            mass: 1.0 / self.start.mu,
            covariance: by * inverse * by.transpose(),
            chi_square: self.chi_square,
            degrees,
            misfit: self.misfit,
            ratio: self.ratio,
            weighed: self.weighed,
            contacts_are_stated: self.corrected.contact_deviation > 0.0,
            is_stated: self.corrected.contact_deviation > 0.0 || self.corrected.torque_deviation > 0.0,
        })
    }
}
