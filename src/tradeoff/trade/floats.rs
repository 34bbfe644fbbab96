//! The kinds of numbers that round: f32, f64, double-double, and intervals of doubles.

use super::blocks::{Blocks, timer, way};
use super::combination::{Derivative, Number, RankMethod};
use super::duals::duals;
use super::ranks::{
    Float, RankWay, Verdict, each, elimination, equilibrated, intervals, lu, qr, svd_faer, svd_nalgebra,
};
use super::study::{Accuracy, Setup};
use super::truth::Exact;
use super::ways::{differences, programs};
use super::work::Work;
use crate::number::{DoubleDouble, Floats, Interval, Real};
use crate::tradeoff::differences::Difference;
use dashu::rational::RBig;
use num_dual::DualNum;
use std::sync::Arc;

/// The distance between one and the next double-double that every operation can tell apart (its error bound).
const DOUBLE_DOUBLE_SPACING: f64 = 1.0 / (1u128 << 102) as f64;

/// The decimal digits that numbers have which lie `spacing` apart at one, rounded to nearest.
fn digits(spacing: f64) -> f64 {
    -(spacing / 2.0).log10()
}

fn middle<T: Real>(low: &RBig, high: &RBig) -> T {
    T::from_rational(&((low + high) / RBig::from(2)))
}

/// The relative error of a double, or of what a double holds.
fn error(value: f64, exact: &Exact) -> f64 {
    let error = ((value - exact.parts[0]) - exact.parts[1]).abs() / exact.scale;
    // where all of a row is zero there is nothing to measure against: right or wrong
    if value == exact.parts[0] && exact.scale == 0.0 {
        0.0
    } else if error.is_nan() {
        f64::INFINITY
    } else {
        error
    }
}

/// What every kind of number can do that stands for one real number.
fn rounded<'w, T: Real + DualNum>(
    work: &'w Work,
    number: Number,
    spacing: f64,
    error: impl Fn(&T, &Exact) -> f64 + Send + Sync + 'w,
) -> Setup<'w, Floats<T>> {
    let mut setup = Setup::new(number, Floats::new(), Accuracy::Digits(digits(spacing)), error);
    for (derivative, way) in programs(work, Floats::<T>::new()) {
        setup.way(derivative, way);
    }
    setup.way(Derivative::Duals, duals(work, middle::<T>));
    setup.way(Derivative::Forward, differences(work, Difference::Forward, spacing));
    setup.way(Derivative::Central, differences(work, Difference::Central, spacing));
    setup
}

/// A machine float with everything that the libraries offer.
fn machine<'w, F: Float + DualNum + Copy>(
    work: &'w Work,
    number: Number,
    spacing: f64,
) -> Setup<'w, Floats<F>> {
    let mut setup = rounded(work, number, spacing, |value: &F, exact| error(Real::to_f64(*value), exact));
    let columns = work.block.columns;
    setup.ranks.push((RankMethod::SvdWhole, each(|matrix| svd_nalgebra(matrix, work.columns))));
    let mut add = |method, way: fn(&[F], usize) -> Verdict| {
        setup.ranks.push((method, nonempty(work, each(move |block| way(block, columns)))));
    };
    add(RankMethod::SvdNalgebra, svd_nalgebra);
    add(RankMethod::SvdFaer, svd_faer);
    add(RankMethod::QrPivoted, qr);
    add(RankMethod::LuFullPivoting, lu);
    setup
}

/// A block without rows or columns has the rank zero, whoever is asked.
pub(super) fn nonempty<'w, N: 'w>(work: &Work, way: RankWay<'w, N>) -> RankWay<'w, N> {
    if work.block.is_empty() { each(|_| Verdict::Rank(0)) } else { way }
}

pub(super) fn single(work: &Work) -> Setup<'_, Floats<f32>> {
    machine(work, Number::Single, f64::from(f32::EPSILON))
}

pub(super) fn double(work: &Work) -> Setup<'_, Floats> {
    let mut setup = machine(work, Number::Double, f64::EPSILON);
    let blocks = Blocks::new(work).map(Arc::new);
    if let Ok(blocks) = &blocks {
        setup.timers.push((Derivative::Blocks, timer(blocks.clone())));
    }
    setup.way(Derivative::Blocks, blocks.map(way));
    let columns = work.block.columns;
    let decide = each(move |block| equilibrated(block, columns));
    setup.ranks.push((RankMethod::SvdEquilibrated, nonempty(work, decide)));
    setup
}

pub(super) fn double_double(work: &Work) -> Setup<'_, Floats<DoubleDouble>> {
    let spacing = DOUBLE_DOUBLE_SPACING;
    let error = |value: &DoubleDouble, exact: &Exact| {
        let truth = DoubleDouble::new(exact.parts[0], exact.parts[1]);
        let error = (*value - truth).to_f64() - exact.parts[2];
        match error.abs() / exact.scale {
            _ if error == 0.0 => 0.0,
            error if error.is_nan() => f64::INFINITY,
            error => error,
        }
    };
    let mut setup = rounded(work, Number::DoubleDouble, spacing, error);
    let columns = work.block.columns;
    let way = each(move |block| elimination(block, columns, spacing));
    setup.ranks.push((RankMethod::Elimination, nonempty(work, way)));
    setup
}

pub(super) fn interval(work: &Work) -> Setup<'_, Floats<Interval>> {
    // the end that is further from the truth; an interval that does not contain it is no enclosure
    let error = |value: &Interval, exact: &Exact| {
        let distance = |end: f64| (end - exact.parts[0]) - exact.parts[1];
        if distance(value.low()) > 0.0 || distance(value.high()) < 0.0 {
            return f64::INFINITY;
        }
        error(value.low(), exact).max(error(value.high(), exact))
    };
    let accuracy = Accuracy::Digits(digits(f64::EPSILON));
    let mut setup = Setup::new(Number::Interval, Floats::<Interval>::new(), accuracy, error);
    for (derivative, way) in programs(work, Floats::<Interval>::new()) {
        setup.way(derivative, way);
    }
    let enclosed = |low: &RBig, high: &RBig| Interval::from_rational(low).hull(Interval::from_rational(high));
    setup.way(Derivative::Duals, duals(work, enclosed));
    let columns = work.block.columns;
    let way = each(move |block| intervals(block, columns));
    setup.ranks.push((RankMethod::IntervalElimination, nonempty(work, way)));
    setup
}
