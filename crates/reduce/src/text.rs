//! The smaller system as a proof file.

use super::flows::Flow;
use super::names::{Names, TOO_LONG};
use super::question::NotReduced;
use super::remaining::{LeftOutOfRate, LeftOutState, Remaining, WhyLeftOut};
use dashu::rational::RBig;
use palmistry_lang::{Assignment, Kind, parse_statement};
use palmistry_math::expression::syntax::Equation;
use palmistry_math::expression::{Node, NodeId, Symbol};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::fmt::Write;

/// The name under which the larger system is imported.
const LARGER: &str = "larger";

/// Assumptions that are longer with what is put in are left out, in bytes.
const LONGEST_ASSUMPTION: usize = 2000;

pub(crate) fn text(remaining: &mut Remaining, import: &str) -> Result<String, NotReduced> {
    if remaining.output_nodes().next().is_none() && remaining.further_outputs.is_empty() {
        return Err(NotReduced::Nothing);
    }
    let names = Names::new(remaining);
    let mut out = String::new();
    head(&mut out, remaining, import);
    declarations(&mut out, remaining);
    assumptions(&mut out, remaining)?;
    if !names.definitions.is_empty() {
        out.push('\n');
    }
    for place in 0..names.definitions.len() {
        let (name, node) = (names.definitions[place].name.clone(), names.definitions[place].node);
        let value = names.text(remaining, node, Some(node));
        if value.starts_with(TOO_LONG) {
            return Err(NotReduced::TooLong { name });
        }
        let _ = writeln!(out, "let {name} = {value}");
    }
    fields(&mut out, remaining, &names)?;
    outputs(&mut out, remaining, &names)?;
    sample(&mut out, remaining, &names);
    claims(&mut out, remaining, &names)?;
    Ok(out)
}

fn head(out: &mut String, remaining: &Remaining, import: &str) {
    let conditions = remaining.conditions();
    let _ = writeln!(out, "# The least model of \"{}\"", one_line(&remaining.system.title));
    if !conditions.is_empty() {
        let _ = writeln!(out, "# where {}.", conditions.join(", "));
    }
    for LeftOutState { name, why } in &remaining.left_out {
        let _ = match why {
            WhyLeftOut::Fixed(value) => writeln!(out, "# {name} is left out: it is {value}"),
            WhyLeftOut::KnownConstant => writeln!(out, "# {name} is a known constant: a parameter here"),
            WhyLeftOut::MeasuredConstant => {
                writeln!(out, "# {name} is measured and constant: a parameter here")
            }
            WhyLeftOut::NoOutputDependsOnIt => {
                writeln!(out, "# {name} is left out: no output depends on it, so that it is unobservable")
            }
            WhyLeftOut::NotNeeded => writeln!(out, "# {name} is left out: no output depends on it"),
            WhyLeftOut::InSmallTermsAlone => {
                writeln!(
                    out,
                    "# {name} is left out: outputs depend on it by small terms alone, which are left out"
                )
            }
            WhyLeftOut::Conserved { law, total } => {
                writeln!(out, "# {name} is left out: {law} is conserved, and is the unknown constant {total}")
            }
        };
    }
    for remark in &remaining.remarks {
        let _ = writeln!(out, "# {remark}");
    }
    for one in &remaining.approximated {
        let (state, bound) = (remaining.system.symbol_name(one.state), &one.bound);
        let field = &remaining.flows[one.flow].name;
        let _ = writeln!(
            out,
            "# small terms of {state}' along {field} are left out: together at most {bound} over the ranges"
        );
    }
    let title = one_line(&remaining.system.title);
    let _ = writeln!(out, "\nsystem \"{title}: the least model\"\n");
    let _ = writeln!(out, "use {LARGER} = \"{import}\"\n");
}

/// A title or a path in quotes ends where it ends.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || c == '"' { ' ' } else { c }).collect()
}

/// A name, and its dimension where the file declares some.
fn declared(remaining: &Remaining, symbol: Symbol) -> String {
    declared_as(remaining, symbol, "")
}

