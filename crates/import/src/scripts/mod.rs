//! Model files of StrikePy (Python) and STRIKE-GOLDD (MATLAB): assignments to `x`, `p`, `h`, `f`, `u` and `w`. They are read, and
//! never run.

mod functions;
mod lists;
mod loops;
mod model;

use super::expression::Span;
use super::model::ForeignModel;
use super::script::{
    Dialect, Form, Parser, ScriptValue, ScriptWorkspace, Syntax, SyntaxKind, Token, TokenKind,
    named_function, tokens,
};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// The variables by which these programs know a model.
const VARIABLES: [&str; 8] = ["x", "p", "h", "f", "u", "w", "ics", "known_ics"];

/// Commands that say nothing of the model.
const IGNORED: [&str; 14] = [
    "clear",
    "clc",
    "close",
    "clearvars",
    "format",
    "warning",
    "disp",
    "fprintf",
    "print",
    "addpath",
    "more",
    "tic",
    "toc",
    "pretty",
];

/// Functions that run a text as a part of the script.
const RUNS: [&str; 6] = ["exec", "eval", "evalc", "evalin", "assignin", "feval"];

/// Words that begin what is more than assignments.
const CONTROL: [&str; 17] = [
    "for", "while", "if", "switch", "function", "try", "parfor", "def", "class", "with", "return", "lambda",
    "elif", "else", "classdef", "global", "assume",
];

/// Reads a model file: the model that it saves, or the one of several that has a name or number.
pub(super) fn read(
    text: &str,
    dialect: Dialect,
    which: Option<&str>,
    budget: &Budget,
) -> Result<ForeignModel, Problem> {
    let (words, comments) = tokens(text, dialect, budget)?;
    let mut script = Script {
        workspace: ScriptWorkspace::new(budget, dialect),
        dialect,
        saved: None,
        title: None,
        which: which.map(str::to_owned),
        saves: 0,
        begin: None,
        deep: 0,
        repetitions: 0,
        at_save: None,
        aliases: BTreeMap::new(),
        groups: 0,
        within: BTreeSet::new(),
        function: None,
    };
    script.workspace.plain.extend(VARIABLES.map(str::to_owned));
    script.all(&words)?;
    if let Some(wanted) = script.which.as_ref().filter(|_| script.saves > 0 && script.title.is_none()) {
        let message = format!("the file saves no model '{wanted}'");
        return Err(Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file")
            .help("models are named by what 'save' calls them"));
    }
    if let Some(wanted) = script.which.as_ref().filter(|wanted| script.saves == 0 && *wanted != "1") {
        let message = format!("the file has no model '{wanted}'");
        return Err(Problem::new(Code::Foreign, &(0..text.len().min(1)), message, "the file")
            .help("it has one model: leave --model out"));
    }
    let mut model = match &script.function {
        Some(head) => script.model_of_function(head)?,
        None => script.model(text)?,
    };
    model.title = script.title.clone();
    model.source = super::heading(text, &comments, script.begin.unwrap_or(text.len()));
    Ok(model)
}

struct Script<'b> {
    workspace: ScriptWorkspace<'b>,
    dialect: Dialect,
    /// The variables that `save` names, and what the file is called.
    saved: Option<BTreeSet<String>>,
    title: Option<String>,
    /// Which of several models is asked for, and how many were saved so far.
    which: Option<String>,
    saves: usize,
    /// Where the first assignment stands.
    begin: Option<usize>,
    /// How many loops are open, and how many statements were read within loops.
    deep: usize,
    repetitions: u64,
    /// What the variables of the model are where they are saved: what is assigned below belongs to another one.
    at_save: Option<BTreeMap<&'static str, ScriptValue>>,
    /// Names of Python that stand for one list, by a number of that list.
    aliases: BTreeMap<String, u64>,
    groups: u64,
    /// Names whose list is an element of another list, or may be: what changes it changes the other.
    within: BTreeSet<String>,
    /// The function that the file is, if it is one.
    function: Option<functions::Head>,
}

