//! How many values of an unknown give the same outputs: one, finitely many, infinitely many.
//!
//! The outputs of almost every state, as functions of time and of known inputs, are met by the states and constants of a
//! *fibre*. At a random point modulo a random prime
//! its equations are written down: `Q x' = P` and the outputs, differentiated along time as often as determines all, or some times more
//! ([`round`]), with the derivatives of the outputs that the point has. Unknowns that are not even locally identifiable are fixed as far as
//! needed to make the fibre finite, which does not change the number of values of the others. What can be solved is solved ([`eliminate`]), of
//! the rest a Groebner basis is found ([`basis`]), and each unknown's minimal polynomial in the quotient algebra ([`quotient`]): the number of
//! its distinct roots is that of the values, over the complex numbers.
//!
//! That there are no more values than were met is as certain as [`bound`] says, and for small systems that is beyond doubt. That there
//! are as many is shown by a symmetry ([`discrete`]), or computed.
//!
//! References: H. Hong, A. Ovchinnikov, G. Pogudin and C. Yap, *Global identifiability of differential models*, Comm. Pure Appl. Math. 73
//! (2020), for the fibre at a random point, and for the orders; A. Ovchinnikov, G. Pogudin and P. Thompson, *Parameter
//! identifiability and input-output
//! equations*, AAECC 34 (2023), for what it means.

mod basis;
mod bound;
mod count;
mod discrete;
mod eliminate;
mod exact;
mod jets;
mod mirror;
mod model;
mod monomials;
mod point;
mod quotient;
mod rational_form;
mod round;
mod second;
mod slice;
#[cfg(test)]
mod tests;

use super::Frame;
use super::driven::{Driven, driven, told_constants};
use super::generic::{GenericAnswer, Observability, sum_of_errors};
use super::needed::CodistributionError;
use count::count;
use dashu::rational::RBig;
use discrete::{Exchange, exchanges, in_words, values_of_expression, values_of_variable};
pub use mirror::{Image, Mirror, mirrors};
use model::Model;
use palmistry_lang::{Assignment, System, UnknownKind};
use palmistry_math::expression::{Node, NodeId, expand_angles};
use palmistry_math::number::Function;
pub(super) use slice::{SlicedVariable, Slicer};
use std::collections::HashSet;
use std::sync::atomic::AtomicBool;

/// How many values give the same outputs, at almost all states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Solutions {
    /// So many, over the complex numbers.
    Finite(usize),
    /// Infinitely many, in any neighbourhood.
    Infinite,
    /// It is not known, and this is why.
    Undecided(String),
}

/// What is known of the values of one unknown, or of one expression.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionsOf {
    /// Its name, or the expression.
    pub name: String,
    /// What it is; none for an expression.
    pub kind: Option<UnknownKind>,
    /// Whether it is locally observable.
    pub local: Observability,
    /// The probability of an error in that, as a power of two.
    pub local_error: f64,
    /// What was found.
    pub solutions: Solutions,
    /// No more values than these, error probability below two to this power; nothing where there is no bound below `2^-100`.
    pub at_most: Option<(usize, f64)>,
    /// As many values at least, and a map of the unknowns that shows it: proved, without an error.
    pub at_least: Option<(usize, String)>,
}

impl SolutionsOf {
    /// Whether it is proved that there are so many values and no more, or infinitely many.
    pub fn is_proved(&self) -> bool {
        match self.solutions {
            Solutions::Infinite => true,
            Solutions::Finite(count) => {
                let least = self.at_least.as_ref().map_or(1, |(least, _)| *least);
                self.at_most.is_some_and(|(most, _)| most == count) && least == count
            }
            Solutions::Undecided(_) => false,
        }
    }
}

/// Two sets of states and constants at which the outputs have the same derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondPoint {
    /// Name, value at the one and value at the other point, of all that the file declares.
    pub values: Vec<(String, RBig, RBig)>,
    /// Up to this order the derivatives of all outputs are equal, in exact arithmetic.
    pub order: usize,
}

