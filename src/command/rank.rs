//! `palmistry rank`: is the state observable from the outputs?

use super::arguments::Wanted;
use super::interrupt::{INTERRUPTED, begin_to_tell, interrupted, nothing_found, watched};
use super::output::{Files, Form, progress};
use super::reparametrise::reparametrisation;
use super::shards::{NO_WHOLE, Parts, Shards};
use super::{Status, Unusable};
use clap::{ArgGroup, Args};
use miette::Report;
use palmistry::checker::VerdictFile;
use palmistry::drops::{DropAnswer, singular_set_at_once, where_it_drops_telling};
use palmistry::evidence::rank_records;
use palmistry::file::note;
use palmistry::observability::SOLUTIONS_WORK;
use palmistry::report::{
    RankTextParts, SingularSet, StateTableWriter, TableForm, accessibility_json, accessibility_text,
    drops_json, drops_page, drops_text, global_json, global_text, rank_json, rank_so_far_json,
    rank_so_far_text, rank_text_with, singular_set_json, unobservable_directions_json,
};
use palmistry::sweep::{
    AccessibilityAnswer, GenericOnBranch, GlobalAnswer, MOST_DIGITS, RankError, RankPart, RankPreparation,
    SolutionsWanted, StateRow, StateTable, answer_accessibility_telling, answer_solutions_telling, shard_of,
};
use palmistry::system::Code;
use palmistry::{RankQuestion, System, answer_rank};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Decides the rank of the observability codistribution at sampled states.
///
/// It first gives what holds generically, except on a set of measure zero: each state observable or not, each parameter identifiable or not, and
/// the rank, by power series at random points modulo random primes; then identifiable combinations and unobservable directions. Where states are sampled it looks for the singular set, as
/// far as a small amount of work decides it. Then at these states: Lie derivatives along the drift and the inputs are added in increasing order until the rank
/// stops growing or reaches the dimension. At every state the rank is computed by singular values and certified by exact
/// arithmetic at that very state. Where the file
/// defines a matrix named 'rows', its rank is decided at the same states too. Parameters without a range have the values of
/// the file, and the answer says which, and from which ranges it draws symbols that have neither range nor value; a claim 'rank = n' in a file is about all values.
#[derive(Args)]
#[command(group(ArgGroup::new("counted").args(["global", "functions"]).multiple(true)))]
#[command(after_help = "Examples:
  palmistry rank mysystem.proof --samples 100000
  palmistry rank mysystem.proof --at omega0=0              on the set where omega0 is zero
  palmistry rank mysystem.proof --where 'sin(phi1) = 0'    on the set of a condition
  palmistry rank mysystem.proof --singular-set             the rank-deficient states, with a proof that there are no others
  palmistry rank mysystem.proof --global                   each unknown globally, locally or not identifiable, with the number of solutions
  palmistry rank mysystem.proof --global --at omega0=0     and the rank where omega0 is zero
  palmistry rank mysystem.proof --functions                generators of all identifiable functions
  palmistry rank mysystem.proof --digits 40                the worst state's singular values, all digits certain
  palmistry rank mysystem.proof --accessible               what the inputs can move, by brackets
  palmistry rank mysystem.proof --samples 1000000 --shard 3/64 --part parts    one of 64 shards, on any machine
  palmistry rank mysystem.proof --samples 1000000 --merge parts                and the answer of all")]
