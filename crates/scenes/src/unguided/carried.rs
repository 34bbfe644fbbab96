//! The residuals in units in which their errors are independent and of one size: the effects of a contact's error on later samples are included.
//!
//! A contact that errs by `e` moves the residual at its own sample by the rate at which the constraint changes along the palm. It also
//! makes the force err, which is a torque over the contact's lever, and the force's error remains in velocity, place and rate
//! at all later samples. So the residuals' errors are correlated; least squares that weights each by its own error alone wastes most of the
//! information of measurements with noise. The errors of `(c, v, omega)` from sample to sample are a Markov chain driven by the contacts' errors, and
//! the innovations of the residuals are white (T. Kailath, An innovations approach to least-squares estimation, 1968): the
//! covariance of all residuals is never formed, and a window costs as many operations as it has samples.
//!
//! The integrals of errors are those of the trapezoidal rule: these are weights.

use super::integrals::{Integrals, Sample};
use super::normal::{Normal, Row, Sums, Unknowns, swept};

/// `c`, `v` and `omega`.
const N: usize = 5;
type Vector = [f64; N];

/// The filter's prediction of the errors of `(c, v, omega)`: their covariance in units of a contact's variance, and their mean given the
/// earlier residuals, for the residual and each of its derivatives.
struct Carried {
    /// Its lower triangle.
    covariance: [Vector; N],
    foreseen: [Row; N],
}

impl Carried {
    /// The covariances with a quantity that has these derivatives.
    #[inline(always)]
    fn covary(&self, by: &Vector) -> Vector {
        std::array::from_fn(|i| {
            let before: f64 =
                self.covariance[i].iter().zip(by).take(i + 1).map(|(value, by)| value * by).sum();
            before + (i + 1..N).map(|j| self.covariance[j][i] * by[j]).sum::<f64>()
        })
    }

    /// The innovations of a sample's residuals with their derivatives, scaled so that they are independent and of one size.
    #[inline(always)]
    fn whiten(&mut self, rows: &mut [Row; 2], at: &Errors) {
        let mut gain = [[0.0; N]; 2];
        let mut covariance = [[0.0; 2]; 2];
        for p in 0..2 {
            let by = &at.by[p];
            gain[p] = self.covary(by);
            for (covariance, (by, own)) in covariance[p].iter_mut().zip(at.by.iter().zip(&at.own)).take(p + 1)
            {
                let carried: f64 = by.iter().zip(&gain[p]).map(|(by, gain)| by * gain).sum();
                *covariance = carried + at.own[p][0] * own[0] + at.own[p][1] * own[1];
            }
            covariance[p][p] += at.other;
            for (gain, (first, second)) in
                gain[p].iter_mut().zip(at.later[0].iter().zip(&at.later[1])).skip(2)
            {
                *gain += first * at.own[p][0] + second * at.own[p][1];
            }
            for (by, foreseen) in by.iter().zip(&self.foreseen) {
                for (value, foreseen) in rows[p].iter_mut().zip(foreseen) {
                    *value -= by * foreseen;
                }
            }
        }
        // L D L', two by two: covariances wait for no square root
        let first = 1.0 / covariance[0][0];
        let mixed = covariance[1][0] * first;
        let second = 1.0 / (covariance[1][1] - mixed * covariance[1][0]).max(at.other);
        let roots = [first.sqrt(), second.sqrt()];
        let [above, below] = rows;
        for (a, b) in above.iter_mut().zip(below) {
            (*a, *b) = (*a * roots[0], (*b - mixed * *a) * roots[1]);
        }
        let [above, below] = &*rows;
        let unmixed: [[f64; 2]; N] = std::array::from_fn(|i| [gain[0][i], gain[1][i] - mixed * gain[0][i]]);
        let parts = unmixed.map(|[a, b]| [a * first, b * second]);
        for i in 0..N {
            for (j, (covariance, unmixed)) in
                self.covariance[i].iter_mut().zip(&unmixed).enumerate().take(i + 1)
            {
                *covariance -= parts[i][0] * unmixed[0] + parts[i][1] * unmixed[1];
                // an error changes no place at once
                if j >= 2 {
                    *covariance += at.later[0][i] * at.later[0][j] + at.later[1][i] * at.later[1][j];
                }
            }
            let [first, second] = [unmixed[i][0] * roots[0], unmixed[i][1] * roots[1]];
            for (foreseen, (a, b)) in self.foreseen[i].iter_mut().zip(above.iter().zip(below)) {
                *foreseen += first * a + second * b;
            }
        }
    }

