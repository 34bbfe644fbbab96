//! Lie derivatives at a kink, where the argument of an absolute value vanishes: those that have a continuous differential there.
//!
//! `beta/(1 + abs(beta))` has one at `beta = 0`, and its derivative has none. On each side the outputs and fields are analytic functions, which go on beyond the side; a
//! function that is one of them on each side is continuously differentiable where both agree with their gradients on all of the surface between the sides. The
//! Lie derivative of such a function along a continuous field is its rate of change along a motion, so that it is determined by the outputs as the function
//! is; the next one counts if it is continuously differentiable too. Where `n` such functions of `n` unknowns have independent differentials, the state is locally observable, by the theorem on
//! inverse functions, which asks for no more. Of a rank that is less than full nothing follows: the outputs may determine more.

use super::conditions::{Branch, vanishes};
use super::signs::{Edges, SignCell, in_sign_cell, sign_cells};
use palmistry_lang::{System, Time};
use palmistry_math::expression::{Guard, Need, Node, NodeId, gradient};
use palmistry_math::number::Function;

/// Of no more derivatives than these differentials are taken, an unknown.
const MOST_ROWS_EACH: usize = 4;
/// No further derivative is taken once those of one side are as large as this.
const MOST_NODES: usize = 50_000;
/// No more sides are compared: three kinks that meet have eight.
const MOST_SIDES: usize = 8;

/// The differentials at the states of a branch that lies in a kink, on a part of it on which all other signs are known.
#[derive(Clone, Debug)]
pub struct KinkRows {
    /// The part.
    pub branch: Branch,
    /// Row by row, by the unknown states in their order; as functions of all states.
    pub entries: Vec<NodeId>,
    /// What has to hold for them to exist.
    pub guards: Vec<Guard>,
    /// The first Lie derivative whose differential is not continuous there, in words.
    pub missing: Option<String>,
}

/// A Lie derivative on one side, with its gradient by all states.
struct Sided {
    /// That of which it is the derivative.
    parent: Option<usize>,
    text: String,
    value: NodeId,
    gradient: Vec<NodeId>,
}

/// Outputs and fields as they are on one side.
struct Side {
    cell: SignCell,
    fields: Vec<NodeId>,
    derivatives: Vec<Sided>,
}

/// The rows at the states of a branch, part by part, where the argument of an absolute value vanishes on all of it; none where none does, or where a field is
/// not continuous there. `guards` are those of the statement, the ones under which all derivatives exist among them.
///
/// # Errors
/// In words: too many signs, or a condition that leaves values open.
pub fn rows_at_kinks(
    system: &mut System,
    branch: &Branch,
    guards: &[Guard],
) -> Result<Option<Vec<KinkRows>>, String> {
    // a step may lead from one side to another; and what the outputs determine at a known beginning, or by signals of which few derivatives are looked at, is another
    // question
    if system.time != Time::Continuous
        || !system.initial_conditions().is_empty()
        || !system.zero_outputs().is_empty()
        || !system.signal_chains().is_empty()
    {
        return Ok(None);
    }
    let mut nodes: Vec<NodeId> = system.outputs.iter().map(|(_, node)| *node).collect();
    for field in system.moving_fields() {
        nodes.extend(system.fields[field].components.iter().map(|(_, node)| *node));
    }
    let Some(kept) = without_kinks(system, branch, guards, &nodes)? else { return Ok(None) };
    // they are differentiated by the states before these have the values that the conditions give
    let mut held = branch.values.clone();
    held.retain(|symbol, _| !system.states.contains(symbol));
    let there = system.graph.substitute(&nodes, &held);
    // what holds with equality on the set says nothing of the states around it: both sides are looked at
    let strict: Vec<Guard> = kept.iter().filter(|guard| guard.need != Need::NotNegative).copied().collect();
    let open = system.substitute_guards(&strict, &held);
    let mut groups: Vec<(Vec<Guard>, Vec<SignCell>)> = Vec::new();
    for cell in sign_cells(system, &there, &open, Edges::Counted)? {
        let operands: Vec<NodeId> = cell.guards.iter().map(|guard| guard.node).collect();
        let operands = branch.put_in(system, &operands)?;
        let mut beside = Vec::new();
        let mut is_empty = false;
        for (guard, node) in cell.guards.iter().zip(operands) {
            is_empty |= Guard { node, need: guard.need }.is_obvious(&system.graph) == Some(false);
            if !vanishes(system, node) {
                beside.push(*guard);
            }
        }
        beside.sort();
        match groups.iter_mut().find(|(own, _)| *own == beside) {
            _ if is_empty => {}
            Some((_, cells)) => cells.push(cell),
            None => groups.push((beside, vec![cell])),
        }
    }
    let mut found = Vec::new();
    for (beside, cells) in groups {
        let Some(mut rows) = rows_of_sides(system, branch, cells)? else { return Ok(None) };
        rows.branch = branch.clone();
        for guard in beside {
            // the sign is not zero but on a part of fewer dimensions
            let strict = Guard { node: guard.node, need: Need::Positive };
            rows.branch.guards.push(strict);
            rows.branch.assumed.push(strict);
        }
        rows.guards.clone_from(&kept);
        found.push(rows);
    }
    Ok((!found.is_empty()).then_some(found))
}

