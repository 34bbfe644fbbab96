//! The differential of a Lie derivative by num-dual's dual numbers, one within the other: each field is a
//! level, and at the bottom is a vector of partial derivatives. The types are fixed when this is compiled, so that
//! nothing is allocated on the way, and the order can be no higher than there are types for.

use super::ways::{Way, points, rows};
use super::work::Work;
use crate::tradeoff::point_programs::{LoadedPoints, PointPrograms};
use dashu::rational::RBig;
use nalgebra::{Const, SVector};
use num_dual::{Derivative, Dual, DualNum, DualSVec};
use palmistry_math::number::{Differentiable, Duals, RealNumber, Refusal};

/// So many partial derivatives are taken at once.
const WIDTH: usize = 4;
/// The highest order for which there are types.
const LONGEST: usize = 3;

/// Takes Lie derivatives at points of numbers `D`.
trait Levels<D> {
    fn lie_derivative(&self, word: &[usize], function: usize, point: &[D]) -> Result<D, Refusal>;
}

/// The last level: functions alone.
struct Last<'p, D: Differentiable> {
    points: LoadedPoints<'p, Duals<D>>,
}

/// A level below which there is another one of dual numbers over these.
struct Level<'p, D: Differentiable, L> {
    points: LoadedPoints<'p, Duals<D>>,
    next: L,
}

impl<D: Differentiable> Levels<D> for Last<'_, D> {
    fn lie_derivative(&self, word: &[usize], function: usize, point: &[D]) -> Result<D, Refusal> {
        if word.is_empty() { self.points.function(function, point) } else { Err(Refusal::TooLarge) }
    }
}

impl<D: Differentiable, L: Levels<Dual<D>>> Levels<D> for Level<'_, D, L> {
    fn lie_derivative(&self, word: &[usize], function: usize, point: &[D]) -> Result<D, Refusal> {
        let Some((field, rest)) = word.split_first() else {
            return self.points.function(function, point);
        };
        let (places, rates) = self.points.rates(*field, point)?;
        let mut moved: Vec<Dual<D>> = point.iter().map(|value| Dual::from_re(value.clone())).collect();
        for (place, rate) in places.iter().zip(rates) {
            moved[*place] = Dual::new(point[*place].clone(), rate);
        }
        Ok(self.next.lie_derivative(rest, function, &moved)?.eps)
    }
}

type Vector<T> = DualSVec<T, WIDTH>;
type Third<'p, D> = Last<'p, Dual<Dual<Dual<D>>>>;
type Second<'p, D> = Level<'p, Dual<Dual<D>>, Third<'p, D>>;
type First<'p, D> = Level<'p, Dual<D>, Second<'p, D>>;
type Bottom<'p, D> = Level<'p, D, First<'p, D>>;

fn load<D: Differentiable>(points: &PointPrograms) -> Result<Bottom<'_, D>, Refusal> {
    let third = Last { points: points.load(Duals::default())? };
    let second = Level { points: points.load(Duals::default())?, next: third };
    let first = Level { points: points.load(Duals::default())?, next: second };
    Ok(Level { points: points.load(Duals::default())?, next: first })
}

/// Dual numbers over `T`; `number` makes one from the ends of an enclosure.
///
/// # Errors
/// In words: rows that are no differentials of Lie derivatives, orders that are too high, constants without an image.
pub(super) fn duals<'w, T>(work: &'w Work, number: impl Fn(&RBig, &RBig) -> T) -> Result<Way<'w, T>, String>
where
    T: RealNumber + DualNum,
{
    let plan = work.programs.plan.as_ref().map_err(Clone::clone)?;
    if plan.rows.iter().any(|(fields, _)| fields.len() > LONGEST) {
        return Err(format!("there are types for Lie derivatives up to order {LONGEST}"));
    }
    let programs = &work.programs.points;
    let levels = load::<Vector<T>>(programs).map_err(|refusal| refusal.to_string())?;
    let states = programs.states();
    Ok(rows(plan, points(work, number), move |word, output, point| {
        let mut row = Vec::with_capacity(states.len());
        for chunk in states.chunks(WIDTH) {
            let mut seeded: Vec<Vector<T>> = point.iter().map(|value| Vector::from_re(*value)).collect();
            for (unit, place) in chunk.iter().enumerate() {
                let mut direction = SVector::<T, WIDTH>::from_element(T::zero());
                direction[unit] = T::one();
                seeded[*place].eps = Derivative::some(direction);
            }
            let slope = levels.lie_derivative(word, output, &seeded)?.eps;
            let slope = slope.unwrap_generic(Const::<WIDTH>, Const::<1>);
            row.extend(slope.iter().take(chunk.len()).copied());
        }
        Ok(row)
    }))
}
