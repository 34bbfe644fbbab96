//! Models of ModelingToolkit.jl, as StructuralIdentifiability.jl takes them: `@parameters`, `@variables`, `D(x) ~ ...` and
//! `measured_quantities = [y ~ x]`.

mod assigned;
mod declared;
mod systems;

use super::expression::{ForeignExpr, Span};
use super::file_functions::FileFunctions;
use super::functions::constant;
use super::model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate};
use super::print::same;
use super::script::{Syntax, SyntaxKind, Token, meaning};
use assigned::{assignments, refuse_assigned, refuse_changed};
use dashu::rational::RBig;
use declared::Declared;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};
use systems::{equations, has_rates, refuse_unread};

/// Reads a file without `@ODEmodel`: its system, or the one of several that has a name or number.
pub(super) fn read(
    text: &str,
    words: &[Token],
    comments: &[(usize, String)],
    which: Option<&str>,
    budget: &Budget,
) -> Result<ForeignModel, Problem> {
    let declared = Declared::of(words)?;
    let lists = equations(words)?;
    if lists.is_empty() || declared.variables.is_empty() {
        let end = text.len();
        return Err(Problem::new(Code::Foreign, &(0..end.min(1)), "the file has no model that can be read", "the file").help(
            "a model is @ODEmodel(x'(t) = ..., y(t) = ...), or @parameters, @variables and lists of equations [D(x) ~ ...] and measured_quantities = [y ~ x]",
        ));
    }
    refuse_steps(words)?;
    refuse_unread(words)?;
    let assigned = assignments(words, &declared);
    let last = lists.iter().map(|list| list.at).max().unwrap_or(0);
    refuse_assigned(words, &assigned, &declared, last)?;
    refuse_changed(words, &lists.iter().filter_map(|list| list.name.as_deref()).collect())?;
    let file = systems::File { words, lists: &lists, assigned: &assigned, budget };
    let (which, remark) = systems::chosen(&file, &declared, which)?;
    let mut model = ForeignModel::default();
    model.remarks.extend(remark);
    let begin = words.iter().find(|word| word.is("@")).map_or(0, |word| word.span.start);
    model.source = super::heading(text, comments, begin);
    let equations = || which.iter().flat_map(|at| &lists[*at].list);
    let functions = FileFunctions::of(words);
    let names = assigned.iter().map(|one| words[one.name].text.as_str()).collect();
    let mut reading =
        Reading { declared: &declared, functions: &functions, assigned: names, orders: BTreeMap::new() };
    reading.look_at_orders(equations())?;
    let mut defined: BTreeMap<String, ForeignExpr> = BTreeMap::new();
    let mut order = Vec::new();
    let mut rated = BTreeSet::new();
    for equation in equations() {
        let (left, right) = sides(equation)?;
        let value = reading.value(right)?;
        let twice = |name: &str| {
            Problem::new(Code::Foreign, &left.span, format!("'{name}' has two equations"), "the second one")
                .help("take one of them out")
        };
        if let Some((state, derivatives)) = declared.derivative(left)? {
            if !rated.insert(state.to_owned()) {
                return Err(twice(state));
            }
            // x, its rate, and so on are states of their own
            for step in 0..derivatives {
                let last = step + 1 == derivatives;
                let rate = match last {
                    true => value.clone(),
                    false => ForeignExpr::name(reading.rate_name(state, step + 1), &left.span),
                };
                model.states.push(ForeignRate {
                    name: reading.rate_name(state, step),
                    rate,
                    span: left.span.clone(),
                });
            }
            if derivatives > 1 {
                let names = (1..derivatives).map(|step| reading.rate_name(state, step)).collect::<Vec<_>>();
                model.remarks.push(format!(
                    "'{state}' has a derivative of order {derivatives}: its derivatives below are states, {}",
                    names.join(", ")
                ));
            }
        } else if let Some(name) = declared.variable(left)? {
            if defined.insert(name.to_owned(), value).is_some() {
                return Err(twice(name));
            }
            order.push(name.to_owned());
        } else {
            return Err(Problem::new(
                Code::Foreign,
                &left.span,
                "the left side is no derivative and no variable",
                "this",
            )
            .help("a model has equations D(x) ~ ... and y ~ ...: solve it for one of these"));
        }
    }
    if let Some(both) = rated.iter().find(|name| defined.contains_key(*name)) {
        let place = defined.get(both).map_or(0..0, |value| value.span.clone());
        return Err(Problem::new(
            Code::Foreign,
            &place,
            format!("'{both}' has two equations"),
            "the second one",
        )
        .help("take one of them out"));
    }
    for equation in lists
        .iter()
        .filter(|list| list.is_measured() && !has_rates(list, &declared))
        .flat_map(|list| &list.list)
    {
        let (left, right) = sides(equation)?;
        let name = declared.variable(left)?.or(left.as_name()).or(name_of_time(left, &declared));
        let (name, value) = (name.map(str::to_owned), reading.value(right)?);
        // what is measured may be said in a list and once more where it is asked about
        match model.outputs.iter().find(|output| name.is_some() && output.name == name) {
            Some(output) if same(&output.value, &value) => {}
            Some(_) => {
                let message = format!("'{}' has two equations", name.unwrap_or_default());
                return Err(Problem::new(Code::Foreign, &left.span, message, "the second one")
                    .help("take one of them out"));
            }
            None => model.outputs.push(ForeignOutput { name, value }),
        }
    }
    place_definitions(&mut model, defined, order);
    let used = used_names(&model);
    let moved: BTreeSet<&String> = model.states.iter().map(|state| &state.name).collect();
    let given: BTreeSet<&String> = model.definitions.iter().map(|(name, _)| name).collect();
    let is_input = |name: &&String| !moved.contains(name) && !given.contains(name);
    model.known_inputs =
        declared.variables.iter().filter(|name| used.contains(*name)).filter(is_input).cloned().collect();
    let constant = |(name, value): &(String, Option<RBig>)| ForeignConstant {
        name: name.clone(),
        value: value.clone(),
        is_unknown: true,
        may_be_unknown: true,
    };
    model.constants = declared.parameters.iter().map(constant).collect();
    Ok(model)
}

