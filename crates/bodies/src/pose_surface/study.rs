//! The conjecture of section 3.6 on many bodies: evidence, and no proof.

use super::body::PoseBody;
use super::contact_chart::{ContactChart, SurfaceComponent, closing_folds};
use super::families::BodyFamily;
use super::plan::{NoPlan, PlanGoal, finer_pose_plan};
use super::potential::measurements;
use super::sheets::{PoseGrid, PoseLimits};
use super::slide::{Slide, plan_of_figure_3_14, slide};
use super::stable::{level_poses, stable_poses};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

/// The question of a study of the conjecture.
#[derive(Clone, Copy)]
pub struct ConjectureQuestion<'a> {
    /// The seed of random bodies.
    pub seed: u64,
    /// How many of each family.
    pub bodies: u64,
    /// Margins from parallel palms, rad.
    pub margins: &'a [f64],
    /// Nodes between two extrema of the support function; the answer counts where twice as many agree.
    pub nodes: usize,
    /// Also plans that touch all normals, on a grid with so many nodes along a side, or on finer ones where it has none.
    pub plans: Option<(PoseLimits, usize)>,
    /// Stops the study when it is set.
    pub interrupt: &'a AtomicBool,
    /// Called with each body as soon as it was examined, in any order: a run that is cut off has these.
    pub found: &'a (dyn Fn(&ConjectureFinding) + Sync),
}

/// What is found of one body at one margin.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginFinding {
    /// Some component reaches all orientations; `None` where two resolutions disagree.
    pub reaches_all: Option<bool>,
    /// The greatest part of a turn that a component reaches, at the finer resolution: 1 where it reaches all.
    pub reach: f64,
    /// How many components have more than a thousandth of a sheet.
    pub components: usize,
    /// The holonomy of the component that reaches most.
    pub holonomy: u32,
    /// Sheets over all palm angles, that is the mean number of stable poses.
    pub sheets: f64,
    /// Jumps in two rounds of plan 3.14, from each of the stable poses at its start.
    pub jumps: Vec<usize>,
    /// Two rounds from the lowest pose turn the body by a whole turn without a jump: the surface is a spiral as in figure 3.13.
    pub is_spiral: bool,
}

/// What is found of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct ConjectureFinding {
    /// Its family.
    pub family: BodyFamily,
    /// Its number under the seed.
    pub number: u64,
    /// The body, as text.
    pub body: String,
    /// Its centre of mass in the frame of its form, m.
    pub centre: [f64; 2],
    /// Stable poses on a level table.
    pub level: usize,
    /// Solutions of 3.47.
    pub closing_folds: usize,
    /// At each margin.
    pub margins: Vec<MarginFinding>,
    /// Where plans are asked for.
    pub plan: Option<PlanFinding>,
}

/// A plan that touches all normals, beside plan 3.14.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanFinding {
    /// Its length in rad, or why there is none.
    pub length: Result<f64, NoPlan>,
    /// The farthest place on a palm that it needs, in mean radii.
    pub measurement: Option<f64>,
    /// The part of all normals that one and two rounds of plan 3.14 touch, from the lowest pose at their start, and the jumps on the way.
    pub rounds: [(f64, usize); 2],
    /// The farthest place on a palm that a round needs, in mean radii.
    pub round_measurement: f64,
}

fn farthest_measurement(body: &PoseBody, run: &Slide) -> f64 {
    let most =
        run.poses.iter().flat_map(|(palms, phi0)| measurements(body, *palms, *phi0)).fold(0.0, f64::max);
    most / body.mean_radius()
}

