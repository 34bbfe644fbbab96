//! Loops of MATLAB over numbers that stand in the file: their statements are read once for each number, and nothing is run.

use super::super::expression::ForeignExpr;
use super::super::script::{Parser, ScriptValue, TokenKind};
use super::Script;
use palmistry_lang::{Code, Problem};

/// Loops within loops beyond this are not read, nor more statements within loops than that.
const DEEPEST_LOOP: usize = 8;
const MOST_REPETITIONS: u64 = 20_000;

impl Script<'_> {
    /// `for i = 1:n ... end`: its statements are read once for each number, in order. Nothing else of a loop is read.
    pub(super) fn repeated(&mut self, parser: &mut Parser<'_>) -> Result<(), Problem> {
        let begin = parser.next().span.clone();
        self.deep += 1;
        if self.deep > DEEPEST_LOOP {
            return Err(Problem::new(
                Code::Foreign,
                &begin,
                format!("more than {DEEPEST_LOOP} loops within loops"),
                "here",
            ));
        }
        let in_brackets = parser.take("(");
        let variable = parser.next();
        if variable.kind != TokenKind::Name || !parser.take("=") {
            return Err(Problem::new(
                Code::Foreign,
                &variable.span,
                "expected a loop such as 'for i = 1:3'",
                "here",
            ));
        }
        let numbers = self.loop_numbers(parser)?;
        if in_brackets && !parser.take(")") {
            return Err(parser.unexpected("')'"));
        }
        let body = parser.position();
        for number in &numbers {
            parser.go_to(body);
            let value = ForeignExpr::integer(*number, &variable.span);
            self.workspace.bind(&variable.text, ScriptValue::One(value));
            while !parser.peek().is_word("end") {
                if parser.take(";") || parser.take(",") {
                    continue;
                }
                let (place, spent) = (parser.position(), self.repetitions);
                if parser.at_end() || spent >= MOST_REPETITIONS {
                    let why = if parser.at_end() {
                        "this loop has no 'end'"
                    } else {
                        "these loops have too many steps"
                    };
                    return Err(Problem::new(Code::Foreign, &begin, why, "this loop")
                        .help("write the model without it"));
                }
                self.repetitions += 1;
                self.statement(parser)?;
                let next = parser.peek();
                let is_over = next.newline || next.is(";") || next.is(",") || next.is_word("end");
                if parser.at_end() || !is_over || parser.position() == place {
                    return Err(parser.unexpected("the end of the line"));
                }
            }
        }
        if numbers.is_empty() {
            self.skip_loop(parser);
            let why = Problem::new(Code::Foreign, &variable.span, "this loop has no steps", "this");
            self.workspace.break_name(&variable.text, why.help("nothing has a value by it"));
        }
        if !parser.peek().is_word("end") {
            return Err(parser.unexpected("'end'"));
        }
        parser.next();
        self.deep -= 1;
        Ok(())
    }

    /// The numbers that a loop goes through: `1:3`, `9:-2:1`, `[1 4 6]`.
    fn loop_numbers(&mut self, parser: &mut Parser<'_>) -> Result<Vec<i64>, Problem> {
        let first = parser.expression()?;
        let mut parts = vec![self.workspace.value(&first)?];
        while parser.take(":") {
            let next = parser.expression()?;
            parts.push(self.workspace.value(&next)?);
        }
        let no = || {
            Problem::new(Code::Foreign, &first.span, "a loop goes through whole numbers", "these")
                .help("write them as 1:3, or as [1 2 3]")
        };
        let mut numbers = Vec::new();
        for part in parts.iter().cloned() {
            // a loop goes through columns
            if let ScriptValue::Many { rows, entries, .. } = &part
                && *rows > 1
            {
                let message =
                    format!("a loop goes through columns, and this has {} rows", rows.min(&entries.len()));
                return Err(Problem::new(Code::Foreign, &first.span, message, "these")
                    .help("write the numbers as a row: 1:3, or [1 2 3]"));
            }
            let entries = part.entries().ok_or_else(no)?;
            numbers.push(
                entries
                    .iter()
                    .map(|one| self.workspace.whole(one))
                    .collect::<Option<Vec<i64>>>()
                    .ok_or_else(no)?,
            );
        }
        let one =
            |numbers: &Vec<i64>| <[i64; 1]>::try_from(numbers.as_slice()).map(|[one]| one).map_err(|_| no());
        let (low, step, high) = match numbers.as_slice() {
            [list] => return Ok(list.clone()),
            [low, high] => (one(low)?, 1, one(high)?),
            [low, step, high] => (one(low)?, one(step)?, one(high)?),
            _ => return Err(no()),
        };
        if step == 0 || (high.saturating_sub(low) / step).unsigned_abs() > MOST_REPETITIONS {
            return Err(no());
        }
        let is_within = |at: &i64| if step > 0 { *at <= high } else { *at >= high };
        Ok(std::iter::successors(Some(low), |at| at.checked_add(step)).take_while(is_within).collect())
    }

    /// Goes to the end of a loop that is never gone through.
    fn skip_loop(&self, parser: &mut Parser<'_>) {
        let (mut open, mut brackets) = (0_usize, 0_usize);
        while !parser.at_end() {
            let word = parser.peek();
            match &word.kind {
                TokenKind::Sign("(" | "[" | "{") => brackets += 1,
                TokenKind::Sign(")" | "]" | "}") => brackets = brackets.saturating_sub(1),
                // `x(end)` is an element
                TokenKind::Name if brackets == 0 && word.text == "end" => match open {
                    0 => return,
                    _ => open -= 1,
                },
                TokenKind::Name
                    if brackets == 0
                        && ["for", "if", "while", "switch", "try", "parfor"]
                            .contains(&word.text.as_str()) =>
                {
                    open += 1;
                }
                _ => {}
            }
            parser.next();
        }
    }
}
