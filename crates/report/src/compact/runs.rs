//! Symbols that stand beside each other on one line of a formula as one element: `a + b` has nothing over or under it, and takes
//! one element instead of three. What has parts above each other (fractions, powers, matrices) keeps its elements.

use super::piece::Piece;

/// Elements whose parts stand beside each other; elsewhere each part has its own place, as base and exponent.
const ROWS: [&str; 4] = ["math", "mrow", "mtd", "msqrt"];

/// A symbol of a formula.
enum Leaf {
    /// A name, a number, or what was put together from such.
    Operand(String),
    Sign(String),
    /// A minus that is known to stand before its operand only.
    Minus,
    /// What nothing is joined to.
    Alone(String),
}

const MINUS: &str = "<mo form=\"prefix\">";
const LEAVES: [&str; 5] = ["<mi>", "<mn>", "<mtext>", "<mo>", MINUS];

impl Leaf {
    fn of(tag: &str, text: &str) -> Leaf {
        match (tag, slanted(text)) {
            (MINUS, _) => Leaf::Minus,
            ("<mo>", _) => Leaf::Sign(text.to_owned()),
            ("<mi>", Some(text)) => Leaf::Operand(text),
            ("<mi>", None) => Leaf::Alone(text.to_owned()),
            _ => Leaf::Operand(text.to_owned()),
        }
    }

    /// Its tag and its text.
    fn written(self) -> (&'static str, String) {
        match self {
            Leaf::Operand(text)
                if text.starts_with(|c: char| c.is_ascii_digit()) && text.parse::<f64>().is_ok() =>
            {
                ("<mn>", text)
            }
            // a letter that stands upright: in an element for names it would be slanted
            Leaf::Operand(text) if slanted(&text).as_ref() != Some(&text) => ("<mtext>", text),
            Leaf::Operand(text) | Leaf::Alone(text) => ("<mi>", text),
            Leaf::Sign(text) => ("<mo>", text),
            Leaf::Minus => (MINUS, "−".to_owned()),
        }
    }
}

