//! Differentials of generators, and whether some are linearly independent over the rational numbers.

use super::Adjunction;
use super::form::{Form, Monomial};
use super::generators::{Key, Measure};
use crate::expression::NodeId;
use crate::number::{Arithmetic, Function, PrimeField};
use dashu::rational::RBig;
use std::collections::HashMap;

/// Points at which differentials are looked at, beyond as many as there are functions.
const MORE_POINTS: usize = 4;

impl Adjunction<'_> {
    /// Whether no rational combination of some forms is constant: it is looked for modulo a prime, at random points. Nothing
    /// where a generator has no derivative here.
    pub(super) fn are_independent(&mut self, forms: &[Form], symbols: &[u32]) -> Option<bool> {
        let mut gradients = Vec::new();
        for symbol in symbols {
            let mut known = HashMap::new();
            for form in forms {
                gradients.push(self.slope_of_form(form, *symbol, &mut known)?);
            }
        }
        let roots = self.roots_below(&gradients);
        self.is_short(&roots).ok()?;
        let program = self.program(&gradients);
        let field = PrimeField::random(&mut self.rng);
        let mut rows: Vec<Vec<u64>> = vec![Vec::new(); forms.len()];
        let wanted = forms.len() + MORE_POINTS;
        let (mut points, mut tries) = (0, 0);
        while points < wanted {
            tries += 1;
            if tries > 4 * wanted + 40 {
                return None;
            }
            let Some((_, values)) = self.point(&program, &roots, field) else { continue };
            points += 1;
            for (place, value) in values.iter().enumerate() {
                let length = values.iter().map(Vec::len).max().unwrap_or(1);
                let mut value = value.clone();
                value.resize(length, 0);
                rows[place % forms.len()].extend(value);
            }
        }
        Some(rank_of(&field, rows) == forms.len())
    }

    /// The derivative of a form by a symbol, over generators.
    fn slope_of_form(&mut self, form: &Form, by: u32, known: &mut HashMap<u32, NodeId>) -> Option<NodeId> {
        let mut sum = self.graph.integer(0);
        for (monomial, factor) in &form.0 {
            for (place, (variable, power)) in monomial.iter().enumerate() {
                let slope = self.slope(*variable, by, known)?;
                let mut product = self.graph.rational(factor * RBig::from(*power));
                for (other, (variable, power)) in monomial.iter().enumerate() {
                    let base = self.node_of(*variable);
                    let part = self.graph.power(base, if other == place { power - 1 } else { *power });
                    product = self.graph.mul(product, part);
                }
                let term = self.graph.mul(product, slope);
                sum = self.graph.add(sum, term);
            }
        }
        Some(sum)
    }

    /// The derivative of a generator by a symbol.
    fn slope(&mut self, variable: u32, by: u32, known: &mut HashMap<u32, NodeId>) -> Option<NodeId> {
        if let Some(slope) = known.get(&variable) {
            return Some(*slope);
        }
        let own = |all: &mut Self| all.node_of(variable);
        let slope = match self.generators.key(variable).clone() {
            Key::Symbol(_) => self.graph.integer(i64::from(variable == by)),
            Key::Pi | Key::Turn => self.graph.integer(0),
            Key::Exp(monomial) => {
                let inner = self.slope_of_part(&monomial, Measure::Exponent, by, known)?;
                let own = own(self);
                self.graph.mul(own, inner)
            }
            Key::Sine(monomial) => {
                let inner = self.slope_of_part(&monomial, Measure::Angle, by, known)?;
                let cosine = self.node_of(variable + 1);
                self.graph.mul(cosine, inner)
            }
            Key::Cosine(monomial) => {
                let inner = self.slope_of_part(&monomial, Measure::Angle, by, known)?;
                let sine = self.node_of(variable - 1);
                let product = self.graph.mul(sine, inner);
                self.graph.neg(product)
            }
            Key::Root(form) => {
                let inner = self.slope_of_form(&form, by, known)?;
                let (own, two) = (own(self), self.graph.integer(2));
                let bottom = self.graph.mul(two, own);
                self.graph.div(inner, bottom)
            }
            Key::Log(form) => {
                let inner = self.slope_of_form(&form, by, known)?;
                let bottom = self.node_of_form(&form);
                self.graph.div(inner, bottom)
            }
            Key::Inverse(form) => {
                let inner = self.slope_of_form(&form, by, known)?;
                let own = own(self);
                let square = self.graph.power(own, 2);
                let product = self.graph.mul(inner, square);
                self.graph.neg(product)
            }
            Key::Value(function, form) => {
                let inner = self.slope_of_form(&form, by, known)?;
                let one = Form::constant(RBig::ONE);
                let square = self.times(&form, &form)?;
                let bottom = match function {
                    Function::Atan => {
                        let sum = one.plus(&square, &RBig::ONE)?;
                        self.node_of_form(&sum)
                    }
                    _ => {
                        let rest = one.plus(&square, &RBig::from(-1))?;
                        self.root(&rest).ok()?
                    }
                };
                self.graph.div(inner, bottom)
            }
            Key::Part(whole) => {
                let inner = self.slope(whole, by, known)?;
                let (parts, upward) = self.generators.parts.get(&whole).copied()?;
                let own = self.generators.node_at(variable);
                let power = self.graph.power(own, parts as i32 - 1);
                let factor = self.graph.integer(if upward { i64::from(parts) } else { -i64::from(parts) });
                let bottom = self.graph.mul(factor, power);
                self.graph.div(inner, bottom)
            }
            Key::Abs(_) | Key::Power(..) | Key::Opaque(..) => return None,
        };
        known.insert(variable, slope);
        Some(slope)
    }

    fn slope_of_part(
        &mut self,
        monomial: &Monomial,
        measure: Measure,
        by: u32,
        known: &mut HashMap<u32, NodeId>,
    ) -> Option<NodeId> {
        let parts = self.generators.divisors.get(&(measure, monomial.clone())).copied().unwrap_or(1);
        let form = Form::term(monomial.clone(), RBig::ONE / RBig::from(parts));
        self.slope_of_form(&form, by, known)
    }
}

/// The rank of some rows modulo a prime.
fn rank_of(field: &PrimeField, mut rows: Vec<Vec<u64>>) -> usize {
    let (mut rank, columns) = (0, rows.first().map_or(0, Vec::len));
    for column in 0..columns {
        let Some(found) = (rank..rows.len()).find(|row| rows[*row][column] != 0) else { continue };
        rows.swap(rank, found);
        let (above, below) = rows.split_at_mut(rank + 1);
        let pivot = &above[rank];
        let Some(inverse) = field.inverse(pivot[column]) else { continue };
        for row in below.iter_mut().filter(|row| row[column] != 0) {
            let factor = field.mul(&row[column], &inverse).unwrap_or(0);
            for (entry, p) in row.iter_mut().zip(pivot) {
                let part = field.mul(p, &factor).unwrap_or(0);
                *entry = field.sub(entry, &part).unwrap_or(0);
            }
        }
        rank += 1;
    }
    rank
}
