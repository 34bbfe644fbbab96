//! The high-gain observer of Gauthier, Hammouri and Othman, which section 6.2 of the thesis names.

use super::filtered::{Filtered, Innovation, of_variances};
use super::flow::advance;
use super::model::{Formulas, InputSource};
use super::spread::Spread;
use super::task::{Observer, Task};
use super::track::Track;
use super::{Learned, Lost, Model};
use nalgebra::{Cholesky, DMatrix, DVector, RowDVector};
use palmistry_math::expression::{NodeId, Symbol, gradient};
use palmistry_math::number::{Duals, Refusal};
use serde::Deserialize;
use std::cell::Cell;
use std::collections::HashMap;

/// The high-gain observer.
///
/// In the coordinates `z = Phi(x)`, the outputs and their derivatives along the motion, the system has the canonical form
/// 6.1, 6.2: each derivative is the next coordinate. There a copy of the system is corrected by
/// `-K e`, `e` being the error of an output and `K` the coefficients of `(1 + 1/gain)^l` (the solution of the paper's matrix
/// equation); in the coordinates of the model the correction is `-(dPhi/dx)^-1 K e`. The form exists where `dPhi/dx` is regular.
/// How many derivatives each output contributes is chosen at the first guess, as the choice that is conditioned best (the observability
/// indices, where there are thousands of choices).
///
/// Reference: J. P. Gauthier, H. Hammouri, S. Othman, A simple observer for nonlinear systems, IEEE TAC 37(6), 1992; for
/// several outputs G. Bornard and H. Hammouri, CDC 1991.
///
/// The method has no covariance of its own. That of its error is carried beside it: with `F = df/dx - (dPhi/dx)^-1 K H` the error moves as `e' = F e +
/// (dPhi/dx)^-1 K v` under the error `v` of the curve through the measurements, from one sample to the next with `F` as it is at the first. The curve depends
/// on eight measurements at a time, so that the errors of neighbouring steps are not independent: how far each of these eight has moved the state is carried
/// too. The covariance begins with a half of each size, as that of the Kalman filter does.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HighGain {
    /// In 1/s: errors die out as `exp(-gain t)`, and noise is amplified by powers of it.
    pub gain: f64,
}

impl Default for HighGain {
    fn default() -> Self {
        HighGain { gain: 20.0 }
    }
}

/// The standard deviation of the first guess, relative to the sizes of the estimated states.
const PRIOR: f64 = 0.5;

/// The least standard deviation that a measurement is believed to have, in its unit.
const LEAST: f64 = 1e-6;

/// A matrix whose scaled condition is worse than this is taken to be singular.
const SINGULAR: f64 = 1e9;

/// So many derivatives of an output are coordinates at most, itself included: a third derivative would need the second derivatives of the signals.
const LONGEST: usize = 3;

/// So many choices of derivatives are looked at; where there are more, that of the observability indices alone.
const MOST_CHOICES: usize = 2000;

/// The derivatives of the canonical coordinates by the states: one row a coordinate, output by output.
struct Canonical {
    /// For each output how many of its derivatives are coordinates, itself included.
    lengths: Vec<usize>,
    /// The rows, and where their inputs come from.
    rows: Formulas,
    /// The derivatives of the rates by the states, a row a state.
    jacobian: Formulas,
    model: Model,
}

/// Places on [-1, 1] and weights of Gauss and Legendre's rule, exact to degree nine: a curve through eight samples has degree seven.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

