//! From tokens to syntax, with the precedences of each language: `-x^2` is the same in all of them, `2^3^2` is not.

mod lists;

use super::super::expression::{DEEPEST, Span};
use super::syntax::{Syntax, SyntaxKind};
use super::tokens::{Dialect, Token, TokenKind};
use palmistry_lang::{Code, Problem};
use palmistry_math::number::parse_decimal;

/// Which bracket is the innermost one that is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bracket {
    Round,
    Square,
    Curly,
}

/// Reads syntax from tokens.
pub(crate) struct Parser<'a> {
    tokens: &'a [Token],
    at: usize,
    dialect: Dialect,
    open: Vec<Bracket>,
    depth: usize,
}

type Parsed = Result<Syntax, Problem>;

fn joined(kind: SyntaxKind, begin: &Span, end: usize) -> Syntax {
    Syntax { kind, span: begin.start..end }
}

fn product_kind(by_entries: bool) -> fn(Vec<(bool, Syntax)>) -> SyntaxKind {
    if by_entries { SyntaxKind::Pointwise } else { SyntaxKind::Product }
}

impl<'a> Parser<'a> {
    /// A parser of tokens, of which the last one is the end.
    pub fn new(tokens: &'a [Token], dialect: Dialect) -> Parser<'a> {
        Parser { tokens, at: 0, dialect, open: Vec::new(), depth: 0 }
    }

    /// The next token.
    pub fn peek(&self) -> &'a Token {
        &self.tokens[self.at.min(self.tokens.len() - 1)]
    }

