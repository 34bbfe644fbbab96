//! Products and sums as single operations, each computed once; operations on constants are done at once.

use super::flat::{Atom, AtomId, CoefficientId, Flat, Term, UNIT};
use super::sharing::{Factor, Pair, Sharing, factors};
use crate::number::{Bounded, Function, Lanes, rational_to_f64};
use dashu::rational::RBig;
use std::collections::HashMap;

/// A place among [`Operations::all`].
pub(super) type Place = u32;

/// One operation on earlier ones.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operation {
    Input(u32),
    Constant(Bounded<f64>),
    Add(Place, Place),
    Sub(Place, Place),
    Mul(Place, Place),
    /// `1/x`, which is also checked for being finite and not zero.
    Reciprocal(Place),
    /// Sine or cosine.
    Circular(Function, Place),
    /// Any other function.
    Function(Function, Place),
}

impl Operation {
    pub fn operands(self) -> impl Iterator<Item = Place> {
        let (a, b) = match self {
            Operation::Input(_) | Operation::Constant(_) => (None, None),
            Operation::Add(a, b) | Operation::Sub(a, b) | Operation::Mul(a, b) => (Some(a), Some(b)),
            Operation::Reciprocal(a) | Operation::Circular(_, a) | Operation::Function(_, a) => {
                (Some(a), None)
            }
        };
        a.into_iter().chain(b)
    }
}

/// A result: a constant, or an operation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Root {
    Constant(Bounded<f64>),
    Place(Place),
}

/// Operations, operands before what uses them.
#[derive(Default)]
pub(super) struct Operations {
    pub all: Vec<Operation>,
    pub roots: Vec<Root>,
    /// Operations that are computed because they have to be finite, whether or not something needs them.
    pub checked: Vec<Place>,
    /// Whether a constant is needed that does not exist or that no double can hold.
    pub undefined: bool,
}

impl Operations {
    pub fn new(flat: &Flat) -> Operations {
        let needed = Needed::of(flat);
        let sharing = Sharing::new(needed.terms.iter().map(|term| factors(flat, *term)));
        let mut building = Building {
            flat,
            sharing,
            found: Operations::default(),
            atoms: vec![None; flat.atoms.len()],
            reciprocals: HashMap::new(),
            constants: HashMap::new(),
            products: HashMap::new(),
            negatives: HashMap::new(),
        };
        for (atom, wanted) in needed.atoms.iter().enumerate() {
            if *wanted {
                building.add_atom(atom as AtomId);
            }
        }
        let divisors = flat.divisors.iter().map(|atom| Factor::Reciprocal(*atom));
        let functions = flat.functions.iter().map(|atom| Factor::Atom(*atom));
        for factor in divisors.chain(functions) {
            let place = building.factor(factor);
            if building.found.constant(place).is_none() {
                building.found.checked.push(place);
            }
        }
        building.found.roots = flat.roots.iter().map(|root| building.root(*root)).collect();
        building.found.undefined |= flat.undefined;
        building.found
    }

