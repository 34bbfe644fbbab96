//! The question that a statement asks, once its sides are read.

use super::claimed_ranks::ClaimedRanks;
use super::evidence::{RankedMatrix, claimed_rank, identity};
use super::terms::OnBranch;
use super::verdict::Verdict;
use palmistry_checker::Evidence;
use palmistry_lang::{Statement, System, Value};
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Guard, Need, NodeId, add_guard};
use rand_chacha::ChaCha8Rng;

/// Said of what is kept for the checkers, which know ranks and no bounds of them.
pub(super) const BOUNDS_ARE_NOT_CHECKED: &str = "bounds of a rank are not checked";

/// What a statement asks.
pub(super) enum Question {
    /// Are the entries of two matrices equal, the left ones first?
    Identity { entries: Vec<NodeId>, columns: usize },
    /// Do inequalities hold? The left sides first.
    Relations { entries: Vec<NodeId>, relations: Vec<Relation> },
    /// Has a matrix this rank?
    Rank { entries: Vec<NodeId>, columns: usize, claimed: ClaimedRanks },
    /// Has the observability codistribution this rank?
    Codistribution { claimed: ClaimedRanks },
    /// Are all these functions observable, or is none of them?
    Visible { functions: Vec<NodeId>, is_observable: bool },
}

impl Question {
    /// Inequalities that are claimed together; what their terms need is added to the guards.
    pub fn relations(
        system: &mut System,
        statement: &Statement,
        guards: &mut Vec<Guard>,
    ) -> Result<Question, String> {
        let (mut entries, mut right_sides, mut relations) = (Vec::new(), Vec::new(), Vec::new());
        for relation in statement.relations() {
            for (side, list) in [(&relation.left, &mut entries), (&relation.right, &mut right_sides)] {
                let (value, needed) = system.elaborate_guarded(side).map_err(|problem| problem.message)?;
                let Some(value) = value.as_number() else {
                    return Err(format!("'{}' compares numbers", relation.relation.sign()));
                };
                list.push(value);
                let needed = needed.into_iter().filter(|guard| guard.is_obvious(&system.graph) != Some(true));
                needed.for_each(|guard| add_guard(&system.graph, guards, guard));
            }
            relations.push(relation.relation);
        }
        entries.append(&mut right_sides);
        Ok(Question::Relations { entries, relations })
    }

    /// A statement with `<`, `<=`, `>` or `>=`: bounds of a rank, or inequalities between numbers.
    pub fn unequal(
        system: &mut System,
        statement: &Statement,
        (left, right): (Value, Value),
        guards: &mut Vec<Guard>,
    ) -> Result<Question, String> {
        let first = statement.equation.relation;
        let (of_rank, bound, relation) = match (left, right) {
            (rank @ (Value::Rank(_) | Value::CodistributionRank), Value::Scalar(bound)) => {
                (rank, bound, first)
            }
            (Value::Scalar(bound), rank @ (Value::Rank(_) | Value::CodistributionRank)) => {
                (rank, bound, first.turned())
            }
            _ => return Question::relations(system, statement, guards),
        };
        let mut relations = vec![(relation, claimed_integer(system, bound)?)];
        for further in &statement.further {
            let bound = system.scalar(&further.right).map_err(|problem| problem.message)?;
            relations.push((further.relation, claimed_integer(system, bound)?));
        }
        let claimed = ClaimedRanks::of(&relations)?;
        Ok(match of_rank {
            Value::Rank(matrix) => {
                Question::Rank { entries: matrix.entries, columns: matrix.columns, claimed }
            }
            _ => Question::Codistribution { claimed },
        })
    }

    pub fn is_of_a_rank(&self) -> bool {
        matches!(self, Question::Rank { .. } | Question::Codistribution { .. } | Question::Visible { .. })
    }

    /// The relation between each left side and its right one; empty where all are equations.
    pub fn all_relations(&self) -> &[Relation] {
        match self {
            Question::Relations { relations, .. } => relations,
            _ => &[],
        }
    }

