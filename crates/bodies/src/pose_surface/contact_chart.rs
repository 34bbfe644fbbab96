//! The surface of stable poses over the pairs of normals that touch the palms.
//!
//! A pose is in balance where `A r'(a) + B r'(b) = 0` for the normals `a` at palm 1 and `b` at palm 2, `A` and `B` being positive. So `r'`
//! has different signs at both (or vanishes at both), `phi2 = b - a - pi`, and `A/B = |r'(b)|/|r'(a)|` determines `phi1`: *each pair of such
//! normals has one pair of palms*. It is stable where `r''(a)/|r'(a)| + r''(b)/|r'(b)| > 0`. Between the extrema of `r` the surface is therefore a
//! graph over rectangles, which are connected only at their corners: where both `r'` vanish each ratio will do, and the corner
//! stands for a whole line of poses with the same contacts. Near a corner what matters is the ratio of both distances from it, so that
//! nodes are laid evenly in the logarithm of the distance from either end.
//!
//! Computed, not certified: what is narrower than a step may be joined or cut.

use super::body::PoseBody;
use super::potential::PalmPair;
use super::turns::TurnSets;
use super::zeros::zeros_over_a_turn;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Samples of a turn between which extrema of the support function are looked for.
const SAMPLES: usize = 2880;

/// The first and last node of an interval lie this far from its ends, in logarithms of parts of its length.
const DEPTH: f64 = 11.0;

/// A component of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceComponent {
    /// Its area over the triangle of palm angles, a sheet that covers all of it counting as one.
    pub sheets: f64,
    /// By how many turns the body can be turned along a cycle of palm angles, the least positive number; zero where each cycle brings it
    /// back to where it was.
    pub holonomy: u32,
    /// The orientations that are met, lifted: from the least to the greatest, rad. Of no meaning where the holonomy is not zero.
    pub reach: f64,
}

impl SurfaceComponent {
    /// Whether the body can be brought to every orientation along it.
    pub fn reaches_all(&self) -> bool {
        self.holonomy > 0 || self.reach >= TAU
    }
}

/// The nodes of an interval between two extrema of the support function.
#[derive(Clone, Debug)]
struct Stretch {
    /// The angle of each node, its weight in an integral, `r'` and `r''`.
    nodes: Vec<[f64; 4]>,
    rises: bool,
}

/// The support function's extrema and the nodes between them.
#[derive(Clone, Debug)]
pub struct ContactChart {
    /// Angles of extrema, and `r''` there.
    extrema: Vec<[f64; 2]>,
    stretches: Vec<Stretch>,
}

/// A node that is a stable pose between palms that are far enough from parallel.
#[derive(Clone, Copy)]
struct Pose {
    phi0: f64,
    area: f64,
}

impl ContactChart {
    /// The chart with so many nodes between any two extrema of the support function. A disc about its middle has none, and no chart.
    pub fn new(body: &PoseBody, nodes: usize) -> ContactChart {
        let slopes = |angle: f64| {
            let [_, slope, second] = body.support(angle);
            [slope, second]
        };
        let zeros = zeros_over_a_turn(slopes, SAMPLES);
        let extrema: Vec<[f64; 2]> = zeros.iter().map(|zero| [zero.at, body.support(zero.at)[2]]).collect();
        let step = 2.0 * DEPTH / (nodes.max(2) - 1) as f64;
        let stretches = (0..zeros.len()).map(|j| {
            let begin = zeros[j].at;
            let width = (zeros[(j + 1) % zeros.len()].at - begin).rem_euclid(TAU);
            let width = if width == 0.0 { TAU } else { width };
            let node = |k: usize| {
                let part = 1.0 / (1.0 + (DEPTH - step * k as f64).exp());
                let angle = begin + width * part;
                let [_, slope, second] = body.support(angle);
                [angle, width * part * (1.0 - part) * step, slope, second]
            };
            Stretch { nodes: (0..nodes.max(2)).map(node).collect(), rises: zeros[j].rises }
        });
        ContactChart { stretches: stretches.collect(), extrema }
    }

