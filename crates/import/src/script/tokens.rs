//! Foreign text as tokens: numbers, names, texts and signs; comments kept aside.

use super::super::expression::Span;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};

/// Whose text it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dialect {
    Julia,
    Python,
    Matlab,
    /// Formulas as SymPy and CasADi print them, or as people write them.
    Printed,
}

/// What a token is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    Number,
    Name,
    /// A text in quotation marks, without them.
    Text(String),
    Sign(&'static str),
    End,
}

/// A token of the text.
#[derive(Clone, Debug)]
pub(crate) struct Token {
    pub kind: TokenKind,
    pub span: Span,
    /// As it is written.
    pub text: String,
    /// Whether a blank stands before it.
    pub spaced: bool,
    /// Whether a line ends before it.
    pub newline: bool,
}

impl Token {
    /// Whether it is this sign.
    pub fn is(&self, sign: &str) -> bool {
        matches!(self.kind, TokenKind::Sign(own) if own == sign)
    }

    /// Whether it is this word.
    pub fn is_word(&self, word: &str) -> bool {
        self.kind == TokenKind::Name && self.text == word
    }
}

/// All signs, longer ones first.
const SIGNS: [&str; 47] = [
    "...", "===", "**", "==", "~=", "!=", "<=", ">=", "=>", "->", "&&", "||", "//", ".*", "./", ".^", ".'",
    "+=", "-=", "*=", "/=", "::", "+", "-", "*", "/", "^", "=", "<", ">", "(", ")", "[", "]", "{", "}", ",",
    ";", ":", "~", "!", "?", "@", "&", "|", ".", "'",
];

/// Signs of print, and those of the keyboard.
const PRINTED_SIGNS: [(char, &str); 5] = [('−', "-"), ('·', "*"), ('⋅', "*"), ('×', "*"), ('∗', "*")];

/// Digits that are raised.
fn is_raised(c: char) -> bool {
    matches!(c, '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | 'ⁿ')
}

/// Comments with the places where they begin.
pub(crate) type Comments = Vec<(usize, String)>;

/// The tokens of a text, each a node of the budget, and its comments with their places.
///
/// # Errors
/// A character that begins nothing, a text that does not end, or too many tokens.
pub(crate) fn tokens(
    text: &str,
    dialect: Dialect,
    budget: &Budget,
) -> Result<(Vec<Token>, Comments), Problem> {
    let mut reading = Reading { text, dialect, at: 0, tokens: Vec::new(), comments: Vec::new() };
    reading.all()?;
    let paid = budget.nodes(reading.tokens.len());
    paid.map_err(|spent| crate::too_much(&(0..text.len().min(1)), spent))?;
    Ok((reading.tokens, reading.comments))
}

struct Reading<'a> {
    text: &'a str,
    dialect: Dialect,
    at: usize,
    tokens: Vec<Token>,
    comments: Comments,
}

fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

