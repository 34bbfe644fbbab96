//! What "how well observable" means, in every table and every picture: the standard deviation of each state, normalised by its
//! prior standard deviation. Never the singular values of an equilibrated matrix, which say how hard a rank is to decide: of a
//! matrix of one row and one column they are one, however small its entry.
//!
//! Noise is measured against what the file says of the system's range. Let `s_i` be the prior standard deviation of state `i`
//! (that of a uniform distribution over its range, the width by the square root of 12), `u_j` the standard deviation of the value
//! of Lie derivative `j` (an output is one of order zero) over states drawn from the sample box, and `J` the differentials of the
//! Lie derivatives that are taken. If each is known up to an error of standard deviation `u_j`, independently, then the states
//! are known by least squares up to errors of covariance `(J^T U^-2 J)^-1`, `U` the diagonal of the `u_j` (the Gauss-Markov
//! theorem). What is reported of state `i` is the root of entry `(i, i)` in units of `s_i`. One means: known as well as the
//! measurements are, each measured by its own range. A million means: to know this state to a hundredth of its range, outputs
//! and derivatives have to be known to a hundred-millionth of theirs. Infinite means: not observable from these rows to first order.
//! The number does not depend on units, and noise of another size multiplies it by that size.
//!
//! All of it is computed in doubles, along lines into singular sets also from enclosures, and proves nothing.

use crate::observability::{Defined, Locus, LocusError, State};
use dashu::rational::RBig;
use nalgebra::DMatrix;
use palmistry_lang::System;
use palmistry_math::expression::{NodeId, Program, Symbol, expand_angles};
use palmistry_math::number::{
    Arithmetic, Enclosure, Enclosures, Floats, MOST_ITERATIONS, Refusal, rational_from_f64, rational_to_f64,
};
use std::collections::BTreeSet;

/// So many states are looked at.
const STATES: u64 = 200;
/// Singular values below this part of the largest one, of columns of length one, cannot be distinguished from zero in doubles.
const NOISE: f64 = 1e-12;

/// An enclosure is worth a double that is so many of its half widths away from zero.
const FIXED: f64 = 1e12;

/// What is measured.
pub struct MeasuredRows {
    /// Their differentials, by rows of an entry a state.
    pub entries: Vec<NodeId>,
    /// Their values; nothing where they are not known, as of a matrix that a paper writes down.
    pub values: Option<Vec<NodeId>>,
}

/// States of the sample box, with what is measured there.
pub struct DrawnStates {
    /// Those at which everything exists.
    pub states: Vec<State>,
    /// The differentials at each.
    pub matrices: Vec<DMatrix<f64>>,
    values: Vec<Option<Vec<f64>>>,
}

impl DrawnStates {
    /// Up to two hundred states of a locus; those at which something does not exist are left out.
    ///
    /// # Errors
    /// Where states cannot be drawn.
    pub fn new(
        system: &mut System,
        locus: &Locus,
        rows: &MeasuredRows,
        seed: u64,
        samples: u64,
    ) -> Result<DrawnStates, LocusError> {
        let guards = system.smooth_guards(&system.moving_fields());
        let defined = Defined::new(system, &guards);
        let is_angle = &system.angle_test();
        let values = rows.values.as_ref().map(|values| {
            let values = expand_angles(&mut system.graph, values, is_angle);
            Program::new(&system.graph, &values, is_angle)
        });
        let entries = expand_angles(&mut system.graph, &rows.entries, is_angle);
        let entries = Program::new(&system.graph, &entries, is_angle);
        let columns = system.unknown_count();
        let mut drawn = DrawnStates { states: Vec::new(), matrices: Vec::new(), values: Vec::new() };
        for index in 0..STATES.min(samples) {
            let state = locus.draw(seed, index)?;
            let Some(entries) = values_at(&entries, &state).filter(|_| defined.holds(&state)) else {
                continue;
            };
            drawn.matrices.push(DMatrix::from_row_slice(entries.len() / columns.max(1), columns, &entries));
            drawn.values.push(values.as_ref().and_then(|values| values_at(values, &state)));
            drawn.states.push(state);
        }
        Ok(drawn)
    }
}

