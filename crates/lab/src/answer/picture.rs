//! How well the unknowns are observable: over two coordinates, along a line, at one state.

use super::place::Place;
use super::{Refused, Tell};
use dashu::rational::RBig;
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{CoordinateRange, LineEnd, Point, System};
use palmistry_math::number::rational_from_f64;
use palmistry_rank::sweep::{RankPreparation, RankQuestion};
use palmistry_workbench::tradeoff::{Landscape, PictureRows};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The seed of the states that scale a picture, that of all commands.
const SEED: u64 = 1;
/// More cells in a row are refused.
const MOST_CELLS: usize = 400;
/// The first picture of a map has so many cells in a row; each further one has twice as many.
const COARSE: usize = 12;

/// The values of what does not move.
type Values = BTreeMap<String, f64>;

#[derive(Deserialize)]
pub(super) struct MapAsked {
    /// Name, least and greatest value.
    x: (String, f64, f64),
    y: (String, f64, f64),
    #[serde(default)]
    at: Values,
    /// One unknown; the worst at each point where none is named.
    of: Option<String>,
    order: Option<usize>,
    cells: usize,
}

#[derive(Deserialize)]
pub(super) struct StateAsked {
    at: Values,
}

#[derive(Deserialize)]
pub(super) struct LineAsked {
    moving: String,
    /// An expression that is zero at the end of the line; infinity where there is none.
    zero: Option<String>,
    #[serde(default)]
    at: Values,
}

fn point(values: &Values) -> Result<Point, Refused> {
    let exact = |(name, value): (&String, &f64)| {
        let exact = rational_from_f64(*value).ok_or_else(|| Refused::new(format!("{name} is not finite")))?;
        Ok((name.clone(), exact))
    };
    values.iter().map(exact).collect()
}

fn axis((name, low, high): &(String, f64, f64)) -> Result<CoordinateRange<f64>, Refused> {
    if !(low.is_finite() && high.is_finite() && low < high) {
        return Err(Refused::new(format!("the range of {name} has no width")));
    }
    Ok(CoordinateRange { name: name.clone(), low: *low, high: *high })
}

/// A standard deviation over the prior one: `-1` where it is infinite, nothing at a pole.
fn told(deviation: Option<f64>) -> Value {
    match deviation {
        None => Value::Null,
        Some(value) if value.is_finite() => json!(value),
        Some(_) => json!(-1.0),
    }
}

pub(super) fn map(place: &Place<'_>, asked: &MapAsked, tell: Tell<'_>) -> Result<Value, Refused> {
    let mut system = place.system()?;
    let axes = [axis(&asked.x)?, axis(&asked.y)?];
    let cells = asked.cells.clamp(1, MOST_CELLS);
    let rows = PictureRows::full(&mut system, asked.order)?;
    let landscape = Landscape::new(&mut system, rows, &point(&asked.at)?, SEED)?;
    let mut width = COARSE.min(cells);
    loop {
        let map = landscape.map(axes.clone(), (width, width), asked.of.as_deref())?;
        let values: Vec<Value> = map.deviations.iter().map(|value| told(*value)).collect();
        tell(json!({ "kind": "map", "width": width, "values": values, "worst": map.worst }));
        if width == cells {
            break;
        }
        width = (2 * width).min(cells);
    }
    Ok(json!({ "names": landscape.names() }))
}

/// The rank at one state, proved where it can be.
pub(super) fn state(place: &Place<'_>, asked: &StateAsked) -> Result<Value, Refused> {
    let mut system = place.system()?;
    let exact: BTreeMap<String, RBig> = point(&asked.at)?.into_iter().collect();
    let is_held = |system: &System, name: &str| {
        let symbol = system.find_symbol(name);
        symbol.filter(|symbol| !system.unknowns().contains(symbol))
    };
    // what is known is put in, and everything else is a coordinate
    let fixed = exact.iter().filter_map(|(name, value)| Some((is_held(&system, name)?, value.clone())));
    let question = RankQuestion { samples: 1, fixed: fixed.collect(), ..RankQuestion::default() };
    let refused = |why: palmistry_rank::sweep::RankError| Refused::new(why.to_string());
    let given = RankPreparation::new(&mut system, &question).map_err(refused)?;
    let given = given.at_given_states(&mut system).map_err(refused)?;
    let value = |symbol: &palmistry_math::expression::Symbol| {
        let name = system.symbol_name(*symbol);
        asked
            .at
            .get(name)
            .copied()
            .map(|value| vec![value])
            .ok_or_else(|| Refused::new(format!("nothing gives the value of {name}")))
    };
    let values: Vec<Vec<f64>> = given.coordinates().iter().map(value).collect::<Result<_, _>>()?;
    let slices: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
    let rows = given.decide(&slices, &UNINTERRUPTED).map_err(|why| Refused::new(why.to_string()))?;
    let row = rows.and_then(|rows| rows.into_iter().next());
    let row = row.ok_or_else(|| Refused::new("the state was not looked at"))?;
    Ok(json!({
        "rank": row.rank,
        "certified": row.certified,
        "dimension": system.unknown_count(),
        "smallest_singular_value": row.smallest_singular_value,
    }))
}

pub(super) fn line(place: &Place<'_>, asked: &LineAsked) -> Result<Value, Refused> {
    /// Lines end so far from where they go.
    const LEAST_DISTANCE: f64 = 1e-12;
    const POINTS: usize = 49;
    let mut system = place.system()?;
    let target = match &asked.zero {
        None => LineEnd::Infinity,
        Some(text) => {
            let value = system.evaluate_text(text)?;
            let node = value
                .as_number()
                .ok_or_else(|| Refused::new("the end of a line is where a number is zero"))?;
            LineEnd::Zero(node)
        }
    };
    let rows = PictureRows::full(&mut system, None)?;
    let mut landscape = Landscape::new(&mut system, rows, &point(&asked.at)?, SEED)?;
    let slope = landscape.line(&asked.moving, target, (LEAST_DISTANCE, POINTS), None)?;
    let values: Vec<Value> = slope
        .values
        .iter()
        .map(|all| {
            all.as_ref().map_or(Value::Null, |all| all.iter().map(|value| told(Some(*value))).collect())
        })
        .collect();
    Ok(json!({ "distance": slope.distance, "names": slope.names, "values": values }))
}
