//! What needs no frame: a formula that is one run of symbols is text.

use super::piece::Piece;

/// The parts of a page, formulas of one run of symbols as `<i>`, which the page's style sets as mathematics. One letter alone stays: MathML slants it.
pub(super) fn without_frames(pieces: Vec<Piece<'_>>) -> Vec<Piece<'_>> {
    let mut found: Vec<Piece<'_>> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        found.push(piece);
        let [.., math, mi, text, end_mi, end_math] = found.as_slice() else { continue };
        let words = [math, mi, end_mi, end_math].map(Piece::text);
        let is_one = words == ["<math>", "<mi>", "</mi>", "</math>"];
        if is_one && matches!(text, Piece::Text(text) if text.chars().count() > 1) {
            let first = found.len() - 5;
            found.truncate(first + 3);
            found.remove(first);
            found[first] = Piece::Tag("<i>".into());
            found.push(Piece::Tag("</i>".into()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::piece::pieces;
    use super::*;

    fn without(html: &str) -> String {
        without_frames(pieces(html)).iter().map(Piece::text).collect()
    }

    #[test]
    fn one_run_of_symbols_is_text() {
        let row = "<div><math><mi>rank = 6</mi></math> where <math><mi>k</mi></math></div>";
        assert_eq!(without(row), "<div><i>rank = 6</i> where <math><mi>k</mi></math></div>");
        let two = "<math><mi>ab</mi><mo>=</mo></math>";
        assert_eq!(without(two), two);
    }
}