    fn constant(&self, place: Place) -> Option<Bounded<f64>> {
        match self.all[place as usize] {
            Operation::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// Adds an operation; one on constants is done at once.
    fn push(&mut self, operation: Operation) -> Place {
        let operation = self.folded(operation).unwrap_or(operation);
        if let Operation::Constant(Bounded { value, .. }) = operation {
            self.undefined |= !value.is_finite() || value.is_subnormal();
        }
        self.all.push(operation);
        self.all.len() as Place - 1
    }

    fn folded(&self, operation: Operation) -> Option<Operation> {
        let value = match operation {
            Operation::Input(_) | Operation::Constant(_) => return None,
            Operation::Add(a, b) => self.constant(a)? + self.constant(b)?,
            Operation::Sub(a, b) => self.constant(a)? - self.constant(b)?,
            Operation::Mul(a, b) => self.constant(a)? * self.constant(b)?,
            Operation::Reciprocal(a) => Bounded::exact(1.0) / self.constant(a)?,
            Operation::Circular(Function::Sin, a) => self.constant(a)?.sin_cos().0,
            Operation::Circular(_, a) => self.constant(a)?.sin_cos().1,
            Operation::Function(Function::Sqrt, a) => self.constant(a)?.sqrt(),
            Operation::Function(function, a) => self.constant(a)?.apply(function),
        };
        Some(Operation::Constant(value))
    }
}

/// The double nearest to a rational, and how far it may be from it.
fn rounded(value: &RBig) -> Bounded<f64> {
    let nearest = rational_to_f64(value);
    let exact = RBig::try_from(nearest).is_ok_and(|back| back == *value);
    // what is too small for a double has no value here
    let lost = nearest == 0.0 && !exact;
    Bounded { value: if lost { f64::NAN } else { nearest }, units: if exact { 0.0 } else { nearest.abs() } }
}

/// What has to be computed.
struct Needed {
    atoms: Vec<bool>,
    /// Magnitudes of coefficients with products, each once, in the order in which they are met.
    terms: Vec<Term>,
}

impl Needed {
    fn of(flat: &Flat) -> Needed {
        let mut atoms = vec![false; flat.atoms.len()];
        let mut terms: Vec<Term> = flat.roots.clone();
        for atom in flat.divisors.iter().chain(&flat.functions) {
            atoms[*atom as usize] = true;
        }
        let mark = |atoms: &mut Vec<bool>, term: &Term| {
            for (atom, _) in &flat.products[term.product as usize] {
                atoms[*atom as usize] = true;
            }
        };
        for term in &flat.roots {
            mark(&mut atoms, term);
        }
        // an atom's own products hold only earlier atoms
        for place in (0..flat.atoms.len()).rev() {
            if !atoms[place] {
                continue;
            }
            let (a, b) = match flat.atoms[place] {
                Atom::Input(_) | Atom::Pi | Atom::Rational(_) => (None, None),
                Atom::Sum(a, b) => (Some(a), Some(b)),
                Atom::Function(_, a) => (Some(a), None),
                Atom::Whole(product) => (Some(Term { coefficient: UNIT, product }), None),
            };
            for term in a.into_iter().chain(b) {
                mark(&mut atoms, &term);
                terms.push(term);
            }
        }
        Needed { atoms, terms }
    }
}

struct Building<'f> {
    flat: &'f Flat,
    sharing: Sharing,
    found: Operations,
    atoms: Vec<Option<Place>>,
    reciprocals: HashMap<AtomId, Place>,
    constants: HashMap<CoefficientId, Place>,
    products: HashMap<Pair, Place>,
    negatives: HashMap<Place, Place>,
}

impl Building<'_> {
    fn add_atom(&mut self, atom: AtomId) -> Place {
        let operation = match self.flat.atoms[atom as usize] {
            Atom::Input(input) => Operation::Input(input),
            Atom::Pi => {
                let pi = std::f64::consts::PI;
                Operation::Constant(Bounded { value: pi, units: pi })
            }
            Atom::Rational(value) => Operation::Constant(rounded(&self.flat.coefficients[value as usize])),
            Atom::Sum(a, b) => {
                let (x, y) = (self.magnitude(a), self.magnitude(b));
                match (self.is_negative(a), self.is_negative(b)) {
                    (false, false) => Operation::Add(x, y),
                    (false, true) => Operation::Sub(x, y),
                    (true, false) => Operation::Sub(y, x),
                    (true, true) => {
                        let sum = self.found.push(Operation::Add(x, y));
                        Operation::Sub(self.zero(), sum)
                    }
                }
            }
            Atom::Function(function, a) => {
                let x = self.signed(a);
                match function {
                    Function::Sin | Function::Cos => Operation::Circular(function, x),
                    _ => Operation::Function(function, x),
                }
            }
            Atom::Whole(product) => {
                let place = self.magnitude(Term { coefficient: UNIT, product });
                self.atoms[atom as usize] = Some(place);
                return place;
            }
        };
        let place = self.found.push(operation);
        self.atoms[atom as usize] = Some(place);
        place
    }

    fn is_negative(&self, term: Term) -> bool {
        self.flat.magnitudes[term.coefficient as usize].0
    }

    fn zero(&mut self) -> Place {
        self.factor(Factor::Constant(0))
    }

    fn factor(&mut self, factor: Factor) -> Place {
        match factor {
            Factor::Constant(id) => {
                if let Some(known) = self.constants.get(&id) {
                    return *known;
                }
                let value = rounded(&self.flat.coefficients[id as usize]);
                let place = self.found.push(Operation::Constant(value));
                self.constants.insert(id, place);
                place
            }
            Factor::Atom(atom) => match self.atoms[atom as usize] {
                Some(place) => place,
                None => self.add_atom(atom),
            },
            Factor::Reciprocal(atom) => {
                if let Some(known) = self.reciprocals.get(&atom) {
                    return *known;
                }
                let value = self.factor(Factor::Atom(atom));
                let place = self.found.push(Operation::Reciprocal(value));
                self.reciprocals.insert(atom, place);
                place
            }
            Factor::Pair(pair) => {
                let (a, b) = self.sharing.pairs[pair as usize];
                if let Some(known) = self.products.get(&(a, b)) {
                    return *known;
                }
                let (x, y) = (self.factor(a), self.factor(b));
                let place = self.found.push(Operation::Mul(x, y));
                self.products.insert((a, b), place);
                place
            }
        }
    }

    /// A term without its sign.
    fn magnitude(&mut self, term: Term) -> Place {
        let factors = factors(self.flat, term);
        let whole = self.sharing.whole.get(&factors).copied();
        self.factor(whole.unwrap_or(Factor::Constant(UNIT)))
    }

    fn signed(&mut self, term: Term) -> Place {
        let place = self.magnitude(term);
        if !self.is_negative(term) {
            return place;
        }
        if let Some(known) = self.negatives.get(&place) {
            return *known;
        }
        let zero = self.zero();
        let negative = self.found.push(Operation::Sub(zero, place));
        self.negatives.insert(place, negative);
        negative
    }

    fn root(&mut self, term: Term) -> Root {
        let place = self.signed(term);
        self.found.constant(place).map_or(Root::Place(place), Root::Constant)
    }
}