/// The same with something behind the name.
fn declared_as(remaining: &Remaining, symbol: Symbol, behind: &str) -> String {
    let name = format!("{}{behind}", remaining.system.symbol_name(symbol));
    let dimension = match remaining.system.declares_dimensions() {
        true => remaining.system.dimension_of(symbol),
        false => None,
    };
    match dimension {
        Some(dimension) if dimension.is_none() && remaining.system.is_angle(symbol) => {
            format!("{name} : angle")
        }
        Some(dimension) => format!("{name} : {dimension}"),
        None => name,
    }
}

fn declarations(out: &mut String, remaining: &Remaining) {
    let totals: HashMap<Symbol, Symbol> = remaining.laws.iter().map(|law| (law.total, law.state)).collect();
    let of = |symbol: &Symbol| match totals.get(symbol) {
        // a sum with rational factors has the dimension of its terms
        Some(state) => {
            let like = declared(remaining, *state);
            let dimension = like.split_once(" : ").map(|(_, dimension)| format!(" : {dimension}"));
            format!("{}{}", remaining.system.symbol_name(*symbol), dimension.unwrap_or_default())
        }
        None => declared(remaining, *symbol),
    };
    let (constants, states): (Vec<Symbol>, Vec<Symbol>) = remaining
        .states
        .iter()
        .copied()
        .partition(|state| remaining.is_declared_constant(*state) || totals.contains_key(state));
    // a dimension holds for the names before it too: what has none stands by itself
    let mut line = Vec::new();
    for state in states.iter().map(of) {
        let ends = !state.contains(':') && remaining.system.declares_dimensions();
        line.push(state);
        if ends {
            let alone = line.pop();
            lines_of_states(out, &mut line);
            line.extend(alone);
            lines_of_states(out, &mut line);
        }
    }
    lines_of_states(out, &mut line);
    for symbol in &constants {
        let hint = remaining.system.hint(*symbol).map(|hint| format!(" = {hint}")).unwrap_or_default();
        let _ = writeln!(out, "param {}{hint} unknown", of(symbol));
    }
    let mentioned = mentioned(remaining);
    for (symbol, info) in remaining.system.symbols() {
        let is_parameter = info.kind == Kind::Parameter && mentioned.contains(&symbol);
        let is_declared = remaining.states.contains(&symbol) || remaining.signals.contains(&symbol);
        let constant = remaining.constants.iter().find(|(constant, _)| *constant == symbol);
        if (is_parameter && !is_declared && remaining.system.derivative_of_signal(symbol).is_none())
            || constant.is_some()
        {
            let value = constant.and_then(|(_, value)| value.as_ref()).or(info.default.as_ref());
            let value = value.map(|value| format!(" = {value}")).unwrap_or_default();
            let _ = writeln!(out, "param {}{value}", declared(remaining, symbol));
        }
    }
    for symbol in remaining.signals.iter().filter(|symbol| mentioned.contains(symbol)) {
        let _ = writeln!(out, "known {}", declared_as(remaining, *symbol, "(t)"));
    }
    for chain in remaining.system.signal_chains() {
        let Some(first) = chain.first() else { continue };
        if !chain.iter().any(|symbol| mentioned.contains(symbol)) {
            continue;
        }
        let whole = declared_as(remaining, *first, "(t)");
        if remaining.system.known.contains(first) {
            let _ = writeln!(out, "known {whole}");
        } else {
            let _ = writeln!(out, "unknown {whole} order {}", chain.len() - 1);
        }
    }
    let at_first: Vec<&str> = remaining
        .states
        .iter()
        .filter(|state| remaining.system.known.contains(state))
        .map(|state| remaining.system.symbol_name(*state))
        .collect();
    if !at_first.is_empty() {
        let _ = writeln!(out, "initial {} known", at_first.join(", "));
    }
    let angles: Vec<&str> = remaining
        .system
        .symbols()
        .filter(|(symbol, info)| {
            info.is_angle && (remaining.states.contains(symbol) || mentioned.contains(symbol))
        })
        .map(|(symbol, _)| remaining.system.symbol_name(symbol))
        .collect();
    if !angles.is_empty() {
        let _ = writeln!(out, "angle {}", angles.join(", "));
    }
}

