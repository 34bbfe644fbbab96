//! How well each state is seen: its standard deviation where what is measured has noise.
//!
//! A condition number says nothing of one state, and after scaling nothing of one that hardly shows in the outputs: a matrix
//! of one row and one column has condition one, however small its entry. So noise is measured against what the file says of
//! the system's range. Let `s_i` be the spread of state `i` over the sample box (the standard deviation of a uniform
//! distribution, the width of its range by the square root of 12), `u_j` the standard deviation of the value of word `j`, an
//! output or one of its Lie derivatives, over drawn states, and `J` the differentials of the words that were needed. If each
//! word is known up to an error of standard deviation `u_j`, independently, then the states are known by least squares up to
//! errors of covariance `(J^T U^-2 J)^-1`, `U` the diagonal of the `u_j` (the Gauss-Markov theorem). What is reported of state
//! `i` is the root of entry `(i, i)` in units of `s_i`. One means: known as well as the words are, each measured by its own
//! range. A million means: to know this state to a hundredth of its range, outputs and derivatives have to be known to a
//! hundred-millionth of theirs. The number does not depend on units, and noise of another size multiplies it by that size.
//!
//! All of it is computed in doubles, and proves nothing.

use super::states::SweepReport;
use crate::expression::{NodeId, Program, Symbol, expand_angles};
use crate::number::{Floats, rational_to_f64};
use crate::observability::{Codistribution, Defined, Locus, LocusError, State};
use crate::system::System;
use nalgebra::DMatrix;

/// So many states are looked at.
const STATES: u64 = 200;
/// From this on a state is called nearly invisible: no instrument has six digits in its derivatives.
pub const NEARLY_INVISIBLE: f64 = 1e6;
/// A decomposition that has not come to its end by then has none.
const MOST_ITERATIONS: usize = 10_000;
/// Singular values below this part of the largest one, of columns of length one, cannot be told from zero in doubles.
const NOISE: f64 = 1e-12;

/// How well one state is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardDeviation {
    /// The state's name.
    pub state: String,
    /// Its own spread over the sample box, in its own unit; one where it has none.
    pub spread: f64,
    /// The middle one of its standard deviations at the states that were looked at, in parts of its spread. Infinite where it
    /// is not seen, or where doubles cannot tell.
    pub median: f64,
    /// The greatest of them.
    pub worst: f64,
    /// At how many states it is infinite.
    pub infinite: usize,
    /// Whether the ranks of the sweep say that it is seen at every state: where it is infinite all the same, doubles cannot
    /// tell how well.
    pub is_seen: bool,
}

/// How well each state is seen, at some states of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardDeviations {
    /// At how many states.
    pub states: usize,
    /// The words that are measured, and the spread of each, which is the unit of its noise.
    pub words: Vec<(String, f64)>,
    /// A row for each state of the system, in the order of the file.
    pub list: Vec<StandardDeviation>,
}

/// The values of some expressions at a state, or nothing where one is infinite or not defined.
fn values_at(program: &Program, state: &State) -> Option<Vec<f64>> {
    let inputs = state.inputs(program, &Floats).ok()?;
    let values = program.load(Floats).ok()?.run(&inputs, &mut Vec::new()).ok()?;
    values.iter().all(|value| value.is_finite()).then_some(values)
}

/// The standard deviation of some numbers, if they differ.
fn spread(values: &[f64]) -> Option<f64> {
    let scale = values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let mean = values.iter().map(|value| value / scale).sum::<f64>() / values.len() as f64;
    let square = values.iter().map(|value| (value / scale - mean).powi(2)).sum::<f64>() / values.len() as f64;
    // what is nothing but rounding is no spread
    let spread = square.sqrt();
    (spread > 1e-14).then_some(spread * scale)
}

/// Whether a sweep says of a state of the system that it is seen at every state that was drawn.
fn is_seen(system: &System, state: Symbol, swept: &SweepReport) -> bool {
    let name = system.symbol_name(state);
    let is_full = swept.rank_histogram.keys().all(|rank| *rank == system.unknown_count());
    let is_told = swept.certified == swept.samples;
    is_full
        || is_told && !swept.unseen.iter().any(|direction| direction.states.iter().any(|part| part == name))
}

