//! Conditions such as `omega1 = 0`, `sin(phi1) = 0` or the vanishing of a determinant, solved for one symbol each, so
//! that states which meet them can be written down exactly.

use crate::expression::syntax::Equation;
use crate::expression::{
    Input, Node, NodeId, Program, Symbol, ZeroTest, expand_angles, identically_zero, share_a_factor,
};
use crate::number::Function;
use crate::system::{Assignment, Kind, System, Value};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// One way to meet all conditions: values for some symbols in terms of the others.
#[derive(Clone, Debug, Default)]
pub struct Branch {
    /// Angles that were solved for from a sine or cosine: their values are known up to whole turns.
    pub up_to_turns: Vec<Symbol>,
    /// The solved symbols; no value mentions a solved symbol.
    pub values: Assignment,
    /// How each condition was met, in words.
    pub steps: Vec<String>,
}

/// Why a condition could not be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsolved {
    /// It cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// It cannot be met.
    #[error("the condition '{0}' is never met")]
    Never(String),
    /// It cannot be solved for a symbol.
    #[error("the condition '{0}' is not linear in any symbol; write it as name = expression")]
    NotLinear(String),
    /// It is met on several sets at once, as a product is.
    #[error("the condition '{0}' is met in more than one way; name the factor that is to vanish")]
    Several(String),
}

/// Conditions are quoted in messages up to so many characters.
const LONGEST_QUOTE: usize = 80;

/// Solves conditions one after the other. `sin(u) = 0` and `cos(u) = 0` have two branches each.
///
/// # Errors
/// A condition that has no solution of the kinds that are known: `name = expression`, a sine or cosine that vanishes,
/// or an equation that is linear in some symbol.
pub fn solve_conditions(system: &mut System, conditions: &[Equation]) -> Result<Vec<Branch>, Unsolved> {
    let mut branches = vec![Branch::default()];
    for condition in conditions {
        let mut side = |expr| match system.elaborate(expr) {
            Ok(Value::Scalar(id)) => Ok(id),
            Ok(other) => Err(Unsolved::Unreadable(format!("a condition equates {}", other.describe()))),
            Err(problem) => Err(Unsolved::Unreadable(problem.message)),
        };
        let (left, right) = (side(&condition.left)?, side(&condition.right)?);
        let mut text = format!("{} = {}", system.graph.text(left), system.graph.text(right));
        if text.chars().count() > LONGEST_QUOTE {
            text = text.chars().take(LONGEST_QUOTE).chain("...".chars()).collect();
        }
        let mut next = Vec::new();
        for branch in &branches {
            let sides = system.graph.substitute(&[left, right], &branch.values);
            let found = match solutions(system, sides[0], sides[1], &text) {
                Err(Unsolved::Never(_)) => continue, // not on this branch
                found => found?,
            };
            let by_turns = found.len() > 1;
            for (symbol, value) in found {
                let Some(symbol) = symbol else {
                    next.push(branch.clone()); // the condition holds already
                    continue;
                };
                let single = Assignment::from([(symbol, value)]);
                let mut extended = branch.clone();
                for known in extended.values.values_mut() {
                    *known = system.graph.substitute(&[*known], &single)[0];
                }
                extended.values.insert(symbol, value);
                if by_turns {
                    extended.up_to_turns.push(symbol);
                }
                extended.steps.push(format!("{} = {}", system.symbol_name(symbol), system.graph.text(value)));
                next.push(extended);
            }
        }
        if next.is_empty() {
            return Err(Unsolved::Never(text));
        }
        branches = next;
    }
    Ok(branches)
}

impl Branch {
    /// Refuses a codistribution that tells apart what the conditions leave open; see [`Branch::check_turns`].
    ///
    /// # Errors
    /// In words: which angle is known up to whole turns only.
    pub fn check_codistribution(&self, system: &mut System) -> Result<(), String> {
        if self.up_to_turns.is_empty() {
            return Ok(());
        }
        let ingredients = ingredients(system);
        self.check_turns(system, &ingredients)
    }

