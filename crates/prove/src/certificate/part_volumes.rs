//! What is known of a part: volumes of boxes, added exactly, by why nothing is proved on them.

use super::answer::{BoxStanding, OpenBox, PartAnswer, Vanishing};
use super::boxes::{FreeCoordinate, Side, Volume};
use super::explain::{Why, explain, sampled_volume};
use super::part::Part;
use super::search::Search;
use dashu::rational::RBig;
use palmistry_budget::Share;
use palmistry_lang::CoordinateRange;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// Open boxes that are listed.
const LISTED: usize = 5;
/// So many open boxes are explained after an interrupt too, the largest: some ten milliseconds.
const EXPLAINED_AT_LEAST: usize = 2000;
/// What is known of a part.
pub(super) struct PartVolumes {
    /// By why a box is open, and whether it is avoided.
    open: BTreeMap<(Why, bool), Volume>,
    pub sampled: RBig,
    pub largest: Vec<(OpenBox, usize)>,
    /// What open boxes cut out of the map.
    pub sections: Vec<([Side; 2], BoxStanding)>,
}

impl PartVolumes {
    /// What is known, after an interrupt of the largest boxes alone: of the others it is that nothing is proved on them.
    pub fn new(part: &Part, search: &Search, interrupt: &AtomicBool) -> PartVolumes {
        let cells = search.unproved();
        let share = Share::here();
        let whys: Vec<(Why, bool)> = cells
            .par_iter()
            .enumerate()
            .map_init(Default::default, |workspace, (place, cell)| {
                if place >= EXPLAINED_AT_LEAST && interrupt.load(Ordering::Relaxed) {
                    return (Why::Undecided, false);
                }
                share.carry(|| explain(part, cell, workspace))
            })
            .collect();
        let mut open: BTreeMap<(Why, bool), Volume> = BTreeMap::new();
        let mut sections = Vec::new();
        for (cell, why) in cells.iter().zip(&whys) {
            open.entry(*why).or_default().add(cell.depth());
            sections.extend(search.plane.section(&cell.sides).map(|section| (section, standing(why.0))));
        }
        let describe = |(cell, (why, avoided)): (&&super::search::Cell, &(Why, bool))| {
            let mut volume = Volume::default();
            volume.add(cell.depth());
            let halved = |(_, side): &(&FreeCoordinate, &Side)| side.depth > 0;
            let sides = part.chart.coordinates().iter().zip(cell.sides.iter()).filter(halved);
            let open = OpenBox {
                ranges: sides
                    .map(|(c, side)| {
                        let (low, high) = c.ends(*side);
                        CoordinateRange { name: c.name.clone(), low, high }
                    })
                    .collect(),
                standing: standing(*why),
                factor: factor_of(part, *why),
                avoided: *avoided,
                fraction: volume.at_least(),
            };
            (open, cell.depth())
        };
        // what is avoided comes last: nobody samples there
        let mut order: Vec<usize> = (0..cells.len()).collect();
        order.sort_by_key(|place| (whys[*place].1, cells[*place].depth()));
        let largest = order.into_iter().take(LISTED).map(|place| describe((&cells[place], &whys[place])));
        PartVolumes {
            largest: largest.collect(),
            open,
            sampled: sampled_volume(part, interrupt).exact(),
            sections,
        }
    }

    pub fn sum(&self, of: impl Fn(Why, bool) -> bool) -> RBig {
        let chosen = self.open.iter().filter(|((why, avoided), _)| of(*why, *avoided));
        chosen.fold(RBig::ZERO, |sum, (_, volume)| sum + volume.exact())
    }
}

pub(super) fn standing(why: Why) -> BoxStanding {
    match why {
        Why::Vanishes { .. } => BoxStanding::MinorVanishes,
        Why::Pole { .. } => BoxStanding::Pole,
        Why::Undecided => BoxStanding::Undecided,
    }
}

fn factor_of(part: &Part, why: Why) -> Option<String> {
    match why {
        Why::Vanishes { factor, .. } | Why::Pole { factor } => Some(part.factors[factor].text.clone()),
        Why::Undecided => None,
    }
}

/// What is reported of a part.
pub(super) fn part_answer(part: &Part, volumes: &PartVolumes, search: &Search) -> PartAnswer {
    let texts = |list: &[usize]| list.iter().map(|factor| part.factors[*factor].text.clone()).collect();
    let mut vanishing: BTreeMap<(Option<usize>, String), Volume> = BTreeMap::new();
    for ((why, _), volume) in &volumes.open {
        let key = match *why {
            Why::Vanishes { minor, factor } => (Some(minor), part.factors[factor].text.clone()),
            Why::Pole { factor } => (None, part.factors[factor].text.clone()),
            Why::Undecided => continue,
        };
        vanishing.entry(key).or_default().merge(volume);
    }
    let vanishing = vanishing.into_iter().map(|((minor, factor), volume)| Vanishing {
        factor,
        minor,
        boxes: volume.boxes(),
        fraction: volume.at_least(),
    });
    PartAnswer {
        coordinates: part.chart.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect(),
        guards: part.guards.iter().map(|guard| part.factors[*guard].needed_text()).collect(),
        common: texts(&part.common),
        alternatives: part.alternatives.len(),
        proved: search.proved.at_least(),
        boxes: search.boxes,
        open_boxes: search.unproved_boxes() as u64,
        vanishing: vanishing.collect(),
    }
}
