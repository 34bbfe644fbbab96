//! Formulas as SymPy and CasADi print them, and as people write them: a line an equation, or a vector of rates.
//!
//! | written | means |
//! |---|---|
//! | `x' = e`, `dx/dt = e`, `Derivative(x(t), t) = e`, `Eq(Derivative(x(t), t), e)` | a rate |
//! | `{x(t): e, ...}`, `[Eq(...), ...]` | rates, each with its name |
//! | `Matrix([[e], [e]])`, `[e, e]`, `f = [e, e]` | rates in the order of the states, which `states: x, y` or the question names |
//! | a second such vector, `h = [e, e]`, `outputs: e, e` | outputs |
//! | `name = e`, `@1=e, ...` | a definition |
//! | `parameters:`, `known:`, `inputs:`, `unknown inputs:`, `title:`, `source:` | what else is known, in lines of their own |

mod headers;
mod names;
mod pieces;

use crate::expression::{ForeignExpr, ForeignKind, Span};
use crate::functions::{constant, names_a_function, takes_one};
use crate::model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate};
use crate::script::{Dialect, Parser, Syntax, SyntaxKind, made_number, meaning, named_function, tokens};
use headers::{Listed, expressions_in, names_in, without_headers};
use names::{look_at_others, look_for_unknown, no_left, outputs_by_use};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use pieces::{LONG_TIME, TIME, differentiated, is_equation, symbol, vector};
use std::collections::{BTreeMap, BTreeSet};

/// Roles of names that the text does not give.
#[derive(Clone, Debug, Default)]
pub struct PrintedRoles {
    /// The states in the order of a vector of rates.
    pub states: Vec<String>,
    /// What is measured: names, or expressions.
    pub outputs: Vec<String>,
    /// Functions of time that are inputs.
    pub inputs: Vec<String>,
}

/// Reads formulas.
pub(crate) fn read(text: &str, roles: &PrintedRoles, budget: &Budget) -> Result<ForeignModel, Problem> {
    let (body, headers) = without_headers(text)?;
    let (words, comments) = tokens(&body, Dialect::Printed, budget)?;
    let mut reading = Reading::new(budget);
    for (header, list) in [("states", &mut reading.states), ("parameters", &mut reading.parameters)] {
        let names = names_in(text, headers.get(header), budget)?;
        list.extend(names.iter().map(|(name, _)| name.clone()));
        reading.listed.extend(names.into_iter().filter(|_| header != "states"));
    }
    for (header, list) in [
        ("known", &mut reading.known),
        ("inputs", &mut reading.inputs),
        ("unknown inputs", &mut reading.unknown_inputs),
    ] {
        let names = names_in(text, headers.get(header), budget)?;
        list.extend(names.iter().map(|(name, _)| name.clone()));
        reading.listed.extend(names);
    }
    if !roles.states.is_empty() {
        reading.states = roles.states.clone();
    }
    reading.look_for_names(&words);
    let mut parser = Parser::new(&words, Dialect::Printed);
    while !parser.at_end() {
        let begin = parser.position();
        reading.line(&mut parser)?;
        if !(parser.at_end() || parser.peek().newline) || parser.position() == begin {
            return Err(parser.unexpected("the end of the line"));
        }
    }
    reading.refuse_signals(roles)?;
    let mut equations = reading.names_of_equations(roles);
    if let Some(span) = headers.get("outputs") {
        if !reading.outputs.is_empty() {
            let message = "the outputs are given twice: by a vector, and here";
            return Err(
                Problem::new(Code::Foreign, span, message, "the second time").help("take one of the two out")
            );
        }
        reading.outputs = expressions_in(text, span, budget)?
            .iter()
            .map(|one| reading.value(one))
            .collect::<Result<_, _>>()?;
        for output in &reading.outputs {
            look_for_unknown(output, &equations)?;
        }
    }
    for wanted in &roles.outputs {
        let (words, _) = tokens(wanted, Dialect::Printed, budget)?;
        let mut parser = Parser::new(&words, Dialect::Printed);
        let one = parser.expression().and_then(|one| match parser.at_end() {
            true => reading.value(&one).and_then(|one| look_for_unknown(&one, &equations).map(|()| one)),
            false => Err(parser.unexpected("one expression")),
        });
        match one {
            Ok(one) => reading.asked_outputs.push(ForeignExpr { span: 0..0, ..one }),
            Err(why) => {
                let message = format!("the output '{wanted}' cannot be read: {}", why.message);
                let help =
                    why.help.as_deref().unwrap_or("an output is a name or an expression of the file's names");
                return Err(
                    Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file").help(help)
                );
            }
        }
    }
    for output in reading.outputs.iter().chain(&reading.asked_outputs) {
        output.names(&mut |name, _| {
            equations.used.insert(name.to_owned());
        });
    }
    if let Some((name, span)) = reading.listed.iter().find(|(name, _)| !equations.used.contains(name)) {
        let message = format!("'{name}' stands in no equation and in no output");
        return Err(Problem::new(Code::Foreign, span, message, "this name").help(equations.advice(name)));
    }
    let mut model = reading.model(text)?;
    let header = |name: &str| headers.get(name).map(|span| text[span.clone()].trim().to_owned());
    model.title = header("title");
    let begin = words.first().map_or(0, |word| word.span.start);
    model.source = header("source").or_else(|| crate::heading(text, &comments, begin));
    Ok(model)
}

