//! Polynomials with rational coefficients in numbered variables, as maps from powers: nothing is factored, nothing is shared.

use dashu::rational::RBig;
use std::collections::BTreeMap;

/// The powers of the variables of a term.
type Powers = Vec<u8>;

/// A polynomial in so many variables as each of its terms has powers.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Polynomial(BTreeMap<Powers, RBig>);

impl Polynomial {
    pub fn constant(value: RBig, variables: usize) -> Polynomial {
        let mut found = Polynomial::default();
        found.add_term(vec![0; variables], value);
        found
    }

    pub fn variable(place: usize, variables: usize) -> Polynomial {
        let mut powers = vec![0; variables];
        powers[place] = 1;
        let mut found = Polynomial::default();
        found.add_term(powers, RBig::ONE);
        found
    }

    fn add_term(&mut self, powers: Powers, value: RBig) {
        let sum = self.0.remove(&powers).unwrap_or(RBig::ZERO) + value;
        if !sum.is_zero() {
            self.0.insert(powers, sum);
        }
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// How many terms there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn plus(&self, other: &Polynomial) -> Polynomial {
        let mut found = self.clone();
        other.0.iter().for_each(|(powers, value)| found.add_term(powers.clone(), value.clone()));
        found
    }

    pub fn times(&self, other: &Polynomial) -> Polynomial {
        let mut found = Polynomial::default();
        for (left, a) in &self.0 {
            for (right, b) in &other.0 {
                let powers = left.iter().zip(right).map(|(m, n)| m + n).collect();
                found.add_term(powers, a * b);
            }
        }
        found
    }

    pub fn scaled(&self, by: &RBig) -> Polynomial {
        let mut found = Polynomial::default();
        self.0.iter().for_each(|(powers, value)| found.add_term(powers.clone(), value * by));
        found
    }

    /// The derivative by one variable.
    pub fn slope(&self, place: usize) -> Polynomial {
        let mut found = Polynomial::default();
        for (powers, value) in self.0.iter().filter(|(powers, _)| powers[place] > 0) {
            let mut lower = powers.clone();
            lower[place] -= 1;
            found.add_term(lower, value * RBig::from(powers[place]));
        }
        found
    }

    /// The value where the variables have these.
    pub fn at(&self, values: &[RBig]) -> RBig {
        let term = |(powers, value): (&Powers, &RBig)| {
            let factors = powers.iter().zip(values).filter(|(power, _)| **power > 0);
            factors.fold(value.clone(), |product, (power, x)| product * x.pow(isize::from(*power)))
        };
        self.0.iter().map(term).fold(RBig::ZERO, |sum, term| sum + term)
    }

    /// As a proof file writes it, the variables by these names.
    pub fn text(&self, names: &[String]) -> String {
        let term = |(powers, value): (&Powers, &RBig)| {
            let mut factors = vec![format!("({value})")];
            for (name, power) in names.iter().zip(powers).filter(|(_, power)| **power > 0) {
                factors.push(if *power == 1 { name.clone() } else { format!("{name}^{power}") });
            }
            if factors.len() > 1 && value == &RBig::ONE {
                factors.remove(0);
            }
            factors.join("*")
        };
        let terms: Vec<String> = self.0.iter().map(term).collect();
        if terms.is_empty() { "0".to_owned() } else { terms.join(" + ") }
    }
}

/// The rank of rows, and whether each of some unit rows lies in their span.
pub fn rank(rows: &[Vec<RBig>]) -> usize {
    let mut basis = Basis::default();
    rows.iter().filter(|row| basis.insert((*row).clone())).count()
}

/// Rows in echelon form.
#[derive(Clone, Debug, Default)]
pub struct Basis(Vec<(usize, Vec<RBig>)>);

impl Basis {
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Takes a row in; whether it was no combination of the others.
    pub fn insert(&mut self, mut row: Vec<RBig>) -> bool {
        for (lead, own) in &self.0 {
            if !row[*lead].is_zero() {
                let factor = row[*lead].clone();
                row.iter_mut().zip(own).for_each(|(entry, own)| *entry = &*entry - &factor * own);
            }
        }
        let Some(lead) = row.iter().position(|entry| !entry.is_zero()) else { return false };
        let factor = row[lead].clone();
        row.iter_mut().for_each(|entry| *entry = &*entry / &factor);
        self.0.push((lead, row));
        true
    }
}

