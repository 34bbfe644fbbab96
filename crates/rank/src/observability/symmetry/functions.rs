//! Functions that no unobservable field changes: products of powers of polynomials that the fields multiply by constants, such as
//! `V/K` under a scaling, `x2 - x1` under a translation, `(x2 - x1)/(x3 - x1)` under both.

use super::ansatz::FieldTerms;
use super::kernel::{Block, KernelSource, Point};
use super::lattice::integer_kernel;
use super::modular::{Echelon, in_integers, simple_vectors};
use super::monomial::{Monomial, Polynomial, in_brackets, monomials, polynomial_text};
use palmistry_math::expression::{Graph, Symbol, SymbolFunction, SymbolInput};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// No more unknown coefficients than this are solved for at once.
const MOST_UNKNOWNS: usize = 300;
/// Polynomials of no higher degree are tried.
const HIGHEST_DEGREE: usize = 3;
/// Fields that are no scalings may multiply a polynomial by up to this, where there are no more of them than the other.
const LARGEST_FACTOR: i64 = 2;
const MOST_FACTORED: usize = 2;

/// A product of powers of polynomials.
pub(super) struct FunctionTerms {
    pub factors: Vec<(Polynomial, i64)>,
}

/// What was found of one block.
pub(super) struct BlockFunctions {
    /// Functionally independent ones.
    pub functions: Vec<FunctionTerms>,
    /// How many are missing.
    pub missing: usize,
    /// Whether something was left untried because it has too many unknown coefficients.
    pub cut_off: bool,
}

/// A polynomial that every field multiplies by a constant.
struct Eigenfunction {
    polynomial: Polynomial,
    /// That constant for each scaling, and then for each other field.
    weights: Vec<i64>,
}

struct Search<'a> {
    source: &'a KernelSource,
    block: &'a Block,
    free: &'a [usize],
    /// The scalings, as weights of columns.
    scalings: Vec<BTreeMap<usize, i64>>,
    /// The other fields; none where not all fields are known, and the kernel at each point stands for them.
    others: Option<Vec<&'a FieldTerms>>,
    /// The differentials of what was found, at one point.
    at: Point,
    span: Echelon,
    found: Vec<Eigenfunction>,
    cut_off: bool,
}

/// Functions of one block, as many as its columns less the unobservable directions where all are found.
pub(super) fn functions_of_block(
    source: &KernelSource,
    block: &Block,
    fields: &[FieldTerms],
    free: &[usize],
    rng: &mut ChaCha8Rng,
) -> BlockFunctions {
    let wanted = block.columns.len() - block.free.len();
    if wanted == 0 {
        return BlockFunctions { functions: Vec::new(), missing: 0, cut_off: false };
    }
    let complete = fields.len() == block.free.len();
    let weights: Vec<Option<Vec<(usize, i64)>>> = fields.iter().map(|field| field.weights(source)).collect();
    let others = fields.iter().zip(&weights).filter(|(_, weights)| weights.is_none()).map(|(field, _)| field);
    let mut search = Search {
        source,
        block,
        free,
        scalings: match complete {
            true => weights.iter().flatten().map(|list| list.iter().copied().collect()).collect(),
            false => Vec::new(),
        },
        others: complete.then(|| others.collect()),
        at: source.draw(rng),
        span: Echelon::new(source.residues, block.columns.len()),
        found: Vec::new(),
        cut_off: false,
    };
    let of_others = search.others.as_ref().map_or(0, Vec::len);
    for factors in factors(if of_others <= MOST_FACTORED { of_others } else { 0 }) {
        let factors = if factors.is_empty() { vec![0; of_others] } else { factors };
        for degree in 1..=HIGHEST_DEGREE {
            if search.functions(wanted).is_none() {
                search.degree(degree, &factors, wanted, rng);
            }
        }
    }
    let functions = search.functions(wanted).unwrap_or_else(|| search.products());
    let missing = wanted - functions.len().min(wanted);
    BlockFunctions { functions, missing, cut_off: search.cut_off }
}

/// By what so many fields may multiply a polynomial: nought first, then small integers.
fn factors(fields: usize) -> Vec<Vec<i64>> {
    let mut all = vec![Vec::new()];
    for _ in 0..fields {
        all = all
            .iter()
            .flat_map(|list: &Vec<i64>| {
                (-LARGEST_FACTOR..=LARGEST_FACTOR).map(|factor| [list.as_slice(), &[factor]].concat())
            })
            .collect();
    }
    all.sort_by_key(|list| list.iter().map(|factor| factor.abs()).sum::<i64>());
    all
}

