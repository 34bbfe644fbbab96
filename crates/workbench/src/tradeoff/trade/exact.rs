//! The kinds of numbers that do not round: residues modulo a prime, and rationals.

use super::combination::{Number, RankMethod};
use super::floats::nonempty;
use super::ranks::{each, exact};
use super::study::{Accuracy, Setup};
use super::truth::Exact;
use super::ways::programs;
use super::work::Work;
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, PrimeField, Rationals};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

pub(super) fn residue(work: &Work, seed: u64) -> Setup<'_, u64> {
    let field = PrimeField::random(&mut ChaCha8Rng::seed_from_u64(seed));
    build(work, Number::Residue, field, Accuracy::Modular, move |value, exact| {
        field.rational(&exact.value).is_ok_and(|truth| truth == *value)
    })
}

pub(super) fn rational(work: &Work) -> Setup<'_, RBig> {
    build(work, Number::Rational, Rationals::default(), Accuracy::Exact, |value, exact| *value == exact.value)
}

fn build<'w, A>(
    work: &'w Work,
    number: Number,
    arithmetic: A,
    accuracy: Accuracy,
    right: impl Fn(&A::Number, &Exact) -> bool + Send + Sync + 'w,
) -> Setup<'w, A::Number>
where
    A: Arithmetic + Copy + Send + Sync + 'w,
    A::Number: Send + Sync + 'w,
{
    let error = move |value: &A::Number, exact: &Exact| if right(value, exact) { 0.0 } else { f64::INFINITY };
    let mut setup = Setup::new(number, accuracy, move |value| arithmetic.rational(value).ok(), error);
    for (derivative, way) in programs(work, arithmetic) {
        setup.way(derivative, way);
    }
    let columns = work.block.columns;
    let way = each(move |block| exact(&arithmetic, block, columns));
    setup.ranks.push((RankMethod::ExactElimination, nonempty(work, way)));
    setup
}
