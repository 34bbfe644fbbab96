//! Symmetries that exchange unknowns and change their signs: two states and two sets of constants with the same outputs for all
//! times and all inputs.
//!
//! A map `X_v = e_v x_w`, `w` a permutation of the unknowns and `e_v` signs, takes solutions to solutions where `r_v(X) = e_v r_w(x)` for
//! the rates, and leaves the outputs as they are where `h(X) = h(x)`. Both are equations between polynomials with integer
//! coefficients, and are compared term by term: there is no
//! error. Permutations are found by refining a partition of the unknowns, the signs by linear algebra modulo 2.

use super::exact::{Exact, Monomial};
use super::jets::Jet;
use super::model::{Model, Motion, Quotient};
use super::point::{Source, random_point};
use dashu::base::{Abs, Sign};
use palmistry_math::number::PrimeField;
use palmistry_math::number::polynomial::Ring;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{Hash, Hasher};

/// A map of the variables of a model: of each the variable whose value it takes, and whether the sign is turned.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Exchange {
    pub of: Vec<(usize, bool)>,
}

/// No more maps are looked for.
const MOST: usize = 64;
/// Nor more partitions refined.
const MOST_STEPS: usize = 2_000;

impl Exchange {
    /// Whether it is the identity.
    fn is_nothing(&self) -> bool {
        self.of.iter().enumerate().all(|(place, (other, turned))| place == *other && !turned)
    }

    /// How many variables it changes.
    pub fn size(&self) -> usize {
        self.of.iter().enumerate().filter(|(place, (other, turned))| place != other || *turned).count()
    }

    /// A polynomial at the image of a state.
    fn of_polynomial(&self, polynomial: &Exact) -> Exact {
        let mut found = Exact::default();
        for (monomial, coefficient) in &polynomial.terms {
            let mut turned = false;
            let mut image: Monomial = Vec::new();
            for (variable, power) in monomial {
                let (other, sign) = self.of[*variable as usize];
                turned ^= sign && power % 2 == 1;
                image.push((other as u32, *power));
            }
            image.sort_unstable();
            // a permutation takes monomials to different ones
            found.terms.insert(image, if turned { -coefficient } else { coefficient.clone() });
        }
        found
    }

    /// Whether a quotient at the image of a state is another quotient at the state, with this sign.
    fn takes(&self, one: &Quotient, other: &Quotient, turned: bool) -> bool {
        let (top, bottom) = (self.of_polynomial(&one.top), self.of_polynomial(&one.bottom));
        let top = if turned { top.neg() } else { top };
        match (top.mul(&other.bottom), other.top.mul(&bottom)) {
            (Some(left), Some(right)) => left == right,
            _ => false,
        }
    }

    /// Whether it takes solutions to solutions with the same outputs.
    fn is_symmetry(&self, model: &Model, fixed: &[bool]) -> bool {
        let rests = (0..fixed.len()).all(|place| !fixed[place] || self.of[place] == (place, false));
        let moves = model.variables.iter().enumerate().all(|(place, variable)| {
            let (other, turned) = self.of[place];
            match (&variable.motion, &model.variables[other].motion) {
                (Motion::Rests, Motion::Rests) => true,
                (Motion::Driven, Motion::Driven) => place == other && !turned,
                (Motion::Moves(own), Motion::Moves(image)) => self.takes(own, image, turned),
                _ => false,
            }
        });
        rests && moves && model.outputs.iter().all(|output| self.takes(output, output, false))
    }
}

/// How many values an unknown, by the place of its variable, has at the images of a state.
pub(super) fn values_of_variable(exchanges: &[Exchange], place: usize) -> usize {
    let images: BTreeSet<(usize, bool)> =
        exchanges.iter().map(|map| map.of[place]).chain([(place, false)]).collect();
    images.len()
}

/// The same of an expression: at a random point that has the given initial conditions, modulo a prime. Values that differ there differ almost
/// everywhere on the set; others may be equal on it alone, as those of `x*k` where `x = 0`, and are not counted.
pub(super) fn values_of_expression(model: &Model, exchanges: &[Exchange], asked: &Quotient) -> usize {
    let given = model.given_program();
    // a root of a number is no number that is drawn
    if given.unknown_function(&model.graph).is_some() {
        return 1;
    }
    let mut rng = ChaCha8Rng::seed_from_u64(0x696d_6167_6573); // any fixed seed: what differs, differs
    let field = PrimeField::random(&mut rng);
    let mut source = Source { rng: &mut rng, given: HashMap::new() };
    let Ok(point) = random_point(model, field, &mut source) else { return 1 };
    let at = |polynomial: &Exact| {
        let value = Jet::of(&field, polynomial).with_values(&field, |variable| point.get(&variable).copied());
        value.as_constant()
    };
    let value = |top: &Exact, bottom: &Exact| Some(field.product(at(top)?, field.inverse(at(bottom)?)?));
    let images = exchanges
        .iter()
        .map(|map| value(&map.of_polynomial(&asked.top), &map.of_polynomial(&asked.bottom)))
        .chain([value(&asked.top, &asked.bottom)]);
    images.flatten().collect::<BTreeSet<u64>>().len().max(1)
}

