//! `palmistry poses`: the surface of stable poses of a body between slow palms.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, nothing_found, watched};
use super::output::{Files, Form, progress, read_scene};
use super::{Status, Unusable};
use clap::{Args, ValueEnum};
use palmistry::pose_surface::{
    BodyFamily, ConjectureFinding, ConjectureQuestion, PalmPair, PoseBody, PoseLimits, PoseQuestion,
    conjecture, numbers, survey_poses,
};
use palmistry::report::{conjecture_json, conjecture_text, poses_json, poses_page, poses_text};
use palmistry::system::Code;
use serde_json::json;
use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// The stable poses of a body between two slow palms, how they are connected, and palm motions that turn the body or touch all of it.
///
/// Without friction a body that two flat palms hold rests where its centre of mass is lowest. Over the palms' angles its stable poses form
/// a surface. At its folds the body jumps; along the surface the palms can move it without a jump. For the body of a SCENE or a --shape it gives: the stable poses on a level table and
/// between --palms with the share of orientations that end in each; the components of the surface at several margins from parallel palms, and
/// whether a cycle of palm angles turns the body; what interval arithmetic proves of that; where its boundaries meet as the palms close; a
/// shortest plan that touches every normal, beside the plan of figure 3.14, and with --turn one from an orientation to another.
///
/// With --bodies N the conjecture that all orientations can be reached is tested on N random bodies of each family.
/// That is evidence; only the certificate of a single body is a proof. The same seed gives the same bodies and the same answer with any
/// number of threads.
#[derive(Args, Clone)]
#[command(after_help = "Examples:
  palmistry poses --shape spline:1.2,1.7,1.3 --out poses
  palmistry poses --shape ellipse:0.02,0.015 --centre 0.002,0 --pad 0,0.0555 --margin 0.3
  palmistry poses --bodies 10 --family harmonics --seed 2")]
pub(crate) struct Poses {
    /// A scene whose body is taken.
    #[arg(conflicts_with_all = ["shape", "bodies"])]
    pub(super) scene: Option<PathBuf>,
    /// A body: spline:Q1,Q2,Q3 (radii of section 3.4), centripetal:Q1,Q2,Q3, ellipse:A,B, or harmonics:MEAN,P2,Q2,P3,Q3... of the support function, in m.
    #[arg(long, value_name = "BODY", conflicts_with = "bodies")]
    shape: Option<String>,
    /// The centre of mass of --shape in its own frame, in m; that of a uniform body unless given.
    #[arg(long, value_name = "X,Y", requires = "shape", allow_hyphen_values = true)]
    centre: Option<String>,
    /// Palm angles phi1 and phi2 (rad) at which all stable poses are listed.
    #[arg(long, value_name = "PHI1,PHI2", default_value = "0.6,1.6")]
    palms: String,
    /// How far palms keep from being parallel to each other or to the ground, rad: for plans and certificates.
    #[arg(long, value_name = "RAD", default_value_t = 0.15)]
    margin: f64,
    /// Margins at which components are reported, rad.
    #[arg(long, value_name = "RAD,...", default_value = "0.004,0.05,0.15,0.3")]
    margins: String,
    /// Plan from one orientation to another, rad.
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true)]
    turn: Option<String>,
    /// Both contacts stay in this part of their palms, in m from where the palms meet.
    #[arg(long, value_name = "NEAR,FAR", allow_hyphen_values = true)]
    pad: Option<String>,
    /// Poses of a plan stay stable if either palm is off by this angle, rad.
    #[arg(long, value_name = "RAD", default_value_t = 0.0)]
    tolerance: f64,
    /// Nodes along a side of the grid of palm angles for plans and pictures; two and four times as many are tried where it has no plan, up to 200.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(4..=200))]
    grid: u64,
    /// How often the certificate halves its squares.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=7))]
    levels: u32,
    /// Test the conjecture on this many random bodies of each family.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    bodies: Option<u64>,
    /// Only this family of random bodies; may be given again.
    #[arg(long, value_enum, value_name = "NAME", requires = "bodies")]
    family: Vec<Family>,
    /// With --bodies: plans that touch every normal, too.
    #[arg(long, requires = "bodies")]
    plans: bool,
    /// Seed of the random bodies.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Write a page with pictures (index.html) and poses.json into this folder.
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Print one JSON object: for a body its 'components', 'certificate', 'touch_all' and more; for random bodies 'families'.
    #[arg(long)]
    pub json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Family {
    /// Splines of section 3.4, uniform knots
    Splines,
    /// The same with centripetal knots
    Centripetal,
    /// Support functions of the harmonics 2 to 6
    Harmonics,
    /// One of these with its mass off centre
    OffCentre,
}

/// Nodes between two extrema in the study; it takes twice as many for a second opinion.
const NODES: usize = 100;

fn list(option: &str, text: &str) -> miette::Result<Vec<f64>> {
    numbers(text).map_err(|why| {
        Unusable::report(Code::Option, format!("{option}: {why}"), "write numbers with commas between them")
    })
}

fn pair(option: &str, text: &str) -> miette::Result<[f64; 2]> {
    let found = list(option, text)?;
    let count = found.len();
    found.try_into().map_err(|_| {
        Unusable::report(Code::Option, format!("{option} takes two numbers, and {count} are given"), "")
    })
}

fn margin_in_range(option: &str, margin: f64) -> miette::Result<f64> {
    if margin > 0.0 && margin < PI / 3.0 - 0.01 {
        return Ok(margin);
    }
    let help = "three times the margin has to be less than pi: take one between 0.001 and 1";
    Err(Unusable::report(
        Code::Option,
        format!("{option}: at a margin of {margin} rad there are no palm angles"),
        help,
    ))
}

