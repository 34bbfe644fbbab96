//! A system without its unobservable directions, written as a proof file: its states are the observable states and observable
//! functions of the others, its claims that these move as the file says and that the outputs are the same.

use super::answer::UnobservableDirections;
use super::express::{Ingredient, as_polynomial};
use super::proof::{Motion, vanish};
use super::section::sections;
use palmistry_lang::{Assignment, Kind, SymbolInfo, System, Time};
use palmistry_math::expression::{Derivation, NodeId, Program, Symbol, expand};
use palmistry_math::number::{Floats, Function, rational_to_f64};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

/// Why a system is not written without its unobservable directions.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotReparametrised {
    /// Fields or functions are missing.
    #[error("not found in symbols: {}", missing_text(*fields, *functions))]
    Incomplete {
        /// Directions without a field.
        fields: usize,
        /// Functions that are missing.
        functions: usize,
    },
    /// The coordinates could not be solved for.
    #[error(
        "the states could not be expressed by observable functions, with as many of them fixed at 0 or 1 as are unobservable"
    )]
    NoSection,
    /// Known signals would have to be declared in the new file as in the old one.
    #[error("a system with known signals is not written anew")]
    KnownSignals,
    /// Steps are compositions, and no derivatives along a field.
    #[error("a system in discrete time is not written anew")]
    DiscreteTime,
    /// A rate would be too long to read.
    #[error("the rates are too long to be written")]
    TooLong,
}

/// Sections of each block that are tried.
const SECTIONS: usize = 6;
/// States at which the ranges of new coordinates are looked at.
const STATES: usize = 200;

/// A coordinate of the new system.
struct Coordinate {
    symbol: Symbol,
    name: String,
    /// The function of the old states that it is, and its text.
    value: NodeId,
    text: String,
    is_new: bool,
    is_angle: bool,
}

/// The text of a proof file that imports the original as `import` and reduces it to what is observable. `found` was found of this
/// very system.
///
/// # Errors
/// Where something is missing for that.
pub fn reparametrise(
    system: &System,
    found: &UnobservableDirections,
    import: &str,
) -> Result<String, NotReparametrised> {
    if found.fields_missing + found.functions_missing > 0 {
        let (fields, functions) = (found.fields_missing, found.functions_missing);
        return Err(NotReparametrised::Incomplete { fields, functions });
    }
    if system.time == Time::Discrete {
        return Err(NotReparametrised::DiscreteTime);
    }
    if !system.known.is_empty() {
        return Err(NotReparametrised::KnownSignals);
    }
    let mut system = system.clone();
    let coordinates = coordinates(&mut system, found);
    let names: Vec<Symbol> =
        coordinates.iter().filter(|c| c.is_new).map(|coordinate| coordinate.symbol).collect();
    let motion = super::motion(&mut system, &found.values);
    let mut choices: Vec<Vec<Assignment>> = Vec::new();
    for block in &found.blocks {
        let functions = &found.functions[block.functions.clone()];
        let found = sections(&mut system, block, functions, &names[block.functions.clone()], SECTIONS);
        choices.push(found);
    }
    // of each block the shortest; where that does not do, the next of all
    for place in 0..SECTIONS {
        let chosen: Option<Vec<&Assignment>> =
            choices.iter().map(|choice| choice.get(place).or(choice.last())).collect();
        let Some(chosen) = chosen else { break };
        let values: Assignment =
            chosen.into_iter().flatten().map(|(symbol, node)| (*symbol, *node)).collect();
        let mut on_section =
            |system: &mut System, value: NodeId| Some(system.graph.substitute(&[value], &values)[0]);
        match Reduced::new(&mut system, &motion, &coordinates, &mut on_section) {
            Err(NotReparametrised::NoSection) => {}
            found_there => {
                return found_there.map(|reduced| text(&system, found, &coordinates, &reduced, import));
            }
        }
    }
    let ingredients = ingredients(&mut system, &motion, &coordinates);
    let mut rng = ChaCha8Rng::seed_from_u64(0x0065_7870_7265); // any fixed seed: what is found is proved
    let mut polynomial =
        |system: &mut System, value: NodeId| as_polynomial(system, value, &ingredients, &mut rng);
    let reduced = Reduced::new(&mut system, &motion, &coordinates, &mut polynomial)?;
    Ok(text(&system, found, &coordinates, &reduced, import))
}

