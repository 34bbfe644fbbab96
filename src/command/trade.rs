//! `palmistry trade`: what does accuracy cost?

use super::interrupt::{INTERRUPTED, begin_to_tell};
use super::output::{Files, Form, progress};
use super::{Status, Unusable};
use clap::Args;
use palmistry::System;
use palmistry::report::{trade_json, trade_plot, trade_text};
use palmistry::system::Code;
use palmistry::tradeoff::{TradeQuestion, trade};
use std::path::PathBuf;

/// Rounds of timing.
const ROUNDS: usize = 15;

/// Measures speed against accuracy: number types, methods of differentiation and of deciding a rank, on the same states.
///
/// Every sensible combination computes the differentials of the file's 'rows' (or of the Lie derivatives that are
/// needed) and their rank at states drawn from the sample box. Digits and ranks are compared with exact arithmetic at
/// that very state. The Pareto front consists of the combinations that no other beats in time, digits and verdicts. States of
/// the sample box keep away from singular sets: 'stress' examines states near them.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry trade mysystem.proof --out trade")]
pub(crate) struct Trade {
    /// The proof file.
    pub(super) file: PathBuf,
    /// How many states are drawn from the sample box.
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=20_000))]
    samples: u64,
    /// Seed of the sampled states.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Write the picture to trade.svg, and what was measured to trade.json, in this folder.
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Print one JSON object with 'derivatives', 'ranks', 'combinations', 'left_out' and more.
    #[arg(long)]
    pub json: bool,
}

impl Trade {
    pub fn run(self) -> miette::Result<Status> {
        let system = System::read(&self.file)?;
        let bar = progress(0, "measuring");
        let found = trade(
            &system,
            &TradeQuestion {
                samples: self.samples,
                seed: self.seed,
                rounds: ROUNDS,
                interrupt: &INTERRUPTED,
                progress: &|done, all| {
                    bar.set_length(all);
                    bar.set_position(done);
                },
            },
        );
        bar.finish_and_clear();
        let found = found.map_err(|why| Unusable::report(Code::Question, why, ""))?;
        begin_to_tell();
        let json = trade_json(&found);
        let mut files = Files::default();
        if let Some(folder) = &self.out {
            files.text(&folder.join("trade.svg"), &trade_plot(&found));
            files.json(&folder.join("trade.json"), &json);
        }
        let status = if found.interrupted { Status::CutOff } else { Status::AsExpected };
        files.print(Form::of(self.json), json, || trade_text(&found), status)
    }
}
