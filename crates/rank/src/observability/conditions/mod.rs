//! Conditions such as `omega1 = 0`, `sin(phi1) = 0` or the vanishing of a determinant, solved for one symbol each, so
//! that states which meet them can be written down exactly.
//!
//! The set of states that meet all conditions is divided into branches. On each one some symbols have values in terms of
//! the others, valid where the branch's guards hold: `a x + b = 0` is met by `x = -b/a` where `a` is not zero, and where `a`
//! and `b` both vanish, which is another branch. Every branch is followed to its end: solved, proved empty, or given back as
//! what could not be solved. Of `k` conditions no part of the set that is a part of its own has less than the dimension
//! of all states less `k`; what is thinner than that (as the edge of a sheet is) need not be solved where a statement is about
//! almost all states, and is named. Which condition is taken first is decided by what it says and not by where it stands.

mod circular;
mod implicit;
mod sampled;
mod single;
mod turns;
mod vanishing;
mod way;
mod written;

pub use single::{also_met_otherwise, linear_solution};
pub(crate) use vanishing::all_vanish;
#[doc(hidden)]
pub use vanishing::vanishes;
pub use written::parse_condition;

use palmistry_lang::{Assignment, System};
use palmistry_math::expression::syntax::{Equation, Relation};
use palmistry_math::expression::{Graph, Guard, Need, NodeId, Symbol, add_guard, sign};
use single::{factors_of, is_nowhere_zero, touching, way, way_apart_from_turns};
use turns::turns_do_not_matter;
use vanishing::{is_a_constant_but_zero, vanish_where};
use way::{Apart, Way};

/// One way to meet all conditions: values for some symbols in terms of the others.
#[derive(Clone, Debug, Default)]
pub struct Branch {
    /// Angles that were solved for from a sine or cosine: their values are known up to whole turns.
    pub up_to_turns: Vec<Symbol>,
    /// The solved symbols; no value mentions a solved symbol.
    pub values: Assignment,
    /// The same for all but the angles of [`Branch::up_to_turns`], which these values may mention.
    pub(crate) before_turns: Assignment,
    /// What has to hold for the values, and both sides of all conditions, to exist. In terms of all symbols.
    pub guards: Vec<Guard>,
    /// Those of the guards that were conditions: inequalities.
    pub assumed: Vec<Guard>,
    /// How each condition was met, in words.
    pub steps: Vec<String>,
    /// What does not vanish on it, in words: elsewhere an output that is zero leaves a signal free, which may be a part of its own.
    pub beside: Vec<String>,
}

/// The set of states that meet some conditions.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// Its parts of the largest dimension.
    pub parts: Vec<Branch>,
    /// Branches of fewer dimensions, which may be parts of their own.
    pub smaller: Vec<Branch>,
    /// Branches that have too few dimensions for that: edges and crossings of parts.
    pub thinner: Vec<Branch>,
    /// Thinner branches that could not be solved.
    pub unsolved: Vec<UnsolvedBranch>,
}

impl Branch {
    /// What holds on it: how its conditions were solved, and what was assumed of the rest.
    pub fn in_words(&self, system: &System) -> Vec<String> {
        let assumed = self.assumed.iter().map(|guard| guard.text(&system.graph));
        let given = self.beside.iter().map(|slope| format!("{slope} != 0"));
        self.steps.iter().cloned().chain(assumed).chain(given).collect()
    }
}

/// A branch some conditions of which could not be solved.
#[derive(Clone, Debug, Default)]
pub struct UnsolvedBranch {
    /// What was solved.
    pub branch: Branch,
    /// What vanishes on it besides.
    pub open: Vec<NodeId>,
    /// All of its conditions, in words.
    pub text: String,
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
    /// The conditions exclude each other.
    #[error("the conditions are never met together")]
    NeverTogether,
    /// It cannot be solved for a symbol.
    #[error("the condition '{0}' is not linear in any symbol; write it as name = expression")]
    NotLinear(String),
    /// It is met on several sets at once, one of which cannot be solved.
    #[error("the condition '{0}' is met in more than one way; name the factor that is to vanish")]
    Several(String),
    /// It is not known whether it is met.
    #[error("it is not known whether the condition '{0}' can be met there")]
    NotKnown(String),
    /// On the branch an output that is zero does not give the last derivatives of known signals.
    #[error(
        "there the equation '{0}' ties the known signals otherwise than at generic states: which derivatives they can have is not known"
    )]
    TiesOtherwise(String),
    /// There are too many ways to meet them.
    #[error("the conditions are met in more than {MOST_BRANCHES} ways")]
    TooMany,
}

