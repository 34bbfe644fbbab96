//! A claim as its proof file has it: sides, rows and conditions, built anew from the file's text.

use super::doubt::{Doubt, Missing};
use super::listing::Listing;
use super::lowering::Lowering;
use super::minor::RankedState;
use super::state::{ExactCoordinate, ExactState};
use super::witness::{Requirement, Sides};
use palmistry_lang::{ClaimBody, Statement, System, Value};
use palmistry_math::expression::syntax::{Equation, Expr, Relation};
use palmistry_math::expression::{Guard, Need, NodeId, Symbol, add_guard, gradient};

/// Graphs of more nodes are refused while rows are built from the names in a verdict.
const LARGEST_GRAPH: usize = 2_000_000;
/// Lie derivatives are of no higher order.
const HIGHEST_ORDER: usize = 64;
/// The definition by which a file has rows of its own.
pub(super) const OWN_ROWS: &str = "rows";

/// Two nodes that are compared.
pub(super) type Compared = (NodeId, Relation, NodeId);

/// What a claim compares.
#[derive(Clone, Debug)]
pub(super) enum Subject {
    /// Sides, those of matrices entry by entry.
    Sides(Vec<Compared>),
    /// Two numbers and how near they are, all at the values that the file gives.
    Near { sides: Compared, tolerance: NodeId },
    /// The rank of a matrix of the file, by rows.
    Matrix { rows: Vec<Vec<NodeId>>, columns: usize, claimed: usize },
    /// The rank of the observability codistribution.
    System { claimed: usize },
    /// Functions whose differentials lie in it, or do not.
    Functions { functions: Vec<NodeId> },
    /// The order of a pole of an expression where another one vanishes.
    Pole { expression: NodeId, factor: NodeId, order: i64 },
    /// Claims that are not examined: numbers of solutions.
    Other,
}

/// A claim in the graph of its file.
#[derive(Clone, Debug)]
pub(super) struct BuiltClaim {
    pub subject: Subject,
    pub conditions: Vec<Compared>,
    /// What sides, rows and conditions need to exist.
    pub guards: Vec<Guard>,
    /// The sets that are left out of a claim about all states.
    pub except: Vec<Vec<Compared>>,
    /// What those need to exist.
    pub except_guards: Vec<Guard>,
}

/// The same as operations behind those of a verdict's own listing.
pub(super) struct ListedClaim {
    pub listing: Listing,
    pub conditions: Vec<Sides>,
    pub requirements: Vec<Requirement>,
    pub except: Vec<Vec<Sides>>,
    pub except_requirements: Vec<Requirement>,
}

/// The statement of an id, as `prove` forms ids: those of errata name one of two forms.
pub(super) fn statement<'s>(system: &'s System, id: &str) -> Option<&'s Statement> {
    let of = |wanted: &str| system.claims.iter().find(|claim| claim.id == wanted).map(|claim| &claim.body);
    if let Some(ClaimBody::Claim { statement, .. } | ClaimBody::Scan { repaired: statement, .. }) = of(id) {
        return Some(statement);
    }
    for (suffix, is_printed) in [(" as printed", true), (" corrected", false)] {
        if let Some(base) = id.strip_suffix(suffix)
            && let Some(ClaimBody::Erratum { printed, corrected, .. }) = of(base)
        {
            return Some(if is_printed { printed } else { corrected });
        }
    }
    None
}

impl BuiltClaim {
    /// Reads the sides and the conditions of a statement.
    pub fn of(system: &mut System, statement: &Statement) -> Result<BuiltClaim, Doubt> {
        let mut guards = Vec::new();
        let subject = subject(system, statement, &mut guards)?;
        let mut conditions = compared(system, &statement.conditions, &mut guards)?;
        if matches!(subject, Subject::System { .. } | Subject::Functions { .. }) {
            let initial = system.initial_conditions().to_vec();
            conditions.extend(compared(system, &initial, &mut guards)?);
            guards.extend(system.smooth_guards(&system.moving_fields()));
        }
        if matches!(subject, Subject::Functions { .. }) {
            guards.iter_mut().for_each(|guard| guard.need = guard.need.smooth());
        }
        guards.retain(|guard| guard.is_obvious(&system.graph) != Some(true));
        let (mut except, mut except_guards) = (Vec::new(), Vec::new());
        for set in statement.except.iter().flatten() {
            except.push(compared(system, set, &mut except_guards)?);
        }
        let mut claim = BuiltClaim { subject, conditions, guards, except, except_guards };
        if statement.on_sample {
            claim.keep_to_the_sample(system);
        }
        Ok(claim)
    }

