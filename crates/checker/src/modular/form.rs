//! In what order operations are evaluated where symbols are given by others, and arguments of functions as sums of multiples.

use super::super::listing::{Listing, Step};
use super::GivenSymbols;
use dashu::base::{BitTest, Gcd};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_math::number::Function;
use std::collections::{BTreeMap, HashMap};

/// Parts of a turn are no finer.
const FINEST: u64 = 48;
/// Nor are multiples of one part larger, in all.
const LARGEST: i64 = 200;
/// Nor sums longer.
const LONGEST: usize = 12;
/// Nor factors and numbers in them, in bits: a product of two is as long as both.
const MOST_BITS: usize = 512;

/// An order in which each operation comes behind what it needs, symbols that are given behind what gives them.
pub struct EvaluationOrder(pub Vec<usize>);

impl EvaluationOrder {
    /// Of all that some places need, and of what is given; nothing where something is given by itself.
    pub fn of(listing: &Listing, given: &[(String, usize)], places: &[usize]) -> Option<EvaluationOrder> {
        let steps = listing.steps();
        let by_name: HashMap<&str, usize> =
            given.iter().map(|(name, place)| (name.as_str(), *place)).collect();
        let mut order = Vec::new();
        // not met, open, done
        let mut state = vec![0u8; steps.len()];
        let mut open: Vec<(usize, bool)> = given.iter().map(|(_, place)| (*place, false)).collect();
        open.extend(places.iter().map(|place| (*place, false)));
        // a symbol that is given has to be met to be found in a circle
        let symbols = steps.iter().enumerate();
        open.extend(symbols.filter_map(|(place, step)| match step {
            Step::Symbol(name) if by_name.contains_key(name.as_str()) => Some((place, false)),
            _ => None,
        }));
        while let Some((place, is_behind)) = open.pop() {
            let step = steps.get(place)?;
            if is_behind {
                state[place] = 2;
                order.push(place);
                continue;
            }
            match state[place] {
                2 => continue,
                1 => return None,
                _ => {}
            }
            state[place] = 1;
            open.push((place, true));
            let by = match step {
                Step::Symbol(name) => by_name.get(name.as_str()).copied(),
                _ => None,
            };
            for needed in step.operands().chain(by) {
                match state.get(needed)? {
                    0 => open.push((needed, false)),
                    1 => return None,
                    _ => {}
                }
            }
        }
        Some(EvaluationOrder(order))
    }
}

/// A sum of multiples of operations, of pi and of one, all in the same parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FunctionArgument {
    /// Operations with their multiples of a part.
    pub terms: Vec<(usize, i64)>,
    /// Quarter turns.
    pub quarters: i64,
    /// A multiple of a part of one.
    pub number: i64,
}

/// What a listing needs to be evaluated at random points.
pub struct FunctionForms {
    pub order: Vec<usize>,
    /// The arguments of sines, cosines and exponentials, by the place of the function; multiples are of one part, the same for all.
    pub arguments: HashMap<usize, FunctionArgument>,
    /// The places that give symbols, by the places of these.
    pub given: HashMap<usize, usize>,
}

/// A sum of multiples: of operations, of pi, and a number.
#[derive(Clone, Debug, Default)]
struct Sum {
    terms: BTreeMap<usize, RBig>,
    pi: RBig,
    number: RBig,
}

impl Sum {
    fn of(place: usize) -> Sum {
        Sum { terms: BTreeMap::from([(place, RBig::ONE)]), ..Sum::default() }
    }

    fn is_constant(&self) -> bool {
        self.terms.is_empty() && self.pi.is_zero()
    }

    /// Whether it is short enough to be gone on with.
    fn is_short(&self) -> bool {
        let bits = |value: &RBig| value.numerator().bit_len() + value.denominator().bit_len();
        self.terms.len() <= LONGEST
            && self.terms.values().chain([&self.pi, &self.number]).all(|value| bits(value) <= MOST_BITS)
    }

    fn plus(mut self, other: &Sum, factor: &RBig) -> Sum {
        for (place, value) in &other.terms {
            let sum = self.terms.remove(place).unwrap_or_default() + value * factor;
            if !sum.is_zero() {
                self.terms.insert(*place, sum);
            }
        }
        self.pi += &other.pi * factor;
        self.number += &other.number * factor;
        self
    }
}

