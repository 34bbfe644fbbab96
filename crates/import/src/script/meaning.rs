//! What an expression means, once somebody says what its names are.

use super::super::expression::{ForeignExpr, ForeignKind, ForeignOrder, Span};
use super::super::functions::{call, case};
use super::syntax::{Syntax, SyntaxKind};
use palmistry_lang::{Code, Problem};

/// A formula of more cases is refused.
pub(crate) const MOST_CASES: usize = 2000;

/// A condition of more parts is refused: each nests the case.
const MOST_PARTS: usize = 40;

/// Values with more parts than these are not written several times.
const TWICE: usize = 40;

type Meant = Result<ForeignExpr, Problem>;

/// The name and the arguments of a call, whatever module the function is taken from: `exp(x)`, `sym.exp(x)`.
pub(crate) fn named_function(syntax: &Syntax) -> Option<(&str, &[Syntax])> {
    let SyntaxKind::Call(callee, arguments) = &syntax.kind else { return None };
    match &callee.kind {
        SyntaxKind::Name(name) => Some((name, arguments)),
        SyntaxKind::Member(_, name) => Some((name, arguments)),
        _ => None,
    }
}

fn refused(syntax: &Syntax, what: &str) -> Problem {
    Problem::new(Code::Foreign, &syntax.span, format!("{what} is no number"), "this")
        .help("a number is meant here: write an expression")
}

/// What a piece of syntax means as a number. `special` is asked first at every part, and says what it knows: what names are, what
/// calls of functions of its own are.
pub(crate) fn meaning(syntax: &Syntax, special: &mut impl FnMut(&Syntax) -> Option<Meant>) -> Meant {
    if let Some(own) = special(syntax) {
        return own;
    }
    let span = &syntax.span;
    match &syntax.kind {
        SyntaxKind::Number(value) => Ok(ForeignExpr::new(ForeignKind::Number(value.clone()), span)),
        SyntaxKind::Name(name) => {
            Err(Problem::new(Code::Foreign, span, format!("nothing says what '{name}' is"), "this name")
                .help("declare it above"))
        }
        SyntaxKind::Sum(terms) => {
            let terms: Vec<(bool, ForeignExpr)> = all(terms, special)?;
            match <[_; 1]>::try_from(terms) {
                Ok([(true, only)]) => Ok(ForeignExpr { span: span.clone(), ..only.negative() }),
                Ok([(false, only)]) => Ok(only),
                Err(terms) => Ok(ForeignExpr::new(ForeignKind::Sum(terms), span)),
            }
        }
        SyntaxKind::Product(factors) | SyntaxKind::Pointwise(factors) => {
            Ok(ForeignExpr::new(ForeignKind::Product(all(factors, special)?), span))
        }
        SyntaxKind::Power(base, exponent) => {
            let kind =
                ForeignKind::Power(Box::new(meaning(base, special)?), Box::new(meaning(exponent, special)?));
            Ok(ForeignExpr::new(kind, span))
        }
        SyntaxKind::Choice(condition, then, otherwise) => choice(condition, then, otherwise, special),
        SyntaxKind::Compare(..) | SyntaxKind::Not(_) | SyntaxKind::Conditions(..) => {
            // what is true counts as one
            let number = |value: i64| Ok(ForeignExpr::integer(value, span));
            let (one, zero) = (number(1)?, number(0)?);
            compared(syntax, one, zero, special)
        }
        SyntaxKind::Call(..) => function(syntax, special),
        SyntaxKind::List(list) => match list.as_slice() {
            [only] => meaning(only, special),
            _ => Err(refused(syntax, "a list")),
        },
        SyntaxKind::Rows(rows) => match rows.as_slice() {
            [row] if row.len() == 1 => meaning(&row[0], special),
            _ => Err(refused(syntax, "a matrix")),
        },
        SyntaxKind::Text(_) => Err(refused(syntax, "a text")),
        SyntaxKind::Pairs(_) => Err(refused(syntax, "a list of pairs")),
        SyntaxKind::Equation(..) => Err(refused(syntax, "an equation")),
        SyntaxKind::Member(_, name) => match super::super::functions::constant(name, span) {
            Some(constant) => Ok(constant),
            None => Err(refused(syntax, &format!("'{name}'"))),
        },
        SyntaxKind::Index(..) => Err(refused(syntax, "an element of something unknown")),
        SyntaxKind::Prime(_) => {
            Err(Problem::new(Code::Foreign, span, "a derivative stands in an expression", "this")
                .help("write what it is equal to: only rates of states may stand on the left"))
        }
    }
}

fn all(
    list: &[(bool, Syntax)],
    special: &mut impl FnMut(&Syntax) -> Option<Meant>,
) -> Result<Vec<(bool, ForeignExpr)>, Problem> {
    list.iter().map(|(mark, part)| Ok((*mark, meaning(part, special)?))).collect()
}

