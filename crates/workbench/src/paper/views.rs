//! The sets, maps and lines of one system: ranks decided, and how well states are observable drawn.

use super::bounds::samples;
use super::left_out::LeftOut;
use crate::tradeoff::{Landscape, LandscapeRows, Map, PictureRows, Slope};
use dashu::rational::RBig;
use palmistry_lang::{
    CoordinateRange, LineEnd, LineView, MapView, NamedSet, Point, Range, System, UnknownKind, Value,
};
use palmistry_math::expression::{NodeId, Symbol};
use palmistry_math::number::parse_decimal;
use palmistry_rank::observability::{CodistributionError, OWN_ROWS};
use palmistry_rank::sweep::{BranchAnswer, RankAnswer, RankError, RankQuestion, SweepReport, answer_rank};
use std::sync::atomic::AtomicBool;

/// Cells of a map.
const MAP: (usize, usize) = (120, 80);
const POINTS_ON_A_LINE: usize = 65;
/// Lines end this far from where they go.
const LEAST_DISTANCE: f64 = 1e-14;

/// The rank on a set of states.
pub struct SetRank {
    /// The set; nothing for the whole sample box.
    pub set: Option<NamedSet>,
    /// The rank there, or why there is none: a divisor that is zero at all its states.
    pub found: Result<RankAnswer, RankError>,
}

impl SetRank {
    /// Its name in reports.
    pub fn name(&self) -> &str {
        self.set.as_ref().map_or("the whole sample box", |set| &set.name)
    }

    /// Whether every state is a pole.
    pub fn is_pole(&self) -> bool {
        match &self.found {
            Err(why) => matches!(why, RankError::Codistribution(CodistributionError::Pole { .. })),
            // the Lie derivatives that were taken exist, and the fields do not
            Ok(answer) => {
                let left_out = |branch: &BranchAnswer| {
                    let SweepReport { samples, poles, interrupted, .. } = &branch.full;
                    *samples == 0 && !poles.is_empty() && !interrupted
                };
                !answer.branches.is_empty() && answer.branches.iter().all(left_out)
            }
        }
    }

    /// Whether no state was found there that has a rank, and none that is a pole either.
    pub fn is_undecided(&self) -> bool {
        let without_states = |branch: &BranchAnswer| branch.full.samples == 0 && !branch.full.interrupted;
        !self.is_pole() && self.found.as_ref().is_ok_and(|answer| answer.branches.iter().all(without_states))
    }

    /// The rank, or as text why there is none.
    pub fn answer(&self) -> Result<&RankAnswer, String> {
        match &self.found {
            Err(why) => Err(why.to_string()),
            Ok(answer) if self.is_pole() => {
                // not all of them are divisors, and the states are those that were drawn
                let reasons = answer.branches.iter().flat_map(|branch| branch.full.poles.keys());
                let reasons: std::collections::BTreeSet<&str> = reasons.map(String::as_str).collect();
                let reasons: Vec<&str> = reasons.into_iter().collect();
                Err(format!("no state that was drawn there has a rank: {}", reasons.join(", ")))
            }
            Ok(answer) if self.is_undecided() => Err(match &answer.left_out[..] {
                [] if answer.branches.is_empty() => {
                    "a rank is that of states at which what stands in abs, sign, min, max and roots has a \
                     sign; none was found there, and at its zero such a function need not have a derivative"
                        .to_owned()
                }
                [] => "no state was found there that has a rank".to_owned(),
                parts => {
                    let parts = parts.join(", or where ");
                    format!("the rank is that of parts of the states, and none was found there where {parts}")
                }
            }),
            Ok(answer) => Ok(answer),
        }
    }

    /// A pole where the file says so, and elsewhere a rank.
    pub fn as_expected(&self) -> bool {
        match &self.set {
            Some(set) if set.is_pole => self.is_pole(),
            _ => self.found.is_ok() && !self.is_pole() && !self.is_undecided(),
        }
    }
}

/// How well a state is observable over a plane: by the file's own rows where it has some, and by the full codistribution.
pub struct MapFound {
    /// What the file asks for.
    pub view: MapView,
    /// A map for each choice of rows.
    pub maps: Vec<(LandscapeRows, Map)>,
}

