//! What the declarations of a file say: parameters, functions of time, time itself, and what differentiates by it.

use crate::script::{Dialect, Parser, Syntax, SyntaxKind, Token, TokenKind};
use dashu::rational::RBig;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What the declarations of a file say.
#[derive(Default)]
pub(super) struct Declared {
    /// Names with their values.
    pub parameters: Vec<(String, Option<RBig>)>,
    /// Their names.
    pub constants: BTreeSet<String>,
    pub variables: BTreeSet<String>,
    /// What functions are differentiated by, and functions of.
    pub times: BTreeSet<String>,
    /// Names without a bracket among the variables, that are no time.
    pub bare: BTreeSet<String>,
    /// The tokens of the declarations.
    pub blocks: Vec<Range<usize>>,
    /// What differentiates by time: names, and how often.
    operators: BTreeMap<String, usize>,
}

/// What stands for a derivative where no line of the file says what does.
const USUAL_OPERATORS: [&str; 3] = ["D", "Dt", "der"];

/// Higher derivatives are refused.
const MOST_DERIVATIVES: usize = 6;

impl Declared {
    /// All `@parameters` and `@variables`, and `D = Differential(t)`.
    pub fn of(words: &[Token]) -> Result<Declared, Problem> {
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
                declared.declare(&one, is_parameter, is_time)?;
            }
            declared.blocks.push(at..parser.position());
        }
        declared.look_for_operators(words)?;
        // `@parameters t` of older files declares time, and no constant
        let Declared { parameters, constants, times, bare, .. } = &mut declared;
        parameters.retain(|(name, _)| !times.contains(name));
        constants.retain(|name| !times.contains(name));
        if times.is_empty() {
            times.append(bare);
        }
        bare.retain(|name| !times.contains(name));
        Ok(declared)
    }

    fn declare(&mut self, one: &Syntax, is_parameter: bool, is_time: bool) -> Result<(), Problem> {
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
                self.constants.insert(name.clone());
                self.parameters.push((name.clone(), value));
            }
            SyntaxKind::Name(name) if is_time => {
                self.times.insert(name.clone());
            }
            SyntaxKind::Name(name) => {
                self.bare.insert(name.clone());
                if right.is_some() {
                    return Err(Problem::new(
                        Code::Foreign,
                        &one.span,
                        format!("'{name}' is no function of time"),
                        "this",
                    )
                    .help(format!("write {name}(t), or declare it under @parameters")));
                }
            }
            SyntaxKind::Call(callee, arguments) => {
                let (Some(name), [time]) = (callee.as_name(), arguments.as_slice()) else {
                    let message = "a function of several variables is not read";
                    return Err(Problem::new(Code::Foreign, &left.span, message, "this")
                        .help("a model has functions of time alone: x(t)"));
                };
                let Some(time) = time.as_name() else {
                    return Err(Problem::new(Code::Foreign, &time.span, "this is no name of time", "this")
                        .help("variables are declared as functions of time: x(t)"));
                };
                self.times.insert(time.to_owned());
                self.variables.insert(name.to_owned());
            }
            _ => {
                return Err(Problem::new(
                    Code::Foreign,
                    &left.span,
                    "this is no name that can be read",
                    "this",
                )
                .help("vectors of variables are not read: write their elements out"));
            }
        }
        Ok(())
    }

    /// `D = Differential(t)`, `D2 = Differential(t)^2`, `using ModelingToolkit: D_nounits as D`.
    fn look_for_operators(&mut self, words: &[Token]) -> Result<(), Problem> {
        let mut by: BTreeSet<&str> = BTreeSet::new();
        let mut says = false;
        for (at, word) in words.iter().enumerate() {
            let next = |by: usize| &words[(at + by).min(words.len() - 1)];
            let before = |by: usize| at.checked_sub(by).map(|at| &words[at]);
            if word.is_word("D_nounits") {
                says = true;
                let name = if next(1).is_word("as") { &next(2).text } else { &word.text };
                self.operators.insert(name.clone(), 1);
            }
            if word.is_word("t_nounits") {
                let name = if next(1).is_word("as") { &next(2).text } else { &word.text };
                self.times.insert(name.clone());
            }
            if !(word.is_word("Differential") && next(1).is("(") && next(2).kind == TokenKind::Name) {
                continue;
            }
            says = true;
            let time = next(2);
            if by.insert(&time.text) && by.len() > 1 {
                return Err(Problem::new(
                    Code::Foreign,
                    &time.span,
                    format!("'{}' is a second variable to differentiate by", time.text),
                    "this",
                )
                .help("a model has derivatives by time alone"));
            }
            self.times.insert(time.text.clone());
            if !next(3).is(")") {
                let message = "this derivative cannot be read";
                return Err(Problem::new(Code::Foreign, &word.span, message, "this")
                    .help("write D = Differential(t)"));
            }
            let power = match next(4).is("^") && !next(4).newline {
                false => Some(1),
                true => next(5).text.parse::<usize>().ok().filter(|n| (1..=MOST_DERIVATIVES).contains(n)),
            };
            let Some(power) = power else {
                return Err(Problem::new(
                    Code::Foreign,
                    &next(5).span,
                    "this is no number of derivatives",
                    "this",
                )
                .help("write D = Differential(t)"));
            };
            if let (Some(sign), Some(name)) = (before(1), before(2))
                && sign.is("=")
                && name.kind == TokenKind::Name
            {
                self.operators.insert(name.text.clone(), power);
            }
        }
        if !says {
            self.operators.extend(USUAL_OPERATORS.map(|name| (name.to_owned(), 1)));
        }
        Ok(())
    }

    /// How often an operator differentiates: `D`, `D^2`, `Differential(t)`.
    fn order_of(&self, operator: &Syntax) -> Option<usize> {
        match &operator.kind {
            SyntaxKind::Name(name) => self.operators.get(name).copied(),
            SyntaxKind::Call(callee, _) => (callee.as_name()? == "Differential").then_some(1),
            SyntaxKind::Power(inner, power) => {
                let SyntaxKind::Number(power) = &power.kind else { return None };
                let power = usize::try_from(power.is_int().then(|| power.numerator().clone())?).ok()?;
                self.order_of(inner)?.checked_mul(power)
            }
            _ => None,
        }
    }

    /// The variable of `D(x)` or `D(D(x))`, and which derivative of it that is; none where it is no derivative.
    pub fn derivative<'a>(&self, syntax: &'a Syntax) -> Result<Option<(&'a str, usize)>, Problem> {
        let (mut inner, mut order) = (syntax, 0_usize);
        while let SyntaxKind::Call(callee, arguments) = &inner.kind
            && !callee.as_name().is_some_and(|name| self.variables.contains(name))
            && let Some(more) = self.order_of(callee)
            && let [only] = arguments.as_slice()
        {
            order = order.saturating_add(more);
            inner = only;
        }
        if order == 0 {
            return Ok(None);
        }
        let help = "equations are D(x) ~ ... of variables x: name what is differentiated, and write its rate";
        match self.variable(inner)? {
            Some(name) if (1..=MOST_DERIVATIVES).contains(&order) => Ok(Some((name, order))),
            _ => {
                let message = "what is differentiated here is no variable";
                Err(Problem::new(Code::Foreign, &syntax.span, message, "this").help(help))
            }
        }
    }

    /// The variable that `x` or `x(t)` is.
    ///
    /// # Errors
    /// A variable with something else than time in its bracket.
    pub fn variable<'a>(&self, syntax: &'a Syntax) -> Result<Option<&'a str>, Problem> {
        let (name, arguments) = match &syntax.kind {
            SyntaxKind::Name(name) => return Ok(self.variables.contains(name).then_some(name.as_str())),
            SyntaxKind::Call(callee, arguments) => match callee.as_name() {
                Some(name) if self.variables.contains(name) => (name, arguments.as_slice()),
                _ => return Ok(None),
            },
            _ => return Ok(None),
        };
        if let [time] = arguments
            && time.as_name().is_some_and(|time| self.times.contains(time))
        {
            return Ok(Some(name));
        }
        let (mut has_time, mut is_number) = (false, false);
        for argument in arguments {
            is_number |= matches!(argument.kind, SyntaxKind::Number(_));
            argument.names(&mut |name| has_time |= self.times.contains(name));
        }
        let (message, help) = match (has_time, is_number) {
            (true, _) => (
                format!("'{name}' is asked for at another time: delays are not read"),
                "a system with delays has no finite state".to_owned(),
            ),
            (false, true) => (
                format!("'{name}' at a fixed time is not read"),
                "initial conditions are none of the equations: leave them out".to_owned(),
            ),
            _ => (
                format!("'{name}' is a function of time, and something else stands in its bracket"),
                format!("a product is written with '*': {name}*(...)"),
            ),
        };
        Err(Problem::new(Code::Foreign, &syntax.span, message, "this").help(help))
    }
}
