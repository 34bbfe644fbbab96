//! Plans: how palms have to move so that the body turns from one orientation to another, or shows them all of its outline.
//!
//! On the grid of stable poses a plan is a shortest way, the length being that of the palms' path (`hypot` of both angles). Contacts move without a
//! break, so that a way from one lifted pose to another touches at least the normals between its ends, on either palm: a plan that touches
//! all is a shortest way to any pose at which both arcs cover a turn. It is then made shorter by leaving out nodes, and followed from its
//! start once more: a plan that is handed out was run.

use super::body::PoseBody;
use super::potential::PalmPair;
use super::sheets::{PoseGrid, PoseLimits};
use super::slide::{Slide, covered, path_length, slide, slide_straight};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::f64::consts::TAU;

/// A plan that was run.
#[derive(Clone, Debug, PartialEq)]
pub struct PosePlan {
    /// Corners of the palms' path.
    pub path: Vec<PalmPair>,
    /// Where the body went.
    pub slide: Slide,
    /// The length of the path, rad.
    pub length: f64,
    /// The part of all normals that it touches.
    pub coverage: f64,
}

/// Why there is no plan.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoPlan {
    /// Nothing keeps the limits.
    #[error(
        "no stable pose on the grid keeps the limits: make the margin or the tolerance smaller, or the pad longer"
    )]
    NoPose,
    /// A whole turn cannot be shown.
    #[error("from no pose can all normals be touched: the farthest way touches {:.1} % of them", 100.0 * .0)]
    NotAll(f64),
    /// There is no way to the orientation.
    #[error(
        "no way leads to that orientation: from where it is the body can be turned from {0:.3} to {1:.3} rad"
    )]
    OutOfReach(f64, f64),
    /// No pose near the start.
    #[error("no stable pose on the grid has the orientation {0:.3} rad, or keeps the limits there")]
    NoStart(f64),
    /// The grid's way was not confirmed.
    #[error("the way on the grid was not confirmed when it was run")]
    NotConfirmed,
}

/// What a plan is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanGoal {
    /// To touch all normals, from whichever pose it is shortest.
    TouchAll,
    /// From one orientation to another, rad, at whichever palm angles.
    Turn {
        /// At the start.
        from: f64,
        /// At the end, up to whole turns.
        to: f64,
    },
}

/// Poses from which shortest ways are looked for.
const STARTS: usize = 24;

/// No way goes round more often than this.
const MOST_TURNS: i32 = 2;

/// A length that can be ordered: all are finite.
#[derive(Clone, Copy, PartialEq)]
struct Length(f64);

impl Eq for Length {}
impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

type Lifted = (usize, i32);

/// Poses of the grid with their lifted orientations.
type GridWay = Vec<(usize, f64)>;

/// A shortest way over the lifted grid, as poses with their lifted orientations, to the first one that will do; or else all orientations that were met.
fn shortest(
    grid: &PoseGrid,
    starts: &[usize],
    within: f64,
    arrives: impl Fn(usize, f64, f64) -> bool,
) -> Result<(GridWay, f64), Vec<f64>> {
    let lifted = |(pose, turns): Lifted| grid.poses[pose].phi0 + TAU * f64::from(turns);
    let mut open: BinaryHeap<Reverse<(Length, Lifted)>> = BinaryHeap::new();
    let mut best: HashMap<Lifted, (f64, Option<Lifted>)> = HashMap::new();
    for start in starts {
        open.push(Reverse((Length(0.0), (*start, 0))));
        best.insert((*start, 0), (0.0, None));
    }
    let begin = starts.first().map_or(0.0, |start| grid.poses[*start].phi0);
    let mut seen = Vec::new();
    while let Some(Reverse((Length(gone), here))) = open.pop() {
        if gone > best[&here].0 || gone > within {
            continue;
        }
        let phi0 = lifted(here);
        seen.push(phi0);
        if arrives(here.0, phi0, begin) {
            let (mut way, mut at) = (vec![(here.0, phi0)], here);
            while let Some(before) = best[&at].1 {
                at = before;
                way.push((at.0, lifted(at)));
            }
            way.reverse();
            return Ok((way, gone));
        }
        for (there, turned) in &grid.poses[here.0].ways {
            let turns = ((phi0 + turned - grid.poses[*there].phi0) / TAU).round() as i32;
            let (next, length) =
                ((*there, turns), gone + grid.poses[here.0].palms.distance(grid.poses[*there].palms));
            if turns.abs() <= MOST_TURNS && best.get(&next).is_none_or(|(known, _)| length < *known) {
                best.insert(next, (length, Some(here)));
                open.push(Reverse((Length(length), next)));
            }
        }
    }
    Err(seen)
}

