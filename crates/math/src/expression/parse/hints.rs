//! What may help where a text does not read: what people write by the habits of other languages, and how it is written here.

use super::tokens::{Expected, RESERVED, ends_a_line};
use crate::expression::COMPOSED;
use crate::number::Function;

/// What is expected behind a state in a field.
pub(super) const PRIME: &str = "' after the state";

/// How it is written here, by what stands before the place and at it.
const AT_THE_PLACE: [(&str, &str, &str); 73] = [
    ("/", "*", COMMENT),
    ("(", "*", COMMENT),
    ("", "(*", COMMENT),
    (".", "..", "a formula goes on in the next line by itself: leave '...' out"),
    ("*", "*", "a power is written with '^', as in x^2"),
    ("/", "/", COMMENT),
    ("", "==>", IMPLIES),
    ("", "=>", IMPLIES),
    ("=", ">", "write '>='"),
    ("=", "<", "write '<='"),
    ("<", ">", UNEQUAL),
    ("<", "<", MUCH_MORE),
    (">", ">", MUCH_MORE),
    ("=", "=", "an equation has one '=', as in x = y"),
    ("", ":=", "write '=' alone"),
    (":", "=", "write '=' alone"),
    ("", "<-", "write '=' alone"),
    ("", "&", SEVERAL),
    ("", "||", SEVERAL),
    ("", "~=", UNEQUAL),
    ("", "~", APPROXIMATELY),
    ("]", "'", "a transpose is written transpose(M)"),
    (")", "'", "a prime stands behind the name of a state alone: a derivative along the drift f is L(f, x)"),
    ("", "|", "an absolute value is written abs(x), as in abs(omega)"),
    ("", "\\", "write functions and Greek letters without the backslash, as in sin(phi)"),
    ("", "{", "brackets are ( and ); a matrix is written [a, b; c, d]"),
    (
        "",
        "%",
        "a comment begins with '#', a percentage is written as a fraction, as in 0.5, and there is no remainder of a division",
    ),
    ("", "!=", "unequal is said in a claim or a condition, as in claim a: x != 0"),
    ("", "!", "there is no factorial: write the number itself, as in 6 for 3!"),
    (
        "",
        "@",
        "'@' stands behind the name of a state alone, as in x@2, its value in the second experiment: leave '@' out",
    ),
    ("", "//", COMMENT),
    ("", ";", "an entry ends with its line: leave ';' out"),
    ("", "$", "formulas stand without '$'"),
    ("", ".*", WITHOUT_A_DOT),
    ("", "./", WITHOUT_A_DOT),
    ("", ".^", WITHOUT_A_DOT),
    ("", "...", "a formula goes on in the next line by itself: leave '...' out"),
    ("", "?", NO_CASES),
    ("", "\u{201c}", STRAIGHT_MARKS),
    ("", "\u{201d}", STRAIGHT_MARKS),
    ("", "\u{201e}", STRAIGHT_MARKS),
    ("", "\u{ab}", STRAIGHT_MARKS),
    ("", "\u{2018}", STRAIGHT_PRIME),
    ("", "\u{2019}", STRAIGHT_PRIME),
    ("", "\u{2032}", STRAIGHT_PRIME),
    ("", "\u{2212}", MINUS),
    ("", "\u{2013}", MINUS),
    ("", "\u{b7}", PRODUCT),
    ("", "\u{d7}", PRODUCT),
    ("", "\u{2022}", PRODUCT),
    ("", "\u{2217}", PRODUCT),
    ("", "\u{22c5}", PRODUCT),
    ("", "\u{f7}", "a quotient is written with '/'"),
    ("", "\u{221a}", "a root is written sqrt(x)"),
    ("", "\u{2264}", "write '<='"),
    ("", "\u{2265}", "write '>='"),
    ("", "\u{2260}", UNEQUAL),
    ("", "\u{2248}", APPROXIMATELY),
    ("", "\u{2261}", "an equation has one '=', as in x = y"),
    ("", "\u{2208}", "a range is written with 'in', as in x in [0, 1]"),
    ("", "\u{211d}", "all numbers are real: leave it out"),
    ("", "\u{221e}", "it is called 'infinity'"),
    ("", "\u{b1}", TOLERANCE),
    ("", "\u{b0}", "angles are in radians: write sin(x*pi/180)"),
    ("", "\u{bd}", "write 1/2"),
    ("", "\u{2202}", DIFFERENTIAL),
    ("", "\u{2207}", DIFFERENTIAL),
    ("", "\u{222b}", "an integral is a state of its own, as in z' = x"),
    ("", "\u{2016}", "a norm is written sqrt(dot(v, v))"),
    ("", "\u{2200}", FOR_ALL),
    ("", "\u{2203}", FOR_ALL),
    ("", "\u{b2}", "a power is written with '^', as in x^2"),
    ("", "\u{b3}", "a power is written with '^', as in x^3"),
];

