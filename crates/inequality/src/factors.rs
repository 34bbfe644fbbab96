//! The sign of an expression by those of its factors: over one denominator, split into polynomials, each of which is
//! assumed to have a sign, has coefficients of one sign in variables whose signs are known, or is a sum of squares.

use super::reading::{GoalVariable, LONGEST, Polynomials, Reading};
use super::squares::{ProvedSign, bounded_below};
use super::{Known, Premises};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_math::expression::{Graph, Guard, Need, Sign, Symbol};
use palmistry_math::number::polynomial::{Polynomial, Ring};
use palmistry_math::number::{Factorisation, Factors, Fraction, primitive, split};

/// Powers of a sine beyond this are not taken out.
const MOST_SINES: u32 = 64;
/// So many assumptions are tried as multipliers.
const MOST_MULTIPLIERS: usize = 3;

/// What is known of some polynomials.
struct Signs {
    read: Polynomials,
    /// Polynomials that are not negative, and whether they are positive.
    assumed: Vec<(Polynomial, bool)>,
    /// Primitive polynomials that are not zero.
    not_zero: Vec<Polynomial>,
}

/// Whether the signs of factors show that a goal holds wherever it exists, the assumptions hold and the equations' left sides vanish.
pub fn tell(
    graph: &mut Graph,
    goal: Guard,
    premises: Premises<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
    known: Known<'_>,
) -> bool {
    let (reading, premises) = match Reading::new(graph, goal.node, premises, is_angle) {
        Some(reading) => (reading, premises),
        // too many variables
        None => match Reading::new(graph, goal.node, Premises::default(), is_angle) {
            Some(reading) => (reading, Premises::default()),
            None => return false,
        },
    };
    let Some(read) = reading.polynomials(graph, known) else {
        return false;
    };
    let signs = Signs::new(read, premises.assumed);
    let Fraction { top, bottom } = &signs.read.goal;
    if goal.need == Need::NotZero {
        return signs.is_not_zero_product(top);
    }
    signs.of_fraction(top, bottom).is_some_and(|sign| super::tells(goal.need, sign))
}

impl Signs {
    fn new(read: Polynomials, assumed: &[Guard]) -> Signs {
        let mut values: Vec<(Fraction, Need)> =
            read.assumed.iter().cloned().zip(assumed.iter().map(|guard| guard.need)).collect();
        let principal = read.principal_values.clone();
        let mut signs = Signs { read, assumed: principal, not_zero: Vec::new() };
        // those of fewer factors first: they help to read the others
        values.sort_by_key(|(value, _)| value.top.len() + value.bottom.len());
        for (value, need) in values {
            signs.assume(&value.top, &value.bottom, need);
        }
        signs
    }

    /// Notes what an assumption about a fraction says of polynomials.
    fn assume(&mut self, top: &Factors, bottom: &Factors, need: Need) {
        let strict = match need {
            Need::Positive | Need::NotZero => true,
            Need::NotNegative => false,
            Need::WithinOne | Need::InsideOne => return,
        };
        // what is different from zero is so in each of its factors
        if strict {
            for place in top.keys() {
                let found = self.split(&self.read.fractions.factor(*place)).factors;
                self.not_zero.extend(found.into_iter().map(|(factor, _)| factor));
            }
        }
        if need == Need::NotZero {
            return;
        }
        let (mut upward, mut rest) = (true, Some(Polynomial::integer(&IBig::ONE)));
        for (place, power) in top.iter().chain(bottom) {
            let factor = self.read.fractions.factor(*place);
            if power % 2 == 0 {
                // where a square vanishes the product says nothing of the rest
                if !strict && !bottom.contains_key(place) && !self.is_not_zero(&factor) {
                    rest = rest.and_then(|rest| rest.mul(&factor)?.mul(&factor));
                }
                continue;
            }
            match self.of_polynomial(&factor, false) {
                Some(sign) if sign.is_strict() => upward ^= !sign.is_upward(),
                _ => rest = rest.and_then(|rest| rest.mul(&factor)),
            }
        }
        if let Some(rest) = rest.map(|rest| (self.read.normal)(rest))
            && rest.degree() > 0
            && rest.len() <= LONGEST
        {
            self.assumed.push((if upward { rest } else { rest.neg() }, strict));
        }
    }

