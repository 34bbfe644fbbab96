//! What is set is read back by a reader that knows nothing of how it was laid out, and has to have the same value.

mod reader;

use super::*;
use crate::expression::parse_expression;
use crate::expression::syntax::{Expr, ExprKind};
use proptest::prelude::*;
use reader::{Values, function, one, xml};

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
        ExprKind::RealPower(base, exponent) => value(base, values).powf(value(exponent, values)),
        ExprKind::Matrix(_) | ExprKind::At(..) | ExprKind::Indexed(_) => panic!("not drawn"),
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

/// A letter and its index in one, as people write them; words stay words, and what another name looks like is spelled out.
#[test]
fn names_of_a_letter_and_an_index() {
    for (name, expected) in [
        ("ia", "i_{a}"),
        ("Lq", "L_{q}"),
        ("Fyf", "F_{\\mathrm{yf}}"),
        ("alphaf", "\\alpha_{f}"),
        ("Calphaf", "C_{\\alpha f}"),
        ("Kphi", "K_{\\varphi}"),
        ("Czeta1", "C_{\\zeta1}"),
        ("dtheta", "\\mathrm{dtheta}"),
        ("meta", "\\mathrm{meta}"),
        ("Beta", "\\mathrm{Beta}"),
        ("omegam", "\\omega_{m}"),
        ("thetaref", "\\theta_{\\mathrm{ref}}"),
        ("Vmax", "V_{\\mathrm{max}}"),
        ("mumax", "\\mu_{\\mathrm{max}}"),
        ("kcat", "k_{\\mathrm{cat}}"),
        ("Kin", "K_{\\mathrm{in}}"),
        ("Kx1", "K_{x1}"),
        ("ia_dot", "\\dot{i}_{a}"),
        ("phi0", "\\varphi_{0}"),
        ("mass", "\\mathrm{mass}"),
        ("old", "\\mathrm{old}"),
        ("dose", "\\mathrm{dose}"),
        ("pin", "p_{\\mathrm{in}}"),
        ("dt", "\\mathrm{dt}"),
        ("left", "\\mathrm{left}"),
        ("radius", "\\mathrm{radius}"),
        ("x*ia + i_a", "x\\,\\mathtt{ia} + \\mathtt{i\\_a}"),
    ] {
        assert_eq!(in_latex(name), expected, "{name}");
    }
}

/// The same in a picture, beside which stands no formula: a letter, and what is set below the line.
#[test]
fn names_in_pictures() {
    let of = |name: &str| letter_and_index(name, None);
    let pair = |letter: &str, index: &str| Some((letter.to_owned(), index.to_owned()));
    assert_eq!(of("Fyf"), pair("F", "yf"));
    assert_eq!(of("Calphaf"), pair("C", "\u{3b1}f"));
    assert_eq!(of("omega0"), pair("\u{3c9}", "0"));
    assert_eq!(of("x_1_max"), pair("x", "1,max"));
    assert_eq!(of("mass"), pair("mass", ""));
    assert_eq!((of("r2_dot"), of("")), (None, None));
    let look = FormulaName::of_latex("F_{\\psi}");
    assert_eq!(letter_and_index("force", look.as_ref()), pair("F", "\u{3c8}"));
}

/// What a file may say of a name: letters, accents and indices, and nothing else of LaTeX.
#[test]
fn looks_in_latex() {
    for (written, expected) in [
        ("F_{yf}", "F_{\\mathrm{yf}}"),
        ("\\alpha_f", "\\alpha_{f}"),
        ("\\dot{\\tilde{r}}_{2}", "\\dot{\\tilde{r}}_{2}"),
        ("\\mathrm{Re}", "\\mathrm{Re}"),
        ("x_{1, \\mathrm{max}}", "x_{1,\\mathrm{max}}"),
        ("\\phi_\\psi", "\\varphi_{\\psi}"),
    ] {
        let look = FormulaName::of_latex(written).unwrap_or_else(|| panic!("{written}"));
        assert_eq!(latex(&Formula::Name(look)), expected, "{written}");
    }
    for bad in [
        "",
        "Force",
        "F_yf",
        "x^2",
        "\\frac{a}{b}",
        "\\href{x}{y}",
        "<b>",
        "x_{<}",
        "\\dot{x",
        "x_",
        "\\input{a}",
        "x_{}",
        "\\mathrm{}",
    ] {
        assert!(FormulaName::of_latex(bad).is_none(), "{bad}");
    }
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