    /// Refuses expressions that tell apart the values which a condition such as `sin(phi) = 0` leaves open: all that differ
    /// by whole turns.
    ///
    /// # Errors
    /// In words: which angle is known up to whole turns only.
    pub fn check_turns(&self, system: &mut System, expressions: &[NodeId]) -> Result<(), String> {
        for angle in &self.up_to_turns {
            if !turns_do_not_matter(system, expressions, *angle) {
                let name = system.symbol_name(*angle);
                return Err(format!(
                    "the condition fixes '{name}' up to whole turns, and the statement tells them apart"
                ));
            }
        }
        Ok(())
    }
}

/// What every Lie derivative's differential is made of: the outputs' differentials and the fields' components.
fn ingredients(system: &mut System) -> Vec<NodeId> {
    let mut found: Vec<NodeId> = Vec::new();
    for (_, output) in system.outputs.clone() {
        found.extend(system.differential(output));
    }
    let moving = system.moving_fields();
    found.extend(
        moving.iter().flat_map(|field| system.fields[*field].components.iter().map(|(_, node)| *node)),
    );
    found
}

/// Whether expressions mention an angle only through sines and cosines of integer combinations, so that whole turns of
/// it do not matter.
fn turns_do_not_matter(system: &mut System, expressions: &[NodeId], angle: Symbol) -> bool {
    let angles = system.angles();
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    let expanded = expand_angles(&mut system.graph, expressions, is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle, true);
    program.inputs().iter().all(|input| match input {
        Input::Plain(symbol) => *symbol != angle,
        Input::Opaque(node) => !system.graph.symbols_of([*node]).contains(&angle),
        Input::Sine(_) | Input::Cosine(_) => true,
    })
}

type Solutions = Vec<(Option<Symbol>, NodeId)>;

fn solutions(system: &mut System, left: NodeId, right: NodeId, text: &str) -> Result<Solutions, Unsolved> {
    // a name on one side, not met on the other
    for (name, value) in [(left, right), (right, left)] {
        if let Some(symbol) = system.graph.as_symbol(name)
            && !system.graph.symbols_of([value]).contains(&symbol)
        {
            return Ok(vec![(Some(symbol), value)]);
        }
    }
    let difference = system.graph.sub(left, right);
    if vanishes(system, difference) {
        return Ok(vec![(None, difference)]);
    }
    if system.graph.symbols_of([difference]).is_empty() {
        return Err(Unsolved::Never(text.to_owned()));
    }
    if let Some(found) = circular(system, difference) {
        return Ok(found);
    }
    // states before parameters, in the order of the file, so that the answer does not depend on anything else
    let mut candidates = system.states.clone();
    candidates
        .extend(system.symbols().filter(|(_, info)| info.kind != Kind::State).map(|(symbol, _)| symbol));
    let mentioned = system.graph.symbols_of([difference]);
    candidates.retain(|symbol| !system.is_angle(*symbol) && mentioned.contains(symbol));
    let mut several = false;
    for symbol in candidates {
        if let Some(value) = linear_solution(system, difference, symbol) {
            // a x + b = 0 is x = -b/a, and also whatever makes a and b vanish together
            if also_met_otherwise(system, difference, symbol) {
                several = true;
            } else {
                return Ok(vec![(Some(symbol), value)]);
            }
        }
    }
    Err(if several { Unsolved::Several(text.to_owned()) } else { Unsolved::NotLinear(text.to_owned()) })
}

