//! How the shapes of pictures look, said once for the whole page: attributes that repeat are a class.

use super::piece::Piece;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Attributes of SVG that a style can say as well.
const LOOKS: [&str; 7] =
    ["fill", "stroke", "stroke-width", "stroke-linecap", "font-size", "text-anchor", "shape-rendering"];
/// What is rarer has no class.
const OFTEN: usize = 4;

/// The parts of a page with classes, and the rules for these.
pub(super) fn with_shared_looks(mut pieces: Vec<Piece<'_>>) -> (Vec<Piece<'_>>, String) {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for piece in &pieces {
        if let Some((_, look)) = taken_apart(piece) {
            *counts.entry(look).or_default() += 1;
        }
    }
    let mut often: Vec<(String, usize)> = counts.into_iter().filter(|(_, count)| *count >= OFTEN).collect();
    often.sort_by_key(|(look, count)| (std::cmp::Reverse(*count), look.clone()));
    let names: BTreeMap<&str, String> =
        often.iter().enumerate().map(|(place, (look, _))| (look.as_str(), format!("z{place}"))).collect();
    for piece in &mut pieces {
        if let Some((rest, look)) = taken_apart(piece)
            && let Some(name) = names.get(look.as_str())
        {
            let (tag, attributes) = rest.split_once(' ').unwrap_or((rest.trim_end_matches('>'), ">"));
            let space = if attributes.starts_with(['>', '/']) { "" } else { " " };
            *piece = Piece::Tag(format!("{tag} class=\"{name}\"{space}{attributes}").into());
        }
    }
    let rules = often.iter().fold(String::new(), |mut rules, (look, _)| {
        let _ = write!(rules, ".{}{{{look}}}", names[look.as_str()]);
        rules
    });
    (pieces, rules)
}

/// A shape's tag without its looks, and these as the content of a rule; nothing if it has none, or a class already.
fn taken_apart(piece: &Piece<'_>) -> Option<(String, String)> {
    let Piece::Tag(tag) = piece else { return None };
    if !["<path ", "<g ", "<text "].iter().any(|start| tag.starts_with(start)) || tag.contains(" class=") {
        return None;
    }
    let (mut rest, mut look) = (String::new(), String::new());
    let mut parts = tag.split('"');
    while let Some(before) = parts.next() {
        let Some(value) = parts.next() else {
            rest.push_str(before);
            break;
        };
        let name = before.trim_start().trim_end_matches('=').rsplit(' ').next().unwrap_or_default();
        match LOOKS.contains(&name) {
            true => {
                rest.push_str(before.strip_suffix(&format!(" {name}="))?);
                let unit = if name == "font-size" { "px" } else { "" };
                let _ = write!(look, "{name}:{value}{unit};");
            }
            false => {
                let _ = write!(rest, "{before}\"{value}\"");
            }
        }
    }
    (!look.is_empty()).then_some((rest, look))
}

#[cfg(test)]
mod tests {
    use super::super::compact;

    /// By hand: what is often is said in the style, what is rare where it is.
    #[test]
    fn what_repeats_is_a_class() {
        let shape = r#"<path fill="none" stroke="red" d="M0 0h1"/>"#;
        let page = format!("<style>a{{}}</style>{}<path fill=\"blue\" d=\"M0 0h1\"/>", shape.repeat(4));
        let expected = format!(
            "<style>a{{}}.z0{{fill:none;stroke:red;}}</style>{}<path fill=blue d=\"M0 0h1\"/>",
            r#"<path class=z0 d="M0 0h1"/>"#.repeat(4)
        );
        assert_eq!(compact(&page), expected);
        let words = r#"<g fill="currentColor" font-size="12">"#.repeat(4);
        assert!(compact(&format!("<style></style>{words}")).ends_with(&"<g class=z0>".repeat(4)));
    }
}
