//! What is known of unknown dimensions: linear equations in their exponents, solved one after the other.

use super::exponents::{Dimension, fraction};
use super::form::{Form, Unknown};
use palmistry_math::expression::syntax::Span;
use std::collections::BTreeSet;

/// What an unknown dimension belongs to, in words: `'k'`, `the field 'g1'`.
#[derive(Clone, Debug)]
struct Entry {
    of: String,
    /// Whether it is what it is, as `length^n` is: no equation says what it has to be.
    rigid: bool,
    /// What it is, in others that are not solved for at the time, and where the equation stands; `None` is an import.
    solved: Option<(Form, Option<Span>)>,
}

/// Unknown dimensions, and equations between them.
#[derive(Clone, Debug, Default)]
pub(super) struct Solution {
    entries: Vec<Entry>,
}

/// Two dimensions where there should be one.
#[derive(Clone, Debug)]
pub(super) struct Conflict {
    /// The two, as far as they are known.
    pub sides: [Form; 2],
    /// The unknowns that other places had decided.
    pub decided: BTreeSet<Unknown>,
}

impl Solution {
    /// An unknown more.
    pub fn unknown(&mut self, of: String) -> Form {
        self.entries.push(Entry { of, rigid: false, solved: None });
        Form::unknown(self.entries.len() - 1)
    }

    /// A dimension more that nothing else is, and no number.
    pub fn rigid(&mut self, of: String) -> Form {
        self.entries.push(Entry { of, rigid: true, solved: None });
        Form::unknown(self.entries.len() - 1)
    }

    /// Whether an unknown is none that an equation may decide.
    pub fn is_rigid(&self, unknown: Unknown) -> bool {
        self.entries[unknown].rigid
    }

    /// What a form is by all that is known; the unknowns that were put in are noted.
    pub fn resolve(&mut self, form: &Form, decided: &mut BTreeSet<Unknown>) -> Form {
        let mut found = form.clone();
        loop {
            let next = found.unknown.iter().find(|(unknown, _)| self.entries[*unknown].solved.is_some());
            let Some((unknown, power)) = next.cloned() else { return found };
            decided.insert(unknown);
            let Some((inner, place)) = self.entries[unknown].solved.clone() else { return found };
            // what was solved for before may have been solved for in part: keep the rest, so that a chain is walked once
            let stale = inner.unknown.iter().any(|(other, _)| self.entries[*other].solved.is_some());
            let inner = if stale {
                let inner = self.resolved_chain(inner, decided);
                self.entries[unknown].solved = Some((inner.clone(), place));
                inner
            } else {
                inner
            };
            found = found.times_power(&Form::unknown(unknown), &-power.clone()).times_power(&inner, &power);
        }
    }

    /// A form without any unknown that is solved for.
    fn resolved_chain(&self, mut form: Form, decided: &mut BTreeSet<Unknown>) -> Form {
        loop {
            let next = form.unknown.iter().find_map(|(unknown, power)| {
                self.entries[*unknown].solved.as_ref().map(|(inner, _)| (*unknown, power.clone(), inner))
            });
            let Some((unknown, power, inner)) = next else { return form };
            decided.insert(unknown);
            form = form.times_power(&Form::unknown(unknown), &-power.clone()).times_power(inner, &power);
        }
    }

    /// Takes two dimensions for one; `place` is where the file asks for that.
    pub fn equate(&mut self, left: &Form, right: &Form, place: Option<Span>) -> Result<(), Box<Conflict>> {
        let mut decided = BTreeSet::new();
        let difference = self.resolve(&left.over(right), &mut decided);
        let open = difference.unknown.iter().rev().find(|(unknown, _)| !self.is_rigid(*unknown));
        let Some((last, power)) = open.cloned() else {
            if difference.known.is_none() && difference.unknown.is_empty() {
                return Ok(());
            }
            let mut decided = BTreeSet::new();
            let sides = [left, right].map(|side| self.resolve(side, &mut decided));
            return Err(Box::new(Conflict { sides, decided }));
        };
        let inverse = -(dashu::rational::RBig::ONE / &power);
        let rest = difference.times_power(&Form::unknown(last), &-power);
        self.entries[last].solved = Some((rest.power(&inverse), place));
        Ok(())
    }

    /// What it is, if it is known.
    pub fn dimension(&mut self, form: &Form) -> Option<Dimension> {
        let found = self.resolve(form, &mut BTreeSet::new());
        found.unknown.is_empty().then_some(found.known)
    }

    /// What an unknown belongs to, and where it was decided.
    pub fn origin(&self, unknown: Unknown) -> (&str, Option<&Span>) {
        let entry = &self.entries[unknown];
        (&entry.of, entry.solved.as_ref().and_then(|(_, place)| place.as_ref()))
    }

    /// In words: `length/time`, `length*[k]` with the unknown dimension of `k`, `number`.
    pub fn text(&self, form: &Form) -> String {
        if form.unknown.is_empty() {
            let known = form.known.to_string();
            return if known == "1" { "number".to_owned() } else { known };
        }
        let known = super::exponents::Base::ALL;
        let known = known.iter().map(|base| (base.name().to_owned(), form.known.exponent(*base)));
        let name = |unknown: Unknown| match &self.entries[unknown] {
            Entry { of, rigid: true, .. } => of.clone(),
            Entry { of, .. } => format!("[{}]", of.trim_matches('\'')),
        };
        fraction(known.chain(form.unknown.iter().map(|(unknown, power)| (name(*unknown), power))))
    }
}
