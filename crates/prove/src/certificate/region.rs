//! A region, and how far the proof has come.

use super::answer::RegionAnswer;
use super::boxes::FreeCoordinate;
use super::problem::Problem;
use super::progress::{Limits, Progress, Searches};
use super::rows::RegionRows;
use super::search::Plane;
use dashu::rational::RBig;
use palmistry_budget::{OF_A_QUESTION, paid};
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::System;
use palmistry_math::expression::Symbol;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// The question whether some rows of a system have full rank all over a box, and what is known of the answer.
pub struct Region {
    pub(super) problem: Problem,
    pub(super) searches: Searches,
    /// The coordinates of the map, by their places among the ranges.
    pub(super) map: Option<(usize, usize)>,
}

impl Region {
    /// The question for the sample box of a system, with some ranges replaced; `map` are the coordinates of which a map is
    /// drawn, two that matter if none are named. Nothing is proved yet.
    ///
    /// # Errors
    /// In words: no states or outputs, a pole everywhere, no rows of its own, a symbol without a range, a map of a
    /// coordinate on which nothing depends.
    pub fn new(
        system: &mut System,
        rows: RegionRows,
        ranges: &BTreeMap<Symbol, (RBig, RBig)>,
        map: Option<(Symbol, Symbol)>,
    ) -> Result<Region, String> {
        // what is done once is paid from a budget; boxes are looked at as often as the user asks
        let mut copy = system.clone();
        let problem = paid(OF_A_QUESTION, || Problem::new(&mut copy, rows, ranges))
            .map_err(|spent| format!("cut off: {spent}, and no question may take more"))??;
        *system = copy;
        let map = match map {
            Some((x, y)) => {
                let place = |symbol: Symbol| {
                    let matters =
                        |place: &usize| problem.ranges[*place].symbol == symbol && problem.matters(*place);
                    (0..problem.ranges.len()).find(matters).ok_or_else(|| {
                        let known = (0..problem.ranges.len()).filter(|place| problem.matters(*place));
                        let known: Vec<&str> =
                            known.map(|place| problem.ranges[place].name.as_str()).collect();
                        format!(
                            "no map of '{}': the minors that are used depend on {}",
                            system.symbol_name(symbol),
                            known.join(", ")
                        )
                    })
                };
                Some((place(x)?, place(y)?))
            }
            None => problem.coordinates_that_matter_most(),
        };
        let mut searches = Searches::new(&problem.parts);
        for (search, part) in searches.searches.iter_mut().zip(&problem.parts) {
            let local = |place: usize| {
                let symbol = problem.ranges[place].symbol;
                part.chart.coordinates().iter().position(|coordinate| coordinate.symbol == symbol)
            };
            search.most_kept = KEPT;
            if let Some((x, y)) = map {
                search.plane = Plane { x: local(x), y: local(y) };
            }
        }
        Ok(Region { problem, searches, map })
    }

    /// Goes on until a limit is reached, nothing is left to do, or an interrupt comes. `progress` is called every few
    /// milliseconds. What comes out for a number of boxes depends neither on threads nor on interruptions; for a time it
    /// depends on the machine.
    pub fn run(&mut self, limits: Limits, interrupt: &AtomicBool, progress: &(dyn Fn(Progress) + Sync)) {
        if !self.problem.minors.is_empty() {
            self.searches.run(&self.problem.parts, limits, interrupt, progress);
        }
    }

    /// Looks at all boxes of at most so many halvings, unless the time of the limits or an interrupt ends it before. What comes out depends on
    /// where the search stands and on that number, and on nothing else: not on threads, and not on how boxes are dealt out
    /// ([`Region::take_share`]).
    pub fn run_to_depth(
        &mut self,
        halvings: usize,
        limits: Limits,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(Progress) + Sync),
    ) {
        if !self.problem.minors.is_empty() {
            self.searches.run_to_depth(&self.problem.parts, limits, halvings, interrupt, progress);
        }
    }

    /// The proved fraction of the volume, rounded down.
    pub fn proved(&self) -> f64 {
        self.searches.proved()
    }

    /// The number of boxes that were looked at.
    pub fn boxes(&self) -> u64 {
        self.searches.boxes()
    }

    /// Whether nothing is left to do: no box is open, or nothing can be proved at all.
    pub fn is_finished(&self) -> bool {
        self.problem.minors.is_empty() || self.searches.is_finished()
    }

    /// The sides of the box.
    pub fn ranges(&self) -> &[FreeCoordinate] {
        &self.problem.ranges
    }
}

/// So many proved boxes of each part are kept if nothing else is said.
const KEPT: usize = 2000;

/// The fraction of its sample box on which a system has full rank, after so many boxes: [`certify_region`] without an interrupt.
///
/// # Errors
/// As [`Region::new`].
pub fn certify(system: &mut System, boxes: u64) -> Result<RegionAnswer, String> {
    certify_region(system, boxes, &UNINTERRUPTED)
}

/// The certificate for the sample box of a system after so many boxes: the short version, with the same result on every machine.
///
/// # Errors
/// As [`Region::new`].
pub fn certify_region(
    system: &mut System,
    boxes: u64,
    interrupt: &AtomicBool,
) -> Result<RegionAnswer, String> {
    let mut region = Region::new(system, RegionRows::default(), &BTreeMap::new(), None)?;
    region.run(Limits { seconds: None, boxes: Some(boxes) }, interrupt, &|_| ());
    Ok(region.answer())
}

impl Problem {
    /// Whether anything depends on a side of the box.
    pub(super) fn matters(&self, place: usize) -> bool {
        let symbol = self.ranges[place].symbol;
        self.parts.iter().any(|part| part.chart.coordinates().iter().any(|c| c.symbol == symbol))
    }

    /// Two coordinates of the part with the most factors, those that most of them depend on; where no part has two, of two
    /// parts.
    fn coordinates_that_matter_most(&self) -> Option<(usize, usize)> {
        let mut counted: Vec<(usize, usize, usize)> = Vec::new();
        for part in &self.parts {
            let size = part.chart.coordinates().len();
            for (local, coordinate) in part.chart.coordinates().iter().enumerate() {
                let uses = part.factors.iter().filter(|f| f.tape.coordinates.contains(&local)).count();
                let place = self.ranges.iter().position(|range| range.symbol == coordinate.symbol)?;
                counted.push((size.min(2), uses, place));
            }
        }
        counted.sort_by_key(|(size, uses, _)| std::cmp::Reverse((*size, *uses))); // stable
        match counted.as_slice() {
            [first, second, ..] => Some((first.2.min(second.2), first.2.max(second.2))),
            _ => None,
        }
    }
}
