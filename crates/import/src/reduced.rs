//! Comparisons whose sides can be equal on more than a thin set, by others that say the same: a flag that is compared with a number is its own
//! condition, `max(x - 1, 0) > 0` is `x - 1 > 0`, and of a number that is zero, one or two any number between them tells what is asked.

use super::expression::{ForeignExpr, ForeignKind, ForeignOrder};
use super::functions::case;
use super::print::same;
use dashu::rational::RBig;
use std::collections::{BTreeMap, BTreeSet};

/// A value with more parts than these gets a name before it is written twice.
pub(super) const SHORT: usize = 40;

/// More values than these are not listed.
const MOST_VALUES: usize = 64;

/// What short definitions are, and which numbers some can be.
#[derive(Default)]
pub(super) struct Flags {
    short: BTreeMap<String, ForeignExpr>,
    numbers: BTreeMap<String, BTreeSet<RBig>>,
}

/// The half of a number.
fn half(value: &RBig) -> RBig {
    value / RBig::from(2)
}

impl Flags {
    /// Keeps in mind what a definition is.
    pub fn define(&mut self, name: &str, value: &ForeignExpr) {
        if let Some(numbers) = self.numbers_of(value) {
            self.numbers.insert(name.to_owned(), numbers);
        }
        if value.size() <= SHORT {
            self.short.insert(name.to_owned(), value.clone());
        }
    }

    /// The numbers that an expression can be, where it is nothing but some numbers.
    fn numbers_of(&self, value: &ForeignExpr) -> Option<BTreeSet<RBig>> {
        let joined =
            |list: &[(bool, ForeignExpr)], begin: RBig, of: &dyn Fn(&RBig, bool, &RBig) -> Option<RBig>| {
                let mut all = BTreeSet::from([begin]);
                for (mark, part) in list {
                    let part = self.numbers_of(part)?;
                    let pairs = all.iter().flat_map(|one| part.iter().map(move |other| (one, other)));
                    all = pairs.map(|(one, other)| of(one, *mark, other)).collect::<Option<_>>()?;
                    if all.len() > MOST_VALUES {
                        return None;
                    }
                }
                Some(all)
            };
        match &value.kind {
            ForeignKind::Number(value) => Some(BTreeSet::from([value.clone()])),
            ForeignKind::Name(name) => self.numbers.get(name).cloned(),
            ForeignKind::Sum(list) => joined(list, RBig::ZERO, &|one, subtracted, other| {
                Some(if subtracted { one - other } else { one + other })
            }),
            ForeignKind::Product(list) => joined(list, RBig::ONE, &|one, divided, other| match divided {
                true => (*other != RBig::ZERO).then(|| one / other),
                false => Some(one * other),
            }),
            ForeignKind::Case { values, .. } => {
                let mut all = self.numbers_of(&values.0)?;
                all.extend(self.numbers_of(&values.1)?);
                (all.len() <= MOST_VALUES).then_some(all)
            }
            _ => None,
        }
    }

    /// A case that says the same as this one, and whose sides are others; none where there is no such.
    pub fn reduced(&self, of: &ForeignExpr) -> Option<ForeignExpr> {
        let ForeignKind::Case { sides, order, values } = &of.kind else { return None };
        let both = [(&sides.0, &sides.1, *order), (&sides.1, &sides.0, order.turned())];
        let compared = |left: &ForeignExpr, order, right: &ForeignExpr| {
            if let (Some(left), Some(right)) = (left.as_number(), right.as_number()) {
                return if ForeignOrder::holds(order, left, right) {
                    values.0.clone()
                } else {
                    values.1.clone()
                };
            }
            let (then, otherwise) = values.as_ref().clone();
            ForeignExpr { span: of.span.clone(), ..case(left.clone(), order, right.clone(), then, otherwise) }
        };
        let chosen = |inner: &(ForeignExpr, ForeignExpr), by: ForeignOrder, then, otherwise| ForeignExpr {
            span: of.span.clone(),
            ..case(inner.0.clone(), by, inner.1.clone(), then, otherwise)
        };
        // a flag of one condition is that condition
        for (one, other, order) in &both {
            if let ForeignKind::Case { sides: inner, order: by, values: own } = &self.opened(one).kind
                && own.0.as_number().is_some()
                && own.1.as_number().is_some()
                && other.as_number().is_some()
            {
                let (then, otherwise) = (compared(&own.0, *order, other), compared(&own.1, *order, other));
                let is_same = same(&then, &otherwise);
                return Some(if is_same { then } else { chosen(inner, *by, then, otherwise) });
            }
        }
        if let Some(plain) = self.between(sides, *order, values) {
            return Some(ForeignExpr { span: of.span.clone(), ..plain });
        }
        for (one, other, order) in &both {
            let one = self.opened(one);
            match &one.kind {
                // of a case it is a case of two comparisons
                ForeignKind::Case { sides: inner, order: by, values: own } => {
                    return Some(chosen(
                        inner,
                        *by,
                        compared(&own.0, *order, other),
                        compared(&own.1, *order, other),
                    ));
                }
                ForeignKind::Call(name @ ("max" | "min"), list) => {
                    if let Some(plain) = greatest(name, list, *order, other) {
                        return Some(match plain {
                            Plain::Always(holds) => {
                                if holds {
                                    values.0.clone()
                                } else {
                                    values.1.clone()
                                }
                            }
                            Plain::Of(left) => compared(&left, *order, other),
                        });
                    }
                    if let [first, second] = list.as_slice() {
                        let by = if *name == "max" { ForeignOrder::AtLeast } else { ForeignOrder::AtMost };
                        let inner = (first.clone(), second.clone());
                        return Some(chosen(
                            &inner,
                            by,
                            compared(first, *order, other),
                            compared(second, *order, other),
                        ));
                    }
                }
                ForeignKind::Call("abs", list) if list.len() == 1 => {
                    let inner = (list[0].clone(), ForeignExpr::integer(0, &list[0].span));
                    let (high, low) = (
                        compared(&list[0], *order, other),
                        compared(&list[0].clone().negative(), *order, other),
                    );
                    return Some(chosen(&inner, ForeignOrder::AtLeast, high, low));
                }
                _ => {}
            }
        }
        None
    }

