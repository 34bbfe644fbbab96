//! `palmistry reduce`: the least model under conditions, as a proof file whose claims say that it is the larger one there.

use super::derived::{decided, import_path};
use super::output::{Files, Form};
use super::{Status, Unusable};
use clap::Args;
use palmistry::foreign::{name_of, shown};
use palmistry::observability::{GenericAnswer, generic_answer, Ceiling};
use palmistry::reduction::{LeastModel, NotReduced, ReduceQuestion, WhyLeftOut, reduce};
use palmistry::system::Assignment;
use palmistry::{Outcome, System};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Writes the least model that a system is under conditions, and proves that it is that.
///
/// Conditions (--fix) are put in, and have to stay met along the drift and every input. Then is left out what they make superfluous: states that they give, constants
/// that are known (--known) or measured by themselves, states on which no output depends, signals that nothing needs, and of each conservation law (a sum of states
/// with rational factors) one state, whose amount becomes an unknown constant.
///
/// The new file imports the larger one. Its claims say that conditions stay met, that the larger system moves as the smaller one wherever they hold, and that the
/// outputs are the same; they are decided before anything is printed, and can be decided again with 'palmistry prove'.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry reduce general.proof --fix omega1=0,omega2=0,alpha1=0,alpha2=0 --known rho --out fixed.proof
  palmistry reduce general.proof --fix alpha1=0,alpha2=0 --undriven g1,g2
  palmistry reduce sir.proof                                conservation laws, states on which no output depends

Exit status: 0 all claims of the new file are proved, 1 some are not, 2 there is no such model.")]
pub(crate) struct Reduce {
    /// The proof file.
    file: PathBuf,
    /// Conditions, as in 'omega1 = 0' or 'omega2 = omega1', or several: 'x = 0, y = 1' (may be repeated).
    #[arg(long, value_name = "CONDITION")]
    fix: Vec<String>,
    /// States and unknown constants that are known: a constant becomes a parameter, a state that moves an output.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    known: Vec<String>,
    /// Input fields that nothing drives.
    #[arg(long, value_name = "INPUT,...", value_delimiter = ',')]
    undriven: Vec<String>,
    /// Write the proof file here; without it, it is printed.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object with the proof file as 'proof', the conditions as they were solved, what was left out and why, counts before and after, the rank, and
    /// the claims with their verdicts.
    #[arg(long)]
    pub json: bool,
}

impl Reduce {
    pub fn run(self) -> miette::Result<Status> {
        let system = System::read(&self.file)?;
        let list = |names: &[String]| -> Vec<String> {
            names.iter().map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
        };
        let question =
            ReduceQuestion { conditions: self.fix.clone(), known: list(&self.known), undriven: list(&self.undriven) };
        let is_printed = self.out.as_ref().is_none_or(|out| out.as_os_str() == "-");
        let out = self.out.as_deref().filter(|_| !is_printed);
        let import = import_path(&self.file, out);
        let least = reduce(&system, &question, &import)
            .map_err(|why| Unusable::report(format!("{}: {why}", name_of(&self.file)), help(&why)))?;
        let place = out.unwrap_or(Path::new("least.proof"));
        let (smaller, outcomes) = decided(&least.text, &import, &self.file, place)
            .map_err(|why| Unusable::report(format!("the least model is not written: {why}"), ""))?;
        let rank = generic_answer(&smaller, &Assignment::new(), Ceiling::Rests);
        let mut files = Files::default();
        if let Some(out) = out {
            files.text(out, &least.text);
            files.announce(out);
        }
        let object = object(&self.file, out, &least, &outcomes, &rank);
        let all_proved = outcomes.iter().all(|outcome| outcome.ok);
        let words = in_words(&least, &outcomes, &rank);
        if !self.json && is_printed {
            eprintln!("{words}");
        }
        let text = || if is_printed { least.text.trim_end().to_owned() } else { words.clone() };
        files.print(Form::of(self.json), object, text, Status::of(all_proved))
    }
}

