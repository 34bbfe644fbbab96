//! Names, short expressions and Lie derivatives within a sentence or a table, as mathematics.

use crate::formula::{conditions_mathml, formula_mathml_in};
use maud::{Markup, PreEscaped, html};
use palmistry_lang::Looks;

/// A name or an expression as mathematics; as it is written where it is none.
pub(super) fn in_line(text: &str, looks: &Looks) -> Markup {
    formula_mathml_in(text, looks).map_or_else(|| html! { (text) }, PreEscaped)
}

/// A condition of more letters may be wider than a narrow screen.
const LONG: usize = 40;

/// Conditions as mathematics; as they are written where they are none.
pub(super) fn conditions(written: &[String], looks: &Looks) -> Markup {
    html! {
        @match conditions_mathml(written, looks) {
            // long ones scroll in a box of their own; a line breaks behind each of the others
            Some(formula) if written.iter().any(|one| one.len() > LONG) => { span.f { (PreEscaped(formula)) } }
            Some(formula) => { (PreEscaped(formula)) }
            None => { code { (written.join(", ")) } }
        }
    }
}

/// A condition as the program writes it, `vy*5 + r*6 > 0`, the number of each term before its letters, as people write them.
pub(super) fn numbers_first(condition: &str) -> String {
    let term = |term: &str| match term.rsplit_once('*') {
        Some((letters, number))
            if number.bytes().all(|c| c.is_ascii_digit()) && !letters.contains(['(', ')', '/', '-', ',']) =>
        {
            format!("{number}*{letters}")
        }
        _ => term.to_owned(),
    };
    condition.split(' ').map(term).collect::<Vec<_>>().join(" ")
}

/// Several, between commas.
pub(super) fn listed<T: AsRef<str>>(texts: &[T], looks: &Looks) -> Markup {
    html! {
        @for (place, text) in texts.iter().enumerate() {
            @if place > 0 { ", " }
            (in_line(text.as_ref(), looks))
        }
    }
}

/// A generated sentence `what is said: a, b, c` whose list is set as mathematics where each part of it is a formula.
pub(super) fn with_list(line: &str, looks: &Looks) -> Markup {
    let Some((said, list)) = line.split_once(": ") else { return html! { (line) } };
    let parts: Vec<&str> = list.split(", ").collect();
    match parts.iter().all(|part| formula_mathml_in(part, looks).is_some()) {
        true => html! { (said) ": " (listed(&parts, looks)) },
        false => html! { (line) },
    }
}

/// The name of a field; that of a known signal's derivative has dashes.
pub(super) fn field_name(name: &str, looks: &Looks) -> Markup {
    let bare = name.trim_end_matches('\'');
    let dashes = "\u{2032}".repeat(name.len() - bare.len());
    html! { (in_line(bare, looks)) (dashes) }
}

/// A Lie derivative as the rank writes it, `Lf Lg x`, as mathematics: its operators, and then the output. Longer outputs may be broken. Where the
/// fields are not known an operator is what begins as one before a name or a bracket.
pub(super) fn lie_derivative(text: &str, fields: Option<&[&str]>, looks: &Looks) -> Markup {
    const SHORT: usize = 24;
    let begins_a_term = |text: &str| text.starts_with(|c: char| c.is_alphanumeric() || c == '(');
    let is_one = |field: &str, behind: &str| match fields {
        Some(fields) => fields.contains(&field),
        None => !field.is_empty() && begins_a_term(behind),
    };
    let mut operators: Vec<(&str, usize)> = Vec::new();
    let mut rest = text;
    while let Some((first, behind)) = rest.split_once(' ')
        && let Some(field) = first.strip_prefix('L').filter(|field| is_one(field, behind))
    {
        match operators.last_mut() {
            Some((last, times)) if *last == field => *times += 1,
            _ => operators.push((field, 1)),
        }
        rest = behind;
    }
    html! {
        span.nb[rest.len() < SHORT] {
            @if !operators.is_empty() { math { @for (field, times) in &operators { (PreEscaped(operator(field, *times, looks))) } } " " }
            (in_line(rest, looks))
        }
    }
}

/// `L` with the field below the line, and above it how many times it is taken, as an element of MathML.
fn operator(field: &str, times: usize, looks: &Looks) -> String {
    let bare = field.trim_end_matches('\'');
    let dashes = "<mo>\u{2032}</mo>".repeat(field.len() - bare.len());
    let formula = formula_mathml_in(bare, looks);
    let inner = formula.as_ref().and_then(|formula| formula.strip_prefix("<math>")?.strip_suffix("</math>"));
    let index = match inner.filter(|inner| !inner.contains("<math>")) {
        Some(inner) => inner.to_owned(),
        None => html! { mtext { (bare) } }.into_string(),
    };
    match times {
        1 => format!("<msub><mi>L</mi><mrow>{index}{dashes}</mrow></msub>"),
        _ => format!("<msubsup><mi>L</mi><mrow>{index}{dashes}</mrow><mn>{times}</mn></msubsup>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lie_derivatives_are_set() {
        let none = Looks::default();
        let of = |text: &str| lie_derivative(text, Some(&["f", "delta'"]), &none).into_string();
        let f = "<msub><mi>L</mi><mrow><mi>f</mi></mrow></msub>";
        let delta = "<msub><mi>L</mi><mrow><mi>\u{3b4}</mi><mo>\u{2032}</mo></mrow></msub>";
        assert_eq!(
            of("Lf Ldelta' vy"),
            format!(
                "<span class=\"nb\"><math>{f}{delta}</math> <math><msub><mi>v</mi><mi>y</mi></msub></math></span>"
            )
        );
        assert!(of("Lf Lf Lf vy").contains("<msubsup><mi>L</mi><mrow><mi>f</mi></mrow><mn>3</mn></msubsup>"));
        // an output that begins with the letter is no operator
        assert!(!of("Lf").contains("<mrow>") && !of("Lg x").contains("<mrow><mi>g"));
        let unknown = |text: &str| lie_derivative(text, None, &none).into_string();
        assert!(unknown("Lg x").contains("<mrow><mi>g") && !unknown("Lg + x").contains("<mrow><mi>g"));
    }

    #[test]
    fn numbers_stand_before_letters() {
        assert_eq!(numbers_first("vy*5 + r*6 > 0"), "5*vy + 6*r > 0");
        assert_eq!(numbers_first("-vy*5 - x*y^2*60 != (r*6)"), "-vy*5 - 60*x*y^2 != (r*6)");
    }

    #[test]
    fn lists_of_formulas_are_set_and_sentences_are_not() {
        let none = Looks::default();
        let set = with_list("known: vy, delta", &none).into_string();
        assert!(set.starts_with("known: <math><msub>") && set.contains("</math>, <math>"), "{set}");
        let plain = "the terms exist: nothing else, and so on";
        assert_eq!(with_list(plain, &none).into_string(), plain);
    }
}