/// How well states are observable along a line, by the file's own rows where it has some.
pub struct LineFound {
    /// What the file asks for.
    pub view: LineView,
    /// Which rows.
    pub rows: LandscapeRows,
    /// The standard deviations along it.
    pub slope: Slope,
}

/// Whether there is a rank to ask for.
pub(super) fn has_a_rank(system: &System) -> bool {
    system.unknown_count() > 0 && !system.outputs.is_empty() && system.require_motion().is_ok()
}

/// The rank on the sample box, or on one set.
pub(super) fn rank_on(system: &System, set: Option<&NamedSet>, seed: u64, interrupt: &AtomicBool) -> SetRank {
    let question = RankQuestion {
        samples: samples(system, set.is_some()),
        seed,
        conditions: set.map(|set| set.written.clone()).unwrap_or_default(),
        interrupt,
        ..RankQuestion::default()
    };
    SetRank { set: set.cloned(), found: answer_rank(&mut system.clone(), &question) }
}

/// The maps and lines of a file, and what of them cannot be drawn.
pub(super) fn draw(
    system: &System,
    observable: &[String],
    seed: u64,
    left_out: &mut Vec<LeftOut>,
) -> (Vec<MapFound>, Vec<LineFound>) {
    let own = own_rows(system);
    let mut maps = Vec::new();
    if system.maps.is_empty()
        && let Some(view) = map_by_default(system, observable)
        && let Ok(found) = map(system, own.as_deref(), &view, seed)
    {
        // nobody has asked for it: what cannot be drawn is not missed, nor is a map without any finite number, as where values that are
        // taken by default are special ones
        let tells =
            |(_, map): &(LandscapeRows, Map)| map.deviations.iter().flatten().any(|value| value.is_finite());
        if found.iter().any(tells) {
            maps.push(MapFound { view, maps: found });
        }
    }
    for view in &system.maps {
        match map(system, own.as_deref(), view, seed) {
            Ok(found) => maps.push(MapFound { view: view.clone(), maps: found }),
            Err(why) => left_out.push(LeftOut { what: format!("the map \"{}\"", view.title), why }),
        }
    }
    let mut lines = Vec::new();
    for view in &system.lines {
        match line(system, own.as_deref(), view, seed) {
            Ok((rows, slope)) => lines.push(LineFound { view: view.clone(), rows, slope }),
            Err(why) => left_out.push(LeftOut { what: format!("the line \"{}\"", view.title), why }),
        }
    }
    if system.lines.is_empty() && !observable.is_empty() {
        // where a line ends is an expression of the system in which it is drawn
        let mut copy = system.clone();
        for view in lines_by_default(&mut copy) {
            if let Ok((rows, slope)) = line(&copy, own.as_deref(), &view, seed) {
                lines.push(LineFound { view, rows, slope });
            }
        }
    }
    (maps, lines)
}

/// Of larger systems nothing is drawn that nobody has asked for.
const MOST_UNKNOWNS: usize = 12;
/// So many lines are drawn by default.
const MOST_LINES: usize = 3;

/// The states over which something is drawn where the file does not say it: those that move and have a name of their own.
fn moving_unknowns(system: &System) -> Vec<Symbol> {
    let is_one = |symbol: &Symbol| {
        system.unknown_kind(*symbol) == Some(UnknownKind::State)
            && !system.symbol_name(*symbol).contains(['@', '\''])
    };
    system.states.iter().copied().filter(is_one).collect()
}

/// A map over the first two states: of the worst unknown where all are observable, else of the first that is observable.
fn map_by_default(system: &System, observable: &[String]) -> Option<MapView> {
    if system.unknown_count() > MOST_UNKNOWNS || observable.is_empty() {
        return None;
    }
    let [x, y] = moving_unknowns(system).into_iter().take(2).collect::<Vec<_>>().try_into().ok()?;
    let axis = |symbol: Symbol| {
        let given = system
            .symbol_info(symbol)
            .and_then(|info| info.range.clone())
            .filter(|range| range.low < range.high);
        let wide = if system.is_angle(symbol) { 3 } else { 1 };
        let range = given.unwrap_or(Range { low: RBig::from(-wide), high: RBig::from(wide) });
        CoordinateRange { name: system.symbol_name(symbol).to_owned(), low: range.low, high: range.high }
    };
    let of = (observable.len() < system.unknown_count()).then(|| observable[0].clone());
    let title = match &of {
        None => "how well the worst state is observable".to_owned(),
        Some(name) => format!("how well {name} is observable"),
    };
    Some(MapView {
        title,
        axes: [axis(x), axis(y)],
        at: Point::default(),
        order: None,
        of,
        caption: None,
        span: 0..0,
    })
}

