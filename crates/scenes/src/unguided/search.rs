//! The best unknowns without a first guess: a grid over the body's rate and its slope, and descents from there.
//!
//! The best points of the grid are optimised on a few samples, and the best of these on all. Coarse grids come first: most windows need no other. A state
//! accepted at once explains the measurements, by chi-square where the noise is stated; the finer grids are searched only where none does.

use super::FirstState;
use super::descent::{End, Free, descend, deviations, refine};
use super::grid::Grid;
use super::integrals::Integrals;
use super::normal::{Look, Unknowns};

/// One pass over a grid.
struct Pass {
    grid: Grid,
    /// The number of its minima that are optimised on some samples.
    kept: usize,
    /// The number of these samples.
    samples: usize,
    /// The number of these that are optimised on all samples.
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

/// Rates below these fractions of the largest are softened: during the search, and at the end.
const SOFTENED: [f64; 2] = [0.05, 0.002];

/// A residual of a contact below this fraction of its length counts as zero where its noise is not known.
const NOTHING: f64 = 1e-6;

/// `k` of a body is within this factor of that of a disc of its size.
const UNLIKELY: f64 = 30.0;

/// A residual on some samples below this, relative to a contact's length or in deviations of its noise, is likely to be that of the state.
const LIKELY: [f64; 2] = [1e-4, 3.0];

/// A state within this many deviations of chi-square is taken at once, without a search for others; and the best one of a pass is taken up to the second.
const SURELY: f64 = 2.5;
const BARELY: f64 = 5.0;

/// Above this many variances of a contact no carried errors explain the residual.
const NEAR: f64 = 100.0;

pub(super) fn search(all: &Integrals) -> Option<FirstState> {
    let mut best: Option<End> = None;
    for pass in &PASSES {
        let is_sure = pass.is_explained(all, |candidate| {
            let end = polished(all, candidate);
            let is_best = is_body(all, &end.x) && best.as_ref().is_none_or(|best| end.cost < best.cost);
            let is_sure = is_best && is_explained(all, end.cost, SURELY);
            if is_best {
                best = Some(end);
            }
            is_sure
        });
        if let Some(best) = best.as_ref().filter(|best| is_sure || is_explained(all, best.cost, BARELY)) {
            return Some(first_state(all, best));
        }
    }
    let best = best?;
    if !is_nothing(all, best.cost) {
        let refined = refine(all, best.x, 30);
        if is_body(all, &refined.x) {
            return Some(first_state(all, &refined));
        }
    }
    Some(first_state(all, &best))
}

/// A descent on all samples, with whitened residuals where the noise of the contacts is known.
fn polished(all: &Integrals, candidate: Unknowns) -> End {
    let look = Look { stride: 1, softened: SOFTENED[1] * all.rate };
    // two steps where the descent on whitened residuals takes the others
    let steps = if all.sigma.is_some() { 2 } else { 30 };
    let (x, cost) = descend(all, candidate, Free::All, look, steps);
    let near = NEAR * all.sigma.unwrap_or(0.0).powi(2) * 2.0 * all.samples.len() as f64;
    if cost <= near && !is_nothing(all, cost) { refine(all, x, 8) } else { End { x, cost, carried: None } }
}

impl Pass {
    /// Tries the ends of descents by some samples on all, until one of them explains the measurements. Ends with a small residual are tried at once,
    /// the others, sorted by their residual, when all have ended.
    fn is_explained(&self, all: &Integrals, mut explains: impl FnMut(Unknowns) -> bool) -> bool {
        let look =
            Look { stride: (all.samples.len() / self.samples).max(1), softened: SOFTENED[0] * all.rate };
        let rows = 2.0 * all.samples.len().div_ceil(look.stride) as f64;
        let likely = all.sigma.map_or(LIKELY[0] * all.length, |sigma| LIKELY[1] * sigma);
        let mut ends = Vec::new();
        let mut tried = 0;
        for (start, _) in self.grid.minima(all).into_iter().take(self.kept) {
            let (drawn, _) = descend(all, start, Free::Drawn, look, 8);
            let (end, cost) = descend(all, drawn, Free::All, look, 8);
            let is_likely = cost <= rows * likely * likely && tried < self.polished;
            if is_likely {
                tried += 1;
                if explains(end) {
                    return true;
                }
            }
            if cost.is_finite() {
                ends.push((end, cost, is_likely));
            }
        }
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        ends.into_iter().take(self.polished).any(|(end, _, was_tried)| !was_tried && explains(end))
    }
}

/// Whether the body lies between the palms, has a plausible inertia and does not turn too fast.
fn is_body(all: &Integrals, x: &Unknowns) -> bool {
    let centre = [x[0], x[1]];
    let between = all.radii(centre).iter().all(|radius| *radius > 0.0);
    between
        && x[4].abs() <= all.fastest()
        && (x[5] - all.likely_log_k(centre)).abs() < UNLIKELY.ln()
        && x.iter().all(|value| value.is_finite())
}

/// Whether the residual is zero.
fn is_nothing(all: &Integrals, cost: f64) -> bool {
    cost <= 2.0 * all.samples.len() as f64 * (NOTHING * all.length).powi(2)
}

/// Whether the residual is the noise of the contacts: at most so many deviations of the sum of as many squares above its mean.
fn is_explained(all: &Integrals, cost: f64, deviations: f64) -> bool {
    let n = 2.0 * all.samples.len() as f64;
    let noise = all.sigma.unwrap_or(0.0).powi(2) * (n + deviations * (2.0 * n).sqrt());
    cost <= noise + n * (NOTHING * all.length).powi(2)
}

fn first_state(all: &Integrals, end: &End) -> FirstState {
    let (x, cost) = (end.x, end.cost);
    let centre = [x[0], x[1]];
    FirstState {
        radii: all.radii(centre),
        rate: x[4],
        gyration: ((-x[5]).exp() / all.mass).sqrt(),
        centre,
        velocity: [x[2], x[3]],
        receding: all.receding([x[2], x[3]]),
        deviations: all
            .sigma
            .map_or([0.0; 3], |sigma| deviations(all, end).map(|deviation| sigma * deviation)),
        rms_residual: (cost / (2.0 * all.samples.len() as f64)).sqrt(),
    }
}
