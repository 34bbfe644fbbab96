//! `palmistry certify`: full rank proved on whole regions.

use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted};
use super::output::{Files, Form, fraction_bar};
use super::shards::{NO_WHOLE, Parts, Shards};
use super::{Status, Unusable};
use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use palmistry::System;
use palmistry::certificate::{Limits, Progress, Region, RegionAnswer, RegionPart, RegionRows};
use palmistry::evidence::{WrittenBoxes, certificate_file};
use palmistry::expression::Symbol;
use palmistry::file::{note, read_text};
use palmistry::foreign::shown_path;
use palmistry::report::{percent, region_curve, region_json, region_map, region_text, unit_of};
use palmistry::system::Code;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Proves full rank on boxes of states, and says on which part of the sample box.
///
/// Branch and bound with interval arithmetic. The sample box is halved again and again; a box is finished when some
/// minor of the rows is proved, with outward rounding, to be different from zero at every state in it. The other boxes
/// are those in which a minor is proved to vanish somewhere, those that contain a singularity, and those that are undecided. The
/// proved fraction is a lower bound, and grows with the budget. Angles and parameters without a range keep their value;
/// what the file says to avoid is part of the box, and the fraction is also given without it.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry certify proofs/martinelli2005/polar.proof --box r=1/10..10 --budget 30
  palmistry certify general.proof --boxes 20000 --state open.txt                  a search that has open boxes
  palmistry certify general.proof --depth 30 --state open.txt --shard 3/64 --part parts        a share of them
  palmistry certify general.proof --state open.txt --merge parts --merged next.txt")]
pub(crate) struct Certify {
    /// The proof file.
    pub(super) file: PathBuf,
    /// Other ranges than those of the file, for states and parameters; the same number twice fixes one.
    #[arg(
        long = "box",
        value_name = "NAME=LOW..HIGH,...",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    ranges: Vec<String>,
    /// How long to work, in seconds.
    #[arg(long, default_value_t = 10.0, value_name = "SECONDS", value_parser = seconds)]
    budget: f64,
    /// Examine N boxes, however long it takes: the same result on every machine and any number of threads.
    #[arg(long, value_name = "N", conflicts_with = "budget")]
    boxes: Option<u64>,
    /// Examine all boxes of at most N halvings: the same result however the boxes are distributed, to the last bit.
    #[arg(long, value_name = "N", conflicts_with_all = ["budget", "boxes"], value_parser = clap::value_parser!(u16).range(0..=1000))]
    depth: Option<u16>,
    /// Which rows are to have full rank.
    #[arg(long, value_enum, default_value = "codistribution")]
    rows: Rows,
    /// Take Lie derivatives of exactly up to order K; otherwise of one order more than is generically needed.
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=12))]
    order: Option<u16>,
    /// Keep the open boxes in this file, and go on from it if it is there.
    #[arg(long, value_name = "FILE")]
    pub(super) state: Option<PathBuf>,
    #[command(flatten)]
    shards: Shards,
    /// With '--merge': write the state of the merged search to a file, which '--state' continues.
    #[arg(long, value_name = "FILE", requires = "merge")]
    pub(super) merged: Option<PathBuf>,
    /// The two coordinates of the map; two that matter if none are named.
    #[arg(long, value_name = "X,Y", value_delimiter = ',')]
    map: Vec<String>,
    /// Write certify.json and the pictures curve.svg and map.svg into this folder.
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Write the largest proved boxes, each with the rows of its minor, to a file for 'palmistry recheck'.
    #[arg(long, value_name = "FILE")]
    pub(super) verdicts: Option<PathBuf>,
    /// How many boxes that file holds at most, the largest first.
    #[arg(long, default_value_t = 2000, value_name = "N", requires = "verdicts", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    verdict_boxes: u32,
    /// Print one JSON object with 'proved_fraction', 'minor_vanishes_fraction', 'open_fraction', 'curve' and more.
    #[arg(long)]
    pub json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Rows {
    /// The differentials of all Lie derivatives.
    Codistribution,
    /// The matrix named 'rows' of the file.
    Own,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("the budget is a positive number of seconds".to_owned()),
    }
}

/// The state is written at least this often.
const SECONDS_BETWEEN_SAVES: f64 = 30.0;

/// A state of more bytes than this is not read: a hundred million open boxes are more than any machine holds.
const LONGEST_STATE: u64 = 4 << 30;

