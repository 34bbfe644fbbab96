//! The answer so far: the volumes of the parts multiplied exactly, and rounded once, in the end.

use super::answer::{BoxStanding, Patch, RegionAnswer, RegionMap, RegionMinor};
use super::boxes::{FreeCoordinate, Side};
use super::explain::{Why, explain};
use super::part::Part;
use super::part_volumes::{PartVolumes, part_answer, standing};
use super::region::Region;
use super::search::Search;
use dashu::rational::RBig;
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::CoordinateRange;
use palmistry_math::expression::Symbol;
use palmistry_math::number::{Interval, RealNumber};
use std::sync::atomic::AtomicBool;

/// A map has no more rectangles.
const MOST_PATCHES: usize = 40_000;

fn down(value: &RBig) -> f64 {
    Interval::from_rational(value).low().clamp(0.0, 1.0)
}

fn up(value: &RBig) -> f64 {
    Interval::from_rational(value).high().clamp(0.0, 1.0)
}

impl Region {
    /// What is known so far. Takes a few microseconds for each open box.
    pub fn answer(&self) -> RegionAnswer {
        self.answer_until(&UNINTERRUPTED)
    }

    /// The same within some ten milliseconds from an interrupt on: only the largest open boxes are explained then, and the volume of the
    /// others counts as undecided. What is proved is the same.
    pub fn answer_until(&self, interrupt: &AtomicBool) -> RegionAnswer {
        let (problem, searches) = (&self.problem, &self.searches);
        let volumes: Vec<PartVolumes> = problem
            .parts
            .iter()
            .zip(&searches.searches)
            .map(|(part, search)| PartVolumes::new(part, search, interrupt))
            .collect();
        // a state is the product of what it is in each part
        let nothing = problem.parts.is_empty();
        let product = |of: &dyn Fn(&PartVolumes, &Search) -> RBig| -> RBig {
            let factors =
                volumes.iter().zip(&searches.searches).map(|(part_volumes, search)| of(part_volumes, search));
            if nothing { RBig::ZERO } else { factors.fold(RBig::ONE, |product, factor| product * factor) }
        };
        let vanishes = |why: Why, _: bool| matches!(why, Why::Vanishes { .. });
        let proved = searches.exact();
        let defined = product(&|part_volumes, search| search.proved.exact() + part_volumes.sum(vanishes));
        let of_sampled = product(&|part_volumes, _| {
            if part_volumes.sampled.is_zero() {
                return RBig::ZERO; // nothing is known to be sampled
            }
            let unproved = part_volumes.sum(|_, avoided| !avoided) / &part_volumes.sampled;
            if unproved < RBig::ONE { RBig::ONE - unproved } else { RBig::ZERO }
        });
        let parts = problem.parts.iter().zip(&volumes).zip(&searches.searches);
        RegionAnswer {
            file: problem.file.clone(),
            title: problem.title.clone(),
            fields: problem.fields.clone(),
            dimension: problem.dimension,
            columns: problem.columns,
            rows: problem.rows,
            order: problem.order,
            ranges: problem
                .ranges
                .iter()
                .cloned()
                .enumerate()
                .map(|(at, c)| (c, problem.matters(at)))
                .collect(),
            minors: self.minors(),
            candidates: problem.candidates,
            all_minors: problem.all_minors,
            parts: parts
                .map(|((part, part_volumes), search)| part_answer(part, part_volumes, search))
                .collect(),
            proved: down(&proved),
            proved_of_sampled: down(&of_sampled),
            minor_vanishes: down(&(&defined - &proved)),
            rest: up(&(RBig::ONE - defined)),
            avoid: problem.avoid.clone(),
            by_default: problem.by_default.clone(),
            boxes: searches.boxes(),
            open_boxes: searches.searches.iter().map(|search| search.unproved_boxes() as u64).sum(),
            seconds: searches.seconds,
            finished: self.is_finished(),
            curve: searches.whole_curve(),
            largest: volumes
                .iter()
                .flat_map(|part_volumes| part_volumes.largest.iter().map(|(open, _)| open.clone()))
                .collect(),
            map: self.map(&volumes),
            remarks: self.remarks(),
            nowhere: problem.nowhere.clone(),
        }
    }

    fn remarks(&self) -> Vec<String> {
        let mut remarks = self.problem.remarks.clone();
        if self.searches.searches.iter().any(Search::is_full) {
            remarks.push(
                "as many boxes are open as are kept in memory; choose a smaller box with --box".to_owned(),
            );
        }
        remarks
    }

