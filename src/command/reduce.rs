//! `palmistry reduce`: the least model under conditions, as a proof file whose claims say that it is the larger one there.

use super::derived::{decided, import_path};
use super::output::{Files, Form};
use super::{Status, Unusable};
use clap::Args;
use palmistry::System;
use palmistry::foreign::name_of;
use palmistry::observability::{Ceiling, generic_answer};
use palmistry::reduction::{NotReduced, ReduceQuestion, reduce};
use palmistry::report::{least_json, least_text};
use palmistry::system::{Assignment, Code, given_number};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Writes the least model of a system under conditions, and proves that both agree there.
///
/// Conditions (--fix) are put in, and must hold along the drift and every input. Then everything that they make superfluous is left out: states that they give, constants
/// that are known (--known) or directly measured, states on which no output depends, signals that nothing needs, and of each conservation law (a sum of states
/// with rational factors) one state, whose amount becomes an unknown constant.
///
/// The new file imports the larger one. Its claims say that conditions stay met, that the larger system moves as the smaller one wherever they hold, and that the
/// outputs are the same; they are decided before anything is printed, and can be decided again with 'palmistry prove'.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry reduce general.proof --fix omega1=0,omega2=0,alpha1=0,alpha2=0 --known rho --out fixed.proof
  palmistry reduce general.proof --fix alpha1=0,alpha2=0 --undriven g1,g2
  palmistry reduce general.proof --fix omega1=0,omega2=0,alpha1=0,alpha2=0 --drive g1=tau1,g2=tau2
  palmistry reduce spinning.proof --tolerance 1e-6          terms that are small over the ranges, with a proved bound
  palmistry reduce sir.proof                                conservation laws, states on which no output depends

Exit status: 0 all claims of the new file are proved, 1 some are not, 2 there is no such model.")]
pub(crate) struct Reduce {
    /// The proof file.
    pub(super) file: PathBuf,
    /// Conditions, as in 'omega1 = 0' or 'omega2 = omega1', or several: 'x = 0, y = 1' (may be repeated).
    #[arg(long, value_name = "CONDITION")]
    fix: Vec<String>,
    /// States and unknown constants that are known, with a value or without: a constant becomes a parameter, and a state that varies becomes an output.
    #[arg(long, value_name = "NAME[=VALUE],...", value_delimiter = ',')]
    known: Vec<String>,
    /// Input fields that nothing drives.
    #[arg(long, value_name = "INPUT,...", value_delimiter = ',')]
    undriven: Vec<String>,
    /// Input fields and what drives each: a parameter, which becomes a known signal, or a known signal. The drift of the new file is f + u g.
    #[arg(long, value_name = "INPUT=NAME,...", value_delimiter = ',')]
    drive: Vec<String>,
    /// Parameters that are known signals.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    signal: Vec<String>,
    /// Leave out terms of a rate that together are at most this part of the median of its absolute values over the ranges of the file, as in 1e-6. How
    /// large they are at most is proved, or they stay.
    #[arg(long, value_name = "PART", value_parser = super::arguments::part)]
    tolerance: Option<f64>,
    /// Write the proof file here; without it, it is printed.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Print one JSON object with the proof file as 'proof', the conditions as they were solved, what was left out and why, counts before and after, the rank, and
    /// the claims with their verdicts.
    #[arg(long)]
    pub json: bool,
}

impl Reduce {
    pub fn run(self) -> miette::Result<Status> {
        let system = System::read(&self.file)?;
        let question = self.question()?;
        let is_printed = self.out.as_ref().is_none_or(|out| out.as_os_str() == "-");
        let out = self.out.as_deref().filter(|_| !is_printed);
        let import = import_path(&self.file, out);
        let least = reduce(&system, &question, &import).map_err(|why| {
            Unusable::report(Code::Question, format!("{}: {why}", name_of(&self.file)), help(&why))
        })?;
        let place = out.unwrap_or(Path::new("least.proof"));
        let (smaller, outcomes) = decided(&least.text, &import, &self.file, place).map_err(|why| {
            Unusable::report(Code::Question, format!("the least model is not written: {why}"), "")
        })?;
        // of tied signals the rank is that of a branch, which 'rank' looks for
        let rank = smaller
            .zero_outputs()
            .is_empty()
            .then(|| generic_answer(&smaller, &Assignment::new(), Ceiling::Rests));
        let mut files = Files::default();
        if let Some(out) = out {
            files.text(out, &least.text);
            files.announce(out);
        }
        let mut object = least_json(&least, &outcomes, rank.as_ref());
        object["file"] = json!(name_of(&self.file));
        object["written"] = json!(out.map(name_of));
        let all_proved = outcomes.iter().all(|outcome| outcome.ok);
        let words = least_text(&least, &outcomes, rank.as_ref());
        if !self.json && is_printed {
            eprint!("{words}");
        }
        let text = || if is_printed { least.text.trim_end().to_owned() } else { words.trim_end().to_owned() };
        files.print(Form::of(self.json), object, text, Status::of(all_proved))
    }
}

impl Reduce {
    fn question(&self) -> miette::Result<ReduceQuestion> {
        let list = |names: &[String]| -> Vec<String> {
            names.iter().map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
        };
        let known = list(&self.known).into_iter().map(|one| match one.split_once('=') {
            None => Ok((one, None)),
            Some((name, value)) => {
                let value = given_number(value.trim()).map_err(|why| {
                    Unusable::report(
                        Code::Option,
                        format!("--known {one}: {why}"),
                        "write a number, as in --known rho=0.5",
                    )
                })?;
                Ok((name.trim().to_owned(), Some(value)))
            }
        });
        let driven = list(&self.drive).into_iter().map(|one| match one.split_once('=') {
            Some((field, symbol)) => Ok((field.trim().to_owned(), symbol.trim().to_owned())),
            None => Err(Unusable::report(
                Code::Option,
                format!("--drive {one}: what drives it is missing"),
                "write --drive g1=tau1, or --undriven g1 where nothing does",
            )),
        });
        Ok(ReduceQuestion {
            conditions: self.fix.clone(),
            known: known.collect::<miette::Result<_>>()?,
            undriven: list(&self.undriven),
            driven: driven.collect::<miette::Result<_>>()?,
            signals: list(&self.signal),
            tolerance: self.tolerance,
            ranges: Vec::new(),
        })
    }
}

/// What to do about it.
fn help(why: &NotReduced) -> String {
    match why {
        NotReduced::NotKept { rate, .. } => {
            format!(
                "add a condition under which this rate is zero, as in --fix '{rate} = 0', or leave an input out with --undriven"
            )
        }
        NotReduced::SeveralWays { .. } => {
            "each --fix has to give a symbol one value, as in --fix x=0".to_owned()
        }
        NotReduced::Condition { .. } => "a condition reads --fix 'x = 0' or --fix 'y = x'".to_owned(),
        NotReduced::Pole { .. } => {
            "the system has no value there: such a model needs other coordinates".to_owned()
        }
        NotReduced::Kind { .. } => "what is reduced has a drift or inputs in continuous time".to_owned(),
        NotReduced::NoUnknown { .. } => {
            "a parameter that is no unknown is known already; give it a value with --fix".to_owned()
        }
        NotReduced::NoSignal { .. } => {
            "a known signal is declared by 'known u(t)', a parameter by 'param u'".to_owned()
        }
        NotReduced::NoInput { .. } | NotReduced::TooLong { .. } | NotReduced::Nothing => String::new(),
    }
}
