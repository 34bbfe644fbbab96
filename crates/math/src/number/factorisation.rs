//! A polynomial as a product of shorter ones, as far as that is cheap.
//!
//! A factor that is free of some variable divides every coefficient of the polynomial by that variable. The shortest
//! of these is split in turn, and what it is a product of is tried on the others. Factors that need every variable are
//! not found, and nothing is said to be irreducible; that the product is the polynomial is exact.

use super::polynomial::{LARGEST_ARITY, Polynomial, Ring};
use dashu::base::SquareRoot;
use dashu::integer::{IBig, UBig};

/// `unit` times the factors with their powers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Factorisation {
    /// An integer; zero for the polynomial zero, which has no factors.
    pub unit: IBig,
    /// Polynomials of positive degree, the greatest common divisor of whose coefficients is one and whose leading
    /// coefficient is positive, each of them once.
    pub factors: Vec<(Polynomial, u32)>,
}

/// A polynomial split into factors; those in `known` are tried first.
pub fn split(polynomial: &Polynomial, known: &[Polynomial]) -> Factorisation {
    let unit = polynomial.content();
    let mut factors = Vec::new();
    let Some(mut rest) = primitive(polynomial) else {
        return Factorisation { unit, factors };
    };
    let monomial = rest.common_monomial();
    for (variable, power) in monomial.iter().enumerate().filter(|(_, power)| **power > 0) {
        factors.push((Polynomial::variable(variable), u32::from(*power)));
    }
    let product = factors.iter().try_fold(Polynomial::integer(&IBig::ONE), |product, (variable, power)| {
        (0..*power).try_fold(product, |product, _| product.mul(variable))
    });
    if let Some(quotient) = product.and_then(|product| rest.divide_exactly(&product)) {
        rest = quotient;
    } else {
        factors.clear();
    }
    for factor in known.iter().filter_map(primitive) {
        if factor.len() > 1 {
            rest = divide_out(rest, &factor, &mut factors);
        }
    }
    for variable in 0..LARGEST_ARITY {
        rest = free_of(variable, rest, &mut factors);
    }
    if rest.degree() > 0 {
        match square_root(&rest) {
            Some(root) => {
                split(&root, &[]).factors.into_iter().for_each(|(f, n)| add(&mut factors, f, 2 * n))
            }
            None => add(&mut factors, rest, 1),
        }
    }
    factors.sort_by(|(a, _), (b, _)| a.len().cmp(&b.len()).then_with(|| a.terms().cmp(b.terms())));
    Factorisation { unit, factors }
}

/// The polynomial without the greatest common divisor and the sign of its coefficients; `None` for zero.
pub fn primitive(polynomial: &Polynomial) -> Option<Polynomial> {
    let content = polynomial.content();
    if content.is_zero() { None } else { polynomial.divide_exactly(&Polynomial::integer(&content)) }
}

/// Takes from a polynomial the factors that are free of a variable.
fn free_of(variable: usize, polynomial: Polynomial, factors: &mut Vec<(Polynomial, u32)>) -> Polynomial {
    let coefficients = polynomial.coefficients_in(variable);
    if coefficients.len() < 2 {
        return polynomial;
    }
    let Some(shortest) = coefficients.values().min_by_key(|coefficient| coefficient.len()) else {
        return polynomial;
    };
    if shortest.len() < 2 {
        return polynomial; // a monomial; those have been taken out
    }
    let mut rest = polynomial.clone();
    for (factor, _) in split(shortest, &[]).factors {
        if factor.len() > 1 && coefficients.values().all(|c| c.divide_exactly(&factor).is_some()) {
            rest = divide_out(rest, &factor, factors);
        }
    }
    rest
}

fn divide_out(mut rest: Polynomial, factor: &Polynomial, factors: &mut Vec<(Polynomial, u32)>) -> Polynomial {
    while rest.degree() > 0
        && let Some(quotient) = rest.divide_exactly(factor)
    {
        rest = quotient;
        add(factors, factor.clone(), 1);
    }
    rest
}

/// The polynomial whose square this is, term by term from the leading one.
pub fn square_root(polynomial: &Polynomial) -> Option<Polynomial> {
    let (exponents, coefficient) = polynomial.terms().next_back()?;
    if exponents.iter().any(|e| e % 2 == 1) {
        return None;
    }
    let magnitude: UBig = coefficient.clone().try_into().ok()?;
    let root_of_lead = IBig::from(magnitude.sqrt());
    let lead = Polynomial::term(exponents.map(|e| e / 2), root_of_lead);
    let mut rest = polynomial.add(&lead.mul(&lead)?.neg());
    let twice = lead.add(&lead);
    let mut root = lead;
    loop {
        let Some((exponents, coefficient)) = rest.terms().next_back() else { return Some(root) };
        let next = Polynomial::term(*exponents, coefficient.clone()).divide_exactly(&twice)?;
        let both = root.add(&root).add(&next);
        rest = rest.add(&both.mul(&next)?.neg());
        root = root.add(&next);
        if root.len() > polynomial.len() {
            return None; // what is no square goes on and on; few roots are longer than their square
        }
    }
}

fn add(factors: &mut Vec<(Polynomial, u32)>, factor: Polynomial, power: u32) {
    match factors.iter_mut().find(|(known, _)| *known == factor) {
        Some((_, n)) => *n += power,
        None => factors.push((factor, power)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x(index: usize) -> Polynomial {
        Polynomial::variable(index)
    }

    fn product(factors: &[Polynomial]) -> Polynomial {
        factors.iter().fold(Polynomial::integer(&IBig::ONE), |p, f| p.mul(f).unwrap())
    }

    /// What was multiplied is found again: a monomial, a factor in x and y twice, one in y and z, and the unit.
    #[test]
    fn a_product_is_taken_apart() {
        let a = x(0).add(&x(1)); // x + y
        let b = x(1).mul(&x(1)).unwrap().add(&x(2)); // y^2 + z
        let minus_six = Polynomial::integer(&IBig::from(-6));
        let whole = product(&[minus_six, x(2), x(2), a.clone(), a.clone(), b.clone()]);
        let found = split(&whole, &[]);
        assert_eq!(found.unit, IBig::from(-6));
        assert_eq!(found.factors.len(), 3);
        for (factor, power) in [(x(2), 2), (a, 2), (b, 1)] {
            assert!(found.factors.contains(&(factor, power)));
        }
    }

    /// `x^2 - y^2` needs both variables in both factors: it is left whole, unless a factor is known.
    #[test]
    fn what_is_not_found_is_left_whole() {
        let (sum, difference) = (x(0).add(&x(1)), x(0).add(&x(1).neg()));
        let whole = sum.mul(&difference).unwrap();
        assert_eq!(split(&whole, &[]).factors, [(whole.clone(), 1)]);
        assert_eq!(split(&whole, &[difference]).factors.len(), 2);
    }

    #[test]
    fn zero_and_constants_have_no_factors() {
        assert_eq!(split(&Polynomial::default(), &[]).unit, IBig::ZERO);
        let seven = split(&Polynomial::integer(&IBig::from(7)), &[]);
        assert_eq!((seven.unit, seven.factors.len()), (IBig::from(7), 0));
    }
}
