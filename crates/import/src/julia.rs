//! `@ODEmodel(...)` and `@DDSmodel(...)` of StructuralIdentifiability.jl.

use super::expression::{ForeignExpr, Span};
use super::file_functions::FileFunctions;
use super::functions::{is_function, takes_one};
use super::model::{ForeignModel, ForeignOutput, ForeignRate};
use super::script::{Dialect, Parser, Syntax, SyntaxKind, Token, TokenKind, meaning, tokens};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::BTreeSet;

/// A model in a file: where its macro stands, and how it is called.
struct Found {
    /// The place of the token `@`.
    at: usize,
    name: Option<String>,
    span: Span,
}

/// Reads the model of a file, or the one of several that has a name or number.
pub(super) fn read(text: &str, which: Option<&str>, budget: &Budget) -> Result<ForeignModel, Problem> {
    let (words, comments) = tokens(text, Dialect::Julia, budget)?;
    let found = models(&words);
    if found.is_empty() {
        return super::toolkit::read(text, &words, &comments, which, budget);
    }
    let one = chosen(text, &found, which)?;
    let mut parser = Parser::new(&words, Dialect::Julia);
    parser.go_to(one.at + 2);
    let equations = parser.bracketed()?;
    let is_discrete = words[one.at + 1].text == "DDSmodel";
    let functions = FileFunctions::of(&words);
    let mut model = of_equations(&equations, is_discrete, &one.span, &functions)?;
    // what a name in the source says of a model is often no more than that it is one
    let says = |name: &&String| !["ode", "odes", "model", "sys", "system", "eqs"].contains(&name.as_str());
    model.title = one.name.as_ref().filter(says).cloned();
    model.source = super::heading(text, &comments, one.span.start);
    Ok(model)
}

fn models(words: &[Token]) -> Vec<Found> {
    let is_macro = |at: &usize| {
        words[*at].is("@")
            && words.get(at + 1).is_some_and(|word| word.is_word("ODEmodel") || word.is_word("DDSmodel"))
            && words.get(at + 2).is_some_and(|word| word.is("("))
    };
    let mut found = Vec::new();
    for at in (0..words.len()).filter(is_macro) {
        let back = |by: usize| at.checked_sub(by).map(|at| &words[at]);
        // `ode = @ODEmodel(`, or `:name => "...", :ode => @ODEmodel(`
        let assigned = back(1).filter(|word| word.is("=")).and_then(|_| back(2));
        let name = match assigned {
            Some(word) if word.kind == TokenKind::Name => Some(word.text.clone()),
            _ => (1..12).find_map(|by| match (&back(by)?.kind, back(by + 2)?.text.as_str()) {
                (TokenKind::Text(text), "name") => Some(text.clone()),
                _ => None,
            }),
        };
        found.push(Found { at, name, span: words[at].span.start..words[at + 1].span.end });
    }
    found
}

fn chosen<'a>(text: &str, found: &'a [Found], which: Option<&str>) -> Result<&'a Found, Problem> {
    let line = |one: &Found| text[..one.span.start].matches('\n').count() + 1;
    let list = || {
        let list = found.iter().enumerate().map(|(at, one)| {
            let name = one.name.as_deref().map_or(String::new(), |name| format!(" '{name}'"));
            format!("{}{name} (line {})", at + 1, line(one))
        });
        list.take(30).collect::<Vec<_>>().join(", ")
    };
    match which {
        None if found.len() > 1 => {
            let message = format!("the file has {} models", found.len());
            Err(Problem::new(Code::Foreign, &found[1].span, message, "the second one")
                .help(format!("say which with --model NAME or --model NUMBER: {}", list())))
        }
        None => Ok(&found[0]),
        Some(wanted) => {
            let by_number = wanted.parse::<usize>().ok().and_then(|number| found.get(number.checked_sub(1)?));
            let mut same = found.iter().filter(|one| one.name.as_deref() == Some(wanted));
            let by_name = same.next();
            if let Some(second) = same.next() {
                let message = format!("the file has several models '{wanted}'");
                return Err(Problem::new(Code::Foreign, &second.span, message, "another one")
                    .help(format!("say which with --model NUMBER: {}", list())));
            }
            by_name.or(by_number).ok_or_else(|| {
                Problem::new(
                    Code::Foreign,
                    &found[0].span,
                    format!("the file has no model '{wanted}'"),
                    "a model",
                )
                .help(format!("it has {}", list()))
            })
        }
    }
}

