//! All that is wrong with a file, and not only what is met first.
//!
//! There is one reader. What it finds wrong goes to a list that takes so many problems: one, where a file is to be used and
//! the first of them ends the reading; more, where somebody asks what has to be mended. Behind a problem the reader goes on: a
//! syntax error is left at the next line that begins an entry, no further to the right than the entry that failed; and an
//! entry that means nothing leaves its names *broken*, so that what only follows from it is not told again.

use super::elaborate::Wanted;
use super::entry_words::ENTRIES;
use super::error::Problem;
use super::model::System;
use super::signals;
use super::syntax::{Item, Statement};
use palmistry_math::expression::parse::ends_a_line;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Span};
use std::collections::HashSet;

/// Who asks for all mistakes of a file is told no more than this many: behind so many, most are one and the same.
pub const MOST_PROBLEMS: usize = 100;

/// On what a problem may rest, so that it says nothing where that is broken itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Cause {
    /// On nothing else.
    #[default]
    Itself,
    /// On a name that is not known.
    Unknown(String),
    /// On the fields of the file: none of them moves the states.
    Motion,
    /// On how many rows and columns there are, and so on how many states.
    Shape,
    /// On the entry that names the system.
    Title,
}

/// No more problems can be taken: the reading ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Full;

/// What is found wrong, in the order in which it is found.
#[derive(Debug)]
pub(super) struct Problems {
    most: usize,
    found: Vec<Problem>,
    /// Whether there is at least one more.
    pub more: bool,
    /// Names whose declaration failed.
    broken: HashSet<String>,
    /// The words of the entries that failed.
    failed: HashSet<&'static str>,
}

impl Problems {
    /// A list of at most so many, of one at the least.
    pub fn up_to(most: usize) -> Problems {
        let (found, broken, failed) = Default::default();
        Problems { most: most.max(1), found, more: false, broken, failed }
    }

    /// Whether the reader goes on behind a problem.
    pub fn goes_on(&self) -> bool {
        self.most > 1
    }

    /// How many more are taken.
    pub fn room(&self) -> usize {
        // one more than is listed, so that it is known whether there are more
        let reserve = usize::from(self.most > 1);
        self.most - self.found.len() + reserve
    }

    /// Takes a problem, unless it follows from another one or is known.
    pub fn add(&mut self, problem: Problem) -> Result<(), Full> {
        let known = |known: &Problem| known.span == problem.span && known.message == problem.message;
        if self.follows(&problem.cause) || self.found.iter().any(known) {
            return Ok(());
        }
        if self.found.len() == self.most {
            self.more = true;
            return Err(Full);
        }
        self.found.push(problem);
        if self.most == 1 { Err(Full) } else { Ok(()) }
    }

    fn follows(&self, cause: &Cause) -> bool {
        let failed = |words: &[&str]| words.iter().any(|word| self.failed.contains(word));
        match cause {
            Cause::Itself => false,
            // what is imported has the name of its system before a dot
            Cause::Unknown(name) => {
                let parts = name.match_indices(['.', '[']).map(|(at, _)| &name[..at]);
                parts.chain([name.as_str()]).any(|part| self.broken.contains(part))
            }
            Cause::Motion => failed(&["drift", "input", "field"]),
            Cause::Shape => failed(&["state", "use"]),
            Cause::Title => failed(&["system"]),
        }
    }

    /// Notes an entry that failed, and the names that it would have declared.
    pub fn break_names(&mut self, word: &'static str, names: impl IntoIterator<Item = String>) {
        self.failed.insert(word);
        self.broken.extend(names);
    }

    /// All of them.
    pub fn into_found(self) -> Vec<Problem> {
        self.found
    }
}

/// Where reading goes on behind an entry that failed: at the next line that begins with the word of an entry and is not
/// further to the right than `column`. At the end of the text where there is none.
pub(super) fn next_entry(text: &str, failed: usize, column: usize) -> usize {
    let mut at = failed;
    while let Some(end) = text[at..].find(ends_a_line) {
        at += end + text[at + end..].chars().next().map_or(1, char::len_utf8);
        let line = text[at..].split(ends_a_line).next().unwrap_or_default();
        let indent = line.len() - line.trim_start().len();
        if indent <= column && first_entry_word(line).is_some() {
            return at + indent;
        }
    }
    text.len()
}

/// How far the line of a place is indented.
pub(super) fn indentation(text: &str, at: usize) -> usize {
    let begin = text[..at]
        .rfind(ends_a_line)
        .map_or(0, |end| end + text[end..].chars().next().map_or(1, char::len_utf8));
    let line = &text[begin..];
    line.len() - line.trim_start_matches([' ', '\t']).len()
}