/// What rates and outputs may be made of: the new coordinates and the parameters, of angles their sines and cosines.
fn ingredients(system: &mut System, motion: &Motion, coordinates: &[Coordinate]) -> Vec<Ingredient> {
    let nodes = motion.fields.iter().flatten().chain(&motion.outputs).copied();
    let others = system.graph.symbols_of(nodes);
    let mut pairs: Vec<(NodeId, NodeId, bool)> = coordinates
        .iter()
        .map(|coordinate| (coordinate.value, system.graph.symbol(coordinate.symbol), coordinate.is_angle))
        .collect();
    for symbol in others.into_iter().filter(|symbol| !motion.states.contains(symbol)) {
        let node = system.graph.symbol(symbol);
        pairs.push((node, node, system.is_angle(symbol)));
    }
    let mut found = Vec::new();
    for (old, new, is_angle) in pairs {
        let functions = if is_angle { &[Some(Function::Sin), Some(Function::Cos)][..] } else { &[None] };
        for function in functions {
            let mut of = |node: NodeId| function.map_or(node, |function| system.graph.apply(function, node));
            let (old, new) = (of(old), of(new));
            found.push(Ingredient { old, new, is_sine: *function == Some(Function::Sin) });
        }
    }
    found
}

/// The observable states, and a new symbol for each function.
fn coordinates(system: &mut System, found: &UnobservableDirections) -> Vec<Coordinate> {
    let mut all = Vec::new();
    for symbol in &found.observable {
        let name = system.symbol_name(*symbol).to_owned();
        let (value, is_angle) = (system.graph.symbol(*symbol), system.is_angle(*symbol));
        let (text, symbol) = (name.clone(), *symbol);
        all.push(Coordinate { symbol, name, value, text, is_new: false, is_angle });
    }
    let mut number = 0;
    for function in &found.functions {
        let name = loop {
            number += 1;
            let name = format!("z{number}");
            if system.graph.find_symbol(&name).is_none() && system.definition(&name).is_none() {
                break name;
            }
        };
        // a sum of angles is one
        let linear = function.factors.len() == 1
            && system.graph.symbols_of([function.value]).into_iter().all(|symbol| {
                let slope = system.partial(function.value, symbol);
                system.is_angle(symbol)
                    && system.graph.constant_value(slope).is_some_and(|slope| slope.denominator().is_one())
            });
        let symbol = system.graph.intern(&name);
        let info = SymbolInfo { kind: Kind::State, is_angle: linear, default: None, range: None };
        system.symbols.insert(symbol, info);
        let (value, text) = (function.value, function.text.clone());
        all.push(Coordinate { symbol, name, value, text, is_new: true, is_angle: linear });
    }
    all
}

/// Rates and outputs in the new coordinates.
struct Reduced {
    /// For each field the rates, in the order of the coordinates.
    rates: Vec<Vec<NodeId>>,
    rate_texts: Vec<Vec<String>>,
    outputs: Vec<NodeId>,
    output_texts: Vec<String>,
}

impl Reduced {
    /// The rates and outputs as they are expressed in the new coordinates, proved to be the same everywhere.
    fn new(
        system: &mut System,
        motion: &Motion,
        coordinates: &[Coordinate],
        express: &mut dyn FnMut(&mut System, NodeId) -> Option<NodeId>,
    ) -> Result<Reduced, NotReparametrised> {
        let back: HashMap<Symbol, NodeId> =
            coordinates.iter().map(|coordinate| (coordinate.symbol, coordinate.value)).collect();
        let mut differences = Vec::new();
        let mut expressed = |system: &mut System, value: NodeId| {
            let there = express(system, value).ok_or(NotReparametrised::NoSection)?;
            let again = system.graph.substitute(&[there], &back)[0];
            differences.push(system.graph.sub(value, again));
            Ok(there)
        };
        let mut rates = Vec::new();
        for field in &motion.fields {
            let slopes = motion.states.iter().copied().zip(field.iter().copied()).collect();
            let mut along = Derivation::new(slopes);
            let mut of_field = Vec::new();
            for coordinate in coordinates {
                let rate = along.apply(&mut system.graph, coordinate.value);
                of_field.push(expressed(system, rate)?);
            }
            rates.push(of_field);
        }
        let outputs: Vec<NodeId> =
            motion.outputs.iter().map(|output| expressed(system, *output)).collect::<Result<_, _>>()?;
        let mut rng = ChaCha8Rng::seed_from_u64(0x0073_6563_7469); // any fixed seed: it is a proof
        vanish(system, &differences, &motion.guards, &mut rng).ok_or(NotReparametrised::NoSection)?;
        let texts = |system: &mut System, nodes: &[NodeId]| {
            nodes.iter().map(|node| short_text(system, *node)).collect::<Option<Vec<_>>>()
        };
        let output_texts = texts(system, &outputs).ok_or(NotReparametrised::TooLong)?;
        let rate_texts = rates.iter().map(|rates| texts(system, rates)).collect::<Option<Vec<_>>>();
        let rate_texts = rate_texts.ok_or(NotReparametrised::TooLong)?;
        Ok(Reduced { rates, rate_texts, outputs, output_texts })
    }
}

