//! Conditions that are known to be met at a state, since they were made to go through it; and more states that meet
//! them, found by trying.

use super::dice::Dice;
use super::expression::{Expression, Function, Symbol};
use super::number::{Number, Sign};
use super::point::{Compared, Coordinate, Point};
use super::series::value;
use super::witness::Equation;
use Expression as E;
use dashu::rational::RBig;

/// The symbols of conditions; the last two are angles.
pub const PLAIN: [Symbol; 3] = ["x", "y", "z"];
pub const ANGLES: [Symbol; 2] = ["phi", "psi"];

/// A multiple of pi, by halves.
fn half_turns(halves: i64) -> Coordinate {
    Coordinate::Number(Number::turns(RBig::from(halves) / RBig::from(2)))
}

/// A value at which something may happen.
fn lattice(name: Symbol, dice: &mut Dice) -> Coordinate {
    if ANGLES.contains(&name) {
        return match dice.below(4) {
            0 => Coordinate::from_half_tangent(&dice.one_of(&[1i64, 2, 3]).into()),
            1 => half_turns(dice.between(-4, 4)),
            _ => half_turns(2 * dice.between(-2, 2)),
        };
    }
    match dice.below(6) {
        0 | 1 => Coordinate::Number(Number::ZERO),
        2 => half_turns(2 * dice.between(-2, 2)),
        3 => half_turns(dice.between(-3, 3)),
        _ => Coordinate::Number(Number::Rational(dice.special())),
    }
}

/// A state of such values.
pub fn anchor(dice: &mut Dice) -> Point {
    let mut point = Point::default();
    for name in PLAIN.into_iter().chain(ANGLES) {
        point.put(name, lattice(name, dice));
    }
    point
}

/// A condition that a state meets, if this attempt finds one.
pub fn through(point: &Point, dice: &mut Dice) -> Option<Equation> {
    let zero = || E::integer(0);
    let name = dice.one_of(&PLAIN);
    let other = dice.one_of(&PLAIN);
    let (x, y) = (E::Symbol(name), E::Symbol(other));
    let angle = E::Symbol(dice.one_of(&ANGLES));
    let at = |e: &E| E::of_number(&value(e, point).ok()?);
    let gap = |e: E| Some(e.clone().minus(at(&e)?)); // vanishes at the state
    // two times in three one of those that the engine can solve
    let template = if dice.once_in(3) {
        dice.below(19)
    } else {
        dice.one_of(&[0, 1, 2, 3, 3, 4, 5, 6, 7, 8, 9, 14, 15, 18])
    };
    let found = match template {
        0 | 1 => {
            let rest: Vec<Symbol> = PLAIN.into_iter().filter(|other| *other != name).collect();
            let e = dice.polynomial(&rest, 2, 2);
            let offset = E::of_number(&value(&x, point).ok()?.subtract(&value(&e, point).ok()?))?;
            Equation::new(x, if offset == zero() { e } else { e.plus(offset) })
        }
        2 => Equation::new(gap(x.times(y))?, zero()),
        3 => Equation::new(E::Symbol("x").times(E::Symbol("y")).minus(E::Symbol("z")), zero()),
        4 => Equation::new(gap(x)?.times(gap(y)?), zero()),
        5 => {
            let factor = dice.polynomial(&PLAIN, 1, 2);
            Equation::new(gap(x)?.times(factor), zero())
        }
        6 | 7 => {
            let wave = dice.wave(&ANGLES);
            Equation::new(wave.clone(), at(&wave)?)
        }
        8 => Equation::new(x.clone(), angle.clone().plus(at(&x.minus(angle))?)),
        9 => Equation::new(x.clone(), angle),
        10 => {
            let e = x.of(Function::Tan).of(Function::Atan);
            Equation::new(e.clone(), at(&e)?)
        }
        11 => {
            let function =
                dice.one_of(&[Function::Exp, Function::Sqrt, Function::Sin, Function::Cos, Function::Atan]);
            let e = x.of(function);
            Equation::new(e.clone(), at(&e)?)
        }
        12 => Equation::new(gap(x)?.power(2).plus(gap(y)?.power(2)), zero()),
        13 => Equation::new(x.clone().power(2), at(&x.power(2))?),
        14 => {
            // holds everywhere, though pi is in it
            let e = E::integer(1).minus(angle.of(Function::Cos));
            let one = E::integer(1);
            Equation::new(E::Pi.plus(one.clone()).times(e.clone()), E::Pi.times(e.clone()).plus(one.times(e)))
        }
        15 => {
            let one = || E::integer(1);
            let square = x.clone().plus(one()).power(2);
            Equation::new(square, x.clone().power(2).plus(E::integer(2).times(x)).plus(one()))
        }
        16 => Equation::new(gap(x)?.over(dice.divisor(&PLAIN)), zero()),
        17 => Equation::new(x.clone().of(Function::Sqrt), {
            let root = x.of(Function::Sqrt);
            y.clone().plus(at(&root.minus(y))?)
        }),
        _ => Equation::new(gap(x)?.times(E::integer(1).minus(angle.of(Function::Cos))), zero()),
    };
    (found.at(point) == Compared::Equal).then_some(found)
}