/// The guards without those of kinks: that a square under a root is positive, which vanishes on the branch. None where there are no such, or another guard fails
/// on all of the branch.
fn without_kinks(
    system: &mut System,
    branch: &Branch,
    guards: &[Guard],
    nodes: &[NodeId],
) -> Result<Option<Vec<Guard>>, String> {
    let arguments = |system: &System, of: Function| -> Vec<NodeId> {
        let reachable = system.graph.reachable(nodes.iter().copied()).into_iter();
        let argument = |id| match system.graph.node(id) {
            Node::Apply(function, argument) if function == of => Some(argument),
            _ => None,
        };
        reachable.filter_map(argument).collect()
    };
    let (roots, logarithms) = (arguments(system, Function::Sqrt), arguments(system, Function::Log));
    let operands: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    let operands = branch.put_in(system, &operands)?;
    let (mut kept, mut kinks) = (Vec::new(), 0);
    for (guard, node) in guards.iter().zip(operands) {
        if guard.need == Need::NotNegative || !vanishes(system, node) {
            kept.push(*guard);
            continue;
        }
        let is_square = match system.graph.node(guard.node) {
            Node::Power(_, exponent) => exponent == 2,
            Node::Mul(one, other) => one == other,
            _ => false,
        };
        let is_root = roots.contains(&guard.node) && !logarithms.contains(&guard.node);
        if guard.need != Need::Positive || !is_square || !is_root || branch.assumed.contains(guard) {
            return Ok(None);
        }
        kinks += 1;
    }
    Ok((kinks > 0).then_some(kept))
}

/// The rows of several sides that meet in the kink: none where a field jumps between them, and where not all sides are there.
fn rows_of_sides(
    system: &mut System,
    branch: &Branch,
    cells: Vec<SignCell>,
) -> Result<Option<KinkRows>, String> {
    // one side alone would agree with itself
    if !(2..=MOST_SIDES).contains(&cells.len()) {
        return Ok(None);
    }
    let mut sides = Vec::new();
    for cell in cells {
        let (fields, derivatives) = in_sign_cell(system, &cell, derivatives);
        sides.push(Side { cell, fields, derivatives });
    }
    if has_kinks_left(system, branch, &sides)? {
        return Ok(None);
    }
    let Some(first) = sides.first() else { return Ok(None) };
    let shared = sides.iter().map(|side| side.derivatives.len()).min().unwrap_or(0);
    let mut faces = Vec::new();
    for (place, one) in sides.iter().enumerate() {
        for (further, other) in sides[place + 1..].iter().enumerate() {
            if let Some(between) = between(system, &one.cell, &other.cell) {
                faces.push((place, place + 1 + further, between));
            }
        }
    }
    if !are_connected(sides.len(), &faces) {
        return Ok(None);
    }
    let mut agree = |of: &dyn Fn(&Side) -> Vec<NodeId>| {
        faces.iter().all(|(one, other, between)| {
            let (one, other) = (of(&sides[*one]), of(&sides[*other]));
            let pairs = one.into_iter().zip(other);
            let differences: Vec<NodeId> = pairs.map(|(one, other)| system.graph.sub(one, other)).collect();
            vanish_on(system, *between, &differences)
        })
    };
    if !agree(&|side| side.fields.clone()) {
        return Ok(None);
    }
    let mut is_smooth: Vec<bool> = Vec::new();
    let mut missing = None;
    for place in 0..shared {
        if let Some(parent) = first.derivatives[place].parent
            && !is_smooth[parent]
        {
            is_smooth.push(false);
            continue;
        }
        let smooth = agree(&|side| {
            let own = &side.derivatives[place];
            std::iter::once(own.value).chain(own.gradient.iter().copied()).collect()
        });
        if !smooth {
            missing.get_or_insert_with(|| first.derivatives[place].text.clone());
        }
        is_smooth.push(smooth);
    }
    let unknowns = system.unknowns();
    let columns: Vec<usize> =
        (0..system.states.len()).filter(|column| unknowns.contains(&system.states[*column])).collect();
    let smooth = first.derivatives.iter().zip(&is_smooth).filter(|(_, is_smooth)| **is_smooth);
    let entries = smooth.flat_map(|(own, _)| columns.iter().map(|column| own.gradient[*column])).collect();
    Ok(Some(KinkRows { branch: Branch::default(), entries, guards: Vec::new(), missing }))
}

