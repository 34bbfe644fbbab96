//! The smallest parts of a text: blanks, signs, words, names, numbers, and brackets counted; and what was expected where something
//! else stands.

use crate::expression::syntax::{Expr, ExprKind, Name, Span};
use crate::number::parse_decimal;
use std::cell::{Cell, RefCell};
use winnow::combinator::{alt, opt};
use winnow::error::{AddContext, ErrMode, ModalResult, ParserError};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful, Stream};
use winnow::token::{literal, one_of, take_till, take_while};

/// Text with the place in it, and how deep in brackets we are.
pub type Text<'a> = Stateful<LocatingSlice<&'a str>, &'a Depth>;

/// What is counted while a text is read.
#[derive(Debug, Default)]
pub struct Depth {
    /// How many brackets are open.
    pub(super) open: Cell<usize>,
    /// Whether the innermost open bracket is that of a matrix.
    pub(super) in_row: Cell<bool>,
    /// How many parts of expressions were written out for values of indices.
    pub(super) written_out: Cell<usize>,
    /// The indices that were met, where each gets its range.
    pub indices: RefCell<Vec<Name>>,
}

/// More brackets within brackets than this are refused: nobody means them.
pub(super) const DEEPEST: usize = 120;

/// What is expected where no parser says it.
const NOTHING_SAID: &str = "something else";

/// What was expected at a place in the text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {what}")]
pub struct Expected {
    /// In words.
    pub what: String,
    /// The byte at which it was expected.
    pub at: usize,
    /// What may help.
    pub help: Option<String>,
}

impl<'a> ParserError<Text<'a>> for Expected {
    type Inner = Self;

    fn from_input(input: &Text<'a>) -> Self {
        Expected { what: NOTHING_SAID.to_owned(), at: input.current_token_start(), help: None }
    }
    fn or(self, other: Self) -> Self {
        // the branch that came further knows better
        if self.at > other.at { self } else { other }
    }
    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

impl<'a> AddContext<Text<'a>, &'static str> for Expected {
    fn add_context(
        mut self,
        input: &Text<'a>,
        start: &<Text<'a> as Stream>::Checkpoint,
        what: &'static str,
    ) -> Self {
        // name the whole only where nothing inside it was recognised
        let mut begin = *input;
        begin.reset(start);
        if self.at == begin.current_token_start() || self.what == NOTHING_SAID {
            self.what = what.to_owned();
        }
        self
    }
}

/// What a parser gives: a value, or what was expected instead.
pub type Read<T> = ModalResult<T, Expected>;

/// Stops the reading with a message of our own.
pub fn stop<T>(at: usize, what: impl Into<String>, help: Option<String>) -> Read<T> {
    Err(ErrMode::Cut(Expected { what: what.into(), at, help }))
}

/// Whether a character ends a line, and with it a comment: whatever some editor shows as the end of a line, so that nothing
/// that is shown below a comment is read as a part of it.
pub fn ends_a_line(c: char) -> bool {
    matches!(c, '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{1c}'..='\u{1e}' | '\u{85}' | '\u{2028}' | '\u{2029}')
}

/// White space and comments, which run from `#` to the end of the line.
pub fn blank(input: &mut Text<'_>) -> Read<()> {
    loop {
        take_while(0.., |c: char| c.is_whitespace() || ends_a_line(c)).void().parse_next(input)?;
        if opt(literal("#")).parse_next(input)?.is_none() {
            return Ok(());
        }
        take_till(0.., ends_a_line).void().parse_next(input)?;
    }
}

/// A sign or bracket, and the blank after it.
pub fn sign<'a>(text: &'static str) -> impl Parser<Text<'a>, (), ErrMode<Expected>> {
    (literal(text), blank).void()
}

/// Words that begin something and so cannot be names.
pub const RESERVED: [&str; 33] = [
    "system",
    "assume",
    "latex",
    "cite",
    "use",
    "state",
    "param",
    "angle",
    "let",
    "drift",
    "input",
    "field",
    "output",
    "sample",
    "avoid",
    "in",
    "claim",
    "erratum",
    "printed",
    "corrected",
    "damaged",
    "convention",
    "loose",
    "scan",
    "scanned",
    "repaired",
    "definition",
    "undecided",
    "where",
    "at",
    "within",
    "expect",
    "for",
];

/// Words with a meaning at some places; elsewhere they are names.
pub const SPECIAL: [&str; 32] = [
    "proved",
    "conclusion",
    "refuted",
    "restates",
    "consequence",
    "example",
    "follows",
    "reads",
    "meant",
    "as",
    "on",
    "carrying",
    "everywhere",
    "except",
    "or",
    "digits",
    "others",
    "set",
    "singularity",
    "pole",
    "map",
    "line",
    "reduction",
    "of",
    "order",
    "to",
    "from",
    "infinity",
    "known",
    "unknown",
    "initial",
    "experiments",
];