pub(crate) struct Rank {
    /// The proof file.
    pub(super) file: PathBuf,
    /// How many states are drawn from the sample box, to find rank-deficient ones; with 0 only the generic rank is decided, which writes
    /// down no Lie derivatives and is quick [default: 1000, where the Lie derivatives are short enough to be written down in a moment, else 0].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=1_000_000_000_000_000))]
    samples: Option<u64>,
    /// Seed of the sampled states.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Take Lie derivatives of exactly up to order K, whether or not the rank still grows.
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=12))]
    order: Option<u16>,
    /// Fix these states and parameters, as in omega0=0 or g=0, and sample the rest.
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',')]
    at: Vec<String>,
    /// Sample only states that meet this condition, as in 'sin(phi1) = 0' or '0 < x < 1', or several: 'x = 0, y > 0' (may be
    /// repeated).
    #[arg(long = "where", value_name = "CONDITION")]
    conditions: Vec<String>,
    /// What every rank has to be: 'certified', proved at the very state, or 'computed', in floating point. The
    /// cheapest number type that suffices is used; a state that it does not decide escalates to a higher precision.
    #[arg(long, value_enum, default_value_t = Wanted::Certified, value_name = "HOW")]
    verdict: Wanted,
    /// Give the singular values of the state whose rank is hardest to decide, and its condition, to N significant digits (at most 200);
    /// by doubles they have about three. The digits are what '--verdict' says: all of them certain, or agreed on by
    /// doubles and double-doubles. The cheapest number type that suffices is used; 'escalations' says how many number types were tried
    /// before. Which state is worst is decided by doubles.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_DIGITS as i64))]
    digits: Option<u16>,
    /// Write states with their certified ranks, minors and kernels to a file for 'palmistry recheck'.
    #[arg(long, value_name = "FILE")]
    pub(super) verdicts: Option<PathBuf>,
    /// How many states that file holds at most; they are spread over the sweep, the worst conditioned one is among them.
    #[arg(long, default_value_t = 1000, value_name = "N", requires = "verdicts", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    verdict_states: u64,
    /// Decide accessibility instead: whether the drift and the inputs can move the state in every direction. That is the rank of
    /// the distribution that they and their brackets span (accessibility), and without the drift itself (strong
    /// accessibility), generically and at the sampled states. Outputs are not used.
    #[arg(long, conflicts_with_all = ["digits", "verdicts", "shard", "merge", "missing"])]
    accessible: bool,
    /// Write a proof file of the observable part of the system: its states are observable functions; its claims, which are
    /// proved, say that they move as in this file and that the outputs are the same.
    #[arg(long, value_name = "FILE")]
    pub(super) reparametrise: Option<PathBuf>,
    /// Instead of sampled states: the singular set, as sets of rank-deficient states, each by its equations, and a proof that at all
    /// other states the rank equals the generic one. The parameters may have any values.
    #[arg(long, alias = "where-it-drops", conflicts_with_all = ["samples", "order", "at", "conditions", "digits", "verdicts", "shard", "merge", "missing"])]
    singular_set: bool,
    /// Write a page with these sets and their proof (index.html), and drops.json, into this folder.
    #[arg(long, value_name = "DIR", requires = "singular_set")]
    pub(super) out: Option<PathBuf>,
    /// Decide whether each unknown is globally identifiable or observable (one value gives the same outputs), locally (finitely many values do,
    /// which are counted over the complex numbers), or not at all. Generically, by Groebner bases at random points modulo random primes; each number says whether it
    /// is proved or computed. Where rates or outputs are not rational functions, one value is found and more are undecided. States are sampled only where another option asks for it; conditions
    /// ('--at', '--where') concern those states, and not these numbers.
    #[arg(long)]
    global: bool,
    /// As '--global', and then generators of all identifiable functions: rational functions of the unknowns that have one value for given
    /// outputs, such as k1 + k2 and k1*k2 where k1 and k2 can be exchanged. Every other such function is a rational function of these.
    #[arg(long)]
    functions: bool,
    /// With '--global' and '--functions': how much work may be done, in products of residues; what takes more is undecided.
    #[arg(long, default_value_t = SOLUTIONS_WORK, value_name = "N", requires = "counted")]
    work: u64,
    /// Write a row for each sampled state to a file, CSV or Parquet by its extension: index, rank, certified, smallest singular value,
    /// condition. With '--shard' those of its states.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["accessible", "singular_set", "merge", "missing"])]
    pub(super) table: Option<PathBuf>,
    /// Add the coordinates of each state to that table, angles in radians.
    #[arg(long, requires = "table")]
    coordinates: bool,
    /// Also print the Lie derivatives that were used, the number types that decided, gaps, how well each state is observable at the sampled ones (standard
    /// deviations), directions at single states, times, and all that is known, fixed or drawn by default.
    #[arg(long)]
    details: bool,
    #[command(flatten)]
    shards: Shards,
    /// Print no times: two runs with one seed then print the same to the last byte, as a merge does, which has no times.
    #[arg(long)]
    no_times: bool,
    /// Print one JSON object with 'samples', 'rank_histogram', 'certified', 'seconds' and more.
    #[arg(long)]
    pub json: bool,
}

/// What is known before the end.
#[derive(Clone)]
enum SoFar {
    Nothing,
    /// Of each branch of the conditions of a file, in their order, what holds generically on it.
    Rank(String, Vec<GenericOnBranch>),
    Values(Box<GlobalAnswer>),
    Drops(Box<DropAnswer>),
    Accessible(Box<AccessibilityAnswer>),
    /// A whole answer, and of the numbers of solutions what is known.
    WithValues(Box<Printed>, Option<Box<GlobalAnswer>>),
}

