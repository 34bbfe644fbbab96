//! What is found out of a polynomial alone: more of its factors than those that are free of a variable, and whether it can
//! vanish at real numbers.
//!
//! A factor found here divides exactly; what is not split may have factors all the same. A polynomial that is nowhere
//! negative has a minimum wherever it vanishes, so that all its derivatives vanish there too: that is what [`semidefinite`]
//! is asked for. Of a polynomial in one variable Sturm's chain counts the real zeros.

use dashu::base::{Abs, Sign};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::number::polynomial::{Exponents, LARGEST_ARITY, Polynomial, Ring};
use palmistry_math::number::real_roots::zeros_of;
use palmistry_math::number::{primitive, split, square_root};

/// Factors are looked for in polynomials of at most so many monomials.
const LONGEST: usize = 150;
/// So many candidates for a linear factor are tried.
const MOST_CANDIDATES: usize = 256;
/// Semidefinite polynomials are recognised by so many completed squares.
const DEEPEST: usize = 4;

/// The factors of a polynomial with their powers, each primitive and with a positive leading coefficient; none of a constant.
pub(super) fn factors(polynomial: &Polynomial, known: &[Polynomial]) -> Vec<(Polynomial, u32)> {
    let mut found: Vec<(Polynomial, u32)> = Vec::new();
    for (factor, power) in split(polynomial, known).factors {
        for part in refined(factor) {
            match found.iter_mut().find(|(other, _)| *other == part) {
                Some((_, n)) => *n += power,
                None => found.push((part, power)),
            }
        }
    }
    found
}

/// The places of the variables that a polynomial mentions.
pub(super) fn places(polynomial: &Polynomial) -> Vec<usize> {
    (0..LARGEST_ARITY).filter(|place| polynomial.degree_in(*place) > 0).collect()
}

/// The coefficient of a power of a variable.
pub(super) fn coefficient(polynomial: &Polynomial, place: usize, power: u8) -> Polynomial {
    polynomial.coefficients_in(place).remove(&power).unwrap_or_default()
}

/// The derivative by a variable.
pub(super) fn derivative(polynomial: &Polynomial, place: usize) -> Polynomial {
    let mut sum = Polynomial::default();
    for (exponents, value) in polynomial.terms().filter(|(exponents, _)| exponents[place] > 0) {
        let mut less: Exponents = *exponents;
        less[place] -= 1;
        sum = sum.add(&Polynomial::term(less, value * IBig::from(exponents[place])));
    }
    sum
}

/// A factor divided further: by discriminants that are squares, and by factors that are linear in a variable.
fn refined(polynomial: Polynomial) -> Vec<Polynomial> {
    if polynomial.len() < 2 || polynomial.len() > LONGEST {
        return vec![polynomial];
    }
    for place in places(&polynomial) {
        let divisor = by_discriminant(&polynomial, place).or_else(|| by_line(&polynomial, place));
        if let Some(divisor) = divisor
            && let Some(rest) = polynomial.divide_exactly(&divisor).and_then(|rest| primitive(&rest))
        {
            return refined(divisor).into_iter().chain(refined(rest)).filter(|f| f.degree() > 0).collect();
        }
    }
    vec![polynomial]
}

/// The part of a polynomial that has a variable, if it divides another one and is shorter.
fn part_with(candidate: &Polynomial, place: usize, of: &Polynomial) -> Option<Polynomial> {
    split(candidate, &[]).factors.into_iter().map(|(factor, _)| factor).find(|factor| {
        factor.degree_in(place) > 0 && factor.degree() < of.degree() && of.divide_exactly(factor).is_some()
    })
}

/// A divisor of `a u^2 + b u + c` whose discriminant is a square, where `u` is a power of a variable.
fn by_discriminant(polynomial: &Polynomial, place: usize) -> Option<Polynomial> {
    let degree = polynomial.degree_in(place);
    if !degree.is_multiple_of(2) {
        return None;
    }
    let half = degree / 2;
    if polynomial.terms().any(|(exponents, _)| exponents[place] % half != 0) {
        return None;
    }
    let [c, b, a] = [0, half, degree].map(|power| coefficient(polynomial, place, power));
    let discriminant = discriminant(&a, &b, &c)?;
    let root = if discriminant.is_zero() { Polynomial::default() } else { square_root(&discriminant)? };
    let mut power = Exponents::default();
    power[place] = half;
    let lead = a.add(&a).mul(&Polynomial::term(power, IBig::ONE))?;
    [root.neg(), root].iter().find_map(|root| part_with(&lead.add(&b).add(root), place, polynomial))
}