/// The name of `y(t)`, where nothing declares it.
fn name_of_time<'a>(left: &'a Syntax, declared: &Declared) -> Option<&'a str> {
    let SyntaxKind::Call(callee, arguments) = &left.kind else { return None };
    let [time] = arguments.as_slice() else { return None };
    time.as_name().filter(|time| declared.times.contains(*time)).and_then(|_| callee.as_name())
}

/// What is only measured is an output, and everything else a definition.
fn place_definitions(
    model: &mut ForeignModel,
    mut defined: BTreeMap<String, ForeignExpr>,
    order: Vec<String>,
) {
    let mut used = used_names(model);
    for value in defined.values() {
        value.names(&mut |name, _| {
            used.insert(name.to_owned());
        });
    }
    let nothing_is_measured = model.outputs.is_empty();
    for name in order {
        let Some(value) = defined.remove(&name) else { continue };
        if nothing_is_measured && !used.contains(&name) {
            model.outputs.push(ForeignOutput { name: Some(name), value });
        } else {
            model.definitions.push((name, value));
        }
    }
}

fn used_names(model: &ForeignModel) -> BTreeSet<String> {
    let mut used = BTreeSet::new();
    let mut look = |value: &ForeignExpr| {
        value.names(&mut |name, _| {
            used.insert(name.to_owned());
        });
    };
    model.states.iter().for_each(|state| look(&state.rate));
    model.outputs.iter().for_each(|output| look(&output.value));
    model.definitions.iter().for_each(|(_, value)| look(value));
    used
}

/// Steps are written in several ways that mean different things.
fn refuse_steps(words: &[Token]) -> Result<(), Problem> {
    let step = ["Difference", "ShiftIndex", "DiscreteSystem", "DiscreteProblem"];
    match words.iter().find(|word| step.iter().any(|name| word.is_word(name))) {
        Some(word) => Err(Problem::new(
            Code::Foreign,
            &word.span,
            "models in steps are not read from ModelingToolkit",
            "this",
        )
        .help("write it as @DDSmodel(x(t + 1) = ..., y(t) = ...)")),
        None => Ok(()),
    }
}

