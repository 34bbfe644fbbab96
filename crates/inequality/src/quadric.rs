//! Polynomials of degree two in any number of symbols: whether one is nowhere negative its matrix decides, and where it is, or has its least
//! value, follows from elimination. Everything is exact.
//!
//! `q(x) = x' A x + 2 b' x + c` is bounded below where `A` is positive semidefinite and `b` lies in its range; its least value is then that at
//! any solution of `A x = -b`. Otherwise there is a direction along which it becomes as negative as one likes.

use super::reading::Reading;
use super::{Known, Premises, Proposed};
use dashu::base::Sign;
use dashu::rational::RBig;
use palmistry_budget as budget;
use palmistry_math::expression::{Graph, Guard, Input, Need, Symbol};
use palmistry_math::number::polynomial::{Polynomial, Ring};

/// What is known of a goal of degree two.
pub enum Quadric {
    /// It holds everywhere.
    Holds,
    /// It fails at this state, if no premise excludes it.
    Fails(Proposed),
}

/// Decides a goal for all states; `None` where it is not of degree two in symbols that take all values, or no state is found.
pub fn of_degree_two(
    graph: &mut Graph,
    goal: Guard,
    is_angle: &dyn Fn(Symbol) -> bool,
    known: Known<'_>,
) -> Option<Quadric> {
    let reading = Reading::new(graph, goal.node, Premises::default(), is_angle)?;
    let symbols: Vec<Symbol> = reading
        .inputs()
        .iter()
        .map(|input| match input {
            Input::Plain(symbol) => Some(*symbol),
            _ => None,
        })
        .collect::<Option<_>>()?;
    let read = reading.polynomials(graph, known)?;
    if !read.goal.bottom.is_empty() || symbols.is_empty() {
        return None;
    }
    let polynomial = read.fractions.expand(&read.goal.top).ok()?;
    if polynomial.degree() != 2 {
        return None;
    }
    let state = |point: Vec<RBig>| symbols.iter().zip(point).map(|(s, x)| (*s, x.clone(), x)).collect();
    let form = Form::new(&polynomial, symbols.len());
    match (form.least(), goal.need) {
        (Least::At(_, value), Need::NotNegative) if value >= RBig::ZERO => Some(Quadric::Holds),
        (Least::At(_, value), Need::Positive | Need::NotZero) if value > RBig::ZERO => Some(Quadric::Holds),
        (Least::At(point, _), Need::NotNegative | Need::Positive) => Some(Quadric::Fails(state(point))),
        (Least::At(point, value), Need::NotZero) if value.is_zero() => Some(Quadric::Fails(state(point))),
        (Least::Below(point), Need::NotNegative | Need::Positive) => Some(Quadric::Fails(state(point))),
        // it may be negative everywhere
        (_, Need::NotZero) => match Form::new(&polynomial.neg(), symbols.len()).least() {
            Least::At(_, value) if value > RBig::ZERO => Some(Quadric::Holds),
            Least::At(point, value) if value.is_zero() => Some(Quadric::Fails(state(point))),
            _ => None,
        },
        (_, Need::WithinOne | Need::InsideOne) => None,
    }
}

/// Where a polynomial of degree two is least.
enum Least {
    /// It has its least value at this point.
    At(Vec<RBig>, RBig),
    /// It has none, and is negative here.
    Below(Vec<RBig>),
}

/// `x' A x + 2 b' x + c`
struct Form {
    matrix: Vec<Vec<RBig>>,
    linear: Vec<RBig>,
    constant: RBig,
}

impl Form {
    fn new(polynomial: &Polynomial, size: usize) -> Form {
        let mut form = Form {
            matrix: vec![vec![RBig::ZERO; size]; size],
            linear: vec![RBig::ZERO; size],
            constant: RBig::ZERO,
        };
        for (exponents, value) in polynomial.terms() {
            let value = RBig::from(value.clone());
            let half = &value / RBig::from(2);
            let met: Vec<usize> =
                (0..size).flat_map(|k| std::iter::repeat_n(k, usize::from(exponents[k]))).collect();
            match met[..] {
                [] => form.constant = value,
                [k] => form.linear[k] = half,
                [k, l] if k == l => form.matrix[k][k] = value,
                [k, l, ..] => {
                    form.matrix[k][l] = half.clone();
                    form.matrix[l][k] = half;
                }
            }
        }
        form
    }

    fn value(&self, x: &[RBig]) -> RBig {
        let mut sum = self.constant.clone();
        for (k, row) in self.matrix.iter().enumerate() {
            let along: RBig = row.iter().zip(x).fold(RBig::ZERO, |sum, (a, x)| sum + a * x);
            sum += &x[k] * (along + &self.linear[k] * RBig::from(2));
        }
        sum
    }

