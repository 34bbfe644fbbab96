//! Does an inequality hold wherever others do?
//!
//! Four ways, one after the other. Signs that can be read off ([`palmistry_math::expression::sign`]); the signs of polynomial
//! factors, by their coefficients or as sums of squares (`factors`, `squares`), for all states; in one variable the zeros of all
//! polynomials (`line`), and of degree two the matrix (`quadric`), which decide completely and propose states at which the
//! inequality fails; and branch and bound in interval arithmetic on a box (`boxes`), which proposes such states too.
//!
//! This module knows expressions and their domains, and nothing of claims or systems.

#![warn(missing_docs)]

mod bounds;
mod boxes;
mod crossing;
mod domain_intervals;
mod factors;
mod line;
mod quadric;
mod reading;
mod semidefinite;
mod space;
mod squares;
mod touch;

#[doc(hidden)]
pub use bounds::{Bound, Bounds, SymbolBounds, bounds};
#[doc(hidden)]
pub use boxes::Proposed;
#[doc(hidden)]
pub use crossing::vanishes_somewhere;
#[doc(hidden)]
pub use line::{Irrational, IrrationalPlace};

use bounds::known_signs;
use palmistry_math::expression::{Graph, Guard, Need, NodeId, Sign, Symbol, sign_given};
use palmistry_math::number::Interval;
use std::collections::HashMap;

/// What may be taken to hold, and where terms exist.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given<'g> {
    /// Inequalities.
    pub assumed: &'g [Guard],
    /// Expressions that vanish.
    pub equations: &'g [NodeId],
    /// What the terms need to exist; nothing is asked about states at which they do not.
    pub exists: &'g [Guard],
}

/// What a proof by signs may use: inequalities, and expressions that vanish.
#[derive(Clone, Copy, Debug, Default)]
struct Premises<'g> {
    assumed: &'g [Guard],
    equations: &'g [NodeId],
}

/// What follows from the premises alone.
#[derive(Clone, Copy, Debug)]
struct Known<'k> {
    bounds: &'k Bounds,
    signs: &'k HashMap<NodeId, Sign>,
}

/// The result for a goal.
#[derive(Clone, Debug)]
pub enum InequalityAnswer {
    /// It holds wherever it exists and what is given holds; by this argument.
    Holds(Argument),
    /// A proposed state was taken as a counterexample.
    Fails,
    /// It fails at this irrational value of a symbol, where all premises hold.
    FailsAt(IrrationalPlace),
    /// It is not decided.
    Open(Open),
}

/// Why a goal holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// The signs of factors, some of them sums of squares.
    Signs,
    /// All zeros of the polynomials in one variable, between which nothing changes.
    Zeros,
    /// The matrix of a polynomial of degree two, by elimination.
    Matrix,
    /// Interval arithmetic on so many boxes, and whether it is met with equality somewhere: that derivatives vanish there was
    /// found by exact arithmetic at random points, and may be wrong with a probability below 2^-100.
    Boxes {
        /// So many boxes.
        boxes: usize,
        /// Whether some of them hold a place where the sides touch.
        touches: bool,
    },
}

/// Where a goal is open.
#[derive(Clone, Debug)]
pub struct Open {
    /// The part of the volume; of unbounded coordinates, of their angles.
    pub share: f64,
    /// One of the open boxes.
    pub sample: Vec<(Symbol, Interval)>,
    /// So many boxes were looked at.
    pub boxes: usize,
}

/// Decides a goal. `refutes` is shown states at which it seems to fail, and says whether one is a counterexample.
pub fn decide(
    graph: &mut Graph,
    goal: Guard,
    given: Given<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
    refutes: &mut dyn FnMut(&mut Graph, &Proposed) -> bool,
) -> InequalityAnswer {
    // where terms exist is as good as what is assumed
    let all: Vec<Guard> = given.assumed.iter().chain(given.exists).copied().collect();
    let bounds = bounds(graph, &all);
    let premises = Premises { assumed: &all, equations: given.equations };
    if by_signs(graph, goal, premises, &bounds, is_angle) {
        return InequalityAnswer::Holds(Argument::Signs);
    }
    if let Some(answer) = completely(graph, goal, premises, is_angle, &bounds, refutes) {
        return answer;
    }
    let question = boxes::Question {
        goal,
        assumed: given.assumed,
        equations: given.equations,
        exists: given.exists,
        bounds: &bounds,
    };
    match boxes::search(graph, &question, is_angle, refutes) {
        boxes::Found::Holds { boxes, touches } => InequalityAnswer::Holds(Argument::Boxes { boxes, touches }),
        boxes::Found::Fails => InequalityAnswer::Fails,
        boxes::Found::Open { share, sample, boxes } => InequalityAnswer::Open(Open { share, sample, boxes }),
    }
}