    /// What a short definition is, and everything else itself.
    fn opened<'e>(&'e self, mut value: &'e ForeignExpr) -> &'e ForeignExpr {
        // each is made of those before it
        while let ForeignKind::Name(name) = &value.kind
            && let Some(own) = self.short.get(name)
        {
            value = own;
        }
        value
    }

    /// A comparison of what is nothing but some numbers with a number that is none of them.
    fn between(
        &self,
        sides: &(ForeignExpr, ForeignExpr),
        order: ForeignOrder,
        values: &(ForeignExpr, ForeignExpr),
    ) -> Option<ForeignExpr> {
        let distances = self.numbers_of(&sides.0.clone().minus(sides.1.clone()))?;
        let above = distances.iter().find(|value| **value > RBig::ZERO);
        let below = distances.iter().rev().find(|value| **value < RBig::ZERO);
        // where it is zero it is with those below, or with those above
        let with_those_below = matches!(order, ForeignOrder::Greater | ForeignOrder::AtMost);
        let beside = match with_those_below {
            true => above,
            false => below,
        };
        let (then, otherwise) = values.clone();
        let Some(beside) = beside else {
            // then it is nowhere on that side
            let holds = matches!(order, ForeignOrder::AtMost | ForeignOrder::AtLeast);
            return Some(if holds { then } else { otherwise });
        };
        let right = match sides.1.as_number() {
            Some(right) => ForeignExpr::new(ForeignKind::Number(right + half(beside)), &sides.1.span),
            None => {
                let more = ForeignExpr::new(ForeignKind::Number(half(beside)), &sides.1.span);
                sides.1.clone().plus(more)
            }
        };
        Some(case(sides.0.clone(), order, right, then, otherwise))
    }
}

/// What a comparison with the greatest of several comes to.
enum Plain {
    /// It is always so, or never.
    Always(bool),
    /// The same of this one.
    Of(ForeignExpr),
}

/// The greatest or the least of several that is compared with one of them, or of which one number is compared with another: that one decides
/// the comparison, or has no say in it. None where nothing of that is so.
fn greatest(
    name: &'static str,
    list: &[ForeignExpr],
    order: ForeignOrder,
    other: &ForeignExpr,
) -> Option<Plain> {
    let decided = |one: &ForeignExpr| match (one.as_number(), other.as_number()) {
        (Some(left), Some(right)) => Some(order.holds(left, right)),
        _ if same(one, other) => Some(matches!(order, ForeignOrder::AtMost | ForeignOrder::AtLeast)),
        _ => None,
    };
    // the greatest is greater where one is, and less where all are
    let is_high = matches!(order, ForeignOrder::Greater | ForeignOrder::AtLeast);
    let one_is_enough = is_high == (name == "max");
    let said: Vec<Option<bool>> = list.iter().map(decided).collect();
    if said.contains(&Some(one_is_enough)) {
        return Some(Plain::Always(one_is_enough));
    }
    let mut rest: Vec<ForeignExpr> =
        list.iter().zip(&said).filter(|(_, said)| said.is_none()).map(|(one, _)| one.clone()).collect();
    match rest.len() {
        _ if rest.len() == list.len() => None,
        0 => Some(Plain::Always(!one_is_enough)),
        1 => rest.pop().map(Plain::Of),
        _ => {
            let span = rest[0].span.clone();
            Some(Plain::Of(ForeignExpr::new(ForeignKind::Call(name, rest), &span)))
        }
    }
}
