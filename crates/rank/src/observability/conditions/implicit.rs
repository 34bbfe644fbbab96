//! Outputs that are zero, `0 = y(x, u)`: they tie known signals to states. Whether a state is observable is then decided by the rows of `y`, `y'`,
//! ... at points where all of these vanish.
//!
//! Each `y^(j) = 0` is solved for a coordinate in which it is linear. For `j > 0` it is so in the highest derivative of a
//! signal, with the slope that `y` itself has; where that slope does not vanish the derivatives of the signal are given by the rest, one after the
//! other. So many derivatives are taken as the rows mention of the signals.
//!
//! Where the slope and the equation both vanish, as those of `u x - y` at `x = y = 0`, the signal is free: if a motion stays there, that is a part of its own,
//! however thin it is among all states. Nothing is said of it, and [`Branch::beside`] names it, unless it is seen that no motion stays there: what
//! is left at once is the limit of states at which the slope does not vanish.
//!
//! The last of them has to be solved for the highest derivative of a signal that it mentions: then there are signals with these derivatives which
//! keep `y` zero for a while, by the theorem on implicit functions. Where its slope vanishes on all of the branch, as that of `u x - y` where `x = 0`,
//! the equation ties lower derivatives, the last ones look free and are not, and points with any value of them are none of the system.
//! There nothing is said.

use super::single::{also_met_otherwise, linear_solution};
use super::{Branch, Unsolved, is_a_constant_but_zero, quote, shortened, vanishes};
use palmistry_lang::{Assignment, System};
use palmistry_math::expression::{Guard, Need, NodeId, Symbol, add_guard, sign};

/// Equations of no more operations are differentiated beyond what the rows mention, and no oftener than this.
const SHORT: usize = 2000;
const MOST_MORE: usize = 8;
/// So many derivatives are asked to vanish where a slope does, as long as they have no more operations.
const MOST_DERIVATIVES_BESIDE: usize = 4;
const SHORT_BESIDE: usize = 100;

/// A derivative of an output that is zero, the last one so far.
struct Tied {
    node: NodeId,
    /// What it was solved for.
    solved: Option<Symbol>,
    /// So many are taken: the rows mention no derivatives of signals beyond those that it gives then.
    most: usize,
    /// Whether it is the last of them.
    is_last: bool,
}

impl Branch {
    /// The part of the branch on which the outputs that are zero vanish, with as many derivatives as give all those of signals that Lie derivatives mention.
    ///
    /// # Errors
    /// Where one of them vanishes nowhere, is linear in no coordinate, or vanishes in more than one way, and where the last derivatives of signals are not
    /// given by it.
    pub fn tied_by_outputs(mut self, system: &mut System) -> Result<Branch, Unsolved> {
        let outputs = system.zero_outputs();
        if outputs.is_empty() {
            return Ok(self);
        }
        let before = self.clone();
        let (mut equations, mut slopes): (Vec<NodeId>, Vec<(NodeId, Vec<NodeId>)>) = (Vec::new(), Vec::new());
        let mut gives_signals = false;
        for node in &outputs {
            let zero = system.graph.integer(0);
            self.steps.push(quote(system, zero, *node));
        }
        let drift = system.drift();
        let words = system.highest_lie_order().unwrap_or(0);
        let reach = highest_in_words(system);
        let tied = |node: &NodeId| {
            let own = highest_derivative(system, std::iter::once(*node));
            Tied { node: *node, solved: None, most: words + 1 + reach.saturating_sub(own), is_last: false }
        };
        let mut current: Vec<Tied> = outputs.iter().map(tied).collect();
        let mut order = 0;
        loop {
            for tied in current.iter_mut().filter(|tied| !tied.is_last) {
                let before_it = tied.solved;
                let here = system.graph.substitute(&[tied.node], &self.values)[0];
                tied.solved = self.meet(system, tied.node, order, before_it)?;
                // one that says nothing more here may cut another part, and would hide it
                equations.extend(tied.solved.map(|_| tied.node));
                // the next derivative of a signal has the slope of the one before
                let is_next = before_it.is_some_and(|signal| system.known.contains(&signal));
                if let Some(symbol) = tied.solved.filter(|_| !is_next) {
                    let is_signal = system.known.contains(&symbol);
                    // what was solved before does not mention a signal's highest derivative
                    let slope = system.partial(if is_signal { tied.node } else { here }, symbol);
                    slopes.push((slope, equations.clone()));
                    gives_signals |= is_signal;
                }
                let mentioned = system.graph.symbols_of([tied.node]);
                // symbols for more derivatives, for which there are no rows, are given too as long as that costs little: the set is then invariant
                let is_long = || system.graph.reachable([tied.node]).len() > SHORT;
                tied.is_last = mentioned.iter().any(|symbol| system.is_cut_off(*symbol))
                    || order >= tied.most && (order >= tied.most + MOST_MORE || is_long());
            }
            let Some(drift) = drift.filter(|_| current.iter().any(|tied| !tied.is_last)) else { break };
            for tied in current.iter_mut().filter(|tied| !tied.is_last) {
                tied.node = system.lie_derivative(drift, tied.node);
            }
            order += 1;
        }
        // derivatives of signals are given without end; without them a thinner part is the limit of others
        let thinner = if gives_signals { None } else { Some(self.values.len()) };
        let mut apart = before;
        for (slope, then) in slopes {
            let is_none = apart.leaves_none_beside(system, slope, &then)
                || thinner.is_some_and(|most| apart.is_thinner_beside(system, slope, &equations, most));
            if !is_none {
                self.beside.push(shortened(system.graph.text(slope)));
            }
            // where it vanishes the next one need not be looked at
            add_guard(&system.graph, &mut apart.guards, Guard { node: slope, need: Need::NotZero });
        }
        for (tied, output) in current.iter().zip(outputs) {
            if !self.gives_the_last(system, tied) {
                let zero = system.graph.integer(0);
                return Err(Unsolved::TiesOtherwise(quote(system, zero, output)));
            }
        }
        Ok(self)
    }

