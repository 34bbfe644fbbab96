//! How names look in formulas, where a file says it: `latex Fyf "F_{yf}"`.

use super::codes::Code;
use super::elaborate::Wanted;
use super::error::Problem;
use super::model::System;
use super::syntax::Item;
use palmistry_math::expression::notation::FormulaName;
use palmistry_math::expression::syntax::{Name, Span};
use std::collections::HashMap;
use std::sync::Arc;

/// So much of a look is shown where it is none.
const SHOWN: usize = 40;

impl System {
    /// Looks of names that are declared above.
    pub(super) fn enter_looks(&mut self, list: &[(Name, String, Span)]) -> Result<(), Problem> {
        for (name, latex, span) in list {
            let is_known = self.find_symbol(&name.text).is_some()
                || self.definitions.contains_key(&name.text)
                || self.field(&name.text).is_some()
                || self.vectors.contains(&name.text);
            if !is_known {
                return Err(self.unknown(&name.text, &name.span, Wanted::Name));
            }
            let Some(look) = FormulaName::of_latex(latex) else {
                let shown: String = latex.chars().take(SHOWN).collect();
                let message = format!("'{shown}' is no letter with accents and an index");
                return Err(Problem::new(Code::View, span, message, "how it looks").help(
                    "as in \"F_{yf}\", \"\\alpha_f\" or \"\\dot{x}_1\", without superscripts; words stand in \\mathrm{...}",
                ));
            };
            if Arc::make_mut(&mut self.looks).insert(name.text.clone(), look).is_some() {
                let message = format!("'{}' has a look already", name.text);
                return Err(Problem::new(Code::Twice, &name.span, message, "the second time"));
            }
        }
        Ok(())
    }

    /// Where a look is that of another name too, by what the file says or by its letters: a page would state another system.
    pub(super) fn looks_alike(&self, items: &[Item]) -> Vec<Problem> {
        if self.looks.is_empty() {
            return Vec::new();
        }
        let symbols = self.symbols.keys().map(|symbol| self.symbol_name(*symbol));
        let names = symbols
            .chain(self.definitions.keys().map(String::as_str))
            .chain(self.vectors.iter().map(String::as_str));
        let mut by_look: HashMap<FormulaName, Vec<&str>> = HashMap::new();
        // copies in further experiments, derivatives and components look like what they are of
        for name in names.filter(|name| !name.contains(['@', '\'', '['])) {
            let look = self.looks.get(name).cloned().or_else(|| FormulaName::of(name));
            if let Some(look) = look {
                by_look.entry(look).or_default().push(name);
            }
        }
        let given = items.iter().flat_map(|item| match item {
            Item::Looks(list) => list.as_slice(),
            _ => &[],
        });
        let mut found = Vec::new();
        for (name, _, span) in given {
            let others = self.looks.get(&name.text).and_then(|look| by_look.get(look));
            if let Some(other) = others.into_iter().flatten().filter(|other| **other != name.text).min() {
                let message = format!("'{other}' looks so, and is something else");
                let problem = Problem::new(Code::View, span, message, "two names of one look");
                found.push(problem.help("choose another look"));
            }
        }
        found
    }
}
