//! What an entry says of itself beside its statements: whose doing a fault is, on what a claim rests, from which other
//! entry an error follows.

use super::grammar::{identifier, quoted, statement};
use super::syntax::{ClaimBody, Statement};
use palmistry_math::expression::parse::{Read, Text, keyword, list, sign, stop};
use palmistry_math::expression::syntax::Span;
use winnow::combinator::{alt, cut_err, opt, preceded};
use winnow::prelude::*;
use winnow::stream::Location;

/// What is the matter with a form that does not hold as it stands in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Flaw {
    /// The author's for sure: a mistake of substance, or one that is carried on.
    Erratum,
    /// A sign, dot, prime, bar, index or bracket is missing or another one: only the page could tell whose doing it is.
    PrintOrScan,
    /// The scanner's for sure: characters that no typesetter sets.
    Scan,
    /// Right in another convention (an order of rows, a sign) than that which the text names.
    Convention,
    /// A sentence or a scheme that does not hold to the letter, and is not used so.
    Loose,
}

impl Flaw {
    /// All of them, in the order in which they weigh.
    pub const ALL: [Flaw; 5] = [Flaw::Erratum, Flaw::PrintOrScan, Flaw::Scan, Flaw::Convention, Flaw::Loose];

    /// The word of a verdict.
    pub fn word(self) -> &'static str {
        match self {
            Flaw::Erratum => "erratum",
            Flaw::PrintOrScan => "print or scan",
            Flaw::Scan => "scanning fault",
            Flaw::Convention => "convention",
            Flaw::Loose => "loose wording",
        }
    }

    /// The word that begins an entry, the one before the form in the text, and the one before the right form.
    pub fn keywords(self) -> [&'static str; 3] {
        match self {
            Flaw::Erratum => ["erratum", "printed", "corrected"],
            Flaw::PrintOrScan => ["damaged", "reads", "repaired"],
            Flaw::Scan => ["scan", "scanned", "repaired"],
            Flaw::Convention => ["convention", "printed", "meant"],
            Flaw::Loose => ["loose", "printed", "meant"],
        }
    }
}

/// On what a claim rests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Its sides come from different premises.
    Derived,
    /// Its sides are one thing in two notations; where that is derived or defined.
    Restates(Vec<Reference>),
    /// Not the statement of the text is checked, but something that follows from it.
    Consequence,
    /// Not all of the statement of the text is checked, but a case of it.
    Example,
}

impl Basis {
    /// The word of a verdict where the claim is proved.
    pub fn word(&self) -> &'static str {
        match self {
            Basis::Derived => "proved",
            Basis::Restates(_) => "holds by definition",
            Basis::Consequence => "consequence",
            Basis::Example => "example",
        }
    }
}

/// Another entry, a definition or a field, by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reference {
    /// Its id or name.
    pub name: String,
    /// Where that stands.
    pub span: Span,
    /// The file that it is an entry of, relative to this one; this one where nothing is said.
    pub file: Option<String>,
}

impl Reference {
    /// As it is written: `4.22`, or `4.22 in general.proof`.
    pub fn text(&self) -> String {
        match &self.file {
            None => self.name.clone(),
            Some(file) => format!("{} in {file}", self.name),
        }
    }
}

fn reference(input: &mut Text<'_>) -> Read<Reference> {
    let name = cut_err(identifier).context("the number or name of what is meant").parse_next(input)?;
    let file = opt(preceded(keyword("in"), cut_err(quoted))).parse_next(input)?;
    Ok(Reference { name: name.text, span: name.span, file })
}

/// `restates X, Y in "file"`, `consequence` or `example` behind the id of a claim.
pub(super) fn basis(input: &mut Text<'_>) -> Read<Basis> {
    let list = cut_err(list("the number or name of what is meant", reference));
    let given = alt((
        preceded(keyword("restates"), list).map(Basis::Restates),
        keyword("consequence").value(Basis::Consequence),
        keyword("example").value(Basis::Example),
    ));
    Ok(opt(given).parse_next(input)?.unwrap_or(Basis::Derived))
}

/// `follows X` behind the id of a fault.
fn follows(input: &mut Text<'_>) -> Read<Option<Reference>> {
    opt(preceded(keyword("follows"), reference)).parse_next(input)
}

/// A form as it stands in the text: in quotation marks, as a statement, or both, with `as` between them.
type Found = (Option<String>, Option<Box<Statement>>);

fn found(fault: Flaw, input: &mut Text<'_>) -> Read<Found> {
    let at = input.current_token_start();
    let quote = opt(quoted).parse_next(input)?;
    let read = match quote {
        None => Some(statement(input)?),
        Some(_) => opt(preceded(keyword("as"), statement)).parse_next(input)?,
    };
    let missing = match (fault, &quote, &read) {
        (Flaw::Erratum | Flaw::Convention, Some(_), None) => {
            Some("'as' and a statement behind the quotation: it has to be refuted")
        }
        (Flaw::Scan | Flaw::Loose, None, _) => Some("the words of the text in quotation marks"),
        _ => None,
    };
    match missing {
        None => Ok((quote, read)),
        Some(missing) if quote.is_some() => stop(input.current_token_start(), missing, None),
        Some(missing) => stop(at, missing, None),
    }
}

/// What a fault says: its id, from what it follows, where in the text it stands, and its two forms.
pub(super) struct FlawEntry {
    pub id: palmistry_math::expression::syntax::Name,
    pub follows: Option<Reference>,
    pub passage: Option<String>,
    pub body: ClaimBody,
}

/// `erratum ID [follows X] [at "page"]: printed ... corrected ...` and its kin, without the remark.
pub(super) fn fault(input: &mut Text<'_>) -> Read<FlawEntry> {
    let begin = |fault: Flaw| keyword(fault.keywords()[0]).value(fault);
    let [a, b, c, d, e] = Flaw::ALL.map(begin);
    let fault = alt((a, b, c, d, e)).parse_next(input)?;
    let [_, before, between] = fault.keywords();
    let id = cut_err(identifier).parse_next(input)?;
    let follows = follows(input)?;
    let passage = opt(preceded(keyword("at"), cut_err(quoted))).parse_next(input)?;
    cut_err(sign(":")).context("':'").parse_next(input)?;
    let what = match fault {
        Flaw::Erratum => "'printed' and the statement as it is printed",
        Flaw::PrintOrScan => "'reads' and the statement as it stands in the text",
        Flaw::Scan => "'scanned' and the damaged text in quotation marks",
        Flaw::Convention => "'printed' and the statement as it is printed",
        Flaw::Loose => "'printed' and the words of the text in quotation marks",
    };
    cut_err(keyword(before)).context(what).parse_next(input)?;
    let (quoted, printed) = found(fault, input)?;
    let what = match fault {
        Flaw::Erratum => "'corrected' and the statement as it should be",
        Flaw::PrintOrScan | Flaw::Scan => "'repaired' and the statement as it must have been",
        Flaw::Convention | Flaw::Loose => "'meant' and the statement that is meant",
    };
    cut_err(keyword(between)).context(what).parse_next(input)?;
    let right = statement(input)?;
    let body = match printed {
        Some(printed) => ClaimBody::Erratum { fault, quoted, printed, corrected: right },
        None => ClaimBody::Scan { fault, scanned: quoted.unwrap_or_default(), repaired: right },
    };
    Ok(FlawEntry { id, follows, passage, body })
}