/// The shorter text of an expression as it came about, and multiplied out.
fn short_text(system: &mut System, node: NodeId) -> Option<String> {
    let as_it_is = Some(system.graph.text(node)).filter(|text| !text.starts_with("(an expression"));
    let is_angle = system.angle_test();
    let expanded = expand(&mut system.graph, node, is_angle).ok().map(|expansion| {
        let graph = &system.graph;
        let whole = |polynomial| expansion.text(graph, polynomial, usize::MAX);
        let top = whole(&expansion.numerator);
        let bottom: Vec<String> = expansion
            .denominator
            .iter()
            .map(|(factor, power)| {
                let text = whole(factor);
                let text = if text.contains(['*', ' ', '^', '-']) { format!("({text})") } else { text };
                if *power == 1 { text } else { format!("{text}^{power}") }
            })
            .collect();
        let (front, below) = (expansion.front.numerator().to_string(), expansion.front.denominator());
        let is_sum = top.contains(" + ") || top.contains(" - ");
        let top = match front.as_str() {
            "1" if bottom.is_empty() && below.is_one() => top,
            "1" if is_sum => format!("({top})"),
            "1" => top,
            "-1" if is_sum => format!("-({top})"),
            "-1" => format!("-{top}"),
            _ if top == "1" => front,
            _ if is_sum => format!("{front}*({top})"),
            _ => format!("{front}*{top}"),
        };
        let below = (!below.is_one()).then(|| below.to_string());
        let bottom: Vec<String> = below.into_iter().chain(bottom).collect();
        match bottom.len() {
            0 => top,
            1 => format!("{top}/{}", bottom[0]),
            _ => format!("{top}/({})", bottom.join("*")),
        }
    });
    match (as_it_is, expanded) {
        (Some(one), Some(other)) => Some(if other.len() <= one.len() { other } else { one }),
        (one, other) => one.or(other),
    }
}

fn text(
    system: &System,
    found: &UnobservableDirections,
    coordinates: &[Coordinate],
    reduced: &Reduced,
    import: &str,
) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "system \"{}: its observable part\"\n", system.title);
    let _ = writeln!(out, "use original = \"{import}\"\n");
    let list = |wanted: &dyn Fn(&Coordinate) -> bool| -> Vec<&str> {
        coordinates.iter().filter(|c| wanted(c)).map(|c| c.name.as_str()).collect()
    };
    for coordinate in coordinates.iter().filter(|coordinate| coordinate.is_new) {
        let _ = writeln!(out, "# {} = {}", coordinate.name, coordinate.text);
    }
    let _ = writeln!(out, "state {}", list(&|_| true).join(", "));
    let nodes = reduced.rates.iter().flatten().chain(&reduced.outputs).copied();
    let mentioned = system.graph.symbols_of(nodes);
    let parameters: BTreeSet<Symbol> = mentioned
        .into_iter()
        .filter(|symbol| coordinates.iter().all(|coordinate| coordinate.symbol != *symbol))
        .collect();
    for parameter in &parameters {
        let default = system.symbol_info(*parameter).and_then(|info| info.default.clone());
        let value = default.map(|value| format!(" = {value}")).unwrap_or_default();
        let _ = writeln!(out, "param {}{value}", system.symbol_name(*parameter));
    }
    let angles: Vec<&str> = list(&|coordinate| coordinate.is_angle);
    if !angles.is_empty() {
        let _ = writeln!(out, "angle {}", angles.join(", "));
    }
    for (field, rates) in system.moving_fields().into_iter().zip(&reduced.rate_texts) {
        let field = &system.fields[field];
        let _ = writeln!(out, "\n{} {}", field.role.name(), field.name);
        for (coordinate, rate) in coordinates.iter().zip(rates).filter(|(_, rate)| *rate != "0") {
            let _ = writeln!(out, "  {}' = {rate}", coordinate.name);
        }
        if rates.iter().any(|rate| rate == "0") {
            let _ = writeln!(out, "  others' = 0");
        }
    }
    let _ = writeln!(out, "\noutput {}", reduced.output_texts.join(", "));
    let ranges = ranges(system, coordinates, &parameters);
    if !ranges.is_empty() {
        let _ = writeln!(out, "\nsample\n  {}", ranges.join("\n  "));
    }
    let mut conditions: Vec<String> = coordinates
        .iter()
        .filter(|coordinate| coordinate.is_new)
        .map(|coordinate| format!("{} = {}", coordinate.name, coordinate.text))
        .collect();
    let mut held: Vec<(&str, String)> = found
        .values
        .iter()
        .map(|(symbol, value)| (system.symbol_name(*symbol), system.graph.text(*value)))
        .collect();
    held.sort_unstable();
    conditions.extend(held.iter().map(|(name, value)| format!("{name} = {value}")));
    let place = match conditions.is_empty() {
        true => String::new(), // what is unobservable is left out, and nothing else
        false => format!(" where {}", conditions.join(", ")),
    };
    let _ = writeln!(out, "\n# the original moves them so, and its outputs are the same");
    for field in system.moving_fields() {
        let name = &system.fields[field].name;
        for coordinate in coordinates {
            let (new, old) = (&coordinate.name, &coordinate.text);
            let _ = writeln!(out, "claim {name}.{new}: L(original.{name}, {old}) = L({name}, {new}){place}");
        }
    }
    let outputs = reduced.output_texts.join("; ");
    let _ = writeln!(out, "claim output: original.output = [{outputs}]{place}");
    let _ = writeln!(out, "claim observable: rank = {}", coordinates.len());
    out
}

