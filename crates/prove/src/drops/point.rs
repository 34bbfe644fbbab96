//! A random point of a case modulo a prime: where a minor is not zero there, it is not zero on the case.

use super::algebra::Algebra;
use super::case::{Case, Relation};
use super::factors::places;
use palmistry_math::expression::{NodeId, Program, Symbol};
use palmistry_math::number::polynomial::Polynomial;
use palmistry_math::number::{Arithmetic, PrimeField};
use rand::Rng;
use std::collections::HashMap;

/// So often points are drawn where an equation has no solution.
const ATTEMPTS: usize = 60;

/// Values for symbols, modulo a prime.
pub(super) struct Point {
    pub field: PrimeField,
    pub values: HashMap<Symbol, u64>,
}

/// A random point that meets all equations of a case; `None` where none was found.
pub(super) fn draw(
    algebra: &mut Algebra<'_>,
    case: &Case,
    symbols: &[Symbol],
    rng: &mut impl Rng,
) -> Option<Point> {
    for _ in 0..ATTEMPTS {
        let field = PrimeField::random(rng);
        let mut values: HashMap<Symbol, u64> = HashMap::new();
        for symbol in symbols.iter().filter(|symbol| !case.values.contains_key(symbol)) {
            values.insert(*symbol, field.draw(rng));
        }
        if solve(algebra, &case.relations, &field, &mut values, rng).is_none() {
            continue;
        }
        let mut solved: Vec<(Symbol, NodeId)> = case.values.iter().map(|(s, v)| (*s, *v)).collect();
        solved.sort_unstable();
        let nodes: Vec<NodeId> = solved.iter().map(|(_, node)| *node).collect();
        let Some(found) = evaluate(algebra, &nodes, &Point { field, values: values.clone() }, rng) else {
            continue;
        };
        values.extend(solved.iter().map(|(symbol, _)| *symbol).zip(found));
        return Some(Point { field, values });
    }
    None
}

/// Expressions of plain symbols at a point; functions have random values.
pub(super) fn evaluate(
    algebra: &Algebra<'_>,
    nodes: &[NodeId],
    point: &Point,
    rng: &mut impl Rng,
) -> Option<Vec<u64>> {
    let program = Program::with_unknown_functions(&algebra.system.graph, nodes, |_| false);
    run(&program, point, rng)
}

/// A program at a point.
pub(super) fn run(program: &Program, point: &Point, rng: &mut impl Rng) -> Option<Vec<u64>> {
    let mut inputs = Vec::with_capacity(program.inputs().len());
    for input in program.inputs() {
        let known = input.symbol().and_then(|symbol| point.values.get(&symbol));
        inputs.push(known.copied().unwrap_or_else(|| point.field.draw(rng)));
    }
    program.load(point.field).ok()?.run(&inputs, &mut Vec::new()).ok()
}

/// Solves relations, each for its own variable.
fn solve(
    algebra: &Algebra<'_>,
    relations: &[Relation],
    field: &PrimeField,
    values: &mut HashMap<Symbol, u64>,
    rng: &mut impl Rng,
) -> Option<()> {
    let mut open: Vec<&Relation> = relations.iter().collect();
    while !open.is_empty() {
        // one that mentions no other's variable
        let at = open.iter().position(|relation| {
            let others = open.iter().filter(|other| other.place != relation.place);
            others.into_iter().all(|other| relation.polynomial.degree_in(other.place) == 0)
        })?;
        let relation = open.remove(at);
        let mut coefficients = vec![0; usize::from(relation.polynomial.degree_in(relation.place)) + 1];
        for (power, part) in relation.polynomial.coefficients_in(relation.place) {
            coefficients[usize::from(power)] = value(algebra, &part, field, values)?;
        }
        let root = root(field, coefficients, rng)?;
        values.insert(algebra.symbol_at(relation.place)?, root);
    }
    Some(())
}

fn value(
    algebra: &Algebra<'_>,
    polynomial: &Polynomial,
    field: &PrimeField,
    values: &HashMap<Symbol, u64>,
) -> Option<u64> {
    let mut at = HashMap::new();
    for place in places(polynomial) {
        at.insert(place, *values.get(&algebra.symbol_at(place)?)?);
    }
    let mut sum = field.integer(&dashu::integer::IBig::ZERO);
    for (exponents, coefficient) in polynomial.terms() {
        let mut term = field.integer(coefficient);
        for (place, power) in exponents.iter().enumerate().filter(|(_, power)| **power > 0) {
            term = field.mul(&term, &field.power(&at[&place], i32::from(*power)).ok()?).ok()?;
        }
        sum = field.add(&sum, &term).ok()?;
    }
    Some(sum)
}

