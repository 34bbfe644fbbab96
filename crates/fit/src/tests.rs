//! Checked against closed forms, published values of a stiff system, differences, and normal equations.

use super::compiled::{CompiledPhase, Names};
use super::laws::Term;
use super::simulate::{At, Moment};
use super::*;
use nalgebra::DMatrix;
use palmistry_lang::System;
use palmistry_math::expression::NodeId;
use std::path::Path;

mod resumed;

const NEVER: fn() -> bool = || false;

/// What is measured: experiment, output, time, value, size.
type Row<'a> = (usize, &'a str, f64, f64, &'a str);

/// What is set, and where the states start.
type Conditions<'a> = (&'a [(&'a str, &'a str)], &'a [Option<&'a str>]);

/// Parameters `[name, low, high]` of a system, experiments as values of other parameters with the starts of its states, and measurements.
struct Made<'a> {
    text: &'a str,
    parameters: &'a [(&'a str, f64, f64, ParameterScale)],
    experiments: &'a [Conditions<'a>],
    rows: &'a [Row<'a>],
    clock: Option<usize>,
}

impl Made<'_> {
    fn problem(&self) -> JointProblem {
        let mut system = System::parse("m.proof", self.text, Path::new("")).unwrap();
        let names: Vec<&str> = self.parameters.iter().map(|one| one.0).collect();
        let states: Vec<_> = system
            .states
            .iter()
            .copied()
            .filter(|state| !names.contains(&system.symbol_name(*state)))
            .collect();
        let drift = system.drift().unwrap();
        let rates: Vec<NodeId> = states
            .iter()
            .map(|state| {
                let found = system.fields[drift].components.iter().find(|(other, _)| other == state);
                found.map_or_else(|| panic!("no rate"), |(_, node)| *node)
            })
            .collect();
        let value =
            |system: &mut System, text: &str| system.evaluate_text(text).unwrap().as_number().unwrap();
        let mut experiments = Vec::new();
        for (set, start) in self.experiments {
            let settings: std::collections::HashMap<_, _> = set
                .iter()
                .map(|(name, text)| (system.find_symbol(name).unwrap(), value(&mut system, text)))
                .collect();
            let own = system.graph.substitute(&rates, &settings);
            let start = start.iter().map(|one| one.map(|text| value(&mut system, text))).collect();
            experiments.push(JointExperiment {
                name: format!("e{}", experiments.len()),
                before: None,
                phase: Phase { rates: own, start },
            });
        }
        let measurements = self
            .rows
            .iter()
            .map(|(experiment, output, time, measured, size)| JointMeasurement {
                experiment: *experiment,
                output: (*output).to_owned(),
                time: *time,
                value: *measured,
                expected: value(&mut system, output),
                size: value(&mut system, size),
                scale: ErrorScale::Linear,
                law: ErrorLaw::Normal,
            })
            .collect();
        let parameters = self
            .parameters
            .iter()
            .map(|(name, low, high, scale)| EstimatedParameter {
                name: (*name).to_owned(),
                symbol: system.find_symbol(name).unwrap(),
                scale: *scale,
                bounds: [*low, *high],
                starts: None,
                nominal: None,
                prior: None,
            })
            .collect();
        JointProblem { system, states, clock: self.clock, parameters, experiments, measurements }
    }

    fn likelihood(&self) -> Likelihood {
        Likelihood::new(self.problem()).unwrap()
    }
}

const LOG10: ParameterScale = ParameterScale::Log10;
const LINEAR: ParameterScale = ParameterScale::Linear;

/// The gradient by central differences.
fn differences(likelihood: &Likelihood, place: &[f64]) -> Vec<f64> {
    let at = |place: &[f64]| likelihood.at(place, Exactness::Answer, &NEVER).unwrap().objective;
    (0..place.len())
        .map(|i| {
            let step = 1e-4;
            let moved = |by: f64| {
                let mut moved = place.to_vec();
                moved[i] += by;
                at(&moved)
            };
            (moved(step) - moved(-step)) / (2.0 * step)
        })
        .collect()
}

fn near(one: f64, other: f64, part: f64) {
    assert!((one - other).abs() <= part * (1.0 + other.abs()), "{one:e} and {other:e}");
}

