//! Vector fields in symbols that lie in the kernel: with constant components, scalings, of low degree, of low degree over a
//! common denominator. Each is a solution of linear equations at random points modulo a prime, and proved elsewhere.

use super::ATTEMPTS;
use super::kernel::{Block, Kernel, KernelSource, Point};
use super::modular::{Echelon, in_integers, rank, simple_vectors};
use super::monomial::{Monomial, Polynomial, count, in_brackets, monomials, polynomial_text, value};
use palmistry_math::expression::{Graph, SymbolFunction, SymbolInput};
use rand_chacha::ChaCha8Rng;

/// A component of a field: the column that it belongs to, a numerator, and a denominator where there is one.
#[derive(Clone, Debug)]
pub(super) struct Component {
    pub column: usize,
    pub top: Polynomial,
    pub bottom: Option<Polynomial>,
}

/// A vector field whose components are fractions of polynomials; the others are zero.
#[derive(Clone, Debug)]
pub(super) struct FieldTerms {
    pub components: Vec<Component>,
}

/// No more unknown coefficients than this are solved for at once.
const MOST_UNKNOWNS: usize = 420;
/// Polynomials of no higher degree are tried.
const HIGHEST_DEGREE: usize = 3;

/// What was found of one block.
pub(super) struct BlockFields {
    /// Independent over functions; as many as the kernel has dimensions, where all were found.
    pub fields: Vec<FieldTerms>,
    /// Whether something was left untried because it has too many unknown coefficients.
    pub cut_off: bool,
}

impl Component {
    /// In the notation of the language.
    pub fn text(&self, graph: &Graph, variables: &[SymbolInput]) -> String {
        let top = polynomial_text(graph, variables, &self.top);
        match &self.bottom {
            None => top,
            Some(bottom) => {
                let bottom = polynomial_text(graph, variables, bottom);
                match bottom.contains(['*', ' ']) {
                    true => format!("{}/({bottom})", in_brackets(top)),
                    false => format!("{}/{bottom}", in_brackets(top)),
                }
            }
        }
    }
}

impl FieldTerms {
    /// The components at a point, in so many columns; none at a pole.
    pub fn at(&self, source: &KernelSource, point: &Point, columns: usize) -> Option<Vec<u64>> {
        let mut vector = vec![0; columns];
        for part in &self.components {
            let top = value(&part.top, source, point);
            vector[part.column] = match &part.bottom {
                None => top,
                Some(bottom) => {
                    let bottom = source.residues.0.inverse(value(bottom, source, point))?;
                    source.residues.mul(top, bottom)
                }
            };
        }
        Some(vector)
    }

    /// The exponents `w` of a field `sum w_i x_i d/dx_i`, as column and weight; none for any other field.
    pub fn weights(&self, source: &KernelSource) -> Option<Vec<(usize, i64)>> {
        let weight = |part: &Component| match (part.top.as_slice(), &part.bottom) {
            ([(monomial, weight)], None) => {
                let own = own_variable(source, part.column)?;
                (*monomial == Monomial::variable(own)).then_some((part.column, *weight))
            }
            _ => None,
        };
        self.components.iter().map(weight).collect()
    }
}

/// The variable that a column's coordinate is; none for an angle.
fn own_variable(source: &KernelSource, column: usize) -> Option<usize> {
    let symbol = source.coordinate(column);
    source.variables.iter().position(|v| v.symbol == symbol && v.function == SymbolFunction::Itself)
}

/// The fields of one block of the kernel, simplest first.
pub(super) fn fields_of_block(
    source: &KernelSource,
    block: &Block,
    free: &[usize],
    rng: &mut ChaCha8Rng,
) -> BlockFields {
    let mut search = Search { source, block, free, chosen: Vec::new(), cut_off: false };
    search.polynomials(rng);
    if !search.is_complete() {
        search.fractions(rng);
    }
    BlockFields { fields: search.chosen, cut_off: search.cut_off }
}

struct Search<'a> {
    source: &'a KernelSource,
    block: &'a Block,
    /// The free columns of the whole kernel.
    free: &'a [usize],
    chosen: Vec<FieldTerms>,
    cut_off: bool,
}

