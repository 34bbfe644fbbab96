//! Cases as our language can say them: by `abs`, `min` and `max`, or by `sign`. By `sign` both values stand twice in what is written; so a value
//! that is more than a few letters, or has cases itself, becomes a definition first. What is written then grows as the file does: nested cases
//! would double with every step.

use super::expression::{DEEPEST, ForeignExpr, ForeignKind, ForeignOrder};
use super::model::{ForeignConstant, ForeignModel, ForeignRate};
use super::print::{by_one_function, by_sign, same};
use super::reduced::{Flags, SHORT};
use super::thin::ThinSets;
use dashu::base::BitTest;
use dashu::rational::RBig;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// Values of more bits are not kept: they are no flags.
const LONGEST: usize = 1 << 14;

/// A model without cases.
pub(super) struct Uncased {
    pub model: ForeignModel,
    /// Whether some case is written by `sign`, which has no value where both sides are equal.
    pub has_sign: bool,
}

/// A part of an expression whose cases are written out.
struct Part {
    value: ForeignExpr,
    /// How many parts it has, and whether it has a value everywhere.
    size: usize,
    is_total: bool,
    /// Whether a case in it is written by `sign`.
    has_sign: bool,
}

struct Writing<'b> {
    budget: &'b Budget,
    taken: BTreeSet<String>,
    count: usize,
    /// Definitions that were made, and are written above what comes next.
    above: Vec<(String, ForeignExpr)>,
    has_sign: bool,
    /// What constants, and definitions made of them, are by the values of the file.
    values: BTreeMap<String, RBig>,
    /// Definitions that do not exist everywhere.
    partial: BTreeSet<String>,
    /// What was decided by the values of the file.
    remarks: Vec<String>,
    /// Where sides can be equal on more than a thin set, and what short definitions with cases are: asked only where there are cases.
    thin: ThinSets,
    flags: Flags,
    has_cases: bool,
    /// How many comparisons are open that are written by others.
    deep: usize,
}

/// Writes out all cases of a model.
///
/// # Errors
/// Cases that our language cannot say, and what becomes too large.
pub(super) fn written_out(model: &ForeignModel, budget: &Budget) -> Result<Uncased, Problem> {
    let taken = model.all_names().into_iter().collect();
    let given = |constant: &ForeignConstant| Some((constant.name.clone(), constant.value.clone()?));
    let values = model.constants.iter().filter(|one| !model.varied.contains(&one.name)).filter_map(given);
    let values: BTreeMap<String, RBig> = values.collect();
    let doubles = values.iter().map(|(name, value)| (name.clone(), value.to_f64().value()));
    let mut writing = Writing {
        budget,
        taken,
        count: 0,
        above: Vec::new(),
        has_sign: false,
        thin: ThinSets::new(doubles),
        flags: Flags::default(),
        has_cases: has_cases(model),
        deep: 0,
        values,
        partial: BTreeSet::new(),
        remarks: Vec::new(),
    };
    let mut found = model.without_formulas();
    for (name, value) in &model.definitions {
        let part = writing.part(value)?;
        writing.has_sign |= part.has_sign;
        writing.note(name, &part);
        let own = part.value;
        found.definitions.append(&mut writing.above);
        found.definitions.push((name.clone(), own));
        if writing.has_cases {
            writing.thin.define(name, value);
            writing.flags.define(name, value);
        }
    }
    for state in &model.states {
        let rate = writing.whole(&state.rate)?;
        found.states.push(ForeignRate { name: state.name.clone(), rate, span: state.span.clone() });
    }
    for output in &mut found.outputs {
        output.value = writing.whole(&output.value)?;
    }
    for (_, value) in &mut found.initial_values {
        *value = value.as_ref().map(|value| writing.whole(value)).transpose()?;
    }
    found.definitions.append(&mut writing.above);
    found.remarks.append(&mut writing.remarks);
    Ok(Uncased { model: found, has_sign: writing.has_sign })
}

/// Whether anything of a model is written by `sign`, or may be.
fn has_cases(model: &ForeignModel) -> bool {
    fn any(value: &ForeignExpr) -> bool {
        matches!(value.kind, ForeignKind::Case { .. } | ForeignKind::Call("sign", _))
            || value.parts().into_iter().any(any)
    }
    model.definitions.iter().any(|(_, value)| any(value))
        || model.states.iter().any(|state| any(&state.rate))
        || model.outputs.iter().any(|output| any(&output.value))
        || model.initial_values.iter().any(|(_, value)| value.as_ref().is_some_and(any))
}

