//! Three ways of automatic differentiation to the Lie derivatives that a rank is made of, along the drift and every input: derivatives of the shared expression graph,
//! Taylor series along the flow, and num-dual's nested duals. They share the values of fields and outputs and no rule of differentiation.

use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{NodeId, Program, Symbol};
use palmistry_math::number::Floats;
use palmistry_rank::observability::{
    Branch, Codistribution, Length, LieDerivative, Locus, float_inputs, lie_derivative_by_duals,
    lie_derivative_by_series,
};
use std::collections::{BTreeMap, HashMap};

/// How far three ways to the same Lie derivatives agree.
#[derive(Clone, Debug)]
pub struct WaysAgreement {
    /// The fields along which outputs are differentiated, in the order of the file.
    pub fields: Vec<String>,
    /// How many Lie derivatives of outputs the codistribution takes.
    pub derivatives: usize,
    /// How many of them are too long to be compared.
    pub too_long: usize,
    /// The highest order of these Lie derivatives.
    pub order: usize,
    /// The number of states of the sample box at which each is compared.
    pub states: usize,
    /// The largest difference of duals and of series from the graph, relative to the largest intermediate number of the graph's
    /// derivative at these states: a measure of rounding that holds also where the derivative itself vanishes.
    pub largest: [f64; 2],
}

/// Differences above this are none of rounding.
const ROUNDING: f64 = 1e-9;

/// States of the sample box.
const STATES: u64 = 8;

/// Longer expressions are not compared, nor more derivatives than [`MOST`].
const LONGEST: usize = 20_000;
const MOST: usize = 200;

impl WaysAgreement {
    /// Whether the ways agree but for rounding.
    pub fn agree(&self) -> bool {
        self.largest.iter().all(|difference| *difference < ROUNDING)
    }
}

/// The larger one of two differences; one that is no number stays.
fn worst(one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() { f64::NAN } else { one.max(other) }
}

/// Compares the ways for all Lie derivatives that a system's codistribution takes; nothing where it takes none that change, or none that is short enough.
///
/// # Errors
/// In words, where the system has no Lie derivatives, or a state cannot be drawn or evaluated.
pub fn compare_ways(system: &System, seed: u64) -> Result<Option<WaysAgreement>, String> {
    let mut system = system.clone();
    let words = Codistribution::new(&mut system, &Assignment::new(), Length::UntilItStops)
        .map_err(|why| why.to_string())?;
    let taken: Vec<LieDerivative> =
        words.lie_derivatives.iter().filter(|word| !word.fields.is_empty()).cloned().collect();
    let (mut kept, mut programs, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for word in taken.iter().take(MOST) {
        let output = system.outputs[word.output].1;
        let by_graph =
            word.fields.iter().rev().fold(output, |value, field| system.lie_derivative(*field, value));
        let by_series = lie_derivative_by_series(&mut system, &word.fields, output)
            .map_err(|failure| failure.refusal.to_string())?;
        let both: [NodeId; 2] = [by_graph, by_series];
        let program = Program::plain(&system.graph, &both);
        if program.len() <= LONGEST {
            kept.push(word);
            programs.push(program);
            values.extend(both);
        }
    }
    if kept.is_empty() {
        return Ok(None);
    }
    let locus = Locus::new(&mut system, &Branch::default(), &BTreeMap::new(), &values)
        .map_err(|why| why.to_string())?;
    let mut points = Vec::new();
    for index in 0..STATES {
        let state = locus.draw(seed, index).map_err(|why| why.to_string())?;
        let mut point: HashMap<Symbol, f64> = system
            .symbols()
            .filter_map(|(symbol, info)| Some((symbol, info.default.as_ref()?.to_f64().value())))
            .collect();
        point.extend(state.values.iter().map(|(symbol, value)| (*symbol, value.to_f64())));
        points.push(point);
    }
    let mut largest = [0.0f64; 2];
    for (word, program) in kept.iter().zip(&programs) {
        let loaded = program.load(Floats).map_err(|why| why.to_string())?;
        let (mut size, mut differences) = (0.0f64, [0.0f64; 2]);
        for point in &points {
            let inputs = float_inputs(program, |symbol| point.get(&symbol).copied().unwrap_or(f64::NAN));
            let mut registers = Vec::new();
            let found = loaded.run(&inputs, &mut registers).map_err(|failure| failure.refusal.to_string())?;
            let by_duals =
                lie_derivative_by_duals(&system, &word.fields, system.outputs[word.output].1, point)
                    .map_err(|_| "the dual numbers have no value at a drawn state".to_owned())?;
            size = registers.iter().filter(|value| value.is_finite()).fold(size, |a, b| a.max(b.abs()));
            for (largest, other) in differences.iter_mut().zip([by_duals, found[1]]) {
                *largest = worst(*largest, (other - found[0]).abs());
            }
        }
        for (largest, difference) in largest.iter_mut().zip(differences) {
            *largest = worst(*largest, if difference == 0.0 { 0.0 } else { difference / size });
        }
    }
    let fields = system.moving_fields().into_iter().map(|field| system.fields[field].name.clone());
    Ok(Some(WaysAgreement {
        fields: fields.collect(),
        derivatives: kept.len(),
        too_long: taken.len() - kept.len(),
        order: kept.iter().map(|word| word.fields.len()).max().unwrap_or(0),
        states: points.len(),
        largest,
    }))
}

#[cfg(test)]
mod tests {
    use super::worst;

    #[test]
    fn what_is_no_number_stays_the_worst() {
        assert_eq!([0.0, 2.0, 1.0].into_iter().fold(0.0, worst), 2.0);
        assert!([f64::NAN, 2.0, 1.0].into_iter().fold(0.0, worst).is_nan());
    }
}
