//! The order of a pole: the power of a factor in a quotient, where no other factor vanishes with it.

use super::super::doubt::{Effort, Missing};
use super::conditions::{Equations, Solution, on_each_part};
use super::{Atom, Normal, Part, Quotient, Stop};
use dashu::rational::RBig;
use std::collections::{BTreeMap, BTreeSet};

/// Whether an expression has a pole of an order at almost all states of each part of the set on which another one vanishes, both by their places; an order below zero is a zero. `false` says nothing.
///
/// # Errors
/// Where it takes too much work, or an operation has no value.
pub fn has_pole(
    states: Equations<'_>,
    (expression, vanishing): (usize, usize),
    order: i64,
    effort: &Effort,
) -> Result<bool, Missing> {
    on_each_part(states, effort, |normal, part| {
        let mut values = BTreeMap::new();
        normal.forms(states.listing, &[expression, vanishing], &mut values)?;
        let [Some(of), Some(by)] = [expression, vanishing].map(|place| values.get(&place).cloned()) else {
            return Ok(false);
        };
        let of = normal.field.cancelled(of)?;
        Ok(normal.order(part, &of, &by)? == Some(order))
    })
}

impl Normal<'_> {
    fn order(&mut self, part: &Part, of: &Quotient, by: &Quotient) -> Result<Option<i64>, Stop> {
        // what vanishes has to be one factor that is solved: then it vanishes to the first order
        let [(factor, 1)] = *by.powers.iter().map(|(factor, power)| (*factor, *power)).collect::<Vec<_>>()
        else {
            return Ok(None);
        };
        if of.is_zero() {
            return Ok(None);
        }
        let Some(solutions) = self.solutions(factor, &BTreeSet::new(), 0)? else { return Ok(None) };
        let order = -i64::from(of.powers.get(&factor).copied().unwrap_or(0));
        for solution in solutions {
            for other in of.powers.keys().filter(|other| **other != factor) {
                let alone = Quotient { number: RBig::ONE, powers: BTreeMap::from([(*other, 1)]) };
                let mut there = part.clone();
                let on_it = match &solution {
                    Solution::Symbol(name, value) => {
                        let Some(variable) = self.known.get(&Atom::Symbol(name.clone())).copied() else {
                            return Ok(None);
                        };
                        self.replaced(&alone, variable, value)?
                    }
                    Solution::Angle(term, [cosine, sine]) => {
                        there.angles.push((term.clone(), [*cosine, *sine]));
                        let mut found = Some(alone);
                        for (atom, value) in
                            [(Atom::Cosine(term.clone()), cosine), (Atom::Sine(term.clone()), sine)]
                        {
                            let value = Quotient::from(RBig::from(*value));
                            if let (Some(before), Some(variable)) = (&found, self.known.get(&atom).copied()) {
                                found = self.replaced(before, variable, &value)?;
                            }
                        }
                        found
                    }
                };
                // an angle that is fixed is no free symbol any more
                self.set(there);
                let is_free = on_it.is_some_and(|on_it| !on_it.is_zero() && self.is_free(&on_it));
                self.set(part.clone());
                if !is_free {
                    return Ok(None);
                }
            }
        }
        Ok(Some(order))
    }
}