/// An answer as it is printed.
#[derive(Clone)]
struct Printed {
    object: Value,
    text: String,
}

impl Printed {
    /// With the numbers of solutions, which stand first in a text.
    fn with(mut self, values: &GlobalAnswer) -> Printed {
        self.object["global"] = global_json(values);
        Printed { text: format!("{}\n\n{}", global_text(values).trim_end(), self.text), ..self }
    }

    /// Numbers of solutions alone.
    fn of_values(values: &GlobalAnswer) -> Printed {
        Printed { object: global_json(values), text: global_text(values) }
    }
}

/// An answer, the files that were written with it, and what the run has come to.
struct Answered {
    files: Files,
    printed: Printed,
    status: Status,
}

impl Answered {
    fn print(self, form: Form) -> miette::Result<Status> {
        let Printed { object, text } = self.printed;
        self.files.print(form, object, || text, self.status)
    }
}

/// What a question has come to.
enum Step {
    Answered(Answered),
    /// It is printed, and nothing is to be added.
    Told(Status),
}

impl SoFar {
    /// Tells it where the work is not waited for, or was cut off.
    fn tell(&self, form: Form, cut_off: Option<&str>) -> miette::Result<Status> {
        let files = Files::default();
        match self {
            SoFar::Nothing => nothing_found(form),
            SoFar::Rank(file, branches) => files.print(
                form,
                rank_so_far_json(file, branches, cut_off),
                || rank_so_far_text(file, branches, cut_off),
                Status::CutOff,
            ),
            SoFar::Values(answer) => {
                files.print(form, global_json(answer), || global_text(answer), Status::CutOff)
            }
            SoFar::Drops(answer) => {
                files.print(form, drops_json(answer), || drops_text(answer), Status::CutOff)
            }
            SoFar::Accessible(answer) => {
                files.print(form, accessibility_json(answer), || accessibility_text(answer), Status::CutOff)
            }
            SoFar::WithValues(printed, values) => {
                let printed = Printed::clone(printed);
                let printed = match values {
                    Some(values) => printed.with(values),
                    None => printed,
                };
                Answered { files, printed, status: Status::CutOff }.print(form)
            }
        }
    }
}

impl Rank {
    /// Finds out. What an interrupt does not wait for is told without it.
    pub fn run(self) -> miette::Result<Status> {
        let form = Form::of(self.json);
        let known = Arc::new(Mutex::new(SoFar::Nothing));
        let kept = known.clone();
        let put = move |so_far| *kept.lock().unwrap_or_else(PoisonError::into_inner) = so_far;
        let left = move || known.lock().unwrap_or_else(PoisonError::into_inner).clone().tell(form, None);
        watched(move || self.work(&put), left)
    }

    fn work(self, known: &dyn Fn(SoFar)) -> miette::Result<Status> {
        let mut system = System::read(&self.file)?;
        // what is known is also told where the work is cut off
        let last = RefCell::new(SoFar::Nothing);
        let known = &|so_far: SoFar| {
            last.replace(so_far.clone());
            known(so_far);
        };
        match self.looked_at(&mut system, known) {
            Err(Ended::CutOff(why)) => {
                let known = last.into_inner();
                if matches!(known, SoFar::Nothing) {
                    return Err(Unusable::report(Code::Question, why, "nothing was found before"));
                }
                begin_to_tell();
                if !matches!(known, SoFar::Rank(..)) {
                    note(&why);
                }
                known.tell(Form::of(self.json), Some(&why))
            }
            Err(Ended::Unusable(why)) => Err(why),
            Ok(status) => Ok(status),
        }
    }

    fn looked_at(&self, system: &mut System, known: &dyn Fn(SoFar)) -> Result<Status, Ended> {
        let form = Form::of(self.json);
        let is_counted = self.global || self.functions;
        if is_counted && !self.asks_for_ranks() {
            let mut own = system.clone();
            let answer = self.values(system, &|answer| known(SoFar::Values(Box::new(answer))))?;
            known(SoFar::Values(Box::new(answer.clone())));
            let printed = self.with_directions(&mut own, &answer);
            begin_to_tell();
            return Ok(Answered { files: Files::default(), printed, status: status_of(&answer) }.print(form)?);
        }
        let first = if self.singular_set {
            Step::Answered(self.singular_set(system, known)?)
        } else {
            self.ranks(system, known)?
        };
        let mut answered = match first {
            Step::Told(status) => return Ok(status),
            Step::Answered(answered) => answered,
        };
        if is_counted {
            let printed = Box::new(answered.printed.clone());
            known(SoFar::WithValues(printed.clone(), None));
            let mut anew = System::read(&self.file).map_err(Report::from)?;
            let tell = |answer| known(SoFar::WithValues(printed.clone(), Some(Box::new(answer))));
            let values = self.values(&mut anew, &tell)?;
            if answered.status == Status::AsExpected {
                answered.status = status_of(&values);
            }
            answered.printed = answered.printed.with(&values);
        }
        begin_to_tell();
        Ok(answered.print(form)?)
    }

