//! What was tried, what came of it, and what is wrong: counted, printed, asserted.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// A fault: something that the library says and that is not so.
#[derive(Clone, Debug)]
pub struct Fault {
    /// In a few words; faults of one kind are shown a few times only.
    pub kind: String,
    /// What was said, and what is so.
    pub detail: String,
    /// The whole proof file.
    pub text: String,
    case: u64,
}

/// What some cases came to.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// How often, by class of cases and by what came of them.
    counts: BTreeMap<(String, String), u64>,
    /// Why something was undecided, by class.
    reasons: BTreeMap<(String, String), u64>,
    faults: Vec<Fault>,
    /// Cases that took longer than [`LONG`] seconds, with the time.
    long: Vec<(u64, f64)>,
    case: u64,
}

/// How many faults of one kind are printed.
const SHOWN: usize = 3;
/// Cases that take longer are listed, in seconds; nothing is asserted of them.
const LONG: f64 = 5.0;

/// The seed of the drawn cases.
pub fn seed() -> u64 {
    number("PALMISTRY_ORACLE_SEED").unwrap_or(1)
}

fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

impl Findings {
    /// Runs a test: as many cases as are asked for, or one of them, on all processors.
    pub fn of(name: &str, usual: u64, case: impl Fn(u64, &mut Findings) + Sync) -> Findings {
        let begin = Instant::now();
        let cases = number("PALMISTRY_ORACLE_CASES").unwrap_or(usual);
        let chosen: Vec<u64> = match number("PALMISTRY_ORACLE_ONLY") {
            Some(only) => vec![only],
            None => (0..cases).collect(),
        };
        let run = |index: u64| {
            let begin = Instant::now();
            let mut findings = Findings { case: index, ..Findings::default() };
            if catch_unwind(AssertUnwindSafe(|| case(index, &mut findings))).is_err() {
                findings.fault("the oracle itself panicked", "see above", "");
            }
            let seconds = begin.elapsed().as_secs_f64();
            if seconds > LONG {
                findings.long.push((index, seconds));
            }
            findings
        };
        // threads of our own: within the library's pool a case would be given others to do while it waits
        let next = AtomicUsize::new(0);
        let work = || {
            let mut done = Vec::new();
            while let Some(index) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
                done.push(run(*index));
            }
            done
        };
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        let mut found: Vec<Findings> = std::thread::scope(|scope| {
            let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            workers.into_iter().filter_map(|worker| worker.join().ok()).flatten().collect()
        });
        found.sort_by_key(|findings| findings.case);
        let mut all = Findings::default();
        for findings in found {
            for (key, count) in findings.counts {
                *all.counts.entry(key).or_insert(0) += count;
            }
            for (key, count) in findings.reasons {
                *all.reasons.entry(key).or_insert(0) += count;
            }
            all.faults.extend(findings.faults);
            all.long.extend(findings.long);
        }
        print!("{}", all.table(name, chosen.len(), begin.elapsed().as_secs_f64()));
        all
    }

    /// Counts one thing that came of a class of cases.
    pub fn count(&mut self, class: &str, what: &str) {
        *self.counts.entry((class.to_owned(), what.to_owned())).or_insert(0) += 1;
    }

    /// Counts something that was left undecided, with its reason.
    pub fn undecided(&mut self, class: &str, why: &str) {
        self.count(class, "undecided");
        *self.reasons.entry((class.to_owned(), shortened(why))).or_insert(0) += 1;
    }

    /// Writes down that the library is wrong.
    pub fn fault(&mut self, kind: &str, detail: impl Into<String>, text: &str) {
        let fault =
            Fault { kind: kind.to_owned(), detail: detail.into(), text: text.to_owned(), case: self.case };
        self.faults.push(fault);
    }

    /// How often something came of a class of cases.
    pub fn counted(&self, class: &str, what: &str) -> u64 {
        self.counts.get(&(class.to_owned(), what.to_owned())).copied().unwrap_or(0)
    }

    /// How often something came of all classes.
    pub fn total(&self, what: &str) -> u64 {
        self.counts.iter().filter(|((_, other), _)| other == what).map(|(_, count)| count).sum()
    }

    /// Whether this is a whole run, of which counts can be asserted.
    pub fn is_whole(&self) -> bool {
        number("PALMISTRY_ORACLE_ONLY").is_none() && number("PALMISTRY_ORACLE_CASES").is_none_or(|n| n >= 200)
    }

    /// Prints the faults and fails if there are any.
    pub fn assert_no_fault(&self, test: &str) {
        let mut kinds: BTreeMap<&str, Vec<&Fault>> = BTreeMap::new();
        for fault in &self.faults {
            kinds.entry(&fault.kind).or_default().push(fault);
        }
        for (kind, faults) in &kinds {
            let mut faults = faults.clone();
            faults.sort_by_key(|fault| fault.text.len()); // the shortest are the easiest to look into
            println!("\n=== {kind}: {} times", faults.len());
            for fault in faults.iter().take(SHOWN) {
                println!(
                    "--- {}\n{}\nto see it again: PALMISTRY_ORACLE_SEED={} PALMISTRY_ORACLE_ONLY={} cargo test --release --test oracle {test} -- --nocapture",
                    fault.detail,
                    fault.text,
                    seed(),
                    fault.case
                );
            }
        }
        assert!(
            self.faults.is_empty(),
            "{} faults of {} kinds, printed above",
            self.faults.len(),
            kinds.len()
        );
    }

    fn table(&self, name: &str, cases: usize, seconds: f64) -> String {
        let mut text = format!("\n{name}: {cases} cases, seed {}, {seconds:.1} s\n", seed());
        for ((class, what), count) in &self.counts {
            text.push_str(&format!("  {class:<34} {what:<34} {count:>7}\n"));
        }
        if !self.reasons.is_empty() {
            text.push_str("  why undecided\n");
        }
        for ((class, why), count) in &self.reasons {
            text.push_str(&format!("  {class:<34} {count:>7}  {why}\n"));
        }
        for (case, seconds) in &self.long {
            text.push_str(&format!("  case {case} took {seconds:.1} s\n"));
        }
        text
    }
}

/// A reason without what differs from case to case: quotations, numbers and terms.
fn shortened(why: &str) -> String {
    let mut text = String::new();
    let mut quoted = false;
    for c in why.chars() {
        match c {
            '\'' => {
                quoted = !quoted;
                text.push(c);
            }
            _ if quoted => {}
            '0'..='9' => {
                if !text.ends_with('#') {
                    text.push('#');
                }
            }
            _ => text.push(c),
        }
    }
    match text.split_once(':') {
        Some((before, _)) if before.len() > 12 => before.to_owned(),
        _ => text.chars().take(90).collect(),
    }
}