impl Unsolved {
    /// Whether there may be states that meet the conditions, for all that is known.
    pub fn may_be_met(&self) -> bool {
        match self {
            Unsolved::Unreadable(_) | Unsolved::Never(_) | Unsolved::NeverTogether => false,
            Unsolved::NotLinear(_)
            | Unsolved::Several(_)
            | Unsolved::NotKnown(_)
            | Unsolved::TiesOtherwise(_)
            | Unsolved::TooMany => true,
        }
    }
}

/// Conditions are quoted in messages up to so many characters.
const LONGEST_QUOTE: usize = 80;
/// No more branches than this are followed.
const MOST_BRANCHES: usize = 64;
/// What is thinner than a part is followed as long as its conditions have no more operations.
const LONGEST_OF_THIN: usize = 150;

/// The parts of the set on which all conditions hold; see `solve`.
///
/// # Errors
/// As for `solve`.
pub fn solve_conditions(system: &mut System, conditions: &[Equation]) -> Result<Vec<Branch>, Unsolved> {
    let solution = solve(system, conditions, &[])?;
    Ok(solution.parts.into_iter().chain(solution.smaller).collect())
}

/// A condition that is not yet met.
#[derive(Clone, Debug)]
struct Condition {
    left: NodeId,
    right: NodeId,
    /// As it is quoted: the condition of the file that it comes from.
    text: String,
    /// Whether its left side is nowhere negative, and its derivatives are among the conditions.
    touches: bool,
}

/// A branch on the way.
#[derive(Clone, Debug, Default)]
struct Partial {
    values: Assignment,
    turns: Vec<(Symbol, NodeId)>,
    guards: Vec<Guard>,
    assumed: Vec<Guard>,
    steps: Vec<String>,
    open: Vec<Condition>,
    /// How many symbols are solved for.
    codimension: usize,
    /// By how many dimensions it is smaller than the set of all states, at the least.
    least: usize,
    /// Whether it comes of a condition that is met in several ways.
    several: bool,
    /// What is kept from zero wherever there is anything to speak of, by no condition.
    kept: Vec<Guard>,
}

/// What one step made of a branch.
enum Step {
    Done(Partial),
    Empty(String),
    Open(Vec<Partial>),
    Stuck(Partial, Unsolved),
}

/// Divides the set on which all conditions hold into branches and solves each, for a statement about those of its states at which some
/// guards hold: what they keep from zero can be divided by, and parts that are thinner than the set are followed only where they may hold.
///
/// # Errors
/// Where a branch that is no thinner than a part of the set cannot be solved, or where no state meets all conditions.
pub fn solve(system: &mut System, conditions: &[Equation], guards: &[Guard]) -> Result<Solution, Unsolved> {
    let mut start = begin(system, conditions)?;
    start.kept = guards.iter().filter(|guard| guard.need == Need::NotZero).copied().collect();
    let count = start.open.len();
    follow(system, start, count)
}

