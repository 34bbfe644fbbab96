//! The planar regimes of chapter 4: which states each needs, where it is singular, and what to draw of it.

use super::Options;
use crate::expression::NodeId;
use crate::observability::{Branch, Codistribution, Length, Locus, OWN_ROWS, solve_conditions};
use crate::sweep::{Certainty, RankAnswer, RankQuestion, answer_rank};
use crate::system::{Assignment, System, Value};
use crate::tradeoff::{Landscape, Map, ModelComparison, Rows, Slope, Target, compare_models};
use std::collections::BTreeMap;

/// A set of states or parameters that deserves a look of its own.
pub struct SingularSet {
    pub title: &'static str,
    /// Conditions in the language.
    pub conditions: &'static [&'static str],
    /// Whether the field itself is infinite there, so that there is no rank to decide.
    pub is_pole: bool,
}

/// A map, and lines into singularities.
pub struct Picture {
    /// The values of what does not move.
    pub at: &'static [(&'static str, f64)],
    pub x: (&'static str, f64, f64),
    pub y: (&'static str, f64, f64),
    /// The length of the words of the full codistribution that is drawn.
    pub order: usize,
    /// What is seen on the map.
    pub caption: &'static str,
    /// Title, the coordinate that moves, and where it goes.
    pub lines: &'static [(&'static str, &'static str, Target<'static>)],
}

/// A regime as the main job walks it.
pub struct Regime {
    pub file: &'static str,
    /// The conditions under which the general regime becomes this one; none for the general regime itself.
    pub reduces_by: &'static [&'static str],
    /// What is left out of the ten states, in words.
    pub left_out: &'static str,
    pub sets: &'static [SingularSet],
    pub picture: Picture,
}

/// The rank on a set, or the divisor that is zero at all its states.
pub type RankFound = Result<RankAnswer, String>;

