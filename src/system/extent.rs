//! How much there is in a system, and the way back to it.
//!
//! To decide a claim, expressions are added to the system's graph and derivatives to its fields. The next claim has to
//! begin where this one began, or its verdict would depend on what was decided before; and a copy of the whole system for
//! each claim would cost as much as the file is long, so that a file of many claims would take time as its square.

use super::model::System;
use crate::expression::{Derivation, Extent, Symbol};
use std::collections::HashMap;

/// How much there is in a system.
#[derive(Clone, Debug)]
pub(crate) struct SystemExtent {
    graph: Extent,
    /// How many derivatives each field of the file knows, in their order.
    fields: Vec<usize>,
    /// The same for the imported fields.
    imported_fields: Vec<usize>,
    /// The same for the derivations by one symbol.
    partials: HashMap<Symbol, usize>,
}

impl System {
    /// How much there is, to come back to.
    pub(crate) fn extent(&self) -> SystemExtent {
        SystemExtent {
            graph: self.graph.extent(),
            fields: self.fields.iter().map(|field| field.derivation.len()).collect(),
            imported_fields: self.imported_fields.iter().map(|field| field.derivation.len()).collect(),
            partials: self.partials.iter().map(|(symbol, known)| (*symbol, known.len())).collect(),
        }
    }

    /// Takes away all expressions and derivatives that were added since: the system is as it was.
    pub(crate) fn shrink_to(&mut self, extent: &SystemExtent) {
        self.graph.shrink_to(&extent.graph);
        for (field, count) in self.fields.iter_mut().zip(&extent.fields) {
            field.derivation.shrink_to(*count);
        }
        for (field, count) in self.imported_fields.iter_mut().zip(&extent.imported_fields) {
            field.derivation.shrink_to(*count);
        }
        self.partials.retain(|symbol, known: &mut Derivation| match extent.partials.get(symbol) {
            Some(count) => {
                known.shrink_to(*count);
                true
            }
            None => false,
        });
        self.domain = Default::default();
    }
}