/// A decay from an unknown start: values, gradient and information by the closed form, on mixed scales.
#[test]
fn a_decay_is_as_its_closed_form() {
    let rows: Vec<Row<'_>> = (0..6).map(|i| (0, "2*x", f64::from(i), 1.0, "s*(1 + x)")).collect();
    let made = Made {
        text: "system \"decay\"\nstate x\nparam k, a, s unknown\ndrift f\n  x' = -k*x\noutput x\n",
        parameters: &[
            ("k", 1e-3, 1e2, LOG10),
            ("a", -10.0, 10.0, LINEAR),
            ("s", 1e-3, 1e2, ParameterScale::Log),
        ],
        experiments: &[(&[], &[Some("a")])],
        rows: &rows,
        clock: None,
    };
    let likelihood = made.likelihood();
    let (k, a, s) = (0.7f64, 1.5f64, 0.3f64);
    let place = [k.log10(), a, s.ln()];
    let found = likelihood.at(&place, Exactness::Answer, &NEVER).unwrap();
    let mut objective = 0.0;
    for (i, (expected, size)) in found.expected.iter().zip(&found.sizes).enumerate() {
        let x = a * (-k * i as f64).exp();
        near(*expected, 2.0 * x, 1e-8);
        near(*size, s * (1.0 + x), 1e-8);
        let residual = (2.0 * x - 1.0) / (s * (1.0 + x));
        objective += 0.5 * (std::f64::consts::TAU * (s * (1.0 + x)).powi(2)).ln() + 0.5 * residual * residual;
    }
    near(found.objective, objective, 1e-8);
    for (own, other) in found.gradient.iter().zip(differences(&likelihood, &place)) {
        near(*own, other, 1e-6);
    }
    // by k: x' = -t x; the information is that of the expected values and of the sizes
    let by_k = |t: f64| -t * a * (-k * t).exp() * k * std::f64::consts::LN_10;
    let own: f64 = (0..6)
        .map(|i| {
            let size = s * (1.0 + a * (-k * f64::from(i)).exp());
            (2.0 * by_k(f64::from(i)) / size).powi(2) + 2.0 * (s * by_k(f64::from(i)) / size).powi(2)
        })
        .sum();
    near(found.information[(0, 0)], own, 1e-7);
}

/// H. H. Robertson's reactions: rates that differ by nine orders of magnitude. Values at 40 and 4e5 as in E. Hairer, G. Wanner (test set IVP) and SUNDIALS' example.
#[test]
fn a_stiff_system_is_followed_with_its_derivatives() {
    let rows: Vec<Row<'_>> = [40.0, 4e5]
        .iter()
        .flat_map(|time| ["x", "1e6*y", "z"].map(|output| (0, output, *time, 0.5, "1")))
        .collect();
    let made = Made {
        text: "system \"robertson\"\nstate x, y, z\nparam a, b, c unknown\ndrift f\n  x' = -a*x + b*y*z\n  y' = a*x - b*y*z - c*y^2\n  z' = c*y^2\noutput x\n",
        parameters: &[("a", 1e-4, 1e1, LOG10), ("b", 1e2, 1e6, LOG10), ("c", 1e5, 1e9, LOG10)],
        experiments: &[(&[], &[Some("1"), Some("0"), Some("0")])],
        rows: &rows,
        clock: None,
    };
    let likelihood = made.likelihood();
    let place = [0.04f64.log10(), 4.0, 3e7f64.log10()];
    let found = likelihood.at(&place, Exactness::Answer, &NEVER).unwrap();
    let known = [0.715_827_068_7, 9.185_534_764_5, 0.284_163_745_7, 4.938_3e-3, 1.984_99e-2, 0.995_061_7];
    let parts = [1e-8, 1e-8, 1e-8, 1e-5, 1e-5, 1e-6];
    for ((own, known), part) in found.expected.iter().zip(known).zip(parts) {
        near(*own, known, part);
    }
    for (own, other) in found.gradient.iter().zip(differences(&likelihood, &place)) {
        near(*own, other, 1e-5);
    }
}

