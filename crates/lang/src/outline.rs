//! What a text declares and where, for editors: read by the one grammar, also where some of it cannot be read, and without
//! the meaning of names.

use super::grammar::{Entries, parse_entries};
use super::model::Role;
use super::signals::Knowledge;
use super::standing::{Basis, Reference};
use super::syntax::{ClaimBody, Item, OutputSyntax};
use super::views::View;
use palmistry_math::expression::parse::ends_a_line;
use palmistry_math::expression::syntax::{Name, Span};

/// What a declaration is one of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclarationKind {
    /// The title of the system.
    System,
    /// Another file that is used.
    Import,
    /// A state.
    State,
    /// A parameter.
    Parameter,
    /// A signal, and whether it is known.
    Signal(bool),
    /// A definition by `let`.
    Definition,
    /// A vector field, by its role.
    Field(Role),
    /// An output.
    Output,
    /// A claim or an erratum, by the word that begins it.
    Claim(&'static str),
    /// A set, a pole, a map or a line, by its word.
    View(&'static str),
    /// A reduction to another file's system.
    Reduction,
}

impl DeclarationKind {
    /// The word that declares it.
    pub fn word(self) -> &'static str {
        match self {
            DeclarationKind::System => "system",
            DeclarationKind::Import => "use",
            DeclarationKind::State => "state",
            DeclarationKind::Parameter => "param",
            DeclarationKind::Signal(true) => "known",
            DeclarationKind::Signal(false) => "unknown",
            DeclarationKind::Definition => "let",
            DeclarationKind::Field(role) => role.name(),
            DeclarationKind::Output => "output",
            DeclarationKind::Claim(word) | DeclarationKind::View(word) => word,
            DeclarationKind::Reduction => "reduction",
        }
    }

    /// Whether expressions and fields refer to it by its name.
    pub fn has_a_name(self) -> bool {
        use DeclarationKind::{Definition, Field, Import, Parameter, Signal, State};
        matches!(self, Import | State | Parameter | Signal(_) | Definition | Field(_))
    }
}

/// Something that a file declares.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// What is declared.
    pub kind: DeclarationKind,
    /// Its name, id, title or text.
    pub name: String,
    /// Where that stands.
    pub span: Span,
    /// The entry that declares it, without blanks and comments behind it.
    pub entry: Span,
}

/// Another file that an entry names.
#[derive(Clone, Debug)]
pub struct ImportedFile {
    pub alias: String,
    /// As it is written, relative to the folder of the file.
    pub path: String,
    /// The entry.
    pub entry: Span,
}

/// What a text declares and refers to.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// In the order of the text.
    pub declarations: Vec<Declaration>,
    /// What it imports.
    pub imports: Vec<ImportedFile>,
    /// What stands behind `restates` and `follows`.
    pub references: Vec<Reference>,
}

/// More parts than this that are no entries are not looked behind.
const MOST_DAMAGE: usize = 1000;

impl Outline {
    /// The outline of a text with plain line ends.
    pub fn of(text: &str) -> Outline {
        let Entries { items, spans, .. } = parse_entries(text, MOST_DAMAGE);
        let mut outline = Outline::default();
        for (item, span) in items.iter().zip(spans) {
            let entry = span.start..span.start + length_without_rest(&text[span]);
            outline.enter(text, item, &entry);
        }
        outline
    }

    /// What names stand for: the declarations of a name that expressions and fields refer to; of a component or a vector,
    /// those of the vector's components.
    pub fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Declaration> {
        let is_meant = move |one: &Declaration| match one.name.split_once('[') {
            Some((vector, _)) => vector == name.split('[').next().unwrap_or_default(),
            None => one.name == name,
        };
        self.declarations.iter().filter(move |one| one.kind.has_a_name() && is_meant(one))
    }

    /// The claim or erratum of an id.
    pub fn claim(&self, id: &str) -> Option<&Declaration> {
        let is_claim = |one: &&Declaration| matches!(one.kind, DeclarationKind::Claim(_));
        self.declarations.iter().filter(is_claim).find(|one| one.name == id)
    }

