//! The kinds of numbers that round: f32, f64, double-double, and intervals of doubles.

use super::blocks::{Blocks, bounded_timer, bounded_way, timer, way};
use super::combination::{Derivative, Number, RankMethod};
use super::duals::duals;
use super::lanes::{certain, jacobi};
use super::ranks::{
    Float, RankVerdict, RankWay, each, elimination, equilibrated, intervals, lu, qr, svd_faer, svd_nalgebra,
};
use super::study::{Accuracy, Setup};
use super::truth::Exact;
use super::ways::{differences, programs};
use super::work::Work;
use crate::tradeoff::differences::FiniteDifference;
use dashu::rational::RBig;
use num_dual::DualNum;
use palmistry_math::number::{Bounded, DoubleDouble, Floats, Interval, RealNumber, rational_from_f64};
use std::sync::Arc;

/// The distance between one and the next double-double that every operation can distinguish (its error bound).
const DOUBLE_DOUBLE_SPACING: f64 = 1.0 / (1u128 << 102) as f64;

/// The decimal digits of numbers with the given spacing at one, rounded to nearest.
fn digits(spacing: f64) -> f64 {
    -(spacing / 2.0).log10()
}

fn middle<T: RealNumber>(low: &RBig, high: &RBig) -> T {
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

/// The relative error of the end of an enclosure that is further from the truth; what does not contain it encloses
/// nothing.
fn enclosed(low: f64, high: f64, exact: &Exact) -> f64 {
    let distance = |end: f64| (end - exact.parts[0]) - exact.parts[1];
    if distance(low) > 0.0 || distance(high) < 0.0 {
        return f64::INFINITY;
    }
    error(low, exact).max(error(high, exact))
}

/// What every kind of number can do that stands for one real number.
fn rounded<'w, T: RealNumber + DualNum>(
    work: &'w Work,
    number: Number,
    spacing: f64,
    error: impl Fn(&T, &Exact) -> f64 + Send + Sync + 'w,
) -> Setup<'w, T> {
    let mut setup =
        Setup::new(number, Accuracy::Digits(digits(spacing)), |value| Some(T::from_rational(value)), error);
    for (derivative, way) in programs(work, Floats::<T>::new()) {
        setup.way(derivative, way);
    }
    setup.way(Derivative::Duals, duals(work, middle::<T>));
    setup.way(Derivative::Forward, differences(work, FiniteDifference::Forward, spacing));
    setup.way(Derivative::Central, differences(work, FiniteDifference::Central, spacing));
    setup
}

/// A machine float with everything that the libraries offer.
fn machine<'w, F: Float + DualNum + Copy>(work: &'w Work, number: Number, spacing: f64) -> Setup<'w, F> {
    let mut setup =
        rounded(work, number, spacing, |value: &F, exact| error(RealNumber::to_f64(*value), exact));
    let columns = work.block.columns;
    setup.ranks.push((RankMethod::SvdWhole, each(|matrix| svd_nalgebra(matrix, work.columns))));
    let mut add = |method, way: fn(&[F], usize) -> RankVerdict| {
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
    if work.block.is_empty() { each(|_| RankVerdict::Rank(0)) } else { way }
}

pub(super) fn single(work: &Work) -> Setup<'_, f32> {
    machine(work, Number::Single, f64::from(f32::EPSILON))
}

pub(super) fn double(work: &Work) -> Setup<'_, f64> {
    let mut setup = machine(work, Number::Double, f64::EPSILON);
    let blocks = Blocks::new(work).map(Arc::new);
    if let Ok(blocks) = &blocks {
        setup.timers.push((Derivative::Blocks, timer(blocks.clone())));
    }
    setup.way(Derivative::Blocks, blocks.map(way));
    let columns = work.block.columns;
    let decide = each(move |block| equilibrated(block, columns));
    setup.ranks.push((RankMethod::SvdEquilibrated, nonempty(work, decide)));
    setup.ranks.push((RankMethod::Jacobi, nonempty(work, jacobi(&work.block))));
    setup
}

/// Doubles with bounds on their errors.
pub(super) fn bounded(work: &Work) -> Setup<'_, Bounded<f64>> {
    let error = |value: &Bounded<f64>, exact: &Exact| {
        let (low, high) = (value.value - value.error(), value.value + value.error());
        enclosed(low.next_down(), high.next_up(), exact)
    };
    let constant = |value: &RBig| {
        let image = f64::from_rational(value);
        let units = if rational_from_f64(image).as_ref() == Some(value) { 0.0 } else { image.abs() };
        image.is_finite().then_some(Bounded { value: image, units })
    };
    let mut setup = Setup::new(Number::Bounded, Accuracy::Digits(digits(f64::EPSILON)), constant, error);
    let blocks = Blocks::new(work).map(Arc::new);
    if let Ok(blocks) = &blocks {
        setup.timers.push((Derivative::Blocks, bounded_timer(blocks.clone())));
    }
    setup.way(Derivative::Blocks, blocks.map(bounded_way));
    setup.ranks.push((RankMethod::BoundedElimination, nonempty(work, certain(&work.block))));
    setup
}

pub(super) fn double_double(work: &Work) -> Setup<'_, DoubleDouble> {
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

pub(super) fn interval(work: &Work) -> Setup<'_, Interval> {
    let error = |value: &Interval, exact: &Exact| enclosed(value.low(), value.high(), exact);
    let accuracy = Accuracy::Digits(digits(f64::EPSILON));
    let mut setup =
        Setup::new(Number::Interval, accuracy, |value| Some(Interval::from_rational(value)), error);
    for (derivative, way) in programs(work, Floats::<Interval>::new()) {
        setup.way(derivative, way);
    }
    let hull = |low: &RBig, high: &RBig| Interval::from_rational(low).hull(Interval::from_rational(high));
    setup.way(Derivative::Duals, duals(work, hull));
    let columns = work.block.columns;
    let way = each(move |block| intervals(block, columns));
    setup.ranks.push((RankMethod::IntervalElimination, nonempty(work, way)));
    setup
}