    /// How many extrema the support function has over a turn: twice the number of stable poses on a level table.
    pub fn extrema(&self) -> usize {
        self.extrema.len()
    }

    fn pose(&self, [first, second]: [&[f64; 4]; 2], margin: f64) -> Option<Pose> {
        let [[a, wide, slope1, bend1], [b, high, slope2, bend2]] = [*first, *second];
        let phi2 = (b - a - PI).rem_euclid(TAU);
        let (d1, d2) = (slope1.abs(), slope2.abs());
        if phi2 < margin || phi2 > PI - 2.0 * margin || d1 == 0.0 || bend1 * d2 + bend2 * d1 <= 0.0 {
            return None;
        }
        let phi1 = phi2.sin().atan2(d2 / d1 - phi2.cos());
        if phi1 < margin || phi1 > PI - phi2 - margin {
            return None;
        }
        // along constant phi2: (A r1'' + B r2'') da + (A r1' + B r2')_phi1 dphi1 = 0
        let phi12 = phi1 + phi2;
        let bend = phi12.sin() * bend1 + phi1.sin() * bend2;
        let tilt = phi12.cos() * slope1 + phi1.cos() * slope2;
        Some(Pose { phi0: phi1 - FRAC_PI_2 - a, area: (bend / tilt).abs() * wide * high })
    }

    /// The components at a margin from parallel palms, rad: of the poses with `phi1`, `phi2`, `pi - phi1 - phi2` at least that. The
    /// greatest comes first.
    pub fn components(&self, margin: f64) -> Vec<SurfaceComponent> {
        let side = PI - 3.0 * margin;
        let (count, stretches) = (self.nodes(), self.stretches.len());
        if stretches == 0 || side <= 0.0 {
            return Vec::new();
        }
        let cells = count * count;
        // rising and falling stretches take turns: of each pair of different kinds one rectangle
        let place = |j: usize, k: usize| (j * (stretches / 2) + k / 2) * cells;
        let mut sets = TurnSets::new(stretches * stretches / 2 * cells);
        let mut poses: Vec<Option<Pose>> = vec![None; stretches * stretches / 2 * cells];
        for (j, first) in self.stretches.iter().enumerate() {
            for (k, second) in self.stretches.iter().enumerate() {
                if first.rises == second.rises {
                    continue;
                }
                let start = place(j, k);
                for (x, one) in first.nodes.iter().enumerate() {
                    for (y, other) in second.nodes.iter().enumerate() {
                        let here = start + x * count + y;
                        poses[here] = self.pose([one, other], margin);
                        if poses[here].is_none() {
                            continue;
                        }
                        if x > 0 && poses[here - count].is_some() {
                            sets.join(here - count, here, 0);
                        }
                        if y > 0 && poses[here - 1].is_some() {
                            sets.join(here - 1, here, 0);
                        }
                    }
                }
            }
        }
        self.join_at_corners(margin, &mut sets, &poses, &place);
        let mut found: BTreeMap<usize, (f64, [f64; 2])> = BTreeMap::new();
        for (i, pose) in poses.iter().enumerate() {
            let Some(pose) = pose else { continue };
            let (root, turns) = sets.root(i);
            let lifted = pose.phi0 + TAU * f64::from(turns);
            let (area, ends) = found.entry(root).or_insert((0.0, [f64::INFINITY, f64::NEG_INFINITY]));
            *area += pose.area;
            *ends = [ends[0].min(lifted), ends[1].max(lifted)];
        }
        let triangle = side * side / 2.0;
        let mut all: Vec<SurfaceComponent> = found
            .into_iter()
            .map(|(root, (area, ends))| SurfaceComponent {
                sheets: area / triangle,
                holonomy: sets.holonomy(root),
                reach: ends[1] - ends[0],
            })
            .collect();
        all.sort_by(|a, b| b.sheets.total_cmp(&a.sheets));
        all
    }

    fn nodes(&self) -> usize {
        self.stretches.first().map_or(0, |stretch| stretch.nodes.len())
    }

