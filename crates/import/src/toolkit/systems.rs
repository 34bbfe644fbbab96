//! Lists of equations, and which of them a system is made of.

use super::assigned::{Assignment, closing};
use super::declared::Declared;
use crate::script::{Dialect, Parser, Syntax, SyntaxKind, Token, TokenKind};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::BTreeSet;
use std::ops::Range;

/// A list of equations, and what it is assigned to.
pub(super) struct Equations {
    pub name: Option<String>,
    /// The token with which it begins.
    pub at: usize,
    pub list: Vec<Syntax>,
}

impl Equations {
    /// Whether it says what is measured.
    pub fn is_measured(&self) -> bool {
        let name = self.name.as_deref().unwrap_or_default().to_lowercase();
        (name.contains("measured") || name.contains("output") || name.contains("observ"))
            && !name.contains("observer")
    }
}

/// What makes a system of equations.
const CONSTRUCTORS: [&str; 2] = ["ODESystem", "System"];

/// What changes a model and is not read, with what it is.
const UNREAD: [(&str, &str); 15] = [
    ("discrete_events", "events are not read"),
    ("continuous_events", "events are not read"),
    ("SymbolicDiscreteCallback", "events are not read"),
    ("SymbolicContinuousCallback", "events are not read"),
    ("SDESystem", "stochastic equations are not read"),
    ("brownian", "stochastic equations are not read"),
    ("JumpSystem", "jumps are not read"),
    ("PDESystem", "partial differential equations are not read"),
    ("ReactionSystem", "reactions are not read"),
    ("reaction_network", "reactions are not read"),
    ("compose", "a system made of systems is not read"),
    ("connect", "a system made of systems is not read"),
    ("components", "a system made of systems is not read"),
    ("extend", "a system made of systems is not read"),
    ("systems", "a system made of systems is not read"),
];

/// What changes the meaning of a model and is not read.
pub(super) fn refuse_unread(words: &[Token]) -> Result<(), Problem> {
    for (at, word) in words.iter().enumerate() {
        let Some((_, what)) = UNREAD.iter().find(|(name, _)| word.is_word(name)) else { continue };
        let next = &words[(at + 1).min(words.len() - 1)];
        let is_macro = at > 0 && words[at - 1].is("@");
        if is_macro || next.is("(") || next.is("=") {
            return Err(Problem::new(Code::Foreign, &word.span, (*what).to_owned(), "this")
                .help("write the model as one list of equations D(x) ~ ..., that hold at all times"));
        }
    }
    let mut models = words.windows(2).filter(|two| two[0].is("@") && two[1].is_word("mtkmodel"));
    match (models.next(), models.next()) {
        (Some(_), Some(second)) => {
            let message = "the file has several @mtkmodel";
            Err(Problem::new(Code::Foreign, &second[1].span, message, "the second one")
                .help("put each of them into a file of its own"))
        }
        _ => Ok(()),
    }
}