impl Observer for HighGain {
    fn observe(&self, task: &Task<'_>) -> Track {
        let times = task.signals.times();
        let learned = Learned::before(task);
        let mut state = task.full_state(&learned.belief, 0);
        let mut so_far = Filtered::begin(task, LEAST);
        let deviations = DVector::from_vec(task.prior_deviations(PRIOR, task.sigma.max(LEAST)));
        let mut covariance = DMatrix::from_diagonal(&deviations.map(|deviation| deviation * deviation));
        if let Some((known, spread)) = &learned.filter {
            (state, covariance) = (known.as_slice().to_vec(), spread.clone());
        }
        let noise = so_far.measurement_variances();
        let mut error = Spread::of_a_guess(covariance, noise, task.signals.carriers());
        let canonical = match Canonical::new(task, &state) {
            Ok(canonical) => canonical,
            Err(why) => {
                return Track { remarks: vec![format!("no canonical form: {why}")], ..Track::default() };
            }
        };
        // at how many samples measurements were compared with nothing
        let untested = Cell::new(0_usize);
        let record = |so_far: &mut Filtered<'_, '_>, state: &[f64], error: &Spread, row: usize| {
            // the outputs of the canonical form are states: they are measured directly
            let read = task.measurements(row);
            let seen = task.full.outputs.iter().map(|name| task.full.find(name).map(|place| state[place]));
            let residual: Vec<f64> = seen.zip(&read).filter_map(|(seen, read)| Some(seen? - read)).collect();
            if row > 0 {
                let covariance = error.of_residual(&canonical.places(), task.signals.sample(row));
                let measured = (0..residual.len()).collect();
                let residual = DVector::from_column_slice(&residual);
                // after the state was lost there is no covariance, and nothing to compare
                let is_known = covariance.iter().all(|value| value.is_finite());
                match Cholesky::new(covariance).filter(|_| is_known) {
                    Some(root) => {
                        so_far.compare(&Innovation { residual, root: root.unpack(), measured });
                    }
                    None => untested.set(untested.get() + 1),
                }
            }
            so_far.believe(times[row], state, &of_variances(&error.covariance().diagonal()), residual);
        };
        record(&mut so_far, &state, &error, 0);
        for row in 1..times.len() {
            if task.interrupted() {
                break;
            }
            let carried = canonical.carry(task, self.gain, &state, &times[row - 1..=row], &mut error);
            match self.step(task, &canonical, &state, times[row - 1], times[row]) {
                Ok((there, seen)) => {
                    let mut held = DVector::from_vec(there);
                    if carried.is_none() {
                        error.forget();
                    }
                    so_far.hold(times[row], &mut held, &error.covariance());
                    state = held.as_slice().to_vec();
                    so_far.track.unobserved += usize::from(!seen);
                }
                Err(lost) => {
                    // what has run away does not come back
                    so_far.track.remarks.push(format!("held from there on: {lost}"));
                    so_far.track.unobserved += times.len() - row;
                    let unknown = DVector::from_element(state.len(), f64::INFINITY);
                    for time in &times[row..] {
                        so_far.believe(*time, &state, &unknown, Vec::new());
                    }
                    break;
                }
            }
            record(&mut so_far, &state, &error, row);
        }
        let covariance = error.covariance();
        let mut track = so_far.end();
        let lengths: Vec<String> = canonical.lengths.iter().map(ToString::to_string).collect();
        if untested.get() > 0 {
            track.remarks.push(format!(
                "at {} of {} samples the innovation has no positive definite covariance and is not in the test",
                untested.get(),
                times.len()
            ));
        }
        track.remarks.push(format!(
            "canonical form: the outputs and their derivatives, {} coordinates",
            lengths.join(" and ")
        ));
        let state = DVector::from_vec(state);
        track.hand_on(Learned::of_filter(task, &state, &covariance, &of_variances(&covariance.diagonal())));
        track
    }
}

impl HighGain {
    /// From one sample to the next; whether the canonical form existed on all of the way.
    fn step(
        &self,
        task: &Task<'_>,
        canonical: &Canonical,
        state: &[f64],
        from: f64,
        to: f64,
    ) -> Result<(Vec<f64>, bool), Lost> {
        let model = &canonical.model;
        let refuse =
            |refusal: Refusal| Lost { time: from, why: format!("the model has no value: {refusal}") };
        let rates = model.rates.program.load(Duals::<f64>::default()).map_err(refuse)?;
        let failure: Cell<Option<Refusal>> = Cell::new(None);
        let seen = Cell::new(true);
        let right_hand_side = |time: f64, x: &[f64], dx: &mut [f64]| {
            match rates.run(&inputs_at(task, model, &model.rates, time, x), &mut Vec::new()) {
                Ok(values) => dx.copy_from_slice(&values),
                Err(error) => {
                    failure.set(Some(error.refusal));
                    return dx.fill(f64::NAN);
                }
            }
            match canonical.correction(task, time, x, self.gain) {
                Some(correction) => dx.iter_mut().zip(correction.iter()).for_each(|(dx, c)| *dx -= c),
                None => seen.set(false),
            }
        };
        let end = advance(&right_hand_side, from, to, state, 1e-10);
        let end = end.map_err(|lost| failure.get().map_or(lost, refuse))?;
        Ok((end, seen.get()))
    }
}