/// At steady state before the experiment, and measured at steady state behind it, with the derivatives of both.
#[test]
fn rest_is_found_with_its_derivatives() {
    let made = Made {
        text: "system \"rest\"\nstate x, t\nparam a, b unknown\nparam u = 1\ndrift f\n  x' = a - b*u*x\n  t' = 1\noutput x\n",
        parameters: &[("a", 1e-3, 1e3, LOG10), ("b", 1e-3, 1e3, LOG10)],
        // u is one before, and two in the experiment; the clock begins again
        experiments: &[(&[("u", "2")], &[Some("3"), Some("0")])],
        rows: &[(0, "x", 0.5, 1.0, "1"), (0, "x", f64::INFINITY, 1.0, "1")],
        clock: Some(1),
    };
    let mut problem = made.problem();
    let one = problem.system.graph.integer(1);
    let u = problem.system.find_symbol("u").unwrap();
    let rates = problem.experiments[0].phase.rates.clone();
    // the same rates with u = 1: doubled b is undone
    let values = std::collections::HashMap::from([(u, one)]);
    let drift = problem.system.drift().unwrap();
    let first = problem.system.fields[drift].components[0].1;
    let before = problem.system.graph.substitute(&[first], &values)[0];
    let zero = problem.system.graph.integer(0);
    problem.experiments[0].before =
        Some(Phase { rates: vec![before, rates[1]], start: vec![Some(zero), Some(zero)] });
    problem.experiments[0].phase.start = vec![None, Some(zero)];
    let likelihood = Likelihood::new(problem).unwrap();
    let (a, b) = (1.2f64, 0.4f64);
    let place = [a.log10(), b.log10()];
    let found = likelihood.at(&place, Exactness::Answer, &NEVER).unwrap();
    let (old, new) = (a / b, a / (2.0 * b));
    near(found.expected[0], new + (old - new) * (-2.0 * b * 0.5).exp(), 1e-7);
    near(found.expected[1], new, 1e-7);
    for (own, other) in found.gradient.iter().zip(differences(&likelihood, &place)) {
        near(*own, other, 1e-5);
    }
}

/// Steady states whose derivatives follow from their equations and from what is conserved, or do not: a reaction with two conserved sums, one of them of
/// a parameter; two volumes, whose conserved sum depends on them; a start that is at rest; an epidemic, in which what is left depends on all that happened. Oracles: the
/// equations of the steady state, solved by bisection, and their differences.
#[test]
fn steady_states_have_their_derivatives() {
    // a value at which an increasing function is zero
    fn zero(of: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
        for _ in 0..200 {
            let middle = (low + high) / 2.0;
            if of(middle) < 0.0 { low = middle } else { high = middle }
        }
        (low + high) / 2.0
    }
    let reaction = |p: &[f64]| {
        let [k, m, all_a, all_b] = [p[0], p[1], p[2] + 0.25, 2.25];
        let c = zero(|c| m * c - k * (all_a - c) * (all_b - c), [0.0, all_a.min(all_b)]);
        vec![all_a - c, all_b - c, c]
    };
    let volumes = |p: &[f64]| {
        let [k, m, v, w] = [p[0], p[1], p[2], 2.0];
        let y = (v + 3.0 * w) / (v * k / m + w);
        vec![k * y / m, y]
    };
    // where it begins at rest
    let still = |p: &[f64]| vec![p[1] / (p[0] * p[2])];
    // log(S/S0) = (S - N)*b/g, and nothing is left of I
    let epidemic = |p: &[f64]| {
        let (b, g) = (p[0], p[1]);
        let all = 1.0 + p[2];
        vec![zero(|s| s.ln() - (s - all) * b / g, [1e-12, g / b]), 0.0]
    };
    type Closed<'c> = &'c dyn Fn(&[f64]) -> Vec<f64>;
    type Kind<'k> = (&'k str, &'k [Option<&'k str>], &'k [&'k str], [f64; 3], Closed<'k>, bool);
    let kinds: [Kind<'_>; 4] = [
        (
            "x\nparam k, m, p unknown\ndrift f\n  x' = m - k*p*x\noutput x\n",
            &[Some("3")],
            &["x"],
            [0.4, 2.4, 2.0],
            &still,
            true,
        ),
        (
            "A, B, C\nparam k, m, p unknown\ndrift f\n  A' = -k*A*B + m*C\n  B' = -k*A*B + m*C\n  C' = k*A*B - m*C\noutput A\n",
            &[Some("p"), Some("2"), Some("1/4")],
            &["A", "B", "C"],
            [3e2, 0.7e2, 1.3],
            &reaction,
            true,
        ),
        (
            "x, y\nparam k, m, p unknown\ndrift f\n  x' = (k*y - m*x)/p\n  y' = (m*x - k*y)/2\noutput x\n",
            &[Some("1"), Some("3")],
            &["x", "y"],
            [0.4, 0.9, 5.0],
            &volumes,
            false,
        ),
        (
            "S, I\nparam k, m, p unknown\ndrift f\n  S' = -k*S*I\n  I' = k*S*I - m*I\noutput S\n",
            &[Some("1"), Some("p")],
            &["S", "I"],
            [1.5, 0.6, 0.02],
            &epidemic,
            false,
        ),
    ];
    for (text, start, outputs, values, closed, is_determined) in kinds {
        let text = format!("system \"rest\"\nstate {text}");
        let rows: Vec<Row<'_>> = outputs.iter().map(|output| (0, *output, f64::INFINITY, 0.3, "1")).collect();
        let made = Made {
            text: &text,
            parameters: &["k", "m", "p"].map(|name| (name, 1e-3, 1e3, LOG10)),
            experiments: &[(&[], start)],
            rows: &rows,
            clock: None,
        };
        let likelihood = made.likelihood();
        let place = values.map(f64::log10);
        let found = likelihood.at(&place, Exactness::Answer, &NEVER).unwrap();
        let of_place = |place: &[f64]| closed(&place.iter().map(|one| 10f64.powf(*one)).collect::<Vec<_>>());
        let known = of_place(&place);
        for (own, known) in found.expected.iter().zip(&known) {
            assert!((own - known).abs() < 1e-7 * (1.0 + known.abs()), "{text}: {own} {known}");
        }
        // which way the derivatives were found
        let mut problem = made.problem();
        let (names, phase) = (Names::of(&problem), problem.experiments[0].phase.clone());
        let phase = CompiledPhase::new(&mut problem.system, &phase, &names, None).unwrap();
        let at = At { values: &values, slopes: &values.map(|value| value * std::f64::consts::LN_10) };
        let rest = Moment { slopes: DMatrix::zeros(known.len(), 3), states: known.clone() };
        let slopes = phase.slopes_at_rest(&at, &phase.start(&at, None), &rest);
        assert_eq!(slopes.is_some(), is_determined, "{text}");
        for i in 0..3 {
            let moved = |by: f64| {
                let mut moved = place;
                moved[i] += by;
                of_place(&moved)
            };
            let slopes: Vec<f64> =
                moved(1e-4).iter().zip(moved(-1e-4)).map(|(one, other)| (one - other) / 2e-4).collect();
            let gradient: f64 = slopes.iter().zip(&known).map(|(slope, known)| slope * (known - 0.3)).sum();
            near(found.gradient[i], gradient, 1e-5);
        }
    }
}

