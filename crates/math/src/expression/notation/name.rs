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

/// Indices that people write out.
const INDICES: [&str; 19] = [
    "max", "min", "in", "out", "ref", "eq", "tot", "cat", "sat", "crit", "obs", "off", "on", "rel", "env",
    "act", "des", "est", "rr",
];

/// Two letters that are a word or a difference, and no letter with an index.
const NO_INDEX: [&str; 12] = ["dt", "dx", "dy", "dz", "ds", "dq", "du", "dv", "go", "no", "of", "to"];

/// Where the index of a name begins whose letter and index are written in one, as people write `ia`, `Lq`, `Fyf`, `alphaf`, `Vmax`. A rule
/// of thumb: a word is no letter with an index, and where it is taken for one a file may say how the name looks.
fn index_within(letters: &str) -> Option<usize> {
    let consonants = |text: &str| !text.chars().any(|c| "aeiouAEIOU".contains(c));
    if greek(letters).is_some() || NO_INDEX.contains(&letters) {
        return None;
    }
    let begins = |name: &&str| letters.len() > name.len() && letters.starts_with(*name);
    let names = GREEK.iter().map(|(name, _, _)| *name).filter(begins);
    if let Some(name) = names.max_by_key(|name| name.len()) {
        let index = &letters[name.len()..];
        let is_one = INDICES.contains(&index)
            || name.len() > 2 && index.len() < 4 && (index.len() == 1 || consonants(index));
        if is_one || name.len() == 2 && name != "pi" && matches!(index, "x" | "y" | "z" | "s" | "k") {
            return Some(name.len());
        }
    }
    let (first, index) = letters.split_at(letters.chars().next()?.len_utf8());
    if first != "d" && begins_with_greek(index).is_some() && !NO_GREEK_INDEX.contains(&letters) {
        return Some(first.len());
    }
    let is_large = first.chars().all(|c| c.is_ascii_uppercase());
    let is_one = match index.len() {
        0 => false,
        1 => true,
        2 => {
            INDICES.contains(&index)
                || is_large && index.chars().any(|c| c.is_ascii_lowercase())
                || consonants(letters)
        }
        _ => INDICES.contains(&index),
    };
    is_one.then_some(first.len())
}

/// Words that end in the name of a Greek letter, most of them such names with a large letter. `d` before one is a difference.
const NO_GREEK_INDEX: [&str; 10] =
    ["Beta", "Zeta", "Eta", "beta", "zeta", "theta", "meta", "biota", "Iota", "Epsilon"];

/// The length of the name of a Greek letter at the head of an index, of which no more is left than an index has: 5 of `alphaf`. Names of two
/// letters are no such heads: `nu` is in `number`.
fn begins_with_greek(index: &str) -> Option<usize> {
    let names =
        GREEK.iter().map(|(name, _, _)| *name).filter(|name| name.len() > 2 && index.starts_with(name));
    let name = names.max_by_key(|name| name.len())?;
    let rest = &index[name.len()..];
    let is_short = rest.len() < 2 || rest.len() < 4 && !rest.chars().any(|c| "aeiouAEIOU".contains(c));
    (is_short || INDICES.contains(&rest)).then_some(name.len())
}

/// A look is no longer than this, in bytes.
const LONGEST_LOOK: usize = 80;

/// A letter of LaTeX by its name here.
fn letter(latex: &str) -> Option<String> {
    let mut letters = latex.chars();
    match (letters.next(), letters.next()) {
        (Some(one), None) if one.is_ascii_alphabetic() => Some(latex.to_owned()),
        _ => {
            let known = GREEK
                .iter()
                .find(|(name, _, command)| *command == latex || latex.strip_prefix('\\') == Some(name));
            known.map(|(name, ..)| (*name).to_owned())
        }
    }
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
    const ALL: [Accent; 5] = [Accent::TwoDots, Accent::Dot, Accent::Tilde, Accent::Bar, Accent::Hat];

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
        let letters = &first[..end];
        if letters.is_empty() {
            return None;
        }
        let (letters, rest) = first.split_at(index_within(letters).unwrap_or(end));
        let mut name =
            FormulaName { from, letters: letters.to_owned(), index: Vec::new(), accents: Vec::new() };
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

    /// The look that LaTeX gives a name, of as much of LaTeX as names need: a letter (`F`, `\\alpha`, `\\mathrm{Re}`), perhaps below accents
    /// (`\\dot{x}`), perhaps with an index (`F_{yf}`, `\\alpha_f`). None where it is anything else.
    pub fn of_latex(text: &str) -> Option<FormulaName> {
        if text.len() > LONGEST_LOOK {
            return None;
        }
        let mut name =
            FormulaName { from: Vec::new(), letters: String::new(), index: Vec::new(), accents: Vec::new() };
        let (base, index) = match text.split_once('_') {
            Some((base, index)) => (base, Some(index)),
            None => (text, None),
        };
        let mut base = base.trim();
        while let Some((accent, inside)) = Accent::ALL.into_iter().find_map(|accent| {
            let inside = base.strip_prefix(accent.latex())?.strip_prefix('{')?.strip_suffix('}')?;
            Some((accent, inside))
        }) {
            name.accents.insert(0, accent);
            if name.accents.len() > 2 {
                return None;
            }
            base = inside.trim();
        }
        let is_word = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphabetic());
        name.letters = match base.strip_prefix("\\mathrm{").and_then(|word| word.strip_suffix('}')) {
            Some(word) => Some(word.to_owned()).filter(|word| is_word(word)),
            None => letter(base),
        }?;
        let Some(index) = index.map(str::trim) else { return Some(name) };
        let index = match index.strip_prefix('{').and_then(|index| index.strip_suffix('}')) {
            Some(index) => index,
            None if index.chars().count() == 1 || index.starts_with('\\') => index,
            None => return None,
        };
        for part in index.split(',').map(str::trim) {
            let part = part.strip_prefix("\\mathrm{").and_then(|word| word.strip_suffix('}')).unwrap_or(part);
            let is_plain = !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric());
            name.index.push(if is_plain { part.to_owned() } else { letter(part)? });
        }
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

/// A name as a letter and what stands below the line beside it, for pictures, whose labels hold no formula: `F` and `yf` of `Fyf`, `C` and `αf` of
/// `Calphaf`. None where it has accents, or is no name of such parts. `look` is what a file says of it.
pub fn letter_and_index(text: &str, look: Option<&FormulaName>) -> Option<(String, String)> {
    let by_rule = FormulaName::of(text);
    let name = look.or(by_rule.as_ref()).filter(|name| name.accents.is_empty() && name.from.is_empty())?;
    let shown = |letters: &str| greek(letters).map_or(letters.to_owned(), |(letter, _)| letter.to_string());
    let part = |part: &String| runs(part).into_iter().map(shown).collect::<String>();
    Some((shown(&name.letters), name.index.iter().map(part).collect::<Vec<_>>().join(",")))
}

/// A name in letters alone, for places that hold no formula, such as what stands under the pointer: `ω₀` for `omega0`. What has accents
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

/// A part of an index, cut into runs of digits and of letters, and of letters into a Greek one by its name and the rest: `alpha` and `f` of
/// `alphaf`.
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
    let cut = |run| match begins_with_greek(run).filter(|end| *end < run.len()) {
        Some(end) => vec![&run[..end], &run[end..]],
        None => vec![run],
    };
    found.into_iter().flat_map(cut).collect()
}
