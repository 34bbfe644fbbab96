//! Where in the text of a scene each key and value stands, and the errors at these places as text.

use super::hints;
use palmistry_lang::{Code, Problem};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The places of a text.
pub(crate) struct Places<'a> {
    table: Spanned<DeTable<'a>>,
    text: &'a str,
}

/// A key and its value, where they stand.
struct Entry<'a, 'b> {
    key: Range<usize>,
    value: &'b Spanned<DeValue<'a>>,
}

impl<'a> Places<'a> {
    pub fn of(text: &'a str) -> Result<Self, Problem> {
        let table = DeTable::parse(text).map_err(|error| {
            let span = error.span().unwrap_or(text.len()..text.len());
            let toml = "a scene is a TOML file (toml.io)";
            let help = match hints::of_syntax(text, &span) {
                _ if error.message() == "duplicate key" => {
                    format!("it is there twice: leave one out; {toml}")
                }
                Some(hint) => format!("{hint}; {toml}"),
                None => toml.to_owned(),
            };
            Problem::new(Code::SceneText, &span, in_words(error.message()), "here").help(help)
        })?;
        Ok(Places { table, text })
    }

    /// The span of a value, named by its keys as in `palms.prescribed[1].start`. Of a place that is not there, what
    /// there is on the way to it.
    pub fn value(&self, place: &str) -> Range<usize> {
        self.walk(place).map_or(self.top(), |entry| entry.value.span())
    }

    /// The span of a value's key.
    pub fn key(&self, place: &str) -> Range<usize> {
        self.walk(place).map_or(self.top(), |entry| entry.key)
    }

    /// The span of a key that may have dots or brackets in it, named by the tables in which it stands and itself.
    pub fn key_of(&self, path: &[&str]) -> Range<usize> {
        let (mut table, mut found) = (Some(self.table.get_ref()), self.top());
        for part in path {
            let Some((key, value)) =
                table.and_then(|t| t.iter().find(|(k, _)| k.get_ref().as_ref() == *part))
            else {
                break;
            };
            (found, table) = (key.span(), value.get_ref().as_table());
        }
        found
    }

    /// Whether a table of the text has this key.
    pub fn has(&self, table: &str, key: &str) -> bool {
        let named = self.table.get_ref().iter().find(|(name, _)| name.get_ref().as_ref() == table);
        let inner = named.and_then(|(_, value)| value.get_ref().as_table());
        inner.is_some_and(|inner| inner.iter().any(|(name, _)| name.get_ref().as_ref() == key))
    }

    /// The start of the text, where missing keys are marked.
    fn top(&self) -> Range<usize> {
        0..usize::from(!self.text.is_empty())
    }

    fn walk(&self, place: &str) -> Option<Entry<'a, '_>> {
        let mut found: Option<Entry> = None;
        for part in place.split('.') {
            let mut indices = part.split(['[', ']']).filter(|piece| !piece.is_empty());
            let key = indices.next()?;
            let table = match &found {
                None => Some(self.table.get_ref()),
                Some(entry) => entry.value.get_ref().as_table(),
            };
            let Some((at, mut value)) =
                table.and_then(|t| t.iter().find(|(k, _)| k.get_ref().as_ref() == key))
            else {
                break;
            };
            for index in indices {
                let array = index.parse::<usize>().ok().zip(value.get_ref().as_array());
                let Some(inner) = array.and_then(|(index, array)| array.get(index)) else { break };
                value = inner;
            }
            found = Some(Entry { key: at.span(), value });
        }
        found
    }

    /// The keys on the way to the value that has a span, or to the innermost one around it.
    fn path_to(&self, span: &Range<usize>) -> Vec<&str> {
        let mut path = Vec::new();
        path_within(self.table.get_ref(), span, &mut path);
        path
    }

    /// The place of a key of this name within a span.
    fn key_within(&self, name: &str, span: &Range<usize>) -> Option<Range<usize>> {
        let mut tables = vec![self.table.get_ref()];
        let mut values: Vec<&Spanned<DeValue>> = Vec::new();
        while let Some(table) = tables.pop() {
            for (key, value) in table.iter() {
                let at = key.span();
                if key.get_ref().as_ref() == name && span.start <= at.start && at.end <= span.end {
                    return Some(at);
                }
                values.push(value);
            }
            while let Some(value) = values.pop() {
                match value.get_ref() {
                    DeValue::Table(table) => tables.push(table),
                    DeValue::Array(array) => values.extend(array.iter()),
                    _ => {}
                }
            }
        }
        None
    }

