//! Lists of Python that are changed in place, and names that stand for one list.

use super::super::script::{Dialect, Form, ScriptValue, Syntax, SyntaxKind};
use super::Script;
use crate::script::Parser;
use palmistry_lang::{Code, Problem};

/// Modules whose functions are known by their names.
const KNOWN: [&str; 7] = ["sympy", "numpy", "math", "casadi", "scipy", "__future__", "strikepy"];

impl Script<'_> {
    /// Makes a name that is assigned to one of those of a list, or of a list of its own.
    pub(super) fn name_list(&mut self, name: &str, right: &Syntax, value: &ScriptValue) {
        let is_list = self.dialect == Dialect::Python && matches!(value, ScriptValue::Many { .. });
        match right.as_name().filter(|other| is_list && *other != name) {
            Some(other) => {
                let groups = &mut self.groups;
                let group = *self.aliases.entry(other.to_owned()).or_insert_with(|| {
                    *groups += 1;
                    *groups
                });
                self.aliases.insert(name.to_owned(), group);
            }
            None if right.as_name() == Some(name) => {}
            None => {
                self.aliases.remove(name);
            }
        }
    }

    /// The other names of a list.
    fn others(&self, name: &str) -> Result<Vec<String>, Problem> {
        let Some(group) = self.aliases.get(name) else { return Ok(Vec::new()) };
        self.workspace.pay(self.aliases.len())?;
        let others = self.aliases.iter().filter(|(other, own)| *own == group && *other != name);
        Ok(others.map(|(other, _)| other.clone()).collect())
    }

    /// What a name stands for now, the other names of its list do, too.
    pub(super) fn share(&mut self, name: &str) -> Result<(), Problem> {
        for other in self.others(name)? {
            if let Some(value) = self.workspace.get(name) {
                self.workspace.bind(&other, value?);
            }
        }
        Ok(())
    }

    /// A list that could not be read, by all of its names.
    pub(super) fn break_list(&mut self, name: &str, why: &Problem) -> Result<(), Problem> {
        for own in self.others(name)?.into_iter().chain([name.to_owned()]) {
            let why = Problem {
                help: why.help.clone(),
                ..Problem::new(Code::Foreign, &why.span, why.message.clone(), "this")
            };
            self.workspace.break_name(&own, why);
        }
        Ok(())
    }

    /// `h.append(x2)`, `h.extend([x2])`: whether a call is one that changes a list. What else changes one is not read.
    pub(super) fn changed_in_place(&mut self, call: &Syntax) -> Result<bool, Problem> {
        let SyntaxKind::Call(callee, arguments) = &call.kind else { return Ok(false) };
        let SyntaxKind::Member(list, method) = &callee.kind else { return Ok(false) };
        let Some(name) = list.as_name().filter(|name| self.workspace.holds_a_list(name)).map(str::to_owned)
        else {
            return Ok(false);
        };
        let Some(Ok(before)) = self.workspace.get(&name) else { return Ok(true) };
        let more = match (method.as_str(), arguments.as_slice()) {
            ("append", [one]) => {
                let part = self.workspace.value(one)?;
                // one more element is a list of one
                Some(match part {
                    ScriptValue::One(one) => {
                        ScriptValue::Many { rows: 1, entries: vec![one], form: Form::List }
                    }
                    ScriptValue::Many { entries, form, .. } if form.is_list() => {
                        ScriptValue::Many { rows: 1, entries, form: Form::Rows }
                    }
                    other => other,
                })
            }
            ("extend", [list]) => Some(self.workspace.value(list)?),
            _ => None,
        };
        match more {
            Some(more) => {
                let value = self.workspace.chained(before, more, &call.span)?;
                self.workspace.bind(&name, value);
                self.share(&name)?;
            }
            None => {
                let message = format!("'{name}' is changed by '{method}', which is not read");
                let why = Problem::new(Code::Foreign, &call.span, message, "this");
                self.break_list(&name, &why.help("assign the whole list at once"))?;
            }
        }
        Ok(true)
    }

    /// `from module import a, b as c`: names of modules that are not read.
    pub(super) fn taken_from(&mut self, parser: &mut Parser<'_>) {
        parser.next();
        let mut module = String::new();
        while !parser.at_end() && !parser.peek().newline && !parser.peek().is_word("import") {
            module.push_str(&parser.next().text);
        }
        let known = KNOWN.iter().any(|name| *name == module.split('.').next().unwrap_or_default());
        let is_sympy = module.split('.').next() == Some("sympy");
        let mut open = false;
        while !parser.at_end() && (open || !parser.peek().newline) && !parser.peek().is(";") {
            let word = parser.next();
            open = open && !word.is(")") || word.is("(");
            if word.is_word("import") || !word.text.starts_with(|c: char| c.is_alphabetic() || c == '_') {
                if word.is("*") && is_sympy {
                    self.workspace.from_sympy.extend(
                        ["factor", "collect", "together", "cancel", "sympify", "S"].map(str::to_owned),
                    );
                }
                continue;
            }
            let name = match parser.peek().is_word("as") {
                true => {
                    parser.next();
                    parser.next().text.clone()
                }
                false => word.text.clone(),
            };
            if known && name == word.text {
                self.workspace.elsewhere.remove(&name);
                if is_sympy {
                    self.workspace.from_sympy.insert(name);
                }
            } else {
                self.workspace.elsewhere.insert(name, module.clone());
            }
        }
    }
}