impl Search<'_> {
    fn is_complete(&self) -> bool {
        self.chosen.len() >= self.block.free.len()
    }

    /// Translations, scalings, then all polynomials of a degree at a time.
    fn polynomials(&mut self, rng: &mut ChaCha8Rng) {
        let constants: Vec<(usize, Monomial)> =
            self.block.columns.iter().map(|column| (*column, Monomial::default())).collect();
        self.try_terms(&constants, rng);
        let scaling =
            |column: &usize| Some((*column, Monomial::variable(own_variable(self.source, *column)?)));
        let scalings: Vec<(usize, Monomial)> = self.block.columns.iter().filter_map(scaling).collect();
        self.try_terms(&scalings, rng);
        let mut terms = constants;
        for degree in 1..=HIGHEST_DEGREE {
            if self.is_complete() {
                return;
            }
            let unknowns = self.block.columns.len() * count(self.block.variables(self.source).len(), degree);
            if unknowns > MOST_UNKNOWNS {
                self.cut_off = true;
                return;
            }
            for monomial in monomials(self.source, self.block.variables(self.source), degree) {
                terms.extend(self.block.columns.iter().map(|column| (*column, monomial.clone())));
            }
            self.try_terms(&terms, rng);
        }
    }

    /// Fields that are combinations, with constant coefficients, of these terms: a column and what stands there.
    fn try_terms(&mut self, terms: &[(usize, Monomial)], rng: &mut ChaCha8Rng) {
        if self.is_complete() || terms.is_empty() || terms.len() > MOST_UNKNOWNS {
            return;
        }
        let Some(solutions) = self.solutions(terms, rng) else { return };
        let own = |place: usize| {
            let (column, monomial) = &terms[place];
            let is_own = own_variable(self.source, *column)
                .is_some_and(|variable| monomial.powers.iter().any(|(of, _)| *of == variable));
            4 * monomial.degree() as u64 + u64::from(!is_own)
        };
        let mut emptied: Vec<usize> = (0..terms.len()).collect();
        emptied.sort_by_key(|place| std::cmp::Reverse(own(*place)));
        let mut found: Vec<(usize, Vec<i64>)> =
            simple_vectors(self.source.residues, &solutions, &own, &emptied)
                .iter()
                .filter_map(|vector| in_integers(self.source.residues, vector))
                .map(|vector| {
                    let used = || vector.iter().zip(terms).filter(|(c, _)| **c != 0);
                    (used().map(|(_, (_, monomial))| monomial.degree()).max().unwrap_or(0), vector)
                })
                .collect();
        // low degree, few terms, small numbers
        found.sort_by_cached_key(|(degree, vector)| {
            let size: u64 = vector.iter().map(|c| c.unsigned_abs()).fold(0, u64::saturating_add);
            (*degree, vector.iter().filter(|c| **c != 0).count(), size, vector.clone())
        });
        for (_, vector) in found {
            let mut components: Vec<Component> = Vec::new();
            for column in &self.block.columns {
                let top: Polynomial = terms
                    .iter()
                    .zip(&vector)
                    .filter(|((of, _), coefficient)| of == column && **coefficient != 0)
                    .map(|((_, monomial), coefficient)| (monomial.clone(), *coefficient))
                    .collect();
                if !top.is_empty() {
                    components.push(Component { column: *column, top, bottom: None });
                }
            }
            self.choose(FieldTerms { components }, rng);
        }
    }

    /// Takes a field that is independent of those chosen, over functions.
    fn choose(&mut self, field: FieldTerms, rng: &mut ChaCha8Rng) {
        if self.is_complete() {
            return;
        }
        // any point at which the fields have values: the kernel there is not needed
        let at_one_point = |_| {
            let point = self.source.draw(rng);
            let all = self.chosen.iter().chain([&field]);
            all.map(|field| field.at(self.source, &point, self.source.columns())).collect::<Option<Vec<_>>>()
        };
        let Some(rows) = (0..ATTEMPTS).find_map(at_one_point) else { return };
        if rank(self.source.residues, &rows) == rows.len() {
            self.chosen.push(field);
        }
    }

    /// The coefficients with which a combination of terms lies in the kernel at all points.
    fn solutions(&self, terms: &[(usize, Monomial)], rng: &mut ChaCha8Rng) -> Option<Vec<Vec<u64>>> {
        let r = self.source.residues;
        let mut echelon = Echelon::new(r, terms.len());
        let mut idle = 0;
        // a point that adds nothing is one at which all that is left holds; another one makes sure
        while idle < 2 && echelon.rank() < terms.len() {
            let (point, kernel) = self.source.sample(Some(self.free), rng)?;
            let values: Vec<u64> =
                terms.iter().map(|(_, monomial)| monomial.value(self.source, &point)).collect();
            let before = echelon.rank();
            for column in self.block.columns.iter().filter(|column| !self.block.free.contains(column)) {
                let factor = |of: usize| match of == *column {
                    true => r.one(),
                    false => r.neg(entry(&kernel, of, *column)),
                };
                let row = terms.iter().zip(&values).map(|((of, _), value)| r.mul(factor(*of), *value));
                echelon.add(row.collect());
            }
            idle = if echelon.rank() == before { idle + 1 } else { 0 };
        }
        Some(echelon.kernel().1)
    }

    /// The basis with a one at each free column, whose other components are fractions of low degree.
    fn fractions(&mut self, rng: &mut ChaCha8Rng) {
        for free in &self.block.free {
            let mut components = Vec::new();
            for column in self.block.columns.iter().filter(|column| !self.block.free.contains(column)) {
                match self.fraction(*free, *column, rng) {
                    Some(Fraction { top, .. }) if top.is_empty() => {}
                    Some(Fraction { top, bottom }) => {
                        components.push(Component { column: *column, top, bottom: Some(bottom) });
                    }
                    None => return,
                }
            }
            // over one denominator, where it is one
            let one: Polynomial = vec![(Monomial::default(), 1)];
            let first = components.first().and_then(|part| part.bottom.clone()).unwrap_or(one.clone());
            let common = components.iter().all(|part| part.bottom.as_ref() == Some(&first));
            if common {
                components.iter_mut().for_each(|part| part.bottom = None);
            }
            let top = if common { first } else { one };
            components.push(Component { column: *free, top, bottom: None });
            components.sort_by_key(|part| part.column);
            self.choose(FieldTerms { components }, rng);
        }
    }

    /// One component of that basis, as a fraction.
    fn fraction(&mut self, free: usize, column: usize, rng: &mut ChaCha8Rng) -> Option<Fraction> {
        let (source, r) = (self.source, self.source.residues);
        let (point, kernel) = source.sample(Some(self.free), rng)?;
        let here = entry(&kernel, free, column);
        if here == 0 {
            return Some(Fraction { top: Vec::new(), bottom: Vec::new() });
        }
        let changes = |variable: &&usize, rng: &mut ChaCha8Rng| {
            let moved = source.redraw(&point, source.variables[**variable].symbol, rng);
            source
                .kernel(&moved)
                .is_none_or(|there| there.free != kernel.free || entry(&there, free, column) != here)
        };
        let variables: Vec<usize> =
            self.block.variables(source).iter().filter(|variable| changes(variable, rng)).copied().collect();
        let mut all: Vec<Monomial> = vec![Monomial::default()];
        for degree in 1..=HIGHEST_DEGREE {
            if 2 * count(variables.len(), degree) > MOST_UNKNOWNS {
                self.cut_off = true;
                return None;
            }
            all.extend(monomials(source, &variables, degree));
            let mut echelon = Echelon::new(r, 2 * all.len());
            let mut idle = 0;
            while idle < 2 && echelon.rank() < 2 * all.len() {
                let (point, kernel) = source.sample(Some(self.free), rng)?;
                let values: Vec<u64> = all.iter().map(|monomial| monomial.value(source, &point)).collect();
                let back = r.neg(entry(&kernel, free, column));
                let row = values.iter().copied().chain(values.iter().map(|value| r.mul(*value, back)));
                idle = if echelon.add(row.collect()) { 0 } else { idle + 1 };
            }
            let basis = echelon.kernel().1;
            let weight = |place: usize| all[place % all.len()].degree() as u64;
            let mut emptied: Vec<usize> = (0..2 * all.len()).collect();
            emptied.sort_by_key(|place| std::cmp::Reverse(weight(*place)));
            let simple = simple_vectors(r, &basis, &weight, &emptied);
            if let Some(vector) = simple.iter().find_map(|vector| in_integers(r, vector)) {
                let part = |from: usize| -> Polynomial {
                    let terms = all.iter().zip(&vector[from..]).filter(|(_, c)| **c != 0);
                    terms.map(|(monomial, c)| (monomial.clone(), *c)).collect()
                };
                return Some(Fraction { top: part(0), bottom: part(all.len()) });
            }
        }
        None
    }
}

struct Fraction {
    top: Polynomial,
    bottom: Polynomial,
}

/// The entry in a column of the kernel vector that has its one at a free column.
fn entry(kernel: &Kernel, free: usize, column: usize) -> u64 {
    kernel.free.iter().position(|other| *other == free).map_or(0, |at| kernel.basis[at][column])
}