/// Whether signs and sums of squares alone show that a goal holds.
pub fn holds_by_signs(
    graph: &mut Graph,
    goal: Guard,
    given: Given<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
) -> bool {
    let all: Vec<Guard> = given.assumed.iter().chain(given.exists).copied().collect();
    let bounds = bounds(graph, &all);
    let premises = Premises { assumed: &all, equations: given.equations };
    by_signs(graph, goal, premises, &bounds, is_angle)
        || completely(graph, goal, premises, is_angle, &bounds, &mut |_, _| false)
            .is_some_and(|answer| matches!(answer, InequalityAnswer::Holds(_)))
}

/// Whether guards that are about one variable all hold somewhere; `None` where they are about more, or that is not decided.
pub fn hold_somewhere(
    graph: &mut Graph,
    guards: &[Guard],
    is_angle: &dyn Fn(Symbol) -> bool,
) -> Option<bool> {
    let bounds = bounds(graph, guards);
    let signs = known_signs(graph, guards, &bounds);
    let premises = Premises { assumed: guards, equations: &[] };
    line::somewhere(graph, premises, is_angle, Known { bounds: &bounds, signs: &signs })
}

/// What the ways say that decide completely, in one variable and in degree two.
fn completely(
    graph: &mut Graph,
    goal: Guard,
    premises: Premises<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
    bounds: &Bounds,
    refutes: &mut dyn FnMut(&mut Graph, &Proposed) -> bool,
) -> Option<InequalityAnswer> {
    let signs = known_signs(graph, premises.assumed, bounds);
    let known = Known { bounds, signs: &signs };
    match line::on_a_line(graph, goal, premises, is_angle, known) {
        Some(line::OnALine::Holds) => return Some(InequalityAnswer::Holds(Argument::Zeros)),
        Some(line::OnALine::Fails(places)) => {
            for place in places {
                match place {
                    line::FailingPlace::At(place) => return Some(InequalityAnswer::FailsAt(place)),
                    line::FailingPlace::Between(state) if refutes(graph, &state) => {
                        return Some(InequalityAnswer::Fails);
                    }
                    line::FailingPlace::Between(_) => {}
                }
            }
        }
        None => {}
    }
    match quadric::of_degree_two(graph, goal, is_angle, known) {
        Some(quadric::Quadric::Holds) => Some(InequalityAnswer::Holds(Argument::Matrix)),
        Some(quadric::Quadric::Fails(state)) if refutes(graph, &state) => Some(InequalityAnswer::Fails),
        _ => None,
    }
}

/// Whether a sign is what is needed.
fn tells(need: Need, sign: Sign) -> bool {
    match need {
        Need::NotZero => sign.is_strict(),
        Need::Positive => sign == Sign::Positive,
        Need::NotNegative => sign.is_upward(),
        Need::WithinOne | Need::InsideOne => false,
    }
}

/// Whether signs show that a goal holds.
fn by_signs(
    graph: &mut Graph,
    goal: Guard,
    premises: Premises<'_>,
    bounds: &Bounds,
    is_angle: &dyn Fn(Symbol) -> bool,
) -> bool {
    if goal.is_obvious(graph) == Some(true) {
        return true;
    }
    let signs = known_signs(graph, premises.assumed, bounds);
    sign_given(graph, goal.node, &signs).is_some_and(|sign| tells(goal.need, sign))
        || factors::tell(graph, goal, premises, is_angle, Known { bounds, signs: &signs })
}