impl FunctionForms {
    /// Nothing where a function is met that has no variable of its own: roots and inverse sines have relations.
    pub fn of(listing: &Listing, given: &GivenSymbols, places: &[usize]) -> Option<FunctionForms> {
        let steps = listing.steps();
        let order = EvaluationOrder::of(listing, &given.symbols, places)?.0;
        let by_name: HashMap<&str, usize> =
            given.symbols.iter().map(|(name, place)| (name.as_str(), *place)).collect();
        let mut sums: HashMap<usize, Sum> = HashMap::new();
        let mut by_place = HashMap::new();
        // one name may stand at several places
        let mut first_of: HashMap<&str, usize> = HashMap::new();
        let mut asked: Vec<(usize, Sum)> = Vec::new();
        for place in &order {
            let sum = |at: &usize| sums.get(at).cloned().unwrap_or_else(|| Sum::of(*at));
            let found = match &steps[*place] {
                Step::Constant(value) => Sum { number: value.clone(), ..Sum::default() },
                Step::Pi => Sum { pi: RBig::ONE, ..Sum::default() },
                Step::Symbol(name) => match by_name.get(name.as_str()) {
                    Some(by) => {
                        by_place.insert(*place, *by);
                        sum(by)
                    }
                    None => Sum::of(*first_of.entry(name).or_insert(*place)),
                },
                Step::Add(a, b) => sum(a).plus(&sum(b), &RBig::ONE),
                Step::Sub(a, b) => sum(a).plus(&sum(b), &RBig::from(-1)),
                Step::Neg(a) => Sum::default().plus(&sum(a), &RBig::from(-1)),
                Step::Mul(a, b) => match (sum(a), sum(b)) {
                    (a, b) if a.is_constant() => Sum::default().plus(&b, &a.number),
                    (a, b) if b.is_constant() => Sum::default().plus(&a, &b.number),
                    _ => Sum::of(*place),
                },
                Step::Div(a, b) => match sum(b) {
                    b if b.is_constant() && !b.number.is_zero() => {
                        Sum::default().plus(&sum(a), &(RBig::ONE / b.number))
                    }
                    _ => Sum::of(*place),
                },
                Step::Power(..) => Sum::of(*place),
                Step::Apply(function, a) => {
                    match function {
                        Function::Sin | Function::Cos | Function::Exp => asked.push((*place, sum(a))),
                        Function::Log | Function::Atan => {}
                        Function::Sqrt | Function::Asin | Function::Acos => return None,
                    }
                    Sum::of(*place)
                }
            };
            let found = if found.is_short() { found } else { Sum::of(*place) };
            sums.insert(*place, found);
        }
        let mut parts = UBig::ONE;
        for (_, sum) in &asked {
            for value in sum.terms.values().chain([&sum.number]) {
                let below = value.denominator();
                let common = (&parts).gcd(below);
                parts = parts * below / common;
                if parts > UBig::from(FINEST) {
                    return None;
                }
            }
        }
        let parts = u64::try_from(parts).ok()?;
        let mut arguments = HashMap::new();
        for (place, sum) in asked {
            let whole = |value: &RBig| {
                let multiple = value * RBig::from(parts);
                i64::try_from(IBig::clone(multiple.numerator())).ok().filter(|n| n.abs() <= LARGEST)
            };
            let terms: Option<Vec<(usize, i64)>> =
                sum.terms.iter().map(|(term, value)| Some((*term, whole(value)?))).collect();
            let twice = &sum.pi * RBig::from(2);
            // of other parts of a turn roots would be needed
            if !twice.denominator().is_one()
                || !sum.pi.is_zero() && matches!(steps[place], Step::Apply(Function::Exp, _))
            {
                return None;
            }
            let quarters = i64::try_from(twice.numerator() % IBig::from(4)).ok()?.rem_euclid(4);
            arguments
                .insert(place, FunctionArgument { terms: terms?, quarters, number: whole(&sum.number)? });
        }
        Some(FunctionForms { order, arguments, given: by_place })
    }

    /// The work of one point, in operations.
    pub fn cost(&self) -> u64 {
        let multiples = self.arguments.values().flat_map(|one| &one.terms).map(|(_, n)| n.unsigned_abs());
        // a division takes as much as a hundred products
        self.order.len() as u64 * 100 + multiples.sum::<u64>()
    }
}