impl Reading<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn goes_on(&self, c: char) -> bool {
        c.is_alphanumeric()
            || c == '_'
            || matches!(c, '\u{300}'..='\u{36f}' | '\u{2032}')
            || (c == '!' && self.dialect == Dialect::Julia)
    }

    fn all(&mut self) -> Result<(), Problem> {
        loop {
            let (spaced, newline) = self.blank()?;
            let begin = self.at;
            let kind = match self.peek() {
                None => TokenKind::End,
                Some(c) => self.one(c, spaced || newline)?,
            };
            let (span, ends) = (begin..self.at, kind == TokenKind::End);
            let text = match kind == TokenKind::Name && self.dialect == Dialect::Julia {
                true => normalised(&self.text[span.clone()]),
                false => self.text[span.clone()].to_owned(),
            };
            self.tokens.push(Token { kind, span, text, spaced: spaced || newline, newline });
            if ends {
                return Ok(());
            }
        }
    }

    /// Blanks, ends of lines, comments; whether there was any, and whether a line has ended.
    fn blank(&mut self) -> Result<(bool, bool), Problem> {
        let (mut spaced, mut newline) = (false, false);
        loop {
            let rest = self.rest();
            let Some(c) = rest.chars().next() else { return Ok((spaced, newline)) };
            if c == '\n' {
                newline = true;
                self.at += 1;
            } else if c.is_whitespace() || c == '\u{feff}' {
                spaced = true;
                self.at += c.len_utf8();
            } else if self.dialect == Dialect::Julia && rest.starts_with("#=") {
                self.nested_comment()?;
            } else if self.dialect == Dialect::Matlab && self.begins_block() {
                self.block_comment();
            } else if c == '#' && self.dialect != Dialect::Matlab
                || c == '%' && self.dialect == Dialect::Matlab
            {
                let line = line_of(rest).to_owned();
                self.comments.push((self.at, line.trim_start_matches(['#', '%']).trim().to_owned()));
                self.at += line.len();
            } else if self.dialect == Dialect::Matlab && rest.starts_with("...") {
                // the line goes on below
                self.at += line_of(rest).len();
                self.at += usize::from(self.rest().starts_with('\n'));
                spaced = true;
            } else if self.dialect == Dialect::Python && c == '\\' && line_of(rest).trim() == "\\" {
                self.at += line_of(rest).len();
                self.at += usize::from(self.rest().starts_with('\n'));
                spaced = true;
            } else {
                return Ok((spaced, newline));
            }
        }
    }

    /// Whether `%{` stands here in a line of its own.
    fn begins_block(&self) -> bool {
        let before = || self.text[..self.at].rsplit('\n').next().is_none_or(|line| line.trim().is_empty());
        self.rest().starts_with("%{") && line_of(self.rest()).trim() == "%{" && before()
    }

    fn nested_comment(&mut self) -> Result<(), Problem> {
        let (begin, mut open) = (self.at, 0_usize);
        loop {
            let rest = self.rest();
            if rest.starts_with("#=") {
                open += 1;
                self.at += 2;
            } else if rest.starts_with("=#") {
                open -= 1;
                self.at += 2;
                if open == 0 {
                    let inside = self.text[begin + 2..self.at - 2].to_owned();
                    let lines = inside.lines().map(|line| (begin, line.trim().to_owned()));
                    self.comments.extend(lines.filter(|(_, line)| !line.is_empty()));
                    return Ok(());
                }
            } else if let Some(c) = rest.chars().next() {
                self.at += c.len_utf8();
            } else {
                return Err(Problem::new(
                    Code::ForeignText,
                    &(begin..begin + 2),
                    "this comment does not end",
                    "begins here",
                )
                .help("close it with '=#'"));
            }
        }
    }

    fn block_comment(&mut self) {
        let begin = self.at;
        loop {
            let line = line_of(self.rest()).to_owned();
            self.at += line.len();
            let ends = line.trim() == "%}";
            if !ends && line.trim() != "%{" {
                self.comments.push((begin, line.trim().to_owned()));
            }
            if ends || self.rest().is_empty() {
                return;
            }
            self.at += 1;
        }
    }

    fn one(&mut self, c: char, spaced: bool) -> Result<TokenKind, Problem> {
        let rest = self.rest();
        let next_is_digit = rest[c.len_utf8()..].starts_with(|c: char| c.is_ascii_digit());
        if c.is_ascii_digit() || c == '.' && next_is_digit {
            return self.number();
        }
        if begins_name(c) {
            let length = rest.find(|c| !self.goes_on(c)).unwrap_or(rest.len());
            // `a!=b` compares
            let length = match (rest[..length].find('!'), rest[length..].starts_with('=')) {
                (Some(mark), true) => mark,
                _ => length,
            };
            if self.dialect != Dialect::Julia
                && let Some((at, c)) = rest[..length].char_indices().find(|(_, c)| is_raised(*c))
            {
                let span = self.at + at..self.at + at + c.len_utf8();
                let sign = if self.dialect == Dialect::Python { "**" } else { "^" };
                return Err(Problem::new(Code::ForeignText, &span, format!("'{c}' is no power"), "this")
                    .help(format!("a power is written with '{sign}', as in x{sign}2")));
            }
            self.at += length;
            return Ok(TokenKind::Name);
        }
        // a prime right behind something is one, elsewhere it begins a text
        let behind = !spaced
            && self.tokens.last().is_some_and(|last| match &last.kind {
                TokenKind::Name | TokenKind::Number => true,
                TokenKind::Sign(sign) => matches!(*sign, ")" | "]" | "}" | "'" | ".'"),
                _ => false,
            });
        if c == '"' || c == '\'' && !behind && self.dialect != Dialect::Julia {
            return self.quoted(c);
        }
        // signs as they are printed
        if let Some((_, sign)) = PRINTED_SIGNS.iter().find(|(own, _)| *own == c)
            && (self.dialect == Dialect::Printed || self.dialect == Dialect::Julia && !matches!(c, '×' | '∗'))
        {
            self.at += c.len_utf8();
            return Ok(TokenKind::Sign(sign));
        }
        let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(*sign)) else {
            let span = self.at..self.at + c.len_utf8();
            let help = match c {
                '−' => "write the minus sign of the keyboard, '-'",
                '·' | '⋅' | '×' | '∗' => "a product is written with '*'",
                '÷' => "a quotient is written with '/'",
                '√' => "a root is written sqrt(x)",
                '°' => "angles are in radians: write x*pi/180",
                '%' => "a comment begins with '#'; a percentage is written as a decimal",
                '\\' | '$' if self.dialect == Dialect::Printed => {
                    "LaTeX is not read: write an equation as x' = -k*x"
                }
                _ => "take it out, or write what it stands for",
            };
            return Err(Problem::new(
                Code::ForeignText,
                &span,
                format!("'{c}' begins nothing that can be read"),
                "this",
            )
            .help(help));
        };
        self.at += sign.len();
        Ok(TokenKind::Sign(sign))
    }

    fn number(&mut self) -> Result<TokenKind, Problem> {
        let begin = self.at;
        let digits = |reading: &mut Self| {
            let rest = reading.rest();
            let underscores = matches!(reading.dialect, Dialect::Julia | Dialect::Python);
            let length =
                rest.find(|c: char| !(c.is_ascii_digit() || underscores && c == '_')).unwrap_or(rest.len());
            let length = rest[..length].trim_end_matches('_').len();
            reading.at += length;
        };
        digits(self);
        let behind = self.rest().strip_prefix('.').map(|rest| rest.chars().next());
        let is_operator = |next: Option<char>| {
            matches!(self.dialect, Dialect::Matlab | Dialect::Julia)
                && matches!(next, Some('*' | '/' | '^' | '\'' | '\\'))
        };
        if behind.is_some_and(|next| {
            !is_operator(next) && !next.is_some_and(|c| begins_name(c) && !matches!(c, 'e' | 'E' | 'd' | 'D'))
        }) {
            self.at += 1;
            digits(self);
        }
        let rest = self.rest();
        let marks = match self.dialect {
            Dialect::Julia => &['e', 'E', 'f'][..],
            Dialect::Matlab => &['e', 'E', 'd', 'D'],
            _ => &['e', 'E'],
        };
        if let Some(exponent) = rest.strip_prefix(marks) {
            let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            if unsigned.starts_with(|c: char| c.is_ascii_digit()) {
                self.at += rest.len() - unsigned.len();
                digits(self);
            }
        }
        let is_other_base = &self.text[begin..self.at] == "0"
            && self.dialect != Dialect::Matlab
            && self.rest().starts_with(['x', 'b', 'o']);
        if is_other_base {
            return Err(Problem::new(
                Code::ForeignText,
                &(begin..self.at + 1),
                "a number that is no decimal",
                "this",
            )
            .help("write it in decimal digits"));
        }
        Ok(TokenKind::Number)
    }

    fn quoted(&mut self, mark: char) -> Result<TokenKind, Problem> {
        let begin = self.at;
        let triple: String = std::iter::repeat_n(mark, 3).collect();
        let end = match self.rest().starts_with(&triple) && self.dialect != Dialect::Matlab {
            true => triple,
            false => mark.to_string(),
        };
        self.at += end.len();
        let inside = self.at;
        loop {
            let rest = self.rest();
            if rest.starts_with(&end) {
                let text = self.text[inside..self.at].to_owned();
                self.at += end.len();
                return Ok(TokenKind::Text(text));
            }
            match rest.chars().next() {
                Some('\\') if self.dialect != Dialect::Matlab => {
                    self.at += 1;
                    self.at += self.peek().map_or(0, char::len_utf8);
                }
                Some('\n') if end.len() == 1 => break,
                Some(c) => self.at += c.len_utf8(),
                None => break,
            }
        }
        let problem = Problem::new(
            Code::ForeignText,
            &(begin..begin + end.len()),
            "this text does not end",
            "begins here",
        );
        Err(problem.help(format!("close it with {end}")))
    }
}

