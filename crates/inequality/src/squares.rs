//! Polynomials that are nowhere negative because they are sums of squares, or such sums times what is assumed.
//!
//! `p = v' G v + sum_i g_i v_i' G_i v_i` with matrices `G` that are positive semidefinite, monomials `v`, and polynomials
//! `g_i` that are assumed to be not negative. Doubles guess the matrices; then they are rational numbers for which the
//! identity holds exactly, by construction, and elimination in exact numbers shows that they are semidefinite. The whole
//! is multiplied out again before it is believed. (Peyrl and Parrilo, Computing sum of squares decompositions with
//! rational coefficients, Theoretical Computer Science 409, 2008.)

use super::semidefinite::{Block, centre};
use super::space::Space;
use dashu::integer::IBig;
use dashu::rational::RBig;
use nalgebra::DMatrix;
use palmistry_math::number::polynomial::{Exponents, LARGEST_ARITY, Polynomial, Ring};
use palmistry_math::number::rational_from_f64;
use std::collections::{BTreeMap, BTreeSet};

/// Bases of more monomials are not tried.
const LONGEST_BASIS: usize = 28;
/// More unknowns are not looked for.
const MOST_UNKNOWNS: usize = 160;
/// Of so many assumptions products of two are used as well.
const PAIRED: usize = 3;

/// The sign of a polynomial that a sum of squares proves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProvedSign {
    NotNegative,
    Positive,
}

/// A polynomial with rational coefficients.
type Rational = BTreeMap<Exponents, RBig>;

/// A square matrix of products of monomials with a multiplier, to be filled in.
struct Part {
    multiplier: Polynomial,
    /// Whether the multiplier is known to be different from zero.
    strict: bool,
    /// The constant, where it is one of them, comes last.
    monomials: Vec<Exponents>,
    /// The place of the first of its entries among the unknowns; entries `(i, j)` with `i <= j` follow by rows.
    first: usize,
}

impl Part {
    fn entries(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let n = self.monomials.len();
        (0..n).flat_map(move |i| (i..n).map(move |j| (i, j)))
    }
}

/// Whether a polynomial is nowhere negative where the polynomials in `assumed` are not (`true`: are positive), by a sum of
/// squares, and any multiples of `equations`, which vanish; `normal` brings polynomials to their normal form.
pub fn bounded_below(
    polynomial: &Polynomial,
    assumed: &[(Polynomial, bool)],
    equations: &[Polynomial],
    normal: &dyn Fn(Polynomial) -> Polynomial,
) -> Option<ProvedSign> {
    let known = assumed.iter().map(|(g, _)| g).chain(equations);
    let degree = known.map(Polynomial::degree).fold(polynomial.degree(), u32::max);
    if polynomial.degree() > 12 {
        return None;
    }
    let mut last = None;
    for raised in [degree.next_multiple_of(2), degree.next_multiple_of(2) + 2] {
        if assumed.is_empty() && equations.is_empty() && raised > polynomial.degree().next_multiple_of(2) {
            break;
        }
        match at_degree(polynomial, assumed, equations, normal, raised) {
            Some(ProvedSign::Positive) => return Some(ProvedSign::Positive),
            found => last = last.or(found),
        }
    }
    last
}

fn at_degree(
    polynomial: &Polynomial,
    assumed: &[(Polynomial, bool)],
    equations: &[Polynomial],
    normal: &dyn Fn(Polynomial) -> Polynomial,
    degree: u32,
) -> Option<ProvedSign> {
    let mut parts = parts(polynomial, assumed, equations, normal, degree)?;
    let mut unknowns = 0;
    for part in &mut parts {
        part.first = unknowns;
        unknowns += part.entries().count();
    }
    if unknowns > MOST_UNKNOWNS {
        return None;
    }
    // what each unknown contributes
    let mut products: Vec<Polynomial> = Vec::new();
    for part in &parts {
        for (i, j) in part.entries() {
            let monomial = product(&part.monomials[i], &part.monomials[j])?;
            let times = if i == j { IBig::ONE } else { IBig::from(2) };
            products.push(normal(part.multiplier.mul(&Polynomial::term(monomial, times))?));
        }
    }
    // multiples of what vanishes have any sign
    let met = variables(polynomial, assumed, equations);
    for equation in equations {
        let Some(rest) = degree.checked_sub(equation.degree()) else { continue };
        for monomial in monomials_up_to(&met, rest, normal) {
            products.push(normal(equation.mul(&Polynomial::term(monomial, IBig::ONE))?));
        }
    }
    if products.len() > 2 * MOST_UNKNOWNS {
        return None;
    }
    let space = Space::new(polynomial, &products)?;
    let (start, directions) = space.as_doubles();
    let blocks: Vec<Block> = parts.iter().map(|part| block(part, &start, &directions)).collect();
    let found = centre(&blocks, space.free.len())?;
    let scale = start.iter().fold(1.0, |a: f64, b| a.max(b.abs()));
    if found.least < -1e-5 * scale {
        return None;
    }
    for rounding in Rounding::ALL {
        let free: Option<Vec<RBig>> = found.unknowns.iter().map(|value| rounding.of(*value)).collect();
        let filled = space.fill(&free?);
        if let Some(strict) = are_semidefinite(&parts, &filled)
            && is_the_sum(polynomial, &products, &filled)
        {
            return Some(if strict { ProvedSign::Positive } else { ProvedSign::NotNegative });
        }
    }
    None
}