struct Reading<'b> {
    /// What shared parts may cost that are put in where they are used.
    budget: &'b Budget,
    states: Vec<String>,
    parameters: Vec<String>,
    known: Vec<String>,
    inputs: Vec<String>,
    unknown_inputs: Vec<String>,
    rates: Vec<ForeignRate>,
    definitions: Vec<(String, ForeignExpr)>,
    outputs: Vec<ForeignExpr>,
    asked_outputs: Vec<ForeignExpr>,
    /// Names that are written as functions of time, or assigned to.
    declared: BTreeSet<String>,
    /// Names that are written as functions of time, where they are met first.
    signals: BTreeMap<String, Span>,
    /// Names in lists of parameters and inputs, with their places.
    listed: Vec<Listed>,
    /// What CasADi's `@1` are in this line: names of definitions, or conditions themselves.
    shared: BTreeMap<String, ForeignExpr>,
    lines: usize,
    vectors: usize,
    /// The names that have a rate, and those that have a definition.
    rated: BTreeSet<String>,
    defined: BTreeSet<String>,
}

impl<'b> Reading<'b> {
    fn new(budget: &'b Budget) -> Reading<'b> {
        Reading {
            budget,
            states: Vec::new(),
            parameters: Vec::new(),
            known: Vec::new(),
            inputs: Vec::new(),
            unknown_inputs: Vec::new(),
            rates: Vec::new(),
            definitions: Vec::new(),
            outputs: Vec::new(),
            asked_outputs: Vec::new(),
            declared: BTreeSet::new(),
            signals: BTreeMap::new(),
            listed: Vec::new(),
            shared: BTreeMap::new(),
            lines: 0,
            vectors: 0,
            rated: BTreeSet::new(),
            defined: BTreeSet::new(),
        }
    }

    fn line(&mut self, parser: &mut Parser<'_>) -> Result<(), Problem> {
        self.lines += 1;
        self.shared.clear();
        loop {
            let one = parser.argument()?;
            self.statement(&one)?;
            let goes_on = parser.take(",") || parser.take(";");
            if !goes_on || parser.at_end() || parser.peek().newline && !self.shared_goes_on(&one) {
                return Ok(());
            }
        }
    }

    /// Whether what was read is one of CasADi's `@1=...,`, behind which the line may be broken.
    fn shared_goes_on(&self, one: &Syntax) -> bool {
        matches!(&one.kind, SyntaxKind::Equation("=", left, _) if left.as_name().is_some_and(|name| name.starts_with('@')))
    }

    /// What stands in `SX(@1=sin(x), [@1, y])` or `SX(x*y)`, as CasADi shows it: its shared parts are read, and the last one is what it is.
    fn unwrapped<'s>(&mut self, one: &'s Syntax) -> Result<&'s Syntax, Problem> {
        let Some(("SX" | "MX" | "DM", [shared @ .., last])) = named_function(one) else { return Ok(one) };
        if !shared.iter().all(|part| self.shared_goes_on(part)) {
            return Ok(one);
        }
        shared.iter().try_for_each(|part| self.statement(part))?;
        Ok(last)
    }

    fn statement(&mut self, one: &Syntax) -> Result<(), Problem> {
        let one = self.unwrapped(one)?;
        if let Some(("Eq" | "Equality", [left, right])) = named_function(one) {
            return self.equation(left, right);
        }
        match &one.kind {
            SyntaxKind::Equation("=", left, right) => self.equation(left, right),
            SyntaxKind::Pairs(pairs) => {
                for (left, right) in pairs {
                    let value = self.value(right)?;
                    let name = differentiated(left).or_else(|| symbol(left)).ok_or_else(|| no_left(left))?;
                    self.rate(&name, value, &left.span)?;
                }
                Ok(())
            }
            _ => match vector(one) {
                Some(list) if !list.is_empty() && list.iter().all(|part| is_equation(part)) => {
                    list.into_iter().try_for_each(|part| self.statement(part))
                }
                Some(list) => {
                    self.vectors += 1;
                    match self.vectors {
                        1 if self.rates.is_empty() => self.all_rates(&list, &one.span),
                        1 | 2 => self.all_outputs(&list),
                        _ => Err(Problem::new(Code::Foreign, &one.span, "a third vector", "this")
                            .help("a vector of rates, and then one of outputs")),
                    }
                }
                // one state alone
                None if self.states.len() == 1 && self.rates.is_empty() => self.all_rates(&[one], &one.span),
                None => Err(Problem::new(Code::Foreign, &one.span, "nothing says what this is", "this").help(
                    "a rate is x' = e, a definition name = e; a vector of rates needs 'states: x, y' or --state x,y",
                )),
            },
        }
    }

    fn equation(&mut self, left: &Syntax, right: &Syntax) -> Result<(), Problem> {
        let right = self.unwrapped(right)?;
        if let Some(state) = differentiated(left) {
            let value = self.value(right)?;
            return self.rate(&state, value, &left.span);
        }
        let name = symbol(left).ok_or_else(|| no_left(left))?;
        if let Some(list) = vector(right) {
            return match name.as_str() {
                "f" | "rhs" | "ode" | "xdot" | "dx" | "dxdt" => self.all_rates(&list, &right.span),
                "h" | "y" | "outputs" if !self.outputs.is_empty() => Err(Problem::new(
                    Code::Foreign,
                    &left.span,
                    "the outputs are given twice",
                    "the second time",
                )
                .help("put all of them into one vector")),
                "h" | "y" | "outputs" => self.all_outputs(&list),
                "x" | "states" if self.states.is_empty() => {
                    let names = list.iter().map(|one| symbol(one).ok_or_else(|| no_left(one)));
                    self.states = names.collect::<Result<_, _>>()?;
                    Ok(())
                }
                _ => Err(Problem::new(
                    Code::Foreign,
                    &left.span,
                    format!("nothing says what the vector '{name}' is"),
                    "this",
                )
                .help("a vector of rates is called f, one of outputs h, one of states x")),
            };
        }
        let value = self.value(right)?;
        if let Some(number) = name.strip_prefix('@') {
            // a condition is put where it is asked for, everything else gets a name
            if matches!(value.kind, ForeignKind::Case { .. }) {
                self.shared.insert(name, value);
                return Ok(());
            }
            let mut own = name.clone();
            if !self.defined.insert(own.clone()) {
                own = format!("@{number}_{}", self.lines);
                self.defined.insert(own.clone());
            }
            self.shared.insert(name, ForeignExpr::name(&own, &left.span));
            self.definitions.push((own, value));
            return Ok(());
        }
        if !self.defined.insert(name.clone()) {
            return Err(Problem::new(
                Code::Foreign,
                &left.span,
                format!("'{name}' has two equations"),
                "the second one",
            )
            .help("take one of them out"));
        }
        self.definitions.push((name, value));
        Ok(())
    }

    fn rate(&mut self, name: &str, rate: ForeignExpr, span: &Span) -> Result<(), Problem> {
        if !self.rated.insert(name.to_owned()) {
            return Err(Problem::new(
                Code::Foreign,
                span,
                format!("'{name}' has two rates"),
                "the second one",
            )
            .help("take one of them out"));
        }
        self.rates.push(ForeignRate { name: name.to_owned(), rate, span: span.clone() });
        Ok(())
    }

    fn all_rates(&mut self, list: &[&Syntax], span: &Span) -> Result<(), Problem> {
        if list.len() != self.states.len() {
            let message = match self.states.len() {
                0 => format!("a vector of {} rates, and nothing says of which states", list.len()),
                count => format!("{} rates, and {count} states", list.len()),
            };
            return Err(Problem::new(Code::Foreign, span, message, "these rates")
                .help("name the states in this order: a line 'states: x, y', or --state x,y"));
        }
        let states = self.states.clone();
        for (name, one) in states.iter().zip(list) {
            let value = self.value(one)?;
            self.rate(name, value, &one.span)?;
        }
        Ok(())
    }

    fn all_outputs(&mut self, list: &[&Syntax]) -> Result<(), Problem> {
        for one in list {
            let value = self.value(one)?;
            self.outputs.push(value);
        }
        Ok(())
    }

    fn value(&self, syntax: &Syntax) -> Result<ForeignExpr, Problem> {
        meaning(syntax, &mut |part| self.special(part))
    }

    fn special(&self, part: &Syntax) -> Option<Result<ForeignExpr, Problem>> {
        let span = &part.span;
        if let SyntaxKind::Power(base, _) = &part.kind
            && base.as_name() == Some("e")
            && !self.declared.contains("e")
        {
            let message = "'e' may be Euler's number or a name";
            return Some(Err(Problem::new(Code::Foreign, &base.span, message, "this")
                .help("write exp(...), or name it in a line such as 'parameters: e'")));
        }
        if let Some(name) = symbol(part) {
            if let Some(shared) = self.shared.get(&name) {
                let paid = self.budget.nodes(shared.size());
                let paid = paid.map_err(|spent| crate::too_much(span, spent));
                return Some(paid.map(|()| ForeignExpr { span: span.clone(), ..shared.clone() }));
            }
            let missing = |what: &str, help: &str| {
                Some(Err(Problem::new(Code::Foreign, span, what.to_owned(), "this").help(help)))
            };
            return match name.as_str() {
                _ if self.declared.contains(&name) => Some(Ok(ForeignExpr::name(name, span))),
                "E" => missing(
                    "'E' may be Euler's number or a name",
                    "write exp(1), or name it in a line such as 'parameters: E'",
                ),
                "I" => missing(
                    "'I' may be the imaginary unit or a name",
                    "there are no complex numbers; name it in a line such as 'parameters: I'",
                ),
                "EulerGamma" | "Catalan" | "GoldenRatio" | "TribonacciConstant" => missing(
                    &format!("'{name}' is a number in SymPy"),
                    "write its digits, or name it in a line such as 'known: c'",
                ),
                "oo" | "zoo" | "∞" | "True" | "False" | "true" | "false" => {
                    missing(&format!("'{name}' is no number"), "write what is meant")
                }
                _ if ["nan", "inf", "infinity"].contains(&name.to_lowercase().as_str()) => {
                    missing(&format!("'{name}' is no number"), "write what is meant")
                }
                // numbers of other programs, that would be symbols of these names here
                "Pi" | "PI" | "M_PI" => missing(
                    &format!("'{name}' may be the number pi or a name"),
                    &format!("write pi, or name it in a line such as 'parameters: {name}'"),
                ),
                "ℯ" | "M_E" => missing(
                    &format!("'{name}' may be Euler's number or a name"),
                    &format!("write exp(1), or name it in a line such as 'parameters: {name}'"),
                ),
                "ⅈ" | "ⅉ" | "im" => missing(
                    &format!("'{name}' may be the imaginary unit or a name"),
                    &format!("there are no complex numbers; name it in a line such as 'parameters: {name}'"),
                ),
                // exp^(-x), sin^2*x: what it is of stands somewhere else, or nowhere
                _ if names_a_function(&name) => missing(
                    &format!("'{name}' is a function, and no bracket stands behind it"),
                    &format!("write {name}(...), or name it in a line such as 'parameters: {name}'"),
                ),
                _ if name.starts_with('@') => {
                    missing(&format!("nothing says what '{name}' is"), "its line says it before")
                }
                _ => Some(Ok(constant(&name, span).unwrap_or_else(|| ForeignExpr::name(name, span)))),
            };
        }
        let all = |list: &[Syntax]| list.iter().map(|one| self.value(one)).collect::<Result<Vec<_>, _>>();
        let (name, arguments) = named_function(part)?;
        Some(match (name, arguments) {
            ("Add", list) if !list.is_empty() => all(list).map(|list| {
                ForeignExpr::new(ForeignKind::Sum(list.into_iter().map(|one| (false, one)).collect()), span)
            }),
            ("Mul", list) if !list.is_empty() => all(list).map(|list| {
                ForeignExpr::new(
                    ForeignKind::Product(list.into_iter().map(|one| (false, one)).collect()),
                    span,
                )
            }),
            ("Pow", [base, exponent]) => self.value(base).and_then(|base| Ok(base.to(self.value(exponent)?))),
            ("Integer" | "Float", [Syntax { kind: SyntaxKind::Text(text), span: place }, rest @ ..]) => {
                ForeignExpr::number(text, place).and_then(|value| made_number(name, value, rest, span))
            }
            ("Integer" | "Float", [value, rest @ ..]) => {
                self.value(value).and_then(|value| made_number(name, value, rest, span))
            }
            ("Derivative" | "diff", _) => {
                Err(Problem::new(Code::Foreign, span, "a derivative stands in an expression", "this")
                    .help("put its equation in its place: only states may be differentiated, on the left"))
            }
            // of a name that is no function: a delay, or a product
            (_, [argument])
                if matches!(&part.kind, SyntaxKind::Call(callee, _) if callee.as_name().is_some())
                    && self.declared.contains(name)
                    && !takes_one(name) =>
            {
                let mut has_time = false;
                argument.names(&mut |name| has_time |= name == TIME);
                let (message, help) = match has_time {
                    true => (
                        format!("'{name}' is asked for at another time: delays are not read"),
                        "a system with delays has no finite state".to_owned(),
                    ),
                    false => (
                        format!("'{name}' is no function, and a bracket stands behind it"),
                        format!("a product is written with '*': {name}*(...)"),
                    ),
                };
                Err(Problem::new(Code::Foreign, span, message, "this").help(help))
            }
            _ => return None,
        })
    }

    fn model(self, text: &str) -> Result<ForeignModel, Problem> {
        let mut model = ForeignModel {
            states: self.rates,
            definitions: self.definitions,
            known_inputs: self.inputs,
            unknown_inputs: self.unknown_inputs,
            ..ForeignModel::default()
        };
        if let Some((name, value)) = model.definitions.iter().find_map(|(name, value)| {
            let stem = name.strip_suffix("dot").or_else(|| name.strip_prefix('d'))?;
            let stem = stem.trim_end_matches('_').to_owned();
            (model.states.is_empty() && !stem.is_empty()).then_some((stem, value))
        }) {
            return Err(Problem::new(
                Code::Foreign,
                &value.span,
                "the file has no rates, and this may be one",
                "this",
            )
            .help(format!("a rate is written {name}' = ... or d{name}/dt = ...")));
        }
        if model.states.is_empty() && text.trim().is_empty() {
            return Err(Problem::new(
                Code::Foreign,
                &(0..text.len().min(1)),
                "the file is empty",
                "the file",
            )
            .help("a rate is x' = e, a line each"));
        }
        if model.states.is_empty() {
            return Err(Problem::new(Code::Foreign, &(0..text.len().min(1)), "the file has no rates", "the file")
                .help("a rate is x' = e, dx/dt = e or Eq(Derivative(x(t), t), e); a vector of rates needs 'states: x, y'"));
        }
        if let Some(missing) = self.states.iter().find(|name| !self.rated.contains(*name)) {
            return Err(Problem::new(
                Code::Foreign,
                &(0..text.len().min(1)),
                format!("the state '{missing}' has no rate"),
                "the file",
            )
            .help(format!("write {missing}' = ...")));
        }
        let moved: BTreeSet<String> = model.states.iter().map(|state| state.name.clone()).collect();
        if let Some((name, value)) = model.definitions.iter().find(|(name, _)| moved.contains(name)) {
            return Err(Problem::new(
                Code::Foreign,
                &value.span,
                format!("'{name}' is a state, and is defined here"),
                "this",
            )
            .help("take one of its two equations out"));
        }
        let outputs = if self.asked_outputs.is_empty() { self.outputs } else { self.asked_outputs };
        model.outputs = outputs.into_iter().map(|value| ForeignOutput { name: None, value }).collect();
        if model.outputs.is_empty() {
            outputs_by_use(&mut model);
        }
        let constant = |name: &String, is_unknown: bool| ForeignConstant {
            name: name.clone(),
            value: None,
            is_unknown,
            may_be_unknown: true,
        };
        model.constants = self.parameters.iter().map(|name| constant(name, true)).collect();
        model.constants.extend(self.known.iter().map(|name| constant(name, false)));
        let names = model.all_names();
        let listed = model.constants.len();
        model.declare_others(self.parameters.is_empty());
        // time by either of its names, where nothing else is called so
        let is_time = |constant: &ForeignConstant| {
            [TIME, LONG_TIME].contains(&constant.name.as_str()) && !names.contains(&constant.name)
        };
        let clocks: Vec<String> =
            model.constants.iter().filter(|one| is_time(one)).map(|one| one.name.clone()).collect();
        if clocks.len() > 1 {
            let message = format!("'{TIME}' and '{LONG_TIME}' stand in the equations, and both may be time");
            return Err(Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file").help(
                format!(
                    "call time {TIME}, or name the other one in a line such as 'parameters: {LONG_TIME}'"
                ),
            ));
        }
        model.constants.retain(|constant| !is_time(constant));
        if let Some(clock) = clocks.first() {
            model.add_clock(clock);
        }
        look_at_others(&mut model, listed, self.parameters.is_empty())?;
        Ok(model)
    }
}
