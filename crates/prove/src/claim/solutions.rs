//! Claims about how many values give the same outputs: `solutions(k) = 2`, `solutions(x*y) = 1`, `solutions(b) = infinity`.
//!
//! *Proved* are a number that is bounded from above by random points modulo random primes, with an error below `2^-100`, and
//! from below by a symmetry (a bound of one needs none); and infinity, where the rank grows with the expression as an
//! output. A number that is only computed leaves the claim undecided and is given in its remark.

use super::question::claimed_integer;
use super::verdict::{Verdict, Witness};
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{Statement, System, Value};
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Guard, LOG2_ERROR, Node, NodeId};
use palmistry_rank::observability::{
    Observability, SmoothPart, Solutions, SolutionsOf, SolutionsQuestion, smooth_part, solutions,
    solve_conditions,
};

/// As much work a claim may be, in products of residues.
const WORK: u64 = 2_000_000_000;

const BASES: &str = "Groebner bases at random points of random prime fields";
const SERIES: &str = "power series at random points of random prime fields";

/// The claim: how the number of values of an expression compares with a number.
pub(super) struct Asking {
    expression: NodeId,
    relation: Relation,
    /// `None` for infinity.
    claimed: Option<usize>,
    /// Whether the expression stands on the left.
    pub is_left: bool,
}

impl Asking {
    /// The question, where one side is a number of solutions; the error is in words.
    pub fn of(
        system: &System,
        left: &Value,
        right: &Value,
        relation: Relation,
    ) -> Option<Result<Asking, String>> {
        let (expression, other, relation, is_left) = match (left, right) {
            (Value::Solutions(expression), other) => (*expression, other, relation, true),
            (other, Value::Solutions(expression)) => (*expression, other, turned(relation), false),
            _ => return None,
        };
        let claimed = match other {
            Value::Infinity => Ok(None),
            Value::Scalar(number) => claimed_integer(system, *number)
                .map_err(|_| "a number of solutions is compared with an integer or with infinity".to_owned())
                .and_then(|claimed| {
                    usize::try_from(claimed)
                        .map(Some)
                        .map_err(|_| format!("a number of solutions is never {claimed}"))
                }),
            other => Err(format!("a number of solutions is compared with {}", other.describe())),
        };
        Some(claimed.map(|claimed| Asking { expression, relation, claimed, is_left }))
    }

    /// Whether the claim holds for all numbers between two (`true`) or for none; infinity is the greatest.
    fn holds(&self, least: usize, most: usize) -> Option<bool> {
        let claimed = self.claimed.unwrap_or(usize::MAX);
        let (always, never) = match self.relation {
            Relation::Equal => (least == claimed && most == claimed, claimed < least || claimed > most),
            Relation::NotEqual => (claimed < least || claimed > most, least == claimed && most == claimed),
            Relation::AtLeast => (least >= claimed, most < claimed),
            Relation::Greater => (least > claimed, most <= claimed),
            Relation::AtMost => (most <= claimed, least > claimed),
            Relation::Less => (most < claimed, least >= claimed),
        };
        if always { Some(true) } else { never.then_some(false) }
    }
}

fn turned(relation: Relation) -> Relation {
    match relation {
        Relation::Less => Relation::Greater,
        Relation::Greater => Relation::Less,
        Relation::AtMost => Relation::AtLeast,
        Relation::AtLeast => Relation::AtMost,
        same => same,
    }
}

/// What is proved of a number of values: between which two it lies, by what, and the probability of an error.
struct Proved {
    least: usize,
    most: usize,
    engine: String,
    log2_error: f64,
}