/// Whether a root is left in what some side is, whose argument vanishes on the branch: such terms are alike on both sides, and have no differential.
fn has_kinks_left(system: &mut System, branch: &Branch, sides: &[Side]) -> Result<bool, String> {
    let nodes = sides.iter().flat_map(|side| {
        let derivatives = side.derivatives.iter();
        side.fields
            .iter()
            .copied()
            .chain(derivatives.flat_map(|own| own.gradient.iter().copied().chain([own.value])))
    });
    let argument = |id| match system.graph.node(id) {
        Node::Apply(Function::Sqrt, argument) => Some(argument),
        _ => None,
    };
    let arguments: Vec<NodeId> = system.graph.reachable(nodes).into_iter().filter_map(argument).collect();
    let there = branch.put_in(system, &arguments)?;
    Ok(there.into_iter().any(|argument| vanishes(system, argument)))
}

/// All components of the moving fields, and the outputs with their Lie derivatives, order by order.
fn derivatives(system: &mut System) -> (Vec<NodeId>, Vec<Sided>) {
    let moving = system.moving_fields();
    let components = moving.iter().flat_map(|field| system.fields[*field].components.iter());
    let fields = components.map(|(_, node)| *node).collect();
    let (states, most) = (system.states.clone(), MOST_ROWS_EACH * system.unknown_count());
    let begin = system.graph.len();
    let mut found: Vec<Sided> = Vec::new();
    for (name, node) in system.outputs.clone() {
        let gradient = gradient(&mut system.graph, node, &states);
        let text = if name.is_empty() { system.graph.text(node) } else { name };
        found.push(Sided { parent: None, text, value: node, gradient });
    }
    let mut parent = 0;
    while parent < found.len() && found.len() < most && system.graph.len() - begin < MOST_NODES {
        for field in &moving {
            let value = system.lie_derivative(*field, found[parent].value);
            let gradient = gradient(&mut system.graph, value, &states);
            let text = format!("L({}, {})", system.fields[*field].name, found[parent].text);
            found.push(Sided { parent: Some(parent), text, value, gradient });
        }
        parent += 1;
    }
    (fields, found)
}

/// The expression that vanishes between two sides, where they differ in one sign.
fn between(system: &mut System, one: &SignCell, other: &SignCell) -> Option<NodeId> {
    let apart = |a: &SignCell, b: &SignCell| -> Vec<NodeId> {
        let only = a.guards.iter().filter(|guard| !b.guards.contains(guard));
        only.map(|guard| guard.node).collect()
    };
    let (own, others) = (apart(one, other), apart(other, one));
    let ([own], [others]) = (own.as_slice(), others.as_slice()) else { return None };
    let sum = system.graph.add(*own, *others);
    vanishes(system, sum).then_some(*own)
}

/// Whether each side is reached from each other across such faces.
fn are_connected(count: usize, faces: &[(usize, usize, NodeId)]) -> bool {
    let mut reached = vec![0];
    let mut at = 0;
    while at < reached.len() {
        for (one, other, _) in faces {
            for (from, to) in [(one, other), (other, one)] {
                if *from == reached[at] && !reached.contains(to) {
                    reached.push(*to);
                }
            }
        }
        at += 1;
    }
    reached.len() == count
}

/// Whether expressions vanish wherever another one does.
fn vanish_on(system: &mut System, surface: NodeId, expressions: &[NodeId]) -> bool {
    let Ok(solution) = Branch::default().meeting(system, &[surface]) else { return false };
    if !solution.unsolved.is_empty() {
        return false;
    }
    let pieces = solution.parts.iter().chain(&solution.smaller).chain(&solution.thinner);
    let mut is_met = false;
    for piece in pieces {
        is_met = true;
        let Ok(there) = piece.put_in(system, expressions) else { return false };
        if !there.iter().all(|expression| vanishes(system, *expression)) {
            return false;
        }
    }
    is_met
}