/// A rate that is switched off at an unknown time: the state and its derivative by that time.
#[test]
fn a_jump_moves_with_its_time() {
    let made = Made {
        text: "system \"pulse\"\nstate x, t\nparam k, T unknown\ndrift f\n  x' = k*(1 + sign(T - t))/2\n  t' = 1\noutput x\n",
        parameters: &[("k", 1e-3, 1e3, LOG10), ("T", 0.5, 20.0, LINEAR)],
        experiments: &[(&[], &[Some("0"), Some("0")])],
        rows: &[(0, "x", 1.0, 1.0, "1"), (0, "x", 3.0, 1.0, "1"), (0, "x", 8.0, 1.0, "1")],
        clock: Some(1),
    };
    let likelihood = made.likelihood();
    for end in [3.0, 4.5] {
        let place = [0.3f64.log10(), end];
        let found = likelihood.at(&place, Exactness::Answer, &NEVER).unwrap();
        for (own, time) in found.expected.iter().zip([1.0f64, 3.0, 8.0]) {
            near(*own, 0.3 * time.min(end), 1e-8);
        }
        // what is measured at the very time has two derivatives
        if end > 4.0 {
            let residuals = found.expected.iter().map(|own| own - 1.0);
            let known: f64 = residuals.zip([0.0, 0.0, 0.3]).map(|(residual, slope)| residual * slope).sum();
            near(found.gradient[1], known, 1e-8);
        }
    }
}

