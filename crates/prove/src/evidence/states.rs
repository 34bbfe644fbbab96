//! States of the engines as the checker reads them.

use palmistry_checker::{ExactCoordinate, ExactState, Ratio};
use palmistry_math::expression::Graph;
use palmistry_rank::observability::{Coordinate, State};

/// A coordinate for the checker.
pub fn exact_coordinate(value: &Coordinate) -> ExactCoordinate {
    match value {
        Coordinate::Number(value) => ExactCoordinate::Number(Ratio(value.clone())),
        Coordinate::Angle { sine, cosine } => {
            ExactCoordinate::Angle { sin: Ratio(sine.clone()), cos: Ratio(cosine.clone()) }
        }
    }
}

/// A state for the checker, by names.
pub fn exact_state(graph: &Graph, state: &State) -> ExactState {
    let named = state.values.iter().map(|(symbol, value)| {
        let name = graph.symbol_name(*symbol).to_owned();
        (name, exact_coordinate(value))
    });
    named.collect()
}