const APPROXIMATELY: &str = "write '=': approximately is said by 'within', as in x = 2 within 0.1";
const COMMENT: &str = "a comment begins with '#'";
const DIFFERENTIAL: &str = "a differential is written d(e, x), the row of all derivatives d(e), a derivative along the drift L(f, x)";
const FOR_ALL: &str = "a claim is about all states and values for which its terms exist: leave it out";
const IMPLIES: &str =
    "what is implied is the claim, and its conditions stand behind 'where', as in claim a: x = y where k = 0";
const MINUS: &str = "use the minus sign of the keyboard, '-'";
const MUCH_MORE: &str = "write '<' or '>' once: nothing is much greater here";
const NO_CASES: &str =
    "there is no 'if': write max(a, b), min(a, b), abs(a) or sign(a), or a claim for each case with 'where'";
const PRODUCT: &str = "a product is written with '*'";
/// Of statements that are to hold together.
const SEVERAL: &str = "of several statements each is a claim of its own; conditions stand behind 'where', with ',' between them";
const STRAIGHT_MARKS: &str = "use straight quotation marks, as in \"text\"";
const STRAIGHT_PRIME: &str = "use the straight mark ', as in x' = y";
/// Of a number with its uncertainty.
pub(super) const TOLERANCE: &str = "a value is one number: a tolerance stands behind 'within', a range in an entry of its own, as in sample k in [1.9, 2.1]";
const UNEQUAL: &str = "unequal is written '!=', as in x != 0";
const WITHOUT_A_DOT: &str = "write '*', '/' and '^' without the dot";

/// By characters that nothing here is written with, from one to another.
const CHARACTERS: [(char, char, &str); 12] = [
    ('\u{2080}', '\u{209c}', "an index is written x_1, or x[1] for the component of a vector"),
    ('\u{2070}', '\u{207f}', "a power is written with '^', as in x^2 or x^(-1)"),
    ('\u{ff01}', '\u{ff5e}', "type it with the plain keyboard: letters and signs of full width are others"),
    ('\u{0}', '\u{1f}', "a control character stands here: delete it"),
    ('\u{7f}', '\u{9f}', "a control character stands here: delete it"),
    ('\u{ad}', '\u{ad}', "an invisible character stands here: delete it"),
    ('\u{200b}', '\u{200f}', "an invisible character stands here: delete it"),
    ('\u{2060}', '\u{2064}', "an invisible character stands here: delete it"),
    ('\u{feff}', '\u{feff}', "an invisible character stands here: delete it"),
    ('\u{c0}', '\u{24f}', OF_NAMES),
    ('\u{300}', '\u{36f}', OF_NAMES),
    ('\u{400}', '\u{1fff}', OF_NAMES),
];

const OF_NAMES: &str = "this character belongs to no name: names have the letters a-z, Greek letters, digits and '_', as in x_dot or x_hat";