/// How well each state is seen by the words that were needed, at up to two hundred states drawn from a locus; those that the
/// sweep left out, since something does not exist there, are left out here too.
///
/// # Errors
/// Where states cannot be drawn.
pub(crate) fn standard_deviations(
    system: &mut System,
    locus: &Locus,
    codistribution: &Codistribution,
    swept: &SweepReport,
    seed: u64,
    samples: u64,
) -> Result<Option<StandardDeviations>, LocusError> {
    let guards = system.smooth_guards(&system.moving_fields());
    let defined = Defined::new(system, &guards);
    let is_angle = &system.angle_test();
    let values: Vec<NodeId> = codistribution.needed.iter().map(|word| codistribution.values[*word]).collect();
    let values = expand_angles(&mut system.graph, &values, is_angle);
    let rows = expand_angles(&mut system.graph, &codistribution.needed_entries(), is_angle);
    let values = Program::new(&system.graph, &values, is_angle);
    let rows = Program::new(&system.graph, &rows, is_angle);
    let columns = system.unknown_count();
    let (mut states, mut found, mut measured) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..STATES.min(samples) {
        let state = locus.draw(seed, index)?;
        let Some(entries) = values_at(&rows, &state).filter(|_| defined.holds(&state)) else { continue };
        found.push(DMatrix::from_row_slice(entries.len() / columns.max(1), columns, &entries));
        measured.push(values_at(&values, &state));
        states.push(state);
    }
    if found.is_empty() {
        return Ok(None);
    }
    let spreads: Vec<f64> =
        system.unknowns().iter().map(|symbol| spread_of_state(system, *symbol, &states)).collect();
    let units: Vec<f64> =
        (0..codistribution.needed.len()).map(|word| unit(word, &measured, &found, &spreads)).collect();
    let all: Vec<Vec<f64>> = found.iter().map(|matrix| deviations_of(matrix, &units, &spreads)).collect();
    let unknowns = system.unknowns();
    let list = (0..columns).map(|column| {
        let mut each: Vec<f64> = all.iter().map(|deviations| deviations[column]).collect();
        each.sort_by(f64::total_cmp);
        StandardDeviation {
            state: system.symbol_name(unknowns[column]).to_owned(),
            spread: spreads[column],
            median: each[each.len() / 2],
            worst: each[each.len() - 1],
            infinite: each.iter().filter(|deviation| deviation.is_infinite()).count(),
            is_seen: is_seen(system, unknowns[column], swept),
        }
    });
    let list = list.collect();
    let words = codistribution.needed.iter().map(|word| codistribution.words[*word].text(system)).zip(units);
    Ok(Some(StandardDeviations { states: found.len(), words: words.collect(), list }))
}

/// The spread of a state over the box: by its range, else by the states that were drawn, else one.
fn spread_of_state(system: &System, symbol: Symbol, states: &[State]) -> f64 {
    let range = system.symbol_info(symbol).and_then(|info| info.range.as_ref());
    let width = range.map_or(0.0, |range| rational_to_f64(&(&range.high - &range.low)));
    if width > 0.0 {
        return width / 12.0f64.sqrt();
    }
    let drawn: Vec<f64> =
        states.iter().filter_map(|state| Some(state.values.get(&symbol)?.to_f64())).collect();
    spread(&drawn).unwrap_or(1.0)
}

/// The spread of a word over the states; to first order where its value is the same at all of them, or not known.
fn unit(word: usize, measured: &[Option<Vec<f64>>], found: &[DMatrix<f64>], spreads: &[f64]) -> f64 {
    let values: Option<Vec<f64>> =
        measured.iter().map(|values| values.as_ref().map(|values| values[word])).collect();
    if let Some(spread) = values.filter(|values| values.len() > 1).and_then(|values| spread(&values)) {
        return spread;
    }
    let square = |matrix: &DMatrix<f64>| -> f64 {
        matrix.row(word).iter().zip(spreads).map(|(entry, spread)| (entry * spread).powi(2)).sum()
    };
    let mean = found.iter().map(square).sum::<f64>() / found.len() as f64;
    if mean > 0.0 { mean.sqrt() } else { 1.0 }
}

/// The length of a vector whose squares may be too small to be held.
fn length(parts: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = parts.clone().fold(0.0f64, |most, part| most.max(part.abs()));
    if largest == 0.0 {
        0.0
    } else {
        largest * parts.map(|part| (part / largest).powi(2)).sum::<f64>().sqrt()
    }
}

