//! Completing the square: the form of a polynomial that shows where it cannot vanish.
//!
//! Written out, `x^2 + x y + y^2` has bounds that contain zero on every box around the axes; as a sum of squares it has
//! none but near the origin.

use super::graph::{Graph, NodeId};
use super::products::{Products, Variable, half};
use crate::number::polynomial::{Polynomial, Ring};
use crate::number::{Factorisation, Function, split};
use dashu::rational::RBig;

impl Products {
    /// The form of a polynomial as a sum of squares, as far as it is one by completing the square in plain variables: of
    /// `a x^2 + b x + c` that is `((2 a x + b)^2 - (b^2 - 4 a c)) / 4a`, with the discriminant as a product. `None` where
    /// no variable is of degree two.
    pub fn in_squares(&self, graph: &mut Graph, polynomial: &Polynomial) -> Option<NodeId> {
        self.squares(graph, polynomial, DEEPEST_SQUARE)
    }

    fn squares(&self, graph: &mut Graph, polynomial: &Polynomial, depth: usize) -> Option<NodeId> {
        if depth == 0 || polynomial.len() > LONGEST_SQUARE {
            return None;
        }
        // the variable with the shortest discriminant
        let mut best: Option<(usize, Square)> = None;
        for (place, variable) in self.variables().iter().enumerate() {
            if matches!(variable, Variable::Plain(_))
                && let Some(square) = Square::of(polynomial, place)
            {
                let length: usize = square.discriminant.factors.iter().map(|(f, _)| f.len()).sum();
                if best.as_ref().is_none_or(|(shortest, _)| length < *shortest) {
                    best = Some((length, square));
                }
            }
        }
        let (_, square) = best?;
        // all three over one degree in each angle
        let slope = self.exactly(graph, &square.slope);
        let mut upper = graph.power(slope, 2);
        let mut lower = graph.rational(RBig::from(square.discriminant.unit.clone()));
        for (factor, power) in &square.discriminant.factors {
            let form = if power.is_multiple_of(2) { None } else { self.squares(graph, factor, depth - 1) };
            let form = match form {
                Some(form) => form,
                None => self.exactly(graph, factor),
            };
            let power = graph.power(form, i32::try_from(*power).ok()?);
            lower = graph.mul(lower, power);
        }
        let mut bottom = self.exactly(graph, &square.four_a);
        for (place, variable) in self.variables().iter().enumerate() {
            let Variable::HalfTangent(symbol) = variable else { continue };
            let of_slope = 2 * i32::from(square.slope.degree_in(place));
            let factors = &square.discriminant.factors;
            let of_lower: i32 = factors
                .iter()
                .map(|(f, n)| i32::from(f.degree_in(place)) * i32::try_from(*n).unwrap_or(0))
                .sum();
            let of_bottom = i32::from(square.four_a.degree_in(place));
            let whole = i32::from(polynomial.degree_in(place)) + of_bottom;
            let most = whole.max(of_slope).max(of_lower);
            let cosine = half(graph, *symbol, Function::Cos);
            for (node, degree) in [(&mut upper, of_slope), (&mut lower, of_lower), (&mut bottom, whole)] {
                let missing = graph.power(cosine, most - degree);
                *node = graph.mul(*node, missing);
            }
        }
        let difference = graph.sub(upper, lower);
        Some(graph.div(difference, bottom))
    }
}

/// Squares are completed in so many variables, one after the other.
const DEEPEST_SQUARE: usize = 3;
/// And not in longer polynomials.
const LONGEST_SQUARE: usize = 400;

/// A polynomial of degree two in a variable, `a x^2 + b x + c`.
struct Square {
    /// `2 a x + b`
    slope: Polynomial,
    /// `b^2 - 4 a c`
    discriminant: Factorisation,
    /// `4 a`
    four_a: Polynomial,
}

impl Square {
    fn of(polynomial: &Polynomial, place: usize) -> Option<Square> {
        let mut coefficients = polynomial.coefficients_in(place);
        if coefficients.keys().max() != Some(&2) {
            return None;
        }
        let mut take = |power: u8| coefficients.remove(&power).unwrap_or_default();
        let (a, b, c) = (take(2), take(1), take(0));
        let two_a = a.add(&a);
        let four_a = two_a.add(&two_a);
        let discriminant = b.mul(&b)?.add(&four_a.mul(&c)?.neg());
        let slope = two_a.mul(&Polynomial::variable(place))?.add(&b);
        Some(Square { slope, discriminant: split(&discriminant, &[]), four_a })
    }
}
