//! Matrices, lists and arrays: how a language joins and multiplies them.

use super::super::expression::{ForeignExpr, ForeignKind, Span};
use super::values::{Form, MOST_ENTRIES, ScriptValue};
use palmistry_lang::{Code, Problem};

type Valued = Result<ScriptValue, Problem>;

pub(super) fn unlike(span: &Span) -> Problem {
    Problem::new(Code::Foreign, span, "matrices of these sizes do not go together", "here")
        .help("write the elements out")
}

/// A matrix of a size, of MATLAB or of SymPy.
pub(super) fn matrix(rows: usize, entries: Vec<ForeignExpr>) -> ScriptValue {
    ScriptValue::Many { rows, entries, form: Form::Matrix }
}

/// One entry is a number.
pub(super) fn flat(value: ScriptValue, span: &Span) -> ScriptValue {
    match value {
        ScriptValue::One(one) => ScriptValue::One(ForeignExpr { span: span.clone(), ..one }),
        other => other,
    }
}

pub(super) fn each(value: ScriptValue, of: impl Fn(ForeignExpr) -> ForeignExpr) -> ScriptValue {
    match value {
        ScriptValue::One(one) => ScriptValue::One(of(one)),
        ScriptValue::Many { rows, entries, form } => {
            ScriptValue::Many { rows, entries: entries.into_iter().map(of).collect(), form }
        }
        ScriptValue::Else => ScriptValue::Else,
    }
}

/// A sum that goes on with another term: sums stay flat, however long they are.
pub(super) fn sum_of(left: ForeignExpr, right: ForeignExpr, subtracted: bool) -> ForeignExpr {
    match left {
        ForeignExpr { kind: ForeignKind::Sum(mut terms), span } => {
            let span = span.start..right.span.end.max(span.end);
            terms.push((subtracted, right));
            ForeignExpr::new(ForeignKind::Sum(terms), &span)
        }
        left if subtracted => left.minus(right),
        left => left.plus(right),
    }
}

/// A product that goes on with another factor.
pub(super) fn product_of(left: ForeignExpr, right: ForeignExpr, divided: bool) -> ForeignExpr {
    match left {
        ForeignExpr { kind: ForeignKind::Product(mut factors), span } => {
            let span = span.start..right.span.end.max(span.end);
            factors.push((divided, right));
            ForeignExpr::new(ForeignKind::Product(factors), &span)
        }
        left if divided => left.over(right),
        left => left.times(right),
    }
}

fn too_large(span: &Span) -> Problem {
    Problem::new(Code::Foreign, span, "a matrix of too many entries", "this").help("take a part of the model")
}

/// What Python does with lists, and we do not.
fn of_lists(span: &Span) -> Problem {
    Problem::new(Code::Foreign, span, "lists are no matrices: this is no calculation in Python", "here")
        .help("write sym.Matrix([...]), or the elements out")
}

/// Lists one behind the other, as Python's '+' and 'extend' have it.
pub(super) fn chained(left: ScriptValue, right: ScriptValue, span: &Span) -> Valued {
    let (
        ScriptValue::Many { rows: above, entries: mut first, form },
        ScriptValue::Many { rows: below, entries: second, form: other },
    ) = (left, right)
    else {
        return Err(of_lists(span));
    };
    if !form.is_list() || !other.is_list() {
        return Err(of_lists(span));
    }
    if first.len() + second.len() > MOST_ENTRIES {
        return Err(too_large(span));
    }
    let form = match (first.is_empty(), second.is_empty()) {
        (true, _) => other,
        (_, true) => form,
        _ if form == other && first.len() / above.max(1) == second.len() / below.max(1) => form,
        // rows of one entry are vectors as well as lists are
        _ if first.len() == above && second.len() == below => Form::List,
        _ => return Err(unlike(span)),
    };
    first.extend(second);
    let rows = if form == Form::List { first.len() } else { above + below };
    Ok(ScriptValue::Many { rows, entries: first, form })
}