fn product(a: &Exponents, b: &Exponents) -> Option<Exponents> {
    let mut found = *a;
    for (x, y) in found.iter_mut().zip(b) {
        *x = x.checked_add(*y)?;
    }
    Some(found)
}

fn quotient(a: &Exponents, b: &Exponents) -> Option<Exponents> {
    let mut found = *a;
    for (x, y) in found.iter_mut().zip(b) {
        *x = x.checked_sub(*y)?;
    }
    Some(found)
}

fn total(exponents: &Exponents) -> u32 {
    exponents.iter().map(|e| u32::from(*e)).sum()
}

/// The matrices that are tried: one for the squares, one for each assumption, and for pairs of them where they are few.
fn parts(
    polynomial: &Polynomial,
    assumed: &[(Polynomial, bool)],
    equations: &[Polynomial],
    normal: &dyn Fn(Polynomial) -> Polynomial,
    degree: u32,
) -> Option<Vec<Part>> {
    let mut multipliers = vec![(Polynomial::integer(&IBig::ONE), true)];
    multipliers.extend(assumed.iter().cloned());
    if assumed.len() <= PAIRED {
        for (i, (a, strict)) in assumed.iter().enumerate() {
            for (b, also) in &assumed[i + 1..] {
                multipliers.push((a.mul(b)?, *strict && *also));
            }
        }
    }
    let met = variables(polynomial, assumed, equations);
    let mut found = Vec::new();
    for (multiplier, strict) in multipliers {
        let Some(rest) = degree.checked_sub(multiplier.degree()) else { continue };
        let mut monomials = monomials_up_to(&met, rest / 2, normal);
        if found.is_empty() && assumed.is_empty() && equations.is_empty() {
            prune(&mut monomials, polynomial, normal);
        }
        if monomials.len() > LONGEST_BASIS {
            if found.is_empty() {
                return None;
            }
            monomials = monomials_up_to(&met, 0, normal);
        }
        // by falling degree, the constant last
        monomials.sort_by_key(|m| (std::cmp::Reverse(total(m)), std::cmp::Reverse(*m)));
        found.push(Part { multiplier, strict, monomials, first: 0 });
    }
    Some(found)
}

/// The highest power of each variable.
fn variables(
    polynomial: &Polynomial,
    assumed: &[(Polynomial, bool)],
    equations: &[Polynomial],
) -> [u8; LARGEST_ARITY] {
    let mut met = [0u8; LARGEST_ARITY];
    let all = [polynomial].into_iter().chain(assumed.iter().map(|(g, _)| g)).chain(equations);
    for (exponents, _) in all.flat_map(Polynomial::terms) {
        for (most, exponent) in met.iter_mut().zip(exponents) {
            *most = (*most).max(*exponent);
        }
    }
    met
}

/// Monomials in normal form in the variables that are met, up to a degree.
fn monomials_up_to(
    met: &[u8; LARGEST_ARITY],
    degree: u32,
    normal: &dyn Fn(Polynomial) -> Polynomial,
) -> Vec<Exponents> {
    let mut found: BTreeSet<Exponents> = BTreeSet::from([Exponents::default()]);
    for _ in 0..degree {
        for known in found.clone() {
            for variable in (0..LARGEST_ARITY).filter(|v| met[*v] > 0) {
                let mut next = known;
                next[variable] += 1;
                found.insert(next);
            }
        }
        if found.len() > 40 * LONGEST_BASIS {
            break;
        }
    }
    let is_normal = |m: &Exponents| {
        let term = Polynomial::term(*m, IBig::ONE);
        normal(term.clone()) == term
    };
    found.into_iter().filter(is_normal).collect()
}

