//! From a claim to its outcome.

use super::identity::{decide_identity, decide_nearness};
use super::pole::decide_pole;
use super::ranks::{decide_codistribution, decide_rank};
use super::verdict::{Outcome, Verdict};
use crate::expression::{NodeId, Symbol};
use crate::observability::{Branch, solve_conditions};
use crate::system::{ClaimBody, ClaimSyntax, Expectation, Matrix, Statement, System, Value};
use dashu::rational::RBig;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Decides all claims of a system, several at a time; the outcomes are in the order of the file and do not depend on
/// the number of threads. Claims that were not begun when `interrupt` was set are left out.
pub fn decide_all(
    system: &System,
    seed: u64,
    interrupt: &AtomicBool,
    done: &(dyn Fn(&Outcome) + Sync),
) -> Vec<Outcome> {
    let extent = system.extent();
    // as many copies as claims are decided at once
    let copies: Mutex<Vec<System>> = Mutex::default();
    let copies = || copies.lock().unwrap_or_else(PoisonError::into_inner);
    system
        .claims
        .par_iter()
        .filter_map(|claim| {
            if interrupt.load(Ordering::Relaxed) {
                return None;
            }
            let spare = copies().pop();
            let mut copy = spare.unwrap_or_else(|| system.clone());
            let outcome = decide_in(&mut copy, claim, seed);
            copy.shrink_to(&extent);
            copies().push(copy);
            done(&outcome);
            Some(outcome)
        })
        .collect()
}

/// Decides one claim. The system is left as it was.
pub fn decide(system: &System, claim: &ClaimSyntax, seed: u64) -> Outcome {
    decide_in(&mut system.clone(), claim, seed)
}

/// Decides one claim in a system that may be added to.
fn decide_in(system: &mut System, claim: &ClaimSyntax, seed: u64) -> Outcome {
    let begin = Instant::now();
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ fingerprint(&claim.id));
    let text = |system: &System, statement: &Statement| {
        let text = system.source.get(statement.span.clone()).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let mut printed = None;
    let (statement, verdict, expected) = match &claim.body {
        ClaimBody::Claim { statement, expected } => {
            (text(system, statement), decide_statement(system, statement, &mut rng), Some(*expected))
        }
        ClaimBody::Erratum { printed: print, corrected } => {
            printed = Some((text(system, print), decide_statement(system, print, &mut rng)));
            let verdict = decide_statement(system, corrected, &mut rng);
            (text(system, corrected), verdict, Some(Expectation::Proved))
        }
        ClaimBody::Scan { repaired, .. } => {
            let verdict = decide_statement(system, repaired, &mut rng);
            (text(system, repaired), verdict, Some(Expectation::Proved))
        }
        ClaimBody::Definition { text } => (text.clone(), Verdict::Definition { text: text.clone() }, None),
        ClaimBody::Open { reason } => {
            (reason.clone(), Verdict::Undecided { why: reason.clone() }, Some(Expectation::Undecided))
        }
    };
    let print_is_wrong = printed.as_ref().is_none_or(|(_, verdict)| verdict.meets(Expectation::Refuted));
    let mentioned = format!("{statement} {}", printed.as_ref().map_or("", |(text, _)| text));
    Outcome {
        definitions: system.definitions_in(&mentioned),
        file: system.name.clone(),
        id: claim.id.clone(),
        ok: expected.is_none_or(|expected| verdict.meets(expected)) && print_is_wrong,
        statement,
        printed,
        scanned: match &claim.body {
            ClaimBody::Scan { scanned, .. } => Some(scanned.clone()),
            _ => None,
        },
        verdict,
        expected,
        remark: claim.remark.clone(),
        seconds: begin.elapsed().as_secs_f64(),
    }
}

