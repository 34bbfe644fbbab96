//! What several products have in common is computed once.
//!
//! Which two factors to multiply first is decided greedily: always the pair that most products hold (M. A. Breuer,
//! "Generation of optimal code for expressions via factorization", Comm. ACM 12, 1969).

use super::flat::{AtomId, CoefficientId, Flat, Term, UNIT};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, HashMap};

/// What products are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Factor {
    Constant(CoefficientId),
    Atom(AtomId),
    Reciprocal(AtomId),
    /// A pair that several products hold.
    Pair(u32),
}

/// A multiset of factors.
pub type FactorPowers = Vec<(Factor, u64)>;

/// The factors of a term, without its sign.
pub(super) fn factors(flat: &Flat, term: Term) -> FactorPowers {
    let mut found = Vec::new();
    let (_, magnitude) = flat.magnitudes[term.coefficient as usize];
    if magnitude != UNIT {
        found.push((Factor::Constant(magnitude), 1));
    }
    for (atom, power) in &flat.products[term.product as usize] {
        let factor = if *power > 0 { Factor::Atom(*atom) } else { Factor::Reciprocal(*atom) };
        found.push((factor, power.unsigned_abs()));
    }
    found.sort_unstable();
    found
}

/// Two factors, the smaller first.
pub(super) type Pair = (Factor, Factor);

/// How each product is multiplied out, two factors at a time.
pub(super) struct Sharing {
    /// The factors of each pair.
    pub pairs: Vec<Pair>,
    /// What each product is in the end: a factor or a pair of pairs. An empty product is not here.
    pub whole: HashMap<FactorPowers, Factor>,
}

impl Sharing {
    pub fn new(wanted: impl Iterator<Item = FactorPowers>) -> Sharing {
        let mut places: HashMap<FactorPowers, usize> = HashMap::new();
        let mut products: Vec<FactorPowers> = Vec::new();
        for factors in wanted {
            if !places.contains_key(&factors) {
                places.insert(factors.clone(), products.len());
                products.push(factors);
            }
        }
        let mut pairs = share(&mut products);
        let finished: Vec<Option<Factor>> = products.iter().map(|left| finish(left, &mut pairs)).collect();
        let whole = places.into_iter().filter_map(|(factors, place)| Some((factors, finished[place]?)));
        let whole = whole.collect();
        Sharing { pairs, whole }
    }
}

/// Puts pairs into the products, as long as two places hold the same one.
fn share(products: &mut [FactorPowers]) -> Vec<Pair> {
    let mut counts: HashMap<Pair, (u64, Vec<usize>)> = HashMap::new();
    for (place, product) in products.iter().enumerate() {
        for (pair, count) in pairs_of(product) {
            let entry = counts.entry(pair).or_default();
            entry.0 += count;
            entry.1.push(place);
        }
    }
    let several =
        |(pair, (count, _)): (&Pair, &(u64, Vec<usize>))| (*count > 1).then_some((*count, Reverse(*pair)));
    let mut queue: BinaryHeap<(u64, Reverse<Pair>)> = counts.iter().filter_map(several).collect();
    let mut pairs: Vec<Pair> = Vec::new();
    while let Some((count, Reverse(pair))) = queue.pop() {
        let Some(entry) = counts.get(&pair) else { continue };
        if entry.0 != count {
            // it has lost some since; another entry stands for what it has gained
            if entry.0 > 1 && entry.0 < count {
                queue.push((entry.0, Reverse(pair)));
            }
            continue;
        }
        let Some((_, holders)) = counts.remove(&pair) else { continue };
        let new = Factor::Pair(pairs.len() as u32);
        pairs.push(pair);
        let mut gained: BTreeMap<Pair, u64> = BTreeMap::new();
        for place in holders {
            let times = pairs_of(&products[place]).find(|(p, _)| *p == pair).map_or(0, |(_, n)| n);
            if times == 0 {
                continue;
            }
            for (other, n) in pairs_of(&products[place]) {
                if let Some(entry) = counts.get_mut(&other) {
                    entry.0 -= n;
                }
            }
            replace(&mut products[place], pair, times, new);
            for (other, n) in pairs_of(&products[place]) {
                let entry = counts.entry(other).or_default();
                entry.0 += n;
                entry.1.push(place);
                gained.insert(other, entry.0);
            }
        }
        queue.extend(gained.into_iter().filter(|(_, n)| *n > 1).map(|(pair, n)| (n, Reverse(pair))));
    }
    pairs
}

/// Multiplies out the rest of a product: neighbours first, so that the chain is short.
fn finish(product: &FactorPowers, pairs: &mut Vec<Pair>) -> Option<Factor> {
    let mut left: Vec<Factor> =
        product.iter().flat_map(|(factor, count)| (0..*count).map(|_| *factor)).collect();
    while left.len() > 1 {
        let halved = left.chunks(2).map(|two| match two {
            [a, b] => {
                pairs.push((*a, *b));
                Factor::Pair(pairs.len() as u32 - 1)
            }
            _ => two[0],
        });
        left = halved.collect();
    }
    left.first().copied()
}

/// The pairs that a product holds, and how often.
fn pairs_of(product: &FactorPowers) -> impl Iterator<Item = (Pair, u64)> + '_ {
    product.iter().enumerate().flat_map(move |(i, (a, m))| {
        let itself = (*m > 1).then_some(((*a, *a), m / 2));
        let others = product[i + 1..].iter().map(move |(b, n)| ((*a, *b), *m.min(n)));
        itself.into_iter().chain(others)
    })
}

/// Puts a new factor in the place of a pair, so many times.
fn replace(product: &mut FactorPowers, pair: Pair, times: u64, new: Factor) {
    for (factor, count) in product.iter_mut() {
        *count -= times * (u64::from(*factor == pair.0) + u64::from(*factor == pair.1));
    }
    product.retain(|(_, count)| *count > 0);
    product.push((new, times));
    product.sort_unstable();
}
