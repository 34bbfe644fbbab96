//! Everything that was found of a paper.

use super::folder::Paper;
use super::left_out::LeftOut;
use super::reduction::ReductionFound;
use super::views::{LineFound, MapFound, SetRank};
use crate::tradeoff::stress::StressStudy;
use crate::tradeoff::{Growth, PrintedExpression, RouteAgreement, Trade, WaysAgreement};
use palmistry_lang::System;
use palmistry_prove::certificate::RegionAnswer;
use palmistry_prove::claim::Outcome;
use palmistry_prove::drops::DropAnswer;
use palmistry_rank::observability::Observability;
use palmistry_scenes::joint::{JointAnswer, JointExperiments};
use palmistry_scenes::slow::{SlowAnswers, SlowExperiment};
use palmistry_scenes::space::{SpaceAnswers, SpaceExperiment};
use palmistry_scenes::{Answer, Experiment};

/// Lie derivatives of one output along one field, to high orders.
pub struct DerivativesFound {
    /// The field along which is differentiated.
    pub field: String,
    /// The output that is differentiated.
    pub output: String,
    /// Two routes to each, order by order.
    pub routes: Vec<RouteAgreement>,
    /// The size of the graph, order by order.
    pub growth: Vec<Growth>,
}

/// What was found of one proof file.
pub struct FileFindings {
    /// The file as it was read; its name is relative to the paper's folder.
    pub system: System,
    /// The claims, in the order of the file.
    pub outcomes: Vec<Outcome>,
    /// The whole box first, then each named set.
    pub ranks: Vec<SetRank>,
    /// Where the rank drops, for a file that claims a rank at all states.
    pub drops: Option<DropAnswer>,
    /// The maps that the file asks for.
    pub maps: Vec<MapFound>,
    /// The lines that it asks for.
    pub lines: Vec<LineFound>,
    /// Numbers in print, by formula.
    pub printed: Vec<PrintedExpression>,
    /// The reductions to other systems.
    pub reductions: Vec<ReductionFound>,
    /// How fast Lie derivatives grow, for the file that was chosen.
    pub derivatives: Option<DerivativesFound>,
    /// Agreement of three ways of automatic differentiation for all Lie derivatives of the codistribution, for a file that names sets, maps or lines.
    pub ways: Option<WaysAgreement>,
    /// Speed against accuracy, the short version.
    pub trade: Option<Trade>,
    /// The extremes, the short version.
    pub stress: Option<StressStudy>,
    /// The certificate on the sample box, after a few thousand sub-boxes.
    pub certificate: Option<RegionAnswer>,
    /// What was left out, and why.
    pub left_out: Vec<LeftOut>,
    /// What was not done or done in part because the system has many unknowns, and the command that does it.
    pub too_large: Vec<LeftOut>,
}

impl FileFindings {
    /// The unknowns that are generically observable or identifiable, as far as that is known.
    pub(super) fn observable(&self) -> Option<Vec<String>> {
        let answer = self.ranks.first()?.answer().ok()?;
        let branch = answer.branches.first()?;
        let found = branch.unknowns.iter().zip(&branch.generic.unknowns);
        Some(
            found
                .filter(|(_, (_, seen))| *seen == Observability::Yes)
                .map(|((name, _), _)| name.clone())
                .collect(),
        )
    }

    /// Nothing found yet.
    pub fn begun(system: System) -> FileFindings {
        FileFindings {
            system,
            outcomes: Vec::new(),
            ranks: Vec::new(),
            drops: None,
            maps: Vec::new(),
            lines: Vec::new(),
            printed: Vec::new(),
            reductions: Vec::new(),
            derivatives: None,
            ways: None,
            trade: None,
            stress: None,
            certificate: None,
            left_out: Vec::new(),
            too_large: Vec::new(),
        }
    }

    /// Whether everything is as the file expects.
    pub fn ok(&self) -> bool {
        self.outcomes.iter().all(|outcome| outcome.ok) && self.others_not_as_expected() == 0
    }

    /// How many results besides the claims are not as expected: ranks on sets, reductions, Lie derivatives by two routes, and what was left out.
    pub fn others_not_as_expected(&self) -> usize {
        self.ranks.iter().filter(|rank| !rank.as_expected()).count()
            + self.reductions.iter().filter(|found| !found.proved()).count()
            + usize::from(self.ways.as_ref().is_some_and(|ways| !ways.agree()))
            + self.left_out.len()
    }
}

/// Everything that was found.
pub struct Findings {
    /// The folder.
    pub paper: Paper,
    /// In the order of the paper.
    pub files: Vec<FileFindings>,
    /// Bodies in motion, and the estimates of the observers.
    pub experiments: Vec<(Experiment, Vec<Answer>)>,
    /// Bodies at rest between slow palms, and the answers from their measurements.
    pub slow: Vec<(SlowExperiment, SlowAnswers)>,
    /// Bodies in space on three palms, and the answers from their measurements.
    pub space: Vec<(SpaceExperiment, SpaceAnswers)>,
    /// Several experiments with one set of parameters, and the answer from all of them together.
    pub joint: Vec<(JointExperiments, JointAnswer)>,
    /// The seed of all that is drawn.
    pub seed: u64,
    /// Whether it was stopped before the end.
    pub interrupted: bool,
    /// How long it took, in s; NaN where no times are kept.
    pub seconds: f64,
}

impl Findings {
    /// Nothing found yet.
    pub fn begun(seed: u64) -> Findings {
        Findings {
            paper: Paper::default(),
            files: Vec::new(),
            experiments: Vec::new(),
            slow: Vec::new(),
            space: Vec::new(),
            joint: Vec::new(),
            seed,
            interrupted: false,
            seconds: 0.0,
        }
    }

    /// The claims of all files, in order.
    pub fn outcomes(&self) -> impl Iterator<Item = &Outcome> {
        self.files.iter().flat_map(|file| &file.outcomes)
    }

    /// Whether everything is as the files expect.
    pub fn ok(&self) -> bool {
        !self.interrupted && self.outcomes().all(|outcome| outcome.ok) && self.others_not_as_expected() == 0
    }

    /// How many results besides the claims are not as expected, the answers from measurements among them.
    pub fn others_not_as_expected(&self) -> usize {
        self.files.iter().map(FileFindings::others_not_as_expected).sum::<usize>()
            + self.slow.iter().filter(|(_, answers)| !answers.explained).count()
            + self.space.iter().filter(|(_, answers)| !answers.as_expected()).count()
            + self.joint.iter().filter(|(_, answer)| !answer.as_expected()).count()
    }
}