/// A number from a name (Fowler, Noll and Vo's hash), so that each claim has random numbers of its own.
fn fingerprint(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn decide_statement(system: &mut System, statement: &Statement, rng: &mut ChaCha8Rng) -> Verdict {
    match attempt(system, statement, rng) {
        Ok(verdict) => verdict,
        Err(why) => Verdict::undecided(why),
    }
}

fn attempt(system: &mut System, statement: &Statement, rng: &mut ChaCha8Rng) -> Result<Verdict, String> {
    let equation = &statement.equation;
    let left = system.elaborate(&equation.left).map_err(|problem| problem.message)?;
    let right = system.elaborate(&equation.right).map_err(|problem| problem.message)?;
    if let Some(tolerance) = &equation.within {
        let tolerance = system.scalar(tolerance).map_err(|problem| problem.message)?;
        return match (left, right) {
            (Value::Scalar(l), Value::Scalar(r)) if statement.conditions.is_empty() => {
                Ok(decide_nearness(system, l, r, tolerance))
            }
            (Value::Scalar(_), Value::Scalar(_)) => {
                Err("'within' takes no 'where'; use 'at {...}'".to_owned())
            }
            _ => Err("'within' compares numbers".to_owned()),
        };
    }
    let point_or_branches = match (&left, &right) {
        (Value::Pole { .. }, _) | (_, Value::Pole { .. }) => None,
        _ => Some(solve_conditions(system, &statement.conditions).map_err(|unsolved| unsolved.to_string())?),
    };
    let Some(branches) = point_or_branches else {
        return pole_statement(system, statement, left, right, rng);
    };
    let verdicts: Vec<Verdict> = branches
        .iter()
        .map(|branch| on_branch(system, branch, left.clone(), right.clone(), rng))
        .collect::<Result<_, _>>()?;
    Ok(Verdict::all(verdicts))
}

fn on_branch(
    system: &mut System,
    branch: &Branch,
    left: Value,
    right: Value,
    rng: &mut ChaCha8Rng,
) -> Result<Verdict, String> {
    for value in [&left, &right] {
        let entries = match value {
            Value::Scalar(id) => vec![*id],
            Value::Matrix(m) | Value::Rank(m) => m.entries.clone(),
            Value::CodistributionRank | Value::Pole { .. } => Vec::new(),
        };
        branch.check_turns(system, &entries)?;
    }
    let (left, right) = (system.substitute(left, &branch.values), system.substitute(right, &branch.values));
    let single = |id: NodeId| Matrix { rows: 1, columns: 1, entries: vec![id] };
    match (left, right) {
        (Value::Scalar(l), Value::Scalar(r)) => Ok(decide_identity(system, &single(l), &single(r), rng)),
        (Value::Matrix(l), Value::Matrix(r)) if (l.rows, l.columns) == (r.rows, r.columns) => {
            Ok(decide_identity(system, &l, &r, rng))
        }
        (Value::Rank(m), Value::Scalar(r)) | (Value::Scalar(r), Value::Rank(m)) => {
            let claimed = claimed_integer(system, r)?;
            Ok(decide_rank(system, &m, usize::try_from(claimed).map_err(|e| e.to_string())?, rng))
        }
        (Value::CodistributionRank, Value::Scalar(r)) | (Value::Scalar(r), Value::CodistributionRank) => {
            let claimed = claimed_integer(system, r)?;
            let claimed = usize::try_from(claimed).map_err(|e| e.to_string())?;
            Ok(decide_codistribution(system, branch, claimed, rng))
        }
        (l, r) => Err(format!("{} is compared with {}", l.describe(), r.describe())),
    }
}

/// For an order of a pole the conditions are a point: `name = number`, at which the others are generic.
fn pole_statement(
    system: &mut System,
    statement: &Statement,
    left: Value,
    right: Value,
    rng: &mut ChaCha8Rng,
) -> Result<Verdict, String> {
    let (expression, factor, claimed) = match (left, right) {
        (Value::Pole { expression, factor }, Value::Scalar(n))
        | (Value::Scalar(n), Value::Pole { expression, factor }) => (expression, factor, n),
        (l, r) => return Err(format!("{} is compared with {}", l.describe(), r.describe())),
    };
    let claimed = claimed_integer(system, claimed)?;
    let mut point: HashMap<Symbol, RBig> = HashMap::new();
    for condition in &statement.conditions {
        let name = system.scalar(&condition.left).map_err(|problem| problem.message)?;
        let value = system.rational(&condition.right).map_err(|problem| problem.message)?;
        let symbol = system.graph.as_symbol(name);
        let symbol = symbol.ok_or("the conditions on a pole are of the form name = number")?;
        point.insert(symbol, value);
    }
    let claimed = i32::try_from(claimed).map_err(|e| e.to_string())?;
    Ok(decide_pole(system, expression, factor, &point, claimed, rng))
}

fn claimed_integer(system: &System, id: NodeId) -> Result<i64, String> {
    let value = system.graph.constant_value(id).ok_or("a rank or an order is compared with an integer")?;
    if !value.denominator().is_one() {
        return Err("a rank or an order is compared with an integer".to_owned());
    }
    i64::try_from(value.numerator().clone()).map_err(|e| e.to_string())
}