/// By the word at the place, or by the one before it.
const WORDS: [(&str, &str); 6] = [
    (
        "rand randn random",
        "nothing is random in a file: states are drawn from the ranges of 'sample', and a scene has noise",
    ),
    ("if then else", NO_CASES),
    ("and or", SEVERAL),
    ("forall exists", "a claim is about all states and values for which its terms exist: leave 'forall' out"),
    ("implies iff", IMPLIES),
    ("not", UNEQUAL),
];

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// What may help by what stands at the place.
fn at_the_place(before: &str, rest: &str) -> Option<String> {
    let line = before.rsplit(ends_a_line).next().unwrap_or_default();
    let fixed = |(left, right, help): &(&str, &str, &str)| {
        (line.ends_with(left) && rest.starts_with(right)).then(|| (*help).to_owned())
    };
    let next = rest.chars().next();
    let of_characters = |(from, to, help): &(char, char, &str)| {
        next.is_some_and(|c| !ends_a_line(c) && (*from..=*to).contains(&c)).then(|| (*help).to_owned())
    };
    let closes = || {
        let is_more = rest.starts_with(')') && line.matches(')').count() >= line.matches('(').count();
        is_more.then(|| "this bracket closes none: each ')' needs its '('".to_owned())
    };
    let found = of_numbers(line, rest).or_else(|| AT_THE_PLACE.iter().find_map(fixed));
    found
        .or_else(|| CHARACTERS.iter().find_map(of_characters))
        .or_else(closes)
        .or_else(|| by_words(line, rest))
        .or_else(|| of_lists(line, rest))
}

/// A comma that ends its line, and entries of a row without one.
fn of_lists(line: &str, rest: &str) -> Option<String> {
    let ends = |behind: &str| {
        let behind = behind.trim_start_matches(' ');
        behind.is_empty() || behind.starts_with(ends_a_line)
    };
    if rest.strip_prefix(',').is_some_and(ends) {
        return Some("an entry ends with its line: leave ',' out".to_owned());
    }
    let is_open = line.matches('[').count() > line.matches(']').count();
    let is_next = rest.starts_with(|c: char| is_word(c) || c == '(') && line.trim_end() != line;
    (is_open && is_next).then(|| {
        "entries of a row and the ends of a range have ',' between them, rows of a matrix ';', as in [1, 2; 3, 4]".to_owned()
    })
}

fn is_function(name: &str) -> bool {
    Function::ALL.into_iter().any(|function| function.name() == name)
        || COMPOSED.into_iter().any(|(composed, ..)| composed == name)
        || ["tan", "cot", "sec", "csc"].contains(&name)
}

/// How numbers are written elsewhere.
fn of_numbers(line: &str, rest: &str) -> Option<String> {
    let digit = |c: char| c.is_ascii_digit();
    let begins_with_digit = |text: &str| text.starts_with(digit);
    let separated = line
        .strip_suffix(',')
        .filter(|_| begins_with_digit(rest))
        .or_else(|| rest.strip_prefix(',').is_some_and(begins_with_digit).then_some(line));
    let number = |line: &str| line.len() - line.trim_end_matches(|c: char| digit(c) || c == '.').len();
    if let Some(whole) = separated.filter(|whole| whole.ends_with(digit)) {
        let fraction = rest.trim_start_matches(',');
        let count = fraction.len() - fraction.trim_start_matches(digit).len();
        // 1.000,5 and 1,000 have separators of thousands
        let has_thousands = count == 3 || whole[whole.len() - number(whole)..].contains('.');
        let help = "a number has no separators, as in 1000";
        let decimal = "a decimal point is written '.', as in 0.5";
        return Some(if has_thousands { format!("{decimal}; {help}") } else { decimal.to_owned() });
    }
    if !line.ends_with(digit) || number(line) == 0 || line[..line.len() - number(line)].ends_with(is_word) {
        return None;
    }
    let word = &rest[..rest.find(|c| !is_word(c)).unwrap_or(rest.len())];
    let help = match word.chars().next() {
        Some('_' | 'x' | 'X') if is_of_digits(line, word) => {
            "a number is written in decimal digits without separators, as in 1000"
        }
        Some('d' | 'D')
            if word.len() == 1 && rest[1..].starts_with(['+', '-']) || word[1..].starts_with(digit) =>
        {
            "an exponent is written with 'e', as in 2e-3"
        }
        Some('i' | 'j') if word.len() == 1 => "there are no complex numbers",
        None if rest.starts_with('%') => {
            "a percentage is written as a fraction, as in 0.5 for 50%; a comment begins with '#'"
        }
        None if rest.strip_prefix('.').is_some_and(begins_with_digit) => {
            "a number has one decimal point, as in 1.5"
        }
        _ => return None,
    };
    Some(help.to_owned())
}

