//! Branch and bound on one part: boxes on which everything is proved are done with, the others are halved, the largest
//! first.

use super::boxes::{DEEPEST, Side, Volume};
use super::factor::{Guess, HOPE};
use super::part::{Alternative, Part};
use super::workspace::{BoxAtWork, Workspace};
use palmistry_budget::Share;
use rayon::prelude::*;
use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};

/// A box, and the factors that are known to be zero nowhere in it (the first 128 of them).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    pub sides: Box<[Side]>,
    pub known: u128,
}

impl Cell {
    /// The whole box.
    pub fn whole(part: &Part) -> Self {
        Cell { sides: vec![Side::WHOLE; part.chart.coordinates().len()].into_boxed_slice(), known: 0 }
    }

    /// The number of halvings that led to it: its volume is that power of one half.
    pub fn depth(&self) -> usize {
        self.sides.iter().map(|side| usize::from(side.depth)).sum()
    }

    pub fn knows(&self, factor: usize) -> bool {
        factor < 128 && self.known >> factor & 1 == 1
    }

    fn learn(&mut self, factor: usize) {
        if factor < 128 {
            self.known |= 1 << factor;
        }
    }

    pub fn halves(&self, coordinate: usize) -> [Cell; 2] {
        self.sides[coordinate].halves().map(|side| {
            let mut half = self.clone();
            half.sides[coordinate] = side;
            half
        })
    }
}

/// What has come of a box.
enum BoxJudgement {
    /// Everything is, by this minor where there are several to choose from.
    Proved(Option<usize>),
    Halved([Cell; 2]),
    /// It cannot be halved any more, or the system is not defined on it.
    Left,
}

/// A plane through a box, or what of it lies in one part: two coordinates, the others a third of their ranges from the low
/// end, where no box ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Plane {
    pub x: Option<usize>,
    pub y: Option<usize>,
}

impl Plane {
    /// What the other coordinates are, as a part of their ranges.
    pub const REST: f64 = 1.0 / 3.0;

    /// What a box cuts out of the plane.
    pub fn section(&self, sides: &[Side]) -> Option<[Side; 2]> {
        let meets = |(place, side): (usize, &Side)| {
            Some(place) == self.x || Some(place) == self.y || side.meets(Self::REST)
        };
        let side = |place: Option<usize>| place.map_or(Side::WHOLE, |place| sides[place]);
        sides.iter().enumerate().all(meets).then(|| [side(self.x), side(self.y)])
    }

    fn is_empty(&self) -> bool {
        self.x.is_none() && self.y.is_none()
    }
}

/// Boxes of one depth that are to be looked at next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    pub depth: usize,
    /// How many of them.
    pub boxes: usize,
}

/// The boxes of a turn were not all looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Interrupted;

/// A proved box, and the minor by which it was, where there are several to choose from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ProvedCell {
    pub sides: Box<[Side]>,
    pub minor: Option<usize>,
}

/// The boxes of a part.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Search {
    /// Open boxes by depth, each depth in the order of its making.
    pub open: BTreeMap<usize, VecDeque<Cell>>,
    /// Boxes that cannot be halved any more.
    pub left: Vec<Cell>,
    /// Boxes on which everything is proved.
    pub proved: Volume,
    /// The first of them, which are the largest, and no more than so many.
    pub kept: Vec<ProvedCell>,
    pub most_kept: usize,
    /// The number of boxes that were looked at.
    pub boxes: u64,
    /// What the proved boxes cut out of a plane.
    pub plane: Plane,
    pub sections: Vec<[Side; 2]>,
}

/// The boxes of a turn are judged by all threads.
const LONGEST_TURN: usize = 2048;
/// So many minors are tried on a box.
const TRIES: usize = 3;
/// With this many open boxes a search ends: more would fill the memory (some 150 bytes each).
const MOST_OPEN: usize = 6_000_000;

impl Search {
    /// The whole box, open.
    pub fn new(part: &Part, plane: Plane) -> Self {
        Search {
            open: BTreeMap::from([(0, VecDeque::from([Cell::whole(part)]))]),
            left: Vec::new(),
            proved: Volume::default(),
            kept: Vec::new(),
            most_kept: 0,
            boxes: 0,
            plane,
            sections: Vec::new(),
        }
    }

    pub fn unproved_boxes(&self) -> usize {
        self.open.values().map(VecDeque::len).sum::<usize>() + self.left.len()
    }

