//! Ways to the entries that vary, over any numbers: programs, and rows one after the other.

use super::combination::Derivative;
use super::programs::RowPlan;
use super::work::{Work, inputs};
use crate::tradeoff::differences::{Differences, FiniteDifference};
use dashu::rational::RBig;
use palmistry_math::expression::Program;
use palmistry_math::number::{Arithmetic, RealNumber, Refusal};
use std::ops::Range;

/// Computes the entries that vary at some of the states, and hands them over one state after the other; `None` where
/// there are none.
pub(super) type Way<'w, N> = Box<dyn Fn(Range<usize>, &mut dyn FnMut(Option<&[N]>)) + Send + Sync + 'w>;

/// A way, or why it is not possible here.
pub(super) type Possible<'w, N> = Result<Way<'w, N>, String>;

/// A straight-line program, state by state.
///
/// # Errors
/// In words, where a constant or an input has no image, or a function no value.
pub(super) fn program<'w, A>(
    work: &Work,
    program: &'w Program,
    arithmetic: A,
) -> Result<Way<'w, A::Number>, String>
where
    A: Arithmetic + Send + Sync + 'w,
    A::Number: Send + Sync,
{
    let inputs = inputs(work, program, &arithmetic)?;
    let loaded = program.load(arithmetic).map_err(|refusal| refusal.to_string())?;
    // what these numbers cannot do at all they cannot do at the first state either
    if let Some(Err(failure)) = inputs.first().map(|input| loaded.run(input, &mut Vec::new()))
        && matches!(failure.refusal, Refusal::NoExactValue(_) | Refusal::NoExactPi)
    {
        return Err(failure.refusal.to_string());
    }
    Ok(Box::new(move |states, sink| {
        let mut registers = Vec::new();
        for input in &inputs[states] {
            sink(loaded.run(input, &mut registers).ok().as_deref());
        }
    }))
}

/// The programs of all forms that an expression can have.
pub(super) fn programs<'w, A>(work: &'w Work, arithmetic: A) -> Vec<(Derivative, Possible<'w, A::Number>)>
where
    A: Arithmetic + Clone + Send + Sync + 'w,
    A::Number: Send + Sync,
{
    let forms = [
        (Derivative::Graph, Ok(&work.programs.graph)),
        (Derivative::Series, work.programs.series.as_ref()),
        (Derivative::Expanded, work.programs.expanded.as_ref()),
    ];
    let way = |form: Result<&'w Program, &String>| match form {
        Ok(form) => program(work, form, arithmetic.clone()),
        Err(why) => Err(why.clone()),
    };
    forms.into_iter().map(|(derivative, form)| (derivative, way(form))).collect()
}

/// The points of all states in numbers made from the ends of enclosures.
pub(super) fn points<N>(work: &Work, number: impl Fn(&RBig, &RBig) -> N) -> Vec<Vec<N>> {
    let point = |values: &Vec<(RBig, RBig)>| values.iter().map(|(low, high)| number(low, high)).collect();
    work.points.iter().map(point).collect()
}

/// Row after row by a function that takes the fields of a Lie derivative, its output, and a point.
pub(super) fn rows<'w, N: Clone + Send + Sync + 'w>(
    plan: &'w RowPlan,
    points: Vec<Vec<N>>,
    differential: impl Fn(&[usize], usize, &[N]) -> Result<Vec<N>, Refusal> + Send + Sync + 'w,
) -> Way<'w, N> {
    Box::new(move |states, sink| {
        for point in &points[states] {
            let rows = plan.rows.iter().map(|(fields, output)| differential(fields, *output, point));
            match rows.collect::<Result<Vec<Vec<N>>, Refusal>>() {
                Ok(rows) => {
                    let picks = plan.picks.iter().map(|(row, column)| rows[*row][*column].clone());
                    sink(Some(&picks.collect::<Vec<N>>()));
                }
                Err(_) => sink(None),
            }
        }
    })
}

/// Nested differences; the middle of an enclosed angle is taken.
///
/// # Errors
/// In words: rows that are no differentials of Lie derivatives, constants without an image.
pub(super) fn differences<'w, T: RealNumber>(
    work: &'w Work,
    difference: FiniteDifference,
    spacing: f64,
) -> Result<Way<'w, T>, String> {
    let plan = work.programs.plan.as_ref().map_err(Clone::clone)?;
    let middle = |low: &RBig, high: &RBig| T::from_rational(&((low + high) / RBig::from(2)));
    let differences = Differences::<T>::new(&work.programs.points, difference, spacing)
        .map_err(|refusal| refusal.to_string())?;
    Ok(rows(plan, points(work, middle), move |word, output, point| {
        differences.differential(word, output, point)
    }))
}