fn plan_finding(body: &PoseBody, limits: &PoseLimits, side: usize) -> PlanFinding {
    let grid = PoseGrid::new(body, limits, side);
    let plan = finer_pose_plan(body, &grid, limits, PlanGoal::TouchAll);
    let path = plan_of_figure_3_14(limits.margin, 1);
    let lowest = stable_poses(body, path[0]).into_iter().min_by(|a, b| a.height.total_cmp(&b.height));
    let round = |rounds: usize| {
        lowest.map_or_else(Slide::default, |start| {
            slide(body, &plan_of_figure_3_14(limits.margin, rounds), start.phi0)
        })
    };
    let runs = [round(1), round(2)];
    PlanFinding {
        measurement: plan.as_ref().ok().map(|plan| farthest_measurement(body, &plan.slide)),
        length: plan.map(|plan| plan.length),
        round_measurement: farthest_measurement(body, &runs[0]),
        rounds: runs.map(|run| (run.coverage(), run.jumps.len())),
    }
}

/// Components with less are not counted, in sheets.
const SPECK: f64 = 1e-3;

fn farthest(components: &[SurfaceComponent]) -> (f64, u32) {
    let reach = |one: &SurfaceComponent| if one.holonomy > 0 { 1.0 } else { (one.reach / TAU).min(1.0) };
    let most = components.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
    most.map_or((0.0, 0), |one| (reach(one), one.holonomy))
}

fn finding(family: BodyFamily, number: u64, question: &ConjectureQuestion<'_>) -> ConjectureFinding {
    let body = family.draw(question.seed, number);
    let charts = [1, 2].map(|finer| ContactChart::new(&body, finer * question.nodes));
    let at = |margin: &f64| {
        let [coarse, fine] = [0, 1].map(|i: usize| charts[i].components(*margin));
        let agree = [&coarse, &fine].map(|found| found.iter().any(SurfaceComponent::reaches_all));
        let (reach, holonomy) = farthest(&fine);
        let counted = fine;
        let path = plan_of_figure_3_14(*margin, 2);
        let starts = stable_poses(&body, path[0]);
        let slides: Vec<_> =
            starts.iter().map(|start| (start.height, slide(&body, &path, start.phi0))).collect();
        let lowest = slides.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let (coarse, fine) = (agree[0], agree[1]);
        let is_whole = |turned: f64| (turned.abs() - TAU).abs() < 1e-6;
        let is_spiral = lowest.is_some_and(|(_, slide)| slide.jumps.is_empty() && is_whole(slide.turned()));
        MarginFinding {
            // a body that was led round is a witness, however narrow its way
            reaches_all: (coarse == fine || is_spiral).then_some(fine || is_spiral),
            reach,
            components: counted.iter().filter(|one| one.sheets > SPECK).count(),
            holonomy,
            sheets: counted.iter().map(|one| one.sheets).sum(),
            jumps: slides.iter().map(|(_, slide)| slide.jumps.len()).collect(),
            is_spiral,
        }
    };
    ConjectureFinding {
        family,
        number,
        level: level_poses(&body).len(),
        closing_folds: closing_folds(&body).len(),
        margins: question.margins.iter().map(at).collect(),
        centre: body.centre(),
        plan: question.plans.as_ref().map(|(limits, side)| plan_finding(&body, limits, *side)),
        body: body.text(),
    }
}

/// Looks at the bodies of all families that are asked for. The order of the findings, and all that they say, does not depend on the number of threads; where
/// it is interrupted, what was not looked at is missing.
pub fn conjecture(families: &[BodyFamily], question: &ConjectureQuestion<'_>) -> Vec<ConjectureFinding> {
    let all: Vec<(BodyFamily, u64)> = families
        .iter()
        .flat_map(|family| (0..question.bodies).map(move |number| (*family, number)))
        .collect();
    let one = |(family, number): &(BodyFamily, u64)| {
        if question.interrupt.load(Ordering::Relaxed) {
            return None;
        }
        let found = finding(*family, *number, question);
        (question.found)(&found);
        Some(found)
    };
    let found: Vec<Option<ConjectureFinding>> = all.par_iter().map(one).collect();
    found.into_iter().flatten().collect()
}