/// Whether a number goes on in another writing of numbers, as in `1_000` and `0x1f`, and is no factor of a name, as in `2x`.
fn is_of_digits(line: &str, word: &str) -> bool {
    let rest = &word[1..];
    match word.starts_with('_') {
        true => rest.starts_with(|c: char| c.is_ascii_digit()),
        false => {
            let is_zero = line
                .strip_suffix('0')
                .is_some_and(|before| !before.ends_with(|c: char| is_word(c) || c == '.'));
            is_zero && !rest.is_empty() && rest.chars().all(|c| c.is_ascii_hexdigit())
        }
    }
}

/// By the words of the line as far as the place.
fn by_words(line: &str, rest: &str) -> Option<String> {
    let words: Vec<&str> = line.split(|c| !is_word(c)).filter(|word| !word.is_empty()).collect();
    let at_word: &str = &rest[..rest.find(|c| !is_word(c)).unwrap_or(rest.len())];
    let last = words.last().copied().unwrap_or_default();
    let met = |word: &str| word == at_word || word == last || word == "if" && words.contains(&word);
    if let Some((_, help)) = WORDS.iter().find(|(all, _)| all.split(' ').any(met)) {
        return Some((*help).to_owned());
    }
    if at_word == "where" && last == "everywhere" {
        return Some("'where' and its conditions stand before 'everywhere'".to_owned());
    }
    if let Some((base, power)) = line.rsplit_once('^')
        && rest.starts_with('(')
        && !power.is_empty()
        && power.chars().all(|c| c.is_ascii_digit())
        && let Some(function) = base.rsplit(|c| !is_word(c)).next().filter(|name| is_function(name))
    {
        return Some(format!(
            "a power of a function stands behind its brackets, as in {function}(x)^{power}"
        ));
    }
    // an index runs in something else: 'for i in 1..3'
    if last == "in" && !rest.starts_with('[') && !words.contains(&"for") {
        return Some("a range has square brackets, as in x in [-1, 1]".to_owned());
    }
    None
}

/// Names of the derivative by time.
const DERIVATIVES: [&str; 8] = ["d", "D", "Dt", "der", "diff", "deriv", "ddt", "Derivative"];

