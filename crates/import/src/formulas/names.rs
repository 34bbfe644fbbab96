//! Names of formulas: which are declared, which are functions of time, and which stand in no equation.

use super::pieces::{LONG_TIME, TIME, is_higher_derivative};
use super::{PrintedRoles, Reading};
use crate::expression::{ForeignExpr, Span};
use crate::functions::takes_one;
use crate::model::{ForeignModel, ForeignOutput};
use crate::script::{Syntax, SyntaxKind, Token, TokenKind};
use palmistry_lang::{Code, Problem, nearest};
use std::collections::{BTreeMap, BTreeSet};

impl Reading<'_> {
    pub(super) fn look_for_names(&mut self, words: &[Token]) {
        let mut signal = |name: &str, span: &Span| {
            self.declared.insert(name.to_owned());
            self.signals.entry(name.to_owned()).or_insert_with(|| span.clone());
        };
        for four in words.windows(4) {
            // sin(t) is a function of time that everybody knows
            let is_signal = four[0].kind == TokenKind::Name
                && four[1].is("(")
                && four[2].is_word(TIME)
                && four[3].is(")")
                && !takes_one(&four[0].text);
            if is_signal {
                signal(&four[0].text, &four[0].span);
            }
        }
        // Function('x')(Symbol('t'))
        for eight in words.windows(8) {
            let is_call = eight[1].is("(") && eight[3].is(")") && eight[4].is("(") && eight[6].is("(");
            if let (TokenKind::Text(name), TokenKind::Text(time)) = (&eight[2].kind, &eight[7].kind)
                && is_call
                && eight[0].is_word("Function")
                && eight[5].is_word("Symbol")
                && time == TIME
            {
                signal(name, &eight[2].span);
            }
        }
        for three in words.windows(3) {
            let is_rate = three[0].is_word("Derivative") || three[0].is_word("diff");
            if is_rate && three[1].is("(") && three[2].kind == TokenKind::Name {
                self.declared.insert(three[2].text.clone());
            }
            if (three[0].is("{") || three[0].is(",")) && three[2].is(":") {
                self.declared.insert(three[1].text.clone());
            }
            if three[1].is("/") && three[2].is_word("dt") {
                self.declared.extend(three[0].text.strip_prefix('d').map(str::to_owned));
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

    /// Refuses functions of time of which nothing says what they are.
    pub(super) fn refuse_signals(&self, roles: &PrintedRoles) -> Result<(), Problem> {
        let lists =
            [&self.states, &self.parameters, &self.known, &self.inputs, &self.unknown_inputs, &roles.inputs];
        let listed: BTreeSet<&String> = lists.into_iter().flatten().collect();
        let is_said =
            |name: &String| self.rated.contains(name) || self.defined.contains(name) || listed.contains(name);
        match self.signals.iter().filter(|(name, _)| !is_said(name)).min_by_key(|(_, span)| span.start) {
            Some((name, span)) => {
                let message = format!("'{name}' is a function of time, and has no equation");
                Err(Problem::new(Code::Foreign, span, message, "this").help(format!(
                    "say what it is in a line 'inputs: {name}', or 'unknown inputs: {name}'; a constant is written {name}"
                )))
            }
            None => Ok(()),
        }
    }

    pub(super) fn names_of_equations(&self, roles: &PrintedRoles) -> EquationNames {
        let mut used: BTreeSet<String> = self.rated.union(&self.defined).cloned().collect();
        let mut look = |value: &ForeignExpr| {
            value.names(&mut |name, _| {
                used.insert(name.to_owned());
            });
        };
        self.rates.iter().for_each(|rate| look(&rate.rate));
        self.definitions.iter().for_each(|(_, value)| look(value));
        self.outputs.iter().for_each(look);
        let mut all = used.clone();
        all.extend(self.listed.iter().map(|(name, _)| name.clone()));
        all.extend(roles.inputs.iter().cloned());
        EquationNames { used, all }
    }
}

/// The names that a file's equations have.
pub(super) struct EquationNames {
    /// Those that stand in rates, definitions and vectors.
    pub used: BTreeSet<String>,
    /// Those, and what lists say besides.
    pub all: BTreeSet<String>,
}

impl EquationNames {
    /// What to do about a name that they do not have.
    pub fn advice(&self, name: &str) -> String {
        match nearest(name, self.used.iter().map(String::as_str).filter(|own| *own != name)) {
            Some(other) => format!("perhaps '{other}' is meant"),
            None => {
                let own = self.used.iter().map(String::as_str).filter(|own| !own.starts_with('@'));
                format!("the equations have {}", own.take(40).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

/// Refuses an output that names what no equation has and no list.
pub(super) fn look_for_unknown(output: &ForeignExpr, equations: &EquationNames) -> Result<(), Problem> {
    let mut bad = None;
    output.names(&mut |name, span| {
        if bad.is_none() && !equations.all.contains(name) && ![TIME, LONG_TIME].contains(&name) {
            bad = Some((name.to_owned(), span.clone()));
        }
    });
    let Some((name, span)) = bad else { return Ok(()) };
    let message = format!("'{name}' stands in no equation");
    let help = format!(
        "{}; a parameter that only outputs have is named in a line 'parameters: {name}'",
        equations.advice(&name)
    );
    Err(Problem::new(Code::Foreign, &span, message, "this name").help(help))
}

/// Says what is taken to be what of the names that nothing declares, and refuses those that look like functions of states.
pub(super) fn look_at_others(
    model: &mut ForeignModel,
    listed: usize,
    are_unknown: bool,
) -> Result<(), Problem> {
    let others: Vec<String> = model.constants[listed.min(model.constants.len())..]
        .iter()
        .map(|constant| constant.name.clone())
        .collect();
    let states: BTreeSet<&str> = model.states.iter().map(|state| state.name.as_str()).collect();
    let small: BTreeMap<String, String> =
        model.states.iter().map(|state| (state.name.to_lowercase(), state.name.clone())).collect();
    let mut remarks = Vec::new();
    for name in &others {
        let state = FUNCTIONS_OF_STATES.iter().find_map(|function| {
            let rest = name.strip_prefix(function)?;
            states.get(rest).map(|state| (*function, (*state).to_owned()))
        });
        if let Some((function, state)) = state {
            let mut place = 0..0;
            let mut look = |value: &ForeignExpr| {
                value.names(&mut |own, span| {
                    if own == name && place.is_empty() {
                        place = span.clone();
                    }
                });
            };
            model.states.iter().for_each(|state| look(&state.rate));
            model.definitions.iter().for_each(|(_, value)| look(value));
            model.outputs.iter().for_each(|output| look(&output.value));
            let message = format!("'{name}' may be a function of '{state}' or a name");
            return Err(Problem::new(Code::Foreign, &place, message, "this").help(format!(
                "write {function}({state}), or name it in a line such as 'parameters: {name}'"
            )));
        }
        if let Some(state) = small.get(&name.to_lowercase()) {
            remarks.push(format!("'{name}' is taken to be a parameter: the state is '{state}'"));
        }
    }
    model.remarks.append(&mut remarks);
    if !are_unknown && !others.is_empty() {
        model.remarks.push(format!("known constants, not in the list of parameters: {}", others.join(", ")));
    }
    Ok(())
}

/// Functions whose brackets are left out most often.
const FUNCTIONS_OF_STATES: [&str; 9] = ["sin", "cos", "tan", "exp", "log", "ln", "sqrt", "sinh", "cosh"];

/// Definitions that nothing uses are what is measured.
pub(super) fn outputs_by_use(model: &mut ForeignModel) {
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

pub(super) fn no_left(syntax: &Syntax) -> Problem {
    if is_higher_derivative(syntax) {
        return Problem::new(Code::Foreign, &syntax.span, "a second derivative is not read", "this")
            .help("it needs a state of its own: x' = v and v' = ...");
    }
    if let SyntaxKind::Call(_, arguments) = &syntax.kind
        && matches!(arguments.as_slice(), [Syntax { kind: SyntaxKind::Number(_), .. }])
    {
        return Problem::new(
            Code::Foreign,
            &syntax.span,
            "an initial condition is none of the equations",
            "this",
        )
        .help("leave it out: initial conditions are unknown unless a proof file says otherwise");
    }
    Problem::new(Code::Foreign, &syntax.span, "this is no name and no derivative of one", "this")
        .help("an equation has x', dx/dt, Derivative(x(t), t) or a name on its left")
}