/// The scales by which it is said how well a state is observable.
#[derive(Clone, Debug)]
pub struct Scales {
    /// The prior standard deviation of each state, in its own unit; one where it has none.
    pub priors: Vec<f64>,
    /// The standard deviation of the noise of each row, in its own unit.
    pub noise: Vec<f64>,
    /// The largest rank that doubles find at the states that were drawn.
    rank: usize,
}

impl Scales {
    /// Those of a system's sample box.
    pub fn new(system: &System, drawn: &DrawnStates) -> Scales {
        let priors: Vec<f64> =
            system.unknowns().iter().map(|symbol| spread_of_state(system, *symbol, &drawn.states)).collect();
        let rows = drawn.matrices.first().map_or(0, DMatrix::nrows);
        let noise = (0..rows).map(|row| unit(row, &drawn.values, &drawn.matrices, &priors)).collect();
        let mut scales = Scales { priors, noise, rank: 0 };
        scales.rank = drawn.matrices.iter().map(|matrix| scales.rank_of(matrix)).max().unwrap_or(0);
        scales
    }

    fn rank_of(&self, matrix: &DMatrix<f64>) -> usize {
        let found = Decomposition::new(self.scaled(matrix), None);
        found.map_or(0, |found| found.values.iter().filter(|value| found.is_told(**value)).count())
    }

    /// The standard deviation of each state over its prior one, where the differentials have these values, known up to `errors`:
    /// infinite where a direction takes part in it that is unobservable, or cannot be distinguished from such.
    pub fn deviations(&self, matrix: &DMatrix<f64>, errors: Option<&DMatrix<f64>>) -> Vec<f64> {
        let found = Decomposition::new(self.scaled(matrix), errors.map(|errors| self.scaled(errors)));
        let Some(found) = found else { return vec![f64::INFINITY; self.priors.len()] };
        let told = found.values.iter().filter(|value| found.is_told(**value)).count();
        // as many directions as anywhere: the others are unobservable everywhere, and what takes no part in them is determined. Where there are
        // fewer, a small value may be hidden, by which any small part of what is connected is divided
        let hides = errors.is_some() && told < self.rank;
        found.deviations(hides)
    }

    /// The same from enclosures of the differentials, which have the digits that doubles lack next to a singular set: of each state whose part of the matrix has full rank for
    /// certain. Nothing of the others: they may be not observable.
    ///
    /// # Errors
    /// Where a number has no image in the enclosures.
    pub fn enclosed_deviations(
        &self,
        on: &Enclosures,
        matrix: &[Vec<Enclosure>],
    ) -> Result<Vec<Option<f64>>, Refusal> {
        let columns = self.priors.len();
        let number = |value: f64| on.rational(&rational_from_f64(value).ok_or(Refusal::NotFinite)?);
        let mut rows = Vec::new();
        for (entries, unit) in matrix.iter().zip(&self.noise) {
            let unit = number(*unit)?;
            let scaled = entries
                .iter()
                .zip(&self.priors)
                .map(|(entry, prior)| on.div(&on.mul(entry, &number(*prior)?)?, &unit));
            rows.push(scaled.collect::<Result<Vec<Enclosure>, Refusal>>()?);
        }
        let pattern = DMatrix::from_fn(rows.len(), columns, |row, column| {
            let entry = &rows[row][column];
            f64::from(u8::from(!(entry.is_exact() && entry.contains_zero())))
        });
        let parts = connected(&pattern);
        let mut found = vec![None; columns];
        for part in parts.iter().copied().collect::<BTreeSet<usize>>() {
            let own: Vec<usize> = (0..columns).filter(|column| parts[*column] == part).collect();
            let of: Vec<Vec<&Enclosure>> =
                rows.iter().map(|row| own.iter().map(|column| &row[*column]).collect()).collect();
            if let Some(variances) = variances(on, &of)? {
                own.iter()
                    .zip(variances)
                    .for_each(|(column, variance)| found[*column] = Some(variance.sqrt()));
            }
        }
        Ok(found)
    }