/// A root of a polynomial, constant first; `None` where none was found. By `x^p - x`, which has every element as a root.
fn root(field: &PrimeField, polynomial: Vec<u64>, rng: &mut impl Rng) -> Option<u64> {
    let mut polynomial = trimmed(polynomial);
    if polynomial.len() < 2 {
        return None;
    }
    let (zero, one) = (field.integer(&0.into()), field.integer(&1.into()));
    let x = vec![zero, one];
    let fermat = minus(field, &power(field, &x, field.modulus(), &polynomial)?, &x)?;
    polynomial = common(field, polynomial, fermat)?;
    for _ in 0..ATTEMPTS {
        match polynomial.len() {
            0 | 1 => return None,
            2 => {
                let inverse = field.inverse(polynomial[1])?;
                return field.neg(&field.mul(&polynomial[0], &inverse).ok()?).ok();
            }
            _ => {}
        }
        // half of all elements are squares: those roots that are after a random shift are split off
        let shifted = vec![field.draw(rng), one];
        let squares = power(field, &shifted, (field.modulus() - 1) / 2, &polynomial)?;
        let part = common(field, polynomial.clone(), minus(field, &squares, &[one])?)?;
        if part.len() > 1 && part.len() < polynomial.len() {
            polynomial = part;
        }
    }
    None
}

fn trimmed(mut polynomial: Vec<u64>) -> Vec<u64> {
    while polynomial.last() == Some(&0) {
        polynomial.pop();
    }
    polynomial
}

fn minus(field: &PrimeField, a: &[u64], b: &[u64]) -> Option<Vec<u64>> {
    let at = |values: &[u64], i: usize| values.get(i).copied().unwrap_or(0);
    let length = a.len().max(b.len());
    let values: Option<Vec<u64>> = (0..length).map(|i| field.sub(&at(a, i), &at(b, i)).ok()).collect();
    Some(trimmed(values?))
}

fn modulo(field: &PrimeField, mut a: Vec<u64>, b: &[u64]) -> Option<Vec<u64>> {
    let lead = field.inverse(*b.last()?)?;
    while a.len() >= b.len() {
        let factor = field.mul(a.last()?, &lead).ok()?;
        let shift = a.len() - b.len();
        for (i, value) in b.iter().enumerate() {
            a[shift + i] = field.sub(&a[shift + i], &field.mul(&factor, value).ok()?).ok()?;
        }
        a.pop();
        a = trimmed(a);
    }
    Some(a)
}

fn common(field: &PrimeField, mut a: Vec<u64>, mut b: Vec<u64>) -> Option<Vec<u64>> {
    while !b.is_empty() {
        let rest = modulo(field, a, &b)?;
        (a, b) = (b, rest);
    }
    Some(a)
}

fn power(field: &PrimeField, base: &[u64], mut n: u64, by: &[u64]) -> Option<Vec<u64>> {
    let product = |a: &[u64], b: &[u64]| -> Option<Vec<u64>> {
        if a.is_empty() || b.is_empty() {
            return Some(Vec::new());
        }
        let mut found = vec![0; a.len() + b.len() - 1];
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                found[i + j] = field.add(&found[i + j], &field.mul(x, y).ok()?).ok()?;
            }
        }
        modulo(field, trimmed(found), by)
    };
    let mut square = modulo(field, base.to_vec(), by)?;
    let mut result = modulo(field, vec![field.integer(&1.into())], by)?;
    while n > 0 {
        if n & 1 == 1 {
            result = product(&result, &square)?;
        }
        square = product(&square, &square)?;
        n >>= 1;
    }
    Some(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// `(x - 3)(x - 5)(x + 7) = x^3 - x^2 - 41 x + 105` has three roots, and one of them is found.
    #[test]
    fn a_root_is_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let field = PrimeField::random(&mut rng);
        let number = |n: i64| field.integer(&n.into());
        let found = root(&field, [105, -41, -1, 1].map(number).to_vec(), &mut rng);
        assert!(found.is_some_and(|root| [3, 5, -7].map(number).contains(&root)));
    }
}
