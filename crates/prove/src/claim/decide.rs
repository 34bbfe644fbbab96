//! From a claim to its outcome.

use super::branches::{Asked, Size, together};
use super::defaults::at_the_files_values;
use super::evidence::{Kept, Nearness, nearness};
use super::existence::{Existence, existence};
use super::identity::{OnOneBranch, decide_nearness};
use super::isolated::{lost, paid};
use super::pole::decide_pole;
use super::question::{Question, claimed_integer, guards_of_conditions, sample_box};
use super::solutions::{Asking, decide_solutions};
use super::terms::{OnBranch, Terms};
use super::verdict::{Outcome, Verdict, Witness};
use super::visible::smooth;
use dashu::rational::RBig;
use palmistry_budget::OF_A_QUESTION;
use palmistry_checker::{ClaimParts, Evidence, RecordedWord, VerdictRecord, source_digest};
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{Basis, ClaimBody, ClaimSyntax, Expectation, Statement, System, Value, in_one_line};
use palmistry_math::expression::syntax::{Equation, Expr, Relation};
use palmistry_math::expression::{Symbol, add_guard};
use palmistry_rank::observability::{Branch, solve};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Decides all claims of a system, in the order of the file, as [`decide_all`] does with the seed 1 and without an
/// interrupt.
pub fn prove(system: &System) -> Vec<Outcome> {
    decide_all(system, 1, &UNINTERRUPTED, &|_| ())
}

/// Decides all claims of a system, several at a time; the outcomes are in the order of the file and do not depend on
/// the number of threads. Claims that were not begun when `interrupt` was set are left out.
pub fn decide_all(
    system: &System,
    seed: u64,
    interrupt: &AtomicBool,
    done: &(dyn Fn(&Outcome) + Sync),
) -> Vec<Outcome> {
    decide_all_keeping(Kept::Verdicts, system, seed, interrupt, done)
}

/// The same; also keeps what the verdicts rest on if asked to.
pub fn decide_all_keeping(
    kept: Kept,
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
            let copy = spare.unwrap_or_else(|| system.clone());
            let (outcome, copy) = decide_apart(copy, (system, claim), seed, kept);
            if let Some(mut copy) = copy {
                copy.shrink_to(&extent);
                copies().push(copy);
            }
            done(&outcome);
            Some(outcome)
        })
        .collect()
}

/// Decides one claim. The system is left as it was.
pub fn decide(system: &System, claim: &ClaimSyntax, seed: u64) -> Outcome {
    decide_apart(system.clone(), (system, claim), seed, Kept::Verdicts).0
}

/// Decides one claim in a copy of its system, which is given back unless the decision has panicked: its state is unknown then.
fn decide_apart(
    mut copy: System,
    (system, claim): (&System, &ClaimSyntax),
    seed: u64,
    kept: Kept,
) -> (Outcome, Option<System>) {
    let begin = Instant::now();
    let allowed = OF_A_QUESTION;
    #[cfg(test)]
    let allowed = match claim.id == super::isolated::IS_POOR {
        true => palmistry_budget::Allowance { steps: 500, ..allowed },
        false => allowed,
    };
    let decided = paid(allowed, move || {
        let outcome = decide_in(&mut copy, claim, seed, kept);
        (outcome, copy)
    });
    match decided {
        Ok((outcome, copy)) => (outcome, Some(copy)),
        Err(why) => (lost(system, claim, why, begin.elapsed().as_secs_f64()), None),
    }
}

