//! How large a numerator can be: its degree, and the bits of the sum of its coefficients' magnitudes.
//!
//! A value is a numerator over powers of what was divided by; over a common denominator each is counted once.

use super::super::listing::{Listing, Step};
use super::form::FunctionForms;
use palmistry_math::number::Function;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A polynomial: its degree plus the bits of its coefficients.
type Size = f64;

/// What stands below: the numerator of a divisor, one and the square of a tangent, an exponential.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Below {
    Divisor(usize),
    Circle(usize),
    Exponential(usize),
}

/// The size of a numerator, and what stands below it.
#[derive(Clone, Debug, Default)]
struct Value {
    size: Size,
    below: BTreeMap<Below, f64>,
    /// The bits of a denominator that is a number.
    scale: f64,
}

/// The sizes of all values of a listing.
pub struct NumeratorBounds {
    values: HashMap<usize, Value>,
    sizes: HashMap<usize, Size>,
    /// How likely two arguments of functions that differ are taken for one, in the same measure: for each pair the numerator of a difference.
    confused: Size,
}

/// Where something is larger nothing is known of it.
const LARGEST: f64 = 1e15;
/// Nor where it has more divisors: each value has a list of its own.
const MOST_DIVISORS: usize = 200;

impl NumeratorBounds {
    pub fn of(listing: &Listing, forms: &FunctionForms) -> NumeratorBounds {
        let mut all = NumeratorBounds { values: HashMap::new(), sizes: HashMap::new(), confused: 0.0 };
        for place in &forms.order {
            let value = all.value(&listing.steps()[*place], *place, forms);
            all.values.insert(*place, value);
        }
        let mut arguments: BTreeSet<usize> =
            forms.arguments.values().flat_map(|argument| &argument.terms).map(|(term, _)| *term).collect();
        arguments.extend(forms.order.iter().filter_map(|place| match &listing.steps()[*place] {
            Step::Apply(Function::Log | Function::Atan, argument) => Some(*argument),
            _ => None,
        }));
        let size = |place: &usize| {
            let value = all.at(*place);
            value.size + value.scale + all.missing(&value.below, &BTreeMap::new())
        };
        let largest = arguments.iter().map(size).fold(0.0, f64::max);
        all.confused = 2.0 * largest * (arguments.len() as f64).powi(2);
        all
    }

    /// The numerator of a difference.
    pub fn of_difference(&self, left: usize, right: usize) -> Size {
        let (left, right) = (self.at(left), self.at(right));
        self.sum(&left, &right).size + self.confused
    }

    /// The largest numerator of a minor of so many rows.
    pub fn of_minors(&self, rows: &[Vec<usize>], count: usize) -> Size {
        let of_row = |row: &Vec<usize>| {
            let entries: Vec<Value> = row.iter().map(|place| self.at(*place)).collect();
            let common = entries.iter().fold(BTreeMap::new(), |common, entry| largest(common, &entry.below));
            let scale: f64 = entries.iter().map(|entry| entry.scale).sum();
            entries
                .iter()
                .map(|entry| entry.size + self.missing(&common, &entry.below) + scale)
                .fold(0.0, f64::max)
        };
        let mut sizes: Vec<Size> = rows.iter().map(of_row).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        sizes.iter().take(count).sum::<f64>() + (count as f64) * (1.0 + count as f64).log2() + self.confused
    }

    fn at(&self, place: usize) -> Value {
        self.values.get(&place).cloned().unwrap_or(Value { size: f64::INFINITY, ..Value::default() })
    }

    fn size_of(&self, below: Below) -> Size {
        match below {
            Below::Divisor(place) => self.sizes.get(&place).copied().unwrap_or(f64::INFINITY),
            // one and a square: of degree two, with coefficients one and one
            Below::Circle(_) => 3.0,
            Below::Exponential(_) => 1.0,
        }
    }

    /// What one denominator has more than another.
    fn missing(&self, common: &BTreeMap<Below, f64>, below: &BTreeMap<Below, f64>) -> Size {
        let more = |(one, power): (&Below, &f64)| power - below.get(one).copied().unwrap_or(0.0);
        common.iter().map(|entry| more(entry) * self.size_of(*entry.0)).sum()
    }

