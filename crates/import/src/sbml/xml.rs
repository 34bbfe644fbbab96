//! Elements of an SBML file by their names, whatever the prefix, with their places.

use super::super::expression::Span;
use super::super::too_much;
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use roxmltree::{Document, Node, ParsingOptions};

/// More elements within elements than this are refused.
const DEEPEST_ELEMENT: usize = 400;

/// More attributes than these has no element.
const MOST_ATTRIBUTES: usize = 256;

/// Reads the elements of a text.
///
/// # Errors
/// Where it is no XML that is well formed, or nested too deeply.
pub(super) fn document<'t>(text: &'t str, budget: &Budget) -> Result<Document<'t>, Problem> {
    // what counts its brackets itself needs no stack for them
    if let Some(at) = too_deep(text) {
        return Err(Problem::new(Code::ForeignText, &(at..at + 1), "elements are nested too deeply", "here")
            .help("this is no model"));
    }
    look_at_attributes(text, budget)?;
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
            Code::ForeignText,
            &(at..(at + 1).min(text.len())),
            format!("this is no XML that can be read: {why}"),
            "here",
        )
        .help("SBML is XML; export the model again")
    })
}

/// Pays for what a reader of XML does with attributes: each of an element is compared with all others of it, and each element that
/// declares prefixes takes over all that are declared around it.
///
/// # Errors
/// At an element with more than anybody writes, or where all of them together are too many.
fn look_at_attributes(text: &str, budget: &Budget) -> Result<(), Problem> {
    let (bytes, mut at) = (text.as_bytes(), 0);
    // how many prefixes are declared around each element that is open
    let mut around: Vec<usize> = vec![0];
    while let Some(begin) = text[at..].find('<').map(|place| at + place) {
        let rest = &text[begin..];
        // what is no element ends by itself
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find(|(open, _)| rest.starts_with(open))
            .map(|(_, close)| rest.find(close).map_or(text.len(), |end| begin + end + close.len()));
        if let Some(end) = skipped {
            at = end;
            continue;
        }
        let (mut quote, mut count, mut prefixes, mut end) = (None, 0_usize, 0_usize, begin + 1);
        while let Some(byte) = bytes.get(end) {
            match (quote, byte) {
                (Some(open), _) if open == *byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(*byte),
                (None, b'>' | b'<') => break,
                (None, b'=') => count += 1,
                (None, b'x') if text[end..].starts_with("xmlns") => prefixes += 1,
                _ => {}
            }
            end += 1;
        }
        let all = |most: usize, what: &str| {
            Problem::new(
                Code::ForeignText,
                &(begin..begin + 1),
                format!("an element with more than {most} {what}"),
                "this element",
            )
            .help("this is no model that a program has written")
        };
        if count > MOST_ATTRIBUTES {
            return Err(all(MOST_ATTRIBUTES, "attributes"));
        }
        let declared = around.last().copied().unwrap_or(0) + prefixes;
        if rest.starts_with("</") {
            around.pop();
        } else if !text[..end].ends_with('/') && !rest.starts_with("<!") {
            around.push(declared);
        }
        let copied = if prefixes > 0 { declared } else { 0 };
        budget.steps(1 + count * count + copied).map_err(|spent| too_much(&(begin..begin + 1), spent))?;
        at = end.max(begin + 1);
    }
    Ok(())
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
        Problem::new(
            Code::ForeignText,
            &place(node),
            format!("'{}' has no {name}", node.tag_name().name()),
            "this element",
        )
        .help(format!("SBML asks for {name}=\"...\" here"))
    })
}

/// Whether an attribute says true.
pub(super) fn says(node: Node<'_, '_>, name: &str, where_left_out: bool) -> bool {
    node.attribute(name).map_or(where_left_out, |value| matches!(value.trim(), "true" | "1"))
}