    pub fn new(system: &System, left: Value, right: Value) -> Result<Question, String> {
        let claimed = |id: NodeId| ClaimedRanks::of(&[(Relation::Equal, claimed_integer(system, id)?)]);
        match (left, right) {
            (Value::Scalar(l), Value::Scalar(r)) => {
                Ok(Question::Identity { entries: vec![l, r], columns: 1 })
            }
            (Value::Matrix(l), Value::Matrix(r)) if (l.rows, l.columns) == (r.rows, r.columns) => {
                let entries = l.entries.into_iter().chain(r.entries).collect();
                Ok(Question::Identity { entries, columns: l.columns.max(1) })
            }
            (Value::Rank(m), Value::Scalar(r)) | (Value::Scalar(r), Value::Rank(m)) => {
                Ok(Question::Rank { entries: m.entries, columns: m.columns, claimed: claimed(r)? })
            }
            (Value::CodistributionRank, Value::Scalar(r)) | (Value::Scalar(r), Value::CodistributionRank) => {
                Ok(Question::Codistribution { claimed: claimed(r)? })
            }
            (Value::Visible { functions, is_observable }, _) => {
                Ok(Question::Visible { functions, is_observable })
            }
            (l, r) => Err(format!("{} is compared with {}", l.describe(), r.describe())),
        }
    }

    /// What the checker needs of a verdict on a branch, but for the refutation of an equation, which has it already.
    pub fn evidence(
        &self,
        system: &mut System,
        on: &OnBranch,
        verdict: &Verdict,
        rng: &mut ChaCha8Rng,
    ) -> Option<Evidence> {
        let matrix = match (self, verdict) {
            (
                Question::Identity { .. } | Question::Relations { .. },
                Verdict::Proved { engine, log2_error },
            ) => {
                return Some(identity(system, on, engine, *log2_error, rng));
            }
            (Question::Identity { .. } | Question::Relations { .. }, _) => return None,
            (Question::Rank { claimed, .. } | Question::Codistribution { claimed }, _)
                if claimed.are_bounds =>
            {
                return Some(Evidence::Unchecked(BOUNDS_ARE_NOT_CHECKED.to_owned()));
            }
            (Question::Rank { entries, columns, claimed }, _) => {
                RankedMatrix::of_file(entries, *columns, claimed.least)
            }
            (Question::Codistribution { claimed }, _) => {
                match RankedMatrix::codistribution(system, &on.branch, claimed.least) {
                    Ok(matrix) => matrix,
                    Err(_) if !matches!(verdict, Verdict::Proved { .. } | Verdict::Refuted { .. }) => {
                        return None;
                    }
                    Err(why) => return Some(Evidence::Unchecked(why)),
                }
            }
            // it comes with the verdict
            (Question::Visible { .. }, _) => return None,
        };
        claimed_rank(system, on, &matrix, verdict, rng)
    }

    /// What has to exist.
    pub fn sides(&self) -> &[NodeId] {
        match self {
            Question::Identity { entries, .. }
            | Question::Relations { entries, .. }
            | Question::Rank { entries, .. }
            | Question::Visible { functions: entries, .. } => entries,
            Question::Codistribution { .. } => &[],
        }
    }
}

/// That states lie in the sample box: inequalities for the symbols that a statement mentions, and what is avoided.
pub(super) fn sample_box(system: &mut System, sides: &[NodeId], conditions: &[NodeId]) -> Vec<Guard> {
    let mentioned = system.graph.symbols_of(sides.iter().chain(conditions).copied());
    let mut found = Vec::new();
    for symbol in &mentioned {
        let Some(range) = system.symbol_info(*symbol).and_then(|info| info.range.clone()) else { continue };
        let (low, high) = (system.graph.rational(range.low), system.graph.rational(range.high));
        let node = system.graph.symbol(*symbol);
        for (more, less) in [(node, low), (high, node)] {
            found.push(Guard { node: system.graph.sub(more, less), need: Need::NotNegative });
        }
    }
    for (_, node) in &system.avoid {
        if system.graph.symbols_of([*node]).iter().all(|symbol| mentioned.contains(symbol)) {
            found.push(Guard { node: *node, need: Need::NotZero });
        }
    }
    found
}

/// Where both sides of all conditions exist.
pub(super) fn guards_of_conditions(system: &mut System, statement: &Statement) -> Result<Vec<Guard>, String> {
    let mut found = Vec::new();
    for side in statement.conditions.iter().flat_map(|condition| [&condition.left, &condition.right]) {
        let (_, guards) = system.elaborate_guarded(side).map_err(|problem| problem.message)?;
        guards.into_iter().for_each(|guard| add_guard(&system.graph, &mut found, guard));
    }
    Ok(found)
}

pub(super) fn claimed_integer(system: &System, id: NodeId) -> Result<i64, String> {
    let value = system.graph.constant_value(id).ok_or("a rank or an order is compared with an integer")?;
    if !value.denominator().is_one() {
        return Err("a rank or an order is compared with an integer".to_owned());
    }
    i64::try_from(value.numerator().clone()).map_err(|e| e.to_string())
}