impl Certify {
    pub fn run(self) -> miette::Result<Status> {
        let begin = Instant::now();
        let mut system = System::read(&self.file)?;
        let ranges = system.given_ranges(&self.ranges).map_err(Unusable::given)?;
        let rows = match (self.rows, self.order) {
            (Rows::Own, Some(_)) => {
                return Err(Unusable::report(
                    Code::Option,
                    "the file's own rows have no order",
                    "leave out --order, or --rows own",
                ));
            }
            (Rows::Own, None) => RegionRows::Own,
            (Rows::Codistribution, order) => RegionRows::Codistribution(order.map(usize::from)),
        };
        let map = self.map_of(&system)?;
        let unit = |symbol| unit_of(&system, system.symbol_name(symbol));
        let units = map.map_or([None, None], |(x, y)| [unit(x), unit(y)]);
        let mut region = Region::new(&mut system, rows, &ranges, map)
            .map_err(|why| Unusable::report(Code::Question, why, ""))?;
        if self.verdicts.is_some() {
            region.keep_boxes(self.verdict_boxes as usize);
        }
        if let Some(file) = &self.state {
            if file.exists() && !file.is_file() {
                let message = format!("{} is no file that a state could be kept in", shown_path(file));
                return Err(Unusable::report(Code::Saved, message, "name a file with --state"));
            }
            resume(&mut region, file)?;
        }
        let mut files = Files::default();
        if let Some(status) = self.of_shards(&mut region, begin, &mut files)? {
            return Ok(status);
        }
        if self.shards.merge.is_none() {
            self.work(&mut region, begin, &mut files);
        }
        begin_to_tell();
        let answer = region.answer();
        let mut object = region_json(&answer);
        object["interrupted"] = json!(interrupted());
        if let Some(folder) = &self.out {
            pictures(&answer, &units, folder, &mut files);
            files.json(&folder.join("certify.json"), &object);
        }
        let written = self.write_verdicts(&system, &region, &mut files);
        if let Some(written) = &written {
            object["verdict_boxes"] = json!({ "written": written.boxes, "left_out": written.left_out });
        }
        let status = Status::of(true);
        let in_words = || {
            let text = region_text(&answer);
            match (&self.verdicts, &written) {
                (Some(file), Some(written)) => format!(
                    "{text}\n{}: {} of {} proved boxes; {} more are not shown by plain interval arithmetic and left out",
                    shown_path(file),
                    written.boxes,
                    region.proved_box_count(),
                    written.left_out
                ),
                _ => text,
            }
        };
        files.print(Form::of(self.json), object, in_words, status)
    }

    /// Does a share of the open boxes, or tells which are missing; where parts are to be merged the region is the merged one.
    fn of_shards(
        &self,
        region: &mut Region,
        begin: Instant,
        files: &mut Files,
    ) -> miette::Result<Option<Status>> {
        let Shards { shard, part, merge, missing } = &self.shards;
        if shard.is_none() && merge.is_none() && missing.is_none() {
            return Ok(None);
        }
        if !self.state.as_ref().is_some_and(|file| file.exists()) {
            return Err(Unusable::report(
                Code::Option,
                "shards share the open boxes of a search, and '--state' names none",
                "search for a while with --state FILE first, without --shard",
            ));
        }
        let base = region.standing_sum();
        let reader = Mutex::new(region);
        let parts = Parts {
            kind: "certify",
            extension: ".part",
            read: &|text| reader.lock().unwrap_or_else(PoisonError::into_inner).read_part(text),
            belongs: &|part: &RegionPart| part.is_of(base),
        };
        let form = Form::of(self.json);
        if let Some(missing) = missing {
            return parts.tell_missing(missing, form).map(Some);
        }
        if let Some((shard, folder)) = shard.zip(part.as_ref()) {
            let work = |files: &mut Files| {
                let mut region = reader.lock().unwrap_or_else(PoisonError::into_inner);
                let base = region.take_share(shard.number, shard.of);
                self.work(&mut region, begin, files);
                Ok(Some(region.part_text(base, shard.number, shard.of)))
            };
            return parts.do_shard(shard, folder, None, form, work).map(Some);
        }
        if let Some(folder) = merge {
            let found = parts.all(folder)?;
            let region = reader.into_inner().unwrap_or_else(PoisonError::into_inner);
            region.merge(found).map_err(|why| Unusable::report(Code::Saved, why, NO_WHOLE))?;
            if let Some(file) = &self.merged {
                files.text(file, &region.saved());
            }
        }
        Ok(None)
    }