/// How many fields and functions are missing, in words.
fn missing_text(fields: usize, functions: usize) -> String {
    let of = |count: usize, one: &str| {
        (count > 0).then(|| format!("{count} {one}{}", if count == 1 { "" } else { "s" }))
    };
    let parts = [of(fields, "unobservable direction"), of(functions, "observable function")];
    parts
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" and ")
        .replace("functions that is", "functions that are")
}

/// Where the new coordinates are, at states of the sample box.
fn ranges(system: &System, coordinates: &[Coordinate], parameters: &BTreeSet<Symbol>) -> Vec<String> {
    let range = |symbol: Symbol| system.symbol_info(symbol).and_then(|info| info.range.clone());
    let mut found = Vec::new();
    let kept = coordinates.iter().filter(|c| !c.is_new).map(|c| c.symbol).chain(parameters.iter().copied());
    for symbol in kept {
        if let Some(range) = range(symbol) {
            found.push(format!("{} in [{}, {}]", system.symbol_name(symbol), range.low, range.high));
        }
    }
    let new: Vec<&Coordinate> = coordinates.iter().filter(|coordinate| coordinate.is_new).collect();
    let values: Vec<NodeId> = new.iter().map(|coordinate| coordinate.value).collect();
    let program = Program::plain(&system.graph, &values);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut bounds = vec![(f64::INFINITY, f64::NEG_INFINITY); new.len()];
    for _ in 0..STATES {
        let draw = |input: &palmistry_math::expression::Input| {
            let symbol = input.symbol()?;
            let info = system.symbol_info(symbol)?;
            let (low, high) = match (&info.range, &info.default) {
                (Some(range), _) => (rational_to_f64(&range.low), rational_to_f64(&range.high)),
                (None, Some(value)) => (rational_to_f64(value), rational_to_f64(value)),
                (None, None) => return None,
            };
            Some(low + (high - low) * rng.random::<f64>())
        };
        let Some(inputs) = program.inputs().iter().map(draw).collect::<Option<Vec<f64>>>() else { continue };
        let Ok(loaded) = program.load(Floats) else { continue };
        let Ok(values) = loaded.run(&inputs, &mut Vec::new()) else { continue };
        if values.iter().all(|value| value.is_finite()) {
            for (bound, value) in bounds.iter_mut().zip(values) {
                *bound = (bound.0.min(value), bound.1.max(value));
            }
        }
    }
    for (coordinate, (low, high)) in new.iter().zip(bounds) {
        if low < high {
            found.push(format!("{} in [{}, {}]", coordinate.name, decimal(low), decimal(high)));
        }
    }
    found
}

/// A decimal with a few digits.
fn decimal(value: f64) -> String {
    let digits = (3 - value.abs().max(1e-300).log10().ceil() as i32).clamp(0, 12) as usize;
    format!("{value:.digits$}")
}
