//! How many derivatives of the outputs determine all at the states of a set that is not invariant, as where initial conditions are numbers.
//!
//! There a derivative may add nothing and a later one may. Let `c_k` be the differential of an output's k-th derivative by all coordinates that move, along
//! the trajectory from a state of the set, with `c_r = sum_(k<r) a_k c_k` at almost all states around. Where `c_0 ... c_(r-1)` are independent at almost all times of the trajectory, so that their minors
//! vanish at its start at most, the same holds along it with Laurent series `a_k(t)`. How the output changes with the initial state, `w = c_0 S`
//! for a direction `S` that moves with the linearised flow, has `w^(k) = c_k S`, and so satisfies the linear equation `w^(r) = sum a_k(t) w^(k)` in whatever direction. A solution
//! of it that is not zero begins with a power of time whose exponent is a root of the indicial polynomial. No further derivatives than up to the largest root that is an integer have to be looked at:
//! what does not change these does not change the output at all.
//!
//! The roots that are wanted do not depend on the state: they are those that two random states modulo one prime have in common, as far as these are small; where
//! something else is left of the common divisor, nothing is said.
//!
//! Reference: E. L. Ince, *Ordinary Differential Equations*, 1926, chapter 16, for exponents at a singular point.

use super::bound::{self, Rounds, sum_of_errors};
use super::covectors::integers;
use super::echelon::Echelon;
use super::laurent::{Laurent, solve};
use super::probe::{ATTEMPTS, Draw, Evaluated, Probe};
use crate::observability::conditions::vanishes;
use crate::observability::residue_polynomial::gcd;
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::NodeId;
use palmistry_math::number::{PrimeField, Refusal};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// The order up to which the derivatives of each output determine all that any derivatives do.
pub(crate) struct Orbit {
    /// Of each output.
    pub last: Vec<usize>,
    /// That fewer are given than are needed has a probability below two to this power.
    pub log2_error: f64,
}

/// Exponents up to this are looked for.
const LARGEST_EXPONENT: u64 = 60;
/// Series are taken to no more coefficients.
const LONGEST: usize = 120;
/// Nor where their equations take more products than this for one point.
const MOST_PRODUCTS: usize = 2_000_000_000;
/// Nor of larger systems.
const MOST_COORDINATES: usize = 40;

/// Why there is no polynomial at a point.
enum Trouble {
    /// Longer series may have one.
    Short,
    Refused(Refusal),
}

impl Probe {
    /// The orders, where `around` has the same equations without the conditions on states.
    ///
    /// # Errors
    /// In words, where nothing can be said.
    pub(crate) fn orbit(&self, around: &Probe, rng: &mut ChaCha8Rng) -> Result<Orbit, String> {
        let closed = self.equations.closed.len();
        if self.equations.roots > 0 {
            return Err("square roots are met".to_owned());
        }
        if closed > MOST_COORDINATES {
            return Err(format!("more than {MOST_COORDINATES} coordinates"));
        }
        let Rounds { rounds, log2_error } = bound::rounds(&around.equations, closed)?;
        let mut ranks = vec![0; self.equations.outputs];
        for _ in 0..rounds {
            let found = around.output_rows(rng)?.rows;
            ranks.iter_mut().zip(found).for_each(|(rank, rows)| *rank = (*rank).max(rows.len() - 1));
        }
        let most = ranks.iter().copied().max().unwrap_or(0);
        let mut length = 2 * (most + 2);
        loop {
            let products = ranks.iter().map(|rank| (closed * rank * rank).saturating_mul(length * length));
            if products.fold(0, usize::saturating_add) > MOST_PRODUCTS {
                return Err(format!("exponents by series of {length} coefficients take too long"));
            }
            match self.exponents(&ranks, length, rng) {
                Ok((last, of_exponents)) => {
                    let log2_error = sum_of_errors(log2_error, of_exponents);
                    return Ok(Orbit { last, log2_error });
                }
                Err(None) if length < LONGEST => length = (2 * length).min(LONGEST),
                Err(None) => {
                    return Err(
                        "the trajectories lie where the outputs' derivatives depend on each other".to_owned()
                    );
                }
                Err(Some(why)) => return Err(why),
            }
        }
    }

    /// The largest exponents, by series of so many coefficients; nothing but none where these are too short.
    fn exponents(
        &self,
        ranks: &[usize],
        length: usize,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Vec<usize>, f64), Option<String>> {
        let most = ranks.iter().copied().max().unwrap_or(0);
        let Rounds { rounds, log2_error } = bound::rounds(&self.equations, most + length)?;
        let each = 1.0 + log2_error / rounds as f64; // two points
        let rounds = (-100.0 / each).ceil().max(1.0) as usize;
        let mut last: Vec<usize> = ranks.iter().map(|rank| rank.saturating_sub(1)).collect();
        for _ in 0..rounds {
            let field = PrimeField::random(rng);
            let [one, other] =
                [self.indicial(ranks, length, field, rng)?, self.indicial(ranks, length, field, rng)?];
            for ((one, other), last) in one.into_iter().zip(other).zip(&mut last) {
                *last = (*last).max(largest_exponent(&field, gcd(&field, one, other))?);
            }
        }
        Ok((last, rounds as f64 * each))
    }

