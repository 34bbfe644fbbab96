//! What stands between brackets: arguments, matrices by rows, and pairs.

use super::{Bracket, Parser};
use crate::script::syntax::{Syntax, SyntaxKind};
use crate::script::tokens::Dialect;
use palmistry_lang::Problem;

impl Parser<'_> {
    /// Arguments up to the closing bracket.
    pub(super) fn list(&mut self, close: &'static str, bracket: Bracket) -> Result<Vec<Syntax>, Problem> {
        self.open.push(bracket);
        let mut list = Vec::new();
        while !self.peek().is(close) {
            list.push(self.argument()?);
            // Julia has keyword arguments behind a semicolon
            let divided = self.take(",") || self.dialect == Dialect::Julia && self.take(";");
            let next = self.peek();
            let goes_on = divided || self.dialect == Dialect::Julia && self.line_ends(next);
            if !goes_on && !next.is(close) {
                return Err(self.unexpected(&format!("',' or '{close}'")));
            }
        }
        self.open.pop();
        self.next();
        Ok(list)
    }

    /// The arguments in round brackets that begin here.
    pub fn bracketed(&mut self) -> Result<Vec<Syntax>, Problem> {
        self.expect("(")?;
        self.list(")", Bracket::Round)
    }

    /// `[a b; c d]`, rows divided by semicolons and ends of lines.
    pub(super) fn rows(&mut self) -> Result<SyntaxKind, Problem> {
        self.open.push(Bracket::Square);
        let (mut rows, mut row) = (Vec::new(), Vec::new());
        loop {
            let token = self.peek();
            if token.is("]") {
                break;
            }
            if token.is(";") || token.newline && !row.is_empty() && !self.tokens[self.at - 1].is(",") {
                if !row.is_empty() {
                    rows.push(std::mem::take(&mut row));
                }
                self.take(";");
                if self.peek().is("]") {
                    break;
                }
            }
            if self.peek().is(";") {
                continue;
            }
            row.push(self.argument()?);
            let next = self.peek();
            let goes_on = self.take(",")
                || next.is(";")
                || next.is("]")
                || next.newline
                || self.dialect == Dialect::Matlab && next.spaced;
            if !goes_on {
                return Err(self.unexpected("',', ';' or ']'"));
            }
        }
        if !row.is_empty() {
            rows.push(row);
        }
        self.open.pop();
        self.next();
        Ok(SyntaxKind::Rows(rows))
    }

    pub(super) fn pairs(&mut self) -> Result<SyntaxKind, Problem> {
        self.open.push(Bracket::Curly);
        let mut pairs = Vec::new();
        while !self.peek().is("}") {
            let key = self.expression()?;
            self.expect(":")?;
            pairs.push((key, self.expression()?));
            if !self.take(",") && !self.peek().is("}") {
                return Err(self.unexpected("',' or '}'"));
            }
        }
        self.open.pop();
        self.next();
        Ok(SyntaxKind::Pairs(pairs))
    }
}