/// A list several times, as Python's '*' has it.
pub(super) fn repeated(list: ScriptValue, times: Option<i64>, span: &Span) -> Valued {
    let (ScriptValue::Many { rows, entries, form }, Some(times)) = (list, times) else {
        return Err(of_lists(span));
    };
    let times = usize::try_from(times).unwrap_or(0);
    if entries.len().saturating_mul(times) > MOST_ENTRIES {
        return Err(too_large(span));
    }
    Ok(ScriptValue::Many { rows: rows * times, entries: vec![entries; times].concat(), form })
}

/// Entry by entry. A row or a column goes with each row or column of a matrix of MATLAB.
pub(super) fn by_entries(
    left: ScriptValue,
    right: ScriptValue,
    of: &impl Fn(ForeignExpr, ForeignExpr) -> ForeignExpr,
    span: &Span,
) -> Valued {
    Ok(match (left, right) {
        (ScriptValue::One(a), ScriptValue::One(b)) => ScriptValue::One(of(a, b)),
        (ScriptValue::Many { rows, entries, form }, ScriptValue::One(b)) => {
            let entries = entries.into_iter().map(|a| of(a, b.clone())).collect();
            ScriptValue::Many { rows, entries, form }
        }
        (ScriptValue::One(a), ScriptValue::Many { rows, entries, form }) => {
            let entries = entries.into_iter().map(|b| of(a.clone(), b)).collect();
            ScriptValue::Many { rows, entries, form }
        }
        (
            ScriptValue::Many { rows: high, entries: a, form },
            ScriptValue::Many { rows: tall, entries: b, form: other },
        ) if form == other && high > 0 && tall > 0 => {
            let (wide, broad) = (a.len() / high, b.len() / tall);
            let fits = |one: usize, other: usize| one == other || one == 1 || other == 1;
            let same = high == tall && wide == broad;
            if !(same || form == Form::Matrix && fits(high, tall) && fits(wide, broad)) {
                return Err(unlike(span));
            }
            let (rows, columns) = (high.max(tall), wide.max(broad));
            if rows.saturating_mul(columns) > MOST_ENTRIES || wide == 0 || broad == 0 {
                return Err(too_large(span));
            }
            let mut entries = Vec::with_capacity(rows * columns);
            for row in 0..rows {
                for column in 0..columns {
                    let left = a[(row % high) * wide + column % wide].clone();
                    let right = b[(row % tall) * broad + column % broad].clone();
                    entries.push(of(left, right));
                }
            }
            ScriptValue::Many { rows, entries, form }
        }
        _ => return Err(unlike(span)),
    })
}

/// A sum or a difference.
pub(super) fn added(left: ScriptValue, right: ScriptValue, subtracted: bool, span: &Span) -> Valued {
    let is_list = |value: &ScriptValue| matches!(value, ScriptValue::Many { form, .. } if form.is_list());
    if is_list(&left) || is_list(&right) {
        return if subtracted { Err(of_lists(span)) } else { chained(left, right, span) };
    }
    by_entries(left, right, &|a, b| sum_of(a, b, subtracted), span)
}

/// A product or a quotient: of matrices the product of matrices, of numpy's arrays entry by entry.
pub(super) fn multiplied(left: ScriptValue, right: ScriptValue, divided: bool, span: &Span) -> Valued {
    Ok(match (left, right) {
        (
            ScriptValue::Many { rows, entries: a, form: Form::Matrix },
            ScriptValue::Many { rows: inner, entries: b, form: Form::Matrix },
        ) => {
            if divided || rows == 0 || inner == 0 || a.len() != rows * inner {
                return Err(unlike(span));
            }
            let columns = b.len() / inner;
            if rows.saturating_mul(columns).saturating_mul(inner) > MOST_ENTRIES {
                return Err(Problem::new(
                    Code::Foreign,
                    span,
                    "a product of matrices that are too large",
                    "this",
                ));
            }
            let mut entries = Vec::new();
            for row in 0..rows {
                for column in 0..columns {
                    let mut terms =
                        (0..inner).map(|k| a[row * inner + k].clone().times(b[k * columns + column].clone()));
                    let Some(first) = terms.next() else { return Err(unlike(span)) };
                    entries.push(terms.fold(first, |sum, term| sum_of(sum, term, false)));
                }
            }
            match (rows, columns) {
                (1, 1) => ScriptValue::One(entries.remove(0)),
                _ => matrix(rows, entries),
            }
        }
        (ScriptValue::One(_), ScriptValue::Many { form: Form::Matrix, .. }) if divided => {
            return Err(unlike(span));
        }
        (ScriptValue::Many { form, .. }, _) | (_, ScriptValue::Many { form, .. }) if form.is_list() => {
            return Err(of_lists(span));
        }
        (left, right) => by_entries(left, right, &|a, b| product_of(a, b, divided), span)?,
    })
}

