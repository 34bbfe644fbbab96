//! A page in few bytes: what a browser shows in the same way is written in the shorter way. Knows HTML, MathML and SVG as this
//! program writes them, and nothing of what they say.

mod looks;
mod piece;
mod runs;
mod symbols;

use looks::with_shared_looks;
use piece::{Piece, pieces};
use runs::joined;
use symbols::without_frames;

/// The same page, shorter: looks of pictures that repeat are classes, runs of symbols on one line are one element, and quotes and
/// end tags that HTML does not ask for are left out.
pub(super) fn compact(html: &str) -> String {
    let joined = joined(pieces(html));
    // how text looks that is mathematics says the page's style
    let framed = if html.contains("</style>") { without_frames(joined) } else { joined };
    let (pieces, rules) = with_shared_looks(framed);
    let mut out = String::with_capacity(html.len());
    for (place, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Tag(tag) if is_implied(tag, pieces.get(place + 1)) => {}
            Piece::Tag(tag) => out.push_str(&without_quotes(tag)),
            _ => out.push_str(piece.text()),
        }
    }
    out.replacen("</style>", &format!("{rules}</style>"), 1)
}

/// Whether an end tag may be left out before what follows (HTML, section "Optional tags").
fn is_implied(tag: &str, next: Option<&Piece<'_>>) -> bool {
    const AFTER_P: [&str; 23] = [
        "p", "div", "ul", "ol", "table", "h1", "h2", "h3", "h4", "section", "details", "figure", "form",
        "pre", "article", "/div", "/article", "/section", "/details", "/td", "/figure", "/main", "/header",
    ];
    let Some(Piece::Tag(next)) = next else { return false };
    let next = next[1..].split([' ', '>']).next().unwrap_or_default();
    match tag {
        "</p>" => AFTER_P.contains(&next),
        "</li>" => ["li", "/ol", "/ul"].contains(&next),
        "</td>" | "</th>" => ["td", "th", "/tr"].contains(&next),
        "</tr>" => ["tr", "/tbody", "/thead"].contains(&next),
        "</option>" => ["option", "/select"].contains(&next),
        _ => false,
    }
}

/// A tag whose values have quotes only where they need them.
fn without_quotes(tag: &str) -> String {
    let parts: Vec<&str> = tag.split('"').collect();
    let mut out = String::with_capacity(tag.len());
    for (place, part) in parts.iter().enumerate() {
        // every other part is a value; a slash behind it would belong to it
        let is_plain = !part.is_empty()
            && !part.contains(|c: char| c.is_whitespace() || "'=<>`".contains(c))
            && parts.get(place + 1).is_some_and(|behind| !behind.starts_with('/'));
        match place % 2 == 0 || is_plain {
            true => out.push_str(part),
            false => out.extend(["\"", part, "\""]),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page without anything, a tag that never ends, a row that never does.
    #[test]
    fn what_is_no_page_stays_what_it_is() {
        for text in ["", "plain", "<p", "<math><mrow>", "<math><mi>", "</mrow>", "<style>", "<math></math>"] {
            assert!(compact(text).len() <= text.len() + "</mi>".len(), "{text}");
        }
        assert_eq!(compact("plain <b>a</b>"), "plain <b>a</b>");
    }

    /// By hand: what needs its quotes keeps them, and an end tag goes only where HTML implies it.
    #[test]
    fn quotes_and_end_tags_go_where_nothing_needs_them() {
        assert_eq!(
            compact(r##"<p class="a b" id="x"><a href="#y">1</a></p><p>2</p> <p>3</p></div>"##),
            r##"<p class="a b" id=x><a href=#y>1</a><p>2</p> <p>3</div>"##
        );
        assert_eq!(compact("<ol><li>a</li><li>b</li></ol>"), "<ol><li>a<li>b</ol>");
        assert_eq!(compact(r#"<input value="" hidden>"#), r#"<input value="" hidden>"#);
        assert_eq!(
            compact(r#"<svg id="a"><path x="1" d="M0"/></svg>"#),
            r#"<svg id=a><path x=1 d="M0"/></svg>"#
        );
        assert_eq!(
            compact(r#"<script id="s">a["b"] = "<p></p><p>"</script>"#),
            r#"<script id=s>a["b"] = "<p></p><p>"</script>"#
        );
    }
}