impl Search<'_> {
    /// The functions, where as many as wanted can be made of what was found.
    fn functions(&self, wanted: usize) -> Option<Vec<FunctionTerms>> {
        let found = self.products();
        (found.len() >= wanted).then_some(found)
    }

    /// All products of powers that no field changes, by a basis of their exponents.
    fn products(&self) -> Vec<FunctionTerms> {
        let rows = self.found.first().map_or(0, |first| first.weights.len());
        let weights: Vec<Vec<i64>> =
            (0..rows).map(|row| self.found.iter().map(|one| one.weights[row]).collect()).collect();
        let exponents = integer_kernel(&weights, self.found.len()).unwrap_or_default();
        let product = |mut exponents: Vec<i64>| {
            // of two reciprocals that with the shorter denominator
            let terms = |sign: i64| -> usize {
                let there = self.found.iter().zip(&exponents).filter(|(_, e)| e.signum() == sign);
                there.map(|(one, _)| one.polynomial.len()).sum()
            };
            if exponents.iter().sum::<i64>() == 0 && terms(-1) > terms(1) {
                exponents.iter_mut().for_each(|exponent| *exponent = -*exponent);
            }
            let used = self.found.iter().zip(exponents).filter(|(_, exponent)| *exponent != 0);
            let mut factors: Vec<(Polynomial, i64)> =
                used.map(|(one, e)| (one.polynomial.clone(), e)).collect();
            factors.sort();
            FunctionTerms { factors }
        };
        exponents.into_iter().map(product).collect()
    }

    fn column_of(&self, variable: usize) -> Option<usize> {
        let symbol = self.source.variables[variable].symbol;
        self.block.columns.iter().copied().find(|column| self.source.coordinate(*column) == symbol)
    }

    /// All polynomials up to a degree that every other field multiplies by its factor.
    fn degree(&mut self, degree: usize, factors: &[i64], wanted: usize, rng: &mut ChaCha8Rng) {
        let source = self.source;
        let own = |place: &usize| self.column_of(*place).is_some();
        // what scalings keep are products of powers of the coordinates that they scale
        let only_scalings = self.others.as_ref().is_some_and(Vec::is_empty);
        let others: &[usize] = if only_scalings { &[] } else { self.block.variables(source) };
        let variables: Vec<usize> =
            (0..source.variables.len()).filter(|place| own(place) || others.contains(place)).collect();
        let mut all: Vec<Monomial> = Vec::new();
        for degree in 1..=degree {
            if super::monomial::count(variables.len(), degree) > 8 * MOST_UNKNOWNS {
                self.cut_off = true;
                return;
            }
            all.extend(monomials(source, &variables, degree));
        }
        if factors.iter().all(|factor| *factor == 0) {
            let angle = |column: &usize| {
                let symbol = source.coordinate(*column);
                let is_angle = source
                    .variables
                    .iter()
                    .any(|v| v.symbol == symbol && v.function != SymbolFunction::Itself);
                is_angle.then_some(Monomial { powers: Vec::new(), angle: Some(symbol) })
            };
            all.extend(self.block.columns.iter().filter_map(angle));
        }
        // nothing is looked for among the observable coordinates
        let mut classes: BTreeMap<Vec<i64>, Vec<Monomial>> = BTreeMap::new();
        for monomial in all {
            if monomial.angle.is_some() || monomial.powers.iter().any(|(place, _)| own(place)) {
                classes.entry(self.weights(&monomial)).or_default().push(monomial);
            }
        }
        let mut candidates: Vec<(usize, usize, u64, Vec<i64>, Polynomial)> = Vec::new();
        for (weights, class) in classes {
            if class.len() > MOST_UNKNOWNS {
                self.cut_off = true;
                continue;
            }
            let Some(solutions) = self.solutions(&class, factors, rng) else { continue };
            let cost = |place: usize| class[place].degree() as u64;
            let mut emptied: Vec<usize> = (0..class.len()).collect();
            emptied.sort_by_key(|place| std::cmp::Reverse(cost(*place)));
            for vector in simple_vectors(source.residues, &solutions, &cost, &emptied) {
                let Some(vector) = in_integers(source.residues, &vector) else { continue };
                let terms = class.iter().zip(&vector).filter(|(_, c)| **c != 0);
                let polynomial: Polynomial = terms.map(|(monomial, c)| (monomial.clone(), *c)).collect();
                let top = polynomial.iter().map(|(monomial, _)| monomial.degree()).max().unwrap_or(0);
                let size = polynomial.iter().map(|(_, c)| c.unsigned_abs()).fold(0, u64::saturating_add);
                let all_weights = weights.iter().chain(factors).copied().collect();
                candidates.push((top, polynomial.len(), size, all_weights, polynomial));
            }
        }
        candidates.sort();
        for (_, _, _, weights, polynomial) in candidates {
            if self.functions(wanted).is_some() {
                return;
            }
            let row = self.differential(&polynomial);
            if self.span.add(row) {
                self.found.push(Eigenfunction { polynomial, weights });
            }
        }
    }

    /// By what each scaling multiplies a monomial.
    fn weights(&self, monomial: &Monomial) -> Vec<i64> {
        let weight = |scaling: &BTreeMap<usize, i64>| {
            let of = |(place, power): &(usize, u8)| {
                let column = match self.source.variables[*place].function {
                    SymbolFunction::Itself => self.column_of(*place),
                    _ => None,
                };
                column.and_then(|column| scaling.get(&column)).map_or(0, |weight| weight * i64::from(*power))
            };
            monomial.powers.iter().map(of).sum()
        };
        self.scalings.iter().map(weight).collect()
    }

    fn differential(&self, polynomial: &Polynomial) -> Vec<u64> {
        let r = self.source.residues;
        let by = |column: &usize| {
            let symbol = self.source.coordinate(*column);
            polynomial.iter().fold(0, |sum, (monomial, coefficient)| {
                r.add(sum, r.mul(r.integer(*coefficient), monomial.slope(self.source, &self.at, symbol)))
            })
        };
        self.block.columns.iter().map(by).collect()
    }

    /// The coefficients with which a combination of monomials is multiplied by its factor along every other field.
    fn solutions(&self, class: &[Monomial], factors: &[i64], rng: &mut ChaCha8Rng) -> Option<Vec<Vec<u64>>> {
        let (source, r) = (self.source, self.source.residues);
        let mut echelon = Echelon::new(r, class.len());
        if self.others.as_ref().is_some_and(Vec::is_empty) {
            return Some(echelon.kernel().1);
        }
        let mut idle = 0;
        while idle < 2 && echelon.rank() < class.len() {
            let (point, kernel) = source.sample(Some(self.free), rng)?;
            let columns = kernel.basis.first().map_or(0, Vec::len);
            let vectors: Vec<Vec<u64>> = match &self.others {
                Some(fields) => {
                    fields.iter().map(|field| field.at(source, &point, columns)).collect::<Option<_>>()?
                }
                None => {
                    let of_block = kernel.free.iter().zip(kernel.basis);
                    of_block.filter(|(free, _)| self.block.free.contains(free)).map(|(_, v)| v).collect()
                }
            };
            let slopes: Vec<Vec<u64>> = class
                .iter()
                .map(|monomial| {
                    self.block
                        .columns
                        .iter()
                        .map(|c| monomial.slope(source, &point, symbol(source, *c)))
                        .collect()
                })
                .collect();
            let before = echelon.rank();
            for (place, vector) in vectors.iter().enumerate() {
                let factor = r.integer(factors.get(place).copied().unwrap_or(0));
                let entry = |(monomial, slopes): (&Monomial, &Vec<u64>)| {
                    let along = self
                        .block
                        .columns
                        .iter()
                        .zip(slopes)
                        .fold(0, |sum, (column, slope)| r.add(sum, r.mul(vector[*column], *slope)));
                    match factor {
                        0 => along,
                        factor => r.sub(along, r.mul(factor, monomial.value(source, &point))),
                    }
                };
                echelon.add(class.iter().zip(&slopes).map(entry).collect());
            }
            idle = if echelon.rank() == before { idle + 1 } else { 0 };
        }
        Some(echelon.kernel().1)
    }
}

