//! Absolute values, extremes, angles of points; and powers whose exponents are no integers.

use super::check::Checker;
use super::exponents::Base;
use super::form::Form;
use super::problem::Asked;
use super::quantity::{Entry, Quantity, Table};
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Expr, ExprKind, Span};
use std::collections::BTreeMap;

impl Checker<'_> {
    /// `abs`, `min` and `max` measure what their arguments do, which all measure one thing; signs and angles are numbers.
    pub(super) fn composed(&mut self, name: &str, arguments: &[Table], place: &Span) -> Quantity {
        let Some((first, others)) = arguments.split_first() else { return Quantity::Open };
        if arguments.iter().any(|table| !table.is_scalar()) {
            return Quantity::Open;
        }
        let mut found = first.clone();
        for other in others {
            let asked = Asked::Arguments(name.to_owned());
            match self.entrywise(&found, other, place, &asked) {
                Quantity::Table(table) => found = table,
                Quantity::Open => return Quantity::Open,
            }
        }
        match name {
            "sign" | "atan2" => {
                Quantity::Table(Table { at_numbers: found.at_numbers, ..Table::scalar(Entry::number()) })
            }
            _ => Quantity::Table(found),
        }
    }

    /// A power: of a number as exponent that of the base; else a power that is known by its exponent alone, `length^n`.
    pub(super) fn real_power(&mut self, base: &Expr, exponent: &Expr) -> Quantity {
        let (below, above) = (self.quantity(base), self.quantity(exponent));
        if let Quantity::Table(table) = &above
            && let [Entry::Of(form)] = table.entries.as_slice()
        {
            self.equate(form, &Form::number(), &exponent.span, &Asked::Exponent);
        }
        let Quantity::Table(table) = below else { return Quantity::Open };
        let [entry] = table.entries.as_slice() else { return Quantity::Open };
        let entry = match (entry, number(exponent)) {
            (Entry::Zero, _) => Entry::Open,
            (Entry::Of(form), Some(exponent)) => Entry::Of(form.power(&exponent)),
            (Entry::Of(form), None) => self.symbolic_power(form, exponent),
            (Entry::Open, _) => Entry::Open,
        };
        Quantity::Table(table.with(vec![entry]))
    }

    /// `length^n` where `n` is no number: a dimension of its own for each base dimension and each symbol in the exponent.
    fn symbolic_power(&mut self, form: &Form, exponent: &Expr) -> Entry {
        let form = self.known.solution.resolve(form, &mut Default::default());
        if form.unknown.iter().any(|(unknown, _)| !self.known.solution.is_rigid(*unknown)) {
            return Entry::Open;
        }
        if form == Form::number() {
            return Entry::number();
        }
        let mut parts = Parts::default();
        self.linear(exponent, &RBig::ONE, &mut parts);
        let mut found = form.power(&parts.number);
        if parts.atoms.is_empty() {
            return Entry::Of(found);
        }
        if !form.unknown.is_empty() {
            return Entry::Open;
        }
        for (atom, (factor, is_symbol)) in parts.atoms {
            for base in Base::ALL {
                let power = form.known.exponent(base) * &factor;
                if power.is_zero() {
                    continue;
                }
                let name = format!("{}^{atom}", base.name());
                let of_base = match self.known.symbolic.get(&name) {
                    Some(known) => known.clone(),
                    // of a symbol nothing is known; what else stands there may be anything
                    None if is_symbol => self.known.solution.rigid(name.clone()),
                    None => self.known.solution.unknown(name.clone()),
                };
                self.known.symbolic.insert(name, of_base.clone());
                found = found.times_power(&of_base, &power);
            }
        }
        Entry::Of(found)
    }

    /// An exponent as a number and multiples of what is none.
    fn linear(&self, expr: &Expr, factor: &RBig, parts: &mut Parts) {
        if let Some(value) = number(expr) {
            parts.number += value * factor;
            return;
        }
        match &expr.kind {
            ExprKind::Sum(terms) => {
                for (minus, term) in terms {
                    self.linear(term, &if *minus { -factor.clone() } else { factor.clone() }, parts);
                }
            }
            ExprKind::Product(factors) => {
                let (numbers, others): (Vec<_>, Vec<_>) = factors
                    .iter()
                    .partition(|(_, factor)| number(factor).is_some_and(|value| !value.is_zero()));
                match others.as_slice() {
                    [(false, only)] => {
                        let scale =
                            numbers.iter().filter_map(|(divides, value)| Some((*divides, number(value)?)));
                        let scale = scale.fold(factor.clone(), |all, (divides, value)| match divides {
                            true => all / value,
                            false => all * value,
                        });
                        self.linear(only, &scale, parts);
                    }
                    _ => self.atom(expr, factor, parts),
                }
            }
            _ => self.atom(expr, factor, parts),
        }
    }

    fn atom(&self, expr: &Expr, factor: &RBig, parts: &mut Parts) {
        let written = self.system.source.get(expr.span.clone()).unwrap_or_default();
        let written: String = written.chars().filter(|c| !c.is_whitespace()).collect();
        let is_symbol = matches!(&expr.kind, ExprKind::Name(name)
            if self.system.find_symbol(name).is_some() && self.system.definition(name).is_none());
        let name = if is_symbol { written } else { format!("({written})") };
        parts.atoms.entry(name).or_insert((RBig::ZERO, is_symbol)).0 += factor;
    }
}

/// An exponent: a number, and multiples of what is none, by how it is written and whether it is a symbol.
#[derive(Default)]
struct Parts {
    number: RBig,
    atoms: BTreeMap<String, (RBig, bool)>,
}

/// An exponent that is made of written numbers.
fn number(expr: &Expr) -> Option<RBig> {
    match &expr.kind {
        ExprKind::Number(value) => Some(value.clone()),
        ExprKind::Sum(terms) => terms.iter().try_fold(RBig::ZERO, |sum, (minus, term)| {
            let value = number(term)?;
            Some(if *minus { sum - value } else { sum + value })
        }),
        ExprKind::Product(factors) => factors.iter().try_fold(RBig::ONE, |product, (divides, factor)| {
            let value = number(factor)?;
            match (divides, value.is_zero()) {
                (true, true) => None,
                (true, false) => Some(product / value),
                (false, _) => Some(product * value),
            }
        }),
        ExprKind::Power(base, exponent) if exponent.abs() <= 16 => {
            let value = number(base)?;
            if *exponent < 0 && value.is_zero() {
                return None;
            }
            let power = (0..exponent.unsigned_abs()).fold(RBig::ONE, |all, _| all * &value);
            Some(if *exponent < 0 { RBig::ONE / power } else { power })
        }
        _ => None,
    }
}
