//! Stable poses proved: interval arithmetic on squares of palm angles.
//!
//! The triangle of palm angles at a margin is cut into squares. Over each the turn of `phi0` is cut into cells, on which `U'` has one sign, or `U''` has, or neither is
//! known. A run of cells with `U'' > 0` between cells with `U' < 0` and `U' > 0` holds *exactly one stable pose for each pair of palm angles in the
//! square*, which moves continuously with them: a certified sheet. Two sheets over squares with a common edge whose cells
//! overlap are one: on the edge `U''` is positive over both, so `U'` vanishes once. What is connected so is connected for certain, and certain is what a cycle
//! adds up to. What is neither a sheet nor free of stable poses stays open; sheets that not even open cells join are separate for certain.

use super::body::PoseBody;
use super::enclosed::EnclosedTable;
use super::turns::TurnSets;
use palmistry_math::number::Interval;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};
use std::sync::atomic::{AtomicBool, Ordering};

/// Squares along a side of the triangle to begin with.
const BEGIN: u32 = 8;

/// Cells of a turn to begin with, and how often one is halved.
const CELLS: u32 = 64;
const HALVINGS: u32 = 5;

/// Cells that overlap by less are not taken to overlap, rad: far more than all roundings of angles.
const OVERLAP: f64 = 1e-9;

/// A certified component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertifiedComponent {
    /// Its area in triangles.
    pub sheets: f64,
    /// By how many turns the body is turned along a cycle, zero where none was found.
    pub holonomy: u32,
}

/// What is certain of the surface of stable poses.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceCertificate {
    /// The margin from parallel palms, rad: all squares keep it.
    pub margin: f64,
    /// How many squares there are, of all sizes.
    pub squares: usize,
    /// The part of the triangle that they make up.
    pub region: f64,
    /// The part of the triangle over which the number of stable poses is certain, by that number.
    pub counted: BTreeMap<usize, f64>,
    /// Certified components, the greatest first.
    pub components: Vec<CertifiedComponent>,
    /// No fewer components than this have a certified sheet: no open cells join them.
    pub at_least: usize,
    /// Whether it is certain that no component leads to all orientations: neither sheets nor open cells come round, nor reach a turn. It holds for
    /// palms that keep a margin that is greater by a part of `1e-8`.
    pub is_confined: bool,
    /// Whether it was cut off: then nothing is certain.
    pub interrupted: bool,
}

impl SurfaceCertificate {
    /// Whether it is proved that the body can be brought from each orientation to each other one, by slow palms that keep the margin, from
    /// stable pose to stable pose without a jump.
    pub fn reaches_all(&self) -> bool {
        self.components.iter().any(|one| one.holonomy > 0)
    }
}

