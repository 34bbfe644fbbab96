//! Expressions in a normal form: quotients of polynomials with integer coefficients in symbols, sines and cosines, exponentials, roots, and values of functions of which nothing is known.
//!
//! The only relations that are used hold wherever their terms exist: the squares of sine and cosine add up to one, the square of a root is what it is taken of, sine, cosine and exponential of a sum
//! are those of its terms. So what is zero in this form is zero at all states at which it exists. What is not zero in it may be zero for a reason that is not known here.

mod closure;
mod conditions;
mod pole;
mod polynomial;
mod quotient;
mod span;
mod states;
mod symmetry;
#[cfg(test)]
mod tests;

use super::doubt::{Effort, Missing};
use super::listing::{Listing, Step};
pub use closure::{Closed, MovingField, closed};
pub use conditions::{Equations, follow};
use dashu::base::Signed;
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_math::number::{Function, Refusal};
pub use pole::has_pole;
use polynomial::{IntegerPolynomial, Monomial, square_part};
use quotient::{Quotient, QuotientField};
pub use span::{RowPlaces, Spans, span};
pub use states::states_on_parts;
use std::collections::{BTreeMap, HashMap, HashSet};
pub use symmetry::{KeptFields, kept};

/// Functions of functions nest no deeper.
const DEEPEST: usize = 16;
/// Multiples of an angle are no greater, nor are its parts smaller.
const LARGEST_MULTIPLE: i64 = 64;

/// What a variable stands for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Atom {
    Symbol(String),
    Pi,
    /// A whole number of turns, by which an angle that was solved may differ.
    Turns(String),
    /// Of a term of an argument, divided by a whole number.
    Sine(Term),
    Cosine(Term),
    Exponential(Term),
    /// The square root of a polynomial, times the sign of another one.
    Root(IntegerPolynomial, IntegerPolynomial),
    /// A function of which nothing is known, of a quotient.
    Value(Function, IntegerPolynomial, IntegerPolynomial),
}

impl Atom {
    /// The variables that take part in it.
    fn variables(&self) -> Vec<u32> {
        let of_term = |term: &Term| {
            let own = term.0.powers().iter().map(|(variable, _)| *variable);
            own.chain(term.1.variables()).collect()
        };
        match self {
            Atom::Symbol(_) | Atom::Pi | Atom::Turns(_) => Vec::new(),
            Atom::Sine(term) | Atom::Cosine(term) | Atom::Exponential(term) => of_term(term),
            Atom::Root(a, b) | Atom::Value(_, a, b) => [a.variables(), b.variables()].concat(),
        }
    }
}

/// One monomial of an argument, over what the argument is divided by.
type Term = (Monomial, IntegerPolynomial);

/// By how much terms of arguments are divided, so that all their multiples are whole.
type Divisors = HashMap<Term, i64>;

/// Cosine and sine.
type Turned = (Quotient, Quotient);

/// Why a listing has no normal form.
enum Stop {
    Missing(Missing),
    /// A term was met in a smaller part than before: all of it has to be done anew.
    Smaller(Term, i64),
}

impl From<Missing> for Stop {
    fn from(missing: Missing) -> Self {
        Stop::Missing(missing)
    }
}

/// Normal forms of the operations of one listing.
pub struct Normal<'e> {
    pub field: QuotientField<'e>,
    atoms: Vec<Atom>,
    /// How deep functions of functions nest in each.
    depths: Vec<usize>,
    known: HashMap<Atom, u32>,
    divisors: Divisors,
    part: Part,
}

/// What is known on a part of the states.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// Symbols that are given by the others.
    symbols: BTreeMap<String, Quotient>,
    /// Cosine and sine of terms of arguments.
    angles: Vec<(Term, [i32; 2])>,
}

/// Runs what needs normal forms, anew where a term of an argument was met in a smaller part than before.
fn with_divisors<'e, T>(
    effort: &'e Effort,
    mut run: impl FnMut(&mut Normal<'e>) -> Result<T, Stop>,
) -> Result<T, Missing> {
    let mut divisors = Divisors::new();
    loop {
        let mut normal = Normal {
            field: QuotientField::new(effort),
            atoms: Vec::new(),
            depths: Vec::new(),
            known: HashMap::new(),
            divisors,
            part: Part::default(),
        };
        match run(&mut normal) {
            Ok(found) => return Ok(found),
            Err(Stop::Missing(missing)) => return Err(missing),
            Err(Stop::Smaller(term, divisor)) => {
                divisors = normal.divisors;
                divisors.insert(term, divisor);
            }
        }
    }
}

