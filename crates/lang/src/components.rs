//! Vectors and their components. A component is a symbol, or a definition, like any other, and is called `x[3]`; here is said
//! what is wrong with one that is not there.

use super::codes::Code;
use super::error::{Problem, nearest};
use super::model::System;
use super::problems::Cause;
use super::vocabulary::functions;
use palmistry_math::expression::Symbol;
use palmistry_math::expression::parse::names_of_range;
use palmistry_math::expression::syntax::{Indexed, Name, Place, Span};

/// Whether a name is that of a component.
pub(super) fn is_component(name: &str) -> bool {
    vector_of(name).is_some()
}

/// The vector of a component, and its number in it; of a derivative, and in another experiment, those of the component.
fn vector_of(name: &str) -> Option<(&str, i64)> {
    let (vector, rest) = name.split_once('[')?;
    let (number, _) = rest.split_once(']')?;
    Some((vector, number.parse().ok()?))
}

impl System {
    /// Notes the vector of a component that is declared.
    pub(super) fn note_component(&mut self, name: &str) {
        if let Some((vector, _)) = vector_of(name)
            && !self.vectors.contains(vector)
        {
            self.vectors.insert(vector.to_owned());
        }
    }

    /// Takes over the vectors of an imported file: symbols have one name everywhere, definitions are under its alias.
    pub(super) fn import_vectors(&mut self, alias: &str, other: &System) {
        for symbol in other.symbols.keys() {
            let name = self.graph.symbol_name(*symbol).to_owned();
            self.note_component(&name);
        }
        for name in other.definitions.keys() {
            self.note_component(&format!("{alias}.{name}"));
        }
    }

    /// A name that is a vector is not declared as something else beside, nor the other way round.
    pub(super) fn refuse_mixed(&self, name: &Name) -> Result<(), Problem> {
        let taken = match vector_of(&name.text) {
            Some((vector, _)) => (self.find_symbol(vector).is_some()
                || self.definitions.contains_key(vector))
            .then_some(vector),
            None => self.vectors.contains(&name.text).then_some(name.text.as_str()),
        };
        match taken {
            None => Ok(()),
            Some(taken) => {
                let message = format!("'{taken}' would be a vector and something without components");
                Err(Problem::new(Code::Twice, &name.span, message, "declared again")
                    .help("choose another name"))
            }
        }
    }

    /// A name that runs through a range means nothing else in the file.
    pub(super) fn refuse_taken_index(&self, index: &Name) -> Result<(), Problem> {
        let name = &index.text;
        let has_a_meaning = self.find_symbol(name).is_some()
            || self.definitions.contains_key(name)
            || self.field(name).is_some()
            || self.vectors.contains(name)
            || ["pi", "rank", "others"].contains(&name.as_str());
        match has_a_meaning {
            false => Ok(()),
            true => {
                let message = format!("'{name}' has a meaning already, and would be an index here");
                Err(Problem::new(Code::Component, &index.span, message, "declared elsewhere")
                    .help("choose another index"))
            }
        }
    }

    /// The first component of a vector of symbols, for editors: where a vector is named, this one speaks for it.
    pub fn first_component(&self, vector: &str) -> Option<Symbol> {
        let mut symbols = self.symbols.keys().copied();
        let is_its = |symbol: &Symbol| vector_of(self.symbol_name(*symbol)).is_some_and(|(v, _)| v == vector);
        symbols.find(is_its)
    }

    /// The symbols of a text from outside: that of a name, or the components of a range such as `x[1..20]`. None where one of
    /// them is not declared.
    pub fn symbols_of(&self, text: &str) -> Vec<Symbol> {
        let names = names_of_range(text).unwrap_or_else(|| vec![text.to_owned()]);
        names.iter().map(|name| self.find_symbol(name)).collect::<Option<_>>().unwrap_or_default()
    }

