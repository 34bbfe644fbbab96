//! Expressions in the functions of their generators: equal exponentials, roots and logarithms under one name.

use super::generators::Key;
use super::{Adjunction, Halt, MOST_NODES, MOST_PASSES};
use crate::expression::{Graph, Guard, Node, NodeId, Symbol};
use crate::number::{Function, Turn};
use rand::{Rng, RngExt};
use std::collections::HashMap;

/// Expressions that are equal to others wherever these exist and the assumptions hold.
#[derive(Clone, Debug)]
pub struct NormalForm {
    /// The expressions, in the functions that generators are.
    pub nodes: Vec<NodeId>,
    /// Whether the functions that are no constants are shown to satisfy no equation but the known ones, on any component of the
    /// domain.
    pub independent: bool,
    /// Whether all relations between constants are known too: at most one of them is no algebraic number.
    pub constants_known: bool,
    /// Arguments of absolute values whose signs are not known, and other expressions whose signs distinguish roots.
    pub open_signs: Vec<NodeId>,
}

/// Writes expressions in the functions of their generators; angles are written out already. The graph keeps the generators' names.
///
/// # Errors
/// In words: the functions are too many or too deep.
pub fn normal_form(
    graph: &mut Graph,
    nodes: &[NodeId],
    assumptions: &[Guard],
    rng: &mut impl Rng,
) -> Result<NormalForm, String> {
    let turn = Turn::new(1).ok_or("no turn is divided")?;
    let mut all = Adjunction::new(graph, turn, rng.random());
    let images = all.images_of(nodes, assumptions)?;
    let standing = all.standing(&images);
    Ok(NormalForm {
        independent: standing.independent,
        constants_known: standing.constants_known,
        open_signs: standing.open.iter().filter_map(|form| all.original(form)).collect(),
        nodes: all.originals(&images).ok_or("a generator has no name of its own")?,
    })
}

/// Writes roots of squares without the root where the assumptions give the sign; all else stays as it is.
pub fn without_signs(
    graph: &mut Graph,
    nodes: &[NodeId],
    assumptions: &[Guard],
    rng: &mut impl Rng,
) -> Vec<NodeId> {
    let roots: Vec<NodeId> = graph
        .reachable(nodes.iter().copied())
        .into_iter()
        .filter(|id| matches!(graph.node(*id), Node::Apply(Function::Sqrt, _)))
        .collect();
    let mut known: HashMap<NodeId, NodeId> = HashMap::new();
    if let Some(turn) = Turn::new(1)
        && !roots.is_empty()
    {
        let mut all = Adjunction::new(graph, turn, rng.random());
        let images = all.images_of(&roots, assumptions).unwrap_or_default();
        for (root, image) in roots.iter().zip(images) {
            if let Some(form) = all.form(image)
                && !all.has_root(&form)
                && let Some(node) = all.original(&form)
            {
                known.insert(*root, node);
            }
        }
    }
    let mut found: HashMap<NodeId, NodeId> = HashMap::new();
    for id in graph.reachable(nodes.iter().copied()) {
        let new = match known.get(&id) {
            Some(new) => *new,
            None => {
                let node = graph.node(id);
                graph.rebuild(node, |operand| found[&operand])
            }
        };
        found.insert(id, new);
    }
    nodes.iter().map(|node| found[node]).collect()
}

impl Adjunction<'_> {
    /// Expressions over generators.
    ///
    /// # Errors
    /// In words.
    pub(super) fn images_of(
        &mut self,
        nodes: &[NodeId],
        assumptions: &[Guard],
    ) -> Result<Vec<NodeId>, String> {
        if self.graph.reachable(nodes.iter().copied()).len() > MOST_NODES {
            return Err(format!("functions are met in more than {MOST_NODES} operations"));
        }
        for _ in 0..MOST_PASSES {
            match self.rewritten_all(nodes, assumptions) {
                Ok(found) => return Ok(found),
                Err(Halt::Stop(why)) => return Err(why),
                Err(Halt::Again) => {}
            }
        }
        Err("the arguments of its functions have too many denominators".to_owned())
    }

    /// Expressions over generators, in the functions that the generators are.
    fn originals(&mut self, images: &[NodeId]) -> Option<Vec<NodeId>> {
        let mut values: HashMap<Symbol, NodeId> = HashMap::new();
        for symbol in self.graph.symbols_of(images.iter().copied()) {
            let value = match self.generators.circles.get(&symbol).copied() {
                Some(circle) => self.original_angle(circle)?,
                None => match self.generators.of_symbol(symbol) {
                    Some(variable) => self.original_generator(variable, 0)?,
                    None => continue,
                },
            };
            values.insert(symbol, value);
        }
        Some(self.graph.substitute(images, &values))
    }

    /// Whether a root of something that varies is a part of a form: of a symbol, too, which may be zero.
    fn has_root(&self, form: &super::form::Form) -> bool {
        form.variables().into_iter().any(|variable| {
            let key = self.generators.key(variable);
            matches!(key, Key::Root(_) | Key::Abs(_) | Key::Power(..) | Key::Part(_))
        })
    }
}
