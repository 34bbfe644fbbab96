//! The best unknowns without a first guess: a grid over the body's rate and its slope, and descents from there.
//!
//! What leaves least on the grid is let go on a few samples, what leaves least there on all. Coarse grids come first: most windows need no other. What is
//! accepted at once explains the readings, by chi-square where the noise is stated; only where nothing does the finer grids are searched.

use super::FirstState;
use super::descent::{Free, descend, deviations, refine};
use super::grid::Grid;
use super::integrals::Integrals;
use super::normal::{Look, Unknowns};

/// One pass over a grid.
struct Pass {
    grid: Grid,
    /// How many of its minima are let go on some samples.
    kept: usize,
    /// So many samples.
    samples: usize,
    /// How many of these are let go on all samples.
    polished: usize,
}

const fn pass(size: [usize; 2], looked_at: usize, [kept, samples, polished]: [usize; 3]) -> Pass {
    Pass { grid: Grid { size, samples: looked_at, softened: SOFTENED[0] }, kept, samples, polished }
}

const PASSES: [Pass; 4] = [
    pass([10, 5], 6, [5, 8, 3]),
    pass([16, 8], 8, [16, 12, 6]),
    pass([32, 16], 12, [40, 16, 10]),
    pass([96, 32], 16, [200, 20, 24]),
];

/// Rates below these parts of the largest are softened: while it is sought, and at the end.
const SOFTENED: [f64; 2] = [0.05, 0.002];

/// What is left of a contact, in parts of its length, counts as nothing where its noise is not known.
const NOTHING: f64 = 1e-6;

/// A body that is no disc turns within this factor like one of its size.
const UNLIKELY: f64 = 30.0;

/// What leaves more than so many variances of a contact is no state that carried errors explain.
const NEAR: f64 = 100.0;

pub(super) fn search(all: &Integrals) -> Option<FirstState> {
    let mut best: Option<(Unknowns, f64)> = None;
    for pass in &PASSES {
        for candidate in pass.candidates(all) {
            let (found, cost) = polished(all, candidate);
            if !is_body(all, &found) || best.is_some_and(|(_, least)| cost >= least) {
                continue;
            }
            best = Some((found, cost));
            if is_explained(all, cost) {
                return Some(first_state(all, &found, cost));
            }
        }
    }
    let (mut found, mut cost) = best?;
    if !is_nothing(all, cost) {
        let refined = refine(all, found, 30);
        if is_body(all, &refined.0) {
            (found, cost) = refined;
        }
    }
    Some(first_state(all, &found, cost))
}

/// A descent by all samples, by the errors of contacts as they are carried on where their noise is known.
fn polished(all: &Integrals, candidate: Unknowns) -> (Unknowns, f64) {
    let look = Look { stride: 1, softened: SOFTENED[1] * all.rate };
    let Some(sigma) = all.sigma else { return descend(all, candidate, Free::All, look, 30) };
    // two steps: what carries errors on takes the others
    let (found, cost) = descend(all, candidate, Free::All, look, 2);
    let is_near = cost <= NEAR * sigma * sigma * 2.0 * all.samples.len() as f64;
    if is_near && !is_nothing(all, cost) { refine(all, found, 8) } else { (found, cost) }
}

impl Pass {
    /// Where descents by all samples begin, those first that leave least of some.
    fn candidates(&self, all: &Integrals) -> Vec<Unknowns> {
        let look =
            Look { stride: (all.samples.len() / self.samples).max(1), softened: SOFTENED[0] * all.rate };
        let minima = self.grid.minima(all).into_iter().take(self.kept);
        let descents = minima.map(|(x, _)| {
            let (drawn, _) = descend(all, x, Free::Drawn, look, 8);
            descend(all, drawn, Free::All, look, 8)
        });
        let mut ends: Vec<(Unknowns, f64)> = descents.filter(|(_, cost)| cost.is_finite()).collect();
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        ends.into_iter().take(self.polished).map(|(x, _)| x).collect()
    }
}

/// Whether the body lies between the palms, and turns like one and not too fast.
fn is_body(all: &Integrals, x: &Unknowns) -> bool {
    let centre = [x[0], x[1]];
    let between = all.radii(centre).iter().all(|radius| *radius > 0.0);
    between
        && x[4].abs() <= all.fastest()
        && (x[5] - all.likely_log_k(centre)).abs() < UNLIKELY.ln()
        && x.iter().all(|value| value.is_finite())
}

/// Whether nothing is left.
fn is_nothing(all: &Integrals, cost: f64) -> bool {
    cost <= 2.0 * all.samples.len() as f64 * (NOTHING * all.length).powi(2)
}

/// Whether what is left is the noise of the contacts: below five deviations of the sum of as many squares.
fn is_explained(all: &Integrals, cost: f64) -> bool {
    let n = 2.0 * all.samples.len() as f64;
    let noise = all.sigma.unwrap_or(0.0).powi(2) * (n + 5.0 * (2.0 * n).sqrt());
    cost <= noise + n * (NOTHING * all.length).powi(2)
}

fn first_state(all: &Integrals, x: &Unknowns, cost: f64) -> FirstState {
    let centre = [x[0], x[1]];
    FirstState {
        radii: all.radii(centre),
        rate: x[4],
        gyration: ((-x[5]).exp() / all.mass).sqrt(),
        centre,
        velocity: [x[2], x[3]],
        receding: all.receding([x[2], x[3]]),
        deviations: all.sigma.map_or([0.0; 3], |sigma| deviations(all, x).map(|deviation| sigma * deviation)),
        misfit: (cost / (2.0 * all.samples.len() as f64)).sqrt(),
    }
}