/// What functions are called elsewhere, and here.
const FUNCTIONS: [(&str, &str); 12] = [
    ("sgn", "sign"),
    ("signum", "sign"),
    ("ln", "log"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("tg", "tan"),
    ("ctg", "cot"),
    ("sh", "sinh"),
    ("ch", "cosh"),
    ("th", "tanh"),
    ("fabs", "abs"),
];

/// What may help where the prime of a rate of change is missing: the name that should have one ends before the place.
fn of_a_rate(before: &str, rest: &str) -> Option<String> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let prime = |state: &str| Some(format!("a rate of change is written with a prime, as in {state}' = ..."));
    let named = before.trim_end();
    let index = named.strip_suffix(']').and_then(|named| named.rsplit_once('['));
    let step = |state: &str| Some(format!("the value after one step is written {state}+ = ..."));
    if let Some((vector, index)) = index {
        let vector = vector.rsplit(|c| !is_word(c)).next().unwrap_or_default();
        if DERIVATIVES.contains(&vector) {
            return prime(index);
        }
        return if index.ends_with("+1") || index.ends_with("+ 1") { step(vector) } else { None };
    }
    let begin = named
        .rfind(|c| !is_word(c))
        .map_or(0, |end| end + named[end..].chars().next().map_or(1, char::len_utf8));
    let (name, line) = (&named[begin..], named[..begin].rsplit(ends_a_line).next().unwrap_or_default());
    let digits = name.len() - name.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    if digits > 0 && digits < name.len() {
        // `2x`, and `1e3x`
        let exponent = name[digits..].strip_prefix(['e', 'E']).unwrap_or_default();
        let count = exponent.len() - exponent.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let end = if count > 0 { digits + 1 + count } else { digits };
        return Some(product(&name[..end], &name[end..]));
    }
    if let Some((state, _)) =
        rest.split_once("/dt").filter(|(state, _)| name == "d" && state.chars().all(is_word))
    {
        return prime(state);
    }
    if let Some(left) =
        line.trim_end().rsplit(|c: char| !is_word(c)).next().filter(|_| !line.trim().is_empty())
    {
        // behind an expression stands no state whose rate follows
        let other = || power_of_a_function(line, name).unwrap_or_else(|| product(left, name));
        return by_words(line, name).or_else(|| Some(other()));
    }
    let inner = rest.strip_prefix('(').and_then(|rest| rest.split(')').next());
    if rest.starts_with("^+") || inner.is_some_and(|inner| inner.ends_with("+1") || inner.ends_with("+ 1")) {
        return step(name);
    }
    if let Some(state) = name.strip_suffix("_next").filter(|_| rest.starts_with('=')) {
        return step(state);
    }
    if let Some(state) =
        name.strip_suffix("_ddot").or_else(|| name.strip_suffix("ddot")).filter(|state| !state.is_empty())
    {
        return Some(format!(
            "a second derivative needs a state of its own, as in {state}' = v and v' = ..."
        ));
    }
    if name == "end" {
        return Some("an entry ends by itself: leave 'end' out".to_owned());
    }
    if let Some(sign) = ["+=", "-=", "*=", "/="].into_iter().find(|sign| rest.starts_with(sign)) {
        let sign = &sign[..1];
        return Some(format!("write {name}' = v for a rate, {name}+ = {name} {sign} v for a step"));
    }
    if rest.starts_with(['*', '/', '+', '-']) && !rest.starts_with("/dt") {
        let state = rest.split('\'').next().and_then(|left| left.rsplit(|c| !is_word(c)).next());
        let state = state.filter(|state| !state.is_empty()).unwrap_or(name);
        return Some(format!("a rate stands alone on the left, as in {state}' = ..."));
    }
    let dotted = name.strip_suffix("_dot").or_else(|| name.strip_suffix("dot"));
    let derived = match inner {
        Some(inner) if DERIVATIVES.contains(&name) => inner.split(',').next(),
        _ if rest.starts_with("/dt") => name.strip_prefix('d'),
        _ => None,
    };
    let state = dotted.or(derived).map(str::trim).filter(|state| !state.is_empty());
    prime(state.or(rest.starts_with('=').then_some(name))?)
}

/// Behind `sin^2` stands the argument of the function.
fn power_of_a_function(before: &str, argument: &str) -> Option<String> {
    let (base, power) = before.trim_end().rsplit_once('^')?;
    let function = base.rsplit(|c| !is_word(c)).next().filter(|name| is_function(name))?;
    let is_power = !power.is_empty() && power.chars().all(|c| c.is_ascii_digit());
    is_power.then(|| {
        format!("a power of a function stands behind its brackets, as in {function}({argument})^{power}")
    })
}

/// A product of two names, or of something else.
fn product(left: &str, right: &str) -> String {
    let left = FUNCTIONS.iter().find(|(other, _)| *other == left).map_or(left, |(_, here)| here);
    match is_function(left) {
        true => format!("a function has its argument in brackets, as in {left}({right})"),
        false if left.is_empty() || right.is_empty() => PRODUCT.to_owned(),
        false => format!("{PRODUCT}, as in {left}*{right}"),
    }
}