impl Normal<'_> {
    /// The normal forms of some places of a listing and of all that they need, beside those that are known.
    fn forms(
        &mut self,
        listing: &Listing,
        wanted: &[usize],
        values: &mut BTreeMap<usize, Quotient>,
    ) -> Result<(), Stop> {
        let steps = listing.steps();
        let mut is_needed = vec![false; steps.len()];
        let mut open = wanted.to_vec();
        while let Some(place) = open.pop() {
            let step = steps.get(place).ok_or(Missing::Place { place })?;
            if !values.contains_key(&place) && !std::mem::replace(&mut is_needed[place], true) {
                open.extend(step.operands());
            }
        }
        for (place, step) in steps.iter().enumerate().filter(|(place, _)| is_needed[*place]) {
            let value = self.form(place, step, values)?;
            if self.depths.last().is_some_and(|depth| *depth > DEEPEST) {
                return Err(Missing::Effort.into());
            }
            // each value is kept
            self.field.effort.spend(1 + value.powers.len() as u64)?;
            values.insert(place, value);
        }
        Ok(())
    }

    fn form(
        &mut self,
        place: usize,
        step: &Step,
        values: &BTreeMap<usize, Quotient>,
    ) -> Result<Quotient, Stop> {
        let at = |operand: &usize| values.get(operand).ok_or(Missing::Place { place });
        let by_zero = Missing::Refused { place, refusal: Refusal::DivisionByZero };
        Ok(match step {
            Step::Constant(value) => Quotient::from(value.clone()),
            Step::Pi => self.atom(Atom::Pi, None),
            Step::Symbol(name) => match self.part.symbols.get(name) {
                Some(value) => value.clone(),
                None => self.atom(Atom::Symbol(name.clone()), None),
            },
            Step::Add(a, b) => self.field.sum(&[at(a)?.clone(), at(b)?.clone()])?,
            Step::Sub(a, b) => self.field.sum(&[at(a)?.clone(), at(b)?.neg()])?,
            Step::Mul(a, b) => self.field.times(at(a)?, at(b)?)?,
            Step::Div(a, b) => {
                let below = self.field.power(at(b)?, -1)?.ok_or(by_zero)?;
                self.field.times(at(a)?, &below)?
            }
            Step::Neg(a) => at(a)?.neg(),
            Step::Power(a, exponent) => self.field.power(at(a)?, *exponent)?.ok_or(by_zero)?,
            Step::Apply(Function::Sin, a) => self.circular(at(a)?)?.1,
            Step::Apply(Function::Cos, a) => self.circular(at(a)?)?.0,
            Step::Apply(Function::Exp, a) => self.exponential(at(a)?)?,
            Step::Apply(Function::Sqrt, a) => self.root(at(a)?)?,
            Step::Apply(function, a) => self.value(*function, at(a)?)?,
        })
    }

    /// The variable of an atom.
    fn atom(&mut self, atom: Atom, square: Option<IntegerPolynomial>) -> Quotient {
        let variable = match self.known.get(&atom) {
            Some(known) => *known,
            None => {
                let variable = self.field.variable(square);
                if let Atom::Root(inner, _) = &atom {
                    self.field.is_root(variable, inner.clone());
                }
                let inner = atom.variables().into_iter().map(|variable| self.depths[variable as usize]);
                self.depths.push(1 + inner.max().unwrap_or(0));
                self.atoms.push(atom.clone());
                self.known.insert(atom, variable);
                variable
            }
        };
        self.field.quotient(IntegerPolynomial::variable(variable))
    }

    /// The variable of a symbol, whatever it is given by.
    fn symbol(&mut self, name: &str) -> IntegerPolynomial {
        self.atom(Atom::Symbol(name.to_owned()), None);
        IntegerPolynomial::variable(
            self.known.get(&Atom::Symbol(name.to_owned())).copied().unwrap_or_default(),
        )
    }

    fn atom_of(&self, variable: u32) -> Option<&Atom> {
        self.atoms.get(variable as usize)
    }

    /// Whether a variable stands for something in which another one takes part, or is that one.
    fn depends(&self, variable: u32, on: u32) -> bool {
        let (mut open, mut seen) = (vec![variable], HashSet::new());
        while let Some(next) = open.pop() {
            if next == on {
                return true;
            }
            if seen.insert(next) {
                open.extend(self.atom_of(next).map(Atom::variables).unwrap_or_default());
            }
        }
        false
    }

    /// A function of which nothing is known but that equal arguments have equal values.
    fn value(&mut self, function: Function, argument: &Quotient) -> Result<Quotient, Missing> {
        let (above, below) = self.fraction(argument)?;
        Ok(self.atom(Atom::Value(function, above, below), None))
    }

    /// Numerator and denominator, multiplied out, with whole coefficients that have no common divisor with those of the other.
    fn fraction(&self, of: &Quotient) -> Result<(IntegerPolynomial, IntegerPolynomial), Missing> {
        let scaled = |number: IBig, sign: i32| {
            let part = self.field.expanded(&of.powers, sign)?;
            self.field.relations.times(&IntegerPolynomial::constant(number), &part, self.field.effort)
        };
        let above = scaled(of.number.numerator().clone(), 1)?;
        let below = scaled(IBig::from(of.number.denominator().clone()), -1)?;
        Ok((above, below))
    }

    /// The terms of an argument: each a rational multiple of one monomial over the common denominator.
    fn terms(&self, argument: &Quotient) -> Result<Vec<(Term, RBig)>, Missing> {
        let above = self.field.expanded(&argument.powers, 1)?;
        let below = self.field.expanded(&argument.powers, -1)?;
        // each term has the denominator in it
        self.field.effort.spend(4 * (above.terms().len() * below.terms().len()) as u64)?;
        let term = |(monomial, value): &(Monomial, IBig)| {
            ((monomial.clone(), below.clone()), &argument.number * RBig::from(value.clone()))
        };
        Ok(if argument.is_zero() { Vec::new() } else { above.terms().iter().map(term).collect() })
    }

    /// How often a term has the part of it that is taken as an angle.
    fn multiple(&self, term: &Term, value: &RBig) -> Result<i64, Stop> {
        let divisor = self.divisors.get(term).copied().unwrap_or(1);
        let scaled = value * RBig::from(divisor);
        let below = i64::try_from(scaled.denominator().clone()).map_err(|_| Missing::Effort)?;
        if below != 1 {
            let smaller = divisor.checked_mul(below).filter(|smaller| *smaller <= LARGEST_MULTIPLE);
            return Err(Stop::Smaller(term.clone(), smaller.ok_or(Missing::Effort)?));
        }
        let multiple = i64::try_from(scaled.numerator().clone()).ok();
        let multiple = multiple.filter(|multiple| multiple.abs() <= LARGEST_MULTIPLE);
        Ok(multiple.ok_or(Missing::Effort)?)
    }

    /// Cosine and sine.
    fn circular(&mut self, argument: &Quotient) -> Result<Turned, Stop> {
        let one = Quotient::from(RBig::ONE);
        let mut whole = (one, Quotient::from(RBig::ZERO));
        for (term, value) in self.terms(argument)? {
            let given = self.part.angles.iter().find(|(known, _)| *known == term).map(|(_, pair)| *pair);
            let (pair, multiple) = match (self.known_angle(&term, &value)?, given) {
                (Some(known), _) => known,
                (None, Some([cosine, sine])) => {
                    let multiple = self.multiple(&term, &value)?;
                    let number = |value: i32| Quotient::from(RBig::from(value));
                    ((number(cosine), number(sine)), multiple)
                }
                (None, None) => {
                    let multiple = self.multiple(&term, &value)?;
                    let cosine = self.atom(Atom::Cosine(term.clone()), None);
                    let square = self.field.expanded(&self.field.times(&cosine, &cosine)?.powers, 1)?;
                    let mut rest = polynomial::Sum::default();
                    rest.add(Monomial::default(), IBig::ONE);
                    square
                        .terms()
                        .iter()
                        .for_each(|(monomial, value)| rest.add(monomial.clone(), -value.clone()));
                    let sine = self.atom(Atom::Sine(term), Some(rest.finish()));
                    ((cosine, sine), multiple)
                }
            };
            let turned = (pair.0, if multiple < 0 { pair.1.neg() } else { pair.1 });
            for _ in 0..multiple.unsigned_abs() {
                whole = self.turned(&whole, &turned)?;
            }
        }
        Ok(whole)
    }

    /// Cosine and sine of the sum of two angles.
    fn turned(&mut self, a: &Turned, b: &Turned) -> Result<Turned, Missing> {
        let field = &mut self.field;
        let products = [
            field.times(&a.0, &b.0)?,
            field.times(&a.1, &b.1)?,
            field.times(&a.0, &b.1)?,
            field.times(&a.1, &b.0)?,
        ];
        let [cc, ss, cs, sc] = products;
        Ok((field.sum(&[cc, ss.neg()])?, field.sum(&[cs, sc])?))
    }

    /// Cosine and sine of what is known of a term, and how often: twelfths of pi, inverse functions.
    fn known_angle(
        &mut self,
        (monomial, below): &Term,
        value: &RBig,
    ) -> Result<Option<(Turned, i64)>, Missing> {
        let is_one = below.number().is_some_and(|number| number.is_one());
        if let [(a, 1), (b, 1)] = *monomial.powers() {
            let is_turned = [a, b].iter().any(|of| matches!(self.atom_of(*of), Some(Atom::Turns(_))))
                && [a, b].iter().any(|of| matches!(self.atom_of(*of), Some(Atom::Pi)));
            let is_even = (value / RBig::from(2)).denominator().is_one();
            let none = (Quotient::from(RBig::ONE), Quotient::from(RBig::ZERO));
            return Ok((is_one && is_turned && is_even).then_some((none, 0)));
        }
        let [(variable, 1)] = *monomial.powers() else { return Ok(None) };
        if !is_one {
            return Ok(None);
        }
        let whole = |value: &RBig| {
            let number = value.denominator().is_one().then(|| i64::try_from(value.numerator().clone()).ok());
            number.flatten().filter(|number| number.abs() <= LARGEST_MULTIPLE)
        };
        match self.atom_of(variable).cloned() {
            Some(Atom::Pi) => {
                let Some(twelfths) = whole(&(value * RBig::from(12))) else { return Ok(None) };
                let half = Quotient::from(RBig::ONE / RBig::from(2));
                let mut half_root = |of: i32| -> Result<Quotient, Missing> {
                    let root = self.root(&Quotient::from(RBig::from(of)))?;
                    self.field.times(&root, &half)
                };
                let quarter = half_root(2)?;
                let (quarter, third) = ((quarter.clone(), quarter), (half.clone(), half_root(3)?));
                let sixth = (third.1.clone(), third.0.clone());
                let twelfths = twelfths.rem_euclid(24);
                let mut pair = match twelfths % 6 {
                    0 => (Quotient::from(RBig::ONE), Quotient::from(RBig::ZERO)),
                    1 => self.turned(&third, &(quarter.0, quarter.1.neg()))?,
                    2 => sixth,
                    3 => quarter,
                    4 => third,
                    _ => self.turned(&quarter, &sixth)?,
                };
                for _ in 0..twelfths / 6 {
                    pair = (pair.1.neg(), pair.0);
                }
                Ok(Some((pair, 1)))
            }
            Some(Atom::Value(function, above, under)) => {
                let Some(multiple) = whole(value) else { return Ok(None) };
                let (above, under) = (self.field.quotient(above), self.field.quotient(under));
                let under = self.field.power(&under, -1)?;
                let Some(under) = under else { return Ok(None) };
                let of = self.field.times(&above, &under)?;
                let square = self.field.times(&of, &of)?;
                let one = Quotient::from(RBig::ONE);
                let pair = match function {
                    Function::Asin | Function::Acos => {
                        let rest = self.field.sum(&[one, square.neg()])?;
                        let other = self.root(&rest)?;
                        if function == Function::Asin { (other, of) } else { (of, other) }
                    }
                    Function::Atan => {
                        let length = self.field.sum(&[one, square])?;
                        let length = self.root(&length)?;
                        let Some(cosine) = self.field.power(&length, -1)? else { return Ok(None) };
                        (cosine.clone(), self.field.times(&of, &cosine)?)
                    }
                    _ => return Ok(None),
                };
                Ok(Some((pair, multiple)))
            }
            _ => Ok(None),
        }
    }

    fn exponential(&mut self, argument: &Quotient) -> Result<Quotient, Stop> {
        let mut product = Quotient::from(RBig::ONE);
        for (term, value) in self.terms(argument)? {
            let of_logarithm = match *term.0.powers() {
                [(variable, 1)] if term.1.number().is_some_and(|number| number.is_one()) => {
                    match self.atom_of(variable) {
                        Some(Atom::Value(Function::Log, above, below)) => {
                            Some((above.clone(), below.clone()))
                        }
                        _ => None,
                    }
                }
                _ => None,
            };
            let multiple = self.multiple(&term, &value)?;
            let is_whole = !self.divisors.contains_key(&term);
            let base = match of_logarithm {
                Some((above, below)) if is_whole => {
                    let (above, below) = (self.field.quotient(above), self.field.quotient(below));
                    let below = self.field.power(&below, -1)?.ok_or(Missing::Effort)?;
                    self.field.times(&above, &below)?
                }
                _ => self.atom(Atom::Exponential(term), None),
            };
            let power = i32::try_from(multiple).map_err(|_| Missing::Effort)?;
            let power = self.field.power(&base, power)?.ok_or(Missing::Effort)?;
            product = self.field.times(&product, &power)?;
        }
        Ok(product)
    }

    /// A square root: that of a positive number by primes, and one variable whose square is numerator times denominator. Over that denominator it
    /// is the root up to the denominator's sign, which is part of what the variable stands for.
    fn root(&mut self, of: &Quotient) -> Result<Quotient, Missing> {
        if of.is_zero() {
            return Ok(of.clone());
        }
        let above = self.field.expanded(&of.powers, 1)?;
        let below = self.field.expanded(&of.powers, -1)?;
        let product = self.field.relations.times(&above, &below, self.field.effort)?;
        // the root of a number times that of a polynomial, where the number is positive
        let (content, common, rest) = product.content();
        let scale = &of.number * RBig::from(content);
        let size = if scale.is_negative() { -scale.clone() } else { scale.clone() };
        let (number, denominator) = (size.numerator().clone(), IBig::from(size.denominator().clone()));
        let number = UBig::try_from(number * &denominator).map_err(|_| Missing::Effort)?;
        let (root, primes) = square_part(&number);
        let under = Quotient { number: RBig::from(denominator), powers: below_the_bar(of) };
        let under = self.field.power(&under, -1)?.ok_or(Missing::Effort)?;
        let mut found = self.field.times(&Quotient::from(RBig::from(root)), &under)?;
        for prime in primes {
            let square = IntegerPolynomial::constant(IBig::from(prime));
            let one = IntegerPolynomial::constant(IBig::ONE);
            let root = self.atom(Atom::Root(square.clone(), one), Some(square));
            found = self.field.times(&found, &root)?;
        }
        let sign = if scale.is_negative() { IBig::from(-1) } else { IBig::ONE };
        let inner =
            self.field.relations.times(&IntegerPolynomial::term(common, sign), &rest, self.field.effort)?;
        if inner.number().is_some_and(|number| number.is_one()) {
            return Ok(found);
        }
        let odd = of.powers.iter().filter(|(_, power)| **power < 0 && **power % 2 != 0);
        let signed = self.field.expanded(&odd.map(|(factor, _)| (*factor, -1)).collect(), -1)?;
        let root = self.atom(Atom::Root(inner.clone(), signed), Some(inner));
        self.field.times(&found, &root)
    }
}

/// The factors below the bar, with positive powers.
fn below_the_bar(of: &Quotient) -> BTreeMap<u32, i32> {
    of.powers.iter().filter(|(_, power)| **power < 0).map(|(factor, power)| (*factor, -power)).collect()
}
