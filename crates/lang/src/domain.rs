//! Where what a file says has a value: the guards of its terms, definitions, fields and outputs.
//!
//! A definition's guards are its own and those of the definitions that it uses; they are put together only when somebody
//! asks, so that a long chain of definitions costs no more than its length.

use super::codes::Code;
use super::error::Problem;
use super::model::{Assignment, System, Value};
use dashu::rational::RBig;
use palmistry_math::expression::syntax::{Expr, ExprKind};
use palmistry_math::expression::{Guard, Need, NodeId, Symbol, add_guard, substitute_guards};
use std::collections::{BTreeSet, HashSet};

/// Guards, and the definitions whose guards belong to them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Domain {
    own: BTreeSet<Guard>,
    used: BTreeSet<String>,
}

impl Domain {
    /// Some guards together.
    pub(super) fn of(guards: impl IntoIterator<Item = Guard>) -> Domain {
        Domain { own: guards.into_iter().collect(), used: BTreeSet::new() }
    }

    /// The same where the definitions are known under an alias.
    pub(super) fn under(self, alias: &str) -> Domain {
        let used = self.used.into_iter().map(|name| format!("{alias}.{name}")).collect();
        Domain { own: self.own, used }
    }
}

impl System {
    /// Notes that what is being read needs something of an operand.
    pub(super) fn need(&mut self, node: NodeId, need: Need) {
        let guard = Guard { node, need };
        if guard.constant(&self.graph) != Some(true) {
            self.domain.own.insert(guard);
        }
    }

    /// Notes that what is being read uses a definition.
    pub(super) fn need_definition(&mut self, name: &str) {
        if self.definition_domains.contains_key(name) && !self.domain.used.contains(name) {
            self.domain.used.insert(name.to_owned());
        }
    }

    /// Notes guards that are put together already.
    pub(super) fn need_all(&mut self, guards: Vec<Guard>) {
        for Guard { node, need } in guards {
            self.need(node, need);
        }
    }

