//! What is set is read back by a reader that knows nothing of how it was laid out, and has to have the same value.

use super::*;
use crate::expression::parse_expression;
use crate::expression::syntax::{Expr, ExprKind};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn set(text: &str) -> Formula {
    let expr = parse_expression(text).unwrap();
    FormulaLayout::new(text, [&expr]).expression(&expr)
}

fn in_latex(text: &str) -> String {
    latex(&set(text))
}

/// By hand, as a textbook sets them.
#[test]
fn formulas_in_latex() {
    for (written, expected) in [
        ("omega0^2*r1", "\\omega_{0}^{2}r_{1}"),
        ("-x^2*y", "-x^{2}y"),
        ("(a + b)*c", "\\left(a + b\\right)c"),
        ("a - (b - c)", "a - \\left(b - c\\right)"),
        ("a + (b - c)", "a + b - c"),
        ("a + (-b)", "a + \\left(-b\\right)"),
        ("a/b/c*d", "\\frac{a}{bc}d"),
        ("a/(b*c)", "\\frac{a}{bc}"),
        ("1/2*3", "\\frac{1}{2} \\cdot 3"),
        ("(a/b)^2", "\\left(\\frac{a}{b}\\right)^{2}"),
        ("x^(-1)", "x^{-1}"),
        ("sin(phi1)^2*cos(phi1)", "\\sin^{2}\\left(\\varphi_{1}\\right)\\cos\\varphi_{1}"),
        ("sin(x)*y", "\\sin\\left(x\\right)y"),
        ("sin(x)*cos(y)", "\\sin x\\cos y"),
        ("sin(x)^(-1)", "\\left(\\sin x\\right)^{-1}"),
        ("sqrt(x + 1)", "\\sqrt{x + 1}"),
        ("L(f, g1, h)", "L_{f}L_{g_{1}}h"),
        ("L(f, L(g, a + b))", "L_{f}L_{g}\\left(a + b\\right)"),
        ("d(x, y, z)", "\\frac{\\partial x}{\\partial\\left(y, z\\right)}"),
        ("det([a, b; c, 1e-6])", "\\det\\begin{bmatrix}a & b \\\\ c & 10^{-6}\\end{bmatrix}"),
        ("theta_dot + r2_tilde_dot", "\\dot{\\theta} + \\dot{\\tilde{r}}_{2}"),
        // a name that begins like a function is spelled out
        ("det_A_factor", "\\mathtt{det\\_A\\_factor}"),
        ("a_c1", "a_{c1}"),
        ("x*a_1 + a1", "x\\,\\mathtt{a\\_1} + \\mathtt{a1}"),
        ("general.f1", "\\mathrm{general}.f_{1}"),
        ("2.50*x", "2.50x"),
        ("x*2", "x \\cdot 2"),
        ("(x + 1) at {x = 3}", "\\left.\\left(x + 1\\right)\\right|_{x = 3}"),
        ("transpose(A)*inverse(B)", "A^{\\mathsf{T}}B^{-1}"),
        ("dot(a, b)*c", "\\left(a \\cdot b\\right)c"),
    ] {
        assert_eq!(in_latex(written), expected, "{written}");
    }
}

/// An element of XML: its tag, and what stands inside.
#[derive(Debug)]
enum Xml {
    Text(String),
    Element(String, Vec<Xml>),
}