/// Those of them that are no names where one is declared: a comma too many would make a constant of them.
pub const UNDECLARABLE: [&str; 6] = ["known", "unknown", "everywhere", "except", "infinity", "others"];

/// Greek letters with their names, which a name may be written with: `\u{3c6}1` is `phi1`. Variants of a letter are the letter.
const GREEK: [(&str, &str); 24] = [
    ("\u{3b1}\u{391}", "alpha"),
    ("\u{3b2}\u{392}\u{3d0}", "beta"),
    ("\u{3b3}\u{393}", "gamma"),
    ("\u{3b4}\u{394}\u{2206}", "delta"),
    ("\u{3b5}\u{395}\u{3f5}", "epsilon"),
    ("\u{3b6}\u{396}", "zeta"),
    ("\u{3b7}\u{397}", "eta"),
    ("\u{3b8}\u{398}\u{3d1}", "theta"),
    ("\u{3b9}\u{399}", "iota"),
    ("\u{3ba}\u{39a}\u{3f0}", "kappa"),
    ("\u{3bb}\u{39b}", "lambda"),
    ("\u{3bc}\u{39c}\u{b5}", "mu"),
    ("\u{3bd}\u{39d}", "nu"),
    ("\u{3be}\u{39e}", "xi"),
    ("\u{3bf}\u{39f}", "omicron"),
    ("\u{3c0}\u{3a0}\u{3d6}", "pi"),
    ("\u{3c1}\u{3a1}\u{3f1}", "rho"),
    ("\u{3c3}\u{3a3}\u{3c2}", "sigma"),
    ("\u{3c4}\u{3a4}", "tau"),
    ("\u{3c5}\u{3a5}", "upsilon"),
    ("\u{3c6}\u{3a6}\u{3d5}", "phi"),
    ("\u{3c7}\u{3a7}", "chi"),
    ("\u{3c8}\u{3a8}", "psi"),
    ("\u{3c9}\u{3a9}\u{2126}", "omega"),
];

/// The name of a Greek letter, with a capital where the letter is one.
fn greek_name(letter: char) -> Option<String> {
    let (letters, name) = GREEK.into_iter().find(|(letters, _)| letters.contains(letter))?;
    // of each letter the second is the capital
    let is_capital = letters.chars().nth(1) == Some(letter) || matches!(letter, '\u{2206}' | '\u{2126}');
    let capital = || format!("{}{}", name[..1].to_ascii_uppercase(), &name[1..]);
    Some(if is_capital { capital() } else { name.to_owned() })
}

/// A name as the program calls it: Greek letters by their names.
fn spelled(text: &str) -> String {
    text.chars().map(|c| greek_name(c).unwrap_or_else(|| c.to_string())).collect()
}

fn is_letter(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_' || greek_name(c).is_some()
}

/// Letters, digits and underscores, beginning with a letter.
pub fn word<'a>(input: &mut Text<'a>) -> Read<(&'a str, Span)> {
    (one_of(is_letter), take_while(0.., |c: char| c.is_ascii_digit() || is_letter(c)))
        .take()
        .with_span()
        .parse_next(input)
}

/// A closing bracket, and the blank after it; where the bracket ends.
pub(super) fn closing<'a>(text: &'static str) -> impl Parser<Text<'a>, usize, ErrMode<Expected>> {
    (literal(text).span(), blank).map(|(span, ())| span.end)
}

/// The same, with advice where it cannot be read and has none of its own.
pub fn helped<'a, T>(
    help: &'static str,
    mut parser: impl Parser<Text<'a>, T, ErrMode<Expected>>,
) -> impl Parser<Text<'a>, T, ErrMode<Expected>> {
    move |input: &mut Text<'a>| {
        parser.parse_next(input).map_err(|error| {
            error.map(|expected: Expected| Expected {
                help: expected.help.clone().or_else(|| Some(help.to_owned())),
                ..expected
            })
        })
    }
}

/// One or more, with commas between them. Behind a comma another one has to stand, unless the comma ends its line: then what
/// stands in the next one belongs to something else, and the comma is left for others to wonder at.
pub fn list<'a, T>(
    what: &'static str,
    mut one: impl Parser<Text<'a>, T, ErrMode<Expected>>,
) -> impl Parser<Text<'a>, Vec<T>, ErrMode<Expected>> {
    move |input: &mut Text<'a>| {
        let mut found = vec![one.parse_next(input)?];
        loop {
            let comma = input.checkpoint();
            if opt(literal(",")).parse_next(input)?.is_none() {
                return Ok(found);
            }
            // no farther than the next sign: a list is as long as its line
            let next = input.input.as_ref().chars().find(|c| ends_a_line(*c) || !c.is_whitespace());
            let ends_line = next.is_none_or(|c| c == '#' || ends_a_line(c));
            blank(input)?;
            match one.parse_next(input) {
                Ok(next) => found.push(next),
                Err(ErrMode::Backtrack(_)) if ends_line => {
                    input.reset(&comma);
                    return Ok(found);
                }
                Err(ErrMode::Backtrack(error)) => {
                    let is_named = error.what != NOTHING_SAID;
                    let what = if is_named { error.what } else { what.to_owned() };
                    return Err(ErrMode::Cut(Expected { what, ..error }));
                }
                Err(error) => return Err(error),
            }
        }
    }
}

