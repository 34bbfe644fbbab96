//! Lie derivatives by nested finite differences: what people bring along, as the bad example.
//!
//! `L_X F(q)` is `(F(q + e X(q)) - F(q)) / e` (forward) or `(F(q + e X(q)) - F(q - e X(q))) / 2e` (central), a Lie derivative along
//! `k` fields is nested `k` deep, and its differential takes one difference more for each state: a derivative of order
//! `n = k + 1` whose cost doubles with each field.
//!
//! The step is the customary one, relative to the size of the state: the difference loses `u/e^n` to rounding and `e`
//! (forward) or `e^2` (central) to truncation, so that `e = u^(1/(n+1))` or `u^(1/(n+2))` balances the two, with `u` the
//! spacing of the numbers at one. For a first derivative these are the familiar square root and cube root.
//!
//! Reference: W. H. Press et al., *Numerical Recipes* (3rd ed. 2007), section 5.7.

use super::point_programs::{LoadedPoints, PointPrograms};
use palmistry_math::number::{Floats, RealNumber, Refusal};

/// Which difference stands for a derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FiniteDifference {
    Forward,
    Central,
}

impl FiniteDifference {
    /// The step for a derivative of this order, in numbers with the given spacing at one.
    pub fn step(self, spacing: f64, order: usize) -> f64 {
        let loss = if self == FiniteDifference::Forward { 1 } else { 2 };
        spacing.powf(1.0 / (order + loss) as f64)
    }
}

/// Differences of a system's functions over the numbers of one type.
pub struct Differences<'p, T: RealNumber> {
    points: LoadedPoints<'p, Floats<T>>,
    difference: FiniteDifference,
    spacing: f64,
}

/// The size by which a step is relative.
fn size(value: f64) -> f64 {
    value.abs().max(1.0)
}

impl<'p, T: RealNumber> Differences<'p, T> {
    /// Differences over numbers with the given spacing at one.
    ///
    /// # Errors
    /// Where a constant has no image.
    pub fn new(
        points: &'p PointPrograms,
        difference: FiniteDifference,
        spacing: f64,
    ) -> Result<Self, Refusal> {
        Ok(Differences { points: points.load(Floats::new())?, difference, spacing })
    }

    /// The differential of `L_{X1} L_{X2} ... h` by the states, in their order; `word` holds the fields' places in the
    /// system, outermost first, and `function` the place of `h`.
    ///
    /// # Errors
    /// Where a point that was stepped to is a pole.
    pub fn differential(&self, word: &[usize], function: usize, point: &[T]) -> Result<Vec<T>, Refusal> {
        let step = self.difference.step(self.spacing, word.len() + 1);
        let value = |point: &[T]| self.lie_derivative(word, function, point, step);
        let here = if self.difference == FiniteDifference::Forward { Some(value(point)?) } else { None };
        let mut moved = point.to_vec();
        let mut row = Vec::with_capacity(self.points.states().len());
        for place in self.points.states() {
            let length = T::from_f64(step * size(point[*place].to_f64()));
            moved[*place] = point[*place] + length;
            let ahead = value(&moved)?;
            row.push(match here {
                Some(here) => (ahead - here).quotient(length)?,
                None => {
                    moved[*place] = point[*place] - length;
                    (ahead - value(&moved)?).quotient(length + length)?
                }
            });
            moved[*place] = point[*place];
        }
        Ok(row)
    }

    fn lie_derivative(&self, word: &[usize], function: usize, point: &[T], step: f64) -> Result<T, Refusal> {
        let Some((field, rest)) = word.split_first() else {
            return self.points.function(function, point);
        };
        let (places, rates) = self.points.rates(*field, point)?;
        // the state moves by the step relative to its size, in the component that moves most
        let speed = places.iter().zip(&rates).map(|(p, rate)| rate.to_f64().abs() / size(point[*p].to_f64()));
        let speed = speed.fold(0.0, f64::max);
        let length = T::from_f64(if speed > 0.0 { step / speed } else { step });
        let mut moved = point.to_vec();
        let mut step_to = |length: T| {
            for (place, rate) in places.iter().zip(&rates) {
                moved[*place] = point[*place] + length * *rate;
            }
            self.lie_derivative(rest, function, &moved, step)
        };
        let ahead = step_to(length)?;
        match self.difference {
            FiniteDifference::Forward => (ahead - step_to(T::from_f64(0.0))?).quotient(length),
            FiniteDifference::Central => (ahead - step_to(-length)?).quotient(length + length),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_lang::System;
    use palmistry_math::expression::{Input, Program};
    use std::path::Path;

    const PLANE: &str = "system \"plane\" state x, y drift f x' = sin(x*y)/y y' = x^2/y output x*y^3";

    /// The errors of a differential, beside that of the graph at the same point.
    fn errors(difference: FiniteDifference, order: usize) -> Vec<f64> {
        let mut system = System::parse("plane.proof", PLANE, Path::new("")).unwrap();
        let h = system.outputs[0].1;
        let points = PointPrograms::new(&system, &[h]);
        let loaded = Differences::<f64>::new(&points, difference, f64::EPSILON).unwrap();
        let point = [0.75, 1.25];
        let row = loaded.differential(&vec![0; order - 1], 0, &point).unwrap();
        let value = (1..order).fold(h, |value, _| system.lie_derivative(0, value));
        let entries = system.differential(value);
        let program = Program::plain(&system.graph, &entries);
        let place = |input: &Input| match input {
            Input::Plain(symbol) if *symbol == system.states[0] => point[0],
            _ => point[1],
        };
        let inputs: Vec<f64> = program.inputs().iter().map(place).collect();
        let exact = program.load(Floats::new()).unwrap().run(&inputs, &mut Vec::new()).unwrap();
        row.iter().zip(exact).map(|(found, exact): (&f64, f64)| (found - exact).abs()).collect()
    }

    /// The error is of the size of the step (forward) or of its square (central), times derivatives of the size of one
    /// to a hundred.
    #[test]
    fn errors_are_what_the_step_predicts() {
        for order in 1..=3 {
            for (difference, power) in [(FiniteDifference::Forward, 1), (FiniteDifference::Central, 2)] {
                let predicted = difference.step(f64::EPSILON, order).powi(power);
                let worst = errors(difference, order).into_iter().fold(0.0, f64::max);
                let found = format!("{difference:?} {order}: {worst:e} and {predicted:e}");
                assert!((0.01..100.0).contains(&(worst / predicted)), "{found}");
            }
        }
    }

    #[test]
    fn the_steps_of_a_first_derivative_are_the_familiar_ones() {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(near(FiniteDifference::Forward.step(f64::EPSILON, 1), f64::EPSILON.sqrt()));
        assert!(near(FiniteDifference::Central.step(f64::EPSILON, 1), f64::EPSILON.cbrt()));
    }
}