/// Whether an expression `a x + b` has a factor that does not depend on `x`: then it vanishes with that factor too, and
/// `x = -b/a` is not all.
pub fn also_met_otherwise(system: &mut System, expression: NodeId, symbol: Symbol) -> bool {
    let slope = system.partial(expression, symbol);
    let zero = system.graph.integer(0);
    let both = system.graph.substitute(&[slope, expression], &Assignment::from([(symbol, zero)]));
    let angles = system.angles();
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    let both = expand_angles(&mut system.graph, &both, is_angle);
    let mut rng = ChaCha8Rng::seed_from_u64(0x6c69_6e65);
    share_a_factor(&system.graph, both[0], both[1], is_angle, &mut rng) != Some(false)
}

/// `sin(u) = 0` and `cos(u) = 0` for an integer combination `u` of angles, solved for an angle whose factor in it is
/// plus or minus one.
fn circular(system: &mut System, difference: NodeId) -> Option<Solutions> {
    let inner = match system.graph.node(difference) {
        Node::Neg(inner) => inner,
        _ => difference,
    };
    let Node::Apply(function, argument) = system.graph.node(inner) else { return None };
    let pi = system.graph.pi();
    let zero = system.graph.integer(0);
    let roots = match function {
        Function::Sin => [zero, pi],
        Function::Cos => {
            let two = system.graph.integer(2);
            let quarter = system.graph.div(pi, two);
            [quarter, system.graph.neg(quarter)]
        }
        _ => return None,
    };
    for symbol in system.graph.symbols_of([argument]) {
        if !system.is_angle(symbol) {
            continue;
        }
        let slope = system.partial(argument, symbol);
        let sign = system.graph.constant_value(slope).cloned();
        let Some(sign) = sign.filter(|s| s.is_one() || *s == dashu::rational::RBig::from(-1)) else {
            continue;
        };
        let rest = system.graph.substitute(&[argument], &Assignment::from([(symbol, zero)]))[0];
        return Some(
            roots
                .iter()
                .map(|root| {
                    let moved = system.graph.sub(*root, rest);
                    let value = if sign.is_one() { moved } else { system.graph.neg(moved) };
                    (Some(symbol), value)
                })
                .collect(),
        );
    }
    None
}

/// The root of an expression that is linear in a symbol, confirmed by putting it in.
pub fn linear_solution(system: &mut System, expression: NodeId, symbol: Symbol) -> Option<NodeId> {
    let slope = system.partial(expression, symbol);
    let bend = system.partial(slope, symbol);
    if vanishes(system, slope) || !vanishes(system, bend) {
        return None;
    }
    let zero = system.graph.integer(0);
    let at_zero = Assignment::from([(symbol, zero)]);
    // both at symbol = 0: a linear expression is its value there plus its slope there times the symbol
    let both = system.graph.substitute(&[expression, slope], &at_zero);
    let value_is_finite = matches!(test(system, &both[..1]), ZeroTest::Zero { .. } | ZeroTest::Nonzero(_));
    if !value_is_finite || !matches!(test(system, &both[1..]), ZeroTest::Nonzero(_)) {
        return None;
    }
    let quotient = system.graph.div(both[0], both[1]);
    let root = system.graph.neg(quotient);
    let value = system.graph.substitute(&[expression], &Assignment::from([(symbol, root)]))[0];
    vanishes(system, value).then_some(root)
}

/// Whether an expression is identically zero, by exact arithmetic at random points.
pub(crate) fn vanishes(system: &mut System, expression: NodeId) -> bool {
    all_vanish(system, &[expression])
}

/// Whether all of some expressions are.
pub(crate) fn all_vanish(system: &mut System, expressions: &[NodeId]) -> bool {
    matches!(test(system, expressions), ZeroTest::Zero { .. })
}

fn test(system: &mut System, expressions: &[NodeId]) -> ZeroTest {
    let angles = system.angles();
    let is_angle = |symbol: Symbol| angles.contains(&symbol);
    let expanded = expand_angles(&mut system.graph, expressions, is_angle);
    let mut rng = ChaCha8Rng::seed_from_u64(0x7a65_726f); // any fixed seed: the same file gives the same answer
    identically_zero(&system.graph, &expanded, is_angle, &mut rng)
}
