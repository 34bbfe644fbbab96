//! Names and short expressions within a sentence or a table.

use crate::formula::formula_mathml_in;
use maud::{Markup, PreEscaped, html};
use palmistry_lang::Looks;

/// A name or an expression as mathematics; as it is written where it is none.
pub(super) fn in_line(text: &str, looks: &Looks) -> Markup {
    formula_mathml_in(text, looks).map_or_else(|| html! { (text) }, PreEscaped)
}