    /// Does something, and says what the terms that were read meanwhile need. What was noted before stays.
    pub(super) fn apart<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<T, Problem>,
    ) -> Result<(T, Domain), Problem> {
        let before = std::mem::take(&mut self.domain);
        let found = work(self);
        let domain = std::mem::replace(&mut self.domain, before);
        Ok((found?, domain))
    }

    /// The guards of a domain, those of the definitions that it uses included, each once.
    pub(super) fn guards_of(&self, domain: &Domain) -> Vec<Guard> {
        let mut all = domain.own.clone();
        let mut seen: HashSet<&str> = HashSet::new();
        let mut open: Vec<&str> = domain.used.iter().map(String::as_str).collect();
        while let Some(name) = open.pop() {
            if seen.insert(name)
                && let Some(domain) = self.definition_domains.get(name)
            {
                all.extend(&domain.own);
                open.extend(domain.used.iter().map(String::as_str));
            }
        }
        all.into_iter().collect()
    }

    /// The value of an expression, and where it exists.
    pub fn elaborate_guarded(&mut self, expr: &Expr) -> Result<(Value, Vec<Guard>), Problem> {
        let (value, domain) = self.apart(|system| system.elaborate(expr))?;
        Ok((value, self.guards_of(&domain)))
    }

    /// Where a definition of the file exists.
    pub fn definition_guards(&self, name: &str) -> Vec<Guard> {
        self.definition_domains.get(name).map(|domain| self.guards_of(domain)).unwrap_or_default()
    }

    /// Refuses a rate or an output that has no value in any state, as it divides by the number zero or takes the root of a
    /// negative one. What is written with names, as `1/(x - x)`, is left to the claims: it exists nowhere, and they say so.
    pub(super) fn refuse_without_value(&mut self, expr: &Expr) -> Result<(), Problem> {
        let mut numbers = Vec::new();
        if !numbers_in(expr, &mut numbers) {
            numbers.push(expr.clone());
        }
        for number in numbers {
            // what is wrong with it besides is said where the whole is read
            let Ok((_, guards)) = self.elaborate_guarded(&number) else { continue };
            let Some(unmet) = guards.iter().find(|guard| guard.constant(&self.graph) == Some(false)) else {
                continue;
            };
            let value = self.graph.text(unmet.node);
            let why = match unmet.need {
                Need::NotZero => "it divides by zero".to_owned(),
                Need::Positive => format!("it takes the logarithm of {value}"),
                Need::NotNegative => format!("it takes the root of {value}"),
                Need::WithinOne | Need::InsideOne => {
                    format!("it takes the inverse sine or cosine of {value}")
                }
            };
            let message = format!("this has a value in no state: {why}");
            return Err(Problem::new(Code::Value, &expr.span, message, "this")
                .help("write what it is to be: all numbers are real and finite"));
        }
        Ok(())
    }

    /// Guards with symbols replaced.
    pub fn substitute_guards(&mut self, guards: &[Guard], values: &Assignment) -> Vec<Guard> {
        substitute_guards(&mut self.graph, guards, values)
    }

    /// Where outputs and fields (of the given places) are defined and have derivatives of all orders, so that all Lie
    /// derivatives of the outputs along these fields, and their differentials, exist.
    pub fn smooth_guards(&self, fields: &[usize]) -> Vec<Guard> {
        let mut found = Vec::new();
        let outputs = self.output_guards.iter().flatten();
        let rates = fields.iter().flat_map(|field| self.fields[*field].guards.iter().flatten());
        for guard in outputs.chain(rates) {
            add_guard(&self.graph, &mut found, Guard { node: guard.node, need: guard.need.smooth() });
        }
        found
    }

    /// The guards of those components of a field along which an expression changes.
    pub(super) fn rate_guards(&self, field: &str, mentioned: &[Symbol]) -> Vec<Guard> {
        let field = self.field(field);
        let parts = field.into_iter().flat_map(|field| field.components.iter().zip(&field.guards));
        parts
            .filter(|((symbol, _), _)| mentioned.contains(symbol))
            .flat_map(|(_, guards)| guards.iter().copied())
            .collect()
    }
}

/// Whether an expression has names. The largest parts of it that have none are put into `numbers`, but for the expression
/// itself and for numbers as they are written; of `x/0` it is `1/0`.
fn numbers_in(expr: &Expr, numbers: &mut Vec<Expr>) -> bool {
    let mut nameless = Vec::new();
    let mut has_names = false;
    let mut part = |divides: bool, part: &Expr, numbers: &mut Vec<Expr>| match numbers_in(part, numbers) {
        true => has_names = true,
        false => nameless.push((divides, part.clone())),
    };
    match &expr.kind {
        ExprKind::Number(_) => {}
        ExprKind::Name(_) | ExprKind::Indexed(_) => return true,
        ExprKind::Call(_, parts) => parts.iter().for_each(|one| part(false, one, numbers)),
        ExprKind::Sum(parts) => parts.iter().for_each(|(_, one)| part(false, one, numbers)),
        ExprKind::Product(parts) => parts.iter().for_each(|(divides, one)| part(*divides, one, numbers)),
        ExprKind::Power(base, _) => part(false, base, numbers),
        ExprKind::RealPower(base, exponent) => {
            part(false, base, numbers);
            part(false, exponent, numbers);
        }
        ExprKind::Matrix(rows) => rows.iter().flatten().for_each(|one| part(false, one, numbers)),
        // what is taken at a point may have another value there
        ExprKind::At(..) => return true,
    }
    if !has_names {
        return false;
    }
    for (divides, part) in nameless {
        let is_written = matches!(part.kind, ExprKind::Number(_));
        if divides {
            let span = part.span.clone();
            let one = Expr { kind: ExprKind::Number(RBig::ONE), span: span.clone() };
            numbers.push(Expr { kind: ExprKind::Product(vec![(false, one), (true, part)]), span });
        } else if !is_written {
            numbers.push(part);
        }
    }
    true
}