pub(super) fn transposed(value: ScriptValue) -> ScriptValue {
    match value {
        ScriptValue::Many { rows, entries, form } if rows > 0 && form != Form::Vector => {
            let columns = entries.len() / rows;
            let at = |row: usize, column: usize| entries[row * columns + column].clone();
            let turned = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
            let entries = turned.map(|(row, column)| at(row, column)).collect();
            ScriptValue::Many { rows: columns, entries, form }
        }
        other => other,
    }
}

/// A list of Python: of numbers a list, of lists rows.
pub(super) fn list(parts: Vec<ScriptValue>, span: &Span) -> Valued {
    let are_lists = !parts.is_empty()
        && parts.iter().all(|part| matches!(part, ScriptValue::Many { form, .. } if form.is_list()));
    if are_lists {
        let (rows, mut width, mut all) = (parts.len(), None, Vec::new());
        for part in parts {
            let entries = part.entries().unwrap_or_default();
            if *width.get_or_insert(entries.len()) != entries.len() {
                return Err(Problem::new(
                    Code::Foreign,
                    span,
                    "lists of different lengths in a list",
                    "this",
                )
                .help("write one list, or lists of one element each"));
            }
            all.extend(entries);
        }
        if all.len() > MOST_ENTRIES {
            return Err(too_large(span));
        }
        return Ok(ScriptValue::Many { rows, entries: all, form: Form::Rows });
    }
    let value = stacked(parts.into_iter().map(|part| vec![part]).collect(), span)?;
    Ok(match value {
        ScriptValue::Many { rows, entries, .. } => {
            let form = if rows == entries.len() { Form::List } else { Form::Rows };
            ScriptValue::Many { rows, entries, form }
        }
        other => other,
    })
}

/// A matrix of blocks.
pub(super) fn stacked(rows: Vec<Vec<ScriptValue>>, span: &Span) -> Valued {
    let (mut height, mut width, mut entries) = (0, None, Vec::new());
    for row in rows {
        let blocks: Vec<(usize, Vec<ForeignExpr>)> = row
            .into_iter()
            .map(|block| match block {
                ScriptValue::One(one) => Ok((1, vec![one])),
                ScriptValue::Many { rows, entries, .. } => Ok((rows, entries)),
                ScriptValue::Else => {
                    Err(Problem::new(Code::Foreign, span, "a matrix of what is no number", "this"))
                }
            })
            .collect::<Result<_, _>>()?;
        let blocks: Vec<(usize, Vec<ForeignExpr>)> =
            blocks.into_iter().filter(|(_, entries)| !entries.is_empty()).collect();
        let Some(tall) = blocks.first().map(|(rows, _)| *rows) else { continue };
        if blocks.iter().any(|(rows, _)| *rows != tall) {
            return Err(unlike(span));
        }
        let columns: usize = blocks.iter().map(|(rows, entries)| entries.len() / rows).sum();
        if *width.get_or_insert(columns) != columns {
            return Err(unlike(span));
        }
        for line in 0..tall {
            for (rows, block) in &blocks {
                let wide = block.len() / rows;
                entries.extend_from_slice(&block[line * wide..(line + 1) * wide]);
            }
        }
        height += tall;
        if entries.len() > MOST_ENTRIES {
            return Err(too_large(span));
        }
    }
    Ok(matrix(height, entries))
}