/// `b^2 - 4 a c`
pub(super) fn discriminant(a: &Polynomial, b: &Polynomial, c: &Polynomial) -> Option<Polynomial> {
    let four = Polynomial::integer(&IBig::from(4));
    Some(b.mul(b)?.add(&a.mul(c)?.mul(&four)?.neg()))
}

/// A divisor `p x + q`: then `p` divides the leading coefficient and `q` the last one.
fn by_line(polynomial: &Polynomial, place: usize) -> Option<Polynomial> {
    let degree = polynomial.degree_in(place);
    if degree < 2 {
        return None;
    }
    let lead = divisors(&coefficient(polynomial, place, degree));
    let last = divisors(&coefficient(polynomial, place, 0));
    if lead.len() * last.len() > MOST_CANDIDATES {
        return None;
    }
    let x = Polynomial::variable(place);
    for p in &lead {
        let line = p.mul(&x)?;
        for q in &last {
            for candidate in [line.add(q), line.add(&q.neg())] {
                if candidate.degree() < polynomial.degree() && polynomial.divide_exactly(&candidate).is_some()
                {
                    return primitive(&candidate);
                }
            }
        }
    }
    None
}

/// Divisors of a polynomial, up to sign, as far as its factors are found; none of zero.
fn divisors(polynomial: &Polynomial) -> Vec<Polynomial> {
    let found = split(polynomial, &[]);
    let magnitude = found.unit.clone().abs();
    if magnitude.is_zero() {
        return Vec::new();
    }
    let mut all = Vec::new();
    let small = u64::try_from(magnitude.clone()).unwrap_or(1);
    for n in (1..=small.min(1000)).filter(|n| small.is_multiple_of(*n)) {
        all.push(Polynomial::integer(&IBig::from(n)));
    }
    for (factor, power) in found.factors {
        let mut next = Vec::new();
        for divisor in &all {
            let mut product = divisor.clone();
            next.push(product.clone());
            for _ in 0..power {
                let Some(longer) = product.mul(&factor) else { break };
                product = longer;
                next.push(product.clone());
            }
        }
        all = next;
        if all.len() > MOST_CANDIDATES {
            break;
        }
    }
    all
}

/// The sign of a polynomial that never has the other one: `Some(Positive)` where it is nowhere negative, `Some(Negative)`
/// where it is nowhere positive. Variables of which `is_positive` holds are taken to be positive.
pub(super) fn semidefinite(polynomial: &Polynomial, is_positive: &dyn Fn(usize) -> bool) -> Option<Sign> {
    sign_within(polynomial, is_positive, DEEPEST)
}

fn sign_within(polynomial: &Polynomial, is_positive: &dyn Fn(usize) -> bool, depth: usize) -> Option<Sign> {
    if polynomial.is_zero() {
        return Some(Sign::Positive);
    }
    let squares = polynomial.terms().all(|(exponents, _)| {
        exponents.iter().enumerate().all(|(place, power)| power % 2 == 0 || is_positive(place))
    });
    let signs = || polynomial.terms().map(|(_, value)| value.sign());
    if squares {
        for sign in [Sign::Positive, Sign::Negative] {
            if signs().all(|other| other == sign) {
                return Some(sign);
            }
        }
    }
    if depth == 0 || polynomial.len() < 2 || polynomial.len() > LONGEST {
        return None;
    }
    let found = split(polynomial, &[]);
    if found.factors.len() > 1 || found.factors.iter().any(|(_, power)| *power > 1) {
        let mut sign = found.unit.sign();
        for (factor, _) in found.factors.iter().filter(|(_, power)| power % 2 == 1) {
            sign *= sign_within(factor, is_positive, depth - 1)?;
        }
        return Some(sign);
    }
    // a x^2 + b x + c with a discriminant that is nowhere positive has the sign of a
    for place in places(polynomial) {
        if polynomial.degree_in(place) != 2 {
            continue;
        }
        let [c, b, a] = [0, 1, 2].map(|power| coefficient(polynomial, place, power));
        let below = discriminant(&a, &b, &c)?.neg();
        if let Some(sign) = sign_within(&a, is_positive, depth - 1)
            && sign_within(&below, is_positive, depth - 1) == Some(Sign::Positive)
        {
            return Some(sign);
        }
    }
    None
}

