//! The answer to one question: a function from a text to lines of JSON, done in a process of its own.
//!
//! Every answer ends with a line whose `kind` is `done` or `error`; before it come `progress` and what is known so far. Nothing is decided
//! here: all verdicts are those of the commands.

mod claims;
mod draft;
mod estimated;
mod models;
mod motion;
mod picture;
mod place;
mod ranks;
mod run;

use place::Place;
pub(crate) use run::PAGE;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Takes a line of an answer.
pub(crate) type Tell<'t> = &'t (dyn Fn(Value) + Sync);

/// What is asked, and of which text.
#[derive(Deserialize)]
struct Question {
    /// The text of a proof file.
    #[serde(default)]
    text: String,
    /// Where it would stand: in the folder that is served, or among the papers of the program (`papers:...`).
    #[serde(default)]
    file: String,
    #[serde(flatten)]
    ask: Ask,
}

#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "kebab-case")]
enum Ask {
    /// Its mistakes, its claims, its names, the system as mathematics.
    Draft,
    /// What the name at a position is.
    Hover { position: Value },
    /// What can stand at a position.
    Complete { position: Value },
    /// The edits that bring it into its normal form.
    Format,
    /// The verdicts of these claims.
    Claims {
        only: Vec<String>,
        #[serde(default = "first_seed")]
        seed: u64,
    },
    /// The rank and what is observable; at so many sampled states too.
    Rank { samples: u64 },
    /// How many values of each unknown give the same outputs.
    Values {
        #[serde(default)]
        functions: bool,
    },
    /// The sets on which the rank drops.
    Drops,
    /// How well the unknowns are observable over two coordinates, coarse first.
    Map(picture::MapAsked),
    /// The certified rank at one state.
    State(picture::StateAsked),
    /// How well they are observable along a line into a set.
    Line(picture::LineAsked),
    /// A motion, and a second one with the same outputs.
    Motion(motion::MotionAsked),
    /// Estimates from a recording or from a simulation.
    Observe(run::ObserveAsked),
    /// A scene that came with the program.
    Scene { scene: PathBuf },
    /// The page of the text as a paper.
    Page,
    /// A proof file from a file of another program.
    Import { files: BTreeMap<String, String> },
    /// The fit of a problem of parameter estimation.
    Fit { files: BTreeMap<String, String> },
    /// The models that came with the program.
    Models,
    /// The text of one of them.
    Model { model: PathBuf },
}

/// The default seed, that of all commands.
fn first_seed() -> u64 {
    1
}

/// Why there is no answer, as text.
#[derive(Debug)]
pub(crate) struct Refused {
    message: String,
    help: Option<String>,
}

impl Refused {
    fn new(message: impl Into<String>) -> Refused {
        Refused { message: message.into(), help: None }
    }
}

impl From<String> for Refused {
    fn from(message: String) -> Refused {
        Refused::new(message)
    }
}

impl From<palmistry_lang::ReadError> for Refused {
    fn from(error: palmistry_lang::ReadError) -> Refused {
        let (line, _) = error.line_and_column();
        Refused { message: format!("line {line}: {}", error.message), help: error.help.clone() }
    }
}

/// Answers a question (a text in JSON) with JSON values, each of which becomes one line. It reads files in `folder` alone, and writes them
/// in `work` alone, a folder made for this question.
pub fn answer(question: &str, folder: Option<&Path>, work: &Path, tell: &(dyn Fn(Value) + Sync)) {
    let last = match serde_json::from_str(question) {
        Err(why) => Err(Refused::new(format!("this is no question: {why}"))),
        Ok(question) => answered(question, folder, work, tell),
    };
    tell(match last {
        Ok(mut answer) => {
            answer["kind"] = json!("done");
            answer
        }
        Err(Refused { message, help }) => json!({ "kind": "error", "message": message, "help": help }),
    });
}

fn answered(
    question: Question,
    folder: Option<&Path>,
    work: &Path,
    tell: Tell<'_>,
) -> Result<Value, Refused> {
    let Question { text, file, ask } = question;
    let place = || Place::new(&file, &text, folder);
    match ask {
        Ask::Draft => Ok(draft::draft(&place()?)),
        Ask::Hover { position } => Ok(json!({ "hover": place()?.draft().hover(&position) })),
        Ask::Complete { position } => Ok(json!({ "items": place()?.draft().completions(&position) })),
        Ask::Format => Ok(json!({ "edits": place()?.draft().formatted() })),
        Ask::Claims { only, seed } => claims::claims(&place()?, &only, seed, tell),
        Ask::Rank { samples } => ranks::rank(&place()?, samples, tell),
        Ask::Values { functions } => ranks::values(&place()?, functions, tell),
        Ask::Drops => ranks::drops(&place()?, tell),
        Ask::Map(asked) => picture::map(&place()?, &asked, tell),
        Ask::State(asked) => picture::state(&place()?, &asked),
        Ask::Line(asked) => picture::line(&place()?, &asked),
        Ask::Motion(asked) => motion::motion(&place()?, &asked),
        Ask::Observe(asked) => run::observe(&place()?, &asked, work),
        Ask::Scene { scene } => run::scene(&scene, work),
        Ask::Page => run::page(&place()?, work),
        Ask::Import { files } => run::import(&files, work),
        Ask::Fit { files } => run::fit(&files, work),
        Ask::Models => Ok(models::models()),
        Ask::Model { model } => models::model(&model),
    }
}