/// Follows a branch to the ends of all that it divides into; of `count` conditions it has `open` ones.
fn follow(system: &mut System, start: Partial, count: usize) -> Result<Solution, Unsolved> {
    let several_asked = start.open.len() != 1;
    let only = start.open.first().map(|condition| condition.text.clone()).unwrap_or_default();
    let (mut work, mut done, mut unsolved, mut never) = (vec![start], Vec::new(), Vec::new(), None);
    let mut followed = 0;
    while let Some(partial) = work.pop() {
        followed += 1;
        if followed > 4 * MOST_BRANCHES || work.len() + done.len() > MOST_BRANCHES {
            return Err(Unsolved::TooMany);
        }
        let next = match partial.least > count && followed > 2 * MOST_BRANCHES {
            true => Step::Stuck(partial, Unsolved::TooMany),
            false => step(system, partial, count),
        };
        match next {
            Step::Empty(why) => never = never.or(Some(why)),
            Step::Open(next) => work.extend(next.into_iter().rev()),
            Step::Stuck(partial, _) if partial.least > count => {
                let quoted = partial.open.iter().map(|c| quote(system, c.left, c.right));
                let steps: Vec<String> = partial.steps.iter().cloned().chain(quoted).collect();
                let open = partial.open.clone();
                let open = open.iter().map(|c| system.graph.sub(c.left, c.right)).collect();
                unsolved.push(UnsolvedBranch {
                    text: steps.join(", "),
                    open,
                    branch: finish(system, partial),
                });
            }
            Step::Stuck(partial, _) if partial.several && !several_asked => {
                return Err(Unsolved::Several(only));
            }
            Step::Stuck(_, why) => return Err(why),
            Step::Done(partial) => {
                let codimension = partial.codimension;
                done.push((codimension, finish(system, partial)));
            }
        }
    }
    let Some(least) = done.iter().map(|(codimension, _)| *codimension).min() else {
        return Err(match (never, unsolved.is_empty()) {
            (_, false) => Unsolved::NotKnown(unsolved.remove(0).text),
            (Some(text), true) if !several_asked => Unsolved::Never(text),
            _ => Unsolved::NeverTogether,
        });
    };
    let mut solution = Solution { unsolved, ..Solution::default() };
    for (codimension, branch) in done {
        match codimension {
            _ if codimension == least => solution.parts.push(branch),
            _ if codimension <= count => solution.smaller.push(branch),
            _ => solution.thinner.push(branch),
        }
    }
    Ok(solution)
}

/// All conditions, read, each once.
fn begin(system: &mut System, conditions: &[Equation]) -> Result<Partial, Unsolved> {
    let mut partial = Partial::default();
    for condition in conditions {
        let mut side = |expr| {
            let (value, guards) =
                system.elaborate_guarded(expr).map_err(|problem| Unsolved::Unreadable(problem.message))?;
            let found = value.as_number().map(|id| (id, guards));
            found.ok_or_else(|| Unsolved::Unreadable(format!("a condition equates {}", value.describe())))
        };
        let ((left, before), (right, after)) = (side(&condition.left)?, side(&condition.right)?);
        for guard in before.into_iter().chain(after) {
            add_guard(&system.graph, &mut partial.guards, guard);
        }
        if let Some(guard) = assumed(&mut system.graph, condition.relation, left, right) {
            add_guard(&system.graph, &mut partial.guards, guard);
            add_guard(&system.graph, &mut partial.assumed, guard);
            continue;
        }
        let text = quote(system, left, right);
        let difference = system.graph.sub(left, right);
        if vanish_where(system, &[difference], &partial.guards) {
            continue; // it says nothing, wherever both sides exist
        }
        if !partial.open.iter().any(|other| (other.left, other.right) == (left, right)) {
            partial.open.push(Condition { left, right, text, touches: false });
        }
    }
    Ok(partial)
}

/// What an inequality needs: the greater side less the other one is positive, or not negative. `None` for an equation.
pub fn assumed(graph: &mut Graph, relation: Relation, left: NodeId, right: NodeId) -> Option<Guard> {
    let (more, less) = if relation.points_up() { (right, left) } else { (left, right) };
    let need = match relation {
        Relation::Equal => return None,
        Relation::NotEqual => Need::NotZero,
        Relation::Less | Relation::Greater => Need::Positive,
        Relation::AtMost | Relation::AtLeast => Need::NotNegative,
    };
    Some(Guard { node: graph.sub(more, less), need })
}

fn quote(system: &System, left: NodeId, right: NodeId) -> String {
    shortened(format!("{} = {}", system.graph.text(left), system.graph.text(right)))
}

fn shortened(text: String) -> String {
    match text.chars().count() > LONGEST_QUOTE {
        true => text.chars().take(LONGEST_QUOTE).chain("...".chars()).collect(),
        false => text,
    }
}

