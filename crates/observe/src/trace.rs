//! How far a window of measurements would show that something is wrong with what is taken for known.
//!
//! An error of a constant, of a gain or of the outputs' time moves the measurements along a direction `d`. The part of it that the unknowns can
//! follow biases the estimate and has no trace; only the rest, `e = d - J J^+ d`, shows as a residual. Where `e` is zero
//! the measurements cannot distinguish the error from the unknowns, whatever its size.

use super::chi_square::noncentrality;
use super::fit::{Fit, NoiseFrom};
use super::suspect::{Suspect, SuspectKind};
use super::task::Task;
use super::track::{Update, UpdateEnd};
use super::window::{Window, WindowExpansion};
use super::{Lost, Model, ModelFlow, ModelQuestion, Order, Signals};
use nalgebra::{DMatrix, DVector};

/// Differences are taken so far to both sides, and twice so far, relative to what is varied.
const STEP: f64 = 1e-3;

/// A rest of a direction below this part of it is an error of the differences.
const NOTHING: f64 = 1e-6;

/// Two traces whose cosine differs from one by less are one.
const PARALLEL: f64 = 1e-8;

/// An error counts as noticed that is found with this probability.
pub const POWER: f64 = 0.99;

/// A direction in which the measurements would move.
struct Direction {
    name: String,
    kind: SuspectKind,
    slope: DVector<f64>,
}

/// The suspects of an update, each with what the measurements of its window say of it; none where the model cannot be followed.
pub(super) fn suspects(task: &Task<'_>, window: &Window<'_>, update: &Update, alarm: f64) -> Vec<Suspect> {
    let Some(fit) = update.fit else { return Vec::new() };
    let start = [&update.estimate[..], &update.outputs].concat();
    let window = Window { start, ..window.clone() };
    let unknowns = window.unknowns(&window.start);
    let Ok(here) = window.expand(&unknowns, Order::First) else { return Vec::new() };
    let tested = TestedRows::of(&here, &window, &fit);
    let Some(unobserved) = Remainder::of(&tested, &window, task) else { return Vec::new() };
    let needed = noncentrality(alarm, POWER, fit.degrees as f64);
    let directions = directions(task, &window, &here);
    let judged = |direction: Direction| {
        let slope = tested.only(window.weighted(direction.slope));
        unobserved.judge(Direction { slope, ..direction }, &tested, &fit, needed)
    };
    let mut judged: Vec<(Suspect, DVector<f64>)> = directions.into_iter().filter_map(judged).collect();
    let names: Vec<String> = judged.iter().map(|(suspect, _)| suspect.to_string()).collect();
    let traces: Vec<DVector<f64>> = judged.iter().map(|(_, trace)| trace.clone()).collect();
    for (i, (suspect, trace)) in judged.iter_mut().enumerate() {
        let others = (0..traces.len()).filter(|j| *j != i && suspect.noticed.is_some());
        let same = others.filter(|j| trace.dot(&traces[*j]).abs() > 1.0 - PARALLEL);
        suspect.same_as = same.map(|j| names[j].clone()).collect();
    }
    judged.into_iter().map(|(suspect, _)| suspect).collect()
}

/// Whether an update is one of which suspects are asked for: its state is the best one, and the errors of the measurements are known.
pub(super) fn is_asked(update: &Update) -> bool {
    let stated = update.fit.is_some_and(|fit| fit.from == NoiseFrom::Stated);
    stated && matches!(update.end, UpdateEnd::Converged | UpdateEnd::DoesNotFit)
}

/// What the test of fit compares: residuals without what a robust loss leaves out of it as outliers, and the derivatives that belong to them.
struct TestedRows {
    residuals: DVector<f64>,
    slopes: DMatrix<f64>,
    outliers: Vec<usize>,
}

impl TestedRows {
    fn of(here: &WindowExpansion, window: &Window<'_>, fit: &Fit) -> TestedRows {
        let loss = window.loss.0;
        let is_out = |i: &usize| loss.is_outlier(here.counted[*i], fit.sigma, 0.0);
        let outliers: Vec<usize> = (window.relations()..here.counted.len()).filter(is_out).collect();
        let (mut residuals, mut slopes) = (here.counted.clone(), here.counted_slopes().clone());
        for place in &outliers {
            residuals[*place] = 0.0;
            slopes.row_mut(*place).fill(0.0);
        }
        TestedRows { residuals, slopes, outliers }
    }