    fn of_fraction(&self, top: &Factors, bottom: &Factors) -> Option<Sign> {
        let mut product = Some(Sign::Positive);
        let mut open = Polynomial::integer(&IBig::ONE);
        for (place, power) in top.iter().chain(bottom) {
            let factor = self.read.fractions.factor(*place);
            if factor.is_zero() {
                return None;
            }
            let sign = self.of_polynomial(&factor, true);
            let even = power % 2 == 0;
            match sign {
                _ if even => {
                    // what is divided by is not zero
                    let strict = bottom.contains_key(place)
                        || sign.is_some_and(Sign::is_strict)
                        || self.is_not_zero(&factor);
                    product = product.map(|product| times(product, Sign::new(true, strict)));
                }
                Some(sign) => {
                    let strict = sign.is_strict() || bottom.contains_key(place);
                    product = product.map(|p| times(p, Sign::new(sign.is_upward(), strict)));
                }
                None => open = open.mul(&factor)?,
            }
        }
        let product = product?;
        if open.degree() == 0 {
            return Some(product);
        }
        // factors without a sign may have one together
        let open = (self.read.normal)(open);
        (open.len() <= LONGEST)
            .then(|| self.of_one_piece(&open, true))
            .flatten()
            .map(|sign| times(product, sign))
    }

    /// Whether no factor of a product is ever zero.
    fn is_not_zero_product(&self, top: &Factors) -> bool {
        top.keys().all(|place| {
            let factor = self.read.fractions.factor(*place);
            self.is_not_zero(&factor) || self.of_polynomial(&factor, true).is_some_and(Sign::is_strict)
        })
    }

    /// A product of polynomials, sines first: with `sin^2 = 1 - cos^2` a sine divides what becomes a multiple of that when
    /// it is multiplied by the sine.
    fn split(&self, polynomial: &Polynomial) -> Factorisation {
        let (mut rest, mut sines) = (polynomial.clone(), Vec::new());
        for (sine, square) in &self.read.squares_of_sines {
            let sine = Polynomial::variable(*sine);
            let mut power = 0;
            while power < MOST_SINES
                && let Some(raised) = rest.mul(&sine).map(|raised| (self.read.normal)(raised))
                && let Some(quotient) = raised.divide_exactly(square)
            {
                (rest, power) = (quotient, power + 1);
            }
            if power > 0 {
                sines.push((sine, power));
            }
        }
        let known: Vec<Polynomial> = self
            .read
            .squares_of_sines
            .iter()
            .map(|(_, square)| square)
            .chain(self.assumed.iter().map(|(known, _)| known))
            .chain(&self.not_zero)
            .cloned()
            .collect();
        let mut found = split(&rest, &known);
        for (sine, power) in sines {
            match found.factors.iter_mut().find(|(factor, _)| *factor == sine) {
                Some((_, known)) => *known += power,
                None => found.factors.push((sine, power)),
            }
        }
        found
    }

    /// The sine of which a polynomial is the square, and whether with its sign.
    fn as_square_of_a_sine(&self, polynomial: &Polynomial) -> Option<(Polynomial, bool)> {
        let of = |(sine, square): &(usize, Polynomial)| {
            let same = polynomial == square;
            (same || *polynomial == square.neg()).then(|| (Polynomial::variable(*sine), same))
        };
        self.read.squares_of_sines.iter().find_map(of)
    }

    fn is_not_zero(&self, polynomial: &Polynomial) -> bool {
        self.split(polynomial).factors.iter().all(|(factor, _)| {
            let sine = self.as_square_of_a_sine(factor).map(|(sine, _)| sine);
            let primitive = primitive(sine.as_ref().unwrap_or(factor));
            primitive.is_some_and(|p| self.not_zero.contains(&p) || self.not_zero.contains(&p.neg()))
        })
    }

    fn of_polynomial(&self, polynomial: &Polynomial, squares: bool) -> Option<Sign> {
        if polynomial.is_zero() || polynomial.len() > LONGEST {
            return None;
        }
        if let Some(sign) = self.of_one_piece(polynomial, false) {
            return Some(sign);
        }
        let found = self.split(polynomial);
        let mut product = Sign::new(found.unit > IBig::ZERO, true);
        let one = found.factors.len() == 1 && found.factors[0].1 == 1;
        for (factor, power) in &found.factors {
            let sign = match self.of_one_piece(factor, squares && (one || power % 2 == 1)) {
                Some(sign) => sign,
                None if power % 2 == 0 => Sign::NotNegative,
                None => return None,
            };
            let strict = sign.is_strict() || self.is_not_zero(factor);
            product = times(product, Sign::new(sign.is_upward() || power % 2 == 0, strict));
        }
        Some(product)
    }