/// What to do about it.
fn help(why: &NotReduced) -> String {
    match why {
        NotReduced::NotKept { rate, .. } => {
            format!("add a condition under which this rate is zero, as in --fix '{rate} = 0', or leave an input out with --undriven")
        }
        NotReduced::SeveralWays { .. } => "each --fix has to give a symbol one value, as in --fix x=0".to_owned(),
        NotReduced::Condition { .. } => "a condition reads --fix 'x = 0' or --fix 'y = x'".to_owned(),
        NotReduced::Pole { .. } => {
            "the system has no value there: such a model needs other coordinates".to_owned()
        }
        NotReduced::Kind { .. } => "what is reduced has a drift or inputs in continuous time".to_owned(),
        NotReduced::NoUnknown { .. } => "a parameter that is no unknown is known already; give it a value with --fix".to_owned(),
        NotReduced::NoInput { .. } | NotReduced::TooLong { .. } | NotReduced::Nothing => String::new(),
    }
}

fn counted(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

fn rank_in_words(rank: &GenericAnswer) -> String {
    match rank.rank() {
        Some(known) if known == rank.dimension => {
            format!("generic rank {known} of {}: locally observable", rank.dimension)
        }
        Some(known) => format!(
            "generic rank {known} of {}: {} unobservable",
            rank.dimension,
            counted(rank.dimension - known, "direction")
        ),
        None => format!("generic rank between {} and {} of {}", rank.at_least, rank.at_most, rank.dimension),
    }
}

fn in_words(least: &LeastModel, outcomes: &[Outcome], rank: &GenericAnswer) -> String {
    let mut lines = Vec::new();
    let of = |[before, after]: [usize; 2], what: &str| match before == after {
        true => counted(after, what),
        false => format!("{} instead of {before}", counted(after, what)),
    };
    lines.push(format!(
        "{}, of which {}; {}",
        of(least.unknowns, "unknown"),
        match least.moving {
            [before, after] if before == after => format!("{after} move"),
            [before, after] => format!("{after} move instead of {before}"),
        },
        of(least.operations, "operation"),
    ));
    for one in &least.left_out {
        lines.push(format!("  {}: {}", one.name, why_in_words(&one.why)));
    }
    lines.extend(least.remarks.iter().map(|remark| format!("  {remark}")));
    lines.push(rank_in_words(rank));
    let proved = outcomes.iter().filter(|outcome| outcome.ok).count();
    lines.push(format!("{proved} of {} claims that it is the larger system there are proved", outcomes.len()));
    for outcome in outcomes.iter().filter(|outcome| !outcome.ok) {
        lines.push(format!("  {} {}: {}", outcome.word(), outcome.id, shown(&outcome.statement)));
    }
    lines.join("\n")
}

fn why_in_words(why: &WhyLeftOut) -> String {
    match why {
        WhyLeftOut::Fixed(value) => format!("fixed, {value}"),
        WhyLeftOut::KnownConstant => "a known constant, a parameter now".to_owned(),
        WhyLeftOut::MeasuredConstant => "constant and measured, a parameter now".to_owned(),
        WhyLeftOut::NoOutputDependsOnIt => "no output depends on it: unobservable".to_owned(),
        WhyLeftOut::Conserved { law, total } => format!("{law} is conserved: the unknown constant {total}"),
    }
}

fn object(
    file: &Path,
    out: Option<&Path>,
    least: &LeastModel,
    outcomes: &[Outcome],
    rank: &GenericAnswer,
) -> Value {
    let left_out = least.left_out.iter().map(|one| {
        let word = match &one.why {
            WhyLeftOut::Fixed(_) => "fixed",
            WhyLeftOut::KnownConstant => "known_constant",
            WhyLeftOut::MeasuredConstant => "measured_constant",
            WhyLeftOut::NoOutputDependsOnIt => "no_output_depends_on_it",
            WhyLeftOut::Conserved { .. } => "conserved",
        };
        json!({ "name": one.name, "why": word, "in_words": why_in_words(&one.why) })
    });
    let claims = outcomes
        .iter()
        .map(|outcome| json!({ "id": outcome.id, "statement": outcome.statement, "verdict": outcome.word() }));
    let pair = |[before, after]: [usize; 2]| json!({ "before": before, "after": after });
    json!({
        "file": name_of(file),
        "written": out.map(name_of),
        "proof": least.text,
        "conditions": least.conditions,
        "left_out": left_out.collect::<Vec<_>>(),
        "unknowns": pair(least.unknowns),
        "moving": pair(least.moving),
        "operations": pair(least.operations),
        "remarks": least.remarks,
        "rank": { "at_least": rank.at_least, "at_most": rank.at_most, "of": rank.dimension },
        "claims": claims.collect::<Vec<_>>(),
    })
}