    /// A direction without what it has along outliers.
    fn only(&self, mut direction: DVector<f64>) -> DVector<f64> {
        self.outliers.iter().for_each(|place| direction[*place] = 0.0);
        direction
    }
}

/// The rest of directions where the unknowns have followed as far as they can.
struct Remainder {
    /// The pseudoinverse of the scaled derivatives by its factors, `V / S` and `U^T`; the sizes with it.
    back: DMatrix<f64>,
    onto: DMatrix<f64>,
    /// The places of the unknowns among the estimates.
    free: Vec<usize>,
    estimated: usize,
}

impl Remainder {
    fn of(tested: &TestedRows, window: &Window<'_>, task: &Task<'_>) -> Option<Remainder> {
        let size = |place: &usize| match task.sizes.get(*place) {
            Some(size) => *size,
            None => window.start[*place].abs().max(1e-3),
        };
        let sizes: Vec<f64> = window.free.iter().map(size).collect();
        let (n, p) = tested.slopes.shape();
        let scaled = DMatrix::from_fn(n, p, |i, j| tested.slopes[(i, j)] * sizes[j]);
        if scaled.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let svd = scaled.try_svd(true, true, f64::EPSILON, 10_000)?;
        let (u, v) = (svd.u?, svd.v_t?);
        let back = DMatrix::from_fn(p, p, |i, k| {
            if svd.singular_values[k] > 0.0 { sizes[i] * v[(k, i)] / svd.singular_values[k] } else { 0.0 }
        });
        Some(Remainder { back, onto: u.transpose(), free: window.free.clone(), estimated: task.estimated() })
    }

    /// A suspect, and the residuals of its direction, of length one where something is.
    fn judge(
        &self,
        direction: Direction,
        tested: &TestedRows,
        fit: &Fit,
        needed: f64,
    ) -> Option<(Suspect, DVector<f64>)> {
        let Direction { name, kind, slope } = direction;
        let length = slope.norm();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let parts = &self.onto * &slope;
        let left = &slope - self.onto.tr_mul(&parts);
        let seen = left.norm();
        let is_observable = seen > NOTHING * length;
        let followed = &self.back * parts;
        let mut shifts = vec![0.0; self.estimated];
        for (place, shift) in self.free.iter().zip(followed.iter()) {
            if let Some(own) = shifts.get_mut(*place) {
                *own = *shift;
            }
        }
        // the differences are expected minus measured
        let error = if is_observable { -left.dot(&tested.residuals) / (seen * seen) } else { 0.0 };
        let noticed = is_observable.then(|| needed.sqrt() * fit.sigma / seen);
        let explains = (error, (error * seen / fit.sigma).powi(2));
        let trace = if is_observable { left / seen } else { DVector::zeros(slope.len()) };
        Some((Suspect { name, kind, noticed, shifts, explains, same_as: Vec::new() }, trace))
    }
}

