//! Sets of states to walk into: those that a file names; and where it names none, what it says to avoid, what its rows divide
//! by, and each of its quantities at zero.

use palmistry_lang::{LineEnd, LineView, NamedSet, System};
use palmistry_math::expression::{Node, NodeId};
use palmistry_rank::observability::{Branch, Locus, State, parse_condition, solve_conditions};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Where lines go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Approach {
    /// To a set of states that meet conditions of the language.
    Set { title: String, conditions: Vec<String> },
    /// To where a quantity is infinite; its distance from there is its reciprocal.
    Infinity { title: String, symbol: String },
}

impl Approach {
    /// Its title.
    pub fn title(&self) -> &str {
        match self {
            Approach::Set { title, .. } | Approach::Infinity { title, .. } => title,
        }
    }
}

/// Lines that are ready to be walked: states on a branch of the set, and what moves away from it.
pub(super) struct Prepared {
    pub title: String,
    /// How the conditions were met, in words.
    pub steps: Vec<String>,
    pub moving: Vec<palmistry_math::expression::Symbol>,
    pub to_infinity: bool,
    /// Exact states on the set; for a quantity that goes to infinity, any states.
    pub bases: Vec<State>,
}

impl Approach {
    /// Draws states on each branch of the set. `rows` are what will be evaluated.
    ///
    /// # Errors
    /// In words: conditions that cannot be solved, a name that is not known, a set without states.
    pub(super) fn prepare(
        &self,
        system: &mut System,
        rows: &[NodeId],
        states: u64,
        seed: u64,
    ) -> Result<Vec<Prepared>, String> {
        let (branches, infinite) = match self {
            Approach::Set { conditions, .. } => {
                let equations =
                    conditions.iter().map(|text| parse_condition(text)).collect::<Result<Vec<_>, _>>()?;
                (solve_conditions(system, &equations.concat()).map_err(|why| why.to_string())?, None)
            }
            Approach::Infinity { symbol, .. } => {
                let known = system.find_symbol(symbol).filter(|symbol| !system.is_angle(*symbol));
                let found = known.ok_or_else(|| format!("'{symbol}' is no quantity of {}", system.name))?;
                (vec![Branch::default()], Some(found))
            }
        };
        let several = branches.len() > 1;
        let mut prepared = Vec::new();
        for branch in branches {
            let mut moving: Vec<_> = branch.values.keys().copied().chain(infinite).collect();
            moving.sort_unstable();
            if moving.is_empty() {
                return Err("every state meets the condition".to_owned());
            }
            let locus = Locus::new(system, &branch, &BTreeMap::new(), rows).map_err(|e| e.to_string())?;
            let bases = (0..states).map(|index| locus.draw(seed, index)).collect::<Result<Vec<_>, _>>();
            let mut title = self.title().to_owned();
            if several {
                title = format!("{title}, {}", branch.steps.join(", "));
            }
            prepared.push(Prepared {
                title,
                steps: branch.steps,
                moving,
                to_infinity: infinite.is_some(),
                bases: bases.map_err(|e| e.to_string())?,
            });
        }
        Ok(prepared)
    }
}

/// Where lines go in a system: to the sets that its file names and to where lines go to infinity; where it names none, to
/// what its rows suggest. `rows` are what is evaluated.
pub fn approaches_of(system: &System, rows: &[NodeId]) -> Vec<Approach> {
    let set = |set: &NamedSet| Approach::Set { title: set.name.clone(), conditions: set.written.clone() };
    let infinite = |line: &LineView| {
        (line.end == LineEnd::Infinity)
            .then(|| Approach::Infinity { title: line.title.clone(), symbol: line.moving.clone() })
    };
    let named: Vec<Approach> =
        system.sets.iter().map(set).chain(system.lines.iter().filter_map(infinite)).collect();
    if named.is_empty() { suggested(system, rows) } else { named }
}

/// The sets of a system of which nothing is known but its rows: see the module's head.
fn suggested(system: &System, rows: &[NodeId]) -> Vec<Approach> {
    let mut found: Vec<Approach> = Vec::new();
    let mut met = BTreeSet::new();
    let mut add = |title: String, expression: String| {
        if met.insert(expression.clone()) {
            found.push(Approach::Set { title, conditions: vec![format!("{expression} = 0")] });
        }
    };
    for (text, node) in &system.avoid {
        // as the graph writes it, so that a divisor which is the same is not taken twice
        let factors = factors(system, *node);
        if let [factor] = factors[..] {
            add(format!("{text} to zero"), system.graph.text(factor));
        } else {
            for factor in factors {
                let expression = system.graph.text(factor);
                add(format!("{expression} to zero"), expression);
            }
        }
    }
    for divisor in divisors(system, rows) {
        let expression = system.graph.text(divisor);
        add(format!("the divisor {expression} to zero"), expression);
    }
    let mentioned = system.graph.symbols_of(rows.iter().copied());
    for (symbol, info) in system.symbols().filter(|(symbol, _)| mentioned.contains(symbol)) {
        let name = system.symbol_name(symbol);
        if info.is_angle {
            add(format!("sin({name}) to zero"), format!("sin({name})"));
        } else {
            add(format!("{name} to zero"), name.to_owned());
        }
    }
    found
}

/// What the rows divide by, factor by factor, in the order of the graph.
fn divisors(system: &System, rows: &[NodeId]) -> Vec<NodeId> {
    let mut found = BTreeSet::new();
    for node in system.graph.reachable(rows.iter().copied()) {
        match system.graph.node(node) {
            Node::Div(_, divisor) => found.extend(factors(system, divisor)),
            Node::Power(base, exponent) if exponent < 0 => found.extend(factors(system, base)),
            _ => {}
        }
    }
    found.into_iter().collect()
}

/// The factors of a product that are not constants: through products, powers, signs, and numerators.
fn factors(system: &System, node: NodeId) -> Vec<NodeId> {
    let mut found = Vec::new();
    let mut stack = vec![node];
    let mut seen = HashMap::new();
    while let Some(node) = stack.pop() {
        if seen.insert(node, ()).is_some() {
            continue;
        }
        match system.graph.node(node) {
            Node::Mul(a, b) => stack.extend([a, b]),
            Node::Power(base, exponent) if exponent > 0 => stack.push(base),
            Node::Div(top, _) => stack.push(top),
            Node::Neg(inner) => stack.push(inner),
            _ if system.graph.symbols_of([node]).is_empty() => {}
            _ => found.push(node),
        }
    }
    found.sort_unstable();
    found
}
