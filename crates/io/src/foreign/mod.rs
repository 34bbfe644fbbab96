//! What strangers wrote: how it is shown, and how much of it is taken in.
//!
//! A file may come from anybody. Whatever of it is shown, on a terminal, in a page, in Markdown or as JSON, goes through
//! [`shown`]; whatever it makes the program do is paid from a [`Budget`].

mod outlet;
mod text;

pub use outlet::{json_text, terminal};
pub use palmistry_budget::{Allowance, Budget, Spent, spent_in_all};
pub use text::{code_block, code_span, html, markdown, name_of, read_line, shown, shown_path};