/// Leaves out monomials whose square can stand in no sum of squares that is this polynomial: nothing would cancel it.
fn prune(monomials: &mut Vec<Exponents>, polynomial: &Polynomial, normal: &dyn Fn(Polynomial) -> Polynomial) {
    let known: BTreeSet<Exponents> = polynomial.terms().map(|(e, _)| *e).collect();
    loop {
        let all: BTreeSet<Exponents> = monomials.iter().copied().collect();
        // the square of a monomial is the product of two others
        let cancels = |m: &Exponents, square: &Exponents| {
            let other = |a: &Exponents| quotient(square, a).is_some_and(|b| all.contains(&b));
            known.contains(square) || all.iter().any(|a| a != m && other(a))
        };
        let before = monomials.len();
        monomials.retain(|m| {
            let Some(square) = product(m, m) else { return false };
            // with relations a square is several monomials, and may be cancelled elsewhere
            let term = Polynomial::term(square, IBig::ONE);
            normal(term.clone()) != term || cancels(m, &square)
        });
        if monomials.len() == before {
            return;
        }
    }
}

fn block(part: &Part, start: &[f64], directions: &[Vec<(usize, f64)>]) -> Block {
    let n = part.monomials.len();
    let places: Vec<(usize, usize)> = part.entries().collect();
    let mut matrix = DMatrix::zeros(n, n);
    for (k, (i, j)) in places.iter().enumerate() {
        matrix[(*i, *j)] = start[part.first + k];
        matrix[(*j, *i)] = start[part.first + k];
    }
    let own = |place: usize| place.checked_sub(part.first).and_then(|k| places.get(k)).copied();
    let one = |direction: &Vec<(usize, f64)>| {
        let mut entries = Vec::new();
        for (place, value) in direction {
            if let Some((i, j)) = own(*place) {
                entries.push((i, j, *value));
                if i != j {
                    entries.push((j, i, *value));
                }
            }
        }
        entries
    };
    Block { start: matrix, directions: directions.iter().map(one).collect() }
}

/// How a double becomes a rational number: first simple ones, since what is optimal is often simple.
#[derive(Clone, Copy)]
enum Rounding {
    Simple(f64),
    Binary(i32),
}

impl Rounding {
    const ALL: [Rounding; 6] = [
        Rounding::Simple(1e-2),
        Rounding::Simple(1e-4),
        Rounding::Simple(1e-6),
        Rounding::Binary(8),
        Rounding::Binary(16),
        Rounding::Binary(30),
    ];

    fn of(self, value: f64) -> Option<RBig> {
        match self {
            Rounding::Binary(bits) => {
                let scale = f64::from(bits).exp2();
                rational_from_f64((value * scale).round() / scale)
            }
            Rounding::Simple(radius) => {
                let radius = radius * value.abs().max(1.0);
                let (low, high) = (rational_from_f64(value - radius)?, rational_from_f64(value + radius)?);
                if low <= RBig::ZERO && high >= RBig::ZERO {
                    return Some(RBig::ZERO);
                }
                Some(RBig::simplest_in(low, high))
            }
        }
    }
}

/// Whether all matrices are positive semidefinite, and if so whether the sum is positive: the square of a constant is
/// part of it.
fn are_semidefinite(parts: &[Part], entries: &[RBig]) -> Option<bool> {
    let mut strict = false;
    for part in parts {
        let n = part.monomials.len();
        let mut matrix = vec![vec![RBig::ZERO; n]; n];
        for (k, (i, j)) in part.entries().enumerate() {
            matrix[i][j] = entries[part.first + k].clone();
            matrix[j][i] = entries[part.first + k].clone();
        }
        let definite = definiteness(matrix);
        if definite == Definiteness::Indefinite {
            return None;
        }
        let ends_in_one = part.monomials.last().is_some_and(|m| total(m) == 0);
        strict |= ends_in_one && part.strict && definite == Definiteness::PositiveAtTheEnd;
    }
    Some(strict)
}

/// The definiteness of a symmetric matrix, by exact elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Definiteness {
    /// It is not positive semidefinite.
    Indefinite,
    /// It is, and its last pivot is zero or it has none.
    Semidefinite,
    /// It is, and its last pivot is positive.
    PositiveAtTheEnd,
}

fn definiteness(mut matrix: Vec<Vec<RBig>>) -> Definiteness {
    let n = matrix.len();
    let mut found = Definiteness::Semidefinite;
    for k in 0..n {
        let pivot = matrix[k][k].clone();
        if pivot < RBig::ZERO || pivot.is_zero() && (k..n).any(|j| !matrix[k][j].is_zero()) {
            return Definiteness::Indefinite;
        }
        if pivot.is_zero() {
            found = Definiteness::Semidefinite;
            continue;
        }
        found = Definiteness::PositiveAtTheEnd;
        let row = matrix[k].clone();
        for i in k + 1..n {
            let factor = &row[i] / &pivot;
            if factor.is_zero() {
                continue;
            }
            for j in i..n {
                let value = &matrix[i][j] - &factor * &row[j];
                matrix[j][i] = value.clone();
                matrix[i][j] = value;
            }
        }
    }
    found
}

