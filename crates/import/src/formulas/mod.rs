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
mod pieces;

use crate::expression::{ForeignExpr, ForeignKind, Span};
use crate::functions::constant;
use crate::model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate};
use crate::script::{Dialect, Parser, Syntax, SyntaxKind, Token, meaning, named_function, tokens};
use headers::{expressions_in, names_in, without_headers};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use pieces::{TIME, differentiated, is_equation, symbol, vector};
use std::collections::{BTreeMap, BTreeSet};

/// Roles of names that the text does not give.
#[derive(Clone, Debug, Default)]
pub struct PrintedRoles {
    /// The states in the order of a vector of rates.
    pub states: Vec<String>,
    /// What is measured: names, or expressions.
    pub outputs: Vec<String>,
}

/// Reads formulas.
pub(crate) fn read(text: &str, roles: &PrintedRoles, budget: &Budget) -> Result<ForeignModel, Problem> {
    let (body, headers) = without_headers(text)?;
    let (words, comments) = tokens(&body, Dialect::Printed, budget)?;
    let mut reading = Reading::new(budget);
    for (header, list) in [("states", &mut reading.states), ("parameters", &mut reading.parameters)] {
        list.extend(names_in(text, headers.get(header), budget)?);
    }
    reading.known = names_in(text, headers.get("known"), budget)?;
    reading.inputs = names_in(text, headers.get("inputs"), budget)?;
    reading.unknown_inputs = names_in(text, headers.get("unknown inputs"), budget)?;
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
    if let Some(span) = headers.get("outputs") {
        reading.outputs = expressions_in(text, span, budget)?
            .iter()
            .map(|one| reading.value(one))
            .collect::<Result<_, _>>()?;
    }
    for wanted in &roles.outputs {
        let (words, _) = tokens(wanted, Dialect::Printed, budget)?;
        let mut parser = Parser::new(&words, Dialect::Printed);
        let one = parser.expression().and_then(|one| match parser.at_end() {
            true => reading.value(&one),
            false => Err(parser.unexpected("one expression")),
        });
        match one {
            Ok(one) => reading.asked_outputs.push(ForeignExpr { span: 0..0, ..one }),
            Err(why) => {
                let message = format!("the output '{wanted}' cannot be read: {}", why.message);
                return Err(Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file")
                    .help("an output is a name or an expression of the file's names"));
            }
        }
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
            shared: BTreeMap::new(),
            lines: 0,
            vectors: 0,
            rated: BTreeSet::new(),
            defined: BTreeSet::new(),
        }
    }

    fn look_for_names(&mut self, words: &[Token]) {
        for three in words.windows(4) {
            if three[1].is("(") && three[2].is_word(TIME) && three[3].is(")") {
                self.declared.insert(three[0].text.clone());
            }
        }
        for two in words.windows(2) {
            if two[1].is("=") || two[1].is("'") {
                self.declared.insert(two[0].text.clone());
            }
        }
        let headers = [&self.states, &self.parameters, &self.known, &self.inputs, &self.unknown_inputs];
        self.declared.extend(headers.into_iter().flatten().cloned());
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

    fn statement(&mut self, one: &Syntax) -> Result<(), Problem> {
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
        if let Some(state) = differentiated(left) {
            let value = self.value(right)?;
            return self.rate(&state, value, &left.span);
        }
        let name = symbol(left).ok_or_else(|| no_left(left))?;
        if let Some(list) = vector(right) {
            return match name.as_str() {
                "f" | "rhs" | "ode" | "xdot" | "dx" | "dxdt" => self.all_rates(&list, &right.span),
                "h" | "y" | "outputs" | "g" => self.all_outputs(&list),
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
                "oo" | "zoo" | "nan" | "inf" | "True" | "False" => {
                    missing(&format!("'{name}' is no number"), "write what is meant")
                }
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
            ("Integer" | "Float", [Syntax { kind: SyntaxKind::Text(text), span }, ..]) => {
                ForeignExpr::number(text, span)
            }
            ("Integer" | "Float", [value, ..]) => self.value(value),
            ("Derivative" | "diff", _) => {
                Err(Problem::new(Code::Foreign, span, "a derivative stands in an expression", "this")
                    .help("put its equation in its place: only states may be differentiated, on the left"))
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
        let is_time = !names.iter().any(|name| name == TIME);
        model.declare_others(self.parameters.is_empty());
        let before = model.constants.len();
        model.constants.retain(|constant| !is_time || constant.name != TIME);
        if model.constants.len() < before {
            model.add_clock(TIME);
        }
        Ok(model)
    }
}

/// Definitions that nothing uses are what is measured.
fn outputs_by_use(model: &mut ForeignModel) {
    let mut used = BTreeSet::new();
    let mut look = |value: &ForeignExpr| {
        value.names(&mut |name, _| {
            used.insert(name.to_owned());
        });
    };
    model.states.iter().for_each(|state| look(&state.rate));
    model.definitions.iter().for_each(|(_, value)| look(value));
    let (free, others): (Vec<_>, Vec<_>) =
        model.definitions.drain(..).partition(|(name, _)| !used.contains(name) && !name.starts_with('@'));
    model.definitions = others;
    if !free.is_empty() {
        let names: Vec<&str> = free.iter().map(|(name, _)| name.as_str()).collect();
        model
            .remarks
            .push(format!("outputs are the definitions that nothing else uses: {}", names.join(", ")));
    }
    model.outputs = free.into_iter().map(|(name, value)| ForeignOutput { name: Some(name), value }).collect();
}

fn no_left(syntax: &Syntax) -> Problem {
    Problem::new(Code::Foreign, &syntax.span, "this is no name and no derivative of one", "this")
        .help("an equation has x', dx/dt, Derivative(x(t), t) or a name on its left")
}
