//! `function dx = rhs(t, x, p)` of MATLAB: the rates as they are given to its solvers. The elements of its arguments are symbols.

use super::super::expression::ForeignExpr;
use super::super::model::{ForeignConstant, ForeignModel, ForeignRate};
use super::super::script::{Parser, TokenKind};
use super::Script;
use palmistry_lang::{Code, Problem};
use std::ops::Range;

/// The first line of a function.
pub(super) struct Head {
    rates: String,
    time: Option<String>,
    state: String,
    others: Vec<String>,
    span: Range<usize>,
}

impl Script<'_> {
    /// Reads the first line of the one function of a file.
    pub(super) fn function(&mut self, parser: &mut Parser<'_>) -> Result<(), Problem> {
        let begin = parser.next().span.clone();
        let in_brackets = parser.take("[");
        let rates = parser.next();
        let closed = !in_brackets || parser.take("]");
        let wrong = |place: &Range<usize>| {
            Problem::new(Code::Foreign, place, "this function is not read", "this")
                .help("a function of rates is 'function dx = name(t, x, p)'; or write the model as plain assignments to x, p, h, f, u and w")
        };
        if rates.kind != TokenKind::Name
            || !closed
            || !parser.take("=")
            || parser.next().kind != TokenKind::Name
        {
            return Err(wrong(&begin));
        }
        if !parser.take("(") {
            return Err(wrong(&begin));
        }
        let mut arguments: Vec<Option<String>> = Vec::new();
        while !parser.take(")") {
            let word = parser.next();
            match word.kind {
                TokenKind::Name if word.text != "varargin" => arguments.push(Some(word.text.clone())),
                TokenKind::Sign("~") => arguments.push(None),
                TokenKind::Sign(",") => {}
                _ => return Err(wrong(&word.span)),
            }
        }
        let mut arguments = arguments.into_iter();
        let (time, state) = match (arguments.next(), arguments.next()) {
            (Some(time), Some(Some(state))) => (time, state),
            _ => return Err(wrong(&begin)),
        };
        let others: Vec<String> = arguments.flatten().collect();
        if let Some(time) = &time {
            let value = self.workspace.symbol(time, &begin)?;
            self.workspace.bind(time, value);
        }
        self.workspace
            .open
            .extend(others.iter().chain([&state]).map(|name| (name.clone(), Default::default())));
        self.workspace.plain.insert(rates.text.clone());
        self.function = Some(Head { rates: rates.text.clone(), time, state, others, span: begin });
        Ok(())
    }

    /// The model of a function.
    pub(super) fn model_of_function(&self, head: &Head) -> Result<ForeignModel, Problem> {
        let refused = |message: String, help: &str| {
            Problem::new(Code::Foreign, &head.span, message, "this function").help(help)
        };
        let rates = match self.workspace.get(&head.rates) {
            Some(value) => value?.entries().unwrap_or_default(),
            None => Vec::new(),
        };
        if rates.is_empty() {
            return Err(refused(
                format!("the function does not say what '{}' is", head.rates),
                "assign its rates",
            ));
        }
        let is_whole = |name: &String| self.workspace.open.get(name).is_some_and(|used| used.whole);
        let whole: Vec<&String> =
            head.others.iter().chain([&head.state]).filter(|name| is_whole(name)).collect();
        if let ([other, ..], true) = (whole.as_slice(), is_whole(&head.state))
            && **other != head.state
        {
            let message = format!(
                "'{}' and '{other}' are used as a whole: they may be numbers, vectors or matrices",
                head.state
            );
            return Err(refused(message, &format!("write their elements: {}(1), {other}(1)", head.state)));
        }
        let mut model =
            ForeignModel { definitions: self.workspace.definitions.clone(), ..ForeignModel::default() };
        for name in head.others.iter().chain([&head.state]) {
            let Some(used) = self.workspace.open.get(name) else { continue };
            let (count, is_state) = (rates.len(), *name == head.state);
            if used.whole && (!used.numbers.is_empty() || is_state && count > 1) {
                let message = format!("'{name}' is used as a whole, and its elements are not known");
                return Err(refused(message, "write its elements: x(1), x(2)"));
            }
            if let Some(number) = used.numbers.iter().find(|number| is_state && **number > count) {
                return Err(refused(
                    format!("{name}({number}) is used, and there are {count} rates"),
                    "each state has a rate",
                ));
            }
            let names: Vec<String> = match (is_state, used.whole) {
                (_, true) => vec![name.clone()],
                (true, _) => (1..=count).map(|number| format!("{name}{number}")).collect(),
                (false, _) => used.numbers.iter().map(|number| format!("{name}{number}")).collect(),
            };
            if let Some(taken) = names.iter().find(|name| self.workspace.has_definition(name)) {
                return Err(refused(
                    format!("'{taken}' is an element of '{name}', and is assigned to"),
                    "give what is assigned another name",
                ));
            }
            if is_state {
                model.states.extend(names.into_iter().zip(&rates).map(|(name, rate)| ForeignRate {
                    name,
                    rate: rate.clone(),
                    span: head.span.clone(),
                }));
            } else {
                model.constants.extend(names.into_iter().map(|name| ForeignConstant {
                    name,
                    value: None,
                    is_unknown: true,
                    may_be_unknown: true,
                }));
            }
        }
        model.order_definitions()?;
        if let Some(time) = &head.time {
            let mut used = false;
            let mut look = |value: &ForeignExpr| value.names(&mut |name, _| used |= name == time);
            model.states.iter().for_each(|state| look(&state.rate));
            model.definitions.iter().for_each(|(_, value)| look(value));
            if used {
                model.add_clock(time);
            }
        }
        if !whole.is_empty() {
            let list = whole.iter().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
            model.remarks.push(format!("used as a whole, and read as one number each: {list}"));
        }
        let has_elements = head
            .others
            .iter()
            .chain([&head.state])
            .any(|name| self.workspace.open.get(name).is_some_and(|used| !used.numbers.is_empty()));
        if has_elements {
            model.remarks.push(format!(
                "elements of the arguments of the function are symbols: {}(1) is {}1",
                head.state, head.state
            ));
        }
        Ok(model)
    }
}