/// Whether the products, each so many times, add up to the polynomial.
fn is_the_sum(polynomial: &Polynomial, products: &[Polynomial], entries: &[RBig]) -> bool {
    let mut sum = Rational::new();
    for (product, times) in products.iter().zip(entries) {
        for (exponents, coefficient) in product.terms() {
            *sum.entry(*exponents).or_insert(RBig::ZERO) += times * RBig::from(coefficient.clone());
        }
    }
    for (exponents, coefficient) in polynomial.terms() {
        *sum.entry(*exponents).or_insert(RBig::ZERO) -= RBig::from(coefficient.clone());
    }
    sum.values().all(RBig::is_zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x(index: usize) -> Polynomial {
        Polynomial::variable(index)
    }
    fn number(value: i64) -> Polynomial {
        Polynomial::integer(&IBig::from(value))
    }
    fn times(a: &Polynomial, b: &Polynomial) -> Polynomial {
        a.mul(b).unwrap()
    }
    fn power(a: &Polynomial, n: u32) -> Polynomial {
        (0..n).fold(number(1), |p, _| times(&p, a))
    }
    fn plain(polynomial: &Polynomial) -> Option<ProvedSign> {
        bounded_below(polynomial, &[], &[], &|p| p)
    }

    #[test]
    fn sums_of_squares_are_found_and_others_are_not() {
        let (a, b, c) = (x(0), x(1), x(2));
        // a^2 - a b + b^2 touches zero; with one more it does not
        let form = power(&a, 2).add(&times(&a, &b).neg()).add(&power(&b, 2));
        assert_eq!(plain(&form), Some(ProvedSign::NotNegative));
        assert_eq!(plain(&form.add(&number(1))), Some(ProvedSign::Positive));
        assert_eq!(plain(&form.add(&number(1).neg())), None);
        // (a^2 - b^2)^2, of which no inner point exists
        let edge = power(&power(&a, 2).add(&power(&b, 2).neg()), 2);
        assert_eq!(plain(&edge), Some(ProvedSign::NotNegative));
        assert_eq!(plain(&edge.add(&number(1))), Some(ProvedSign::Positive));
        // a^4 + b^4 + c^4 + 1 >= 4 a b c
        let mean = power(&a, 4).add(&power(&b, 4)).add(&power(&c, 4)).add(&number(1));
        let product = times(&times(&a, &b), &c);
        assert_eq!(plain(&mean.add(&times(&number(-4), &product))), Some(ProvedSign::NotNegative));
        assert_eq!(plain(&mean.add(&times(&number(-5), &product))), None);
        // Motzkin's polynomial is not negative, and no sum of squares
        let (aa, bb) = (power(&a, 2), power(&b, 2));
        let motzkin = times(&times(&aa, &bb), &aa.add(&bb).add(&number(-3))).add(&number(1));
        assert_eq!(plain(&motzkin), None);
        // x^4 - x + 1
        assert_eq!(plain(&power(&a, 4).add(&a.neg()).add(&number(1))), Some(ProvedSign::Positive));
    }

    #[test]
    fn what_is_assumed_takes_part() {
        let (a, b) = (x(0), x(1));
        // a b + 1 > 0 where a > 0 and b > 0
        let assumed = [(a.clone(), true), (b.clone(), true)];
        let found = bounded_below(&times(&a, &b).add(&number(1)), &assumed, &[], &|p| p);
        assert_eq!(found, Some(ProvedSign::Positive));
        assert_eq!(bounded_below(&times(&a, &b).neg(), &assumed, &[], &|p| p), None);
        // 1 - a^2 >= 0 where 1 - a >= 0 and 1 + a >= 0
        let assumed = [(number(1).add(&a.neg()), false), (number(1).add(&a), false)];
        let found = bounded_below(&number(1).add(&power(&a, 2).neg()), &assumed, &[], &|p| p);
        assert_eq!(found, Some(ProvedSign::NotNegative));
    }

    /// `1 - 2 a b` is `(a - b)^2` on the circle.
    #[test]
    fn multiples_of_what_vanishes_take_part() {
        let (a, b) = (x(0), x(1));
        let circle = power(&a, 2).add(&power(&b, 2)).add(&number(-1));
        let goal = number(1).add(&times(&number(-2), &times(&a, &b)));
        assert_eq!(plain(&goal), None);
        assert_eq!(bounded_below(&goal, &[], &[circle], &|p| p), Some(ProvedSign::NotNegative));
    }
}