/// Decides one claim in a system that may be added to.
fn decide_in(system: &mut System, claim: &ClaimSyntax, seed: u64, kept: Kept) -> Outcome {
    #[cfg(test)]
    assert!(claim.id != super::isolated::PANICS, "as a test asks");
    let begin = Instant::now();
    // of what is said and not of its name: a claim that is renamed or moved keeps its verdict
    let own = fingerprint(&said(system, claim));
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ own);
    let system_name = system.name.clone();
    let text = |system: &System, statement: &Statement| in_one_line(&system.source, &statement.span);
    // other random numbers than those of the verdict: that one stays what it is whatever the file's values are
    let mut again = ChaCha8Rng::seed_from_u64(seed ^ own ^ 1);
    let mut special = |system: &mut System, statement: &Statement, verdict: &Verdict| {
        at_the_files_values(system, statement, verdict, |system, special| {
            decide_statement(system, special, Kept::Verdicts, &mut again).verdict
        })
    };
    let mut at_files_values = None;
    let mut printed_at_files_values = None;
    let mut printed = None;
    let (mut domain, mut beside, mut not_looked_at) = (Vec::new(), Vec::new(), Vec::new());
    let mut evidence = Vec::new();
    let digest = if kept == Kept::Evidence { source_digest(&system.source) } else { String::new() };
    let mut known = |decided: Decided, text: &str, suffix: &str| {
        domain = decided.domain;
        beside = decided.beside;
        let refuted = matches!(decided.verdict, Verdict::Refuted { .. });
        not_looked_at = decided.not_looked_at;
        let records = decided.evidence.into_iter().map(|evidence| VerdictRecord {
            file: system_name.clone(),
            digest: digest.clone(),
            id: format!("{}{suffix}", claim.id),
            statement: text.to_owned(),
            asked: ClaimParts::of(text),
            verdict: if refuted { RecordedWord::Refuted } else { RecordedWord::Proved },
            evidence,
        });
        evidence.extend(records);
        decided.verdict
    };
    let (statement, verdict, expected) = match &claim.body {
        ClaimBody::Claim { statement, expected } => {
            let text = text(system, statement);
            let verdict = known(decide_statement(system, statement, kept, &mut rng), &text, "");
            at_files_values = special(system, statement, &verdict);
            (text, verdict, Some(*expected))
        }
        ClaimBody::Erratum { printed: print, corrected, .. } => {
            let as_printed = text(system, print);
            let wrong = decide_statement(system, print, kept, &mut rng);
            let refuted = known(wrong, &as_printed, " as printed");
            printed_at_files_values = special(system, print, &refuted);
            printed = Some((as_printed, refuted));
            let text = text(system, corrected);
            let verdict = known(decide_statement(system, corrected, kept, &mut rng), &text, " corrected");
            at_files_values = special(system, corrected, &verdict);
            (text, verdict, Some(Expectation::Proved))
        }
        ClaimBody::Scan { repaired, .. } => {
            let text = text(system, repaired);
            let verdict = known(decide_statement(system, repaired, kept, &mut rng), &text, "");
            at_files_values = special(system, repaired, &verdict);
            (text, verdict, Some(Expectation::Proved))
        }
        ClaimBody::Definition { text } => (text.clone(), Verdict::Definition { text: text.clone() }, None),
        ClaimBody::Open { reason } => {
            (reason.clone(), Verdict::Undecided { why: reason.clone() }, Some(Expectation::Undecided))
        }
    };
    let basis = match (&claim.basis, &claim.body, &verdict) {
        (Basis::Derived, ClaimBody::Claim { statement, .. }, Verdict::Proved { .. })
            if system.says_one_thing_twice(statement) =>
        {
            Basis::Restates(Vec::new())
        }
        (basis, ..) => basis.clone(),
    };
    let print_is_wrong = printed.as_ref().is_none_or(|(_, verdict)| verdict.meets(Expectation::Refuted));
    let explanations = system.explanations(&claim.body);
    Outcome {
        definitions: explanations.definitions,
        differentiated_along: explanations.fields,
        file: system.name.clone(),
        place: system.place(claim.span.start),
        id: claim.id.clone(),
        ok: expected.is_none_or(|expected| verdict.meets(expected)) && print_is_wrong,
        statement,
        printed,
        fault: match &claim.body {
            ClaimBody::Erratum { fault, .. } | ClaimBody::Scan { fault, .. } => Some(*fault),
            _ => None,
        },
        quoted: match &claim.body {
            ClaimBody::Erratum { quoted, .. } => quoted.clone(),
            ClaimBody::Scan { scanned, .. } => Some(scanned.clone()),
            _ => None,
        },
        basis,
        follows: claim.follows.as_ref().map(|reference| reference.text()),
        passage: claim.passage.clone(),
        conclusion: claim.conclusion.clone(),
        looks: system.looks.clone(),
        pole_of: claim.body.pole_of().map(|expr| in_one_line(&system.source, &expr.span)),
        verdict,
        domain,
        beside,
        not_looked_at,
        evidence,
        expected,
        remark: claim.remark.clone(),
        at_files_values,
        printed_at_files_values,
        fields: if claim.body.is_about_the_codistribution() { system.roles() } else { Vec::new() },
        seconds: begin.elapsed().as_secs_f64(),
    }
}