    /// To the next sample: the place moves with the velocity, and the forces turn the body about another place.
    #[inline(always)]
    fn pass(&mut self, time: f64, [x, y]: [f64; 2]) {
        let (x, y) = (time * x, time * y);
        let [px, py, vx, vy, omega] = &mut self.foreseen;
        for column in 0..px.len() {
            omega[column] -= x * px[column] + y * py[column];
            px[column] += time * vx[column];
            py[column] += time * vy[column];
        }
        let [[xx, ..], [xy, yy, ..], [xu, yu, uu, ..], [xv, yv, uv, vv, _], [xo, yo, uo, vo, oo]] =
            &mut self.covariance;
        // the rate first: it is moved by where the place was
        *oo -= x * (2.0 * *xo - x * *xx - y * *xy) + y * (2.0 * *yo - x * *xy - y * *yy);
        *xo -= x * *xx + y * *xy;
        *yo -= x * *xy + y * *yy;
        *uo -= x * *xu + y * *yu;
        *vo -= x * *xv + y * *yv;
        *xo += time * *uo;
        *yo += time * *vo;
        *xx += time * (2.0 * *xu + time * *uu);
        *xy += time * (*yu + *xv + time * *uv);
        *yy += time * (2.0 * *yv + time * *vv);
        *xu += time * *uu;
        *yu += time * *uv;
        *xv += time * *uv;
        *yv += time * *vv;
    }
}

/// The effects of errors at a sample.
struct Errors {
    /// The residuals' derivatives by `(c, v, omega)`.
    by: [Vector; 2],
    /// Those by both contacts here.
    own: [[f64; 2]; 2],
    /// The change of `(c, v, omega)` at all later samples by each contact's error.
    later: [Vector; 2],
    /// The variance of other errors.
    other: f64,
}

/// The normal equations of the whitened residuals at some unknowns; `softened` as in [`super::normal::Look`].
pub(super) fn expand(all: &Integrals, x: &Unknowns, softened: f64) -> Normal {
    let [cx, cy, vx, vy, rate, log_k] = *x;
    let k = log_k.exp();
    let mut sums = Sums::default();
    let mut carried = Carried { covariance: [[0.0; N]; N], foreseen: [[0.0; 8]; N] };
    let samples = &all.samples;
    for (i, sample) in samples.iter().enumerate() {
        let time = sample.time;
        let before = if i == 0 { time } else { samples[i - 1].time };
        let after = samples.get(i + 1).map_or(time, |next| next.time);
        let turned = sample.c - sample.a[0] * cx - sample.a[1] * cy - sample.b[0] * vx - sample.b[1] * vy;
        let omega = rate + k * turned;
        let slopes =
            [-k * sample.a[0], -k * sample.a[1], -k * sample.b[0], -k * sample.b[1], 1.0, k * turned];
        let place = [cx + vx * time + sample.place[0], cy + vy * time + sample.place[1]];
        let velocity = [vx + sample.velocity[0], vy + sample.velocity[1]];
        let mut rows = [[0.0; 8]; 2];
        let mut at = Errors {
            by: [[0.0; N]; 2],
            own: [[0.0; 2]; 2],
            later: [[0.0; N]; 2],
            other: softened * softened,
        };
        for (p, palm) in sample.palms.iter().enumerate() {
            let [nx, ny] = palm.normal;
            let arm = palm.lever - ny * place[0] + nx * place[1];
            let off = nx * velocity[0] + ny * velocity[1] + omega * arm - palm.rate * palm.lever;
            at.by[p] = [-omega * ny, omega * nx, nx, ny, arm];
            let [x, y, ..] = at.by[p];
            let turns = slopes.map(|slope| slope * arm);
            rows[p] = [
                off,
                turns[0] + x,
                turns[1] + y,
                turns[2] + nx + x * time,
                turns[3] + ny + y * time,
                turns[4],
                turns[5],
                0.0,
            ];
            // the force's derivative by the contact: the torque stays
            let along = -palm.force * palm.lever_slope / palm.lever;
            let across = palm.force * palm.bend;
            let force = [along * nx - across * ny, along * ny + across * nx];
            let turn = -k * (place[0] * force[1] - place[1] * force[0]);
            at.later[p] = [0.0, 0.0, force[0] / all.mass, force[1] / all.mass, turn];
            at.own[p][p] = palm.side * swept(palm, place, velocity, omega);
        }
        // the trapezoidal rule: half of an error counts here
        let [here, held] = [(time - before) / 2.0, (after - before) / 2.0];
        for p in 0..2 {
            for q in 0..2 {
                let sum: f64 = at.by[p].iter().zip(&at.later[q]).map(|(by, later)| by * later).sum();
                at.own[p][q] += here * sum;
            }
        }
        at.later.iter_mut().flatten().for_each(|value| *value *= held);
        carried.whiten(&mut rows, &at);
        rows.iter().for_each(|row| sums.add(row));
        carried.pass(after - time, turning(sample).map(|turning| k * turning));
    }
    sums.normal()
}

/// `A'`.
fn turning(sample: &Sample) -> [f64; 2] {
    let pushed = |axis: usize| sample.palms.iter().map(|palm| palm.force * palm.normal[axis]).sum::<f64>();
    [pushed(1), -pushed(0)]
}
