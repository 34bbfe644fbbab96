//! When functions that are adjoined with random values show neither more nor less than the functions themselves.
//!
//! Theorem of Kolchin and Ostrowski (E. R. Kolchin, *Algebraic groups and algebraic dependence*, Amer. J. Math. 90 (1968)): exponentials
//! and logarithms over a field of functions are algebraically dependent only if a product of powers of the exponentials, or a sum of
//! multiples of the logarithms, lies in the field. Over rational functions and their roots the exponentials of `u_1, u_2, ...`
//! are independent where no integer combination of the `u_i` is constant, and logarithms of `a_j` where the forms `da_j/a_j` are linearly
//! independent: a sum of them has only simple poles, and no exact form has. Sine and cosine of `w` are those of `exp(i w)`, `atan(u)`
//! is the integral of `du/(1 + u^2)`. Arguments that hold functions themselves are left to others.

use crate::expression::{Derivation, Graph, Node, NodeId, Program, Symbol, draw_residues};
use crate::number::{Arithmetic, Function, PrimeField};
use crate::observability::elimination::rank;
use rand_chacha::ChaCha8Rng;

/// Whether functions, sines and cosines of angles aside, are shown to satisfy no relation but those that define them.
pub(super) fn independent(
    graph: &mut Graph,
    functions: &[NodeId],
    is_angle: &dyn Fn(Symbol) -> bool,
    rng: &mut ChaCha8Rng,
) -> bool {
    let (mut exponents, mut turns, mut forms): (Vec<NodeId>, Vec<NodeId>, Vec<(NodeId, NodeId)>) =
        Default::default();
    for id in functions {
        let Node::Apply(function, argument) = graph.node(*id) else { return false };
        let met = graph.reachable([argument]);
        if met.iter().any(|id| matches!(graph.node(*id), Node::Apply(..) | Node::Pi)) {
            return false;
        }
        match function {
            Function::Exp => exponents.push(argument),
            Function::Sin | Function::Cos if !turns.contains(&argument) => turns.push(argument),
            Function::Sin | Function::Cos => {}
            Function::Log => forms.push((argument, argument)),
            Function::Atan => {
                let square = graph.mul(argument, argument);
                let one = graph.integer(1);
                forms.push((argument, graph.add(one, square)));
            }
            // one root of a rational function, which is algebraic: its sign is looked at elsewhere
            Function::Sqrt => {}
            _ => return false,
        }
    }
    // an angle that also stands by itself is one more argument of sines
    let bare = graph.reachable(functions.iter().copied());
    let angle = |id: &NodeId| graph.as_symbol(*id).is_some_and(is_angle);
    if bare.iter().any(angle) {
        return false;
    }
    no_constant_combination(graph, &exponents, rng)
        && no_constant_combination(graph, &turns, rng)
        && independent_forms(graph, &forms, rng)
}

/// Whether no combination of some expressions is constant: their differences between points are independent.
fn no_constant_combination(graph: &Graph, arguments: &[NodeId], rng: &mut ChaCha8Rng) -> bool {
    if arguments.is_empty() {
        return true;
    }
    let program = Program::with_unknown_functions(graph, arguments, |_| false);
    let field = PrimeField::random(rng);
    let Some(origin) = value(&program, field, rng) else { return false };
    let rows: Option<Vec<Vec<u64>>> = arguments
        .iter()
        .map(|_| {
            let point = value(&program, field, rng)?;
            point.iter().zip(&origin).map(|(a, b)| field.sub(a, b).ok()).collect()
        })
        .collect();
    rows.is_some_and(|rows| rank(&field, rows) == Ok(arguments.len()))
}

/// Whether the forms `du/b` are linearly independent over the constants.
fn independent_forms(graph: &mut Graph, forms: &[(NodeId, NodeId)], rng: &mut ChaCha8Rng) -> bool {
    if forms.is_empty() {
        return true;
    }
    let symbols = graph.symbols_of(forms.iter().flat_map(|(u, b)| [*u, *b]));
    let mut entries = Vec::new();
    for symbol in &symbols {
        let mut partial = Derivation::partial(graph, *symbol);
        for (u, b) in forms {
            let slope = partial.apply(graph, *u);
            entries.push(graph.div(slope, *b));
        }
    }
    let program = Program::with_unknown_functions(graph, &entries, |_| false);
    let field = PrimeField::random(rng);
    let mut rows = Vec::new();
    for _ in forms {
        let Some(point) = value(&program, field, rng) else { return false };
        rows.extend(point.chunks(forms.len()).map(<[u64]>::to_vec));
    }
    rank(&field, rows) == Ok(forms.len())
}

/// The values at a random point; none where it is a pole.
fn value(program: &Program, field: PrimeField, rng: &mut ChaCha8Rng) -> Option<Vec<u64>> {
    let inputs = draw_residues(program, &field, rng);
    program.load(field).ok()?.run(&inputs, &mut Vec::new()).ok()
}