    /// Whether there are as many open boxes as are kept.
    pub fn is_full(&self) -> bool {
        self.unproved_boxes() >= MOST_OPEN
    }

    /// The boxes to look at next: the largest. None where no box is open, or too many are.
    pub fn turn(&self) -> Option<Turn> {
        let (depth, queue) = self.open.first_key_value().filter(|_| !self.is_full())?;
        Some(Turn { depth: *depth, boxes: queue.len().min(LONGEST_TURN) })
    }

    /// The order of boxes that depends on nothing but what they are: the largest first.
    pub fn sort(&mut self) {
        for boxes in self.open.values_mut() {
            boxes.make_contiguous().sort_by(|a, b| a.sides.cmp(&b.sides));
        }
        self.left.sort_by(|a, b| (a.depth(), &a.sides).cmp(&(b.depth(), &b.sides)));
        self.sections.sort();
        self.keep_largest();
    }

    /// Forgets proved boxes beyond those that are kept, the smallest first.
    pub fn keep_largest(&mut self) {
        let depth = |sides: &[Side]| sides.iter().map(|side| usize::from(side.depth)).sum::<usize>();
        self.kept.sort_by(|a, b| (depth(&a.sides), &a.sides).cmp(&(depth(&b.sides), &b.sides)));
        self.kept.truncate(self.most_kept);
    }

    /// Examines at most so many boxes of a turn, the oldest first. Returns the rest of the turn. With `keep_all`, the caller
    /// sorts and forgets proved boxes beyond those that are kept.
    ///
    /// # Errors
    /// An interrupt came before the last of these boxes was begun: all of them are open as they were, and nothing is counted.
    pub fn step(
        &mut self,
        part: &Part,
        turn: Turn,
        most: u64,
        keep_all: bool,
        interrupt: &AtomicBool,
    ) -> Result<Option<Turn>, Interrupted> {
        let Some(queue) = self.open.get_mut(&turn.depth) else { return Ok(None) };
        let count = turn.boxes.min(queue.len()).min(usize::try_from(most).unwrap_or(usize::MAX));
        let block: Vec<Cell> = queue.drain(..count).collect();
        let share = Share::here();
        let judged: Vec<(Cell, u128, Option<BoxJudgement>)> = block
            .into_par_iter()
            .map_init(Workspace::default, |workspace, mut cell| {
                let known = cell.known;
                let is_cut = interrupt.load(Ordering::Relaxed);
                let judged = (!is_cut).then(|| share.carry(|| judge(part, &mut cell, workspace)));
                (cell, known, judged)
            })
            .collect();
        if judged.iter().any(|(_, _, judged)| judged.is_none()) {
            // which boxes were looked at depends on threads and on time, so that none of it counts
            let before = judged.into_iter().rev().map(|(cell, known, _)| Cell { known, ..cell });
            before.for_each(|cell| queue.push_front(cell));
            return Err(Interrupted);
        }
        if queue.is_empty() {
            self.open.remove(&turn.depth);
        }
        let found = judged.into_iter().filter_map(|(cell, _, judged)| Some((cell, judged?)));
        for (cell, judged) in found {
            match judged {
                BoxJudgement::Proved(minor) => {
                    self.proved.add(cell.depth());
                    if keep_all || self.kept.len() < self.most_kept {
                        self.kept.push(ProvedCell { sides: cell.sides.clone(), minor });
                    }
                    if !self.plane.is_empty() {
                        self.sections.extend(self.plane.section(&cell.sides));
                    }
                }
                BoxJudgement::Halved(halves) => self.open.entry(cell.depth() + 1).or_default().extend(halves),
                BoxJudgement::Left => self.left.push(cell),
            }
        }
        self.boxes += count as u64;
        let rest = Turn { boxes: turn.boxes - count, ..turn };
        Ok((rest.boxes > 0 && count > 0).then_some(rest))
    }

    /// All boxes on which nothing is proved, the largest first.
    pub fn unproved(&self) -> Vec<&Cell> {
        let mut all: Vec<&Cell> = self.open.values().flatten().chain(&self.left).collect();
        all.sort_by_key(|cell| cell.depth()); // stable
        all
    }
}