    /// Whether something else is asked for beside numbers of solutions.
    fn asks_for_ranks(&self) -> bool {
        let files = [&self.verdicts, &self.reparametrise, &self.table, &self.shards.merge];
        self.singular_set
            || self.accessible
            || self.shards.are_asked()
            || self.samples.is_some()
            || self.order.is_some()
            || self.digits.is_some()
            || !(self.at.is_empty() && self.conditions.is_empty())
            || files.into_iter().any(Option::is_some)
    }

    /// Numbers of solutions, then what is identifiable of unknowns with infinitely many and the directions along which they change. Where these cannot be decided, the numbers alone.
    fn with_directions(&self, system: &mut System, values: &GlobalAnswer) -> Printed {
        let mut printed = Printed::of_values(values);
        if interrupted() || values.interrupted {
            return printed;
        }
        let question =
            RankQuestion { samples: 0, seed: self.seed, interrupt: &INTERRUPTED, ..Default::default() };
        let Ok(answer) = answer_rank(system, &question) else { return printed };
        let singular_set = Some(SingularSet::NotSearched);
        printed.object["unobservable_directions"] = unobservable_directions_json(&answer);
        printed.object["singular_set"] = singular_set_json(singular_set.as_ref());
        let parts = RankTextParts {
            global: Some(values),
            without_table: true,
            singular_set: singular_set.as_ref(),
            details: self.details,
        };
        Printed { text: rank_text_with(&answer, &parts), ..printed }
    }

    /// The singular set, as far as it is decided at once, beside sampled states: some tenths of a second are little there, and much beside a generic rank alone. `None` where
    /// the question is about other states than all, or the work was interrupted.
    fn singular_set_beside(&self, system: &mut System, is_sampled: bool) -> Option<SingularSet> {
        let is_of_all = self.at.is_empty() && self.conditions.is_empty() && self.order.is_none();
        if !is_of_all || interrupted() {
            return None;
        }
        if !is_sampled {
            return Some(SingularSet::NotSearched);
        }
        let found = singular_set_at_once(system, self.seed, &INTERRUPTED);
        (!interrupted()).then(|| match found {
            Ok(Some(answer)) => SingularSet::Found(Box::new(answer)),
            Ok(None) => SingularSet::TooMuchWork,
            Err(why) => SingularSet::NotAsked(why),
        })
    }