/// `then` where a condition holds, and `otherwise` elsewhere.
fn choice(
    condition: &Syntax,
    then: &Syntax,
    otherwise: &Syntax,
    special: &mut impl FnMut(&Syntax) -> Option<Meant>,
) -> Meant {
    let (then, otherwise) = (meaning(then, special)?, meaning(otherwise, special)?);
    compared(condition, then, otherwise, special)
}

fn compared(
    condition: &Syntax,
    then: ForeignExpr,
    otherwise: ForeignExpr,
    special: &mut impl FnMut(&Syntax) -> Option<Meant>,
) -> Meant {
    match &condition.kind {
        SyntaxKind::Not(inner) => compared(inner, otherwise, then, special),
        SyntaxKind::Compare(sign, left, right) => {
            let order = order(sign).ok_or_else(|| {
                Problem::new(
                    Code::Foreign,
                    &condition.span,
                    format!("cases by '{sign}' are not read"),
                    "this condition",
                )
                .help("what holds on a thin set alone has no derivative: leave the case out")
            })?;
            let (left, right) = (meaning(left, special)?, meaning(right, special)?);
            Ok(case(left, order, right, then, otherwise))
        }
        SyntaxKind::Conditions(all, list) => {
            if list.len() > MOST_PARTS {
                let message = format!("a condition of more than {MOST_PARTS} parts");
                return Err(Problem::new(Code::Foreign, &condition.span, message, "this condition")
                    .help("write cases within cases"));
            }
            // both values would stand there several times: one comparison of a number that is one or zero
            if then.size() + otherwise.size() > TWICE {
                let number = |value: i64| ForeignExpr::integer(value, &condition.span);
                let holds = compared(condition, number(1), number(0), special)?;
                let half = number(1).over(number(2));
                return Ok(case(holds, ForeignOrder::Greater, half, then, otherwise));
            }
            let mut value = if *all { then.clone() } else { otherwise.clone() };
            for part in list.iter().rev() {
                value = match *all {
                    true => compared(part, value, otherwise.clone(), special)?,
                    false => compared(part, then.clone(), value, special)?,
                };
            }
            Ok(value)
        }
        // several conditions that have a name
        SyntaxKind::Name(_) | SyntaxKind::Call(..) if matches!(special(condition), Some(Ok(value)) if is_flag(&value, true)) =>
        {
            let Some(Ok(value)) = special(condition) else { return Err(unread(&condition.span)) };
            let number = |value: i64| ForeignExpr::integer(value, &condition.span);
            Ok(case(value, ForeignOrder::Greater, number(1).over(number(2)), then, otherwise))
        }
        // a condition that has a name: CasADi's @1, one where it holds and zero elsewhere, or the other way about
        SyntaxKind::Name(_) => match special(condition) {
            Some(Ok(ForeignExpr { kind: ForeignKind::Case { sides, order, values }, .. })) => {
                let ((left, right), is_number) = (*sides, |value: &ForeignExpr, number: i64| {
                    value.as_number().is_some_and(|own| *own == number.into())
                });
                let (holds, fails) = *values;
                match (
                    is_number(&holds, 1) && is_number(&fails, 0),
                    is_number(&holds, 0) && is_number(&fails, 1),
                ) {
                    (true, _) => Ok(case(left, order, right, then, otherwise)),
                    (_, true) => Ok(case(left, order, right, otherwise, then)),
                    _ => Err(unread(&condition.span)),
                }
            }
            Some(Err(problem)) => Err(problem),
            _ => Err(unread(&condition.span)),
        },
        _ => Err(unread(&condition.span)),
    }
}

/// Whether a value is nothing but one and zero by conditions within conditions, of which one alone is none of its values.
fn is_flag(value: &ForeignExpr, outermost: bool) -> bool {
    match &value.kind {
        ForeignKind::Number(number) => {
            !outermost && (*number == dashu::rational::RBig::ONE || *number == dashu::rational::RBig::ZERO)
        }
        ForeignKind::Case { values, .. } => {
            let is_nested = |value: &ForeignExpr| matches!(value.kind, ForeignKind::Case { .. });
            (!outermost || is_nested(&values.0) || is_nested(&values.1))
                && is_flag(&values.0, false)
                && is_flag(&values.1, false)
        }
        _ => false,
    }
}

fn unread(span: &Span) -> Problem {
    Problem::new(Code::Foreign, span, "this condition cannot be read", "this")
        .help("comparisons with '<', '<=', '>' or '>=', joined by '&' and '|'")
}

fn order(sign: &str) -> Option<ForeignOrder> {
    Some(match sign {
        "<" => ForeignOrder::Less,
        "<=" => ForeignOrder::AtMost,
        ">" => ForeignOrder::Greater,
        ">=" => ForeignOrder::AtLeast,
        _ => return None,
    })
}