/// A square in units of the finest one.
#[derive(Clone, Copy)]
struct Square {
    x: u32,
    y: u32,
    size: u32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Cell {
    Falls,
    Rises,
    Convex,
    Concave,
    Open,
}

/// A run of cells in which stable poses may be: its ends in rad, and whether there is exactly one.
#[derive(Clone, Copy)]
struct Run {
    ends: [f64; 2],
    is_sheet: bool,
}

/// What is known over a square.
struct Known {
    square: Square,
    runs: Vec<Run>,
    /// Whether all of it keeps the margin; the others only serve to exclude.
    is_inside: bool,
}

struct Grid {
    margin: f64,
    side: f64,
    units: u32,
}

impl Grid {
    fn palm(&self, from: u32, size: u32) -> Interval {
        // one formula for an edge from either side, so that it is the same number
        let at = |unit: u32| self.margin + self.side * (f64::from(unit) / f64::from(self.units));
        Interval::new(at(from), at(from + size))
    }
}

/// `U'` and `U''`, up to the positive factor `sin phi2`.
fn slopes(body: &EnclosedTable, [phi1, phi2]: [Interval; 2], phi0: Interval) -> [Interval; 2] {
    let quarter = Interval::PI * Interval::point(0.5);
    let both = phi1 + phi2;
    let (first, second) = (body.slopes(phi1 - phi0 - quarter), body.slopes(both - phi0 + quarter));
    let (a, b) = (both.sin_cos().0, phi1.sin_cos().0);
    [-(a * first[0] + b * second[0]), a * first[1] + b * second[1]]
}

fn cells(body: &EnclosedTable, palms: [Interval; 2]) -> Vec<(f64, f64, Cell)> {
    let mut found = Vec::new();
    let edge = |k: u32| if k == CELLS { TAU.next_up() } else { TAU * f64::from(k) / f64::from(CELLS) };
    for k in 0..CELLS {
        let mut open = vec![(edge(k), edge(k + 1), 0)];
        while let Some((low, high, depth)) = open.pop() {
            let [slope, bend] = slopes(body, palms, Interval::new(low, high));
            let cell = if slope.high() < 0.0 {
                Cell::Falls
            } else if slope.low() > 0.0 {
                Cell::Rises
            } else if bend.low() > 0.0 {
                Cell::Convex
            } else if bend.high() < 0.0 {
                Cell::Concave
            } else if depth < HALVINGS {
                let middle = f64::midpoint(low, high);
                open.push((middle, high, depth + 1));
                open.push((low, middle, depth + 1));
                continue;
            } else {
                Cell::Open
            };
            found.push((low, high, cell));
        }
    }
    found
}

/// The runs of cells in which a stable pose may be.
fn runs(body: &EnclosedTable, palms: [Interval; 2]) -> Vec<Run> {
    let cells = cells(body, palms);
    let count = cells.len();
    let is_kept = |i: usize| matches!(cells[i % count].2, Cell::Convex | Cell::Open);
    let Some(start) = (0..count).find(|i| !is_kept(*i)) else {
        return vec![Run { ends: [0.0, TAU], is_sheet: false }];
    };
    let mut found = Vec::new();
    let mut i = start;
    while i < start + count {
        if !is_kept(i) {
            i += 1;
            continue;
        }
        let begin = i;
        while is_kept(i) {
            i += 1;
        }
        let is_convex = (begin..i).all(|k| cells[k % count].2 == Cell::Convex);
        let (before, after) = (cells[(begin + count - 1) % count].2, cells[i % count].2);
        // U' increases over a convex run: where it is positive before or negative behind, it does not vanish in it
        if is_convex && (before == Cell::Rises || after == Cell::Falls) {
            continue;
        }
        let turn = |k: usize| if k >= count { TAU } else { 0.0 };
        let ends = [cells[begin % count].0 + turn(begin), cells[(i - 1) % count].1 + turn(i - 1)];
        found.push(Run { ends, is_sheet: is_convex && before == Cell::Falls && after == Cell::Rises });
    }
    found
}

/// Squares with their runs: those with open ones are cut in four down to the finest.
fn divided(body: &EnclosedTable, grid: &Grid, square: Square, interrupt: &AtomicBool) -> Vec<Known> {
    let mut found = Vec::new();
    let mut open = vec![square];
    while let Some(square) = open.pop() {
        let Square { x, y, size } = square;
        if x + y >= grid.units || interrupt.load(Ordering::Relaxed) {
            continue;
        }
        let is_inside = x + y + 2 * size <= grid.units;
        let four = || {
            let half = size / 2;
            [(0, 0), (half, 0), (0, half), (half, half)].map(|(a, b)| Square {
                x: x + a,
                y: y + b,
                size: half,
            })
        };
        if is_inside || size == 1 {
            let runs = runs(body, [grid.palm(x, size), grid.palm(y, size)]);
            if size == 1 || runs.iter().all(|run| run.is_sheet) {
                found.push(Known { square, runs, is_inside });
                continue;
            }
        }
        open.extend(four());
    }
    found
}

/// The turns by which the second run has to be taken on so that both overlap by more than `least`.
fn shifts(first: &Run, second: &Run, least: f64) -> impl Iterator<Item = i32> {
    let (first, second) = (first.ends, second.ends);
    (-2..=2).filter(move |turns| {
        let by = TAU * f64::from(*turns);
        let [low, high] = second.map(|end| end + by);
        high.min(first[1]) - low.max(first[0]) > least
    })
}

/// Certifies stable poses at a margin from parallel palms, rad. `levels` is how often the squares (eight along a side) are halved where
/// something is open; the body has to be one of harmonics, an ellipse or a spline, and the margin below `pi/3`: `None` otherwise.
pub fn certify_surface(
    body: &PoseBody,
    margin: f64,
    levels: u32,
    interrupt: &AtomicBool,
) -> Option<SurfaceCertificate> {
    let enclosed = EnclosedTable::new(body)?;
    if !(margin > 0.0 && margin < PI / 3.0 - 1e-3) {
        return None;
    }
    let size = 1 << levels.min(7);
    // a trifle less, so that no rounding brings an edge beyond the margin
    let grid = Grid {
        margin: margin * (1.0 + 1e-12),
        side: (PI - 3.0 * margin) * (1.0 - 1e-9),
        units: BEGIN * size,
    };
    let begin: Vec<Square> = (0..BEGIN * BEGIN)
        .map(|i| Square { x: size * (i % BEGIN), y: size * (i / BEGIN), size })
        .filter(|square| square.x + square.y < grid.units)
        .collect();
    let parts: Vec<Vec<Known>> =
        begin.par_iter().map(|square| divided(&enclosed, &grid, *square, interrupt)).collect();
    let squares: Vec<Known> = parts.into_iter().flatten().collect();
    Some(joined(margin, &grid, &squares, interrupt.load(Ordering::Relaxed)))
}

/// Pairs of squares with a common edge.
fn neighbours(grid: &Grid, squares: &[Known]) -> BTreeSet<(usize, usize)> {
    let units = grid.units as usize;
    let mut owner = vec![usize::MAX; units * units];
    for (i, Known { square, .. }) in squares.iter().enumerate() {
        for y in square.y..square.y + square.size {
            for x in square.x..square.x + square.size {
                owner[y as usize * units + x as usize] = i;
            }
        }
    }
    let mut found = BTreeSet::new();
    for y in 0..units {
        for x in 0..units {
            let here = owner[y * units + x];
            let right = if x + 1 < units { owner[y * units + x + 1] } else { usize::MAX };
            let above = if y + 1 < units { owner[(y + 1) * units + x] } else { usize::MAX };
            for other in [right, above] {
                if here != usize::MAX && other != usize::MAX && here != other {
                    found.insert((here.min(other), here.max(other)));
                }
            }
        }
    }
    found
}

fn joined(margin: f64, grid: &Grid, squares: &[Known], interrupted: bool) -> SurfaceCertificate {
    let mut starts = vec![0];
    starts.extend(squares.iter().scan(0, |sum, known| {
        *sum += known.runs.len();
        Some(*sum)
    }));
    let total = starts.last().copied().unwrap_or(0);
    let (mut certain, mut possible) = (TurnSets::new(total), TurnSets::new(total));
    for (a, b) in neighbours(grid, squares) {
        let are_inside = squares[a].is_inside && squares[b].is_inside;
        for (i, first) in squares[a].runs.iter().enumerate() {
            for (j, second) in squares[b].runs.iter().enumerate() {
                let (one, other) = (starts[a] + i, starts[b] + j);
                if are_inside && first.is_sheet && second.is_sheet {
                    // taken on by a turn it is near: what is lifted there is stored a turn lower
                    shifts(first, second, OVERLAP).for_each(|turns| certain.join(one, other, -turns));
                }
                shifts(first, second, -OVERLAP).for_each(|turns| possible.join(one, other, -turns));
            }
        }
    }
    let area = |square: &Square| {
        let side = f64::from(square.size) / f64::from(grid.units);
        2.0 * side * side
    };
    let mut counted: BTreeMap<usize, f64> = BTreeMap::new();
    let mut components: BTreeMap<usize, f64> = BTreeMap::new();
    let (mut apart, mut reach) = (BTreeSet::new(), BTreeMap::new());
    for (a, Known { square, runs, is_inside }) in squares.iter().enumerate() {
        for (i, run) in runs.iter().enumerate() {
            let (root, turns) = possible.root(starts[a] + i);
            let [low, high] = run.ends.map(|end| end - TAU * f64::from(turns));
            let ends: &mut [f64; 2] = reach.entry(root).or_insert([low, high]);
            *ends = [ends[0].min(low), ends[1].max(high)];
        }
        if !is_inside {
            continue;
        }
        if runs.iter().all(|run| run.is_sheet) {
            *counted.entry(runs.len()).or_default() += area(square);
        }
        for (i, _) in runs.iter().enumerate().filter(|(_, run)| run.is_sheet) {
            *components.entry(certain.root(starts[a] + i).0).or_default() += area(square);
            apart.insert(possible.root(starts[a] + i).0);
        }
    }
    let is_confined =
        reach.iter().all(|(root, [low, high])| possible.holonomy(*root) == 0 && high - low < TAU - OVERLAP);
    let mut components: Vec<CertifiedComponent> = components
        .into_iter()
        .map(|(root, sheets)| CertifiedComponent { sheets, holonomy: certain.holonomy(root) })
        .collect();
    components.sort_by(|a, b| b.sheets.total_cmp(&a.sheets));
    if interrupted {
        components.clear();
    }
    SurfaceCertificate {
        margin,
        squares: squares.iter().filter(|known| known.is_inside).count(),
        region: squares.iter().filter(|known| known.is_inside).map(|known| area(&known.square)).sum(),
        counted: if interrupted { BTreeMap::new() } else { counted },
        at_least: if interrupted { 0 } else { apart.len() },
        components,
        is_confined: is_confined && !interrupted,
        interrupted,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_surface::body::tests::egg;
    use crate::pose_surface::families::BodyFamily;
    use crate::pose_surface::potential::PalmPair;
    use crate::pose_surface::stable::stable_poses;

    /// Where the number of stable poses is certain, it is what is found in doubles, at places of which the certificate knew nothing.
    #[test]
    fn certain_counts_are_those_that_are_found() {
        let body = egg();
        let enclosed = EnclosedTable::new(&body).expect("enclosed");
        let grid = Grid { margin: 0.3, side: PI - 0.9, units: 32 };
        let mut seen = 0;
        for (x, y) in (0..31).flat_map(|x| (0..31 - x).map(move |y| (x, y))).step_by(7) {
            let palms = [grid.palm(x, 1), grid.palm(y, 1)];
            let runs = runs(&enclosed, palms);
            if !runs.iter().all(|run| run.is_sheet) {
                continue;
            }
            seen += 1;
            for part in [0.1, 0.9] {
                let at = palms.map(|side| side.low() + part * (side.high() - side.low()));
                let found = stable_poses(&body, PalmPair::new(at[0], at[1]));
                assert_eq!(found.len(), runs.len(), "{at:?}");
                for pose in found {
                    let holds = |run: &Run| {
                        let place = (pose.phi0 - run.ends[0]).rem_euclid(TAU);
                        place <= run.ends[1] - run.ends[0]
                    };
                    assert_eq!(runs.iter().filter(|run| holds(run)).count(), 1);
                }
            }
        }
        assert!(seen > 40, "{seen}");
    }

    /// A spline comes round for certain; a disc whose mass is off centre has one stable pose everywhere, and no way to turn it:
    /// its centre of mass hangs below its middle whatever the palms do.
    #[test]
    fn a_turn_is_certain_and_its_absence_is() {
        let never = AtomicBool::new(false);
        let found = certify_surface(&BodyFamily::Splines.draw(1, 0), 0.15, 3, &never).expect("a certificate");
        assert!(found.reaches_all() && !found.is_confined, "{found:?}");
        let disc = PoseBody::parse("ellipse:1,1", Some([0.3, 0.1])).unwrap();
        let found = certify_surface(&disc, 0.2, 3, &never).expect("a certificate");
        assert!(
            !found.reaches_all() && found.is_confined && found.components.len() == 1 && found.at_least == 1,
            "{found:?}"
        );
        assert!((found.counted[&1] - found.region).abs() < 1e-12 && found.region > 0.9, "{found:?}");
        assert!(certify_surface(&disc, 1.2, 3, &never).is_none());
    }
}