    fn enter(&mut self, text: &str, item: &Item, entry: &Span) {
        let named: Vec<(DeclarationKind, &Name)> = match item {
            Item::State(list) => list.iter().map(|one| (DeclarationKind::State, &one.name)).collect(),
            Item::Param(list) => list.iter().map(|one| (DeclarationKind::Parameter, &one.name)).collect(),
            Item::Let { name, .. } => vec![(DeclarationKind::Definition, name)],
            Item::Signals { knowledge, list } => {
                let kind = DeclarationKind::Signal(*knowledge == Knowledge::Known);
                list.iter().map(|one| (kind, &one.name)).collect()
            }
            _ => Vec::new(),
        };
        for (kind, Name { span, .. }) in named {
            // the components of a range are declared once, as they are written
            if self.declarations.last().is_none_or(|last| last.span != *span) {
                let (name, span, entry) = (super::in_one_line(text, span), span.clone(), entry.clone());
                self.declarations.push(Declaration { kind, name, span, entry });
            }
        }
        let mut add = |kind: DeclarationKind, name: &str, span: &Span| {
            let (name, span, entry) = (name.to_owned(), span.clone(), entry.clone());
            self.declarations.push(Declaration { kind, name, span, entry });
        };
        match item {
            Item::System { title, span, .. } => add(DeclarationKind::System, title, span),
            Item::Use { alias, path, .. } => {
                add(DeclarationKind::Import, &alias.text, &alias.span);
                let (alias, path, entry) = (alias.text.clone(), path.clone(), entry.clone());
                self.imports.push(ImportedFile { alias, path, entry });
            }
            Item::Field { role, name, .. } => add(DeclarationKind::Field(*role), &name.text, &name.span),
            Item::Output(list) | Item::Zero(list) => {
                // what stands for several is listed once
                let mut last = None;
                for OutputSyntax { value, .. } in list {
                    if last.replace(&value.span) != Some(&value.span) {
                        add(DeclarationKind::Output, &super::in_one_line(text, &value.span), &value.span);
                    }
                }
            }
            Item::Claim(claim) => {
                let word = match &claim.body {
                    ClaimBody::Claim { .. } => "claim",
                    ClaimBody::Erratum { fault, .. } | ClaimBody::Scan { fault, .. } => fault.keywords()[0],
                    ClaimBody::Definition { .. } => "definition",
                    ClaimBody::Open { .. } => "undecided",
                };
                add(DeclarationKind::Claim(word), &claim.id, &claim.span);
                if let Basis::Restates(list) = &claim.basis {
                    self.references.extend(list.iter().cloned());
                }
                self.references.extend(claim.follows.clone());
            }
            Item::View(view) => match &**view {
                View::Set { title, is_pole, span, .. } => {
                    add(DeclarationKind::View(if *is_pole { "singularity" } else { "set" }), title, span);
                }
                View::Map { title, span, .. } => add(DeclarationKind::View("map"), title, span),
                View::Line { title, span, .. } => add(DeclarationKind::View("line"), title, span),
                View::Reduction { alias, .. } => add(DeclarationKind::Reduction, &alias.text, &alias.span),
            },
            Item::Signals { .. } | Item::State(_) | Item::Param(_) | Item::Let { .. } => {}
            Item::Angle(_)
            | Item::Looks(_)
            | Item::Assume(_)
            | Item::Initial(_)
            | Item::Experiments { .. }
            | Item::Sample { .. } => {}
        }
    }
}

/// A text without its claims, sets, maps, lines and reductions: the system alone.
pub fn without_claims(text: &str) -> String {
    let Entries { items, spans, .. } = parse_entries(text, MOST_DAMAGE);
    let kept = items.iter().zip(spans).filter(|(item, _)| !matches!(item, Item::Claim(_) | Item::View(_)));
    kept.map(|(_, span)| format!("{}\n", text[span].trim_end())).collect()
}

/// How much of an entry is left without the blanks and comments behind it.
fn length_without_rest(text: &str) -> usize {
    let (mut end, mut quoted, mut comment) = (0, false, false);
    for (place, c) in text.char_indices() {
        quoted ^= c == '"' && !comment;
        comment = (comment || c == '#' && !quoted) && !ends_a_line(c);
        if !comment && !c.is_whitespace() && !ends_a_line(c) {
            end = place + c.len_utf8();
        }
    }
    end
}
