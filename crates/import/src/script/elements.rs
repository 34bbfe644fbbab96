//! Whole numbers of a script, and elements of vectors that are assigned to.

use super::super::expression::{ForeignExpr, ForeignKind};
use super::syntax::Syntax;
use super::values::{Form, MOST_ENTRIES, ScriptValue};
use super::workspace::ScriptWorkspace;
use palmistry_lang::{Code, Problem};

impl ScriptWorkspace<'_> {
    /// The whole number that an expression of numbers is, by what definitions stand for.
    pub fn whole(&self, value: &ForeignExpr) -> Option<i64> {
        match &value.kind {
            ForeignKind::Number(number) if number.is_int() => i64::try_from(number.numerator().clone()).ok(),
            ForeignKind::Name(name) => self.wholes.get(name).copied(),
            ForeignKind::Sum(terms) => terms.iter().try_fold(0_i64, |sum, (subtracted, term)| {
                let term = self.whole(term)?;
                if *subtracted { sum.checked_sub(term) } else { sum.checked_add(term) }
            }),
            ForeignKind::Product(factors) => factors.iter().try_fold(1_i64, |product, (divided, factor)| {
                let factor = self.whole(factor)?;
                match divided {
                    false => product.checked_mul(factor),
                    true if product.checked_rem(factor) == Some(0) => product.checked_div(factor),
                    true => None,
                }
            }),
            _ => None,
        }
    }

    /// The number of something, if it is a whole one and not negative.
    pub fn count(&mut self, syntax: &Syntax) -> Result<Option<usize>, Problem> {
        let value = match self.value(syntax)? {
            ScriptValue::One(one) => self.whole(&one),
            _ => None,
        };
        Ok(value.and_then(|value| usize::try_from(value).ok()))
    }

    /// The place of an element among the entries of what a name stands for, by its numbers from 1. One number counts the entries of a matrix by
    /// columns, as in MATLAB, or by rows; behind the end of a vector there are places, too.
    pub fn element(&self, name: &str, numbers: &[usize], by_columns: bool) -> Option<usize> {
        let (rows, count) = match self.get(name) {
            Some(Ok(ScriptValue::Many { rows, entries, form })) => {
                // an element of a list of lists is a list
                if form == Form::Rows && rows != entries.len() {
                    return None;
                }
                (rows.max(1), entries.len())
            }
            _ => (1, 1),
        };
        let columns = count / rows;
        let is_matrix = rows > 1 && columns > 1;
        // a second index that would make a matrix of a vector
        if let [row, column] = *numbers
            && (row > 1 && columns > 1 || column > 1 && rows > 1)
            && !is_matrix
        {
            return None;
        }
        match *numbers {
            [at] | [at, 1] | [1, at] if !is_matrix => at.checked_sub(1),
            [at] if is_matrix && by_columns => {
                let at = at.checked_sub(1).filter(|at| *at < count)?;
                Some(at % rows * columns + at / rows)
            }
            [at] => at.checked_sub(1).filter(|at| *at < count),
            [row, column] if is_matrix && (1..=rows).contains(&row) && (1..=columns).contains(&column) => {
                Some((row - 1) * columns + column - 1)
            }
            _ => None,
        }
    }

    /// Assigns a value to the entry at a place, see [`ScriptWorkspace::element`]. A vector grows where it has none there; one that is not there
    /// yet is a row, as in MATLAB, or a column where `down` says so.
    pub fn assign_element(
        &mut self,
        name: &str,
        place: usize,
        down: bool,
        value: ForeignExpr,
    ) -> Result<(), Problem> {
        let span = value.span.clone();
        if place >= MOST_ENTRIES {
            return Err(Problem::new(
                Code::Foreign,
                &span,
                format!("'{name}' would have too many elements"),
                "this",
            ));
        }
        let (rows, mut entries, form) = match self.get(name) {
            None | Some(Ok(ScriptValue::Else)) => (1, Vec::new(), Form::Matrix),
            Some(Ok(ScriptValue::One(one))) => (1, vec![one], Form::Matrix),
            Some(Ok(ScriptValue::Many { rows, entries, form })) => (rows, entries, form),
            Some(Err(why)) => return Err(why),
        };
        if form != Form::Matrix && place >= entries.len() {
            return Err(Problem::new(Code::Foreign, &span, format!("'{name}' has no such element"), "this")
                .help("elements are counted from 0; a list grows by 'append'"));
        }
        let is_column = down && entries.len() <= 1 || rows == entries.len() && rows > 1;
        if place >= entries.len() {
            entries.resize(place + 1, ForeignExpr::integer(0, &span));
        }
        entries[place] = value;
        let rows = if is_column { entries.len() } else { rows.max(1) };
        self.bind(name, ScriptValue::Many { rows, entries, form });
        Ok(())
    }
}