/// The assumptions of the larger system, with what the conditions and the conserved amounts give put in. One about what is left out altogether restricts nothing that
/// is written here, and is named.
fn assumptions(out: &mut String, remaining: &mut Remaining) -> Result<(), NotReduced> {
    let declared: HashSet<Symbol> = remaining.states.iter().copied().chain(mentioned(remaining)).collect();
    let values = values_of_what_is_left_out(remaining);
    for assumed in remaining.system.assumptions() {
        let not_read = || NotReduced::Kind { why: format!("the assumption {assumed} cannot be read") };
        let statement = parse_statement(&format!("0 = 0 where {assumed}")).map_err(|_| not_read())?;
        let mut parts = Vec::new();
        let (mut changes, mut is_whole) = (false, true);
        for Equation { left, relation, right, .. } in &statement.conditions {
            let mut side = |expr| remaining.system.elaborate(expr).ok()?.as_number();
            let (left, right) = (side(left).ok_or_else(not_read)?, side(right).ok_or_else(not_read)?);
            let there = match remaining.system.graph.vanishing_divisor(&[left, right], &values) {
                Some(_) => None,
                None => Some(remaining.system.graph.substitute(&[left, right], &values)),
            };
            let Some(&[new_left, new_right]) = there.as_deref() else {
                is_whole = false;
                continue;
            };
            let graph = &mut remaining.system.graph;
            let difference = graph.sub(new_left, new_right);
            if let Some(number) = graph.constant_value(difference) {
                let holds = relation.holds(number.cmp(&RBig::ZERO));
                if !holds {
                    let why = format!("the conditions contradict the assumption {assumed}");
                    return Err(NotReduced::Kind { why });
                }
                changes = true;
                continue;
            }
            changes |= (left, right) != (new_left, new_right);
            is_whole &= graph.symbols_of([new_left, new_right]).iter().all(|one| declared.contains(one));
            let [left, right] = [new_left, new_right].map(|side| graph.text(side));
            is_whole &= left.len() + right.len() < LONGEST_ASSUMPTION;
            parts.push(format!("{left} {} {right}", relation.sign()));
        }
        match (is_whole, changes, parts.is_empty()) {
            (true, false, _) => {
                let _ = writeln!(out, "assume {assumed}");
            }
            (true, true, false) => {
                let _ = writeln!(out, "assume {}", parts.join(", "));
            }
            (true, true, true) => {}
            (false, ..) => {
                let _ = writeln!(
                    out,
                    "# not assumed here, as it is about what is left out: {}",
                    one_line(&assumed)
                );
            }
        }
    }
    Ok(())
}

/// What is written in the place of states and constants that are left out.
fn values_of_what_is_left_out(remaining: &mut Remaining) -> Assignment {
    let mut values = remaining.values.clone();
    for law in &remaining.laws {
        let given = law.given(&mut remaining.system.graph);
        values.insert(law.state, given);
    }
    values
}

/// Writes the states of a list, where there are some, and empties it.
fn lines_of_states(out: &mut String, list: &mut Vec<String>) {
    if !list.is_empty() {
        let _ = writeln!(out, "state {}", std::mem::take(list).join(", "));
    }
}

/// The symbols of all formulas of the smaller system, and the constants that have become parameters.
fn mentioned(remaining: &Remaining) -> BTreeSet<Symbol> {
    let formulas = remaining.rates.iter().flatten().copied().chain(remaining.output_nodes());
    remaining
        .system
        .graph
        .symbols_of(formulas)
        .into_iter()
        .chain(remaining.constants.iter().map(|(constant, _)| *constant))
        .collect()
}

fn fields(out: &mut String, remaining: &mut Remaining, names: &Names) -> Result<(), NotReduced> {
    for (place, flow) in remaining.flows.clone().into_iter().enumerate() {
        let (role, name) = (flow.role.name(), flow.name);
        let _ = writeln!(out, "\n{role} {name}");
        let mut rests = false;
        let totals: Vec<Symbol> = remaining.laws.iter().map(|law| law.total).collect();
        for (at, state) in remaining.states.clone().into_iter().enumerate() {
            if remaining.is_declared_constant(state) || totals.contains(&state) {
                continue;
            }
            let rate = remaining.rates[place][at];
            let text = names.text(remaining, rate, None);
            let state = remaining.system.symbol_name(state);
            if text.starts_with(TOO_LONG) {
                return Err(NotReduced::TooLong { name: state.to_owned() });
            }
            if text == "0" {
                rests = true;
            } else {
                let _ = writeln!(out, "  {state}' = {text}");
            }
        }
        if rests {
            let _ = writeln!(out, "  others' = 0");
        }
    }
    Ok(())
}

