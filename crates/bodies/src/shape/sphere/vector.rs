//! Vectors of intervals.

use palmistry_math::number::{Function, Interval};

/// Three enclosures.
pub(super) type Enclosed = [Interval; 3];

pub(super) fn minus(a: &Enclosed, b: &Enclosed) -> Enclosed {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn cross(a: &Enclosed, b: &Enclosed) -> Enclosed {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i] * b[j] - a[j] * b[i])
}

pub(super) fn dot(a: &Enclosed, b: &Enclosed) -> Interval {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Squares are not negative, and so is their sum.
pub(super) fn length(a: &Enclosed) -> Interval {
    (a[0].sqr() + a[1].sqr() + a[2].sqr()).image(Function::Sqrt).unwrap_or(Interval::new(0.0, f64::INFINITY))
}