    /// The rank at sampled states, or the dual question.
    fn ranks(&self, system: &mut System, known: &dyn Fn(SoFar)) -> Result<Step, Ended> {
        let fixed: BTreeMap<_, _> =
            system.given_values(&self.at).map_err(Unusable::given)?.into_iter().collect();
        let samples = self.samples.unwrap_or(RankQuestion::default().samples);
        let bar = progress(samples, "sampling states");
        let question = &RankQuestion {
            samples,
            seed: self.seed,
            wanted: self.verdict.into(),
            digits: self.digits.map(usize::from),
            order: self.order.map(usize::from),
            fixed,
            conditions: self.conditions.clone(),
            recorded: if self.verdicts.is_some() { self.verdict_states } else { 0 },
            interrupt: &INTERRUPTED,
            progress: &|done| bar.set_position(done),
        };
        if self.accessible {
            return Ok(Step::Answered(self.accessible(system, question, &bar, known)?));
        }
        let nothing_asked = self.samples.is_none() && self.order.is_none() && self.verdicts.is_none();
        let asked = RankPreparation::fingerprint(system, question, nothing_asked);
        let parts = Parts {
            kind: "rank",
            extension: ".json",
            read: &|text| RankPart::read(text).map_err(|why| why.to_string()),
            belongs: &|part: &RankPart| part.fingerprint() == asked,
        };
        let form = Form::of(self.json);
        if let Some(missing) = &self.shards.missing {
            begin_to_tell();
            return Ok(Step::Told(parts.tell_missing(missing, form)?));
        }
        let prepare = |system: &mut System| {
            let (file, mut branches) = (system.name.clone(), Vec::new());
            let mut tell = |branch| {
                branches.push(branch);
                known(SoFar::Rank(file.clone(), branches.clone()));
            };
            let prepared = RankPreparation::telling(system, question, nothing_asked, &mut tell);
            prepared.map_err(Ended::from)
        };
        if let (Some(shard), Some(folder)) = (self.shards.shard, &self.shards.part) {
            if self.global || self.functions {
                note("numbers of solutions do not depend on states, and parts have none: --merge adds them");
            }
            let done = parts.do_shard(shard, folder, self.table.as_deref(), form, |files| {
                let states = shard_of(samples, shard.number, shard.of);
                bar.set_length(states.end - states.start);
                let prepared = prepare(system)?;
                let part = self.sweep(system, &prepared, states, files)?;
                bar.finish_and_clear();
                Ok(part.text())
            });
            return Ok(Step::Told(done?));
        }
        let mut anew = system.clone();
        let (mut files, prepared) = (Files::default(), prepare(system)?);
        let parts = match &self.shards.merge {
            Some(folder) => parts.all(folder)?,
            None => vec![(String::new(), self.sweep(system, &prepared, 0..samples, &mut files)?)],
        };
        let answer = prepared.answer(system, parts);
        bar.finish_and_clear();
        let mut answer = answer.map_err(|why| match why {
            RankError::Merge(_) => Unusable::report(Code::Saved, why.to_string(), NO_WHOLE).into(),
            _ => Ended::from(why),
        })?;
        if !self.is_timed() {
            answer.forget_times();
        }
        if let Some(path) = &self.verdicts {
            let records = rank_records(system, &answer, &self.conditions);
            let text = records.map_err(|why| why.to_string()).and_then(|records| {
                VerdictFile::new(self.seed, records).text().map_err(|why| why.to_string())
            });
            files.text_or(path, text);
        }
        let written = self.reparametrise.as_ref().map(|path| {
            let written = reparametrisation(system, &answer, &self.file, path);
            files.text_or(path, written.as_ref().map(|found| found.text.clone()).map_err(String::clone));
            written
        });
        let is_sampled = answer.branches.iter().any(|branch| branch.full.samples > 0);
        let singular_set = self.singular_set_beside(&mut anew, is_sampled);
        let mut object = rank_json(&answer);
        object["singular_set"] = singular_set_json(singular_set.as_ref());
        if let Some(Ok(found)) = &written {
            object["reparametrised"] = json!({ "claims": found.claims, "proved": found.proved });
        }
        let parts = RankTextParts {
            singular_set: singular_set.as_ref(),
            details: self.details,
            ..RankTextParts::default()
        };
        let mut text = rank_text_with(&answer, &parts);
        if let Some(Ok(found)) = &written {
            text += &format!("\n{}", found.in_words());
        }
        let status =
            if answer.interrupted() || answer.cut_off() { Status::CutOff } else { Status::AsExpected };
        Ok(Step::Answered(Answered { files, printed: Printed { object, text }, status }))
    }

    /// Looks at some states, and writes the table of them where one is wanted.
    fn sweep(
        &self,
        system: &System,
        prepared: &RankPreparation<'_>,
        states: Range<u64>,
        files: &mut Files,
    ) -> miette::Result<RankPart> {
        let unusable = |why: RankError| Unusable::report(Code::Question, why.to_string(), "");
        let Some(path) = &self.table else { return prepared.sweep(system, states).map_err(unusable) };
        let form = TableForm::of(path)
            .map_err(|why| Unusable::report(Code::Option, why, "as in --table states.parquet"))?;
        let coordinates = if self.coordinates { prepared.coordinates() } else { Vec::new() };
        let names: Vec<String> =
            coordinates.iter().map(|symbol| system.symbol_name(*symbol).to_owned()).collect();
        let mut found = None;
        files.table_of(path, |file| {
            let mut table = StateTableWriter::new(file, form, prepared.branches(), &names)?;
            let mut written = Ok(());
            let mut take = |branch: usize, rows: &[StateRow]| {
                if written.is_ok() {
                    written = table.add(branch, rows);
                }
            };
            let sink = &mut StateTable { coordinates, take: &mut take };
            let part = prepared.sweep_with(system, states.clone(), Some(sink));
            let is_whole = part.as_ref().is_ok_and(RankPart::is_whole);
            found = Some(part);
            written?;
            if is_whole {
                table.finish()
            } else {
                Err(std::io::Error::other("not all states were looked at"))
            }
        });
        match found {
            Some(part) => part.map_err(unusable),
            // the file could not be begun, and the answer does not need it
            None => prepared.sweep(system, states).map_err(unusable),
        }
    }

