use super::SolutionsQuestion;
use super::basis::{Basis, Limits, Row, Stop};
use super::model::Model;
use super::monomials::Monomials;
use super::quotient::{Algebra, NoAlgebra, distinct_roots};
use super::round::{Course, WAYS, round};
use crate::observability::generic::Probe;
use palmistry_math::number::PrimeField;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cell::Cell;
use std::sync::atomic::AtomicBool;

/// The least prime above 2^61.
const PRIME: u64 = (1 << 61) + 15;

/// Polynomials in so many variables: powers and coefficient of each term.
type Terms<'a> = &'a [(&'a [(usize, u16)], i64)];

fn algebra(variables: usize, polynomials: &[Terms]) -> Result<Algebra, NoAlgebra> {
    let field = PrimeField::new(PRIME);
    let mut monomials = Monomials::new(vec![1; variables]);
    let mut rows = Vec::new();
    for polynomial in polynomials {
        let mut terms: Vec<(u32, u64)> = polynomial
            .iter()
            .map(|(powers, coefficient)| (monomials.of(powers), field.integer(&(*coefficient).into())))
            .collect();
        terms.sort_by(|a, b| monomials.compare(b.0, a.0));
        let (monomials, coefficients) = terms.into_iter().unzip();
        rows.push(Row { monomials, coefficients });
    }
    let work = Cell::new(0);
    let limits = Limits { columns: 10_000, entries: 1_000_000, degree: 50, work: &work, is_over: &|| false };
    Algebra::new(Basis::of(field, monomials, rows, &limits).unwrap(), 200)
}

fn values(algebra: &mut Algebra, powers: &[(usize, u16)]) -> usize {
    let field = PrimeField::new(PRIME);
    distinct_roots(&field, &algebra.minimal_polynomial(&[(powers.to_vec(), field.one())]))
}

/// The elementary symmetric functions of three numbers leave their six orders: cyclic roots for n = 3.
#[test]
fn symmetric_functions_leave_six_points() {
    let sum: Terms = &[(&[(0, 1)], 1), (&[(1, 1)], 1), (&[(2, 1)], 1), (&[], -6)];
    let pairs: Terms = &[(&[(0, 1), (1, 1)], 1), (&[(1, 1), (2, 1)], 1), (&[(0, 1), (2, 1)], 1), (&[], -11)];
    let product: Terms = &[(&[(0, 1), (1, 1), (2, 1)], 1), (&[], -6)];
    let mut found = algebra(3, &[sum, pairs, product]).unwrap();
    assert_eq!(found.dimension(), 6);
    assert_eq!(values(&mut found, &[(0, 1)]), 3);
    // of 1, 2 and 3 the products of two are 2, 3 and 6
    assert_eq!(values(&mut found, &[(0, 1), (2, 1)]), 3);
    assert_eq!(values(&mut found, &[(0, 1), (1, 1), (2, 1)]), 1);
    // x^2 y has the values 2, 3, 4, 12, 9, 18
    assert_eq!(values(&mut found, &[(0, 2), (1, 1)]), 6);
}

/// A double point counts twice as a point and once as a value.
#[test]
fn a_double_point_has_one_value() {
    let square: Terms = &[(&[(0, 2)], 1), (&[(0, 1)], -2), (&[], 1)];
    let line: Terms = &[(&[(1, 1)], 1), (&[(0, 1)], -1)];
    let mut found = algebra(2, &[square, line]).unwrap();
    assert_eq!((found.dimension(), values(&mut found, &[(1, 1)])), (2, 1));
}

/// A curve has infinitely many points; what contradicts itself has none.
#[test]
fn curves_and_contradictions() {
    let curve: Terms = &[(&[(0, 1), (1, 1)], 1), (&[], -1)];
    assert_eq!(algebra(2, &[curve]).err(), Some(NoAlgebra::Infinite));
    let other: Terms = &[(&[(0, 1), (1, 1)], 1), (&[], -2)];
    assert_eq!(algebra(2, &[curve, other]).map(|found| found.dimension()).ok(), Some(0));
}

/// What is counted does not depend on how many derivatives were taken, on what was solved before or on the order of monomials.
#[test]
fn every_way_counts_the_same_values() {
    let rows = [
        ("state x param k, a unknown drift f x' = -k^2*x + a output x^2", vec![2, 2, 2]),
        (
            "state x, s param v, k unknown drift f x' = -v*x/(k + x) s' = v*x/(k + x) - s output s",
            vec![1, 1, 1, 1],
        ),
        // either exchanges the two compartments that are not measured
        (
            "state x, y, z param a, b, c, d unknown drift f x' = -(a + b)*x + c*y + d*z y' = a*x - c*y \
             z' = b*x - d*z input u x' = 1 others' = 0 output x",
            vec![1, 2, 2, 2, 2, 2, 2],
        ),
        // a pendulum whose sine is measured: the angle or its supplement
        ("state q, w angle q param g unknown drift f q' = w w' = -g*sin(q) output sin(q)", vec![2, 2, 2]),
    ];
    for (text, expected) in rows {
        let system: palmistry_lang::System = format!("system \"s\" {text}").parse().unwrap();
        let model = Model::new(&system, &Default::default(), &[]).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let orders = Probe::new(&system, &Default::default()).orders(&mut rng).unwrap();
        let interrupt = AtomicBool::new(false);
        let question = SolutionsQuestion {
            conditions: Default::default(),
            expressions: Vec::new(),
            work: 1_000_000_000,
            interrupt: &interrupt,
        };
        for way in WAYS {
            let course = Course { work: Cell::new(0), way: Cell::new(Some(way)) };
            let round = round(&model, &orders, &question, &course, &mut rng).unwrap();
            assert_eq!(round.values, expected, "{text} {way:?}");
        }
    }
}

/// The table against powers that are compared one by one, in more variables than a mask has bits and with more monomials than it begins with.
#[test]
fn the_table_of_monomials_is_one_of_powers() {
    for variables in [1, 9, 70] {
        let mut rng = ChaCha8Rng::seed_from_u64(variables as u64);
        let mut table = Monomials::new(vec![1; variables]);
        let mut draw = || -> Vec<u16> { (0..variables).map(|_| rng.random_range(0..4)).collect() };
        let number = |table: &mut Monomials, powers: &[u16]| {
            table.of(&powers.iter().copied().enumerate().collect::<Vec<_>>())
        };
        let combined = |a: &[u16], b: &[u16], by: fn(u16, u16) -> u16| -> Vec<u16> {
            a.iter().zip(b).map(|(a, b)| by(*a, *b)).collect()
        };
        for _ in 0..2000 {
            let (left, right) = (draw(), draw());
            let (a, b) = (number(&mut table, &left), number(&mut table, &right));
            assert_eq!((table.powers(a), table.powers(b)), (left.as_slice(), right.as_slice()));
            let product = table.product(a, b);
            assert_eq!(product, number(&mut table, &combined(&left, &right, |a, b| a + b)));
            assert_eq!(table.quotient(product, a), b);
            let lcm = table.lcm(a, b);
            assert_eq!(lcm, number(&mut table, &combined(&left, &right, u16::max)));
            assert!(table.is_lcm(a, b, lcm) && (lcm == product || !table.is_lcm(a, b, product)));
            assert_eq!(table.divides(a, b), left.iter().zip(&right).all(|(a, b)| a <= b));
            assert!(table.divides(a, lcm) && table.divides(b, lcm) && table.divides(0, a));
            assert_eq!(table.are_coprime(a, b), lcm == product);
        }
        assert!(table.len() < 4 * 2000 + 2);
    }
}

/// Each limit ends a basis with its own error.
#[test]
fn limits_are_named() {
    let field = PrimeField::new(PRIME);
    let ends = |columns, entries, degree| {
        let mut monomials = Monomials::new(vec![1; 2]);
        let one = field.one();
        let mut row = |a: &[(usize, u16)], b: &[(usize, u16)]| Row {
            monomials: vec![monomials.of(a), monomials.of(b)],
            coefficients: vec![one, one],
        };
        let rows = vec![row(&[(0, 2)], &[(1, 1)]), row(&[(0, 1), (1, 1)], &[])];
        let work = Cell::new(0);
        let limits = Limits { columns, entries, degree, work: &work, is_over: &|| false };
        Basis::of(field, monomials, rows, &limits).err()
    };
    assert_eq!(ends(100, 100, 50), None);
    assert!(matches!(ends(1, 100, 50), Some(Stop::TooWide(_))));
    assert!(matches!(ends(100, 1, 50), Some(Stop::TooFull(_))));
    assert!(matches!(ends(100, 100, 1), Some(Stop::DegreeTooHigh(2))));
}