/// Letters with marks that follow them, and the one letter that both are. Those of Latin and of time derivatives: others are left as they are.
const COMPOSED: [(char, &str, &str); 9] = [
    ('\u{300}', "aeiounwyAEIOUNWY", "àèìòùǹẁỳÀÈÌÒÙǸẀỲ"),
    ('\u{301}', "aeiouyclnrszgkmpwAEIOUYCLNRSZGKMPW", "áéíóúýćĺńŕśźǵḱḿṕẃÁÉÍÓÚÝĆĹŃŔŚŹǴḰḾṔẂ"),
    ('\u{302}', "aeioucghjswyzAEIOUCGHJSWYZ", "âêîôûĉĝĥĵŝŵŷẑÂÊÎÔÛĈĜĤĴŜŴŶẐ"),
    ('\u{303}', "anoiuevyANOIUEVY", "ãñõĩũẽṽỹÃÑÕĨŨẼṼỸ"),
    ('\u{304}', "aeiouygAEIOUYG", "āēīōūȳḡĀĒĪŌŪȲḠ"),
    ('\u{307}', "abcdefghmnoprstwxyzABCDEFGHIMNOPRSTWXYZ", "ȧḃċḋėḟġḣṁṅȯṗṙṡṫẇẋẏżȦḂĊḊĖḞĠḢİṀṄȮṖṘṠṪẆẊẎŻ"),
    ('\u{308}', "aeiouywxhtAEIOUYWXH", "äëïöüÿẅẍḧẗÄËÏÖÜŸẄẌḦ"),
    ('\u{30a}', "auwyAU", "åůẘẙÅŮ"),
    ('\u{30c}', "cdenrstzaiougkhjCDENRSTZAIOUGKH", "čďěňřšťžǎǐǒǔǧǩȟǰČĎĚŇŘŠŤŽǍǏǑǓǦǨȞ"),
];

/// A name as Julia takes it: letters that look alike, and letters with a mark that are written in two ways, are one.
fn normalised(name: &str) -> String {
    let mut out = String::with_capacity(name.len());
    for c in name.chars() {
        let composed = COMPOSED.iter().find(|(mark, ..)| *mark == c).and_then(|(_, plain, marked)| {
            let last = out.chars().last()?;
            let at = plain.chars().position(|own| own == last)?;
            marked.chars().nth(at)
        });
        match (c, composed) {
            ('\u{b5}', _) => out.push('\u{3bc}'),
            ('\u{25b}', _) => out.push('\u{3b5}'),
            (_, Some(composed)) => {
                out.pop();
                out.push(composed);
            }
            _ => out.push(c),
        }
    }
    out
}

fn line_of(text: &str) -> &str {
    text.split('\n').next().unwrap_or(text)
}