/// An input that is measured itself, at the very time at which it is switched: it has been switched.
#[test]
fn an_input_has_been_switched_when_it_is_measured() {
    let made = Made {
        text: "system \"input\"\nstate x, t\nparam k, T unknown\ndrift f\n  x' = -k*x*(3 + sign(t - T))\n  t' = 1\nlet u = 3 + 2*sign(t - T)\noutput x\n",
        parameters: &[("k", 1e-3, 1e3, LOG10), ("T", 0.5, 20.0, LINEAR)],
        experiments: &[(&[], &[Some("1"), Some("0")])],
        rows: &[
            (0, "u", 1.0, 1.0, "1"),
            (0, "u", 2.0, 1.0, "1"),
            (0, "u", 5.0, 1.0, "1"),
            (0, "x", 2.0, 1.0, "1"),
        ],
        clock: Some(1),
    };
    let found = made.likelihood().at(&[-1.0, 2.0], Exactness::Answer, &NEVER).unwrap();
    for (own, known) in found.expected.iter().zip([1.0, 5.0, 5.0, (-0.4f64).exp()]) {
        near(*own, known, 1e-8);
    }
}

/// Densities of what is measured have the integral one, on each scale and by each law; and their derivatives are those of differences.
#[test]
fn densities_are_densities() {
    for scale in [ErrorScale::Linear, ErrorScale::Log, ErrorScale::Log10] {
        for law in [ErrorLaw::Normal, ErrorLaw::Laplace] {
            let (expected, size) = (2.0, 0.1);
            let density = |m: f64| law.term(scale, m, expected, size).map_or(0.0, |term| (-term.value).exp());
            // by the logarithm of what is measured
            let width = 1e-3;
            let sum: f64 = (-40_000..40_000)
                .map(|i| (f64::from(i) * width).exp())
                .map(|m| {
                    (density(m) + if scale == ErrorScale::Linear { density(-m) } else { 0.0 }) * m * width
                })
                .sum();
            near(sum, 1.0, 1e-5);
            let value = |y: f64, s: f64| law.term(scale, 1.7, y, s).unwrap().value;
            let Term { by_expected, by_size, .. } = law.term(scale, 1.7, expected, size).unwrap();
            let step = 1e-6;
            near(
                by_expected,
                (value(expected + step, size) - value(expected - step, size)) / (2.0 * step),
                1e-6,
            );
            near(by_size, (value(expected, size + step) - value(expected, size - step)) / (2.0 * step), 1e-6);
            assert!(law.term(scale, 1.7, expected, 0.0).is_none());
        }
    }
    for (law, is_on_scale) in [
        (PriorLaw::Normal, false),
        (PriorLaw::Normal, true),
        (PriorLaw::LogNormal, false),
        (PriorLaw::LogLaplace, false),
    ] {
        let prior = Prior { law, is_on_scale, centre: 0.2, spread: 0.5 };
        let [_, slope, _] = prior.term(LOG10, 0.4);
        let step = 1e-6;
        let difference = (prior.term(LOG10, 0.4 + step)[0] - prior.term(LOG10, 0.4 - step)[0]) / (2.0 * step);
        near(slope, difference, 1e-7);
    }
}

/// Two decays in two experiments with a common rate: the truth is found from anywhere, and it is the same on any number of threads.
#[test]
fn the_truth_is_found_on_any_number_of_threads() {
    let truth = |amplitude: f64, t: f64| amplitude * ((-0.8 * t).exp() + (-0.05 * t).exp());
    let mut rows: Vec<Row<'_>> = Vec::new();
    for i in 0..12 {
        let t = 2.0 * f64::from(i);
        rows.push((0, "x + y", t, truth(2.0, t), "0.01"));
        rows.push((1, "x + y", t, truth(5.0, t), "0.01"));
    }
    let made = Made {
        text: "system \"decays\"\nstate x, y\nparam k, q, a, b unknown\ndrift f\n  x' = -k*x\n  y' = -q*y\noutput x\n",
        parameters: &[
            ("k", 1e-1, 1e2, LOG10),
            ("q", 1e-4, 1e-1, LOG10),
            ("a", 1e-2, 1e2, LOG10),
            ("b", 1e-2, 1e2, LOG10),
        ],
        experiments: &[(&[], &[Some("a"), Some("a")]), (&[], &[Some("b"), Some("b")])],
        rows: &rows,
        clock: None,
    };
    let likelihood = made.likelihood();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fit(&likelihood, (6, 200, 1), None, &NEVER, &|| ()).unwrap())
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.best().found, three.best().found);
    let all = |fit: &JointFit| fit.searches.iter().map(|one| one.objective).collect::<Vec<_>>();
    assert_eq!(all(&one), all(&three));
    for (found, known) in one.best().found.iter().zip([0.8f64, 0.05, 2.0, 5.0]) {
        near(*found, known.log10(), 1e-6);
    }
    assert!(one.simulated.chi_square < 1e-8 && one.arrived(&[])[0] >= 3, "{:?}", one.arrived(&[]));
}

