//! Two witnesses that share nothing with what they vouch for: a body moved by Newton's laws alone for the observers'
//! equations, and plain differences for the derivatives of the flow.

use crate::observe::{NEVER, REGIMES, experiment, text, with};
use palmistry::System;
use palmistry::experiment::{Experiment, Simulation};
use palmistry::expression::{Input, NodeId, Program};
use palmistry::number::Floats;
use palmistry::observer::{ModelFlow, Order, Sample, Stride};
use std::path::Path;

/// The central difference of order eight: the weights of the values one to four steps away.
const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// How a column changes at a sample, in its unit a second.
fn rate_of(column: &[f64], step: f64, at: usize) -> f64 {
    let pairs = (1..).zip(WEIGHTS).map(|(k, weight)| weight * (column[at + k] - column[at - k]));
    pairs.sum::<f64>() / step
}

/// The rate of a state along `f + tau1 g1 + tau2 g2` at a sample, in the system's own words.
fn told_rate(system: &System, simulation: &Simulation, name: &str, row: usize) -> f64 {
    let state = system.find_symbol(name).unwrap();
    let nodes: Vec<NodeId> = system
        .fields
        .iter()
        .filter_map(|field| field.components.iter().find(|(other, _)| *other == state).map(|(_, node)| *node))
        .collect();
    let program = Program::plain(&system.graph, &nodes);
    let value = |name: &str| simulation.truth(name).unwrap_or_else(|| panic!("{name}"))[row];
    let inputs: Vec<f64> = program
        .inputs()
        .iter()
        .map(|input| match input {
            Input::Plain(symbol) => value(system.symbol_name(*symbol)),
            other => panic!("no {other:?} was asked for"),
        })
        .collect();
    let parts = program.load(Floats).unwrap().run(&inputs, &mut Vec::new()).unwrap();
    match parts[..] {
        // the torques move neither radius at once
        [f] => f,
        [f, g1, g2] => f + value("tau1") * g1 + value("tau2") * g2,
        _ => panic!("{name} has {} parts", parts.len()),
    }
}

/// The corrected equations (4.31, 4.34, and 4.19 to 4.23) against a body moved by Newton's laws, in all regimes and under torques.
///
/// The simulation's steps are good to 1e-12, its samples 3.5 ms apart: differences of order eight carry the former as 1e-9
/// a second, and leave out less than that.
#[test]
fn simulated_bodies_move_as_the_thesis_says_they_do() {
    // motors that push with the torques of the scene's start, and a swing: both palms accelerate
    let pushed = "torques = [
        { angle = 0.4, rate = 0.4, torque = 5.1, swings = [{ amplitude = 0.5, frequency = 1.0 }] },
        { angle = 1.8, rate = 0.0, torque = -6.2, swings = [{ amplitude = 0.3, frequency = 2.0 }] },
    ]";
    let prescribed = "prescribed = [{ start = 0.4, rate = 0.4 }, { start = 1.8 }]";
    let mut scenes = REGIMES.map(text).to_vec();
    scenes.push(with(&text("same_rate"), prescribed, pushed));
    let system = System::read(Path::new("proofs/moll2002/general.proof")).unwrap();
    for text in scenes {
        let experiment = experiment(&text);
        let title = &experiment.scene.title;
        let simulation = experiment.simulation.as_ref().unwrap();
        let times = experiment.signals.times();
        let step = times[1] - times[0];
        let mut compared = 0;
        for row in (4..times.len() - 4).step_by(24) {
            for name in ["s1", "s2", "omega0", "r1", "r2"] {
                let found = rate_of(&simulation.truth(name).unwrap(), step, row);
                let told = told_rate(&system, simulation, name, row);
                let size = 1.0 + found.abs();
                assert!(
                    (found - told).abs() < 2e-9 * size,
                    "{title}: {name}' at {}: {found} and {told}",
                    times[row]
                );
                compared += 1;
            }
            // the witness is awake: with the sign that 4.31 has in print s2' is another
            let value = |name: &str| simulation.truth(name).unwrap()[row];
            let (omega0, phi12) = (value("omega0"), value("phi1") + value("phi2"));
            let first = (-omega0.powi(2) * value("r2") + value("g") * phi12.cos())
                / (value("omega1") + value("omega2") - omega0);
            let found = rate_of(&simulation.truth("s2").unwrap(), step, row);
            let printed = told_rate(&system, simulation, "s2", row) - 2.0 * first;
            assert!((found - printed).abs() > 1e-3, "{title} at {}: {found} and {printed}", times[row]);
        }
        assert!(compared >= 40, "{title}: {compared}");
    }
}

