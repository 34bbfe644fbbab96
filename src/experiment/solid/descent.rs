//! Steps that make the residuals smaller, before errors are carried: each constraint over its own change by its contact.

use super::UNKNOWNS;
use super::constraint::{Constrained, expanded, values};
use super::flow::{DIRECTIONS, INVERSE, MOMENTUM, MU, Start};
use super::integrals::Integrals;
use super::linear::{backward, cholesky, forward, solved};
use super::vector::{Matrix, PLACES, Vector, along, dot, symmetric, times};

/// Changes of centre, velocity, rate; of the inverse `K = C C^T` by `C X C^T`, six; and of the logarithm of one over mass.
pub(super) type Change = [f64; UNKNOWNS];

/// A symmetric positive matrix, its triangle and its inverse.
pub(super) struct Positive {
    pub triangle: Matrix,
    pub inverse: Matrix,
}

impl Positive {
    pub fn of(entries: &[f64; 6]) -> Option<Positive> {
        let triangle = cholesky(&symmetric(entries), 3)?;
        let column = |i: usize| {
            let mut unit = [0.0; 3];
            unit[i] = 1.0;
            backward(&triangle, 3, &forward(&triangle, 3, &unit))
        };
        Some(Positive { triangle, inverse: [column(0), column(1), column(2)] })
    }

    /// `C X C^T`.
    fn around(&self, x: &Matrix) -> [f64; 6] {
        let c = &self.triangle;
        PLACES.map(|(i, j)| {
            let mut sum = 0.0;
            for k in 0..3 {
                for m in 0..3 {
                    sum += c[i][k] * x[k][m] * c[j][m];
                }
            }
            sum
        })
    }
}

impl Start {
    /// A start whose momentum follows from the rate; none where the inverse is not positive.
    pub fn new(centre: Vector, velocity: Vector, rate: Vector, inverse: [f64; 6], mu: f64) -> Option<Start> {
        let momentum = times(&Positive::of(&inverse)?.inverse, &rate);
        Some(Start { centre, velocity, rate, inverse, momentum, mu })
    }

    /// The start after a change. `1 + X + X^2/2` takes the place of the exponential: it is positive for every `X`.
    pub fn changed(&self, by: &Change) -> Option<Start> {
        let part = |from: usize| -> Vector { [by[from], by[from + 1], by[from + 2]] };
        let x = symmetric(&std::array::from_fn(|i| by[9 + i]));
        let mut grown = x;
        for i in 0..3 {
            grown[i][i] += 1.0;
            for j in 0..3 {
                grown[i][j] += dot(&x[i], &x[j]) / 2.0;
            }
        }
        let inverse = Positive::of(&self.inverse)?.around(&grown);
        Start::new(
            along(&self.centre, 1.0, &part(0)),
            along(&self.velocity, 1.0, &part(3)),
            along(&self.rate, 1.0, &part(6)),
            inverse,
            self.mu * by[15].clamp(-2.0, 2.0).exp(),
        )
    }

    /// What takes derivatives in all directions to those by changes.
    pub fn chain(&self) -> Option<Chain> {
        let k = Positive::of(&self.inverse)?;
        let changes = std::array::from_fn(|a| {
            let mut unit = [0.0; 6];
            unit[a] = 1.0;
            let dk = k.around(&symmetric(&unit));
            let moved = times(&k.inverse, &times(&symmetric(&dk), &self.momentum));
            (dk, moved)
        });
        Some(Chain { inertia: k.inverse, changes, mu: self.mu })
    }
}

/// Derivatives by changes.
pub(super) struct Chain {
    inertia: Matrix,
    changes: [([f64; 6], Vector); 6],
    mu: f64,
}

impl Chain {
    pub fn row(&self, by: &[f64; DIRECTIONS]) -> Change {
        let spin: Vector = [by[MOMENTUM], by[MOMENTUM + 1], by[MOMENTUM + 2]];
        let rate = times(&self.inertia, &spin);
        std::array::from_fn(|i| match i {
            0..6 => by[i],
            6..9 => rate[i - 6],
            9..15 => {
                let (dk, moved) = &self.changes[i - 9];
                let own: f64 = dk.iter().zip(&by[INVERSE..]).map(|(a, b)| a * b).sum();
                own - dot(&spin, moved)
            }
            _ => self.mu * by[MU],
        })
    }
}

/// Which unknowns are free.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Free {
    /// Centre, velocity, rate.
    Motion,
    /// These and the mass.
    Mass,
    /// All.
    All,
}

impl Free {
    fn places(self) -> Vec<usize> {
        match self {
            Free::Motion => (0..9).collect(),
            Free::Mass => (0..9).chain([15]).collect(),
            Free::All => (0..UNKNOWNS).collect(),
        }
    }
}