/// The difference of the sides of `a = b` or `a != b`, as the library prints it; none where it is no polynomial of sines, cosines and names.
pub fn read_equation(text: &str, names: &[String]) -> Option<Polynomial> {
    let (left, right) = text.split_once("!=").or_else(|| text.split_once('='))?;
    let side = |text: &str| {
        let mut reader = Reader { rest: text.trim(), names };
        let found = reader.sum()?;
        reader.rest.trim().is_empty().then_some(found)
    };
    Some(side(left)?.plus(&side(right)?.scaled(&RBig::from(-1))))
}

struct Reader<'a> {
    rest: &'a str,
    names: &'a [String],
}

impl Reader<'_> {
    fn sign(&mut self, sign: &str) -> bool {
        match self.rest.trim_start().strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn sum(&mut self) -> Option<Polynomial> {
        let mut found = self.product()?;
        loop {
            if self.sign("+") {
                found = found.plus(&self.product()?);
            } else if self.sign("-") {
                found = found.plus(&self.product()?.scaled(&RBig::from(-1)));
            } else {
                return Some(found);
            }
        }
    }

    fn product(&mut self) -> Option<Polynomial> {
        if self.sign("-") {
            return Some(self.product()?.scaled(&RBig::from(-1)));
        }
        let mut found = self.power()?;
        loop {
            if self.sign("*") {
                found = found.times(&self.power()?);
            } else if self.sign("/") {
                found = found.scaled(&(RBig::ONE / RBig::from(self.whole()?)));
            } else {
                return Some(found);
            }
        }
    }

    fn power(&mut self) -> Option<Polynomial> {
        let base = match self.sign("(") {
            true => {
                let inner = self.sum()?;
                self.sign(")").then_some(inner)?
            }
            false => self.name_or_number()?,
        };
        if !self.sign("^") {
            return Some(base);
        }
        let power = self.whole()?;
        Some((1..power).fold(base.clone(), |product, _| product.times(&base)))
    }

    fn whole(&mut self) -> Option<u32> {
        let rest = self.rest.trim_start();
        let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        self.rest = &rest[end..];
        rest[..end].parse().ok().filter(|n| *n > 0)
    }

    fn name_or_number(&mut self) -> Option<Polynomial> {
        let all = self.names.len();
        let rest = self.rest.trim_start();
        let longest = self.names.iter().enumerate().filter(|(_, name)| rest.starts_with(name.as_str()));
        if let Some((place, name)) = longest.max_by_key(|(_, name)| name.len()) {
            self.rest = &rest[name.len()..];
            return Some(Polynomial::variable(place, all));
        }
        if let Some(behind) = rest.strip_prefix('0') {
            self.rest = behind;
            return Some(Polynomial::default());
        }
        Some(Polynomial::constant(RBig::from(self.whole()?), all))
    }
}

#[test]
fn by_hand() {
    let names = ["x".to_owned(), "y".to_owned()];
    let (x, y) = (Polynomial::variable(0, 2), Polynomial::variable(1, 2));
    // (x + y)(x - y) = x^2 - y^2
    let product = x.plus(&y).times(&x.plus(&y.scaled(&RBig::from(-1))));
    assert_eq!(product.text(&names), "(-1)*y^2 + x^2");
    assert_eq!(product.at(&[RBig::from(3), RBig::from(2)]), RBig::from(5));
    assert_eq!(product.slope(1).text(&names), "(-2)*y");
    assert!(product.slope(0).slope(1).is_zero());
    assert_eq!(read_equation("x^2 = y*y", &names), Some(product));
    assert_eq!(
        read_equation("(x - 1/2)*2 != 0", &names).map(|p| p.text(&names)),
        Some("(-1) + (2)*x".to_owned())
    );
    assert_eq!(read_equation("exp(x) = 0", &names), None);
    let number = |n: i64| RBig::from(n);
    assert_eq!(
        rank(&[vec![number(1), number(2)], vec![number(2), number(4)], vec![number(0), number(0)]]),
        1
    );
}
