//! States of the witness, and what two sides of an equation are there.

use super::expression::{Expression, Symbol};
use super::number::{Number, Trouble, float, is_blurred, threshold};
use super::reading::read_constant;
use super::series::value;
use dashu::base::Abs;
use dashu::rational::RBig;
use std::collections::BTreeMap;

/// The value of one symbol.
#[derive(Clone, Debug)]
pub enum Coordinate {
    Number(Number),
    /// An angle of which only sine and cosine are given, both rational.
    Angle {
        sine: RBig,
        cosine: RBig,
    },
}

impl Coordinate {
    /// The angle whose half has a rational tangent.
    pub fn from_half_tangent(t: &RBig) -> Coordinate {
        let square = t * t;
        let bottom = RBig::ONE + &square;
        Coordinate::Angle { sine: (t + t) / &bottom, cosine: (RBig::ONE - square) / bottom }
    }

    fn text(&self) -> String {
        match self {
            Coordinate::Number(Number::Rational(value)) => value.to_string(),
            Coordinate::Number(number) => match number.as_turns() {
                Some(turns) => format!("{turns}*pi"),
                None => format!("about {}", number.digits().to_f64().value()),
            },
            Coordinate::Angle { sine, cosine } => format!("(sin {sine}, cos {cosine})"),
        }
    }
}

/// A state: a coordinate for each symbol that matters.
#[derive(Clone, Debug, Default)]
pub struct Point(BTreeMap<String, Coordinate>);

impl Point {
    pub fn of<const N: usize>(coordinates: [(&str, Coordinate); N]) -> Point {
        Point(coordinates.into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
    }

    pub fn put(&mut self, name: &str, value: Coordinate) {
        self.0.insert(name.to_owned(), value);
    }

    pub fn get(&self, name: &str) -> Option<&Coordinate> {
        self.0.get(name)
    }

    /// A symbol's coordinate; what the point does not give is unclear.
    pub fn coordinate(&self, name: &str) -> Result<&Coordinate, Trouble> {
        self.0.get(name).ok_or(Trouble::Unclear)
    }

    /// A symbol's value; of an angle that is given by sine and cosine, the one between minus pi and pi, in digits.
    pub fn number(&self, name: Symbol) -> Result<Number, Trouble> {
        Ok(match self.coordinate(name)? {
            Coordinate::Number(number) => number.clone(),
            Coordinate::Angle { sine, cosine } => {
                if sine.is_zero() {
                    let turns = if *cosine > RBig::ZERO { RBig::ZERO } else { RBig::ONE };
                    Number::turns(turns)
                } else {
                    Number::Digits(float(sine).atan2(&float(cosine)))
                }
            }
        })
    }

    /// For messages: `x = 3/2, phi = 1*pi`.
    pub fn text(&self) -> String {
        let all: Vec<String> = self.0.iter().map(|(name, at)| format!("{name} = {}", at.text())).collect();
        all.join(", ")
    }

    /// A state from the words in which the library prints one: `3/2`, or `sin = 4/5, cos = 3/5`.
    pub fn read(words: &[(String, String)]) -> Option<Point> {
        let mut point = Point::default();
        for (name, text) in words {
            let angle = text.strip_prefix("sin = ").and_then(|rest| rest.split_once(", cos = "));
            let coordinate = match angle {
                Some((sine, cosine)) => {
                    Coordinate::Angle { sine: rational(sine)?, cosine: rational(cosine)? }
                }
                None => Coordinate::Number(value(&read_constant(text)?, &Point::default()).ok()?),
            };
            point.put(name, coordinate);
        }
        Some(point)
    }
}

/// `-3/2`.
pub fn rational(text: &str) -> Option<RBig> {
    text.trim().parse().ok()
}

/// What two sides come to at a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// Both exist and are the same number, or agree to 90 digits where they are not rational.
    Equal,
    /// Both exist, and certainly differ.
    Differ,
    /// One of them certainly does not exist.
    Undefined,
    Unclear,
}

/// Compares the sides of an equation at a state.
pub fn compare(left: &Expression, right: &Expression, point: &Point) -> Compared {
    let (l, r) = match (value(left, point), value(right, point)) {
        (Ok(l), Ok(r)) => (l, r),
        (Err(Trouble::Undefined), _) | (_, Err(Trouble::Undefined)) => return Compared::Undefined,
        _ => return Compared::Unclear,
    };
    let difference = l.subtract(&r);
    if difference.is_exact() {
        return if difference.is_exact_zero() { Compared::Equal } else { Compared::Differ };
    }
    let size = l.digits().abs() + r.digits().abs() + float(&RBig::ONE);
    let relative = (difference.digits() / size).abs();
    if is_blurred(&relative) {
        Compared::Equal
    } else if relative > threshold(200) {
        Compared::Differ
    } else {
        Compared::Unclear
    }
}