impl Script<'_> {
    fn all(&mut self, words: &[Token]) -> Result<(), Problem> {
        let mut parser = Parser::new(words, self.dialect);
        while !parser.at_end() {
            if parser.take(";") || parser.take(",") {
                continue;
            }
            // the end of the function that the file is
            if self.function.is_some() && parser.peek().is_word("end") {
                parser.next();
                continue;
            }
            let begin = parser.position();
            self.statement(&mut parser)?;
            let next = parser.peek();
            if !(parser.at_end() || next.newline || next.is(";") || next.is(","))
                || parser.position() == begin
            {
                return Err(parser.unexpected("the end of the line"));
            }
        }
        Ok(())
    }

    fn statement(&mut self, parser: &mut Parser<'_>) -> Result<(), Problem> {
        let word = parser.peek();
        if word.is_word("for") && self.dialect == Dialect::Matlab {
            return self.repeated(parser);
        }
        let is_first = self.begin.is_none() && self.function.is_none();
        if word.is_word("function") && self.dialect == Dialect::Matlab && is_first {
            return self.function(parser);
        }
        if let Some(control) = CONTROL.iter().find(|control| word.is_word(control)) {
            return Err(Problem::new(
                Code::Foreign,
                &word.span,
                format!("'{control}' is not read: nothing of a script is run"),
                "this",
            )
            .help("write the model as plain assignments to x, p, h, f, u and w"));
        }
        let ignored = IGNORED.iter().any(|name| word.is_word(name));
        if word.is_word("from") && self.dialect == Dialect::Python {
            self.taken_from(parser);
            return Ok(());
        }
        if RUNS.iter().any(|name| word.is_word(name)) && parser.ahead(1).is("(") {
            let message = format!("'{}' is not read: nothing of a script is run", word.text);
            return Err(Problem::new(Code::Foreign, &word.span, message, "this")
                .help("write what it does as plain assignments to x, p, h, f, u and w"));
        }
        if word.is_word("import") && self.dialect == Dialect::Python || ignored && !parser.ahead(1).is("=") {
            let begin = parser.position();
            self.skip_line(parser);
            return self.refuse_changes_among(parser, begin);
        }
        if word.is_word("syms") && self.dialect == Dialect::Matlab {
            return self.symbols(parser);
        }
        if word.is_word("save") && self.dialect == Dialect::Matlab {
            return self.saving(parser);
        }
        if let TokenKind::Text(_) = word.kind {
            // a text by itself is a remark
            parser.next();
            return Ok(());
        }
        let left = parser.expression()?;
        let mut targets = vec![left];
        while parser.peek().is(",") && self.dialect == Dialect::Python && !parser.peek().newline {
            parser.next();
            targets.push(parser.expression()?);
        }
        for target in &targets {
            let by_itself = targets.len() == 1 && !parser.peek().is("=");
            self.refuse_changes_within(target, by_itself)?;
        }
        if !parser.take("=") {
            if let [only] = targets.as_slice()
                && self.changed_in_place(only)?
            {
                return Ok(());
            }
            return match targets.as_slice() {
                // a call for its own sake changes nothing that is read here, but the lists that it is given
                [only] if named_function(only).is_some_and(|(name, _)| !VARIABLES.contains(&name)) => Ok(()),
                [only] if matches!(only.kind, SyntaxKind::Text(_) | SyntaxKind::Name(_)) => Ok(()),
                _ => Err(parser.unexpected("'='")),
            };
        }
        self.begin.get_or_insert(targets[0].span.start);
        let right = self.right_side(parser)?;
        self.refuse_changes_within(&right, false)?;
        // a = b = 0
        let mut chain = vec![targets];
        let mut right = right;
        while self.dialect == Dialect::Python && parser.take("=") {
            chain.push(match right.kind {
                SyntaxKind::List(list) if !self.is_bracketed(&right.span, &list) => list,
                kind => vec![Syntax { kind, span: right.span }],
            });
            right = self.right_side(parser)?;
        }
        let is_chain = chain.len() > 1;
        let first = chain
            .first()
            .and_then(|targets| targets.first())
            .and_then(|one| one.as_name())
            .map(str::to_owned);
        for (at, targets) in chain.iter().enumerate() {
            match (&first, targets.as_slice()) {
                // one list by two names
                (Some(first), [_]) if at > 0 => {
                    let same = Syntax { kind: SyntaxKind::Name(first.clone()), span: right.span.clone() };
                    self.assigned(targets, &same)?;
                }
                _ if at > 0 || is_chain && targets.len() > 1 => {
                    return Err(parser.unexpected("one assignment at a time"));
                }
                _ => self.assigned(targets, &right)?,
            }
        }
        Ok(())
    }

    /// Whether a list has brackets of its own: its elements begin behind its begin.
    fn is_bracketed(&self, span: &Span, list: &[Syntax]) -> bool {
        list.first().is_none_or(|first| first.span.start > span.start)
    }

    /// An expression, or several with commas between them in Python.
    fn right_side(&mut self, parser: &mut Parser<'_>) -> Result<Syntax, Problem> {
        let first = parser.expression()?;
        if parser.peek().is("=") && self.dialect != Dialect::Python {
            return Err(parser.unexpected("one assignment at a time"));
        }
        if self.dialect != Dialect::Python || !parser.peek().is(",") {
            return Ok(first);
        }
        let begin = first.span.start;
        let mut list = vec![first];
        while parser.take(",") {
            list.push(parser.expression()?);
        }
        let end = list.last().map_or(begin, |last| last.span.end);
        Ok(Syntax { kind: SyntaxKind::List(list), span: begin..end })
    }

    fn skip_line(&self, parser: &mut Parser<'_>) {
        parser.next();
        while !parser.at_end() && !parser.peek().newline && !parser.peek().is(";") {
            parser.next();
        }
    }

    /// `syms a b c real`
    fn symbols(&mut self, parser: &mut Parser<'_>) -> Result<(), Problem> {
        parser.next();
        while !parser.at_end() && !parser.peek().newline && !parser.peek().is(";") {
            let word = parser.next();
            if word.is(",") || ["real", "positive", "rational", "integer"].contains(&word.text.as_str()) {
                continue;
            }
            if word.kind != TokenKind::Name {
                return Err(Problem::new(
                    Code::Foreign,
                    &word.span,
                    format!("'{}' is no name of a symbol", word.text),
                    "this",
                )
                .help("functions of time are plain symbols in such files: write their names"));
            }
            let value = self.workspace.symbol(&word.text, &word.span)?;
            self.workspace.bind(&word.text, value);
        }
        Ok(())
    }

    /// `save('name', 'x', 'p', ...)`, `save name x p`
    fn saving(&mut self, parser: &mut Parser<'_>) -> Result<(), Problem> {
        let span = parser.next().span.clone();
        let mut names = Vec::new();
        while !parser.at_end() && !parser.peek().newline && !parser.peek().is(";") {
            let word = parser.next();
            match &word.kind {
                TokenKind::Text(text) => names.push(text.clone()),
                TokenKind::Name => names.push(word.text.clone()),
                _ => {}
            }
        }
        self.saves += 1;
        let (count, name) = (self.saves.to_string(), names.first().cloned());
        if self.which.is_none() && self.saves > 1 {
            let message = format!("the file saves a second model, '{}'", name.unwrap_or_default());
            return Err(Problem::new(Code::Foreign, &span, message, "the second one")
                .help("say which with --model NAME or --model NUMBER; what is assigned behind the first belongs to the second"));
        }
        let is_asked = |which: &String| *which == count || Some(which) == name.as_ref();
        if self.which.as_ref().is_some_and(|which| !is_asked(which)) {
            return Ok(());
        }
        self.title.clone_from(&name);
        // what is assigned below belongs to other models
        let mut values = BTreeMap::new();
        for variable in VARIABLES {
            if let Some(value) = self.workspace.get(variable) {
                values.insert(variable, value?);
            }
        }
        self.at_save = Some(values);
        let names: BTreeSet<String> =
            names.into_iter().skip(1).filter(|name| !name.starts_with('-')).collect();
        if !names.is_empty() {
            self.saved.get_or_insert_default().extend(names);
        }
        if self.which.is_some() {
            // what stands below belongs to other models
            let asked_by_name = self.which != Some(count);
            while !parser.at_end() {
                let word = parser.next();
                let again = (1..3).any(|by| {
                    matches!(&parser.ahead(by - 1).kind, TokenKind::Text(text) if Some(text) == name.as_ref())
                });
                if asked_by_name && word.is_word("save") && again {
                    let message = format!("the file saves several models '{}'", name.unwrap_or_default());
                    return Err(Problem::new(Code::Foreign, &word.span, message, "another one")
                        .help("say which with --model NUMBER"));
                }
            }
        }
        Ok(())
    }

    /// `f(2) = ...` in MATLAB, `f[1] = ...` in Python: the name of the vector or matrix, and the place of the element among its entries.
    fn element(&mut self, target: &Syntax) -> Result<Option<(String, usize, bool)>, Problem> {
        let (vector, indices, from) = match (&target.kind, self.dialect) {
            (SyntaxKind::Call(vector, indices), Dialect::Matlab) => (vector, indices, 1),
            (SyntaxKind::Index(vector, indices), Dialect::Python) => (vector, indices, 0),
            _ => return Ok(None),
        };
        let Some(name) = vector.as_name() else { return Ok(None) };
        let mut numbers = Vec::new();
        for index in indices {
            let Some(number) = self.workspace.count(index)? else { return Ok(None) };
            numbers.push(number + 1 - from);
        }
        let place = self.workspace.element(name, &numbers, self.dialect == Dialect::Matlab);
        let down = matches!(numbers.as_slice(), [row, 1] if *row > 1);
        Ok(place.map(|place| (name.to_owned(), place, down)))
    }

    fn assigned(&mut self, targets: &[Syntax], right: &Syntax) -> Result<(), Problem> {
        if let [target] = targets
            && target.as_name().is_none()
            && let Some((name, at, down)) = self.element(target)?
        {
            self.refuse_shared(&name, &target.span)?;
            match self.workspace.value(right).map(ScriptValue::entries) {
                Ok(Some(entries)) if entries.len() == 1 => {
                    for value in entries {
                        self.workspace.assign_element(&name, at, down, value)?;
                    }
                    self.share(&name)?;
                }
                Ok(_) => {
                    let why =
                        Problem::new(Code::Foreign, &right.span, "an element is one number", "this is none");
                    self.break_list(&name, &why)?;
                }
                Err(why) => self.break_list(&name, &why)?,
            }
            return Ok(());
        }
        let names = targets
            .iter()
            .map(|target| {
                target.as_name().map(str::to_owned).ok_or_else(|| {
                    let message = "an element of something is assigned to: that is not read";
                    Problem::new(Code::Foreign, &target.span, message, "this")
                        .help("assign the whole vector at once")
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        match (self.workspace.value(right), names.as_slice()) {
            (Ok(value), [name]) => {
                self.note_lists_within(Some(name), right, &value);
                self.name_list(name, right, &value);
                self.workspace.assign(name, value);
            }
            // each of the names would stand for a list
            (Ok(ScriptValue::Many { form: Form::Rows | Form::Array, .. }), _) => {
                let message = "several lists are assigned to several names";
                return Err(Problem::new(Code::Foreign, &right.span, message, "these values")
                    .help("write an assignment each, in a line of its own"));
            }
            (Ok(value), names) => {
                let entries = value.entries().unwrap_or_default();
                if entries.len() != names.len() {
                    let message = format!("{} names, and {} values", names.len(), entries.len());
                    return Err(Problem::new(Code::Foreign, &right.span, message, "these values"));
                }
                for (name, entry) in names.iter().zip(entries) {
                    self.workspace.assign(name, ScriptValue::One(entry));
                }
            }
            (Err(why), names) => {
                // reported where it is used: many files compute what no model uses
                for name in names {
                    let why = Problem {
                        help: why.help.clone(),
                        ..Problem::new(Code::Foreign, &why.span, why.message.clone(), "this")
                    };
                    self.workspace.break_name(name, why);
                }
            }
        }
        Ok(())
    }
}