    /// Completes one square after the other. `columns[k]` is what the `k`-th square is of: the coordinates are `x = C y`, and in the
    /// coordinates `y` the matrix becomes diagonal.
    fn least(&self) -> Least {
        let size = self.linear.len();
        let mut matrix = self.matrix.clone();
        let mut linear = self.linear.clone();
        // x = C y, by columns; at first C is one
        let mut columns: Vec<Vec<RBig>> =
            (0..size).map(|k| (0..size).map(|l| RBig::from(u8::from(k == l))).collect()).collect();
        let mut y = vec![RBig::ZERO; size];
        for k in 0..size {
            let pivot = matrix[k][k].clone();
            if pivot.is_zero() {
                if let Some(l) = (k + 1..size).find(|l| !matrix[k][*l].is_zero()) {
                    // q(s e_k + t e_l) = 2 s (t a_kl + b_k) + ..: linear in s, with a slope for one of two values of t
                    let from = match (&matrix[k][l] + &linear[k]).is_zero() {
                        true => columns[l].iter().map(|x| x + x).collect(),
                        false => columns[l].clone(),
                    };
                    return self.downwards(&columns[k], &from);
                }
                if !linear[k].is_zero() {
                    return self.downwards(&columns[k], &vec![RBig::ZERO; size]);
                }
                continue;
            }
            if pivot.sign() == Sign::Negative {
                return self.downwards(&columns[k], &vec![RBig::ZERO; size]);
            }
            for l in k + 1..size {
                let factor = &matrix[k][l] / &pivot;
                if factor.is_zero() {
                    continue;
                }
                for m in 0..size {
                    let less = &factor * &matrix[k][m];
                    matrix[l][m] -= less;
                    let less = &factor * &columns[k][m];
                    columns[l][m] -= less;
                }
                let less = &factor * &linear[k];
                linear[l] -= less;
            }
            y[k] = -(&linear[k] / &pivot);
        }
        let mut point = vec![RBig::ZERO; size];
        for (column, y) in columns.iter().zip(&y) {
            for (x, c) in point.iter_mut().zip(column) {
                *x += c * y;
            }
        }
        let value = self.value(&point);
        Least::At(point, value)
    }

    /// A point with a negative value on a line on which the values have no bound below.
    fn downwards(&self, direction: &[RBig], from: &[RBig]) -> Least {
        let mut step = RBig::ONE;
        // the values grow at least as the step does, whose square passes every number
        loop {
            budget::steps(256 * direction.len() * direction.len());
            for signed in [step.clone(), -step.clone()] {
                let point: Vec<RBig> = from.iter().zip(direction).map(|(x, d)| x + &signed * d).collect();
                if self.value(&point) < RBig::ZERO {
                    return Least::Below(point);
                }
            }
            step = &step + &step;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::integer::IBig;
    use proptest::prelude::*;

    fn numbers(values: &[i64]) -> Vec<RBig> {
        values.iter().map(|value| RBig::from(*value)).collect()
    }

    fn form(matrix: &[&[i64]], linear: &[i64], constant: i64) -> Form {
        Form {
            matrix: matrix.iter().map(|row| numbers(row)).collect(),
            linear: numbers(linear),
            constant: RBig::from(constant),
        }
    }

    /// `(x - 1)^2 + (x - y)^2 - 3` is least at (1, 1); `x y` has no least value, nor has `x^2 + y`; `(x + y)^2` has one, on a line.
    #[test]
    fn least_values_by_hand() {
        let Least::At(point, value) = form(&[&[2, -1], &[-1, 1]], &[-1, 0], -2).least() else { panic!() };
        assert_eq!((point, value), (numbers(&[1, 1]), RBig::from(-3)));
        assert!(matches!(form(&[&[0, 1], &[1, 0]], &[0, 0], 7).least(), Least::Below(_)));
        assert!(matches!(form(&[&[1, 0], &[0, 0]], &[0, 1], 7).least(), Least::Below(_)));
        // on the line y = 1 it does not depend on x
        assert!(matches!(form(&[&[0, 1], &[1, 0]], &[-1, 0], 7).least(), Least::Below(_)));
        assert!(
            matches!(form(&[&[1, 1], &[1, 1]], &[0, 0], 0).least(), Least::At(_, value) if value.is_zero())
        );
    }

    proptest! {
        /// No point of a grid has a lesser value than the least one, and what is said to be negative is.
        #[test]
        fn nothing_is_less(
            entries in prop::collection::vec(-3i64..4, 10),
            points in prop::collection::vec(prop::collection::vec(-9i64..10, 3), 20),
        ) {
            let e = &entries;
            let form = form(&[&[e[0] + 2, e[1], e[2]], &[e[1], e[3] + 2, e[4]], &[e[2], e[4], e[5] + 2]], &e[6..9], e[9]);
            match form.least() {
                Least::Below(point) => prop_assert!(form.value(&point) < RBig::ZERO),
                Least::At(point, least) => {
                    prop_assert_eq!(form.value(&point), least.clone());
                    for other in &points {
                        prop_assert!(form.value(&numbers(other)) >= least);
                    }
                }
            }
        }
    }

    /// A polynomial is read as it is written: `3 x^2 - 2 x y + 5 y - 7`.
    #[test]
    fn coefficients_are_in_their_places() {
        let (x, y) = (Polynomial::variable(0), Polynomial::variable(1));
        let times = |p: &Polynomial, n: i64| p.mul(&Polynomial::integer(&IBig::from(n))).unwrap();
        let sum = times(&x.mul(&x).unwrap(), 3)
            .add(&times(&x.mul(&y).unwrap(), -2))
            .add(&times(&y, 5))
            .add(&Polynomial::integer(&IBig::from(-7)));
        // 12 - 12 + 15 - 7
        assert_eq!(Form::new(&sum, 2).value(&numbers(&[2, 3])), RBig::from(8));
    }
}
