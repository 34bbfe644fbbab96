//! The constraints of all samples to first order, about a state and errors of the measurements; errors are the likeliest for each change of the state.

use super::change::{Change, Normal};
use super::constraint::expanded;
use super::flow::Start;
use super::integrals::{Integrals, Rules};
use super::vector::dot;
use super::whiten::{Deviations, ERRORS, Whitener};
use super::{SolidMeasurements, UNKNOWNS};

/// The measurements less errors in units of their deviations.
pub(super) fn corrected(
    measurements: &SolidMeasurements,
    errors: &[[f64; ERRORS]],
    deviations: &Deviations,
) -> SolidMeasurements {
    let mut own = measurements.clone();
    for (palms, error) in own.palms.iter_mut().zip(errors) {
        for (i, palm) in palms.iter_mut().enumerate() {
            palm.place[0] -= deviations.contact * error[2 * i];
            palm.place[1] -= deviations.contact * error[2 * i + 1];
            palm.torque -= deviations.torque * error[6 + i];
        }
    }
    own
}

/// All constraints about a start and errors of the measurements.
pub(super) struct Linear {
    whitener: Whitener,
    /// The constraints with the estimated errors added back.
    column: Vec<[f64; 3]>,
    rows: Vec<[Change; 3]>,
    pub normal: Normal,
    /// J. von Neumann's ratio of the white residuals.
    pub ratio: f64,
}

/// The mean square of the differences of successive residuals, divided by their mean square.
fn neumann(white: &[[f64; 3]]) -> f64 {
    let squares: f64 = white.iter().flatten().map(|value| value * value).sum();
    let steps: f64 =
        white.windows(2).flat_map(|pair| (0..3).map(|i| (pair[1][i] - pair[0][i]).powi(2))).sum();
    steps / squares * white.len() as f64 / (white.len() - 1) as f64
}

impl Linear {
    pub fn about(
        measurements: &SolidMeasurements,
        rules: &Rules,
        deviations: &Deviations,
        start: &Start,
        errors: &[[f64; ERRORS]],
    ) -> Option<Linear> {
        let none = vec![[0.0; ERRORS]; measurements.rows()];
        let errors = if errors.is_empty() { &none } else { errors };
        let own = corrected(measurements, errors, deviations);
        if !own.is_whole() {
            return None;
        }
        let all = Integrals::of(&own, rules);
        let samples = expanded(start, &all);
        let whitener =
            Whitener::of(start, &all, &samples, rules, deviations, measurements.contact_deviation > 0.0)?;
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
        let multipliers = whitener.multipliers(&column);
        normal.cost = 0.0;
        normal.gradient = [0.0; UNKNOWNS];
        for ((value, rows), by) in column.iter().zip(&rows).zip(&multipliers) {
            normal.cost += dot(value, by);
            for i in 0..3 {
                for j in 0..UNKNOWNS {
                    normal.gradient[j] += rows[i][j] * by[i];
                }
            }
        }
        normal.cost.is_finite().then_some(Linear { whitener, column, rows, normal, ratio })
    }

    /// The likeliest errors after a step.
    pub fn errors(&self, step: &Change) -> Vec<[f64; ERRORS]> {
        let left = |(value, rows): (&[f64; 3], &[Change; 3])| {
            std::array::from_fn(|i| value[i] + rows[i].iter().zip(step).map(|(a, b)| a * b).sum::<f64>())
        };
        let column: Vec<_> = self.column.iter().zip(&self.rows).map(left).collect();
        self.whitener.likely(&self.whitener.multipliers(&column))
    }
}