    fn minors(&self) -> Vec<RegionMinor> {
        let parts = &self.problem.parts;
        // what depends on nothing is no place at which to vanish
        let texts = |part: &Part, list: &[usize]| -> Vec<String> {
            let varies = |factor: &&usize| !part.factors[**factor].tape.coordinates.is_empty();
            list.iter().filter(varies).map(|factor| part.factors[*factor].text.clone()).collect()
        };
        let of = |(place, minor): (usize, &super::part::FactoredMinor)| {
            let mut factors: Vec<String> = parts.iter().flat_map(|part| texts(part, &part.common)).collect();
            for part in parts {
                let own = part.alternatives.iter().filter(|alternative| alternative.minor == place);
                factors.extend(own.flat_map(|alternative| texts(part, &alternative.factors)));
            }
            RegionMinor { rows: minor.rows.clone(), factors }
        };
        self.problem.minors.iter().enumerate().map(of).collect()
    }

    /// How the boxes stand in which a state may lie; the worst of them if there are several. `at` encloses the state's
    /// coordinates. `None` where one of them is not given, or lies outside of the box.
    pub fn standing(&self, at: impl Fn(Symbol) -> Option<Interval>) -> Option<BoxStanding> {
        let mut worst =
            if self.problem.parts.is_empty() { BoxStanding::Undecided } else { BoxStanding::Proved };
        for range in &self.problem.ranges {
            let whole = Interval::from_rational(&range.low).hull(Interval::from_rational(&range.high));
            at(range.symbol).filter(|value| whole.encloses(*value))?;
        }
        for (part, search) in self.problem.parts.iter().zip(&self.searches.searches) {
            let values: Option<Vec<Interval>> =
                part.chart.coordinates().iter().map(|c| at(c.symbol)).collect();
            let values = values?;
            let mut workspace = Default::default();
            for cell in search.unproved() {
                let sides = cell.sides.iter().enumerate();
                let meets = |(place, side): (usize, &Side)| {
                    values[place].intersection(part.chart.side(place, *side)).is_some()
                };
                if sides.into_iter().all(meets) {
                    worst = worst.max(standing(explain(part, cell, &mut workspace).0));
                }
            }
        }
        Some(worst)
    }

    /// The map: what the boxes of the parts cut out of it.
    fn map(&self, volumes: &[PartVolumes]) -> Option<RegionMap> {
        let (x, y) = self.map?;
        let ranges = &self.problem.ranges;
        let mut patches = vec![([Side::WHOLE; 2], BoxStanding::Proved)];
        let mut at = Vec::new();
        for ((part, part_volumes), search) in
            self.problem.parts.iter().zip(volumes).zip(&self.searches.searches)
        {
            let plane = search.plane;
            if plane.x.is_none() && plane.y.is_none() {
                // the same all over the map: what the part is a third of its ranges from the low ends
                let open = part_volumes.sections.iter().map(|(_, standing)| *standing).max();
                let open = open.unwrap_or(BoxStanding::Proved);
                patches.iter_mut().for_each(|(_, how)| *how = (*how).max(open));
                let rest = |c: &FreeCoordinate| (c.name.clone(), c.middle_of(super::search::Plane::REST));
                at.extend(part.chart.coordinates().iter().map(rest));
                continue;
            }
            let proved = search.sections.iter().map(|section| (*section, BoxStanding::Proved));
            let all: Vec<([Side; 2], BoxStanding)> =
                proved.chain(part_volumes.sections.iter().copied()).collect();
            if patches.len() * all.len() > MOST_PATCHES {
                return None;
            }
            let joined = |a: &[Side; 2], b: &[Side; 2]| {
                [if plane.x.is_some() { b[0] } else { a[0] }, if plane.y.is_some() { b[1] } else { a[1] }]
            };
            patches = patches
                .iter()
                .flat_map(|(a, how)| all.iter().map(move |(b, other)| (joined(a, b), (*how).max(*other))))
                .collect();
            for (place, coordinate) in part.chart.coordinates().iter().enumerate() {
                if Some(place) != plane.x && Some(place) != plane.y {
                    at.push((coordinate.name.clone(), coordinate.middle_of(super::search::Plane::REST)));
                }
            }
        }
        let range = |place: usize| {
            let (low, high) = ranges[place].ends(Side::WHOLE);
            CoordinateRange { name: ranges[place].name.clone(), low, high }
        };
        let patch = |([a, b], standing): ([Side; 2], BoxStanding)| Patch {
            x: ranges[x].ends(a),
            y: ranges[y].ends(b),
            standing,
        };
        Some(RegionMap { x: range(x), y: range(y), patches: patches.into_iter().map(patch).collect(), at })
    }
}
