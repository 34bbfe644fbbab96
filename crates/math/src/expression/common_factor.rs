//! Do two rational expressions vanish together on more than a thin set? On a random line they then share a root.

use super::graph::{Graph, NodeId, Symbol};
use super::input::Input;
use super::program::Program;
use crate::number::polynomial::Ring;
use crate::number::univariate::Univariate;
use crate::number::{Arithmetic, Fraction, Fractions};
use dashu::integer::IBig;
use rand::Rng;
use std::collections::HashMap;

/// Whether the numerators of `a` and `b`, over their least common denominator, have a common factor that is not
/// constant. `None` where that cannot be found out.
///
/// A common factor has a root on almost every line (over a large enough field), and polynomials without one have no
/// common root there: the answer errs, with a probability of about degree squared over 2^61, by refusing.
pub fn share_a_factor(
    graph: &Graph,
    a: NodeId,
    b: NodeId,
    is_angle: impl Fn(Symbol) -> bool,
    rng: &mut impl Rng,
) -> Option<bool> {
    let program = Program::with_unknown_functions(graph, &[a, b], is_angle);
    if program.bare_angle().is_some() {
        return None;
    }
    let fractions = Fractions::<Univariate>::default();
    let field = Univariate::field();
    let mut half_tangents: HashMap<Symbol, Univariate> = HashMap::new();
    // 1 + t^2 vanishes at no real angle, and so describes no set
    let mut imaginary: Vec<Univariate> = Vec::new();
    let mut inputs: Vec<Fraction> = Vec::new();
    for input in program.inputs() {
        let mut line = || Univariate::line(field.draw(rng), field.draw(rng));
        inputs.push(match input {
            Input::Plain(_) | Input::Opaque(_) => fractions.element(line()),
            Input::Sine(symbol) | Input::Cosine(symbol) => {
                let t = half_tangents.entry(*symbol).or_insert_with(line).clone();
                let (one, square) = (Univariate::integer(&IBig::ONE), t.mul(&t)?);
                imaginary.push(one.add(&square));
                let bottom = fractions.element(one.add(&square));
                let top = if matches!(input, Input::Sine(_)) { t.add(&t) } else { one.add(&square.neg()) };
                fractions.div(&fractions.element(top), &bottom).ok()?
            }
        });
    }
    let values = program.load(&fractions).ok()?.run(&inputs, &mut Vec::new()).ok()?;
    let (top_a, bottom_a) = lowest_terms(&fractions, &values[0])?;
    let (top_b, bottom_b) = lowest_terms(&fractions, &values[1])?;
    if top_b.is_zero() {
        // everything is divisible by what b is
        return Some(top_a.degree() > 0);
    }
    let shared = bottom_a.gcd(&bottom_b);
    let left = top_a.mul(&bottom_b.quotient(&shared)?)?;
    let right = top_b.mul(&bottom_a.quotient(&shared)?)?;
    let mut common = left.gcd(&right);
    for circle in &imaginary {
        loop {
            let part = common.gcd(circle);
            if part.degree() == 0 {
                break;
            }
            common = common.quotient(&part)?;
        }
    }
    Some(common.degree() > 0)
}

fn lowest_terms(fractions: &Fractions<Univariate>, value: &Fraction) -> Option<(Univariate, Univariate)> {
    let (top, bottom) = (fractions.expand(&value.top).ok()?, fractions.expand(&value.bottom).ok()?);
    if top.is_zero() {
        return Some((top, Univariate::integer(&IBig::ONE)));
    }
    let shared = top.gcd(&bottom);
    Some((top.quotient(&shared)?, bottom.quotient(&shared)?))
}
