//! Where a symbol is drawn from when the file does not say. What was taken so is told with every answer that rests on it.

use super::model::{Range, System};
use dashu::rational::RBig;
use palmistry_math::expression::Symbol;
use std::collections::BTreeSet;

impl System {
    /// The range that is taken for a symbol of which the file says neither a range nor a value: a half of a value that was
    /// given as a hint to both sides of it, almost a whole turn for an angle, from one half to two for what something is
    /// divided by, or has a root or a logarithm taken of, in the outputs and in the fields that move; else from -1 to 1.
    /// Nothing where the file says one.
    pub fn default_range(&self, symbol: Symbol) -> Option<Range> {
        // a known signal is the same kind of thing at every step
        let symbol = self.now(symbol);
        let info = self.symbol_info(symbol)?;
        if info.range.is_some() || info.default.is_some() {
            return None;
        }
        let between = |low: RBig, high: RBig| Some(Range { low, high });
        let half = RBig::ONE / RBig::from(2);
        match self.coordinates.hints.get(&symbol) {
            Some(hint) if *hint > RBig::ZERO => return between(hint * &half, hint * (RBig::ONE + half)),
            Some(hint) if *hint < RBig::ZERO => return between(hint * (RBig::ONE + &half), hint * half),
            _ => {}
        }
        if info.is_angle {
            return between(RBig::from(-3), RBig::from(3));
        }
        match self.is_guarded(symbol) {
            true => between(half, RBig::from(2)),
            false => between(RBig::from(-1), RBig::ONE),
        }
    }

    /// The ranges that are taken for these, by name.
    pub fn ranges_by_default(&self) -> Vec<(String, Range)> {
        let range = |symbol: Symbol| Some((self.symbol_name(symbol).to_owned(), self.default_range(symbol)?));
        self.without_range().into_iter().filter_map(range).collect()
    }

    /// Whether a symbol is met in what outputs and fields need to exist.
    fn is_guarded(&self, symbol: Symbol) -> bool {
        let guards = self.smooth_guards(&self.moving_fields());
        let open = guards.iter().filter(|guard| guard.is_obvious(&self.graph) != Some(true));
        self.graph.symbols_of(open.map(|guard| guard.node)).contains(&symbol)
    }

    /// The symbols that something is asked of and the file does not say where they are: the states, and what outputs and
    /// fields mention.
    pub fn without_range(&self) -> BTreeSet<Symbol> {
        let outputs = self.outputs.iter().map(|(_, node)| *node);
        let rates = self.moving_fields().into_iter().flat_map(|field| &self.fields[field].components);
        let mentioned = self.graph.symbols_of(outputs.chain(rates.map(|(_, node)| *node)));
        let asked = mentioned.into_iter().chain(self.states.iter().copied());
        asked.filter(|symbol| self.default_range(*symbol).is_some()).collect()
    }
}