    /// Both rectangles that meet in a corner are connected where the line of poses there has a part that is stable and far enough from
    /// parallel palms: along it `A/B` runs through an interval, and the poses are stable on one side of one ratio.
    fn join_at_corners(
        &self,
        margin: f64,
        sets: &mut TurnSets,
        poses: &[Option<Pose>],
        place: &impl Fn(usize, usize) -> usize,
    ) {
        let (count, stretches) = (self.nodes(), self.stretches.len());
        // nodes nearer to the corner than half of the logarithms
        let near = count / 4;
        for (p, [a, bend1]) in self.extrema.iter().enumerate() {
            for (q, [b, bend2]) in self.extrema.iter().enumerate() {
                let phi2 = (b - a - PI).rem_euclid(TAU);
                if phi2 < margin || phi2 > PI - 2.0 * margin {
                    continue;
                }
                let ratio = |phi1: f64| (phi1 + phi2).sin() / phi1.sin();
                let (most, least) = (ratio(margin), ratio(PI - phi2 - margin));
                if most * bend1 + bend2 <= 0.0 && least * bend1 + bend2 <= 0.0 {
                    continue;
                }
                let corner = sets.add();
                let before = |i: usize| (i + stretches - 1) % stretches;
                for (j, at_begin1) in [(p, true), (before(p), false)] {
                    for (k, at_begin2) in [(q, true), (before(q), false)] {
                        if self.stretches[j].rises == self.stretches[k].rises {
                            continue;
                        }
                        // behind the last extremum the angle has gone round once
                        let turns = i32::from(p == 0 && !at_begin1);
                        for i in 0..near {
                            for (x, y) in [(0, i), (i, 0)] {
                                let x = if at_begin1 { x } else { count - 1 - x };
                                let y = if at_begin2 { y } else { count - 1 - y };
                                let node = place(j, k) + x * count + y;
                                if poses[node].is_some() {
                                    sets.join(corner, node, turns);
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Where the inside and the outside boundary meet as both palms close, 3.47: places along `a`, `b = a + pi` at which `r'(a)` and `r'(b)`
/// have different signs and `r''(a)/|r'(a)| + r''(b)/|r'(b)|` vanishes, each at the ratio `c = phi1/phi2` that its `A/B` determines. For `A/B > 1` it is
/// the corner `phi1 = phi2 = 0`, and the same two normals with their palms exchanged are at the other corner; these are counted once.
pub fn closing_folds(body: &PoseBody) -> Vec<ClosingFold> {
    let at = |angle: f64| {
        let ([_, slope1, bend1], [_, slope2, bend2]) = (body.support(angle), body.support(angle + PI));
        (slope1, slope2, bend1 * slope2 - bend2 * slope1)
    };
    let step = TAU / SAMPLES as f64;
    let mut found = Vec::new();
    for i in 0..SAMPLES {
        let (low, high) = (step * i as f64, step * (i + 1) as f64);
        // with different signs of r' the sum over |r'| vanishes with this cross product
        if (at(low).2 > 0.0) == (at(high).2 > 0.0) {
            continue;
        }
        let angle = super::zeros::bisect(|x| at(x).2, low, high);
        let (slope1, slope2, _) = at(angle);
        let ratio = -slope2 / slope1;
        if ratio > 1.0 && ratio.is_finite() {
            found.push(ClosingFold { angle: angle.rem_euclid(TAU), ratio: 1.0 / (ratio - 1.0) });
        }
    }
    found
}

/// A solution of 3.47 with 3.42.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosingFold {
    /// The normal at palm 1, in the body's frame, rad.
    pub angle: f64,
    /// `c = phi1/phi2` as both close.
    pub ratio: f64,
}

/// A pair of palms close to the fold: where it is when their angle is `phi2`.
impl ClosingFold {
    /// The palms at a small `phi2`.
    pub fn palms(&self, phi2: f64) -> PalmPair {
        PalmPair::new(self.ratio * phi2, phi2)
    }
}
