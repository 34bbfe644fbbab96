//! A refutation's witness, read as it is printed and evaluated again.

use super::expression::Expression;
use super::library::Said;
use super::number::Number;
use super::point::{Compared, Coordinate, Point, compare, rational};
use super::series::value;
use dashu::rational::RBig;

/// An equation that is claimed, or a condition.
#[derive(Clone, Debug)]
pub struct Equation {
    pub left: Expression,
    pub right: Expression,
}

impl Equation {
    pub fn new(left: Expression, right: Expression) -> Equation {
        Equation { left, right }
    }

    pub fn text(&self) -> String {
        format!("{} = {}", self.left.text(), self.right.text())
    }

    pub fn at(&self, point: &Point) -> Compared {
        compare(&self.left, &self.right, point)
    }

    /// Whether a state gives all symbols.
    fn is_covered(&self, point: &Point) -> bool {
        let symbols = [self.left.symbols(), self.right.symbols()].concat();
        symbols.iter().all(|name| point.get(name).is_some())
    }
}

/// How a witness stands.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// It is given in full, meets the conditions, and the sides differ there by what is printed.
    Good,
    /// It leaves something out that the sides or the conditions mention.
    Incomplete,
    /// 240 digits do not tell.
    Unclear,
    /// It is none; the words say why.
    Bad(String),
}

/// Looks at the witness of a refutation.
pub fn examine(said: &Said, claimed: &Equation, conditions: &[Equation]) -> Standing {
    let Some(shown) = &said.witness else {
        return Standing::Bad("a refutation without a witness".to_owned());
    };
    let Some(point) = Point::read(&shown.state) else {
        return Standing::Bad(format!("a witness that cannot be read: {:?}", shown.state));
    };
    let mut complete = true;
    for condition in conditions {
        if !condition.is_covered(&point) {
            complete = false;
            continue;
        }
        match condition.at(&point) {
            Compared::Equal => {}
            Compared::Unclear => return Standing::Unclear,
            Compared::Differ | Compared::Undefined => {
                let text = condition.text();
                return Standing::Bad(format!("the witness ({}) does not meet {text}", point.text()));
            }
        }
    }
    let mut point = point;
    if !claimed.is_covered(&point) {
        if !complete || !any_completion_will_do(claimed, &point) {
            return Standing::Incomplete;
        }
        for name in [claimed.left.symbols(), claimed.right.symbols()].concat() {
            if point.get(name).is_none() {
                point.put(name, Coordinate::Number(Number::ONE));
            }
        }
        if claimed.at(&point) == Compared::Undefined {
            return Standing::Incomplete;
        }
    }
    match claimed.at(&point) {
        Compared::Differ => {}
        Compared::Equal => {
            return Standing::Bad(format!("the sides are equal at the witness ({})", point.text()));
        }
        Compared::Undefined => {
            return Standing::Bad(format!("a side does not exist at the witness ({})", point.text()));
        }
        Compared::Unclear => return Standing::Unclear,
    }
    for (side, text) in [(&claimed.left, &shown.left), (&claimed.right, &shown.right)] {
        if let Ok(right) = value(side, &point)
            && !agrees(&right, text)
        {
            let about = right.digits().to_f64().value();
            return Standing::Bad(format!("{text} is printed where {about} is right ({})", point.text()));
        }
    }
    if shown.left == shown.right {
        return Standing::Bad(format!("both sides are printed as {}", shown.left));
    }
    if complete { Standing::Good } else { Standing::Incomplete }
}

/// Whether the sides differ whatever values the symbols have of which a witness says nothing: then these are needed by
/// nothing, not even for the sides to exist.
fn any_completion_will_do(claimed: &Equation, point: &Point) -> bool {
    let all = [-7, -1, 0, 1, 3].map(|n| Number::Rational(RBig::from(n) / RBig::from(2)));
    all.iter().all(|value| {
        let mut point = point.clone();
        for name in [claimed.left.symbols(), claimed.right.symbols()].concat() {
            if point.get(name).is_none() {
                point.put(name, Coordinate::Number(value.clone()));
            }
        }
        claimed.at(&point) == Compared::Differ
    })
}

/// Whether a printed value is a number, rounded or not; what is no number is not judged.
fn agrees(right: &Number, text: &str) -> bool {
    if text.contains('/')
        && let (Some(printed), Number::Rational(right)) = (rational(text), right)
    {
        return printed == *right;
    }
    let Ok(printed) = text.parse::<f64>() else { return true };
    let right = right.digits().to_f64().value();
    let digits = text.trim_start_matches('-').split(['e', 'E']).next().unwrap_or("");
    let digits = digits.chars().filter(char::is_ascii_digit).count().min(14) as i32;
    let exact = text.parse::<RBig>().is_ok();
    let room = if exact { 1e-14 } else { 10f64.powi(1 - digits).max(1e-13) };
    (printed - right).abs() <= room * right.abs().max(1e-300) || (printed == right)
}