    /// Whether it is seen that no motion stays where the slope of a signal vanishes beside the equations that were met so far: all their derivatives
    /// would vanish too.
    fn leaves_none_beside(&self, system: &mut System, slope: NodeId, equations: &[NodeId]) -> bool {
        let there = system.graph.substitute(&[slope], &self.values)[0];
        let needs = |guard: &Guard| guard.node == there && guard.need != Need::NotNegative;
        if sign(&system.graph, there).is_some_and(|sign| sign.is_strict()) || self.guards.iter().any(needs) {
            return true;
        }
        let mut last: Vec<NodeId> = std::iter::once(slope).chain(equations.last().copied()).collect();
        let mut all: Vec<NodeId> = std::iter::once(slope).chain(equations.iter().copied()).collect();
        for _ in 0..=MOST_DERIVATIVES_BESIDE {
            if system.graph.reachable(last.clone()).len() > SHORT_BESIDE {
                return false;
            }
            if self.meeting(system, &all).is_err_and(|why| !why.may_be_met()) {
                return true;
            }
            let Some(drift) = system.drift() else { return false };
            last = last.into_iter().map(|node| system.lie_derivative(drift, node)).collect();
            all.extend(&last);
        }
        false
    }

    /// Whether the part on which a slope vanishes beside all equations has more coordinates solved for than so many: each part of its own that
    /// equations have is at least as large as their number says.
    fn is_thinner_beside(
        &self,
        system: &mut System,
        slope: NodeId,
        equations: &[NodeId],
        most: usize,
    ) -> bool {
        let all: Vec<NodeId> = std::iter::once(slope).chain(equations.iter().copied()).collect();
        if system.graph.reachable(all.clone()).len() > SHORT_BESIDE {
            return false;
        }
        match self.meeting(system, &all) {
            Err(why) => !why.may_be_met(),
            Ok(solution) => {
                let mut solved = solution.parts.iter().chain(&solution.smaller).chain(&solution.thinner);
                solution.unsolved.is_empty() && solved.all(|branch| branch.values.len() > most)
            }
        }
    }

    /// Whether the last derivative of an output gives the highest derivative of a signal that it mentions, so that there are signals for any values of the others;
    /// or mentions none that is not given already.
    fn gives_the_last(&self, system: &System, tied: &Tied) -> bool {
        let mentioned = system.graph.symbols_of([tied.node]);
        let is_highest = |symbol: &&Symbol| {
            let next = system.next_derivative_of_signal(**symbol);
            system.known.contains(symbol)
                && system.derivative_of_signal(**symbol).is_some()
                && next.is_none_or(|next| !mentioned.contains(&next))
        };
        let mut highest = mentioned.iter().filter(is_highest);
        tied.solved.is_some_and(|solved| highest.clone().any(|symbol| *symbol == solved))
            || highest.all(|symbol| self.values.contains_key(symbol))
    }

