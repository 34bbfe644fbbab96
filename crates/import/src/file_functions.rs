//! The functions that a file of Julia defines itself, whose names mean something else than elsewhere.

use super::script::{Syntax, Token, TokenKind, named_function};
use palmistry_lang::{Code, Problem};
use std::collections::BTreeSet;

/// The functions that a file defines itself: what they are is not read, whatever they are called.
pub(super) struct FileFunctions(BTreeSet<String>);

impl FileFunctions {
    /// Those of `f(x) = ...`, `f = x -> ...`, `function f(x)` and `@register_symbolic f(x)`, outside of all brackets.
    pub fn of(words: &[Token]) -> FileFunctions {
        let mut found = BTreeSet::new();
        let mut depth = 0_usize;
        for (at, word) in words.iter().enumerate() {
            let next = |by: usize| &words[(at + by).min(words.len() - 1)];
            match word.kind {
                TokenKind::Sign("(" | "[" | "{") => depth += 1,
                TokenKind::Sign(")" | "]" | "}") => depth = depth.saturating_sub(1),
                TokenKind::Name if depth == 0 => {
                    let is_named = at > 0
                        && (words[at - 1].is_word("function")
                            || ["register", "register_symbolic"]
                                .iter()
                                .any(|name| words[at - 1].is_word(name)));
                    let begins =
                        at == 0 || word.newline || words[at - 1].is(";") || words[at - 1].is_word("const");
                    let is_lambda = next(1).is("=")
                        && (next(3).is("->")
                            || next(2).is("(")
                                && closed(words, at + 2).is_some_and(|end| words[end].is("->")));
                    let is_defined = next(1).is("(")
                        && !next(1).spaced
                        && closed(words, at + 1).is_some_and(|end| words[end].is("="));
                    if is_named && next(1).is("(") || begins && (is_lambda || is_defined) {
                        found.insert(word.text.clone());
                    }
                }
                _ => {}
            }
        }
        FileFunctions(found)
    }

    /// Refuses a call of one of them.
    pub fn refuse(&self, part: &Syntax) -> Result<(), Problem> {
        match named_function(part) {
            Some((name, _)) if self.0.contains(name) => {
                let message = format!("'{name}' is a function that the file defines: it is not read");
                Err(Problem::new(Code::Foreign, &part.span, message, "this call")
                    .help("write its formula in its place"))
            }
            _ => Ok(()),
        }
    }
}

/// Where the bracket that begins at a token is behind its end, if it ends soon.
fn closed(words: &[Token], begin: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, word) in words.iter().enumerate().skip(begin).take(LONGEST_HEAD) {
        match word.kind {
            TokenKind::Sign("(" | "[" | "{") => depth += 1,
            TokenKind::Sign(")" | "]" | "}") => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return (at + 1 < words.len()).then_some(at + 1);
                }
            }
            _ => {}
        }
    }
    None
}

/// More tokens than these have no arguments of a function.
const LONGEST_HEAD: usize = 400;