/// Conditions that no state meets, of one or two equations.
pub fn never(dice: &mut Dice) -> Vec<Equation> {
    let name = dice.one_of(&PLAIN);
    let other = dice.one_of(&PLAIN);
    let (x, y, phi) = (E::Symbol(name), E::Symbol(other), E::Symbol(dice.one_of(&ANGLES)));
    let (zero, one) = (|| E::integer(0), || E::integer(1));
    let square = x.clone().power(2);
    let all = [
        vec![Equation::new(square.clone().plus(one()), zero())],
        vec![Equation::new(phi.clone().of(Function::Sin), E::integer(2))],
        vec![Equation::new(x.clone().minus(x.clone()), one())],
        vec![Equation::new(x.clone().of(Function::Exp), zero())],
        vec![Equation::new(one().over(x.clone()), zero())],
        vec![Equation::new(x.clone().of(Function::Sqrt), E::integer(-1))],
        vec![Equation::new(x.clone(), zero()), Equation::new(x.clone(), one())],
        vec![
            Equation::new(phi.clone().of(Function::Sin), zero()),
            Equation::new(phi.clone().of(Function::Cos), zero()),
        ],
        vec![
            Equation::new(x.clone().times(E::Symbol("y").plus(E::Symbol("z"))), one()),
            Equation::new(x.clone(), zero()),
        ],
        vec![Equation::new(square.clone().plus(y.power(2)).plus(one()), zero())],
        vec![Equation::new(x.clone().over(x.clone()), zero())],
        vec![Equation::new(x.clone(), phi.clone()), Equation::new(x.clone(), phi.plus(one()))],
        vec![Equation::new(square.plus(one()).negated().of(Function::Sqrt), zero())],
        vec![
            Equation::new(E::integer(0).times(x.clone().of(Function::Log)), zero()),
            Equation::new(x, E::integer(-3)),
        ],
    ];
    dice.one_of(&all)
}

/// States that meet all conditions, the first one among them: others are found near it, and by solving `name = e`.
pub fn points_on(conditions: &[Equation], first: &Point, dice: &mut Dice) -> Vec<Point> {
    let meets = |point: &Point| conditions.iter().all(|condition| condition.at(point) == Compared::Equal);
    let mut found = vec![first.clone()];
    for attempt in 0..160 {
        let base = dice.below(found.len());
        let mut point = found[base].clone();
        for _ in 0..1 + dice.below(3) {
            let all = [&PLAIN[..], &ANGLES[..]].concat();
            let name = dice.one_of(&all);
            let coordinate = match attempt % 3 {
                0 if !ANGLES.contains(&name) => Coordinate::Number(Number::Rational(dice.generic())),
                1 if ANGLES.contains(&name) => Coordinate::from_half_tangent(&dice.generic()),
                _ => lattice(name, dice),
            };
            point.put(name, coordinate);
        }
        // twice, since one condition may need what another gives
        for condition in conditions.iter().chain(conditions) {
            if let E::Symbol(name) = condition.left
                && let Ok(number) = value(&condition.right, &point)
                && number.sign() != Sign::Unclear
            {
                point.put(name, Coordinate::Number(number));
            }
        }
        if meets(&point) {
            found.push(point);
            if found.len() == 14 {
                break;
            }
        }
    }
    found
}