    /// Meets one more equation, a derivative of an output, and returns what it was solved for. `before` is what the derivative before
    /// it was.
    fn meet(
        &mut self,
        system: &mut System,
        output: NodeId,
        order: usize,
        before: Option<Symbol>,
    ) -> Result<Option<Symbol>, Unsolved> {
        let here = system.graph.substitute(&[output], &self.values)[0];
        if let Some((symbol, slope)) = before.and_then(|before| next_in_line(system, here, before)) {
            let zero = system.graph.integer(0);
            let rest = system.graph.substitute(&[here], &Assignment::from([(symbol, zero)]))[0];
            let quotient = system.graph.div(rest, slope);
            let value = system.graph.neg(quotient);
            self.put(system, symbol, value, slope);
            return Ok(Some(symbol));
        }
        if vanishes(system, here) {
            return Ok(None);
        }
        let zero = system.graph.integer(0);
        let text = quote(system, zero, here);
        if is_a_constant_but_zero(system, here) {
            return Err(Unsolved::Never(text));
        }
        for symbol in candidates(system, here) {
            let Some(value) = linear_solution(system, here, symbol) else { continue };
            // derivatives of a signal follow from what was found to be one part
            let follows = order > 0 && system.known.contains(&symbol);
            if !follows && also_met_otherwise(system, here, symbol) {
                return Err(Unsolved::Several(text));
            }
            let slope = system.partial(here, symbol);
            self.put(system, symbol, value, slope);
            return Ok(Some(symbol));
        }
        Err(Unsolved::NotLinear(text))
    }

    /// Puts the value of a symbol into all that is known, where the slope that it was divided by does not vanish.
    fn put(&mut self, system: &mut System, symbol: Symbol, value: NodeId, slope: NodeId) {
        add_guard(&system.graph, &mut self.guards, Guard { node: slope, need: Need::NotZero });
        let single = Assignment::from([(symbol, value)]);
        for values in [&mut self.values, &mut self.before_turns] {
            let (symbols, nodes): (Vec<Symbol>, Vec<NodeId>) =
                values.iter().map(|(symbol, node)| (*symbol, *node)).unzip();
            let images = system.graph.substitute(&nodes, &single);
            values.extend(symbols.into_iter().zip(images));
            values.insert(symbol, value);
        }
    }
}

/// The highest derivative of a signal that expressions mention.
fn highest_derivative(system: &System, nodes: impl Iterator<Item = NodeId>) -> usize {
    let mentioned = system.graph.symbols_of(nodes);
    mentioned.into_iter().filter_map(|symbol| system.derivative_of_signal(symbol)).max().unwrap_or(0)
}

/// The highest derivative of a signal in a Lie derivative of an output is this one's, and one more for each field: that of the outputs, or one less than that of the
/// rates of states, which come in with the first field.
fn highest_in_words(system: &System) -> usize {
    let rates = system.moving_fields().into_iter().flat_map(|field| &system.fields[field].components);
    // what moves a signal is its next derivative, and no rate of a state
    let of_states = rates.filter(|(symbol, _)| system.derivative_of_signal(*symbol).is_none());
    let in_rates = highest_derivative(system, of_states.map(|(_, rate)| *rate));
    highest_derivative(system, system.outputs.iter().map(|(_, node)| *node)).max(in_rates.saturating_sub(1))
}

/// The next derivative of a signal that the derivative before was solved for, and its slope, where an equation is visibly linear
/// in it: the slope does not mention it. The slope is that of the derivative before (Faa di Bruno), which was tested for zero, so that
/// none of the tests is made again on expressions that grow with each order.
fn next_in_line(system: &mut System, equation: NodeId, before: Symbol) -> Option<(Symbol, NodeId)> {
    if !system.known.contains(&before) {
        return None;
    }
    let next = system.next_derivative_of_signal(before)?;
    if !system.graph.symbols_of([equation]).contains(&next) {
        return None;
    }
    let slope = system.partial(equation, next);
    (!system.graph.symbols_of([slope]).contains(&next)).then_some((next, slope))
}

/// The coordinates that an equation may be solved for: known signals, their highest derivatives first, then all others.
fn candidates(system: &System, equation: NodeId) -> Vec<Symbol> {
    let mentioned = system.graph.symbols_of([equation]);
    let may_be = |symbol: &Symbol| mentioned.contains(symbol) && !system.is_angle(*symbol);
    let mut found: Vec<Symbol> = system.states.iter().copied().filter(may_be).collect();
    found.sort_by_key(|symbol| match system.known.contains(symbol) {
        true => (0, std::cmp::Reverse(system.derivative_of_signal(*symbol).unwrap_or(0))),
        false => (1, std::cmp::Reverse(0)),
    });
    found
}
