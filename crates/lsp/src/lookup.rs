//! What stands under the cursor, and where it is declared: in the text itself or in a file that it imports.

use super::source::{Source, uri_of};
use palmistry_lang::{Declaration, DeclarationKind, Reference, load};
use palmistry_math::expression::syntax::Span;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// What the cursor is on.
pub(super) enum Under<'s> {
    /// A name, of `a.b.c` as far as the cursor is.
    Name(&'s str, Span),
    /// What a claim restates, or an error follows from.
    Reference(&'s Reference),
    /// The id of a claim.
    Claim(&'s Declaration),
    /// The name of a file, in quotation marks.
    File(&'s str),
}

/// A declaration and the text that it stands in.
pub(super) struct Found {
    pub source: Rc<Source>,
    pub declaration: Declaration,
}

fn touches(span: &Span, at: usize) -> bool {
    span.start <= at && at <= span.end
}

/// Whether a place is in a comment, or in quotation marks.
enum Context {
    Code,
    Comment,
    Quoted,
}

fn context(text: &str, at: usize) -> Context {
    let mut found = Context::Code;
    for c in text[..at].chars() {
        found = match (found, c) {
            (Context::Code, '"') => Context::Quoted,
            (Context::Code, '#') => Context::Comment,
            (Context::Quoted, '"') | (Context::Comment, '\n') => Context::Code,
            (found, _) => found,
        };
    }
    found
}

/// Whether what follows this part of a text is neither in a comment nor in quotation marks.
pub(super) fn is_code(before: &str) -> bool {
    matches!(context(before, before.len()), Context::Code)
}

/// What stands at a byte of the plain text, or ends there.
pub(super) fn under(source: &Source, at: usize) -> Option<Under<'_>> {
    let (text, outline) = (&source.plain, &source.outline);
    if let Some(reference) = outline.references.iter().find(|reference| touches(&reference.span, at)) {
        return Some(Under::Reference(reference));
    }
    let is_claim = |one: &&Declaration| matches!(one.kind, DeclarationKind::Claim(_));
    if let Some(claim) = outline.declarations.iter().filter(is_claim).find(|one| touches(&one.span, at)) {
        return Some(Under::Claim(claim));
    }
    match context(text, at) {
        Context::Comment => return None,
        Context::Quoted => {
            let import = outline.imports.iter().find(|import| touches(&import.entry, at))?;
            return Some(Under::File(&import.path));
        }
        Context::Code => {}
    }
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
    let begin = at - text[..at].chars().rev().take_while(|c| is_part(*c)).count();
    // as far as the part of the name that the cursor is on
    let end = at + text[at..].chars().take_while(|c| is_part(*c) && *c != '.').count();
    let is_name =
        |name: &str| name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && !name.ends_with('.');
    // a component that is written with its number is one by itself
    let component = text[end..].strip_prefix('[').and_then(|rest| rest.split_once(']'));
    let number = component.map(|(number, _)| number).filter(|number| number.parse::<i64>().is_ok());
    let whole = end + number.map_or(0, |number| number.len() + 2);
    is_name(&text[begin..end]).then_some(Under::Name(&text[begin..whole], begin..whole))
}

/// The texts that are open, by the files that they are in; what is not open is read.
#[derive(Default)]
pub(super) struct Library {
    pub open: HashMap<PathBuf, Rc<Source>>,
}

/// Names of imports of imports beyond this are not looked for; the reader refuses such files.
const DEEPEST: usize = 16;

impl Library {
    /// The text of a file, as the editor has it where it is open.
    fn text(&self, path: &Path) -> Option<Rc<Source>> {
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if let Some(open) = self.open.get(&path) {
            return Some(open.clone());
        }
        let text = load(&path).ok()?;
        Some(Rc::new(Source::new(&uri_of(&path), Some(path), &text)))
    }

    /// The text of a file that another one names.
    pub fn beside(&self, source: &Source, file: &str) -> Option<Rc<Source>> {
        self.text(&source.folder().join(file))
    }

    /// What a name in a text stands for.
    pub fn find(&self, source: &Rc<Source>, name: &str) -> Vec<Found> {
        let mut met = HashSet::from([source.uri.clone()]);
        self.search(source, name, false, DEEPEST, &mut met)
    }

    fn search(
        &self,
        source: &Rc<Source>,
        name: &str,
        symbols_only: bool,
        deep: usize,
        met: &mut HashSet<String>,
    ) -> Vec<Found> {
        let is_symbol = |kind| {
            use DeclarationKind::{Parameter, Signal, State};
            matches!(kind, State | Parameter | Signal(_))
        };
        let found =
            |declaration: &Declaration| Found { source: source.clone(), declaration: declaration.clone() };
        let own: Vec<Found> = source
            .outline
            .named(name)
            .filter(|one| !symbols_only || is_symbol(one.kind))
            .map(found)
            .collect();
        if !own.is_empty() || deep == 0 {
            return own;
        }
        let imports = &source.outline.imports;
        if let Some((alias, rest)) = name.split_once('.') {
            let Some(import) = imports.iter().find(|import| import.alias == alias) else { return own };
            let Some(other) = self.beside(source, &import.path) else { return own };
            if rest == "output" {
                let outputs =
                    other.outline.declarations.iter().filter(|one| one.kind == DeclarationKind::Output);
                return outputs
                    .map(|one| Found { source: other.clone(), declaration: one.clone() })
                    .collect();
            }
            return self.search(&other, rest, false, deep - 1, met);
        }
        // symbols of one name are one, whichever of the files declares them
        for import in imports {
            let Some(other) = self.beside(source, &import.path) else { continue };
            if met.insert(other.uri.clone()) {
                let found = self.search(&other, name, true, deep - 1, met);
                if !found.is_empty() {
                    return found;
                }
            }
        }
        own
    }

    /// What a claim refers to: another entry, else a name.
    pub fn referred(&self, source: &Rc<Source>, reference: &Reference) -> Vec<Found> {
        let within = match &reference.file {
            None => Some(source.clone()),
            Some(file) => self.beside(source, file),
        };
        let Some(within) = within else { return Vec::new() };
        match within.outline.claim(&reference.name).cloned() {
            Some(declaration) => vec![Found { source: within, declaration }],
            None => self.find(&within, &reference.name),
        }
    }
}