/// What flows in and what flows out of a vessel may be exchanged with another scale: both ends are found, neither counts as the other's arrival, and
/// all three parameters have two values.
#[test]
fn ends_that_explain_as_much_lie_apart() {
    let (k, q, s) = (1.0, 0.3, 2.0);
    let rows: Vec<(f64, f64)> = (1..13)
        .map(|i| 0.7 * f64::from(i))
        .map(|t| (t, s * k / (q - k) * ((-k * t).exp() - (-q * t).exp())))
        .collect();
    let rows: Vec<Row<'_>> = rows.iter().map(|(t, value)| (0, "s*y", *t, *value, "0.01")).collect();
    let made = Made {
        text: "system \"vessels\"\nstate x, y\nparam k, q, s unknown\ndrift f\n  x' = -k*x\n  y' = k*x - q*y\noutput y\n",
        parameters: &[("k", 1e-2, 1e1, LOG10), ("q", 1e-2, 1e1, LOG10), ("s", 1e-1, 1e2, LOG10)],
        experiments: &[(&[], &[Some("1"), Some("0")])],
        rows: &rows,
        clock: None,
    };
    let found = fit(&made.likelihood(), (12, 200, 1), None, &NEVER, &|| ()).unwrap();
    let information = Information::of(&found.simulated, &[false; 3]);
    let apart = found.apart(&information);
    assert!(!apart.is_empty());
    let values = [(k, q), (q, k), (s, s * k / q)];
    for (place, (one, other)) in values.into_iter().enumerate() {
        let mut all = found.other_values(&information, &apart, place);
        all.push(found.best().found[place]);
        all.sort_by(f64::total_cmp);
        let mut known = [f64::log10(one), f64::log10(other)];
        known.sort_by(f64::total_cmp);
        assert_eq!(all.len(), 2, "{all:?}");
        all.iter().zip(known).for_each(|(found, known)| near(*found, known, 1e-4));
    }
    let arrived = found.arrived(&apart);
    let elsewhere = found.searches.len() - arrived[0] - arrived[1];
    assert!(arrived[0] >= 1 && elsewhere >= apart.len(), "{arrived:?}");
}

/// A straight line: deviations and profiles are those of the normal equations.
#[test]
fn profiles_of_a_line_are_parabolas() {
    let times = [0.0, 1.0, 2.0, 3.0, 5.0];
    let values = [0.1, 1.2, 1.9, 3.2, 4.9];
    let rows: Vec<Row<'_>> = times.iter().zip(values).map(|(t, value)| (0, "x", *t, value, "0.2")).collect();
    let made = Made {
        text: "system \"line\"\nstate x\nparam a, b unknown\ndrift f\n  x' = b\noutput x\n",
        parameters: &[("a", -5.0, 5.0, LINEAR), ("b", -5.0, 5.0, LINEAR)],
        experiments: &[(&[], &[Some("a")])],
        rows: &rows,
        clock: None,
    };
    let likelihood = made.likelihood();
    let found = fit(&likelihood, (4, 100, 1), None, &NEVER, &|| ()).unwrap();
    let information = Information::of(&found.simulated, &[false, false]);
    let n = times.len() as f64;
    let (sum, square): (f64, f64) = (times.iter().sum(), times.iter().map(|t| t * t).sum());
    let determinant = n * square - sum * sum;
    let known = [0.2 * (square / determinant).sqrt(), 0.2 * (n / determinant).sqrt()];
    for (place, known) in known.into_iter().enumerate() {
        let own = information.deviations[place].unwrap();
        near(own, known, 1e-8);
        let best = found.best();
        let profile = profile(&likelihood, &best.found, best.objective, place, own, &NEVER);
        for point in &profile.points {
            near(point[1], 0.5 * ((point[0] - best.found[place]) / known).powi(2), 1e-6);
        }
        let [low, high] = profile.interval.map(|end| end.unwrap());
        // ends are interpolated between points
        near(high - low, 2.0 * 1.959_964 * known, 0.02);
    }
}

