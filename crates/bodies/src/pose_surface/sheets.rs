//! The surface over a grid of palm angles: all stable poses at each node, and which poses of neighbouring nodes the body slides between. What pictures show and planners walk on.

use super::body::PoseBody;
use super::potential::{PalmPair, measurements};
use super::slide::slide_straight;
use super::stable::stable_poses;
use std::f64::consts::{PI, TAU};

/// What a pose of a plan has to keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseLimits {
    /// Palms keep this from being parallel to each other or to the ground, rad.
    pub margin: f64,
    /// Both contacts lie in this part of their palms, measured from the line in which the palms meet, m.
    pub pad: Option<[f64; 2]>,
    /// The body stays in its pose while either palm is off by this, rad; 0 asks for nothing.
    pub tolerance: f64,
}

impl PoseLimits {
    pub(super) fn allow(&self, body: &PoseBody, palms: PalmPair, phi0: f64) -> bool {
        let on_pad = self.pad.is_none_or(|[low, high]| {
            measurements(body, palms, phi0).into_iter().all(|reading| (low..=high).contains(&reading))
        });
        on_pad && palms.margin() >= self.margin - 1e-12
    }

    /// Whether the pose stands it that both palms are off: to each of the four corners around them it is a slide without a jump.
    pub(super) fn stands(&self, body: &PoseBody, palms: PalmPair, phi0: f64) -> bool {
        let off = self.tolerance;
        off == 0.0
            || [[off, off], [off, -off], [-off, off], [-off, -off]].into_iter().all(|[a, b]| {
                let to = PalmPair::new(palms.phi1 + a, palms.phi2 + b);
                to.margin() > 0.0 && slide_straight(body, palms, to, phi0, |_, _| ()).is_ok()
            })
    }
}

/// A stable pose at a node.
#[derive(Clone, Debug, PartialEq)]
pub struct GridPose {
    /// The palms.
    pub palms: PalmPair,
    /// `phi0`, from 0 to a turn, rad.
    pub phi0: f64,
    /// Poses that the body slides to: which one, and by how much it turns on the way, rad.
    pub ways: Vec<(usize, f64)>,
}

/// All stable poses over a triangular grid that keep the limits.
#[derive(Clone, Debug)]
pub struct PoseGrid {
    /// In the order of their nodes.
    pub poses: Vec<GridPose>,
    /// Nodes along a side.
    pub side: usize,
}

impl PoseGrid {
    /// A grid with so many nodes along a side of the triangle.
    pub fn new(body: &PoseBody, limits: &PoseLimits, side: usize) -> PoseGrid {
        let side = side.max(2);
        let step = (PI - 3.0 * limits.margin) / (side - 1) as f64;
        let palms = |i: usize, j: usize| {
            PalmPair::new(limits.margin + step * i as f64, limits.margin + step * j as f64)
        };
        let mut poses: Vec<GridPose> = Vec::new();
        let mut nodes = vec![vec![0..0; side]; side];
        if step <= 0.0 {
            return PoseGrid { poses, side };
        }
        for (i, row) in nodes.iter_mut().enumerate() {
            for (j, node) in row.iter_mut().enumerate().take(side - i) {
                let (begin, palms) = (poses.len(), palms(i, j));
                let kept = stable_poses(body, palms).into_iter().filter(|pose| {
                    limits.allow(body, palms, pose.phi0) && limits.stands(body, palms, pose.phi0)
                });
                poses.extend(kept.map(|pose| GridPose { palms, phi0: pose.phi0, ways: Vec::new() }));
                *node = begin..poses.len();
            }
        }
        for i in 0..side {
            for j in 0..side - i {
                for (a, b) in [(i + 1, j), (i, j + 1), (i + 1, j.wrapping_sub(1)), (i + 1, j + 1)] {
                    if a >= side || b >= side || a + b >= side {
                        continue;
                    }
                    for here in nodes[i][j].clone() {
                        join(body, limits, &mut poses, here, nodes[a][b].clone());
                    }
                }
            }
        }
        PoseGrid { poses, side }
    }
}

fn join(
    body: &PoseBody,
    limits: &PoseLimits,
    poses: &mut [GridPose],
    here: usize,
    others: std::ops::Range<usize>,
) {
    let Some(other) = others.clone().next() else { return };
    let (from, to, phi0) = (poses[here].palms, poses[other].palms, poses[here].phi0);
    let mut is_allowed = true;
    let end =
        slide_straight(body, from, to, phi0, |palms, phi0| is_allowed &= limits.allow(body, palms, phi0));
    let Ok(end) = end else { return };
    let near = |i: &usize| {
        let off = (end - poses[*i].phi0).rem_euclid(TAU);
        off.min(TAU - off) < 1e-6
    };
    if let Some(there) = others.clone().find(near).filter(|_| is_allowed) {
        poses[here].ways.push((there, end - phi0));
        poses[there].ways.push((here, phi0 - end));
    }
}
