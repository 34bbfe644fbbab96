//! Models of ModelingToolkit.jl, as StructuralIdentifiability.jl takes them: `@parameters`, `@variables`, `D(x) ~ ...` and
//! `measured_quantities = [y ~ x]`.

use super::expression::ForeignExpr;
use super::model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate};
use super::script::{Dialect, Parser, Syntax, SyntaxKind, Token, TokenKind, meaning};
use dashu::rational::RBig;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// What the declarations of a file say.
#[derive(Default)]
struct Declared {
    /// Names with their values.
    parameters: Vec<(String, Option<RBig>)>,
    /// Their names.
    constants: BTreeSet<String>,
    variables: BTreeSet<String>,
    /// Names without a bracket among the variables: time.
    times: BTreeSet<String>,
}

/// A list of equations, and what it is assigned to.
struct Equations {
    measured: bool,
    list: Vec<Syntax>,
}

/// Reads a file without `@ODEmodel`.
pub(super) fn read(
    text: &str,
    words: &[Token],
    comments: &[(usize, String)],
) -> Result<ForeignModel, Problem> {
    let declared = declarations(words)?;
    let lists = equations(words)?;
    if lists.is_empty() || declared.variables.is_empty() {
        let end = text.len();
        return Err(Problem::new(Code::Foreign, &(0..end.min(1)), "the file has no model that can be read", "the file").help(
            "a model is @ODEmodel(x'(t) = ..., y(t) = ...), or @parameters, @variables and lists of equations [D(x) ~ ...] and measured_quantities = [y ~ x]",
        ));
    }
    refuse_steps(words)?;
    let mut model = ForeignModel::default();
    let begin = words.iter().find(|word| word.is("@")).map_or(0, |word| word.span.start);
    model.source = super::heading(text, comments, begin);
    let mut defined: BTreeMap<String, ForeignExpr> = BTreeMap::new();
    let mut order = Vec::new();
    let mut rated = BTreeSet::new();
    for equation in lists.iter().filter(|list| !list.measured).flat_map(|list| &list.list) {
        let (left, right) = sides(equation)?;
        let value = value(right, &declared)?;
        if let Some(state) = differentiated(left, &declared) {
            if !rated.insert(state.to_owned()) {
                return Err(Problem::new(
                    Code::Foreign,
                    &left.span,
                    format!("'{state}' has two equations"),
                    "the second one",
                )
                .help("take one of them out"));
            }
            model.states.push(ForeignRate { name: state.to_owned(), rate: value, span: left.span.clone() });
        } else if let Some(name) = variable(left, &declared) {
            if defined.insert(name.to_owned(), value).is_some() {
                return Err(Problem::new(
                    Code::Foreign,
                    &left.span,
                    format!("'{name}' has two equations"),
                    "the second one",
                )
                .help("take one of them out"));
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
    for equation in lists.iter().filter(|list| list.measured).flat_map(|list| &list.list) {
        let (left, right) = sides(equation)?;
        let name = variable(left, &declared).or(left.as_name()).map(str::to_owned);
        model.outputs.push(ForeignOutput { name, value: value(right, &declared)? });
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

/// All `@parameters` and `@variables`.
fn declarations(words: &[Token]) -> Result<Declared, Problem> {
    let mut declared = Declared::default();
    for at in 0..words.len().saturating_sub(1) {
        let kind = &words[at + 1];
        let is_parameter = kind.is_word("parameters") || kind.is_word("constants");
        let is_time = kind.is_word("independent_variables");
        if !words[at].is("@") || !(is_parameter || is_time || kind.is_word("variables")) {
            continue;
        }
        let mut parser = Parser::new(words, Dialect::Julia);
        parser.go_to(at + 2);
        let block = parser.peek().is_word("begin");
        if block {
            parser.next();
        }
        loop {
            let word = parser.peek();
            let ends = if block { word.is_word("end") } else { word.newline };
            if ends || parser.at_end() {
                break;
            }
            if parser.take(",") || parser.take(";") {
                continue;
            }
            // metadata behind a name
            if word.is("[") {
                parser.argument()?;
                continue;
            }
            if word.kind != TokenKind::Name {
                return Err(parser.unexpected("a name"));
            }
            let one = parser.argument()?;
            declare(&one, is_parameter, is_time, &mut declared)?;
        }
    }
    Ok(declared)
}

fn declare(one: &Syntax, is_parameter: bool, is_time: bool, declared: &mut Declared) -> Result<(), Problem> {
    let (left, right) = match &one.kind {
        SyntaxKind::Equation("=", left, right) => (left.as_ref(), Some(right.as_ref())),
        _ => (one, None),
    };
    match &left.kind {
        SyntaxKind::Name(name) if is_parameter => {
            let value = right.and_then(|right| match &right.kind {
                SyntaxKind::Number(value) => Some(value.clone()),
                _ => None,
            });
            declared.constants.insert(name.clone());
            declared.parameters.push((name.clone(), value));
        }
        SyntaxKind::Name(name) => {
            declared.times.insert(name.clone());
            if !is_time && right.is_some() {
                return Err(Problem::new(
                    Code::Foreign,
                    &one.span,
                    format!("'{name}' is no function of time"),
                    "this",
                )
                .help(format!("write {name}(t), or declare it under @parameters")));
            }
        }
        SyntaxKind::Call(callee, _) => match callee.as_name() {
            Some(name) => {
                declared.variables.insert(name.to_owned());
            }
            None => return Err(Problem::new(Code::Foreign, &left.span, "this is no name", "this")),
        },
        _ => {
            return Err(Problem::new(Code::Foreign, &left.span, "this is no name that can be read", "this")
                .help("vectors of variables are not read: write their elements out"));
        }
    }
    Ok(())
}

/// All lists of equations, `[... ~ ..., ...]` and `@equations begin ... end`.
fn equations(words: &[Token]) -> Result<Vec<Equations>, Problem> {
    let mut lists = Vec::new();
    let mut open: Vec<(usize, bool)> = Vec::new();
    for (at, word) in words.iter().enumerate() {
        match word.kind {
            TokenKind::Sign("[" | "(" | "{") => open.push((at, false)),
            TokenKind::Sign("~") => match open.last_mut() {
                Some((_, has_equations)) => *has_equations = true,
                None if !within_block(words, at) => {
                    return Err(Problem::new(
                        Code::Foreign,
                        &word.span,
                        "an equation outside of a list",
                        "this",
                    )
                    .help("put equations into lists: eqs = [D(x) ~ ...] and measured_quantities = [y ~ x]"));
                }
                None => {}
            },
            TokenKind::Sign("]" | ")" | "}") => {
                let Some((begin, has_equations)) = open.pop() else { continue };
                if has_equations && words[begin].is("[") {
                    let mut parser = Parser::new(words, Dialect::Julia);
                    parser.go_to(begin);
                    let list = parser.expression()?;
                    let before = |by: usize| begin.checked_sub(by).map(|at| &words[at]);
                    let named = before(1).filter(|word| word.is("=")).and_then(|_| before(2));
                    let measured = named.is_some_and(|word| {
                        let name = word.text.to_lowercase();
                        name.contains("measured") || name.contains("output") || name.contains("observ")
                    });
                    lists.push(Equations { measured, list: list.elements().into_iter().cloned().collect() });
                }
            }
            TokenKind::Sign("@") if words.get(at + 1).is_some_and(|word| word.is_word("equations")) => {
                let mut parser = Parser::new(words, Dialect::Julia);
                parser.go_to(at + 2);
                if !parser.peek().is_word("begin") {
                    return Err(parser.unexpected("'begin'"));
                }
                parser.next();
                let mut list = Vec::new();
                while !parser.peek().is_word("end") && !parser.at_end() {
                    list.push(parser.argument()?);
                    parser.take(";");
                }
                lists.push(Equations { measured: false, list });
            }
            _ => {}
        }
    }
    Ok(lists)
}

/// Whether a token stands in `@equations begin ... end`.
fn within_block(words: &[Token], at: usize) -> bool {
    let begin = words[..at].iter().rposition(|word| word.is_word("equations"));
    begin.is_some_and(|begin| !words[begin..at].iter().any(|word| word.is_word("end")))
}

fn sides(equation: &Syntax) -> Result<(&Syntax, &Syntax), Problem> {
    match &equation.kind {
        SyntaxKind::Equation("~", left, right) => Ok((left, right)),
        _ => Err(Problem::new(Code::Foreign, &equation.span, "this is no equation", "this")
            .help("an equation is left ~ right")),
    }
}

/// The state of `D(x)`.
fn differentiated<'a>(left: &'a Syntax, declared: &Declared) -> Option<&'a str> {
    let SyntaxKind::Call(callee, arguments) = &left.kind else { return None };
    let (operator, [inner]) = (callee.as_name()?, arguments.as_slice()) else { return None };
    if declared.variables.contains(operator) {
        return None;
    }
    variable(inner, declared)
}

/// The variable that `x` or `x(t)` is.
fn variable<'a>(syntax: &'a Syntax, declared: &Declared) -> Option<&'a str> {
    let name = match &syntax.kind {
        SyntaxKind::Name(name) => name,
        SyntaxKind::Call(callee, _) => callee.as_name()?,
        _ => return None,
    };
    declared.variables.contains(name).then_some(name)
}

fn value(syntax: &Syntax, declared: &Declared) -> Result<ForeignExpr, Problem> {
    meaning(syntax, &mut |part| {
        if let Some(name) = variable(part, declared) {
            return Some(Ok(ForeignExpr::name(name, &part.span)));
        }
        match &part.kind {
            SyntaxKind::Name(name) if declared.constants.contains(name) => {
                Some(Ok(ForeignExpr::name(name, &part.span)))
            }
            SyntaxKind::Name(name) => {
                let message = match declared.times.contains(name) {
                    true => format!("time stands by itself: '{name}'"),
                    false => format!("'{name}' is declared neither as a parameter nor as a variable"),
                };
                Some(Err(Problem::new(Code::Foreign, &part.span, message, "this name")
                    .help("declare it with @parameters or @variables; time is a state with D(time) ~ 1")))
            }
            _ => None,
        }
    })
}