    fn of_one_piece(&self, polynomial: &Polynomial, squares: bool) -> Option<Sign> {
        let minus = polynomial.neg();
        let scaled = |known: &Polynomial| {
            let (a, b) = (primitive(polynomial)?, primitive(known)?);
            let upward = |p: &Polynomial| p.content() > IBig::ZERO;
            (a == b).then(|| upward(polynomial) == upward(known))
        };
        if let Some((sine, upward)) = self.as_square_of_a_sine(polynomial) {
            return Some(Sign::new(upward, self.is_not_zero(&sine)));
        }
        for (known, strict) in &self.assumed {
            if let Some(upward) = scaled(known) {
                return Some(Sign::new(upward, *strict || self.is_not_zero(polynomial)));
            }
        }
        if let Some(strict) = self.by_coefficients(polynomial) {
            return Some(Sign::new(true, strict));
        }
        if let Some(strict) = self.by_coefficients(&minus) {
            return Some(Sign::new(false, strict));
        }
        if let Some(sign) = self.beside_a_root(polynomial, squares) {
            return Some(sign);
        }
        if !squares {
            return None;
        }
        for (candidate, upward) in [(polynomial, true), (&minus, false)] {
            if self.fails_somewhere(candidate) {
                continue;
            }
            if let Some(bounded) = self.by_squares(candidate) {
                let strict = bounded == ProvedSign::Positive || self.is_not_zero(polynomial);
                return Some(Sign::new(upward, strict));
            }
        }
        None
    }

    /// The sign of `a + b sqrt(u)`: that of the side whose square is the greater one.
    fn beside_a_root(&self, polynomial: &Polynomial, squares: bool) -> Option<Sign> {
        for (place, top, bottom) in &self.read.roots {
            let mut parts = polynomial.coefficients_in(*place);
            if parts.keys().max() != Some(&1) || top.degree_in(*place) + bottom.degree_in(*place) > 0 {
                continue;
            }
            let mut take = |power: u8| parts.remove(&power).unwrap_or_default();
            let (a, b) = (take(0), take(1));
            // u = top/bottom is not negative, and so its sign is that of top*bottom
            let Some(slope) = self.of_polynomial(&b, squares) else { continue };
            let Some(below) = self.of_polynomial(bottom, squares).filter(|sign| sign.is_strict()) else {
                continue;
            };
            let square = |p: &Polynomial, factor: &Polynomial| p.mul(p)?.mul(factor);
            let (of_rest, of_root) = (square(&a, bottom)?, square(&b, top)?);
            let more = (self.read.normal)(of_root.add(&of_rest.neg()));
            let upward = |sign: Sign| sign.is_upward() == below.is_upward();
            // the root's part outweighs the rest
            if let Some(sign) = self.of_polynomial(&more, squares).filter(|sign| upward(*sign)) {
                return Some(Sign::new(slope.is_upward(), sign.is_strict() && slope.is_strict()));
            }
            // the rest outweighs the root's part
            if let Some(rest) = self.of_polynomial(&a, squares)
                && let Some(sign) = self.of_polynomial(&more.neg(), squares).filter(|sign| upward(*sign))
            {
                return Some(Sign::new(rest.is_upward(), sign.is_strict() && rest.is_strict()));
            }
        }
        None
    }

    /// Sums of squares: by itself; with what is assumed; and times something positive that is assumed.
    fn by_squares(&self, polynomial: &Polynomial) -> Option<ProvedSign> {
        let assumed = self.all_assumed();
        let normal = &*self.read.normal;
        let mut found = bounded_below(polynomial, &[], &[], normal);
        if found == Some(ProvedSign::Positive) || assumed.is_empty() && self.read.vanishing.is_empty() {
            return found;
        }
        found = bounded_below(polynomial, &assumed, &self.read.vanishing, normal).or(found);
        for (factor, _) in assumed.iter().filter(|(_, strict)| *strict).take(MOST_MULTIPLIERS) {
            if found.is_some() {
                break;
            }
            let product = polynomial.mul(factor).map(normal);
            found = product.and_then(|p| bounded_below(&p, &assumed, &self.read.vanishing, normal));
        }
        found
    }

