//! A motion of the system from a state, and a second one from another state whose outputs are the same, where an unobservable direction is
//! known as a vector field.

use super::Refused;
use super::place::Place;
use palmistry_lang::{Kind, SymbolInfo, System};
use palmistry_math::expression::{Program, Symbol};
use palmistry_math::number::{Floats, rational_to_f64};
use palmistry_observe::{Response, ResponseQuestion, response};
use palmistry_rank::observability::{UnobservableField, float_inputs};
use palmistry_rank::sweep::{RankQuestion, answer_rank};
use palmistry_report::unobservable_field_text;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};

/// No motion has more samples.
const MOST_SAMPLES: usize = 5000;
/// Steps along an unobservable field, of Runge and Kutta's fourth order.
const STEPS: usize = 400;
/// An output smaller than the largest one by this factor is an error of the integration.
const NOTHING: f64 = 1e-12;

#[derive(Deserialize)]
pub(super) struct MotionAsked {
    /// Initial conditions of states, and parameters with other values than in the file.
    start: BTreeMap<String, f64>,
    /// Functions of the time `t` by the names of signals, and of input fields.
    #[serde(default)]
    inputs: BTreeMap<String, String>,
    duration: f64,
    samples: usize,
    /// How far the second start lies along which unobservable field.
    along: Option<(usize, f64)>,
}

pub(super) fn motion(place: &Place<'_>, asked: &MotionAsked) -> Result<Value, Refused> {
    let mut system = place.system()?;
    if !(asked.duration.is_finite() && asked.duration > 0.0) {
        return Err(Refused::new("a motion lasts longer than no time"));
    }
    let samples = asked.samples.clamp(2, MOST_SAMPLES);
    let times: Vec<f64> = (0..samples).map(|i| asked.duration * i as f64 / (samples - 1) as f64).collect();
    let fields = unobservable(&mut system)?;
    let (functions, inputs) = driven(&mut system, &asked.inputs);
    let from = |start: &BTreeMap<String, f64>| {
        let question =
            ResponseQuestion { start: start.clone(), functions: functions.clone(), inputs: inputs.clone() };
        response(&system, &question, &times).map_err(|why| Refused::new(why.to_string()))
    };
    let first = from(&asked.start)?;
    let mut answer = told(&first);
    answer["fields"] = fields.iter().map(|field| json!(unobservable_field_text(field))).collect();
    if let Some((place, far)) = asked.along {
        let field = fields.get(place).ok_or_else(|| Refused::new("there is no such field"))?;
        let start = moved(&system, field, &asked.start, far)?;
        let second = from(&start)?;
        answer["second"] = told(&second);
        answer["second"]["start"] = json!(start);
        answer["second"]["difference"] = json!(difference(&first, &second));
        answer["second"]["compared_until"] =
            json!(first.times[first.times.len().min(second.times.len()) - 1]);
    }
    Ok(answer)
}

fn told(found: &Response) -> Value {
    let columns = |columns: &[(String, Vec<f64>)]| -> Value {
        columns.iter().map(|(name, values)| json!({ "name": name, "values": values })).collect()
    };
    json!({
        "times": found.times,
        "states": columns(&found.states),
        "outputs": columns(&found.outputs),
        "inputs": columns(&found.inputs),
        "ended": found.ended.as_ref().map(ToString::to_string),
    })
}

/// The greatest difference of an output over its own size: a small output is not lost beside a large one. An output that is zero up to the
/// error of the integration has no size.
fn difference(first: &Response, second: &Response) -> f64 {
    let size = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let least = NOTHING * first.outputs.iter().fold(0.0, |most: f64, (_, values)| most.max(size(values)));
    let mut most = 0.0_f64;
    for ((_, one), (_, other)) in first.outputs.iter().zip(&second.outputs) {
        let far: Vec<f64> = one.iter().zip(other).map(|(one, other)| one - other).collect();
        let far = size(&far);
        if far > 0.0 {
            most = most.max(far / size(one).max(least));
        }
    }
    most
}

/// The unobservable directions that are known as vector fields.
fn unobservable(system: &mut System) -> Result<Vec<UnobservableField>, Refused> {
    // where no rank can be computed there is a motion all the same
    let question = RankQuestion { samples: 0, ..RankQuestion::default() };
    let Ok(answer) = answer_rank(system, &question) else { return Ok(Vec::new()) };
    let [branch] = answer.branches.as_slice() else { return Ok(Vec::new()) };
    Ok(branch.motions.as_ref().map_or_else(Vec::new, |found| found.fields.clone()))
}