    /// A matrix in units of the noise and of the priors, with rows of zeros for what is missing, so that all directions come out.
    fn scaled(&self, entries: &DMatrix<f64>) -> DMatrix<f64> {
        let columns = self.priors.len();
        let mut scaled = DMatrix::zeros(entries.nrows().max(columns), columns);
        for (row, unit) in self.noise.iter().enumerate() {
            for (column, prior) in self.priors.iter().enumerate() {
                scaled[(row, column)] = entries[(row, column)] * prior / unit;
            }
        }
        scaled
    }
}

/// The diagonal of `(S^T S)^-1`, where the matrix `S` has full rank for certain and the enclosures fix a double.
fn variances(on: &Enclosures, rows: &[Vec<&Enclosure>]) -> Result<Option<Vec<f64>>, Refusal> {
    let size = rows.first().map_or(0, Vec::len);
    let nothing = on.rational(&RBig::ZERO)?;
    // beside the matrix stands the identity, which becomes the inverse
    let mut work = vec![vec![nothing.clone(); 2 * size]; size];
    for i in 0..size {
        for j in 0..size {
            for row in rows {
                work[i][j] = on.add(&work[i][j], &on.mul(row[i], row[j])?)?;
            }
        }
        work[i][size + i] = on.rational(&RBig::ONE)?;
    }
    // of a positive matrix any diagonal entry is a pivot, and the largest loses the fewest digits
    let mut left: Vec<usize> = (0..size).collect();
    while !left.is_empty() {
        let largest = |a: &usize, b: &usize| work[*a][*a].midpoint().total_cmp(&work[*b][*b].midpoint());
        let Some(pivot) = left.iter().copied().max_by(largest) else { break };
        left.retain(|other| *other != pivot);
        let divisor = work[pivot][pivot].clone();
        if divisor.contains_zero() {
            return Ok(None);
        }
        for entry in &mut work[pivot] {
            *entry = on.div(entry, &divisor)?;
        }
        let own = work[pivot].clone();
        for row in work.iter_mut().enumerate().filter(|(i, _)| *i != pivot).map(|(_, row)| row) {
            let factor = row[pivot].clone();
            for (entry, own) in row.iter_mut().zip(&own) {
                *entry = on.sub(entry, &on.mul(&factor, own)?)?;
            }
        }
    }
    let diagonal: Vec<&Enclosure> = (0..size).map(|i| &work[i][size + i]).collect();
    // a variance beyond the range of doubles is not an infinite one
    let is_fixed = diagonal.iter().all(|own| own.significance() > FIXED && own.midpoint().is_normal());
    Ok(is_fixed.then(|| diagonal.iter().map(|own| own.midpoint()).collect()))
}

/// Singular values and directions of a matrix in units of the noise and of the priors, its columns of length one: a state that hardly shows
/// spoils none of the others' digits, and none of its own.
struct Decomposition {
    lengths: Vec<f64>,
    values: Vec<f64>,
    directions: DMatrix<f64>,
    /// How far a singular value may be off.
    doubt: f64,
    /// How far the matrix may be off.
    turning: f64,
    /// The columns that share rows have one number.
    parts: Vec<usize>,
}

