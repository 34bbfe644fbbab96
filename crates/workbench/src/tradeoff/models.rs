//! What the smallest state that a scene needs saves against the full model.

use palmistry_lang::{Assignment, Role, System};
use palmistry_math::expression::{NodeId, Program, expand_angles};
use palmistry_math::number::Floats;
use palmistry_rank::observability::{
    Branch, Codistribution, Length, LieDerivative, Locus, Reduction, State, parse_condition, singular_values,
    solve_conditions,
};
use std::collections::BTreeMap;
use std::time::Instant;

/// Two models of the same states, timed on the same work: the rows of a codistribution and their singular values.
#[derive(Clone, Copy, Debug)]
pub struct ModelComparison {
    pub small_states: usize,
    pub large_states: usize,
    /// Operations of the two programs.
    pub small_operations: usize,
    pub large_operations: usize,
    /// Seconds a state, the median over rounds in which the two take turns.
    pub small_seconds: f64,
    pub large_seconds: f64,
    /// The largest relative difference between entries that both models have.
    pub largest_difference: f64,
}

const ROUNDS: usize = 9;
/// States at which a reduction is timed.
const STATES_TO_TIME: u64 = 400;

/// A model and the rows of it that are compared.
struct ModelRows<'m> {
    system: &'m mut System,
    rows: &'m [NodeId],
}

/// The same, made ready, with its inputs at some states.
struct Prepared<'p> {
    program: &'p Program,
    inputs: &'p [Vec<f64>],
    system: &'p System,
}

/// Compares rows of one system with rows of another at states drawn from a locus of the large one; the small one is given
/// the values of the symbols that it shares.
///
/// # Errors
/// In words, where a state cannot be drawn or evaluated.
fn compare_models(
    small: ModelRows<'_>,
    large: ModelRows<'_>,
    locus: &Locus,
    states: u64,
    seed: u64,
) -> Result<ModelComparison, String> {
    let (small_program, small_reduced) = compiled(small.system, small.rows);
    let (large_program, large_reduced) = compiled(large.system, large.rows);
    let drawn: Vec<State> = (0..states)
        .map(|index| locus.draw(seed, index))
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())?;
    let renamed: Vec<State> = drawn.iter().map(|state| rename(state, large.system, small.system)).collect();
    let inputs = |program: &Program, states: &[State]| -> Result<Vec<Vec<f64>>, String> {
        states
            .iter()
            .map(|state| state.inputs(program, &Floats).map_err(|_| "a symbol without a value".to_owned()))
            .collect()
    };
    let small_inputs = inputs(&small_program, &renamed)?;
    let large_inputs = inputs(&large_program, &drawn)?;
    let largest_difference = difference(
        &Prepared { program: &small_program, inputs: &small_inputs, system: small.system },
        &Prepared { program: &large_program, inputs: &large_inputs, system: large.system },
    )?;
    let (mut small_times, mut large_times) = (Vec::new(), Vec::new());
    let small_work = (&small_reduced, inputs(&small_reduced.program, &renamed)?);
    let large_work = (&large_reduced, inputs(&large_reduced.program, &drawn)?);
    for _ in 0..ROUNDS {
        small_times.push(time(small_work.0, &small_work.1)?);
        large_times.push(time(large_work.0, &large_work.1)?);
    }
    Ok(ModelComparison {
        small_states: small.system.unknown_count(),
        large_states: large.system.unknown_count(),
        small_operations: small_reduced.program.len(),
        large_operations: large_reduced.program.len(),
        small_seconds: median(&mut small_times),
        large_seconds: median(&mut large_times),
        largest_difference,
    })
}

/// The rows that a smaller system needs, once with its own states and once with those of a larger one that it is under
/// conditions.
///
/// # Errors
/// In words: conditions that cannot be solved, outputs or fields that the larger system has not, states that cannot be drawn.
pub fn compare_reduction(
    small: &System,
    large: &System,
    conditions: &[String],
    seed: u64,
) -> Result<ModelComparison, String> {
    let (mut small, mut large) = (small.clone(), large.clone());
    let equations =
        conditions.iter().map(|text| parse_condition(text)).collect::<Result<Vec<_>, _>>()?.concat();
    let branches = solve_conditions(&mut large, &equations).map_err(|e| e.to_string())?;
    let branch: Branch = branches.into_iter().next().ok_or("no state meets the conditions")?;
    let (own, rows) = counterparts(&mut small, &mut large)?;
    let locus = Locus::new(&mut large, &branch, &BTreeMap::new(), &rows).map_err(|e| e.to_string())?;
    compare_models(
        ModelRows { system: &mut small, rows: &own },
        ModelRows { system: &mut large, rows: &rows },
        &locus,
        STATES_TO_TIME,
        seed,
    )
}

/// The rows that the smaller system's codistribution needs, and in the larger one the differentials of all outputs and of the
/// same Lie derivatives.
fn counterparts(small: &mut System, large: &mut System) -> Result<(Vec<NodeId>, Vec<NodeId>), String> {
    let words = Codistribution::new(small, &Assignment::new(), Length::UntilItStops)?;
    let mut rows: Vec<NodeId> = Vec::new();
    for output in large.outputs.clone() {
        rows.extend(large.differential(output.1));
    }
    let longer = |word: &&LieDerivative| !word.fields.is_empty();
    for word in words.needed.iter().map(|index| &words.lie_derivatives[*index]).filter(longer) {
        let output = &small.outputs[word.output].0;
        let place = large.outputs.iter().position(|(name, _)| name == output);
        let mut value = large.outputs[place.ok_or_else(|| format!("no output {output}"))?].1;
        for field in word.fields.iter().rev() {
            let name = &small.fields[*field].name;
            let place =
                large.fields.iter().position(|field| field.name == *name && field.role != Role::Other);
            value = large.lie_derivative(place.ok_or_else(|| format!("no field {name}"))?, value);
        }
        rows.extend(large.differential(value));
    }
    Ok((words.needed_entries(), rows))
}

