//! What a file defines, as it is written: for those who write it in another language.

use super::grammar::parse_entries;
use super::model::System;
use super::syntax::Item;
use palmistry_math::expression::syntax::{Expr, Name};
use std::path::PathBuf;

/// A definition, a field or an output as it stands in a file.
#[derive(Clone, Debug)]
pub enum Entry {
    /// `let name = value`
    Definition {
        /// Its name.
        name: String,
        /// What it stands for.
        value: Expr,
    },
    /// `drift`, `input` or `field`, with the rate of each state that it names.
    Field {
        /// Its name.
        name: String,
        /// The states and their rates.
        components: Vec<(Name, Expr)>,
        /// Whether it takes states to their successors.
        is_map: bool,
    },
    /// `output value`
    Output {
        /// What is measured.
        value: Expr,
    },
}

/// The definitions, fields and outputs of a text that has no mistake, in its order.
pub fn entries_of(text: &str) -> Vec<Entry> {
    let entries = |item| match item {
        Item::Let { name, value, .. } => vec![Entry::Definition { name: name.text, value }],
        Item::Field { name, components, is_map, .. } => {
            vec![Entry::Field { name: name.text, components, is_map }]
        }
        Item::Output(list) => list.into_iter().map(|one| Entry::Output { value: one.value }).collect(),
        _ => Vec::new(),
    };
    parse_entries(text, 1).items.into_iter().flat_map(entries).collect()
}

impl System {
    /// The names that this file gives to imported systems, and where these are.
    pub fn imports(&self) -> &[(String, PathBuf)] {
        &self.aliases
    }
}