    /// The indicial polynomial of each output at a random point.
    fn indicial(
        &self,
        ranks: &[usize],
        length: usize,
        field: PrimeField,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<Vec<u64>>, Option<String>> {
        let mut refused = String::new();
        for _ in 0..ATTEMPTS {
            match self.indicial_in(ranks, length, field, rng) {
                Ok(found) => return Ok(found),
                Err(Trouble::Short) => return Err(None),
                Err(Trouble::Refused(refusal)) => refused = refusal.to_string(),
            }
        }
        Err(Some(format!("{ATTEMPTS} random points were singularities: {refused}")))
    }

    fn indicial_in(
        &self,
        ranks: &[usize],
        length: usize,
        field: PrimeField,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<Vec<u64>>, Trouble> {
        let equations = &self.equations;
        let start = equations.draw(field, rng).map_err(Trouble::Refused)?;
        let trajectory =
            equations.trajectory(field, &start, (rng.random(), None), length).map_err(Trouble::Refused)?;
        let integers = integers(&field, length);
        let mut found = Vec::new();
        for (covector, rank) in trajectory.covectors.into_iter().zip(ranks) {
            let mut rows: Vec<Vec<Laurent>> = Vec::new();
            let mut covector = covector;
            for k in 0..=*rank {
                let known = length - k;
                let series = |place: &usize| Laurent::new(&covector.series[*place], known);
                rows.push(equations.closed.iter().map(series).collect());
                if k < *rank {
                    covector = covector.next(&field, &trajectory.entries, &integers);
                }
            }
            let right = rows.pop().unwrap_or_default();
            let factors = solve(&field, &rows, right).ok_or(Trouble::Short)?;
            found.push(indicial_polynomial(&field, &factors).ok_or(Trouble::Short)?);
        }
        Ok(found)
    }

    /// The span of the derivatives of each output up to its order, at one start.
    fn evaluate_up_to(&self, last: &[usize], start: &[u64], draw: Draw) -> Result<Evaluated, Refusal> {
        let equations = &self.equations;
        let length = last.iter().max().map_or(1, |most| most + 1);
        let trajectory = equations.trajectory(draw.field, start, (draw.seed, draw.signs), length)?;
        let integers = integers(&draw.field, length);
        let mut echelon = Echelon::new(draw.field, equations.columns.len());
        let mut closed = Echelon::new(draw.field, equations.closed.len());
        let mut covectors = trajectory.covectors;
        let part = |value: &[u64], places: &[usize]| places.iter().map(|place| value[*place]).collect();
        let asked = covectors.split_off(equations.outputs);
        let asked = asked.iter().map(|covector| part(&covector.value(), &equations.columns)).collect();
        let mut order = 0;
        for (covector, last) in covectors.into_iter().zip(last) {
            let mut covector = covector;
            for k in 0..=*last {
                let value = covector.value();
                if echelon.insert(part(&value, &equations.columns)) {
                    order = order.max(k);
                }
                closed.insert(part(&value, &equations.closed));
                if k < *last {
                    covector = covector.next(&draw.field, &trajectory.entries, &integers);
                }
            }
        }
        Ok(Evaluated::new(echelon, asked, closed.rank(), order))
    }

    /// The same at a random point.
    pub(super) fn round_up_to(&self, last: &[usize], rng: &mut ChaCha8Rng) -> Result<Evaluated, String> {
        let mut refused = String::new();
        for _ in 0..ATTEMPTS {
            let field = PrimeField::random(rng);
            let begin = self.equations.draw(field, rng);
            let draw = Draw { field, seed: rng.random(), signs: None };
            match begin.and_then(|start| self.evaluate_up_to(last, &start, draw)) {
                Ok(found) => return Ok(found),
                Err(refusal) => refused = refusal.to_string(),
            }
        }
        Err(format!("{ATTEMPTS} random points were singularities: {refused}"))
    }
}

/// The probes with and without conditions on states; what stays at its initial condition all along is put in.
pub(super) fn probes(system: &System, conditions: &Assignment, asked: &[NodeId]) -> (Probe, Probe) {
    let (system, asked) = settled(system, conditions, asked);
    let mentions_states =
        |node: NodeId| system.graph.symbols_of([node]).iter().any(|symbol| system.states.contains(symbol));
    let of_constants: Assignment = conditions
        .iter()
        .filter(|(symbol, value)| !system.states.contains(symbol) && !mentions_states(**value))
        .map(|(symbol, value)| (*symbol, *value))
        .collect();
    (Probe::asking(&system, conditions, &asked), Probe::asking(&system, &of_constants, &asked))
}

/// The system with the values put in of states that keep their known initial values, as an amount that is zero and stays so.
fn settled(system: &System, conditions: &Assignment, asked: &[NodeId]) -> (System, Vec<NodeId>) {
    let mut system = system.clone();
    let is_number = |system: &System, value: NodeId| {
        system.graph.symbols_of([value]).iter().all(|symbol| !system.states.contains(symbol))
    };
    let mut stays: Assignment = conditions
        .iter()
        .filter(|(symbol, value)| system.known.contains(symbol) && is_number(&system, **value))
        .map(|(symbol, value)| (*symbol, *value))
        .collect();
    loop {
        let mut moved = Vec::new();
        for field in system.moving_fields() {
            let rates = system.fields[field].components.clone();
            for (symbol, rate) in rates.into_iter().filter(|(symbol, _)| stays.contains_key(symbol)) {
                let there = system.graph.substitute(&[rate], &stays)[0];
                if !vanishes(&mut system, there) {
                    moved.push(symbol);
                }
            }
        }
        if moved.is_empty() {
            break;
        }
        stays.retain(|symbol, _| !moved.contains(symbol));
    }
    if stays.is_empty() {
        return (system, asked.to_vec());
    }
    for field in system.moving_fields() {
        let kept: Vec<_> = system.fields[field].components.clone();
        let kept = kept.into_iter().filter(|(symbol, _)| !stays.contains_key(symbol));
        let (symbols, rates): (Vec<_>, Vec<_>) = kept.unzip();
        let rates = system.graph.substitute(&rates, &stays);
        system.fields[field].components = symbols.into_iter().zip(rates).collect();
    }
    let outputs: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    let outputs = system.graph.substitute(&outputs, &stays);
    system.outputs.iter_mut().zip(outputs).for_each(|((_, node), there)| *node = there);
    let asked = system.graph.substitute(asked, &stays);
    (system, asked)
}

/// `N (N-1) ... (N-r+1) - sum a_k N ... (N-k+1)`, of each factor what counts for small times; nothing where too few of its coefficients are known.
fn indicial_polynomial(field: &PrimeField, factors: &[Laurent]) -> Option<Vec<u64>> {
    let rank = factors.len() as i64;
    let weight = |(k, factor): (usize, &Laurent)| -> Option<Option<(i64, usize, u64)>> {
        match factor.leading() {
            Some((exponent, lead)) => Some(Some((exponent - k as i64, k, lead))),
            // nought, as far as it matters
            None if factor.known() - k as i64 > -rank => Some(None),
            None => None,
        }
    };
    let terms: Vec<(i64, usize, u64)> =
        factors.iter().enumerate().map(weight).collect::<Option<Vec<_>>>()?.into_iter().flatten().collect();
    let least = terms.iter().map(|(weight, ..)| *weight).fold(-rank, i64::min);
    let mut polynomial = vec![0; factors.len() + 1];
    let mut add = |order: usize, factor: u64| {
        for (place, coefficient) in falling(field, order).into_iter().enumerate() {
            polynomial[place] = field.sum(polynomial[place], field.product(factor, coefficient));
        }
    };
    if least == -rank {
        add(factors.len(), field.one());
    }
    for (_, k, lead) in terms.into_iter().filter(|(weight, ..)| *weight == least) {
        add(k, field.modulus() - lead);
    }
    Some(polynomial)
}

/// The coefficients of `N (N-1) ... (N-order+1)`, constant first.
fn falling(field: &PrimeField, order: usize) -> Vec<u64> {
    let mut found = vec![field.one()];
    let mut minus = 0;
    for _ in 0..order {
        // times N - k
        let mut next = vec![0; found.len() + 1];
        for (place, coefficient) in found.iter().enumerate() {
            next[place + 1] = field.sum(next[place + 1], *coefficient);
            next[place] = field.sum(next[place], field.product(minus, *coefficient));
        }
        found = next;
        minus = field.sum(minus, field.modulus() - field.one());
    }
    found
}

/// The largest root that is a small integer, where no others are left.
fn largest_exponent(field: &PrimeField, mut polynomial: Vec<u64>) -> Result<usize, Option<String>> {
    let mut largest = 0;
    for exponent in 0..=LARGEST_EXPONENT {
        let root = field.integer(&exponent.into());
        while polynomial.len() > 1 {
            // Horner's quotient and rest
            let mut quotient = vec![0; polynomial.len() - 1];
            let mut rest = 0;
            for (place, coefficient) in polynomial.iter().enumerate().rev() {
                let value = field.sum(field.product(rest, root), *coefficient);
                if place > 0 {
                    quotient[place - 1] = value;
                }
                rest = value;
            }
            if rest != 0 {
                break;
            }
            (polynomial, largest) = (quotient, exponent as usize);
        }
    }
    match polynomial.len() {
        0 | 1 => Ok(largest),
        _ => Err(Some("how the outputs begin to change has exponents that are no small integers".to_owned())),
    }
}