/// All lists of equations, `[... ~ ..., ...]` and `@equations begin ... end`.
pub(super) fn equations(words: &[Token]) -> Result<Vec<Equations>, Problem> {
    let outside = |word: &Token| {
        Problem::new(Code::Foreign, &word.span, "an equation outside of a list", "this")
            .help("put equations into lists: eqs = [D(x) ~ ...] and measured_quantities = [y ~ x]")
    };
    let mut lists = Vec::new();
    // where brackets begin, and the sign '~' in them
    let mut open: Vec<(usize, Option<usize>)> = Vec::new();
    for (at, word) in words.iter().enumerate() {
        match word.kind {
            TokenKind::Sign("[" | "(" | "{") => open.push((at, None)),
            TokenKind::Sign("~") => match open.last_mut() {
                Some((_, sign)) => *sign = Some(at),
                None if !within_block(words, at) => return Err(outside(word)),
                None => {}
            },
            TokenKind::Sign("]" | ")" | "}") => {
                let Some((begin, Some(sign))) = open.pop() else { continue };
                if !words[begin].is("[") {
                    // a bracket around an equation is none of a call: [(D(x) ~ ...), ...]
                    let is_call = begin > 0
                        && !words[begin].spaced
                        && (words[begin - 1].kind == TokenKind::Name || words[begin - 1].is(")"));
                    match open.last_mut().filter(|_| !is_call && words[begin].is("(")) {
                        Some((_, outer)) => *outer = Some(sign),
                        None => return Err(outside(&words[sign])),
                    }
                    continue;
                }
                let is_event = begin > 0 && words[begin - 1].is("=>")
                    || words.get(at + 1).is_some_and(|next| next.is("=>"));
                if is_event {
                    return Err(Problem::new(
                        Code::Foreign,
                        &words[sign].span,
                        "events are not read",
                        "this equation",
                    )
                    .help(
                        "events change states in jumps: take them out, and look at the time between them",
                    ));
                }
                let mut parser = Parser::new(words, Dialect::Julia);
                parser.go_to(begin);
                let list = parser.expression()?;
                let name =
                    std::iter::once(begin).chain(open.iter().rev().map(|(at, _)| *at)).find_map(|at| {
                        let named =
                            at.checked_sub(2).filter(|_| words[at].is("[") && words[at - 1].is("="))?;
                        Some(words[named].text.clone())
                    });
                let list = list.elements().into_iter().cloned().collect();
                lists.push(Equations { name, at: begin, list });
            }
            TokenKind::Sign("@") if words.get(at + 1).is_some_and(|word| word.is_word("equations")) => {
                let mut parser = Parser::new(words, Dialect::Julia);
                parser.go_to(at + 2);
                if !parser.peek().is_word("begin") {
                    return Err(parser.unexpected("'begin'"));
                }
                parser.next();
                let mut list = Vec::new();
                while !parser.peek().is_word("end") && !parser.at_end() {
                    list.push(parser.argument()?);
                    parser.take(";");
                }
                lists.push(Equations { name: None, at, list });
            }
            _ => {}
        }
    }
    Ok(lists)
}

/// Whether a token stands in `@equations begin ... end`.
fn within_block(words: &[Token], at: usize) -> bool {
    let begin = words[..at].iter().rposition(|word| word.is_word("equations"));
    begin.is_some_and(|begin| !words[begin..at].iter().any(|word| word.is_word("end")))
}

/// A system: what it is called, where it is made, and which lists it is made of.
struct Made {
    name: Option<String>,
    at: usize,
    lists: BTreeSet<usize>,
}

/// What a system is looked for in.
pub(super) struct File<'f> {
    pub words: &'f [Token],
    pub lists: &'f [Equations],
    pub assigned: &'f [Assignment],
    pub budget: &'f Budget,
}