fn function(syntax: &Syntax, special: &mut impl FnMut(&Syntax) -> Option<Meant>) -> Meant {
    let Some((name, arguments)) = named_function(syntax) else {
        return Err(refused(syntax, "this call"));
    };
    match (name, arguments) {
        ("ifelse" | "if_else", [condition, then, otherwise]) => choice(condition, then, otherwise, special),
        ("Piecewise" | "piecewise", cases) if !cases.is_empty() => piecewise(syntax, cases, special),
        // what changes the form and not the value, and is called so by nobody else
        ("UnevaluatedExpr", [inner]) => meaning(inner, special),
        (_, [inner]) if keeps_the_value(syntax) => meaning(inner, special),
        _ => {
            if let Some(keyword) = arguments.iter().find(|one| matches!(one.kind, SyntaxKind::Equation(..))) {
                return Err(Problem::new(
                    Code::Foreign,
                    &keyword.span,
                    format!("'{name}' has no such argument"),
                    "this",
                ));
            }
            let values: Vec<ForeignExpr> =
                arguments.iter().map(|one| meaning(one, special)).collect::<Result<_, _>>()?;
            call(name, values, &syntax.span)
        }
    }
}

/// `Integer(2)` and `Float('0.1', 15)` of SymPy, as the numbers that they are: `Integer` cuts off what stands behind the point, and a `Float` of few
/// digits is another number, so these are refused.
pub(crate) fn made_number(name: &str, value: ForeignExpr, rest: &[Syntax], span: &Span) -> Meant {
    let refused =
        |message: String, help: &str| Err(Problem::new(Code::Foreign, span, message, "this").help(help));
    let Some(number) = value.exact(&|_| None) else {
        return refused(
            format!("'{name}' of what is no number"),
            "write the number, or the expression alone",
        );
    };
    if name == "Integer" && !number.is_int() {
        return refused(
            "'Integer' of a number that is no whole one cuts off what stands behind the point".to_owned(),
            "write the whole number that is meant, or Rational(27, 10) for 2.7",
        );
    }
    for one in rest {
        let (digits, fewest) = match &one.kind {
            SyntaxKind::Equation("=", word, digits) => {
                (digits.as_ref(), if word.as_name() == Some("precision") { 50 } else { 15 })
            }
            _ => (one, 15),
        };
        if !matches!(&digits.kind, SyntaxKind::Number(digits) if *digits >= dashu::rational::RBig::from(fewest))
        {
            let message = format!("'{name}' of so few digits is another number");
            return refused(message, "write all digits that are meant, without the number of them");
        }
    }
    Ok(ForeignExpr { span: span.clone(), ..value })
}

/// Whether a call changes the form of its argument and not the value: a function of SymPy, by its module (`sym.factor(x)`). By the name
/// alone it may be any function.
pub(crate) fn keeps_the_value(syntax: &Syntax) -> bool {
    const NAMES: [&str; 8] =
        ["simplify", "expand", "factor", "collect", "together", "cancel", "sympify", "S"];
    let SyntaxKind::Call(callee, _) = &syntax.kind else { return false };
    match &callee.kind {
        SyntaxKind::Member(module, name) => {
            matches!(module.as_name(), Some("sym" | "sympy" | "sp" | "sy" | "Symbolics"))
                && NAMES.contains(&name.as_str())
        }
        SyntaxKind::Name(name) => matches!(name.as_str(), "simplify" | "expand"),
        _ => false,
    }
}

/// `Piecewise((e, condition), ..., (e, True))`
fn piecewise(syntax: &Syntax, cases: &[Syntax], special: &mut impl FnMut(&Syntax) -> Option<Meant>) -> Meant {
    if cases.len() > MOST_CASES {
        return Err(Problem::new(
            Code::Foreign,
            &syntax.span,
            format!("more than {MOST_CASES} cases"),
            "this",
        )
        .help("a table of values is no model: say it as a formula"));
    }
    let mut result: Option<ForeignExpr> = None;
    for one in cases.iter().rev() {
        let SyntaxKind::List(pair) = &one.kind else { return Err(refused(one, "this case")) };
        let [value, condition] = pair.as_slice() else { return Err(refused(one, "this case")) };
        result = Some(match (condition.as_name(), result) {
            (Some("True" | "true"), None) => meaning(value, special)?,
            (_, Some(otherwise)) => {
                let then = meaning(value, special)?;
                compared(condition, then, otherwise, special)?
            }
            (_, None) => {
                return Err(Problem::new(
                    Code::Foreign,
                    &condition.span,
                    "nothing is said of what is so elsewhere",
                    "the last case",
                )
                .help("end with a case for all others: (value, True)"));
            }
        });
    }
    result.ok_or_else(|| refused(syntax, "no case"))
}