/// What is known of the values of all unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolutionsAnswer {
    /// The unknowns in the order of the file, then the expressions.
    pub unknowns: Vec<SolutionsOf>,
    /// At how many random points, each modulo a random prime.
    pub rounds: usize,
    /// How many derivatives of each output were taken.
    pub orders: Vec<usize>,
    /// How many states and constants give the same outputs, with those fixed that are not locally observable.
    pub points: Option<usize>,
    /// How much work it was, in products of residues.
    pub work: u64,
    /// Two points with the same outputs, in exact numbers, where there are just two and no symmetry shows it.
    pub second: Option<SecondPoint>,
    /// Whether initial conditions are given, so that further derivatives might be informative.
    pub orders_are_open: bool,
    /// Whether what is observable locally has finitely many values: where no sine or cosine is taken of an unknown that is no angle.
    pub is_finite_where_local: bool,
}

/// What is asked.
pub struct SolutionsQuestion<'a> {
    /// Fixed values and given initial conditions.
    pub conditions: Assignment,
    /// Expressions beside the unknowns.
    pub expressions: Vec<(String, NodeId)>,
    /// How much work may be done, in products of residues.
    pub work: u64,
    /// Set from outside to stop early.
    pub interrupt: &'a AtomicBool,
}

/// Work for about a minute.
pub const WORK: u64 = 15_000_000_000;

/// How many values of each unknown give the same outputs.
///
/// # Errors
/// In words, where nothing can be asked; and as for the rank.
pub fn solutions(
    system: &mut System,
    question: &SolutionsQuestion,
) -> Result<SolutionsAnswer, CodistributionError> {
    solutions_telling(system, question, &mut |_| ())
}

/// The same; `known` is called with what is known before anything is counted: which unknowns have infinitely many values, then what symmetries
/// show.
///
/// # Errors
/// As for [`solutions`].
pub fn solutions_telling(
    system: &mut System,
    question: &SolutionsQuestion,
    known: &mut dyn FnMut(SolutionsAnswer),
) -> Result<SolutionsAnswer, CodistributionError> {
    let frame = Frame::new(system, &question.conditions)?;
    let generic = frame.generic.clone();
    let unknowns = system.unknowns();
    let mut found: Vec<SolutionsOf> = Vec::new();
    for symbol in &unknowns {
        let local = generic
            .unknowns
            .iter()
            .find(|(other, _)| other == symbol)
            .map_or(Observability::Undecided, |(_, seen)| *seen);
        found.push(SolutionsOf {
            name: system.symbol_name(*symbol).to_owned(),
            kind: system.unknown_kind(*symbol),
            local,
            local_error: generic.log2_error,
            solutions: Solutions::Undecided(String::new()),
            at_most: None,
            at_least: None,
        });
    }
    // at the time at which they are asked for: an initial condition that is known is known then alone
    let (of_functions, locals) = frame.functions(system, &question.conditions, &expressions(question));
    for ((name, _), local) in question.expressions.iter().zip(locals) {
        let local_error = sum_of_errors(generic.log2_error, of_functions.log2_error);
        let solutions = Solutions::Undecided(String::new());
        found.push(SolutionsOf {
            name: name.clone(),
            kind: None,
            local,
            local_error,
            solutions,
            at_most: None,
            at_least: None,
        });
    }
    let mut answer = SolutionsAnswer {
        unknowns: found,
        rounds: 0,
        orders: Vec::new(),
        points: None,
        work: 0,
        second: None,
        orders_are_open: false,
        is_finite_where_local: has_finite_fibres(system, question),
    };
    let mut tell = |answer: &SolutionsAnswer| {
        let mut so_far = answer.clone();
        conclude(&mut so_far, &Err("it was interrupted".to_owned()), &generic);
        known(so_far);
    };
    tell(&answer);
    let counted = match Model::new(system, &question.conditions, &expressions(question)) {
        Ok(model) => {
            by_symmetry(&model, &mut answer);
            tell(&answer);
            count(system, &model, question, &mut answer)
        }
        Err(why) => rational_form::count_in_rational_form(system, question, &mut answer)
            .map_err(|reason| reason.unwrap_or(why)),
    };
    conclude(&mut answer, &counted, &generic);
    Ok(answer)
}