/// The lists of the system of a file, or of the one of several that has a name or number, and what has to be said of that.
pub(super) fn chosen(
    file: &File<'_>,
    declared: &Declared,
    which: Option<&str>,
) -> Result<(BTreeSet<usize>, Option<String>), Problem> {
    let File { words, lists, .. } = *file;
    let mut systems: Vec<Made> = Vec::new();
    for (at, word) in words.iter().enumerate() {
        let is_one = CONSTRUCTORS.iter().any(|name| word.is_word(name))
            && words.get(at + 1).is_some_and(|next| next.is("(") && !next.spaced);
        if is_one && let Some(made) = file.made_of(at)? {
            systems.push(made);
        }
    }
    file.look_at_reassigned(systems.is_empty())?;
    let line = |made: &Made| {
        let name = made.name.as_deref().map_or(String::new(), |name| format!(" '{name}'"));
        format!("{name} of {}", named(lists, &made.lists))
    };
    let list = || {
        let each = systems.iter().enumerate().map(|(at, made)| format!("{}{}", at + 1, line(made)));
        each.take(30).collect::<Vec<_>>().join(", ")
    };
    let wanted = |wanted: &str| {
        let mut same = systems.iter().filter(|made| made.name.as_deref() == Some(wanted));
        match (same.next(), same.next()) {
            (Some(one), None) => Some(one),
            _ => systems.get(wanted.parse::<usize>().ok()?.checked_sub(1)?),
        }
    };
    let one = match (which, systems.as_slice()) {
        (None | Some("1"), []) => None,
        (Some(name), _) => Some(wanted(name).ok_or_else(|| {
            let place = systems.first().map_or(0..1, |made| words[made.at].span.clone());
            Problem::new(Code::Foreign, &place, format!("the file has no model '{name}'"), "a model").help(
                match systems.len() {
                    0 => "it has one model".to_owned(),
                    _ => format!("it has {}", list()),
                },
            )
        })?),
        (None, [first, others @ ..]) => match others.iter().find(|made| made.lists != first.lists) {
            Some(other) => {
                let message = format!("the file has {} systems", systems.len());
                return Err(Problem::new(Code::Foreign, &words[other.at].span, message, "another one")
                    .help(format!("say which with --model NAME or --model NUMBER: {}", list())));
            }
            None => Some(first),
        },
    };
    let equations: BTreeSet<usize> =
        (0..lists.len()).filter(|at| !lists[*at].is_measured() || has_rates(&lists[*at], declared)).collect();
    Ok(match one {
        Some(made) => {
            let others: BTreeSet<usize> = equations.difference(&made.lists).copied().collect();
            let remark = (!others.is_empty()).then(|| {
                format!("equations that the system does not have are left out: {}", named(lists, &others))
            });
            (made.lists.clone(), remark)
        }
        None => {
            let remark = (equations.len() > 1)
                .then(|| format!("several lists are read as one system: {}", named(lists, &equations)));
            (equations, remark)
        }
    })
}

/// Whether a list has a derivative on some left side; what is measured has none.
pub(super) fn has_rates(list: &Equations, declared: &Declared) -> bool {
    list.list.iter().any(|one| match &one.kind {
        SyntaxKind::Equation("~", left, _) => !matches!(declared.derivative(left), Ok(None)),
        _ => false,
    })
}