/// The part of a turn between the normals of two lifted poses, on both palms.
fn between(grid: &PoseGrid, start: usize, begin: f64, end: usize, phi0: f64) -> f64 {
    let (first, last) = (grid.poses[start].palms.normals(begin), grid.poses[end].palms.normals(phi0));
    covered(&[0, 1].map(|i: usize| [first[i].min(last[i]), first[i].max(last[i])]))
}

/// Leaves out corners as long as the body comes to the same lifted pose, and the limits are kept.
fn shortened(body: &PoseBody, limits: &PoseLimits, way: &[(PalmPair, f64)]) -> Vec<PalmPair> {
    let mut path = vec![way[0].0];
    let mut i = 0;
    while i + 1 < way.len() {
        let direct = |j: usize| {
            let mut is_allowed = true;
            let end = slide_straight(body, way[i].0, way[j].0, way[i].1, |palms, phi0| {
                is_allowed &= limits.allow(body, palms, phi0) && limits.stands(body, palms, phi0);
            });
            is_allowed && end.is_ok_and(|end| (end - way[j].1).abs() < 1e-6)
        };
        let mut stride = way.len() - 1 - i;
        while stride > 1 && !direct(i + stride) {
            stride /= 2;
        }
        i += stride.max(1);
        path.push(way[i].0);
    }
    path
}

/// Plans on a grid that was made with the same limits. Deterministic.
///
/// # Errors
/// Why there is none.
pub fn pose_plan(
    body: &PoseBody,
    grid: &PoseGrid,
    limits: &PoseLimits,
    goal: PlanGoal,
) -> Result<PosePlan, NoPlan> {
    if grid.poses.is_empty() {
        return Err(NoPlan::NoPose);
    }
    let spacing =
        grid.poses.iter().flat_map(|pose| pose.ways.iter().map(|way| way.1.abs())).fold(0.0, f64::max);
    let way = match goal {
        PlanGoal::TouchAll => {
            let stride = grid.poses.len().div_ceil(STARTS);
            let (mut best, mut most) = (None::<(GridWay, f64)>, 0.0_f64);
            for start in (0..grid.poses.len()).step_by(stride) {
                let within = best.as_ref().map_or(f64::INFINITY, |(_, length)| *length);
                let begin = grid.poses[start].phi0;
                let far = std::cell::Cell::new(0.0_f64);
                let found = shortest(grid, &[start], within, |end, phi0, _| {
                    let part = between(grid, start, begin, end, phi0);
                    far.set(far.get().max(part));
                    part >= 1.0 - 1e-12
                });
                most = most.max(far.get());
                if let Ok(found) = found {
                    best = Some(found);
                }
            }
            best.ok_or(NoPlan::NotAll(most))?.0
        }
        PlanGoal::Turn { from, to } => {
            let off = |a: f64, b: f64| {
                let off = (a - b).rem_euclid(TAU);
                off.min(TAU - off)
            };
            // the poses nearest to the orientation, no farther than neighbours are
            let nearest = grid.poses.iter().map(|pose| off(pose.phi0, from)).fold(f64::INFINITY, f64::min);
            let close = nearest.max(spacing / 4.0).max(1e-3);
            if nearest > spacing.max(1e-3) {
                return Err(NoPlan::NoStart(from));
            }
            let starts: Vec<usize> =
                (0..grid.poses.len()).filter(|i| off(grid.poses[*i].phi0, from) <= close).collect();
            let arrives = |_: usize, phi0: f64, _: f64| off(phi0, to) <= close;
            shortest(grid, &starts, f64::INFINITY, arrives)
                .map_err(|seen| {
                    let (low, high) = seen
                        .iter()
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (x.min(a), x.max(b)));
                    NoPlan::OutOfReach(low, high)
                })?
                .0
        }
    };
    let lifted: Vec<(PalmPair, f64)> =
        way.iter().map(|(pose, phi0)| (grid.poses[*pose].palms, *phi0)).collect();
    let end = lifted[lifted.len() - 1].1;
    // where the shorter one is not confirmed, perhaps the way itself is
    let whole = || lifted.iter().map(|(palms, _)| *palms).collect();
    let shorter = || shortened(body, limits, &lifted);
    let both: [&dyn Fn() -> Vec<PalmPair>; 2] = [&shorter, &whole];
    for path in both {
        let path = path();
        let run = slide(body, &path, lifted[0].1);
        let is_there = run.poses.last().is_some_and(|(_, phi0)| (phi0 - end).abs() < 1e-6);
        let coverage = run.coverage();
        let is_whole = goal != PlanGoal::TouchAll || coverage >= 1.0 - 1e-9;
        if run.jumps.is_empty() && is_there && is_whole {
            return Ok(PosePlan { length: path_length(&path), path, coverage, slide: run });
        }
    }
    Err(NoPlan::NotConfirmed)
}

/// So many times as many nodes along a side are tried where a grid gives no plan, but no more than the second number: work grows with the square.
const FINER: [usize; 2] = [2, 4];
const MOST_NODES: usize = 200;