/// The maps that are found, but the one that changes nothing.
pub(super) fn exchanges(model: &Model) -> Vec<Exchange> {
    let is_fixed = |place: usize| {
        model.variables[place].is_known || model.given.iter().any(|(given, _)| *given == place)
    };
    exchanges_beside(model, (0..model.variables.len()).map(is_fixed).collect())
}

/// The same where these variables, and no others, keep their values.
pub(super) fn exchanges_beside(model: &Model, fixed: Vec<bool>) -> Vec<Exchange> {
    // the half turns of angles are no changes of sign
    if !model.angles.is_empty() {
        return Vec::new();
    }
    let begin: Vec<u64> = model
        .variables
        .iter()
        .enumerate()
        .map(|(place, variable)| {
            let kind = match variable.motion {
                Motion::Rests => 0,
                Motion::Moves(_) => 1,
                Motion::Driven => 2,
            };
            hash(&(kind, fixed[place].then_some(place)))
        })
        .collect();
    let mut search = Search { model, fixed, found: BTreeSet::new(), steps: 0 };
    search.go_on(begin.clone(), begin);
    search.found.into_iter().collect()
}

/// The maps that change signs alone, of cosines and sines as well, but the one that changes nothing.
pub(super) fn changes_of_sign(model: &Model, fixed: Vec<bool>) -> Vec<Exchange> {
    let mut search = Search { model, fixed, found: BTreeSet::new(), steps: 0 };
    search.signs(&(0..model.variables.len()).collect::<Vec<_>>());
    search.found.into_iter().collect()
}

fn hash(value: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

struct Search<'a> {
    model: &'a Model,
    fixed: Vec<bool>,
    found: BTreeSet<Exchange>,
    steps: usize,
}

impl Search<'_> {
    /// Colours that distinguish variables which stand in different terms.
    fn refine(&self, mut colours: Vec<u64>) -> Vec<u64> {
        let mut count = 0;
        loop {
            let kinds: BTreeSet<u64> = colours.iter().copied().collect();
            if kinds.len() == count {
                return colours;
            }
            count = kinds.len();
            let mut seen: Vec<Vec<u64>> = vec![Vec::new(); colours.len()];
            let outputs = self
                .model
                .outputs
                .iter()
                .enumerate()
                .map(|(place, output)| (hash(&("output", place)), None, output));
            let rates =
                self.model.variables.iter().enumerate().filter_map(|(place, variable)| {
                    match &variable.motion {
                        Motion::Moves(rate) => Some((hash(&("rate", colours[place])), Some(place), rate)),
                        _ => None,
                    }
                });
            for (owner, place, quotient) in outputs.chain(rates) {
                let mut terms: Vec<(u64, u32, u16)> = Vec::new();
                let mut all: Vec<u64> = Vec::new();
                for (side, polynomial) in [(0, &quotient.top), (1, &quotient.bottom)] {
                    for (monomial, coefficient) in &polynomial.terms {
                        let mut parts: Vec<(u64, u16)> = monomial
                            .iter()
                            .map(|(variable, power)| (colours[*variable as usize], *power))
                            .collect();
                        parts.sort_unstable();
                        let term = hash(&(owner, side, coefficient.clone().abs().to_string(), parts));
                        all.push(term);
                        terms.extend(monomial.iter().map(|(variable, power)| (term, *variable, *power)));
                    }
                }
                all.sort_unstable();
                let whole = hash(&all);
                for (term, variable, power) in terms {
                    seen[variable as usize].push(hash(&(whole, term, power)));
                }
                if let Some(place) = place {
                    seen[place].push(hash(&("own", whole)));
                }
            }
            for (colour, seen) in colours.iter_mut().zip(&mut seen) {
                seen.sort_unstable();
                *colour = hash(&(*colour, &*seen));
            }
        }
    }

    /// All permutations that take the colours of the one to those of the other.
    fn go_on(&mut self, from: Vec<u64>, to: Vec<u64>) {
        self.steps += 1;
        if self.steps > MOST_STEPS || self.found.len() >= MOST {
            return;
        }
        let (from, to) = (self.refine(from), self.refine(to));
        let classes = |colours: &[u64]| {
            let mut classes: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
            for (place, colour) in colours.iter().enumerate() {
                classes.entry(*colour).or_default().push(place);
            }
            classes
        };
        let (here, there) = (classes(&from), classes(&to));
        if here.len() != there.len()
            || here.iter().any(|(colour, own)| there.get(colour).is_none_or(|o| o.len() != own.len()))
        {
            return;
        }
        let open = here.iter().filter(|(_, own)| own.len() > 1).min_by_key(|(_, own)| own.len());
        let Some((colour, own)) = open else {
            let permutation: Vec<usize> = from.iter().map(|colour| there[colour][0]).collect();
            self.signs(&permutation);
            return;
        };
        let alone = hash(&("alone", colour));
        for other in &there[colour] {
            let (mut from, mut to) = (from.clone(), to.clone());
            from[own[0]] = alone;
            to[*other] = alone;
            self.go_on(from, to);
        }
    }

    /// All signs with which a permutation is a symmetry.
    fn signs(&mut self, permutation: &[usize]) {
        let Some((particular, kernel)) = self.solve(permutation) else { return };
        let count = permutation.len();
        for choice in 0..1u64 << kernel.len().min(6) {
            let mut bits = particular.clone();
            for (place, direction) in kernel.iter().enumerate().take(6) {
                if choice >> place & 1 == 1 {
                    bits.iter_mut().zip(direction).for_each(|(bit, other)| *bit ^= other);
                }
            }
            let map =
                Exchange { of: permutation.iter().copied().zip(bits[..count].iter().copied()).collect() };
            if self.found.len() < MOST && !map.is_nothing() && map.is_symmetry(self.model, &self.fixed) {
                self.found.insert(map);
            }
        }
    }

    /// The signs as a solution of linear equations modulo 2, and those of the equations without right sides: a bit for each
    /// variable, then one
    /// for each top and bottom.
    fn solve(&self, permutation: &[usize]) -> Option<(Vec<bool>, Vec<Vec<bool>>)> {
        let count = permutation.len();
        let mut pairs: Vec<(Option<usize>, &Quotient, &Quotient)> = Vec::new();
        for (place, variable) in self.model.variables.iter().enumerate() {
            match (&variable.motion, &self.model.variables[permutation[place]].motion) {
                (Motion::Moves(own), Motion::Moves(image)) => pairs.push((Some(place), own, image)),
                (Motion::Moves(_), _) | (_, Motion::Moves(_)) => return None,
                _ => {}
            }
        }
        pairs.extend(self.model.outputs.iter().map(|output| (None, output, output)));
        let width = count + 2 * pairs.len();
        let mut rows: Vec<Vec<bool>> = Vec::new();
        for place in (0..count).filter(|place| self.fixed[*place]) {
            let mut row = vec![false; width + 1];
            row[place] = true;
            rows.push(row);
        }
        for (number, (place, own, image)) in pairs.iter().enumerate() {
            for (side, (left, right)) in
                [(&own.top, &image.top), (&own.bottom, &image.bottom)].into_iter().enumerate()
            {
                if left.terms.len() != right.terms.len() {
                    return None;
                }
                for (monomial, coefficient) in &left.terms {
                    let mut moved: Monomial = monomial
                        .iter()
                        .map(|(variable, power)| (permutation[*variable as usize] as u32, *power))
                        .collect();
                    moved.sort_unstable();
                    let other = right.terms.get(&moved)?;
                    if other.clone().abs() != coefficient.clone().abs() {
                        return None;
                    }
                    let mut row = vec![false; width + 1];
                    for (variable, power) in monomial {
                        row[*variable as usize] ^= power % 2 == 1;
                    }
                    row[count + 2 * number + side] = true;
                    row[width] = (coefficient.sign() == Sign::Negative) != (other.sign() == Sign::Negative);
                    rows.push(row);
                }
            }
            let mut row = vec![false; width + 1];
            row[count + 2 * number] = true;
            row[count + 2 * number + 1] = true;
            if let Some(place) = place {
                row[*place] = true;
            }
            rows.push(row);
        }
        solve_modulo_two(rows, width)
    }
}