    /// Whether times are printed: neither where they are not wanted, nor of a merge, whose parts ran on several machines.
    fn is_timed(&self) -> bool {
        !self.no_times && self.shards.merge.is_none()
    }

    /// How many values of each unknown give the same outputs.
    fn values(&self, system: &mut System, tell: &dyn Fn(GlobalAnswer)) -> Result<GlobalAnswer, Ended> {
        let wanted = if self.functions { SolutionsWanted::Functions } else { SolutionsWanted::Values };
        // what an interrupt leaves is printed as the whole answer is, and has no time either
        let told = |mut answer: GlobalAnswer| {
            if !self.is_timed() {
                answer.seconds = f64::NAN;
            }
            answer
        };
        let mut tell = |answer| tell(told(answer));
        Ok(told(answer_solutions_telling(system, wanted, self.work, &INTERRUPTED, &mut tell)?))
    }

    /// The exact set on which the rank drops.
    fn singular_set(&self, system: &mut System, known: &dyn Fn(SoFar)) -> Result<Answered, Ended> {
        let told = |mut answer: DropAnswer| {
            if !self.is_timed() {
                answer.seconds = f64::NAN;
            }
            answer
        };
        let mut tell = |answer| known(SoFar::Drops(Box::new(told(answer))));
        let answer = where_it_drops_telling(system, self.seed, &INTERRUPTED, &mut tell)
            .map_err(|why| Unusable::report(Code::Question, why, ""))?;
        let answer = told(answer);
        let status = if answer.is_exact() { Status::AsExpected } else { Status::CutOff };
        let (mut files, object) = (Files::default(), drops_json(&answer));
        if let Some(folder) = &self.out {
            files.text(&folder.join("index.html"), &drops_page(&answer));
            files.json(&folder.join("drops.json"), &object);
            files.announce(&folder.join("index.html"));
        }
        Ok(Answered { files, printed: Printed { object, text: drops_text(&answer) }, status })
    }

    /// The answer to the dual question.
    fn accessible(
        &self,
        system: &mut System,
        question: &RankQuestion<'_>,
        bar: &indicatif::ProgressBar,
        known: &dyn Fn(SoFar),
    ) -> Result<Answered, Ended> {
        let told = |mut answer: AccessibilityAnswer| {
            if !self.is_timed() {
                let sampled = answer.branches.iter_mut().filter_map(|branch| branch.sampled.as_mut());
                sampled.for_each(|sampled| sampled.seconds = f64::NAN);
            }
            answer
        };
        let mut tell = |answer| known(SoFar::Accessible(Box::new(told(answer))));
        let answer = answer_accessibility_telling(system, question, &mut tell);
        bar.finish_and_clear();
        let answer = told(answer?);
        let is_whole = answer.is_final() && !answer.interrupted();
        let status = if is_whole { Status::AsExpected } else { Status::CutOff };
        let printed = Printed { object: accessibility_json(&answer), text: accessibility_text(&answer) };
        Ok(Answered { files: Files::default(), printed, status })
    }
}

/// Whether all numbers of solutions are there.
fn status_of(values: &GlobalAnswer) -> Status {
    if values.is_final() && !values.interrupted { Status::AsExpected } else { Status::CutOff }
}

/// Why there is no answer.
enum Ended {
    /// It takes more than a question may: what was found before is printed.
    CutOff(String),
    /// Something cannot be used.
    Unusable(Report),
}

impl From<RankError> for Ended {
    fn from(why: RankError) -> Ended {
        match why {
            RankError::CutOff(_) => Ended::CutOff(why.to_string()),
            _ => Ended::Unusable(Unusable::report(Code::Question, why.to_string(), "")),
        }
    }
}

impl From<Ended> for Report {
    fn from(why: Ended) -> Report {
        match why {
            Ended::CutOff(why) => Unusable::report(Code::Question, why, ""),
            Ended::Unusable(why) => why,
        }
    }
}

impl From<Report> for Ended {
    fn from(why: Report) -> Ended {
        Ended::Unusable(why)
    }
}