fn sides(equation: &Syntax) -> Result<(&Syntax, &Syntax), Problem> {
    match &equation.kind {
        SyntaxKind::Equation("~", left, right) => Ok((left, right)),
        _ => Err(Problem::new(Code::Foreign, &equation.span, "this is no equation", "this")
            .help("an equation is left ~ right")),
    }
}

/// What names and calls of a file mean.
struct Reading<'f> {
    declared: &'f Declared,
    functions: &'f FileFunctions,
    /// Names that something is assigned to: declaring them would make another model.
    assigned: BTreeSet<&'f str>,
    /// Which derivative of a variable the equations give.
    orders: BTreeMap<String, usize>,
}

impl Reading<'_> {
    fn look_at_orders<'s>(&mut self, equations: impl Iterator<Item = &'s Syntax>) -> Result<(), Problem> {
        for equation in equations {
            let (left, _) = sides(equation)?;
            if let Some((name, order)) = self.declared.derivative(left)? {
                let own = self.orders.entry(name.to_owned()).or_insert(order);
                *own = (*own).max(order);
            }
        }
        Ok(())
    }

    /// The name of a derivative of a variable that is a state of its own: `x_t`, `x_tt`.
    fn rate_name(&self, name: &str, derivatives: usize) -> String {
        if derivatives == 0 {
            return name.to_owned();
        }
        let taken =
            |name: &String| self.declared.variables.contains(name) || self.declared.constants.contains(name);
        let mut own = format!("{name}_{}", "t".repeat(derivatives));
        while taken(&own) {
            own.push('_');
        }
        own
    }

    fn value(&self, syntax: &Syntax) -> Result<ForeignExpr, Problem> {
        meaning(syntax, &mut |part| self.special(part).transpose())
    }

    fn special(&self, part: &Syntax) -> Result<Option<ForeignExpr>, Problem> {
        if let Some(name) = self.declared.variable(part)? {
            return Ok(Some(ForeignExpr::name(name, &part.span)));
        }
        if let Some((name, order)) = self.declared.derivative(part)? {
            return match self.orders.get(name) {
                Some(most) if order < *most => {
                    Ok(Some(ForeignExpr::name(self.rate_name(name, order), &part.span)))
                }
                _ => Err(Problem::new(
                    Code::Foreign,
                    &part.span,
                    "a derivative stands in an expression",
                    "this",
                )
                .help("write what it is equal to: only rates of states may stand on the left")),
            };
        }
        self.functions.refuse(part)?;
        match &part.kind {
            SyntaxKind::Name(name) if self.declared.constants.contains(name) => {
                Ok(Some(ForeignExpr::name(name, &part.span)))
            }
            SyntaxKind::Name(name) => match named_number(name, &part.span) {
                Some(number) => Ok(Some(number)),
                None => {
                    let (message, help) = match self.declared.times.contains(name) {
                        true => {
                            (format!("time stands by itself: '{name}'"), "time is a state with D(time) ~ 1")
                        }
                        false if self.declared.bare.contains(name) => (
                            format!("'{name}' is no function of time"),
                            "declare it with @parameters, or as a function of time",
                        ),
                        false if self.assigned.contains(name.as_str()) => (
                            format!("'{name}' is assigned to in the file, and assignments are not read"),
                            "write what is assigned in its place, or under @parameters with its value",
                        ),
                        false => (
                            format!("'{name}' is declared neither as a parameter nor as a variable"),
                            "declare it with @parameters or @variables; time is a state with D(time) ~ 1",
                        ),
                    };
                    Err(Problem::new(Code::Foreign, &part.span, message, "this name").help(help))
                }
            },
            _ => Ok(None),
        }
    }
}

/// The numbers that have names in Julia.
fn named_number(name: &str, span: &Span) -> Option<ForeignExpr> {
    match name {
        "ℯ" => constant("E", span),
        "π" | "pi" => constant("pi", span),
        _ => None,
    }
}