impl Writing<'_> {
    fn whole(&mut self, value: &ForeignExpr) -> Result<ForeignExpr, Problem> {
        let part = self.part(value)?;
        self.has_sign |= part.has_sign;
        Ok(part.value)
    }

    /// Keeps in mind what a definition is by the values of the file, and whether it exists everywhere.
    fn note(&mut self, name: &str, part: &Part) {
        if !part.is_total {
            self.partial.insert(name.to_owned());
        }
        // a longer one is no flag
        if part.size <= SHORT
            && let Some(value) = part.value.exact(&|name| self.values.get(name).cloned())
            && value.numerator().bit_len() + value.denominator().bit_len() <= LONGEST
        {
            self.values.insert(name.to_owned(), value);
        }
    }

    /// Which value a case has whose sides are constants that are equal by the values of the file: `sign` has none there.
    fn decided<'e>(&mut self, of: &'e ForeignExpr) -> Option<&'e ForeignExpr> {
        let ForeignKind::Case { sides, order, values } = &of.kind else { return None };
        if sides.0.size() + sides.1.size() > SHORT {
            return None;
        }
        let value = |side: &ForeignExpr| side.exact(&|name| self.values.get(name).cloned());
        if same(&sides.0, &sides.1) {
            // whatever they are
            return Some(order.of_equals(values));
        }
        if let (Some(left), Some(right)) = (sides.0.as_number(), sides.1.as_number()) {
            return Some(if order.holds(left, right) { &values.0 } else { &values.1 });
        }
        if value(&sides.0)? != value(&sides.1)? {
            return None;
        }
        let mut names = BTreeSet::new();
        for side in [&sides.0, &sides.1] {
            side.names(&mut |name, _| {
                names.insert(name.to_owned());
            });
        }
        if !names.is_empty() {
            let list = names.into_iter().collect::<Vec<_>>().join(", ");
            let remark =
                format!("a case is decided by the values of the file, at which both sides are equal: {list}");
            if !self.remarks.contains(&remark) {
                self.remarks.push(remark);
            }
        }
        Some(order.of_equals(values))
    }

    fn part(&mut self, of: &ForeignExpr) -> Result<Part, Problem> {
        self.budget.nodes(1).map_err(|spent| super::too_much(&of.span, spent))?;
        if let Some(value) = self.decided(of) {
            return self.part(value);
        }
        if let ForeignKind::Name(name) = &of.kind {
            let is_total = !self.partial.contains(name);
            return Ok(Part { value: of.clone(), size: 1, is_total, has_sign: false });
        }
        if let Some(plain) = self.without_equal_sides(of)? {
            self.deep += 1;
            if self.deep > DEEPEST {
                let problem = Problem::new(
                    Code::Foreign,
                    &of.span,
                    "cases of cases that are nested too deeply",
                    "this",
                );
                return Err(problem.help("compare what stands within max, min, abs or another case itself"));
            }
            let part = self.part(&plain);
            self.deep -= 1;
            return part;
        }
        if let ForeignKind::Product(list) = &of.kind
            && let Some((_, zero)) = list.iter().find(|(divided, part)| {
                *divided && part.exact(&|_| None).is_some_and(|value| value == RBig::ZERO)
            })
        {
            return Err(Problem::new(Code::Foreign, &zero.span, "this divides by zero", "this")
                .help("write what it is to be: all numbers are real and finite"));
        }
        let mut parts = Vec::new();
        for inner in of.parts() {
            parts.push(self.part(inner)?);
        }
        let ForeignKind::Case { order, .. } = &of.kind else { return Ok(together(of, parts)) };
        let has_sign = parts.iter().any(|part| part.has_sign);
        let [left, right, then, otherwise] =
            <[Part; 4]>::try_from(parts).unwrap_or_else(|_| unreachable!("a case has four parts"));
        let is_total = [&left, &right, &then, &otherwise].iter().all(|part| part.is_total);
        let sides = (left.value, right.value);
        let mut values = (then.value, otherwise.value);
        // by abs, min or max both stand once
        if let Some(value) = by_one_function(of, &sides, *order, &values) {
            let size = value.size();
            return Ok(Part { value, size, is_total, has_sign });
        }
        let both = [
            (&mut values.0, then.size, then.is_total, then.has_sign),
            (&mut values.1, otherwise.size, otherwise.is_total, otherwise.has_sign),
        ];
        for (value, size, is_total, has_sign) in both {
            if !is_total {
                let message =
                    "the cases cannot be written as one expression: this one does not exist everywhere";
                return Err(Problem::new(Code::Foreign, &value.span, message, "does not exist everywhere").help(
                    "what can be read: cases that are abs, min or max, or whose values are without quotients, roots and logarithms; or keep the case that holds where you look",
                ));
            }
            if has_sign || size > SHORT {
                let name = self.name();
                let place = value.span.clone();
                let named = std::mem::replace(value, ForeignExpr::name(name.as_str(), &place));
                self.above.push((name, named));
            }
        }
        let value = by_sign(of, &sides, *order, &values);
        let size = value.size();
        self.budget.nodes(size).map_err(|spent| super::too_much(&of.span, spent))?;
        Ok(Part { value, size, is_total, has_sign: true })
    }

    /// What is the same as an expression that `sign` would have to say, where its sides can be equal on more than a thin set: `sign` has no
    /// value there. None where it can be said as it is.
    ///
    /// # Errors
    /// Such an expression that is nothing simpler.
    fn without_equal_sides(&mut self, of: &ForeignExpr) -> Result<Option<ForeignExpr>, Problem> {
        let refused = || {
            let message = "the two sides of a case can be equal on more than a thin set, and it cannot be written by sign there";
            Problem::new(Code::Foreign, &of.span, message, "this case").help(
                "compare what stands within max, min, abs or another case itself: x > 1, and not max(x - 1, 0) > 0",
            )
        };
        match &of.kind {
            ForeignKind::Call("sign", list) if list.len() == 1 => {
                if !self.thin.may_be_zero(&list[0]) {
                    return Ok(None);
                }
                let (zero, one) = (ForeignExpr::integer(0, &of.span), ForeignExpr::integer(1, &of.span));
                let case = |order, then: &ForeignExpr, otherwise: ForeignExpr| {
                    let sides = Box::new((list[0].clone(), zero.clone()));
                    let values = Box::new((then.clone(), otherwise));
                    ForeignExpr::new(ForeignKind::Case { sides, order, values }, &of.span)
                };
                let below = case(ForeignOrder::Less, &one.clone().negative(), zero.clone());
                Ok(Some(case(ForeignOrder::Greater, &one, below)))
            }
            ForeignKind::Case { sides, order, values } => {
                if by_one_function(of, sides, *order, values).is_some() {
                    return Ok(None);
                }
                if !self.thin.may_be_equal(&sides.0, &sides.1) {
                    return Ok(None);
                }
                // both values may stand several times in what is made of it
                let mut short = values.as_ref().clone();
                for value in [&mut short.0, &mut short.1] {
                    if value.size() > SHORT {
                        let part = self.part(value)?;
                        let name = self.name();
                        self.has_sign |= part.has_sign;
                        self.note(&name, &part);
                        self.thin.define(&name, value);
                        *value = ForeignExpr::name(name.as_str(), &value.span);
                        self.above.push((name, part.value));
                    }
                }
                let case = ForeignKind::Case { sides: sides.clone(), order: *order, values: Box::new(short) };
                let case = ForeignExpr::new(case, &of.span);
                let plain = self.flags.reduced(&case).ok_or_else(refused)?;
                self.budget.nodes(plain.size()).map_err(|spent| super::too_much(&of.span, spent))?;
                Ok(Some(plain))
            }
            _ => Ok(None),
        }
    }

    /// A name that nothing has.
    fn name(&mut self) -> String {
        loop {
            self.count += 1;
            let name = format!("case_{}", self.count);
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

/// An expression made of its parts again.
fn together(of: &ForeignExpr, parts: Vec<Part>) -> Part {
    let size = 1 + parts.iter().map(|part| part.size).sum::<usize>();
    let has_sign = parts.iter().any(|part| part.has_sign);
    let all_total = parts.iter().all(|part| part.is_total);
    let mut values = parts.into_iter().map(|part| part.value);
    let mut next = || values.next().unwrap_or_else(|| unreachable!("as many as there were"));
    let kind = match &of.kind {
        ForeignKind::Number(value) => ForeignKind::Number(value.clone()),
        ForeignKind::Pi => ForeignKind::Pi,
        ForeignKind::Name(name) => ForeignKind::Name(name.clone()),
        ForeignKind::Sum(list) => ForeignKind::Sum(list.iter().map(|(mark, _)| (*mark, next())).collect()),
        ForeignKind::Product(list) => {
            ForeignKind::Product(list.iter().map(|(mark, _)| (*mark, next())).collect())
        }
        ForeignKind::Power(..) => {
            let base = next();
            ForeignKind::Power(Box::new(base), Box::new(next()))
        }
        ForeignKind::Call(name, list) => ForeignKind::Call(name, list.iter().map(|_| next()).collect()),
        ForeignKind::Case { .. } => unreachable!("cases are written out elsewhere"),
    };
    let value = ForeignExpr::new(kind, &of.span);
    let is_total = all_total && value.is_total_here();
    Part { value, size, is_total, has_sign }
}