fn outputs(out: &mut String, remaining: &mut Remaining, names: &Names) -> Result<(), NotReduced> {
    let mut list = Vec::new();
    let mut zeros = Vec::new();
    for output in remaining.outputs.clone().into_iter().filter(|output| output.is_kept) {
        let text = names.text(remaining, output.node, None);
        if text.starts_with(TOO_LONG) {
            return Err(NotReduced::TooLong { name: "an output".to_owned() });
        }
        if output.is_zero { zeros.push(text) } else { list.push(text) }
    }
    for symbol in &remaining.further_outputs {
        list.push(remaining.system.symbol_name(*symbol).to_owned());
    }
    out.push('\n');
    if !list.is_empty() {
        let _ = writeln!(out, "output {}", list.join(", "));
    }
    for zero in zeros {
        let _ = writeln!(out, "output 0 = {zero}");
    }
    Ok(())
}

/// The ranges of what remains, and what samples avoid.
fn sample(out: &mut String, remaining: &mut Remaining, names: &Names) {
    let mentioned = mentioned(remaining);
    let mut lines = Vec::new();
    for (symbol, info) in remaining.system.symbols() {
        if let (true, Some(range)) =
            (remaining.states.contains(&symbol) || mentioned.contains(&symbol), &info.range)
        {
            let name = remaining.system.symbol_name(symbol);
            lines.push(format!("{name} in [{}, {}]", range.low, range.high));
        }
    }
    for law in &remaining.laws {
        if let Some([low, high]) = law.range_of_the_total(&remaining.system) {
            lines.push(format!("{} in [{low}, {high}]", remaining.system.symbol_name(law.total)));
        }
    }
    let values = values_of_what_is_left_out(remaining);
    let mut avoided = Vec::new();
    for (_, node) in remaining.system.avoid.clone() {
        if remaining.system.graph.vanishing_divisor(&[node], &values).is_some() {
            continue;
        }
        let there = remaining.system.graph.substitute(&[node], &values)[0];
        // what is not zero has an opposite that is not
        let there = match remaining.system.graph.node(there) {
            Node::Neg(inner) => inner,
            _ => there,
        };
        let symbols = remaining.system.graph.symbols_of([there]);
        let is_there =
            symbols.iter().all(|symbol| mentioned.contains(symbol) || remaining.states.contains(symbol));
        let text = names.text(remaining, there, None);
        if is_there && !symbols.is_empty() && !text.starts_with(TOO_LONG) && !avoided.contains(&text) {
            avoided.push(text);
        }
    }
    if !avoided.is_empty() {
        lines.push(format!("avoid {}", avoided.join(", ")));
    }
    if !lines.is_empty() {
        let _ = writeln!(out, "\nsample\n  {}", lines.join("\n  "));
    }
}