/// What was found of a regime.
pub struct RegimeResult {
    pub regime: &'static Regime,
    pub title: String,
    /// The whole box first, then each singular set that has states.
    pub ranks: Vec<(&'static SingularSet, RankFound)>,
    /// The smallest singular value, of the thesis's own rows and of the full codistribution.
    pub maps: Vec<(Rows, Map)>,
    /// The singular values of the thesis's own rows.
    pub lines: Vec<(&'static str, Slope)>,
    pub comparison: Option<ModelComparison>,
}

impl RegimeResult {
    /// Poles where poles are expected; elsewhere every rank certified, and full on the whole box.
    pub fn as_expected(&self) -> bool {
        self.ranks.iter().all(|(set, found)| match found {
            Err(why) => set.is_pole && why.starts_with("every state there is a pole"),
            Ok(_) if set.is_pole => false,
            Ok(answer) => answer.branches.iter().all(|branch| {
                let full = branch.full.rank_histogram.keys().all(|rank| *rank == answer.dimension);
                branch.full.certified == branch.full.samples && (full || !set.conditions.is_empty())
            }),
        })
    }
}

const SAMPLES: u64 = 20_000;
const SAMPLES_ON_A_SET: u64 = 200;
const MAP: (usize, usize) = (120, 80);
const POINTS_ON_A_LINE: usize = 65;
/// Lines end this far from the singularity.
const LEAST_DISTANCE: f64 = 1e-14;
const STATES_TO_TIME: u64 = 400;

macro_rules! sets {
    ($($title:literal: $($condition:literal),+;)* poles: $($pole:literal: $at:literal;)*) => {
        &[
            $(SingularSet { title: $title, conditions: &[$($condition),+], is_pole: false },)*
            $(SingularSet { title: $pole, conditions: &[$at], is_pole: true },)*
        ]
    };
}

static WHOLE_BOX: SingularSet =
    SingularSet { title: "the whole sample box", conditions: &[], is_pole: false };

/// The four regimes; the general one first.
pub const REGIMES: [Regime; 4] = [
    Regime {
        file: "general.proof",
        reduces_by: &[],
        left_out: "nothing: ten states, the palms' accelerations as parameters",
        sets: sets! {
            "no gravity": "g = 0";
            "the object does not turn": "omega0 = 0";
            "palm 1 at rest": "omega1 = 0";
            "the palms at one rate": "omega2 = 0";
            "the object turns against palm 1": "omega0 = -omega1";
            "palm 1 level": "sin(phi1) = 0";
            "palm 2 level": "sin(phi1 + phi2) = 0";
            "contact 1 under the centre of mass": "d1 = 0";
            "contact 2 under the centre of mass": "d2 = 0";
            "both contacts under the centre of mass": "d1 = 0", "d2 = 0";
            "the appendix's determinant vanishes": "det_A_factor = 0";
            poles:
            "palm 1 and the object at one rate": "omega0 = omega1";
            "palm 2 and the object at one rate": "omega0 = omega1 + omega2";
            "the palms in line": "sin(phi2) = 0";
            "the radius of gyration zero": "rho = 0";
            "contact 1 at the joint": "s1 = 0";
        },
        picture: Picture {
            at: &[
                ("omega0", 1.0),
                ("s1", 1.0),
                ("s2", 2.0),
                ("phi1", 0.5),
                ("omega1", 2.0),
                ("phi2", 2.0),
                ("omega2", 1.5),
                ("rho", 0.5),
                ("r1", 1.5),
                ("r2", 1.5),
                ("m", 1.0),
            ],
            x: ("r1", 0.2, 3.0),
            y: ("r2", 0.2, 3.0),
            order: 1,
            caption: "The valley in the left map is where the appendix's determinant vanishes; the full \
                      codistribution, which has the drift's Lie derivatives too, does not see it.",
            lines: &[
                ("palm 1 and the object at one rate", "omega0", Target::Value(2.0)),
                ("palm 2 and the object at one rate", "omega0", Target::Value(3.5)),
                ("the radius of gyration to zero", "rho", Target::Value(0.0)),
                ("contact 1 to the joint", "s1", Target::Value(0.0)),
                ("the palms folded together", "phi2", Target::Value(0.0)),
                ("the palms in line", "phi2", Target::Value(std::f64::consts::PI)),
                ("the appendix's determinant to zero", "omega2", Target::Zero("det_A_factor")),
            ],
        },
    },
    Regime {
        file: "same_rate.proof",
        reduces_by: &["omega2 = 0", "alpha1 = 0", "alpha2 = 0"],
        left_out: "omega1, phi2 and omega2 (= 0) are known constants; rho does not enter the drift",
        sets: sets! {
            "no gravity": "g = 0";
            "the object does not turn": "omega0 = 0";
            "the palms at rest": "omega1 = 0";
            "the object turns against the palms": "omega0 = -omega1";
            "palm 1 level": "sin(phi1) = 0";
            "palm 2 level": "sin(phi1 + phi2) = 0";
            "contact 1 under the centre of mass": "d1 = 0";
            "contact 2 under the centre of mass": "d2 = 0";
            poles:
            "the palms and the object at one rate": "omega0 = omega1";
            "the palms in line": "sin(phi2) = 0";
        },
        picture: Picture {
            at: &[("r1", 1.5), ("r2", 1.5), ("s1", 1.0), ("s2", 2.0), ("omega0", 1.0), ("phi1", 0.5)],
            x: ("omega0", -3.0, 3.0),
            y: ("phi1", -1.5, 1.5),
            order: 2,
            caption: "Valleys at omega0 = 0 and, for the thesis's own rows only, at phi1 = 0; the pole is at \
                      omega0 = omega1 = 2.",
            lines: &[
                ("the object does not turn", "omega0", Target::Value(0.0)),
                ("the palms and the object at one rate", "omega0", Target::Value(2.0)),
                ("the palms at rest", "omega1", Target::Value(0.0)),
                ("palm 1 level", "phi1", Target::Value(0.0)),
                ("no gravity", "g", Target::Value(0.0)),
                ("the palms folded together", "phi2", Target::Value(0.0)),
                ("the palms in line", "phi2", Target::Value(std::f64::consts::PI)),
            ],
        },
    },
    Regime {
        file: "one_palm_fixed.proof",
        reduces_by: &["omega1 = 0", "alpha1 = 0", "alpha2 = 0"],
        left_out: "phi1, omega1 (= 0) and omega2 are known constants; rho does not enter the drift",
        sets: sets! {
            "no gravity": "g = 0";
            "palm 2 at rest": "omega2 = 0";
            "the object turns against palm 2": "omega0 = -omega2";
            "palm 1 level": "sin(phi1) = 0";
            "palm 2 level": "sin(phi1 + phi2) = 0";
            "contact 1 under the centre of mass": "d1 = 0";
            "contact 2 under the centre of mass": "d2 = 0";
            "the bracket of 4.65 vanishes": "bracket = 0";
            poles:
            "the object does not turn": "omega0 = 0";
            "palm 2 and the object at one rate": "omega0 = omega2";
            "the palms in line": "sin(phi2) = 0";
        },
        picture: Picture {
            at: &[
                ("r1", 1.5),
                ("r2", 1.5),
                ("s1", 1.0),
                ("s2", 2.0),
                ("omega0", 1.0),
                ("phi2", 2.0),
                ("omega2", 2.0),
            ],
            x: ("omega0", -1.0, 4.0),
            y: ("r1", 0.2, 6.0),
            order: 3,
            caption: "The curved valley is where the bracket of 4.65 vanishes; words of three fields see through it. \
                      The straight lines are the poles at omega0 = 0 and omega0 = omega2 = 2.",
            lines: &[
                ("the object does not turn", "omega0", Target::Value(0.0)),
                ("palm 2 and the object at one rate", "omega0", Target::Value(2.0)),
                ("palm 2 at rest", "omega2", Target::Value(0.0)),
                ("the bracket of 4.65 to zero", "s1", Target::Zero("bracket")),
                ("the palms folded together", "phi2", Target::Value(0.0)),
                ("the palms in line", "phi2", Target::Value(std::f64::consts::PI)),
            ],
        },
    },
    Regime {
        file: "fixed_palms.proof",
        reduces_by: &["omega1 = 0", "omega2 = 0", "alpha1 = 0", "alpha2 = 0"],
        left_out: "phi1, phi2 and the rates (= 0) are known constants; rho is taken as recovered before",
        sets: sets! {
            "no gravity": "g = 0";
            "palm 1 level": "sin(phi1) = 0";
            "palm 2 level": "sin(phi1 + phi2) = 0";
            "contact 1 under the centre of mass": "d1 = 0";
            "contact 2 under the centre of mass": "d2 = 0";
            "the determinant of the thesis's rows vanishes": "bracket_1 = 0";
            poles:
            "the object does not turn": "omega0 = 0";
            "the palms in line": "sin(phi2) = 0";
            "contact 1 at the joint": "s1 = 0";
        },
        picture: Picture {
            at: &[("r1", 1.5), ("r2", 1.5), ("omega0", 1.0), ("s1", 1.0), ("s2", 2.0)],
            x: ("omega0", -3.0, 3.0),
            y: ("r1", 0.2, 3.0),
            order: 1,
            caption: "The valleys of the thesis's own rows are where rho^2 + 3 d1^2 = 2 g d1 sin(phi1)/omega0^2; the \
                      second input field sees through them. The pole is at omega0 = 0.",
            lines: &[
                ("the object does not turn", "omega0", Target::Value(0.0)),
                ("the determinant of the thesis's rows to zero", "g", Target::Zero("bracket_1")),
                ("contact 1 to the joint", "s1", Target::Value(0.0)),
                ("the palms folded together", "phi2", Target::Value(0.0)),
                ("the palms in line", "phi2", Target::Value(std::f64::consts::PI)),
            ],
        },
    },
];

impl Regime {
    /// The number of steps that [`Regime::examine`] announces.
    pub(super) fn steps(&self) -> u64 {
        1 + self.sets.len() as u64 + 1
    }

    pub(super) fn examine(
        &'static self,
        system: &System,
        general: &System,
        options: &Options<'_>,
        step: &dyn Fn(&str),
    ) -> Result<RegimeResult, String> {
        let mut ranks = Vec::new();
        for set in std::iter::once(&WHOLE_BOX).chain(self.sets) {
            if options.interrupt.load(std::sync::atomic::Ordering::Relaxed) {
                break;
            }
            let question = RankQuestion {
                samples: if set.conditions.is_empty() { SAMPLES } else { SAMPLES_ON_A_SET },
                seed: options.seed,
                wanted: Certainty::Certified,
                digits: None,
                order: None,
                fixed: BTreeMap::new(),
                conditions: set.conditions.iter().map(|c| (*c).to_owned()).collect(),
                recorded: 0,
                interrupt: options.interrupt,
                progress: &|_| (),
            };
            let answer = answer_rank(&mut system.clone(), &question);
            ranks.push((set, answer));
            step(set.title);
        }
        let (maps, lines) = self.draw(system)?;
        let comparison = match self.reduces_by {
            [] => None,
            conditions => Some(self.compare(system, general, conditions, options.seed)?),
        };
        step("pictures");
        Ok(RegimeResult { regime: self, title: system.title.clone(), ranks, maps, lines, comparison })
    }

    #[allow(clippy::type_complexity)] // two lists of pictures, named in `RegimeResult`
    fn draw(&self, system: &System) -> Result<(Vec<(Rows, Map)>, Vec<(&'static str, Slope)>), String> {
        let mut system = system.clone();
        let own = own_rows(&system)?;
        let picture = &self.picture;
        let length = Length::Exactly(picture.order);
        let full = Codistribution::new(&mut system, &Assignment::new(), length)?.entries();
        let mut maps = Vec::new();
        for (kind, rows) in [(Rows::Own, &own), (Rows::Full, &full)] {
            let mut copy = system.clone();
            let landscape = Landscape::new(&mut copy, rows, picture.at)?;
            maps.push((kind, landscape.map(picture.x, picture.y, MAP.0, MAP.1)?));
        }
        let mut lines = Vec::new();
        for (title, moving, target) in picture.lines {
            let mut landscape = Landscape::new(&mut system, &own, picture.at)?;
            lines.push((*title, landscape.line(moving, *target, LEAST_DISTANCE, POINTS_ON_A_LINE)?));
        }
        Ok((maps, lines))
    }

    /// The same rows, once with this regime's states and once with all ten.
    fn compare(
        &self,
        system: &System,
        general: &System,
        conditions: &[&str],
        seed: u64,
    ) -> Result<ModelComparison, String> {
        let (mut small, mut large) = (system.clone(), general.clone());
        let equations: Vec<Vec<_>> = conditions
            .iter()
            .map(|text| crate::observability::parse_condition(text))
            .collect::<Result<_, _>>()?;
        let equations = equations.concat();
        let branch: Branch = solve_conditions(&mut large, &equations).map_err(|e| e.to_string())?.remove(0);
        let (own, rows) = counterparts(&mut small, &mut large)?;
        let locus = Locus::new(&mut large, &branch, &BTreeMap::new(), &rows).map_err(|e| e.to_string())?;
        compare_models((&mut small, &own), (&mut large, &rows, &locus), STATES_TO_TIME, seed)
    }
}

fn own_rows(system: &System) -> Result<Vec<NodeId>, String> {
    match system.definition(OWN_ROWS) {
        Some(Value::Matrix(matrix)) => Ok(matrix.entries.clone()),
        _ => Err(format!("{} does not define '{OWN_ROWS}'", system.name)),
    }
}

/// The rows that the small regime's codistribution needs, and in the ten-state model the differentials of all outputs
/// and of the same Lie derivatives.
fn counterparts(small: &mut System, large: &mut System) -> Result<(Vec<NodeId>, Vec<NodeId>), String> {
    let words = Codistribution::new(small, &Assignment::new(), Length::UntilItStops)?;
    let mut rows: Vec<NodeId> = Vec::new();
    for output in large.outputs.clone() {
        rows.extend(large.differential(output.1));
    }
    for index in &words.needed {
        let word = &words.words[*index];
        if word.fields.is_empty() {
            continue;
        }
        let output = &small.outputs[word.output].0;
        let place = large.outputs.iter().position(|(name, _)| name == output);
        let mut value = large.outputs[place.ok_or_else(|| format!("no output {output}"))?].1;
        for field in word.fields.iter().rev() {
            let name = &small.fields[*field].name;
            let place = large.fields.iter().position(|field| field.name == *name);
            value = large.lie_derivative(place.ok_or_else(|| format!("no field {name}"))?, value);
        }
        rows.extend(large.differential(value));
    }
    Ok((words.needed_entries(), rows))
}
