//! Where multiple shooting begins, and the bounds of its search: from the sample box in the file, and the measurements.

use super::nodes::{Bounds, Nodes, Segments};
use super::task::Task;
use nalgebra::DVector;
use palmistry_math::number::rational_to_f64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// The range from which a state is drawn, and whether the file says it; none where there is no such state.
pub(super) fn range(task: &Task<'_>, place: usize) -> Option<([f64; 2], bool)> {
    let system = &task.source.0;
    let symbol = system.find_symbol(task.full.states.get(place)?)?;
    let own = system.symbol_info(symbol)?.range.clone();
    let is_own = own.is_some();
    let range = own.or_else(|| system.default_range(symbol))?;
    Some(([&range.low, &range.high].map(rational_to_f64), is_own))
}

/// Whether a state is an angle.
pub(super) fn is_angle(task: &Task<'_>, place: usize) -> bool {
    let system = &task.source.0;
    let symbol = task.full.states.get(place).and_then(|name| system.find_symbol(name));
    symbol.is_some_and(|symbol| system.is_angle(symbol))
}

/// The bounds of the states in a search: at first the ranges of the file, wider by their own width to both sides, later none; where signs are
/// kept, on the same side of zero all the time. Ranges hold for initial states, and a motion may leave them and change sign: one half of the
/// starts keeps signs, the other does not. Whole turns are no bound.
pub(super) fn bounds(task: &Task<'_>, are_signs_kept: bool) -> Bounds {
    let one = |place: usize| {
        let anywhere = [f64::NEG_INFINITY, f64::INFINITY];
        let Some(([low, high], true)) = range(task, place).filter(|_| !is_angle(task, place)) else {
            return (anywhere, anywhere);
        };
        let width = high - low;
        let (mut first, mut later) = ([low - width, high + width], anywhere);
        if are_signs_kept && low >= 0.0 {
            (first[0], later[0]) = (low / 100.0, low.min(width) / 100.0);
        }
        if are_signs_kept && high <= 0.0 {
            (first[1], later[1]) = (high / 100.0, high.max(-width) / 100.0);
        }
        (first, later)
    };
    let (first, later) = (0..task.full.states.len()).map(one).unzip();
    Bounds { first, later }
}

/// Where a start begins: from the guess, or from a state of the sample box. A state that is measured begins at each node as it is measured there. Any other
/// begins with one value at all nodes or, in every other pair of starts, where the model takes it from node to node: an angle that turns on is soon far from
/// where it began, and a search that begins far from a motion ends at a false minimum.
pub(super) fn first_nodes(
    task: &Task<'_>,
    segments: &Segments<'_>,
    bounds: &Bounds,
    (belief, rows, clamped): (&[f64], &Range<usize>, &[usize]),
    start: usize,
) -> Nodes {
    let is_followed = start / 2 % 2 == 1;
    let mut random = ChaCha8Rng::seed_from_u64(start as u64);
    let mut state = task.full_state(belief, rows.start);
    for (place, value) in state.iter_mut().enumerate() {
        let part = random.random::<f64>();
        if start > 0
            && place < task.estimated()
            && !clamped.contains(&place)
            && let Some(([low, high], _)) = range(task, place)
        {
            *value = low + part * (high - low);
        }
    }
    let constants = segments.constant.iter().map(|place| bounds.within(0, *place, state[*place]));
    let constant = DVector::from_iterator(segments.constant.len(), constants);
    for (place, value) in segments.constant.iter().zip(constant.iter()) {
        state[*place] = *value;
    }
    let mut moving = Vec::with_capacity(segments.rows.len());
    for (node, segment) in segments.rows.iter().enumerate() {
        let row = rows.start + segment.start;
        let mut here = state.clone();
        for place in &segments.moving {
            let read = task.full.column_of(*place).map(|column| task.signals.column(column)[row]);
            let value = read.filter(|read| !read.is_nan()).unwrap_or(state[*place]);
            here[*place] = bounds.within(node, *place, value);
        }
        moving.push(DVector::from_iterator(segments.moving.len(), segments.moving.iter().map(|i| here[*i])));
        if is_followed && let Some(end) = segments.end_of(node, &here) {
            state = end;
        }
    }
    Nodes { moving, constant }
}