/// Normal equations.
#[derive(Clone)]
pub(super) struct Normal {
    pub cost: f64,
    pub matrix: [[f64; UNKNOWNS]; UNKNOWNS],
    pub gradient: Change,
}

impl Normal {
    pub fn none() -> Normal {
        Normal { cost: 0.0, matrix: [[0.0; UNKNOWNS]; UNKNOWNS], gradient: [0.0; UNKNOWNS] }
    }

    pub fn add(&mut self, residual: f64, row: &Change) {
        self.cost += residual * residual;
        for i in 0..UNKNOWNS {
            self.gradient[i] += row[i] * residual;
            for j in 0..=i {
                self.matrix[i][j] += row[i] * row[j];
            }
        }
    }

    /// The step of least squares in some unknowns, the diagonal made larger by a part of itself.
    pub fn step(&self, places: &[usize], damping: f64) -> Option<Change> {
        let mut matrix = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut right = [0.0; UNKNOWNS];
        for (i, from) in places.iter().enumerate() {
            for (j, to) in places.iter().enumerate().take(i + 1) {
                matrix[i][j] = self.matrix[*from][*to];
            }
            matrix[i][i] *= 1.0 + damping;
            right[i] = -self.gradient[*from];
        }
        let found = solved(&matrix, places.len(), &right)?;
        let mut step = [0.0; UNKNOWNS];
        for (value, place) in found.iter().zip(places) {
            step[*place] = *value;
        }
        Some(step)
    }
}

/// What is left of contacts, in m^2: each constraint over its change by its contact, of which rates below `softened` count as this one.
pub(super) fn cost(all: &Integrals, start: &Start, softened: f64) -> f64 {
    let mut sum = 0.0;
    for (value, slopes) in values(start, all) {
        for i in 0..3 {
            let [p, q] = slopes[i];
            sum += value[i] * value[i] / (p * p + q * q + softened * softened);
        }
    }
    sum
}

pub(super) fn expand(all: &Integrals, start: &Start, softened: f64) -> Option<Normal> {
    let chain = start.chain()?;
    let mut normal = Normal::none();
    for sample in expanded(start, all) {
        for i in 0..3 {
            let (residual, row) = weighed(&sample, i, softened);
            normal.add(residual, &chain.row(&row));
        }
    }
    Some(normal)
}

fn weighed(sample: &Constrained, i: usize, softened: f64) -> (f64, [f64; DIRECTIONS]) {
    let [p, q] = sample.slopes[i];
    let size = p * p + q * q + softened * softened;
    let root = size.sqrt();
    let residual = sample.value[i] / root;
    let row = std::array::from_fn(|d| {
        let [dp, dq] = sample.slopes_by[i][d];
        sample.by[i][d] / root - residual * (p * dp + q * dq) / size
    });
    (residual, row)
}

/// The longest step: in parts of a length, of a length in a second, of a rate, and relatively.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    pub length: f64,
    pub rate: f64,
}

pub(super) fn shortened(step: &Change, scale: &Scale) -> Change {
    let most = |i: usize| match i {
        0..3 => scale.length,
        3..6 => scale.length * scale.rate,
        6..9 => scale.rate,
        _ => 0.7,
    };
    let longest = (0..UNKNOWNS).map(|i| step[i].abs() / most(i)).fold(1.0, f64::max);
    step.map(|value| value / longest)
}

/// Levenberg and Marquardt's method from a start; the start and the sum of the squares that it ends with.
pub(super) fn descend(
    all: &Integrals,
    from: Start,
    free: Free,
    scale: &Scale,
    softened: f64,
    steps: usize,
) -> (Start, f64) {
    let places = free.places();
    let mut here = from;
    let Some(mut normal) = expand(all, &here, softened) else { return (here, f64::INFINITY) };
    let mut damping = 1e-3;
    for _ in 0..steps {
        let mut better = None;
        for _ in 0..7 {
            if let Some(there) =
                normal.step(&places, damping).and_then(|step| here.changed(&shortened(&step, scale)))
            {
                let reached = cost(all, &there, softened);
                if reached < normal.cost {
                    better = Some((there, reached));
                    break;
                }
            }
            damping = (damping * 8.0).max(1e-6);
        }
        let Some((there, reached)) = better else { break };
        let is_settled = reached > normal.cost * (1.0 - 1e-5);
        here = there;
        damping *= 0.1;
        if is_settled {
            return (here, reached);
        }
        match expand(all, &here, softened) {
            Some(next) => normal = next,
            None => break,
        }
    }
    (here, normal.cost)
}
