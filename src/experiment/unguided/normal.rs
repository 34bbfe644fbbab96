//! The constraint's residuals at all samples, and steps that make them smaller.

use super::integrals::{Integrals, PalmSample, Sample};

/// `c0`, `v0`, `omega0` and the logarithm of `k`.
pub(super) type Unknowns = [f64; 6];

/// The sum of the squares of the residuals, half of its gradient, and its matrix of second derivatives by Gauss and Newton.
struct Normal {
    cost: f64,
    gradient: [f64; 6],
    matrix: [[f64; 6]; 6],
}

/// Which samples are looked at, and how residuals are weighed.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// Every so many samples.
    pub stride: usize,
    /// A residual is the palm's distance of where a contact is from where it had to be: the constraint over its rate of change by that,
    /// which is `omega - w_i` of a flat palm; rates below this one are softened.
    pub softened: f64,
}

/// Which unknowns are free.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Free {
    /// The velocity alone; `k` is that of a disc.
    Velocity,
    /// Centre and velocity; `k` is that of a disc.
    Motion,
    /// All, `k` drawn to that of a disc as strongly as the residuals let it.
    Drawn,
    /// All.
    All,
}

impl Free {
    fn places(self, is_k_known: bool) -> std::ops::Range<usize> {
        match self {
            Free::Velocity => 2..4,
            Free::Motion => 0..4,
            Free::Drawn | Free::All if is_k_known => 0..5,
            Free::Drawn | Free::All => 0..6,
        }
    }
}

fn looked_at(all: &Integrals, look: Look) -> impl Iterator<Item = &Sample> {
    all.samples.iter().step_by(look.stride)
}

/// The derivative of the constraint by a contact's place along its palm, up to its sign: the palm turns with its own rate against the body, and
/// where it is bent its normal turns along it, so that the speed of sliding counts.
fn swept(palm: &PalmSample, place: [f64; 2], velocity: [f64; 2], omega: f64) -> f64 {
    let turned = omega - palm.rate;
    if palm.bend == 0.0 {
        return turned;
    }
    // along the palm, away from the hinge
    let [tx, ty] = [palm.side * palm.normal[1], -palm.side * palm.normal[0]];
    let [nx, ny] = palm.normal;
    let along = palm.side * palm.lever;
    let contact = [along * tx + palm.height * nx, along * ty + palm.height * ny];
    let [x, y] = [contact[0] - place[0], contact[1] - place[1]];
    let body = [velocity[0] - omega * y, velocity[1] + omega * x];
    let own = [-palm.rate * contact[1], palm.rate * contact[0]];
    let sliding = tx * (body[0] - own[0]) + ty * (body[1] - own[1]);
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
fn expand(all: &Integrals, x: &Unknowns, look: Look) -> Normal {
    let [cx, cy, vx, vy, rate, log_k] = *x;
    let k = log_k.exp();
    let mut normal = Normal { cost: 0.0, gradient: [0.0; 6], matrix: [[0.0; 6]; 6] };
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
            let mut row = by.map(|by| by * bend);
            row[0] -= omega * ny;
            row[1] += omega * nx;
            row[2] += nx - omega * time * ny;
            row[3] += ny + omega * time * nx;
            let row = row.map(|value| value * root);
            let residual = off * root;
            normal.cost += residual * residual;
            for i in 0..6 {
                normal.gradient[i] += row[i] * residual;
                for j in 0..=i {
                    normal.matrix[i][j] += row[i] * row[j];
                }
            }
        }
    }
    normal
}

/// The solution of a part of the normal equations with the diagonal made larger by a part of itself, by Cholesky; the lower triangle is
/// given.
fn solve(normal: &Normal, places: &std::ops::Range<usize>, damping: f64) -> Option<[f64; 6]> {
    let (start, size) = (places.start, places.len());
    let mut l = [[0.0; 6]; 6];
    for i in 0..size {
        for j in 0..=i {
            let mut value = normal.matrix[start + i][start + j];
            if i == j {
                value *= 1.0 + damping;
            }
            value -= l[i][..j].iter().zip(&l[j][..j]).map(|(a, b)| a * b).sum::<f64>();
            l[i][j] = if i != j {
                value / l[j][j]
            } else if value > 0.0 {
                value.sqrt()
            } else {
                return None;
            };
        }
    }
    let mut y = [0.0; 6];
    for i in 0..size {
        let sum: f64 = (0..i).map(|m| l[i][m] * y[m]).sum();
        y[i] = (-normal.gradient[start + i] - sum) / l[i][i];
    }
    let mut step = [0.0; 6];
    for i in (0..size).rev() {
        let sum: f64 = (i + 1..size).map(|m| l[m][i] * step[start + m]).sum();
        step[start + i] = (y[i] - sum) / l[i][i];
    }
    step.iter().all(|value| value.is_finite()).then_some(step)
}

/// How strongly `k` is drawn to that of a disc, in parts of the residuals.
const DRAWN: f64 = 0.3;
/// `k` changes by no more than this factor's logarithm in one step.
const LONGEST: f64 = 1.5;

/// Levenberg and Marquardt's method from a start; the unknowns and the sum of the squares that it ends with.
pub(super) fn descend(
    all: &Integrals,
    start: Unknowns,
    free: Free,
    look: Look,
    steps: usize,
) -> (Unknowns, f64) {
    let places = free.places(all.log_k.is_some());
    let is_tied = matches!(free, Free::Velocity | Free::Motion);
    let tied = |x: &mut Unknowns| {
        if is_tied {
            x[5] = all.likely_log_k([x[0], x[1]]);
        }
    };
    let mut x = start;
    tied(&mut x);
    let mut damping = 1e-3;
    let mut normal = expand(all, &x, look);
    for _ in 0..steps {
        let (draw, likely) = match free {
            Free::Drawn if all.log_k.is_none() => (DRAWN * normal.cost, all.likely_log_k([x[0], x[1]])),
            _ => (0.0, 0.0),
        };
        let drawn = |cost: f64, x: &Unknowns| cost + draw * (x[5] - likely) * (x[5] - likely);
        normal.matrix[5][5] += draw;
        normal.gradient[5] += draw * (x[5] - likely);
        let before = drawn(normal.cost, &x);
        let mut better = None;
        for _ in 0..6 {
            if let Some(mut step) = solve(&normal, &places, damping) {
                step[5] = step[5].clamp(-LONGEST, LONGEST);
                let mut there: Unknowns = std::array::from_fn(|i| x[i] + step[i]);
                tied(&mut there);
                let cost = cost(all, &there, look);
                if drawn(cost, &there) < before {
                    better = Some((there, cost));
                    break;
                }
            }
            damping *= 8.0;
        }
        let Some((there, cost)) = better else { break };
        let is_settled = drawn(cost, &there) > before * (1.0 - 1e-6);
        x = there;
        damping *= 0.1;
        if is_settled {
            return (x, cost);
        }
        normal = expand(all, &x, look);
    }
    let cost = cost(all, &x, look);
    (x, cost)
}

/// Centre and velocity by linear least squares for a body that turns at one rate; none where they are not told.
pub(super) fn at_one_rate(all: &Integrals, rate: f64, look: Look) -> Option<Unknowns> {
    // with no k the constraint is linear in the centre and the velocity: one step without damping solves it
    let x = [0.0, 0.0, 0.0, 0.0, rate, f64::NEG_INFINITY];
    let step = solve(&expand(all, &x, look), &(0..4), 1e-12)?;
    Some([step[0], step[1], step[2], step[3], rate, all.likely_log_k([step[0], step[1]])])
}
