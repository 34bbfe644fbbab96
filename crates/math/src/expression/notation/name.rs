//! How names look: Greek letters, indices, accents.

use super::{Accent, FormulaName};

/// The Greek letters that have a look of their own: name, letter, LaTeX.
const GREEK: [(&str, char, &str); 34] = [
    ("alpha", 'α', "\\alpha"),
    ("beta", 'β', "\\beta"),
    ("gamma", 'γ', "\\gamma"),
    ("delta", 'δ', "\\delta"),
    ("epsilon", 'ε', "\\varepsilon"),
    ("zeta", 'ζ', "\\zeta"),
    ("eta", 'η', "\\eta"),
    ("theta", 'θ', "\\theta"),
    ("iota", 'ι', "\\iota"),
    ("kappa", 'κ', "\\kappa"),
    ("lambda", 'λ', "\\lambda"),
    ("mu", 'μ', "\\mu"),
    ("nu", 'ν', "\\nu"),
    ("xi", 'ξ', "\\xi"),
    ("pi", 'π', "\\pi"),
    ("rho", 'ρ', "\\rho"),
    ("sigma", 'σ', "\\sigma"),
    ("tau", 'τ', "\\tau"),
    ("upsilon", 'υ', "\\upsilon"),
    ("phi", 'φ', "\\varphi"),
    ("chi", 'χ', "\\chi"),
    ("psi", 'ψ', "\\psi"),
    ("omega", 'ω', "\\omega"),
    ("Gamma", 'Γ', "\\Gamma"),
    ("Delta", 'Δ', "\\Delta"),
    ("Theta", 'Θ', "\\Theta"),
    ("Lambda", 'Λ', "\\Lambda"),
    ("Xi", 'Ξ', "\\Xi"),
    ("Pi", 'Π', "\\Pi"),
    ("Sigma", 'Σ', "\\Sigma"),
    ("Upsilon", 'Υ', "\\Upsilon"),
    ("Phi", 'Φ', "\\Phi"),
    ("Psi", 'Ψ', "\\Psi"),
    ("Omega", 'Ω', "\\Omega"),
];

/// The Greek letter of a name and its LaTeX.
pub(super) fn greek(letters: &str) -> Option<(char, &'static str)> {
    GREEK.iter().find(|(name, _, _)| *name == letters).map(|(_, letter, latex)| (*letter, *latex))
}

/// A letter in the slanted alphabet of mathematics (Unicode, Mathematical Alphanumeric Symbols): what MathML makes of a single
/// letter by itself, for places where more stands beside it.
fn slanted(letter: char) -> Option<char> {
    let (first, alphabet) = match letter {
        // the one letter that had a place already
        'h' => return Some('\u{210e}'),
        'A'..='Z' => ('A', 0x1d434),
        'a'..='z' => ('a', 0x1d44e),
        'Α'..='Ω' => ('Α', 0x1d6e2),
        'α'..='ω' => ('α', 0x1d6fc),
        _ => return None,
    };
    char::from_u32(alphabet + (u32::from(letter) - u32::from(first)))
}

/// Digits below the line; none where something else stands among them.
fn lowered(digits: &str) -> Option<String> {
    digits.chars().map(|c| char::from_u32(0x2080 + c.to_digit(10)?)).collect()
}

impl Accent {
    /// The accent that the last part of a name says.
    fn of(part: &str) -> Option<Accent> {
        Some(match part {
            "dot" => Accent::Dot,
            "ddot" => Accent::TwoDots,
            "tilde" => Accent::Tilde,
            "bar" => Accent::Bar,
            "hat" => Accent::Hat,
            _ => return None,
        })
    }

    pub(super) fn latex(self) -> &'static str {
        match self {
            Accent::Dot => "\\dot",
            Accent::TwoDots => "\\ddot",
            Accent::Tilde => "\\tilde",
            Accent::Bar => "\\bar",
            Accent::Hat => "\\hat",
        }
    }

    pub(super) fn character(self) -> char {
        match self {
            Accent::Dot => '˙',
            Accent::TwoDots => '¨',
            Accent::Tilde => '~',
            Accent::Bar => '¯',
            Accent::Hat => '^',
        }
    }
}

impl FormulaName {
    /// The look of a name as it is written; none for one that has no parts, such as `_2` and `a__b`.
    pub fn of(text: &str) -> Option<FormulaName> {
        let (text, component) = match text.strip_suffix(']').and_then(|text| text.split_once('[')) {
            Some((vector, component)) => (vector, Some(component)),
            None => (text, None),
        };
        let mut from: Vec<String> = text.split('.').map(str::to_owned).collect();
        let own = from.pop()?;
        let mut parts = own.split('_');
        let first = parts.next()?;
        let end = first.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(first.len());
        let (letters, rest) = first.split_at(end);
        let mut name =
            FormulaName { from, letters: letters.to_owned(), index: Vec::new(), accents: Vec::new() };
        if letters.is_empty() {
            return None;
        }
        if !rest.is_empty() {
            name.index.push(rest.to_owned());
        }
        for part in parts {
            match Accent::of(part) {
                _ if part.is_empty() => return None,
                Some(accent) => name.accents.push(accent),
                None => name.index.push(part.to_owned()),
            }
        }
        name.index.extend(component.map(str::to_owned));
        Some(name)
    }

    /// A letter without accents and the digits of its index as one symbol: `𝜔₀`.
    pub(super) fn symbol(&self) -> Option<String> {
        let mut letters = self.letters.chars();
        let letter = match (greek(&self.letters), letters.next(), letters.next()) {
            (Some((letter, _)), _, _) => letter,
            (None, Some(letter), None) => letter,
            _ => return None,
        };
        match &self.index[..] {
            [index] if self.accents.is_empty() => Some(format!("{}{}", slanted(letter)?, lowered(index)?)),
            _ => None,
        }
    }

    /// Whether its letters are more than one, so that they stand upright and need room.
    pub(super) fn is_wide(&self) -> bool {
        !self.from.is_empty() || (self.letters.len() > 1 && greek(&self.letters).is_none())
    }
}

/// A name in letters alone, for places that hold no formula, such as the axis of a picture: `ω₀` for `omega0`. What has accents
/// or an index of letters stays as it is written.
pub fn in_letters(text: &str) -> String {
    let plain = |name: &FormulaName| name.accents.is_empty() && name.from.is_empty() && name.index.len() < 2;
    let Some(name) = FormulaName::of(text).filter(plain) else { return text.to_owned() };
    let index = name.index.first().map_or("", String::as_str);
    match (greek(&name.letters), lowered(index)) {
        (Some((letter, _)), Some(below)) => format!("{letter}{below}"),
        (None, Some(below)) if name.letters.len() == 1 => format!("{}{below}", name.letters),
        _ => text.to_owned(),
    }
}

/// A part of an index, cut into runs of digits and of letters.
pub(super) fn runs(part: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut begin = 0;
    for (place, pair) in part.as_bytes().windows(2).enumerate() {
        if pair[0].is_ascii_digit() != pair[1].is_ascii_digit() {
            found.push(&part[begin..=place]);
            begin = place + 1;
        }
    }
    found.push(&part[begin..]);
    found
}