fn symbol(source: &KernelSource, column: usize) -> Symbol {
    source.coordinate(column)
}

impl FunctionTerms {
    /// In the notation of the language.
    pub fn text(&self, graph: &Graph, variables: &[SymbolInput]) -> String {
        let side = |sign: i64| -> Vec<String> {
            let factors = self.factors.iter().filter(|(_, exponent)| exponent.signum() == sign);
            let factor = |(polynomial, exponent): &(Polynomial, i64)| {
                let text = polynomial_text(graph, variables, polynomial);
                match exponent.unsigned_abs() {
                    1 => text,
                    power if text.contains(['+', '-', '*', ' ']) => format!("({text})^{power}"),
                    power => format!("{text}^{power}"),
                }
            };
            factors.map(factor).collect()
        };
        let product = |mut factors: Vec<String>| match factors.len() {
            0 => "1".to_owned(),
            1 => factors.remove(0),
            _ => factors.into_iter().map(in_brackets).collect::<Vec<_>>().join("*"),
        };
        let (top, bottom) = (product(side(1)), side(-1));
        match bottom.as_slice() {
            [] => top,
            [one] if !one.contains(['*', ' ']) => format!("{}/{one}", in_brackets(top)),
            _ => format!("{}/({})", in_brackets(top), product(bottom)),
        }
    }
}
