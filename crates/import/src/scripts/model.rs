//! The model that the variables of a script are.

use super::super::expression::{ForeignExpr, ForeignKind, Span};
use super::super::model::{ForeignConstant, ForeignModel, ForeignOutput, ForeignRate};
use super::super::script::ScriptValue;
use super::Script;
use dashu::rational::RBig;
use palmistry_lang::{Code, Problem};
use std::collections::BTreeSet;

impl Script<'_> {
    /// The entries of one of the variables of a model; none where it is not there.
    fn vector(&self, name: &str) -> Result<Option<Vec<ForeignExpr>>, Problem> {
        if self.saved.as_ref().is_some_and(|saved| !saved.contains(name)) {
            return Ok(None);
        }
        if let Some(values) = &self.at_save {
            return Ok(values.get(name).cloned().and_then(ScriptValue::entries));
        }
        match self.workspace.get(name) {
            None => Ok(None),
            Some(value) => Ok(value?.entries()),
        }
    }

    fn required(&self, name: &str, what: &str, text: &str) -> Result<Vec<ForeignExpr>, Problem> {
        self.vector(name)?.ok_or_else(|| {
            let message = format!("the file does not say what {name} is: {what}");
            Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file")
                .help("model files have x (states), p (parameters), f (rates), h (outputs), u and w (inputs)")
        })
    }

    fn symbols_of(&self, name: &str) -> Result<Vec<(String, Span)>, Problem> {
        let entries = self.vector(name)?.unwrap_or_default();
        names_only(name, entries)
    }

    pub(super) fn model(&self, text: &str) -> Result<ForeignModel, Problem> {
        let states = names_only("x", self.required("x", "the states", text)?)?;
        let rates = self.required("f", "the rates of the states", text)?;
        if states.len() != rates.len() {
            let message = format!("{} states, and {} rates", states.len(), rates.len());
            let span = rates.last().map_or(0..0, |rate| rate.span.clone());
            return Err(Problem::new(Code::Foreign, &span, message, "the last rate")
                .help("x and f have as many elements"));
        }
        let mut model =
            ForeignModel { definitions: self.workspace.definitions.clone(), ..ForeignModel::default() };
        let mut seen = BTreeSet::new();
        let mut new = |name: &str, span: &Span| {
            let twice = || {
                Problem::new(
                    Code::Foreign,
                    span,
                    format!("x, p, u and w have the symbol '{name}' twice"),
                    "this symbol",
                )
                .help("two variables of the script may be one symbol: give each a symbol of its own")
            };
            if self.workspace.has_definition(name) {
                let message = format!("'{name}' has a value above, and is no symbol");
                return Err(Problem::new(Code::Foreign, span, message, "this")
                    .help("x, p, u and w have symbols alone: take it out, or do not assign to it"));
            }
            if seen.insert(name.to_owned()) { Ok(()) } else { Err(twice()) }
        };
        for ((name, span), rate) in states.iter().zip(rates) {
            new(name, span)?;
            model.states.push(ForeignRate { name: name.clone(), rate, span: span.clone() });
        }
        for (list, target) in [("u", &mut model.known_inputs), ("w", &mut model.unknown_inputs)] {
            // `syms u` alone is a symbol of that name
            for (name, span) in self.symbols_of(list)? {
                new(&name, &span)?;
                target.push(name);
            }
        }
        for (name, span) in self.symbols_of("p")? {
            new(&name, &span)?;
            model.constants.push(ForeignConstant {
                name,
                value: None,
                is_unknown: true,
                may_be_unknown: true,
            });
        }
        let outputs = self.required("h", "the outputs", text)?;
        model.outputs = outputs.into_iter().map(|value| ForeignOutput { name: None, value }).collect();
        let before = model.constants.len();
        model.order_definitions()?;
        model.declare_others(false);
        let others: Vec<&str> =
            model.constants[before..].iter().map(|constant| constant.name.as_str()).collect();
        self.look_at_others(&model, &others)?;
        if !others.is_empty() {
            model
                .remarks
                .push(format!("known constants, in neither x nor p nor u nor w: {}", others.join(", ")));
        }
        if self.saved.as_ref().is_some_and(|saved| !saved.contains("u")) && self.workspace.get("u").is_some()
        {
            model
                .remarks
                .push("'u' is not among what the file saves, so it is no input of the model".to_owned());
        }
        self.initial_values(&mut model);
        Ok(model)
    }

    /// Refuses time and functions among what is in none of the lists.
    fn look_at_others(&self, model: &ForeignModel, others: &[&str]) -> Result<(), Problem> {
        let mut listed: BTreeSet<&str> = model.states.iter().map(|state| state.name.as_str()).collect();
        listed.extend(model.known_inputs.iter().chain(&model.unknown_inputs).map(String::as_str));
        let parameters = model.constants.iter().map(|constant| constant.name.as_str());
        let place = |name: &str| {
            let mut found = 0..0;
            let mut look = |value: &ForeignExpr| {
                value.names(&mut |own, span| {
                    if own == name && found.is_empty() {
                        found = span.clone();
                    }
                });
            };
            model.states.iter().for_each(|state| look(&state.rate));
            model.outputs.iter().for_each(|output| look(&output.value));
            model.definitions.iter().for_each(|(_, value)| look(value));
            found
        };
        if others.contains(&"t") {
            return Err(Problem::new(Code::Foreign, &place("t"), "'t' is time, and no constant", "this").help(
                "make it a state with the rate 1, in x and in f, and measure it, in h; a constant has another name",
            ));
        }
        let all: BTreeSet<&str> = listed.iter().copied().chain(parameters).collect();
        for (name, (of, span)) in
            self.workspace.functions.iter().filter(|(name, _)| all.contains(name.as_str()))
        {
            let mut of_states = false;
            of.iter().for_each(|one| one.names(&mut |own, _| of_states |= all.contains(own) && own != "t"));
            if of_states {
                let message = format!("'{name}' is a function that nothing defines");
                return Err(
                    Problem::new(Code::Foreign, span, message, "this").help("write its formula in its place")
                );
            }
            if !listed.contains(name.as_str()) && others.contains(&name.as_str()) {
                let message = format!("'{name}' is a function of time, and in none of x, u and w");
                return Err(Problem::new(Code::Foreign, span, message, "this")
                    .help("known inputs are in u, unknown ones in w"));
            }
        }
        Ok(())
    }

    /// States with a known initial condition: the programs use them only on request, so they stand in a comment.
    fn initial_values(&self, model: &mut ForeignModel) {
        let Ok(Some(known)) = self.vector("known_ics") else { return };
        let values = self.vector("ics").ok().flatten().unwrap_or_default();
        for (at, (state, flag)) in model.states.iter().zip(known).enumerate() {
            if flag.as_number().is_some_and(|flag| *flag != RBig::ZERO) {
                let value = values.get(at).filter(|value| value.as_number().is_some()).cloned();
                model.initial_values.push((state.name.clone(), value));
            }
        }
        if !model.initial_values.is_empty() {
            let remark = "known initial conditions stand at the end of the file as comments: the program uses them only where it is asked to";
            model.remarks.push(remark.to_owned());
        }
    }
}

/// Names, and nothing else.
fn names_only(list: &str, entries: Vec<ForeignExpr>) -> Result<Vec<(String, Span)>, Problem> {
    entries
        .into_iter()
        .map(|entry| match entry.kind {
            ForeignKind::Name(name) => Ok((name, entry.span)),
            _ => Err(Problem::new(
                Code::Foreign,
                &entry.span,
                format!("an element of {list} is no symbol"),
                "this",
            )
            .help(format!("{list} has symbols alone"))),
        })
        .collect()
}
