//! A body that lies in a stable pose while the palms move: where it goes along a path of palm angles, and where it jumps.

use super::body::PoseBody;
use super::potential::{PalmPair, potential};
use super::zeros::zero_between;
use std::f64::consts::{PI, TAU};

/// Palms move by no more than this at once, rad.
const STEP: f64 = 0.02;

/// A jump is one that remains when palms move by this, rad.
const LEAST_STEP: f64 = 1e-8;

/// Between two orientations the curvature of the potential is looked at this often, rad.
const LOOK: f64 = 0.01;

/// A sudden change of the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseJump {
    /// Where the palms were.
    pub palms: PalmPair,
    /// The orientation before it and after it, rad.
    pub orientation: [f64; 2],
}

/// Where a body went along a path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slide {
    /// Palm angles and orientation, lifted: whole turns count.
    pub poses: Vec<(PalmPair, f64)>,
    /// Its jumps.
    pub jumps: Vec<PoseJump>,
}

impl Slide {
    /// By how much the body has turned, rad.
    pub fn turned(&self) -> f64 {
        match (self.poses.first(), self.poses.last()) {
            (Some(first), Some(last)) => last.1 - first.1,
            _ => 0.0,
        }
    }

    /// The part of all normals that either palm has touched, between 0 and 1. Where the body jumps contact is lost: each stretch
    /// without a jump touches what lies between its ends.
    pub fn coverage(&self) -> f64 {
        let mut arcs = Vec::new();
        let mut open: [Option<[f64; 2]>; 2] = [None, None];
        let mut last: Option<f64> = None;
        for (palms, phi0) in &self.poses {
            let has_jumped =
                last.is_some_and(|last| self.jumps.iter().any(|jump| jump.orientation == [last, *phi0]));
            if has_jumped {
                arcs.extend(open.iter_mut().filter_map(Option::take));
            }
            for (arc, angle) in open.iter_mut().zip(palms.normals(*phi0)) {
                let [low, high] = arc.unwrap_or([angle, angle]);
                *arc = Some([low.min(angle), high.max(angle)]);
            }
            last = Some(*phi0);
        }
        arcs.extend(open.into_iter().flatten());
        covered(&arcs)
    }
}

/// The part of a turn that arcs cover.
pub(super) fn covered(arcs: &[[f64; 2]]) -> f64 {
    let mut pieces: Vec<[f64; 2]> = Vec::new();
    for [low, high] in arcs {
        if high - low >= TAU {
            return 1.0;
        }
        let (begin, length) = (low.rem_euclid(TAU), high - low);
        pieces.push([begin, (begin + length).min(TAU)]);
        if begin + length > TAU {
            pieces.push([0.0, begin + length - TAU]);
        }
    }
    pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut total, mut end) = (0.0, 0.0_f64);
    for [low, high] in pieces {
        total += (high - low.max(end)).max(0.0);
        end = end.max(high);
    }
    (total / TAU).min(1.0)
}

/// The nearest stable pose downhill, and whether the potential was convex on all of the way. `None` where no way leads down within a turn:
/// the potential is flat.
pub(super) fn downhill(body: &PoseBody, palms: PalmPair, phi0: f64) -> Option<(f64, bool)> {
    let slope = |phi0: f64| potential(body, palms, phi0);
    let [_, here, bend] = slope(phi0);
    if here == 0.0 {
        return (bend > 0.0).then_some((phi0, true));
    }
    let direction = -here.signum();
    // where Newton's step is short the zero is bracketed at once
    let mut stride = if bend > 0.0 { (2.0 * here.abs() / bend).clamp(1e-12, LOOK) } else { LOOK };
    let (mut near, mut is_convex) = (phi0, bend > 0.0);
    let mut gone = 0.0;
    while gone < TAU {
        let far = near + direction * stride;
        let [_, next, bend] = slope(far);
        is_convex &= bend > 0.0;
        if next * direction >= 0.0 {
            let slopes = |x: f64| {
                let [_, slope, bend] = slope(x);
                [slope, bend]
            };
            let found = zero_between(slopes, near.min(far), near.max(far));
            return Some((found, is_convex));
        }
        gone += stride;
        near = far;
        stride = LOOK;
    }
    None
}

/// Moves the palms on a straight line, as finely as the body asks for. The orientation at the end, or the jump: `Err` has the orientations
/// before it and after it, and where it was.
pub(super) fn slide_straight(
    body: &PoseBody,
    from: PalmPair,
    to: PalmPair,
    phi0: f64,
    mut visit: impl FnMut(PalmPair, f64),
) -> Result<f64, PoseJump> {
    let length = from.distance(to);
    let (mut part, mut phi0, mut step) = (0.0, phi0, STEP);
    while part < 1.0 {
        let next = if length > 0.0 { (part + step / length).min(1.0) } else { 1.0 };
        let palms = from.toward(to, next);
        match downhill(body, palms, phi0) {
            // a pose that moves by much for little has to be looked at more closely
            Some((found, true)) if (found - phi0).abs() < 0.2 || step < LEAST_STEP => {
                (part, phi0) = (next, found);
                visit(palms, phi0);
                step = (2.0 * step).min(STEP);
            }
            found if step < LEAST_STEP || length == 0.0 => {
                let after = found.map_or(phi0, |(after, _)| after);
                return Err(PoseJump { palms, orientation: [phi0, after] });
            }
            _ => step /= 2.0,
        }
    }
    Ok(phi0)
}

