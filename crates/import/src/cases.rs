//! Cases as our language can say them: by `abs`, `min` and `max`, or by `sign`. By `sign` both values stand twice in what is written; so a value
//! that is more than a few letters, or has cases itself, becomes a definition first. What is written then grows as the file does: nested cases
//! would double with every step.

use super::expression::{ForeignExpr, ForeignKind};
use super::model::{ForeignConstant, ForeignModel, ForeignRate};
use super::print::{Written, same, without_case};
use dashu::base::BitTest;
use dashu::rational::RBig;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// A value with more parts than these gets a name before it is written twice.
const SHORT: usize = 40;

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
}

/// Writes out all cases of a model.
///
/// # Errors
/// Cases that our language cannot say, and what becomes too large.
pub(super) fn written_out(model: &ForeignModel, budget: &Budget) -> Result<Uncased, Problem> {
    let taken = model.all_names().into_iter().collect();
    let given = |constant: &ForeignConstant| Some((constant.name.clone(), constant.value.clone()?));
    let values = model.constants.iter().filter(|one| !model.varied.contains(&one.name)).filter_map(given);
    let mut writing = Writing {
        budget,
        taken,
        count: 0,
        above: Vec::new(),
        has_sign: false,
        values: values.collect(),
        partial: BTreeSet::new(),
        remarks: Vec::new(),
    };
    let mut found = model.without_formulas();
    for (name, value) in &model.definitions {
        let part = writing.part(value)?;
        writing.has_sign |= part.has_sign;
        writing.note(name, &part);
        let value = part.value;
        found.definitions.append(&mut writing.above);
        found.definitions.push((name.clone(), value));
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
        if let Written::Once(value) = without_case(of, &sides, *order, &values) {
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
        let (Written::Once(value) | Written::BySign(value)) = without_case(of, &sides, *order, &values);
        let size = value.size();
        self.budget.nodes(size).map_err(|spent| super::too_much(&of.span, spent))?;
        Ok(Part { value, size, is_total, has_sign: true })
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
