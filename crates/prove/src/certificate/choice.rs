//! Which minors to keep: few, that together are far from zero in as much of the box as can be, and whose factors depend on
//! few coordinates.
//!
//! A minor with a factor of many coordinates ties these together in one part. So there are several pools to choose from,
//! by the number of coordinates that a factor may have, and short searches decide between them.

use super::boxes::{Chart, Side};
use super::collector::{Collector, Ranges};
use super::factor::Factor;
use super::part::{Demand, FactoredMinor, Part};
use super::progress::{Limits, Searches};
use super::slots::Slots;
use super::workspace::Workspace;
use palmistry_math::expression::{Graph, NodeId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// States at which the minors are compared.
const SAMPLES: usize = 400;
/// No more minors are kept.
const MOST: usize = 24;
/// A further minor has to raise the mean logarithm of the distance from the zeros by so much.
const LEAST_GAIN: f64 = 0.005;
/// A state nearer than this to a zero of all minors is given up.
const NEAREST: f64 = 1e-4;
/// Operations of the searches by which pools are compared, if every box needs all factors, and of those of the best two.
const FIRST_TRIAL: usize = 1 << 22;
const SECOND_TRIAL: usize = 1 << 23;

/// The minors to keep and the parts that they lead to; none where there are no minors.
///
/// # Errors
/// In words: a symbol has neither range nor value.
pub(super) fn choose(
    graph: &Graph,
    collector: &Collector,
    ranges: &Ranges,
    guards: &[usize],
    minors: Vec<FactoredMinor>,
    avoid: &[NodeId],
) -> Result<(Vec<FactoredMinor>, Vec<Part>), String> {
    if minors.is_empty() {
        return Ok((minors, Vec::new()));
    }
    let mut needed: Vec<usize> =
        minors.iter().flat_map(|minor| minor.factors.iter().chain(&minor.below)).copied().collect();
    needed.sort_unstable();
    needed.dedup();
    let mut slots = Slots::default();
    let factors = collector.factors(graph, &needed, ranges, &mut slots)?;
    let chart = Chart::new(ranges.free.clone(), slots);
    let place = |factor: &usize| needed.binary_search(factor).unwrap_or(0);
    let ratios = ratios(&chart, &factors);

    let size = |minor: &FactoredMinor| -> usize {
        minor.factors.iter().map(|f| factors[place(f)].tape.coordinates.len()).max().unwrap_or(0)
    };
    let mut sizes: Vec<usize> = minors.iter().map(size).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let mut trials: Vec<Trial> = Vec::new();
    for most in sizes {
        let pool: Vec<&FactoredMinor> = minors.iter().filter(|minor| size(minor) <= most).collect();
        let logarithms = distances(&pool, &ratios, place);
        let chosen: Vec<FactoredMinor> =
            greedily(&logarithms).into_iter().map(|at| pool[at].clone()).collect();
        for asked_of_all in [0, 1] {
            let demand = Demand { guards, minors: &chosen, avoid, asked_of_all };
            let parts = demand.parts(graph, collector, ranges)?;
            let shape = parts.iter().map(Part::shape).collect();
            if trials.iter().any(|trial| trial.shape == shape && trial.minors == chosen) {
                continue;
            }
            let mut trial = Trial { minors: chosen.clone(), searches: Searches::new(&parts), parts, shape };
            trial.run(FIRST_TRIAL);
            trials.push(trial);
        }
    }
    // the two best go on: what is best with few boxes need not be so with many
    trials.sort_by(|a, b| b.searches.proved().total_cmp(&a.searches.proved())); // stable
    trials.truncate(2);
    if trials.len() == 2 {
        trials.iter_mut().for_each(|trial| trial.run(SECOND_TRIAL));
    }
    let best =
        trials.into_iter().reduce(|a, b| if b.searches.proved() > a.searches.proved() { b } else { a });
    Ok(best.map_or((Vec::new(), Vec::new()), |trial| (trial.minors, trial.parts)))
}

/// Some minors and the parts that they lead to, and a short search.
struct Trial {
    minors: Vec<FactoredMinor>,
    parts: Vec<Part>,
    shape: Vec<(usize, usize, usize)>,
    searches: Searches,
}

impl Trial {
    fn run(&mut self, operations: usize) {
        let each: usize = self.parts.iter().flat_map(|part| &part.factors).map(|f| f.tape.len()).sum();
        let limits = Limits { seconds: None, boxes: Some((operations / each.max(1)).max(1000) as u64) };
        self.searches.run(&self.parts, limits, &false.into(), &|_| ());
    }
}

/// The places of the minors to keep, best first: each the one that takes most states further from the zeros.
fn greedily(distances: &[Vec<f64>]) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut reached = vec![NEAREST.ln(); SAMPLES];
    while chosen.len() < MOST {
        let gain = |minor: &Vec<f64>| -> f64 {
            minor.iter().zip(&reached).map(|(d, r)| (d - r).max(0.0)).sum::<f64>() / SAMPLES as f64
        };
        let best = (0..distances.len())
            .filter(|place| !chosen.contains(place))
            .map(|place| (gain(&distances[place]), place))
            .reduce(|a, b| if b.0 > a.0 { b } else { a });
        match best {
            Some((gain, place)) if gain > LEAST_GAIN || chosen.is_empty() => {
                for (reached, distance) in reached.iter_mut().zip(&distances[place]) {
                    *reached = reached.max(*distance);
                }
                chosen.push(place);
            }
            _ => break,
        }
    }
    chosen
}

/// The logarithm of the distance of each minor's zeros from each state, at most zero. Factors that all minors have are
/// left out: they are no reason to prefer one of them.
fn distances(
    minors: &[&FactoredMinor],
    ratios: &[Vec<f64>],
    place: impl Fn(&usize) -> usize,
) -> Vec<Vec<f64>> {
    let of = |minor: &&FactoredMinor| {
        let own: Vec<usize> = minor
            .factors
            .iter()
            .filter(|factor| !minors.iter().all(|other| other.factors.contains(factor)))
            .map(&place)
            .collect();
        let least = |ratios: &Vec<f64>| own.iter().map(|factor| ratios[*factor]).fold(1.0, f64::min);
        ratios.iter().map(|ratios| least(ratios).max(NEAREST).ln()).collect()
    };
    minors.iter().map(of).collect()
}

/// For each drawn state the value of each factor over the change that its slopes would make across the whole box.
fn ratios(chart: &Chart, factors: &[Factor]) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(0x6d69_6e6f_7273); // any fixed seed: the same file gives the same minors
    let mut workspace = Workspace::default();
    let draw = |_| {
        let side = |_| Side { index: rng.random_range(0..1 << DEPTH), depth: DEPTH };
        let sides: Vec<Side> = chart.coordinates().iter().map(side).collect();
        let mut at = workspace.begin(chart, &sides);
        at.widen(f64::from(1u32 << DEPTH));
        factors.iter().map(|factor| factor.guess(&mut at).ratio).collect()
    };
    (0..SAMPLES).map(draw).collect()
}

/// States are drawn on a grid of so many halvings, so that few sines are needed.
const DEPTH: u8 = 6;
