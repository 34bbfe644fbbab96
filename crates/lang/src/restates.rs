//! Whether a statement says the same thing twice: its two sides are one expression once names are put in. A paper that
//! writes down a field again after it was derived does so; no calculation stands behind such an equation.

use super::model::{System, Value};
use super::syntax::Statement;
use super::written::in_one_line;
use palmistry_math::expression::COMPOSED;
use palmistry_math::expression::syntax::{Expr, ExprKind, Relation};
use palmistry_math::number::Function;

impl System {
    /// Whether the sides of a statement become one expression by nothing but this: the meanings of names are put in, among
    /// them the components of fields, `L(f, x)` with a state `x`, and the unit rows `d(x)`; and terms and factors are put
    /// in order. Where something is differentiated, multiplied as matrices, or taken at a point, and where there are
    /// conditions, something was calculated.
    pub fn says_one_thing_twice(&mut self, statement: &Statement) -> bool {
        let equation = &statement.equation;
        let is_one_equation = equation.relation == Relation::Equal && statement.further.is_empty();
        if !is_one_equation
            || !statement.conditions.is_empty()
            || statement.except.is_some()
            || statement.is_about_observability()
            || equation.within.is_some()
        {
            return false;
        }
        let (left, right) = (&equation.left, &equation.right);
        let text = |expr: &Expr| in_one_line(&self.source, &expr.span);
        let defines = |name: &Expr, meaning: &Expr| {
            let written = self.written.get(&text(name)).map(|written| written.text());
            written.is_some_and(|written| unspaced(&written) == unspaced(&text(meaning)))
        };
        if text(left) == text(right) || defines(left, right) || defines(right, left) {
            return true;
        }
        let reads = self.calculates_nothing(left)
            && self.calculates_nothing(right)
            && (self.looks_up(left) || self.looks_up(right));
        reads && self.apart(|system| Ok(system.are_equal(left, right))).is_ok_and(|(equal, _)| equal)
    }

    /// Whether an expression is made of names and their meanings by the four operations, powers and functions alone.
    pub(super) fn calculates_nothing(&mut self, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Number(_) => true,
            ExprKind::Name(name) => name != "rank" && !self.calculated.contains(name),
            ExprKind::Sum(terms) => terms.iter().all(|(_, term)| self.calculates_nothing(term)),
            ExprKind::Product(factors) => {
                factors.iter().all(|(_, factor)| self.calculates_nothing(factor))
                    && factors.iter().filter(|(_, factor)| self.is_matrix(factor)).count() < 2
            }
            ExprKind::Power(base, _) => self.calculates_nothing(base),
            ExprKind::RealPower(base, exponent) => {
                self.calculates_nothing(base) && self.calculates_nothing(exponent)
            }
            ExprKind::Matrix(rows) => rows.iter().flatten().all(|entry| self.calculates_nothing(entry)),
            ExprKind::At(..) | ExprKind::Indexed(_) => false,
            ExprKind::Call(name, arguments) => match (name.as_str(), arguments.as_slice()) {
                // the components of a field are looked up, those of a bracket are calculated
                ("L", [field, of]) => matches!(field.kind, ExprKind::Name(_)) && self.are_states(of),
                ("d", [of, ..]) => self.are_states(of),
                ("tan" | "cot" | "sec" | "csc", [of]) => self.calculates_nothing(of),
                (name, of) if COMPOSED.iter().any(|(known, ..)| *known == name) => {
                    of.iter().all(|of| self.calculates_nothing(of))
                }
                (name, [of]) if Function::ALL.iter().any(|known| known.name() == name) => {
                    self.calculates_nothing(of)
                }
                _ => false,
            },
        }
    }

    /// Whether an expression mentions something whose meaning stands elsewhere in the file.
    fn looks_up(&self, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Indexed(_) => false,
            ExprKind::Name(name) => self.definition(name).is_some(),
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                parts.iter().any(|(_, part)| self.looks_up(part))
            }
            ExprKind::Power(inner, _) | ExprKind::At(inner, _) => self.looks_up(inner),
            ExprKind::RealPower(base, exponent) => self.looks_up(base) || self.looks_up(exponent),
            ExprKind::Matrix(rows) => rows.iter().flatten().any(|entry| self.looks_up(entry)),
            ExprKind::Call(name, arguments) => {
                ["L", "d"].contains(&name.as_str()) || arguments.iter().any(|part| self.looks_up(part))
            }
        }
    }

    /// Whether an expression is a state, or a matrix of states, perhaps under a name.
    fn are_states(&self, expr: &Expr) -> bool {
        let is_symbol = |node| self.graph.as_symbol(node).is_some();
        match &expr.kind {
            ExprKind::Name(name) => match self.definition(name) {
                None => self.find_symbol(name).is_some(),
                Some(Value::Scalar(node)) => is_symbol(*node),
                Some(Value::Matrix(matrix)) => matrix.entries.iter().all(|node| is_symbol(*node)),
                Some(_) => false,
            },
            ExprKind::Matrix(rows) => rows.iter().flatten().all(|entry| self.are_states(entry)),
            _ => false,
        }
    }

    fn is_matrix(&mut self, expr: &Expr) -> bool {
        matches!(self.apart(|system| system.elaborate(expr)), Ok((Value::Matrix(_), _)))
    }

    /// Whether the difference of two expressions is zero as it stands.
    fn are_equal(&mut self, left: &Expr, right: &Expr) -> bool {
        let (Ok(left), Ok(right)) = (self.elaborate(left), self.elaborate(right)) else { return false };
        let pairs = match Value::compared(left, right) {
            (Value::Scalar(l), Value::Scalar(r)) => vec![(l, r)],
            (Value::Matrix(l), Value::Matrix(r)) if (l.rows, l.columns) == (r.rows, r.columns) => {
                l.entries.into_iter().zip(r.entries).collect()
            }
            _ => return false,
        };
        pairs.into_iter().all(|(l, r)| {
            let difference = self.graph.sub(l, r);
            self.graph.constant_value(difference).is_some_and(|value| value.is_zero())
        })
    }
}

fn unspaced(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}