fn named(lists: &[Equations], which: &BTreeSet<usize>) -> String {
    let name = |at: &usize| lists[*at].name.clone().unwrap_or_else(|| format!("list {}", at + 1));
    which.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// Functions of lists of equations that leave them as they are.
const JOINING: [&str; 5] = ["vcat", "collect", "copy", "deepcopy", "scalarize"];

impl File<'_> {
    /// What a constructor makes a system of; none where it has no first argument.
    fn made_of(&self, at: usize) -> Result<Option<Made>, Problem> {
        let words = self.words;
        let name = at
            .checked_sub(2)
            .filter(|_| words[at - 1].is("="))
            .map(|at| words[at].text.clone())
            .filter(|name| !name.is_empty());
        let end = closing(words, at + 1).unwrap_or(words.len() - 1);
        let first = self.divided(at + 2..end).into_iter().next().filter(|_| !words[at + 2].is(";"));
        let Some(first) = first.filter(|first| !self.has_equals(first)) else { return Ok(None) };
        let lists = self.lists_of(first, at)?;
        Ok((!lists.is_empty()).then_some(Made { name, at, lists }))
    }

    /// Whether a piece of code is `name = value`.
    fn has_equals(&self, range: &Range<usize>) -> bool {
        range.len() > 1 && self.words[range.start + 1].is("=")
    }

    /// The parts of a piece of code that commas, semicolons and ends of lines divide, outside of inner brackets.
    fn divided(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let (mut parts, mut begin, mut depth) = (Vec::new(), range.start, 0_usize);
        for at in range.clone() {
            let word = &self.words[at];
            if depth == 0 && word.newline && at > begin {
                parts.push(begin..at);
                begin = at;
            }
            match word.kind {
                TokenKind::Sign("(" | "[" | "{") => depth += 1,
                TokenKind::Sign(")" | "]" | "}") => depth = depth.saturating_sub(1),
                TokenKind::Sign("," | ";") if depth == 0 => {
                    parts.push(begin..at);
                    begin = at + 1;
                }
                _ => {}
            }
        }
        parts.push(begin..range.end);
        parts.retain(|part| !part.is_empty());
        parts
    }

    /// The lists that a piece of code puts together: a list, the name of one, `vcat(a, b)`, `[a; b]`. A name is what was assigned to it last before
    /// `before`.
    ///
    /// # Errors
    /// Code that makes other equations of a list: nothing of it is run.
    fn lists_of(&self, range: Range<usize>, before: usize) -> Result<BTreeSet<usize>, Problem> {
        let words = self.words;
        let pay = |steps: usize| {
            self.budget.steps(steps).map_err(|spent| crate::too_much(&words[range.start].span, spent))
        };
        let mut found = BTreeSet::new();
        let mut open = vec![(range.clone(), before)];
        while let Some((part, before)) = open.pop() {
            pay(self.lists.len() + self.assigned.len() + 10 * part.len())?;
            let refused = |part: &Range<usize>| {
                let place = words[part.start].span.start..words[part.end - 1].span.end;
                let message =
                    "these equations are no list, and no lists put together: what changes them is not read";
                Problem::new(Code::Foreign, &place, message, "this").help(
                    "write them as one list, eqs = [D(x) ~ ..., ...], with everything put in; lists are joined by vcat(a, b) or [a; b]",
                )
            };
            let part = match words[part.clone()].last() {
                Some(last) if last.is("...") && part.len() > 1 => part.start..part.end - 1,
                Some(_) => part,
                None => continue,
            };
            let (first, ends) =
                (&words[part.start], |begin: usize| closing(words, begin) == Some(part.end - 1));
            if part.len() == 1 && first.kind == TokenKind::Name {
                let of_name = |one: &&Assignment| one.name < before && words[one.name].text == first.text;
                if let Some(one) = self.assigned.iter().rev().find(of_name) {
                    if one.right.is_empty() || !words[one.right.start - 1].is("=") {
                        return Err(refused(&(one.name..one.right.start.max(one.name + 1))));
                    }
                    open.push((one.right.clone(), one.name));
                    continue;
                }
                let own = (0..self.lists.len())
                    .filter(|at| self.lists[*at].name.as_deref() == Some(first.text.as_str()));
                let own: Vec<usize> = own.collect();
                if own.is_empty() {
                    return Err(refused(&part));
                }
                found.extend(own);
                continue;
            }
            // Equation[...]
            let bracket = part.start + usize::from(first.is_word("Equation"));
            if words[bracket].is("[") && ends(bracket) {
                match (0..self.lists.len()).find(|at| self.lists[*at].at == bracket) {
                    Some(own) => drop(found.insert(own)),
                    None => open
                        .extend(self.divided(bracket + 1..part.end - 1).into_iter().map(|one| (one, before))),
                }
                continue;
            }
            if first.is("(") && ends(part.start) {
                open.push((part.start + 1..part.end - 1, before));
                continue;
            }
            // Symbolics.scalarize(...)
            let behind = part.start + if words[(part.start + 1).min(part.end - 1)].is(".") { 2 } else { 0 };
            let is_joined = behind + 1 < part.end
                && JOINING.iter().any(|name| words[behind].is_word(name))
                && words[behind + 1].is("(")
                && ends(behind + 1);
            if !is_joined {
                return Err(refused(&part));
            }
            open.extend(self.divided(behind + 2..part.end - 1).into_iter().map(|one| (one, before)));
        }
        Ok(found)
    }

    /// Looks at what is assigned to names of lists, where no constructor says which of them counts, and at all that is measured.
    fn look_at_reassigned(&self, all: bool) -> Result<(), Problem> {
        let counts = |list: &&Equations| all || list.is_measured();
        let named: BTreeSet<&str> =
            self.lists.iter().filter(counts).filter_map(|list| list.name.as_deref()).collect();
        for one in self.assigned.iter().filter(|one| named.contains(self.words[one.name].text.as_str())) {
            if !one.right.is_empty() {
                self.lists_of(one.right.clone(), one.name)?;
            }
        }
        Ok(())
    }
}