    /// The error of serde or the TOML reader, at its place, with advice.
    pub fn explain(&self, error: &toml::de::Error) -> Problem {
        let message = error.message();
        let span = error.span().unwrap_or(self.top());
        let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        match (quoted.split_first(), message) {
            (Some((unknown, known)), m) if m.starts_with("unknown field") => {
                // for a table that is read by hand the span is that of its header
                let after = || self.key_within(unknown, &(span.start..self.text.len()));
                let place = self.key_within(unknown, &span).or_else(after).unwrap_or(span);
                Problem::new(
                    Code::SceneKey,
                    &place,
                    format!("unknown key '{unknown}'"),
                    "not a key of this table",
                )
                .help(hints::of_key(unknown, known))
            }
            (Some((unknown, known)), m) if m.starts_with("unknown variant") => {
                Problem::new(Code::SceneValue, &span, format!("'{unknown}' is not known"), "here")
                    .help(hints::of_word(unknown, known))
            }
            (Some((missing, _)), m) if m.starts_with("missing field") => {
                let help = EXAMPLES.iter().find(|(key, _)| key == missing).map(|(_, example)| *example);
                let help = help.map_or(format!("give '{missing}'"), |e| format!("add, for instance: {e}"));
                // the table of the whole file has no header to mark
                let (place, label) = match span.is_empty() {
                    true => (self.top(), "at the top of the file, before the first table"),
                    false => (span, "in this table"),
                };
                Problem::new(Code::SceneKey, &place, format!("the key '{missing}' is missing"), label)
                    .help(help)
            }
            _ => {
                let message = in_words(message);
                let help = match message.rsplit_once("expected ") {
                    Some((_, expected)) if message.starts_with("invalid ") => {
                        let written = self.text.get(span.clone()).unwrap_or_default();
                        // of a value within a table only the place of the table may be known
                        match written.starts_with('{') && !message.contains("a table,") {
                            true => hints::ANY_KIND.to_owned(),
                            false => hints::of_kind(&self.path_to(&span), written, expected),
                        }
                    }
                    _ => hints::ANY_KIND.to_owned(),
                };
                Problem::new(Code::SceneValue, &span, message, "this").help(help)
            }
        }
    }
}

/// Appends the keys on the way to the value that has a span, as far as there is one in a table. The span of a table is that of its header
/// alone.
fn path_within<'t>(table: &'t DeTable<'_>, span: &Range<usize>, path: &mut Vec<&'t str>) -> bool {
    for (key, value) in table.iter() {
        path.push(key.get_ref().as_ref());
        let own = value.span();
        let is_inside = value.get_ref().as_table().is_some_and(|inner| path_within(inner, span, path));
        if is_inside || own.start <= span.start && span.end <= own.end {
            return true;
        }
        path.pop();
    }
    false
}

/// Keys that a table cannot do without, with examples.
const EXAMPLES: [(&str, &str); 20] = [
    ("title", "title = \"Both palms turn at one constant rate\""),
    ("model", "model = \"general.proof\""),
    ("observer", "[observer] with methods and estimate"),
    ("shape", "shape = { kind = \"ellipse\", semi_axes = [1.2, 0.9] }"),
    ("kind", "kind = \"ellipse\""),
    ("mean", "mean = 1.0, in m"),
    ("semi_axes", "semi_axes = [1.2, 0.9], in m"),
    ("exponent", "exponent = 4"),
    ("radii", "radii = [1.2, 1.5, 1.3], in m"),
    ("mass", "mass = 1.0, in kg"),
    ("inertia", "inertia = [0.5, 0.5], in kg m^2"),
    ("start", "start = 0.8, in rad"),
    ("angle", "angle = 0.8, in rad"),
    ("torque", "torque = 10.0, in N m"),
    ("amplitude", "amplitude = 0.1"),
    ("frequency", "frequency = 1.0, in Hz"),
    ("methods", "methods = [\"newton\"]"),
    ("estimate", "estimate = [\"r1\", \"r2\", \"omega0\"]"),
    ("levels", "levels = [1e-5, 1e-4], in m"),
    ("points", "points = 21"),
];

/// A message of serde's without Rust's terms.
fn in_words(message: &str) -> String {
    if message == "wanted string or table" {
        return "this is no text, expected one in quotation marks".to_owned();
    }
    let words = [
        ("floating point `", "the number `"),
        ("integer `", "the number `"),
        ("f64", "a number"),
        ("usize", "a whole number that is not negative"),
        ("u64", "a whole number that is not negative"),
        ("a sequence", "a list"),
        ("sequence", "a list"),
        ("a map", "a table"),
        ("map", "a table"),
        ("an array of length", "a list of length"),
        ("a string", "a text"),
        ("path string", "a text"),
        ("struct ParameterKeys", "a table with 'bounds'"),
        ("struct PriorKeys", "a table with 'law', 'centre' and 'spread'"),
        ("string \"", "the text \""),
    ];
    // only the part that serde writes, not its quotes from the file
    let quote = message.rfind("expected ").filter(|_| message.starts_with("invalid "));
    match quote {
        Some(at) => {
            let swap = |text: &str| {
                let found = words.iter().find(|(from, _)| text.starts_with(from));
                found.map_or(text.to_owned(), |(from, to)| format!("{to}{}", &text[from.len()..]))
            };
            let (head, tail) = message.split_at(at);
            let (kind, what) = head.split_once(": ").unwrap_or(("", head));
            let kind = if kind.is_empty() { "" } else { &format!("{kind}: ") };
            format!("{kind}{}expected {}", swap(what), swap(&tail["expected ".len()..]))
        }
        None => message.to_owned(),
    }
}
