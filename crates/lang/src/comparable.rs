//! Whether a statement can be understood: its names are known, and its two sides can be equal at all.

use super::codes::Code;
use super::error::Problem;
use super::model::{System, Value};
use super::problems::Cause;
use super::syntax::{ClaimSyntax, Statement};
use dashu::rational::RBig;
use palmistry_math::expression::NodeId;
use palmistry_math::expression::syntax::{Expr, ExprKind, Relation};

impl System {
    /// Whether a statement of a claim can be understood: its names are known and its two sides can be equal at all.
    pub(super) fn check(&mut self, claim: &ClaimSyntax, statement: &Statement) -> Result<(), Problem> {
        let (left, right) = (&statement.equation.left, &statement.equation.right);
        let values = Value::compared(self.elaborate(left)?, self.elaborate(right)?);
        let comparable = match &values {
            (Value::Matrix(l), Value::Matrix(r)) => (l.rows, l.columns) == (r.rows, r.columns),
            (Value::Matrix(_), _) | (_, Value::Matrix(_)) => false,
            (Value::Visible { .. }, _) | (_, Value::Visible { .. }) => statement.is_about_observability(),
            (left, right) => left.are_comparable(right),
        };
        for value in [&values.0, &values.1] {
            self.refuse_what_is_known(value, statement)?;
        }
        let of_codistribution = matches!(
            values,
            (Value::CodistributionRank | Value::Visible { .. } | Value::Solutions(_), _)
                | (_, Value::CodistributionRank | Value::Solutions(_))
        );
        if of_codistribution
            && !self.states.is_empty()
            && !self.outputs.is_empty()
            && let Some(problem) = self.no_motion()
        {
            let span = if self.fields.is_empty() { statement.span.clone() } else { problem.span.clone() };
            return Err(Problem {
                span,
                message: format!("claim {}: {}", claim.id, problem.message),
                cause: Cause::Motion,
                ..problem
            });
        }
        if !comparable {
            let message = format!("{} cannot equal {}", values.0.describe(), values.1.describe());
            let problem = Problem::new(Code::Value, &statement.span, message, "this claim");
            return Err(problem.help(self.why_not_comparable(&values)).because(Cause::Shape));
        }
        let relation = statement.equation.relation;
        let of_numbers = values.0.as_number().is_some() && values.1.as_number().is_some();
        let of_solutions = matches!(values, (Value::Solutions(_), _) | (_, Value::Solutions(_)));
        let is_rank = |value: &Value| matches!(value, Value::Rank(_) | Value::CodistributionRank);
        let of_a_rank = is_rank(&values.0) || is_rank(&values.1);
        let bounds_a_rank = of_a_rank && relation.is_ordering();
        if relation != Relation::Equal && !of_numbers && !of_solutions && !bounds_a_rank {
            let (left, right) = (values.0.describe(), values.1.describe());
            let message = format!("'{}' compares numbers, not {left} and {right}", relation.sign());
            let problem = Problem::new(Code::Statement, &statement.equation.span, message, "this relation");
            return Err(match of_a_rank {
                true => problem.help("a rank that is not 3 is smaller, rank < 3, or greater, rank > 3"),
                false => problem.help("matrices are compared by '='; '!=' is said of one number"),
            });
        }
        let mut further = Vec::new();
        for one in &statement.further {
            further.push((self.scalar(&one.right)?, &one.right.span));
        }
        if of_a_rank {
            let side = |value: &Value| if let Value::Scalar(number) = value { Some(*number) } else { None };
            let bound = side(&values.0).or(side(&values.1)).map(|number| (number, &statement.equation.span));
            let is_whole = |number: NodeId| {
                self.graph.constant_value(number).is_some_and(|value| value.denominator().is_one())
            };
            if let Some((_, span)) = bound.into_iter().chain(further).find(|(number, _)| !is_whole(*number)) {
                let message = "a rank is compared with a whole number";
                return Err(Problem::new(Code::Statement, span, message, "no whole number")
                    .help("the number itself, as in rank = 3, and no name"));
            }
        }
        if of_a_rank || of_solutions {
            let is_taken_at = |side: &Expr, value: &Value| {
                matches!(side.kind, ExprKind::At(..)) && value.as_number().is_some()
            };
            if is_taken_at(left, &values.0) || is_taken_at(right, &values.1) {
                let message = "'at' belongs to the number, which has the same value everywhere";
                return Err(Problem::new(Code::Statement, &statement.equation.span, message, "this claim")
                    .help("the states of a claim stand behind 'where', as in rank = 3 where x = 0"));
            }
            self.refuse_negative(&values, statement)?;
        }
        if of_solutions && !statement.further.is_empty() {
            let message = "a number of solutions is compared with one number";
            return Err(Problem::new(Code::Statement, &statement.span, message, "this claim")
                .help("as in solutions(a) = 1 or solutions(a) <= 2; a second bound is a claim of its own"));
        }
        if bounds_a_rank && statement.further.iter().any(|further| !further.relation.is_ordering()) {
            let message = "a rank has bounds, as in 2 <= rank <= 3";
            return Err(Problem::new(Code::Statement, &statement.equation.span, message, "this relation"));
        }
        if (of_a_rank || of_solutions)
            && let Some(within) = &statement.equation.within
        {
            let message = "a rank and a number of solutions are exact";
            return Err(Problem::new(Code::Statement, &within.span, message, "leave 'within' out")
                .help("a rank may have bounds, as in 2 <= rank <= 3"));
        }
        if statement.on_sample && !of_numbers {
            let message = "'on sample' is said of numbers; a rank is the generic one";
            return Err(Problem::new(Code::Statement, &statement.span, message, "this claim").help(
                "leave 'on sample' out: it stands behind a comparison of numbers, as in x^2 >= 0 on sample",
            ));
        }
        let first = if is_rank(&values.0) { relation } else { relation.turned() };
        let mut relations = std::iter::once(first).chain(statement.further.iter().map(|one| one.relation));
        if statement.except.is_some() && bounds_a_rank && relations.any(Relation::points_up) {
            let message = "a rank is nowhere greater than it is generically: 'everywhere' and 'except where' take rank = n or rank >= n";
            return Err(Problem::new(Code::Statement, &statement.span, message, "this claim")
                .help("claim the bound from above without them"));
        }
        if statement.except.is_some() && !of_a_rank {
            let message =
                "'everywhere' and 'except where' are said of a rank: all else is claimed wherever it exists";
            return Err(Problem::new(Code::Statement, &statement.span, message, "this claim")
                .help("leave it out: it stands behind a rank, as in rank = 3 everywhere"));
        }
        if let Some(unequal) =
            statement.except.iter().flatten().flatten().find(|e| e.relation != Relation::Equal)
        {
            let message = "what is left out is given by equations";
            return Err(Problem::new(Code::Statement, &unequal.span, message, "no equation")
                .help("as in except where x = 0; what holds for some states alone stands behind 'where'"));
        }
        for condition in statement.conditions.iter().chain(statement.except.iter().flatten().flatten()) {
            self.scalar(&condition.left)?;
            self.scalar(&condition.right)?;
            if let Some(within) = &condition.within {
                return Err(Problem::new(
                    Code::Statement,
                    &within.span,
                    "a condition is met exactly",
                    "without 'within'",
                ));
            }
        }
        if let Some(within) = &statement.equation.within {
            self.scalar(within)?;
        }
        if statement.carried.is_some() {
            let is_print = statement.equation.right.is_literal();
            if !is_print || !of_numbers || relation != Relation::Equal {
                let message = "'carrying ... digits' is said of a number in print, as in e at {x = 1} = 2.718 carrying 10 digits";
                return Err(Problem::new(Code::Statement, &statement.span, message, "this claim"));
            }
        }
        Ok(())
    }