/// Functions of time by the names of symbols; an input field that nothing drives gets a symbol of its own.
fn driven(
    system: &mut System,
    asked: &BTreeMap<String, String>,
) -> (BTreeMap<String, String>, Vec<(String, String)>) {
    let (mut functions, mut inputs) = (BTreeMap::new(), Vec::new());
    let fields: Vec<String> = system.roles().into_iter().map(|one| one.name).collect();
    for (name, text) in asked.iter().filter(|(_, text)| !text.trim().is_empty()) {
        if !fields.contains(name) {
            functions.insert(name.clone(), text.clone());
            continue;
        }
        let own = format!("(input of {name})");
        let symbol = system.graph.intern(&own);
        let info = SymbolInfo { kind: Kind::Parameter, is_angle: false, default: None, range: None };
        system.symbols.insert(symbol, info);
        functions.insert(own.clone(), text.clone());
        inputs.push((name.clone(), own));
    }
    (functions, inputs)
}

/// The state and the parameters so far along a field.
fn moved(
    system: &System,
    field: &UnobservableField,
    start: &BTreeMap<String, f64>,
    far: f64,
) -> Result<BTreeMap<String, f64>, Refused> {
    let mut values: HashMap<Symbol, f64> = HashMap::new();
    for (symbol, info) in system.symbols() {
        let given = start.get(system.symbol_name(symbol)).copied();
        let value = given.or_else(|| info.default.as_ref().map(rational_to_f64));
        values.extend(value.map(|value| (symbol, value)));
    }
    let rates: Vec<_> = field.components.iter().map(|part| part.rate).collect();
    let program = Program::plain(&system.graph, &rates);
    let loaded = program.load(Floats).map_err(|why| Refused::new(why.to_string()))?;
    let symbols: Vec<Symbol> = field.components.iter().map(|part| part.state).collect();
    let rate = |at: &[f64]| {
        let value = |symbol: Symbol| match symbols.iter().position(|moved| *moved == symbol) {
            Some(place) => at[place],
            None => values.get(&symbol).copied().unwrap_or(f64::NAN),
        };
        let found = loaded.run(&float_inputs(&program, value), &mut Vec::new());
        found.map_err(|_| Refused::new("the unobservable direction has no value there"))
    };
    let value = |part: &palmistry_rank::observability::FieldComponent| {
        let value = values.get(&part.state).copied();
        value.ok_or_else(|| Refused::new(format!("nothing gives the value of {}", part.name)))
    };
    let mut at: Vec<f64> = field.components.iter().map(value).collect::<Result<_, _>>()?;
    let step = far / STEPS as f64;
    let along = |at: &[f64], rate: &[f64], step: f64| -> Vec<f64> {
        at.iter().zip(rate).map(|(at, rate)| at + step * rate).collect()
    };
    for _ in 0..STEPS {
        let first = rate(&at)?;
        let second = rate(&along(&at, &first, step / 2.0))?;
        let third = rate(&along(&at, &second, step / 2.0))?;
        let fourth = rate(&along(&at, &third, step))?;
        for (place, value) in at.iter_mut().enumerate() {
            *value += step / 6.0 * (first[place] + 2.0 * second[place] + 2.0 * third[place] + fourth[place]);
        }
    }
    if !at.iter().all(|value| value.is_finite()) {
        return Err(Refused::new("so far along the unobservable direction there is no state"));
    }
    let mut found = start.clone();
    found.extend(field.components.iter().map(|part| part.name.clone()).zip(at));
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(outputs: &[&[f64]]) -> Response {
        let outputs = outputs.iter().map(|values| ("y".to_owned(), values.to_vec())).collect();
        let (times, states, inputs) = (vec![0.0, 1.0], Vec::new(), Vec::new());
        Response { times, states, outputs, inputs, constants: BTreeMap::new(), ended: None }
    }

    /// By hand: a small output that differs beside a large one that does not; outputs that are zero; a motion that ends early.
    #[test]
    fn each_output_is_compared_by_its_own_size() {
        let large: &[f64] = &[1e6, -1e6];
        assert_eq!(difference(&of(&[large, &[1e-3, 0.0]]), &of(&[large, &[2e-3, 0.0]])), 1.0);
        assert_eq!(difference(&of(&[&[0.0, 0.0]]), &of(&[&[0.0, 0.0]])), 0.0);
        assert!(difference(&of(&[&[1.0, 2.0], &[0.0, 0.0]]), &of(&[&[1.0, 2.0], &[1e-15, 0.0]])) < 1e-2);
        assert_eq!(difference(&of(&[&[0.0, 0.0]]), &of(&[&[0.0, 1.0]])), f64::INFINITY);
        assert_eq!(difference(&of(&[&[1.0, 5.0]]), &of(&[&[1.0]])), 0.0);
    }
}
