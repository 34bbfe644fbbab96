//! All that is asked of one body at once.

use super::body::PoseBody;
use super::certify::{SurfaceCertificate, certify_surface};
use super::contact_chart::{ClosingFold, ContactChart, SurfaceComponent, closing_folds};
use super::plan::{NoPlan, PlanGoal, PosePlan, finer_pose_plan};
use super::potential::PalmPair;
use super::sheets::{PoseGrid, PoseLimits};
use super::slide::{Slide, plan_of_figure_3_14, slide};
use super::stable::{StablePose, level_poses, stable_poses};
use std::sync::atomic::AtomicBool;

/// Nodes between two extrema of the support function, of the chart for the components.
pub const CHART_NODES: usize = 240;

/// What is asked of a body.
#[derive(Clone, Copy)]
pub struct PoseQuestion<'a> {
    /// Palm angles at which all stable poses are listed.
    pub palms: PalmPair,
    /// What plans keep.
    pub limits: PoseLimits,
    /// Margins at which components are computed, rad.
    pub margins: &'a [f64],
    /// From which orientation to which one the body is to be turned, rad.
    pub turn: Option<[f64; 2]>,
    /// How often squares of the certificate are halved.
    pub levels: u32,
    /// Nodes along a side of the grid of plans and pictures; plans are looked for on finer ones where it has none.
    pub side: usize,
    /// Stops the survey when it is set.
    pub interrupt: &'a AtomicBool,
}

/// What is found of a body.
#[derive(Clone, Debug)]
pub struct PoseSurvey {
    /// The body.
    pub body: PoseBody,
    /// Where it lies on a level table.
    pub level: Vec<StablePose>,
    /// The palm angles that were asked for, and where it lies between them.
    pub palms: (PalmPair, Vec<StablePose>),
    /// Where inside and outside boundary meet, 3.47.
    pub closing_folds: Vec<ClosingFold>,
    /// Components at each margin.
    pub components: Vec<(f64, Vec<SurfaceComponent>)>,
    /// What is certain at the margin of the limits; `None` for a body whose support function is not enclosed.
    pub certificate: Option<SurfaceCertificate>,
    /// The limits of plans.
    pub limits: PoseLimits,
    /// The surface over a grid of palm angles.
    pub grid: PoseGrid,
    /// A plan that touches all normals.
    pub touch_all: Result<PosePlan, NoPlan>,
    /// A plan between two orientations, where one is asked for.
    pub turn: Option<([f64; 2], Result<PosePlan, NoPlan>)>,
    /// Two rounds of plan 3.14 at the same margin, from the lowest pose.
    pub figure_3_14: Slide,
}

/// Looks at a body.
pub fn survey_poses(body: PoseBody, question: &PoseQuestion<'_>) -> PoseSurvey {
    let limits = question.limits;
    let chart = ContactChart::new(&body, CHART_NODES);
    let grid = PoseGrid::new(&body, &limits, question.side);
    let path = plan_of_figure_3_14(limits.margin, 2);
    let lowest = stable_poses(&body, path[0]).into_iter().min_by(|a, b| a.height.total_cmp(&b.height));
    let turn = question
        .turn
        .map(|[from, to]| ([from, to], finer_pose_plan(&body, &grid, &limits, PlanGoal::Turn { from, to })));
    PoseSurvey {
        level: level_poses(&body),
        palms: (question.palms, stable_poses(&body, question.palms)),
        closing_folds: closing_folds(&body),
        components: question.margins.iter().map(|margin| (*margin, chart.components(*margin))).collect(),
        certificate: certify_surface(&body, limits.margin, question.levels, question.interrupt),
        touch_all: finer_pose_plan(&body, &grid, &limits, PlanGoal::TouchAll),
        turn,
        figure_3_14: lowest.map_or_else(Slide::default, |start| slide(&body, &path, start.phi0)),
        limits,
        grid,
        body,
    }
}