/// What remains of some rows without unit rows.
struct Reduced {
    program: Program,
    columns: usize,
}

/// The program of all rows, and of what remains of them.
fn compiled(system: &mut System, rows: &[NodeId]) -> (Program, Reduced) {
    let is_angle = &system.angle_test();
    let rows = expand_angles(&mut system.graph, rows, is_angle);
    let rest = Reduction::new(&system.graph, &rows, system.unknown_count());
    let reduced = Reduced {
        program: Program::new(&system.graph, &rest.entries, is_angle),
        columns: rest.columns.len(),
    };
    (Program::new(&system.graph, &rows, is_angle), reduced)
}

/// The values of one system's symbols under another's symbols of the same names.
fn rename(state: &State, from: &System, to: &System) -> State {
    let values = state
        .values
        .iter()
        .filter_map(|(symbol, value)| Some((to.find_symbol(from.symbol_name(*symbol))?, value.clone())));
    State { values: values.collect() }
}

fn time(rows: &Reduced, inputs: &[Vec<f64>]) -> Result<f64, String> {
    let loaded = rows.program.load(Floats).map_err(|refusal| refusal.to_string())?;
    let mut registers = Vec::new();
    let begin = Instant::now();
    for input in inputs {
        let values = loaded.run(input, &mut registers).map_err(|failure| failure.refusal.to_string())?;
        std::hint::black_box(singular_values(&values, &vec![0.0; values.len()], rows.columns));
    }
    Ok(begin.elapsed().as_secs_f64() / inputs.len() as f64)
}

/// The largest relative difference between the entries of rows that have the same place counted from the end (the
/// large model has more outputs in front), in columns of the same name.
fn difference(small: &Prepared<'_>, large: &Prepared<'_>) -> Result<f64, String> {
    let run = |program: &Program, input: &Vec<f64>| {
        let loaded = program.load(Floats).map_err(|refusal| refusal.to_string())?;
        loaded.run(input, &mut Vec::new()).map_err(|failure| failure.refusal.to_string())
    };
    let columns: Vec<(usize, usize)> = small
        .system
        .states
        .iter()
        .enumerate()
        .filter_map(|(i, symbol)| {
            let name = small.system.symbol_name(*symbol);
            Some((
                i,
                large.system.unknowns().iter().position(|other| large.system.symbol_name(*other) == name)?,
            ))
        })
        .collect();
    let (ns, nl) = (small.system.unknown_count(), large.system.unknown_count());
    let mut worst = 0.0f64;
    for (small_input, large_input) in small.inputs.iter().zip(large.inputs) {
        let (a, b) = (run(small.program, small_input)?, run(large.program, large_input)?);
        // the smaller one needs not all of its outputs, the larger one has them all in front
        let lie_rows = b.len() / nl - large.system.outputs.len();
        for (x, y) in a.chunks(ns).rev().zip(b.chunks(nl).rev()).take(lie_rows) {
            let scale = x.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (i, j) in &columns {
                worst = worst.max((x[*i] - y[*j]).abs() / scale);
            }
        }
    }
    Ok(worst)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: &str = "drift f x' = v v' = -x";
    const BOX: &str = "sample x in [1, 2] v in [1, 2]";

    fn compared(small: &str, large: &str, conditions: &[&str]) -> Result<ModelComparison, String> {
        let read = |text: &str| -> System { text.parse().unwrap() };
        let conditions: Vec<String> = conditions.iter().map(|text| (*text).to_owned()).collect();
        compare_reduction(&read(small), &read(large), &conditions, 1)
    }

    /// Of three outputs that are multiples of one the codistribution needs one: fewer rows than there are outputs.
    #[test]
    fn outputs_that_say_the_same_are_no_rows() {
        for outputs in ["x, 2*x, 3*x", "3", "x, v, x + v"] {
            let small = format!("system \"a\" state x, v {FIELD} output {outputs} {BOX}");
            let large =
                format!("system \"b\" state x, v, w {FIELD} w' = w output {outputs} {BOX} w in [1, 2]");
            let found = compared(&small, &large, &["w = 1"]).unwrap();
            assert!(found.largest_difference < 1e-12, "{outputs}: {}", found.largest_difference);
        }
        // the rates differ, and so do the rows of the Lie derivatives
        let large = format!("system \"b\" state x, v drift f x' = 2*v v' = -x output x, 2*x, 3*x {BOX}");
        let small = format!("system \"a\" state x, v {FIELD} output x, 2*x, 3*x {BOX}");
        let found = compared(&small, &large, &[]).unwrap();
        assert!((found.largest_difference - 1.0).abs() < 1e-12, "{}", found.largest_difference);
    }

    #[test]
    fn what_cannot_be_compared_is_an_error() {
        let whole = format!("system \"a\" state x, v {FIELD} output x {BOX}");
        for (small, large) in [
            ("system \"a\" param k = 1 output k", whole.as_str()),
            (whole.as_str(), "system \"a\" param k = 1 output k"),
            ("system \"a\" param k = 1 output k", "system \"a\" param k = 1 output k"),
            // only the larger one has values nowhere
            (
                &whole,
                "system \"b\" state x, v drift f x' = v/(x - x) v' = -x output x sample x in [1, 2] v in [1, 2]",
            ),
        ] {
            let found = compared(small, large, &[]);
            assert!(found.is_err(), "{small} {large}: {:?}", found.map(|found| found.largest_difference));
        }
    }
}