/// Looks at a box.
fn judge(part: &Part, cell: &mut Cell, workspace: &mut Workspace) -> BoxJudgement {
    let at = &mut workspace.begin(&part.chart, &cell.sides);
    let mut guesses: Vec<Option<Guess>> = vec![None; part.factors.len()];
    let mut least = |cell: &Cell, at: &mut BoxAtWork<'_>, list: &mut dyn Iterator<Item = &usize>| -> f64 {
        let mut least = f64::INFINITY;
        for factor in list.copied().filter(|factor| !cell.knows(*factor)) {
            let guess = guesses[factor].get_or_insert_with(|| part.factors[factor].guess(at));
            least = least.min(guess.ratio);
        }
        least
    };
    let required = least(cell, at, &mut part.guards.iter().chain(&part.common));
    let mut order: Vec<(f64, Option<&Alternative>)> = Vec::with_capacity(part.alternatives.len().max(1));
    for alternative in &part.alternatives {
        order.push((least(cell, at, &mut alternative.all()).min(required), Some(alternative)));
    }
    if order.is_empty() {
        order.push((required, None));
    }
    order.sort_by(|a, b| b.0.total_cmp(&a.0)); // stable
    let mut worst: Option<(f64, usize)> = None;
    for (rank, (ratio, own)) in order.into_iter().take(TRIES).enumerate() {
        if rank > 0 && ratio < HOPE {
            break;
        }
        let mut proved = true;
        let minor = own.map(|alternative| alternative.minor);
        let own = own.into_iter().flat_map(Alternative::all);
        for factor in part.guards.iter().chain(&part.common).chain(own).copied() {
            if cell.knows(factor) {
                continue;
            }
            let Some(guess) = guesses[factor] else { continue };
            let expression = &part.factors[factor];
            if expression.is_worth_trying(guess) && expression.holds_everywhere(at, guess.value < 0.0) {
                cell.learn(factor);
                continue;
            }
            proved = false;
            if expression.fails_everywhere(at) {
                return BoxJudgement::Left;
            }
            if rank == 0 && worst.is_none_or(|(ratio, _)| guess.ratio < ratio) {
                worst = Some((guess.ratio, factor));
            }
        }
        if proved {
            return BoxJudgement::Proved(minor);
        }
    }
    let Some((_, factor)) = worst else { return BoxJudgement::Left };
    let can = |coordinate: &usize| cell.sides[*coordinate].depth < DEEPEST;
    let steepest = guesses[factor].and_then(|guess| guess.steepest).filter(can);
    let coordinate = steepest.or_else(|| {
        let coordinates = part.factors[factor].tape.coordinates.iter().copied().filter(can);
        coordinates.min_by_key(|coordinate| cell.sides[*coordinate].depth)
    });
    coordinate.map_or(BoxJudgement::Left, |coordinate| BoxJudgement::Halved(cell.halves(coordinate)))
}

#[cfg(test)]
mod tests {
    use super::super::region::Region;
    use super::super::rows::RegionRows;
    use super::Interrupted;
    use palmistry_lang::System;
    use std::path::Path;

    /// Boxes at which an interrupt comes are open as they were, and what comes of them later is the same. Oracle: a search without one.
    #[test]
    fn boxes_that_are_cut_short_are_open_again() {
        let text = "system \"A saddle\"\nstate x, y\ndrift f\n  x' = 0\n  y' = 0\noutput x^3/3 - x/8 + x*y, y\n\
                    sample\n  x in [-1, 1]\n  y in [-1, 1]\nclaim 1: x = x\n";
        let mut system = System::parse("saddle.proof", text, Path::new(".")).unwrap();
        let mut region = Region::new(&mut system, RegionRows::default(), &Default::default(), None).unwrap();
        let part = &region.problem.parts[0];
        let mut turns = 0;
        while let (Some(turn), true) = (region.searches.searches[0].turn(), turns < 12) {
            let search = &mut region.searches.searches[0];
            let mut other = search.clone();
            assert_eq!(search.step(part, turn, u64::MAX, false, &true.into()), Err(Interrupted));
            assert_eq!(*search, other);
            let whole = other.step(part, turn, u64::MAX, false, &false.into());
            assert_eq!(search.step(part, turn, u64::MAX, false, &false.into()), whole);
            assert_eq!(*search, other);
            turns += 1;
        }
        assert!(turns > 5 && region.boxes() > 20, "{turns} turns, {} boxes", region.boxes());
    }
}