/// The parts of a page with the runs of their formulas joined.
pub(super) fn joined(pieces: Vec<Piece<'_>>) -> Vec<Piece<'_>> {
    let mut found: Vec<Piece<'_>> = Vec::with_capacity(pieces.len());
    let mut open: Vec<String> = Vec::new();
    let mut run: Vec<Leaf> = Vec::new();
    let mut pieces = pieces.into_iter().peekable();
    while let Some(piece) = pieces.next() {
        let Piece::Tag(tag) = &piece else {
            found.push(piece);
            continue;
        };
        let is_in_row = |open: &[String]| open.last().is_some_and(|parent| ROWS.contains(&parent.as_str()));
        if is_in_row(&open) && LEAVES.contains(&tag.as_ref()) {
            let text = match pieces.next_if(|next| matches!(next, Piece::Text(_))) {
                Some(Piece::Text(text)) => text.into_owned(),
                _ => String::new(),
            };
            pieces.next();
            run.push(Leaf::of(tag, &text));
            continue;
        }
        finish(&mut run, &mut found);
        let name = tag.trim_matches(['<', '>', '/']).split(' ').next().unwrap_or_default().to_owned();
        let is_end = tag.starts_with("</");
        match (is_end, open.is_empty()) {
            (false, true) if name == "math" => open.push(name),
            (false, false) if !tag.ends_with("/>") => open.push(name),
            (true, false) => {
                open.pop();
            }
            _ => {}
        }
        let is_row = tag == "</mrow>";
        found.push(piece);
        if is_row && let Some(text) = on_one_line(&mut found) {
            run.push(Leaf::Operand(text));
            match is_in_row(&open) {
                true => take_back(&mut run, &mut found),
                false => finish(&mut run, &mut found),
            }
        }
    }
    found
}

/// The text of the row that has just ended, if it is one symbol or a matrix of one line of such; the row is taken away then.
fn on_one_line(found: &mut Vec<Piece<'_>>) -> Option<String> {
    let start = found.iter().rposition(|piece| matches!(piece, Piece::Tag(tag) if tag == "<mrow>"))?;
    let words: Vec<&str> = found[start..].iter().map(Piece::text).collect();
    let is_symbol = |open: &str, close: &str| matches!((open, close), ("<mi>", "</mi>") | ("<mn>", "</mn>"));
    let text = match words.as_slice() {
        ["<mrow>", open, text, close, "</mrow>"] if is_symbol(open, close) => (*text).to_owned(),
        [
            "<mrow>",
            "<mo>",
            "[",
            "</mo>",
            "<mtable>",
            "<mtr>",
            cells @ ..,
            "</mtr>",
            "</mtable>",
            "<mo>",
            "]",
            "</mo>",
            "</mrow>",
        ] => {
            let mut texts = Vec::new();
            for cell in cells.chunks(5) {
                match cell {
                    ["<mtd>", open, text, close, "</mtd>"] if is_symbol(open, close) => texts.push(*text),
                    _ => return None,
                }
            }
            format!("[{}]", texts.join("\u{2002}"))
        }
        _ => return None,
    };
    let text = slanted(&text)?;
    found.truncate(start);
    Some(text)
}

/// Symbols that were written already, and beside which there is another one now.
fn take_back(run: &mut Vec<Leaf>, found: &mut Vec<Piece<'_>>) {
    while let [.., open, text, close] = found.as_slice()
        && ["</mi>", "</mn>", "</mo>", "</mtext>"].contains(&close.text())
        && LEAVES.contains(&open.text())
    {
        run.insert(0, Leaf::of(open.text(), text.text()));
        found.truncate(found.len() - 3);
    }
}

/// Writes a run.
fn finish(run: &mut Vec<Leaf>, found: &mut Vec<Piece<'_>>) {
    let begins = matches!(found.last(), Some(Piece::Tag(tag)) if !tag.starts_with("</"));
    let mut stack: Vec<Leaf> = Vec::new();
    for leaf in run.drain(..) {
        stack.push(leaf);
        reduce(&mut stack, begins);
    }
    for leaf in stack {
        let (tag, text) = leaf.written();
        found.push(Piece::Tag(tag.into()));
        found.push(Piece::Text(text.into()));
        let name = tag[1..].split([' ', '>']).next().unwrap_or_default();
        found.push(Piece::Tag(format!("</{name}>").into()));
    }
}

/// Puts together what stands at the end of a row, as far as it goes. `begins`: nothing stands before the row.
fn reduce(stack: &mut Vec<Leaf>, begins: bool) {
    loop {
        let joined = match stack.as_slice() {
            [.., Leaf::Operand(a), Leaf::Operand(b)] => Some((2, format!("{a}{b}"))),
            [.., Leaf::Minus, Leaf::Operand(a)] => Some((2, format!("−{a}"))),
            [.., Leaf::Sign(open), Leaf::Operand(a), Leaf::Sign(close)] if open == "(" && close == ")" => {
                Some((3, format!("({a})")))
            }
            [.., Leaf::Operand(a), Leaf::Sign(sign), Leaf::Operand(b)] => {
                spaced(sign).map(|sign| (3, format!("{a}{sign}{b}")))
            }
            [before @ .., Leaf::Sign(sign), Leaf::Operand(a)] if sign == "−" => {
                let is_prefix = match before.last() {
                    None => begins,
                    Some(Leaf::Sign(before)) => before == "(" || before == "=",
                    Some(_) => false,
                };
                is_prefix.then(|| (2, format!("−{a}")))
            }
            _ => None,
        };
        let Some((count, text)) = joined else { return };
        stack.truncate(stack.len() - count);
        stack.push(Leaf::Operand(text));
    }
}

/// A sign between two operands with the spaces that it has there.
fn spaced(sign: &str) -> Option<String> {
    Some(match sign {
        "+" | "−" | "·" | "×" => format!("\u{205f}{sign}\u{205f}"),
        "=" | "≠" | "≤" | "≥" | "&lt;" | "&gt;" => format!("\u{2005}{sign}\u{2005}"),
        "," => ",\u{2009}".to_owned(),
        _ => return None,
    })
}

/// A name as it looks: a single letter is slanted by itself and has to be slanted in a run. Nothing where there is no such letter.
fn slanted(name: &str) -> Option<String> {
    let mut letters = name.chars();
    let (Some(letter), None) = (letters.next(), letters.next()) else { return Some(name.to_owned()) };
    let moved = |first: char, to: u32| char::from_u32(to + (letter as u32 - first as u32));
    let found = match letter {
        'h' => Some('ℎ'),
        'a'..='z' => moved('a', 0x1d44e),
        'A'..='Z' => moved('A', 0x1d434),
        'α'..='ω' => moved('α', 0x1d6fc),
        'Α'..='Ω' => moved('Α', 0x1d6e2),
        other => (!other.is_alphabetic() || (other as u32) >= 0x1d400).then_some(other),
    };
    found.map(String::from)
}

#[cfg(test)]
mod tests {
    use super::super::compact;

    /// By hand: what is on one line is one element; base and exponent, and what is beside a fraction, keep theirs.
    #[test]
    fn a_run_of_symbols_is_one_element() {
        assert_eq!(
            compact("<math><mi>𝑎</mi><mo>+</mo><mi>b</mi><mo>=</mo><mn>0</mn></math>"),
            "<math><mi>𝑎\u{205f}+\u{205f}𝑏\u{2005}=\u{2005}0</mi></math>"
        );
        let power = "<math><msup><mi>x</mi><mn>2</mn></msup></math>";
        assert_eq!(compact(power), power);
        assert_eq!(
            compact("<math><mfrac><mn>1</mn><mi>x</mi></mfrac><mo>−</mo><mi>x</mi><mi>y</mi></math>"),
            "<math><mfrac><mn>1</mn><mi>x</mi></mfrac><mo>−</mo><mi>𝑥𝑦</mi></math>"
        );
        assert_eq!(
            compact("<math><mo>−</mo><mn>2</mn><mo>(</mo><mi>x</mi><mo>−</mo><mi>ρ</mi><mo>)</mo></math>"),
            "<math><mi>−2(𝑥\u{205f}−\u{205f}𝜌)</mi></math>"
        );
        assert_eq!(
            compact("<math><mn>3</mn></math> <math><mi>x</mi></math>"),
            "<math><mn>3</mn></math> <math><mi>𝑥</mi></math>"
        );
    }

    /// By hand: a matrix of one row is on one line, and so is a numerator; a letter that stands upright stays so.
    #[test]
    fn rows_that_are_on_one_line_are_symbols() {
        let row = "<math><mi>d</mi><mo>=</mo><mrow><mo>[</mo><mtable><mtr><mtd><mn>0</mn></mtd><mtd><mi>x</mi></mtd></mtr></mtable>\
                   <mo>]</mo></mrow></math>";
        assert_eq!(compact(row), "<math><mi>𝑑\u{2005}=\u{2005}[0\u{2002}𝑥]</mi></math>");
        let half = "<math><mfrac><mrow><mi>a</mi><mo>+</mo><mo form=\"prefix\">−</mo><mn>1</mn></mrow><mn>2</mn></mfrac></math>";
        assert_eq!(compact(half), "<math><mfrac><mi>𝑎\u{205f}+\u{205f}−1</mi><mn>2</mn></mfrac></math>");
        let differential = "<math><mtext>d</mtext><mi>x</mi></math> <math><mtext>d</mtext></math>";
        assert_eq!(compact(differential), "<math><mi>d𝑥</mi></math> <math><mtext>d</mtext></math>");
    }

    /// A sum before a product: signs bind as they are written, since nothing is moved.
    #[test]
    fn nothing_changes_its_place() {
        let text = |html: &str| html.split(['<', '>']).skip(2).step_by(2).collect::<String>();
        let long = "<math><mi>a</mi><mo>−</mo><mo>(</mo><mo>−</mo><mi>b</mi><mo>)</mo><mo>·</mo><mi>c</mi><mo>∈</mo><mi>d</mi></math>";
        let plain = text(&compact(long)).replace(['\u{205f}', '\u{2005}', '\u{2009}'], "");
        assert_eq!(plain, "𝑎−(−𝑏)·𝑐∈𝑑");
    }

    /// What is written, without spaces, and letters as they are on a keyboard.
    fn bare(html: &str) -> String {
        let plain = |c: char| {
            let from = |first: char, moved: u32| char::from_u32(c as u32 - moved + first as u32);
            match c as u32 {
                0x210e => Some('h'),
                0x1d434..0x1d44e => from('A', 0x1d434),
                0x1d44e..0x1d468 => from('a', 0x1d44e),
                0x1d6e2..=0x1d6fa => from('Α', 0x1d6e2),
                0x1d6fc..=0x1d714 => from('α', 0x1d6fc),
                _ => Some(c),
            }
        };
        let mut is_tag = false;
        let mut found = String::new();
        for c in html.chars() {
            match c {
                '<' => is_tag = true,
                '>' => is_tag = false,
                c if !is_tag && !c.is_whitespace() => found.extend(plain(c)),
                _ => {}
            }
        }
        found
    }

    /// On the statements of all shipped files: every symbol stays, in its order, and what stands above or below something stays
    /// there; the formula as it was is the witness.
    #[test]
    fn no_formula_says_anything_else() {
        let papers = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../proofs");
        let folders = std::fs::read_dir(papers).unwrap().map(|folder| folder.unwrap().path());
        let files =
            folders.flat_map(|folder| std::fs::read_dir(folder).unwrap()).map(|file| file.unwrap().path());
        let (mut formulas, mut before, mut after) = (0, 0, 0);
        for file in files.filter(|file| file.extension().is_some_and(|extension| extension == "proof")) {
            let system = palmistry_lang::System::read(&file).unwrap();
            for statement in system.claims.iter().flat_map(|claim| claim.body.statements()) {
                let text = &system.source[statement.span.clone()];
                let long = crate::formula_mathml(text).unwrap();
                let short = compact(&long);
                assert_eq!(bare(&short), bare(&long), "{text}");
                for kept in ["<mfrac", "<msub", "<msup", "<mover", "<math"] {
                    assert_eq!(short.matches(kept).count(), long.matches(kept).count(), "{kept} in {text}");
                }
                assert_eq!(short.matches("</").count() * 2, short.matches('<').count(), "{short}");
                (formulas, before, after) = (formulas + 1, before + long.len(), after + short.len());
            }
        }
        assert!(formulas > 900 && 10 * after < 9 * before, "{formulas}: {after} of {before} bytes");
    }
}