/// Decides such a claim, of an expression that needs these guards.
///
/// # Errors
/// In words, where the number cannot be computed.
pub(super) fn decide_solutions(
    system: &mut System,
    statement: &Statement,
    asking: &Asking,
    name: String,
    guards: &[Guard],
) -> Result<Verdict, String> {
    if !statement.conditions.is_empty() || statement.on_sample || statement.except.is_some() {
        return Err("solutions are counted generically: such a claim takes no conditions".to_owned());
    }
    if !statement.further.is_empty() {
        return Err("solutions are compared with one number".to_owned());
    }
    if system.outputs.is_empty() || system.unknown_count() == 0 {
        return Err("there is nothing to count: the file declares no unknowns or no outputs".to_owned());
    }
    let initial = system.initial_conditions().to_vec();
    let branches = solve_conditions(system, &initial).map_err(|why| why.to_string())?;
    let [branch] = branches.as_slice() else {
        return Err(
            "initial conditions are given in several ways: of these no solutions are counted".to_owned()
        );
    };
    let branch = branch.clone().tied_by_outputs(system).map_err(|why| why.to_string())?;
    // what is counted holds at almost all states at which all of it is smooth: there have to be some
    match smooth_part(system, &branch, &branch.values.clone(), guards)? {
        SmoothPart::Open => {}
        SmoothPart::Thin(why) | SmoothPart::NotShown(why) => return Err(why),
    }
    // of an unknown its own values are counted: those of an angle up to whole turns
    let unknown = match system.graph.node(asking.expression) {
        Node::Symbol(symbol) => system.unknowns().iter().position(|unknown| *unknown == symbol),
        _ => None,
    };
    let expressions = match unknown {
        Some(_) => Vec::new(),
        None => vec![(name, asking.expression)],
    };
    let question = SolutionsQuestion {
        conditions: branch.values.clone(),
        expressions,
        work: WORK,
        interrupt: &UNINTERRUPTED,
    };
    let answer = solutions(system, &question).map_err(|why| why.to_string())?;
    let place = unknown.unwrap_or(answer.unknowns.len() - 1);
    let found = answer.unknowns.get(place).ok_or("there is nothing to count")?;
    let proved = proved(found, answer.is_finite_where_local);
    match asking.holds(proved.least, proved.most) {
        Some(true) => Ok(Verdict::Proved { engine: proved.engine, log2_error: proved.log2_error }),
        Some(false) => {
            let number =
                |count: usize| if count == usize::MAX { "infinity".to_owned() } else { count.to_string() };
            let left = match (proved.least, proved.most) {
                (least, most) if least == most => number(least),
                (least, usize::MAX) => format!("at least {}", number(least)),
                (1, most) if most == usize::MAX - 1 => "finite".to_owned(),
                (least, most) if most == usize::MAX - 1 => format!("finite, at least {least}"),
                (least, most) => format!("from {least} to {}", number(most)),
            };
            let right = asking.claimed.map_or_else(|| "infinity".to_owned(), |claimed| claimed.to_string());
            let (left, right) = if asking.is_left { (left, right) } else { (right, left) };
            let witness = Witness { state: Vec::new(), left, right, entry: None, refutation: None };
            Ok(Verdict::Refuted { engine: proved.engine, witness })
        }
        None => Err(open(found, answer.rounds)),
    }
}

/// What is proved, for what follows from it; `is_finite_where_local` as in the answer.
fn proved(found: &SolutionsOf, is_finite_where_local: bool) -> Proved {
    let map = found.at_least.as_ref();
    let least = map.map_or(1, |(least, _)| *least);
    let by_map = map.map(|(_, map)| format!("all outputs are the same with {map}"));
    match (found.local, found.at_most) {
        (Observability::No, _) => {
            let (engine, log2_error) = (SERIES.to_owned(), found.local_error);
            Proved { least: usize::MAX, most: usize::MAX, engine, log2_error }
        }
        (_, Some((most, log2_error))) if log2_error <= LOG2_ERROR => {
            let engine = by_map.map_or_else(|| BASES.to_owned(), |map| format!("{BASES}; {map}"));
            Proved { least, most, engine, log2_error }
        }
        (Observability::Yes, _) if is_finite_where_local => {
            let engine = by_map.unwrap_or_else(|| SERIES.to_owned());
            Proved { least, most: usize::MAX - 1, engine, log2_error: found.local_error }
        }
        (Observability::Yes | Observability::Undecided, _) => {
            let engine = by_map.unwrap_or_default();
            Proved { least, most: usize::MAX, engine, log2_error: f64::NEG_INFINITY }
        }
    }
}

/// Why it is open, with what was computed.
fn open(found: &SolutionsOf, rounds: usize) -> String {
    let most = match found.at_most {
        Some((most, _)) => format!("; that there are no more than {most} is proved"),
        None => String::new(),
    };
    let least = match &found.at_least {
        Some((least, map)) => format!("; that there are at least {least} is proved, by {map}"),
        None => String::new(),
    };
    match &found.solutions {
        Solutions::Finite(count) => {
            format!(
                "{count} over the complex numbers, computed modulo {rounds} primes at random points{most}{least}"
            )
        }
        Solutions::Undecided(why) => format!("{why}{least}"),
        Solutions::Infinite => "infinitely many".to_owned(),
    }
}
