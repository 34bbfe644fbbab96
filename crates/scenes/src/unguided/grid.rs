//! Initial values: the rate and its slope on a grid, all else by linear least squares.
//!
//! A window is so short that the body's rate is nearly a straight line through it. Where that line is given the constraint is linear in the centre and
//! its velocity, and so is its weight known: no search is needed, and no false minimum is met in these four unknowns. `k` follows from the slope.

use super::integrals::Integrals;
use super::normal::Unknowns;

/// The logarithm of the initial `k` is that of a disc within this.
const UNLIKE: f64 = 1.5;

/// A grid over rates at the first sample and their slopes.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    /// Rates, and slopes, from one end to the other.
    pub size: [usize; 2],
    /// The number of samples that are used.
    pub samples: usize,
    /// Rates of sliding below this part of the largest likely rate are softened.
    pub softened: f64,
}

/// One palm at one sample.
struct Row {
    normal: [f64; 2],
    time: f64,
    rate: f64,
    /// The residual of a body whose centre starts at rest in the origin: without a rate, and the part proportional to the rate.
    still: f64,
    turning: f64,
}

/// From -1 to 1, denser about zero.
fn part(i: usize, of: usize) -> f64 {
    let even = 2.0 * i as f64 / (of - 1) as f64 - 1.0;
    (1.5 * even).sinh() / 1.5f64.sinh()
}

impl Grid {
    /// At each rate the slopes whose residual is a local minimum over slopes, sorted by the residual. The valleys are narrow and aslant: minima
    /// over rates, too, would lose many.
    pub(super) fn minima(self, all: &Integrals) -> Vec<(Unknowns, f64)> {
        let stride = ((all.samples.len() - 1) / (self.samples - 1)).max(1);
        let rows: Vec<Row> = all
            .samples
            .iter()
            .step_by(stride)
            .flat_map(|sample| {
                sample.palms.iter().map(|palm| {
                    let [nx, ny] = palm.normal;
                    Row {
                        normal: palm.normal,
                        time: sample.time,
                        rate: palm.rate,
                        still: nx * sample.velocity[0] + ny * sample.velocity[1] - palm.rate * palm.lever,
                        turning: palm.lever - ny * sample.place[0] + nx * sample.place[1],
                    }
                })
            })
            .collect();
        let [rates, slopes] = self.size;
        let least = (self.softened * all.rate).powi(2);
        let lines = |largest: f64, count: usize| -> Vec<f64> {
            (0..count).map(|i| largest * part(i, count)).collect()
        };
        let (all_rates, all_slopes) = (lines(all.rate, rates), lines(all.slope, slopes));
        let mut found = vec![None; rates * slopes];
        for (i, place) in found.iter_mut().enumerate() {
            let line = [all_rates[i / slopes], all_slopes[i % slopes]];
            *place =
                solved(&rows, line, least).filter(|(x, _)| all.radii([x[0], x[1]]).iter().all(|r| *r > 0.0));
        }
        let cost = |i: usize| found[i].map_or(f64::INFINITY, |(_, cost)| cost);
        let mut minima: Vec<(Unknowns, f64)> = (0..found.len())
            .filter(|i| {
                let (a, b) = (i / slopes, i % slopes);
                let beside = b.saturating_sub(1)..=(b + 1).min(slopes - 1);
                found[*i].is_some() && beside.into_iter().all(|d| cost(*i) <= cost(a * slopes + d))
            })
            .map(|i| {
                let (x, cost) = found[i].unwrap_or_default();
                ([x[0], x[1], x[2], x[3], x[4], log_k(all, &x, all_slopes[i % slopes])], cost)
            })
            .collect();
        minima.sort_by(|a, b| a.1.total_cmp(&b.1));
        minima
    }
}

/// `k` by which the forces turn the body as fast as the slope requires; that of a disc where it is none of a body.
fn log_k(all: &Integrals, x: &Unknowns, slope: f64) -> f64 {
    let likely = all.likely_log_k([x[0], x[1]]);
    if all.log_k.is_some() {
        return likely;
    }
    let (mut both, mut square) = (0.0, 0.0);
    for sample in all.samples.iter().step_by(8) {
        let [a, b] = [sample.a, sample.b];
        let turned = sample.c - a[0] * x[0] - a[1] * x[1] - b[0] * x[2] - b[1] * x[3];
        both += turned * slope * sample.time;
        square += turned * turned;
    }
    let k = both / square;
    if k > 0.0 && k.is_finite() { k.ln().clamp(likely - UNLIKE, likely + UNLIKE) } else { likely }
}

/// Centre and velocity for a rate that is a line, and the residual sum of squares.
fn solved(rows: &[Row], [rate, slope]: [f64; 2], least: f64) -> Option<(Unknowns, f64)> {
    let mut m = [[0.0; 4]; 4];
    let mut g = [0.0; 4];
    let mut cost = 0.0;
    for row in rows {
        let omega = rate + slope * row.time;
        let weight = 1.0 / ((omega - row.rate) * (omega - row.rate) + least);
        let [nx, ny] = row.normal;
        let (x, y) = (-omega * ny, omega * nx);
        let by = [x, y, nx + x * row.time, ny + y * row.time];
        let off = row.still + omega * row.turning;
        cost += weight * off * off;
        for i in 0..4 {
            let weighted = weight * by[i];
            g[i] += weighted * off;
            for j in 0..=i {
                m[i][j] += weighted * by[j];
            }
        }
    }
    // Cholesky
    let mut y = [0.0; 4];
    for i in 0..4 {
        for j in 0..=i {
            let value = (0..j).fold(m[i][j], |value, k| value - m[i][k] * m[j][k]);
            if i == j {
                if value <= 1e-13 * m[i][i] {
                    return None;
                }
                m[i][i] = value.sqrt();
            } else {
                m[i][j] = value / m[j][j];
            }
        }
        let mut value = -g[i];
        for k in 0..i {
            value -= m[i][k] * y[k];
        }
        y[i] = value / m[i][i];
        cost -= y[i] * y[i];
    }
    let mut x = [0.0; 6];
    for i in (0..4).rev() {
        let mut value = y[i];
        for k in i + 1..4 {
            value -= m[k][i] * x[k];
        }
        x[i] = value / m[i][i];
    }
    x[4] = rate;
    Some((x, cost.max(0.0)))
}