/// What a flow is asked for: the last of 81 samples, from a start whose places `i` and `j` are moved.
struct Followed<'a> {
    flow: ModelFlow<'a>,
    start: Vec<f64>,
    times: &'a [f64],
}

impl Followed<'_> {
    fn end(&self, order: Order, moved: &[(usize, f64)]) -> Sample {
        let mut start = self.start.clone();
        moved.iter().for_each(|(place, by)| start[*place] += by);
        let free: Vec<usize> = (0..start.len()).collect();
        self.flow.follow(&start, &free, self.times, order).unwrap().pop().unwrap()
    }

    fn values(&self, moved: &[(usize, f64)]) -> Vec<f64> {
        let end = self.end(Order::Value, moved);
        [end.state, end.outputs].concat()
    }

    /// A sum of values at some starts, weighted.
    fn sum(&self, parts: &[(f64, &[(usize, f64)])]) -> Vec<f64> {
        let mut sum = vec![0.0; self.start.len() + self.flow.model.outputs.len()];
        for (weight, moved) in parts {
            sum.iter_mut().zip(self.values(moved)).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }

    /// The first difference by one place.
    fn first(&self, i: usize, h: f64) -> Vec<f64> {
        self.sum(&[(0.5 / h, &[(i, h)]), (-0.5 / h, &[(i, -h)])])
    }

    /// The second difference by two places, which may be the same.
    fn second(&self, i: usize, j: usize, h: f64) -> Vec<f64> {
        let w = 0.25 / (h * h);
        let mixed = |a: f64, b: f64| [(i, a * h), (j, b * h)];
        self.sum(&[
            (w, &mixed(1.0, 1.0)),
            (-w, &mixed(1.0, -1.0)),
            (-w, &mixed(-1.0, 1.0)),
            (w, &mixed(-1.0, -1.0)),
        ])
    }
}

/// Richardson's step: the difference with its error of second order taken out, and what that changed.
fn extrapolated(wide: &[f64], narrow: &[f64]) -> Vec<(f64, f64)> {
    wide.iter()
        .zip(narrow)
        .map(|(wide, narrow)| ((4.0 * narrow - wide) / 3.0, (narrow - wide).abs()))
        .collect()
}

fn followed<T>(experiment: &Experiment, ask: impl FnOnce(&Followed<'_>) -> T) -> T {
    let task = experiment.task(&NEVER).unwrap();
    let simulation = experiment.simulation.as_ref().unwrap();
    let start = task.full.states.iter().map(|name| simulation.truth(name).unwrap()[0]).collect();
    let flow =
        ModelFlow { model: &task.full, signals: task.signals, tolerance: 1e-13, stride: Stride::BySample };
    ask(&Followed { flow, start, times: &task.signals.times()[..=80] })
}

/// The derivatives of the flow by the unknowns, integrated along, against differences of the flow without any.
///
/// The tolerance: a difference carries the flow's rounding, some 1e-12 over the step, or over its square, and what the
/// extrapolation leaves out, which is small beside what it changed.
#[test]
fn the_derivatives_of_the_flow_are_its_differences() {
    let experiment = experiment(&text("general"));
    followed(&experiment, |followed| {
        let n = followed.start.len();
        assert_eq!(followed.flow.model.states, ["r1", "r2", "omega0", "rho", "s1", "s2"]);
        let [first, second] = [Order::First, Order::Second].map(|order| followed.end(order, &[]));
        assert!((&first.slopes - &second.slopes).amax() < 1e-9 * (1.0 + first.slopes.amax()));
        assert!(first.slopes.amax() > 0.1, "the test has looked at something");
        for i in 0..n {
            let h = 1e-4;
            let differences = extrapolated(&followed.first(i, h), &followed.first(i, h / 2.0));
            for (row, (difference, change)) in differences.into_iter().enumerate() {
                let own = if row < n { first.slopes[(row, i)] } else { first.output_slopes[(row - n, i)] };
                let allowed = 0.1 * change + 1e-12 / h * (1.0 + own.abs());
                assert!(
                    (own - difference).abs() < allowed,
                    "{row} by {i}: {own} and {difference}, {allowed:e}"
                );
            }
            for j in 0..=i {
                let h = 2e-3;
                let differences = extrapolated(&followed.second(i, j, h), &followed.second(i, j, h / 2.0));
                for (output, (difference, change)) in differences.into_iter().skip(n).enumerate() {
                    let own = second.output_bends[output][(i, j)];
                    assert_eq!(own, second.output_bends[output][(j, i)]);
                    let allowed = 0.1 * change + 1e-12 / (h * h) * (1.0 + own.abs());
                    assert!(
                        (own - difference).abs() < allowed,
                        "{output} by {i}, {j}: {own} and {difference}, {allowed:e}"
                    );
                }
            }
        }
    });
}