impl Decomposition {
    /// Nothing where it leaves the range of doubles, where nothing can be decided and a decomposition would panic.
    fn new(mut scaled: DMatrix<f64>, errors: Option<DMatrix<f64>>) -> Option<Decomposition> {
        if !scaled.iter().all(|value| value.is_finite()) {
            return None;
        }
        let columns = scaled.ncols();
        let lengths_of = |matrix: &DMatrix<f64>| -> Vec<f64> {
            matrix.column_iter().map(|column| length(column.iter().copied())).collect()
        };
        let mut lengths = lengths_of(&scaled);
        let doubts = errors.as_ref().map_or(vec![0.0; columns], lengths_of);
        let mut doubt = 0.0f64;
        for ((mut column, size), error) in scaled.column_iter_mut().zip(&mut lengths).zip(doubts) {
            // what may be zero is not observable for all that is known
            if *size <= error {
                *size = 0.0;
                column.fill(0.0);
            }
            if *size > 0.0 {
                column /= *size;
                doubt = doubt.hypot(error / *size);
            }
        }
        if !lengths.iter().chain([&doubt]).all(|value| value.is_finite()) {
            return None;
        }
        let parts = connected(&scaled);
        let found = scaled.try_svd(false, true, f64::EPSILON, MOST_ITERATIONS)?;
        let values: Vec<f64> = found.singular_values.iter().copied().collect();
        let turning = doubt.max(1e-14);
        let doubt = doubt.max(NOISE * values.iter().copied().fold(0.0, f64::max));
        Some(Decomposition { lengths, values, directions: found.v_t?, doubt, turning, parts })
    }

    /// Whether a singular value can be distinguished from zero.
    fn is_told(&self, value: f64) -> bool {
        value > self.doubt
    }

    fn deviations(&self, hides: bool) -> Vec<f64> {
        let least =
            self.values.iter().copied().filter(|value| self.is_told(*value)).fold(f64::INFINITY, f64::min);
        // how far errors turn a direction that is not observable towards those that are
        let turned = (self.turning / least).max(1e-10);
        let columns = self.lengths.len();
        let takes_part = |column: usize| {
            let mut parts =
                self.values.iter().enumerate().map(|(k, value)| (*value, self.directions[(k, column)]));
            self.lengths[column] > 0.0
                && parts.any(|(value, part)| !self.is_told(value) && part.abs() > turned)
        };
        let hidden: Vec<usize> =
            (0..columns).filter(|column| takes_part(*column)).map(|k| self.parts[k]).collect();
        let of = |column: usize| {
            let is_hidden = takes_part(column) || hides && hidden.contains(&self.parts[column]);
            if self.lengths[column] == 0.0 || is_hidden {
                return f64::INFINITY;
            }
            let parts = self.values.iter().enumerate().filter(|(_, value)| self.is_told(**value));
            let squares = parts.map(|(k, value)| (self.directions[(k, column)] / value).powi(2));
            squares.sum::<f64>().sqrt() / self.lengths[column]
        };
        (0..columns).map(of).collect()
    }
}