    fn sum(&self, a: &Value, b: &Value) -> Value {
        let below = largest(a.below.clone(), &b.below);
        let [from_a, from_b] = [
            a.size + self.missing(&below, &a.below) + b.scale,
            b.size + self.missing(&below, &b.below) + a.scale,
        ];
        Value { size: from_a.max(from_b) + 1.0, below, scale: a.scale + b.scale }
    }

    fn product(&self, a: &Value, b: &Value) -> Value {
        let mut below = a.below.clone();
        for (one, power) in &b.below {
            *below.entry(*one).or_default() += power;
        }
        Value { size: a.size + b.size, below, scale: a.scale + b.scale }
    }

    /// The reciprocal of an operation.
    fn reciprocal(&mut self, place: usize) -> Value {
        let of = self.at(place);
        self.sizes.insert(place, of.size);
        let size = of.scale + of.below.iter().map(|(one, power)| power * self.size_of(*one)).sum::<f64>();
        Value { size, below: BTreeMap::from([(Below::Divisor(place), 1.0)]), scale: 0.0 }
    }

    fn power(&self, value: &Value, n: f64) -> Value {
        let below = value.below.iter().map(|(one, power)| (*one, power * n)).collect();
        Value { size: value.size * n, below, scale: value.scale * n }
    }

    fn value(&mut self, step: &Step, place: usize, forms: &FunctionForms) -> Value {
        let variable = Value { size: 1.0, ..Value::default() };
        let found = match step {
            Step::Constant(number) => {
                use dashu::base::BitTest;
                let bits = |n: usize| n as f64 + 1.0;
                let scale =
                    if number.denominator().is_one() { 0.0 } else { bits(number.denominator().bit_len()) };
                Value { size: bits(number.numerator().bit_len()), scale, ..Value::default() }
            }
            Step::Pi => variable,
            Step::Symbol(_) => match forms.given.get(&place) {
                Some(by) => self.at(*by),
                None => variable,
            },
            Step::Add(a, b) | Step::Sub(a, b) => self.sum(&self.at(*a), &self.at(*b)),
            Step::Mul(a, b) => self.product(&self.at(*a), &self.at(*b)),
            Step::Div(a, b) => {
                let reciprocal = self.reciprocal(*b);
                self.product(&self.at(*a), &reciprocal)
            }
            Step::Neg(a) => self.at(*a),
            Step::Power(a, n) if *n >= 0 => self.power(&self.at(*a), f64::from(*n)),
            Step::Power(a, n) => {
                let reciprocal = self.reciprocal(*a);
                self.power(&reciprocal, f64::from(n.unsigned_abs()))
            }
            Step::Apply(Function::Sin | Function::Cos, _) => {
                let mut value = Value { size: 1.0, ..Value::default() };
                for (term, multiple) in terms(forms, place) {
                    // (1 + i t)^2, of degree two, with four as the sum of its coefficients
                    value.size += 4.0 * multiple;
                    *value.below.entry(Below::Circle(term)).or_default() += multiple;
                }
                value
            }
            Step::Apply(Function::Exp, _) => {
                let mut value = Value { size: 1.0, ..Value::default() };
                for (term, multiple) in terms(forms, place) {
                    value.size += multiple;
                    *value.below.entry(Below::Exponential(term)).or_default() += multiple;
                }
                value
            }
            Step::Apply(..) => variable,
        };
        // beyond all bounds differences of bounds would be no numbers
        let is_small = found.size < LARGEST
            && found.below.len() <= MOST_DIVISORS
            && found.below.values().all(|power| *power < LARGEST);
        if is_small { found } else { Value { size: LARGEST, below: BTreeMap::new(), scale: LARGEST } }
    }
}

/// The terms of an argument, the one behind all places, with their multiples.
fn terms(forms: &FunctionForms, place: usize) -> impl Iterator<Item = (usize, f64)> {
    let argument = forms.arguments.get(&place).cloned().unwrap_or_default();
    let number = (argument.number != 0).then_some((usize::MAX, argument.number));
    argument.terms.into_iter().chain(number).map(|(term, multiple)| (term, multiple.unsigned_abs() as f64))
}

fn largest(mut common: BTreeMap<Below, f64>, other: &BTreeMap<Below, f64>) -> BTreeMap<Below, f64> {
    for (one, power) in other {
        let known = common.entry(*one).or_default();
        *known = known.max(*power);
    }
    common
}
