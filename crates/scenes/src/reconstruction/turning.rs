//! Initial values for a body of unknown motion: rates on a grid, each with a constant acceleration.
//!
//! Along a given motion the contacts are linear in the support function, so that each such motion has one body that explains them best, in one step and without a first
//! guess. A body that hardly turns is explained by many of them; a search from each then decides by the law of motion.

use super::candidate::Best;
use super::descent::{joined, solved, triangle_of};
use super::law::pose;
use super::record::{Unknowns, WholeRecord};
use super::series::convex_weights;
use nalgebra::DMatrix;
use palmistry_bodies::shape::{SupportFunction, SupportSeries};
use std::sync::atomic::AtomicBool;

/// Harmonics of a body that is found along a given motion.
const ORDER: usize = 6;

/// Rates on the grid on either side of zero, and accelerations, relative to the one that stops the fastest rate within the first part of the record.
const RATES: i32 = 30;
const BENDS: i32 = 10;

/// This many ends go on from one part of the record to the next.
const KEPT: [usize; 4] = [24, 16, 12, 6];

/// This many samples of the part are used.
const LOOKED_AT: usize = 100;

/// The standard deviation of contacts relative to the size of the body, where a motion is only near the true one.
const WORTH: f64 = 1e-3;

/// The standard deviation, in rad, of the angle at the end of the part that the law of motion adds to a given motion.
const TURN: f64 = 1e-2;

/// Two ends of searches are the same if their sums of squares and rates differ by no more than this fraction, sums by no more than a unit.
const SAME: f64 = 1e-3;

fn is_same(a: &Best, b: &Best) -> bool {
    let most = SAME * a.x.rate.abs().max(b.x.rate.abs());
    (a.cost - b.cost).abs() <= SAME * a.cost.max(b.cost) + 1.0 && (a.x.rate - b.x.rate).abs() <= most
}

/// A motion from the angle of the first sample on.
#[derive(Clone, Copy)]
struct Given {
    /// At the first sample, in rad/s.
    rate: f64,
    /// In rad/s^2.
    acceleration: f64,
}

impl WholeRecord {
    /// The different ends of searches through the record from each rate of the grid, the best first.
    pub fn begun_by_turning(&self, interrupt: &AtomicBool) -> Vec<Best> {
        let mut begins = self.along_a_grid();
        let mut found: Vec<Best> = Vec::new();
        for (part, kept) in self.parts().into_iter().zip(KEPT) {
            let ends = begins.into_iter().filter_map(|begin| self.low(begin, part, interrupt));
            let mut ends: Vec<Best> = ends.collect();
            ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            found.clear();
            for end in ends {
                if found.len() < kept && !found.iter().any(|known| is_same(known, &end)) {
                    found.push(end);
                }
            }
            begins = found.iter().map(|end| end.x.clone()).collect();
        }
        found
    }

    /// For each rate of a grid that is fine near zero the acceleration that explains the first part of the record best, by the contacts and by the law of motion in the mean.
    fn along_a_grid(&self) -> Vec<Unknowns> {
        let discs = self.discs();
        let Some(disc) = discs.first() else { return Vec::new() };
        // a body that begins at rest is accelerated all the same
        let fastest = self.fastest(disc.support.mean());
        let rows = self.parts()[0];
        let span = self.times[rows - 1] - self.times[0];
        let places: Vec<usize> = (0..rows).step_by(rows.div_ceil(LOOKED_AT).max(1)).collect();
        let cubes = |n: i32| (-n..=n).map(move |i| (f64::from(i) / f64::from(n)).powi(3));
        let best = |rate: f64| {
            let tried = cubes(BENDS).filter_map(|bend| {
                let given = Given { rate, acceleration: bend * fastest / span };
                let (contacts_miss, x) = self.along(given, &places, disc)?;
                let turn_missed = 0.5 * span * span * self.acceleration_missed(given, &places, &x);
                Some((contacts_miss + (turn_missed / TURN).powi(2), x))
            });
            tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, x)| x)
        };
        match self.rate {
            Some(rate) => best(rate).into_iter().collect(),
            None => cubes(RATES).filter_map(|rate| best(rate * fastest)).collect(),
        }
    }

    /// Time, angle and rate of a given motion at a sample.
    fn given_at(&self, given: Given, place: usize) -> (f64, f64, f64) {
        let since = self.times[place] - self.times[0];
        let phi = self.phi + since * (given.rate + 0.5 * since * given.acceleration);
        (self.times[place], phi, given.rate + since * given.acceleration)
    }

    /// The body that explains samples best along a given motion, and its sum of squares in units of [`WORTH`].
    fn along(&self, given: Given, places: &[usize], disc: &Unknowns) -> Option<(f64, Unknowns)> {
        let prior = convex_weights(self.size(), ORDER);
        let p = prior.len();
        let round = SupportSeries { mean: disc.support.mean(), harmonics: vec![[0.0; 2]; ORDER] };
        let round = SupportFunction::from(round);
        let worth = WORTH * self.size();
        let mut rows = DMatrix::zeros(2 * places.len(), p + 1);
        for (i, place) in places.iter().enumerate() {
            let (time, phi, _) = self.given_at(given, *place);
            let palms = self.palms_at(time);
            let bases = palms.normals(phi).map(|angle| round.basis(angle));
            for j in 0..=p {
                let contacts = match j < p {
                    true => {
                        let by = bases.each_ref().map(|basis| [basis[j][0], basis[j][1], 0.0]);
                        pose(&palms, &by, 0.0, disc.gyration, 0.0).contacts
                    }
                    false => [self.contacts[0][*place], self.contacts[1][*place]],
                };
                for (palm, contact) in contacts.into_iter().enumerate() {
                    rows[(2 * i + palm, j)] = contact / worth;
                }
            }
        }
        let triangle = joined(&triangle_of(rows), &prior, &vec![0.0; p]);
        let support = round.with(solved(&triangle)?.as_slice())?;
        Some((triangle[(p, p)].powi(2), Unknowns { rate: given.rate, support, ..disc.clone() }))
    }

    /// The mean difference between the acceleration by the law of motion and the given one, in rad/s^2.
    fn acceleration_missed(&self, given: Given, places: &[usize], x: &Unknowns) -> f64 {
        let missed = places.iter().map(|place| {
            let (time, phi, rate) = self.given_at(given, *place);
            self.pose(time, phi, rate, x).acceleration - given.acceleration
        });
        missed.sum::<f64>() / places.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Experiment, Scene};

    /// Section 4.6, which begins at rest and says so: its only rate is accelerated all the same, and the result explains the first part better than a body at rest does.
    #[test]
    fn a_body_that_begins_at_rest_is_bent() {
        let text = include_str!("../../../../proofs/moll2002/scenes/section_4_6.toml");
        let scene = Scene::parse("../../proofs/moll2002/scenes/section_4_6.toml", text).unwrap();
        let experiment = Experiment::new(scene, None).unwrap();
        let mut record = WholeRecord::of(&experiment, 1e-3).unwrap();
        assert_eq!(record.rate, Some(0.0));
        record.sigma = 1e-3;
        let starts = record.along_a_grid();
        assert_eq!(starts.len(), 1);
        let places: Vec<usize> = (0..record.parts()[0]).collect();
        let disc = &record.discs()[0];
        let (_, unbent) = record.along(Given { rate: 0.0, acceleration: 0.0 }, &places, disc).unwrap();
        let left = |x: &Unknowns| record.squares(&record.follow(x, places.len(), false).unwrap());
        assert!(left(&starts[0]) < 0.5 * left(&unbent), "{:e} {:e}", left(&starts[0]), left(&unbent));
    }
}