/// The standard deviations of the states in parts of their spreads, at one state: infinite where a direction that is not
/// seen takes part in it.
fn deviations_of(matrix: &DMatrix<f64>, units: &[f64], spreads: &[f64]) -> Vec<f64> {
    let columns = spreads.len();
    // with rows of zeros for what is missing, so that all directions come out
    let mut scaled = DMatrix::zeros(matrix.nrows().max(columns), columns);
    for (row, unit) in units.iter().enumerate() {
        for (column, spread) in spreads.iter().enumerate() {
            scaled[(row, column)] = matrix[(row, column)] * spread / unit;
        }
    }
    // columns of length one: a state that hardly shows spoils none of the others' digits, and none of its own
    let lengths: Vec<f64> = scaled.column_iter().map(|column| length(column.iter().copied())).collect();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths).filter(|(_, length)| **length > 0.0) {
        column /= *length;
    }
    let nowhere = vec![f64::INFINITY; columns];
    // beyond the range of doubles nothing can be told, and a decomposition would panic
    if !scaled.iter().chain(&lengths).all(|value| value.is_finite()) {
        return nowhere;
    }
    let Some(found) = scaled.try_svd(false, true, f64::EPSILON, MOST_ITERATIONS) else { return nowhere };
    let Some(directions) = found.v_t else { return nowhere };
    let values = &found.singular_values;
    let is_seen = |value: f64| value > NOISE * values.max();
    let least = values.iter().copied().filter(|value| is_seen(*value)).fold(f64::INFINITY, f64::min);
    // how far rounding turns a direction that is not seen towards those that are
    let turned = (1e-14 / least).max(1e-10);
    let of = |column: usize| {
        let parts = || values.iter().enumerate().map(|(k, value)| (*value, directions[(k, column)]));
        let unseen = parts().any(|(value, part)| !is_seen(value) && part.abs() > turned);
        if lengths[column] == 0.0 || unseen {
            return f64::INFINITY;
        }
        let seen = parts().filter(|(value, _)| is_seen(*value));
        seen.map(|(value, part)| (part / value).powi(2)).sum::<f64>().sqrt() / lengths[column]
    };
    (0..columns).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: of `a = x`, `b = -x + t k` with units 1 and 1, `k = (a + b)/t` has the variance `2/t^2`, `x` that of `a`.
    #[test]
    fn a_state_that_hardly_shows_has_the_deviation_that_one_computes_by_hand() {
        for small in [1e-3, 1e-9, 1e-30, 1e-200] {
            let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, -1.0, small]);
            let found = deviations_of(&matrix, &[1.0, 1.0], &[1.0, 1.0]);
            assert!((found[0] - 1.0).abs() < 1e-12, "{found:?}");
            assert!((found[1] * small / 2.0f64.sqrt() - 1.0).abs() < 1e-12, "{found:?}");
        }
    }

    /// `a = x + y` sees neither, `b = z` sees z.
    #[test]
    fn what_takes_part_in_an_unseen_direction_is_infinite_and_nothing_else() {
        let matrix = DMatrix::from_row_slice(2, 3, &[1.0, 1.0, 0.0, 0.0, 0.0, 4.0]);
        let found = deviations_of(&matrix, &[1.0, 2.0], &[1.0, 1.0, 1.0]);
        assert!(found[0].is_infinite() && found[1].is_infinite(), "{found:?}");
        assert!((found[2] - 0.5).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn what_leaves_the_doubles_is_told_of_no_state() {
        for entry in [1e300, f64::INFINITY, f64::NAN] {
            let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, entry]);
            assert_eq!(deviations_of(&matrix, &[1.0, 1.0], &[1e10, 1e10]), [f64::INFINITY; 2], "{entry}");
        }
    }

    #[test]
    fn other_units_change_nothing() {
        let matrix = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 3.0, -1.0, 0.5, 4.0]);
        let (units, spreads) = ([0.1, 0.2, 0.3], [2.0, 5.0]);
        let expected = deviations_of(&matrix, &units, &spreads);
        // rows in other units of the words, columns in other units of the states
        let (words, states) = ([1e6, 1e-9, 3.0], [1e3, 1e-5]);
        let other = DMatrix::from_fn(3, 2, |row, column| matrix[(row, column)] * words[row] / states[column]);
        let units: Vec<f64> = units.iter().zip(words).map(|(unit, scale)| unit * scale).collect();
        let spreads: Vec<f64> = spreads.iter().zip(states).map(|(spread, scale)| spread * scale).collect();
        for (found, expected) in deviations_of(&other, &units, &spreads).into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
    }
}
