//! HTML as tags and the texts between them.

use std::borrow::Cow;

/// A part of a page.
#[derive(Debug, PartialEq)]
pub(super) enum Piece<'a> {
    /// With its brackets.
    Tag(Cow<'a, str>),
    Text(Cow<'a, str>),
    /// The content of a script or a style.
    Raw(&'a str),
}

impl Piece<'_> {
    /// As it is written.
    pub fn text(&self) -> &str {
        match self {
            Piece::Tag(text) | Piece::Text(text) => text,
            Piece::Raw(text) => text,
        }
    }
}

/// The parts of a page, in order.
pub(super) fn pieces(html: &str) -> Vec<Piece<'_>> {
    let mut found = Vec::new();
    let mut rest = html;
    while !rest.is_empty() {
        let Some(start) = rest.find('<') else {
            found.push(Piece::Text(rest.into()));
            break;
        };
        let (text, from_tag) = rest.split_at(start);
        if !text.is_empty() {
            found.push(Piece::Text(text.into()));
        }
        let (tag, after) = from_tag.split_at(tag_end(from_tag));
        found.push(Piece::Tag(tag.into()));
        rest = after;
        for (name, end) in [("<script", "</script"), ("<style", "</style")] {
            if tag.starts_with(name) {
                let (raw, after) = rest.split_at(rest.find(end).unwrap_or(rest.len()));
                found.push(Piece::Raw(raw));
                rest = after;
            }
        }
    }
    found
}

/// The length of the tag at the head of a text; a bracket within quotes ends none.
fn tag_end(text: &str) -> usize {
    let mut is_quoted = false;
    for (place, c) in text.char_indices() {
        match c {
            '"' => is_quoted = !is_quoted,
            '>' if !is_quoted => return place + 1,
            _ => {}
        }
    }
    text.len()
}