    /// A token further on.
    pub fn ahead(&self, by: usize) -> &'a Token {
        &self.tokens[(self.at + by).min(self.tokens.len() - 1)]
    }

    /// Takes the next token.
    pub fn next(&mut self) -> &'a Token {
        let token = self.peek();
        self.at += 1;
        token
    }

    /// How many tokens were taken.
    pub fn position(&self) -> usize {
        self.at
    }

    /// Goes to a token.
    pub fn go_to(&mut self, position: usize) {
        self.at = position;
    }

    pub fn at_end(&self) -> bool {
        self.peek().kind == TokenKind::End
    }

    /// Takes a sign if it is the next token.
    pub fn take(&mut self, sign: &str) -> bool {
        let found = self.peek().is(sign);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, sign: &str) -> Result<(), Problem> {
        if self.take(sign) { Ok(()) } else { Err(self.unexpected(&format!("'{sign}'"))) }
    }

    /// The error that something else stands here.
    pub fn unexpected(&self, wanted: &str) -> Problem {
        let token = self.peek();
        let found = match &token.kind {
            TokenKind::End => "the text ends".to_owned(),
            _ => format!("'{}' stands there", token.text),
        };
        Problem::new(
            Code::ForeignText,
            &token.span,
            format!("expected {wanted}, and {found}"),
            format!("expected {wanted}"),
        )
        .help(self.advice())
    }

    /// What may be meant where something else was expected.
    fn advice(&self) -> &'static str {
        let token = self.peek();
        let before = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
        let ends_factor = before
            .is_some_and(|last| matches!(last.kind, TokenKind::Number | TokenKind::Name) || last.is(")"));
        let begins_factor = matches!(token.kind, TokenKind::Name | TokenKind::Number) || token.is("(");
        match &token.kind {
            TokenKind::Name if ["and", "or", "else"].contains(&token.text.as_str()) => {
                "this is as far as the file was understood"
            }
            TokenKind::Name
                if ["i", "j", "im", "I"].contains(&token.text.as_str())
                    && !token.spaced
                    && before.is_some_and(|last| last.kind == TokenKind::Number) =>
            {
                "there are no complex numbers"
            }
            _ if token.newline && self.open.last() == Some(&Bracket::Round) => {
                "a ',' is missing above, or a bracket is not closed"
            }
            _ if ends_factor && begins_factor && !token.newline => "a product is written with '*', as in 2*x",
            TokenKind::Sign("|") => "an absolute value is written abs(x)",
            TokenKind::Sign("//") => "a comment begins with '#', and a quotient is written with '/'",
            TokenKind::End if !self.open.is_empty() => "a bracket is not closed",
            _ => "this is as far as the file was understood",
        }
    }

    /// Whether an expression ends before a token because a line does.
    fn line_ends(&self, token: &Token) -> bool {
        token.newline
            && matches!(
                (self.open.last(), self.dialect),
                (None, _)
                    | (Some(Bracket::Square), Dialect::Matlab | Dialect::Julia)
                    | (Some(Bracket::Curly), Dialect::Matlab)
            )
    }

    /// Whether blanks stand between elements here.
    fn blanks_divide(&self) -> bool {
        self.dialect == Dialect::Matlab && self.open.last() == Some(&Bracket::Square)
    }

    /// The sign of an operator that goes on with the expression, of those that are asked for.
    fn operator(&self, signs: &[&'static str]) -> Option<&'static str> {
        let token = self.peek();
        let TokenKind::Sign(sign) = token.kind else { return None };
        let sign = signs.iter().copied().find(|own| *own == sign)?;
        if self.line_ends(token) {
            return None;
        }
        // [a -b] has two elements, [a - b] and [a-b] have one
        let begins_element = self.blanks_divide() && token.spaced && !self.ahead(1).spaced;
        (!(begins_element && matches!(sign, "+" | "-" | "~" | "!"))).then_some(sign)
    }

    /// An expression, or two with `=`, `~` or `=>` between them.
    pub fn argument(&mut self) -> Parsed {
        let left = self.expression()?;
        let Some(sign) = self.operator(&["=", "~", "=>"]) else { return Ok(left) };
        self.next();
        let right = self.expression()?;
        let (begin, end) = (left.span.clone(), right.span.end);
        Ok(joined(SyntaxKind::Equation(sign, Box::new(left), Box::new(right)), &begin, end))
    }

    /// An expression.
    pub fn expression(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Problem::new(
                Code::ForeignText,
                &self.peek().span,
                format!("more than {DEEPEST} brackets within brackets"),
                "here",
            )
            .help("give the inner part a name of its own"));
        }
        let result = self.choice();
        self.depth -= 1;
        result
    }

    fn choice(&mut self) -> Parsed {
        let first = self.conditions()?;
        if self.dialect != Dialect::Matlab && self.operator(&["?"]).is_some() {
            self.next();
            let then = self.expression()?;
            self.expect(":")?;
            let otherwise = self.expression()?;
            let (begin, end) = (first.span.clone(), otherwise.span.end);
            let kind = SyntaxKind::Choice(Box::new(first), Box::new(then), Box::new(otherwise));
            return Ok(joined(kind, &begin, end));
        }
        if matches!(self.dialect, Dialect::Python | Dialect::Printed)
            && self.peek().is_word("if")
            && !self.line_ends(self.peek())
        {
            self.next();
            let condition = self.conditions()?;
            if !self.peek().is_word("else") {
                return Err(self.unexpected("'else'"));
            }
            self.next();
            let otherwise = self.expression()?;
            let (begin, end) = (first.span.clone(), otherwise.span.end);
            let kind = SyntaxKind::Choice(Box::new(condition), Box::new(first), Box::new(otherwise));
            return Ok(joined(kind, &begin, end));
        }
        Ok(first)
    }

    /// Conditions with `or` between them, of which each may be several with `and`.
    fn conditions(&mut self) -> Parsed {
        let (any, all): (&[&'static str], &[&'static str]) = match self.dialect {
            // where they hold together like sums do, or less
            Dialect::Matlab => (&["||", "|"], &["&&", "&"]),
            _ => (&["||"], &["&&"]),
        };
        self.several(any, "or", false, |parser| parser.several(all, "and", true, Parser::comparison))
    }

    /// Parts with one of some signs between them, or a word.
    fn several(
        &mut self,
        signs: &[&'static str],
        word: &str,
        all: bool,
        part: impl Fn(&mut Self) -> Parsed,
    ) -> Parsed {
        let first = part(self)?;
        let by_word = matches!(self.dialect, Dialect::Python | Dialect::Printed);
        let begin = first.span.clone();
        let mut list = vec![first];
        loop {
            let goes_on = by_word && self.peek().is_word(word) && !self.line_ends(self.peek());
            if !goes_on && self.operator(signs).is_none() {
                break;
            }
            self.next();
            list.push(part(self)?);
        }
        match (list.len(), list.pop()) {
            (1, Some(only)) => Ok(only),
            (_, Some(last)) => {
                let end = last.span.end;
                list.push(last);
                Ok(joined(SyntaxKind::Conditions(all, list), &begin, end))
            }
            (_, None) => Err(self.unexpected("a condition")),
        }
    }

    /// A sum, or conditions in brackets with `&` and `|` between them: these signs bind as a product and a sum do, but in MATLAB.
    fn operand(&mut self) -> Parsed {
        let first = self.sum()?;
        if self.dialect == Dialect::Matlab || self.operator(&["&", "|"]).is_none() {
            return Ok(first);
        }
        let begin = first.span.clone();
        // those that hold together, and what stands between such
        let mut any = vec![vec![self.in_brackets(first)?]];
        while let Some(sign) = self.operator(&["&", "|"]) {
            self.next();
            let next = self.sum()?;
            let next = self.in_brackets(next)?;
            match any.last_mut().filter(|_| sign == "&") {
                Some(all) => all.push(next),
                None => any.push(vec![next]),
            }
        }
        let end = self.tokens[self.at - 1].span.end;
        let several = |all: bool, mut list: Vec<Syntax>| match (list.len(), list.pop()) {
            (1, Some(only)) => only,
            (_, last) => {
                list.extend(last);
                joined(SyntaxKind::Conditions(all, list), &begin, end)
            }
        };
        let list = any.into_iter().map(|list| several(true, list)).collect();
        Ok(several(false, list))
    }

    /// A condition that holds together.
    fn in_brackets(&self, one: Syntax) -> Parsed {
        match one.kind {
            SyntaxKind::Compare(..)
            | SyntaxKind::Conditions(..)
            | SyntaxKind::Not(_)
            | SyntaxKind::Name(_)
            | SyntaxKind::Call(..) => Ok(one),
            _ => Err(Problem::new(Code::ForeignText, &one.span, "this is no condition", "here")
                .help("each condition beside '&' and '|' has brackets of its own: (x > 0) & (x < 1)")),
        }
    }

    fn comparison(&mut self) -> Parsed {
        const SIGNS: [&str; 7] = ["<", "<=", ">", ">=", "==", "!=", "~="];
        let left = self.operand()?;
        let Some(sign) = self.operator(&SIGNS) else { return Ok(left) };
        self.next();
        let right = self.operand()?;
        if self.operator(&SIGNS).is_some() {
            return Err(Problem::new(
                Code::ForeignText,
                &self.peek().span,
                "conditions of several parts are not read",
                "here",
            )
            .help("write each comparison by itself: (0 < x) & (x < 1)"));
        }
        let is_condition = |one: &Syntax| matches!(one.kind, SyntaxKind::Conditions(..));
        if is_condition(&left) || is_condition(&right) {
            return Err(Problem::new(Code::ForeignText, &left.span, "a condition is compared", "here")
                .help("each condition beside '&' and '|' has brackets of its own: (x > 0) & (x < 1)"));
        }
        let sign = if sign == "~=" { "!=" } else { sign };
        let (begin, end) = (left.span.clone(), right.span.end);
        Ok(joined(SyntaxKind::Compare(sign, Box::new(left), Box::new(right)), &begin, end))
    }

    fn sum(&mut self) -> Parsed {
        let first = self.product()?;
        let begin = first.span.clone();
        let mut terms = vec![(false, first)];
        while let Some(sign) = self.operator(&["+", "-"]) {
            self.next();
            terms.push((sign == "-", self.product()?));
        }
        self.collected(terms, &begin, SyntaxKind::Sum)
    }

    fn product(&mut self) -> Parsed {
        let first = self.signed()?;
        let begin = first.span.clone();
        let mut factors = vec![(false, first)];
        // whether the factors so far are multiplied entry by entry, and how often that changed
        let (mut by_entries, mut changes) = (false, 0);
        loop {
            let signs: &[&'static str] = match self.dialect {
                Dialect::Matlab | Dialect::Julia => &["*", "/", ".*", "./"],
                Dialect::Python | Dialect::Printed => &["*", "/"],
            };
            let Some(sign) = self.operator(signs) else { break };
            let own = self.dialect == Dialect::Matlab && sign.starts_with('.');
            if own != by_entries && factors.len() > 1 {
                changes += 1;
                if changes > DEEPEST {
                    return Err(Problem::new(
                        Code::ForeignText,
                        &self.peek().span,
                        "a product of too many parts",
                        "here",
                    )
                    .help("give its parts names of their own"));
                }
                factors = vec![(false, self.collected(factors, &begin, product_kind(by_entries))?)];
            }
            by_entries = own;
            self.next();
            factors.push((matches!(sign, "/" | "./"), self.signed()?));
        }
        self.collected(factors, &begin, product_kind(by_entries))
    }

    fn collected(
        &self,
        mut list: Vec<(bool, Syntax)>,
        begin: &Span,
        kind: fn(Vec<(bool, Syntax)>) -> SyntaxKind,
    ) -> Parsed {
        match (list.len(), list.pop()) {
            (1, Some((_, only))) => Ok(only),
            (_, Some(last)) => {
                let end = last.1.span.end;
                list.push(last);
                Ok(joined(kind(list), begin, end))
            }
            (_, None) => Err(self.unexpected("an expression")),
        }
    }

    /// Signs before a factor: they bind weaker than a power and stronger than a product.
    fn signed(&mut self) -> Parsed {
        let begin = self.peek().span.clone();
        let mut negative = false;
        let mut turned = false;
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::Sign("+") => {}
                TokenKind::Sign("-") => negative = !negative,
                TokenKind::Sign("!" | "~") => turned = !turned,
                _ => break,
            }
            self.next();
        }
        let inner = self.fraction()?;
        let end = inner.span.end;
        let inner = if turned { joined(SyntaxKind::Not(Box::new(inner)), &begin, end) } else { inner };
        Ok(match negative {
            true => joined(SyntaxKind::Sum(vec![(true, inner)]), &begin, end),
            false => inner,
        })
    }

    /// `1//2` of Julia binds stronger than a product.
    fn fraction(&mut self) -> Parsed {
        let first = self.coefficient()?;
        if self.dialect != Dialect::Julia || self.operator(&["//"]).is_none() {
            return Ok(first);
        }
        let begin = first.span.clone();
        let mut factors = vec![(false, first)];
        while self.operator(&["//"]).is_some() {
            self.next();
            factors.push((true, self.coefficient()?));
        }
        self.collected(factors, &begin, SyntaxKind::Product)
    }

    /// `2x` of Julia binds stronger than a product, and its power is that of `x`.
    fn coefficient(&mut self) -> Parsed {
        let (token, behind) = (self.peek(), self.ahead(1));
        let is_coefficient = self.dialect == Dialect::Julia
            && token.kind == TokenKind::Number
            && !behind.spaced
            && (behind.kind == TokenKind::Name || behind.is("("));
        if !is_coefficient {
            return self.power();
        }
        let number = self.primary()?;
        let factor = self.power()?;
        let (begin, end) = (number.span.clone(), factor.span.end);
        Ok(joined(SyntaxKind::Product(vec![(false, number), (false, factor)]), &begin, end))
    }

    fn power(&mut self) -> Parsed {
        let signs: &[&'static str] = match self.dialect {
            Dialect::Python => &["**"],
            Dialect::Printed => &["**", "^"],
            Dialect::Matlab | Dialect::Julia => &["^", ".^"],
        };
        let mut base = self.postfix()?;
        let mut powers = 0;
        while self.operator(signs).is_some() {
            self.next();
            powers += 1;
            if powers > DEEPEST {
                return Err(Problem::new(Code::ForeignText, &self.peek().span, "a tower of powers", "here")
                    .help("write it shorter"));
            }
            // from the left in MATLAB, from the right elsewhere; a sign of the exponent is its own
            let exponent = match self.dialect {
                Dialect::Matlab => self.signed_primary()?,
                _ => {
                    self.depth += 1;
                    if self.depth > DEEPEST {
                        return Err(Problem::new(
                            Code::ForeignText,
                            &self.peek().span,
                            "a tower of powers",
                            "here",
                        )
                        .help("write it shorter"));
                    }
                    let exponent = self.exponent()?;
                    self.depth -= 1;
                    exponent
                }
            };
            let (begin, end) = (base.span.clone(), exponent.span.end);
            base = joined(SyntaxKind::Power(Box::new(base), Box::new(exponent)), &begin, end);
        }
        if self.dialect == Dialect::Python && self.operator(&["^"]).is_some() {
            return Err(Problem::new(
                Code::ForeignText,
                &self.peek().span,
                "'^' is no power in Python",
                "this",
            )
            .help("write '**' for a power"));
        }
        Ok(base)
    }

    fn exponent(&mut self) -> Parsed {
        let begin = self.peek().span.clone();
        let mut negative = false;
        while let TokenKind::Sign(sign @ ("+" | "-")) = self.peek().kind {
            negative ^= sign == "-";
            self.next();
        }
        let inner = self.coefficient()?;
        let end = inner.span.end;
        Ok(if negative { joined(SyntaxKind::Sum(vec![(true, inner)]), &begin, end) } else { inner })
    }

    fn signed_primary(&mut self) -> Parsed {
        let begin = self.peek().span.clone();
        let mut negative = false;
        while let TokenKind::Sign(sign @ ("+" | "-")) = self.peek().kind {
            negative ^= sign == "-";
            self.next();
        }
        let inner = self.postfix()?;
        let end = inner.span.end;
        Ok(if negative { joined(SyntaxKind::Sum(vec![(true, inner)]), &begin, end) } else { inner })
    }

    fn postfix(&mut self) -> Parsed {
        let mut inner = self.primary()?;
        for _ in 0..DEEPEST {
            let token = self.peek();
            let begin = inner.span.clone();
            let divided = self.line_ends(token) || self.blanks_divide() && token.spaced;
            let kind = match token.kind {
                TokenKind::Sign(_) if divided => return Ok(inner),
                TokenKind::Sign("(") if !matches!(inner.kind, SyntaxKind::Number(_)) => {
                    self.next();
                    let mut list = self.list(")", Bracket::Round)?;
                    // Julia has the base of a logarithm in front
                    let has_base = self.dialect == Dialect::Julia && list.len() == 2;
                    if has_base && inner.as_name() == Some("log") {
                        list.swap(0, 1);
                    }
                    SyntaxKind::Call(Box::new(inner), list)
                }
                TokenKind::Sign("[") if self.dialect != Dialect::Matlab && !token.spaced => {
                    self.next();
                    SyntaxKind::Index(Box::new(inner), self.list("]", Bracket::Square)?)
                }
                TokenKind::Sign("'" | ".'") if !token.spaced => {
                    self.next();
                    SyntaxKind::Prime(Box::new(inner))
                }
                TokenKind::Sign(".") if self.ahead(1).kind == TokenKind::Name => {
                    self.next();
                    SyntaxKind::Member(Box::new(inner), self.next().text.clone())
                }
                _ => return Ok(inner),
            };
            let end = self.tokens[self.at - 1].span.end;
            inner = joined(kind, &begin, end);
        }
        Err(Problem::new(Code::ForeignText, &inner.span, "calls of calls of calls", "here")
            .help("give the inner part a name of its own"))
    }

    fn primary(&mut self) -> Parsed {
        let token = self.next();
        let span = token.span.clone();
        let kind = match &token.kind {
            TokenKind::Number => SyntaxKind::Number(self.value(token)?),
            TokenKind::Name => SyntaxKind::Name(token.text.clone()),
            TokenKind::Text(text) => SyntaxKind::Text(text.clone()),
            // `@1` of CasADi, `@parameters` of Julia
            TokenKind::Sign("@") if !self.peek().spaced => {
                let name = self.next();
                SyntaxKind::Name(format!("@{}", name.text))
            }
            // `:name` of Julia
            TokenKind::Sign(":") if self.dialect == Dialect::Julia && self.peek().kind == TokenKind::Name => {
                SyntaxKind::Text(self.next().text.clone())
            }
            TokenKind::Sign("(") => {
                let mut list = self.list(")", Bracket::Round)?;
                match (list.len(), self.tokens[self.at.saturating_sub(2)].is(",")) {
                    (1, false) => {
                        let inner = list.remove(0);
                        return Ok(Syntax {
                            kind: inner.kind,
                            span: span.start..self.tokens[self.at - 1].span.end,
                        });
                    }
                    _ => SyntaxKind::List(list),
                }
            }
            TokenKind::Sign("[") => match self.dialect {
                Dialect::Matlab | Dialect::Julia => self.rows()?,
                Dialect::Python | Dialect::Printed => SyntaxKind::List(self.list("]", Bracket::Square)?),
            },
            TokenKind::Sign("{") => self.pairs()?,
            _ => {
                self.at -= 1;
                return Err(self.unexpected("an expression"));
            }
        };
        Ok(joined(kind, &span, self.tokens[self.at - 1].span.end))
    }

    fn value(&self, token: &Token) -> Result<dashu::rational::RBig, Problem> {
        let plain: String = token
            .text
            .chars()
            .filter(|c| *c != '_')
            .map(|c| if matches!(c, 'f' | 'd' | 'D') { 'e' } else { c })
            .collect();
        parse_decimal(&plain).ok_or_else(|| {
            Problem::new(Code::ForeignText, &token.span, "a number that is too long", "this")
                .help("decimals of at most 4096 digits, with an exponent of at most 4096")
        })
    }
}