    /// What is asked of ranks at states and on boxes, where nothing is claimed: `given` is what stands behind `where`.
    pub fn of_rows(
        system: &mut System,
        rows: Vec<Vec<NodeId>>,
        are_the_files: bool,
        given: &str,
        states: &[RankedState],
    ) -> Result<BuiltClaim, Doubt> {
        let mut conditions = Vec::new();
        let mut guards = match are_the_files {
            true => system.definition_guards(OWN_ROWS),
            false => system.smooth_guards(&system.moving_fields()),
        };
        if !given.is_empty() {
            let read = palmistry_lang::parse_statement(&format!("0 = 0 where {given}"));
            let statement = read.map_err(|_| Doubt::OtherClaim("the conditions cannot be read"))?;
            conditions = compared(system, &statement.conditions, &mut guards)?;
        }
        // what the file says of all states: as far as these states have values for it, since what else it mentions may be anything
        let mut said = system.initial_conditions().to_vec();
        for assumption in system.assumptions() {
            let read = palmistry_lang::parse_statement(&format!("0 = 0 where {assumption}"));
            said.extend(read.map_err(|_| Doubt::OtherClaim("the assumptions cannot be read"))?.conditions);
        }
        for equation in said {
            let found = compared(system, std::slice::from_ref(&equation), &mut guards)?;
            let symbols = system.graph.symbols_of(found.iter().flat_map(|(left, _, right)| [*left, *right]));
            let has = |symbol: &Symbol| {
                states.iter().all(|one| one.state.contains_key(system.symbol_name(*symbol)))
            };
            if !states.is_empty() && symbols.iter().all(has) {
                conditions.extend(found);
            }
        }
        guards.retain(|guard| guard.is_obvious(&system.graph) != Some(true));
        let columns = system.unknown_count();
        let subject = Subject::Matrix { rows, columns, claimed: columns };
        Ok(BuiltClaim { subject, conditions, guards, except: Vec::new(), except_guards: Vec::new() })
    }

    /// Whether a state gives more values by operations than the claim has equations to give them: it may assume what the claim
    /// does not.
    pub fn is_exceeded_by(&self, state: &ExactState) -> bool {
        let steps = state.values().filter(|value| matches!(value, ExactCoordinate::Step(_))).count();
        steps > self.conditions.iter().filter(|(_, relation, _)| *relation == Relation::Equal).count()
    }

    /// Lies in the sample box, and not on what is avoided.
    fn keep_to_the_sample(&mut self, system: &mut System) {
        let mut nodes: Vec<NodeId> = self.conditions.iter().flat_map(|(l, _, r)| [*l, *r]).collect();
        if let Subject::Sides(sides) = &self.subject {
            nodes.extend(sides.iter().flat_map(|(l, _, r)| [*l, *r]));
        }
        let mentioned = system.graph.symbols_of(nodes);
        for symbol in &mentioned {
            let Some(range) = system.symbol_info(*symbol).and_then(|info| info.range.clone()) else {
                continue;
            };
            let (low, high) = (system.graph.rational(range.low), system.graph.rational(range.high));
            let node = system.graph.symbol(*symbol);
            self.conditions.extend([(node, Relation::AtLeast, low), (node, Relation::AtMost, high)]);
        }
        for (_, node) in &system.avoid {
            if system.graph.symbols_of([*node]).iter().all(|symbol| mentioned.contains(symbol)) {
                add_guard(&system.graph, &mut self.guards, Guard { node: *node, need: Need::NotZero });
            }
        }
    }