/// A number for each column, one for those that share rows, if by way of others.
fn connected(matrix: &DMatrix<f64>) -> Vec<usize> {
    let mut parts: Vec<usize> = (0..matrix.ncols()).collect();
    for row in matrix.row_iter() {
        let in_it: Vec<usize> =
            (0..parts.len()).filter(|column| row[*column] != 0.0).map(|k| parts[k]).collect();
        if let Some(first) = in_it.first() {
            parts.iter_mut().filter(|part| in_it.contains(part)).for_each(|part| *part = *first);
        }
    }
    parts
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

/// The spread of a Lie derivative over the states; to first order where its value is the same at all of them, or not known.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// As they are at rows with noise of these units, of states with these priors.
    fn deviations_of(matrix: &DMatrix<f64>, units: &[f64], spreads: &[f64]) -> Vec<f64> {
        Scales { priors: spreads.to_vec(), noise: units.to_vec(), rank: spreads.len() }
            .deviations(matrix, None)
    }

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

    /// `a = x + y` determines neither, `b = z` determines z.
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
        // rows in other units of the Lie derivatives, columns in other units of the states
        let (words, states) = ([1e6, 1e-9, 3.0], [1e3, 1e-5]);
        let other = DMatrix::from_fn(3, 2, |row, column| matrix[(row, column)] * words[row] / states[column]);
        let units: Vec<f64> = units.iter().zip(words).map(|(unit, scale)| unit * scale).collect();
        let spreads: Vec<f64> = spreads.iter().zip(states).map(|(spread, scale)| spread * scale).collect();
        for (found, expected) in deviations_of(&other, &units, &spreads).into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
    }

    /// Entries that are known up to an error say nothing of what the error may have made.
    #[test]
    fn what_errors_may_have_made_is_infinite() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0 + 1e-6]);
        let errors = |size: f64| DMatrix::from_element(2, 2, size);
        let scales = Scales { priors: vec![1.0; 2], noise: vec![1.0; 2], rank: 2 };
        assert!(scales.deviations(&matrix, Some(&errors(1e-9))).iter().all(|found| found.is_finite()));
        assert!(scales.deviations(&matrix, Some(&errors(1e-5))).iter().all(|found| found.is_infinite()));
        let small = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 1e-9]);
        let found = scales.deviations(&small, Some(&errors(1e-8)));
        assert!((found[0] - 1.0).abs() < 1e-12 && found[1].is_infinite(), "{found:?}");
    }

    /// By hand: rows `x + e y`, `e^2 y`, `x`, and a `z` of its own. Of `y` a value is hidden that any part of `x` is divided by; `z` is determined.
    #[test]
    fn next_to_a_singular_set_only_what_is_not_connected_is_told() {
        let scales = Scales { priors: vec![1.0; 3], noise: vec![1.0; 3], rank: 3 };
        let of = |e: f64| {
            let matrix =
                DMatrix::from_row_slice(3, 3, &[1.0, e, 0.0, 1.0, e + e * e * e, 0.0, 0.0, 0.0, 2.0]);
            scales.deviations(&matrix, Some(&DMatrix::zeros(3, 3)))
        };
        // y = (b - a)/e^3, x = a - e y
        let told = of(1e-3);
        assert!(
            (told[1] / (2.0f64.sqrt() * 1e9) - 1.0).abs() < 1e-3
                && (told[0] / (2.0f64.sqrt() * 1e6) - 1.0).abs() < 1e-3
        );
        let hidden = of(1e-7);
        assert!(hidden[0].is_infinite() && hidden[1].is_infinite(), "{hidden:?}");
        assert!((hidden[2] - 0.5).abs() < 1e-12, "{hidden:?}");
    }

    /// The same rows in enclosures, where they have their digits, and with an unobservable `w`.
    #[test]
    fn enclosures_tell_next_to_a_singular_set() {
        let scales = Scales { priors: vec![1.0; 4], noise: vec![1.0; 3], rank: 3 };
        let on = Enclosures::new(512);
        for e in [1e-3f64, 1e-7, 1e-20] {
            let own = rational_from_f64(e).unwrap();
            let cube = &own + &own * &own * &own;
            let (nought, one) = (RBig::ZERO, RBig::ONE);
            let matrix = [[&one, &own, &nought], [&one, &cube, &nought], [&nought, &nought, &RBig::from(2)]];
            let enclosed: Vec<Vec<Enclosure>> = matrix
                .iter()
                .map(|row| row.iter().copied().chain([&nought]).map(|v| on.rational(v).unwrap()).collect())
                .collect();
            let found = scales.enclosed_deviations(&on, &enclosed).unwrap();
            let near = |value: Option<f64>, expected: f64| {
                (value.unwrap() / expected - 1.0).abs() < 2.0 * e * e + 1e-14
            };
            assert!(near(found[1], 2.0f64.sqrt() / e.powi(3)) && near(found[0], 2.0f64.sqrt() / e.powi(2)));
            assert!(near(found[2], 0.5) && found[3].is_none(), "{found:?}");
        }
    }
}