/// The factors of a product are not identifiable: their direction has no end, and what is determined stays so.
#[test]
fn factors_of_a_product_are_not_told() {
    let rows: Vec<Row<'_>> = (0..5).map(|i| (0, "x", f64::from(i), 1.0, "0.1")).collect();
    let made = Made {
        text: "system \"product\"\nstate x\nparam a, b, k unknown\ndrift f\n  x' = -k*x\noutput x\n",
        parameters: &[("a", 1e-2, 1e2, LOG10), ("b", 1e-2, 1e2, LOG10), ("k", 1e-2, 1e2, LOG10)],
        experiments: &[(&[], &[Some("a*b")])],
        rows: &rows,
        clock: None,
    };
    let found = made.likelihood().at(&[0.1, 0.2, -0.3], Exactness::Answer, &NEVER).unwrap();
    let information = Information::of(&found, &[false; 3]);
    assert!(information.covariance.is_none());
    assert!(
        information.deviations[0].unwrap().is_infinite() && information.deviations[1].unwrap().is_infinite()
    );
    assert!(information.deviations[2].unwrap() < 1.0);
    let worst = &information.directions[0];
    assert!(worst.deviation.is_infinite());
    let parts: Vec<usize> = worst.parts.iter().map(|part| part.0).collect();
    assert_eq!(parts.len(), 2);
    near(worst.parts[0].1 + worst.parts[1].1, 0.0, 1e-6);
    // one factor fixed at its bound makes the other identifiable
    let held = Information::of(&found, &[true, false, false]);
    assert!(held.deviations[0].is_none() && held.deviations[1].unwrap() < 1.0 && held.covariance.is_some());
}

/// What is slow is not steady when something fast is, however little it has moved until then; and what is conserved does not keep a system from a steady state.
#[test]
fn what_is_slow_is_not_at_rest() {
    let made = Made {
        text: "system \"slow\"\nstate x, y, z, w\nparam k, q unknown\ndrift f\n  x' = k*(2 - x)\n  y' = -k*y + q*z\n  z' = k*y - q*z\n  w' = 1000000*(1 - w)\noutput x\n",
        parameters: &[("k", 1e-9, 1.0, LOG10), ("q", 1e-9, 1.0, LOG10)],
        experiments: &[(&[], &[Some("1"), Some("3"), Some("1"), Some("0")])],
        rows: &[(0, "x", f64::INFINITY, 1.0, "1"), (0, "y", f64::INFINITY, 1.0, "1")],
        clock: None,
    };
    let likelihood = made.likelihood();
    for (k, q) in [(1.0f64, 0.5f64), (1e-4, 2e-4), (1e-6, 1e-5)] {
        let found = likelihood.at(&[k.log10(), q.log10()], Exactness::Answer, &NEVER).unwrap();
        near(found.expected[0], 2.0, 1e-7);
        near(found.expected[1], 4.0 * q / (k + q), 1e-7);
        let by_k = -4.0 * q / (k + q).powi(2) * k * std::f64::consts::LN_10;
        near(found.gradient[0], (found.expected[1] - 1.0) * by_k, 1e-5);
    }
}

/// A power of zero has a value, and a pole has none: neither as a rate nor as what is expected; nor has a root of what is negative. And none of them keeps the program for ever.
#[test]
fn poles_have_no_values() {
    let made = |rate: &str, output: &'static str| {
        let text = format!("system \"edges\"\nstate x\nparam k unknown\ndrift f\n  x' = {rate}\noutput x\n");
        let made = Made {
            text: &text,
            parameters: &[("k", 0.1, 10.0, LOG10)],
            experiments: &[(&[], &[Some("0")])],
            rows: &[(0, output, 0.0, 1.0, "1"), (0, output, 2.0, 1.0, "1")],
            clock: None,
        };
        made.likelihood().at(&[0.0], Exactness::Answer, &NEVER)
    };
    let found = made("1 - x^k", "x^k").unwrap();
    assert!(found.expected[0].abs() < 1e-12);
    near(found.expected[1], 1.0 - (-2.0f64).exp(), 1e-8);
    for (rate, output) in [("1", "1/x"), ("1", "log(x)")] {
        let why = made(rate, output).unwrap_err();
        assert!(matches!(why, NotFollowed::NoValue { time: 0.0, .. }), "{why:?}");
    }
    for rate in ["1/x", "sqrt(-1 - x^2)", "1 + x^2", "exp(exp(k + x))"] {
        assert!(matches!(made(rate, "x"), Err(NotFollowed::Lost { .. })), "{rate}");
    }
}
