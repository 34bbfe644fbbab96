//! What an expression means, once somebody says what its names are.

use super::super::expression::{ForeignExpr, ForeignKind, ForeignOrder, Span};
use super::super::functions::{call, case};
use super::syntax::{Syntax, SyntaxKind};
use palmistry_lang::{Code, Problem};

/// A formula of more cases is refused.
pub(crate) const MOST_CASES: usize = 2000;

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
        SyntaxKind::Compare(..) | SyntaxKind::Not(_) => {
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

fn unread(span: &Span) -> Problem {
    Problem::new(Code::Foreign, span, "this condition cannot be read", "this")
        .help("one comparison with '<', '<=', '>' or '>='")
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