/// The same on finer grids, one after the other, where this one gives no plan: between its nodes a fold may be nearer than a step. The answer of the finest is
/// given.
///
/// # Errors
/// As for [`pose_plan`].
pub fn finer_pose_plan(
    body: &PoseBody,
    grid: &PoseGrid,
    limits: &PoseLimits,
    goal: PlanGoal,
) -> Result<PosePlan, NoPlan> {
    let finer = |by: usize| pose_plan(body, &PoseGrid::new(body, limits, by * grid.side), limits, goal);
    let sides = FINER.into_iter().filter(|by| by * grid.side <= MOST_NODES);
    sides.fold(pose_plan(body, grid, limits, goal), |found, by| found.or_else(|_| finer(by)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_surface::BodyFamily;
    use crate::pose_surface::body::tests::egg;
    use crate::pose_surface::slide::plan_of_figure_3_14;

    const LIMITS: PoseLimits = PoseLimits { margin: 0.2, pad: None, tolerance: 0.0 };

    /// A plan touches every normal, counted degree by degree along its run, keeps its margin everywhere, and takes no longer than one round and a half of plan
    /// 3.14, which turns the body by less than is needed.
    #[test]
    fn a_plan_touches_every_normal() {
        let body = egg();
        let grid = PoseGrid::new(&body, &LIMITS, 16);
        let plan = pose_plan(&body, &grid, &LIMITS, PlanGoal::TouchAll).expect("a plan");
        let mut seen = [false; 360];
        for poses in plan.slide.poses.windows(2) {
            let ends = [poses[0], poses[1]].map(|(palms, phi0)| palms.normals(phi0));
            for (a, b) in ends[0].iter().zip(ends[1]) {
                let (low, high) = (a.min(b), a.max(b));
                // 0.2 rad of the body and 0.02 rad of either palm, or else it would have been looked at more closely
                assert!(high - low < 0.24, "no jump");
                for degree in (low.to_degrees().ceil() as i32)..=(high.to_degrees().floor() as i32) {
                    seen[degree.rem_euclid(360) as usize] = true;
                }
            }
            assert!(poses[1].0.margin() > 0.2 - 1e-9);
        }
        assert!(seen.iter().all(|seen| *seen));
        assert!(plan.slide.jumps.is_empty());
        assert!(plan.length < path_length(&plan_of_figure_3_14(0.2, 2)), "{}", plan.length);
    }

    /// A body for which the way on a grid of 20 is not confirmed, since a fold is nearer than its steps: a finer one has a plan.
    #[test]
    fn a_finer_grid_confirms_a_plan() {
        let body = BodyFamily::Splines.draw(1, 9);
        let limits = PoseLimits { margin: 0.15, ..LIMITS };
        let grid = PoseGrid::new(&body, &limits, 20);
        assert_eq!(pose_plan(&body, &grid, &limits, PlanGoal::TouchAll), Err(NoPlan::NotConfirmed));
        let plan = finer_pose_plan(&body, &grid, &limits, PlanGoal::TouchAll).expect("a plan");
        assert!(plan.slide.jumps.is_empty() && plan.coverage >= 1.0 - 1e-9);
    }

    /// From any orientation to any other; with a pad that is too short, or palms that may be off by half a radian, the error says that no pose is left.
    #[test]
    fn a_plan_turns_the_body_and_a_failure_says_why() {
        let body = egg();
        let grid = PoseGrid::new(&body, &LIMITS, 14);
        for (from, to) in [(0.0, 3.0), (5.0, 1.0), (2.0, 2.5)] {
            let plan = pose_plan(&body, &grid, &LIMITS, PlanGoal::Turn { from, to }).expect("a plan");
            let off = (plan.slide.poses.last().unwrap().1 - to).rem_euclid(TAU);
            assert!(off.min(TAU - off) < 0.2, "{off}");
        }
        for limits in
            [PoseLimits { pad: Some([0.0, 0.05]), ..LIMITS }, PoseLimits { tolerance: 1.5, ..LIMITS }]
        {
            let grid = PoseGrid::new(&body, &limits, 10);
            assert_eq!(pose_plan(&body, &grid, &limits, PlanGoal::TouchAll), Err(NoPlan::NoPose));
        }
        let disc = PoseBody::parse("ellipse:1,1", Some([0.3, 0.1])).unwrap();
        let grid = PoseGrid::new(&disc, &LIMITS, 10);
        let Err(NoPlan::NotAll(part)) = pose_plan(&disc, &grid, &LIMITS, PlanGoal::TouchAll) else {
            panic!()
        };
        // the disc does not turn: palm 1 touches the range of phi1, palm 2 that of phi1 + phi2, each pi - 3 margin wide
        assert!((part - 2.0 * (std::f64::consts::PI - 0.6) / TAU).abs() < 1e-9, "{part}");
    }
}