/// Reads XML; panics where it is not well formed.
fn xml(text: &str) -> Xml {
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
                let children = if empty { Vec::new() } else { self::inside_of(text, at, &name) };
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

type Values = BTreeMap<String, f64>;

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

fn function(word: &str) -> Option<fn(f64) -> f64> {
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
fn one(xml: &Xml, values: &Values) -> f64 {
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

/// What is expected: the syntax taken for what the language says it means.
fn value(expr: &Expr, values: &Values) -> f64 {
    match &expr.kind {
        ExprKind::Number(number) => crate::number::rational_to_f64(number),
        ExprKind::Name(name) => values[name],
        ExprKind::Call(name, arguments) => {
            let inner = value(&arguments[0], values);
            match name.as_str() {
                "sqrt" => inner.sqrt(),
                "atan" => inner.atan(),
                name => function(name).unwrap()(inner),
            }
        }
        ExprKind::Sum(terms) => {
            terms.iter().map(|(minus, t)| if *minus { -value(t, values) } else { value(t, values) }).sum()
        }
        ExprKind::Product(factors) => factors
            .iter()
            .fold(1.0, |all, (by, f)| if *by { all / value(f, values) } else { all * value(f, values) }),
        ExprKind::Power(base, exponent) => value(base, values).powi(*exponent),
        ExprKind::Matrix(_) | ExprKind::At(..) => panic!("not drawn"),
    }
}

/// The names that are drawn, how each looks, and its value: also two that would look alike, and one that is a function's word.
const NAMES: [(&str, &str, f64); 8] = [
    ("x", "x", 0.7),
    ("omega0", "𝜔₀", 1.3),
    ("r_2", "𝑟₂", 0.9),
    ("mass", "mass", 1.7),
    ("a1", "𝑎₁", 0.6),
    ("a_1", "a_1", 1.1),
    ("sin", "sin", 0.8),
    ("phi12", "𝜑₁₂", 0.4),
];

/// Expressions as somebody may write them.
fn expressions() -> impl Strategy<Value = String> {
    let name = (0..NAMES.len()).prop_map(|place| NAMES[place].0.to_owned());
    let number = prop_oneof!["[1-9]", "[1-9]\\.[0-9]", "[1-9]e-[1-2]", Just("1e1".to_owned())];
    let leaf = prop_oneof![3 => name, 1 => number];
    leaf.prop_recursive(5, 40, 4, |inner| {
        let sign = |signs: &'static [&'static str]| (0..signs.len()).prop_map(move |place| signs[place]);
        prop_oneof![
            (inner.clone(), sign(&[" + ", " - ", "*", "/", "*-", "/-", "- -"]), inner.clone())
                .prop_map(|(a, sign, b)| format!("{a}{sign}{b}")),
            (inner.clone(), sign(&["*", "/", "-"]), inner.clone())
                .prop_map(|(a, sign, b)| format!("({a}){sign}({b})")),
            (inner.clone(), 2..4).prop_map(|(a, n)| format!("({a})^{n}")),
            (inner.clone(), 1..3).prop_map(|(a, n)| format!("({a})^(-{n})")),
            (sign(&["sin", "cos", "atan", "sqrt"]), inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            (sign(&["sin", "cos"]), inner.clone(), 1..4).prop_map(|(f, a, n)| format!("{f}({a})^{n}")),
            (sign(&["sin", "cos"]), inner.clone(), inner.clone())
                .prop_map(|(f, a, b)| format!("{f}({a})*{b}")),
            inner.prop_map(|a| format!("-({a})")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The oracle is the value of the syntax; the reader of the MathML shares nothing with its writer.
    #[test]
    fn what_is_set_is_what_is_written(text in expressions()) {
        let Ok(expr) = parse_expression(&text) else { return Ok(()) };
        let plain: Values = NAMES.iter().map(|(name, _, value)| ((*name).to_owned(), *value)).collect();
        // a name looks as usual, or as it is written where that says something else
        let shown: Values = NAMES.iter().flat_map(|(name, look, value)| [((*name).to_owned(), *value), ((*look).to_owned(), *value)])
            .chain([("a1".to_owned(), 0.6)]).collect();
        let expected = value(&expr, &plain);
        let formula = FormulaLayout::new(&text, [&expr]).expression(&expr);
        let written = mathml(&formula);
        let only_second = text.contains("a_1") && !text.contains("a1");
        let shown = if only_second { Values::from_iter(shown.into_iter().chain([("𝑎₁".to_owned(), 1.1)])) } else { shown };
        let found = one(&xml(&written), &shown);
        if expected.is_finite() && expected.abs() < 1e12 && expected.abs() > 1e-12 {
            let scale = expected.abs().max(1e-6);
            prop_assert!((found - expected).abs() < 1e-6 * scale, "{} = {} read back as {} from {}", text, expected, found, written);
        }
        balanced(&latex(&formula));
        let pieces = mathml_in_pieces(&formula).replace("</math> <math>", "");
        prop_assert_eq!(one(&xml(&pieces), &shown).to_bits(), found.to_bits(), "{} differs from {}", pieces, written);
    }
}

/// Braces, \left and \right, \begin and \end come in pairs, properly within one another.
fn balanced(latex: &str) {
    let mut open = Vec::new();
    let mut rest = latex;
    while let Some(c) = rest.chars().next() {
        let (mark, close): (&str, Option<&str>) = if rest.starts_with("\\left") {
            ("\\left", None)
        } else if rest.starts_with("\\right") {
            ("\\right", Some("\\left"))
        } else if rest.starts_with("\\begin") {
            ("\\begin", None)
        } else if rest.starts_with("\\end") {
            ("\\end", Some("\\begin"))
        } else if c == '{' {
            ("{", None)
        } else if c == '}' {
            ("}", Some("{"))
        } else {
            rest = &rest[c.len_utf8()..];
            continue;
        };
        match close {
            None => open.push(mark),
            Some(begun) => assert_eq!(open.pop(), Some(begun), "{latex}"),
        }
        rest = &rest[mark.len()..];
    }
    assert!(open.is_empty(), "{latex}");
}

/// To the deepest nesting that the language reads.
#[test]
fn nothing_overflows() {
    let deep = format!("{}x{}", "1/(x + sqrt(".repeat(59), "))".repeat(59));
    let formula = set(&deep);
    assert!(formula.depth() > 100);
    xml(&mathml(&formula));
    balanced(&latex(&formula));
}

#[test]
fn names_in_letters() {
    for (name, letters) in [
        ("omega0", "ω₀"),
        ("r12", "r₁₂"),
        ("phi", "φ"),
        ("theta_dot", "theta_dot"),
        ("mass2", "mass2"),
        ("c_m", "c_m"),
    ] {
        assert_eq!(in_letters(name), letters);
    }
}

/// What is no number, letter by letter.
#[test]
fn markup_is_escaped() {
    let text = "a < b";
    let depth = crate::expression::parse::Depth::default();
    let all =
        crate::expression::parse::read_all(text, &depth, "", crate::expression::parse::equations).unwrap();
    let formula =
        FormulaLayout::new(text, [&all[0].left, &all[0].right]).relations(&all.iter().collect::<Vec<_>>());
    assert_eq!(mathml(&formula), "<math><mi>a</mi><mo>&lt;</mo><mi>b</mi></math>");
}