    /// Spends the budget, and keeps the state on the way; not that of a share, whose search begins where the state stands.
    fn work(&self, region: &mut Region, begin: Instant, files: &mut Files) {
        let bar = fraction_bar("proving");
        let mut left = self.boxes;
        let state = self.state.as_ref().filter(|_| self.shards.shard.is_none());
        while !interrupted() && !region.is_finished() {
            let rest = self.budget - begin.elapsed().as_secs_f64();
            let slice = if state.is_some() { SECONDS_BETWEEN_SAVES } else { f64::INFINITY };
            let limits = match (left, self.depth) {
                (Some(_), _) | (None, Some(_)) => Limits { seconds: Some(slice), boxes: left },
                (None, None) => Limits { seconds: Some(rest.min(slice)), boxes: None },
            };
            let is_over = rest <= 0.0 && left.is_none() && self.depth.is_none();
            if is_over || left == Some(0) {
                break;
            }
            let (before, tell) = (region.boxes(), |now| show(&bar, now));
            match self.depth {
                Some(depth) => region.run_to_depth(depth.into(), limits, &INTERRUPTED, &tell),
                None => region.run(limits, &INTERRUPTED, &tell),
            }
            let done = region.boxes() - before;
            left = left.map(|left| left - done.min(left));
            if let Some(file) = state {
                let mut saved = Files::default();
                saved.text(file, &region.saved());
                if !saved.whole() {
                    break; // told below: hours of work that nobody can keep are not begun
                }
            }
            if done == 0 {
                break; // all boxes of the depth are done, the rest of the time is for explaining the open boxes, or too many of these are open
            }
        }
        bar.finish_and_clear();
        if let Some(file) = state {
            files.text(file, &region.saved());
        }
    }

    /// Writes what the certificate rests on, where that is asked for.
    fn write_verdicts(&self, system: &System, region: &Region, files: &mut Files) -> Option<WrittenBoxes> {
        let path = self.verdicts.as_ref()?;
        let most = self.verdict_boxes as usize;
        let found = certificate_file(system, region, most, &INTERRUPTED).map_err(|why| why.to_string());
        let (text, written) = match found {
            Ok((file, written)) => (file.text().map_err(|why| why.to_string()), Some(written)),
            Err(why) => (Err(why), None),
        };
        files.text_or(path, text);
        written
    }

    fn map_of(&self, system: &System) -> miette::Result<Option<(Symbol, Symbol)>> {
        match self.map.as_slice() {
            [] => Ok(None),
            [x, y] if x.trim() != y.trim() => {
                let symbol = |name| system.own_symbol(name).map_err(Unusable::given);
                Ok(Some((symbol(x)?, symbol(y)?)))
            }
            _ => Err(Unusable::report(Code::Option, "a map has two coordinates", "as in --map omega0,r1")),
        }
    }
}

fn show(bar: &ProgressBar, now: Progress) {
    bar.set_position((now.proved * bar.length().unwrap_or(1) as f64) as u64);
    bar.set_message(format!("{} proved, {:.1e} boxes", percent(now.proved), now.boxes as f64));
}

fn pictures(answer: &RegionAnswer, units: &[Option<String>; 2], folder: &Path, files: &mut Files) {
    files.text(&folder.join("curve.svg"), &region_curve(answer, &answer.title));
    if let Some(map) = &answer.map {
        let units = [units[0].as_deref(), units[1].as_deref()];
        files.text(&folder.join("map.svg"), &region_map(map, &answer.title, units));
    }
}

/// Takes up a search, where there is one.
fn resume(region: &mut Region, file: &Path) -> miette::Result<()> {
    if !file.exists() {
        return Ok(());
    }
    let text = read_text(file, LONGEST_STATE).map_err(|why| {
        Unusable::report(
            Code::Saved,
            format!("cannot read {}: {why}", shown_path(file)),
            "the state of a search is a file",
        )
    })?;
    region.resume(&text).map_err(|why| {
        let message = format!("{} cannot be taken up: {why}", shown_path(file));
        Unusable::report(
            Code::Saved,
            message,
            "name another file with --state, or delete this one to begin anew",
        )
    })?;
    if region.is_finished() {
        note(&format!("{} is finished: no box in it is open any more", shown_path(file)));
    }
    Ok(())
}