/// The statements of a claim, without blanks and comments, conditions in an order of their own: in which one they are written changes nothing.
fn said(system: &System, claim: &ClaimSyntax) -> String {
    let statements: Vec<&Statement> = match &claim.body {
        ClaimBody::Claim { statement, .. } => vec![statement],
        ClaimBody::Erratum { printed, corrected, .. } => vec![printed, corrected],
        ClaimBody::Scan { repaired, .. } => vec![repaired],
        ClaimBody::Definition { .. } | ClaimBody::Open { .. } => Vec::new(),
    };
    let text = |statement: &Statement| -> String {
        let text: String = in_one_line(&system.source, &statement.span).split_whitespace().collect();
        let Some((claimed, conditions)) = text.split_once("where") else { return text };
        let mut conditions: Vec<&str> = conditions.split(',').collect();
        conditions.sort_unstable();
        format!("{claimed}where{}", conditions.join(","))
    };
    statements.into_iter().map(text).collect::<Vec<_>>().join(";")
}

/// A number from a text (Fowler, Noll and Vo's hash), so that each claim has random numbers of its own.
fn fingerprint(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A verdict, what has to hold for the statement's terms to exist, in words, and what it rests on.
struct Decided {
    verdict: Verdict,
    beside: Vec<String>,
    not_looked_at: Vec<String>,
    domain: Vec<String>,
    evidence: Vec<Evidence>,
}

/// What is noted beside a verdict.
struct Notes {
    domain: Vec<String>,
    beside: Vec<String>,
    /// Thin parts of the set that a proof does not speak of.
    not_looked_at: Vec<String>,
    /// Of all branches, whatever the verdict on them.
    evidence: Vec<Evidence>,
    kept: Kept,
}

fn decide_statement(system: &mut System, statement: &Statement, kept: Kept, rng: &mut ChaCha8Rng) -> Decided {
    let mut notes = Notes {
        domain: Vec::new(),
        beside: Vec::new(),
        not_looked_at: Vec::new(),
        evidence: Vec::new(),
        kept,
    };
    let verdict = attempt(system, statement, rng, &mut notes).unwrap_or_else(Verdict::undecided);
    let Notes { domain, beside, not_looked_at, mut evidence, .. } = notes;
    let word = verdict.word();
    // at a state where a rank is lower than claimed it is certified, and at states of all cases where it is proved everywhere
    let is_of_it = |evidence: &Evidence| {
        [word, "unchecked"].contains(&evidence.word())
            || ["proved", "refuted"].contains(&word) && matches!(evidence, Evidence::Rank(_))
    };
    evidence.retain(is_of_it);
    match &verdict {
        _ if kept == Kept::Verdicts => evidence.clear(),
        Verdict::Refuted { witness: Witness { refutation: Some(refutation), .. }, .. } => {
            evidence = vec![Evidence::Refuted((**refutation).clone())];
        }
        Verdict::Proved { .. } | Verdict::Refuted { .. } if evidence.is_empty() => {
            evidence.push(Evidence::Unchecked("the order of a pole is not found by evaluation".to_owned()));
        }
        Verdict::Proved { .. } | Verdict::Refuted { .. } => {}
        Verdict::Definition { .. } | Verdict::Undecided { .. } => evidence.clear(),
    }
    Decided { verdict, domain, beside, not_looked_at, evidence }
}

fn attempt(
    system: &mut System,
    statement: &Statement,
    rng: &mut ChaCha8Rng,
    notes: &mut Notes,
) -> Result<Verdict, String> {
    let equation = &statement.equation;
    let (left, before) = system.elaborate_guarded(&equation.left).map_err(|problem| problem.message)?;
    let (right, after) = system.elaborate_guarded(&equation.right).map_err(|problem| problem.message)?;
    let (left, right) = Value::compared(left, right);
    let mut guards = Vec::new();
    for guard in before.into_iter().chain(after) {
        add_guard(&system.graph, &mut guards, guard);
    }
    let of_what_is_seen = matches!(left, Value::Visible { .. });
    let of_rank =
        of_what_is_seen || [&left, &right].iter().any(|value| matches!(value, Value::CodistributionRank));
    if of_what_is_seen {
        // a function has a differential where it is smooth
        smooth(&mut guards);
    }
    if of_rank {
        // every Lie derivative of the outputs has to exist
        guards.extend(system.smooth_guards(&system.moving_fields()));
    }
    // a rank holds at the initial state, where some values are known
    let mut at_first = None;
    if of_rank && !system.initial_conditions().is_empty() {
        let initial = system.initial_conditions().iter().cloned();
        at_first.insert(statement.clone()).conditions.extend(initial);
    }
    let statement = at_first.as_ref().unwrap_or(statement);
    guards.retain(|guard| guard.is_obvious(&system.graph) != Some(true));
    notes.domain = guards.iter().map(|guard| guard.text(&system.graph)).collect();
    if let Some(tolerance) = &equation.within {
        let (tolerance, needed) = system.elaborate_guarded(tolerance).map_err(|problem| problem.message)?;
        guards.extend(needed);
        return match (left.or_number(), right.or_number(), tolerance.or_number()) {
            (Value::Scalar(l), Value::Scalar(r), Value::Scalar(t)) if statement.conditions.is_empty() => {
                let verdict = decide_nearness(system, l, r, t, &guards, rng);
                let near = Nearness { left: l, right: r, tolerance: t };
                let evidence = nearness(system, near, &guards, &verdict).map_err(|doubt| {
                    format!(
                        "the difference is found to be greater, which the checker does not confirm: {doubt}"
                    )
                })?;
                notes.evidence.extend(evidence);
                Ok(verdict)
            }
            (Value::Scalar(_), Value::Scalar(_), Value::Scalar(_)) => {
                Err("'within' takes no 'where'; use 'at {...}'".to_owned())
            }
            _ => Err("'within' compares numbers".to_owned()),
        };
    }
    if let Some(asked) = Asking::of(system, &left, &right, equation.relation) {
        let asked = asked?;
        let kept = Evidence::Unchecked("the number of solutions is not found by evaluation".to_owned());
        notes.evidence.push(kept);
        let text = |expr: &Expr| in_one_line(&system.source, &expr.span);
        let name = text(if asked.is_left { &equation.left } else { &equation.right });
        smooth(&mut guards);
        return decide_solutions(system, statement, &asked, name, &guards);
    }
    if matches!(left, Value::Pole { .. }) || matches!(right, Value::Pole { .. }) {
        let terms = Terms { guards, ..Terms::default() };
        let on = OnBranch::new(system, &Branch::default(), &terms)?;
        if let Existence::Nowhere(guard) = existence(system, &on, rng) {
            return Err(format!("its formula is defined nowhere: it needs {guard}"));
        }
        return pole_statement(system, statement, left, right, rng);
    }
    let mut conditions = Vec::new();
    for condition in statement.conditions.iter().filter(|condition| condition.relation == Relation::Equal) {
        let left = system.scalar(&condition.left).map_err(|problem| problem.message)?;
        let right = system.scalar(&condition.right).map_err(|problem| problem.message)?;
        conditions.push(system.graph.sub(left, right));
    }
    let question = match equation.relation {
        Relation::Equal => Question::new(system, left, right)?,
        _ => Question::unequal(system, statement, (left, right), &mut guards)?,
    };
    if let Question::Relations { .. } = question {
        notes.domain = guards.iter().map(|guard| guard.text(&system.graph)).collect();
    }
    if let Some(except) = &statement.except {
        let mut claim = super::everywhere::read(system, statement, &question, except, (guards, conditions))?;
        notes.domain = claim.guards.iter().map(|guard| guard.text(&system.graph)).collect();
        claim.with_examples = notes.kept == Kept::Evidence;
        let decided = super::everywhere::decide(system, &claim, rng)?;
        notes.evidence = decided.evidence;
        notes.beside = decided.beside;
        return Ok(decided.verdict);
    }
    let sampled =
        if statement.on_sample { sample_box(system, question.sides(), &conditions) } else { Vec::new() };
    let (solution, unsolved) = match solve(system, &statement.conditions, &guards) {
        Ok(solution) => (solution, Vec::new()),
        // what cannot be solved can still be looked at, box by box
        Err(why) if matches!(question, Question::Relations { .. }) && why.may_be_met() => {
            let is_inequality = |condition: &&Equation| condition.relation != Relation::Equal;
            let others: Vec<Equation> = statement.conditions.iter().filter(is_inequality).cloned().collect();
            let mut solution = solve(system, &others, &guards).map_err(|why| why.to_string())?;
            let exists = guards_of_conditions(system, statement)?;
            solution.parts.iter_mut().for_each(|part| part.guards.extend(&exists));
            (solution, conditions.clone())
        }
        Err(why) => return Err(why.to_string()),
    };
    let mut solution = solution;
    let mut signals_free = Vec::new();
    if of_rank {
        for branch in solution.parts.iter_mut().chain(&mut solution.smaller) {
            let tied = std::mem::take(branch).tied_by_outputs(system);
            *branch = tied.map_err(|why| why.to_string())?;
            signals_free.extend(branch.beside.iter().map(|slope| format!("{slope} = 0")));
        }
        conditions.extend(system.zero_outputs());
    }
    let asked = Asked {
        question: &question,
        guards: &guards,
        sampled: &sampled,
        conditions: &conditions,
        unsolved: &unsolved,
        one_thing_twice: system.says_one_thing_twice(statement),
        parts_are_proved: false,
    };
    if question.is_of_a_rank() {
        let decided = asked.on_pieces(system, solution, notes.kept, rng)?;
        notes.evidence.extend(decided.evidence);
        let verdict = together(&question, decided.found);
        if matches!(verdict, Verdict::Proved { .. }) {
            // branches may leave out the same
            for part in decided.unsolved.iter().chain(&signals_free) {
                if !notes.not_looked_at.contains(part) {
                    notes.not_looked_at.push(part.clone());
                }
            }
        }
        return Ok(verdict);
    }
    let mut found = Vec::new();
    let lists = [
        (Size::Part, &solution.parts),
        (Size::Smaller, &solution.smaller),
        (Size::Thinner, &solution.thinner),
    ];
    for (size, branches) in lists {
        for branch in branches {
            for (branch, verdict, evidence) in asked.on_whole_branch(system, branch, notes.kept, rng)? {
                notes.evidence.extend(evidence);
                found.push((size, branch, verdict));
            }
        }
    }
    let parts_are_proved = solution.parts.iter().all(|part| part.values.len() == conditions.len())
        && found.iter().all(|(.., on_one)| {
            matches!(on_one, OnOneBranch::Verdict(Verdict::Proved { .. }, Existence::Shown))
        });
    let asked = Asked { parts_are_proved, ..asked };
    for part in &solution.unsolved {
        found.extend(asked.on_unsolved(system, part, rng)?);
    }
    Ok(together(&question, found))
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
