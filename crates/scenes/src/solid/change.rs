//! Changes of the initial state and parameters of a motion, and the normal equations for them.

use super::UNKNOWNS;
use super::flow::{DIRECTIONS, INVERSE, MOMENTUM, MU, Start};
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
    pub fn around(&self, x: &Matrix) -> [f64; 6] {
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

    /// The chain rule from derivatives in all directions to those by changes.
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

    /// The least-squares step, the diagonal enlarged by a fraction of itself.
    pub fn step(&self, damping: f64) -> Option<Change> {
        let mut matrix = self.matrix;
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] *= 1.0 + damping;
        }
        solved(&matrix, UNKNOWNS, &self.gradient.map(|value| -value))
    }
}

/// The largest step: in units of a length, of a length times a rate, of a rate, and relative.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    pub length: f64,
    pub rate: f64,
}

impl Scale {
    /// Of one of the unknowns.
    pub fn of(&self, place: usize) -> f64 {
        match place {
            0..3 => self.length,
            3..6 => self.length * self.rate,
            6..9 => self.rate,
            _ => 1.0,
        }
    }
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
