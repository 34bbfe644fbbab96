//! The constraint's residuals at all samples, each weighted by its own error.

use super::integrals::{Integrals, PalmSample, Sample};

/// `c0`, `v0`, `omega0` and the logarithm of `k`.
pub(super) type Unknowns = [f64; 6];

/// The sum of the squares of the residuals, half of its gradient, and its Gauss-Newton matrix.
#[derive(Clone, Debug, Default)]
pub(super) struct Normal {
    pub cost: f64,
    pub gradient: [f64; 6],
    pub matrix: [[f64; 6]; 6],
}

/// A residual and its derivatives by the unknowns; the last is zero, and fills the processor's registers up.
pub(super) type Row = [f64; 8];

/// Sums of the products of residuals and derivatives.
#[derive(Default)]
pub(super) struct Sums([Row; 7]);

impl Sums {
    #[inline(always)]
    pub(super) fn add(&mut self, row: &Row) {
        for (sums, by) in self.0.iter_mut().zip(row) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += by * value;
            }
        }
    }

    pub(super) fn normal(&self) -> Normal {
        let [[cost, gradient @ .., _], rows @ ..] = &self.0;
        Normal { cost: *cost, gradient: *gradient, matrix: rows.map(|[_, row @ .., _]| row) }
    }
}

/// Which samples are used, and how residuals are weighted.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// Every so many samples.
    pub stride: usize,
    /// A residual is the distance along the palm between a contact and its expected place: the constraint over its rate of change by that,
    /// which is `omega - w_i` of a flat palm; rates below this one are softened.
    pub softened: f64,
}

fn looked_at(all: &Integrals, look: Look) -> impl Iterator<Item = &Sample> {
    all.samples.iter().step_by(look.stride)
}

/// The derivative of the constraint by a contact's place along its palm, up to its sign: the palm turns with its own rate against the body, and
/// where it is bent its normal turns along it, so that the speed of sliding counts.
#[inline]
pub(super) fn swept(palm: &PalmSample, place: [f64; 2], velocity: [f64; 2], omega: f64) -> f64 {
    let turned = omega - palm.rate;
    if palm.bend == 0.0 {
        return turned;
    }
    let [tx, ty] = palm.tangent;
    let [x, y] = [palm.contact[0] - place[0], palm.contact[1] - place[1]];
    let sliding = tx * velocity[0] + ty * velocity[1] + omega * (ty * x - tx * y) - palm.own;
    turned - palm.bend * sliding
}

/// The sum of the squares alone.
pub(super) fn cost(all: &Integrals, x: &Unknowns, look: Look) -> f64 {
    let [cx, cy, vx, vy, rate, log_k] = *x;
    let k = log_k.exp();
    let mut cost = 0.0;
    for sample in looked_at(all, look) {
        let turned = sample.c - sample.a[0] * cx - sample.a[1] * cy - sample.b[0] * vx - sample.b[1] * vy;
        let omega = rate + k * turned;
        let place = [cx + vx * sample.time + sample.place[0], cy + vy * sample.time + sample.place[1]];
        let velocity = [vx + sample.velocity[0], vy + sample.velocity[1]];
        for palm in &sample.palms {
            let [nx, ny] = palm.normal;
            let arm = palm.lever - ny * place[0] + nx * place[1];
            let off = nx * velocity[0] + ny * velocity[1] + omega * arm - palm.rate * palm.lever;
            let swept = swept(palm, place, velocity, omega);
            cost += off * off / (swept * swept + look.softened * look.softened);
        }
    }
    cost
}

/// The residuals' normal equations.
pub(super) fn expand(all: &Integrals, x: &Unknowns, look: Look) -> Normal {
    let [cx, cy, vx, vy, rate, log_k] = *x;
    let k = log_k.exp();
    let mut sums = Sums::default();
    for sample in looked_at(all, look) {
        let turned = sample.c - sample.a[0] * cx - sample.a[1] * cy - sample.b[0] * vx - sample.b[1] * vy;
        let omega = rate + k * turned;
        let by = [-k * sample.a[0], -k * sample.a[1], -k * sample.b[0], -k * sample.b[1], 1.0, k * turned];
        let time = sample.time;
        let place = [cx + vx * time + sample.place[0], cy + vy * time + sample.place[1]];
        let velocity = [vx + sample.velocity[0], vy + sample.velocity[1]];
        for palm in &sample.palms {
            let [nx, ny] = palm.normal;
            let arm = palm.lever - ny * place[0] + nx * place[1];
            let off = nx * velocity[0] + ny * velocity[1] + omega * arm - palm.rate * palm.lever;
            let swept = swept(palm, place, velocity, omega);
            let weight = 1.0 / (swept * swept + look.softened * look.softened);
            let root = weight.sqrt();
            let bend = arm - off * swept * weight;
            let [x, y] = [-omega * ny, omega * nx];
            let row = [
                off,
                bend * by[0] + x,
                bend * by[1] + y,
                bend * by[2] + nx + time * x,
                bend * by[3] + ny + time * y,
                bend * by[4],
                bend * by[5],
                0.0,
            ];
            sums.add(&row.map(|value| value * root));
        }
    }
    sums.normal()
}