impl Partial {
    /// Expressions with all values put in, those of angles only where whole turns do not matter.
    fn put_in(&self, system: &mut System, expressions: &[NodeId]) -> Vec<NodeId> {
        let mut found = system.graph.substitute(expressions, &self.values);
        for (angle, value) in &self.turns {
            if turns_do_not_matter(system, &found, *angle) {
                found = system.graph.substitute(&found, &Assignment::from([(*angle, *value)]));
            }
        }
        found
    }

    /// A guard that holds nowhere on the branch; of parts that are thinner than the set also one of those that the statement needs.
    fn fails(&self, system: &mut System, count: usize) -> Option<Guard> {
        let is_thin = self.least > count;
        let guards: Vec<Guard> =
            self.guards.iter().chain(self.kept.iter().filter(|_| is_thin)).copied().collect();
        let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
        let there = self.put_in(system, &nodes);
        let mut both = guards.iter().zip(there);
        both.find(|(guard, node)| {
            Guard { node: *node, need: guard.need }.is_obvious(&system.graph) == Some(false)
                || guard.need == Need::NotZero && vanishes(system, *node)
        })
        .map(|(guard, _)| *guard)
    }

    /// The branch on which a symbol has a value.
    fn with(&self, system: &mut System, symbol: Symbol, value: NodeId) -> Partial {
        let mut next = self.clone();
        let single = Assignment::from([(symbol, value)]);
        for known in next.values.values_mut().chain(next.turns.iter_mut().map(|(_, value)| value)) {
            *known = system.graph.substitute(&[*known], &single)[0];
        }
        next.values.insert(symbol, value);
        next.codimension += 1;
        next.steps.push(format!("{} = {}", system.symbol_name(symbol), system.graph.text(value)));
        next
    }

    /// The branch on which an angle has a value, up to whole turns.
    fn with_turns(&self, system: &mut System, angle: Symbol, value: NodeId) -> Partial {
        let mut next = self.clone();
        // of an angle that is known up to whole turns another's whole turns are no news
        let single = Assignment::from([(angle, value)]);
        for (_, known) in &mut next.turns {
            *known = system.graph.substitute(&[*known], &single)[0];
        }
        next.turns.push((angle, value));
        next.codimension += 1;
        next.steps.push(format!("{} = {}", system.symbol_name(angle), system.graph.text(value)));
        next
    }
}

