//! A reader of XML, and of presentation MathML as people read it, which knows nothing of how it was written.

use std::collections::BTreeMap;

/// An element of XML: its tag, and what stands inside.
#[derive(Debug)]
pub(super) enum Xml {
    Text(String),
    Element(String, Vec<Xml>),
}

/// Reads XML; panics where it is not well formed.
pub(super) fn xml(text: &str) -> Xml {
    fn inside(text: &str, at: &mut usize, tag: &str) -> Vec<Xml> {
        let mut found = Vec::new();
        loop {
            let rest = &text[*at..];
            if let Some(rest) = rest.strip_prefix("</") {
                let end = rest.find('>').expect("an end");
                assert_eq!(&rest[..end], tag);
                *at += end + 3;
                return found;
            } else if let Some(inner) = rest.strip_prefix('<') {
                let end = inner.find('>').expect("an end");
                *at += end + 2;
                let (head, empty) = match inner[..end].strip_suffix('/') {
                    Some(head) => (head, true),
                    None => (&inner[..end], false),
                };
                assert_eq!(head.matches('"').count() % 2, 0, "{head}");
                let name = head.split(' ').next().unwrap().to_owned();
                let children = if empty { Vec::new() } else { inside_of(text, at, &name) };
                found.push(Xml::Element(name, children));
            } else {
                let end = rest.find('<').expect("an element's end");
                let part = rest[..end].replace("&lt;", "<").replace("&gt;", ">");
                assert!(!part.contains('&'));
                found.push(Xml::Text(part));
                *at += end;
            }
        }
    }
    let text = format!("{text}</all>");
    let mut at = 0;
    Xml::Element("all".into(), inside(&text, &mut at, "all"))
}

fn inside_of(text: &str, at: &mut usize, tag: &str) -> Vec<Xml> {
    let closed = format!("</{tag}>");
    let mut depth = 0;
    let mut place = *at;
    // the end that belongs to this beginning
    let end = loop {
        let rest = &text[place..];
        let next = rest.find('<').expect("an end") + place;
        if text[next..].starts_with(&closed) {
            if depth == 0 {
                break next;
            }
            depth -= 1;
        } else if text[next + 1..].starts_with(tag) && text[next + 1 + tag.len()..].starts_with(['>', ' ']) {
            let stop = text[next..].find('>').expect("an end") + next;
            depth += usize::from(!text[..stop].ends_with('/'));
        }
        place = next + 1;
    };
    let Xml::Element(_, children) = xml(&text[*at..end]) else { panic!("no element") };
    *at = end + closed.len();
    children
}

/// What is shown, and its value.
pub(super) type Values = BTreeMap<String, f64>;

/// A reader of presentation MathML as people read it: a row of signs, what stands side by side multiplied, a function's word
/// before what it is taken of.
struct Reader<'a> {
    parts: &'a [Xml],
    at: usize,
    values: &'a Values,
}

fn text_of(xml: &Xml) -> String {
    match xml {
        Xml::Text(text) => text.clone(),
        Xml::Element(_, children) => children.iter().map(text_of).collect(),
    }
}

fn children(xml: &Xml) -> (&str, &[Xml]) {
    match xml {
        Xml::Element(tag, children) => (tag, children),
        Xml::Text(text) => panic!("text {text:?} between elements"),
    }
}

pub(super) fn function(word: &str) -> Option<fn(f64) -> f64> {
    Some(match word {
        "sin" => f64::sin,
        "cos" => f64::cos,
        "arctan" => f64::atan,
        "exp" => f64::exp,
        _ => return None,
    })
}

impl Reader<'_> {
    fn peek(&self) -> Option<(&str, String)> {
        self.parts.get(self.at).map(|part| (children(part).0, text_of(part)))
    }

    fn sign(&mut self, wanted: &str) -> bool {
        let found = self.peek().is_some_and(|(tag, text)| tag == "mo" && text == wanted);
        self.at += usize::from(found);
        found
    }

    fn room(&mut self) -> bool {
        let found = self.peek().is_some_and(|(_, text)| text == "\u{2009}");
        self.at += usize::from(found);
        found
    }

    /// One element, or brackets with what stands between them.
    fn thing(&mut self) -> f64 {
        if !self.sign("(") {
            self.at += 1;
            return one(&self.parts[self.at - 1], self.values);
        }
        let (begin, mut open) = (self.at, 1);
        while open > 0 {
            open += i32::from(self.sign_at("(")) - i32::from(self.sign_at(")"));
            self.at += 1;
        }
        row(&self.parts[begin..self.at - 1], self.values)
    }

    fn sign_at(&self, wanted: &str) -> bool {
        self.peek().expect("a bracket that closes") == ("mo", wanted.to_owned())
    }

    fn sum(&mut self) -> f64 {
        let mut total = if self.sign("−") { -self.product() } else { self.product() };
        loop {
            if self.sign("+") {
                total += self.product();
            } else if self.sign("−") {
                total -= self.product();
            } else {
                return total;
            }
        }
    }

    fn product(&mut self) -> f64 {
        let mut value = self.factor();
        loop {
            let room = self.room();
            if room || self.sign("·") {
                value *= self.factor();
                continue;
            }
            match self.peek() {
                Some((tag, text)) if tag != "mo" || text == "(" => value *= self.factor(),
                _ => return value,
            }
        }
    }

    fn factor(&mut self) -> f64 {
        let (tag, inner) = children(&self.parts[self.at]);
        let (word, power) = match tag {
            "mi" => (text_of(&self.parts[self.at]), 1),
            "msup" if children(&inner[0]).0 == "mi" => {
                (text_of(&inner[0]), text_of(&inner[1]).replace('−', "-").parse().unwrap())
            }
            _ => (String::new(), 1),
        };
        if let Some(function) = function(word.trim()) {
            self.at += 1;
            self.room();
            // its argument is the next thing and no more
            return function(self.thing()).powi(power);
        }
        self.thing()
    }
}

/// The value of one element.
pub(super) fn one(xml: &Xml, values: &Values) -> f64 {
    let (tag, inner) = children(xml);
    let look_up = |text: &str| *values.get(text).unwrap_or_else(|| panic!("no value of {text:?}"));
    match tag {
        "mn" => text_of(xml).replace('−', "-").parse().unwrap(),
        "mi" | "msub" | "mtext" => look_up(&text_of(xml)),
        "mfrac" => one(&inner[0], values) / one(&inner[1], values),
        "msup" => one(&inner[0], values).powi(text_of(&inner[1]).replace('−', "-").parse().unwrap()),
        "msubsup" => {
            let name: String = inner[..2].iter().map(text_of).collect();
            look_up(&name).powi(text_of(&inner[2]).replace('−', "-").parse().unwrap())
        }
        "msqrt" => row(inner, values).sqrt(),
        "mrow" | "math" | "all" => row(inner, values),
        other => panic!("<{other}>"),
    }
}

fn row(parts: &[Xml], values: &Values) -> f64 {
    let mut reader = Reader { parts, at: 0, values };
    let value = reader.sum();
    assert_eq!(reader.at, parts.len(), "something is left over in {parts:?}");
    value
}
