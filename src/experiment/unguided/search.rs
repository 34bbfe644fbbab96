//! The best unknowns without a first guess: a grid over the body's rate, and descents from there.
//!
//! At each rate of the grid the centre and its velocity are sought for a body that turns like a disc; where the residuals are smaller than at the
//! rates beside, all unknowns are let go. Coarse grids come first: most windows need no other. What is accepted at once explains the readings.

use super::FirstState;
use super::descent::{Free, at_one_rate, descend, deviations, refine};
use super::integrals::Integrals;
use super::normal::{Look, Unknowns};

/// One pass over the grid.
struct Pass {
    /// Rates, from one end to the other.
    rates: usize,
    /// Samples that are looked at.
    samples: usize,
    /// Steps at each rate.
    steps: usize,
    /// How many are let go.
    kept: usize,
    /// Begins where the normals meet, by linear least squares, from the state at the rate before.
    starts: [bool; 3],
}

const PASSES: [Pass; 4] = [
    Pass { rates: 10, samples: 8, steps: 3, kept: 3, starts: [true, false, false] },
    Pass { rates: 16, samples: 16, steps: 5, kept: 6, starts: [false, true, false] },
    Pass { rates: 32, samples: 20, steps: 8, kept: 10, starts: [true, true, true] },
    Pass { rates: 128, samples: 40, steps: 12, kept: 24, starts: [true, true, true] },
];

/// Rates below these parts of the largest are softened: while it is sought, and at the end.
const SOFTENED: [f64; 2] = [0.05, 0.002];

/// What is left of a contact, in parts of its length, counts as nothing where its noise is not known.
const NOTHING: f64 = 1e-6;

/// A body that is no disc turns within this factor like one of its size.
const UNLIKELY: f64 = 30.0;

pub(super) fn search(all: &Integrals) -> Option<FirstState> {
    let mut best: Option<(Unknowns, f64)> = None;
    for pass in &PASSES {
        for candidate in pass.candidates(all) {
            let coarse = Look { stride: pass.stride(all), softened: SOFTENED[0] * all.rate };
            let (drawn, _) = descend(all, candidate, Free::Drawn, coarse, 12);
            let fine = Look { stride: 1, softened: SOFTENED[1] * all.rate };
            let (mut found, mut cost) = descend(all, drawn, Free::All, fine, 30);
            if found[4].abs() > all.fastest() {
                continue;
            }
            if !is_nothing(all, cost) {
                (found, cost) = refine(all, found, 8);
            }
            if !is_body(all, &found) || best.is_some_and(|(_, least)| cost >= least) {
                continue;
            }
            best = Some((found, cost));
            if is_explained(all, cost) {
                return Some(first_state(all, &found, cost));
            }
        }
    }
    best.map(|(found, cost)| first_state(all, &found, cost))
}

impl Pass {
    fn stride(&self, all: &Integrals) -> usize {
        (all.samples.len() / self.samples).max(1)
    }

    /// The best states of bodies like discs, those first that leave least.
    fn candidates(&self, all: &Integrals) -> Vec<Unknowns> {
        let look = Look { stride: self.stride(all), softened: SOFTENED[0] * all.rate };
        let mut profile: Vec<(Unknowns, f64)> = Vec::with_capacity(self.rates);
        for i in 0..self.rates {
            // denser about zero
            let part = 2.0 * i as f64 / (self.rates - 1) as f64 - 1.0;
            let rate = all.rate * (1.5 * part).sinh() / 1.5f64.sinh();
            let [x, y] = all.meeting;
            let meeting = || descend(all, [x, y, 0.0, 0.0, rate, 0.0], Free::Velocity, look, 1).0;
            let before = || profile.last().map(|(x, _)| [x[0], x[1], x[2], x[3], rate, x[5]]);
            let starts = [
                self.starts[0].then(meeting),
                self.starts[1].then(|| at_one_rate(all, rate, look)).flatten(),
                self.starts[2].then(before).flatten(),
            ];
            let ends = starts.into_iter().flatten().map(|x| descend(all, x, Free::Motion, look, self.steps));
            let best = ends.filter(|(_, cost)| cost.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1));
            profile.push(best.unwrap_or(([x, y, 0.0, 0.0, rate, 0.0], f64::INFINITY)));
        }
        let at = |i: usize| profile.get(i).map_or(f64::INFINITY, |(_, cost)| *cost);
        let is_least =
            |i: &usize| at(*i) <= at(i.wrapping_sub(1)) && at(*i) <= at(i + 1) && at(*i).is_finite();
        let mut least: Vec<usize> = (0..self.rates).filter(is_least).collect();
        least.sort_by(|a, b| at(*a).total_cmp(&at(*b)));
        least.into_iter().take(self.kept).map(|i| profile[i].0).collect()
    }
}

/// Whether the body lies between the palms, and turns like one.
fn is_body(all: &Integrals, x: &Unknowns) -> bool {
    let centre = [x[0], x[1]];
    let between = all.radii(centre).iter().all(|radius| *radius > 0.0);
    between
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
        deviations: deviations(all, x).map(|deviation| deviation * all.sigma.unwrap_or(0.0)),
        misfit: (cost / (2.0 * all.samples.len() as f64)).sqrt(),
    }
}