/// The inputs of some formulas at a time and a state.
fn inputs_at(task: &Task<'_>, model: &Model, formulas: &Formulas, time: f64, x: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; model.columns.len()];
    let mut slopes = vec![0.0; model.columns.len()];
    task.signals.at(&model.columns, time, &mut values);
    if formulas.sources.iter().any(|source| matches!(source, InputSource::Rate(_))) {
        task.signals.rates_at(&model.columns, time, &mut slopes);
    }
    let source = |source: &InputSource| match *source {
        InputSource::State(place) => x[place],
        InputSource::Column(place) => values[place],
        InputSource::Rate(place) => slopes[place],
    };
    formulas.sources.iter().map(source).collect()
}

impl Canonical {
    /// The canonical form of a task's model, where it has one at the first guess.
    fn new(task: &Task<'_>, state: &[f64]) -> Result<Canonical, String> {
        if let Some(why) = task.refuses_implicit().or_else(|| task.refuses_sparse()) {
            return Err(why);
        }
        let mut model = Model::clone(&task.full);
        if model.delays.iter().any(Option::is_some) {
            return Err("it takes outputs for states as they are read, and knows no delay".to_owned());
        }
        if model.outputs.iter().any(|output| model.find(output).is_none()) {
            return Err("an output is not one of the states that are followed".to_owned());
        }
        let (n, m) = (model.states.len(), model.outputs.len());
        let (rates, states) = (model.rate_nodes.clone(), model.symbols.clone());
        let slopes: Vec<NodeId> =
            rates.into_iter().flat_map(|rate| gradient(&mut model.system.graph, rate, &states)).collect();
        let jacobian = model.formulas(&slopes, &HashMap::new(), task.signals);
        let jacobian = jacobian.map_err(|error| error.to_string())?;
        // a choice of derivatives is a choice among the rows of this one
        let mut canonical = Canonical { lengths: Vec::new(), rows: jacobian.clone(), jacobian, model };
        let mut why = format!("there is no choice of {n} derivatives of the {m} outputs");
        for longest in (1..=LONGEST.min((n + 1).saturating_sub(m))).rev() {
            match canonical.choose(vec![longest; m], task) {
                Ok(()) => {}
                Err(refused) => {
                    why = refused;
                    continue;
                }
            }
            let Some(all) = canonical.matrix(task, task.signals.times()[0], state) else {
                why = "the derivatives of the outputs have no value at the first guess".to_owned();
                continue;
            };
            let choices = compositions(n, m, longest);
            let looked_at = if choices.is_some() { "choice" } else { "choice that was looked at" };
            let choices = choices.unwrap_or_else(|| vec![observability_indices(&all, longest)]);
            if let Some(lengths) = best_lengths(choices, &all, longest, |matrix| condition(matrix, task)) {
                canonical.choose(lengths, task)?;
                return Ok(canonical);
            }
            return Err(format!(
                "no {looked_at} of {n} derivatives of the {m} outputs, at most second ones, is regular at the first guess"
            ));
        }
        Err(why)
    }

    /// Takes so many derivatives of each output for coordinates.
    fn choose(&mut self, lengths: Vec<usize>, task: &Task<'_>) -> Result<(), String> {
        let (rows, rates) = coordinate_rows(&mut self.model, &lengths);
        self.rows = self.model.formulas(&rows, &rates, task.signals).map_err(|error| error.to_string())?;
        self.lengths = lengths;
        Ok(())
    }

    /// `dPhi/dx`.
    fn matrix(&self, task: &Task<'_>, time: f64, x: &[f64]) -> Option<DMatrix<f64>> {
        let program = self.rows.program.load(Duals::<f64>::default()).ok()?;
        let inputs = inputs_at(task, &self.model, &self.rows, time, x);
        let values = program.run(&inputs, &mut Vec::new()).ok()?;
        let n = self.model.states.len();
        values
            .iter()
            .all(|value| value.is_finite())
            .then(|| DMatrix::from_row_slice(values.len() / n, n, &values))
    }

    /// The places of the outputs among the states.
    fn places(&self) -> Vec<usize> {
        self.model.outputs.iter().filter_map(|name| self.model.find(name)).collect()
    }