/// Names of inputs, in the order in which they are met.
#[derive(Default)]
struct Inputs {
    known: BTreeSet<String>,
    order: Vec<String>,
}

/// What stands on the left of an equation.
enum Left<'a> {
    State(&'a str),
    Output(&'a str),
}

fn left_side<'a>(syntax: &'a Syntax, is_discrete: bool) -> Option<(Left<'a>, &'a str)> {
    let SyntaxKind::Call(callee, arguments) = &syntax.kind else { return None };
    let [time] = arguments.as_slice() else { return None };
    match (&callee.kind, &time.kind) {
        (SyntaxKind::Prime(inner), SyntaxKind::Name(time)) if !is_discrete => {
            Some((Left::State(inner.as_name()?), time))
        }
        (SyntaxKind::Name(name), SyntaxKind::Name(time)) => Some((Left::Output(name), time)),
        (SyntaxKind::Name(name), SyntaxKind::Sum(terms)) if is_discrete => match terms.as_slice() {
            [(false, time), (false, Syntax { kind: SyntaxKind::Number(one), .. })] if one.is_one() => {
                Some((Left::State(name), time.as_name()?))
            }
            _ => None,
        },
        _ => None,
    }
}

fn of_equations(
    equations: &[Syntax],
    is_discrete: bool,
    span: &Span,
    functions: &FileFunctions,
) -> Result<ForeignModel, Problem> {
    let form = if is_discrete { "x(t + 1) = ... and y(t) = ..." } else { "x'(t) = ... and y(t) = ..." };
    let mut sides = Vec::new();
    for equation in equations {
        let wrong = || {
            let (message, help) = match &equation.kind {
                SyntaxKind::Equation(_, left, _) if is_second_derivative(left) => (
                    "a second derivative is not read",
                    "it needs a state of its own: x'(t) = v(t) and v'(t) = ...".to_owned(),
                ),
                SyntaxKind::Equation(_, left, _) if is_initial_value(left) => (
                    "this is no equation of a model",
                    "an initial condition is none of the equations: leave it out".to_owned(),
                ),
                _ => ("this is no equation of a model", format!("a model has lines {form}")),
            };
            Problem::new(Code::Foreign, &equation.span, message, "this").help(help)
        };
        let SyntaxKind::Equation("=", left, right) = &equation.kind else { return Err(wrong()) };
        sides.push((left_side(left, is_discrete).ok_or_else(wrong)?, left.as_ref(), right.as_ref()));
    }
    let Some(((_, time), ..)) = sides.first() else {
        return Err(Problem::new(Code::Foreign, span, "the model has no equations", "this")
            .help(format!("it has lines {form}")));
    };
    let mut moved: BTreeSet<&str> = BTreeSet::new();
    let mut measured: BTreeSet<&str> = BTreeSet::new();
    for ((left, own_time), place, _) in &sides {
        let (name, is_new) = match left {
            Left::State(name) => (name, moved.insert(name)),
            Left::Output(name) => (name, measured.insert(name)),
        };
        if !is_new || moved.contains(name) && measured.contains(name) {
            return Err(Problem::new(
                Code::Foreign,
                &place.span,
                format!("'{name}' has two equations"),
                "the second one",
            )
            .help("take one of them out"));
        }
        if own_time != time {
            return Err(Problem::new(
                Code::Foreign,
                &place.span,
                format!("time is '{time}' above"),
                format!("here it is '{own_time}'"),
            ));
        }
    }
    let mut model = ForeignModel { is_discrete, ..ForeignModel::default() };
    let mut inputs = Inputs::default();
    for ((left, _), place, right) in &sides {
        let value = right_side(right, time, &measured, &moved, &mut inputs, functions)?;
        match left {
            Left::State(name) => {
                model.states.push(ForeignRate {
                    name: (*name).to_owned(),
                    rate: value,
                    span: place.span.clone(),
                });
            }
            Left::Output(name) => model.outputs.push(ForeignOutput { name: Some((*name).to_owned()), value }),
        }
    }
    model.known_inputs = inputs.order;
    model.declare_others(true);
    Ok(model)
}