/// One solution, and a basis of those of the homogeneous equations; the last column is the right side.
fn solve_modulo_two(mut rows: Vec<Vec<bool>>, width: usize) -> Option<(Vec<bool>, Vec<Vec<bool>>)> {
    let mut pivots: HashMap<usize, usize> = HashMap::new();
    let mut done = 0;
    for column in 0..width {
        let Some(place) = (done..rows.len()).find(|row| rows[*row][column]) else { continue };
        rows.swap(done, place);
        let pivot = rows[done].clone();
        for (place, row) in rows.iter_mut().enumerate() {
            if place != done && row[column] {
                row.iter_mut().zip(&pivot).for_each(|(bit, other)| *bit ^= other);
            }
        }
        pivots.insert(column, done);
        done += 1;
    }
    if rows[done..].iter().any(|row| row[width]) {
        return None;
    }
    let particular =
        (0..width).map(|column| pivots.get(&column).is_some_and(|row| rows[*row][width])).collect();
    let free = (0..width).filter(|column| !pivots.contains_key(column));
    let kernel = free.map(|free| {
        (0..width)
            .map(|column| column == free || pivots.get(&column).is_some_and(|row| rows[*row][free]))
            .collect()
    });
    Some((particular, kernel.collect()))
}

/// A map in words: `k1 -> k2, k2 -> k1, x -> -x`.
pub(super) fn in_words(model: &Model, map: &Exchange) -> String {
    let name = |place: usize| {
        model.variables[place]
            .input
            .symbol()
            .map_or_else(String::new, |symbol| model.graph.symbol_name(symbol).to_owned())
    };
    let changed = map.of.iter().enumerate().filter(|(place, (other, turned))| place != other || *turned);
    let parts: Vec<String> = changed
        .map(|(place, (other, turned))| {
            format!("{} -> {}{}", name(place), if *turned { "-" } else { "" }, name(*other))
        })
        .collect();
    parts.join(", ")
}