    /// Carries the error over a step; nothing where it has no value.
    fn carry(&self, task: &Task<'_>, gain: f64, x: &[f64], times: &[f64], error: &mut Spread) -> Option<()> {
        let n = x.len();
        let program = self.jacobian.program.load(Duals::<f64>::default()).ok()?;
        let inputs = inputs_at(task, &self.model, &self.jacobian, times[0], x);
        let mut own = DMatrix::from_row_slice(n, n, &program.run(&inputs, &mut Vec::new()).ok()?);
        // where the form is singular nothing is corrected
        let pull = self.pull(task, times[0], x, gain);
        let pull = pull.unwrap_or_else(|| DMatrix::zeros(n, self.model.outputs.len()));
        for (output, place) in self.places().into_iter().enumerate() {
            let mut column = own.column_mut(place);
            column -= pull.column(output);
        }
        let step = times[1] - times[0];
        let first = task.signals.first_carrier(times[0]);
        let mut moved = vec![DMatrix::zeros(n, pull.ncols()); task.signals.carriers()];
        for (place, weight) in GAUSS {
            let time = times[0] + step * (1.0 + place) / 2.0;
            let on = (&own * (times[1] - time)).exp() * &pull * (weight * step / 2.0);
            for (moved, carries) in moved.iter_mut().zip(task.signals.weights_from(first, time)) {
                *moved += &on * carries;
            }
        }
        let by_state = (own * step).exp();
        let is_finite = |matrix: &DMatrix<f64>| matrix.iter().all(|value| value.is_finite());
        (is_finite(&by_state) && moved.iter().all(is_finite)).then(|| error.step(&by_state, first, moved))
    }

    /// `(dPhi/dx)^-1 K`, a column an output; none where the form is singular.
    fn pull(&self, task: &Task<'_>, time: f64, x: &[f64], gain: f64) -> Option<DMatrix<f64>> {
        let matrix = self.matrix(task, time, x)?;
        if condition(&matrix, task) > SINGULAR {
            return None;
        }
        let mut right = DMatrix::zeros(x.len(), self.lengths.len());
        let mut row = 0;
        for (output, length) in self.lengths.iter().enumerate() {
            for k in 1..=*length {
                right[(row, output)] = binomial(*length, k) * gain.powi(k as i32);
                row += 1;
            }
        }
        matrix.lu().solve(&right)
    }

    /// `(dPhi/dx)^-1 K e`.
    fn correction(&self, task: &Task<'_>, time: f64, x: &[f64], gain: f64) -> Option<DVector<f64>> {
        let matrix = self.matrix(task, time, x)?;
        if condition(&matrix, task) > SINGULAR {
            return None;
        }
        let mut read = vec![0.0; self.model.measured.len()];
        let measured: Vec<usize> = self.model.measured.iter().flatten().copied().collect();
        task.signals.at(&measured, time, &mut read);
        let mut right = Vec::with_capacity(x.len());
        for ((length, output), read) in self.lengths.iter().zip(&self.model.outputs).zip(&read) {
            let error = x[self.model.find(output)?] - read;
            right.extend((1..=*length).map(|k| binomial(*length, k) * gain.powi(k as i32) * error));
        }
        matrix.lu().solve(&DVector::from_vec(right))
    }
}

/// The condition of a matrix whose columns are scaled by the sizes of the states and whose rows to length one.
fn condition(matrix: &DMatrix<f64>, task: &Task<'_>) -> f64 {
    let mut scaled = matrix.clone();
    for (j, mut column) in scaled.column_iter_mut().enumerate() {
        column *= task.sizes.get(j).copied().unwrap_or(1.0);
    }
    for mut row in scaled.row_iter_mut() {
        let length = row.norm();
        if length > 0.0 {
            row /= length;
        }
    }
    let Some(svd) = scaled.try_svd(false, false, f64::EPSILON, 10_000) else { return f64::INFINITY };
    svd.singular_values.max() / svd.singular_values.min()
}

/// The differentials of the outputs and their derivatives along the motion, and the symbols that stand for the rates of
/// signals in them.
fn coordinate_rows(model: &mut Model, lengths: &[usize]) -> (Vec<NodeId>, HashMap<Symbol, Symbol>) {
    let states = model.symbols.clone();
    let mut rates = HashMap::new();
    let mut rows = Vec::new();
    for (output, length) in model.output_nodes.clone().into_iter().zip(lengths) {
        let mut coordinate = output;
        for k in 0..*length {
            if k > 0 {
                coordinate = along(model, coordinate, &states, &mut rates);
            }
            rows.extend(gradient(&mut model.system.graph, coordinate, &states));
        }
    }
    (rows, rates)
}