/// Follows a body from a stable pose along a path of palm angles, straight from corner to corner; after a jump it goes on from where it
/// has landed.
pub fn slide(body: &PoseBody, path: &[PalmPair], phi0: f64) -> Slide {
    let Some(first) = path.first() else { return Slide::default() };
    let mut found = Slide { poses: vec![(*first, phi0)], jumps: Vec::new() };
    let mut phi0 = phi0;
    for ends in path.windows(2) {
        let (mut from, to) = (ends[0], ends[1]);
        loop {
            match slide_straight(body, from, to, phi0, |palms, phi0| found.poses.push((palms, phi0))) {
                Ok(end) => {
                    phi0 = end;
                    break;
                }
                Err(jump) => {
                    found.jumps.push(jump);
                    found.poses.push((jump.palms, jump.orientation[1]));
                    phi0 = jump.orientation[1];
                    from = jump.palms;
                    // more jumps than this has no body that lies anywhere
                    if found.jumps.len() > 1000 {
                        return found;
                    }
                }
            }
        }
    }
    found
}

/// Plan 3.14 at a margin from parallel palms, so many rounds: with palm 1 nearly level palm 2 closes from nearly level as well, then both turn
/// to the other side together, then both go back. The corners of its path, the first one again at the end.
pub fn plan_of_figure_3_14(margin: f64, rounds: usize) -> Vec<PalmPair> {
    let far = PI - 2.0 * margin;
    let corners = [PalmPair::new(margin, far), PalmPair::new(margin, margin), PalmPair::new(far, margin)];
    let mut path: Vec<PalmPair> = (0..rounds).flat_map(|_| corners).collect();
    path.push(corners[0]);
    path
}

/// The length of a path of palm angles, rad.
pub fn path_length(path: &[PalmPair]) -> f64 {
    path.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_surface::body::tests::{egg, off_centre};
    use crate::pose_surface::stable::stable_poses;

    /// At every corner of the path the body is in one of the stable poses that are found from nothing. A jump takes away one of them: just
    /// before it there is one more than just behind it.
    #[test]
    fn a_fold_has_one_pose_less_behind_it() {
        let mut jumps = 0;
        let bodies = [
            egg(),
            off_centre(),
            PoseBody::parse("harmonics:1,0.02,0.01,0.05,0.03,0.01,0.02", Some([0.2, 0.1])).unwrap(),
        ];
        for body in bodies {
            for margin in [0.05, 0.15, 0.3] {
                let path = plan_of_figure_3_14(margin, 1);
                for start in stable_poses(&body, path[0]) {
                    let found = slide(&body, &path, start.phi0);
                    let (palms, phi0) = *found.poses.last().unwrap();
                    assert_eq!(palms, path[0]);
                    let ends = stable_poses(&body, palms);
                    let near = |x: f64| (x.rem_euclid(TAU)).min((-x).rem_euclid(TAU));
                    assert!(ends.iter().any(|end| near(end.phi0 - phi0) < 1e-7), "{phi0} {ends:?}");
                    for jump in &found.jumps {
                        jumps += 1;
                        let i = found.poses.iter().position(|pose| pose.1 == jump.orientation[1]).unwrap();
                        let before = found.poses[i - 1].0;
                        // straight on, on either side of the fold, by as much as a square root needs to separate both poses
                        let way = before.distance(jump.palms).max(1e-12);
                        let on = |by: f64| jump.palms.toward(before, by / way);
                        let counts = [1e-4, -1e-4].map(|by| stable_poses(&body, on(by)).len());
                        assert_eq!(counts[0], counts[1] + 1, "{jump:?}");
                    }
                }
            }
        }
        assert!(jumps > 3, "{jumps}");
    }

    /// Arcs by hand.
    #[test]
    fn arcs_cover_a_part_of_a_turn() {
        assert!((covered(&[[0.0, PI], [3.0 * PI, 3.5 * PI]]) - 0.75).abs() < 1e-15);
        assert!((covered(&[[-0.5, 0.5], [0.0, 1.0]]) - 1.5 / TAU).abs() < 1e-15);
        assert!((covered(&[[1.0, 7.3]]) - 1.0).abs() < 1e-15);
        assert!((path_length(&plan_of_figure_3_14(0.0, 1)) - (2.0 + 2f64.sqrt()) * PI).abs() < 1e-12);
    }
}