/// Whether nothing but blanks stands before a place in its line.
pub(super) fn is_first_in_line(text: &str, at: usize) -> bool {
    let line = text[..at].rsplit(ends_a_line).next().unwrap_or_default();
    line.trim_start().is_empty()
}

/// The place of something that is missing: where it was missed is the beginning of another entry, at the end of what stands before
/// that.
pub(super) fn missing_before(text: &str, begin: usize, at: usize) -> usize {
    if at <= begin || !is_first_in_line(text, at) || first_entry_word(&text[at..]).is_none() {
        return at;
    }
    let (mut end, mut comment, mut quoted) = (begin, false, false);
    for (place, c) in text[begin..at].char_indices() {
        quoted ^= c == '"' && !comment;
        comment = (comment || c == '#' && !quoted) && !ends_a_line(c);
        if !comment && !c.is_whitespace() && !ends_a_line(c) {
            end = begin + place + c.len_utf8();
        }
    }
    end
}

/// The place of the last quotation mark of an entry, if it closes nothing.
pub(super) fn open_quotation(entry: &str) -> Option<usize> {
    let (mut open, mut comment) = (None, false);
    for (at, c) in entry.char_indices() {
        comment = (comment || c == '#' && open.is_none()) && !ends_a_line(c);
        if c == '"' && !comment {
            open = if open.is_none() { Some(at) } else { None };
        }
    }
    open
}

/// The word of the entry that a text begins with.
pub(super) fn first_entry_word(text: &str) -> Option<&'static str> {
    let word = words(text).next()?;
    let rest = text.trim_start().strip_prefix(word)?;
    let entry = ENTRIES.into_iter().find(|entry| *entry == word)?;
    // these are names too, unless a title follows, or what is reduced
    let begins = match entry {
        "set" | "singularity" | "pole" | "map" | "line" => rest.trim_start().starts_with('"'),
        word if signals::WORDS.contains(&word) => signals::goes_on(word, rest),
        "reduction" => words(rest).next() == Some("of"),
        _ => !rest.trim_start().starts_with(['\'', '=']),
    };
    begins.then_some(entry)
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).filter(|word| !word.is_empty())
}

/// The word of an entry that could not be read, and the names that it seems to declare.
pub(super) fn names_of_text(text: &str) -> Option<(&'static str, Vec<String>)> {
    let entry = first_entry_word(text)?;
    let without_comments = text.split(ends_a_line).map(|line| line.split('#').next().unwrap_or_default());
    let text = without_comments.collect::<Vec<_>>().join("\n");
    let rest = text.trim_start().trim_start_matches(entry);
    let names: Vec<String> = match entry {
        "state" | "param" | "angle" | "known" | "unknown" => words(rest).map(str::to_owned).collect(),
        "let" | "drift" | "input" | "field" | "use" => words(rest).take(1).map(str::to_owned).collect(),
        "set" | "singularity" | "pole" | "map" | "line" | "reduction" | "output" | "sample" | "system"
        | "initial" | "experiments" => Vec::new(),
        // ids may have dots and dashes
        _ => rest
            .split(|c: char| !(c.is_alphanumeric() || matches!(c, '.' | '_' | '-')))
            .find(|word| !word.is_empty())
            .map(str::to_owned)
            .into_iter()
            .collect(),
    };
    Some((entry, names))
}

