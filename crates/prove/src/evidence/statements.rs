//! A refuted or proved equation, with the state at which it is evaluated.

use super::states::exact_coordinate;
use palmistry_checker::Lowering;
use palmistry_checker::{
    ExactCoordinate, ExactState, Listing, Missing, PrintedSides, Refutation, Requirement, Sides,
    StatedIdentity,
};
use palmistry_math::expression::syntax::Relation;
use palmistry_math::expression::{Graph, Guard, NodeId, Symbol};
use palmistry_rank::observability::State;

/// An equation as it was read, and a state that meets its conditions.
#[derive(Clone, Debug)]
pub struct StatementAt<'g> {
    pub graph: &'g Graph,
    /// The entries of the left side, then those of the right.
    pub sides: &'g [NodeId],
    /// The relation claimed between each entry of the left and that of the right; empty where all are equations.
    pub relations: &'g [Relation],
    /// Where sides are claimed to be near each other: the tolerance.
    pub within: Option<NodeId>,
    /// Left sides less right sides of the conditions.
    pub conditions: &'g [NodeId],
    /// Where sides and conditions exist.
    pub guards: &'g [Guard],
    /// Values in numbers.
    pub state: &'g State,
    /// Values by expressions of the others.
    pub terms: &'g [(Symbol, NodeId)],
}

/// What refuted and proved equations share.
struct Listed {
    listing: Listing,
    state: ExactState,
    sides: Vec<Sides>,
    within: Option<usize>,
    conditions: Vec<Sides>,
    requirements: Vec<Requirement>,
}

impl StatementAt<'_> {
    /// The refutation by one entry, counted from zero, with its two sides as they are printed.
    ///
    /// # Errors
    /// Where there is no such entry, or a listing becomes too long.
    pub fn refutation(&self, entry: usize, printed: PrintedSides) -> Result<Refutation, Missing> {
        let Listed { listing, state, mut sides, within, conditions, requirements } =
            self.listed(Some(entry))?;
        let sides = sides.pop().ok_or(Missing::Place { place: entry })?;
        Ok(Refutation { listing, state, sides, within, conditions, requirements, printed })
    }

    /// The proof, by an engine.
    ///
    /// # Errors
    /// Where a listing becomes too long.
    pub fn identity(
        &self,
        engine: &str,
        log2_error: f64,
        degree: Option<f64>,
    ) -> Result<StatedIdentity, Missing> {
        let Listed { listing, state, sides, within, conditions, requirements } = self.listed(None)?;
        Ok(StatedIdentity {
            listing,
            state,
            sides,
            within,
            conditions,
            requirements,
            engine: engine.to_owned(),
            // minus infinity, of an argument that cannot err, has no JSON
            log2_error: log2_error.is_finite().then_some(log2_error),
            degree,
        })
    }

    fn listed(&self, entry: Option<usize>) -> Result<Listed, Missing> {
        let mut lowering = Lowering::new(self.graph);
        let name = |symbol: &Symbol| self.graph.symbol_name(*symbol).to_owned();
        let mut state: ExactState =
            self.state.values.iter().map(|(symbol, value)| (name(symbol), exact_coordinate(value))).collect();
        // what gives a symbol its value has to come before whatever mentions the symbol
        for (symbol, term) in self.terms {
            state.insert(name(symbol), ExactCoordinate::Step(lowering.place(*term)?));
        }
        let (left, right) = self.sides.split_at(self.sides.len() / 2);
        let mut sides = Vec::new();
        for (index, (l, r)) in left.iter().zip(right).enumerate() {
            if entry.is_none_or(|entry| entry == index) {
                let relation = self.relations.get(index).copied().unwrap_or(Relation::Equal);
                sides.push(lowering.sides(*l, relation, *r)?);
            }
        }
        let within = self.within.map(|node| lowering.place(node)).transpose()?;
        let mut conditions = Vec::new();
        for condition in self.conditions {
            conditions.push(lowering.vanishing(*condition)?);
        }
        let requirements = self.guards.iter().map(|guard| lowering.requirement(*guard));
        let requirements = requirements.collect::<Result<_, _>>()?;
        Ok(Listed { listing: lowering.finish(), state, sides, within, conditions, requirements })
    }
}