    /// The numbers of the components that a vector has: `x[1..20]`.
    fn components(&self, vector: &str) -> String {
        let symbols = self.symbols.keys().map(|symbol| self.symbol_name(*symbol));
        let names = symbols.chain(self.definitions.keys().map(String::as_str));
        let mut numbers: Vec<i64> = names
            .filter_map(vector_of)
            .filter(|(known, _)| *known == vector)
            .map(|(_, number)| number)
            .collect();
        numbers.sort_unstable();
        let mut runs: Vec<(i64, i64)> = Vec::new();
        for number in numbers {
            match runs.last_mut() {
                Some((_, last)) if *last + 1 >= number => *last = number,
                _ => runs.push((number, number)),
            }
        }
        let run = |(low, high): &(i64, i64)| match low == high {
            true => format!("{vector}[{low}]"),
            false => format!("{vector}[{low}..{high}]"),
        };
        let more = if runs.len() > 4 { ", ..." } else { "" };
        runs.iter().take(4).map(run).collect::<Vec<_>>().join(", ") + more
    }

    /// The error for a component that is not there, and for a vector where one of its components is meant; none for a name
    /// that has nothing to do with vectors.
    pub(super) fn unknown_component(&self, name: &str, span: &Span) -> Option<Problem> {
        if self.find_symbol(name).is_some() || self.definitions.contains_key(name) {
            return None;
        }
        let Some((vector, number)) = vector_of(name) else {
            if !self.vectors.contains(name) {
                return None;
            }
            let message = format!("'{name}' is a vector, and one of its components is needed");
            let help = format!("it has {}; in a list a range stands for all of them", self.components(name));
            return Some(Problem::new(Code::Component, span, message, "which one?").help(help));
        };
        if self.find_symbol(&format!("{vector}[{number}]")).is_some() {
            // it is there, and not what stands behind its name
            return None;
        }
        let problem = if self.vectors.contains(vector) {
            let known = self.components(vector);
            let message = format!("'{vector}' has no component {number}: it has {known}");
            let help = "where an index runs too far, give the components at the ends lines of their own";
            Problem::new(Code::Component, span, message, format!("this is '{name}'")).help(help)
        } else if self.find_symbol(vector).is_some() || self.definitions.contains_key(vector) {
            let message = format!("'{vector}' has no components");
            Problem::new(Code::Component, span, message, format!("this is '{name}'"))
                .help(format!("declare a vector with its range, as in state {vector}_[1..3]"))
        } else {
            let problem = Problem::new(
                Code::Component,
                span,
                format!("unknown vector '{vector}'"),
                "not declared above",
            );
            match nearest(vector, self.vectors.iter().map(String::as_str)) {
                Some(near) => problem.help(format!("perhaps you meant '{near}'")),
                None => problem.help(format!("declare its components, as in state {vector}[1..3]")),
            }
        };
        Some(problem.because(Cause::Unknown(name.to_owned())))
    }

    /// The error for an index without a value, and for a range where one component is needed.
    pub(super) fn without_index(&self, indexed: &Indexed, span: &Span) -> Problem {
        let index = match indexed {
            Indexed::Component { place, .. } => place.open_index(),
            Indexed::Fold { over, .. } => {
                over.from.terms.iter().chain(&over.to.terms).map(|(index, _)| index.as_str()).next()
            }
        };
        match (indexed, index) {
            (Indexed::Component { vector, place: Place::Range(..), .. }, None) => {
                let message = "a range of components stands for several, and one is needed here";
                Problem::new(Code::Component, span, message, "this range").help(format!(
                    "write sum(i in 1..3, {vector}[i]) to add up; a range by itself is an entry of a list"
                ))
            }
            (_, index) => {
                let index = index.unwrap_or_default();
                let message = match self.find_symbol(index) {
                    Some(_) => format!("'{index}' is a state or parameter, and no index"),
                    None => format!("unknown index '{index}'"),
                };
                Problem::new(Code::Component, span, message, "nothing says what it runs through").help(
                    match indexed {
                        Indexed::Component { vector, .. }
                            if functions().any(|known| known == vector.to_lowercase()) =>
                        {
                            format!("a function has round brackets, as in {}({index})", vector.to_lowercase())
                        }
                        _ => format!(
                            "write 'for {index} in 1..3' at the end, or sum({index} in 1..3, ...) around it"
                        ),
                    },
                )
            }
        }
    }
}