/// One of the words of the language, and the blank after it.
pub fn keyword<'a>(text: &'static str) -> impl Parser<Text<'a>, Span, ErrMode<Expected>> {
    debug_assert!(RESERVED.contains(&text) || SPECIAL.contains(&text), "'{text}' is in no list of words");
    move |input: &mut Text<'a>| {
        let start = input.checkpoint();
        match word.parse_next(input) {
            Ok((found, span)) if found == text => {
                blank(input)?;
                Ok(span)
            }
            Ok((_, span)) => {
                input.reset(&start);
                Err(ErrMode::Backtrack(Expected { what: format!("'{text}'"), at: span.start, help: None }))
            }
            Err(error) => {
                input.reset(&start);
                Err(error)
            }
        }
    }
}

/// A name that is not reserved, with parts joined by dots (`general.f`), and the blank after it.
pub fn name(input: &mut Text<'_>) -> Read<Name> {
    let name = bare_name(input)?;
    blank(input)?;
    Ok(name)
}

/// Right behind a name that has been declared: `'` for a derivative of a signal, `@2` for the second experiment, or both. As it is
/// written in names: the primes first, and of the first experiment nothing.
pub(super) fn suffix(input: &mut Text<'_>) -> Read<String> {
    let before = take_while(0.., '\'').parse_next(input)?;
    let experiment =
        opt((literal("@"), take_while(1.., |c: char| c.is_ascii_digit())).take()).parse_next(input)?;
    // the primes may stand behind the experiment too
    let behind = match experiment {
        Some(_) => take_while(0.., '\'').parse_next(input)?,
        None => "",
    };
    let experiment = experiment.filter(|experiment| *experiment != "@1").unwrap_or_default();
    Ok(format!("{before}{behind}{experiment}"))
}

/// A name without the blank after it.
pub(super) fn bare_name(input: &mut Text<'_>) -> Read<Name> {
    let start = input.checkpoint();
    let ((first, _), span) = (word, winnow::combinator::repeat::<_, _, (), _, _>(0.., (literal("."), word)))
        .map(|((text, span), ())| (text, span))
        .with_span()
        .parse_next(input)?;
    if RESERVED.contains(&first) {
        input.reset(&start);
        let what = format!("a name; '{first}' is a word of the language");
        return Err(ErrMode::Backtrack(Expected { what, at: span.start, help: None }));
    }
    let mut whole = *input;
    whole.reset(&start);
    let text = spelled(&whole.input.as_ref()[..span.len()]);
    Ok(Name { text, span })
}

/// An unsigned number as it is written in a file.
pub(super) fn number(input: &mut Text<'_>) -> Read<Expr> {
    let digits = |c: char| c.is_ascii_digit();
    let mantissa = alt((
        (take_while(1.., digits), opt((literal("."), take_while(0.., digits)))).void(),
        (literal("."), take_while(1.., digits)).void(),
    ));
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), take_while(1.., digits)).void();
    let (text, span) = (mantissa, opt(exponent)).take().with_span().parse_next(input)?;
    let Some(value) = parse_decimal(text) else {
        // the place is that of the exponent, or of the last digit: at its beginning a number is what is expected
        let at = text.find(['e', 'E']).map_or(span.end - 1, |exponent| span.start + exponent + 1);
        return stop(at, "a number of at most 4096 digits, with an exponent of at most 4096", None);
    };
    blank(input)?;
    Ok(Expr { kind: ExprKind::Number(value), span })
}

/// Something in brackets, counted.
pub fn within<'a, T>(input: &mut Text<'a>, inner: impl Parser<Text<'a>, T, ErrMode<Expected>>) -> Read<T> {
    let depth = input.state;
    if depth.open.get() >= DEEPEST {
        let at = input.current_token_start();
        return stop(
            at,
            format!("at most {DEEPEST} brackets within brackets"),
            Some("name the inner part with 'let'".into()),
        );
    }
    depth.open.set(depth.open.get() + 1);
    let in_row = depth.in_row.replace(false);
    let mut inner = inner;
    let result = inner.parse_next(input);
    depth.in_row.set(in_row);
    depth.open.set(depth.open.get() - 1);
    result
}