/// The directions of all that is taken for known and not zero.
fn directions(task: &Task<'_>, window: &Window<'_>, here: &WindowExpansion) -> Vec<Direction> {
    let (system, wanted) = &*task.source;
    let mut all = Vec::new();
    let mut add = |name: &str, kind: SuspectKind, slope: Option<DVector<f64>>| {
        let measured = |mut slope: DVector<f64>| {
            window.unmeasured().for_each(|place| slope[place] = 0.0);
            slope
        };
        all.extend(slope.map(|own| Direction { name: name.to_owned(), kind, slope: measured(own) }));
    };
    let question = |known: &std::collections::BTreeMap<String, f64>| ModelQuestion {
        followed: task.full.states.clone(),
        known: known.clone(),
        inputs: wanted.inputs.clone(),
    };
    let defaults = system.symbols().filter_map(|(symbol, info)| {
        let name = system.symbol_name(symbol);
        let is_given = task.signals.find(name).is_some() || wanted.known.contains_key(name);
        let value = info.default.as_ref().map(palmistry_math::number::rational_to_f64)?;
        (!is_given).then(|| (name.to_owned(), value))
    });
    let constants = wanted.known.clone().into_iter().chain(defaults);
    for (name, value) in constants.filter(|(_, value)| *value != 0.0) {
        let slope = difference(|factor| {
            let mut known = wanted.known.clone();
            known.insert(name.clone(), value * factor);
            let model = Model::new(system, &question(&known), task.signals).ok()?;
            expected(window, &ModelFlow { model: &model, ..window.flow }).ok()
        });
        add(&name, SuspectKind::Constant, slope);
    }
    let (mut together, mut names) = (None, Vec::new());
    for (_, symbol) in &wanted.inputs {
        let Some(column) = task.signals.find(symbol).filter(|_| !wanted.known.contains_key(symbol)) else {
            continue;
        };
        // a gain that is estimated is under no suspicion
        if task.full.find(&format!("{symbol}.gain")).is_some() {
            continue;
        }
        let slope = difference(|factor| {
            let signals = window.flow.signals.scaled(column, factor);
            expected(window, &ModelFlow { signals: &signals, ..window.flow }).ok()
        });
        if let Some(slope) = &slope {
            together = Some(together.map_or_else(|| slope.clone(), |all: DVector<f64>| all + slope));
            names.push(symbol.as_str());
        }
        add(symbol, SuspectKind::InputGain, slope);
    }
    if names.len() > 1 {
        add(&names.join(" and "), SuspectKind::InputGain, together);
    }
    let outputs = task.full.outputs.len().max(1);
    let read: Vec<f64> = window.measured.concat();
    for (place, name) in task.full.outputs.iter().enumerate() {
        if task.full.is_implicit(place) || task.full.find(&format!("{name}.gain")).is_some() {
            continue;
        }
        // a gain multiplies the measurements without their errors: those themselves would seem to show any gain
        let own = |i: usize, _| if i % outputs == place { read[i] + here.left[i] } else { 0.0 };
        add(name, SuspectKind::OutputGain, Some(DVector::from_fn(read.len(), own)));
    }
    // a delay that is estimated is under no suspicion
    if task.full.delays.iter().any(Option::is_some) {
        return all;
    }
    // what is late in an implicit output are its measurements, each in its own way
    let modelled = |(i, (off, read)): (usize, (&f64, &f64))| {
        if task.full.is_implicit(i % outputs) { 0.0 } else { off + read }
    };
    let modelled: Vec<f64> = here.left.iter().zip(&read).enumerate().map(modelled).collect();
    add(
        &task.full.outputs.join(", "),
        SuspectKind::Delay,
        rates(window.times, &modelled, outputs).map(|rates| -rates),
    );
    all
}

/// The derivative of the measurements by the logarithm of something, by differences of the fourth order.
fn difference(at: impl Fn(f64) -> Option<DVector<f64>>) -> Option<DVector<f64>> {
    let [near, far] = [1.0, 2.0].map(|k| Some(at(1.0 + k * STEP)? - at(1.0 - k * STEP)?));
    let slope = (near? * 8.0 - far?) / (12.0 * STEP);
    slope.iter().all(|value| value.is_finite()).then_some(slope)
}

/// What a flow expects of the measurements of a window.
fn expected(window: &Window<'_>, flow: &ModelFlow<'_>) -> Result<DVector<f64>, Lost> {
    let samples = flow.follow(&window.start, &[], window.times, Order::Value)?;
    Ok(DVector::from_vec(samples.into_iter().flat_map(|sample| sample.outputs).collect()))
}

/// The rates of change of the outputs, sample by sample.
fn rates(times: &[f64], values: &[f64], outputs: usize) -> Option<DVector<f64>> {
    let column = |output: usize| values.iter().skip(output).step_by(outputs).copied().collect();
    let columns = (0..outputs).map(|output| (output.to_string(), column(output))).collect();
    let signals = Signals::new(times.to_vec(), columns).ok()?;
    let places: Vec<usize> = (0..outputs).collect();
    let mut all = Vec::new();
    for time in times {
        let mut rates = vec![0.0; outputs];
        signals.rates_at(&places, *time, &mut rates);
        all.extend(rates);
    }
    Some(DVector::from_vec(all))
}