/// The derivative of an expression along the motion: by the states, and by the signals that it depends on.
fn along(
    model: &mut Model,
    expression: NodeId,
    states: &[Symbol],
    rates: &mut HashMap<Symbol, Symbol>,
) -> NodeId {
    let graph = &mut model.system.graph;
    let symbols: Vec<Symbol> = graph.symbols_of([expression]);
    let signals: Vec<Symbol> = symbols.into_iter().filter(|symbol| !states.contains(symbol)).collect();
    let by_states = gradient(graph, expression, states);
    let by_signals = gradient(graph, expression, &signals);
    let mut terms = Vec::new();
    for (slope, rate) in by_states.into_iter().zip(&model.rate_nodes) {
        terms.push(graph.mul(slope, *rate));
    }
    for (slope, signal) in by_signals.into_iter().zip(signals) {
        let name = format!("{}'", graph.symbol_name(signal));
        let rate = graph.intern(&name);
        rates.insert(rate, signal);
        let rate = graph.symbol(rate);
        terms.push(graph.mul(slope, rate));
    }
    graph.sum(terms)
}

/// That of the choices whose rows, a square matrix, are conditioned best, and better than [`SINGULAR`]; `all` has the rows of `longest`
/// derivatives of each output, output by output.
fn best_lengths(
    choices: Vec<Vec<usize>>,
    all: &DMatrix<f64>,
    longest: usize,
    condition: impl Fn(&DMatrix<f64>) -> f64,
) -> Option<Vec<usize>> {
    let graded =
        choices.into_iter().filter(|lengths| lengths.iter().sum::<usize>() == all.ncols()).map(|lengths| {
            let rows = lengths.iter().enumerate();
            let rows: Vec<usize> =
                rows.flat_map(|(output, length)| (0..*length).map(move |k| output * longest + k)).collect();
            (condition(&all.select_rows(&rows)), lengths)
        });
    let best =
        graded.filter(|(condition, _)| *condition < SINGULAR).reduce(|a, b| if b.0 < a.0 { b } else { a });
    best.map(|(_, lengths)| lengths)
}

/// The observability indices of rows, `longest` of each output: a derivative is taken wherever it is independent of all lower ones and of
/// those of its order before it, and the one below it was taken.
fn observability_indices(all: &DMatrix<f64>, longest: usize) -> Vec<usize> {
    let m = all.nrows() / longest;
    let mut lengths = vec![0; m];
    let mut basis: Vec<RowDVector<f64>> = Vec::new();
    for k in 0..longest {
        for (output, length) in lengths.iter_mut().enumerate().filter(|(_, length)| **length == k) {
            let row = all.row(output * longest + k).into_owned();
            let size = row.norm();
            // twice: the second projection takes away the rounding of the first
            let rest =
                (0..2).fold(row, |row, _| basis.iter().fold(row, |row, unit| &row - unit * row.dot(unit)));
            if rest.norm() > size / SINGULAR.sqrt() {
                basis.push(rest.normalize());
                *length += 1;
            }
        }
    }
    lengths
}

/// All ways to write `n` as a sum of `m` positive numbers of which none is larger than `most`; nothing where there are more than
/// [`MOST_CHOICES`].
fn compositions(n: usize, m: usize, most: usize) -> Option<Vec<Vec<usize>>> {
    let mut begun = vec![Vec::new()];
    for left in (0..m).rev() {
        let with = |lengths: &Vec<usize>| {
            let rest = n.saturating_sub(lengths.iter().sum());
            let fits = (1..=most).filter(move |k| (left..=left * most).contains(&rest.wrapping_sub(*k)));
            fits.map(|k| [&lengths[..], &[k]].concat()).collect::<Vec<_>>()
        };
        begun = begun.iter().flat_map(with).collect();
        if begun.len() > MOST_CHOICES {
            return None;
        }
    }
    Some(begun)
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |value, i| value * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_all_or_none() {
        assert_eq!(compositions(4, 2, 3), Some(vec![vec![1, 3], vec![2, 2], vec![3, 1]]));
        assert_eq!(compositions(7, 2, 3), Some(Vec::new()));
        assert_eq!(compositions(1, 2, 3), Some(Vec::new()));
        // coefficients of (x + x^2 + x^3)^6
        assert_eq!(compositions(12, 6, 3).map(|all| all.len()), Some(141));
        // 77 million without a bound on each part
        assert_eq!(compositions(30, 15, 3), None);
    }

    #[test]
    fn observability_indices_take_the_lowest_derivatives_that_are_independent() {
        // y1' is y2, and y2 has a second derivative of its own
        let rows = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]];
        let all = DMatrix::from_fn(6, 4, |i, j| f64::from(rows[i][j]));
        assert_eq!(observability_indices(&all, 3), [1, 3]);
        let condition = |matrix: &DMatrix<f64>| if matrix.determinant() == 0.0 { f64::INFINITY } else { 1.0 };
        assert_eq!(best_lengths(compositions(4, 2, 3).unwrap(), &all, 3, condition), Some(vec![1, 3]));
    }
}