impl Item {
    /// The word that begins the entry, as far as others rest on it.
    fn word(&self) -> &'static str {
        match self {
            Item::System { .. } => "system",
            Item::Use { .. } => "use",
            Item::State(_) => "state",
            Item::Param(_) => "param",
            // what is broken in one of them may be missing wherever a state may
            Item::Signals { .. } => "state",
            Item::Field { role, .. } => role.name(),
            _ => "",
        }
    }

    /// The names that it declares.
    fn declares(&self) -> Vec<String> {
        match self {
            Item::Use { alias: name, .. } | Item::Let { name, .. } | Item::Field { name, .. } => {
                vec![name.text.clone()]
            }
            Item::State(list) | Item::Param(list) => {
                list.iter().map(|declared| declared.name.text.clone()).collect()
            }
            Item::Signals { list, .. } => list.iter().map(|declared| declared.name.text.clone()).collect(),
            _ => Vec::new(),
        }
    }

    /// The expressions in it, but those of claims, which are looked at when all names are known.
    fn expressions(&self) -> Vec<Expr> {
        match self {
            Item::Let { value, .. } => vec![value.clone()],
            Item::Field { components, .. } => components.iter().map(|(_, expr)| expr.clone()).collect(),
            Item::Output(list) | Item::Zero(list) => list.iter().map(|one| one.value.clone()).collect(),
            Item::View(view) => {
                view.equations().into_iter().flat_map(|e| [e.left.clone(), e.right.clone()]).collect()
            }
            Item::Sample { avoid, .. } => avoid.clone(),
            Item::Assume(relations) => {
                relations.iter().flat_map(|one| [one.left.clone(), one.right.clone()]).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// The expressions of which a statement is made.
fn expressions(statement: &Statement) -> Vec<Expr> {
    let sides = |equation: &Equation| {
        let within = equation.within.clone();
        [equation.left.clone(), equation.right.clone()].into_iter().chain(within).collect::<Vec<_>>()
    };
    statement.all_equations().flat_map(sides).collect()
}

/// What is needed to go on behind an entry that fails; nothing where the reading ends there.
pub(super) struct Remnant {
    word: &'static str,
    names: Vec<String>,
    expressions: Vec<Expr>,
}

impl Remnant {
    /// Of an entry that is about to be entered.
    pub fn of(item: &Item, problems: &Problems) -> Remnant {
        match problems.goes_on() {
            true => Remnant { word: item.word(), names: item.declares(), expressions: item.expressions() },
            false => Remnant { word: "", names: Vec::new(), expressions: Vec::new() },
        }
    }

    /// Of a statement of a claim that was checked.
    pub fn of_statement(statement: &Statement, problems: &Problems) -> Remnant {
        let expressions = if problems.goes_on() { expressions(statement) } else { Vec::new() };
        Remnant { word: "", names: Vec::new(), expressions }
    }
}

impl System {
    /// Notes what is wrong with an entry, and everything else that is wrong with the expressions in it.
    pub(super) fn entry_failed(
        &mut self,
        problem: Problem,
        remnant: Remnant,
        problems: &mut Problems,
    ) -> Result<(), Full> {
        problems.add(problem)?;
        for expr in &remnant.expressions {
            let mut unknown = Vec::new();
            self.unknown_names(expr, &mut unknown);
            for problem in unknown {
                problems.add(problem)?;
            }
            if let Err(problem) = self.apart(|system| system.elaborate(expr)) {
                problems.add(problem)?;
            }
        }
        // a name that was declared before has a meaning still
        let is_known = |name: &String| {
            self.find_symbol(name).is_some() || self.definition(name).is_some() || self.field(name).is_some()
        };
        let broken: Vec<String> = remnant.names.into_iter().filter(|name| !is_known(name)).collect();
        problems.break_names(remnant.word, broken);
        Ok(())
    }

    /// The names in an expression that nobody has declared.
    fn unknown_names(&self, expr: &Expr, found: &mut Vec<Problem>) {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Indexed(_) => {}
            ExprKind::Name(name) => {
                let is_known = self.find_symbol(name).is_some() || self.definition(name).is_some();
                if !is_known && !["pi", "rank", "infinity"].contains(&name.as_str()) {
                    found.push(self.unknown(name, &expr.span, Wanted::Name));
                }
            }
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                parts.iter().for_each(|(_, part)| self.unknown_names(part, found));
            }
            ExprKind::Power(inner, _) => self.unknown_names(inner, found),
            ExprKind::RealPower(base, exponent) => {
                [base, exponent].into_iter().for_each(|part| self.unknown_names(part, found));
            }
            ExprKind::Matrix(rows) => {
                rows.iter().flatten().for_each(|entry| self.unknown_names(entry, found));
            }
            ExprKind::At(inner, list) => {
                self.unknown_names(inner, found);
                for (name, value) in list {
                    if self.find_symbol(&name.text).is_none() {
                        found.push(self.unknown(&name.text, &name.span, Wanted::Symbol));
                    }
                    self.unknown_names(value, found);
                }
            }
            ExprKind::Call(name, arguments) if name == "L" => {
                let Some((last, fields)) = arguments.split_last() else { return };
                for field in fields {
                    if let ExprKind::Name(name) = &field.kind
                        && self.field(name).is_none()
                    {
                        found.push(self.unknown(name, &field.span, Wanted::Field));
                    }
                }
                self.unknown_names(last, found);
            }
            // fields stand first, which are looked for where the bracket is
            ExprKind::Call(name, arguments) if name == "bracket" => {
                arguments.iter().skip(2).for_each(|argument| self.unknown_names(argument, found));
            }
            ExprKind::Call(_, arguments) => {
                arguments.iter().for_each(|argument| self.unknown_names(argument, found));
            }
        }
    }
}

/// A part of the text that could not be read: what was expected, and the entry that it belongs to, as far as was left out.
pub(super) struct Damage {
    pub expected: palmistry_math::expression::Expected,
    pub left_out: Span,
}