/// Meets one more condition.
fn step(system: &mut System, mut partial: Partial, count: usize) -> Step {
    if let Some(guard) = partial.fails(system, count) {
        return Step::Empty(guard.text(&system.graph));
    }
    let mut open = Vec::new();
    let mut guards: Vec<Guard> = partial.guards.iter().chain(&partial.kept).copied().collect();
    let nodes: Vec<NodeId> = guards.iter().map(|guard| guard.node).collect();
    for (guard, node) in guards.iter_mut().zip(partial.put_in(system, &nodes)) {
        guard.node = node;
    }
    for condition in std::mem::take(&mut partial.open) {
        let sides = partial.put_in(system, &[condition.left, condition.right]);
        let difference = system.graph.sub(sides[0], sides[1]);
        if vanish_where(system, &[difference], &guards) {
            continue; // it holds already
        }
        if sign(&system.graph, difference).is_some_and(|sign| sign.is_strict())
            || is_a_constant_but_zero(system, difference)
        {
            return Step::Empty(condition.text);
        }
        open.push(Condition { left: sides[0], right: sides[1], ..condition });
    }
    // short ones first: what is put into long ones may be anything
    let mut best: Option<((u8, usize, String), usize, Way)> = None;
    for (index, condition) in open.iter().enumerate() {
        if system.graph.symbols_of([condition.left, condition.right]).is_empty() {
            let why = Unsolved::NotKnown(condition.text.clone());
            return Step::Stuck(Partial { open, ..partial }, why);
        }
        // an angle that is known up to whole turns, and was not put in: the condition distinguishes these
        let mentioned = system.graph.symbols_of([condition.left, condition.right]);
        let way = match partial.turns.iter().any(|(angle, _)| mentioned.contains(angle)) {
            true => way_apart_from_turns(system, condition.left, condition.right, &guards),
            false => way(system, condition.left, condition.right, &guards),
        };
        let way = match way {
            Way::Unknown if is_nowhere_zero(system, condition.left, condition.right, &guards) => {
                return Step::Empty(condition.text.clone());
            }
            Way::Unknown if !condition.touches => touching(system, condition.left, condition.right),
            Way::Linear { slope, rest, .. }
                if partial.least > count && system.graph.reachable([slope, rest]).len() > LONGEST_OF_THIN =>
            {
                // too thin to be a part over the complex numbers: followed as long as that costs little
                match factors_of(system, condition.left, condition.right) {
                    Some(factors) => Way::Factors(factors),
                    None => Way::Unknown,
                }
            }
            way => way,
        };
        let length = system.graph.reachable([condition.left, condition.right]).len();
        let key = (way.rank(), length, quote(system, condition.left, condition.right));
        if best.as_ref().is_none_or(|(least, ..)| key < *least) {
            best = Some((key, index, way));
        }
    }
    let Some((_, index, way)) = best else { return Step::Done(partial) };
    let taken = open.remove(index);
    let text = taken.text.clone();
    let zero = system.graph.integer(0);
    let also = |left: NodeId| Condition { left, right: zero, text: text.clone(), touches: false };
    partial.open = open;
    match way {
        Way::Unknown => {
            partial.open.insert(0, taken);
            Step::Stuck(partial, Unsolved::NotLinear(text))
        }
        Way::All(terms) => {
            partial.open.splice(0..0, terms.into_iter().map(also));
            Step::Open(vec![partial])
        }
        Way::Touching(slopes) => {
            partial.open.splice(0..0, slopes.into_iter().map(also));
            partial.open.push(Condition { touches: true, ..taken });
            Step::Open(vec![partial])
        }
        Way::Factors(factors) if factors.is_empty() => Step::Empty(text),
        Way::Factors(factors) => {
            let several = factors.len() > 1 || partial.several;
            let next = factors.into_iter().map(|factor| {
                let mut next = Partial { several, ..partial.clone() };
                next.open.insert(0, also(factor));
                next
            });
            Step::Open(next.collect())
        }
        Way::Value(symbol, value) => Step::Open(vec![partial.with(system, symbol, value)]),
        Way::Turns(angle, values) => {
            Step::Open(values.iter().map(|value| partial.with_turns(system, angle, *value)).collect())
        }
        Way::Linear { symbol, value, slope, rest, apart } => {
            let mut main = partial.with(system, symbol, value);
            add_guard(&system.graph, &mut main.guards, Guard { node: slope, need: Need::NotZero });
            let mut other = partial;
            other.open.splice(0..0, [also(slope), also(rest)]);
            other.several |= apart != Apart::Coprime;
            other.least = other.least.max(other.codimension + apart.dimensions());
            Step::Open(vec![main, other])
        }
    }
}

impl Branch {
    /// The part of the branch on which some expressions vanish besides.
    ///
    /// # Errors
    /// As for `solve`.
    pub fn meeting(&self, system: &mut System, vanishing: &[NodeId]) -> Result<Solution, Unsolved> {
        let turns = self.up_to_turns.iter().map(|angle| (*angle, self.values[angle])).collect();
        let codimension = self.values.len();
        let zero = system.graph.integer(0);
        let mut start = Partial {
            values: self.before_turns.clone(),
            turns,
            guards: self.guards.clone(),
            assumed: self.assumed.clone(),
            steps: self.steps.clone(),
            open: Vec::new(),
            codimension,
            least: codimension,
            several: false,
            kept: Vec::new(),
        };
        for left in vanishing {
            let text = quote(system, *left, zero);
            start.open.push(Condition { left: *left, right: zero, text, touches: false });
        }
        follow(system, start, codimension + vanishing.len())
    }
}

/// The branch that is left when all conditions are met.
fn finish(system: &mut System, partial: Partial) -> Branch {
    let turns: Assignment = partial.turns.iter().copied().collect();
    let mut values = partial.values.clone();
    for value in values.values_mut() {
        *value = system.graph.substitute(&[*value], &turns)[0];
    }
    values.extend(&turns);
    Branch {
        up_to_turns: partial.turns.iter().map(|(angle, _)| *angle).collect(),
        values,
        before_turns: partial.values,
        guards: partial.guards,
        assumed: partial.assumed,
        steps: partial.steps,
        beside: Vec::new(),
    }
}
