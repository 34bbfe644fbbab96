//! Assignments of Julia outside of all brackets. They are not run: one to a name that is declared, and one that changes a list of equations, would
//! make another model of the file, and is refused.

use super::declared::Declared;
use crate::script::{Token, TokenKind};
use palmistry_lang::{Code, Problem};
use std::collections::BTreeSet;
use std::ops::Range;

/// An assignment.
pub(super) struct Assignment {
    /// The token of the name.
    pub name: usize,
    /// The tokens of the right side.
    pub right: Range<usize>,
}

/// Signs that assign.
const ASSIGNING: [&str; 5] = ["=", "+=", "-=", "*=", "/="];

/// More tokens than these are no index.
const LONGEST_INDEX: usize = 200;

/// Words behind which a statement begins in the same line.
const BEFORE: [&str; 9] = ["const", "global", "local", "let", "begin", "else", "try", "do", "finally"];

/// Where the bracket that begins at a token is closed.
pub(super) fn closing(words: &[Token], begin: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, word) in words.iter().enumerate().skip(begin) {
        match word.kind {
            TokenKind::Sign("(" | "[" | "{") => depth += 1,
            TokenKind::Sign(")" | "]" | "}") => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(at);
                }
            }
            _ => {}
        }
    }
    None
}

/// Where the statement that goes on at a token ends.
fn end_of_statement(words: &[Token], begin: usize) -> usize {
    let (mut at, mut depth) = (begin, 0_usize);
    while at < words.len() && words[at].kind != TokenKind::End {
        // a line that ends in an operator goes on
        let goes_on = at == begin
            || matches!(&words[at - 1].kind, TokenKind::Sign(sign) if !matches!(*sign, ")" | "]" | "}" | "'" | ";" | ".'" | "..."));
        if depth == 0 && (words[at].newline && !goes_on || words[at].is(";")) {
            break;
        }
        match words[at].kind {
            TokenKind::Sign("(" | "[" | "{") => depth += 1,
            TokenKind::Sign(")" | "]" | "}") => depth = depth.saturating_sub(1),
            _ => {}
        }
        at += 1;
    }
    at
}

/// All assignments outside of brackets and declarations, in the order of the file.
pub(super) fn assignments(words: &[Token], declared: &Declared) -> Vec<Assignment> {
    let assigns = |at: usize| words.get(at).is_some_and(|word| ASSIGNING.iter().any(|sign| word.is(sign)));
    let mut declarations = declared.blocks.iter().peekable();
    let (mut found, mut depth) = (Vec::new(), 0_usize);
    for (at, word) in words.iter().enumerate() {
        while declarations.next_if(|block| block.end <= at).is_some() {}
        let is_declared = declarations.peek().is_some_and(|block| block.contains(&at));
        let behind = at.checked_sub(1).map(|at| &words[at]);
        let begins = word.newline
            || behind.is_none_or(|last| last.is(";") || BEFORE.iter().any(|own| last.is_word(own)));
        if depth == 0 && !is_declared {
            let is_tuple = word.is("(") && begins;
            // a chain assigns to each of its names: a = b = 2
            let in_chain = word.kind == TokenKind::Name && assigns(at + 1);
            let end = match is_tuple {
                true => closing(words, at).map(|close| close + 1),
                false => {
                    let mut end = at + 1;
                    while begins && words.get(end).is_some_and(|word| word.is(",")) && end + 1 < words.len() {
                        end += 2;
                    }
                    Some(end)
                }
            };
            if let Some(end) = end.filter(|end| assigns(*end) && (in_chain || begins)) {
                // what is assigned to several names ends once
                let known = found.last().map(|one: &Assignment| one.right.clone());
                let stop = match known.filter(|right| right.contains(&end)) {
                    Some(right) => right.end,
                    None => end_of_statement(words, end + 1),
                };
                let right = end + 1..stop;
                let names = (at..end).filter(|at| words[*at].kind == TokenKind::Name);
                found.extend(names.map(|name| Assignment { name, right: right.clone() }));
            }
            if word.is_word("for") && words.get(at + 1).is_some_and(|next| next.kind == TokenKind::Name) {
                found.push(Assignment { name: at + 1, right: at + 2..at + 2 });
            }
        }
        match word.kind {
            TokenKind::Sign("(" | "[" | "{") => depth += 1,
            TokenKind::Sign(")" | "]" | "}") => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    found
}

/// Refuses assignments to names that are declared, above the last list of equations, which begins at a token: what the equations have is then the value, and no symbol.
pub(super) fn refuse_assigned(
    words: &[Token],
    assignments: &[Assignment],
    declared: &Declared,
    last: usize,
) -> Result<(), Problem> {
    for one in assignments.iter().filter(|one| one.name < last) {
        let name = &words[one.name].text;
        let (is_parameter, is_variable) =
            (declared.constants.contains(name), declared.variables.contains(name));
        // k = @parameters k
        let is_declaration = words[one.right.clone()].first().is_some_and(|first| first.is("@"));
        if !(is_parameter || is_variable || declared.bare.contains(name)) || is_declaration {
            continue;
        }
        let message = format!("'{name}' is declared, and something else is assigned to it here");
        let help = match is_variable {
            true => format!(
                "write the expression where it is used, or an equation {name} ~ ... in the list of equations"
            ),
            false => format!(
                "write its value where it is declared: @parameters {name} = 2.0; or the value where it is used"
            ),
        };
        return Err(Problem::new(Code::Foreign, &words[one.name].span, message, "this assignment").help(help));
    }
    Ok(())
}

/// Refuses what changes a list of equations in its place: `append!(eqs, more)`, `eqs[1] = other`.
pub(super) fn refuse_changed(words: &[Token], named: &BTreeSet<&str>) -> Result<(), Problem> {
    let refused = |name: &Token, by: &str| {
        let message = format!("the equations '{}' are changed by {by}, which is not read", name.text);
        Err(Problem::new(Code::Foreign, &name.span, message, "this")
            .help("write all equations into one list; lists are joined by vcat(a, b) or [a; b]"))
    };
    for (at, word) in words.iter().enumerate().filter(|(_, word)| named.contains(word.text.as_str())) {
        let before = |by: usize| at.checked_sub(by).map(|at| &words[at]);
        if let (Some(open), Some(call)) = (before(1), before(2))
            && open.is("(")
            && call.kind == TokenKind::Name
            && call.text.ends_with('!')
        {
            return refused(word, &format!("'{}'", call.text));
        }
        let is_index = words.get(at + 1).is_some_and(|next| next.is("[") && !next.spaced);
        if is_index
            && let Some(close) = closing(&words[..words.len().min(at + LONGEST_INDEX)], at + 1)
            && words.get(close + 1).is_some_and(|next| ASSIGNING.iter().any(|sign| next.is(sign)))
        {
            return refused(word, "an assignment to an element");
        }
    }
    Ok(())
}
