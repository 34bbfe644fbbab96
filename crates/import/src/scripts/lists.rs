//! Lists of Python that are changed in place, and names that stand for one list.

use super::super::expression::Span;
use super::super::script::{Dialect, Form, ScriptValue, Syntax, SyntaxKind};
use super::Script;
use crate::script::Parser;
use palmistry_lang::{Code, Problem};

/// Modules whose functions are known by their names.
const KNOWN: [&str; 7] = ["sympy", "numpy", "math", "casadi", "scipy", "__future__", "strikepy"];

/// What changes a list, or a matrix of SymPy, in its place.
const CHANGING: [&str; 22] = [
    "append",
    "extend",
    "insert",
    "pop",
    "remove",
    "sort",
    "reverse",
    "clear",
    "row_del",
    "col_del",
    "row_swap",
    "col_swap",
    "row_op",
    "col_op",
    "zip_row_op",
    "fill",
    "copyin_list",
    "copyin_matrix",
    "simplify",
    "itemset",
    "resize",
    "put",
];

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
                if self.within.contains(other) {
                    self.within.insert(name.to_owned());
                }
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
        // one of several names that a list was assigned to: its list is not kept
        if let Some(name) = list.as_name()
            && self.dialect == Dialect::Python
            && CHANGING.contains(&method.as_str())
            && self.workspace.is_bound(name)
            && !self.workspace.holds_a_list(name)
        {
            let message = format!("'{name}' is changed by '{method}', and is no list that is known");
            return Err(Problem::new(Code::Foreign, &call.span, message, "this")
                .help("assign the whole list at once"));
        }
        let Some(name) = list.as_name().filter(|name| self.workspace.holds_a_list(name)).map(str::to_owned)
        else {
            return Ok(false);
        };
        let Some(Ok(before)) = self.workspace.get(&name) else { return Ok(true) };
        self.refuse_shared(&name, &call.span)?;
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
                for one in arguments {
                    self.note_lists_within(None, one, &more);
                }
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

    /// Keeps in mind which names stand for a list that is an element of another one now: `h = [row, [x2]]`, `r = f[0]`, `h.append(row)`. Their
    /// elements are copied here, and are one thing in Python.
    pub(super) fn note_lists_within(&mut self, name: Option<&str>, right: &Syntax, value: &ScriptValue) {
        let is_list = self.dialect == Dialect::Python && matches!(value, ScriptValue::Many { .. });
        if let Some(name) = name.filter(|name| right.as_name() != Some(*name)) {
            self.within.remove(name);
        }
        if !is_list {
            return;
        }
        let mut found = Vec::new();
        self.lists_within(right, name.is_none(), &mut found);
        // an element of a list of lists by a name of its own
        if let (Some(name), SyntaxKind::Index(..)) = (name, &right.kind) {
            found.push(name.to_owned());
        }
        // of numpy's arrays rows, and arrays that are turned round, are views: each changes with the other
        if let (Some(name), ScriptValue::Many { form: Form::Array | Form::Vector, .. }) = (name, value)
            && let SyntaxKind::Index(inner, _) | SyntaxKind::Member(inner, _) = &right.kind
            && let Some(inner) = inner.as_name()
        {
            found.extend([name.to_owned(), inner.to_owned()]);
        }
        for own in found {
            self.within.extend(self.others(&own).unwrap_or_default());
            self.within.insert(own);
        }
    }

    /// The names of lists that are elements of a list which an expression makes.
    fn lists_within(&self, of: &Syntax, is_element: bool, found: &mut Vec<String>) {
        match &of.kind {
            SyntaxKind::Name(name) if is_element && self.workspace.holds_a_list(name) => {
                found.push(name.clone());
            }
            SyntaxKind::List(list) => list.iter().for_each(|one| self.lists_within(one, true, found)),
            SyntaxKind::Sum(list) | SyntaxKind::Product(list) => {
                list.iter().for_each(|(_, one)| self.lists_within(one, is_element, found));
            }
            SyntaxKind::Choice(_, then, otherwise) => {
                self.lists_within(then, is_element, found);
                self.lists_within(otherwise, is_element, found);
            }
            _ => {}
        }
    }

    /// Refuses to change a list that is an element of another one.
    pub(super) fn refuse_shared(&self, name: &str, place: &Span) -> Result<(), Problem> {
        if !self.within.contains(name) {
            return Ok(());
        }
        let message =
            format!("'{name}' is changed here, and is an element of another list, which changes with it");
        Err(Problem::new(Code::Foreign, place, message, "this change")
            .help("assign whole lists, each at once"))
    }

    /// Refuses calls that change a list within an expression, `last = h.pop()`, and such that change one without a name of its own,
    /// `f[0].append(x)`. The outermost call of a statement by itself is looked at elsewhere.
    pub(super) fn refuse_changes_within(&mut self, of: &Syntax, by_itself: bool) -> Result<(), Problem> {
        if self.dialect != Dialect::Python {
            return Ok(());
        }
        let mut found: Option<(String, Span)> = None;
        let mut lists = Vec::new();
        of.each(&mut |part| {
            let SyntaxKind::Call(callee, arguments) = &part.kind else { return };
            // what a function that is not read does with a list, nobody knows
            if let Some(function) =
                callee.as_name().filter(|name| self.workspace.elsewhere.contains_key(*name))
            {
                for one in arguments.iter().filter_map(Syntax::as_name) {
                    if self.workspace.holds_a_list(one) {
                        lists.push((one.to_owned(), function.to_owned(), part.span.clone()));
                    }
                }
            }
            let SyntaxKind::Member(list, method) = &callee.kind else { return };
            let is_outermost = by_itself && part.span == of.span && list.as_name().is_some();
            let is_list = list.as_name().is_none_or(|name| self.workspace.holds_a_list(name));
            if !is_outermost && is_list && CHANGING.contains(&method.as_str()) && found.is_none() {
                found = Some((method.clone(), part.span.clone()));
            }
        });
        if let Some((method, span)) = found {
            let message = format!("a list is changed by '{method}' within an expression, which is not read");
            return Err(Problem::new(Code::Foreign, &span, message, "this").help(
                "write the change as a line of its own: h.append(x), or assign the whole list at once",
            ));
        }
        for (name, function, span) in lists {
            let message = format!("'{name}' may be changed by '{function}', which is not read");
            let why = Problem::new(Code::Foreign, &span, message, "this");
            self.break_list(&name, &why.help("assign the whole list at once"))?;
        }
        Ok(())
    }

    /// Refuses a change of a list in a line that is not read: `print(h.pop())`.
    pub(super) fn refuse_changes_among(&self, parser: &mut Parser<'_>, begin: usize) -> Result<(), Problem> {
        let end = parser.position();
        parser.go_to(begin);
        let mut found = None;
        while parser.position() < end {
            let (name, dot, method) = (parser.next(), parser.peek(), parser.ahead(1));
            let is_list = self.workspace.holds_a_list(&name.text) || name.is("]") || name.is(")");
            if is_list
                && dot.is(".")
                && CHANGING.contains(&method.text.as_str())
                && self.dialect == Dialect::Python
            {
                found.get_or_insert((method.text.clone(), method.span.clone()));
            }
        }
        match found {
            Some((method, span)) => {
                let message = format!("a list is changed by '{method}' within a line that is not read");
                Err(Problem::new(Code::Foreign, &span, message, "this").help("assign the whole list at once"))
            }
            None => Ok(()),
        }
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