    /// A rank, or a number of solutions, beside a number below zero.
    fn refuse_negative(&self, values: &(Value, Value), statement: &Statement) -> Result<(), Problem> {
        let is_negative = |value: &Value| {
            let number = value.as_number().and_then(|number| self.graph.constant_value(number));
            number.is_some_and(|number| *number < RBig::ZERO)
        };
        if !is_negative(&values.0) && !is_negative(&values.1) {
            return Ok(());
        }
        let message = "a rank and a number of solutions are never negative";
        Err(Problem::new(Code::Statement, &statement.equation.span, message, "this claim")
            .help("as in rank = 3 or solutions(a) = 1"))
    }

    /// What to write for a claim whose sides cannot be equal.
    fn why_not_comparable(&self, values: &(Value, Value)) -> String {
        let is_count =
            |value: &Value| matches!(value, Value::Rank(_) | Value::CodistributionRank | Value::Solutions(_));
        match values {
            (Value::Infinity, other) | (other, Value::Infinity) if is_count(other) => {
                "a rank is a whole number, as in rank = 3; infinitely many are solutions(e) = infinity"
                    .to_owned()
            }
            (left, right) if is_count(left) && is_count(right) => {
                "a number stands on the other side, as in rank = 3: two of them are two claims".to_owned()
            }
            (Value::Matrix(m), _) | (_, Value::Matrix(m))
                if m.columns == self.unknowns().len() && m.rows == 1 =>
            {
                self.columns_in_words()
            }
            (Value::Matrix(_), _) | (_, Value::Matrix(_)) => {
                "both sides have as many rows and columns, as in [x; y] = [0; 0]".to_owned()
            }
            _ => "numbers are compared with numbers, a rank and a number of solutions with a whole number"
                .to_owned(),
        }
    }

    /// A claim that known constants or numbers are observable, identifiable or not, or how many values they have: it would be true or
    /// false by definition, and is mostly one in which `unknown` was forgotten.
    fn refuse_what_is_known(&self, value: &Value, statement: &Statement) -> Result<(), Problem> {
        let (functions, what) = match value {
            Value::Visible { functions, .. } => (functions.as_slice(), "nothing is to be identified"),
            Value::Solutions(function) => (std::slice::from_ref(function), "it has its one value"),
            _ => return Ok(()),
        };
        for function in functions {
            let symbols = self.graph.symbols_of([*function]);
            let has_no_value = symbols.is_empty() && self.graph.constant_value(*function).is_none();
            if has_no_value || symbols.iter().any(|symbol| self.states.contains(symbol)) {
                continue;
            }
            let span = &statement.equation.span;
            return Err(match symbols.first() {
                Some(symbol) => {
                    let name = self.symbol_name(*symbol);
                    let message =
                        format!("'{}' is made of known constants: {what}", self.graph.text(*function));
                    Problem::new(Code::Statement, span, message, "this claim")
                        .help(format!("what is to be identified is declared as 'param {name} unknown'"))
                }
                None => {
                    let message = format!("{} is a number: {what}", self.graph.text(*function));
                    Problem::new(Code::Statement, span, message, "this claim")
                        .help("the states at which something is claimed stand behind 'where', as in observable(x) where x = 1")
                }
            });
        }
        Ok(())
    }
}