impl Poses {
    pub fn run(self) -> miette::Result<Status> {
        let margins = list("--margins", &self.margins)?;
        margins.iter().try_for_each(|margin| margin_in_range("--margins", *margin).map(drop))?;
        let pad = self.pad.as_deref().map(|text| pair("--pad", text)).transpose()?;
        if !(0.0..1.0).contains(&self.tolerance) {
            return Err(Unusable::report(
                Code::Option,
                format!("--tolerance is {} rad; give 0 to 1", self.tolerance),
                "",
            ));
        }
        let limits =
            PoseLimits { margin: margin_in_range("--margin", self.margin)?, pad, tolerance: self.tolerance };
        match self.bodies {
            Some(bodies) => {
                let found: Arc<Mutex<Vec<ConjectureFinding>>> = Arc::default();
                let study = Study { asked: self, bodies, margins, limits };
                let (worker, filled) = (study.clone(), found.clone());
                let work = move || {
                    worker.work(&filled);
                    begin_to_tell();
                    worker.tell(&filled)
                };
                watched(work, || study.tell(&found))
            }
            None => {
                let form = Form::of(self.json);
                watched(move || self.one(&margins, limits), move || nothing_found(form))
            }
        }
    }

    fn body(&self) -> miette::Result<PoseBody> {
        if let Some(path) = &self.scene {
            let scene = read_scene(path)?;
            return Ok(scene.pose_body()?);
        }
        let Some(shape) = &self.shape else {
            let help = "name a scene, or a body as in --shape spline:1.2,1.7,1.3, or ask for random ones with --bodies 100";
            return Err(Unusable::report(Code::Option, "no body is given", help));
        };
        let centre = self.centre.as_deref().map(|text| pair("--centre", text)).transpose()?;
        PoseBody::parse(shape, centre).map_err(|why| {
            Unusable::report(
                Code::Option,
                format!("--shape {shape}: {why}"),
                "for example spline:1.2,1.7,1.3 or harmonics:1,0.1,0",
            )
        })
    }

    fn one(&self, margins: &[f64], limits: PoseLimits) -> miette::Result<Status> {
        let body = self.body()?;
        let [phi1, phi2] = pair("--palms", &self.palms)?;
        let palms = PalmPair::new(phi1, phi2);
        if palms.margin() <= 0.0 {
            let help = "both push where phi1 > 0, phi2 > 0 and phi1 + phi2 < pi";
            return Err(Unusable::report(
                Code::Option,
                format!("--palms {}: not both palms push there", self.palms),
                help,
            ));
        }
        let turn = self.turn.as_deref().map(|text| pair("--turn", text)).transpose()?;
        let question = PoseQuestion {
            palms,
            limits,
            margins,
            turn,
            levels: self.levels,
            side: self.grid as usize,
            interrupt: &INTERRUPTED,
        };
        let survey = survey_poses(body, &question);
        begin_to_tell();
        let mut object = poses_json(&survey);
        object["interrupted"] = json!(interrupted());
        let mut files = Files::default();
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &poses_page(&survey));
            files.json(&folder.join("poses.json"), &object);
            files.announce(&folder.join("index.html"));
        }
        files.print(Form::of(self.json), object, || poses_text(&survey), Status::of(true))
    }
}

/// Many random bodies. What was found of each is kept as soon as it is there: a body takes longer than an interrupt leaves.
#[derive(Clone)]
struct Study {
    asked: Poses,
    bodies: u64,
    margins: Vec<f64>,
    limits: PoseLimits,
}

impl Study {
    fn families(&self) -> Vec<BodyFamily> {
        let is_asked = |family: &BodyFamily| {
            let mut asked = self.asked.family.iter().map(|asked| BodyFamily::ALL[*asked as usize]);
            self.asked.family.is_empty() || asked.any(|asked| asked == *family)
        };
        BodyFamily::ALL.into_iter().filter(is_asked).collect()
    }

    fn question<'a>(&'a self, found: &'a (dyn Fn(&ConjectureFinding) + Sync)) -> ConjectureQuestion<'a> {
        ConjectureQuestion {
            seed: self.asked.seed,
            bodies: self.bodies,
            margins: &self.margins,
            nodes: NODES,
            plans: self.asked.plans.then_some((self.limits, self.asked.grid as usize)),
            interrupt: &INTERRUPTED,
            found,
        }
    }

    fn work(&self, found: &Mutex<Vec<ConjectureFinding>>) {
        let families = self.families();
        let bar = progress(self.bodies * families.len() as u64, "bodies");
        let keep = |one: &ConjectureFinding| {
            found.lock().unwrap_or_else(PoisonError::into_inner).push(one.clone());
            bar.inc(1);
        };
        let _ = conjecture(&families, &self.question(&keep));
        bar.finish_and_clear();
    }

    /// Prints and writes what was found, in the order of families and numbers.
    fn tell(&self, found: &Mutex<Vec<ConjectureFinding>>) -> miette::Result<Status> {
        let mut findings = found.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let form = Form::of(self.asked.json);
        if findings.is_empty() && interrupted() {
            return nothing_found(form);
        }
        let place = |family: BodyFamily| BodyFamily::ALL.iter().position(|one| *one == family);
        findings.sort_by_key(|one| (place(one.family), one.number));
        let nobody = |_: &ConjectureFinding| ();
        let question = self.question(&nobody);
        let mut object = conjecture_json(&findings, &question);
        object["interrupted"] = json!(interrupted());
        let mut files = Files::default();
        if let Some(folder) = &self.asked.out {
            files.json(&folder.join("poses.json"), &object);
            files.announce(&folder.join("poses.json"));
        }
        files.print(form, object, || conjecture_text(&findings, &question), Status::of(true))
    }
}