/// A word of the language where a name is meant, or a product without its sign.
fn of_a_product(before: &str, rest: &str, what: &str) -> Option<String> {
    let word = |text: &str| text[..text.find(|c| !is_word(c)).unwrap_or(text.len())].to_owned();
    let right = word(rest);
    if RESERVED.contains(&right.as_str()) {
        let help = format!("'{right}' is a word of the language: choose another name, as in {right}_1");
        let is_name = ["a name", "the name", "a list of", "the field's name", "a state", "a number, a name"];
        return is_name.into_iter().any(|name| what.starts_with(name)).then_some(help);
    }
    let left = before.trim_end();
    let is_factor = left.ends_with(|c: char| is_word(c) || matches!(c, ')' | ']' | '.'))
        && rest.starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '(');
    let joins = ["operator", "list of arguments"].into_iter().any(|part| what.contains(part));
    let is_argument = what.contains("list of arguments");
    (is_factor && joins).then(|| {
        let left = &left[left
            .rfind(|c| !is_word(c))
            .map_or(0, |end| end + left[end..].chars().next().map_or(1, char::len_utf8))..];
        if is_argument && !left.is_empty() && !right.is_empty() && !is_function(left) {
            return format!(
                "arguments have ',' between them, as in ({left}, {right}); {PRODUCT}, as in {left}*{right}"
            );
        }
        if let Some(help) = power_of_a_function(before, &right) {
            return help;
        }
        let left = if left.starts_with(|c: char| c.is_ascii_digit()) { "" } else { left };
        product(left, &right)
    })
}

impl Expected {
    /// With the advice for what people write by the habits of other languages, where the text has it at the place and nobody has
    /// better advice.
    pub fn with_habits(self, text: &str) -> Expected {
        let Some((before, rest)) = text.split_at_checked(self.at) else { return self };
        let rate = || if self.what.starts_with(PRIME) { of_a_rate(before, rest) } else { None };
        let help = self.help.clone().or_else(|| at_the_place(before, rest)).or_else(rate);
        Expected { help, ..self }
    }

    /// The same, by how numbers are written elsewhere alone.
    pub fn with_habits_of_numbers(self, text: &str) -> Expected {
        let Some((before, rest)) = text.split_at_checked(self.at) else { return self };
        let line = before.rsplit(ends_a_line).next().unwrap_or_default();
        Expected { help: self.help.or_else(|| of_numbers(line, rest)), ..self }
    }

    /// The same, and where no habit is known the advice for a product without its sign.
    pub fn hinted(self, text: &str) -> Expected {
        let found = self.with_habits(text);
        let Some((before, rest)) = text.split_at_checked(found.at) else { return found };
        let help = found.help.clone().or_else(|| of_a_product(before, rest, &found.what));
        Expected { help, ..found }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Anything may stand at a place, and a place may be no boundary of characters.
    #[test]
    fn no_text_is_too_strange() {
        let texts = [
            "",
            "\u{3c6}",
            "d(",
            "  \u{2032}x",
            "x y",
            "x\u{85}y\u{2028}z",
            "# \u{201c}\nif",
            "in (",
            "1,2",
            "2d",
            "1\u{e9}",
            "x[\u{e9}]",
            "]",
            "[",
            "\u{e9}]",
            "1.2.",
            "x\u{302}_dot",
            "1dx",
            "2d-",
            ",1",
            "\u{e9},1",
        ];
        for text in texts {
            for at in 0..=text.len() + 2 {
                for what in [PRIME, "a name or an operator"] {
                    let expected = Expected { what: what.to_owned(), at, help: Some("kept".to_owned()) };
                    assert_eq!(expected.hinted(text).help.as_deref(), Some("kept"), "{text:?} at {at}");
                    let _ = Expected { what: what.to_owned(), at, help: None }.hinted(text);
                }
            }
        }
    }
}