/// How many different real zeros a polynomial in one variable has (Sturm); `None` where it has several variables or none.
pub(super) fn real_zeros(polynomial: &Polynomial) -> Option<usize> {
    let [place] = places(polynomial)[..] else { return None };
    if polynomial.degree_in(place) > HIGHEST {
        return None;
    }
    let mut values = vec![RBig::ZERO; usize::from(polynomial.degree_in(place)) + 1];
    for (exponents, value) in polynomial.terms() {
        values[usize::from(exponents[place])] = RBig::from(value.clone());
    }
    Some(zeros_of(&values))
}

/// Zeros of polynomials of higher degrees are not counted.
const HIGHEST: u8 = 40;

/// The remainder of a polynomial by another one in a variable, after it was multiplied by a power of the other's leading
/// coefficient; `None` where it becomes too long.
pub(super) fn pseudo_remainder(of: &Polynomial, by: &Polynomial, place: usize) -> Option<Polynomial> {
    let degree = by.degree_in(place);
    let lead = coefficient(by, place, degree);
    let mut rest = of.clone();
    while !rest.is_zero() && rest.degree_in(place) >= degree {
        let top = rest.degree_in(place);
        let mut shift = Exponents::default();
        shift[place] = top - degree;
        let front = coefficient(&rest, place, top).mul(&Polynomial::term(shift, IBig::ONE))?;
        rest = rest.mul(&lead)?.add(&by.mul(&front)?.neg());
        if rest.len() > MOST_TERMS {
            return None;
        }
        if let Some(shorter) = primitive(&rest) {
            rest = shorter;
        }
    }
    Some(rest)
}

/// Longer polynomials are not calculated with.
pub(super) const MOST_TERMS: usize = 2_000;

#[cfg(test)]
mod tests {
    use super::*;

    fn x(place: usize) -> Polynomial {
        Polynomial::variable(place)
    }
    fn number(value: i64) -> Polynomial {
        Polynomial::integer(&IBig::from(value))
    }
    fn power(base: &Polynomial, n: usize) -> Polynomial {
        (0..n).fold(number(1), |product, _| product.mul(base).unwrap())
    }

    /// `x^4 - y^4 = (x - y)(x + y)(x^2 + y^2)`, and `x^3 - 2 x y^2 + y^3 = (x - y)(x^2 + x y - y^2)`.
    #[test]
    fn factors_that_need_every_variable_are_found() {
        let fourth = power(&x(0), 4).add(&power(&x(1), 4).neg());
        let mut lengths: Vec<u32> = factors(&fourth, &[]).iter().map(|(f, _)| f.degree()).collect();
        lengths.sort_unstable();
        assert_eq!(lengths, [1, 1, 2]);
        let line = x(0).add(&x(1).neg());
        let cubic = power(&x(0), 2).add(&x(0).mul(&x(1)).unwrap()).add(&power(&x(1), 2).neg());
        let found = factors(&line.mul(&cubic).unwrap(), &[]);
        assert_eq!(found.len(), 2);
        assert!(found.contains(&(line, 1)) && found.contains(&(cubic, 1)));
    }

    /// `x^2 + x y + y^2` is nowhere negative, `x^2 + 3 x y + y^2` has both signs; `x^2 y` has the sign of `y`.
    #[test]
    fn signs_are_found_by_completed_squares() {
        let form = |middle: i64| {
            let mixed = x(0).mul(&x(1)).unwrap().mul(&number(middle)).unwrap();
            power(&x(0), 2).add(&mixed).add(&power(&x(1), 2))
        };
        let any = |_: usize| false;
        assert_eq!(semidefinite(&form(1), &any), Some(Sign::Positive));
        assert_eq!(semidefinite(&form(1).neg(), &any), Some(Sign::Negative));
        assert_eq!(semidefinite(&form(3), &any), None);
        let product = power(&x(0), 2).mul(&x(1)).unwrap();
        assert_eq!(semidefinite(&product, &any), None);
        assert_eq!(semidefinite(&product, &|place| place == 1), Some(Sign::Positive));
    }

    /// `x^4 + x + 1` has no real zero, `x^3 - 2` has one, `(x - 1)^2 (x + 2)` has two.
    #[test]
    fn real_zeros_are_counted() {
        let quartic = power(&x(0), 4).add(&x(0)).add(&number(1));
        assert_eq!(real_zeros(&quartic), Some(0));
        assert_eq!(real_zeros(&power(&x(0), 3).add(&number(-2))), Some(1));
        let double = power(&x(0).add(&number(-1)), 2).mul(&x(0).add(&number(2))).unwrap();
        assert_eq!(real_zeros(&double), Some(2));
        assert_eq!(real_zeros(&x(0).add(&x(1))), None);
    }
}