/// What follows for each unknown from its local observability and from what was counted.
fn conclude(answer: &mut SolutionsAnswer, counted: &Result<(), String>, generic: &GenericAnswer) {
    for of_it in &mut answer.unknowns {
        match (of_it.local, counted) {
            // that few values were met where it was fixed is no bound: there are infinitely many
            (Observability::No, _) => (of_it.solutions, of_it.at_most) = (Solutions::Infinite, None),
            (Observability::Undecided, _) => {
                let why = generic
                    .open
                    .clone()
                    .unwrap_or_else(|| "it is not known whether it is observable locally".to_owned());
                (of_it.solutions, of_it.at_most) = (Solutions::Undecided(why), None);
            }
            (Observability::Yes, Err(why)) => {
                (of_it.solutions, of_it.at_most) = (Solutions::Undecided(why.clone()), None);
            }
            (Observability::Yes, Ok(())) => {
                let least = of_it.at_least.as_ref().map_or(1, |(least, _)| *least);
                if matches!(of_it.solutions, Solutions::Finite(count) if count < least) {
                    // one of the two is wrong, and neither is believed
                    let why = "the random points have fewer values than a symmetry shows".to_owned();
                    (of_it.solutions, of_it.at_most, of_it.at_least) =
                        (Solutions::Undecided(why), None, None);
                }
            }
        }
    }
}

/// Whether points of a generic fibre that are apart from each other are finitely many: where no sine or cosine is taken of an unknown that is no
/// angle. Then rates and outputs are algebraic on the line and on the circle, or made of exponentials, logarithms, roots and arcs besides,
/// whose sets have finitely many components (A. Wilkie, *Model completeness results for expansions of the ordered field of real numbers by
/// restricted Pfaffian functions and the exponential function*, J. Amer. Math. Soc. 9, 1996). With `x' = sin(k)` all `k + 2*pi*n` are values of `k`.
fn has_finite_fibres(system: &System, question: &SolutionsQuestion) -> bool {
    let mut graph = system.graph.clone();
    let Driven { rates, .. } = driven(system, &mut graph);
    let mut roots: Vec<NodeId> = rates.into_iter().map(|(_, rate)| rate).collect();
    roots.extend(system.outputs.iter().map(|(_, node)| *node));
    roots.extend(expressions(question));
    let fixed = told_constants(system, &graph, &question.conditions);
    let roots = graph.substitute(&roots, &fixed);
    let roots = expand_angles(&mut graph, &roots, |symbol| system.is_angle(symbol));
    let unknowns = system.unknowns();
    // an angle that is a number too is none
    let (mut turned, mut bare, mut has_other) = (HashSet::new(), HashSet::new(), false);
    let (mut waiting, mut met) = (roots, HashSet::new());
    while let Some(node) = waiting.pop().filter(|_| !has_other) {
        if !met.insert(node) {
            continue;
        }
        match graph.node(node) {
            Node::Apply(Function::Sin | Function::Cos, argument) => match graph.node(argument) {
                Node::Symbol(symbol) if system.is_angle(symbol) => {
                    turned.insert(symbol);
                }
                _ => has_other = graph.symbols_of([argument]).iter().any(|symbol| unknowns.contains(symbol)),
            },
            Node::Symbol(symbol) if system.is_angle(symbol) => {
                bare.insert(symbol);
            }
            other => waiting.extend(other.operands()),
        }
    }
    !has_other && turned.is_disjoint(&bare)
}

fn expressions(question: &SolutionsQuestion) -> Vec<NodeId> {
    question.expressions.iter().map(|(_, node)| *node).collect()
}

/// Fills in what symmetries show.
fn by_symmetry(model: &Model, answer: &mut SolutionsAnswer) {
    let exchanges = exchanges(model);
    let of_unknowns = model.unknowns.len();
    for (number, of_it) in answer.unknowns.iter_mut().enumerate() {
        if of_it.local != Observability::Yes {
            continue;
        }
        let values = |maps: &[Exchange]| match model.unknowns.get(number) {
            Some((_, places)) => places.first().map_or(1, |place| values_of_variable(maps, *place)),
            None => model
                .asked
                .get(number - of_unknowns)
                .map_or(1, |asked| values_of_expression(model, maps, asked)),
        };
        let count = values(&exchanges);
        // of all maps that change it one that changes little besides
        let changing = exchanges.iter().filter(|map| values(std::slice::from_ref(map)) > 1);
        if let Some(map) = changing.min_by_key(|map| map.size()) {
            of_it.at_least = Some((count, in_words(model, map)));
        }
    }
}
