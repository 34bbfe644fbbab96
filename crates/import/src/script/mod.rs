//! The text of Julia, Python, MATLAB and printed formulas, as far as models need it: tokens, syntax, and what expressions mean.
//! Nothing is ever run: what is not an expression or an assignment is refused at its line.

mod calls;
mod elements;
mod forms;
mod meaning;
mod parser;
mod syntax;
mod tokens;
mod values;
mod workspace;

pub(super) use meaning::{MOST_CASES, made_number, meaning, named_function};
pub(super) use parser::Parser;
pub(super) use syntax::{Syntax, SyntaxKind};
pub(super) use tokens::{Dialect, Token, TokenKind, tokens};
pub(super) use values::{Form, ScriptValue};
pub(super) use workspace::ScriptWorkspace;