    /// Whether a polynomial without assumptions is certainly negative somewhere, so that no sum of squares is looked for:
    /// an odd power of highest degree, or a negative value at the origin.
    fn fails_somewhere(&self, polynomial: &Polynomial) -> bool {
        self.all_assumed().is_empty()
            && self.read.vanishing.is_empty()
            && polynomial.degree() % 2 == 1
            && polynomial.terms().all(|(e, _)| {
                // with relations between sines and cosines the degree says nothing
                let as_term = Polynomial::term(*e, IBig::ONE);
                let square = as_term.mul(&as_term);
                square.is_some_and(|square| (self.read.normal)(square.clone()) == square)
            })
    }

    /// What is assumed, the ends of variables included.
    fn all_assumed(&self) -> Vec<(Polynomial, bool)> {
        let mut all = self.assumed.clone();
        for (place, variable) in self.read.variables.iter().enumerate() {
            let x = Polynomial::variable(place);
            let mut note = |polynomial: Polynomial, strict: bool| {
                if !all.iter().any(|(known, _)| *known == polynomial) {
                    all.push((polynomial, strict));
                }
            };
            if let Some(low) = &variable.low {
                note(line(&x, &low.value, true), low.strict);
            }
            if let Some(high) = &variable.high {
                note(line(&x, &high.value, false), high.strict);
            }
            if variable.low.is_none()
                && variable.high.is_none()
                && let Some(sign) = variable.sign
            {
                note(if sign.is_upward() { x } else { x.neg() }, sign.is_strict());
            }
        }
        all
    }

    /// Whether each monomial is not negative for the signs of its variables, counted from an end where they have one; if
    /// so, whether the sum is positive.
    fn by_coefficients(&self, polynomial: &Polynomial) -> Option<bool> {
        let mut shifted = polynomial.clone();
        let mut signs: Vec<Option<bool>> = Vec::new();
        for (place, variable) in self.read.variables.iter().enumerate() {
            let x = Polynomial::variable(place);
            let (moved, strict) = match (variable, variable.sign) {
                (GoalVariable { low: Some(low), .. }, _) => (Some((x, &low.value, true)), Some(low.strict)),
                (GoalVariable { high: Some(high), .. }, _) => {
                    (Some((x, &high.value, false)), Some(high.strict))
                }
                (_, Some(sign)) if sign.is_upward() => (None, Some(sign.is_strict())),
                (_, Some(sign)) => (Some((x, &RBig::ZERO, false)), Some(sign.is_strict())),
                _ => (None, None),
            };
            if let Some((x, end, upward)) = moved
                && polynomial.degree_in(place) > 0
            {
                shifted = replace(&shifted, place, &x, end, upward)?;
            }
            signs.push(strict);
        }
        let mut strict = false;
        for (exponents, coefficient) in shifted.terms() {
            if *coefficient < IBig::ZERO {
                return None;
            }
            let mut positive = true;
            for (place, exponent) in exponents.iter().enumerate().filter(|(_, e)| **e > 0) {
                match signs.get(place).copied().flatten() {
                    Some(strict) => positive &= strict,
                    None if exponent % 2 == 0 => positive = false,
                    None => return None,
                }
            }
            strict |= positive;
        }
        Some(strict)
    }
}

/// `x - end` or `end - x`, over a common denominator.
fn line(x: &Polynomial, end: &RBig, upward: bool) -> Polynomial {
    let bottom = Polynomial::integer(&IBig::from(end.denominator().clone()));
    let top = Polynomial::integer(end.numerator());
    let scaled = x.mul(&bottom).unwrap_or_default();
    if upward { scaled.add(&top.neg()) } else { top.add(&scaled.neg()) }
}

/// A positive multiple of a polynomial in which a variable is counted from an end: `x = end + x'`, or `end - x'`.
fn replace(
    polynomial: &Polynomial,
    place: usize,
    x: &Polynomial,
    end: &RBig,
    upward: bool,
) -> Option<Polynomial> {
    let bottom = IBig::from(end.denominator().clone());
    let scaled = x.mul(&Polynomial::integer(&bottom))?;
    let step = Polynomial::integer(end.numerator()).add(&if upward { scaled } else { scaled.neg() });
    let most = polynomial.degree_in(place);
    let mut total = Polynomial::default();
    for (power, coefficient) in polynomial.coefficients_in(place) {
        let mut term = coefficient;
        for _ in 0..power {
            term = term.mul(&step)?;
        }
        for _ in power..most {
            term = term.mul(&Polynomial::integer(&bottom))?;
        }
        total = total.add(&term);
    }
    (total.len() <= LONGEST).then_some(total)
}

fn times(a: Sign, b: Sign) -> Sign {
    Sign::new(a.is_upward() == b.is_upward(), a.is_strict() && b.is_strict())
}