fn right_side(
    syntax: &Syntax,
    time: &str,
    measured: &BTreeSet<&str>,
    moved: &BTreeSet<&str>,
    inputs: &mut Inputs,
    functions: &FileFunctions,
) -> Result<ForeignExpr, Problem> {
    let is_known = |name: &str| moved.contains(name) || measured.contains(name);
    meaning(syntax, &mut |part| {
        match &part.kind {
        // what is called so in Julia is a number there, and any symbol here
        SyntaxKind::Name(name) if NUMBERS.contains(&name.as_str()) => Some(Err(Problem::new(
            Code::Foreign,
            &part.span,
            format!("'{name}' is a number in Julia, and a parameter by that name for @ODEmodel"),
            "this",
        )
        .help("for the number write 4*atan(1) or exp(1); give a parameter another name; there are no complex numbers"))),
        SyntaxKind::Name(name) if name == time => Some(Err(Problem::new(
            Code::Foreign,
            &part.span,
            format!("time stands by itself: '{name}'"),
            "this",
        )
        .help("make it a state: add the equations time'(t) = 1 and y_time(t) = time(t)"))),
        SyntaxKind::Name(name) if measured.contains(name.as_str()) => Some(Err(Problem::new(
            Code::Foreign,
            &part.span,
            format!("'{name}' is an output, and stands on a right side"),
            "this",
        )
        .help("write what is measured in its place"))),
        SyntaxKind::Name(name) => Some(Ok(ForeignExpr::name(name, &part.span))),
        SyntaxKind::Call(callee, arguments) => match (&callee.kind, arguments.as_slice()) {
            // sin(t) is a function, and no signal
            (SyntaxKind::Name(name), [only])
                if only.as_name() == Some(time) && (is_known(name) || !takes_one(name)) =>
            {
                if let Err(problem) = functions.refuse(part) {
                    return Some(Err(problem));
                }
                if measured.contains(name.as_str()) {
                    return Some(Err(Problem::new(
                        Code::Foreign,
                        &part.span,
                        format!("'{name}' is an output, and stands on a right side"),
                        "this",
                    )
                    .help("write what is measured in its place")));
                }
                if !moved.contains(name.as_str()) && inputs.known.insert(name.clone()) {
                    inputs.order.push(name.clone());
                }
                Some(Ok(ForeignExpr::name(name, &part.span)))
            }
            (SyntaxKind::Name(name), [only]) if is_known(name) || !is_function(name) && mentions(only, time) => {
                let (message, help) = match mentions(only, time) {
                    true => (
                        format!("'{name}' is asked for at another time: delays are not read"),
                        "a system with delays has no finite state".to_owned(),
                    ),
                    false => (
                        format!("'{name}' is a function of time, and something else stands in its bracket"),
                        format!("a product is written with '*': {name}({time})*(...)"),
                    ),
                };
                Some(Err(Problem::new(Code::Foreign, &part.span, message, "this").help(help)))
            }
            _ => functions.refuse(part).err().map(Err),
        },
        _ => None,
    }
    })
}

/// Names of numbers in Julia.
const NUMBERS: [&str; 4] = ["π", "pi", "ℯ", "im"];

/// Whether time stands in an expression, otherwise than in `x(t)`.
fn mentions(syntax: &Syntax, time: &str) -> bool {
    match &syntax.kind {
        SyntaxKind::Name(name) => name == time,
        SyntaxKind::Sum(list) | SyntaxKind::Product(list) => list.iter().any(|(_, one)| mentions(one, time)),
        _ => false,
    }
}

/// `x''(t)`
fn is_second_derivative(left: &Syntax) -> bool {
    let SyntaxKind::Call(callee, _) = &left.kind else { return false };
    matches!(&callee.kind, SyntaxKind::Prime(inner) if matches!(inner.kind, SyntaxKind::Prime(_)))
}

/// `x(0)`
fn is_initial_value(left: &Syntax) -> bool {
    matches!(&left.kind, SyntaxKind::Call(_, arguments)
        if matches!(arguments.as_slice(), [Syntax { kind: SyntaxKind::Number(_), .. }]))
}