/// Lines into the sets that the file names, of those whose first equation gives a state its value.
fn lines_by_default(system: &mut System) -> Vec<LineView> {
    if system.unknown_count() > MOST_UNKNOWNS {
        return Vec::new();
    }
    let states = moving_unknowns(system);
    let mut found: Vec<LineView> = Vec::new();
    for set in system.sets.clone().into_iter().filter(|set| !set.is_pole && set.written.len() == 1) {
        let Some((name, value)) = set.written[0].split_once('=') else { continue };
        let state = states.iter().find(|state| system.symbol_name(**state) == name.trim());
        let (Some(state), Some(value)) = (state, parse_decimal(value.trim())) else { continue };
        let (node, value) = (system.graph.symbol(*state), system.graph.rational(value));
        let end = LineEnd::Zero(system.graph.sub(node, value));
        let moving = name.trim().to_owned();
        found.push(LineView { title: set.name, moving, end, from: Point::default(), of: None, span: 0..0 });
        if found.len() == MOST_LINES {
            break;
        }
    }
    found
}

fn map(
    system: &System,
    own: Option<&[NodeId]>,
    view: &MapView,
    seed: u64,
) -> Result<Vec<(LandscapeRows, Map)>, String> {
    let mut system = system.clone();
    let full = PictureRows::full(&mut system, view.order)?;
    let axis = |axis: &CoordinateRange<RBig>| CoordinateRange {
        name: axis.name.clone(),
        low: axis.low.to_f64().value(),
        high: axis.high.to_f64().value(),
    };
    let own = own.map(|rows| (LandscapeRows::Own, PictureRows::own(rows, system.unknown_count())));
    let mut maps = Vec::new();
    for (kind, rows) in own.into_iter().chain([(LandscapeRows::Full, full)]) {
        let mut copy = system.clone();
        let landscape = Landscape::new(&mut copy, rows, &view.at, seed)?;
        let axes = [axis(&view.axes[0]), axis(&view.axes[1])];
        maps.push((kind, landscape.map(axes, MAP, view.of.as_deref())?));
    }
    Ok(maps)
}

fn line(
    system: &System,
    own: Option<&[NodeId]>,
    view: &LineView,
    seed: u64,
) -> Result<(LandscapeRows, Slope), String> {
    let mut system = system.clone();
    let (kind, rows) = match own {
        Some(rows) => (LandscapeRows::Own, PictureRows::own(rows, system.unknown_count())),
        None => (LandscapeRows::Full, PictureRows::full(&mut system, None)?),
    };
    let mut landscape = Landscape::new(&mut system, rows, &view.from, seed)?;
    let slope =
        landscape.line(&view.moving, view.end, (LEAST_DISTANCE, POINTS_ON_A_LINE), view.of.as_deref())?;
    Ok((kind, slope))
}

/// The file's own choice of rows.
pub(super) fn own_rows(system: &System) -> Option<Vec<NodeId>> {
    match system.definition(OWN_ROWS) {
        Some(Value::Matrix(matrix)) if matrix.columns == system.unknown_count() => {
            Some(matrix.entries.clone())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing is divided by; and a sweep that was stopped says nothing of the states that it did not come to.
    #[test]
    fn states_without_a_rank_are_told_by_what_is_missing() {
        let text = "system \"s\" state x, v drift f x' = v v' = sqrt(-5 - x) output x \
                    sample x in [-1, 1] v in [-1, 1]";
        let mut found = rank_on(&text.parse().unwrap(), None, 1, &false.into());
        assert!(found.is_pole());
        assert_eq!(
            found.answer().map(|answer| answer.branches.len()),
            Err("no state that was drawn there has a rank: outside of -5 - x > 0".to_owned())
        );
        if let Ok(answer) = &mut found.found {
            answer.branches[0].full.interrupted = true;
        }
        assert!(!found.is_pole());
    }
}
