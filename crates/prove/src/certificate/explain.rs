//! Why a box is open, and which part of the volume is sampled at all.

use super::boxes::{DEEPEST, Place, Volume};
use super::part::Part;
use super::search::Cell;
use super::tape::Tape;
use super::workspace::{BoxAtWork, Workspace};
use palmistry_rank::observability::AVOIDED;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};

/// Why nothing is proved on a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Why {
    /// The system is defined on all of it, and this minor is zero somewhere in it, with this factor.
    Vanishes {
        minor: usize,
        factor: usize,
    },
    /// What the system divides by is zero somewhere in it, or takes the root or the logarithm of what has none.
    Pole {
        factor: usize,
    },
    Undecided,
}

/// Why nothing is proved on a box, and whether no sampled state lies in it.
pub(super) fn explain(part: &Part, cell: &Cell, workspace: &mut Workspace) -> (Why, bool) {
    let mut at = workspace.begin(&part.chart, &cell.sides);
    let mut room = Default::default();
    let mut is_avoided = |tape: &Tape| tape.value(at.at(Place::All), &mut room).magnitude() < JUST_AVOIDED;
    let avoided = part.avoid.iter().any(&mut is_avoided);
    let excludes = |at: &mut BoxAtWork<'_>, factor: usize| {
        let expression = &part.factors[factor];
        cell.knows(factor) || {
            let guess = expression.guess(at);
            expression.holds_everywhere(at, guess.value < 0.0)
        }
    };
    for guard in &part.guards {
        if !excludes(&mut at, *guard) {
            let guard_factor = &part.factors[*guard];
            let pole = guard_factor.vanishes(&mut at) || guard_factor.fails_everywhere(&mut at);
            return (if pole { Why::Pole { factor: *guard } } else { Why::Undecided }, avoided);
        }
    }
    let vanishing = |at: &mut BoxAtWork<'_>, list: &[usize]| {
        let vanishes = |f: &&usize| !cell.knows(**f) && part.factors[**f].vanishes(at);
        list.iter().find(vanishes).copied()
    };
    if let Some(factor) = vanishing(&mut at, &part.common) {
        let place = part.common.iter().position(|common| *common == factor).unwrap_or(0);
        return (Why::Vanishes { minor: part.common_of[place], factor }, avoided);
    }
    for alternative in &part.alternatives {
        if alternative.below.iter().all(|factor| excludes(&mut at, *factor))
            && let Some(factor) = vanishing(&mut at, &alternative.factors)
        {
            return (Why::Vanishes { minor: alternative.minor, factor }, avoided);
        }
    }
    (Why::Undecided, avoided)
}

/// Sampled states have a magnitude of at least [`AVOIDED`] in floating point: a little less is surely avoided.
const JUST_AVOIDED: f64 = AVOIDED * (1.0 - 1e-9);
/// And a little more is surely not.
const NOT_AVOIDED: f64 = AVOIDED * (1.0 + 1e-9);

/// A lower bound of the volume in which states are sampled; an interrupt makes it a coarser one.
pub(super) fn sampled_volume(part: &Part, interrupt: &AtomicBool) -> Volume {
    let mut sampled = Volume::default();
    let mut queue = VecDeque::from([Cell::whole(part)]);
    let mut workspace = Workspace::default();
    let mut room = Default::default();
    for paved in 0..MOST_PAVED {
        if paved >= PAVED_AT_LEAST && interrupt.load(Ordering::Relaxed) {
            break;
        }
        let Some(cell) = queue.pop_front() else { break };
        let at = workspace.begin(&part.chart, &cell.sides);
        let all = at.at(Place::All);
        let (mut halved, mut avoided) = (None, false);
        for tape in &part.avoid {
            let value = tape.value(all, &mut room);
            avoided |= value.magnitude() < JUST_AVOIDED;
            if value.mignitude() < NOT_AVOIDED && halved.is_none() {
                let can = tape.coordinates.iter().filter(|place| cell.sides[**place].depth < DEEPEST);
                halved = can.min_by_key(|place| cell.sides[**place].depth).copied();
                avoided |= halved.is_none();
            }
        }
        match halved {
            _ if avoided => {}
            Some(coordinate) => queue.extend(cell.halves(coordinate)),
            None => sampled.add(cell.depth()),
        }
    }
    sampled
}

/// So many boxes are looked at to find out which part of the volume is avoided.
const MOST_PAVED: usize = 20_000;
/// And so many after an interrupt too.
const PAVED_AT_LEAST: usize = 2000;