fn claims(out: &mut String, remaining: &mut Remaining, names: &Names) -> Result<(), NotReduced> {
    let solved = remaining.conditions();
    let place = |conditions: &[String]| match conditions.is_empty() {
        true => String::new(),
        false => format!(" where {}", conditions.join(", ")),
    };
    let mut all = solved.clone();
    for law in remaining.laws.clone() {
        let given = law.given(&mut remaining.system.graph);
        let value = remaining.system.graph.text(given);
        all.push(format!("{} = {value}", remaining.system.symbol_name(law.state)));
    }
    let (fixed_place, whole_place) = (place(&solved), place(&all));
    let along = |remaining: &Remaining, flow: &Flow, what: &str| {
        let term = |(by, field): &(Option<Symbol>, usize)| {
            let by = by.map(|by| format!("{}*", remaining.system.symbol_name(by))).unwrap_or_default();
            format!("{by}L({LARGER}.{}, {what})", remaining.system.fields[*field].name)
        };
        let terms: Vec<String> = flow.terms.iter().map(term).collect();
        terms.join(" + ")
    };
    let flows = remaining.flows.clone();
    let mut constant = Vec::new();
    let mut values: Vec<(Symbol, NodeId)> =
        remaining.values.iter().map(|(symbol, value)| (*symbol, *value)).collect();
    values.sort_unstable_by_key(|(symbol, _)| *symbol);
    for (symbol, value) in values {
        let name = remaining.system.symbol_name(symbol);
        // a parameter and a signal have the value that is said
        let is_fixed = |one: &LeftOutState| one.name == name && matches!(one.why, WhyLeftOut::Fixed(_));
        if remaining.left_out.iter().any(is_fixed) {
            // a number has no rate
            constant.push(match remaining.system.graph.constant_value(value) {
                Some(_) => name.to_owned(),
                None => format!("{name} - ({})", remaining.system.graph.text(value)),
            });
        }
    }
    constant.extend(
        remaining.constants.iter().rev().map(|(one, _)| remaining.system.symbol_name(*one).to_owned()),
    );
    if !constant.is_empty() || !remaining.laws.is_empty() {
        let _ = writeln!(out, "\n# the conditions stay met, and what is constant does not move");
    }
    if !constant.is_empty() {
        let zeros = vec!["0"; constant.len()].join(", ");
        let list = format!("[{}]", constant.join(", "));
        for flow in &flows {
            let rates = along(remaining, flow, &list);
            let _ = writeln!(out, "claim constant.{}: {rates} = [{zeros}]{fixed_place}", flow.name);
        }
    }
    for law in &remaining.laws {
        for flow in &flows {
            let rate = along(remaining, flow, &law.text);
            let _ = writeln!(out, "claim {}.{}: {rate} = 0{fixed_place}", law.name, flow.name);
        }
    }
    let moves = match remaining.approximated.is_empty() {
        true => "the larger system moves so",
        false => "the larger system moves so, but for the terms that are left out",
    };
    let _ = writeln!(out, "\n# {moves}, and its outputs are the same");
    let totals: Vec<Symbol> = remaining.laws.iter().map(|law| law.total).collect();
    for (place, flow) in flows.iter().enumerate() {
        let field = &flow.name;
        for state in remaining.states.clone().into_iter().filter(|state| !totals.contains(state)) {
            if remaining.is_declared_constant(state) {
                continue; // a constant is one in both
            }
            let name = remaining.system.symbol_name(state).to_owned();
            let id = id(&name);
            let rate = along(remaining, flow, &name);
            match remaining.approximated.iter().position(|one| one.flow == place && one.state == state) {
                None => {
                    let _ = writeln!(out, "claim {field}.{id}: L({field}, {name}) = {rate}{whole_place}");
                }
                Some(one) => {
                    let difference = format!("{rate} - L({field}, {name})");
                    bounded(out, remaining, names, &remaining.approximated[one].clone(), &difference, &all);
                }
            }
        }
    }
    let mut texts = Vec::new();
    for output in remaining.outputs.clone() {
        let text = names.text(remaining, output.node, None);
        if text.starts_with(TOO_LONG) {
            return Err(NotReduced::TooLong { name: "an output".to_owned() });
        }
        texts.push(text);
    }
    let _ = writeln!(out, "claim output: {LARGER}.output = [{}]{whole_place}", texts.join("; "));
    Ok(())
}

/// The claims that bound what was left out of a rate: what it is, where that could be written, and how large it is over the ranges.
fn bounded(
    out: &mut String,
    remaining: &mut Remaining,
    names: &Names,
    left_out: &LeftOutOfRate,
    difference: &str,
    conditions: &[String],
) {
    let id = format!(
        "{}.{}",
        remaining.flows[left_out.flow].name,
        id(remaining.system.symbol_name(left_out.state))
    );
    let place = |conditions: &[String]| match conditions.is_empty() {
        true => String::new(),
        false => format!(" where {}", conditions.join(", ")),
    };
    let written = names.text(remaining, left_out.difference, None);
    let difference = match written.starts_with(TOO_LONG) {
        false => {
            let _ = writeln!(out, "claim {id}.left_out: {difference} = {written}{}", place(conditions));
            written
        }
        true => difference.to_owned(),
    };
    let ranges = left_out.ranges.iter().map(|(symbol, low, high)| {
        let name = remaining.system.symbol_name(*symbol);
        if low == high { format!("{name} = {low}") } else { format!("{low} <= {name} <= {high}") }
    });
    let all: Vec<String> = conditions.iter().cloned().chain(ranges).collect();
    let bound = &left_out.bound;
    let _ = writeln!(out, "claim {id}: -{bound} <= {difference} <= {bound}{}", place(&all));
}

/// A name as a part of a claim's id.
fn id(name: &str) -> String {
    name.replace('[', ".").replace([']', '\''], "")
}
