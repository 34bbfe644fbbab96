//! Elements of an SBML file by their names, whatever the prefix, with their places.

use super::super::expression::Span;
use crate::system::Problem;
use roxmltree::{Document, Node, ParsingOptions};

/// More elements within elements than this are refused.
const DEEPEST_ELEMENT: usize = 400;

/// Reads the elements of a text.
///
/// # Errors
/// Where it is no XML that is well formed, or nested too deeply.
pub(super) fn document(text: &str) -> Result<Document<'_>, Problem> {
    // what counts its brackets itself needs no stack for them
    if let Some(at) = too_deep(text) {
        return Err(
            Problem::new(&(at..at + 1), "elements are nested too deeply", "here").help("this is no model")
        );
    }
    let options = ParsingOptions { nodes_limit: 2_000_000, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|why| {
        let place = why.pos();
        let line = text
            .split_inclusive('\n')
            .take(place.row.saturating_sub(1) as usize)
            .map(str::len)
            .sum::<usize>();
        let rest = text.get(line..).unwrap_or_default();
        let column: usize = rest.chars().take(place.col.saturating_sub(1) as usize).map(char::len_utf8).sum();
        let at = (line + column).min(text.len());
        Problem::new(
            &(at..(at + 1).min(text.len())),
            format!("this is no XML that can be read: {why}"),
            "here",
        )
        .help("SBML is XML; export the model again")
    })
}

/// Where elements are nested deeper than is meant, by their brackets alone.
fn too_deep(text: &str) -> Option<usize> {
    let (mut depth, bytes) = (0_usize, text.as_bytes());
    for (at, pair) in bytes.windows(2).enumerate() {
        match pair {
            [b'<', b'/'] => depth = depth.saturating_sub(1),
            [b'/', b'>'] => depth = depth.saturating_sub(1),
            [b'<', next] if next.is_ascii_alphabetic() || *next == b'_' => {
                depth += 1;
                if depth > DEEPEST_ELEMENT {
                    return Some(at);
                }
            }
            _ => {}
        }
    }
    None
}

/// Where an element begins: its first tag.
pub(super) fn place(node: Node<'_, '_>) -> Span {
    let range = node.range();
    let text = &node.document().input_text()[range.clone()];
    range.start..range.start + text.find('>').map_or(text.len(), |end| end + 1)
}

pub(super) fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

pub(super) fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| is(*child, name))
}

pub(super) fn elements<'a, 'b>(node: Node<'a, 'b>) -> impl Iterator<Item = Node<'a, 'b>> {
    node.children().filter(|child| child.is_element())
}

/// The elements of a list that the model has, or none.
pub(super) fn listed<'a, 'b>(node: Node<'a, 'b>, list: &str) -> Vec<Node<'a, 'b>> {
    child(node, list)
        .map(|list| elements(list).filter(|one| !is(*one, "annotation") && !is(*one, "notes")).collect())
        .unwrap_or_default()
}

/// An attribute that has to be there.
pub(super) fn required<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, Problem> {
    node.attribute(name).map(str::trim).filter(|value| !value.is_empty()).ok_or_else(|| {
        Problem::new(&place(node), format!("'{}' has no {name}", node.tag_name().name()), "this element")
            .help(format!("SBML asks for {name}=\"...\" here"))
    })
}

/// Whether an attribute says true.
pub(super) fn says(node: Node<'_, '_>, name: &str, where_left_out: bool) -> bool {
    node.attribute(name).map_or(where_left_out, |value| matches!(value.trim(), "true" | "1"))
}