    /// The conditions behind a listing, and what else is lowered by `more`.
    pub fn listed<T>(
        &self,
        system: &System,
        behind: &Listing,
        more: impl FnOnce(&mut Lowering<'_>) -> Result<T, Missing>,
    ) -> Result<(ListedClaim, T), Missing> {
        let mut lowering = Lowering::behind(&system.graph, behind.clone());
        let found = more(&mut lowering)?;
        let conditions = sides(&mut lowering, &self.conditions)?;
        let requirement = |lowering: &mut Lowering<'_>, guard: &Guard| lowering.requirement(*guard);
        let requirements =
            self.guards.iter().map(|guard| requirement(&mut lowering, guard)).collect::<Result<_, _>>()?;
        let except = self.except.iter().map(|set| sides(&mut lowering, set)).collect::<Result<_, _>>()?;
        let except_requirements = self
            .except_guards
            .iter()
            .map(|guard| requirement(&mut lowering, guard))
            .collect::<Result<_, _>>()?;
        let listing = lowering.finish();
        Ok((ListedClaim { listing, conditions, requirements, except, except_requirements }, found))
    }
}

/// Pairs of nodes as places of a listing.
pub(super) fn sides(lowering: &mut Lowering<'_>, compared: &[Compared]) -> Result<Vec<Sides>, Missing> {
    compared.iter().map(|(left, relation, right)| lowering.sides(*left, *relation, *right)).collect()
}

const UNREAD: Doubt = Doubt::OtherClaim("the claim in the proof file compares what cannot be compared");

fn value(system: &mut System, expr: &Expr, guards: &mut Vec<Guard>) -> Result<Value, Doubt> {
    let (value, needed) = system.elaborate_guarded(expr).map_err(|_| UNREAD)?;
    needed.into_iter().for_each(|guard| add_guard(&system.graph, guards, guard));
    Ok(value)
}

fn compared(
    system: &mut System,
    equations: &[Equation],
    guards: &mut Vec<Guard>,
) -> Result<Vec<Compared>, Doubt> {
    let mut found = Vec::new();
    for equation in equations {
        let mut side = |expr| value(system, expr, guards)?.as_number().ok_or(UNREAD);
        let (left, right) = (side(&equation.left)?, side(&equation.right)?);
        found.push((left, equation.relation, right));
    }
    Ok(found)
}

fn subject(system: &mut System, statement: &Statement, guards: &mut Vec<Guard>) -> Result<Subject, Doubt> {
    let equation = &statement.equation;
    if equation.relation != Relation::Equal {
        let relations: Vec<Equation> = statement.relations().cloned().collect();
        for side in relations.iter().flat_map(|relation| [&relation.left, &relation.right]) {
            // bounds of ranks and of numbers of solutions are not examined
            if value(system, side, guards)?.as_number().is_none() {
                return Ok(Subject::Other);
            }
        }
        return compared(system, &relations, guards).map(Subject::Sides);
    }
    let left = value(system, &equation.left, guards)?;
    let right = value(system, &equation.right, guards)?;
    let (left, right) = Value::compared(left, right);
    if let Some(tolerance) = &equation.within {
        let tolerance = value(system, tolerance, guards)?.as_number().ok_or(UNREAD)?;
        let pair = left.as_number().zip(right.as_number());
        let (left, right) = pair.ok_or(UNREAD)?;
        return Ok(Subject::Near { sides: (left, Relation::Equal, right), tolerance });
    }
    Ok(match (left, right) {
        (Value::Scalar(l), Value::Scalar(r)) => Subject::Sides(vec![(l, Relation::Equal, r)]),
        (Value::Matrix(l), Value::Matrix(r)) if (l.rows, l.columns) == (r.rows, r.columns) => {
            let pairs = l.entries.into_iter().zip(r.entries);
            Subject::Sides(pairs.map(|(l, r)| (l, Relation::Equal, r)).collect())
        }
        (Value::Rank(m), Value::Scalar(n)) | (Value::Scalar(n), Value::Rank(m)) => {
            let rows = m.entries.chunks(m.columns.max(1)).map(<[NodeId]>::to_vec).collect();
            Subject::Matrix { rows, columns: m.columns, claimed: whole(system, n)? }
        }
        (Value::CodistributionRank, Value::Scalar(n)) | (Value::Scalar(n), Value::CodistributionRank) => {
            Subject::System { claimed: whole(system, n)? }
        }
        (Value::Visible { functions, .. }, _) => Subject::Functions { functions },
        (Value::Pole { expression, factor }, Value::Scalar(n))
        | (Value::Scalar(n), Value::Pole { expression, factor }) => {
            Subject::Pole { expression, factor, order: integer(system, n).ok_or(UNREAD)? }
        }
        (Value::Pole { .. } | Value::Solutions(_), _) | (_, Value::Pole { .. } | Value::Solutions(_)) => {
            Subject::Other
        }
        _ => return Err(UNREAD),
    })
}

fn integer(system: &System, node: NodeId) -> Option<i64> {
    let value = system.graph.constant_value(node).filter(|value| value.denominator().is_one());
    value.and_then(|value| i64::try_from(value.numerator().clone()).ok())
}

fn whole(system: &System, node: NodeId) -> Result<usize, Doubt> {
    integer(system, node).and_then(|value| usize::try_from(value).ok()).ok_or(UNREAD)
}

/// The rows that some names stand for: differentials of outputs, of their Lie derivatives `Lg Lf^3 y`, and of functions.
pub(super) fn rows_of_lie_derivatives(
    system: &mut System,
    row_names: &[String],
    functions: &[NodeId],
) -> Result<Vec<Vec<NodeId>>, Doubt> {
    let unknowns = system.unknowns();
    let mut rows = Vec::new();
    for text in row_names {
        let function = functions.iter().copied().find(|function| system.graph.text(*function) == *text);
        let of = match function {
            Some(function) => function,
            None => lie_derivative(system, text)?,
        };
        rows.push(gradient(&mut system.graph, of, &unknowns));
        if system.graph.len() > LARGEST_GRAPH {
            return Err(Doubt::NoValue(Missing::Effort));
        }
    }
    Ok(rows)
}

fn lie_derivative(system: &mut System, text: &str) -> Result<NodeId, Doubt> {
    let (fields, mut value) = fields_and_output(system, text)?;
    for field in fields.into_iter().rev() {
        value = system.lie_derivative(field, value);
        if system.graph.len() > LARGEST_GRAPH {
            return Err(Doubt::NoValue(Missing::Effort));
        }
    }
    Ok(value)
}

/// Whether a name is that of a Lie derivative.
pub(super) fn is_lie_derivative(system: &System, text: &str) -> bool {
    fields_and_output(system, text).is_ok()
}

/// The fields of a Lie derivative, the last one first, and the output.
fn fields_and_output(system: &System, text: &str) -> Result<(Vec<usize>, NodeId), Doubt> {
    let other = || Doubt::NoSuchRow(text.to_owned());
    let (mut fields, mut rest) = (Vec::new(), text);
    loop {
        let mut outputs = system.outputs.iter().filter(|(name, _)| name == rest);
        match (outputs.next(), outputs.next()) {
            (Some((_, value)), None) => return Ok((fields, *value)),
            (Some(_), Some(_)) => return Err(other()),
            (None, _) => {}
        }
        let (first, tail) = rest.split_once(' ').ok_or_else(other)?;
        let name = first.strip_prefix('L').ok_or_else(other)?;
        let (name, power) = name.split_once('^').unwrap_or((name, "1"));
        let power = power.parse::<usize>().ok().filter(|power| (1..=HIGHEST_ORDER).contains(power));
        let moving = system.moving_fields().into_iter().find(|field| system.fields[*field].name == name);
        let (power, field) = power.zip(moving).ok_or_else(other)?;
        fields.extend(std::iter::repeat_n(field, power));
        if fields.len() > HIGHEST_ORDER {
            return Err(Doubt::NoValue(Missing::Effort));
        }
        rest = tail;
    }
}

/// So many rows of the checker's own are tried beside those of the evidence, and so many nodes are made for them.
const MOST_FURTHER: usize = 120;
const MOST_NODES: usize = 60_000;

/// The rows of all Lie derivatives of one order more than those of the evidence, as far as they are few and short: what
/// was left out of the evidence is among them.
pub(super) fn further_rows(system: &mut System, row_names: &[String]) -> Vec<Vec<NodeId>> {
    let orders = row_names.iter().filter_map(|word| fields_and_output(system, word).ok());
    let order = orders.map(|(fields, _)| fields.len()).max().unwrap_or(0) + 1;
    let (unknowns, moving, begin) = (system.unknowns(), system.moving_fields(), system.graph.len());
    let mut last: Vec<NodeId> = system.outputs.iter().map(|(_, value)| *value).collect();
    let mut rows = Vec::new();
    for _ in 0..=order {
        for value in &last {
            if rows.len() >= MOST_FURTHER || system.graph.len() - begin > MOST_NODES {
                return rows;
            }
            rows.push(gradient(&mut system.graph, *value, &unknowns));
        }
        let mut next = Vec::new();
        for (field, value) in moving.iter().flat_map(|field| last.iter().map(move |value| (*field, *value))) {
            if next.len() >= MOST_FURTHER || system.graph.len() - begin > MOST_NODES {
                break;
            }
            let value = system.lie_derivative(field, value);
            if system.graph.constant_value(value).is_none() {
                next.push(value);
            }
        }
        last = next;
    }
    rows
}

/// The place of a row of a matrix, counted from zero, by its name `row 3`.
pub(super) fn numbered_row(name: &str, rows: usize) -> Result<usize, Doubt> {
    let number = name.strip_prefix("row ").and_then(|number| number.parse::<usize>().ok());
    number
        .filter(|number| (1..=rows).contains(number))
        .map(|number| number - 1)
        .ok_or_else(|| Doubt::NoSuchRow(name.to_owned()))
}
